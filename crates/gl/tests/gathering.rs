//! Small draws that wait for each other: what is drawn is what would have been drawn one by one.

use crate::common::{Dice, Stage};
use std::sync::{Arc, OnceLock};
use vitral_exec::Workers;
use vitral_gl::enums as gl;
use vitral_math::lanes::Level;
use vitral_raster::forward::Runner;

fn material(c: &mut Stage, d: &mut Dice) {
    let names = [
        gl::AMBIENT,
        gl::DIFFUSE,
        gl::SPECULAR,
        gl::EMISSION,
        gl::AMBIENT_AND_DIFFUSE,
        gl::SHININESS,
    ];
    let faces = [gl::FRONT, gl::BACK, gl::FRONT_AND_BACK];
    let (face, name, color) = (faces[d.below(3) as usize], names[d.below(6) as usize], d.color());
    let color = c.put(&color);
    c.materialfv(face, name, color);
}

fn matrix(c: &mut Stage, d: &mut Dice) {
    match d.below(6) {
        0 => c.translatef(d.number() * 0.3, d.number() * 0.3, d.number() * 0.1),
        1 => c.rotatef(d.number() * 90.0, d.number(), d.number(), 1.0),
        2 => c.scalef(0.9, 1.1, 1.0),
        3 => c.push_matrix(),
        4 => c.pop_matrix(),
        _ => c.load_identity(),
    }
}

/// Begin, some vertices, End.
fn pair(c: &mut Stage, d: &mut Dice) {
    let [x, y] = [d.number() * 0.7, d.number() * 0.7];
    c.begin(d.below(10));
    for _ in 0..d.below(9) {
        match d.below(12) {
            0..3 => c.normal_3f(d.number(), d.number(), 1.0),
            3..5 => c.color_4fv(Some(d.color())),
            5 => c.tex_coord_2f(d.number(), d.number()),
            6 => material(c, d),
            7 => c.edge_flag(d.below(2) as u8),
            8 => c.fog_coordf(d.number()),
            9 => c.secondary_color_3f(d.number(), 0.5, 0.25),
            _ => {}
        }
        c.vertex_4f(x + d.number() * 0.4, y + d.number() * 0.4, d.number() * 0.5, 1.0);
    }
    c.end();
}

/// A call that changes what primitives are drawn with; some see to what waits themselves.
fn change(c: &mut Stage, d: &mut Dice) {
    let on = d.below(2) == 1;
    let modes = [gl::POINT, gl::LINE, gl::FILL, gl::FILL];
    let switches = [
        gl::LIGHTING,
        gl::BLEND,
        gl::DEPTH_TEST,
        gl::COLOR_MATERIAL,
        gl::CULL_FACE,
        gl::LINE_STIPPLE,
        gl::NORMALIZE,
        gl::CLIP_PLANE0,
        gl::FOG,
        gl::COLOR_SUM,
        gl::TEXTURE_2D,
    ];
    match d.below(20) {
        0 => c.shade_model(if on { gl::FLAT } else { gl::SMOOTH }),
        1 => {
            c.flush_vertices();
            c.polygon_mode(gl::FRONT_AND_BACK, modes[d.below(4) as usize]);
        }
        2 => {
            c.flush_vertices();
            c.light_modeli(gl::LIGHT_MODEL_TWO_SIDE, i32::from(on));
        }
        3 => {
            c.flush_vertices();
            c.point_size(1.0 + d.below(5) as f32);
        }
        4 => c.bind_texture(gl::TEXTURE_2D, d.below(3)),
        _ if on => c.enable(switches[d.below(11) as usize]),
        _ => c.disable(switches[d.below(11) as usize]),
    }
}

fn arrays(c: &mut Stage, d: &mut Dice) {
    if d.below(2) == 0 {
        c.draw_arrays(d.below(10), d.below(9) as i32, d.below(30) as i32);
    } else {
        let indices: [u8; 20] = std::array::from_fn(|_| d.below(40) as u8);
        let indices = c.put(&indices);
        c.draw_elements(d.below(10), d.below(20) as i32, gl::UNSIGNED_BYTE, indices);
    }
}

/// What a list may hold.
fn listed(c: &mut Stage, d: &mut Dice) {
    for _ in 0..d.below(6) {
        match d.below(8) {
            0 => matrix(c, d),
            1 => material(c, d),
            2 => c.color_4fv(Some(d.color())),
            3 => c.normal_3f(0.0, d.number(), 1.0),
            4 => c.disable(gl::FOG),
            _ => pair(c, d),
        }
    }
}

