//! Facets of at most 8x8 pixels, of which a fine mesh is made, eight of one draw at a time, where
//! nothing but depths and colours is written.
//!
//! Coverage and depths of all eight are computed together, then each facet's pixels meet the stored
//! depths, one after the other, since two facets may lie in one pixel. Where colours come from
//! corners and common textures they are found together again ([`super::shade::EightFacets`]); else
//! each facet colours its own pixels. The results are those of [`super::block`].

use super::assemble::{Facet, Primitives};
use super::block::{self, BlockWords, Passing, Words};
use super::fragment::{BlendPath, ColorTile, SAMPLES, stored_depth};
use super::fragment_ops::packed::add_words;
use super::fragment_ops::stencil::stencil_holds;
use super::pass::{DrawContext, facet_of};
use super::shade::{EightFacets, FacetPixels, Scratch, Shader, can_batch_facets};
use super::state::{Compare, DepthTest};
use super::tile::TileRun;
use crate::kernel::tiny::{PLACES, TinyEight, pixel, set_bits};
use crate::{BLOCK, SamplePattern, TILE_PIXELS};
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

/// What a tile's facets are drawn with, kept so that it need not be cleared. Colours lie on whole
/// lines of the cache: a row that is read as soon as it is written would be waited for long if it
/// lay on two.
#[repr(C, align(64))]
pub(super) struct FacetMemory {
    /// A block's colours.
    pub(super) words: BlockWords,
    pub(super) scratch: Scratch,
    /// Colours at places of tiny facets, of all eight.
    each: [[u32; LANES]; PLACES],
    /// Pixels of all eight that show.
    pixels: FacetPixels,
    pub(super) waiting: TinyFacets,
}

impl Default for FacetMemory {
    fn default() -> Self {
        Self {
            scratch: Scratch::default(),
            words: [0; BLOCK * BLOCK],
            each: [[0; LANES]; PLACES],
            pixels: FacetPixels::default(),
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

    /// Where one more, [`Self::takes`] it, has to be pushed.
    #[inline(always)]
    pub(super) fn next(&mut self, entry: usize, draw: u32) -> &mut TinyEight {
        self.entries[self.eight.len() % LANES] = entry;
        self.draw = draw;
        &mut self.eight
    }

    /// One of them.
    #[inline(always)]
    fn facet<'p>(&self, primitives: &'p Primitives, number: usize) -> &'p Facet {
        facet_of(primitives, primitives.batch.item(self.entries[number % LANES]).facet)
    }
}

/// Whether a draw's tiny facets may come this way.
pub(super) fn by_eights(draw: &DrawContext<'_>, run: &TileRun<'_>) -> bool {
    draw.ops.direct
        && !draw.layout.smooth[2]
        && !draw.state.unclamped_vertices
        && matches!(run.planes.samples, 1 | SAMPLES)
        && !matches!(run.planes.color, Some(ColorTile::RgbaF32(_)))
}

