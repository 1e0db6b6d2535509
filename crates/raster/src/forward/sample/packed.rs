//! The common case: two dimensions, 8 bits a component, no border in reach.

use super::fetch::{Words, interior, level_of};
use super::mip::{mipped, mix_rgba};
use super::wrap::{Axis, linear, nearest, position};
use crate::forward::texture::Texture;
use crate::forward::wide::{Rgba, splat_rgba};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Simd};

/// As [`super::sample`].
#[inline(never)]
pub(super) fn sample<S: Simd>(
    simd: S,
    texture: &Texture,
    coords: [F32x8<S>; 4],
    lod: F32x8<S>,
    active: u32,
) -> Rgba<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            let (s, t) = (coords[0] / coords[3], coords[1] / coords[3]);
            mipped(
                simd,
                texture,
                lod,
                active,
                #[inline(always)]
                |level, linear, _| lookup(simd, texture, level, linear, s, t),
            )
        },
    )
}

/// One level, filtered.
#[inline(always)]
fn lookup<S: Simd>(simd: S, texture: &Texture, level: usize, filtered: bool, s: F32x8<S>, t: F32x8<S>) -> Rgba<S> {
    let Some((shape, words)) = level_of(texture, level).and_then(|shape| Some((shape, Words::new(shape)?))) else {
        return splat_rgba(simd, [0.0, 0.0, 0.0, 1.0]);
    };
    let [width, height, _] = interior(shape, 2);
    let [wrap_s, wrap_t, _] = texture.sampler.wrap;
    let (x, y) = (position(simd, s, width, wrap_s), position(simd, t, height, wrap_t));
    let color = if filtered {
        bilinear(simd, words, &linear(simd, x, width, wrap_s), &linear(simd, y, height, wrap_t), width)
    } else {
        let (x, y) = (nearest(simd, x, width, wrap_s), nearest(simd, y, height, wrap_t));
        words.colors(simd, y * width as i32 + x)
    };
    words.finish(color)
}

/// Raw colours of an image `width` wide, mixed along the two rows, then between them.
#[inline(always)]
pub(super) fn bilinear<S: Simd>(simd: S, words: Words<'_>, x: &Axis<S>, y: &Axis<S>, width: u32) -> Rgba<S> {
    let (lower, upper) = (y.near * width as i32, y.far * width as i32);
    // But where the image wraps round or ends, the two texels of a row are neighbours in memory.
    let adjacent = (x.near + 1).simd_eq(x.far).all_true();
    let (a, b, c, d) = if adjacent {
        let (a, b) = words.pairs(simd, lower + x.near);
        let (c, d) = words.pairs(simd, upper + x.near);
        (a, b, c, d)
    } else {
        (
            words.words(simd, lower + x.near),
            words.words(simd, lower + x.far),
            words.words(simd, upper + x.near),
            words.words(simd, upper + x.far),
        )
    };
    let lower = mix_rgba(words.meaning(simd, a), words.meaning(simd, b), x.weight);
    let upper = mix_rgba(words.meaning(simd, c), words.meaning(simd, d), x.weight);
    mix_rgba(lower, upper, y.weight)
}
