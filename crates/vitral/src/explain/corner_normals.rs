//! The normals at a facet's corners: those of the faces that meet there, their mean, and the one
//! that shading uses.
//!
//! Faces count once, however many triangles they were cut into, weighted by their angle at the
//! corner. Source: the course, notes L, Gouraud shading (L8).

use super::spaces::check_facet;
use crate::{Error, Renderer};
use serde::Serialize;
use vitral_math::{DVec3, func};
use vitral_scene::Mesh;
use vitral_scene::normals::face_normal;

/// Faces of one corner that are listed.
const MOST_FACES: usize = 64;

/// A corner of a facet, and the normals there, model space, unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct CornerNormal {
    /// Which corner of the facet, 0 to 2.
    pub corner: usize,
    /// The mesh's vertex.
    pub vertex: u32,
    /// The first [faces](NormalOfFace) that have a corner at its position.
    pub faces: Vec<NormalOfFace>,
    /// The mean of all their normals, weighted by their angles; zero where they cancel each other.
    pub mean: [f32; 3],
    /// The unweighted mean of the normals of all triangles there: it leans towards faces that are
    /// cut through the corner.
    pub mean_of_triangles: [f32; 3],
    /// The normal that shading uses there.
    pub result: [f32; 3],
}

/// What a face says to one of its corners.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct NormalOfFace {
    /// The surface that the face is, as in the channel `id`.
    pub surface: u32,
    /// Its first facet.
    pub facet: u32,
    /// Its unit normal; zero without area.
    pub normal: [f32; 3],
    /// Its angle at the corner, degrees.
    #[serde(rename = "angle")]
    pub angle_degrees: f64,
}

/// The normals at the corners of a facet.
///
/// # Errors
/// A facet that the scene has not.
pub fn corner_normals(renderer: &Renderer, facet: u32) -> Result<[CornerNormal; 3], Error> {
    let world = renderer.world();
    check_facet(world, facet)?;

    // Find the triangle in its mesh, and the normals that shading has there.
    let instance = &world.instances[world.instance_of_facet(facet)];
    let mesh = &*instance.mesh;
    let triangle = (facet - instance.first_facet) as usize;
    let normals = mesh.normals.as_ref().map(|normals| normals.at(triangle, &mesh.triangles));

    Ok([0, 1, 2].map(|corner| {
        let vertex = mesh.triangles[triangle][corner];
        let position = mesh.positions[vertex as usize];
        let (mut faces, mut sum) = (Vec::new(), DVec3::ZERO);
        let mut sum_of_triangles = DVec3::ZERO;
        for face in 0..mesh.face_count() {
            // Look for the corner in the face's outline.
            let outline = mesh.face_corners(face);
            let Some(at) = outline.iter().position(|&v| mesh.positions[v as usize] == position)
            else {
                continue;
            };

            // Add the face's normal with its angle as weight.
            let (normal, angle) = (face_normal(mesh, face), angle_at(mesh, outline, at));
            let unit = DVec3::from(normal.map(f64::from));
            sum += unit * angle;
            let meets = |triangle: &[u32; 3]| {
                triangle.iter().any(|&v| mesh.positions[v as usize] == position)
            };
            let triangles = &mesh.triangles[mesh.face_triangles(face)];
            sum_of_triangles += unit * triangles.iter().filter(|t| meets(t)).count() as f64;
            if faces.len() < MOST_FACES {
                faces.push(NormalOfFace {
                    surface: instance.first_surface + face as u32,
                    facet: instance.first_facet + mesh.face_triangles(face).start as u32,
                    normal,
                    angle_degrees: angle.to_degrees(),
                });
            }
        }

        // Make means of the sums.
        let mean = sum.normalize_or_zero().as_vec3().to_array();
        let own = || face_normal(mesh, mesh.face_of_triangle(triangle));
        let result = normals.map_or_else(own, |normals| {
            let normal = DVec3::from(normals[corner].map(f64::from));
            normal.normalize_or_zero().as_vec3().to_array()
        });
        let mean_of_triangles = sum_of_triangles.normalize_or_zero().as_vec3().to_array();
        CornerNormal { corner, vertex, faces, mean, mean_of_triangles, result }
    }))
}

/// The angle of a polygon at the corner `at` of its outline, radians.
fn angle_at(mesh: &Mesh, outline: &[u32], at: usize) -> f64 {
    let count = outline.len();
    let corner = |i: usize| DVec3::from(mesh.positions[outline[i % count] as usize].map(f64::from));
    let here = corner(at);
    let (to_next, to_last) = (corner(at + 1) - here, corner(at + count - 1) - here);
    func::atan2(to_next.cross(to_last).length(), to_next.dot(to_last))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load_builtin;

    #[test]
    fn l8_three_squares_of_a_cube_meet_in_their_mean() {
        let renderer = Renderer::new(load_builtin("cubs").unwrap()).unwrap();
        let mut skewed = false;
        for facet in [0, 1, 11] {
            for corner in corner_normals(&renderer, facet).unwrap() {
                assert_eq!(corner.faces.len(), 3, "{corner:?}");
                assert!(corner.faces.iter().all(|f| (f.angle_degrees - 90.0).abs() < 1e-6));
                let third = 1.0 / 3.0f32.sqrt();
                assert!(corner.mean.iter().all(|c| (c.abs() - third).abs() < 1e-6), "{corner:?}");
                assert!(corner.faces.iter().any(|face| face.normal == corner.result));
                // A square that is cut through the corner counts twice.
                let cut = corner.mean_of_triangles.iter().any(|c| (c.abs() - third).abs() > 0.01);
                skewed |= cut;
            }
        }
        assert!(skewed);
        assert!(corner_normals(&renderer, u32::MAX).is_err());
    }
}
