//! Whitted's ray tracing in whole pictures: the notes' figures, laws of optics, and agreement with
//! the local models.

use super::common::{
    colors, exact, exact_builtin, largest_difference, on_z, one, pixel, poster, project, sun,
};
use std::sync::{Arc, Mutex};
use vitral::explain::{Deciders, explain};
use vitral::internals::render::registry::{SHADOWS, VISIBILITY};
use vitral::internals::render::stats::TracingCounters;
use vitral::internals::render::trace::{Observer, Step, Way};
use vitral::{
    Acceleration, AlphaMode, Background, Camera, DMat4, DVec3, Global, Light, LightKind, Material,
    Mesh, Projection, Reflectance, Renderer, Scene, Shadows, Transparency, Visibility, solids,
};

/// Glass that shows nothing of its own.
pub(super) fn glass(kt: f32, ior: f32) -> Material {
    let mut material = Material { alpha_mode: AlphaMode::Blend, ior, ..poster([0.0; 3]) };
    material.set_kt(kt);
    material
}

fn mirror() -> Material {
    let reflectance =
        Reflectance::Phong { ka: [0.0; 3], kd: [0.0; 3], ks: [1.0; 3], shininess: 200.0 };
    Material { reflectance, mirror: true, unlit: true, ..Material::default() }
}

pub(super) fn add(scene: &mut Scene, mut mesh: Mesh, material: Material, to: DMat4) {
    let material = Some(scene.add_material(material));
    mesh.parts.iter_mut().for_each(|p| p.material = material);
    scene.add_mesh(mesh, to);
}

fn at(x: f64, y: f64, z: f64) -> DMat4 {
    DMat4::from_translation(DVec3::new(x, y, z))
}

pub(super) fn traced(mut renderer: Renderer) -> Renderer {
    renderer.settings.global.model = Global::RayTrace;
    renderer.settings.shadows.algorithm = Shadows::RAY;
    renderer
}

/// Which channel is the brightest.
fn hue([r, g, b, _]: [u8; 4]) -> usize {
    (0..3).max_by_key(|&k| [r, g, b][k]).unwrap()
}

#[test]
fn t4_refraction_changes_which_polygon_is_seen_in_p_and_q() {
    let (p, q) = (DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.0, -1.0, 0.0));
    let seen = |mut r: Renderer| {
        let picture = colors(&mut r);
        [p, q].map(|point| hue(pixel(&r, &picture, point)))
    };
    // 3 is red, 4 is blue.
    assert_eq!(seen(exact_builtin("refraction", 200, 150)), [0, 2], "straight on");
    assert_eq!(seen(traced(exact_builtin("refraction", 200, 150))), [2, 0], "bent");
    // Bodies with the index of air bend nothing.
    let mut scene = vitral::load_builtin("refraction").unwrap();
    scene.materials.iter_mut().for_each(|m| m.ior = 1.0);
    let mut air = traced(exact(scene, 200, 150));
    air.camera = exact_builtin("refraction", 8, 8).camera;
    assert_eq!(seen(air), [0, 2]);
}

