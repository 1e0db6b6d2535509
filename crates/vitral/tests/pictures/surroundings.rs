//! What surrounds a model: an image that metals mirror, what is near and weakens ambient light, and
//! the shadow on the ground.

use super::common::{colors, limit, one, settings_error};
use std::sync::Arc;
use vitral::internals::light::Panorama;
use vitral::{
    Axis, Background, DMat4, DVec3, Environment, EnvironmentMap, Global, GroundShadow, Light,
    LightKind, Limit, Material, Reflectance, Renderer, Scene, SettingsError, Shadows, View,
    Visibility, load_builtin, solids,
};

/// An image whose red is up, whose green is down, and whose blue is on the right; all are 0 to 1.
fn colored() -> Arc<EnvironmentMap> {
    let (width, height) = (256, 128);
    let texel = |i: usize| {
        let (u, v) = ((i % width) as f32 / width as f32, (i / width) as f32 / height as f32);
        let right = if (0.5..1.0).contains(&u) { 0.5 } else { 0.0 };
        if v < 0.5 { [1.0, 0.0, right] } else { [0.0, 1.0, right] }
    };
    let panorama = Panorama::new(width, height, (0..width * height).map(texel).collect()).unwrap();
    Arc::new(EnvironmentMap::new(panorama, [width, height]))
}

fn metal(metallic: f32, roughness: f32) -> Material {
    Material {
        reflectance: Reflectance::MetallicRoughness { base_color: [0.9; 3], metallic, roughness },
        ..Material::default()
    }
}

/// A small picture of a scene from the front, without background.
fn front(scene: Scene) -> Renderer {
    let mut renderer = Renderer::new(scene).unwrap();
    (renderer.settings.picture.width, renderer.settings.picture.height) = (64, 64);
    renderer.settings.picture.background = Background::Transparent;
    renderer.view = View::Front;
    renderer
}

/// A ball without lights, in the coloured image.
fn ball(material: Material) -> Renderer {
    let mut renderer = front(one(solids::sphere(1.0, 64, 32), material));
    renderer.lights = Some(Vec::new());
    renderer.environment_image = Some(colored());
    renderer
}

fn at(pixels: &[[u8; 4]], x: usize, y: usize) -> [u8; 4] {
    pixels[y * 64 + x]
}

#[test]
fn a_mirror_shows_the_image_upright() {
    let pixels = colors(&mut ball(metal(1.0, 0.0)));
    // The ball's normal halfway to the border turns the sight by 90 degrees: up, down, and to the
    // sides.
    let [up, down] = [at(&pixels, 32, 16), at(&pixels, 32, 48)];
    assert!(up[0] > 200 && up[1] < 20 && down[0] < 20 && down[1] > 200, "{up:?} {down:?}");
    let [left, right] = [at(&pixels, 15, 28), at(&pixels, 49, 28)];
    assert!(left[2] < 20 && right[2] > 150, "{left:?} {right:?}");
    // The image stands on the model's ground, and does not turn with the camera.
    let mut turned = ball(metal(1.0, 0.0));
    turned.up = Axis::PlusZ;
    let close = |a: &[u8; 4], b: &[u8; 4]| (0..4).all(|k| a[k].abs_diff(b[k]) <= 40);
    let differ = colors(&mut turned).iter().zip(&pixels).filter(|(a, b)| !close(a, b)).count();
    assert!(differ < 64 * 64 / 20, "{differ} pixels, where facets meet the steps of the image");
    turned.view = View::Back;
    assert!(at(&colors(&mut turned), 15, 28)[2] > 150, "seen from behind, right is left");
}

