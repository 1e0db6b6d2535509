//! Framebuffer objects, multisampling, shadow maps, clip control.

use super::*;
use crate::gl::{at, at_mut};

pub(crate) const SCENES: &[Scene] = &[
    scene("fbo-texture", Close, to_texture),
    scene("fbo-renderbuffer", Close, to_renderbuffer),
    scene("fbo-blit", Rounded, blit),
    scene("fbo-blit-depth", Close, blit_depth),
    scene("fbo-blit-formats", Exact, blit_formats),
    scene("fbo-multisample", Close, multisample),
    scene("fbo-sample-coverage", Close, sample_coverage),
    scene("fbo-packed-depth-stencil", Rounded, packed),
    scene("fbo-generate-mipmap", Close, generate_mipmap),
    scene("fbo-cube-face", Close, cube_face),
    scene("fbo-depth-float", Close, depth_float),
    scene("fbo-status", Exact, status),
    scene("shadow-map", Close, |gl| shadow_map(gl, [LINEAR, LINEAR])),
    scene("shadow-map-nearest-above", Close, |gl| shadow_map(gl, [LINEAR, NEAREST])),
    scene("shadow-map-nearest-below", Close, |gl| shadow_map(gl, [NEAREST, LINEAR])),
    scene("clip-control", Close, clip_control),
    scene("read-framebuffer", Rounded, read_framebuffer),
];

fn name_of(make: impl Fn(&mut [u32])) -> u32 {
    let mut names = [0];
    make(&mut names);
    names[0]
}

/// A bound framebuffer object.
fn framebuffer(gl: &Gl) -> u32 {
    let name = name_of(|names| gl.glGenFramebuffers(1, names));
    gl.glBindFramebuffer(FRAMEBUFFER, name);
    name
}

/// A renderbuffer, attached to the bound framebuffer object.
fn renderbuffer(gl: &Gl, attachment: u32, format: u32, samples: i32, size: i32) -> u32 {
    let name = name_of(|names| gl.glGenRenderbuffers(1, names));
    gl.glBindRenderbuffer(RENDERBUFFER, name);
    gl.glRenderbufferStorageMultisample(RENDERBUFFER, samples, format, size, size);
    gl.glFramebufferRenderbuffer(FRAMEBUFFER, attachment, RENDERBUFFER, name);
    name
}

/// A 2D texture, attached to the bound framebuffer object.
fn color_texture(gl: &Gl, size: i32) -> u32 {
    let name = name_of(|names| gl.glGenTextures(1, names));
    gl.glBindTexture(TEXTURE_2D, name);
    gl.glTexImage2D(TEXTURE_2D, 0, RGBA8 as i32, size, size, 0, RGBA, UNSIGNED_BYTE, 0);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, LINEAR as i32);
    gl.glFramebufferTexture2D(FRAMEBUFFER, COLOR_ATTACHMENT0, TEXTURE_2D, name, 0);
    name
}

fn to_texture(gl: &mut Stage<'_>) {
    let object = framebuffer(gl);
    let texture = color_texture(gl, 32);
    renderbuffer(gl, DEPTH_ATTACHMENT, DEPTH_COMPONENT24, 0, 32);
    gl.note(gl.glCheckFramebufferStatus(FRAMEBUFFER));
    gl.glViewport(0, 0, 32, 32);
    gl.glClearColor(0.2, 0.3, 0.4, 1.0);
    gl.glClear(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT);
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glEnable(LIGHTING);
    gl.glEnable(LIGHT0);
    sphere(gl, 1.5, 24, 16);
    gl.glDisable(LIGHTING);
    gl.glBindFramebuffer(FRAMEBUFFER, 0);
    gl.glViewport(0, 0, 64, 64);
    gl.glEnable(TEXTURE_2D);
    gl.glBindTexture(TEXTURE_2D, texture);
    gl.glRotatef(40.0, 0.0, 1.0, 0.0);
    textured(gl, [-1.5, -1.5, 1.5, 1.5], 1.0);
    gl.glDeleteFramebuffers(1, &[object]);
    gl.note(gl.glIsTexture(texture));
}

