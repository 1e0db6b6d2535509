//! What programs that others wrote rely on, found by running them with Mesa and with us: lines,
//! framebuffers that lack or mix attachments, depth textures with several levels or six faces,
//! colours beyond 0..=1.

use crate::common::{BUFFER, Stage, assert_color};
use vitral_gl::enums as gl;

/// A framebuffer object, bound.
fn framebuffer(c: &mut Stage) {
    c.bind_framebuffer_ext(gl::FRAMEBUFFER, 1);
}

/// A renderbuffer of this format, attached.
fn attach(c: &mut Stage, point: u32, format: u32, [width, height]: [i32; 2], name: u32) {
    c.bind_renderbuffer_ext(gl::RENDERBUFFER, name);
    c.renderbuffer_storage(gl::RENDERBUFFER, format, width, height);
    c.framebuffer_renderbuffer(gl::FRAMEBUFFER, point, gl::RENDERBUFFER, name);
}

/// The columns of row 0 that a line at its centre lights.
fn columns(c: &mut Stage, from: f32, to: f32) -> Vec<usize> {
    c.clear(gl::COLOR_BUFFER_BIT);
    c.begin(gl::LINES);
    c.vertex_2f(from, 0.5);
    c.vertex_2f(to, 0.5);
    c.end();
    let row = c.bytes();
    (0..8).filter(|&x| row[x][0] > 0).collect()
}

#[test]
fn lines_draw_the_pixels_whose_diamonds_they_leave() {
    let mut c = Stage::new(8, 4);
    c.pixels();
    // Section 3.4.1: the first pixel is drawn, the last is not, whichever way the line runs.
    assert_eq!(columns(&mut c, 1.5, 4.5), [1, 2, 3]);
    assert_eq!(columns(&mut c, 4.5, 1.5), [2, 3, 4]);
    assert_eq!(columns(&mut c, 1.7, 4.7), [1, 2, 3]);
    assert_eq!(columns(&mut c, 1.3, 4.3), [1, 2, 3]);
    assert_eq!(columns(&mut c, 4.3, 1.3), [2, 3, 4]);
    assert_eq!(columns(&mut c, 2.4, 2.6), [0_usize; 0]);
}

#[test]
fn a_closed_line_draws_each_pixel_once() {
    let mut c = Stage::new(8, 8);
    c.pixels();
    c.clear(gl::COLOR_BUFFER_BIT);
    c.enable(gl::BLEND);
    c.blend_func(gl::ONE, gl::ONE);
    c.color_3f(0.25, 0.25, 0.25);
    c.begin(gl::LINE_LOOP);
    for [x, y] in [[1.5, 1.5], [5.5, 1.5], [5.5, 6.5], [1.5, 6.5]] {
        c.vertex_2f(x, y);
    }
    c.end();
    let lit = c.bytes();
    for y in 0..8 {
        for x in 0..8 {
            let edge = (1..=5).contains(&x)
                && (1..=6).contains(&y)
                && (x == 1 || x == 5 || y == 1 || y == 6);
            assert_eq!(lit[y * 8 + x][0], if edge { 64 } else { 0 }, "({x}, {y})");
        }
    }
}

#[test]
fn the_stipple_goes_on_round_corners() {
    let mut c = Stage::new(16, 4);
    c.pixels();
    c.clear(gl::COLOR_BUFFER_BIT);
    c.enable(gl::LINE_STIPPLE);
    c.line_stipple(3, 0xAAAA);
    c.begin(gl::LINE_STRIP);
    for [x, y] in [[0.5, 0.5], [15.5, 0.5], [15.5, 1.5], [0.5, 1.5]] {
        c.vertex_2f(x, y);
    }
    c.end();
    let lit = c.bytes();
    let path = (0..15).map(|x| (x, 0)).chain([(15, 0)]).chain((1..16).rev().map(|x| (x, 1)));
    for (count, (x, y)) in path.enumerate() {
        assert_eq!(lit[y * 16 + x][0] > 0, count / 3 % 2 == 1, "pixel {count}, ({x}, {y})");
    }
}

