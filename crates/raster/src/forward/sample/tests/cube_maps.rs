//! Cube maps: faces, their orientation, seams.

use super::*;

/// Faces of `side x side` texels; red is `20 * face + texel`, in bytes.
fn cube(side: u32, sampler: Sampler) -> Texture {
    let faces = (0..6u8).map(|face| {
        let values: Vec<u8> = (0..(side * side) as u8).map(|i| 20 * face + i).collect();
        vec![level([side, side, 1], 0, reds(&values))]
    });
    texture(TextureKind::Cube, faces.collect(), sampler)
}

fn toward(texture: &Texture, direction: [f32; 3]) -> f32 {
    let [x, y, z] = direction;
    at(texture, [x, y, z, 1.0], -1.0)[0] * 255.0
}

#[test]
fn all_six_faces_are_turned_as_specified() {
    let t = cube(2, NEAREST);
    // Directions to texel (0, 0) of each face: sc and tc negative in table 3.20.
    for (face, first) in [
        [1.0, 0.5, 0.5],
        [-1.0, 0.5, -0.5],
        [-0.5, 1.0, -0.5],
        [-0.5, -1.0, 0.5],
        [-0.5, 0.5, 1.0],
        [0.5, 0.5, -1.0],
    ]
    .into_iter()
    .enumerate()
    {
        assert!(close(toward(&t, first), 20.0 * face as f32), "face {face}");
        assert!(
            close(toward(&t, first.map(|c| c * 7.0)), 20.0 * face as f32),
            "length does not matter"
        );
    }
    // And the texel one to the right (s grows), then one up (t grows).
    for (face, s_axis, t_axis, centre) in [
        (0, [0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]),
        (1, [0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]),
        (2, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        (3, [1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, -1.0, 0.0]),
        (4, [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]),
        (5, [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]),
    ] {
        for (texel, s, v) in [(0, -0.5, -0.5), (1, 0.5, -0.5), (2, -0.5, 0.5), (3, 0.5, 0.5f32)] {
            let direction = [0, 1, 2].map(|k: usize| centre[k] + s * s_axis[k] + v * t_axis[k]);
            assert!(
                close(toward(&t, direction), 20.0 * face as f32 + texel as f32),
                "face {face} texel {texel}"
            );
        }
    }
}

#[test]
fn a_negative_q_turns_the_direction_round() {
    for t in [cube(2, NEAREST), cube(2, linear(Wrap::ClampToEdge))] {
        for [x, y, z] in [[1.0, 0.5, 0.5], [-0.5, 1.0, -0.5], [0.5, 0.5, -1.0]] {
            assert_eq!(at(&t, [x, y, z, -2.0], -1.0), at(&t, [-x, -y, -z, 1.0], -1.0));
            assert_eq!(at(&t, [x, y, z, 2.0], -1.0), at(&t, [x, y, z, 1.0], -1.0));
        }
    }
}

#[test]
fn a_seam_is_half_of_each_face() {
    let seamless = Sampler { seamless: true, ..linear(Wrap::Repeat) };
    let t = cube(2, seamless);
    // Between +x texel (0, 0) and +z texel (1, 0), then +z and +y at the top.
    assert!(close(toward(&t, [1.0, 0.5, 1.0]), (0.0 + 81.0) / 2.0));
    assert!(close(toward(&t, [-0.5, 1.0, 1.0]), (80.0 + 42.0) / 2.0));
    // Without, each face clamps: the major axis is x where both are equal.
    let apart = cube(2, linear(Wrap::ClampToEdge));
    assert!(close(toward(&apart, [1.0, 0.5, 1.0]), 0.0));
    assert!(close(toward(&apart, [0.999, 0.5, 1.0]), 81.0));
    // At a corner three texels meet: +x (0, 0), +y (1, 1), +z (1, 0).
    assert!(close(toward(&t, [1.0, 1.0, 1.0]), (0.0 + 43.0 + 81.0) / 3.0));
}

#[test]
fn seams_agree_from_both_sides() {
    let t = cube(4, Sampler { seamless: true, ..linear(Wrap::ClampToEdge) });
    let signs = [-1.0f32, 1.0];
    for a in signs {
        for b in signs {
            for i in -9..10 {
                let c = i as f32 / 10.0;
                for axes in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
                    let mut direction = [0.0; 3];
                    direction[axes[2]] = c;
                    let mut sides = [0.0; 2];
                    for (k, side) in sides.iter_mut().enumerate() {
                        direction[axes[0]] = a * if k == 0 { 1.000_01 } else { 1.0 };
                        direction[axes[1]] = b * if k == 0 { 1.0 } else { 1.000_01 };
                        *side = toward(&t, direction);
                    }
                    assert!((sides[0] - sides[1]).abs() < 0.02, "{direction:?}: {sides:?}");
                }
            }
        }
    }
}

#[test]
fn eight_lanes_may_look_at_six_faces() {
    let t = cube(2, NEAREST);
    let x = [1.0, -1.0, -0.5, -0.5, -0.5, 0.5, 1.0, -1.0];
    let y = [0.5, 0.5, 1.0, -1.0, 0.5, 0.5, 0.5, 0.5];
    let z = [0.5, -0.5, -0.5, 0.5, 1.0, -1.0, 0.5, -0.5];
    let out = look(&t, std::array::from_fn(|i| [x[i], y[i], z[i], 1.0]), [0.0; 8], 0xff);
    assert_eq!(out.map(|c| (c[0] * 255.0).round()), [0., 20., 40., 60., 80., 100., 0., 20.]);
}

#[test]
fn derivatives_follow_the_face() {
    let t = cube(8, NEAREST);
    for (c, dx) in [
        ([2.0f32, 0.5, -0.25], [0.05f32, 0.02, -0.01]),
        ([-2.0, 0.5, -0.25], [0.05, 0.02, -0.01]),
        ([0.5, 3.0, -0.25], [0.05, 0.02, 0.1]),
        ([0.5, -3.0, -0.25], [0.05, 0.02, 0.1]),
        ([0.5, 0.25, 1.0], [0.05, 0.02, 0.01]),
        ([0.5, 0.25, -1.0], [0.05, 0.02, 0.01]),
    ] {
        // Texel coordinates on the face, by the table.
        let project = |h: f64| -> [f64; 2] {
            let [x, y, z] = [0, 1, 2].map(|k: usize| f64::from(c[k]) + h * f64::from(dx[k]));
            let (sc, tc, ma) = match c {
                [v, _, _] if v.abs() >= 2.0 => (if v > 0.0 { -z } else { z }, -y, x.abs()),
                [_, v, _] if v.abs() >= 3.0 => (x, if v > 0.0 { z } else { -z }, y.abs()),
                [_, _, v] => (if v > 0.0 { x } else { -x }, -y, z.abs()),
            };
            [(sc / ma + 1.0) * 4.0, (tc / ma + 1.0) * 4.0]
        };
        let e = 1e-4;
        for (name, simd_level) in available_levels() {
            let step = dispatch!(simd_level, simd => {
                let load = |v: [f32; 3]| crate::forward::wide::splat_rgba(simd, [v[0], v[1], v[2], 0.0]);
                let d = derivatives(simd, &t, load(c), load(dx), load([0.0; 3]));
                [d[0][0][0], d[0][1][0]]
            });
            for k in 0..2 {
                let expected = (project(e)[k] - project(-e)[k]) / (2.0 * e);
                assert!(
                    (f64::from(step[k]) - expected).abs() < 1e-4,
                    "{name} {c:?} {k}: {step:?} {expected}"
                );
            }
        }
    }
}
