//! Implied edges: the lines where faces penetrate each other.
//!
//! Two planes meet in a line, and on the screen it is a straight line, too: an edge that is in no
//! table, but just as good. Two points of it are enough. They are found when two polygons first
//! compete for a span; on every line after that, the crossing follows from them by a step, and the
//! span falls in two parts with a winner each, without a look at depths.
//!
//! Depths are rounded, and clamped to the range of their facet. So a strip along the edge is left
//! to the depths at the samples: as wide as the planes need to come farther apart than all that can
//! differ from them. Beyond it, the winner is the one that the depth function would find at each
//! sample.
//!
//! In:   two convex polygons (screen space) and a span that both cover. Out: the part where depths
//!       decide, and who is nearer left and right of it.
//! Cost: some 60 operations for a pair, one product and one sum on each line after that.
//! Source: implied edge coherence after [Foley et al. 1990], section 15.2. Departs from it: the
//!         strip.

use crate::visible::polygons::ConvexPolygon;
use std::ops::Range;
use vitral_raster::{SUBPIXEL, TILE};

/// The edge's second point lies this far below the first, 1/256 pixel: the farther apart, the
/// better they fix the line.
const APART: i32 = TILE as i32 * SUBPIXEL;
/// Places in the table.
const PLACES: usize = 256;

/// The line where two polygons' planes meet.
#[derive(Clone, Copy, Debug)]
struct ImpliedEdge {
    polygons: [u32; 2],
    /// A point, 1/256 pixel.
    x: f64,
    y: i32,
    /// What is added to `x` from a line to the one 1/256 pixel below.
    step: f64,
    /// Half the width of the strip, along a line, 1/256 pixel.
    reach: f64,
    /// Whether the first polygon is nearer on the left.
    first_on_left: bool,
}

/// The edges that were found, each at the place that its polygons have. Edges with the same place
/// displace each other.
#[derive(Debug, Default)]
pub(super) struct ImpliedEdges {
    places: Vec<Option<ImpliedEdge>>,
    /// How many were found.
    pub(super) found: u64,
}

/// How a span falls in parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct DividedSpan {
    /// The pixels where the depths decide. Those before them and those behind them have a winner.
    pub(super) undecided: Range<usize>,
    /// Whether the first polygon is nearer on the left, and the second on the right, or the other
    /// way round.
    pub(super) first_on_left: bool,
}

impl ImpliedEdges {
    /// Divides a span at the edge of two polygons: `pixels` with samples at `sample_x` within the
    /// pixel, on the line at `y`.
    pub(super) fn divide(
        &mut self,
        polygons: [u32; 2],
        shapes: [ConvexPolygon<'_, '_>; 2],
        pixels: Range<usize>,
        sample_x: i32,
        y: i32,
    ) -> DividedSpan {
        if self.places.is_empty() {
            self.places = vec![None; PLACES];
        }
        let place = polygons[0]
            .wrapping_mul(0x9e37_79b1)
            .wrapping_add(polygons[1].wrapping_mul(0x85eb_ca6b))
            >> 24;
        let edge = match self.places[place as usize] {
            Some(known) if known.polygons == polygons => known,
            _ => {
                self.found += 1;
                *self.places[place as usize].insert(ImpliedEdge::new(polygons, shapes, y))
            }
        };
        DividedSpan {
            undecided: edge.undecided(pixels, sample_x, y),
            first_on_left: edge.first_on_left,
        }
    }
}

