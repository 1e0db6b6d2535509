//! Light, shadow and glass in scenes as people write them, whose right pictures are known.

use super::common::{colors, exact, sun};
use std::collections::BTreeSet;
use vitral::internals::render::registry::SHADOWS;
use vitral::{
    Camera, DMat4, DVec3, Global, Material, Reflectance, Renderer, Scene, Shadows, Terminator,
    load_bytes, solids,
};

fn fixture(bytes: &[u8], side: u32) -> Renderer {
    let mut renderer = exact(load_bytes(bytes, "scene.json").unwrap(), side, side);
    renderer.camera = renderer.world().cameras.first().copied();
    renderer
}

fn matt(kd: f32) -> Material {
    let reflectance =
        Reflectance::Phong { ka: [0.0; 3], kd: [kd; 3], ks: [0.0; 3], shininess: 1.0 };
    Material { reflectance, ..Material::default() }
}

#[test]
fn a_mirror_of_glass_in_an_evenly_bright_room_is_never_brighter_than_the_room() {
    let mut renderer = fixture(include_bytes!("../fixtures/energy-mirror-glass.json"), 96);
    renderer.settings.global.model = Global::RayTrace;
    let picture = renderer.render().unwrap();
    let rays = picture.stats.tracing.rays;
    let brightest =
        picture.frame.color.unwrap().data().iter().flat_map(|p| [p[0], p[1], p[2]]).max().unwrap();
    // Walls of 0.25 are all the light that there is.
    assert!(brightest <= 64, "{brightest}");
    assert!(rays < 40 * 96 * 96, "branches end where they add nothing: {rays}");
}

#[test]
fn an_opacity_below_1_blends_unless_the_file_says_otherwise() {
    let file = include_str!("../fixtures/opacity-without-alpha-mode.json");
    let middle = |file: &str| colors(&mut fixture(file.as_bytes(), 64))[32 * 64 + 32];
    // Half of (1, 0.2, 0.1) and half of (0.8, 0.6, 0.4).
    assert_eq!(middle(file), [230, 102, 64, 255]);
    let opaque = file
        .replace("\"opacity\": 0.5", "\"opacity\": 0.5, \"alpha-mode\": {\"mode\": \"opaque\"}");
    assert_eq!(middle(&opaque), [255, 51, 26, 255]);
}

#[test]
fn what_only_another_setting_shows_is_told() {
    let file = include_str!("../fixtures/opacity-without-alpha-mode.json");
    let warnings = |more: &str, change: &dyn Fn(&mut Renderer)| {
        let mut renderer = fixture(file.replace("\"opacity\": 0.5", more).as_bytes(), 16);
        change(&mut renderer);
        renderer.render().unwrap().warnings.join("\n")
    };
    let filter = "\"opacity\": 0.5, \"filter\": [1, 0, 0]";
    assert!(
        warnings(filter, &|_| ())
            .contains("material `glass` colours nothing without --transparency filtered")
    );
    assert_eq!(
        warnings(filter, &|r| r.settings.transparency.model = vitral::Transparency::Filtered),
        ""
    );
    assert!(warnings("\"opacity\": 0.5, \"kt-min\": 0.2", &|_| ()).contains("--transparency kay"));
    assert!(
        warnings("\"transmission\": \"translucent\"", &|_| ())
            .contains("give it an opacity below 1")
    );
    assert_eq!(warnings("\"opacity\": 0.5", &|_| ()), "");
}

#[test]
fn a_parallel_camera_does_not_show_what_is_behind_it() {
    let mut renderer = fixture(include_bytes!("../fixtures/ortho-behind-camera.json"), 32);
    assert_eq!(colors(&mut renderer)[16 * 32 + 16], [0, 255, 0, 255]);
    let camera = renderer.camera.unwrap();
    renderer.camera = Some(Camera { clip: Some((-3.0, 5.0)), ..camera });
    assert_eq!(colors(&mut renderer)[16 * 32 + 16], [255, 0, 0, 255], "planes that are given hold");
}

