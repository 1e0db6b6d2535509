//! Which formula a material's points go through.

use vitral_light::{Illumination, Material, Rgb, constant_color};

/// The formula that gives a point its light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Model {
    /// The surface's own colour, without lights: lighting is off, or the material is unlit.
    Own,
    /// Self-luminous: `I = ki`.
    Constant(Rgb),
    /// Ambient, Lambert, Phong or Blinn–Phong.
    Empirical(Illumination),
    /// Cook–Torrance.
    Microfacet,
}

impl Model {
    /// The model of a material.
    pub(crate) fn of_material(
        material: &Material,
        illumination: Illumination,
        lighting: bool,
    ) -> Self {
        match illumination.for_reflectance(&material.reflectance) {
            Illumination::Constant => Self::Constant(constant_color(material)),
            _ if !lighting || material.unlit => Self::Own,
            Illumination::CookTorrance => Self::Microfacet,
            other => Self::Empirical(other),
        }
    }

    /// Whether the light of a point depends on which lights reach it.
    #[inline]
    pub(crate) fn needs_light_visibility(self) -> bool {
        matches!(self, Self::Empirical(_) | Self::Microfacet)
    }
}
