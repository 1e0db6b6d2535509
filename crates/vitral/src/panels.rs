//! The notes' figures of an algorithm for shadows: six pictures, three in a row, on one sheet.
//!
//! In image space (`--shadows map`), after the figure from Columbia University: the whole scene
//! with light and viewer; the z-buffer from the light, in no more texels than a map has; the
//! z-buffer from the viewer; the picture without shadows; the finished picture darkened where
//! shadow falls, highlights and all; the picture whose illumination knows the shadows.
//!
//! At object precision (`--shadows object-precision`), after the figure from Cornell University:
//! the whole scene with light and viewer; what the light sees; the lit polygons as the light sees
//! them, the same outlines; the lit polygons as the viewer sees them; the picture without shadows;
//! the picture with them.

use crate::{Error, Picture, Renderer};
use vitral_frame::{Frame, Plane};
use vitral_light::{Light, LightKind, Material, Reflectance};
use vitral_math::{DMat4, DQuat, DVec3};
use vitral_render::catalogue::Panels;
use vitral_render::{Channels, Lines, Settings, SettingsError, Shadows, registry, shadow};
use vitral_scene::builtin::solids;
use vitral_scene::{Camera, Faces, Lens, Mesh, Part, Projection, Scene, framing};

/// Pixels between two panels.
const GAP: usize = 4;
/// What is left of a colour where shadow falls, if the picture is darkened afterwards.
const DARKENED: f32 = 0.5;

type Colors = Plane<[u8; 4]>;

/// The panels of `renderer`'s shadow algorithm, seen by `camera`; each has the size of a picture.
/// Light and shadow are those of the first light that casts shadows.
///
/// # Errors
/// Shadows without panels, a scene without such a light, and whatever ends a picture.
pub fn panels(renderer: &mut Renderer, camera: &Camera) -> Result<Picture, Error> {
    let settings = renderer.settings.clone();
    let shadows = settings.shadows.algorithm;
    let Some(sequence) = shadows.panels else {
        let error =
            SettingsError::Panels { shadows, choices: Shadows::names(|row| row.panels.is_some()) };
        return Err(vitral_render::Error::from(error).into());
    };
    let lights = renderer.frame_lights(camera);
    let number = lights.iter().position(|l| l.kind != LightKind::Ambient && l.shadow);
    let Some(number) = number else {
        return Err(Error::usage(
            "no light casts shadows",
            "add one: --light directional:direction=0,-1,-1",
        ));
    };
    let from_light = light_camera(renderer, &lights[number]);
    let overview = overview(renderer, camera, &lights, &from_light)?;
    let result = six(renderer, sequence, [camera, &from_light], (&lights, number), overview);
    renderer.settings = settings;
    result
}

fn six(
    renderer: &mut Renderer,
    sequence: Panels,
    [camera, from_light]: [&Camera; 2],
    (lights, number): (&[Light], usize),
    overview: Colors,
) -> Result<Picture, Error> {
    // Take the settings over, with one light and without the user's edits.
    let with = renderer.settings.clone();
    let own_lights = renderer.lights.replace(lights.to_vec());
    let edits = std::mem::take(&mut renderer.light_edits);
    let intensity = renderer.light_intensity.replace(1.0);
    let without = with.clone().with_shadows(Shadows::NONE);

    // Render the panels; the sequence chooses the middle four.
    let made = || {
        let mut shot = |settings: &Settings, camera: &Camera| {
            renderer.settings = settings.clone();
            renderer.render_from(camera)
        };
        let mut shadowed = shot(&with, camera)?;
        let plain = color(shot(&without, camera)?);
        let rest = match sequence {
            Panels::ImageSpace => {
                let depth = Channels { depth: true, color: false, ..Channels::default() };
                let depths = without.with_channels(depth);
                let cast = Channels { cast_shadow: true, color: false, ..Channels::default() };
                let mask =
                    shot(&with.with_channels(cast), camera)?.frame.cast_shadow.unwrap_or_default();
                let [light, viewer] =
                    [shot(&texels(&depths), from_light)?, shot(&depths, camera)?].map(grey);
                let light = enlarged(&light, [viewer.width(), viewer.height()]);
                let darkened = darkened(&plain, &mask);
                [light, viewer, plain, darkened]
            }
            Panels::ObjectPrecision => {
                let seen = color(shot(&without, from_light)?);
                renderer.settings = with.clone();
                let mut lit = lit_scene(renderer, number)?;
                lit.settings = without;
                let [light, viewer] =
                    [color(lit.render_from(from_light)?), color(lit.render_from(camera)?)];
                [seen, light, viewer, plain]
            }
        };
        let last = shadowed.frame.color.take().unwrap_or_default();
        let [b, c, d, e] = &rest;
        shadowed.frame = sheet([&overview, b, c, d, e, &last]);
        Ok(shadowed)
    };

    // Restore the renderer, even after an error.
    let made = made();
    renderer.lights = own_lights;
    renderer.light_edits = edits;
    renderer.light_intensity = intensity;
    made
}

