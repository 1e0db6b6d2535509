//! Shading tiles into display colours, one after the other as they are finished.

use super::behind::DeepImage;
use super::buffers::{self, BufferPlanes};
use super::collect::InFront;
use super::composite::Composer;
use super::deadline::Deadline;
use super::scratch::{Scratch, SpareScratch};
use super::shade::shade;
use super::tile_rows::TileRows;
use super::tracer::Tracer;
use super::{FrameConstants, passes};
use crate::marks::MarkColors;
use crate::stats::PictureCounters;
use crate::visible::{Peel, TileSink};
use std::sync::{Arc, Mutex};
use vitral_exec::{Budget, Limit, Workers};
use vitral_raster::{LayerList, TILE_PIXELS, Tile};

/// Shades tiles into display colours.
pub(crate) struct ColorSink<'a> {
    constants: &'a FrameConstants<'a>,
    marks: &'a MarkColors,
    tracer: Option<&'a dyn Tracer>,
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
    deadline: Deadline<'a>,
}

/// The pictures of each tile after each pass.
pub(crate) type Passes = Vec<Mutex<Vec<Vec<[u8; 4]>>>>;

/// What is shown besides the picture, a tile each.
#[derive(Default)]
pub(crate) struct Shown {
    pub passes: Passes,
    pub buffers: Vec<Mutex<BufferPlanes>>,
}

impl<'a> ColorSink<'a> {
    pub(crate) fn new(
        constants: &'a FrameConstants<'a>,
        marks: &'a MarkColors,
        tracer: Option<&'a dyn Tracer>,
        deep: Option<DeepImage<'a>>,
        tiles: TileRows<'a>,
        budget: &'a Budget,
    ) -> Self {
        Self {
            constants,
            marks,
            tracer,
            deep,
            tiles,
            passes: Vec::new(),
            buffers: Vec::new(),
            spare: SpareScratch::of(constants.view.session),
            counters: Mutex::default(),
            deadline: Deadline::new(budget),
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

    /// When all tiles were handed over: composes what was kept until the whole picture is there.
    /// Gives what else is shown.
    pub(crate) fn finish(self, workers: &Workers) -> Result<Shown, Limit> {
        self.deadline.into_result()?;
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
        if self.deadline.is_over() {
            return;
        }
        let mut scratch = self.spare.take();
        let Scratch { points, facets, lit, .. } = &mut scratch;
        let constants = self.constants;

        // Shade what is opaque, then lay one layer after the other over it.
        points.collect(tile, InFront::Samples(&[]), constants, self.marks);
        points.ground = constants.ground_shadow(tile);
        shade(points, facets, constants, lit);
        let (covered_pixels, opaque) = (points.covered_pixels, points.len() as u64);
        let shown = !self.passes.is_empty();
        let (mut pictures, layer_samples, shaded) =
            passes::compose(tile, &mut scratch, constants, self.marks, pass, shown);

        // Write the last picture, and keep the others if they are shown.
        if let Some(last) = pictures.last() {
            self.tiles.write(index, last);
        }
        if let Some(passes) = self.passes.get(index) {
            *passes.lock().expect("tile pictures") = std::mem::take(&mut pictures);
        }
        let shaded_points = opaque + shaded;
        let counters = PictureCounters {
            covered_pixels,
            shaded_points,
            layer_samples,
            ..PictureCounters::default()
        };
        self.counters.lock().expect("counters").add(&counters);
        self.spare.give_back(scratch);
    }

    fn tile(&self, index: usize, tile: &Tile, layers: &mut LayerList) {
        if self.deadline.is_over() {
            return;
        }

        // Fill a tile without a surface.
        let empty = !tile.touched && layers.sample_count() == 0 && layers.lost() == 0;
        let ground = self.constants.ground_shadow(tile);
        if empty && ground.is_empty() && self.deep.is_none() && self.buffers.is_empty() {
            self.tracer.into_iter().for_each(Tracer::tile_done);
            return self.tiles.fill(index, &self.constants.background.bytes[tile.y as usize..]);
        }

        // Collect the points. A tracer takes the first surface at each sample alone, and finds what
        // is behind it by itself.
        let mut scratch = self.spare.take();
        let Scratch { points, facets, lit, composer, picture } = &mut scratch;
        let constants = self.constants;
        let layer_samples = layers.sample_count() as u64;
        let front = self.tracer.map(|tracer| tracer.front(tile, layers, self.marks));
        let (tile, seen) = match &front {
            Some(front) => (&front.tile, InFront::Samples(&front.marked)),
            None if layers.gathers() => {
                let depths = layers.take_depths();
                (tile, InFront::Fragments(layers.fragments(), depths))
            }
            None => (tile, InFront::Samples(layers)),
        };
        points.collect(tile, seen, constants, self.marks);
        points.ground = ground;

        // Shade them.
        shade(points, facets, constants, lit);
        if let (Some(tracer), Some(front)) = (self.tracer, &front) {
            tracer.follow(front, points, lit);
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

        // Compose the tile, or keep it until the whole picture is there.
        if let Some(deep) = &self.deep {
            deep.keep(index, tile, std::mem::take(points), std::mem::take(lit));
        } else {
            picture.resize(TILE_PIXELS, [0; 4]);
            composer.compose(tile, points, lit, constants, self.marks, None, picture);
            self.tiles.write(index, picture);
            if let Some(buffers) = self.buffers.get(index) {
                *buffers.lock().expect("buffers of a tile") =
                    buffers::planes(tile, points, lit, constants, self.marks);
            }
        }
        self.spare.give_back(scratch);
    }
}
