//! Looking textures up: filters, levels, wrapping, kinds of texture, comparison.

use super::*;
use crate::gl::at;
use texture_images::{cube, levels, plain};

pub(crate) const SCENES: &[Scene] = &[
    scene("texture-nearest", Close, nearest),
    scene("texture-linear", Close, linear),
    scene("texture-minified", Close, minified),
    scene("texture-levels", Close, mip_levels),
    scene("texture-generate-mipmap", Close, generate_mipmap),
    scene("texture-lod-bias", Close, lod_bias),
    scene("texture-lod-range", Close, lod_range),
    scene("texture-base-max-level", Close, base_max_level),
    scene("texture-wrap-nearest", Close, wrap_nearest),
    scene("texture-wrap-linear", Close, wrap_linear),
    scene("texture-1d", Close, one),
    scene("texture-3d", Close, three),
    scene("texture-cube", Close, cube_faces),
    scene("texture-cube-seamless", Close, cube_seamless),
    scene("texture-rectangle", Close, rectangle),
    scene("texture-npot", Close, npot),
    scene("texture-priority-of-targets", Close, priority),
    scene("texture-incomplete", Rounded, incomplete),
    scene("texture-shadow-compare", Close, shadow_compare),
    scene("texture-depth-modes", Close, depth_modes),
    scene("texture-srgb", Close, srgb),
    scene("texture-float", Close, float),
    scene("texture-anisotropic", Close, anisotropic),
];

fn filters(gl: &Gl, target: u32, min: u32, mag: u32) {
    gl.glTexParameteri(target, TEXTURE_MIN_FILTER, min as i32);
    gl.glTexParameteri(target, TEXTURE_MAG_FILTER, mag as i32);
}

fn nearest(gl: &mut Stage<'_>) {
    pixels(gl);
    plain(gl, 8, &checks(8, 2));
    filters(gl, TEXTURE_2D, NEAREST, NEAREST);
    gl.glEnable(TEXTURE_2D);
    textured(gl, [2.0, 2.0, 62.0, 62.0], 1.3);
}

fn linear(gl: &mut Stage<'_>) {
    pixels(gl);
    plain(gl, 8, &checks(8, 2));
    gl.glEnable(TEXTURE_2D);
    textured(gl, [2.0, 2.0, 62.0, 62.0], 1.3);
}

fn minified(gl: &mut Stage<'_>) {
    pixels(gl);
    plain(gl, 64, &checks(64, 8));
    gl.glEnable(TEXTURE_2D);
    filters(gl, TEXTURE_2D, NEAREST, NEAREST);
    textured(gl, [2.0, 2.0, 32.0, 62.0], 1.7);
    filters(gl, TEXTURE_2D, LINEAR, NEAREST);
    textured(gl, [32.0, 2.0, 62.0, 62.0], 1.7);
}

/// A row for each minification filter, in it squares whose texels are ever smaller. How exactly the
/// level is found is free: these sizes are near powers of two. (Nor are they below the square root
/// of two, from where on Mesa would magnify with nearest texels.)
fn shrinking(gl: &Gl) {
    pixels(gl);
    let rows = [
        NEAREST_MIPMAP_NEAREST,
        LINEAR_MIPMAP_NEAREST,
        NEAREST_MIPMAP_LINEAR,
        LINEAR_MIPMAP_LINEAR,
    ];
    for (j, filter) in rows.into_iter().enumerate() {
        filters(gl, TEXTURE_2D, filter, LINEAR);
        for (i, texels) in [1.9, 2.15, 3.8, 4.3].into_iter().enumerate() {
            let (x, y) = (1.0 + 12.6 * i as f32, 1.0 + 16.0 * j as f32);
            textured(gl, [x, y, x + 12.0, y + 12.0], 12.0 * texels / 32.0);
        }
    }
}

fn mip_levels(gl: &mut Stage<'_>) {
    levels(gl, 32);
    gl.glEnable(TEXTURE_2D);
    shrinking(gl);
}