#[test]
fn t4_the_surface_under_p_and_q_is_told_with_the_way_of_its_rays() {
    let ids = |r: &Renderer, point: DVec3| {
        let p = project(r, point);
        let told = explain(r, &r.frame_camera(), [p.x as u32, p.y as u32], &Deciders::Chosen, None)
            .unwrap();
        let behind =
            told.surfaces.iter().find(|s| !s.layer).expect("something opaque lies straight on");
        (behind.surface, behind.material.clone(), told)
    };
    let (p, q) = (DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.0, -1.0, 0.0));
    let straight = exact_builtin("refraction", 60, 44);
    let [(under_p, of_p, told), (under_q, of_q, _)] = [p, q].map(|point| ids(&straight, point));
    assert_eq!((of_p.as_deref(), of_q.as_deref()), (Some("3"), Some("4")));
    assert!(told.rays.is_empty(), "no rays without ray tracing");

    let bent = traced(exact_builtin("refraction", 60, 44));
    for (point, expected) in [(p, under_q), (q, under_p)] {
        let (_, _, told) = ids(&bent, point);
        // The eye's ray, the one within the glass, and the one behind it.
        let met: Vec<_> =
            told.rays.iter().map(|ray| ray.meets.as_ref().map(|met| met.surface)).collect();
        assert_eq!(met.len(), 3, "{told}");
        assert_eq!(met[2], Some(expected), "{told}");
        assert!(told.rays[2].goes_on.is_empty() && told.rays[2].turns == 2);
        for (ray, indices) in told.rays.iter().zip([[1.0, 1.5], [1.5, 1.0]]) {
            let [turn] = &ray.goes_on[..] else { panic!("{told}") };
            assert_eq!((turn.way, turn.indices), (Way::Refracted, indices), "{told}");
            let [before, behind] = [0, 1].map(|k| {
                f64::from(turn.indices[k])
                    * vitral::internals::math::func::sin(turn.angles_degrees[k].to_radians())
            });
            assert!((before - behind).abs() < 1e-6, "{before} {behind}: {told}");
        }
        // The front stands upright, the back lies aslant.
        let [front, back] = [0, 1].map(|k| told.rays[k].goes_on[0].angles_degrees);
        assert!(front[0] < 1e-3 && back[0] > 20.0 && back[1] > back[0] + 10.0, "{told}");
        // What the rays add is the pixel.
        let mut renderer = traced(exact_builtin("refraction", 60, 44));
        let sum = [0, 1, 2].map(|k| told.rays.iter().map(|ray| ray.light[k]).sum::<f32>());
        let picture = colors(&mut renderer);
        let shown = pixel(&renderer, &picture, point);
        assert!(
            (0..3).all(|k| (sum[k] * 255.0 - f32::from(shown[k])).abs() <= 1.0),
            "{sum:?} {shown:?}: {told}"
        );
        let text = told.to_string();
        assert!(text.contains("refracted at") && text.contains("in 1.5"), "{text}");
    }
}

/// Keeps what rays meet.
#[derive(Debug, Default)]
struct Meetings(Mutex<Vec<Step>>);

impl Observer for Meetings {
    fn step(&self, step: &Step) {
        if matches!(step, Step::RayMeets { .. }) {
            self.0.lock().unwrap().push(step.clone());
        }
    }
}

#[test]
fn p36_the_id_in_a_mirror_is_that_of_the_virtual_image() {
    let (image, ball) = (DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0)), at(0.5, 0.2, 1.0));
    let facets = || solids::sphere(0.4, 16, 8);
    let scene = |with_mirror: bool| {
        let mut scene = Scene::default();
        if with_mirror {
            cuboid(&mut scene, DVec3::new(6.0, 6.0, 0.2), DVec3::new(0.0, 0.0, -0.1), mirror());
        } else {
            add(&mut scene, facets(), poster([1.0; 3]), image * ball);
        }
        add(&mut scene, facets(), poster([1.0; 3]), ball);
        let mut r = exact(scene, 120, 90);
        r.settings.cull.back_face = false;
        let camera = Camera {
            position: DVec3::new(-2.0, 0.6, 4.0),
            focal_point: DVec3::ZERO,
            ..on_z(4.0, 0.8)
        };
        r.camera = Some(camera);
        r
    };
    let mut virtual_image = scene(false);
    virtual_image.settings.picture.channels.surface = true;
    let ids = virtual_image.render().unwrap().frame.surface.unwrap().into_data();
    let of_ball =
        virtual_image.world().surface_of_facet(virtual_image.world().instances[1].first_facet);

    let mut mirrored = traced(scene(true));
    let meetings = Arc::new(Meetings::default());
    mirrored.execution_mut().observer = Some(Arc::clone(&meetings) as Arc<dyn Observer>);
    mirrored.render().unwrap();
    let first = mirrored.world().instances[1].first_facet;
    let of_facet =
        |facet| mirrored.world().surface_of_facet(facet) - mirrored.world().surface_of_facet(first);
    let (mut seen, mut different) = (0, 0);
    for step in meetings.0.lock().unwrap().iter() {
        let Step::RayMeets { pixel: [x, y], turns: 1, facet, .. } = step else { continue };
        let expected = ids[(y * 120 + x) as usize];
        // The ball itself may stand before its image.
        if expected < of_ball {
            seen += 1;
            different +=
                u32::from(facet.is_none_or(|facet| facet < first || of_facet(facet) != expected));
        }
    }
    assert!(seen > 150, "{seen}");
    assert!(different * 100 <= seen * 6, "{different} of {seen}, on edges");
}

