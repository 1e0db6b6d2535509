//! Polygons: kinds, facings, modes, offset, stipple, clipping, and where they go on the screen.

use super::*;
use crate::gl::at;

pub(crate) const SCENES: &[Scene] = &[
    scene("clear-scissored", Rounded, clear_scissored),
    scene("triangle-kinds", Close, triangle_kinds),
    scene("polygon-kinds", Close, polygon_kinds),
    scene("quad-ways", Close, quad_ways),
    scene("rect", Rounded, rect),
    scene("shade-flat", Close, shade_flat),
    scene("cull", Rounded, cull),
    scene("polygon-mode", Close, polygon_mode),
    scene("polygon-mode-faces", Close, polygon_mode_faces),
    scene("polygon-mode-clip-planes", Rounded, polygon_mode_clip_planes),
    scene("edge-flags", Close, edge_flags),
    scene("polygon-offset", Close, polygon_offset),
    scene("polygon-offset-edges", Close, polygon_offset_edges),
    scene("polygon-stipple", Rounded, polygon_stipple),
    scene("clip-planes", Close, clip_planes),
    scene("near-far-clip", Close, near_far_clip),
    scene("depth-clamp", Close, depth_clamp),
    scene("depth-clamp-beyond", Close, depth_clamp_beyond),
    scene("viewport", Close, viewport),
    scene("depth-range", Close, depth_range),
    scene("perspective-correct", Close, perspective_correct),
    scene("matrix-stacks", Close, matrix_stacks),
    scene("small-triangles", Close, small_triangles),
    scene("shared-edges", Rounded, shared_edges),
];

fn clear_scissored(gl: &mut Stage<'_>) {
    gl.glClearColor(0.2, 0.4, 0.6, 0.8);
    gl.glClear(COLOR_BUFFER_BIT);
    gl.glEnable(SCISSOR_TEST);
    for i in 0..6 {
        gl.glScissor(8 * i, 5 * i, 20, 12);
        gl.glClearColor(i as f32 / 6.0, 1.0, 0.0, 1.0);
        gl.glClearDepth(f64::from(i) / 10.0);
        gl.glColorMask(1, (i & 1) as u8, 1, 1);
        gl.glClear(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT);
    }
}

/// Five points with colours.
fn zigzag(gl: &Gl, y: f32) {
    for (i, x) in [4.3, 12.8, 24.2, 33.7, 45.1, 58.6].into_iter().enumerate() {
        gl.glColor3f(i as f32 / 5.0, (i % 2) as f32, 1.0 - i as f32 / 5.0);
        gl.glVertex2f(x, y + if i % 2 == 0 { 1.2 } else { 13.7 });
    }
}

fn triangle_kinds(gl: &mut Stage<'_>) {
    pixels(gl);
    for (mode, y) in [(TRIANGLES, 2.0), (TRIANGLE_STRIP, 22.0)] {
        gl.glBegin(mode);
        zigzag(gl, y);
        gl.glEnd();
    }
    gl.glBegin(TRIANGLE_FAN);
    for i in 0..9 {
        let angle = i as f32 * 0.35;
        gl.glColor3f(1.0, i as f32 / 8.0, 0.0);
        let far = if i == 0 { 0.0 } else { 20.0 };
        gl.glVertex2f(30.0 + far * angle.cos(), 42.0 + far * angle.sin());
    }
    gl.glEnd();
}

fn polygon_kinds(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glBegin(QUAD_STRIP);
    zigzag(gl, 2.0);
    gl.glEnd();
    rainbow(gl, [3.0, 20.0, 25.0, 60.0], 0.0);
    gl.glBegin(POLYGON);
    for i in 0..7 {
        let angle = i as f32 * 0.8976;
        gl.glColor3f(0.2, i as f32 / 6.0, 1.0);
        gl.glVertex2f(45.0 + 15.0 * angle.cos(), 40.0 + 15.0 * angle.sin());
    }
    gl.glEnd();
    // Left over vertices make nothing.
    gl.glBegin(QUADS);
    for i in 0..7 {
        gl.glVertex2f(28.0 + (i % 2) as f32 * 3.0, 25.0 + (i / 2) as f32);
    }
    gl.glEnd();
}