impl TileRun<'_> {
    /// Draws those that wait.
    #[inline(always)]
    pub(super) fn tiny_facets<S: Simd>(
        &mut self,
        simd: S,
        job: &JobContext<'_>,
        memory: &mut FacetMemory,
    ) {
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
    fn tiny_facets_apart<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        job: &JobContext<'_>,
        memory: &mut FacetMemory,
    ) {
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
        let Some(covered) = self.tiny_covered::<S, N>(simd, job, &mut memory.waiting) else {
            return;
        };
        let draw = &job.draws[memory.waiting.draw as usize];
        let mut seen = covered;
        if draw.state.alpha_test.is_none() {
            self.tiny_tested::<S, N>(simd, draw, &memory.waiting.eight, &mut seen, true);
            self.tiny_colored(simd, job, memory, &mut seen);
            return;
        }
        // Before the alpha test depths may be looked at, but not written. Mostly they are there
        // already, from a draw before.
        if !self.tiny_tested::<S, N>(simd, draw, &memory.waiting.eight, &mut seen, false) {
            self.tiny_colored(simd, job, memory, &mut seen);
            return;
        }
        // Else what one facet leaves may hide the next.
        for facet in 0..memory.waiting.eight.len() {
            let mut seen = covered.of(facet);
            self.tiny_tested::<S, N>(simd, draw, &memory.waiting.eight, &mut seen, false);
            self.tiny_colored(simd, job, memory, &mut seen);
            self.tiny_written::<N>(&memory.waiting.eight, &seen);
        }
    }

    /// What is covered and passes the stencil test. `None` if that is nothing.
    #[inline(always)]
    fn tiny_covered<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        job: &JobContext<'_>,
        waiting: &mut TinyFacets,
    ) -> Option<LiveSamples> {
        // Cover the samples and evaluate their depths.
        let draw = &job.draws[waiting.draw as usize];
        let (eight, pattern) = (&mut waiting.eight, job.pattern(draw));
        let scale = self.planes.depth.as_ref().map_or(1.0, |d| d.1);
        let mut positions = [[0; 2]; N];
        for (sample, position) in positions.iter_mut().enumerate() {
            *position = pattern.position(sample);
        }
        let masks = eight.cover(
            simd,
            (self.x, self.y),
            positions,
            #[inline(always)]
            |depth| stored_depth(simd, depth, scale),
        );
        // A draw without multisampling covers all samples of a pixel alike; where all have one
        // value, one stands for all.
        let mut seen = LiveSamples { masks, any: [0; LANES], touched: 0, alike: N == 1 };
        seen.settle(eight)?;
        if draw.state.stencil.is_some() {
            self.tiny_stencilled(job, waiting, &mut seen);
            seen.settle(&waiting.eight)?;
        }
        Some(seen)
    }

    /// Stencil test, which changes nothing.
    fn tiny_stencilled(
        &mut self,
        job: &JobContext<'_>,
        waiting: &TinyFacets,
        seen: &mut LiveSamples,
    ) {
        // Decide a tile that was only cleared with one test per facet.
        let draw = &job.draws[waiting.draw as usize];
        let (Some(test), Some(tile)) = (&draw.state.stencil, &mut self.planes.stencil) else {
            return;
        };
        let face = |facet: usize| {
            if waiting.facet(job.primitives, facet).back { &test.back } else { &test.front }
        };
        if let Some(value) = tile.uniform() {
            for facet in
                (0..waiting.eight.len()).filter(|&facet| !stencil_holds(face(facet), value))
            {
                seen.masks.iter_mut().for_each(|masks| masks[facet] = 0);
            }
            return;
        }

        // Test the stored value of each covered sample.
        let (count, stored) = tile.open(seen.touched, seen.alike, self.planes.samples);
        seen.alike &= count == 1;
        for (stored, masks) in
            stored.as_chunks::<TILE_PIXELS>().0.iter().zip(&mut seen.masks).take(count)
        {
            for facet in 0..waiting.eight.len() {
                let (face, first) = (face(facet), waiting.eight.first(facet));
                for place in set_bits(masks[facet]) {
                    let holds = stencil_holds(face, stored[pixel(first, place) % TILE_PIXELS]);
                    masks[facet] &= !(u64::from(!holds) << place);
                }
            }
        }
    }

    /// Depth test, with its writes if `write` is set and the draw writes depths. Otherwise, whether
    /// they would change anything.
    #[inline(always)]
    fn tiny_tested<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        draw: &DrawContext<'_>,
        eight: &TinyEight,
        seen: &mut LiveSamples,
        write: bool,
    ) -> bool {
        // Decide whether depths are written.
        let (Some(mut rule), Some((tile, _))) = (draw.state.depth, &mut self.planes.depth) else {
            return false;
        };
        let wanted = rule.write;
        rule.write &= write;
        if rule.write {
            self.planes.ranges.forget(seen.touched);
        }

        // Test four sample planes, or one that stands for all.
        let mut changes = false;
        let (count, stored) = tile.open(seen.touched, seen.alike, self.planes.samples);
        seen.alike &= count == 1;
        let planes = stored.as_chunks_mut::<TILE_PIXELS>().0;
        if let ([a, b, c, d, ..], SAMPLES) = (&mut *planes, count) {
            let depths = [0, 1 % N, 2 % N, 3 % N];
            changes = test(simd, eight, seen, rule, [a, b, c, d], depths);
        } else if let [plane, ..] = planes {
            changes = test(simd, eight, seen, rule, [plane], [0]);
        }

        // Join the masks of the samples.
        seen.join();
        wanted && !write && changes
    }

    /// Writes depths of what is seen, if there are any.
    fn tiny_written<const N: usize>(&mut self, eight: &TinyEight, seen: &LiveSamples) {
        let Some((tile, _)) = &mut self.planes.depth else { return };
        self.planes.ranges.forget(seen.touched);
        let (count, stored) = tile.open(seen.touched, seen.alike, self.planes.samples);
        for (sample, stored) in
            stored.as_chunks_mut::<TILE_PIXELS>().0.iter_mut().enumerate().take(count)
        {
            for (facet, &mask) in seen.masks[sample].iter().enumerate().take(eight.len()) {
                let first = eight.first(facet);
                for place in set_bits(mask) {
                    stored[pixel(first, place) % TILE_PIXELS] =
                        eight.depth(facet, place, sample % N);
                }
            }
        }
    }

    /// Colours the visible pixels, and removes those that fail the alpha test from `seen`.
    #[inline(never)]
    fn tiny_colored<S: Simd>(
        &mut self,
        simd: S,
        job: &JobContext<'_>,
        memory: &mut FacetMemory,
        seen: &mut LiveSamples,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.tiny_colored_inlined(simd, job, memory, seen),
        );
    }

    #[inline(always)]
    fn tiny_colored_inlined<S: Simd>(
        &mut self,
        simd: S,
        job: &JobContext<'_>,
        memory: &mut FacetMemory,
        seen: &mut LiveSamples,
    ) {
        // Skip draws that write no colours.
        let FacetMemory { scratch, words, each, pixels, waiting } = memory;
        let (eight, draw) = (&waiting.eight, &job.draws[waiting.draw as usize]);
        if !draw.shaded || seen.any == [0; LANES] {
            return;
        }

        // Shade all facets at once if the draw allows it.
        if self.tiny_shaded(simd, job, waiting, seen, pixels, each) {
            return self.tiny_mixed(simd, draw, eight, seen, each, words);
        }

        // Otherwise shade facet by facet.
        for facet in 0..eight.len() {
            if seen.any[facet] == 0 {
                continue;
            }
            let setup = job.primitives.batch.item(waiting.entries[facet]);
            let (own, tile) =
                (facet_of(job.primitives, setup.facet), [self.x as f32, self.y as f32]);
            let mut shader = Shader::new(own, draw, job.primitives, tile, scratch);
            let block = eight.block(facet, seen.any[facet]);
            let corner = (self.x as usize + block.x, self.y as usize + block.y);
            let (one, visible) = shader.block(simd, setup, corner, seen.any[facet], words);
            let masks = seen.limit(facet, visible);
            block::colors(
                simd,
                &block,
                &mut self.planes,
                (&draw.ops, draw.state),
                &Words::of(one, words),
                &masks,
            );
        }
    }

    /// The colours at the places of all facets that are seen, and the alpha test, if that can be
    /// found for all together; whether it can.
    #[inline(always)]
    fn tiny_shaded<S: Simd>(
        &mut self,
        simd: S,
        job: &JobContext<'_>,
        waiting: &TinyFacets,
        seen: &mut LiveSamples,
        pixels: &mut FacetPixels,
        each: &mut [[u32; LANES]; PLACES],
    ) -> bool {
        let (eight, draw) = (&waiting.eight, &job.draws[waiting.draw as usize]);
        // Lanes without a facet of their own repeat the first one's.
        let mut facets = [waiting.facet(job.primitives, 0); LANES];
        for lane in 1..eight.len() {
            facets[lane] = waiting.facet(job.primitives, lane);
        }

        // Take constant colours, or interpolate and sample for all facets.
        let mut shown = seen.any;
        if draw.constant {
            let mut words = [0; LANES];
            for lane in 0..LANES {
                let (word, passes) = Shader::constant_of(draw, facets[lane], job.primitives);
                words[lane] = word;
                shown[lane] = if passes { shown[lane] } else { 0 };
            }
            set_bits(shown.iter().fold(0, |all, mask| all | mask))
                .for_each(|place| each[place] = words);
        } else if can_batch_facets(draw) {
            let tile = [self.x, self.y];
            let Some(colors) = EightFacets::new(simd, eight, &facets, (draw, job.primitives), tile)
            else {
                return false;
            };
            colors.colors(simd, eight, tile, &mut shown, pixels, each);
        } else {
            return false;
        }

        // Limit the masks to what passed the alpha test.
        for facet in 0..LANES {
            if shown[facet] != seen.any[facet] {
                seen.limit(facet, shown[facet]);
            }
        }
        true
    }

    /// Brings colours of places to the samples that are seen, one facet's after the other.
    #[inline(always)]
    fn tiny_mixed<S: Simd>(
        &mut self,
        simd: S,
        draw: &DrawContext<'_>,
        eight: &TinyEight,
        seen: &LiveSamples,
        each: &[[u32; LANES]; PLACES],
        words: &mut BlockWords,
    ) {
        // Write all facets at once where colours replace or add.
        let Some(ColorTile::Rgba8(plane)) = &mut self.planes.color else { return };
        let adds = draw.ops.blend_path == BlendPath::Add;
        if draw.ops.protected == 0 && (adds || draw.ops.blend_path == BlendPath::Replace) {
            let (count, values) = plane.open(seen.touched, seen.alike, self.planes.samples);
            let planes = values.as_chunks_mut::<TILE_PIXELS>().0;
            if let ([a, b, c, d, ..], SAMPLES) = (&mut *planes, count) {
                bring(simd, eight, seen, adds, each, [a, b, c, d]);
            } else if let [plane, ..] = planes {
                bring(simd, eight, seen, adds, each, [plane]);
            }
            return;
        }

        // Blend other colours facet by facet.
        for facet in (0..eight.len()).filter(|&facet| seen.any[facet] != 0) {
            set_bits(seen.any[facet])
                .for_each(|place| words[place % PLACES] = each[place % PLACES][facet]);
            let (block, masks) =
                (eight.block(facet, seen.any[facet]), seen.masks.map(|masks| masks[facet]));
            block::colors(
                simd,
                &block,
                &mut self.planes,
                (&draw.ops, draw.state),
                &Words::Each(words),
                &masks,
            );
        }
    }
}

