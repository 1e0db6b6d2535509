//! Vertices that a pass shows with one texture more than once: their texels are worth keeping.

use super::pass::{Command, Geometry};
use super::state::{EnvironmentMode, FragmentState};
use super::texture::Texture;
use std::sync::Arc;

/// A draw's vertices with one of its textures.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct TextureUse {
    vertices: usize,
    texture: *const Texture,
    pub(super) unit: usize,
}

/// The textures of a draw, for [`repeated_uses`]; none where a texture is not multiplied with the
/// others.
pub(super) fn texture_uses(
    geometry: &dyn Geometry,
    state: &FragmentState,
) -> impl Iterator<Item = TextureUse> {
    let vertices = geometry.vertex_source();
    let multiplied = state.units.iter().all(|unit| unit.mode == EnvironmentMode::Modulate);
    state.units.iter().filter(move |_| multiplied).map(move |unit| TextureUse {
        vertices,
        texture: Arc::as_ptr(&unit.texture),
        unit: unit.index,
    })
}

/// The vertices that draws of colours show with one texture more than once, each with that texture.
pub(super) fn repeated_uses(commands: &[Command]) -> Vec<TextureUse> {
    let mut all = Vec::new();
    for command in commands {
        if let Command::Draw(geometry, state) = command
            && state.masked != [true; 4]
        {
            all.extend(texture_uses(&**geometry, state));
        }
    }
    all.sort_unstable();
    let mut again: Vec<TextureUse> =
        all.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
    again.dedup();
    again
}
