//! Lights, materials, the light model.

use super::*;

pub(crate) const SCENES: &[Scene] = &[
    scene("light-directional", Close, directional),
    scene("light-positional", Close, positional),
    scene("light-spot", Close, spot),
    scene("light-attenuation", Close, attenuation),
    scene("light-eight", Close, eight),
    scene("light-specular-infinite", Close, specular_infinite),
    scene("light-local-viewer", Close, local_viewer),
    scene("light-separate-specular", Close, separate_specular),
    scene("light-two-side", Close, two_side),
    scene("light-ambient-emission", Close, ambient_emission),
    scene("light-color-material", Close, color_material),
    scene("light-material-in-begin", Close, material_in_begin),
    scene("light-normalize", Close, normalize),
    scene("light-rescale", Close, rescale),
    scene("light-long-normals", Close, long_normals),
    scene("light-flat", Close, flat),
    scene("light-position-at-call", Close, position_at_call),
    scene("light-alpha", Close, alpha),
    scene("secondary-color", Close, secondary_color),
    scene("light-get", Close, get),
];

/// A view with depth test and lighting, light 0 on.
fn lit(gl: &Gl) {
    camera(gl);
    gl.glEnable(DEPTH_TEST);
    gl.glEnable(LIGHTING);
    gl.glEnable(LIGHT0);
}

fn shiny(gl: &Gl, shininess: f32) {
    gl.glMaterialfv(FRONT_AND_BACK, AMBIENT, &[0.1, 0.05, 0.0, 1.0]);
    gl.glMaterialfv(FRONT_AND_BACK, DIFFUSE, &[0.8, 0.5, 0.2, 1.0]);
    gl.glMaterialfv(FRONT_AND_BACK, SPECULAR, &[0.9, 0.9, 1.0, 1.0]);
    gl.glMaterialf(FRONT_AND_BACK, SHININESS, shininess);
}

fn directional(gl: &mut Stage<'_>) {
    lit(gl);
    gl.glLightfv(LIGHT0, POSITION, &[1.0, 1.0, 1.0, 0.0]);
    sphere(gl, 1.6, 32, 20);
}

fn positional(gl: &mut Stage<'_>) {
    lit(gl);
    gl.glLightfv(LIGHT0, POSITION, &[1.2, 1.0, 2.0, 1.0]);
    gl.glLightfv(LIGHT0, DIFFUSE, &[0.2, 1.0, 0.4, 1.0]);
    sphere(gl, 1.6, 32, 20);
}

/// A grid of small squares in the plane z = 0 that faces the eye.
fn wall(gl: &Gl) {
    gl.glNormal3f(0.0, 0.0, 1.0);
    for y in 0..32 {
        gl.glBegin(QUAD_STRIP);
        for x in 0..=32 {
            for dy in 0..2 {
                gl.glVertex3f(-2.0 + x as f32 / 8.0, -2.0 + (y + 1 - dy) as f32 / 8.0, 0.0);
            }
        }
        gl.glEnd();
    }
}

fn spot(gl: &mut Stage<'_>) {
    lit(gl);
    for (i, (x, cutoff, exponent)) in [(-0.9, 20.0, 0.0), (0.9, 35.0, 20.0)].into_iter().enumerate()
    {
        let light = LIGHT0 + i as u32;
        gl.glEnable(light);
        gl.glLightfv(light, POSITION, &[x, 0.3, 2.0, 1.0]);
        gl.glLightfv(light, SPOT_DIRECTION, &[0.1, -0.1, -1.0]);
        gl.glLightf(light, SPOT_CUTOFF, cutoff);
        gl.glLightf(light, SPOT_EXPONENT, exponent);
        gl.glLightfv(light, DIFFUSE, &[1.0, 0.5 + x / 2.0, 0.5, 1.0]);
    }
    wall(gl);
}

fn attenuation(gl: &mut Stage<'_>) {
    lit(gl);
    gl.glLightfv(LIGHT0, POSITION, &[-1.5, 0.0, 0.5, 1.0]);
    gl.glLightf(LIGHT0, CONSTANT_ATTENUATION, 0.3);
    gl.glLightf(LIGHT0, LINEAR_ATTENUATION, 0.2);
    gl.glLightf(LIGHT0, QUADRATIC_ATTENUATION, 0.4);
    wall(gl);
}

fn eight(gl: &mut Stage<'_>) {
    lit(gl);
    for i in 0..8 {
        let angle = i as f32 * 0.785;
        let light = LIGHT0 + i;
        gl.glEnable(light);
        gl.glLightfv(light, POSITION, &[2.0 * angle.cos(), 2.0 * angle.sin(), 0.5, (i % 2) as f32]);
        let color =
            [(i & 1) as f32 * 0.6, (i >> 1 & 1) as f32 * 0.6, 0.3 + (i >> 2 & 1) as f32 * 0.4, 1.0];
        gl.glLightfv(light, DIFFUSE, &color);
        gl.glLightfv(light, AMBIENT, &[0.01, 0.02, 0.0, 1.0]);
    }
    sphere(gl, 1.6, 40, 24);
}

