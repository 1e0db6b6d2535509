//! `Clear`, and which colour buffers are drawn to and read from.

use super::Failure;
use super::image::Shared;
use crate::Context;
use crate::enums::*;
use crate::state::MAX_COLOR_ATTACHMENTS;
use vitral_math::color::srgb_from_linear;
use vitral_raster::Viewport;
use vitral_raster::forward::{Clear, ColorPlane, Command};

impl Context {
    /// The pixels that the scissor leaves of a target: x0, y0, x1, y1, the last two exclusive.
    pub(crate) fn scissored(&self, viewport: Viewport) -> [i32; 4] {
        let whole = [0, 0, viewport.width as i32, viewport.height as i32];
        if !self.state.scissor.enabled {
            return whole;
        }
        let [x, y, width, height] = self.state.scissor.rect;
        let end = [x.saturating_add(width).min(whole[2]), y.saturating_add(height).min(whole[3])];
        [x.max(0), y.max(0), end[0].max(x.max(0)), end[1].max(y.max(0))]
    }

    /// `glClear`.
    pub fn clear(&mut self, mask: u32) {
        self.listable(move |c| c.exec_clear(mask));
    }

    fn exec_clear(&mut self, mask: u32) {
        const CALL: &str = "glClear";
        if !self.outside_begin(CALL) {
            return;
        }

        // Check the mask and the framebuffer.
        if mask & !(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT | STENCIL_BUFFER_BIT | ACCUM_BUFFER_BIT)
            != 0
        {
            return self.record_error(INVALID_VALUE, CALL, "mask has bits that name no buffer");
        }
        if !self.draw_framebuffer_complete(CALL) || !self.renders() {
            return;
        }

        // Limit the clear to the scissor rectangle.
        let surfaces = self.draw_surfaces();
        let Some(viewport) = surfaces.size else { return };
        let clip = self.scissored(viewport);
        if mask & ACCUM_BUFFER_BIT != 0 && self.framebuffers.draw == 0 {
            self.clear_accum_plane(clip);
        }
        if clip[0] >= clip[2] || clip[1] >= clip[3] {
            return;
        }

        // Find the components that stay: masked ones, and those that the format lacks.
        let missing = self.missing_components();
        let srgb = self.encodes_srgb();
        let written = self.state.color_buffer.mask;
        let masked: [bool; 4] = std::array::from_fn(|i| !written[i] || missing[i]);
        let color =
            surfaces.color.as_ref().filter(|_| mask & COLOR_BUFFER_BIT != 0 && masked != [true; 4]);
        let color = color.map(|s| {
            let clear = self.state.color_buffer.clear;
            // What the format does not store keeps its constant value: a whole clear is then a
            // whole tile's.
            let constant = [0.0, 0.0, 0.0, if missing[3] { 1.0 } else { 0.0 }];
            let clear = std::array::from_fn(|i| if missing[i] { constant[i] } else { clear[i] });
            let unmasked = std::array::from_fn(|i| !written[i] && !missing[i]);
            let mut clear = s.format.clear_color(clear);
            if srgb {
                clear[..3].iter_mut().for_each(|c| *c = srgb_from_linear(c.clamp(0.0, 1.0)));
            }
            (clear, unmasked)
        });

        // Choose the values of depth and stencil.
        let depth =
            (mask & DEPTH_BUFFER_BIT != 0 && self.state.depth.write && surfaces.depth.is_some())
                .then_some(self.state.depth.clear as f32);
        let stencil = (mask & STENCIL_BUFFER_BIT != 0 && surfaces.stencil.is_some()).then(|| {
            let face = self.state.stencil.faces[0];
            ((self.state.stencil.clear & 255) as u8, (face.write_mask & 255) as u8)
        });

        // Skip loading the client's pixels if all of them are overwritten.
        let whole = clip == [0, 0, viewport.width as i32, viewport.height as i32];
        if self.framebuffers.draw == 0 && whole && color.is_some_and(|c| c.1 == [false; 4]) {
            // Nothing of the client's pixels remains.
            self.default_framebuffer.set_loaded();
        }

        // Record the clear.
        if color.is_some() || depth.is_some() || stencil.is_some() {
            self.record(Command::Clear(Clear { color, depth, stencil, clip }));
        }
    }

    /// Which buffers `DrawBuffer` and `ReadBuffer` may name.
    pub(crate) fn buffer_choice(
        &self,
        buffer: u32,
        object: bool,
        draw: bool,
    ) -> Result<(), Failure> {
        let colors = COLOR_ATTACHMENT0..=COLOR_ATTACHMENT15;
        let exists = match buffer {
            NONE => true,
            FRONT_AND_BACK if !draw => return Err((INVALID_ENUM, "FRONT_AND_BACK cannot be read")),
            // There is one buffer. Programs made for windows call it the back one, and Mesa's
            // library takes that.
            FRONT | FRONT_LEFT | LEFT | FRONT_AND_BACK | BACK | BACK_LEFT => !object,
            BACK_RIGHT | FRONT_RIGHT | RIGHT | AUX0..=AUX3 => false,
            _ if colors.contains(&buffer) => {
                object && buffer < COLOR_ATTACHMENT0 + MAX_COLOR_ATTACHMENTS as u32
            }
            _ => return Err((INVALID_ENUM, "the token names no colour buffer")),
        };
        if exists { Ok(()) } else { Err((INVALID_OPERATION, "the framebuffer has no such buffer")) }
    }

