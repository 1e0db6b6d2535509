//! Weiler–Atherton: clip polygons against each other until only visible ones are left.
//!
//! Sort the polygons by their nearest points. Take the first and clip all others by it: the part of the scene inside it
//! and the part outside become two lists. In the inside list, what lies behind the clipping polygon is hidden and goes.
//! If nothing else remains there, the clipping polygon is visible. If something lies in front, the preliminary order
//! erred, and the inside list is treated in the same way with that as the clipping polygon. Go on with the outside list.
//! Polygons that penetrate the clipping polygon are cut where they do. In the end there are polygons of any shape, with
//! holes, which do not overlap and are all that is seen.
//!
//! In:   set-up triangles (screen space). Out: visible polygons, and the samples of each tile (screen space).
//! Cost: pairs of polygons that overlap on the screen times their edges; most pairs are told apart by their boxes.
//! Source: [Weiler & Atherton 1977]. Departs from it: the picture is divided into tiles of 64x64 pixels, which threads
//! take independently; how regions are clipped, see
//! `weiler_atherton/region.rs`. A clipping polygon is the facet as it came in, not what
//! is left of it. Whatever is closer to the clipping polygon than the rounding of depths is not taken for hidden by it:
//! then both are visible polygons, and where they overlap the facets' depth function decides each sample. Nothing loops:
//! a list never takes the same clipping polygon twice.

mod region;

use super::agreement::nearer;
use super::facets::{Facets, fill_tiles};
use super::polygons::same_plane;
use super::sink::TileSink;
use super::tiles::put;
use super::{Resolved, VisibleSurface};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::trace::Step;
use crate::{Execution, PreparedView};
use region::{Clipped, Convex, Edge, Line, Region};
use vitral_exec::Limit;
use vitral_raster::{SUBPIXEL, Setup, TILE, TILE_PIXELS, Tile, TileGrid};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct WeilerAtherton;

impl VisibleSurface for WeilerAtherton {
    fn resolve(
        &self,
        view: &PreparedView<'_>,
        marks: Option<&Marks>,
        grid: &mut TileGrid,
        execution: &Execution,
        sink: &dyn TileSink,
    ) -> Result<Resolved, Limit> {
        fill_tiles(view, marks, grid, execution, sink, 1, &|facets, index, tiles, counters| {
            let mut sorting = AreaSorting::new(facets, index, &tiles[0]);
            let mut rows = vec![0; facets.view().pattern.len() * TILE];
            let done = sorting.run(counters, |setup, region| draw(facets, setup, region, &mut rows, &mut tiles[0]));
            facets.execution().budget.release(sorting.charged);
            done
        })
    }
}

/// A facet's triangle, in a window.
struct Polygon<'f> {
    setup: &'f Setup,
    shape: Convex,
    /// Its depth plane's origin, in the window.
    origin: [f64; 2],
    /// Change of depth for 1/256 pixel.
    slope: [f64; 2],
}

/// What of a polygon may be visible.
struct Item {
    polygon: u32,
    /// It has been the clipping polygon of this list, or of one that this list came from.
    clipped_with: bool,
    region: Region,
    bounds: [f64; 4],
}

/// The hidden-surface removal in one window.
struct AreaSorting<'f> {
    execution: &'f Execution,
    polygons: Vec<Polygon<'f>>,
    /// The tile's first pixel.
    tile: [u32; 2],
    /// Lists that are still to be treated.
    lists: Vec<Vec<Item>>,
    charged: u64,
}

/// Bytes of an item without its edges; a triangle's edges.
const BYTES_AN_ITEM: usize = size_of::<Item>() + size_of::<Polygon<'_>>() + 6 * size_of::<Edge>();

impl<'f> AreaSorting<'f> {
    /// Takes the facets of a tile, the nearest first.
    fn new(facets: &'f Facets<'_, '_>, index: usize, tile: &Tile) -> Self {
        let view = facets.view();
        let size = [view.viewport.width - tile.x, view.viewport.height - tile.y].map(|s| (TILE as u32).min(s));
        let origin = [tile.x, tile.y].map(|v| v as i32 * SUBPIXEL);
        Self::over(facets.in_tile(index), origin, size.map(|s| s as i32 * SUBPIXEL), facets.execution())
    }

