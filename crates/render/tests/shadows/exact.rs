//! Algorithms that find the shadows that rays find: volumes, scan lines, lit polygons.

use super::*;

/// All opaque built-in scenes, lights and sides: at least this part agrees with rays.
fn agrees_with_rays(other: &Settings, least: f64) {
    let (mut mean, scenes) = (0.0, opaque_scenes());
    for &name in &scenes {
        for light in lights_for(name) {
            for from in SIDES {
                let same = agreement(name, &light, from, other);
                assert!(same >= least, "{name}, {:?} from {from}: {same}", light.kind);
                mean += same / (scenes.len() * 9) as f64;
            }
        }
    }
    println!("{}: {mean}", other.shadows.algorithm);
}

#[test]
fn f26_volumes_agree_with_rays() {
    agrees_with_rays(&settings("volume"), 0.999);
    let from_viewer = Settings {
        shadows: ShadowSettings {
            volume_counting: Some(VolumeCounting::ZPass),
            ..settings("volume").shadows
        },
        ..settings("volume")
    };
    agrees_with_rays(&from_viewer, 0.999);
}

#[test]
fn f21_scan_line_shadows_agree_with_rays() {
    agrees_with_rays(&settings("scan-line"), 0.999);
}

#[test]
fn f22_lit_polygons_agree_with_rays() {
    agrees_with_rays(&settings("object-precision"), 0.999);
}

/// Algorithms that give what rays give, everywhere.
const EXACT: [&str; 3] = ["volume", "scan-line", "object-precision"];

/// What an algorithm says about places, all asked at once, as seen by a viewer.
fn ask_all(
    scene: &Scene,
    light: &Light,
    settings: &Settings,
    viewer: DVec3,
    places: &[SurfacePoint],
) -> Vec<f32> {
    let session = Session::new(Arc::new(scene.clone())).unwrap();
    let algorithm = registry::shadows(settings.shadows.algorithm).unwrap();
    let lights = std::slice::from_ref(light);
    let execution = Execution::default();
    let ready =
        algorithm.prepare(&session, lights, viewer.extend(1.0), settings, &execution).unwrap();
    let center = Triangles::center_of(session.world());
    let moved: SurfacePoints =
        places.iter().map(|p| SurfacePoint { position: p.position - center, ..*p }).collect();
    let mut parts = LightVisibility::new(places.len(), [f32::NAN; 3]);
    ready.light_visibility(0, &moved, &mut parts, &mut 0);
    (0..places.len()).map(|place| parts.get(place)[0]).collect()
}

/// Sheets that share an edge, a bent quadrangle, a sheet wound the wrong way, one that is there
/// twice.
fn torn() -> Scene {
    let p = |x: f32, y: f32, z: f32| [x, y, z];
    let positions = vec![
        p(0.0, 1.0, -1.0),
        p(0.0, 1.0, 1.0),
        p(-1.0, 1.5, 0.1),
        p(1.0, 1.4, 0.2),
        p(0.3, 2.2, 0.0),
        p(2.0, 0.5, -1.0),
        p(3.0, 1.0, -1.0),
        p(3.0, 0.4, 0.5),
        p(2.0, 1.2, 0.4),
    ];
    let triangles = vec![
        [0, 1, 2],
        [0, 1, 3],
        [1, 0, 4],
        [5, 6, 7],
        [5, 7, 8],
        [7, 6, 5],
        [0, 3, 4],
        [0, 3, 4],
        [2, 2, 3],
    ];
    let parts =
        vec![Part { name: String::new(), triangles: 0..triangles.len() as u32, material: None }];
    let mesh = Mesh { positions, triangles, parts, ..Mesh::default() };
    above_floor(mesh, Material::default(), DVec3::ZERO)
}

#[test]
fn f26_torn_and_branching_meshes_cast_the_shadows_that_rays_find() {
    let scene = torn();
    let places = places_on(&scene);
    assert!(places.len() > 1000);
    let towards = dvec3(0.3, 1.0, 0.4);
    // From far, from amidst the sheets, from below, from behind the viewer, from in a sheet's
    // plane.
    let lamps = [
        towards * 9.0,
        dvec3(0.1, 1.3, 0.0),
        dvec3(0.5, -2.0, 0.3),
        dvec3(1.7, 8.0, 12.0),
        dvec3(0.0, 4.0, 0.0),
    ];
    for light in lamps.map(lamp).into_iter().chain([sun(-towards)]) {
        let rays = ask_all(&scene, &light, &settings("ray"), VIEWER.truncate(), &places);
        assert!(rays.contains(&0.0));
        for algorithm in EXACT {
            let found = ask_all(&scene, &light, &settings(algorithm), VIEWER.truncate(), &places);
            let same = rays.iter().zip(&found).filter(|(a, b)| a == b).count();
            assert!(
                same as f64 >= 0.999 * rays.len() as f64,
                "{algorithm}, {:?}: {same} of {}",
                light.kind,
                rays.len()
            );
        }
    }
}

