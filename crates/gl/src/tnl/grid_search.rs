//! Flat grids: programs tessellate large planes so that lighting by vertex shows, and send them
//! again and again.
//!
//! All triangles of such a grid lie in one plane, and everything but their lit colours is linear on
//! it. So the rasteriser gets the rectangle alone, two triangles instead of tens of thousands, and
//! takes colours from the grid of shaded vertices
//! ([`ColorGrid`](vitral_raster::forward::ColorGrid)): the colour at a point is that of the small
//! triangle it lies in, as if that had been drawn.
//!
//! A batch is a grid if one coordinate of its positions is constant, the other two form evenly
//! spaced rows and columns, each cell is cut into two triangles along the same diagonal, all
//! normals are equal, and texture coordinates are linear.
//!
//! In:   a batch and its triangles. Out: the rectangle and the numbers of its vertices.
//! Cost: linear, once a batch.

use super::grid::Grid;
use super::piece::{Piece, PieceVertices, bounds};
use crate::vertex::VertexBatch;
use vitral_math::lanes::Level;

/// Fewer cells are drawn as they are.
const LEAST_CELLS: usize = 16;

/// The grid that a batch of `count` triangles is, if it is one; `triangles` gives them as numbers
/// of vertices.
pub(super) fn find_grid(
    batch: &VertexBatch,
    count: usize,
    triangles: impl FnOnce() -> Vec<[u32; 3]>,
) -> Option<Grid> {
    if count < 2 * LEAST_CELLS || !is_flat(batch) || !is_plain(batch) {
        return None;
    }

    // Find the rows and columns.
    let triangles = &triangles()[..];
    let lattice = Lattice::new(batch, triangles)?;
    let [columns, rows] = lattice.cells();
    if columns * rows < LEAST_CELLS || columns * rows * 2 > triangles.len() {
        return None;
    }

    // Enter the triangles in the cells. Some programs send a border of triangles without area,
    // which are skipped.
    let mut found = FoundCells::new(
        [columns, rows],
        batch.tex.iter().any(Option::is_some).then_some(triangles.len()),
    );
    for triangle in triangles {
        let nodes =
            [lattice.node(triangle[0])?, lattice.node(triangle[1])?, lattice.node(triangle[2])?];
        if nodes[0] != nodes[1] && nodes[1] != nodes[2] && nodes[2] != nodes[0] {
            found.add(*triangle, nodes)?;
        }
    }
    found.into_grid(batch)
}

/// Evenly spaced rows and columns of vertices in a plane.
struct Lattice<'a> {
    batch: &'a VertexBatch,
    /// The axes of position that columns and rows lie along.
    axes: [usize; 2],
    lines: [Lines; 2],
}

impl<'a> Lattice<'a> {
    /// The lattice of the vertices of some triangles.
    fn new(batch: &'a VertexBatch, triangles: &[[u32; 3]]) -> Option<Self> {
        let axes = axes(batch, triangles)?;
        let lines =
            [Lines::new(batch, triangles, axes[0])?, Lines::new(batch, triangles, axes[1])?];
        Some(Self { batch, axes, lines })
    }

    /// How many cells there are in a row and in a column.
    fn cells(&self) -> [usize; 2] {
        self.lines.map(|lines| lines.count - 1)
    }

    /// The column and row of a vertex.
    fn node(&self, vertex: u32) -> Option<[usize; 2]> {
        let position = self.batch.positions[vertex as usize];
        let [x, y] = self.axes.map(|axis| position[axis]);
        Some([self.lines[0].number(x)?, self.lines[1].number(y)?])
    }
}

/// What the triangles so far have shown of the cells.
struct FoundCells {
    columns: usize,
    rows: usize,
    /// A vertex of each node, row by row.
    vertices: Vec<u32>,
    /// For each cell a bit for each corner that one of its triangles leaves out.
    missing: Vec<u8>,
    /// The nodes of all corners of triangles, if there are texture coordinates.
    corners: Option<Vec<(u32, [usize; 2])>>,
    /// How triangles that leave out a corner of their cell name the others.
    turns: [Option<Turn>; 4],
}

