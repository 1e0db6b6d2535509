//! From a coordinate to texel numbers along one axis.
//!
//! Texel `i` covers `i..i + 1` of the position; the image is `0..size`, without its border. Texels
//! -1 and `size` are the border.

use crate::forward::texture::Wrap;
use crate::forward::wide::{every, floor, max, min, select, splat};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Floats, I32x8, Lanes, Simd};

/// The two texels whose centres surround a position, and how far it is from the first to the
/// second, 0..1.
#[derive(Clone, Copy)]
pub(super) struct Axis<S: Simd, V: Floats<S> = F32x8<S>> {
    pub(super) near: V::Ints,
    pub(super) far: V::Ints,
    pub(super) weight: V,
}

impl<S: Simd> Axis<S> {
    /// The texels round a position, or if not `filtered` the one at it twice.
    #[inline(always)]
    pub(super) fn new(simd: S, position: F32x8<S>, size: u32, wrap: Wrap, filtered: bool) -> Self {
        if filtered {
            return linear(simd, position, size, wrap);
        }
        let near = nearest(simd, position, size, wrap);
        Self { near, far: near, weight: splat(simd, 0.0) }
    }
}

/// The position in texels: wrapped or clamped, always within half a texel of the image.
#[inline(always)]
pub(super) fn position<S: Simd>(simd: S, coordinate: F32x8<S>, size: u32, wrap: Wrap) -> F32x8<S> {
    position_in(simd, coordinate, splat(simd, size as f32), wrap)
}

/// As [`position`] where each lane has an image of its own size.
#[inline(always)]
pub(super) fn position_in<S: Simd, V: Floats<S>>(
    simd: S,
    coordinate: V,
    texels: V,
    wrap: Wrap,
) -> V {
    match wrap {
        Wrap::Repeat => {
            between((coordinate - floor(coordinate)) * texels, every(simd, 0.0), texels)
        }
        Wrap::MirroredRepeat => {
            let there_and_back = coordinate - floor(coordinate * 0.5) * 2.0;
            let mirrored = min(there_and_back, -there_and_back + 2.0);
            between(mirrored * texels, every(simd, 0.5), texels - 0.5)
        }
        _ if wrap.mirrors_once() => {
            // Within half a texel of 0 the two texels are one.
            let mirrored = max(Lanes::abs(coordinate) * texels, every(simd, 0.5));
            limited_in(simd, mirrored, texels, wrap.after_mirror())
        }
        _ => limited_in(simd, coordinate * texels, texels, wrap),
    }
}

/// As [`position`] for a coordinate in texels (rectangles), which can only be clamped.
#[inline(always)]
pub(super) fn limited<S: Simd>(texels: F32x8<S>, size: u32, wrap: Wrap) -> F32x8<S> {
    let simd = texels.token();
    limited_in(simd, texels, splat(simd, size as f32), wrap)
}

#[inline(always)]
fn limited_in<S: Simd, V: Floats<S>>(simd: S, texels: V, size: V, wrap: Wrap) -> V {
    match wrap {
        Wrap::Clamp => between(texels, every(simd, 0.0), size),
        Wrap::ClampToBorder => between(texels, every(simd, -0.5), size + 0.5),
        _ => between(texels, every(simd, 0.5), size - 0.5),
    }
}

/// Brought into `low..=high`; NaN gives `low`.
#[inline(always)]
fn between<V: Lanes>(value: V, low: V, high: V) -> V {
    min(max(value, low), high)
}

/// The texel at a position.
#[inline(always)]
pub(super) fn nearest<S: Simd>(simd: S, position: F32x8<S>, size: u32, wrap: Wrap) -> I32x8<S> {
    nearest_in(position, splat(simd, size as f32), wrap)
}

/// As [`nearest`] where each lane has an image of its own size.
#[inline(always)]
pub(super) fn nearest_in<S: Simd, V: Floats<S>>(position: V, texels: V, wrap: Wrap) -> V::Ints {
    let last = if wrap.after_mirror() == Wrap::ClampToBorder { texels } else { texels - 1.0 };
    min(floor(position), last).to_int()
}

/// The texels round a position.
#[inline(always)]
pub(super) fn linear<S: Simd>(simd: S, position: F32x8<S>, size: u32, wrap: Wrap) -> Axis<S> {
    linear_in(simd, position, splat(simd, size as f32), wrap)
}

/// As [`linear`] where each lane has an image of its own size.
#[inline(always)]
pub(super) fn linear_in<S: Simd, V: Floats<S>>(
    simd: S,
    position: V,
    texels: V,
    wrap: Wrap,
) -> Axis<S, V> {
    let (zero, one): (V, V) = (every(simd, 0.0), every(simd, 1.0));
    let from_centre = position - 0.5;
    let near = floor(from_centre);
    let weight = from_centre - near;
    let far = near + one;
    let (near, far) = match wrap.after_mirror() {
        Wrap::Repeat => {
            (select(near.simd_lt(zero), texels - one, near), select(far.simd_ge(texels), zero, far))
        }
        Wrap::MirroredRepeat | Wrap::ClampToEdge => (near, min(far, max(texels - one, zero))),
        _ => (near, far),
    };
    Axis { near: near.to_int(), far: far.to_int(), weight }
}
