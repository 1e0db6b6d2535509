//! What programs met: objects of other contexts, small updates, careless arrays, colours beyond 1,
//! old extensions.

use crate::common::{BUFFER, Stage, assert_color};
use std::sync::Arc;
use vitral_gl::memory::Arena;
use vitral_gl::{ClientMemory, Context, Shared, enums as gl};

const WHITE: [u8; 4] = [255; 4];
const BLACK: [u8; 4] = [0; 4];

#[test]
fn groups_of_contexts_have_names_of_their_own() {
    let memory = Arc::new(Arena::new(4096, 256));
    let name = |address| {
        let mut name = [0; 4];
        assert!(memory.read(address, &mut name));
        u32::from_ne_bytes(name)
    };
    let mut groups =
        [0; 2].map(|_| Context::new(memory.clone(), Arc::new(Shared::with_own_names())));
    let names = groups.each_mut().map(|c| {
        c.gen_textures(1, 4096);
        let texture = name(4096);
        c.gen_buffers(1, 4096);
        let buffer = name(4096);
        c.gen_framebuffers(1, 4096);
        let framebuffer = name(4096);
        c.gen_queries(1, 4096);
        [texture, buffer, framebuffer, name(4096), c.gen_lists(5)]
    });
    assert_ne!(names[0][0], names[1][0]);
    for (c, names) in groups.iter_mut().zip(names) {
        // All kinds of objects begin with the range's first name.
        assert!(names.iter().all(|&name| name == names[0]));
        assert_eq!(c.is_list(names[4] + 4), 1);
    }
    // The first group's objects, while the second is current.
    let [_, second] = &mut groups;
    second.delete_lists(names[0][4], 5);
    assert!(memory.write(4096, &names[0][0].to_ne_bytes()));
    second.delete_textures(1, 4096);
    assert_eq!(second.is_list(names[1][4]), 1);
}

/// A square of 4x4 texels, black, with linear filters off, over the window.
fn square(c: &mut Stage, size: i32) {
    c.texture(&[(size, vec![BLACK; (size * size) as usize])]);
}

#[test]
fn draws_that_wait_keep_the_texels_they_saw() {
    for size in [4, 256] {
        let mut c = Stage::new(8, 8);
        square(&mut c, size);
        let white = c.put(&[WHITE]);
        // The lower half shows the texture before, the upper half after the change.
        c.rectangle([-1.0, -1.0, 1.0, 0.0], 0.0);
        c.tex_sub_image_2d(gl::TEXTURE_2D, 0, 0, 0, 1, 1, gl::RGBA, gl::UNSIGNED_BYTE, white);
        c.begin(gl::QUADS);
        c.tex_coord_2f(0.0, 0.0);
        for [x, y] in [[-1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]] {
            c.vertex_2f(x, y);
        }
        c.end();
        let pixels = c.bytes();
        assert!(
            pixels[..32].iter().all(|&pixel| pixel == BLACK)
                && pixels[32..].iter().all(|&pixel| pixel == WHITE)
        );
        c.no_error();
    }
}

#[test]
fn little_drawn_leaves_the_rest_to_the_program() {
    let mut c = Stage::new(256, 256);
    c.finish();
    c.color_4f(1.0, 1.0, 1.0, 1.0);
    c.rectangle([-1.0, -1.0, -0.99, -0.99], 0.0);
    c.finish();
    let at = |x: usize, y: usize| BUFFER + 4 * (y * 256 + x);
    assert_eq!(c.take::<[u8; 4]>(at(0, 0), 1), [WHITE]);
    // The program writes, and nothing is drawn near it.
    c.raw_write(at(200, 200), &WHITE);
    c.rectangle([-1.0, -1.0, -0.9, -0.9], 0.0);
    c.finish();
    assert_eq!(c.take::<[u8; 4]>(at(200, 200), 1), [WHITE]);
    // What it wrote is there to be read and blended with.
    assert_eq!(c.pixel(200, 200), WHITE);
    // Having been read it is still the program's.
    c.raw_write(at(200, 200), &[1, 2, 3, 4]);
    c.rectangle([-1.0, -1.0, -0.9, -0.9], 0.0);
    c.finish();
    assert_eq!(c.take::<[u8; 4]>(at(200, 200), 1), [[1, 2, 3, 4]]);
    c.raw_write(at(100, 100), &[0, 0, 255, 255]);
    c.enable(gl::BLEND);
    c.blend_func(gl::ONE, gl::ONE);
    c.fill([1.0, 0.0, 0.0, 0.0], 0.0);
    c.finish();
    assert_eq!(c.take::<[u8; 4]>(at(100, 100), 1), [[255, 0, 255, 255]]);
    // Lines reach beyond their vertices.
    c.disable(gl::BLEND);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.finish();
    c.color_4f(1.0, 1.0, 1.0, 1.0);
    c.line_width(9.0);
    c.begin(gl::LINES);
    c.vertex_2f(-1.0, 126.0 / 128.0 - 1.0);
    c.vertex_2f(1.0, 126.0 / 128.0 - 1.0);
    c.end();
    c.finish();
    assert_eq!(c.take::<[u8; 4]>(at(9, 129), 1), [WHITE], "in the next row of tiles");
}

