//! Materials: how a surface reflects, emits and lets light through.

use crate::Rgb;
use serde::{Deserialize, Serialize};
use vitral_frame::Sampler;
use vitral_math::color::linear_from_srgb;

/// A surface's optical properties. All colours are linear RGB coefficients, but for
/// [`srgb_colors`](Self::srgb_colors).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct Material {
    /// For overrides and messages; may be empty.
    pub name: String,
    /// The reflection coefficients, in the form in which the file gave them.
    pub reflectance: Reflectance,
    /// The colours are those of displays (sRGB), as programs write them into MTL files, until
    /// [`decode_colors`](Self::decode_colors) makes coefficients of them.
    pub srgb_colors: bool,
    /// The diffuse (or base) colour that the file gave beside a base texture, which is shown alone.
    /// Linear RGB, but for [`srgb_colors`](Self::srgb_colors).
    pub texture_tint: Option<Rgb>,
    /// Light that the surface sends out by itself (ki), RGB.
    pub emission: Rgb,
    /// 1: opaque, 0: invisible. With `kt` of the course, `opacity = 1 - kt`.
    pub opacity: f32,
    /// What a blended surface lets through at its silhouette in Kay's model (`kmin`), 0 to 1; no
    /// more than `kt` counts.
    pub kt_min: f32,
    /// How `opacity`, and the alpha of the base texture, are used.
    pub alpha_mode: AlphaMode,
    /// What kind of transparency the surface has.
    pub transmission: Transmission,
    /// `opacity` is that of glass, not of a surface with holes: highlights stay whole, and what the
    /// surface mirrors (Fresnel) does not pass, so that clear bodies have a rim. Metal lets nothing
    /// pass.
    pub glass: bool,
    /// Colour of coloured glass: how much of each colour passes of the light that `1 - opacity`
    /// lets through.
    pub filter: Rgb,
    /// Index of refraction, above 0; 1 bends no light.
    pub ior: f32,
    /// Shows mirror images, in the proportion of its specular coefficient, where rays are traced.
    pub mirror: bool,
    /// Both sides are visible and lit, whatever the mesh's closedness.
    pub double_sided: bool,
    /// Seen from the front alone, as glTF's `doubleSided: false` has it: the viewer looks through
    /// its back faces. Shadows, rays and radiosity take it as solid. Counts for nothing where
    /// `double_sided` is set.
    pub front_only: bool,
    /// Shown with its base colour alone, without any light.
    pub unlit: bool,
    /// Multiplies the diffuse (or base) colour; its alpha multiplies `opacity`.
    pub base_texture: Option<TextureRef>,
    /// Multiplies `ks`.
    pub specular_texture: Option<TextureRef>,
    /// Multiplies `emission`.
    pub emission_texture: Option<TextureRef>,
    /// Its red channel multiplies `opacity` (`map_d`): of `glass` how much light the surface keeps,
    /// of all else how much of the surface there is.
    pub opacity_texture: Option<TextureRef>,
    /// Green multiplies roughness, blue multiplies metallic (glTF).
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Its red channel says how much of the ambient light arrives (glTF).
    pub occlusion_texture: Option<TextureRef>,
    /// How much the occlusion texture counts, 0 to 1.
    pub occlusion_strength: f32,
    /// Normals in tangent space, `0..=255` for `-1..=1`: red along growing u, green along falling
    /// v, which is upwards in the picture, blue outwards.
    pub normal_texture: Option<TextureRef>,
    /// Scales x and y of the normal texture.
    pub normal_scale: f32,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            reflectance: Reflectance::default(),
            srgb_colors: false,
            texture_tint: None,
            emission: [0.0; 3],
            opacity: 1.0,
            kt_min: 0.0,
            alpha_mode: AlphaMode::Opaque,
            transmission: Transmission::Transparent,
            glass: false,
            filter: [1.0; 3],
            ior: 1.5,
            mirror: false,
            double_sided: false,
            front_only: false,
            unlit: false,
            base_texture: None,
            specular_texture: None,
            emission_texture: None,
            opacity_texture: None,
            metallic_roughness_texture: None,
            occlusion_texture: None,
            occlusion_strength: 1.0,
            normal_texture: None,
            normal_scale: 1.0,
        }
    }
}