fn to_renderbuffer(gl: &mut Stage<'_>) {
    let object = framebuffer(gl);
    let color = renderbuffer(gl, COLOR_ATTACHMENT0, RGBA8, 0, 48);
    renderbuffer(gl, DEPTH_ATTACHMENT, DEPTH_COMPONENT16, 0, 48);
    gl.glViewport(0, 0, 48, 48);
    gl.glClear(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT);
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    rainbow(gl, [-1.5, -1.5, 1.5, 1.5], 0.0);
    gl.glColor3f(1.0, 1.0, 0.0);
    sphere(gl, 0.8, 16, 10);
    let mut pixels = vec![[0_u8; 4]; 48 * 48];
    gl.glReadPixels(0, 0, 48, 48, RGBA, UNSIGNED_BYTE, at_mut(&mut pixels));
    for name in [RENDERBUFFER_WIDTH, RENDERBUFFER_RED_SIZE, RENDERBUFFER_SAMPLES] {
        gl.glBindRenderbuffer(RENDERBUFFER, color);
        let mut value = [-1];
        gl.glGetRenderbufferParameteriv(RENDERBUFFER, name, &mut value);
        gl.note(value[0]);
    }
    gl.glBindFramebuffer(FRAMEBUFFER, 0);
    gl.glDeleteFramebuffers(1, &[object]);
    gl.glDisable(DEPTH_TEST);
    gl.glWindowPos2i(8, 8);
    gl.glDrawPixels(48, 48, RGBA, UNSIGNED_BYTE, at(&pixels));
}

fn blit(gl: &mut Stage<'_>) {
    let object = framebuffer(gl);
    color_texture(gl, 32);
    gl.glViewport(0, 0, 32, 32);
    camera(gl);
    rainbow(gl, [-2.0, -2.0, 2.0, 2.0], 0.0);
    gl.glBindFramebuffer(DRAW_FRAMEBUFFER, 0);
    gl.glBindFramebuffer(READ_FRAMEBUFFER, object);
    gl.glBlitFramebuffer(0, 0, 32, 32, 0, 0, 32, 32, COLOR_BUFFER_BIT, NEAREST);
    gl.glBlitFramebuffer(0, 0, 16, 16, 32, 0, 64, 32, COLOR_BUFFER_BIT, NEAREST);
    gl.glBlitFramebuffer(0, 0, 32, 32, 32, 64, 0, 32, COLOR_BUFFER_BIT, NEAREST);
    gl.glEnable(SCISSOR_TEST);
    gl.glScissor(36, 36, 20, 20);
    gl.glBlitFramebuffer(8, 8, 24, 24, 32, 32, 64, 64, COLOR_BUFFER_BIT, NEAREST);
}

fn blit_depth(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    sphere(gl, 1.5, 24, 16);
    let object = framebuffer(gl);
    renderbuffer(gl, COLOR_ATTACHMENT0, RGBA8, 0, 64);
    renderbuffer(gl, DEPTH_STENCIL_ATTACHMENT, DEPTH24_STENCIL8, 0, 64);
    gl.glBindFramebuffer(READ_FRAMEBUFFER, 0);
    gl.glClear(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT);
    gl.glBlitFramebuffer(0, 0, 64, 64, 0, 0, 64, 64, DEPTH_BUFFER_BIT, NEAREST);
    gl.glColor3f(1.0, 0.4, 0.0);
    gl.glDepthFunc(LESS);
    rainbow(gl, [-2.0, -2.0, 2.0, 2.0], 0.9);
    gl.glBindFramebuffer(FRAMEBUFFER, object);
    gl.glBindFramebuffer(DRAW_FRAMEBUFFER, 0);
    gl.glBlitFramebuffer(0, 0, 64, 64, 0, 0, 64, 64, COLOR_BUFFER_BIT, NEAREST);
}

