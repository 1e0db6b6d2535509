//! What covered samples mean: the nearest facet, the last of a list, or all facets in front.

use crate::kernel::block::{Block, RowSink};
use crate::kernel::plane::RowPlane;
use crate::{
    BLOCK, Layer, LayerList, NO_FACET, SUBPIXEL, SamplePattern, Setup, TILE, TILE_PIXELS, Tile,
};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Mask8, Simd, U32x8};

/// Eight samples of a row that a facet covers, with the facet's depth there.
pub(crate) struct Row<S: Simd> {
    /// Index of the first in the tile's planes.
    at: usize,
    /// The samples that the facet covers.
    covered: Mask8<S>,
    /// Depths of the facet's plane: 1 on the near plane, 0 on the far plane.
    pub(crate) z: F32x8<S>,
}

impl<S: Simd> Row<S> {
    /// Sample `sample` of the tile's pixels from `[x, y]`.
    #[inline(always)]
    pub(crate) fn new(
        plane: &RowPlane<S>,
        sample: usize,
        [x, y]: [usize; 2],
        covered: Mask8<S>,
    ) -> Self {
        Self { at: sample * TILE_PIXELS + y * TILE + x, covered, z: plane.row(y) }
    }
}

/// [`RowSink::first`] in a tile.
#[inline(always)]
pub(crate) fn first_sample(
    tile: &Tile,
    pattern: &SamplePattern,
    sample: usize,
    x: usize,
) -> [i32; 2] {
    let [sx, sy] = pattern.axes().map(|axis| axis[sample]);
    [(tile.x as usize + x) as i32 * SUBPIXEL + sx, tile.y as i32 * SUBPIXEL + sy]
}

/// The depth test of a facet at eight samples.
pub(crate) struct DepthTest8<S: Simd> {
    /// The facet is nearer than what was there; of equally near ones it is the lower.
    nearer: Mask8<S>,
    /// It is nearer and covers.
    pub(crate) wins: Mask8<S>,
    /// The stored depths, and the facets that they are of.
    old_z: F32x8<S>,
    old_facet: U32x8<S>,
}

impl<S: Simd> DepthTest8<S> {
    /// At the samples of `row`.
    #[inline(always)]
    pub(crate) fn new(simd: S, tile: &Tile, facet: U32x8<S>, row: &Row<S>) -> Self {
        let old_z = F32x8::from_slice(simd, &tile.depth[row.at..row.at + BLOCK]);
        let old_facet = U32x8::from_slice(simd, &tile.facet[row.at..row.at + BLOCK]);
        let nearer = row.z.simd_gt(old_z) | (row.z.simd_eq(old_z) & facet.simd_lt(old_facet));
        Self { nearer, wins: nearer & row.covered, old_z, old_facet }
    }
}

/// Keeps the nearer facet at the samples of `row`.
#[inline(always)]
fn keep_nearer<S: Simd>(simd: S, tile: &mut Tile, facet: U32x8<S>, row: &Row<S>) -> DepthTest8<S> {
    let met = DepthTest8::new(simd, tile, facet, row);
    met.wins.select(row.z, met.old_z).store_slice(&mut tile.depth[row.at..row.at + BLOCK]);
    met.wins.select(facet, met.old_facet).store_slice(&mut tile.facet[row.at..row.at + BLOCK]);
    met
}

/// The z-buffer: each sample keeps the nearest facet, of equally near ones the lowest.
#[derive(Debug)]
pub struct VisibilitySink<'a> {
    tile: &'a mut Tile,
    pattern: &'a SamplePattern,
    /// Samples of a block that are written before its `block_far` is computed anew.
    patience: u32,
    /// Samples of the triangle at hand that were written row by row.
    written: u32,
}

impl<'a> VisibilitySink<'a> {
    /// Draws into `tile`.
    pub fn new(tile: &'a mut Tile, pattern: &'a SamplePattern) -> Self {
        Self { tile, pattern, patience: (BLOCK * BLOCK * pattern.len()) as u32, written: 0 }
    }

    /// Draws into `tile`, for someone who wants to know how far a block is as soon as it is full:
    /// facets that come from front to back fill it once.
    pub fn eager(tile: &'a mut Tile, pattern: &'a SamplePattern) -> Self {
        Self { tile, pattern, patience: 1, written: 0 }
    }
}

