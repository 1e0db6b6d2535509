//! The course's OpenGL, item by item: each test is named by its item, and its expectations are
//! closed forms.

use crate::common::{Stage, assert_color};
use vitral_gl::{Context, OSMESA_RGB_565, enums as gl};

const WHOLE: [f32; 4] = [-1.0, -1.0, 1.0, 1.0];

#[test]
fn t14_alpha_functions_times_less_equal_greater() {
    let table = [
        (gl::NEVER, [false, false, false]),
        (gl::LESS, [true, false, false]),
        (gl::EQUAL, [false, true, false]),
        (gl::LEQUAL, [true, true, false]),
        (gl::GREATER, [false, false, true]),
        (gl::NOTEQUAL, [true, false, true]),
        (gl::GEQUAL, [false, true, true]),
        (gl::ALWAYS, [true, true, true]),
    ];
    let mut c = Stage::new(4, 4);
    c.enable(gl::ALPHA_TEST);
    for (func, passes) in table {
        for (alpha, passes) in [0.25, 0.5, 0.75].into_iter().zip(passes) {
            c.clear(gl::COLOR_BUFFER_BIT);
            c.alpha_func(func, 0.5);
            c.fill([1.0, 0.0, 0.0, alpha], 0.0);
            assert_eq!(c.pixel(1, 1)[0] == 255, passes, "{func:#x} {alpha}");
        }
    }
    // The reference is clamped.
    c.alpha_func(gl::GEQUAL, 7.0);
    assert_eq!(c.get(gl::ALPHA_TEST_REF), [1.0]);
}

#[test]
fn t14_alphas_are_compared_as_stored() {
    let functions = [
        (gl::LESS, false),
        (gl::EQUAL, true),
        (gl::LEQUAL, true),
        (gl::GREATER, false),
        (gl::NOTEQUAL, false),
        (gl::GEQUAL, true),
    ];
    // Both are 128 in 8 bits; of the others the alpha is larger.
    for (format, kind, equal) in [
        (gl::RGBA, gl::UNSIGNED_BYTE, true),
        (gl::RGB, gl::UNSIGNED_BYTE, true),
        (OSMESA_RGB_565, gl::UNSIGNED_SHORT_5_6_5, true),
        (gl::RGBA, gl::UNSIGNED_SHORT, false),
        (gl::RGBA, gl::FLOAT, false),
    ] {
        // All facets of a kind: large ones, tiny ones, a point, an image.
        for figure in 0..4 {
            let mut c = Stage::with_buffer(16, 16, format, kind);
            c.enable(gl::ALPHA_TEST);
            c.color_4f(1.0, 1.0, 1.0, 128.0 / 255.0);
            let image = c.put(&[[1.0f32, 1.0, 1.0, 128.0 / 255.0]]);
            for (func, passes) in functions {
                c.clear(gl::COLOR_BUFFER_BIT);
                c.alpha_func(func, 0.5);
                match figure {
                    0 => c.rectangle(WHOLE, 0.0),
                    1 => c.rectangle([-0.1, -0.1, 0.1, 0.1], 0.0),
                    2 => {
                        c.begin(gl::POINTS);
                        c.vertex_2f(0.01, 0.01);
                        c.end();
                    }
                    _ => {
                        c.raster_pos_2f(0.0, 0.0);
                        c.draw_pixels(1, 1, gl::RGBA, gl::FLOAT, image);
                    }
                }
                let larger = matches!(func, gl::GREATER | gl::NOTEQUAL | gl::GEQUAL);
                let expected = if equal { passes } else { larger };
                assert_eq!(
                    c.pixel(8, 8)[0] == 255,
                    expected,
                    "{format:#x} {kind:#x} {func:#x} {figure}"
                );
            }
        }
    }
}

