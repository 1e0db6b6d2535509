//! Giving textures their texels: formats, parts, copies; textures that other scenes use.

use super::*;
use crate::gl::{at, at_mut};

pub(crate) const SCENES: &[Scene] = &[
    scene("texture-internal-formats", Close, internal_formats),
    scene("texture-pixel-formats", Close, pixel_formats),
    scene("texture-packed-types", Close, packed_types),
    scene("texture-sub-image", Rounded, sub_image),
    scene("texture-sub-image-1d-3d", Close, sub_image_others),
    scene("texture-copy", Rounded, copy),
    scene("texture-unpack", Rounded, unpack),
    scene("texture-transfer", Close, transfer),
    scene("texture-level-queries", Exact, level_queries),
    scene("texture-compressed", Close, compressed),
    scene("texture-proxy", Exact, proxy),
];

/// A square 2D texture without further levels.
pub(crate) fn plain(gl: &Gl, size: usize, texels: &[[u8; 4]]) {
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, LINEAR as i32);
    let side = size as i32;
    gl.glTexImage2D(TEXTURE_2D, 0, RGBA as i32, side, side, 0, RGBA, UNSIGNED_BYTE, at(texels));
}

/// A 2D texture with a colour for each level.
pub(crate) fn levels(gl: &Gl, size: usize) {
    let colors = [
        [255, 0, 0],
        [0, 255, 0],
        [0, 0, 255],
        [255, 255, 0],
        [0, 255, 255],
        [255, 0, 255],
        [255, 255, 255],
    ];
    for (level, [r, g, b]) in
        colors.into_iter().enumerate().take_while(|(level, _)| size >> level > 0)
    {
        let side = size >> level;
        let texel = |i: usize| {
            if (i % side + i / side).is_multiple_of(2) {
                [r, g, b, 255]
            } else {
                [r / 2, g / 2, b / 2, 128]
            }
        };
        let texels: Vec<[u8; 4]> = (0..side * side).map(texel).collect();
        let side = side as i32;
        gl.glTexImage2D(
            TEXTURE_2D,
            level as i32,
            RGBA as i32,
            side,
            side,
            0,
            RGBA,
            UNSIGNED_BYTE,
            at(&texels),
        );
    }
}

/// A cube map, each face with a colour and a slope.
pub(crate) fn cube(gl: &Gl, size: usize) {
    for face in 0..6_u32 {
        let texel = |i: usize| {
            let (x, y) = ((255 * (i % size) / size) as u8, (255 * (i / size) / size) as u8);
            let full = |bit: u32| if (face + 1) & bit != 0 { 255 } else { 40 };
            [full(1).min(x | 64), full(2).min(y | 64), full(4), 255]
        };
        let texels: Vec<[u8; 4]> = (0..size * size).map(texel).collect();
        let (target, side) = (TEXTURE_CUBE_MAP_POSITIVE_X + face, size as i32);
        gl.glTexImage2D(target, 0, RGBA as i32, side, side, 0, RGBA, UNSIGNED_BYTE, at(&texels));
    }
    for (name, value) in [
        (TEXTURE_MIN_FILTER, LINEAR),
        (TEXTURE_WRAP_S, CLAMP_TO_EDGE),
        (TEXTURE_WRAP_T, CLAMP_TO_EDGE),
        (TEXTURE_WRAP_R, CLAMP_TO_EDGE),
    ] {
        gl.glTexParameteri(TEXTURE_CUBE_MAP, name, value as i32);
    }
}

/// Draws the bound texture into field `i` of a grid of 8 x 8.
fn field(gl: &Gl, i: usize) {
    let (x, y) = ((i % 8) as f32 * 8.0, (i / 8) as f32 * 8.0);
    textured(gl, [x, y, x + 8.0, y + 8.0], 1.0);
}

fn ready(gl: &Gl) {
    pixels(gl);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, NEAREST as i32);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MAG_FILTER, NEAREST as i32);
    gl.glEnable(TEXTURE_2D);
    gl.glTexEnvi(TEXTURE_ENV, TEXTURE_ENV_MODE, REPLACE as i32);
    gl.glEnable(BLEND);
    gl.glBlendFunc(SRC_ALPHA, ONE);
    gl.glColor4f(0.2, 0.4, 0.6, 0.8);
}