/// Brings `block_far` up to date once `patience` samples of a block, of `samples` samples a pixel,
/// have been written.
#[inline(always)]
fn note_writes<S: Simd>(
    simd: S,
    tile: &mut Tile,
    samples: usize,
    block: &Block,
    (written, patience): (u32, u32),
) {
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

/// The block for which a triangle walked by rows counts, though its rows may reach into others:
/// when far depths are computed anew does not matter to pictures.
fn block_of([x, y]: [usize; 2]) -> Block {
    Block { x: x & !(BLOCK - 1), y: y & !(BLOCK - 1), rows: 0..BLOCK }
}

impl<S: Simd> RowSink<S> for VisibilitySink<'_> {
    #[inline(always)]
    fn hiding(&self) -> Option<&Tile> {
        Some(self.tile)
    }

    #[inline(always)]
    fn first(&self, sample: usize, x: usize) -> [i32; 2] {
        first_sample(self.tile, self.pattern, sample, x)
    }

    #[inline(always)]
    fn cover_row(
        &mut self,
        simd: S,
        (setup, plane): (&Setup, &RowPlane<S>),
        sample: usize,
        at: [usize; 2],
        covered: Mask8<S>,
    ) {
        let row = Row::new(plane, sample, at, covered);
        let met = keep_nearer(simd, self.tile, U32x8::splat(simd, setup.facet), &row);
        self.written += met.wins.to_bitmask().count_ones();
    }

    #[inline(always)]
    fn end(&mut self, simd: S, at: [usize; 2]) {
        let written = std::mem::take(&mut self.written);
        note_writes(simd, self.tile, self.pattern.len(), &block_of(at), (written, self.patience));
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

/// Facets in a list from back to front, each covers earlier ones; or from front to back, each
/// fills empty samples, and blocks that are full are not looked at. The depth function has the last
/// word: where it contradicts the list, the nearer facet is kept, and that is counted.
#[derive(Debug)]
pub struct PrioritySink<'a, const FRONT_FIRST: bool> {
    tile: &'a mut Tile,
    pattern: &'a SamplePattern,
    /// What happened so far.
    pub counts: PriorityCounts,
    /// Samples of the triangle at hand that were written row by row.
    written: u32,
}

impl<'a, const FRONT_FIRST: bool> PrioritySink<'a, FRONT_FIRST> {
    /// Draws into `tile`.
    pub fn new(tile: &'a mut Tile, pattern: &'a SamplePattern) -> Self {
        Self { tile, pattern, counts: PriorityCounts::default(), written: 0 }
    }
}

impl<const FRONT_FIRST: bool> PrioritySink<'_, FRONT_FIRST> {
    /// Draws a row and counts; returns how many samples were written.
    #[inline(always)]
    fn draw<S: Simd>(&mut self, simd: S, facet: U32x8<S>, row: &Row<S>) -> u32 {
        let DepthTest8 { nearer, wins, old_z, old_facet } =
            keep_nearer(simd, self.tile, facet, row);
        let filled = row.covered & !old_facet.simd_eq(U32x8::splat(simd, NO_FACET));
        let (overruled, gap) = if FRONT_FIRST {
            (filled & wins, row.z - old_z)
        } else {
            (row.covered & !nearer & !old_facet.simd_eq(facet), old_z - row.z)
        };
        let far = overruled & gap.simd_ge(F32x8::splat(simd, NEAR_TIE));
        self.counts.overdrawn += u64::from((filled & wins).to_bitmask().count_ones());
        self.counts.overruled += u64::from(overruled.to_bitmask().count_ones());
        self.counts.overruled_far += u64::from(far.to_bitmask().count_ones());
        wins.to_bitmask().count_ones()
    }

    /// What was written in a block.
    #[inline(always)]
    fn note<S: Simd>(&mut self, simd: S, block: &Block, written: u32) {
        if FRONT_FIRST {
            let patience = (BLOCK * BLOCK * self.pattern.len()) as u32;
            note_writes(simd, self.tile, self.pattern.len(), block, (written, patience));
        }
        self.tile.touched = true;
    }
}

impl<S: Simd, const FRONT_FIRST: bool> RowSink<S> for PrioritySink<'_, FRONT_FIRST> {
    #[inline(always)]
    fn hiding(&self) -> Option<&Tile> {
        FRONT_FIRST.then_some(&*self.tile)
    }

    #[inline(always)]
    fn first(&self, sample: usize, x: usize) -> [i32; 2] {
        first_sample(self.tile, self.pattern, sample, x)
    }

    #[inline(always)]
    fn cover_row(
        &mut self,
        simd: S,
        (setup, plane): (&Setup, &RowPlane<S>),
        sample: usize,
        at: [usize; 2],
        covered: Mask8<S>,
    ) {
        let row = Row::new(plane, sample, at, covered);
        self.written += self.draw(simd, U32x8::splat(simd, setup.facet), &row);
    }

    #[inline(always)]
    fn end(&mut self, simd: S, at: [usize; 2]) {
        let written = std::mem::take(&mut self.written);
        self.note(simd, &block_of(at), written);
    }
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