fn color(rendered: Picture) -> Colors {
    rendered.frame.color.unwrap_or_default()
}

/// A z-buffer as greys: the nearest depth white, the farthest dark, nothing black.
fn grey(rendered: Picture) -> Colors {
    let depth = rendered.frame.depth.unwrap_or_default();
    let seen = depth.data().iter().copied().filter(|&z| z > 0.0);
    let (low, high) =
        seen.fold((f32::INFINITY, 0.0f32), |(low, high), z| (low.min(z), high.max(z)));
    let range = (high - low).max(f32::MIN_POSITIVE);
    let shade = |&z: &f32| {
        let v = if z > 0.0 { (40.5 + 215.0 * (z - low) / range) as u8 } else { 0 };
        [v, v, v, 255]
    };
    Plane::from_rows(depth.width(), depth.height(), depth.data().iter().map(shade).collect())
        .unwrap_or_default()
}

/// Settings for a picture with no more pixels along its longer side than a shadow map has texels.
fn texels(settings: &Settings) -> Settings {
    let longer = u64::from(settings.picture.width.max(settings.picture.height));
    let most = longer.min(u64::from(settings.shadows.map_size));
    let [width, height] = [settings.picture.width, settings.picture.height]
        .map(|s| (u64::from(s) * most / longer).max(1) as u32);
    settings.clone().with_size(width, height)
}

/// The picture in another size, each pixel as the nearest is.
fn enlarged(picture: &Colors, [width, height]: [u32; 2]) -> Colors {
    let from =
        |i: u32, size: u32, of: u32| (u64::from(i) * u64::from(of) / u64::from(size.max(1))) as u32;
    let column = |x: u32, y: u32| {
        *picture.at(from(x, width, picture.width()), from(y, height, picture.height()))
    };
    let all = (0..height).flat_map(|y| (0..width).map(move |x| column(x, y)));
    Plane::from_rows(width, height, all.collect()).unwrap_or_default()
}

/// The picture, darkened by the mask after it was illuminated.
fn darkened(picture: &Colors, mask: &Plane<f32>) -> Colors {
    let mut darkened = picture.clone();
    for (pixel, cast) in darkened.data_mut().iter_mut().zip(mask.data()) {
        let keep = 1.0 - cast * (1.0 - DARKENED);
        pixel[..3].iter_mut().for_each(|c| *c = (f32::from(*c) * keep + 0.5) as u8);
    }
    darkened
}

/// Six pictures of one size, three in a row.
fn sheet(panels: [&Colors; 6]) -> Frame {
    let (width, height) = (panels[0].width() as usize, panels[0].height() as usize);
    let size = [3 * width + 2 * GAP, 2 * height + GAP].map(|s| s as u32);
    let mut all = Plane::filled(size[0], size[1], [255; 4]);
    for (i, panel) in panels.into_iter().enumerate() {
        let (x, y) = (i % 3 * (width + GAP), i / 3 * (height + GAP));
        for (row, from) in panel.data().chunks(width.max(1)).enumerate() {
            let start = (y + row) * size[0] as usize + x;
            all.data_mut()[start..start + width].copy_from_slice(from);
        }
    }
    Frame { width: size[0], height: size[1], color: Some(all), ..Frame::default() }
}

