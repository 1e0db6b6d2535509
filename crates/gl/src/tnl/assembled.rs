//! What a batch draws when polygons are filled: triangles in pieces, each found once, when it is drawn, and kept with the batch.

use super::grid::{self, Grid};
use super::ordered;
use super::snapshot::Transform;
use crate::enums::{POINTS, POLYGON, QUAD_STRIP, QUADS, TRIANGLE_FAN, TRIANGLE_STRIP, TRIANGLES};
use crate::vertex::{Primitive, VertexBatch};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::{Arc, OnceLock};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Level, Simd, dispatch};

/// Triangles of a piece.
const PIECE: usize = 1024;

/// A run of triangles and the vertices they use.
#[derive(Debug)]
pub(crate) struct Piece {
    /// Corners as numbers into `vertices`; the last one provokes.
    pub triangles: Cow<'static, [[u32; 3]]>,
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
    /// Those that `numbers` gives, in any order and more than once: all from the lowest to the highest if these are no more than
    /// `most`.
    pub(super) fn of<I: Iterator<Item = u32>>(numbers: impl Fn() -> I, most: usize) -> Self {
        let (low, high) = numbers().fold((u32::MAX, 0), |(low, high), v| (low.min(v), high.max(v + 1)));
        let low = low.min(high);
        if (high - low) as usize <= most {
            return Self::Range(low, high);
        }
        let mut list: Vec<u32> = numbers().collect();
        list.sort_unstable();
        list.dedup();
        Self::List(list)
    }

    /// The number in the piece of a vertex of the batch.
    #[inline(always)]
    pub(super) fn number(&self, vertex: u32) -> u32 {
        match self {
            Self::Range(start, _) => vertex - start,
            Self::List(list) => list.binary_search(&vertex).unwrap_or(0) as u32,
        }
    }

    /// The vertex with number `i` of the piece.
    #[inline(always)]
    pub(crate) fn get(&self, i: u32) -> u32 {
        match self {
            Self::Range(start, _) => start + i,
            Self::List(list) => list[i as usize],
        }
    }

