//! Which of two polygons has to be painted first: the five tests, and what is left when they fail.
//!
//! In:   two convex polygons on the screen with their depth planes. Out: a
//!       [`ListVerdict`](Verdict), and the test that decided.
//! Cost: a few comparisons for most pairs; corners times edges for the last tests.
//! Source: [Newell, Newell & Sancha 1972]. Departs from it: depths closer than 2^-22 count as
//! equal, and polygons that are equally far over their whole overlap are ordered as the law of
//! agreement decides: what faces the viewer comes last, then the lower facet.

use super::super::cut::{Cut, Depth};
use super::super::polygons::Polygons;
use crate::stats::VisibilityCounters;
use crate::trace::lists::{ListTest, ListVerdict as Verdict};
use std::cmp::Ordering;
use std::ops::Range;
use vitral_math::DVec2;
use vitral_raster::Setup;
use vitral_scene::{Extent1, Extent2};

/// Depths this close are equal.
const EQUAL: f64 = 1.0 / (1 << 22) as f64;
/// How far off a line a polygon has to reach, in 1/256 pixel, to lie clearly on that side.
const CLEARLY: f64 = 1e-3;

/// A polygon, or a part of one.
#[derive(Clone, Debug)]
pub(super) struct PainterPolygon {
    /// The whole one's number.
    pub(super) whole: u32,
    /// Farthest depth.
    pub(super) far: f32,
    /// From the farthest to the nearest.
    pub(super) depth: Extent1,
    /// The window round it.
    window: Extent2,
    corners: Range<u32>,
    /// The lines it was cut along.
    pub(super) cuts: Range<u32>,
    /// The cells of the grid it is in: first column and row, last column and row.
    pub(super) cells: [u16; 4],
}

impl PainterPolygon {
    /// `plane` is that of the whole polygon.
    pub(super) fn new(
        plane: &Setup,
        whole: u32,
        points: &[[f64; 2]],
        corners: Range<u32>,
        cuts: Range<u32>,
        cells: [u16; 4],
    ) -> Self {
        let window = Extent2::of(points.iter().copied().map(DVec2::from_array));
        let (mut far, mut near) = (f64::INFINITY, f64::NEG_INFINITY);
        let depths = Depth::of(plane);
        for &p in points {
            let depth = depths.at(p);
            (far, near) = (far.min(depth), near.max(depth));
        }
        // The depths of samples are clamped.
        let [far, near] = [far, near].map(|depth| (depth as f32).max(plane.z_min).min(plane.z_max));
        let depth = Extent1 { min: f64::from(far), max: f64::from(near) };
        Self { whole, far, depth, window, corners, cuts, cells }
    }

    /// Whether all of it is farther than the other's farthest point.
    pub(super) fn is_behind(&self, far: f32, counters: &mut VisibilityCounters) -> bool {
        let behind = !self.depth.overlaps(&Extent1 { min: f64::from(far), max: f64::INFINITY });
        counters.list_tests += u64::from(behind);
        counters.by_depth_extent += u64::from(behind);
        behind
    }

