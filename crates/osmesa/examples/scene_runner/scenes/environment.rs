//! Texture environments.

use super::*;
use crate::gl::at;

pub(crate) const SCENES: &[Scene] = &[
    scene("env-modes", Close, modes),
    scene("env-combine-functions", Close, functions),
    scene("env-combine-sources", Close, sources),
    scene("env-combine-scale", Close, scale),
    scene("env-dot3", Close, dot3),
    scene("env-crossbar", Close, crossbar),
    scene("env-two-units", Close, two_units),
    scene("env-get", Exact, get),
];

/// A square in field (i, j) of a grid of 6 columns and 7 rows.
fn field(gl: &Gl, i: usize, j: usize) {
    let (x, y) = (1.0 + 10.0 * i as f32, 1.0 + 9.0 * j as f32);
    textured(gl, [x, y, x + 8.0, y + 8.0], 1.0);
}

fn ready(gl: &Gl) {
    pixels(gl);
    gl.glEnable(TEXTURE_2D);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, NEAREST as i32);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MAG_FILTER, NEAREST as i32);
    gl.glTexEnvfv(TEXTURE_ENV, TEXTURE_ENV_COLOR, &[0.9, 0.1, 0.4, 0.6]);
    gl.glColor4f(0.3, 0.6, 0.8, 0.7);
}

/// Every mode with every base format; columns are formats. Alpha is shown in a second half of each
/// field's colours by blending.
fn modes(gl: &mut Stage<'_>) {
    ready(gl);
    let texels = checks(8, 2);
    gl.glEnable(BLEND);
    gl.glBlendFunc(SRC_ALPHA, ZERO);
    for (i, format) in
        [ALPHA, LUMINANCE, LUMINANCE_ALPHA, INTENSITY, RGB, RGBA].into_iter().enumerate()
    {
        gl.glTexImage2D(TEXTURE_2D, 0, format as i32, 8, 8, 0, RGBA, UNSIGNED_BYTE, at(&texels));
        for (j, mode) in [REPLACE, MODULATE, BLEND, ADD, DECAL].into_iter().enumerate() {
            // Decal is defined for RGB and RGBA only.
            if mode != DECAL || i >= 4 {
                gl.glTexEnvi(TEXTURE_ENV, TEXTURE_ENV_MODE, mode as i32);
                field(gl, i, j);
            }
        }
    }
}

fn set(gl: &Gl, name: u32, value: u32) {
    gl.glTexEnvi(TEXTURE_ENV, name, value as i32);
}

fn combining(gl: &Gl) {
    ready(gl);
    gl.glTexImage2D(TEXTURE_2D, 0, RGBA as i32, 8, 8, 0, RGBA, UNSIGNED_BYTE, at(&checks(8, 2)));
    set(gl, TEXTURE_ENV_MODE, COMBINE);
}

fn functions(gl: &mut Stage<'_>) {
    combining(gl);
    gl.glEnable(BLEND);
    gl.glBlendFunc(SRC_ALPHA, ZERO);
    for (i, rgb) in
        [REPLACE, MODULATE, ADD, ADD_SIGNED, INTERPOLATE, SUBTRACT].into_iter().enumerate()
    {
        set(gl, COMBINE_RGB, rgb);
        for (j, alpha) in
            [REPLACE, MODULATE, ADD, ADD_SIGNED, INTERPOLATE, SUBTRACT].into_iter().enumerate()
        {
            set(gl, COMBINE_ALPHA, alpha);
            field(gl, i, j);
        }
    }
}

fn sources(gl: &mut Stage<'_>) {
    combining(gl);
    set(gl, COMBINE_RGB, MODULATE);
    for (i, source) in [TEXTURE, CONSTANT, PRIMARY_COLOR, PREVIOUS].into_iter().enumerate() {
        set(gl, SOURCE0_RGB, source);
        for (j, operand) in
            [SRC_COLOR, ONE_MINUS_SRC_COLOR, SRC_ALPHA, ONE_MINUS_SRC_ALPHA].into_iter().enumerate()
        {
            set(gl, OPERAND1_RGB, operand);
            field(gl, i, j);
        }
    }
    set(gl, COMBINE_ALPHA, MODULATE);
    set(gl, OPERAND0_ALPHA, ONE_MINUS_SRC_ALPHA);
    gl.glEnable(BLEND);
    gl.glBlendFunc(SRC_ALPHA, ZERO);
    for (i, source) in [TEXTURE, CONSTANT, PRIMARY_COLOR, PREVIOUS].into_iter().enumerate() {
        set(gl, SOURCE0_ALPHA, source);
        field(gl, i, 5);
    }
}

fn scale(gl: &mut Stage<'_>) {
    combining(gl);
    gl.glEnable(BLEND);
    gl.glBlendFunc(SRC_ALPHA, ZERO);
    for (i, rgb) in [1.0, 2.0, 4.0].into_iter().enumerate() {
        gl.glTexEnvf(TEXTURE_ENV, RGB_SCALE, rgb);
        for (j, alpha) in [1.0, 2.0, 4.0].into_iter().enumerate() {
            gl.glTexEnvf(TEXTURE_ENV, ALPHA_SCALE, alpha);
            field(gl, i, j);
            set(gl, COMBINE_RGB, ADD_SIGNED);
            field(gl, i + 3, j);
            set(gl, COMBINE_RGB, MODULATE);
        }
    }
}