/// Quads whose colours are not linear show along which diagonal they are cut, which depends on how
/// they were sent.
fn quad_ways(gl: &mut Stage<'_>) {
    pixels(gl);
    let corners = |x: f32, y: f32| [[x, y], [x + 18.0, y], [x + 18.0, y + 18.0], [x, y + 18.0]];
    let colors: [[f32; 3]; 8] =
        std::array::from_fn(|i| [f32::from(i % 4 == 0), (i % 3) as f32 / 2.0, f32::from(i == 6)]);
    let send = |gl: &Gl, y: f32| {
        gl.glBegin(QUADS);
        for (place, color) in [corners(2.0, y), corners(22.0, y)].as_flattened().iter().zip(&colors)
        {
            gl.glColor3fv(color);
            gl.glVertex2f(place[0], place[1]);
        }
        gl.glEnd();
    };
    send(gl, 2.0);
    gl.glNewList(1, COMPILE);
    send(gl, 22.0);
    gl.glEndList();
    gl.glCallList(1);

    let places = [corners(42.0, 2.0), corners(42.0, 22.0)];
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glEnableClientState(COLOR_ARRAY);
    gl.glVertexPointer(2, FLOAT, 0, at(&places));
    gl.glColorPointer(3, FLOAT, 0, at(&colors));
    gl.glDrawArrays(QUADS, 0, 4);
    gl.glDrawElements(QUADS, 4, UNSIGNED_BYTE, at(&[4u8, 5, 6, 7]));
    gl.glPolygonMode(BACK, LINE);
    send(gl, 42.0);
}

fn rect(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glColor3f(1.0, 0.0, 0.0);
    gl.glRectf(3.0, 4.0, 20.0, 30.0);
    gl.glColor3f(0.0, 1.0, 0.0);
    gl.glRecti(60, 50, 40, 10);
    gl.glColor3f(0.0, 0.0, 1.0);
    gl.glRectdv(&[22.0, 33.0], &[35.0, 60.0]);
    gl.glColor3f(1.0, 1.0, 0.0);
    gl.glRects(25, 5, 30, 8);
}

fn shade_flat(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glShadeModel(FLAT);
    gl.glBegin(TRIANGLE_STRIP);
    zigzag(gl, 2.0);
    gl.glEnd();
    gl.glBegin(QUAD_STRIP);
    zigzag(gl, 20.0);
    gl.glEnd();
    rainbow(gl, [3.0, 40.0, 20.0, 60.0], 0.0);
    gl.glBegin(TRIANGLE_FAN);
    for (i, (x, y)) in
        [(25.0, 40.0), (40.0, 40.0), (38.0, 55.0), (24.0, 60.0)].into_iter().enumerate()
    {
        gl.glColor3f(1.0, i as f32 / 3.0, 0.0);
        gl.glVertex2f(x, y);
    }
    gl.glEnd();
    gl.glBegin(POLYGON);
    for (i, (x, y)) in
        [(45.0, 40.0), (60.0, 40.0), (61.0, 55.0), (50.0, 62.0)].into_iter().enumerate()
    {
        gl.glColor3f(0.0, i as f32 / 3.0, 1.0 - i as f32 / 3.0);
        gl.glVertex2f(x, y);
    }
    gl.glEnd();
}

fn cull(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(CULL_FACE);
    for (i, (mode, front)) in
        [(BACK, CCW), (BACK, CW), (FRONT, CCW), (FRONT, CW), (FRONT_AND_BACK, CCW)]
            .into_iter()
            .enumerate()
    {
        gl.glCullFace(mode);
        gl.glFrontFace(front);
        let y = 12.0 * i as f32 + 2.0;
        gl.glColor3f(1.0, 0.2 * i as f32, 0.0);
        gl.glRectf(2.0, y, 28.0, y + 9.0);
        gl.glColor3f(0.0, 0.2 * i as f32, 1.0);
        gl.glRectf(60.0, y, 34.0, y + 9.0);
    }
}