    /// Its corners, of those of all polygons.
    pub(super) fn points<'c>(&self, corners: &'c [[f64; 2]]) -> &'c [[f64; 2]] {
        &corners[self.corners.start as usize..self.corners.end as usize]
    }

    /// Twice its area, 1/65536 square pixels.
    pub(super) fn area(&self, corners: &[[f64; 2]]) -> f64 {
        let points = self.points(corners);
        let edges = points.iter().zip(points.iter().cycle().skip(1));
        edges.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs()
    }

    /// The lines along its edges.
    pub(super) fn edges(&self, corners: &[[f64; 2]]) -> Vec<Cut> {
        let points = self.points(corners);
        (0..points.len()).filter_map(|i| edge(points[i], points[(i + 1) % points.len()])).collect()
    }

    /// A line that has what it shares with one of two others on one side, and what it shares with
    /// the other on the other side; whether it is one of the first's.
    pub(super) fn separating_line(
        &self,
        others: [&Self; 2],
        wholes: &Polygons<'_>,
        corners: &[[f64; 2]],
    ) -> Option<(Cut, bool)> {
        let plane = |polygon: &Self| wholes.get(polygon.whole as usize).plane();

        // Find what the polygon shares with both others on the screen.
        let shared = others.map(|other| overlap(self.points(corners), other.points(corners)));

        // Tell on which side of a line points lie.
        let side = |line: &Cut, points: &[[f64; 2]]| {
            let (low, high) = range(points.iter().map(|&p| line.value(p)));
            if low >= -CLEARLY {
                1
            } else if high <= CLEARLY {
                -1
            } else {
                0
            }
        };

        // Try the lines in which planes meet, then the edges of the others.
        let lines = others.into_iter().zip([true, false]).flat_map(|(other, is_first)| {
            let lines = crossing(plane(self), plane(other)).into_iter().chain(other.edges(corners));
            lines.map(move |line| (line, is_first))
        });
        let mut lines =
            lines.filter(|(line, _)| side(line, &shared[0]) * side(line, &shared[1]) < 0);
        lines.find(|(line, _)| self.split(corners, line).is_some())
    }

    /// The parts on the kept side of a line and beyond it, if both reach clearly off the line.
    pub(super) fn split(&self, corners: &[[f64; 2]], line: &Cut) -> Option<[Vec<[f64; 2]>; 2]> {
        // Refuse lines that do not clearly cross the polygon.
        let points = self.points(corners);
        let value = |p: [f64; 2]| if line.positive { line.value(p) } else { -line.value(p) };
        let (low, high) = range(points.iter().map(|&p| value(p)));
        let clearly = low < -CLEARLY && high > CLEARLY;
        if !clearly {
            return None;
        }

        // Walk the outline, and put crossings into both halves.
        let mut halves = [Vec::new(), Vec::new()];
        for (i, &to) in points.iter().enumerate() {
            let from = points[(i + points.len() - 1) % points.len()];
            let (d_from, d_to) = (value(from), value(to));
            if d_from * d_to < 0.0 {
                let t = d_from / (d_from - d_to);
                let crossing = [from[0] + (to[0] - from[0]) * t, from[1] + (to[1] - from[1]) * t];
                halves.iter_mut().for_each(|h| h.push(crossing));
            }
            if d_to >= 0.0 {
                halves[0].push(to);
            }
            if d_to <= 0.0 {
                halves[1].push(to);
            }
        }
        halves.iter().all(|h| h.len() >= 3).then_some(halves)
    }
}

/// Smallest and largest of some values.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// A line in units of distance.
fn unit(a: f64, b: f64, c: f64) -> Option<Cut> {
    let length = (a * a + b * b).sqrt();
    let line = Cut { a: a / length, b: b / length, c: c / length, positive: true };
    (length > 0.0 && line.a.is_finite() && line.b.is_finite() && line.c.is_finite()).then_some(line)
}

/// The line through two points, positive on the inner side of a polygon's edge.
fn edge(from: [f64; 2], to: [f64; 2]) -> Option<Cut> {
    let [dx, dy] = [0, 1].map(|k| to[k] - from[k]);
    unit(-dy, dx, dy * from[0] - dx * from[1])
}

/// The line where two facets are equally far.
pub(super) fn crossing(p: &Setup, q: &Setup) -> Option<Cut> {
    let gap = Depth::of(q).minus(Depth::of(p));
    unit(gap.slope[0], gap.slope[1], gap.at_zero)
}

/// Compares two polygons by the five tests, and says which decided.
pub(super) fn compare(
    p: &PainterPolygon,
    q: &PainterPolygon,
    wholes: &Polygons<'_>,
    corners: &[[f64; 2]],
    counters: &mut VisibilityCounters,
) -> (Verdict, ListTest) {
    // Compare depths, then extents.
    if p.is_behind(q.far, counters) {
        return (Verdict::Before, ListTest::DepthExtent);
    }
    counters.list_tests += 1;
    if !p.window.x.crosses(&q.window.x) {
        counters.by_x_extent += 1;
        return (Verdict::Before, ListTest::XExtent);
    }
    if !p.window.y.crosses(&q.window.y) {
        counters.by_y_extent += 1;
        return (Verdict::Before, ListTest::YExtent);
    }

    // Test each polygon against the plane of the other.
    let [ps, qs] = [p, q].map(|i| wholes.get(i.whole as usize).plane());
    let (p_points, q_points) = (p.points(corners), q.points(corners));
    // How much nearer Q is than P. With all corners of P, that tells where P lies from the plane of
    // Q.
    let gap = Depth::of(qs).minus(Depth::of(ps));
    let at_p = range(p_points.iter().map(|&c| gap.at(c)));
    let at_q = range(q_points.iter().map(|&c| gap.at(c)));
    let [by_p, by_q] = [at_p, at_q].map(|gaps| order(gaps, ps, qs));
    if by_p == Verdict::Before {
        counters.by_plane_of_nearer += 1;
        return (Verdict::Before, ListTest::BehindPlane);
    }
    if by_q == Verdict::Before {
        counters.by_plane_of_farther += 1;
        return (Verdict::Before, ListTest::InFrontOfPlane);
    }

    // Test whether the outlines overlap.
    if disjoint(p_points, q_points) || disjoint(q_points, p_points) {
        counters.by_projection += 1;
        return (Verdict::Before, ListTest::Projection);
    }

    // Test whether exchanging the two orders them.
    if by_p == Verdict::After || by_q == Verdict::After {
        let test = match (are_equal(at_p) || are_equal(at_q), by_p) {
            (true, _) => ListTest::Coplanar,
            (false, Verdict::After) => ListTest::ExchangedInFront,
            (false, _) => ListTest::ExchangedBehind,
        };
        return (Verdict::After, test);
    }
    // The planes meet, but perhaps not where the polygons overlap.
    counters.by_overlap += 1;
    let overlap = overlap(p_points, q_points);
    let verdict = match overlap.len() {
        0..3 => Verdict::Before,
        _ => order(range(overlap.into_iter().map(|c| gap.at(c))), ps, qs),
    };
    (verdict, ListTest::Overlap)
}

