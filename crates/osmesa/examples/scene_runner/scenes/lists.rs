//! Display lists, attribute stacks, evaluators.

use super::*;
use crate::gl::at;

pub(crate) const SCENES: &[Scene] = &[
    scene("list-geometry", Close, geometry),
    scene("list-nested", Close, nested),
    scene("list-state", Close, state),
    scene("list-compile-and-execute", Close, compile_and_execute),
    scene("list-call-types", Rounded, call_types),
    scene("list-inside-begin", Rounded, inside_begin),
    scene("list-images", Rounded, images),
    scene("list-textures", Close, textures),
    scene("list-arrays", Close, arrays),
    scene("list-array-errors", Exact, array_errors),
    scene("list-redefined", Exact, redefined),
    scene("attribute-stack", Close, attribute_stack),
    scene("evaluator-1d", Close, evaluator_1d),
    scene("evaluator-2d", Close, evaluator_2d),
    scene("evaluator-mesh-lit", Close, evaluator_mesh_lit),
    scene("evaluator-color-texture", Close, evaluator_color_texture),
];

fn geometry(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glEnable(LIGHTING);
    gl.glEnable(LIGHT0);
    let list = gl.glGenLists(1);
    gl.glNewList(list, COMPILE);
    sphere(gl, 0.6, 20, 12);
    gl.glEndList();
    for i in 0..5 {
        gl.glPushMatrix();
        gl.glRotatef(72.0 * i as f32, 0.0, 0.0, 1.0);
        gl.glTranslatef(1.2, 0.0, 0.0);
        gl.glCallList(list);
        gl.glPopMatrix();
    }
    gl.note(gl.glIsList(list));
    gl.note(gl.glIsList(list + 1));
}

fn nested(gl: &mut Stage<'_>) {
    pixels(gl);
    let base = gl.glGenLists(3);
    gl.glNewList(base, COMPILE);
    gl.glRectf(0.0, 0.0, 5.0, 5.0);
    gl.glTranslatef(7.0, 1.0, 0.0);
    gl.glEndList();
    gl.glNewList(base + 1, COMPILE);
    for i in 0..4 {
        gl.glColor3f(1.0, i as f32 / 4.0, 0.2);
        gl.glCallList(base);
    }
    gl.glEndList();
    gl.glNewList(base + 2, COMPILE);
    gl.glPushMatrix();
    gl.glCallList(base + 1);
    gl.glPopMatrix();
    gl.glTranslatef(3.0, 14.0, 0.0);
    gl.glEndList();
    for _ in 0..4 {
        gl.glCallList(base + 2);
    }
}

/// What a list sets stays set.
fn state(gl: &mut Stage<'_>) {
    camera(gl);
    let list = gl.glGenLists(2);
    gl.glNewList(list, COMPILE);
    gl.glEnable(LIGHTING);
    gl.glEnable(LIGHT1);
    gl.glLightfv(LIGHT1, POSITION, &[1.0, 1.0, 1.0, 0.0]);
    gl.glLightfv(LIGHT1, DIFFUSE, &[1.0, 0.8, 0.3, 1.0]);
    gl.glMaterialfv(FRONT, DIFFUSE, &[0.9, 0.9, 0.9, 1.0]);
    gl.glShadeModel(FLAT);
    gl.glEnable(DEPTH_TEST);
    gl.glDepthFunc(LEQUAL);
    gl.glRotatef(30.0, 1.0, 0.0, 0.0);
    gl.glEndList();
    gl.note(gl.glIsEnabled(LIGHTING));
    gl.glCallList(list);
    gl.note(gl.glIsEnabled(LIGHTING));
    sphere(gl, 1.5, 16, 10);
    gl.note_floats::<16>(MODELVIEW_MATRIX);
}

fn compile_and_execute(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glNewList(7, COMPILE_AND_EXECUTE);
    rainbow(gl, [2.0, 2.0, 25.0, 25.0], 0.0);
    gl.glTranslatef(30.0, 20.0, 0.0);
    gl.glEndList();
    gl.glCallList(7);
    gl.note_floats::<16>(MODELVIEW_MATRIX);
}

