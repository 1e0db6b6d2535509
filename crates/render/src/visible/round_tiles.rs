//! Tiles that are drawn in rounds of triangles: their state between rounds, and how a
//! round changes one.
//!
//! In:   batches of set-up triangles (screen space). Out: the samples of each tile, handed on after
//!       the last round.
//! Cost: linear in triangles and covered samples; memory: the layers of all rounds.

use super::front_end::BYTES_A_TRIANGLE;
use super::overdraw::Overdraw;
use super::sink::{TileSink, layer_list};
use super::tiles::{PASSES, hand_on_in_passes};
use super::walk::{hide_behind, walk, walk_integer};
use crate::marks::Marks;
use crate::{Execution, PreparedView};
use std::sync::Mutex;
use vitral_exec::{Budget, Limit};
use vitral_raster::{Batch, LayerList, Tile};

/// Triangles that are set up together.
pub(super) struct Round {
    /// Sorted by tile, and whether they are layers.
    pub(super) batches: Vec<(bool, Batch)>,
    pub(super) is_first: bool,
    pub(super) is_last: bool,
}

/// What is known of the tiles between rounds, besides their samples.
pub(super) struct RoundTiles<'a> {
    view: &'a PreparedView<'a>,
    marks: Option<&'a Marks>,
    execution: &'a Execution,
    sink: &'a dyn TileSink,
    /// Of each tile.
    layers: Vec<Mutex<LayerList>>,
    overdraw: Overdraw,
    /// What passes go through, of all rounds.
    kept: KeptLayers<'a>,
}

impl<'a> RoundTiles<'a> {
    pub(super) fn new(
        view: &'a PreparedView<'a>,
        marks: Option<&'a Marks>,
        execution: &'a Execution,
        sink: &'a dyn TileSink,
        count: usize,
    ) -> Self {
        let layers = (0..count).map(|_| Mutex::new(layer_list(view, sink))).collect();
        let (overdraw, kept) =
            (Overdraw::new(count, execution), KeptLayers::new(&execution.budget));
        Self { view, marks, execution, sink, layers, overdraw, kept }
    }

    /// Draws a round's triangles into a tile; after the last round draws the marks and hands the
    /// tile on.
    pub(super) fn draw(&self, round: &Round, index: usize, tile: &mut Tile) {
        // Empty the tile before the first round.
        if round.is_first {
            tile.clear();
        }
        let (view, level, passes) = (self.view, self.execution.level, self.sink.takes_passes());
        let mut layers = self.layers[index].lock().expect("no thread panics while it holds layers");
        self.overdraw.come(view, self.execution, &round.batches, index, tile);

        // Let marks hide the samples behind them, then walk the triangles. Layers that are asked
        // for in passes wait.
        let marks = self.marks.filter(|_| round.is_last);
        if let Some(marks) = marks {
            hide_behind((level, view.depth_bits), &marks.hiding, index, tile, &view.pattern);
        }
        let batches = round.batches.iter().map(|(layered, batch)| (*layered, batch));
        let batches = batches.chain(marks.map(|marks| (true, &marks.all)));
        let batches: Vec<_> = batches.filter(|(layered, _)| !(passes && *layered)).collect();
        match view.depth_bits {
            None => walk(level, &batches, index, tile, &view.pattern, &mut layers),
            Some(bits) => {
                walk_integer((level, bits), &batches, index, tile, &view.pattern, &mut layers)
            }
        }

        // Hand the finished tile on.
        if round.is_last {
            if passes {
                let here =
                    round.batches.iter().filter(|(layered, _)| *layered).map(|(_, batch)| batch);
                let layered =
                    self.kept.batches.iter().chain(here).chain(marks.map(|marks| &marks.all));
                hand_on_in_passes(view, self.execution, layered, index, tile, self.sink);
            } else {
                layers.finish();
                self.sink.tile(index, tile, &mut layers);
            }
        }
    }

    /// Keeps the layers of a round for passes to go through and returns the other batches.
    pub(super) fn keep_layers(
        &mut self,
        batches: Vec<(bool, Batch)>,
    ) -> Result<Vec<(bool, Batch)>, Limit> {
        if !self.sink.takes_passes() {
            return Ok(batches);
        }
        self.execution.budget.check(PASSES)?;
        self.kept.keep(batches)
    }
}

/// Layers of earlier rounds, which passes over a finished tile go through, charged to the budget.
struct KeptLayers<'e> {
    batches: Vec<Batch>,
    charged: u64,
    budget: &'e Budget,
}

impl<'e> KeptLayers<'e> {
    fn new(budget: &'e Budget) -> Self {
        Self { batches: Vec::new(), charged: 0, budget }
    }

    /// Keeps the layers and gives the rest back.
    fn keep(&mut self, batches: Vec<(bool, Batch)>) -> Result<Vec<(bool, Batch)>, Limit> {
        let (layered, rest): (Vec<_>, Vec<_>) =
            batches.into_iter().partition(|(layered, _)| *layered);
        for (_, batch) in layered {
            let bytes = batch.counters.tile_entries * BYTES_A_TRIANGLE;
            self.budget.charge(bytes, "layers to go through")?;
            self.charged += bytes;
            self.batches.push(batch);
        }
        Ok(rest)
    }
}

impl Drop for KeptLayers<'_> {
    fn drop(&mut self) {
        self.budget.release(self.charged);
    }
}
