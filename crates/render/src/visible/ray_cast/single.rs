//! One ray at a time, for structures that are walked rather than gone down: the grid, and the mere
//! list.
//!
//! Each sample has its beam. The facet that the last ray met is tried first: most often this one
//! meets it, too, and then whatever lies behind it need not be looked at.
//!
//! In:   a view's facets and the structure over them. Out: the samples of a tile.
//! Cost: one walk a sample.
//! Source: [Appel 1968].

use super::cast::{Cast, NONE, Stamps, Tests, names};
use crate::Coherence;
use crate::raytrace::{RayPath, Structure, Visitor, Watched};
use crate::stats::VisibilityCounters;
use crate::trace::Step;
use crate::visible::agreement::nearer;
use crate::visible::tiles::size_in_picture;
use vitral_exec::Limit;
use vitral_raster::{Layer, LayerList, NO_FACET, SUBPIXEL, TILE, TILE_PIXELS, Tile};

/// Depth and facet where nothing is.
const BACKGROUND: (f32, u32) = (0.0, NO_FACET);

/// What the ray through one sample has met.
struct RaySearch<'a, T> {
    cast: &'a Cast<'a, T>,
    sample: [i32; 2],
    /// Depth and facet of the nearest opaque facet, and the setups of it.
    nearest: (f32, u32),
    setups: [u32; 2],
    /// Transparent facets, some of them hidden.
    layers: Vec<(f32, u32)>,
    stamps: Stamps,
    tests: Tests,
}

impl<'a, T: Structure> RaySearch<'a, T> {
    /// Nothing met yet.
    fn new(cast: &'a Cast<'a, T>) -> Self {
        Self {
            cast,
            sample: [0; 2],
            nearest: BACKGROUND,
            setups: [NONE; 2],
            layers: Vec::new(),
            stamps: cast.take_stamps(),
            tests: Tests::new(cast.execution),
        }
    }

    /// Follows the ray through a sample of a tile's pixel; notes the parts it went through in
    /// `passed`.
    #[inline]
    fn follow(
        &mut self,
        tile: &Tile,
        [column, row]: [usize; 2],
        sample: usize,
        passed: Option<&mut Vec<u32>>,
        counters: &mut VisibilityCounters,
    ) {
        let cast = self.cast;
        let [sx, sy] = cast.view.pattern.position(sample);
        let x = (tile.x as i32 + column as i32) * SUBPIXEL + sx;
        let y = (tile.y as i32 + row as i32) * SUBPIXEL + sy;
        (self.sample, self.nearest) = ([x, y], BACKGROUND);
        self.stamps.next();

        // Try what the last ray met, then follow the beam.
        let last = std::mem::replace(&mut self.setups, [NONE; 2]);
        if last[0] != NONE && cast.view.coherence.has(Coherence::Area) {
            self.test(last);
            counters.saved_by_area += u64::from(self.setups[0] != NONE);
        }
        let beam = cast.eye.beam(x, y);
        counters.box_tests += match passed {
            None => cast.structure.traverse(&beam, self),
            Some(passed) => cast.structure.traverse(&beam, &mut Watched { visitor: self, passed }),
        };
        counters.rays += 1;
    }

    /// Asks the law of agreement about the facet of these setups.
    #[inline]
    fn test(&mut self, setups: [u32; 2]) {
        let [x, y] = self.sample;
        // Skip setups that are farther or do not cover the sample.
        for setup in self.cast.setups(setups) {
            self.tests.add(setup.facet);
            if setup.z_max < self.nearest.0 || !setup.covers(x, y) {
                continue;
            }

            // Keep a nearer one: as a layer if it is transparent.
            let candidate = (setup.depth(x, y), setup.facet);
            if nearer(candidate, self.nearest) {
                if self.cast.is_layered(setups) {
                    self.layers.push(candidate);
                } else {
                    (self.nearest, self.setups) = (candidate, setups);
                }
            }
        }
    }
}

