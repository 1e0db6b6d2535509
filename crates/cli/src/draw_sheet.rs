//! Sheets of `vitral draw --views`: several views on one page.

use crate::draw_args::{Angle, DrawArgs};
use crate::draw_file::too_large;
use crate::report::{self, Failure};
use serde_json::json;
use vitral::{
    DrawingSettings, Drawn, Error, Figure, Renderer, SYMBOL_SIZE, Sheet, SheetAngle, SheetError,
    SheetLayout, View, names, symbol,
};

/// Scales below this share of the others' are told.
const SMALLER: f64 = 1.0 - 1e-9;

/// The symbol of the projection method, on sheets with views that it places.
pub(crate) fn projection_symbol(args: &DrawArgs) -> Option<Figure> {
    let orthographic = args.page.views.iter().filter(|&&view| view != View::Iso).count();
    (orthographic > 1).then(|| Figure { size: SYMBOL_SIZE, strokes: symbol(angle_of(args)) })
}

fn angle_of(args: &DrawArgs) -> SheetAngle {
    match args.page.angle.unwrap_or_default() {
        Angle::First => SheetAngle::First,
        Angle::Third => SheetAngle::Third,
    }
}

/// Millimetres of the model in a unit of it.
fn unit_of(args: &DrawArgs) -> f64 {
    args.page.unit.unwrap_or_default().millimetres()
}

/// Draws the sheet.
pub(crate) fn draw(
    args: &DrawArgs,
    renderer: &Renderer,
    settings: &DrawingSettings,
) -> Result<(Drawn, SheetLayout), Failure> {
    let sheet = Sheet {
        views: args.page.views.clone(),
        angle: angle_of(args),
        scale: args.page.scale.map(|scale| scale * unit_of(args)),
    };
    let (drawn, layout) = renderer
        .draw_sheet(settings, &sheet, args.surfaces().as_ref())
        .map_err(|error| failure(args, error))?;

    // Tell where the axonometric view has a scale of its own.
    let scale_of = |is_iso: bool| {
        layout.views.iter().find(|view| (view.view == View::Iso) == is_iso).map(|v| v.scale)
    };
    if let (Some(iso), Some(others)) = (scale_of(true), scale_of(false))
        && iso < others * SMALLER
        && !args.report.quiet
    {
        let [iso, others] = [iso, others].map(|scale| ratio(scale / unit_of(args)));
        report::warnings(&[format!(
            "--views: iso is drawn at {iso}, since it does not fit the sheet at {others}"
        )]);
    }
    Ok((drawn, layout))
}

/// The message for a sheet that cannot be laid out.
fn failure(args: &DrawArgs, error: Error) -> Failure {
    match error {
        Error::Sheet(SheetError::TooLarge { size, room, fitting: Some(fitting) })
            if args.page.scale.is_some() =>
        {
            too_large(size, room, fitting / unit_of(args))
        }
        Error::Sheet(SheetError::TooLarge { size, room, .. }) => {
            let what = format!(
                "--views: the gaps between views need {:.1} x {:.1} mm, the sheet has room for {:.1} x {:.1} mm",
                size[0], size[1], room[0], room[1]
            );
            Failure::usage(what)
                .with_hint("choose a larger --page, a smaller --margin, or fewer views")
        }
        error => error.into(),
    }
}

/// A scale as people write it, to three digits.
fn ratio(scale: f64) -> String {
    if scale < 1.0 { format!("1:{:.2}", 1.0 / scale) } else { format!("{scale:.2}:1") }
}

/// Where the views are, for `--stats`.
pub(crate) fn stats_of(args: &DrawArgs, layout: &SheetLayout) -> serde_json::Value {
    let views = layout.views.iter().map(|view| {
        let [low, high] = view.corners;
        json!({
            "view": names::view_name(view.view),
            "scale": view.scale / unit_of(args),
            "x": [low[0], high[0]],
            "y": [low[1], high[1]],
        })
    });
    views.collect()
}
