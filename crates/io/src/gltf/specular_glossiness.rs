//! The older form of materials, diffuse and specular colour with a glossiness, as
//! metallic-roughness.
//!
//! A specular-glossiness surface reflects `c = diffuse (1 - max specular)` diffusely and
//! `f = specular` head on; a metallic-roughness one `b (1 - m)` and `0.04 (1 - m) + b m`. For
//! brightnesses, the sum of the second two without the `0.04` is `b`, so
//! `b² - (c + f) b + 0.04 c = 0`; the greater root and `m = 1 - c / b` are the only ones with
//! `0 <= m <= 1`. Then `b = c + f - 0.04 (1 - m)`, channel by channel.
//! `roughness = 1 - glossiness`.
//!
//! In:   the JSON of `KHR_materials_pbrSpecularGlossiness`. Out: factors and the diffuse texture.
//! Cost: constant. Source: KHR_materials_pbrSpecularGlossiness, \[glTF 2.0\], appendix B. Departs
//! from it: the texture of specular colour and glossiness is left out, as it would need a new
//! image. A material that has one is shown as its metallic-roughness form says, if it has that,
//! too, else with [`USUAL_SPECULAR`]. The diffuse texture varies the specular colour as well, if
//! there is anything diffuse.

use super::accessor::Source;
use crate::Error;
use crate::json_message::plain_message;
use gltf::json::texture::Info;
use serde::Deserialize;
use vitral_light::{DIELECTRIC_F0, Reflectance};

/// The name in files.
pub(crate) const NAME: &str = "KHR_materials_pbrSpecularGlossiness";

/// Specular colour where the texture that would give it is left out: that of most things but
/// metals.
const USUAL_SPECULAR: f32 = DIELECTRIC_F0;
/// Glossiness likewise.
const USUAL_GLOSSINESS: f32 = 0.5;

/// The extension's object.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct SpecularGlossiness {
    /// Linear RGBA.
    pub(crate) diffuse_factor: [f32; 4],
    pub(crate) diffuse_texture: Option<Info>,
    specular_factor: [f32; 3],
    glossiness_factor: f32,
    pub(crate) specular_glossiness_texture: Option<Info>,
}

impl Default for SpecularGlossiness {
    fn default() -> Self {
        Self {
            diffuse_factor: [1.0; 4],
            diffuse_texture: None,
            specular_factor: [1.0; 3],
            glossiness_factor: 1.0,
            specular_glossiness_texture: None,
        }
    }
}

impl SpecularGlossiness {
    /// The extension of the material at `path`, if it has it.
    pub(crate) fn find(
        source: &Source<'_>,
        material: &gltf::json::Material,
        path: &str,
    ) -> Result<Option<Self>, Error> {
        let value = material.extensions.as_ref().and_then(|e| e.others.get(NAME));
        let Some(value) = value else { return Ok(None) };
        let path = format!("{path}.extensions.{NAME}");
        let read: Self = serde_json::from_value(value.clone())
            .map_err(|e| source.error(&*path, plain_message(&e)))?;
        if let Some(texture) = &read.diffuse_texture
            && texture.index.value() >= source.root.textures.len()
        {
            return Err(
                source.error(format!("{path}.diffuseTexture.index"), "the index points at nothing")
            );
        }
        Ok(Some(read))
    }

    /// Whether nothing is reflected diffusely, so that the diffuse texture does not show.
    pub(crate) fn is_mirror(&self) -> bool {
        self.specular_glossiness_texture.is_none() && self.specular_factor.iter().any(|c| *c >= 1.0)
    }

