//! Texture coordinates: generation and the texture matrix.

use super::*;

pub(crate) const SCENES: &[Scene] = &[
    scene("texgen-object-linear", Close, object_linear),
    scene("texgen-eye-linear", Close, eye_linear),
    scene("texgen-sphere-map", Close, sphere_map),
    scene("texgen-reflection", Close, reflection),
    scene("texgen-normal-map", Close, normal_map),
    scene("texture-matrix", Close, texture_matrix),
    scene("texture-projective", Close, projective),
    scene("texcoord-units", Close, units),
];

fn ready(gl: &Gl) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    texture_images::plain(gl, 16, &checks(16, 4));
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MAG_FILTER, NEAREST as i32);
    gl.glEnable(TEXTURE_2D);
}

fn object_linear(gl: &mut Stage<'_>) {
    ready(gl);
    gl.glTexGeni(S, TEXTURE_GEN_MODE, OBJECT_LINEAR as i32);
    gl.glTexGeni(T, TEXTURE_GEN_MODE, OBJECT_LINEAR as i32);
    gl.glTexGenfv(S, OBJECT_PLANE, &[0.5, 0.1, 0.0, 0.2]);
    gl.glTexGenfv(T, OBJECT_PLANE, &[0.0, 0.5, 0.3, 0.0]);
    gl.glEnable(TEXTURE_GEN_S);
    gl.glEnable(TEXTURE_GEN_T);
    gl.glRotatef(30.0, 1.0, 1.0, 0.0);
    sphere(gl, 1.6, 24, 16);
}

fn eye_linear(gl: &mut Stage<'_>) {
    ready(gl);
    gl.glRotatef(20.0, 0.0, 0.0, 1.0);
    gl.glTexGeni(S, TEXTURE_GEN_MODE, EYE_LINEAR as i32);
    gl.glTexGeni(T, TEXTURE_GEN_MODE, EYE_LINEAR as i32);
    gl.glTexGenfv(S, EYE_PLANE, &[0.4, 0.0, 0.0, 0.3]);
    gl.glTexGendv(T, EYE_PLANE, &[0.0, 0.4, 0.1, 0.0]);
    gl.glEnable(TEXTURE_GEN_S);
    gl.glEnable(TEXTURE_GEN_T);
    gl.glRotatef(50.0, 1.0, 0.0, 0.0);
    sphere(gl, 1.6, 24, 16);
    let mut plane = [0.0; 4];
    gl.glGetTexGenfv(S, EYE_PLANE, &mut plane);
    gl.notes(&plane);
}

fn sphere_map(gl: &mut Stage<'_>) {
    ready(gl);
    for coordinate in [S, T] {
        gl.glTexGeni(coordinate, TEXTURE_GEN_MODE, SPHERE_MAP as i32);
    }
    gl.glEnable(TEXTURE_GEN_S);
    gl.glEnable(TEXTURE_GEN_T);
    sphere(gl, 1.6, 40, 24);
}

fn cube_by(gl: &mut Stage<'_>, mode: u32) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    texture_images::cube(gl, 16);
    gl.glEnable(TEXTURE_CUBE_MAP);
    for (coordinate, cap) in [(S, TEXTURE_GEN_S), (T, TEXTURE_GEN_T), (R, TEXTURE_GEN_R)] {
        gl.glTexGeni(coordinate, TEXTURE_GEN_MODE, mode as i32);
        gl.glEnable(cap);
    }
    gl.glRotatef(30.0, 1.0, 0.5, 0.0);
    sphere(gl, 1.6, 48, 32);
}

fn reflection(gl: &mut Stage<'_>) {
    cube_by(gl, REFLECTION_MAP);
}

fn normal_map(gl: &mut Stage<'_>) {
    cube_by(gl, NORMAL_MAP);
}

fn texture_matrix(gl: &mut Stage<'_>) {
    ready(gl);
    gl.glMatrixMode(TEXTURE);
    gl.glTranslatef(0.25, 0.1, 0.0);
    gl.glRotatef(30.0, 0.0, 0.0, 1.0);
    gl.glScalef(1.5, 0.7, 1.0);
    gl.glMatrixMode(MODELVIEW);
    textured(gl, [-1.5, -1.5, 1.5, 1.5], 1.2);
    gl.note_floats::<16>(TEXTURE_MATRIX);
}

fn projective(gl: &mut Stage<'_>) {
    ready(gl);
    gl.glBegin(TRIANGLE_FAN);
    for (x, y, q) in [(-1.5, -1.5, 1.0), (1.5, -1.5, 1.0), (1.0, 1.5, 3.0), (-1.0, 1.5, 3.0)] {
        gl.glTexCoord4f((x + 1.5) * q / 3.0, (y + 1.5) * q / 3.0, 0.0, q);
        gl.glVertex3f(x, y, 0.0);
    }
    gl.glEnd();
}

fn units(gl: &mut Stage<'_>) {
    camera(gl);
    for unit in 0..4 {
        gl.glActiveTexture(TEXTURE0 + unit);
        let mut name = [0];
        gl.glGenTextures(1, &mut name);
        gl.glBindTexture(TEXTURE_2D, name[0]);
        texture_images::plain(gl, 16, &checks(16, 1 << unit));
        gl.glTexParameteri(TEXTURE_2D, TEXTURE_MAG_FILTER, NEAREST as i32);
        gl.glTexEnvi(
            TEXTURE_ENV,
            TEXTURE_ENV_MODE,
            [MODULATE, ADD, MODULATE, BLEND][unit as usize] as i32,
        );
        gl.glTexEnvfv(TEXTURE_ENV, TEXTURE_ENV_COLOR, &[0.3, 0.6, 0.9, 1.0]);
        gl.glEnable(TEXTURE_2D);
    }
    gl.glColor3f(0.8, 0.5, 0.5);
    gl.glBegin(QUADS);
    for (x, y) in [(-1.5_f32, -1.5_f32), (1.5, -1.5), (1.5, 1.5), (-1.5, 1.5)] {
        for unit in 0..4 {
            let (sin, cos) = (0.1 + unit as f32 * 0.3).sin_cos();
            gl.glMultiTexCoord2f(
                TEXTURE0 + unit,
                0.8 * (x * cos - y * sin),
                0.8 * (x * sin + y * cos),
            );
        }
        gl.glVertex3f(x, y, 0.0);
    }
    gl.glEnd();
}
