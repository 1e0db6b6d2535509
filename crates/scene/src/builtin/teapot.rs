//! The Utah teapot, from its Bézier patches.
//!
//! Idea: 32 bicubic patches. Rim, body, lid and bottom are turned: a profile of four control
//! points, swept through four quarter turns. A cubic cannot make an exact quarter circle; the
//! control points in between lie at 0.56 of the radius along the tangent (at 0.5625 in the knob).
//! Handle and spout are given as halves and mirrored. Each patch is evaluated on a grid and gives
//! quads, triangles where a side of the patch is a point; normals are the cross products of the
//! partial derivatives.
//!
//! In:   the number of quads along each side of a patch.
//! Out:  a mesh, y up, standing on `y = 0`, radius 2 and height 3.15 units; vertices shared between
//!       patches. It is open, as the original is: between lid and rim, and where handle and spout
//!       enter the body.
//! Cost: `O(32 divisions²)`.
//! Source: [Newell 1975] (measured from a Melitta teapot); bottom after [Crow 1987].

use super::builder::{Builder, Corner};
use crate::weld::Weld;
use crate::{Faces, Mesh};
use std::array::from_fn;
use vitral_exec::Workers;
use vitral_math::{DVec3, Vec3};

/// Control points of a patch: rows along the profile, columns across. z is up here.
type Patch = [[DVec3; 4]; 4];

/// A profile's control points: radius, offset of the tangent's control points, height.
type Profile = [[f64; 3]; 4];

/// Rim, upper and lower body, bottom: one smooth curve, from the inner edge of the rim to the
/// middle of the bottom.
const BODY: [Profile; 4] = [
    [[1.4, 0.784, 2.4], [1.3375, 0.749, 2.53125], [1.4375, 0.805, 2.53125], [1.5, 0.84, 2.4]],
    [[1.5, 0.84, 2.4], [1.75, 0.98, 1.875], [2.0, 1.12, 1.35], [2.0, 1.12, 0.9]],
    [[2.0, 1.12, 0.9], [2.0, 1.12, 0.45], [1.5, 0.84, 0.225], [1.5, 0.84, 0.15]],
    [[1.5, 0.84, 0.15], [1.5, 0.84, 0.075], [1.425, 0.798, 0.0], [0.0, 0.0, 0.0]],
];

/// Knob and lid, from the top outwards.
const LID: [Profile; 2] = [
    [[0.0, 0.0, 3.15], [0.8, 0.45, 3.15], [0.0, 0.0, 2.85], [0.2, 0.112, 2.7]],
    [[0.2, 0.112, 2.7], [0.4, 0.224, 2.55], [1.3, 0.728, 2.55], [1.3, 0.728, 2.4]],
];

/// Rows of handle and spout: the two ends of a half section in the plane of symmetry, each
/// `[x, z]`, and the half width (the two control points in between lie beside the ends, at this
/// distance).
type Row = ([f64; 2], [f64; 2], f64);

const HANDLE: [Row; 7] = [
    ([-1.6, 2.025], [-1.5, 2.25], 0.3),
    ([-2.3, 2.025], [-2.5, 2.25], 0.3),
    ([-2.7, 2.025], [-3.0, 2.25], 0.3),
    ([-2.7, 1.8], [-3.0, 1.8], 0.3),
    ([-2.7, 1.575], [-3.0, 1.35], 0.3),
    ([-2.5, 1.125], [-2.65, 0.9375], 0.3),
    ([-2.0, 0.9], [-1.9, 0.6], 0.3),
];

const SPOUT: [Row; 7] = [
    ([1.7, 1.425], [1.7, 0.6], 0.66),
    ([2.6, 1.425], [3.1, 0.825], 0.66),
    ([2.3, 2.1], [2.4, 2.025], 0.25),
    ([2.7, 2.4], [3.3, 2.4], 0.25),
    ([2.8, 2.475], [3.525, 2.49375], 0.25),
    ([2.9, 2.475], [3.45, 2.5125], 0.15),
    ([2.8, 2.4], [3.2, 2.4], 0.15),
];

