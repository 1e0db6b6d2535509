//! The rays of 8x8 pixels at a time, for structures that are trees.
//!
//! Rays through neighbouring pixels go down the same branches. So they go together: a box is tested
//! once for all of them, against the pyramid that holds them; a facet that is found is tested for
//! all their samples, eight at a time. A branch is passed over once every sample of the block holds
//! something nearer. The answers are those of the rays one by one, since what covers a sample and
//! how near it is are asked as for a single ray.
//!
//! Opaque facets come first. Only then are the layers collected that lie in front of them.
//!
//! In:   a view's facets and the tree over them. Out: the samples of a tile.
//! Cost: one way down for each block and kind.
//! Source: [Wald et al. 2001]. Departs from it: 64 rays and more, and planes round them, not each
//!         ray's own slabs.

use super::cast::{Cast, ScreenTriangle, Stamps, Tests, names};
use crate::raytrace::{Probe, Structure, Tree, Visitor, Watched};
use crate::stats::VisibilityCounters;
use crate::trace::Step;
use crate::visible::tiles::{extent, size_in_picture};
use vitral_exec::Limit;
use vitral_math::lanes::{Simd, dispatch};
use vitral_raster::{
    BLOCK, InBlocks, LayerList, LayerSink, SUBPIXEL, SamplePattern, Setup, TILE, Tile,
    VisibilitySink, traverse_block,
};

/// Takes what is found in a block.
trait Taker<S> {
    /// Whether it is facets that become layers that it takes, or the opaque ones.
    const LAYERED: bool;

    fn tile(&self) -> &Tile;

    fn take(&mut self, simd: S, setup: &Setup, block: (usize, usize), pattern: &SamplePattern);
}

/// Keeps the nearest opaque facets.
struct Opaque<'a>(&'a mut Tile);

/// Collects the layers in front of the finished opaque samples.
struct Layers<'a>(&'a Tile, &'a mut LayerList);

impl<S: Simd> Taker<S> for Opaque<'_> {
    const LAYERED: bool = false;

    #[inline(always)]
    fn tile(&self) -> &Tile {
        self.0
    }

    #[inline(always)]
    fn take(&mut self, simd: S, setup: &Setup, block: (usize, usize), pattern: &SamplePattern) {
        let place = (self.0.x, self.0.y);
        let mut sink = VisibilitySink::eager(self.0, pattern);
        traverse_block(simd, setup, place, block, pattern, &mut InBlocks(&mut sink));
    }
}

impl<S: Simd> Taker<S> for Layers<'_> {
    const LAYERED: bool = true;

    #[inline(always)]
    fn tile(&self) -> &Tile {
        self.0
    }

    #[inline(always)]
    fn take(&mut self, simd: S, setup: &Setup, block: (usize, usize), pattern: &SamplePattern) {
        let place = (self.0.x, self.0.y);
        let mut sink = LayerSink::new(self.0, pattern, self.1);
        traverse_block(simd, setup, place, block, pattern, &mut InBlocks(&mut sink));
    }
}

/// The facets of a block that `taker` takes.
struct BlockSearch<'a, S, T, K> {
    simd: S,
    cast: &'a Cast<'a, T>,
    taker: K,
    /// Top left pixel within the tile.
    block: (usize, usize),
    /// The block's samples lie between these places on the screen, in 1/256 pixel.
    samples: [[i32; 2]; 2],
    stamps: &'a mut Stamps,
    tests: &'a mut Tests,
}

/// The depth of the block's farthest sample.
#[inline(always)]
fn farthest(tile: &Tile, (x, y): (usize, usize)) -> f32 {
    tile.block_far[y / BLOCK * (TILE / BLOCK) + x / BLOCK]
}

/// Whether a triangle's box on the screen touches the block, in front of depth `far`. What is
/// nowhere does not.
#[inline(always)]
fn reaches(triangle: &ScreenTriangle, tile: &Tile, (x, y): (usize, usize), far: f32) -> bool {
    let (x, y, side) = (tile.x as i32 + x as i32, tile.y as i32 + y as i32, BLOCK as i32);
    let touches = |range: [i16; 2], start: i32| {
        i32::from(range[0]) < start + side && i32::from(range[1]) >= start
    };
    touches(triangle.columns, x) & touches(triangle.rows, y) & (triangle.nearest >= far)
}

impl<S: Simd, T: Structure, K: Taker<S>> BlockSearch<'_, S, T, K> {
    #[inline(always)]
    fn is_behind(&self, near: f32, slack: f32) -> bool {
        self.cast.eye.is_behind(near, slack, farthest(self.taker.tile(), self.block))
    }
}