/// The samples of eight tiny facets that have passed all tests so far.
#[derive(Clone, Copy)]
struct LiveSamples {
    /// Those of each facet, sample by sample.
    masks: [[u64; LANES]; SAMPLES],
    /// Those of which some samples are.
    any: [u64; LANES],
    /// Bits of the tile's blocks that they may lie in.
    touched: u64,
    /// All samples of a pixel are alike: the first one's say it for all.
    alike: bool,
}

impl LiveSamples {
    /// After masks have changed, brings the rest up to date.
    #[inline(always)]
    fn join(&mut self) {
        if self.alike {
            self.masks = [self.masks[0]; SAMPLES];
        }
        let [a, b, c, d] = &self.masks;
        for facet in 0..LANES {
            self.any[facet] = a[facet] | b[facet] | c[facet] | d[facet];
        }
    }

    /// [`Self::join`], and finds the blocks. `None` if nothing is left.
    #[inline(always)]
    fn settle(&mut self, eight: &TinyEight) -> Option<()> {
        self.join();
        self.touched = 0;
        for facet in (0..eight.len()).filter(|&facet| self.any[facet] != 0) {
            self.touched |= eight.block(facet, self.any[facet]).touched();
        }
        (self.touched != 0).then_some(())
    }

    /// The pixels of one facet in the first `M` planes of samples.
    #[inline(always)]
    fn masks_of<const M: usize>(&self, facet: usize) -> [u64; M] {
        let mut masks = [0; M];
        for s in 0..M {
            masks[s] = self.masks[s][facet];
        }
        masks
    }

