//! Tiny facets of one draw, eight at a time, where nothing but depths and colours is tested and written.
//!
//! Coverage and depths of all eight are computed together, then each facet's pixels meet the stored depths, one after the other,
//! since two facets may lie in one pixel. Where colours are those of corners they are computed together again; else each facet
//! colours its own pixels. The results are those of [`super::tiny`].

use super::assemble::Primitives;
use super::block::{self, BlockWords, Words};
use super::fragment::{ColorTile, Mixing, SAMPLES, stored_depth};
use super::fragment_ops::compare::holds;
use super::pass::{DrawContext, facet_of};
use super::shade::{PlainEight, Scratch, Shader};
use super::state::{Compare, DepthTest};
use super::tile::TileRun;
use crate::kernel::tiny::{PLACES, TinyEight, pixel, places};
use crate::kernel::traverse::Placed;
use crate::{BLOCK, SamplePattern, Setup, TILE_PIXELS};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{LANES, Simd};

/// Tiny facets of one draw that wait until there are eight.
#[derive(Default)]
pub(super) struct TinyFacets {
    eight: TinyEight,
    /// Their places among the setups of all tiles.
    entries: [usize; LANES],
    /// Their draw.
    draw: u32,
}

/// What a tile's facets are drawn with, kept so that it need not be cleared.
pub(super) struct FacetMemory {
    pub(super) scratch: Scratch,
    /// A block's colours.
    pub(super) words: BlockWords,
    /// Colours at places of tiny facets, of all eight.
    each: [[u32; LANES]; PLACES],
    pub(super) waiting: TinyFacets,
}

impl Default for FacetMemory {
    fn default() -> Self {
        Self {
            scratch: Scratch::default(),
            words: [0; BLOCK * BLOCK],
            each: [[0; LANES]; PLACES],
            waiting: TinyFacets::default(),
        }
    }
}

/// What all facets of a tile's job share.
pub(super) struct JobContext<'a> {
    pub(super) primitives: &'a Primitives,
    pub(super) draws: &'a [DrawContext<'a>],
    pub(super) many: &'a SamplePattern,
    pub(super) one: &'a SamplePattern,
}

impl JobContext<'_> {
    /// Where the samples of a draw's pixels lie.
    #[inline(always)]
    pub(super) fn pattern(&self, draw: &DrawContext<'_>) -> &SamplePattern {
        if draw.multisample { self.many } else { self.one }
    }
}

impl TinyFacets {
    /// Whether one more of `draw` finds a place.
    #[inline(always)]
    pub(super) fn takes(&self, draw: u32) -> bool {
        self.eight.len() == 0 || (self.draw == draw && self.eight.len() < LANES)
    }

    /// One more: [`Self::takes`] it.
    #[inline(always)]
    pub(super) fn push(&mut self, entry: usize, draw: u32, setup: &Setup, place: &Placed) {
        self.entries[self.eight.len() % LANES] = entry;
        self.draw = draw;
        self.eight.push(setup, place);
    }
}

/// Whether a draw's tiny facets may come this way.
pub(super) fn by_eights(draw: &DrawContext<'_>, run: &TileRun<'_>) -> bool {
    let state = draw.state;
    draw.ops.direct
        && state.stencil.is_none()
        && state.alpha_test.is_none()
        && !draw.layout.smooth[2]
        && matches!(run.planes.samples, 1 | SAMPLES)
        && !matches!(run.planes.color, Some(ColorTile::RgbaF32(_)))
}

