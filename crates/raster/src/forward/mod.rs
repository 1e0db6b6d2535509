//! Forward rendering: fragments with OpenGL's per-fragment state, straight into colour, depth and
//! stencil planes.
//!
//! A [`Pass`] is a list of recorded commands on one [`Target`]: draws, clears, images. Running it
//! turns geometry into setups and tile lists in parallel, then each tile walks the commands in
//! their order. Planes are stored tile by tile and cleared lazily. Row 0 of a plane is OpenGL's
//! window row 0: the lowest.

mod assemble;
mod block;
mod boxes;
mod color_grid;
mod depth_ranges;
mod environment;
mod fragment;
mod fragment_ops;
mod hard_line;
mod pass;
mod pending;
mod plan;
mod plane;
mod project;
mod repeated_textures;
mod sample;
mod shade;
mod soft;
mod spare;
mod state;
mod strips;
mod surface;
mod texture;
mod tile;
mod tile_index;
mod tiny_eight;
mod wide;

pub use assemble::{
    Assembler, Facet, FacetKind, NO_GRID, PrimitiveState, Primitives, Shape, Vertices,
    flag_user_planes,
};
pub use color_grid::{ColorGrid, GridColors};
pub use pass::{
    Clear, Command, ForwardScreen, Geometry, ImageColors, ImageFragments, Pass, Runner, Target,
};
pub use plane::{ColorPlane, DepthBuffer, Plane, PlaneTile, Resolve, StencilPlane};
pub use project::{WindowTransform, project};
pub use shade::Layout;
pub use state::{
    AlphaTest, Blend, BlendEquation, BlendFactor, Clamping, Combine, CombineFunction,
    CombineOperand, CombineSource, Compare, DepthTest, EnvironmentMode, Fog, FogMode,
    FragmentState, LogicOp, SampleCoverage, Stencil, StencilFace, StencilOp, Unit,
};
pub use texture::{
    BaseFormat, Filter, Level, Sampler, Swizzle, Texels, Texture, TextureKind, Wrap,
};
