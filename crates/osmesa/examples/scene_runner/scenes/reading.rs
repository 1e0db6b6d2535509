//! Reading pixels back: what the client gets is noted as numbers.

use super::*;
use crate::gl::at_mut;

pub(crate) const SCENES: &[Scene] = &[
    scene("read-formats", Close, formats),
    scene("read-packed", Close, packed),
    scene("read-pack", Rounded, pack),
    scene("read-outside", Rounded, outside),
    scene("read-transfer", Close, transfer),
    scene("read-depth-stencil", Close, depth_stencil),
];

fn picture(gl: &Gl) {
    pixels(gl);
    rainbow(gl, [0.0, 0.0, 64.0, 64.0], 0.0);
}

fn formats(gl: &mut Stage<'_>) {
    picture(gl);
    for format in [RED, GREEN, BLUE, ALPHA, RGB, BGR, RGBA, BGRA, LUMINANCE, LUMINANCE_ALPHA] {
        let mut floats = [0.0_f32; 16];
        gl.glReadPixels(10, 20, 2, 2, format, FLOAT, at_mut(&mut floats));
        gl.notes(&floats);
        let mut bytes = [0_u8; 16];
        gl.glReadPixels(40, 30, 2, 2, format, UNSIGNED_BYTE, at_mut(&mut bytes));
        gl.notes(&bytes.map(|b| f32::from(b) / 255.0));
        let mut shorts = [0_i16; 16];
        gl.glReadPixels(50, 50, 2, 2, format, SHORT, at_mut(&mut shorts));
        gl.notes(&shorts.map(|s| f32::from(s) / 32767.0));
        if matches!(format, LUMINANCE | LUMINANCE_ALPHA) {
            // Mesa's sums overflow there.
            continue;
        }
        let mut integers = [0_u32; 16];
        gl.glReadPixels(50, 50, 2, 2, format, UNSIGNED_INT, at_mut(&mut integers));
        gl.notes(&integers.map(|i| (f64::from(i) / 4294967295.0) as f32));
    }
}

