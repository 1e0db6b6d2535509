//! What queries and attribute stacks ask about textures and framebuffers.

use super::image::lock;
use super::internal_format::{Bits, Storage};
use super::texture::{TextureHandle, TextureParameters};
use crate::Context;
use crate::enums::FRONT;
use crate::state::MAX_TEXTURE_UNITS;
use std::sync::Arc;

/// What the draw framebuffer has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FramebufferBits {
    /// Red, green, blue, alpha.
    pub color: [u32; 4],
    /// Depth; 32 for floating point.
    pub depth: u32,
    /// Bits of stencil values.
    pub stencil: u32,
    /// Red, green, blue, alpha of the accumulation buffer.
    pub accum: [u32; 4],
    /// 0 without multisampling.
    pub samples: u32,
    /// `DOUBLEBUFFER`.
    pub double_buffer: bool,
}

/// Textures bound to all units and their parameters, kept by `PushAttrib(TEXTURE_BIT)`.
#[derive(Clone, Debug, Default)]
pub(crate) struct SavedTextures {
    /// Names, by unit and slot.
    bound: [[u32; 5]; MAX_TEXTURE_UNITS],
    textures: Vec<(TextureHandle, TextureParameters)>,
}

impl Context {
    /// `DRAW_FRAMEBUFFER_BINDING`.
    pub(crate) fn draw_framebuffer_name(&self) -> u32 {
        self.framebuffers.draw
    }

    /// `READ_FRAMEBUFFER_BINDING`.
    pub(crate) fn read_framebuffer_name(&self) -> u32 {
        self.framebuffers.read
    }

    /// `RENDERBUFFER_BINDING`.
    pub(crate) fn renderbuffer_name(&self) -> u32 {
        self.framebuffers.renderbuffer.as_ref().map_or(0, |renderbuffer| lock(renderbuffer).name)
    }

    /// `FRAMEBUFFER_SRGB_CAPABLE_EXT`: whether the draw buffer holds sRGB-encoded colours.
    pub(crate) fn draws_srgb(&self) -> bool {
        let surfaces = self.surfaces_of(self.framebuffers.draw, true);
        surfaces.color.is_some_and(|c| c.format.storage == Storage::Srgb8)
    }

    /// `DRAW_BUFFER` of the bound framebuffer.
    pub(crate) fn draw_buffer_token(&self) -> u32 {
        let object = self.framebuffers.object(self.framebuffers.draw);
        object.map_or(self.state.color_buffer.draw_buffer, |o| o.draw_buffer)
    }

    /// `READ_BUFFER` of the bound framebuffer.
    pub(crate) fn read_buffer_token(&self) -> u32 {
        let object = self.framebuffers.object(self.framebuffers.read);
        object.map_or(self.state.pixel_mode.read_buffer, |o| o.read_buffer)
    }

    /// Sets `DRAW_BUFFER` of the bound framebuffer to a value it had.
    pub(crate) fn set_draw_buffer_token(&mut self, token: u32) {
        self.restore_buffer(token, true);
    }

    /// Sets `READ_BUFFER` of the bound framebuffer to a value it had.
    pub(crate) fn set_read_buffer_token(&mut self, token: u32) {
        self.restore_buffer(token, false);
    }

    /// Another framebuffer may be bound than the one that had the value: then it does not fit, and
    /// is left out.
    fn restore_buffer(&mut self, token: u32, draw: bool) {
        let name = if draw { self.framebuffers.draw } else { self.framebuffers.read };
        if self.buffer_choice(token, name != 0, draw).is_ok() {
            self.put_buffer(token, draw);
        }
    }

    /// The bits of the draw framebuffer.
    pub(crate) fn framebuffer_bits(&mut self) -> FramebufferBits {
        let bits = |surface: &Option<super::attachments::Surface>| {
            surface.as_ref().map_or(Bits::default(), |s| s.format.bits())
        };
        let unsigned = i32::cast_unsigned;
        let object = self.framebuffers.object(self.framebuffers.draw).is_some();
        // Framebuffer 0 has its colours even while nothing is drawn to them.
        let surfaces =
            if object { self.draw_surfaces() } else { self.default_framebuffer.surfaces(FRONT) };
        let accum = if object { 0 } else { unsigned(self.default_framebuffer.accum_bits()) };
        FramebufferBits {
            color: bits(&surfaces.color).rgba.map(unsigned),
            depth: unsigned(bits(&surfaces.depth).depth),
            stencil: unsigned(bits(&surfaces.stencil).stencil),
            accum: [accum; 4],
            samples: surfaces.samples as u32,
            double_buffer: false,
        }
    }

