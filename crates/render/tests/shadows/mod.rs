//! Shadows: what the definitions say, by arithmetic where there is a formula.

mod area;
mod cascades;
mod exact;
mod maps;
mod transparent;

use std::sync::Arc;
use vitral_exec::{Budget, Limit, Workers};
use vitral_frame::Frame;
use vitral_light::{AlphaMode, AreaShape, Light, LightKind, Material, Rgb};
use vitral_math::lanes::available_levels;
use vitral_math::{DMat4, DVec3, DVec4, dvec3};
use vitral_render::raytrace::triangles::Triangles;
use vitral_render::shadow::{self, Drawn, LightVisibility, SurfacePoint, SurfacePoints};
use vitral_render::{
    Channels, Execution, PictureSettings, Session, Settings, Shading, ShadowSettings, Shadows,
    Shot, Surroundings, TransparencySettings, VolumeCounting, registry, render,
};
use vitral_scene::builtin::{self, solids};
use vitral_scene::{Camera, Mesh, Part, Projection, Scene};

fn light(kind: LightKind) -> Light {
    Light { kind, ..Light::default() }
}

fn sun(direction: DVec3) -> Light {
    light(LightKind::Directional { direction })
}

fn lamp(position: DVec3) -> Light {
    light(LightKind::Point { position })
}

/// All that find shadows.
fn names() -> impl Iterator<Item = &'static str> {
    registry::SHADOWS.iter().filter(|s| s.algorithm.is_some()).map(|s| s.name)
}

fn settings(shadows: &str) -> Settings {
    Settings::default().with_shadows(shadows.parse().unwrap()).with_size(160, 120).with_samples(1)
}

/// Where shadows are looked at from, where that is not what a test is about.
const VIEWER: DVec4 = DVec4::new(1.7, 5.3, 9.1, 1.0);

/// Asks the algorithm `shadows` about red light of the first of `lights`.
fn with_shadows<R>(
    scene: &Scene,
    lights: &[Light],
    settings: &Settings,
    ask: impl FnOnce(&dyn Fn(SurfacePoint) -> f32) -> R,
) -> R {
    with_colored_shadows(scene, lights, settings, |arriving| ask(&|place| arriving(place)[0]))
}

/// Asks the algorithm `shadows` about the first of `lights`.
fn with_colored_shadows<R>(
    scene: &Scene,
    lights: &[Light],
    settings: &Settings,
    ask: impl FnOnce(&dyn Fn(SurfacePoint) -> Rgb) -> R,
) -> R {
    let session = Session::new(Arc::new(scene.clone())).unwrap();
    let algorithm = registry::shadows(settings.shadows.algorithm).unwrap();
    let execution = Execution::default();
    let ready: Box<dyn shadow::PreparedShadows> =
        algorithm.prepare(&session, lights, VIEWER, settings, &execution).unwrap();
    let center = Triangles::center_of(session.world());
    ask(&|place| {
        let facet =
            if place.facet == u32::MAX { facet_at(&session, place.position) } else { place.facet };
        let places: SurfacePoints =
            [SurfacePoint { position: place.position - center, facet, ..place }]
                .into_iter()
                .collect();
        let mut parts = LightVisibility::new(1, [f32::NAN; 3]);
        ready.light_visibility(0, &places, &mut parts, &mut 0);
        parts.get(0)
    })
}

/// The facet that a position is on.
fn facet_at(session: &Session, position: DVec3) -> u32 {
    for instance in &session.world().instances {
        for (facet, t) in (instance.first_facet..).zip(&instance.mesh.triangles) {
            let [a, b, c] = t.map(|i| {
                let [x, y, z] = instance.mesh.positions[i as usize].map(f64::from);
                instance.world_from_model.transform_point3(dvec3(x, y, z)) - position
            });
            let normal = (b - a).cross(c - a);
            let inside =
                [(a, b), (b, c), (c, a)].iter().all(|(p, q)| p.cross(*q).dot(normal) >= -1e-9);
            if inside && normal.dot(a).abs() < 1e-9 {
                return facet;
            }
        }
    }
    u32::MAX
}