fn dot3(gl: &mut Stage<'_>) {
    combining(gl);
    let normals: Vec<[u8; 4]> =
        (0..64).map(|i| [(i % 8 * 36) as u8, (i / 8 * 36) as u8, 220, (i * 4) as u8]).collect();
    gl.glTexImage2D(TEXTURE_2D, 0, RGBA as i32, 8, 8, 0, RGBA, UNSIGNED_BYTE, at(&normals));
    set(gl, SOURCE1_RGB, PRIMARY_COLOR);
    gl.glColor4f(0.8, 0.7, 0.9, 1.0);
    set(gl, COMBINE_RGB, DOT3_RGB);
    textured(gl, [1.0, 1.0, 31.0, 63.0], 1.0);
    set(gl, COMBINE_RGB, DOT3_RGBA);
    gl.glEnable(BLEND);
    gl.glBlendFunc(SRC_ALPHA, ZERO);
    textured(gl, [33.0, 1.0, 63.0, 31.0], 1.0);
    gl.glTexEnvf(TEXTURE_ENV, RGB_SCALE, 2.0);
    textured(gl, [31.0, 33.0, 47.0, 63.0], 1.0);
    gl.glTexEnvf(TEXTURE_ENV, ALPHA_SCALE, 4.0);
    textured(gl, [47.0, 33.0, 63.0, 63.0], 1.0);
}

/// Unit 0 passes the primary colour on, unit 1 reads the texture of unit 0 beside its own.
fn crossbar(gl: &mut Stage<'_>) {
    combining(gl);
    set(gl, COMBINE_RGB, REPLACE);
    set(gl, SOURCE0_RGB, PRIMARY_COLOR);
    gl.glActiveTexture(TEXTURE1);
    let mut name = [0];
    gl.glGenTextures(1, &mut name);
    gl.glBindTexture(TEXTURE_2D, name[0]);
    texture_images::plain(gl, 4, &checks(4, 1));
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MAG_FILTER, NEAREST as i32);
    gl.glEnable(TEXTURE_2D);
    set(gl, TEXTURE_ENV_MODE, COMBINE);
    set(gl, COMBINE_RGB, INTERPOLATE);
    set(gl, SOURCE0_RGB, TEXTURE0);
    set(gl, SOURCE1_RGB, PREVIOUS);
    set(gl, SOURCE2_RGB, TEXTURE1);
    set(gl, OPERAND2_RGB, SRC_COLOR);
    gl.glBegin(QUADS);
    for (x, y) in [(2.0, 2.0), (62.0, 2.0), (62.0, 62.0), (2.0, 62.0)] {
        gl.glMultiTexCoord2f(TEXTURE0, x / 64.0, y / 64.0);
        gl.glMultiTexCoord2f(TEXTURE1, y / 64.0, x / 64.0);
        gl.glVertex2f(x, y);
    }
    gl.glEnd();
}

fn two_units(gl: &mut Stage<'_>) {
    ready(gl);
    texture_images::plain(gl, 8, &checks(8, 2));
    gl.glActiveTexture(TEXTURE1);
    let mut name = [0];
    gl.glGenTextures(1, &mut name);
    gl.glBindTexture(TEXTURE_2D, name[0]);
    texture_images::plain(gl, 8, &checks(8, 4));
    gl.glEnable(TEXTURE_2D);
    for (i, first) in [REPLACE, MODULATE, DECAL, BLEND, ADD].into_iter().enumerate() {
        gl.glActiveTexture(TEXTURE0);
        set(gl, TEXTURE_ENV_MODE, first);
        for (j, second) in [REPLACE, MODULATE, DECAL, BLEND, ADD].into_iter().enumerate() {
            gl.glActiveTexture(TEXTURE1);
            set(gl, TEXTURE_ENV_MODE, second);
            gl.glMultiTexCoord2f(TEXTURE1, 0.3, 0.3 + 0.1 * i as f32);
            field(gl, i, j);
        }
    }
}

fn get(gl: &mut Stage<'_>) {
    set(gl, COMBINE_RGB, SUBTRACT);
    set(gl, SOURCE1_ALPHA, PRIMARY_COLOR);
    gl.glTexEnvfv(TEXTURE_ENV, TEXTURE_ENV_COLOR, &[2.0, -1.0, 0.5, 0.25]);
    let mut color = [0.0; 4];
    gl.glGetTexEnvfv(TEXTURE_ENV, TEXTURE_ENV_COLOR, &mut color);
    gl.notes(&color);
    for name in [
        TEXTURE_ENV_MODE,
        COMBINE_RGB,
        COMBINE_ALPHA,
        SOURCE0_RGB,
        SOURCE1_RGB,
        SOURCE2_RGB,
        SOURCE1_ALPHA,
        OPERAND0_RGB,
        OPERAND2_RGB,
        OPERAND2_ALPHA,
        RGB_SCALE,
    ] {
        let mut value = [0];
        gl.glGetTexEnviv(TEXTURE_ENV, name, &mut value);
        gl.note(value[0]);
    }
}
