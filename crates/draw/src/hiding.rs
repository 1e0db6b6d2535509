//! The part of an edge that one triangle hides.
//!
//! On the page, a triangle is the common part of three half planes; each cuts the edge in one place
//! at most, and the hidden part is an interval. In depth, the edge meets the triangle's plane in
//! one place at most: the signs of the ends' heights over the plane tell on which side of it the
//! triangle hides. All decisions are exact ([`vitral_math::exact`]).
//!
//! Hidden is what lies inside the triangle, its outline included, and behind it by more than
//! snapping can make of a contact: a line that lies in a face stays visible there, whatever the
//! last bits are.
//!
//! A triangle whose outline runs along the edge covers one side of it only. It hides, but a line
//! that runs under the common side of two triangles lies behind one layer and not two: an interval
//! tells on which [`Sides`] of the edge the triangle lies.
//!
//! In:   an edge and a triangle on the page. Out: the interval, if it has a length.
//! Cost: constant.

use crate::page_mesh::Triangle;
use crate::place::{EdgePosition, Maker, Segment};
use vitral_math::exact::orient2d;

/// The sides of an edge that a triangle covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sides {
    /// The edge runs through it.
    Both,
    /// It lies to the left of the edge, which runs along its outline.
    Left,
    /// It lies to the right.
    Right,
}

/// A part of an edge that a triangle hides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval {
    pub(crate) from: EdgePosition,
    pub(crate) to: EdgePosition,
    pub(crate) sides: Sides,
}

impl Segment<'_> {
    /// What of this edge the triangle with this number hides.
    #[inline]
    pub(crate) fn hidden_by(&self, number: u32, triangle: &Triangle) -> Option<Interval> {
        let covered = self.covered_by(number, triangle)?;
        self.behind(number, triangle, covered)
    }

    /// The part of the edge within the triangle's outline.
    #[inline]
    fn covered_by(&self, number: u32, triangle: &Triangle) -> Option<Interval> {
        let [p, q] = self.ends;
        let mut covered =
            Interval { from: EdgePosition::START, to: EdgePosition::END, sides: Sides::Both };

        // Narrow the interval by each side of the triangle.
        for side in 0..3 {
            let (u, v) = (triangle.corners[side], triangle.corners[(side + 1) % 3]);
            let (start, end) = (orient2d(u, v, p), orient2d(u, v, q));
            if start <= 0 && end <= 0 {
                // At most the outline is touched: in a point, or along the edge.
                if start < 0 || end < 0 {
                    return None;
                }
                let along = |k: usize| {
                    (i64::from(q[k]) - i64::from(p[k])) * (i64::from(v[k]) - i64::from(u[k]))
                };
                covered.sides = if along(0) + along(1) > 0 { Sides::Left } else { Sides::Right };
            } else if start < 0 || end < 0 {
                // Move an end to where the edge crosses the side.
                let about = start as f64 / (start - end) as f64;
                let place = EdgePosition {
                    about,
                    maker: Maker::Side { triangle: number, side: side as u8 },
                };
                if start < 0 && self.is_before(&covered.from, &place) {
                    covered.from = place;
                } else if end < 0 && self.is_before(&place, &covered.to) {
                    covered.to = place;
                }
            }
        }
        self.is_before(&covered.from, &covered.to).then_some(covered)
    }

    /// What of a covered part lies behind the triangle.
    #[inline]
    fn behind(&self, number: u32, triangle: &Triangle, covered: Interval) -> Option<Interval> {
        // Reject edges whose ends both lie in front of the plane.
        let [p, q] = self.ends;
        let plane = triangle.plane();
        let (start, end) = (plane.side(p), plane.side(q));
        if start >= 0 && end >= 0 {
            return None;
        }
        let mut hidden = covered;

        // Cut the interval at the crossing of the plane.
        if start * end < 0 {
            let (a, b) = (plane.height(p), plane.height(q));
            let place = EdgePosition {
                about: a as f64 / (a - b) as f64,
                maker: Maker::Plane { triangle: number },
            };
            if start > 0 && self.is_before(&hidden.from, &place) {
                hidden.from = place;
            } else if end > 0 && self.is_before(&place, &hidden.to) {
                hidden.to = place;
            }
            if !self.is_before(&hidden.from, &hidden.to) {
                return None;
            }
        }

        // Contacts: the deepest point lies no deeper than snapping can bring it.
        let ((a, _), (b, _)) = (plane.rounded_height(p), plane.rounded_height(q));
        let height = |place: &EdgePosition| a + place.about * (b - a);
        let deepest = height(&hidden.from).min(height(&hidden.to));
        (deepest < -plane.snapping()).then_some(hidden)
    }
}

