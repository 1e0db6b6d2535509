//! The polygons of a mesh as flat shading sees them: a centre and a normal each.

use vitral_scene::{Faces, Mesh, normals};

/// Centre and normal of each polygon of a mesh, model space. Meshes of triangles need none: a facet
/// is a face.
#[derive(Debug, Default)]
pub struct FaceTable {
    pub(super) centers_and_normals: Vec<[[f32; 3]; 2]>,
}

impl FaceTable {
    /// Walks the mesh's polygons.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let Faces::Polygons { .. } = mesh.faces else { return Self::default() };
        let center = |face: usize| {
            let corners = mesh.face_corners(face);
            let mut sum = [0.0; 3];
            for &c in corners {
                (0..3).for_each(|k| sum[k] += mesh.positions[c as usize][k]);
            }
            sum.map(|s| s / corners.len() as f32)
        };
        let faces = (0..mesh.face_count()).map(|f| [center(f), normals::face_normal(mesh, f)]);
        Self { centers_and_normals: faces.collect() }
    }
}
