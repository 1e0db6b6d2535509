//! Shading normals for meshes that come without, or with some of them missing.
//!
//! Idea: the normal of a vertex is the average of the normals of the faces round it. Each *polygon*
//! counts once, with its own (Newell) normal, however many triangles it was cut into; it is
//! weighted by its angle at the vertex, so that a surface gets the same normals whether a file
//! holds it as quads or as triangles. Plain averaging over triangles would lean towards the side
//! that happens to be cut through the vertex. Faces that meet at more than the crease angle are not
//! averaged. Where the file has smoothing groups, faces of different groups, or of group 0, have
//! creases between them, too; programs write one group for all faces of a box, so that within a
//! group the angle still counts.
//!
//! In:   a mesh, model space; equal positions count as one vertex, so that seams stay smooth.
//! Out:  unit normals in [`Mesh::normals`]; one per vertex where no vertex needs two, else with
//!       corner indices.
//! Cost: `O(corners)`; with creases each vertex compares its faces in pairs (see `corner_fans`).
//! Source: [Gouraud 1971] (the average); [Thürmer & Wüthrich 1998] (the angle as weight).
//!
//! A face without area has no say. A vertex with no other faces gets `(0, 0, 1)`, OpenGL's initial
//! normal. Where the faces of a vertex cancel each other (two sheets back to back, smoothed
//! together), it gets its first face's normal.

use crate::corner_fans::{Rule, fan_normals};
use crate::directions::{DEFAULT_NORMAL, unit};
use crate::face_data::{BATCH, FaceData, face_data, outline_normal};
use crate::weld::Weld;
use crate::{Attribute, Corners, Faces, KnownSolidity, Mesh, Solids};
use std::f64::consts::PI;
use std::sync::Arc;
use vitral_exec::Workers;
use vitral_math::DVec3;

/// Makes the normals that `mesh` lacks: all, or those that are zero or not finite. Does nothing
/// where none is missing.
///
/// `crease_angle` in radians: faces whose normals differ by more are not averaged. `π` (or NaN) is
/// smooth everywhere, `0` gives each face its own normal.
///
/// # Panics
/// Possibly, if the mesh is not sound ([`Mesh::check`]): its indices are followed without a look at
/// their size.
pub fn generate(mesh: &mut Mesh, crease_angle: f64, workers: &Workers) {
    let missing = |n: &[f32; 3]| *n == [0.0; 3] || n.iter().any(|c| !c.is_finite());
    if mesh.triangles.is_empty()
        || mesh.normals.as_ref().is_some_and(|n| !n.values.iter().any(missing))
    {
        return;
    }
    let (made, solids) = all_normals(mesh, crease_angle, workers);
    mesh.solidity = solids.map(|solids| KnownSolidity::new(mesh, solids, workers));
    mesh.normals = Some(match mesh.normals.take() {
        None => made,
        Some(given) => fill_gaps(given, made, &mesh.triangles, missing),
    });
}

/// Makes normals unit whose length single precision cannot square, so that any length but 0 is as
/// good as another.
pub fn make_measurable(mesh: &mut Arc<Mesh>, workers: &Workers) {
    let is_extreme = |n: &[f32; 3]| {
        let length = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        !(1e-24..=1e24).contains(&length) && *n != [0.0; 3] && n.iter().all(|c| c.is_finite())
    };
    let Some(normals) = &mesh.normals else { return };
    let batches: Vec<_> = normals.values.chunks(BATCH).collect();
    if !workers.map(batches.len(), |i| batches[i].iter().any(is_extreme)).contains(&true) {
        return;
    }
    let normals = Arc::make_mut(mesh).normals.iter_mut().flat_map(|n| &mut n.values);
    normals
        .filter(|n| is_extreme(n))
        .for_each(|n| *n = DVec3::from(n.map(f64::from)).normalize().as_vec3().to_array());
}

/// The unit normal of face `face`, counter-clockwise outlines towards the viewer; zero for a face
/// without area.
pub fn face_normal(mesh: &Mesh, face: usize) -> [f32; 3] {
    outline_normal(mesh, mesh.face_corners(face)).as_vec3().to_array()
}

/// The unit normals of all faces; zero for faces without area.
pub fn face_normals(mesh: &Mesh, workers: &Workers) -> Vec<[f32; 3]> {
    let mut normals = vec![[0.0; 3]; mesh.face_count()];
    workers.for_each_chunk(&mut normals, BATCH, |batch, normals| {
        for (k, normal) in normals.iter_mut().enumerate() {
            *normal = face_normal(mesh, batch * BATCH + k);
        }
    });
    normals
}

fn all_normals(
    mesh: &Mesh,
    crease_angle: f64,
    workers: &Workers,
) -> (Attribute<[f32; 3]>, Option<Solids>) {
    let weld = Weld::new(&mesh.positions, workers);
    let rule = match &mesh.smoothing_groups {
        Some(groups) if groups.len() == mesh.face_count() => {
            Rule::within(crease_angle).in_groups(groups)
        }
        _ if crease_angle.is_nan() || crease_angle >= PI => {
            return (
                Attribute::per_vertex(smooth(mesh, &weld, &face_data(mesh, workers), workers)),
                None,
            );
        }
        _ => Rule::within(crease_angle),
    };
    let made = fan_normals(mesh, &weld, rule, workers);
    let corners = made.of_corner.map(|of_corner| triangle_corners(mesh, &of_corner, workers));
    (Attribute { values: made.values, corners }, made.solids)
}

