//! Vertex arrays and buffer objects.

use super::*;
use crate::gl::{at, at_mut};

pub(crate) const SCENES: &[Scene] = &[
    scene("array-types", Close, types),
    scene("array-element", Close, element),
    scene("array-elements", Close, elements),
    scene("array-multi", Rounded, multi),
    scene("array-interleaved", Close, interleaved),
    scene("array-attributes", Close, attributes),
    scene("array-lit-sphere", Close, lit_sphere),
    scene("buffer-objects", Close, buffer_objects),
    scene("buffer-map", Rounded, buffer_map),
    scene("buffer-changed-after-draw", Rounded, buffer_changed),
    scene("vertex-array-objects", Rounded, vertex_array_objects),
    scene("immediate-types", Close, immediate_types),
];

fn types(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glEnableClientState(COLOR_ARRAY);
    let colors: [[u8; 4]; 3] = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]];
    gl.glColorPointer(4, UNSIGNED_BYTE, 0, at(&colors));
    let shorts: [[i16; 2]; 3] = [[2, 2], [28, 2], [15, 25]];
    gl.glVertexPointer(2, SHORT, 0, at(&shorts));
    gl.glDrawArrays(TRIANGLES, 0, 3);
    let integers: [[i32; 3]; 3] = [[34, 2, 0], [60, 2, 0], [47, 25, 0]];
    let colors: [[u16; 3]; 3] = [[65535, 0, 0], [0, 65535, 30000], [0, 20000, 65535]];
    gl.glVertexPointer(3, INT, 0, at(&integers));
    gl.glColorPointer(3, UNSIGNED_SHORT, 0, at(&colors));
    gl.glDrawArrays(TRIANGLES, 0, 3);
    let doubles: [[f64; 4]; 3] =
        [[4.0, 68.0, 0.0, 2.0], [28.0, 34.0, 0.0, 1.0], [7.0, 27.0, 0.0, 0.5]];
    let colors: [[f64; 3]; 3] = [[1.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0]];
    gl.glVertexPointer(4, DOUBLE, 0, at(&doubles));
    gl.glColorPointer(3, DOUBLE, 0, at(&colors));
    gl.glDrawArrays(TRIANGLES, 0, 3);
    let floats: [[f32; 5]; 3] =
        [[34.0, 34.0, 0.2, 0.4, 0.6], [60.0, 34.0, 1.0, 0.4, 0.1], [47.0, 60.0, 0.5, 1.0, 1.0]];
    gl.glVertexPointer(2, FLOAT, 20, at(&floats));
    gl.glColorPointer(3, FLOAT, 20, at(&floats) + 8);
    gl.glDrawArrays(TRIANGLES, 0, 3);
}

/// A wavy grid: positions, colours, and the indices of its triangles.
fn grid() -> (Vec<[f32; 2]>, Vec<[f32; 3]>, Vec<u16>) {
    let n = 8_usize;
    let place = |i: usize| ((i % (n + 1)) as f32, (i / (n + 1)) as f32);
    let positions = (0..(n + 1) * (n + 1))
        .map(place)
        .map(|(x, y)| [3.0 + 7.2 * x + y.sin(), 3.0 + 7.2 * y - x.cos()]);
    let colors = (0..(n + 1) * (n + 1))
        .map(place)
        .map(|(x, y)| [x / 8.0, y / 8.0, ((x + y) as i32 % 2) as f32]);
    let corner = |x: usize, y: usize| (y * (n + 1) + x) as u16;
    let cell = |i: usize| {
        let (x, y) = (i % n, i / n);
        [
            corner(x, y),
            corner(x + 1, y),
            corner(x + 1, y + 1),
            corner(x, y),
            corner(x + 1, y + 1),
            corner(x, y + 1),
        ]
    };
    (positions.collect(), colors.collect(), (0..n * n).flat_map(cell).collect())
}

