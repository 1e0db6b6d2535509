//! Feedback, selection, occlusion queries, errors, state queries: their numbers are compared.

use super::*;

pub(crate) const SCENES: &[Scene] = &[
    scene("feedback", Close, feedback),
    scene("feedback-clipped", Close, feedback_clipped),
    scene("feedback-images", Close, feedback_images),
    scene("selection", Close, selection),
    scene("selection-overflow", Exact, selection_overflow),
    scene("occlusion-query", Close, occlusion),
    scene("errors", Exact, errors),
    scene("errors-in-begin", Exact, errors_in_begin),
    scene("defaults", Exact, defaults),
    scene("enables", Exact, enables),
    scene("get-conversions", Exact, conversions),
];

/// Notes what came back. Whether the stipple pattern begins anew with a line is left out: Mesa does
/// not say so for lines that stand alone.
fn note_feedback(gl: &mut Stage<'_>, buffer: &[f32], count: i32) {
    gl.note(count);
    for value in &buffer[..count.max(0) as usize] {
        gl.note(if *value == LINE_RESET_TOKEN as f32 { LINE_TOKEN as f32 } else { *value });
    }
}

fn feedback(gl: &mut Stage<'_>) {
    pixels(gl);
    let mut buffer = vec![0.0_f32; 1000];
    for kind in [_2D, _3D, _3D_COLOR, _3D_COLOR_TEXTURE, _4D_COLOR_TEXTURE] {
        gl.glFeedbackBuffer(1000, kind, &mut buffer);
        gl.glRenderMode(FEEDBACK);
        gl.glPassThrough(kind as f32);
        gl.glColor4f(1.0, 0.5, 0.25, 1.0);
        gl.glTexCoord4f(0.1, 0.2, 0.3, 1.0);
        gl.glBegin(POINTS);
        gl.glVertex3f(10.0, 10.0, 0.5);
        gl.glVertex3f(-10.0, 10.0, 0.0);
        gl.glEnd();
        gl.glBegin(LINE_STRIP);
        gl.glVertex2f(5.0, 6.0);
        gl.glVertex2f(20.0, 30.0);
        gl.glVertex2f(40.0, 20.0);
        gl.glEnd();
        // Mesa feeds four corners back as two triangles.
        gl.glBegin(TRIANGLES);
        for (x, y) in [(5.0, 40.0), (25.0, 40.0), (25.0, 60.0)] {
            gl.glVertex2f(x, y);
        }
        gl.glEnd();
        let count = gl.glRenderMode(RENDER);
        note_feedback(gl, &buffer, count);
    }
}

fn feedback_clipped(gl: &mut Stage<'_>) {
    pixels(gl);
    let mut buffer = vec![0.0_f32; 500];
    gl.glFeedbackBuffer(500, _3D_COLOR, &mut buffer);
    gl.glRenderMode(FEEDBACK);
    gl.glBegin(LINES);
    gl.glColor3f(1.0, 0.0, 0.0);
    gl.glVertex2f(-32.0, 10.0);
    gl.glColor3f(0.0, 1.0, 0.0);
    gl.glVertex2f(32.0, 10.0);
    gl.glEnd();
    gl.glEnable(CULL_FACE);
    gl.glBegin(TRIANGLES);
    for (x, y) in
        [(10.0, 10.0), (5.0, 20.0), (10.0, 20.0), (10.0, 10.0), (20.0, 10.0), (20.0, 20.0)]
    {
        gl.glVertex2f(x, y);
    }
    gl.glEnd();
    let count = gl.glRenderMode(RENDER);
    note_feedback(gl, &buffer, count);
}

fn feedback_images(gl: &mut Stage<'_>) {
    pixels(gl);
    let mut buffer = vec![0.0_f32; 100];
    gl.glFeedbackBuffer(100, _3D, &mut buffer);
    gl.glRenderMode(FEEDBACK);
    gl.glRasterPos2i(10, 20);
    gl.glBitmap(8, 8, 0.0, 0.0, 3.0, 4.0, &[0xff; 32]);
    gl.glDrawPixels(1, 1, RGBA, UNSIGNED_BYTE, crate::gl::at(&[0_u8; 4]));
    gl.glCopyPixels(0, 0, 2, 2, COLOR);
    let count = gl.glRenderMode(RENDER);
    note_feedback(gl, &buffer, count);
}

