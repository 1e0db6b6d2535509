//! Tiny triangles eight at a time: which pixels they cover, and how deep these are.
//!
//! A fine mesh is made of triangles of some pixels. Walked one by one, eight pixels of a row are
//! computed where one or two are covered; here eight triangles, each in a lane, go together through
//! the pixels of their boxes. Coverage and depth are those of [`super::traverse`] and of
//! [`Setup::depth`].
//!
//! In:   triangles of a tile whose boxes hold at most 8x8 pixels. Out: masks of covered pixels, and
//!       depths.
//! Cost: some operations for each pixel of the largest box, shared by eight triangles.

use super::block::Block;
use super::traverse::{Placed, biases};
use crate::{BLOCK, SUBPIXEL, Setup, TILE};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, F32x16, Floats, I32x8, LANES, Simd};

/// As many samples a pixel may have.
pub(crate) const SAMPLES: usize = 4;

/// Pixels of a box.
pub(crate) const PLACES: usize = BLOCK * BLOCK;

/// Up to eight tiny triangles. The pixels of a triangle's box are bits of a word, or places in a
/// list: `8 * row + column` from [`TinyEight::corner`] on.
#[derive(Debug)]
pub(crate) struct TinyEight {
    /// Corners in 1/256 pixel of the tile.
    x: [[i32; LANES]; 3],
    y: [[i32; LANES]; 3],
    /// First column and row of each triangle's box, pixels of the tile.
    left: [i32; LANES],
    top: [i32; LANES],
    /// What follows the corners in setups: depth planes.
    planes: [[[i32; 4]; 2]; LANES],
    /// The pixels of boxes.
    boxes: [u64; LANES],
    /// All ones where those are covered, whatever the corners say.
    given: [u64; LANES],
    /// The largest of their ends: columns, rows.
    size: [usize; 2],
    count: usize,
    /// Depths of samples at places, of all triangles.
    depths: [[[f32; LANES]; PLACES]; SAMPLES],
}

impl Default for TinyEight {
    fn default() -> Self {
        let (corners, zeros) = ([[0; LANES]; 3], [0; LANES]);
        Self {
            x: corners,
            y: corners,
            left: zeros,
            top: zeros,
            planes: [[[0; 4]; 2]; LANES],
            boxes: [0; LANES],
            given: [0; LANES],
            size: [0; 2],
            count: 0,
            depths: [[[0.0; LANES]; PLACES]; SAMPLES],
        }
    }
}

/// The positions of the set bits, from the lowest on.
#[inline(always)]
pub(crate) fn set_bits(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = (bits != 0).then_some(bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        place
    })
}

/// Where a place of a box lies in the tile, row by row: `first` is where the box's first pixel
/// does.
#[inline(always)]
pub(crate) fn pixel(first: usize, place: usize) -> usize {
    first + place + place / BLOCK * (TILE - BLOCK)
}

impl TinyEight {
    /// How many there are.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// Removes all.
    #[inline(always)]
    pub(crate) fn clear(&mut self) {
        self.boxes = [0; LANES];
        self.given = [0; LANES];
        self.size = [0; 2];
        self.count = 0;
    }

    /// One more, which [`Placed::is_tiny`]. Not for more than eight.
    #[inline(always)]
    pub(crate) fn push(&mut self, setup: &Setup, place: &Placed) {
        let at = self.count % LANES;
        let (left, [top, bottom]) = (place.left(), place.rows);
        self.set(setup, place.corners(), [left, top]);
        let [first, last] = [place.columns[0] - left, place.columns[1] - left];
        let columns = (0xff << first & 0xff >> (BLOCK - 1 - last)) * 0x0101_0101_0101_0101;
        self.boxes[at] = columns & u64::MAX >> (BLOCK * (BLOCK - 1 - (bottom - top)));
        self.size = [self.size[0].max(last + 1), self.size[1].max(bottom - top + 1)];
        self.count = at + 1;
    }

    /// One more whose covered pixels are given, as are the first column and row of their box in the
    /// tile, which begins at pixel `tile`. Not for more than eight.
    #[cfg(any(test, feature = "forward"))]
    #[inline(always)]
    pub(crate) fn push_pixels(
        &mut self,
        setup: &Setup,
        tile: [u32; 2],
        corner: [usize; 2],
        pixels: u64,
    ) {
        let at = self.count % LANES;
        let [x, y] = tile.map(|v| v as i32 * SUBPIXEL);
        self.set(setup, (setup.x.map(|v| v - x), setup.y.map(|v| v - y)), corner);
        (self.boxes[at], self.given[at]) = (pixels, u64::MAX);
        self.size = [BLOCK, self.size[1].max(Block::of(corner, pixels).rows.end)];
        self.count = at + 1;
    }

