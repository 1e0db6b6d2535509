//! The file that `vitral draw` writes: its place, format and pens, and whether the options suit it.

use crate::draw_args::{DrawArgs, Hidden, Style};
use crate::draw_checks;
use crate::draw_sheet;
use crate::outputs::{expand, model_name};
use crate::report::{self, Failure};
use std::path::{Path, PathBuf};
use vitral::{
    Drawing, DrawingFormat, DrawingOptions, DrawingSettings, LineClass, PageSize, State,
    TitleBlock, for_plotter, simplify,
};

/// Exit code of formats that drawings are not written in.
const UNSUPPORTED: u8 = 4;
/// The longest side of a drawing to scale, in millimetres.
const LONGEST: f64 = 10_000.0;
/// What a drawing may be larger than its sheet for the rounding of its corners: millimetres, and a
/// part of its size.
const ROUNDING: [f64; 2] = [0.002, 1e-6];

/// Where a drawing goes.
#[derive(Debug)]
pub(crate) struct DrawFile {
    /// The file, or `-`.
    pub(crate) path: PathBuf,
    format: DrawingFormat,
    options: DrawingOptions,
    /// Ordered for a plotter.
    plotter: bool,
    /// Tolerance of simplified lines, millimetres.
    tolerance: f64,
    title: Option<TitleBlock>,
}

impl DrawFile {
    /// The file to write, after a check of everything that can be checked before the work.
    pub(crate) fn new(args: &DrawArgs, state: &State, model: &Path) -> Result<Self, Failure> {
        let (path, format) = place(args, model)?;
        draw_checks::check(args, state, format)?;

        // Choose the pens.
        let mut options = DrawingOptions::default();
        if args.lines.hidden == Some(Hidden::Solid) {
            options.pens.hidden_dashes = None;
        }
        for (name, width) in &args.lines.stroke {
            if let Some(pen) = options.pens.width_mut(name) {
                *pen = *width;
            }
        }

        // Take the rest over.
        options.decimals = args.page.precision.unwrap_or(options.decimals);
        options.surface_ids = args.page.svg_ids;
        options.region_outlines =
            Some(LineClass::Smooth).filter(|_| args.overlaps() && args.style() != Style::Filled);
        let tolerance = args.page.simplify.unwrap_or(0.0);
        let rows = &args.page.title_block;
        let symbol = draw_sheet::projection_symbol(args);
        let has_block = symbol.is_some() || !rows.is_empty();
        let title = has_block.then(|| TitleBlock::with_figure(rows, symbol.as_ref()));
        let title = title.transpose().map_err(|letter| {
            Failure::usage(format!("--title-block: there is no stroke letter for `{letter}`"))
        })?;
        Ok(Self { path, format, options, plotter: args.page.plotter, tolerance, title })
    }

    /// The page without the title block.
    pub(crate) fn page_above_title(
        &self,
        page: PageSize,
        margin: f64,
    ) -> Result<PageSize, Failure> {
        let (Some(title), PageSize::Sheet { width, height }) = (&self.title, page) else {
            return Ok(page);
        };
        let height = height - title.room();
        if title.size[0] + 2.0 * margin > width || height <= 2.0 * margin {
            let [across, up] = title.size;
            let what = format!(
                "--page: a title block of {across:.1} x {up:.1} mm leaves no room on the sheet"
            );
            return Err(Failure::usage(what).with_hint("choose a larger --page, or shorter texts"));
        }
        Ok(PageSize::Sheet { width, height })
    }

    /// What the format leaves out of a drawing, or that there is nothing in it.
    pub(crate) fn warning(&self, drawing: &Drawing) -> Option<String> {
        if drawing.lines.is_empty() && drawing.regions.is_empty() && drawing.points.is_empty() {
            let what =
                "the drawing is empty: the models have no surface or line that this style shows";
            return Some(format!(
                "{}: {what} (--style lines draws free points, too)",
                self.path.display()
            ));
        }
        let is_left_out = !drawing.regions.is_empty() && (self.plotter || !self.format.has_fills());
        is_left_out.then(|| format!("{}: filled regions are left out", self.path.display()))
    }

