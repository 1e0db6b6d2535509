//! Values: texturing, tests, blending, masks, pixels, framebuffers.

use super::Value;
use crate::api::arguments::unit;
use crate::api::capabilities::index_in;
use crate::state::{PixelStore, target};
use crate::{Context, enums as gl};
use vitral_raster::forward::Clamping;

impl Context {
    pub(super) fn get_texturing(&mut self, pname: u32) -> Option<Value> {
        let bound = |slot| Value::token(self.texture_name(self.state.active_unit, slot));
        Some(match pname {
            gl::SAMPLER_BINDING => Value::token(self.sampler_name(self.state.active_unit)),
            gl::ACTIVE_TEXTURE => Value::token(gl::TEXTURE0 + self.state.active_unit as u32),
            gl::TEXTURE_BINDING_1D => bound(target::ONE),
            gl::TEXTURE_BINDING_2D => bound(target::TWO),
            gl::TEXTURE_BINDING_3D => bound(target::THREE),
            gl::TEXTURE_BINDING_CUBE_MAP => bound(target::CUBE),
            gl::TEXTURE_BINDING_RECTANGLE_ARB => bound(target::RECTANGLE),
            _ => return None,
        })
    }

    pub(super) fn get_tests(&mut self, pname: u32) -> Option<Value> {
        let s = &self.state;
        Some(match pname {
            gl::SCISSOR_BOX => Value::integers(&s.scissor.rect),
            gl::ALPHA_TEST_FUNC => Value::token(s.alpha_test.1),
            gl::ALPHA_TEST_REF => Value::normalized(&[s.alpha_test.2]),
            gl::DEPTH_FUNC => Value::token(s.depth.func),
            gl::DEPTH_WRITEMASK => Value::boolean(s.depth.write),
            gl::DEPTH_CLEAR_VALUE => Value::normalized64(&[s.depth.clear]),
            _ => return None,
        })
    }

    /// `ActiveStencilFaceEXT` chooses what the names without `BACK` tell.
    pub(super) fn get_stencil(&mut self, pname: u32) -> Option<Value> {
        if !is_stencil(pname) {
            return None;
        }
        let largest = (1 << self.framebuffer_bits().stencil.min(8)) - 1;
        let stencil = &self.state.stencil;
        let face = &stencil.faces[if stencil.active_face == 0 { 0 } else { 2 }];
        let back = &stencil.faces[1];
        Some(match pname {
            gl::STENCIL_FUNC => Value::token(face.func),
            gl::STENCIL_REF => Value::integer(face.reference.clamp(0, largest)),
            gl::STENCIL_VALUE_MASK => Value::token(face.value_mask),
            gl::STENCIL_FAIL => Value::token(face.ops[0]),
            gl::STENCIL_PASS_DEPTH_FAIL => Value::token(face.ops[1]),
            gl::STENCIL_PASS_DEPTH_PASS => Value::token(face.ops[2]),
            gl::STENCIL_WRITEMASK => Value::token(face.write_mask),
            gl::STENCIL_CLEAR_VALUE => Value::integer(stencil.clear),
            gl::STENCIL_BACK_REF => Value::integer(back.reference.clamp(0, largest)),
            gl::STENCIL_BACK_VALUE_MASK => Value::token(back.value_mask),
            gl::STENCIL_BACK_WRITEMASK => Value::token(back.write_mask),
            gl::STENCIL_BACK_FUNC_ATI => Value::token(back.func),
            gl::STENCIL_BACK_FAIL_ATI => Value::token(back.ops[0]),
            gl::STENCIL_BACK_PASS_DEPTH_FAIL_ATI => Value::token(back.ops[1]),
            gl::STENCIL_BACK_PASS_DEPTH_PASS_ATI => Value::token(back.ops[2]),
            gl::ACTIVE_STENCIL_FACE_EXT => Value::token([gl::FRONT, gl::BACK][stencil.active_face]),
            _ => return None,
        })
    }

