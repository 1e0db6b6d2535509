//! Materials: metallic-roughness with the extensions that change what is seen.
//!
//! Source: [glTF 2.0], section 3.9; KHR_materials_emissive_strength, _ior, _transmission, _unlit;
//! for _pbrSpecularGlossiness see `specular_glossiness.rs`. Departs from it: a transmissive surface
//! becomes glass, a blended one whose opacity is what transmission leaves, with the base colour as
//! the colour of what passes; a base texture does not colour what passes.

use super::accessor::Source;
use super::specular_glossiness::SpecularGlossiness;
use super::texture::{Meaning, Reference, Wanted, transform_in};
use crate::Error;
use gltf::json::Material as JsonMaterial;
use gltf::json::material::AlphaMode as JsonAlphaMode;
use gltf::json::texture::Info;
use gltf::json::validation::Checked;
use serde_json::{Map, Value};
use vitral_light::{AlphaMode, Material, Reflectance, TextureRef, Transmission};

/// Reads material `index`. Its textures are asked for, not yet loaded.
pub(crate) fn read(
    source: &Source<'_>,
    index: usize,
    wanted: &mut Wanted,
    warnings: &mut Vec<String>,
) -> Result<Material, Error> {
    let json = &source.root.materials[index];
    let mut reader =
        Reader { source: *source, json, path: format!("materials[{index}]"), wanted, warnings };
    let older = reader.find_older_form()?;

    // Colour, reflection and opacity.
    let pbr = &json.pbr_metallic_roughness;
    let color = older.as_ref().map_or(pbr.base_color_factor.0, |o| o.diffuse_factor);
    let [r, g, b, alpha] = color.map(|v| unit(v, 1.0));
    let reflectance = older.as_ref().map_or_else(
        || Reflectance::MetallicRoughness {
            base_color: [r, g, b],
            metallic: unit(pbr.metallic_factor.0, 1.0),
            roughness: unit(pbr.roughness_factor.0, 1.0),
        },
        SpecularGlossiness::reflectance,
    );
    let (alpha_mode, opacity) = opacity(json, alpha);
    let mut material = Material {
        name: json.name.clone().unwrap_or_default(),
        reflectance,
        alpha_mode,
        opacity,
        double_sided: json.double_sided,
        front_only: !json.double_sided,
        ..Material::default()
    };

    // Extensions, then textures: transmission decides what the alpha of the base texture means.
    reader.apply_extensions(&mut material);
    reader.apply_transmission(&mut material);
    reader.ask_textures(older.as_ref(), &mut material)?;
    if older.is_some_and(|o| o.is_mirror()) && material.alpha_mode == AlphaMode::Opaque {
        material.base_texture = None;
    }
    Ok(material)
}

/// How a material's alpha counts, and its opacity.
fn opacity(json: &JsonMaterial, alpha: f32) -> (AlphaMode, f32) {
    match json.alpha_mode {
        Checked::Valid(JsonAlphaMode::Mask) => {
            (AlphaMode::Mask { cutoff: json.alpha_cutoff.map_or(0.5, |c| finite(c.0, 0.5)) }, alpha)
        }
        Checked::Valid(JsonAlphaMode::Blend) => (AlphaMode::Blend, alpha),
        Checked::Valid(JsonAlphaMode::Opaque) | Checked::Invalid => (AlphaMode::Opaque, 1.0),
    }
}

/// One material while it is read.
struct Reader<'a> {
    source: Source<'a>,
    json: &'a JsonMaterial,
    /// JSON path of the material.
    path: String,
    wanted: &'a mut Wanted,
    warnings: &'a mut Vec<String>,
}

