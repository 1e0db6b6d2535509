//! Points and lines.

use super::*;

pub(crate) const SCENES: &[Scene] = &[
    scene("points", Rounded, points),
    scene("point-sizes", Close, point_sizes),
    scene("point-attenuation", Close, point_attenuation),
    scene("point-sprites", Close, point_sprites),
    scene("line-kinds", Close, line_kinds),
    scene("line-widths", Close, line_widths),
    scene("line-stipple", Close, line_stipple),
    scene("lines-clipped", Close, lines_clipped),
    scene("lines-shaded", Close, lines_shaded),
];

fn points(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glBegin(POINTS);
    for i in 0..64 {
        let i = i as f32;
        gl.glColor3f(i / 64.0, 1.0 - i / 64.0, 0.5);
        gl.glVertex2f(i + 0.5, i * 0.75 + 0.25);
        gl.glVertex2f(i * 0.5 + 0.25, 60.5 - i * 0.5);
    }
    gl.glEnd();
}

fn point_sizes(gl: &mut Stage<'_>) {
    pixels(gl);
    for (i, size) in [1.0, 2.0, 3.0, 4.5, 7.0, 10.0, 15.0].into_iter().enumerate() {
        gl.glPointSize(size);
        gl.glBegin(POINTS);
        gl.glColor3f(1.0, i as f32 / 7.0, 0.0);
        gl.glVertex2f(9.0 * i as f32 + 5.3, 20.0 + 3.0 * i as f32);
        gl.glColor3f(0.0, i as f32 / 7.0, 1.0);
        gl.glVertex2f(9.0 * i as f32 + 5.0, 50.0);
        gl.glEnd();
    }
}

fn point_attenuation(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glPointSize(16.0);
    gl.glPointParameterfv(POINT_DISTANCE_ATTENUATION, &[0.0, 0.5, 0.1]);
    gl.glPointParameterf(POINT_SIZE_MIN, 3.0);
    gl.glBegin(POINTS);
    for i in 0..8 {
        let i = i as f32;
        gl.glColor3f(1.0, i / 8.0, 0.2);
        gl.glVertex3f(-1.5 + 0.4 * i, -1.0 + 0.3 * i, 2.0 - i);
    }
    gl.glEnd();
}

fn point_sprites(gl: &mut Stage<'_>) {
    pixels(gl);
    texture_images::plain(gl, 16, &checks(16, 4));
    gl.glEnable(TEXTURE_2D);
    gl.glEnable(POINT_SPRITE_ARB);
    gl.glTexEnvi(POINT_SPRITE_ARB, COORD_REPLACE_ARB, 1);
    gl.glPointSize(20.0);
    gl.glBegin(POINTS);
    gl.glColor3f(1.0, 1.0, 1.0);
    gl.glVertex2f(16.0, 16.0);
    gl.glColor3f(1.0, 0.5, 0.0);
    gl.glVertex2f(46.0, 40.0);
    gl.glEnd();
    gl.glDisable(POINT_SPRITE_ARB);
    gl.glTexCoord2f(0.9, 0.1);
    gl.glBegin(POINTS);
    gl.glVertex2f(14.0, 50.0);
    gl.glEnd();
}

fn line_kinds(gl: &mut Stage<'_>) {
    pixels(gl);
    for (mode, y) in [(LINES, 2.25), (LINE_STRIP, 22.25), (LINE_LOOP, 42.25)] {
        gl.glBegin(mode);
        for (i, (dx, dy)) in [(3.2, 0.3), (20.3, 14.1), (35.7, 3.3), (50.2, 17.4), (60.9, 2.8)]
            .into_iter()
            .enumerate()
        {
            gl.glColor3f(1.0 - i as f32 * 0.2, i as f32 * 0.2, 1.0);
            gl.glVertex2f(dx, y + dy);
        }
        gl.glEnd();
    }
}

fn line_widths(gl: &mut Stage<'_>) {
    pixels(gl);
    for (i, width) in [1.0, 2.0, 3.0, 5.0, 8.0].into_iter().enumerate() {
        gl.glLineWidth(width);
        let at = 6.3 + 11.0 * i as f32;
        gl.glBegin(LINES);
        gl.glColor3f(1.0, 0.8, 0.2 * i as f32);
        gl.glVertex2f(4.2, at);
        gl.glVertex2f(30.7, at + 4.0);
        gl.glColor3f(0.2 * i as f32, 0.8, 1.0);
        gl.glVertex2f(34.3 + 5.0 * i as f32, 5.2);
        gl.glVertex2f(36.3 + 5.0 * i as f32, 60.6);
        gl.glEnd();
    }
}

fn line_stipple(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(LINE_STIPPLE);
    for (i, (factor, pattern)) in
        [(1, 0x00ff), (1, 0xaaaa), (3, 0x5555), (2, 0xf0f1), (5, 0x1c47)].into_iter().enumerate()
    {
        gl.glLineStipple(factor, pattern);
        let y = 4.5 + 10.0 * i as f32;
        gl.glBegin(LINE_STRIP);
        gl.glColor3f(1.0, 1.0, 0.2 * i as f32);
        gl.glVertex2f(2.5, y);
        gl.glVertex2f(40.5, y);
        gl.glVertex2f(61.5, y + 9.0);
        gl.glEnd();
    }
    gl.glLineWidth(3.0);
    gl.glLineStipple(4, 0x3333);
    gl.glBegin(LINES);
    gl.glVertex2f(2.5, 58.5);
    gl.glVertex2f(62.5, 58.5);
    gl.glEnd();
}

fn lines_clipped(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glBegin(LINES);
    for i in 0..12 {
        let angle = i as f32 * 0.52 + 0.1;
        gl.glColor3f(1.0, 1.0, 0.0);
        gl.glVertex3f(0.1 * angle.cos(), 0.1 * angle.sin(), -3.0);
        gl.glColor3f(0.0, 0.3, 1.0);
        gl.glVertex3f(30.0 * angle.cos(), 30.0 * angle.sin(), 6.0);
    }
    gl.glEnd();
}

fn lines_shaded(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glRotatef(30.0, 1.0, 1.0, 0.0);
    for model in [SMOOTH, FLAT] {
        gl.glShadeModel(model);
        gl.glScalef(0.7, 0.7, 0.7);
        gl.glBegin(LINE_STRIP);
        for i in 0..120 {
            let t = i as f32 * 0.2;
            gl.glColor3f(0.5 + 0.5 * t.sin(), 0.5 + 0.5 * t.cos(), 0.5);
            gl.glVertex3f(1.7 * t.cos(), -1.5 + t * 0.12, 1.7 * t.sin());
        }
        gl.glEnd();
    }
}
