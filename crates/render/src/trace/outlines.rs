//! Polygons with outlines, in the steps of Weiler and Atherton's algorithm. Places are pixels from
//! the top left.

use serde::Serialize;

/// Facets of an outside list that a step names: all of a scene that one looks at step by step, and
/// a bound for large ones, in which each of many clips has a long list.
pub const MAX_LISTED: usize = 1024;

/// A closed outline of a polygon.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contour {
    /// Whether it is the outline of a hole.
    pub is_hole: bool,
    /// Its corners in order, pixels: clockwise on the screen, those of a hole the other way round.
    pub corners: Vec<[f32; 2]>,
}

/// A polygon of the first order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SortedPolygon {
    /// Its first facet.
    pub facet: u32,
    /// Depth of its nearest point, 1 near, 0 far.
    pub nearest: f32,
    /// Its outlines in the picture.
    pub contours: Vec<Contour>,
}

/// A polygon of a list, clipped with another.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CutPolygon {
    /// Its first facet.
    pub facet: u32,
    /// Its outlines before the clip.
    pub before: Vec<Contour>,
    /// What is inside the clipping polygon and not hidden by it: this goes into the inside list.
    pub inside: Vec<Contour>,
    /// What is inside and hidden by the clipping polygon: this is removed.
    pub hidden: Vec<Contour>,
    /// What is outside the clipping polygon: this stays in the list.
    pub outside: Vec<Contour>,
}

impl Contour {
    /// Its edges.
    pub fn edges(&self) -> impl Iterator<Item = [[f32; 2]; 2]> {
        edges(&self.corners)
    }
}

/// The edges of a closed outline.
pub fn edges(corners: &[[f32; 2]]) -> impl Iterator<Item = [[f32; 2]; 2]> {
    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(from, to)| [*from, *to])
}
