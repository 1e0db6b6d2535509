//! The closed sets of choices: what cannot grow by adding a file.

use crate::choice::named;
use serde::{Deserialize, Serialize};

/// Where the count of shadow volumes begins. It does not change the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VolumeCounting {
    /// At infinity, behind what is seen.
    #[default]
    ZFail,
    /// At the viewer.
    ZPass,
}

/// Where light ends on surfaces that facets only stand for, with shadows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Terminator {
    /// Where the interpolated normal turns away.
    #[default]
    Soft,
    /// Where the facet or the interpolated normal turns away.
    Exact,
}

/// Where illumination is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shading {
    /// Once a face, at its centre with its own normal.
    Flat,
    /// At each vertex; intensities are interpolated.
    Gouraud,
    /// At each pixel, with the interpolated normal.
    #[default]
    Phong,
}

/// Light that comes from other surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Global {
    /// None: surfaces are lit by lights alone.
    #[default]
    None,
    /// Mirror images and refraction; shadows are those of
    /// [`ShadowSettings`](super::ShadowSettings).
    RayTrace,
    /// What matt surfaces send to each other.
    Radiosity,
}

/// What surfaces with metallic-roughness materials mirror of their surroundings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Environment {
    /// The image of the [`Surroundings`](crate::Surroundings) if there is one, else the sky, for
    /// pictures in the default lights; who makes pictures says which these are, and here it is
    /// nothing.
    #[default]
    Auto,
    /// A soft sky over a darker ground ([`Sky`](vitral_light::Sky)), which turns with the camera
    /// like the default lights.
    Sky,
    /// Nothing: they show highlights alone.
    None,
}

/// What darkens the background where there would be a ground at the model's lowest point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GroundShadow {
    /// Nothing: there is no ground.
    #[default]
    None,
    /// A soft shadow in the default lights, else that of the lights; who makes pictures says which
    /// these are, and here it is that of the lights.
    Auto,
    /// What the model keeps of the light of all lights that cast shadows.
    Lights,
    /// A soft shadow where the model is near the ground, whatever the lights.
    Soft,
}

/// How values between vertices are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// As on the surface in space.
    #[default]
    Perspective,
    /// Linearly on the screen: the classical defect, for comparison.
    Linear,
}

/// What the numbers in a picture mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColorSpace {
    /// Light is computed linearly and encoded as sRGB.
    #[default]
    Srgb,
    /// Intensities go straight to bytes, as in the course's arithmetic. Textures, coefficients and
    /// colours of vertices are taken as the file has them: sRGB in OBJ, PLY and OFF files, linear
    /// factors and `COLOR_0` in glTF.
    Raw,
}

/// How transparent surfaces are combined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transparency {
    /// `opacity` of the surface, the rest of what is behind.
    #[default]
    Linear,
    /// Less where the surface turns away from the viewer: with the material's `kt` and `kt-min` it
    /// is `kt_min + (kt - kt_min) (1 - (1 - |nz|)^m)`.
    Kay,
    /// Tinted by the material's filter; highlights stay whole.
    Filtered,
    /// Everything is opaque (cut-outs stay).
    None,
}

/// Edges instead of, or on top of, surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lines {
    /// Only the lines and points that the model itself has.
    #[default]
    None,
    /// Surfaces with their faces' edges.
    Edges,
    /// Edges alone, the hidden ones too.
    Wireframe,
    /// Edges alone, the visible ones.
    WireframeHiddenLine,
}

impl Lines {
    /// Whether edges alone are drawn.
    pub const fn has_no_surfaces(self) -> bool {
        matches!(self, Self::Wireframe | Self::WireframeHiddenLine)
    }
}

impl Transparency {
    /// Whether blended surfaces are seen through at all.
    pub const fn sees_through(self) -> bool {
        !matches!(self, Self::None)
    }

    /// Whether light that passes takes the colour of the material's filter.
    pub const fn tints(self) -> bool {
        matches!(self, Self::Filtered)
    }

    /// Whether how much light passes depends on how the surface is turned to the viewer.
    pub const fn varies_by_angle(self) -> bool {
        matches!(self, Self::Kay)
    }
}

named!(Shading, "shading model", [
    Phong: "phong", "normals are interpolated, each pixel is illuminated";
    Gouraud: "gouraud", "vertices are illuminated, intensities are interpolated";
    Flat: "flat", "one colour for each face";
]);

named!(VolumeCounting, "way to count shadow volumes", [
    ZFail: "z-fail", "at infinity, behind what is seen";
    ZPass: "z-pass", "at the viewer";
]);

named!(Environment, "environment", [
    Auto: "auto", "the sky where neither the scene nor the command names lights";
    Sky: "sky", "a soft sky over a darker ground";
    None: "none", "nothing: metals show highlights alone";
]);

named!(GroundShadow, "shadow on the ground", [
    None: "none", "there is no ground";
    Auto: "auto", "soft in the default lights, else of the lights";
    Lights: "lights", "what the model keeps of the light of all lights that cast shadows";
    Soft: "soft", "dark where the model is near the ground, whatever the lights";
]);

named!(Terminator, "terminator", [
    Soft: "soft", "light ends where the interpolated normal turns away: round bodies of few facets have a smooth border";
    Exact: "exact", "light ends where the facet turns away, too: steps along the facets";
]);

named!(Interpolation, "interpolation", [
    Perspective: "perspective", "as on the surface in space";
    Linear: "linear", "on the screen: shows the classical defect";
]);

named!(ColorSpace, "colour space", [
    Srgb: "srgb", "linear light, encoded as sRGB";
    Raw: "raw", "intensities from 0 to 1 straight to bytes, without the curve of sRGB: what textbooks compute by hand";
]);

named!(Lines, "way to draw edges", [
    None: "none", "only the lines and points that the model itself has";
    Edges: "edges", "surfaces with their faces' edges";
    Wireframe: "wireframe", "edges alone, the hidden ones too";
    WireframeHiddenLine: "wireframe-hidden-line", "edges alone, the visible ones";
]);

named!(Global, "model of global illumination", [
    None: "none", "surfaces are lit by lights alone";
    RayTrace: "ray-trace", "rays go on where they are mirrored and bent; with ray-traced shadows";
    Radiosity: "radiosity", "matt surfaces light each other; solved once for all cameras";
]);

named!(Transparency, "model of transparency", [
    Linear: "linear", "opacity of the surface, the rest of what is behind";
    Kay: "kay", "less light passes where a surface turns away: the rim of curved glass is darker";
    Filtered: "filtered", "what is behind is tinted by the material's filter, highlights stay whole";
    None: "none", "every surface is opaque; cut-outs stay";
]);