fn selection(gl: &mut Stage<'_>) {
    pixels(gl);
    let mut buffer = vec![0_u32; 200];
    gl.glSelectBuffer(200, &mut buffer);
    gl.glRenderMode(SELECT);
    gl.glInitNames();
    gl.glRectf(1.0, 1.0, 5.0, 5.0);
    gl.glPushName(7);
    gl.glBegin(TRIANGLES);
    for (x, y, z) in [(1.0, 1.0, 0.5), (20.0, 1.0, -0.25), (10.0, 20.0, 0.0)] {
        gl.glVertex3f(x, y, z);
    }
    gl.glEnd();
    gl.glLoadName(8);
    gl.glRectf(100.0, 100.0, 120.0, 120.0);
    gl.glPushName(9);
    gl.glBegin(POINTS);
    gl.glVertex3f(30.0, 30.0, 0.75);
    gl.glEnd();
    gl.glPopName();
    gl.glLoadName(10);
    gl.glRasterPos3f(5.0, 5.0, -0.5);
    gl.glLoadName(11);
    gl.glEnable(CULL_FACE);
    gl.glRectf(20.0, 1.0, 10.0, 5.0);
    gl.note_floats::<1>(NAME_STACK_DEPTH);
    let hits = gl.glRenderMode(RENDER);
    gl.note(hits);
    let mut at = 0;
    for _ in 0..hits.max(0) {
        let names = buffer[at] as usize;
        gl.note(buffer[at]);
        gl.note(f64::from(buffer[at + 1]) / 4294967295.0);
        gl.note(f64::from(buffer[at + 2]) / 4294967295.0);
        let list: Vec<f32> = buffer[at + 3..at + 3 + names].iter().map(|n| *n as f32).collect();
        gl.notes(&list);
        at += 3 + names;
    }
}

fn selection_overflow(gl: &mut Stage<'_>) {
    pixels(gl);
    let mut buffer = [0_u32; 6];
    gl.glSelectBuffer(6, &mut buffer);
    gl.glRenderMode(SELECT);
    gl.glInitNames();
    gl.glPushName(1);
    for i in 0..4 {
        gl.glLoadName(i);
        gl.glRectf(1.0, 1.0, 5.0, 5.0);
    }
    gl.note(gl.glRenderMode(RENDER));
    let mut small = [0.0_f32; 4];
    gl.glFeedbackBuffer(4, _2D, &mut small);
    gl.glRenderMode(FEEDBACK);
    gl.glRectf(1.0, 1.0, 5.0, 5.0);
    gl.note(gl.glRenderMode(RENDER));
}

fn occlusion(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(DEPTH_TEST);
    let mut names = [0; 3];
    gl.glGenQueries(3, &mut names);
    for (i, (x, z)) in [(10.0, 0.0), (20.0, -0.5), (15.0, 0.5)].into_iter().enumerate() {
        gl.glBeginQuery(SAMPLES_PASSED, names[i]);
        gl.glColor3f(1.0, i as f32 / 3.0, 0.0);
        gl.glBegin(QUADS);
        for (dx, dy) in [(0.0, 0.0), (30.0, 0.0), (30.0, 30.0), (0.0, 30.0)] {
            gl.glVertex3f(x + dx, x + dy, z);
        }
        gl.glEnd();
        gl.glEndQuery(SAMPLES_PASSED);
    }
    for name in names {
        let mut count = [0];
        gl.glGetQueryObjectuiv(name, QUERY_RESULT, &mut count);
        gl.note(count[0]);
        gl.note(gl.glIsQuery(name));
    }
}