#[test]
fn an_edge_that_two_polygons_share_passes_a_test_for_equal_depth() {
    // Polygon mode LINE draws the shared edge twice, in opposite directions: depths must agree bit
    // by bit.
    let mut c = Stage::new(64, 64);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    c.frustum(-1.0, 1.0, -1.0, 1.0, 1.0, 9.0);
    c.enable(gl::DEPTH_TEST);
    c.depth_func(gl::LEQUAL);
    c.enable(gl::BLEND);
    c.blend_func(gl::ONE, gl::ONE);
    c.polygon_mode(gl::FRONT_AND_BACK, gl::LINE);
    c.color_3f(0.25, 0.25, 0.25);
    let (a, b) = ([-0.9f32, -0.37, -1.3], [3.1f32, 2.03, -5.7]);
    for (first, second) in [(a, b), (b, a)] {
        c.begin(gl::TRIANGLES);
        for [x, y, z] in [first, second] {
            c.edge_flag(u8::from([x, y, z] == first));
            c.vertex_3f(x, y, z);
        }
        c.edge_flag(0);
        c.vertex_3f(0.3, -0.6, -2.0);
        c.end();
    }
    let lit: Vec<u8> = c.bytes().iter().map(|p| p[0]).filter(|&v| v > 0).collect();
    let twice = lit.iter().filter(|&&v| v == 128).count();
    // But for the two ends, where one direction draws and the other does not.
    assert!(
        lit.len() > 20 && twice + 2 >= lit.len(),
        "{twice} of {} pixels were drawn twice",
        lit.len()
    );
}

#[test]
fn a_framebuffer_of_depths_needs_no_colours() {
    let mut c = Stage::new(4, 4);
    framebuffer(&mut c);
    attach(&mut c, gl::DEPTH_ATTACHMENT, gl::DEPTH_COMPONENT24, [4, 4], 1);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
    c.clear_depth(0.25);
    c.clear(gl::DEPTH_BUFFER_BIT | gl::COLOR_BUFFER_BIT);
    assert!(c.depths().iter().all(|d| (d - 0.25).abs() < 1e-6));
    c.no_error();
    c.read_pixels(0, 0, 1, 1, gl::RGBA, gl::UNSIGNED_BYTE, BUFFER);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    // A buffer that was named has to be there.
    c.draw_buffer(gl::COLOR_ATTACHMENT0 + 1);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_INCOMPLETE_DRAW_BUFFER);
    c.draw_buffer(gl::NONE);
    c.read_buffer(gl::COLOR_ATTACHMENT0 + 1);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_INCOMPLETE_READ_BUFFER);
    c.read_buffer(gl::NONE);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
}

#[test]
fn attachments_of_different_sizes_share_the_common_area() {
    // Tiles are 64 wide: the planes have different numbers of them in a row.
    let mut c = Stage::new(200, 70);
    framebuffer(&mut c);
    attach(&mut c, gl::COLOR_ATTACHMENT0, gl::RGBA8, [200, 70], 1);
    attach(&mut c, gl::DEPTH_ATTACHMENT, gl::DEPTH_COMPONENT24, [100, 90], 2);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
    c.viewport(0, 0, 100, 70);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    c.enable(gl::DEPTH_TEST);
    c.fill([0.0, 1.0, 0.0, 1.0], 0.0);
    c.fill([1.0, 0.0, 0.0, 1.0], 0.5);
    c.size = [100, 70];
    assert!(c.bytes().iter().all(|p| *p == [0, 255, 0, 255]));
    assert!(c.depths().iter().all(|d| (d - 0.5).abs() < 1e-6));
    c.no_error();
}

