//! Depth textures of one and two dimensions: shadow maps.
//!
//! With a comparison each texel becomes 0 or 1 before filtering, so that a linear filter gives the share of the four
//! texels that pass, by their weights.

use super::fetch::{Depths, level_of};
use super::flat::{axes, corner_texels};
use super::mip::mipped;
use crate::forward::fragment_ops::compare::compare;
use crate::forward::plane::DepthPlane;
use crate::forward::state::Compare;
use crate::forward::texture::{BaseFormat, Texture, TextureKind};
use crate::forward::wide::{Rgba, mix, saturate, select, splat, splat_rgba};
use vitral_math::lanes::{F32x8, Simd};

/// As [`super::sample`].
#[inline(never)]
pub(super) fn sample<S: Simd>(
    simd: S,
    texture: &Texture,
    plane: Option<&DepthPlane>,
    coords: [F32x8<S>; 4],
    lod: F32x8<S>,
    active: u32,
) -> Rgba<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            let [s, t, r, q] = coords;
            let point = [s / q, t / q, r / q];
            let [value] = mipped(
                simd,
                texture,
                lod,
                active,
                #[inline(always)]
                |level, linear, lanes| {
                    // A constant number of dimensions unrolls the loops.
                    [match texture.kind {
                        TextureKind::One => lookup::<S, 1>(simd, texture, plane, level, linear, point, lanes),
                        _ => lookup::<S, 2>(simd, texture, plane, level, linear, point, lanes),
                    }]
                },
            );
            by_mode(simd, texture.depth_mode, value)
        },
    )
}

/// What `DEPTH_TEXTURE_MODE` makes of a value.
#[inline(always)]
pub(super) fn by_mode<S: Simd>(simd: S, mode: BaseFormat, value: F32x8<S>) -> Rgba<S> {
    let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
    match mode {
        BaseFormat::Alpha => [zero, zero, zero, value],
        BaseFormat::Intensity => [value; 4],
        BaseFormat::Rgb => [value, zero, zero, one],
        _ => [value, value, value, one],
    }
}

/// A texel as it is filtered: its depth, or 1 where the comparison of the reference with it holds.
#[inline(always)]
pub(super) fn compared<S: Simd>(simd: S, texture: &Texture, reference: F32x8<S>, depth: F32x8<S>) -> F32x8<S> {
    match texture.sampler.compare {
        None => depth,
        Some(func) => {
            let passes = compare(simd, func, saturate(reference), depth);
            select(passes, splat(simd, 1.0), splat(simd, 0.0))
        }
    }
}

/// The stored depth that decides a comparison, for each lane: triangles that are no nearer need not be looked at.
#[inline(always)]
fn known<S: Simd>(texture: &Texture, depths: &Depths<'_>, reference: F32x8<S>) -> Option<F32x8<S>> {
    let sign = depths.pending()?;
    // With a larger depth in the plane the comparison only fails more, so what is not above the reference is settled.
    let settles = match texture.sampler.compare {
        Some(Compare::GreaterOrEqual) => sign > 0.0,
        Some(Compare::LessOrEqual) => sign < 0.0,
        _ => false,
    };
    settles.then(
        #[inline(always)]
        || saturate(reference),
    )
}

/// One level, filtered.
#[inline(always)]
fn lookup<S: Simd, const DIMENSIONS: usize>(
    simd: S,
    texture: &Texture,
    plane: Option<&DepthPlane>,
    level: usize,
    linear: bool,
    point: [F32x8<S>; 3],
    lanes: u32,
) -> F32x8<S> {
    let Some(shape) = level_of(texture, level) else { return splat(simd, 0.0) };
    let depths = Depths::new(shape, plane);
    let known = known(texture, &depths, point[2]);
    let axes = axes(simd, texture, shape, DIMENSIONS, linear, point);
    let border = splat_rgba(simd, texture.sampler.border)[0];
    let corners = if linear { 1 << DIMENSIONS } else { 1 };
    let mut values = [border; 4];
    for corner in 0..corners {
        let ([x, y, _], outside) = corner_texels(simd, shape, DIMENSIONS, &axes, corner);
        let depth = select(outside, border, depths.at(simd, x, y, shape.size[0], lanes, known));
        values[corner] = compared(simd, texture, point[2], depth);
    }
    let mut count = corners;
    for k in 0..DIMENSIONS {
        count /= 2;
        for i in 0..count {
            values[i] = mix(values[2 * i], values[2 * i + 1], axes[k].weight);
        }
    }
    values[0]
}