    /// `glDrawBuffer`.
    pub fn draw_buffer(&mut self, buf: u32) {
        self.listable(move |c| c.set_buffer("glDrawBuffer", buf, true));
    }

    /// `glReadBuffer`.
    pub fn read_buffer(&mut self, src: u32) {
        self.listable(move |c| c.set_buffer("glReadBuffer", src, false));
    }

    /// `glDrawBuffersARB`: of one buffer at most.
    pub fn draw_buffers(&mut self, n: i32, bufs: usize) {
        const CALL: &str = "glDrawBuffersARB";
        let named = match n {
            0 => Some([NONE]),
            1 => crate::api::read_tokens::<1>(&*self.memory, bufs),
            _ => None,
        };
        self.listable(move |c| match named {
            Some([FRONT_AND_BACK | FRONT | BACK | LEFT | RIGHT]) if c.framebuffers.draw != 0 => {
                c.record_error(INVALID_ENUM, CALL, "the token may name several buffers");
            }
            Some([buffer]) => c.set_buffer(CALL, buffer, true),
            None => c.record_error(
                INVALID_VALUE,
                CALL,
                "there is one draw buffer, which must be in readable memory",
            ),
        });
    }

    fn set_buffer(&mut self, call: &str, buffer: u32, draw: bool) {
        if !self.outside_begin(call) {
            return;
        }
        let name = if draw { self.framebuffers.draw } else { self.framebuffers.read };
        if let Err((error, why)) = self.buffer_choice(buffer, name != 0, draw) {
            return self.record_error(error, call, why);
        }
        self.put_buffer(buffer, draw);
    }

    /// Sets a draw or read buffer that was found valid.
    pub(crate) fn put_buffer(&mut self, buffer: u32, draw: bool) {
        let name = if draw { self.framebuffers.draw } else { self.framebuffers.read };
        match (name, draw) {
            (0, true) => self.state.color_buffer.draw_buffer = buffer,
            (0, false) => self.state.pixel_mode.read_buffer = buffer,
            _ => self.set_object_buffer(draw, buffer),
        }
    }

    /// The colour plane that draws go to, with the components that it stores.
    pub(crate) fn draw_color(&mut self) -> Option<(Shared<ColorPlane>, [bool; 4])> {
        let color = self.draw_surfaces().color?;
        Some((color.color?, color.format.missing()))
    }
}

impl super::internal_format::InternalFormat {
    /// A clear colour as this format stores it.
    fn clear_color(&self, color: [f32; 4]) -> [f32; 4] {
        if self.component_type() == FLOAT { color } else { color.map(super::transfer::clamp_unit) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::context_with;
    use super::*;

    #[test]
    fn scissor_rectangles_are_clipped() {
        let mut c = context_with(10, 10);
        c.state.scissor.enabled = true;
        c.state.scissor.rect = [-5, 2, i32::MAX, 3];
        let viewport = Viewport::new(10, 10).unwrap();
        assert_eq!(c.scissored(viewport), [0, 2, 10, 5]);
        c.state.scissor.rect = [20, 20, 5, 5];
        let [x0, _, x1, _] = c.scissored(viewport);
        assert!(x0 >= x1);
    }

    #[test]
    fn buffers_must_exist() {
        let mut c = context_with(4, 4);
        let mut error = |draw: bool, buffer| {
            c.error = NO_ERROR;
            if draw {
                c.draw_buffer(buffer)
            } else {
                c.read_buffer(buffer)
            }
            c.error
        };
        assert_eq!((error(true, BACK), error(false, BACK_LEFT)), (NO_ERROR, NO_ERROR));
        assert_eq!(error(true, BACK_RIGHT), INVALID_OPERATION);
        assert_eq!(error(true, FRONT_AND_BACK), NO_ERROR);
        assert_eq!(error(false, FRONT_AND_BACK), INVALID_ENUM);
        assert_eq!(error(true, COLOR_ATTACHMENT0), INVALID_OPERATION);
        assert_eq!(error(true, 0x1234), INVALID_ENUM);
        assert_eq!(error(true, NONE), NO_ERROR);
        assert!(c.draw_target(None).unwrap().color.is_none());
    }

    #[test]
    fn unknown_bits_are_an_error() {
        let mut c = context_with(4, 4);
        c.clear(1);
        assert_eq!(c.error, INVALID_VALUE);
    }
}
