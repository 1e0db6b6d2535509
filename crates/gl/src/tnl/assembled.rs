//! What a batch draws when polygons are filled: triangles in pieces, found once and kept with the batch.

use super::grid::{self, Grid};
use crate::enums::{POLYGON, QUAD_STRIP, QUADS, TRIANGLE_FAN, TRIANGLE_STRIP, TRIANGLES};
use crate::vertex::{Primitive, VertexBatch};
use std::sync::{Arc, OnceLock};

/// Triangles of a piece.
const PIECE: usize = 1024;

/// A run of triangles and the vertices they use.
#[derive(Debug)]
pub(crate) struct Piece {
    /// Corners as numbers into `vertices`; the last one provokes.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices of the batch.
    pub vertices: PieceVertices,
    /// Smallest and largest coordinates, if all positions have `w = 1`.
    pub bounds: Option<[[f32; 3]; 2]>,
}

/// Which vertices a piece uses.
#[derive(Debug)]
pub(crate) enum PieceVertices {
    /// `start..end`.
    Range(u32, u32),
    /// Any.
    List(Vec<u32>),
}

impl PieceVertices {
    /// The vertex with number `i` of the piece.
    #[inline(always)]
    pub(crate) fn get(&self, i: u32) -> u32 {
        match self {
            Self::Range(start, _) => start + i,
            Self::List(list) => list[i as usize],
        }
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Range(start, end) => (end - start) as usize,
            Self::List(list) => list.len(),
        }
    }
}

/// All triangles of a batch.
#[derive(Debug)]
pub(crate) struct Assembled {
    pub pieces: Vec<Piece>,
    /// There are points or lines too.
    pub others: bool,
    /// All triangles are a flat grid.
    pub grid: Option<Grid>,
}

/// A place for `Assembled` in a batch: no part of its value.
#[derive(Default)]
pub struct AssembledCell(OnceLock<Arc<Assembled>>);

impl AssembledCell {
    pub(crate) fn get(&self, batch: &VertexBatch) -> Arc<Assembled> {
        self.0.get_or_init(|| Arc::new(Assembled::new(batch))).clone()
    }
}

impl std::fmt::Debug for AssembledCell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("AssembledCell")
    }
}

impl Clone for AssembledCell {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for AssembledCell {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Assembled {
    fn new(batch: &VertexBatch) -> Self {
        let mut triangles = Vec::new();
        let mut others = false;
        for primitive in &batch.primitives {
            others |= primitive.mode < TRIANGLES;
            add_triangles(primitive, &mut triangles);
        }
        for corner in triangles.iter_mut().flatten() {
            *corner = batch.vertex(*corner) as u32;
        }
        let pieces = triangles.chunks(PIECE).map(|t| piece(t, &batch.positions)).collect();
        let grid = if others { None } else { grid::find(batch, &triangles) };
        Self { pieces, others, grid }
    }
}

/// Triangles of a primitive as index numbers, provoking corner last.
fn add_triangles(p: &Primitive, out: &mut Vec<[u32; 3]>) {
    let (first, n) = (p.first, p.count);
    match p.mode {
        TRIANGLES => out.extend((0..n / 3).map(|i| [0, 1, 2].map(|k| first + 3 * i + k))),
        TRIANGLE_STRIP => out.extend((2..n).map(|i| {
            let v = first + i;
            if i % 2 == 0 { [v - 2, v - 1, v] } else { [v - 1, v - 2, v] }
        })),
        TRIANGLE_FAN => out.extend((2..n).map(|i| [first, first + i - 1, first + i])),
        // The first vertex of a polygon provokes.
        POLYGON => out.extend((2..n).map(|i| [first + i - 1, first + i, first])),
        QUADS => out.extend((0..n / 4).flat_map(|i| {
            let v = first + 4 * i;
            [[v, v + 1, v + 3], [v + 1, v + 2, v + 3]]
        })),
        QUAD_STRIP => out.extend((0..n.saturating_sub(2) / 2).flat_map(|i| {
            let v = first + 2 * i;
            [[v, v + 1, v + 3], [v + 2, v, v + 3]]
        })),
        _ => {}
    }
}

fn piece(triangles: &[[u32; 3]], positions: &[[f32; 4]]) -> Piece {
    let (mut low, mut high) = (u32::MAX, 0);
    for &v in triangles.iter().flatten() {
        (low, high) = (low.min(v), high.max(v + 1));
    }
    let low = low.min(high);
    if (high - low) as usize <= 4 * triangles.len() + 64 {
        // Vertices between that no triangle uses may widen the bounds: they only ever save work.
        let bounds = bounds(positions[low as usize..high as usize].iter().copied());
        let triangles = triangles.iter().map(|t| t.map(|v| v - low)).collect();
        return Piece { triangles, vertices: PieceVertices::Range(low, high), bounds };
    }
    let mut list: Vec<u32> = triangles.iter().flatten().copied().collect();
    list.sort_unstable();
    list.dedup();
    let number = |v: u32| list.binary_search(&v).unwrap_or(0) as u32;
    let triangles = triangles.iter().map(|t| t.map(number)).collect();
    let bounds = bounds(list.iter().map(|&v| positions[v as usize]));
    Piece { triangles, vertices: PieceVertices::List(list), bounds }
}

pub(super) fn bounds(positions: impl Iterator<Item = [f32; 4]>) -> Option<[[f32; 3]; 2]> {
    let (mut low, mut high, mut regular) = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4], true);
    for p in positions {
        regular &= p[3] == 1.0 && (p[0] + p[1] + p[2]).is_finite();
        for k in 0..4 {
            low[k] = if p[k] < low[k] { p[k] } else { low[k] };
            high[k] = if p[k] > high[k] { p[k] } else { high[k] };
        }
    }
    let three = |v: [f32; 4]| [v[0], v[1], v[2]];
    regular.then_some([three(low), three(high)])
}