fn packed(gl: &mut Stage<'_>) {
    pixels(gl);
    // Colours that every type can hold.
    for i in 0..8 {
        gl.glColor4f((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32, 1.0);
        gl.glRectf(i as f32, 0.0, i as f32 + 1.0, 64.0);
    }
    for (format, kind, bytes) in [
        (RGB, UNSIGNED_BYTE_3_3_2, 1),
        (RGB, UNSIGNED_BYTE_2_3_3_REV, 1),
        (RGB, UNSIGNED_SHORT_5_6_5, 2),
        (RGB, UNSIGNED_SHORT_5_6_5_REV, 2),
        (RGBA, UNSIGNED_SHORT_4_4_4_4, 2),
        (BGRA, UNSIGNED_SHORT_4_4_4_4_REV, 2),
        (RGBA, UNSIGNED_SHORT_5_5_5_1, 2),
        (BGRA, UNSIGNED_SHORT_1_5_5_5_REV, 2),
        (RGBA, UNSIGNED_INT_8_8_8_8, 4),
        (BGRA, UNSIGNED_INT_8_8_8_8_REV, 4),
        (RGBA, UNSIGNED_INT_10_10_10_2, 4),
        (BGRA, UNSIGNED_INT_2_10_10_10_REV, 4),
    ] {
        let mut data = [0_u8; 32];
        gl.glReadPixels(0, 3, 8, 1, format, kind, at_mut(&mut data));
        gl.notes(&data[..8 * bytes].iter().map(|b| f32::from(*b)).collect::<Vec<_>>());
    }
}

fn pack(gl: &mut Stage<'_>) {
    picture(gl);
    for (row, rows, skip, alignment, swap) in
        [(0, 0, 0, 4, 0), (9, 1, 2, 4, 0), (0, 0, 1, 8, 1), (5, 2, 0, 2, 1)]
    {
        gl.glPixelStorei(PACK_ROW_LENGTH, row);
        gl.glPixelStorei(PACK_SKIP_ROWS, rows);
        gl.glPixelStorei(PACK_SKIP_PIXELS, skip);
        gl.glPixelStorei(PACK_ALIGNMENT, alignment);
        gl.glPixelStorei(PACK_SWAP_BYTES, swap);
        let mut data = [77_u8; 240];
        gl.glReadPixels(20, 20, 5, 3, RGB, UNSIGNED_BYTE, at_mut(&mut data));
        gl.notes(&data.map(|b| f32::from(b) / 255.0));
        let mut data = [0x7777_u16; 120];
        gl.glReadPixels(20, 20, 3, 3, RED, UNSIGNED_SHORT, at_mut(&mut data));
        gl.notes(&data.map(|s| f32::from(s) / 65535.0));
    }
}

/// Pixels outside of the buffer leave the client's memory as it was.
fn outside(gl: &mut Stage<'_>) {
    picture(gl);
    let mut data = [99_u8; 8 * 8 * 4];
    gl.glReadPixels(-3, 59, 8, 8, RGBA, UNSIGNED_BYTE, at_mut(&mut data));
    for (i, pixel) in data.chunks_exact(4).enumerate() {
        if i % 8 >= 3 && i / 8 < 5 {
            gl.notes(&[pixel[0], pixel[1], pixel[2], pixel[3]].map(|b| f32::from(b) / 255.0));
        }
    }
}

fn transfer(gl: &mut Stage<'_>) {
    picture(gl);
    gl.glPixelTransferf(RED_SCALE, 0.5);
    gl.glPixelTransferf(GREEN_BIAS, 0.25);
    gl.glPixelTransferf(BLUE_SCALE, 2.0);
    gl.glPixelMapfv(PIXEL_MAP_R_TO_R, 4, &[1.0, 0.6, 0.3, 0.0]);
    gl.glPixelTransferi(MAP_COLOR, 1);
    let mut data = [[0.0_f32; 4]; 16];
    gl.glReadPixels(30, 30, 4, 4, RGBA, FLOAT, at_mut(&mut data));
    gl.notes(&data.map(|[r, g, _, a]| [r, g, 0.0, a]).concat());
}

fn depth_stencil(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glEnable(STENCIL_TEST);
    gl.glStencilOp(KEEP, KEEP, INCR);
    gl.glBegin(TRIANGLES);
    for (x, y, z) in [(0.0, 0.0, 0.8), (60.0, 0.0, -0.8), (20.0, 60.0, 0.0)] {
        gl.glVertex3f(x, y, z);
    }
    gl.glEnd();
    let mut floats = [0.0_f32; 16];
    gl.glReadPixels(20, 20, 4, 4, DEPTH_COMPONENT, FLOAT, at_mut(&mut floats));
    gl.notes(&floats);
    let mut shorts = [0_u16; 16];
    gl.glReadPixels(20, 20, 4, 4, DEPTH_COMPONENT, UNSIGNED_SHORT, at_mut(&mut shorts));
    gl.notes(&shorts.map(|s| f32::from(s) / 65535.0));
    let mut words = [0_u32; 16];
    gl.glReadPixels(20, 20, 4, 4, DEPTH_COMPONENT, UNSIGNED_INT, at_mut(&mut words));
    gl.notes(&words.map(|w| (f64::from(w) / 4294967295.0) as f32));
    gl.glPixelTransferf(DEPTH_SCALE, 0.5);
    gl.glPixelTransferf(DEPTH_BIAS, 0.25);
    gl.glReadPixels(20, 20, 4, 4, DEPTH_COMPONENT, FLOAT, at_mut(&mut floats));
    gl.notes(&floats);
    let mut stencils = [0_u8; 64];
    gl.glReadPixels(0, 20, 64, 1, STENCIL_INDEX, UNSIGNED_BYTE, at_mut(&mut stencils));
    gl.notes(&stencils.map(f32::from));
    gl.glPixelTransferf(DEPTH_SCALE, 1.0);
    gl.glPixelTransferf(DEPTH_BIAS, 0.0);
    gl.glReadPixels(20, 20, 4, 4, DEPTH_STENCIL_EXT, UNSIGNED_INT_24_8_EXT, at_mut(&mut words));
    gl.notes(&words.map(|w| (w >> 8) as f32 / 16777215.0));
    gl.notes(&words.map(|w| (w & 255) as f32));
}
