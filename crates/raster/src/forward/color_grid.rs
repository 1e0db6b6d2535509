//! Colours of a flat grid of vertices, for a rectangle that is drawn in place of the grid's many small triangles.
//!
//! Each cell of the grid is two triangles. The colour at a point is that of the triangle it lies in, interpolated between
//! that triangle's three vertices, as if it had been drawn alone (Gouraud).
//!
//! In:   a place in cells, for eight points. Out: eight colours.

use super::wide::{Rgba, clamp, floor, max, min, select_rgba, splat, splat_rgba};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Simd};

/// The grid's vertices that a picture needs, a part of all.
#[derive(Clone, Copy, Debug)]
pub struct ColorGrid {
    /// Where its colours begin in [`Primitives::grid_colors`](super::Primitives::grid_colors), row by row.
    pub first: usize,
    /// The first column and row that are there.
    pub origin: [u32; 2],
    /// How many vertices are there along each axis, at least 2.
    pub size: [u32; 2],
    /// Cells are cut from `(i, j)` to `(i + 1, j + 1)`, not from `(i + 1, j)` to `(i, j + 1)`.
    pub rising: bool,
}

impl ColorGrid {
    /// The colours at places given in cells of the whole grid.
    #[inline(always)]
    pub(crate) fn at<S: Simd>(&self, simd: S, colors: &[[f32; 4]], place: [F32x8<S>; 2]) -> Rgba<S> {
        let [columns, rows] = self.size.map(|n| (n - 1) as f32);
        let x = clamp(place[0] - self.origin[0] as f32, 0.0, columns);
        let y = clamp(place[1] - self.origin[1] as f32, 0.0, rows);
        let (i, j) = (min(floor(x), splat(simd, columns - 1.0)), min(floor(y), splat(simd, rows - 1.0)));
        let (mut fx, fy) = (x - i, y - j);
        let (i, j): (I32x8<S>, I32x8<S>) = (i.to_int(), j.to_int());
        let width = self.size[0] as i32;

        // From the corner where the diagonal begins, along the longer way to a middle corner, then to the diagonal's end.
        let near = j * width + i + self.first as i32;
        let (start, end, step) = if self.rising { (near, near + (width + 1), 1) } else { (near + 1, near + width, -1) };
        if !self.rising {
            fx = -fx + 1.0;
        }
        let across = fx.simd_ge(fy);
        let (a, b) = (max(fx, fy), min(fx, fy));
        let first = start.to_array()[0];
        let (start, middle, end) = if start.simd_eq(first).all_true() {
            // Nearly always eight pixels lie in one cell: then its four corners are all that there is.
            let each = lanes::inlined(
                #[inline(always)]
                |at: i32| splat_rgba(simd, colors.get(at as u32 as usize).copied().unwrap_or_default()),
            );
            let last = if self.rising { first + width + 1 } else { first + width - 1 };
            (each(first), select_rgba(across, each(first + step), each(first + width)), each(last))
        } else {
            let middle = across.select(start + step, start + width);
            (fetch(simd, colors, start), fetch(simd, colors, middle), fetch(simd, colors, end))
        };
        let mut color = start;
        for k in 0..4 {
            color[k] = start[k] + (middle[k] - start[k]) * a + (end[k] - middle[k]) * b;
        }
        color
    }
}

/// One colour a lane; black where there is none.
#[inline(always)]
fn fetch<S: Simd>(simd: S, colors: &[[f32; 4]], at: I32x8<S>) -> Rgba<S> {
    let at = at.to_array();
    let mut rows = [[0.0f32; 4]; LANES];
    for lane in 0..LANES {
        if let Some(color) = colors.get(at[lane] as u32 as usize) {
            rows[lane] = *color;
        }
    }
    let flat = rows.as_flattened();
    let row = lanes_of(simd, flat);
    let (rb_low, ga_low) = row[0].deinterleave(row[1]);
    let (rb_high, ga_high) = row[2].deinterleave(row[3]);
    let ((r, b), (g, a)) = (rb_low.deinterleave(rb_high), ga_low.deinterleave(ga_high));
    [r, g, b, a]
}

#[inline(always)]
fn lanes_of<S: Simd>(simd: S, flat: &[f32]) -> [F32x8<S>; 4] {
    [
        F32x8::from_slice(simd, &flat[..8]),
        F32x8::from_slice(simd, &flat[8..16]),
        F32x8::from_slice(simd, &flat[16..24]),
        F32x8::from_slice(simd, &flat[24..32]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::lanes::{available_levels, dispatch};

    /// The colour of the small triangle round a place, by barycentric coordinates.
    fn by_hand(grid: &ColorGrid, colors: &[[f32; 4]], [x, y]: [f32; 2]) -> [f32; 4] {
        let (i, j) = ((x.floor() as usize).min(2), (y.floor() as usize).min(1));
        let (fx, fy) = (x - i as f32, y - j as f32);
        let c = |di: usize, dj: usize| colors[grid.first + (j + dj) * 4 + i + di];
        let (p, u, v, s, t) = match (grid.rising, if grid.rising { fx >= fy } else { fx + fy <= 1.0 }) {
            (true, true) => (c(1, 0), c(0, 0), c(1, 1), 1.0 - fx, fy),
            (true, false) => (c(0, 1), c(1, 1), c(0, 0), fx, 1.0 - fy),
            (false, true) => (c(0, 0), c(1, 0), c(0, 1), fx, fy),
            (false, false) => (c(1, 1), c(0, 1), c(1, 0), 1.0 - fx, 1.0 - fy),
        };
        std::array::from_fn(|k| p[k] * (1.0 - s - t) + u[k] * s + v[k] * t)
    }

    #[test]
    fn colours_are_those_of_the_small_triangles() {
        let colors: Vec<[f32; 4]> =
            (0..17).map(|i| [(i * 7 % 5) as f32, i as f32 * 0.5, (i * i % 11) as f32, 1.0]).collect();
        let places = [[0.0, 0.0], [0.3, 0.2], [0.3, 0.9], [1.5, 0.5], [2.9, 1.8], [3.0, 2.0], [2.2, 1.1], [1.0, 1.0]];
        for rising in [false, true] {
            let grid = ColorGrid { first: 5, origin: [10, 20], size: [4, 3], rising };
            for (name, level) in available_levels() {
                let out = dispatch!(level, simd => {
                    let axis = |k: usize| F32x8::from_slice(simd, &places.map(|p| p[k] + [10.0, 20.0][k]));
                    let [r, g, b, a] = grid.at(simd, &colors, [axis(0), axis(1)]);
                    [r.to_array(), g.to_array(), b.to_array(), a.to_array()]
                });
                for (lane, place) in places.into_iter().enumerate() {
                    let expected = by_hand(&grid, &colors, place);
                    for k in 0..4 {
                        assert!((out[k][lane] - expected[k]).abs() < 1e-4, "{name} {rising} {place:?}: component {k}");
                    }
                }
            }
        }
    }
}
