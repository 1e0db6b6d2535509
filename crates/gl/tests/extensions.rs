//! Extensions beyond OpenGL 1.5, each against values worked out by hand.

use crate::common::{BUFFER, Stage};
use vitral_gl::enums as gl;

/// What a texture of one texel gives where it replaces a fragment's colour of (64, 64, 64, 64),
/// read from bytes.
fn replaced(c: &mut Stage) -> [u8; 4] {
    let part = 64.0 / 255.0;
    c.fill([part; 4], 0.0);
    let found = c.pixel(1, 1);
    c.no_error();
    found
}

#[test]
fn swizzled_components_come_from_others() {
    let mut c = Stage::new(4, 4);
    c.texture(&[(1, vec![[10, 20, 30, 40]])]);
    assert_eq!(replaced(&mut c), [10, 20, 30, 40]);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_SWIZZLE_R, gl::ALPHA as i32);
    assert_eq!(replaced(&mut c), [40, 20, 30, 40]);
    let all = c.put(&[gl::BLUE as i32, gl::ZERO as i32, gl::ONE as i32, gl::GREEN as i32]);
    c.tex_parameteriv(gl::TEXTURE_2D, gl::TEXTURE_SWIZZLE_RGBA, all);
    assert_eq!(replaced(&mut c), [30, 0, 255, 20]);
    // The border's colour is swizzled too.
    let border = c.put(&[0.2f32, 0.4, 0.6, 0.8]);
    c.tex_parameterfv(gl::TEXTURE_2D, gl::TEXTURE_BORDER_COLOR, border);
    for axis in [gl::TEXTURE_WRAP_S, gl::TEXTURE_WRAP_T] {
        c.tex_parameteri(gl::TEXTURE_2D, axis, gl::CLAMP_TO_BORDER as i32);
    }
    c.begin(gl::QUADS);
    for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
        c.tex_coord_2f(5.0, 5.0);
        c.vertex_2f(x, y);
    }
    c.end();
    assert_eq!(c.pixel(1, 1), [153, 0, 255, 102]);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_SWIZZLE_G, gl::LUMINANCE as i32);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_SWIZZLE_RGBA, gl::RED as i32);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
}

#[test]
fn textures_of_red_and_of_red_and_green() {
    let mut c = Stage::new(4, 4);
    c.texture(&[(1, vec![[0; 4]])]);
    let texel = c.put(&[10u8, 20, 30, 40]);
    // What they lack is 0, and alpha stays the fragment's.
    for (internal, expected) in
        [(gl::R8, [10, 0, 0, 64]), (gl::RG16, [10, 20, 0, 64]), (gl::RG32F, [10, 20, 0, 64])]
    {
        c.tex_image_2d(
            gl::TEXTURE_2D,
            0,
            internal as i32,
            1,
            1,
            0,
            gl::RGBA,
            gl::UNSIGNED_BYTE,
            texel,
        );
        assert_eq!(replaced(&mut c), expected, "{internal:#x}");
    }
    // A format of two components in memory.
    c.tex_image_2d(gl::TEXTURE_2D, 0, gl::RGBA8 as i32, 1, 1, 0, gl::RG, gl::UNSIGNED_BYTE, texel);
    assert_eq!(replaced(&mut c), [10, 20, 0, 255]);
    c.get_tex_image(gl::TEXTURE_2D, 0, gl::RG, gl::UNSIGNED_BYTE, BUFFER + 4096);
    assert_eq!(c.take::<u8>(BUFFER + 4096, 2), [10, 20]);
    // Depths in red alone.
    c.tex_parameteri(gl::TEXTURE_2D, gl::DEPTH_TEXTURE_MODE, gl::RED as i32);
    let depth = c.put(&[0.2f32]);
    let internal = gl::DEPTH_COMPONENT24 as i32;
    c.tex_image_2d(gl::TEXTURE_2D, 0, internal, 1, 1, 0, gl::DEPTH_COMPONENT, gl::FLOAT, depth);
    assert_eq!(replaced(&mut c), [51, 0, 0, 64]);
}

#[test]
fn a_framebuffer_of_red_keeps_red_alone() {
    let mut c = Stage::new(4, 4);
    let names = c.put(&[0u32; 2]);
    c.gen_renderbuffers(1, names);
    c.gen_framebuffers(1, names + 4);
    let [buffer, object] = c.take::<u32>(names, 2)[..] else { panic!() };
    c.bind_renderbuffer(gl::RENDERBUFFER, buffer);
    c.renderbuffer_storage(gl::RENDERBUFFER, gl::R8, 4, 4);
    c.bind_framebuffer(gl::FRAMEBUFFER, object);
    c.framebuffer_renderbuffer(gl::FRAMEBUFFER, gl::COLOR_ATTACHMENT0, gl::RENDERBUFFER, buffer);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
    c.clear_color(0.2, 0.4, 0.6, 0.8);
    c.clear(gl::COLOR_BUFFER_BIT);
    assert_eq!(c.pixel(0, 0), [51, 0, 0, 255]);
    // Its alpha counts as 1 in blending.
    c.enable(gl::BLEND);
    c.blend_func(gl::DST_ALPHA, gl::ZERO);
    c.fill([0.4, 1.0, 1.0, 0.0], 0.0);
    assert_eq!(c.pixel(0, 0), [102, 0, 0, 255]);
    c.no_error();
}