    /// Fills the next lane but for its pixels.
    #[inline(always)]
    fn set(&mut self, setup: &Setup, (x, y): ([i32; 3], [i32; 3]), [left, top]: [usize; 2]) {
        let at = self.count % LANES;
        let words: [i32; size_of::<Setup>() / 4] = bytemuck::cast(*setup);
        self.planes[at] = [
            [words[6], words[7], words[8], words[9]],
            [words[10], words[11], words[12], words[13]],
        ];
        for k in 0..3 {
            (self.x[k][at], self.y[k][at]) = (x[k], y[k]);
        }
        (self.left[at], self.top[at]) = (left as i32, top as i32);
    }

    /// The first pixel of a triangle's box within the tile, column and row.
    #[inline(always)]
    pub(crate) fn corner(&self, triangle: usize) -> [usize; 2] {
        [self.left[triangle] as usize, self.top[triangle] as usize]
    }

    /// The depth of a triangle at a place, once [`Self::cover`] was asked for the sample.
    #[inline(always)]
    pub(crate) fn depth(&self, triangle: usize, place: usize, sample: usize) -> f32 {
        self.depths[sample % SAMPLES][place % PLACES][triangle % LANES]
    }

    /// Where the first pixel of a triangle's box lies in the tile, row by row.
    #[inline(always)]
    pub(crate) fn first(&self, triangle: usize) -> usize {
        let [left, top] = self.corner(triangle);
        top * TILE + left
    }

    /// A triangle's box, with the rows down to the last of these pixels.
    #[inline(always)]
    pub(crate) fn block(&self, triangle: usize, pixels: u64) -> Block {
        Block::of(self.corner(triangle), pixels)
    }

    /// Corners' x and y of all triangles, in 1/256 pixel of the tile.
    #[inline(always)]
    pub(crate) fn corners<S: Simd>(&self, simd: S) -> [[I32x8<S>; 3]; 2] {
        let load = lanes::inlined(
            #[inline(always)]
            |v: &[[i32; LANES]; 3]| {
                [
                    I32x8::from_slice(simd, &v[0]),
                    I32x8::from_slice(simd, &v[1]),
                    I32x8::from_slice(simd, &v[2]),
                ]
            },
        );
        [load(&self.x), load(&self.y)]
    }

    /// The column and row within the tile of a place of all triangles.
    #[inline(always)]
    pub(crate) fn pixels<S: Simd>(&self, simd: S, place: usize) -> [I32x8<S>; 2] {
        let (left, top) = (I32x8::from_slice(simd, &self.left), I32x8::from_slice(simd, &self.top));
        [left + (place % BLOCK) as i32, top + (place / BLOCK) as i32]
    }

