//! Regions of the screen with any number of parts and holes, cut exactly.
//!
//! Weiler and Atherton walk along the outline of one polygon until it meets the other, and turn
//! there. What makes this hard are the degenerate cases: corners on edges, edges along edges, and
//! rounded crossings that are not on either. Here a region is the set of its boundary's edges, each
//! directed with the region on the positive side of its line. Lines have whole coefficients, and
//! points are crossings of lines, compared exactly (`line.rs`). Clipping by a convex polygon then
//! needs no cases:
//!
//! - An edge of the region is cut where it enters and leaves the clipping polygon: the middle
//!   bounds the inside, the rest the outside. What lies along an edge of the clipping polygon is
//!   dropped.
//! - Along an edge of the clipping polygon, the region is met in intervals. Infinitely little to
//!   the inner side of the edge, the crossings with the region's boundary begin and end the
//!   intervals that bound the inside; infinitely little to the outer side, those that bound the
//!   outside, turned round. Where an edge is crossed nowhere, one of its ends is looked at.
//!
//! Holes need no bookkeeping: where a polygon lies in the middle of a region, its edges, turned
//! round, are the hole. A point belongs to the region if a ray from it crosses the boundary an odd
//! number of times. Outlines are walked when they are asked for. An edge that does not touch the
//! clipping polygon's box stays as it is and is not looked at, in a region that has many.
//!
//! In:   regions and convex polygons, 1/256 pixel. Out: the part inside and the part outside.
//! Cost: edges of the region near the polygon, times edges of the polygon.
//! Source: [Weiler & Atherton 1977], [Weiler 1980].

use super::edge_index::EdgeIndex;
use super::line::{Line, Point, ROUNDING, RegionEdge};
use std::cmp::Ordering;
use vitral_raster::SUBPIXEL;

/// Edges up to which all of a region are clipped: a search for those near the clipping polygon
/// takes longer.
const SMALL: usize = 8;
/// Edges up to which a region's box is found anew when it was cut.
const BOUNDED: usize = 32;
/// Edges from which on a region has an index of them.
const INDEX_THRESHOLD: usize = 256;

/// A convex polygon to clip with: its corners, and the line from each to the next, positive inside.
/// A half-plane has no corners.
#[derive(Clone, Debug)]
pub(super) struct ConvexOutline {
    lines: Vec<Line>,
    corners: Vec<[i32; 2]>,
    /// Smallest x and y, largest x and y.
    pub(super) bounds: [f64; 4],
}

impl ConvexOutline {
    /// A polygon of grid points that run so that the inner side is positive. Corners on a straight
    /// line are left out.
    pub(super) fn polygon(outline: &[[i32; 2]]) -> Self {
        let count = outline.len();
        let turns = |i: usize| {
            let [before, here, after] = [count - 1, 0, 1].map(|k| outline[(i + k) % count]);
            Line::through(before, here).cross(&Line::through(here, after)) != 0
        };
        let corners: Vec<_> = (0..count).filter(|&i| turns(i)).map(|i| outline[i]).collect();
        let next = |i: usize| corners[(i + 1) % corners.len()];
        let lines = (0..corners.len()).map(|i| Line::through(corners[i], next(i))).collect();
        let bounds = bounds(corners.iter().map(|c| c.map(f64::from)));
        Self { lines, corners, bounds }
    }

    /// The positive side of a line.
    pub(super) fn half_plane(line: Line) -> Self {
        let far = f64::INFINITY;
        Self { lines: vec![line], corners: Vec::new(), bounds: [-far, -far, far, far] }
    }

    /// Its corners, 1/256 pixel.
    pub(super) fn corners(&self) -> &[[i32; 2]] {
        &self.corners
    }

    /// Where a side begins and ends, if it does.
    fn ends(&self, side: usize) -> Option<[Point; 2]> {
        let count = self.corners.len();
        let corner = |i: usize| {
            Point::corner(self.corners[i], [self.lines[(i + count - 1) % count], self.lines[i]])
        };
        (count > 0).then(|| [corner(side), corner((side + 1) % count)])
    }

    /// Whether it may have an area in common with something in a box.
    pub(super) fn touches(&self, around: [f64; 4]) -> bool {
        overlap(self.bounds, around)
    }

