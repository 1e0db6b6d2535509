//! `GetFramebufferAttachmentParameteriv`.

use super::Failure;
use super::attachments::{Attached, DEPTH_POINT, STENCIL_POINT};
use super::image::lock;
use super::internal_format::{Bits, Storage};
use super::texture::slot;
use crate::Context;
use crate::enums::*;
use crate::state::MAX_COLOR_ATTACHMENTS;

impl Context {
    /// `glGetFramebufferAttachmentParameteriv`.
    pub fn get_framebuffer_attachment_parameteriv(
        &mut self,
        target: u32,
        attachment: u32,
        pname: u32,
        params: usize,
    ) {
        const CALL: &str = "glGetFramebufferAttachmentParameteriv";
        if !self.outside_begin(CALL) {
            return;
        }
        let Some(name) = self.framebuffer_of(CALL, target) else { return };
        let value = if name == 0 {
            self.default_attachment(attachment, pname)
        } else {
            self.object_attachment(name, attachment, pname)
        };
        match value {
            Err((error, why)) => self.record_error(error, CALL, why),
            Ok(value) if params != 0 => {
                self.memory.write(params, &value.to_ne_bytes());
            }
            Ok(_) => {}
        }
    }

    fn default_attachment(&self, attachment: u32, pname: u32) -> Result<i32, Failure> {
        let surfaces = self.default_framebuffer.surfaces(FRONT);
        let surface = match attachment {
            // There is one colour buffer. Programs ask for the back buffer of windows that were
            // meant to have two.
            FRONT | FRONT_LEFT | BACK | BACK_LEFT | COLOR => surfaces.color,
            DEPTH => surfaces.depth,
            STENCIL => surfaces.stencil,
            FRONT_RIGHT | BACK_RIGHT => None,
            _ => return Err((INVALID_ENUM, "attachment is not a buffer of framebuffer 0")),
        };
        match (pname, surface) {
            (FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, surface) => {
                Ok(if surface.is_some() { FRAMEBUFFER_DEFAULT } else { NONE } as i32)
            }
            (_, None) => no_object(pname),
            (_, Some(surface)) => {
                let (bits, kind) = (surface.format.bits(), surface.format.component_type());
                format_parameter(pname, bits, kind, surface.format.storage)
                    .ok_or((INVALID_ENUM, "pname is not a parameter of this attachment"))
            }
        }
    }

    fn object_attachment(&self, name: u32, attachment: u32, pname: u32) -> Result<i32, Failure> {
        let object = self
            .framebuffers
            .object(name)
            .ok_or((INVALID_OPERATION, "there is no such framebuffer"))?;

        // Find the attachment point.
        let colors = COLOR_ATTACHMENT0..COLOR_ATTACHMENT0 + MAX_COLOR_ATTACHMENTS as u32;
        let point = match attachment {
            DEPTH_ATTACHMENT => DEPTH_POINT,
            STENCIL_ATTACHMENT => STENCIL_POINT,
            DEPTH_STENCIL_ATTACHMENT => {
                let same =
                    match (&object.attachments[DEPTH_POINT], &object.attachments[STENCIL_POINT]) {
                        (Some(depth), Some(stencil)) => depth.same(stencil),
                        (None, None) => true,
                        _ => false,
                    };
                if !same {
                    return Err((INVALID_OPERATION, "depth and stencil attachments differ"));
                }
                DEPTH_POINT
            }
            _ if colors.contains(&attachment) => (attachment - COLOR_ATTACHMENT0) as usize,
            _ => return Err((INVALID_ENUM, "attachment is not an attachment point")),
        };
        if attachment == DEPTH_STENCIL_ATTACHMENT && pname == FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE
        {
            return Err((INVALID_OPERATION, "depth and stencil have types of their own"));
        }

        // Report the parameters of nothing attached.
        let Some(attached) = &object.attachments[point] else {
            return if pname == FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE {
                Ok(NONE as i32)
            } else {
                no_object(pname)
            };
        };

        // Report the object's parameters, or those of its format.
        object_parameter(attached, pname)
            .or_else(|| match attached.surface(point).map(|surface| surface.format) {
                Some(format) => {
                    format_parameter(pname, format.bits(), format.component_type(), format.storage)
                }
                // An attachment that is not complete has no components.
                None => format_parameter(pname, Bits::default(), NONE, Storage::Unorm8),
            })
            .ok_or((INVALID_ENUM, "pname is not a parameter of this attachment"))
    }
}

/// The answer where nothing is attached.
fn no_object(pname: u32) -> Result<i32, Failure> {
    match pname {
        FRAMEBUFFER_ATTACHMENT_OBJECT_NAME => Ok(0),
        FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL
        | FRAMEBUFFER_ATTACHMENT_TEXTURE_CUBE_MAP_FACE
        | FRAMEBUFFER_ATTACHMENT_TEXTURE_LAYER
        | FRAMEBUFFER_ATTACHMENT_RED_SIZE..=FRAMEBUFFER_ATTACHMENT_STENCIL_SIZE
        | FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE
        | FRAMEBUFFER_ATTACHMENT_COLOR_ENCODING => {
            Err((INVALID_OPERATION, "nothing is attached there"))
        }
        _ => Err((INVALID_ENUM, "pname is not a parameter of an attachment")),
    }
}

