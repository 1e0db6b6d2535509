//! Ray casting: a ray through every sample, and what it meets first.
//!
//! A structure over the world's triangles (a tree of boxes, an octree, a partition, a grid: `--acceleration`) finds those near a ray
//! without looking at the others; what is nearest comes first, and once a facet is found, whatever begins behind it is
//! passed over. The structure serves every view.
//!
//! So that the picture is that of the other algorithms sample by sample, rays only *find*; what covers a sample and how
//! near it is there is decided on the screen, by `Setup::covers` and `Setup::depth`. Corners on the screen are snapped,
//! so a facet may cover a sample whose ray misses it by a hair: rays are beams, wider than snapping and rounding can
//! move a corner (`ray_cast/eye.rs`). And the depth on the screen rounds, so a box is passed over only if it lies behind by more
//! than its facets' depths can be wrong. Facets that were culled in this view do not count, nor do boxes with nothing
//! else. Through trees the rays of 8x8 pixels go together (`packet.rs`), through a grid one by one (`single.rs`).
//!
//! In:   prepared draws (model space). Out: the samples of each tile (screen space).
//! Cost: `O(log n)` for each sample in scenes of everyday, after `O(n log n)` for the structure and `O(n)` for a view.
//! Source: [Appel 1968]; the tree after [Rubin & Whitted 1980]. Departs from them: see above.

mod eye;
mod packet;
mod single;

use super::brute_force::{each_tile, few_enough};
use super::screen_setups::{ScreenSetups, charged};
use super::{Resolved, TileSink, VisibleSurface};
use crate::marks::Marks;
use crate::raytrace::follow::StructureUser;
use crate::raytrace::structures::AnyStructure;
use crate::raytrace::triangles::Triangles;
use crate::raytrace::{Structure, Tree};
use crate::stats::VisibilityCounters;
use crate::trace::Passed;
use crate::{Coherence, Execution, PreparedView};
use eye::Eye;
use std::collections::HashSet;
use std::sync::Mutex;
use vitral_exec::Limit;
use vitral_raster::{LayerList, Setup, Tile, TileGrid};

/// Rounding of a depth on the screen, relative to the facet's range of depths and to how much of a needle it is.
const DEPTH_ROUNDING: f32 = 1.0 / (1 << 19) as f32;
/// Triangles whose places are listed at once.
const CHUNK: usize = 16384;
/// No setup: nothing of this triangle is on the screen.
const NONE: u32 = u32::MAX;

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
        let facets = u64::from(view.session.world.facet_count);
        let bytes = AnyStructure::bytes(view.acceleration, facets);
        let bytes = ScreenSetups::bytes(view) + Triangles::bytes(facets) + bytes + facets * 32;
        charged(&execution.budget, bytes, "ray casting", || {
            let job = Job { view, marks, execution, sink, start: execution.budget.elapsed() };
            AnyStructure::new(view.acceleration, view.session, execution)?.lend((job, grid))
        })
    }
}

/// What is to be done, with any structure.
struct Job<'a> {
    view: &'a PreparedView<'a>,
    marks: Option<&'a Marks>,
    execution: &'a Execution,
    sink: &'a dyn TileSink,
    /// When it began, on the budget's clock.
    start: f64,
}

/// Rays through a tree go down it in packets; other structures take them one by one.
impl StructureUser for (Job<'_>, &mut TileGrid) {
    type Outcome = Result<Resolved, Limit>;

    fn with_structure<T: Structure>(self, structure: &T) -> Self::Outcome {
        let (job, grid) = self;
        job.run(grid, structure, single::look)
    }

    fn with_tree<T: Tree>(self, tree: &T) -> Self::Outcome {
        let (job, grid) = self;
        tree.widen(&job.execution.workers);
        if job.view.coherence.has(Coherence::Area) {
            job.run(grid, tree, packet::look)
        } else {
            job.run(grid, tree, single::look)
        }
    }
}