fn element(gl: &mut Stage<'_>) {
    pixels(gl);
    let (positions, colors, indices) = grid();
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glEnableClientState(COLOR_ARRAY);
    gl.glVertexPointer(2, FLOAT, 0, at(&positions));
    gl.glColorPointer(3, FLOAT, 0, at(&colors));
    gl.glBegin(TRIANGLES);
    for index in &indices[..120] {
        gl.glArrayElement(i32::from(*index));
    }
    gl.glEnd();
    gl.glDisableClientState(COLOR_ARRAY);
    gl.glBegin(TRIANGLES);
    for index in &indices[120..] {
        gl.glColor3f(f32::from(*index) / 80.0, 0.5, 1.0);
        gl.glArrayElement(i32::from(*index));
    }
    gl.glEnd();
}

fn elements(gl: &mut Stage<'_>) {
    pixels(gl);
    let (positions, colors, indices) = grid();
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glEnableClientState(COLOR_ARRAY);
    gl.glVertexPointer(2, FLOAT, 0, at(&positions));
    gl.glColorPointer(3, FLOAT, 0, at(&colors));
    let bytes: Vec<u8> = indices[..96].iter().map(|i| *i as u8).collect();
    gl.glDrawElements(TRIANGLES, 96, UNSIGNED_BYTE, at(&bytes));
    gl.glDrawRangeElements(TRIANGLES, 0, 80, 144, UNSIGNED_SHORT, at(&indices[96..240]));
    let words: Vec<u32> = indices[240..].iter().map(|i| u32::from(*i)).collect();
    gl.glDrawElements(TRIANGLES, 144, UNSIGNED_INT, at(&words));
    gl.glDrawElements(LINE_STRIP, 5, UNSIGNED_SHORT, at(&[0_u16, 40, 80, 72, 8]));
}

fn multi(gl: &mut Stage<'_>) {
    pixels(gl);
    let positions: Vec<[f32; 2]> =
        (0..32).map(|i| [(i / 2 * 4) as f32, if i % 2 == 0 { 4.0 } else { 30.0 }]).collect();
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glVertexPointer(2, FLOAT, 0, at(&positions));
    gl.glColor3f(1.0, 0.5, 0.0);
    gl.glMultiDrawArrays(TRIANGLE_STRIP, &[0, 8, 20], &[6, 4, 12], 3);
    gl.glTranslatef(0.0, 32.0, 0.0);
    gl.glColor3f(0.0, 0.5, 1.0);
    let (first, second) = ([0_u16, 4, 1, 5], [10_u16, 20, 11, 21, 12, 31]);
    gl.glMultiDrawElements(TRIANGLE_STRIP, &[4, 6], UNSIGNED_SHORT, &[at(&first), at(&second)], 2);
}

fn interleaved(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(LIGHTING);
    gl.glEnable(LIGHT0);
    gl.glEnable(COLOR_MATERIAL);
    // T2F_N3F_V3F, then C4UB_V3F.
    let points: Vec<[f32; 8]> = [(-1.5, -1.5), (0.0, -1.5), (0.0, 1.5), (-1.5, 1.5)]
        .map(|(x, y): (f32, f32)| [x, y, x * 0.4, y * 0.4, 1.0, x, y, 0.0])
        .to_vec();
    texture_images::plain(gl, 8, &checks(8, 2));
    gl.glEnable(TEXTURE_2D);
    gl.glInterleavedArrays(T2F_N3F_V3F, 0, at(&points));
    gl.glDrawArrays(QUADS, 0, 4);
    gl.glDisable(TEXTURE_2D);
    let points: Vec<[f32; 4]> =
        [(0.2, -1.5, 0xff00_00ff_u32), (1.6, -1.5, 0xff00_ff00), (0.9, 1.5, 0xffff_0000)]
            .map(|(x, y, color)| [f32::from_bits(color), x, y, 0.0])
            .to_vec();
    gl.glNormal3f(0.0, 0.0, 1.0);
    gl.glInterleavedArrays(C4UB_V3F, 0, at(&points));
    gl.glDrawArrays(TRIANGLES, 0, 3);
    for name in [VERTEX_ARRAY, NORMAL_ARRAY, COLOR_ARRAY, TEXTURE_COORD_ARRAY] {
        gl.note(gl.glIsEnabled(name));
    }
}

