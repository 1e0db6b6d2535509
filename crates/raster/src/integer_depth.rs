//! Depth as an integer of a few bits, as depth buffers of hardware have it: faces nearer to each
//! other than a step get equal depths.
//!
//! The depth of a facet at a sample, 0 far to 1 near, is rounded to a multiple of `1 / (2^N - 1)`
//! before it is compared. Two faces closer than a step lie at the same depth in bands, where the
//! lower facet is seen although it may lie behind: z-fighting. In perspective, depth goes with the
//! reciprocal of distance, so that steps grow with the square of the distance.
//!
//! In:   rows of covered samples (screen space). Out: the same for another sink, with depths
//!       rounded.
//! Cost: a multiplication and a division more for each sample; nothing is rejected unseen, since
//!       far depths are not rounded.
//! Source: [Catmull 1974], whose z-buffer holds integers.

use crate::{RowPlane, RowSink, Setup, Tile};
use vitral_math::lanes::{self, F32x8, Mask8, Simd};

/// Hands rows on with integer depths.
#[derive(Debug)]
pub struct IntegerDepth<'a, K> {
    sink: &'a mut K,
    /// The largest integer.
    most: f32,
}

impl<'a, K> IntegerDepth<'a, K> {
    /// Rounds for `sink` to integers of `bits` bits, `1..=32`.
    pub fn new(sink: &'a mut K, bits: u32) -> Self {
        Self { sink, most: ((1u64 << bits.clamp(1, 32)) - 1) as f32 }
    }

    /// The depths of eight samples after rounding.
    #[inline(always)]
    fn rounded<S: Simd>(&self, z: F32x8<S>) -> F32x8<S> {
        lanes::Lanes::floor(z * self.most + 0.5) / self.most
    }
}

impl<S: Simd, K: RowSink<S>> RowSink<S> for IntegerDepth<'_, K> {
    #[inline(always)]
    fn hiding(&self) -> Option<&Tile> {
        None
    }

    #[inline(always)]
    fn first(&self, sample: usize, x: usize) -> [i32; 2] {
        self.sink.first(sample, x)
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
        let pinned = plane.pinned(self.rounded(plane.row(at[1])));
        self.sink.cover_row(simd, (setup, &pinned), sample, at, covered);
    }

    #[inline(always)]
    fn end(&mut self, simd: S, at: [usize; 2]) {
        self.sink.end(simd, at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::triangles;
    use crate::{NO_FACET, SamplePattern, TileGrid, Viewport, VisibilitySink, traverse_by_rows};
    use vitral_math::lanes::{Level, dispatch};

    /// A tile with these triangles, its depths of so many bits.
    fn drawn(bits: Option<u32>) -> Tile {
        let pattern = SamplePattern::new(1);
        let mut tile = TileGrid::new(Viewport::new(64, 64).unwrap(), 1).tiles.remove(0);
        tile.clear();
        let setups = triangles(4000, 0);
        dispatch!(Level::new(), simd => {
            let mut sink = VisibilitySink::new(&mut tile, &pattern);
            match bits {
                None => setups.iter().for_each(|s| traverse_by_rows(simd, s, (0, 0), &pattern, &mut sink)),
                Some(bits) => {
                    let mut sink = IntegerDepth::new(&mut sink, bits);
                    setups.iter().for_each(|s| traverse_by_rows(simd, s, (0, 0), &pattern, &mut sink));
                }
            }
        });
        tile
    }

    #[test]
    fn p17_depths_are_multiples_of_a_step_and_many_bits_change_next_to_nothing() {
        let exact = drawn(None);
        let fought = |bits: u32| {
            let tile = drawn(Some(bits));
            let seen = || (0..tile.facet.len()).filter(|&i| tile.facet[i] != NO_FACET);
            let most = ((1u64 << bits) - 1) as f32;
            for i in seen().filter(|_| bits < 20) {
                let integer = tile.depth[i] * most;
                assert!(
                    (integer - integer.round()).abs() < 1e-2
                        && (tile.depth[i] - exact.depth[i]).abs() <= 1.0 / most
                );
            }
            assert_eq!(seen().count(), exact.facet.iter().filter(|&&f| f != NO_FACET).count());
            seen().filter(|&i| tile.facet[i] != exact.facet[i]).count()
        };
        let (few, many) = (fought(4), fought(24));
        assert!(few > 100 && many * 100 < few, "{few} samples with 4 bits, {many} with 24");
    }
}
