//! Several views on one sheet, placed as the rules of orthographic projection demand.
//!
//! The front view stands in the middle of a grid of columns and rows. Views from the sides share
//! its row, those from above and below its column; columns and rows are [`GAP`] apart, and all are
//! to one scale, so that a point of the model is at the same height in all views of the row and at
//! the same place across in all of the column.
//!
//! | method | view from the right | from the left | from above | from below | from behind |
//! |---|---|---|---|---|---|
//! | first angle | left of the front | right of it | below it | above it | beside the left view, else the right one |
//! | third angle | right of the front | left of it | above it | below it | beside the right view, else the left one |
//!
//! The axonometric view comes into a corner of the grid that is free, or beside or below all if
//! there is none; of several such places it takes the one that leaves the largest scale. Where a
//! scale is given at which it does not fit, it alone gets a smaller one.
//!
//! In:   a world, the views and the page. Out: a camera and a place for each view; drawings put
//!       together.
//! Cost: constant, but for the extents of the world along the views' axes.
//! Source: \[ISO 5456-2\] for the places of the views and the symbol.

mod axis;
mod symbol;

pub use symbol::{SYMBOL_SIZE, symbol};

use crate::{DrawingStats, Drawn, PageSize};
use axis::{Row, Spot};
use std::iter::zip;
use vitral_exec::Workers;
use vitral_frame::Drawing;
use vitral_scene::framing::reach;
use vitral_scene::{Axis, Camera, Lens, Projection, View, World, frame};

/// Millimetres between views.
pub const GAP: f64 = 15.0;
/// The camera's window is larger than the model by this factor, so that nothing is cut at its
/// border.
const ROOM: f64 = 1.001;
/// The longest side of a sheet that fits views to scale, in millimetres.
const LONGEST: f64 = 10_000.0;
/// Differences of scales below this share do not count.
const EQUAL: f64 = 1e-9;
/// What views may be larger than the sheet for rounding, in millimetres.
const ROUNDING: f64 = 1e-6;

/// How views are placed round the front view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Angle {
    /// First-angle projection, as is usual in Europe: the view from the right stands on the
    /// left.
    #[default]
    First,
    /// Third-angle projection, as is usual in America: the view from the right stands on the
    /// right.
    Third,
}

/// The views of a sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// The views, each once.
    pub views: Vec<View>,
    /// How they are placed.
    pub angle: Angle,
    /// Millimetres on paper for a unit of the world; `None`: as large as the page allows.
    pub scale: Option<f64>,
}

/// Why a sheet cannot be laid out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SheetError {
    /// A list of views that is empty, or names one twice.
    #[error("a sheet needs views, each once")]
    Views,
    /// The views are larger than the page.
    #[error("the views need {:.1} x {:.1} mm, the sheet has room for {:.1} x {:.1} mm", size[0], size[1], room[0], room[1])]
    TooLarge {
        /// Width and height of all in millimetres.
        size: [f64; 2],
        /// What the page has room for.
        room: [f64; 2],
        /// The largest scale that fits; `None`: not even the gaps do.
        fitting: Option<f64>,
    },
}

/// Where a view is on its sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedView {
    /// Which one.
    pub view: View,
    /// Millimetres for a unit of the world.
    pub scale: f64,
    /// The lower left and the upper right corner of the box round it, in millimetres.
    pub corners: [[f64; 2]; 2],
    /// The camera that sees it.
    pub camera: Camera,
    /// Millimetres along a side of the camera's window, which is a square.
    pub window: f64,
    /// How far the window's drawing is moved on the sheet, in whole micrometres: the step of
    /// drawings.
    pub shift: [f64; 2],
}

/// A sheet with a place for each view.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetLayout {
    /// Width and height of the sheet in millimetres.
    pub size: [f64; 2],
    /// The views, in the order of the list.
    pub views: Vec<PlacedView>,
}

/// A view and how far the model reaches from the middle of its box: to the left, down, to the
/// right, up.
#[derive(Clone, Copy, Debug)]
struct Extent {
    view: View,
    low: [f64; 2],
    high: [f64; 2],
    camera: Camera,
}

impl Sheet {
    /// Finds the scale and places the views. [`PageSize::Scaled`] and [`PageSize::Window`] belong
    /// to single views: of them the sheet counts alone.
    ///
    /// # Errors
    /// [`SheetError`].
    pub fn lay_out(
        &self,
        world: &World,
        up: Axis,
        page: PageSize,
        margin: f64,
        workers: &Workers,
    ) -> Result<SheetLayout, SheetError> {
        let twice = (1..self.views.len()).any(|i| self.views[..i].contains(&self.views[i]));
        if self.views.is_empty() || twice {
            return Err(SheetError::Views);
        }
        let extents: Vec<Extent> =
            self.views.iter().map(|&view| Extent::new(world, view, up, workers)).collect();
        self.place(&extents, page, margin)
    }

