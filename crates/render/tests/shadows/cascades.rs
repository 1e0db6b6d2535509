//! Cascades of shadow maps: sharp near the viewer, without gaps, still when the viewer moves.

use super::*;
use vitral_raster::Viewport;
use vitral_render::PreparedView;
use vitral_render::stats::CullCounters;

/// A small table on a vast plain, posts into the distance.
fn plain() -> Scene {
    let mut scene = Scene::default();
    add(&mut scene, solids::plane(2000.0, 2000.0, 1, 1), Material::default(), DVec3::ZERO);
    for (size, at) in [([1.0, 0.06, 0.7], [0.0, 0.7, 0.0]), ([0.3, 0.3, 0.2], [0.1, 0.88, 0.0])] {
        add(
            &mut scene,
            solids::cuboid(DVec3::from_array(size)),
            Material::default(),
            DVec3::from_array(at),
        );
    }
    for (x, z) in [(-0.45, -0.3), (0.45, -0.3), (-0.45, 0.3), (0.45, 0.3)] {
        add(
            &mut scene,
            solids::cuboid(dvec3(0.05, 0.7, 0.05)),
            Material::default(),
            dvec3(x, 0.35, z),
        );
    }
    for i in 0..12 {
        let away = 4.0 * vitral_math::func::pow(1.6, f64::from(i));
        let size = dvec3(0.1 * away, 0.4 * away, 0.1 * away);
        add(
            &mut scene,
            solids::cuboid(size),
            Material::default(),
            dvec3(away * 0.4 - 2.0, size.y * 0.5, -away),
        );
    }
    scene
}

fn near_the_table() -> Camera {
    Camera {
        position: dvec3(1.4, 1.5, 2.6),
        focal_point: dvec3(0.0, 0.35, -0.5),
        view_up: DVec3::Y,
        projection: Projection::Perspective { view_angle: 0.8 },
        clip: None,
    }
}

const SUN: DVec3 = dvec3(-0.7, -1.0, 0.4);

fn with_cascades(count: u32) -> Settings {
    Settings {
        shadows: ShadowSettings { map_size: 1024, cascades: count, ..settings("map").shadows },
        picture: PictureSettings { width: 400, height: 300, ..settings("map").picture },
        ..settings("map")
    }
}

/// How deep in a cast shadow pixels with a surface are.
fn mask(scene: &Scene, camera: Camera, light: &Light, settings: &Settings) -> Vec<Option<f32>> {
    shadows(scene, camera, light, settings).iter().map(|seen| seen.map(|(cast, ..)| cast)).collect()
}

/// How deep in a cast, and in an attached shadow they are, and on which object.
fn shadows(
    scene: &Scene,
    camera: Camera,
    light: &Light,
    settings: &Settings,
) -> Vec<Option<(f32, f32, u32)>> {
    let channels = Channels {
        color: false,
        object: true,
        cast_shadow: true,
        attached_shadow: true,
        ..Channels::default()
    };
    let settings = settings.clone().with_channels(channels);
    let mut session = Session::new(Arc::new(scene.clone())).unwrap();
    let shot = Shot {
        camera,
        lights: std::slice::from_ref(light),
        ambient: [0.0; 3],
        surroundings: Surroundings::default(),
    };
    let frame = render(&mut session, &shot, &settings, &Execution::default()).unwrap().frame;
    let (object, cast, attached) =
        (frame.object.unwrap(), frame.cast_shadow.unwrap(), frame.attached_shadow.unwrap());
    let seen = object.data().iter().zip(cast.data().iter().zip(attached.data()));
    seen.map(|(&object, (&cast, &attached))| {
        (object != Frame::BACKGROUND).then_some((cast, attached, object))
    })
    .collect()
}

/// The part of pixels with a surface in which two masks agree.
fn same(a: &[Option<f32>], b: &[Option<f32>]) -> f64 {
    let seen: Vec<_> =
        a.iter().zip(b).filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?))).collect();
    let same = seen.iter().filter(|(a, b)| (**a >= 0.5) == (**b >= 0.5)).count();
    same as f64 / seen.len() as f64
}