#[test]
fn t15_alpha_then_stencil_then_depth_then_blend() {
    let mut c = Stage::new(4, 4);
    for cap in [gl::ALPHA_TEST, gl::STENCIL_TEST, gl::DEPTH_TEST, gl::BLEND] {
        c.enable(cap);
    }
    c.alpha_func(gl::GREATER, 0.5);
    c.blend_func(gl::ONE, gl::ONE);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT | gl::STENCIL_BUFFER_BIT);
    // What fails the alpha test writes nothing.
    c.stencil_func(gl::ALWAYS, 9, 0xff);
    c.stencil_op(gl::REPLACE, gl::REPLACE, gl::REPLACE);
    c.fill([0.5, 0.5, 0.5, 0.25], 0.0);
    assert_eq!((c.depths()[0], c.stencils()[0], c.pixel(0, 0)), (1.0, 0, [0; 4]));
    // What fails the stencil test changes the stencil alone.
    c.stencil_func(gl::NEVER, 5, 0xff);
    c.stencil_op(gl::REPLACE, gl::ZERO, gl::INVERT);
    c.fill([0.5, 0.5, 0.5, 1.0], 0.0);
    assert_eq!((c.depths()[0], c.stencils()[0], c.pixel(0, 0)), (1.0, 5, [0; 4]));
    // What fails the depth test takes the second operation, what passes all the third.
    c.stencil_func(gl::ALWAYS, 7, 0xff);
    c.stencil_op(gl::KEEP, gl::REPLACE, gl::INCR);
    c.fill([0.2, 0.2, 0.2, 1.0], 0.0);
    assert_eq!((c.stencils()[0], c.pixel(0, 0)), (6, [51, 51, 51, 255]));
    c.fill([0.2, 0.2, 0.2, 1.0], 0.5);
    assert_eq!((c.stencils()[0], c.pixel(0, 0)), (7, [51, 51, 51, 255]));
    assert!((c.depths()[0] - 0.5).abs() < 1e-6);
}

#[test]
fn t16_blending_by_alpha() {
    let mut c = Stage::new(4, 4);
    c.clear_color(0.2, 0.4, 0.6, 1.0);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.enable(gl::BLEND);
    c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
    c.fill([1.0, 0.0, 0.5, 0.3], 0.0);
    assert_color(c.pixel(1, 1), [0.3 + 0.7 * 0.2, 0.7 * 0.4, 0.15 + 0.7 * 0.6, 0.09 + 0.7]);
}

#[test]
fn t17_a_hidden_fragment_does_not_blend() {
    let mut c = Stage::new(4, 4);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    c.enable(gl::DEPTH_TEST);
    c.fill([0.2, 0.4, 0.6, 1.0], -0.5);
    let before = c.bytes();
    c.enable(gl::BLEND);
    c.blend_func(gl::ONE, gl::ONE);
    c.fill([0.5; 4], 0.5);
    assert_eq!(c.bytes(), before);
}

#[test]
fn f12_alpha_is_opacity() {
    let mut c = Stage::new(4, 4);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.fill([0.0, 1.0, 1.0, 0.75], 0.0);
    assert_color(c.pixel(2, 2), [0.0, 1.0, 1.0, 0.75]);
}

#[test]
fn f13_blend_equations() {
    let (s, d) = ([0.8, 0.4, 0.2, 0.6], [0.2f32, 0.6, 0.4, 0.4]);
    type Equation = fn(f32, f32) -> f32;
    let table: [(u32, Equation); 5] = [
        (gl::FUNC_ADD, |s, d| 0.6 * s + d),
        (gl::FUNC_SUBTRACT, |s, d| 0.6 * s - d),
        (gl::FUNC_REVERSE_SUBTRACT, |s, d| d - 0.6 * s),
        (gl::MIN, f32::min),
        (gl::MAX, f32::max),
    ];
    let mut c = Stage::new(4, 4);
    c.clear_color(d[0], d[1], d[2], d[3]);
    c.enable(gl::BLEND);
    c.blend_func(gl::SRC_ALPHA, gl::ONE);
    for (equation, formula) in table {
        c.clear(gl::COLOR_BUFFER_BIT);
        c.blend_equation(equation);
        c.fill(s, 0.0);
        assert_color(c.pixel(1, 1), std::array::from_fn(|k| formula(s[k], d[k])));
    }
}