    /// Whether a box is inside.
    fn holds_box(&self, [x0, y0, x1, y1]: [f64; 4]) -> bool {
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        self.lines.iter().all(|line| corners.iter().all(|&c| line.about(c) > line.slack()))
    }

    /// A box round what this and another polygon have in common, a little too large.
    fn common_box(
        &self,
        other: &Self,
        [outline, clipped]: &mut [Vec<[f64; 2]>; 2],
    ) -> Option<[f64; 4]> {
        // Clip the outline by the other's lines, with some slack.
        outline.clear();
        outline.extend(self.corners.iter().map(|c| c.map(f64::from)));
        for line in &other.lines {
            clipped.clear();
            let slack = line.slack();
            for (i, &p) in outline.iter().enumerate() {
                let q = outline[(i + 1) % outline.len()];
                let [here, there] = [p, q].map(|p| line.about(p) + slack);
                if here >= 0.0 {
                    clipped.push(p);
                }
                if (here >= 0.0) != (there >= 0.0) {
                    let t = here / (here - there);
                    clipped.push([0, 1].map(|k| p[k] + (q[k] - p[k]) * t));
                }
            }
            std::mem::swap(outline, clipped);
            if outline.is_empty() {
                return None;
            }
        }

        // Bound the clipped outline.
        let [x0, y0, x1, y1] = bounds(outline.iter().copied());
        Some([x0 - 1.0, y0 - 1.0, x1 + 1.0, y1 + 1.0])
    }
}

/// Smallest x and y, largest x and y.
fn bounds(points: impl Iterator<Item = [f64; 2]>) -> [f64; 4] {
    let empty = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    points.fold(empty, |b, [x, y]| [b[0].min(x), b[1].min(y), b[2].max(x), b[3].max(y)])
}

/// Whether two boxes may have an area in common.
pub(super) fn overlap(a: [f64; 4], b: [f64; 4]) -> bool {
    (0..2).all(|k| a[k] < b[k + 2] + ROUNDING && b[k] < a[k + 2] + ROUNDING)
}

/// A part of the screen.
#[derive(Clone, Debug, Default)]
pub(super) struct Region {
    /// Those that the index has removed among them.
    edges: Vec<RegionEdge>,
    index: Option<Box<EdgeIndex>>,
    /// Smallest x and y, largest x and y, or a little more.
    bounds: [f64; 4],
}

/// What a polygon leaves of a region.
#[derive(Debug)]
pub(super) enum Clipped {
    /// All is inside. The region is as it was.
    Inside,
    /// All is outside. The region is as it was.
    Outside,
    /// This is inside; the region has become the part outside.
    Both(Region),
}

/// An outline of a region.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RegionOutline {
    /// Whether the region lies around it.
    pub(super) is_hole: bool,
    /// 1/256 pixel. Clockwise on the screen, a hole the other way round.
    pub(super) corners: Vec<[f64; 2]>,
}

/// An edge as filling needs it: it is crossed at whole `y` of this range, 1/256 pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct FillEdge {
    pub(super) line: Line,
    /// First, and the one behind the last.
    pub(super) y: [i32; 2],
}

/// Memory that clips have in common.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    /// Numbers of the edges near the polygon.
    near: Vec<u32>,
    /// Outlines while they are clipped.
    outlines: [Vec<[f64; 2]>; 2],
    /// On which side of the polygon's lines their ends lie, line by line.
    sides: Vec<[Ordering; 2]>,
    /// Where a line enters (1) or leaves (-1) the region.
    crossings: Vec<(Point, i32)>,
    /// Edges that the polygon cuts or holds.
    removed: Vec<u32>,
    inside: Vec<RegionEdge>,
    outside: Vec<RegionEdge>,
}

impl Region {
    /// A convex polygon.
    pub(super) fn polygon(polygon: &ConvexOutline) -> Self {
        let side = |i: usize| polygon.ends(i).map(|ends| RegionEdge::new(polygon.lines[i], ends));
        Self {
            edges: (0..polygon.lines.len()).filter_map(side).collect(),
            index: None,
            bounds: polygon.bounds,
        }
    }

