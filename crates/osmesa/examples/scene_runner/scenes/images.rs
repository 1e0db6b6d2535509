//! Pixel rectangles and bitmaps.

use super::*;
use crate::gl::at;

pub(crate) const SCENES: &[Scene] = &[
    scene("draw-pixels", Rounded, draw_pixels),
    scene("draw-pixels-formats", Close, formats),
    scene("draw-pixels-index", Rounded, index),
    scene("draw-pixels-zoom", Close, zoom),
    scene("draw-pixels-transfer", Close, transfer),
    scene("draw-pixels-maps", Close, maps),
    scene("draw-pixels-clipped", Rounded, clipped),
    scene("draw-pixels-depth", Close, depth),
    scene("draw-pixels-stencil", Rounded, stencil),
    scene("draw-pixels-textured", Close, textured_image),
    scene("copy-pixels", Rounded, copy),
    scene("copy-pixels-zoom", Rounded, copy_zoom),
    scene("copy-pixels-depth-stencil", Close, copy_depth_stencil),
    scene("bitmap", Rounded, bitmap),
    scene("bitmap-font", Rounded, font),
    scene("raster-position", Close, raster_position),
    scene("window-position", Rounded, window_position),
];

fn draw_pixels(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glRasterPos2i(5, 7);
    gl.glDrawPixels(16, 16, RGBA, UNSIGNED_BYTE, at(&checks(16, 4)));
    gl.glRasterPos2f(30.7, 20.2);
    gl.glDrawPixels(12, 12, BGRA, UNSIGNED_BYTE, at(&checks(12, 2)));
    gl.glRasterPos2i(50, 50);
    gl.glDrawPixels(16, 16, RGBA, UNSIGNED_BYTE, at(&checks(16, 1)));
    gl.note_floats::<4>(CURRENT_RASTER_POSITION);
}

fn formats(gl: &mut Stage<'_>) {
    pixels(gl);
    let bytes: Vec<u8> = (0..=255).collect();
    let shorts: Vec<i16> = (0..64).map(|i| i * 511).collect();
    let floats: Vec<f32> = (0..64).map(|i| i as f32 / 50.0 - 0.1).collect();
    let list = [RED, GREEN, BLUE, ALPHA, LUMINANCE, LUMINANCE_ALPHA, RGB, BGR, RGBA, BGRA];
    for (i, format) in list.into_iter().enumerate() {
        let kinds = [
            (UNSIGNED_BYTE, at(&bytes)),
            (BYTE, at(&bytes)),
            (SHORT, at(&shorts)),
            (FLOAT, at(&floats)),
            (UNSIGNED_INT, at(&bytes)),
        ];
        for (j, (kind, data)) in kinds.into_iter().enumerate() {
            gl.glRasterPos2i(6 * i as i32 + 1, 12 * j as i32 + 1);
            gl.glDrawPixels(4, 4, format, kind, data);
        }
    }
}

fn index(gl: &mut Stage<'_>) {
    pixels(gl);
    for (map, values) in [
        (PIXEL_MAP_I_TO_R, [0.0, 1.0, 0.5, 0.2]),
        (PIXEL_MAP_I_TO_G, [1.0, 0.0, 0.5, 0.8]),
        (PIXEL_MAP_I_TO_B, [0.2, 0.4, 0.6, 0.8]),
        (PIXEL_MAP_I_TO_A, [1.0, 1.0, 0.5, 1.0]),
    ] {
        gl.glPixelMapfv(map, 4, &values);
    }
    let indices: Vec<u8> = (0..64).map(|i| i % 7).collect();
    gl.glRasterPos2i(4, 4);
    gl.glDrawPixels(8, 8, COLOR_INDEX, UNSIGNED_BYTE, at(&indices));
}

