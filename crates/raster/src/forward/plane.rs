//! Planes of samples, stored in tiles of 64x64 pixels, which are cleared and compressed by blocks.
//!
//! Source: the idea of block flags from graphics hardware, [Morein 2000].

use super::pending::PendingDepth;
use super::surface::Surface;
use crate::{BLOCK, TILE, TILE_PIXELS, Viewport};

/// A tile's samples, 64x64 pixels. Its blocks of 8x8 pixels can be cleared without being written,
/// and can hold one value for all samples of a pixel: most blocks lie inside one surface, where a
/// colour is written, blended and read once.
#[derive(Clone, Debug)]
pub struct PlaneTile<T> {
    /// Index: `sample * TILE_PIXELS + (y % 64) * TILE + x % 64`. Empty until the first sample is
    /// written.
    values: Vec<T>,
    /// What the cleared blocks hold.
    clear: T,
    /// Bit `8 * row + column` of blocks: nothing was written there since the tile was cleared.
    cleared: u64,
    /// Bits of blocks whose pixels have one value, stored as sample 0, for all samples.
    single: u64,
    /// Bits of blocks that are not stored: all of their samples are a surface's. They are not
    /// cleared.
    surfaced: u64,
    /// The surfaces, by block. Empty until there is one.
    surfaces: Vec<Option<Surface>>,
    /// How surfaces are read, once there is one.
    reading: Option<Reading<T>>,
    /// Something may have changed since [`Self::take_changed`].
    changed: bool,
}

/// What surfaces store for a sample: in a row of their block, and in all rows.
#[derive(Clone, Copy, Debug)]
struct Reading<T> {
    /// The values of a sample in a row of the block.
    row: fn(&Surface, usize, usize) -> [T; BLOCK],
    /// The values of a sample in all rows of the block.
    rows: fn(&Surface, usize) -> [[T; BLOCK]; BLOCK],
}

/// A plane of `width x height` pixels with `samples` values each.
#[derive(Clone, Debug)]
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
        Self { viewport, samples, tiles: (0..count).map(|_| PlaneTile::new(value)).collect() }
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
            *tile = PlaneTile::new(value);
        }
    }

    /// The tile of a pixel, and the pixel's place in it.
    fn locate(&self, x: u32, y: u32) -> (usize, usize) {
        let side = TILE as u32;
        debug_assert!(x < self.viewport.width && y < self.viewport.height);
        let tile = (y / side * self.viewport.tiles_x() + x / side) as usize;
        (tile, ((y % side) * side + x % side) as usize)
    }

    /// One sample.
    pub fn get(&self, x: u32, y: u32, sample: usize) -> T {
        debug_assert!(sample < self.samples);
        let (tile, at) = self.locate(x, y);
        self.tiles[tile].get(sample, at)
    }

    /// Sets one sample.
    pub fn set(&mut self, x: u32, y: u32, sample: usize, value: T) {
        debug_assert!(sample < self.samples);
        let (tile, at) = self.locate(x, y);
        self.tiles[tile].stored(self.samples)[sample * TILE_PIXELS + at] = value;
    }

    /// Copies `out.len()` pixels' sample `sample` from row `y`, beginning at `x`.
    pub fn read_row(&self, x: u32, y: u32, sample: usize, out: &mut [T]) {
        let mut done = 0;
        while done < out.len() {
            let here = x + done as u32;
            let run = (TILE - here as usize % TILE).min(out.len() - done);
            let (tile, at) = self.locate(here, y);
            self.tiles[tile].read(sample, at, &mut out[done..done + run]);
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
            let (tile, at) = self.locate(here, y);
            let stored = self.tiles[tile].stored(samples);
            for s in 0..samples {
                let at = at + s * TILE_PIXELS;
                stored[at..at + run].copy_from_slice(&values[done..done + run]);
            }
            done += run;
        }
    }
}

/// Makes one value of a pixel's four samples, for a run of pixels.
pub type Resolve<T> = fn([&[T]; 4], &mut [T]);

