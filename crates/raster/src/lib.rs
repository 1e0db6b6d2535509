//! Floor 2: triangles to samples. Clip, project, snap, set up, bin, and walk the tiles.
//!
//! A picture is cut into tiles of 64x64 pixels, each owned by one worker at a time. [`geometry`]
//! turns triangles into [`Setup`]s (snapped corners, a depth plane) and sorts them into the tiles
//! they touch; [`traverse_by_rows`] walks a tile's triangles, makes their integer edge functions,
//! and hands rows of eight pixels with their coverage masks to a [`RowSink`], which decides what a
//! covered sample means: [`VisibilitySink`] keeps the nearest facet, [`LayerSink`] collects every
//! facet in front of it, [`FragmentSink`] likewise, pixel by pixel. Triangles that are at most eight
//! pixels wide go row by row, wherever the rows begin: of a fine mesh, most are. Larger ones are cut
//! into blocks of 8x8 pixels. [`NearestDepths`] keeps depths alone, for shadow maps. OpenGL walks by
//! [`traverse_window`], which hands blocks to a [`BlockSink`].
//!
//! Coverage is decided in integers on corners snapped to 1/256 pixel, with the top-left rule: two
//! triangles that share an edge cover each sample along it exactly once. Depth is `1` at the near
//! plane and `0` at the far plane; the larger wins, and of equal depths the lower facet. So neither
//! the order of triangles nor the number of threads nor the instruction set can change a picture.
#![forbid(unsafe_code)]

pub mod clip;
#[cfg(feature = "forward")]
pub mod forward;
mod fragments;
pub mod geometry;
mod integer_depth;
mod kernel;
mod layers;
mod samples;
mod screen;
mod setup;
mod sink;
#[cfg(test)]
mod testing;
mod tile;

pub use fragments::FragmentSink;
pub use geometry::{BackFaces, Batch, Draw, GeometryCounters, TileLists, Unsorted};
pub use integer_depth::IntegerDepth;
pub use kernel::block::{Block, BlockSink, InBlocks, RowSink};
pub use kernel::nearest::NearestDepths;
pub use kernel::plane::RowPlane;
pub use kernel::transform::transform;
pub use kernel::traverse::{Window, traverse, traverse_block, traverse_by_rows, traverse_window};
pub use layers::{Fragment, Layer, LayerList};
pub use samples::SamplePattern;
pub use screen::ScreenVertex;
pub use setup::{CornerPosition, Setup, SharedPlane, snap};
pub use sink::{LayerSink, NEAR_TIE, PriorityCounts, PrioritySink, VisibilitySink};
pub use tile::{Tile, TileGrid, Viewport};

/// Pixels along a tile's side.
pub const TILE: usize = 64;
/// Pixels along a block's side.
pub const BLOCK: usize = 8;
/// Pixels in a tile.
pub const TILE_PIXELS: usize = TILE * TILE;
/// Positions are snapped to `1 / SUBPIXEL` pixel.
pub const SUBPIXEL: i32 = 256;
/// The facet that no triangle has: background.
pub const NO_FACET: u32 = u32::MAX;
/// Screen coordinates stay within this many pixels of the viewport's centre: farther triangles are
/// clipped, so that edge functions fit in 32 bits inside a tile.
pub const GUARD_BAND: f32 = 16384.0;
/// Largest width and height of a viewport.
pub const MAX_SIDE: u32 = 16384;
