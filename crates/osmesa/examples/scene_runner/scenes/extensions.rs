//! Extensions beyond OpenGL 1.5: swizzles, red textures, sampler objects, immutable textures,
//! arrays.

use super::*;
use crate::gl::at;
use texture_images::plain;

pub(crate) const SCENES: &[Scene] = &[
    scene("swizzle", Rounded, swizzle),
    scene("red-textures", Rounded, red_textures),
    scene("red-framebuffers", Rounded, red_framebuffers),
    scene("sampler-object", Close, sampler_object),
    scene("immutable-texture", Close, immutable),
    scene("base-vertex", Close, base_vertex),
    scene("arrays-of-halves-and-bgra", Close, halves_and_bgra),
    scene("copied-buffer", Exact, copied_buffer),
];

/// The environments, one beside the other in a row from `y` on, over half of a colour.
fn environments(gl: &Gl, y: f32) {
    for (i, mode) in [REPLACE, MODULATE, ADD, BLEND].into_iter().enumerate() {
        gl.glTexEnvi(TEXTURE_ENV, TEXTURE_ENV_MODE, mode as i32);
        gl.glColor4f(0.5, 0.25, 0.75, 0.5);
        let x = 16.0 * i as f32;
        textured(gl, [x, y, x + 16.0, y + 16.0], 1.0);
    }
}

fn swizzle(gl: &mut Stage<'_>) {
    pixels(gl);
    plain(gl, 8, &checks(8, 2));
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MAG_FILTER, NEAREST as i32);
    gl.glEnable(TEXTURE_2D);
    let rows = [
        [RED, GREEN, BLUE, ALPHA],
        [BLUE, RED, GREEN, ONE],
        [ALPHA, ZERO, RED, BLUE],
        [GREEN, ONE, ZERO, ZERO],
    ];
    for (j, row) in rows.into_iter().enumerate() {
        for (name, from) in (TEXTURE_SWIZZLE_R..).zip(row) {
            gl.glTexParameteri(TEXTURE_2D, name, from as i32);
        }
        environments(gl, 16.0 * j as f32);
    }
}

fn red_textures(gl: &mut Stage<'_>) {
    pixels(gl);
    let texels = checks(8, 2);
    gl.glEnable(TEXTURE_2D);
    for filter in [TEXTURE_MIN_FILTER, TEXTURE_MAG_FILTER] {
        gl.glTexParameteri(TEXTURE_2D, filter, NEAREST as i32);
    }
    for (j, internal) in [R8, RG8, R16, RG32F].into_iter().enumerate() {
        gl.glTexImage2D(TEXTURE_2D, 0, internal as i32, 8, 8, 0, RGBA, UNSIGNED_BYTE, at(&texels));
        environments(gl, 16.0 * j as f32);
    }
}

fn red_framebuffers(gl: &mut Stage<'_>) {
    let mut names = [0; 2];
    gl.glGenTextures(1, &mut names);
    gl.glGenFramebuffers(1, &mut names[1..]);
    gl.glBindTexture(TEXTURE_2D, names[0]);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, NEAREST as i32);
    gl.glTexImage2D(TEXTURE_2D, 0, RG8 as i32, 64, 64, 0, RGBA, UNSIGNED_BYTE, 0);
    gl.glBindFramebuffer(FRAMEBUFFER, names[1]);
    gl.glFramebufferTexture2D(FRAMEBUFFER, COLOR_ATTACHMENT0, TEXTURE_2D, names[0], 0);
    gl.glClearColor(0.75, 0.5, 0.25, 0.125);
    gl.glClear(COLOR_BUFFER_BIT);
    pixels(gl);
    gl.glEnable(BLEND);
    gl.glBlendFunc(ONE_MINUS_DST_COLOR, DST_ALPHA);
    gl.glColor4f(0.5, 0.5, 0.5, 0.5);
    gl.glRectf(10.0, 10.0, 40.0, 50.0);
    let mut found = [0.0_f32; 8];
    gl.glReadPixels(5, 20, 1, 1, RGBA, FLOAT, crate::gl::at_mut(&mut found[..4]));
    gl.glReadPixels(20, 20, 1, 1, RGBA, FLOAT, crate::gl::at_mut(&mut found[4..]));
    gl.notes(&found);
    gl.glDisable(BLEND);
    gl.glBindFramebuffer(FRAMEBUFFER, 0);
    gl.glEnable(TEXTURE_2D);
    gl.glTexEnvi(TEXTURE_ENV, TEXTURE_ENV_MODE, REPLACE as i32);
    textured(gl, [0.0, 0.0, 64.0, 64.0], 1.0);
}