    /// One facet's.
    fn of(&self, facet: usize) -> Self {
        let alone =
            |masks: &[u64; LANES]| std::array::from_fn(|f| if f == facet { masks[f] } else { 0 });
        Self {
            masks: std::array::from_fn(|s| alone(&self.masks[s])),
            any: alone(&self.any),
            ..*self
        }
    }

    /// Leaves of a facet's pixels those that are `visible`.
    #[inline(always)]
    fn limit(&mut self, facet: usize, visible: u64) -> [u64; SAMPLES] {
        self.any[facet] &= visible;
        self.masks.each_mut().map(|masks| {
            masks[facet] &= visible;
            masks[facet]
        })
    }
}

/// Brings colours of places to the samples that are seen, facet by facet, in `M` planes of samples.
/// All planes for one facet, then the next: plane by plane for all facets costs crowds of small
/// bodies 5 % of a frame, here and in the depth test.
#[inline(never)]
fn bring<S: Simd, const M: usize>(
    simd: S,
    eight: &TinyEight,
    seen: &LiveSamples,
    adds: bool,
    each: &[[u32; LANES]; PLACES],
    values: [&mut [u32; TILE_PIXELS]; M],
) {
    simd.vectorize(
        #[inline(always)]
        || {
            for facet in 0..eight.len() {
                let (first, masks) = (eight.first(facet), seen.masks_of::<M>(facet));
                for s in 0..M {
                    for place in set_bits(masks[s]) {
                        let value = &mut values[s][pixel(first, place) % TILE_PIXELS];
                        let new = each[place % PLACES][facet];
                        *value = if adds { add_words(new, *value) } else { new };
                    }
                }
            }
        },
    );
}

