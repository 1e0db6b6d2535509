//! The tables of the scan-line algorithm, as an onlooker is told them.

use serde::Serialize;

/// An entry of the polygon table: a convex polygon on the screen, of a face that is flat. A face
/// that is not flat, or not convex, has several.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TablePolygon {
    /// The first of its facets.
    pub facet: u32,
    /// The face of the file that it is of.
    pub surface: u32,
    /// Its plane: change of depth for a pixel to the right, for a pixel down, and depth at the
    /// picture's top left, which may be far outside of it.
    pub plane: [f64; 3],
}

/// A bucket of the edge table: the edges that begin on one line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bucket {
    /// Row of pixels of the line.
    pub row: u32,
    /// Which sample of the pixels.
    pub sample: u32,
    /// The edges, in the order of the polygon table.
    pub edges: Vec<TableEdge>,
}

/// An entry of the edge table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TableEdge {
    /// Index into the polygon table.
    pub polygon: u32,
    /// The first of the polygon's facets.
    pub facet: u32,
    /// From this corner of the polygon on the screen to the next.
    pub edge: u32,
    /// Where it crosses the bucket's line, in pixels from the left.
    pub x: f64,
    /// What is added to `x` for a pixel down.
    pub dx: f64,
    /// Row and sample of the last line that it crosses in the band.
    pub last: [u32; 2],
}

/// An entry of the active edge table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Crossing {
    /// Where the edge crosses the line, in pixels from the left.
    pub x: f64,
    /// Index into the polygon table.
    pub polygon: u32,
    /// The first facet of the polygon, whose in-out flag turns there.
    pub facet: u32,
    /// From this corner of the polygon on the screen to the next.
    pub edge: u32,
}