/// Reflection coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    tag = "form",
    rename_all = "kebab-case",
    rename_all_fields = "kebab-case",
    deny_unknown_fields
)]
pub enum Reflectance {
    /// The empirical model's: ambient, diffuse and specular coefficients and the exponent `n`.
    Phong {
        /// Reflected part of ambient light.
        ka: Rgb,
        /// Diffusely reflected part.
        kd: Rgb,
        /// Specularly reflected part.
        ks: Rgb,
        /// Specular exponent, 1 (dull) to 200 (polished) in the course, up to 1000 in MTL files.
        shininess: f32,
    },
    /// The physical model's.
    MetallicRoughness {
        /// Albedo of a dielectric, specular colour of a metal.
        base_color: Rgb,
        /// 0: dielectric, 1: metal.
        metallic: f32,
        /// 0: mirror, 1: rough. Its square is the RMS slope `m` of the microfacets.
        roughness: f32,
    },
}

impl Default for Reflectance {
    fn default() -> Self {
        Self::Phong { ka: [0.8; 3], kd: [0.8; 3], ks: [0.15; 3], shininess: 40.0 }
    }
}

/// How opacity is used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(
    tag = "mode",
    rename_all = "kebab-case",
    rename_all_fields = "kebab-case",
    deny_unknown_fields
)]
pub enum AlphaMode {
    /// Not at all: the surface is opaque.
    #[default]
    Opaque,
    /// Cut-out: fully there where opacity reaches `cutoff` (see [`AlphaMode::least_opacity`]), gone
    /// elsewhere.
    Mask {
        /// The threshold, usually 0.5.
        cutoff: f32,
    },
    /// Blended with what is behind.
    Blend,
}

impl AlphaMode {
    /// The opacity from which on a cut-out surface is there: its cutoff less what interpolation may
    /// round away, so that a surface whose opacity is its cutoff everywhere has no holes.
    pub fn least_opacity(cutoff: f32) -> f32 {
        cutoff - 1.0 / (1u32 << 20) as f32
    }
}

/// Specular or diffuse transmission (the course's transparent and translucent materials).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transmission {
    /// Light passes along a straight or refracted ray: things behind are seen sharply.
    #[default]
    Transparent,
    /// Light is scattered on its way: things behind are blurred, as much as highlights are wide
    /// (shininess, roughness).
    Translucent,
}

/// A texture as a material uses it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct TextureRef {
    /// Index into the scene's textures.
    pub texture: u32,
    /// How it is looked up.
    #[serde(default)]
    pub sampler: Sampler,
    /// Which texture-coordinate set of the mesh, 0 or 1.
    #[serde(default)]
    pub uv_set: u32,
    /// Rows of the affine map from mesh coordinates `(u, v, 1)` to texture coordinates.
    #[serde(default = "TextureRef::identity")]
    pub transform: [[f32; 3]; 2],
}

impl TextureRef {
    /// The whole texture, once.
    pub fn new(texture: u32) -> Self {
        Self { texture, sampler: Sampler::default(), uv_set: 0, transform: Self::identity() }
    }

    fn identity() -> [[f32; 3]; 2] {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    }
}

impl Material {
    /// Whether light from behind can show: blended or cut out.
    pub fn is_layered(&self) -> bool {
        match self.alpha_mode {
            AlphaMode::Opaque => false,
            AlphaMode::Mask { .. } | AlphaMode::Blend => true,
        }
    }
}