fn internal_formats(gl: &mut Stage<'_>) {
    ready(gl);
    let formats = [
        1,
        2,
        3,
        4,
        ALPHA,
        ALPHA4,
        ALPHA8,
        ALPHA12,
        ALPHA16,
        LUMINANCE,
        LUMINANCE4,
        LUMINANCE8,
        LUMINANCE12,
        LUMINANCE16,
        LUMINANCE_ALPHA,
        LUMINANCE4_ALPHA4,
        LUMINANCE6_ALPHA2,
        LUMINANCE8_ALPHA8,
        LUMINANCE12_ALPHA4,
        LUMINANCE12_ALPHA12,
        LUMINANCE16_ALPHA16,
        INTENSITY,
        INTENSITY4,
        INTENSITY8,
        INTENSITY12,
        INTENSITY16,
        RGB,
        RGB5,
        RGB8,
        RGB10,
        RGB12,
        RGB16,
        RGBA,
        RGBA8,
        RGBA12,
        RGBA16,
    ];
    let texels = checks(4, 2);
    for (i, format) in formats.into_iter().enumerate() {
        gl.glTexImage2D(TEXTURE_2D, 0, format as i32, 4, 4, 0, RGBA, UNSIGNED_BYTE, at(&texels));
        field(gl, i);
    }
}

fn pixel_formats(gl: &mut Stage<'_>) {
    ready(gl);
    let formats = [RED, GREEN, BLUE, ALPHA, LUMINANCE, LUMINANCE_ALPHA, RGB, BGR, RGBA, BGRA];
    let bytes: Vec<u8> = (0..64_u8).map(|i| i * 4).collect();
    let shorts: Vec<u16> = (0..64_u16).map(|i| i * 1000).collect();
    let floats: Vec<f32> = (0..64).map(|i| i as f32 / 60.0).collect();
    let signed: Vec<i32> = (0..64).map(|i| i * 30_000_000).collect();
    let mut i = 0;
    for format in formats {
        for (kind, data) in [
            (UNSIGNED_BYTE, at(&bytes)),
            (UNSIGNED_SHORT, at(&shorts)),
            (FLOAT, at(&floats)),
            (INT, at(&signed)),
        ] {
            gl.glTexImage2D(TEXTURE_2D, 0, RGBA as i32, 4, 4, 0, format, kind, data);
            field(gl, i);
            i += 1;
        }
    }
}

fn packed_types(gl: &mut Stage<'_>) {
    ready(gl);
    let kinds = [
        (RGB, UNSIGNED_BYTE_3_3_2),
        (RGB, UNSIGNED_BYTE_2_3_3_REV),
        (RGB, UNSIGNED_SHORT_5_6_5),
        (RGB, UNSIGNED_SHORT_5_6_5_REV),
        (RGBA, UNSIGNED_SHORT_4_4_4_4),
        (BGRA, UNSIGNED_SHORT_4_4_4_4_REV),
        (RGBA, UNSIGNED_SHORT_5_5_5_1),
        (BGRA, UNSIGNED_SHORT_1_5_5_5_REV),
        (RGBA, UNSIGNED_INT_8_8_8_8),
        (BGRA, UNSIGNED_INT_8_8_8_8_REV),
        (RGBA, UNSIGNED_INT_10_10_10_2),
        (BGRA, UNSIGNED_INT_2_10_10_10_REV),
    ];
    let words: Vec<u32> = (0..16_u32).map(|i| i.wrapping_mul(0x1234_5679).rotate_left(i)).collect();
    for (i, (format, kind)) in kinds.into_iter().enumerate() {
        gl.glTexImage2D(TEXTURE_2D, 0, RGBA16 as i32, 4, 4, 0, format, kind, at(&words));
        field(gl, i);
        gl.glPixelStorei(UNPACK_SWAP_BYTES, 1);
        gl.glTexImage2D(TEXTURE_2D, 0, RGBA16 as i32, 4, 4, 0, format, kind, at(&words));
        field(gl, i + 24);
        gl.glPixelStorei(UNPACK_SWAP_BYTES, 0);
    }
}

fn sub_image(gl: &mut Stage<'_>) {
    ready(gl);
    gl.glTexImage2D(
        TEXTURE_2D,
        0,
        RGBA8 as i32,
        16,
        16,
        0,
        RGBA,
        UNSIGNED_BYTE,
        at(&checks(16, 4)),
    );
    gl.glTexSubImage2D(
        TEXTURE_2D,
        0,
        3,
        5,
        8,
        6,
        RGBA,
        UNSIGNED_BYTE,
        at(&[[250_u8, 120, 0, 255]; 48]),
    );
    gl.glTexSubImage2D(TEXTURE_2D, 0, 0, 0, 4, 4, LUMINANCE, UNSIGNED_BYTE, at(&[200_u8; 16]));
    textured(gl, [0.0, 0.0, 64.0, 64.0], 1.0);
}