/// A camera at the light that sees the scene.
fn light_camera(renderer: &Renderer, light: &Light) -> Camera {
    let bounds = renderer.world().bounds;
    let (center, radius) = (bounds.center(), (bounds.diagonal() * 0.5).max(f64::MIN_POSITIVE));
    let up_for = |way: DVec3| {
        let up = renderer.up.vector();
        if way.normalize_or_zero().cross(up).length() > 0.1 {
            up
        } else {
            up.any_orthogonal_vector()
        }
    };
    let at = |position: DVec3, way: DVec3, view_angle: f64| Camera {
        position,
        focal_point: position + way,
        view_up: up_for(way),
        projection: Projection::Perspective { view_angle },
        clip: None,
    };
    let around = |position: DVec3| {
        let way = center - position;
        let way = if way == DVec3::ZERO { -renderer.up.vector() } else { way };
        at(
            position,
            way,
            (2.2 * vitral_math::func::asin((radius / way.length()).min(1.0))).min(2.6),
        )
    };
    match &light.kind {
        LightKind::Directional { direction } => {
            let (eye, aspect) = (-*direction, renderer.aspect());
            framing::frame_from(&bounds, eye, up_for(eye), Lens::Parallel, aspect, framing::FILL)
        }
        LightKind::Spot { position, direction, cutoff, .. } => {
            at(*position, *direction, (2.0 * cutoff).min(2.6))
        }
        LightKind::Point { position } => around(*position),
        LightKind::Area { shape } => around(shape.middle()),
        LightKind::Ambient => around(center),
    }
}

/// The whole scene with a ball for the light and a cone for the viewer, its tip where the viewer
/// is.
fn overview(
    renderer: &Renderer,
    viewer: &Camera,
    lights: &[Light],
    light: &Camera,
) -> Result<Colors, Error> {
    let mut scene = Scene::clone(renderer.scene());
    let size = renderer.world().bounds.diagonal().max(f64::MIN_POSITIVE) * 0.05;
    let mut mark = |mut mesh: Mesh, emission: [f32; 3], transform: DMat4| {
        let reflectance =
            Reflectance::Phong { ka: [0.0; 3], kd: [0.0; 3], ks: [0.0; 3], shininess: 1.0 };
        let material =
            scene.add_material(Material { reflectance, emission, ..Material::default() });
        mesh.parts.iter_mut().for_each(|part| part.material = Some(material));
        scene.add_mesh(mesh, transform);
    };
    let turned = |camera: &Camera| {
        let back = (camera.position - camera.focal_point).normalize_or(DVec3::Y);
        DMat4::from_rotation_translation(DQuat::from_rotation_arc(DVec3::Y, back), camera.position)
    };
    mark(solids::sphere(size, 24, 12), [1.0, 0.85, 0.1], DMat4::from_translation(light.position));
    // The cone's tip is up.
    let tip = DMat4::from_translation(DVec3::Y * -2.0 * size);
    mark(solids::cone(size, 2.0 * size, 24), [0.1, 0.4, 0.9], turned(viewer) * tip);
    let mut whole = Renderer::with_execution(scene, renderer.execution().clone())?;
    whole.settings = renderer.settings.clone().with_shadows(Shadows::NONE).with_lines(Lines::None);
    whole.lights = Some(lights.to_vec());
    whole.ambient = renderer.ambient;
    // From beside the viewer, so that the cone hides nothing.
    let (up, back) =
        (renderer.up.vector(), (viewer.position - viewer.focal_point).normalize_or(DVec3::Z));
    let side = up.cross(back).try_normalize().unwrap_or_else(|| up.any_orthonormal_vector());
    let eye = side + back * 0.3 + up * 0.4;
    let seen = framing::frame_from(
        &whole.world().bounds,
        eye,
        up,
        Lens::default(),
        renderer.aspect(),
        framing::FILL,
    );
    Ok(color(whole.render_from(&seen)?))
}

