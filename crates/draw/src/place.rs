//! Places along an edge: its ends, where it crosses the side of a triangle, where it pierces a
//! triangle.
//!
//! A place is known by what makes it, and about where it is. Most comparisons are decided by the
//! rounded fraction; those that are not compute the exact fractions from the grid points that make
//! the places.

use crate::page_mesh::PageMesh;
use std::cmp::Ordering;
use vitral_math::exact::{Fraction, GridPoint, orient2d};

/// Rounded fractions that differ by more are in the order of the exact ones: each is a quotient of
/// two rounded numbers and at most 1.
const CERTAIN: f64 = 1e-14;

/// A place along an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EdgePosition {
    /// About which fraction of the way from the first end it is.
    pub(crate) about: f64,
    /// What makes it.
    pub(crate) maker: Maker,
}

/// What makes a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Maker {
    /// The edge's first end.
    Start,
    /// Its second end.
    End,
    /// A side of a triangle: on the page the two cross.
    Side {
        /// The triangle whose side it is.
        triangle: u32,
        /// The side from this corner to the next.
        side: u8,
    },
    /// A triangle that the edge pierces.
    Plane {
        /// The pierced triangle.
        triangle: u32,
    },
}

impl EdgePosition {
    /// The first end.
    pub(crate) const START: Self = Self { about: 0.0, maker: Maker::Start };
    /// The second end.
    pub(crate) const END: Self = Self { about: 1.0, maker: Maker::End };
}

/// An edge on the page, from its first end to its second.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment<'m> {
    pub(crate) mesh: &'m PageMesh,
    pub(crate) ends: [GridPoint; 2],
}

impl Segment<'_> {
    /// The order of two places along the edge.
    #[inline]
    pub(crate) fn compare(&self, a: &EdgePosition, b: &EdgePosition) -> Ordering {
        let difference = a.about - b.about;
        if difference < -CERTAIN {
            Ordering::Less
        } else if difference > CERTAIN {
            Ordering::Greater
        } else if a.maker == b.maker {
            Ordering::Equal
        } else {
            self.fraction(a.maker).cmp(&self.fraction(b.maker))
        }
    }

    /// Whether `a` comes before `b`.
    #[inline]
    pub(crate) fn is_before(&self, a: &EdgePosition, b: &EdgePosition) -> bool {
        self.compare(a, b).is_lt()
    }

    /// Exactly where a place is.
    #[cold]
    fn fraction(&self, maker: Maker) -> Fraction {
        let [p, q] = self.ends;
        match maker {
            Maker::Start => Fraction::whole(0),
            Maker::End => Fraction::whole(1),
            Maker::Side { triangle, side } => {
                let corners = self.mesh.triangles[triangle as usize].corners;
                let (u, v) = (corners[side as usize], corners[(side as usize + 1) % 3]);
                Fraction::zero_between(orient2d(u, v, p).into(), orient2d(u, v, q).into())
            }
            Maker::Plane { triangle } => {
                let plane = self.mesh.triangles[triangle as usize].plane();
                Fraction::zero_between(plane.height(p), plane.height(q))
            }
        }
    }

    /// The point of the page at a place, in units.
    pub(crate) fn point(&self, place: &EdgePosition) -> [f64; 2] {
        let [p, q] = self.ends.map(|p| [p[0], p[1]].map(f64::from));
        match place.maker {
            Maker::Start => p,
            Maker::End => q,
            _ => [0, 1].map(|k| p[k] + place.about * (q[k] - p[k])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page_mesh::Triangle;

    #[test]
    fn places_that_rounding_cannot_tell_apart_are_ordered() {
        // Two sides cross a long edge at fractions that differ by about 2^-56: their numerators by
        // 1 of 2^28.
        let triangle = |x: i32, dx: i32| {
            Triangle::new([[x, 0, 0], [x + dx, 1 << 14, 0], [0, 1 << 14, 0]], [0, 1, 2])
        };
        let mesh = PageMesh {
            triangles: vec![triangle(1 << 13, 1), triangle(1 << 13, 1), triangle(1 << 13, 2)],
            ..PageMesh::default()
        };
        let segment = Segment { mesh: &mesh, ends: [[0, 1, 0], [1 << 14, 1, 0]] };
        let at = |triangle| EdgePosition { about: 0.5, maker: Maker::Side { triangle, side: 0 } };
        assert_eq!(segment.compare(&at(0), &at(1)), Ordering::Equal);
        assert_eq!(segment.compare(&at(0), &at(2)), Ordering::Less);
        assert!(
            segment.is_before(&EdgePosition::START, &at(0))
                && segment.is_before(&at(2), &EdgePosition::END)
        );
        assert_eq!(segment.point(&at(0)), [8192.0, 1.0]);
        // A plane that rises along the edge.
        let slope = Triangle::new([[0, 0, -8], [1 << 14, 0, 8], [0, 1 << 14, -8]], [0, 1, 2]);
        let mesh = PageMesh { triangles: vec![slope], ..PageMesh::default() };
        let segment = Segment { mesh: &mesh, ends: [[0, 1, 0], [1 << 14, 1, 0]] };
        let half = EdgePosition { about: 0.5, maker: Maker::Plane { triangle: 0 } };
        assert_eq!(segment.fraction(half.maker), Fraction::zero_between(-1, 1));
    }
}
