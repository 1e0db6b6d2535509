//! Targets, stored tile by tile: a tile's planes lie together in memory and belong to one worker at
//! a time.

use crate::{BLOCK, MAX_SIDE, NO_FACET, TILE, TILE_PIXELS};

/// Size of a picture in pixels, both sides `1..=MAX_SIDE`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Viewport {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Viewport {
    /// `None` if a side is 0 or larger than [`MAX_SIDE`].
    pub fn new(width: u32, height: u32) -> Option<Self> {
        let fits = |side| (1..=MAX_SIDE).contains(&side);
        (fits(width) && fits(height)).then_some(Self { width, height })
    }

    /// Tiles in a row of tiles.
    pub fn tiles_x(&self) -> u32 {
        self.width.div_ceil(TILE as u32)
    }

    /// Rows of tiles.
    pub fn tiles_y(&self) -> u32 {
        self.height.div_ceil(TILE as u32)
    }
}

/// The samples of 64x64 pixels. Within a plane the index is `sample * TILE_PIXELS + y * TILE + x`.
/// A new tile has no memory until it is [`clear`](Self::clear)ed: who works on it touches it first,
/// and tiles that nobody works on cost nothing.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Left pixel column of the tile in the picture.
    pub x: u32,
    /// Top pixel row.
    pub y: u32,
    /// Depth of each sample, 0 where nothing is.
    pub depth: Vec<f32>,
    /// Facet of each sample, [`NO_FACET`] where nothing is.
    pub facet: Vec<u32>,
    /// For each 8x8 block, a depth that none of its samples is farther than.
    pub block_far: [f32; TILE_PIXELS / (BLOCK * BLOCK)],
    /// Whether any sample was written since the tile was cleared.
    pub touched: bool,
    /// Samples in each plane.
    planes: usize,
    /// Samples written in each block since `block_far` was computed.
    pub(crate) block_writes: [u32; TILE_PIXELS / (BLOCK * BLOCK)],
}

impl Tile {
    fn new(x: u32, y: u32, samples: usize) -> Self {
        Self {
            x,
            y,
            depth: Vec::new(),
            facet: Vec::new(),
            planes: samples * TILE_PIXELS,
            block_far: [0.0; TILE_PIXELS / (BLOCK * BLOCK)],
            touched: false,
            block_writes: [0; TILE_PIXELS / (BLOCK * BLOCK)],
        }
    }

    /// Samples a pixel.
    pub fn samples(&self) -> usize {
        self.planes / TILE_PIXELS
    }

    /// Empties the tile; free if nothing was written.
    pub fn clear(&mut self) {
        if self.facet.is_empty() {
            self.depth.resize(self.planes, 0.0);
            self.facet.resize(self.planes, NO_FACET);
        }
        if !self.touched {
            return;
        }
        self.touched = false;
        self.depth.fill(0.0);
        self.facet.fill(NO_FACET);
        self.block_far.fill(0.0);
        self.block_writes.fill(0);
    }
}

/// All tiles of a picture, row by row.
#[derive(Clone, Debug)]
pub struct TileGrid {
    viewport: Viewport,
    samples: usize,
    /// The tiles; tile `(tx, ty)` has the index `ty * tiles_x + tx`.
    pub tiles: Vec<Tile>,
}

impl TileGrid {
    /// Empty tiles for `samples` samples a pixel.
    pub fn new(viewport: Viewport, samples: usize) -> Self {
        let place = |i: u32| {
            ((i % viewport.tiles_x()) * TILE as u32, (i / viewport.tiles_x()) * TILE as u32)
        };
        let count = viewport.tiles_x() * viewport.tiles_y();
        let tiles = (0..count).map(|i| Tile::new(place(i).0, place(i).1, samples)).collect();
        Self { viewport, samples, tiles }
    }

    /// Size of the picture.
    pub fn viewport(&self) -> Viewport {
        self.viewport
    }

    /// Samples a pixel.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Bytes that a grid of this size takes.
    pub fn bytes(viewport: Viewport, samples: usize) -> u64 {
        u64::from(viewport.tiles_x() * viewport.tiles_y())
            * (samples * TILE_PIXELS * 8 + size_of::<Tile>()) as u64
    }

    /// The tile that holds pixel `(x, y)`, and the pixel's index in one of its planes.
    ///
    /// # Panics
    /// If the pixel lies outside the viewport.
    pub fn locate(&self, x: u32, y: u32) -> (&Tile, usize) {
        assert!(
            x < self.viewport.width && y < self.viewport.height,
            "pixel ({x}, {y}) is outside the picture"
        );
        let side = TILE as u32;
        let tile = &self.tiles[(y / side * self.viewport.tiles_x() + x / side) as usize];
        (tile, ((y % side) * side + x % side) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_the_picture() {
        let viewport = Viewport::new(65, 64).unwrap();
        let grid = TileGrid::new(viewport, 2);
        assert_eq!(grid.tiles.len(), 2);
        assert_eq!((grid.locate(64, 3).0.x, grid.locate(64, 3).1), (64, 192));
        assert_eq!(Viewport::new(0, 5), None);
        assert_eq!(Viewport::new(5, MAX_SIDE + 1), None);
    }
}
