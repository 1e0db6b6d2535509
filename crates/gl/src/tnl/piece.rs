//! Pieces: the unit of work of a draw, about a thousand triangles with the vertices they use.

use std::borrow::Cow;
use std::ops::Range;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Level, Simd, dispatch};

/// Triangles of a piece at most.
pub(super) const PIECE_TRIANGLES: usize = 1024;

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
    /// The vertices that `numbers` gives, in any order and more than once. Everything between the
    /// lowest and the highest is taken if that is no more than `most` vertices.
    pub(super) fn from_numbers<I: Iterator<Item = u32>>(
        numbers: impl Fn() -> I,
        most: usize,
    ) -> Self {
        let (low, high) =
            numbers().fold((u32::MAX, 0), |(low, high), v| (low.min(v), high.max(v + 1)));
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

    /// How many of its vertices from `start` on come before `vertex` in the batch, up to the first
    /// that does not.
    pub(crate) fn below(&self, start: usize, vertex: u32) -> usize {
        match self {
            Self::Range(first, end) => (vertex.min(*end) - first) as usize - start,
            Self::List(list) => list[start..].iter().take_while(|v| **v < vertex).count(),
        }
    }

    /// How many vertices the piece uses.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Range(start, end) => (end - start) as usize,
            Self::List(list) => list.len(),
        }
    }
}

/// The corners of triangles that share no vertices, as numbers into the piece.
static UNSHARED: [[u32; 3]; PIECE_TRIANGLES] = {
    let (mut corners, mut i) = ([[0; 3]; PIECE_TRIANGLES], 0);
    while i < PIECE_TRIANGLES {
        let first = 3 * i as u32;
        corners[i] = [first, first + 1, first + 2];
        i += 1;
    }
    corners
};

impl Piece {
    /// The piece of triangles with three vertices of their own each, one triangle's after the
    /// other's.
    pub(super) fn unshared(level: Level, vertices: Range<u32>, positions: &[[f32; 4]]) -> Self {
        let bounds = bounds(level, &positions[vertices.start as usize..vertices.end as usize]);
        let triangles = Cow::Borrowed(&UNSHARED[..vertices.len() / 3]);
        Self { triangles, vertices: PieceVertices::Range(vertices.start, vertices.end), bounds }
    }

    /// The piece of triangles given as numbers of vertices of the batch.
    pub(super) fn new(level: Level, mut triangles: Vec<[u32; 3]>, positions: &[[f32; 4]]) -> Self {
        let vertices = PieceVertices::from_numbers(
            || triangles.iter().flatten().copied(),
            4 * triangles.len() + 64,
        );
        triangles.iter_mut().flatten().for_each(|corner| *corner = vertices.number(*corner));
        let bounds = match &vertices {
            // Vertices between that no triangle uses may widen the bounds: they only ever save
            // work.
            PieceVertices::Range(low, high) => {
                bounds(level, &positions[*low as usize..*high as usize])
            }
            PieceVertices::List(list) => {
                bounds(level, &list.iter().map(|&v| positions[v as usize]).collect::<Vec<_>>())
            }
        };
        Self { triangles: triangles.into(), vertices, bounds }
    }

    /// Whether the whole piece lies outside one plane of the view volume, or of the user.
    pub(crate) fn is_outside(
        &self,
        clip_from_model: &[f32; 16],
        planes: &[[f32; 4]],
        near: f32,
    ) -> bool {
        let Some([low, high]) = self.bounds else { return false };
        // Express the planes in model space.
        let m = clip_from_model;
        let row = |r: usize| [m[r], m[4 + r], m[8 + r], m[12 + r]];
        let [x, y, z, w] = [row(0), row(1), row(2), row(3)];
        let sum = |a: [f32; 4], s: f32, b: [f32; 4]| [0, 1, 2, 3].map(|k| a[k] + s * b[k]);
        let sides = [
            sum(w, 1.0, x),
            sum(w, -1.0, x),
            sum(w, 1.0, y),
            sum(w, -1.0, y),
            sum(w, -1.0, z),
            sum(z, -near, w),
        ];

        // Test the corner of the bounds that lies farthest inside each plane, with room for
        // rounding.
        sides.iter().chain(planes).any(|p| {
            let (mut most, mut size) = (p[3], p[3].abs());
            for k in 0..3 {
                most += (p[k] * low[k]).max(p[k] * high[k]);
                size += p[k].abs() * low[k].abs().max(high[k].abs());
            }
            most < size * -1e-5
        })
    }
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
    let (mut low, mut high, mut finite) =
        (splat(f32::INFINITY), splat(f32::NEG_INFINITY), splat(0.0));
    for pair in pairs {
        let v = F32x8::from_slice(simd, pair.as_flattened());
        // 0 x is 0 for finite numbers only.
        finite += v * 0.0;
        (low, high) = (lanes::Lanes::min(v, low), lanes::Lanes::max(v, high));
    }
    [low.to_array(), high.to_array(), finite.to_array()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_keep_their_vertices_together() {
        let p = Piece::new(Level::new(), vec![[7, 8, 9], [9, 8, 10]], &[[0.0; 4]; 11]);
        assert!(matches!(p.vertices, PieceVertices::Range(7, 11)));
        assert_eq!(p.triangles[..], [[0, 1, 2], [2, 1, 3]]);
        let p = Piece::new(Level::new(), vec![[7, 80_000, 9]], &vec![[0.0; 4]; 80_001]);
        assert_eq!((p.vertices.len(), p.vertices.get(2)), (3, 80_000));
    }

    #[test]
    fn bounds_are_of_finite_positions_with_w_1() {
        let positions = [[1.0, -2.0, 3.0, 1.0], [-4.0, 5.0, 0.5, 1.0], [0.0, 0.0, 9.0, 1.0]];
        let level = Level::new();
        assert_eq!(bounds(level, &positions), Some([[-4.0, -2.0, 0.5], [1.0, 5.0, 9.0]]));
        assert_eq!(bounds(level, &positions[..2]), Some([[-4.0, -2.0, 0.5], [1.0, 5.0, 3.0]]));
        for wrong in
            [[f32::NAN, 0.0, 0.0, 1.0], [0.0, f32::INFINITY, 0.0, 1.0], [0.0, 0.0, 0.0, 2.0]]
        {
            assert_eq!(bounds(level, &[positions[0], wrong]), None);
            assert_eq!(bounds(level, &[wrong, positions[0], positions[1]]), None);
        }
        assert_eq!(bounds(level, &[]), None);
    }
}