/// Whether all of a range of gaps counts as none.
fn are_equal((low, high): (f64, f64)) -> bool {
    low >= -EQUAL && high <= EQUAL
}

/// The verdict for a range of gaps between the planes of two polygons.
fn order((low, high): (f64, f64), p: &Setup, q: &Setup) -> Verdict {
    match (low >= -EQUAL, high <= EQUAL) {
        (true, true) => coplanar_order(p, q),
        (true, false) => Verdict::Before,
        (false, true) => Verdict::After,
        (false, false) => Verdict::Across,
    }
}

/// The verdict for polygons in one plane. Facets that share their plane in the world have parallel
/// planes here, the nearer one where they face the viewer. Of equal ones the lower facet is seen,
/// and comes last.
fn coplanar_order(p: &Setup, q: &Setup) -> Verdict {
    let slope = |s: &Setup| ([s.dz_dx, s.dz_dy].map(f32::to_bits), s.origin);
    let gap = if slope(p) == slope(q) { q.z.total_cmp(&p.z) } else { Ordering::Equal };
    match gap.then(p.facet.cmp(&q.facet)) {
        Ordering::Less => Verdict::After,
        _ => Verdict::Before,
    }
}

/// Whether an edge of a convex polygon has all of another on its outer side.
fn disjoint(p: &[[f64; 2]], q: &[[f64; 2]]) -> bool {
    (0..p.len()).any(|i| {
        let (from, to) = (p[i], p[(i + 1) % p.len()]);
        let [dx, dy] = [0, 1].map(|k| to[k] - from[k]);
        let slack = (dx.abs() + dy.abs()) * 1e-7;
        q.iter().all(|c| dx * (c[1] - from[1]) - dy * (c[0] - from[0]) <= slack)
    })
}

/// The part of a convex polygon that another covers.
fn overlap(p: &[[f64; 2]], q: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let (mut polygon, mut next) = (p.to_vec(), Vec::new());
    // Clip by one edge after the other.
    for i in 0..q.len() {
        let Some(line) = edge(q[i], q[(i + 1) % q.len()]) else { continue };
        for (k, &to) in polygon.iter().enumerate() {
            let from = polygon[(k + polygon.len() - 1) % polygon.len()];
            let (d_from, d_to) = (line.value(from), line.value(to));
            if d_from * d_to < 0.0 {
                let t = d_from / (d_from - d_to);
                next.push([from[0] + (to[0] - from[0]) * t, from[1] + (to[1] - from[1]) * t]);
            }
            if d_to >= 0.0 {
                next.push(to);
            }
        }
        std::mem::swap(&mut polygon, &mut next);
        next.clear();
    }
    polygon
}

#[cfg(test)]
mod tests {
    use super::super::super::cut::corners;
    use super::*;
    use vitral_raster::CornerPosition;

    fn setup(corners: [[i32; 2]; 3], z: [f32; 3], facet: u32) -> Setup {
        let [a, b, c] =
            [0, 1, 2].map(|i| CornerPosition { x: corners[i][0], y: corners[i][1], z: z[i] });
        Setup::new([a, b, c], Setup::doubled_area(a, b, c), facet)
    }

    fn verdict(p: Setup, q: Setup) -> ((Verdict, ListTest), VisibilityCounters) {
        let [a, b] = [p, q].map(|s| corners(&s));
        let points = [a, b].concat();
        let polygons = [
            PainterPolygon::new(&p, 0, &a, 0..3, 0..0, [0; 4]),
            PainterPolygon::new(&q, 1, &b, 3..6, 0..0, [0; 4]),
        ];
        let mut counters = VisibilityCounters::default();
        let setups = [p, q];
        let wholes = Polygons::joined(&setups, |facet| facet);
        (compare(&polygons[0], &polygons[1], &wholes, &points, &mut counters), counters)
    }