#[test]
fn renderbuffers_hold_all_kinds_of_colours() {
    for (format, expected) in [
        (gl::ALPHA8, [0.0, 0.0, 0.0, 0.8]),
        (gl::LUMINANCE8, [0.2, 0.0, 0.0, 1.0]),
        (gl::LUMINANCE8_ALPHA8, [0.2, 0.0, 0.0, 0.8]),
        (gl::RGB8, [0.2, 0.4, 0.6, 1.0]),
    ] {
        let mut c = Stage::new(4, 4);
        framebuffer(&mut c);
        attach(&mut c, gl::COLOR_ATTACHMENT0, format, [4, 4], 1);
        assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
        c.clear_color(0.2, 0.4, 0.6, 0.8);
        c.clear(gl::COLOR_BUFFER_BIT);
        let found = c.pixel(1, 1);
        for k in 0..4 {
            assert!(
                (f32::from(found[k]) / 255.0 - expected[k]).abs() < 0.01,
                "{format:#x}: {found:?}"
            );
        }
        c.no_error();
    }
}

/// A depth texture of two levels, drawn to and then sampled with mipmaps.
#[test]
fn levels_of_a_depth_texture_are_drawn_to_and_sampled() {
    let mut c = Stage::new(4, 4);
    c.bind_texture(gl::TEXTURE_2D, 1);
    for (level, size) in [(0, 4), (1, 2), (2, 1)] {
        let internal = gl::DEPTH_COMPONENT24 as i32;
        c.tex_image_2d(
            gl::TEXTURE_2D,
            level,
            internal,
            size,
            size,
            0,
            gl::DEPTH_COMPONENT,
            gl::FLOAT,
            0,
        );
    }
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, gl::NEAREST_MIPMAP_NEAREST as i32);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_MAG_FILTER, gl::NEAREST as i32);
    framebuffer(&mut c);
    for level in 0..3 {
        c.framebuffer_texture_2d(gl::FRAMEBUFFER, gl::DEPTH_ATTACHMENT, gl::TEXTURE_2D, 1, level);
        c.clear_depth(0.2 + 0.3 * f64::from(level));
        c.clear(gl::DEPTH_BUFFER_BIT);
    }
    c.bind_framebuffer_ext(gl::FRAMEBUFFER, 0);
    c.enable(gl::TEXTURE_2D);
    c.tex_envi(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, gl::REPLACE as i32);
    for (bias, expected) in [(0.0, 0.2), (1.0, 0.5), (2.0, 0.8)] {
        c.tex_envf(gl::TEXTURE_FILTER_CONTROL, gl::TEXTURE_LOD_BIAS, bias);
        c.fill([1.0; 4], 0.0);
        assert_color(c.pixel(1, 2), [expected, expected, expected, 1.0]);
    }
    // A rectangle of pixels meets the texture too.
    c.raster_pos_2f(-1.0, -1.0);
    let at = c.put(&[[1.0f32; 4]; 16]);
    c.draw_pixels(4, 4, gl::RGBA, gl::FLOAT, at);
    assert!(c.pixel(0, 0)[0] > 0);
    c.no_error();
}

#[test]
fn floating_point_depths_are_compared_with_any_number() {
    let mut c = Stage::new(4, 4);
    c.enable(gl::TEXTURE_2D);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, gl::NEAREST as i32);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_COMPARE_MODE, gl::COMPARE_R_TO_TEXTURE as i32);
    for (format, passes) in [(gl::DEPTH_COMPONENT24, 255), (gl::DEPTH_COMPONENT32F, 0)] {
        let at = c.put(&[1.0f32]);
        c.tex_image_2d(
            gl::TEXTURE_2D,
            0,
            format as i32,
            1,
            1,
            0,
            gl::DEPTH_COMPONENT,
            gl::FLOAT,
            at,
        );
        c.begin(gl::QUADS);
        c.tex_coord_3f(0.5, 0.5, 1.5);
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            c.vertex_2f(x, y);
        }
        c.end();
        assert_eq!(c.pixel(2, 1)[0], passes);
    }
    c.no_error();
}