/// The 15 factors for source, destination and constant colours.
fn factor(factor: u32, s: [f32; 4], d: [f32; 4], c: [f32; 4]) -> [f32; 4] {
    let one_minus = |v: [f32; 4]| v.map(|v| 1.0 - v);
    let saturated = s[3].min(1.0 - d[3]);
    match factor {
        gl::ZERO => [0.0; 4],
        gl::ONE => [1.0; 4],
        gl::SRC_COLOR => s,
        gl::ONE_MINUS_SRC_COLOR => one_minus(s),
        gl::DST_COLOR => d,
        gl::ONE_MINUS_DST_COLOR => one_minus(d),
        gl::SRC_ALPHA => [s[3]; 4],
        gl::ONE_MINUS_SRC_ALPHA => one_minus([s[3]; 4]),
        gl::DST_ALPHA => [d[3]; 4],
        gl::ONE_MINUS_DST_ALPHA => one_minus([d[3]; 4]),
        gl::CONSTANT_COLOR => c,
        gl::ONE_MINUS_CONSTANT_COLOR => one_minus(c),
        gl::CONSTANT_ALPHA => [c[3]; 4],
        gl::ONE_MINUS_CONSTANT_ALPHA => one_minus([c[3]; 4]),
        _ => [saturated, saturated, saturated, 1.0],
    }
}

#[test]
fn f14_fifteen_source_times_fourteen_destination_factors() {
    const FACTORS: [u32; 15] = [
        gl::ZERO,
        gl::ONE,
        gl::SRC_COLOR,
        gl::ONE_MINUS_SRC_COLOR,
        gl::DST_COLOR,
        gl::ONE_MINUS_DST_COLOR,
        gl::SRC_ALPHA,
        gl::ONE_MINUS_SRC_ALPHA,
        gl::DST_ALPHA,
        gl::ONE_MINUS_DST_ALPHA,
        gl::CONSTANT_COLOR,
        gl::ONE_MINUS_CONSTANT_COLOR,
        gl::CONSTANT_ALPHA,
        gl::ONE_MINUS_CONSTANT_ALPHA,
        gl::SRC_ALPHA_SATURATE,
    ];
    // Destination colours that bytes hold exactly.
    let (s, d, constant) = ([0.9, 0.3, 0.6, 0.7], [0.2, 0.8, 0.4, 0.6], [0.15, 0.55, 0.95, 0.35]);
    let mut c = Stage::new(16, 16);
    c.blend_color(constant[0], constant[1], constant[2], constant[3]);
    c.clear_color(d[0], d[1], d[2], d[3]);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.enable(gl::BLEND);
    c.color_4f(s[0], s[1], s[2], s[3]);
    c.pixels();
    for (i, source) in FACTORS.into_iter().enumerate() {
        for (j, destination) in FACTORS[..14].iter().enumerate() {
            c.blend_func(source, *destination);
            c.recti(i as i32, j as i32, i as i32 + 1, j as i32 + 1);
        }
    }
    c.no_error();
    let found = c.bytes();
    for (i, source) in FACTORS.into_iter().enumerate() {
        for (j, destination) in FACTORS[..14].iter().enumerate() {
            let (f, g) = (factor(source, s, d, constant), factor(*destination, s, d, constant));
            assert_color(found[j * 16 + i], std::array::from_fn(|k| s[k] * f[k] + d[k] * g[k]));
        }
    }
    // Saturation is a source factor alone.
    c.blend_func(gl::ONE, gl::SRC_ALPHA_SATURATE);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
}

#[test]
fn f15_by_default_nothing_is_transparent() {
    let mut c = Stage::new(4, 4);
    assert_eq!(c.get(gl::BLEND_SRC), [gl::ONE as f32]);
    assert_eq!(c.get(gl::BLEND_DST), [gl::ZERO as f32]);
    let mut picture = |blend: bool| {
        if blend {
            c.enable(gl::BLEND);
        }
        c.clear(gl::COLOR_BUFFER_BIT);
        c.fill([0.3, 0.6, 0.9, 0.25], 0.0);
        c.bytes()
    };
    assert_eq!(picture(false), picture(true));
}