#[cfg(test)]
mod tests {
    use super::Sides::{Both, Left, Right};
    use super::*;
    use crate::page_mesh::PageMesh;

    const BIG: [[i32; 3]; 3] = [[0, 0, 1000], [4000, 0, 1000], [0, 4000, 1000]];

    /// The hidden part of an edge, in thousandths, and the covered sides.
    fn hidden(corners: [[i32; 3]; 3], ends: [[i32; 3]; 2]) -> Option<(i32, i32, Sides)> {
        let mesh =
            PageMesh { triangles: vec![Triangle::new(corners, [0, 1, 2])], ..PageMesh::default() };
        let part = Segment { mesh: &mesh, ends }.hidden_by(0, &mesh.triangles[0])?;
        let thousandths = |place: EdgePosition| (place.about * 1000.0).round() as i32;
        Some((thousandths(part.from), thousandths(part.to), part.sides))
    }

    #[test]
    fn what_is_inside_and_behind_is_hidden() {
        assert_eq!(hidden(BIG, [[500, 500, 0], [1000, 1000, 0]]), Some((0, 1000, Both)));
        assert_eq!(hidden(BIG, [[-1000, 1000, 0], [9000, 1000, 0]]), Some((100, 400, Both)));
        assert_eq!(hidden(BIG, [[500, 500, 2000], [1000, 1000, 2000]]), None, "in front");
        assert_eq!(hidden(BIG, [[5000, 500, 0], [9000, 1000, 0]]), None, "beside");
        assert_eq!(
            hidden(BIG, [[-1000, 1000, 2000], [9000, 1000, -3000]]),
            Some((200, 400, Both)),
            "piercing"
        );
        assert_eq!(
            hidden(BIG, [[9000, 1000, -3000], [-1000, 1000, 2000]]),
            Some((600, 800, Both)),
            "the other way"
        );
    }

    #[test]
    fn the_outline_hides_and_covers_one_side() {
        assert_eq!(hidden(BIG, [[1000, 0, 0], [2000, 0, 0]]), Some((0, 1000, Left)));
        assert_eq!(hidden(BIG, [[2000, 0, 0], [1000, 0, 0]]), Some((0, 1000, Right)));
        assert_eq!(hidden(BIG, [[0, 0, 0], [-100, -100, 0]]), None, "a corner alone");
        assert_eq!(hidden(BIG, [[-500, 500, 0], [500, -500, 0]]), None, "through a corner");
    }

    #[test]
    fn contacts_hide_nothing() {
        assert_eq!(hidden(BIG, [[500, 500, 1000], [1000, 1000, 1000]]), None, "in the plane");
        assert_eq!(hidden(BIG, [[500, 500, 999], [1000, 1000, 999]]), None, "a unit behind");
        assert_eq!(hidden(BIG, [[500, 500, 998], [1000, 1000, 998]]), Some((0, 1000, Both)));
        assert_eq!(
            hidden(BIG, [[500, 500, 1000], [1000, 1000, 900]]),
            Some((0, 1000, Both)),
            "leaving the plane"
        );
    }
}