#[test]
fn f11_a_glass_ball_inverts_what_is_behind_it() {
    let mut r = traced(exact_builtin("lens", 240, 180));
    let picture = colors(&mut r);
    // Beside the ball and through it, point by point: the colours of opposite quarters agree.
    for (x, y) in [(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
        let beside = pixel(&r, &picture, DVec3::new(2.2 * x, 1.2 * y, -4.0));
        let through = pixel(&r, &picture, DVec3::new(-0.35 * x, -0.35 * y, 0.0));
        let far = (0..3).map(|k| beside[k].abs_diff(through[k])).max().unwrap();
        assert!(far < 40, "{x} {y}: {beside:?} {through:?}");
    }
    assert!(r.render().unwrap().stats.tracing.total_reflections < 1000);
}

#[test]
fn t5_a_slab_moves_what_is_behind_by_the_formula() {
    // A white bar behind a slab that is turned by 40 degrees, seen by parallel rays.
    let (thick, angle) = (1.0f64, 40f64.to_radians());
    let mut scene = Scene::default();
    add(
        &mut scene,
        solids::cuboid(DVec3::new(0.4, 4.0, 0.1)),
        poster([1.0; 3]),
        at(0.0, 0.0, -4.0),
    );
    let slab = solids::cuboid(DVec3::new(6.0, 4.0, thick));
    add(&mut scene, slab, glass(1.0, 1.5), DMat4::from_rotation_y(angle));
    let mut r = exact(scene, 400, 100);
    let projection = Projection::Parallel { height: 1.0 };
    r.camera = Some(Camera { projection, ..on_z(8.0, 1.0) });
    let center = |picture: &[[u8; 4]]| {
        let row = &picture[50 * 400..51 * 400];
        let lit: Vec<usize> = (0..400).filter(|&x| row[x][0] > 127).collect();
        assert!(lit.len() > 30, "{}", lit.len());
        lit.iter().sum::<usize>() as f64 / lit.len() as f64 + 0.5
    };
    let straight = center(&colors(&mut r));
    let bent = center(&colors(&mut traced(r)));
    let sin_r = vitral::internals::math::func::sin(angle) / 1.5;
    let r_angle = vitral::internals::math::func::asin(sin_r);
    let offset = thick * vitral::internals::math::func::sin(angle - r_angle)
        / vitral::internals::math::func::cos(r_angle);
    assert!(
        ((bent - straight).abs() - offset * 100.0).abs() < 1.0,
        "{straight} {bent}, {}",
        offset * 100.0
    );
}

#[test]
fn t3_red_green_and_blue_are_bent_alike() {
    // A wedge before posters of one channel each: an edge of a colour appears where that of any
    // other does.
    let picture = |color: [f32; 3]| {
        let mut scene = Scene::default();
        add(
            &mut scene,
            solids::cuboid(DVec3::new(0.7, 0.9, 0.1)),
            poster(color),
            at(0.3, 0.2, -4.0),
        );
        let ball = glass(1.0, 1.5);
        add(&mut scene, solids::sphere(1.0, 48, 24), ball, DMat4::IDENTITY);
        let mut r = exact(scene, 90, 70);
        r.camera = Some(on_z(5.0, 0.5));
        let straight = colors(&mut r);
        (colors(&mut traced(r)), straight)
    };
    let (white, straight) = picture([1.0; 3]);
    assert!(white.iter().all(|p| p[0] == p[1] && p[1] == p[2]), "white stays white");
    for k in 0..3 {
        let mut one = [0.0; 3];
        one[k] = 1.0;
        let own = picture(one).0;
        assert!(own.iter().zip(&white).all(|(own, white)| own[k] == white[k]), "channel {k}");
        assert!(
            own.iter().all(|p| (0..3).all(|other| other == k || p[other] == 0)),
            "channel {k} alone"
        );
    }
    assert!(differing(&white, &straight, 100) > 100, "it is bent at all");
}

#[test]
fn p36_a_mirror_shows_the_virtual_image() {
    // A coloured ball in front of a mirror in the plane z = 0, seen against its image.
    let ball = |z: f64, scene: &mut Scene| {
        add(scene, solids::sphere(0.4, 64, 32), poster([0.9, 0.3, 0.1]), at(0.5, 0.2, z));
    };
    let camera =
        Camera { position: DVec3::new(-2.0, 0.6, 4.0), focal_point: DVec3::ZERO, ..on_z(4.0, 0.8) };
    let wall = || solids::cuboid(DVec3::new(6.0, 6.0, 0.2));
    let mut mirrored = Scene::default();
    add(&mut mirrored, wall(), mirror(), at(0.0, 0.0, -0.1));
    ball(1.0, &mut mirrored);
    let mut mirrored = traced(exact(mirrored, 120, 90));
    let mut virtual_image = Scene::default();
    ball(1.0, &mut virtual_image);
    ball(-1.0, &mut virtual_image);
    let mut virtual_image = exact(virtual_image, 120, 90);
    for r in [&mut mirrored, &mut virtual_image] {
        r.camera = Some(camera);
    }
    let (a, b) = (colors(&mut mirrored), colors(&mut virtual_image));
    let different = a.iter().zip(&b).filter(|(a, b)| a != b).count();
    assert!(different < 12, "{different} pixels, all of them on the outline");
    assert!(b.iter().filter(|p| p[0] > 0).count() > 300);
}

#[test]
fn opaque_surfaces_look_as_without_ray_tracing() {
    for name in ["scene0", "scene1", "cubs", "teapot"] {
        for samples in [1, 4] {
            let mut local = exact_builtin(name, 96, 72);
            (local.settings.shadows.algorithm, local.settings.picture.samples) =
                ("ray".parse().unwrap(), samples);
            let expected = colors(&mut local);
            assert!(colors(&mut traced(local)) == expected, "{name}, {samples}");
        }
    }
}

/// Panes one behind the other, and something lit behind them.
fn panes(count: usize, ior: f32) -> Scene {
    let mut scene = Scene::default();
    add(&mut scene, solids::cuboid(DVec3::splat(2.0)), poster([1.0, 0.6, 0.2]), at(0.0, 0.0, -3.0));
    for i in 0..count {
        let pane = Material { filter: [1.0, 0.5, 0.8], ..glass(0.7, ior) };
        let quad = solids::plane(6.0, 6.0, 1, 1);
        add(
            &mut scene,
            quad,
            pane,
            at(0.0, 0.0, i as f64 * 0.3) * DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2),
        );
    }
    scene
}

