//! Alpha, stencil and depth tests, and their buffers.

use super::*;

pub(crate) const SCENES: &[Scene] = &[
    scene("alpha-functions", Rounded, alpha_functions),
    scene("depth-functions", Rounded, depth_functions),
    scene("depth-mask", Close, depth_mask),
    scene("depth-bits", Close, depth_bits),
    scene("stencil-functions", Rounded, stencil_functions),
    scene("stencil-operations", Rounded, stencil_operations),
    scene("stencil-mask", Rounded, stencil_mask),
    scene("stencil-two-side", Rounded, stencil_two_side),
    scene("stencil-outline", Close, stencil_outline),
    scene("order-of-tests", Rounded, order_of_tests),
];

/// Column `i` and row `j` of a grid of 8 x 8.
fn field(gl: &Gl, i: usize, j: usize, z: f32) {
    let (x, y) = (i as f32 * 8.0, j as f32 * 8.0);
    gl.glBegin(QUADS);
    for (dx, dy) in [(0.0, 0.0), (7.0, 0.0), (7.0, 7.0), (0.0, 7.0)] {
        gl.glVertex3f(x + dx, y + dy, z);
    }
    gl.glEnd();
}

const FUNCTIONS: [u32; 8] = [NEVER, LESS, EQUAL, LEQUAL, GREATER, NOTEQUAL, GEQUAL, ALWAYS];

fn alpha_functions(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(ALPHA_TEST);
    for (i, function) in FUNCTIONS.into_iter().enumerate() {
        gl.glAlphaFunc(function, 0.6);
        for (j, alpha) in [0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.5, -0.5].into_iter().enumerate() {
            gl.glColor4f(1.0, j as f32 / 8.0, 0.3, alpha);
            field(gl, i, j, 0.0);
        }
    }
}

fn depth_functions(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glDepthFunc(ALWAYS);
    gl.glColor3f(0.2, 0.2, 0.2);
    gl.glRectf(0.0, 0.0, 64.0, 64.0);
    for (i, function) in FUNCTIONS.into_iter().enumerate() {
        gl.glDepthFunc(function);
        for (j, z) in [-0.5, 0.0, 0.5].into_iter().enumerate() {
            gl.glColor3f(1.0, j as f32 / 3.0, 0.5);
            field(gl, i, j, z);
        }
    }
}

fn depth_mask(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glColor3f(1.0, 0.4, 0.1);
    sphere(gl, 1.0, 24, 16);
    gl.glDepthMask(0);
    gl.glColor3f(0.1, 0.4, 1.0);
    gl.glTranslatef(0.6, 0.2, 0.4);
    sphere(gl, 1.0, 24, 16);
    gl.glClear(DEPTH_BUFFER_BIT);
    gl.glDepthMask(1);
    gl.glColor3f(0.1, 1.0, 0.1);
    gl.glTranslatef(-0.9, 0.5, -0.6);
    sphere(gl, 1.0, 24, 16);
}

/// Two planes that cross at a small angle: where they change places shows the depth buffer's steps.
fn depth_bits(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glDepthFunc(LESS);
    for (color, slope) in [([1.0, 0.0, 0.0], 0.0), ([0.0, 0.0, 1.0], 0.001)] {
        gl.glColor3fv(&color);
        gl.glBegin(QUADS);
        for (x, y) in [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)] {
            gl.glVertex3f(x, y, slope * (x + 0.3 * y));
        }
        gl.glEnd();
    }
}

fn stencil_functions(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(STENCIL_TEST);
    gl.glClearStencil(0x35);
    gl.glClear(STENCIL_BUFFER_BIT);
    for (i, function) in FUNCTIONS.into_iter().enumerate() {
        for (j, (reference, mask)) in [
            (0x34, 0xff),
            (0x35, 0xff),
            (0x36, 0xff),
            (0x05, 0x0f),
            (0x7f, 0x30),
            (300, 0xff),
            (-1, 0xff),
            (0x1ff, 1),
        ]
        .into_iter()
        .enumerate()
        {
            gl.glStencilFunc(function, reference, mask);
            gl.glColor3f(1.0, j as f32 / 8.0, i as f32 / 8.0);
            field(gl, i, j, 0.0);
        }
    }
}

/// Shows the stencil buffer as red, a level for each value.
fn show_stencil(gl: &mut Stage<'_>) {
    gl.glPushAttrib(PIXEL_MODE_BIT | STENCIL_BUFFER_BIT | DEPTH_BUFFER_BIT);
    let mut values = [0_u8; 64 * 64];
    gl.glPixelStorei(PACK_ALIGNMENT, 1);
    gl.glReadPixels(0, 0, 64, 64, STENCIL_INDEX, UNSIGNED_BYTE, crate::gl::at_mut(&mut values));
    gl.glPopAttrib();
    // One value for each field of a grid of 8 x 8.
    for field in 0..64 {
        gl.note(values[(field / 8 * 8 + 3) * 64 + field % 8 * 8 + 3]);
    }
}