fn resolve(gl: &Gl, object: u32) {
    gl.glBindFramebuffer(READ_FRAMEBUFFER, object);
    gl.glBindFramebuffer(DRAW_FRAMEBUFFER, 0);
    gl.glBlitFramebuffer(0, 0, 64, 64, 0, 0, 64, 64, COLOR_BUFFER_BIT, NEAREST);
}

/// Where samples lie is free: shapes are big, and their edges lie on pixels' borders or are few.
/// Which formats of depths and stencil values fit.
fn blit_formats(gl: &mut Stage<'_>) {
    let formats = [
        (DEPTH24_STENCIL8, DEPTH_STENCIL_ATTACHMENT),
        (DEPTH32F_STENCIL8, DEPTH_STENCIL_ATTACHMENT),
        (STENCIL_INDEX8, STENCIL_ATTACHMENT),
        (DEPTH_COMPONENT24, DEPTH_ATTACHMENT),
        (DEPTH_COMPONENT16, DEPTH_ATTACHMENT),
    ];
    let objects = formats.map(|(format, attachment)| {
        let object = framebuffer(gl);
        gl.glDrawBuffer(NONE);
        gl.glReadBuffer(NONE);
        renderbuffer(gl, attachment, format, 0, 8);
        object
    });
    for from in objects {
        for to in objects.into_iter().filter(|to| *to != from) {
            gl.glBindFramebuffer(READ_FRAMEBUFFER, from);
            gl.glBindFramebuffer(DRAW_FRAMEBUFFER, to);
            for mask in
                [DEPTH_BUFFER_BIT, STENCIL_BUFFER_BIT, DEPTH_BUFFER_BIT | STENCIL_BUFFER_BIT]
            {
                gl.glBlitFramebuffer(0, 0, 8, 8, 0, 0, 8, 8, mask, NEAREST);
                gl.note(gl.glGetError());
            }
        }
    }
}

fn multisample(gl: &mut Stage<'_>) {
    let object = framebuffer(gl);
    renderbuffer(gl, COLOR_ATTACHMENT0, RGBA8, 4, 64);
    renderbuffer(gl, DEPTH_ATTACHMENT, DEPTH_COMPONENT24, 4, 64);
    gl.note(gl.glCheckFramebufferStatus(FRAMEBUFFER));
    gl.note_floats::<1>(SAMPLES);
    gl.glClear(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT);
    pixels(gl);
    gl.glEnable(DEPTH_TEST);
    rainbow(gl, [4.0, 4.0, 60.0, 60.0], 0.0);
    gl.glColor3f(0.2, 0.2, 0.2);
    gl.glBegin(QUADS);
    for (x, y, z) in [(20.0, 10.0, -0.5), (50.0, 10.0, 0.5), (50.0, 50.0, 0.5), (20.0, 50.0, -0.5)]
    {
        gl.glVertex3f(x, y, z);
    }
    gl.glEnd();
    resolve(gl, object);
}

fn sample_coverage(gl: &mut Stage<'_>) {
    let object = framebuffer(gl);
    renderbuffer(gl, COLOR_ATTACHMENT0, RGBA8, 4, 64);
    gl.glClear(COLOR_BUFFER_BIT);
    pixels(gl);
    gl.glColor4f(1.0, 1.0, 1.0, 1.0);
    gl.glEnable(SAMPLE_COVERAGE);
    for (i, coverage) in [0.0, 0.25, 0.5, 0.75, 1.0].into_iter().enumerate() {
        let x = 12.0 * i as f32;
        gl.glSampleCoverage(coverage, 0);
        gl.glRectf(x, 0.0, x + 10.0, 30.0);
        gl.glSampleCoverage(coverage, 1);
        gl.glRectf(x, 32.0, x + 10.0, 62.0);
    }
    resolve(gl, object);
}