impl Reader<'_> {
    fn warn(&mut self, what: &str) {
        self.warnings.push(format!("{}: {}: {what}", self.source.file, self.path));
    }

    /// The specular-glossiness form of the material, if it has one and no better form.
    fn find_older_form(&mut self) -> Result<Option<SpecularGlossiness>, Error> {
        let older = SpecularGlossiness::find(&self.source, self.json, &self.path)?;
        if older.as_ref().is_none_or(|o| o.specular_glossiness_texture.is_none()) {
            return Ok(older);
        }
        let pbr = &self.json.pbr_metallic_roughness;
        let newer = pbr.base_color_texture.is_some() || pbr.metallic_roughness_texture.is_some();
        let instead =
            if newer { "its metallic-roughness form is" } else { "a usual reflection is" };
        self.warn(&format!("the specularGlossinessTexture is not used, {instead} shown instead"));
        Ok(older.filter(|_| !newer))
    }

    /// Asks for the textures. Colours are sRGB in their images, all other quantities linear.
    fn ask_textures(
        &mut self,
        older: Option<&SpecularGlossiness>,
        material: &mut Material,
    ) -> Result<(), Error> {
        let json = self.json;
        let pbr = &json.pbr_metallic_roughness;
        // Transmission blends what alpha leaves opaque.
        let alpha_counts =
            !matches!(json.alpha_mode, Checked::Valid(JsonAlphaMode::Opaque) | Checked::Invalid);
        let base =
            if material.glass && !alpha_counts { Meaning::OpaqueColor } else { Meaning::Color };
        match older {
            // The older form takes the place of the other.
            Some(older) => {
                material.base_texture =
                    self.ask(older.diffuse_texture.as_ref(), base, "diffuseTexture");
            }
            None => {
                let name = "pbrMetallicRoughness.baseColorTexture";
                material.base_texture = self.ask(pbr.base_color_texture.as_ref(), base, name);
                let name = "pbrMetallicRoughness.metallicRoughnessTexture";
                let texture = pbr.metallic_roughness_texture.as_ref();
                material.metallic_roughness_texture = self.ask(texture, Meaning::Data, name);
            }
        }
        material.emission_texture =
            self.ask(json.emissive_texture.as_ref(), Meaning::Color, "emissiveTexture");
        if let Some(normal) = &json.normal_texture {
            let others = normal.extensions.as_ref().map(|e| &e.others);
            material.normal_texture =
                self.ask_data("normalTexture", normal.index.value(), normal.tex_coord, others)?;
            material.normal_scale = finite(normal.scale, 1.0);
        }
        if let Some(occlusion) = &json.occlusion_texture {
            let others = occlusion.extensions.as_ref().map(|e| &e.others);
            material.occlusion_texture = self.ask_data(
                "occlusionTexture",
                occlusion.index.value(),
                occlusion.tex_coord,
                others,
            )?;
            material.occlusion_strength = unit(occlusion.strength.0, 1.0);
        }
        Ok(())
    }

    /// Asks for the texture of the material's property `name`, if it has one.
    fn ask(&mut self, info: Option<&Info>, meaning: Meaning, name: &str) -> Option<TextureRef> {
        let info = info?;
        let path = format!("{}.{name}", self.path);
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.clone());
        let reference = Reference {
            texture: info.index.value(),
            uv_set: info.tex_coord,
            transform,
            path: &path,
        };
        self.wanted.ask(&self.source, &reference, meaning, self.warnings)
    }

    /// Asks for a texture of linear values, whose extensions are plain JSON.
    fn ask_data(
        &mut self,
        name: &str,
        texture: usize,
        uv_set: u32,
        extensions: Option<&Map<String, Value>>,
    ) -> Result<Option<TextureRef>, Error> {
        let path = format!("{}.{name}", self.path);
        let transform = match extensions {
            Some(extensions) => transform_in(extensions, &path, &self.source)?,
            None => None,
        };
        let reference = Reference { texture, uv_set, transform, path: &path };
        Ok(self.wanted.ask(&self.source, &reference, Meaning::Data, self.warnings))
    }

    /// Emission, index of refraction, unlit.
    fn apply_extensions(&mut self, material: &mut Material) {
        let extensions = self.json.extensions.clone().unwrap_or_default();
        let strength = extensions
            .emissive_strength
            .map_or(1.0, |e| finite(e.emissive_strength.0, 1.0).max(0.0));
        material.emission =
            self.json.emissive_factor.0.map(|v| finite(finite(v, 0.0).max(0.0) * strength, 0.0));
        material.unlit = extensions.unlit.is_some();
        if let Some(ior) = extensions.ior {
            match ior.ior.0 {
                n if n >= 1.0 && n.is_finite() => material.ior = n,
                0.0 => self.warn(
                    "an index of refraction of 0 (no light enters) is not shown, 1.5 is used",
                ),
                n => self.warn(&format!(
                    "an index of refraction of {n}, 1 or more is required; 1.5 is used"
                )),
            }
        }
    }

    /// Makes a transmissive surface glass. Where a texture says how much passes, the rest becomes
    /// the texture of the opacity.
    fn apply_transmission(&mut self, material: &mut Material) {
        let json = self.json;
        let Some(transmission) = json.extensions.as_ref().and_then(|e| e.transmission.as_ref())
        else {
            return;
        };
        let factor = unit(transmission.transmission_factor.0, 0.0);
        // Of glass that is partly metal, or in places, shading knows how much passes.
        let textured = json.pbr_metallic_roughness.metallic_roughness_texture.is_some();
        let metal =
            matches!(material.reflectance, Reflectance::MetallicRoughness { metallic: 1.0, .. })
                && !textured;
        if factor == 0.0 || metal {
            return;
        }
        if matches!(material.alpha_mode, AlphaMode::Mask { .. }) {
            self.warn("a cut-out surface is not transmissive as well, transmission is not used");
            return;
        }
        material.filter = filter(material, factor);
        match &transmission.transmission_texture {
            None => material.opacity *= 1.0 - factor,
            Some(info) => {
                let name = "extensions.KHR_materials_transmission.transmissionTexture";
                material.opacity_texture =
                    self.ask(Some(info), Meaning::Transmission(factor), name);
            }
        }
        material.alpha_mode = AlphaMode::Blend;
        material.transmission = Transmission::Transparent;
        material.glass = true;
    }
}

/// The colour of all light that passes a material of which the part `factor` is transmissive: what
/// goes through the surface takes its base colour, what goes past it, where alpha is below 1, stays
/// white.
fn filter(material: &Material, factor: f32) -> [f32; 3] {
    let Reflectance::MetallicRoughness { base_color, .. } = material.reflectance else {
        return material.filter;
    };
    let (past, through) = (1.0 - material.opacity, material.opacity * factor);
    if through > 0.0 {
        base_color.map(|c| (past + through * c) / (past + through))
    } else {
        [1.0; 3]
    }
}

/// `value`, or `or` if it is not finite.
fn finite(value: f32, or: f32) -> f32 {
    if value.is_finite() { value } else { or }
}

/// `value` clamped to `0..=1`, or `or` if it is not finite.
fn unit(value: f32, or: f32) -> f32 {
    finite(value, or).clamp(0.0, 1.0)
}
