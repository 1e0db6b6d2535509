//! The state tables of the specification as plain structs, one file per group; `Default` is the
//! initial value.

mod client;
mod fragment;
mod lighting;
mod limits;
mod matrix;
mod pixel;
mod raster;
mod texture;
mod vertex;

pub use client::{ArrayPointer, ClientState, PixelStore};
pub use fragment::{Blend, ColorBuffer, DepthState, Fog, StencilFace, StencilState};
pub use lighting::{ColorMaterial, Light, LightModel, Lighting, MaterialFace};
pub use limits::{
    MAX_3D_TEXTURE_SIZE, MAX_ANISOTROPY, MAX_ATTRIB_STACK_DEPTH, MAX_CLIP_PLANES,
    MAX_COLOR_ATTACHMENTS, MAX_EVAL_ORDER, MAX_LIGHTS, MAX_LIST_NESTING, MAX_MATRIX_STACK_DEPTH,
    MAX_NAME_STACK_DEPTH, MAX_PIXEL_MAP_TABLE, MAX_POINT_SIZE, MAX_SAMPLES, MAX_TEXTURE_LOD_BIAS,
    MAX_TEXTURE_SIZE, MAX_TEXTURE_STACK_DEPTH, MAX_TEXTURE_UNITS,
};
pub use matrix::{Matrices, MatrixStack};
pub use pixel::{PixelMap, PixelMode, PixelTransfer};
pub use raster::{Lines, Points, Polygons, Scissor, Viewport};
pub use texture::{Combine, TexGen, TextureEnvironment, TextureUnit, target};
pub use vertex::{Current, Eval, Map1, Map2, RasterPosition};

use crate::enums;

/// All server state of a context that is not an object.
#[derive(Clone, Debug)]
pub struct State {
    /// Current vertex attributes.
    pub current: Current,
    /// The raster position (always valid state; `valid` tells whether it may draw).
    pub raster_position: RasterPosition,
    /// Matrix stacks and `NORMALIZE`, `RESCALE_NORMAL`.
    pub matrices: Matrices,
    /// Viewport and depth range.
    pub viewport: Viewport,
    /// Planes of `ClipPlane`, eye space.
    pub clip_planes: [[f64; 4]; MAX_CLIP_PLANES],
    /// Which of them are enabled.
    pub clip_plane_enabled: [bool; MAX_CLIP_PLANES],
    /// Lights, materials, light model, shade model.
    pub lighting: Lighting,
    /// Fog.
    pub fog: Fog,
    /// `COLOR_SUM`.
    pub color_sum: bool,
    /// Points.
    pub points: Points,
    /// Lines.
    pub lines: Lines,
    /// Polygons.
    pub polygons: Polygons,
    /// `MULTISAMPLE`, initially on.
    pub multisample: bool,
    /// `SAMPLE_ALPHA_TO_COVERAGE`.
    pub sample_alpha_to_coverage: bool,
    /// `SAMPLE_ALPHA_TO_ONE`.
    pub sample_alpha_to_one: bool,
    /// `SAMPLE_COVERAGE`.
    pub sample_coverage: bool,
    /// `SAMPLE_COVERAGE_VALUE`, `SAMPLE_COVERAGE_INVERT`.
    pub sample_coverage_value: (f32, bool),
    /// `DEPTH_CLAMP` (ARB_depth_clamp).
    pub depth_clamp: bool,
    /// `TEXTURE_CUBE_MAP_SEAMLESS`.
    pub cube_map_seamless: bool,
    /// `CLIP_ORIGIN`, `CLIP_DEPTH_MODE` (ARB_clip_control).
    pub clip_control: (u32, u32),
    /// Texture units.
    pub units: [TextureUnit; MAX_TEXTURE_UNITS],
    /// `ACTIVE_TEXTURE - TEXTURE0`.
    pub active_unit: usize,
    /// Scissor.
    pub scissor: Scissor,
    /// Alpha test: enabled, function, reference.
    pub alpha_test: (bool, u32, f32),
    /// Stencil.
    pub stencil: StencilState,
    /// Depth test.
    pub depth: DepthState,
    /// Blending.
    pub blend: Blend,
    /// `DITHER`, kept but without effect.
    pub dither: bool,
    /// `COLOR_LOGIC_OP` and the operation.
    pub logic_op: (bool, u32),
    /// `INDEX_LOGIC_OP`, kept but without effect: there are no colour index buffers.
    pub index_logic_op: bool,
    /// Clear values and masks.
    pub color_buffer: ColorBuffer,
    /// Pixel transfer and maps.
    pub pixel: PixelTransfer,
    /// Zoom, read buffer.
    pub pixel_mode: PixelMode,
    /// Evaluators.
    pub eval: Eval,
    /// Hints by token: perspective correction, point smooth, line smooth, polygon smooth, fog,
    /// generate mipmap, texture compression.
    pub hints: [(u32, u32); 7],
    /// `LIST_BASE`.
    pub list_base: u32,
    /// `RASTER_POSITION_UNCLIPPED_IBM`.
    pub raster_position_unclipped: bool,
    /// `FRAMEBUFFER_SRGB`.
    pub framebuffer_srgb: bool,
    /// `DEBUG_OUTPUT`, `DEBUG_OUTPUT_SYNCHRONOUS`.
    pub debug_output: (bool, bool),
}

impl Default for State {
    fn default() -> Self {
        let hint = |target| (target, enums::DONT_CARE);
        Self {
            current: Current::default(),
            raster_position: RasterPosition::default(),
            matrices: Matrices::default(),
            viewport: Viewport::default(),
            clip_planes: [[0.0; 4]; MAX_CLIP_PLANES],
            clip_plane_enabled: [false; MAX_CLIP_PLANES],
            lighting: Lighting::default(),
            fog: Fog::default(),
            color_sum: false,
            points: Points::default(),
            lines: Lines::default(),
            polygons: Polygons::default(),
            multisample: true,
            sample_alpha_to_coverage: false,
            sample_alpha_to_one: false,
            sample_coverage: false,
            sample_coverage_value: (1.0, false),
            depth_clamp: false,
            cube_map_seamless: false,
            clip_control: (enums::LOWER_LEFT, enums::NEGATIVE_ONE_TO_ONE),
            units: std::array::from_fn(|_| TextureUnit::default()),
            active_unit: 0,
            scissor: Scissor::default(),
            alpha_test: (false, enums::ALWAYS, 0.0),
            stencil: StencilState::default(),
            depth: DepthState::default(),
            blend: Blend::default(),
            dither: true,
            logic_op: (false, enums::COPY),
            index_logic_op: false,
            color_buffer: ColorBuffer::default(),
            pixel: PixelTransfer::default(),
            pixel_mode: PixelMode::default(),
            eval: Eval::default(),
            hints: [
                hint(enums::PERSPECTIVE_CORRECTION_HINT),
                hint(enums::POINT_SMOOTH_HINT),
                hint(enums::LINE_SMOOTH_HINT),
                hint(enums::POLYGON_SMOOTH_HINT),
                hint(enums::FOG_HINT),
                hint(enums::GENERATE_MIPMAP_HINT),
                hint(enums::TEXTURE_COMPRESSION_HINT),
            ],
            raster_position_unclipped: false,
            list_base: 0,
            framebuffer_srgb: false,
            debug_output: (false, false),
        }
    }
}