#[test]
fn arrays_that_are_too_short_read_as_zero() {
    let mut c = Stage::new(8, 8);
    c.color_4f(1.0, 1.0, 1.0, 1.0);
    let corners = c.put(&[-1.0f32, -1.0, 9.0, 1.0, -1.0, 9.0, 0.0, 1.0]);
    c.bind_buffer(gl::ARRAY_BUFFER, 1);
    c.buffer_data(gl::ARRAY_BUFFER, 32, corners, gl::STATIC_DRAW);
    // The last vertex lacks the padding of its stride.
    c.vertex_pointer(2, gl::FLOAT, 12, 0);
    c.enable_client_state(gl::VERTEX_ARRAY);
    c.draw_arrays(gl::TRIANGLES, 0, 3);
    assert_eq!(c.pixel(4, 2), WHITE);
    // Coordinates that nothing asks for.
    c.clear(gl::COLOR_BUFFER_BIT);
    c.bind_buffer(gl::ARRAY_BUFFER, 2);
    c.buffer_data(gl::ARRAY_BUFFER, 8, corners, gl::STATIC_DRAW);
    c.tex_coord_pointer(2, gl::FLOAT, 0, 0);
    c.enable_client_state(gl::TEXTURE_COORD_ARRAY);
    c.draw_arrays(gl::TRIANGLES, 0, 3);
    assert_eq!(c.pixel(4, 2), WHITE);
    // One index out of range is a vertex at the middle.
    c.clear(gl::COLOR_BUFFER_BIT);
    c.disable_client_state(gl::TEXTURE_COORD_ARRAY);
    let indices = c.put(&[0u32, 1, 1000]);
    c.draw_elements(gl::TRIANGLES, 3, gl::UNSIGNED_INT, indices);
    assert_eq!((c.pixel(4, 1), c.pixel(4, 6)), (WHITE, BLACK));
    c.no_error();
}

#[test]
fn colours_beyond_1_reach_buffers_of_floats() {
    let mut c = Stage::with_buffer(2, 2, gl::RGBA, gl::FLOAT);
    c.clear_color(7.0, -3.0, 0.5, 1.0);
    c.clear(gl::COLOR_BUFFER_BIT);
    assert_eq!(c.floats()[0], [7.0, -3.0, 0.5, 1.0]);
    assert_eq!(c.get::<4>(gl::COLOR_CLEAR_VALUE), [7.0, -3.0, 0.5, 1.0]);
    // Textures.
    let texel = c.put(&[5.0f32, 3.0, -2.0, 1.0]);
    c.tex_image_2d(gl::TEXTURE_2D, 0, gl::RGBA32F_ARB as i32, 1, 1, 0, gl::RGBA, gl::FLOAT, texel);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, gl::NEAREST as i32);
    c.enable(gl::TEXTURE_2D);
    c.fill([1.0; 4], 0.0);
    assert_eq!(c.floats()[0], [5.0, 3.0, -2.0, 1.0]);
    c.tex_envi(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, gl::REPLACE as i32);
    c.fill([1.0; 4], 0.0);
    assert_eq!(c.floats()[0], [5.0, 3.0, -2.0, 1.0]);
    c.clamp_color(gl::CLAMP_FRAGMENT_COLOR, gl::TRUE);
    c.fill([1.0; 4], 0.0);
    assert_eq!(c.floats()[0], [1.0, 1.0, 0.0, 1.0]);
    c.clamp_color(gl::CLAMP_FRAGMENT_COLOR, gl::FIXED_ONLY);
    // Vertices, once the program says so.
    c.disable(gl::TEXTURE_2D);
    c.fill([2.0, -1.0, 0.5, 1.0], 0.0);
    assert_eq!(c.floats()[0], [1.0, 0.0, 0.5, 1.0]);
    c.clamp_color(gl::CLAMP_VERTEX_COLOR, gl::FALSE);
    c.fill([2.0, -1.0, 0.5, 1.0], 0.0);
    assert_eq!(c.floats()[0], [2.0, -1.0, 0.5, 1.0]);
    // Reading.
    c.clamp_color(gl::CLAMP_READ_COLOR, gl::TRUE);
    assert_eq!(c.floats()[0], [1.0, 0.0, 0.5, 1.0]);
    assert_eq!(c.get::<1>(gl::RGBA_FLOAT_MODE_ARB), [1.0]);
    c.no_error();
    c.clamp_color(gl::CLAMP_READ_COLOR, gl::LINEAR);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
}

