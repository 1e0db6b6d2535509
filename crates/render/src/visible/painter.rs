//! Painter's algorithm: sort the polygons from back to front and paint each over what is there.
//!
//! Polygons are taken in the order of their farthest points. That order can be wrong where extents
//! in depth overlap. So before a polygon P is painted it is compared with each unpainted Q that it
//! might cover, and passes by the first of five tests, cheap ones first, that shows that it does
//! not: (1) extents in x or (2) in y are disjoint; (3) P lies behind the plane of Q; (4) Q lies in
//! front of the plane of P; (5) the projections do not overlap. If none holds but 3 or 4 with the
//! roles exchanged, Q has to come first: it is moved before P and marked, and the same is asked of
//! Q. If a polygon has to wait for one that is marked, they wait for each other in a circle, which
//! is cut: one of them is split. If Q is neither before nor behind P, they penetrate, and one is
//! split where the planes meet.
//!
//! The polygons are the faces of the file: flat convex ones whole, others in the few convex pieces
//! that their triangles can be joined to (`polygons.rs`).
//!
//! It always ends. A polygon is split along planes and edges of the others it meets, each time into
//! two parts that lie clearly off the line; when no line is left that splits one, the circle is one
//! of rounding, and P is painted.
//!
//! In:   set-up triangles, joined to polygons (screen space). Out: the samples of each tile (screen
//!       space).
//! Cost: `O(n log n)` for sorting, plus pairs of polygons in one cell of a grid, plus covered
//!       samples, hidden ones too.
//! Source: [Newell, Newell & Sancha 1972]. Departs from it: a grid over the picture finds the
//! polygons to compare with; marked polygons form a stack, so that one that has to come first is
//! painted at once; before a split the depths in the overlap of the projections are looked at,
//! since planes often meet elsewhere; circles are cut along a line, of a plane or an edge, that
//! leaves no part both waiting and waited for, if there is one; of two polygons that penetrate, the
//! smaller is split, which makes fewer parts; parts go on with the comparisons of the whole; and
//! the grid becomes finer as parts become many.

mod compare;
mod split;

use super::cut::{Cut, bounds};
use super::facets::Facets;
use super::pieces::{Pieces, Raster};
use super::polygons::Polygons;
use super::priority_list::{PriorityList, draw_list, on_screen};
use super::sink::TileSink;
use super::{PolygonAlgorithm, PolygonList, Resolved, VisibleSurface};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::trace::Step;
use crate::trace::lists::{ListTest, ListVerdict as Verdict, ListedPolygon};
use crate::{Execution, PreparedView};
use compare::{PainterPolygon, compare};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::Range;
use vitral_exec::Limit;
use vitral_raster::{Setup, TileGrid};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct Painter;

impl VisibleSurface for Painter {
    fn resolve(
        &self,
        view: &PreparedView<'_>,
        marks: Option<&Marks>,
        grid: &mut TileGrid,
        execution: &Execution,
        sink: &dyn TileSink,
    ) -> Result<Resolved, Limit> {
        let mut resolved = Resolved::default();
        let facets = Facets::new(view, execution, &mut resolved)?;
        let (setups, opaque) = facets.listed();
        let polygons = Polygons::of_list(setups.split_at(opaque), view);
        execution.budget.charged(polygons.bytes(), "the painter's list", || {
            // Sort from back to front, splitting what is in no order.
            let mut counters = VisibilityCounters::default();
            let raster = Raster::new(view.viewport, &view.pattern);
            let list =
                sorted(&polygons, raster, execution, &mut counters, |sorting| sorting.list())?;
            counters.pieces = list.len() as u64;

            // Paint.
            let (bytes, runs) = (list.bytes(), [list]);
            let list = PriorityList { setups: polygons.triangles(), opaque, runs: &runs };
            let painted = execution.budget.charged(bytes, "the painter's list", || {
                draw_list::<false>(&facets, &list, marks, grid, sink, "painting")
            })?;
            counters.add(&painted);
            resolved.counters = counters;
            Ok(())
        })?;
        Ok(resolved)
    }
}

