//! The nearest depths in a tile, one sample in the middle of each pixel: what a shadow map is made of.
//!
//! The z-buffer without facets: of equal depths it does not matter whose they are. Coverage and depth are those of
//! [`super::traverse`] and of [`Setup::depth`]. Triangles that are at most eight pixels wide are walked row by row, others
//! by the blocks of 8x8 pixels that they touch. A block that is full remembers how far its farthest pixel is, so that what
//! lies behind is rejected.
//!
//! In:   facets set up, in any order. Out: depths.
//! Cost: linear in the rows of eight pixels that facets touch.

use super::traverse::{Edge, Extremes, Placed, Window};
use crate::{BLOCK, SUBPIXEL, SamplePattern, Setup, TILE, TILE_PIXELS};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Level, Simd, dispatch};

/// Rows walked in a block before its far depth is computed anew.
const PATIENCE: u32 = 16;
/// Blocks along a tile's side.
const BLOCKS: usize = TILE / BLOCK;

/// Depths of a tile while facets are drawn.
#[derive(Debug)]
pub struct NearestDepths {
    tile: (u32, u32),
    pattern: SamplePattern,
    depths: Vec<f32>,
    /// For each block a depth that none of its pixels is farther than.
    far: [f32; BLOCKS * BLOCKS],
    /// Rows walked in each block since `far` was computed.
    walked: [u32; BLOCKS * BLOCKS],
}

impl NearestDepths {
    /// Nothing in the tile whose first pixel is `tile`.
    pub fn new(tile: (u32, u32)) -> Self {
        let (far, walked) = ([f32::NEG_INFINITY; BLOCKS * BLOCKS], [0; BLOCKS * BLOCKS]);
        Self { tile, pattern: SamplePattern::new(1), depths: vec![f32::NEG_INFINITY; TILE_PIXELS], far, walked }
    }

