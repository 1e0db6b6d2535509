//! What a drawing looks like on paper, for all writers: layers with their pens, and corners in
//! steps of the precision.
//!
//! A layer is a class of visible lines, or all hidden lines, the strokes of the title block, the
//! hatching of cuts, or the free points of the model. Names and numbers of layers are the same in
//! all formats.

use std::fmt::Write;
use vitral_frame::Drawing;
use vitral_frame::drawing::LineClass;

/// Name of the layer of hidden lines.
pub const HIDDEN: &str = "hidden";
/// Name of the layer of the title block.
pub const TITLE: &str = "title";
/// Name of the layer of hatching.
pub const HATCH: &str = "hatch";
/// Name of the layer of free points.
pub const POINT: &str = "point";
/// Name of the layer of filled regions.
pub(super) const FILL: &str = "fill";

/// A polyline on the page in millimetres.
pub type Polyline = Vec<[f64; 2]>;

/// Widths and dashes of lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pens {
    /// Widths of visible lines in millimetres, in the order of [`LineClass::ALL`].
    pub widths: [f64; 7],
    /// Width of hidden lines in millimetres.
    pub hidden_width: f64,
    /// Width of the strokes of the title block in millimetres.
    pub title_width: f64,
    /// Width of hatching in millimetres.
    pub hatch_width: f64,
    /// Diameter of free points in millimetres; `None`: the width of contours.
    pub point_width: Option<f64>,
    /// Lengths of dashes and gaps of hidden lines in millimetres; `None`: solid.
    pub hidden_dashes: Option<[f64; 2]>,
}

impl Default for Pens {
    /// The widths of ISO 128: wide lines for outlines, narrow ones inside, thin dashes where lines
    /// are hidden.
    fn default() -> Self {
        let widths = LineClass::ALL.map(|(class, ..)| match class {
            LineClass::Contour | LineClass::Boundary => 0.5,
            LineClass::Section => 0.7,
            LineClass::Smooth => 0.18,
            _ => 0.35,
        });
        Self {
            widths,
            hidden_width: 0.18,
            title_width: 0.25,
            hatch_width: 0.18,
            point_width: None,
            hidden_dashes: Some([2.0, 1.0]),
        }
    }
}

impl Pens {
    /// The names of all pens: the classes of lines, [`HIDDEN`], [`TITLE`], [`HATCH`] and [`POINT`].
    pub fn names() -> impl Iterator<Item = &'static str> {
        LineClass::ALL.into_iter().map(|(_, name, _)| name).chain([HIDDEN, TITLE, HATCH, POINT])
    }

    /// The width of the pen of this name.
    pub fn width_mut(&mut self, name: &str) -> Option<&mut f64> {
        match name {
            HIDDEN => Some(&mut self.hidden_width),
            TITLE => Some(&mut self.title_width),
            HATCH => Some(&mut self.hatch_width),
            POINT => Some(self.point_width.get_or_insert(self.widths[LineClass::Contour as usize])),
            _ => LineClass::ALL.iter().position(|row| row.1 == name).map(|i| &mut self.widths[i]),
        }
    }
}

/// How a drawing is written.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingOptions {
    /// What lines look like.
    pub pens: Pens,
    /// Decimals of millimetres that coordinates have, at most 3.
    pub decimals: u8,
    /// Whether regions of SVG files tell the surface that they show.
    pub surface_ids: bool,
    /// Whether regions of SVG and PDF files are outlined, each above the regions painted before,
    /// and by the pen of which class.
    pub region_outlines: Option<LineClass>,
    /// Strokes of the title block.
    pub title: Vec<Polyline>,
}

impl Default for DrawingOptions {
    fn default() -> Self {
        Self {
            pens: Pens::default(),
            decimals: 3,
            surface_ids: false,
            region_outlines: None,
            title: Vec::new(),
        }
    }
}

impl DrawingOptions {
    /// The width of the outlines of regions in millimetres, if there are any.
    pub(super) fn outline_width(&self) -> Option<f64> {
        self.region_outlines.map(|class| self.pens.widths[class as usize])
    }

    /// Coordinates in whole steps of the precision.
    pub(super) fn precision(&self) -> Precision {
        let decimals = usize::from(self.decimals.min(3));
        Precision { decimals, steps_a_millimetre: [1.0, 10.0, 100.0, 1000.0][decimals] }
    }
}

/// The last decimal that is written.
#[derive(Clone, Copy, Debug)]
pub(super) struct Precision {
    pub(super) decimals: usize,
    pub(super) steps_a_millimetre: f64,
}

/// A share of 0 to 1 in thousandths.
pub(super) fn thousandths(share: f32) -> u32 {
    (share.clamp(0.0, 1.0) * 1000.0).round() as u32
}

impl Precision {
    /// A length in steps.
    pub(super) fn steps(self, millimetres: f64) -> i32 {
        (millimetres * self.steps_a_millimetre).round() as i32
    }

    /// Corners in steps, without repeated ones.
    pub(super) fn corners(self, points: &[[f64; 2]]) -> Vec<[i32; 2]> {
        let mut corners: Vec<_> =
            points.iter().map(|point| point.map(|at| self.steps(at))).collect();
        corners.dedup();
        corners
    }

    /// The corners of an outline, whose last is not its first.
    pub(super) fn ring(self, points: &[[f64; 2]]) -> Vec<[i32; 2]> {
        let mut corners = self.corners(points);
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        corners
    }