impl FoundCells {
    /// No triangles yet; `textured` is how many will come, if there are texture coordinates.
    fn new([columns, rows]: [usize; 2], textured: Option<usize>) -> Self {
        Self {
            columns,
            rows,
            vertices: vec![u32::MAX; (columns + 1) * (rows + 1)],
            missing: vec![0; columns * rows],
            corners: textured.map(|triangles| Vec::with_capacity(3 * triangles)),
            turns: [None; 4],
        }
    }

    /// Adds a triangle with an area, given the nodes of its corners. `None` if it does not fit a
    /// grid.
    #[inline]
    fn add(&mut self, triangle: [u32; 3], nodes: [[usize; 2]; 3]) -> Option<()> {
        // Note the vertices.
        for k in 0..3 {
            self.vertices[nodes[k][1] * (self.columns + 1) + nodes[k][0]] = triangle[k];
            if let Some(corners) = &mut self.corners {
                corners.push((triangle[k], nodes[k]));
            }
        }

        // Each half of a cell comes once, and names its corners as in other cells.
        let (cell, turn) = turn(nodes)?;
        let missing = &mut self.missing[cell[1] * self.columns + cell[0]];
        let is_first = *missing & 1 << turn.missing == 0;
        *missing |= 1 << turn.missing;
        (is_first && *self.turns[turn.missing].get_or_insert(turn) == turn).then_some(())
    }

    /// The grid, if each cell has both triangles, all are cut along the same diagonal, and texture
    /// coordinates are linear.
    fn into_grid(self, batch: &VertexBatch) -> Option<Grid> {
        // Triangles that leave out corners 0 and 2, or 1 and 3, lie on both sides of one diagonal.
        let pair = self.missing[0];
        let is_whole =
            matches!(pair, 0b0101 | 0b1010) && self.missing.iter().all(|missing| *missing == pair);
        if !is_whole || self.vertices.contains(&u32::MAX) {
            return None;
        }

        // Compare texture coordinates with those of the rectangle's corners.
        let (columns, rows) = (self.columns, self.rows);
        let at = |i: usize, j: usize| self.vertices[j * (columns + 1) + i];
        let corners = vec![at(0, 0), at(columns, 0), at(columns, rows), at(0, rows)];
        if !is_linear(batch, &corners, self.corners.as_deref().unwrap_or(&[]), [columns, rows]) {
            return None;
        }

        // Make the rectangle: its triangles are cut as the cells are.
        let triangles: Vec<[u32; 3]> =
            self.turns.into_iter().flatten().map(|turn| turn.corners).collect();
        let positions: Vec<[f32; 4]> =
            corners.iter().map(|&v| batch.positions[v as usize]).collect();
        let bounds = bounds(Level::new(), &positions);
        let rectangle =
            Piece { triangles: triangles.into(), vertices: PieceVertices::List(corners), bounds };

        // A triangle without corner (1, 0) or (0, 1) has the rising diagonal.
        let (cells, rising) = ([columns as u32, rows as u32], pair == 0b1010);
        Some(Grid { rectangle, cells, vertices: self.vertices, rising })
    }
}

/// One of the two triangles of a cell, its corners numbered round the cell as [`Grid::rectangle`]'s
/// are.
#[derive(Clone, Copy, PartialEq)]
struct Turn {
    corners: [u32; 3],
    /// The corner of the cell that it leaves out.
    missing: usize,
}