#[test]
fn the_combiner_multiplies_and_adds() {
    let mut c = Stage::new(2, 2);
    c.texture(&[(1, vec![[102, 102, 102, 255]])]);
    c.tex_envi(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, gl::COMBINE as i32);
    for (name, source) in [
        (gl::SOURCE0_RGB, gl::TEXTURE),
        (gl::SOURCE1_RGB, gl::CONSTANT),
        (gl::SOURCE2_RGB, gl::PRIMARY_COLOR),
    ] {
        c.tex_envi(gl::TEXTURE_ENV, name, source as i32);
    }
    c.tex_envi(gl::TEXTURE_ENV, gl::OPERAND2_RGB, gl::SRC_COLOR as i32);
    let constant = c.put(&[0.1f32, 0.6, 0.0, 1.0]);
    c.tex_envfv(gl::TEXTURE_ENV, gl::TEXTURE_ENV_COLOR, constant);
    for (function, expected) in [
        (gl::MODULATE_ADD_ATI, [0.3, 0.8, 0.2]),
        (gl::MODULATE_SIGNED_ADD_ATI, [0.0, 0.3, 0.0]),
        (gl::MODULATE_SUBTRACT_ATI, [0.1, 0.0, 0.2]),
    ] {
        c.tex_envi(gl::TEXTURE_ENV, gl::COMBINE_RGB, function as i32);
        c.fill([0.5; 4], 0.0);
        assert_color(c.pixel(0, 0), [expected[0], expected[1], expected[2], 0.5]);
    }
    c.tex_envi(gl::TEXTURE_ENV, gl::SOURCE2_RGB, gl::ONE as i32);
    c.tex_envi(gl::TEXTURE_ENV, gl::SOURCE1_RGB, gl::ZERO as i32);
    c.tex_envi(gl::TEXTURE_ENV, gl::COMBINE_RGB, gl::MODULATE_ADD_ATI as i32);
    c.fill([0.5; 4], 0.0);
    assert_color(c.pixel(0, 0), [0.4, 0.4, 0.4, 0.5]);
    c.no_error();
}

#[test]
fn textures_are_mirrored_once() {
    let mut c = Stage::new(8, 1);
    let texels = c.put(&[[255u8, 0, 0, 255], [0, 255, 0, 255]]);
    c.tex_image_2d(
        gl::TEXTURE_2D,
        0,
        gl::RGBA as i32,
        2,
        1,
        0,
        gl::RGBA,
        gl::UNSIGNED_BYTE,
        texels,
    );
    c.tex_envi(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, gl::REPLACE as i32);
    let border = c.put(&[0.0f32, 0.0, 1.0, 1.0]);
    c.tex_parameterfv(gl::TEXTURE_2D, gl::TEXTURE_BORDER_COLOR, border);
    c.enable(gl::TEXTURE_2D);
    let (r, g, b) = ([255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]);
    for (filter, wrap, expected) in [
        (gl::NEAREST, gl::MIRROR_CLAMP_TO_EDGE_EXT, [g, g, g, r, r, g, g, g]),
        (gl::NEAREST, gl::MIRROR_CLAMP_TO_BORDER_EXT, [b, b, g, r, r, g, b, b]),
        (gl::NEAREST, gl::MIRROR_CLAMP_EXT, [g, g, g, r, r, g, g, g]),
        (gl::LINEAR, gl::MIRROR_CLAMP_TO_EDGE_EXT, [g, g, g, r, r, g, g, g]),
    ] {
        for name in [gl::TEXTURE_MIN_FILTER, gl::TEXTURE_MAG_FILTER] {
            c.tex_parameteri(gl::TEXTURE_2D, name, filter as i32);
        }
        c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_WRAP_S, wrap as i32);
        // Texels' centres: s from -2 to 2, half a unit a pixel.
        c.begin(gl::QUADS);
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            c.tex_coord_2f(2.0 * x, 0.5);
            c.vertex_2f(x, y);
        }
        c.end();
        assert_eq!(c.bytes(), expected, "{wrap:#x}");
    }
    c.no_error();
}