/// Depth tests of visible samples, facet by facet, with their writes: passing ones remain. Gives
/// whether something of that is not the depth that was stored. A plane of samples meets the facets'
/// depths of the sample that `depths` says.
#[inline(never)]
fn test<S: Simd, const M: usize>(
    simd: S,
    eight: &TinyEight,
    seen: &mut LiveSamples,
    rule: DepthTest,
    stored: [&mut [f32; TILE_PIXELS]; M],
    depths: [usize; M],
) -> bool {
    simd.vectorize(
        #[inline(always)]
        || match (rule.func, rule.write) {
            (Compare::LessOrEqual, true) => {
                test_by(eight, seen, true, stored, depths, |new, old| new <= old)
            }
            (Compare::LessOrEqual, false) => {
                test_by(eight, seen, false, stored, depths, |new, old| new <= old)
            }
            (Compare::GreaterOrEqual, true) => {
                test_by(eight, seen, true, stored, depths, |new, old| new >= old)
            }
            (Compare::GreaterOrEqual, false) => {
                test_by(eight, seen, false, stored, depths, |new, old| new >= old)
            }
            (Compare::Less, true) => {
                test_by(eight, seen, true, stored, depths, |new, old| new < old)
            }
            (func, write) => {
                let passing = Passing::new(func);
                let passes =
                    |new, old| passing.of(u32::from(new >= old), u32::from(new <= old)) & 1 == 1;
                test_by(eight, seen, write, stored, depths, passes)
            }
        },
    )
}

#[inline(always)]
fn test_by<const M: usize>(
    eight: &TinyEight,
    seen: &mut LiveSamples,
    write: bool,
    stored: [&mut [f32; TILE_PIXELS]; M],
    depths: [usize; M],
    passes: impl Fn(f32, f32) -> bool,
) -> bool {
    // Test facets in their order, since two may lie in one pixel.
    let mut changes = false;
    for facet in 0..eight.len() {
        let (first, mut masks) = (eight.first(facet), seen.masks_of::<M>(facet));
        for s in 0..M {
            for place in set_bits(masks[s]) {
                let old = &mut stored[s][pixel(first, place) % TILE_PIXELS];
                let new = eight.depth(facet, place, depths[s]);
                let pass = passes(new, *old);
                masks[s] ^= u64::from(!pass) << place;
                if write {
                    *old = if pass { new } else { *old };
                } else {
                    changes |= pass & (new != *old);
                }
            }
            seen.masks[s][facet] = masks[s];
        }
    }
    changes
}