    pub(super) fn get_blending(&mut self, pname: u32) -> Option<Value> {
        let float = self.clamping() == Clamping::None;
        let blend = &self.state.blend;
        let buffer = &self.state.color_buffer;
        Some(match pname {
            gl::BLEND_SRC | gl::BLEND_SRC_RGB => Value::token(blend.source[0]),
            gl::BLEND_SRC_ALPHA => Value::token(blend.source[1]),
            gl::BLEND_DST | gl::BLEND_DST_RGB => Value::token(blend.destination[0]),
            gl::BLEND_DST_ALPHA => Value::token(blend.destination[1]),
            gl::BLEND_EQUATION => Value::token(blend.equation[0]),
            gl::BLEND_EQUATION_ALPHA_EXT => Value::token(blend.equation[1]),
            gl::BLEND_COLOR => Value::normalized(&blend.color.map(unit)),
            gl::LOGIC_OP_MODE => Value::token(self.state.logic_op.1),
            gl::COLOR_WRITEMASK => Value::booleans(&buffer.mask),
            gl::INDEX_WRITEMASK => Value::token(buffer.index_mask),
            gl::COLOR_CLEAR_VALUE if float => Value::normalized(&buffer.clear),
            gl::COLOR_CLEAR_VALUE => Value::normalized(&buffer.clear.map(unit)),
            gl::CLAMP_VERTEX_COLOR => Value::token(buffer.clamps[0]),
            gl::CLAMP_FRAGMENT_COLOR => Value::token(buffer.clamps[1]),
            gl::CLAMP_READ_COLOR => Value::token(buffer.clamps[2]),
            gl::INDEX_CLEAR_VALUE => Value::float(buffer.clear_index),
            gl::ACCUM_CLEAR_VALUE => Value::normalized(&buffer.accum_clear),
            _ => return None,
        })
    }

    pub(super) fn get_pixels(&mut self, pname: u32) -> Option<Value> {
        let pixel = &self.state.pixel;
        if let Some(map) = index_in(pname, gl::PIXEL_MAP_I_TO_I_SIZE, 10) {
            return Some(Value::size(pixel.maps[map].values.len()));
        }
        let zoom = &self.state.pixel_mode.zoom;
        Some(match pname {
            gl::MAP_COLOR => Value::boolean(pixel.map_color),
            gl::MAP_STENCIL => Value::boolean(pixel.map_stencil),
            gl::INDEX_SHIFT => Value::integer(pixel.index.0),
            gl::INDEX_OFFSET => Value::integer(pixel.index.1),
            gl::RED_SCALE => Value::float(pixel.scale[0]),
            gl::GREEN_SCALE => Value::float(pixel.scale[1]),
            gl::BLUE_SCALE => Value::float(pixel.scale[2]),
            gl::ALPHA_SCALE => Value::float(pixel.scale[3]),
            gl::RED_BIAS => Value::float(pixel.bias[0]),
            gl::GREEN_BIAS => Value::float(pixel.bias[1]),
            gl::BLUE_BIAS => Value::float(pixel.bias[2]),
            gl::ALPHA_BIAS => Value::float(pixel.bias[3]),
            gl::DEPTH_SCALE => Value::float(pixel.depth.0),
            gl::DEPTH_BIAS => Value::float(pixel.depth.1),
            gl::ZOOM_X => Value::float(zoom[0]),
            gl::ZOOM_Y => Value::float(zoom[1]),
            _ => return pixel_store(pname, &self.client.unpack, &self.client.pack),
        })
    }

    pub(super) fn get_framebuffer(&mut self, pname: u32) -> Option<Value> {
        Some(match pname {
            gl::INDEX_BITS | gl::AUX_BUFFERS => Value::integer(0),
            gl::STEREO | gl::INDEX_MODE => Value::boolean(false),
            gl::FRAMEBUFFER_SRGB_CAPABLE_EXT => Value::boolean(self.draws_srgb()),
            gl::RGBA_MODE => Value::boolean(true),
            gl::RGBA_FLOAT_MODE_ARB => Value::boolean(self.clamping() != Clamping::Results),
            gl::MAX_DRAW_BUFFERS => Value::integer(1),
            gl::DRAW_BUFFER0 => Value::token(self.draw_buffer_token()),
            gl::DRAW_BUFFER => Value::token(self.draw_buffer_token()),
            gl::READ_BUFFER => Value::token(self.read_buffer_token()),
            gl::DRAW_FRAMEBUFFER_BINDING => Value::token(self.draw_framebuffer_name()),
            gl::READ_FRAMEBUFFER_BINDING => Value::token(self.read_framebuffer_name()),
            gl::RENDERBUFFER_BINDING => Value::token(self.renderbuffer_name()),
            _ => return self.get_bits(pname),
        })
    }

