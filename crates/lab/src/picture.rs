//! A picture, its counters, and what it shows in words.

use crate::answer::Answer;
use crate::files::plain_name;
use serde_json::{Value, json};
use vitral::internals::render::stats::{GeometryStats, PictureCounters, TracingCounters};
use vitral::picture::{self, Channel};
use vitral::{Error, LightKind, Renderer, State, VisibilityCounters};

/// The picture of a state; with one sample a pixel where it may be coarse.
pub(crate) fn picture(
    renderer: &mut Renderer,
    state: &State,
    channel: Option<String>,
    coarse: bool,
) -> Answer {
    let channel: Channel = channel.as_deref().unwrap_or("color").parse()?;
    if coarse {
        renderer.settings.picture.samples = 1;
    }
    channel.request(&mut renderer.settings.picture.channels);
    let camera = renderer.frame_camera();
    let start = renderer.execution().budget.elapsed();
    let picture = renderer.render_from(&camera)?;
    let seconds = renderer.execution().budget.elapsed() - start;
    let pixels = picture::shown(&picture.frame, channel)?.data().as_flattened().to_vec();

    let lights = renderer.frame_lights(&camera);
    let answer = json!({
        "width": picture.width(),
        "height": picture.height(),
        "description": description(renderer, state, lights.len()),
        "seconds": seconds,
        "warnings": ([renderer.scene().warnings.clone(), picture.warnings.clone()].concat()),
        "counters": counters(&serde_json::to_value(&picture.stats).map_err(|e| Error::usage(e.to_string(), ""))?),
        "facts": {
            "models": state.models,
            "view": state.viewpoint.view.map(vitral::names::view_name),
            "visibility": renderer.settings.visibility.to_string(),
            "shading": renderer.settings.shading.model.name(),
            "lighting": renderer.settings.shading.lighting,
            "triangles": picture.stats.cull.triangles,
            "lights": lights.iter().filter(|light| light.kind != LightKind::Ambient).count(),
        },
    });
    renderer.recycle(picture);
    Ok((answer, vec![pixels]))
}

/// The picture in words: "teapot seen from front, z-buffer, phong shading, 2 lights".
fn description(renderer: &Renderer, state: &State, lights: usize) -> String {
    let settings = &renderer.settings;
    let models: Vec<&str> = state.models.iter().map(|model| plain_name(model)).collect();
    let view = state.viewpoint.view.map_or("the default side", vitral::names::view_name);
    let shading = match settings.shading.lighting {
        true => format!("{} shading", settings.shading.model.name()),
        false => "unlit".to_owned(),
    };
    let lights = if lights == 1 { "1 light".to_owned() } else { format!("{lights} lights") };
    format!(
        "{} seen from {view}, {}, {shading}, {lights}",
        models.join(" and "),
        settings.visibility
    )
}

/// Counters of culling by boxes.
const CULL_MEANINGS: &[(&str, &str)] = &[
    ("box_tests", "Box tests against the view volume."),
    ("instances_culled", "Objects that no box test let through."),
    ("triangles_culled", "Triangles thrown away with the box round them."),
];

/// Counters that are not zero, with what they mean.
fn counters(stats: &Value) -> Vec<Value> {
    let groups = [
        ("cull", CULL_MEANINGS),
        ("geometry", GeometryStats::MEANINGS),
        ("visibility", VisibilityCounters::MEANINGS),
        ("tracing", TracingCounters::MEANINGS),
        ("picture", PictureCounters::MEANINGS),
    ];
    let mut rows = Vec::new();
    for (group, meanings) in groups {
        for (name, meaning) in meanings {
            let name = name.replace('_', "-");
            let value = &stats[group][&name];
            if value.as_f64().is_some_and(|value| value != 0.0) {
                rows.push(
                    json!({"name": format!("{group}.{name}"), "value": value, "meaning": meaning}),
                );
            }
        }
    }
    rows
}
