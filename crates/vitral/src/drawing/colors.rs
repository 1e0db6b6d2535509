//! The colours of filled drawings.
//!
//! Shaded faces have the light of flat shading, in steps: faces of one material and step become one
//! region. A step is one of a brightness and not of a colour. What the light makes of the
//! material's own colour is divided into the brightest of three factors, which is rounded, and the
//! ratios of the others to it: they are 1 under white light without a highlight, whatever the
//! material.
//!
//! In:   what faces look like. Out: sRGB.
//! Cost: the lights of each face.

use super::{ColorBy, FillSettings};
use crate::Renderer;
use vitral_draw::FaceLook;
use vitral_frame::{Encoding, Texture};
use vitral_light::{Material, Rgb, constant_color};
use vitral_math::color::{byte_from_unit, linear_from_srgb, srgb_from_linear};
use vitral_math::{DVec3, Vec3};
use vitral_render::shading::face_colors::{FaceColors, FacePlace};
use vitral_scene::{Camera, Instance, depth_range};

/// The least of a material's colour that factors are told by.
const LEAST_BASE: f32 = 0.02;
/// Steps of the ratios between the factors of three channels.
const RATIO_STEPS: f32 = 64.0;
/// How far the hues of parts that follow each other are apart, in turns: the golden ratio leaves
/// none near to another.
const HUE_STEP: f64 = 0.618_033_988_749_895;

/// Gives faces their colours.
pub(crate) struct Colors<'r> {
    renderer: &'r Renderer,
    light: FaceColors,
    fill: FillSettings,
    usual: Material,
    /// The part of each surface, where colours tell it.
    parts: Vec<u32>,
}

impl<'r> Colors<'r> {
    pub(crate) fn new(renderer: &'r Renderer, camera: &Camera, fill: &FillSettings) -> Self {
        let view =
            camera.transform(renderer.aspect(), depth_range(camera, &renderer.world().bounds));
        let (lights, ambient) = (renderer.frame_lights(camera), renderer.frame_ambient());
        let light = FaceColors::new(renderer.settings.shading, &view, &lights, ambient);
        let parts = match fill.color_by {
            ColorBy::Part => renderer.world().parts_of_surfaces(&renderer.execution().workers),
            _ => Vec::new(),
        };
        Self { renderer, light, fill: *fill, usual: Material::default(), parts }
    }

    /// The colour of a face.
    pub(crate) fn of(&self, look: &FaceLook) -> [u8; 3] {
        let world = self.renderer.world();
        let instance = &world.instances[world.instance_of_facet(look.facet)];
        let face = instance.mesh.face_of_triangle((look.facet - instance.first_facet) as usize);
        let material =
            look.material.and_then(|index| self.renderer.scene().materials.get(index as usize));
        let material = material.unwrap_or(&self.usual);
        let own = |material: &Material, base: Rgb| {
            let constant = constant_color(material);
            [0, 1, 2].map(|k| constant[k] * base[k])
        };
        match self.fill.color_by {
            ColorBy::None => [255; 3],
            ColorBy::Part => hue_of_part(self.parts[look.surface as usize] as usize),
            ColorBy::Material => encoded(own(material, self.base_of(instance, face, material))),
            ColorBy::Shading => {
                let base = self.base_of(instance, face, material);
                let normal = Vec3::from_array(look.normal).as_dvec3();
                let place = FacePlace { position: center_of(instance, face), normal, base };
                let reaches = |light: usize| light >= 32 || look.lights >> light & 1 == 1;
                let color = self.light.color(material, &place, reaches);
                encoded(in_steps(color, own(material, base), self.fill.shades))
            }
        }
    }

    /// What vertex colours and textures make of a material's colour: the mean of a face, and that
    /// of the whole texture.
    fn base_of(&self, instance: &Instance, face: usize, material: &Material) -> Rgb {
        let vertices = vertex_color(instance, face);
        let textures = &self.renderer.scene().textures;
        let texture =
            material.base_texture.and_then(|reference| textures.get(reference.texture as usize));
        let texture = texture.map_or([1.0; 3], |texture| mean_of(texture));
        [0, 1, 2].map(|k| vertices[k] * texture[k])
    }
}

