//! Layers gathered pixel by pixel: a facet in a pixel is one entry, however many of the pixel's
//! samples it covers.
//!
//! A triangle is walked sample by sample; its masks and depths wait in rows of eight pixels until
//! it is done. Then the bits of a pixel are put together: of a mesh finer than a few pixels, that
//! is a fourth of the entries.

use crate::layers::Fragment;
use crate::samples::MOST_SAMPLES;
use crate::sink::{DepthTest8, Row, first_sample};
use crate::{LayerList, RowPlane, RowSink, SamplePattern, Setup, TILE, Tile};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Mask8, Simd, U32x8};

/// Collects every facet that is not hidden by the tile's opaque samples, fragment by fragment.
#[derive(Debug)]
pub struct FragmentSink<'a> {
    tile: &'a Tile,
    pattern: &'a SamplePattern,
    layers: &'a mut LayerList,
    /// What of the triangle at hand is seen in each row of the tile, sample by sample; 0 between
    /// triangles.
    seen: [[u8; MOST_SAMPLES]; TILE],
    /// Its depths there.
    depths: [[[f32; LANES]; MOST_SAMPLES]; TILE],
    /// The first row in which something is seen, the one behind the last, and the column of their
    /// first pixel.
    rows: [usize; 2],
    left: usize,
    facet: u32,
}

/// Rows before the first one is found.
const NO_ROWS: [usize; 2] = [TILE, 0];

impl<'a> FragmentSink<'a> {
    /// Adds to `layers`, in front of what `tile` holds.
    pub fn new(tile: &'a Tile, pattern: &'a SamplePattern, layers: &'a mut LayerList) -> Self {
        layers.expect_fragments(pattern.len());
        let (seen, depths) = ([[0; MOST_SAMPLES]; TILE], [[[0.0; LANES]; MOST_SAMPLES]; TILE]);
        Self { tile, pattern, layers, seen, depths, rows: NO_ROWS, left: 0, facet: 0 }
    }

    /// Hands the triangle at hand on.
    #[inline(always)]
    fn flush<S: Simd, const MAX: usize>(&mut self, simd: S) {
        let samples = if MAX == 16 { self.pattern.len().min(MAX) } else { MAX };
        let infinity = F32x8::splat(simd, f32::INFINITY);
        let [top, end] = std::mem::replace(&mut self.rows, NO_ROWS);
        // Bound each pixel's depths over its covered samples.
        for y in top..end {
            let seen = std::mem::take(&mut self.seen[y]);
            let (mut far, mut near, mut pixels, mut full) = (infinity, -infinity, 0u8, u8::MAX);
            for s in 0..samples {
                let z = F32x8::from_slice(simd, &self.depths[y][s]);
                let here = Mask8::from_bitmask(simd, u64::from(seen[s]));
                far = lanes::Lanes::min(far, here.select(z, infinity));
                near = lanes::Lanes::max(near, here.select(z, -infinity));
                (pixels, full) = (pixels | seen[s], full & seen[s]);
            }
            let (far, near) = (far.to_array(), near.to_array());
            let (depths, first) = (&self.depths[y], y * TILE + self.left);
            let place = |lane: usize| {
                let pixel = (first + lane) as u16;
                Fragment {
                    facet: self.facet,
                    pixel,
                    far: far[lane],
                    near: near[lane],
                    ..Fragment::default()
                }
            };
            // Pixels that are covered whole, then the others, whose order does not matter.
            let mut rest = pixels & !full;
            while full != 0 {
                let lane = full.trailing_zeros() as usize % LANES;
                full &= full - 1;
                self.layers.push_fragment::<MAX>(place(lane), samples, |s| (true, depths[s][lane]));
            }
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize % LANES;
                rest &= rest - 1;
                self.layers.push_fragment::<MAX>(place(lane), samples, |s| {
                    (seen[s] >> lane & 1 == 1, depths[s][lane])
                });
            }
        }
        self.layers.spread_at_limit();
    }
}

impl<S: Simd> RowSink<S> for FragmentSink<'_> {
    #[inline(always)]
    fn hiding(&self) -> Option<&Tile> {
        Some(self.tile)
    }

    #[inline(always)]
    fn first(&self, sample: usize, x: usize) -> [i32; 2] {
        first_sample(self.tile, self.pattern, sample, x)
    }

    #[inline(always)]
    fn cover_row(
        &mut self,
        simd: S,
        (setup, plane): (&Setup, &RowPlane<S>),
        sample: usize,
        at: [usize; 2],
        covered: Mask8<S>,
    ) {
        let row = Row::new(plane, sample, at, covered);
        // Where nothing opaque is, there is nothing to compare with.
        let seen = if self.tile.touched {
            DepthTest8::new(simd, self.tile, U32x8::splat(simd, setup.facet), &row).wins
        } else {
            covered
        };
        let seen = seen.to_bitmask() as u8;
        let [x, y] = at;
        self.seen[y][sample] = seen;
        row.z.store_slice(&mut self.depths[y][sample]);
        (self.left, self.facet) = (x, setup.facet);
        if seen != 0 {
            self.rows = [self.rows[0].min(y), self.rows[1].max(y + 1)];
        }
    }

    #[inline(always)]
    fn end(&mut self, simd: S, _at: [usize; 2]) {
        if self.rows == NO_ROWS {
            return;
        }
        match self.pattern.len() {
            1 => self.flush::<S, 1>(simd),
            4 => self.flush::<S, 4>(simd),
            32 => self.flush::<S, 32>(simd),
            _ => self.flush::<S, 16>(simd),
        }
    }
}