#[test]
fn a_negative_q_turns_to_the_opposite_face() {
    let mut c = Stage::new(32, 32);
    for face in 0..6u8 {
        let at = c.put(&[[40 * face, 0, 0, 255]; 4]);
        let target = gl::TEXTURE_CUBE_MAP_POSITIVE_X + u32::from(face);
        c.tex_image_2d(target, 0, gl::RGBA as i32, 2, 2, 0, gl::RGBA, gl::UNSIGNED_BYTE, at);
    }
    c.enable(gl::TEXTURE_CUBE_MAP);
    for filter in [gl::NEAREST, gl::LINEAR] {
        c.tex_parameteri(gl::TEXTURE_CUBE_MAP, gl::TEXTURE_MIN_FILTER, filter as i32);
        for (q, face) in [(1.0, 4), (-1.0, 5), (0.5, 4), (-0.5, 5)] {
            for size in [1.0, 0.1] {
                c.begin(gl::QUADS);
                c.tex_coord_4f(0.0, 0.0, 1.0, q);
                for [x, y] in [[-size, -size], [size, -size], [size, size], [-size, size]] {
                    c.vertex_2f(x, y);
                }
                c.end();
                assert_eq!(c.pixel(16, 16)[0], 40 * face, "{q}");
            }
        }
    }
    c.no_error();
}

#[test]
fn cube_maps_may_hold_depths() {
    let mut c = Stage::new(4, 4);
    c.bind_texture(gl::TEXTURE_CUBE_MAP, 1);
    for filter in [gl::TEXTURE_MIN_FILTER, gl::TEXTURE_MAG_FILTER] {
        c.tex_parameteri(gl::TEXTURE_CUBE_MAP, filter, gl::NEAREST as i32);
    }
    for face in 0..6 {
        let at = c.put(&[0.1 + 0.15 * face as f32; 4]);
        let (target, internal) =
            (gl::TEXTURE_CUBE_MAP_POSITIVE_X + face, gl::DEPTH_COMPONENT24 as i32);
        c.tex_image_2d(target, 0, internal, 2, 2, 0, gl::DEPTH_COMPONENT, gl::FLOAT, at);
    }
    // One face is drawn to.
    framebuffer(&mut c);
    let drawn = gl::TEXTURE_CUBE_MAP_POSITIVE_X + 3;
    c.framebuffer_texture_2d(gl::FRAMEBUFFER, gl::DEPTH_ATTACHMENT, drawn, 1, 0);
    c.clear_depth(1.0);
    c.clear(gl::DEPTH_BUFFER_BIT);
    c.bind_framebuffer_ext(gl::FRAMEBUFFER, 0);
    c.enable(gl::TEXTURE_CUBE_MAP);
    c.tex_envi(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, gl::REPLACE as i32);
    let directions =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
    for (face, [s, t, r]) in directions.into_iter().enumerate() {
        c.begin(gl::QUADS);
        c.tex_coord_3f(s, t, r);
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            c.vertex_2f(x, y);
        }
        c.end();
        let depth = if face == 3 { 1.0 } else { 0.1 + 0.15 * face as f32 };
        assert_color(c.pixel(2, 1), [depth, depth, depth, 1.0]);
    }
    c.no_error();
    c.tex_image_3d(
        gl::TEXTURE_3D,
        0,
        gl::DEPTH_COMPONENT as i32,
        2,
        2,
        2,
        0,
        gl::DEPTH_COMPONENT,
        gl::FLOAT,
        0,
    );
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
}