#[test]
fn roughness_blurs_the_image_and_matt_surfaces_gather_it() {
    let spread =
        |pixels: &[[u8; 4]]| i32::from(at(pixels, 32, 26)[0]) - i32::from(at(pixels, 32, 38)[0]);
    let of = |metallic: f32, roughness: f32| spread(&colors(&mut ball(metal(metallic, roughness))));
    let (mirror, brushed, matt) = (of(1.0, 0.0), of(1.0, 0.5), of(0.0, 1.0));
    assert!(
        mirror > 200 && brushed < mirror - 40 && matt < brushed && matt > 5,
        "{mirror} {brushed} {matt}"
    );
    // A floor under half a sphere of red light gets all of it: 0.9 of 1.
    let mut floor = front(one(solids::cuboid(DVec3::new(4.0, 0.1, 4.0)), metal(0.0, 1.0)));
    (floor.lights, floor.environment_image, floor.view) =
        (Some(Vec::new()), Some(colored()), View::Top);
    let [r, g, ..] = at(&colors(&mut floor), 32, 32);
    assert!((235..=255).contains(&r) && g < 90, "{r} {g}");
}

#[test]
fn every_visibility_algorithm_mirrors_the_same_image() {
    let picture = |visibility| {
        let mut renderer = ball(metal(0.8, 0.3));
        renderer.settings.visibility = visibility;
        colors(&mut renderer)
    };
    let expected = picture(Visibility::Z_BUFFER);
    for visibility in [
        Visibility::SCAN_LINE,
        Visibility::WARNOCK,
        Visibility::PAINTER,
        Visibility::BSP,
        Visibility::RAY_CAST,
    ] {
        let other = picture(visibility);
        let differ = expected.iter().zip(&other).filter(|(a, b)| a != b).count();
        assert!(differ <= 4, "{visibility}: {differ}");
    }
}

#[test]
fn rays_see_the_image_beyond_the_scene() {
    let mut traced = ball(metal(1.0, 0.0));
    traced.settings.global.model = Global::RayTrace;
    let (traced, looked_up) = (colors(&mut traced), colors(&mut ball(metal(1.0, 0.0))));
    let close = |a: &[u8; 4], b: &[u8; 4]| (0..4).all(|k| a[k].abs_diff(b[k]) <= 30);
    let differ = traced.iter().zip(&looked_up).filter(|(a, b)| !close(a, b)).count();
    assert!(differ < 64 * 64 / 20, "{differ} pixels, of the rim and of the steps of the image");
    // Without an image they see the background, as ever.
    let background = |image: bool| {
        let mut renderer = ball(metal(1.0, 0.0));
        renderer.settings.global.model = Global::RayTrace;
        if !image {
            renderer.environment_image = None;
        }
        at(&colors(&mut renderer), 32, 16)
    };
    assert_ne!(background(true), background(false));
    assert_eq!(background(false)[..3], [0; 3]);
}

#[test]
fn the_image_is_light_that_options_of_lights_change() {
    let value = |change: &dyn Fn(&mut Renderer)| {
        let mut renderer = ball(metal(0.0, 1.0));
        change(&mut renderer);
        at(&colors(&mut renderer), 32, 16)[0]
    };
    let whole = value(&|_| {});
    assert!(whole > 200);
    assert!(value(&|r| r.light_intensity = Some(0.25)) < 150);
    assert!(
        value(&|r| r.settings.shading.environment = Environment::None) == 0,
        "none switches it off"
    );
    assert!(value(&|r| r.light_term = Some(vitral::LightTerm::Diffuse)) == 0);
    assert!(value(&|r| r.light_term = Some(vitral::LightTerm::Specular)) < 100);
    assert!(value(&|r| r.light_term = Some(vitral::LightTerm::Ambient)) > 200);
    assert!(value(&|r| r.settings.global.model = Global::Radiosity) == 0, "radiosity does without");
}

#[test]
fn an_image_of_another_shape_is_told() {
    let mut renderer = ball(metal(1.0, 0.0));
    assert!(renderer.render().unwrap().warnings.is_empty());
    let square = Panorama::new(8, 8, vec![[0.5; 3]; 64]).unwrap();
    renderer.environment_image = Some(Arc::new(EnvironmentMap::new(square, [8, 8])));
    let warnings = renderer.render().unwrap().warnings.join(" ");
    assert!(warnings.contains("an image of 8 x 8"), "{warnings}");
}