impl TileRun<'_> {
    /// Draws those that wait.
    #[inline(always)]
    pub(super) fn tiny_facets<S: Simd>(&mut self, simd: S, job: &JobContext<'_>, memory: &mut FacetMemory) {
        if memory.waiting.eight.len() != 0 {
            if job.pattern(&job.draws[memory.waiting.draw as usize]).len() == 1 {
                self.tiny_facets_apart::<S, 1>(simd, job, memory);
            } else {
                self.tiny_facets_apart::<S, SAMPLES>(simd, job, memory);
            }
            memory.waiting.eight.clear();
        }
    }

    #[inline(never)]
    fn tiny_facets_apart<S: Simd, const N: usize>(&mut self, simd: S, job: &JobContext<'_>, memory: &mut FacetMemory) {
        simd.vectorize(
            #[inline(always)]
            || self.tiny_facets_inlined::<S, N>(simd, job, memory),
        );
    }

    #[inline(always)]
    fn tiny_facets_inlined<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        job: &JobContext<'_>,
        memory: &mut FacetMemory,
    ) {
        let FacetMemory { scratch, words, each, waiting } = memory;
        let draw = &job.draws[waiting.draw as usize];
        let Some(passed) = self.tiny_tested::<S, N>(simd, draw, job.pattern(draw), &mut waiting.eight) else { return };
        if !draw.shaded || passed.any == [0; LANES] || self.tiny_replaced(simd, job, waiting, &passed, each) {
            return;
        }
        let (eight, Passed { masks, any, .. }) = (&waiting.eight, &passed);
        for facet in (0..eight.len()).filter(|&facet| any[facet] != 0) {
            let setup = job.primitives.batch.item(waiting.entries[facet]);
            let (own, tile) = (facet_of(job.primitives, setup.facet), [self.x as f32, self.y as f32]);
            let mut shader = Shader::new(own, draw, job.primitives, tile, scratch);
            let block = eight.block(facet, any[facet]);
            let corner = (self.x as usize + block.x, self.y as usize + block.y);
            let (one, _) = shader.block(simd, setup, corner, any[facet], words);
            let each = [masks[0][facet], masks[1][facet], masks[2][facet], masks[3][facet]];
            block::colors(simd, &block, &mut self.planes, draw.ops.mixing, &Words::of(one, words), &each);
        }
    }

    /// Coverage and depth test. `None` if nothing is covered.
    #[inline(always)]
    fn tiny_tested<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        draw: &DrawContext<'_>,
        pattern: &SamplePattern,
        eight: &mut TinyEight,
    ) -> Option<Passed> {
        let scale = self.planes.depth.as_ref().map_or(1.0, |d| d.1);
        let (mut masks, mut any) = ([[0; LANES]; SAMPLES], [0; LANES]);
        for sample in 0..N {
            masks[sample] = eight.cover(
                simd,
                (self.x, self.y),
                (sample, pattern.position(sample)),
                #[inline(always)]
                |depth| stored_depth(simd, depth, scale),
            );
            join(&mut any, &masks[sample]);
        }
        let mut touched = 0;
        for facet in (0..eight.len()).filter(|&facet| any[facet] != 0) {
            touched |= eight.block(facet, any[facet]).touched();
        }
        if touched == 0 {
            return None;
        }
        // A draw without multisampling covers all samples of a pixel alike; where all have one depth, one stands for all.
        let mut alike = N == 1;
        if alike {
            masks = [masks[0]; SAMPLES];
        }
        if let (Some(rule), Some((tile, _))) = (draw.state.depth, &mut self.planes.depth) {
            if rule.write {
                self.planes.ranges.forget(touched);
            }
            any = [0; LANES];
            let (count, stored) = tile.open(touched, alike, self.planes.samples);
            for (sample, stored) in stored.as_chunks_mut().0.iter_mut().enumerate().take(count) {
                test(eight, &mut masks[sample], sample % N, rule, stored);
                join(&mut any, &masks[sample]);
            }
            alike &= count == 1;
            if alike {
                masks = [masks[0]; SAMPLES];
            }
        }
        Some(Passed { masks, any, touched, alike })
    }

    /// Colours what passed, if colours replace what is there and are one a facet or those of corners; whether they are.
    #[inline(always)]
    fn tiny_replaced<S: Simd>(
        &mut self,
        simd: S,
        job: &JobContext<'_>,
        waiting: &TinyFacets,
        passed: &Passed,
        each: &mut [[u32; LANES]; PLACES],
    ) -> bool {
        let (eight, draw) = (&waiting.eight, &job.draws[waiting.draw as usize]);
        let Some(ColorTile::Rgba8(plane)) = &mut self.planes.color else { return false };
        if draw.ops.mixing != Mixing::Replace {
            return false;
        }
        let batch = &job.primitives.batch;
        let facet_at = |lane: usize| facet_of(job.primitives, batch.item(waiting.entries[lane]).facet);
        // Lanes without a facet of their own repeat the first one's.
        let mut facets = [facet_at(0); LANES];
        for lane in 1..eight.len() {
            facets[lane] = facet_at(lane);
        }
        let shown = places(passed.any.iter().fold(0, |all, mask| all | mask));
        if draw.constant {
            let mut words = [0; LANES];
            for lane in 0..LANES {
                words[lane] = Shader::constant_of(draw, facets[lane], job.primitives).0;
            }
            shown.for_each(|place| each[place] = words);
        } else if Shader::is_plain(draw) {
            let tile = [self.x, self.y];
            let Some(colors) = PlainEight::new(simd, eight, &facets, (draw, job.primitives), tile) else {
                return false;
            };
            for place in shown {
                colors.colors(simd, eight, place, tile).store_slice(&mut each[place]);
            }
        } else {
            return false;
        }
        let (count, values) = plane.open(passed.touched, passed.alike, self.planes.samples);
        for (values, masks) in values.as_chunks_mut::<TILE_PIXELS>().0.iter_mut().zip(&passed.masks).take(count) {
            for (facet, &mask) in masks.iter().enumerate().take(eight.len()) {
                let first = eight.first(facet);
                for place in places(mask) {
                    values[pixel(first, place) % TILE_PIXELS] = each[place % PLACES][facet];
                }
            }
        }
        true
    }
}