fn sub_image_others(gl: &mut Stage<'_>) {
    ready(gl);
    gl.glDisable(TEXTURE_2D);
    gl.glTexImage1D(TEXTURE_1D, 0, RGBA as i32, 16, 0, RGBA, UNSIGNED_BYTE, at(&checks(4, 1)));
    gl.glTexSubImage1D(TEXTURE_1D, 0, 4, 8, RGBA, UNSIGNED_BYTE, at(&[[9_u8, 200, 100, 255]; 8]));
    gl.glTexImage3D(TEXTURE_3D, 0, RGBA as i32, 4, 4, 4, 0, RGBA, UNSIGNED_BYTE, at(&checks(8, 1)));
    gl.glTexSubImage3D(
        TEXTURE_3D,
        0,
        1,
        1,
        2,
        2,
        2,
        1,
        RGBA,
        UNSIGNED_BYTE,
        at(&[[255_u8, 100, 9, 255]; 4]),
    );
    for (target, y) in [(TEXTURE_1D, 2.0), (TEXTURE_3D, 34.0)] {
        gl.glTexParameteri(target, TEXTURE_MIN_FILTER, NEAREST as i32);
        gl.glTexParameteri(target, TEXTURE_MAG_FILTER, NEAREST as i32);
        gl.glEnable(target);
        gl.glBegin(QUADS);
        for (x, dy) in [(2.0, 0.0), (62.0, 0.0), (62.0, 28.0), (2.0, 28.0)] {
            gl.glTexCoord3f(x / 64.0, dy / 28.0, 0.6);
            gl.glVertex2f(x, y + dy);
        }
        gl.glEnd();
        gl.glDisable(target);
    }
}

fn copy(gl: &mut Stage<'_>) {
    pixels(gl);
    rainbow(gl, [0.0, 0.0, 32.0, 32.0], 0.0);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, NEAREST as i32);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MAG_FILTER, NEAREST as i32);
    gl.glCopyTexImage2D(TEXTURE_2D, 0, RGBA, 0, 0, 16, 16, 0);
    gl.glCopyTexSubImage2D(TEXTURE_2D, 0, 4, 4, 20, 20, 8, 8);
    gl.glCopyTexSubImage2D(TEXTURE_2D, 0, 0, 12, -2, 30, 6, 4);
    gl.glEnable(TEXTURE_2D);
    gl.glColor3f(1.0, 1.0, 1.0);
    textured(gl, [32.0, 32.0, 64.0, 64.0], 1.0);
    gl.glCopyTexImage2D(TEXTURE_2D, 0, LUMINANCE, 8, 8, 16, 16, 0);
    textured(gl, [0.0, 32.0, 32.0, 64.0], 1.0);
}

fn unpack(gl: &mut Stage<'_>) {
    ready(gl);
    let texels = checks(16, 3);
    for (i, (row, rows, pixels, alignment)) in
        [(16, 0, 0, 4), (16, 3, 2, 4), (0, 1, 1, 8), (5, 0, 1, 1)].into_iter().enumerate()
    {
        gl.glPixelStorei(UNPACK_ROW_LENGTH, row);
        gl.glPixelStorei(UNPACK_SKIP_ROWS, rows);
        gl.glPixelStorei(UNPACK_SKIP_PIXELS, pixels);
        gl.glPixelStorei(UNPACK_ALIGNMENT, alignment);
        gl.glTexImage2D(TEXTURE_2D, 0, RGBA as i32, 8, 8, 0, RGBA, UNSIGNED_BYTE, at(&texels));
        let x = 32.0 * (i % 2) as f32;
        textured(gl, [x, 0.0, x + 16.0, 16.0], 1.0);
        gl.glTexImage2D(TEXTURE_2D, 0, RGB as i32, 5, 8, 0, RGB, UNSIGNED_BYTE, at(&texels));
        let y = 16.0 * (1 + i / 2) as f32;
        textured(gl, [x, y, x + 20.0, y + 16.0], 1.0);
    }
}

