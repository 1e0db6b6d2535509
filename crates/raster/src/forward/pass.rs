//! Recorded commands on one target, and how they run.

use super::plane::{ColorPlane, DepthPlane, StencilPlane};
use super::state::FragmentState;
use crate::Viewport;
use std::sync::{Arc, Mutex};

/// Where fragments go. All planes have the same size and number of samples.
#[derive(Clone, Debug)]
pub struct Target {
    /// Size in pixels.
    pub viewport: Viewport,
    /// Samples a pixel: 1 or 4.
    pub samples: usize,
    /// Colour; without one colours are dropped.
    pub color: Option<Arc<Mutex<ColorPlane>>>,
    /// Depth; without one the depth test passes.
    pub depth: Option<Arc<Mutex<DepthPlane>>>,
    /// Stencil; without one the stencil test passes.
    pub stencil: Option<Arc<Mutex<StencilPlane>>>,
}

/// A clear.
#[derive(Clone, Copy, Debug)]
pub struct Clear {
    /// Colour, and which components are masked.
    pub color: Option<([f32; 4], [bool; 4])>,
    /// Depth, 0..=1.
    pub depth: Option<f32>,
    /// Stencil value and write mask.
    pub stencil: Option<(u8, u8)>,
    /// Pixels x0, y0, x1, y1, the last two exclusive.
    pub clip: [i32; 4],
}

/// Fragments of a pixel rectangle or bitmap. The fragment of source pixel `(i, j)` covers the pixels whose centres lie
/// in `[x + zoom_x * i, x + zoom_x * (i + 1)) x [y + zoom_y * j, ...)`.
#[derive(Clone, Debug)]
pub struct ImageFragments {
    /// Window position of the first pixel's corner.
    pub origin: [f32; 2],
    /// Zoom; may be negative.
    pub zoom: [f32; 2],
    /// Source size.
    pub size: [u32; 2],
    /// Window depth of all fragments that bring none, 0..=1.
    pub z: f32,
    /// Colours for each source pixel.
    pub colors: Option<Vec<[f32; 4]>>,
    /// Depths for each source pixel, 0..=1.
    pub depths: Option<Vec<f32>>,
    /// Stencil values for each source pixel: written through the stencil mask and nothing else.
    pub stencils: Option<Vec<u8>>,
    /// For bitmaps: which source pixels make a fragment.
    pub bits: Option<Vec<bool>>,
    /// Colour where there are no `colors`.
    pub color: [f32; 4],
    /// Secondary colour.
    pub secondary: [f32; 3],
    /// Texture coordinates of each unit.
    pub tex: [[f32; 4]; 8],
    /// Fog coordinate.
    pub fog: f32,
    /// Stencil mask for `stencils`.
    pub stencil_mask: u8,
}

/// Turns vertices into primitives, in parallel pieces.
pub trait Geometry: Send + Sync + std::fmt::Debug {
    /// How many pieces there are.
    fn pieces(&self) -> usize;
}

/// A recorded command.
#[derive(Clone, Debug)]
pub enum Command {
    /// Clears.
    Clear(Clear),
    /// A pixel rectangle or bitmap.
    Image(Arc<ImageFragments>, Arc<FragmentState>),
    /// Points, lines, triangles.
    Draw(Arc<dyn Geometry>, Arc<FragmentState>),
}

/// Commands on one target.
#[derive(Debug)]
pub struct Pass {
    /// Where they draw.
    pub target: Target,
    /// In order.
    pub commands: Vec<Command>,
}
