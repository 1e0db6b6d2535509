//! Regions of the screen with any number of parts and holes, cut exactly.
//!
//! Weiler and Atherton walk along the outline of one polygon until it meets the other, and turn there. What makes this
//! hard are the degenerate cases: corners on edges, edges along edges, and rounded crossings that are not on either.
//! Here a region is the set of its boundary's edges, each directed with the region on the positive side of its line.
//! Lines have whole coefficients; the ends of an edge are crossings of lines, kept as fractions of whole numbers, so that
//! the side of a line on which a crossing lies is known exactly. Clipping by a convex polygon then needs no cases:
//!
//! - An edge of the region is cut where it enters and leaves the clipping polygon: the middle bounds the inside, the rest
//!   the outside. What lies along an edge of the clipping polygon is dropped.
//! - Along an edge of the clipping polygon, the region is met in intervals. Infinitely little to the inner side of the
//!   edge, the crossings with the region's boundary begin and end the intervals that bound the inside; infinitely little
//!   to the outer side, those that bound the outside, turned round.
//!
//! Holes need no bookkeeping: where a polygon lies in the middle of a region, its edges, turned round, are the hole.
//! A point belongs to the region if a ray from it crosses the boundary an odd number of times. Filling
//! samples and clipping need no more; only the tests walk along outlines.
//!
//! In:   regions and convex polygons, 1/256 pixel from the corner of a window. Out: the part inside and the part outside.
//! Cost: edges of the region times edges of the polygon. Numbers stay below 2^115: ends are crossings of two of the lines
//! that came in, never of crossings.
//! Source: [Weiler & Atherton 1977], [Weiler 1980]; points as crossings after [Bernstein & Fussell 2009].

use std::cmp::Ordering;
use vitral_raster::{SUBPIXEL, SamplePattern, TILE};

/// `a x + b y + c`, positive on the inner side. The edge runs in the direction `(b, -a)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line {
    pub(super) a: i64,
    pub(super) b: i64,
    pub(super) c: i64,
}

/// The point `(x / w, y / w)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    x: i128,
    y: i128,
    /// Positive.
    w: i128,
    /// About where it is.
    pub(super) about: [f64; 2],
}

/// Beyond this, in 1/256 pixel, the rounding of [`Point::about`] cannot matter.
const ROUNDING: f64 = 1e-6;

impl Point {
    /// A point of the grid.
    fn whole([x, y]: [i64; 2]) -> Self {
        Self { x: x.into(), y: y.into(), w: 1, about: [x as f64, y as f64] }
    }

    /// Compares x (`axis` 0) or y.
    fn compare(&self, other: &Self, axis: usize) -> Ordering {
        let gap = self.about[axis] - other.about[axis];
        if gap.abs() > ROUNDING {
            return gap.total_cmp(&0.0);
        }
        let [one, two] = [self, other].map(|p| if axis == 0 { p.x } else { p.y });
        (one * other.w).cmp(&(two * self.w))
    }

    /// Whether it lies below the line `y`.
    fn is_below(&self, y: i32) -> bool {
        let gap = self.about[1] - f64::from(y);
        if gap.abs() > ROUNDING { gap > 0.0 } else { self.y > i128::from(y) * self.w }
    }
}

impl Line {
    /// The line through two points of the grid.
    fn through(from: [i64; 2], to: [i64; 2]) -> Self {
        let [dx, dy] = [0, 1].map(|k| to[k] - from[k]);
        Self { a: -dy, b: dx, c: dy * from[0] - dx * from[1] }
    }

    fn reversed(self) -> Self {
        Self { a: -self.a, b: -self.b, c: -self.c }
    }

    /// On which side a point lies.
    fn side(&self, p: &Point) -> Ordering {
        let (a, b) = (self.a as f64, self.b as f64);
        let value = a * p.about[0] + b * p.about[1] + self.c as f64;
        // Rounding of the point, and of the sum, whose parts may be large.
        let slack = (a.abs() + b.abs()) * ROUNDING + (self.c as f64).abs() * 1e-14;
        if value.abs() > slack {
            return value.total_cmp(&0.0);
        }
        (i128::from(self.a) * p.x + i128::from(self.b) * p.y + i128::from(self.c) * p.w).cmp(&0)
    }

