//! Painter's algorithm: sort the polygons from back to front and paint each over what is there.
//!
//! Polygons are taken in the order of their farthest points. That order can be wrong where extents in depth overlap. So
//! before a polygon P is painted it is compared with each unpainted Q that it might cover, and passes by the first of
//! five tests, cheap ones first, that shows that it does not: (1) extents in x or (2) in y are disjoint; (3) P lies
//! behind the plane of Q; (4) Q lies in front of the plane of P; (5) the projections do not overlap. If none holds but
//! 3 or 4 with the roles exchanged, Q has to come first: it is moved before P and marked, and the same is asked of Q.
//! If a polygon has to wait for one that is marked, they wait for each other in a circle, which is cut: one of them is
//! split. If Q is neither before nor behind P, they penetrate, and P is split where the planes meet.
//!
//! It always ends. A polygon is split along planes and edges of the others it meets, each time into two parts that lie
//! clearly off the line; when no line is left that splits one, the circle is one of rounding, and P is painted.
//!
//! In:   set-up triangles (screen space). Out: the samples of each tile (screen space).
//! Cost: `O(n log n)` for sorting, plus pairs of polygons in one cell of a grid, plus covered samples, hidden ones too.
//! Source: [Newell, Newell & Sancha 1972]. Departs from it: a grid over the picture finds the polygons to compare with;
//! marked polygons form a stack, so that one that has to come first is painted at once; before a split the depths in
//! the overlap of the projections are looked at, since planes often meet elsewhere; circles of polygons that lie on one
//! side of each other's planes are cut along an edge, where a plane would not cut them.

mod compare;

use super::cut::{Cut, bounds, corners};
use super::facets::Facets;
use super::pieces::{Pieces, Raster};
use super::priority_list::{PriorityList, draw_list, piece_step};
use super::sink::TileSink;
use super::{Resolved, VisibleSurface};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::trace::Step;
use crate::{Execution, PreparedView};
use compare::{Polygon, Verdict, compare, crossing};
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

        // Sort from back to front, splitting what is in no order.
        let mut counters = VisibilityCounters::default();
        let list = sorted(&setups, Raster::new(view.viewport, &view.pattern), execution, &mut counters)?;
        counters.pieces = list.len() as u64;

        // Paint.
        let (bytes, runs) = (list.bytes(), [list]);
        let list = PriorityList { setups: &setups, opaque, runs: &runs };
        let painted = execution.budget.charged(bytes, "the painter's list", || {
            draw_list::<false>(&facets, &list, marks, grid, sink, "painting")
        })?;
        counters.add(&painted);
        resolved.counters = counters;
        Ok(resolved)
    }
}

/// The list of all triangles or their pieces, from back to front.
fn sorted(
    setups: &[&Setup],
    raster: Raster<'_>,
    execution: &Execution,
    counters: &mut VisibilityCounters,
) -> Result<Pieces, Limit> {
    let mut sorting = Sorting::new(setups, raster, execution, counters)?;
    let outcome = sorting.sort();
    let (list, charged) = (sorting.list(), sorting.charged);
    drop(sorting);
    execution.budget.release(charged);
    outcome.map(|()| list)
}

/// What has become of a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Waiting,
    /// It waits, and others wait for it to be painted first.
    Marked,
    Painted,
    /// Its parts have taken its place.
    Split,
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
        other.far.total_cmp(&self.far).then(self.facet.cmp(&other.facet)).then(other.polygon.cmp(&self.polygon))
    }
}

/// A marked polygon, and how far its comparisons have come.
#[derive(Clone, Copy)]
struct Marked {
    polygon: u32,
    /// Cell of the grid, and place in its list.
    cell: [u16; 2],
    at: u32,
}

/// What is looked at first of a polygon that another is compared with: the first cell it is in, its farthest depth, and
/// what has become of it. Small, since many are looked at.
#[derive(Clone, Copy)]
struct Brief {
    cell: [u16; 2],
    far: f32,
    state: State,
}

/// Pixels along a cell of the grid at least.
const SMALLEST_CELL: u32 = 8;
/// About how many polygons a cell should hold.
const POLYGONS_A_CELL: usize = 12;
/// Bytes of a polygon: itself, its corners, its place, its entries in the grid.
const BYTES_A_POLYGON: u64 = (size_of::<Polygon>() + 3 * 16 + size_of::<Farness>() + 16) as u64;