impl Job<'_> {
    /// Sets up what is on the screen and lets `look` fill each tile.
    fn run<T: Structure>(
        &self,
        grid: &mut TileGrid,
        structure: &T,
        look: impl Fn(&Cast<'_, T>, &mut Tile, &mut LayerList) -> Result<VisibilityCounters, Limit> + Sync + Send,
    ) -> Result<Resolved, Limit> {
        let (view, execution) = (self.view, self.execution);
        let mut resolved = Resolved::default();
        let on_screen = ScreenSetups::new(view, execution, &mut resolved.geometry)?;
        let cast = Cast::new(view, execution, structure, on_screen);
        let setups = cast.on_screen.setups.len() as u64;
        let pixels = u64::from(view.viewport.width) * u64::from(view.viewport.height);
        let all = (pixels * view.pattern.len() as u64).saturating_mul(setups);
        if view.acceleration.asks_all {
            few_enough(all, "ray casting without a structure")?;
        }
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

/// A structure, what its triangles are in this view, and the eye.
struct Cast<'a, T> {
    view: &'a PreparedView<'a>,
    execution: &'a Execution,
    structure: &'a T,
    on_screen: ScreenSetups,
    /// What each triangle of the structure is on the screen.
    places: Vec<Place>,
    /// For each part how wrong the depth of an opaque facet in it may be, then the same for layers; -∞ if there is
    /// none in it. No list of layers if there are none at all.
    slack: [Vec<f32>; 2],
    largest_slack: f32,
    eye: Eye,
    /// Lists to use again.
    stamps: Mutex<Vec<Stamps>>,
}

impl<'a, T: Structure> Cast<'a, T> {
    fn new(view: &'a PreparedView<'a>, execution: &'a Execution, structure: &'a T, on_screen: ScreenSetups) -> Self {
        // Find each facet's setups, and how wrong their depths may be.
        let mut of_facet = vec![Place::NOWHERE; view.session.world.facet_count as usize];
        let mut start = 0;
        for &(end, clipped) in &on_screen.runs {
            for (i, setup) in on_screen.setups[start..end].iter().enumerate() {
                of_facet[setup.facet as usize].add((start + i) as u32, setup, clipped);
            }
            start = end;
        }
        let facets = &structure.triangles().facets;
        let mut places = vec![Place::NOWHERE; facets.len()];
        execution.workers.for_each_chunk(&mut places, CHUNK, |chunk, places| {
            for (place, &f) in places.iter_mut().zip(&facets[chunk * CHUNK..]) {
                *place = of_facet[f as usize];
            }
        });
        let opaque = on_screen.opaque as u32;
        let slack_of = |place: usize, layered: bool| {
            let place = &places[place];
            if (place.setups[0] >= opaque) == layered { place.slack } else { f32::NEG_INFINITY }
        };
        let any_layered = on_screen.opaque < on_screen.setups.len();
        let slack = [
            structure.largest(&|place| slack_of(place, false)),
            if any_layered { structure.largest(&|place| slack_of(place, true)) } else { Vec::new() },
        ];
        let largest_slack = slack.iter().flatten().copied().fold(f32::NEG_INFINITY, f32::max);
        let eye = Eye::new(view, structure.triangles());
        Self { view, execution, structure, on_screen, places, slack, largest_slack, eye, stamps: Mutex::default() }
    }

    /// A facet's setups.
    #[inline(always)]
    fn setups(&self, [first, end]: [u32; 2]) -> &[Setup] {
        &self.on_screen.setups[first as usize..end as usize]
    }

    /// Whether these are setups of a facet that becomes a layer.
    #[inline(always)]
    fn is_layered(&self, [first, _]: [u32; 2]) -> bool {
        first as usize >= self.on_screen.opaque
    }

    fn take_stamps(&self) -> Stamps {
        let spare = self.stamps.lock().expect("no thread panics while it holds stamps").pop();
        spare.unwrap_or_else(|| Stamps::new(if T::REPEATS { self.places.len() } else { 0 }))
    }

    fn give_stamps(&self, stamps: Stamps) {
        self.stamps.lock().expect("no thread panics while it holds stamps").push(stamps);
    }
}

/// Names what rays went through, each part once, and empties the list.
fn names(structure: &impl Structure, passed: &mut Vec<u32>) -> Passed {
    let mut seen = HashSet::new();
    passed.retain(|part| seen.insert(*part));
    let names = structure.names(passed);
    passed.clear();
    names
}

/// What a triangle is on the screen: little enough to be looked at before its setups are.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// The first setup and the one behind the last, or `NONE`.
    setups: [u32; 2],
    /// Left and right pixel column, top and bottom row, of the box round them.
    columns: [i16; 2],
    rows: [i16; 2],
    /// The nearest depth.
    nearest: f32,
    /// How wrong depths may be, -∞ where there are none.
    slack: f32,
}