    /// Where two lines that are not parallel cross.
    fn crossing(&self, other: &Self) -> Point {
        let [a, b, c] = [self.a, self.b, self.c].map(i128::from);
        let [d, e, f] = [other.a, other.b, other.c].map(i128::from);
        let (x, y, w) = (b * f - e * c, c * d - f * a, a * e - d * b);
        let (x, y, w) = if w < 0 { (-x, -y, -w) } else { (x, y, w) };
        Point { x, y, w, about: [x as f64 / w as f64, y as f64 / w as f64] }
    }

    /// Which of two points on the line comes first.
    fn compare(&self, one: &Point, two: &Point) -> Ordering {
        let (axis, forwards) = if self.b.abs() >= self.a.abs() { (0, self.b > 0) } else { (1, self.a < 0) };
        let order = one.compare(two, axis);
        if forwards { order } else { order.reverse() }
    }
}

/// A piece of a boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    line: Line,
    pub(super) ends: [Point; 2],
}

impl Edge {
    fn reversed(self) -> Self {
        Self { line: self.line.reversed(), ends: [self.ends[1], self.ends[0]] }
    }
}

/// A convex polygon to clip with: the lines along its edges, and where each begins and ends.
#[derive(Clone, Debug)]
pub(super) struct Convex {
    sides: Vec<(Line, Option<[Point; 2]>)>,
    /// Smallest x and y, largest x and y.
    bounds: [f64; 4],
}

impl Convex {
    /// A polygon of grid points that run so that the inner side is positive.
    pub(super) fn polygon(corners: &[[i64; 2]]) -> Self {
        let region = Region::polygon(corners);
        Self { sides: region.edges.iter().map(|e| (e.line, Some(e.ends))).collect(), bounds: region.bounds() }
    }

    /// The positive side of a line.
    pub(super) fn half_plane(line: Line) -> Self {
        let far = f64::INFINITY;
        Self { sides: vec![(line, None)], bounds: [-far, -far, far, far] }
    }

    fn touches(&self, [x0, y0, x1, y1]: [f64; 4]) -> bool {
        let [left, top, right, bottom] = self.bounds;
        x0 < right + ROUNDING && left < x1 + ROUNDING && y0 < bottom + ROUNDING && top < y1 + ROUNDING
    }
}

/// A part of the screen.
#[derive(Clone, Debug, Default)]
pub(super) struct Region {
    pub(super) edges: Vec<Edge>,
}

/// What a polygon leaves of a region.
pub(super) enum Clipped {
    /// All is inside.
    Inside,
    /// All is outside.
    Outside,
    /// The parts inside and outside; either may be empty.
    Both(Region, Region),
}

