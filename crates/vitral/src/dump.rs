//! What each stage of the pipeline hands on to the next, as files (docs/course.md P1).
//!
//! | file | stage |
//! |---|---|
//! | `1-scene.json` | the scene graph |
//! | `2-world.json` | model transform: every instance with its matrix and box |
//! | `3-cull.json` | culling: which triangles of which instances are left, and the counters |
//! | `4-lights.json`, `4-illuminated.csv` | illumination: the lights in view space; the corners of facets, world space, with their colours |
//! | `5-view.json`, `5-view.csv` | view transform: the camera and its matrices; the corners in view space |
//! | `6-clip.csv` | clipping: polygons in clip space, before the division by `w` |
//! | `7-project.csv` | projection: the pieces of facets on the screen |
//! | `8-surface.npy`, `8-surface.png`, `8-depth.npy` | rasterising: the visible surface of each pixel |
//! | `8-edge-table.txt` | with `--visibility scan-line` its polygon table, edge table, active edges and spans |
//! | `9-framebuffer.png` | the picture |
//! | `9-pass-00.png`, … | with `--transparency-order multi-pass` the picture after each pass, first what is opaque |
//! | `9-opaque.png`, … | with `--transparency-order two-buffer` both buffers, and the list of transparent surfaces |
//! | `index.md` | this list |
//!
//! Stages 4 to 8 and both buffers have one sample a pixel, at its centre. Pictures illuminate what
//! is seen, after stage 8; stage 4 shows what the same formulas make of corners.

mod edge_table;
mod facets;
mod scene;
mod stage;
mod two_buffer;

use crate::{Channel, Error, Frame, Picture, PictureFormat, Renderer, picture};
use serde_json::Value;
use stage::{Listed, Write};
use std::path::Path;
use vitral_render::stats::CullCounters;
use vitral_render::{Settings, TransparencyOrder, illuminate_corners};
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
    let (mut of_samples, mut of_picture) = (Vec::new(), Vec::new());

    // Stages 1 to 7: geometry.
    write_scene(renderer, &mut write)?;
    let cull = write_geometry(renderer, camera, &mut write, &mut of_picture)?;

    // Stage 8 of scan lines, as text.
    if renderer.settings.visibility.has_edge_table {
        let (name, what) = (
            "8-edge-table.txt".to_owned(),
            "polygon table, edge table, active edges, spans".to_owned(),
        );
        write(&name, edge_table::edge_tables(renderer, camera, viewport)?.as_bytes())?;
        of_samples.push(Listed { name, what });
    }

    // Stages 8 and 9: samples and the picture.
    let rendered = render_planes(renderer, camera)?;
    debug_assert_eq!(rendered.stats.cull.triangles, cull.triangles);
    write_picture(&rendered, &mut write, &mut of_picture)?;
    if has_list(&renderer.settings) {
        of_picture.extend(two_buffer::write(renderer, camera, &mut write)?);
    }
    write("index.md", index(&renderer.settings, &of_samples, &of_picture).as_bytes())
}

/// Writes a value as indented JSON.
fn write_json(write: &mut Write<'_>, name: &str, value: &Value) -> Result<(), Error> {
    write(name, format!("{value:#}\n").as_bytes())
}

/// Stages 1 and 2: the scene graph and the world.
fn write_scene(renderer: &Renderer, write: &mut Write<'_>) -> Result<(), Error> {
    write_json(write, "1-scene.json", &scene::scene_graph(renderer.scene()))?;
    write_json(write, "2-world.json", &scene::world(renderer))
}

/// Stages 3 to 7: culling, illumination, view transform, clipping, projection; and the list of
/// transparent surfaces of the two-buffer order. Gives the counters of culling.
fn write_geometry(
    renderer: &Renderer,
    camera: &Camera,
    write: &mut Write<'_>,
    listed: &mut Vec<Listed>,
) -> Result<CullCounters, Error> {
    let lights = renderer.frame_lights(camera);
    let shot = renderer.shot(camera, &lights);
    let corners = illuminate_corners(
        renderer.session(),
        &shot,
        &renderer.picture_settings(),
        renderer.execution(),
        None,
    )?;
    let mut counters = CullCounters::default();
    let view = renderer.prepared(camera, &mut counters)?;
    write_json(write, "3-cull.json", &scene::culled(&view, &counters))?;
    write_json(write, "4-lights.json", &scene::lights_in_view(renderer, camera, &view))?;
    write_json(write, "5-view.json", &scene::view_matrices(&view))?;
    write("4-illuminated.csv", facets::illuminated(&corners).as_bytes())?;
    write("5-view.csv", facets::in_view(&corners).as_bytes())?;
    write("6-clip.csv", facets::clipped(&view).as_bytes())?;
    write("7-project.csv", facets::projected(&view).as_bytes())?;
    if has_list(&renderer.settings) {
        let (name, what) =
            ("9-transparent.csv".to_owned(), "the list of transparent surfaces".to_owned());
        write(&name, two_buffer::list(&view).as_bytes())?;
        listed.push(Listed { name, what });
    }
    Ok(counters)
}

