//! The data between the steps of filling: parts of triangles, their looks, and regions of the page.

use crate::shapes::Shapes;
use std::cmp::Ordering;

/// How regions of different colours meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Seams {
    /// Each region reaches under those that are painted later, so that no viewer shows the paper
    /// between them.
    #[default]
    Under,
    /// Regions only touch: no place is painted twice.
    None,
}

/// A visible region on the page.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PageRegion {
    /// The lowest surface id of its faces.
    pub(crate) surface: u32,
    pub(crate) material: u32,
    pub(crate) color: [u8; 3],
    pub(crate) opacity: f32,
    /// The lights that do not reach it, a bit each.
    pub(crate) unlit: u32,
    /// Counter-clockwise round the region, clockwise round holes; in units.
    pub(crate) rings: Vec<Vec<[f64; 2]>>,
}

/// A visible part of a triangle.
#[derive(Debug)]
pub(super) struct Part {
    pub(super) triangle: u32,
    pub(super) surface: u32,
    pub(super) look: Look,
    pub(super) shapes: Shapes,
}

/// The visible parts of all triangles, and the triangles that cut them.
#[derive(Default)]
pub(super) struct VisibleParts {
    pub(super) all: Vec<Part>,
    /// A part and a triangle whose outline cuts it.
    pub(super) contacts: Vec<[u32; 2]>,
}

/// The look of a part. The order is that of painting: equal colours after each other, so that
/// nothing of another colour reaches between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    /// 0 for opaque parts; clear layers come over each other in this order.
    pub(super) over: u32,
    pub(super) material: u32,
    pub(super) color: [u8; 3],
    pub(super) opacity: f32,
    /// The lights that do not reach it, a bit each.
    pub(super) unlit: u32,
    /// The surface id, where each face is a region of its own; else 0.
    pub(super) face: u32,
}

impl Look {
    fn key(&self) -> (u32, [u8; 3], u32, [u32; 3]) {
        (self.over, self.color, self.material, [self.opacity.to_bits(), self.unlit, self.face])
    }
}

impl Eq for Look {}

impl Ord for Look {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

impl PartialOrd for Look {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
