//! The nearest depths in a tile, one sample in the middle of each pixel: what a shadow map is made
//! of.
//!
//! The z-buffer without facets: of equal depths it does not matter whose they are. Coverage and
//! depth are those of [`super::traverse`] and of [`Setup::depth`]. Triangles that are at most eight
//! pixels wide are walked row by row, others by the blocks of 8x8 pixels that they touch. A block
//! that is full remembers how far its farthest pixel is, so that what lies behind is rejected.
//!
//! In:   facets set up, in any order. Out: depths.
//! Cost: linear in the rows of eight pixels that facets touch.

use super::plane::RowPlane;
use super::slender;
use super::traverse::{Edge, Extremes, Placed, Window};
use crate::{BLOCK, SUBPIXEL, SamplePattern, Setup, TILE, TILE_PIXELS};
use std::ops::Range;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Level, Mask8, Simd, dispatch};

/// Rows walked in a block between two computations of its far depth.
const ROWS_PER_UPDATE: u32 = 16;
/// Blocks along a tile's side.
const BLOCKS: usize = TILE / BLOCK;
/// All of a tile.
const WHOLE: Window = [0..TILE, 0..TILE];

/// Depths of a tile while facets are drawn.
#[derive(Debug)]
pub struct NearestDepths {
    tile: (u32, u32),
    pattern: SamplePattern,
    /// 1 where larger depths are nearer, -1 where smaller ones are. All depths within are times
    /// this.
    sign: f32,
    /// The nearest depth of each pixel, row by row.
    depths: Vec<f32>,
    /// For each block a depth that none of its pixels is farther than.
    far: [f32; BLOCKS * BLOCKS],
    /// Rows walked in each block since `far` was computed.
    walked: [u32; BLOCKS * BLOCKS],
}

impl NearestDepths {
    /// Nothing in the tile whose first pixel is `tile`.
    pub fn new(tile: (u32, u32)) -> Self {
        Self::with_sign(tile, 1.0)
    }

    /// The same with a sign: for -1 the smaller depth is the nearer one, and depths are handed out
    /// negated.
    pub(crate) fn with_sign(tile: (u32, u32), sign: f32) -> Self {
        let (far, walked) = ([f32::NEG_INFINITY; BLOCKS * BLOCKS], [0; BLOCKS * BLOCKS]);
        Self {
            tile,
            pattern: SamplePattern::new(1),
            sign,
            depths: vec![f32::NEG_INFINITY; TILE_PIXELS],
            far,
            walked,
        }
    }

