//! The common case: two dimensions, 8 bits a component, no texels of a border of its own. One
//! dimension is a single row, where it is filtered: between two texels the nearest may be another
//! one here.
//!
//! Where a lookup reaches beyond the image into the one colour of its border, the texels at the
//! edge are filtered, and the border's share is mixed in: weights of two axes are products, so that
//! this is what the four texels give.
//!
//! All lanes are looked up together, each on the level that it needs: a level is only a slice of
//! texels and a size.

use super::fetch::{TexelWords, interior, quads};
use super::halves::{Halves, weight};
use super::mip::{Choice, choose, dimensions, mix_rgba};
use super::wrap::{Axis, linear_in, nearest_in, position_in};
use crate::forward::fragment_ops::packed::unpack_bytes;
use crate::forward::texture::{Filter, Level, Sampler, Texture, TextureKind, Wrap};
use crate::forward::wide::{
    Rgba, bits_of, every, every_rgba, floor, max, min, select, select_rgba,
};
use std::sync::Arc;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Floats, MOST_LANES, Simd};

/// A texture's levels, made ready for lookups.
#[derive(Clone, Copy)]
pub(crate) struct Packed<'a> {
    /// From the finest to the coarsest.
    levels: &'a [Arc<Level>],
    /// Level 0, for what bytes mean.
    first: TexelWords<'a>,
    /// Of level 0, in texels; 0 along what the texture does not have.
    size: [f32; 2],
    sampler: &'a Sampler,
    /// How texels of the image itself are found.
    wrap: [Wrap; 2],
    /// Along which axes lookups may reach the border.
    reaches: [bool; 2],
}

impl<'a> Packed<'a> {
    /// `None` for textures of another kind.
    pub(crate) fn new(texture: &'a Texture) -> Option<Self> {
        let [levels] = &texture.faces[..] else { return None };
        let first = levels.first()?;
        // What most textures of other kinds lack.
        let words = TexelWords::new(first)?;

        // Accept flat textures with wrap modes that the packed path knows.
        let sampler = &texture.sampler;
        let flat = match texture.kind {
            TextureKind::One => sampler.mag.is_linear() && sampler.min.is_linear(),
            kind => kind == TextureKind::Two,
        };
        if !flat
            || texture.swizzle.is_some()
            || sampler.wrap[..2].iter().any(|wrap| wrap.mirrors_once())
        {
            return None;
        }

        // Every level must have half the size of the one before, no border and packed texels.
        let [width, height, _] = interior(first, dimensions(texture.kind));
        for (k, level) in levels.iter().enumerate() {
            let size = [(width >> k).max(1), (height >> k).max(1)];
            if level.border != 0 || level.size[..2] != size || TexelWords::new(level).is_none() {
                return None;
            }
        }
        // A row has no height that texels a pixel could be counted along, and no border there.
        let is_row = texture.kind == TextureKind::One;
        let size = [width as f32, if is_row { 0.0 } else { height as f32 }];
        let own = [sampler.wrap[0], if is_row { Wrap::ClampToEdge } else { sampler.wrap[1] }];
        let reaches = own.map(|wrap| matches!(wrap, Wrap::Clamp | Wrap::ClampToBorder));
        let wrap = [0, 1].map(|k: usize| if reaches[k] { Wrap::ClampToEdge } else { own[k] });
        Some(Self { levels, first: words, size, sampler, wrap, reaches })
    }