impl Place {
    const NOWHERE: Self = Self {
        setups: [NONE; 2],
        columns: [i16::MAX, i16::MIN],
        rows: [i16::MAX, i16::MIN],
        nearest: 0.0,
        slack: f32::NEG_INFINITY,
    };

    /// Adds the setup of this number, which is the first or the one behind those before it.
    fn add(&mut self, number: u32, setup: &Setup, clipped: bool) {
        self.setups = [self.setups[0].min(number), number + 1];
        // Setups lie within the guard band, which 16 bits can hold.
        let pixel = |v: i32| (v >> 8).clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16;
        for (range, v) in [(&mut self.columns, &setup.x), (&mut self.rows, &setup.y)] {
            let (low, high) = (v[0].min(v[1]).min(v[2]), v[0].max(v[1]).max(v[2]));
            *range = [range[0].min(pixel(low)), range[1].max(pixel(high))];
        }
        self.nearest = self.nearest.max(setup.z_max);
        self.slack = self.slack.max(depth_slack(setup, clipped));
    }
}

/// Who was already asked: a structure may show a triangle to the same ray several times.
struct Stamps {
    seen: Vec<u32>,
    now: u32,
}

impl Stamps {
    fn new(count: usize) -> Self {
        Self { seen: vec![0; count], now: 0 }
    }

    /// Begins another ray.
    #[inline(always)]
    fn next(&mut self) {
        self.now = self.now.wrapping_add(1);
        if self.now == 0 {
            self.seen.fill(0);
            self.now = 1;
        }
    }

    /// Whether the triangle at `place` has not been asked since [`Self::next`].
    #[inline(always)]
    fn first_time(&mut self, place: usize) -> bool {
        std::mem::replace(&mut self.seen[place], self.now) != self.now
    }
}

/// By how much `Setup::depth` can differ from the exact interpolation of the corners' depths: rounding grows with the
/// square of the length over the area, but not beyond the range that depths are clamped to.
fn depth_slack(setup: &Setup, clipped: bool) -> f32 {
    let range = setup.z_max - setup.z_min + setup.z_max * DEPTH_ROUNDING;
    if clipped {
        return range;
    }
    let extent = |v: &[i32; 3]| (v[0].max(v[1]).max(v[2]) - v[0].min(v[1]).min(v[2])) as f32;
    let (dx, dy) = (extent(&setup.x), extent(&setup.y));
    let [x, y] = [&setup.x, &setup.y].map(|v| [v[1] - v[0], v[2] - v[0]].map(i64::from));
    let area = (x[0] * y[1] - x[1] * y[0]) as f32;
    range.min(DEPTH_ROUNDING * (range * (dx * dx + dy * dy) / area + setup.z_max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_tell_the_first_time() {
        let mut stamps = Stamps::new(2);
        stamps.now = u32::MAX - 1;
        for _ in 0..3 {
            stamps.next();
            assert!(stamps.first_time(1) && !stamps.first_time(1) && stamps.first_time(0));
        }
    }
}
