//! Slender triangles, walked along their longer side: eight columns, or eight rows, at a time.
//!
//! A sliver that is thinner than a pixel touches a block of 8x8 pixels for every eight pixels of
//! its length, and covers a few of each block. Here each lane is a column (a row, where the
//! triangle is higher than wide) and finds which pixels lie between the edges in it. Where these
//! begin is estimated, to the safe side; whether a pixel is covered is decided by the edge
//! functions of [`super::traverse`].
//!
//! In:   a triangle in a tile. Out: covered pixels, eight at a time.
//! Cost: linear in the length, times the thickness in pixels.

use super::traverse::{Edge, Placed};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Mask8, Simd};

/// Pixels by which an estimate may be wrong: far more than the rounding of positions within a tile.
const DOUBT: f32 = 1.0 / 1024.0;

/// Walks a triangle's pixels by the edge functions `a x + b y + c` with these constants. Where any
/// of eight pixels, in as many columns from a multiple of eight on, is covered, `eight` gets the
/// columns, the rows, and which are; rows and columns exchanged if the triangle
/// [`Placed::is_upright`]. All pixels are in the tile.
#[inline(always)]
pub(crate) fn each_eight<S: Simd>(
    simd: S,
    place: &Placed,
    (edges, constants): (&[Edge; 3], &[i32; 3]),
    mut eight: impl FnMut(I32x8<S>, I32x8<S>, Mask8<S>),
) {
    // Call the axis with more pixels "along", the other one "across".
    let upright = place.is_upright();
    let [along, across] =
        if upright { [place.rows, place.columns] } else { [place.columns, place.rows] };
    let [along, across] = [along, across].map(|range| range.map(|v| v as i32));
    let splat = lanes::inlined(
        #[inline(always)]
        |v: i32| I32x8::splat(simd, v),
    );
    let lane = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
    let (zero, least, most) = (splat(0), splat(across[0]), splat(across[1]));
    let [before, behind] = [across[0] - 1, across[1] + 1].map(|v| F32x8::splat(simd, v as f32));
    // How each edge function changes along and across, and what makes of its value a distance
    // across.
    let (mut steps, mut slopes, mut scales) = ([zero; 3], [zero; 3], [before; 3]);
    for i in 0..3 {
        let Edge { a, b } = edges[i];
        let [step, slope] = if upright { [b, a] } else { [a, b] };
        (steps[i], slopes[i]) = (splat(step), splat(slope));
        scales[i] = F32x8::splat(simd, if slope == 0 { 0.0 } else { -1.0 / slope as f32 });
    }
    let rises = [slopes[0].simd_gt(zero), slopes[1].simd_gt(zero), slopes[2].simd_gt(zero)];
    let falls = [slopes[0].simd_lt(zero), slopes[1].simd_lt(zero), slopes[2].simd_lt(zero)];

    // Visit eight columns along at a time.
    for start in (along[0] & !(LANES as i32 - 1)..=along[1]).step_by(LANES) {
        // Intersect the edges' crossings: the pixels between the least and the greatest are
        // candidates.
        let position = lane + start;
        let (mut low, mut high) = (before, behind);
        let mut values = [zero; 3];
        for i in 0..3 {
            values[i] = position * steps[i] + constants[i];
            let value: F32x8<S> = values[i].to_float();
            let crossing = value * scales[i];
            low = rises[i].select(lanes::Lanes::max(crossing, low), low);
            high = falls[i].select(lanes::Lanes::min(crossing, high), high);
        }
        // Such numbers fit, wherever the edges go.
        let first: I32x8<S> = lanes::Lanes::min((low - DOUBT).ceil(), behind).to_int();
        let last: I32x8<S> = lanes::Lanes::max((high + DOUBT).floor(), before).to_int();

        // Clip the candidates to the triangle's box.
        let within = position.simd_ge(splat(along[0])) & position.simd_le(splat(along[1]));
        let last = within.select(last.min(most), splat(-1));

        // Test the candidates exactly, one across in each step.
        let mut pixel = first.max(least);
        loop {
            let left = pixel.simd_le(last);
            if !left.any_true() {
                break;
            }
            let at = pixel.min(most);
            let inside = (values[0] + slopes[0] * at)
                | (values[1] + slopes[1] * at)
                | (values[2] + slopes[2] * at);
            let inside = left & inside.simd_ge(zero);
            if inside.any_true() {
                eight(position, at, inside);
            }
            pixel += 1;
        }
    }
}