/// The sorting of one picture.
struct Sorting<'f, 'c> {
    setups: &'f [&'f Setup],
    raster: Raster<'f>,
    execution: &'f Execution,
    counters: &'c mut VisibilityCounters,
    polygons: Vec<Polygon>,
    briefs: Vec<Brief>,
    corners: Vec<[f64; 2]>,
    cuts: Vec<Cut>,
    /// The order by the farthest point.
    waiting: BinaryHeap<Farness>,
    marked: Vec<Marked>,
    /// Polygons by cell, row by row.
    cells: Vec<Vec<u32>>,
    /// How many polygons of each cell's list are painted or split.
    done: Vec<u32>,
    /// Cells where that is more than half.
    stale: Vec<u32>,
    columns: u32,
    cell: u32,
    painted: Vec<u32>,
    charged: u64,
}

impl<'f, 'c> Sorting<'f, 'c> {
    fn new(
        setups: &'f [&'f Setup],
        raster: Raster<'f>,
        execution: &'f Execution,
        counters: &'c mut VisibilityCounters,
    ) -> Result<Self, Limit> {
        let viewport = raster.viewport();
        let pixels = viewport.width as usize * viewport.height as usize;
        let cells = setups.len() / POLYGONS_A_CELL + 1;
        let cell = ((pixels / cells).isqrt() as u32).max(SMALLEST_CELL);
        let (columns, rows) = (viewport.width.div_ceil(cell), viewport.height.div_ceil(cell));
        let charged = setups.len() as u64 * BYTES_A_POLYGON + u64::from(columns * rows) * 24;
        execution.budget.charge(charged, "the painter's list")?;
        let mut sorting = Self {
            setups,
            raster,
            execution,
            counters,
            polygons: Vec::with_capacity(setups.len()),
            briefs: Vec::with_capacity(setups.len()),
            corners: Vec::with_capacity(setups.len() * 3),
            cuts: Vec::new(),
            waiting: BinaryHeap::with_capacity(setups.len()),
            marked: Vec::new(),
            cells: vec![Vec::new(); (columns * rows) as usize],
            done: vec![0; (columns * rows) as usize],
            stale: Vec::new(),
            columns,
            cell,
            painted: Vec::new(),
            charged,
        };
        for (i, setup) in setups.iter().enumerate() {
            sorting.add(i as u32, &corners(setup), 0..0);
        }
        Ok(sorting)
    }

    /// Adds a polygon, if it can have samples.
    fn add(&mut self, index: u32, corners: &[[f64; 2]], cuts: Range<u32>) {
        let Some(pixels) = self.raster.pixels(bounds(corners)) else { return };
        let setup = self.setups[index as usize];
        let first = self.corners.len() as u32;
        self.corners.extend_from_slice(corners);
        let own = first..self.corners.len() as u32;
        let polygon = Polygon::new(setup, index, corners, own, cuts, pixels.map(|p| p / self.cell as u16));
        let number = self.polygons.len() as u32;
        let [x0, y0, x1, y1] = polygon.cells;
        for y in y0..=y1 {
            for x in x0..=x1 {
                self.cells[y as usize * self.columns as usize + x as usize].push(number);
            }
        }
        self.waiting.push(Farness { far: polygon.far, facet: setup.facet, polygon: number });
        self.briefs.push(Brief { cell: [x0, y0], far: polygon.far, state: State::Waiting });
        self.polygons.push(polygon);
    }

    /// Finds the order.
    fn sort(&mut self) -> Result<(), Limit> {
        self.execution.budget.begin("polygons", self.polygons.len() as u64);
        while let Some(place) = self.waiting.pop() {
            if self.briefs[place.polygon as usize].state == State::Waiting {
                self.mark(place.polygon);
                self.paint_marked()?;
                self.tidy();
            }
        }
        Ok(())
    }

    /// Notes that a polygon is painted or split.
    fn finish(&mut self, polygon: u32, state: State) {
        self.briefs[polygon as usize].state = state;
        let [x0, y0, x1, y1] = self.polygons[polygon as usize].cells;
        for y in y0..=y1 {
            for x in x0..=x1 {
                let cell = y as usize * self.columns as usize + x as usize;
                self.done[cell] += 1;
                if self.done[cell] as usize * 2 > self.cells[cell].len() {
                    self.stale.push(cell as u32);
                }
            }
        }
    }

    /// Takes what is done out of the cells' lists. While polygons are marked, their places in the lists must not move.
    fn tidy(&mut self) {
        for cell in self.stale.drain(..) {
            let done = &mut self.done[cell as usize];
            if *done > 0 {
                *done = 0;
                let pending = |p: &u32| matches!(self.briefs[*p as usize].state, State::Waiting | State::Marked);
                self.cells[cell as usize].retain(pending);
            }
        }
    }

    fn mark(&mut self, polygon: u32) {
        self.briefs[polygon as usize].state = State::Marked;
        let [x0, y0, ..] = self.polygons[polygon as usize].cells;
        self.marked.push(Marked { polygon, cell: [x0, y0], at: 0 });
    }

    /// Paints the marked polygons, and whatever has to come before them.
    fn paint_marked(&mut self) -> Result<(), Limit> {
        let mut steps = 0u32;
        while let Some(&top) = self.marked.last() {
            steps += 1;
            if steps % 64 == 1 {
                self.account()?;
            }
            let Some((other, verdict)) = self.obstacle()? else {
                self.finish(top.polygon, State::Painted);
                self.painted.push(top.polygon);
                self.execution.budget.advance();
                self.marked.pop();
                continue;
            };
            let solved = match (verdict, self.briefs[other as usize].state) {
                (Verdict::After, State::Marked) => self.cut_cycle(other),
                (Verdict::After, _) => {
                    self.counters.reordered += 1;
                    let [facet, before] = [other, top.polygon].map(|p| self.facet(p));
                    self.execution.tell(|| Step::Moved { facet, before });
                    self.mark(other);
                    true
                }
                _ => self.split_at_plane(top.polygon, other),
            };
            // No line splits them clearly: they are as good as in order.
            if !solved && let Some(top) = self.marked.last_mut() {
                top.at += 1;
            }
        }
        Ok(())
    }

    /// Goes on with the comparisons of the last marked polygon, until one says that it cannot be painted yet.
    fn obstacle(&mut self) -> Result<Option<(u32, Verdict)>, Limit> {
        let Some(top) = self.marked.last_mut() else { return Ok(None) };
        let p = &self.polygons[top.polygon as usize];
        let [x0, y0, x1, y1] = p.cells;
        loop {
            let list = &self.cells[top.cell[1] as usize * self.columns as usize + top.cell[0] as usize];
            while let Some(&other) = list.get(top.at as usize) {
                let brief = &self.briefs[other as usize];
                // Two polygons are compared in the first cell that both are in.
                let here = [0, 1].map(|k| p.cells[k].max(brief.cell[k])) == top.cell;
                let pending = matches!(brief.state, State::Waiting | State::Marked);
                if here && pending && other != top.polygon && !p.is_behind(brief.far, self.counters) {
                    let q = &self.polygons[other as usize];
                    let verdict = compare(p, q, self.setups, &self.corners, self.counters);
                    if verdict != Verdict::Before {
                        return Ok(Some((other, verdict)));
                    }
                }
                top.at += 1;
            }
            // On to the next cell.
            top.at = 0;
            top.cell[0] += 1;
            if top.cell[0] > x1 {
                self.execution.budget.check("the painter's list")?;
                top.cell = [x0, top.cell[1] + 1];
                if top.cell[1] > y1 {
                    top.cell[1] = y0;
                    return Ok(None);
                }
            }
        }
    }

    fn facet(&self, polygon: u32) -> u32 {
        self.setups[self.polygons[polygon as usize].setup as usize].facet
    }

    /// Splits the last marked polygon where its plane meets that of another.
    fn split_at_plane(&mut self, polygon: u32, other: u32) -> bool {
        let [p, q] = [polygon, other].map(|i| self.setups[self.polygons[i as usize].setup as usize]);
        crossing(p, q).is_some_and(|line| self.split(self.marked.len() - 1, line))
    }

    /// Cuts the circle of marked polygons that begins at `start`: somewhere along it, one is split by its neighbour.
    fn cut_cycle(&mut self, start: u32) -> bool {
        self.counters.cycles += 1;
        let first = self.marked.iter().position(|m| m.polygon == start).unwrap_or(0);
        let last = self.marked.len() - 1;
        let circle = || self.marked[first..].iter().map(|m| self.facet(m.polygon)).collect();
        self.execution.tell(|| Step::Circle { facets: circle() });
        // Each has to be painted after the next one, and the last after the first.
        for place in (first..=last).rev() {
            let next = if place == last { first } else { place + 1 };
            for (split, by) in [(place, next), (next, place)] {
                let [p, q] = [split, by].map(|i| self.marked[i].polygon as usize);
                let [ps, qs] = [p, q].map(|i| self.setups[self.polygons[i].setup as usize]);
                let lines = crossing(ps, qs).into_iter().chain(self.polygons[q].edges(&self.corners));
                let lines: Vec<_> = lines.collect();
                if lines.into_iter().any(|line| self.split(split, line)) {
                    return true;
                }
            }
        }
        false
    }

    /// Splits a marked polygon along a line, if it lies clearly on both sides. Those marked after it have to wait again.
    fn split(&mut self, place: usize, line: Cut) -> bool {
        let number = self.marked[place].polygon as usize;
        let polygon = self.polygons[number].clone();
        let Some(halves) = polygon.split(&self.corners, &line) else { return false };
        self.counters.splits += 1;
        let facet = self.facet(number as u32);
        self.execution.tell(|| Step::Split { facet, line: [line.a, line.b, line.c] });
        self.finish(number as u32, State::Split);
        for left in self.marked.drain(place..) {
            let state = &mut self.briefs[left.polygon as usize].state;
            if *state == State::Marked {
                *state = State::Waiting;
                let waiting = &self.polygons[left.polygon as usize];
                let facet = self.setups[waiting.setup as usize].facet;
                self.waiting.push(Farness { far: waiting.far, facet, polygon: left.polygon });
            }
        }
        for (corners, cut) in halves.iter().zip([line, line.opposite()]) {
            let first = self.cuts.len() as u32;
            self.cuts.extend_from_within(polygon.cuts.start as usize..polygon.cuts.end as usize);
            self.cuts.push(cut);
            self.add(polygon.setup, corners, first..self.cuts.len() as u32);
        }
        true
    }

    /// Charges what the splits have added, and looks at the clock.
    fn account(&mut self) -> Result<(), Limit> {
        let budget = &self.execution.budget;
        budget.check("the painter's list")?;
        let now = self.polygons.len() as u64 * BYTES_A_POLYGON + (self.cuts.len() * size_of::<Cut>()) as u64;
        if now > self.charged + (1 << 16) {
            budget.charge(now - self.charged, "the painter's list")?;
            self.charged = now;
        }
        Ok(())
    }

    /// The painted polygons in order, as pieces of facets.
    fn list(&self) -> Pieces {
        let mut list = Pieces::default();
        for &number in &self.painted {
            let polygon = &self.polygons[number as usize];
            let cuts = &self.cuts[polygon.cuts.start as usize..polygon.cuts.end as usize];
            let setup = self.setups[polygon.setup as usize];
            let order = list.len() as u32;
            let Some(footprint) = self.raster.footprint(setup) else { continue };
            if list.add(polygon.setup, (setup, footprint), cuts.iter().copied(), &self.raster) {
                self.execution.tell(|| piece_step(order, setup, cuts));
            }
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
        let [a, b, c] = [0, 1, 2].map(|i| CornerPosition { x: corners[i][0] * 256, y: corners[i][1] * 256, z: z[i] });
        Setup::new([a, b, c], Setup::doubled_area(a, b, c), facet)
    }

    /// The facets in the order in which they are painted, and the counters.
    fn order(setups: &[Setup]) -> (Vec<u32>, VisibilityCounters) {
        let setups: Vec<_> = setups.iter().collect();
        let (execution, mut counters) = (Execution::default(), VisibilityCounters::default());
        let pattern = SamplePattern::new(1);
        let raster = Raster::new(Viewport::new(64, 64).unwrap(), &pattern);
        let mut sorting = Sorting::new(&setups, raster, &execution, &mut counters).unwrap();
        sorting.sort().unwrap();
        let painted = sorting.painted.iter().map(|&p| setups[sorting.polygons[p as usize].setup as usize].facet);
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
        let (painted, counters) = order(&[triangle(LARGE, [0.2, 0.8, 0.2], 0), triangle(LARGE, [0.8, 0.2, 0.8], 1)]);
        assert_eq!((painted.len(), counters.splits), (3, 1));
    }

    #[test]
    fn p21_a_circle_is_cut() {
        // Three bars on the screen, each far at one end and near at the other.
        let bar = |a: [i32; 2], b: [i32; 2], c: [i32; 2], facet| triangle([a, b, c], [0.2, 0.8, 0.8], facet);
        let (painted, counters) = order(&[
            bar([2, 20], [60, 18], [60, 24], 0),
            bar([50, 2], [36, 60], [30, 58], 1),
            bar([44, 58], [10, 4], [16, 2], 2),
        ]);
        assert!(counters.cycles >= 1 && counters.splits >= 1, "{counters:?}");
        assert_eq!(painted.len(), 3 + counters.splits as usize);
    }
}