/// The teapot with `divisions` quads along each side of its 32 patches, from 1 to 256 (values
/// outside are moved there).
pub fn teapot(divisions: u32) -> Mesh {
    let divisions = divisions.clamp(1, 256);
    let mut b = Builder::new("teapot");
    for (name, profiles) in [("body", &BODY[..]), ("lid", &LID[..])] {
        for profile in profiles {
            (0..4).for_each(|quarter| {
                tessellate(&mut b, &turned(profile, quarter), divisions, false)
            });
        }
        b.end_part(name);
    }
    for (name, rows) in [("handle", &HANDLE), ("spout", &SPOUT)] {
        for half in [&rows[..4], &rows[3..]] {
            let patch: Patch = from_fn(|j| section(&half[j]));
            tessellate(&mut b, &patch, divisions, false);
            tessellate(
                &mut b,
                &patch.map(|row| row.map(|p| p * DVec3::new(1.0, -1.0, 1.0))),
                divisions,
                true,
            );
        }
        b.end_part(name);
    }
    weld_positions(b.finish())
}

/// The patch of one quarter turn (clockwise seen from above) of a profile.
fn turned(profile: &Profile, quarter: usize) -> Patch {
    profile.map(|[radius, tangent, z]| {
        [[radius, 0.0], [radius, -tangent], [tangent, -radius], [0.0, -radius]].map(
            |[mut x, mut y]| {
                // Quarter turns by exchange of coordinates are exact, so that patches meet in equal
                // positions.
                for _ in 0..quarter {
                    (x, y) = (y, -x);
                }
                DVec3::new(x, y, z)
            },
        )
    })
}

/// The control points across handle or spout.
fn section(&([x0, z0], [x1, z1], width): &Row) -> [DVec3; 4] {
    [
        DVec3::new(x0, 0.0, z0),
        DVec3::new(x0, -width, z0),
        DVec3::new(x1, -width, z1),
        DVec3::new(x1, 0.0, z1),
    ]
}

/// Bernstein polynomials of degree 3, and their derivatives.
fn bernstein(t: f64) -> ([f64; 4], [f64; 4]) {
    let s = 1.0 - t;
    (
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
        [-3.0 * s * s, 3.0 * s * s - 6.0 * s * t, 6.0 * s * t - 3.0 * t * t, 3.0 * t * t],
    )
}

/// Combines the columns first, then the rows, so that equal boundary curves give equal points.
fn combine(patch: &Patch, across: &[f64; 4], along: &[f64; 4]) -> DVec3 {
    let mix = |weights: &[f64; 4], p: &[DVec3; 4]| (0..4).map(|k| p[k] * weights[k]).sum::<DVec3>();
    mix(along, &patch.map(|row| mix(across, &row)))
}

/// The unit normal, outwards in the patches as given; beside a degenerate side where that has none.
fn normal(patch: &Patch, u: f64, v: f64) -> DVec3 {
    for inset in [0.0, 1e-3, 1e-2] {
        let ((bu, du), (bv, dv)) = (bernstein(u), bernstein(v.clamp(inset, 1.0 - inset)));
        let n = combine(patch, &du, &bv).cross(combine(patch, &bu, &dv));
        if n.length_squared() > 1e-8 {
            return n.normalize();
        }
    }
    DVec3::Z
}