/// The cell of a triangle, and which of its halves it is.
fn turn(nodes: [[usize; 2]; 3]) -> Option<([usize; 2], Turn)> {
    let low = |k: usize| nodes[0][k].min(nodes[1][k]).min(nodes[2][k]);
    let cell = [low(0), low(1)];
    let mut corners = [0; 3];
    let mut missing = 6;
    for (corner, node) in corners.iter_mut().zip(nodes) {
        *corner = match [node[0] - cell[0], node[1] - cell[1]] {
            [0, 0] => 0,
            [1, 0] => 1,
            [1, 1] => 2,
            [0, 1] => 3,
            _ => return None,
        };
        missing -= *corner as i32;
    }
    let all_differ =
        corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
    all_differ.then_some((cell, Turn { corners, missing: missing.clamp(0, 3) as usize }))
}

/// Whether one coordinate is the same at all vertices that primitives name. Few batches are, and
/// others show it soon.
fn is_flat(batch: &VertexBatch) -> bool {
    (0..3).any(|axis| {
        let mut named = batch.primitives.iter().flat_map(|p| p.first..p.first + p.count);
        let at = |i: u32| batch.positions[batch.vertex(i)][axis];
        named.next().is_some_and(|first| named.all(|i| at(i) == at(first)))
    })
}

/// Whether only positions, equal normals and texture coordinates vary.
fn is_plain(batch: &VertexBatch) -> bool {
    let same = |normals: &Vec<[f32; 3]>| normals.windows(2).all(|pair| pair[0] == pair[1]);
    batch.colors.is_none()
        && batch.secondary.is_none()
        && batch.fog.is_none()
        && batch.materials.is_empty()
        && batch.modelviews.is_empty()
        && batch.normals.as_ref().is_none_or(same)
}

/// The two axes of position that vary; the third is constant, and all are finite with `w = 1`.
fn axes(batch: &VertexBatch, triangles: &[[u32; 3]]) -> Option<[usize; 2]> {
    let first = batch.positions[triangles[0][0] as usize];
    let mut varies = [false; 3];

    // Find which coordinates vary.
    for &v in triangles.iter().flatten() {
        let p = batch.positions[v as usize];
        if p[3] != 1.0 || !(p[0] + p[1] + p[2]).is_finite() {
            return None;
        }
        for k in 0..3 {
            varies[k] |= p[k] != first[k];
        }
        if varies == [true; 3] {
            return None;
        }
    }

    // Accept exactly two.
    match varies {
        [true, true, false] => Some([0, 1]),
        [true, false, true] => Some([0, 2]),
        [false, true, true] => Some([1, 2]),
        _ => None,
    }
}

/// Evenly spaced values of a coordinate.
#[derive(Clone, Copy)]
struct Lines {
    first: f64,
    step: f64,
    count: usize,
}

impl Lines {
    /// Those of the vertices along an axis. Values that differ by rounding alone are one line.
    fn new(batch: &VertexBatch, triangles: &[[u32; 3]], axis: usize) -> Option<Self> {
        let mut values: Vec<f32> =
            triangles.iter().flatten().map(|&v| batch.positions[v as usize][axis]).collect();
        values.sort_unstable_by(f32::total_cmp);
        let (first, last) = (f64::from(*values.first()?), f64::from(*values.last()?));
        let rounding = (last - first) * 1e-5;
        let count = 1 + values
            .windows(2)
            .filter(|pair| f64::from(pair[1]) - f64::from(pair[0]) > rounding)
            .count();
        (count > 1).then_some(Self { first, step: (last - first) / (count - 1) as f64, count })
    }

    /// The number of the line that a value lies on.
    fn number(&self, value: f32) -> Option<usize> {
        let exact = (f64::from(value) - self.first) / self.step;
        let number = (exact + 0.5).floor();
        ((exact - number).abs() < 1e-3).then_some((number as usize).min(self.count - 1))
    }
}

