//! Welding: vertices at one place become one vertex, for everything that asks who is next to whom.
//!
//! Idea: file formats repeat a position at every seam of normals or texture coordinates. The mesh
//! keeps its vertices; neighbourhood is asked of *representatives*: of all vertices with one
//! position, the first. Positions are equal if their coordinates are; what is smaller than the
//! rounding of the mesh's largest coordinate counts as 0, such as the sine of a half turn at a
//! sphere's pole. There is no other tolerance, so welding is transitive and never closes a real
//! gap.
//!
//! In:   positions, model space.
//! Out:  for each vertex the first vertex with the same position.
//! Cost: expected `O(n)`: dealt into buckets by a hash, then one open-addressing table a bucket,
//!       small enough for the cache.
//! Source: [Knuth 1998], section 6.4 (linear probing).

use crate::buckets::{Buckets, Source, shift_and_count};
use std::ops::Range;
use vitral_exec::Workers;

/// Which vertices are at one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Weld {
    /// For each vertex the lowest index of a vertex at the same position.
    pub representative: Vec<u32>,
    /// Number of different positions.
    pub distinct: usize,
}

impl Weld {
    /// Finds equal positions. NaN is equal to itself here, bit for bit.
    pub fn new(positions: &[[f32; 3]], workers: &Workers) -> Self {
        let (_, count) = shift_and_count(positions.len());
        let zero = zero(positions);
        let source = Hashed { positions, zero, count: count as u64 };
        let buckets = Buckets::deal(&source, count, workers);
        let repeated = workers.map(count, |b| repeated_in_bucket(positions, zero, &buckets, b));

        // Write down the repeated ones, bucket by bucket: each vertex is in one bucket only.
        let mut representative: Vec<u32> = (0..positions.len() as u32).collect();
        let mut distinct = positions.len();
        for [vertex, first] in repeated.iter().flatten() {
            representative[*vertex as usize] = *first;
            distinct -= 1;
        }
        Self { representative, distinct }
    }
}

impl Weld {
    /// The representative of `vertex`.
    #[inline]
    pub(crate) fn of(&self, vertex: u32) -> u32 {
        // Files often share vertices where they can: nothing to look up then.
        if self.distinct == self.representative.len() {
            vertex
        } else {
            self.representative[vertex as usize]
        }
    }
}

/// Coordinates count as 0 up to this part of the largest one: two steps of single precision there,
/// as far as the sine of a whole turn is from 0.
const ROUNDING: f32 = 1.0 / (1 << 22) as f32;

/// The coordinates that count as 0 in these positions.
fn zero(positions: &[[f32; 3]]) -> f32 {
    let finite = positions.as_flattened().iter().filter(|c| c.is_finite());
    ROUNDING * finite.fold(0.0f32, |most, c| most.max(c.abs()))
}

/// A position as bits, with what is at most `zero` made 0.
fn key(p: [f32; 3], zero: f32) -> [u32; 3] {
    p.map(|c| if c.abs() <= zero { 0 } else { c.to_bits() })
}

/// A well-mixed hash of a position.
fn hash(p: [f32; 3], zero: f32) -> u64 {
    let [x, y, z] = key(p, zero).map(u64::from);
    let mut h = (x | y << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    h = (h ^ h >> 32 ^ z).wrapping_mul(0xd6e8_feb8_6659_fd93);
    h ^ h >> 32
}

/// Vertices with the upper half of their hash, dealt by the lower half.
struct Hashed<'a> {
    positions: &'a [[f32; 3]],
    zero: f32,
    count: u64,
}

impl Source<[u32; 2]> for Hashed<'_> {
    fn items(&self) -> usize {
        self.positions.len()
    }

    fn visit(&self, range: Range<usize>, mut put: impl FnMut(usize, [u32; 2])) {
        for i in range {
            let h = hash(self.positions[i], self.zero);
            let bucket = ((h & 0xffff_ffff) * self.count) >> 32;
            put(bucket as usize, [i as u32, (h >> 32) as u32]);
        }
    }
}

/// Pairs of a vertex and the first vertex at its position, for every vertex of bucket `b` that is
/// not the first.
fn repeated_in_bucket(
    positions: &[[f32; 3]],
    zero: f32,
    buckets: &Buckets<[u32; 2]>,
    b: usize,
) -> Vec<[u32; 2]> {
    const FREE: u32 = u32::MAX;
    let total: usize = buckets.pieces(b).map(<[_]>::len).sum();
    let mask = (total * 2).next_power_of_two() - 1;
    let mut table = vec![FREE; mask + 1];
    let mut repeated = Vec::new();
    for &[vertex, h] in buckets.pieces(b).flatten() {
        let position = key(positions[vertex as usize], zero);
        let mut slot = h as usize & mask;
        loop {
            let seen = table[slot];
            if seen == FREE {
                table[slot] = vertex;
                break;
            }
            if key(positions[seen as usize], zero) == position {
                repeated.push([vertex, seen]);
                break;
            }
            slot = (slot + 1) & mask;
        }
    }
    repeated
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_equal_positions_stands_for_all() {
        let p =
            [[0.0, 1.0, 2.0], [3.0, 0.0, 0.0], [-0.0, 1.0, 2.0], [3.0, -0.0, 0.0], [0.0, 1.0, 2.5]];
        let weld = Weld::new(&p, &Workers::single());
        assert_eq!(weld.representative, [0, 1, 0, 1, 4]);
        assert_eq!(weld.distinct, 3);
        assert_eq!(Weld::new(&[], &Workers::single()).distinct, 0);
        let nan = Weld::new(&[[f32::NAN; 3]; 2], &Workers::single());
        assert_eq!(nan.representative, [0, 0]);
    }

    #[test]
    fn what_rounding_leaves_of_a_zero_is_one() {
        // The pole of a sphere of radius 5, and the seam, by sines of half and whole turns.
        let p = [
            [0.0, 5.0, 0.0],
            [4.4e-7, 5.0, -8.7e-7],
            [-6e-16, 5.0, 0.0],
            [1e-5, 5.0, 0.0],
            [0.0, 5.000_001, 0.0],
        ];
        assert_eq!(Weld::new(&p, &Workers::single()).representative, [0, 0, 0, 3, 4]);
    }

    #[test]
    fn many_vertices_are_welded_the_same_by_any_number_of_threads() {
        // 90000 vertices, each position three times.
        let p: Vec<[f32; 3]> =
            (0..90_000).map(|i| [(i % 30_000) as f32, (i % 173) as f32 * 0.0, 1.0]).collect();
        let one = Weld::new(&p, &Workers::single());
        assert_eq!(one.distinct, 30_000);
        assert!(one.representative.iter().enumerate().all(|(i, &r)| r as usize == i % 30_000));
        assert_eq!(one, Weld::new(&p, &Workers::new(3)));
    }
}