    /// A level, or the last one.
    #[inline(always)]
    fn get(&self, level: i32) -> &'a Level {
        &self.levels[(level as u32 as usize).min(self.levels.len() - 1)]
    }

    /// The number of the last level.
    #[inline(always)]
    fn last(&self) -> usize {
        self.levels.len() - 1
    }

    /// Whether the level of detail can matter.
    #[inline(always)]
    pub(crate) fn needs_lod(&self) -> bool {
        self.sampler.min != self.sampler.mag
    }

    /// Width and height of level 0; 0 for the height of one dimension.
    #[inline(always)]
    pub(crate) fn size(&self) -> [f32; 2] {
        self.size
    }

    /// The colours at (s, t), as [`super::sample`] tells.
    #[inline(always)]
    pub(crate) fn at<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        place: [V; 2],
        lod: V,
        active: u32,
    ) -> [V; 4] {
        // Choose the levels and the filter.
        let zero = every(simd, 0.0);
        let choice = if self.needs_lod() {
            choose(simd, self.sampler, self.last(), lod)
        } else {
            let linear = if self.sampler.mag == Filter::Linear { u32::MAX } else { 0 };
            Choice { level: zero, fraction: zero, linear }
        };

        // Filter lanes, those with another filter a second time.
        let active = active & ((1 << V::LEN) - 1);
        let linear = choice.linear & active;
        let mut color = self.filtered(simd, place, &choice, linear == active);
        if linear != 0 && linear != active {
            let mask = SimdMask::from_bitmask(simd, u64::from(linear));
            color = select_rgba(mask, self.filtered(simd, place, &choice, true), color);
        }
        self.first.finish(color)
    }

    /// The bytes of what [`Self::at`] gives for groups of places with levels of detail, see
    /// [`Self::meaning`], if all filter linearly and those of a group need the same levels, as
    /// nearly always. Groups go through each step together: texels take long to come, and none
    /// needs wait for another's.
    #[inline(always)]
    pub(crate) fn sample_batch<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        places: &[([V; 2], V); N],
        active: u32,
    ) -> Option<[V::Words; N]> {
        // Choose the levels of each group; give up if lanes differ.
        if self.first.is_encoded() || !self.levels[0].has_columns() {
            return None;
        }
        let (mut levels, mut fractions, mut several) = ([[0; 2]; N], [every(simd, 0.0); N], false);
        for i in 0..N {
            if !self.needs_lod() {
                if self.sampler.mag != Filter::Linear {
                    return None;
                }
                continue;
            }
            let choice = choose(simd, self.sampler, self.last(), places[i].1);
            let level: V::Ints = choice.level.to_int();
            let first = level.as_slice()[0];
            if choice.linear & active != active || !level.simd_eq(first).all_true() {
                return None;
            }
            (levels[i], fractions[i]) = ([first, first + 1], choice.fraction);
            several |= bits_of(choice.fraction.simd_gt(every::<S, V>(simd, 0.0))) != 0;
        }

        // Compute addresses and weights for all groups and levels.
        let count = if several { 2 } else { 1 };
        let (mut at, mut weights) =
            ([[V::Ints::splat(simd, 0); 2]; N], [[[every(simd, 0.0); 2]; 2]; N]);
        let (mut beyond, mut reached) = ([[every(simd, 0.0); 2]; N], false);
        for i in 0..N {
            for k in 0..count {
                let [width, height, _] = self.get(levels[i][k]).size;
                let size = [every(simd, width as f32), every(simd, height as f32)];
                let [x, y] = self.linear(simd, places[i].0, size);
                if let Some(share) = self.beyond(simd, places[i].0, size, true) {
                    (beyond[i][k], reached) = (share, true);
                }
                at[i][k] = y.near * (width as i32 + 1) + x.near;
                weights[i][k] = [x.weight, y.weight];
            }
        }

        // Fetch the texels of all of them.
        let mut texels = [[[V::Words::splat(simd, 0); 4]; 2]; N];
        for i in 0..N {
            for k in 0..count {
                let columns = self.get(levels[i][k]).columns(V::LEN)?;
                texels[i][k] = quads::<S, V>(
                    simd,
                    #[inline(always)]
                    |_| columns,
                    at[i][k],
                );
            }
        }

        // Filter, then mix the levels.
        let mut words = [V::Words::splat(simd, 0); N];
        for i in 0..N {
            let filtered = lanes::inlined(
                #[inline(always)]
                |k: usize| {
                    let color = Halves::filter(simd, texels[i][k], weights[i][k]);
                    if reached { self.bordered(simd, color, beyond[i][k]) } else { color }
                },
            );
            let mut color = filtered(0);
            if several {
                color = color.mix(&filtered(1), weight(simd, fractions[i]));
            }
            words[i] = color.words();
        }
        Some(words)
    }

    /// The colours that [`Self::sample_batch`] gave as bytes.
    #[inline(always)]
    pub(crate) fn meaning<S: Simd, V: Floats<S>>(&self, words: V::Words) -> [V; 4] {
        self.first.finish(unpack_bytes::<S, V>(words))
    }

    /// Raw colours, all lanes with one filter within a level.
    #[inline(always)]
    fn filtered<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        place: [V; 2],
        choice: &Choice<V>,
        linear: bool,
    ) -> [V; 4] {
        let several = bits_of(choice.fraction.simd_gt(every::<S, V>(simd, 0.0))) != 0;
        let next = min(choice.level + 1.0, every(simd, self.last() as f32));
        if linear && !self.first.is_encoded() {
            let color = self.halves(simd, place, choice.level);
            if !several {
                return color.unpack();
            }
            return color
                .mix(&self.halves(simd, place, next), weight(simd, choice.fraction))
                .unpack();
        }
        let color = self.level(simd, place, choice.level, linear);
        if !several {
            return color;
        }
        mix_rgba(color, self.level(simd, place, next, linear), choice.fraction)
    }

    /// Filtered bytes of one level a lane.
    #[inline(always)]
    fn halves<S: Simd, V: Floats<S>>(&self, simd: S, place: [V; 2], level: V) -> Halves<S, V> {
        let each: V::Ints = level.to_int();
        let first = each.as_slice()[0];
        // Nearly always all lanes need the same level.
        let same = each.simd_eq(first).all_true().then(|| self.get(first));
        let Some((columns, [width, height, _])) =
            same.and_then(|level| Some((level.columns(V::LEN)?, level.size)))
        else {
            return self.mixed_halves(simd, place, level);
        };

        // Fetch the four texels round each place and filter.
        let size = [every(simd, width as f32), every(simd, height as f32)];
        let [x, y] = self.linear(simd, place, size);
        let quads = quads::<S, V>(
            simd,
            #[inline(always)]
            |_| columns,
            y.near * (width as i32 + 1) + x.near,
        );
        let color = Halves::filter(simd, quads, [x.weight, y.weight]);

        // Mix the border in where a wrap mode reaches it.
        match self.beyond(simd, place, size, true) {
            Some(share) => self.bordered(simd, color, share),
            None => color,
        }
    }

    /// Colours of texels at the edge, mixed with the border's by its share.
    #[inline(always)]
    fn bordered<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        color: Halves<S, V>,
        share: V,
    ) -> Halves<S, V> {
        let border = self.sampler.border_word();
        color.mix(&Halves::new(V::Words::splat(simd, border)), weight(simd, share))
    }

    /// What share of the colours at places of a level of this size is the border's; `None` for none
    /// at all.
    #[inline(always)]
    fn beyond<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        place: [V; 2],
        size: [V; 2],
        filtered: bool,
    ) -> Option<V> {
        if self.reaches == [false; 2] {
            return None;
        }
        let share = self.beyond_apart(simd, place, size, filtered);
        (bits_of(share.simd_gt(every::<S, V>(simd, 0.0))) != 0).then_some(share)
    }

    #[inline(never)]
    fn beyond_apart<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        place: [V; 2],
        size: [V; 2],
        filtered: bool,
    ) -> V {
        simd.vectorize(
            #[inline(always)]
            || {
                // Multiply the shares that lie inside along both axes.
                let (zero, one) = (every::<S, V>(simd, 0.0), every(simd, 1.0));
                let mut inside = one;
                for k in 0..2 {
                    if !self.reaches[k] {
                        continue;
                    }
                    // With `CLAMP` half of the way to the border's texels is the farthest, and the
                    // nearest texel the image's own.
                    let position = position_in(simd, place[k], size[k], self.sampler.wrap[k]);
                    if filtered {
                        let out = max(max(-position + 0.5, position - size[k] + 0.5), zero);
                        inside *= one - out;
                    } else if self.sampler.wrap[k] == Wrap::ClampToBorder {
                        let out = position.simd_lt(zero) | position.simd_ge(size[k]);
                        inside = select(out, zero, inside);
                    }
                }
                one - inside
            },
        )
    }

    /// [`Self::halves`] where lanes need different levels.
    #[inline(never)]
    fn mixed_halves<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        place: [V; 2],
        level: V,
    ) -> Halves<S, V> {
        simd.vectorize(
            #[inline(always)]
            || {
                let (quads, weights) = self.mixed_quads(simd, place, level);
                let color = Halves::filter(simd, quads, weights);
                match self.beyond(simd, place, self.size_of(simd, level), true) {
                    Some(share) => self.bordered(simd, color, share),
                    None => color,
                }
            },
        )
    }

    /// The texels round places, each on its lane's level, and the weights of those further on along
    /// both axes.
    #[inline(always)]
    fn mixed_quads<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        place: [V; 2],
        level: V,
    ) -> ([V::Words; 4], [V; 2]) {
        // Find the texels and weights along both axes.
        let size = self.size_of(simd, level);
        let [x, y] = self.linear(simd, place, size);
        let (level, stride): (V::Ints, V::Ints) = (level.to_int(), size[0].to_int());
        // Nearly always all lanes need the same level.
        let first = level.as_slice()[0];
        let have_columns = if level.simd_eq(first).all_true() {
            self.get(first).columns(V::LEN).is_some()
        } else {
            self.levels[0].has_columns()
                && level.as_slice().iter().all(|l| self.get(*l).columns(1).is_some())
        };

        // Fetch single texels where a level has no columns.
        if !have_columns {
            let words = lanes::inlined(
                #[inline(always)]
                |x: V::Ints, y: V::Ints| self.words::<S, V>(simd, level, y * stride + x),
            );
            let quads = [
                words(x.near, y.near),
                words(x.far, y.near),
                words(x.near, y.far),
                words(x.far, y.far),
            ];
            return (quads, [x.weight, y.weight]);
        }

        // Fetch pairs of columns, each lane from its level.
        let level = level.as_slice();
        let quads = quads::<S, V>(
            simd,
            #[inline(always)]
            |lane| self.get(level[lane]).columns(0).unwrap_or_default(),
            y.near * (stride + 1) + x.near,
        );
        (quads, [x.weight, y.weight])
    }

    /// The texels round a place along both axes.
    #[inline(always)]
    fn linear<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        place: [V; 2],
        size: [V; 2],
    ) -> [Axis<S, V>; 2] {
        let along = lanes::inlined(
            #[inline(always)]
            |k: usize| {
                let wrap = self.wrap[k];
                linear_in(simd, position_in(simd, place[k], size[k], wrap), size[k], wrap)
            },
        );
        [along(0), along(1)]
    }

    /// The size of each lane's level.
    #[inline(always)]
    fn size_of<S: Simd, V: Floats<S>>(&self, simd: S, level: V) -> [V; 2] {
        let (shrink, one) = (lanes::Lanes::exp2_whole(-level), every(simd, 1.0));
        let [width, height] = self.size();
        [max(floor(shrink * width), one), max(floor(shrink * height), one)]
    }

    /// Raw colours of one level a lane.
    #[inline(never)]
    fn level<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        place: [V; 2],
        level: V,
        filtered: bool,
    ) -> [V; 4] {
        simd.vectorize(
            #[inline(always)]
            || {
                // Filter four texels, or take the nearest one.
                let words = &self.first;
                let [width, height] = self.size_of(simd, level);
                let color = if filtered {
                    let ([a, b, c, d], [x, y]) = self.mixed_quads(simd, place, level);
                    let lower = mix_rgba(words.meaning(simd, a), words.meaning(simd, b), x);
                    let upper = mix_rgba(words.meaning(simd, c), words.meaning(simd, d), x);
                    mix_rgba(lower, upper, y)
                } else {
                    let [wrap_s, wrap_t] = self.wrap;
                    let x = nearest_in(position_in(simd, place[0], width, wrap_s), width, wrap_s);
                    let y = nearest_in(position_in(simd, place[1], height, wrap_t), height, wrap_t);
                    let stride: V::Ints = width.to_int();
                    words.meaning(simd, self.words::<S, V>(simd, level.to_int(), y * stride + x))
                };

                // Mix the border in where a wrap mode reaches it.
                match self.beyond(simd, place, [width, height], filtered) {
                    Some(share) => {
                        mix_rgba(color, every_rgba(simd, words.raw(self.sampler.border)), share)
                    }
                    None => color,
                }
            },
        )
    }

    /// One texel a lane; 0 where there is none.
    #[inline(always)]
    fn words<S: Simd, V: Floats<S>>(&self, simd: S, level: V::Ints, at: V::Ints) -> V::Words {
        let mut words = [0u32; MOST_LANES];
        self.add_words(level.as_slice(), at.as_slice(), &mut words);
        V::Words::from_slice(simd, &words[..V::LEN])
    }

    #[inline(never)]
    fn add_words(&self, level: &[i32], at: &[i32], words: &mut [u32; MOST_LANES]) {
        let texels =
            |level: i32| TexelWords::new(self.get(level)).map_or(&[][..], |words| words.texels);
        let [first, ..] = level else { return };
        // Nearly always all lanes need the same level.
        let (same, shared) = (level.iter().all(|other| other == first), texels(*first));
        for (word, (level, at)) in words.iter_mut().zip(level.iter().zip(at)) {
            let texels = if same { shared } else { texels(*level) };
            *word = texels.get(*at as u32 as usize).copied().unwrap_or_default();
        }
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