    /// Places views of these extents.
    fn place(
        &self,
        extents: &[Extent],
        page: PageSize,
        margin: f64,
    ) -> Result<SheetLayout, SheetError> {
        // Find the room on the sheet.
        let (sheet, longest) = match page {
            PageSize::Sheet { width, height }
            | PageSize::Scaled { sheet: Some([width, height]), .. } => {
                (Some([width, height]), f64::INFINITY)
            }
            PageSize::Fit { longer } if self.scale.is_none() => (None, longer),
            _ => (None, LONGEST),
        };
        let room = sheet.map_or([longest; 2], |sheet| sheet.map(|side| side - 2.0 * margin));

        // Sort the orthographic views into columns and rows, and find the best spot for the
        // axonometric one.
        let rows = [
            Row::new(extents, 0, |view| self.column(view)),
            Row::new(extents, 1, |view| self.row(view)),
        ];
        let iso = extents.iter().find(|extent| extent.view == View::Iso);
        let size = iso.map_or([0.0; 2], |iso| [0, 1].map(|k| iso.low[k] + iso.high[k]));
        let spots = if iso.is_some() { self.spots(&rows) } else { vec![[Spot::Middle; 2]] };
        let mut best: Option<([f64; 2], [Spot; 2])> = None;
        for spot in spots {
            let scales = self.scales(&rows, spot, size, room)?;
            if best.is_none_or(|(found, _)| scales[1] > found[1] * (1.0 + EQUAL)) {
                best = Some((scales, spot));
            }
        }
        let Some((scales, spot)) = best else { return Err(SheetError::Views) };

        // Centre the whole on the sheet.
        let lengths = [0, 1].map(|k| rows[k].length(spot[k], scales, size[k]));
        let whole = sheet.unwrap_or(lengths.map(|length| length + 2.0 * margin));
        let corner = [0, 1].map(|k| (whole[k] - lengths[k]) / 2.0);

        // Cover the view of the longest reach with the window that all cameras share.
        let reach = extents
            .iter()
            .flat_map(|e| [e.low[0], e.low[1], e.high[0], e.high[1]])
            .fold(0.0, f64::max);
        let window = if reach > 0.0 { 2.0 * reach * ROOM } else { 1.0 };

        // Place each view in the middle of its cell.
        let views = extents.iter().map(|extent| {
            let is_iso = extent.view == View::Iso;
            let scale = if is_iso { scales[1] } else { scales[0] };
            let middle = [0, 1].map(|k| match (is_iso, k) {
                (true, _) => {
                    let [from, to] = rows[k].rest(spot[k], scales, size[k]);
                    corner[k] + (from + to + (extent.low[k] - extent.high[k]) * scale) / 2.0
                }
                (false, 0) => {
                    corner[k] + rows[k].middle(self.column(extent.view), spot[k], scales, size[k])
                }
                (false, _) => {
                    corner[k] + rows[k].middle(self.row(extent.view), spot[k], scales, size[k])
                }
            });
            let corners = [
                [0, 1].map(|k| middle[k] - extent.low[k] * scale),
                [0, 1].map(|k| middle[k] + extent.high[k] * scale),
            ];
            let camera =
                Camera { projection: Projection::Parallel { height: window }, ..extent.camera };
            let window = window * scale;
            let shift = middle.map(|at| ((at - window / 2.0) * 1000.0).round() / 1000.0);
            PlacedView { view: extent.view, scale, corners, camera, window, shift }
        });
        Ok(SheetLayout { size: whole, views: views.collect() })
    }

    /// The scale of the orthographic views and that of the axonometric one.
    fn scales(
        &self,
        rows: &[Row; 2],
        spot: [Spot; 2],
        size: [f64; 2],
        room: [f64; 2],
    ) -> Result<[f64; 2], SheetError> {
        let largest = |k: usize| rows[k].largest(spot[k], size[k], room[k]);
        let common = largest(0).min(largest(1));
        let too_large = |needed: [f64; 2]| {
            let fitting = Some(common).filter(|&scale| scale > 0.0 && scale.is_finite());
            Err(SheetError::TooLarge { size: needed, room, fitting })
        };
        let lengths = |scales: [f64; 2]| [0, 1].map(|k| rows[k].length(spot[k], scales, size[k]));
        let Some(scale) = self.scale else {
            if common <= 0.0 {
                return too_large(lengths([0.0; 2]));
            }
            // A model without extent has any scale.
            return Ok(if common.is_finite() { [common; 2] } else { [0.0; 2] });
        };

        // At a given scale, the axonometric view takes the room that is left.
        if rows.iter().all(Row::is_empty)
            || (0..2).any(|k| rows[k].full(scale) > room[k] + ROUNDING)
        {
            let needed = lengths([scale; 2]);
            let fits = (0..2).all(|k| needed[k] <= room[k] + ROUNDING);
            return if fits { Ok([scale; 2]) } else { too_large(needed) };
        }
        let left = |k: usize| rows[k].largest_rest(spot[k], scale, size[k], room[k]);
        match scale.min(left(0)).min(left(1)) {
            rest if rest >= scale * (1.0 - EQUAL) => Ok([scale; 2]),
            rest if rest > 0.0 => Ok([scale, rest]),
            _ => too_large(lengths([scale; 2])),
        }
    }