/// A place in the world, on whatever facet is there.
fn place(position: DVec3, normal: DVec3) -> SurfacePoint {
    SurfacePoint { position, normal, facet: u32::MAX, seed: 1, pixel: Some([0.5; 2]) }
}

fn add(scene: &mut Scene, mut mesh: Mesh, material: Material, at: DVec3) {
    let material = Some(scene.add_material(material));
    mesh.parts.iter_mut().for_each(|p| p.material = material);
    scene.add_mesh(mesh, DMat4::from_translation(at));
}

/// A floor of side 8 in the plane y = 0, and what is above it.
fn above_floor(mesh: Mesh, material: Material, at: DVec3) -> Scene {
    let mut scene = Scene::default();
    add(&mut scene, solids::plane(8.0, 8.0, 1, 1), Material::default(), DVec3::ZERO);
    add(&mut scene, mesh, material, at);
    scene
}

fn camera(scene: &Scene, from: DVec3) -> Camera {
    let bounds = Session::new(Arc::new(scene.clone())).unwrap().world().bounds;
    Camera {
        position: bounds.center() + from * bounds.diagonal(),
        focal_point: bounds.center(),
        view_up: DVec3::Y,
        projection: Projection::Perspective { view_angle: 0.8 },
        clip: None,
    }
}

fn picture(scene: &Scene, lights: &[Light], settings: &Settings, execution: &Execution) -> Frame {
    let mut session = Session::new(Arc::new(scene.clone())).unwrap();
    let camera = camera(scene, dvec3(0.6, 0.5, 0.9));
    let shot = Shot { camera, lights, ambient: [0.2; 3], surroundings: Surroundings::default() };
    render(&mut session, &shot, settings, execution).unwrap().frame
}

#[test]
fn a_ball_throws_a_round_shadow() {
    // The lamp at height 4, the ball at 2: its shadow is the cone that touches it, cut by the
    // floor.
    let scene =
        above_floor(solids::sphere(0.5, 192, 96), Material::default(), dvec3(0.0, 2.0, 0.0));
    let sine = 0.5 / 2.0f64;
    let radius = 4.0 * sine / (1.0 - sine * sine).sqrt();
    with_shadows(&scene, &[lamp(dvec3(0.0, 4.0, 0.0))], &settings("ray"), |arriving| {
        for i in 0..64 {
            let (sin, cos) = vitral_math::func::sin_cos(f64::from(i) * 0.1);
            let at = |r: f64| arriving(place(dvec3(cos * r, 0.0, sin * r), DVec3::Y));
            assert_eq!((at(radius * 0.995), at(radius * 1.005)), (0.0, 1.0), "{i}");
        }
        assert_eq!(arriving(place(dvec3(3.0, 0.0, 0.0), DVec3::NEG_Y)), 0.0, "attached");
    });
}

#[test]
fn nothing_shades_itself() {
    for offset in [0.0, 3e4] {
        let ball = solids::sphere(1.0, 40, 20);
        let mut scene = Scene::default();
        scene.add_mesh(ball.clone(), DMat4::from_translation(DVec3::splat(offset)));
        let (center, far) = (DVec3::splat(offset), dvec3(7.0, 30.0, 5.0));
        with_shadows(&scene, &[lamp(center + far)], &settings("ray"), |arriving| {
            let mut lit = 0;
            for (facet, t) in (0..).zip(&ball.triangles) {
                let [a, b, c] = t.map(|i| {
                    let [x, y, z] = ball.positions[i as usize].map(f64::from);
                    dvec3(x, y, z)
                });
                let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
                for [u, v] in [[0.3, 0.3], [0.0, 0.5], [0.0, 0.0], [0.999, 0.001]] {
                    let p = a + (b - a) * u + (c - a) * v;
                    // Corners of a ball far away are rounded: ask where the light is well in front.
                    if normal.dot((far - p).normalize()) < 0.02 {
                        continue;
                    }
                    let part = arriving(SurfacePoint {
                        position: p + center,
                        normal,
                        facet,
                        seed: 0,
                        pixel: Some([0.5; 2]),
                    });
                    assert_eq!(part, 1.0, "facet {facet} at {p}");
                    lit += 1;
                }
            }
            assert!(lit > 1000);
        });
    }
}