impl PolygonAlgorithm for Painter {
    fn polygons(
        &self,
        view: &PreparedView<'_>,
        execution: &Execution,
        list: &mut PolygonList,
    ) -> Result<(), Limit> {
        // Set up the facets and join them to polygons.
        let facets = Facets::without_tiles(view, execution)?;
        let wholes = Polygons::new(facets.all(), view);
        list.wholes = wholes.len() as u64;
        execution.budget.charged(wholes.bytes(), "the painter's list", || {
            let mut counters = VisibilityCounters::default();
            let raster = Raster::new(view.viewport, &view.pattern);
            // Sort them and copy the list.
            sorted(&wholes, raster, execution, &mut counters, |sorting| {
                for &number in &sorting.painted {
                    let polygon = &sorting.polygons[number as usize];
                    let facets = wholes.get(polygon.whole as usize).all_facets();
                    list.push_convex(facets, polygon.points(&sorting.corners));
                }
            })?;
            counters.pieces = list.polygons.len() as u64;
            list.counters = counters;
            Ok(())
        })
    }
}

/// Sorts all polygons and their parts from back to front, and takes what is wanted of that.
fn sorted<T>(
    wholes: &Polygons<'_>,
    raster: Raster<'_>,
    execution: &Execution,
    counters: &mut VisibilityCounters,
    take: impl FnOnce(&Sorting<'_, '_>) -> T,
) -> Result<T, Limit> {
    let mut sorting = Sorting::new(wholes, raster, execution, counters)?;
    let outcome = sorting.sort();
    let (list, charged) = (take(&sorting), sorting.charged);
    drop(sorting);
    execution.budget.release(charged);
    outcome.map(|()| list)
}

/// What has become of a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// In the list, not painted.
    Waiting,
    /// It waits, and others wait for it to be painted first.
    Marked,
    /// Painted.
    Painted,
    /// Its parts have taken its place.
    Split,
}

impl State {
    /// Whether it is neither painted nor split.
    fn is_pending(self) -> bool {
        matches!(self, Self::Waiting | Self::Marked)
    }
}

/// What the first order goes by: the farthest first.
#[derive(Clone, Copy, PartialEq)]
struct Farness {
    far: f32,
    facet: u32,
    polygon: u32,
}

impl Eq for Farness {}