    /// The corners of a line and whether it is closed; the last corner of a closed one is not its
    /// first. `None`: a line shorter than a step.
    pub(super) fn line(self, points: &[[f64; 2]]) -> Option<(Vec<[i32; 2]>, bool)> {
        let mut corners = self.corners(points);
        let closed = corners.len() > 3 && corners.first() == corners.last();
        if closed {
            corners.pop();
        }
        (corners.len() > 1).then_some((corners, closed))
    }

    /// Writes steps as millimetres, without needless zeros.
    pub(super) fn write(self, out: &mut String, steps: i32) {
        let unit = self.steps_a_millimetre as u32;
        let (whole, part) = (steps.unsigned_abs() / unit, steps.unsigned_abs() % unit);
        let sign = if steps < 0 { "-" } else { "" };
        let _ = write!(out, "{sign}{whole}");
        if part > 0 {
            let digits = format!("{part:0width$}", width = self.decimals);
            let _ = write!(out, ".{}", digits.trim_end_matches('0'));
        }
    }
}

/// Lines that are drawn with one pen.
pub(super) struct Layer<'d> {
    pub(super) number: usize,
    pub(super) name: &'static str,
    /// Millimetres.
    pub(super) width: f64,
    /// Lengths of dashes and gaps, millimetres.
    pub(super) dashes: Option<[f64; 2]>,
    pub(super) lines: Vec<&'d [[f64; 2]]>,
    /// Points that are drawn as dots of the pen's width.
    pub(super) points: &'d [[f64; 2]],
}

/// The layers of a drawing that are not empty, as they are painted: hatching, hidden lines, then
/// visible ones, the most important last, then the title block and the free points.
pub(super) fn layers<'d>(drawing: &'d Drawing, options: &'d DrawingOptions) -> Vec<Layer<'d>> {
    let pens = &options.pens;
    let count = LineClass::ALL.len();
    let visible = |class: LineClass| {
        let of_class =
            drawing.lines.iter().filter(move |line| line.layers == 0 && line.class == class);
        of_class.map(|line| &line.points[..]).collect()
    };

    // Begin with the hatching, which is painted under everything else.
    let lines = visible(LineClass::Hatch);
    let mut layers = vec![Layer {
        number: count + 3,
        name: HATCH,
        width: pens.hatch_width,
        dashes: None,
        lines,
        points: &[],
    }];

    // Add the hidden lines, of all classes.
    layers.push(Layer {
        number: count + 1,
        name: HIDDEN,
        width: pens.hidden_width,
        dashes: pens.hidden_dashes,
        lines: drawing
            .lines
            .iter()
            .filter(|line| line.layers > 0)
            .map(|line| &line.points[..])
            .collect(),
        points: &[],
    });

    // Add the visible lines, the most important class last.
    for (i, (class, name, _)) in LineClass::ALL.into_iter().enumerate().rev() {
        let lines = visible(class);
        layers.push(Layer {
            number: i + 1,
            name,
            width: pens.widths[i],
            dashes: None,
            lines,
            points: &[],
        });
    }

    // Add the title block.
    let lines = options.title.iter().map(|stroke| &stroke[..]).collect();
    layers.push(Layer {
        number: count + 2,
        name: TITLE,
        width: pens.title_width,
        dashes: None,
        lines,
        points: &[],
    });

    // Add the free points, as wide as contours unless the pens say otherwise.
    let width = pens.point_width.unwrap_or(pens.widths[LineClass::Contour as usize]);
    let (number, points) = (count + 4, &drawing.points[..]);
    layers.push(Layer { number, name: POINT, width, dashes: None, lines: Vec::new(), points });

    // Leave empty layers out.
    layers.retain(|layer| !layer.lines.is_empty() || !layer.points.is_empty());
    layers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_written_as_millimetres() {
        let text = |decimals, steps| {
            let mut out = String::new();
            DrawingOptions { decimals, ..DrawingOptions::default() }
                .precision()
                .write(&mut out, steps);
            out
        };
        assert_eq!(
            [text(3, 0), text(3, -5), text(3, 12_340), text(1, 25)],
            ["0", "-0.005", "12.34", "2.5"]
        );
        assert_eq!([text(0, -7), text(3, i32::MIN)], ["-7", "-2147483.648"]);
    }

    #[test]
    fn lines_below_the_precision_vanish_and_closed_ones_are_told() {
        let precision = DrawingOptions { decimals: 1, ..DrawingOptions::default() }.precision();
        assert_eq!(precision.line(&[[0.0, 0.0], [0.04, 0.0]]), None);
        assert_eq!(
            precision.line(&[[0.0, 0.0], [0.04, 0.0], [1.0, 0.0]]),
            Some((vec![[0, 0], [10, 0]], false))
        );
        let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
        assert_eq!(precision.line(&triangle), Some((vec![[0, 0], [10, 0], [0, 10]], true)));
        assert_eq!(
            precision.line(&triangle.map(|p| [p[0], 0.0])),
            Some((vec![[0, 0], [10, 0], [0, 0]], false))
        );
        assert_eq!(precision.ring(&triangle).len(), 3);
    }

    #[test]
    fn pens_have_names() {
        let mut pens = Pens::default();
        for (i, name) in Pens::names().enumerate() {
            *pens.width_mut(name).unwrap() = 1.0 + i as f64;
        }
        assert_eq!(
            (pens.widths[0], pens.widths[6], pens.hidden_width, pens.title_width, pens.hatch_width),
            (1.0, 7.0, 8.0, 9.0, 10.0)
        );
        assert!(pens.width_mut("fill").is_none());
    }
}
