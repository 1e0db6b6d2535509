//! Blending, logical operations, masks, accumulation.

use super::*;

pub(crate) const SCENES: &[Scene] = &[
    scene("blend-factors", Rounded, factors),
    scene("blend-equations", Rounded, equations),
    scene("blend-separate", Rounded, separate),
    scene("blend-order", Close, order),
    scene("logic-operations", Exact, logic_operations),
    scene("color-mask", Rounded, color_mask),
    scene("accumulation", Close, accumulation),
    scene("sample-coverage-off", Rounded, sample_coverage),
    scene("draw-buffer-none", Rounded, draw_buffer_none),
];

const FACTORS: [u32; 15] = [
    ZERO,
    ONE,
    SRC_COLOR,
    ONE_MINUS_SRC_COLOR,
    DST_COLOR,
    ONE_MINUS_DST_COLOR,
    SRC_ALPHA,
    ONE_MINUS_SRC_ALPHA,
    DST_ALPHA,
    ONE_MINUS_DST_ALPHA,
    CONSTANT_COLOR,
    ONE_MINUS_CONSTANT_COLOR,
    CONSTANT_ALPHA,
    ONE_MINUS_CONSTANT_ALPHA,
    SRC_ALPHA_SATURATE,
];

/// A field of 4 x 4 pixels.
fn field(gl: &Gl, i: usize, j: usize) {
    let (x, y) = (i as f32 * 4.0, j as f32 * 4.0);
    gl.glRectf(x, y, x + 4.0, y + 4.0);
}

/// Something to blend with.
fn background(gl: &Gl) {
    pixels(gl);
    gl.glColor4f(0.6, 0.2, 0.8, 0.4);
    gl.glRectf(0.0, 0.0, 64.0, 64.0);
    gl.glEnable(BLEND);
    gl.glBlendColor(0.3, 0.9, 0.1, 0.6);
    gl.glColor4f(0.2, 0.8, 0.4, 0.7);
}

/// All 15 x 14 pairs.
fn factors(gl: &mut Stage<'_>) {
    background(gl);
    for (i, source) in FACTORS.into_iter().enumerate() {
        for (j, destination) in FACTORS[..14].iter().enumerate() {
            gl.glBlendFunc(source, *destination);
            field(gl, i, j);
        }
    }
}

fn equations(gl: &mut Stage<'_>) {
    background(gl);
    for (i, equation) in
        [FUNC_ADD, FUNC_SUBTRACT, FUNC_REVERSE_SUBTRACT, MIN, MAX].into_iter().enumerate()
    {
        gl.glBlendEquation(equation);
        for (j, factor) in FACTORS[..14].iter().enumerate() {
            gl.glBlendFunc(*factor, ONE);
            field(gl, 2 * i, j);
            gl.glBlendFunc(ONE, *factor);
            field(gl, 2 * i + 1, j);
        }
    }
}

fn separate(gl: &mut Stage<'_>) {
    background(gl);
    for (i, alpha) in FACTORS.into_iter().enumerate() {
        gl.glBlendFuncSeparate(SRC_ALPHA, ONE_MINUS_SRC_ALPHA, alpha, ONE);
        field(gl, i, 0);
        gl.glBlendFuncSeparate(alpha, ZERO, ONE, FACTORS[(i + 5) % 14]);
        field(gl, i, 1);
        gl.glBlendFunc(SRC_ALPHA, ONE);
        gl.glBlendEquationSeparateEXT(
            FUNC_REVERSE_SUBTRACT,
            [FUNC_ADD, FUNC_SUBTRACT, MIN, MAX][i % 4],
        );
        field(gl, i, 2);
        gl.glBlendEquationSeparateEXT([FUNC_ADD, FUNC_SUBTRACT, MIN, MAX][i % 4], FUNC_ADD);
        field(gl, i, 3);
        gl.glBlendEquation(FUNC_ADD);
    }
}

