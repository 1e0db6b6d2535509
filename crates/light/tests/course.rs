//! The checks of the course notes on lights and reflection, each named after its item.

use proptest::prelude::*;
use vitral_light::*;
use vitral_math::lanes::V3;
use vitral_math::{DMat4, DVec3, dvec3, func};

type Point = Surface<f32>;

/// A direction in the xz plane, `degrees` away from +z towards +x.
fn leaning(degrees: f64) -> DVec3 {
    let (sin, cos) = func::sin_cos(degrees.to_radians());
    dvec3(sin, 0.0, cos)
}

fn v3(v: DVec3) -> V3<f32> {
    V3::splat(0.0, v.as_vec3().to_array())
}

fn rgb(v: V3<f32>) -> [f32; 3] {
    [v.x, v.y, v.z]
}

/// The origin, with normal +z.
fn point(v: DVec3) -> Point {
    Surface { position: v3(DVec3::ZERO), n: v3(DVec3::Z), v: v3(v) }
}

fn sun(towards: DVec3) -> Light {
    Light { kind: LightKind::Directional { direction: -towards }, ..Light::default() }
}

fn prepared(lights: &[Light]) -> Vec<PreparedLight> {
    lights.iter().filter_map(|light| PreparedLight::new(light, &DMat4::IDENTITY)).collect()
}

fn material(ka: f32, kd: f32, ks: f32, shininess: f32) -> Phong<f32> {
    let grey = |k: f32| V3::splat(0.0, [k; 3]);
    Phong { ka: grey(ka), kd: grey(kd), ks: grey(ks), shininess }
}

fn lit(
    model: Illumination,
    lights: &[Light],
    ambient: Rgb,
    s: &Point,
    k: &Phong<f32>,
) -> Reflected<f32> {
    phong(model, &prepared(lights), ambient, s, k, |_| V3::new(1.0, 1.0, 1.0), |_| 0.0)
}

#[test]
fn l3_diffuse_is_the_cosine() {
    for (degrees, expected) in [(0.0, 1.0), (60.0, 0.5), (90.0, 0.0)] {
        let k = material(0.0, 1.0, 0.0, 1.0);
        let r =
            lit(Illumination::Lambert, &[sun(leaning(degrees))], [0.0; 3], &point(DVec3::Z), &k);
        assert!((r.diffuse.x - expected).abs() < 1e-6, "{degrees}: {}", r.diffuse.x);
    }
}

#[test]
fn l4_specular_is_a_power_of_the_cosine() {
    let k = material(0.0, 0.0, 1.0, 10.0);
    let r = lit(Illumination::Phong, &[sun(leaning(20.0))], [0.0; 3], &point(leaning(-50.0)), &k);
    assert!((r.specular.x - 0.237_30).abs() < 1e-5, "{}", r.specular.x);

    // It varies over a plane, because the direction to a viewer at finite distance does.
    let at = |x: f64| {
        let position = dvec3(x, 0.0, 0.0);
        let s = Surface {
            position: v3(position),
            ..point((dvec3(0.0, 0.0, 2.0) - position).normalize())
        };
        lit(Illumination::Phong, &[sun(DVec3::Z)], [0.0; 3], &s, &k).specular.x
    };
    assert!(at(0.0) > at(0.5) && at(0.5) > at(1.0));
}

#[test]
fn l5_the_total_is_the_sum_of_the_layers() {
    let lights = [sun(leaning(35.0))];
    let s = point(leaning(-20.0));
    let (a, d, p) =
        (material(0.3, 0.0, 0.0, 9.0), material(0.0, 0.6, 0.0, 9.0), material(0.0, 0.0, 0.5, 9.0));
    let layer = |k: &Phong<f32>| {
        let r = lit(Illumination::Phong, &lights, [0.4; 3], &s, k);
        r.diffuse.x + r.specular.x
    };
    let sum = layer(&a) + layer(&d) + layer(&p);
    assert!((layer(&material(0.3, 0.6, 0.5, 9.0)) - sum).abs() < 1e-6);
    assert_eq!(layer(&a), 0.3 * 0.4);
}

#[test]
fn p31_ambient_is_the_exact_product_per_channel() {
    let k = Phong { ka: V3::new(0.25, 0.5, 0.75), ..material(0.0, 1.0, 1.0, 9.0) };
    let sky = Light { kind: LightKind::Ambient, ambient: [0.5, 0.25, 0.125], ..Light::default() };
    let r =
        lit(Illumination::Ambient, &[sky, sun(DVec3::Z)], [0.5, 1.0, 2.0], &point(DVec3::Z), &k);
    assert_eq!(rgb(r.diffuse), [0.25 * 1.0, 0.5 * 1.25, 0.75 * 2.125]);
    assert_eq!(rgb(r.specular), [0.0; 3]);
}