    /// How many of its vertices from `start` on come before `vertex` in the batch, up to the first that does not.
    pub(crate) fn below(&self, start: usize, vertex: u32) -> usize {
        match self {
            Self::Range(first, end) => (vertex.min(*end) - first) as usize - start,
            Self::List(list) => list[start..].iter().take_while(|v| **v < vertex).count(),
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
    /// Made by who first draws them, which may be any thread.
    pieces: Vec<OnceLock<Piece>>,
    /// For each primitive, how many triangles those before it have; then how many there are.
    starts: Vec<u32>,
    /// There are points or lines too.
    pub others: bool,
    /// There are points.
    pub points: bool,
    /// All triangles are a flat grid.
    pub grid: Option<Grid>,
    /// See [`Self::ordered`]: without a stipple, with one.
    ordered: [OnceLock<Vec<Vec<Primitive>>>; 2],
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
        let mut starts = vec![0];
        let mut count = 0;
        for primitive in &batch.primitives {
            count += triangle_count(primitive);
            starts.push(count);
        }
        let others = batch.primitives.iter().any(|primitive| primitive.mode < TRIANGLES);
        let points = batch.primitives.iter().any(|primitive| primitive.mode == POINTS);
        let mut assembled =
            Self { points, pieces: Vec::new(), starts, others, grid: None, ordered: Default::default() };
        if !others {
            assembled.grid = grid::find(batch, count as usize, || assembled.triangles(batch, 0..count));
        }
        assembled.pieces.resize_with((count as usize).div_ceil(PIECE), OnceLock::new);
        assembled
    }

    /// All primitives in parts, for what is not only filled triangles; whether a stipple runs along lines.
    pub(crate) fn ordered(&self, batch: &VertexBatch, stippled: bool) -> &[Vec<Primitive>] {
        self.ordered[usize::from(stippled)].get_or_init(|| ordered::parts(&batch.primitives, stippled))
    }

    /// How many pieces there are.
    pub(crate) fn len(&self) -> usize {
        self.pieces.len()
    }

    /// The triangles of a piece, by their numbers.
    fn range(&self, piece: usize) -> Range<u32> {
        let count = self.starts.last().copied().unwrap_or(0);
        let first = (piece * PIECE) as u32;
        first..count.min(first + PIECE as u32)
    }

    /// How many triangles piece number `piece` has.
    pub(crate) fn weight(&self, piece: usize) -> usize {
        self.range(piece).len()
    }

    /// Piece number `piece` of the batch that this was made of.
    pub(crate) fn piece(&self, level: Level, batch: &VertexBatch, piece: usize) -> &Piece {
        self.pieces[piece].get_or_init(|| match self.apart(batch, self.range(piece)) {
            Some(vertices) => piece_apart(level, vertices, &batch.positions),
            None => make_piece(level, self.triangles(batch, self.range(piece)), &batch.positions),
        })
    }

    /// The vertices of some triangles, if each has three of its own, one triangle's after the other's.
    fn apart(&self, batch: &VertexBatch, range: Range<u32>) -> Option<Range<u32>> {
        if batch.indices.is_some() {
            return None;
        }
        let at = self.starts.partition_point(|start| *start <= range.start).checked_sub(1)?;
        let (primitive, start) = (batch.primitives.get(at)?, self.starts[at]);
        let alone = primitive.mode == TRIANGLES && range.end <= start + triangle_count(primitive);
        alone.then(|| primitive.first + 3 * (range.start - start)..primitive.first + 3 * (range.end - start))
    }

    /// The triangles of a piece with its quads cut along the other diagonal, from the first corner to the third; `None` if
    /// that is nothing new. Of a batch without indices. Unless `all`, quads on which everything is linear stay as
    /// they are, as does one whose halves are in two pieces. The corner that provokes is not in both halves then.
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
            let first = range.start.max(*start);
            let first = first + ((first - start) & 1);
            let end = range.end.min(start + triangle_count(primitive));
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
        let first = self.starts.partition_point(|start| *start <= range.start).saturating_sub(1);
        for (primitive, start) in batch.primitives.iter().zip(&self.starts).skip(first) {
            if *start >= range.end {
                break;
            }
            let end = (range.end - start).min(triangle_count(primitive));
            add_triangles(primitive, range.start.saturating_sub(*start)..end, &mut triangles);
        }
        if let Some(indices) = &batch.indices {
            for corner in triangles.iter_mut().flatten() {
                *corner = indices[*corner as usize];
            }
        }
        triangles
    }
}