impl<T: Copy> PlaneTile<T> {
    /// A tile full of `value`.
    pub fn new(value: T) -> Self {
        Self {
            values: Vec::new(),
            clear: value,
            cleared: u64::MAX,
            single: 0,
            surfaced: 0,
            surfaces: Vec::new(),
            reading: None,
            changed: true,
        }
    }

    /// Whether something may have changed since this was last asked; a new tile has changed.
    pub fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.changed)
    }

    /// Notes that something may change.
    pub(crate) fn set_changed(&mut self) {
        self.changed = true;
    }

    /// The value of all samples, where nothing was written since they were cleared.
    pub fn uniform(&self) -> Option<T> {
        (self.cleared == u64::MAX).then_some(self.clear)
    }

    /// Sets every sample. A tile that is drawn to in every frame keeps its memory.
    pub fn clear(&mut self, value: T) {
        (self.clear, self.cleared, self.single, self.surfaced) = (value, u64::MAX, 0, 0);
        self.changed = true;
    }

    /// The value of a pixel's sample; `at` is the pixel's place `y * TILE + x` in the tile.
    #[inline(always)]
    pub fn get(&self, sample: usize, at: usize) -> T {
        let block = block_of(at);
        if self.cleared >> block & 1 == 1 {
            return self.clear;
        }
        if self.surfaced >> block & 1 == 1 {
            return self.row(block, sample, at / TILE % BLOCK)[at % BLOCK];
        }
        let sample = if self.single >> block & 1 == 1 { 0 } else { sample };
        self.values[sample * TILE_PIXELS + at]
    }

    /// A row of a block that is a surface.
    fn row(&self, block: usize, sample: usize, row: usize) -> [T; BLOCK] {
        match (self.reading, self.surfaces.get(block)) {
            (Some(reading), Some(Some(surface))) => (reading.row)(surface, sample, row),
            _ => [self.clear; BLOCK],
        }
    }

    /// All rows of a block that is a surface.
    fn rows(&self, block: usize, sample: usize) -> [[T; BLOCK]; BLOCK] {
        match (self.reading, self.surfaces.get(block)) {
            (Some(reading), Some(Some(surface))) => (reading.rows)(surface, sample),
            _ => [[self.clear; BLOCK]; BLOCK],
        }
    }

    /// Whether the samples of a pixel have one value in a block that is a surface.
    fn is_alike(&self, block: usize) -> bool {
        self.surface(block).is_some_and(|surface| surface.places == 1)
    }

    /// Copies a sample of the pixels of a row from place `at` on.
    pub fn read(&self, sample: usize, at: usize, out: &mut [T]) {
        let Some(last) = out.len().checked_sub(1) else { return };
        let blocks =
            u64::MAX << block_of(at) & u64::MAX >> (u64::BITS as usize - 1 - block_of(at + last));
        if (self.cleared | self.surfaced) & blocks == 0
            && (sample == 0 || self.single & blocks == 0)
        {
            // The row as it lies in memory.
            let first = sample * TILE_PIXELS + at;
            return out.copy_from_slice(&self.values[first..=first + last]);
        }

        // Fill a row that is cleared as a whole.
        if self.cleared & blocks == blocks {
            return out.fill(self.clear);
        }

        // Copy block by block, each by the form it is stored in.
        let mut done = 0;
        while done < out.len() {
            let here = at + done;
            let run = (BLOCK - here % BLOCK).min(out.len() - done);
            let (block, out) = (block_of(here), &mut out[done..done + run]);
            if self.cleared >> block & 1 == 1 {
                out.fill(self.clear);
            } else if self.surfaced >> block & 1 == 1 {
                out.copy_from_slice(
                    &self.row(block, sample, here / TILE % BLOCK)[here % BLOCK..][..run],
                );
            } else {
                let first =
                    if self.single >> block & 1 == 1 { 0 } else { sample * TILE_PIXELS } + here;
                out.copy_from_slice(&self.values[first..first + run]);
            }
            done += run;
        }
    }

    /// All samples, as [`Self::read`] would give them, to read and write.
    pub fn stored(&mut self, samples: usize) -> &mut [T] {
        self.changed = true;
        self.open(u64::MAX, false, samples).1
    }

    /// Makes the blocks of `bits` ready to be changed: cleared ones are filled. Gives how many
    /// samples of a pixel must be written, and all samples of the tile. That is one sample if what
    /// is written is the same for all (`together`), and all these blocks hold one value a pixel.
    #[inline(always)]
    pub(crate) fn open(&mut self, bits: u64, together: bool, samples: usize) -> (usize, &mut [T]) {
        // Bring all blocks to the form of stored values.
        if self.values.is_empty() {
            self.values = vec![self.clear; samples * TILE_PIXELS];
        }
        if bits & self.surfaced != 0 {
            self.write_surfaces(bits & self.surfaced, samples);
        }
        if bits & self.cleared != 0 {
            self.fill(bits & self.cleared);
        }

        // Return one value a pixel where the blocks have no more.
        if together && bits & !self.single == 0 {
            return (1, &mut self.values);
        }
        if bits & self.single != 0 {
            self.spread(bits & self.single, samples);
        }
        (samples, &mut self.values)
    }

    /// Makes a block ready to be overwritten, whatever it holds: with one value for all samples of
    /// a pixel, or each.
    #[inline(always)]
    pub(crate) fn replace(&mut self, bit: u64, together: bool, samples: usize) -> &mut [T] {
        if self.values.is_empty() {
            self.values = vec![self.clear; samples * TILE_PIXELS];
        }
        self.cleared &= !bit;
        self.surfaced &= !bit;
        self.single = if together { self.single | bit } else { self.single & !bit };
        &mut self.values
    }

    /// The surface that all samples of a block are, if they are one.
    #[inline(always)]
    pub(crate) fn surface(&self, block: usize) -> Option<&Surface> {
        if self.surfaced >> (block % (BLOCKS * BLOCKS)) & 1 == 0 {
            return None;
        }
        self.surfaces.get(block).and_then(Option::as_ref)
    }

    /// The value of a cleared block.
    #[inline(always)]
    pub(crate) fn cleared(&self, bit: u64) -> Option<T> {
        (self.cleared & bit != 0).then_some(self.clear)
    }

    #[inline(never)]
    fn fill(&mut self, bits: u64) {
        each_row(bits, |row| {
            if let Some(eight) =
                self.values.get_mut(row..).and_then(|rest| rest.first_chunk_mut::<BLOCK>())
            {
                *eight = [self.clear; BLOCK];
            }
        });
        self.cleared &= !bits;
        self.single |= bits;
    }

    /// Stores blocks that were surfaces.
    #[inline(never)]
    fn write_surfaces(&mut self, bits: u64, samples: usize) {
        let mut rest = bits;
        // Evaluate the block's plane for each sample.
        while rest != 0 {
            let block = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let stored = if self.is_alike(block) { 1 } else { samples };
            for sample in 0..stored {
                let mut rows = self.rows(block, sample).into_iter();
                each_row(1 << block, |at| {
                    if let Some(row) = rows.next() {
                        self.values[sample * TILE_PIXELS + at..][..BLOCK].copy_from_slice(&row);
                    }
                });
            }

            // Note how many samples are stored.
            self.single = if stored < samples || samples == 1 {
                self.single | 1 << block
            } else {
                self.single & !(1 << block)
            };
        }
        self.surfaced &= !bits;
    }

    #[inline(never)]
    fn spread(&mut self, bits: u64, samples: usize) {
        let (first, others) = self.values.split_at_mut(TILE_PIXELS);
        debug_assert_eq!(others.len(), (samples - 1) * TILE_PIXELS);
        each_row(bits, |row| {
            for plane in others.chunks_exact_mut(TILE_PIXELS) {
                plane[row..row + BLOCK].copy_from_slice(&first[row..row + BLOCK]);
            }
        });
        self.single &= !bits;
    }

    /// The same without what was written before it was cleared.
    pub(crate) fn copy(&self) -> Self {
        let values = if self.cleared == u64::MAX { Vec::new() } else { self.values.clone() };
        let surfaces = if self.surfaced == 0 { Vec::new() } else { self.surfaces.clone() };
        Self { values, surfaces, ..*self }
    }

    /// Takes blocks over from a tile of as many samples.
    pub(crate) fn take(&mut self, mut from: Self, blocks: u64, samples: usize)
    where
        T: PartialEq,
    {
        // There is one value for all cleared blocks of a tile.
        if from.clear != self.clear && blocks & from.cleared != 0 {
            from.open(blocks & from.cleared, true, samples);
        }

        // Copy the planes of blocks that are stored as such.
        let surfaces = blocks & from.surfaced;
        if surfaces != 0 {
            self.reading = from.reading;
            self.surfaces.resize(BLOCKS * BLOCKS, None);
            for (block, (into, surface)) in self.surfaces.iter_mut().zip(&from.surfaces).enumerate()
            {
                if surfaces >> block & 1 == 1 {
                    *into = *surface;
                }
            }
        }

        // Copy the values of the other blocks.
        let written = blocks & !from.cleared & !surfaces;
        if written != 0 {
            if self.values.is_empty() {
                self.values = vec![self.clear; samples * TILE_PIXELS];
            }
            for s in 0..samples {
                let (into, from_sample) =
                    (&mut self.values[s * TILE_PIXELS..], &from.values[s * TILE_PIXELS..]);
                each_row(if s == 0 { written } else { written & !from.single }, |row| {
                    into[row..row + BLOCK].copy_from_slice(&from_sample[row..row + BLOCK]);
                });
            }
        }

        // Take over the form of each block.
        self.surfaced = self.surfaced & !blocks | surfaces;
        self.cleared = self.cleared & !blocks | from.cleared & blocks;
        self.single = self.single & !blocks | from.single & blocks;
    }

    /// Copies everything to a tile of as many samples, or of one, for which `resolve` makes one
    /// value of a pixel's samples.
    pub fn copy_to(
        &self,
        samples: usize,
        target: &mut Self,
        target_samples: usize,
        resolve: Resolve<T>,
    ) {
        target.changed = true;

        // Copy everything as it is for the same number of samples.
        if samples == target_samples {
            target.values.clone_from(&self.values);
            (target.clear, target.cleared, target.single) = (self.clear, self.cleared, self.single);
            (target.surfaced, target.reading) = (self.surfaced, self.reading);
            target.surfaces.clone_from(&self.surfaces);
            return;
        }

        // Mark everything cleared, then write what is not.
        target.clear(self.clear);
        let written = !self.cleared;
        if written == 0 {
            return;
        }

        // Copy blocks with one value a pixel; copy a tile of such blocks at once.
        let stored = written & !self.surfaced;
        let plain = if samples == 1 { stored } else { stored & self.single };
        let values = target.replace(written, true, target_samples);
        if plain == u64::MAX {
            values[..TILE_PIXELS].copy_from_slice(&self.values[..TILE_PIXELS]);
            return;
        }
        each_row(plain, |row| {
            values[row..row + BLOCK].copy_from_slice(&self.values[row..row + BLOCK])
        });

        // Evaluate blocks that are stored as planes.
        for block in (0..BLOCKS * BLOCKS).filter(|block| self.surfaced >> block & 1 == 1) {
            let alike = samples == 1 || self.is_alike(block);
            self.copy_surface(block, if alike { 1 } else { samples }, values, resolve);
        }

        // Resolve the samples of the other blocks.
        each_row(stored & !plain, |row| {
            let sources =
                std::array::from_fn(|s| &self.values[s % samples * TILE_PIXELS + row..][..BLOCK]);
            resolve(sources, &mut values[row..row + BLOCK]);
        });
    }

    /// Writes a block that is a surface to a tile of one sample.
    fn copy_surface(&self, block: usize, samples: usize, target: &mut [T], resolve: Resolve<T>) {
        let mut row = 0;
        let first = self.rows(block, 0);
        if samples == 1 {
            return each_row(1 << block, |at| {
                target[at..at + BLOCK].copy_from_slice(&first[row]);
                row += 1;
            });
        }
        let [second, third, fourth] = [1, 2, 3].map(|s| self.rows(block, s % samples));
        each_row(1 << block, |at| {
            resolve(
                [&first[row], &second[row], &third[row], &fourth[row]],
                &mut target[at..at + BLOCK],
            );
            row += 1;
        });
    }

    /// A tile with `f` of every value; not for depths, which may not be stored.
    pub fn map<U: Copy>(&self, f: impl Fn(T) -> U) -> PlaneTile<U> {
        debug_assert!(self.reading.is_none(), "the values of a surface are not stored");
        let values = self.values.iter().map(|&v| f(v)).collect();
        PlaneTile {
            values,
            cleared: self.cleared,
            single: self.single,
            ..PlaneTile::new(f(self.clear))
        }
    }
}