fn object_parameter(attached: &Attached, pname: u32) -> Option<i32> {
    match (pname, attached) {
        (FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, Attached::Renderbuffer(_)) => {
            Some(RENDERBUFFER as i32)
        }
        (FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, Attached::Texture { .. }) => Some(TEXTURE as i32),
        (FRAMEBUFFER_ATTACHMENT_OBJECT_NAME, Attached::Renderbuffer(r)) => {
            Some(lock(r).name as i32)
        }
        (FRAMEBUFFER_ATTACHMENT_OBJECT_NAME, Attached::Texture { texture, .. }) => {
            Some(lock(texture).name as i32)
        }
        (FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL, Attached::Texture { level, .. }) => {
            Some(*level as i32)
        }
        (FRAMEBUFFER_ATTACHMENT_TEXTURE_LAYER, Attached::Texture { layer, .. }) => {
            Some(*layer as i32)
        }
        (FRAMEBUFFER_ATTACHMENT_TEXTURE_CUBE_MAP_FACE, Attached::Texture { texture, face, .. }) => {
            let cube = lock(texture).slot == slot::CUBE;
            Some(if cube { (TEXTURE_CUBE_MAP_POSITIVE_X + *face as u32) as i32 } else { 0 })
        }
        _ => None,
    }
}