impl Region {
    /// A polygon of grid points that run so that the inner side is positive.
    pub(super) fn polygon(corners: &[[i64; 2]]) -> Self {
        let next = |i: usize| corners[(i + 1) % corners.len()];
        let edge = |i: usize| Edge {
            line: Line::through(corners[i], next(i)),
            ends: [Point::whole(corners[i]), Point::whole(next(i))],
        };
        Self { edges: (0..corners.len()).map(edge).collect() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// Smallest x and y, largest x and y.
    pub(super) fn bounds(&self) -> [f64; 4] {
        let empty = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        self.edges.iter().fold(empty, |b, e| {
            let [x, y] = e.ends[0].about;
            [b[0].min(x), b[1].min(y), b[2].max(x), b[3].max(y)]
        })
    }

    /// Clips by a convex polygon. `bounds` are the region's.
    pub(super) fn clip(&self, bounds: [f64; 4], polygon: &Convex) -> Clipped {
        if !polygon.touches(bounds) {
            return Clipped::Outside;
        }
        // Trivial cases: all corners inside, or all beyond one side.
        let mut within = true;
        for (line, _) in &polygon.sides {
            let (mut front, mut back) = (false, false);
            for edge in &self.edges {
                match line.side(&edge.ends[0]) {
                    Ordering::Greater => front = true,
                    Ordering::Less => back = true,
                    Ordering::Equal => {}
                }
            }
            if !front {
                return Clipped::Outside;
            }
            within &= !back;
        }
        if within {
            return Clipped::Inside;
        }
        let (mut inside, mut outside) = (Self::default(), Self::default());
        for edge in &self.edges {
            cut_edge(edge, polygon, &mut inside, &mut outside);
        }
        for (line, ends) in &polygon.sides {
            let bounding = |interval: [Point; 2]| {
                let ends = ends.map_or(interval, |[from, to]| {
                    let later = line.compare(&interval[0], &from) == Ordering::Less;
                    let sooner = line.compare(&interval[1], &to) == Ordering::Greater;
                    [if later { from } else { interval[0] }, if sooner { to } else { interval[1] }]
                });
                (line.compare(&ends[0], &ends[1]) == Ordering::Less).then_some(Edge { line: *line, ends })
            };
            inside.edges.extend(self.intervals(line, true).into_iter().filter_map(bounding));
            let outer = self.intervals(line, false).into_iter().filter_map(bounding);
            outside.edges.extend(outer.map(Edge::reversed));
        }
        Clipped::Both(inside, outside)
    }

    /// Where the region is met infinitely little beside a line, on its inner or outer side: from where to where.
    fn intervals(&self, line: &Line, inner: bool) -> Vec<[Point; 2]> {
        let mut crossings = Vec::new();
        for edge in &self.edges {
            let sides = [line.side(&edge.ends[0]), line.side(&edge.ends[1])];
            // Beside the line, the points on it are on the other side.
            let [from, to] = sides.map(|s| if inner { s == Ordering::Greater } else { s != Ordering::Less });
            if from != to {
                crossings.push(match sides {
                    [Ordering::Equal, _] => edge.ends[0],
                    [_, Ordering::Equal] => edge.ends[1],
                    _ => line.crossing(&edge.line),
                });
            }
        }
        crossings.sort_by(|one, two| line.compare(one, two));
        crossings.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
    }

    /// The area, in square pixels of 256 x 256.
    #[cfg(test)]
    pub(super) fn area(&self) -> f64 {
        let doubled = |e: &Edge| {
            let [[x0, y0], [x1, y1]] = e.ends.map(|p| p.about);
            x0 * y1 - y0 * x1
        };
        self.edges.iter().map(doubled).sum::<f64>() / 2.0 / f64::from(SUBPIXEL * SUBPIXEL)
    }

    /// Turns the bits of the window's samples that lie in the region: `rows[sample * TILE + row]`, bit = column.
    /// A sample on an edge counts as one a little to the right, and if that is on it too, a little below: this is the
    /// rule of top and left edges.
    pub(super) fn turn_samples(&self, pattern: &SamplePattern, rows: &mut [u64]) {
        for edge in &self.edges {
            let [top, bottom] = [0, 1].map(|axis| {
                let [one, two] = edge.ends.map(|p| p.about[1]);
                if axis == 0 { one.min(two) } else { one.max(two) }
            });
            let pixel = f64::from(SUBPIXEL);
            let first = ((top - pixel) / pixel).floor().max(0.0) as usize;
            let last = ((bottom + 1.0) / pixel).floor().min(TILE as f64 - 1.0);
            for row in (first..TILE).take_while(|&r| r as f64 <= last) {
                for s in 0..pattern.len() {
                    let [x, y] = pattern.position(s);
                    let y = row as i32 * SUBPIXEL + y;
                    if edge.ends[0].is_below(y) != edge.ends[1].is_below(y) {
                        rows[s * TILE + row] ^= right_of(&edge.line, y, x);
                    }
                }
            }
        }
    }

    /// The outlines, walked: the region lies on the positive side, so holes run the other way. Where several edges leave
    /// a point, the walk takes the one that turns most towards the region, so that outlines touch but do not cross.
    #[cfg(test)]
    pub(super) fn contours(&self) -> Vec<Vec<[f64; 2]>> {
        let same = |p: &Point, q: &Point| (0..2).all(|k| p.compare(q, k) == Ordering::Equal);
        let direction = |e: &Edge| [e.line.b as f64, -e.line.a as f64];
        let mut left: Vec<Edge> = self.edges.clone();
        let mut contours = Vec::new();
        while let Some(first) = left.pop() {
            let (mut contour, mut edge) = (vec![first.ends[0].about], first);
            while !same(&edge.ends[1], &first.ends[0]) {
                let [dx, dy] = direction(&edge);
                let turn = |e: &Edge| {
                    let [ex, ey] = direction(e);
                    vitral_math::func::atan2(dx * ey - dy * ex, dx * ex + dy * ey)
                };
                let leaving = (0..left.len()).filter(|&i| same(&left[i].ends[0], &edge.ends[1]));
                let next = leaving.max_by(|&i, &j| turn(&left[i]).total_cmp(&turn(&left[j])));
                edge = left.swap_remove(next.expect("boundaries are closed"));
                contour.push(edge.ends[0].about);
            }
            contours.push(contour);
        }
        contours
    }
}

/// The columns whose samples at `y` lie right of a line that is not horizontal; `x` is their place in the pixel.
fn right_of(line: &Line, y: i32, x: i32) -> u64 {
    let (a, rest) = (i128::from(line.a), i128::from(line.b) * i128::from(y) + i128::from(line.c));
    let (a, rest) = if a < 0 { (-a, -rest) } else { (a, rest) };
    // Right of it is where a x + rest is not negative.
    let ceil = |n: i128, d: i128| -(-n).div_euclid(d);
    let column = ceil(ceil(-rest, a) - i128::from(x), SUBPIXEL.into());
    match column {
        ..=0 => u64::MAX,
        1..64 => u64::MAX << column,
        _ => 0,
    }
}

/// Hands the part of an edge within a polygon to `inside`, if it is not along the polygon's own, and the rest to `outside`.
fn cut_edge(edge: &Edge, polygon: &Convex, inside: &mut Region, outside: &mut Region) {
    let [mut from, mut to] = edge.ends;
    let (mut along, mut cut) = (false, [false; 2]);
    for (line, _) in &polygon.sides {
        use Ordering::{Equal, Greater, Less};
        match edge.ends.map(|p| line.side(&p)) {
            [Equal, Equal] => along = true,
            [Less | Equal, Less | Equal] => return outside.edges.push(*edge),
            [Less, Greater] => {
                let enters = edge.line.crossing(line);
                if edge.line.compare(&enters, &from) == Greater {
                    (from, cut[0]) = (enters, true);
                }
            }
            [Greater, Less] => {
                let leaves = edge.line.crossing(line);
                if edge.line.compare(&leaves, &to) == Less {
                    (to, cut[1]) = (leaves, true);
                }
            }
            _ => {}
        }
    }
    if edge.line.compare(&from, &to) != Ordering::Less {
        return outside.edges.push(*edge);
    }
    if cut[0] {
        outside.edges.push(Edge { ends: [edge.ends[0], from], ..*edge });
    }
    if cut[1] {
        outside.edges.push(Edge { ends: [to, edge.ends[1]], ..*edge });
    }
    if !along {
        inside.edges.push(Edge { ends: [from, to], ..*edge });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In pixels; corners run clockwise as one looks at the screen.
    fn grid(corners: &[[i64; 2]]) -> Vec<[i64; 2]> {
        corners.iter().map(|c| c.map(|v| v * 256)).collect()
    }

    fn region(corners: &[[i64; 2]]) -> Region {
        Region::polygon(&grid(corners))
    }

    fn clip(region: &Region, corners: &[[i64; 2]]) -> [Region; 2] {
        match region.clip(region.bounds(), &Convex::polygon(&grid(corners))) {
            Clipped::Inside => [region.clone(), Region::default()],
            Clipped::Outside => [Region::default(), region.clone()],
            Clipped::Both(inside, outside) => [inside, outside],
        }
    }

    const SQUARE: [[i64; 2]; 4] = [[0, 0], [10, 0], [10, 10], [0, 10]];

    fn shape(region: &Region) -> Vec<usize> {
        let mut shape: Vec<_> = region.contours().iter().map(Vec::len).collect();
        shape.sort_unstable();
        shape
    }

    #[test]
    fn p24_a_triangle_in_the_middle_leaves_a_hole() {
        let [inside, outside] = clip(&region(&SQUARE), &[[3, 3], [7, 3], [3, 7]]);
        assert!((inside.area() - 8.0).abs() < 1e-9 && (outside.area() - 92.0).abs() < 1e-9);
        assert_eq!((shape(&inside), shape(&outside)), (vec![3], vec![3, 4]));
        // A second one across the hole's edge: the hole grows.
        let [inside, outside] = clip(&outside, &[[5, 3], [9, 3], [5, 7]]);
        assert!((inside.area() + outside.area() - 92.0).abs() < 1e-9);
        assert!((inside.area() - 6.0).abs() < 1e-9, "{}", inside.area());
        // And one that cuts the square in two.
        let [_, outside] = clip(&outside, &[[-5, 4], [20, 4], [20, 5], [-5, 5]]);
        assert_eq!(shape(&outside).len(), 2);
    }

    #[test]
    fn p24_degenerate_cases() {
        let square = region(&SQUARE);
        let areas = |corners: &[[i64; 2]]| clip(&square, corners).map(|r| r.area());
        // Itself; the same with a corner on an edge; half of it along three edges.
        assert_eq!(areas(&SQUARE), [100.0, 0.0]);
        assert_eq!(areas(&[[0, 0], [10, 0], [10, 10]]), [50.0, 50.0]);
        assert_eq!(areas(&[[0, 0], [5, 0], [5, 10], [0, 10]]), [50.0, 50.0]);
        // Touching along an edge, in a part of an edge, in a corner.
        for touching in [
            [[10, 0], [20, 0], [20, 10], [10, 10]],
            [[10, 3], [20, 3], [20, 5], [10, 5]],
            [[10, 10], [20, 10], [20, 20], [10, 20]],
        ] {
            assert_eq!(areas(&touching), [0.0, 100.0]);
        }
        // From outside to a corner; corners on two edges.
        assert_eq!(areas(&[[0, 0], [5, -5], [10, 0]]), [0.0, 100.0]);
        assert_eq!(areas(&[[5, 0], [10, 5], [5, 10], [0, 5]]), [50.0, 50.0]);
        // Clipped again with the same: nothing is left to clip.
        let [inside, outside] = clip(&square, &[[5, 0], [10, 5], [5, 10], [0, 5]]);
        assert!(clip(&outside, &[[5, 0], [10, 5], [5, 10], [0, 5]])[0].is_empty());
        assert!(clip(&inside, &[[5, 0], [10, 5], [5, 10], [0, 5]])[1].is_empty());
        // A hole may touch the outline, and outlines that touch in a point stay apart.
        assert_eq!(shape(&outside), [4, 4]);
        let [_, left] = clip(&square, &[[0, 0], [10, 0], [5, 5]]);
        assert_eq!(shape(&clip(&left, &[[10, 10], [0, 10], [5, 5]])[1]), [3, 3]);
    }

    #[test]
    fn p24_random_polygons_share_samples_and_area_out() {
        let pattern = SamplePattern::new(4);
        let mut state = 5u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            i64::from(state >> 8)
        };
        for round in 0..200 {
            // Coarse grids make degenerate cases, and samples on edges.
            let step = [1, 32, 1024, 4096][round % 4];
            let whole = Region::polygon(&[[0, 0], [16384, 0], [16384, 16384], [0, 16384]]);
            let mut parts = vec![whole];
            for _ in 0..12 {
                let mut corners = [0; 3].map(|_| [0; 2].map(|_| (next() % 24576 - 4096) / step * step));
                let [a, b, c] = corners;
                let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
                if area == 0 {
                    continue;
                }
                if area < 0 {
                    corners.swap(1, 2);
                }
                let polygon = Convex::polygon(&corners);
                let mut pieces = Vec::new();
                for part in parts {
                    match part.clip(part.bounds(), &polygon) {
                        Clipped::Inside | Clipped::Outside => pieces.push(part),
                        Clipped::Both(inside, outside) => pieces.extend([inside, outside]),
                    }
                }
                parts = pieces;
            }
            let area: f64 = parts.iter().map(Region::area).sum();
            assert!((area - 4096.0).abs() < 1e-6, "round {round}: {area}");
            // Each sample is in exactly one.
            let (mut once, mut twice) = ([0u64; 4 * TILE], [0u64; 4 * TILE]);
            for part in &parts {
                let mut rows = [0u64; 4 * TILE];
                part.turn_samples(&pattern, &mut rows);
                for i in 0..rows.len() {
                    twice[i] |= once[i] & rows[i];
                    once[i] |= rows[i];
                }
            }
            assert!(once.iter().all(|&r| r == u64::MAX) && twice.iter().all(|&r| r == 0), "round {round}");
        }
    }

    #[test]
    fn p24_samples_of_a_triangle_are_those_that_its_edge_functions_cover() {
        use vitral_raster::{CornerPosition, Setup};
        let pattern = SamplePattern::new(1);
        for corners in [
            [[0, 0], [2048, 0], [0, 2048]],
            [[128, 128], [1408, 640], [640, 1408]],
            [[77, 9], [3000, 1111], [500, 4000]],
        ] {
            let [a, b, c] = corners.map(|[x, y]| CornerPosition { x, y, z: 0.5 });
            let setup = Setup::new([a, b, c], Setup::doubled_area(a, b, c), 0);
            let mut rows = [0; TILE];
            Region::polygon(&corners.map(|c| c.map(i64::from))).turn_samples(&pattern, &mut rows);
            for (row, bits) in rows.iter().enumerate() {
                for column in 0..TILE {
                    let covers = setup.covers(column as i32 * 256 + 128, row as i32 * 256 + 128);
                    assert_eq!(bits >> column & 1 == 1, covers, "{corners:?}: {column}, {row}");
                }
            }
        }
    }
}