#[test]
fn no_light_goes_through_the_foot_of_a_wall() {
    let mut renderer = fixture(include_bytes!("../fixtures/radiosity-leak.json"), 64);
    renderer.settings.global.model = Global::Radiosity;
    renderer.settings.shadows.algorithm = Shadows::RAY;
    // A closed dark room. A sample may fall on the line itself in which wall and floor meet, and
    // that belongs to both sides.
    let lit = colors(&mut renderer).into_iter().filter(|p| p[0].max(p[1]).max(p[2]) > 0).count();
    assert!(lit <= 1, "{lit} pixels of 4096");
    // The other side of the wall is lit.
    let camera = renderer.camera.unwrap();
    let position = DVec3::new(-1.9, 1.0, 1.9);
    renderer.camera = Some(Camera { position, focal_point: DVec3::new(-1.0, 0.9, -1.0), ..camera });
    let lit = colors(&mut renderer);
    assert!(lit.iter().all(|p| p[0] > 10), "{:?}", lit.iter().min());
}

#[test]
fn glass_that_nothing_is_made_of_is_no_matter() {
    let mut renderer = fixture(include_bytes!("../fixtures/unused-glass-warning.json"), 16);
    renderer.settings.global.model = Global::Radiosity;
    assert_eq!(renderer.render().unwrap().warnings, Vec::<String>::new());
}

#[test]
fn edges_of_shadows_have_as_many_levels_as_samples() {
    for shadows in SHADOWS.iter().filter(|s| s.algorithm.is_some()) {
        let mut renderer = fixture(include_bytes!("../fixtures/shadow-edge-jagged.json"), 128);
        renderer.settings.picture.samples = 16;
        renderer.settings.shadows.algorithm = shadows.name.parse().unwrap();
        let levels: BTreeSet<u8> = colors(&mut renderer).into_iter().map(|p| p[0]).collect();
        assert!(levels.len() >= 12, "{}: {levels:?}", shadows.name);
    }
}

#[test]
fn coarse_round_bodies_have_a_smooth_border_of_light_by_all_shadows() {
    let mut scene = Scene::default();
    let mut ball = solids::sphere(1.0, 16, 8);
    let material = scene.add_material(matt(0.9));
    ball.parts.iter_mut().for_each(|p| p.material = Some(material));
    scene.add_mesh(ball, DMat4::IDENTITY);
    scene.lights = vec![sun(DVec3::new(1.0, 0.3, 0.2), 1.0)];
    let mut seen = Vec::new();
    for shadows in SHADOWS.iter() {
        let mut renderer = exact(scene.clone(), 96, 96);
        renderer.camera = Some(super::common::on_z(5.0, 0.5));
        renderer.settings.shadows.algorithm = shadows.name.parse().unwrap();
        let soft = colors(&mut renderer);
        // The largest step between neighbours inside the ball.
        let step = |picture: &[[u8; 4]]| {
            let inside = (30..66).flat_map(|y| (30..66).map(move |x| y * 96 + x));
            inside.map(|i| picture[i][0].abs_diff(picture[i + 1][0])).max().unwrap()
        };
        assert!(step(&soft) < 14, "{}: {}", shadows.name, step(&soft));
        if shadows.algorithm.is_some() {
            renderer.settings.shadows.terminator = Terminator::Exact;
            let exact = step(&colors(&mut renderer));
            assert!(exact > 20, "{}: facets end the light in steps: {exact}", shadows.name);
        }
        seen.push((shadows.name, soft));
    }
    // Nothing else stands in the light: what the interpolated normal says is the picture without
    // shadows.
    for (name, picture) in &seen[1..] {
        let worst = super::common::largest_difference(picture, &seen[0].1);
        assert!(worst < 3, "{name}: {worst}");
    }
}

#[test]
fn a_sphere_of_glass_whose_pole_is_rounded_is_closed() {
    let mut ball = solids::sphere(1.0, 16, 8);
    // Each triangle has its own corners; those at a pole are off it by the sine of half a turn.
    let corners: Vec<[f32; 3]> =
        ball.triangles.as_flattened().iter().map(|&v| ball.positions[v as usize]).collect();
    let noise = |i: usize, c: f32| if c.abs() < 1e-6 { 1e-16 * (i % 7) as f32 } else { c };
    ball.positions = corners.into_iter().enumerate().map(|(i, p)| p.map(|c| noise(i, c))).collect();
    ball.triangles =
        (0..ball.positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    (ball.normals, ball.faces) = (None, Default::default());
    ball.uvs.clear();
    let glass =
        Material { opacity: 0.3, alpha_mode: vitral::AlphaMode::Blend, ior: 1.5, ..matt(0.5) };
    let mut renderer = exact(super::common::one(ball, glass), 16, 16);
    renderer.settings.global.model = Global::RayTrace;
    assert_eq!(renderer.render().unwrap().warnings, Vec::<String>::new());
}
