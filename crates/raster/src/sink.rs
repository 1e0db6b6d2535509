//! What covered samples mean: the nearest facet, the last of a list, or all facets in front.

use crate::kernel::traverse::{Block, BlockSink};
use crate::{BLOCK, LayerList, NO_FACET, SUBPIXEL, SamplePattern, Setup, TILE, TILE_PIXELS, Tile};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Mask8, Simd, U32x8};

const LANE_OFFSETS: [f32; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// Depths of eight pixels of a row, by the operations of [`Setup::depth`].
#[inline(always)]
pub(crate) fn row_depth<S: Simd>(simd: S, setup: &Setup, x: i32, y: i32) -> F32x8<S> {
    let dy = (y - setup.origin[1]) as f32 / SUBPIXEL as f32;
    let dx = (x - setup.origin[0]) as f32 / SUBPIXEL as f32;
    // Whole pixels and 1/256 pixels below 2^15 pixels: the sum is exact.
    let dx = F32x8::from_slice(simd, &LANE_OFFSETS) + dx;
    let z = dx * setup.dz_dx + (setup.z + dy * setup.dz_dy);
    lanes::Lanes::min(lanes::Lanes::max(z, F32x8::splat(simd, setup.z_min)), F32x8::splat(simd, setup.z_max))
}

/// Eight samples of a row that a facet covers, with the facet's depth there.
struct Row<S: Simd> {
    /// Index of the first in the tile's planes.
    at: usize,
    /// A bit for each that is covered.
    covered: u64,
    z: F32x8<S>,
}

/// Goes through the rows of a block in which `masks`, one a sample, have something; the tile starts at pixel `corner`.
#[inline(always)]
fn each_row<S: Simd>(
    simd: S,
    setup: &Setup,
    (pattern, corner): (&SamplePattern, [usize; 2]),
    block: &Block,
    masks: &[u64],
    mut visit: impl FnMut(Row<S>),
) {
    for (s, &mask) in masks.iter().enumerate() {
        let [sx, sy] = pattern.position(s);
        let x = (corner[0] + block.x) as i32 * SUBPIXEL + sx;
        for row in block.rows.clone() {
            let covered = (mask >> (8 * row)) & 0xff;
            if covered == 0 {
                continue;
            }
            let y = (corner[1] + block.y + row) as i32 * SUBPIXEL + sy;
            let at = s * TILE_PIXELS + (block.y + row) * TILE + block.x;
            visit(Row { at, covered, z: row_depth(simd, setup, x, y) });
        }
    }
}

/// The tile's first pixel.
fn corner(tile: &Tile) -> [usize; 2] {
    [tile.x as usize, tile.y as usize]
}

/// What a facet met at eight samples.
struct Met<S: Simd> {
    covered: Mask8<S>,
    /// The facet is nearer than what was there; of equally near ones it is the lower.
    nearer: Mask8<S>,
    /// It is nearer and covers: it was kept.
    wins: Mask8<S>,
    old_z: F32x8<S>,
    old_facet: U32x8<S>,
}

/// Keeps the nearer facet at the samples of `row`.
#[inline(always)]
fn keep_nearer<S: Simd>(simd: S, tile: &mut Tile, facet: U32x8<S>, row: &Row<S>) -> Met<S> {
    let depths = &mut tile.depth[row.at..row.at + BLOCK];
    let facets = &mut tile.facet[row.at..row.at + BLOCK];
    let (old_z, old_facet) = (F32x8::from_slice(simd, depths), U32x8::from_slice(simd, facets));
    let covered = Mask8::from_bitmask(simd, row.covered);
    let nearer = row.z.simd_gt(old_z) | (row.z.simd_eq(old_z) & facet.simd_lt(old_facet));
    let wins = nearer & covered;
    wins.select(row.z, old_z).store_slice(depths);
    wins.select(facet, old_facet).store_slice(facets);
    Met { covered, nearer, wins, old_z, old_facet }
}

/// The z-buffer: each sample keeps the nearest facet, of equally near ones the lowest.
#[derive(Debug)]
pub struct VisibilitySink<'a> {
    tile: &'a mut Tile,
    pattern: &'a SamplePattern,
    /// Samples of a block that are written before its `block_far` is computed anew.
    patience: u32,
}

impl<'a> VisibilitySink<'a> {
    /// Draws into `tile`.
    pub fn new(tile: &'a mut Tile, pattern: &'a SamplePattern) -> Self {
        Self { tile, pattern, patience: (BLOCK * BLOCK * pattern.len()) as u32 }
    }

    /// Draws into `tile`, for someone who wants to know how far a block is as soon as it is full: facets that come from
    /// front to back fill it once.
    pub fn eager(tile: &'a mut Tile, pattern: &'a SamplePattern) -> Self {
        Self { tile, pattern, patience: 1 }
    }
}

/// Brings `block_far` up to date once `patience` samples of a block, of `samples` samples a pixel, have been written.
#[inline(always)]
fn note_writes<S: Simd>(simd: S, tile: &mut Tile, samples: usize, block: &Block, (written, patience): (u32, u32)) {
    let index = block.index();
    tile.touched |= written > 0;
    tile.block_writes[index] += written;
    if tile.block_writes[index] < patience {
        return;
    }
    tile.block_writes[index] = 0;
    let mut far = F32x8::splat(simd, f32::INFINITY);
    for s in 0..samples {
        for row in 0..BLOCK {
            let at = s * TILE_PIXELS + (block.y + row) * TILE + block.x;
            far = lanes::Lanes::min(far, F32x8::from_slice(simd, &tile.depth[at..at + BLOCK]));
        }
    }
    tile.block_far[index] = far.to_array().into_iter().fold(f32::INFINITY, f32::min);
}

