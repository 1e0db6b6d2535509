//! Brute force: every facet is tested at every sample.
//!
//! For each sample, look at all facets; of those that cover it, the nearest is seen. This is the
//! first of the two approaches that courses begin with, and the one that nobody can get wrong: no
//! order, no coherence, no structure. The other algorithms are measured against it.
//!
//! In:   prepared draws (model space). Out: the samples of each tile (screen space).
//! Cost: samples times facets, always. It refuses what would take more than
//!       [`vitral_exec::MAX_STEPS`], and stops at the time limit.
//! Source: [Foley et al. 1990], section 15.1. Departs from it: facets that lie beside the picture
//!       or face away are dropped when they are set up, as the view says.

use super::agreement::nearer;
use super::screen_setups::ScreenSetups;
use super::sink::TileSink;
use super::tiles::{each_tile, size_in_picture};
use super::{Resolved, VisibleSurface};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::trace::{Passed, Step};
use crate::{Execution, PreparedView};
use vitral_exec::Limit;
use vitral_raster::{Layer, LayerList, SUBPIXEL, TILE, TILE_PIXELS, Tile, TileGrid};

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
        execution.budget.charged(ScreenSetups::bytes(view), "the facets on the screen", || {
            let mut resolved = Resolved::default();
            let start = execution.budget.elapsed();
            let facets = ScreenSetups::new(view, execution, &mut resolved.geometry)?;
            resolved.geometry_seconds = execution.budget.elapsed() - start;
            let pixels = u64::from(view.viewport.width) * u64::from(view.viewport.height);
            let needed =
                (pixels * view.pattern.len() as u64).saturating_mul(facets.setups.len() as u64);
            execution.budget.check_work(needed, "brute force")?;
            let look = |tile: &mut Tile, layers: &mut LayerList| {
                look(view, &facets, tile, layers, execution)
            };
            resolved.counters = each_tile(view, marks, grid, execution, sink, look)?;
            Ok(resolved)
        })
    }
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

                // Keep all layers in front of it.
                for setup in layered.iter().filter(|s| s.covers(x, y)) {
                    let (depth, facet) = (setup.depth(x, y), setup.facet);
                    if nearer((depth, facet), nearest) {
                        layers.push(Layer { at: at as u32, depth, facet });
                    }
                }
            }
        }
    }

    // Count the work and report it.
    let rays = (rows * columns * view.pattern.len()) as u64;
    let triangle_tests = rays * facets.setups.len() as u64;
    let pixels = [tile.x, tile.y, columns as u32, rows as u32];
    let (facets, tested, through) = (facets.setups.len() as u64, Vec::new(), Passed::Nowhere);
    execution.report(|| Step::Rays { pixels, rays, boxes: 0, facets, tested, through });
    Ok(VisibilityCounters { rays, triangle_tests, ..VisibilityCounters::default() })
}
