//! Warnock's area subdivision: what is simple in a window is drawn, the rest is looked at in four smaller windows.
//!
//! A polygon is to a window one of four things: disjoint, contained, intersecting, or surrounding it. Four cases are
//! simple. All polygons are disjoint: the window stays empty. One polygon is left, contained or intersecting: it is
//! drawn into the window. One polygon is left, and surrounds: it fills the window. Several are left, but one that
//! surrounds is nearer than all others at the window's four corners, hence everywhere in it: it fills the window.
//! Everything else is put off: the window is cut in four. Disjoint polygons and those behind a surrounder are not
//! handed down, so lists become shorter; surrounders stay surrounders and need no further test. A window of one pixel
//! is not cut: the nearest facet at each of the pixel's samples is taken.
//!
//! In:   set-up triangles, joined to polygons (screen space). Out: the samples of each tile (screen space).
//! Cost: windows (about the length of visible edges in pixels) times the polygons in them.
//! Source: [Warnock 1969]. Departs from it: the first cuts are those of the picture into tiles of 64x64 pixels, whose
//! lists of polygons there are already; a window's corners are those of the box round its samples. The four-corner test
//! leaves a margin for rounding and reckons with the clamping of depths, so that it never decides but what the facets'
//! depth function would; two facets with one depth plane are decided by their ids.

use super::agreement::nearer;
use super::facets::{Facets, fill_tiles};
use super::polygons::{ConvexPolygon, Polygons, same_plane};
use super::sink::TileSink;
use super::tiles::{extent, put};
use super::{Resolved, VisibleSurface};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::trace::{Step, WindowVerdict};
use crate::{Coherence, CoherenceSet, Execution, PreparedView};
use std::cmp::Ordering;
use std::ops::Range;
use vitral_exec::Limit;
use vitral_raster::{SUBPIXEL, SamplePattern, Setup, TILE, TILE_PIXELS, Tile, TileGrid};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct Warnock;

impl VisibleSurface for Warnock {
    fn resolve(
        &self,
        view: &PreparedView<'_>,
        marks: Option<&Marks>,
        grid: &mut TileGrid,
        execution: &Execution,
        sink: &dyn TileSink,
    ) -> Result<Resolved, Limit> {
        fill_tiles(view, marks, grid, execution, sink, 1, &|facets, index, tiles, counters| {
            let polygons = Polygons::new(facets.in_tile(index), facets.view());
            let mut subdivision = Subdivision::new(facets, &polygons, &mut tiles[0], counters);
            let bytes = polygons.bytes() + (polygons.len() * BYTES_A_POLYGON) as u64;
            let budget = &facets.execution().budget;
            budget.charge(bytes, "area subdivision")?;
            let all = 0..subdivision.stack.len();
            let done = subdivision.window(Window { x: 0, y: 0, side: TILE }, all);
            budget.release(bytes);
            done
        })
    }
}

/// A square of pixels of the tile.
#[derive(Clone, Copy, Debug)]
struct Window {
    x: usize,
    y: usize,
    side: usize,
}

/// The box round a window's samples in the picture, ends included, 1/256 pixel.
#[derive(Clone, Copy, Debug)]
struct SampleBox {
    x: [i32; 2],
    y: [i32; 2],
}

/// What a polygon is to a window. Contained polygons are treated like intersecting ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Relation {
    Disjoint,
    ContainedOrIntersecting,
    Surrounding,
}

/// A polygon on a window's list.
#[derive(Clone, Copy)]
struct Entry {
    polygon: u32,
    surrounds: bool,
}

/// A polygon's entries on the lists of windows that are being looked at.
const BYTES_A_POLYGON: usize = 7 * size_of::<Entry>();