impl PlaneTile<f32> {
    /// Makes all samples of a block a triangle's depths, without storing them.
    #[inline(always)]
    pub(crate) fn set_surface(&mut self, block: usize, surface: Surface) {
        if self.surfaces.is_empty() {
            self.surfaces = vec![None; BLOCKS * BLOCKS];
            self.reading = Some(Reading { row: Surface::row, rows: Surface::rows });
        }
        if let Some(place) = self.surfaces.get_mut(block) {
            *place = Some(surface);
            let bit = 1 << block;
            self.surfaced |= bit;
            self.cleared &= !bit;
        }
    }
}

/// Blocks along a tile's side.
const BLOCKS: usize = TILE / BLOCK;

/// The number of the block that the pixel at `y * TILE + x` lies in.
#[inline(always)]
fn block_of(at: usize) -> usize {
    at / (TILE * BLOCK) % BLOCKS * BLOCKS + at % TILE / BLOCK
}

/// Calls `f` with the places where the rows of eight pixels of the blocks of `bits` begin.
#[inline(always)]
fn each_row(mut bits: u64, mut f: impl FnMut(usize)) {
    while bits != 0 {
        let block = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        let first = block / BLOCKS * BLOCK * TILE + block % BLOCKS * BLOCK;
        for row in 0..BLOCK {
            f(first + row * TILE);
        }
    }
}