fn polygon_mode(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glPolygonMode(FRONT_AND_BACK, LINE);
    gl.glColor3f(1.0, 1.0, 0.0);
    gl.glPushMatrix();
    gl.glTranslatef(-0.8, 0.8, 0.0);
    gl.glRotatef(20.0, 1.0, 0.5, 0.0);
    sphere(gl, 0.9, 10, 6);
    gl.glPopMatrix();
    gl.glPolygonMode(FRONT_AND_BACK, POINT);
    gl.glPointSize(3.0);
    gl.glColor3f(0.0, 1.0, 1.0);
    gl.glTranslatef(0.8, -0.8, 0.0);
    sphere(gl, 0.9, 10, 6);
}

fn polygon_mode_faces(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glPolygonMode(FRONT, FILL);
    gl.glPolygonMode(BACK, LINE);
    gl.glBegin(TRIANGLES);
    gl.glColor3f(1.0, 0.5, 0.0);
    for (x, y) in [(4.5, 4.5), (40.5, 8.5), (20.5, 30.5), (24.5, 60.5), (60.5, 40.5), (30.5, 34.5)]
    {
        gl.glVertex2f(x, y);
    }
    gl.glEnd();
}

/// Edges along the planes of the user show. (Those along the view volume do, too, but not with
/// Mesa.)
fn polygon_mode_clip_planes(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glPolygonMode(FRONT_AND_BACK, LINE);
    for (plane, equation) in
        [(CLIP_PLANE0, [-1.0, -0.3, 0.0, 50.0]), (CLIP_PLANE0 + 3, [0.2, -1.0, 0.0, 45.0])]
    {
        gl.glClipPlane(plane, &equation);
        gl.glEnable(plane);
    }
    gl.glBegin(POLYGON);
    for (x, y, edge) in
        [(3.5, 3.5, 1), (60.5, 6.5, 0), (62.5, 50.5, 1), (30.5, 60.5, 1), (5.5, 40.5, 1)]
    {
        gl.glEdgeFlag(edge);
        gl.glColor3f(1.0, x / 64.0, y / 64.0);
        gl.glVertex2f(x, y);
    }
    gl.glEnd();
}

fn edge_flags(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glPolygonMode(FRONT_AND_BACK, LINE);
    for (mode, y) in [(TRIANGLES, 3.5), (QUADS, 23.5), (POLYGON, 43.5)] {
        gl.glBegin(mode);
        for (i, (dx, dy)) in
            [(3.5, 0.0), (28.5, 2.0), (18.5, 16.0), (40.5, 15.0), (35.5, 1.0), (60.5, 7.0)]
                .into_iter()
                .enumerate()
        {
            if mode != POLYGON || i < 5 {
                gl.glEdgeFlag(u8::from(i % 2 == 0));
                gl.glVertex2f(dx, y + dy);
            }
        }
        gl.glEnd();
    }
}

fn polygon_offset(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glDepthFunc(LESS);
    gl.glRotatef(35.0, 0.3, 1.0, 0.1);
    gl.glColor3f(0.3, 0.3, 1.0);
    gl.glEnable(POLYGON_OFFSET_FILL);
    gl.glPolygonOffset(1.0, 2.0);
    sphere(gl, 1.5, 12, 8);
    gl.glDisable(POLYGON_OFFSET_FILL);
    gl.glPolygonMode(FRONT_AND_BACK, LINE);
    gl.glColor3f(1.0, 1.0, 0.0);
    sphere(gl, 1.5, 12, 8);
    gl.glPolygonMode(FRONT_AND_BACK, FILL);
    gl.glEnable(POLYGON_OFFSET_FILL);
    // How much a unit is depends on the library.
    gl.glPolygonOffset(0.0, -5_000_000.0);
    gl.glDepthMask(0);
    gl.glColor3f(1.0, 0.0, 0.0);
    gl.glRectf(-0.3, -0.3, 0.3, 0.3);
}

