//! Which surfaces hide those behind them: others are layers, and close no solid whose back faces
//! could be dropped.

use crate::Transparency;
use vitral_light::{AlphaMode, Material};

/// Whether surfaces of a material are layers in front of what is opaque.
pub(crate) fn is_layered(material: Option<&Material>, transparency: Transparency) -> bool {
    material.is_some_and(|m| match m.alpha_mode {
        AlphaMode::Opaque => false,
        AlphaMode::Mask { .. } => true,
        AlphaMode::Blend => transparency.sees_through(),
    })
}
