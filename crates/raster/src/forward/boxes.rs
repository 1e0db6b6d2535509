//! Boxes of a tile's triangles, in the order of its list: what finds those that may matter at a
//! pixel, eight a step, without a look at the triangles themselves, which lie all over the memory.
//!
//! A box is four bytes: how far its columns and rows begin behind the tile's first and end before
//! its last ones. A pixel is four bytes likewise, and lies within if none of them is below the
//! box's.
//!
//! In:   a job's triangles, sorted by tile. Out: entries whose box holds a pixel's middle and whose
//!       bound beats a depth.
//! Cost: some ten operations for eight entries.

use super::wide::max;
use crate::TILE;
use crate::geometry::packed_box;
use std::ops::Range;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, I32x8, LANES, Simd};

/// The highest bit of each byte.
const HIGH: i32 = 0x8080_8080_u32.cast_signed();

/// See the module.
#[derive(Debug, Default)]
pub(crate) struct Boxes {
    boxes: Vec<i32>,
    /// Bounds of depths.
    bounds: Vec<f32>,
}

impl Boxes {
    /// Makes room for so many entries, whose values are what they were.
    pub(crate) fn resize(&mut self, entries: usize) {
        // Eights may reach beyond the last entry.
        self.boxes.resize(entries + LANES, 0);
        self.bounds.resize(entries + LANES, f32::NEG_INFINITY);
    }

    /// Sets an entry: the [`packed_box`] of a triangle in the tile, and the depth that none of its
    /// pixels exceeds.
    #[inline(always)]
    pub(crate) fn set(&mut self, at: usize, packed: i32, bound: f32) {
        self.boxes[at] = packed;
        self.bounds[at] = bound;
    }