fn sampler_object(gl: &mut Stage<'_>) {
    pixels(gl);
    // Without mipmaps and with its own filters the texture would be incomplete.
    plain(gl, 8, &checks(8, 2));
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, NEAREST_MIPMAP_NEAREST as i32);
    gl.glEnable(TEXTURE_2D);
    textured(gl, [0.0, 0.0, 20.0, 20.0], 1.0);
    let mut sampler = [0];
    gl.glGenSamplers(1, &mut sampler);
    gl.glSamplerParameteri(sampler[0], TEXTURE_MIN_FILTER, NEAREST as i32);
    gl.glSamplerParameteri(sampler[0], TEXTURE_MAG_FILTER, NEAREST as i32);
    gl.glSamplerParameteri(sampler[0], TEXTURE_WRAP_S, MIRRORED_REPEAT as i32);
    gl.glBindSampler(0, sampler[0]);
    // Libraries choose names as they like.
    let mut bound = [0];
    gl.glGetIntegerv(SAMPLER_BINDING, &mut bound);
    gl.note(u8::from(bound[0] == sampler[0].cast_signed()));
    textured(gl, [22.0, 0.0, 62.0, 40.0], 2.0);
    gl.glDeleteSamplers(1, &sampler);
    textured(gl, [0.0, 42.0, 20.0, 62.0], 1.0);
    gl.note_floats::<1>(SAMPLER_BINDING);
}

fn immutable(gl: &mut Stage<'_>) {
    pixels(gl);
    let mut name = [0];
    gl.glGenTextures(1, &mut name);
    gl.glBindTexture(TEXTURE_2D, name[0]);
    gl.glTexStorage2D(TEXTURE_2D, 2, RGBA8, 16, 16);
    gl.glTexSubImage2D(TEXTURE_2D, 0, 0, 0, 16, 16, RGBA, UNSIGNED_BYTE, at(&checks(16, 4)));
    gl.glTexSubImage2D(
        TEXTURE_2D,
        1,
        0,
        0,
        8,
        8,
        RGBA,
        UNSIGNED_BYTE,
        at(&[[255_u8, 200, 0, 255]; 64]),
    );
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, NEAREST_MIPMAP_NEAREST as i32);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MAG_FILTER, NEAREST as i32);
    gl.glEnable(TEXTURE_2D);
    gl.note(gl.glGetError());
    textured(gl, [0.0, 0.0, 32.0, 32.0], 1.0);
    textured(gl, [34.0, 0.0, 40.0, 6.0], 1.0);
    textured(gl, [34.0, 20.0, 37.0, 23.0], 1.0);
    for levels in [1, 0] {
        gl.glTexStorage2D(TEXTURE_2D, levels, RGBA8, 16, 16);
        gl.note(gl.glGetError());
    }
    gl.glTexImage2D(TEXTURE_2D, 0, RGBA8 as i32, 16, 16, 0, RGBA, UNSIGNED_BYTE, 0);
    gl.note(gl.glGetError());
}

fn base_vertex(gl: &mut Stage<'_>) {
    pixels(gl);
    let corners: Vec<[f32; 2]> = (0..4).flat_map(|i| square(16.0 * i as f32)).collect();
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glVertexPointer(2, FLOAT, 0, at(&corners));
    let indices = [4_u16, 5, 6, 7];
    for (base, green) in [(-4, 0.2), (0, 0.5), (8, 1.0)] {
        gl.glColor3f(1.0, green, 0.5);
        gl.glDrawElementsBaseVertex(QUADS, 4, UNSIGNED_SHORT, at(&indices), base);
    }
    gl.note(gl.glGetError());
}

/// A square on the diagonal.
fn square(at: f32) -> [[f32; 2]; 4] {
    [[at, at], [at + 14.0, at], [at + 14.0, at + 14.0], [at, at + 14.0]]
}

fn halves_and_bgra(gl: &mut Stage<'_>) {
    pixels(gl);
    // 4, 60, 32 and 56.
    let corners = [[0x4400_u16, 0x4400], [0x5380, 0x4400], [0x5000, 0x5300]];
    let colors = [[255_u8, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]];
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glEnableClientState(COLOR_ARRAY);
    gl.glVertexPointer(2, HALF_FLOAT_ARB, 0, at(&corners));
    gl.glColorPointer(BGRA as i32, UNSIGNED_BYTE, 0, at(&colors));
    gl.glDrawArrays(TRIANGLES, 0, 3);
    gl.note(gl.glGetError());
    gl.note_floats::<1>(COLOR_ARRAY_SIZE);
    gl.glColorPointer(BGRA as i32, FLOAT, 0, 0);
    gl.note(gl.glGetError());
}

fn copied_buffer(gl: &mut Stage<'_>) {
    for (target, name) in [(COPY_READ_BUFFER, 1), (COPY_WRITE_BUFFER, 2)] {
        gl.glBindBuffer(target, name);
        gl.glBufferData(target, 8, at(&[1_u8, 2, 3, 4, 5, 6, 7, 8]), STATIC_DRAW);
        gl.note_floats::<1>(target);
    }
    let copies = [(1, 5, 3), (0, 0, 8), (4, 6, 4), (0, 0, -1)];
    for (from, to, size) in copies {
        gl.glCopyBufferSubData(COPY_READ_BUFFER, COPY_WRITE_BUFFER, from, to, size);
        gl.note(gl.glGetError());
    }
    gl.glCopyBufferSubData(COPY_WRITE_BUFFER, COPY_WRITE_BUFFER, 0, 2, 4);
    gl.note(gl.glGetError());
    gl.glCopyBufferSubData(COPY_WRITE_BUFFER, COPY_WRITE_BUFFER, 0, 5, 3);
    let mut found = [0_u8; 8];
    gl.glGetBufferSubData(COPY_WRITE_BUFFER, 0, 8, crate::gl::at_mut(&mut found));
    gl.notes(&found.map(f32::from));
}