    /// The metallic-roughness surface that reflects as much.
    pub(crate) fn reflectance(&self) -> Reflectance {
        let unit = |c: f32| if c.is_finite() { c.clamp(0.0, 1.0) } else { 1.0 };
        let [r, g, b, _] = self.diffuse_factor.map(unit);
        // Factors say little without the texture that they multiply.
        let (specular, glossiness) = match &self.specular_glossiness_texture {
            Some(_) => ([USUAL_SPECULAR; 3], USUAL_GLOSSINESS),
            None => (self.specular_factor.map(unit), unit(self.glossiness_factor)),
        };
        let strongest = specular.into_iter().fold(0.0, f32::max);
        let diffuse = [r, g, b].map(|c| c * (1.0 - strongest));

        let brightness = |[r, g, b]: [f32; 3]| 0.299 * r + 0.587 * g + 0.114 * b;
        let (c, f) = (brightness(diffuse), brightness(specular));
        let square = (c + f) * (c + f) - 4.0 * DIELECTRIC_F0 * c;
        let base = 0.5 * (c + f + square.max(0.0).sqrt());
        let metallic = if base > 0.0 { (1.0 - c / base).clamp(0.0, 1.0) } else { 0.0 };
        let low = DIELECTRIC_F0 * (1.0 - metallic);
        Reflectance::MetallicRoughness {
            base_color: [0, 1, 2].map(|k| unit(diffuse[k] + specular[k] - low)),
            metallic,
            roughness: 1.0 - glossiness,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_reflected_stays_the_same() {
        for (diffuse, specular) in [
            ([0.0; 3], [1.0, 0.8, 0.3]),
            ([0.8, 0.1, 0.1], [0.04; 3]),
            ([0.5; 3], [0.3; 3]),
            ([0.2, 0.4, 0.9], [0.1, 0.2, 0.1]),
        ] {
            let material = SpecularGlossiness {
                diffuse_factor: [diffuse[0], diffuse[1], diffuse[2], 1.0],
                specular_factor: specular,
                glossiness_factor: 0.25,
                ..SpecularGlossiness::default()
            };
            let Reflectance::MetallicRoughness { base_color, metallic, roughness } =
                material.reflectance()
            else {
                panic!("metallic-roughness");
            };
            assert_eq!(roughness, 0.75);
            // In brightness, what is reflected diffusely and head on.
            let strongest = specular.into_iter().fold(0.0, f32::max);
            let brightness = |c: [f32; 3]| 0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2];
            let base = brightness(base_color);
            let expected = brightness(diffuse) * (1.0 - strongest);
            assert!(
                (base * (1.0 - metallic) - expected).abs() < 1e-3,
                "{diffuse:?} {specular:?}: {base} {metallic}"
            );
            let head_on = DIELECTRIC_F0 * (1.0 - metallic) + base * metallic;
            assert!(
                (head_on - brightness(specular)).abs() < 1e-3,
                "{diffuse:?} {specular:?}: {head_on}"
            );
        }
    }

    #[test]
    fn the_newer_form_and_mirrors() {
        let materials = format!(
            r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["{NAME}"],"textures":[{{"source":0}}],"images":[{{"uri":"data:image/png;base64,{PIXEL}"}}],"materials":[
            {{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}},"roughnessFactor":0.25}},"extensions":{{"{NAME}":{{"diffuseFactor":[1,0,0,1],"specularGlossinessTexture":{{"index":0}}}}}}}},
            {{"extensions":{{"{NAME}":{{"diffuseTexture":{{"index":0}},"specularFactor":[1,0.5,0.5]}}}}}},
            {{"extensions":{{"{NAME}":{{"diffuseTexture":{{"index":0}},"specularFactor":[0.1,0.1,0.1]}}}}}}]}}"#
        );
        let scene = crate::gltf::load(
            materials.as_bytes(),
            "a.gltf",
            &crate::NoFiles,
            &vitral_exec::Workers::single(),
        );
        let scene = scene.unwrap();
        let [both, mirror, diffuse] = &scene.materials[..] else { panic!() };
        let newer =
            Reflectance::MetallicRoughness { base_color: [1.0; 3], metallic: 1.0, roughness: 0.25 };
        assert_eq!(both.reflectance, newer, "the one whose textures are read");
        assert!(both.base_texture.is_some() && diffuse.base_texture.is_some());
        assert_eq!(mirror.base_texture, None, "nothing diffuse is left that it could colour");
    }

    /// A white pixel.
    const PIXEL: &str = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8/5+hHgAHggJ/PchI7wAAAABJRU5ErkJggg==";

    #[test]
    fn the_older_form_takes_the_place_of_the_other() {
        let material = |extension: &str| {
            let text = format!(
                r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["{NAME}"],"extensionsRequired":["{NAME}"],
                "materials":[{{"alphaMode":"BLEND","extensions":{{"{NAME}":{extension}}}}}]}}"#
            );
            crate::gltf::load(
                text.as_bytes(),
                "a.gltf",
                &crate::NoFiles,
                &vitral_exec::Workers::single(),
            )
        };
        let factors = r#""diffuseFactor":[0.5,0.25,0.125,0.75],"specularFactor":[0.04,0.04,0.04],"glossinessFactor":0.5"#;
        let scene = material(&format!("{{{factors}}}")).unwrap();
        assert!(!scene.warnings.iter().any(|w| w.contains("Texture")), "{:?}", scene.warnings);
        let seen = &scene.materials[0];
        let Reflectance::MetallicRoughness { base_color, metallic, roughness } = seen.reflectance
        else {
            panic!("{seen:?}");
        };
        assert!(metallic < 1e-4 && (roughness, seen.opacity) == (0.5, 0.75), "{seen:?}");
        assert!(
            (base_color[0] - 0.48).abs() < 1e-3 && (base_color[2] - 0.12).abs() < 1e-3,
            "{base_color:?}"
        );
        // Without the texture that they multiply, factors of 1 would make mirrors of all things.
        let scene = material(r#"{"specularGlossinessTexture":{"index":0}}"#).unwrap();
        let told = "a.gltf: materials[0]: the specularGlossinessTexture is not used, a usual reflection is shown instead";
        assert!(scene.warnings.iter().any(|w| w == told), "{:?}", scene.warnings);
        let seen = &scene.materials[0];
        let dull = matches!(seen.reflectance, Reflectance::MetallicRoughness { metallic, roughness, .. } if metallic < 1e-4 && roughness == 0.5);
        assert!(dull, "{seen:?}");
        for (extension, place) in [
            (
                r#"{"diffuseTexture":{"index":3}}"#,
                "diffuseTexture.index: the index points at nothing",
            ),
            (r#"{"glossinessFactor":"x"}"#, "KHR_materials_pbrSpecularGlossiness: invalid type"),
        ] {
            let told = material(extension).unwrap_err().to_string();
            assert!(told.contains(place), "{told}");
        }
    }
}