    const HERE: [[i32; 2]; 3] = [[0, 0], [1000, 0], [0, 1000]];

    #[test]
    fn p21_each_of_the_five_tests_decides() {
        let p = setup(HERE, [0.2, 0.8, 0.2], 0);
        let moved = |by: [i32; 2]| HERE.map(|[x, y]| [x + by[0], y + by[1]]);
        let decided = |q: Setup| {
            let ((verdict, test), c) = verdict(p, q);
            assert_eq!(verdict, Verdict::Before);
            let counts = [
                c.by_depth_extent,
                c.by_x_extent,
                c.by_y_extent,
                c.by_plane_of_nearer,
                c.by_plane_of_farther,
                c.by_projection,
            ];
            assert_eq!(counts.iter().sum::<u64>(), 1);
            assert_eq!(counts[test as usize], 1, "{test:?}");
            counts
        };
        assert_eq!(decided(setup(HERE, [0.9; 3], 1)), [1, 0, 0, 0, 0, 0]);
        assert_eq!(decided(setup(moved([1000, 0]), [0.1; 3], 1)), [0, 1, 0, 0, 0, 0]);
        assert_eq!(decided(setup(moved([0, 1000]), [0.1; 3], 1)), [0, 0, 1, 0, 0, 0]);
        // A parallel plane in front; a small polygon in front of the sloping one, whose own plane
        // cuts that.
        assert_eq!(decided(setup(HERE, [0.3, 0.9, 0.3], 1)), [0, 0, 0, 1, 0, 0]);
        assert_eq!(decided(setup([[0, 0], [100, 0], [0, 100]], [0.3; 3], 1)), [0, 0, 0, 0, 1, 0]);
        // The other half of the square.
        assert_eq!(
            decided(setup([[1000, 1000], [1000, 0], [0, 1000]], [0.1, 0.5, 0.1], 1)),
            [0, 0, 0, 0, 0, 1]
        );
    }

    #[test]
    fn p21_what_is_left_when_the_tests_fail() {
        let p = setup(HERE, [0.2, 0.8, 0.2], 0);
        assert_eq!(
            verdict(p, setup(HERE, [0.1, 0.7, 0.1], 1)).0,
            (Verdict::After, ListTest::ExchangedInFront)
        );
        assert_eq!(
            verdict(p, setup(HERE, [0.8, 0.2, 0.8], 1)).0,
            (Verdict::Across, ListTest::Overlap)
        );
        // Coplanar: the lower facet comes last.
        assert_eq!(verdict(p, Setup { facet: 1, ..p }).0, (Verdict::After, ListTest::Coplanar));
        assert_eq!(verdict(Setup { facet: 1, ..p }, p).0, (Verdict::Before, ListTest::BehindPlane));
        // Of one plane, but this one faces the viewer: it comes last all the same, however little
        // nearer that makes it.
        let facing = Setup { facet: 1, z: p.z + f32::EPSILON, ..p };
        assert_eq!(verdict(p, facing).0, (Verdict::Before, ListTest::BehindPlane));
        assert_eq!(verdict(facing, p).0, (Verdict::After, ListTest::Coplanar));
        // The planes meet at x = 290, the polygons overlap left of x = 208.
        let q = setup([[0, 300], [0, -100], [900, -1000]], [0.1, 0.1, 0.95], 1);
        let (left, counters) = verdict(p, q);
        assert_eq!((left, counters.by_overlap), ((Verdict::After, ListTest::Overlap), 1));
    }

    #[test]
    fn p21_the_halves_of_a_polygon_add_up() {
        let p = setup(HERE, [0.2, 0.8, 0.2], 0);
        let points = corners(&p);
        let polygon = PainterPolygon::new(&p, 0, &points, 0..3, 0..0, [0; 4]);
        let area = |points: &[[f64; 2]]| -> f64 {
            let n = points.len();
            (0..n)
                .map(|i| {
                    points[i][0] * points[(i + 1) % n][1] - points[i][1] * points[(i + 1) % n][0]
                })
                .sum::<f64>()
        };
        let line = unit(1.0, 2.0, -700.0).unwrap();
        let [one, other] = polygon.split(&points, &line).unwrap();
        assert!(
            (area(&one) + area(&other) - area(&points)).abs() < 1e-6
                && area(&one) > 1.0
                && area(&other) > 1.0
        );
        assert!(
            polygon.split(&points, &unit(1.0, 0.0, 0.0).unwrap()).is_none(),
            "an edge does not split it"
        );
    }
}
