//! Extents: intervals in one dimension, windows in two. The cheapest test that two things do not
//! meet.
//!
//! Idea: if the projections of two polygons on one axis are apart, so are the polygons. The
//! converse does not hold: windows may overlap while the polygons pass each other by, so "overlap"
//! only means "look closer".
//!
//! In:   coordinates in any one space; NaN is passed over.
//! Out:  whether extents overlap. Touching counts: nothing is lost by looking closer.
//! Cost: constant.
//! Source: the course, notes P (docs/course.md P11, P12); [Foley et al. 1990], section 15.2.3.

use vitral_math::DVec2;

/// A closed interval; empty if `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent1 {
    /// Lower end.
    pub min: f64,
    /// Upper end.
    pub max: f64,
}

impl Extent1 {
    /// The interval that holds nothing.
    pub const EMPTY: Self = Self { min: f64::INFINITY, max: f64::NEG_INFINITY };

    /// The smallest interval that holds all `values`.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        values.into_iter().fold(Self::EMPTY, |e, v| Self { min: e.min.min(v), max: e.max.max(v) })
    }

    /// No overlap if and only if one ends before the other begins: `max2 < min1` or `max1 < min2`.
    pub fn overlaps(&self, other: &Self) -> bool {
        !(other.max < self.min || self.max < other.min)
    }

    /// Whether they share more than one number, or one is a number within the other: where extents
    /// only touch, polygons share no area.
    pub fn crosses(&self, other: &Self) -> bool {
        self.min < other.max && other.min < self.max
    }
}

/// A window: an extent in x and one in y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent2 {
    /// Along x.
    pub x: Extent1,
    /// Along y.
    pub y: Extent1,
}

impl Extent2 {
    /// The smallest window round `points`.
    pub fn of(points: impl IntoIterator<Item = DVec2> + Clone) -> Self {
        Self {
            x: Extent1::of(points.clone().into_iter().map(|p| p.x)),
            y: Extent1::of(points.into_iter().map(|p| p.y)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use vitral_math::dvec2;

    /// Windows overlap if their extents overlap along both axes.
    fn overlap(a: &Extent2, b: &Extent2) -> bool {
        a.x.overlaps(&b.x) && a.y.overlaps(&b.y)
    }

    #[test]
    fn p11_windows_of_two_triangles_in_figures_a_and_b() {
        let lower = [dvec2(0.0, 0.0), dvec2(4.0, 0.0), dvec2(0.0, 4.0)];
        // a: far apart, told by the windows alone.
        let far = lower.map(|p| p + dvec2(5.0, 1.0));
        assert!(!overlap(&Extent2::of(lower), &Extent2::of(far)));
        // b: the windows overlap, the triangles do not: the line x + y = 5 lies between them.
        let near = [dvec2(4.0, 4.0), dvec2(4.0, 2.0), dvec2(2.0, 4.0)];
        assert!(overlap(&Extent2::of(lower), &Extent2::of(near)));
        assert!(lower.iter().all(|p| p.x + p.y < 5.0) && near.iter().all(|p| p.x + p.y > 5.0));
    }

    #[test]
    fn touching_overlaps_and_nothing_overlaps_the_empty() {
        let a = Extent1 { min: 0.0, max: 1.0 };
        assert!(a.overlaps(&Extent1 { min: 1.0, max: 2.0 }));
        assert!(!a.overlaps(&Extent1::EMPTY) && !Extent1::EMPTY.overlaps(&a));
        assert_eq!(Extent1::of([f64::NAN, 1.0, 0.0]), a);
        let crosses = |min, max| a.crosses(&Extent1 { min, max });
        assert!(
            crosses(0.5, 2.0) && crosses(0.5, 0.5) && !crosses(1.0, 2.0) && !crosses(-1.0, 0.0)
        );
        assert!(!a.crosses(&Extent1::EMPTY));
    }

    proptest! {
        #[test]
        fn p12_extents_overlap_if_and_only_if_they_share_a_number(a in -9i8..9, b in -9i8..9, c in -9i8..9, d in -9i8..9) {
            let [z1, z2] = [[a, b], [c, d]].map(|z| Extent1::of(z.map(f64::from)));
            // With whole ends, a shared number can be taken to be whole.
            let shared = (-9i8..9).any(|k| [z1, z2].iter().all(|z| z.min <= f64::from(k) && f64::from(k) <= z.max));
            prop_assert_eq!(z1.overlaps(&z2), shared);
            prop_assert_eq!(z2.overlaps(&z1), shared);
        }

        #[test]
        fn p11_polygons_that_share_a_point_have_overlapping_windows(
            p in prop::array::uniform6(-9.0f64..9.0), q in prop::array::uniform6(-9.0f64..9.0),
        ) {
            // Two triangles that share their middles after a shift.
            let triangle = |t: [f64; 6]| [dvec2(t[0], t[1]), dvec2(t[2], t[3]), dvec2(t[4], t[5])];
            let (p, q) = (triangle(p), triangle(q));
            let middle = |t: [DVec2; 3]| (t[0] + t[1] + t[2]) / 3.0;
            let shifted = q.map(|v| v + middle(p) - middle(q));
            prop_assert!(overlap(&Extent2::of(p), &Extent2::of(shifted)));
        }
    }
}
