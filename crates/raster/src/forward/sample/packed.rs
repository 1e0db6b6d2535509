//! The common case: two dimensions, 8 bits a component, no border in reach.

use super::fetch::{Images, decode, gather, interior, level_of};
use super::mip::{mipped, mix_rgba};
use super::wrap::{Axis, linear, nearest, position};
use crate::forward::fragment_ops::packed::unpack_bytes;
use crate::forward::texture::Texture;
use crate::forward::wide::{Rgba, splat_rgba};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, I32x8, LANES, Simd, U32x8};

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
    let Some(shape) = level_of(texture, level) else { return splat_rgba(simd, [0.0, 0.0, 0.0, 1.0]) };
    let images = Images::new(texture, level);
    let [width, height, _] = interior(shape, 2);
    let [wrap_s, wrap_t, _] = texture.sampler.wrap;
    let (x, y) = (position(simd, s, width, wrap_s), position(simd, t, height, wrap_t));
    let row = width as i32;
    let color = if filtered {
        let (x, y) = (linear(simd, x, width, wrap_s), linear(simd, y, height, wrap_t));
        bilinear(simd, &images, &x, &y, row)
    } else {
        let (x, y) = (nearest(simd, x, width, wrap_s), nearest(simd, y, height, wrap_t));
        texels(simd, &images, y * row + x)
    };
    // Components of 0..=255 until here: division once instead of for each texel.
    let [r, g, b, a] = color;
    match images {
        Images::Srgb8(..) => [r, g, b, a / 255.0],
        _ => [r / 255.0, g / 255.0, b / 255.0, a / 255.0],
    }
}

/// Mixes along the two rows, then between them.
#[inline(always)]
fn bilinear<S: Simd>(simd: S, images: &Images<'_>, x: &Axis<S>, y: &Axis<S>, row: i32) -> Rgba<S> {
    let (lower, upper) = (y.near * row, y.far * row);
    let a = mix_rgba(texels(simd, images, lower + x.near), texels(simd, images, lower + x.far), x.weight);
    let b = mix_rgba(texels(simd, images, upper + x.near), texels(simd, images, upper + x.far), x.weight);
    mix_rgba(a, b, y.weight)
}

/// Texels, alpha and colours without decoding as 0..=255.
#[inline(always)]
fn texels<S: Simd>(simd: S, images: &Images<'_>, index: I32x8<S>) -> Rgba<S> {
    match images {
        Images::Rgba8(faces) => unpack_bytes(U32x8::from_slice(simd, &gather(faces, &[0; LANES], index))),
        Images::Srgb8(faces, table) => decode(simd, &gather(faces, &[0; LANES], index), table),
        _ => splat_rgba(simd, [0.0, 0.0, 0.0, 255.0]),
    }
}