impl ImpliedEdge {
    /// Finds the edge by its crossings with the line at `y` and one farther down.
    fn new(polygons: [u32; 2], [p, q]: [ConvexPolygon<'_, '_>; 2], y: i32) -> Self {
        let [p, q] = [p, q].map(Plane::of);
        // The part for needed rounding is generous; the last factor is for slopes that are raised.
        let margin = (p.rounding + q.rounding + p.beyond + q.beyond) * 1.0625;
        // How much nearer P gets than Q for a step to the right. Planes that stay as far apart as
        // they are get a slope that does not matter on any screen.
        let (slope, least) = (p.slope[0] - q.slope[0], margin * 1e-9);
        let slope = if slope.abs() < least { least } else { slope };
        let crossing = |y: i32| {
            p.origin[0]
                - (p.at(p.origin[0], f64::from(y)) - q.at(p.origin[0], f64::from(y))) / slope
        };
        let (x, far) = (crossing(y), crossing(y + APART));
        let (step, reach) = ((far - x) / f64::from(APART), margin / slope.abs() + 1.0);
        if !(x + far + reach).is_finite() {
            // Planes without numbers decide nothing.
            return Self {
                polygons,
                x: 0.0,
                y,
                step: 0.0,
                reach: f64::INFINITY,
                first_on_left: false,
            };
        }
        Self { polygons, x, y, step, reach, first_on_left: slope < 0.0 }
    }

    /// The pixels of a span whose samples lie in the strip.
    fn undecided(&self, pixels: Range<usize>, sample_x: i32, y: i32) -> Range<usize> {
        let crossing = self.x + self.step * f64::from(y - self.y) - f64::from(sample_x);
        // Rounded up to the first pixel not left of a place.
        let first = |x: f64| {
            let pixel = (x / f64::from(SUBPIXEL)).clamp(pixels.start as f64, pixels.end as f64);
            pixel as usize + usize::from(pixel > (pixel as usize) as f64)
        };
        first(crossing - self.reach)..first(crossing + self.reach + 1.0)
    }
}

/// The plane of a polygon's depths, not clamped to the polygon's, and by how much the depth
/// function may differ from it.
struct Plane {
    origin: [f64; 2],
    z: f64,
    /// For 1/256 pixel to the right and downwards.
    slope: [f64; 2],
    /// The most that rounding does to a depth within the polygon.
    rounding: f64,
    /// How far the plane leaves the polygon's range of depths within the polygon.
    beyond: f64,
}

impl Plane {
    fn of(shape: ConvexPolygon<'_, '_>) -> Self {
        let setup = shape.plane();
        let slope = [setup.dz_dx, setup.dz_dy].map(|d| f64::from(d) / f64::from(SUBPIXEL));
        let (origin, z) = (setup.origin.map(f64::from), f64::from(setup.z));
        let mut plane = Self { origin, z, slope, rounding: 0.0, beyond: 0.0 };
        // Four roundings to 24 bits, of numbers no larger than the sum; or of numbers that are too
        // small for 24 bits.
        let away = |k: usize| {
            shape.outline().iter().map(move |corner| (corner[k] - setup.origin[k]).abs())
        };
        let [across, down] = [0, 1].map(|k| f64::from(away(k).max().unwrap_or(0)));
        let sum = z.abs() + across * slope[0].abs() + down * slope[1].abs();
        plane.rounding = sum * f64::from(f32::EPSILON) * 4.0 + f64::from(f32::MIN_POSITIVE);
        for &[x, y] in shape.outline() {
            let depth = plane.at(f64::from(x), f64::from(y));
            plane.beyond = plane
                .beyond
                .max(f64::from(setup.z_min) - depth)
                .max(depth - f64::from(setup.z_max));
        }
        plane
    }

