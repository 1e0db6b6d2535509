//! The options of `vitral draw` as typed.

use crate::choices::{self, DrawingAlgorithm};
use crate::help::{self, EXIT_CODES, model_help, model_long_help};
use crate::render_args::{CameraArgs, EyeArgs, LightArgs, ProcessArgs, ProgressWhen};
use crate::section_args::SectionArgs;
use crate::similar::not_one_of;
use crate::values;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use vitral::{
    ColorBy, FillSettings, Illumination, LineClass, LineClasses, Pens, PolygonOrder, Seams,
    TitleBlock, View, Visibility,
};

/// Options of `vitral draw`.
#[derive(Args, Clone, Debug, Default)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct DrawArgs {
    #[arg(required_unless_present = "load_state", value_name = "MODEL", help = model_help(), long_help = model_long_help())]
    pub(crate) models: Vec<PathBuf>,
    /// Where the drawing goes: .svg, .pdf, .dxf, .hpgl or .plt; or `-` for an SVG on standard
    /// output
    ///
    /// {model} expands. Several models make one scene, or with {model} a drawing each
    #[arg(help_heading = help::OUTPUT)]
    #[arg(long, short, value_name = "OUT", required = true)]
    pub(crate) output: PathBuf,
    /// Put several models into one scene, although --output has {model} [default: a drawing of each
    /// model]
    #[arg(help_heading = help::OUTPUT)]
    #[arg(long)]
    pub(crate) together: bool,
    #[command(flatten)]
    pub(crate) lines: LineArgs,
    #[command(flatten)]
    pub(crate) fill: FillArgs,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    #[command(flatten)]
    pub(crate) section: SectionArgs,
    #[command(flatten)]
    pub(crate) page: PageArgs,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
    #[command(flatten)]
    pub(crate) eye: EyeArgs,
    /// A perspective drawing; --camera-view-angle makes one, too [default: parallel projection]
    #[arg(long, conflicts_with = "camera_orthographic", help_heading = help::CAMERA)]
    pub(crate) perspective: bool,
    #[command(flatten)]
    pub(crate) process: ProcessArgs,
    #[command(flatten)]
    pub(crate) report: DrawReportArgs,
}

/// Lines, fills and their looks.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::LINES)]
pub(crate) struct LineArgs {
    /// Algorithm that finds the visible parts [default: exact]
    ///
    /// The classical algorithms draw their own polygons in their own order, with all their cuts, as
    /// lines of the class smooth; in a list from back to front, later polygons cover earlier ones
    #[arg(long, value_name = "NAME", value_parser = choices::drawing_algorithm())]
    pub(crate) algorithm: Option<DrawingAlgorithm>,
    /// Style of the drawing: lines, filled regions or both [default: hidden-line; filled-lines with
    /// another --algorithm than exact]
    #[arg(long, value_name = "STYLE", value_enum)]
    pub(crate) style: Option<Style>,
    #[arg(long, value_name = "LIST", value_parser = line_classes, help = LINES_HELP, long_help = lines_help())]
    pub(crate) lines: Option<LineClasses>,
    /// How hidden lines are drawn [default: none]
    #[arg(long, value_name = "HOW", value_enum)]
    pub(crate) hidden: Option<Hidden>,
    /// Draw hidden lines behind at most N faces; 0 means any number; with --hidden [default: 0]
    #[arg(long, value_name = "N", value_parser = values::whole(0..=u32::MAX), allow_negative_numbers = true)]
    pub(crate) hidden_max_layers: Option<u32>,
    /// Edges between faces that meet at a larger angle are creases, 0 (all) to 180 (none) [default:
    /// 30]
    #[arg(long, value_name = "DEGREES", value_parser = values::half_turn, allow_negative_numbers = true)]
    pub(crate) crease_angle: Option<f64>,
    /// Leave out tangent edges, between two faces whose normals differ by less than a degree,
    /// unless they are contours
    #[arg(long)]
    pub(crate) hide_tangent: bool,
    /// The most segments of lines and outlines, before --simplify and dashes; beyond it the work
    /// ends with exit code 7
    #[arg(long, value_name = "N", value_parser = values::whole(1..=u64::MAX), allow_negative_numbers = true)]
    pub(crate) max_segments: Option<u64>,
    #[arg(long, value_name = "CLASS=MM", value_parser = stroke, help = stroke_help())]
    pub(crate) stroke: Vec<(String, f64)>,
}