fn generate_mipmap(gl: &mut Stage<'_>) {
    gl.glTexParameteri(TEXTURE_2D, GENERATE_MIPMAP, 1);
    plain(gl, 32, &checks(32, 4));
    gl.glEnable(TEXTURE_2D);
    shrinking(gl);
    let mut texels = [[0_u8; 4]; 16];
    gl.glGetTexImage(TEXTURE_2D, 3, RGBA, UNSIGNED_BYTE, crate::gl::at_mut(&mut texels));
    // How a level is made is not said exactly: only its mean is compared.
    let mean = |i: usize| texels.iter().map(|t| f32::from(t[i])).sum::<f32>() / 16.0 / 255.0;
    gl.notes(&[mean(0), mean(1), mean(2), mean(3)].map(|m| (m * 40.0).round()));
}

fn lod_bias(gl: &mut Stage<'_>) {
    pixels(gl);
    levels(gl, 16);
    filters(gl, TEXTURE_2D, NEAREST_MIPMAP_NEAREST, NEAREST);
    gl.glEnable(TEXTURE_2D);
    for (i, bias) in [-2.0, 0.0, 1.0, 2.2, 3.0, 9.0].into_iter().enumerate() {
        if i % 2 == 0 {
            gl.glTexEnvf(TEXTURE_FILTER_CONTROL, TEXTURE_LOD_BIAS, bias);
        } else {
            gl.glTexEnvf(TEXTURE_FILTER_CONTROL, TEXTURE_LOD_BIAS, 0.0);
            gl.glTexParameterf(TEXTURE_2D, TEXTURE_LOD_BIAS, bias);
        }
        let x = 2.0 + 10.0 * i as f32;
        textured(gl, [x, 4.0, x + 8.0, 12.0], 0.5);
        textured(gl, [x, 20.0, x + 8.0, 28.0], 1.0);
        textured(gl, [x, 36.0, x + 8.0, 44.0], 2.0);
        gl.glTexParameterf(TEXTURE_2D, TEXTURE_LOD_BIAS, 0.0);
    }
}

fn lod_range(gl: &mut Stage<'_>) {
    pixels(gl);
    levels(gl, 16);
    filters(gl, TEXTURE_2D, NEAREST_MIPMAP_NEAREST, NEAREST);
    gl.glEnable(TEXTURE_2D);
    for (i, (least, most)) in
        [(0.0, 0.0), (1.0, 1.0), (2.0, 4.0), (-1000.0, 1.0), (-5.0, -2.0)].into_iter().enumerate()
    {
        gl.glTexParameterf(TEXTURE_2D, TEXTURE_MIN_LOD, least);
        gl.glTexParameterf(TEXTURE_2D, TEXTURE_MAX_LOD, most);
        let x = 2.0 + 12.0 * i as f32;
        textured(gl, [x, 4.0, x + 8.0, 12.0], 0.5);
        textured(gl, [x, 20.0, x + 8.0, 28.0], 2.0);
        textured(gl, [x, 36.0, x + 8.0, 44.0], 4.0);
    }
}

fn base_max_level(gl: &mut Stage<'_>) {
    pixels(gl);
    levels(gl, 16);
    filters(gl, TEXTURE_2D, NEAREST_MIPMAP_NEAREST, NEAREST);
    gl.glEnable(TEXTURE_2D);
    for (i, (base, most)) in [(0, 1000), (1, 1000), (2, 3), (0, 1), (4, 4)].into_iter().enumerate()
    {
        gl.glTexParameteri(TEXTURE_2D, TEXTURE_BASE_LEVEL, base);
        gl.glTexParameteri(TEXTURE_2D, TEXTURE_MAX_LEVEL, most);
        let x = 2.0 + 12.0 * i as f32;
        textured(gl, [x, 4.0, x + 8.0, 12.0], 0.5);
        textured(gl, [x, 20.0, x + 8.0, 28.0], 1.0);
        textured(gl, [x, 36.0, x + 8.0, 44.0], 4.0);
    }
}

const WRAPS: [u32; 5] = [REPEAT, CLAMP, CLAMP_TO_EDGE, CLAMP_TO_BORDER, MIRRORED_REPEAT];

