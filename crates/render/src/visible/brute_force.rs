//! Brute force: every facet is tested at every sample.
//!
//! For each sample, look at all facets; of those that cover it, the nearest is seen. This is the first of the two
//! approaches that courses begin with, and the one that nobody can get wrong: no order, no coherence, no structure.
//! The other algorithms are measured against it.
//!
//! In:   prepared draws (model space). Out: the samples of each tile (screen space).
//! Cost: samples times facets, always. It refuses what would take more than [`MOST_TESTS`], and stops at the time limit.
//! Source: [Foley et al. 1990], section 15.1. Departs from it: facets that lie beside the picture or face away are
//!       dropped when they are set up, as the view says.

use super::facets::nearer;
use super::screen_setups::{ScreenSetups, charged};
use super::zbuffer::hide_behind;
use super::{Resolved, TileSink, VisibleSurface};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::trace::{Passed, Step};
use crate::{Execution, PreparedView};
use std::sync::Mutex;
use vitral_exec::Limit;
use vitral_math::lanes::dispatch;
use vitral_raster::{Layer, LayerList, LayerSink, SUBPIXEL, TILE, TILE_PIXELS, Tile, TileGrid, traverse_by_rows};

/// Tests of a facet at a sample that are not refused: about an hour on one thread.
pub const MOST_TESTS: u64 = 1 << 40;

/// Refuses what needs more than [`MOST_TESTS`].
pub(crate) fn few_enough(needed: u64, stage: &'static str) -> Result<(), Limit> {
    if needed > MOST_TESTS { Err(Limit::Work { needed, limit: MOST_TESTS, stage }) } else { Ok(()) }
}

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct BruteForce;

impl VisibleSurface for BruteForce {
    fn resolve(
        &self,
        view: &PreparedView<'_>,
        marks: Option<&Marks>,
        grid: &mut TileGrid,
        execution: &Execution,
        sink: &dyn TileSink,
    ) -> Result<Resolved, Limit> {
        charged(&execution.budget, ScreenSetups::bytes(view), "the facets on the screen", || {
            let mut resolved = Resolved::default();
            let start = execution.budget.elapsed();
            let facets = ScreenSetups::new(view, execution, &mut resolved.geometry)?;
            resolved.geometry_seconds = execution.budget.elapsed() - start;
            let pixels = u64::from(view.viewport.width) * u64::from(view.viewport.height);
            let needed = (pixels * view.pattern.len() as u64).saturating_mul(facets.setups.len() as u64);
            few_enough(needed, "brute force")?;
            let look = |tile: &mut Tile, layers: &mut LayerList| look(view, &facets, tile, layers, execution);
            resolved.counters = each_tile(view, marks, grid, execution, sink, look)?;
            Ok(resolved)
        })
    }
}

/// Lets `look` fill each tile and its layers, adds the marks and hands the tile on. After a limit the rest is left out.
pub(super) fn each_tile(
    view: &PreparedView<'_>,
    marks: Option<&Marks>,
    grid: &mut TileGrid,
    execution: &Execution,
    sink: &dyn TileSink,
    look: impl Fn(&mut Tile, &mut LayerList) -> Result<VisibilityCounters, Limit> + Sync + Send,
) -> Result<VisibilityCounters, Limit> {
    let outcome = Mutex::new(Ok(VisibilityCounters::default()));
    execution.budget.begin("tiles", grid.tiles.len() as u64);
    execution.workers.for_each_chunk(&mut grid.tiles, 1, |index, tiles| {
        if outcome.lock().expect("counters").is_err() {
            return;
        }
        let (tile, mut layers) = (&mut tiles[0], view.layer_list());
        tile.clear();
        match look(tile, &mut layers) {
            Ok(counters) => {
                if let Some(marks) = marks {
                    add_marks(view, marks, index, tile, &mut layers, execution);
                }
                layers.finish();
                sink.tile(index, tile, &mut layers);
                execution.budget.advance();
                if let Ok(sum) = &mut *outcome.lock().expect("counters") {
                    sum.add(&counters);
                }
            }
            Err(limit) => *outcome.lock().expect("counters") = Err(limit),
        }
    });
    outcome.into_inner().expect("counters")
}

/// Tests lines and points against the finished depth.
fn add_marks(
    view: &PreparedView<'_>,
    marks: &Marks,
    index: usize,
    tile: &mut Tile,
    layers: &mut LayerList,
    execution: &Execution,
) {
    hide_behind(execution.level, &marks.hiding, index, tile, &view.pattern);
    dispatch!(execution.level, simd => {
        let place = (tile.x, tile.y);
        let mut sink = LayerSink::new(tile, &view.pattern, layers);
        for setup in marks.all.tile(index) {
            traverse_by_rows(simd, setup, place, &view.pattern, &mut sink);
        }
    });
}

/// Rows and columns of a tile that lie in the picture.
pub(super) fn size_in_picture(view: &PreparedView<'_>, tile: &Tile) -> (usize, usize) {
    let inside = |size: u32, start: u32| TILE.min((size - start) as usize);
    (inside(view.viewport.height, tile.y), inside(view.viewport.width, tile.x))
}

/// Fills a tile, sample by sample.
fn look(
    view: &PreparedView<'_>,
    facets: &ScreenSetups,
    tile: &mut Tile,
    layers: &mut LayerList,
    execution: &Execution,
) -> Result<VisibilityCounters, Limit> {
    let (opaque, layered) = facets.setups.split_at(facets.opaque);
    let (rows, columns) = size_in_picture(view, tile);
    for row in 0..rows {
        execution.budget.check("brute force")?;
        for column in 0..columns {
            for sample in 0..view.pattern.len() {
                let [sx, sy] = view.pattern.position(sample);
                let x = (tile.x as i32 + column as i32) * SUBPIXEL + sx;
                let y = (tile.y as i32 + row as i32) * SUBPIXEL + sy;
                let at = sample * TILE_PIXELS + row * TILE + column;

                // The nearest of all opaque facets stays, and all others in front of it.
                let mut nearest = (tile.depth[at], tile.facet[at]);
                for setup in opaque.iter().filter(|s| s.covers(x, y)) {
                    let candidate = (setup.depth(x, y), setup.facet);
                    if nearer(candidate, nearest) {
                        nearest = candidate;
                        tile.touched = true;
                    }
                }
                (tile.depth[at], tile.facet[at]) = nearest;
                for setup in layered.iter().filter(|s| s.covers(x, y)) {
                    let (depth, facet) = (setup.depth(x, y), setup.facet);
                    if nearer((depth, facet), nearest) {
                        layers.push(Layer { at: at as u32, depth, facet });
                    }
                }
            }
        }
    }
    let rays = (rows * columns * view.pattern.len()) as u64;
    let triangle_tests = rays * facets.setups.len() as u64;
    let pixels = [tile.x, tile.y, columns as u32, rows as u32];
    let (facets, through) = (facets.setups.len() as u64, Passed::Nowhere);
    execution.tell(|| Step::Rays { pixels, rays, boxes: 0, facets, through });
    Ok(VisibilityCounters { rays, triangle_tests, ..VisibilityCounters::default() })
}
