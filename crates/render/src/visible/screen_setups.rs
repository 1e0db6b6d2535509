//! All facets of a view on the screen, for algorithms that pick them one by one.

use super::zbuffer::{jobs, set_up, transform_vertices};
use crate::stats::GeometryStats;
use crate::{Execution, PreparedView};
use vitral_exec::{Budget, Limit};
use vitral_raster::{ScreenVertex, Setup, TileLists};

/// The pieces of facets that may be seen, those of one facet in a row.
#[derive(Debug, Default)]
pub(super) struct ScreenSetups {
    /// Opaque ones, then those that become layers.
    pub setups: Vec<Setup>,
    /// How many are opaque.
    pub opaque: usize,
    /// Runs `(end, clipped)` of `setups`: whether one of the run may be a piece of a clipped facet, which takes its
    /// depth plane from another piece.
    pub runs: Vec<(usize, bool)>,
}

impl ScreenSetups {
    /// Bytes that a view's facets take, at most, unless many are clipped into pieces.
    pub(super) fn bytes(view: &PreparedView<'_>) -> u64 {
        let draws = view.instances.iter().flat_map(|i| i.opaque.iter().chain(&i.layered));
        let triangles: u64 = draws.flat_map(|d| &d.ranges).map(|r| u64::from(r.end - r.start)).sum();
        // Once in batches, once here.
        triangles * (2 * size_of::<Setup>()) as u64
    }

    /// Transforms, culls, clips and sets up, as for the z-buffer.
    pub(super) fn new(
        view: &PreparedView<'_>,
        execution: &Execution,
        stats: &mut GeometryStats,
    ) -> Result<Self, Limit> {
        execution.budget.check("geometry")?;
        let jobs = jobs(view);
        let mut vertices: Vec<Vec<ScreenVertex>> = view.instances.iter().map(|_| Vec::new()).collect();
        transform_vertices(view, &jobs, &mut vertices, execution, stats);
        execution.budget.check("geometry")?;
        let batches = set_up(view, &jobs, &vertices, TileLists::Unwanted, execution);
        let mut all = Self::default();
        for (layered, batch) in &batches {
            stats.add(&batch.counters);
            all.setups.extend_from_slice(batch.setups());
            all.runs.push((all.setups.len(), batch.counters.clipped > 0));
            if !layered {
                all.opaque = all.setups.len();
            }
        }
        view.session.spare_batches.lock().expect("spare batches").extend(batches.into_iter().map(|(_, batch)| batch));
        view.session.spare_vertices.lock().expect("spare vertices").extend(vertices);
        Ok(all)
    }
}

/// Runs `work` while `bytes` are charged.
pub(crate) fn charged<R>(
    budget: &Budget,
    bytes: u64,
    stage: &'static str,
    work: impl FnOnce() -> Result<R, Limit>,
) -> Result<R, Limit> {
    budget.charge(bytes, stage)?;
    let result = work();
    budget.release(bytes);
    result
}