    fn of(edges: &[RegionEdge]) -> Self {
        let bounds = bounds(edges.iter().flat_map(|e| e.about));
        Self { edges: edges.to_vec(), index: None, bounds }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.edge_count() == 0
    }

    fn edge_count(&self) -> usize {
        self.index.as_ref().map_or(self.edges.len(), |index| index.len())
    }

    /// Smallest x and y, largest x and y of a box around it.
    pub(super) fn bounds(&self) -> [f64; 4] {
        self.bounds
    }

    /// Its boundary, in no order.
    pub(super) fn edges(&self) -> impl Iterator<Item = &RegionEdge> {
        let index = self.index.as_deref();
        let is_there = move |i: usize| index.is_none_or(|index| index.has(i));
        self.edges.iter().enumerate().filter(move |(i, _)| is_there(*i)).map(|(_, edge)| edge)
    }

    /// Bytes in memory, about.
    pub(super) fn bytes(&self) -> usize {
        self.edges.capacity() * size_of::<RegionEdge>()
            + self.index.as_ref().map_or(0, |index| index.bytes())
    }

    /// Clips by a convex polygon. The region is a part of `whole`.
    pub(super) fn clip(
        &mut self,
        polygon: &ConvexOutline,
        whole: &ConvexOutline,
        work: &mut Workspace,
    ) -> Clipped {
        // Reject by boxes.
        if !polygon.touches(self.bounds) {
            return Clipped::Outside;
        }
        work.near.clear();
        let is_all = self.index.is_none() && self.edges.len() <= SMALL;
        if is_all {
            work.near.extend(0..self.edges.len() as u32);
        } else {
            // Take the edges near the polygon.
            if polygon.holds_box(self.bounds) {
                return Clipped::Inside;
            }
            let Some(common) = whole.common_box(polygon, &mut work.outlines) else {
                return Clipped::Outside;
            };
            if self
                .index
                .as_ref()
                .map_or(self.edges.len() > INDEX_THRESHOLD, |index| index.is_stale())
            {
                self.make_index();
            }
            match &self.index {
                Some(index) => index.near(&self.edges, common, &mut work.near),
                None => work.near.extend(
                    (0..).zip(&self.edges).filter(|(_, e)| e.touches(common)).map(|(i, _)| i),
                ),
            }
        }

        // Classify the near edges, and cut only if some cross.
        if let Some(trivial) = self.find_sides(polygon, is_all, work) {
            return trivial;
        }
        self.cut(polygon, work)
    }

    /// Finds on which side of the polygon's lines the near edges' ends lie, and what follows if
    /// these are all edges.
    fn find_sides(
        &self,
        polygon: &ConvexOutline,
        is_all: bool,
        work: &mut Workspace,
    ) -> Option<Clipped> {
        let mut within = true;
        work.sides.clear();
        // Classify both ends of each near edge.
        for line in &polygon.lines {
            let mut front = false;
            for &i in &work.near {
                let edge = &self.edges[i as usize];
                let sides = [line.side(&edge.end(0)), line.side(&edge.end(1))];
                front |= sides.contains(&Ordering::Greater);
                within &= !sides.contains(&Ordering::Less);
                work.sides.push(sides);
            }

            // Stop if all edges lie on the outer side of a line.
            if is_all && !front {
                return Some(Clipped::Outside);
            }
        }
        (is_all && within).then_some(Clipped::Inside)
    }

    /// Cuts the near edges and finds the new ones.
    fn cut(&mut self, polygon: &ConvexOutline, work: &mut Workspace) -> Clipped {
        // Cut each near edge into parts inside, before and behind.
        work.removed.clear();
        work.inside.clear();
        work.outside.clear();
        let count = work.near.len();
        for (at, &number) in work.near.iter().enumerate() {
            let sides = work.sides.iter().skip(at).step_by(count.max(1));
            let cut = EdgeCut::new(&self.edges[number as usize], polygon, sides);
            if let Some([inside, before, behind]) = cut.into_parts() {
                work.removed.push(number);
                work.inside.extend(inside);
                work.outside.extend(before.into_iter().chain(behind));
            }
        }

        // Close both regions along the polygon's sides.
        for side in 0..polygon.lines.len() {
            let line = polygon.lines[side];
            for inner in [true, false] {
                self.intervals(polygon, side, inner, work, |ends, work| {
                    let edge = RegionEdge::new(line, ends);
                    if inner { work.inside.push(edge) } else { work.outside.push(edge.reversed()) }
                });
            }
        }

        // Tell whether one of the two is empty.
        if work.inside.is_empty() {
            return Clipped::Outside;
        }
        if work.outside.is_empty() && work.removed.len() == self.edge_count() {
            return Clipped::Inside;
        }

        // Keep the outside and return the inside.
        self.become_outside(work);
        Clipped::Both(Self::of(&work.inside))
    }

