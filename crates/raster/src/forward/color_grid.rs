//! Colours of a flat grid of vertices, for a rectangle that is drawn in place of the grid's many small triangles.
//!
//! Each cell of the grid is two triangles. The colour at a point is that of the triangle it lies in, interpolated between
//! that triangle's three vertices, as if it had been drawn alone (Gouraud). Vertices are shaded where pixels ask for them, eight
//! of a row at a time: of the far part of a plane, and of what lies beside the picture, most are never asked for.
//!
//! In:   a place in cells, for eight points; who shades vertices. Out: eight colours.

use super::wide::{Rgba, clamp, floor, max, min, select_rgba, splat, splat_rgba};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Simd};

/// A grid of vertices.
#[derive(Clone, Copy, Debug)]
pub struct ColorGrid {
    /// Where it begins in its [`GridColors`].
    first: usize,
    /// How many vertices it has along each axis, at least 2.
    size: [u32; 2],
    /// Cells are cut from `(i, j)` to `(i + 1, j + 1)`, not from `(i + 1, j)` to `(i, j + 1)`.
    rising: bool,
}

/// Colours of eight vertices of a row: two words each, red and green, blue and alpha.
type EightColors = [AtomicU64; 2 * LANES];

/// Colours of the vertices of grids, as far as they were asked for. Threads may shade the same vertices at the same time: they
/// come to the same colours.
#[derive(Debug, Default)]
pub struct GridColors {
    /// Whether an eight is shaded.
    known: Vec<AtomicBool>,
    /// May be longer.
    colors: Vec<EightColors>,
}

/// Shades the eight vertices of row `row` from column `8 * eight` on, RGBA; some may be beyond the row's end.
pub(crate) type ShadeEight<'a> = dyn Fn(u32, u32) -> [[f32; 4]; LANES] + 'a;

impl GridColors {
    /// Forgets all grids, keeping their memory.
    pub(crate) fn clear(&mut self) {
        self.known.clear();
    }

    /// Adds a grid of `size` vertices along each axis, at least 2; see [`ColorGrid`].
    pub fn add(&mut self, size: [u32; 2], rising: bool) -> ColorGrid {
        let grid = ColorGrid { first: self.known.len(), size, rising };
        let count = grid.first + grid.across() * size[1] as usize;
        self.known.resize_with(count, AtomicBool::default);
        if self.colors.len() < count {
            self.colors.resize_with(count, EightColors::default);
        }
        grid
    }

    /// The two words of a vertex of an eight, which is shaded now if it was not; black where there is none.
    #[inline(always)]
    fn words(&self, eight: usize, lane: usize, shade: impl FnOnce() -> [[f32; 4]; LANES]) -> [u64; 2] {
        let (Some(known), Some(colors)) = (self.known.get(eight), self.colors.get(eight)) else { return [0; 2] };
        // Whoever sees `known` sees the colours that were stored before it.
        if !known.load(Ordering::Acquire) {
            let pair = |low: f32, high: f32| u64::from(low.to_bits()) | u64::from(high.to_bits()) << 32;
            for (words, [r, g, b, a]) in colors.chunks_exact(2).zip(shade()) {
                words[0].store(pair(r, g), Ordering::Relaxed);
                words[1].store(pair(b, a), Ordering::Relaxed);
            }
            known.store(true, Ordering::Release);
        }
        let lane = lane % LANES;
        [colors[2 * lane].load(Ordering::Relaxed), colors[2 * lane + 1].load(Ordering::Relaxed)]
    }
}

impl ColorGrid {
    /// Eights in a row.
    #[inline(always)]
    fn across(&self) -> usize {
        self.size[0].div_ceil(LANES as u32) as usize
    }