fn attributes(gl: &mut Stage<'_>) {
    pixels(gl);
    let positions: [[f32; 2]; 4] = [[4.0, 4.0], [60.0, 4.0], [60.0, 60.0], [4.0, 60.0]];
    let second: [[f32; 3]; 4] =
        [[0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.0, 0.0, 0.5]];
    let fog: [f32; 4] = [0.0, 0.3, 0.8, 0.5];
    let coordinates: [[i16; 2]; 4] = [[0, 0], [2, 0], [2, 2], [0, 2]];
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glVertexPointer(2, FLOAT, 0, at(&positions));
    gl.glEnableClientState(SECONDARY_COLOR_ARRAY);
    gl.glSecondaryColorPointer(3, FLOAT, 0, at(&second));
    gl.glEnableClientState(FOG_COORD_ARRAY);
    gl.glFogCoordPointer(FLOAT, 0, at(&fog));
    gl.glClientActiveTexture(TEXTURE1);
    gl.glEnableClientState(TEXTURE_COORD_ARRAY);
    gl.glTexCoordPointer(2, SHORT, 0, at(&coordinates));
    gl.glActiveTexture(TEXTURE1);
    texture_images::plain(gl, 8, &checks(8, 4));
    gl.glEnable(TEXTURE_2D);
    gl.glEnable(COLOR_SUM);
    gl.glEnable(FOG);
    gl.glFogi(FOG_COORD_SRC, FOG_COORD as i32);
    gl.glFogi(FOG_MODE, LINEAR as i32);
    gl.glFogfv(FOG_COLOR, &[0.0, 1.0, 1.0, 1.0]);
    gl.glColor3f(0.5, 0.5, 0.5);
    gl.glDrawArrays(QUADS, 0, 4);
}

/// Positions of a sphere and the indices of its triangles.
fn ball() -> (Vec<[f32; 3]>, Vec<u32>) {
    let (slices, stacks) = (24, 16);
    let point = |i: usize| {
        sphere_point(
            -((i % (slices + 1)) as f32) / slices as f32,
            (i / (slices + 1)) as f32 / stacks as f32,
        )
    };
    let points = (0..(slices + 1) * (stacks + 1)).map(point).collect();
    let cell = |i: usize| {
        let at = (i / slices * (slices + 1) + i % slices) as u32;
        let below = at + slices as u32 + 1;
        [at, below, below + 1, at, below + 1, at + 1]
    };
    (points, (0..slices * stacks).flat_map(cell).collect())
}

fn lit(gl: &Gl) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glEnable(CULL_FACE);
    gl.glEnable(LIGHTING);
    gl.glEnable(LIGHT0);
    gl.glLightfv(LIGHT0, POSITION, &[1.0, 1.0, 1.0, 0.0]);
    gl.glScalef(1.5, 1.5, 1.5);
    gl.glEnable(NORMALIZE);
}

fn lit_sphere(gl: &mut Stage<'_>) {
    lit(gl);
    let (points, indices) = ball();
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glEnableClientState(NORMAL_ARRAY);
    gl.glVertexPointer(3, FLOAT, 0, at(&points));
    gl.glNormalPointer(FLOAT, 0, at(&points));
    gl.glDrawElements(TRIANGLES, indices.len() as i32, UNSIGNED_INT, at(&indices));
}

