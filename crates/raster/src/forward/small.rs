//! Facets of at most 8x8 pixels, of which a fine mesh is made, with fragments of the common kinds: coverage and depth test row
//! by row as the rows are found, then the colours of what passed. Nothing is prepared for whole blocks; the results are
//! those of [`super::block`].

use super::block;
use super::fragment::{ColorTile, SAMPLES, stored_depth};
use super::fragment_ops::compare::compare;
use super::shade::CENTERS;
use super::tile::FragmentSink;
use super::wide::{bits_of, mask_of, select, splat};
use crate::kernel::traverse::{Block, RowSink};
use crate::sink::row_depth;
use crate::{BLOCK, SUBPIXEL, Setup, TILE, TILE_PIXELS};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, LANES, Mask8, Simd};

/// What is known of a small facet while its rows come.
#[derive(Default)]
pub(crate) struct SmallFacet {
    /// Its pixels lie in the eight columns from `left` on, in the rows from `top` on.
    left: usize,
    top: usize,
    /// How many rows there are at most.
    rows: usize,
    /// Bits of the pixels that may be drawn, row by row.
    allowed: u64,
    /// The samples that passed, row by row.
    passed: [u64; SAMPLES],
}

impl FragmentSink<'_, '_, '_> {
    /// Whether small facets come row by row: no test but that of depth, and as many samples as the target has.
    #[inline(always)]
    pub(super) fn by_rows(&self) -> bool {
        let state = self.draw.state;
        let plain = state.stencil.is_none() && state.alpha_test.is_none();
        plain && self.pattern.len() == self.run.planes.samples && self.by_blocks()
    }
}

impl<S: Simd> RowSink<S> for FragmentSink<'_, '_, '_> {
    const MOST_ROWS: usize = BLOCK;

    #[inline(always)]
    fn rejects_box(&mut self, _: &Setup, low: [usize; 2], high: [usize; 2]) -> bool {
        let (left, top) = (low[0].min(TILE - LANES), low[1]);
        let block = Block { x: left, y: top, rows: 0..high[1] + 1 - top };
        let allowed = block::rectangle(left as i32, top as i32, self.clip);
        if allowed == 0 {
            return true;
        }
        if let (Some((tile, _)), Some(test)) = (&mut self.run.planes.depth, self.draw.state.depth) {
            let touched = block.touched();
            tile.open(touched, false, self.run.planes.samples);
            if test.write {
                self.run.planes.ranges.forget(touched);
            }
        }
        self.small = SmallFacet { left, top, rows: block.rows.end, allowed, passed: [0; SAMPLES] };
        false
    }

    #[inline(always)]
    fn cover_row(&mut self, simd: S, setup: &Setup, sample: usize, [x, y]: [usize; 2], covered: Mask8<S>) {
        let shift = 8 * (y - self.small.top);
        let mut passed = covered;
        if self.small.allowed != u64::MAX {
            passed &= mask_of(simd, (self.small.allowed >> shift) as u32 & 0xff);
        }
        if let (Some((tile, scale)), Some(test)) = (&mut self.run.planes.depth, self.draw.state.depth) {
            let [sx, sy] = self.pattern.position(sample);
            let (column, line) = (self.run.x as usize + x, self.run.y as usize + y);
            let depth = row_depth(simd, setup, column as i32 * SUBPIXEL + sx, line as i32 * SUBPIXEL + sy);
            let depth = stored_depth(simd, depth, *scale);
            let at = sample * TILE_PIXELS + y * TILE + x;
            let stored = &mut tile.opened()[at..at + LANES];
            let old = F32x8::from_slice(simd, stored);
            passed &= compare(simd, test.func, depth, old);
            if test.write {
                select(passed, depth, old).store_slice(stored);
            }
        }
        self.small.passed[sample % SAMPLES] |= u64::from(bits_of(passed) & 0xff) << shift;
    }

    #[inline(always)]
    fn end(&mut self, simd: S, _: [usize; 2]) {
        let SmallFacet { left, top, rows, passed, .. } = self.small;
        let any = passed[0] | passed[1] | passed[2] | passed[3];
        if any == 0 || !self.draw.shaded {
            return;
        }
        let place = (self.run.x as usize + left, self.run.y as usize + top);
        let block = Block { x: left, y: top, rows: 0..rows };
        if self.shader.is_plain() {
            return self.plain_rows(simd, place, &block, any);
        }
        let (words, _) = self.shader.block(simd, self.setup, place, any);
        block::colors(simd, &block, &mut self.run.planes, self.draw.ops.mixing, &words, &passed);
    }
}

impl FragmentSink<'_, '_, '_> {
    /// Colours and writes the pixels that passed, of which `any` has all, where colours are those of corners.
    #[inline(always)]
    fn plain_rows<S: Simd>(&mut self, simd: S, (left, top): (usize, usize), block: &Block, any: u64) {
        let (samples, passed) = (self.run.planes.samples, &self.small.passed);
        let Some(ColorTile::Rgba8(tile)) = &mut self.run.planes.color else { return };
        self.shader.prepare(simd, self.setup);
        let x = F32x8::from_slice(simd, &CENTERS) + left as f32;
        let (count, values) = tile.open(block.touched(), block::all_alike(passed, samples), samples);
        for row in block.rows.clone() {
            if any >> (8 * row) & 0xff == 0 {
                continue;
            }
            let words = self.shader.plain_row(simd, x, splat(simd, (top + row) as f32 + 0.5));
            let at = (block.y + row) * TILE + block.x;
            for (plane, passed) in values.chunks_exact_mut(TILE_PIXELS).zip(passed).take(count) {
                let bits = (passed >> (8 * row)) as u32 & 0xff;
                if bits != 0 {
                    block::write_row(simd, words, bits, self.draw.ops.mixing, &mut plane[at..at + LANES]);
                }
            }
        }
    }
}

const _: () =
    assert!(BLOCK * BLOCK == u64::BITS as usize && LANES == BLOCK, "a small facet's pixels are bits of a word");