fn specular_infinite(gl: &mut Stage<'_>) {
    lit(gl);
    shiny(gl, 20.0);
    gl.glLightfv(LIGHT0, POSITION, &[1.0, 1.0, 2.0, 0.0]);
    sphere(gl, 1.6, 64, 40);
}

fn local_viewer(gl: &mut Stage<'_>) {
    lit(gl);
    shiny(gl, 30.0);
    gl.glLightModeli(LIGHT_MODEL_LOCAL_VIEWER, 1);
    gl.glLightfv(LIGHT0, POSITION, &[1.0, 1.0, 2.0, 1.0]);
    wall(gl);
    gl.glTranslatef(-1.0, -1.0, 0.0);
    sphere(gl, 0.8, 48, 32);
}

fn separate_specular(gl: &mut Stage<'_>) {
    lit(gl);
    shiny(gl, 15.0);
    texture_images::plain(gl, 16, &checks(16, 2));
    gl.glEnable(TEXTURE_2D);
    gl.glLightModeli(LIGHT_MODEL_COLOR_CONTROL, SEPARATE_SPECULAR_COLOR as i32);
    gl.glLightfv(LIGHT0, POSITION, &[1.0, 1.0, 2.0, 0.0]);
    gl.glMaterialfv(FRONT, DIFFUSE, &[0.3, 0.3, 0.3, 1.0]);
    sphere(gl, 1.6, 48, 32);
}

fn two_side(gl: &mut Stage<'_>) {
    lit(gl);
    gl.glLightModeli(LIGHT_MODEL_TWO_SIDE, 1);
    gl.glMaterialfv(FRONT, DIFFUSE, &[0.9, 0.2, 0.1, 1.0]);
    gl.glMaterialfv(BACK, DIFFUSE, &[0.1, 0.3, 0.9, 1.0]);
    gl.glMaterialfv(BACK, SPECULAR, &[1.0, 1.0, 1.0, 1.0]);
    gl.glMaterialf(BACK, SHININESS, 10.0);
    gl.glClipPlane(CLIP_PLANE0, &[0.4, -0.7, -0.6, 0.0]);
    gl.glEnable(CLIP_PLANE0);
    gl.glLightfv(LIGHT0, POSITION, &[1.0, 2.0, 2.0, 0.0]);
    sphere(gl, 1.6, 40, 24);
}

fn ambient_emission(gl: &mut Stage<'_>) {
    lit(gl);
    gl.glLightModelfv(LIGHT_MODEL_AMBIENT, &[0.3, 0.1, 0.5, 1.0]);
    gl.glMaterialfv(FRONT, AMBIENT, &[1.0, 0.5, 0.5, 1.0]);
    gl.glMaterialfv(FRONT, EMISSION, &[0.0, 0.2, 0.1, 1.0]);
    gl.glLightfv(LIGHT0, AMBIENT, &[0.2, 0.2, 0.0, 1.0]);
    gl.glLightfv(LIGHT0, POSITION, &[-1.0, 0.5, 0.2, 0.0]);
    sphere(gl, 1.6, 40, 24);
}

fn color_material(gl: &mut Stage<'_>) {
    lit(gl);
    gl.glEnable(LIGHT0);
    gl.glLightModelfv(LIGHT_MODEL_AMBIENT, &[0.4, 0.4, 0.4, 1.0]);
    for (i, mode) in
        [AMBIENT, DIFFUSE, SPECULAR, EMISSION, AMBIENT_AND_DIFFUSE].into_iter().enumerate()
    {
        gl.glPushAttrib(LIGHTING_BIT);
        shiny(gl, 8.0);
        gl.glColor4f(0.2, 0.2, 0.2, 1.0);
        gl.glColorMaterial(FRONT_AND_BACK, mode);
        gl.glEnable(COLOR_MATERIAL);
        gl.glColor4f(0.1, 0.9, 0.4, 1.0);
        gl.glPushMatrix();
        gl.glTranslatef(-1.1 + 1.1 * (i % 3) as f32, 0.7 - 1.4 * (i / 3) as f32, 0.0);
        sphere(gl, 0.6, 24, 16);
        gl.glPopMatrix();
        gl.glPopAttrib();
    }
}

fn material_in_begin(gl: &mut Stage<'_>) {
    lit(gl);
    gl.glNormal3f(0.0, 0.0, 1.0);
    gl.glBegin(QUADS);
    for i in 0..16 {
        let (x, y) = ((i % 4) as f32 - 2.0, (i / 4) as f32 - 2.0);
        gl.glMaterialfv(FRONT, DIFFUSE, &[x / 4.0 + 0.5, y / 4.0 + 0.5, 0.5, 1.0]);
        for (dx, dy) in [(0.1, 0.1), (0.9, 0.1), (0.9, 0.9), (0.1, 0.9)] {
            gl.glVertex3f(x + dx, y + dy, 0.0);
        }
    }
    gl.glEnd();
    let mut diffuse = [0.0; 4];
    gl.glGetMaterialfv(FRONT, DIFFUSE, &mut diffuse);
    gl.notes(&diffuse);
}

