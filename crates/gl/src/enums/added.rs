//! Tokens of extensions that games and viewers of the years about 2000 look for; by value.

pub const PRIMITIVE_RESTART_NV: u32 = 0x8558;
pub const PRIMITIVE_RESTART_INDEX_NV: u32 = 0x8559;
pub const FOG_DISTANCE_MODE_NV: u32 = 0x855A;
pub const EYE_RADIAL_NV: u32 = 0x855B;
pub const EYE_PLANE_ABSOLUTE_NV: u32 = 0x855C;
pub const MIRROR_CLAMP_EXT: u32 = 0x8742;
pub const MIRROR_CLAMP_TO_EDGE_EXT: u32 = 0x8743;
pub const MODULATE_ADD_ATI: u32 = 0x8744;
pub const MODULATE_SIGNED_ADD_ATI: u32 = 0x8745;
pub const MODULATE_SUBTRACT_ATI: u32 = 0x8746;
pub const PACK_INVERT_MESA: u32 = 0x8758;
pub const RGBA_FLOAT_MODE_ARB: u32 = 0x8820;
pub const MAX_DRAW_BUFFERS: u32 = 0x8824;
pub const DRAW_BUFFER0: u32 = 0x8825;
pub const CLAMP_VERTEX_COLOR: u32 = 0x891A;
pub const CLAMP_FRAGMENT_COLOR: u32 = 0x891B;
pub const CLAMP_READ_COLOR: u32 = 0x891C;
pub const FIXED_ONLY: u32 = 0x891D;
pub const MIRROR_CLAMP_TO_BORDER_EXT: u32 = 0x8912;
pub const STENCIL_BACK_REF: u32 = 0x8CA3;
pub const STENCIL_BACK_VALUE_MASK: u32 = 0x8CA4;
pub const STENCIL_BACK_WRITEMASK: u32 = 0x8CA5;
pub const RASTER_POSITION_UNCLIPPED_IBM: u32 = 0x19262;
