//! The illumination models by name.
//!
//! *Illumination* is how much light leaves one point of a surface; *shading* is where it is
//! computed and how it is spread over a polygon. The two choices are independent.

use crate::Reflectance;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// How the light that leaves a point is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Illumination {
    /// The model for which the material was described.
    #[default]
    Auto,
    /// `I = ki`.
    Constant,
    /// `I = Ia ka`.
    Ambient,
    /// `I = Ia ka + Ip kd (N·L)`.
    Lambert,
    /// Lambert and `Ip ks (R·V)^n`.
    Phong,
    /// Lambert and `Ip ks (N·H)^n`.
    BlinnPhong,
    /// Microfacets: distribution, shadowing and Fresnel reflection.
    CookTorrance,
}

/// A name that is not an illumination model's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown illumination model `{0}`; there are {names}", names = Illumination::ALL.map(Illumination::name).join(", "))]
pub struct UnknownIllumination(pub String);

impl Illumination {
    /// Every model, the simplest first.
    pub const ALL: [Self; 7] = [
        Self::Auto,
        Self::Constant,
        Self::Ambient,
        Self::Lambert,
        Self::Phong,
        Self::BlinnPhong,
        Self::CookTorrance,
    ];

    /// The name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Constant => "constant",
            Self::Ambient => "ambient",
            Self::Lambert => "lambert",
            Self::Phong => "phong",
            Self::BlinnPhong => "blinn-phong",
            Self::CookTorrance => "cook-torrance",
        }
    }

    /// One line for lists.
    pub fn description(self) -> &'static str {
        match self {
            Self::Auto => {
                "what the material asks for: Cook-Torrance for metallic-roughness, Phong for the others"
            }
            Self::Constant => "self-luminous: one colour per object, no lights",
            Self::Ambient => "ambient light alone",
            Self::Lambert => "ambient and diffuse reflection, the same from every side",
            Self::Phong => "Lambert and a highlight round the mirror direction",
            Self::BlinnPhong => "Lambert and a highlight round the halfway vector",
            Self::CookTorrance => "microfacets: physically based diffuse and specular reflection",
        }
    }

    /// The model to compute for a surface: `self`, or for [`Illumination::Auto`] the one that fits
    /// the coefficients.
    #[must_use]
    pub fn for_reflectance(self, reflectance: &Reflectance) -> Self {
        match (self, reflectance) {
            (Self::Auto, Reflectance::Phong { .. }) => Self::Phong,
            (Self::Auto, Reflectance::MetallicRoughness { .. }) => Self::CookTorrance,
            (chosen, _) => chosen,
        }
    }
}

impl fmt::Display for Illumination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Illumination {
    type Err = UnknownIllumination;

    fn from_str(name: &str) -> Result<Self, UnknownIllumination> {
        Self::ALL
            .into_iter()
            .find(|model| model.name() == name)
            .ok_or_else(|| UnknownIllumination(name.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p28_names_are_the_same_everywhere() {
        for model in Illumination::ALL {
            assert_eq!(model.to_string().parse(), Ok(model));
            assert_eq!(serde_json::to_string(&model).unwrap(), format!("\"{model}\""));
            assert!(!model.description().is_empty() && !model.description().contains('\n'));
        }
        let error = "gouraud".parse::<Illumination>().unwrap_err().to_string();
        assert!(
            error.contains("`gouraud`") && error.contains("lambert, phong, blinn-phong"),
            "{error}"
        );
    }

    #[test]
    fn auto_follows_the_material() {
        let metal =
            Reflectance::MetallicRoughness { base_color: [1.0; 3], metallic: 1.0, roughness: 0.5 };
        assert_eq!(Illumination::Auto.for_reflectance(&metal), Illumination::CookTorrance);
        assert_eq!(
            Illumination::Auto.for_reflectance(&Reflectance::default()),
            Illumination::Phong
        );
        assert_eq!(Illumination::Lambert.for_reflectance(&metal), Illumination::Lambert);
    }
}
