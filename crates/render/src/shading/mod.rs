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

mod channels;
mod composite;
mod facets;
mod frame_constants;
mod geometry;
mod group;
pub(crate) mod hits;
mod looks;
mod points;
mod shadowed;

pub(crate) use channels::{ChannelSink, DataPlanes};
pub use flat::FaceTable;
pub(crate) use frame_constants::{DecodeTables, FrameConstants};

use composite::Composer;
pub(crate) use group::{Bounce, Lit, shade_hits};
pub(crate) use points::Points;

use facets::FacetTable;
use std::sync::Mutex;
use vitral_math::lanes::{Level, dispatch};
use vitral_raster::{LayerList, TILE_PIXELS, Tile};

use crate::global::{Whitted, whitted::Forest};
use crate::marks::MarkColors;
use crate::stats::PictureCounters;
use crate::visible::TileSink;

/// Shades tiles into display colours.
pub(crate) struct ColorSink<'a> {
    constants: &'a FrameConstants<'a>,
    marks: &'a MarkColors,
    tracer: Option<&'a Whitted<'a>>,
    level: Level,
    /// One picture for each tile, row by row within the tile.
    pub tiles: Vec<Mutex<Vec<[u8; 4]>>>,
    spare: Mutex<Vec<Scratch>>,
    counters: Mutex<PictureCounters>,
}

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
        level: Level,
        tile_count: usize,
    ) -> Self {
        Self {
            constants,
            marks,
            tracer,
            level,
            tiles: (0..tile_count).map(|_| Mutex::default()).collect(),
            spare: Mutex::default(),
            counters: Mutex::default(),
        }
    }

    pub(crate) fn counters(&self) -> PictureCounters {
        *self.counters.lock().expect("counters")
    }
}

impl TileSink for ColorSink<'_> {
    fn tile(&self, index: usize, tile: &Tile, layers: &mut LayerList) {
        let mut scratch = self.spare.lock().expect("spare scratch").pop().unwrap_or_default();
        let Scratch { points, facets, lit, forest, composer } = &mut scratch;
        let constants = self.constants;
        let front = self.tracer.map(|tracer| tracer.frontmost(tile, layers, self.marks));
        let (tile, seen) = front.as_ref().map_or((tile, &layers[..]), |(tile, marked)| (tile, marked));
        points.collect(tile, seen, constants, self.marks);
        lit.reset(points.len(), constants);
        dispatch!(self.level, simd => group::shade_all(simd, points, facets, constants, lit));
        if let Some(tracer) = self.tracer {
            tracer.follow(points, lit, forest);
        }
        let mut picture = vec![[0; 4]; TILE_PIXELS];
        dispatch!(self.level, simd => composer.compose(simd, tile, points, lit, constants, self.marks, &mut picture));
        *self.tiles[index].lock().expect("tile picture") = picture;
        let counters = PictureCounters {
            pixels: 0,
            covered_pixels: points.covered_pixels,
            shaded_points: points.len() as u64,
            layer_samples: layers.len() as u64,
            lost_layers: layers.lost(),
        };
        self.counters.lock().expect("counters").add(&counters);
        self.spare.lock().expect("spare scratch").push(scratch);
    }
}