    /// Draws facets: the larger depth, the nearer one, stays.
    pub fn draw<'s>(&mut self, level: Level, setups: impl Iterator<Item = &'s Setup>) {
        dispatch!(level, simd => {
            for setup in setups {
                self.facet(simd, setup);
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
    fn facet<S: Simd>(&mut self, simd: S, setup: &Setup) {
        let window: Window = [0..TILE, 0..TILE];
        let Some(place) = Placed::new(setup, self.tile, &window, &self.pattern) else { return };
        let [x0, x1] = place.columns;
        if x1 - x0 < LANES && place.is_small() {
            self.narrow(simd, setup, &place);
        } else {
            self.wide(simd, setup, &place);
        }
    }

    /// A facet that is at most eight pixels wide and whose edge functions fit into 32 bits.
    #[inline(always)]
    fn narrow<S: Simd>(&mut self, simd: S, setup: &Setup, place: &Placed) {
        let ([x0, x1], [y0, y1]) = (place.columns, place.rows);
        let block = |x: usize, y: usize| y / BLOCK * BLOCKS + x / BLOCK;
        let own = block(x0, y0);
        if y1 - y0 < BLOCK {
            let far = [self.far[own], self.far[block(x1, y0)], self.far[block(x0, y1)], self.far[block(x1, y1)]];
            if setup.z_max < far[0].min(far[1]).min(far[2].min(far[3])) {
                return;
            }
        }
        let left = place.left();
        let (edges, corners) = place.edges();
        let lane = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
        let mut e = [lane; 3];
        for i in 0..3 {
            let Edge { a, b } = edges[i];
            let constant = edges[i].constant(corners[i], [SUBPIXEL / 2; 2]);
            e[i] = lane * a + (constant + a * left as i32 + b * y0 as i32);
        }
        let plane = Plane::new(simd, setup, self.tile, left);
        for y in y0..=y1 {
            let inside = (e[0] | e[1] | e[2]).simd_ge(I32x8::splat(simd, 0));
            if inside.any_true() {
                let stored = &mut self.depths[y * TILE + left..][..LANES];
                let old = F32x8::from_slice(simd, stored);
                let new = lanes::Lanes::max(plane.row(y), old);
                lanes::Lanes::select(inside, new, old).store_slice(stored);
            }
            for i in 0..3 {
                e[i] += edges[i].b;
            }
        }
        self.note(simd, own, (y1 - y0 + 1) as u32);
    }

    /// A facet of any size.
    #[inline(always)]
    fn wide<S: Simd>(&mut self, simd: S, setup: &Setup, place: &Placed) {
        let ([x0, x1], [y0, y1]) = (place.columns, place.rows);
        let columns = (0xff << (x0 / BLOCK)) & (0xff >> (BLOCKS - 1 - x1 / BLOCK));
        let mut seen = [0u32; BLOCKS];
        let mut any = 0;
        for row in y0 / BLOCK..=y1 / BLOCK {
            let far = F32x8::from_slice(simd, &self.far[row * BLOCKS..][..BLOCKS]);
            seen[row] = far.simd_le(F32x8::splat(simd, setup.z_max)).to_bitmask() as u32 & columns;
            any |= seen[row];
        }
        if any == 0 {
            return;
        }
        let (edges, constants) = place.center_edges();
        let extremes = Extremes::new(simd, &edges, &constants.map(|c| [c]), 1);
        let lane = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
        let zero = I32x8::splat(simd, 0);
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
                let (block, left) = (top / BLOCK * BLOCKS + number, number * BLOCK);
                let plane = Plane::new(simd, setup, self.tile, left);
                if full >> number & 1 == 1 {
                    for y in rows.clone() {
                        let stored = &mut self.depths[y * TILE + left..][..LANES];
                        let old = F32x8::from_slice(simd, stored);
                        lanes::Lanes::max(plane.row(y), old).store_slice(stored);
                    }
                } else {
                    // The rows in which no edge has all eight pixels on its outer side.
                    let (mut e, mut most) = (across, zero);
                    for i in 0..3 {
                        let Edge { a, b } = edges[i];
                        let constant = constants[i] + a * left as i32;
                        e[i] += constant;
                        most |= lane * b + (constant + b * top as i32 + (a * (BLOCK as i32 - 1)).max(0));
                    }
                    let reached = most.simd_ge(zero).to_bitmask() as u32;
                    if reached == 0 {
                        continue;
                    }
                    let first = rows.start.max(top + reached.trailing_zeros() as usize);
                    let end = rows.end.min(top + 32 - reached.leading_zeros() as usize);
                    for i in 0..3 {
                        e[i] += edges[i].b * first as i32;
                    }
                    for y in first..end {
                        let outside = (e[0] | e[1] | e[2]).simd_lt(zero);
                        let stored = &mut self.depths[y * TILE + left..][..LANES];
                        let old = F32x8::from_slice(simd, stored);
                        let new = lanes::Lanes::max(plane.row(y), old);
                        lanes::Lanes::select(outside, old, new).store_slice(stored);
                        for i in 0..3 {
                            e[i] += edges[i].b;
                        }
                    }
                }
                self.note(simd, block, rows.len() as u32);
            }
        }
    }

    /// Brings `far` up to date once enough rows were walked in a block. When does not matter to depths.
    #[inline(always)]
    fn note<S: Simd>(&mut self, simd: S, block: usize, rows: u32) {
        self.walked[block] += rows;
        if self.walked[block] < PATIENCE {
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

/// Depths of a facet on the rows of eight pixels from one column of a tile on, by the operations of [`Setup::depth`].
struct Plane<S: Simd> {
    across: F32x8<S>,
    low: F32x8<S>,
    high: F32x8<S>,
    z: f32,
    dz_dy: f32,
    /// From the plane's origin to the middles of the tile's first row, in 1/256 pixel.
    down: i32,
}

impl<S: Simd> Plane<S> {
    #[inline(always)]
    fn new(simd: S, setup: &Setup, tile: (u32, u32), left: usize) -> Self {
        let centers = F32x8::from_slice(simd, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let first = (tile.0 as i32 + left as i32) * SUBPIXEL + SUBPIXEL / 2 - setup.origin[0];
        Self {
            // Whole pixels and 1/256 pixels below 2^15 pixels: the sum is exact.
            across: (centers + first as f32 / SUBPIXEL as f32) * setup.dz_dx,
            low: F32x8::splat(simd, setup.z_min),
            high: F32x8::splat(simd, setup.z_max),
            z: setup.z,
            dz_dy: setup.dz_dy,
            down: tile.1 as i32 * SUBPIXEL + SUBPIXEL / 2 - setup.origin[1],
        }
    }

    #[inline(always)]
    fn row(&self, y: usize) -> F32x8<S> {
        let below = self.down + y as i32 * SUBPIXEL;
        let z = self.across + (self.z + below as f32 / SUBPIXEL as f32 * self.dz_dy);
        lanes::Lanes::min(lanes::Lanes::max(z, self.low), self.high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::triangles;
    use vitral_math::lanes::available_levels;

    #[test]
    fn nearest_depths_are_those_of_single_samples() {
        let setups = triangles(3000, 64);
        for count in [40, setups.len()] {
            let setups = &setups[..count];
            let mut expected = vec![f32::NEG_INFINITY; TILE_PIXELS];
            for (at, depth) in expected.iter_mut().enumerate() {
                let [x, y] = [at % TILE, at / TILE].map(|v| (v as i32 + 64) * SUBPIXEL + SUBPIXEL / 2);
                for setup in setups.iter().filter(|s| s.covers(x, y)) {
                    *depth = depth.max(setup.depth(x, y));
                }
            }
            for (name, level) in available_levels() {
                let mut nearest = NearestDepths::new((64, 64));
                nearest.draw(level, setups.iter());
                let far = nearest.far();
                let depths = nearest.into_depths();
                assert!(depths == expected, "{name}, {count} facets");
                let above = |(at, &depth): (usize, &f32)| depth >= far[at / TILE / BLOCK * BLOCKS + at % TILE / BLOCK];
                assert!(depths.iter().enumerate().all(above), "{name}, {count} facets");
            }
        }
    }
}
