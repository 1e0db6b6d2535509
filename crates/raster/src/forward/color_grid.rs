//! Colours of a flat grid of vertices, for a rectangle that is drawn in place of the grid's many
//! small triangles.
//!
//! Each cell of the grid is two triangles. The colour at a point is that of the triangle it lies
//! in, interpolated between that triangle's three vertices, as if it had been drawn alone
//! (Gouraud). Vertices are shaded where pixels ask for them, eight of a row at a time: of the far
//! part of a plane, and of what lies beside the picture, most are never asked for.
//!
//! In:   places in cells, for groups of eight points or sixteen; who shades vertices. Out: their
//!       colours.

use super::wide::{bits_of, clamp, every, every_rgba, floor, max, min, select_rgba};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, Floats, LANES, MaskOf, Simd};

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

/// Cells that a group of places is interpolated in cell by cell; places in further cells are
/// interpolated one by one.
const MAX_CELLS: usize = 3;

/// Colours of eight vertices of a row: two words each, red and green, blue and alpha.
type EightColors = [AtomicU64; 2 * LANES];

/// Colours of the vertices of grids, as far as they were asked for. Threads may shade the same
/// vertices at the same time: they come to the same colours.
#[derive(Debug, Default)]
pub struct GridColors {
    /// Whether an eight is shaded.
    known: Vec<AtomicBool>,
    /// May be longer.
    colors: Vec<EightColors>,
}

/// Shades the eight vertices of row `row` from column `8 * eight` on, RGBA; some may be beyond the
/// row's end.
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

    /// The two words of a vertex of an eight, which is shaded at the first call; black where there
    /// is none.
    #[inline(always)]
    fn words(
        &self,
        eight: usize,
        lane: usize,
        shade: impl FnOnce() -> [[f32; 4]; LANES],
    ) -> [u64; 2] {
        let (Some(known), Some(colors)) = (self.known.get(eight), self.colors.get(eight)) else {
            return [0; 2];
        };
        // Whoever sees `known` sees the colours that were stored before it.
        if !known.load(Ordering::Acquire) {
            let pair =
                |low: f32, high: f32| u64::from(low.to_bits()) | u64::from(high.to_bits()) << 32;
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

    /// The colours at groups of places, given in cells.
    #[inline(always)]
    pub(crate) fn at<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        colors: &GridColors,
        places: &[[V; 2]; N],
        shade: &ShadeEight<'_>,
    ) -> [[V; 4]; N] {
        // Find the grid cell of each place.
        let mut cells = [self.cell(simd, places[0]); N];
        for i in 1..N {
            cells[i] = self.cell(simd, places[i]);
        }

        // Fetch the colours of vertices, shading those that are not cached.
        let words = lanes::inlined(
            #[inline(always)]
            |[i, j]: [i32; 2]| {
                let (column, row) = (i as u32, j as u32);
                let eight = (row as usize).wrapping_mul(self.across()) + column as usize / LANES;
                let vertex = column as usize % LANES;
                let words =
                    colors.words(self.first + eight, vertex, || shade(row, column / LANES as u32));
                bytemuck::cast::<[u64; 2], [f32; 4]>(words)
            },
        );
        let corners = lanes::inlined(
            #[inline(always)]
            |[i, j]: [i32; 2]| {
                let corner = lanes::inlined(
                    #[inline(always)]
                    |[di, dj]: [i32; 2]| every_rgba(simd, words([i + di, j + dj])),
                );
                let (start, end) = self.ends();
                [corner([start, 0]), corner([end, 0]), corner([start, 1]), corner([end, 1])]
            },
        );
        let mut out = [every_rgba(simd, [0.0; 4]); N];
        // Often all places lie in one cell: then its four corners are all that there is.
        let first = cells[0].first();
        let mut together = true;
        for cell in &cells {
            together &= cell.there(first).all_true();
        }
        if together {
            let corners = corners(first);
            for i in 0..N {
                out[i] = cells[i].between(&corners);
            }
            return out;
        }

        // Otherwise interpolate cell by cell, each for all places in it.
        for i in 0..N {
            let cell = &cells[i];
            let mut rest = u32::MAX >> (u32::BITS as usize - V::LEN);
            for _ in 0..MAX_CELLS {
                let lane = rest.trailing_zeros() as usize;
                let one = [cell.i.as_slice()[lane], cell.j.as_slice()[lane]];
                let there = cell.there(one);
                out[i] = select_rgba(there, cell.between(&corners(one)), out[i]);
                rest &= !bits_of(there);
                if rest == 0 {
                    break;
                }
            }

            // Fetch the corners of the remaining places one by one.
            if rest != 0 {
                out[i] = self.interpolate_each(simd, cell, &words);
            }
        }
        out
    }

    /// Columns where a cell's diagonal begins, and where it ends.
    #[inline(always)]
    fn ends(&self) -> (i32, i32) {
        if self.rising { (0, 1) } else { (1, 0) }
    }

    /// Where places lie.
    #[inline(always)]
    fn cell<S: Simd, V: Floats<S>>(&self, simd: S, place: [V; 2]) -> Cell<S, V> {
        let [columns, rows] = self.size.map(|n| (n - 1) as f32);
        let x = clamp(place[0], 0.0, columns);
        let y = clamp(place[1], 0.0, rows);
        let (i, j) =
            (min(floor(x), every(simd, columns - 1.0)), min(floor(y), every(simd, rows - 1.0)));
        let (mut fx, fy) = (x - i, y - j);
        if !self.rising {
            fx = -fx + 1.0;
        }
        Cell {
            i: i.to_int(),
            j: j.to_int(),
            across: fx.simd_ge(fy),
            a: max(fx, fy),
            b: min(fx, fy),
        }
    }

    /// The colours of places in different cells.
    #[inline(always)]
    fn interpolate_each<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        cell: &Cell<S, V>,
        words: &impl Fn([i32; 2]) -> [f32; 4],
    ) -> [V; 4] {
        // Fetch vertices lane by lane, as columns of a register.
        let (start, end) = self.ends();
        let (i, j, across) = (cell.i.as_slice(), cell.j.as_slice(), bits_of(cell.across));
        let fetch = lanes::inlined(
            #[inline(always)]
            |vertex: &dyn Fn(usize) -> [i32; 2]| -> [V; 4] {
                V::by_eights(
                    simd,
                    [],
                    #[inline(always)]
                    |first, []| {
                        let columns = lanes::columns_of_rows(
                            simd,
                            #[inline(always)]
                            |lane| bytemuck::cast(words(vertex(first + lane))),
                        );
                        [
                            columns[0].bitcast(),
                            columns[1].bitcast(),
                            columns[2].bitcast(),
                            columns[3].bitcast(),
                        ]
                    },
                )
            },
        );

        // Interpolate between the corners of each place's half of the cell.
        let middle = |lane: usize| {
            if across >> lane & 1 == 1 {
                [i[lane] + end, j[lane]]
            } else {
                [i[lane] + start, j[lane] + 1]
            }
        };
        let begin = fetch(&|lane| [i[lane] + start, j[lane]]);
        cell.along(&begin, &fetch(&middle), &fetch(&|lane| [i[lane] + end, j[lane] + 1]))
    }
}

