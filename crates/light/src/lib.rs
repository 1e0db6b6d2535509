//! Floor 1: light meets surface. Lights, materials and the formulas of reflection, written once and used by every
//! renderer of the house, for one point or for eight at a time.
#![forbid(unsafe_code)]

mod light;
mod material;

pub use light::{AreaShape, Attenuation, Light, LightKind};
pub use material::{AlphaMode, Material, Reflectance, TextureRef, Transmission};

/// Linear RGB, each component usually in `0..=1`.
pub type Rgb = [f32; 3];