/// Calls that are errors, with four texels of data.
const WRONG_CALLS: &[fn(&Gl, &[u8])] = &[
    |gl, _| gl.glEnable(0x1234),
    |gl, _| gl.glBegin(0x99),
    |gl, _| gl.glEnd(),
    |gl, _| gl.glLineWidth(0.0),
    |gl, _| gl.glPointSize(-1.0),
    |gl, _| gl.glViewport(0, 0, -1, 5),
    |gl, _| gl.glScissor(0, 0, 5, -1),
    |gl, _| gl.glMatrixMode(0x42),
    |gl, _| gl.glPopMatrix(),
    |gl, _| gl.glPopAttrib(),
    |gl, _| gl.glPopClientAttrib(),
    |gl, _| gl.glFrustum(1.0, 1.0, 0.0, 1.0, 1.0, 2.0),
    |gl, _| gl.glFrustum(0.0, 1.0, 0.0, 1.0, -1.0, 2.0),
    |gl, _| gl.glOrtho(0.0, 1.0, 2.0, 2.0, -1.0, 1.0),
    |gl, _| gl.glLightf(LIGHT0, SPOT_CUTOFF, 95.0),
    |gl, _| gl.glLightf(LIGHT0, SPOT_EXPONENT, 200.0),
    |gl, _| gl.glLightf(LIGHT0, CONSTANT_ATTENUATION, -1.0),
    |gl, _| gl.glMaterialf(FRONT, SHININESS, 129.0),
    |gl, _| gl.glFogf(FOG_DENSITY, -0.5),
    |gl, _| gl.glFogi(FOG_MODE, 0),
    |gl, _| gl.glBlendFunc(SRC_ALPHA_SATURATE, 0x7777),
    |gl, _| gl.glAlphaFunc(0x10, 0.0),
    |gl, _| gl.glDepthFunc(0x10),
    |gl, _| gl.glStencilOp(KEEP, 0x1, KEEP),
    |gl, _| gl.glLogicOp(0x1),
    |gl, _| gl.glCullFace(FILL),
    |gl, _| gl.glPolygonMode(FRONT, FRONT),
    |gl, _| gl.glShadeModel(0),
    |gl, _| gl.glHint(FOG_HINT, 5),
    |gl, _| gl.glClear(0x8000_0000),
    |gl, _| gl.glAccum(0x9, 1.0),
    |gl, _| gl.glNewList(0, COMPILE),
    |gl, _| gl.glNewList(1, 0),
    |gl, _| gl.glEndList(),
    |gl, _| gl.glDeleteLists(1, -1),
    |gl, _| gl.glPixelStorei(PACK_ALIGNMENT, 3),
    |gl, _| gl.glPixelStorei(PACK_ROW_LENGTH, -1),
    |gl, _| gl.glPixelZoom(0.0, 0.0),
    |gl, data| gl.glDrawPixels(-1, 1, RGBA, UNSIGNED_BYTE, crate::gl::at(data)),
    |gl, data| gl.glDrawPixels(1, 1, 0x77, UNSIGNED_BYTE, crate::gl::at(data)),
    |gl, data| gl.glDrawPixels(1, 1, RGBA, 0x77, crate::gl::at(data)),
    |gl, data| gl.glDrawPixels(1, 1, RGBA, UNSIGNED_SHORT_5_6_5, crate::gl::at(data)),
    |gl, data| {
        gl.glTexImage2D(TEXTURE_2D, -1, 4, 2, 2, 0, RGBA, UNSIGNED_BYTE, crate::gl::at(data))
    },
    |gl, data| gl.glTexImage2D(TEXTURE_2D, 0, 4, 2, 2, 2, RGBA, UNSIGNED_BYTE, crate::gl::at(data)),
    |gl, data| {
        gl.glTexImage2D(TEXTURE_2D, 0, 4, -2, 2, 0, RGBA, UNSIGNED_BYTE, crate::gl::at(data))
    },
    |gl, data| {
        gl.glTexImage2D(TEXTURE_2D, 0, 9999, 2, 2, 0, RGBA, UNSIGNED_BYTE, crate::gl::at(data))
    },
    |gl, data| {
        gl.glTexSubImage2D(TEXTURE_2D, 5, 0, 0, 2, 2, RGBA, UNSIGNED_BYTE, crate::gl::at(data))
    },
    |gl, _| gl.glTexParameteri(TEXTURE_2D, TEXTURE_WRAP_S, 7),
    |gl, _| gl.glTexParameteri(TEXTURE_2D, TEXTURE_MAG_FILTER, LINEAR_MIPMAP_LINEAR as i32),
    |gl, _| gl.glTexEnvi(TEXTURE_ENV, TEXTURE_ENV_MODE, 3),
    |gl, _| gl.glTexEnvf(TEXTURE_ENV, RGB_SCALE, 3.0),
    |gl, _| gl.glTexGeni(R, TEXTURE_GEN_MODE, SPHERE_MAP as i32),
    |gl, _| gl.glBindTexture(TEXTURE_ENV, 1),
    |gl, _| gl.glActiveTexture(TEXTURE0 + 900),
    |gl, _| gl.glGenTextures(-1, &mut [0]),
    |gl, _| gl.glBindBuffer(0x5, 1),
    |gl, _| gl.glBufferData(ARRAY_BUFFER, 5, 0, STATIC_DRAW),
    |gl, _| {
        gl.glMapBuffer(ARRAY_BUFFER, WRITE_ONLY);
    },
    |gl, _| gl.glVertexPointer(5, FLOAT, 0, 0),
    |gl, _| gl.glVertexPointer(3, UNSIGNED_BYTE, 0, 0),
    |gl, _| gl.glNormalPointer(FLOAT, -4, 0),
    |gl, _| gl.glDrawArrays(TRIANGLES, 0, -1),
    |gl, _| gl.glDrawArrays(55, 0, 3),
    |gl, _| gl.glDrawElements(TRIANGLES, 3, FLOAT, 0),
    |gl, _| gl.glMap1f(MAP1_VERTEX_3, 1.0, 1.0, 3, 4, &[0.0; 12]),
    |gl, _| gl.glMap1f(MAP1_VERTEX_3, 0.0, 1.0, 2, 4, &[0.0; 12]),
    |gl, _| gl.glMap1f(MAP1_VERTEX_3, 0.0, 1.0, 3, 0, &[0.0; 12]),
    |gl, _| gl.glMapGrid1f(0, 0.0, 1.0),
    |gl, _| gl.glEvalMesh1(FILL, 0, 1),
    |gl, _| {
        gl.glRenderMode(0x55);
    },
    |gl, _| gl.glPushName(3),
    |gl, _| gl.glEndQuery(SAMPLES_PASSED),
    |gl, _| gl.glBeginQuery(SAMPLES_PASSED, 0),
    |gl, _| gl.glClipPlane(CLIP_PLANE0 + 50, &[0.0; 4]),
    |gl, _| gl.glColorMaterial(FRONT, SHININESS),
    |gl, _| gl.glFeedbackBuffer(-1, _2D, &mut []),
    |gl, _| gl.glGetFloatv(0x1, &mut [0.0; 16]),
    |gl, _| {
        gl.glIsEnabled(0x1);
    },
    |gl, _| gl.glBindFramebuffer(0x3, 1),
    |gl, _| gl.glLoadTransposeMatrixf(&[1.0; 16]),
];

