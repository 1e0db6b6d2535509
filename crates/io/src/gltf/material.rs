//! Materials: metallic-roughness with the extensions that change what is seen.
//!
//! Source: [glTF 2.0], section 3.9; KHR_materials_emissive_strength, _ior, _transmission, _unlit; for _pbrSpecularGlossiness see
//! `specular_glossiness.rs`.
//! Departs from it: a transmissive surface becomes glass, a blended one whose opacity is what transmission leaves, with the
//! base colour as the colour of what passes; a base texture does not colour what passes.

use super::accessor::Source;
use super::specular_glossiness::SpecularGlossiness;
use super::texture::{Meaning, Reference, Wanted, transform_in};
use crate::Error;
use gltf::json::Material as JsonMaterial;
use gltf::json::material::AlphaMode as JsonAlphaMode;
use gltf::json::texture::Info;
use gltf::json::validation::Checked;
use vitral_light::{AlphaMode, Material, Reflectance, TextureRef, Transmission};

/// Reads material `index`. Its textures are asked for, not yet loaded.
pub(crate) fn read(
    source: &Source<'_>,
    index: usize,
    wanted: &mut Wanted,
    warnings: &mut Vec<String>,
) -> Result<Material, Error> {
    let json = &source.root.materials[index];
    let path = format!("materials[{index}]");
    let pbr = &json.pbr_metallic_roughness;
    let mut older = SpecularGlossiness::find(source, json, &path)?;
    if older.as_ref().is_some_and(|o| o.specular_glossiness_texture.is_some()) {
        let newer = pbr.base_color_texture.is_some() || pbr.metallic_roughness_texture.is_some();
        let instead = if newer { "its metallic-roughness form is" } else { "a usual reflection is" };
        let what = format!("the specularGlossinessTexture is not used, {instead} shown instead");
        warnings.push(format!("{}: {path}: {what}", source.file));
        older = older.filter(|_| !newer);
    }
    let color = older.as_ref().map_or(pbr.base_color_factor.0, |o| o.diffuse_factor);
    let [r, g, b, alpha] = color.map(|v| unit(v, 1.0));
    let mut material = Material {
        name: json.name.clone().unwrap_or_default(),
        reflectance: older.as_ref().map_or_else(
            || Reflectance::MetallicRoughness {
                base_color: [r, g, b],
                metallic: unit(pbr.metallic_factor.0, 1.0),
                roughness: unit(pbr.roughness_factor.0, 1.0),
            },
            SpecularGlossiness::reflectance,
        ),
        double_sided: json.double_sided,
        ..Material::default()
    };
    (material.alpha_mode, material.opacity) = match json.alpha_mode {
        Checked::Valid(JsonAlphaMode::Mask) => {
            (AlphaMode::Mask { cutoff: json.alpha_cutoff.map_or(0.5, |c| finite(c.0, 0.5)) }, alpha)
        }
        Checked::Valid(JsonAlphaMode::Blend) => (AlphaMode::Blend, alpha),
        Checked::Valid(JsonAlphaMode::Opaque) | Checked::Invalid => (AlphaMode::Opaque, 1.0),
    };
    apply_extensions(source, json, &path, &mut material, warnings);
    apply_transmission(source, json, &path, &mut material, wanted, warnings);

    ask_textures(source, json, older.as_ref(), &path, &mut material, wanted, warnings)?;
    if older.is_some_and(|o| o.is_mirror()) && material.alpha_mode == AlphaMode::Opaque {
        material.base_texture = None;
    }
    Ok(material)
}

/// Asks for the textures. Colours are sRGB in their images, all other quantities linear.
fn ask_textures(
    source: &Source<'_>,
    json: &JsonMaterial,
    older: Option<&SpecularGlossiness>,
    path: &str,
    material: &mut Material,
    wanted: &mut Wanted,
    warnings: &mut Vec<String>,
) -> Result<(), Error> {
    let pbr = &json.pbr_metallic_roughness;
    // Transmission blends what alpha leaves opaque.
    let alpha_counts = !matches!(json.alpha_mode, Checked::Valid(JsonAlphaMode::Opaque) | Checked::Invalid);
    let base = if material.glass && !alpha_counts { Meaning::OpaqueColor } else { Meaning::Color };
    let mut ask = |info: &Option<Info>, meaning, name: &str| -> Option<TextureRef> {
        ask_info(source, info.as_ref()?, meaning, &format!("{path}.{name}"), wanted, warnings)
    };
    match older {
        // The older form takes the place of the other.
        Some(older) => {
            material.base_texture = ask(&older.diffuse_texture, base, "diffuseTexture");
        }
        None => {
            let name = "pbrMetallicRoughness.baseColorTexture";
            material.base_texture = ask(&pbr.base_color_texture, base, name);
            let name = "pbrMetallicRoughness.metallicRoughnessTexture";
            material.metallic_roughness_texture = ask(&pbr.metallic_roughness_texture, Meaning::Data, name);
        }
    }
    material.emission_texture = ask(&json.emissive_texture, Meaning::Color, "emissiveTexture");
    if let Some(normal) = &json.normal_texture {
        let path = format!("{path}.normalTexture");
        let transform = match &normal.extensions {
            Some(extensions) => transform_in(&extensions.others, &path, source)?,
            None => None,
        };
        let reference = Reference { texture: normal.index.value(), uv_set: normal.tex_coord, transform, path: &path };
        material.normal_texture = wanted.ask(source, &reference, Meaning::Data, warnings);
        material.normal_scale = finite(normal.scale, 1.0);
    }
    if let Some(occlusion) = &json.occlusion_texture {
        let path = format!("{path}.occlusionTexture");
        let transform = match &occlusion.extensions {
            Some(extensions) => transform_in(&extensions.others, &path, source)?,
            None => None,
        };
        let (texture, uv_set) = (occlusion.index.value(), occlusion.tex_coord);
        let reference = Reference { texture, uv_set, transform, path: &path };
        material.occlusion_texture = wanted.ask(source, &reference, Meaning::Data, warnings);
        material.occlusion_strength = unit(occlusion.strength.0, 1.0);
    }
    Ok(())
}