    fn get_bits(&mut self, pname: u32) -> Option<Value> {
        let known = matches!(
            pname,
            gl::RED_BITS
                ..=gl::ACCUM_ALPHA_BITS | gl::SAMPLES | gl::SAMPLE_BUFFERS | gl::DOUBLEBUFFER
        );
        if !known {
            return None;
        }
        let bits = self.framebuffer_bits();
        Some(match pname {
            gl::RED_BITS => Value::token(bits.color[0]),
            gl::GREEN_BITS => Value::token(bits.color[1]),
            gl::BLUE_BITS => Value::token(bits.color[2]),
            gl::ALPHA_BITS => Value::token(bits.color[3]),
            gl::DEPTH_BITS => Value::token(bits.depth),
            gl::STENCIL_BITS => Value::token(bits.stencil),
            gl::ACCUM_RED_BITS => Value::token(bits.accum[0]),
            gl::ACCUM_GREEN_BITS => Value::token(bits.accum[1]),
            gl::ACCUM_BLUE_BITS => Value::token(bits.accum[2]),
            gl::ACCUM_ALPHA_BITS => Value::token(bits.accum[3]),
            gl::SAMPLES => Value::token(bits.samples),
            gl::SAMPLE_BUFFERS => Value::integer(i32::from(bits.samples > 0)),
            gl::DOUBLEBUFFER => Value::boolean(bits.double_buffer),
            _ => return None,
        })
    }
}

/// Whether a token belongs to the stencil test.
fn is_stencil(pname: u32) -> bool {
    matches!(
        pname,
        gl::STENCIL_CLEAR_VALUE..=gl::STENCIL_WRITEMASK
            | gl::STENCIL_BACK_REF..=gl::STENCIL_BACK_WRITEMASK
            | gl::STENCIL_BACK_FUNC_ATI..=gl::STENCIL_BACK_PASS_DEPTH_PASS_ATI
            | gl::ACTIVE_STENCIL_FACE_EXT
    )
}

fn pixel_store(pname: u32, unpack: &PixelStore, pack: &PixelStore) -> Option<Value> {
    Some(match pname {
        gl::UNPACK_SWAP_BYTES => Value::boolean(unpack.swap_bytes),
        gl::UNPACK_LSB_FIRST => Value::boolean(unpack.lsb_first),
        gl::UNPACK_ROW_LENGTH => Value::integer(unpack.row_length),
        gl::UNPACK_IMAGE_HEIGHT => Value::integer(unpack.image_height),
        gl::UNPACK_SKIP_ROWS => Value::integer(unpack.skip_rows),
        gl::UNPACK_SKIP_PIXELS => Value::integer(unpack.skip_pixels),
        gl::UNPACK_SKIP_IMAGES => Value::integer(unpack.skip_images),
        gl::UNPACK_ALIGNMENT => Value::integer(unpack.alignment),
        gl::PACK_SWAP_BYTES => Value::boolean(pack.swap_bytes),
        gl::PACK_LSB_FIRST => Value::boolean(pack.lsb_first),
        gl::PACK_ROW_LENGTH => Value::integer(pack.row_length),
        gl::PACK_IMAGE_HEIGHT => Value::integer(pack.image_height),
        gl::PACK_SKIP_ROWS => Value::integer(pack.skip_rows),
        gl::PACK_SKIP_PIXELS => Value::integer(pack.skip_pixels),
        gl::PACK_SKIP_IMAGES => Value::integer(pack.skip_images),
        gl::PACK_INVERT_MESA => Value::boolean(pack.invert),
        gl::PACK_ALIGNMENT => Value::integer(pack.alignment),
        _ => return None,
    })
}
