//! Welds triangles that come as loose corners (STL): corners at exactly equal positions become one
//! vertex.
//!
//! Vertices are numbered by their first occurrence in the file, so the result does not depend on
//! threads. Neighbours in a mesh are mostly neighbours in the file: each block of triangles first
//! finds the places of its own corners, with a hash table that stays in the processor's cache. Then
//! the places of all blocks, far fewer than corners, are dealt into partitions by a hash of their
//! position; each partition's hash table stays in the cache, too, and partitions are independent:
//!
//! 1. each block gives its places in the order in which they occur, and for each corner the number
//!    of its place;
//! 2. each block of places is sorted by partition (counting sort, 2 bytes a place);
//! 3. each partition walks its places in file order and finds for each the first one at the same
//!    position;
//! 4. each block fetches these answers back; places that are their own first occurrence are new
//!    vertices, marked in a bit set;
//! 5. a corner's vertex number is the number of marks before the first occurrence of its place.
//!
//! In:   a function that gives the three corners of each triangle. `-0` equals `0`; a NaN equals
//!       the same NaN.
//! Out:  vertices, and triangles of indices to them.
//! Cost: `O(n)`, or `O(n log n)` for positions made to collide in the hash; 6 bytes of working
//! memory a triangle and about 24 a place.
//! Source: partitioned hash join, [Shatdal, Kant & Naughton 1994].

use vitral_exec::Workers;

/// Triangles of a block; the places of their corners are numbered with 16 bits.
const BLOCK: usize = u16::MAX as usize / 3;

/// Places of a block of them, numbered likewise.
const PLACES: usize = u16::MAX as usize;

/// Places that a partition should have at most: its table then fits the second-level cache.
const PARTITION: usize = 1 << 15;

/// Corners after which a block may know that its triangles come in no order.
const SAMPLE: usize = 1 << 12;

/// A position as comparable bits.
type Key = [u32; 3];

fn key(position: [f32; 3]) -> Key {
    // Adding zero makes +0 of -0 and changes nothing else.
    position.map(|c| (c + 0.0).to_bits())
}

fn hash(key: Key) -> u64 {
    let mut h = u64::from(key[0]) | u64::from(key[1]) << 32;
    h = (h ^ 0x9E37_79B9_7F4A_7C15).wrapping_mul(0xFF51_AFD7_ED55_8CCD);
    h = (h ^ h >> 32 ^ u64::from(key[2])).wrapping_mul(0xC4CE_B9FE_1A85_EC53);
    (h ^ h >> 29).wrapping_mul(0x9E37_79B9_7F4A_7C15)
}

/// The places of a block's corners.
struct Local {
    /// In the order in which they occur.
    places: Vec<[f32; 3]>,
    /// Their numbers, of all corners.
    numbers: Vec<[u16; 3]>,
}

/// A block's places, sorted by partition: partition `p` has `order[starts[p]..starts[p + 1]]`.
struct Dealt {
    starts: Vec<u32>,
    order: Vec<u16>,
}

/// Welds `count` triangles. `corners(t)` gives the corners of triangle `t`.
///
/// # Panics
/// If there are more than `u32::MAX / 3` triangles.
pub(crate) fn weld(
    count: usize,
    corners: impl Fn(usize) -> [[f32; 3]; 3] + Sync,
    workers: &Workers,
) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    assert!(count <= u32::MAX as usize / 3, "corner numbers have 32 bits");
    let blocks = count.div_ceil(BLOCK);
    let mut locals =
        workers.map(blocks, |b| local_places(b * BLOCK..count.min((b + 1) * BLOCK), &corners));
    let mut starts = Vec::with_capacity(blocks);
    let mut places = Vec::with_capacity(locals.iter().map(|local| local.places.len()).sum());
    for local in &mut locals {
        starts.push(places.len());
        places.append(&mut local.places);
    }
    let mut numbers = first_places(&places, workers);
    let rank = Rank::new(&numbers, workers);
    let positions = gather(&places, &rank, workers);
    drop(places);
    workers.for_each_chunk(&mut numbers, PLACES, |_, chunk| {
        chunk.iter_mut().for_each(|n| *n = rank.of(*n))
    });
    let mut triangles = vec![[0u32; 3]; count];
    workers.for_each_chunk(&mut triangles, BLOCK, |b, chunk| {
        let numbers = &numbers[starts[b]..];
        for (triangle, local) in chunk.iter_mut().zip(&locals[b].numbers) {
            *triangle = local.map(|place| numbers[place as usize]);
        }
    });
    (positions, triangles)
}

