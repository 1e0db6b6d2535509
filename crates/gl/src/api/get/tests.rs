//! The state tables of the specification: initial values, conversions.

use crate::Context;
use crate::api::testing::{RESULT, context, take};
use crate::enums as gl;

fn integers<const N: usize>(c: &mut Context, pname: u32) -> [i32; N] {
    c.get_integerv(pname, RESULT);
    assert_eq!(c.get_error(), gl::NO_ERROR, "{pname:x}");
    take(c)
}

fn floats<const N: usize>(c: &mut Context, pname: u32) -> [f32; N] {
    c.get_floatv(pname, RESULT);
    assert_eq!(c.get_error(), gl::NO_ERROR, "{pname:x}");
    take(c)
}

#[test]
fn initial_tokens_and_integers() {
    let mut c = context();
    for (pname, value) in [
        (gl::MATRIX_MODE, gl::MODELVIEW),
        (gl::MODELVIEW_STACK_DEPTH, 1),
        (gl::PROJECTION_STACK_DEPTH, 1),
        (gl::TEXTURE_STACK_DEPTH, 1),
        (gl::FOG_MODE, gl::EXP),
        (gl::FOG_COORD_SRC, gl::FRAGMENT_DEPTH),
        (gl::SHADE_MODEL, gl::SMOOTH),
        (gl::PROVOKING_VERTEX, gl::LAST_VERTEX_CONVENTION),
        (gl::QUADS_FOLLOW_PROVOKING_VERTEX_CONVENTION, 0),
        (gl::FOG_DISTANCE_MODE_NV, gl::EYE_PLANE_ABSOLUTE_NV),
        (gl::COLOR_MATERIAL_PARAMETER, gl::AMBIENT_AND_DIFFUSE),
        (gl::COLOR_MATERIAL_FACE, gl::FRONT_AND_BACK),
        (gl::LIGHT_MODEL_COLOR_CONTROL, gl::SINGLE_COLOR),
        (gl::LINE_STIPPLE_PATTERN, 0xFFFF),
        (gl::LINE_STIPPLE_REPEAT, 1),
        (gl::CULL_FACE_MODE, gl::BACK),
        (gl::FRONT_FACE, gl::CCW),
        (gl::ACTIVE_TEXTURE, gl::TEXTURE0),
        (gl::CLIENT_ACTIVE_TEXTURE, gl::TEXTURE0),
        (gl::ALPHA_TEST_FUNC, gl::ALWAYS),
        (gl::STENCIL_FUNC, gl::ALWAYS),
        (gl::STENCIL_VALUE_MASK, u32::MAX),
        (gl::STENCIL_REF, 0),
        (gl::STENCIL_FAIL, gl::KEEP),
        (gl::STENCIL_WRITEMASK, u32::MAX),
        (gl::DEPTH_FUNC, gl::LESS),
        (gl::DEPTH_WRITEMASK, 1),
        (gl::BLEND_SRC_RGB, gl::ONE),
        (gl::BLEND_DST_ALPHA, gl::ZERO),
        (gl::BLEND_EQUATION, gl::FUNC_ADD),
        (gl::LOGIC_OP_MODE, gl::COPY),
        (gl::UNPACK_ALIGNMENT, 4),
        (gl::PACK_ROW_LENGTH, 0),
        (gl::PIXEL_MAP_A_TO_A_SIZE, 1),
        (gl::MAP1_GRID_SEGMENTS, 1),
        (gl::PERSPECTIVE_CORRECTION_HINT, gl::DONT_CARE),
        (gl::TEXTURE_COMPRESSION_HINT, gl::DONT_CARE),
        (gl::VERTEX_ARRAY_SIZE, 4),
        (gl::COLOR_ARRAY_TYPE, gl::FLOAT),
        (gl::SECONDARY_COLOR_ARRAY_SIZE, 3),
        (gl::ARRAY_BUFFER_BINDING, 0),
        (gl::MAX_SERVER_WAIT_TIMEOUT, 0),
        (gl::LIST_BASE, 0),
        (gl::RENDER_MODE, gl::RENDER),
        (gl::ATTRIB_STACK_DEPTH, 0),
        (gl::DEBUG_GROUP_STACK_DEPTH, 1),
        (gl::CLIP_ORIGIN, gl::LOWER_LEFT),
        (gl::CLIP_DEPTH_MODE, gl::NEGATIVE_ONE_TO_ONE),
        (gl::NUM_COMPRESSED_TEXTURE_FORMATS, 3),
        (gl::CURRENT_RASTER_POSITION_VALID, 1),
    ] {
        assert_eq!(integers::<1>(&mut c, pname)[0] as u32, value, "{pname:x}");
    }
}