    /// The pixels of each triangle that are covered, sample by sample: those at `positions` of a
    /// pixel in 1/256 pixel, one or four. `stored` says how depths are stored; `tile` is the tile's
    /// first pixel.
    #[inline(always)]
    pub(crate) fn cover<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        tile: (u32, u32),
        positions: [[i32; 2]; N],
        stored: impl Fn(F32x8<S>) -> F32x8<S>,
    ) -> [[u64; LANES]; SAMPLES] {
        // Load the corners and the first pixel of each box.
        let zero = I32x8::splat(simd, 0);
        let [x, y] = self.corners(simd);
        let [left, top] = self.pixels(simd, 0);
        // Edge functions as of `Placed::edges` and `Edge::constant`.
        let (mut dx, mut dy, mut corner) = ([zero; 3], [zero; 3], [zero; 3]);
        for i in 0..3 {
            let j = (i + 1) % 3;
            (dx[i], dy[i]) = (x[j] - x[i], y[j] - y[i]);
            corner[i] = dy[i] * x[i] - dx[i] * y[i] + biases(simd, dx[i], dy[i]);
        }
        // Depths by the operations of `Setup::depth`, in their order; distances from the origin are
        // exact.
        let words = lanes::inlined(
            #[inline(always)]
            |half: usize| {
                lanes::columns_of_rows(
                    simd,
                    #[inline(always)]
                    |lane| self.planes[lane][half],
                )
            },
        );
        let ([z, dz_dx, dz_dy, origin_x], [origin_y, z_min, z_max, _]) = (words(0), words(1));
        let real = lanes::inlined(
            #[inline(always)]
            |words: I32x8<S>| -> F32x8<S> { words.bitcast() },
        );
        let plane = [real(z), real(dz_dx), real(dz_dy), real(z_min), real(z_max)];
        let away = lanes::inlined(
            #[inline(always)]
            |pixel: I32x8<S>, first: i32, origin: I32x8<S>| -> F32x8<S> {
                let distance: F32x8<S> =
                    ((pixel << SUBPIXEL.trailing_zeros()) + first - origin).to_float();
                distance * (1.0 / SUBPIXEL as f32)
            },
        );

        // Prepare the walk of one sample: edge functions and distances at the first pixel.
        let walk = lanes::inlined(
            #[inline(always)]
            |sample: usize| -> Walk<S, F32x8<S>> {
                let [sx, sy] = positions[sample % N];
                let (mut a, mut row) = ([zero; 3], [zero; 3]);
                for i in 0..3 {
                    a[i] = zero - dy[i];
                    row[i] =
                        ((corner[i] + (dx[i] * sy - dy[i] * sx)) >> 8) + a[i] * left + dx[i] * top;
                }
                let distance = [
                    away(left, tile.0 as i32 * SUBPIXEL + sx, origin_x),
                    away(top, tile.1 as i32 * SUBPIXEL + sy, origin_y),
                ];
                Walk { a, b: dx, row, plane, distance }
            },
        );
        let mut covered = [self.boxes; SAMPLES];
        // Two samples go together where lanes are wide enough for both.
        let together = if <S::f32s as SimdBase<S>>::LEN > LANES { 2 } else { 1 };
        for first in (0..N.min(SAMPLES)).step_by(together) {
            if N > 1 && together == 2 {
                self.walk(simd, walk(first).with(&walk(first + 1)), first, &stored, &mut covered);
            } else {
                self.walk(simd, walk(first), first, &stored, &mut covered);
            }
        }
        covered
    }

    /// Goes through the places of the boxes with one or two samples, from number `first` on; leaves
    /// in `covered` what is.
    #[inline(always)]
    fn walk<S: Simd, V: Floats<S>>(
        &mut self,
        simd: S,
        walk: Walk<S, V>,
        first: usize,
        stored: &impl Fn(F32x8<S>) -> F32x8<S>,
        covered: &mut [[u64; LANES]; SAMPLES],
    ) {
        // Start at the first pixel with an empty mask, whose two halves hold four rows each.
        let Walk {
            a,
            b,
            mut row,
            plane: [z, dz_dx, dz_dy, z_min, z_max],
            distance: [left, mut dy],
        } = walk;
        let [columns, rows] = self.size;
        let every = lanes::inlined(
            #[inline(always)]
            |value: i32| <V::Ints as SimdBase<S>>::splat(simd, value),
        );
        let mut halves = [every(0); 2];

        // Step through the rows and columns of the largest of the boxes.
        for r in 0..rows.min(BLOCK) {
            let (mut e, mut bit) = (row, every(1 << (8 * (r % 4))));
            let (line, mut dx) = (z + dy * dz_dy, left);
            for c in 0..columns.min(BLOCK) {
                // The sign is none only where no edge's is.
                let outside = (e[0] | e[1] | e[2]) >> 31;
                halves[r / 4] |= bit & !outside;
                // Evaluate, clamp and store the depth.
                let depth = line + dx * dz_dx;
                let depth = lanes::Lanes::min(lanes::Lanes::max(depth, z_min), z_max);
                let [] = V::by_eights(
                    simd,
                    [depth],
                    #[inline(always)]
                    |lane, [depth]| {
                        let sample = (first + lane / LANES) % SAMPLES;
                        stored(depth).store_slice(&mut self.depths[sample][BLOCK * r + c]);
                        []
                    },
                );
                // Step one pixel to the right.
                bit <<= 1;
                dx += 1.0;
                for i in 0..3 {
                    e[i] += a[i];
                }
            }
            // Step one row down.
            dy += 1.0;
            for i in 0..3 {
                row[i] += b[i];
            }
        }

        // Intersect the masks with the boxes.
        let (low, high) = (halves[0].as_slice(), halves[1].as_slice());
        for lane in 0..V::LEN {
            let inside =
                u64::from(low[lane].cast_unsigned()) | u64::from(high[lane].cast_unsigned()) << 32;
            covered[(first + lane / LANES) % SAMPLES][lane % LANES] &=
                inside | self.given[lane % LANES];
        }
    }
}

