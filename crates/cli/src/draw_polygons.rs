//! `vitral draw --algorithm`: the polygons of an algorithm of the course, in its own order.

use crate::draw_args::{DrawArgs, Style};
use crate::report::{self, Failure};
use serde_json::{Value, json};
use vitral::{
    DrawingSettings, LineClass, PolygonDrawing, PolygonFill, PolygonSettings, Renderer, Visibility, covered_area,
};

/// Whether every option has an effect beside the algorithm.
pub(crate) fn check_options(args: &DrawArgs) -> Result<(), Failure> {
    let Some(algorithm) = args.polygons() else {
        return Ok(());
    };
    let lines = &args.lines;
    let outline = LineClass::Smooth.name();
    let other_pen =
        lines.stroke.iter().map(|(class, _)| class.as_str()).find(|class| ![outline, "title"].contains(class));

    // Each row: whether it is a mistake, and the option.
    let mistakes = [
        (lines.lines.is_some(), "--lines"),
        (lines.hidden.is_some(), "--hidden"),
        (lines.hidden_max_layers.is_some(), "--hidden-max-layers"),
        (lines.crease_angle.is_some(), "--crease-angle"),
        (lines.hide_tangent, "--hide-tangent"),
        (args.section.hatch.is_some(), "--hatch"),
    ];
    if let Some((_, option)) = mistakes.into_iter().find(|(is_mistake, _)| *is_mistake) {
        let what = format!("{option}: with --algorithm {algorithm}, the outlines of its polygons are the lines");
        return Err(Failure::usage(what).with_hint("leave it out, or choose --algorithm exact"));
    }
    let exact = [
        (args.fill.transparency, "--transparency", "all are opaque"),
        (args.fill.seams.is_some(), "--seams", "they are as they are"),
        (!args.page.views.is_empty(), "--views", "they are those of one view"),
    ];
    if let Some((_, option, why)) = exact.into_iter().find(|(is_mistake, ..)| *is_mistake) {
        let what = format!("{option}: --algorithm {algorithm} gives its own polygons, and {why}");
        return Err(Failure::usage(what).with_hint("leave it out, or choose --algorithm exact"));
    }
    if let Some(class) = other_pen {
        let what = format!("--stroke {class}: with --algorithm {algorithm}, all outlines are of the class {outline}");
        return Err(Failure::usage(what).with_hint(format!("give --stroke {outline}=MM")));
    }
    if args.overlaps() && args.page.simplify.is_some() {
        let what = format!("--simplify: the polygons of --algorithm {algorithm} are drawn as they are");
        return Err(Failure::usage(what).with_hint("leave it out, or choose --algorithm exact"));
    }
    Ok(())
}

/// Draws the polygons.
pub(crate) fn draw(
    args: &DrawArgs,
    algorithm: Visibility,
    renderer: &Renderer,
    settings: &DrawingSettings,
) -> Result<PolygonDrawing, Failure> {
    let lines: usize = renderer.world().instances.iter().map(|instance| instance.mesh.lines.len()).sum();
    if lines > 0 && !args.report.quiet {
        report::warnings(&[format!("--algorithm {algorithm} knows polygons alone: {lines} free lines are not drawn")]);
    }
    let (fill, outlines) = match args.style() {
        Style::HiddenLine if args.overlaps() => (PolygonFill::White, true),
        Style::HiddenLine => (PolygonFill::None, true),
        Style::Filled => (PolygonFill::Shaded, false),
        Style::FilledLines => (PolygonFill::Shaded, true),
    };
    let polygons = PolygonSettings { algorithm, fill, outlines, surfaces: args.surfaces().unwrap_or_default() };
    Ok(renderer.draw_polygons(&polygons, settings)?)
}

/// Counters.
pub(crate) fn stats_of(drawn: &PolygonDrawing) -> Value {
    let PolygonDrawing { drawing, model_polygons, pieces, counters, .. } = drawn;
    let (area, covered) = (drawing.area(), covered_area(&drawing.regions));
    json!({
        "model-polygons": model_polygons,
        "pieces": pieces,
        "shadowed-regions": drawing.regions.iter().filter(|region| region.unlit != 0).count(),
        "splits": counters.splits,
        "counters": nonzero(json!(counters)),
        "regions": drawing.regions.len(),
        "polylines": drawing.lines.len(),
        "region-square-millimetres": area,
        "covered-square-millimetres": covered,
        "square-millimetres-drawn-again": (area - covered).max(0.0),
    })
}

/// The counters that are not 0.
fn nonzero(counters: Value) -> Value {
    let Value::Object(fields) = counters else { return counters };
    Value::Object(fields.into_iter().filter(|(_, count)| count.as_u64() != Some(0)).collect())
}