impl PartialOrd for Farness {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Farness {
    /// The greatest is painted first; of equally far ones, the higher facet.
    fn cmp(&self, other: &Self) -> Ordering {
        other
            .far
            .total_cmp(&self.far)
            .then(self.facet.cmp(&other.facet))
            .then(other.polygon.cmp(&self.polygon))
    }
}

/// A marked polygon, and how far its comparisons have come.
#[derive(Clone, Copy)]
struct Marked {
    polygon: u32,
    progress: Progress,
}

/// How far the comparisons of a polygon have come. What it passed once it need not be compared with
/// again, nor with parts of it.
#[derive(Clone, Copy)]
struct Progress {
    /// Cell of the grid, and place in its list.
    cell: [u16; 2],
    at: u32,
    /// The state of the cell's list that the place is in.
    version: u32,
}

/// A polygon on the list of a cell, with the values compared first when another is compared with
/// it. Small, since many are looked at.
#[derive(Clone, Copy)]
struct Entry {
    polygon: u32,
    /// Its farthest depth.
    far: f32,
    /// The first cell it is in.
    cell: [u16; 2],
}

/// Pixels along a cell of the grid at least.
const SMALLEST_CELL: u32 = 8;
/// About how many polygons a cell should hold.
const POLYGONS_A_CELL: usize = 12;
/// Bytes of a polygon: itself, its corners, its place, its comparisons, its entries in the grid.
const BYTES_A_POLYGON: u64 = (size_of::<PainterPolygon>()
    + 4 * 16
    + size_of::<Farness>()
    + size_of::<Progress>()
    + 2 * size_of::<Entry>()) as u64;

/// The sorting of one picture.
struct Sorting<'f, 'c> {
    /// The polygons before any is split.
    wholes: &'f Polygons<'f>,
    raster: Raster<'f>,
    execution: &'f Execution,
    counters: &'c mut VisibilityCounters,
    polygons: Vec<PainterPolygon>,
    states: Vec<State>,
    corners: Vec<[f64; 2]>,
    cuts: Vec<Cut>,
    /// The order by the farthest point.
    waiting: BinaryHeap<Farness>,
    marked: Vec<Marked>,
    /// Polygons by cell, row by row.
    cells: Vec<Vec<Entry>>,
    /// How many polygons of each cell's list are painted or split.
    done: Vec<u32>,
    /// Cells where that is more than half.
    stale: Vec<u32>,
    /// How often each cell's list was tidied.
    versions: Vec<u32>,
    /// How far each polygon's comparisons had come when it lost its mark.
    progress: Vec<Progress>,
    columns: u32,
    cell: u32,
    /// How many polygons wait.
    pending: usize,
    painted: Vec<u32>,
    charged: u64,
}

/// Pixels along a cell of the grid for so many polygons.
fn cell_size(raster: &Raster<'_>, polygons: usize) -> u32 {
    let viewport = raster.viewport();
    let pixels = viewport.width as usize * viewport.height as usize;
    ((pixels / (polygons / POLYGONS_A_CELL + 1)).isqrt() as u32).max(SMALLEST_CELL)
}

impl<'f, 'c> Sorting<'f, 'c> {
    fn new(
        wholes: &'f Polygons<'f>,
        raster: Raster<'f>,
        execution: &'f Execution,
        counters: &'c mut VisibilityCounters,
    ) -> Result<Self, Limit> {
        // Choose the cells and charge for the lists.
        let cell = cell_size(&raster, wholes.len());
        let viewport = raster.viewport();
        let (columns, rows) = (viewport.width.div_ceil(cell), viewport.height.div_ceil(cell));
        let charged = wholes.len() as u64 * BYTES_A_POLYGON + u64::from(columns * rows) * 24;
        execution.budget.charge(charged, "the painter's list")?;
        let mut sorting = Self {
            wholes,
            raster,
            execution,
            counters,
            polygons: Vec::with_capacity(wholes.len()),
            states: Vec::with_capacity(wholes.len()),
            corners: Vec::with_capacity(wholes.len() * 4),
            cuts: Vec::new(),
            waiting: BinaryHeap::with_capacity(wholes.len()),
            marked: Vec::new(),
            cells: vec![Vec::new(); (columns * rows) as usize],
            done: vec![0; (columns * rows) as usize],
            stale: Vec::new(),
            versions: vec![0; (columns * rows) as usize],
            progress: Vec::with_capacity(wholes.len()),
            columns,
            cell,
            pending: 0,
            painted: Vec::new(),
            charged,
        };

        // Enter all polygons.
        let mut outline = Vec::new();
        for whole in 0..wholes.len() {
            outline.clear();
            outline.extend(wholes.get(whole).outline().iter().map(|corner| corner.map(f64::from)));
            sorting.add(whole as u32, &outline, 0..0);
        }
        Ok(sorting)
    }

    /// The plane of a polygon, or of the one that it is a part of.
    fn plane(&self, polygon: u32) -> &'f Setup {
        self.wholes.get(self.polygons[polygon as usize].whole as usize).plane()
    }

    /// The facet by which a polygon is named.
    fn facet(&self, polygon: u32) -> u32 {
        self.plane(polygon).facet
    }

    /// Adds a polygon, if it can have samples, and gives its number.
    fn add(&mut self, whole: u32, corners: &[[f64; 2]], cuts: Range<u32>) -> Option<u32> {
        // Skip polygons without pixels.
        let pixels = self.raster.pixels(bounds(corners))?;
        let plane = self.wholes.get(whole as usize).plane();

        // Store the corners and the polygon, and enter it in its cells.
        let first = self.corners.len() as u32;
        self.corners.extend_from_slice(corners);
        let own = first..self.corners.len() as u32;
        let polygon = PainterPolygon::new(
            plane,
            whole,
            corners,
            own,
            cuts,
            pixels.map(|p| p / self.cell as u16),
        );
        let number = self.polygons.len() as u32;
        self.enter(number, polygon.far, polygon.cells);
        self.pending += 1;
        let [x0, y0, ..] = polygon.cells;

        // Queue it by its farthest depth.
        self.waiting.push(Farness { far: polygon.far, facet: plane.facet, polygon: number });
        self.states.push(State::Waiting);
        self.polygons.push(polygon);
        self.progress.push(Progress { cell: [x0, y0], at: 0, version: 0 });
        Some(number)
    }

    /// Where a cell is among all.
    fn index(&self, [x, y]: [u16; 2]) -> usize {
        y as usize * self.columns as usize + x as usize
    }

