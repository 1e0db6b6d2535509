//! Sheets of `vitral draw --views`: several views on one page.

use crate::draw_args::{Angle, DrawArgs};
use crate::draw_file::too_large;
use crate::report::{self, Failure};
use serde_json::json;
use vitral::{
    DrawingSettings, Drawn, Error, Figure, Renderer, SYMBOL_SIZE, Sheet, SheetAngle, SheetError, SheetLayout, State,
    View, Viewpoint, names, symbol,
};

/// Scales below this share of the others' are told.
const SMALLER: f64 = 1.0 - 1e-9;

/// Whether the options suit a sheet, or have an effect without one.
pub(crate) fn check_options(args: &DrawArgs, state: &State) -> Result<(), Failure> {
    let views = &args.page.views;
    if views.is_empty() {
        return match args.page.angle {
            Some(_) => Err(Failure::usage("--angle: there is one view only").with_hint("add --views front,top,right")),
            None => Ok(()),
        };
    }
    if let Some(i) = (1..views.len()).find(|&i| views[..i].contains(&views[i])) {
        let name = names::view_name(views[i]);
        return Err(Failure::usage(format!("--views: {name} is there twice")).with_hint("name each view once"));
    }
    let has_methods = views.iter().filter(|&&view| view != View::Iso).count() > 1;
    if args.page.angle.is_some() && !has_methods {
        return Err(Failure::usage("--angle: a sheet with one orthographic view has no order of views")
            .with_hint("leave it out, or add views such as top,right"));
    }

    // The views bring their cameras.
    if args.perspective {
        return Err(Failure::usage("--perspective: the views of a sheet are parallel projections")
            .with_hint("leave out --perspective, or --views"));
    }
    let Viewpoint { view, up, orthographic, .. } = state.viewpoint;
    if let Some(view) = view {
        let hint = format!("leave out --view, and give --views {},...", names::view_name(view));
        return Err(Failure::usage("--view: the views of a sheet are those of --views").with_hint(hint));
    }
    if state.viewpoint != (Viewpoint { up, orthographic, ..Viewpoint::default() }) {
        let what = "--views: the views of a sheet have cameras of their own, and another one is given";
        return Err(Failure::usage(what)
            .with_hint("leave out --camera-... and --eye-..., in state files too; --up turns all views"));
    }
    Ok(())
}

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
    let (drawn, layout) =
        renderer.draw_sheet(settings, &sheet, args.surfaces().as_ref()).map_err(|error| failure(args, error))?;

    // Tell where the axonometric view has a scale of its own.
    let scale_of = |is_iso: bool| layout.views.iter().find(|view| (view.view == View::Iso) == is_iso).map(|v| v.scale);
    if let (Some(iso), Some(others)) = (scale_of(true), scale_of(false))
        && iso < others * SMALLER
        && !args.report.quiet
    {
        let [iso, others] = [iso, others].map(|scale| ratio(scale / unit_of(args)));
        report::warnings(&[format!("--views: iso is drawn at {iso}, since it does not fit the sheet at {others}")]);
    }
    Ok((drawn, layout))
}

/// What is said of a sheet that cannot be drawn.
fn failure(args: &DrawArgs, error: Error) -> Failure {
    match error {
        Error::Sheet(SheetError::TooLarge { size, room, fitting: Some(fitting) }) if args.page.scale.is_some() => {
            too_large(size, room, fitting / unit_of(args))
        }
        Error::Sheet(SheetError::TooLarge { size, room, .. }) => {
            let what = format!(
                "--views: {:.1} x {:.1} mm of gaps, and room for {:.1} x {:.1} mm",
                size[0], size[1], room[0], room[1]
            );
            Failure::usage(what).with_hint("choose a larger --page, a smaller --margin, or fewer views")
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