    fn over(
        setups: impl Iterator<Item = &'f Setup>,
        origin: [i32; 2],
        [width, height]: [i32; 2],
        execution: &'f Execution,
    ) -> Self {
        let [width, height] = [width, height].map(i64::from);
        let window = Convex::polygon(&[[0, 0], [width, 0], [width, height], [0, height]]);
        let mut setups: Vec<_> = setups.collect();
        setups.sort_by(|a, b| b.z_max.total_cmp(&a.z_max).then(a.facet.cmp(&b.facet)));
        let (mut polygons, mut items) = (Vec::new(), Vec::new());
        for setup in setups {
            let corners = [0, 1, 2].map(|i| [setup.x[i] - origin[0], setup.y[i] - origin[1]].map(i64::from));
            let whole = Region::polygon(&corners);
            let region = match whole.clip(whole.bounds(), &window) {
                Clipped::Inside => whole,
                Clipped::Outside => continue,
                Clipped::Both(inside, _) => inside,
            };
            let bounds = region.bounds();
            items.push(Item { polygon: polygons.len() as u32, clipped_with: false, region, bounds });
            polygons.push(Polygon::new(setup, Convex::polygon(&corners), origin));
        }
        let tile = origin.map(|v| (v / SUBPIXEL) as u32);
        Self { execution, polygons, tile, lists: vec![items], charged: 0 }
    }

    /// Calls `show` with the visible polygons.
    fn run(&mut self, counters: &mut VisibilityCounters, mut show: impl FnMut(&Setup, &Region)) -> Result<(), Limit> {
        let mut steps = 0u32;
        while let Some(mut list) = self.lists.pop() {
            self.execution.budget.check("Weiler–Atherton")?;
            if steps.is_multiple_of(64) {
                self.account(&list)?;
            }
            steps += 1;

            // Take the nearest polygon that nothing was clipped with yet; a list without one is done.
            let Some(first) = list.iter().position(|i| !i.clipped_with) else {
                for item in &list {
                    counters.visible_polygons += 1;
                    self.execution.tell(|| self.visible(item));
                    show(self.polygons[item.polygon as usize].setup, &item.region);
                }
                continue;
            };
            let clipping = list[first].polygon;
            let inside = self.clip(&mut list, clipping, counters);
            list.retain(|i| !i.region.is_empty());
            let (inside_count, outside) = (inside.len() as u32, list.len() as u32);
            if !list.is_empty() {
                self.lists.push(list);
            }
            let again = inside.iter().any(|i| !i.clipped_with);
            counters.recursions += u64::from(again);
            let (facet, tile) = (self.polygons[clipping as usize].setup.facet, self.tile);
            self.execution.tell(|| Step::Clip { tile, facet, inside: inside_count, outside, again });
            if !inside.is_empty() {
                self.lists.push(inside);
            }
        }
        Ok(())
    }

    /// What is to be told of a visible polygon.
    fn visible(&self, item: &Item) -> Step {
        let place = |p: [f64; 2]| [0, 1].map(|k| (p[k] / f64::from(SUBPIXEL)) as f32 + self.tile[k] as f32);
        let edges = item.region.edges.iter().map(|e| e.ends.map(|end| place(end.about))).collect();
        Step::Visible { facet: self.polygons[item.polygon as usize].setup.facet, edges }
    }

    /// Clips a list by a polygon: leaves the outside, and gives what is inside and not hidden.
    fn clip(&self, list: &mut [Item], clipping: u32, counters: &mut VisibilityCounters) -> Vec<Item> {
        let front = &self.polygons[clipping as usize];
        let mut inside = Vec::new();
        for item in list {
            let part = match item.region.clip(item.bounds, &front.shape) {
                Clipped::Outside => continue,
                Clipped::Inside => std::mem::take(&mut item.region),
                Clipped::Both(inside, outside) => {
                    counters.clipped_polygons += 1;
                    item.bounds = outside.bounds();
                    item.region = outside;
                    inside
                }
            };
            if part.is_empty() {
                continue;
            }
            let clipped_with = item.clipped_with || item.polygon == clipping;
            let region = if item.polygon == clipping {
                part
            } else {
                counters.depth_comparisons += 1;
                match self.unhidden(part, item.polygon, front, counters) {
                    Some(region) => region,
                    None => continue,
                }
            };
            let bounds = region.bounds();
            inside.push(Item { polygon: item.polygon, clipped_with, region, bounds });
        }
        inside
    }

    /// What of a region inside `front` is not hidden by it.
    fn unhidden(
        &self,
        region: Region,
        back: u32,
        front: &Polygon<'_>,
        counters: &mut VisibilityCounters,
    ) -> Option<Region> {
        let back = &self.polygons[back as usize];
        let margin = match relation(front, back, &region) {
            Relation::Hidden => return None,
            Relation::Visible => return Some(region),
            Relation::Partly { margin } => margin,
        };
        let Some(line) = line_of_gap(front, back, margin) else { return Some(region) };
        match region.clip(region.bounds(), &Convex::half_plane(line)) {
            Clipped::Both(behind, rest) if relation(front, back, &behind) == Relation::Hidden => {
                counters.splits += 1;
                (!rest.is_empty()).then_some(rest)
            }
            _ => Some(region),
        }
    }

