//! The stages of the pipeline with their counts, and the contents of the scene.

use crate::answer::Answer;
use crate::projector::projector;
use serde_json::{Value, json};
use vitral::explain::{Deciders, FacetSpaces, Overlying, explain, spaces};
use vitral::info::info_on;
use vitral::{Camera, Error, Projection, Renderer};

/// The stages with their input and output; for the facet that is seen at a pixel, its corners in
/// each space.
pub(crate) fn stages(renderer: &mut Renderer, pixel: Option<[u32; 2]>) -> Answer {
    let camera = renderer.frame_camera();
    let picture = renderer.render_from(&camera)?;
    let stats =
        serde_json::to_value(&picture.stats).map_err(|e| Error::usage(e.to_string(), ""))?;
    renderer.recycle(picture);

    // Bring the corners of the facet at the pixel through all spaces.
    let mut answer = json!({"stages": rows(&stats), "facet": null, "spaces": null, "projector": null, "faces": []});
    if let Some(pixel) = pixel {
        let explained = explain(renderer, &camera, pixel, &Deciders::Chosen, None)?;
        answer["faces"] =
            explained.candidates.iter().map(|c| facing(renderer, &camera, c)).collect();
        let surfaces = explained.surfaces;
        if let Some(nearest) = surfaces.first() {
            answer["facet"] = json!(nearest.facet);
            answer["spaces"] = rows_of(&spaces(renderer, &camera, nearest.facet)?);
        }
        answer["projector"] = projector(renderer, &camera, pixel, &surfaces);
    }
    Ok((answer, Vec::new()))
}

/// `V·N` of a facet: V from the eye to its middle, N its normal, both unit. Above 0 it is a back
/// face.
///
/// Source: the course, notes P, P14.
fn facing(renderer: &Renderer, camera: &Camera, over: &Overlying) -> Value {
    let facet = over.candidate.facet;
    let [a, b, c] = renderer.world().corners_of_facet(facet);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let from_eye = match camera.projection {
        Projection::Parallel { .. } => camera.focal_point - camera.position,
        _ => (a + b + c) / 3.0 - camera.position,
    };
    json!({
        "facet": facet,
        "surface": over.surface,
        "mesh": over.mesh,
        "fate": over.candidate.fate,
        "v-n": from_eye.normalize_or_zero().dot(normal),
    })
}

/// For each space a row for each corner.
fn rows_of(corners: &FacetSpaces) -> Value {
    fn rows<T: Copy + Into<f64>, const N: usize>(corners: &[[T; N]]) -> Vec<Value> {
        let row = |corner: &[T; N]| {
            let values = corner.iter().map(|&c| json!(Into::<f64>::into(c)));
            ["x", "y", "z", "w"].iter().map(|name| (*name).to_owned()).zip(values).collect()
        };
        corners.iter().map(row).collect()
    }
    json!({
        "model": rows(&corners.model),
        "world": rows(&corners.world),
        "view": rows(&corners.view),
        "clip": rows(&corners.clip),
        "ndc": rows(&corners.ndc),
        "screen": rows(&corners.screen),
    })
}

/// A row for each stage: its name, its input, its output.
fn rows(stats: &Value) -> Vec<Value> {
    // Read the sections of the statistics.
    let (cull, geometry, picture) = (&stats["cull"], &stats["geometry"], &stats["picture"]);
    let count = |value: &Value| value.as_u64().unwrap_or(0);

    // Count the triangles that culling of boxes leaves, and those that later culling drops.
    let left =
        count(&cull["triangles"]) - count(&cull["triangles-culled"]).min(count(&cull["triangles"]));
    let gone = ["outside", "back-facing", "degenerate", "no-sample", "not-finite"]
        .map(|name| count(&geometry[name]));

    // List the stages, each with what enters and what leaves it.
    let row = |stage: &str, goes_in: String, comes_out: String| json!({"stage": stage, "in": goes_in, "out": comes_out});
    let triangles = |n: u64| format!("{n} triangles");
    let kept = count(&geometry["triangles"]);
    let [shaded, layers, covered, pixels] =
        ["shaded-points", "layer-samples", "covered-pixels", "pixels"]
            .map(|name| count(&picture[name]));
    vec![
        row(
            "scene graph",
            format!("{} instances", count(&cull["instances"])),
            triangles(count(&cull["triangles"])),
        ),
        row(
            "model transform",
            "model space".to_owned(),
            format!("world space, {} instances", count(&cull["instances"])),
        ),
        row("culling of boxes", triangles(count(&cull["triangles"])), triangles(left)),
        row(
            "view transform",
            format!("{} vertices", count(&geometry["vertices"])),
            format!("{} vertices in view space", count(&geometry["vertices"])),
        ),
        row(
            "clipping and culling of faces",
            triangles(kept),
            format!(
                "{} cut, {} outside, {} back faces, {} without area or sample",
                count(&geometry["clipped"]),
                gone[0],
                gone[1],
                gone[2] + gone[3] + gone[4]
            ),
        ),
        row(
            "projection",
            "clip space".to_owned(),
            format!("{} triangles on the screen", count(&geometry["set-up"])),
        ),
        row(
            "rasterisation and visible surfaces",
            triangles(count(&geometry["set-up"])),
            format!("{covered} covered pixels, {layers} samples of layers"),
        ),
        row("illumination", format!("{shaded} places"), format!("{shaded} colours")),
        row("frame buffer", format!("{shaded} colours"), format!("{pixels} pixels")),
    ]
}

/// Counts, materials, lights and warnings of the scene, as `vitral info`.
pub(crate) fn info(renderer: &mut Renderer) -> Answer {
    let info = info_on(renderer.scene(), &renderer.execution().workers)?;
    let all = serde_json::to_value(&info).map_err(|e| Error::usage(e.to_string(), ""))?;
    let simple = |(name, value): (&String, &Value)| match value {
        Value::Number(_) | Value::Bool(_) => Some(json!({"name": name, "value": value})),
        // A colour has its numbers, a list its length.
        Value::Array(list) if !list.is_empty() && list.iter().all(Value::is_number) => {
            let numbers: Vec<String> = list.iter().map(Value::to_string).collect();
            Some(json!({"name": name, "value": numbers.join(" ")}))
        }
        Value::Array(list) if name != "warnings" => {
            Some(json!({"name": name, "value": list.len()}))
        }
        _ => None,
    };
    let rows: Vec<Value> = all.as_object().into_iter().flatten().filter_map(simple).collect();
    Ok((json!({"rows": rows, "warnings": info.warnings, "info": all}), Vec::new()))
}
