//! Tangents: the directions in which a texture's u grows at the corners of triangles, so that
//! normal maps go on smoothly from facet to facet.
//!
//! Idea: corners that agree in position, normal and texture coordinates, and whose triangles show
//! the texture the same way round, share a tangent: the mean of the triangles' own directions, each
//! laid into the plane of the normal, by the angles at the corner. Pictures of normals are made for
//! such tangents.
//!
//! In:   a mesh with normals and texture coordinates, model space. Out: unit tangents, zero where
//! no texture runs, and in `w` which way round the texture is, see [`Mesh::tangents`].
//! Cost: linear in corners (hashing).
//! Source: [Mikkelsen 2008]. Departs from it: corners share whether or not edges connect their
//!         triangles.

use crate::{Attribute, Corners, Mesh};
use std::collections::HashMap;
use vitral_math::{DVec3, func};

/// What corners that share a tangent agree in: bits of the position, the normal and the texture
/// coordinates, and which way round the texture is.
type Place = ([u32; 3], [u32; 3], [u32; 2], bool);

/// The tangents for texture coordinates `set`; `None` if the mesh has no such coordinates or no
/// normals.
///
/// # Panics
/// Possibly, if the mesh is not sound ([`Mesh::check`]).
pub fn tangents(mesh: &Mesh, set: usize) -> Option<Attribute<[f32; 4]>> {
    let (uvs, normals) = (mesh.uvs.get(set)?, mesh.normals.as_ref()?);
    let mut numbers: HashMap<Place, u32> = HashMap::new();
    let mut sums: Vec<(DVec3, f32)> = Vec::new();
    let mut corners: Vec<Corners> = Vec::with_capacity(mesh.triangles.len());
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let positions = triangle.map(|i| mesh.positions[i as usize]);
        let (uv, normal) = (uvs.at(t, &mesh.triangles), normals.at(t, &mesh.triangles));
        let (along, flipped) = growing_u(positions.map(wide), uv);
        corners.push([0, 1, 2].map(|c| {
            // -0 and 0 are one place.
            let bits = |v: [f32; 3]| v.map(|x| (x + 0.0).to_bits());
            let place =
                (bits(positions[c]), bits(normal[c]), uv[c].map(|x| (x + 0.0).to_bits()), flipped);
            let number = *numbers.entry(place).or_insert_with(|| {
                // Where corners run counter-clockwise and v grows downwards, the area of the
                // texture is negative.
                sums.push((DVec3::ZERO, if flipped { 1.0 } else { -1.0 }));
                sums.len() as u32 - 1
            });
            let n = wide(normal[c]).normalize_or_zero();
            let laid = (along - n * n.dot(along)).normalize_or_zero();
            if laid.is_finite() {
                sums[number as usize].0 += laid * angle(positions.map(wide), c);
            }
            number
        }));
    }
    let values = sums
        .iter()
        .map(|(sum, w)| sum.normalize_or_zero().as_vec3().extend(*w).to_array())
        .collect();
    Some(Attribute { values, corners: Some(corners) })
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

/// The unit vector in a triangle's plane along which u grows and v stays, and whether the texture
/// lies the other way round; zero where the texture coordinates have no area.
fn growing_u([a, b, c]: [DVec3; 3], uv: [[f32; 2]; 3]) -> (DVec3, bool) {
    let difference = |i: usize, k: usize| f64::from(uv[i][k]) - f64::from(uv[0][k]);
    let (du1, dv1, du2, dv2) =
        (difference(1, 0), difference(1, 1), difference(2, 0), difference(2, 1));
    let area = du1 * dv2 - du2 * dv1;
    let along = (b - a) * dv2 - (c - a) * dv1;
    let flipped = area < 0.0;
    let usable = area != 0.0 && along.is_finite();
    let direction = if usable { along.normalize_or_zero() } else { DVec3::ZERO };
    (if flipped { -direction } else { direction }, flipped)
}