    /// Puts a polygon on the lists of its cells.
    fn enter(&mut self, polygon: u32, far: f32, [x0, y0, x1, y1]: [u16; 4]) {
        let entry = Entry { polygon, far, cell: [x0, y0] };
        for y in y0..=y1 {
            for x in x0..=x1 {
                let cell = self.index([x, y]);
                self.cells[cell].push(entry);
            }
        }
    }

    /// Makes the cells smaller when splitting has made polygons many and small. None may be marked.
    fn refine(&mut self) {
        let cell = cell_size(&self.raster, self.pending);
        if cell * 2 > self.cell {
            return;
        }

        // Empty all cells.
        let viewport = self.raster.viewport();
        self.cell = cell;
        self.columns = viewport.width.div_ceil(cell);
        let cells = (self.columns * viewport.height.div_ceil(cell)) as usize;
        self.cells.iter_mut().for_each(Vec::clear);
        self.cells.resize(cells, Vec::new());
        self.stale.clear();
        self.done.clear();
        self.done.resize(cells, 0);
        self.versions.clear();
        self.versions.resize(cells, 0);

        // Enter the waiting polygons anew.
        for number in 0..self.polygons.len() as u32 {
            if self.states[number as usize] == State::Waiting {
                let around = bounds(self.polygons[number as usize].points(&self.corners));
                let Some(pixels) = self.raster.pixels(around) else { continue };
                let own = pixels.map(|p| p / cell as u16);
                self.polygons[number as usize].cells = own;
                self.progress[number as usize] =
                    Progress { cell: [own[0], own[1]], at: 0, version: 0 };
                self.enter(number, self.polygons[number as usize].far, own);
            }
        }
    }

    /// A polygon as steps tell it.
    fn listed(&self, polygon: u32) -> ListedPolygon {
        let depth = &self.polygons[polygon as usize].depth;
        ListedPolygon {
            polygon,
            facet: self.facet(polygon),
            far: depth.min as f32,
            near: depth.max as f32,
        }
    }

    /// The step of the first order.
    fn first_order(&self) -> Step {
        let order = self.waiting.clone().into_sorted_vec();
        Step::FirstOrder {
            polygons: order.iter().rev().map(|farness| self.listed(farness.polygon)).collect(),
        }
    }

    /// Finds the order.
    fn sort(&mut self) -> Result<(), Limit> {
        self.execution.budget.begin("polygons", self.polygons.len() as u64);
        self.execution.report(|| self.first_order());
        while let Some(place) = self.waiting.pop() {
            if self.states[place.polygon as usize] == State::Waiting {
                self.execution.report(|| Step::Turn { polygon: place.polygon, facet: place.facet });
                self.mark(place.polygon);
                self.paint_marked()?;
                self.refine();
            }
        }
        Ok(())
    }

    /// Notes that a polygon is painted or split.
    fn finish(&mut self, polygon: u32, state: State) {
        self.states[polygon as usize] = state;
        self.pending -= 1;
        let [x0, y0, x1, y1] = self.polygons[polygon as usize].cells;
        for y in y0..=y1 {
            for x in x0..=x1 {
                let cell = self.index([x, y]);
                self.done[cell] += 1;
                if self.done[cell] as usize * 2 > self.cells[cell].len() {
                    self.stale.push(cell as u32);
                }
            }
        }
    }

    /// Removes finished polygons from the cells' lists, which invalidates positions in these lists.
    fn tidy(&mut self) {
        for cell in self.stale.drain(..) {
            let done = &mut self.done[cell as usize];
            if *done > 0 {
                *done = 0;
                self.versions[cell as usize] += 1;
                let pending = |entry: &Entry| self.states[entry.polygon as usize].is_pending();
                self.cells[cell as usize].retain(pending);
            }
        }
    }

    fn mark(&mut self, polygon: u32) {
        self.states[polygon as usize] = State::Marked;
        self.marked.push(Marked { polygon, progress: self.progress[polygon as usize] });
    }

