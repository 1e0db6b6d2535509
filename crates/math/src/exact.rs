//! Exact predicates on points of an integer grid: the side of a line, the side of a plane, the
//! order of fractions.
//!
//! A geometric algorithm stays consistent if its decisions never contradict each other. Rounded
//! decisions do, so points are rounded once, to a grid, and decisions about them are exact.
//! Differences of coordinates are below [`MAX_STEP`] across the page and below 2^31 in depth: twice
//! an area fits 64 bits, six times a volume fits 128. Signs of volumes are computed in floating
//! point first, and only those too close to zero are computed again in 128 bits.
//!
//! Intersections are not rounded at all. Where a segment meets a line or a plane is a fraction of
//! its length, and two fractions are compared by their continued fractions, which needs no product
//! of the four numbers.
//!
//! Source: the filter is the simplest stage of [Shewchuk 1997]; comparison by continued fractions
//! is Euclid's algorithm on both fractions at once [Knuth 1997], section 4.5.3.

use std::cmp::Ordering;

/// Coordinates across the page differ by less than this.
pub const MAX_STEP: i64 = 1 << 25;

/// A point of the grid: x to the right, y upwards, z towards the viewer.
pub type GridPoint = [i32; 3];

/// Twice the area of the triangle `a b p` on the page: positive where `p` is to the left of the way
/// from `a` to `b`.
#[inline(always)]
pub fn orient2d(a: GridPoint, b: GridPoint, p: GridPoint) -> i64 {
    let d = |p: GridPoint, k: usize| i64::from(p[k]) - i64::from(a[k]);
    d(b, 0) * d(p, 1) - d(b, 1) * d(p, 0)
}

/// The plane through three grid points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridPlane {
    /// One of the points.
    pub origin: GridPoint,
    /// The cross product of two sides of the triangle; its z is twice the triangle's area on the
    /// page.
    pub normal: [i64; 3],
}

impl GridPlane {
    /// The plane of a triangle. Its normal points to the viewer where the corners run
    /// counter-clockwise on the page.
    #[inline(always)]
    pub fn new([a, b, c]: [GridPoint; 3]) -> Self {
        let d = |p: GridPoint| [0, 1, 2].map(|k| i64::from(p[k]) - i64::from(a[k]));
        let (u, v) = (d(b), d(c));
        let normal =
            [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        Self { origin: a, normal }
    }

    /// Six times the volume of the triangle and `p`: positive on the side to which the normal
    /// points.
    pub fn height(&self, p: GridPoint) -> i128 {
        let term =
            |k: usize| i128::from(self.normal[k]) * (i128::from(p[k]) - i128::from(self.origin[k]));
        term(0) + term(1) + term(2)
    }

    /// About [`height`](Self::height), and how far from it this may be.
    #[inline(always)]
    pub fn rounded_height(&self, p: GridPoint) -> (f64, f64) {
        let term = |k: usize| self.normal[k] as f64 * (f64::from(p[k]) - f64::from(self.origin[k]));
        let (x, y, z) = (term(0), term(1), term(2));
        // Seven roundings of at most 2^-53 each: of three normals, three products and two sums.
        (x + y + z, (x.abs() + y.abs() + z.abs()) * (4.0 * f64::EPSILON))
    }

    /// The sign of [`height`](Self::height): in floating point where that is certain.
    #[inline(always)]
    pub fn side(&self, p: GridPoint) -> i32 {
        let (height, error) = self.rounded_height(p);
        if height > error {
            1
        } else if height < -error {
            -1
        } else {
            self.height(p).signum() as i32
        }
    }

    /// How much the height of a point changes at most while all coordinates of the point and of the
    /// triangle's corners move by half a unit, if the point is over the triangle: how far apart
    /// snapping can bring what touched.
    #[inline(always)]
    pub fn snapping(&self) -> f64 {
        self.normal.iter().map(|n| n.abs() as f64).sum()
    }
}

/// A fraction with a positive denominator. Fractions of equal value are equal.
#[derive(Clone, Copy, Debug)]
pub struct Fraction {
    numerator: i128,
    denominator: i128,
}

impl Fraction {
    /// `numerator / denominator`; `None` where the denominator is 0.
    pub fn new(numerator: i128, denominator: i128) -> Option<Self> {
        match denominator.signum() {
            0 => None,
            1 => Some(Self { numerator, denominator }),
            _ => Some(Self { numerator: -numerator, denominator: -denominator }),
        }
    }

