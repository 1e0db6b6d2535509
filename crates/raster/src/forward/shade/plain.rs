//! Colours of tiny facets eight at a time, where they are those of corners and nothing else.
//!
//! Each facet has a lane. The colours are those of [`Shader::plain_row`].

use super::{MOST_W, Shader};
use crate::SUBPIXEL;
use crate::forward::assemble::{Facet, Primitives};
use crate::forward::fragment_ops::packed::pack;
use crate::forward::pass::DrawContext;
use crate::forward::wide::{Rgba, splat};
use crate::kernel::tiny::TinyEight;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, F64x8, I32x8, LANES, Simd, U32x8};

/// Up to eight facets ready to be interpolated: see `Interpolation` and `Differences`.
pub(crate) struct PlainEight<S: Simd> {
    origin: [F32x8<S>; 2],
    first: [F32x8<S>; 2],
    second: [F32x8<S>; 2],
    sum: [F32x8<S>; 3],
    base: Rgba<S>,
    d1: Rgba<S>,
    d2: Rgba<S>,
}

impl<S: Simd> PlainEight<S> {
    /// Makes the facets of `eight` ready, in a tile whose first pixel is `tile`. `None` if `1 / w` differs much at the corners
    /// of one, which needs more care.
    #[inline(always)]
    pub(crate) fn new(
        simd: S,
        eight: &TinyEight,
        facets: &[&Facet; LANES],
        (draw, primitives): (&DrawContext<'_>, &Primitives),
        tile: [u32; 2],
    ) -> Option<Self> {
        let records = primitives.records.as_slice();
        let (mut inverse_w, mut color_at) = ([[0.0; LANES]; 3], [0; LANES]);
        for (lane, facet) in facets.iter().enumerate() {
            color_at[lane] = Shader::color_of(draw, facet);
            for (k, &slot) in facet.corners.iter().enumerate() {
                inverse_w[k][lane] = records[slot as usize];
            }
        }
        let inverse_w = lanes::three(
            #[inline(always)]
            |k| F32x8::from_slice(simd, &inverse_w[k]),
        );
        let least = lanes::Lanes::min(lanes::Lanes::min(inverse_w[0], inverse_w[1]), inverse_w[2]) * MOST_W;
        if (inverse_w[0].simd_gt(least) | inverse_w[1].simd_gt(least) | inverse_w[2].simd_gt(least)).any_true() {
            return None;
        }
        let corner = lanes::inlined(
            #[inline(always)]
            |k: usize| {
                let words = lanes::columns_of_rows(
                    simd,
                    #[inline(always)]
                    |lane| {
                        let from = facets[lane].corners[k] as usize + color_at[lane];
                        bytemuck::cast(*records[from..].first_chunk::<4>().unwrap_or(&[0.0; 4]))
                    },
                );
                let color: Rgba<S> = [words[0].bitcast(), words[1].bitcast(), words[2].bitcast(), words[3].bitcast()];
                color
            },
        );
        let (base, second_color, third_color) = (corner(0), corner(1), corner(2));
        let less = lanes::inlined(
            #[inline(always)]
            |color: Rgba<S>| {
                lanes::four(
                    #[inline(always)]
                    |k| color[k] - base[k],
                )
            },
        );
        let (d1, d2) = (less(second_color), less(third_color));

        // The operations of `Interpolation::near`, in their order.
        let [x, y] = eight.corners(simd);
        let double = lanes::inlined(
            #[inline(always)]
            |value: F32x8<S>| {
                let (low, high) = simd.widen_f32x8(value);
                simd.combine_f64x4(low, high)
            },
        );
        let single = lanes::inlined(
            #[inline(always)]
            |value: F64x8<S>| {
                let (low, high) = simd.split_f64x8(value);
                simd.narrow_f64x4(low, high)
            },
        );
        let side = lanes::inlined(
            #[inline(always)]
            |to: I32x8<S>, from: I32x8<S>| double((to - from).to_float()),
        );
        let (dx1, dy1) = (side(x[1], x[0]), side(y[1], y[0]));
        let (dx2, dy2) = (side(x[2], x[0]), side(y[2], y[0]));
        let inverse = F64x8::splat(simd, f64::from(SUBPIXEL)) / (dx1 * dy2 - dx2 * dy1);
        let zero = F64x8::splat(simd, 0.0);
        let (a, b) = ([dy2 * inverse, (zero - dx2) * inverse], [(zero - dy1) * inverse, dx1 * inverse]);
        // With one w for all corners the weights themselves are planes, and their sum is 1.
        let flat = inverse_w[0].simd_eq(inverse_w[1]) & inverse_w[1].simd_eq(inverse_w[2]);
        let weight = lanes::inlined(
            #[inline(always)]
            |k: usize| double(lanes::Lanes::select(flat, splat(simd, 1.0), inverse_w[k])),
        );
        let [w0, w1, w2] = [weight(0), weight(1), weight(2)];
        let (e1, e2) = (w1 - w0, w2 - w0);
        let origin = lanes::inlined(
            #[inline(always)]
            |corner: I32x8<S>, first: u32| -> F32x8<S> {
                let absolute: F32x8<S> = (corner + first as i32 * SUBPIXEL).to_float();
                absolute * (1.0 / SUBPIXEL as f32)
            },
        );
        Some(Self {
            origin: [origin(x[0], tile[0]), origin(y[0], tile[1])],
            first: [single(a[0] * w1), single(a[1] * w1)],
            second: [single(b[0] * w2), single(b[1] * w2)],
            sum: [single(w0), single(a[0] * e1 + b[0] * e2), single(a[1] * e1 + b[1] * e2)],
            base,
            d1,
            d2,
        })
    }

    /// The packed colours at a place of all facets.
    #[inline(always)]
    pub(crate) fn colors(&self, simd: S, eight: &TinyEight, place: usize, tile: [u32; 2]) -> U32x8<S> {
        let away = lanes::inlined(
            #[inline(always)]
            |pixel: I32x8<S>, first: u32, origin: F32x8<S>| -> F32x8<S> {
                let pixel: F32x8<S> = (pixel + first as i32).to_float();
                pixel + 0.5 - origin
            },
        );
        let [column, row] = eight.pixels(simd, place);
        let (dx, dy) = (away(column, tile[0], self.origin[0]), away(row, tile[1], self.origin[1]));
        let w = splat(simd, 1.0) / (dx * self.sum[1] + dy * self.sum[2] + self.sum[0]);
        let (b1, b2) = ((dx * self.first[0] + dy * self.first[1]) * w, (dx * self.second[0] + dy * self.second[1]) * w);
        pack(&lanes::four(
            #[inline(always)]
            |k| b1 * self.d1[k] + b2 * self.d2[k] + self.base[k],
        ))
    }
}