/// The subdivision of one tile.
struct Subdivision<'t, 'f> {
    execution: &'f Execution,
    coherence: CoherenceSet,
    pattern: &'f SamplePattern,
    /// Place of the samples within a pixel.
    extent: [[i32; 2]; 2],
    /// The tile's pixels inside the picture.
    size: [usize; 2],
    polygons: &'f Polygons<'f>,
    /// Lists of the windows from the tile down to the present one, one after the other.
    stack: Vec<Entry>,
    tile: &'t mut Tile,
    counters: &'t mut VisibilityCounters,
}

impl<'t, 'f> Subdivision<'t, 'f> {
    fn new(
        facets: &'f Facets<'_, '_>,
        polygons: &'f Polygons<'f>,
        tile: &'t mut Tile,
        counters: &'t mut VisibilityCounters,
    ) -> Self {
        let view = facets.view();
        let stack = (0..polygons.len() as u32).map(|polygon| Entry { polygon, surrounds: false }).collect();
        let size = [view.viewport.width - tile.x, view.viewport.height - tile.y].map(|s| TILE.min(s as usize));
        let (pattern, extent) = (&view.pattern, extent(&view.pattern));
        let (execution, coherence) = (facets.execution(), view.coherence);
        Self { execution, coherence, pattern, extent, size, polygons, stack, tile, counters }
    }

    /// Draws what is seen in a window, of the polygons at `list` on the stack.
    fn window(&mut self, window: Window, list: Range<usize>) -> Result<(), Limit> {
        if window.x >= self.size[0] || window.y >= self.size[1] {
            return Ok(());
        }
        self.counters.windows += 1;
        if self.counters.windows % 1024 == 1 {
            self.execution.budget.check("area subdivision")?;
        }

        // Put the window's own list on the stack: what is not disjoint, and not behind a surrounder.
        let samples = self.sample_box(window);
        let start = self.stack.len();
        self.classify(samples, list);
        if self.coherence.has(Coherence::Depth) {
            self.drop_hidden(samples, start);
        }
        self.execution.tell(|| self.step(window, &self.stack[start..]));

        // Draw the simple cases; cut the window otherwise.
        let result = match &self.stack[start..] {
            [] => Ok(()),
            &[only] => {
                self.draw(window, only);
                Ok(())
            }
            _ if window.side == 1 => {
                self.draw_nearest(window, start);
                Ok(())
            }
            _ => {
                let (own, side) = (start..self.stack.len(), window.side / 2);
                let quarters = [(0, 0), (side, 0), (0, side), (side, side)];
                quarters.into_iter().try_for_each(|(dx, dy)| {
                    self.window(Window { x: window.x + dx, y: window.y + dy, side }, own.clone())
                })
            }
        };
        self.stack.truncate(start);
        result
    }

    /// The step of a window with this list.
    fn step(&self, window: Window, list: &[Entry]) -> Step {
        let (columns, rows) = self.pixels(window);
        let pixels = [
            self.tile.x + columns.start as u32,
            self.tile.y + rows.start as u32,
            columns.len() as u32,
            rows.len() as u32,
        ];
        let (verdict, drawn) = match list {
            [] => (WindowVerdict::Empty, None),
            [only] if only.surrounds => (WindowVerdict::Surrounded, Some(only)),
            [only] => (WindowVerdict::One, Some(only)),
            _ if window.side == 1 => (WindowVerdict::Pixel, None),
            _ => (WindowVerdict::Cut, None),
        };
        let facet = drawn.map(|entry| self.polygons.get(entry.polygon as usize).facet());
        Step::Window { pixels, polygons: list.len() as u32, verdict, facet }
    }

    fn sample_box(&self, window: Window) -> SampleBox {
        let (tile_x, tile_y) = (self.tile.x as usize, self.tile.y as usize);
        let ends = |tile: usize, first: usize, size: usize, [low, high]: [i32; 2]| {
            let last = (first + window.side).min(size) - 1;
            [(tile + first) as i32 * SUBPIXEL + low, (tile + last) as i32 * SUBPIXEL + high]
        };
        let [across, down] = self.extent;
        SampleBox { x: ends(tile_x, window.x, self.size[0], across), y: ends(tile_y, window.y, self.size[1], down) }
    }