    /// Takes the edges that were cut out, and the new ones in.
    fn become_outside(&mut self, work: &Workspace) {
        // Replace the edges in the index.
        if let Some(index) = &mut self.index {
            work.removed.iter().for_each(|&number| index.remove(number));
            for edge in &work.outside {
                index.push(edge);
                self.edges.push(*edge);
            }
            return;
        }

        // Without an index, replace them in the list and bound the region anew if it is small.
        for &number in work.removed.iter().rev() {
            self.edges.swap_remove(number as usize);
        }
        self.edges.extend(&work.outside);
        if self.edges.len() <= BOUNDED {
            self.bounds = bounds(self.edges.iter().flat_map(|e| e.about));
        }
    }

    fn make_index(&mut self) {
        self.edges = self.edges().copied().collect();
        self.bounds = bounds(self.edges.iter().flat_map(|e| e.about));
        self.index = Some(Box::new(EdgeIndex::new(&self.edges, self.bounds)));
    }

    /// Where the region is met infinitely little beside a side of a polygon, on its inner or outer
    /// side: from where to where.
    fn intervals(
        &self,
        polygon: &ConvexOutline,
        side: usize,
        inner: bool,
        work: &mut Workspace,
        mut found: impl FnMut([Point; 2], &mut Workspace),
    ) {
        // Find the crossings, in order.
        let (line, ends) = (polygon.lines[side], polygon.ends(side));
        let count = work.near.len();
        let mut crossings = std::mem::take(&mut work.crossings);
        crossings.clear();
        for (&number, &sides) in work.near.iter().zip(&work.sides[side * count..(side + 1) * count])
        {
            // Beside the line, the points on it are on the other side.
            let [from, to] =
                sides.map(|s| if inner { s == Ordering::Greater } else { s != Ordering::Less });
            if from == to {
                continue;
            }
            let edge = &self.edges[number as usize];
            let place = match sides {
                [Ordering::Equal, _] => edge.end(0),
                [_, Ordering::Equal] => edge.end(1),
                _ => line.crossing(&edge.line),
            };
            let is_within = ends.is_none_or(|[first, last]| {
                line.compare(&place, &first) == Ordering::Greater
                    && line.compare(&place, &last) == Ordering::Less
            });
            if is_within {
                crossings.push((place, if line.cross(&edge.line) < 0 { 1 } else { -1 }));
            }
        }
        crossings.sort_by(|one, two| line.compare(&one.0, &two.0));

        // Where parts of the region touch in a point, the line leaves one and enters the other.
        crossings.dedup_by(|next, kept| {
            let same = line.compare(&next.0, &kept.0) == Ordering::Equal;
            kept.1 += if same { next.1 } else { 0 };
            same
        });
        crossings.retain(|crossing| crossing.1 != 0);

        // Decide whether the side begins in the region.
        let starts_within = match (crossings.first(), ends) {
            (Some(first), _) => first.1 < 0,
            (None, Some(_)) => self.holds_beside(polygon.corners[side], &line, inner),
            (None, None) => false,
        };

        // Emit the intervals between entering and leaving.
        let mut from = ends.filter(|_| starts_within).map(|ends| ends[0]);
        for &(place, change) in &crossings {
            if change > 0 {
                from = Some(place);
            } else if let Some(from) = from.take() {
                found([from, place], work);
            }
        }
        if let (Some(from), Some(ends)) = (from, ends) {
            found([from, ends[1]], work);
        }
        work.crossings = crossings;
    }