/// What eight tiny facets cover and passed the depth test.
struct Passed {
    /// Pixels of each facet, sample by sample.
    masks: [[u64; LANES]; SAMPLES],
    /// Those of which some samples did.
    any: [u64; LANES],
    /// Bits of the tile's blocks that were covered.
    touched: u64,
    /// All samples of a pixel are alike.
    alike: bool,
}

/// Adds pixels to those of each facet.
#[inline(always)]
fn join(all: &mut [u64; LANES], more: &[u64; LANES]) {
    for facet in 0..LANES {
        all[facet] |= more[facet];
    }
}

/// Depth tests of a sample of the pixels of `masks`, facet by facet, with their writes: those that pass remain.
#[inline(always)]
fn test(eight: &TinyEight, masks: &mut [u64; LANES], sample: usize, rule: DepthTest, stored: &mut [f32; TILE_PIXELS]) {
    match rule.func {
        Compare::Less => test_by(eight, masks, sample, rule.write, stored, |new, old| new < old),
        Compare::LessOrEqual => test_by(eight, masks, sample, rule.write, stored, |new, old| new <= old),
        func => test_by(eight, masks, sample, rule.write, stored, |new, old| holds(func, new, old)),
    }
}

#[inline(always)]
fn test_by(
    eight: &TinyEight,
    masks: &mut [u64; LANES],
    sample: usize,
    write: bool,
    stored: &mut [f32; TILE_PIXELS],
    passes: impl Fn(f32, f32) -> bool,
) {
    for (facet, mask) in masks.iter_mut().enumerate().take(eight.len()) {
        let (first, covered) = (eight.first(facet), *mask);
        for place in places(covered) {
            let old = &mut stored[pixel(first, place) % TILE_PIXELS];
            let new = eight.depth(facet, place, sample);
            let pass = passes(new, *old);
            *mask ^= u64::from(!pass) << place;
            if write {
                *old = if pass { new } else { *old };
            }
        }
    }
}