fn wraps(gl: &Gl, filter: u32) {
    pixels(gl);
    plain(gl, 8, &checks(8, 2));
    filters(gl, TEXTURE_2D, filter, filter);
    gl.glTexParameterfv(TEXTURE_2D, TEXTURE_BORDER_COLOR, &[1.0, 0.0, 1.0, 1.0]);
    gl.glEnable(TEXTURE_2D);
    for (i, s) in WRAPS.into_iter().enumerate() {
        for (j, t) in WRAPS.into_iter().enumerate() {
            gl.glTexParameteri(TEXTURE_2D, TEXTURE_WRAP_S, s as i32);
            gl.glTexParameteri(TEXTURE_2D, TEXTURE_WRAP_T, t as i32);
            let (x, y) = (1.0 + 12.5 * i as f32, 1.0 + 12.5 * j as f32);
            gl.glBegin(QUADS);
            for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                gl.glTexCoord2f(-1.07 + 3.11 * dx, -1.07 + 3.11 * dy);
                gl.glVertex2f(x + 12.0 * dx, y + 12.0 * dy);
            }
            gl.glEnd();
        }
    }
}

fn wrap_nearest(gl: &mut Stage<'_>) {
    wraps(gl, NEAREST);
}

fn wrap_linear(gl: &mut Stage<'_>) {
    wraps(gl, LINEAR);
}

fn one(gl: &mut Stage<'_>) {
    pixels(gl);
    let texels: Vec<[u8; 4]> =
        (0..16_u8).map(|i| [i * 17, 255 - i * 17, 90 * (i % 3), 255]).collect();
    gl.glTexImage1D(TEXTURE_1D, 0, RGBA as i32, 16, 0, RGBA, UNSIGNED_BYTE, at(&texels));
    gl.glEnable(TEXTURE_1D);
    filters(gl, TEXTURE_1D, LINEAR, LINEAR);
    textured(gl, [2.0, 2.0, 62.0, 30.0], 1.5);
    filters(gl, TEXTURE_1D, NEAREST, NEAREST);
    textured(gl, [2.0, 34.0, 62.0, 62.0], 1.0);
}

fn three(gl: &mut Stage<'_>) {
    camera(gl);
    let texel = |i: usize| {
        let (x, y, z) = (i % 8, i / 8 % 8, i / 64);
        [(x * 36) as u8, (y * 36) as u8, (z * 85) as u8, 255]
    };
    let texels: Vec<[u8; 4]> = (0..256).map(texel).collect();
    gl.glTexImage3D(TEXTURE_3D, 0, RGBA as i32, 8, 8, 4, 0, RGBA, UNSIGNED_BYTE, at(&texels));
    gl.glEnable(TEXTURE_3D);
    for (filter, x) in [(LINEAR, -1.7), (NEAREST, 0.1)] {
        filters(gl, TEXTURE_3D, filter, filter);
        gl.glBegin(QUADS);
        for (dx, y, r) in [(0.0, -1.6, 0.0), (1.6, -1.6, 0.5), (1.6, 1.6, 1.2), (0.0, 1.6, 0.7)] {
            gl.glTexCoord3f(dx / 1.6, (y + 1.6) / 3.2, r);
            gl.glVertex3f(x + dx, y, 0.0);
        }
        gl.glEnd();
    }
}

/// A sphere whose points are the directions looked up.
fn looked_at(gl: &Gl) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glEnable(TEXTURE_CUBE_MAP);
    gl.glRotatef(35.0, 1.0, 0.8, 0.0);
    for stack in 0..24 {
        gl.glBegin(QUAD_STRIP);
        for slice in 0..=40 {
            for v in [stack as f32 / 24.0, (stack + 1) as f32 / 24.0] {
                let p = sphere_point(-(slice as f32) / 40.0, v);
                gl.glTexCoord3fv(&p);
                gl.glVertex3fv(&p.map(|c| 1.7 * c));
            }
        }
        gl.glEnd();
    }
}

