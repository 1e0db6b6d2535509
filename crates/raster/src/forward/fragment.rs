//! What happens to the fragments of a row of eight pixels: the specification's per-fragment
//! operations, in their order.
//!
//! Scissor (the clip rectangle), alpha test, stencil test, depth test, blending, logic operation,
//! masks. Depth is looked at once before colours are computed, without writing, so that hidden
//! fragments are not shaded; nothing can tell, because a fragment that fails the depth test changes
//! at most the stencil.

use super::depth_ranges::DepthRanges;
use super::fragment_ops::blend::{Components, blend, blend_packed};
use super::fragment_ops::compare::{alpha_test, depth_test};
use super::fragment_ops::coverage::{alpha_coverage, sample_coverage_bits};
use super::fragment_ops::logic::{
    logic_op, logic_op_of_16_bits, protected_bits, write_unprotected,
};
use super::fragment_ops::packed::{add_packed, add_scaled_packed, mix_packed, pack, unpack};
use super::fragment_ops::stencil::{load_stencil, stencil_test, stencil_update, store_stencil};
use super::plane::PlaneTile;
use super::state::{
    Blend, BlendEquation, BlendFactor, Clamping, Compare, FragmentState, LogicOp, StencilFace,
    StencilOp,
};
use super::wide::{Rgba, bits_of, every, floor, mask_of, saturate_rgba, select, splat};
use crate::{TILE, TILE_PIXELS};
use std::sync::atomic::Ordering;
use vitral_math::color::{linear_from_srgb, srgb_from_linear};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Floats, LANES, Simd, U32x8};

/// The colour samples of a tile.
pub(crate) enum ColorTile<'a> {
    /// Packed bytes.
    Rgba8(&'a mut PlaneTile<u32>),
    /// Floating point.
    RgbaF32(&'a mut PlaneTile<[f32; 4]>),
}

/// The planes of one tile.
pub(crate) struct TilePlanes<'a> {
    /// Colour.
    pub color: Option<ColorTile<'a>>,
    /// Depth and its scale.
    pub depth: Option<(&'a mut PlaneTile<f32>, f32)>,
    /// Stencil values, if the target has them.
    pub stencil: Option<&'a mut PlaneTile<u8>>,
    /// Samples a pixel.
    pub samples: usize,
    /// What is known of depths.
    pub ranges: DepthRanges,
}

impl<'a> TilePlanes<'a> {
    /// Planes of whose depths nothing is known yet.
    pub(crate) fn new(
        color: Option<ColorTile<'a>>,
        depth: Option<(&'a mut PlaneTile<f32>, f32)>,
        stencil: Option<&'a mut PlaneTile<u8>>,
        samples: usize,
    ) -> Self {
        Self { color, depth, stencil, samples, ranges: DepthRanges::new() }
    }

    /// Notes that the tile's colours may change.
    pub(crate) fn set_changed(&mut self) {
        match &mut self.color {
            Some(ColorTile::Rgba8(tile)) => tile.set_changed(),
            Some(ColorTile::RgbaF32(tile)) => tile.set_changed(),
            None => {}
        }
    }

    /// The same planes, for a while.
    pub(crate) fn reborrow(&mut self) -> TilePlanes<'_> {
        let color = self.color.as_mut().map(|color| match color {
            ColorTile::Rgba8(tile) => ColorTile::Rgba8(tile),
            ColorTile::RgbaF32(tile) => ColorTile::RgbaF32(tile),
        });
        let depth = self.depth.as_mut().map(|(tile, scale)| (&mut **tile, *scale));
        TilePlanes::new(color, depth, self.stencil.as_deref_mut(), self.samples)
    }
}

/// Most samples a pixel.
pub(crate) const SAMPLES: usize = 4;

/// Depths of a row's samples as they would be stored.
pub(crate) type Depths<S> = [F32x8<S>; SAMPLES];

/// Depth in `0..=1` as stored: scaled and rounded to whole numbers, unless the scale is 1.
#[inline(always)]
pub(crate) fn stored_depth<S: Simd, V: Floats<S>>(simd: S, depth: V, scale: f32) -> V {
    if scale == 1.0 {
        return depth;
    }
    let scaled = depth * scale;
    // From 2^23 on every number is whole, and adding a half would round again.
    let half = select(
        scaled.simd_lt(every::<S, V>(simd, 8_388_608.0)),
        every(simd, 0.5),
        every::<S, V>(simd, 0.0),
    );
    floor(scaled + half)
}

/// [`stored_depth`] of one depth.
pub(crate) fn stored(depth: f32, scale: f32) -> f32 {
    if scale == 1.0 {
        return depth;
    }
    let scaled = depth * scale;
    // From 2^23 on every number is whole, and adding a half would round again.
    if scaled < 8_388_608.0 { (scaled + 0.5) as u32 as f32 } else { scaled as u32 as f32 }
}

/// How colours meet stored ones, decided once a draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BlendPath {
    /// The new colour replaces the stored one.
    Replace,
    /// Both are added and saturate.
    Add,
    /// The new colour times its alpha is added.
    AddScaled,
    /// Both are mixed by the new colour's alpha.
    Mix,
    /// Any other factors and equations.
    General,
    /// A logical operation on the bits.
    Logic(LogicOp),
}

