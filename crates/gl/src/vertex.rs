//! Vertices on their way to the pipeline.

use crate::state::{MAX_TEXTURE_UNITS, MaterialFace};

/// What a run of vertices is assembled into; `mode` is `POINTS` ... `POLYGON`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Primitive {
    /// `POINTS` ... `POLYGON`.
    pub mode: u32,
    /// First index (or first vertex, without indices).
    pub first: u32,
    /// Indices (or vertices).
    pub count: u32,
}

/// Vertices and what they form. An attribute that is `None` has the current value for all vertices, taken when drawn.
/// Every attribute that is there has one entry a vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VertexBatch {
    /// Model-space positions.
    pub positions: Vec<[f32; 4]>,
    /// Normals.
    pub normals: Option<Vec<[f32; 3]>>,
    /// Colours.
    pub colors: Option<Vec<[f32; 4]>>,
    /// Secondary colours.
    pub secondary: Option<Vec<[f32; 3]>>,
    /// Fog coordinates.
    pub fog: Option<Vec<f32>>,
    /// Texture coordinates of each unit.
    pub tex: [Option<Vec<[f32; 4]>>; MAX_TEXTURE_UNITS],
    /// Edge flags.
    pub edges: Option<Vec<bool>>,
    /// Materials (front, back) set between vertices: they hold from the given vertex on.
    pub materials: Vec<(u32, [MaterialFace; 2])>,
    /// Indices into the attributes; without them vertices are taken in order.
    pub indices: Option<Vec<u32>>,
    /// What is drawn, in order.
    pub primitives: Vec<Primitive>,
}