    /// Draws facets: the nearer depth stays.
    pub fn draw<'s>(&mut self, level: Level, setups: impl Iterator<Item = &'s Setup>) {
        dispatch!(level, simd => {
            for setup in setups {
                self.facet::<_, false>(simd, setup, &WHOLE);
            }
        });
    }

    /// Draws of each facet what lies in its window of the tile.
    #[cfg(any(test, feature = "forward"))]
    pub(crate) fn draw_within<'s>(
        &mut self,
        level: Level,
        setups: impl Iterator<Item = (&'s Setup, Window)>,
    ) {
        dispatch!(level, simd => {
            for (setup, window) in setups {
                if window == WHOLE {
                    self.facet::<_, false>(simd, setup, &WHOLE);
                } else {
                    self.facet::<_, true>(simd, setup, &window);
                }
            }
        });
    }

    /// For each block of 8x8 pixels, row by row, a depth that none of its pixels is farther than.
    pub fn far(&self) -> [f32; BLOCKS * BLOCKS] {
        self.far
    }

    /// The depths, rows of [`TILE`]: −∞ where nothing is.
    pub fn into_depths(self) -> Vec<f32> {
        self.depths
    }

    #[inline(always)]
    fn facet<S: Simd, const CLIPPED: bool>(&mut self, simd: S, setup: &Setup, window: &Window) {
        let Some(place) = Placed::new(setup, self.tile, window, &self.pattern) else { return };
        let ([x0, x1], [y0, y1]) = (place.columns, place.rows);
        if x1 - x0 < LANES && place.is_small() && (y1 - y0 < 2 * LANES || !place.is_slender()) {
            self.narrow::<S, CLIPPED>(simd, setup, &place, &window[0]);
        } else {
            self.wide::<S, CLIPPED>(simd, setup, &place, &window[0]);
        }
    }

    /// Depths of a facet in the rows of the tile, from one of its columns on.
    #[inline(always)]
    fn plane<S: Simd>(&self, simd: S, setup: &Setup, left: usize) -> RowPlane<S> {
        let middle = |pixel: u32| pixel as i32 * SUBPIXEL + SUBPIXEL / 2;
        let first = [middle(self.tile.0 + left as u32), middle(self.tile.1)];
        RowPlane::with_sign(simd, setup, self.sign, first)
    }

    /// The depth that a facet cannot be nearer than.
    #[inline(always)]
    fn nearest_of(&self, setup: &Setup) -> f32 {
        if self.sign > 0.0 { setup.z_max } else { -setup.z_min }
    }

    /// Keeps the nearer of old and new depths in a row of eight pixels, without those outside.
    #[inline(always)]
    fn keep<S: Simd>(&mut self, simd: S, at: usize, new: F32x8<S>, outside: Option<Mask8<S>>) {
        let stored = &mut self.depths[at..at + LANES];
        let old = F32x8::from_slice(simd, stored);
        let nearer = lanes::Lanes::max(new, old);
        match outside {
            Some(outside) => lanes::Lanes::select(outside, old, nearer).store_slice(stored),
            None => nearer.store_slice(stored),
        }
    }

    /// A facet that is at most eight pixels wide and whose edge functions fit into 32 bits.
    #[inline(always)]
    fn narrow<S: Simd, const CLIPPED: bool>(
        &mut self,
        simd: S,
        setup: &Setup,
        place: &Placed,
        columns: &Range<usize>,
    ) {
        // Skip the facet if every block under its box holds nearer depths everywhere.
        let ([x0, x1], [y0, y1]) = (place.columns, place.rows);
        let block = |x: usize, y: usize| y / BLOCK * BLOCKS + x / BLOCK;
        let own = block(x0, y0);
        if y1 - y0 < BLOCK {
            let far = [
                self.far[own],
                self.far[block(x1, y0)],
                self.far[block(x0, y1)],
                self.far[block(x1, y1)],
            ];
            if self.nearest_of(setup) < far[0].min(far[1]).min(far[2].min(far[3])) {
                return;
            }
        }

        // Set up the edge functions of a row of eight pixels at the facet's first row.
        let left = place.left();
        let (edges, corners) = place.edges();
        let lane = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
        let mut e = [lane; 3];
        for i in 0..3 {
            let Edge { a, b } = edges[i];
            let constant = edges[i].constant(corners[i], [SUBPIXEL / 2; 2]);
            e[i] = lane * a + (constant + a * left as i32 + b * y0 as i32);
        }

        // Walk the rows and merge the depths of covered pixels.
        let plane = self.plane(simd, setup, left);
        let beside = beside(simd, left, columns);
        for y in y0..=y1 {
            let mut outside = (e[0] | e[1] | e[2]).simd_lt(I32x8::splat(simd, 0));
            if CLIPPED {
                outside |= beside;
            }
            if !outside.all_true() {
                self.keep(simd, y * TILE + left, plane.row(y), Some(outside));
            }
            for i in 0..3 {
                e[i] += edges[i].b;
            }
        }

        // Update the block's farthest depth from time to time.
        self.note(simd, own, (y1 - y0 + 1) as u32);
    }

    /// A facet of any size.
    #[inline(always)]
    fn wide<S: Simd, const CLIPPED: bool>(
        &mut self,
        simd: S,
        setup: &Setup,
        place: &Placed,
        window: &Range<usize>,
    ) {
        let ([x0, x1], [y0, y1]) = (place.columns, place.rows);

        // Find the blocks that the facet is not behind.
        let nearest = self.nearest_of(setup);
        let columns = (0xff << (x0 / BLOCK)) & (0xff >> (BLOCKS - 1 - x1 / BLOCK));
        let mut seen = [0u32; BLOCKS];
        let mut any = 0;
        for row in y0 / BLOCK..=y1 / BLOCK {
            let far = F32x8::from_slice(simd, &self.far[row * BLOCKS..][..BLOCKS]);
            seen[row] = far.simd_le(F32x8::splat(simd, nearest)).to_bitmask() as u32 & columns;
            any |= seen[row];
        }
        if any == 0 {
            return;
        }

        // Walk thin facets along their longer axis instead of by blocks.
        let (edges, constants) = place.center_edges();
        if place.is_slender() {
            self.slender(simd, setup, place, (&edges, &constants));
            return;
        }

        // Walk those that it touches.
        let extremes = Extremes::new(simd, &edges, &constants.map(|c| [c]), 1);
        let lane = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
        let across = [lane * edges[0].a, lane * edges[1].a, lane * edges[2].a];
        for top in (y0 & !(BLOCK - 1)..=y1).step_by(BLOCK) {
            if seen[top / BLOCK] == 0 {
                continue;
            }
            let rows = y0.max(top)..(y1 + 1).min(top + BLOCK);
            let [touched, full] = extremes.row(simd, &edges, top);
            let mut rest = touched & seen[top / BLOCK];
            while rest != 0 {
                let number = rest.trailing_zeros() as usize;
                rest &= rest - 1;

                // Evaluate the depth plane at the block's left column.
                let (block, left) = (top / BLOCK * BLOCKS + number, number * BLOCK);
                let plane = self.plane(simd, setup, left);
                let beside = beside(simd, left, window);
                // Merge full blocks without edge tests.
                if full >> number & 1 == 1 {
                    for y in rows.clone() {
                        self.keep(simd, y * TILE + left, plane.row(y), CLIPPED.then_some(beside));
                    }
                } else {
                    // Step the edge functions down the rows that the facet reaches.
                    let at = constants_at(&edges, &constants, left);
                    let Some(rows) = reached_rows(simd, &edges, &at, top, &rows) else { continue };
                    let mut e = [across[0] + at[0], across[1] + at[1], across[2] + at[2]];
                    for i in 0..3 {
                        e[i] += edges[i].b * rows.start as i32;
                    }
                    for y in rows {
                        let mut outside = (e[0] | e[1] | e[2]).simd_lt(I32x8::splat(simd, 0));
                        if CLIPPED {
                            outside |= beside;
                        }
                        self.keep(simd, y * TILE + left, plane.row(y), Some(outside));
                        for i in 0..3 {
                            e[i] += edges[i].b;
                        }
                    }
                }
                self.note(simd, block, rows.len() as u32);
            }
        }
    }

    /// A facet that is thin.
    #[inline(always)]
    fn slender<S: Simd>(
        &mut self,
        simd: S,
        setup: &Setup,
        place: &Placed,
        edges: (&[Edge; 3], &[i32; 3]),
    ) {
        // Evaluate depths at the covered pixels and keep the nearer ones.
        let plane = self.plane(simd, setup, 0);
        let upright = place.is_upright();
        let nothing = F32x8::splat(simd, f32::NEG_INFINITY);
        let depths: &mut [f32; TILE_PIXELS] =
            self.depths.as_mut_slice().try_into().expect("a tile");
        slender::each_eight(
            simd,
            place,
            edges,
            #[inline(always)]
            |along, across, inside| {
                let [x, y] = if upright { [across, along] } else { [along, across] };
                let new = lanes::Lanes::select(inside, plane.at(x, y), nothing).to_array();
                let at = (x + y * TILE as i32).to_array();
                // No two are the same.
                for lane in 0..LANES {
                    let depth = &mut depths[at[lane] as usize % TILE_PIXELS];
                    *depth = if new[lane] > *depth { new[lane] } else { *depth };
                }
            },
        );
    }

    /// Brings `far` up to date once enough rows were walked in a block. When does not matter to
    /// depths.
    #[inline(always)]
    fn note<S: Simd>(&mut self, simd: S, block: usize, rows: u32) {
        self.walked[block] += rows;
        if self.walked[block] < ROWS_PER_UPDATE {
            return;
        }
        self.walked[block] = 0;
        let first = block / BLOCKS * BLOCK * TILE + block % BLOCKS * BLOCK;
        let mut far = F32x8::splat(simd, f32::INFINITY);
        for row in 0..BLOCK {
            let at = first + row * TILE;
            far = lanes::Lanes::min(far, F32x8::from_slice(simd, &self.depths[at..at + BLOCK]));
        }
        self.far[block] = far.to_array().into_iter().fold(f32::INFINITY, f32::min);
    }
}

