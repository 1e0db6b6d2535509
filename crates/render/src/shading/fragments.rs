//! Fragments with their colours, ready to be laid over a pixel.

use super::FrameConstants;
use super::points::{FragmentPoint, Points};
use super::shaded_points::ShadedPoints;
use crate::marks::MarkColors;
use crate::transparency::Fragment;
use vitral_math::Vec2;
use vitral_raster::{TILE, Tile};

/// A fragment of a tile with its colour.
pub(super) fn fragment<'a>(
    f: &FragmentPoint,
    tile: &Tile,
    points: &'a Points,
    lit: &ShadedPoints,
    constants: &FrameConstants<'_>,
    marks: &MarkColors,
) -> Fragment<'a> {
    let (start, source) = (f.start as usize, f.source as usize);
    let color = if f.is_mark {
        let (x, y) = (tile.x + f.pixel % TILE as u32, tile.y + f.pixel / TILE as u32);
        marks.color(source, Vec2::new(x as f32, y as f32), constants.background.colors[y as usize])
    } else {
        lit.colors[source]
    };
    let passes = match lit.passes.get(source) {
        Some(passes) if !f.is_mark => *passes,
        _ => [1.0 - color[3]; 3],
    };
    let depths = &points.depths[start..start + f.count as usize];
    let FragmentPoint { facet, mask, far, near, .. } = *f;
    Fragment { facet, mask, depths, far, near, color, passes, behind: None }
}
