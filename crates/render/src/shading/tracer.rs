//! What follows rays on from the surfaces that a picture shows, as shading sees it.

use super::points::Points;
use super::shaded_points::ShadedPoints;
use crate::marks::MarkColors;
use vitral_raster::{Layer, Tile};

/// The first surfaces of a tile.
pub(crate) struct Front {
    /// The first surface at each sample, transparent or not.
    pub tile: Tile,
    /// Lines and points in front of them.
    pub marked: Vec<Layer>,
    /// Facets, in order, at some samples of which another is as deep.
    pub touching: Vec<u32>,
}

/// Takes over the samples that show mirrors and transparent surfaces, and finds the surfaces seen
/// in and through them.
///
/// Shading asks once for each tile. It illuminates the first surface at each sample itself.
pub(crate) trait Tracer: Sync {
    /// The first surface at each sample of a tile with layers in front of its opaque surfaces.
    fn front(&self, tile: &Tile, layers: &[Layer], marks: &MarkColors) -> Front;

    /// Adds to the points of a tile, which are illuminated, what mirrors and glass show there.
    fn follow(&self, front: &Front, points: &Points, lit: &mut ShadedPoints);

    /// One more tile is shaded, whether rays went on from it or not.
    fn tile_done(&self);
}
