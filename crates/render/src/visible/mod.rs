//! Which surface is seen at each sample.

pub mod brute_force;
pub mod bsp;
mod cut;
mod facets;
mod near_first;
pub mod painter;
mod peel;
mod pieces;
pub mod ray_cast;
pub mod scanline;
mod screen_setups;
pub mod warnock;
pub mod weiler_atherton;
pub mod zbuffer;

pub(crate) use brute_force::few_enough;
pub(crate) use facets::nearer;
pub use peel::{PassLayer, Peel};
pub(crate) use screen_setups::charged;

use crate::marks::Marks;
use crate::stats::{GeometryStats, VisibilityCounters};
use crate::{Execution, PreparedView};
use vitral_exec::Limit;
use vitral_raster::{LayerList, Tile, TileGrid};

/// Takes tiles as they are finished, from any thread, each once.
pub trait TileSink: Sync {
    /// `layers` are the transparent facets in front of the tile's opaque samples, in no particular order.
    fn tile(&self, index: usize, tile: &Tile, layers: &mut LayerList);

    /// Whether the grid's tiles are wanted when all have been handed on. If not, algorithms may fill each in memory that the next one
    /// uses again.
    fn keeps_tiles(&self) -> bool {
        true
    }

    /// Whether it takes layers as [`LayerList::fragments`] from algorithms that find them so.
    fn takes_fragments(&self) -> bool {
        false
    }

    /// Whether it asks for layers pass by pass. Algorithms that find all layers of a sample at once (rays) hand on all.
    fn takes_passes(&self) -> bool {
        false
    }

    /// [`Self::tile`] for those that do: `pass` goes through all layers again, as long as it finds some.
    fn tile_in_passes(&self, _: usize, _: &Tile, _: &mut dyn FnMut(&mut Peel) -> bool) {}
}

/// Takes tiles and does nothing with them.
#[derive(Clone, Copy, Debug)]
pub struct Nowhere;

impl TileSink for Nowhere {
    fn tile(&self, _: usize, _: &Tile, _: &mut LayerList) {}
}

/// What an algorithm did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resolved {
    /// Triangles on their way to the screen.
    pub geometry: GeometryStats,
    /// Seconds of the budget's clock spent on that, the rest went into the tiles.
    pub geometry_seconds: f64,
    /// What finding the visible surfaces took.
    pub counters: VisibilityCounters,
}

/// An algorithm that finds the visible surface at each sample.
pub trait VisibleSurface: Sync {
    /// Fills `grid`, if `sink` keeps its tiles, and hands each finished tile to `sink`. `marks` are lines and points already on the screen, to be
    /// tested against the finished depth.
    ///
    /// # Errors
    /// A limit of the budget.
    fn resolve(
        &self,
        view: &PreparedView<'_>,
        marks: Option<&Marks>,
        grid: &mut TileGrid,
        execution: &Execution,
        sink: &dyn TileSink,
    ) -> Result<Resolved, Limit>;
}