impl Material {
    /// What number of the material has no meaning, for those who read materials that somebody wrote
    /// by hand and can say so. Models bring such numbers; they are drawn as well as can be.
    ///
    /// # Errors
    /// Which it is, and what is required.
    pub fn check(&self) -> Result<(), String> {
        let unit = |value: f32| (0.0..=1.0).contains(&value);
        let positive = |value: f32| value >= 0.0 && value.is_finite();
        let bad = |what: &str, value: f32, required: &str| {
            Err(format!("{what} {value}: {required} is required"))
        };
        let shares = [
            ("opacity", self.opacity),
            ("kt-min", self.kt_min),
            ("occlusion-strength", self.occlusion_strength),
        ];
        let (mut shares, mut colors) = (shares.to_vec(), vec![("emission", self.emission)]);
        match self.reflectance {
            Reflectance::Phong { ka, kd, ks, shininess } => {
                colors.extend([("ka", ka), ("kd", kd), ("ks", ks), ("shininess", [shininess; 3])]);
            }
            Reflectance::MetallicRoughness { base_color, metallic, roughness } => {
                colors.push(("base-color", base_color));
                shares.extend([("metallic", metallic), ("roughness", roughness)]);
            }
        }
        if let Some(&(what, value)) = shares.iter().find(|(_, value)| !unit(*value)) {
            return bad(what, value, "0 to 1");
        }
        if !(self.ior > 0.0 && self.ior.is_finite()) {
            return bad("index of refraction", self.ior, "a number above 0");
        }
        if let Some(&part) = self.filter.iter().find(|part| !unit(**part)) {
            return bad("filter", part, "0 to 1 in each channel");
        }
        let channels =
            colors.iter().flat_map(|(what, color)| color.map(|channel| (*what, channel)));
        match channels.into_iter().find(|(_, channel)| !positive(*channel)) {
            Some((what, channel)) => bad(what, channel, "a number of at least 0"),
            None => Ok(()),
        }
    }
}

impl Material {
    /// Makes linear coefficients of display colours. Values above 1, as of lamps, stay.
    pub fn decode_colors(&mut self) {
        if !std::mem::take(&mut self.srgb_colors) {
            return;
        }
        let decode = |color: &mut Rgb| {
            *color = color.map(|c| if c < 1.0 { linear_from_srgb(c) } else { c });
        };
        match &mut self.reflectance {
            Reflectance::Phong { ka, kd, ks, .. } => [ka, kd, ks].into_iter().for_each(decode),
            Reflectance::MetallicRoughness { base_color, .. } => decode(base_color),
        }
        decode(&mut self.emission);
        decode(&mut self.filter);
        self.texture_tint.iter_mut().for_each(decode);
    }

    /// Lets the colour that the file gave beside the base texture multiply it, as the letter of MTL
    /// has it. Changes nothing where there is none.
    pub fn multiply_texture(&mut self) {
        let Some(tint) = self.texture_tint.take() else { return };
        match &mut self.reflectance {
            Reflectance::Phong { kd, .. } => *kd = tint,
            Reflectance::MetallicRoughness { base_color, .. } => *base_color = tint,
        }
    }

    /// Every place for a texture, to change.
    pub fn texture_slots_mut(&mut self) -> [&mut Option<TextureRef>; 7] {
        [
            &mut self.base_texture,
            &mut self.specular_texture,
            &mut self.emission_texture,
            &mut self.opacity_texture,
            &mut self.metallic_roughness_texture,
            &mut self.occlusion_texture,
            &mut self.normal_texture,
        ]
    }

    /// Every texture that the material uses, to change.
    pub fn textures_mut(&mut self) -> impl Iterator<Item = &mut TextureRef> {
        self.texture_slots_mut().into_iter().filter_map(Option::as_mut)
    }
}

impl Material {
    /// The course's transmission coefficient `kt`: 0 opaque, 1 fully transparent. `opacity`, the A
    /// of RGBA, is `1 - kt`.
    pub fn kt(&self) -> f32 {
        1.0 - self.opacity
    }

    /// Sets `opacity` from the course's `kt`.
    pub fn set_kt(&mut self, kt: f32) {
        self.opacity = 1.0 - kt;
    }
}

