//! Area lights: what arrives of a whole shape, smooth where all of it is seen.

use super::*;
use vitral_light::Attenuation;

/// A square of side 1.6 at height 3 that shines down, by the physical law.
fn square() -> Light {
    let corners = [[-0.8, -0.8], [0.8, -0.8], [0.8, 0.8], [-0.8, 0.8]]
        .map(|[x, z]| dvec3(x, 3.0, z))
        .to_vec();
    let shape = LightKind::Area { shape: AreaShape::Polygon { corners } };
    Light { attenuation: Attenuation::InverseSquare, diffuse: [8.0; 3], ..light(shape) }
}

fn matt() -> Material {
    Material {
        reflectance: vitral_light::Reflectance::Phong {
            ka: [0.0; 3],
            kd: [1.0; 3],
            ks: [0.0; 3],
            shininess: 1.0,
        },
        ..Material::default()
    }
}

/// A floor and a ball to the right of its middle.
fn room() -> Scene {
    let mut scene = Scene::default();
    add(&mut scene, solids::plane(8.0, 8.0, 1, 1), matt(), DVec3::ZERO);
    add(&mut scene, solids::sphere(0.4, 48, 24), matt(), dvec3(1.5, 0.7, 0.0));
    scene
}

/// Red bytes of the picture from above, 192 pixels a side, 24 pixels a unit, with raw intensities.
fn from_above(scene: &Scene, lights: &[Light], settings: Settings) -> Vec<u8> {
    let camera = Camera {
        position: dvec3(0.0, 2.9, 0.0),
        focal_point: DVec3::ZERO,
        view_up: DVec3::NEG_Z,
        projection: Projection::Parallel { height: 8.0 },
        clip: Some((0.1, 9.0)),
    };
    let raw = vitral_render::ColorSpace::Raw;
    let settings = settings.clone().with_size(192, 192).with_samples(1).with_color_space(raw);
    let mut session = Session::new(Arc::new(scene.clone())).unwrap();
    let shot = Shot { camera, lights, ambient: [0.0; 3], surroundings: Surroundings::default() };
    let frame = render(&mut session, &shot, &settings, &Execution::default()).unwrap().frame;
    frame.color.unwrap().data().iter().map(|p| p[0]).collect()
}

#[test]
fn full_light_of_a_shape_is_smooth_and_exact() {
    let scene = room();
    let plain = from_above(&scene, &[square()], settings("none"));
    // On the floor, away from the ball: four rectangles over one of their corners, added with
    // signs.
    let corner = |x: f64, z: f64| {
        let part = |a: f64, b: f64| {
            let root = (9.0 + a * a).sqrt();
            a / root * vitral_math::func::atan2(b, root)
        };
        (part(x, z) + part(z, x)) * 0.5
    };
    let floor = |x: f64, z: f64| {
        let (low, high) = ([-0.8 - x, -0.8 - z], [0.8 - x, 0.8 - z]);
        let sum = corner(high[0], high[1]) - corner(low[0], high[1]) - corner(high[0], low[1])
            + corner(low[0], low[1]);
        8.0 * sum / 2.56
    };
    for (i, &byte) in plain.iter().enumerate() {
        let [x, z] = [i % 192, i / 192].map(|k| (k as f64 + 0.5) / 24.0 - 4.0);
        if (x - 1.5).abs() > 0.5 || z.abs() > 0.5 {
            let wanted = (floor(x, z) * 255.0).min(255.0);
            assert!(
                (f64::from(byte) - wanted).abs() < 0.51 + wanted * 1e-5,
                "{x} {z}: {byte}, {wanted}"
            );
        }
    }
    // Where the whole light is seen, shadows change no bit, however few places are asked.
    for algorithm in names() {
        let sampled = Settings {
            shadows: ShadowSettings {
                light_samples: 4,
                map_size: 512,
                ..settings(algorithm).shadows
            },
            ..settings(algorithm)
        };
        let shadowed = from_above(&scene, &[square()], sampled);
        let same = |i: &usize| i % 192 < 90;
        assert!((0..192 * 192).filter(same).all(|i| plain[i] == shadowed[i]), "{algorithm}");
        assert!(shadowed.iter().zip(&plain).all(|(with, without)| with <= without), "{algorithm}");
        assert!(shadowed != plain, "{algorithm}: the ball throws a shadow");
    }
}