/// Colour samples.
#[derive(Clone, Debug)]
pub enum ColorPlane {
    /// Red in the lowest byte, alpha in the highest.
    Rgba8(Plane<u32>),
    /// Floating point, not clamped in storage.
    RgbaF32(Plane<[f32; 4]>),
}

/// Depth samples: `scale` times the depth in 0..=1, whole numbers unless `scale` is 1
/// (floating-point depth).
#[derive(Debug)]
pub struct DepthBuffer {
    /// The samples, before what is pending.
    pub(crate) plane: Plane<f32>,
    /// 1 for floating point, else `2^bits - 1`.
    pub scale: f32,
    /// It is a texture's: passes that draw depth alone may leave it pending, since few of its
    /// texels may ever be read.
    pub sampled: bool,
    pub(crate) pending: Option<Box<PendingDepth>>,
}

impl Clone for DepthBuffer {
    /// A copy of a plane without pending triangles, see [`Self::resolved`].
    fn clone(&self) -> Self {
        debug_assert!(self.pending.is_none(), "resolve the plane first");
        Self { plane: self.plane.clone(), scale: self.scale, sampled: self.sampled, pending: None }
    }
}

impl DepthBuffer {
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
            pending.resolve(&mut self.plane);
        }
        &mut self.plane
    }
}

/// Stencil samples.
pub type StencilPlane = Plane<u8>;

#[cfg(test)]
mod tests;
