//! The scenes, by chapter of the specification.

mod alpha_stencil;
mod arrays;
mod blending;
mod environment;
mod extensions;
mod fog;
mod framebuffers;
mod images;
mod lighting;
mod lines;
mod lists;
mod polygons;
mod queries;
mod reading;
mod surfaces;
mod texgen;
mod texture_images;
mod textures;

use crate::gl::Gl;
use crate::stage::{Stage, Surface, USUAL};
use vitral_gl::enums::*;

/// How well two libraries must agree on a scene. Numbers that a scene notes agree within a
/// hundredth (or a thousandth of their size).
#[derive(Clone, Copy, Debug)]
pub(crate) enum Agreement {
    /// Every byte.
    Exact,
    /// Every byte, but for rounding: at most 2 of 255.
    Rounded,
    /// At most 1 % of the pixels differ by more than 8 of 255.
    Close,
}
pub(crate) use Agreement::{Close, Exact, Rounded};

/// A scene.
pub(crate) struct Scene {
    /// Its name.
    pub(crate) name: &'static str,
    /// How well libraries must agree.
    pub(crate) agreement: Agreement,
    /// What it is drawn to.
    pub(crate) surface: Surface,
    /// Draws it.
    pub(crate) draw: fn(&mut Stage<'_>),
}

const fn scene(name: &'static str, agreement: Agreement, draw: fn(&mut Stage<'_>)) -> Scene {
    Scene { name, agreement, surface: USUAL, draw }
}

/// All scenes in their groups.
pub(crate) const GROUPS: &[(&str, &[Scene])] = &[
    ("lines", lines::SCENES),
    ("polygons", polygons::SCENES),
    ("lighting", lighting::SCENES),
    ("fog", fog::SCENES),
    ("texgen", texgen::SCENES),
    ("textures", textures::SCENES),
    ("texture_images", texture_images::SCENES),
    ("environment", environment::SCENES),
    ("alpha_stencil", alpha_stencil::SCENES),
    ("blending", blending::SCENES),
    ("images", images::SCENES),
    ("reading", reading::SCENES),
    ("lists", lists::SCENES),
    ("arrays", arrays::SCENES),
    ("framebuffers", framebuffers::SCENES),
    ("queries", queries::SCENES),
    ("surfaces", surfaces::SCENES),
    ("extensions", extensions::SCENES),
];

/// All scenes.
pub(crate) fn all() -> impl Iterator<Item = &'static Scene> {
    GROUPS.iter().flat_map(|(_, scenes)| scenes.iter())
}

/// One unit a pixel, origin in the lower left corner, z from -1 to 1 (nearer is greater).
fn pixels(gl: &Gl) {
    gl.glMatrixMode(PROJECTION);
    gl.glLoadIdentity();
    gl.glOrtho(0.0, 64.0, 0.0, 64.0, -1.0, 1.0);
    gl.glMatrixMode(MODELVIEW);
    gl.glLoadIdentity();
}

/// A camera at (0, 0, 4) that looks at the origin; the view is 53 degrees wide.
fn camera(gl: &Gl) {
    gl.glMatrixMode(PROJECTION);
    gl.glLoadIdentity();
    gl.glFrustum(-0.5, 0.5, -0.5, 0.5, 1.0, 10.0);
    gl.glMatrixMode(MODELVIEW);
    gl.glLoadIdentity();
    gl.glTranslatef(0.0, 0.0, -4.0);
}

/// A rectangle in the plane z = 0 with texture coordinates from 0 to `repeat`.
fn textured(gl: &Gl, [x0, y0, x1, y1]: [f32; 4], repeat: f32) {
    gl.glBegin(QUADS);
    for (x, y, s, t) in
        [(x0, y0, 0.0, 0.0), (x1, y0, repeat, 0.0), (x1, y1, repeat, repeat), (x0, y1, 0.0, repeat)]
    {
        gl.glTexCoord2f(s, t);
        gl.glVertex2f(x, y);
    }
    gl.glEnd();
}

/// A square with a different colour in each corner, in the plane z. The colours lie in a plane as
/// well, so that it does not matter along which diagonal a library cuts.
fn rainbow(gl: &Gl, [x0, y0, x1, y1]: [f32; 4], z: f32) {
    gl.glBegin(QUADS);
    gl.glColor4f(1.0, 0.0, 0.0, 1.0);
    gl.glVertex3f(x0, y0, z);
    gl.glColor4f(1.0, 1.0, 0.0, 0.75);
    gl.glVertex3f(x1, y0, z);
    gl.glColor4f(0.0, 1.0, 1.0, 0.5);
    gl.glVertex3f(x1, y1, z);
    gl.glColor4f(0.0, 0.0, 1.0, 0.75);
    gl.glVertex3f(x0, y1, z);
    gl.glEnd();
}

/// Point of the unit sphere: `u` around, `v` from pole to pole, both 0..=1.
fn sphere_point(u: f32, v: f32) -> [f32; 3] {
    let (around, down) = (u * std::f32::consts::TAU, v * std::f32::consts::PI);
    [down.sin() * around.cos(), down.cos(), down.sin() * around.sin()]
}

/// A sphere with normals and texture coordinates, counter-clockwise seen from outside.
fn sphere(gl: &Gl, radius: f32, slices: usize, stacks: usize) {
    for stack in 0..stacks {
        gl.glBegin(QUAD_STRIP);
        for slice in 0..=slices {
            let u = slice as f32 / slices as f32;
            for v in [stack as f32 / stacks as f32, (stack + 1) as f32 / stacks as f32] {
                let n = sphere_point(-u, v);
                gl.glTexCoord2f(u, 1.0 - v);
                gl.glNormal3fv(&n);
                gl.glVertex3fv(&n.map(|c| c * radius));
            }
        }
        gl.glEnd();
    }
}

/// A checkerboard of `size` x `size` RGBA texels, `cell` texels a field, with a slope of red in it.
fn checks(size: usize, cell: usize) -> Vec<[u8; 4]> {
    let texel = |i: usize| {
        let (x, y) = (i % size, i / size);
        let light = (x / cell + y / cell).is_multiple_of(2);
        let red = (255 * x / (size - 1).max(1)) as u8;
        if light { [red, 255, 255, 255] } else { [red, 40, 80, 100] }
    };
    (0..size * size).map(texel).collect()
}