#[test]
fn f16_yellow_and_cyan_in_both_orders() {
    let (yellow, cyan) = ([1.0, 1.0, 0.0, 0.75], [0.0, 1.0, 1.0, 0.75]);
    let mut c = Stage::new(4, 4);
    c.enable(gl::BLEND);
    c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
    for (first, second, [r, g, b]) in
        [(cyan, yellow, [0.75, 0.9375, 0.1875]), (yellow, cyan, [0.1875, 0.9375, 0.75])]
    {
        c.clear(gl::COLOR_BUFFER_BIT);
        c.fill(first, 0.0);
        c.fill(second, 0.0);
        assert_color(c.pixel(1, 1), [r, g, b, 0.75 * 0.75 + 0.25 * 0.5625]);
    }
}

#[test]
fn f17_filters_antialiasing_and_cut_out_textures() {
    let mut c = Stage::new(8, 8);
    // A filter: the product.
    c.clear_color(0.8, 0.6, 0.4, 1.0);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.enable(gl::BLEND);
    c.blend_func(gl::DST_COLOR, gl::ZERO);
    c.fill([0.5, 1.0, 0.25, 1.0], 0.0);
    assert_color(c.pixel(3, 3), [0.4, 0.6, 0.1, 1.0]);

    // Coverage of a line of width 3 whose middle is at 4.2: it covers y from 2.7 to 5.7.
    c.clear_color(0.0, 0.0, 0.0, 0.0);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
    c.enable(gl::LINE_SMOOTH);
    c.line_width(3.0);
    c.color_4f(1.0, 1.0, 1.0, 1.0);
    c.pixels();
    c.begin(gl::LINES);
    c.vertex_2f(-4.0, 4.2);
    c.vertex_2f(12.0, 4.2);
    c.end();
    for (y, coverage) in [(1, 0.0), (2, 0.3), (3, 1.0), (4, 1.0), (5, 0.7), (6, 0.0)] {
        let found = f32::from(c.pixel(4, y)[0]) / 255.0;
        assert!((found - coverage).abs() < 1.0 / 16.0, "{y}: {found} instead of {coverage}");
    }

    // A cut-out texture: where its alpha is 0 the alpha test fails.
    c.line_width(1.0);
    c.disable(gl::LINE_SMOOTH);
    c.load_identity();
    c.disable(gl::BLEND);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.texture(&[(2, vec![[255, 0, 0, 255], [0, 255, 0, 0], [0, 0, 255, 0], [255, 255, 0, 255]])]);
    c.enable(gl::ALPHA_TEST);
    c.alpha_func(gl::GREATER, 0.5);
    c.fill([1.0; 4], 0.0);
    let found = [[1, 1], [6, 1], [1, 6], [6, 6]].map(|[x, y]| c.pixel(x, y));
    assert_eq!(found, [[255, 0, 0, 255], [0; 4], [0; 4], [255, 255, 0, 255]]);
}

/// For each pixel of a picture, how many of 4x4 places in it are inside, from 0 to 1.
fn supersampled(side: usize, inside: impl Fn(f32, f32) -> bool) -> Vec<f32> {
    let place = |pixel: usize, i: usize| pixel as f32 + (i as f32 + 0.5) / 4.0;
    let count = |at: usize| {
        (0..16).filter(|i| inside(place(at % side, i % 4), place(at / side, i / 4))).count()
    };
    (0..side * side).map(|at| count(at) as f32 / 16.0).collect()
}

