//! The z-buffer for views whose tiles nobody needs afterwards: shadow maps, hemicubes.
//!
//! All tiles are filled in the same memory, one after the other, and tiles that no triangle touches
//! are passed over.
//!
//! In:   prepared draws (model space). Out: the samples of each tile (screen space).
//! Cost: that of the z-buffer, less the tiles without triangles.
//! Source: that of the z-buffer.

use super::VisibleSurface;
use super::front_end::{all_batches, give_back, touching};
use super::sink::{TileSink, layer_list};
use super::tiles::{tile_origin, with_spare};
use super::walk::walk;
use super::zbuffer::ZBuffer;
use crate::{Execution, PreparedView};
use std::sync::Mutex;
use vitral_exec::Limit;
use vitral_raster::{Batch, Tile, TileGrid};

/// Resolves a view without marks and hands each tile to `sink` unless nothing is in it. The samples
/// are those that [`ZBuffer`] finds. Only the top `rows` of tiles need be.
pub(crate) fn resolve_in_passing(
    view: &PreparedView<'_>,
    rows: u32,
    execution: &Execution,
    sink: &dyn TileSink,
) -> Result<(), Limit> {
    // Draw one tile in spare memory and hand it on if something is in it.
    let spare: Mutex<Vec<Tile>> = Mutex::default();
    let tile = |index: usize, batches: &[(bool, &Batch)]| {
        with_spare(&spare, view.pattern.len(), |tile| {
            tile.clear();
            (tile.x, tile.y) = tile_origin(view, index);
            let mut layers = layer_list(view, sink);
            walk(execution.level, batches, index, tile, &view.pattern, &mut layers);
            layers.finish();
            if tile.touched || !layers.is_empty() {
                sink.tile(index, tile, &mut layers);
            }
        });
    };
    if each_touched_tile(view, rows, execution, tile)? {
        return Ok(());
    }

    // Tiles must wait for more triangles.
    let bytes = TileGrid::bytes(view.viewport, view.pattern.len());
    execution.budget.charged(bytes, "a z-buffer", || {
        let mut grid = TileGrid::new(view.viewport, view.pattern.len());
        ZBuffer.resolve(view, None, &mut grid, execution, sink).map(|_| ())
    })
}

/// Calls `tile` with the number of each tile of the top `rows` that triangles touch, and the
/// batches that hold them: whether they are layers, in order. From any thread. Gives `false` and
/// does nothing where there are too many triangles to be set up at once.
fn each_touched_tile(
    view: &PreparedView<'_>,
    rows: u32,
    execution: &Execution,
    tile: impl Fn(usize, &[(bool, &Batch)]) + Sync + Send,
) -> Result<bool, Limit> {
    let Some(batches) = all_batches(view, execution)? else { return Ok(false) };
    let numbers = 0..view.viewport.tiles_x() * rows.min(view.viewport.tiles_y());
    execution.workers.for_each(numbers.collect(), |number: u32| {
        let touching = touching(&batches, number as usize);
        if !touching.is_empty() {
            tile(number as usize, &touching);
        }
    });
    give_back(view.session, batches);
    Ok(true)
}