    /// The column of a view, 0 for that of the front.
    fn column(&self, view: View) -> i32 {
        let has = |view| self.views.contains(&view);
        // As seen in third angle, in which the model's right is on the right.
        let third = match view {
            View::Left => -1,
            View::Right => 1,
            View::Back => {
                let (near, far) =
                    if self.angle == Angle::Third { (View::Right, 2) } else { (View::Left, -2) };
                let other = if self.angle == Angle::Third { View::Left } else { View::Right };
                if has(other) && !has(near) { -far } else { far }
            }
            _ => 0,
        };
        if self.angle == Angle::Third { third } else { -third }
    }

    /// The row of a view, 0 for that of the front; rows count upwards.
    fn row(&self, view: View) -> i32 {
        let third = match view {
            View::Top => 1,
            View::Bottom => -1,
            _ => 0,
        };
        if self.angle == Angle::Third { third } else { -third }
    }

    /// Where the axonometric view may come, the best of equal places first.
    fn spots(&self, rows: &[Row; 2]) -> Vec<[Spot; 2]> {
        // The corner towards the right, and away from the front.
        let first = if self.angle == Angle::Third { 1 } else { -1 };
        let corners = [[1, first], [-1, first], [1, -first], [-1, -first]];
        let is_corner =
            |corner: &[i32; 2]| zip(rows, corner).all(|(row, &side)| row.has_side(side));
        let free: Vec<_> = corners
            .iter()
            .filter(|corner| is_corner(corner))
            .map(|c| c.map(Spot::Corner))
            .collect();
        match (free.is_empty(), rows.iter().all(Row::is_empty)) {
            (false, _) => free,
            (true, true) => vec![[Spot::Middle; 2]],
            (true, false) => {
                vec![[Spot::Beyond(1), Spot::Middle], [Spot::Middle, Spot::Beyond(-1)]]
            }
        }
    }
}

impl Extent {
    fn new(world: &World, view: View, up: Axis, workers: &Workers) -> Self {
        let camera = frame(&world.bounds, view, up, Lens::Parallel, 1.0);
        let world_from_view = camera.view_from_world().inverse();
        let axes = [world_from_view.x_axis, world_from_view.y_axis].map(|axis| axis.truncate());
        let along =
            |sign: f64| axes.map(|axis| reach(world, camera.focal_point, axis * sign, workers));
        Self { view, low: along(-1.0), high: along(1.0), camera }
    }
}

impl SheetLayout {
    /// The sheet of these drawings, one for each view, each of the whole window of its camera
    /// ([`PageSize::Window`]).
    pub fn compose(&self, drawings: Vec<Drawn>) -> Drawn {
        let mut whole = Drawn::default();
        let mut sheet = Drawing { width: self.size[0], height: self.size[1], ..Drawing::default() };
        for (view, drawn) in zip(&self.views, drawings) {
            let Drawn { mut drawing, stats } = drawn;
            drawing.shift(view.shift);
            sheet.lines.append(&mut drawing.lines);
            sheet.regions.append(&mut drawing.regions);
            sheet.points.append(&mut drawing.points);
            whole.stats = whole.stats.plus(&stats);
        }
        sheet.lines.sort_by_key(|line| (line.layers > 0, line.class, line.layers));
        sheet.points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        whole.drawing = sheet;
        whole
    }
}

impl DrawingStats {
    fn plus(self, other: &Self) -> Self {
        Self {
            triangles: self.triangles + other.triangles,
            hiding_triangles: self.hiding_triangles + other.hiding_triangles,
            edges: self.edges + other.edges,
            intersections: self.intersections + other.intersections,
            fragments: self.fragments + other.fragments,
            visibility: self.visibility.plus(&other.visibility),
        }
    }
}

#[cfg(test)]
mod tests;