/// Lines and points move by the slope of the polygon, not by their own.
fn polygon_offset_edges(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glDepthFunc(ALWAYS);
    gl.glPointSize(16.0);
    gl.glLineWidth(5.0);
    let modes =
        [(FILL, POLYGON_OFFSET_FILL), (LINE, POLYGON_OFFSET_LINE), (POINT, POLYGON_OFFSET_POINT)];
    for (i, (mode, enable)) in modes.into_iter().enumerate() {
        gl.glPolygonMode(FRONT_AND_BACK, mode);
        gl.glEnable(enable);
        gl.glPolygonOffset(1.5, 0.0);
        gl.glColor3f(0.3 + 0.3 * i as f32, 1.0, 0.0);
        let x = 1.3 * i as f32;
        gl.glBegin(TRIANGLES);
        for (dx, y, z) in [(-2.0, -2.0, 0.0), (-1.0, -2.0, 0.0), (-1.5, 2.0, -3.0)] {
            gl.glVertex3f(x + dx, y, z);
        }
        gl.glEnd();
    }
}

fn polygon_stipple(gl: &mut Stage<'_>) {
    pixels(gl);
    let pattern: [u8; 128] = std::array::from_fn(|i| match i / 4 % 8 {
        0..=3 => 0xf0,
        4 => (37 * i) as u8,
        _ => 0x33,
    });
    gl.glPolygonStipple(&pattern);
    gl.glEnable(POLYGON_STIPPLE);
    gl.glColor3f(1.0, 0.5, 0.2);
    gl.glRectf(3.0, 5.0, 61.0, 60.0);
    gl.glPixelStorei(UNPACK_LSB_FIRST, 1);
    gl.glPolygonStipple(&pattern);
    gl.glColor3f(0.0, 0.5, 1.0);
    gl.glRectf(20.0, 20.0, 50.0, 50.0);
    let mut back = [0; 128];
    gl.glPixelStorei(PACK_ALIGNMENT, 1);
    gl.glGetPolygonStipple(&mut back);
    gl.notes(&back.map(f32::from));
}

fn clip_planes(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glClipPlane(CLIP_PLANE0, &[1.0, 0.3, 0.0, 0.7]);
    gl.glEnable(CLIP_PLANE0);
    gl.glRotatef(40.0, 0.0, 1.0, 1.0);
    gl.glClipPlane(CLIP_PLANE0 + 1, &[0.0, -1.0, 0.2, 0.8]);
    gl.glEnable(CLIP_PLANE0 + 1);
    gl.glColor3f(1.0, 0.6, 0.1);
    sphere(gl, 1.5, 16, 10);
    let mut equation = [0.0; 4];
    gl.glGetClipPlane(CLIP_PLANE0 + 1, &mut equation);
    gl.notes(&equation.map(|c| c as f32));
    gl.glLineWidth(2.0);
    gl.glColor3f(0.0, 1.0, 0.0);
    gl.glBegin(LINES);
    gl.glVertex3f(-2.0, -2.0, 1.5);
    gl.glVertex3f(2.0, 2.0, 1.5);
    gl.glEnd();
}

fn near_far_clip(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    for (i, turn) in [0.0_f32, 60.0, 120.0].into_iter().enumerate() {
        gl.glPushMatrix();
        gl.glRotatef(turn, 0.0, 0.0, 1.0);
        rainbow_floor(gl, i as f32 * 0.3);
        gl.glPopMatrix();
    }
}

/// A floor from behind the eye to behind the far plane.
fn rainbow_floor(gl: &Gl, shade: f32) {
    gl.glBegin(QUADS);
    for (i, (x, z)) in
        [(-4.0, 9.0), (4.0, 9.0), (4.0, -20.0), (-4.0, -20.0)].into_iter().enumerate()
    {
        gl.glColor3f(shade, f32::from(u8::from(i == 1 || i == 2)), (i / 2) as f32);
        gl.glVertex3f(x, -1.0, z);
    }
    gl.glEnd();
}

fn depth_clamp(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glDepthFunc(LEQUAL);
    gl.glEnable(DEPTH_CLAMP);
    rainbow_floor(gl, 0.5);
}

