//! What happens to fragments after they are coloured, with each state alone and on primitives of
//! all sizes: a rectangle over all of the window, tiny squares, points, each against the
//! specification's formula for bytes.

use crate::common::Stage;
use vitral_gl::enums as gl;

const SIDE: i32 = 24;
/// Colours of whole bytes: what is drawn, what is there.
const SOURCE: [u8; 4] = [200, 90, 15, 160];
const STORED: [u8; 4] = [40, 250, 100, 77];
const CONSTANT: [u8; 4] = [51, 255, 0, 153];

fn unit(bytes: [u8; 4]) -> [f32; 4] {
    bytes.map(|byte| f32::from(byte) / 255.0)
}

/// How the window is covered.
#[derive(Clone, Copy, Debug)]
enum With {
    Rectangle,
    Squares,
    Points,
}

const ALL: [With; 3] = [With::Rectangle, With::Squares, With::Points];

/// A window full of `STORED`, in pixels.
fn stage() -> Stage {
    let mut c = Stage::new(SIDE, SIDE);
    c.pixels();
    let [r, g, b, a] = unit(STORED);
    c.clear_color(r, g, b, a);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    c
}

fn cover(c: &mut Stage, with: With) {
    let [r, g, b, a] = unit(SOURCE);
    c.color_4f(r, g, b, a);
    let side = match with {
        With::Rectangle => SIDE,
        With::Squares => 3,
        With::Points => 1,
    };
    c.begin(if side == 1 { gl::POINTS } else { gl::QUADS });
    for (x, y) in (0..SIDE)
        .step_by(side as usize)
        .flat_map(|y| (0..SIDE).step_by(side as usize).map(move |x| (x, y)))
    {
        let (x, y, side) = (x as f32, y as f32, side as f32);
        if side == 1.0 {
            c.vertex_3f(x + 0.5, y + 0.5, 0.0);
        } else {
            for [dx, dy] in [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]] {
                c.vertex_3f(x + dx, y + dy, 0.0);
            }
        }
    }
    c.end();
}

/// All pixels are this.
fn assert_all(c: &mut Stage, expected: [u8; 4], what: &str) {
    let found = c.bytes();
    assert_eq!(c.get_error(), gl::NO_ERROR, "{what}");
    assert!(
        found.iter().all(|pixel| *pixel == expected),
        "{what}: {:?} instead of {expected:?}",
        found[0]
    );
}

#[test]
fn a_mask_of_all_colours_holds_with_an_alpha_test() {
    for with in ALL {
        let mut c = stage();
        c.enable(gl::ALPHA_TEST);
        c.alpha_func(gl::GREATER, 0.5);
        c.enable(gl::DEPTH_TEST);
        c.color_mask(0, 0, 0, 0);
        cover(&mut c, with);
        assert_all(&mut c, STORED, &format!("{with:?}"));
        assert!(
            c.depths().iter().all(|depth| (depth - 0.5).abs() < 1e-6),
            "{with:?}: depths are written"
        );
    }
}

#[test]
fn masks_keep_their_components() {
    for with in ALL {
        for mask in 0..16u8 {
            for blends in [false, true] {
                let mut c = stage();
                let [r, g, b, a] = [0, 1, 2, 3].map(|k| mask >> k & 1);
                c.color_mask(r, g, b, a);
                if blends {
                    c.enable(gl::BLEND);
                    c.blend_func(gl::ONE, gl::ONE);
                }
                cover(&mut c, with);
                let sum =
                    |k: usize| if blends { SOURCE[k].saturating_add(STORED[k]) } else { SOURCE[k] };
                let expected =
                    [0, 1, 2, 3].map(|k| if mask >> k & 1 == 1 { sum(k) } else { STORED[k] });
                assert_all(
                    &mut c,
                    expected,
                    &format!("{with:?}, mask {mask:04b}, blends {blends}"),
                );
            }
        }
    }
}

#[test]
fn logical_operations_work_on_bytes() {
    let functions: [fn(u8, u8) -> u8; 16] = [
        |_, _| 0,
        |s, d| s & d,
        |s, d| s & !d,
        |s, _| s,
        |s, d| !s & d,
        |_, d| d,
        |s, d| s ^ d,
        |s, d| s | d,
        |s, d| !(s | d),
        |s, d| !(s ^ d),
        |_, d| !d,
        |s, d| s | !d,
        |s, _| !s,
        |s, d| !s | d,
        |s, d| !(s & d),
        |_, _| 255,
    ];
    for with in ALL {
        for (i, function) in functions.iter().enumerate() {
            let mut c = stage();
            c.enable(gl::COLOR_LOGIC_OP);
            c.logic_op(gl::CLEAR + i as u32);
            // Blending counts for nothing then.
            c.enable(gl::BLEND);
            c.blend_func(gl::DST_COLOR, gl::ZERO);
            cover(&mut c, with);
            let expected = [0, 1, 2, 3].map(|k| function(SOURCE[k], STORED[k]));
            assert_all(&mut c, expected, &format!("{with:?}, operation {i}"));
        }
    }
}

/// A factor's token, and its value for component `k` in 255ths.
type Factor = (u32, fn(usize) -> u32);

