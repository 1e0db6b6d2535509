//! Small formulas on eight pixels that all fragment stages share.

use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Lanes as _, Mask8, Simd};

/// Red, green, blue, alpha of eight pixels.
pub(crate) type Rgba<S> = [F32x8<S>; 4];

/// `value` in every lane.
#[inline(always)]
pub(crate) fn splat<S: Simd>(simd: S, value: f32) -> F32x8<S> {
    <F32x8<S> as SimdBase<S>>::splat(simd, value)
}

/// The same colour in every lane.
#[inline(always)]
pub(crate) fn splat_rgba<S: Simd>(simd: S, color: [f32; 4]) -> Rgba<S> {
    [splat(simd, color[0]), splat(simd, color[1]), splat(simd, color[2]), splat(simd, color[3])]
}

/// The larger; `b` if either is NaN.
#[inline(always)]
pub(crate) fn max<S: Simd>(a: F32x8<S>, b: F32x8<S>) -> F32x8<S> {
    lanes::Lanes::max(a, b)
}

/// The smaller; `b` if either is NaN.
#[inline(always)]
pub(crate) fn min<S: Simd>(a: F32x8<S>, b: F32x8<S>) -> F32x8<S> {
    lanes::Lanes::min(a, b)
}

/// Brought into `low..=high`; NaN gives `low`.
#[inline(always)]
pub(crate) fn clamp<S: Simd>(value: F32x8<S>, low: f32, high: f32) -> F32x8<S> {
    let simd = value.token();
    min(max(value, splat(simd, low)), splat(simd, high))
}

/// Brought into `0..=1`; NaN gives 0.
#[inline(always)]
pub(crate) fn saturate<S: Simd>(value: F32x8<S>) -> F32x8<S> {
    value.saturate()
}

/// Each component brought into `0..=1`.
#[inline(always)]
pub(crate) fn saturate_rgba<S: Simd>(c: Rgba<S>) -> Rgba<S> {
    [saturate(c[0]), saturate(c[1]), saturate(c[2]), saturate(c[3])]
}

/// Largest whole number not above.
#[inline(always)]
pub(crate) fn floor<S: Simd>(value: F32x8<S>) -> F32x8<S> {
    lanes::Lanes::floor(value)
}

/// Magnitude.
#[inline(always)]
pub(crate) fn abs<S: Simd>(value: F32x8<S>) -> F32x8<S> {
    lanes::Lanes::abs(value)
}

/// `a` at `t = 0`, `b` at `t = 1`; exactly `a` where they are equal.
#[inline(always)]
pub(crate) fn mix<S: Simd>(a: F32x8<S>, b: F32x8<S>, t: F32x8<S>) -> F32x8<S> {
    a + (b - a) * t
}

/// `if_true` where the mask is true.
#[inline(always)]
pub(crate) fn select<S: Simd>(mask: Mask8<S>, if_true: F32x8<S>, if_false: F32x8<S>) -> F32x8<S> {
    lanes::Lanes::select(mask, if_true, if_false)
}

/// `if_true` where the mask is true, all components.
#[inline(always)]
pub(crate) fn select_rgba<S: Simd>(mask: Mask8<S>, if_true: Rgba<S>, if_false: Rgba<S>) -> Rgba<S> {
    [
        select(mask, if_true[0], if_false[0]),
        select(mask, if_true[1], if_false[1]),
        select(mask, if_true[2], if_false[2]),
        select(mask, if_true[3], if_false[3]),
    ]
}

/// The mask whose lane `i` is bit `i`.
#[inline(always)]
pub(crate) fn mask_of<S: Simd>(simd: S, bits: u32) -> Mask8<S> {
    Mask8::from_bitmask(simd, u64::from(bits))
}

/// Bit `i` is lane `i`.
#[inline(always)]
pub(crate) fn bits_of<S: Simd>(mask: Mask8<S>) -> u32 {
    mask.to_bitmask() as u32
}