/// Whether the texture coordinates of vertices at given nodes are linear; `corners` are the
/// rectangle's.
fn is_linear(
    batch: &VertexBatch,
    corners: &[u32],
    nodes: &[(u32, [usize; 2])],
    cells: [usize; 2],
) -> bool {
    batch.tex.iter().flatten().all(|tex| {
        let [a, b, d] = [corners[0], corners[1], corners[3]].map(|v| tex[v as usize]);
        (0..4).all(|k| {
            let size = a[k].abs().max(b[k].abs()).max(d[k].abs());
            nodes.iter().all(|&(v, node)| {
                let [x, y] = [0, 1].map(|axis: usize| node[axis] as f32 / cells[axis] as f32);
                let expected = a[k] + (b[k] - a[k]) * x + (d[k] - a[k]) * y;
                (tex[v as usize][k] - expected).abs() <= size * 2e-6
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::enums::QUADS;
    use crate::primitive::Primitive;

    /// A grid of quads as programs send them, `v0 v1 v2 v3` counter-clockwise.
    fn plane(columns: u32, rows: u32) -> VertexBatch {
        let mut batch = VertexBatch::default();
        let mut tex = Vec::new();
        for j in 0..rows {
            for i in 0..columns {
                for [di, dj] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
                    let (x, y) = ((i + di) as f32 * 0.5 - 1.0, (j + dj) as f32 * 0.25);
                    batch.positions.push([x, y, 3.0, 1.0]);
                    tex.push([2.0 * x + y, 1.0 - y, 0.0, 1.0]);
                }
            }
        }
        batch.normals = Some(vec![[0.0, 0.0, 1.0]; batch.positions.len()]);
        batch.tex[0] = Some(tex);
        batch.primitives.push(Primitive { mode: QUADS, first: 0, count: 4 * columns * rows });
        batch
    }

    fn found(batch: &VertexBatch) -> Option<Grid> {
        let n = batch.positions.len() as u32;
        let halves = |q: u32| [[4 * q, 4 * q + 1, 4 * q + 3], [4 * q + 1, 4 * q + 2, 4 * q + 3]];
        find_grid(batch, n as usize / 2, || (0..n / 4).flat_map(halves).collect())
    }

    #[test]
    fn a_plane_of_quads_is_a_grid() {
        let batch = plane(5, 4);
        let grid = found(&batch).unwrap();
        assert_eq!((grid.cells, grid.vertices.len(), grid.rising), ([5, 4], 30, false));
        let mut triangles = grid.rectangle.triangles.to_vec();
        triangles.sort_unstable();
        assert_eq!(triangles, [[0, 1, 3], [1, 2, 3]]);
        let positions =
            [0, 1, 2, 3].map(|k| batch.positions[grid.rectangle.vertices.get(k) as usize]);
        assert_eq!(
            positions.map(|p| [p[0], p[1]]),
            [[-1.0, 0.0], [1.5, 0.0], [1.5, 1.0], [-1.0, 1.0]]
        );
        assert_eq!(
            [0, 1, 2, 3].map(|k| grid.corner(k)),
            [[0.0, 0.0], [5.0, 0.0], [5.0, 4.0], [0.0, 4.0]]
        );
    }

    #[test]
    fn what_is_not_flat_even_or_linear_is_no_grid() {
        assert!(found(&plane(3, 3)).is_none(), "too few cells");
        let changes: [fn(&mut VertexBatch); 6] = [
            |b| b.positions[7][2] += 0.1,
            |b| b.positions.iter_mut().for_each(|p| p[0] = p[0] * p[0] * p[0]),
            |b| b.tex[0].as_mut().unwrap()[9][0] += 0.01,
            |b| b.normals.as_mut().unwrap()[3] = [0.0, 1.0, 0.0],
            |b| b.colors = Some(vec![[1.0; 4]; b.positions.len()]),
            |b| b.positions.copy_within(0..4, 4),
        ];
        for (i, change) in changes.into_iter().enumerate() {
            let mut batch = plane(6, 6);
            change(&mut batch);
            assert!(found(&batch).is_none(), "change {i}");
        }
    }
}