#[test]
fn f18_attached_shadows_face_away_and_cast_shadows_are_hidden() {
    let channels = Channels {
        color: false,
        normal: true,
        attached_shadow: true,
        cast_shadow: true,
        ..Channels::default()
    };
    let settings = settings("ray").with_channels(channels);
    let towards = dvec3(-1.0, 2.0, -0.5).normalize();
    let scene = above_floor(solids::cuboid(DVec3::ONE), Material::default(), dvec3(0.0, 1.5, 0.0));
    let frame = picture(&scene, &[sun(-towards)], &settings, &Execution::default());
    let (normals, attached) = (frame.normal.unwrap(), frame.attached_shadow.unwrap());
    let cast = frame.cast_shadow.unwrap();
    let mut counts = [0; 3];
    for ((n, &attached), &cast) in normals.data().iter().zip(attached.data()).zip(cast.data()) {
        let n = dvec3(f64::from(n[0]), f64::from(n[1]), f64::from(n[2]));
        let away = n != DVec3::ZERO && n.dot(towards) <= 0.0;
        assert_eq!(attached, f32::from(u8::from(away)));
        assert!(
            cast == 0.0 || (cast == 1.0 && attached == 0.0 && n.y > 0.9),
            "only the floor lies in a cast shadow"
        );
        let which = [attached == 1.0, cast == 1.0, n != DVec3::ZERO && attached + cast == 0.0];
        (0..3).for_each(|k| counts[k] += usize::from(which[k]));
    }
    assert!(counts.iter().all(|&c| c > 50), "{counts:?}");
}

#[test]
fn f20_a_light_that_does_not_arrive_leaves_ambient_light_alone() {
    let scene = above_floor(solids::cuboid(DVec3::ONE), Material::default(), dvec3(0.0, 1.5, 0.0));
    let light = Light { ambient: [0.1; 3], ..lamp(dvec3(2.0, 6.0, 1.0)) };
    let dark = Light { diffuse: [0.0; 3], specular: [0.0; 3], ..light.clone() };
    let data =
        Channels { color: true, attached_shadow: true, cast_shadow: true, ..Channels::default() };
    for (shading, algorithm) in Shading::ALL.iter().flat_map(|s| names().map(move |name| (s, name)))
    {
        let settings = settings(algorithm).with_channels(data).with_shading(shading.0);
        let execution = Execution::default();
        let shaded = picture(&scene, std::slice::from_ref(&light), &settings, &execution);
        let unlit = picture(&scene, std::slice::from_ref(&dark), &settings, &execution);
        let plain = picture(
            &scene,
            std::slice::from_ref(&light),
            &settings.clone().with_shadows(Shadows::NONE).with_channels(Channels::default()),
            &execution,
        );
        let [shaded_color, unlit, plain] =
            [&shaded, &unlit, &plain].map(|f| f.color.clone().unwrap());
        let cast = shaded.cast_shadow.unwrap();
        let attached = shaded.attached_shadow.unwrap();
        let mut counts = [0; 2];
        for i in 0..cast.data().len() {
            let expected = if cast.data()[i] == 1.0 {
                counts[0] += 1;
                unlit.data()[i]
            } else if attached.data()[i] + cast.data()[i] == 0.0 {
                counts[1] += 1;
                plain.data()[i]
            } else {
                continue;
            };
            assert_eq!(shaded_color.data()[i], expected, "{}", shading.1);
        }
        assert!(counts[0] > 100 && counts[1] > 1000, "{counts:?}");
    }
}

/// The inside of a cube of side 10.
fn hollow() -> Scene {
    let mut mesh = solids::cuboid(DVec3::splat(10.0));
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh.normals = None;
    Scene::from_mesh(Mesh { faces: Default::default(), ..mesh })
}

#[test]
fn what_a_lamp_is_fixed_to_does_not_hide_it_at_grazing_angles() {
    let (scene, lamp) = (hollow(), lamp(dvec3(0.3, 5.0, 0.2)));
    for algorithm in names().filter(|&name| name != "map") {
        with_shadows(&scene, std::slice::from_ref(&lamp), &settings(algorithm), |arriving| {
            for i in 0..4000 {
                let (x, below) =
                    (f64::from(i % 200) * 0.0199 - 1.97, f64::from(i / 200 + 1) * 0.003);
                let p = dvec3(x, 5.0 - below, -5.0);
                assert_eq!(arriving(place(p, DVec3::Z)), 1.0, "{algorithm}: {p}");
            }
        });
    }
}