impl BlendPath {
    /// Whether it is one of the ways that programs use most.
    #[inline(always)]
    pub(crate) fn is_simple(self) -> bool {
        !matches!(self, Self::General | Self::Logic(_))
    }

    /// What such a way stores where new words meet old ones.
    #[inline(always)]
    pub(crate) fn blend_fast<S: Simd, W: SimdInt<S, Element = u32>>(self, new: W, old: W) -> W {
        match self {
            Self::Add => add_packed(new, old),
            Self::AddScaled => add_scaled_packed(new, old),
            Self::Mix => mix_packed(new, old),
            Self::Replace | Self::General | Self::Logic(_) => new,
        }
    }
}

/// The part of a draw's fragment state that needs some work first.
#[derive(Debug)]
pub(crate) struct FragmentOps {
    pub(crate) blend_path: BlendPath,
    /// Bits of a packed colour that the mask keeps from being written.
    pub(crate) protected: u32,
    /// Nothing needs the row-by-row operations, see [`super::block`].
    pub(crate) common: bool,
    /// Common, and nothing but depths and colours is written, see [`super::tiny_eight`].
    pub(crate) direct: bool,
    pub(crate) all_protected: bool,
    coverage: u32,
}

impl FragmentOps {
    pub(crate) fn new(state: &FragmentState, samples: usize) -> Self {
        let all = (1u32 << samples) - 1;
        let coverage = match state.sample_coverage {
            Some(c) if state.multisample && samples > 1 => sample_coverage_bits(c, samples),
            _ => all,
        };
        let protected = protected_bits(state.masked);
        let blend_path = blend_path(state);
        let writes_stencil = !state.stencil.is_none_or(|s| keeps(&s.front) && keeps(&s.back));
        // The alpha test comes before a stencil that changes.
        let by_rows = (writes_stencil && state.alpha_test.is_some())
            || state.srgb
            || state.sample_coverage.is_some();
        let common = !(by_rows || state.alpha_to_coverage || state.alpha_to_one);
        let direct =
            common && !writes_stencil && state.query.is_none() && state.polygon_stipple.is_none();
        Self {
            blend_path,
            protected,
            common,
            direct,
            all_protected: state.masked == [true; 4],
            coverage,
        }
    }
}

/// Whether a stencil test changes nothing.
pub(crate) fn keeps(face: &StencilFace) -> bool {
    face.write_mask == 0 || [face.fail, face.depth_fail, face.pass] == [StencilOp::Keep; 3]
}

fn blend_path(state: &FragmentState) -> BlendPath {
    use BlendFactor::{One, OneMinusSrcAlpha, SrcAlpha, Zero};

    // Logical operations take precedence over blending.
    if let Some(op) = state.logic_op {
        return BlendPath::Logic(op);
    }

    // Recognise the common factors; everything else is general.
    let Some(Blend { source, destination, equation, .. }) = state.blend else {
        return BlendPath::Replace;
    };
    if equation != [BlendEquation::Add; 2] {
        return BlendPath::General;
    }
    match (source, destination) {
        ([One, One], [Zero, Zero]) => BlendPath::Replace,
        ([One, One], [One, One]) => BlendPath::Add,
        ([SrcAlpha, SrcAlpha], [One, One]) => BlendPath::AddScaled,
        ([SrcAlpha, SrcAlpha], [OneMinusSrcAlpha, OneMinusSrcAlpha]) => BlendPath::Mix,
        _ => BlendPath::General,
    }
}