    /// Paints the marked polygons, and whatever has to come before them.
    fn paint_marked(&mut self) -> Result<(), Limit> {
        // Work on the last marked polygon until nothing has to come before it.
        let mut steps = 0u32;
        while let Some(&top) = self.marked.last() {
            steps += 1;
            if steps % 64 == 1 {
                self.account()?;
            }
            self.tidy();
            let Some((other, verdict)) = self.obstacle()? else {
                self.finish(top.polygon, State::Painted);
                self.execution.report(|| Step::Painted {
                    polygon: top.polygon,
                    facet: self.facet(top.polygon),
                });
                self.painted.push(top.polygon);
                self.execution.budget.advance();
                self.marked.pop();
                continue;
            };

            // Move the obstacle to the front, cut a cycle, or split.
            let solved = match (verdict, self.states[other as usize]) {
                (Verdict::After, State::Marked) => self.cut_cycle(other),
                (Verdict::After, _) => {
                    self.counters.reordered += 1;
                    self.execution.report(|| {
                        let [facet, before] = [other, top.polygon].map(|p| self.facet(p));
                        Step::Moved { polygon: other, facet, before_polygon: top.polygon, before }
                    });
                    self.mark(other);
                    true
                }
                _ => self.split_at_plane(other),
            };
            // No line splits them clearly: they are as good as in order.
            if !solved && let Some(top) = self.marked.last_mut() {
                top.progress.at += 1;
            }
        }
        Ok(())
    }

    /// Goes on with the comparisons of the last marked polygon, until one says that it cannot be
    /// painted yet.
    fn obstacle(&mut self) -> Result<Option<(u32, Verdict)>, Limit> {
        // Continue where the last comparison stopped.
        let Some(top) = self.marked.last_mut() else { return Ok(None) };
        let (polygon, at) = (top.polygon, &mut top.progress);
        let p = &self.polygons[polygon as usize];
        let [x0, _, x1, y1] = p.cells;
        let version =
            self.versions[at.cell[1] as usize * self.columns as usize + at.cell[0] as usize];
        if at.version != version {
            // The list was tidied since: look at all of it.
            *at = Progress { at: 0, version, ..*at };
        }
        loop {
            let cell = at.cell[1] as usize * self.columns as usize + at.cell[0] as usize;
            while let Some(&Entry { polygon: other, far, cell: first }) =
                self.cells[cell].get(at.at as usize)
            {
                // Two polygons are compared in the first cell that both are in.
                let here = [0, 1].map(|k| p.cells[k].max(first[k])) == at.cell;
                if here && self.states[other as usize].is_pending() && other != polygon {
                    let (verdict, test) = match p.is_behind(far, self.counters) {
                        true => (Verdict::Before, ListTest::DepthExtent),
                        false => {
                            let q = &self.polygons[other as usize];
                            compare(p, q, self.wholes, &self.corners, self.counters)
                        }
                    };
                    self.execution.report(|| {
                        let facet = |i: u32| {
                            self.wholes.get(self.polygons[i as usize].whole as usize).facet()
                        };
                        let (facet, with_facet) = (facet(polygon), facet(other));
                        Step::Compared { polygon, facet, with: other, with_facet, test, verdict }
                    });
                    if verdict != Verdict::Before {
                        return Ok(Some((other, verdict)));
                    }
                }
                at.at += 1;
            }
            // On to the next cell.
            let mut next = [at.cell[0] + 1, at.cell[1]];
            if next[0] > x1 {
                self.execution.budget.check("the painter's list")?;
                next = [x0, at.cell[1] + 1];
                if next[1] > y1 {
                    return Ok(None);
                }
            }
            let version =
                self.versions[next[1] as usize * self.columns as usize + next[0] as usize];
            *at = Progress { cell: next, at: 0, version };
        }
    }

    /// Charges what the splits have added, and looks at the clock.
    fn account(&mut self) -> Result<(), Limit> {
        let budget = &self.execution.budget;
        budget.check("the painter's list")?;
        let now = self.polygons.len() as u64 * BYTES_A_POLYGON
            + (self.cuts.len() * size_of::<Cut>()) as u64;
        if now > self.charged + (1 << 16) {
            budget.charge(now - self.charged, "the painter's list")?;
            self.charged = now;
        }
        Ok(())
    }