fn call_types(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glListBase(1000);
    for i in 0..16 {
        gl.glNewList(1000 + i, COMPILE);
        gl.glColor3f(i as f32 / 16.0, 1.0 - i as f32 / 16.0, 0.5);
        gl.glRecti(0, 0, 3, 3);
        gl.glTranslatef(4.0, 0.0, 0.0);
        gl.glEndList();
    }
    let rows = [
        (UNSIGNED_BYTE, 4, bytes(&[0, 3, 5, 7], u8::to_ne_bytes)),
        (BYTE, 4, bytes(&[1, 2, 3, -1], i8::to_ne_bytes)),
        (UNSIGNED_SHORT, 3, bytes(&[9, 10, 11], u16::to_ne_bytes)),
        (SHORT, 3, bytes(&[12, 13, -2], i16::to_ne_bytes)),
        (UNSIGNED_INT, 2, bytes(&[14, 15], u32::to_ne_bytes)),
        (INT, 2, bytes(&[0, 1], i32::to_ne_bytes)),
        (FLOAT, 2, bytes(&[4.9, 6.0], f32::to_ne_bytes)),
        (_2_BYTES, 2, bytes(&[0, 8, 0, 9], u8::to_ne_bytes)),
        (_3_BYTES, 2, bytes(&[0, 0, 10, 0, 0, 2], u8::to_ne_bytes)),
        (_4_BYTES, 1, bytes(&[0, 0, 0, 3], u8::to_ne_bytes)),
    ];
    for (i, (kind, count, lists)) in rows.into_iter().enumerate() {
        gl.glLoadIdentity();
        gl.glTranslatef(2.0, 2.0 + 6.0 * i as f32, 0.0);
        gl.glCallLists(count, kind, at(&lists));
    }
}

fn inside_begin(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glNewList(3, COMPILE);
    gl.glColor3f(1.0, 0.5, 0.0);
    gl.glVertex2f(10.0, 10.0);
    gl.glVertex2f(50.0, 10.0);
    gl.glEndList();
    gl.glBegin(QUADS);
    gl.glCallList(3);
    gl.glVertex2f(50.0, 40.0);
    gl.glVertex2f(10.0, 40.0);
    gl.glEnd();
    // A primitive may begin in one list and end in another.
    gl.glNewList(4, COMPILE);
    gl.glBegin(TRIANGLES);
    gl.glVertex2f(5.0, 45.0);
    gl.glEndList();
    gl.glNewList(5, COMPILE);
    gl.glVertex2f(60.0, 45.0);
    gl.glVertex2f(30.0, 62.0);
    gl.glEnd();
    gl.glEndList();
    gl.glColor3f(0.0, 0.5, 1.0);
    gl.glCallList(4);
    gl.glCallList(5);
    gl.note_floats::<4>(CURRENT_COLOR);
}

/// Images are read when the list is made, as the client's pixel store was then.
fn images(gl: &mut Stage<'_>) {
    pixels(gl);
    let mut image = checks(16, 4);
    gl.glNewList(9, COMPILE);
    gl.glRasterPos2i(5, 5);
    gl.glDrawPixels(16, 16, RGBA, UNSIGNED_BYTE, at(&image));
    gl.glPixelZoom(2.0, 1.0);
    gl.glRasterPos2i(25, 25);
    gl.glDrawPixels(16, 16, RGBA, UNSIGNED_BYTE, at(&image));
    gl.glEndList();
    image.fill([255, 0, 0, 255]);
    gl.glPixelStorei(UNPACK_ROW_LENGTH, 5);
    gl.glCallList(9);
}

fn textures(gl: &mut Stage<'_>) {
    pixels(gl);
    let mut names = [0; 2];
    gl.glGenTextures(2, &mut names);
    gl.glNewList(1, COMPILE);
    gl.glBindTexture(TEXTURE_2D, names[0]);
    texture_images::plain(gl, 8, &checks(8, 2));
    gl.glEndList();
    gl.glNewList(2, COMPILE);
    gl.glBindTexture(TEXTURE_2D, names[1]);
    texture_images::plain(gl, 8, &checks(8, 4));
    gl.glEnable(TEXTURE_2D);
    textured(gl, [34.0, 4.0, 62.0, 60.0], 1.0);
    gl.glBindTexture(TEXTURE_2D, names[0]);
    textured(gl, [2.0, 4.0, 30.0, 60.0], 1.0);
    gl.glEndList();
    gl.glCallList(1);
    gl.glCallList(2);
}