fn cube_faces(gl: &mut Stage<'_>) {
    cube(gl, 8);
    filters(gl, TEXTURE_CUBE_MAP, NEAREST, NEAREST);
    looked_at(gl);
}

fn cube_seamless(gl: &mut Stage<'_>) {
    cube(gl, 4);
    filters(gl, TEXTURE_CUBE_MAP, LINEAR, LINEAR);
    gl.glEnable(TEXTURE_CUBE_MAP_SEAMLESS);
    looked_at(gl);
}

fn rectangle(gl: &mut Stage<'_>) {
    pixels(gl);
    let texels: Vec<[u8; 4]> = checks(12, 3)[..84].to_vec();
    gl.glTexImage2D(
        TEXTURE_RECTANGLE_ARB,
        0,
        RGBA as i32,
        12,
        7,
        0,
        RGBA,
        UNSIGNED_BYTE,
        at(&texels),
    );
    gl.glEnable(TEXTURE_RECTANGLE_ARB);
    filters(gl, TEXTURE_RECTANGLE_ARB, NEAREST, NEAREST);
    textured(gl, [2.0, 2.0, 30.0, 62.0], 12.0);
    filters(gl, TEXTURE_RECTANGLE_ARB, LINEAR, LINEAR);
    textured(gl, [34.0, 2.0, 62.0, 62.0], 14.0);
}

fn npot(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glTexParameteri(TEXTURE_2D, GENERATE_MIPMAP, 1);
    gl.glTexImage2D(
        TEXTURE_2D,
        0,
        RGBA as i32,
        13,
        9,
        0,
        RGBA,
        UNSIGNED_BYTE,
        at(&checks(13, 3)[..117]),
    );
    gl.glEnable(TEXTURE_2D);
    filters(gl, TEXTURE_2D, NEAREST, NEAREST);
    textured(gl, [2.0, 2.0, 30.0, 62.0], 1.5);
    filters(gl, TEXTURE_2D, LINEAR, LINEAR);
    textured(gl, [34.0, 2.0, 62.0, 62.0], 2.5);
}

fn priority(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glTexImage1D(
        TEXTURE_1D,
        0,
        RGBA as i32,
        2,
        0,
        RGBA,
        UNSIGNED_BYTE,
        at(&[[255_u8, 0, 0, 255]; 2]),
    );
    plain(gl, 2, &[[0, 255, 0, 255]; 4]);
    gl.glTexImage3D(
        TEXTURE_3D,
        0,
        RGBA as i32,
        2,
        2,
        2,
        0,
        RGBA,
        UNSIGNED_BYTE,
        at(&[[0_u8, 0, 255, 255]; 8]),
    );
    for target in [TEXTURE_1D, TEXTURE_2D, TEXTURE_3D] {
        filters(gl, target, NEAREST, NEAREST);
    }
    for (i, target) in [TEXTURE_1D, TEXTURE_2D, TEXTURE_3D].into_iter().enumerate() {
        gl.glEnable(target);
        let x = 2.0 + 20.0 * i as f32;
        textured(gl, [x, 4.0, x + 16.0, 60.0], 1.0);
    }
}

/// A texture without all its levels is as if texturing were off.
fn incomplete(gl: &mut Stage<'_>) {
    pixels(gl);
    let texels = checks(8, 2);
    gl.glTexImage2D(TEXTURE_2D, 0, RGBA as i32, 8, 8, 0, RGBA, UNSIGNED_BYTE, at(&texels));
    gl.glEnable(TEXTURE_2D);
    gl.glColor3f(1.0, 0.2, 0.0);
    textured(gl, [2.0, 2.0, 30.0, 62.0], 1.0);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MAX_LEVEL, 0);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MAG_FILTER, NEAREST as i32);
    textured(gl, [32.0, 2.0, 64.0, 66.0], 1.0);
}

