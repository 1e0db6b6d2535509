//! Surfaces that shine evenly, which become area lights.

use super::*;

#[test]
fn what_lamps_light_lights_the_rest() {
    // A lamp over a red floor under a white ceiling: the ceiling, which the lamp does not reach,
    // becomes reddish.
    let mut scene = Scene::default();
    let matt = |color: [f32; 3]| Material {
        reflectance: Reflectance::Phong { ka: color, kd: color, ks: [0.0; 3], shininess: 1.0 },
        ..Material::default()
    };
    for (y, color) in [(0.0, [0.8, 0.1, 0.1]), (2.0, [0.8; 3])] {
        let mut plane = solids::plane(4.0, 4.0, 1, 1);
        let material = Some(scene.add_material(matt(color)));
        plane.parts.iter_mut().for_each(|p| p.material = material);
        scene.add_mesh(plane, DMat4::from_translation(dvec3(0.0, y, 0.0)));
    }
    let axis = LightKind::Spot {
        position: dvec3(0.0, 1.9, 0.0),
        direction: DVec3::NEG_Y,
        cutoff: 0.6,
        inner: 0.6,
        exponent: 0.0,
    };
    let lights = [Light { kind: axis, ..Light::default() }];
    let camera = Camera {
        position: dvec3(0.0, 0.5, 0.1),
        focal_point: dvec3(0.0, 2.0, 0.0),
        view_up: DVec3::Z,
        projection: Projection::Perspective { view_angle: 0.5 },
        clip: None,
    };
    let mut session = Session::new(Arc::new(scene)).unwrap();
    let settings = Settings {
        picture: PictureSettings { color_space: ColorSpace::Raw, ..settings().picture },
        global: GlobalSettings { patch_size: Some(0.5), ..settings().global },
        shadows: ShadowSettings { algorithm: Shadows::RAY, ..settings().shadows },
        ..settings()
    };
    let shot =
        Shot { camera, lights: &lights, ambient: [0.0; 3], surroundings: Surroundings::default() };
    let lit = render(&mut session, &shot, &settings, &Execution::default()).unwrap();
    let [r, g, b, _] = lit.frame.color.unwrap().data()[32 * 64 + 32];
    assert!(r > 10 && g == b && r > 5 * g, "{r} {g} {b}");
    let local = settings.clone().with_global(Global::None);
    let dark = render(&mut session, &shot, &local, &Execution::default()).unwrap();
    assert_eq!(dark.frame.color.unwrap().data()[32 * 64 + 32], [0, 0, 0, 255]);
}

#[test]
fn narrow_lights_bring_what_they_bring_wherever_they_fall() {
    // A spot that is smaller than an element, and no element's middle: what its light is worth is
    // known.
    let mut scene = Scene::default();
    let kd = [0.8; 3];
    let material = Some(scene.add_material(Material {
        reflectance: Reflectance::Phong { ka: [0.0; 3], kd, ks: [0.0; 3], shininess: 1.0 },
        ..Material::default()
    }));
    let mut plane = solids::plane(2.0, 2.0, 1, 1);
    plane.parts.iter_mut().for_each(|p| p.material = material);
    scene.add_mesh(plane, DMat4::IDENTITY);
    let session = Session::new(Arc::new(scene)).unwrap();
    let triangles = Triangles::of_world(session.world(), &Workers::single());
    let corners = |f: u32| Some(triangles.corners[f as usize].map(|c| c.as_dvec3()));
    for (x, z) in [(0.013, 0.021), (0.05, 0.02), (0.1, -0.07), (-0.04, 0.09)] {
        let trees = Trees::new(session.world().facet_count, corners, 0.4, 1 << 20).unwrap();
        let (height, cutoff) = (2.0, 0.035f64);
        let position = dvec3(x, height, z);
        let kind = LightKind::Spot {
            position,
            direction: DVec3::NEG_Y,
            cutoff,
            inner: cutoff,
            exponent: 0.0,
        };
        let lights = [Light { kind, ..Light::default() }];
        let room =
            Enclosure::new(trees, &session, &lights, &Settings::default(), &Execution::default())
                .unwrap();
        let sent: f64 = room
            .elements
            .iter()
            .enumerate()
            .map(|(e, element)| room.emission[2 * e][0] * element.area)
            .sum();
        let (sin, cos) = func::sin_cos(cutoff);
        let radius = height * sin / cos;
        let expected = 0.8 * std::f64::consts::PI * radius * radius;
        assert!((sent / expected - 1.0).abs() < 0.15, "{x} {z}: {sent}, expected {expected}");
    }
}
