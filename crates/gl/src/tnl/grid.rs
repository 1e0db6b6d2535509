//! What a batch that is a flat grid is drawn as: a rectangle, and the grid of vertices that colours
//! it.

use super::piece::Piece;

/// A batch that is a flat grid.
#[derive(Debug)]
pub(crate) struct Grid {
    /// The rectangle: its vertices are those of the corners `(0, 0)`, `(columns, 0)`,
    /// `(columns, rows)`, `(0, rows)`.
    pub rectangle: Piece,
    /// Cells along the two axes.
    pub cells: [u32; 2],
    /// Vertices of the batch, row by row, `columns + 1` a row.
    pub vertices: Vec<u32>,
    /// Cells are cut from `(i, j)` to `(i + 1, j + 1)`, not from `(i + 1, j)` to `(i, j + 1)`.
    pub rising: bool,
}

impl Grid {
    /// Where the rectangle's corner `k` lies, in cells.
    pub(crate) fn corner(&self, k: u32) -> [f32; 2] {
        let [columns, rows] = self.cells.map(|c| c as f32);
        [if matches!(k, 1 | 2) { columns } else { 0.0 }, if k >= 2 { rows } else { 0.0 }]
    }
}