/// A program without order.
fn run(c: &mut Stage, seed: u64) {
    let mut d = Dice(seed);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    c.enable(gl::LIGHT0);
    c.enable(gl::DEPTH_TEST);
    c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
    c.line_stipple(1, 0x6d);
    let corners: Vec<[f32; 3]> =
        (0..40).map(|_| [d.number(), d.number(), d.number() * 0.5]).collect();
    let corners = c.put(&corners);
    let colors: Vec<[f32; 4]> = (0..40).map(|_| d.color()).collect();
    let colors = c.put(&colors);
    c.vertex_pointer(3, gl::FLOAT, 0, corners);
    c.color_pointer(4, gl::FLOAT, 0, colors);
    c.enable_client_state(gl::VERTEX_ARRAY);
    for texture in 1..3u8 {
        let texels: Vec<[u8; 4]> = (0..16).map(|i| [i * 16, 255 / texture, 90, 255 - i]).collect();
        c.bind_texture(gl::TEXTURE_2D, texture.into());
        c.texture(&[(4, texels)]);
    }
    let plane = c.put(&[0.3, 1.0, 0.2, 0.6]);
    c.clip_plane(gl::CLIP_PLANE0, plane);
    for list in 1..=8 {
        c.new_list(list, gl::COMPILE);
        listed(c, &mut d);
        if list > 4 {
            c.call_list(d.below(4) + 1);
        }
        c.end_list();
    }
    for _ in 0..300 {
        match d.below(16) {
            0..3 => matrix(c, &mut d),
            3..5 => material(c, &mut d),
            5 => change(c, &mut d),
            6..8 => c.call_list(d.below(9)),
            8 => arrays(c, &mut d),
            9 => {
                let on = d.below(2) == 1;
                if on {
                    c.enable_client_state(gl::COLOR_ARRAY)
                } else {
                    c.disable_client_state(gl::COLOR_ARRAY)
                }
            }
            10 => c.color_4fv(Some(d.color())),
            _ => pair(c, &mut d),
        }
    }
    c.finish();
}

#[test]
fn draws_that_wait_for_each_other_are_drawn_as_one_by_one() {
    for seed in 0..150 {
        let [mut alone, mut together] = [Stage::new(64, 48), Stage::new(64, 48)];
        together.set_merging(true);
        run(&mut alone, seed);
        run(&mut together, seed);
        let (a, b) = (alone.bytes(), together.bytes());
        let apart = a.iter().zip(&b).filter(|(a, b)| a != b).count();
        assert_eq!(apart, 0, "pixels of program {seed}");
        assert!(alone.depths() == together.depths(), "depths of program {seed}");
        assert!(a.iter().filter(|p| **p != a[0]).count() > 50, "program {seed} draws something");
    }
}

/// Red over all, a green line on it, blue over the right half of both.
#[test]
fn lines_and_polygons_of_a_list_are_drawn_in_their_order() {
    let mut c = Stage::new(8, 8);
    c.pixels();
    c.new_list(1, gl::COMPILE);
    c.color_3f(1.0, 0.0, 0.0);
    let quad = |c: &mut Stage, x: f32| {
        c.begin(gl::QUADS);
        [[x, 0.0], [8.0, 0.0], [8.0, 8.0], [x, 8.0]].iter().for_each(|[x, y]| c.vertex_2f(*x, *y));
        c.end();
    };
    quad(&mut c, 0.0);
    c.color_3f(0.0, 1.0, 0.0);
    c.begin(gl::LINES);
    c.vertex_2f(0.0, 4.5);
    c.vertex_2f(8.0, 4.5);
    c.end();
    c.color_3f(0.0, 0.0, 1.0);
    quad(&mut c, 4.0);
    c.end_list();
    c.call_list(1);
    let (red, green, blue) = ([255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]);
    assert_eq!(
        [c.pixel(1, 1), c.pixel(1, 4), c.pixel(6, 1), c.pixel(6, 4)],
        [red, green, blue, blue]
    );
}

