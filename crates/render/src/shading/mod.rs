//! Colouring what is visible: one pass over the samples of each tile, eight points at a time.
//!
//! A *point* is a facet in a pixel: however many samples of the pixel show it, it is illuminated once, at the pixel's
//! centre, or at the middle of its samples where it does not fill the pixel. Points of one object and material go
//! through the formulas together.
//!
//! In:   a tile's facets and depths. Out: display colours, straight alpha.
//! Cost: linear in points, times the number of lights.

pub mod flat;
pub mod gouraud;
pub mod phong;

mod behind;
mod buffers;
mod channels;
mod composite;
mod corners;
mod depth_cue;
mod facets;
mod frame_constants;
mod geometry;
mod glow;
mod group;
pub(crate) mod hits;
mod lighting;
mod listed;
mod looks;
mod passes;
mod points;
mod shadowed;
mod together;

pub(crate) use buffers::{BYTES_A_PIXEL, BufferPlanes};
pub(crate) use channels::{ChannelSink, DataPlanes};
pub use corners::LitCorner;
pub(crate) use corners::lit_corners;
pub use flat::FaceTable;
pub(crate) use frame_constants::{BackgroundKey, BackgroundRows, DecodeTables, FrameConstants};

pub(crate) use behind::DeepImage;

use composite::Composer;
pub(crate) use depth_cue::Fade;
pub(crate) use group::{Bounce, Lit, shade_hits};
pub(crate) use points::{InFront, Points};

use facets::FacetTable;
use std::convert::Infallible;
use std::sync::{Arc, Mutex};
use vitral_exec::{Limit, Workers};
use vitral_math::lanes::dispatch;
use vitral_raster::{LayerList, TILE, TILE_PIXELS, Tile, Viewport};

use crate::global::{Whitted, whitted::Forest};
use crate::marks::MarkColors;
use crate::stats::PictureCounters;
use crate::visible::{Peel, TileSink};
use crate::{Cached, Reuse};

/// Shades tiles into display colours.
pub(crate) struct ColorSink<'a> {
    constants: &'a FrameConstants<'a>,
    marks: &'a MarkColors,
    tracer: Option<&'a Whitted<'a>>,
    /// Keeps tiles that need the whole picture to be composed.
    deep: Option<DeepImage<'a>>,
    /// Where the rows of each tile go.
    tiles: TileRows<'a>,
    /// What each pass made of each tile, the opaque tile first; empty where nobody asked.
    passes: Passes,
    /// The buffers of each tile in the two-buffer order; empty where nobody asked.
    buffers: Vec<Mutex<BufferPlanes>>,
    /// The session's.
    spare: Arc<SpareScratch>,
    counters: Mutex<PictureCounters>,
}

/// The pictures of each tile after each pass.
pub(crate) type Passes = Vec<Mutex<Vec<Vec<[u8; 4]>>>>;

/// What is shown besides the picture, a tile each.
#[derive(Default)]
pub(crate) struct Shown {
    pub passes: Passes,
    pub buffers: Vec<Mutex<BufferPlanes>>,
}

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
                row.chunks_mut(TILE).zip(&mut tiles[first..]).for_each(|(part, tile)| tile.push(part));
            }
        }
        Self { tiles: tiles.into_iter().map(Mutex::new).collect() }
    }

    fn len(&self) -> usize {
        self.tiles.len()
    }

    /// Writes the picture of a whole tile, once.
    fn write(&self, index: usize, tile: &[[u8; 4]]) {
        self.take(index)
            .into_iter()
            .zip(tile.chunks(TILE))
            .for_each(|(row, of_tile)| row.copy_from_slice(&of_tile[..row.len()]));
    }

    /// [`Self::write`] of a tile whose rows have one colour each.
    fn fill(&self, index: usize, colors: &[[u8; 4]]) {
        for (row, color) in self.take(index).into_iter().zip(colors) {
            row.fill(*color);
        }
    }

    fn take(&self, index: usize) -> Vec<&'a mut [[u8; 4]]> {
        let rows = std::mem::take(&mut *self.tiles[index].lock().expect("rows of a tile"));
        assert!(!rows.is_empty(), "tile {index} is finished only once");
        rows
    }

    /// Nothing may be left from what the memory was used for before.
    fn check(&self) {
        let written = |tile: &Mutex<Vec<_>>| tile.lock().is_ok_and(|rows| rows.is_empty());
        assert!(self.tiles.iter().all(written), "every tile is finished");
    }
}

/// Memory of one tile's work, used again for the next.
#[derive(Default)]
pub(crate) struct Scratch {
    points: Points,
    facets: FacetTable,
    lit: Lit,
    forest: Forest,
    composer: Composer,
    picture: Vec<[u8; 4]>,
}

/// Scratch memory of finished tiles, for the next ones.
#[derive(Default)]
struct SpareScratch(Mutex<Vec<Scratch>>);

impl Cached for SpareScratch {
    type Key = ();
    const REUSE: Reuse = Reuse::Session;
}

impl SpareScratch {
    fn take(&self) -> Scratch {
        self.0.lock().expect("spare scratch").pop().unwrap_or_default()
    }

    fn give_back(&self, scratch: Scratch) {
        self.0.lock().expect("spare scratch").push(scratch);
    }
}

impl std::fmt::Debug for Scratch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scratch").finish_non_exhaustive()
    }
}