#[test]
fn f18_a_surface_with_the_lamp_in_its_plane_is_in_its_own_shadow() {
    let channels = Channels {
        color: false,
        normal: true,
        attached_shadow: true,
        cast_shadow: true,
        ..Channels::default()
    };
    let camera = Camera {
        position: dvec3(1.1, -0.3, 3.7),
        focal_point: dvec3(0.4, 5.0, -1.3),
        view_up: DVec3::Y,
        projection: Projection::Perspective { view_angle: 1.0 },
        clip: None,
    };
    let mut session = Session::new(Arc::new(hollow())).unwrap();
    let shot = Shot {
        camera,
        lights: &[lamp(dvec3(0.3, 5.0, 0.2))],
        ambient: [0.0; 3],
        surroundings: Surroundings::default(),
    };
    let settings = settings("ray").with_channels(channels);
    let frame = render(&mut session, &shot, &settings, &Execution::default()).unwrap().frame;
    let (normals, attached, cast) =
        (frame.normal.unwrap(), frame.attached_shadow.unwrap(), frame.cast_shadow.unwrap());
    let ceiling: Vec<_> =
        (0..normals.data().len()).filter(|&i| normals.data()[i][1] < -0.9).collect();
    assert!(ceiling.len() > 5000, "{}", ceiling.len());
    let rounding =
        ceiling.iter().filter(|&&i| (attached.data()[i], cast.data()[i]) != (1.0, 0.0)).count();
    assert_eq!(rounding, 0, "of {}", ceiling.len());
}

#[test]
fn nothing_is_in_a_cast_shadow_beside_the_cone_of_a_spot() {
    let scene = above_floor(solids::cuboid(DVec3::ONE), Material::default(), dvec3(0.0, 1.5, 0.0));
    let cast = |algorithm: &str, direction: DVec3| {
        let (cutoff, position) = (0.15, dvec3(0.0, 5.0, 0.0));
        let spot =
            light(LightKind::Spot { position, direction, cutoff, inner: cutoff, exponent: 0.0 });
        let channels = Channels { color: false, cast_shadow: true, ..Channels::default() };
        let settings = Settings {
            picture: PictureSettings { channels, ..settings(algorithm).picture },
            shadows: ShadowSettings { map_size: 512, ..settings(algorithm).shadows },
            ..settings(algorithm)
        };
        let frame = picture(&scene, &[spot], &settings, &Execution::default());
        frame.cast_shadow.unwrap().data().iter().filter(|&&part| part > 0.5).count() as f64
    };
    let rays = cast("ray", DVec3::NEG_Y);
    assert!(rays > 50.0, "{rays} pixels of the floor are below the box");
    for algorithm in names() {
        assert_eq!(cast(algorithm, DVec3::Y), 0.0, "{algorithm}: it shines away");
        let found = cast(algorithm, DVec3::NEG_Y);
        assert!((found / rays - 1.0).abs() < 0.1, "{algorithm}: {found} pixels, by rays {rays}");
    }
}

#[test]
fn maps_of_a_scene_far_from_the_origin_are_those_of_one_near_it() {
    let far = 1e5;
    let scene = |from: f32| {
        let mut scene =
            above_floor(solids::cuboid(DVec3::ONE), Material::default(), dvec3(0.0, 1.5, 0.0));
        for mesh in &mut scene.meshes {
            Arc::make_mut(mesh).positions.iter_mut().flatten().for_each(|k| *k += from);
        }
        scene
    };
    for light in [sun(dvec3(-0.4, -1.0, -0.3)), lamp(dvec3(0.3, 4.0, 1.0))] {
        let moved = light.transformed(&DMat4::from_translation(DVec3::splat(far)));
        let maps = Settings {
            shadows: ShadowSettings { map_size: 512, ..settings("map").shadows },
            ..settings("map")
        };
        let lit = |scene: &Scene, light: &Light, at: DVec3| {
            with_shadows(scene, std::slice::from_ref(light), &maps, |arriving| {
                let places = (0..2500).map(|i| {
                    dvec3(f64::from(i % 50) * 0.151 - 3.7, 0.0, f64::from(i / 50) * 0.149 - 3.7)
                });
                let part =
                    |p: DVec3| arriving(SurfacePoint { facet: 0, ..place(p + at, DVec3::Y) });
                places.map(part).collect::<Vec<_>>()
            })
        };
        let (near, far) = (
            lit(&scene(0.0), &light, DVec3::ZERO),
            lit(&scene(far as f32), &moved, DVec3::splat(far)),
        );
        // Positions of the box, too, are a whole number of 1/128 there.
        let different = near.iter().zip(&far).filter(|(a, b)| (**a - **b).abs() > 0.1).count();
        assert!(different <= 5, "{:?}: {different} of 2500 differ", light.kind);
        assert!(near.iter().filter(|part| **part == 0.0).count() > 30, "something is in shadow");
    }
}