#[test]
fn p32_every_kind_of_light_reaches_the_surface_below_it() {
    let above = dvec3(0.0, 0.0, 2.0);
    let disc = AreaShape::Disc { center: above, normal: DVec3::NEG_Z, radius: 0.5 };
    let kinds = [
        LightKind::Directional { direction: DVec3::NEG_Z },
        LightKind::Point { position: above },
        LightKind::Spot {
            position: above,
            direction: DVec3::NEG_Z,
            cutoff: 0.4,
            inner: 0.4,
            exponent: 3.0,
        },
        LightKind::Area { shape: disc },
    ];
    for kind in kinds {
        let light = Light { kind, ..Light::default() };
        let k = material(0.0, 1.0, 0.0, 9.0);
        let r = lit(
            Illumination::Lambert,
            std::slice::from_ref(&light),
            [0.0; 3],
            &point(DVec3::Z),
            &k,
        );
        // A disc's border is seen from the side: F = R² / (R² + h²), in units of what would come
        // from its middle; without loss over the way, which is √(h² + R² / 2) in the mean.
        let whole = if matches!(light.kind, LightKind::Area { .. }) { 4.125 / 4.25 } else { 1.0 };
        assert!((r.diffuse.x - whole).abs() < 1e-6, "{light:?}: {}", r.diffuse.x);
    }
}

#[test]
fn area_lights_send_what_their_whole_shape_sends() {
    let k = material(0.0, 1.0, 0.0, 9.0);
    let ceiling = |center: DVec3, half: f64, attenuation: Attenuation| {
        let corners = [[-1., -1.], [-1., 1.], [1., 1.], [1., -1.]]
            .map(|[x, y]| center + dvec3(x, y, 0.0) * half);
        let shape = AreaShape::Polygon { corners: corners.to_vec() };
        Light { kind: LightKind::Area { shape }, attenuation, ..Light::default() }
    };
    let get = |light: &Light, n: DVec3| {
        let surface = Surface { n: v3(n), ..point(n) };
        lit(Illumination::Lambert, std::slice::from_ref(light), [0.0; 3], &surface, &k).diffuse.x
    };
    // Under the middle of a square, by the inverse square: E = 4 · 2 A / √(1 + A²) atan(A / √(1 +
    // A²)) / 2 / area.
    let square = ceiling(DVec3::Z, 1.0, Attenuation::InverseSquare);
    let wanted = 4.0 * (0.5f64.sqrt() * func::atan2(0.5f64.sqrt(), 1.0)) / 4.0;
    assert!(
        (f64::from(get(&square, DVec3::Z)) - wanted).abs() < 1e-6,
        "{} {wanted}",
        get(&square, DVec3::Z)
    );
    // Its middle is below the horizon, but not all of it: the integral summed over 16 million
    // points.
    let tilted = dvec3(1.0, 0.0, -0.2).normalize();
    assert!((get(&square, tilted) - 0.049_403_6).abs() < 1e-5, "{}", get(&square, tilted));
    assert_eq!(get(&square, DVec3::NEG_Z), 0.0);
    // Far away it is a point, by any law.
    let laws = [
        Attenuation::None,
        Attenuation::InverseSquare,
        Attenuation::Clamped { c1: 0.2, c2: 0.01, c3: 0.001 },
    ];
    for attenuation in laws {
        let at = dvec3(30.0, 0.0, 40.0);
        let whole = get(&ceiling(at, 0.3, attenuation), DVec3::Z);
        let loss = match attenuation {
            Attenuation::InverseSquare => 1.0 / 2500.0,
            Attenuation::Clamped { .. } => 1.0 / (0.2 + 0.5 + 2.5),
            _ => 1.0,
        };
        assert!((whole / (0.64 * loss) - 1.0).abs() < 2e-4, "{attenuation:?}: {whole}");
    }
    // No size at all is a point that shines to one side.
    let disc = AreaShape::Disc { center: dvec3(3.0, 0.0, 4.0), normal: DVec3::NEG_Z, radius: 0.0 };
    let dot = Light { kind: LightKind::Area { shape: disc }, ..Light::default() };
    assert!((get(&dot, DVec3::Z) - 0.64).abs() < 1e-6);
    let bad = |radius| AreaShape::Disc { center: DVec3::Z, normal: DVec3::NEG_Z, radius };
    for radius in [f64::NAN, f64::INFINITY] {
        let light = Light { kind: LightKind::Area { shape: bad(radius) }, ..Light::default() };
        assert_eq!(PreparedLight::new(&light, &DMat4::IDENTITY), None);
    }
}