impl<'a> ColorSink<'a> {
    pub(crate) fn new(
        constants: &'a FrameConstants<'a>,
        marks: &'a MarkColors,
        tracer: Option<&'a Whitted<'a>>,
        deep: Option<DeepImage<'a>>,
        tiles: TileRows<'a>,
    ) -> Self {
        let Ok(spare) = constants.view.session.cache.get_or_build((), || Ok::<_, Infallible>(SpareScratch::default()));
        Self {
            constants,
            marks,
            tracer,
            deep,
            tiles,
            passes: Vec::new(),
            buffers: Vec::new(),
            spare,
            counters: Mutex::default(),
        }
    }

    /// Keeps what each pass makes of each tile.
    pub(crate) fn show_passes(&mut self) {
        self.passes = (0..self.tiles.len()).map(|_| Mutex::default()).collect();
    }

    /// Keeps the two buffers of each tile.
    pub(crate) fn show_buffers(&mut self) {
        self.buffers = (0..self.tiles.len()).map(|_| Mutex::default()).collect();
    }

    pub(crate) fn counters(&self) -> PictureCounters {
        *self.counters.lock().expect("counters")
    }

    /// When all tiles were handed over: composes what was kept until the whole picture is there. Gives what else is shown.
    pub(crate) fn finish(self, workers: &Workers) -> Result<Shown, Limit> {
        let shown = Shown { passes: self.passes, buffers: self.buffers };
        let Some(deep) = self.deep else {
            self.tiles.check();
            return Ok(shown);
        };
        let deep = deep.finish()?;
        let tiles = self.tiles;
        let composed = workers.map(tiles.len(), |index| {
            deep.check()?;
            let Some((tile, points, lit)) = deep.tile(index) else { return Ok(()) };
            let (mut composer, mut picture) = (Composer::default(), vec![[0; 4]; TILE_PIXELS]);
            let (constants, marks, whole) = (self.constants, self.marks, Some((&deep, index)));
            composer.compose(tile, points, &lit, constants, marks, whole, &mut picture);
            tiles.write(index, &picture);
            Ok(())
        });
        composed.into_iter().collect::<Result<(), Limit>>()?;
        tiles.check();
        Ok(shown)
    }
}

impl TileSink for ColorSink<'_> {
    fn keeps_tiles(&self) -> bool {
        false
    }

    fn takes_passes(&self) -> bool {
        self.constants.in_passes && self.tracer.is_none()
    }

    fn takes_fragments(&self) -> bool {
        self.tracer.is_none()
    }

    fn tile_in_passes(&self, index: usize, tile: &Tile, pass: &mut dyn FnMut(&mut Peel) -> bool) {
        let mut scratch = self.spare.take();
        let Scratch { points, facets, lit, .. } = &mut scratch;
        let constants = self.constants;
        points.collect(tile, InFront::Samples(&[]), constants, self.marks);
        lit.reset(points.len(), constants);
        dispatch!(constants.level, simd => group::shade_all(simd, points, facets, constants, lit));
        let (covered_pixels, opaque) = (points.covered_pixels, points.len() as u64);
        let shown = !self.passes.is_empty();
        let (mut pictures, layer_samples, shaded) = self.compose_in_passes(tile, &mut scratch, pass, shown);
        if let Some(last) = pictures.last() {
            self.tiles.write(index, last);
        }
        if let Some(passes) = self.passes.get(index) {
            *passes.lock().expect("tile pictures") = std::mem::take(&mut pictures);
        }
        let shaded_points = opaque + shaded;
        let counters = PictureCounters { covered_pixels, shaded_points, layer_samples, ..PictureCounters::default() };
        self.counters.lock().expect("counters").add(&counters);
        self.spare.give_back(scratch);
    }

    fn tile(&self, index: usize, tile: &Tile, layers: &mut LayerList) {
        let empty = !tile.touched && layers.sample_count() == 0 && layers.lost() == 0;
        if empty && self.deep.is_none() && self.buffers.is_empty() {
            self.tracer.into_iter().for_each(Whitted::tile_done);
            return self.tiles.fill(index, &self.constants.background.bytes[tile.y as usize..]);
        }
        let mut scratch = self.spare.take();
        let Scratch { points, facets, lit, forest, composer, picture } = &mut scratch;
        let constants = self.constants;
        let layer_samples = layers.sample_count() as u64;
        let front = self.tracer.map(|tracer| tracer.frontmost(tile, layers, self.marks));
        let (tile, seen) = match &front {
            Some(front) => (&front.tile, InFront::Samples(&front.marked)),
            None if layers.gathers() => {
                let depths = layers.take_depths();
                (tile, InFront::Fragments(layers.fragments(), depths))
            }
            None => (tile, InFront::Samples(layers)),
        };
        points.collect(tile, seen, constants, self.marks);
        lit.reset(points.len(), constants);
        dispatch!(constants.level, simd => group::shade_all(simd, points, facets, constants, lit));
        if let (Some(tracer), Some(front)) = (self.tracer, &front) {
            tracer.follow(front, points, lit, forest);
            tracer.tile_done();
        }
        let counters = PictureCounters {
            pixels: 0,
            covered_pixels: points.covered_pixels,
            shaded_points: points.len() as u64,
            layer_samples,
            lost_layers: layers.lost(),
            overruled_layers: points.overruled,
        };
        self.counters.lock().expect("counters").add(&counters);
        if let Some(deep) = &self.deep {
            deep.keep(index, tile, std::mem::take(points), std::mem::take(lit));
        } else {
            picture.resize(TILE_PIXELS, [0; 4]);
            composer.compose(tile, points, lit, constants, self.marks, None, picture);
            self.tiles.write(index, picture);
            if let Some(buffers) = self.buffers.get(index) {
                *buffers.lock().expect("buffers of a tile") = self.buffers(tile, points, lit);
            }
        }
        self.spare.give_back(scratch);
    }
}
