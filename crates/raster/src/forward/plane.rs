//! Planes of samples, stored in tiles of 64x64 pixels that are cleared lazily.

use super::pending::PendingDepth;
use crate::{TILE, TILE_PIXELS, Viewport};

/// A tile's samples. Index: `sample * TILE_PIXELS + (y % 64) * TILE + x % 64`.
#[derive(Clone, Debug, PartialEq)]
pub enum PlaneTile<T> {
    /// Every sample has this value.
    Cleared(T),
    /// One value a sample.
    Stored(Box<[T]>),
}

/// A plane of `width x height` pixels with `samples` values each.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane<T> {
    viewport: Viewport,
    samples: usize,
    /// Row by row, lowest first.
    pub tiles: Vec<PlaneTile<T>>,
}

impl<T: Copy> Plane<T> {
    /// A plane full of `value`; no memory is taken for samples until they are written.
    pub fn new(viewport: Viewport, samples: usize, value: T) -> Self {
        let count = (viewport.tiles_x() * viewport.tiles_y()) as usize;
        Self { viewport, samples, tiles: (0..count).map(|_| PlaneTile::Cleared(value)).collect() }
    }

    /// Size in pixels.
    pub fn viewport(&self) -> Viewport {
        self.viewport
    }

    /// Samples a pixel.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Sets every sample; frees the tiles' memory.
    pub fn clear(&mut self, value: T) {
        for tile in &mut self.tiles {
            *tile = PlaneTile::Cleared(value);
        }
    }

    fn locate(&self, x: u32, y: u32, sample: usize) -> (usize, usize) {
        let side = TILE as u32;
        debug_assert!(x < self.viewport.width && y < self.viewport.height && sample < self.samples);
        let tile = (y / side * self.viewport.tiles_x() + x / side) as usize;
        (tile, sample * TILE_PIXELS + ((y % side) * side + x % side) as usize)
    }

    /// One sample.
    pub fn get(&self, x: u32, y: u32, sample: usize) -> T {
        let (tile, at) = self.locate(x, y, sample);
        match &self.tiles[tile] {
            PlaneTile::Cleared(value) => *value,
            PlaneTile::Stored(values) => values[at],
        }
    }

    /// Sets one sample.
    pub fn set(&mut self, x: u32, y: u32, sample: usize, value: T) {
        let (tile, at) = self.locate(x, y, sample);
        self.tiles[tile].stored(self.samples)[at] = value;
    }

    /// Copies `out.len()` pixels' sample `sample` from row `y`, beginning at `x`.
    pub fn read_row(&self, x: u32, y: u32, sample: usize, out: &mut [T]) {
        let mut done = 0;
        while done < out.len() {
            let here = x + done as u32;
            let run = (TILE - here as usize % TILE).min(out.len() - done);
            let (tile, at) = self.locate(here, y, sample);
            match &self.tiles[tile] {
                PlaneTile::Cleared(value) => out[done..done + run].fill(*value),
                PlaneTile::Stored(values) => out[done..done + run].copy_from_slice(&values[at..at + run]),
            }
            done += run;
        }
    }

    /// Sets all samples of the pixels from `(x, y)` on to the right.
    pub fn write_row(&mut self, x: u32, y: u32, values: &[T]) {
        let samples = self.samples;
        let mut done = 0;
        while done < values.len() {
            let here = x + done as u32;
            let run = (TILE - here as usize % TILE).min(values.len() - done);
            let (tile, at) = self.locate(here, y, 0);
            let stored = self.tiles[tile].stored(samples);
            for s in 0..samples {
                let at = at + s * TILE_PIXELS;
                stored[at..at + run].copy_from_slice(&values[done..done + run]);
            }
            done += run;
        }
    }
}

impl<T: Copy> PlaneTile<T> {
    /// The samples, made from the clear value if there are none yet.
    pub fn stored(&mut self, samples: usize) -> &mut [T] {
        if let PlaneTile::Cleared(value) = *self {
            *self = PlaneTile::Stored(vec![value; samples * TILE_PIXELS].into_boxed_slice());
        }
        match self {
            PlaneTile::Stored(values) => values,
            PlaneTile::Cleared(_) => unreachable!("just stored"),
        }
    }
}

/// Colour samples.
#[derive(Clone, Debug, PartialEq)]
pub enum ColorPlane {
    /// Red in the lowest byte, alpha in the highest.
    Rgba8(Plane<u32>),
    /// Floating point, not clamped in storage.
    RgbaF32(Plane<[f32; 4]>),
}

/// Depth samples: `scale` times the depth in 0..=1, whole numbers unless `scale` is 1 (floating-point depth).
#[derive(Debug)]
pub struct DepthPlane {
    /// The samples, before what is pending.
    pub(crate) plane: Plane<f32>,
    /// 1 for floating point, else `2^bits - 1`.
    pub scale: f32,
    /// It is a texture's: passes that draw depth alone may leave it pending, since few of its texels may ever be read.
    pub sampled: bool,
    pub(crate) pending: Option<Box<PendingDepth>>,
}

impl Clone for DepthPlane {
    /// A copy of a plane without pending triangles, see [`Self::resolved`].
    fn clone(&self) -> Self {
        debug_assert!(self.pending.is_none(), "resolve the plane first");
        Self { plane: self.plane.clone(), scale: self.scale, sampled: self.sampled, pending: None }
    }
}

impl DepthPlane {
    /// A plane of samples and their scale.
    pub fn new(plane: Plane<f32>, scale: f32) -> Self {
        Self { plane, scale, sampled: false, pending: None }
    }

    /// Size in pixels.
    pub fn viewport(&self) -> Viewport {
        self.plane.viewport()
    }

    /// Samples a pixel.
    pub fn samples(&self) -> usize {
        self.plane.samples()
    }

    /// All samples; nothing may be pending, see [`Self::resolved`].
    pub fn plane(&self) -> &Plane<f32> {
        debug_assert!(self.pending.is_none(), "resolve the plane first");
        &self.plane
    }

    /// All samples, after drawing what is pending.
    pub fn resolved(&mut self) -> &mut Plane<f32> {
        if let Some(pending) = self.pending.take() {
            pending.resolve(&mut self.plane, self.scale);
        }
        &mut self.plane
    }
}

/// Stencil samples.
pub type StencilPlane = Plane<u8>;