#[test]
fn p33_lambert_does_not_depend_on_the_viewer() {
    let k = material(0.1, 0.7, 0.5, 9.0);
    let lamp =
        Light { kind: LightKind::Point { position: dvec3(1.0, 2.0, 3.0) }, ..Light::default() };
    for degrees in [-80.0, -30.0, 15.0, 60.0] {
        let n = leaning(degrees);
        let seen_by = |v: DVec3| {
            let s = Surface { position: v3(n), n: v3(n), v: v3(v.normalize()) };
            rgb(lit(Illumination::Phong, std::slice::from_ref(&lamp), [0.2; 3], &s, &k).diffuse)
        };
        assert_eq!(seen_by(n + DVec3::X), seen_by(n + DVec3::Y * 3.0));
    }
    // Only up to 90 degrees.
    assert_eq!(
        lit(Illumination::Lambert, &[sun(leaning(100.0))], [0.0; 3], &point(DVec3::Z), &k)
            .diffuse
            .x,
        0.0
    );
}

#[test]
fn p34_ambient_and_diffuse() {
    let k = Phong { kd: V3::new(0.9, 0.6, 0.3), ..material(0.2, 0.0, 0.0, 1.0) };
    let lamp = Light { diffuse: [1.0, 0.5, 2.0], ..sun(leaning(60.0)) };
    let r = lit(Illumination::Lambert, &[lamp], [0.1, 0.2, 0.3], &point(DVec3::Z), &k);
    for (got, expected) in rgb(r.diffuse).into_iter().zip([0.02 + 0.45, 0.04 + 0.15, 0.06 + 0.3]) {
        assert!((got - expected).abs() < 1e-6, "{got}, expected {expected}");
    }
}

#[test]
fn p35_a_highlight_has_the_colour_of_the_light_except_on_metals() {
    let color = [1.0, 0.5, 0.25];
    let lamp = Light { diffuse: color, specular: color, ..sun(DVec3::Z) };
    let hue = |c: [f32; 3]| [c[1] / c[0], c[2] / c[0]];
    let near = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).abs() < 0.02 && (a[1] - b[1]).abs() < 0.02;

    // A red apple, polished: the highlight outshines the red.
    let base_color = V3::new(0.8f32, 0.05, 0.05);
    let shown = |metallic: f32, lamp: &Light| {
        let m = Microfacet { base_color, metallic, roughness: 0.2, occlusion: 1.0 };
        let r = cook_torrance(
            &prepared(std::slice::from_ref(lamp)),
            [0.0; 3],
            &point(DVec3::Z),
            &m,
            |_| V3::new(1.0, 1.0, 1.0),
        );
        (rgb(r.specular), rgb(r.diffuse + r.specular))
    };
    let (specular, total) = shown(0.0, &lamp);
    assert!(near(hue(specular), [0.5, 0.25]), "{specular:?}");
    assert!(
        (hue(total)[0] - 0.5).abs() < 0.08,
        "the centre tends to the light's colour: {total:?}"
    );

    // The same in copper: the light's colour times the metal's.
    let white = Light { specular: [1.0; 3], ..lamp.clone() };
    assert!(near(hue(shown(1.0, &white).1), [0.05 / 0.8, 0.05 / 0.8]));

    // Phong says the same with a grey ks.
    let k = Phong { kd: base_color, ..material(0.0, 0.0, 1.0, 50.0) };
    assert!(near(
        hue(rgb(lit(Illumination::Phong, &[lamp], [0.0; 3], &point(DVec3::Z), &k).specular)),
        [0.5, 0.25]
    ));
}

/// Angle in degrees between viewer and mirror direction at which a highlight has half its height.
fn half_width(model: Illumination, shininess: f32) -> f64 {
    let k = material(0.0, 0.0, 1.0, shininess);
    let (mut inside, mut outside) = (0.0, 90.0);
    for _ in 0..40 {
        let middle = (inside + outside) / 2.0;
        let r = lit(model, &[sun(DVec3::Z)], [0.0; 3], &point(leaning(middle)), &k);
        if r.specular.x > 0.5 { inside = middle } else { outside = middle }
    }
    inside
}

