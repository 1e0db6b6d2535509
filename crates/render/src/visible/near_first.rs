//! Opaque triangles from near to far, roughly: triangles drawn first hide later ones, which is
//! then rejected unseen.
//!
//! Runs of triangles are dealt into slices by how far away their boxes begin; within a slice they
//! stay in the scene's order.
//!
//! In:   jobs in the scene's order. Out: the same triangles in jobs of about the same size.
//! Cost: linear in runs of [`TRIANGLES_A_RUN`] triangles.

use super::jobs::{Job, Jobs, TriangleRun};
use crate::PreparedView;
use vitral_math::{Aabb, DVec4};
use vitral_scene::TRIANGLES_A_RUN;

/// Slices between the nearest run and the farthest.
const SLICES: usize = 256;

/// The jobs, those with opaque triangles from near to far.
pub(super) fn near_first<'v, 'a>(
    view: &'v PreparedView<'a>,
    jobs: &[Job<'v, 'a>],
) -> Vec<Job<'v, 'a>> {
    let (distances, pieces) = runs(view, jobs);
    let mut ordered = Jobs::default();
    for number in by_distance(&distances) {
        ordered.push(&pieces[number], false);
    }
    for job in jobs.iter().filter(|job| job.layered) {
        for piece in &job.pieces {
            ordered.push(piece, true);
        }
    }
    ordered.finish()
}

/// The runs of opaque triangles: how far away each begins, and its part of a piece.
fn runs<'v, 'a>(
    view: &'v PreparedView<'a>,
    jobs: &[Job<'v, 'a>],
) -> (Vec<f64>, Vec<TriangleRun<'v, 'a>>) {
    let (mut distances, mut pieces) = (Vec::new(), Vec::new());
    let mut item = None;
    let mut forward = DVec4::ZERO;
    // Take the depth axis of each instance.
    for piece in jobs.iter().filter(|job| !job.layered).flat_map(|job| &job.pieces) {
        let instance = &view.session.world.instances[view.instances[piece.item].instance];
        if item.replace(piece.item) != Some(piece.item) {
            forward = -(view.view.view_from_world * instance.world_from_model).row(2);
        }

        // Cut the piece into runs, each with its nearest distance.
        let bounds = &view.session.world.run_bounds[instance.mesh_index as usize];
        let mut start = piece.range.start;
        while start < piece.range.end {
            let run = start as usize / TRIANGLES_A_RUN;
            let end = piece.range.end.min(((run + 1) * TRIANGLES_A_RUN) as u32);
            distances.push(nearest(forward, &bounds[run]));
            pieces.push(TriangleRun { range: start..end, ..piece.clone() });
            start = end;
        }
    }
    (distances, pieces)
}

/// The order of these distances, dealt into slices; equal slices stay in order.
fn by_distance(distances: &[f64]) -> Vec<usize> {
    let (mut near, mut far) = (f64::INFINITY, f64::NEG_INFINITY);
    for &distance in distances {
        (near, far) = (near.min(distance), far.max(distance));
    }
    let scale = SLICES as f64 / (far - near);
    // Conversion ends at the limits, and makes 0 of what is not a number.
    let slice = |distance: f64| (((distance - near) * scale) as usize).min(SLICES - 1);

    // Count what falls into each slice, then deal.
    let mut starts = [0; SLICES + 1];
    for &distance in distances {
        starts[slice(distance) + 1] += 1;
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }

    // Deal the runs, slice by slice.
    let mut order = vec![0; distances.len()];
    for (number, &distance) in distances.iter().enumerate() {
        let next = &mut starts[slice(distance)];
        order[*next] = number;
        *next += 1;
    }
    order
}

/// How far along a direction a box begins.
fn nearest(forward: DVec4, bounds: &Aabb) -> f64 {
    let (center, half) = ((bounds.min + bounds.max) * 0.5, (bounds.max - bounds.min) * 0.5);
    forward.dot(center.extend(1.0)) - forward.truncate().abs().dot(half)
}

#[cfg(test)]
mod tests {
    use super::super::jobs::jobs;
    use super::*;
    use crate::stats::CullCounters;
    use crate::{Execution, Session, Settings};
    use std::sync::Arc;
    use vitral_math::DVec3;
    use vitral_raster::{SamplePattern, Viewport};
    use vitral_scene::{Camera, Projection, builtin};

    #[test]
    fn all_triangles_come_once_and_far_runs_last() {
        let session = Session::new(Arc::new(builtin::scene("teapot").expect("there is one")))
            .expect("a sound scene");
        for projection in
            [Projection::Perspective { view_angle: 0.7 }, Projection::Parallel { height: 8.0 }]
        {
            let (position, focal_point, view_up) =
                (DVec3::new(9.0, 4.0, 5.0), DVec3::ZERO, DVec3::Z);
            let camera = Camera { position, focal_point, view_up, projection, clip: None };
            let (viewport, pattern) = (Viewport { width: 64, height: 64 }, SamplePattern::new(1));
            let (settings, execution) = (Settings::default(), Execution::default());
            let counters = &mut CullCounters::default();
            let view = PreparedView::new(
                &session, &camera, &settings, viewport, pattern, &execution, counters,
            );
            let before = jobs(&view);
            let after = near_first(&view, &before);
            let triangles = |jobs: &[Job<'_, '_>]| -> Vec<(usize, u32)> {
                let pieces = jobs.iter().flat_map(|job| &job.pieces);
                pieces.flat_map(|p| p.range.clone().map(|t| (p.item, t))).collect()
            };
            let [mut all, ordered] = [triangles(&before), triangles(&after)];
            assert_ne!(all, ordered);
            let along = (focal_point - position).normalize();
            let runs: Vec<_> = ordered.chunk_by(|a, b| a.0 == b.0 && a.1 + 1 == b.1).collect();
            assert!(runs.len() > 5, "{} runs", runs.len());
            let mean = |half: &[(usize, u32)]| -> f64 {
                let sum = half.iter().map(|&(item, t)| {
                    let instance = &session.world.instances[view.instances[item].instance];
                    let corner =
                        instance.mesh.positions[instance.mesh.triangles[t as usize][0] as usize];
                    let [x, y, z] = corner.map(f64::from);
                    instance.world_from_model.transform_point3(DVec3::new(x, y, z)).dot(along)
                });
                sum.sum::<f64>() / half.len() as f64
            };
            let (near, far) = ordered.split_at(ordered.len() / 2);
            assert!(mean(near) + 0.5 < mean(far), "{} {}", mean(near), mean(far));
            let mut sorted = ordered;
            sorted.sort_unstable();
            all.sort_unstable();
            assert_eq!(all, sorted);
        }
    }
}