    /// Pushes the polygons of `list` that are not disjoint. Surrounders stay surrounders.
    fn classify(&mut self, samples: SampleBox, list: Range<usize>) {
        for i in list {
            let mut entry = self.stack[i];
            if entry.surrounds && self.coherence.has(Coherence::Area) {
                self.counters.saved_by_area += 1;
            } else {
                self.counters.window_tests += 1;
                match relation(self.polygons.get(entry.polygon as usize).outline(), samples) {
                    Relation::Disjoint => continue,
                    Relation::ContainedOrIntersecting => {}
                    Relation::Surrounding => entry.surrounds = true,
                }
            }
            self.stack.push(entry);
        }
    }

    /// Drops from the list that begins at `start` what the nearest surrounder hides at all four corners.
    fn drop_hidden(&mut self, samples: SampleBox, start: usize) {
        if self.stack.len() - start < 2 {
            return;
        }
        let surrounders = self.stack[start..].iter().filter(|e| e.surrounds).map(|e| e.polygon);
        let farthest = |p: u32| {
            let [near, far] = [f32::max, f32::min].map(|pick| {
                let depths = corners(samples).map(|[x, y]| self.polygons.get(p as usize).depth(x, y));
                depths.into_iter().reduce(pick).unwrap_or(0.0)
            });
            (far, near, p)
        };
        let front = surrounders.map(farthest).reduce(|a, b| match (b.0, b.1).partial_cmp(&(a.0, a.1)) {
            Some(Ordering::Greater) => b,
            Some(Ordering::Equal)
                if self.polygons.get(b.2 as usize).facet() < self.polygons.get(a.2 as usize).facet() =>
            {
                b
            }
            _ => a,
        });
        let Some((_, _, front)) = front else { return };
        let (polygons, counters) = (self.polygons, &mut *self.counters);
        let plane = CornerDepths::new(polygons.get(front as usize).plane(), samples);
        let mut kept = start;
        for i in start..self.stack.len() {
            let entry = self.stack[i];
            let hidden = entry.polygon != front && {
                counters.depth_comparisons += 1;
                plane.hides(&CornerDepths::new(polygons.get(entry.polygon as usize).plane(), samples))
            };
            if !hidden {
                self.stack[kept] = entry;
                kept += 1;
            }
        }
        self.counters.saved_by_depth += (self.stack.len() - kept) as u64;
        self.stack.truncate(kept);
    }

    /// Fills a window with a surrounder, or draws the one polygon in it.
    fn draw(&mut self, window: Window, entry: Entry) {
        let polygon = self.polygons.get(entry.polygon as usize);
        let (columns, rows) = self.pixels(window);
        for s in 0..self.pattern.len() {
            for row in rows.clone() {
                for column in columns.clone() {
                    let [x, y] = self.sample(column, row, s);
                    if let Some(facet) = facet_at(polygon, entry.surrounds, [x, y]) {
                        put(self.tile, s * TILE_PIXELS + row * TILE + column, (polygon.depth(x, y), facet));
                    }
                }
            }
        }
    }

    /// Takes the nearest facet at each sample of a window of one pixel.
    fn draw_nearest(&mut self, window: Window, start: usize) {
        self.counters.pixel_windows += 1;
        for s in 0..self.pattern.len() {
            let [x, y] = self.sample(window.x, window.y, s);
            let mut seen: Option<(f32, u32)> = None;
            for entry in &self.stack[start..] {
                let polygon = self.polygons.get(entry.polygon as usize);
                let Some(facet) = facet_at(polygon, entry.surrounds, [x, y]) else { continue };
                let candidate = (polygon.depth(x, y), facet);
                self.counters.depth_comparisons += u64::from(seen.is_some());
                if seen.is_none_or(|seen| nearer(candidate, seen)) {
                    seen = Some(candidate);
                }
            }
            if let Some(seen) = seen {
                put(self.tile, s * TILE_PIXELS + window.y * TILE + window.x, seen);
            }
        }
    }

