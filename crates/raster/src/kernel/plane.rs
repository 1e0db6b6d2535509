//! Depths of a facet at one sample of many pixels, by the operations of [`Setup::depth`].

use crate::{SUBPIXEL, Setup};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, Simd};

/// A facet's depth plane as rows of eight pixels from one column on see it.
#[derive(Clone, Copy, Debug)]
pub struct RowPlane<S: Simd> {
    /// Depth relative to `z` at eight pixels of row 0, as far as columns change it.
    across: F32x8<S>,
    /// Farthest depth of the facet, in all lanes.
    low: F32x8<S>,
    /// Nearest depth of the facet, in all lanes.
    high: F32x8<S>,
    /// Depth at the plane's origin.
    z: f32,
    /// Change of depth with a pixel to the right.
    dz_dx: f32,
    /// Change of depth with a pixel down.
    dz_dy: f32,
    /// From the plane's origin to the sample of the column's pixel in row 0, in 1/256 pixel.
    first: [i32; 2],
}

impl<S: Simd> RowPlane<S> {
    /// Given where the column's sample in row 0 is, in 1/256 pixel.
    #[inline(always)]
    pub fn new(simd: S, setup: &Setup, first: [i32; 2]) -> Self {
        Self::with_sign(simd, setup, 1.0, first)
    }

    /// Depths times 1 or -1: rounding does not depend on signs.
    #[inline(always)]
    pub(crate) fn with_sign(simd: S, setup: &Setup, sign: f32, first: [i32; 2]) -> Self {
        let lane = F32x8::from_slice(simd, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let first = [first[0] - setup.origin[0], first[1] - setup.origin[1]];
        let (low, high) =
            if sign > 0.0 { (setup.z_min, setup.z_max) } else { (-setup.z_max, -setup.z_min) };
        Self {
            // Whole pixels and 1/256 pixels below 2^15 pixels: the sum is exact.
            across: (lane + first[0] as f32 / SUBPIXEL as f32) * (setup.dz_dx * sign),
            low: F32x8::splat(simd, low),
            high: F32x8::splat(simd, high),
            z: setup.z * sign,
            dz_dx: setup.dz_dx * sign,
            dz_dy: setup.dz_dy * sign,
            first,
        }
    }

    /// At the eight pixels of a row.
    #[inline(always)]
    pub fn row(&self, y: usize) -> F32x8<S> {
        let below = self.first[1] + y as i32 * SUBPIXEL;
        self.within(self.across + (self.z + below as f32 / SUBPIXEL as f32 * self.dz_dy))
    }

    /// At any eight pixels, counted from the column's in row 0.
    #[inline(always)]
    pub(crate) fn at(&self, x: I32x8<S>, y: I32x8<S>) -> F32x8<S> {
        let away = lanes::inlined(
            #[inline(always)]
            |pixel: I32x8<S>, first: i32| -> F32x8<S> {
                let distance: F32x8<S> = ((pixel << SUBPIXEL.trailing_zeros()) + first).to_float();
                distance * (1.0 / SUBPIXEL as f32)
            },
        );
        self.within(
            away(x, self.first[0]) * self.dz_dx + (away(y, self.first[1]) * self.dz_dy + self.z),
        )
    }

    /// The same at these eight pixels alone, whose depths are `z`.
    #[inline(always)]
    #[must_use]
    pub fn pinned(&self, z: F32x8<S>) -> Self {
        Self { low: z, high: z, ..*self }
    }

    #[inline(always)]
    fn within(&self, z: F32x8<S>) -> F32x8<S> {
        lanes::Lanes::min(lanes::Lanes::max(z, self.low), self.high)
    }
}