#[test]
fn f26_nothing_pops_when_the_viewer_walks_into_a_shadow() {
    let scene = above_floor(solids::cuboid(DVec3::ONE), Material::default(), dvec3(0.0, 1.5, 0.0));
    let light = lamp(dvec3(2.0, 5.0, 1.0));
    let places = places_on(&scene);
    let rays = ask_all(&scene, &light, &settings("ray"), DVec3::ZERO, &places);
    for counting in [VolumeCounting::ZFail, VolumeCounting::ZPass] {
        let settings = Settings {
            shadows: ShadowSettings {
                volume_counting: Some(counting),
                ..settings("volume").shadows
            },
            ..settings("volume")
        };
        // Along the floor through the shadow's border, through the box, up to the light and beyond.
        let walk = (0..40).map(|i| dvec3(4.0 - f64::from(i) * 0.2, 0.3, 0.1));
        let climb = (0..20).map(|i| dvec3(2.0, 5.0, 1.0) * (f64::from(i) * 0.1));
        for viewer in walk.chain(climb) {
            let found = ask_all(&scene, &light, &settings, viewer, &places);
            let different = rays.iter().zip(&found).filter(|(a, b)| a != b).count();
            assert!(
                different * 1000 <= rays.len(),
                "{counting:?} from {viewer}: {different} of {}",
                rays.len()
            );
        }
    }
}

#[test]
fn f26_pictures_from_within_a_shadow_are_those_of_rays() {
    // The near plane is so near, or so far, that it cuts the box and its shadow open.
    let scene = above_floor(solids::cuboid(DVec3::ONE), Material::default(), dvec3(0.0, 1.5, 0.0));
    let light = [lamp(dvec3(2.0, 5.0, 1.0))];
    for (position, clip) in [
        (dvec3(-0.9, 0.4, -0.3), None),
        (dvec3(-0.9, 0.4, -0.3), Some((1.0, 20.0))),
        (dvec3(0.2, 1.6, 0.1), Some((0.01, 20.0))),
    ] {
        let projection = Projection::Perspective { view_angle: 1.4 };
        for focal_point in [dvec3(3.0, 0.2, 2.0), dvec3(-3.0, -0.3, -2.0)] {
            let camera = Camera { position, focal_point, view_up: DVec3::Y, projection, clip };
            let channels = Channels { color: false, cast_shadow: true, ..Channels::default() };
            let mask = |settings: Settings| {
                let mut session = Session::new(Arc::new(scene.clone())).unwrap();
                let shot = Shot {
                    camera,
                    lights: &light,
                    ambient: [0.0; 3],
                    surroundings: Surroundings::default(),
                };
                let settings = settings.clone().with_channels(channels);
                render(&mut session, &shot, &settings, &Execution::default())
                    .unwrap()
                    .frame
                    .cast_shadow
                    .unwrap()
            };
            let rays = mask(settings("ray"));
            for counting in [VolumeCounting::ZFail, VolumeCounting::ZPass] {
                assert!(
                    rays == mask(Settings {
                        shadows: ShadowSettings {
                            volume_counting: Some(counting),
                            ..settings("volume").shadows
                        },
                        ..settings("volume")
                    }),
                    "{position}"
                );
            }
        }
    }
}

/// All polygons that an algorithm works with.
fn drawn(scene: &Scene, light: &Light, settings: &Settings) -> Vec<(&'static str, Vec<DVec3>)> {
    let session = Session::new(Arc::new(scene.clone())).unwrap();
    let (mut all, lights) = (Vec::new(), std::slice::from_ref(light));
    let mut take = |polygon: Drawn<'_>| {
        all.push((polygon.kind, polygon.corners.to_vec()));
        0
    };
    let algorithm = registry::shadows(settings.shadows.algorithm);
    shadow::draw(algorithm, &session, lights, settings, &Execution::default(), &mut take).unwrap();
    all
}

