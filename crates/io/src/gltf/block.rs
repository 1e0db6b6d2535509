//! Vertices that some primitives of a mesh share.

use super::geometry::Attributes;
use std::ops::Range;

/// Vertices that some primitives share.
pub(crate) struct Block {
    pub(crate) attributes: Attributes,
    /// The vertices that are used, of those in the accessors.
    pub(crate) range: Range<usize>,
    /// Number of the first one in the mesh.
    pub(crate) base: u32,
    /// JSON path of the first primitive that uses it.
    pub(crate) path: String,
    /// Whether it has triangles, so that normals matter.
    pub(crate) has_surface: bool,
}