/// The places of the corners of some triangles. Where few of the first ones share places, or
/// positions collide in the hash too often, later ones get places of their own.
fn local_places(
    triangles: std::ops::Range<usize>,
    corners: &impl Fn(usize) -> [[f32; 3]; 3],
) -> Local {
    const EMPTY: u16 = u16::MAX;
    let count = 3 * triangles.len();
    let mut table = vec![EMPTY; (2 * count).next_power_of_two()];
    let mask = table.len() - 1;
    let mut places: Vec<[f32; 3]> = Vec::with_capacity(count / 2);
    let (mut seen, mut steps, mut looks) = (0, 0usize, true);
    let mut number = |position: [f32; 3]| {
        let new = places.len() as u16;
        seen += 1;
        if looks && steps < 16 * count {
            // The lower bits choose the partition.
            let mut slot = (hash(key(position)) >> 20) as usize & mask;
            while table[slot] != EMPTY {
                let place = table[slot];
                if key(places[place as usize]) == key(position) {
                    return place;
                }
                slot = (slot + 1) & mask;
                steps += 1;
            }
            table[slot] = new;
            looks = seen < SAMPLE || usize::from(new) < seen - seen / 4;
        }
        places.push(position.map(|c| c + 0.0));
        new
    };
    let numbers = triangles.map(|t| corners(t).map(&mut number)).collect();
    Local { places, numbers }
}

/// For each place the number of the first one at the same position.
fn first_places(places: &[[f32; 3]], workers: &Workers) -> Vec<u32> {
    let count = places.len();
    let partitions = (count / PARTITION).next_power_of_two().min(1 << 12);
    let blocks = count.div_ceil(PLACES);
    let dealt =
        workers.map(blocks, |b| deal(&places[b * PLACES..count.min((b + 1) * PLACES)], partitions));
    let firsts = workers.map(partitions, |p| first_occurrences(&dealt, p, places));
    let mut numbers = vec![0u32; count];
    let segments = segment_offsets(&dealt, partitions);
    workers.for_each_chunk(&mut numbers, PLACES, |b, chunk| {
        for p in 0..partitions {
            let mine =
                &dealt[b].order[dealt[b].starts[p] as usize..dealt[b].starts[p + 1] as usize];
            let answers = &firsts[p][segments[b * partitions + p] as usize..][..mine.len()];
            for (&local, &first) in mine.iter().zip(answers) {
                chunk[local as usize] = first;
            }
        }
    });
    numbers
}

/// Sorts places by partition, keeping their order within each.
fn deal(places: &[[f32; 3]], partitions: usize) -> Dealt {
    let mask = partitions as u64 - 1;
    let mut starts = vec![0u32; partitions + 1];
    let part = |position: &[f32; 3]| (hash(key(*position)) & mask) as u16;
    let parts: Vec<u16> = places.iter().map(part).collect();
    for p in &parts {
        starts[*p as usize + 1] += 1;
    }
    for p in 0..partitions {
        starts[p + 1] += starts[p];
    }
    let mut next = starts.clone();
    let mut order = vec![0u16; parts.len()];
    for (local, &p) in parts.iter().enumerate() {
        order[next[p as usize] as usize] = local as u16;
        next[p as usize] += 1;
    }
    Dealt { starts, order }
}

/// Where each block's places begin among those of each partition.
fn segment_offsets(dealt: &[Dealt], partitions: usize) -> Vec<u32> {
    let mut running = vec![0u32; partitions];
    let mut offsets = Vec::with_capacity(dealt.len() * partitions);
    for block in dealt {
        for (p, total) in running.iter_mut().enumerate() {
            offsets.push(*total);
            *total += block.starts[p + 1] - block.starts[p];
        }
    }
    offsets
}

