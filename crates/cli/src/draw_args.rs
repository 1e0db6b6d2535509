//! The options of `vitral draw` as typed.

use crate::help::{EXIT_CODES, model_help};
use crate::render_args::{CameraArgs, EyeArgs, ProcessArgs, ProgressWhen};
use crate::values;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use vitral::{LineClass, LineClasses, MaterialOverride};

/// Options of `vitral draw`.
#[derive(Args, Debug, Default)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct DrawArgs {
    #[arg(required_unless_present = "load_state", value_name = "MODEL", help = model_help())]
    pub(crate) models: Vec<PathBuf>,
    /// Where the drawing goes: .svg, or `-` for an SVG on standard output; {model} expands
    #[arg(long, short, value_name = "OUT", required = true)]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) lines: LineArgs,
    #[command(flatten)]
    pub(crate) page: PageArgs,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
    #[command(flatten)]
    pub(crate) eye: EyeArgs,
    /// A perspective drawing; with --camera-view-angle, too [default: parallel projection]
    #[arg(long, conflicts_with = "camera_orthographic", help_heading = "Camera (without any, the model is framed)")]
    pub(crate) perspective: bool,
    #[command(flatten)]
    pub(crate) process: ProcessArgs,
    #[command(flatten)]
    pub(crate) report: DrawReportArgs,
}

/// What is drawn.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Lines")]
pub(crate) struct LineArgs {
    /// What the drawing is made of [default: hidden-line]
    #[arg(long, value_name = "STYLE", value_enum)]
    pub(crate) style: Option<Style>,
    #[arg(long, value_name = "LIST", value_parser = line_classes, help = lines_help())]
    pub(crate) lines: Option<LineClasses>,
    /// What becomes of hidden lines [default: none]
    #[arg(long, value_name = "HOW", value_enum)]
    pub(crate) hidden: Option<Hidden>,
    /// Draw lines behind at most N faces; 0 means any number; with --hidden [default: 0]
    #[arg(long, value_name = "N", value_parser = values::whole(0..=u32::MAX), allow_negative_numbers = true)]
    pub(crate) hidden_max_layers: Option<u32>,
    /// Edges at a larger angle are creases, 0 (all) to 180 (none) [default: 30]
    #[arg(long, value_name = "DEGREES", value_parser = values::half_turn, allow_negative_numbers = true)]
    pub(crate) crease_angle: Option<f64>,
    /// Override a material's property, as in `render`; a material that is told apart makes a line; repeatable
    #[arg(long, value_name = "NAME.PROPERTY=VALUE", value_parser = values::material)]
    pub(crate) material: Vec<MaterialOverride>,
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
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Page")]
pub(crate) struct PageArgs {
    /// The sheet: fit, for a drawing of 180 mm and no more paper than it needs, A0 to A6, or WxHmm [default: fit]
    #[arg(long, value_name = "SIZE", value_parser = page_size)]
    pub(crate) page: Option<Sheet>,
    /// The sheet with its longer side across
    #[arg(long, requires = "page")]
    pub(crate) landscape: bool,
    /// Distance of the drawing from the border of the sheet in millimetres [default: 5]
    #[arg(long, value_name = "MM", value_parser = margin, allow_negative_numbers = true)]
    pub(crate) margin: Option<f64>,
}

/// A sheet of paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sheet {
    /// As large as the drawing.
    Fit,
    /// Width and height in millimetres.
    Size([f64; 2]),
}

/// What is told.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Reports")]
pub(crate) struct DrawReportArgs {
    /// Counters and times as JSON on standard error
    #[arg(long)]
    pub(crate) stats: bool,
    /// No warnings
    #[arg(long, short)]
    pub(crate) quiet: bool,
    /// A progress bar [default: auto]
    #[arg(long, value_name = "WHEN", value_enum)]
    pub(crate) progress: Option<ProgressWhen>,
}

/// The help of `--lines`.
fn lines_help() -> String {
    let classes: Vec<String> = drawable().map(|(class, what)| format!("{} ({what})", class.name())).collect();
    format!(
        "Which lines are drawn: a list of {}; or all. An edge of several classes is drawn as the first of the list that it is \
         [default: contour,boundary,crease,material,intersection]",
        classes.join(", ")
    )
}

/// The classes that there are lines of, with a line each.
fn drawable() -> impl Iterator<Item = (LineClass, &'static str)> {
    LineClass::ALL.into_iter().filter(|row| row.0 != LineClass::Section).map(|(class, _, what)| (class, what))
}

/// `contour,crease`, or `all`.
fn line_classes(text: &str) -> Result<LineClasses, String> {
    if text == "all" {
        return Ok(LineClasses::ALL);
    }
    let class = |word: &str| {
        if word == LineClass::Section.name() {
            return Err("section: lines of sections are not there yet".to_owned());
        }
        let found = drawable().map(|row| row.0).find(|class| class.name() == word);
        let names: Vec<_> = drawable().map(|row| row.0.name()).collect();
        found.ok_or_else(|| format!("`{word}` is not one of {}; or all alone", names.join(", ")))
    };
    text.split(',').map(class).collect()
}

/// `fit`, `A4`, or `210x297mm`.
fn page_size(text: &str) -> Result<Sheet, String> {
    if text == "fit" {
        return Ok(Sheet::Fit);
    }
    let series = [("A0", [841, 1189]), ("A1", [594, 841]), ("A2", [420, 594]), ("A3", [297, 420])];
    let small = [("A4", [210, 297]), ("A5", [148, 210]), ("A6", [105, 148])];
    if let Some((_, size)) = series.iter().chain(&small).find(|(name, _)| name.eq_ignore_ascii_case(text)) {
        return Ok(Sheet::Size(size.map(f64::from)));
    }
    let sides = text.strip_suffix("mm").and_then(|sides| sides.split_once('x'));
    let side = |side: &str| values::positive(side).ok().filter(|&side| side <= 10_000.0);
    match sides.and_then(|(width, height)| Some([side(width)?, side(height)?])) {
        Some(size) => Ok(Sheet::Size(size)),
        None => {
            Err(format!("`{text}` is no sheet: fit, A0 to A6, or a size of up to 10 m such as 200x100mm is required"))
        }
    }
}

/// A distance of at least 0 mm.
fn margin(text: &str) -> Result<f64, String> {
    let margin = values::number(text)?;
    if (0.0..=1000.0).contains(&margin) { Ok(margin) } else { Err("0 to 1000 is required".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_sheets_are_read() {
        assert_eq!(line_classes("crease"), Ok(LineClasses::one(LineClass::Crease)));
        assert_eq!(line_classes("contour,boundary,crease,material,intersection"), Ok(LineClasses::USUAL));
        assert_eq!(line_classes("all"), Ok(LineClasses::ALL));
        assert!(line_classes("all,crease").is_err() && line_classes("").is_err());
        assert!(line_classes("section").unwrap_err().contains("not there yet"));
        assert_eq!((page_size("fit"), page_size("a4")), (Ok(Sheet::Fit), Ok(Sheet::Size([210.0, 297.0]))));
        assert_eq!(page_size("20x10.5mm"), Ok(Sheet::Size([20.0, 10.5])));
        assert!(["A9", "20x10", "0x3mm", "-1x1mm", "1e9x1mm"].iter().all(|text| page_size(text).is_err()));
        assert_eq!(margin("0"), Ok(0.0));
        assert!(margin("-1").is_err());
    }
}
