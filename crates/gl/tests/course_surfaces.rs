//! The course's OpenGL, item by item, second part: lights as the exercises have them, errata, and
//! what the notes on visible surfaces and illumination ask of the fixed functions. Each test is
//! named by its item; expectations are closed forms.

#![expect(
    clippy::disallowed_methods,
    reason = "expected values may differ by the machine's last bit"
)]

use crate::common::{Stage, assert_color};
use vitral_gl::enums as gl;

const WHOLE: [f32; 4] = [-1.0, -1.0, 1.0, 1.0];

/// `light_ambient`, `light_diffuse`, `light_specular` and `light_position` of the exercises'
/// scenes, whose numbers are lost in the notes: those that vitral's own scenes have
/// (`vitral_scene::lab`). A lamp, and a light at infinity.
const AMBIENT: [[f32; 4]; 2] = [[0.2, 0.2, 0.2, 1.0], [0.02, 0.03, 0.05, 1.0]];
const DIFFUSE: [[f32; 4]; 2] = [[0.8, 0.76, 0.68, 1.0], [0.2, 0.25, 0.35, 1.0]];
const SPECULAR: [[f32; 4]; 2] = [[0.9, 0.88, 0.84, 1.0], [0.2, 0.25, 0.35, 1.0]];
const POSITION: [[f32; 4]; 2] = [[-4.0, 7.0, 6.0, 1.0], [1.0, 0.2, 0.3, 0.0]];

/// A material, in this order: ambient, diffuse, specular, all grey; and no light but the lights.
fn material(c: &mut Stage, grey: [f32; 3], shininess: f32) {
    for (name, v) in [gl::AMBIENT, gl::DIFFUSE, gl::SPECULAR].into_iter().zip(grey) {
        let at = c.put(&[v, v, v, 1.0]);
        c.materialfv(gl::FRONT_AND_BACK, name, at);
    }
    c.materialf(gl::FRONT_AND_BACK, gl::SHININESS, shininess);
    let black = c.put(&[0.0f32, 0.0, 0.0, 1.0]);
    c.light_modelfv(gl::LIGHT_MODEL_AMBIENT, black);
    c.enable(gl::LIGHTING);
}

fn light(c: &mut Stage, number: usize, name: u32, values: [f32; 4]) {
    let at = c.put(&values);
    c.lightfv(gl::LIGHT0 + number as u32, name, at);
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|k| k / length)
}

#[test]
fn l15_light0_and_light1_shine_as_their_arrays_say() {
    let mut c = Stage::new(4, 4);
    let (grey, exponent) = ([0.5, 0.7, 0.4], 8.0);
    material(&mut c, grey, exponent);
    let tables = [
        (gl::AMBIENT, AMBIENT),
        (gl::DIFFUSE, DIFFUSE),
        (gl::SPECULAR, SPECULAR),
        (gl::POSITION, POSITION),
    ];
    let into = c.put(&[9.0f32; 4]);
    for (name, table) in tables {
        for (number, values) in table.into_iter().enumerate() {
            light(&mut c, number, name, values);
            c.get_lightfv(gl::LIGHT0 + number as u32, name, into);
            assert_eq!(c.take::<f32>(into, 4), values, "light {number} {name:#x}");
        }
    }
    // At the origin, for a viewer at infinity: the formula, by hand.
    for normal in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [-0.48, 0.6, 0.64], [0.0, -0.8, 0.6]] {
        let part = |number: usize, channel: usize| {
            let [x, y, z, _] = POSITION[number].map(f64::from);
            let l = unit([x, y, z]);
            let h = unit([l[0], l[1], l[2] + 1.0]);
            let facing = dot(normal, l).max(0.0);
            let shine =
                if facing > 0.0 { dot(normal, h).max(0.0).powf(f64::from(exponent)) } else { 0.0 };
            let colors =
                [AMBIENT, DIFFUSE, SPECULAR].map(|table| f64::from(table[number][channel]));
            let [ka, kd, ks] = grey.map(f64::from);
            ka * colors[0] + kd * facing * colors[1] + ks * shine * colors[2]
        };
        for (first, second) in [(true, false), (false, true), (true, true)] {
            for (number, on) in [first, second].into_iter().enumerate() {
                let name = gl::LIGHT0 + number as u32;
                if on { c.enable(name) } else { c.disable(name) }
            }
            c.normal_3f(normal[0] as f32, normal[1] as f32, normal[2] as f32);
            c.clear(gl::COLOR_BUFFER_BIT);
            c.point_size(9.0);
            c.begin(gl::POINTS);
            c.vertex_3f(0.0, 0.0, 0.0);
            c.end();
            let sum = |k| {
                (if first { part(0, k) } else { 0.0 } + if second { part(1, k) } else { 0.0 })
                    as f32
            };
            assert_color(c.pixel(2, 2), [sum(0), sum(1), sum(2), 1.0]);
        }
    }
}