    /// The painted polygons in order, as pieces of facets.
    fn list(&self) -> Pieces {
        // Cut each polygon's triangles by its cuts.
        let mut list = Pieces::default();
        for &number in &self.painted {
            let polygon = &self.polygons[number as usize];
            let cuts = &self.cuts[polygon.cuts.start as usize..polygon.cuts.end as usize];
            let triangles = self.wholes.triangles_of(polygon.whole as usize).map(|index| {
                let setup = self.wholes.triangles()[index as usize];
                (index, setup, self.raster.footprint(setup))
            });
            list.add_polygon(number, triangles, |_| cuts.iter().copied(), &self.raster);
        }

        // Report the list in order.
        for (order, &number) in (0..).zip(&list.listed) {
            self.execution.report(|| {
                let polygon = &self.polygons[number as usize];
                let outline = on_screen(polygon.points(&self.corners));
                let cuts = polygon.cuts.len() as u32;
                Step::Piece {
                    order,
                    polygon: number,
                    node: None,
                    facet: self.facet(number),
                    cuts,
                    outline,
                }
            });
        }
        list.finish(self.raster.viewport());
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_raster::{CornerPosition, SamplePattern, Viewport};

    fn triangle(corners: [[i32; 2]; 3], z: [f32; 3], facet: u32) -> Setup {
        let [a, b, c] = [0, 1, 2].map(|i| CornerPosition {
            x: corners[i][0] * 256,
            y: corners[i][1] * 256,
            z: z[i],
        });
        Setup::new([a, b, c], Setup::doubled_area(a, b, c), facet)
    }

    /// The facets in the order in which they are painted, and the counters.
    fn order(setups: &[Setup]) -> (Vec<u32>, VisibilityCounters) {
        let wholes = Polygons::joined(setups, |facet| facet);
        let (execution, mut counters) = (Execution::default(), VisibilityCounters::default());
        let pattern = SamplePattern::new(1);
        let raster = Raster::new(Viewport::new(64, 64).unwrap(), &pattern);
        let mut sorting = Sorting::new(&wholes, raster, &execution, &mut counters).unwrap();
        sorting.sort().unwrap();
        let painted = sorting.painted.iter().map(|&p| sorting.facet(p));
        (painted.collect(), counters)
    }

    const LARGE: [[i32; 2]; 3] = [[0, 0], [60, 0], [0, 60]];

    #[test]
    fn p21_the_farthest_point_gives_the_first_order() {
        let (painted, counters) = order(&[
            triangle(LARGE, [0.9; 3], 0),
            triangle(LARGE, [0.1; 3], 1),
            triangle(LARGE, [0.5; 3], 2),
            triangle(LARGE, [0.5; 3], 3),
        ]);
        // Of coplanar ones the lower facet is painted last.
        assert_eq!(painted, [1, 3, 2, 0]);
        assert_eq!((counters.splits, counters.reordered), (0, 0));
    }

    #[test]
    fn p21_a_polygon_that_reaches_farther_may_lie_in_front() {
        // A steep polygon, nearly all of it in front of a small one that lies behind its near part.
        let steep = triangle([[0, 0], [60, 0], [60, 30]], [0.2, 0.8, 0.8], 0);
        let small = triangle([[50, 5], [58, 5], [58, 12]], [0.4; 3], 1);
        let (painted, counters) = order(&[steep, small]);
        assert_eq!(painted, [1, 0]);
        assert_eq!((counters.reordered, counters.splits), (1, 0));
    }

    #[test]
    fn p21_penetrating_polygons_are_split_once() {
        let (painted, counters) =
            order(&[triangle(LARGE, [0.2, 0.8, 0.2], 0), triangle(LARGE, [0.8, 0.2, 0.8], 1)]);
        assert_eq!((painted.len(), counters.splits), (3, 1));
    }

    #[test]
    fn p21_a_circle_is_cut() {
        // Three bars on the screen, each far at one end and near at the other.
        let bar = |a: [i32; 2], b: [i32; 2], c: [i32; 2], facet| {
            triangle([a, b, c], [0.2, 0.8, 0.8], facet)
        };
        let (painted, counters) = order(&[
            bar([2, 20], [60, 18], [60, 24], 0),
            bar([50, 2], [36, 60], [30, 58], 1),
            bar([44, 58], [10, 4], [16, 2], 2),
        ]);
        assert!(counters.cycles >= 1 && counters.splits >= 1, "{counters:?}");
        assert_eq!(painted.len(), 3 + counters.splits as usize);
    }
}