#[test]
fn t7_straight_through_any_number_of_panes_is_the_same_as_sorting_them() {
    for count in 1..=12 {
        for model in
            [Transparency::Linear, Transparency::Kay, Transparency::Filtered, Transparency::None]
        {
            // Sheets have no inside: their index does not matter.
            let mut sorted = exact(panes(count, 1.5), 40, 30);
            sorted.camera = Some(on_z(9.0, 0.6));
            sorted.settings.transparency.model = model;
            let expected = colors(&mut sorted);
            let own = colors(&mut traced(sorted));
            assert!(largest_difference(&own, &expected) <= 1, "{count} panes, {model:?}");
        }
    }
}

/// Some colour of its own, and `kt` of what is behind.
pub(super) fn tinted(color: [f32; 3], kt: f32, ior: f32) -> Material {
    let mut material = Material { alpha_mode: AlphaMode::Blend, ior, ..poster(color) };
    material.set_kt(kt);
    material
}

pub(super) fn cuboid(scene: &mut Scene, size: DVec3, center: DVec3, material: Material) {
    add(scene, solids::cuboid(size), material, DMat4::from_translation(center));
}

/// A camera above the floor on which things stand.
pub(super) fn above() -> Camera {
    Camera {
        position: DVec3::new(3.0, 4.1, 5.2),
        focal_point: DVec3::new(0.0, 0.2, 0.0),
        ..on_z(6.0, 0.7)
    }
}