#[test]
fn l16_the_eye_is_the_inverse_of_placing_it() {
    // Rx(-a) Ry(-b) Rz(-c) T(-t), then the object's T Rz Ry Rx with the same angles and place: the
    // object is before the eye.
    let mut c = Stage::new(4, 4);
    let ([a, b, g], [x, y, z]) = ([20.0, -35.0, 50.0], [1.0, -2.0, 3.0]);
    c.rotated(-a, 1.0, 0.0, 0.0);
    c.rotated(-b, 0.0, 1.0, 0.0);
    c.rotated(-g, 0.0, 0.0, 1.0);
    c.translated(-x, -y, -z);
    let view: [f32; 16] = c.get(gl::MODELVIEW_MATRIX);
    light(&mut c, 0, gl::POSITION, [x as f32, y as f32, z as f32, 1.0]);
    c.push_matrix();
    c.translated(x, y, z);
    c.rotated(g, 0.0, 0.0, 1.0);
    c.rotated(b, 0.0, 1.0, 0.0);
    c.rotated(a, 1.0, 0.0, 0.0);
    let whole: [f32; 16] = c.get(gl::MODELVIEW_MATRIX);
    for (i, found) in whole.into_iter().enumerate() {
        let expected = f32::from(u8::from(i % 5 == 0));
        assert!((found - expected).abs() < 2e-6, "{whole:?}");
    }
    c.pop_matrix();
    assert_eq!(c.get::<16>(gl::MODELVIEW_MATRIX), view);
    // The light stays at the eye while the object moves.
    let into = c.put(&[9.0f32; 4]);
    c.get_lightfv(gl::LIGHT0, gl::POSITION, into);
    assert!(c.take::<f32>(into, 3).iter().all(|v| v.abs() < 2e-6));
}

#[test]
fn t13_opacity_is_one_minus_kt() {
    // Linear transparency (1 - kt) I1 + kt I2 for kt = 0.3, with an alpha of 0.7.
    let mut c = Stage::new(4, 4);
    c.clear_color(0.9, 0.1, 0.5, 1.0);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.enable(gl::BLEND);
    c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
    c.fill([0.2, 0.6, 1.0, 0.7], 0.0);
    let kt = 0.3;
    let mixed = |near: f32, far: f32| (1.0 - kt) * near + kt * far;
    assert_color(
        c.pixel(1, 1),
        [mixed(0.2, 0.9), mixed(0.6, 0.1), mixed(1.0, 0.5), 0.7 * 0.7 + 0.3],
    );
}

#[test]
fn e5_the_blue_triangle_is_cyan() {
    let mut c = Stage::new(4, 4);
    c.enable(gl::BLEND);
    c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
    c.color_4f(0.0, 1.0, 1.0, 0.75);
    c.begin(gl::TRIANGLES);
    for [x, y] in [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]] {
        c.vertex_2f(x, y);
    }
    c.end();
    let found = c.pixel(1, 1);
    assert_color(found, [0.0, 0.75, 0.75, 0.5625]);
    assert_eq!(found[1], found[2], "as much green as blue");
}

