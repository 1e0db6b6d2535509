//! Blocks of 8x8 pixels, and who takes what a triangle covers of them.

use super::plane::RowPlane;
use crate::{BLOCK, Setup, TILE, Tile};
use std::ops::Range;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{Mask8, Simd};

/// A block of 8x8 pixels of a tile.
#[derive(Clone, Debug)]
pub struct Block {
    /// Left pixel column within the tile.
    pub x: usize,
    /// Top pixel row within the tile.
    pub y: usize,
    /// Rows of the block that may hold covered samples.
    pub rows: Range<usize>,
}

impl Block {
    /// Its number in the tile, row by row.
    pub fn index(&self) -> usize {
        self.y / BLOCK * (TILE / BLOCK) + self.x / BLOCK
    }
}

#[cfg(any(test, feature = "forward"))]
impl Block {
    /// From this column and row on, with the rows down to the last of these pixels (bit
    /// `8 * row + column`).
    #[inline(always)]
    pub(crate) fn of([x, y]: [usize; 2], pixels: u64) -> Self {
        Self { x, y, rows: 0..BLOCK - pixels.leading_zeros() as usize / BLOCK }
    }

    /// Whether it is one of the tile's blocks; sinks that take rows may make others.
    #[inline(always)]
    pub(crate) fn is_aligned(&self) -> bool {
        (self.x | self.y).is_multiple_of(BLOCK)
    }

    /// The bits of those of the tile's blocks that its rows lie in.
    #[inline(always)]
    pub(crate) fn touched(&self) -> u64 {
        let columns = 1u64 << (self.x / BLOCK) | 1 << self.x.div_ceil(BLOCK);
        let (first, last) =
            ((self.y + self.rows.start) / BLOCK, (self.y + self.rows.end - 1) / BLOCK);
        columns << (8 * first) | columns << (8 * last)
    }
}

/// What to do with covered samples.
pub trait BlockSink<S: Simd> {
    /// Whether nothing of `setup` can matter in this block, so that coverage need not be computed.
    fn rejects(&self, setup: &Setup, block: &Block) -> bool;

    /// `masks[s]` has bit `8 * row + column` set where sample `s` of the block's pixel is covered;
    /// not all are 0.
    fn cover(&mut self, simd: S, setup: &Setup, block: &Block, masks: &[u64]);
}

/// A sink that takes covered samples row by row, wherever in the tile a row of eight pixels begins:
/// what small triangles want, which are most of a fine mesh. [`InBlocks`] makes a [`BlockSink`] of
/// it.
pub trait RowSink<S: Simd> {
    /// The tile whose far depths hide what cannot matter; none if everything does.
    fn hiding(&self) -> Option<&Tile>;

    /// Where sample `sample` of the pixel in column `x` of the tile's row 0 is, in 1/256 pixel.
    fn first(&self, sample: usize, x: usize) -> [i32; 2];

    /// Sample `sample` of the eight pixels from column `x` of row `y` is covered where `covered` is
    /// set; with the facet come its depths in rows from this column on.
    fn cover_row(
        &mut self,
        simd: S,
        facet: (&Setup, &RowPlane<S>),
        sample: usize,
        at: [usize; 2],
        covered: Mask8<S>,
    );

    /// The last row of a triangle, or of its part in a block, whose box begins at pixel `at` was
    /// given.
    #[inline(always)]
    fn end(&mut self, _simd: S, _at: [usize; 2]) {}
}

/// Takes blocks for a sink of rows, and hands it the rows in which something is covered.
#[derive(Debug)]
pub struct InBlocks<'a, K>(pub &'a mut K);

impl<S: Simd, K: RowSink<S>> BlockSink<S> for InBlocks<'_, K> {
    #[inline(always)]
    fn rejects(&self, setup: &Setup, block: &Block) -> bool {
        self.0.hiding().is_some_and(|tile| setup.z_max < tile.block_far[block.index()])
    }

    #[inline(always)]
    fn cover(&mut self, simd: S, setup: &Setup, block: &Block, masks: &[u64]) {
        for (s, &mask) in masks.iter().enumerate() {
            let plane = RowPlane::new(simd, setup, self.0.first(s, block.x));
            for row in block.rows.clone() {
                let covered = (mask >> (8 * row)) & 0xff;
                if covered != 0 {
                    let covered = Mask8::from_bitmask(simd, covered);
                    self.0.cover_row(simd, (setup, &plane), s, [block.x, block.y + row], covered);
                }
            }
        }
        self.0.end(simd, [block.x, block.y]);
    }
}