/// No centre lies on a border where the image runs backwards: Mesa takes it for the wrong pixel's
/// there.
fn zoom(gl: &mut Stage<'_>) {
    pixels(gl);
    let image = checks(8, 2);
    for (x, y, zx, zy) in [
        (2, 2, 2.0, 3.0),
        (60, 4, -2.4, 1.5),
        (4, 60, 0.5, -3.0),
        (62, 62, -3.0, -3.0),
        (26, 34, 1.3, 0.7),
    ] {
        gl.glRasterPos2i(x, y);
        gl.glPixelZoom(zx, zy);
        gl.glDrawPixels(8, 8, RGBA, UNSIGNED_BYTE, at(&image));
    }
}

fn transfer(gl: &mut Stage<'_>) {
    pixels(gl);
    let image = checks(16, 4);
    for (i, (scale, bias)) in
        [(0.5, 0.0), (1.0, 0.3), (-1.0, 1.0), (2.0, -0.5)].into_iter().enumerate()
    {
        gl.glPixelTransferf([RED_SCALE, GREEN_SCALE, BLUE_SCALE, RED_SCALE][i], scale);
        gl.glPixelTransferf([RED_BIAS, GREEN_BIAS, BLUE_BIAS, ALPHA_BIAS][i], bias);
        gl.glRasterPos2i(2 + 31 * (i as i32 % 2), 2 + 31 * (i as i32 / 2));
        gl.glPixelZoom(1.8, 1.8);
        gl.glDrawPixels(16, 16, RGBA, UNSIGNED_BYTE, at(&image));
    }
}

/// Red and green alone: Mesa looks up the others wrongly.
fn maps(gl: &mut Stage<'_>) {
    pixels(gl);
    // As many entries as colours: libraries find others in different ways.
    let red: Vec<f32> = (0..256).map(|i| (i * 37 % 256) as f32 / 255.0).collect();
    let green: Vec<u16> = (0..256).map(|i| 65535 - 257 * i).collect();
    gl.glPixelMapfv(PIXEL_MAP_R_TO_R, 256, &red);
    gl.glPixelMapusv(PIXEL_MAP_G_TO_G, 256, &green);
    gl.glPixelTransferi(MAP_COLOR, 1);
    let image: Vec<[u8; 4]> = (0..256).map(|i| [i as u8, 255 - i as u8, 0, 255]).collect();
    gl.glColorMask(1, 1, 0, 0);
    gl.glRasterPos2i(2, 2);
    gl.glPixelZoom(3.0, 3.0);
    gl.glDrawPixels(16, 16, RGBA, UNSIGNED_BYTE, at(&image));
    let mut back = [0.0; 256];
    gl.glGetPixelMapfv(PIXEL_MAP_R_TO_R, &mut back);
    gl.notes(&back);
}

fn clipped(gl: &mut Stage<'_>) {
    pixels(gl);
    let image = checks(32, 4);
    gl.glWindowPos2i(-10, -5);
    gl.glDrawPixels(32, 32, RGBA, UNSIGNED_BYTE, at(&image));
    gl.glWindowPos2i(50, 45);
    gl.glDrawPixels(32, 32, RGBA, UNSIGNED_BYTE, at(&image));
    gl.glEnable(SCISSOR_TEST);
    gl.glScissor(30, 10, 9, 11);
    gl.glWindowPos2i(25, 5);
    gl.glDrawPixels(32, 32, RGBA, UNSIGNED_BYTE, at(&image));
}

fn depth(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glDepthFunc(ALWAYS);
    gl.glColor3f(0.0, 0.5, 1.0);
    let depths: Vec<f32> = (0..1024).map(|i| (i % 32) as f32 / 31.0).collect();
    gl.glRasterPos2i(4, 4);
    gl.glDrawPixels(32, 32, DEPTH_COMPONENT, FLOAT, at(&depths));
    let shorts: Vec<u16> = (0..256).map(|i| i * 257).collect();
    gl.glRasterPos2i(40, 40);
    gl.glDrawPixels(16, 16, DEPTH_COMPONENT, UNSIGNED_SHORT, at(&shorts));
    gl.glDepthFunc(LESS);
    gl.glColor3f(1.0, 0.8, 0.0);
    gl.glBegin(QUADS);
    for (x, y, z) in [(0.0, 0.0, 0.9), (64.0, 0.0, -0.9), (64.0, 64.0, -0.9), (0.0, 64.0, 0.9)] {
        gl.glVertex3f(x, y, z);
    }
    gl.glEnd();
}

