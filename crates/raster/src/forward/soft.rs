//! How much of a pixel lies in a line, a disc, a polygon: the soft borders of smooth primitives.

use super::wide::{clamp, max, min, splat};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Simd};

/// How much of the pixel's width round `at` lies between `low` and `high`.
#[inline(always)]
pub(super) fn overlap<S: Simd>(at: F32x8<S>, low: f32, high: f32) -> F32x8<S> {
    let simd = at.token();
    clamp(min(at + 0.5, splat(simd, high)) - max(at - 0.5, splat(simd, low)), 0.0, 1.0)
}

/// The part of the pixel round `(x, y)` that a disc round the origin covers: the mean of its
/// chords' overlaps.
#[inline(always)]
pub(super) fn disc_coverage<S: Simd>(simd: S, x: F32x8<S>, y: F32x8<S>, radius: f32) -> F32x8<S> {
    const CHORDS: u32 = 16;
    let mut sum = splat(simd, 0.0);
    for i in 0..CHORDS {
        let at = x + ((i as f32 + 0.5) / CHORDS as f32 - 0.5);
        let half = max(-(at * at) + radius * radius, splat(simd, 0.0)).sqrt();
        sum += clamp(min(y + 0.5, half) - max(y - 0.5, -half), 0.0, 1.0);
    }
    sum * (1.0 / CHORDS as f32)
}

/// The part of the pixel round `(x, y)` inside those of the edges that are the polygon's: the mean
/// of its chords' parts.
#[inline(always)]
pub(super) fn polygon_coverage<S: Simd>(
    simd: S,
    x: F32x8<S>,
    y: F32x8<S>,
    edges: &[[f32; 3]; 3],
    boundary: [bool; 3],
) -> F32x8<S> {
    const CHORDS: u32 = 16;
    let mut sum = splat(simd, 0.0);
    for i in 0..CHORDS {
        let at = x + ((i as f32 + 0.5) / CHORDS as f32 - 0.5);
        let (mut low, mut high) = (y - 0.5, y + 0.5);
        for ([a, b, c], _) in edges.iter().zip(boundary).filter(|(_, boundary)| *boundary) {
            // Inside is b y >= -(a x + c). Nearly upright edges cut the chord far away, or all of
            // it.
            let steep = if b.abs() < 1e-6 { 1e-6f32.copysign(*b) } else { *b };
            let cut = (at * *a + *c) * (-1.0 / steep);
            if steep > 0.0 {
                low = max(low, cut);
            } else {
                high = min(high, cut);
            }
        }
        sum += clamp(high - low, 0.0, 1.0);
    }
    sum * (1.0 / CHORDS as f32)
}

/// Whether a line's stipple, a factor and a pattern, lets the fragment with this number pass.
pub(super) fn stipples((factor, pattern): (i32, u16), count: u32) -> bool {
    pattern >> (count / factor.max(1) as u32 % 16) & 1 == 1
}

/// How much of a pixel, `at` its centre along a smooth line, lies in those pieces of the line that
/// its stipple lets pass.
pub(super) fn pieces(at: f32, length: f32, count: u32, stippling: (i32, u16)) -> f32 {
    let (low, high) = ((at - 0.5).max(0.0), (at + 0.5).min(length));
    let mut sum = 0.0;
    let mut start = low;
    while start < high {
        let end = (start.floor() + 1.0).min(high);
        if stipples(stippling, count.wrapping_add(start as u32)) {
            sum += end - start;
        }
        start = end;
    }
    sum
}
