//! Depths alone, one sample in the middle of each pixel: what a shadow map is made of.
//!
//! In:   a facet, a tile, the depths that the tile has. Out: the nearest (or farthest) of both.
//! Cost: linear in the pixels of the facet's box within the tile, eight a step.

use super::traverse::{Placed, Window, center_edges};
use crate::{SUBPIXEL, SamplePattern, Setup, TILE, TILE_PIXELS};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Mask8, Simd};

/// Brings a facet's depths into the tile at pixel `tile`, within `window` of it. `pattern` has one sample in the centre; `merge`
/// gives what is kept of eight new and eight old depths. Coverage and depth are those of [`super::traverse`] and of
/// [`Setup::depth`].
#[inline(always)]
pub(crate) fn merge_depths<S: Simd>(
    simd: S,
    setup: &Setup,
    tile: (u32, u32),
    window: &Window,
    pattern: &SamplePattern,
    depths: &mut [f32; TILE_PIXELS],
    merge: impl Fn(F32x8<S>, F32x8<S>) -> F32x8<S>,
) {
    let Some(place) = Placed::new(setup, tile, window, pattern) else { return };
    let ([x0, x1], [y0, y1]) = (place.columns, place.rows);
    let (origin_x, origin_y) = (tile.0 as i32, tile.1 as i32);
    let edges = center_edges(setup, [origin_x, origin_y]);
    let lane = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
    let (zero, centers) = (I32x8::splat(simd, 0), F32x8::from_slice(simd, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]));
    let [low, high] = [F32x8::splat(simd, setup.z_min), F32x8::splat(simd, setup.z_max)];
    let whole = window[0] == (0..TILE);
    let mut x = if x1 - x0 < LANES { x0.min(TILE - LANES) } else { x0 & !(LANES - 1) };
    while x <= x1 {
        let mut e = [zero; 3];
        for i in 0..3 {
            let [a, b, c] = edges[i];
            e[i] = lane * a + (c + a * x as i32 + b * y0 as i32);
        }
        let allowed = columns(simd, lane, x, &window[0]);
        let left = (origin_x + x as i32) * SUBPIXEL + SUBPIXEL / 2 - setup.origin[0];
        let across = (centers + left as f32 / SUBPIXEL as f32) * setup.dz_dx;
        for y in y0..=y1 {
            let mut covered = (e[0] | e[1] | e[2]).simd_ge(zero);
            if !whole {
                covered &= allowed;
            }
            if covered.any_true() {
                let above = (origin_y + y as i32) * SUBPIXEL + SUBPIXEL / 2 - setup.origin[1];
                let z = across + (setup.z + above as f32 / SUBPIXEL as f32 * setup.dz_dy);
                let z = lanes::Lanes::min(lanes::Lanes::max(z, low), high);
                let stored = &mut depths[y * TILE + x..][..LANES];
                let old = F32x8::from_slice(simd, stored);
                lanes::Lanes::select(covered, merge(z, old), old).store_slice(stored);
            }
            for i in 0..3 {
                e[i] += edges[i][1];
            }
        }
        x += LANES;
    }
}

/// Which of the eight columns from `x` on lie in a range.
#[inline(always)]
fn columns<S: Simd>(simd: S, lane: I32x8<S>, x: usize, range: &std::ops::Range<usize>) -> Mask8<S> {
    let (first, end) = (range.start as i32 - x as i32, range.end as i32 - x as i32);
    lane.simd_ge(I32x8::splat(simd, first)) & lane.simd_lt(I32x8::splat(simd, end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::triangles;
    use vitral_math::lanes::{available_levels, dispatch};

    #[test]
    fn depths_are_those_of_single_samples() {
        let pattern = SamplePattern::new(1);
        let setups = triangles(600, 64);
        for window in [[0..TILE, 0..TILE], [5..50, 17..61]] {
            let mut expected = vec![0.25f32; TILE_PIXELS];
            for setup in &setups {
                for (x, y) in window[0].clone().flat_map(|x| window[1].clone().map(move |y| (x, y))) {
                    let at = |v: usize| (v as i32 + 64) * SUBPIXEL + SUBPIXEL / 2;
                    if setup.covers(at(x), at(y)) {
                        let depth = &mut expected[y * TILE + x];
                        *depth = depth.max(setup.depth(at(x), at(y)));
                    }
                }
            }
            for (name, level) in available_levels() {
                let mut depths = Box::new([0.25f32; TILE_PIXELS]);
                dispatch!(level, simd => {
                    for setup in &setups {
                        merge_depths(simd, setup, (64, 64), &window, &pattern, &mut depths, lanes::Lanes::max);
                    }
                });
                assert!(depths[..] == expected[..], "{name} {window:?}");
            }
        }
    }
}