#[test]
fn pictures_by_rays_do_not_depend_on_threads_instructions_or_visibility() {
    pictures_do_not_depend("ray");
}

#[test]
fn pictures_by_maps_do_not_depend_on_threads_instructions_or_visibility() {
    pictures_do_not_depend("map");
}

#[test]
fn pictures_by_scan_lines_do_not_depend_on_threads_instructions_or_visibility() {
    pictures_do_not_depend("scan-line");
}

#[test]
fn pictures_by_lit_polygons_do_not_depend_on_threads_instructions_or_visibility() {
    pictures_do_not_depend("object-precision");
}

#[test]
fn pictures_by_volumes_do_not_depend_on_threads_instructions_or_visibility() {
    pictures_do_not_depend("volume");
}

fn pictures_do_not_depend(algorithm: &str) {
    let scene = builtin::scene("scene1").unwrap();
    let disc = AreaShape::Disc {
        center: dvec3(3.0, 7.0, 2.0),
        normal: dvec3(-3.0, -7.0, -2.0),
        radius: 0.6,
    };
    let lights = [sun(dvec3(1.0, -2.0, -1.0)), light(LightKind::Area { shape: disc })];
    let channels =
        Channels { color: true, attached_shadow: true, cast_shadow: true, ..Channels::default() };
    let settings = Settings {
        picture: PictureSettings { channels, samples: 4, ..settings(algorithm).picture },
        shadows: ShadowSettings { light_samples: 4, map_size: 512, ..settings(algorithm).shadows },
        ..settings(algorithm)
    };
    let one = Execution { workers: Workers::single(), ..Execution::default() };
    let first = picture(&scene, &lights, &settings, &one);
    assert!(first.cast_shadow.as_ref().unwrap().data().iter().any(|&c| c > 0.0));
    let many = Execution { workers: Workers::new(3), ..Execution::default() };
    for (name, level) in available_levels() {
        assert!(
            first == picture(&scene, &lights, &settings, &Execution { level, ..many.clone() }),
            "{name}"
        );
    }
    for algorithm in registry::VISIBILITY.iter().filter(|a| a.name != "brute-force") {
        let settings = settings.clone().with_visibility(algorithm.choice());
        assert!(first == picture(&scene, &lights, &settings, &many), "{}", algorithm.name);
    }
}

#[test]
fn odd_lights_are_defined() {
    let scene = above_floor(solids::cuboid(DVec3::ONE), Material::default(), dvec3(0.0, 1.5, 0.0));
    names().for_each(|algorithm| odd_lights(&scene, algorithm));
}

fn odd_lights(scene: &Scene, algorithm: &str) {
    let at = |light: Light| {
        with_shadows(scene, &[light], &settings(algorithm), |a| {
            a(place(dvec3(2.0, 0.0, 0.0), DVec3::Y))
        })
    };
    assert_eq!(at(lamp(dvec3(0.0, 1.5, 0.0))), 0.0, "inside the box");
    assert_eq!(at(lamp(dvec3(2.0, 0.0, 0.0))), 0.0, "at the very place");
    assert_eq!(at(lamp(dvec3(0.5, 1.5, 0.0))), 1.0, "on the side of the box");
    assert_eq!(at(Light { shadow: false, ..lamp(dvec3(0.0, 1.5, 0.0)) }), 1.0, "it casts none");
    let point =
        AreaShape::Disc { center: dvec3(-2.0, 4.0, 0.0), normal: DVec3::NEG_Y, radius: 0.0 };
    assert_eq!(at(light(LightKind::Area { shape: point })), 0.0, "without size, behind the box");
    assert_eq!(at(light(LightKind::Ambient)), 1.0);
}

