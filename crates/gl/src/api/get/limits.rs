//! Values: what the implementation allows.

use super::Value;
use crate::api::debug::{MAX_GROUPS, MAX_LABEL_LENGTH, MAX_LOGGED, MAX_MESSAGE_LENGTH};
use crate::{Context, enums as gl, state};

/// What `DrawRangeElements` is fastest with.
const MAX_ELEMENTS: i32 = 65536;

/// Those that programs may choose for any image: with one bit of alpha is not among them.
const COMPRESSED_FORMATS: [u32; 3] = [
    gl::COMPRESSED_RGB_S3TC_DXT1_EXT,
    gl::COMPRESSED_RGBA_S3TC_DXT3_EXT,
    gl::COMPRESSED_RGBA_S3TC_DXT5_EXT,
];

impl Context {
    pub(super) fn get_limits(&mut self, pname: u32) -> Option<Value> {
        let points = [1.0, state::MAX_POINT_SIZE];
        Some(match pname {
            gl::MAX_LIGHTS => Value::size(state::MAX_LIGHTS),
            gl::MAX_CLIP_PLANES => Value::size(state::MAX_CLIP_PLANES),
            gl::MAX_MODELVIEW_STACK_DEPTH | gl::MAX_PROJECTION_STACK_DEPTH => {
                Value::size(state::MAX_MATRIX_STACK_DEPTH)
            }
            gl::MAX_TEXTURE_STACK_DEPTH => Value::size(state::MAX_TEXTURE_STACK_DEPTH),
            gl::MAX_ATTRIB_STACK_DEPTH | gl::MAX_CLIENT_ATTRIB_STACK_DEPTH => {
                Value::size(state::MAX_ATTRIB_STACK_DEPTH)
            }
            gl::MAX_NAME_STACK_DEPTH => Value::size(state::MAX_NAME_STACK_DEPTH),
            gl::MAX_LIST_NESTING => Value::size(state::MAX_LIST_NESTING),
            gl::MAX_EVAL_ORDER => Value::size(state::MAX_EVAL_ORDER),
            gl::MAX_PIXEL_MAP_TABLE => Value::size(state::MAX_PIXEL_MAP_TABLE),
            gl::MAX_VIEWPORT_DIMS => Value::integers(&[state::MAX_TEXTURE_SIZE as i32; 2]),
            gl::SUBPIXEL_BITS => Value::integer(8),
            gl::SMOOTH_POINT_SIZE_RANGE | gl::ALIASED_POINT_SIZE_RANGE => Value::floats(&points),
            gl::SMOOTH_LINE_WIDTH_RANGE | gl::ALIASED_LINE_WIDTH_RANGE => Value::floats(&points),
            gl::SMOOTH_POINT_SIZE_GRANULARITY | gl::SMOOTH_LINE_WIDTH_GRANULARITY => {
                Value::float(0.125)
            }
            gl::MAX_ELEMENTS_INDICES | gl::MAX_ELEMENTS_VERTICES => Value::integer(MAX_ELEMENTS),
            gl::MAX_SHININESS_NV | gl::MAX_SPOT_EXPONENT_NV => Value::integer(128),
            gl::MAX_DEBUG_MESSAGE_LENGTH => Value::size(MAX_MESSAGE_LENGTH),
            gl::MAX_DEBUG_LOGGED_MESSAGES => Value::size(MAX_LOGGED),
            gl::MAX_DEBUG_GROUP_STACK_DEPTH => Value::size(MAX_GROUPS),
            // Everything has been done before a wait begins.
            gl::MAX_SERVER_WAIT_TIMEOUT => Value::integer(0),
            gl::MAX_LABEL_LENGTH => Value::size(MAX_LABEL_LENGTH),
            _ => return texture_limit(pname),
        })
    }
}

fn texture_limit(pname: u32) -> Option<Value> {
    Some(match pname {
        gl::MAX_TEXTURE_UNITS => Value::size(state::MAX_TEXTURE_UNITS),
        gl::MAX_TEXTURE_SIZE
        | gl::MAX_CUBE_MAP_TEXTURE_SIZE
        | gl::MAX_RECTANGLE_TEXTURE_SIZE_ARB => Value::size(state::MAX_TEXTURE_SIZE),
        gl::MAX_RENDERBUFFER_SIZE => Value::size(state::MAX_TEXTURE_SIZE),
        gl::MAX_3D_TEXTURE_SIZE => Value::size(state::MAX_3D_TEXTURE_SIZE),
        gl::MAX_TEXTURE_LOD_BIAS => Value::float(state::MAX_TEXTURE_LOD_BIAS),
        gl::MAX_TEXTURE_MAX_ANISOTROPY_EXT => Value::float(state::MAX_ANISOTROPY),
        gl::NUM_COMPRESSED_TEXTURE_FORMATS => Value::size(COMPRESSED_FORMATS.len()),
        gl::COMPRESSED_TEXTURE_FORMATS => {
            Value::integers(&COMPRESSED_FORMATS.map(u32::cast_signed))
        }
        gl::MAX_SAMPLES => Value::size(state::MAX_SAMPLES),
        gl::MAX_COLOR_ATTACHMENTS => Value::size(state::MAX_COLOR_ATTACHMENTS),
        _ => return None,
    })
}