const FACTORS: [Factor; 15] = [
    (gl::ZERO, |_| 0),
    (gl::ONE, |_| 255),
    (gl::SRC_COLOR, |k| SOURCE[k].into()),
    (gl::ONE_MINUS_SRC_COLOR, |k| 255 - u32::from(SOURCE[k])),
    (gl::DST_COLOR, |k| STORED[k].into()),
    (gl::ONE_MINUS_DST_COLOR, |k| 255 - u32::from(STORED[k])),
    (gl::SRC_ALPHA, |_| SOURCE[3].into()),
    (gl::ONE_MINUS_SRC_ALPHA, |_| 255 - u32::from(SOURCE[3])),
    (gl::DST_ALPHA, |_| STORED[3].into()),
    (gl::ONE_MINUS_DST_ALPHA, |_| 255 - u32::from(STORED[3])),
    (gl::CONSTANT_COLOR, |k| CONSTANT[k].into()),
    (gl::ONE_MINUS_CONSTANT_COLOR, |k| 255 - u32::from(CONSTANT[k])),
    (gl::CONSTANT_ALPHA, |_| CONSTANT[3].into()),
    (gl::ONE_MINUS_CONSTANT_ALPHA, |_| 255 - u32::from(CONSTANT[3])),
    (gl::SRC_ALPHA_SATURATE, |k| {
        if k == 3 { 255 } else { u32::from(SOURCE[3]).min(255 - u32::from(STORED[3])) }
    }),
];

#[test]
fn all_factors_give_the_nearest_byte() {
    for with in ALL {
        let mut c = stage();
        c.enable(gl::BLEND);
        let [r, g, b, a] = unit(CONSTANT);
        c.blend_color(r, g, b, a);
        for (source, s) in FACTORS {
            for (destination, d) in
                FACTORS.into_iter().filter(|(token, _)| *token != gl::SRC_ALPHA_SATURATE)
            {
                c.clear(gl::COLOR_BUFFER_BIT);
                c.blend_func(source, destination);
                cover(&mut c, with);
                // 255 is odd: no quotient is a half.
                let expected = [0, 1, 2, 3].map(|k| {
                    let sum = u32::from(SOURCE[k]) * s(k) + u32::from(STORED[k]) * d(k);
                    ((2 * sum + 255) / 510).min(255) as u8
                });
                assert_all(
                    &mut c,
                    expected,
                    &format!("{with:?}, factors {source:#x} and {destination:#x}"),
                );
            }
        }
    }
}

#[test]
fn equations_of_colour_and_alpha() {
    for with in ALL {
        for (token, function) in [
            (gl::FUNC_ADD, (|s, d| s + d) as fn(i32, i32) -> i32),
            (gl::FUNC_SUBTRACT, |s, d| s - d),
            (gl::FUNC_REVERSE_SUBTRACT, |s, d| d - s),
            (gl::MIN, i32::min),
            (gl::MAX, i32::max),
        ] {
            let mut c = stage();
            c.enable(gl::BLEND);
            c.blend_func(gl::ONE, gl::ONE);
            c.blend_equation(token);
            cover(&mut c, with);
            let expected = [0, 1, 2, 3]
                .map(|k| function(i32::from(SOURCE[k]), i32::from(STORED[k])).clamp(0, 255) as u8);
            assert_all(&mut c, expected, &format!("{with:?}, equation {token:#x}"));
        }
    }
}

#[test]
fn stipples_let_pass_their_bits_of_polygons() {
    // A byte for each eight columns, the leftmost pixel in the highest bit, rows from the bottom.
    let pattern: [u8; 128] = std::array::from_fn(|i| (i * 37 + 11) as u8 ^ (i / 4 * 5) as u8);
    for with in ALL {
        let mut c = stage();
        let at = c.put(&pattern);
        c.polygon_stipple(at);
        c.enable(gl::POLYGON_STIPPLE);
        cover(&mut c, with);
        for (i, pixel) in c.bytes().into_iter().enumerate() {
            let (x, y) = (i % SIDE as usize, i / SIDE as usize);
            let shows =
                matches!(with, With::Points) || pattern[4 * y + x / 8] >> (7 - x % 8) & 1 == 1;
            assert_eq!(pixel, if shows { SOURCE } else { STORED }, "{with:?} at ({x}, {y})");
        }
    }
}

#[test]
fn queries_count_samples_that_pass() {
    for with in ALL {
        for (alpha, expected) in [(0.5, 24 * 10), (0.7, 0)] {
            let mut c = stage();
            // The upper part is near: there nothing passes.
            c.enable(gl::DEPTH_TEST);
            c.begin(gl::QUADS);
            for [x, y] in [[0.0, 10.0], [24.0, 10.0], [24.0, 24.0], [0.0, 24.0]] {
                c.vertex_3f(x, y, 0.5);
            }
            c.end();
            c.enable(gl::ALPHA_TEST);
            c.alpha_func(gl::GREATER, alpha);
            let names = c.put(&[0u32; 2]);
            c.gen_queries(1, names);
            let query = c.take::<u32>(names, 1)[0];
            c.begin_query(gl::SAMPLES_PASSED, query);
            cover(&mut c, with);
            c.end_query(gl::SAMPLES_PASSED);
            c.get_query_objectuiv(query, gl::QUERY_RESULT, names + 4);
            assert_eq!(c.take::<u32>(names + 4, 1)[0], expected, "{with:?}, alpha above {alpha}");
        }
    }
}
