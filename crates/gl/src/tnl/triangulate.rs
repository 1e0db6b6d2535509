//! How the triangles of a batch are found: piece by piece, from primitives, with quads cut along
//! one diagonal or the other.

use super::grid_search::find_grid;
use super::piece::{PIECE_TRIANGLES, Piece};
use super::triangulation::{Triangulation, TriangulationCell};
use crate::enums::{POINTS, QUADS, TRIANGLES};
use crate::primitive::{Primitive, add_triangles, cut_into_parts, triangle_count};
use crate::vertex::VertexBatch;
use std::ops::Range;
use std::sync::{Arc, OnceLock};
use vitral_math::lanes::Level;

impl TriangulationCell {
    /// The triangulation of the batch that the cell belongs to.
    pub(crate) fn get(&self, batch: &VertexBatch) -> Arc<Triangulation> {
        self.get_or_make(|| Triangulation::new(batch))
    }
}

impl Triangulation {
    /// The triangulation of a batch, its pieces yet to be made.
    fn new(batch: &VertexBatch) -> Self {
        let mut starts = vec![0];
        let mut count = 0;
        for primitive in &batch.primitives {
            count += triangle_count(primitive);
            starts.push(count);
        }
        let others = batch.primitives.iter().any(|primitive| primitive.mode < TRIANGLES);
        let points = batch.primitives.iter().any(|primitive| primitive.mode == POINTS);
        let mut all = Self {
            points,
            pieces: Vec::new(),
            starts,
            others,
            grid: None,
            ordered: Default::default(),
        };
        if !others {
            all.grid = find_grid(batch, count as usize, || all.triangles(batch, 0..count));
        }
        all.pieces.resize_with((count as usize).div_ceil(PIECE_TRIANGLES), OnceLock::new);
        all
    }

    /// All primitives in parts, for draws that are not only filled triangles; whether a stipple
    /// runs along lines.
    pub(crate) fn ordered(&self, batch: &VertexBatch, stippled: bool) -> &[Vec<Primitive>] {
        self.ordered[usize::from(stippled)]
            .get_or_init(|| cut_into_parts(&batch.primitives, stippled))
    }

    /// Piece number `piece` of the batch that this was made of.
    pub(crate) fn piece(&self, level: Level, batch: &VertexBatch, piece: usize) -> &Piece {
        self.pieces[piece].get_or_init(|| match self.unshared(batch, self.range(piece)) {
            Some(vertices) => Piece::unshared(level, vertices, &batch.positions),
            None => Piece::new(level, self.triangles(batch, self.range(piece)), &batch.positions),
        })
    }

    /// The vertices of some triangles, if each has three of its own, one triangle's after the
    /// other's.
    fn unshared(&self, batch: &VertexBatch, range: Range<u32>) -> Option<Range<u32>> {
        if batch.indices.is_some() {
            return None;
        }
        let at = self.starts.partition_point(|start| *start <= range.start).checked_sub(1)?;
        let (primitive, start) = (batch.primitives.get(at)?, self.starts[at]);
        let alone = primitive.mode == TRIANGLES && range.end <= start + triangle_count(primitive);
        alone.then(|| {
            primitive.first + 3 * (range.start - start)..primitive.first + 3 * (range.end - start)
        })
    }

    /// The triangles of a piece with its quads cut along the other diagonal, from the first corner
    /// to the third; `None` if no quad changes. The batch has no indices. Unless `all`, quads on
    /// which everything is linear stay as they are. A quad whose halves are in two pieces always
    /// does. The provoking corner is in one half of a turned quad only.
    pub(crate) fn turned(
        &self,
        batch: &VertexBatch,
        piece: usize,
        triangles: &[[u32; 3]],
        all: bool,
    ) -> Option<Vec<[u32; 3]>> {
        let range = self.range(piece);
        let quads = batch.primitives.iter().zip(&self.starts).filter(|(p, _)| p.mode == QUADS);
        let mut turned: Option<Vec<[u32; 3]>> = None;
        for (primitive, start) in quads {
            // Take the quads of the primitive that lie in the piece with both halves.
            let first = range.start.max(*start);
            let first = first + ((first - start) & 1);
            let end = range.end.min(start + triangle_count(primitive));

            // Turn those that look different along the other diagonal.
            for triangle in (first..end.saturating_sub(1)).step_by(2) {
                let vertex = (primitive.first + (triangle - start) * 2) as usize;
                if all || is_bent(batch, vertex) {
                    let at = (triangle - range.start) as usize;
                    turn(&mut turned.get_or_insert_with(|| triangles.to_vec())[at..]);
                }
            }
        }
        turned
    }

    /// Triangles as numbers of vertices.
    fn triangles(&self, batch: &VertexBatch, range: Range<u32>) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(range.len());