    fn at(&self, x: f64, y: f64) -> f64 {
        self.z + (x - self.origin[0]) * self.slope[0] + (y - self.origin[1]) * self.slope[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::visible::agreement::nearer;
    use crate::visible::scanline::edges::tests::{apart, triangle};
    use vitral_raster::Setup;

    /// Two faces that are equally near where `x + y` is 20 pixels.
    fn crossing() -> [Setup; 2] {
        let corners = [[0, 0], [256 * 40, 0], [0, 256 * 40]];
        [triangle(corners, [0.2, 0.6, 0.6]), triangle(corners, [0.4, 0.4, 0.4])]
    }

    #[test]
    fn p7_two_points_tell_where_every_line_is_crossed() {
        let (setups, mut edges) = (crossing(), ImpliedEdges::default());
        let shapes = apart(&setups);
        let [p, q] = [shapes.get(0), shapes.get(1)];
        let at = |line: i32| line * 256 + 128;
        // Samples are in the middle of pixels, so each line has one on the edge.
        for line in 0..18 {
            let parts = edges.divide([1, 2], [p, q], 0..30, 128, at(line));
            let middle = 19 - line as usize;
            assert_eq!(
                parts,
                DividedSpan { undecided: middle..middle + 1, first_on_left: false },
                "line {line}"
            );
        }
        assert_eq!(edges.found, 1);
        // A span beside the edge has no undecided part, at one end of it or the other.
        let beside = edges.divide([1, 2], [p, q], 22..25, 128, at(0)).undecided;
        assert_eq!((beside.start, beside.end), (22, 22));
        let beside = edges.divide([1, 2], [p, q], 3..9, 128, at(0)).undecided;
        assert_eq!((beside.start, beside.end), (9, 9));
        // Other polygons have an edge of their own, whatever their place.
        for other in 3..2000 {
            assert!(edges.divide([1, other], [q, p], 0..30, 128, at(0)).first_on_left);
        }
        assert_eq!((edges.found, edges.places.len()), (1998, PLACES));
    }

    #[test]
    fn p7_what_is_decided_is_what_the_depths_say() {
        let mut state = 5u32;
        let mut next = |size: i32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as i32 % size
        };
        let (mut decided, mut undecided) = (0, 0);
        for round in 0..4000 {
            // Some nearly parallel, some nearly equal, some needles.
            let (flat, thin) =
                ([1 << 20, 1 << 10, 8][round % 3], [6000, 6000, 6000, 90][round % 4]);
            let corners = [0; 3].map(|_| [next(6000), next(thin)]);
            let mut depths = || [0; 3].map(|_| 0.5 + next(flat) as f32 / (1 << 21) as f32);
            let (a, b) = (depths(), depths());
            let others = [0; 3].map(|_| [next(6000), next(thin)]);
            let area = |c: [[i32; 2]; 3]| {
                (c[1][0] - c[0][0]) * (c[2][1] - c[0][1])
                    - (c[2][0] - c[0][0]) * (c[1][1] - c[0][1])
            };
            if area(corners) == 0 || area(others) == 0 {
                continue;
            }
            let [p, q] = [(triangle(corners, a), 3), (triangle(others, b), 4)]
                .map(|(s, facet)| Setup { facet, ..s });
            let mut edges = ImpliedEdges::default();
            let setups = [p, q];
            let shapes = apart(&setups);
            for line in 0..24 {
                let y = line * 256 + 128;
                let both = |x: usize| [p, q].iter().all(|s| s.covers(x as i32 * 256 + 128, y));
                let Some(start) = (0..24).find(|&x| both(x)) else { continue };
                let end = (start..24).find(|&x| !both(x)).unwrap_or(24);
                let parts = edges.divide(
                    [0, 1],
                    [0, 1].map(|number| shapes.get(number)),
                    start..end,
                    128,
                    y,
                );
                for x in start..end {
                    if parts.undecided.contains(&x) {
                        undecided += 1;
                        continue;
                    }
                    decided += 1;
                    let depth = |s: &Setup| (s.depth(x as i32 * 256 + 128, y), s.facet);
                    let first = (x < parts.undecided.start) == parts.first_on_left;
                    assert_eq!(nearer(depth(&p), depth(&q)), first, "{p:?} {q:?} {x} {y}");
                }
            }
        }
        assert!(decided > 10_000 && undecided > 1000, "{decided} {undecided}");
    }

    #[test]
    fn planes_without_numbers_and_equal_planes_decide_nothing() {
        let [p, q] = crossing();
        for odd in [
            Setup { dz_dx: f32::NAN, ..p },
            Setup { dz_dy: f32::INFINITY, ..p },
            Setup { facet: 9, ..q },
        ] {
            let setups = [odd, q];
            let shapes = apart(&setups);
            let shapes = [shapes.get(0), shapes.get(1)];
            let parts = ImpliedEdges::default().divide([0, 1], shapes, 2..30, 128, 128);
            assert_eq!(parts.undecided, 2..30, "{odd:?}");
        }
    }
}
