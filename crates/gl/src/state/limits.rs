//! Limits of this implementation, which `glGet` tells.

/// Texture units of the fixed-function pipeline.
pub const MAX_TEXTURE_UNITS: usize = 8;
/// Lights. MuJoCo names up to 100.
pub const MAX_LIGHTS: usize = 128;
/// User clip planes.
pub const MAX_CLIP_PLANES: usize = 8;
/// Depth of the server and client attribute stacks.
pub const MAX_ATTRIB_STACK_DEPTH: usize = 16;
/// Depth of the selection name stack.
pub const MAX_NAME_STACK_DEPTH: usize = 128;
/// Nested display lists.
pub const MAX_LIST_NESTING: usize = 64;
/// Order of evaluator polynomials.
pub const MAX_EVAL_ORDER: usize = 30;
/// Side of a 1D, 2D or cube texture, of a renderbuffer and of the viewport.
pub const MAX_TEXTURE_SIZE: usize = 16384;
/// Side of a 3D texture.
pub const MAX_3D_TEXTURE_SIZE: usize = 2048;
/// Entries of a pixel map.
pub const MAX_PIXEL_MAP_TABLE: usize = 65536;
/// Samples of multisample renderbuffers.
pub const MAX_SAMPLES: usize = 4;
/// Colour attachments of a framebuffer object.
pub const MAX_COLOR_ATTACHMENTS: usize = 8;

/// Depth of the modelview and projection stacks.
pub const MAX_MATRIX_STACK_DEPTH: usize = 32;
/// Depth of each texture matrix stack.
pub const MAX_TEXTURE_STACK_DEPTH: usize = 10;
/// Width of points and lines.
pub const MAX_POINT_SIZE: f32 = 256.0;
/// Magnitude of `TEXTURE_LOD_BIAS`, object's and unit's together.
pub const MAX_TEXTURE_LOD_BIAS: f32 = 16.0;
/// `MAX_TEXTURE_MAX_ANISOTROPY_EXT`.
pub const MAX_ANISOTROPY: f32 = 16.0;