impl<S: Simd, T: Structure, K: Taker<S>> Visitor for BlockSearch<'_, S, T, K> {
    #[inline(always)]
    fn skips(&self, part: usize, near: f32) -> bool {
        self.is_behind(near, self.cast.slack[usize::from(K::LAYERED)][part])
    }

    #[inline(always)]
    fn done(&self, near: f32) -> bool {
        self.is_behind(near, self.cast.largest_slack)
    }

    #[inline(always)]
    fn triangle(&mut self, place: usize) {
        let tile = self.taker.tile();
        let far = farthest(tile, self.block);
        let found = &self.cast.triangles[place];
        if !reaches(found, tile, self.block, far)
            || self.cast.is_layered(found.setups) != K::LAYERED
        {
            return;
        }
        if T::REPEATS && !self.stamps.first_time(place) {
            return;
        }
        for setup in self.cast.setups(found.setups) {
            self.tests.add(setup.facet);
            // Many a box that touches the block is that of a long slanting facet, which does not.
            if !setup.reaches(self.samples) {
                continue;
            }
            self.taker.take(self.simd, setup, self.block, &self.cast.view.pattern);
        }
    }
}

/// Fills a tile, block by block.
pub(super) fn look<T: Tree>(
    cast: &Cast<'_, T>,
    tile: &mut Tile,
    layers: &mut LayerList,
) -> Result<VisibilityCounters, Limit> {
    // Prepare counters, and lists only where an observer wants them.
    let mut counters = VisibilityCounters::default();
    let (mut stamps, mut tests) = (cast.take_stamps(), Tests::new(cast.execution));
    let mut passed = cast.execution.observer.is_some().then(Vec::new);
    let (rows, columns) = size_in_picture(cast.view, tile);

    // Cast the rays of each block together.
    for y in (0..rows).step_by(BLOCK) {
        cast.execution.budget.check("ray casting")?;
        for x in (0..columns).step_by(BLOCK) {
            let pixels = (rows - y).min(BLOCK) * (columns - x).min(BLOCK);
            let rays = (pixels * cast.view.pattern.len()) as u64;
            let before = tests.count;
            let noted = Noted { stamps: &mut stamps, tests: &mut tests, passed: passed.as_mut() };
            let boxes = dispatch!(cast.execution.level, simd =>
                look_at_block(simd, cast, tile, (x, y), layers, noted));
            // Count, and report the block.
            let facets = tests.count - before;
            counters.rays += rays;
            counters.saved_by_area += rays - 1;
            counters.box_tests += boxes;
            if let Some(passed) = &mut passed {
                let size = [columns - x, rows - y].map(|s| s.min(BLOCK) as u32);
                let pixels = [tile.x + x as u32, tile.y + y as u32, size[0], size[1]];
                let through = names(cast.structure, passed);
                let tested = tests.take();
                cast.execution.report(|| Step::Rays {
                    pixels,
                    rays,
                    boxes,
                    facets,
                    tested,
                    through,
                });
            }
            counters.triangle_tests += facets * rays;
        }
    }
    cast.give_stamps(stamps);
    Ok(counters)
}

/// What a search notes on its way.
struct Noted<'a> {
    stamps: &'a mut Stamps,
    tests: &'a mut Tests,
    /// The parts of the structure gone through.
    passed: Option<&'a mut Vec<u32>>,
}

/// Fills a block: how many boxes were tested.
#[inline(always)]
fn look_at_block<S: Simd, T: Tree>(
    simd: S,
    cast: &Cast<'_, T>,
    tile: &mut Tile,
    block: (usize, usize),
    layers: &mut LayerList,
    noted: Noted<'_>,
) -> u64 {
    let Noted { stamps, tests, mut passed } = noted;

    // The pyramid round the block's samples.
    let offsets = extent(&cast.view.pattern);
    let corner = [tile.x as i32 + block.0 as i32, tile.y as i32 + block.1 as i32];
    let low = [0, 1].map(|k| corner[k] * SUBPIXEL + offsets[k][0]);
    let high = [0, 1].map(|k| (corner[k] + BLOCK as i32 - 1) * SUBPIXEL + offsets[k][1]);
    let pyramid = cast.eye.pyramid(simd, low, high);

    stamps.next();
    let samples = [low, high];
    let mut opaque = BlockSearch {
        simd,
        cast,
        taker: Opaque(tile),
        block,
        samples,
        stamps: &mut *stamps,
        tests: &mut *tests,
    };
    let mut boxes = descend(cast.structure, &pyramid, &mut opaque, passed.as_deref_mut());
    if !cast.slack[1].is_empty() {
        stamps.next();
        let mut visitor =
            BlockSearch { simd, cast, taker: Layers(tile, layers), block, samples, stamps, tests };
        boxes += descend(cast.structure, &pyramid, &mut visitor, passed);
    }
    boxes
}

/// [`Tree::descend`], with the parts gone through if somebody wants to know.
#[inline(always)]
fn descend(
    tree: &impl Tree,
    probe: &impl Probe,
    visitor: &mut impl Visitor,
    passed: Option<&mut Vec<u32>>,
) -> u64 {
    match passed {
        None => tree.descend(probe, visitor),
        Some(passed) => tree.descend(probe, &mut Watched { visitor, passed }),
    }
}
