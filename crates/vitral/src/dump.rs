//! What each stage of the pipeline hands on to the next, as files (COURSE.md P1).
//!
//! | file | stage |
//! |---|---|
//! | `1-scene.json` | the scene graph |
//! | `2-world.json` | model transform: every instance with its matrix and box |
//! | `3-cull.json` | culling: which triangles of which instances are left, and the counters |
//! | `4-lights.json` | illumination: the lights in view space |
//! | `5-view.json` | view transform and projection |
//! | `6-facets.csv` | clipping and projection: the pieces of facets on the screen |
//! | `7-surface.npy`, `7-surface.png`, `7-depth.npy` | rasterising: the visible surface of each pixel |
//! | `8-framebuffer.png` | the picture |
//! | `8-pass-00.png`, … | with `--transparency-order multi-pass` the picture after each pass, first what is opaque |
//! | `index.md` | this list |

use crate::picture::{self, EncodeOptions};
use crate::{Channel, Error, Frame, PictureFormat, Renderer, Scene};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use vitral_math::{Aabb, DMat4};
use vitral_raster::{BackFaces, SUBPIXEL, SamplePattern, Viewport};
use vitral_render::stats::CullCounters;
use vitral_render::{ColorSpace, PreparedView, Settings};
use vitral_scene::Camera;

/// Renders what `camera` sees and hands each stage's result to `write`, by file name.
///
/// # Errors
/// Those of [`Renderer::render`], and those of `write`.
pub fn dump(
    renderer: &mut Renderer,
    camera: &Camera,
    mut write: impl FnMut(&str, &[u8]) -> Result<(), Error>,
) -> Result<(), Error> {
    let viewport = renderer.settings.check().map_err(vitral_render::Error::from)?;
    let mut put = |name: &str, value: &Value| write(name, format!("{value:#}\n").as_bytes());
    put("1-scene.json", &scene_graph(renderer.scene()))?;
    put("2-world.json", &world(renderer))?;
    let cull_counters = {
        let mut counters = CullCounters::default();
        let view = prepare(renderer, camera, viewport, &mut counters);
        put("3-cull.json", &culled(&view, &counters))?;
        put("4-lights.json", &lights_in_view(renderer, camera, &view))?;
        put("5-view.json", &view_matrices(&view))?;
        let facets = facets(&view);
        write("6-facets.csv", facets.as_bytes())?;
        counters
    };

    // The same picture again, with the planes of the visible surface.
    let in_passes = has_passes(&renderer.settings);
    let wanted = renderer.settings.channels;
    let channels = &mut renderer.settings.channels;
    [Channel::Color, Channel::Depth, Channel::Id].iter().for_each(|c| c.request(channels));
    channels.passes = in_passes;
    let rendered = renderer.render_from(camera);
    renderer.settings.channels = wanted;
    let rendered = rendered?;
    debug_assert_eq!(rendered.stats.cull.triangles, cull_counters.triangles);
    let options = EncodeOptions { srgb: renderer.settings.color_space == ColorSpace::Srgb, ..EncodeOptions::default() };
    for (name, channel) in [
        ("7-surface.npy", Channel::Id),
        ("7-surface.png", Channel::Id),
        ("7-depth.npy", Channel::Depth),
        ("8-framebuffer.png", Channel::Color),
    ] {
        write(name, &picture::encode_with(&rendered.frame, channel, PictureFormat::from_path(name)?, &options)?)?;
    }
    for (number, pass) in rendered.frame.passes.iter().enumerate() {
        let frame = Frame { width: pass.width(), height: pass.height(), color: Some(pass.clone()), ..Frame::default() };
        let png = picture::encode_with(&frame, Channel::Color, PictureFormat::Png, &options)?;
        write(&format!("8-pass-{number:02}.png"), &png)?;
    }
    write("index.md", index(&renderer.settings, rendered.frame.passes.len()).as_bytes())
}

/// Whether the picture is made in passes.
fn has_passes(settings: &Settings) -> bool {
    let mut asked = settings.clone();
    asked.channels.passes = true;
    asked.check().is_ok()
}

/// As [`dump`], into a folder, which is made if it is not there.
///
/// # Errors
/// As [`dump`]; [`Error::Write`].
pub fn dump_to_folder(renderer: &mut Renderer, camera: &Camera, folder: impl AsRef<Path>) -> Result<(), Error> {
    let folder = folder.as_ref();
    std::fs::create_dir_all(folder).map_err(|source| Error::Write { path: folder.to_owned(), source })?;
    dump(renderer, camera, |name, bytes| picture::write(folder.join(name), bytes))
}

fn prepare<'a>(
    renderer: &'a Renderer,
    camera: &Camera,
    viewport: Viewport,
    counters: &mut CullCounters,
) -> PreparedView<'a> {
    let pattern = SamplePattern::new(1);
    PreparedView::new(renderer.session(), camera, &renderer.settings, viewport, pattern, renderer.execution(), counters)
}

