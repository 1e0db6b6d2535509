//! The common case: two dimensions, 8 bits a component, no border in reach.
//!
//! All lanes are looked up together, each on the level that it needs: a level is only a slice of texels and a size.

use super::fetch::{Words, interior};
use super::mip::{Choice, choose, mix_rgba};
use super::wrap::{Axis, linear_in, nearest_in, position_in};
use crate::forward::texture::{Filter, Sampler, Texture, TextureKind, Wrap};
use crate::forward::wide::{Rgba, bits_of, floor, mask_of, max, min, select_rgba, splat};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Simd, U32x8};

/// Most levels: the largest texture has 2^14 texels a side.
const LEVELS: usize = 16;

/// A texture's levels, made ready for lookups.
#[derive(Clone, Copy)]
pub(crate) struct Packed<'a> {
    levels: [&'a [u32]; LEVELS],
    last: usize,
    /// Of level 0, in texels.
    size: [f32; 2],
    /// Level 0, for what bytes mean.
    first: Words<'a>,
    sampler: &'a Sampler,
}

/// Whether no lookup can reach a border along s and t.
fn stays_inside(wrap: &[Wrap; 3]) -> bool {
    wrap[..2].iter().all(|wrap| !matches!(wrap, Wrap::Clamp | Wrap::ClampToBorder))
}

impl<'a> Packed<'a> {
    /// `None` for textures of another kind.
    pub(crate) fn new(texture: &'a Texture) -> Option<Self> {
        let [levels] = &texture.faces[..] else { return None };
        let first = levels.first()?;
        if texture.kind != TextureKind::Two || levels.len() > LEVELS || !stays_inside(&texture.sampler.wrap) {
            return None;
        }
        let [width, height, _] = interior(first, 2);
        let mut slices: [&[u32]; LEVELS] = [&[]; LEVELS];
        for (k, (slice, level)) in slices.iter_mut().zip(levels).enumerate() {
            let size = [(width >> k).max(1), (height >> k).max(1)];
            if level.border != 0 || level.size[..2] != size {
                return None;
            }
            *slice = Words::new(level)?.texels;
        }
        let (last, size) = (levels.len() - 1, [width as f32, height as f32]);
        Some(Self { levels: slices, last, size, first: Words::new(first)?, sampler: &texture.sampler })
    }

    /// Whether the level of detail can matter.
    #[inline(always)]
    pub(crate) fn needs_lod(&self) -> bool {
        self.sampler.min != self.sampler.mag
    }

    /// Width and height of level 0.
    #[inline(always)]
    pub(crate) fn size(&self) -> [f32; 2] {
        self.size
    }

    /// The colours at (s, t), as [`super::sample`] tells.
    #[inline(always)]
    pub(crate) fn at<S: Simd>(&self, simd: S, place: [F32x8<S>; 2], lod: F32x8<S>, active: u32) -> Rgba<S> {
        let zero = splat(simd, 0.0);
        let choice = if self.needs_lod() {
            choose(simd, self.sampler, self.last, lod)
        } else {
            let linear = if self.sampler.mag == Filter::Linear { u32::MAX } else { 0 };
            Choice { level: zero, fraction: zero, linear }
        };
        let active = active & 0xff;
        let linear = choice.linear & active;
        let mut color = self.filtered(simd, place, &choice, linear == active);
        if linear != 0 && linear != active {
            color = select_rgba(mask_of(simd, linear), self.filtered(simd, place, &choice, true), color);
        }
        self.first.finish(color)
    }

    /// Raw colours, all lanes with one filter within a level.
    #[inline(always)]
    fn filtered<S: Simd>(&self, simd: S, place: [F32x8<S>; 2], choice: &Choice<S>, linear: bool) -> Rgba<S> {
        let color = self.level(simd, place, choice.level, linear);
        if bits_of(choice.fraction.simd_gt(splat(simd, 0.0))) == 0 {
            return color;
        }
        let next = min(choice.level + 1.0, splat(simd, self.last as f32));
        mix_rgba(color, self.level(simd, place, next, linear), choice.fraction)
    }