    /// Where a value that runs evenly from `a` to `b` is zero, as a fraction of the way; 0 where
    /// the two are equal.
    pub fn zero_between(a: i128, b: i128) -> Self {
        Self::new(a, a - b).unwrap_or(Self::whole(0))
    }

    /// A whole number.
    pub fn whole(numerator: i128) -> Self {
        Self { numerator, denominator: 1 }
    }

    /// The nearest double, give or take two roundings.
    pub fn to_f64(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }
}

impl Ord for Fraction {
    fn cmp(&self, other: &Self) -> Ordering {
        let (mut a, mut b) = (*self, *other);
        let mut turned = false;
        loop {
            // Compare the whole parts; what is left of both is less than 1.
            let wholes = [a, b].map(|f| f.numerator.div_euclid(f.denominator));
            let rests = [a, b].map(|f| f.numerator.rem_euclid(f.denominator));
            let order = match (wholes[0].cmp(&wholes[1]), rests) {
                (Ordering::Equal, [0, 0]) => Ordering::Equal,
                (Ordering::Equal, [0, _]) => Ordering::Less,
                (Ordering::Equal, [_, 0]) => Ordering::Greater,
                (Ordering::Equal, _) => {
                    // Go on with their reciprocals, whose order is the opposite.
                    a = Self { numerator: a.denominator, denominator: rests[0] };
                    b = Self { numerator: b.denominator, denominator: rests[1] };
                    turned = !turned;
                    continue;
                }
                (order, _) => order,
            };
            return if turned { order.reverse() } else { order };
        }
    }
}

impl PartialOrd for Fraction {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Fraction {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Fraction {}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Twice the area, in wide arithmetic.
    fn wide_area(a: GridPoint, b: GridPoint, p: GridPoint) -> i128 {
        let d = |p: GridPoint, k: usize| i128::from(p[k]) - i128::from(a[k]);
        d(b, 0) * d(p, 1) - d(b, 1) * d(p, 0)
    }

    /// The volume by the expansion along the last column, which shares no term with
    /// [`GridPlane::height`].
    fn wide_volume(t: [GridPoint; 3], p: GridPoint) -> i128 {
        let d = |a: GridPoint| [0, 1, 2].map(|k| i128::from(a[k]) - i128::from(p[k]));
        let [a, b, c] = t.map(d);
        let minor = |u: [i128; 3], v: [i128; 3]| u[0] * v[1] - u[1] * v[0];
        -(a[2] * minor(b, c) - b[2] * minor(a, c) + c[2] * minor(a, b))
    }

    fn fraction(n: i128, d: i128) -> Fraction {
        Fraction::new(n, d).unwrap()
    }

    fn point() -> impl Strategy<Value = GridPoint> {
        let across = -(1i32 << 23)..=1 << 23;
        (across.clone(), across, 0i32..=1 << 30).prop_map(|(x, y, z)| [x, y, z])
    }

    #[test]
    fn signs_follow_the_hand() {
        let t = [[0, 0, 0], [4, 0, 0], [0, 4, 0]];
        assert_eq!(orient2d(t[0], t[1], t[2]), 16);
        assert_eq!(orient2d(t[1], t[0], t[2]), -16);
        assert_eq!(orient2d(t[0], t[1], [9, 0, 7]), 0);
        let plane = GridPlane::new(t);
        assert_eq!(
            [plane.side([1, 1, 1]), plane.side([1, 1, -1]), plane.side([9, -5, 0])],
            [1, -1, 0]
        );
        assert_eq!((plane.height([1, 1, 3]), plane.snapping()), (48, 16.0));
    }

    #[test]
    fn the_largest_coordinates_do_not_overflow() {
        let (m, z) = (1 << 24, 1 << 30);
        let t = [[-m, -m, 0], [m, -m, z], [-m, m, z]];
        let plane = GridPlane::new(t);
        assert_eq!(plane.height([m, m, 0]), wide_volume(t, [m, m, 0]));
        assert_eq!(i128::from(orient2d(t[0], t[1], t[2])), wide_area(t[0], t[1], t[2]));
        assert!(plane.side([m, m, 0]) < 0);
    }