#[test]
fn initial_floats() {
    let mut c = context();
    for (pname, value) in [
        (gl::CURRENT_COLOR, [1.0, 1.0, 1.0, 1.0]),
        (gl::CURRENT_SECONDARY_COLOR, [0.0, 0.0, 0.0, 1.0]),
        (gl::CURRENT_TEXTURE_COORDS, [0.0, 0.0, 0.0, 1.0]),
        (gl::CURRENT_RASTER_POSITION, [0.0, 0.0, 0.0, 1.0]),
        (gl::LIGHT_MODEL_AMBIENT, [0.2, 0.2, 0.2, 1.0]),
        (gl::FOG_COLOR, [0.0; 4]),
        (gl::COLOR_CLEAR_VALUE, [0.0; 4]),
        (gl::BLEND_COLOR, [0.0; 4]),
        (gl::ACCUM_CLEAR_VALUE, [0.0; 4]),
        (gl::MAP2_GRID_DOMAIN, [0.0, 1.0, 0.0, 1.0]),
        (gl::COLOR_WRITEMASK, [1.0; 4]),
    ] {
        assert_eq!(floats::<4>(&mut c, pname), value, "{pname:x}");
    }
    assert_eq!(floats::<3>(&mut c, gl::CURRENT_NORMAL), [0.0, 0.0, 1.0]);
    assert_eq!(floats::<3>(&mut c, gl::POINT_DISTANCE_ATTENUATION), [1.0, 0.0, 0.0]);
    for (pname, value) in [
        (gl::POINT_SIZE, 1.0),
        (gl::LINE_WIDTH, 1.0),
        (gl::POINT_SIZE_MIN, 0.0),
        (gl::POINT_FADE_THRESHOLD_SIZE, 1.0),
        (gl::FOG_DENSITY, 1.0),
        (gl::FOG_END, 1.0),
        (gl::DEPTH_CLEAR_VALUE, 1.0),
        (gl::SAMPLE_COVERAGE_VALUE, 1.0),
        (gl::RED_SCALE, 1.0),
        (gl::DEPTH_SCALE, 1.0),
        (gl::ZOOM_Y, 1.0),
        (gl::CURRENT_INDEX, 1.0),
    ] {
        assert_eq!(floats::<1>(&mut c, pname), [value], "{pname:x}");
    }
}

#[test]
fn conversions() {
    let mut c = context();
    c.clear_color(1.0, 0.5, 0.0, 1.0);
    assert_eq!(integers::<4>(&mut c, gl::COLOR_CLEAR_VALUE), [i32::MAX, 0x3FFF_FFFF, 0, i32::MAX]);
    c.clear_accum(-1.0, 0.0, 0.0, 0.0);
    assert_eq!(integers::<1>(&mut c, gl::ACCUM_CLEAR_VALUE), [i32::MIN]);
    c.line_width(2.5);
    assert_eq!(integers::<1>(&mut c, gl::LINE_WIDTH), [3]);
    c.get_booleanv(gl::LINE_WIDTH, RESULT);
    assert_eq!(take::<u8, 1>(&c), [1]);
    c.depth_range(0.25, 0.75);
    c.get_doublev(gl::DEPTH_RANGE, RESULT);
    assert_eq!(take::<f64, 2>(&c), [0.25, 0.75]);
    assert_eq!(floats::<1>(&mut c, gl::STENCIL_WRITEMASK), [4_294_967_295.0]);
    c.get_doublev(gl::DITHER, RESULT);
    assert_eq!(take::<f64, 1>(&c), [1.0]);
    c.translatef(1.0, 2.0, 3.0);
    assert_eq!(floats::<16>(&mut c, gl::MODELVIEW_MATRIX)[12..15], [1.0, 2.0, 3.0]);
    let transposed = floats::<16>(&mut c, gl::TRANSPOSE_MODELVIEW_MATRIX);
    assert_eq!([transposed[3], transposed[7], transposed[11]], [1.0, 2.0, 3.0]);
}

#[test]
fn limits_reach_the_minima_of_the_specification() {
    let mut c = context();
    for (pname, least) in [
        (gl::MAX_LIGHTS, 8),
        (gl::MAX_CLIP_PLANES, 6),
        (gl::MAX_MODELVIEW_STACK_DEPTH, 32),
        (gl::MAX_PROJECTION_STACK_DEPTH, 2),
        (gl::MAX_TEXTURE_STACK_DEPTH, 2),
        (gl::SUBPIXEL_BITS, 4),
        (gl::MAX_3D_TEXTURE_SIZE, 16),
        (gl::MAX_TEXTURE_SIZE, 64),
        (gl::MAX_CUBE_MAP_TEXTURE_SIZE, 16),
        (gl::MAX_TEXTURE_LOD_BIAS, 2),
        (gl::MAX_PIXEL_MAP_TABLE, 32),
        (gl::MAX_NAME_STACK_DEPTH, 64),
        (gl::MAX_LIST_NESTING, 64),
        (gl::MAX_EVAL_ORDER, 8),
        (gl::MAX_ATTRIB_STACK_DEPTH, 16),
        (gl::MAX_CLIENT_ATTRIB_STACK_DEPTH, 16),
        (gl::MAX_TEXTURE_UNITS, 4),
        (gl::MAX_SAMPLES, 4),
        (gl::MAX_COLOR_ATTACHMENTS, 1),
        (gl::MAX_RENDERBUFFER_SIZE, 1),
        (gl::MAX_DEBUG_MESSAGE_LENGTH, 1),
        (gl::MAX_DEBUG_LOGGED_MESSAGES, 1),
        (gl::MAX_DEBUG_GROUP_STACK_DEPTH, 64),
        (gl::MAX_LABEL_LENGTH, 256),
    ] {
        assert!(integers::<1>(&mut c, pname)[0] >= least, "{pname:x}");
    }
}