/// Pixels of two pictures that differ by more than a step in any channel.
pub(super) fn differing(a: &[[u8; 4]], b: &[[u8; 4]], step: u8) -> usize {
    a.iter().zip(b).filter(|(a, b)| (0..4).any(|k| a[k].abs_diff(b[k]) > step)).count()
}

#[test]
fn backgrounds_are_seen_through_glass_as_they_are() {
    let gradient = Background::Gradient { top: [0.9, 0.2, 0.1], bottom: [0.1, 0.3, 0.9] };
    for background in [Background::Transparent, gradient] {
        let mut sorted = exact(panes(3, 1.0), 60, 50);
        sorted.camera = Some(on_z(9.0, 0.9));
        sorted.settings.picture.background = background;
        let expected = colors(&mut sorted);
        assert!(largest_difference(&colors(&mut traced(sorted)), &expected) <= 1, "{background:?}");
    }
}

#[test]
fn shadows_of_coloured_glass_have_its_colour() {
    let mut scene = Scene::default();
    let white = Material {
        reflectance: Reflectance::Phong {
            ka: [0.0; 3],
            kd: [1.0; 3],
            ks: [0.0; 3],
            shininess: 1.0,
        },
        ..Material::default()
    };
    add(&mut scene, solids::plane(8.0, 8.0, 1, 1), white, DMat4::IDENTITY);
    let red = Material { filter: [1.0, 0.25, 0.0], ..glass(0.8, 1.0) };
    add(&mut scene, solids::plane(2.0, 2.0, 1, 1), red, at(0.0, 1.0, 0.0));
    let mut r = traced(exact(scene, 100, 100));
    r.settings.transparency.model = Transparency::Filtered;
    r.lights = Some(vec![sun(DVec3::new(1.0, 1.0, 0.0), 1.0)]);
    let eye =
        Camera { position: DVec3::new(0.0, 6.0, 6.0), focal_point: DVec3::ZERO, ..on_z(6.0, 1.0) };
    r.camera = Some(eye);
    let picture = colors(&mut r);
    // The pane's shadow lies one to the left of it.
    let shadow = pixel(&r, &picture, DVec3::new(-1.6, 0.0, 0.0));
    let lit = pixel(&r, &picture, DVec3::new(2.5, 0.0, 0.0));
    let share = |k: usize| f64::from(shadow[k]) / f64::from(lit[k]);
    assert!(
        (share(0) - 0.8).abs() < 0.02 && (share(1) - 0.2).abs() < 0.02 && shadow[2] == 0,
        "{shadow:?} {lit:?}"
    );
}