/// Which of the eight columns from `left` on lie outside a range.
#[inline(always)]
fn beside<S: Simd>(simd: S, left: usize, range: &Range<usize>) -> Mask8<S> {
    let column = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]) + left as i32;
    column.simd_lt(I32x8::splat(simd, range.start as i32))
        | column.simd_ge(I32x8::splat(simd, range.end as i32))
}

/// The constants of edge functions for pixels counted from column `left`.
#[inline(always)]
fn constants_at(edges: &[Edge; 3], constants: &[i32; 3], left: usize) -> [i32; 3] {
    let at = |i: usize| constants[i] + edges[i].a * left as i32;
    [at(0), at(1), at(2)]
}

/// Which of a block's rows, the first of them at `top`, have no edge with all eight pixels on its
/// outer side: from the first such row to the last. `constants` are for the block's first column.
#[inline(always)]
fn reached_rows<S: Simd>(
    simd: S,
    edges: &[Edge; 3],
    constants: &[i32; 3],
    top: usize,
    rows: &Range<usize>,
) -> Option<Range<usize>> {
    let lane = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
    let zero = I32x8::splat(simd, 0);
    let mut most = zero;
    for i in 0..3 {
        let Edge { a, b } = edges[i];
        most |= lane * b + (constants[i] + b * top as i32 + (a * (BLOCK as i32 - 1)).max(0));
    }
    let reached = most.simd_ge(zero).to_bitmask() as u32;
    let first = rows.start.max(top + reached.trailing_zeros() as usize);
    let end = rows.end.min(top + 32 - reached.leading_zeros() as usize);
    (reached != 0).then_some(first..end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::CornerPosition;
    use crate::testing::triangles;
    use vitral_math::lanes::available_levels;

    #[test]
    fn nearest_depths_are_those_of_single_samples() {
        let mut setups = triangles(3000, 64);
        // With rows and columns exchanged slivers stand upright.
        let exchanged = |s: &Setup| {
            let corners = [0, 1, 2].map(|i| CornerPosition {
                x: s.y[i],
                y: s.x[i],
                z: s.depth(s.x[i], s.y[i]),
            });
            Setup::new(
                corners,
                Setup::doubled_area(corners[0], corners[1], corners[2]),
                s.facet + 3000,
            )
        };
        let upright: Vec<_> = setups.iter().map(exchanged).collect();
        for (direction, setups) in [(false, &setups), (true, &upright)] {
            let pattern = SamplePattern::new(1);
            let places = setups.iter().filter_map(|s| Placed::new(s, (64, 64), &WHOLE, &pattern));
            let slender = places.filter(|p| p.is_slender() && p.is_upright() == direction).count();
            assert!(slender > 200, "{slender} slender ones, upright: {direction}");
        }
        setups.extend(upright);
        let ways = [(1.0, WHOLE), (-1.0, WHOLE), (1.0, [5..50, 17..61]), (-1.0, [0..64, 3..4])];
        for ((sign, window), count) in ways.iter().flat_map(|way| [(way, 40), (way, setups.len())])
        {
            let setups = &setups[..count];
            let mut expected = vec![f32::NEG_INFINITY; TILE_PIXELS];
            for (x, y) in window[0].clone().flat_map(|x| window[1].clone().map(move |y| (x, y))) {
                let [sx, sy] = [x, y].map(|v| (v as i32 + 64) * SUBPIXEL + SUBPIXEL / 2);
                for setup in setups.iter().filter(|s| s.covers(sx, sy)) {
                    let depth = &mut expected[y * TILE + x];
                    *depth = depth.max(setup.depth(sx, sy) * sign);
                }
            }
            for (name, level) in available_levels() {
                let mut nearest = NearestDepths::with_sign((64, 64), *sign);
                nearest.draw_within(level, setups.iter().map(|setup| (setup, window.clone())));
                let far = nearest.far();
                let depths = nearest.into_depths();
                assert!(depths == expected, "{name}, {count} facets in {window:?}, sign {sign}");
                let above = |(at, &depth): (usize, &f32)| {
                    depth >= far[at / TILE / BLOCK * BLOCKS + at % TILE / BLOCK]
                };
                assert!(depths.iter().enumerate().all(above), "{name}, {count} facets");
            }
        }
    }
}