/// How surfaces are filled.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::SURFACES)]
pub(crate) struct FillArgs {
    /// What the colours of regions show [default: shading]
    #[arg(long, value_name = "WHAT", value_parser = choices::color_by())]
    pub(crate) color_by: Option<ColorBy>,
    /// Steps of brightness of shaded faces, 1 to 256: faces of one material and one step become one
    /// region [default: 32]
    #[arg(long, value_name = "N", value_parser = values::whole(1..=256u32), allow_negative_numbers = true)]
    pub(crate) shades: Option<u32>,
    /// Formula for the light that a surface reflects, as in `render` [default: auto]
    #[arg(long, value_name = "MODEL", value_parser = choices::illumination())]
    pub(crate) illumination: Option<Illumination>,
    /// Cut faces where shadows fall, and shade both parts
    ///
    /// All lights that cast shadows count, area lights as points. SVG files name the lights that do
    /// not reach a region as data-shadow
    #[arg(long)]
    pub(crate) shadows: bool,
    /// Draw transparent materials as translucent layers over the surfaces behind them [default: all
    /// surfaces are opaque]
    #[arg(long)]
    pub(crate) transparency: bool,
    /// Blend transparent layers and the surfaces behind them into opaque regions, for programs
    /// without opacity
    #[arg(long, requires = "transparency")]
    pub(crate) flatten: bool,
    /// Whether neighbouring regions overlap [default: under]
    #[arg(long, value_name = "HOW", value_parser = choices::seams())]
    pub(crate) seams: Option<Seams>,
}

impl DrawArgs {
    /// What the drawing is made of.
    pub(crate) fn style(&self) -> Style {
        self.lines.style.unwrap_or(match self.polygons() {
            Some(_) => Style::FilledLines,
            None => Style::default(),
        })
    }

    /// How its surfaces are filled, if they are.
    pub(crate) fn surfaces(&self) -> Option<FillSettings> {
        let (fill, usual) = (&self.fill, FillSettings::default());
        (self.style() != Style::HiddenLine).then(|| FillSettings {
            color_by: fill.color_by.unwrap_or(usual.color_by),
            shades: fill.shades.unwrap_or(usual.shades),
            shadows: fill.shadows,
            transparency: fill.transparency,
            flatten: fill.flatten,
            seams: fill.seams.unwrap_or(usual.seams),
            by_face: self.page.svg_ids,
        })
    }

    /// The algorithm whose polygons are drawn.
    pub(crate) fn polygons(&self) -> Option<Visibility> {
        match self.lines.algorithm {
            Some(DrawingAlgorithm::Polygons(algorithm)) => Some(algorithm),
            Some(DrawingAlgorithm::Exact) | None => None,
        }
    }

    /// Whether the drawing is a list of polygons of which later ones cover earlier ones.
    pub(crate) fn overlaps(&self) -> bool {
        self.polygons()
            .is_some_and(|algorithm| algorithm.polygons == Some(PolygonOrder::BackToFront))
    }
}

/// What a drawing is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Style {
    /// Lines alone
    #[default]
    HiddenLine,
    /// Filled regions
    Filled,
    /// Filled regions and lines
    FilledLines,
}

/// What becomes of hidden lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Hidden {
    /// They are left out
    #[default]
    None,
    /// Thin dashes
    Dashed,
    /// Thin lines
    Solid,
}

/// The sheet.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::PAGE)]
pub(crate) struct PageArgs {
    /// The sheet: fit, A0 to A6, or WxHmm [default: fit]
    ///
    /// fit is a drawing 180 mm long, on no more paper than it needs
    #[arg(long, value_name = "SIZE", value_parser = page_size)]
    pub(crate) page: Option<Sheet>,
    /// Turn the sheet, with its longer side across
    #[arg(long, requires = "page")]
    pub(crate) landscape: bool,
    /// Distance between the drawing and the border of the sheet in millimetres [default: 5]
    #[arg(long, value_name = "MM", value_parser = margin, allow_negative_numbers = true)]
    pub(crate) margin: Option<f64>,
    /// Scale, such as 1:2 or .5: millimetres on paper to millimetres of the model; not in
    /// perspective [default: as large as the sheet allows]
    #[arg(long, value_name = "RATIO", value_parser = scale, conflicts_with = "perspective")]
    pub(crate) scale: Option<f64>,
    /// Unit of the model's coordinates [default: mm]
    #[arg(long, value_name = "UNIT", value_enum, requires = "scale")]
    pub(crate) unit: Option<ModelUnit>,
    /// Step of coordinates in millimetres: 1, .1, .01 or .001 [default: .001]
    #[arg(long, value_name = "MM", value_parser = decimals)]
    pub(crate) precision: Option<u8>,
    /// Leave out corners of lines that are at most MM from the simplified line [default: 0]
    #[arg(long, value_name = "MM", value_parser = values::not_negative, allow_negative_numbers = true)]
    pub(crate) simplify: Option<f64>,
    /// Several views on one sheet: a list of front, back, left, right, top, bottom and iso
    ///
    /// They have one scale, are 15 mm apart and are placed by --angle, with the symbol of the
    /// projection below. iso goes into a free corner; with --scale it may get a smaller one
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = crate::choices::view())]
    pub(crate) views: Vec<View>,
    /// Method of projection of --views [default: first]
    #[arg(long, value_name = "METHOD", value_enum)]
    pub(crate) angle: Option<Angle>,
    /// A row of a table below the drawing, in strokes on a layer of their own; repeatable
    #[arg(long, value_name = "KEY=VALUE", value_parser = title_row)]
    pub(crate) title_block: Vec<(String, String)>,
    /// Write for a plotter: lines alone
    ///
    /// Lines are joined and each is drawn once, with short ways of the raised pen; dashes are lines
    /// of their own. HP-GL is always like this
    #[arg(long)]
    pub(crate) plotter: bool,
    /// Write the id of the surface of each filled region into SVG files, as data-face
    #[arg(long)]
    pub(crate) svg_ids: bool,
}

