//! Which surface is seen at each sample.

mod agreement;
pub mod brute_force;
pub mod bsp;
mod cut;
mod facets;
pub mod fates;
mod front_end;
mod jobs;
mod near_first;
mod outlined;
mod overdraw;
pub mod painter;
mod passing;
mod peel;
mod pieces;
mod polygons;
mod priority_list;
pub mod ray_cast;
mod round_tiles;
pub mod scanline;
mod screen_setups;
mod sink;
mod tiles;
mod walk;
pub mod warnock;
pub mod weiler_atherton;
pub mod zbuffer;

pub(crate) use agreement::nearer;
pub(crate) use front_end::{all_batches, give_back, touching};
pub use outlined::{OutlinedPolygon, PolygonAlgorithm, PolygonList};
pub(crate) use passing::resolve_in_passing;
pub use peel::{PassLayer, Peel};
pub(crate) use sink::layer_list;
pub use sink::{NullSink, TileSink};
pub(crate) use tiles::{tile_origin, with_spare};
pub(crate) use walk::walk;

use crate::marks::Marks;
use crate::stats::{GeometryStats, VisibilityCounters};
use crate::{Execution, PreparedView};
use vitral_exec::Limit;
use vitral_raster::TileGrid;

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
    /// Fills `grid`, if `sink` keeps its tiles, and hands each finished tile to `sink`. `marks` are
    /// lines and points already on the screen, to be tested against the finished depth.
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