fn buffer_objects(gl: &mut Stage<'_>) {
    lit(gl);
    let (points, indices) = ball();
    let mut names = [0; 2];
    gl.glGenBuffers(2, &mut names);
    gl.glBindBuffer(ARRAY_BUFFER, names[0]);
    let bytes = |count: usize, size: usize| (count * size) as isize;
    gl.glBufferData(ARRAY_BUFFER, bytes(points.len(), 12) + 64, 0, STATIC_DRAW);
    gl.glBufferSubData(ARRAY_BUFFER, 64, bytes(points.len(), 12), at(&points));
    gl.glBindBuffer(ELEMENT_ARRAY_BUFFER, names[1]);
    gl.glBufferData(ELEMENT_ARRAY_BUFFER, bytes(indices.len(), 4), at(&indices), STATIC_DRAW);
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glEnableClientState(NORMAL_ARRAY);
    gl.glVertexPointer(3, FLOAT, 0, 64);
    gl.glNormalPointer(FLOAT, 0, 64);
    gl.glBindBuffer(ARRAY_BUFFER, 0);
    gl.glDrawElements(TRIANGLES, indices.len() as i32 / 2, UNSIGNED_INT, 0);
    gl.glShadeModel(FLAT);
    gl.glDrawElements(TRIANGLES, indices.len() as i32 / 2, UNSIGNED_INT, indices.len() * 2);
    gl.note(gl.glIsBuffer(names[0]));
    let mut size = [0];
    gl.glGetBufferParameteriv(ELEMENT_ARRAY_BUFFER, BUFFER_SIZE, &mut size);
    gl.note(size[0]);
    let mut first = [0_u32; 6];
    gl.glGetBufferSubData(ELEMENT_ARRAY_BUFFER, 24, 24, at_mut(&mut first));
    gl.notes(&first.map(|i| i as f32));
}

fn buffer_map(gl: &mut Stage<'_>) {
    pixels(gl);
    let mut names = [0];
    gl.glGenBuffers(1, &mut names);
    gl.glBindBuffer(ARRAY_BUFFER, names[0]);
    gl.glBufferData(ARRAY_BUFFER, 32, 0, DYNAMIC_DRAW);
    let address = gl.glMapBuffer(ARRAY_BUFFER, WRITE_ONLY);
    crate::gl::store(address, &[4.0_f32, 4.0, 60.0, 8.0, 50.0, 60.0, 8.0, 50.0]);
    gl.note(gl.glUnmapBuffer(ARRAY_BUFFER));
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glVertexPointer(2, FLOAT, 0, 0);
    gl.glColor3f(0.7, 0.3, 1.0);
    gl.glDrawArrays(QUADS, 0, 4);
    let address = gl.glMapBufferRange(ARRAY_BUFFER, 8, 8, MAP_WRITE_BIT | MAP_READ_BIT);
    let [x, y] = crate::gl::fetch::<f32, 2>(address);
    gl.notes(&[x, y]);
    crate::gl::store(address, &[30.0_f32, 20.0]);
    gl.note(gl.glUnmapBuffer(ARRAY_BUFFER));
    gl.glColor3f(1.0, 0.9, 0.2);
    gl.glDrawArrays(TRIANGLES, 0, 3);
}

/// A draw keeps the data that it saw.
fn buffer_changed(gl: &mut Stage<'_>) {
    pixels(gl);
    let mut names = [0];
    gl.glGenBuffers(1, &mut names);
    gl.glBindBuffer(ARRAY_BUFFER, names[0]);
    gl.glEnableClientState(VERTEX_ARRAY);
    let mut client: [[f32; 2]; 4] = [[0.0; 2]; 4];
    for i in 0..6 {
        let x = 10.0 * i as f32;
        client = [[x, 4.0], [x + 8.0, 4.0], [x + 8.0, 30.0], [x, 30.0]];
        gl.glBufferData(ARRAY_BUFFER, 32, at(&client), STREAM_DRAW);
        gl.glVertexPointer(2, FLOAT, 0, 0);
        gl.glColor3f(1.0, x / 60.0, 0.0);
        gl.glDrawArrays(QUADS, 0, 4);
        gl.glBufferSubData(ARRAY_BUFFER, 0, 4, at(&[0.0_f32]));
    }
    // Client memory is read at the call.
    gl.glBindBuffer(ARRAY_BUFFER, 0);
    gl.glVertexPointer(2, FLOAT, 0, at_mut(&mut client));
    for i in 0..6 {
        let x = 10.0 * i as f32;
        crate::gl::store(at_mut(&mut client), &[x, 34.0, x + 8.0, 34.0, x + 8.0, 60.0, x, 60.0]);
        gl.glColor3f(0.0, x / 60.0, 1.0);
        gl.glDrawArrays(QUADS, 0, 4);
    }
}