        // Collect the triangles of the primitives that reach into the range.
        let first = self.starts.partition_point(|start| *start <= range.start).saturating_sub(1);
        for (primitive, start) in batch.primitives.iter().zip(&self.starts).skip(first) {
            if *start >= range.end {
                break;
            }
            let end = (range.end - start).min(triangle_count(primitive));
            add_triangles(primitive, range.start.saturating_sub(*start)..end, &mut triangles);
        }

        // Replace indices by the vertices that they name.
        if let Some(indices) = &batch.indices {
            for corner in triangles.iter_mut().flatten() {
                *corner = indices[*corner as usize];
            }
        }
        triangles
    }
}

/// The filled triangles of one primitive, as numbers of vertices of the batch. With `turned`, quads
/// are cut as [`Triangulation::turned`] cuts them; `turned` says whether all of them are.
pub(super) fn add_filled(
    batch: &VertexBatch,
    primitive: &Primitive,
    turned: Option<bool>,
    out: &mut Vec<[u32; 3]>,
) {
    let start = out.len();
    add_triangles(primitive, 0..triangle_count(primitive), out);

    // Turn quads that look different along the other diagonal.
    if let Some(all) = turned.filter(|_| primitive.mode == QUADS) {
        for (quad, pair) in out[start..].chunks_exact_mut(2).enumerate() {
            if all || is_bent(batch, primitive.first as usize + 4 * quad) {
                turn(pair);
            }
        }
    }

    // Replace indices by the vertices that they name.
    if let Some(indices) = &batch.indices {
        for corner in out[start..].iter_mut().flatten() {
            *corner = indices[*corner as usize];
        }
    }
}

/// Cuts a quad, its halves the first two triangles, along the other diagonal.
fn turn(halves: &mut [[u32; 3]]) {
    let ([a, b, d], [_, c, _]) = (halves[0], halves[1]);
    (halves[0], halves[1]) = ([a, b, c], [a, c, d]);
}

/// Whether something is not linear on the quad of four vertices from `first` on: it looks different
/// along each diagonal.
fn is_bent(batch: &VertexBatch, first: usize) -> bool {
    fn bent<const N: usize>(values: &[[f32; N]], first: usize) -> bool {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| values[first + k]);
        (0..N).any(|k| {
            let size = a[k].abs().max(b[k].abs()).max(c[k].abs()).max(d[k].abs());
            ((a[k] - b[k]) + (c[k] - d[k])).abs() > 1e-5 * size
        })
    }
    bent(&batch.positions, first)
        || batch.colors.as_ref().is_some_and(|v| bent(v, first))
        || batch.secondary.as_ref().is_some_and(|v| bent(v, first))
        || batch.fog.as_ref().is_some_and(|v| bent(v.as_chunks::<1>().0, first))
        || batch.tex.iter().flatten().any(|v| bent(v, first))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::enums::{POLYGON, QUAD_STRIP, TRIANGLE_STRIP};
    use std::borrow::Cow;

    #[test]
    fn pieces_are_cut_from_any_primitives() {
        let modes = [
            (TRIANGLES, 9),
            (QUADS, 8),
            (TRIANGLE_STRIP, 3000),
            (POINTS, 5),
            (POLYGON, 5),
            (QUAD_STRIP, 8),
        ];
        let modes = modes.into_iter().chain([(TRIANGLES, 9_000), (QUADS, 4)]);
        let mut primitives = Vec::new();
        let (mut first, mut all) = (0, Vec::new());
        for (mode, count) in modes {
            let primitive = Primitive { mode, first, count };
            add_triangles(&primitive, 0..triangle_count(&primitive), &mut all);
            primitives.push(primitive);
            first += count;
        }
        let batch = VertexBatch {
            positions: vec![[0.0; 4]; first as usize],
            primitives,
            ..VertexBatch::default()
        };
        let made = Triangulation::new(&batch);
        assert_eq!((made.len(), made.others), (all.len().div_ceil(PIECE_TRIANGLES), true));
        let mut found = Vec::new();
        for i in 0..made.len() {
            let piece = made.piece(Level::new(), &batch, i);
            assert_eq!(piece.triangles.len(), made.weight(i));
            found.extend(piece.triangles.iter().map(|t| t.map(|v| piece.vertices.get(v))));
        }
        assert_eq!(found, all);
        // Triangles 3,014 to 6,013 have vertices of their own: all of pieces 3 and 4.
        let shared =
            |i: usize| matches!(made.piece(Level::new(), &batch, i).triangles, Cow::Borrowed(_));
        assert_eq!((0..made.len()).filter(|&i| shared(i)).collect::<Vec<_>>(), [3, 4]);
    }
}