#[test]
fn settings_that_cannot_be_are_refused() {
    let text = |settings: Settings| settings.check().unwrap_err().to_string();
    let unknown = "umbra".parse::<Shadows>().unwrap_err().to_string();
    assert!(unknown.contains("choose none, ray, map"), "{unknown}");
    assert!(
        text(Settings {
            shadows: ShadowSettings { light_samples: 0, ..settings("ray").shadows },
            ..settings("ray")
        })
        .contains("1 to 4096")
    );
    assert!(
        text(Settings {
            shadows: ShadowSettings { map_size: 9000, ..settings("map").shadows },
            ..settings("map")
        })
        .contains("16 to 8192")
    );
    assert!(
        text(Settings {
            shadows: ShadowSettings { cascades: 9, ..settings("map").shadows },
            ..settings("map")
        })
        .contains("1 to 8")
    );
    assert!(
        text(Settings {
            shadows: ShadowSettings { cascades: 0, ..settings("map").shadows },
            ..settings("map")
        })
        .contains("1 to 8")
    );
    let channels = Channels { cast_shadow: true, ..Channels::default() };
    assert!(
        text(settings("none").with_channels(channels))
            .contains("needs a shadow algorithm: choose ray")
    );
}

/// The part of pixels with a surface in which another algorithm and rays tell light from shadow
/// alike.
fn agreement(name: &str, light: &Light, from: DVec3, other_settings: &Settings) -> f64 {
    let scene = on_floor(name);
    let mut session = Session::new(Arc::new(scene.clone())).unwrap();
    let camera = camera(&scene, from);
    let mut mask = |settings: &Settings| {
        let channels = Channels {
            color: false,
            object: true,
            attached_shadow: true,
            cast_shadow: true,
            ..Channels::default()
        };
        let settings = settings.clone().with_size(320, 240).with_channels(channels);
        let shot = Shot {
            camera,
            lights: std::slice::from_ref(light),
            ambient: [0.0; 3],
            surroundings: Surroundings::default(),
        };
        render(&mut session, &shot, &settings, &Execution::default()).unwrap().frame
    };
    let (rays, other) = (mask(&settings("ray")), mask(other_settings));
    let (object, attached) = (rays.object.unwrap(), rays.attached_shadow.unwrap());
    let (rays, other) = (rays.cast_shadow.unwrap(), other.cast_shadow.unwrap());
    let seen: Vec<_> =
        (0..object.data().len()).filter(|&i| object.data()[i] != Frame::BACKGROUND).collect();
    assert!(seen.iter().any(|&i| rays.data()[i] == 1.0), "{name}: something is in shadow");
    let [rays, shadows] =
        [&rays, &other].map(|mask| mask.data().iter().map(|&c| c >= 0.5).collect::<Vec<_>>());
    let different: Vec<_> = seen.iter().filter(|&&i| rays[i] != shadows[i]).collect();
    if !other_settings.shadows.algorithm.draws_maps {
        // Texels may be larger, but these differ no more than 1.5 pixels from an edge of a shadow,
        // cast or attached.
        let dark = |i: usize| rays.get(i).map(|&cast| cast || attached.data()[i] > 0.0);
        for &&i in &different {
            let around =
                [-321, -320, -319, -1, 1, 319, 320, 321].map(|d| dark(i.wrapping_add_signed(d)));
            let edge = around.iter().any(|&n| n.is_some() && n != dark(i));
            assert!(edge, "{name}: no edge near pixel {i}");
        }
    }
    1.0 - different.len() as f64 / seen.len() as f64
}

/// A built-in scene, and a floor where it has none.
fn on_floor(name: &str) -> Scene {
    let mut scene = builtin::scene(name).unwrap();
    let bounds = Session::new(Arc::new(scene.clone())).unwrap().world().bounds;
    if name == "sphere" || name == "teapot" || name == "cubs" {
        let floor = solids::plane(bounds.diagonal() * 1.5, bounds.diagonal() * 1.5, 1, 1);
        add(&mut scene, floor, Material::default(), dvec3(0.0, bounds.min.y, 0.0));
    }
    scene
}

