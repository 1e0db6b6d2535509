//! Any texture but cube maps and depth: one to three dimensions, borders, every wrap mode.

use super::fetch::{Image, interior, level_of};
use super::mip::{dimensions, mipped, mix_rgba};
use super::wrap::{Axis, limited, position};
use crate::forward::texture::{Level, Texture, TextureKind};
use crate::forward::wide::{Rgba, select_rgba, splat, splat_rgba};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, I32x8, Mask8, Simd};

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
            let [s, t, r, q] = coords;
            let point = [s / q, t / q, r / q];
            mipped(
                simd,
                texture,
                lod,
                active,
                #[inline(always)]
                |level, linear, _| lookup(simd, texture, level, linear, point),
            )
        },
    )
}

/// One level, filtered.
#[inline(always)]
fn lookup<S: Simd>(
    simd: S,
    texture: &Texture,
    level: usize,
    linear: bool,
    point: [F32x8<S>; 3],
) -> Rgba<S> {
    // Find the texels and weights along the axes.
    let Some(shape) = level_of(texture, level) else {
        return splat_rgba(simd, [0.0, 0.0, 0.0, 1.0]);
    };
    let image = Image::new(shape);
    let dimensions = dimensions(texture.kind);
    let axes = axes(simd, texture, shape, dimensions, linear, point);

    // Fetch the corners of the cell round the point. Bit k of a corner's number chooses the far
    // texel of axis k.
    let border = splat_rgba(simd, image.raw(texture.sampler.border));
    let corners = if linear { 1 << dimensions } else { 1 };
    let mut colors = [border; 8];
    for corner in 0..corners {
        let (index, outside) = address(simd, shape, dimensions, &axes, corner);
        let texel = image.colors(simd, index);
        colors[corner] = select_rgba(outside, border, texel);
    }

    // Mix along one axis after the other: each halves the corners.
    let mut count = corners;
    for k in 0..dimensions {
        count /= 2;
        for i in 0..count {
            colors[i] = mix_rgba(colors[2 * i], colors[2 * i + 1], axes[k].weight);
        }
    }
    image.finish(colors[0])
}

/// Texel numbers along the axes in use; a nearest lookup has near texels only.
#[inline(always)]
pub(super) fn axes<S: Simd>(
    simd: S,
    texture: &Texture,
    shape: &Level,
    dimensions: usize,
    filtered: bool,
    point: [F32x8<S>; 3],
) -> [Axis<S>; 3] {
    let size = interior(shape, dimensions);
    let zero = I32x8::splat(simd, 0);
    let mut axes = [Axis { near: zero, far: zero, weight: splat(simd, 0.0) }; 3];
    for k in 0..dimensions {
        let wrap = texture.sampler.wrap[k];
        let at = if texture.kind == TextureKind::Rectangle {
            limited(point[k], size[k], wrap)
        } else {
            position(simd, point[k], size[k], wrap)
        };
        axes[k] = Axis::new(simd, at, size[k], wrap, filtered);
    }
    axes
}

/// Coordinates of a corner's texels within the stored image, border included; and where there is no
/// such texel.
#[inline(always)]
pub(super) fn corner_texels<S: Simd>(
    simd: S,
    shape: &Level,
    dimensions: usize,
    axes: &[Axis<S>; 3],
    corner: usize,
) -> ([I32x8<S>; 3], Mask8<S>) {
    let zero = I32x8::splat(simd, 0);
    let mut at = [zero; 3];
    let mut outside = Mask8::splat(simd, false);
    for k in 0..dimensions {
        let texel = if corner >> k & 1 == 0 { axes[k].near } else { axes[k].far };
        let stored = texel + shape.border as i32;
        let last = I32x8::splat(simd, shape.size[k] as i32 - 1);
        outside |= stored.simd_lt(zero) | stored.simd_gt(last);
        at[k] = stored.min(last).max(zero);
    }
    (at, outside)
}

/// The number of a corner's texels.
#[inline(always)]
fn address<S: Simd>(
    simd: S,
    shape: &Level,
    dimensions: usize,
    axes: &[Axis<S>; 3],
    corner: usize,
) -> (I32x8<S>, Mask8<S>) {
    let ([x, y, z], outside) = corner_texels(simd, shape, dimensions, axes, corner);
    let (row, layer) = (shape.size[0] as i32, shape.size[0].wrapping_mul(shape.size[1]) as i32);
    (z * layer + y * row + x, outside)
}