#[test]
fn f23_cascades_make_near_shadows_of_a_vast_scene_sharp() {
    let (scene, camera) = (plain(), near_the_table());
    let spot = LightKind::Spot {
        position: dvec3(300.0, 400.0, -200.0),
        direction: -dvec3(300.0, 400.0, -200.0),
        cutoff: 0.9,
        inner: 0.9,
        exponent: 0.0,
    };
    for light in [sun(SUN), light(spot)] {
        let by_rays = with_cascades(1).with_shadows(Shadows::RAY);
        let seen = shadows(&scene, camera, &light, &by_rays);
        let rays: Vec<_> = seen.iter().map(|seen| seen.map(|(cast, ..)| cast)).collect();
        let dark = rays.iter().flatten().filter(|&&cast| cast == 1.0).count();
        assert!(dark > 5000, "{dark}");
        let [one, four] = [1, 4].map(|count| mask(&scene, camera, &light, &with_cascades(count)));
        // The only map has texels two units wide: the table throws no shadow that it could be known
        // by.
        let (coarse, fine) = (same(&rays, &one), same(&rays, &four));
        assert!(coarse < 0.97, "{:?}: {coarse}", light.kind);
        assert!(fine >= 0.99, "{:?}: {fine}", light.kind);
        // Where they differ, it is within two pixels of an edge of a shadow, cast or attached, or
        // of where two things meet, as a texel of one may show the other; but for the farthest,
        // whose pixels are larger than texels.
        let width = 400i64;
        let at = |i: i64| seen.get(i as usize).copied().flatten();
        let kind =
            |i: i64| at(i).map(|(cast, attached, object)| (cast >= 0.5 || attached >= 0.5, object));
        let mut met = 0;
        for i in 60 * width..rays.len() as i64 {
            let [fine, ray] = [&four, &rays].map(|mask| mask[i as usize].map(|cast| cast >= 0.5));
            let around = || (-2..=2).flat_map(|y| (-2..=2).map(move |x| i + y * width + x));
            let edge = around().any(|k| kind(k).map(|k| k.0) != kind(i).map(|k| k.0));
            met += u32::from(fine != ray && !edge);
            let near = edge || around().any(|k| kind(k) != kind(i));
            assert!(fine == ray || near, "{:?}: pixel {} {}", light.kind, i % width, i / width);
        }
        assert!(met < 30, "{:?}: {met} pixels where things meet", light.kind);
    }
}

/// Asks the first of the lights, at places as the view sees them.
fn ask_view(
    scene: &Scene,
    camera: &Camera,
    light: &Light,
    settings: &Settings,
    places: &[SurfacePoint],
) -> Vec<f32> {
    let session = Session::new(Arc::new(scene.clone())).unwrap();
    let execution = Execution::default();
    let viewport = Viewport::new(settings.picture.width, settings.picture.height).unwrap();
    let pattern = vitral_raster::SamplePattern::new(1);
    let culled = &mut CullCounters::default();
    let view = PreparedView::new(&session, camera, settings, viewport, pattern, &execution, culled);
    let algorithm = registry::shadows(settings.shadows.algorithm).unwrap();
    let ready =
        algorithm.prepare_for(&view, std::slice::from_ref(light), settings, &execution).unwrap();
    let center = Triangles::center_of(session.world());
    let places: SurfacePoints =
        places.iter().map(|p| SurfacePoint { position: p.position - center, ..*p }).collect();
    let mut parts = LightVisibility::new(places.len(), [f32::NAN; 3]);
    ready.light_visibility(0, &places, &mut parts, &mut 0);
    (0..places.len()).map(|place| parts.get(place)[0]).collect()
}

/// Places along the ground in front of the viewer, and far behind.
fn ground(count: u32, side: f64) -> Vec<SurfacePoint> {
    let at = |i: u32| {
        let away = 0.05 * vitral_math::func::pow(1e5, f64::from(i) / f64::from(count));
        let position = dvec3(1.4, 0.0, 2.6) + dvec3(-0.41 + side, 0.0, -0.9) * away;
        SurfacePoint { position, normal: DVec3::Y, facet: 0, seed: 0, pixel: Some([0.0; 2]) }
    };
    (0..count).map(at).filter(|p| p.position.abs().max_element() < 1000.0).collect()
}