fn stencil(gl: &mut Stage<'_>) {
    pixels(gl);
    let values: Vec<u8> = (0..=255).collect();
    gl.glStencilMask(0x7f);
    gl.glRasterPos2i(8, 8);
    gl.glPixelZoom(2.0, 2.0);
    gl.glDrawPixels(16, 16, STENCIL_INDEX, UNSIGNED_BYTE, at(&values));
    gl.glEnable(STENCIL_TEST);
    for i in 0..8 {
        gl.glStencilFunc(EQUAL, 1 << i, 1 << i);
        gl.glColor3f(i as f32 / 8.0, 1.0 - i as f32 / 8.0, (i % 2) as f32);
        gl.glRectf(8.0 * i as f32, 0.0, 8.0 * i as f32 + 8.0, 64.0);
    }
}

/// Images are textured with the raster position's coordinates.
fn textured_image(gl: &mut Stage<'_>) {
    pixels(gl);
    texture_images::plain(gl, 4, &[[128, 255, 64, 255]; 16]);
    gl.glEnable(TEXTURE_2D);
    gl.glTexCoord2f(0.5, 0.5);
    gl.glRasterPos2i(10, 10);
    gl.glDrawPixels(32, 32, RGBA, UNSIGNED_BYTE, at(&checks(32, 4)));
    gl.glEnable(BLEND);
    gl.glBlendFunc(ONE, ONE);
    gl.glRasterPos2i(30, 30);
    gl.glDrawPixels(32, 32, RGBA, UNSIGNED_BYTE, at(&checks(32, 8)));
}

fn copy(gl: &mut Stage<'_>) {
    pixels(gl);
    rainbow(gl, [0.0, 0.0, 30.0, 30.0], 0.0);
    gl.glRasterPos2i(32, 32);
    gl.glCopyPixels(2, 2, 28, 28, COLOR);
    // Overlapping.
    gl.glRasterPos2i(10, 14);
    gl.glCopyPixels(0, 0, 25, 25, COLOR);
    // Partly outside.
    gl.glRasterPos2i(40, 2);
    gl.glCopyPixels(-5, 50, 20, 20, COLOR);
}

fn copy_zoom(gl: &mut Stage<'_>) {
    pixels(gl);
    rainbow(gl, [0.0, 0.0, 16.0, 16.0], 0.0);
    gl.glPixelZoom(2.0, 2.0);
    gl.glRasterPos2i(20, 20);
    gl.glCopyPixels(0, 0, 16, 16, COLOR);
    gl.glPixelZoom(-1.0, -1.0);
    gl.glRasterPos2i(62, 18);
    gl.glCopyPixels(0, 0, 16, 16, COLOR);
}

fn copy_depth_stencil(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glEnable(STENCIL_TEST);
    gl.glStencilFunc(ALWAYS, 5, 0xff);
    gl.glStencilOp(KEEP, KEEP, REPLACE);
    gl.glBegin(TRIANGLES);
    for (x, y, z) in [(0.0, 0.0, 0.8), (30.0, 0.0, -0.8), (10.0, 30.0, 0.0)] {
        gl.glVertex3f(x, y, z);
    }
    gl.glEnd();
    gl.glColor3f(0.0, 0.3, 0.0);
    gl.glDepthFunc(ALWAYS);
    gl.glDisable(STENCIL_TEST);
    gl.glRasterPos2i(32, 32);
    gl.glCopyPixels(0, 0, 30, 30, DEPTH);
    gl.glCopyPixels(0, 0, 30, 30, STENCIL);
    gl.glEnable(STENCIL_TEST);
    gl.glStencilFunc(EQUAL, 5, 0xff);
    gl.glDepthFunc(LESS);
    gl.glColor3f(1.0, 0.0, 0.0);
    gl.glRectf(0.0, 0.0, 64.0, 64.0);
}