    #[test]
    fn fractions_without_denominator_are_none() {
        assert!(Fraction::new(1, 0).is_none());
        assert_eq!(fraction(-1, -2), fraction(2, 4));
        assert!(fraction(1, -3) < Fraction::whole(0) && fraction(1, 3) < fraction(334, 1000));
        assert_eq!(fraction(-7, 2).to_f64(), -3.5);
        assert_eq!(
            (Fraction::zero_between(-1, 3), Fraction::zero_between(5, 5)),
            (fraction(1, 4), Fraction::whole(0))
        );
    }

    proptest! {
        #[test]
        fn areas_and_volumes_are_exact(t in prop::array::uniform3(point()), p in point()) {
            prop_assert_eq!(i128::from(orient2d(t[0], t[1], t[2])), wide_area(t[0], t[1], t[2]));
            let plane = GridPlane::new(t);
            let exact = wide_volume(t, p);
            prop_assert_eq!(plane.height(p), exact);
            prop_assert_eq!(plane.side(p), exact.signum() as i32);
            let (about, error) = plane.rounded_height(p);
            prop_assert!((about - exact as f64).abs() <= error);
        }

        #[test]
        fn points_in_a_plane_and_beside_it_are_told_apart(
            t in prop::array::uniform3(point()), i in 0i32..8, j in 0i32..8, off in -1i32..=1,
        ) {
            // A corner, moved along whole multiples of the sides, then by a unit at most: the
            // products cancel down to the last bit.
            let small = t.map(|p| [p[0] / 64, p[1] / 64, p[2] / 64]);
            let moved = [0, 1, 2].map(|k| {
                small[0][k] + i * (small[1][k] - small[0][k]) + j * (small[2][k] - small[0][k])
            });
            let p = [moved[0], moved[1], moved[2] + off];
            let plane = GridPlane::new(small);
            let exact = i128::from(plane.normal[2]) * i128::from(off);
            prop_assert_eq!(plane.height(p), exact);
            prop_assert_eq!(plane.side(p), exact.signum() as i32);
        }

        #[test]
        fn snapping_bounds_what_rounding_does(
            t in prop::array::uniform3(point()), weights in prop::array::uniform3(0.0f64..1.0),
            moves in prop::array::uniform4(prop::array::uniform3(-0.5f64..0.5)),
        ) {
            // A point of the triangle; everything moves by up to half a unit and is then rounded,
            // which is another half: twice the bound.
            let sum: f64 = weights.iter().sum::<f64>().max(1e-9);
            let real = t.map(|p| p.map(f64::from));
            let at = [0, 1, 2].map(|k| (0..3).map(|i| real[i][k] * weights[i] / sum).sum::<f64>());
            let moved = |p: [f64; 3], m: [f64; 3]| [0, 1, 2].map(|k| (p[k] + m[k]).round() as i32);
            let plane = GridPlane::new([0, 1, 2].map(|i| moved(real[i], moves[i])));
            let (height, error) = plane.rounded_height(moved(at, moves[3]));
            prop_assert!(height.abs() <= 2.0 * plane.snapping() + error);
        }

        #[test]
        fn fractions_are_ordered_as_their_cross_products(
            a in -(1i128 << 62)..1 << 62, b in 1i128..1 << 62, c in -(1i128 << 62)..1 << 62, d in 1i128..1 << 62,
        ) {
            prop_assert_eq!(fraction(a, b).cmp(&fraction(c, d)), (a * d).cmp(&(c * b)));
            prop_assert_eq!(fraction(-a, -b).cmp(&fraction(c, d)), (a * d).cmp(&(c * b)));
        }

        #[test]
        fn fractions_of_products_beyond_all_bits_are_ordered(
            a in -(1i128 << 40)..1 << 40, b in 1i128..1 << 40, k in 2i128..1 << 80, by in -1i128..=1,
        ) {
            prop_assert_eq!(fraction(a * k + by, b * k).cmp(&fraction(a, b)), by.cmp(&0));
            prop_assert_eq!(fraction(a, b).cmp(&fraction(a * k + by, b * k)), 0.cmp(&by));
        }
    }
}