/// One normal per vertex, all faces averaged.
fn smooth(mesh: &Mesh, weld: &Weld, faces: &FaceData, workers: &Workers) -> Vec<[f32; 3]> {
    // Every thread owns a range of vertices and reads all faces: each sum is in the order of the
    // faces, whatever the number of threads.
    let mut normals = vec![[0.0f32; 3]; mesh.positions.len()];
    let share = mesh.positions.len().div_ceil(workers.threads()).max(1);
    workers.for_each_chunk(&mut normals, share, |k, sums| {
        let first = (k * share) as u32;
        for_each_corner(mesh, |face, corner, vertex| {
            let v = weld.representative[vertex as usize].wrapping_sub(first) as usize;
            if let Some(sum) = sums.get_mut(v) {
                let (n, w) = (faces.normals[face], faces.weights[corner]);
                *sum = [sum[0] + n[0] * w, sum[1] + n[1] * w, sum[2] + n[2] * w];
            }
        });
        sums.iter_mut().for_each(|sum| *sum = unit(*sum).unwrap_or([0.0; 3]));
    });

    // Where a sum has cancelled out, the first face with a normal decides.
    if normals.contains(&[0.0; 3]) {
        for_each_corner(mesh, |face, _, vertex| {
            let normal = &mut normals[weld.representative[vertex as usize] as usize];
            if *normal == [0.0; 3] {
                *normal = faces.normals[face];
            }
        });
        normals.iter_mut().filter(|n| **n == [0.0; 3]).for_each(|n| *n = DEFAULT_NORMAL);
    }
    if weld.distinct < normals.len() {
        for (v, &first) in weld.representative.iter().enumerate() {
            normals[v] = normals[first as usize];
        }
    }
    normals
}

/// Calls `f(face, position in the corner list, vertex)` for every corner of every face.
#[inline]
fn for_each_corner(mesh: &Mesh, mut f: impl FnMut(usize, usize, u32)) {
    match &mesh.faces {
        Faces::Triangles => {
            for (t, corners) in mesh.triangles.iter().enumerate() {
                (0..3).for_each(|k| f(t, 3 * t + k, corners[k]));
            }
        }
        Faces::Polygons { starts, corners } => {
            for (face, ends) in starts.windows(2).enumerate() {
                (ends[0] as usize..ends[1] as usize).for_each(|c| f(face, c, corners[c]));
            }
        }
    }
}

/// From the normals at the corners of faces to those at the corners of triangles.
fn triangle_corners(mesh: &Mesh, of_corner: &[u32], workers: &Workers) -> Vec<Corners> {
    if matches!(mesh.faces, Faces::Triangles) {
        return of_corner.as_chunks().0.to_vec();
    }
    let batches = workers.map(mesh.face_count().div_ceil(BATCH), |batch| {
        let mut triangles = Vec::new();
        let mut sorted = Vec::new();
        for face in batch * BATCH..mesh.face_count().min((batch + 1) * BATCH) {
            let outline = mesh.face_corners(face);
            let normals = &of_corner[mesh.first_corner(face)..][..outline.len()];

            // A polygon's triangles name vertices: look up which corner that is. Long outlines are
            // sorted for it.
            sorted.clear();
            if outline.len() > 16 {
                sorted.extend(outline.iter().copied().zip(normals.iter().copied()));
                sorted.sort_unstable();
            }
            let find = |vertex: u32| {
                if sorted.is_empty() {
                    outline.iter().position(|&v| v == vertex).map_or(normals[0], |k| normals[k])
                } else {
                    sorted[sorted.partition_point(|s| s.0 < vertex).min(sorted.len() - 1)].1
                }
            };
            triangles.extend(mesh.triangles[mesh.face_triangles(face)].iter().map(|t| t.map(find)));
        }
        triangles
    });
    batches.concat()
}

/// The given normals, with the made ones at the corners where a given one is missing.
fn fill_gaps(
    mut given: Attribute<[f32; 3]>,
    made: Attribute<[f32; 3]>,
    triangles: &[Corners],
    missing: impl Fn(&[f32; 3]) -> bool,
) -> Attribute<[f32; 3]> {
    let first = given.values.len() as u32;
    let mut corners = given.corners.take().unwrap_or_else(|| triangles.to_vec());
    let made_corners = made.corners.as_deref().unwrap_or(triangles);
    for (mine, other) in corners.as_flattened_mut().iter_mut().zip(made_corners.as_flattened()) {
        if missing(&given.values[*mine as usize]) {
            *mine = first + other;
        }
    }
    // Nothing refers to the bad values, but they must not trip a reader who looks at all of them.
    given.values.iter_mut().filter(|n| missing(n)).for_each(|n| *n = DEFAULT_NORMAL);
    given.values.extend(made.values);
    Attribute { values: given.values, corners: Some(corners) }
}

#[cfg(test)]
mod tests;
