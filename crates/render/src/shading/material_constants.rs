//! A material in a frame: its model, its textures, and how it lets light through.

use super::model::Model;
use crate::display::DecodeTables;
use crate::{Global, PreparedView, Settings};
use vitral_frame::Texture;
use vitral_light::{
    AlphaMode, Material, Reflectance, TextureRef, Transmission, mirroring_exponent,
    scattering_exponent,
};

/// A texture as a material uses it, ready to sample.
pub(crate) struct TextureConstants<'a> {
    pub texture: &'a Texture,
    pub reference: TextureRef,
    pub decode: &'a [f32; 256],
}

/// A material, ready for the formulas.
pub(crate) struct MaterialConstants<'a> {
    pub material: Material,
    pub model: Model,
    pub base: Option<TextureConstants<'a>>,
    pub specular: Option<TextureConstants<'a>>,
    pub emission: Option<TextureConstants<'a>>,
    pub opacity: Option<TextureConstants<'a>>,
    pub metallic_roughness: Option<TextureConstants<'a>>,
    pub occlusion: Option<TextureConstants<'a>>,
    pub normal: Option<TextureConstants<'a>>,
    /// Below this alpha nothing is there (cut-outs), else `None`.
    pub cutoff: Option<f32>,
    /// Its cut-outs have soft borders, a pixel wide: pixels have several samples, which do not
    /// decide by themselves.
    pub soft_cut: bool,
    /// Alpha matters.
    pub blend: bool,
    /// It mirrors the soft sky or the image of the surroundings, where rays do not show what is
    /// there.
    pub mirrors_sky: bool,
    /// Rays that meet it are followed on.
    pub follows: bool,
    /// It is translucent: the exponent with which it scatters what passes.
    pub scatters: Option<f32>,
    /// It shows blurred mirror images: the exponent with which it scatters them.
    pub blurs: Option<f32>,
}

impl<'a> MaterialConstants<'a> {
    /// Of a material of the scene.
    pub(super) fn new(
        material: &Material,
        view: &'a PreparedView<'a>,
        settings: &Settings,
        tables: &'a DecodeTables,
    ) -> Self {
        let scene = &view.session.scene;

        // Find the textures.
        let texture = |reference: Option<TextureRef>| {
            let reference = reference?;
            let texture = scene.textures.get(reference.texture as usize)?;
            Some(TextureConstants { texture, reference, decode: tables.table(texture.encoding) })
        };

        // Decide how alpha counts.
        let (cutoff, blend) = match material.alpha_mode {
            AlphaMode::Opaque => (None, false),
            AlphaMode::Mask { cutoff } => (Some(AlphaMode::least_opacity(cutoff)), false),
            AlphaMode::Blend => (None, settings.transparency.model.sees_through()),
        };

        // Collect everything.
        let traced = settings.global.model == Global::RayTrace;
        let mut material = material.clone();
        let is_polished = traced && !material.mirror && is_polished_metal(&material);
        material.mirror |= is_polished;
        Self {
            model: Model::of_material(
                &material,
                settings.shading.illumination,
                settings.shading.lighting,
            ),
            base: texture(material.base_texture),
            specular: texture(material.specular_texture),
            emission: texture(material.emission_texture),
            opacity: texture(material.opacity_texture),
            metallic_roughness: texture(material.metallic_roughness_texture),
            occlusion: texture(material.occlusion_texture),
            normal: texture(material.normal_texture),
            cutoff,
            soft_cut: cutoff.is_some() && view.pattern.len() > 1 && !traced,
            blend,
            mirrors_sky: !(traced && material.mirror),
            follows: traced && (cutoff.is_some() || blend || material.mirror),
            scatters: (blend && material.transmission == Transmission::Translucent)
                .then(|| scattering_exponent(&material.reflectance)),
            blurs: mirroring_exponent(&material.reflectance).filter(|_| is_polished),
            material,
        }
    }
}

/// Whether rays that a surface mirrors show its surroundings: a metal that is all but smooth.
fn is_polished_metal(material: &Material) -> bool {
    const MOST_ROUGHNESS: f32 = 0.2;
    const LEAST_METALLIC: f32 = 0.5;
    let varies = material.metallic_roughness_texture.is_some();
    matches!(material.reflectance, Reflectance::MetallicRoughness { metallic, roughness, .. }
        if !varies && metallic >= LEAST_METALLIC && roughness <= MOST_ROUGHNESS)
}

impl MaterialConstants<'_> {
    /// Whether something may be seen behind it.
    pub(super) fn is_layered(&self) -> bool {
        self.cutoff.is_some() || self.blend
    }

    /// Whether textures vary it.
    pub(super) fn has_textures(&self) -> bool {
        let Self {
            base, specular, emission, opacity, metallic_roughness, occlusion, normal, ..
        } = self;
        [base, specular, emission, opacity, metallic_roughness, occlusion, normal]
            .iter()
            .any(|texture| texture.is_some())
    }
}
