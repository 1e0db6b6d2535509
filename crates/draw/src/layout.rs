//! The sheet: strokes are scaled and placed, rounded to the precision, and joined.
//!
//! In:   strokes, regions and points in units of the page's grid. Out: a [`Drawing`] in
//!       millimetres.
//! Cost: that of [`chains`](crate::chains).

use crate::chains::{Step, chains};
use crate::fill::PageRegion;
use crate::hatch::{Cuts, hatch};
use crate::page_mesh::{NONE, PAGE_UNITS};
use crate::strokes::Stroke;
use vitral_frame::Drawing;
use vitral_frame::drawing::{Line, Region, bounds};

/// Steps of the precision in a millimetre.
pub(crate) const STEPS_A_MILLIMETRE: f64 = 1000.0;

/// How large the sheet is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PageSize {
    /// As large as the drawing, whose longer side has this length in millimetres.
    Fit {
        /// The length.
        longer: f64,
    },
    /// A sheet of this width and height in millimetres, which the drawing fills.
    Sheet {
        /// Width in millimetres.
        width: f64,
        /// Height in millimetres.
        height: f64,
    },
    /// A drawing to scale.
    Scaled {
        /// Millimetres on paper along the longer side of the camera's window.
        window: f64,
        /// Width and height of the sheet; `None`: as large as the drawing.
        sheet: Option<[f64; 2]>,
    },
    /// The whole window of the camera, to scale and without margins: the middle of the window
    /// is the middle of the page.
    Window {
        /// Millimetres on paper along its longer side.
        window: f64,
    },
}

impl Default for PageSize {
    /// A drawing of 180 mm, which fits on A4.
    fn default() -> Self {
        Self::Fit { longer: 180.0 }
    }
}

/// From units of the grid to millimetres on the sheet.
#[derive(Clone, Copy, Debug)]
struct Placement {
    /// Millimetres for each unit.
    scale: f64,
    /// Millimetres that the origin is moved by.
    offset: [f64; 2],
    /// Width and height of the sheet.
    sheet: [f64; 2],
}

impl Placement {
    /// Places a window of so many units.
    fn of_window(size: [i32; 2], window: f64) -> Self {
        let scale = window / f64::from(PAGE_UNITS);
        Self { scale, offset: [0.0; 2], sheet: size.map(|side| f64::from(side) * scale) }
    }

    /// Places a box of these corners.
    fn new(low: [f64; 2], high: [f64; 2], page: PageSize, margin: f64) -> Self {
        let size = [0, 1].map(|k| high[k] - low[k]);
        // Choose the scale. A drawing without width or height is placed by its other side; one
        // without both is a point.
        let ratio =
            |room: f64, side: f64| if side > 0.0 { (room / side).max(0.0) } else { f64::INFINITY };
        let scale = match page {
            PageSize::Fit { longer } => ratio(longer, size[0].max(size[1])),
            PageSize::Sheet { width, height } => {
                ratio(width - 2.0 * margin, size[0]).min(ratio(height - 2.0 * margin, size[1]))
            }
            PageSize::Scaled { window, .. } | PageSize::Window { window } => {
                window / f64::from(PAGE_UNITS)
            }
        };
        let scale = if scale.is_finite() { scale } else { 0.0 };

        // Choose the sheet and centre the drawing on it.
        let sheet = match page {
            PageSize::Fit { .. }
            | PageSize::Scaled { sheet: None, .. }
            | PageSize::Window { .. } => size.map(|side| side * scale + 2.0 * margin),
            PageSize::Sheet { width, height }
            | PageSize::Scaled { sheet: Some([width, height]), .. } => [width, height],
        };
        let offset = [0, 1].map(|k| (sheet[k] - size[k] * scale) / 2.0 - low[k] * scale);
        Self { scale, offset, sheet }
    }

    fn step(&self, point: [f64; 2]) -> Step {
        [0, 1]
            .map(|k| ((point[k] * self.scale + self.offset[k]) * STEPS_A_MILLIMETRE).round() as i32)
    }

    /// A region on the sheet, unless nothing is left of it at the precision.
    fn region(&self, region: &PageRegion) -> Option<Region> {
        let ring = |ring: &Vec<[f64; 2]>| {
            let mut points: Vec<Step> = ring.iter().map(|&point| self.step(point)).collect();
            points.dedup();
            while points.len() > 1 && points.first() == points.last() {
                points.pop();
            }
            (points.len() > 2).then(|| points.into_iter().map(millimetres).collect::<Vec<_>>())
        };
        let rings: Vec<_> = region.rings.iter().filter_map(ring).collect();
        let PageRegion { surface, material, color, opacity, unlit, .. } = *region;
        let material = Some(material).filter(|&material| material != NONE);
        (!rings.is_empty()).then_some(Region { surface, material, color, opacity, unlit, rings })
    }
}

/// A point of the sheet in millimetres.
fn millimetres(point: Step) -> [f64; 2] {
    point.map(|step| f64::from(step) / STEPS_A_MILLIMETRE)
}

/// The content of a drawing, in units of the page's grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Content<'a> {
    /// Width and height of the camera's window.
    pub(crate) size: [i32; 2],
    pub(crate) strokes: &'a [Stroke],
    pub(crate) regions: &'a [PageRegion],
    pub(crate) cuts: &'a Cuts,
    /// Free points.
    pub(crate) points: &'a [[f64; 2]],
}