impl<S: Simd> BlockSink<S> for VisibilitySink<'_> {
    #[inline(always)]
    fn rejects(&self, setup: &Setup, block: &Block) -> bool {
        setup.z_max < self.tile.block_far[block.index()]
    }

    #[inline(always)]
    fn cover(&mut self, simd: S, setup: &Setup, block: &Block, masks: &[u64]) {
        let facet = U32x8::splat(simd, setup.facet);
        let place = (self.pattern, corner(self.tile));
        let mut written = 0;
        each_row(
            simd,
            setup,
            place,
            block,
            masks,
            #[inline(always)]
            |row| written += keep_nearer(simd, self.tile, facet, &row).wins.to_bitmask().count_ones(),
        );
        note_writes(simd, self.tile, self.pattern.len(), block, (written, self.patience));
    }
}

/// What a drawing in order of priority came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PriorityCounts {
    /// Samples drawn over by something later in the list.
    pub overdrawn: u64,
    /// Samples where the depth function contradicted the list.
    pub overruled: u64,
    /// Among these, the ones with at least [`NEAR_TIE`] between the two depths.
    pub overruled_far: u64,
}

/// Depths closer than this, 2^-20 of the range, count as a near tie.
pub const NEAR_TIE: f32 = 1.0 / (1 << 20) as f32;

/// Facets in a list from back to front, each covers what is there; or from front to back, each fills what is left, and
/// blocks that are full are not looked at. The depth function has the last word: where it contradicts the list, the
/// nearer facet is kept, and that is counted.
#[derive(Debug)]
pub struct PrioritySink<'a, const FRONT_FIRST: bool> {
    tile: &'a mut Tile,
    pattern: &'a SamplePattern,
    /// What happened so far.
    pub counts: PriorityCounts,
}

impl<'a, const FRONT_FIRST: bool> PrioritySink<'a, FRONT_FIRST> {
    /// Draws into `tile`.
    pub fn new(tile: &'a mut Tile, pattern: &'a SamplePattern) -> Self {
        Self { tile, pattern, counts: PriorityCounts::default() }
    }
}

impl<S: Simd, const FRONT_FIRST: bool> BlockSink<S> for PrioritySink<'_, FRONT_FIRST> {
    #[inline(always)]
    fn rejects(&self, setup: &Setup, block: &Block) -> bool {
        FRONT_FIRST && setup.z_max < self.tile.block_far[block.index()]
    }

    #[inline(always)]
    fn cover(&mut self, simd: S, setup: &Setup, block: &Block, masks: &[u64]) {
        let facet = U32x8::splat(simd, setup.facet);
        let nothing = U32x8::splat(simd, NO_FACET);
        let place = (self.pattern, corner(self.tile));
        let mut written = 0;
        each_row(
            simd,
            setup,
            place,
            block,
            masks,
            #[inline(always)]
            |row| {
                let Met { covered, nearer, wins, old_z, old_facet } = keep_nearer(simd, self.tile, facet, &row);
                written += wins.to_bitmask().count_ones();
                let filled = covered & !old_facet.simd_eq(nothing);
                let (overruled, gap) = if FRONT_FIRST {
                    (filled & wins, row.z - old_z)
                } else {
                    (covered & !nearer & !old_facet.simd_eq(facet), old_z - row.z)
                };
                let far = overruled & gap.simd_ge(F32x8::splat(simd, NEAR_TIE));
                self.counts.overdrawn += u64::from((filled & wins).to_bitmask().count_ones());
                self.counts.overruled += u64::from(overruled.to_bitmask().count_ones());
                self.counts.overruled_far += u64::from(far.to_bitmask().count_ones());
            },
        );
        if FRONT_FIRST {
            let patience = (BLOCK * BLOCK * self.pattern.len()) as u32;
            note_writes(simd, self.tile, self.pattern.len(), block, (written, patience));
        }
        self.tile.touched = true;
    }
}

/// A facet seen at a sample, in front of the nearest opaque one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// `sample * TILE_PIXELS + y * TILE + x` within the tile.
    pub at: u32,
    /// Depth, 1 near.
    pub depth: f32,
    /// The facet.
    pub facet: u32,
}

/// Collects every facet that is not hidden by the tile's opaque samples.
#[derive(Debug)]
pub struct LayerSink<'a> {
    tile: &'a Tile,
    pattern: &'a SamplePattern,
    layers: &'a mut LayerList,
}

impl<'a> LayerSink<'a> {
    /// Adds to `layers`, in front of what `tile` holds.
    pub fn new(tile: &'a Tile, pattern: &'a SamplePattern, layers: &'a mut LayerList) -> Self {
        Self { tile, pattern, layers }
    }
}

impl<S: Simd> BlockSink<S> for LayerSink<'_> {
    #[inline(always)]
    fn rejects(&self, setup: &Setup, block: &Block) -> bool {
        setup.z_max < self.tile.block_far[block.index()]
    }

    #[inline(always)]
    fn cover(&mut self, simd: S, setup: &Setup, block: &Block, masks: &[u64]) {
        let place = (self.pattern, corner(self.tile));
        each_row(
            simd,
            setup,
            place,
            block,
            masks,
            #[inline(always)]
            |row| {
                let (z, at, mut covered) = (row.z.to_array(), row.at, row.covered);
                while covered != 0 {
                    let lane = covered.trailing_zeros() as usize;
                    covered &= covered - 1;
                    let (old_z, old_facet) = (self.tile.depth[at + lane], self.tile.facet[at + lane]);
                    if z[lane] > old_z || (z[lane] == old_z && setup.facet < old_facet) {
                        self.layers.push(Layer { at: (at + lane) as u32, depth: z[lane], facet: setup.facet });
                    }
                }
            },
        );
    }
}