#[test]
fn the_constant_colour_is_clamped_where_it_is_used() {
    for (format, expected) in
        [(gl::RGBA32F_ARB, [2.0, 0.0, 0.25, 1.5]), (gl::RGBA8, [1.0, 0.0, 0.25, 1.0])]
    {
        let mut c = Stage::new(2, 2);
        framebuffer(&mut c);
        attach(&mut c, gl::COLOR_ATTACHMENT0, format, [2, 2], 1);
        c.blend_color(2.0, -1.0, 0.25, 1.5);
        assert_eq!(c.get::<4>(gl::BLEND_COLOR), [1.0, 0.0, 0.25, 1.0]);
        c.enable(gl::BLEND);
        c.blend_func(gl::CONSTANT_COLOR, gl::ZERO);
        c.fill([1.0; 4], 0.0);
        let found = c.floats()[0];
        let lowest = if format == gl::RGBA8 { 0.0 } else { -1.0 };
        let expected = [expected[0], lowest, expected[2], expected[3]];
        assert!((0..4).all(|k| (found[k] - expected[k]).abs() < 0.01), "{format:#x}: {found:?}");
    }
}

#[test]
fn colours_of_fragments_may_be_clamped_on_their_way_to_floats() {
    let mut c = Stage::with_buffer(2, 2, gl::RGBA, gl::FLOAT);
    for (clamped, expected) in [(false, 3.0), (true, 1.0)] {
        c.set_fragment_clamp(clamped);
        let at = c.put(&[[3.0f32; 4]; 4]);
        c.raster_pos_2f(-1.0, -1.0);
        c.draw_pixels(2, 2, gl::RGBA, gl::FLOAT, at);
        assert_eq!(c.floats()[0], [expected; 4]);
    }
}

#[test]
fn logic_operations_combine_16_bits() {
    let mut c = Stage::new(2, 2);
    framebuffer(&mut c);
    for (format, combined) in [(gl::RGBA8, true), (gl::RGBA16, true), (gl::RGBA32F_ARB, false)] {
        attach(&mut c, gl::COLOR_ATTACHMENT0, format, [2, 2], 1);
        for (op, expected) in [
            (gl::INVERT, [0.8, 0.6, 0.0, 1.0]),
            (gl::SET, [1.0; 4]),
            (gl::NOOP, [0.2, 0.4, 1.0, 0.0]),
        ] {
            c.clear_color(0.2, 0.4, 1.0, 0.0);
            c.clear(gl::COLOR_BUFFER_BIT);
            c.enable(gl::COLOR_LOGIC_OP);
            c.logic_op(op);
            c.fill([0.5; 4], 0.0);
            c.disable(gl::COLOR_LOGIC_OP);
            assert_color(c.pixel(1, 1), if combined { expected } else { [0.5; 4] });
        }
        // Both are rounded alike.
        c.clear_color(0.4, 0.4, 0.4, 0.4);
        c.clear(gl::COLOR_BUFFER_BIT);
        c.enable(gl::COLOR_LOGIC_OP);
        c.logic_op(gl::XOR);
        c.fill([0.4; 4], 0.0);
        c.disable(gl::COLOR_LOGIC_OP);
        assert_color(c.pixel(1, 1), [if combined { 0.0 } else { 0.4 }; 4]);
    }
    c.no_error();
}

#[test]
fn framebuffers_of_srgb_colours_encode_them_on_demand() {
    // EXT_framebuffer_sRGB: 0.5 is stored as 188 of 255; blending works on what is stored, decoded.
    let mut c = Stage::new(2, 2);
    assert_eq!(c.get(gl::FRAMEBUFFER_SRGB_CAPABLE_EXT), [0.0]);
    framebuffer(&mut c);
    attach(&mut c, gl::COLOR_ATTACHMENT0, gl::SRGB8_ALPHA8_EXT, [2, 2], 1);
    assert_eq!(c.get(gl::FRAMEBUFFER_SRGB_CAPABLE_EXT), [1.0]);
    c.fill([0.5; 4], 0.0);
    assert_color(c.pixel(0, 0), [0.5; 4]);
    c.enable(gl::FRAMEBUFFER_SRGB);
    c.fill([0.5; 4], 0.0);
    assert_color(c.pixel(0, 0), [188.0 / 255.0, 188.0 / 255.0, 188.0 / 255.0, 0.5]);
    c.clear_color(0.5, 0.0, 1.0, 0.25);
    c.clear(gl::COLOR_BUFFER_BIT);
    assert_color(c.pixel(0, 0), [188.0 / 255.0, 0.0, 1.0, 0.25]);
    c.enable(gl::BLEND);
    c.blend_func(gl::ONE, gl::ONE);
    c.fill([0.25; 4], 0.0);
    // 0.75 and 0.25 encoded.
    assert_color(c.pixel(0, 0), [225.0 / 255.0, 137.0 / 255.0, 1.0, 0.5]);
}

