//! Fog.

use super::*;

pub(crate) const SCENES: &[Scene] = &[
    scene("fog-linear", Close, linear),
    scene("fog-exp", Close, exp),
    scene("fog-exp2", Close, exp2),
    scene("fog-coordinate", Close, coordinate),
];

/// Rows of squares that go away from the eye, a line and some points between them.
fn alley(gl: &Gl) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glEnable(FOG);
    gl.glFogfv(FOG_COLOR, &[0.5, 0.6, 0.7, 1.0]);
    for i in 0..6 {
        let z = 2.5 - 1.5 * i as f32;
        gl.glColor3f(1.0, 0.2, 0.2);
        gl.glRectf(0.0, 0.0, 0.0, 0.0);
        gl.glBegin(QUADS);
        for (x, y) in [(-1.5, -1.0), (-0.5, -1.0), (-0.5, 1.0), (-1.5, 1.0)] {
            gl.glVertex3f(x, y, z);
        }
        gl.glEnd();
    }
    gl.glColor3f(0.0, 0.0, 0.0);
    gl.glBegin(QUADS);
    for (x, z) in [(-3.0, 2.9), (3.0, 2.9), (3.0, -5.9), (-3.0, -5.9)] {
        gl.glVertex3f(x, -1.0, z);
    }
    gl.glEnd();
    gl.glLineWidth(3.0);
    gl.glColor3f(1.0, 1.0, 0.0);
    gl.glBegin(LINES);
    gl.glVertex3f(0.3, 0.0, 2.9);
    gl.glVertex3f(1.5, 1.5, -5.5);
    gl.glEnd();
    gl.glPointSize(4.0);
    gl.glBegin(POINTS);
    for i in 0..8 {
        gl.glVertex3f(0.9, 0.0, 2.0 - i as f32);
    }
    gl.glEnd();
}

fn linear(gl: &mut Stage<'_>) {
    gl.glFogi(FOG_MODE, LINEAR as i32);
    gl.glFogf(FOG_START, 2.0);
    gl.glFogf(FOG_END, 9.0);
    alley(gl);
}

fn exp(gl: &mut Stage<'_>) {
    gl.glFogf(FOG_DENSITY, 0.3);
    alley(gl);
    gl.note_floats::<1>(FOG_MODE);
}

fn exp2(gl: &mut Stage<'_>) {
    gl.glFogf(FOG_MODE, EXP2 as f32);
    gl.glFogf(FOG_DENSITY, 0.2);
    alley(gl);
}

fn coordinate(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(FOG);
    gl.glFogi(FOG_MODE, LINEAR as i32);
    gl.glFogi(FOG_COORD_SRC, FOG_COORD as i32);
    gl.glFogf(FOG_END, 2.0);
    gl.glFogfv(FOG_COLOR, &[1.0, 1.0, 0.0, 0.0]);
    gl.glColor4f(0.0, 0.2, 1.0, 0.5);
    gl.glBegin(QUADS);
    for (x, y, fog) in [(4.0, 4.0, 0.0), (60.0, 4.0, 1.0), (60.0, 60.0, 2.3), (4.0, 60.0, 1.3)] {
        gl.glFogCoordf(fog);
        gl.glVertex2f(x, y);
    }
    gl.glEnd();
    gl.note_floats::<1>(CURRENT_FOG_COORD);
}