/// A row of eight pixels of a tile: where it begins in each sample's part of a plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneRow {
    /// `y * TILE + x`, x a multiple of 8.
    pub at: usize,
}

/// What a facet has in the eight pixels of a row.
pub(crate) struct RowFragments<'a, S: Simd> {
    pub row: PlaneRow,
    /// Of a back-facing polygon.
    pub back: bool,
    /// The pixels whose sample is covered, for each sample.
    pub bits: [u32; SAMPLES],
    pub depths: &'a Depths<S>,
    pub color: Rgba<S>,
}

/// Leaves out of `bits` the pixels that fail the alpha test, and the samples that multisampling
/// does not cover.
#[inline(always)]
fn mask_coverage<S: Simd>(
    simd: S,
    state: &FragmentState,
    ops: &FragmentOps,
    samples: usize,
    bits: &mut [u32; SAMPLES],
    color: &mut Rgba<S>,
) {
    // Apply the alpha test.
    if let Some(test) = state.alpha_test {
        let passed = bits_of(alpha_test(simd, test, color[3]));
        for s in 0..samples {
            bits[s] &= passed;
        }
    }

    // Apply alpha to coverage and the sample mask.
    if samples > 1 && state.multisample {
        for s in 0..samples {
            if state.alpha_to_coverage {
                bits[s] &= alpha_coverage(simd, color[3], s, samples);
            }
            if ops.coverage >> s & 1 == 0 {
                bits[s] = 0;
            }
        }
        if state.alpha_to_one {
            color[3] = splat(simd, 1.0);
        }
    }
}

