//! The common case: two dimensions, 8 bits a component, no border in reach.
//!
//! All lanes are looked up together, each on the level that it needs: a level is only a slice of texels and a size.

use super::fetch::{Words, interior, pairs, singles, split};
use super::halves::{Halves, weight};
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
    /// Of each level, in texels.
    sizes: [[f32; 2]; LEVELS],
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
        if texture.kind != TextureKind::Two
            || levels.len() > LEVELS
            || texture.swizzle.is_some()
            || !stays_inside(&texture.sampler.wrap)
        {
            return None;
        }
        let [width, height, _] = interior(first, 2);
        let mut slices: [&[u32]; LEVELS] = [&[]; LEVELS];
        let mut sizes = [[1.0; 2]; LEVELS];
        for (k, (slice, level)) in slices.iter_mut().zip(levels).enumerate() {
            let size = [(width >> k).max(1), (height >> k).max(1)];
            sizes[k] = size.map(|side| side as f32);
            if level.border != 0 || level.size[..2] != size {
                return None;
            }
            *slice = Words::new(level)?.texels;
        }
        let last = levels.len() - 1;
        Some(Self { levels: slices, last, sizes, first: Words::new(first)?, sampler: &texture.sampler })
    }

    /// Whether the level of detail can matter.
    #[inline(always)]
    pub(crate) fn needs_lod(&self) -> bool {
        self.sampler.min != self.sampler.mag
    }

    /// Width and height of level 0.
    #[inline(always)]
    pub(crate) fn size(&self) -> [f32; 2] {
        self.sizes[0]
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
        let several = bits_of(choice.fraction.simd_gt(splat(simd, 0.0))) != 0;
        let next = min(choice.level + 1.0, splat(simd, self.last as f32));
        if linear && !self.first.is_encoded() {
            let color = self.halves(simd, place, choice.level);
            if !several {
                return color.unpack();
            }
            return color.mix(&self.halves(simd, place, next), weight(simd, choice.fraction)).unpack();
        }
        let color = self.level(simd, place, choice.level, linear);
        if !several {
            return color;
        }
        mix_rgba(color, self.level(simd, place, next, linear), choice.fraction)
    }

    /// Filtered bytes of one level a lane.
    #[inline(always)]
    fn halves<S: Simd>(&self, simd: S, place: [F32x8<S>; 2], level: F32x8<S>) -> Halves<S> {
        let each: I32x8<S> = level.to_int();
        let first = each.to_array()[0];
        if !each.simd_eq(first).all_true() {
            return self.mixed_halves(simd, place, level);
        }
        // Nearly always all lanes need the same level.
        let level = first as usize % LEVELS;
        let size = self.sizes[level];
        let [wrap_s, wrap_t, _] = self.sampler.wrap;
        let (width, height) = (splat(simd, size[0]), splat(simd, size[1]));
        let x = linear_in(simd, position_in(simd, place[0], width, wrap_s), width, wrap_s);
        let y = linear_in(simd, position_in(simd, place[1], height, wrap_t), height, wrap_t);
        let (texels, stride): (_, I32x8<S>) = (self.levels[level], width.to_int());
        let rows = [y.near * stride, y.far * stride];
        let quads = if (x.near + 1).simd_eq(x.far).all_true() {
            let ((a, b), (c, d)) = (pairs(simd, texels, rows[0] + x.near), pairs(simd, texels, rows[1] + x.near));
            [a, b, c, d]
        } else {
            // The image wraps round or ends.
            [
                singles(simd, texels, rows[0] + x.near),
                singles(simd, texels, rows[0] + x.far),
                singles(simd, texels, rows[1] + x.near),
                singles(simd, texels, rows[1] + x.far),
            ]
        };
        Halves::filter(simd, quads, [x.weight, y.weight])
    }

    /// [`Self::halves`] where lanes need different levels.
    #[inline(never)]
    fn mixed_halves<S: Simd>(&self, simd: S, place: [F32x8<S>; 2], level: F32x8<S>) -> Halves<S> {
        simd.vectorize(
            #[inline(always)]
            || {
                let (level, stride, [x, y]) = self.axes(simd, place, level);
                let (x, y) = (self.along(simd, 0, x), self.along(simd, 1, y));
                let quads = self.quads(simd, &level, &x, [y.near * stride, y.far * stride]);
                Halves::filter(simd, quads, [x.weight, y.weight])
            },
        )
    }

    /// Of each lane's level: its number, its width, and along both axes the position and the size.
    #[inline(always)]
    fn axes<S: Simd>(
        &self,
        simd: S,
        place: [F32x8<S>; 2],
        level: F32x8<S>,
    ) -> ([i32; LANES], I32x8<S>, [[F32x8<S>; 2]; 2]) {
        let shrink = lanes::Lanes::exp2_whole(-level);
        let one = splat(simd, 1.0);
        let (width, height) = (max(floor(shrink * self.sizes[0][0]), one), max(floor(shrink * self.sizes[0][1]), one));
        let [wrap_s, wrap_t, _] = self.sampler.wrap;
        let x = position_in(simd, place[0], width, wrap_s);
        let y = position_in(simd, place[1], height, wrap_t);
        let (level, stride): (I32x8<S>, I32x8<S>) = (level.to_int(), width.to_int());
        (level.to_array(), stride, [[x, width], [y, height]])
    }

    /// The texels round positions along an axis, given with sizes.
    #[inline(always)]
    fn along<S: Simd>(&self, simd: S, axis: usize, [position, size]: [F32x8<S>; 2]) -> Axis<S> {
        linear_in(simd, position, size, self.sampler.wrap[axis])
    }

    /// Raw colours of one level a lane.
    #[inline(never)]
    fn level<S: Simd>(&self, simd: S, place: [F32x8<S>; 2], level: F32x8<S>, filtered: bool) -> Rgba<S> {
        simd.vectorize(
            #[inline(always)]
            || {
                let (level, stride, [x, y]) = self.axes(simd, place, level);
                let words = &self.first;
                if filtered {
                    let (x, y) = (self.along(simd, 0, x), self.along(simd, 1, y));
                    let [a, b, c, d] = self.quads(simd, &level, &x, [y.near * stride, y.far * stride]);
                    let lower = mix_rgba(words.meaning(simd, a), words.meaning(simd, b), x.weight);
                    let upper = mix_rgba(words.meaning(simd, c), words.meaning(simd, d), x.weight);
                    mix_rgba(lower, upper, y.weight)
                } else {
                    let [wrap_s, wrap_t, _] = self.sampler.wrap;
                    let (x, y) = (nearest_in(x[0], x[1], wrap_s), nearest_in(y[0], y[1], wrap_t));
                    words.meaning(simd, self.words(simd, &level, y * stride + x))
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