fn order(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(BLEND);
    gl.glBlendFunc(SRC_ALPHA, ONE_MINUS_SRC_ALPHA);
    for i in 0..12 {
        let at = i as f32 * 4.0;
        gl.glColor4f((i % 3) as f32 / 2.0, (i % 4) as f32 / 3.0, (i % 2) as f32, 0.4);
        gl.glBegin(TRIANGLES);
        gl.glVertex2f(at, 5.0 + at * 0.3);
        gl.glVertex2f(at + 25.3, 12.1 + at * 0.2);
        gl.glVertex2f(at + 4.2, 60.7 - at * 0.4);
        gl.glEnd();
    }
}

fn logic_operations(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glColor4ub(0x35, 0xc9, 0x0f, 0x93);
    gl.glRectf(0.0, 0.0, 64.0, 64.0);
    gl.glEnable(COLOR_LOGIC_OP);
    // Where a logical operation is, there is no blending.
    gl.glEnable(BLEND);
    gl.glBlendFunc(ZERO, ZERO);
    gl.glColor4ub(0x5a, 0x66, 0xf1, 0x3c);
    for i in 0..16 {
        gl.glLogicOp(CLEAR + i);
        field(gl, i as usize, 1);
        gl.glColorMask(1, 0, 1, 0);
        field(gl, i as usize, 3);
        gl.glColorMask(1, 1, 1, 1);
    }
}

fn color_mask(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glColor4f(0.2, 0.4, 0.6, 0.8);
    gl.glRectf(0.0, 0.0, 64.0, 64.0);
    gl.glColor4f(1.0, 1.0, 1.0, 0.3);
    for i in 0..16_u8 {
        gl.glColorMask(i & 1, i >> 1 & 1, i >> 2 & 1, i >> 3 & 1);
        field(gl, usize::from(i), 2);
        gl.glEnable(BLEND);
        gl.glBlendFunc(SRC_ALPHA, ONE_MINUS_SRC_ALPHA);
        field(gl, usize::from(i), 4);
        gl.glDisable(BLEND);
    }
}

fn accumulation(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glClearAccum(0.05, 0.0, -0.2, 0.0);
    gl.glClear(ACCUM_BUFFER_BIT);
    for i in 0..4 {
        gl.glClear(COLOR_BUFFER_BIT);
        rainbow(gl, [4.0 + 5.0 * i as f32, 4.0, 44.0 + 5.0 * i as f32, 60.0], 0.0);
        gl.glAccum(ACCUM, 0.2);
    }
    gl.glAccum(MULT, 0.8);
    gl.glAccum(ADD, 0.05);
    gl.glEnable(SCISSOR_TEST);
    gl.glScissor(0, 0, 64, 32);
    gl.glAccum(RETURN, 1.0);
    gl.glScissor(0, 32, 64, 32);
    gl.glAccum(RETURN, 0.5);
    gl.glScissor(20, 20, 20, 20);
    gl.glAccum(LOAD, -0.5);
    gl.glColorMask(1, 1, 0, 1);
    gl.glAccum(RETURN, -1.0);
}

/// With one sample a pixel coverage has nothing to say.
fn sample_coverage(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glSampleCoverage(0.3, 0);
    gl.glEnable(SAMPLE_COVERAGE);
    gl.glEnable(SAMPLE_ALPHA_TO_COVERAGE);
    gl.glColor4f(1.0, 0.5, 0.2, 0.3);
    gl.glRectf(5.0, 5.0, 50.0, 50.0);
    gl.note_floats::<1>(SAMPLE_BUFFERS);
    gl.note_floats::<1>(SAMPLE_COVERAGE_VALUE);
}

fn draw_buffer_none(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glDrawBuffer(NONE);
    gl.glRectf(5.0, 5.0, 30.0, 30.0);
    gl.glClear(COLOR_BUFFER_BIT);
    gl.glDrawBuffer(FRONT);
    gl.glDepthFunc(LESS);
    gl.glColor3f(1.0, 0.0, 0.0);
    gl.glRectf(20.0, 20.0, 50.0, 50.0);
}