fn depth_texture(gl: &Gl, internal: u32) {
    let depths: Vec<f32> =
        (0..64).map(|i| (i % 8) as f32 / 7.0 * 0.6 + (i / 8) as f32 / 7.0 * 0.4).collect();
    gl.glTexImage2D(TEXTURE_2D, 0, internal as i32, 8, 8, 0, DEPTH_COMPONENT, FLOAT, at(&depths));
    filters(gl, TEXTURE_2D, NEAREST, NEAREST);
    gl.glEnable(TEXTURE_2D);
}

fn shadow_compare(gl: &mut Stage<'_>) {
    pixels(gl);
    depth_texture(gl, DEPTH_COMPONENT24);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_COMPARE_MODE, COMPARE_R_TO_TEXTURE as i32);
    for i in 0..8 {
        gl.glTexParameteri(TEXTURE_2D, TEXTURE_COMPARE_FUNC, (NEVER + i) as i32);
        let (x, y) = (1.0 + 16.0 * (i % 4) as f32, 2.0 + 32.0 * (i / 4) as f32);
        gl.glBegin(QUADS);
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            gl.glTexCoord3f(dx, dy, 0.505);
            gl.glVertex2f(x + 14.0 * dx, y + 28.0 * dy);
        }
        gl.glEnd();
    }
}

fn depth_modes(gl: &mut Stage<'_>) {
    pixels(gl);
    depth_texture(gl, DEPTH_COMPONENT16);
    gl.glEnable(BLEND);
    gl.glBlendFunc(SRC_ALPHA, ONE);
    gl.glColor4f(1.0, 0.7, 0.4, 0.9);
    for (i, mode) in [LUMINANCE, INTENSITY, ALPHA].into_iter().enumerate() {
        gl.glTexParameteri(TEXTURE_2D, DEPTH_TEXTURE_MODE, mode as i32);
        let x = 2.0 + 21.0 * i as f32;
        textured(gl, [x, 4.0, x + 16.0, 60.0], 1.0);
    }
}

fn srgb(gl: &mut Stage<'_>) {
    pixels(gl);
    let texels: Vec<[u8; 4]> =
        (0..=255).map(|i| [i as u8, 255 - i as u8, i as u8 / 2, i as u8]).collect();
    gl.glTexImage2D(
        TEXTURE_2D,
        0,
        SRGB8_ALPHA8_EXT as i32,
        16,
        16,
        0,
        RGBA,
        UNSIGNED_BYTE,
        at(&texels),
    );
    filters(gl, TEXTURE_2D, NEAREST, LINEAR);
    gl.glEnable(TEXTURE_2D);
    textured(gl, [2.0, 2.0, 62.0, 62.0], 1.0);
}

fn float(gl: &mut Stage<'_>) {
    pixels(gl);
    let texels: Vec<[f32; 4]> =
        (0..64).map(|i| [i as f32 / 16.0 - 1.0, 4.0, -2.0, i as f32 / 64.0]).collect();
    gl.glTexImage2D(TEXTURE_2D, 0, RGBA32F_ARB as i32, 8, 8, 0, RGBA, FLOAT, at(&texels));
    filters(gl, TEXTURE_2D, LINEAR, LINEAR);
    gl.glEnable(TEXTURE_2D);
    gl.glColor4f(0.25, 0.2, 0.5, 1.0);
    textured(gl, [2.0, 2.0, 62.0, 62.0], 1.0);
    let mut back = [[0.0_f32; 4]; 64];
    gl.glGetTexImage(TEXTURE_2D, 0, RGBA, FLOAT, crate::gl::at_mut(&mut back));
    gl.notes(&back.concat());
}

/// How anisotropic filters look is free.
fn anisotropic(gl: &mut Stage<'_>) {
    pixels(gl);
    plain(gl, 16, &[[200, 100, 50, 255]; 256]);
    gl.glTexParameterf(TEXTURE_2D, TEXTURE_MAX_ANISOTROPY_EXT, 4.0);
    gl.glEnable(TEXTURE_2D);
    textured(gl, [2.0, 2.0, 34.0, 60.0], 9.0);
    let mut value = [0.0];
    gl.glGetTexParameterfv(TEXTURE_2D, TEXTURE_MAX_ANISOTROPY_EXT, &mut value);
    gl.notes(&value);
}
