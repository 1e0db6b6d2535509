//! Floor 1: light meets surface. Lights, materials and the formulas of reflection, written once and
//! used by every renderer of the house, for one point or for eight at a time.
//!
//! The formulas are generic over [`vitral_math::lanes::Lanes`], so a vertex (`f32`) and eight
//! pixels run the same lines and get the same bits. `docs/materials.md` explains the conventions.
//!
//! Scale: a white Lambert surface that faces a directional light of intensity 1 reflects 1. There
//! is no `1/π`.
#![forbid(unsafe_code)]

mod area;
mod builders;
mod cook_torrance;
mod environment;
mod illumination;
mod light;
mod mapping;
mod material;
mod panorama;
mod phong;
mod prepared;
mod refraction;
mod sky;
mod surface;
mod terms;
mod translucency;

pub use cook_torrance::{DIELECTRIC_F0, LEAST_SLOPE, Microfacet, cook_torrance};
pub use environment::{EnvironmentLight, EnvironmentMap};
pub use illumination::{Illumination, UnknownIllumination};
pub use light::{AreaShape, Attenuation, Light, LightKind};
pub use mapping::{microfacet_from_phong, phong_from_microfacet};
pub use material::{AlphaMode, Material, Reflectance, TextureRef, Transmission, constant_color};
pub use panorama::Panorama;
pub use phong::{Phong, phong};
pub use prepared::{Arrival, DIRECTION_ROUNDING, Incident, PreparedLight};
pub use refraction::{reflected_share, transmitted};
pub use sky::Sky;
pub use surface::{Reflected, Surface, reflect};
pub use terms::{Highlight, LightTerms, ambient_term, microfacet_terms, phong_terms, sum_of_terms};
pub use translucency::{mirroring_exponent, scattered, scattering_exponent, transmitted_light};

/// Linear RGB, each component usually in `0..=1`.
pub type Rgb = [f32; 3];
