//! Between which depths a tile's blocks lie, found where it is asked for: what lies wholly before
//! or behind all of a block need not be compared sample by sample.
//!
//! Source: [Greene et al. 1993], with one level and both bounds.

use super::plane::PlaneTile;
use super::state::Compare;
use super::wide::{max, min};
use crate::{BLOCK, TILE, TILE_PIXELS};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, LANES, Simd};

const COUNT: usize = TILE / BLOCK * TILE / BLOCK;

/// Bounds of the stored depths of a tile's blocks.
pub(crate) struct DepthRanges {
    /// Bits of the blocks whose bounds are known.
    known: u64,
    /// Lower bound of each block's depths, as stored.
    least: [f32; COUNT],
    /// Upper bound of each block's depths, as stored.
    largest: [f32; COUNT],
}

/// What bounds tell of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Every sample of the block passes.
    AllPass,
    /// No sample of the block passes.
    AllFail,
    /// The bounds do not decide.
    Differs,
}

impl DepthRanges {
    /// Nothing is known.
    pub(crate) fn new() -> Self {
        Self { known: 0, least: [0.0; COUNT], largest: [0.0; COUNT] }
    }

    /// Depths of the blocks of `bits` were changed.
    #[inline(always)]
    pub(crate) fn forget(&mut self, bits: u64) {
        self.known &= !bits;
    }

    /// The bounds of a block.
    #[inline(always)]
    pub(crate) fn of<S: Simd>(
        &mut self,
        simd: S,
        tile: &mut PlaneTile<f32>,
        block: usize,
        samples: usize,
    ) -> [f32; 2] {
        let (bit, block) = (1 << (block % COUNT), block % COUNT);
        if self.known & bit == 0 {
            let [least, largest] = match (tile.cleared(bit), tile.surface(block)) {
                (Some(value), _) => [value; 2],
                (None, Some(surface)) => surface.range(simd),
                (None, None) => bounds(simd, tile, block, samples),
            };
            self.set(block, [least, largest]);
        }
        [self.least[block], self.largest[block]]
    }

    /// Tells the bounds of a block.
    #[inline(always)]
    pub(crate) fn set(&mut self, block: usize, [least, largest]: [f32; 2]) {
        let block = block % COUNT;
        self.known |= 1 << block;
        (self.least[block], self.largest[block]) = (least, largest);
    }
}

/// The bounds of what is stored.
#[inline(always)]
fn bounds<S: Simd>(simd: S, tile: &mut PlaneTile<f32>, block: usize, samples: usize) -> [f32; 2] {
    let first = block * BLOCK % TILE + block * BLOCK / TILE * BLOCK * TILE;
    let (samples, values) = tile.open(1 << block, true, samples);
    let start = F32x8::from_slice(simd, &values[first..first + LANES]);
    let (mut least, mut largest) = (start, start);
    for plane in values.chunks_exact(TILE_PIXELS).take(samples) {
        for row in plane[first..first + 7 * TILE + LANES].chunks(TILE) {
            let row = F32x8::from_slice(simd, &row[..LANES]);
            (least, largest) = (min(row, least), max(row, largest));
        }
    }
    let least = least.to_array().into_iter().fold(f32::INFINITY, f32::min);
    [least, largest.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max)]
}

/// What comparing depths in `low..=high` with stored ones in `least..=largest` must give.
#[inline(always)]
pub(crate) fn verdict(func: Compare, [low, high]: [f32; 2], [least, largest]: [f32; 2]) -> Verdict {
    let (pass, fail) = match func {
        Compare::GreaterOrEqual => (low >= largest, high < least),
        Compare::Greater => (low > largest, high <= least),
        Compare::LessOrEqual => (high <= least, low > largest),
        Compare::Less => (high < least, low >= largest),
        Compare::Always => (true, false),
        Compare::Never => (false, true),
        _ => (false, false),
    };
    match (pass, fail) {
        (true, _) => Verdict::AllPass,
        (_, true) => Verdict::AllFail,
        _ => Verdict::Differs,
    }
}

#[cfg(test)]
mod tests {
    use super::super::fragment_ops::compare::holds;
    use super::*;
    use vitral_math::lanes::{available_levels, dispatch};

    #[test]
    fn verdicts_are_those_of_all_pairs() {
        use Compare::{Always, Equal, Greater, GreaterOrEqual, Less, LessOrEqual, Never, NotEqual};
        let ranges: Vec<[f32; 2]> =
            (0..4).flat_map(|a| (a..4).map(move |b| [a as f32, b as f32])).collect();
        for func in [Always, Equal, Greater, GreaterOrEqual, Less, LessOrEqual, Never, NotEqual] {
            let mut decided = 0;
            for [new, old] in ranges.iter().flat_map(|a| ranges.iter().map(move |b| [*a, *b])) {
                let verdict = verdict(func, new, old);
                decided += u32::from(verdict != Verdict::Differs);
                for n in new {
                    for o in old {
                        let pass = holds(func, n, o);
                        assert!(
                            verdict == Verdict::Differs || pass == (verdict == Verdict::AllPass),
                            "{func:?}"
                        );
                    }
                }
            }
            assert!(decided > 0 || matches!(func, Equal | NotEqual), "{func:?} is never decided");
        }
    }

    #[test]
    fn bounds_are_those_of_the_samples() {
        for (name, level) in available_levels() {
            let mut tile = PlaneTile::new(0.5);
            let mut ranges = DepthRanges::new();
            let of = |ranges: &mut DepthRanges, tile: &mut PlaneTile<f32>| dispatch!(level, simd => ranges.of(simd, tile, 9, 4));
            assert_eq!(of(&mut ranges, &mut tile), [0.5, 0.5], "{name}");
            // Block 9 begins at pixel (8, 8): its last pixel is (15, 15).
            tile.stored(4)[3 * TILE_PIXELS + 15 * TILE + 15] = 0.75;
            tile.stored(4)[8 * TILE + 8] = 0.25;
            tile.stored(4)[8 * TILE + 7] = 0.0;
            tile.stored(4)[7 * TILE + 8] = 1.0;
            assert_eq!(of(&mut ranges, &mut tile), [0.5, 0.5], "{name}: not asked to forget");
            ranges.forget(1 << 9);
            assert_eq!(of(&mut ranges, &mut tile), [0.25, 0.75], "{name}");
        }
    }
}