#[test]
fn every_group_answers() {
    let mut c = context();
    let runs = [
        (gl::CURRENT_COLOR, gl::CURRENT_RASTER_DISTANCE),
        (gl::POINT_SMOOTH, gl::POINT_SIZE_GRANULARITY),
        (gl::LINE_SMOOTH, gl::LINE_STIPPLE_REPEAT),
        (gl::LIST_MODE, gl::LIST_INDEX),
        (gl::POLYGON_MODE, gl::FRONT_FACE),
        (gl::LIGHTING, gl::COLOR_MATERIAL),
        (gl::FOG, gl::FOG_COLOR),
        (gl::DEPTH_RANGE, gl::DEPTH_FUNC),
        (gl::STENCIL_TEST, gl::STENCIL_WRITEMASK),
        (gl::MATRIX_MODE, gl::TEXTURE_MATRIX),
        (gl::ATTRIB_STACK_DEPTH, gl::CLIENT_ATTRIB_STACK_DEPTH),
        (gl::ALPHA_TEST, gl::ALPHA_TEST_REF),
        (gl::BLEND_DST, gl::BLEND),
        (gl::LOGIC_OP_MODE, gl::COLOR_LOGIC_OP),
        (gl::AUX_BUFFERS, gl::READ_BUFFER),
        (gl::SCISSOR_BOX, gl::SCISSOR_TEST),
        (gl::INDEX_CLEAR_VALUE, gl::COLOR_WRITEMASK),
        (gl::INDEX_MODE, gl::STEREO),
        (gl::PERSPECTIVE_CORRECTION_HINT, gl::FOG_HINT),
        (gl::TEXTURE_GEN_S, gl::TEXTURE_GEN_Q),
        (gl::PIXEL_MAP_I_TO_I_SIZE, gl::PIXEL_MAP_A_TO_A_SIZE),
        (gl::UNPACK_SWAP_BYTES, gl::UNPACK_ALIGNMENT),
        (gl::PACK_SWAP_BYTES, gl::PACK_ALIGNMENT),
        (gl::MAP_COLOR, gl::DEPTH_BIAS),
        (gl::MAX_EVAL_ORDER, gl::MAX_CLIENT_ATTRIB_STACK_DEPTH),
        (gl::SUBPIXEL_BITS, gl::ACCUM_ALPHA_BITS),
        (gl::MAP1_COLOR_4, gl::MAP1_VERTEX_4),
        (gl::MAP2_COLOR_4, gl::MAP2_VERTEX_4),
        (gl::MAP1_GRID_DOMAIN, gl::MAP2_GRID_SEGMENTS),
        (gl::TEXTURE_1D, gl::TEXTURE_2D),
        (gl::TEXTURE_BINDING_1D, gl::UNPACK_IMAGE_HEIGHT),
        (gl::VERTEX_ARRAY, gl::VERTEX_ARRAY_STRIDE),
        (gl::MULTISAMPLE, gl::SAMPLE_COVERAGE),
        (gl::SAMPLE_BUFFERS, gl::SAMPLE_COVERAGE_INVERT),
        (gl::BLEND_DST_RGB, gl::BLEND_SRC_ALPHA),
        (gl::POINT_SIZE_MIN, gl::POINT_DISTANCE_ATTENUATION),
        (gl::CURRENT_FOG_COORD, gl::FOG_COORD_ARRAY_STRIDE),
        (gl::FOG_COORD_ARRAY, gl::SECONDARY_COLOR_ARRAY_STRIDE),
        (gl::ACTIVE_TEXTURE, gl::TRANSPOSE_TEXTURE_MATRIX),
        (gl::NUM_COMPRESSED_TEXTURE_FORMATS, gl::COMPRESSED_TEXTURE_FORMATS),
        (gl::STENCIL_BACK_FUNC_ATI, gl::STENCIL_BACK_PASS_DEPTH_PASS_ATI),
        (gl::ARRAY_BUFFER_BINDING, gl::FOG_COORD_ARRAY_BUFFER_BINDING),
        (gl::DRAW_FRAMEBUFFER_BINDING, gl::RENDERBUFFER_BINDING),
        (gl::CLIP_PLANE0, gl::CLIP_PLANE5),
        (gl::LIGHT0, gl::LIGHT7),
    ];
    for (first, last) in runs {
        for pname in first..=last {
            assert!(c.knows(pname), "{pname:x}");
        }
    }
    for unknown in [0x0B5D, gl::FOG_COORD, gl::TEXTURE_ENV_MODE, gl::QUERY_RESULT] {
        assert!(!c.knows(unknown));
    }
    c.get_integerv(gl::QUERY_RESULT, RESULT);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
}