#[test]
fn p37_the_half_width_of_a_highlight() {
    for exponent in [1.0f32, 2.0, 10.0, 50.0, 200.0] {
        let expected = func::acos(func::exp2(-1.0 / f64::from(exponent))).to_degrees();
        let got = half_width(Illumination::Phong, exponent);
        assert!((got - expected).abs() < 2e-3, "n = {exponent}: {got}, expected {expected}");
    }
    assert!((half_width(Illumination::Phong, 200.0) - 4.77).abs() < 0.005);
}

#[test]
fn p41_blinn_needs_four_times_the_exponent() {
    for exponent in [10.0f32, 30.0, 100.0] {
        let ratio = half_width(Illumination::BlinnPhong, 4.0 * exponent)
            / half_width(Illumination::Phong, exponent);
        assert!((ratio - 1.0).abs() < 0.02, "n = {exponent}: {ratio}");
    }
}

#[test]
fn p39_lights_add_up_channel_by_channel() {
    let lights: Vec<Light> = (0..8)
        .map(|i| Light {
            kind: LightKind::Point { position: leaning(f64::from(i) * 17.0 - 60.0) * 3.0 },
            diffuse: [0.1 * i as f32, 0.5, 0.3],
            specular: [0.2, 0.1 * i as f32, 0.7],
            ambient: [0.01; 3],
            attenuation: Attenuation::Clamped { c1: 0.2, c2: 0.1, c3: 0.1 },
            ..Light::default()
        })
        .collect();
    let s = point(leaning(10.0));
    let k = material(0.3, 0.6, 0.5, 20.0);
    let m = microfacet_from_phong(&k);
    let shine = |lights: &[Light]| {
        let p = lit(Illumination::Phong, lights, [0.0; 3], &s, &k);
        let c = cook_torrance(&prepared(lights), [0.0; 3], &s, &m, |_| V3::new(1.0, 1.0, 1.0));
        [rgb(p.diffuse), rgb(p.specular), rgb(c.diffuse), rgb(c.specular)].concat()
    };
    let mut sum = vec![0.0; 12];
    for light in &lights {
        for (total, part) in sum.iter_mut().zip(shine(std::slice::from_ref(light))) {
            *total += part;
        }
    }
    for (together, total) in shine(&lights).into_iter().zip(sum) {
        assert!(
            (together - total).abs() <= 1e-5 * total.abs().max(1.0),
            "{together}, one by one {total}"
        );
    }
}

#[test]
fn p40_two_parallel_surfaces_differ_by_their_distance() {
    let lamp = |attenuation| {
        let kind = LightKind::Point { position: DVec3::Z * 2.0 };
        Light { kind, attenuation, ..Light::default() }
    };
    let at = |attenuation, z: f64| {
        let s = Surface { position: v3(DVec3::Z * z), ..point(DVec3::Z) };
        lit(
            Illumination::Lambert,
            &[lamp(attenuation)],
            [0.0; 3],
            &s,
            &material(0.0, 1.0, 0.0, 1.0),
        )
        .diffuse
        .x
    };
    assert_eq!(
        at(Attenuation::None, 0.0),
        at(Attenuation::None, -2.0),
        "without attenuation they merge"
    );
    assert_eq!(at(Attenuation::InverseSquare, 0.0) / at(Attenuation::InverseSquare, -2.0), 4.0);
    let clamped = Attenuation::Clamped { c1: 1.0, c2: 0.0, c3: 1.0 };
    assert_eq!((at(clamped, 0.0), at(clamped, -2.0)), (0.2, 1.0 / 17.0));
}

#[test]
fn e12_reflectance_is_reflected_over_incident() {
    // A sky of 1 over a Lambert surface: what comes back over what arrives is kd.
    let k = material(0.0, 0.6, 0.0, 1.0);
    let (mut arrived, mut reflected) = (0.0, 0.0);
    for i in 0..90 {
        let (sin, cos) = func::sin_cos((f64::from(i) + 0.5).to_radians());
        let r = lit(
            Illumination::Lambert,
            &[sun(leaning(f64::from(i) + 0.5))],
            [0.0; 3],
            &point(DVec3::Z),
            &k,
        );
        arrived += sin * cos;
        reflected += sin * f64::from(r.diffuse.x);
    }
    assert!((reflected / arrived - 0.6).abs() < 1e-6);
}