    /// Makes the file's content.
    pub(crate) fn encode(&self, mut drawing: Drawing, margin: f64) -> Vec<u8> {
        if self.tolerance > 0.0 {
            simplify(&mut drawing, self.tolerance);
        }
        let mut options = self.options.clone();
        if let Some(title) = &self.title {
            options.title = title.place(&mut drawing, margin);
        }
        // HP-GL is ordered by its writer, in the plotter's own steps.
        if self.plotter && self.format != DrawingFormat::Hpgl {
            let (drawing, options) = for_plotter(&drawing, &options);
            return self.format.encode(&drawing, &options);
        }
        self.format.encode(&drawing, &options)
    }
}

/// The path and the format of its extension.
fn place(args: &DrawArgs, model: &Path) -> Result<(PathBuf, DrawingFormat), Failure> {
    if report::is_standard(&args.output) {
        if args.process.save_state.as_deref().is_some_and(report::is_standard) {
            return Err(Failure::usage(
                "--output - and --save-state - both write to standard output",
            ));
        }
        return Ok((args.output.clone(), DrawingFormat::Svg));
    }
    // Fill the model's name in.
    let model = model_name(model);
    let path = PathBuf::from(expand(args.output.as_os_str(), &model, 0)?);

    // Find the format.
    let extension = path.extension().map(|e| e.to_string_lossy().into_owned()).unwrap_or_default();
    let Some(format) = DrawingFormat::from_extension(&extension) else {
        let names = DrawingFormat::ALL
            .iter()
            .flat_map(|(_, names)| names.iter().map(|name| format!(".{name}")));
        let names: Vec<String> = names.collect();
        let what = format!("{}: drawings are not written in this format", path.display());
        return Err(
            Failure::with_code(UNSUPPORTED, what).with_hint(format!("choose {}", names.join(", ")))
        );
    };
    vitral::picture::check_place(&path)?;
    Ok((path, format))
}

/// The page of a drawing to scale; `window` is the longer side of the camera's window in units of
/// the model, if it is not in perspective.
pub(crate) fn scaled_page(
    args: &DrawArgs,
    page: PageSize,
    window: Option<f64>,
) -> Result<PageSize, Failure> {
    let Some(scale) = args.page.scale else { return Ok(page) };
    let Some(window) = window else {
        return Err(Failure::usage("--scale: a perspective drawing has no scale")
            .with_hint("add --camera-orthographic"));
    };
    let sheet = match page {
        PageSize::Sheet { width, height } => Some([width, height]),
        PageSize::Fit { .. } | PageSize::Scaled { .. } | PageSize::Window { .. } => None,
    };
    Ok(PageSize::Scaled {
        window: window * args.page.unit.unwrap_or_default().millimetres() * scale,
        sheet,
    })
}

/// Whether a drawing to scale fits its sheet.
pub(crate) fn check_fits(
    args: &DrawArgs,
    settings: &DrawingSettings,
    drawing: &Drawing,
) -> Result<(), Failure> {
    let (Some(scale), PageSize::Scaled { sheet, .. }) = (args.page.scale, settings.page) else {
        return Ok(());
    };
    // A sheet that fits the drawing has room for any that is not too large to be one.
    let room = sheet.map_or([LONGEST; 2], |sheet| sheet.map(|side| side - 2.0 * settings.margin));
    let size = match sheet {
        Some(_) => drawing.extent(),
        None => [drawing.width, drawing.height].map(|side| side - 2.0 * settings.margin),
    };
    let room_with_rounding = [0, 1].map(|k| room[k] + ROUNDING[0] + ROUNDING[1] * size[k]);
    if (0..2).all(|k| size[k] <= room_with_rounding[k]) {
        return Ok(());
    }

    // Name the largest scale that fits, by the same measure.
    let ratios = [0, 1].map(|k| room_with_rounding[k] / size[k]);
    Err(too_large(size, room, scale * ratios.into_iter().fold(f64::INFINITY, f64::min)))
}

/// A drawing to scale does not fit its sheet, but one at `fitting` would.
pub(crate) fn too_large(size: [f64; 2], room: [f64; 2], fitting: f64) -> Failure {
    let fitting = round_scale(fitting);
    let sides = |[width, height]: [f64; 2]| format!("{width:.1} x {height:.1} mm");
    let what =
        format!("--scale: the drawing has {}, the sheet has room for {}", sides(size), sides(room));
    Failure::usage(what)
        .with_hint(format!("--scale {fitting} fits; or choose a larger --page, a smaller --margin"))
}

/// The largest scale of round numbers that is no larger.
fn round_scale(scale: f64) -> String {
    match scale < 1.0 {
        true => format!("1:{}", (1.0 / scale).ceil()),
        false => format!("{}", (scale * 100.0).floor() / 100.0),
    }
}
