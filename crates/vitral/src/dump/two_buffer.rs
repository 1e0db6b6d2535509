//! The buffers of the two-buffer order of transparency, one sample a pixel.

use super::stage::{Listed, Write};
use crate::picture::{self, Channel, EncodeOptions, PictureFormat};
use crate::{Error, Frame, Renderer};
use std::fmt::Write as _;
use vitral_frame::{Plane, TwoBuffers};
use vitral_io::encode;
use vitral_math::color::{byte_from_unit, srgb_from_linear};
use vitral_render::{ColorSpace, PreparedView};
use vitral_scene::Camera;

/// The list of transparent surfaces, in its order: that of the scene.
pub(super) fn list(view: &PreparedView<'_>) -> String {
    let (world, materials) = (view.session.world(), &view.session.scene().materials);
    let mut text = "facet,surface,material\n".to_owned();
    for prepared in &view.instances {
        let instance = &world.instances[prepared.instance];
        for draw in &prepared.layered {
            for triangle in draw.ranges.iter().cloned().flatten() {
                let facet = draw.first_facet + triangle;
                let material = instance.mesh.material_of_triangle(triangle as usize);
                let name = material.and_then(|m| materials.get(m as usize)).map_or("", |m| &m.name);
                let name = name.replace('"', "\"\"");
                // Writing to a String cannot fail.
                let _ = writeln!(text, "{facet},{},\"{name}\"", world.surface_of_facet(facet));
            }
        }
    }
    text
}

/// Renders the buffers that `camera` sees, and writes them.
pub(super) fn write(
    renderer: &mut Renderer,
    camera: &Camera,
    put: &mut Write<'_>,
) -> Result<Vec<Listed>, Error> {
    // Render the buffers at one sample a pixel, and restore the settings.
    let settings = renderer.settings.clone();
    renderer.settings.picture.samples = 1;
    renderer.settings.picture.channels =
        vitral_render::Channels { buffers: true, ..Default::default() };
    let rendered = renderer.render_from(camera);
    renderer.settings = settings;
    let mut frame = rendered?.frame;
    let buffers = frame.buffers.take().unwrap_or_default();
    let raw = renderer.settings.picture.color_space == ColorSpace::Raw;
    let TwoBuffers { opaque, depth, layers, intensity, coefficient } = &buffers;
    let most = layers.data().iter().copied().max().unwrap_or(0);

    // Define how a plane becomes a file.
    let mut listed = Vec::new();
    let mut file = |name: &'static str, what: String, bytes: Vec<u8>| {
        listed.push(Listed { name: name.to_owned(), what });
        put(name, &bytes)
    };
    let shown = |plane: &Plane<[f32; 4]>| plane.map(|&c| bytes(c, raw));
    let png = |plane: Plane<[u8; 4]>, srgb: bool| {
        let frame = Frame {
            width: plane.width(),
            height: plane.height(),
            color: Some(plane),
            ..Frame::default()
        };
        picture::encode_with(
            &frame,
            Channel::Color,
            PictureFormat::Png,
            &EncodeOptions { srgb, ..Default::default() },
        )
    };

    // Write the first buffer: colour and depth of what is opaque.
    let opaque_rgb = opaque.map(|&[r, g, b, _]| [r, g, b]);
    file("9-opaque.png", "first buffer: what is opaque".to_owned(), png(shown(opaque), !raw)?)?;
    file(
        "9-opaque.npy",
        "the same, premultiplied numbers".to_owned(),
        encode::npy_f32x3(&opaque_rgb),
    )?;
    file("9-opaque-depth.npy", "its depth".to_owned(), encode::npy_f32(depth))?;

    // Write the second buffer: layers, intensity and coefficient of what is transparent.
    let what = format!("surfaces of the list in front of that, {most} at most");
    file("9-transparent-layers.npy", what, encode::npy_u32(layers))?;
    let light = intensity.map(|&[r, g, b]| bytes([r, g, b, 1.0], raw));
    file(
        "9-transparent-intensity.png",
        "second buffer: intensity I".to_owned(),
        png(light, !raw)?,
    )?;
    file(
        "9-transparent-intensity.npy",
        "the same, numbers".to_owned(),
        encode::npy_f32x3(intensity),
    )?;
    let k = coefficient.map(|&[r, g, b]| [r, g, b, 1.0].map(byte_from_unit));
    file("9-transparent-k.png", "its coefficient k, a channel each".to_owned(), png(k, false)?)?;
    file("9-transparent-k.npy", "the same, numbers".to_owned(), encode::npy_f32x3(coefficient))?;

    // Write both buffers together.
    let combined = frame.color.take().unwrap_or_default();
    file(
        "9-combined.png",
        "both together: I + (1 - k) of what is opaque".to_owned(),
        png(combined, !raw)?,
    )?;
    Ok(listed)
}

/// A premultiplied colour as display bytes.
fn bytes([r, g, b, a]: [f32; 4], raw: bool) -> [u8; 4] {
    let straight = |c: f32| if a > 0.0 { c / a } else { 0.0 };
    let encoded = |c: f32| byte_from_unit(if raw { c } else { srgb_from_linear(c) });
    let [r, g, b] = [r, g, b].map(|c| encoded(straight(c)));
    [r, g, b, byte_from_unit(a)]
}