    /// The largest bound of some entries.
    #[inline(always)]
    pub(crate) fn largest<S: Simd>(&self, simd: S, entries: Range<usize>) -> f32 {
        let mut most = F32x8::splat(simd, f32::NEG_INFINITY);
        let lane = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
        for at in entries.clone().step_by(LANES) {
            let bounds = F32x8::from_slice(simd, &self.bounds[at..at + LANES]);
            let ours = lane.simd_lt(I32x8::splat(simd, (entries.end - at).min(LANES) as i32));
            most = max(most, ours.select(bounds, most));
        }
        most.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max)
    }

    /// First and last column and row of an entry's box, and its bound; none if the box holds no
    /// pixel.
    pub(crate) fn get(&self, at: usize) -> Option<([[u8; 2]; 2], f32)> {
        let [x0, x1, y0, y1] = self.boxes[at].to_le_bytes();
        let side = |first: u8, before: u8| {
            (first + before < TILE as u8).then(|| [first, TILE as u8 - 1 - before])
        };
        Some(([side(x0, x1)?, side(y0, y1)?], self.bounds[at]))
    }

    /// Hands out those of some entries whose box holds pixel `(x, y)` of the tile and whose bound
    /// is above `floor`; the return value is the next floor.
    #[inline(always)]
    pub(crate) fn find<S: Simd>(
        &self,
        simd: S,
        entries: Range<usize>,
        [x, y]: [i32; 2],
        mut floor: f32,
        mut found: impl FnMut(usize) -> f32,
    ) {
        let place = I32x8::splat(simd, packed_box([x, y, x, y]) | HIGH);
        let high = I32x8::splat(simd, HIGH);
        for at in entries.clone().step_by(LANES) {
            let boxes = I32x8::from_slice(simd, &self.boxes[at..at + LANES]);
            let bounds = F32x8::from_slice(simd, &self.bounds[at..at + LANES]);
            // No byte borrows from the next: the place's are from 128 on, the box's at most 64.
            let holds = ((place - boxes) & high).simd_eq(high);
            let mut bits = (holds & bounds.simd_gt(F32x8::splat(simd, floor))).to_bitmask();
            bits &= 0xff >> (LANES - (entries.end - at).min(LANES));
            while bits != 0 {
                floor = found(at + bits.trailing_zeros() as usize);
                bits &= bits - 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::screen::Screen;
    use crate::setup::CornerPosition;
    use crate::testing::{box_of, triangles};
    use crate::{Batch, SUBPIXEL, SamplePattern, Setup, TileLists, Viewport};
    use vitral_math::lanes::{available_levels, dispatch};

    #[test]
    fn a_pixel_finds_the_triangles_whose_box_holds_it() {
        let setups = triangles(500, 64);
        let mut boxes = Boxes::default();
        boxes.resize(setups.len());
        for (at, setup) in setups.iter().enumerate() {
            boxes.set(at, box_of(setup, [64, 64]), setup.z_max);
        }
        let within = |v: [i32; 3], at: i32| {
            let middle = (at + 64) * SUBPIXEL + SUBPIXEL / 2;
            v.iter().any(|&v| v <= middle) && v.iter().any(|&v| v >= middle)
        };
        for (name, level) in available_levels() {
            let ranges = [0..setups.len(), 3..8, 9..9, 11..setups.len() - 5];
            for (range, [x, y]) in
                ranges.iter().flat_map(|r| [[0, 0], [63, 63], [5, 40], [31, 7]].map(|at| (r, at)))
            {
                for floor in [f32::NEG_INFINITY, 0.9] {
                    let mut found = Vec::new();
                    let mut find = |at| {
                        found.push(at);
                        floor
                    };
                    dispatch!(level, simd => boxes.find(simd, range.clone(), [x, y], floor, &mut find));
                    let holds = |s: &Setup| within(s.x, x) && within(s.y, y) && s.z_max > floor;
                    let expected: Vec<usize> =
                        range.clone().filter(|&at| holds(&setups[at])).collect();
                    assert_eq!(found, expected, "{name} {range:?} {x} {y} {floor}");
                }
                let largest = dispatch!(level, simd => boxes.largest(simd, range.clone()));
                let expected = setups[range.clone()]
                    .iter()
                    .fold(f32::NEG_INFINITY, |most, s| most.max(s.z_max));
                assert_eq!(largest, expected, "{name} {range:?}");
            }
        }
    }

    /// What a batch enters for each tile of a triangle is the box of the pixels whose middles it
    /// may cover there.
    #[test]
    fn a_batch_keeps_the_boxes_of_its_entries() {
        let viewport = Viewport::new(4 * TILE as u32, 3 * TILE as u32).unwrap();
        let screen = Screen::new(viewport, &SamplePattern::new(1));
        let mut batch = Batch::default();
        batch.clear(TileLists::WithBoxes);
        let mut triangles = triangles(800, 100);
        triangles.extend(triangles_at(&triangles, 90 * SUBPIXEL));
        for t in &triangles {
            let corner = |k: usize| CornerPosition { x: t.x[k], y: t.y[k], z: t.z };
            batch.add_corners(
                [corner(0), corner(1), corner(2)],
                false,
                false,
                None,
                t.facet,
                &screen,
            );
        }
        let mut entries = Vec::new();
        batch.finish_with_boxes(&screen, |place, packed, setup| {
            entries.push((place, packed, *setup))
        });
        entries.sort_by_key(|e| e.0);
        let mut seen = 0;
        for tile in 0..12 {
            let origin = [(tile % 4 * TILE) as i32, (tile / 4 * TILE) as i32];
            for (_, packed, setup) in &entries[batch.tile_range(tile)] {
                assert_eq!(*packed, box_of(setup, origin), "tile {tile}, {setup:?}");
                seen += 1;
            }
        }
        assert!(seen == entries.len() && seen > batch.setups().len(), "{seen}");
    }

    /// The same triangles elsewhere.
    fn triangles_at(triangles: &[Setup], shift: i32) -> Vec<Setup> {
        let moved =
            |t: &Setup| Setup { x: t.x.map(|x| x + shift), y: t.y.map(|y| y + shift / 2), ..*t };
        triangles.iter().map(moved).collect()
    }
}
