//! View-frustum culling by hierarchy: the scene, then objects, then runs of triangles of objects
//! that cross its border.
//!
//! In:   the world's instances, the view volume.
//! Out:  for each instance that may be visible, the runs of its triangles that may be.
//! Cost: one box test for whatever is wholly outside or inside; the tests in between go with the
//!       border.
//! Source: [Clark 1976].

use super::bounds_tree::{BoundsTree, BoxTest};
use crate::stats::CullCounters;
use crate::trace::{BoxVerdict, Step};
use crate::{Execution, Session};
use std::ops::Range;
use vitral_math::DMat4;
use vitral_math::frustum::{Containment, Frustum};
use vitral_scene::TRIANGLES_A_RUN;

/// An instance and which of its triangles to draw.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VisibleInstance {
    /// Index into the world's instances.
    pub instance: usize,
    /// Runs of triangles, in order.
    pub ranges: Vec<Range<u32>>,
}

/// What may be visible. With `enabled` false, everything.
pub fn cull(
    session: &Session,
    clip_from_world: &DMat4,
    enabled: bool,
    execution: &Execution,
    counters: &mut CullCounters,
) -> Vec<VisibleInstance> {
    let instances = &session.world.instances;
    counters.instances = instances.len() as u64;
    counters.triangles = u64::from(session.world.facet_count);
    let all = |i: usize| 0..instances[i].mesh.triangles.len() as u32;

    // Keep everything if culling is off.
    if !enabled {
        return (0..instances.len())
            .map(|i| VisibleInstance { instance: i, ranges: vec![all(i)] })
            .collect();
    }

    // Reject whole objects through a tree over their boxes.
    let boxes: Vec<_> = instances.iter().map(|i| i.bounds).collect();
    let runs = if boxes.is_empty() {
        Vec::new()
    } else {
        let tests = &mut counters.box_tests;
        BoundsTree::new(&boxes).visible(&Frustum::from_matrix(clip_from_world), &mut |test| {
            *tests += 1;
            execution.report(|| step(test, None));
        })
    };

    let trees = session.per_mesh::<BoundsTree>();

    // Of large objects across the border, reject runs of triangles.
    let mut visible = Vec::new();
    for i in runs.into_iter().flatten().map(|i| i as usize) {
        let instance = &instances[i];
        let frustum = Frustum::from_matrix(&(*clip_from_world * instance.world_from_model));
        let ranges = if instance.mesh.triangles.len() <= 4 * TRIANGLES_A_RUN {
            vec![all(i)]
        } else {
            let mut tested = |test: &BoxTest| {
                counters.box_tests += 1;
                execution.report(|| step(test, Some(i as u32)));
            };
            // Test the object's own box first.
            let (bounds, items) = (instance.model_bounds, all(i));
            let (containment, beyond) = frustum.find_box(&bounds);
            tested(&BoxTest { bounds, items, containment, beyond });
            match containment {
                Containment::Outside => Vec::new(),
                Containment::Inside => vec![all(i)],
                Containment::Crossing => {
                    let tree = trees.get_or_build(instance.mesh_index, || {
                        let runs = &session.world.run_bounds[instance.mesh_index as usize];
                        BoundsTree::over_runs(runs, instance.mesh.triangles.len())
                    });
                    tree.visible(&frustum, &mut tested)
                }
            }
        };
        if !ranges.is_empty() || !instance.mesh.lines.is_empty() || !instance.mesh.points.is_empty()
        {
            visible.push(VisibleInstance { instance: i, ranges });
        }
    }

    // Count what was culled.
    counters.instances_culled = (instances.len() - visible.len()) as u64;
    let kept: u64 =
        visible.iter().flat_map(|v| &v.ranges).map(|r| u64::from(r.end - r.start)).sum();
    counters.triangles_culled = counters.triangles - kept;
    visible
}

/// A test of a box round objects, or round triangles of one, as a step.
fn step(test: &BoxTest, instance: Option<u32>) -> Step {
    let verdict = match test.containment {
        Containment::Outside => BoxVerdict::Outside,
        Containment::Crossing => BoxVerdict::Crossing,
        Containment::Inside => BoxVerdict::Inside,
    };
    Step::Box {
        instance,
        items: [test.items.start, test.items.end],
        min: test.bounds.min.to_array(),
        max: test.bounds.max.to_array(),
        verdict,
        beyond: test.beyond.map(|plane| Frustum::NAMES[plane]),
    }
}
