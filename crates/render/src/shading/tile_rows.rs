//! The rows of each tile within the picture.

use std::sync::Mutex;
use vitral_raster::{TILE, Viewport};

/// A picture cut into its tiles, so that each can be written by whoever finishes it.
pub(crate) struct TileRows<'a> {
    tiles: Vec<Mutex<Vec<&'a mut [[u8; 4]]>>>,
}

impl<'a> TileRows<'a> {
    /// Cuts `picture`, row by row, the top row first.
    pub(crate) fn new(viewport: Viewport, picture: &'a mut [[u8; 4]]) -> Self {
        let mut tiles = Vec::new();
        for band in picture.chunks_mut(viewport.width as usize * TILE) {
            let first = tiles.len();
            tiles.resize_with(first + viewport.tiles_x() as usize, || Vec::with_capacity(TILE));
            for row in band.chunks_mut(viewport.width as usize) {
                row.chunks_mut(TILE)
                    .zip(&mut tiles[first..])
                    .for_each(|(part, tile)| tile.push(part));
            }
        }
        Self { tiles: tiles.into_iter().map(Mutex::new).collect() }
    }

    pub(super) fn len(&self) -> usize {
        self.tiles.len()
    }

    /// Writes the picture of a whole tile, once.
    pub(super) fn write(&self, index: usize, tile: &[[u8; 4]]) {
        self.take(index)
            .into_iter()
            .zip(tile.chunks(TILE))
            .for_each(|(row, of_tile)| row.copy_from_slice(&of_tile[..row.len()]));
    }

    /// [`Self::write`] of a tile whose rows have one colour each.
    pub(super) fn fill(&self, index: usize, colors: &[[u8; 4]]) {
        for (row, color) in self.take(index).into_iter().zip(colors) {
            row.fill(*color);
        }
    }

    fn take(&self, index: usize) -> Vec<&'a mut [[u8; 4]]> {
        let rows = std::mem::take(&mut *self.tiles[index].lock().expect("rows of a tile"));
        assert!(!rows.is_empty(), "tile {index} is finished only once");
        rows
    }

    /// Every tile must be written, since the memory holds another picture at first.
    pub(super) fn check(&self) {
        let written = |tile: &Mutex<Vec<_>>| tile.lock().is_ok_and(|rows| rows.is_empty());
        assert!(self.tiles.iter().all(written), "every tile is finished");
    }
}