/// Adds the patch's grid; z up becomes y up. A mirrored patch is wound the other way.
fn tessellate(b: &mut Builder, patch: &Patch, divisions: u32, mirrored: bool) {
    let upright = |p: DVec3| DVec3::new(p.x, p.z, -p.y);
    let mut grid: Vec<(Vec3, Corner)> = Vec::new();
    for j in 0..=divisions {
        for i in 0..=divisions {
            let (u, v) = (f64::from(i) / f64::from(divisions), f64::from(j) / f64::from(divisions));
            let p = combine(patch, &bernstein(u).0, &bernstein(v).0);
            let n = normal(patch, u, v) * if mirrored { -1.0 } else { 1.0 };
            grid.push((p.as_vec3(), [b.position(upright(p)), b.normal(upright(n)), b.uv(u, v)]));
        }
    }
    for j in 0..divisions {
        for i in 0..divisions {
            let at = |i: u32, j: u32| grid[(j * (divisions + 1) + i) as usize];
            let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            // Leave out corners that fall on their predecessor: at a pole, quads are triangles.
            let mut corners: Vec<Corner> =
                (0..4).filter(|&k| quad[k].0 != quad[(k + 3) % 4].0).map(|k| quad[k].1).collect();
            if mirrored {
                corners.reverse();
            }
            b.polygon(&corners);
        }
    }
}

/// Keeps one vertex for each position.
fn weld_positions(mut mesh: Mesh) -> Mesh {
    let weld = Weld::new(&mesh.positions, &Workers::single());
    let mut kept = Vec::with_capacity(weld.distinct);
    let mut index = vec![0; mesh.positions.len()];
    for (v, &first) in weld.representative.iter().enumerate() {
        if first as usize == v {
            index[v] = kept.len() as u32;
            kept.push(mesh.positions[v]);
        } else {
            index[v] = index[first as usize];
        }
    }
    mesh.positions = kept;
    mesh.triangles.as_flattened_mut().iter_mut().for_each(|v| *v = index[*v as usize]);
    if let Faces::Polygons { corners, .. } = &mut mesh.faces {
        corners.iter_mut().for_each(|v| *v = index[*v as usize]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Topology, normals};

    #[test]
    fn the_teapot_is_sound_and_its_patches_meet() {
        let mesh = teapot(8);
        mesh.check().unwrap();
        let t = Topology::of(&mesh, &Workers::single());
        // Bodies: lid, spout, and the body with the handle, which ends in a vertex of the widest
        // ring.
        assert_eq!(
            (t.components, t.degenerate_triangles, t.non_manifold_edges, t.inconsistent_edges),
            (3, 0, 0, 0)
        );
        // Open: rim and lid have one boundary each, handle and spout two; a boundary of four
        // quarters has 32 edges, one of two halves 16.
        assert_eq!(t.boundary_edges, 2 * 32 + 4 * 16);
        let bounds = mesh.bounds();
        assert_eq!((bounds.min.y, (bounds.max.y - 3.15).abs() < 1e-6), (0.0, true));
    }

    #[test]
    fn normals_are_unit_and_look_the_way_the_faces_do() {
        let mesh = teapot(10);
        for t in 0..mesh.triangles.len() {
            let face = DVec3::from_array(
                normals::face_normal(&mesh, mesh.face_of_triangle(t)).map(f64::from),
            );
            for n in mesh.normals.as_ref().unwrap().at(t, &mesh.triangles) {
                let n = DVec3::from_array(n.map(f64::from));
                assert!(
                    (n.length() - 1.0).abs() < 1e-6 && n.dot(face) > 0.3,
                    "triangle {t}: {n} by {face}"
                );
            }
        }
    }

    #[test]
    fn the_body_looks_outwards() {
        // The widest ring, at height 0.9: normals lead away from the axis.
        let mesh = teapot(4);
        let widest =
            |p: &[f32; 3]| (p[1] - 0.9).abs() < 1e-6 && (p[0] * p[0] + p[2] * p[2]).sqrt() > 1.95;
        let mut seen = 0;
        for t in mesh.parts[0].triangles.clone().map(|t| t as usize) {
            let n = mesh.normals.as_ref().unwrap().at(t, &mesh.triangles);
            for k in 0..3 {
                let p = mesh.positions[mesh.triangles[t][k] as usize];
                if widest(&p) {
                    seen += 1;
                    assert!(n[k][0] * p[0] + n[k][2] * p[2] > 1.9, "{n:?} at {p:?}");
                }
            }
        }
        assert!(seen > 16);
    }
}
