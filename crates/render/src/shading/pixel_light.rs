//! How the colour of one pixel comes about, in numbers that add up to its bytes.
//!
//! A pixel is the mean of its samples. A sample shows a point of an opaque surface or the
//! background, and the layers in front. Phong's shading illuminates the point itself, Gouraud's the
//! corners of its facet, and every light adds its terms there. The picture was made with these very
//! numbers: a sum given here was added up in single precision and in this order.

use serde::Serialize;
use vitral_light::{LightTerms, Rgb};

/// A pixel, from the terms of its lights to its bytes.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PixelLight {
    /// The points that its samples show.
    pub points: Vec<PointLight>,
    /// Its samples.
    pub samples: Vec<SampleLight>,
    /// Their mean, premultiplied RGBA: linear, or the course's numbers in the raw colour space.
    pub average: [f32; 4],
    /// The mean's colour, divided by its opacity (straight alpha).
    pub straight: Rgb,
    /// Some channel is above 1 or below 0 and is clamped.
    pub clamped: bool,
    /// Red, green, blue and opacity in the display's encoding times 255, before they are rounded;
    /// clamped.
    pub encoded: [f32; 4],
    /// The bytes that these numbers round to.
    pub bytes: [u8; 4],
}

/// A sample of a pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct SampleLight {
    /// Where it lies, in pixels of the picture.
    pub at: [f32; 2],
    /// The opaque point that it shows, by its number in [`PixelLight::points`]; `None` is the
    /// background.
    pub point: Option<usize>,
    /// The colour of that point or of the background, premultiplied RGBA.
    pub behind: [f32; 4],
    /// What lies in front of it, the nearest first.
    pub layers: Vec<LayerLight>,
    /// Its colour with the layers laid over it.
    pub color: [f32; 4],
}

/// A layer over a sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct LayerLight {
    /// Its point's number in [`PixelLight::points`]; `None` is a line or a dot.
    pub point: Option<usize>,
    /// Its depth, 1 near.
    pub depth: f32,
    /// Its colour, premultiplied RGBA.
    pub color: [f32; 4],
    /// What passes of the light from behind.
    pub passes: Rgb,
}

/// A point of a surface that a pixel shows.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PointLight {
    /// The facet.
    pub facet: u32,
    /// Where it is illuminated, in pixels of the picture.
    pub at: [f32; 2],
    /// The same place, world space.
    pub world: [f64; 3],
    /// How it weighs the corners of its facet.
    pub weights: [f32; 3],
    /// The formula: `own` (the surface's colour without lights), `constant`, or an illumination
    /// model.
    pub model: &'static str,
    /// Where that is evaluated: `flat`, `gouraud` or `phong`.
    pub shading: &'static str,
    /// The evaluations of the formula: one, or one for each corner with Gouraud's shading; none
    /// without lights.
    pub evaluations: Vec<Evaluation>,
    /// For each light how much of it arrives and what stands in its way; empty without shadows.
    pub shadows: Vec<ShadowOfLight>,
    /// Colour of the texture.
    pub texture: Rgb,
    /// Colour of the texture times that of the vertices: a factor of the ambient and diffuse
    /// coefficients, or of the base colour.
    pub base: Rgb,
    /// Ambient and diffuse light: the evaluations weighed; with Gouraud's shading times the
    /// texture.
    pub diffuse: Rgb,
    /// Specular light.
    pub specular: Rgb,
    /// Light from other surfaces that is added to the diffuse light, with radiosity.
    pub interreflection: Option<Rgb>,
    /// Emission.
    pub emission: Rgb,
    /// Opacity.
    pub alpha: f32,
    /// The part of the point that textures and vertex colours leave of the surface.
    pub coverage: f32,
    /// Specular light is multiplied with the coverage, not with the opacity: a transparent surface
    /// keeps its highlights.
    pub keeps_specular: bool,
    /// Light that shines through a translucent surface from behind.
    pub glow: Option<Rgb>,
    /// How distance changes it, with depth cueing.
    pub depth_cue: Option<DepthCueTerms>,
    /// The colour, premultiplied RGBA.
    pub color: [f32; 4],
}

/// How distance fades a point: `kept * color + (1 - kept) * alpha * into`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct DepthCueTerms {
    /// The share of its light that it keeps.
    pub kept: f32,
    /// The colour that it fades into.
    pub into: Rgb,
}

/// One evaluation of an illumination model. Vectors in view space: the eye in the origin, `z`
/// towards it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Evaluation {
    /// The corner of the facet, with Gouraud's shading.
    pub corner: Option<u8>,
    /// Its weight in the point.
    pub weight: f32,
    /// Where.
    pub position: [f32; 3],
    /// Unit normal `N`.
    pub normal: [f32; 3],
    /// Unit vector `V` to the viewer.
    pub viewer: [f32; 3],
    /// How the surface reflects there, textures and vertex colours included.
    pub coefficients: CoefficientValues,
    /// The ambient light of the scene times its coefficient.
    pub ambient: Rgb,
    /// What each light adds, with its number in the scene.
    pub lights: Vec<NumberedTerms>,
    /// Sum of the ambient and diffuse terms, in this order: the scene's ambient light, then each
    /// light's ambient and diffuse term.
    pub diffuse: Rgb,
    /// What it reflects diffusely of an image of the surroundings, with metallic-roughness
    /// materials; part of `diffuse`.
    pub gathered: Option<Rgb>,
    /// What it mirrors of the soft sky round the scene, or of the image, with metallic-roughness
    /// materials.
    pub environment: Option<Rgb>,
    /// Sum of the specular terms, and of what it mirrors of the surroundings.
    pub specular: Rgb,
}

/// The terms of a light, with its number.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct NumberedTerms {
    /// The light's number among the scene's.
    pub light: usize,
    /// What it adds.
    #[serde(flatten)]
    pub terms: LightTerms,
}

/// The coefficients of an illumination model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", untagged)]
pub enum CoefficientValues {
    /// Of the empirical models.
    #[serde(rename_all = "kebab-case")]
    Empirical {
        /// Ambient.
        ka: Rgb,
        /// Diffuse.
        kd: Rgb,
        /// Specular.
        ks: Rgb,
        /// Exponent.
        shininess: f32,
    },
    /// Of microfacets.
    #[serde(rename_all = "kebab-case")]
    Microfacet {
        /// Albedo of a dielectric, colour of a metal.
        base_color: Rgb,
        /// 0 a dielectric, 1 a metal.
        metallic: f32,
        /// Roughness.
        roughness: f32,
        /// How much ambient light arrives.
        occlusion: f32,
    },
}

/// The shadow of a light at a point.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ShadowOfLight {
    /// The light's number among the scene's.
    pub light: usize,
    /// Which part of each colour arrives.
    pub visibility: Rgb,
    /// The facet faces away from the light: the shadow is its own.
    pub attached: bool,
    /// The first facet on the way to the light (to the middle of a light with a shape), where not
    /// all of it arrives and the facet does not face away.
    pub blocker: Option<u32>,
    /// How far that is, world space.
    pub distance: Option<f64>,
}