/// The angle of a triangle at a corner; 0 if it has none.
fn angle(corners: [DVec3; 3], c: usize) -> f64 {
    let at = corners[c];
    let (forth, back) = (corners[(c + 1) % 3] - at, corners[(c + 2) % 3] - at);
    let angle = func::atan2(forth.cross(back).length(), forth.dot(back));
    if angle.is_finite() { angle } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::solids;
    use crate::normals;
    use vitral_exec::Workers;

    /// Two squares side by side, bent along the line between them; the second one's texture is
    /// mirrored if wanted.
    fn bent(mirrored: bool) -> Mesh {
        let positions = vec![
            [-1.0, 0.0, -1.0],
            [0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-1.0, 1.0, -1.0],
            [1.0, 0.0, -1.0],
            [1.0, 1.0, -1.0],
        ];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]];
        let u = if mirrored { -1.0 } else { 1.0 };
        let uv = vec![[-1.0, 0.0], [0.0, 0.0], [0.0, -1.0], [-1.0, -1.0], [u, 0.0], [u, -1.0]];
        let mut mesh =
            Mesh { positions, triangles, uvs: vec![Attribute::per_vertex(uv)], ..Mesh::default() };
        normals::generate(&mut mesh, 3.2, &Workers::single());
        mesh
    }

    fn without_w([x, y, z, _]: [f32; 4]) -> [f32; 3] {
        [x, y, z]
    }

    fn close(a: [f32; 3], b: [f64; 3]) {
        assert!((0..3).all(|k| (f64::from(a[k]) - b[k]).abs() < 1e-6), "{a:?}, not {b:?}");
    }

    #[test]
    fn neighbours_share_tangents_unless_the_texture_is_mirrored_between_them() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let mesh = bent(false);
        let smooth = tangents(&mesh, 0).expect("it has coordinates");
        let of = |tangents: &Attribute<[f32; 4]>, mesh: &Mesh, t| {
            tangents.at(t, &mesh.triangles).map(without_w)
        };
        let [left, right] = [0, 2].map(|t| of(&smooth, &mesh, t));
        assert!(smooth.values.iter().all(|v| v[3] == 1.0));
        close(left[0], [half, 0.0, half]);
        close(left[1], [1.0, 0.0, 0.0]);
        close(right[0], [1.0, 0.0, 0.0]);
        close(right[1], [half, 0.0, -half]);

        let mesh = bent(true);
        let mirrored = tangents(&mesh, 0).expect("it has coordinates");
        let [left, right] = [0, 2].map(|t| of(&mirrored, &mesh, t));
        assert_eq!([0, 2].map(|t| mirrored.at(t, &mesh.triangles)[0][3]), [1.0, -1.0]);
        close(left[1], [1.0, 0.0, 0.0]);
        close(right[0], [-1.0, 0.0, 0.0]);
        assert_eq!(tangents(&mesh, 1), None);
    }

    #[test]
    fn tangents_are_unit_and_lie_in_the_surface_or_are_zero() {
        let mut ball = solids::sphere(1.0, 24, 12);
        assert!(!ball.uvs.is_empty(), "a ball has coordinates");
        let of_ball = tangents(&ball, 0).expect("a ball has coordinates");
        for t in 0..ball.triangles.len() {
            let normals = ball.normals.as_ref().expect("a ball has normals").at(t, &ball.triangles);
            for (tangent, normal) in of_ball
                .at(t, &ball.triangles)
                .map(without_w)
                .map(wide)
                .into_iter()
                .zip(normals.map(wide))
            {
                assert!(
                    (tangent.length() - 1.0).abs() < 1e-6 && tangent.dot(normal).abs() < 1e-6,
                    "{tangent}"
                );
                // u runs round the axis.
                assert!(tangent.y.abs() < 0.3, "{tangent}");
            }
        }
        ball.uvs[0].values.fill([0.5; 2]);
        assert!(
            tangents(&ball, 0).is_some_and(|a| a.values.iter().all(|v| without_w(*v) == [0.0; 3]))
        );
        ball.uvs[0].values.fill([f32::NAN; 2]);
        assert!(
            tangents(&ball, 0).is_some_and(|a| a.values.iter().all(|v| without_w(*v) == [0.0; 3]))
        );
    }
}
