//! A picture of few tiles, drawn by several threads: each draws a strip of rows of a tile, in a
//! copy of its own, and the strips are put together afterwards.
//!
//! What does not reach into a strip is passed over before anything else, so that a triangle costs
//! little more than once. The first strip is drawn in the tile itself.

use super::fragment::{ColorTile, TilePlanes};
use super::pass::Item;
use super::plane::PlaneTile;
use crate::{BLOCK, TILE};
use std::ops::Range;

/// Entries in its list that make a tile worth cutting: with fewer, copying costs more than it
/// saves. Measured: benches/results/2026-11-22-opengl-tiny.md.
const MIN_ENTRIES: usize = 512;

/// Into how many strips which of the tiles are cut for `threads` threads: a power of two, at most a
/// strip for each row of blocks. Two for each thread, since one may have more in it than another.
/// Tiles are told by their place among `tiles`.
pub(crate) fn cut(
    threads: usize,
    tiles: impl Iterator<Item = usize>,
    items: &[Item<'_>],
) -> (usize, Vec<usize>) {
    let entries = |tile: usize| {
        let of_item = |item: &Item<'_>| match item {
            Item::Job { primitives, .. } => primitives.batch.tile_range(tile).len(),
            _ => 0,
        };
        items.iter().map(of_item).sum::<usize>()
    };
    if threads < 2 {
        return (1, Vec::new());
    }
    let full: Vec<usize> = tiles
        .enumerate()
        .filter(|&(_, tile)| entries(tile) >= MIN_ENTRIES)
        .map(|(at, _)| at)
        .collect();
    let share = 2 * threads / full.len().max(1);
    if share < 2 { (1, Vec::new()) } else { (1 << share.min(TILE / BLOCK).ilog2(), full) }
}

/// The rows of a strip.
pub(crate) fn rows(strip: usize, strips: usize) -> Range<usize> {
    strip * (TILE / strips)..(strip + 1) * (TILE / strips)
}

/// Planes of a tile of its own.
pub(crate) struct TileCopy {
    color: Option<ColorCopy>,
    depth: Option<PlaneTile<f32>>,
    stencil: Option<PlaneTile<u8>>,
}

enum ColorCopy {
    /// Packed bytes.
    Rgba8(PlaneTile<u32>),
    /// Floats.
    RgbaF32(PlaneTile<[f32; 4]>),
}

impl TileCopy {
    pub(crate) fn of(planes: &TilePlanes<'_>) -> Self {
        let color = planes.color.as_ref().map(|color| match color {
            ColorTile::Rgba8(tile) => ColorCopy::Rgba8(tile.copy()),
            ColorTile::RgbaF32(tile) => ColorCopy::RgbaF32(tile.copy()),
        });
        let depth = planes.depth.as_ref().map(|(tile, _)| tile.copy());
        Self { color, depth, stencil: planes.stencil.as_ref().map(|tile| tile.copy()) }
    }

    /// The planes to draw in; scale and samples as in the tile.
    pub(crate) fn planes(&mut self, scale: f32, samples: usize) -> TilePlanes<'_> {
        let color = self.color.as_mut().map(|color| match color {
            ColorCopy::Rgba8(tile) => ColorTile::Rgba8(tile),
            ColorCopy::RgbaF32(tile) => ColorTile::RgbaF32(tile),
        });
        TilePlanes::new(
            color,
            self.depth.as_mut().map(|tile| (tile, scale)),
            self.stencil.as_mut(),
            samples,
        )
    }

    /// Brings the rows of a strip into the tile that this is a copy of.
    pub(crate) fn give_back(self, rows: &Range<usize>, planes: &mut TilePlanes<'_>) {
        let blocks = (rows.start / BLOCK..rows.end / BLOCK)
            .fold(0u64, |blocks, row| blocks | 0xff << (8 * row));
        let samples = planes.samples;
        match (self.color, &mut planes.color) {
            (Some(ColorCopy::Rgba8(from)), Some(ColorTile::Rgba8(into))) => {
                into.take(from, blocks, samples)
            }
            (Some(ColorCopy::RgbaF32(from)), Some(ColorTile::RgbaF32(into))) => {
                into.take(from, blocks, samples)
            }
            _ => {}
        }
        if let (Some(from), Some((into, _))) = (self.depth, &mut planes.depth) {
            into.take(from, blocks, samples);
        }
        if let (Some(from), Some(into)) = (self.stencil, &mut planes.stencil) {
            into.take(from, blocks, samples);
        }
    }
}