    /// Columns and rows of the window's pixels that are in the picture.
    fn pixels(&self, window: Window) -> (Range<usize>, Range<usize>) {
        let ends = |first: usize, size: usize| first..(first + window.side).min(size);
        (ends(window.x, self.size[0]), ends(window.y, self.size[1]))
    }

    /// Where sample `s` of one of the tile's pixels lies in the picture.
    fn sample(&self, column: usize, row: usize, s: usize) -> [i32; 2] {
        let [x, y] = self.pattern.position(s);
        let place = |tile: u32, pixel: usize, offset: i32| (tile as i32 + pixel as i32) * SUBPIXEL + offset;
        [place(self.tile.x, column, x), place(self.tile.y, row, y)]
    }
}

/// The facet of a polygon at a sample, if it covers it, as a surrounder does.
fn facet_at(polygon: ConvexPolygon<'_, '_>, surrounds: bool, [x, y]: [i32; 2]) -> Option<u32> {
    if surrounds { Some(polygon.facet_within(x, y)) } else { polygon.facet_at(x, y) }
}

fn corners(samples: SampleBox) -> [[i32; 2]; 4] {
    let ([x0, x1], [y0, y1]) = (samples.x, samples.y);
    [[x0, y0], [x1, y0], [x0, y1], [x1, y1]]
}

/// Tests a polygon, given by its outline, against the box round a window's samples: one of the box's sides or of the
/// outline's edges has the other on its outer side, if they are disjoint.
fn relation(outline: &[[i32; 2]], samples: SampleBox) -> Relation {
    let outside =
        |k: usize, [low, high]: [i32; 2]| outline.iter().all(|v| v[k] < low) || outline.iter().all(|v| v[k] > high);
    if outside(0, samples.x) || outside(1, samples.y) {
        return Relation::Disjoint;
    }
    // An edge function is largest and smallest at two corners of the box.
    let mut surrounds = true;
    for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
        let (dx, dy) = (i64::from(b[0] - a[0]), i64::from(b[1] - a[1]));
        // Positive inside, y downwards: left edges go up, top edges go right; on these, 0 is inside.
        let inside = if dy < 0 || (dy == 0 && dx > 0) { 0 } else { 1 };
        let down = samples.y.map(|y| dx * i64::from(y - a[1]));
        let across = samples.x.map(|x| -dy * i64::from(x - a[0]));
        if down[0].max(down[1]) + across[0].max(across[1]) < inside {
            return Relation::Disjoint;
        }
        surrounds &= down[0].min(down[1]) + across[0].min(across[1]) >= inside;
    }
    if surrounds { Relation::Surrounding } else { Relation::ContainedOrIntersecting }
}

/// A facet's plane at the four corners of a window.
struct CornerDepths<'f> {
    setup: &'f Setup,
    /// The plane's depths, not clamped to the facet's.
    depths: [f64; 4],
    /// How far [`Setup::depth`] may be from the plane at most, by rounding.
    margin: f64,
}

impl<'f> CornerDepths<'f> {
    fn new(setup: &'f Setup, samples: SampleBox) -> Self {
        let mut margin = 0.0f64;
        let depths = corners(samples).map(|[x, y]| {
            let offset = |v: i32, k: usize| f64::from(v - setup.origin[k]) / f64::from(SUBPIXEL);
            let (across, down) = (offset(x, 0) * f64::from(setup.dz_dx), offset(y, 1) * f64::from(setup.dz_dy));
            // Four roundings to 24 bits, of numbers no larger than the sum.
            let rounding = (f64::from(setup.z.abs()) + across.abs() + down.abs()) * f64::from(f32::EPSILON) * 4.0;
            // f64::max would swallow the NaN of a plane that overflows.
            margin = if rounding <= margin { margin } else { rounding };
            f64::from(setup.z) + across + down
        });
        Self { setup, depths, margin }
    }

