//! Polygons of the list, and which of two hides the other.
//!
//! In:   polygons and a region of the screen. Out: whether one is hidden there by the other, or
//!       beyond which line.
//! Cost: linear in the region's edges.

use super::line::{Line, MAX_OFFSET, MAX_SLOPE};
use super::region::{ConvexOutline, Region};
use crate::visible::polygons::{ConvexPolygon, same_plane};
use vitral_raster::{SUBPIXEL, Setup};

/// A polygon as it came in.
#[derive(Debug)]
pub(super) struct AreaPolygon<'p> {
    pub(super) plane: &'p Setup,
    /// Its number among the view's polygons.
    pub(super) number: u32,
    /// Lowest and highest facet that it is of.
    facets: [u32; 2],
    pub(super) shape: ConvexOutline,
    /// Change of depth for 1/256 pixel.
    slope: [f64; 2],
}

impl<'p> AreaPolygon<'p> {
    pub(super) fn new(number: u32, polygon: ConvexPolygon<'p, '_>) -> Self {
        let plane = polygon.plane();
        let slope = [plane.dz_dx, plane.dz_dy].map(|d| f64::from(d) / f64::from(SUBPIXEL));
        Self {
            plane,
            number,
            facets: polygon.facets(),
            shape: ConvexOutline::polygon(polygon.outline()),
            slope,
        }
    }

    /// What moving from the plane's origin adds to its depth, for x and for y.
    fn change(&self, p: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (p[k] - f64::from(self.plane.origin[k])) * self.slope[k])
    }

    /// The plane's depth, not clamped.
    fn depth(&self, p: [f64; 2]) -> f64 {
        let [x, y] = self.change(p);
        f64::from(self.plane.z) + x + y
    }

    /// How far [`Setup::depth`] may be from that: four roundings to 24 bits, of numbers no larger
    /// than the sum.
    fn rounding(&self, p: [f64; 2]) -> f64 {
        let [x, y] = self.change(p);
        (f64::from(self.plane.z.abs()) + x.abs() + y.abs()) * f64::from(f32::EPSILON) * 4.0
    }
}

/// What a region of one polygon is to another that covers it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum DepthRelation {
    /// Behind it at every sample.
    Hidden,
    /// Nowhere certainly behind.
    Visible,
    /// Behind it somewhere; depths are certain by `margin`.
    Partly { margin: f64 },
}

/// Looks at the corners of a region: between them depths are linear, apart from rounding and from
/// the clamping to the facet's own range, for which there has to be room.
pub(super) fn relation(
    front: &AreaPolygon<'_>,
    back: &AreaPolygon<'_>,
    region: &Region,
) -> DepthRelation {
    // Decide by the ranges of depth if they do not overlap.
    let (near, far) = (front.plane, back.plane);
    if near.z_min > far.z_max {
        return DepthRelation::Hidden;
    }
    if same_plane(near, far) {
        // Where ids of facets mix, each sample decides.
        return if front.facets[1] < back.facets[0] {
            DepthRelation::Hidden
        } else {
            DepthRelation::Visible
        };
    }

    // Compare depths at all corners.
    let (mut smallest, mut largest) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut margin, mut room) = (0.0f64, near.z_max > far.z_min);
    let (mut nearest_back, mut farthest_front) = (f64::NEG_INFINITY, f64::INFINITY);
    for edge in region.edges() {
        let place = edge.about[0];
        let [a, b] = [front, back].map(|p| p.depth(place));
        (smallest, largest) = (smallest.min(a - b), largest.max(a - b));
        (farthest_front, nearest_back) = (farthest_front.min(a), nearest_back.max(b));
        // f64::max would swallow a NaN.
        let rounding = front.rounding(place) + back.rounding(place);
        margin = if rounding <= margin { margin } else { rounding };
    }

    // Compare the differences with the rounding.
    room &= farthest_front - margin > f64::from(far.z_min)
        && nearest_back + margin < f64::from(near.z_max);
    if smallest > margin && room {
        DepthRelation::Hidden
    } else if largest > margin {
        DepthRelation::Partly { margin }
    } else {
        DepthRelation::Visible
    }
}

/// The line, with whole coefficients, beyond which, in a box, `front` is nearer than `back` by
/// `margin`, and a little more for the rounding of the coefficients.
pub(super) fn line_of_gap(
    front: &AreaPolygon<'_>,
    back: &AreaPolygon<'_>,
    margin: f64,
    [x0, y0, x1, y1]: [f64; 4],
) -> Option<Line> {
    let [dx, dy] = [0, 1].map(|k| front.slope[k] - back.slope[k]);
    let middle = [(x0 + x1) * 0.5, (y0 + y1) * 0.5].map(f64::round);
    let gap = front.depth(middle) - back.depth(middle) - margin;
    let scale = MAX_SLOPE as f64 / dx.abs().max(dy.abs());
    let (a, b) = ((dx * scale).round(), (dy * scale).round());
    // Half a unit in a and in b makes a quarter of the box's sides, at its corners.
    let slack = ((x1 - x0) + (y1 - y0)) * 0.25 + 2.0;
    let c = (gap * scale).floor() - slack.ceil() - a * middle[0] - b * middle[1];
    let fits = scale.is_finite() && c.abs() < MAX_OFFSET as f64;
    fits.then_some(Line { a: a as i32, b: b as i32, c: c as i64 })
}