#[test]
fn a_light_at_infinity_has_a_cone() {
    // Equation 2.5: the spot factor is the cosine between the ray and the cone's axis, to the
    // exponent.
    let mut c = Stage::new(2, 2);
    c.enable(gl::LIGHTING);
    c.enable(gl::LIGHT0);
    let (half, exponent) = (3.0f32.sqrt() / 2.0, 1.0);
    let position = c.put(&[0.0f32, 0.0, -1.0, 0.0]);
    let axis = c.put(&[half, 0.0, 0.5, 0.0]);
    let red = c.put(&[1.0f32, 0.0, 0.0, 1.0]);
    let black = c.put(&[0.0f32, 0.0, 0.0, 1.0]);
    let white = c.put(&[1.0f32; 4]);
    c.light_modelfv(gl::LIGHT_MODEL_AMBIENT, black);
    c.lightfv(gl::LIGHT0, gl::POSITION, position);
    c.lightfv(gl::LIGHT0, gl::SPOT_DIRECTION, axis);
    c.lightfv(gl::LIGHT0, gl::AMBIENT, red);
    c.lightfv(gl::LIGHT0, gl::DIFFUSE, black);
    c.lightf(gl::LIGHT0, gl::SPOT_EXPONENT, exponent);
    c.materialfv(gl::FRONT, gl::AMBIENT, white);
    for (cutoff, expected) in [(180.0, 1.0), (89.0, 0.5), (59.0, 0.0)] {
        c.lightf(gl::LIGHT0, gl::SPOT_CUTOFF, cutoff);
        c.fill([1.0; 4], 0.0);
        assert_color(c.pixel(0, 0), [expected, 0.0, 0.0, 1.0]);
    }
}

#[test]
fn luminance_of_a_texture_is_its_red_and_of_a_picture_the_sum() {
    let mut c = Stage::new(1, 1);
    let texel = c.put(&[0.5f32, 0.25, 0.125, 1.0]);
    c.tex_image_2d(gl::TEXTURE_2D, 0, gl::RGBA as i32, 1, 1, 0, gl::RGBA, gl::FLOAT, texel);
    let result = c.put(&[0.0f32; 4]);
    c.get_tex_image(gl::TEXTURE_2D, 0, gl::LUMINANCE, gl::FLOAT, result);
    assert!((c.take::<f32>(result, 1)[0] - 0.5).abs() < 0.005);
    c.fill([0.5, 0.25, 0.125, 1.0], 0.0);
    c.read_pixels(0, 0, 1, 1, gl::LUMINANCE, gl::FLOAT, result);
    assert!((c.take::<f32>(result, 1)[0] - 0.875).abs() < 0.01);
}

#[test]
fn the_scale_of_alpha_holds_beside_an_unscaled_dot_product() {
    // EXT_texture_env_dot3: RGB_SCALE does not apply to DOT3_RGB_EXT; ALPHA_SCALE belongs to the
    // function of alpha.
    let mut c = Stage::new(2, 2);
    c.texture(&[(1, vec![[255, 255, 255, 64]])]);
    for (name, value) in [
        (gl::TEXTURE_ENV_MODE, gl::COMBINE),
        (gl::COMBINE_RGB, gl::DOT3_RGB_EXT),
        (gl::COMBINE_ALPHA, gl::REPLACE),
        (gl::SOURCE0_RGB, gl::TEXTURE),
        (gl::SOURCE1_RGB, gl::TEXTURE),
        (gl::SOURCE0_ALPHA, gl::TEXTURE),
    ] {
        c.tex_envi(gl::TEXTURE_ENV, name, value as i32);
    }
    c.tex_envf(gl::TEXTURE_ENV, gl::ALPHA_SCALE, 2.0);
    c.fill([1.0; 4], 0.0);
    assert_color(c.pixel(0, 0), [1.0, 1.0, 1.0, 128.0 / 255.0]);
}