#[test]
fn f17_antialiasing_by_coverage_is_4x4_supersampling_at_every_slant() {
    const SIDE: usize = 32;
    // In one pixel a corner or the way in which 4x4 places lie may do much; on the mean little is
    // left.
    const MOST: f32 = 0.23;
    const MEAN: f32 = 0.036;
    let mut c = Stage::new(SIDE as i32, SIDE as i32);
    c.enable(gl::BLEND);
    c.color_4f(1.0, 1.0, 1.0, 1.0);
    c.pixels();
    let (mut total, mut border, mut worst) = (0.0, 0, 0.0f32);
    let mut compare = |c: &mut Stage, expected: &[f32], what: &str| {
        for (at, expected) in expected.iter().enumerate() {
            let found =
                f32::from(c.pixel(at as i32 % SIDE as i32, at as i32 / SIDE as i32)[0]) / 255.0;
            let error = (found - expected).abs();
            assert!(error <= MOST, "{what}, pixel {at}: {found} instead of {expected}");
            if *expected > 0.0 && *expected < 1.0 {
                (total, border, worst) = (total + error, border + 1, worst.max(error));
            }
        }
    };
    for step in 0..12 {
        let angle = 0.13 + 0.5 * step as f32;
        let (sin, cos) = vitral_math::func::sin_cos(f64::from(angle));
        let (sin, cos) = (sin as f32, cos as f32);
        let middle = [16.0 + 0.1 * step as f32, 15.7];
        // Along and across, from the middle.
        let turned = |x: f32, y: f32| {
            let (x, y) = (x - middle[0], y - middle[1]);
            [cos * x + sin * y, cos * y - sin * x]
        };

        // A line of width 3: a rectangle, all within 1.5 of it.
        c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
        c.enable(gl::LINE_SMOOTH);
        c.line_width(3.0);
        c.clear(gl::COLOR_BUFFER_BIT);
        c.begin(gl::LINES);
        c.vertex_2f(middle[0] - 11.0 * cos, middle[1] - 11.0 * sin);
        c.vertex_2f(middle[0] + 11.0 * cos, middle[1] + 11.0 * sin);
        c.end();
        let inside = |x: f32, y: f32| turned(x, y)[0].abs() <= 11.0 && turned(x, y)[1].abs() <= 1.5;
        compare(&mut c, &supersampled(SIDE, inside), &format!("line at {angle}"));

        // A square with smooth borders, whose triangles share a diagonal: coverages add up.
        c.blend_func(gl::SRC_ALPHA_SATURATE, gl::ONE);
        c.enable(gl::POLYGON_SMOOTH);
        c.clear(gl::COLOR_BUFFER_BIT);
        c.begin(gl::QUADS);
        for (along, across) in [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)] {
            c.vertex_2f(
                middle[0] + cos * along - sin * across,
                middle[1] + sin * along + cos * across,
            );
        }
        c.end();
        c.disable(gl::POLYGON_SMOOTH);
        let inside = |x: f32, y: f32| turned(x, y).iter().all(|v| v.abs() <= 9.0);
        compare(&mut c, &supersampled(SIDE, inside), &format!("square at {angle}"));
    }
    assert!(
        border > 1000 && total / border as f32 <= MEAN,
        "{} on the mean, {worst} at the worst",
        total / border as f32
    );
}

/// A lit stage: no global ambient light, a material of diffuse white alone.
fn lit() -> Stage {
    let mut c = Stage::new(8, 8);
    let black = c.put(&[0.0f32, 0.0, 0.0, 1.0]);
    let white = c.put(&[1.0f32; 4]);
    c.light_modelfv(gl::LIGHT_MODEL_AMBIENT, black);
    c.materialfv(gl::FRONT, gl::AMBIENT, black);
    c.materialfv(gl::FRONT, gl::DIFFUSE, white);
    c.enable(gl::LIGHTING);
    c.normal_3f(0.0, 0.0, 1.0);
    c
}

fn light(c: &mut Stage, number: u32, name: u32, values: [f32; 4]) {
    let at = c.put(&values);
    c.lightfv(gl::LIGHT0 + number, name, at);
}

fn shown(c: &mut Stage) -> [u8; 4] {
    c.clear(gl::COLOR_BUFFER_BIT);
    c.rectangle(WHOLE, 0.0);
    c.pixel(3, 3)
}