fn errors(gl: &mut Stage<'_>) {
    pixels(gl);
    let texels = [0_u8; 16];
    for call in WRONG_CALLS {
        call(gl, &texels);
        gl.note(gl.glGetError());
        gl.note(gl.glGetError());
    }
    // The first error stays.
    gl.glEnable(0x1234);
    gl.glPopMatrix();
    gl.note(gl.glGetError());
    gl.note(gl.glGetError());
}

fn errors_in_begin(gl: &mut Stage<'_>) {
    pixels(gl);
    let wrong: &[fn(&Gl)] = &[
        |gl| gl.glEnable(LIGHTING),
        |gl| gl.glMatrixMode(PROJECTION),
        |gl| gl.glLoadIdentity(),
        |gl| gl.glClear(COLOR_BUFFER_BIT),
        |gl| gl.glBegin(POINTS),
        |gl| gl.glPushMatrix(),
        |gl| gl.glLineWidth(3.0),
        |gl| gl.glRectf(0.0, 0.0, 50.0, 50.0),
        |gl| gl.glFinish(),
        |gl| gl.glRasterPos2i(1, 1),
        |gl| gl.glBindTexture(TEXTURE_2D, 3),
        |gl| gl.glNewList(1, COMPILE),
        |gl| {
            gl.glGenLists(1);
        },
    ];
    for call in wrong {
        gl.glBegin(TRIANGLES);
        gl.glVertex2f(5.0, 5.0);
        call(gl);
        gl.glVertex2f(20.0, 5.0);
        gl.glVertex2f(10.0, 20.0);
        gl.glEnd();
        gl.note(gl.glGetError());
    }
    gl.note(gl.glIsEnabled(LIGHTING));
    gl.note_floats::<1>(MATRIX_MODE);
}

