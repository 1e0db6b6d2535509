//! How many facets cover each pixel, for who looks on at the z-buffer.

use super::tiles::size_in_picture;
use crate::trace::Step;
use crate::{Execution, PreparedView};
use std::sync::Mutex;
use vitral_raster::{Batch, SUBPIXEL, Tile};

/// Counts for each pixel of each tile; none where nobody looks on.
pub(super) struct Overdraw(Vec<Mutex<Vec<u32>>>);

impl Overdraw {
    pub(super) fn new(tiles: usize, execution: &Execution) -> Self {
        let watched = if execution.observer.is_some() { tiles } else { 0 };
        Self((0..watched).map(|_| Mutex::default()).collect())
    }

    /// Adds for each pixel of a tile how many opaque facets of these batches cover its first sample.
    pub(super) fn count(&self, view: &PreparedView<'_>, batches: &[(bool, Batch)], index: usize, tile: &Tile) {
        let Some(counts) = self.0.get(index) else { return };
        let mut counts = counts.lock().expect("counts");
        let (rows, columns) = size_in_picture(view, tile);
        counts.resize(rows * columns, 0);
        let [sx, sy] = view.pattern.position(0);
        let setups = batches.iter().filter(|(layered, _)| !layered).flat_map(|(_, batch)| batch.tile(index));
        for setup in setups {
            for (i, count) in counts.iter_mut().enumerate() {
                let x = (tile.x as i32 + (i % columns) as i32) * SUBPIXEL + sx;
                let y = (tile.y as i32 + (i / columns) as i32) * SUBPIXEL + sy;
                *count += u32::from(setup.covers(x, y));
            }
        }
    }

    /// Reports the step of a finished tile.
    pub(super) fn report(&self, view: &PreparedView<'_>, execution: &Execution, index: usize, tile: &Tile) {
        let Some(counts) = self.0.get(index) else { return };
        let (rows, columns) = size_in_picture(view, tile);
        let pixels = [tile.x, tile.y, columns as u32, rows as u32];
        let facets = std::mem::take(&mut *counts.lock().expect("counts"));
        execution.tell(|| Step::Tile { pixels, facets });
    }
}
