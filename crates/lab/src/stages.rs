//! What each stage of the pipeline hands on, and what is in the scene.

use crate::answer::Answer;
use serde_json::{Value, json};
use vitral::explain::{Deciders, explain};
use vitral::info::info_on;
use vitral::{Error, Renderer, dump};

/// The stages with what goes in and comes out; for the facet that is seen at a pixel, its corners in each space.
pub(crate) fn stages(renderer: &mut Renderer, pixel: Option<[u32; 2]>) -> Answer {
    let camera = renderer.frame_camera();
    let picture = renderer.render_from(&camera)?;
    let stats = serde_json::to_value(&picture.stats).map_err(|e| Error::usage(e.to_string(), ""))?;
    renderer.recycle(picture);

    // Take the corners of the facet from the tables of the stages.
    let facet = match pixel {
        Some(pixel) => explain(renderer, &camera, pixel, &Deciders::Chosen, None)?.surfaces.first().map(|s| s.facet),
        None => None,
    };
    let mut spaces = serde_json::Map::new();
    if let Some(facet) = facet {
        dump::dump(renderer, &camera, |name, bytes| {
            let tables = [
                ("4-illuminated.csv", "world"),
                ("5-view.csv", "view"),
                ("6-clip.csv", "clip"),
                ("7-project.csv", "screen"),
            ];
            if let Some((_, space)) = tables.iter().find(|(table, _)| *table == name) {
                spaces.insert((*space).to_owned(), rows_of(&String::from_utf8_lossy(bytes), facet));
            }
            Ok(())
        })?;
    }
    let answer = json!({"stages": rows(&stats), "facet": facet, "spaces": spaces});
    Ok((answer, Vec::new()))
}

/// The rows of a table that begin with a facet, each as an object by the table's head.
fn rows_of(table: &str, facet: u32) -> Value {
    let mut lines = table.lines();
    let head: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let first = format!("{facet},");
    let row = |line: &str| -> Value {
        let values = line.split(',').map(|cell| cell.parse::<f64>().map_or(Value::Null, |number| json!(number)));
        head.iter().map(|name| (*name).to_owned()).zip(values).collect()
    };
    lines.filter(|line| line.starts_with(&first)).map(row).collect()
}

/// A row for each stage: its name, what goes in, what comes out.
fn rows(stats: &Value) -> Vec<Value> {
    let (cull, geometry, picture) = (&stats["cull"], &stats["geometry"], &stats["picture"]);
    let count = |value: &Value| value.as_u64().unwrap_or(0);
    let left = count(&cull["triangles"]) - count(&cull["triangles-culled"]).min(count(&cull["triangles"]));
    let gone = ["outside", "back-facing", "degenerate", "no-sample", "not-finite"].map(|name| count(&geometry[name]));
    let row =
        |stage: &str, goes_in: String, comes_out: String| json!({"stage": stage, "in": goes_in, "out": comes_out});
    vec![
        row(
            "model transform and culling of boxes",
            format!("{} triangles of {} objects", count(&cull["triangles"]), count(&cull["instances"])),
            format!("{left} triangles"),
        ),
        row(
            "view transform and projection",
            format!("{} vertices", count(&geometry["vertices"])),
            format!("{} vertices in clip space", count(&geometry["vertices"])),
        ),
        row(
            "clipping and culling of faces",
            format!("{} triangles", count(&geometry["triangles"])),
            format!(
                "{} set up, {} cut, {} outside, {} back faces, {} without area or sample",
                count(&geometry["set-up"]),
                count(&geometry["clipped"]),
                gone[0],
                gone[1],
                gone[2] + gone[3] + gone[4]
            ),
        ),
        row(
            "visible surfaces and shading",
            format!("{} triangles", count(&geometry["set-up"])),
            picture.as_object().map_or(String::new(), |fields| {
                let told = fields.iter().filter(|(_, value)| value.as_f64().is_some_and(|v| v != 0.0));
                told.map(|(name, value)| format!("{value} {}", name.replace('-', " "))).collect::<Vec<_>>().join(", ")
            }),
        ),
    ]
}

/// Counts, materials, lights and warnings of the scene, as `vitral info`.
pub(crate) fn info(renderer: &mut Renderer) -> Answer {
    let info = info_on(renderer.scene(), &renderer.execution().workers)?;
    let all = serde_json::to_value(&info).map_err(|e| Error::usage(e.to_string(), ""))?;
    let simple = |(name, value): (&String, &Value)| match value {
        Value::Number(_) | Value::Bool(_) => Some(json!({"name": name, "value": value})),
        Value::Array(list) if name != "warnings" => Some(json!({"name": name, "value": list.len()})),
        _ => None,
    };
    let rows: Vec<Value> = all.as_object().into_iter().flatten().filter_map(simple).collect();
    Ok((json!({"rows": rows, "warnings": info.warnings, "info": all}), Vec::new()))
}
