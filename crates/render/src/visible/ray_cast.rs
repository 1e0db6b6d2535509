//! Ray casting: a ray through every sample, and what it meets first.
//!
//! A structure over the world's triangles (a tree of boxes, an octree, a partition, a grid:
//! `--acceleration`) finds those near a ray without looking at the others; the nearest hit comes
//! first, and once a facet is found, whatever begins behind it is passed over. The structure serves
//! every view.
//!
//! So that the picture is that of the other algorithms sample by sample, rays only *find*; what
//! covers a sample and how near it is there is decided on the screen, by `Setup::covers` and
//! `Setup::depth`. Corners on the screen are snapped, so a facet may cover a sample whose ray
//! misses it by a hair: rays are beams, wider than snapping and rounding can move a corner
//! (`ray_cast/eye.rs`). And the depth on the screen rounds, so a box is passed over only if it lies
//! behind by more than its facets' depths can be wrong. Facets that were culled in this view do not
//! count, nor do boxes with nothing else. Through trees the rays of 8x8 pixels go together
//! (`packet.rs`), through a grid one by one (`single.rs`).
//!
//! In:   prepared draws (model space). Out: the samples of each tile (screen space).
//! Cost: `O(log n)` for each sample in scenes of everyday, after `O(n log n)` for the structure and
//!       `O(n)` for a view.
//! Source: [Appel 1968]; the tree after [Rubin & Whitted 1980]. Departs from them: see above.

mod cast;
mod eye;
mod packet;
mod single;

use super::screen_setups::ScreenSetups;
use super::sink::TileSink;
use super::tiles::each_tile;
use super::{Resolved, VisibleSurface};
use crate::marks::Marks;
use crate::raytrace::follow::StructureUser;
use crate::raytrace::structures::AnyStructure;
use crate::raytrace::triangles::Triangles;
use crate::raytrace::{RayPath, Structure, Tree};
use crate::stats::{GeometryStats, VisibilityCounters};
use crate::{Coherence, Execution, PreparedView};
use cast::Cast;
use vitral_exec::Limit;
use vitral_raster::{LayerList, Tile, TileGrid};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct RayCast;

impl VisibleSurface for RayCast {
    fn resolve(
        &self,
        view: &PreparedView<'_>,
        marks: Option<&Marks>,
        grid: &mut TileGrid,
        execution: &Execution,
        sink: &dyn TileSink,
    ) -> Result<Resolved, Limit> {
        execution.budget.charged(bytes(view), "ray casting", || {
            let casting =
                RayCasting { view, marks, execution, sink, start: execution.budget.elapsed() };
            AnyStructure::new(view.acceleration, view.session, execution)?.lend((casting, grid))
        })
    }
}

/// Bytes that ray casting takes, the structure among them.
fn bytes(view: &PreparedView<'_>) -> u64 {
    let facets = u64::from(view.session.world.facet_count);
    let structure = AnyStructure::bytes(view.acceleration, facets);
    ScreenSetups::bytes(view) + Triangles::bytes(facets) + structure + facets * 32
}

/// Follows the ray through a pixel's first sample alone: what it opens of the structure of the
/// view, which is built if the session has none.
///
/// # Errors
/// A limit of the budget.
pub fn ray_path(
    view: &PreparedView<'_>,
    pixel: [u32; 2],
    execution: &Execution,
) -> Result<RayPath, Limit> {
    execution.budget.charged(bytes(view), "following a ray", || {
        let structure = AnyStructure::new(view.acceleration, view.session, execution)?;
        structure.lend(Following { view, pixel, execution })
    })
}

/// The ray that is followed alone.
struct Following<'a> {
    view: &'a PreparedView<'a>,
    pixel: [u32; 2],
    execution: &'a Execution,
}

impl StructureUser for Following<'_> {
    type Outcome = Result<RayPath, Limit>;

    fn with_structure<T: Structure>(self, structure: &T) -> Self::Outcome {
        let Self { view, pixel, execution } = self;
        let on_screen = ScreenSetups::new(view, execution, &mut GeometryStats::default())?;
        Ok(single::path(&Cast::new(view, execution, structure, on_screen), pixel))
    }

    fn with_tree<T: Tree>(self, tree: &T) -> Self::Outcome {
        tree.widen(&self.execution.workers);
        self.with_structure(tree)
    }
}

/// What is to be done, with any structure.
struct RayCasting<'a> {
    view: &'a PreparedView<'a>,
    marks: Option<&'a Marks>,
    execution: &'a Execution,
    sink: &'a dyn TileSink,
    /// When it began, on the budget's clock.
    start: f64,
}

/// Rays go down a tree in packets; other structures take them one by one.
impl StructureUser for (RayCasting<'_>, &mut TileGrid) {
    type Outcome = Result<Resolved, Limit>;

    fn with_structure<T: Structure>(self, structure: &T) -> Self::Outcome {
        let (casting, grid) = self;
        casting.run(grid, structure, single::look)
    }

    fn with_tree<T: Tree>(self, tree: &T) -> Self::Outcome {
        let (casting, grid) = self;
        tree.widen(&casting.execution.workers);
        if casting.view.coherence.has(Coherence::Area) {
            casting.run(grid, tree, packet::look)
        } else {
            casting.run(grid, tree, single::look)
        }
    }
}

impl RayCasting<'_> {
    /// Sets up what is on the screen and lets `look` fill each tile.
    fn run<T: Structure>(
        &self,
        grid: &mut TileGrid,
        structure: &T,
        look: impl Fn(&Cast<'_, T>, &mut Tile, &mut LayerList) -> Result<VisibilityCounters, Limit>
        + Sync
        + Send,
    ) -> Result<Resolved, Limit> {
        let (view, execution) = (self.view, self.execution);

        // Set up the facets on the screen.
        let mut resolved = Resolved::default();
        let on_screen = ScreenSetups::new(view, execution, &mut resolved.geometry)?;
        let cast = Cast::new(view, execution, structure, on_screen);

        // Check the work that testing all facets would take.
        let setups = cast.on_screen.setups.len() as u64;
        let pixels = u64::from(view.viewport.width) * u64::from(view.viewport.height);
        let all = (pixels * view.pattern.len() as u64).saturating_mul(setups);
        if view.acceleration.asks_all {
            execution.budget.check_work(all, "ray casting without a structure")?;
        }

        // Report the structure, then cast the rays of each tile.
        resolved.geometry_seconds = execution.budget.elapsed() - self.start;
        if let (Some(observer), Some(step)) = (&execution.observer, structure.step()) {
            observer.step(&step);
        }
        let look = |tile: &mut Tile, layers: &mut LayerList| look(&cast, tile, layers);
        resolved.counters = each_tile(view, self.marks, grid, execution, self.sink, look)?;
        resolved.counters.tests_saved = all.saturating_sub(resolved.counters.triangle_tests);
        Ok(resolved)
    }
}