fn format_parameter(pname: u32, bits: Bits, kind: u32, storage: Storage) -> Option<i32> {
    Some(match pname {
        FRAMEBUFFER_ATTACHMENT_RED_SIZE => bits.rgba[0],
        FRAMEBUFFER_ATTACHMENT_GREEN_SIZE => bits.rgba[1],
        FRAMEBUFFER_ATTACHMENT_BLUE_SIZE => bits.rgba[2],
        FRAMEBUFFER_ATTACHMENT_ALPHA_SIZE => bits.rgba[3],
        FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE => bits.depth,
        FRAMEBUFFER_ATTACHMENT_STENCIL_SIZE => bits.stencil,
        FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE => kind as i32,
        FRAMEBUFFER_ATTACHMENT_COLOR_ENCODING => {
            (if storage == Storage::Srgb8 { SRGB_EXT } else { LINEAR }) as i32
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context, context_with, read_u32};
    use super::*;
    use vitral_raster::forward::Texels;

    fn bind_new(c: &mut Context) -> u32 {
        c.gen_framebuffers(1, BASE);
        let name = read_u32(c, BASE);
        c.bind_framebuffer(FRAMEBUFFER, name);
        name
    }

    #[test]
    fn the_default_framebuffer_answers() {
        let mut c = context_with(4, 4);
        assert_eq!(c.check_framebuffer_status(FRAMEBUFFER), FRAMEBUFFER_COMPLETE);
        let mut get = |attachment, pname| {
            c.get_framebuffer_attachment_parameteriv(FRAMEBUFFER, attachment, pname, BASE);
            read_u32(&c, BASE)
        };
        assert_eq!(get(FRONT_LEFT, FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE), FRAMEBUFFER_DEFAULT);
        assert_eq!(get(DEPTH, FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE), 24);
        assert_eq!(get(STENCIL, FRAMEBUFFER_ATTACHMENT_STENCIL_SIZE), 8);
        assert_eq!(c.error, NO_ERROR);
    }

    #[test]
    fn a_shadow_map_is_drawn_to_and_sampled_as_one_plane() {
        let mut c = context();
        c.gen_textures(1, BASE);
        let texture = read_u32(&c, BASE);
        c.bind_texture(TEXTURE_2D, texture);
        c.tex_parameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, NEAREST as i32);
        let internal = DEPTH24_STENCIL8 as i32;
        c.tex_image_2d(TEXTURE_2D, 0, internal, 64, 64, 0, DEPTH_STENCIL, UNSIGNED_INT_24_8, 0);
        c.state.units[0].enabled[slot::TWO] = true;
        bind_new(&mut c);
        assert_eq!(
            c.check_framebuffer_status(FRAMEBUFFER),
            FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT
        );
        c.framebuffer_texture_2d(FRAMEBUFFER, DEPTH_ATTACHMENT, TEXTURE_2D, texture, 0);
        assert_eq!(c.check_framebuffer_status(FRAMEBUFFER), FRAMEBUFFER_COMPLETE);
        c.read_pixels(0, 0, 1, 1, RGBA, UNSIGNED_BYTE, BASE);
        assert_eq!(std::mem::take(&mut c.error), INVALID_OPERATION, "there is no colour to read");
        c.draw_buffer(NONE);
        c.read_buffer(NONE);
        assert_eq!(c.check_framebuffer_status(FRAMEBUFFER), FRAMEBUFFER_COMPLETE);
        let target = c.draw_target(None).unwrap();
        assert!(target.color.is_none() && target.stencil.is_none());
        let sampled = c.sampled_texture(0).unwrap();
        let Texels::DepthBuffer(plane) = sampled.faces[0][0].texels() else { panic!() };
        assert!(std::sync::Arc::ptr_eq(plane, target.depth.as_ref().unwrap()));
        assert_eq!(c.error, NO_ERROR);
        c.bind_framebuffer_ext(FRAMEBUFFER, 0);
        c.delete_textures(1, BASE);
    }

    #[test]
    fn attachments_without_an_image_have_no_components() {
        let mut c = context();
        bind_new(&mut c);
        c.bind_texture(TEXTURE_2D, 5);
        c.framebuffer_texture_2d(FRAMEBUFFER, COLOR_ATTACHMENT0, TEXTURE_2D, 5, 1);
        let get = |c: &mut Context, attachment, pname| {
            c.get_framebuffer_attachment_parameteriv(FRAMEBUFFER, attachment, pname, BASE);
            (read_u32(c, BASE), std::mem::take(&mut c.error))
        };
        for (pname, value) in [
            (FRAMEBUFFER_ATTACHMENT_RED_SIZE, 0),
            (FRAMEBUFFER_ATTACHMENT_COLOR_ENCODING, LINEAR),
            (FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE, NONE),
        ] {
            assert_eq!(get(&mut c, COLOR_ATTACHMENT0, pname), (value, NO_ERROR));
        }
        c.bind_renderbuffer_ext(RENDERBUFFER, 1);
        c.renderbuffer_storage(RENDERBUFFER, DEPTH24_STENCIL8, 4, 4);
        c.framebuffer_renderbuffer(FRAMEBUFFER, DEPTH_STENCIL_ATTACHMENT, RENDERBUFFER, 1);
        let pname = FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE;
        assert_eq!(get(&mut c, DEPTH_ATTACHMENT, pname), (UNSIGNED_NORMALIZED, NO_ERROR));
        assert_eq!(get(&mut c, DEPTH_STENCIL_ATTACHMENT, pname).1, INVALID_OPERATION);
    }

    #[test]
    fn a_read_buffer_that_is_missing_is_noticed() {
        let mut c = context();
        bind_new(&mut c);
        c.bind_renderbuffer_ext(RENDERBUFFER, 1);
        c.renderbuffer_storage(RENDERBUFFER, RGBA8, 4, 4);
        c.framebuffer_renderbuffer(FRAMEBUFFER, COLOR_ATTACHMENT0, RENDERBUFFER, 1);
        let mut error = |buffer| {
            c.read_buffer(buffer);
            c.clear(COLOR_BUFFER_BIT);
            std::mem::take(&mut c.error)
        };
        assert_eq!(error(COLOR_ATTACHMENT0), NO_ERROR);
        assert_eq!(error(COLOR_ATTACHMENT0 + 1), INVALID_FRAMEBUFFER_OPERATION);
        assert_eq!(error(COLOR_ATTACHMENT0), NO_ERROR);
    }

    #[test]
    fn attachments_are_checked() {
        let mut c = context();
        c.framebuffer_renderbuffer(FRAMEBUFFER, COLOR_ATTACHMENT0, RENDERBUFFER, 0);
        assert_eq!(c.error, INVALID_OPERATION);
        c.error = NO_ERROR;
        c.bind_framebuffer(FRAMEBUFFER, 77);
        assert_eq!(c.error, INVALID_OPERATION);
        c.error = NO_ERROR;
        c.bind_framebuffer_ext(FRAMEBUFFER, 77);
        c.framebuffer_texture_2d(FRAMEBUFFER, COLOR_ATTACHMENT0, TEXTURE_2D, 5, 0);
        assert_eq!(c.error, INVALID_OPERATION);
        c.error = NO_ERROR;
        c.bind_texture(TEXTURE_3D, 5);
        c.tex_image_3d(TEXTURE_3D, 0, RGBA as i32, 4, 4, 2, 0, RGBA, UNSIGNED_BYTE, 0);
        c.framebuffer_texture_layer(FRAMEBUFFER, COLOR_ATTACHMENT0, 5, 0, 1);
        assert_eq!(c.check_framebuffer_status(FRAMEBUFFER), FRAMEBUFFER_COMPLETE);
        c.framebuffer_texture_3d(FRAMEBUFFER, COLOR_ATTACHMENT0, TEXTURE_3D, 5, 0, 2);
        assert_eq!(c.check_framebuffer_status(FRAMEBUFFER), FRAMEBUFFER_INCOMPLETE_ATTACHMENT);
        c.framebuffer_texture_2d(FRAMEBUFFER, COLOR_ATTACHMENT0, TEXTURE_2D, 5, 0);
        assert_eq!(c.error, INVALID_OPERATION);
        c.error = NO_ERROR;
        for (level, error) in [(-1, INVALID_VALUE), (11, NO_ERROR), (12, INVALID_VALUE)] {
            c.framebuffer_texture_3d(FRAMEBUFFER, DEPTH_ATTACHMENT, TEXTURE_3D, 5, level, 0);
            assert_eq!(std::mem::take(&mut c.error), error);
        }
        c.delete_framebuffers(1, BASE);
    }
}