/// The filled triangles of one primitive, as numbers of vertices of the batch. With `turned`, quads are cut as
/// [`Assembled::turned`] cuts them; whether all of them.
pub(super) fn add_filled(batch: &VertexBatch, primitive: &Primitive, turned: Option<bool>, out: &mut Vec<[u32; 3]>) {
    let start = out.len();
    add_triangles(primitive, 0..triangle_count(primitive), out);
    if let Some(all) = turned.filter(|_| primitive.mode == QUADS) {
        for (quad, pair) in out[start..].chunks_exact_mut(2).enumerate() {
            if all || is_bent(batch, primitive.first as usize + 4 * quad) {
                turn(pair);
            }
        }
    }
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

/// Whether something is not linear on the quad of four vertices from `first` on: it looks different along each diagonal.
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

/// How many triangles a primitive has; none for points and lines.
fn triangle_count(p: &Primitive) -> u32 {
    match p.mode {
        TRIANGLES => p.count / 3,
        TRIANGLE_STRIP | TRIANGLE_FAN | POLYGON => p.count.saturating_sub(2),
        QUADS => p.count / 4 * 2,
        QUAD_STRIP => p.count.saturating_sub(2) / 2 * 2,
        _ => 0,
    }
}

/// Some triangles of a primitive as index numbers, provoking corner last.
fn add_triangles(p: &Primitive, range: Range<u32>, out: &mut Vec<[u32; 3]>) {
    let first = p.first;
    match p.mode {
        TRIANGLES => out.extend(range.map(|i| [0, 1, 2].map(|k| first + 3 * i + k))),
        TRIANGLE_STRIP => out.extend(range.map(|i| {
            let v = first + i;
            if i % 2 == 0 { [v, v + 1, v + 2] } else { [v + 1, v, v + 2] }
        })),
        TRIANGLE_FAN => out.extend(range.map(|i| [first, first + i + 1, first + i + 2])),
        // The first vertex of a polygon provokes.
        POLYGON => out.extend(range.map(|i| [first + i + 1, first + i + 2, first])),
        QUADS => out.extend(range.map(|i| {
            let v = first + i / 2 * 4;
            if i % 2 == 0 { [v, v + 1, v + 3] } else { [v + 1, v + 2, v + 3] }
        })),
        QUAD_STRIP => out.extend(range.map(|i| {
            let v = first + i / 2 * 2;
            if i % 2 == 0 { [v, v + 1, v + 3] } else { [v + 2, v, v + 3] }
        })),
        _ => {}
    }
}

/// The corners of triangles that have three vertices each.
static APART: [[u32; 3]; PIECE] = {
    let (mut apart, mut i) = ([[0; 3]; PIECE], 0);
    while i < PIECE {
        let first = 3 * i as u32;
        apart[i] = [first, first + 1, first + 2];
        i += 1;
    }
    apart
};

/// A piece of triangles that have three vertices each.
fn piece_apart(level: Level, vertices: Range<u32>, positions: &[[f32; 4]]) -> Piece {
    let bounds = bounds(level, &positions[vertices.start as usize..vertices.end as usize]);
    let triangles = Cow::Borrowed(&APART[..vertices.len() / 3]);
    Piece { triangles, vertices: PieceVertices::Range(vertices.start, vertices.end), bounds }
}

/// A piece of triangles given as numbers of vertices of the batch.
fn make_piece(level: Level, mut triangles: Vec<[u32; 3]>, positions: &[[f32; 4]]) -> Piece {
    let vertices = PieceVertices::of(|| triangles.iter().flatten().copied(), 4 * triangles.len() + 64);
    triangles.iter_mut().flatten().for_each(|corner| *corner = vertices.number(*corner));
    let bounds = match &vertices {
        // Vertices between that no triangle uses may widen the bounds: they only ever save work.
        PieceVertices::Range(low, high) => bounds(level, &positions[*low as usize..*high as usize]),
        PieceVertices::List(list) => bounds(level, &list.iter().map(|&v| positions[v as usize]).collect::<Vec<_>>()),
    };
    Piece { triangles: triangles.into(), vertices, bounds }
}

/// The least and the largest coordinates, if all are finite and all `w` 1.
pub(super) fn bounds(level: Level, positions: &[[f32; 4]]) -> Option<[[f32; 3]; 2]> {
    // Two positions a step; a last one alone counts twice.
    let (pairs, last) = positions.as_chunks::<2>();
    let last = last.first().map(|p| [*p, *p]);
    let [low, high, finite] = dispatch!(level, simd => extremes(simd, pairs.iter().chain(&last)));
    let both = |v: [f32; 8], best: fn(f32, f32) -> f32| [0, 1, 2, 3].map(|k| best(v[k], v[k + 4]));
    let (low, high) = (both(low, f32::min), both(high, f32::max));
    let regular = finite == [0.0; 8] && low[3] == 1.0 && high[3] == 1.0;
    regular.then_some([[low[0], low[1], low[2]], [high[0], high[1], high[2]]])
}

/// The least and the largest numbers of pairs of positions, and 0 where all are finite.
#[inline(always)]
fn extremes<'a, S: Simd>(simd: S, pairs: impl Iterator<Item = &'a [[f32; 4]; 2]>) -> [[f32; 8]; 3] {
    let splat = |v| <F32x8<S> as SimdBase<S>>::splat(simd, v);
    let (mut low, mut high, mut finite) = (splat(f32::INFINITY), splat(f32::NEG_INFINITY), splat(0.0));
    for pair in pairs {
        let v = F32x8::from_slice(simd, pair.as_flattened());
        // 0 x is 0 for finite numbers only.
        finite += v * 0.0;
        (low, high) = (lanes::Lanes::min(v, low), lanes::Lanes::max(v, high));
    }
    [low.to_array(), high.to_array(), finite.to_array()]
}