#[test]
fn the_part_of_a_light_below_the_horizon_casts_no_shadow() {
    // A wall under the light: half of the light is behind its plane, and nothing stands in the way
    // of the other half.
    let mut scene = Scene::default();
    let wall = solids::cuboid(dvec3(0.25, 2.0, 4.0));
    add(&mut scene, wall, matt(), dvec3(-0.125, 1.0, 0.0));
    let place = SurfacePoint {
        position: dvec3(0.0, 1.0, 0.0),
        normal: DVec3::X,
        facet: u32::MAX,
        seed: 3,
        pixel: Some([0.5; 2]),
    };
    for algorithm in names() {
        with_shadows(
            &scene,
            &[square()],
            &Settings {
                shadows: ShadowSettings { light_samples: 16, ..settings(algorithm).shadows },
                ..settings(algorithm)
            },
            |arriving| {
                assert_eq!(arriving(place), 1.0, "{algorithm}");
            },
        );
    }
    // A shade before the nearer part of that half: the far part has the smaller share.
    add(&mut scene, solids::plane(0.4, 4.0, 1, 1), matt(), dvec3(0.2, 2.5, 0.0));
    for algorithm in names() {
        with_shadows(
            &scene,
            &[square()],
            &Settings {
                shadows: ShadowSettings { light_samples: 1024, ..settings(algorithm).shadows },
                ..settings(algorithm)
            },
            |arriving| {
                if algorithm == "map" {
                    return;
                }
                let found = arriving(place);
                // From above the shade, tan = 0.4 / 1.5, to the light's border: ∫ x / (x² + y² +
                // 4)² by strips.
                let share = |from: f64, to: f64| -> f64 {
                    let strips = (0..400).flat_map(|i| (0..400).map(move |k| (i, k)));
                    let at = strips.map(|(i, k)| {
                        let x = from + (to - from) * (f64::from(i) + 0.5) / 400.0;
                        let z = 1.6 * (f64::from(k) + 0.5) / 400.0 - 0.8;
                        x / ((x * x + z * z + 4.0) * (x * x + z * z + 4.0))
                    });
                    at.sum::<f64>() * (to - from)
                };
                let hidden = 0.4 / 1.5 * 2.0;
                let wanted = share(hidden, 0.8) / share(0.0, 0.8);
                assert!((f64::from(found) - wanted).abs() < 0.03, "{algorithm}: {found}, {wanted}");
            },
        );
    }
}