#[test]
fn e7_a_fragment_that_fails_the_alpha_test_is_discarded() {
    // As `discard`: neither colour nor depth nor stencil nor an occlusion query hear of it,
    // whatever the tests behind say.
    let mut c = Stage::new(4, 4);
    for cap in [gl::ALPHA_TEST, gl::STENCIL_TEST, gl::DEPTH_TEST] {
        c.enable(cap);
    }
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT | gl::STENCIL_BUFFER_BIT);
    c.stencil_func(gl::ALWAYS, 3, 0xff);
    c.stencil_op(gl::REPLACE, gl::REPLACE, gl::REPLACE);
    let names = c.put(&[0u32]);
    c.gen_queries(1, names);
    let query = c.take::<u32>(names, 1)[0];
    let result = c.put(&[99u32]);
    for (alpha, passed) in [(0.5, 0), (0.51, 16)] {
        c.alpha_func(gl::GREATER, 0.5);
        c.begin_query(gl::SAMPLES_PASSED, query);
        c.fill([1.0, 0.0, 0.0, alpha], -0.5);
        c.end_query(gl::SAMPLES_PASSED);
        c.get_query_objectuiv(query, gl::QUERY_RESULT, result);
        assert_eq!(c.take::<u32>(result, 1), [passed], "alpha {alpha}");
        let written = passed > 0;
        assert_eq!(c.pixel(1, 1)[0], if written { 255 } else { 0 });
        assert_eq!(c.stencils()[0], if written { 3 } else { 0 });
        assert!((c.depths()[0] - if written { 0.25 } else { 1.0 }).abs() < 1e-6);
    }
}

#[test]
fn e10_one_normal_and_a_near_light_still_interpolate() {
    // A light above the left end of a strip with a single normal: the left is lit straight on (1),
    // the right at 60 degrees (1/2).
    let mut c = Stage::new(64, 1);
    material(&mut c, [0.0, 1.0, 0.0], 0.0);
    light(&mut c, 0, gl::POSITION, [-1.0, 0.0, 2.0 / f32::sqrt(3.0), 1.0]);
    c.enable(gl::LIGHT0);
    c.normal_3f(0.0, 0.0, 1.0);
    let mut along = |model: u32| {
        c.shade_model(model);
        c.clear(gl::COLOR_BUFFER_BIT);
        c.rectangle([-1.0, -0.01, 1.0, 0.01], 0.0);
        [0, 31, 63].map(|x| f64::from(c.pixel(x, 0)[0]) / 255.0)
    };
    let flat = along(gl::FLAT);
    assert!(
        flat == [flat[0]; 3] && (flat[0] - 1.0).abs().min((flat[0] - 0.5).abs()) < 0.005,
        "{flat:?}"
    );
    for (found, x) in along(gl::SMOOTH).into_iter().zip([0.0, 31.0, 63.0]) {
        let expected = 1.0 - 0.5 * (x + 0.5) / 64.0;
        assert!((found - expected).abs() < 0.005, "{found} instead of {expected} at {x}");
    }
}

#[test]
fn p17_the_depth_buffer_finds_what_rays_find() {
    // Six planes z = a x + b y + d through one another, in any order: at each pixel the nearest of
    // them stays, as a ray through the pixel's centre says.
    const SIDE: i32 = 33;
    let planes: [[f64; 3]; 6] = [
        [0.5, 0.1, 0.0],
        [-0.4, 0.3, 0.1],
        [0.0, -0.6, -0.05],
        [0.2, 0.25, -0.1],
        [-0.1, -0.2, 0.2],
        [0.0, 0.0, 0.05],
    ];
    let at = |[a, b, d]: [f64; 3], x: f64, y: f64| a * x + b * y + d;
    let mut c = Stage::new(SIDE, SIDE);
    c.enable(gl::DEPTH_TEST);
    let mut pictures = [[0, 1, 2, 3, 4, 5], [5, 4, 3, 2, 1, 0], [3, 0, 5, 1, 4, 2]].map(|order| {
        c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
        for id in order {
            c.color_4ub(10 * (id as u8 + 1), 0, 0, 255);
            c.begin(gl::QUADS);
            for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
                c.vertex_3d(x, y, at(planes[id], x, y));
            }
            c.end();
        }
        (c.bytes(), c.depths())
    });
    for y in 0..SIDE {
        for x in 0..SIDE {
            let [u, v] = [x, y].map(|i| (f64::from(i) + 0.5) / f64::from(SIDE) * 2.0 - 1.0);
            let mut hits: Vec<(f64, u8)> =
                (0..6).map(|id| (at(planes[id], u, v), id as u8)).collect();
            hits.sort_by(|a, b| a.0.total_cmp(&b.0));
            // Where two planes meet in less than two steps of a 24-bit buffer either may win.
            if hits[1].0 - hits[0].0 > 4.0 / f64::from(1 << 24) {
                let place = (y * SIDE + x) as usize;
                for (colors, depths) in &mut pictures {
                    assert_eq!(colors[place][0], 10 * (hits[0].1 + 1), "pixel {x}, {y}");
                    assert!(
                        (f64::from(depths[place]) - (hits[0].0 + 1.0) / 2.0).abs()
                            < 2.0 / f64::from(1 << 24)
                    );
                }
            }
        }
    }
}