#[test]
fn f20_shadow_takes_all_but_ambient_light() {
    let lights = prepared(&[Light { ambient: [0.5; 3], ..sun(DVec3::Z) }]);
    let k = material(0.4, 0.6, 0.5, 20.0);
    let r = phong(
        Illumination::Phong,
        &lights,
        [0.25; 3],
        &point(DVec3::Z),
        &k,
        |_| V3::new(0.0, 0.0, 0.0),
        |_| 0.0,
    );
    assert!((r.diffuse.x - 0.3).abs() < 1e-7 && r.specular.x == 0.0);
}

/// Any light, degenerate ones included.
fn any_light() -> impl Strategy<Value = Light> {
    let vector = || {
        prop_oneof![
            Just(DVec3::ZERO),
            proptest::array::uniform3(-5.0f64..5.0).prop_map(DVec3::from)
        ]
    };
    let kind = prop_oneof![
        Just(LightKind::Ambient),
        vector().prop_map(|direction| LightKind::Directional { direction }),
        vector().prop_map(|position| LightKind::Point { position }),
        (vector(), vector(), -0.1f64..2.0, 0.0f64..2.0, 0.0f64..200.0).prop_map(
            |(position, direction, cutoff, inner, exponent)| LightKind::Spot {
                position,
                direction,
                cutoff,
                inner,
                exponent
            }
        ),
        (vector(), vector()).prop_map(|(center, normal)| LightKind::Area {
            shape: AreaShape::Disc { center, normal, radius: 1.0 }
        }),
    ];
    let attenuation = prop_oneof![
        Just(Attenuation::None),
        Just(Attenuation::InverseSquare),
        proptest::array::uniform3(-1.0f64..1.0).prop_map(|[constant, linear, quadratic]| {
            Attenuation::Gl { constant, linear, quadratic }
        }),
        proptest::array::uniform3(0.0f64..1.0).prop_map(|[c1, c2, c3]| Attenuation::Clamped {
            c1,
            c2,
            c3
        }),
        (-1.0f64..9.0).prop_map(|range| Attenuation::Range { range }),
    ];
    (kind, attenuation, proptest::array::uniform3(0.0f32..1e6)).prop_map(
        |(kind, attenuation, diffuse)| Light { kind, attenuation, diffuse, ..Light::default() },
    )
}

fn any_unit() -> impl Strategy<Value = V3<f32>> {
    prop_oneof![
        Just([0.0f32; 3]),
        Just([0.0, 0.0, 1.0]),
        Just([0.0, 0.0, -1.0]),
        Just([1.0, 0.0, 0.0]),
        proptest::array::uniform3(-1.0f32..1.0)
    ]
    .prop_map(|v| V3::splat(0.0f32, v).normalize())
}

fn any_position() -> impl Strategy<Value = V3<f32>> {
    prop_oneof![
        Just([0.0f32; 3]),
        Just([f32::MAX, -f32::MAX, 0.0]),
        Just([1e-30, 0.0, 0.0]),
        proptest::array::uniform3(-5.0f32..5.0)
    ]
    .prop_map(|p| V3::splat(0.0, p))
}

proptest! {
    #[test]
    fn finite_input_gives_finite_output(
        lights in proptest::collection::vec(any_light(), 0..4),
        position in any_position(), n in any_unit(), v in any_unit(),
        ks in proptest::array::uniform3(0.0f32..1.0),
        scalars in proptest::array::uniform3(prop_oneof![Just(0.0f32), Just(1.0), 0.0f32..1.0, -2.0f32..2000.0]),
    ) {
        let lights = prepared(&lights);
        let s = Surface { position, n, v };
        let [metallic, roughness, shininess] = scalars;
        let k = Phong { ks: V3::splat(0.0, ks), ..material(0.3, 0.5, 0.0, shininess) };
        let m = Microfacet { base_color: k.ks, metallic, roughness, occlusion: 1.0 };
        let mut results = vec![];
        for model in Illumination::ALL {
            results.push(phong(model, &lights, [0.1; 3], &s, &k, |_| V3::new(1.0, 1.0, 1.0), |_| 0.0));
            results.push(phong(model, &lights, [0.1; 3], &s, &phong_from_microfacet(&m), |_| V3::new(1.0, 1.0, 1.0), |_| 0.0));
        }
        results.push(cook_torrance(&lights, [0.1; 3], &s, &m, |_| V3::new(1.0, 1.0, 1.0)));
        results.push(cook_torrance(&lights, [0.1; 3], &s, &microfacet_from_phong(&k), |_| V3::new(1.0, 1.0, 1.0)));
        for r in results {
            for channel in [rgb(r.diffuse), rgb(r.specular)].concat() {
                prop_assert!(channel.is_finite() && channel >= 0.0, "{r:?}");
            }
        }
    }
}