/// Three kinds of light, far enough from a built-in scene.
fn lights_for(name: &str) -> [Light; 3] {
    let reach = if name == "teapot" { 8.0 } else { 6.0 };
    let spot = LightKind::Spot {
        position: dvec3(-0.5, 1.0, 0.4) * reach,
        direction: dvec3(0.5, -1.0, -0.4),
        cutoff: 0.6,
        inner: 0.6,
        exponent: 0.0,
    };
    [sun(dvec3(-1.0, -2.0, 0.6)), lamp(dvec3(0.6, 1.0, -0.5) * reach), light(spot)]
}

/// Three sides from which a scene is looked at.
const SIDES: [DVec3; 3] = [dvec3(0.6, 0.5, 0.9), dvec3(-0.9, 0.3, 0.4), dvec3(0.1, 1.2, 0.2)];

/// Built-in scenes of opaque things that stand before each other: glass keeps only a part of the
/// light, the Cornell box is lit from within, and figures of defects are flat.
fn opaque_scenes() -> Vec<&'static str> {
    let opaque = |name: &&str| {
        let scene = builtin::scene(name).unwrap();
        let opaque = scene.materials.iter().all(|m| !m.is_layered() && m.emission == [0.0; 3]);
        opaque && !name.starts_with("defect-")
    };
    builtin::names().iter().map(|(name, _)| *name).filter(opaque).collect()
}

#[test]
fn what_is_kept_changes_nothing() {
    names().for_each(kept_changes_nothing);
}

fn kept_changes_nothing(algorithm: &str) {
    let scene = builtin::scene("scene0").unwrap();
    let lights = [lamp(dvec3(3.0, 6.0, 2.0))];
    let settings = Settings {
        shadows: ShadowSettings { map_size: 256, ..settings(algorithm).shadows },
        ..settings(algorithm)
    };
    let mut used = Session::new(Arc::new(scene.clone())).unwrap();
    for (view, lights) in
        [(0, &lights[..]), (1, &lights[..]), (1, &[sun(dvec3(1.0, -1.0, 0.0))]), (2, &lights[..])]
    {
        let camera = camera(
            &scene,
            [dvec3(0.6, 0.5, 0.9), dvec3(-0.6, 0.5, 0.9), dvec3(0.6, 0.9, -0.9)][view],
        );
        let shot =
            Shot { camera, lights, ambient: [0.1; 3], surroundings: Surroundings::default() };
        let again = render(&mut used, &shot, &settings, &Execution::default()).unwrap().frame;
        let mut fresh = Session::new(Arc::new(scene.clone())).unwrap();
        assert!(
            again == render(&mut fresh, &shot, &settings, &Execution::default()).unwrap().frame,
            "{algorithm}, view {view}"
        );
    }
}

/// Places all over the facets of a scene, world space.
fn places_on(scene: &Scene) -> Vec<SurfacePoint> {
    let session = Session::new(Arc::new(scene.clone())).unwrap();
    let mut places = Vec::new();
    for instance in &session.world().instances {
        for (facet, t) in (instance.first_facet..).zip(&instance.mesh.triangles) {
            let [a, b, c] = t.map(|i| {
                let [x, y, z] = instance.mesh.positions[i as usize].map(f64::from);
                instance.world_from_model.transform_point3(dvec3(x, y, z))
            });
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            // Large facets get more places.
            let side = ((b - a).cross(c - a).length().sqrt() * 24.0).clamp(2.0, 40.0) as u32;
            for (i, k) in (0..side).flat_map(|i| (0..side - i).map(move |k| (i, k))) {
                let [u, v] = [i, k].map(|n| (f64::from(n) + 1.0 / 3.0) / f64::from(side));
                let position = a + (b - a) * u + (c - a) * v;
                places.push(SurfacePoint {
                    position,
                    normal,
                    facet,
                    seed: 0,
                    pixel: Some([k, i].map(|n| n as f32)),
                });
            }
        }
    }
    places
}