fn arrays(gl: &mut Stage<'_>) {
    pixels(gl);
    let mut points: [[f32; 2]; 6] =
        [[4.0, 4.0], [40.0, 8.0], [20.0, 30.0], [24.0, 60.0], [60.0, 40.0], [30.0, 34.0]];
    gl.glEnableClientState(VERTEX_ARRAY);
    gl.glVertexPointer(2, FLOAT, 0, at(&points));
    gl.glNewList(6, COMPILE);
    gl.glColor3f(0.9, 0.4, 0.6);
    gl.glDrawArrays(TRIANGLES, 0, 6);
    gl.glEndList();
    points.fill([0.0, 0.0]);
    gl.glCallList(6);
}

/// Wrong draws: what GetError says while they are compiled, and when they are executed.
fn array_errors(gl: &mut Stage<'_>) {
    let positions = [1.0_f32, 1.0, 20.0, 1.0, 1.0, 20.0];
    let indices = [0_u32, 1, 2];
    gl.glVertexPointer(2, FLOAT, 0, at(&positions));
    gl.glEnableClientState(VERTEX_ARRAY);
    for (list, mode) in [(1, COMPILE), (2, COMPILE_AND_EXECUTE)] {
        for draw in 0..5 {
            gl.glNewList(list, mode);
            match draw {
                0 => gl.glDrawArrays(99, 0, 3),
                1 => gl.glDrawArrays(TRIANGLES, 0, -1),
                2 => gl.glDrawElements(77, 3, UNSIGNED_INT, at(&indices)),
                3 => gl.glDrawElements(TRIANGLES, -3, UNSIGNED_INT, at(&indices)),
                _ => gl.glDrawRangeElements(TRIANGLES, 2, 1, 3, UNSIGNED_INT, at(&indices)),
            }
            gl.note(gl.glGetError());
            gl.glEndList();
            gl.glCallList(list);
            gl.note(gl.glGetError());
        }
    }
}

fn redefined(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glNewList(11, COMPILE);
    gl.glColor3f(1.0, 0.0, 0.0);
    gl.glRecti(2, 2, 20, 60);
    gl.glEndList();
    gl.glCallList(11);
    gl.glNewList(11, COMPILE);
    gl.glColor3f(0.0, 1.0, 0.0);
    gl.glRecti(24, 2, 40, 60);
    gl.glEndList();
    gl.glCallList(11);
    gl.glDeleteLists(11, 1);
    gl.glColor3f(0.0, 0.0, 1.0);
    gl.glCallList(11);
    gl.glRecti(44, 2, 60, 60);
}

fn attribute_stack(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glPushAttrib(ALL_ATTRIB_BITS);
    gl.glEnable(LIGHTING);
    gl.glEnable(LIGHT0);
    gl.glEnable(DEPTH_TEST);
    gl.glColor3f(1.0, 0.0, 0.0);
    gl.glPolygonMode(FRONT_AND_BACK, LINE);
    gl.glLineWidth(2.0);
    gl.glViewport(0, 0, 32, 32);
    sphere(gl, 1.5, 10, 6);
    gl.note_floats::<1>(ATTRIB_STACK_DEPTH);
    gl.glPopAttrib();
    for name in [LIGHTING, LIGHT0, DEPTH_TEST] {
        gl.note(gl.glIsEnabled(name));
    }
    gl.note_floats::<4>(CURRENT_COLOR);
    gl.note_floats::<4>(VIEWPORT);
    gl.note_floats::<1>(LINE_WIDTH);
    gl.note_floats::<2>(POLYGON_MODE);
    gl.glColor3f(0.2, 0.7, 0.3);
    gl.glTranslatef(1.0, 1.0, 0.0);
    sphere(gl, 0.8, 10, 6);
}

const CURVE: [f32; 12] = [-1.6, -1.2, 0.0, -0.6, 2.5, 0.0, 0.5, -2.4, 0.0, 1.6, 1.3, 0.0];

fn evaluator_1d(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glMap1f(MAP1_VERTEX_3, 0.0, 1.0, 3, 4, &CURVE);
    gl.glMap1f(MAP1_COLOR_4, 0.0, 1.0, 4, 2, &[1.0, 0.0, 0.0, 1.0, 0.0, 0.5, 1.0, 1.0]);
    gl.glEnable(MAP1_VERTEX_3);
    gl.glEnable(MAP1_COLOR_4);
    gl.glLineWidth(2.0);
    gl.glBegin(LINE_STRIP);
    for i in 0..=20 {
        gl.glEvalCoord1f(i as f32 / 20.0);
    }
    gl.glEnd();
    gl.glTranslatef(0.0, -0.4, 0.0);
    gl.glMapGrid1f(8, 0.2, 0.9);
    gl.glEvalMesh1(LINE, 0, 8);
    gl.glPointSize(4.0);
    gl.glEvalMesh1(POINT, 1, 7);
    let mut points = [0.0; 12];
    gl.glGetMapfv(MAP1_VERTEX_3, COEFF, &mut points);
    gl.notes(&points);
}