fn normalize(gl: &mut Stage<'_>) {
    lit(gl);
    shiny(gl, 20.0);
    gl.glEnable(NORMALIZE);
    gl.glScalef(1.6, 0.8, 1.0);
    gl.glRotatef(30.0, 0.0, 0.0, 1.0);
    sphere(gl, 1.0, 40, 24);
}

fn rescale(gl: &mut Stage<'_>) {
    lit(gl);
    gl.glEnable(RESCALE_NORMAL);
    gl.glScalef(3.0, 3.0, 3.0);
    sphere(gl, 0.5, 40, 24);
    gl.glDisable(RESCALE_NORMAL);
    gl.glTranslatef(0.4, 0.4, 0.2);
    gl.glScalef(0.5, 0.5, 0.5);
    sphere(gl, 0.4, 20, 12);
}

/// Scaling down makes normals longer; nobody makes them shorter again, so the highlight is wide and
/// bright.
fn long_normals(gl: &mut Stage<'_>) {
    lit(gl);
    shiny(gl, 40.0);
    gl.glMaterialfv(FRONT, DIFFUSE, &[0.1, 0.1, 0.1, 1.0]);
    gl.glMaterialfv(FRONT, SPECULAR, &[0.3, 0.1, 0.02, 1.0]);
    gl.glScalef(0.9, 0.95, 0.92);
    sphere(gl, 1.7, 40, 24);
}

fn flat(gl: &mut Stage<'_>) {
    lit(gl);
    shiny(gl, 5.0);
    gl.glShadeModel(FLAT);
    gl.glRotatef(25.0, 1.0, 0.4, 0.0);
    sphere(gl, 1.6, 12, 8);
}

/// A light stays where the modelview matrix put it when its position was given.
fn position_at_call(gl: &mut Stage<'_>) {
    lit(gl);
    gl.glPushMatrix();
    gl.glRotatef(90.0, 0.0, 0.0, 1.0);
    gl.glLightfv(LIGHT0, POSITION, &[1.0, 0.0, 0.5, 0.0]);
    gl.glPopMatrix();
    gl.glRotatef(45.0, 0.0, 1.0, 0.0);
    sphere(gl, 1.6, 40, 24);
    let mut position = [0.0; 4];
    gl.glGetLightfv(LIGHT0, POSITION, &mut position);
    gl.notes(&position);
}

fn alpha(gl: &mut Stage<'_>) {
    lit(gl);
    gl.glEnable(BLEND);
    gl.glBlendFunc(SRC_ALPHA, ONE_MINUS_SRC_ALPHA);
    gl.glMaterialfv(FRONT, DIFFUSE, &[1.0, 1.0, 0.2, 1.0]);
    sphere(gl, 1.0, 32, 20);
    gl.glDepthMask(0);
    gl.glMaterialfv(FRONT, DIFFUSE, &[0.2, 0.4, 1.0, 0.4]);
    gl.glTranslatef(0.5, 0.5, 1.0);
    sphere(gl, 0.9, 32, 20);
}

fn secondary_color(gl: &mut Stage<'_>) {
    pixels(gl);
    gl.glEnable(COLOR_SUM);
    for i in 0..4 {
        gl.glSecondaryColor3f(0.0, 0.25 * i as f32, 0.5);
        rainbow(gl, [2.0 + 15.0 * i as f32, 4.0, 15.0 + 15.0 * i as f32, 60.0], 0.0);
    }
}

fn get(gl: &mut Stage<'_>) {
    gl.glLightfv(LIGHT1, SPECULAR, &[0.5, 0.25, 1.0, -1.0]);
    gl.glLightiv(LIGHT1, DIFFUSE, &[i32::MAX, 0, i32::MIN, 1 << 30]);
    gl.glLighti(LIGHT1, SPOT_CUTOFF, 45);
    for light in [LIGHT0, LIGHT1, LIGHT0 + 7] {
        for name in [AMBIENT, DIFFUSE, SPECULAR, POSITION] {
            let mut values = [0.0; 4];
            gl.glGetLightfv(light, name, &mut values);
            gl.notes(&values);
        }
        let mut direction = [0.0; 3];
        gl.glGetLightfv(light, SPOT_DIRECTION, &mut direction);
        gl.notes(&direction);
        for name in [
            SPOT_EXPONENT,
            SPOT_CUTOFF,
            CONSTANT_ATTENUATION,
            LINEAR_ATTENUATION,
            QUADRATIC_ATTENUATION,
        ] {
            let mut value = [0.0];
            gl.glGetLightfv(light, name, &mut value);
            gl.notes(&value);
        }
    }
    let mut integers = [0; 4];
    gl.glGetLightiv(LIGHT1, SPECULAR, &mut integers);
    gl.notes(&integers.map(|i| i as f32 / 1e9));
    for name in [AMBIENT, DIFFUSE, SPECULAR, EMISSION] {
        let mut values = [0.0; 4];
        gl.glGetMaterialfv(BACK, name, &mut values);
        gl.notes(&values);
    }
}
