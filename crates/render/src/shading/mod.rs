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
mod channels;
mod composite;
mod facets;
mod frame_constants;
mod geometry;
mod glow;
mod group;
pub(crate) mod hits;
mod listed;
mod looks;
mod passes;
mod points;
mod shadowed;

pub(crate) use channels::{ChannelSink, DataPlanes};
pub use flat::FaceTable;
pub(crate) use frame_constants::{DecodeTables, FrameConstants};

pub(crate) use behind::DeepImage;

use composite::Composer;
pub(crate) use group::{Bounce, Lit, shade_hits};
pub(crate) use points::{InFront, Points};

use facets::FacetTable;
use std::sync::Mutex;
use vitral_exec::{Limit, Workers};
use vitral_math::lanes::{Level, dispatch};
use vitral_raster::{LayerList, TILE_PIXELS, Tile};

use crate::global::{Whitted, whitted::Forest};
use crate::marks::MarkColors;
use crate::stats::PictureCounters;
use crate::visible::{Peel, TileSink};

/// Shades tiles into display colours.
pub(crate) struct ColorSink<'a> {
    constants: &'a FrameConstants<'a>,
    marks: &'a MarkColors,
    tracer: Option<&'a Whitted<'a>>,
    /// Keeps tiles that need the whole picture to be composed.
    deep: Option<DeepImage<'a>>,
    level: Level,
    /// One picture for each tile, row by row within the tile.
    pub tiles: Vec<Mutex<Vec<[u8; 4]>>>,
    /// What each pass made of each tile, the opaque tile first; empty where nobody asked.
    pub passes: Vec<Mutex<Vec<Vec<[u8; 4]>>>>,
    spare: Mutex<Vec<Scratch>>,
    counters: Mutex<PictureCounters>,
}

/// Pictures of all tiles, and after each pass.
type Pictures = (Vec<Mutex<Vec<[u8; 4]>>>, Vec<Mutex<Vec<Vec<[u8; 4]>>>>);

/// Memory of one tile's work, used again for the next.
#[derive(Default)]
struct Scratch {
    points: Points,
    facets: FacetTable,
    lit: Lit,
    forest: Forest,
    composer: Composer,
}

impl<'a> ColorSink<'a> {
    pub(crate) fn new(
        constants: &'a FrameConstants<'a>,
        marks: &'a MarkColors,
        tracer: Option<&'a Whitted<'a>>,
        deep: Option<DeepImage<'a>>,
        level: Level,
        tile_count: usize,
    ) -> Self {
        Self {
            constants,
            marks,
            tracer,
            deep,
            level,
            tiles: (0..tile_count).map(|_| Mutex::default()).collect(),
            passes: Vec::new(),
            spare: Mutex::default(),
            counters: Mutex::default(),
        }
    }

    /// Keeps what each pass makes of each tile.
    pub(crate) fn show_passes(&mut self) {
        self.passes = (0..self.tiles.len()).map(|_| Mutex::default()).collect();
    }

    pub(crate) fn counters(&self) -> PictureCounters {
        *self.counters.lock().expect("counters")
    }

    /// Composes what was kept until the whole picture is there. Gives the tiles, finished.
    pub(crate) fn finish(self, workers: &Workers) -> Result<Pictures, Limit> {
        let Some(deep) = self.deep else { return Ok((self.tiles, self.passes)) };
        let deep = deep.finish()?;
        let (level, tiles) = (self.level, self.tiles);
        let composed = workers.map(tiles.len(), |index| {
            deep.check()?;
            let Some((tile, points, mut lit)) = deep.tile(index) else { return Ok(()) };
            let (mut composer, mut picture) = (Composer::default(), vec![[0; 4]; TILE_PIXELS]);
            let (constants, marks, whole) = (self.constants, self.marks, Some((&deep, index)));
            dispatch!(level, simd => composer.compose(simd, tile, points, &mut lit, constants, marks, whole, &mut picture));
            *tiles[index].lock().expect("tile picture") = picture;
            Ok(())
        });
        composed.into_iter().collect::<Result<(), Limit>>()?;
        Ok((tiles, self.passes))
    }
}

impl TileSink for ColorSink<'_> {
    fn takes_passes(&self) -> bool {
        self.constants.in_passes && self.tracer.is_none()
    }

    fn takes_fragments(&self) -> bool {
        self.tracer.is_none()
    }

    fn tile_in_passes(&self, index: usize, tile: &Tile, pass: &mut dyn FnMut(&mut Peel) -> bool) {
        let mut scratch = self.spare.lock().expect("spare scratch").pop().unwrap_or_default();
        let Scratch { points, facets, lit, .. } = &mut scratch;
        let constants = self.constants;
        points.collect(tile, InFront::Samples(&[]), constants, self.marks);
        lit.reset(points.len(), constants);
        dispatch!(self.level, simd => group::shade_all(simd, points, facets, constants, lit));
        let (covered_pixels, opaque) = (points.covered_pixels, points.len() as u64);
        let shown = !self.passes.is_empty();
        let (mut pictures, layer_samples, shaded) = self.compose_in_passes(tile, &mut scratch, pass, shown);
        if let Some(last) = pictures.last() {
            self.tiles[index].lock().expect("tile picture").clone_from(last);
        }
        if let Some(passes) = self.passes.get(index) {
            *passes.lock().expect("tile pictures") = std::mem::take(&mut pictures);
        }
        let shaded_points = opaque + shaded;
        let counters = PictureCounters { covered_pixels, shaded_points, layer_samples, ..PictureCounters::default() };
        self.counters.lock().expect("counters").add(&counters);
        self.spare.lock().expect("spare scratch").push(scratch);
    }

    fn tile(&self, index: usize, tile: &Tile, layers: &mut LayerList) {
        let mut scratch = self.spare.lock().expect("spare scratch").pop().unwrap_or_default();
        let Scratch { points, facets, lit, forest, composer } = &mut scratch;
        let constants = self.constants;
        let layer_samples = layers.sample_count() as u64;
        let front = self.tracer.map(|tracer| tracer.frontmost(tile, layers, self.marks));
        let (tile, seen) = match &front {
            Some((tile, marked)) => (tile, InFront::Samples(marked)),
            None if layers.gathers() => {
                let depths = layers.take_depths();
                (tile, InFront::Fragments(layers.fragments(), depths))
            }
            None => (tile, InFront::Samples(layers)),
        };
        points.collect(tile, seen, constants, self.marks);
        lit.reset(points.len(), constants);
        dispatch!(self.level, simd => group::shade_all(simd, points, facets, constants, lit));
        if let Some(tracer) = self.tracer {
            tracer.follow(points, lit, forest);
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
            let mut picture = vec![[0; 4]; TILE_PIXELS];
            let marks = self.marks;
            dispatch!(self.level, simd => composer.compose(simd, tile, points, lit, constants, marks, None, &mut picture));
            *self.tiles[index].lock().expect("tile picture") = picture;
        }
        self.spare.lock().expect("spare scratch").push(scratch);
    }
}
