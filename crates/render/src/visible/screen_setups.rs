//! All facets of a view on the screen, for algorithms that pick them one by one.

use super::front_end::{DrawOrder, FrontEnd, give_back, triangle_count};
use crate::stats::GeometryStats;
use crate::{Execution, PreparedView};
use vitral_exec::Limit;
use vitral_raster::{Setup, TileLists};

/// The pieces of facets that may be seen, those of one facet in a row.
#[derive(Debug, Default)]
pub(super) struct ScreenSetups {
    /// Opaque ones, then those that become layers.
    pub setups: Vec<Setup>,
    /// How many are opaque.
    pub opaque: usize,
    /// Runs `(end, clipped)` of `setups`: whether one of the run may be a piece of a clipped facet,
    /// which takes its depth plane from another piece.
    pub runs: Vec<(usize, bool)>,
}

impl ScreenSetups {
    /// Bytes that a view's facets take, at most, unless many are clipped into pieces.
    pub(super) fn bytes(view: &PreparedView<'_>) -> u64 {
        // Once in batches, once here.
        triangle_count(view) * (2 * size_of::<Setup>()) as u64
    }

    /// Transforms, culls, clips and sets up, as for the z-buffer.
    pub(super) fn new(
        view: &PreparedView<'_>,
        execution: &Execution,
        stats: &mut GeometryStats,
    ) -> Result<Self, Limit> {
        // Transform and set up the whole view in one round.
        execution.budget.check("geometry")?;
        let mut front_end = FrontEnd::new(view, execution);
        let round = front_end.whole();
        front_end.transform(round.clone());
        execution.budget.check("geometry")?;
        let batches = front_end.set_up(round, DrawOrder::Scene, TileLists::Unwanted);
        *stats = front_end.stats;

        // Join the batches, opaque ones first.
        let mut all = Self::default();
        for (layered, batch) in &batches {
            all.setups.extend_from_slice(batch.setups());
            all.runs.push((all.setups.len(), batch.counters.clipped > 0));
            if !layered {
                all.opaque = all.setups.len();
            }
        }
        give_back(view.session, batches);
        Ok(all)
    }
}