/// Cells that places lie in, and where in them: from the corner where the diagonal begins, `a`
/// along the longer way to a middle corner, then `b` to the diagonal's end.
#[derive(Clone, Copy)]
struct Cell<S: Simd, V: Floats<S>> {
    i: V::Ints,
    j: V::Ints,
    /// The longer way is along a row.
    across: MaskOf<S, V>,
    a: V,
    b: V,
}

impl<S: Simd, V: Floats<S>> Cell<S, V> {
    /// That of the first lane.
    #[inline(always)]
    fn first(&self) -> [i32; 2] {
        [self.i.as_slice()[0], self.j.as_slice()[0]]
    }

    /// Which lanes lie in a cell.
    #[inline(always)]
    fn there(&self, [i, j]: [i32; 2]) -> MaskOf<S, V> {
        self.i.simd_eq(i) & self.j.simd_eq(j)
    }

    /// The colours in a cell of which these are the corners: where the diagonal begins, those
    /// beside and above it, where it ends.
    #[inline(always)]
    fn between(&self, [start, beside, above, end]: &[[V; 4]; 4]) -> [V; 4] {
        self.along(start, &select_rgba(self.across, *beside, *above), end)
    }

    #[inline(always)]
    fn along(&self, start: &[V; 4], middle: &[V; 4], end: &[V; 4]) -> [V; 4] {
        let mut color = *start;
        for k in 0..4 {
            color[k] = start[k] + (middle[k] - start[k]) * self.a + (end[k] - middle[k]) * self.b;
        }
        color
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use vitral_math::lanes::{F32x8, F32x16, available_levels, dispatch};

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
        let interpolate_each = [
            [0.0, 0.0],
            [0.3, 0.2],
            [7.3, 0.9],
            [8.5, 0.5],
            [2.9, 1.8],
            [19.0, 2.0],
            [7.9, 1.1],
            [1.0, 1.0],
        ];
        let within = [0.0, 0.2, 0.4, 0.5, 0.7, 0.9, 0.1, 0.3].map(|x| [7.0 + x, 1.0 + x * x]);
        for (rising, places) in
            [(false, interpolate_each), (true, interpolate_each), (false, within), (true, within)]
        {
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
                        let place = [axis(0), axis(1)];
                        let groups = grid.at(simd, &colors, &[place, place], &shade);
                        let [[r, g, b, a], again] = groups.map(|color| color.map(|c| c.to_array()));
                        assert_eq!([r, g, b, a], again, "{name}");
                        let both = |k: usize| F32x16::from_slice(simd, &[place[k].to_array(), place[k].to_array()].concat());
                        let [wide] = grid.at(simd, &colors, &[[both(0), both(1)]], &shade);
                        for (component, eight) in wide.iter().zip([r, g, b, a]) {
                            assert_eq!(component.to_array()[..], [eight, eight].concat(), "{name}");
                        }
                        [r, g, b, a]
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