    /// Whether a texture has that name.
    pub(crate) fn texture_exists(&self, name: u32) -> bool {
        lock(&self.shared.textures).get(&name).is_some_and(Option::is_some)
    }

    /// Whether a renderbuffer has that name.
    pub(crate) fn renderbuffer_exists(&self, name: u32) -> bool {
        lock(&self.shared.renderbuffers).get(&name).is_some_and(Option::is_some)
    }

    /// Whether a framebuffer object has that name.
    pub(crate) fn framebuffer_exists(&self, name: u32) -> bool {
        self.framebuffers.object(name).is_some()
    }

    /// Keeps all bound textures and their parameters.
    pub(crate) fn save_bound_textures(&mut self) -> SavedTextures {
        let mut textures: Vec<(TextureHandle, TextureParameters)> = Vec::new();
        for unit in 0..MAX_TEXTURE_UNITS {
            for slot in 0..5 {
                let texture = self.bound_texture(unit, slot);
                if !textures.iter().any(|(t, _)| Arc::ptr_eq(t, &texture)) {
                    let parameters = lock(&texture).parameters.clone();
                    textures.push((texture, parameters));
                }
            }
        }
        let name = |unit| std::array::from_fn(|slot| self.texture_name(unit, slot));
        SavedTextures { bound: std::array::from_fn(name), textures }
    }

    /// Binds textures again, and gives those that were bound then their parameters back. Ones
    /// deleted since are replaced by the default one, as in the binding when they were deleted; so
    /// is a name that has become another target's texture.
    pub(crate) fn restore_bound_textures(&mut self, saved: SavedTextures) {
        for (names, bound) in saved.bound.iter().zip(&mut self.textures.bound) {
            for (slot, (name, bound)) in names.iter().zip(bound).enumerate() {
                // The texture still bound may have been deleted in another context.
                if bound.as_ref().map_or(0, |texture| lock(texture).name) != *name {
                    let texture = lock(&self.shared.textures).get(name).cloned().flatten();
                    *bound = texture.filter(|texture| lock(texture).slot == slot);
                }
            }
        }
        for (texture, parameters) in &saved.textures {
            let mut texture = lock(texture);
            if texture.parameters != *parameters {
                texture.parameters = parameters.clone();
                texture.touch();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::context_with;
    use super::*;
    use crate::enums::*;

    #[test]
    fn framebuffer_zero_has_what_was_asked_for() {
        let mut c = context_with(4, 4);
        let bits = c.framebuffer_bits();
        assert_eq!((bits.color, bits.depth, bits.stencil, bits.accum), ([8; 4], 24, 8, [16; 4]));
        c.draw_buffer(NONE);
        assert_eq!(c.framebuffer_bits(), bits);
    }

    #[test]
    fn parameters_come_back() {
        let mut c = context_with(4, 4);
        let saved = c.save_bound_textures();
        c.tex_parameteri(TEXTURE_2D, TEXTURE_MAG_FILTER, NEAREST as i32);
        c.restore_bound_textures(saved);
        assert_eq!(lock(&c.bound_texture(0, crate::state::target::TWO)).parameters.mag, LINEAR);
    }

    #[test]
    fn buffers_are_restored_where_they_fit() {
        let mut c = context_with(4, 4);
        c.draw_buffer(NONE);
        assert_eq!(c.draw_buffer_token(), NONE);
        c.bind_framebuffer_ext(FRAMEBUFFER, 1);
        assert_eq!(c.draw_buffer_token(), COLOR_ATTACHMENT0);
        c.set_draw_buffer_token(FRONT);
        assert_eq!(c.draw_buffer_token(), COLOR_ATTACHMENT0);
        c.bind_framebuffer_ext(FRAMEBUFFER, 0);
        c.set_draw_buffer_token(FRONT);
        assert_eq!(c.draw_buffer_token(), FRONT);
    }
}
