//! A tile's triangles by blocks of its texels: which of them may matter at a texel, without a look at the others.
//!
//! Each block of 8×8 texels has a bit for each triangle whose box reaches it. The triangles stand in falling order of their
//! bounds: the first that covers a texel is mostly the one that is kept there, and what comes after the first bound that is too
//! low needs no look.
//!
//! In:   a tile's entries with their boxes and bounds. Out: entries that may matter at a texel.
//! Cost: an operation a row of blocks for each triangle; a lookup is linear in the triangles of its block.

use crate::{Setup, TILE};

/// As many triangles fit.
pub(crate) const MOST: usize = u64::BITS as usize;

/// Texels along a side of a block.
const BLOCK: usize = 8;
/// Blocks along a side of a tile.
const BLOCKS: usize = TILE / BLOCK;

/// A triangle in the tile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate<'a> {
    /// First and last column and row.
    pub(crate) within: [[u8; 2]; 2],
    /// The depth that none of its texels exceeds.
    pub(crate) bound: f32,
    pub(crate) job: u32,
    pub(crate) setup: &'a Setup,
}

/// See the module.
#[derive(Debug)]
pub(crate) struct TileIndex {
    bounds: Vec<f32>,
    /// With their jobs; copied, as they lie all over the memory.
    setups: Vec<(u32, Setup)>,
    blocks: [u64; BLOCKS * BLOCKS],
}

impl TileIndex {
    /// Of at most [`MOST`] candidates.
    pub(crate) fn new(mut candidates: Vec<Candidate<'_>>) -> Self {
        candidates.truncate(MOST);
        candidates.sort_by(|a, b| b.bound.total_cmp(&a.bound));
        let mut blocks = [0; BLOCKS * BLOCKS];
        for (number, candidate) in candidates.iter().enumerate() {
            let [[left, right], [top, bottom]] = candidate.within.map(|side| side.map(|p| usize::from(p) / BLOCK));
            for row in blocks[top * BLOCKS..(bottom + 1) * BLOCKS].chunks_exact_mut(BLOCKS) {
                row[left..=right].iter_mut().for_each(|block| *block |= 1 << number);
            }
        }
        Self {
            bounds: candidates.iter().map(|c| c.bound).collect(),
            setups: candidates.iter().map(|c| (c.job, *c.setup)).collect(),
            blocks,
        }
    }

    /// Hands out the triangles that may lie above `floor` at texel `(x, y)` of the tile, with their jobs; what is returned is the
    /// next floor.
    #[inline(always)]
    pub(crate) fn find(&self, [x, y]: [usize; 2], mut floor: f32, mut found: impl FnMut(u32, &Setup) -> f32) {
        let mut bits = self.blocks[y % TILE / BLOCK * BLOCKS + x % TILE / BLOCK];
        while bits != 0 {
            let number = bits.trailing_zeros() as usize;
            // NaN, which is above nothing, stands first.
            let (Some(&bound), Some((job, setup))) = (self.bounds.get(number), self.setups.get(number)) else { return };
            if bound <= floor {
                return;
            }
            floor = found(*job, setup);
            bits &= bits - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::boxes::Boxes;
    use crate::testing::triangles;

    #[test]
    fn a_texel_finds_the_triangles_that_may_matter_from_the_highest_bound_on() {
        let setups = triangles(MOST as u32, 64);
        let mut boxes = Boxes::default();
        boxes.resize(setups.len());
        setups.iter().enumerate().for_each(|(at, setup)| boxes.set(at, setup, [64, 64], setup.z_max));
        let candidate = |at: usize| {
            let (within, bound) = boxes.get(at)?;
            Some(Candidate { within, bound, job: 7, setup: &setups[at] })
        };
        let candidates: Vec<_> = (0..setups.len()).filter_map(candidate).collect();
        assert!(candidates.len() > 10 && candidates.len() < setups.len(), "some lie elsewhere: {}", candidates.len());
        let index = TileIndex::new(candidates.clone());
        let mut handed_out = 0;
        for (x, y) in (0..TILE).flat_map(|y| (0..TILE).map(move |x| (x, y))) {
            for floor in [f32::NEG_INFINITY, 0.5] {
                let mut found = Vec::new();
                index.find([x, y], floor, |job, setup| {
                    found.push((job, *setup));
                    floor
                });
                assert!(found.iter().all(|(job, setup)| *job == 7 && setup.z_max > floor));
                assert!(found.is_sorted_by(|a, b| a.1.z_max >= b.1.z_max));
                let holds = |c: &&Candidate<'_>| {
                    let [columns, rows] = c.within.map(|[first, last]| usize::from(first)..=usize::from(last));
                    columns.contains(&x) && rows.contains(&y) && c.bound > floor
                };
                assert!(candidates.iter().filter(holds).all(|c| found.contains(&(7, *c.setup))), "{x} {y} {floor}");
                handed_out += found.len();
            }
        }
        assert!(handed_out < TILE * TILE * candidates.len(), "not all of them, everywhere");
        let mut first = 0;
        index.find([32, 32], f32::NEG_INFINITY, |_, _| {
            first += 1;
            f32::INFINITY
        });
        assert!(first <= 1, "nothing is above infinity");
    }
}