#[test]
fn p17_depths_closer_than_a_step_fight() {
    // 24 bits: what is a quarter of a step behind falls on the same number, so the first (LESS)
    // stays; four steps do not.
    let step = 2.0 / f64::from((1 << 24) - 1);
    let mut c = Stage::new(4, 4);
    c.enable(gl::DEPTH_TEST);
    let mut second_wins = |nearer: f64| {
        c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
        for (red, z) in [(0.0, 0.0), (1.0, -nearer)] {
            c.color_3f(red, 0.0, 0.0);
            c.begin(gl::QUADS);
            for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
                c.vertex_3d(x, y, z);
            }
            c.end();
        }
        c.pixel(1, 1)[0] == 255
    };
    assert_eq!([0.0, 0.01, 4.0].map(|steps| second_wins(steps * step)), [false, false, true]);
}

#[test]
fn p41_fog_is_depth_cueing() {
    // Atmospheric depth cueing: between two depths the colour goes to that of the distance,
    // linearly.
    let mut c = Stage::new(4, 4);
    c.enable(gl::FOG);
    c.fogi(gl::FOG_MODE, gl::LINEAR as i32);
    c.fogf(gl::FOG_START, 0.25);
    c.fogf(gl::FOG_END, 0.75);
    let far = c.put(&[0.1f32, 0.2, 0.8, 1.0]);
    c.fogfv(gl::FOG_COLOR, far);
    for (distance, kept) in [
        (0.0f32, 1.0f32),
        (0.25, 1.0),
        (0.375, 0.75),
        (0.5, 0.5),
        (0.7, 0.1),
        (0.75, 0.0),
        (0.9, 0.0),
    ] {
        c.clear(gl::COLOR_BUFFER_BIT);
        c.fill([1.0, 0.6, 0.0, 1.0], -distance);
        let mixed = |near: f32, far: f32| kept * near + (1.0 - kept) * far;
        assert_color(c.pixel(2, 2), [mixed(1.0, 0.1), mixed(0.6, 0.2), mixed(0.0, 0.8), 1.0]);
    }
}

#[test]
fn p41_the_highlight_is_blinns_and_lights_add_up() {
    // Light and viewer at infinity, straight ahead: the halfway vector is z, so a normal at angle t
    // shines with cos^n t, and Phong's reflected ray, at 2t, with cos^m 2t, which has the same
    // width for n = 4 m.
    let mut c = Stage::new(4, 4);
    let shine = |c: &mut Stage, degrees: f64| {
        let t = degrees.to_radians();
        c.normal_3f(t.sin() as f32, 0.0, t.cos() as f32);
        c.clear(gl::COLOR_BUFFER_BIT);
        c.rectangle(WHOLE, 0.0);
        f64::from(c.pixel(1, 1)[0]) / 255.0
    };
    light(&mut c, 0, gl::SPECULAR, [1.0, 1.0, 1.0, 1.0]);
    c.enable(gl::LIGHT0);
    for exponent in [10.0, 25.0] {
        material(&mut c, [0.0, 0.0, 1.0], 4.0 * exponent);
        for degrees in [0.0, 3.0, 6.0, 10.0, 20.0, 44.0] {
            let t = f64::to_radians(degrees);
            let found = shine(&mut c, degrees);
            assert!(
                (found - t.cos().powf(4.0 * f64::from(exponent))).abs() < 0.005,
                "{degrees} degrees: {found}"
            );
            let phong = (2.0 * t).cos().powf(f64::from(exponent));
            assert!((found - phong).abs() < 0.03, "{degrees} degrees: {found}, Phong {phong}");
        }
    }
    // A second light of the same kind adds its own highlight.
    material(&mut c, [0.0, 0.0, 1.0], 40.0);
    light(&mut c, 0, gl::SPECULAR, [0.25, 0.0, 0.0, 1.0]);
    light(&mut c, 1, gl::SPECULAR, [0.5, 0.0, 0.0, 1.0]);
    light(&mut c, 1, gl::POSITION, [0.0, 0.0, 1.0, 0.0]);
    c.enable(gl::LIGHT1);
    let expected = 0.75 * f64::to_radians(5.0).cos().powf(40.0);
    assert!((shine(&mut c, 5.0) - expected).abs() < 0.005);
}