    /// Whether the region holds a place infinitely little farther than `corner` along a line, and
    /// still less beside it.
    fn holds_beside(&self, corner: [i32; 2], line: &Line, inner: bool) -> bool {
        // Reject corners outside the region's box.
        let place = corner.map(f64::from);
        let [x0, y0, x1, y1] = self.bounds;
        if place[0] < x0 - 1.0 || place[1] < y0 - 1.0 || place[0] > x1 + 1.0 || place[1] > y1 + 1.0
        {
            return false;
        }

        // Order places along the line, and beside it where that decides nothing.
        let axis = self.index.as_ref().map_or(1, |index| index.axis);
        let point = Point::corner(corner, [*line; 2]);
        let along = [line.b, -line.a].map(i64::from);
        let beside = [line.a, line.b].map(|v| if inner { i64::from(v) } else { -i64::from(v) });
        let is_forwards = if along[axis] != 0 { along[axis] > 0 } else { beside[axis] > 0 };

        // Count the edges that a ray along the other axis, to the lower side, crosses.
        let comes_before = |edge: &RegionEdge, end: usize| {
            let gap = edge.about[end][axis] - place[axis];
            if gap.abs() > ROUNDING {
                return gap < 0.0;
            }
            match edge.end(end).compare(&point, axis) {
                Ordering::Less => true,
                Ordering::Equal => is_forwards,
                Ordering::Greater => false,
            }
        };
        let is_crossed = |edge: &RegionEdge| {
            if comes_before(edge, 0) == comes_before(edge, 1) {
                return false;
            }
            let slopes = [edge.line.a, edge.line.b].map(i64::from);
            let change = |way: [i64; 2]| slopes[0] * way[0] + slopes[1] * way[1];
            let values = [edge.line.at(corner), change(along), change(beside)];
            let value = values.into_iter().find(|v| *v != 0).unwrap_or(0);
            (value > 0) == (slopes[1 - axis] > 0)
        };

        // Count the crossings: an odd number means inside.
        let crossed = match &self.index {
            Some(index) => {
                index.across(place[axis]).filter(|&i| is_crossed(&self.edges[i])).count()
            }
            None => self.edges.iter().filter(|edge| is_crossed(edge)).count(),
        };
        crossed % 2 == 1
    }

    /// The area, in square pixels of 256 x 256.
    pub(super) fn area(&self) -> f64 {
        let doubled = |e: &RegionEdge| {
            let [[x0, y0], [x1, y1]] = e.about;
            x0 * y1 - y0 * x1
        };
        self.edges().map(doubled).sum::<f64>() / 2.0 / f64::from(SUBPIXEL * SUBPIXEL)
    }

    /// The edges as filling needs them.
    pub(super) fn fill_edges(&self) -> impl Iterator<Item = FillEdge> {
        self.edges().filter(|edge| edge.line.a != 0).filter_map(|edge| {
            let [one, two] = [edge.end(0).y_up(), edge.end(1).y_up()];
            (one != two).then(|| FillEdge { line: edge.line, y: [one.min(two), one.max(two)] })
        })
    }

    /// The outlines, walked, those around the region before its holes. Where several edges leave a
    /// point, the walk takes the one that turns most towards the region, so that outlines touch but
    /// do not cross.
    pub(super) fn outlines(&self) -> Vec<RegionOutline> {
        // Sort the edges by where they begin.
        let mut edges: Vec<(Point, RegionEdge)> =
            self.edges().map(|edge| (edge.end(0), *edge)).collect();
        edges.sort_by(|one, two| one.0.compare_both(&two.0));

        // Walk one boundary from each edge that is not walked.
        let mut is_walked = vec![false; edges.len()];
        let mut outlines = Vec::new();
        for start in 0..edges.len() {
            if is_walked[start] {
                continue;
            }
            let (mut walk, mut at) = (vec![edges[start].1], start);
            is_walked[start] = true;
            loop {
                let edge = edges[at].1;
                let end = edge.end(1);
                let first =
                    edges.partition_point(|(begin, _)| begin.compare_both(&end) == Ordering::Less);
                let leaving = (first..edges.len())
                    .take_while(|&i| edges[i].0.compare_both(&end) == Ordering::Equal)
                    .filter(|&i| !is_walked[i]);
                let next = leaving
                    .max_by(|&i, &j| turn(&edge, &edges[i].1).total_cmp(&turn(&edge, &edges[j].1)));
                // A boundary is closed: the walk ends where it began.
                let Some(next) =
                    next.filter(|_| end.compare_both(&edges[start].0) != Ordering::Equal)
                else {
                    break;
                };
                is_walked[next] = true;
                walk.push(edges[next].1);
                at = next;
            }
            outlines.push(outline(&walk));
        }

        // Put holes last.
        outlines.sort_by_key(|outline| outline.is_hole);
        outlines
    }
}