#[test]
fn odd_area_lights_are_defined() {
    let scene = above_floor(solids::cuboid(DVec3::ONE), Material::default(), dvec3(0.0, 1.5, 0.0));
    let flat = |y: f64, half: f64| {
        let corners = [[-1., -1.], [1., -1.], [1., 1.], [-1., 1.]]
            .map(|[x, z]| dvec3(x * half, y, z * half))
            .to_vec();
        light(LightKind::Area { shape: AreaShape::Polygon { corners } })
    };
    let disc = |center: DVec3, normal: DVec3, radius: f64| {
        light(LightKind::Area { shape: AreaShape::Disc { center, normal, radius } })
    };
    let line = light(LightKind::Area {
        shape: AreaShape::Polygon { corners: vec![DVec3::X, DVec3::Y, DVec3::X] },
    });
    for algorithm in names() {
        let at = |light: &Light, position: DVec3| {
            let lights = std::slice::from_ref(light);
            with_shadows(&scene, lights, &settings(algorithm), |arriving| {
                arriving(place(position, DVec3::Y))
            })
        };
        let beside = dvec3(2.0, 0.0, 0.3);
        assert_eq!(at(&flat(1.5, 0.3), beside), 0.0, "{algorithm}: inside the box");
        assert_eq!(
            at(&flat(1.0, 0.5), dvec3(0.1, 0.0, 0.1)),
            1.0,
            "{algorithm}: on the box's lower side"
        );
        assert_eq!(at(&flat(0.0, 3.0), beside), 0.0, "{algorithm}: in the floor's own plane");
        assert_eq!(at(&disc(dvec3(2.0, 3.0, 0.0), DVec3::NEG_Y, 0.3), beside), 1.0, "{algorithm}");
        assert_eq!(
            at(&disc(dvec3(-2.0, 4.0, 0.0), DVec3::NEG_Y, 0.0), dvec3(2.0, 0.0, 0.0)),
            0.0,
            "{algorithm}: a point"
        );
        // It casts no shadow: it does not shine.
        assert_eq!(at(&line, beside), 1.0, "{algorithm}: a line");
    }
    // Behind the viewer, or with the viewer in its plane: the picture is the same from everywhere.
    let lights = [flat(6.0, 0.5)];
    for algorithm in names() {
        let look = |settings: &Settings| {
            let camera = Camera {
                position: dvec3(1.0, 5.0, 1.0),
                focal_point: dvec3(1.0, 0.0, 0.9),
                view_up: DVec3::NEG_Z,
                projection: Projection::Perspective { view_angle: 0.9 },
                clip: None,
            };
            let mut session = Session::new(Arc::new(scene.clone())).unwrap();
            let shot = Shot {
                camera,
                lights: &lights,
                ambient: [0.0; 3],
                surroundings: Surroundings::default(),
            };
            render(&mut session, &shot, settings, &Execution::default())
                .unwrap()
                .frame
                .color
                .unwrap()
        };
        let [lit, dark] = [settings("none"), settings(algorithm)].map(|s| look(&s));
        let changed = lit.data().iter().zip(dark.data()).filter(|(a, b)| a != b).count();
        assert!(changed > 200 && changed < lit.data().len() / 2, "{algorithm}: {changed}");
    }
}

/// Width of the penumbra behind an edge, along a line across it: from where the first light is seen
/// to where all of it is; and by the slope in its middle.
fn penumbra(algorithm: &str, shape: AreaShape, samples: u32) -> [f64; 2] {
    // A board whose edge runs along z through x = 0, at height 1; the light is 2 above it.
    let scene =
        above_floor(solids::plane(4.0, 8.0, 1, 1), Material::default(), dvec3(-2.0, 1.0, 0.0));
    let settings = Settings {
        shadows: ShadowSettings { light_samples: samples, ..settings(algorithm).shadows },
        ..settings(algorithm)
    };
    with_shadows(&scene, &[light(LightKind::Area { shape })], &settings, |arriving| {
        let at = |x: f64| {
            let parts = (0..32)
                .map(|seed| arriving(SurfacePoint { seed, ..place(dvec3(x, 0.0, 0.0), DVec3::Y) }));
            f64::from(parts.sum::<f32>()) / 32.0
        };
        assert_eq!((at(-1.0), at(1.0)), (0.0, 1.0), "umbra and full light");
        // Halve the interval in which it begins, and the one in which it ends.
        let change = |above: f64| {
            let (mut low, mut high) = (-1.0, 1.0);
            for _ in 0..14 {
                let middle = 0.5 * (low + high);
                if at(middle) > above { high = middle } else { low = middle }
            }
            high
        };
        let (x, step) = (-0.1, 0.2);
        [change(1.0 - 1e-6) - change(1e-6), step / (at(x + step) - at(x))]
    })
}

