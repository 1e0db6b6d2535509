//! What all algorithms do with tiles: fill each, add the marks, hand it on, and count.

use super::Peel;
use super::sink::TileSink;
use super::walk::{collect_layers, hide_behind};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::{Execution, PreparedView};
use std::sync::Mutex;
use vitral_exec::Limit;
use vitral_raster::{Batch, LayerList, SamplePattern, TILE, Tile, TileGrid, Viewport};

/// The counters of the tiles that are finished, or the limit that stopped the work.
pub(super) struct Outcome(Mutex<Result<VisibilityCounters, Limit>>);

impl Outcome {
    pub(super) fn new() -> Self {
        Self(Mutex::new(Ok(VisibilityCounters::default())))
    }

    /// Whether a limit was reached: then the rest of the tiles is left out.
    pub(super) fn is_limit(&self) -> bool {
        self.0.lock().expect("no thread panics while it counts").is_err()
    }

    /// Adds what some tiles took; of several limits the first is kept.
    pub(super) fn add(&self, counted: Result<VisibilityCounters, Limit>) {
        let mut outcome = self.0.lock().expect("no thread panics while it counts");
        match (&mut *outcome, counted) {
            (Ok(sum), Ok(counters)) => sum.add(&counters),
            (Ok(_), Err(limit)) => *outcome = Err(limit),
            (Err(_), _) => {}
        }
    }

    pub(super) fn into_result(self) -> Result<VisibilityCounters, Limit> {
        self.0.into_inner().expect("no thread panics while it counts")
    }
}

/// Lets `look` fill each tile and its layers, adds the marks and hands the tile on. After a limit
/// the rest is left out.
pub(super) fn each_tile(
    view: &PreparedView<'_>,
    marks: Option<&Marks>,
    grid: &mut TileGrid,
    execution: &Execution,
    sink: &dyn TileSink,
    look: impl Fn(&mut Tile, &mut LayerList) -> Result<VisibilityCounters, Limit> + Sync + Send,
) -> Result<VisibilityCounters, Limit> {
    let outcome = Outcome::new();
    execution.budget.begin("tiles", grid.tiles.len() as u64);
    execution.workers.for_each_chunk(&mut grid.tiles, 1, |index, tiles| {
        if outcome.is_limit() || !view.makes_tile(index) {
            return;
        }
        let (tile, mut layers) = (&mut tiles[0], view.layer_list());
        tile.clear();
        let counted = look(tile, &mut layers);
        if counted.is_ok() {
            // Test lines and points against the finished depth.
            if let Some(marks) = marks {
                hide_behind((execution.level, None), &marks.hiding, index, tile, &view.pattern);
                collect_layers(
                    execution.level,
                    &marks.all,
                    index,
                    tile,
                    &view.pattern,
                    &mut layers,
                );
            }
            layers.finish();
            sink.tile(index, tile, &mut layers);
            execution.budget.advance();
        }
        outcome.add(counted);
    });
    outcome.into_result()
}

/// Hands a tile on to a sink that asks for its layers pass by pass, which walk `layered`. Passes
/// end early at a limit: check the budget when all tiles are handed on.
pub(super) fn hand_on_in_passes<'b>(
    view: &PreparedView<'_>,
    execution: &Execution,
    layered: impl Iterator<Item = &'b Batch> + Clone,
    index: usize,
    tile: &Tile,
    sink: &dyn TileSink,
) {
    let go_on = || execution.budget.check(PASSES).is_ok();
    let mut pass = |peel: &mut Peel| {
        go_on() && peel.pass(execution.level, layered.clone(), index, tile, &view.pattern)
    };
    sink.tile_in_passes(index, tile, &mut pass);
}

/// The stage of passes, for the budget.
pub(super) const PASSES: &str = "passes over layers";

/// The first pixel of a tile.
pub(crate) fn tile_origin(view: &PreparedView<'_>, index: usize) -> (u32, u32) {
    let columns = view.viewport.tiles_x();
    (index as u32 % columns * TILE as u32, index as u32 / columns * TILE as u32)
}

/// Rows and columns of a tile that lie in the picture.
pub(super) fn size_in_picture(view: &PreparedView<'_>, tile: &Tile) -> (usize, usize) {
    let inside = |size: u32, start: u32| TILE.min((size - start) as usize);
    (inside(view.viewport.height, tile.y), inside(view.viewport.width, tile.x))
}

/// Smallest and largest x, then y, of a pattern's samples within the pixel.
pub(super) fn extent(pattern: &SamplePattern) -> [[i32; 2]; 2] {
    [0, 1].map(|axis| {
        let values = (0..pattern.len()).map(|s| pattern.position(s)[axis]);
        values.fold([i32::MAX, i32::MIN], |[low, high], v| [low.min(v), high.max(v)])
    })
}

/// Puts a facet into a sample, `at` its index in the tile's planes.
#[inline]
pub(super) fn put(tile: &mut Tile, at: usize, (depth, facet): (f32, u32)) {
    tile.depth[at] = depth;
    tile.facet[at] = facet;
    tile.touched = true;
}

/// Lends `f` a tile as someone left it, or an empty one.
pub(crate) fn with_spare(spare: &Mutex<Vec<Tile>>, samples: usize, f: impl FnOnce(&mut Tile)) {
    let used = spare.lock().expect("spare tiles").pop();
    let mut tile = used.filter(|tile| tile.samples() == samples).unwrap_or_else(|| {
        let side = TILE as u32;
        let one = TileGrid::new(Viewport { width: side, height: side }, samples);
        let mut tile = one.tiles.into_iter().next().expect("one tile");
        tile.clear();
        tile
    });
    f(&mut tile);
    spare.lock().expect("spare tiles").push(tile);
}