/// Rows of a matrix, as they are written on paper.
fn matrix(m: &DMat4) -> Value {
    json!([0, 1, 2, 3].map(|r| m.row(r).to_array()))
}

fn bounds(b: &Aabb) -> Value {
    if b.is_empty() { Value::Null } else { json!({"min": b.min.to_array(), "max": b.max.to_array()}) }
}

fn scene_graph(scene: &Scene) -> Value {
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

fn world(renderer: &Renderer) -> Value {
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

fn culled(view: &PreparedView<'_>, counters: &CullCounters) -> Value {
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

fn lights_in_view(renderer: &Renderer, camera: &Camera, view: &PreparedView<'_>) -> Value {
    let lights = renderer.frame_lights(camera);
    let in_view = lights.iter().map(|l| l.transformed(&view.view.view_from_world));
    json!({
        "view-space": in_view.collect::<Vec<_>>(),
        "global-ambient": renderer.frame_ambient(),
        "illumination": renderer.settings.illumination,
        "lighting": renderer.settings.lighting,
    })
}

fn view_matrices(view: &PreparedView<'_>) -> Value {
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

/// One line for each piece on the screen: facet, surface, corners in pixels, range of depth.
fn facets(view: &PreparedView<'_>) -> String {
    let world = view.session.world();
    let mut text = "facet,surface,x0,y0,x1,y1,x2,y2,z_min,z_max\n".to_owned();
    let pixels = |v: i32| f64::from(v) / f64::from(SUBPIXEL);
    for instance in &view.instances {
        for draw in instance.opaque.iter().chain(&instance.layered) {
            for triangle in draw.ranges.iter().cloned().flatten() {
                let facet = draw.first_facet + triangle;
                for s in view.setups(facet, draw.back_faces) {
                    let [a, b, c] = [0, 1, 2].map(|i| format!("{},{}", pixels(s.x[i]), pixels(s.y[i])));
                    let surface = world.surface_of_facet(facet);
                    // Writing to a String cannot fail.
                    let _ = writeln!(text, "{facet},{surface},{a},{b},{c},{},{}", s.z_min, s.z_max);
                }
            }
        }
    }
    text
}

fn index(settings: &Settings, passes: usize) -> String {
    let of_passes = (0..passes).map(|n| format!("   - [after pass {n}](8-pass-{n:02}.png)\n")).collect::<String>();
    format!(
        "# The pipeline, stage by stage\n\n\
         1. [Scene graph](1-scene.json)\n\
         2. [Model transform](2-world.json): instances in world space\n\
         3. [Culling](3-cull.json): what is left of them\n\
         4. [Illumination](4-lights.json): the lights in view space\n\
         5. [View transform and projection](5-view.json)\n\
         6. [Clipping and projection](6-facets.csv): facets on the screen, in pixels from the top left; depth is 1 near, \
         0 far\n\
         7. Rasterising ({}): surface ids ([numbers](7-surface.npy), [colours](7-surface.png)) and [depth](7-depth.npy) \
         at pixel centres\n\
         8. [Frame buffer](8-framebuffer.png): {} x {} pixels, {} samples each\n{of_passes}",
        settings.visibility, settings.width, settings.height, settings.samples
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load_builtin;
    use std::collections::BTreeMap;

    fn stages(name: &str) -> BTreeMap<String, Vec<u8>> {
        let mut renderer = Renderer::new(load_builtin(name).unwrap()).unwrap();
        (renderer.settings.width, renderer.settings.height) = (64, 48);
        let mut files = BTreeMap::new();
        let camera = renderer.frame_camera();
        dump(&mut renderer, &camera, |name, bytes| {
            files.insert(name.to_owned(), bytes.to_vec());
            Ok(())
        })
        .unwrap();
        assert!(!renderer.settings.channels.depth, "the settings are as before");
        files
    }

    #[test]
    fn p1_every_stage_is_exported() {
        let files = stages("cubs");
        let index = std::str::from_utf8(&files["index.md"]).unwrap();
        assert_eq!(files.len(), 11);
        for name in files.keys().filter(|n| *n != "index.md") {
            assert!(index.contains(&format!("({name})")), "{name} is in the index");
        }
        let json = |name: &str| serde_json::from_slice::<Value>(&files[name]).unwrap();
        assert_eq!(json("1-scene.json")["meshes"].as_array().unwrap().len(), 8);
        assert_eq!(json("2-world.json")["facets"], 96);
        assert_eq!(json("3-cull.json")["kept"].as_array().unwrap().len(), 8);
        assert_eq!(json("4-lights.json")["view-space"].as_array().unwrap().len(), 2);
        assert_eq!(json("5-view.json")["clip-from-view"][3], json!([0.0, 0.0, -1.0, 0.0]));
        let facets = std::str::from_utf8(&files["6-facets.csv"]).unwrap().lines().count() - 1;
        assert!((16..=48).contains(&facets), "back faces are gone, three faces of a cube are seen at most: {facets}");
    }
}