/// Places strokes, regions and points on the sheet, joins the strokes, and hatches the visible
/// parts of cuts.
pub(crate) fn lay_out(content: &Content<'_>, page: PageSize, margin: f64) -> Drawing {
    let Content { size, strokes, regions, cuts, points } = *content;

    // Find the placement of everything on the sheet.
    let outlines =
        regions.iter().chain(&cuts.regions).flat_map(|region| region.rings.iter().flatten());
    let all = strokes.iter().flat_map(|stroke| &stroke.ends).chain(outlines).chain(points);
    let placement = match (page, bounds(all.copied()).unwrap_or_default()) {
        (PageSize::Window { window }, _) => Placement::of_window(size, window),
        (_, [low, high]) => Placement::new(low, high, page, margin),
    };

    // Join the strokes to chains.
    let placed: Vec<_> =
        strokes.iter().map(|s| (s.class, s.layers, s.ends.map(|p| placement.step(p)))).collect();
    let mut lines: Vec<Line> = chains(&placed)
        .into_iter()
        .map(|chain| {
            let points = chain.points.iter().map(|&p| millimetres(p)).collect();
            Line { class: chain.class, layers: chain.layers, points }
        })
        .collect();

    // Hatch the cuts.
    for region in &cuts.regions {
        let Some(on_sheet) = placement.region(region) else { continue };
        lines.extend(hatch(&on_sheet.rings, cuts.pattern(region)));
    }

    // Place regions and points.
    let regions = regions.iter().filter_map(|region| placement.region(region)).collect();
    let mut points: Vec<Step> = points.iter().map(|&point| placement.step(point)).collect();
    points.sort_unstable();
    points.dedup();
    let [width, height] = placement.sheet;
    Drawing { width, height, lines, regions, points: points.into_iter().map(millimetres).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_frame::drawing::LineClass;

    fn lay_out(strokes: &[Stroke], points: &[[f64; 2]], page: PageSize, margin: f64) -> Drawing {
        let content = Content {
            size: [PAGE_UNITS, PAGE_UNITS / 2],
            strokes,
            regions: &[],
            cuts: &Cuts::default(),
            points,
        };
        super::lay_out(&content, page, margin)
    }

    fn line(p: [f64; 2], q: [f64; 2]) -> Stroke {
        Stroke { class: LineClass::Crease, layers: 0, ends: [p, q] }
    }

    #[test]
    fn a_drawing_fits_the_sheet_or_the_sheet_the_drawing() {
        let strokes = [line([100.0, 100.0], [300.0, 100.0]), line([300.0, 100.0], [300.0, 200.0])];
        let fit = lay_out(&strokes, &[], PageSize::Fit { longer: 100.0 }, 5.0);
        assert_eq!((fit.width, fit.height), (110.0, 60.0));
        assert_eq!(fit.lines[0].points, [[5.0, 5.0], [105.0, 5.0], [105.0, 55.0]]);
        let sheet = lay_out(&strokes, &[], PageSize::Sheet { width: 50.0, height: 90.0 }, 5.0);
        assert_eq!((sheet.width, sheet.height), (50.0, 90.0));
        assert_eq!(sheet.lines[0].points, [[5.0, 35.0], [45.0, 35.0], [45.0, 55.0]]);
    }

    #[test]
    fn a_drawing_to_scale_is_as_large_as_its_window_says() {
        let half = f64::from(PAGE_UNITS) / 2.0;
        let strokes = [line([0.0, 0.0], [half, 0.0])];
        let fit = lay_out(&strokes, &[], PageSize::Scaled { window: 40.0, sheet: None }, 5.0);
        assert_eq!((fit.width, fit.height), (30.0, 10.0));
        let sheet = lay_out(
            &strokes,
            &[],
            PageSize::Scaled { window: 40.0, sheet: Some([30.0, 20.0]) },
            5.0,
        );
        assert_eq!(sheet.lines[0].points, [[5.0, 10.0], [25.0, 10.0]]);
    }

    #[test]
    fn a_window_keeps_its_middle_and_points_are_drawn_once() {
        let [half, quarter] = [2.0, 4.0].map(|part| f64::from(PAGE_UNITS) / part);
        let window = lay_out(
            &[],
            &[[half, quarter], [half, quarter], [0.0, 0.0]],
            PageSize::Window { window: 40.0 },
            5.0,
        );
        assert_eq!((window.width, window.height), (40.0, 20.0));
        assert_eq!(window.points, [[0.0, 0.0], [20.0, 10.0]]);
    }

    #[test]
    fn nothing_and_lines_without_height_have_a_sheet() {
        let empty = lay_out(&[], &[], PageSize::default(), 5.0);
        assert_eq!((empty.width, empty.height, empty.lines.len()), (10.0, 10.0, 0));
        let flat = lay_out(
            &[line([0.0, 7.0], [9.0, 7.0])],
            &[],
            PageSize::Sheet { width: 20.0, height: 10.0 },
            1.0,
        );
        assert_eq!(flat.lines[0].points, [[1.0, 5.0], [19.0, 5.0]]);
    }
}
