//! Shapes on a grid that is finer than the page's, and their overlays.
//!
//! A shape is an outline, counter-clockwise, with holes, clockwise. The overlay of polygons is the
//! crate `i_overlay`'s.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;
use vitral_math::exact::GridPoint;

/// Steps of the finer grid in a unit of the page: the corners of the pieces of clipped polygons
/// are rounded to it.
pub(crate) const FINER: i32 = 128;
/// Shapes that are nowhere wider, in units of the page, are traces of rounding where they are not
/// wanted.
const HAIR: f64 = 0.25;

/// A corner of the finer grid.
pub(crate) type Corner = IntPoint<i32>;
/// Outlines with their holes.
pub(crate) type Shapes = Vec<Vec<Vec<Corner>>>;

/// The corner nearest to a point in units of the page.
pub(crate) fn corner_at([x, y]: [f64; 2]) -> Corner {
    IntPoint::new((x * f64::from(FINER)).round() as i32, (y * f64::from(FINER)).round() as i32)
}

/// The corner at a fraction of the way from one point of the page to another.
pub(crate) fn corner_between(from: GridPoint, way: f64, to: GridPoint) -> Corner {
    let at = |k: usize| {
        let (p, q) = (f64::from(from[k]), f64::from(to[k]));
        p + way * (q - p)
    };
    corner_at([at(0), at(1)])
}

/// A corner in units of the page.
pub(crate) fn on_page(corner: &Corner) -> [f64; 2] {
    [corner.x, corner.y].map(|c| f64::from(c) / f64::from(FINER))
}

/// The part of `subject` outside `polygons`.
pub(crate) fn without<'p>(
    subject: &Shapes,
    polygons: impl IntoIterator<Item = &'p Vec<Corner>>,
) -> Shapes {
    overlaid(subject, polygons, OverlayRule::Difference)
}

/// What `subject` has in common with the union of `polygons`.
pub(crate) fn within<'p>(
    subject: &Shapes,
    polygons: impl IntoIterator<Item = &'p Vec<Corner>>,
) -> Shapes {
    overlaid(subject, polygons, OverlayRule::Intersect)
}

fn overlaid<'p>(
    subject: &Shapes,
    polygons: impl IntoIterator<Item = &'p Vec<Corner>>,
    rule: OverlayRule,
) -> Shapes {
    let mut overlay = Overlay::<i32>::new(16);
    subject.iter().flatten().for_each(|ring| overlay.add_contour(ring, ShapeType::Subject));
    polygons.into_iter().for_each(|polygon| overlay.add_contour(polygon, ShapeType::Clip));
    overlay.overlay(rule, FillRule::NonZero)
}

/// The union of shapes, without those that are smaller than `least`, in steps squared, and without
/// such holes.
pub(crate) fn union<'s>(all: impl IntoIterator<Item = &'s Shapes>, least: u64) -> Shapes {
    let options = IntOverlayOptions { min_output_area: least, ..IntOverlayOptions::default() };
    let mut overlay = Overlay::<i32>::new_custom(64, options, Default::default());
    for ring in all.into_iter().flatten().flatten() {
        overlay.add_contour(ring, ShapeType::Subject);
    }
    overlay.overlay(OverlayRule::Subject, FillRule::NonZero)
}

/// Where at least `count` of some counter-clockwise polygons lie over each other.
pub(crate) fn covered(polygons: &[Vec<Corner>], count: usize) -> Vec<Vec<Corner>> {
    let corners = || polygons.iter().flatten();
    let (Some(left), Some(right)) = (corners().map(|p| p.x).min(), corners().map(|p| p.x).max())
    else {
        return Vec::new();
    };
    let (Some(bottom), Some(top)) = (corners().map(|p| p.y).min(), corners().map(|p| p.y).max())
    else {
        return Vec::new();
    };
    // Each clockwise box takes one from how often a place is covered.
    let mut overlay = Overlay::<i32>::new(polygons.len() * 4);
    polygons.iter().for_each(|polygon| overlay.add_contour(polygon, ShapeType::Subject));
    let clockwise = [[left, bottom], [left, top], [right, top], [right, bottom]]
        .map(|[x, y]| IntPoint::new(x, y));
    (1..count).for_each(|_| overlay.add_contour(&clockwise, ShapeType::Subject));
    overlay.overlay(OverlayRule::Subject, FillRule::Positive).into_iter().flatten().collect()
}

/// The area of shapes, in steps squared.
pub(crate) fn area_of(shapes: &Shapes) -> f64 {
    shapes.iter().flatten().map(|ring| area_and_outline(ring)[0]).sum()
}

/// The area inside a ring, positive where it runs counter-clockwise, and its length.
fn area_and_outline(ring: &[Corner]) -> [f64; 2] {
    let (mut area, mut outline) = (0.0, 0.0);
    for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        let [ax, ay, bx, by] = [a.x, a.y, b.x, b.y].map(f64::from);
        area += ax * by - bx * ay;
        outline += ((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt();
    }
    [area / 2.0, outline]
}

/// Without shapes that are nowhere wider than a hair.
pub(crate) fn without_hairs(mut shapes: Shapes) -> Shapes {
    shapes.retain(|shape| {
        let [area, outline] = shape
            .iter()
            .map(|ring| area_and_outline(ring))
            .fold([0.0; 2], |s, r| [s[0] + r[0], s[1] + r[1]]);
        // A strip has half its outline times its width.
        area.abs() > outline / 2.0 * HAIR * f64::from(FINER)
    });
    shapes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(at: i32, side: i32) -> Vec<Corner> {
        [[0, 0], [side, 0], [side, side], [0, side]]
            .map(|[x, y]| IntPoint::new(at + x, at + y))
            .to_vec()
    }

    fn area(rings: &[Vec<Corner>]) -> f64 {
        let ring = |ring: &Vec<Corner>| {
            ring.iter().map(|p| [f64::from(p.x), f64::from(p.y)]).collect::<Vec<_>>()
        };
        rings.iter().map(|r| vitral_frame::drawing::signed_area(&ring(r))).sum()
    }

    #[test]
    fn layers_are_counted_where_polygons_lie_over_each_other() {
        let all = [square(0, 100), square(50, 100), square(50, 25), square(50, 25)];
        let areas = [1, 2, 3, 4, 5].map(|count| area(&covered(&all, count)));
        assert_eq!(areas, [17_500.0, 2_500.0, 625.0, 625.0, 0.0]);
        assert!(covered(&[], 1).is_empty());
    }

    #[test]
    fn differences_common_parts_and_unions_have_their_areas() {
        let (big, small) = (vec![vec![square(0, 100)]], square(90, 30));
        assert_eq!(without(&big, [&small]).iter().map(|s| area(s)).sum::<f64>(), 9_900.0);
        assert_eq!(within(&big, [&small]).iter().map(|s| area(s)).sum::<f64>(), 100.0);
        let all = union([&big, &vec![vec![small]]], 0);
        assert_eq!((all.len(), area(&all[0])), (1, 10_800.0));
    }

    #[test]
    fn hairs_are_narrow_and_not_small() {
        let strip = |width: i32| {
            [[0, 0], [10_000, 0], [10_000, width], [0, width]]
                .map(|[x, y]| IntPoint::new(x, y))
                .to_vec()
        };
        assert_eq!(
            without_hairs(vec![vec![strip(20)], vec![strip(80)], vec![square(0, 200)]]).len(),
            2
        );
    }
}