/// Methods of orthographic projection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Angle {
    /// The view from the right stands left of the front, that from above below it (ISO, Europe)
    #[default]
    First,
    /// The view from the right stands right of the front, that from above above it (America)
    Third,
}

/// Units of models.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ModelUnit {
    /// Millimetres
    #[default]
    Mm,
    /// Centimetres
    Cm,
    /// Inches
    In,
    /// Metres
    M,
}

impl ModelUnit {
    /// Its length.
    pub(crate) fn millimetres(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Cm => 10.0,
            Self::In => 25.4,
            Self::M => 1000.0,
        }
    }
}

/// A sheet of paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sheet {
    /// As large as the drawing.
    Fit,
    /// Width and height in millimetres.
    Size([f64; 2]),
}

/// Statistics, warnings, progress.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::REPORTS)]
pub(crate) struct DrawReportArgs {
    /// Print counters and times as JSON on standard error
    #[arg(long)]
    pub(crate) stats: bool,
    /// Print no warnings
    #[arg(long, short)]
    pub(crate) quiet: bool,
    /// When to show a progress bar [default: auto]
    #[arg(long, value_name = "WHEN", value_enum)]
    pub(crate) progress: Option<ProgressWhen>,
}

/// The short help of `--lines`.
const LINES_HELP: &str = "Which lines are drawn: a list of classes, or all [default: contour,boundary,crease,material,intersection; section with --section-plane]";

/// The help of `--lines`.
fn lines_help() -> String {
    let classes: Vec<String> =
        LineClass::ALL.iter().map(|(_, name, what)| format!("{name} ({what})")).collect();
    format!(
        "Which lines are drawn: a list of {}; or all. An edge of several classes is drawn as section, or else as the first of the \
         list that it is [default: contour,boundary,crease,material,intersection; section with --section-plane]",
        classes.join(", ")
    )
}

/// `contour,crease`, or `all`.
pub(crate) fn line_classes(text: &str) -> Result<LineClasses, String> {
    if text.eq_ignore_ascii_case("all") {
        return Ok(LineClasses::ALL);
    }

    // Look each name of the list up.
    let class = |word: &str| {
        let found = LineClass::ALL
            .iter()
            .map(|row| row.0)
            .find(|class| class.name().eq_ignore_ascii_case(word));
        let names: Vec<_> = LineClass::ALL.iter().map(|row| row.1).collect();
        found.ok_or_else(|| not_one_of(word, &names, "; or all alone"))
    };
    text.split(',').map(class).collect()
}

/// `fit`, `A4`, or `210x297mm`.
fn page_size(text: &str) -> Result<Sheet, String> {
    if text.eq_ignore_ascii_case("fit") {
        return Ok(Sheet::Fit);
    }

    // Look for a size of the series A.
    let series = [("A0", [841, 1189]), ("A1", [594, 841]), ("A2", [420, 594]), ("A3", [297, 420])];
    let small = [("A4", [210, 297]), ("A5", [148, 210]), ("A6", [105, 148])];
    if let Some((_, size)) =
        series.iter().chain(&small).find(|(name, _)| name.eq_ignore_ascii_case(text))
    {
        return Ok(Sheet::Size(size.map(f64::from)));
    }

    // Parse width and height, of at most 10 m each.
    let sides = text.strip_suffix("mm").and_then(|sides| sides.split_once('x'));
    let side = |side: &str| values::positive(side).ok().filter(|&side| side <= 10_000.0);
    match sides.and_then(|(width, height)| Some([side(width)?, side(height)?])) {
        Some(size) => Ok(Sheet::Size(size)),
        None => Err(format!(
            "`{text}` is not a sheet: fit, A0 to A6, or a size of up to 10 m such as 200x100mm is required"
        )),
    }
}