impl<T: Structure> Visitor for RaySearch<'_, T> {
    #[inline]
    fn skips(&self, part: usize, near: f32) -> bool {
        let [opaque, layered] = &self.cast.slack;
        let slack = if layered.is_empty() { opaque[part] } else { opaque[part].max(layered[part]) };
        self.cast.eye.is_behind(self.cast.eye.start() + near, slack, self.nearest.0)
    }

    #[inline]
    fn done(&self, near: f32) -> bool {
        self.cast.eye.is_behind(
            self.cast.eye.start() + near,
            self.cast.largest_slack,
            self.nearest.0,
        )
    }

    #[inline]
    fn triangle(&mut self, place: usize) {
        let setups = self.cast.triangles[place].setups;
        if setups[0] != NONE && (!T::REPEATS || self.stamps.first_time(place)) {
            self.test(setups);
        }
    }
}

/// Follows the ray through a pixel's first sample, from the eye to the nearest opaque facet, with no
/// hint of what its neighbours met: the way it took, and the nearest facet, a layer or not.
pub(super) fn path<T: Structure>(cast: &Cast<'_, T>, pixel: [u32; 2]) -> RayPath {
    let offset = cast.view.pattern.position(0);
    let [x, y] = [0, 1].map(|k: usize| pixel[k] as i32 * SUBPIXEL + offset[k]);
    let mut search = RaySearch::new(cast);
    search.sample = [x, y];
    search.stamps.next();
    let [origin, direction] = cast.eye.ray(x, y);
    let ray = [origin + cast.structure.triangles().center, direction];
    let mut path = RayPath::follow(cast.structure, ray, &cast.eye.beam(x, y), &mut search);

    // Find the nearest among the opaque facet and the layers.
    let opaque = search.nearest;
    let nearest = search.layers.drain(..).fold(opaque, |a, b| if nearer(b, a) { b } else { a });
    if nearest.1 != NO_FACET {
        path.hit = Some((nearest.1, cast.eye.distance(nearest.0) * direction.length()));
    }
    cast.give_stamps(search.stamps);
    path
}

/// Fills a tile, a ray for each sample.
pub(super) fn look<T: Structure>(
    cast: &Cast<'_, T>,
    tile: &mut Tile,
    layers: &mut LayerList,
) -> Result<VisibilityCounters, Limit> {
    // Prepare the search, whose memory serves all rays of the tile.
    let mut counters = VisibilityCounters::default();
    let mut search = RaySearch::new(cast);
    let mut passed = cast.execution.observer.is_some().then(Vec::new);
    let (rows, columns) = size_in_picture(cast.view, tile);

    // Follow one ray for each sample.
    for row in 0..rows {
        cast.execution.budget.check("ray casting")?;
        for column in 0..columns {
            let before_pixel = (counters.box_tests, search.tests.count);
            let samples = cast.view.pattern.len();
            for sample in 0..samples {
                search.follow(tile, [column, row], sample, passed.as_mut(), &mut counters);

                // Keep the nearest, and the layers in front of it.
                let at = sample * TILE_PIXELS + row * TILE + column;
                (tile.depth[at], tile.facet[at]) = search.nearest;
                tile.touched |= search.nearest.1 != NO_FACET;
                let nearest = search.nearest;
                let seen = search.layers.drain(..).filter(|c| nearer(*c, nearest));
                seen.for_each(|(depth, facet)| layers.push(Layer { at: at as u32, depth, facet }));
            }
            // Report the pixel.
            if let Some(passed) = &mut passed {
                let (rays, boxes) = (samples as u64, counters.box_tests - before_pixel.0);
                let (facets, through) =
                    (search.tests.count - before_pixel.1, names(cast.structure, passed));
                let pixels = [tile.x + column as u32, tile.y + row as u32, 1, 1];
                let tested = search.tests.take();
                cast.execution.report(|| Step::Rays {
                    pixels,
                    rays,
                    boxes,
                    facets,
                    tested,
                    through,
                });
            }
        }
    }
    counters.triangle_tests = search.tests.count;
    cast.give_stamps(search.stamps);
    Ok(counters)
}