impl LayerSink<'_> {
    #[inline(always)]
    fn collect<S: Simd>(&mut self, facet: u32, row: &Row<S>) {
        let (z, at, mut covered) = (row.z.to_array(), row.at, row.covered.to_bitmask());
        while covered != 0 {
            let lane = covered.trailing_zeros() as usize;
            covered &= covered - 1;
            let (old_z, old_facet) = (self.tile.depth[at + lane], self.tile.facet[at + lane]);
            if z[lane] > old_z || (z[lane] == old_z && facet < old_facet) {
                self.layers.push(Layer { at: (at + lane) as u32, depth: z[lane], facet });
            }
        }
    }
}

impl<S: Simd> RowSink<S> for LayerSink<'_> {
    #[inline(always)]
    fn hiding(&self) -> Option<&Tile> {
        Some(self.tile)
    }

    #[inline(always)]
    fn first(&self, sample: usize, x: usize) -> [i32; 2] {
        first_sample(self.tile, self.pattern, sample, x)
    }

    #[inline(always)]
    fn cover_row(
        &mut self,
        _: S,
        (setup, plane): (&Setup, &RowPlane<S>),
        sample: usize,
        at: [usize; 2],
        covered: Mask8<S>,
    ) {
        self.collect(setup.facet, &Row::new(plane, sample, at, covered));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::triangles;
    use crate::{InBlocks, TileGrid, Viewport, traverse, traverse_by_rows};
    use vitral_math::lanes::{Level, dispatch};

    #[test]
    fn rows_blocks_and_single_samples_agree() {
        let setups = triangles(4000, 0);
        for samples in [1, 4, 3] {
            let pattern = SamplePattern::new(samples);
            let empty = || {
                let mut tile =
                    TileGrid::new(Viewport::new(64, 64).unwrap(), samples).tiles.remove(0);
                tile.clear();
                tile
            };
            let [mut rows, mut blocks, mut one_by_one] = [empty(), empty(), empty()];
            dispatch!(Level::new(), simd => {
                let mut by_rows = VisibilitySink::new(&mut rows, &pattern);
                setups.iter().for_each(|s| traverse_by_rows(simd, s, (0, 0), &pattern, &mut by_rows));
                let mut by_blocks = VisibilitySink::new(&mut blocks, &pattern);
                setups.iter().for_each(|s| traverse(simd, s, (0, 0), &pattern, &mut InBlocks(&mut by_blocks)));
            });
            for setup in &setups {
                for at in 0..samples * TILE_PIXELS {
                    let [sx, sy] = pattern.position(at / TILE_PIXELS);
                    let pixel = at % TILE_PIXELS;
                    let (x, y) = (
                        (pixel % TILE) as i32 * SUBPIXEL + sx,
                        (pixel / TILE) as i32 * SUBPIXEL + sy,
                    );
                    let z = setup.depth(x, y);
                    let (old_z, old_facet) = (one_by_one.depth[at], one_by_one.facet[at]);
                    if setup.covers(x, y) && (z > old_z || (z == old_z && setup.facet < old_facet))
                    {
                        (one_by_one.depth[at], one_by_one.facet[at]) = (z, setup.facet);
                    }
                }
            }
            assert!(
                one_by_one.facet.iter().filter(|f| **f != NO_FACET).count()
                    > samples * TILE_PIXELS / 2
            );
            assert!(
                rows.facet == one_by_one.facet && rows.depth == one_by_one.depth,
                "{samples} samples by rows"
            );
            assert!(
                blocks.facet == one_by_one.facet && blocks.depth == one_by_one.depth,
                "{samples} samples by blocks"
            );
        }
    }

    #[test]
    fn rows_and_blocks_give_each_layer_once() {
        let pattern = SamplePattern::new(4);
        let mut tile = TileGrid::new(Viewport::new(64, 64).unwrap(), 4).tiles.remove(0);
        tile.clear();
        for setup in triangles(4000, 0) {
            let mut found = [LayerList::default(), LayerList::default()];
            let [rows, blocks] = &mut found;
            dispatch!(Level::new(), simd => {
                traverse_by_rows(simd, &setup, (0, 0), &pattern, &mut LayerSink::new(&tile, &pattern, rows));
                let mut by_blocks = LayerSink::new(&tile, &pattern, blocks);
                traverse(simd, &setup, (0, 0), &pattern, &mut InBlocks(&mut by_blocks));
            });
            let [rows, blocks] = found.map(|list| {
                let mut places: Vec<_> = list.iter().map(|l| (l.at, l.depth.to_bits())).collect();
                places.sort_unstable();
                places
            });
            assert_eq!(rows, blocks);
        }
    }
}