/// The lit polygons of one of the lights, white.
fn lit_scene(renderer: &Renderer, number: usize) -> Result<Renderer, Error> {
    let lights = renderer.lights.clone().unwrap_or_default();
    let mut mesh = Mesh { name: "lit".to_owned(), ..Mesh::default() };
    let (mut starts, mut corners) = (vec![0], Vec::new());
    let (session, settings) = (renderer.session(), &renderer.settings);
    let algorithm = registry::shadows(settings.shadows.algorithm);
    let drawn =
        shadow::draw(algorithm, session, &lights, settings, renderer.execution(), &mut |polygon| {
            if polygon.light == number {
                let first = mesh.positions.len() as u32;
                mesh.positions.extend(polygon.corners.iter().map(|c| c.as_vec3().to_array()));
                let count = polygon.corners.len() as u32;
                mesh.triangles.extend((2..count).map(|i| [first, first + i - 1, first + i]));
                corners.extend(first..first + count);
                starts.push(corners.len() as u32);
            }
            let triples = mesh.positions.len() + mesh.triangles.len();
            (12 * triples + 4 * (corners.len() + starts.len())) as u64
        });
    drawn.map_err(vitral_render::Error::from)?;
    mesh.faces = Faces::Polygons { starts, corners };
    let mut scene = Scene::default();
    let material = scene.add_material(Material { double_sided: true, ..Material::default() });
    mesh.parts = vec![Part {
        name: String::new(),
        triangles: 0..mesh.triangles.len() as u32,
        material: Some(material),
    }];
    scene.add_mesh(mesh, DMat4::IDENTITY);
    let mut lit = Renderer::with_execution(scene, renderer.execution().clone())?;
    lit.lights = Some(lights);
    lit.ambient = [0, 1, 2].map(|k| renderer.ambient[k] + renderer.scene().ambient[k]);
    Ok(lit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load_builtin;
    use vitral_light::Illumination;
    use vitral_render::ColorSpace;

    fn panel(frame: &Frame, number: usize, size: [u32; 2]) -> Vec<[u8; 4]> {
        let gap = GAP as u32;
        let (x, y) = (number as u32 % 3 * (size[0] + gap), number as u32 / 3 * (size[1] + gap));
        let color = frame.color.as_ref().unwrap();
        (0..size[1])
            .flat_map(|row| (0..size[0]).map(move |c| (x + c, y + row)))
            .map(|(x, y)| *color.at(x, y))
            .collect()
    }

    fn of(shadows: &str) -> (Frame, [u32; 2]) {
        let mut renderer = Renderer::new(load_builtin("scene0").unwrap()).unwrap();
        let size = [96, 72];
        (
            renderer.settings.picture.width,
            renderer.settings.picture.height,
            renderer.settings.picture.samples,
        ) = (size[0], size[1], 1);
        renderer.settings.shadows.algorithm = shadows.parse().unwrap();
        let before = renderer.settings.clone();
        let camera = renderer.frame_camera();
        let frame = panels(&mut renderer, &camera).unwrap().frame;
        assert!(
            renderer.settings == before && renderer.lights.is_none(),
            "nothing of the renderer changes"
        );
        assert_eq!([frame.width, frame.height], [3 * size[0] + 8, 2 * size[1] + 4]);
        (frame, size)
    }

    #[test]
    fn f25_shadow_after_illumination_differs_from_shadow_in_it_only_where_shadow_falls() {
        let (frame, size) = of("map");
        let [overview, light, viewer, plain, darkened, shadowed] =
            std::array::from_fn(|i| panel(&frame, i, size));
        assert_ne!(overview, plain, "light and viewer are in it");
        assert!(
            light.iter().any(|p| p[0] == 255)
                && viewer.iter().any(|p| p[0] == 255)
                && light != viewer
        );
        let mut dark = 0;
        for i in 0..plain.len() {
            if darkened[i] == plain[i] {
                // A trace of shadow may round to nothing.
                let apart = (0..4).map(|k| shadowed[i][k].abs_diff(plain[i][k])).max();
                assert!(
                    apart <= Some(1),
                    "lit places are the same: {:?} {:?}",
                    shadowed[i],
                    plain[i]
                );
            } else {
                dark += 1;
                // Ambient light is left, and nothing gets lighter.
                assert!((0..3).all(|k| shadowed[i][k] <= plain[i][k]) && shadowed[i][0] > 0);
            }
        }
        assert!(dark > plain.len() / 50, "{dark} pixels in shadow");
    }

    #[test]
    fn f25_each_of_the_six_panels_shows_what_it_is_to_show() {
        let lamp = Light {
            kind: LightKind::Point { position: DVec3::new(2.5, 4.0, 2.0) },
            ambient: [0.2; 3],
            ..Light::default()
        };
        let size = [96, 72];
        let fresh = |lights: &[Light], shadows: &str| {
            let mut renderer = Renderer::new(load_builtin("scene0").unwrap()).unwrap();
            (
                renderer.settings.picture.width,
                renderer.settings.picture.height,
                renderer.settings.picture.samples,
            ) = (size[0], size[1], 1);
            (renderer.settings.shadows.algorithm, renderer.settings.picture.color_space) =
                (shadows.parse().unwrap(), ColorSpace::Raw);
            renderer.settings.shading.illumination = Illumination::Phong;
            (renderer.lights, renderer.light_intensity) = (Some(lights.to_vec()), Some(1.0));
            renderer
        };
        let lights = [lamp.clone()];
        let camera = fresh(&lights, "map").frame_camera();
        let sheet = panels(&mut fresh(&lights, "map"), &camera).unwrap().frame;
        let [a, b, c, d, e, f] = std::array::from_fn(|i| panel(&sheet, i, size));
        let picture = |lights: &[Light], shadows: &str| {
            color(fresh(lights, shadows).render_from(&camera).unwrap()).into_data()
        };
        let depths = |from: &Camera| {
            let mut renderer = fresh(&lights, "none");
            renderer.settings.picture.channels =
                Channels { depth: true, color: false, ..Channels::default() };
            renderer.render_from(from).unwrap().frame.depth.unwrap().into_data()
        };

        // a: both marks are in it, yellow for the light and blue for the viewer, and nowhere else.
        let yellow = |p: &&[u8; 4]| p[0] > 200 && p[1] > 150 && p[2] < 90;
        let blue = |p: &&[u8; 4]| p[2] > 150 && p[0] < 90;
        for marked in [a.iter().filter(yellow).count(), a.iter().filter(blue).count()] {
            assert!((4..a.len() / 5).contains(&marked), "{marked}");
        }
        // b and c: the nearer the lighter, black where nothing is; from the light and from the
        // viewer.
        let from_light = light_camera(&fresh(&lights, "none"), &lamp);
        for (greys, from) in [(&b, &from_light), (&c, &camera)] {
            let depths = depths(from);
            let mut pairs: Vec<_> =
                depths.iter().zip(greys).map(|(depth, grey)| (*depth, grey[0])).collect();
            pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
            assert!(pairs.windows(2).all(|w| w[0].1 <= w[1].1), "grey goes with depth");
            assert!(pairs.iter().all(|(depth, grey)| (*depth == 0.0) == (*grey == 0)));
            assert!(pairs.last().unwrap().1 == 255 && pairs.iter().any(|p| (1..80).contains(&p.1)));
            assert!(greys.iter().all(|p| p[0] == p[1] && p[1] == p[2]));
        }
        // d and f: the picture without and with shadows.
        assert!(d == picture(&lights, "none") && f == picture(&lights, "map"));
        // e: d, a share of it where shadow falls. f: there nothing but ambient light is left, no
        // highlight; e keeps a part of it.
        let ambient = Light { diffuse: [0.0; 3], specular: [0.0; 3], ..lamp };
        let ambient = picture(&[ambient], "none");
        let mut mask = fresh(&lights, "map");
        mask.settings.picture.channels =
            Channels { color: false, cast_shadow: true, ..Channels::default() };
        let mask = mask.render_from(&camera).unwrap().frame.cast_shadow.unwrap().into_data();
        let (mut shadow, mut brighter) = (0, 0);
        for i in 0..d.len() {
            if mask[i] == 0.0 {
                assert_eq!((e[i], f[i]), (d[i], d[i]), "pixel {i} is lit");
            } else if mask[i] == 1.0 {
                shadow += 1;
                let share = [0, 1, 2].map(|k| (f32::from(d[i][k]) * DARKENED + 0.5) as u8);
                assert_eq!([e[i][0], e[i][1], e[i][2]], share, "pixel {i} is darkened");
                assert!(
                    (0..3).all(|k| f[i][k].abs_diff(ambient[i][k]) <= 1),
                    "{:?} {:?}",
                    f[i],
                    ambient[i]
                );
                brighter += usize::from((0..3).any(|k| e[i][k] != f[i][k]));
            }
        }
        assert!(
            shadow > d.len() / 100 && brighter * 2 > shadow,
            "{shadow} in shadow, {brighter} differ"
        );
    }

    #[test]
    fn f25_panels_show_the_size_of_the_map() {
        let mut renderer = Renderer::new(load_builtin("scene0").unwrap()).unwrap();
        (
            renderer.settings.picture.width,
            renderer.settings.picture.height,
            renderer.settings.picture.samples,
        ) = (96, 72, 1);
        renderer.settings.shadows.algorithm = Shadows::MAP;
        renderer.settings.shadows.map_size = 16;
        let camera = renderer.frame_camera();
        let coarse = panels(&mut renderer, &camera).unwrap().frame;
        let (fine, size) = of("map");
        // Sixteen texels in a row of 96: six pixels each.
        let row = panel(&coarse, 1, size);
        assert!(
            row.chunks(96)
                .all(|row| row.chunks(6).all(|texel| texel.iter().all(|p| *p == texel[0])))
        );
        assert!(row != panel(&fine, 1, size) && panel(&coarse, 5, size) != panel(&fine, 5, size));
        assert!([2, 3].into_iter().all(|i| panel(&coarse, i, size) == panel(&fine, i, size)));
    }

    #[test]
    fn f24_lit_polygons_are_what_the_light_sees() {
        let (frame, size) = of("object-precision");
        let [_, seen, lit, from_viewer, plain, shadowed] =
            std::array::from_fn(|i| panel(&frame, i, size));
        // The background is where nothing is: the outlines are the same but for a few pixels of
        // borders.
        let background =
            |p: &[u8; 4], row: usize, other: &[[u8; 4]]| *p == other[row * size[0] as usize];
        let differing = (0..seen.len()).filter(|&i| {
            let row = i / size[0] as usize;
            background(&seen[i], row, &seen) != background(&lit[i], row, &lit)
        });
        assert!(differing.count() < seen.len() / 100);
        assert!(from_viewer != plain && plain != shadowed);
    }

    #[test]
    fn shadows_without_panels_are_refused() {
        let mut renderer = Renderer::new(load_builtin("scene0").unwrap()).unwrap();
        let camera = renderer.frame_camera();
        let error = panels(&mut renderer, &camera).unwrap_err();
        assert!(error.to_string().contains("map, object-precision"), "{error}");
        renderer.settings.shadows.algorithm = Shadows::MAP;
        renderer.lights = Some(Vec::new());
        assert!(matches!(panels(&mut renderer, &camera), Err(Error::Usage { .. })));
    }
}
