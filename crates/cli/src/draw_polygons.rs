//! `vitral draw --algorithm`: the polygons of an algorithm of the course, in its own order.

use crate::draw_args::{DrawArgs, Style};
use crate::report::{self, Failure};
use serde_json::{Value, json};
use vitral::{
    DrawingSettings, PolygonDrawing, PolygonFill, PolygonSettings, Renderer, Visibility,
    covered_area,
};

/// Draws the polygons.
pub(crate) fn draw(
    args: &DrawArgs,
    algorithm: Visibility,
    renderer: &Renderer,
    settings: &DrawingSettings,
) -> Result<PolygonDrawing, Failure> {
    let lines: usize =
        renderer.world().instances.iter().map(|instance| instance.mesh.lines.len()).sum();
    let mut warnings = Vec::new();
    if lines > 0 {
        warnings.push(format!(
            "--algorithm {algorithm} draws polygons only: {lines} free lines are not drawn"
        ));
    }
    if !args.section.section_plane.is_empty() {
        warnings.push(format!("--algorithm {algorithm} draws polygons only: cuts are not hatched"));
    }
    if !args.report.quiet {
        report::warnings(&warnings);
    }
    let (fill, outlines) = match args.style() {
        Style::HiddenLine if args.overlaps() => (PolygonFill::White, true),
        Style::HiddenLine => (PolygonFill::None, true),
        Style::Filled => (PolygonFill::Shaded, false),
        Style::FilledLines => (PolygonFill::Shaded, true),
    };
    let polygons = PolygonSettings {
        algorithm,
        fill,
        outlines,
        surfaces: args.surfaces().unwrap_or_default(),
    };
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
