//! The window system's side: formats and types of the colour buffer, its rows, several contexts,
//! shared objects.

use super::*;
use crate::gl::{at, at_mut};

const BGRA_FORMAT: u32 = 0x1;
const ARGB_FORMAT: u32 = 0x2;
const RGB_565_FORMAT: u32 = 0x5;

const fn on(name: &'static str, surface: Surface) -> Scene {
    Scene { name, agreement: Close, surface, draw: picture }
}

pub(crate) const SCENES: &[Scene] = &[
    on("surface-rgba", USUAL),
    on("surface-bgra", Surface { format: BGRA_FORMAT, ..USUAL }),
    on("surface-argb", Surface { format: ARGB_FORMAT, ..USUAL }),
    on("surface-short", Surface { kind: UNSIGNED_SHORT, ..USUAL }),
    on("surface-float", Surface { kind: FLOAT, ..USUAL }),
    on("surface-565", Surface { format: RGB_565_FORMAT, kind: UNSIGNED_SHORT_5_6_5, ..USUAL }),
    on("surface-y-down", Surface { y_up: false, ..USUAL }),
    on("surface-row-length", Surface { row_length: 100, size: [61, 47], ..USUAL }),
    on("surface-large", Surface { size: [333, 259], ..USUAL }),
    on("surface-one-pixel", Surface { size: [1, 1], ..USUAL }),
    scene("two-contexts", Close, two_contexts),
    scene("shared-objects", Close, shared_objects),
    scene("framebuffer-kept", Close, framebuffer_kept),
];

fn picture(gl: &mut Stage<'_>) {
    gl.glClearColor(0.25, 0.5, 0.75, 1.0);
    gl.glClear(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT);
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    rainbow(gl, [-1.2, -1.7, 1.6, 1.1], 0.0);
    gl.glColor4f(0.9, 0.1, 0.4, 1.0);
    gl.glTranslatef(0.7, 0.9, 0.0);
    sphere(gl, 0.6, 16, 10);
    let mut corner = [0_u8; 4];
    gl.glReadPixels(0, 0, 1, 1, RGBA, UNSIGNED_BYTE, at_mut(&mut corner));
    gl.notes(&corner.map(|c| (f32::from(c) / 16.0).round()));
}

/// Each context has its own state and its own buffer.
fn two_contexts(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glColor3f(1.0, 0.5, 0.0);
    let mut other_buffer = vec![0_u32; 32 * 32];
    let other = gl.OSMesaCreateContext(RGBA, 0);
    gl.OSMesaMakeCurrent(other, at_mut(&mut other_buffer), UNSIGNED_BYTE, 32, 32);
    gl.note_floats::<4>(CURRENT_COLOR);
    gl.glClearColor(0.0, 1.0, 0.0, 1.0);
    gl.glClear(COLOR_BUFFER_BIT);
    gl.glFinish();
    gl.back();
    gl.note_floats::<4>(CURRENT_COLOR);
    gl.glRectf(3.0, 3.0, 60.0, 60.0);
    gl.glWindowPos2i(16, 16);
    gl.glDrawPixels(32, 32, RGBA, UNSIGNED_BYTE, at(&other_buffer));
    gl.OSMesaDestroyContext(other);
}

fn shared_objects(gl: &mut Stage<'_>) {
    pixels(gl);
    let mut buffer = vec![0_u32; 32 * 32];
    let other = gl.OSMesaCreateContextExt(RGBA, 24, 8, 0, gl.context());
    gl.OSMesaMakeCurrent(other, at_mut(&mut buffer), UNSIGNED_BYTE, 32, 32);
    gl.glNewList(5, COMPILE);
    gl.glColor3f(0.3, 0.8, 1.0);
    gl.glRectf(2.0, 2.0, 30.0, 62.0);
    gl.glEndList();
    let mut names = [0];
    gl.glGenTextures(1, &mut names);
    gl.glBindTexture(TEXTURE_2D, names[0]);
    texture_images::plain(gl, 8, &checks(8, 2));
    gl.glFinish();
    gl.back();
    gl.OSMesaDestroyContext(other);
    gl.note(gl.glIsList(5));
    gl.note(gl.glIsTexture(names[0]));
    gl.glCallList(5);
    gl.glBindTexture(TEXTURE_2D, names[0]);
    gl.glEnable(TEXTURE_2D);
    gl.glColor3f(1.0, 1.0, 1.0);
    textured(gl, [34.0, 2.0, 62.0, 62.0], 1.0);
}

/// What was drawn before a release is there after it.
fn framebuffer_kept(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(DEPTH_TEST);
    rainbow(gl, [4.0, 4.0, 40.0, 40.0], 0.5);
    gl.glFinish();
    gl.OSMesaMakeCurrent(0, 0, 0, 0, 0);
    gl.back();
    gl.glColor3f(1.0, 1.0, 1.0);
    gl.glRectf(20.0, 20.0, 60.0, 60.0);
}
