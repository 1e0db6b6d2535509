//! Pixels: formats, textures, framebuffers, clears, copies.

use crate::Context;
use std::sync::Arc;
use vitral_raster::forward::{Target, Texture};

/// Framebuffer objects and what is bound.
#[derive(Debug, Default)]
pub(crate) struct FramebufferBindings {}

/// The planes of framebuffer 0.
#[derive(Debug, Default)]
pub(crate) struct DefaultFramebuffer {}

impl Context {
    /// The planes that draws go to: of the bound framebuffer object or framebuffer 0. `None` if it is incomplete (the
    /// caller records INVALID_FRAMEBUFFER_OPERATION), has no size, or draws nowhere.
    pub(crate) fn draw_target(&mut self) -> Option<Target> {
        None
    }

    /// The texture that unit `unit` samples: the enabled target of highest priority, if its texture is complete.
    pub(crate) fn sampled_texture(&mut self, unit: usize) -> Option<Arc<Texture>> {
        let _ = unit;
        None
    }
}