#[test]
fn buffers_copy_from_one_another() {
    let mut c = Stage::new(4, 4);
    let bytes = c.put(&[0u8, 1, 2, 3, 4, 5, 6, 7]);
    let (read, write) = (gl::COPY_READ_BUFFER, gl::COPY_WRITE_BUFFER);
    for (target, name) in [(read, 1), (write, 2)] {
        c.bind_buffer(target, name);
        c.buffer_data(target, 8, bytes, gl::STATIC_DRAW);
    }
    assert_eq!((c.get::<1>(read), c.get::<1>(write)), ([1.0], [2.0]));
    let found = |c: &mut Stage| {
        c.get_buffer_sub_data(write, 0, 8, BUFFER + 4096);
        c.take::<u8>(BUFFER + 4096, 8)
    };
    c.copy_buffer_sub_data(read, write, 5, 0, 3);
    assert_eq!(found(&mut c), [5, 6, 7, 3, 4, 5, 6, 7]);
    // Within one buffer the ranges may touch, not overlap.
    c.copy_buffer_sub_data(write, write, 0, 4, 4);
    assert_eq!(found(&mut c), [5, 6, 7, 3, 5, 6, 7, 3]);
    c.no_error();
    c.copy_buffer_sub_data(write, write, 0, 3, 4);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
    c.copy_buffer_sub_data(read, write, 6, 0, 3);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
    c.copy_buffer_sub_data(read, write, -1, 0, 3);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
    c.map_buffer(read, gl::READ_ONLY);
    c.copy_buffer_sub_data(read, write, 0, 0, 3);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    c.bind_buffer(write, 0);
    c.copy_buffer_sub_data(write, gl::ARRAY_BUFFER, 0, 0, 1);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
}

#[test]
fn indices_count_from_a_base() {
    let mut c = Stage::new(8, 1);
    c.pixels();
    let corners: Vec<[f32; 2]> = (0..8).map(|x| [x as f32 + 0.5, 0.5]).collect();
    let at = c.put(&corners);
    c.vertex_pointer(2, gl::FLOAT, 0, at);
    c.enable_client_state(gl::VERTEX_ARRAY);
    let indices = c.put(&[2u8, 3, 5]);
    let drawn = |c: &mut Stage| -> Vec<usize> {
        let row = c.bytes();
        c.clear(gl::COLOR_BUFFER_BIT);
        (0..8).filter(|x| row[*x][0] == 255).collect()
    };
    c.clear(gl::COLOR_BUFFER_BIT);
    c.draw_elements_base_vertex(gl::POINTS, 3, gl::UNSIGNED_BYTE, indices, 2);
    assert_eq!(drawn(&mut c), [4, 5, 7]);
    c.draw_range_elements_base_vertex(gl::POINTS, 0, 5, 3, gl::UNSIGNED_BYTE, indices, -2);
    assert_eq!(drawn(&mut c), [0, 1, 3]);
    let counts = c.put(&[1i32, 2]);
    let pointers = c.put(&[indices, indices + 1]);
    let bases = c.put(&[-1i32, 1]);
    c.multi_draw_elements_base_vertex(gl::POINTS, counts, gl::UNSIGNED_BYTE, pointers, 2, bases);
    assert_eq!(drawn(&mut c), [1, 4, 6]);
    c.no_error();
    c.draw_elements_base_vertex(gl::POINTS, 3, gl::FLOAT, indices, 2);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
}

#[test]
fn an_incomplete_framebuffer_refuses_what_draws_nothing_too() {
    let mut c = Stage::new(4, 4);
    let names = c.put(&[0u32]);
    let feedback = c.put(&[0.0f32; 64]);
    c.feedback_buffer(64, gl::_2D, feedback);
    c.gen_framebuffers(1, names);
    let name = c.take(names, 1)[0];
    c.new_list(1, gl::COMPILE);
    c.rectangle([-1.0, -1.0, 1.0, 1.0], 0.0);
    c.draw_arrays(gl::POINTS, 0, 0);
    c.end_list();
    let calls: [fn(&mut Stage); 6] = [
        |c| {
            c.begin(gl::QUADS);
            c.end();
        },
        |c| c.rectangle([-1.0, -1.0, 1.0, 1.0], 0.0),
        |c| c.rectf(-1.0, -1.0, 1.0, 1.0),
        |c| c.call_list(1),
        |c| c.draw_arrays(gl::POINTS, 0, 0),
        |c| c.raster_pos_2f(0.5, 0.5),
    ];
    for mode in [gl::RENDER, gl::FEEDBACK] {
        c.render_mode(mode);
        for (i, call) in calls.into_iter().enumerate() {
            c.bind_framebuffer(gl::FRAMEBUFFER, name);
            call(&mut c);
            assert_eq!(c.get_error(), gl::INVALID_FRAMEBUFFER_OPERATION, "call {i}");
            c.no_error();
            assert_eq!(c.get::<4>(gl::CURRENT_RASTER_POSITION)[0], 0.0);
        }
    }
    assert_eq!(c.render_mode(gl::RENDER), 0);
    c.bind_framebuffer(gl::FRAMEBUFFER, 0);
    assert!(c.bytes().iter().all(|pixel| *pixel == [0; 4]));
    calls.into_iter().for_each(|call| call(&mut c));
    c.no_error();
    assert_eq!(c.pixel(1, 1), [255; 4]);
}