fn transfer(gl: &mut Stage<'_>) {
    ready(gl);
    gl.glPixelTransferf(RED_SCALE, 0.45);
    gl.glPixelTransferf(GREEN_BIAS, -0.3);
    gl.glPixelTransferf(BLUE_SCALE, -1.0);
    gl.glPixelTransferf(BLUE_BIAS, 1.0);
    gl.glPixelMapfv(PIXEL_MAP_G_TO_G, 4, &[0.0, 0.9, 0.2, 1.0]);
    gl.glPixelMapfv(PIXEL_MAP_R_TO_R, 4, &[0.9, 0.3, 0.6, 0.1]);
    gl.glPixelMapfv(PIXEL_MAP_A_TO_A, 2, &[1.0, 0.8]);
    // Mesa looks blue up wrongly.
    gl.glColorMask(1, 1, 0, 1);
    gl.glPixelTransferi(MAP_COLOR, 1);
    gl.glTexImage2D(TEXTURE_2D, 0, RGBA as i32, 16, 16, 0, RGBA, UNSIGNED_BYTE, at(&checks(16, 2)));
    textured(gl, [2.0, 2.0, 62.0, 62.0], 1.0);
}

fn level_queries(gl: &mut Stage<'_>) {
    ready(gl);
    gl.glTexImage2D(TEXTURE_2D, 0, RGBA8 as i32, 16, 8, 0, RGBA, UNSIGNED_BYTE, at(&checks(16, 4)));
    gl.glTexImage2D(TEXTURE_2D, 1, RGBA8 as i32, 8, 4, 0, RGBA, UNSIGNED_BYTE, 0);
    for level in 0..3 {
        for name in
            [TEXTURE_WIDTH, TEXTURE_HEIGHT, TEXTURE_DEPTH, TEXTURE_BORDER, TEXTURE_COMPRESSED]
        {
            let mut value = [-1];
            gl.glGetTexLevelParameteriv(TEXTURE_2D, level, name, &mut value);
            gl.note(value[0]);
        }
    }
    for name in
        [TEXTURE_RED_SIZE, TEXTURE_ALPHA_SIZE, TEXTURE_INTENSITY_SIZE, TEXTURE_INTERNAL_FORMAT]
    {
        let mut value = [-1];
        gl.glGetTexLevelParameteriv(TEXTURE_2D, 0, name, &mut value);
        gl.note(value[0]);
    }
    let mut texels = [[0_u8; 4]; 128];
    gl.glGetTexImage(TEXTURE_2D, 0, BGRA, UNSIGNED_BYTE, at_mut(&mut texels));
    gl.notes(&texels.concat().iter().map(|b| f32::from(*b)).collect::<Vec<_>>());
}

fn compressed(gl: &mut Stage<'_>) {
    ready(gl);
    let texels = checks(16, 8);
    for (i, format) in
        [COMPRESSED_ALPHA, COMPRESSED_LUMINANCE, COMPRESSED_LUMINANCE_ALPHA, COMPRESSED_INTENSITY]
            .into_iter()
            .enumerate()
    {
        gl.glTexImage2D(TEXTURE_2D, 0, format as i32, 16, 16, 0, RGBA, UNSIGNED_BYTE, at(&texels));
        let x = 16.0 * i as f32;
        textured(gl, [x, 4.0, x + 15.0, 60.0], 1.0);
    }
}

fn proxy(gl: &mut Stage<'_>) {
    let width = |gl: &mut Stage<'_>, target, name| {
        let mut value = [-1];
        gl.glGetTexLevelParameteriv(target, 0, name, &mut value);
        gl.note(value[0]);
    };
    gl.glTexImage2D(PROXY_TEXTURE_2D, 0, RGBA8 as i32, 64, 32, 0, RGBA, UNSIGNED_BYTE, 0);
    width(gl, PROXY_TEXTURE_2D, TEXTURE_WIDTH);
    width(gl, PROXY_TEXTURE_2D, TEXTURE_HEIGHT);
    gl.glTexImage2D(PROXY_TEXTURE_2D, 0, RGBA8 as i32, 1 << 20, 1 << 20, 0, RGBA, UNSIGNED_BYTE, 0);
    width(gl, PROXY_TEXTURE_2D, TEXTURE_WIDTH);
    gl.glTexImage1D(PROXY_TEXTURE_1D, 0, RGBA8 as i32, 64, 0, RGBA, UNSIGNED_BYTE, 0);
    width(gl, PROXY_TEXTURE_1D, TEXTURE_WIDTH);
    gl.glTexImage3D(PROXY_TEXTURE_3D, 0, RGB as i32, 16, 8, 4, 0, RGB, UNSIGNED_BYTE, 0);
    width(gl, PROXY_TEXTURE_3D, TEXTURE_DEPTH);
    gl.note(gl.glGetError());
}