/// States of one value.
const SINGLE_VALUES: &[u32] = &[
    MATRIX_MODE,
    SHADE_MODEL,
    CULL_FACE_MODE,
    FRONT_FACE,
    POINT_SIZE,
    LINE_WIDTH,
    LINE_STIPPLE_REPEAT,
    LINE_STIPPLE_PATTERN,
    POLYGON_OFFSET_FACTOR,
    FOG_MODE,
    FOG_DENSITY,
    FOG_START,
    FOG_END,
    ALPHA_TEST_FUNC,
    ALPHA_TEST_REF,
    DEPTH_FUNC,
    DEPTH_CLEAR_VALUE,
    DEPTH_WRITEMASK,
    STENCIL_FUNC,
    STENCIL_REF,
    STENCIL_FAIL,
    STENCIL_CLEAR_VALUE,
    BLEND_SRC,
    BLEND_DST,
    BLEND_EQUATION,
    LOGIC_OP_MODE,
    UNPACK_ALIGNMENT,
    PACK_ALIGNMENT,
    PACK_ROW_LENGTH,
    ZOOM_X,
    RED_SCALE,
    DEPTH_BIAS,
    LIST_BASE,
    LIST_INDEX,
    RENDER_MODE,
    ACTIVE_TEXTURE,
    CLIENT_ACTIVE_TEXTURE,
    TEXTURE_BINDING_2D,
    ARRAY_BUFFER_BINDING,
    MODELVIEW_STACK_DEPTH,
    ATTRIB_STACK_DEPTH,
    NAME_STACK_DEPTH,
    MAP1_GRID_SEGMENTS,
    PERSPECTIVE_CORRECTION_HINT,
    LIGHT_MODEL_LOCAL_VIEWER,
    LIGHT_MODEL_TWO_SIDE,
    LIGHT_MODEL_COLOR_CONTROL,
    COLOR_MATERIAL_FACE,
    COLOR_MATERIAL_PARAMETER,
    FOG_COORD_SRC,
    GENERATE_MIPMAP_HINT,
    POINT_SIZE_MIN,
    POINT_FADE_THRESHOLD_SIZE,
    SAMPLE_COVERAGE_VALUE,
    CURRENT_RASTER_POSITION_VALID,
    EDGE_FLAG,
    DOUBLEBUFFER,
    STEREO,
    RGBA_MODE,
    RED_BITS,
    ALPHA_BITS,
    DEPTH_BITS,
    STENCIL_BITS,
];

