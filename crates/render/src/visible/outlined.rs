//! Polygons as algorithms come to them before they look at samples: what a vector drawing is made
//! of.
//!
//! Painter's algorithm and BSP trees end in a list from back to front, Weiler–Atherton in polygons
//! that do not overlap. All three work with corners on the grid of 1/256 pixel. For a drawing the
//! picture is as large as pictures can be, so that the grid is finer than a drawing's precision,
//! and no sample is ever looked at.
//!
//! In:   outlines on the screen (1/256 pixel, y downwards). Out: the same on a page whose width and
//!       height are 1, y upwards.
//! Cost: linear in corners.

use crate::stats::VisibilityCounters;
use crate::{Execution, PreparedView};
use vitral_exec::Limit;
use vitral_raster::{SUBPIXEL, Viewport};

/// An algorithm that comes to polygons.
pub trait PolygonAlgorithm: Sync {
    /// Adds the polygons in their order to `list`, and counts how they came about.
    ///
    /// # Errors
    /// A limit of the budget.
    fn polygons(
        &self,
        view: &PreparedView<'_>,
        execution: &Execution,
        list: &mut PolygonList,
    ) -> Result<(), Limit>;
}

/// A polygon, or what an algorithm made of one.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlinedPolygon {
    /// The facets of the polygon that it is a part of, first the one by which that is named.
    pub facets: Vec<u32>,
    /// Outlines, closed without repeating the first point: counter-clockwise round the polygon,
    /// clockwise round holes. The page reaches from `[0, 0]`, lower left, to `[1, 1]`.
    pub outlines: Vec<Vec<[f64; 2]>>,
}

/// Polygons in the order in which they are painted.
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonList {
    /// The polygons.
    pub polygons: Vec<OutlinedPolygon>,
    /// Polygons of the model that took part: flat convex faces, and the convex parts of others.
    pub wholes: u64,
    /// What the algorithm did.
    pub counters: VisibilityCounters,
    viewport: Viewport,
}

impl PolygonList {
    /// None yet, of a picture of this size.
    pub(crate) fn new(viewport: Viewport) -> Self {
        Self { polygons: Vec::new(), wholes: 0, counters: VisibilityCounters::default(), viewport }
    }

    /// Adds a convex polygon, given clockwise on the screen, as far as it lies in the picture.
    pub(super) fn push_convex(&mut self, facets: Vec<u32>, corners: &[[f64; 2]]) {
        let size = self.size();
        let (mut inside, mut from) = (corners.to_vec(), Vec::new());
        for (axis, side) in [(0, 0.0), (1, 0.0), (0, size[0]), (1, size[1])] {
            std::mem::swap(&mut inside, &mut from);
            clip_along(axis, side, side > 0.0, &from, &mut inside);
        }
        if inside.len() > 2 {
            self.push(facets, [inside]);
        }
    }

    /// Adds a polygon by its outlines, clockwise on the screen, those of holes the other way round.
    pub(super) fn push(
        &mut self,
        facets: Vec<u32>,
        outlines: impl IntoIterator<Item = Vec<[f64; 2]>>,
    ) {
        let [width, height] = self.size();
        let on_page = |[x, y]: [f64; 2]| [x / width, 1.0 - y / height];
        let outlines =
            outlines.into_iter().map(|corners| corners.into_iter().rev().map(on_page).collect());
        self.polygons.push(OutlinedPolygon { facets, outlines: outlines.collect() });
    }

    /// Width and height of the picture, 1/256 pixel.
    fn size(&self) -> [f64; 2] {
        [self.viewport.width, self.viewport.height]
            .map(|side| f64::from(side) * f64::from(SUBPIXEL))
    }
}

/// Cuts off what lies beyond a border of the picture: above `side` where `is_upper`, else below.
fn clip_along(axis: usize, side: f64, is_upper: bool, from: &[[f64; 2]], to: &mut Vec<[f64; 2]>) {
    to.clear();
    let within = |p: &[f64; 2]| if is_upper { p[axis] <= side } else { p[axis] >= side };
    for (i, p) in from.iter().enumerate() {
        let q = &from[(i + 1) % from.len()];
        if within(p) {
            to.push(*p);
        }
        if within(p) != within(q) {
            let way = (side - p[axis]) / (q[axis] - p[axis]);
            let mut border = [0, 1].map(|k| p[k] + (q[k] - p[k]) * way);
            border[axis] = side;
            to.push(border);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_lie_on_the_page_with_y_upwards_and_end_at_its_border() {
        let mut list = PolygonList::new(Viewport::new(4, 2).unwrap());
        let square = |x0: f64, y0: f64, x1: f64, y1: f64| [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        list.push_convex(vec![7], &square(256.0, 0.0, 512.0, 256.0));
        list.push_convex(vec![8], &square(-600.0, 256.0, 256.0, 9000.0));
        list.push_convex(vec![9], &square(2000.0, 0.0, 2100.0, 9.0));
        assert_eq!(list.polygons.iter().map(|p| p.facets[0]).collect::<Vec<_>>(), [7, 8]);
        assert_eq!(list.polygons[0].outlines, [[[0.25, 0.5], [0.5, 0.5], [0.5, 1.0], [0.25, 1.0]]]);
        let corners = &list.polygons[1].outlines[0];
        let mut sorted = corners.clone();
        sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        assert_eq!(sorted, [[0.0, 0.0], [0.0, 0.5], [0.25, 0.0], [0.25, 0.5]]);
    }
}