fn packed(gl: &mut Stage<'_>) {
    let object = framebuffer(gl);
    renderbuffer(gl, COLOR_ATTACHMENT0, RGBA8, 0, 64);
    renderbuffer(gl, DEPTH_STENCIL_ATTACHMENT, DEPTH24_STENCIL8, 0, 64);
    gl.note(gl.glCheckFramebufferStatus(FRAMEBUFFER));
    gl.glClearStencil(3);
    gl.glClear(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT | STENCIL_BUFFER_BIT);
    pixels(gl);
    gl.glEnable(STENCIL_TEST);
    gl.glStencilFunc(ALWAYS, 0, 0xff);
    gl.glStencilOp(KEEP, KEEP, INCR);
    gl.glRectf(10.0, 10.0, 40.0, 40.0);
    gl.glStencilFunc(EQUAL, 4, 0xff);
    gl.glColor3f(0.0, 0.7, 0.2);
    gl.glRectf(20.0, 20.0, 60.0, 60.0);
    resolve(gl, object);
}

fn generate_mipmap(gl: &mut Stage<'_>) {
    framebuffer(gl);
    color_texture(gl, 32);
    gl.glViewport(0, 0, 32, 32);
    camera(gl);
    rainbow(gl, [-2.0, -2.0, 2.0, 2.0], 0.0);
    gl.glBindFramebuffer(FRAMEBUFFER, 0);
    gl.glGenerateMipmap(TEXTURE_2D);
    gl.glTexParameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, LINEAR_MIPMAP_LINEAR as i32);
    gl.glViewport(0, 0, 64, 64);
    pixels(gl);
    gl.glColor3f(1.0, 1.0, 1.0);
    gl.glEnable(TEXTURE_2D);
    for (i, side) in [32.0, 16.0, 8.0, 4.0].into_iter().enumerate() {
        let at = [0.0, 33.0, 50.0, 59.0][i];
        textured(gl, [at, at, at + side, at + side], 1.0);
    }
}

fn cube_face(gl: &mut Stage<'_>) {
    texture_images::cube(gl, 16);
    let mut names = [0];
    gl.glGenTextures(1, &mut names);
    gl.glBindTexture(TEXTURE_CUBE_MAP, names[0]);
    texture_images::cube(gl, 16);
    framebuffer(gl);
    gl.glViewport(0, 0, 16, 16);
    for face in [TEXTURE_CUBE_MAP_POSITIVE_Z, TEXTURE_CUBE_MAP_NEGATIVE_X] {
        gl.glFramebufferTexture2D(FRAMEBUFFER, COLOR_ATTACHMENT0, face, names[0], 0);
        gl.glClearColor(0.0, 0.2, 0.0, 1.0);
        gl.glClear(COLOR_BUFFER_BIT);
        camera(gl);
        rainbow(gl, [-1.0, -1.0, 1.0, 1.0], 0.0);
    }
    gl.glBindFramebuffer(FRAMEBUFFER, 0);
    gl.glViewport(0, 0, 64, 64);
    camera(gl);
    gl.glEnable(TEXTURE_CUBE_MAP);
    gl.glColor3f(1.0, 1.0, 1.0);
    gl.glBegin(QUADS);
    for (x, z) in [(-1.5, -1.0), (1.5, 1.0)] {
        for y in if x < 0.0 { [1.5, -1.5] } else { [-1.5, 1.5] } {
            gl.glTexCoord3f(x * 0.6 - 0.5, y * 0.6, 0.6 + z * 0.5);
            gl.glVertex3f(x, y, 0.0);
        }
    }
    gl.glEnd();
}

fn depth_float(gl: &mut Stage<'_>) {
    let object = framebuffer(gl);
    renderbuffer(gl, COLOR_ATTACHMENT0, RGBA8, 0, 64);
    renderbuffer(gl, DEPTH_ATTACHMENT, DEPTH_COMPONENT32F, 0, 64);
    gl.note(gl.glCheckFramebufferStatus(FRAMEBUFFER));
    gl.glClear(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT);
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glColor3f(0.9, 0.3, 0.3);
    sphere(gl, 1.3, 24, 16);
    let mut depth = [0.0_f32; 64];
    gl.glReadPixels(0, 32, 64, 1, DEPTH_COMPONENT, FLOAT, at_mut(&mut depth));
    gl.notes(&depth[20..44]);
    resolve(gl, object);
}

