//! The scene graph and what becomes of its nodes, as JSON.

use crate::{Renderer, Scene};
use serde_json::{Value, json};
use vitral_math::{Aabb, DMat4};
use vitral_raster::BackFaces;
use vitral_render::PreparedView;
use vitral_render::stats::CullCounters;
use vitral_scene::Camera;

/// Rows of a matrix, as they are written on paper.
fn matrix(m: &DMat4) -> Value {
    json!([0, 1, 2, 3].map(|r| m.row(r).to_array()))
}

fn bounds(b: &Aabb) -> Value {
    if b.is_empty() {
        Value::Null
    } else {
        json!({"min": b.min.to_array(), "max": b.max.to_array()})
    }
}

pub(super) fn scene_graph(scene: &Scene) -> Value {
    let nodes: Vec<Value> = scene
        .nodes
        .iter()
        .map(|node| {
            json!({
                "name": node.name,
                "parent-from-node": matrix(&node.transform.matrix()),
                "children": node.children,
                "mesh": node.mesh,
                "camera": node.camera,
                "light": node.light,
            })
        })
        .collect();
    let mesh = |m: &std::sync::Arc<vitral_scene::Mesh>| {
        json!({
            "name": m.name,
            "vertices": m.positions.len(),
            "faces": m.face_count(),
            "triangles": m.triangles.len(),
            "bounds": bounds(&m.bounds()),
            "parts": m.parts.iter().map(|p| json!({
                "name": p.name, "triangles": [p.triangles.start, p.triangles.end], "material": p.material,
            })).collect::<Vec<_>>(),
        })
    };
    json!({
        "roots": scene.roots,
        "nodes": nodes,
        "meshes": scene.meshes.iter().map(mesh).collect::<Vec<_>>(),
        "materials": scene.materials,
        "lights": scene.lights,
        "cameras": scene.cameras,
        "ambient": scene.ambient,
    })
}

pub(super) fn world(renderer: &Renderer) -> Value {
    let world = renderer.world();
    let instance = |(number, i): (usize, &vitral_scene::Instance)| {
        json!({
            "instance": number,
            "node": i.node,
            "mesh": i.mesh_index,
            "world-from-model": matrix(&i.world_from_model),
            "bounds": bounds(&i.bounds),
            "first-surface": i.first_surface,
            "first-facet": i.first_facet,
        })
    };
    json!({
        "instances": world.instances.iter().enumerate().map(instance).collect::<Vec<_>>(),
        "bounds": bounds(&world.bounds),
        "surfaces": world.surface_count,
        "facets": world.facet_count,
    })
}

pub(super) fn culled(view: &PreparedView<'_>, counters: &CullCounters) -> Value {
    let draws = |draws: &[vitral_raster::Draw<'_>]| {
        let draw = |d: &vitral_raster::Draw<'_>| {
            json!({
                "triangles": d.ranges.iter().map(|r| [r.start, r.end]).collect::<Vec<_>>(),
                "back-faces": match d.back_faces {
                    BackFaces::Kept => "kept",
                    BackFaces::Dropped => "dropped",
                    BackFaces::DroppedOf(_) => "dropped of solid bodies",
                },
            })
        };
        draws.iter().map(draw).collect::<Vec<_>>()
    };
    let instance = |i: &vitral_render::prepare::PreparedInstance<'_>| json!({"instance": i.instance, "opaque": draws(&i.opaque), "transparent": draws(&i.layered)});
    json!({"kept": view.instances.iter().map(instance).collect::<Vec<_>>(), "counters": counters})
}

pub(super) fn lights_in_view(
    renderer: &Renderer,
    camera: &Camera,
    view: &PreparedView<'_>,
) -> Value {
    let lights = renderer.frame_lights(camera);
    let in_view = lights.iter().map(|l| l.transformed(&view.view.view_from_world));
    json!({
        "view-space": in_view.collect::<Vec<_>>(),
        "global-ambient": renderer.frame_ambient(),
        "illumination": renderer.settings.shading.illumination,
        "lighting": renderer.settings.shading.lighting,
    })
}

pub(super) fn view_matrices(view: &PreparedView<'_>) -> Value {
    json!({
        "camera": view.camera,
        "view-from-world": matrix(&view.view.view_from_world),
        "clip-from-view": matrix(&view.view.clip_from_view),
        "near": view.view.near,
        "far": view.view.far,
        "width": view.viewport.width,
        "height": view.viewport.height,
    })
}