/// Asks for the texture of the reference `info` at `path`.
fn ask_info(
    source: &Source<'_>,
    info: &Info,
    meaning: Meaning,
    path: &str,
    wanted: &mut Wanted,
    warnings: &mut Vec<String>,
) -> Option<TextureRef> {
    let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.clone());
    let reference = Reference { texture: info.index.value(), uv_set: info.tex_coord, transform, path };
    wanted.ask(source, &reference, meaning, warnings)
}

/// Emission, index of refraction, unlit.
fn apply_extensions(
    source: &Source<'_>,
    json: &JsonMaterial,
    path: &str,
    material: &mut Material,
    warnings: &mut Vec<String>,
) {
    let mut warn = |what: &str| warnings.push(format!("{}: {path}: {what}", source.file));
    let extensions = json.extensions.clone().unwrap_or_default();
    let strength = extensions.emissive_strength.map_or(1.0, |e| finite(e.emissive_strength.0, 1.0).max(0.0));
    material.emission = json.emissive_factor.0.map(|v| finite(finite(v, 0.0).max(0.0) * strength, 0.0));
    material.unlit = extensions.unlit.is_some();
    if let Some(ior) = extensions.ior {
        match ior.ior.0 {
            n if n >= 1.0 && n.is_finite() => material.ior = n,
            0.0 => warn("an index of refraction of 0 (no light enters) is not shown, 1.5 is used"),
            n => warn(&format!("an index of refraction of {n}, 1 or more is required; 1.5 is used")),
        }
    }
}

/// Makes a transmissive surface glass. Where a texture says how much passes, the rest becomes the texture of the opacity.
fn apply_transmission(
    source: &Source<'_>,
    json: &JsonMaterial,
    path: &str,
    material: &mut Material,
    wanted: &mut Wanted,
    warnings: &mut Vec<String>,
) {
    let Some(transmission) = json.extensions.as_ref().and_then(|e| e.transmission.as_ref()) else { return };
    let factor = unit(transmission.transmission_factor.0, 0.0);
    // Of glass that is partly metal, or in places, shading knows how much passes.
    let textured = json.pbr_metallic_roughness.metallic_roughness_texture.is_some();
    let metal = matches!(material.reflectance, Reflectance::MetallicRoughness { metallic: 1.0, .. }) && !textured;
    if factor == 0.0 || metal {
        return;
    }
    if matches!(material.alpha_mode, AlphaMode::Mask { .. }) {
        let what = "a cut-out surface is not transmissive as well, transmission is not used";
        warnings.push(format!("{}: {path}: {what}", source.file));
        return;
    }
    material.filter = filter(material, factor);
    match &transmission.transmission_texture {
        None => material.opacity *= 1.0 - factor,
        Some(info) => {
            let path = format!("{path}.extensions.KHR_materials_transmission.transmissionTexture");
            material.opacity_texture = ask_info(source, info, Meaning::Transmission(factor), &path, wanted, warnings);
        }
    }
    material.alpha_mode = AlphaMode::Blend;
    material.transmission = Transmission::Transparent;
    material.glass = true;
}

/// The colour of all light that passes a material of which the part `factor` is transmissive: what goes through the surface
/// takes its base colour, what goes past it, where alpha is below 1, stays white.
fn filter(material: &Material, factor: f32) -> [f32; 3] {
    let Reflectance::MetallicRoughness { base_color, .. } = material.reflectance else { return material.filter };
    let (past, through) = (1.0 - material.opacity, material.opacity * factor);
    if through > 0.0 { base_color.map(|c| (past + through * c) / (past + through)) } else { [1.0; 3] }
}

/// `value`, or `or` if it is not finite.
fn finite(value: f32, or: f32) -> f32 {
    if value.is_finite() { value } else { or }
}

/// `value` clamped to `0..=1`, or `or` if it is not finite.
fn unit(value: f32, or: f32) -> f32 {
    finite(value, or).clamp(0.0, 1.0)
}