/// A wall on a floor, in ambient light and, if wanted, a lamp straight above.
fn corner(lamp: bool) -> Renderer {
    let mut scene = Scene::default();
    let white = Some(scene.add_material(Material::matte([0.8; 3])));
    for (size, at) in [
        (DVec3::new(10.0, 0.2, 10.0), DVec3::new(0.0, -0.1, 0.0)),
        (DVec3::new(10.0, 4.0, 0.2), DVec3::new(0.0, 2.0, -1.0)),
    ] {
        let mut mesh = solids::cuboid(size);
        mesh.parts.iter_mut().for_each(|part| part.material = white);
        scene.add_mesh(mesh, DMat4::from_translation(at));
    }
    let mut renderer = front(scene);
    renderer.view = View::Iso;
    renderer.ambient = [0.5; 3];
    let sun =
        Light { kind: LightKind::Directional { direction: DVec3::NEG_Y }, ..Light::default() };
    renderer.lights = Some(if lamp { vec![sun] } else { Vec::new() });
    renderer
}

#[test]
fn corners_get_less_ambient_light() {
    let picture = |rays: Option<u32>, radius: f64| {
        let mut renderer = corner(false);
        renderer.settings.shading.ambient_occlusion = rays;
        renderer.settings.shading.occlusion_radius = rays.map(|_| radius);
        colors(&mut renderer)
    };
    let (plain, weakened) = (picture(None, 0.0), picture(Some(64), 2.0));
    let pairs = || plain.iter().zip(&weakened).filter(|(a, _)| a[3] == 255);
    assert!(pairs().all(|(a, b)| b[0] <= a[0] && b[3] == 255));
    let (same, darker) =
        (pairs().filter(|(a, b)| a == b).count(), pairs().filter(|(a, b)| a[0] > b[0] + 8).count());
    assert!(same > 100 && darker > 60, "what is open stays, the corner is darker: {same} {darker}");
    // A radius that meets nothing changes nothing.
    assert!(picture(Some(16), 1e-5) == plain);
}

#[test]
fn only_ambient_light_is_weakened() {
    let picture = |rays: Option<u32>, ambient: f32| {
        let mut renderer = corner(true);
        (renderer.ambient, renderer.settings.shading.ambient_occlusion) = ([ambient; 3], rays);
        colors(&mut renderer)
    };
    assert!(picture(Some(16), 0.0) == picture(None, 0.0));
    assert!(picture(Some(16), 0.3) != picture(None, 0.3));
}

#[test]
fn occlusion_is_the_same_for_all_algorithms_threads_and_structures() {
    let picture = |change: &dyn Fn(&mut Renderer)| {
        let mut renderer = corner(true);
        renderer.settings.shading.ambient_occlusion = Some(16);
        change(&mut renderer);
        colors(&mut renderer)
    };
    let expected = picture(&|_| {});
    for visibility in [
        Visibility::SCAN_LINE,
        Visibility::WARNOCK,
        Visibility::WEILER_ATHERTON,
        Visibility::RAY_CAST,
    ] {
        assert!(picture(&|r| r.settings.visibility = visibility) == expected, "{visibility}");
    }
    assert!(picture(&|r| r.settings.acceleration = Some(vitral::Acceleration::OCTREE)) == expected);
    assert!(picture(&|r| *r.execution_mut() = vitral::execution(1)) == expected);
    assert!(picture(&|r| *r.execution_mut() = vitral::execution(3)) == expected);
}

#[test]
fn occlusion_knows_its_numbers_and_limits() {
    let mut renderer = corner(false);
    renderer.settings.shading.ambient_occlusion = Some(0);
    assert_eq!(
        settings_error(&renderer.render().unwrap_err()),
        &SettingsError::AmbientOcclusion(0)
    );
    (renderer.settings.shading.ambient_occlusion, renderer.settings.shading.occlusion_radius) =
        (None, Some(1.0));
    assert_eq!(settings_error(&renderer.render().unwrap_err()), &SettingsError::NoOcclusion);
    (renderer.settings.shading.ambient_occlusion, renderer.settings.shading.occlusion_radius) =
        (Some(4), Some(-1.0));
    assert_eq!(
        settings_error(&renderer.render().unwrap_err()),
        &SettingsError::OcclusionRadius(-1.0)
    );
    (renderer.settings.shading.ambient_occlusion, renderer.settings.shading.occlusion_radius) =
        (Some(4096), None);
    let budget = renderer.execution().budget.clone().with_time_limit(Some(0.001));
    renderer.execution_mut().budget = budget;
    assert!(matches!(limit(&mut renderer), Limit::Time { .. }));
}

