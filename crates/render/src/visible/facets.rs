//! All facets of a view at once, for algorithms that look at several facets before they decide.
//!
//! The z-buffer takes triangles a few hundred thousand at a time and forgets them; algorithms that
//! sort, subdivide or sweep need them together. Here all draws of a view are brought to the screen
//! and set up, opaque ones apart from the layers, with their lists by tile and by row of tiles. The
//! frame of such an algorithm is the same each time, too: fill some tiles with opaque facets,
//! collect the layers and marks in front, hand the tiles on ([`fill_tiles`]).
//!
//! In:   prepared draws (model space). Out: set-up triangles (screen space).
//! Cost: linear in vertices and triangles; memory: all triangles, charged to the budget before they
//!       are set up.

use super::Resolved;
use super::front_end::{BYTES_A_TRIANGLE, DrawOrder, FrontEnd, triangle_count};
use super::sink::{TileSink, layer_list};
use super::tiles::{Outcome, PASSES, hand_on_in_passes};
use super::walk::{hide_behind, walk};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::{Execution, PreparedView};
use std::sync::OnceLock;
use vitral_exec::Limit;
use vitral_raster::{Batch, LayerList, SUBPIXEL, Setup, TILE, Tile, TileGrid, TileLists};

/// The set-up triangles of a view. A facet that was clipped has several, with one depth plane.
pub(super) struct Facets<'v, 'a> {
    view: &'v PreparedView<'a>,
    execution: &'v Execution,
    opaque: Vec<Batch>,
    layered: Vec<Batch>,
    /// For each row of tiles the opaque triangles that may have samples in it: batch and index in
    /// the batch. Once asked.
    rows: OnceLock<Vec<Vec<[u32; 2]>>>,
    charged: u64,
}

impl<'v, 'a> Facets<'v, 'a> {
    /// Brings the view's triangles to the screen, and counts that in `resolved`.
    pub(super) fn new(
        view: &'v PreparedView<'a>,
        execution: &'v Execution,
        resolved: &mut Resolved,
    ) -> Result<Self, Limit> {
        Self::with_lists(view, execution, resolved, TileLists::Kept)
    }

    /// [`Self::new`] without lists by tile: nobody looks at samples.
    pub(super) fn without_tiles(
        view: &'v PreparedView<'a>,
        execution: &'v Execution,
    ) -> Result<Self, Limit> {
        Self::with_lists(view, execution, &mut Resolved::default(), TileLists::Unwanted)
    }

    fn with_lists(
        view: &'v PreparedView<'a>,
        execution: &'v Execution,
        resolved: &mut Resolved,
        lists: TileLists,
    ) -> Result<Self, Limit> {
        // Charge for the triangles.
        let start = execution.budget.elapsed();
        let charged = triangle_count(view) * BYTES_A_TRIANGLE;
        execution.budget.charge(charged, "the view's facets")?;
        let rows = OnceLock::new();
        let mut facets =
            Self { view, execution, opaque: Vec::new(), layered: Vec::new(), rows, charged };

        // Set up all rounds and keep their batches.
        let mut front_end = FrontEnd::new(view, execution);
        for round in front_end.rounds() {
            execution.budget.check("the view's facets")?;
            front_end.transform(round.clone());
            for (layered, batch) in front_end.set_up(round.clone(), DrawOrder::Scene, lists) {
                let list = if layered { &mut facets.layered } else { &mut facets.opaque };
                list.push(batch);
            }
            front_end.retire(round);
        }
        resolved.geometry = front_end.stats;
        resolved.geometry_seconds = execution.budget.elapsed() - start;
        Ok(facets)
    }

    /// Lists the opaque triangles by the rows of tiles that their box touches.
    fn sort_by_row(&self) -> Vec<Vec<[u32; 2]>> {
        let tile_rows = self.view.viewport.tiles_y() as i32;
        let mut rows = vec![Vec::new(); tile_rows as usize];
        // A sample lies below the top of its pixel and above its bottom: the tile of its y is the
        // tile of its pixel.
        let row = |y: i32| y.div_euclid(TILE as i32 * SUBPIXEL);
        for (b, batch) in self.opaque.iter().enumerate() {
            for (i, setup) in batch.setups().iter().enumerate() {
                let [y0, y1, y2] = setup.y;
                let (first, last) =
                    (row(y0.min(y1).min(y2)).max(0), row(y0.max(y1).max(y2)).min(tile_rows - 1));
                for r in first..=last {
                    rows[r as usize].push([b as u32, i as u32]);
                }
            }
        }
        rows
    }

    /// The opaque triangles that may have samples in a row of tiles.
    pub(super) fn in_row(&self, row: usize) -> impl ExactSizeIterator<Item = &Setup> {
        let rows = self.rows.get_or_init(|| self.sort_by_row());
        rows[row]
            .iter()
            .map(|&[batch, index]| &self.opaque[batch as usize].setups()[index as usize])
    }

    /// All opaque triangles, those of a face one after the other.
    pub(super) fn opaque(&self) -> impl Iterator<Item = &Setup> {
        self.opaque.iter().flat_map(Batch::setups)
    }

    /// All triangles, opaque ones first, those of a face one after the other.
    pub(super) fn all(&self) -> impl Iterator<Item = &Setup> {
        self.opaque.iter().chain(&self.layered).flat_map(Batch::setups)
    }

