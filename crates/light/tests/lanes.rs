//! One point at a time and eight at a time give the same bits, at every level of the instruction
//! set.

use vitral_light::*;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, LANES, Lanes, V3, available_levels, dispatch};
use vitral_math::{DMat4, DVec3, dvec3};

/// Eight values for each of the inputs of the formulas.
type Inputs = [[f32; LANES]; 14];
/// Eight values for each output channel.
type Outputs = Vec<[f32; LANES]>;

/// Numbers without pattern in `-1..1`.
fn inputs(seed: u32) -> Inputs {
    let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(12_345);
    let mut inputs = [[0.0; LANES]; 14];
    for value in inputs.iter_mut().flatten() {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *value = (state >> 8) as f32 / 8_388_608.0 - 1.0;
    }
    // One lane with a zero normal, one with the viewer behind.
    for k in 3..6 {
        inputs[k][2] = 0.0;
        inputs[k + 3][5] = -inputs[k][5];
    }
    inputs
}

fn lights() -> Vec<PreparedLight> {
    let at = dvec3(0.3, 1.2, 0.7);
    let corners = vec![at, at + DVec3::X, at + DVec3::X + DVec3::Z];
    let kinds = [
        LightKind::Ambient,
        LightKind::Directional { direction: dvec3(0.2, -1.0, -0.4) },
        LightKind::Point { position: at },
        LightKind::Spot { position: at, direction: -at, cutoff: 0.9, inner: 0.5, exponent: 3.5 },
        LightKind::Spot { position: at, direction: -at, cutoff: 0.7, inner: 0.7, exponent: 0.0 },
        LightKind::Area { shape: AreaShape::Polygon { corners } },
        LightKind::Area { shape: AreaShape::Disc { center: at, normal: -at, radius: 0.4 } },
    ];
    let losses = [
        Attenuation::None,
        Attenuation::InverseSquare,
        Attenuation::Clamped { c1: 0.3, c2: 0.2, c3: 0.5 },
        Attenuation::Gl { constant: 0.1, linear: 0.2, quadratic: 0.3 },
        Attenuation::Range { range: 1.7 },
    ];
    let all = kinds.iter().flat_map(|kind| losses.map(|attenuation| (kind.clone(), attenuation)));
    all.map(|(kind, attenuation)| Light {
        kind,
        attenuation,
        ambient: [0.1, 0.0, 0.2],
        ..Light::default()
    })
    .filter_map(|light| PreparedLight::new(&light, &DMat4::IDENTITY))
    .collect()
}

/// Every formula of the crate, on one lane or eight.
#[inline(always)]
fn formulas<T: Lanes>(lights: &[PreparedLight], x: [T; 14], out: &mut impl FnMut(T)) {
    let [px, py, pz, nx, ny, nz, vx, vy, vz, r, g, b, a, e] = x;
    let s = Surface {
        position: V3::new(px, py, pz),
        n: V3::new(nx, ny, nz).normalize(),
        v: V3::new(vx, vy, vz).normalize(),
    };
    let color = V3::new(r.abs(), g.abs(), b.abs());
    let k = Phong {
        ka: color,
        kd: color,
        ks: V3::new(b.abs(), r.abs(), a.abs()),
        shininess: (e + 1.0) * 60.0,
    };
    let m =
        Microfacet { base_color: color, metallic: a.abs(), roughness: e.abs(), occlusion: b.abs() };
    let mut put = |r: Reflected<T>| {
        for channel in
            [r.diffuse.x, r.diffuse.y, r.diffuse.z, r.specular.x, r.specular.y, r.specular.z]
        {
            out(channel);
        }
    };
    for light in lights {
        let light = std::slice::from_ref(light);
        for model in [Illumination::Lambert, Illumination::Phong, Illumination::BlinnPhong] {
            put(phong(
                model,
                light,
                [0.1; 3],
                &s,
                &k,
                |_| V3::new(a.saturate(), a.saturate(), a.saturate()),
                |l| l.direction_rounding(s.position),
            ));
        }
        put(cook_torrance(light, [0.1; 3], &s, &m, |_| {
            V3::new(a.saturate(), a.saturate(), a.saturate())
        }));
    }
    put(phong(
        Illumination::Phong,
        lights,
        [0.1; 3],
        &s,
        &phong_from_microfacet(&m),
        |_| V3::splat(e, [1.0; 3]),
        |_| e * 0.0,
    ));
    put(cook_torrance(lights, [0.1; 3], &s, &microfacet_from_phong(&k), |_| {
        V3::splat(e, [1.0; 3])
    }));
}

#[test]
fn one_point_and_eight_give_the_same_bits_at_every_level() {
    let lights = lights();
    assert_eq!(lights.len(), 35);
    for seed in 0..20 {
        let x = inputs(seed);
        let mut expected: Outputs = Vec::new();
        for lane in 0..LANES {
            let mut k = 0;
            formulas(&lights, x.map(|values| values[lane]), &mut |value: f32| {
                if lane == 0 {
                    expected.push([0.0; LANES]);
                }
                expected[k][lane] = value;
                k += 1;
            });
        }
        for (name, level) in available_levels() {
            let mut wide: Outputs = Vec::new();
            dispatch!(level, simd => {
                let x = x.map(|values| F32x8::from_slice(simd, &values));
                formulas(&lights, x, &mut |value: F32x8<_>| wide.push(value.to_array()));
            });
            assert_eq!(wide.len(), expected.len());
            for (k, (w, e)) in wide.iter().zip(&expected).enumerate() {
                assert_eq!(
                    w.map(f32::to_bits),
                    e.map(f32::to_bits),
                    "{name}, seed {seed}, output {k}: {w:?}, {e:?}"
                );
            }
        }
    }
}