#[test]
fn primitives_begin_anew() {
    let mut c = Stage::new(8, 8);
    c.color_4f(1.0, 1.0, 1.0, 1.0);
    let corners = c.put(&[
        [-1.0f32, -1.0],
        [-0.5, -1.0],
        [-1.0, 1.0],
        [-0.5, 1.0],
        [0.5, -1.0],
        [1.0, -1.0],
        [0.5, 1.0],
        [1.0, 1.0],
    ]);
    c.vertex_pointer(2, gl::FLOAT, 0, corners);
    c.enable_client_state(gl::VERTEX_ARRAY);
    let indices = c.put(&[0u16, 1, 2, 3, 0xffff, 4, 5, 6, 7]);
    c.enable_client_state(gl::PRIMITIVE_RESTART_NV);
    c.primitive_restart_index_nv(0xffff);
    c.draw_elements(gl::TRIANGLE_STRIP, 9, gl::UNSIGNED_SHORT, indices);
    let expected = [WHITE, WHITE, BLACK, BLACK, BLACK, BLACK, WHITE, WHITE];
    assert_eq!(c.bytes()[24..32], expected);
    assert_eq!(c.get::<1>(gl::PRIMITIVE_RESTART_INDEX_NV), [65535.0]);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.begin(gl::TRIANGLE_STRIP);
    for i in 0..8 {
        if i == 4 {
            c.primitive_restart_nv();
        }
        c.array_element(i);
    }
    c.end();
    assert_eq!(c.bytes()[24..32], expected);
    c.no_error();
}

#[test]
fn rows_are_read_from_above_and_raster_positions_may_be_outside() {
    let mut c = Stage::new(2, 2);
    c.clear_color(1.0, 0.0, 0.0, 1.0);
    c.enable(gl::SCISSOR_TEST);
    c.scissor(0, 0, 2, 1);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.disable(gl::SCISSOR_TEST);
    c.pixel_storei(gl::PACK_INVERT_MESA, 1);
    assert_eq!(c.bytes(), [BLACK, BLACK, [255, 0, 0, 255], [255, 0, 0, 255]]);
    c.pixel_storei(gl::PACK_INVERT_MESA, 0);

    // An image that begins to the left of the window.
    let texels = c.put(&[BLACK, WHITE]);
    c.raster_pos_2f(-2.0, -1.0);
    c.draw_pixels(2, 1, gl::RGBA, gl::UNSIGNED_BYTE, texels);
    assert_eq!(c.pixel(0, 0), [255, 0, 0, 255]);
    c.enable(gl::RASTER_POSITION_UNCLIPPED_IBM);
    c.raster_pos_2f(-2.0, -1.0);
    c.draw_pixels(2, 1, gl::RGBA, gl::UNSIGNED_BYTE, texels);
    assert_eq!((c.pixel(0, 0), c.pixel(1, 0)), (WHITE, [255, 0, 0, 255]));
    c.no_error();
}

#[test]
fn there_is_one_draw_buffer() {
    let mut c = Stage::new(2, 2);
    let tokens = c.put(&[gl::BACK_LEFT, gl::NONE]);
    c.draw_buffers(1, tokens);
    assert_eq!(
        (c.get::<1>(gl::MAX_DRAW_BUFFERS), c.get::<1>(gl::DRAW_BUFFER0)),
        ([1.0], [gl::BACK_LEFT as f32])
    );
    c.draw_buffers(1, tokens + 4);
    c.fill([1.0; 4], 0.0);
    assert_eq!(c.pixel(0, 0), BLACK);
    c.no_error();
    c.draw_buffers(2, tokens);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
}
