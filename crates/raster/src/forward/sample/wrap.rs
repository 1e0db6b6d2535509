//! From a coordinate to texel numbers along one axis.
//!
//! Texel `i` covers `i..i + 1` of the position; the image is `0..size`, without its border. Texels -1 and `size` are
//! the border.

use crate::forward::texture::Wrap;
use crate::forward::wide::{floor, max, min, select, splat};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, I32x8, Simd};

/// The two texels whose centres surround a position, and how far it is from the first to the second, 0..1.
#[derive(Clone, Copy)]
pub(super) struct Axis<S: Simd> {
    pub(super) near: I32x8<S>,
    pub(super) far: I32x8<S>,
    pub(super) weight: F32x8<S>,
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
pub(super) fn position_in<S: Simd>(simd: S, coordinate: F32x8<S>, texels: F32x8<S>, wrap: Wrap) -> F32x8<S> {
    match wrap {
        Wrap::Repeat => between((coordinate - floor(coordinate)) * texels, splat(simd, 0.0), texels),
        Wrap::MirroredRepeat => {
            let there_and_back = coordinate - floor(coordinate * 0.5) * 2.0;
            let mirrored = min(there_and_back, splat(simd, 2.0) - there_and_back);
            between(mirrored * texels, splat(simd, 0.5), texels - 0.5)
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
fn limited_in<S: Simd>(simd: S, texels: F32x8<S>, size: F32x8<S>, wrap: Wrap) -> F32x8<S> {
    match wrap {
        Wrap::Clamp => between(texels, splat(simd, 0.0), size),
        Wrap::ClampToBorder => between(texels, splat(simd, -0.5), size + 0.5),
        _ => between(texels, splat(simd, 0.5), size - 0.5),
    }
}

/// Brought into `low..=high`; NaN gives `low`.
#[inline(always)]
fn between<S: Simd>(value: F32x8<S>, low: F32x8<S>, high: F32x8<S>) -> F32x8<S> {
    min(max(value, low), high)
}

/// The texel at a position.
#[inline(always)]
pub(super) fn nearest<S: Simd>(simd: S, position: F32x8<S>, size: u32, wrap: Wrap) -> I32x8<S> {
    nearest_in(position, splat(simd, size as f32), wrap)
}

/// As [`nearest`] where each lane has an image of its own size.
#[inline(always)]
pub(super) fn nearest_in<S: Simd>(position: F32x8<S>, texels: F32x8<S>, wrap: Wrap) -> I32x8<S> {
    let last = if wrap == Wrap::ClampToBorder { texels } else { texels - 1.0 };
    min(floor(position), last).to_int()
}

/// The texels round a position.
#[inline(always)]
pub(super) fn linear<S: Simd>(simd: S, position: F32x8<S>, size: u32, wrap: Wrap) -> Axis<S> {
    linear_in(simd, position, splat(simd, size as f32), wrap)
}

/// As [`linear`] where each lane has an image of its own size.
#[inline(always)]
pub(super) fn linear_in<S: Simd>(simd: S, position: F32x8<S>, texels: F32x8<S>, wrap: Wrap) -> Axis<S> {
    let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
    let from_centre = position - 0.5;
    let near = floor(from_centre);
    let weight = from_centre - near;
    let far = near + one;
    let (near, far) = match wrap {
        Wrap::Repeat => (select(near.simd_lt(zero), texels - one, near), select(far.simd_ge(texels), zero, far)),
        Wrap::MirroredRepeat | Wrap::ClampToEdge => (near, min(far, max(texels - one, zero))),
        Wrap::Clamp | Wrap::ClampToBorder => (near, far),
    };
    Axis { near: near.to_int(), far: far.to_int(), weight }
}