/// Primitives that lie wholly beyond the far plane, or before the near one.
fn depth_clamp_beyond(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glDepthFunc(LEQUAL);
    gl.glEnable(DEPTH_CLAMP);
    gl.glPointSize(5.0);
    gl.glLineWidth(3.0);
    for (z, color) in [(-20.0, [0.2, 0.9, 0.4]), (3.5, [0.9, 0.3, 0.6])] {
        gl.glColor3fv(&color);
        let size = 0.4 * (4.0 - z);
        for (primitive, x) in [(TRIANGLES, -1.0), (LINES, 0.1), (POINTS, 0.6)] {
            gl.glBegin(primitive);
            for (dx, y) in [(0.0, -0.8), (0.6, -0.1), (0.3, 0.7)]
                .into_iter()
                .take(if primitive == LINES { 2 } else { 3 })
            {
                gl.glVertex3f((x + dx) * size, y * size, z);
            }
            gl.glEnd();
        }
    }
}

fn viewport(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glViewport(5, 10, 30, 40);
    gl.glColor3f(1.0, 0.0, 0.0);
    sphere(gl, 1.8, 12, 8);
    gl.glViewport(30, -20, 60, 60);
    rainbow(gl, [-1.5, -1.5, 1.5, 1.5], 0.0);
    gl.glViewport(-10, 45, 40, 40);
    rainbow(gl, [-1.5, -1.5, 1.5, 1.5], 0.0);
    gl.note_floats::<4>(VIEWPORT);
}

fn depth_range(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glDepthRange(0.5, 0.75);
    gl.glColor3f(0.2, 1.0, 0.2);
    sphere(gl, 1.5, 16, 10);
    gl.glDepthRange(1.0, 0.0);
    gl.glDepthFunc(LESS);
    gl.glColor3f(1.0, 0.2, 0.2);
    gl.glTranslatef(0.8, 0.3, 0.0);
    sphere(gl, 1.2, 16, 10);
    gl.glDepthRange(-3.0, 5.0);
    gl.note_floats::<2>(DEPTH_RANGE);
}

fn perspective_correct(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glRotatef(-70.0, 1.0, 0.2, 0.0);
    gl.glScalef(2.2, 4.0, 1.0);
    rainbow(gl, [-1.0, -1.0, 1.0, 1.0], 0.0);
}

fn matrix_stacks(gl: &mut Stage<'_>) {
    camera(gl);
    for i in 0..4 {
        gl.glPushMatrix();
        gl.glRotatef(90.0 * i as f32 + 15.0, 0.0, 0.0, 1.0);
        gl.glTranslatef(1.0, 0.0, 0.0);
        gl.glMultMatrixf(&[
            1.0, 0.2, 0.0, 0.0, -0.1, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.1, 0.0, 0.0, 1.0,
        ]);
        gl.glScalef(0.6, 0.4, 1.0);
        rainbow(gl, [-1.0, -1.0, 1.0, 1.0], 0.0);
        gl.note_floats::<16>(MODELVIEW_MATRIX);
        gl.glPopMatrix();
    }
    gl.note_floats::<1>(MODELVIEW_STACK_DEPTH);
    gl.note_floats::<16>(PROJECTION_MATRIX);
    gl.glLoadTransposeMatrixf(&[
        0.3, 0.0, 0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0, 1.0, -4.0, 0.0, 0.0, 0.0, 1.0,
    ]);
    gl.note_floats::<16>(TRANSPOSE_MODELVIEW_MATRIX);
    rainbow(gl, [-1.0, -1.0, 1.0, 1.0], 0.0);
}

fn small_triangles(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glEnable(LIGHTING);
    gl.glEnable(LIGHT0);
    sphere(gl, 1.6, 120, 80);
}

/// Every pixel of a fan is drawn once: sums of colour show gaps and overlaps.
fn shared_edges(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(BLEND);
    gl.glBlendFunc(ONE, ONE);
    gl.glColor4f(0.25, 0.25, 0.25, 0.25);
    gl.glBegin(TRIANGLES);
    for i in 0..16 {
        let corner = |i: i32| {
            let i = i.rem_euclid(16);
            let along = (i % 4) as f32 * 16.0;
            match i / 4 {
                0 => (along, 0.0),
                1 => (64.0, along),
                2 => (64.0 - along, 64.0),
                _ => (0.0, 64.0 - along),
            }
        };
        gl.glVertex2f(27.3, 33.8);
        for (x, y) in [corner(i), corner(i + 1)] {
            gl.glVertex2f(x, y);
        }
    }
    gl.glEnd();
}
