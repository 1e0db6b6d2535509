//! Texture colours of blocks of pixels, kept for draws that show the same surface again.
//!
//! Programs that add up light draw their scene once for each lamp, with the same textures: a lookup
//! costs much more than to see that nothing changed.
//!
//! In:   what the colours of a facet's texture depend on, and a block of 8x8 pixels of a tile. Out:
//!       its 64 words, if it has them.
//! Cost: the comparison of two numbers, and for each facet in a tile of thirty.

use super::{Differences, Interpolation, MAX_NUMBERS};
use crate::forward::block::BlockWords;
use crate::forward::state::Unit;
use crate::{BLOCK, TILE};
use std::sync::Arc;

/// Blocks of a tile.
const BLOCKS: usize = (TILE / BLOCK) * (TILE / BLOCK);

/// What the colours of a texture within a facet depend on, but for the place. The texture lives as
/// long as the pass.
#[derive(Debug, PartialEq)]
struct TexelCacheKey {
    texture: usize,
    /// Origin of the weights, bias of the level of detail, `w` of all corners and whether they have
    /// it in common, which numbers vary.
    facet: [u32; 6],
    planes: [[u32; 3]; 3],
    /// Coordinates s, t, q of corner 0, and how much the other corners' differ.
    coordinates: [[u32; 3]; 3],
}

impl TexelCacheKey {
    /// With the unit's coordinates at `at` of the records.
    fn new(unit: &Unit, at: usize, i: &Interpolation, d: &Differences) -> Self {
        let coordinates = [at % MAX_NUMBERS, (at + 1) % MAX_NUMBERS, (at + 3) % MAX_NUMBERS];
        let varies = coordinates.iter().fold(0, |bits, k| bits << 1 | (d.varies >> k & 1) as u32);
        let [x, y] = i.origin.map(f32::to_bits);
        let w = i.flat_w.map_or([0; 2], |w| [1, w.to_bits()]);
        Self {
            texture: Arc::as_ptr(&unit.texture) as usize,
            facet: [x, y, unit.lod_bias.to_bits(), w[0], w[1], varies],
            planes: [i.first, i.second, i.sum].map(|plane| plane.map(f32::to_bits)),
            coordinates: coordinates.map(|k| [d.base[k], d.d1[k], d.d2[k]].map(f32::to_bits)),
        }
    }
}

/// Texture colours of a tile's blocks, as bytes.
#[derive(Debug, Default)]
pub(crate) struct TexelCache {
    /// Those that there were in this tile.
    sights: Vec<TexelCacheKey>,
    /// That of the facet at hand is the last one.
    current: bool,
    /// Which sight is kept in a block, and its colours. Empty until something is kept.
    blocks: Vec<(usize, BlockWords)>,
}

/// A block without cached colours.
const NONE: usize = usize::MAX;

impl TexelCache {
    /// Forgets everything, but keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.sights.clear();
        self.current = false;
        self.blocks.iter_mut().for_each(|(kept, _)| *kept = NONE);
    }

    /// Says that another facet is at hand.
    #[inline(always)]
    pub(super) fn turn(&mut self) {
        self.current = false;
    }

    /// The colours in a block, if they were kept with the sight of the facet at hand.
    #[inline(always)]
    pub(super) fn get(&self, block: usize) -> Option<&BlockWords> {
        let (kept, words) = self.blocks.get(block)?;
        let now = self.sights.len().wrapping_sub(1);
        let same = *kept == now || (*kept != NONE && self.sights.get(*kept) == self.sights.last());
        (same && self.current).then_some(words)
    }

    /// Makes ready for the facet at hand.
    #[inline(always)]
    pub(super) fn look_at(&mut self, unit: &Unit, at: usize, i: &Interpolation, d: &Differences) {
        if !self.current {
            self.current = true;
            self.sights.push(TexelCacheKey::new(unit, at, i, d));
        }
    }

    /// Where to put the colours of a block that are to be kept.
    #[inline(always)]
    pub(super) fn keep(&mut self, block: usize) -> Option<&mut BlockWords> {
        if self.blocks.is_empty() {
            self.blocks.resize(BLOCKS, (NONE, [0; BLOCK * BLOCK]));
        }
        let (kept, words) = self.blocks.get_mut(block)?;
        *kept = self.sights.len() - 1;
        Some(words)
    }
}