#[test]
fn l11_eight_lights_are_independent() {
    let mut c = lit();
    let white = c.put(&[1.0f32; 4]);
    c.materialfv(gl::FRONT, gl::AMBIENT, white);
    for i in 0..8 {
        light(&mut c, i, gl::AMBIENT, [0.01 * (i + 1) as f32, 0.0, 0.0, 1.0]);
        light(&mut c, i, gl::DIFFUSE, [0.0, 0.0, 0.0, 1.0]);
        c.enable(gl::LIGHT0 + i);
    }
    assert_color(shown(&mut c), [0.36, 0.0, 0.0, 1.0]);
    c.disable(gl::LIGHT4);
    assert_color(shown(&mut c), [0.31, 0.0, 0.0, 1.0]);
    // Whole numbers are colours: the largest is 1.
    let at = c.put(&[i32::MAX, 0, i32::MIN, i32::MAX]);
    c.lightiv(gl::LIGHT3, gl::DIFFUSE, at);
    let into = c.put(&[9.0f32; 4]);
    c.get_lightfv(gl::LIGHT3, gl::DIFFUSE, into);
    let found: Vec<f32> = c.take(into, 4);
    assert!(
        (found[0] - 1.0).abs() < 1e-6 && found[1].abs() < 1e-6 && (found[2] + 1.0).abs() < 1e-6
    );
}

#[test]
fn l12_a_position_is_transformed_at_the_call() {
    let mut c = lit();
    c.enable(gl::LIGHT0);
    // The light goes with the view that was current when it was set, and stays when the view
    // changes.
    c.rotatef(60.0, 0.0, 1.0, 0.0);
    light(&mut c, 0, gl::POSITION, [0.0, 0.0, 1.0, 0.0]);
    c.load_identity();
    assert_color(shown(&mut c), [0.5, 0.5, 0.5, 1.0]);
    // Set under the identity: fixed to the camera.
    light(&mut c, 0, gl::POSITION, [0.0, 0.0, 1.0, 0.0]);
    assert_color(shown(&mut c), [1.0, 1.0, 1.0, 1.0]);
    let into = c.put(&[0.0f32; 4]);
    c.translatef(1.0, 2.0, 3.0);
    light(&mut c, 0, gl::POSITION, [4.0, 5.0, 6.0, 1.0]);
    c.load_identity();
    c.get_lightfv(gl::LIGHT0, gl::POSITION, into);
    assert_eq!(c.take::<f32>(into, 4), [5.0, 7.0, 9.0, 1.0]);
    // E8: whole numbers of a position are not scaled.
    let at = c.put(&[2i32, 3, 4, 1]);
    c.lightiv(gl::LIGHT0, gl::POSITION, at);
    c.get_lightfv(gl::LIGHT0, gl::POSITION, into);
    assert_eq!(c.take::<f32>(into, 4), [2.0, 3.0, 4.0, 1.0]);
}

#[test]
fn l13_each_light_adds_its_own_part() {
    let mut c = lit();
    for (i, color) in [[0.25, 0.0, 0.0, 1.0], [0.0, 0.5, 0.0, 1.0], [0.125, 0.0, 0.75, 1.0]]
        .into_iter()
        .enumerate()
    {
        light(&mut c, i as u32, gl::DIFFUSE, color);
    }
    let mut with = |on: [bool; 3]| {
        for (i, on) in on.into_iter().enumerate() {
            let switch: fn(&mut Context, u32) = if on { Context::enable } else { Context::disable };
            switch(&mut c, gl::LIGHT0 + i as u32);
        }
        shown(&mut c)
    };
    assert_color(with([true, false, false]), [0.25, 0.0, 0.0, 1.0]);
    assert_color(with([true, true, false]), [0.25, 0.5, 0.0, 1.0]);
    assert_color(with([true, true, true]), [0.375, 0.5, 0.75, 1.0]);
    assert_color(with([false, false, true]), [0.125, 0.0, 0.75, 1.0]);
}

