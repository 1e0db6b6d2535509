//! Facets of at most 8x8 pixels, of which a fine mesh is made, with fragments of the common kinds: coverage and depth test row
//! by row, then the colours of what passed. Nothing is prepared for whole blocks; the results are those of
//! [`super::block`].

use super::block;
use super::block::{DepthRule, Slope, Words};
use super::fragment::{ColorTile, SAMPLES};
use super::fragment_ops::compare::compare;
use super::shade::{CENTERS, Shader};
use super::state::Compare;
use super::tile::ForwardSink;
use super::wide::{bits_of, mask_of, select, splat};
use crate::kernel::traverse::{Block, Placed};
use crate::{BLOCK, SamplePattern, Setup, TILE, TILE_PIXELS};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, LANES, Mask8, Simd};

impl ForwardSink<'_, '_, '_> {
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
        let rectangle = block::rectangle(left as i32, top as i32, self.clip);
        if rectangle == 0 {
            return;
        }
        let mut allowed = [rectangle; SAMPLES];
        if let Some(test) = &self.draw.state.stencil {
            let face = if self.shader.facet.back { &test.back } else { &test.front };
            block::stencil(simd, &block, &mut self.run.planes, face, &mut allowed);
            if self.run.planes.samples == 1 {
                // The others stand for samples that there are not.
                allowed = [allowed[0]; SAMPLES];
            }
            if allowed == [0; SAMPLES] {
                return;
            }
        }
        // Before the alpha test depth may be looked at, but not written.
        let late = self.draw.state.alpha_test.is_some();
        let rule = self.draw.state.depth.map(|test| DepthRule { func: test.func, write: test.write && !late });
        let (mut passed, any) = self.passing::<S, N>(simd, setup, place, &block, rule, &allowed);
        if any == 0 || !self.draw.shaded {
            return;
        }
        let corner = (self.run.x as usize + left, self.run.y as usize + top);
        if Shader::is_plain(self.draw) && !late {
            self.shader.prepare(simd, setup);
            return self.plain_rows(simd, corner, &block, any, &passed);
        }
        let (one, visible) = self.shader.block(simd, setup, corner, any, self.words);
        if late {
            for bits in &mut passed {
                *bits &= visible;
            }
            self.write_depths::<S, N>(simd, setup, place, &block, &passed);
        }
        let words = Words::of(one, self.words);
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

    /// Depth test, with its writes: the samples of `allowed` pixels that are covered and pass, row by row, and the pixels of
    /// which some do.
    #[inline(always)]
    fn passing<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        setup: &Setup,
        place: &Placed,
        block: &Block,
        rule: Option<DepthRule>,
        allowed: &[u64; SAMPLES],
    ) -> ([u64; SAMPLES], u64) {
        let corner = (self.run.x as usize + block.x, self.run.y as usize + block.y);
        let (planes, pattern) = (&mut self.run.planes, self.pattern);
        let (Some((tile, scale)), Some(rule)) = (&mut planes.depth, rule) else {
            return covered::<S, N>(simd, place, pattern, allowed);
        };
        let touched = block.touched();
        if rule.write {
            planes.ranges.forget(touched);
        }
        // A draw without multisampling covers all samples of a pixel alike; where all have one depth and the same may be
        // drawn, one stands for all.
        let together = N == 1 && block::all_alike(allowed, planes.samples);
        let (count, values) = tile.open(touched, together, planes.samples);
        let depths = Depths { values, corner: (block.x, block.y), scale: *scale, rule, allowed };
        if N == 1 && count > 1 {
            return depths.compare::<S, 1, SAMPLES>(simd, setup, place, corner, pattern);
        }
        depths.compare::<S, N, 1>(simd, setup, place, corner, pattern)
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
        let together = samples == 1 || block::all_alike(passed, samples);
        let (count, values) = tile.open(block.touched(), together, samples);
        let mixing = self.draw.ops.mixing;
        for row in block.rows.clone() {
            let bits = (any >> (8 * row)) as u32 & 0xff;
            if bits == 0 {
                continue;
            }
            let words = self.shader.plain_row(simd, x, splat(simd, (top + row) as f32 + 0.5));
            let at = (block.y + row) * TILE + block.x;
            if count == 1 {
                block::write_row(simd, words, bits, mixing, &mut values[at..at + LANES]);
                continue;
            }
            for (s, passed) in passed.iter().enumerate().take(count) {
                let (bits, at) = ((passed >> (8 * row)) as u32 & 0xff, at + s * TILE_PIXELS);
                if bits != 0 {
                    block::write_row(simd, words, bits, mixing, &mut values[at..at + LANES]);
                }
            }
        }
    }
}