fn status(gl: &mut Stage<'_>) {
    framebuffer(gl);
    gl.note(gl.glCheckFramebufferStatus(FRAMEBUFFER));
    renderbuffer(gl, DEPTH_ATTACHMENT, RGBA8, 0, 16);
    gl.note(gl.glCheckFramebufferStatus(FRAMEBUFFER));
    renderbuffer(gl, DEPTH_ATTACHMENT, DEPTH_COMPONENT24, 0, 16);
    renderbuffer(gl, COLOR_ATTACHMENT0, RGBA8, 4, 16);
    gl.note(gl.glCheckFramebufferStatus(FRAMEBUFFER));
    pixels(gl);
    gl.glRectf(0.0, 0.0, 8.0, 8.0);
    gl.note(gl.glGetError());
    for name in [FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE] {
        for attachment in [COLOR_ATTACHMENT0, DEPTH_ATTACHMENT, STENCIL_ATTACHMENT] {
            let mut value = [-1];
            gl.glGetFramebufferAttachmentParameteriv(FRAMEBUFFER, attachment, name, &mut value);
            gl.note(value[0]);
        }
    }
    gl.glBindFramebuffer(FRAMEBUFFER, 0);
    gl.note(gl.glCheckFramebufferStatus(FRAMEBUFFER));
}

/// The scene that casts shadows: a ball over a floor.
fn ball_and_floor(gl: &Gl) {
    gl.glColor3f(0.9, 0.6, 0.3);
    gl.glPushMatrix();
    gl.glTranslatef(0.0, 0.3, 0.0);
    sphere(gl, 0.6, 24, 16);
    gl.glPopMatrix();
    gl.glColor3f(0.5, 0.7, 0.9);
    gl.glNormal3f(0.0, 1.0, 0.0);
    gl.glBegin(QUADS);
    for (x, z) in [(-1.8, 1.8), (1.8, 1.8), (1.8, -1.8), (-1.8, -1.8)] {
        gl.glVertex3f(x, -0.8, z);
    }
    gl.glEnd();
}

/// With filters for minification and magnification.
fn shadow_map(gl: &mut Stage<'_>, [min, mag]: [u32; 2]) {
    // Create a depth texture for the light's view.
    framebuffer(gl);
    let texture = name_of(|names| gl.glGenTextures(1, names));
    gl.glBindTexture(TEXTURE_2D, texture);
    gl.glTexImage2D(
        TEXTURE_2D,
        0,
        DEPTH_COMPONENT24 as i32,
        64,
        64,
        0,
        DEPTH_COMPONENT,
        UNSIGNED_INT,
        0,
    );
    for (name, value) in [
        (TEXTURE_MIN_FILTER, min),
        (TEXTURE_MAG_FILTER, mag),
        (TEXTURE_WRAP_S, CLAMP_TO_EDGE),
        (TEXTURE_WRAP_T, CLAMP_TO_EDGE),
        (TEXTURE_COMPARE_MODE, COMPARE_R_TO_TEXTURE),
        (TEXTURE_COMPARE_FUNC, LEQUAL),
    ] {
        gl.glTexParameteri(TEXTURE_2D, name, value as i32);
    }

    // Attach the texture to a framebuffer without colour.
    gl.glFramebufferTexture2D(FRAMEBUFFER, DEPTH_ATTACHMENT, TEXTURE_2D, texture, 0);
    gl.glDrawBuffer(NONE);
    gl.glReadBuffer(NONE);
    gl.note(gl.glCheckFramebufferStatus(FRAMEBUFFER));
    gl.glEnable(DEPTH_TEST);
    gl.glClear(DEPTH_BUFFER_BIT);

    // Draw the depths as the light sees them.
    let light = |gl: &Gl| {
        gl.glOrtho(-2.5, 2.5, -2.5, 2.5, 0.0, 8.0);
        gl.glTranslatef(0.0, 0.0, -4.0);
        gl.glRotatef(55.0, 1.0, 0.0, 0.0);
        gl.glRotatef(-30.0, 0.0, 1.0, 0.0);
    };
    gl.glMatrixMode(PROJECTION);
    gl.glLoadIdentity();
    light(gl);
    gl.glMatrixMode(MODELVIEW);
    gl.glLoadIdentity();
    gl.glEnable(POLYGON_OFFSET_FILL);
    gl.glPolygonOffset(2.0, 8.0);
    ball_and_floor(gl);
    gl.glDisable(POLYGON_OFFSET_FILL);

    // Draw the eye's view, with the light's clip coordinates as texture coordinates.
    gl.glBindFramebuffer(FRAMEBUFFER, 0);
    camera(gl);
    gl.glRotatef(25.0, 1.0, 0.0, 0.0);
    gl.glMatrixMode(TEXTURE);
    gl.glLoadIdentity();
    gl.glTranslatef(0.5, 0.5, 0.5);
    gl.glScalef(0.5, 0.5, 0.5);
    light(gl);
    gl.glMatrixMode(MODELVIEW);
    for (coordinate, cap) in
        [(S, TEXTURE_GEN_S), (T, TEXTURE_GEN_T), (R, TEXTURE_GEN_R), (Q, TEXTURE_GEN_Q)]
    {
        let mut plane = [0.0; 4];
        plane[(coordinate - S) as usize] = 1.0;
        gl.glTexGeni(coordinate, TEXTURE_GEN_MODE, EYE_LINEAR as i32);
        gl.glTexGenfv(coordinate, EYE_PLANE, &plane);
        gl.glEnable(cap);
    }
    gl.glEnable(TEXTURE_2D);
    ball_and_floor(gl);
}

