//! Degenerate scenes and settings: everything is defined, nothing panics, no pixel comes from a
//! NaN.

use super::common::{
    all_channels, colors, exact, exact_builtin, limit, on_z, one, settings_error, sun,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use vitral::internals::render::registry::SHADOWS;
use vitral::{
    AlphaMode, Budget, Camera, Channel, Channels, Clock, DMat4, DVec3, Error, Faces, Frame, Light,
    LightKind, Limit, Material, Mesh, Node, NodeTransform, Projection, Reflectance, RenderError,
    Renderer, Scene, SettingsError, Shadows, SystemClock, Viewpoint, Visibility, Workers,
    load_builtin, solids,
};

#[test]
fn zero_lights_leave_ambient_light_alone() {
    let mut renderer = exact_builtin("sphere", 40, 30);
    renderer.lights = Some(Vec::new());
    assert!(colors(&mut renderer).iter().all(|c| *c == [0, 0, 0, 255]), "no light, no picture");
    renderer.ambient = [0.5; 3];
    assert!(colors(&mut renderer).iter().any(|c| c[0] > 50));
}

#[test]
fn an_empty_scene_is_all_background() {
    let mut renderer = exact(Scene::default(), 33, 7);
    renderer.settings.picture.samples = 4;
    renderer.settings.picture.channels = all_channels();
    let rendered = renderer.render().unwrap();
    let frame = rendered.frame;
    assert!(frame.color.unwrap().data().iter().all(|c| *c == [0, 0, 0, 255]));
    assert!(frame.depth.unwrap().data().iter().all(|&z| z == 0.0));
    assert!(frame.surface.unwrap().data().iter().all(|&id| id == Frame::BACKGROUND));
    assert_eq!((rendered.stats.picture.pixels, rendered.stats.picture.covered_pixels), (231, 0));
}

#[test]
fn a_camera_inside_a_model_sees_it_or_nothing_but_never_fails() {
    // Inside a closed ball back faces are culled by right; inside an open dome they are seen.
    let mut dome = solids::sphere(1.0, 48, 24);
    dome.faces = Faces::Triangles;
    dome.triangles.pop();
    (dome.normals, dome.uvs) = (None, Vec::new());
    dome.parts[0].triangles.end -= 1;
    let mut inside = exact(Scene::from_mesh(dome), 64, 48);
    inside.camera = Some(Camera {
        position: DVec3::new(0.1, 0.0, 0.2),
        focal_point: DVec3::X,
        ..on_z(1.0, 1.2)
    });
    let stats = inside.render().unwrap().stats;
    assert_eq!(stats.picture.covered_pixels, 64 * 48, "the dome is all round");
    let mut scene0 = exact_builtin("scene0", 64, 48);
    for position in [DVec3::new(0.7, 0.8, 1.2), DVec3::new(-1.1, 0.7, -1.1), DVec3::ZERO] {
        scene0.camera =
            Some(Camera { position, focal_point: DVec3::new(3.0, 0.0, 0.0), ..on_z(1.0, 1.2) });
        scene0.settings.picture.channels = all_channels();
        let frame = scene0.render().unwrap().frame;
        assert!(frame.depth.unwrap().data().iter().all(|z| (0.0..=1.0).contains(z)));
    }
}

#[test]
fn models_of_any_size_fill_the_picture() {
    let covered = |size: f64, parallel: bool| {
        let mut scene = Scene::default();
        scene.add_mesh(solids::cuboid(DVec3::splat(1.0)), DMat4::from_scale(DVec3::splat(size)));
        let mut renderer = exact(scene, 64, 48);
        Viewpoint { orthographic: parallel, ..Viewpoint::default() }
            .apply(&mut renderer, Default::default())
            .unwrap();
        renderer.render().unwrap().stats.picture.covered_pixels
    };
    for parallel in [false, true] {
        let usual = covered(1.0, parallel);
        assert!(usual > 500, "{usual}");
        for size in [1e-7, 1e-11, 1e-15, 1e9] {
            assert!(
                covered(size, parallel).abs_diff(usual) < 20,
                "{size}: {} {usual}",
                covered(size, parallel)
            );
        }
    }
}

#[test]
fn triangles_with_nan_or_infinite_corners_vanish_and_are_counted() {
    let mut mesh = solids::plane(2.0, 2.0, 4, 4);
    mesh.positions[0][0] = f32::NAN;
    mesh.positions[6][1] = f32::INFINITY;
    mesh.positions[24][2] = f32::NEG_INFINITY;
    let touched =
        mesh.triangles.iter().filter(|t| t.iter().any(|i| [0, 6, 24].contains(i))).count() as u64;
    mesh.normals.as_mut().unwrap().values.push([f32::NAN; 3]);
    let mut renderer = exact(Scene::from_mesh(mesh), 80, 60);
    renderer.settings.picture.samples = 4;
    renderer.settings.picture.channels = all_channels();
    let rendered = renderer.render().unwrap();
    assert_eq!(rendered.stats.geometry.not_finite, touched);
    assert!(rendered.stats.picture.covered_pixels > 100, "the others are there");
    assert!(rendered.frame.depth.unwrap().data().iter().all(|z| (0.0..=1.0).contains(z)));
    assert!(rendered.frame.normal.unwrap().data().iter().flatten().all(|n| n.is_finite()));
}

#[test]
fn corners_too_far_away_to_clip_exactly_are_harmless() {
    let corners = [
        [3.5332105e18, -1.2369859e18, 8.757267e-36],
        [-4.1693534e21, 1.8051624e-14, -6.3354252e-12],
        [2.8403258e17, -3.0664892e25, -2.912492e36],
    ];
    let mut renderer = exact(Scene::from_mesh(Mesh::new(corners, [[0, 1, 2]])), 64, 64);
    renderer.settings.shading.lighting = false;
    renderer.settings.picture.channels = Channels { attached_shadow: false, ..all_channels() };
    let projection = Projection::Parallel { height: 10.924444444444445 };
    for position in [
        DVec3::new(-3.21875, 2.4375, -3.8125),
        DVec3::new(3.0, 2.0, 1.0),
        DVec3::new(0.0, 0.0, 5.0),
    ] {
        let focal_point = DVec3::new(-1.84375, -0.75, -3.96875);
        let view_up = DVec3::new(-3.0, 0.96875, -0.15625);
        renderer.camera = Some(Camera { position, focal_point, view_up, projection, clip: None });
        let frame = renderer.render().unwrap().frame;
        assert!(frame.depth.unwrap().data().iter().all(|z| (0.0..=1.0).contains(z)));
    }
}

#[test]
fn odd_numbers_everywhere_give_a_picture_all_the_same() {
    let mut renderer = exact_builtin("sphere", 40, 30);
    renderer.settings.picture.channels = all_channels();
    let good = renderer.frame_camera();
    for camera in [
        Camera { position: good.focal_point, ..good },
        Camera { view_up: good.focal_point - good.position, ..good },
        Camera { position: DVec3::splat(f64::NAN), ..good },
        Camera { position: DVec3::splat(1e300), ..good },
        Camera { clip: Some((1e-300, 1e300)), ..good },
    ] {
        renderer.camera = Some(camera);
        let frame = renderer.render().unwrap().frame;
        assert!(frame.depth.unwrap().data().iter().all(|z| (0.0..=1.0).contains(z)), "{camera:?}");
    }
    renderer.camera = Some(good);
    renderer.light_intensity = Some(f32::NAN);
    assert_eq!(colors(&mut renderer).len(), 1200);
    renderer.light_intensity = Some(f32::INFINITY);
    assert_eq!(colors(&mut renderer).len(), 1200);
    // A flat object, one scaled to nothing, and one far away.
    let mut scene = load_builtin("cubs").unwrap();
    for (node, scale) in [(1, DVec3::new(1.0, 0.0, 1.0)), (2, DVec3::ZERO), (3, DVec3::splat(1e30))]
    {
        scene.nodes[node].transform = NodeTransform::Matrix(DMat4::from_scale(scale));
    }
    let mut renderer = exact(scene, 40, 30);
    renderer.settings.picture.channels = Channels { attached_shadow: false, ..all_channels() };
    let error = renderer.render().unwrap_err().to_string();
    assert!(
        error.starts_with("the scene is ")
            && error.contains("light is computed from 1e-16 to 1e16"),
        "{error}"
    );
    renderer.settings.shading.lighting = false;
    let frame = renderer.render().unwrap().frame;
    assert!(frame.normal.unwrap().data().iter().flatten().all(|n| n.is_finite()));
}

#[test]
fn light_is_the_same_at_all_sizes_or_refused() {
    // Lab3D's sphere and its lights, scaled; a point light without attenuation shines alike at all
    // distances.
    let picture = |scale: f64, change: fn(&mut Renderer)| {
        let mut scene = load_builtin("sphere").unwrap();
        let transform = DMat4::from_scale(DVec3::splat(scale));
        scene.roots.retain(|&root| scene.nodes[root as usize].camera.is_none());
        let children = std::mem::take(&mut scene.roots);
        scene.add_root(Node {
            transform: NodeTransform::Matrix(transform),
            children,
            ..Node::default()
        });
        scene.lights.iter_mut().for_each(|light| {
            if let LightKind::Point { position } = &mut light.kind {
                *position *= scale;
            }
        });
        let mut renderer = exact(scene, 48, 36);
        change(&mut renderer);
        renderer.render().map(|rendered| rendered.frame.color.unwrap().data().to_vec())
    };
    let usual = picture(1.0, |_| {}).unwrap();
    let apart = |a: &[[u8; 4]], b: &[[u8; 4]]| {
        let pairs = a.as_flattened().iter().zip(b.as_flattened());
        pairs.filter(|(a, b)| a.abs_diff(**b) > 2).count()
    };
    for scale in [1e-15, 1e-9, 1e6, 1e14] {
        let scaled = picture(scale, |_| {}).unwrap();
        assert!(apart(&usual, &scaled) < usual.len() / 100, "{scale}: {}", apart(&usual, &scaled));
    }
    for scale in [1e-20, 1e18] {
        let told = picture(scale, |_| {}).unwrap_err().to_string();
        assert!(told.contains("light is computed"), "{told}");
        picture(scale, |r| r.settings.shading.lighting = false).unwrap();
    }
    // Shadows and rays need more room.
    let shadowed = |r: &mut Renderer| r.settings.shadows.algorithm = Shadows::RAY;
    let usual = picture(1.0, shadowed).unwrap();
    for scale in [1e-8, 1e10] {
        let scaled = picture(scale, shadowed).unwrap();
        assert!(apart(&usual, &scaled) < usual.len() / 50, "{scale}: {}", apart(&usual, &scaled));
    }
    assert!(
        picture(1e-12, shadowed).unwrap_err().to_string().contains("shadows and rays are computed")
    );
}

/// The error for a resolution and a number of samples.
fn refusal(width: u32, height: u32, samples: u32) -> Error {
    let mut renderer = exact_builtin("cubs", width, height);
    renderer.settings.picture.samples = samples;
    renderer.render().unwrap_err()
}

#[test]
fn sizes_that_cannot_be_are_errors() {
    for (width, height) in [(0, 10), (10, 0), (100_000, 10), (u32::MAX, u32::MAX)] {
        let error = refusal(width, height, 1);
        assert!(matches!(settings_error(&error), SettingsError::Resolution { .. }), "{error}");
        assert!(error.to_string().contains(&format!("resolution {width}x{height}")), "{error}");
    }
    assert!(refusal(8, 8, 17).to_string().contains("17 samples"));
    let unknown = "magic".parse::<Visibility>().unwrap_err();
    assert!(unknown.to_string().contains("choose z-buffer"), "{unknown}");
}

#[test]
fn limits_stop_the_work() {
    let mut renderer = exact_builtin("cubs", 4096, 4096);
    renderer.execution_mut().budget = Budget::default().with_memory_limit(Some(1 << 20));
    let error = renderer.render().unwrap_err();
    assert!(matches!(error, Error::Render(RenderError::Limit(Limit::Memory { .. }))), "{error}");
    let mut renderer = exact_builtin("cubs", 64, 64);
    let budget = Budget::new(Arc::new(SystemClock::default())).with_time_limit(Some(0.0));
    renderer.execution_mut().budget = budget;
    std::thread::sleep(std::time::Duration::from_millis(2));
    assert!(matches!(limit(&mut renderer), Limit::Time { .. }));
    renderer.execution_mut().budget = Budget::default();
    renderer.execution().budget.cancel_flag().store(true, Ordering::Relaxed);
    assert!(matches!(limit(&mut renderer), Limit::Cancelled { .. }));
    // After a limit the renderer still works.
    renderer.execution_mut().budget = Budget::default();
    assert!(colors(&mut renderer) == colors(&mut exact_builtin("cubs", 64, 64)));
}

/// Each look at this clock takes a second.
struct Ticking(AtomicU64);

impl Clock for Ticking {
    fn seconds(&self) -> f64 {
        self.0.fetch_add(1, Ordering::Relaxed) as f64
    }
}

#[test]
fn limits_stop_shading_between_tiles() {
    /// 256 by 256 pixels in tiles of 64.
    const TILES: u64 = 16;
    let mut renderer = exact_builtin("cubs", 256, 256);
    renderer.execution_mut().workers = Workers::single();
    let render = |renderer: &mut Renderer, limit: f64| {
        let clock = Arc::new(Ticking(AtomicU64::new(0)));
        renderer.execution_mut().budget = Budget::new(clock.clone()).with_time_limit(Some(limit));
        let result = renderer.render();
        (result.map(drop), clock.0.load(Ordering::Relaxed))
    };
    for channel in [Channel::Color, Channel::Normal] {
        renderer.settings.picture.channels = Channels { color: false, ..Channels::default() };
        channel.request(&mut renderer.settings.picture.channels);
        let (result, ticks) = render(&mut renderer, 1e9);
        assert!(result.is_ok() && ticks > TILES, "{ticks} ticks, {TILES} tiles");

        // Wherever in the tiles time is over, the rest is left out.
        let mut in_tiles = 0_u64;
        for limit in 1..ticks {
            if let (
                Err(Error::Render(RenderError::Limit(Limit::Time {
                    stage: "shading" | "visibility",
                    ..
                }))),
                _,
            ) = render(&mut renderer, limit as f64)
            {
                in_tiles += 1;
            }
        }
        assert!(in_tiles >= TILES, "{channel:?}: time was over {in_tiles} times, {TILES} tiles");
    }
}

#[test]
fn unsound_scenes_are_errors() {
    let mut cyclic = load_builtin("cubs").unwrap();
    cyclic.nodes[1].children.push(1);
    let error = Renderer::new(cyclic).unwrap_err();
    assert!(
        matches!(error, Error::Render(RenderError::World(_)))
            && error.to_string().contains("must be a tree")
    );
    let mut broken = load_builtin("cubs").unwrap();
    Arc::make_mut(&mut broken.meshes[0]).triangles[0][0] = 99;
    assert!(Renderer::new(broken).unwrap_err().to_string().contains("index 99"));
    let mut renderer = exact_builtin("cubs", 8, 8);
    let bad = Viewpoint { camera_index: Some(3), ..Viewpoint::default() };
    assert!(matches!(bad.apply(&mut renderer, vitral::Axis::PlusY), Err(Error::Usage { .. })));
}

#[test]
fn no_light_leaks_in_where_walls_meet() {
    // A closed room whose edges run through the middles of pixels, and a lamp outside.
    let mut room = solids::cuboid(DVec3::splat(10.0));
    room.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    (room.faces, room.normals, room.uvs) = (Faces::Triangles, None, Vec::new());
    let reflectance =
        Reflectance::Phong { ka: [0.0; 3], kd: [0.9; 3], ks: [0.0; 3], shininess: 1.0 };
    let walls = Material { reflectance, double_sided: true, ..Material::default() };
    let mut r = exact(one(room, walls), 320, 240);
    r.camera = Some(on_z(2.5, 80f64.to_radians()));
    let kind = LightKind::Point { position: DVec3::new(7.0, 8.0, 9.0) };
    r.lights = Some(vec![Light { kind, ..Light::default() }]);
    assert!(colors(&mut r).iter().any(|c| c[0] > 50), "without shadows it shines in");
    for shadows in SHADOWS.iter().filter(|s| !["none", "map"].contains(&s.name)) {
        r.settings.shadows.algorithm = shadows.name.parse().unwrap();
        let bright = colors(&mut r).iter().filter(|c| c[0] > 0).count();
        assert_eq!(bright, 0, "{}", shadows.name);
    }
    // Maps see no better than a texel: some pixels along the edges have a wall's very edge in their
    // texel.
    r.settings.shadows.algorithm = Shadows::MAP;
    for (size, most) in [(128, 350), (512, 15), (2048, 10)] {
        r.settings.shadows.map_size = size;
        let bright = colors(&mut r).iter().filter(|c| c[0] > 0).count();
        assert!(bright <= most, "{bright} with {size} texels");
    }
}

#[test]
fn shadow_maps_of_transparent_things_keep_to_the_memory_limit() {
    // Forty panes over each other are forty layers in each of half a million texels.
    let pane = Material { opacity: 0.5, alpha_mode: AlphaMode::Blend, ..Material::default() };
    let mut scene = one(solids::cuboid(DVec3::new(2.0, 1e-3, 2.0)), pane);
    let (mesh, height) = (scene.nodes[0].mesh, |i: usize| DVec3::Y * (0.1 * i as f64));
    for i in 1..20 {
        let transform = NodeTransform::Matrix(DMat4::from_translation(height(i)));
        scene.roots.push(scene.nodes.len() as u32);
        scene.nodes.push(Node { mesh, transform, ..Node::default() });
    }
    let mut renderer = exact(scene, 16, 16);
    (renderer.settings.shadows.algorithm, renderer.settings.shadows.map_size) =
        (Shadows::MAP, 1024);
    renderer.lights = Some(vec![sun(DVec3::Y, 1.0)]);
    renderer.execution_mut().budget = Budget::default().with_memory_limit(Some(64 << 20));
    let error = renderer.render().unwrap_err().to_string();
    assert!(error.contains("shadow map"), "{error}");
    renderer.execution_mut().budget = Budget::default().with_memory_limit(Some(2 << 30));
    renderer.render().unwrap();
}