/// The self-luminous model, `I = ki`: one value for the whole object, whatever the lights are. `ki`
/// is the emission; a material that emits nothing shows its diffuse or base colour instead, so that
/// the model draws every scene.
pub fn constant_color(material: &Material) -> Rgb {
    if material.emission.iter().any(|&channel| channel != 0.0) {
        return material.emission;
    }
    match material.reflectance {
        Reflectance::Phong { kd, .. } => kd,
        Reflectance::MetallicRoughness { base_color, .. } => base_color,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn display_colours_become_coefficients_once() {
        let mut material = Material {
            reflectance: Reflectance::Phong {
                ka: [0.2; 3],
                kd: [0.69, 0.2, 0.0],
                ks: [1.0; 3],
                shininess: 10.0,
            },
            srgb_colors: true,
            texture_tint: Some([0.5; 3]),
            emission: [5.0, 0.5, 0.0],
            ..Material::default()
        };
        let written = material.clone();
        material.decode_colors();
        let Reflectance::Phong { kd, ks, .. } = material.reflectance else {
            panic!("the form stays")
        };
        assert!(
            (kd[0] - 0.433_6).abs() < 1e-3 && (kd[1] - 0.033_1).abs() < 1e-3 && kd[2] == 0.0,
            "{kd:?}"
        );
        assert!(
            ks == [1.0; 3] && material.emission[0] == 5.0,
            "what a display shows whole, or cannot show, stays"
        );
        assert!((material.emission[1] - 0.214).abs() < 1e-3);
        let decoded = material.clone();
        material.decode_colors();
        assert_eq!(material, decoded);
        assert_ne!(written, decoded);

        material.multiply_texture();
        let Reflectance::Phong { kd, .. } = material.reflectance else { panic!("the form stays") };
        assert!((kd[0] - 0.214).abs() < 1e-3 && material.texture_tint.is_none());
    }

    #[test]
    fn p30_the_constant_model_is_one_value_per_object() {
        let mut material = Material::default();
        assert_eq!(constant_color(&material), [0.8; 3]);
        material.reflectance = Reflectance::MetallicRoughness {
            base_color: [1.0, 0.5, 0.0],
            metallic: 1.0,
            roughness: 0.2,
        };
        assert_eq!(constant_color(&material), [1.0, 0.5, 0.0]);
        material.emission = [0.0, 0.0, 0.3];
        assert_eq!(constant_color(&material), [0.0, 0.0, 0.3]);
    }

    #[test]
    fn t13_opacity_is_one_minus_kt() {
        let mut material = Material::default();
        material.set_kt(0.3);
        assert_eq!(material, Material { opacity: 0.7, ..Material::default() });
        assert!((material.kt() - 0.3).abs() < 1e-7);
    }

    #[test]
    fn t1_both_kinds_of_transmission_can_be_set() {
        for (name, expected) in
            [("transparent", Transmission::Transparent), ("translucent", Transmission::Translucent)]
        {
            let json = format!(r#"{{"transmission": "{name}", "opacity": 0.5}}"#);
            let material: Material = serde_json::from_str(&json).unwrap();
            assert_eq!((material.transmission, material.opacity), (expected, 0.5));
        }
    }

    #[test]
    fn numbers_without_meaning_are_told() {
        let phong = |ks: f32, shininess| Reflectance::Phong {
            ka: [0.1; 3],
            kd: [0.5; 3],
            ks: [ks; 3],
            shininess,
        };
        let rough = |metallic, roughness| Reflectance::MetallicRoughness {
            base_color: [2.0; 3],
            metallic,
            roughness,
        };
        let told = |reflectance| Material { reflectance, ..Material::default() }.check();
        assert_eq!([told(phong(3.0, 0.0)), told(rough(0.0, 1.0))], [Ok(()), Ok(())]);
        for (reflectance, expected) in [
            (phong(-0.5, 9.0), "ks -0.5: a number of at least 0 is required"),
            (phong(0.5, -9.0), "shininess -9: a number of at least 0 is required"),
            (rough(1.5, 0.5), "metallic 1.5: 0 to 1 is required"),
            (rough(1.0, -0.5), "roughness -0.5: 0 to 1 is required"),
            (rough(1.0, f32::NAN), "roughness NaN: 0 to 1 is required"),
        ] {
            assert_eq!(told(reflectance).unwrap_err(), expected);
        }
        let emission = Material { emission: [0.0, -1.0, 0.0], ..Material::default() };
        let occluded = Material { occlusion_strength: 1.1, ..Material::default() };
        assert!([emission, occluded].iter().all(|m| m.check().is_err()));
    }

    #[test]
    fn textures_can_be_visited() {
        let mut material =
            Material { base_texture: Some(TextureRef::new(3)), ..Material::default() };
        for texture in material.textures_mut() {
            texture.texture += 1;
        }
        assert_eq!(material.base_texture.map(|t| t.texture), Some(4));
    }
}