/// Renders the picture with the planes of the visible surface, and what each pass left.
fn render_planes(renderer: &mut Renderer, camera: &Camera) -> Result<Picture, Error> {
    let in_passes = has_passes(&renderer.settings);
    let wanted = renderer.settings.picture.channels;
    let channels = &mut renderer.settings.picture.channels;
    [Channel::Color, Channel::Depth, Channel::Surface].iter().for_each(|c| c.request(channels));
    channels.passes = in_passes;
    let rendered = renderer.render_from(camera);
    renderer.settings.picture.channels = wanted;
    rendered
}

/// Stages 8 and 9: the planes of a frame, and the picture after each pass.
fn write_picture(
    rendered: &Picture,
    write: &mut Write<'_>,
    listed: &mut Vec<Listed>,
) -> Result<(), Error> {
    for (name, channel) in [
        ("8-surface.npy", Channel::Surface),
        ("8-surface.png", Channel::Surface),
        ("8-depth.npy", Channel::Depth),
        ("9-framebuffer.png", Channel::Color),
    ] {
        write(name, &rendered.encode_channel(channel, PictureFormat::from_path(name)?)?)?;
    }
    for (number, pass) in rendered.frame.passes.iter().enumerate() {
        let frame = Frame {
            width: pass.width(),
            height: pass.height(),
            color: Some(pass.clone()),
            ..Frame::default()
        };
        let png = Picture { color_space: rendered.color_space, ..frame.into() }
            .encode(PictureFormat::Png)?;
        let (name, what) = (format!("9-pass-{number:02}.png"), format!("after pass {number}"));
        write(&name, &png)?;
        listed.push(Listed { name, what });
    }
    Ok(())
}

/// Whether transparent surfaces are kept in a list and a buffer of their own.
fn has_list(settings: &Settings) -> bool {
    settings.transparency.order == TransparencyOrder::TWO_BUFFER
}

/// Whether the picture is made in passes.
fn has_passes(settings: &Settings) -> bool {
    let mut asked = settings.clone();
    asked.picture.channels.passes = true;
    asked.check().is_ok()
}

/// As [`dump`], into a folder, which is made if it is not there.
///
/// # Errors
/// As [`dump`]; [`Error::Write`].
pub fn dump_to_folder(
    renderer: &mut Renderer,
    camera: &Camera,
    folder: impl AsRef<Path>,
) -> Result<(), Error> {
    let folder = folder.as_ref();
    std::fs::create_dir_all(folder)
        .map_err(|source| Error::Write { path: folder.to_owned(), source })?;
    dump(renderer, camera, |name, bytes| picture::write(folder.join(name), bytes))
}

