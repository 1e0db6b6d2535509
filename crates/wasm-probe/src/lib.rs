//! One scene, for the test that native code and WebAssembly give the same bytes.
//!
//! `cargo xtask test` builds this library for `wasm32-unknown-unknown`, plain and with simd128,
//! lets Node hash what [`render`] draws, and compares with the hash that this crate's program
//! prints natively.
//!
//! What is drawn: Lab3D's scene 1 through its own camera, smooth with all data planes, then as
//! faceted Cook-Torrance with edges. So culling, clipping, rasterising, three shading models, marks
//! and both colour spaces take part. Then the same scene as a vector drawing: visible and hidden
//! lines, intersections, and regions.

// Exporting a function by its name is the only way out of a WebAssembly module, and the attribute
// for it is unsafe because two functions of one name would collide. There is no unsafe block.
#![allow(unsafe_code)]

use std::sync::{Arc, OnceLock};
use vitral_draw::{Classes, DrawingSettings, FaceLook, Surfaces};
use vitral_exec::{Budget, Workers};
use vitral_frame::Frame;
use vitral_light::Illumination;
use vitral_math::lanes::Level;
use vitral_render::{
    Channels, ColorSpace, Execution, Lines, Session, Settings, Shading, Shot, Surroundings,
};
use vitral_scene::{Camera, Projection, World, builtin};

/// Width and height of the pictures in pixels; the last tiles are not full.
const SIZE: (u32, u32) = (140, 100);

/// The pictures: RGBA colours of all, then depths, surface ids and normals of the first, and the
/// points of the drawing, little-endian.
pub fn picture() -> Vec<u8> {
    let mut bytes = draw(Level::new());
    bytes.extend(drawing(&Workers::single()));
    bytes
}

/// The corners of all lines and regions of a drawing, in millimetres.
fn drawing(workers: &Workers) -> Vec<u8> {
    let world = World::new(&builtin::scene("scene1").expect("scene1 is built in"))
        .expect("built-in scenes are sound");
    let settings =
        DrawingSettings { lines: Classes::ALL, hidden_layers: 2, ..DrawingSettings::default() };
    let palette = |look: &FaceLook| look.normal.map(|c| if c > 0.5 { 200 } else { 100 });
    let surfaces = Surfaces::new(&palette);
    let drawn = vitral_draw::draw(
        &world,
        &world.cameras[0],
        1.4,
        &settings,
        Some(&surfaces),
        workers,
        &Budget::default(),
    );
    let drawing = drawn.expect("there are no limits").drawing;
    let outlines = drawing.regions.iter().flat_map(|region| &region.rings);
    let points = drawing.lines.iter().map(|line| &line.points).chain(outlines).flatten();
    points.flatten().flat_map(|c| c.to_le_bytes()).collect()
}

/// FNV-1a, 64 bits: the hash that `run.mjs` computes as well.
pub fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

static PICTURE: OnceLock<Vec<u8>> = OnceLock::new();

/// Address of the pictures' first byte, for JavaScript.
#[unsafe(no_mangle)]
pub extern "C" fn render() -> *const u8 {
    PICTURE.get_or_init(picture).as_ptr()
}

/// Number of the pictures' bytes, for JavaScript.
#[unsafe(no_mangle)]
pub extern "C" fn length() -> usize {
    PICTURE.get_or_init(picture).len()
}

fn draw(level: Level) -> Vec<u8> {
    // Set up the scene.
    let scene = Arc::new(builtin::scene("scene1").expect("scene1 is built in"));
    let mut session = Session::new(scene).expect("built-in scenes are sound");
    let execution =
        Execution { workers: Workers::single(), level, budget: Budget::default(), observer: None };
    let camera = session.world().cameras[0];

    // Take different ways of shading.
    let smooth = Settings::default().with_size(SIZE.0, SIZE.1).with_channels(Channels {
        depth: true,
        surface: true,
        normal: true,
        ..Channels::default()
    });
    let gouraud = smooth
        .clone()
        .with_shading(Shading::Gouraud)
        .with_color_space(ColorSpace::Raw)
        .with_channels(Channels::default());
    let faceted = smooth
        .clone()
        .with_shading(Shading::Flat)
        .with_illumination(Illumination::CookTorrance)
        .with_lines(Lines::Edges)
        .with_samples(1)
        .with_channels(Channels::default());

    // Look from close by, so that facets are clipped.
    let near = Camera {
        position: camera.position * 0.35,
        projection: Projection::Perspective { view_angle: 1.3 },
        ..camera
    };

    // Render the frames.
    let mut frame = |settings: &Settings, camera: Camera| {
        let lights = session.world().lights.clone();
        let shot = Shot {
            camera,
            lights: &lights,
            ambient: [0.05; 3],
            surroundings: Surroundings::default(),
        };
        vitral_render::render(&mut session, &shot, settings, &execution)
            .expect("there are no limits")
            .frame
    };
    let frames = [frame(&smooth, camera), frame(&gouraud, near), frame(&faceted, camera)];
    bytes(&frames)
}

/// The frames' planes as bytes.
fn bytes(frames: &[Frame]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for frame in frames {
        bytes.extend(frame.color.iter().flat_map(|plane| plane.data().as_flattened()));
        bytes.extend(
            frame.depth.iter().flat_map(|plane| plane.data()).flat_map(|z| z.to_le_bytes()),
        );
        bytes.extend(
            frame.surface.iter().flat_map(|plane| plane.data()).flat_map(|id| id.to_le_bytes()),
        );
        let normals = frame.normal.iter().flat_map(|plane| plane.data().as_flattened());
        bytes.extend(normals.flat_map(|n| n.to_le_bytes()));
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::lanes::available_levels;

    #[test]
    fn every_level_draws_the_same_pictures() {
        let pictures = draw(Level::new());
        for (name, level) in available_levels() {
            assert!(draw(level) == pictures, "{name}");
        }
        // Three colour planes, and 4 + 4 + 12 bytes of data for each pixel of the first.
        let pixels = (SIZE.0 * SIZE.1) as usize;
        assert_eq!(pictures.len(), pixels * (3 * 4 + 20));
        assert_ne!(
            pictures[..4],
            pictures[pixels * 2..][..4],
            "the middle differs from the corner"
        );
    }

    #[test]
    fn drawings_do_not_depend_on_threads() {
        let bytes = drawing(&Workers::single());
        assert!(
            bytes.len() > 1000 && bytes == drawing(&Workers::new(3)) && picture().ends_with(&bytes)
        );
    }

    #[test]
    fn the_hash_has_its_published_values() {
        assert_eq!(fnv1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a(b"a"), 0xaf63_dc4c_8601_ec8c);
    }
}
