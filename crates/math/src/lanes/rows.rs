//! Eight rows of four numbers, as they lie in memory, and four columns of eight, as formulas take
//! them.

use super::{F32x8, F64x8, I32x4, I32x8, Simd, inlined};
use fearless_simd::prelude::*;

/// The columns of eight rows of four words, each word in the lane of its row.
#[inline(always)]
pub fn columns_of_rows<S: Simd>(simd: S, row: impl Fn(usize) -> [i32; 4]) -> [I32x8<S>; 4] {
    let at = inlined(
        #[inline(always)]
        |lane: usize| I32x4::from_slice(simd, &row(lane)),
    );
    let (low, high) =
        (transposed([at(0), at(1), at(2), at(3)]), transposed([at(4), at(5), at(6), at(7)]));
    let both = inlined(
        #[inline(always)]
        |k: usize| simd.combine_i32x4(low[k], high[k]),
    );
    [both(0), both(1), both(2), both(3)]
}

/// Hands out the eight rows of four columns: the way back from [`columns_of_rows`].
#[inline(always)]
pub fn rows_of_columns<S: Simd>(
    simd: S,
    columns: [I32x8<S>; 4],
    mut row: impl FnMut(usize, [i32; 4]),
) {
    let halves = inlined(
        #[inline(always)]
        |k: usize| simd.split_i32x8(columns[k]),
    );
    let (a, b, c, d) = (halves(0), halves(1), halves(2), halves(3));
    for (first, half) in
        [(0, transposed([a.0, b.0, c.0, d.0])), (4, transposed([a.1, b.1, c.1, d.1]))]
    {
        for k in 0..4 {
            row(first + k, half[k].to_array());
        }
    }
}

/// The coordinates of eight points as doubles, each point in a lane.
#[inline(always)]
pub fn wide_points<S: Simd>(simd: S, point: impl Fn(usize) -> [f32; 3]) -> [F64x8<S>; 3] {
    let columns = columns_of_rows(
        simd,
        #[inline(always)]
        |lane| {
            let [x, y, z] = point(lane);
            bytemuck::cast([x, y, z, 0.0])
        },
    );
    [
        widened(simd, columns[0].bitcast()),
        widened(simd, columns[1].bitcast()),
        widened(simd, columns[2].bitcast()),
    ]
}

/// Singles as doubles.
#[inline(always)]
pub fn widened<S: Simd>(simd: S, narrow: F32x8<S>) -> F64x8<S> {
    let (low, high) = simd.widen_f32x8(narrow);
    simd.combine_f64x4(low, high)
}

/// Doubles rounded to the nearest single.
#[inline(always)]
pub fn narrowed<S: Simd>(simd: S, wide: F64x8<S>) -> F32x8<S> {
    let (low, high) = simd.split_f64x8(wide);
    simd.narrow_f64x4(low, high)
}

/// Rows become columns.
#[inline(always)]
fn transposed<S: Simd>([a, b, c, d]: [I32x4<S>; 4]) -> [I32x4<S>; 4] {
    let (ac, bd) = (a.interleave(c), b.interleave(d));
    let (low, high) = (ac.0.interleave(bd.0), ac.1.interleave(bd.1));
    [low.0, low.1, high.0, high.1]
}