impl Piece {
    /// Whether the whole piece lies outside one plane of the view volume, or of the user.
    pub(crate) fn is_outside(&self, transform: &Transform, near: f32) -> bool {
        let Some([low, high]) = self.bounds else { return false };
        let (m, planes) = (&transform.clip_from_model, &transform.clip_planes);
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
        let p = Primitive { mode, first: 0, count };
        let mut out = Vec::new();
        add_triangles(&p, 0..triangle_count(&p), &mut out);
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
        let p = make_piece(Level::new(), vec![[7, 8, 9], [9, 8, 10]], &[[0.0; 4]; 11]);
        assert!(matches!(p.vertices, PieceVertices::Range(7, 11)));
        assert_eq!(p.triangles[..], [[0, 1, 2], [2, 1, 3]]);
        let p = make_piece(Level::new(), vec![[7, 80_000, 9]], &vec![[0.0; 4]; 80_001]);
        assert_eq!((p.vertices.len(), p.vertices.get(2)), (3, 80_000));
    }

    #[test]
    fn pieces_are_cut_from_any_primitives() {
        let modes = [(TRIANGLES, 9), (QUADS, 8), (TRIANGLE_STRIP, 3000), (POINTS, 5), (POLYGON, 5), (QUAD_STRIP, 8)];
        let modes = modes.into_iter().chain([(TRIANGLES, 9_000), (QUADS, 4)]);
        let mut primitives = Vec::new();
        let (mut first, mut all) = (0, Vec::new());
        for (mode, count) in modes {
            let primitive = Primitive { mode, first, count };
            add_triangles(&primitive, 0..triangle_count(&primitive), &mut all);
            primitives.push(primitive);
            first += count;
        }
        let batch = VertexBatch { positions: vec![[0.0; 4]; first as usize], primitives, ..VertexBatch::default() };
        let assembled = Assembled::new(&batch);
        assert_eq!((assembled.len(), assembled.others), (all.len().div_ceil(PIECE), true));
        let mut found = Vec::new();
        for i in 0..assembled.len() {
            let piece = assembled.piece(Level::new(), &batch, i);
            assert_eq!(piece.triangles.len(), assembled.weight(i));
            found.extend(piece.triangles.iter().map(|t| t.map(|v| piece.vertices.get(v))));
        }
        assert_eq!(found, all);
        // Triangles 3,014 to 6,013 have vertices of their own: all of pieces 3 and 4.
        let shared = |i: usize| matches!(assembled.piece(Level::new(), &batch, i).triangles, Cow::Borrowed(_));
        assert_eq!((0..assembled.len()).filter(|&i| shared(i)).collect::<Vec<_>>(), [3, 4]);
    }

    #[test]
    fn bounds_are_of_finite_positions_with_w_1() {
        let positions = [[1.0, -2.0, 3.0, 1.0], [-4.0, 5.0, 0.5, 1.0], [0.0, 0.0, 9.0, 1.0]];
        let level = Level::new();
        assert_eq!(bounds(level, &positions), Some([[-4.0, -2.0, 0.5], [1.0, 5.0, 9.0]]));
        assert_eq!(bounds(level, &positions[..2]), Some([[-4.0, -2.0, 0.5], [1.0, 5.0, 3.0]]));
        for wrong in [[f32::NAN, 0.0, 0.0, 1.0], [0.0, f32::INFINITY, 0.0, 1.0], [0.0, 0.0, 0.0, 2.0]] {
            assert_eq!(bounds(level, &[positions[0], wrong]), None);
            assert_eq!(bounds(level, &[wrong, positions[0], positions[1]]), None);
        }
        assert_eq!(bounds(level, &[]), None);
    }
}