#[test]
fn l14_e10_the_shade_model_decides_not_the_normals() {
    let mut c = Stage::new(16, 16);
    let mut colors = |model: u32| {
        c.shade_model(model);
        c.clear(gl::COLOR_BUFFER_BIT);
        c.begin(gl::TRIANGLES);
        for (x, y, color) in [
            (-1.0, -1.0, [1.0, 0.0, 0.0]),
            (3.0, -1.0, [0.0, 1.0, 0.0]),
            (-1.0, 3.0, [0.0, 0.0, 1.0]),
        ] {
            c.color_3f(color[0], color[1], color[2]);
            c.vertex_2f(x, y);
        }
        c.end();
        let mut all = c.bytes();
        all.sort_unstable();
        all.dedup();
        all
    };
    assert_eq!(colors(gl::FLAT), [[0, 0, 255, 255]]);
    assert!(colors(gl::SMOOTH).len() > 100);
}

#[test]
fn l14_e10_one_normal_is_smooth_and_four_normals_are_flat_if_the_model_says_so() {
    // A square under a lamp nearby, over one of its corners, with one normal for all corners or
    // with one for each.
    let colors = |model: u32, normals: &[[f32; 3]]| {
        let mut c = lit();
        c.enable(gl::LIGHT0);
        light(&mut c, 0, gl::POSITION, [-0.8, -0.8, 0.6, 1.0]);
        c.shade_model(model);
        c.clear(gl::COLOR_BUFFER_BIT);
        c.begin(gl::QUADS);
        for (i, (x, y)) in
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].into_iter().enumerate()
        {
            if let Some([nx, ny, nz]) = normals.get(i).copied() {
                c.normal_3f(nx, ny, nz);
            }
            c.vertex_2f(x, y);
        }
        c.end();
        let shown = [[0, 0], [7, 0], [7, 7], [0, 7]].map(|[x, y]| c.pixel(x, y)[0]);
        let mut all = c.bytes();
        all.sort_unstable();
        all.dedup();
        (all.len(), shown)
    };
    let (up, aslant) = ([0.0f32, 0.0, 1.0], [0.6f32, 0.0, 0.8]);
    // One normal: a local light still falls differently on the corners, and that is interpolated.
    let (count, [near, beside, far, other]) = colors(gl::SMOOTH, &[up]);
    assert!(count > 8 && near > beside + 50 && beside > far, "{count}: {near} {beside} {far}");
    assert!(other.abs_diff(beside) <= 1, "the same on both sides: {beside} {other}");
    // None given: the current normal counts, (0, 0, 1) here, for all.
    assert_eq!(colors(gl::SMOOTH, &[]), colors(gl::SMOOTH, &[up]));
    // Four normals: with flat shading the last vertex gives one colour. N·L there: L = (-0.8, -0.8,
    // 0.6) - (-1, 1, 0).
    let (count, [flat, ..]) = colors(gl::FLAT, &[aslant, aslant, aslant, up]);
    let cosine = 0.6 / (0.2f32 * 0.2 + 1.8 * 1.8 + 0.6 * 0.6).sqrt();
    assert_eq!(count, 1);
    assert!((f32::from(flat) - cosine * 255.0).abs() <= 1.0, "{flat}, not {}", cosine * 255.0);
    assert_eq!(colors(gl::FLAT, &[up]).0, 1);
}

#[test]
fn l16_the_view_and_model_matrices_are_hand_products() {
    let mut c = Stage::new(4, 4);
    // T(1, 2, 3) Rz(90): x goes to y, y to -x.
    c.translated(1.0, 2.0, 3.0);
    c.rotated(90.0, 0.0, 0.0, 1.0);
    let expected =
        [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 2.0, 3.0, 1.0];
    let near = |found: [f32; 16], expected: [f32; 16]| {
        (0..16).all(|i| (found[i] - expected[i]).abs() < 1e-6)
    };
    assert!(near(c.get(gl::MODELVIEW_MATRIX), expected));
    c.push_matrix();
    c.scaled(2.0, 2.0, 2.0);
    c.pop_matrix();
    assert!(near(c.get(gl::MODELVIEW_MATRIX), expected));
}