fn stencil_operations(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(STENCIL_TEST);
    gl.glEnable(DEPTH_TEST);
    let operations = [KEEP, ZERO, REPLACE, INCR, DECR, INVERT, INCR_WRAP, DECR_WRAP];
    for (j, start) in [0, 255, 0x5a].into_iter().enumerate() {
        gl.glEnable(SCISSOR_TEST);
        gl.glScissor(0, 16 * j as i32, 64, 16);
        gl.glClearStencil(start);
        gl.glClear(STENCIL_BUFFER_BIT);
        gl.glDisable(SCISSOR_TEST);
        for (i, operation) in operations.into_iter().enumerate() {
            gl.glColor3f(1.0, i as f32 / 8.0, j as f32 / 3.0);
            // Depth passes.
            gl.glStencilFunc(ALWAYS, 0x77, 0xff);
            gl.glStencilOp(KEEP, KEEP, operation);
            field(gl, i, 2 * j, 0.5);
            // Depth fails.
            gl.glStencilOp(KEEP, operation, KEEP);
            field(gl, i, 2 * j + 1, -1.5);
            field(gl, i, 2 * j + 1, 0.0);
            field(gl, i, 2 * j + 1, -0.5);
        }
    }
    // The stencil test fails.
    for (i, operation) in operations.into_iter().enumerate() {
        gl.glStencilFunc(NEVER, 0x42, 0xff);
        gl.glStencilOp(operation, KEEP, KEEP);
        field(gl, i, 6, 0.0);
    }
    show_stencil(gl);
}

fn stencil_mask(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(STENCIL_TEST);
    gl.glStencilOp(REPLACE, REPLACE, REPLACE);
    for (i, mask) in [0xff, 0x0f, 0xf0, 0x01, 0x80, 0].into_iter().enumerate() {
        gl.glStencilMask(mask);
        gl.glStencilFunc(ALWAYS, 0xa5, 0xff);
        field(gl, i, 0, 0.0);
        gl.glStencilFunc(ALWAYS, 0x5a, 0xff);
        field(gl, i, 0, 0.0);
    }
    gl.glStencilMask(0x3c);
    gl.glClearStencil(0xff);
    gl.glEnable(SCISSOR_TEST);
    gl.glScissor(0, 32, 64, 16);
    gl.glClear(STENCIL_BUFFER_BIT);
    gl.glDisable(SCISSOR_TEST);
    show_stencil(gl);
}

fn stencil_two_side(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(STENCIL_TEST);
    gl.glEnable(STENCIL_TEST_TWO_SIDE_EXT);
    gl.glActiveStencilFaceEXT(BACK);
    gl.glStencilFunc(ALWAYS, 3, 0xff);
    gl.glStencilOp(KEEP, KEEP, DECR_WRAP);
    gl.glActiveStencilFaceEXT(FRONT);
    gl.glStencilFunc(ALWAYS, 3, 0xff);
    gl.glStencilOp(KEEP, KEEP, INCR_WRAP);
    gl.glColor3f(1.0, 0.0, 0.0);
    gl.glRectf(0.0, 0.0, 40.0, 40.0);
    gl.glRectf(8.0, 8.0, 48.0, 48.0);
    gl.glColor3f(0.0, 0.0, 1.0);
    gl.glRectf(60.0, 60.0, 24.0, 24.0);
    gl.glRectf(60.0, 60.0, 32.0, 0.0);
    gl.glDisable(STENCIL_TEST_TWO_SIDE_EXT);
    show_stencil(gl);
}

fn stencil_outline(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(STENCIL_TEST);
    gl.glStencilFunc(ALWAYS, 1, 0xff);
    gl.glStencilOp(KEEP, KEEP, REPLACE);
    gl.glColor3f(0.2, 0.6, 1.0);
    sphere(gl, 1.2, 24, 16);
    gl.glStencilFunc(NOTEQUAL, 1, 0xff);
    gl.glColor3f(1.0, 0.9, 0.1);
    sphere(gl, 1.5, 24, 16);
}

/// Fragments that fail the alpha test leave stencil and depth as they are.
fn order_of_tests(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(ALPHA_TEST);
    gl.glAlphaFunc(GREATER, 0.5);
    gl.glEnable(STENCIL_TEST);
    gl.glEnable(DEPTH_TEST);
    gl.glStencilOp(INCR, INCR, INCR);
    for i in 0..8 {
        gl.glColor4f(1.0, 0.5, 0.0, i as f32 / 7.0);
        field(gl, i, 1, 0.2);
        gl.glColor4f(0.0, 0.5, 1.0, 1.0);
        field(gl, i, 1, 0.1);
        field(gl, i, 3, 0.1);
    }
    show_stencil(gl);
}