/// The help of `--stroke`.
fn stroke_help() -> String {
    let mut usual = Pens::default();
    let mut width = |name: &str| usual.width_mut(name).map_or(0.0, |width| *width);
    let names: Vec<String> = Pens::names().map(|name| format!("{name}={}", width(name))).collect();
    format!("Width of lines in millimetres; repeatable [default: {}]", names.join(", "))
}

/// `contour=0.5`.
fn stroke(text: &str) -> Result<(String, f64), String> {
    let (name, width) =
        text.split_once('=').ok_or("CLASS=WIDTH is required, such as contour=0.5")?;
    if !Pens::names().any(|known| known == name) {
        return Err(format!(
            "`{name}` is not one of {}",
            Pens::names().collect::<Vec<_>>().join(", ")
        ));
    }

    // Parse the width, of at most 100 mm.
    let width = values::positive(width)?;
    if width > 100.0 {
        Err("at most 100 mm is required".to_owned())
    } else {
        Ok((name.to_owned(), width))
    }
}

/// `1:2`, `2:1` or `0.5`.
fn scale(text: &str) -> Result<f64, String> {
    let wrong = || format!("`{text}` is not a scale: 1:2, 2:1 or a number above 0 is required");

    // Divide the two sides of a colon, or take a plain number.
    let ratio = match text.split_once(':') {
        Some((paper, model)) => {
            values::positive(paper).and_then(|paper| Ok(paper / values::positive(model)?))
        }
        None => values::positive(text),
    };
    ratio.ok().filter(|ratio| ratio.is_finite() && *ratio > 0.0).ok_or_else(wrong)
}

/// The decimals of a precision.
fn decimals(text: &str) -> Result<u8, String> {
    let step = values::number(text)?;
    let known = [1.0, 0.1, 0.01, 0.001].iter().position(|&known| known == step);
    known.map(|decimals| decimals as u8).ok_or_else(|| "1, .1, .01 or .001 is required".to_owned())
}

/// `Scale=1:2`, in letters that there are strokes for.
fn title_row(text: &str) -> Result<(String, String), String> {
    let (key, value) = text.split_once('=').ok_or("KEY=VALUE is required, such as Scale=1:2")?;

    // Refuse letters that the stroke font does not have.
    let row = (key.to_owned(), value.to_owned());
    match TitleBlock::new(std::slice::from_ref(&row)) {
        Ok(_) => Ok(row),
        Err(letter) => Err(format!(
            "there is no stroke letter for `{letter}`; letters are A to Z, a to z, 0 to 9 and punctuation"
        )),
    }
}

/// A distance of at least 0 mm.
fn margin(text: &str) -> Result<f64, String> {
    let margin = values::number(text)?;
    if (0.0..=1000.0).contains(&margin) {
        Ok(margin)
    } else {
        Err("0 to 1000 is required".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_sheets_are_read() {
        assert_eq!(line_classes("crease"), Ok(LineClasses::one(LineClass::Crease)));
        assert_eq!(
            line_classes("contour,boundary,crease,material,intersection,section"),
            Ok(LineClasses::USUAL)
        );
        assert_eq!(line_classes("all"), Ok(LineClasses::ALL));
        assert!(line_classes("all,crease").is_err() && line_classes("").is_err());
        assert!(line_classes("hatch").unwrap_err().contains("is not one of"));
        assert_eq!(
            (page_size("fit"), page_size("a4")),
            (Ok(Sheet::Fit), Ok(Sheet::Size([210.0, 297.0])))
        );
        assert_eq!(page_size("20x10.5mm"), Ok(Sheet::Size([20.0, 10.5])));
        assert!(
            ["A9", "20x10", "0x3mm", "-1x1mm", "1e9x1mm"]
                .iter()
                .all(|text| page_size(text).is_err())
        );
        assert_eq!((scale("1:2"), scale("2.5"), scale("25.4:1")), (Ok(0.5), Ok(2.5), Ok(25.4)));
        assert!(["1:0", "0", "-1:2", "1:2:3", "a"].iter().all(|text| scale(text).is_err()));
        assert_eq!((decimals(".001"), decimals("1")), (Ok(3), Ok(0)));
        assert!(
            decimals("0.002").is_err()
                && stroke("contour").is_err()
                && stroke("contour=0").is_err()
        );
        assert_eq!(stroke("hidden=.2"), Ok(("hidden".to_owned(), 0.2)));
        assert!(stroke("outline=1").unwrap_err().contains("contour, boundary"));
        assert_eq!(title_row("Scale=1:2"), Ok(("Scale".to_owned(), "1:2".to_owned())));
        assert!(title_row("Scale").is_err() && title_row("Maß=1").unwrap_err().contains("`ß`"));
        assert_eq!(margin("0"), Ok(0.0));
        assert!(margin("-1").is_err());
    }
}