/// The mean colour of a texture, linear: its smallest level.
fn mean_of(texture: &Texture) -> Rgb {
    let Some([r, g, b, _]) = texture.levels.last().map(|level| level.row(0)[0]) else {
        return [1.0; 3];
    };
    let decoded = |byte: u8| match texture.encoding {
        Encoding::Linear => f32::from(byte) / 255.0,
        Encoding::Srgb => linear_from_srgb(f32::from(byte) / 255.0),
    };
    [r, g, b].map(decoded)
}

/// The mean colour of the vertices of a face, linear; white without any.
fn vertex_color(instance: &Instance, face: usize) -> Rgb {
    let Some(colors) = &instance.mesh.colors else { return [1.0; 3] };
    let triangles = instance.mesh.face_triangles(face);
    let count = 3.0 * triangles.len() as f32;
    let mut sum = [0.0; 3];
    for color in triangles.flat_map(|t| colors.at(t, &instance.mesh.triangles)) {
        (0..3).for_each(|k| sum[k] += color[k]);
    }
    sum.map(|s| s / count)
}

/// The mean of the corners of a face, world space.
fn center_of(instance: &Instance, face: usize) -> DVec3 {
    let corners = instance.mesh.face_corners(face);
    corners.iter().map(|&corner| instance.place(corner)).sum::<DVec3>() / corners.len() as f64
}

/// A linear colour in steps of brightness, see the module; `own` is that of the material.
fn in_steps(color: Rgb, own: Rgb, shades: u32) -> Rgb {
    let own = own.map(|c| c.max(LEAST_BASE));
    let factors = [0, 1, 2].map(|k| (color[k] / own[k]).max(0.0));
    let brightest = factors.into_iter().fold(0.0, f32::max);
    if brightest == 0.0 {
        return [0.0; 3];
    }
    let steps = shades.max(1) as f32;
    let step = (srgb_from_linear(brightest.min(1.0)) * steps).round() / steps;
    // Light that is brighter than white is as bright as it is in pictures, and none of the steps is
    // black.
    let rounded = if brightest > 1.0 { brightest } else { linear_from_srgb(step.max(0.5 / steps)) };
    [0, 1, 2]
        .map(|k| own[k] * rounded * ((factors[k] / brightest) * RATIO_STEPS).round() / RATIO_STEPS)
}

fn encoded(linear: Rgb) -> [u8; 3] {
    linear.map(|c| byte_from_unit(srgb_from_linear(c)))
}

/// A colour for each part: light, with hues that are far from each other for parts that follow each
/// other.
fn hue_of_part(number: usize) -> [u8; 3] {
    let turns = number as f64 * HUE_STEP;
    let hue = (turns - turns.floor()) * 6.0;
    // A channel is full for a third of the turn and falls to both sides.
    let channel = |at: f64| {
        let away = (hue - at).abs();
        let away = away.min(6.0 - away);
        let full = (2.0 - away).clamp(0.0, 1.0);
        byte_from_unit((0.45 + 0.5 * full) as f32)
    };
    [channel(0.0), channel(2.0), channel(4.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_keep_the_hue_of_the_material() {
        let own = [0.8, 0.4, 0.1];
        let lit = own.map(|c| c * 0.37);
        let stepped = in_steps(lit, own, 8);
        assert!(
            (stepped[0] / stepped[1] - 2.0).abs() < 1e-5
                && (stepped[1] / stepped[2] - 4.0).abs() < 1e-4
        );
        // sRGB of 0.37 is 0.643: the nearest of eight steps is 0.625.
        assert!((srgb_from_linear(stepped[0] / own[0]) - 0.625).abs() < 1e-3);
        // What differs little is in one step.
        assert_eq!(stepped, in_steps(own.map(|c| c * 0.375), own, 8));
        assert_eq!(in_steps([0.0; 3], own, 8), [0.0; 3]);
    }

    #[test]
    fn parts_that_follow_each_other_differ() {
        let all: Vec<[u8; 3]> = (0..12).map(hue_of_part).collect();
        for (i, a) in all.iter().enumerate() {
            for b in &all[..i] {
                assert!((0..3).any(|k| a[k].abs_diff(b[k]) > 12), "{a:?} {b:?}");
            }
        }
    }
}