fn vertex_array_objects(gl: &mut Stage<'_>) {
    pixels(gl);
    let (first, second): ([[f32; 2]; 4], [[f32; 2]; 4]) = (
        [[2.0, 2.0], [30.0, 2.0], [30.0, 60.0], [2.0, 60.0]],
        [[34.0, 2.0], [62.0, 2.0], [62.0, 60.0], [34.0, 60.0]],
    );
    let colors: [[f32; 3]; 4] = [[1.0, 0.0, 0.0]; 4];
    let mut names = [0; 2];
    let mut buffers = [0; 3];
    gl.glGenVertexArrays(2, &mut names);
    gl.glGenBuffers(3, &mut buffers);
    let fill = |name: u32, data: usize, size: isize| {
        gl.glBindBuffer(ARRAY_BUFFER, name);
        gl.glBufferData(ARRAY_BUFFER, size, data, STATIC_DRAW);
    };
    gl.glBindVertexArray(names[0]);
    fill(buffers[0], at(&first), 32);
    gl.glVertexPointer(2, FLOAT, 0, 0);
    fill(buffers[1], at(&colors), 48);
    gl.glColorPointer(3, FLOAT, 0, 0);
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glEnableClientState(COLOR_ARRAY);
    gl.glBindVertexArray(names[1]);
    fill(buffers[2], at(&second), 32);
    gl.glVertexPointer(2, FLOAT, 0, 0);
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glColor3f(0.0, 1.0, 0.5);
    gl.glBindVertexArray(names[0]);
    gl.glDrawArrays(QUADS, 0, 4);
    gl.glBindVertexArray(names[1]);
    gl.glColor3f(0.0, 1.0, 0.5);
    gl.glDrawArrays(QUADS, 0, 4);
    gl.glBindVertexArray(0);
    gl.note(gl.glIsEnabled(VERTEX_ARRAY));
    gl.note(gl.glIsVertexArray(names[1]));
}

fn immediate_types(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glBegin(TRIANGLES);
    gl.glColor3b(127, -128, 64);
    gl.glVertex2i(2, 2);
    gl.glColor3us(65535, 30000, 0);
    gl.glVertex2s(30, 2);
    gl.glColor3d(0.1, 0.9, 0.5);
    gl.glVertex2d(16.5, 28.5);
    gl.glColor4i(i32::MAX, 0, i32::MAX / 2, i32::MAX);
    gl.glVertex3i(34, 2, 0);
    gl.glColor3ui(u32::MAX, u32::MAX / 3, 0);
    gl.glVertex4f(124.0, 4.0, 0.0, 2.0);
    gl.glColor4ubv(&[10, 200, 255, 255]);
    gl.glVertex3dv(&[48.0, 28.0, 0.0]);
    gl.glColor3sv(&[32767, 16000, -5]);
    gl.glVertex2sv(&[2, 34]);
    gl.glColor4fv(&[0.3, 0.2, 0.9, 1.0]);
    gl.glVertex4iv(&[60, 34, 0, 1]);
    gl.glColor3bv(&[0, 127, 127]);
    gl.glVertex3sv(&[30, 62, 0]);
    gl.glEnd();
    gl.note_floats::<4>(CURRENT_COLOR);
    gl.glNormal3b(127, -128, 0);
    gl.note_floats::<3>(CURRENT_NORMAL);
    gl.glNormal3s(32767, 0, -32768);
    gl.note_floats::<3>(CURRENT_NORMAL);
    gl.glTexCoord1s(7);
    gl.note_floats::<4>(CURRENT_TEXTURE_COORDS);
    gl.glTexCoord3i(1, 2, 3);
    gl.note_floats::<4>(CURRENT_TEXTURE_COORDS);
}