fn clip_control(gl: &mut Stage<'_>) {
    camera(gl);
    gl.glClipControl(UPPER_LEFT, ZERO_TO_ONE);
    gl.glEnable(DEPTH_TEST);
    gl.glDepthFunc(GREATER);
    gl.glClearDepth(0.0);
    gl.glClear(DEPTH_BUFFER_BIT);
    gl.glMatrixMode(PROJECTION);
    // Reversed depth: near is 1, far is 0.
    gl.glLoadMatrixf(&[
        2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.1, -1.0, 0.0, 0.0, 1.1, 0.0,
    ]);
    gl.glMatrixMode(MODELVIEW);
    gl.glEnable(CULL_FACE);
    gl.glEnable(LIGHTING);
    gl.glEnable(LIGHT0);
    gl.glTranslatef(0.3, 0.5, 0.0);
    gl.glFrontFace(CCW);
    sphere(gl, 1.0, 24, 16);
    gl.glTranslatef(0.4, 0.2, 0.4);
    sphere(gl, 0.8, 24, 16);
    gl.note_floats::<1>(CLIP_ORIGIN);
}

fn read_framebuffer(gl: &mut Stage<'_>) {
    pixels(gl);
    rainbow(gl, [0.0, 0.0, 32.0, 32.0], 0.0);
    let object = framebuffer(gl);
    renderbuffer(gl, COLOR_ATTACHMENT0, RGBA8, 0, 64);
    gl.glClearColor(0.4, 0.6, 0.8, 1.0);
    gl.glClear(COLOR_BUFFER_BIT);
    let mut inside = [0_u8; 4];
    gl.glReadPixels(5, 5, 1, 1, RGBA, UNSIGNED_BYTE, at_mut(&mut inside));
    gl.notes(&inside.map(f32::from));
    gl.glBindFramebuffer(READ_FRAMEBUFFER, 0);
    gl.glReadPixels(5, 5, 1, 1, RGBA, UNSIGNED_BYTE, at_mut(&mut inside));
    gl.notes(&inside.map(f32::from));
    // Pixels come from one framebuffer and go to the other.
    gl.glWindowPos2i(10, 20);
    gl.glCopyPixels(0, 0, 32, 32, COLOR);
    resolve(gl, object);
}