#[test]
fn f27_the_penumbra_is_as_wide_as_the_light_times_b_over_a() {
    let corners = [[-0.4, -0.4], [0.4, -0.4], [0.4, 0.4], [-0.4, 0.4]]
        .map(|[x, z]| dvec3(x, 3.0, z))
        .to_vec();
    // D = 0.8, a = 2, b = 1.
    let square = AreaShape::Polygon { corners };
    let [width, slope] = penumbra("ray", square.clone(), 256);
    assert!((width / 0.4 - 1.0).abs() < 0.02, "{width}");
    // The light's middle is 1 part in 40 brighter than its border, as seen from here.
    assert!((slope / 0.4 - 1.0).abs() < 0.03, "{slope}");
    // The same 64 places serve all points: steps of an eighth.
    for algorithm in names().filter(|&name| name != "ray") {
        let [_, slope] = penumbra(algorithm, square.clone(), 64);
        assert!((slope / 0.4 - 1.0).abs() < 0.15, "{algorithm}: {slope}");
    }
    let disc = AreaShape::Disc { center: dvec3(0.0, 3.0, 0.0), normal: DVec3::NEG_Y, radius: 0.4 };
    let [width, slope] = penumbra("ray", disc, 256);
    assert!((width / 0.4 - 1.0).abs() < 0.02, "{width}");
    // Through its middle the lit part rises by 4 / (π D) of its width.
    let t: f64 = 0.5;
    let share =
        2.0 / std::f64::consts::PI * (t * (1.0 - t * t).sqrt() + std::f64::consts::FRAC_PI_6);
    assert!((slope / (0.2 / share) - 1.0).abs() < 0.03, "{slope}");
}

/// Width of the penumbra behind the edge of `penumbra` by all of its course: six times the integral
/// of `f (1 - f)`, which for a part `f` of the light that rises evenly is where it rises.
fn width(algorithm: &str, shape: AreaShape, samples: u32) -> f64 {
    let scene =
        above_floor(solids::plane(4.0, 8.0, 1, 1), Material::default(), dvec3(-2.0, 1.0, 0.0));
    let settings = Settings {
        shadows: ShadowSettings { light_samples: samples, ..settings(algorithm).shadows },
        ..settings(algorithm)
    };
    with_shadows(&scene, &[light(LightKind::Area { shape })], &settings, |arriving| {
        // Chance differs from place to place, so that its mean is what is seen along the edge.
        let seeds = if algorithm == "ray" { 1024_u32.div_ceil(samples) } else { 1 };
        let part = |x: f64| {
            let parts = (0..seeds)
                .map(|seed| arriving(SurfacePoint { seed, ..place(dvec3(x, 0.0, 0.0), DVec3::Y) }));
            f64::from(parts.sum::<f32>()) / f64::from(seeds)
        };
        let step = 1.0 / 400.0;
        let course = (-200..200).map(|i| part((f64::from(i) + 0.5) * step));
        course.map(|f| 6.0 * f * (1.0 - f) * step).sum()
    })
}

#[test]
fn f27_sixteen_samples_show_penumbrae_as_wide_as_they_are() {
    let turned = |degrees: f64| {
        let (sin, cos) = vitral_math::func::sin_cos(degrees.to_radians());
        let corner = |x: f64, z: f64| dvec3(cos * x - sin * z, 3.0, sin * x + cos * z);
        AreaShape::Polygon {
            corners: vec![
                corner(-0.4, -0.4),
                corner(0.4, -0.4),
                corner(0.4, 0.4),
                corner(-0.4, 0.4),
            ],
        }
    };
    let disc = AreaShape::Disc { center: dvec3(0.0, 3.0, 0.0), normal: DVec3::NEG_Y, radius: 0.4 };
    for shape in [turned(0.0), turned(20.0), turned(45.0), turned(-45.0), disc] {
        let right = width("ray", shape.clone(), 4096);
        for algorithm in names() {
            let found = width(algorithm, shape.clone(), 16);
            assert!(
                (found / right - 1.0).abs() < 0.05,
                "{algorithm}, {shape:?}: {found}, {right} by 4096 rays"
            );
        }
    }
}