    /// Charges what the lists hold.
    fn account(&mut self, list: &[Item]) -> Result<(), Limit> {
        let budget = &self.execution.budget;
        let items = self.lists.iter().flatten().chain(list);
        let bytes: usize = items.map(|i| BYTES_AN_ITEM + i.region.edges.len() * size_of::<Edge>()).sum();
        let more = (bytes as u64).saturating_sub(self.charged);
        budget.charge(more, "Weiler–Atherton")?;
        self.charged += more;
        Ok(())
    }
}

impl<'f> Polygon<'f> {
    fn new(setup: &'f Setup, shape: Convex, window: [i32; 2]) -> Self {
        let slope = [setup.dz_dx, setup.dz_dy].map(|d| f64::from(d) / f64::from(SUBPIXEL));
        let origin = [0, 1].map(|k| f64::from(setup.origin[k] - window[k]));
        Self { setup, shape, origin, slope }
    }

    /// What moving from the plane's origin adds to its depth, for x and for y.
    fn change(&self, p: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (p[k] - self.origin[k]) * self.slope[k])
    }

    /// The plane's depth, not clamped.
    fn depth(&self, p: [f64; 2]) -> f64 {
        let [x, y] = self.change(p);
        f64::from(self.setup.z) + x + y
    }

    /// How far [`Setup::depth`] may be from that: four roundings to 24 bits, of numbers no larger than the sum.
    fn rounding(&self, p: [f64; 2]) -> f64 {
        let [x, y] = self.change(p);
        (f64::from(self.setup.z.abs()) + x.abs() + y.abs()) * f64::from(f32::EPSILON) * 4.0
    }
}

/// What a region of one polygon is to another that covers it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Relation {
    /// Behind it at every sample.
    Hidden,
    /// Nowhere certainly behind.
    Visible,
    /// Behind it somewhere; depths are certain by `margin`.
    Partly { margin: f64 },
}

/// Looks at the corners of a region: between them depths are linear, apart from rounding and from the clamping to the
/// facet's own range, for which there has to be room.
fn relation(front: &Polygon<'_>, back: &Polygon<'_>, region: &Region) -> Relation {
    let (near, far) = (front.setup, back.setup);
    if near.z_min > far.z_max {
        return Relation::Hidden;
    }
    if same_plane(near, far) {
        return if near.facet < far.facet { Relation::Hidden } else { Relation::Visible };
    }
    let (mut smallest, mut largest) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut margin, mut room) = (0.0f64, near.z_max > far.z_min);
    let (mut nearest_back, mut farthest_front) = (f64::NEG_INFINITY, f64::INFINITY);
    for edge in &region.edges {
        let place = edge.ends[0].about;
        let [a, b] = [front, back].map(|p| p.depth(place));
        (smallest, largest) = (smallest.min(a - b), largest.max(a - b));
        (farthest_front, nearest_back) = (farthest_front.min(a), nearest_back.max(b));
        // f64::max would swallow a NaN.
        let rounding = front.rounding(place) + back.rounding(place);
        margin = if rounding <= margin { margin } else { rounding };
    }
    room &= farthest_front - margin > f64::from(far.z_min) && nearest_back + margin < f64::from(near.z_max);
    if smallest > margin && room {
        Relation::Hidden
    } else if largest > margin {
        Relation::Partly { margin }
    } else {
        Relation::Visible
    }
}

/// The line, with whole coefficients, beyond which `front` is nearer than `back` by `margin`, and a little more for the
/// rounding of the coefficients.
fn line_of_gap(front: &Polygon<'_>, back: &Polygon<'_>, margin: f64) -> Option<Line> {
    let [dx, dy] = [0, 1].map(|k| front.slope[k] - back.slope[k]);
    let z = front.depth([0.0; 2]) - back.depth([0.0; 2]);
    let scale = f64::from(1 << 22) / dx.abs().max(dy.abs());
    let (a, b, c) = ((dx * scale).round(), (dy * scale).round(), ((z - margin) * scale).floor());
    // Half a unit in a and in b makes the window's side, 2^14, at most.
    let slack = f64::from(1 << 15);
    let fits = scale.is_finite() && c.abs() < 1e12;
    fits.then_some(Line { a: a as i64, b: b as i64, c: (c - slack) as i64 })
}