const LETTER: [u8; 8] = [0x18, 0x3c, 0x66, 0xc3, 0xff, 0xc3, 0xc3, 0x81];

fn bitmap(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glPixelStorei(UNPACK_ALIGNMENT, 1);
    for i in 0..5 {
        gl.glColor3f(1.0, i as f32 / 5.0, 0.0);
        gl.glRasterPos2f(3.0 + 12.0 * i as f32, 5.0 + 7.3 * i as f32);
        // The current colour is not the raster position's.
        gl.glColor3f(0.0, 0.0, 1.0);
        gl.glBitmap(8, 8, i as f32, 2.0, 9.0, 1.0, &LETTER);
        gl.glBitmap(6, 8, 0.0, 0.0, 0.0, 0.0, &LETTER);
    }
    gl.note_floats::<4>(CURRENT_RASTER_POSITION);
    gl.note_floats::<4>(CURRENT_RASTER_COLOR);
}

/// Letters in display lists, as toolkits do it.
fn font(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glPixelStorei(UNPACK_ALIGNMENT, 1);
    let base = gl.glGenLists(128);
    for letter in 0..26 {
        gl.glNewList(base + 65 + letter, COMPILE);
        let rows = LETTER.map(|row| row.rotate_left(letter % 8) ^ letter as u8);
        gl.glBitmap(8, 8, 0.0, 0.0, 7.0, 0.0, &rows);
        gl.glEndList();
    }
    gl.glListBase(base);
    for (y, text) in [(4, "VITRAL"), (20, "OPENGL"), (36, "ABCDEFGH")] {
        gl.glColor3f(0.2, 1.0, y as f32 / 40.0);
        gl.glRasterPos2i(3, y);
        gl.glCallLists(text.len() as i32, UNSIGNED_BYTE, at(text.as_bytes()));
    }
    gl.note_floats::<4>(CURRENT_RASTER_POSITION);
}

fn raster_position(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(LIGHTING);
    gl.glEnable(LIGHT0);
    gl.glNormal3f(0.3, 0.2, 1.0);
    let positions =
        [[0.0, 0.0, 0.0], [1.0, 0.5, -1.0], [3.5, 0.0, 0.0], [0.0, 0.0, 5.0], [-1.0, -0.7, 2.0]];
    for position in positions {
        gl.glRasterPos3fv(&position);
        gl.note_floats::<1>(CURRENT_RASTER_POSITION_VALID);
        let mut valid = [0];
        gl.glGetIntegerv(CURRENT_RASTER_POSITION_VALID, &mut valid);
        if valid[0] != 0 {
            gl.note_floats::<4>(CURRENT_RASTER_POSITION);
            gl.note_floats::<4>(CURRENT_RASTER_COLOR);
        }
        gl.glDrawPixels(8, 8, RGBA, UNSIGNED_BYTE, at(&checks(8, 2)));
    }
}

fn window_position(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glDepthFunc(ALWAYS);
    for (x, y, z) in [(4.0, 4.0, 0.25), (30.0, 20.0, 0.5), (45.0, 40.0, 1.5), (10.0, 44.0, -1.0)] {
        gl.glColor3f(x / 64.0, y / 64.0, 0.5);
        gl.glWindowPos3f(x, y, z);
        gl.glBitmap(8, 8, 0.0, 0.0, 0.0, 0.0, &[0xff; 32]);
        gl.note_floats::<4>(CURRENT_RASTER_POSITION);
    }
    gl.glWindowPos2i(50, 4);
    gl.note_floats::<4>(CURRENT_RASTER_POSITION);
}