    /// Whether this facet is what is seen of the two at each sample of the window that both cover. The planes' distance
    /// is linear, so smallest at a corner; depths are clamped, so neither plane may leave the other facet's range on
    /// the wrong side.
    fn hides(&self, other: &Self) -> bool {
        let (near, far) = (self.setup, other.setup);
        if near.z_min > far.z_max {
            return true;
        }
        if same_plane(near, far) {
            return near.facet < far.facet;
        }
        let margin = self.margin + other.margin;
        near.z_max > far.z_min
            && (0..4).all(|i| {
                let (a, b) = (self.depths[i], other.depths[i]);
                a - b > margin && a - margin > f64::from(far.z_min) && b + margin < f64::from(near.z_max)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_raster::CornerPosition;

    fn triangle(corners: [[i32; 2]; 3], z: [f32; 3], facet: u32) -> Setup {
        let [a, b, c] = [0, 1, 2].map(|i| CornerPosition { x: corners[i][0], y: corners[i][1], z: z[i] });
        Setup::new([a, b, c], Setup::doubled_area(a, b, c), facet)
    }

    const WINDOW: SampleBox = SampleBox { x: [128, 1920], y: [128, 1920] };

    #[test]
    fn p20_the_relations_of_a_polygon_to_a_window() {
        let relation = |corners| {
            let setup = triangle(corners, [0.5; 3], 0);
            relation(&[0, 1, 2].map(|i| [setup.x[i], setup.y[i]]), WINDOW)
        };
        assert_eq!(relation([[3000, 0], [4000, 0], [3000, 900]]), Relation::Disjoint);
        // Its box overlaps the window, but an edge has the window on its outer side.
        assert_eq!(relation([[4000, 0], [4000, 4000], [0, 4000]]), Relation::Disjoint);
        assert_eq!(relation([[300, 300], [900, 300], [300, 900]]), Relation::ContainedOrIntersecting);
        assert_eq!(relation([[-300, 300], [900, 300], [300, 900]]), Relation::ContainedOrIntersecting);
        assert_eq!(relation([[-300, -300], [9000, -300], [-300, 9000]]), Relation::Surrounding);
        // The samples on the left and top edges are in, those on the right one are out.
        assert_eq!(relation([[128, 128], [9000, 128], [128, 9000]]), Relation::Surrounding);
        assert_eq!(relation([[1920, 9000], [1920, -7000], [-7000, -7000]]), Relation::ContainedOrIntersecting);
    }

    #[test]
    fn p20_the_four_corner_test_decides_only_what_is_so_at_every_sample() {
        let large = [[-300, -300], [9000, -300], [-300, 9000]];
        let at = |setup| CornerDepths::new(setup, WINDOW);
        let front = triangle(large, [0.6, 0.9, 0.6], 1);
        let behind = triangle(large, [0.4, 0.8, 0.4], 0);
        let through = triangle(large, [0.6, 0.6, 0.9], 2);
        assert!(at(&front).hides(&at(&behind)) && !at(&behind).hides(&at(&front)));
        assert!(!at(&front).hides(&at(&through)) && !at(&through).hides(&at(&front)));
        let twin = Setup { facet: 5, ..front };
        assert!(at(&front).hides(&at(&twin)) && !at(&twin).hides(&at(&front)));
        // Less than the rounding apart: left to the samples.
        let close = triangle(large, [0.6 + 1e-7, 0.9, 0.6], 3);
        assert!(!at(&close).hides(&at(&front)) && !at(&front).hides(&at(&close)));
        let overflowing = Setup { dz_dx: f32::INFINITY, ..through };
        assert!(!at(&front).hides(&at(&overflowing)) && !at(&overflowing).hides(&at(&front)));
    }
}