/// Fills the samples of a visible polygon.
fn draw(facets: &Facets<'_, '_>, setup: &Setup, region: &Region, rows: &mut [u64], tile: &mut Tile) {
    let view = facets.view();
    rows.fill(0);
    region.turn_samples(&view.pattern, rows);
    for (line, &bits) in rows.iter().enumerate() {
        let (s, row) = (line / TILE, line % TILE);
        let [sx, sy] = view.pattern.position(s);
        let y = (tile.y as usize + row) as i32 * SUBPIXEL + sy;
        let mut left = bits;
        while left != 0 {
            let column = left.trailing_zeros() as usize;
            left &= left - 1;
            let x = (tile.x as usize + column) as i32 * SUBPIXEL + sx;
            let (sample, candidate) = (s * TILE_PIXELS + row * TILE + column, (setup.depth(x, y), setup.facet));
            if nearer(candidate, (tile.depth[sample], tile.facet[sample])) {
                put(tile, sample, candidate);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_raster::CornerPosition;

    fn triangle(corners: [[i32; 2]; 3], z: [f32; 3], facet: u32) -> Setup {
        let [a, b, c] = [0, 1, 2].map(|i| CornerPosition { x: corners[i][0] * 256, y: corners[i][1] * 256, z: z[i] });
        Setup::new([a, b, c], Setup::doubled_area(a, b, c), facet)
    }

    /// Facet and area of the visible polygons in a window of 64x64 pixels.
    fn visible(setups: &[Setup]) -> (Vec<(u32, f64)>, VisibilityCounters) {
        let (execution, mut counters) = (Execution::default(), VisibilityCounters::default());
        let mut sorting = AreaSorting::over(setups.iter(), [0, 0], [64 * 256; 2], &execution);
        let mut seen = Vec::new();
        sorting.run(&mut counters, |setup, region| seen.push((setup.facet, region.area()))).unwrap();
        (seen, counters)
    }

    /// The area of a union: what the window loses when everything is cut out of it.
    fn union_area(setups: &[Setup]) -> f64 {
        let mut left = Region::polygon(&[[0, 0], [16384, 0], [16384, 16384], [0, 16384]]);
        for setup in setups {
            let corners = [0, 1, 2].map(|i| [setup.x[i], setup.y[i]].map(i64::from));
            match left.clip(left.bounds(), &Convex::polygon(&corners)) {
                Clipped::Inside => return 4096.0,
                Clipped::Outside => {}
                Clipped::Both(_, outside) => left = outside,
            }
        }
        4096.0 - left.area()
    }

    const LARGE: [[i32; 2]; 3] = [[0, 0], [60, 0], [0, 60]];

    #[test]
    fn p24_a_polygon_in_front_cuts_a_hole() {
        let (seen, counters) =
            visible(&[triangle(LARGE, [0.2; 3], 0), triangle([[10, 10], [20, 10], [10, 20]], [0.8; 3], 1)]);
        assert_eq!(seen, [(1, 50.0), (0, 1750.0)]);
        assert_eq!((counters.recursions, counters.splits), (0, 0));
    }

    #[test]
    fn p24_the_preliminary_order_may_err() {
        // The large one comes nearer, but elsewhere: where they overlap, the small one is in front.
        let (seen, counters) =
            visible(&[triangle(LARGE, [0.1, 0.9, 0.1], 0), triangle([[2, 2], [12, 2], [2, 12]], [0.5; 3], 1)]);
        let of = |facet: u32| seen.iter().filter(|s| s.0 == facet).map(|s| s.1).sum::<f64>();
        assert!((of(1) - 50.0).abs() < 1e-6 && (of(0) - 1750.0).abs() < 1e-6, "{seen:?}");
        assert!(counters.recursions > 0);
    }

    #[test]
    fn p24_penetrating_polygons_are_cut_where_they_meet() {
        let (seen, counters) = visible(&[triangle(LARGE, [0.2, 0.8, 0.2], 0), triangle(LARGE, [0.8, 0.2, 0.8], 1)]);
        let of = |facet: u32| seen.iter().filter(|s| s.0 == facet).map(|s| s.1).sum::<f64>();
        // They meet at x = 30: a triangle of 450 square pixels remains right of it.
        assert!((of(0) - 450.0).abs() < 0.1 && (of(1) - 1350.0).abs() < 0.1, "{seen:?}");
        assert!(counters.splits > 0);
    }

    #[test]
    fn p24_visible_areas_make_the_area_of_the_union() {
        let mut state = 3u32;
        let mut next = |n: i32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as i32 % n
        };
        for round in 0..40 {
            let setups: Vec<_> = (0..24)
                .filter_map(|facet| {
                    let corners = [0; 3].map(|_| [0; 2].map(|_| next(80) - 8));
                    let z = [0; 3].map(|_| next(1000) as f32 / 1000.0);
                    let [a, b, c] = corners.map(|[x, y]| CornerPosition { x, y, z: 0.0 });
                    (Setup::doubled_area(a, b, c) != 0).then(|| triangle(corners, z, facet))
                })
                .collect();
            let (seen, _) = visible(&setups);
            let sum: f64 = seen.iter().map(|s| s.1).sum();
            let union = union_area(&setups);
            // Strips along the lines of penetration, 1/30000 pixel wide, are there twice.
            assert!(sum > union - 1e-6 && sum < union + 0.1, "round {round}: {sum} of {union}");
        }
    }
}