/// A bent patch of 4 x 4 control points.
fn patch() -> Vec<f32> {
    let point = |i: usize| {
        let (u, v) = ((i / 4) as f32, (i % 4) as f32);
        let height = [0.0, 1.4, -0.9, 0.6][i % 4] * [0.5, -1.0, 1.0, 0.3][i / 4];
        [-1.5 + u, -1.5 + v, height]
    };
    (0..16).flat_map(point).collect()
}

fn evaluator_2d(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glRotatef(-40.0, 1.0, 0.3, 0.0);
    gl.glMap2f(MAP2_VERTEX_3, 0.0, 1.0, 12, 4, 0.0, 1.0, 3, 4, &patch());
    gl.glEnable(MAP2_VERTEX_3);
    gl.glMapGrid2f(10, 0.0, 1.0, 8, 0.0, 1.0);
    gl.glColor3f(0.3, 0.6, 1.0);
    gl.glEvalMesh2(LINE, 0, 10, 0, 8);
    gl.glColor3f(1.0, 0.8, 0.0);
    gl.glPointSize(3.0);
    gl.glEvalMesh2(POINT, 2, 8, 2, 6);
    gl.glBegin(LINE_STRIP);
    for i in 0..=16 {
        gl.glEvalCoord2f(i as f32 / 16.0, 1.0 - i as f32 / 16.0);
    }
    gl.glEnd();
}

fn evaluator_mesh_lit(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glEnable(LIGHTING);
    gl.glEnable(LIGHT0);
    gl.glLightModeli(LIGHT_MODEL_TWO_SIDE, 1);
    gl.glLightfv(LIGHT0, POSITION, &[0.5, 1.0, 1.0, 0.0]);
    gl.glEnable(AUTO_NORMAL);
    gl.glEnable(NORMALIZE);
    // The strips of a mesh run so that u to the right and v up is seen from behind.
    gl.glFrontFace(CW);
    gl.glRotatef(-40.0, 1.0, 0.3, 0.0);
    gl.glMap2f(MAP2_VERTEX_3, 0.0, 1.0, 12, 4, 0.0, 1.0, 3, 4, &patch());
    gl.glEnable(MAP2_VERTEX_3);
    gl.glMapGrid2f(20, 0.0, 1.0, 20, 0.0, 1.0);
    gl.glEvalMesh2(FILL, 0, 20, 0, 20);
}

fn evaluator_color_texture(gl: &mut Stage<'_>) {
    camera(gl);
    texture_images::plain(gl, 8, &checks(8, 2));
    gl.glEnable(TEXTURE_2D);
    gl.glMap2f(
        MAP2_VERTEX_4,
        0.0,
        2.0,
        8,
        2,
        0.0,
        3.0,
        4,
        2,
        &[-1.5, -1.5, 0.0, 1.0, -1.0, 1.5, 0.0, 1.0, 1.5, -1.0, 0.0, 1.0, 2.4, 2.4, 0.0, 2.0],
    );
    gl.glMap2f(
        MAP2_COLOR_4,
        0.0,
        2.0,
        8,
        2,
        0.0,
        3.0,
        4,
        2,
        &[1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
    );
    gl.glMap2f(
        MAP2_TEXTURE_COORD_2,
        0.0,
        2.0,
        4,
        2,
        0.0,
        3.0,
        2,
        2,
        &[0.0, 0.0, 0.0, 2.0, 2.0, 0.0, 2.0, 2.0],
    );
    for map in [MAP2_VERTEX_4, MAP2_COLOR_4, MAP2_TEXTURE_COORD_2] {
        gl.glEnable(map);
    }
    gl.glMapGrid2f(6, 0.0, 2.0, 6, 0.0, 3.0);
    gl.glEvalMesh2(FILL, 0, 6, 0, 6);
}

/// Numbers as bytes, filled up to 16.
fn bytes<T: Copy, const N: usize>(numbers: &[T], of: fn(T) -> [u8; N]) -> [u8; 16] {
    let mut out = [0; 16];
    for (place, byte) in out.iter_mut().zip(numbers.iter().flat_map(|n| of(*n))) {
        *place = byte;
    }
    out
}