#[test]
fn l21_a_green_light_at_infinity_on_ox() {
    let mut c = lit();
    light(&mut c, 2, gl::POSITION, [1.0, 0.0, 0.0, 0.0]);
    for name in [gl::AMBIENT, gl::DIFFUSE, gl::SPECULAR] {
        light(&mut c, 2, name, [0.0, 1.0, 0.0, 1.0]);
    }
    c.enable(gl::LIGHT2);
    c.normal_3f(0.8, 0.0, 0.6);
    assert_color(shown(&mut c), [0.0, 0.8, 0.0, 1.0]);
    // Where the object is makes no difference.
    c.translatef(0.3, 0.2, 0.1);
    assert_color(shown(&mut c), [0.0, 0.8, 0.0, 1.0]);
    c.normal_3f(-0.8, 0.0, 0.6);
    assert_color(shown(&mut c), [0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn l22_without_normals_an_object_has_one_colour() {
    let mut c = lit();
    c.enable(gl::LIGHT0);
    assert_eq!(Stage::new(1, 1).get(gl::CURRENT_NORMAL), [0.0, 0.0, 1.0]);
    let mut colors = |angle: f32| {
        c.load_identity();
        c.rotatef(angle, 0.0, 1.0, 0.0);
        c.clear(gl::COLOR_BUFFER_BIT);
        c.begin(gl::TRIANGLE_FAN);
        for [x, y, z] in
            [[0.0, 0.0, 0.5], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
        {
            c.vertex_3f(x, y, z);
        }
        c.end();
        let mut all: Vec<_> = c.bytes().into_iter().filter(|p| p[3] == 255).collect();
        all.dedup();
        assert_eq!(all.len(), 1, "{all:?}");
        all[0]
    };
    assert_color(colors(0.0), [1.0, 1.0, 1.0, 1.0]);
    assert_color(colors(60.0), [0.5, 0.5, 0.5, 1.0]);
}

#[test]
fn e6_e9_defaults() {
    let mut c = Stage::new(4, 4);
    assert_eq!(c.get(gl::BLEND_COLOR), [0.0; 4]);
    assert_eq!(c.get(gl::LIGHT_MODEL_AMBIENT), [0.2, 0.2, 0.2, 1.0]);
    assert_eq!(c.get(gl::SHADE_MODEL), [gl::SMOOTH as f32]);
    assert_eq!(c.get(gl::ALPHA_TEST_FUNC), [gl::ALWAYS as f32]);
    assert_eq!(c.get(gl::DEPTH_FUNC), [gl::LESS as f32]);
    let into = c.put(&[9.0f32; 4]);
    for i in 0..8 {
        let bright = if i == 0 { [1.0, 1.0, 1.0, 1.0] } else { [0.0, 0.0, 0.0, 1.0] };
        let table = [
            (gl::AMBIENT, vec![0.0, 0.0, 0.0, 1.0]),
            (gl::DIFFUSE, bright.to_vec()),
            (gl::SPECULAR, bright.to_vec()),
            (gl::POSITION, vec![0.0, 0.0, 1.0, 0.0]),
            (gl::SPOT_DIRECTION, vec![0.0, 0.0, -1.0]),
            (gl::SPOT_EXPONENT, vec![0.0]),
            (gl::SPOT_CUTOFF, vec![180.0]),
            (gl::CONSTANT_ATTENUATION, vec![1.0]),
            (gl::LINEAR_ATTENUATION, vec![0.0]),
            (gl::QUADRATIC_ATTENUATION, vec![0.0]),
        ];
        for (name, expected) in table {
            c.get_lightfv(gl::LIGHT0 + i, name, into);
            assert_eq!(c.take::<f32>(into, expected.len()), expected, "light {i} {name:#x}");
        }
    }
}
