//! Small formulas that all fragment stages share, on eight pixels or sixteen.

use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Floats, Lanes, Mask8, Simd};

/// Red, green, blue, alpha of eight pixels.
pub(crate) type Rgba<S> = [F32x8<S>; 4];

/// `value` in each of eight lanes.
#[inline(always)]
pub(crate) fn splat<S: Simd>(simd: S, value: f32) -> F32x8<S> {
    every(simd, value)
}

/// `value` in every lane, however many there are.
#[inline(always)]
pub(crate) fn every<S: Simd, V: Floats<S>>(simd: S, value: f32) -> V {
    <V as SimdBase<S>>::splat(simd, value)
}

/// The same colour in each of eight lanes.
#[inline(always)]
pub(crate) fn splat_rgba<S: Simd>(simd: S, color: [f32; 4]) -> Rgba<S> {
    every_rgba(simd, color)
}

/// The same colour in every lane, however many there are.
#[inline(always)]
pub(crate) fn every_rgba<S: Simd, V: Floats<S>>(simd: S, color: [f32; 4]) -> [V; 4] {
    [every(simd, color[0]), every(simd, color[1]), every(simd, color[2]), every(simd, color[3])]
}

/// The larger; `b` if either is NaN.
#[inline(always)]
pub(crate) fn max<V: Lanes>(a: V, b: V) -> V {
    Lanes::max(a, b)
}

/// The smaller; `b` if either is NaN.
#[inline(always)]
pub(crate) fn min<V: Lanes>(a: V, b: V) -> V {
    Lanes::min(a, b)
}

/// Brought into `low..=high`; NaN gives `low`.
#[inline(always)]
pub(crate) fn clamp<V: Lanes>(value: V, low: f32, high: f32) -> V {
    min(max(value, value.splat(low)), value.splat(high))
}

/// Brought into `0..=1`; NaN gives 0.
#[inline(always)]
pub(crate) fn saturate<V: Lanes>(value: V) -> V {
    value.saturate()
}

/// Each component brought into `0..=1`.
#[inline(always)]
pub(crate) fn saturate_rgba<V: Lanes>(c: [V; 4]) -> [V; 4] {
    [saturate(c[0]), saturate(c[1]), saturate(c[2]), saturate(c[3])]
}

/// Largest whole number not above.
#[inline(always)]
pub(crate) fn floor<V: Lanes>(value: V) -> V {
    Lanes::floor(value)
}

/// Magnitude.
#[inline(always)]
pub(crate) fn abs<V: Lanes>(value: V) -> V {
    Lanes::abs(value)
}

/// `a` at `t = 0`, `b` at `t = 1`; exactly `a` where they are equal.
#[inline(always)]
pub(crate) fn mix<V: Lanes>(a: V, b: V, t: V) -> V {
    a + (b - a) * t
}

/// `if_true` where the mask is true.
#[inline(always)]
pub(crate) fn select<V: Lanes>(mask: V::Mask, if_true: V, if_false: V) -> V {
    Lanes::select(mask, if_true, if_false)
}

/// `if_true` where the mask is true, all components.
#[inline(always)]
pub(crate) fn select_rgba<V: Lanes>(mask: V::Mask, if_true: [V; 4], if_false: [V; 4]) -> [V; 4] {
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
pub(crate) fn bits_of<S: Simd, M: SimdMask<S>>(mask: M) -> u32 {
    mask.to_bitmask() as u32
}