/// How far an edge turns towards the region from another that ends where it begins, radians.
fn turn(edge: &RegionEdge, next: &RegionEdge) -> f64 {
    let [[dx, dy], [ex, ey]] = [edge, next].map(|e| [f64::from(e.line.b), -f64::from(e.line.a)]);
    vitral_math::func::atan2(dx * ey - dy * ex, dx * ex + dy * ey)
}

/// The outline of edges that were walked. Edges along one line are one.
fn outline(walk: &[RegionEdge]) -> RegionOutline {
    let before = walk.iter().cycle().skip(walk.len() - 1);
    let bends = walk.iter().zip(before).filter(|(edge, before)| turn(before, edge) != 0.0);
    let corners: Vec<_> = bends.map(|(edge, _)| edge.about[0]).collect();
    let doubled = |([x0, y0], [x1, y1]): (&[f64; 2], &[f64; 2])| x0 * y1 - y0 * x1;
    let area: f64 = corners.iter().zip(corners.iter().cycle().skip(1)).map(doubled).sum();
    RegionOutline { is_hole: area < 0.0, corners }
}

/// An edge cut where it enters and leaves a polygon.
struct EdgeCut {
    edge: RegionEdge,
    /// From where to where it is within, or along a side.
    ends: [Point; 2],
    /// Whether these are not its own ends.
    is_cut: [bool; 2],
    is_along: bool,
    is_outside: bool,
}

impl EdgeCut {
    /// `sides`: on which side of the polygon's lines the edge's ends lie.
    fn new<'s>(
        edge: &RegionEdge,
        polygon: &ConvexOutline,
        sides: impl Iterator<Item = &'s [Ordering; 2]>,
    ) -> Self {
        use Ordering::{Equal, Greater, Less};

        // Start with the whole edge.
        let own = [edge.end(0), edge.end(1)];
        let mut cut =
            Self { edge: *edge, ends: own, is_cut: [false; 2], is_along: false, is_outside: false };

        // Cut it at each line of the polygon.
        for (line, sides) in polygon.lines.iter().zip(sides) {
            match sides {
                [Equal, Equal] => cut.is_along = true,
                [Less | Equal, Less | Equal] => {
                    cut.is_outside = true;
                    return cut;
                }
                [Less, Greater] => {
                    let enters = edge.line.crossing(line);
                    if edge.line.compare(&enters, &cut.ends[0]) == Greater {
                        (cut.ends[0], cut.is_cut[0]) = (enters, true);
                    }
                }
                [Greater, Less] => {
                    let leaves = edge.line.crossing(line);
                    if edge.line.compare(&leaves, &cut.ends[1]) == Less {
                        (cut.ends[1], cut.is_cut[1]) = (leaves, true);
                    }
                }
                _ => {}
            }
        }

        // Drop an edge of which nothing is left.
        cut.is_outside = edge.line.compare(&cut.ends[0], &cut.ends[1]) != Less;
        cut
    }

    /// The part within the polygon, if it is not along one of its sides, and those before and
    /// behind it; `None` if all is outside.
    fn into_parts(self) -> Option<[Option<RegionEdge>; 3]> {
        let Self { edge, ends, is_cut, is_along, is_outside } = self;
        let part = |ends: [Point; 2]| RegionEdge::new(edge.line, ends);
        (!is_outside).then(|| {
            [
                (!is_along).then(|| part(ends)),
                is_cut[0].then(|| part([edge.end(0), ends[0]])),
                is_cut[1].then(|| part([ends[1], edge.end(1)])),
            ]
        })
    }
}

#[cfg(test)]
mod tests;
