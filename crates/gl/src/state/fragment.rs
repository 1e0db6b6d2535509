//! Per-fragment state.

use crate::enums;

/// What `glFog` and `FOG` set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fog {
    /// `FOG`.
    pub enabled: bool,
    /// `FOG_COLOR`.
    pub color: [f32; 4],
    /// `FOG_INDEX`, kept for queries alone.
    pub index: f32,
    /// `FOG_DENSITY`.
    pub density: f32,
    /// `FOG_START`.
    pub start: f32,
    /// `FOG_END`.
    pub end: f32,
    /// `FOG_MODE`.
    pub mode: u32,
    /// `FOG_COORD_SRC`.
    pub source: u32,
    /// `FOG_DISTANCE_MODE_NV`.
    pub distance_mode: u32,
}

impl Default for Fog {
    fn default() -> Self {
        Self {
            enabled: false,
            color: [0.0; 4],
            index: 0.0,
            density: 1.0,
            start: 0.0,
            end: 1.0,
            mode: enums::EXP,
            source: enums::FRAGMENT_DEPTH,
            distance_mode: enums::EYE_PLANE_ABSOLUTE_NV,
        }
    }
}

/// One side's stencil state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StencilFace {
    /// Function.
    pub func: u32,
    /// Reference, as given.
    pub reference: i32,
    /// Mask of the comparison.
    pub value_mask: u32,
    /// Operations: stencil fails, depth fails, depth passes.
    pub ops: [u32; 3],
    /// Which bits may be written.
    pub write_mask: u32,
}

/// What `glStencil...` calls set, for all faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StencilState {
    /// `STENCIL_TEST`.
    pub enabled: bool,
    /// `STENCIL_TEST_TWO_SIDE_EXT`.
    pub two_side: bool,
    /// `ACTIVE_STENCIL_FACE_EXT`: 0 front, 1 back.
    pub active_face: usize,
    /// Front; back (which differs from the front only through ATI_separate_stencil); back of
    /// EXT_stencil_two_side.
    pub faces: [StencilFace; 3],
    /// `STENCIL_CLEAR_VALUE`.
    pub clear: i32,
}

impl StencilState {
    /// What holds for front-facing polygons, points, lines and images.
    pub fn front(&self) -> &StencilFace {
        &self.faces[0]
    }

    /// What holds for back-facing polygons.
    pub fn back(&self) -> &StencilFace {
        &self.faces[if self.two_side { 2 } else { 1 }]
    }
}

impl Default for StencilState {
    fn default() -> Self {
        let face = StencilFace {
            func: enums::ALWAYS,
            reference: 0,
            value_mask: u32::MAX,
            ops: [enums::KEEP; 3],
            write_mask: u32::MAX,
        };
        Self { enabled: false, two_side: false, active_face: 0, faces: [face; 3], clear: 0 }
    }
}

/// Depth test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthState {
    /// `DEPTH_TEST`.
    pub enabled: bool,
    /// `DEPTH_FUNC`.
    pub func: u32,
    /// `DEPTH_WRITEMASK`.
    pub write: bool,
    /// `DEPTH_CLEAR_VALUE`.
    pub clear: f64,
}

impl Default for DepthState {
    fn default() -> Self {
        Self { enabled: false, func: enums::LESS, write: true, clear: 1.0 }
    }
}

/// Blending. Pairs are (colour, alpha).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// `BLEND`.
    pub enabled: bool,
    /// Source factors.
    pub source: [u32; 2],
    /// Destination factors.
    pub destination: [u32; 2],
    /// Equations of colour and of alpha.
    pub equation: [u32; 2],
    /// `BLEND_COLOR` as it was given; clamped where it meets colours that are not floating-point,
    /// and in queries.
    pub color: [f32; 4],
}

impl Blend {
    /// EXT_blend_logic_op: blending is replaced by the logic operation.
    pub fn is_logic_op(&self) -> bool {
        self.enabled && self.equation[0] == enums::LOGIC_OP
    }
}

impl Default for Blend {
    fn default() -> Self {
        Self {
            enabled: false,
            source: [enums::ONE; 2],
            destination: [enums::ZERO; 2],
            equation: [enums::FUNC_ADD; 2],
            color: [0.0; 4],
        }
    }
}

/// Clear values, masks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorBuffer {
    /// `COLOR_CLEAR_VALUE`.
    pub clear: [f32; 4],
    /// `INDEX_CLEAR_VALUE`, kept for queries alone.
    pub clear_index: f32,
    /// `COLOR_WRITEMASK`.
    pub mask: [bool; 4],
    /// `INDEX_WRITEMASK`, kept for queries alone.
    pub index_mask: u32,
    /// `ACCUM_CLEAR_VALUE`.
    pub accum_clear: [f32; 4],
    /// `DRAW_BUFFER` of the default framebuffer.
    pub draw_buffer: u32,
    /// `CLAMP_VERTEX_COLOR`, `CLAMP_FRAGMENT_COLOR`, `CLAMP_READ_COLOR`: 1, 0 or `FIXED_ONLY`.
    pub clamps: [u32; 3],
}

impl Default for ColorBuffer {
    fn default() -> Self {
        Self {
            clear: [0.0; 4],
            clear_index: 0.0,
            mask: [true; 4],
            index_mask: u32::MAX,
            accum_clear: [0.0; 4],
            draw_buffer: enums::FRONT,
            clamps: [enums::TRUE, enums::FIXED_ONLY, enums::FIXED_ONLY],
        }
    }
}