/// For each place of partition `p`, in file order: the number of the first one at the same
/// position.
fn first_occurrences(dealt: &[Dealt], p: usize, places: &[[f32; 3]]) -> Vec<u32> {
    const EMPTY: u32 = u32::MAX;
    let members = || {
        dealt.iter().enumerate().flat_map(move |(b, block)| {
            let mine = &block.order[block.starts[p] as usize..block.starts[p + 1] as usize];
            mine.iter().map(move |&local| (b * PLACES + local as usize) as u32)
        })
    };
    let total: usize = dealt.iter().map(|b| (b.starts[p + 1] - b.starts[p]) as usize).sum();

    // An open table that grows with the vertices found, not with the places.
    let mut table = vec![([0u32; 3], EMPTY); 64];
    let (mut used, mut steps) = (0, 0usize);
    let mut firsts = Vec::with_capacity(total);
    for c in members() {
        let key = key(places[c as usize]);
        let mask = table.len() - 1;
        // The lower bits of the hash chose the partition.
        let mut slot = (hash(key) >> 20) as usize & mask;
        while table[slot].1 != EMPTY && table[slot].0 != key {
            slot = (slot + 1) & mask;
            steps += 1;
        }
        if table[slot].1 == EMPTY {
            table[slot] = (key, c);
            used += 1;
        }
        firsts.push(table[slot].1);
        if 2 * used > table.len() {
            steps += table.len() / 64;
            table = regrown(&table);
        }
        // Positions made to collide: sort instead.
        if steps > 64 * total {
            return first_occurrences_by_sorting(members(), places);
        }
    }
    firsts
}

fn regrown(table: &[(Key, u32)]) -> Vec<(Key, u32)> {
    let mut larger = vec![([0u32; 3], u32::MAX); table.len() * 2];
    let mask = larger.len() - 1;
    for &(key, first) in table.iter().filter(|e| e.1 != u32::MAX) {
        let mut slot = (hash(key) >> 20) as usize & mask;
        while larger[slot].1 != u32::MAX {
            slot = (slot + 1) & mask;
        }
        larger[slot] = (key, first);
    }
    larger
}

fn first_occurrences_by_sorting(
    members: impl Iterator<Item = u32>,
    places: &[[f32; 3]],
) -> Vec<u32> {
    let mut sorted: Vec<(Key, u32, u32)> =
        members.enumerate().map(|(rank, c)| (key(places[c as usize]), c, rank as u32)).collect();
    sorted.sort_unstable();
    let mut firsts = vec![0; sorted.len()];
    let mut first = 0;
    for (i, &(key, c, rank)) in sorted.iter().enumerate() {
        if i == 0 || sorted[i - 1].0 != key {
            first = c;
        }
        firsts[rank as usize] = first;
    }
    firsts
}

/// A bit set of the places that are first occurrences, which counts marks before a bit.
struct Rank {
    /// 64 marks, and the number of marks in all words before.
    words: Vec<(u64, u32)>,
    total: u32,
}

impl Rank {
    fn new(firsts: &[u32], workers: &Workers) -> Self {
        let mut words = vec![(0u64, 0u32); firsts.len().div_ceil(64)];
        workers.for_each_chunk(&mut words, 1024, |chunk, words| {
            for (w, word) in words.iter_mut().enumerate() {
                let base = (chunk * 1024 + w) * 64;
                for (bit, &first) in firsts[base..].iter().take(64).enumerate() {
                    word.0 |= u64::from(first as usize == base + bit) << bit;
                }
            }
        });
        let mut total = 0;
        for word in &mut words {
            word.1 = total;
            total += word.0.count_ones();
        }
        Self { words, total }
    }

    fn is_first(&self, c: usize) -> bool {
        self.words[c / 64].0 >> (c % 64) & 1 == 1
    }