#[test]
fn every_visibility_algorithm_and_thread_count_gives_the_same_picture() {
    let mut r = traced(exact_builtin("mirrors", 80, 60));
    r.settings.picture.samples = 2;
    let expected = colors(&mut r);
    for algorithm in VISIBILITY {
        r.settings.visibility = algorithm.choice();
        let own = colors(&mut r);
        let different = own.iter().zip(&expected).filter(|(a, b)| a != b).count();
        assert!(different <= 4, "{}: {different}", algorithm.name);
    }
    r.settings.visibility = Visibility::Z_BUFFER;
    for threads in [1, 2, 5] {
        let mut execution = vitral::execution(threads);
        for (_, level) in vitral::internals::math::lanes::available_levels() {
            execution.level = level;
            let scene = vitral::load_builtin("mirrors").unwrap();
            let mut other = Renderer::with_execution(scene, execution.clone()).unwrap();
            (other.settings, other.camera) = (r.settings.clone(), r.camera);
            assert!(colors(&mut other) == expected, "{threads} threads, {level:?}");
        }
    }
}

#[test]
fn every_shadow_algorithm_serves_what_rays_hit() {
    let scene = || exact_builtin("mirrors", 96, 72);
    let [rays, none] = ["ray", "none"].map(|shadows| {
        let mut r = traced(scene());
        r.settings.shadows.algorithm = shadows.parse().unwrap();
        colors(&mut r)
    });
    let differing = |a: &[[u8; 4]], b: &[[u8; 4]]| {
        let apart = |(a, b): &(&[u8; 4], &[u8; 4])| (0..3).any(|k| a[k].abs_diff(b[k]) > 2);
        a.iter().zip(b).filter(apart).count() as f64 / a.len() as f64
    };
    assert!(differing(&rays, &none) > 0.05);
    for shadows in SHADOWS.iter().filter(|s| s.name != "none") {
        let mut r = traced(scene());
        r.settings.shadows.algorithm = shadows.name.parse().unwrap();
        // Maps differ within texels of a shadow's edge.
        let allowed = if shadows.name == "map" { 0.02 } else { 0.001 };
        let differing = differing(&rays, &colors(&mut r));
        assert!(differing <= allowed, "{}: {differing}", shadows.name);
    }
}

#[test]
fn total_internal_reflection_and_the_most_turns() {
    // From inside a block of glass the camera sees its side at a flat angle: everything is
    // mirrored.
    let mut scene = Scene::default();
    add(&mut scene, solids::cuboid(DVec3::splat(4.0)), glass(1.0, 1.5), DMat4::IDENTITY);
    let mut r = traced(exact(scene, 16, 16));
    r.settings.picture.background = Background::Color { color: [1.0; 3] };
    r.camera = Some(Camera {
        position: DVec3::new(0.0, 0.0, 1.0),
        focal_point: DVec3::new(1.0, 1.0, 0.0),
        ..on_z(1.0, 0.1)
    });
    let tracing = r.render().unwrap().stats.tracing;
    // The diagonal meets all sides beyond the critical angle of 41.8 degrees: 54.7.
    assert_eq!((tracing.refracted, tracing.stopped_by_depth), (0, 256));
    assert_eq!(tracing.total_reflections, 256 * 9);
    r.settings.global.max_depth = 2;
    assert_eq!(r.render().unwrap().stats.tracing.total_reflections, 256 * 3);
    // What is not followed to its end is black, not a hole in the picture.
    assert!(colors(&mut r).iter().all(|p| *p == [0, 0, 0, 255]));
}

#[test]
fn a_bubble_of_air_in_glass_bends_light() {
    let picture = |air: f32| {
        let mut scene = Scene::default();
        for k in 0..8 {
            let center = DVec3::new(-3.5 + k as f64, 0.0, -4.0);
            cuboid(
                &mut scene,
                DVec3::new(0.5, 8.0, 0.1),
                center,
                poster([1.0, 0.1 * k as f32, 0.1]),
            );
        }
        add(&mut scene, solids::sphere(1.0, 48, 24), glass(1.0, 1.5), DMat4::IDENTITY);
        add(&mut scene, solids::sphere(0.8, 48, 24), glass(1.0, air), DMat4::IDENTITY);
        let mut r = traced(exact(scene, 80, 60));
        r.camera = Some(on_z(4.0, 0.6));
        colors(&mut r)
    };
    // An index of exactly 1 is like one next to it, and not like no bubble.
    assert!(differing(&picture(1.0), &picture(1.0001), 4) < 20);
    assert!(differing(&picture(1.0), &picture(1.5), 4) > 400);
}