/// Area of a polygon along its normal.
fn area(corners: &[DVec3]) -> DVec3 {
    (2..corners.len())
        .map(|i| (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]) * 0.5)
        .sum()
}

#[test]
fn f22_the_lit_area_of_a_square_under_a_square() {
    // The lamp at height 2, the plate at 1: its shadow is twice as wide.
    let scene =
        above_floor(solids::plane(1.0, 1.0, 1, 1), Material::default(), dvec3(0.25, 1.0, -0.5));
    let lit = drawn(&scene, &lamp(dvec3(0.25, 2.0, -0.5)), &settings("object-precision"));
    let of = |height: f64| -> f64 {
        let at_height =
            lit.iter().filter(|(_, corners)| corners.iter().all(|c| (c.y - height).abs() < 1e-9));
        at_height.map(|(_, corners)| area(corners).length()).sum()
    };
    assert!(
        (of(0.0) - 60.0).abs() < 1e-9 && (of(1.0) - 1.0).abs() < 1e-9,
        "{} and {}",
        of(0.0),
        of(1.0)
    );
    assert!(lit.iter().all(|(kind, _)| *kind == "lit"));
}

#[test]
fn f21_the_shadow_polygons_of_a_square_on_a_plane_have_the_analytic_area() {
    let plate = || solids::plane(1.0, 1.0, 1, 1);
    let scene = above_floor(plate(), Material::default(), dvec3(0.25, 1.0, -0.5));
    let of =
        |light: &Light| -> Vec<(&str, Vec<DVec3>)> { drawn(&scene, light, &settings("scan-line")) };
    let on_floor =
        |polygons: &[(&str, Vec<DVec3>)]| -> f64 {
            assert!(
                polygons.iter().all(|(kind, corners)| *kind == "shadow"
                    && corners.iter().all(|c| c.y.abs() < 1e-12))
            );
            polygons.iter().map(|(_, corners)| area(corners).length()).sum()
        };
    // The lamp at height 2, the plate at 1: its shadow is twice as wide.
    let by_lamp = on_floor(&of(&lamp(dvec3(0.25, 2.0, -0.5))));
    assert!((by_lamp - 4.0).abs() < 4e-9, "{by_lamp}");
    // Beside the lamp's foot it is as large; slanted rays of the sun leave the size as it is.
    let beside = on_floor(&of(&lamp(dvec3(0.75, 2.0, 0.25))));
    assert!((beside - 4.0).abs() < 4e-9, "{beside}");
    let by_sun = on_floor(&of(&sun(dvec3(0.5, -1.0, 0.25))));
    assert!((by_sun - 1.0).abs() < 1e-9, "{by_sun}");
    // What lit polygons leave of the floor.
    let light = lamp(dvec3(0.25, 2.0, -0.5));
    let lit = drawn(&scene, &light, &settings("object-precision"));
    let lit: f64 =
        lit.iter().filter(|(_, c)| c[0].y.abs() < 1e-9).map(|(_, c)| area(c).length()).sum();
    assert!((lit + by_lamp - 64.0).abs() < 1e-8, "{lit} and {by_lamp}");
    // Five times as wide and moved aside, it goes beyond the floor's edge: from x = -0.25 to 4,
    // from z = -3 to 2.
    let clipped = on_floor(&of(&lamp(dvec3(-0.25, 1.25, -0.5))));
    assert!((clipped - 21.25).abs() < 21.25e-9, "{clipped}");
    // Glass casts a tinted one.
    let glass = Material { alpha_mode: AlphaMode::Blend, opacity: 0.5, ..Material::default() };
    let tinted =
        drawn(&above_floor(plate(), glass, dvec3(0.25, 1.0, -0.5)), &light, &settings("scan-line"));
    let tinted: f64 = tinted
        .iter()
        .filter(|(kind, _)| *kind == "tinted-shadow")
        .map(|(_, c)| area(c).length())
        .sum();
    assert!((tinted - 4.0).abs() < 4e-9, "{tinted}");
}