#[test]
fn errors_where_several_rules_meet() {
    let mut c = Stage::new(2, 2);
    // A packed type with a format that is not its own, be it known or not.
    c.draw_pixels(1, 1, 0x8228, gl::UNSIGNED_SHORT_5_6_5, BUFFER);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    c.draw_pixels(1, 1, 0x8228, gl::UNSIGNED_BYTE, BUFFER);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
    // One of format and internal format is of depth.
    let depth = gl::DEPTH_COMPONENT24 as i32;
    c.tex_image_2d(gl::TEXTURE_2D, 0, depth, 2, 2, 0, gl::STENCIL_INDEX, gl::INT, 0);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    // Depth with stencil has no mipmaps.
    let packed = gl::DEPTH24_STENCIL8 as i32;
    c.tex_image_2d(gl::TEXTURE_2D, 0, packed, 2, 2, 0, gl::DEPTH_STENCIL, gl::UNSIGNED_INT_24_8, 0);
    c.no_error();
    c.generate_mipmap(gl::TEXTURE_2D);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    // All draws or none.
    let corners = c.put(&[[-1.0f32, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]]);
    let (firsts, counts) = (c.put(&[0i32, 0]), c.put(&[4i32, -1]));
    c.vertex_pointer(2, gl::FLOAT, 0, corners);
    c.enable_client_state(gl::VERTEX_ARRAY);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.multi_draw_arrays(gl::TRIANGLE_STRIP, firsts, counts, 2);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
    assert_eq!(c.pixel(0, 0), [0; 4]);
}

#[test]
fn counts_of_static_elements_are_kept() {
    let mut c = Stage::new(1, 1);
    let at = c.put(&[0.0f32; 8]);
    c.vertex_pointer_ext(2, gl::FLOAT, 0, 4, at);
    c.color_pointer_ext(3, gl::FLOAT, 0, 2, at);
    assert_eq!(
        (c.get(gl::VERTEX_ARRAY_COUNT_EXT), c.get(gl::COLOR_ARRAY_COUNT_EXT)),
        ([4.0], [2.0])
    );
    c.normal_pointer_ext(gl::FLOAT, 0, -1, at);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
    c.vertex_pointer(2, gl::FLOAT, 0, at);
    assert_eq!(c.get(gl::VERTEX_ARRAY_COUNT_EXT), [0.0]);
}

#[test]
fn a_smooth_polygon_that_a_plane_cuts_keeps_its_soft_edges() {
    let mut c = Stage::new(16, 16);
    c.pixels();
    c.enable(gl::POLYGON_SMOOTH);
    c.enable(gl::BLEND);
    c.blend_func(gl::SRC_ALPHA_SATURATE, gl::ONE);
    let plane = c.put(&[1.0f64, 0.0, 0.0, -8.0]);
    c.clip_plane(gl::CLIP_PLANE0, plane);
    c.enable(gl::CLIP_PLANE0);
    c.clear_color(0.0, 0.0, 0.0, 0.0);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.begin(gl::QUADS);
    for [x, y] in [[2.0, 3.5], [13.0, 3.5], [13.0, 12.0], [2.0, 12.0]] {
        c.vertex_2f(x, y);
    }
    c.end();
    let lit = c.bytes();
    let red = |x: usize, y: usize| i32::from(lit[y * 16 + x][0]);
    assert!((red(10, 3) - 128).abs() <= 8, "half a pixel is covered: {}", red(10, 3));
    assert_eq!((red(10, 7), red(7, 7), red(8, 7), red(10, 1)), (255, 0, 255, 0));
}