/// A cube of side 2 over the origin, and how it is seen and lit: its shadow.
fn cube(shadow: GroundShadow) -> Renderer {
    let mut scene = Scene::default();
    scene.add_mesh(solids::cuboid(DVec3::splat(2.0)), DMat4::IDENTITY);
    let mut renderer = front(scene);
    renderer.view = View::Iso;
    renderer.moves.zoom = 0.5;
    renderer.settings.shadows.ground = shadow;
    renderer
}

#[test]
fn the_ground_shows_shadow_alone() {
    for (kind, lights) in [
        (GroundShadow::Auto, None),
        (GroundShadow::Lights, Some(vec![sun_from(DVec3::new(-1.0, 1.0, 0.0))])),
    ] {
        let picture = |kind, background| {
            let mut renderer = cube(kind);
            renderer.lights.clone_from(&lights);
            renderer.settings.picture.background = background;
            colors(&mut renderer)
        };
        let (model, shaded) = (
            picture(GroundShadow::None, Background::Transparent),
            picture(kind, Background::Transparent),
        );
        let mut shadow = 0;
        for (a, b) in model.iter().zip(&shaded) {
            match a[3] {
                255 => assert_eq!(a, b, "the model stays"),
                0 => {
                    assert_eq!(b[..3], [0; 3], "shadow is black, more or less of it");
                    shadow += usize::from(b[3] > 8);
                }
                _ => assert!(b[3] >= a[3]),
            }
        }
        assert!(shadow > 40, "{kind:?}: {shadow}");
        // Over a background of a colour the same shadow darkens it, and nothing else changes.
        let white = Background::Color { color: [1.0; 3] };
        let (plain, over) = (picture(GroundShadow::None, white), picture(kind, white));
        for ((a, b), (model, shadow)) in plain.iter().zip(&over).zip(model.iter().zip(&shaded)) {
            assert!(b[3] == 255 && (0..3).all(|k| b[k] <= a[k]), "{a:?} {b:?}");
            if shadow[3] == 0 || model[3] == 255 {
                assert_eq!(a, b);
            }
        }
    }
}

fn sun_from(from: DVec3) -> Light {
    Light { kind: LightKind::Directional { direction: -from }, shadow: true, ..Light::default() }
}

#[test]
fn the_shadow_falls_where_the_light_says() {
    // The sun stands 45 degrees high on the left: from above the shadow of the cube, which ends at
    // x = 1, goes on to x = 3.
    let mut renderer = cube(GroundShadow::Lights);
    (renderer.view, renderer.lights) =
        (View::Top, Some(vec![sun_from(DVec3::new(-1.0, 1.0, 0.0))]));
    renderer.lens = vitral::Lens::Parallel;
    renderer.moves.zoom = 0.25;
    let camera = renderer.frame_camera();
    let pixels = colors(&mut renderer);
    let vitral::Projection::Parallel { height } = camera.projection else {
        panic!("a parallel view")
    };
    let alpha = |x: f64, z: f64| {
        let at = [x, z].map(|v| (32.0 + v / height * 64.0) as usize);
        at_alpha(&pixels, at[0], at[1])
    };
    assert!([1.3, 2.0, 2.7].iter().all(|&x| alpha(x, 0.0) == 255), "the only light is gone");
    assert!(
        [-1.4, 3.3].iter().all(|&x| alpha(x, 0.0) == 0)
            && alpha(2.0, 1.4) == 0
            && alpha(2.0, -1.4) == 0
    );
    // In ambient light of a third of the sun's on the ground, three quarters are gone. A quarter of
    // white is sRGB's 137.
    let sun = 0.5f32.sqrt();
    renderer.ambient = [sun / 3.0; 3];
    let pixels = colors(&mut renderer);
    let at = [2.0, 0.0].map(|v| (32.0 + v / height * 64.0) as usize);
    assert_eq!(at_alpha(&pixels, at[0], at[1]), 255 - 137);
}