    /// The triangles that take part in a list by depth, those of a clipped facet one after the
    /// other, and how many of them are opaque: these come first, then the layers, where they are to
    /// be drawn by a list.
    pub(super) fn listed(&self) -> (Vec<&Setup>, usize) {
        let mut setups: Vec<_> = self.opaque.iter().flat_map(Batch::setups).collect();
        let opaque = setups.len();
        if self.view.lists_layers {
            setups.extend(self.layered.iter().flat_map(Batch::setups));
        }
        (setups, opaque)
    }

    /// The view.
    pub(super) fn view(&self) -> &'v PreparedView<'a> {
        self.view
    }

    /// Limits and threads.
    pub(super) fn execution(&self) -> &'v Execution {
        self.execution
    }

    /// Collects what lies in front of a tile's finished opaque samples, and hands the tile on.
    fn finish(
        &self,
        index: usize,
        tile: &mut Tile,
        marks: Option<&Marks>,
        sink: &dyn TileSink,
        collect: Option<&Collect<'_>>,
    ) {
        // Let marks hide what lies behind them.
        let (level, pattern) = (self.execution.level, &self.view.pattern);
        if let Some(marks) = marks {
            hide_behind((level, None), &marks.hiding, index, tile, pattern);
        }

        // Hand the layers on in passes if the sink takes them so.
        let all = marks.map(|m| &m.all);
        if sink.takes_passes() {
            let layered = self.layered.iter().chain(all);
            return hand_on_in_passes(self.view, self.execution, layered, index, tile, sink);
        }

        // Otherwise collect them in a list, and hand the tile on.
        let mut layers = layer_list(self.view, sink);
        let mut layered = self.layered.as_slice();
        if let Some(collect) = collect.filter(|_| self.view.lists_layers) {
            collect(self, index, tile, &mut layers);
            layered = &[];
        }
        let in_front: Vec<_> = layered.iter().chain(all).map(|batch| (true, batch)).collect();
        walk(level, &in_front, index, tile, pattern, &mut layers);
        layers.finish();
        sink.tile(index, tile, &mut layers);
    }
}

impl Drop for Facets<'_, '_> {
    fn drop(&mut self) {
        let batches = self.opaque.drain(..).chain(self.layered.drain(..));
        if let Ok(mut spare) = self.view.session.spare_batches.lock() {
            spare.extend(batches);
        }
        self.execution.budget.release(self.charged);
    }
}

/// Collects the layers in front of a tile's finished opaque samples, from back to front.
pub(super) type Collect<'f> =
    dyn Fn(&Facets<'_, '_>, usize, &Tile, &mut LayerList) + Sync + Send + 'f;

/// Fills tiles with opaque facets: all facets, index of the first tile, the tiles (empty),
/// counters.
pub(super) type Fill<'f> = dyn Fn(&Facets<'_, '_>, usize, &mut [Tile], &mut VisibilityCounters) -> Result<(), Limit>
    + Sync
    + 'f;

/// Calls `fill` for each `chunk` tiles, on all threads, and hands the tiles on.
pub(super) fn fill_tiles(
    view: &PreparedView<'_>,
    marks: Option<&Marks>,
    grid: &mut TileGrid,
    execution: &Execution,
    sink: &dyn TileSink,
    chunk: usize,
    fill: &Fill<'_>,
) -> Result<Resolved, Limit> {
    let mut resolved = Resolved::default();
    let facets = Facets::new(view, execution, &mut resolved)?;
    resolved.counters = fill_with(&facets, marks, grid, sink, chunk, fill, None)?;
    Ok(resolved)
}

/// [`fill_tiles`], of facets that are on the screen already; `collect` takes the layers by a list,
/// if there is one.
pub(super) fn fill_with(
    facets: &Facets<'_, '_>,
    marks: Option<&Marks>,
    grid: &mut TileGrid,
    sink: &dyn TileSink,
    chunk: usize,
    fill: &Fill<'_>,
    collect: Option<&Collect<'_>>,
) -> Result<VisibilityCounters, Limit> {
    // Fill and finish several tiles a job.
    let outcome = Outcome::new();
    let budget = &facets.execution.budget;
    budget.begin("tiles", grid.tiles.len() as u64);
    facets.execution.workers.for_each_chunk(&mut grid.tiles, chunk, |piece, tiles| {
        // After a limit, the rest of the pieces are passed over.
        let wanted = |tile: usize| facets.view.makes_tile(tile);
        if outcome.is_limit() || !(piece * chunk..piece * chunk + tiles.len()).any(wanted) {
            return;
        }
        tiles.iter_mut().for_each(Tile::clear);
        let (first, mut counters) = (piece * chunk, VisibilityCounters::default());
        let filled = fill(facets, first, tiles, &mut counters);
        if filled.is_ok() {
            for (i, tile) in tiles.iter_mut().enumerate().filter(|(i, _)| wanted(first + i)) {
                facets.finish(first + i, tile, marks, sink, collect);
                budget.advance();
            }
        }
        outcome.add(filled.map(|()| counters));
    });
    if sink.takes_passes() {
        // Passes end early at a limit.
        budget.check(PASSES)?;
    }
    outcome.into_result()
}