#[test]
fn f21_shadow_polygons_hold_the_places_that_the_scan_line_finds_dark() {
    let scene = builtin::scene("scene1").unwrap();
    let light = lamp(dvec3(3.0, 6.0, 2.0));
    let polygons = drawn(&scene, &light, &settings("scan-line"));
    let planes = |corners: &[DVec3]| {
        let normal = area(corners).normalize();
        let inwards =
            |i: usize| normal.cross(corners[(i + 1) % corners.len()] - corners[i]).normalize();
        (normal, (0..corners.len()).map(|i| (inwards(i), corners[i])).collect::<Vec<_>>())
    };
    let polygons: Vec<_> = polygons.iter().map(|(_, corners)| planes(corners)).collect();
    // Places are lifted off their facet, shadow polygons are not: on an edge they may differ.
    let inside = |p: DVec3, slack: f64| {
        polygons.iter().any(|(normal, edges)| {
            normal.dot(p - edges[0].1).abs() < 1e-5
                && edges.iter().all(|(n, at)| n.dot(p - *at) >= -slack)
        })
    };
    let (mut dark, mut lit) = (0, 0);
    with_shadows(&scene, std::slice::from_ref(&light), &settings("scan-line"), |arriving| {
        let LightKind::Point { position } = light.kind else { panic!("{light:?}") };
        for place in places_on(&scene).into_iter().step_by(23) {
            // Faces in their own shadow have no polygons.
            if place.normal.dot(position - place.position) <= 0.0 {
                continue;
            }
            let shadowed = arriving(place) == 0.0;
            assert!(
                if shadowed {
                    inside(place.position, 1e-4)
                } else {
                    !inside(place.position, -1e-4)
                },
                "{place:?}"
            );
            (dark, lit) = (dark + u32::from(shadowed), lit + u32::from(!shadowed));
        }
    });
    assert!(dark > 20 && lit > 20, "{dark} dark, {lit} lit");
}

#[test]
fn f19_two_viewers_share_the_polygons() {
    for shadows in ["object-precision", "scan-line", "volume"] {
        two_viewers_share(shadows);
    }
}

fn two_viewers_share(shadows: &str) {
    let scene = builtin::scene("scene1").unwrap();
    let light = lamp(dvec3(3.0, 6.0, 2.0));
    let settings = settings(shadows);
    let alone = drawn(&scene, &light, &settings);
    let mut session = Session::new(Arc::new(scene.clone())).unwrap();
    let lights = std::slice::from_ref(&light);
    for from in SIDES {
        let shot = Shot {
            camera: camera(&scene, from),
            lights,
            ambient: [0.0; 3],
            surroundings: Surroundings::default(),
        };
        render(&mut session, &shot, &settings, &Execution::default()).unwrap();
    }
    let mut after = Vec::new();
    let mut take = |polygon: Drawn<'_>| {
        after.push((polygon.kind, polygon.corners.to_vec()));
        0
    };
    let algorithm = registry::shadows(settings.shadows.algorithm);
    shadow::draw(algorithm, &session, lights, &settings, &Execution::default(), &mut take).unwrap();
    assert!(!after.is_empty() && after == alone);
}

#[test]
fn drawn_volumes_are_closed() {
    for scene in [torn(), builtin::scene("scene0").unwrap()] {
        for light in
            [lamp(dvec3(0.7, 6.0, 2.0)), sun(dvec3(-1.0, -2.0, 0.6)), lamp(dvec3(0.1, 1.3, 0.0))]
        {
            let polygons = drawn(&scene, &light, &settings("volume"));
            let kinds = ["near-cap", "far-cap", "side"];
            assert!(kinds.iter().all(|kind| polygons.iter().any(|(k, _)| k == kind)));
            let sum: DVec3 = polygons.iter().map(|(_, corners)| area(corners)).sum();
            let whole: f64 = polygons.iter().map(|(_, corners)| area(corners).length()).sum();
            assert!(sum.length() < 1e-9 * whole, "{sum} of {whole}");
        }
    }
}

#[test]
fn limits_hold_while_shadows_are_made_ready() {
    let session = Session::new(Arc::new(builtin::scene("teapot").unwrap())).unwrap();
    let lights = [lamp(dvec3(3.0, 6.0, 2.0))];
    for algorithm in ["map", "volume", "object-precision"] {
        let ready = |budget: Budget| {
            let execution = Execution { budget, ..Execution::default() };
            let algorithm_ = registry::shadows(algorithm.parse().unwrap()).unwrap();
            algorithm_
                .prepare(&session, &lights, VIEWER, &settings(algorithm), &execution)
                .map(|_| ())
        };
        let little = ready(Budget::default().with_memory_limit(Some(20_000)));
        assert!(matches!(little, Err(Limit::Memory { .. })), "{algorithm}: {little:?}");
        let stopped = Budget::default();
        stopped.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
        assert!(matches!(ready(stopped), Err(Limit::Cancelled { .. })), "{algorithm}");
        assert!(ready(Budget::default()).is_ok());
    }
}
