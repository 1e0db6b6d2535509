//! Facets of at most 8x8 pixels, of which a fine mesh is made, with fragments of the common kinds: coverage and depth test row
//! by row, then the colours of what passed. Nothing is prepared for whole blocks; the results are those of
//! [`super::block`].

use super::block;
use super::block::{DepthRule, Slope};
use super::fragment::{ColorTile, SAMPLES};
use super::fragment_ops::compare::compare;
use super::shade::CENTERS;
use super::state::Compare;
use super::tile::FragmentSink;
use super::wide::{bits_of, mask_of, select, splat};
use crate::kernel::traverse::{Block, Placed};
use crate::{BLOCK, Setup, TILE, TILE_PIXELS};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, LANES, Mask8, Simd};

impl FragmentSink<'_, '_, '_> {
    /// Whether tiny facets come this way.
    #[inline(always)]
    pub(super) fn by_rows(&self) -> bool {
        self.draw.ops.direct && matches!(self.pattern.len(), 1 | SAMPLES) && self.by_blocks()
    }

    /// The fragments of a tiny facet.
    #[inline(always)]
    pub(super) fn tiny<S: Simd>(&mut self, simd: S, setup: &Setup, place: &Placed) {
        if self.pattern.len() == 1 {
            self.tiny_apart::<S, 1>(simd, setup, place);
        } else {
            self.tiny_apart::<S, SAMPLES>(simd, setup, place);
        }
    }

    #[inline(never)]
    fn tiny_apart<S: Simd, const N: usize>(&mut self, simd: S, setup: &Setup, place: &Placed) {
        simd.vectorize(
            #[inline(always)]
            || self.tiny_inlined::<S, N>(simd, setup, place),
        );
    }

    #[inline(always)]
    fn tiny_inlined<S: Simd, const N: usize>(&mut self, simd: S, setup: &Setup, place: &Placed) {
        let (left, [top, last]) = (place.left(), place.rows);
        let block = Block { x: left, y: top, rows: 0..last + 1 - top };
        let mut allowed = [block::rectangle(left as i32, top as i32, self.clip); SAMPLES];
        if let Some(test) = &self.draw.state.stencil {
            let face = if self.shader.facet.back { &test.back } else { &test.front };
            block::stencil(simd, &block, &mut self.run.planes, face, &mut allowed);
        }
        if allowed == [0; SAMPLES] {
            return;
        }
        // Before the alpha test depth may be looked at, but not written.
        let late = self.draw.state.alpha_test.is_some();
        let rule = self.draw.state.depth.map(|test| DepthRule { func: test.func, write: test.write && !late });
        let mut passed = self.passing::<S, N>(simd, setup, place, &block, rule, &allowed);
        let any = passed[0] | passed[1] | passed[2] | passed[3];
        if any == 0 || !self.draw.shaded {
            return;
        }
        let corner = (self.run.x as usize + left, self.run.y as usize + top);
        if self.shader.is_plain() && !late {
            self.shader.prepare(simd, setup);
            return self.plain_rows(simd, corner, &block, any, &passed);
        }
        let (words, visible) = self.shader.block(simd, setup, corner, any);
        if late {
            for bits in &mut passed {
                *bits &= visible;
            }
            self.write_depths::<S, N>(simd, setup, place, &block, &passed);
        }
        block::colors(simd, &block, &mut self.run.planes, self.draw.ops.mixing, &words, &passed);
    }

    /// Writes the depths of `passed` samples, if depths are written.
    #[inline(never)]
    fn write_depths<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        setup: &Setup,
        place: &Placed,
        block: &Block,
        passed: &[u64; SAMPLES],
    ) {
        if self.draw.state.depth.is_some_and(|test| test.write) && *passed != [0; SAMPLES] {
            let rule = Some(DepthRule { func: Compare::Always, write: true });
            simd.vectorize(
                #[inline(always)]
                || self.passing::<S, N>(simd, setup, place, block, rule, passed),
            );
        }
    }

    /// Depth test, with its writes: the samples of `allowed` pixels that are covered and pass, row by row.
    #[inline(always)]
    fn passing<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        setup: &Setup,
        place: &Placed,
        block: &Block,
        rule: Option<DepthRule>,
        allowed: &[u64; SAMPLES],
    ) -> [u64; SAMPLES] {
        let (left, top) = (block.x, block.y);
        let corner = (self.run.x as usize + left, self.run.y as usize + top);
        let planes = &mut self.run.planes;
        // A draw without multisampling covers all samples of a pixel alike; where all have one depth and the same may be drawn,
        // one stands for all.
        let (mut test, mut alike) = (None, 1);
        if let (Some((tile, scale)), Some(rule)) = (&mut planes.depth, rule) {
            let touched = block.touched();
            if rule.write {
                planes.ranges.forget(touched);
            }
            let together = N == 1 && block::all_alike(allowed, planes.samples);
            let (count, values) = tile.open(touched, together, planes.samples);
            alike = if N == 1 { count } else { 1 };
            test = Some((values, *scale, rule));
        }
        let limits = [splat(simd, setup.z_min), splat(simd, setup.z_max)];
        let [xs, ys] = self.pattern.axes();
        let mut passed = [0; SAMPLES];
        place.each_row::<S, Slope<S>, N>(
            simd,
            self.pattern,
            #[inline(always)]
            |s| Slope::new(simd, setup, corner, [xs[s], ys[s]]),
            #[inline(always)]
            |slope, s, y, covered: Mask8<S>| {
                let (row, shift) = (y - top, 8 * (y - top));
                let Some((values, scale, rule)) = &mut test else {
                    passed[s % SAMPLES] |= u64::from(bits_of(covered) & 0xff) << shift;
                    return;
                };
                let depth = slope.row(simd, row, limits, *scale);
                for other in 0..alike {
                    let at = (s + other) * TILE_PIXELS + y * TILE + left;
                    let stored = &mut values[at..at + LANES];
                    let old = F32x8::from_slice(simd, stored);
                    let (sample, mut pass) = ((s + other) % SAMPLES, covered & compare(simd, rule.func, depth, old));
                    if allowed[sample] != u64::MAX {
                        pass &= mask_of(simd, (allowed[sample] >> shift) as u32 & 0xff);
                    }
                    if rule.write {
                        select(pass, depth, old).store_slice(stored);
                    }
                    passed[sample] |= u64::from(bits_of(pass) & 0xff) << shift;
                }
            },
        );
        if N == 1 && (alike == 1 || test.is_none()) {
            passed = [passed[0]; SAMPLES];
        }
        if test.is_none() {
            for s in 0..SAMPLES {
                passed[s] &= allowed[s];
            }
        }
        passed
    }

    /// Colours and writes the pixels that passed, of which `any` has all, where colours are those of corners.
    #[inline(always)]
    fn plain_rows<S: Simd>(
        &mut self,
        simd: S,
        (left, top): (usize, usize),
        block: &Block,
        any: u64,
        passed: &[u64; SAMPLES],
    ) {
        let samples = self.run.planes.samples;
        let Some(ColorTile::Rgba8(tile)) = &mut self.run.planes.color else { return };
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
    assert!(BLOCK * BLOCK == u64::BITS as usize && LANES == BLOCK, "a tiny facet's pixels are bits of a word");
