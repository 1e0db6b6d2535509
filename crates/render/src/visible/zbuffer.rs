//! The z-buffer: every sample keeps the nearest facet that covers it.
//!
//! Triangles come in any order. For each covered sample their depth is compared with the depth that
//! the sample holds; the nearer one stays. Here the picture is cut into tiles of 64x64 pixels whose
//! samples fit in the second-level cache, and stay there if nobody keeps them; triangles are sorted
//! into the tiles they touch, a few hundred thousand at a time (`front_end.rs`), and each tile is
//! then walked by one thread (`round_tiles.rs`, `walk.rs`). Blocks of 8x8 pixels remember how far
//! their farthest sample is, so that hidden triangles are rejected without looking at samples; what
//! seems nearer is drawn first. Transparent facets are not tested against each other but collected,
//! after all opaque ones.
//!
//! In:   prepared draws (model space). Out: the samples of each tile (screen space).
//! Cost: linear in vertices, triangles and covered samples; memory: the samples and one round of
//!       triangles.
//! Source: [Catmull 1974], [Straßer 1974]; hierarchical depth after [Greene et al. 1993]. Departs
//! from them: equal depths go to the lower facet, so the order of triangles cannot be seen.

use super::front_end::{DrawOrder, FrontEnd, give_back};
use super::round_tiles::{Round, RoundTiles};
use super::sink::TileSink;
use super::tiles::with_spare;
use super::{Resolved, VisibleSurface};
use crate::marks::Marks;
use crate::{Execution, PreparedView};
use vitral_exec::Limit;
use vitral_raster::{TileGrid, TileLists};

/// The stage, for the budget.
const STAGE: &str = "visibility";

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct ZBuffer;

impl VisibleSurface for ZBuffer {
    fn resolve(
        &self,
        view: &PreparedView<'_>,
        marks: Option<&Marks>,
        grid: &mut TileGrid,
        execution: &Execution,
        sink: &dyn TileSink,
    ) -> Result<Resolved, Limit> {
        // Cut the view into rounds.
        let mut resolved = Resolved::default();
        let mut front_end = FrontEnd::new(view, execution);
        let mut tiles = RoundTiles::new(view, marks, execution, sink, grid.tiles.len());
        let rounds = front_end.rounds();
        execution.budget.begin("rounds of triangles", rounds.len() as u64);
        for (number, round) in rounds.iter().enumerate() {
            execution.budget.check(STAGE)?;

            // Bring the round's triangles to the screen, sorted by tile.
            let start = execution.budget.elapsed();
            front_end.transform(round.clone());
            let batches = front_end.set_up(round.clone(), DrawOrder::NearFirst, TileLists::Copied);
            resolved.geometry_seconds += execution.budget.elapsed() - start;
            front_end.retire(round.clone());

            // Draw them, tile by tile; the last round finishes the tiles.
            let round =
                Round { batches, is_first: number == 0, is_last: number + 1 == rounds.len() };
            execution.workers.for_each_chunk(&mut grid.tiles, 1, |index, tile| {
                // At a limit the rest of the tiles is left out.
                if !view.makes_tile(index) || execution.budget.check(STAGE).is_err() {
                    return;
                }
                if sink.keeps_tiles() || rounds.len() > 1 {
                    tiles.draw(&round, index, &mut tile[0]);
                } else {
                    with_spare(&view.session.spare_tiles, view.pattern.len(), |spare| {
                        (spare.x, spare.y) = (tile[0].x, tile[0].y);
                        tiles.draw(&round, index, spare);
                    });
                }
            });
            execution.budget.check(STAGE)?;
            give_back(view.session, tiles.keep_layers(round.batches)?);
            execution.budget.advance();
        }
        resolved.geometry = front_end.stats;
        Ok(resolved)
    }
}