#[test]
fn between_cascades_is_no_gap_and_no_acne() {
    // A plain without anything on it is lit everywhere, right and left of the view, and where
    // slices meet.
    let mut bare = Scene::default();
    add(&mut bare, solids::plane(2000.0, 2000.0, 1, 1), Material::default(), DVec3::ZERO);
    add(
        &mut bare,
        solids::cuboid(dvec3(0.01, 0.01, 0.01)),
        Material::default(),
        dvec3(-990.0, 0.1, 990.0),
    );
    for elevation in [3.0f64, 20.0, 70.0] {
        let (sin, cos) = vitral_math::func::sin_cos(elevation.to_radians());
        let light = sun(-dvec3(cos * 0.6, sin, cos * 0.8));
        for side in [-2.0, -0.3, 0.0, 0.2, 3.0] {
            let places = ground(4000, side);
            let found = ask_view(&bare, &near_the_table(), &light, &with_cascades(4), &places);
            for (place, part) in places.iter().zip(found) {
                assert_eq!(part, 1.0, "{elevation} degrees, {}", place.position);
            }
        }
    }
    // Under a roof over all of it nothing is lit.
    let mut covered = plain();
    add(
        &mut covered,
        solids::plane(1990.0, 1990.0, 1, 1),
        Material::default(),
        dvec3(0.0, 300.0, 0.0),
    );
    let places = ground(4000, 0.0);
    let found =
        ask_view(&covered, &near_the_table(), &sun(DVec3::NEG_Y), &with_cascades(4), &places);
    assert!(found.len() > 3000);
    for (place, part) in
        places.iter().zip(found).filter(|(p, _)| p.position.abs().max_element() < 980.0)
    {
        assert_eq!(part, 0.0, "{}", place.position);
    }
}

#[test]
fn shadows_of_cascades_stand_still_while_the_viewer_moves() {
    let (scene, light) = (plain(), sun(SUN));
    // Round the table and its shadow.
    let places: Vec<SurfacePoint> = (0..10_000)
        .map(|i| {
            let position =
                dvec3(f64::from(i % 100) * 0.0171 - 1.2, 0.0, f64::from(i / 100) * 0.0173 - 0.8);
            SurfacePoint { position, normal: DVec3::Y, facet: 0, seed: 0, pixel: Some([0.0; 2]) }
        })
        .collect();
    let lit = |camera: &Camera, count: u32| {
        ask_view(&scene, camera, &light, &with_cascades(count), &places)
    };
    let rays = ask_view(&scene, &near_the_table(), &light, &settings("ray"), &places);
    assert!(rays.iter().filter(|&&part| part == 0.0).count() > 500);
    let mut last: Option<Vec<f32>> = None;
    let mut equal = 0;
    for step in 0..12 {
        let away = DVec3::new(0.031, 0.017, -0.023) * f64::from(step);
        let camera = near_the_table();
        let camera = Camera {
            position: camera.position + away,
            focal_point: camera.focal_point + away * 0.6,
            ..camera
        };
        let found = lit(&camera, 4);
        let wrong = found.iter().zip(&rays).filter(|(a, b)| (**a >= 0.5) != (**b >= 0.5)).count();
        assert!(wrong * 50 < places.len(), "step {step}: {wrong} of {}", places.len());
        if let Some(last) = &last {
            let largest = last.iter().zip(&found).filter(|(a, b)| (*a - *b).abs() > 0.1).count();
            assert!(largest * 100 < places.len(), "step {step}: {largest} change");
            equal += u32::from(*last == found);
        }
        last = Some(found);
    }
    assert!(equal >= 6, "most steps change nothing at all: {equal} of 11");
}

#[test]
fn small_scenes_keep_the_map_of_the_whole_scene() {
    let scene = builtin::scene("scene0").unwrap();
    let camera = camera(&scene, dvec3(0.6, 0.5, 0.9));
    for light in [sun(dvec3(-1.0, -2.0, 0.6)), lamp(dvec3(3.0, 6.0, 2.0))] {
        let [one, two] = [1, 2].map(|count| mask(&scene, camera, &light, &with_cascades(count)));
        assert!(one == two, "{:?}", light.kind);
    }
}

#[test]
fn pictures_with_cascades_do_not_depend_on_threads_instructions_or_sessions() {
    let scene = plain();
    let lights = [sun(SUN)];
    let settings = with_cascades(3).with_samples(2);
    let picture = |session: &mut Session, camera: Camera, execution: &Execution| {
        let shot = Shot {
            camera,
            lights: &lights,
            ambient: [0.2; 3],
            surroundings: Surroundings::default(),
        };
        render(session, &shot, &settings, execution).unwrap().frame
    };
    let one = Execution { workers: Workers::single(), ..Execution::default() };
    let fresh = || Session::new(Arc::new(scene.clone())).unwrap();
    let first = picture(&mut fresh(), near_the_table(), &one);
    let mut used = fresh();
    for (name, level) in available_levels() {
        let many = Execution { workers: Workers::new(3), level, ..Execution::default() };
        picture(&mut used, camera(&scene, dvec3(0.1, 0.2, 0.3)), &many);
        assert!(first == picture(&mut used, near_the_table(), &many), "{name}");
    }
}