    /// The number of marks before bit `c`.
    fn of(&self, c: u32) -> u32 {
        let (marks, before) = self.words[c as usize / 64];
        before + (marks & ((1 << (c % 64)) - 1)).count_ones()
    }
}

/// The positions of the first occurrences, in order.
fn gather(places: &[[f32; 3]], rank: &Rank, workers: &Workers) -> Vec<[f32; 3]> {
    let mut positions = vec![[0.0f32; 3]; rank.total as usize];
    let mut jobs = Vec::new();
    let mut rest = positions.as_mut_slice();
    for start in (0..places.len()).step_by(PLACES) {
        let end = places.len().min(start + PLACES);
        let until = if end == places.len() { rank.total } else { rank.of(end as u32) };
        let (mine, after) = rest.split_at_mut((until - rank.of(start as u32)) as usize);
        rest = after;
        jobs.push((start..end, mine));
    }
    workers.for_each(jobs, |(range, out)| {
        for (slot, place) in out.iter_mut().zip(range.filter(|&place| rank.is_first(place))) {
            *slot = places[place];
        }
    });
    positions
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashMap;

    fn plain(soup: &[[[f32; 3]; 3]]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
        let (mut seen, mut positions) = (HashMap::new(), Vec::new());
        let triangles = soup
            .iter()
            .map(|t| {
                t.map(|p| {
                    *seen.entry(key(p)).or_insert_with(|| {
                        positions.push(p);
                        positions.len() as u32 - 1
                    })
                })
            })
            .collect();
        (positions, triangles)
    }

    #[test]
    fn two_triangles_share_an_edge() {
        let soup = [
            [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            [[1.0, 0.0, 0.0], [1.0, 1.0, -0.0], [-0.0, 1.0, 0.0]],
        ];
        let (positions, triangles) = weld(2, |t| soup[t], &Workers::single());
        assert_eq!((positions.len(), triangles), (4, vec![[0, 1, 2], [1, 3, 2]]));
        assert_eq!(weld(0, |_| [[0.0; 3]; 3], &Workers::single()), (vec![], vec![]));
    }

    #[test]
    fn many_blocks_and_partitions_agree_with_a_plain_map() {
        let side = 60_000u32;
        let at = |i: u32| [(i % 300) as f32, (i / 300) as f32, 0.5];
        let soup: Vec<_> = (0..side).map(|i| [at(i), at(i + 1), at((i * 7919) % side)]).collect();
        let expected = plain(&soup);
        for workers in [Workers::single(), Workers::new(2)] {
            assert_eq!(weld(soup.len(), |t| soup[t], &workers), expected);
        }
        // In no order, and with neighbours where the blocks do not look for them.
        let scattered = |i: u32| at((i * 7919) % side);
        let soup: Vec<_> = (0..side)
            .map(|i| {
                if i % BLOCK as u32 > 9000 {
                    [at(i), at(i), at(i + 1)]
                } else {
                    [0, 1, 2].map(|k| scattered(3 * i + k))
                }
            })
            .collect();
        assert!(local_places(0..BLOCK, &|t| soup[t]).places.len() > 3 * BLOCK - 2 * SAMPLE);
        assert_eq!(weld(soup.len(), |t| soup[t], &Workers::single()), plain(&soup));
    }

    #[test]
    fn sorting_finds_the_same_first_occurrences() {
        let points: Vec<[f32; 3]> =
            (0..300).map(|i| [(i * i % 7) as f32, (i % 5) as f32, 0.0]).collect();
        let dealt = [deal(&points, 1)];
        assert_eq!(
            first_occurrences(&dealt, 0, &points),
            first_occurrences_by_sorting(0..300, &points)
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn any_soup_is_welded_by_first_occurrence(ids in proptest::collection::vec([0u8..9, 0u8..9, 0u8..9], 0..200)) {
            let soup: Vec<_> = ids.iter().map(|t| t.map(|i| [f32::from(i / 3), f32::from(i % 3), 1.0])).collect();
            prop_assert_eq!(weld(soup.len(), |t| soup[t], &Workers::single()), plain(&soup));
        }
    }
}
