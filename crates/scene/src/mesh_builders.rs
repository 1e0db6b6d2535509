//! Short ways to meshes: positions and triangles or polygons, then a name, a material, normals.
//!
//! ```
//! use vitral_scene::Mesh;
//! let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
//! let square = Mesh::from_polygons(corners, [[0, 1, 2, 3]]).with_name("square");
//! assert_eq!((square.face_count(), square.triangles.len()), (1, 2));
//! assert!(square.check().is_ok());
//! ```

use crate::{Attribute, Corners, Faces, Mesh, Part, normals};
use vitral_exec::Workers;

impl Mesh {
    /// A mesh of triangles, each a face, in one part without a material. Corners run
    /// counter-clockwise seen from outside.
    pub fn new(positions: impl Into<Vec<[f32; 3]>>, triangles: impl Into<Vec<Corners>>) -> Self {
        let (positions, triangles) = (positions.into(), triangles.into());
        let parts = vec![Part {
            name: String::new(),
            triangles: 0..triangles.len() as u32,
            material: None,
        }];
        Self { positions, triangles, parts, ..Self::default() }
    }

    /// As [`new`](Self::new), of convex polygons with three or more corners, each a face. Polygons
    /// with fewer corners are left out.
    pub fn from_polygons(
        positions: impl Into<Vec<[f32; 3]>>,
        polygons: impl IntoIterator<Item = impl AsRef<[u32]>>,
    ) -> Self {
        let (mut starts, mut corners, mut triangles) = (vec![0], Vec::new(), Vec::new());
        for polygon in polygons {
            if let [first, rest @ ..] = polygon.as_ref()
                && rest.len() >= 2
            {
                triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
                corners.extend_from_slice(polygon.as_ref());
                starts.push(corners.len() as u32);
            }
        }
        Self { faces: Faces::Polygons { starts, corners }, ..Self::new(positions, triangles) }
    }

    /// With this name, for messages.
    #[must_use]
    pub fn with_name(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// With this material for all triangles, lines and points that have a part: an index into
    /// [`Scene::materials`](crate::Scene::materials).
    #[must_use]
    pub fn with_material(mut self, material: u32) -> Self {
        self.materials_mut().for_each(|own| *own = Some(material));
        self
    }

    /// With a normal for each position, of any length but 0.
    #[must_use]
    pub fn with_normals(self, normals: impl Into<Vec<[f32; 3]>>) -> Self {
        Self { normals: Some(Attribute::per_vertex(normals.into())), ..self }
    }

    /// With normals made from the faces. Faces whose normals differ by more than `crease_angle`
    /// radians have an edge between them; others are smooth together. Without normals each face is
    /// flat.
    ///
    /// # Panics
    /// Possibly, if the mesh is not sound ([`Mesh::check`]).
    #[must_use]
    pub fn with_smooth_normals(mut self, crease_angle: f64) -> Self {
        self.normals = None;
        normals::generate(&mut self, crease_angle, &Workers::single());
        self
    }

    /// With texture coordinates for each position, `(0, 0)` at the image's top left.
    #[must_use]
    pub fn with_uvs(mut self, uvs: impl Into<Vec<[f32; 2]>>) -> Self {
        self.uvs = vec![Attribute::per_vertex(uvs.into())];
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_become_fans_that_remember_their_faces() {
        let positions =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 2.0, 0.0]];
        let mesh = Mesh::from_polygons(positions, [&[0, 1, 2, 3][..], &[3, 2, 4], &[0, 1]])
            .with_material(7);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [3, 2, 4]]);
        assert_eq!(
            (mesh.face_count(), mesh.face_of_triangle(2), mesh.material_of_triangle(2)),
            (2, 1, Some(7))
        );
        mesh.check().unwrap();
        Mesh::new(positions, []).check().unwrap();
    }

    #[test]
    fn normals_are_smooth_up_to_the_crease_angle() {
        // Two squares at a right angle.
        let positions = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, -1.0],
            [0.0, 1.0, -1.0],
        ];
        let bent = || Mesh::from_polygons(positions, [[0, 1, 2, 3], [0, 3, 5, 4]]);
        let first = |mesh: Mesh| mesh.normals.as_ref().map(|n| n.at(0, &mesh.triangles)[0]);
        assert_eq!(first(bent()), None);
        assert_eq!(first(bent().with_smooth_normals(1.0)), Some([0.0, 0.0, 1.0]));
        assert!(first(bent().with_smooth_normals(2.0)).is_some_and(|n| n[0] < -0.7 && n[2] > 0.7));
    }
}