fn index(settings: &Settings, of_samples: &[Listed], of_picture: &[Listed]) -> String {
    let list = |files: &[Listed]| {
        files
            .iter()
            .map(|Listed { name, what }| format!("   - [{what}]({name})\n"))
            .collect::<String>()
    };
    format!(
        "# The pipeline, stage by stage\n\n\
         1. [Scene graph](1-scene.json)\n\
         2. [Model transform](2-world.json): instances in world space\n\
         3. [Culling](3-cull.json): what is left of them\n\
         4. Illumination: [the lights in view space](4-lights.json), and what they make of [the facets' \
         corners](4-illuminated.csv), world space and premultiplied colours; pictures illuminate what is seen, after stage 8\n\
         5. [View transform](5-view.json): the camera and its matrices, [the corners](5-view.csv) in view space\n\
         6. [Clipping](6-clip.csv): polygons in clip space, before the division by w\n\
         7. [Projection](7-project.csv): facets on the screen, in pixels from the top left; depth is 1 near, 0 far\n\
         8. Rasterising ({}): surface ids ([numbers](8-surface.npy), [colours](8-surface.png)) and [depth](8-depth.npy) \
         at pixel centres\n{}\
         9. [Frame buffer](9-framebuffer.png): {} x {} pixels, {} samples each\n{}",
        settings.visibility,
        list(of_samples),
        settings.picture.width,
        settings.picture.height,
        settings.picture.samples,
        list(of_picture)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColorSpace, EncodeOptions, Scene, load_builtin};
    use serde_json::json;
    use std::collections::{BTreeMap, BTreeSet};
    use vitral_math::DVec3;

    fn dumped(renderer: &mut Renderer) -> BTreeMap<String, Vec<u8>> {
        let mut files = BTreeMap::new();
        let (camera, before) = (renderer.frame_camera(), renderer.settings.clone());
        dump(renderer, &camera, |name, bytes| {
            files.insert(name.to_owned(), bytes.to_vec());
            Ok(())
        })
        .unwrap();
        assert!(renderer.settings == before, "the settings are as before");
        let index = std::str::from_utf8(&files["index.md"]).unwrap();
        for name in files.keys().filter(|n| *n != "index.md") {
            assert!(index.contains(&format!("({name})")), "{name} is in the index");
        }
        files
    }

    fn small(name: &str) -> Renderer {
        let mut renderer = Renderer::new(load_builtin(name).unwrap()).unwrap();
        (
            renderer.settings.picture.width,
            renderer.settings.picture.height,
            renderer.settings.picture.samples,
        ) = (64, 48, 1);
        renderer
    }

    /// The fields of a table's rows.
    fn table(files: &BTreeMap<String, Vec<u8>>, name: &str) -> Vec<Vec<String>> {
        let text = std::str::from_utf8(&files[name]).unwrap();
        text.lines().skip(1).map(|l| l.split(',').map(str::to_owned).collect()).collect()
    }

    fn facets_of(table: &[Vec<String>]) -> BTreeSet<&str> {
        table.iter().map(|row| row[0].as_str()).collect()
    }

    #[test]
    fn p1_every_stage_is_exported() {
        let files = dumped(&mut small("cubs"));
        let names = "1-scene.json 2-world.json 3-cull.json 4-illuminated.csv 4-lights.json 5-view.csv 5-view.json \
                     6-clip.csv 7-project.csv 8-depth.npy 8-surface.npy 8-surface.png 9-framebuffer.png index.md";
        assert_eq!(files.keys().map(String::as_str).collect::<Vec<_>>().join(" "), names);
        let json = |name: &str| serde_json::from_slice::<Value>(&files[name]).unwrap();
        assert_eq!(json("1-scene.json")["meshes"].as_array().unwrap().len(), 8);
        assert_eq!(json("2-world.json")["facets"], 96);
        assert_eq!(json("3-cull.json")["kept"].as_array().unwrap().len(), 8);
        assert_eq!(json("4-lights.json")["view-space"].as_array().unwrap().len(), 2);
        assert_eq!(json("5-view.json")["clip-from-view"][3], json!([0.0, 0.0, -1.0, 0.0]));
        let facets = table(&files, "7-project.csv").len();
        assert!(
            (16..=48).contains(&facets),
            "back faces are gone, three faces of a cube are seen at most: {facets}"
        );
    }

    #[test]
    fn p1_counts_of_the_stages_are_those_of_the_statistics() {
        // One from afar, one from amidst it, so that the near plane cuts.
        for near in [false, true] {
            let mut renderer = small("cornell");
            let framed = renderer.frame_camera();
            let position = if near {
                framed.focal_point + DVec3::new(0.01, 0.02, 0.0)
            } else {
                framed.position
            };
            let focal_point = if near { framed.focal_point - DVec3::Z } else { framed.focal_point };
            renderer.camera = Some(Camera { position, focal_point, ..framed });
            let files = dumped(&mut renderer);
            let stats = renderer.render().unwrap().stats;
            let (cull, geometry) = (stats.cull, stats.geometry);
            let kept = cull.triangles - cull.triangles_culled;
            assert_eq!(kept, geometry.triangles);
            for name in ["4-illuminated.csv", "5-view.csv"] {
                assert_eq!(table(&files, name).len() as u64, 3 * kept, "{name}");
            }
            let (clip, project) = (table(&files, "6-clip.csv"), table(&files, "7-project.csv"));
            let left = facets_of(&clip);
            assert_eq!(left.len() as u64, kept - geometry.outside - geometry.not_finite);
            let cut: Vec<_> = clip.iter().filter(|row| row[2] == "1").cloned().collect();
            assert!(
                facets_of(&cut).len() as u64 <= geometry.clipped && (geometry.clipped > 0) == near
            );
            assert_eq!(cut.is_empty(), !near);
            // What was cut begins before the division: every corner is before the eye and between
            // near and far.
            let number = |row: &[String], at: usize| row[at].parse::<f64>().unwrap();
            assert!(cut.iter().all(|row| {
                let [z, w] = [number(row, 6), number(row, 7)];
                w > 0.0 && z >= -1e-5 * w && z <= w * 1.00001
            }));
            assert_eq!(project.len() as u64, geometry.set_up);
            assert!(facets_of(&project).is_subset(&left));
            let gone = geometry.back_facing + geometry.degenerate + geometry.no_sample;
            assert!(facets_of(&project).len() as u64 >= left.len() as u64 - gone);
        }
    }

    #[test]
    fn p1_the_stages_follow_from_each_other() {
        let mut renderer = small("cubs");
        let files = dumped(&mut renderer);
        let view =
            renderer.prepared(&renderer.frame_camera(), &mut CullCounters::default()).unwrap();
        let (world, seen) = (table(&files, "4-illuminated.csv"), table(&files, "5-view.csv"));
        let clip = table(&files, "6-clip.csv");
        let numbers =
            |row: &[String], from: usize| [0, 1, 2].map(|k| row[from + k].parse::<f64>().unwrap());
        for (row, in_view) in world.iter().zip(&seen) {
            assert_eq!(row[..2], in_view[..2]);
            let (at, expected) = (DVec3::from(numbers(row, 2)), DVec3::from(numbers(in_view, 2)));
            let placed = view.view.view_from_world.transform_point3(at);
            assert!(placed.distance(expected) < 1e-9);
            // Nothing of the cubes is cut: clip space has the same corners.
            let projected = view.view.clip_from_view * placed.extend(1.0);
            if let Some(clipped) = clip.iter().find(|c| c[0] == row[0] && c[3] == row[1]) {
                let clipped = DVec3::from(numbers(clipped, 4));
                assert!(clipped.distance(projected.truncate()) < 1e-4 * projected.length());
            }
        }
    }

    #[test]
    fn p1_l8_corners_are_illuminated_by_the_formula() {
        let mut renderer = small("cubs");
        renderer.settings.picture.color_space = ColorSpace::Raw;
        renderer.settings.shading.illumination = vitral_light::Illumination::Lambert;
        let material = vitral_light::Material::default();
        let vitral_light::Reflectance::Phong { kd, .. } = material.reflectance else {
            panic!("{material:?}")
        };
        let mut scene = Scene::clone(renderer.scene());
        scene.materials.iter_mut().for_each(|m| *m = material.clone());
        renderer.set_scene(scene).unwrap();
        let direction = DVec3::new(-1.0, -2.0, -3.0).normalize();
        let kind = vitral_light::LightKind::Directional { direction };
        renderer.lights =
            Some(vec![vitral_light::Light { kind, ..vitral_light::Light::default() }]);
        let files = dumped(&mut renderer);
        let rows = table(&files, "4-illuminated.csv");
        let numbers =
            |row: &[String], from: usize| [0, 1, 2].map(|k| row[from + k].parse::<f64>().unwrap());
        let mut lit = 0;
        for triangle in rows.chunks(3) {
            let [a, b, c] = [0, 1, 2].map(|i| DVec3::from(numbers(&triangle[i], 2)));
            let cos = (b - a).cross(c - a).normalize().dot(-direction).max(0.0);
            lit += usize::from(cos > 0.0);
            for row in triangle {
                let color = numbers(row, 5);
                assert!(
                    (0..3).all(|k| (color[k] - f64::from(kd[k]) * cos).abs() < 1e-5),
                    "{row:?}, cosine {cos}"
                );
            }
        }
        assert!(lit > 0);
    }

    #[test]
    fn f7_both_buffers_are_exported() {
        let mut renderer = small("lens");
        renderer.settings.transparency.order = TransparencyOrder::TWO_BUFFER;
        let files = dumped(&mut renderer);
        let picture = renderer.render().unwrap().frame;
        let encoded = picture::encode_with(
            &picture,
            Channel::Color,
            PictureFormat::Png,
            &EncodeOptions { srgb: true, ..EncodeOptions::default() },
        );
        assert!(
            files["9-combined.png"] == encoded.unwrap()
                && files["9-combined.png"] == files["9-framebuffer.png"]
        );
        let list = table(&files, "9-transparent.csv");
        assert!(!list.is_empty() && list.iter().all(|row| row[2] == "\"glass\""));
        for name in [
            "opaque.png",
            "opaque.npy",
            "opaque-depth.npy",
            "transparent-layers.npy",
            "transparent-k.png",
        ] {
            assert!(files.contains_key(&format!("9-{name}")), "{name}");
        }
    }
}