    /// The colours at places given in cells.
    #[inline(always)]
    pub(crate) fn at<S: Simd>(
        &self,
        simd: S,
        colors: &GridColors,
        place: [F32x8<S>; 2],
        shade: &ShadeEight<'_>,
    ) -> Rgba<S> {
        let [columns, rows] = self.size.map(|n| (n - 1) as f32);
        let x = clamp(place[0], 0.0, columns);
        let y = clamp(place[1], 0.0, rows);
        let (i, j) = (min(floor(x), splat(simd, columns - 1.0)), min(floor(y), splat(simd, rows - 1.0)));
        let (mut fx, fy) = (x - i, y - j);
        let (i, j): (I32x8<S>, I32x8<S>) = (i.to_int(), j.to_int());
        // From the corner where the diagonal begins, along the longer way to a middle corner, then to the diagonal's end.
        let (mut left, mut right) = (0, 1);
        if !self.rising {
            fx = -fx + 1.0;
            (left, right) = (right, left);
        }
        let across = fx.simd_ge(fy);
        let (a, b) = (max(fx, fy), min(fx, fy));
        let words = lanes::inlined(
            #[inline(always)]
            |i: i32, j: i32| {
                let (column, row) = (i as u32, j as u32);
                let eight = (row as usize).wrapping_mul(self.across()) + column as usize / LANES;
                let vertex = column as usize % LANES;
                colors.words(self.first + eight, vertex, || shade(row, column / LANES as u32))
            },
        );
        let (i0, j0) = (i.to_array()[0], j.to_array()[0]);
        let one_cell = (i.simd_eq(i0) & j.simd_eq(j0)).all_true();
        let (start, middle, end) = if one_cell {
            // Nearly always eight pixels lie in one cell: then its four corners are all that there is.
            let each = lanes::inlined(
                #[inline(always)]
                |di: i32, dj: i32| {
                    let [rg, ba] = words(i0 + di, j0 + dj);
                    let component = |bits: u64| f32::from_bits(bits as u32);
                    splat_rgba(simd, [component(rg), component(rg >> 32), component(ba), component(ba >> 32)])
                },
            );
            (each(left, 0), select_rgba(across, each(right, 0), each(left, 1)), each(right, 1))
        } else {
            let middle_i = across.select(i + right, i + left);
            let middle_j = across.select(j, j + 1);
            let fetch = lanes::inlined(
                #[inline(always)]
                |i: I32x8<S>, j: I32x8<S>| -> Rgba<S> {
                    let (i, j) = (i.to_array(), j.to_array());
                    let columns = lanes::columns_of_rows(
                        simd,
                        #[inline(always)]
                        |lane| bytemuck::cast(words(i[lane], j[lane])),
                    );
                    [columns[0].bitcast(), columns[1].bitcast(), columns[2].bitcast(), columns[3].bitcast()]
                },
            );
            (fetch(i + left, j), fetch(middle_i, middle_j), fetch(i + right, j + 1))
        };
        let mut color = start;
        for k in 0..4 {
            color[k] = start[k] + (middle[k] - start[k]) * a + (end[k] - middle[k]) * b;
        }
        color
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use vitral_math::lanes::{available_levels, dispatch};

    const SIZE: [u32; 2] = [20, 3];

    fn color(i: u32, j: u32) -> [f32; 4] {
        let v = j * SIZE[0] + i;
        [(v * 7 % 5) as f32, v as f32 * 0.5, (v * v % 11) as f32, 1.0]
    }

    /// The colour of the small triangle round a place, by barycentric coordinates.
    fn by_hand(rising: bool, [x, y]: [f32; 2]) -> [f32; 4] {
        let (i, j) = ((x.floor() as u32).min(SIZE[0] - 2), (y.floor() as u32).min(SIZE[1] - 2));
        let (fx, fy) = (x - i as f32, y - j as f32);
        let c = |di: u32, dj: u32| color(i + di, j + dj);
        let (p, u, v, s, t) = match (rising, if rising { fx >= fy } else { fx + fy <= 1.0 }) {
            (true, true) => (c(1, 0), c(0, 0), c(1, 1), 1.0 - fx, fy),
            (true, false) => (c(0, 1), c(1, 1), c(0, 0), fx, 1.0 - fy),
            (false, true) => (c(0, 0), c(1, 0), c(0, 1), fx, fy),
            (false, false) => (c(1, 1), c(0, 1), c(1, 0), 1.0 - fx, 1.0 - fy),
        };
        std::array::from_fn(|k| p[k] * (1.0 - s - t) + u[k] * s + v[k] * t)
    }

    #[test]
    fn colours_are_those_of_the_small_triangles_and_shaded_once() {
        let apart = [[0.0, 0.0], [0.3, 0.2], [7.3, 0.9], [8.5, 0.5], [2.9, 1.8], [19.0, 2.0], [7.9, 1.1], [1.0, 1.0]];
        let within = [0.0, 0.2, 0.4, 0.5, 0.7, 0.9, 0.1, 0.3].map(|x| [7.0 + x, 1.0 + x * x]);
        for (rising, places) in [(false, apart), (true, apart), (false, within), (true, within)] {
            for (name, level) in available_levels() {
                let mut colors = GridColors::default();
                colors.add([9, 9], true);
                let grid = colors.add(SIZE, rising);
                let asked = Mutex::new(Vec::new());
                let shade = |row: u32, eight: u32| {
                    asked.lock().unwrap().push([row, eight]);
                    std::array::from_fn(|lane| color(8 * eight + lane as u32, row))
                };
                for _ in 0..2 {
                    let out = dispatch!(level, simd => {
                        let axis = |k: usize| F32x8::from_slice(simd, &places.map(|p| p[k]));
                        let [r, g, b, a] = grid.at(simd, &colors, [axis(0), axis(1)], &shade);
                        [r.to_array(), g.to_array(), b.to_array(), a.to_array()]
                    });
                    for (lane, place) in places.into_iter().enumerate() {
                        let expected = by_hand(rising, place);
                        for k in 0..4 {
                            let difference = (out[k][lane] - expected[k]).abs();
                            assert!(difference < 1e-4, "{name} {rising} {place:?}: component {k}");
                        }
                    }
                }
                let mut asked = asked.into_inner().unwrap();
                let count = asked.len();
                asked.sort_unstable();
                asked.dedup();
                assert_eq!(asked.len(), count, "{name}: each eight once");
                assert!(asked.iter().all(|[row, eight]| *row < 3 && *eight < 3), "{asked:?}");
                assert!(count <= if places == within { 4 } else { 9 }, "{asked:?}");
            }
        }
    }
}
