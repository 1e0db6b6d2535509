//! A tile's triangles by blocks of its texels: which of them may matter at some texels, without a
//! look at the others.
//!
//! Each block of 8×8 texels has a bit for each triangle whose box reaches it. The triangles stand
//! in falling order of their bounds: the first that covers a texel is mostly the one that is kept
//! there, and what comes after the first bound that is too low needs no look. Eight texels or
//! sixteen go through the triangles of all their blocks together.
//!
//! In:   a tile's entries with their boxes and bounds. Out: triangles that may matter at texels.
//! Cost: an operation a row of blocks for each triangle; a lookup is linear in the triangles of its
//!       blocks.

use super::wide::every;
use crate::kernel::traverse::{Edge, center_edges};
use crate::{SUBPIXEL, Setup, TILE};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, Floats, MaskOf, Simd};

/// Triangles that an index holds at most, one bit each.
pub(crate) const MAX_TRIANGLES: usize = u128::BITS as usize;

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
    pub(crate) setup: &'a Setup,
    /// The texels that its draw may touch: x0, y0, x1, y1, the ends excluded.
    pub(crate) clip: [i32; 4],
}

/// What is looked at: copied, as triangles lie all over the memory.
#[derive(Debug)]
struct Indexed {
    /// Best depth of the triangle, times the sign.
    bound: f32,
    /// Edge functions of texels within the tile, not negative inside.
    edges: [Edge; 3],
    /// Values of the edge functions at the tile's first texel.
    constants: [i32; 3],
    setup: Setup,
    /// Allowed texels: x0, y0, x1, y1, the last two exclusive.
    clip: [i32; 4],
}

/// See the module.
#[derive(Debug)]
pub(crate) struct TileIndex {
    /// The tile's first texel.
    origin: [i32; 2],
    /// The triangles, best bound first.
    triangles: Vec<Indexed>,
    /// Bits of the triangles that touch each block.
    blocks: [u128; BLOCKS * BLOCKS],
}

/// Texels of a tile, eight or sixteen.
#[derive(Clone, Copy)]
pub(crate) struct TileTexels<S: Simd, V: Floats<S>> {
    /// Places in the plane.
    pub(crate) x: V::Ints,
    pub(crate) y: V::Ints,
    /// Which of them matter.
    pub(crate) active: MaskOf<S, V>,
}