fn defaults(gl: &mut Stage<'_>) {
    for &name in SINGLE_VALUES {
        gl.note_floats::<1>(name);
    }
    for name in [
        CURRENT_COLOR,
        CURRENT_SECONDARY_COLOR,
        CURRENT_RASTER_POSITION,
        CURRENT_TEXTURE_COORDS,
        FOG_COLOR,
        COLOR_CLEAR_VALUE,
        ACCUM_CLEAR_VALUE,
        COLOR_WRITEMASK,
        LIGHT_MODEL_AMBIENT,
        BLEND_COLOR,
        VIEWPORT,
        SCISSOR_BOX,
        MAP2_GRID_DOMAIN,
    ] {
        gl.note_floats::<4>(name);
    }
    gl.note_floats::<3>(CURRENT_NORMAL);
    gl.note_floats::<2>(POLYGON_MODE);
    gl.note_floats::<3>(POINT_DISTANCE_ATTENUATION);
    gl.note_floats::<16>(TEXTURE_MATRIX);
}

fn enables(gl: &mut Stage<'_>) {
    let all = [
        ALPHA_TEST,
        AUTO_NORMAL,
        BLEND,
        CLIP_PLANE0,
        COLOR_LOGIC_OP,
        COLOR_MATERIAL,
        COLOR_SUM,
        CULL_FACE,
        DEPTH_TEST,
        DITHER,
        FOG,
        LIGHT0,
        LIGHTING,
        LINE_SMOOTH,
        LINE_STIPPLE,
        MAP1_COLOR_4,
        MAP2_VERTEX_3,
        MULTISAMPLE,
        NORMALIZE,
        POINT_SMOOTH,
        POLYGON_OFFSET_FILL,
        POLYGON_OFFSET_LINE,
        POLYGON_SMOOTH,
        POLYGON_STIPPLE,
        RESCALE_NORMAL,
        SAMPLE_ALPHA_TO_COVERAGE,
        SAMPLE_COVERAGE,
        SCISSOR_TEST,
        STENCIL_TEST,
        TEXTURE_1D,
        TEXTURE_2D,
        TEXTURE_3D,
        TEXTURE_CUBE_MAP,
        TEXTURE_GEN_S,
        TEXTURE_GEN_Q,
    ];
    for cap in all {
        gl.note(gl.glIsEnabled(cap));
        gl.glEnable(cap);
        gl.note(gl.glIsEnabled(cap));
        gl.note_floats::<1>(cap);
        gl.glDisable(cap);
        gl.note(gl.glIsEnabled(cap));
    }
    for array in [
        VERTEX_ARRAY,
        NORMAL_ARRAY,
        COLOR_ARRAY,
        EDGE_FLAG_ARRAY,
        TEXTURE_COORD_ARRAY,
        FOG_COORD_ARRAY,
    ] {
        gl.note(gl.glIsEnabled(array));
        gl.glEnableClientState(array);
        gl.note(gl.glIsEnabled(array));
    }
}

fn conversions(gl: &mut Stage<'_>) {
    gl.glColor4f(0.5, -0.25, 2.0, 1.0);
    gl.glClearColor(0.5, 0.25, 0.75, 1.0);
    gl.glFogfv(FOG_COLOR, &[0.25, 0.5, 1.0, 0.0]);
    gl.glPointSize(2.6);
    gl.glDepthRange(0.25, 0.75);
    for name in [COLOR_CLEAR_VALUE, FOG_COLOR] {
        let mut integers = [0; 4];
        gl.glGetIntegerv(name, &mut integers);
        gl.notes(&integers.map(|i| (f64::from(i) / 2147483647.0) as f32));
    }
    for name in [POINT_SIZE, FOG_END, ALPHA_TEST_REF, LIST_BASE, DEPTH_TEST] {
        let (mut integer, mut boolean, mut double) = ([0; 1], [9; 1], [0.0; 1]);
        gl.glGetIntegerv(name, &mut integer);
        gl.glGetBooleanv(name, &mut boolean);
        gl.glGetDoublev(name, &mut double);
        gl.note(integer[0]);
        gl.note(boolean[0]);
        gl.note(double[0]);
    }
    let mut booleans = [9; 4];
    gl.glGetBooleanv(COLOR_CLEAR_VALUE, &mut booleans);
    gl.notes(&booleans.map(f32::from));
    let mut matrix = [9; 16];
    gl.glGetBooleanv(MODELVIEW_MATRIX, &mut matrix);
    gl.notes(&matrix.map(f32::from));
}