#[test]
fn faint_panes_before_a_bright_light_are_seen_through() {
    let mut scene = panes(12, 1.0);
    scene.materials[0].emission = [50.0; 3];
    scene.materials[1..].iter_mut().for_each(|m| m.set_kt(0.5));
    let mut sorted = exact(scene.clone(), 8, 8);
    let mut r = traced(exact(scene, 8, 8));
    for r in [&mut sorted, &mut r] {
        r.camera = Some(on_z(4.0, 0.1));
    }
    let (a, b) = (colors(&mut sorted), colors(&mut r));
    assert!(a[9][0] > 2 && largest_difference(&a, &b) <= 1, "{:?} {:?}", a[9], b[9]);
}

#[test]
fn kays_sheets_let_the_same_light_through_with_and_without_rays() {
    let mut scene = panes(3, 1.0);
    scene.materials.iter_mut().for_each(|m| m.alpha_mode = AlphaMode::Blend);
    let camera = Camera { position: DVec3::new(3.0, 2.0, 5.0), ..on_z(1.0, 0.9) };
    let picture = |mut r: Renderer| {
        r.settings.transparency.model = Transparency::Kay;
        r.camera = Some(camera);
        colors(&mut r)
    };
    let (flat, rays) =
        (picture(exact(scene.clone(), 64, 48)), picture(traced(exact(scene, 64, 48))));
    assert!(largest_difference(&flat, &rays) <= 1);
}

#[test]
fn bad_indices_of_refraction_are_refused() {
    for ior in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let mut r = traced(exact(one(solids::sphere(1.0, 8, 4), glass(0.5, ior)), 8, 8));
        let error = r.render().unwrap_err().to_string();
        assert!(error.contains("index of refraction") && error.contains("above 0"), "{error}");
    }
    let mut open = traced(exact(panes(1, 1.5), 8, 8));
    assert!(open.render().unwrap().warnings[0].contains("not closed"));
    open.settings.global.max_depth = 0;
    assert!(open.render().unwrap_err().to_string().contains("1 to 64"));
}

#[test]
fn limits_stop_the_rays() {
    let mut r = traced(exact_builtin("mirrors", 64, 48));
    r.execution_mut().budget = r.execution().budget.renewed().with_memory_limit(Some(1 << 20));
    assert!(r.render().is_err());
    r.execution_mut().budget =
        r.execution().budget.renewed().with_memory_limit(None).with_time_limit(Some(1e-9));
    assert!(r.render().is_err());
    let light = Light { kind: LightKind::Ambient, ..Light::default() };
    (r.lights, r.execution_mut().budget) =
        (Some(vec![light]), r.execution().budget.renewed().with_time_limit(None));
    assert!(r.render().is_ok());
}

#[test]
fn the_eye_is_in_what_stands_round_it() {
    // In a tank of water, a ball of water is not seen: nothing bends light.
    let picture = |ball: f32, inside: bool| {
        let mut scene = Scene::default();
        for k in 0..8 {
            let center = DVec3::new(-3.5 + k as f64, 0.0, -4.0);
            cuboid(
                &mut scene,
                DVec3::new(0.5, 8.0, 0.1),
                center,
                poster([1.0, 0.1 * k as f32, 0.1]),
            );
        }
        if inside {
            cuboid(&mut scene, DVec3::splat(11.0), DVec3::ZERO, glass(1.0, 1.33));
        }
        add(&mut scene, solids::sphere(1.0, 48, 24), glass(1.0, ball), DMat4::IDENTITY);
        let mut r = traced(exact(scene, 80, 60));
        r.camera = Some(on_z(4.0, 0.9));
        colors(&mut r)
    };
    let seen = |a: &[[u8; 4]], b: &[[u8; 4]]| differing(a, b, 1);
    let straight = picture(1.0, false);
    assert!(
        seen(&picture(1.33, false), &straight) > 300,
        "in air the ball bends what is behind it"
    );
    let found = seen(&picture(1.33, true), &straight);
    assert!(found <= 4, "in water it does not: {found}");
    assert!(seen(&picture(1.001, true), &straight) > 300, "a bubble does");
}