/// A draw from arrays that has too few vertices for its primitive leaves nothing behind.
#[test]
fn a_colour_after_a_draw_is_not_that_draw_s() {
    let mut c = Stage::new(8, 8);
    c.set_merging(true);
    let corners = c.put(&[[-1.0f32, -1.0], [3.0, -1.0], [-1.0, 3.0]]);
    let colors = c.put(&[[0u8, 0, 255, 255]; 3]);
    let indices = c.put(&[0u8, 1, 2]);
    c.vertex_pointer(2, gl::FLOAT, 0, corners);
    c.color_pointer(4, gl::UNSIGNED_BYTE, 0, colors);
    c.enable_client_state(gl::VERTEX_ARRAY);
    c.enable_client_state(gl::COLOR_ARRAY);
    c.draw_elements(gl::TRIANGLES, 3, gl::UNSIGNED_BYTE, indices);
    c.draw_arrays(gl::TRIANGLE_STRIP, 0, 1);
    c.disable_client_state(gl::COLOR_ARRAY);
    c.color_3f(0.0, 1.0, 0.0);
    c.draw_elements(gl::TRIANGLES, 3, gl::UNSIGNED_BYTE, indices);
    let red = [1.0, 0.0, 0.0];
    if !c.quick_color(Some(red)) {
        c.color_3fv(Some(red));
    }
    c.finish();
    assert_eq!(c.pixel(4, 4), [0, 255, 0, 255]);
}

/// The threads of the contexts that draw while more is given.
fn threads() -> Arc<Runner> {
    static RUNNER: OnceLock<Arc<Runner>> = OnceLock::new();
    Arc::clone(RUNNER.get_or_init(|| Arc::new(Runner::new(Workers::new(3), Level::new()))))
}

/// Long primitives, of which a part is drawn before they end, between calls that change what they
/// are drawn with.
fn run_long(c: &mut Stage, mode: u32) {
    let mut d = Dice(u64::from(mode));
    c.enable(gl::BLEND);
    c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
    c.enable(gl::LIGHT0);
    c.enable(gl::COLOR_MATERIAL);
    c.enable(gl::TEXTURE_2D);
    let mut queries = [0; 4];
    for (part, query) in queries.iter_mut().enumerate() {
        let texels: Vec<[u8; 4]> =
            (0..16).map(|i| [i * 16, 255, 60 * part as u8, 255 - i]).collect();
        // As the library does before most calls.
        c.flush_vertices();
        c.bind_texture(gl::TEXTURE_2D, 1);
        c.texture(&[(4, texels)]);
        if part == 2 {
            c.enable(gl::LIGHTING);
            c.begin_query(gl::SAMPLES_PASSED, 7);
        }
        c.begin(mode);
        // Far from a multiple of anything.
        for vertex in 0..75_001 + 1234 * part {
            match d.below(3000) {
                0 => c.color_4fv(Some(d.color())),
                1 => c.normal_3f(d.number(), d.number(), 1.0),
                2 => material(c, &mut d),
                _ => {}
            }
            let [x, y] =
                [(vertex / 3 % 97) as f32 / 50.0 - 1.0, (vertex / 3 % 89) as f32 / 45.0 - 1.0];
            c.tex_coord_2f(x, y);
            let place = [x + d.number() * 0.05, y + d.number() * 0.05, d.number()];
            if !c.quick_vertex(Some(place)) {
                c.vertex_3fv(Some(place));
            }
        }
        c.end();
        if part == 2 {
            c.flush_vertices();
            c.end_query(gl::SAMPLES_PASSED);
        }
        c.translatef(0.1, 0.0, 0.0);
        *query = c.get_error();
    }
    assert_eq!(queries, [gl::NO_ERROR; 4]);
}

#[test]
fn long_primitives_are_drawn_while_they_are_given() {
    for mode in gl::POINTS..gl::POLYGON {
        let [mut alone, mut together] = [Stage::new(64, 48), Stage::new(64, 48)];
        together.set_runner_source(threads);
        together.set_merging(true);
        run_long(&mut alone, mode);
        run_long(&mut together, mode);
        let passed = [&mut alone, &mut together].map(|c| {
            let at = c.put(&[0u32]);
            c.get_query_objectuiv(7, gl::QUERY_RESULT, at);
            c.take::<u32>(at, 1)[0]
        });
        assert_eq!(passed[0], passed[1], "samples of mode {mode}");
        let (a, b) = (alone.bytes(), together.bytes());
        assert_eq!(a.iter().zip(&b).filter(|(a, b)| a != b).count(), 0, "pixels of mode {mode}");
        assert!(alone.depths() == together.depths(), "depths of mode {mode}");
        assert!(
            passed[0] > 1000 && a.iter().filter(|p| **p != a[0]).count() > 50,
            "mode {mode} draws something"
        );
    }
}