    /// Raw colours of one level a lane.
    #[inline(never)]
    fn level<S: Simd>(&self, simd: S, place: [F32x8<S>; 2], level: F32x8<S>, filtered: bool) -> Rgba<S> {
        simd.vectorize(
            #[inline(always)]
            || {
                let shrink = lanes::Lanes::exp2_whole(-level);
                let [wrap_s, wrap_t, _] = self.sampler.wrap;
                let one = splat(simd, 1.0);
                let (width, height) = (max(floor(shrink * self.size[0]), one), max(floor(shrink * self.size[1]), one));
                let x = position_in(simd, place[0], width, wrap_s);
                let y = position_in(simd, place[1], height, wrap_t);
                let (level, stride): (I32x8<S>, I32x8<S>) = (level.to_int(), width.to_int());
                let level = level.to_array();
                if filtered {
                    let (x, y) = (linear_in(simd, x, width, wrap_s), linear_in(simd, y, height, wrap_t));
                    let [a, b, c, d] = self.quads(simd, &level, &x, [y.near * stride, y.far * stride]);
                    let words = &self.first;
                    let lower = mix_rgba(words.meaning(simd, a), words.meaning(simd, b), x.weight);
                    let upper = mix_rgba(words.meaning(simd, c), words.meaning(simd, d), x.weight);
                    mix_rgba(lower, upper, y.weight)
                } else {
                    let (x, y) = (nearest_in(x, width, wrap_s), nearest_in(y, height, wrap_t));
                    self.first.meaning(simd, self.words(simd, &level, y * stride + x))
                }
            },
        )
    }

    /// The texels round a place: two of the lower row, two of the upper, which begin at `rows`.
    #[inline(always)]
    fn quads<S: Simd>(&self, simd: S, level: &[i32; LANES], x: &Axis<S>, rows: [I32x8<S>; 2]) -> [U32x8<S>; 4] {
        // But where the image wraps round or ends, the two texels of a row are neighbours in memory.
        if !(x.near + 1).simd_eq(x.far).all_true() {
            let word = lanes::inlined(
                #[inline(always)]
                |at: I32x8<S>| self.words(simd, level, at),
            );
            return [word(rows[0] + x.near), word(rows[0] + x.far), word(rows[1] + x.near), word(rows[1] + x.far)];
        }
        let (lower, upper) = ((rows[0] + x.near).to_array(), (rows[1] + x.near).to_array());
        let mut pairs = [[[0u32; 2]; LANES]; 2];
        for lane in 0..LANES {
            let texels = self.levels[level[lane] as usize % LEVELS];
            for (row, at) in [lower[lane], upper[lane]].into_iter().enumerate() {
                let at = at as u32 as usize;
                if let Some(pair) = texels.get(at..at + 2) {
                    pairs[row][lane] = [pair[0], pair[1]];
                }
            }
        }
        let [lower, upper] = &pairs;
        let ((a, b), (c, d)) = (split(simd, lower), split(simd, upper));
        [a, b, c, d]
    }

    /// One texel a lane; 0 where there is none.
    #[inline(always)]
    fn words<S: Simd>(&self, simd: S, level: &[i32; LANES], at: I32x8<S>) -> U32x8<S> {
        let at = at.to_array();
        let mut words = [0u32; LANES];
        for lane in 0..LANES {
            let texels = self.levels[level[lane] as usize % LEVELS];
            words[lane] = texels.get(at[lane] as u32 as usize).copied().unwrap_or_default();
        }
        U32x8::from_slice(simd, &words)
    }
}

/// The first texels of eight pairs, and the second ones.
#[inline(always)]
fn split<S: Simd>(simd: S, pairs: &[[u32; 2]; LANES]) -> (U32x8<S>, U32x8<S>) {
    let flat: &[u32] = bytemuck::cast_slice(pairs);
    let (low, high) = flat.split_at(LANES);
    U32x8::from_slice(simd, low).deinterleave(U32x8::from_slice(simd, high))
}

/// As [`super::sample`].
#[inline(never)]
pub(super) fn sample<S: Simd>(
    simd: S,
    packed: &Packed<'_>,
    coords: [F32x8<S>; 4],
    lod: F32x8<S>,
    active: u32,
) -> Rgba<S> {
    simd.vectorize(
        #[inline(always)]
        || packed.at(simd, [coords[0] / coords[3], coords[1] / coords[3]], lod, active),
    )
}