impl Piece {
    /// Whether the whole piece lies outside one plane of the view volume, or of `planes` (model space).
    pub(crate) fn is_outside(&self, m: &[f32; 16], near: f32, planes: &[[f32; 4]]) -> bool {
        let Some([low, high]) = self.bounds else { return false };
        let row = |r: usize| [m[r], m[4 + r], m[8 + r], m[12 + r]];
        let [x, y, z, w] = [row(0), row(1), row(2), row(3)];
        let sum = |a: [f32; 4], s: f32, b: [f32; 4]| [0, 1, 2, 3].map(|k| a[k] + s * b[k]);
        let sides =
            [sum(w, 1.0, x), sum(w, -1.0, x), sum(w, 1.0, y), sum(w, -1.0, y), sum(w, -1.0, z), sum(z, -near, w)];
        sides.iter().chain(planes).any(|p| {
            // The corner that is farthest inside, with room for rounding.
            let (mut most, mut size) = (p[3], p[3].abs());
            for k in 0..3 {
                most += (p[k] * low[k]).max(p[k] * high[k]);
                size += p[k].abs() * low[k].abs().max(high[k].abs());
            }
            most < size * -1e-5
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(mode: u32, count: u32) -> Vec<[u32; 3]> {
        let mut out = Vec::new();
        add_triangles(&Primitive { mode, first: 0, count }, &mut out);
        out
    }

    #[test]
    fn the_provoking_vertex_is_last() {
        assert_eq!(triangles(QUADS, 4), [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(triangles(QUAD_STRIP, 6), [[0, 1, 3], [2, 0, 3], [2, 3, 5], [4, 2, 5]]);
        assert_eq!(triangles(TRIANGLE_STRIP, 4), [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(triangles(TRIANGLE_FAN, 4), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(triangles(POLYGON, 4), [[1, 2, 0], [2, 3, 0]]);
    }

    #[test]
    fn pieces_keep_their_vertices_together() {
        let p = piece(&[[7, 8, 9], [9, 8, 10]], &[[0.0; 4]; 11]);
        assert!(matches!(p.vertices, PieceVertices::Range(7, 11)));
        assert_eq!(p.triangles, [[0, 1, 2], [2, 1, 3]]);
        let p = piece(&[[7, 80_000, 9]], &vec![[0.0; 4]; 80_001]);
        assert_eq!((p.vertices.len(), p.vertices.get(2)), (3, 80_000));
    }
}