/// What eight triangles' edge functions and depths begin with at one sample of their boxes' first
/// pixels, or at two: those of the second sample in the upper lanes.
#[derive(Clone, Copy)]
struct Walk<S: Simd, V: Floats<S>> {
    /// What edge functions change by with a column, with a row.
    a: [V::Ints; 3],
    b: [V::Ints; 3],
    /// Values of the edge functions at the sample of the box's first pixel.
    row: [V::Ints; 3],
    /// `z`, `dz_dx`, `dz_dy`, `z_min`, `z_max`.
    plane: [V; 5],
    /// From the plane's origin, pixels.
    distance: [V; 2],
}

impl<S: Simd> Walk<S, F32x8<S>> {
    /// This sample in the lower lanes, the other in the upper ones.
    #[inline(always)]
    fn with(&self, other: &Self) -> Walk<S, F32x16<S>> {
        let (low, high) = (self, other);

        // Join the edge functions, which differ between the samples.
        let ints = lanes::inlined(
            #[inline(always)]
            |low: [I32x8<S>; 3], high: [I32x8<S>; 3]| {
                [low[0].combine(high[0]), low[1].combine(high[1]), low[2].combine(high[2])]
            },
        );

        // Repeat the depth plane, which is the same.
        let [z, dz_dx, dz_dy, z_min, z_max] = low.plane;
        let twice = lanes::inlined(
            #[inline(always)]
            |v: F32x8<S>| v.combine(v),
        );
        Walk {
            a: ints(low.a, high.a),
            b: ints(low.b, high.b),
            row: ints(low.row, high.row),
            plane: [twice(z), twice(dz_dx), twice(dz_dy), twice(z_min), twice(z_max)],
            distance: [
                low.distance[0].combine(high.distance[0]),
                low.distance[1].combine(high.distance[1]),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SamplePattern;
    use crate::testing::triangles;
    use vitral_math::lanes::{available_levels, dispatch};

    #[test]
    fn covers_what_its_triangles_cover_at_their_depths() {
        let tile = (64, 64);
        let window = [0..50, 3..TILE];
        for samples in [1, 4] {
            let pattern = SamplePattern::new(samples);
            let place =
                |setup: &Setup| Placed::new(setup, tile, &window, &pattern).filter(Placed::is_tiny);
            let tiny: Vec<_> =
                triangles(4000, 64).into_iter().filter(|s| place(s).is_some()).collect();
            assert!(tiny.len() > 500, "{}", tiny.len());
            for (name, level) in available_levels() {
                let (mut eight, mut covered, mut clipped) = (TinyEight::default(), 0, 0);
                for (number, setups) in tiny.chunks(LANES).enumerate() {
                    // Some eights are not full.
                    let setups = &setups[number % 3 * setups.len() / 8..];
                    eight.clear();
                    setups.iter().for_each(|setup| eight.push(setup, &place(setup).unwrap()));
                    assert_eq!(eight.len(), setups.len());
                    let positions = [0, 1, 2, 3].map(|sample| pattern.position(sample % samples));
                    let all = dispatch!(level, simd => match samples {
                        1 => eight.cover(simd, tile, [positions[0]], |depth| depth * 0.5),
                        _ => eight.cover(simd, tile, positions, |depth| depth * 0.5),
                    });
                    for (sample, masks) in all.into_iter().enumerate().take(samples) {
                        let [sx, sy] = positions[sample];
                        let mut found = Vec::new();
                        for (triangle, &mask) in masks.iter().enumerate() {
                            let pixel_of = |place| {
                                (
                                    triangle,
                                    pixel(eight.first(triangle), place),
                                    2.0 * eight.depth(triangle, place, sample),
                                )
                            };
                            found.extend(set_bits(mask).map(pixel_of));
                        }
                        let mut expected = Vec::new();
                        for (triangle, setup) in setups.iter().enumerate() {
                            let [columns, rows] = window.clone();
                            for at in 0..TILE * TILE {
                                let [x, y] = [at % TILE, at / TILE].map(|v| v as i32);
                                let place = [(64 + x) * SUBPIXEL + sx, (64 + y) * SUBPIXEL + sy];
                                if setup.covers(place[0], place[1]) {
                                    if columns.contains(&(x as usize))
                                        && rows.contains(&(y as usize))
                                    {
                                        expected.push((
                                            triangle,
                                            at,
                                            setup.depth(place[0], place[1]),
                                        ));
                                    } else {
                                        clipped += 1;
                                    }
                                }
                            }
                        }
                        assert_eq!(found, expected, "{name}, sample {sample} of {samples}");
                        covered += found.len();
                    }
                }
                assert!(covered > 1000 && clipped > 100, "{covered} {clipped}");
            }
        }
    }
}