/// The covered samples of `allowed` pixels, and the pixels of which some are.
#[inline(always)]
fn covered<S: Simd, const N: usize>(
    simd: S,
    place: &Placed,
    pattern: &SamplePattern,
    allowed: &[u64; SAMPLES],
) -> ([u64; SAMPLES], u64) {
    let (top, mut passed) = (place.rows[0], *allowed);
    place.each_row::<S, u64, N>(
        simd,
        pattern,
        #[inline(always)]
        |_| 0,
        #[inline(always)]
        |bits, y, covered| *bits |= u64::from(bits_of(covered) & 0xff) << (8 * (y - top)),
        #[inline(always)]
        |s, bits| {
            // One sample stands for all.
            for s in if N == 1 { 0..SAMPLES } else { s..s + 1 } {
                passed[s] &= bits;
            }
        },
    );
    (passed, passed[0] | passed[1] | passed[2] | passed[3])
}

/// A tile's depths, and what meets them.
struct Depths<'a> {
    values: &'a mut [f32],
    /// The facet's first pixel within the tile.
    corner: (usize, usize),
    scale: f32,
    rule: DepthRule,
    allowed: &'a [u64; SAMPLES],
}

impl Depths<'_> {
    /// See [`ForwardSink::passing`]. Of each of the `N` samples that are walked there are `A` alike; if there is one of all,
    /// it stands for all.
    #[inline(always)]
    fn compare<S: Simd, const N: usize, const A: usize>(
        self,
        simd: S,
        setup: &Setup,
        place: &Placed,
        corner: (usize, usize),
        pattern: &SamplePattern,
    ) -> ([u64; SAMPLES], u64) {
        let Self { values, corner: (left, top), scale, rule, allowed } = self;
        let limits = [splat(simd, setup.z_min), splat(simd, setup.z_max)];
        let [xs, ys] = pattern.axes();
        let (mut passed, mut any) = ([0; SAMPLES], 0);
        place.each_row::<S, (Slope<S>, usize, [u64; A]), N>(
            simd,
            pattern,
            #[inline(always)]
            |s| (Slope::new(simd, &setup.plane(), corner, [xs[s], ys[s]]), s, [0; A]),
            #[inline(always)]
            |(slope, s, bits), y, covered: Mask8<S>| {
                let shift = 8 * (y - top);
                let depth = slope.row(simd, y - top, limits, scale);
                for other in 0..A {
                    let sample = (*s + other) % SAMPLES;
                    let at = sample * TILE_PIXELS + y * TILE + left;
                    let stored = &mut values[at..at + LANES];
                    let old = F32x8::from_slice(simd, stored);
                    let mut pass = covered & compare(simd, rule.func, depth, old);
                    if allowed[sample] != u64::MAX {
                        pass &= mask_of(simd, (allowed[sample] >> shift) as u32 & 0xff);
                    }
                    if rule.write {
                        select(pass, depth, old).store_slice(stored);
                    }
                    bits[other] |= u64::from(bits_of(pass) & 0xff) << shift;
                }
            },
            #[inline(always)]
            |s, (_, _, bits)| {
                for other in 0..A {
                    passed[(s + other) % SAMPLES] = bits[other];
                    any |= bits[other];
                }
            },
        );
        if N == 1 && A == 1 {
            passed = [any; SAMPLES];
        }
        (passed, any)
    }
}

const _: () =
    assert!(BLOCK * BLOCK == u64::BITS as usize && LANES == BLOCK, "a tiny facet's pixels are bits of a word");