#[test]
fn p15_p16_every_structure_serves_all_rays_with_the_same_picture() {
    // Boxes of glass that touch, four sheets of coloured glass over them, and a mirror: piles,
    // bodies, products of shadows.
    let touching = || {
        let mut scene = Scene::default();
        cuboid(
            &mut scene,
            DVec3::splat(1.0),
            DVec3::new(-0.5, 0.5, 0.0),
            tinted([0.8, 0.2, 0.2], 0.7, 1.5),
        );
        cuboid(
            &mut scene,
            DVec3::splat(1.0),
            DVec3::new(0.5, 0.5, 0.0),
            tinted([0.2, 0.2, 0.8], 0.6, 1.33),
        );
        for k in 0..4 {
            let filter = [0.9 - 0.1 * k as f32, 0.37, 0.5 + 0.1 * k as f32];
            let sheet = Material { filter, ..tinted([0.1, 0.1, 0.1], 0.83, 1.0) };
            add(
                &mut scene,
                solids::plane(2.3, 2.1, 1, 1),
                sheet,
                at(0.2, 1.5 + 0.2 * f64::from(k), 0.3),
            );
        }
        add(
            &mut scene,
            solids::plane(7.0, 7.0, 3, 2),
            Material::default(),
            DMat4::from_rotation_y(0.2),
        );
        cuboid(&mut scene, DVec3::new(3.0, 2.0, 0.1), DVec3::new(0.0, 1.0, -1.5), mirror());
        let mut r = exact(scene, 80, 60);
        r.camera = Some(above());
        r.settings.transparency.model = Transparency::Filtered;
        r.lights =
            Some(vec![sun(DVec3::new(0.3, 1.0, 0.2), 1.0), sun(DVec3::new(-0.5, 0.8, 0.9), 0.5)]);
        r
    };
    // The eye within glass: what it is in is asked of all that a ray meets.
    let within = || {
        let mut r = touching();
        r.camera = Some(Camera {
            position: DVec3::new(0.4, 0.4, 0.3),
            focal_point: DVec3::new(-3.0, 0.6, -1.0),
            ..above()
        });
        r
    };
    let scenes: [(&str, &dyn Fn() -> Renderer); 3] = [
        ("mirrors", &|| exact_builtin("mirrors", 16, 12)),
        ("touching", &touching),
        ("within", &within),
    ];
    for (name, scene) in scenes {
        for global in [Global::None, Global::RayTrace] {
            let picture = |acceleration| {
                let mut r = scene();
                (r.settings.global.model, r.settings.shadows.algorithm) =
                    (global, "ray".parse().unwrap());
                r.settings.acceleration = acceleration;
                let rendered = r.render().unwrap();
                let tests = TracingCounters {
                    box_tests: 0,
                    triangle_tests: 0,
                    rays_per_second: 0.0,
                    ..rendered.stats.tracing
                };
                (rendered.frame, tests, rendered.stats.tracing.triangle_tests)
            };
            let (expected, counters, _) = picture(None);
            let asked = picture(Some(Acceleration::NONE)).2;
            assert!(global == Global::None || counters.hits > 20, "{name}: {counters:?}");
            let wrong = |structure: &Acceleration| {
                let (frame, counted, tests) = picture(Some(*structure));
                let saves = structure.asks_all || tests < asked || asked == 0;
                frame != expected || counted != counters || !saves
            };
            let wrong: Vec<_> =
                Acceleration::all().filter(wrong).map(|structure| structure.name).collect();
            assert!(wrong.is_empty(), "{name}, {global:?}: {wrong:?}");
        }
    }
}
