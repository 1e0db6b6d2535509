//! Depth cueing of shaded points, eight at a time: see [`Fade`].
//!
//! In:   colours and depths of up to eight points. Out: the faded colours; those that rays see
//!       after a turn stay.
//! Cost: a multiplication and a few additions a point.

use super::geometry::{F, Surface, constant};
use super::hits::Along;
use super::slots::Slots;
use crate::display::{BackgroundRows, Fade};
use vitral_math::lanes::prelude::SimdBase;
use vitral_math::lanes::{F32x8, LANES, Lanes, Simd, V3};

/// Premultiplied colours of up to eight points. One instruction-set function: kept out of line, so
/// that each level compiles it once.
#[inline(never)]
pub(super) fn faded_eight<S: Simd>(
    simd: S,
    fade: &Fade,
    (color, alpha): (V3<F<S>>, F<S>),
    surface: &Surface<F<S>>,
    (slots, along): (&Slots, Option<&Along>),
    background: &BackgroundRows,
) -> V3<F<S>> {
    simd.vectorize(
        #[inline(always)]
        || {
            let rows = along.map_or(slots.y.map(|y| Some(y as u32)), |along| along.rows);
            let mut into = [[0.0; LANES]; 3];
            let mut straight = [0.0; LANES];
            for lane in 0..LANES {
                let Some(row) = rows[lane] else { continue };
                let color = fade.into(background.color(row));
                (0..3).for_each(|k| into[k][lane] = color[k]);
                straight[lane] = 1.0;
            }
            let [r, g, b] = &into;
            let into = V3::new(
                F32x8::from_slice(simd, r),
                F32x8::from_slice(simd, g),
                F32x8::from_slice(simd, b),
            );
            let kept = fade.kept(-surface.position().z);
            let faded = color.scale(kept) + into.scale(alpha * (-kept + 1.0));
            let is_straight = Lanes::lt(constant(simd, 0.0), F32x8::from_slice(simd, &straight));
            V3::select(is_straight, faded, color)
        },
    )
}