impl TileIndex {
    /// Of at most [`MAX_TRIANGLES`] candidates in the tile whose first texel is `origin`.
    pub(crate) fn new(origin: [i32; 2], mut candidates: Vec<Candidate<'_>>) -> Self {
        // Sort the candidates, best bound first.
        candidates.truncate(MAX_TRIANGLES);
        candidates.sort_by(|a, b| b.bound.total_cmp(&a.bound));

        // Enter each in the blocks that its box touches.
        let mut blocks = [0; BLOCKS * BLOCKS];
        for (number, candidate) in candidates.iter().enumerate() {
            let [[left, right], [top, bottom]] =
                candidate.within.map(|side| side.map(|p| usize::from(p) / BLOCK));
            for row in blocks[top * BLOCKS..(bottom + 1) * BLOCKS].chunks_exact_mut(BLOCKS) {
                row[left..=right].iter_mut().for_each(|block| *block |= 1 << number);
            }
        }

        // Move the edge functions to the tile's origin.
        let indexed = |candidate: Candidate<'_>| {
            let Candidate { bound, setup, clip, .. } = candidate;
            let from = |v: [i32; 3], axis: usize| v.map(|v| v - origin[axis] * SUBPIXEL);
            let (edges, constants) = center_edges(&from(setup.x, 0), &from(setup.y, 1));
            Indexed { bound, edges, constants, setup: *setup, clip }
        };
        Self { origin, triangles: candidates.into_iter().map(indexed).collect(), blocks }
    }

    /// Hands out the triangles that cover some of the texels and may lie above `floors` there, with
    /// which texels; the return value is the next floors.
    #[inline(always)]
    pub(crate) fn find<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        texels: &TileTexels<S, V>,
        mut floors: V,
        mut found: impl FnMut(&Setup, MaskOf<S, V>) -> V,
    ) {
        // Gather the triangles that touch the blocks of the texels.
        let TileTexels { x, y, active } = *texels;
        let (column, row) = (x - self.origin[0], y - self.origin[1]);
        let block =
            (row >> BLOCK.trailing_zeros()) * BLOCKS as i32 + (column >> BLOCK.trailing_zeros());
        let block = block.as_slice();
        let (mut bits, mut rest) = (0, active.to_bitmask());
        while rest != 0 {
            bits |= self.blocks
                [block[rest.trailing_zeros() as usize % V::LEN] as usize % self.blocks.len()];
            rest &= rest - 1;
        }

        // Test them, best bound first.
        let whole = lanes::inlined(
            #[inline(always)]
            |value| <V::Ints as SimdBase<S>>::splat(simd, value),
        );
        let zero = whole(0);
        while bits != 0 {
            let Some(triangle) = self.triangles.get(bits.trailing_zeros() as usize) else { return };
            bits &= bits - 1;
            // NaN, which is above nothing, stands first.
            let above = active & every::<S, V>(simd, triangle.bound).simd_gt(floors);
            if !above.any_true() {
                return;
            }

            // Test coverage by the edge functions and the clip rectangle.
            let mut e = [zero; 3];
            for i in 0..3 {
                let Edge { a, b } = triangle.edges[i];
                e[i] = column * a + row * b + triangle.constants[i];
            }
            let mut covered = above & (e[0] | e[1] | e[2]).simd_ge(zero);
            if !covered.any_true() {
                continue;
            }
            let [x0, y0, x1, y1] = triangle.clip;
            covered &= x.simd_ge(whole(x0))
                & x.simd_lt(whole(x1))
                & y.simd_ge(whole(y0))
                & y.simd_lt(whole(y1));
            floors = found(&triangle.setup, covered);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::boxes::Boxes;
    use crate::testing::{box_of, triangles};
    use vitral_math::lanes::{F32x8, I32x8, LANES, Mask8, available_levels, dispatch};

    /// What triangles must be above.
    const FLOORS: [f32; 3] = [f32::NEG_INFINITY, 0.5, f32::INFINITY];

    #[test]
    fn texels_find_the_triangles_that_cover_them_from_the_highest_bound_on() {
        let setups = triangles(MAX_TRIANGLES as u32, 64);
        let mut boxes = Boxes::default();
        boxes.resize(setups.len());
        setups
            .iter()
            .enumerate()
            .for_each(|(at, setup)| boxes.set(at, box_of(setup, [64, 64]), setup.z_max));
        let candidate = |at: usize| {
            let (within, bound) = boxes.get(at)?;
            Some(Candidate {
                within,
                bound,
                setup: &setups[at],
                clip: [0, 0, 80 + at as i32 % 40, 1000],
            })
        };
        let candidates: Vec<_> = (0..setups.len()).filter_map(candidate).collect();
        assert!(
            candidates.len() > 10 && candidates.len() < setups.len(),
            "some lie elsewhere: {}",
            candidates.len()
        );
        let index = TileIndex::new([64; 2], candidates.clone());
        for (name, level) in available_levels() {
            let (mut found_once, mut clipped) = (0, 0);
            for eight in 0..TILE * TILE / LANES {
                // Texels of all blocks, those of a lane far from those of the next; the last is not
                // asked for.
                let at: [i32; LANES] = std::array::from_fn(|lane| {
                    ((eight * LANES + lane) * 1237 % (TILE * TILE)) as i32
                });
                let (x, y) =
                    (at.map(|at| 64 + at % TILE as i32), at.map(|at| 64 + at / TILE as i32));
                for floor in FLOORS {
                    let mut found = Vec::new();
                    dispatch!(level, simd => {
                        let (lanes_x, lanes_y) = (I32x8::from_slice(simd, &x), I32x8::from_slice(simd, &y));
                        let active = Mask8::from_bitmask(simd, 0x7f);
                        let floors = <F32x8<_> as SimdBase<_>>::splat(simd, floor);
                        index.find(simd, &TileTexels { x: lanes_x, y: lanes_y, active }, floors, |setup, covered| {
                            found.push((*setup, covered.to_bitmask()));
                            floors
                        });
                    });
                    assert!(found.is_sorted_by(|a, b| a.0.z_max >= b.0.z_max), "{name}");
                    for candidate in &candidates {
                        let setup = candidate.setup;
                        let covers = |lane: &usize| {
                            let place = [x[*lane], y[*lane]].map(|v| v * SUBPIXEL + SUBPIXEL / 2);
                            setup.z_max > floor && setup.covers(place[0], place[1])
                        };
                        let inside = |lane: &usize| x[*lane] < candidate.clip[2];
                        let bits = |lanes: &mut dyn Iterator<Item = usize>| {
                            lanes.fold(0, |bits, lane| bits | 1u64 << lane)
                        };
                        let expected = bits(&mut (0..LANES - 1).filter(covers).filter(inside));
                        let given =
                            found.iter().find(|(s, _)| s == setup).map_or(0, |(_, bits)| *bits);
                        assert_eq!(given, expected, "{name}, floor {floor}");
                        found_once += expected.count_ones();
                        clipped +=
                            (bits(&mut (0..LANES - 1).filter(covers)) ^ expected).count_ones();
                    }
                }
            }
            assert!(found_once > 300 && clipped > 100, "{found_once} {clipped}");
        }
    }
}