fn at_alpha(pixels: &[[u8; 4]], x: usize, y: usize) -> u8 {
    at(pixels, x, y)[3]
}

#[test]
fn the_ground_is_the_same_for_all_algorithms_and_threads() {
    for kind in [GroundShadow::Soft, GroundShadow::Lights] {
        let picture = |change: &dyn Fn(&mut Renderer)| {
            let mut renderer = cube(kind);
            change(&mut renderer);
            colors(&mut renderer)
        };
        let expected = picture(&|_| {});
        let others = Visibility::all().filter(|v| *v != Visibility::BRUTE_FORCE);
        for visibility in others {
            assert!(
                picture(&|r| r.settings.visibility = visibility) == expected,
                "{kind:?} {visibility}"
            );
        }
        for shadows in [Shadows::MAP, Shadows::RAY] {
            let alpha = |pixels: &[[u8; 4]]| pixels.iter().map(|p| p[3]).collect::<Vec<_>>();
            assert!(
                alpha(&picture(&|r| r.settings.shadows.algorithm = shadows)) == alpha(&expected),
                "{shadows}"
            );
        }
        assert!(picture(&|r| *r.execution_mut() = vitral::execution(3)) == expected);
    }
}

#[test]
fn the_soft_shadow_is_darkest_at_the_foot_and_fades() {
    let mut renderer = cube(GroundShadow::Soft);
    (renderer.view, renderer.lens, renderer.moves.zoom) = (View::Top, vitral::Lens::Parallel, 0.4);
    let pixels = colors(&mut renderer);
    let row: Vec<u8> = (0..64).map(|x| at_alpha(&pixels, x, 32)).collect();
    let foot = (32..64).find(|&x| row[x] < 255).unwrap() + 1;
    assert!(row[foot] > 12 && row[foot] < 200 && row[63] == 0, "{row:?}");
    assert!(row[foot..].windows(2).all(|w| w[1] <= w[0] + 3), "{row:?}");
    // Both sides alike, as no light has a say.
    assert!((0..64).all(|x| row[x].abs_diff(row[63 - x]) <= 6), "{row:?}");
}

#[test]
fn glass_shows_the_shadow_behind_it_and_the_ground_has_no_back() {
    let mut scene = load_builtin("cubs").unwrap();
    for material in &mut scene.materials {
        (material.alpha_mode, material.opacity) = (vitral::AlphaMode::Blend, 0.3);
    }
    let picture = |scene: &Scene, change: &dyn Fn(&mut Renderer)| {
        let mut renderer = front(scene.clone());
        renderer.view = View::Iso;
        renderer.settings.picture.background = Background::Color { color: [1.0; 3] };
        change(&mut renderer);
        colors(&mut renderer)
    };
    let soft = |renderer: &mut Renderer| renderer.settings.shadows.ground = GroundShadow::Soft;
    let covered = picture(&scene, &|r| r.settings.picture.background = Background::Transparent);
    for model in [Global::None, Global::RayTrace] {
        let plain = picture(&scene, &|r| r.settings.global.model = model);
        let shaded = picture(&scene, &|r| {
            soft(r);
            r.settings.global.model = model;
        });
        let darker = |(a, b): &(&[u8; 4], &[u8; 4])| a[0] > b[0] + 2;
        let seen_through = plain.iter().zip(&shaded).zip(&covered).filter(|(_, c)| c[3] > 30);
        let count = seen_through.map(|(pair, _)| pair).filter(darker).count();
        assert!(count > 40, "{model:?}: {count}");
    }
    // From below the ground does not hide the model.
    let below = |renderer: &mut Renderer| renderer.view = View::Bottom;
    assert!(
        picture(&scene, &|r| {
            soft(r);
            below(r);
        }) == picture(&scene, &below)
    );
}