impl TilePlanes<'_> {
    /// Which of the covered samples would pass the depth test, if that can be told before stencil
    /// and alpha test.
    #[inline(always)]
    pub(crate) fn visible<S: Simd>(
        &mut self,
        simd: S,
        state: &FragmentState,
        row: PlaneRow,
        bits: &[u32; SAMPLES],
        depths: &Depths<S>,
    ) -> [u32; SAMPLES] {
        let mut visible = *bits;

        // Leave what the stencil test may change, and what always passes.
        let (Some(test), None, Some((tile, _))) = (state.depth, &state.stencil, &mut self.depth)
        else {
            return visible;
        };
        if test.func == Compare::Always {
            return visible;
        }

        // Test each sample plane against the stored depths.
        for s in 0..self.samples {
            if bits[s] == 0 {
                continue;
            }
            let at = s * TILE_PIXELS + row.at;
            let stored = match tile.uniform() {
                Some(value) => splat(simd, value),
                None => F32x8::from_slice(simd, &tile.stored(self.samples)[at..at + LANES]),
            };
            visible[s] &= bits_of(depth_test(simd, test, depths[s], stored));
        }
        visible
    }

    /// Alpha test, coverage by alpha, stencil and depth test with their writes, and the colour of
    /// what passes. `settled`: [`Self::visible`] has left the samples that pass stencil and depth
    /// test.
    #[inline(always)]
    pub(crate) fn fragments<S: Simd>(
        &mut self,
        simd: S,
        state: &FragmentState,
        ops: &FragmentOps,
        fragments: RowFragments<'_, S>,
        settled: bool,
    ) {
        let RowFragments { row, back, mut bits, depths, mut color } = fragments;
        let samples = self.samples;

        // Drop what fails the alpha test and what multisample coverage leaves out.
        mask_coverage(simd, state, ops, samples, &mut bits, &mut color);
        let any = bits[0] | bits[1] | bits[2] | bits[3];
        if any == 0 {
            return;
        }

        // Test stencil and depth, or write the depths if the tests have been made.
        let mut passed = bits;
        let mut count = 0;
        if settled {
            for s in 0..samples {
                count += u64::from(bits[s].count_ones());
                self.write_depth(simd, state, s, row, bits[s], depths[s]);
            }
        }
        for s in 0..if settled { 0 } else { samples } {
            if bits[s] != 0 {
                passed[s] = self.tests(simd, state, s, row, back, bits[s], depths[s]);
                count += u64::from(passed[s].count_ones());
            }
        }

        // Count what passes for a query, and blend its colours.
        if let Some(query) = &state.query {
            query.fetch_add(count, Ordering::Relaxed);
        }
        if count > 0 && !ops.all_protected {
            self.write_colors(simd, state, ops, row, &passed, &color);
        }
    }

    /// Writes the depths of pixels that have passed.
    #[inline(always)]
    fn write_depth<S: Simd>(
        &mut self,
        simd: S,
        state: &FragmentState,
        s: usize,
        row: PlaneRow,
        bits: u32,
        depth: F32x8<S>,
    ) {
        if bits == 0 || !state.depth.is_some_and(|test| test.write) {
            return;
        }
        if let Some((tile, _)) = &mut self.depth {
            self.ranges.forget(u64::MAX);
            let at = s * TILE_PIXELS + row.at;
            let values = &mut tile.stored(self.samples)[at..at + LANES];
            if bits == 0xff {
                depth.store_slice(values);
            } else {
                let stored = F32x8::from_slice(simd, values);
                select(mask_of(simd, bits), depth, stored).store_slice(values);
            }
        }
    }

    /// Stencil and depth test of one sample plane; which pixels pass.
    #[inline(always)]
    fn tests<S: Simd>(
        &mut self,
        simd: S,
        state: &FragmentState,
        s: usize,
        row: PlaneRow,
        back: bool,
        bits: u32,
        depth: F32x8<S>,
    ) -> u32 {
        // Run the stencil test.
        let samples = self.samples;
        let at = s * TILE_PIXELS + row.at;
        let covered = mask_of(simd, bits);
        let mut stencil = None;
        let mut reached = covered;
        if let (Some(test), Some(tile)) = (&state.stencil, &mut self.stencil) {
            let face: StencilFace = if back { test.back } else { test.front };
            let values = &mut tile.stored(samples)[at..at + LANES];
            let stored = load_stencil(simd, values);
            let passed = stencil_test(simd, &face, stored);
            reached = covered & passed;
            stencil = Some((face, stored, passed));
        }

        // Run the depth test and write the depths that pass.
        let mut passed = reached;
        if let (Some(test), Some((tile, _))) = (state.depth, &mut self.depth) {
            let plain = test.func == Compare::Always;
            if !plain || test.write {
                self.ranges.forget(u64::MAX);
                let values = &mut tile.stored(samples)[at..at + LANES];
                let stored = F32x8::from_slice(simd, values);
                passed = reached & depth_test(simd, test, depth, stored);
                if test.write {
                    select(passed, depth, stored).store_slice(values);
                }
            }
        }

        // Update the stencil values by the outcomes.
        if let (Some((face, stored, stencil_passed)), Some(tile)) = (stencil, &mut self.stencil) {
            let updated = stencil_update(simd, &face, stored, covered, stencil_passed, passed);
            store_stencil(updated, &mut tile.stored(samples)[at..at + LANES]);
        }
        bits_of(passed)
    }

    #[inline(always)]
    fn write_colors<S: Simd>(
        &mut self,
        simd: S,
        state: &FragmentState,
        ops: &FragmentOps,
        row: PlaneRow,
        bits: &[u32; SAMPLES],
        color: &Rgba<S>,
    ) {
        let samples = self.samples;

        // Pack and write sample by sample, by the format of the colour plane.
        match &mut self.color {
            None => {}
            Some(ColorTile::Rgba8(tile)) => {
                let values = tile.stored(samples);
                let color = saturate_rgba(*color);
                let packed = pack(&color);
                for s in 0..samples {
                    if bits[s] == 0 {
                        continue;
                    }
                    let at = s * TILE_PIXELS + row.at;
                    let values = &mut values[at..at + LANES];
                    write_packed(simd, state, ops, bits[s], &color, packed, values);
                }
            }
            Some(ColorTile::RgbaF32(tile)) => {
                let values = tile.stored(samples);
                for s in 0..samples {
                    if bits[s] != 0 {
                        let at = s * TILE_PIXELS + row.at;
                        write_floats(simd, state, bits[s], color, &mut values[at..at + LANES]);
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn write_packed<S: Simd>(
    simd: S,
    state: &FragmentState,
    ops: &FragmentOps,
    bits: u32,
    color: &Rgba<S>,
    packed: U32x8<S>,
    values: &mut [u32],
) {
    // Combine the new and the stored words.
    let stored = U32x8::from_slice(simd, values);
    let mut new = match (ops.blend_path, &state.blend) {
        (BlendPath::General, Some(b)) => general_packed(simd, b, packed, stored),
        (BlendPath::Logic(op), _) => logic_op(op, packed, stored),
        (blend_path, _) => blend_path.blend_fast(packed, stored),
    };
    if state.srgb && state.logic_op.is_none() {
        new = srgb_packed(simd, state, color, stored);
    }

    // Keep the protected bits, and write the pixels of the mask.
    if ops.protected != 0 {
        new = write_unprotected(new, stored, ops.protected);
    }
    if bits == 0xff {
        new.store_slice(values);
    } else {
        mask_of(simd, bits).select(new, stored).store_slice(values);
    }
}

/// The seldom factors and equations, kept out of line.
#[inline(never)]
fn general_packed<S: Simd>(simd: S, state: &Blend, color: U32x8<S>, stored: U32x8<S>) -> U32x8<S> {
    simd.vectorize(
        #[inline(always)]
        || blend_packed::<S, F32x8<S>>(simd, state, color, stored),
    )
}

/// Colours that are stored sRGB-encoded: decoded, blended, encoded.
#[inline(never)]
fn srgb_packed<S: Simd>(
    simd: S,
    state: &FragmentState,
    color: &Rgba<S>,
    stored: U32x8<S>,
) -> U32x8<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            // Decode the stored colours to linear light.
            let mut old = unpack(stored);
            for component in &mut old[..3] {
                *component = F32x8::from_slice(simd, &component.to_array().map(linear_from_srgb));
            }

            // Blend and encode.
            let mut new = match &state.blend {
                Some(b) => blend(simd, b, *color, old, Components::Unit),
                None => *color,
            };
            for component in &mut new[..3] {
                *component = F32x8::from_slice(simd, &component.to_array().map(srgb_from_linear));
            }
            pack(&saturate_rgba(new))
        },
    )
}

#[inline(never)]
fn write_floats<S: Simd>(
    simd: S,
    state: &FragmentState,
    bits: u32,
    color: &Rgba<S>,
    values: &mut [[f32; 4]],
) {
    simd.vectorize(
        #[inline(always)]
        || {
            // Transpose eight stored pixels to components.
            let mut soa = [[0.0f32; LANES]; 4];
            for lane in 0..LANES {
                for k in 0..4 {
                    soa[k][lane] = values[lane][k];
                }
            }

            // Clamp and blend.
            let clamped = state.clamping != Clamping::None;
            let color = if clamped { saturate_rgba(*color) } else { *color };
            let mut new = color;
            if let (Some(b), None) = (&state.blend, state.logic_op) {
                let stored = [
                    F32x8::from_slice(simd, &soa[0]),
                    F32x8::from_slice(simd, &soa[1]),
                    F32x8::from_slice(simd, &soa[2]),
                    F32x8::from_slice(simd, &soa[3]),
                ];
                let results = state.clamping == Clamping::Results;
                new = blend(
                    simd,
                    b,
                    color,
                    stored,
                    if results { Components::Unit } else { Components::Unclamped },
                );
            }
            let mut new =
                [new[0].to_array(), new[1].to_array(), new[2].to_array(), new[3].to_array()];
            // Floating-point colours have no bits to combine.
            if let (Some(op), Clamping::Results) = (state.logic_op, state.clamping) {
                let both = new.as_flattened_mut().iter_mut().zip(soa.as_flattened());
                both.for_each(|(new, &stored)| *new = logic_op_of_16_bits(op, *new, stored));
            }

            // Write the components that no mask protects.
            for lane in 0..LANES {
                for k in 0..4 {
                    if bits >> lane & 1 == 1 && !state.masked[k] {
                        values[lane][k] = new[k][lane];
                    }
                }
            }
        },
    );
}

/// The bits of a row's eight pixels whose columns lie in `x0..x1`, given the row's first column.
#[inline(always)]
pub(crate) fn columns(first: i32, x0: i32, x1: i32) -> u32 {
    let low = (x0 - first).clamp(0, 8);
    let high = (x1 - first).clamp(0, 8);
    if high <= low { 0 } else { ((1u32 << high) - 1) & !((1u32 << low) - 1) }
}

const _: () =
    assert!(TILE.is_multiple_of(LANES), "rows of a tile are cut into whole rows of eight");
