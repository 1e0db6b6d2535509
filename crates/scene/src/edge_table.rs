//! The table of a mesh's edges: who uses each edge, and in which direction.
//!
//! Idea: every face says once for each of its sides "I run from a to b". Under the key (lower
//! vertex, higher vertex) the uses of one edge come together. The uses are dealt into buckets by
//! their lower vertex, then within a bucket placed by the lower vertex (counting sort); the few
//! uses left under one vertex are sorted by the higher one.
//!
//! In:   outlines of faces over welded vertices.
//! Out:  one call for each edge, with its uses; within one bucket in order of (lower, higher
//!       vertex).
//! Cost: `O(sides)` for meshes of bounded valence; never worse than `O(sides log sides)`.
//! Source: the winged-edge literature builds its tables so [Baumgart 1975]; the sort is
//!         distribution counting.

use crate::buckets::{Buckets, Source, shift_and_count};
use crate::{Faces, Mesh};
use std::ops::Range;
use vitral_exec::Workers;

/// Faces beyond this cannot be numbered in a use (one bit holds the direction).
pub(crate) const MAX_FACES: usize = 1 << 31;

/// One side of a face: the number of the face, and whether it runs from the higher to the lower
/// vertex. In order of the higher vertex.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Use(u64);

impl Use {
    /// The side of `face` between a vertex and `higher`; `reversed` if it runs from there.
    pub(crate) fn new(higher: u32, face: u32, reversed: bool) -> Self {
        Self(u64::from(higher) << 32 | u64::from(face << 1 | u32::from(reversed)))
    }

    /// The face (or triangle).
    pub(crate) fn face(self) -> u32 {
        (self.0 as u32) >> 1
    }

    /// Whether the face runs from the higher to the lower vertex.
    pub(crate) fn reversed(self) -> bool {
        self.0 & 1 == 1
    }

    /// The edge's vertex with the higher number.
    pub(crate) fn higher(self) -> u32 {
        (self.0 >> 32) as u32
    }
}

/// Which outlines to take the edges of.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outlines {
    /// Triangles, all of them; a side from a vertex to itself is an edge as well.
    AllTriangles,
    /// Triangles whose three corners lie at three positions.
    SoundTriangles,
    /// The file's faces with at least three different corners in a row; sides from a vertex to
    /// itself left out.
    Faces,
}

struct Sides<'a> {
    mesh: &'a Mesh,
    representative: &'a [u32],
    outlines: Outlines,
    shift: u32,
}

impl Sides<'_> {
    fn put_side(&self, from: u32, to: u32, face: usize, put: &mut impl FnMut(usize, [u32; 3])) {
        let (lower, higher, reversed) = if from <= to { (from, to, 0) } else { (to, from, 1) };
        put((lower >> self.shift) as usize, [lower, higher, (face as u32) << 1 | reversed]);
    }

    fn visit_triangle(&self, t: usize, put: &mut impl FnMut(usize, [u32; 3])) {
        let [a, b, c] = self.mesh.triangles[t].map(|i| self.representative[i as usize]);
        if self.outlines == Outlines::SoundTriangles && is_collapsed([a, b, c]) {
            return;
        }
        self.put_side(a, b, t, put);
        self.put_side(b, c, t, put);
        self.put_side(c, a, t, put);
    }

    fn visit_face(&self, f: usize, put: &mut impl FnMut(usize, [u32; 3])) {
        let corners = self.mesh.face_corners(f);
        let mut from = self.representative[corners[corners.len() - 1] as usize];
        let mut sides = 0;
        for &c in corners {
            let to = self.representative[c as usize];
            sides += usize::from(to != from);
            from = to;
        }
        // A face that has collapsed to a point or to a line there and back has no outline.
        if sides < 3 {
            return;
        }
        for &c in corners {
            let to = self.representative[c as usize];
            if to != from {
                self.put_side(from, to, f, put);
            }
            from = to;
        }
    }
}

impl Source<[u32; 3]> for Sides<'_> {
    fn items(&self) -> usize {
        let polygons =
            self.outlines == Outlines::Faces && matches!(self.mesh.faces, Faces::Polygons { .. });
        if polygons { self.mesh.face_count() } else { self.mesh.triangles.len() }
    }

    fn visit(&self, range: Range<usize>, mut put: impl FnMut(usize, [u32; 3])) {
        if self.outlines == Outlines::Faces {
            range.for_each(|f| self.visit_face(f, &mut put));
        } else {
            range.for_each(|t| self.visit_triangle(t, &mut put));
        }
    }
}

/// Calls `visit(result of the bucket, lower vertex, higher vertex, uses)` for every edge. Uses are
/// in order of faces. The results come in order of the lower vertex.
///
/// A mesh of [`MAX_FACES`] faces or more has no table: the caller must not ask for it.
pub(crate) fn for_each_edge<R: Default + Send>(
    mesh: &Mesh,
    representative: &[u32],
    outlines: Outlines,
    workers: &Workers,
    visit: impl Fn(&mut R, u32, u32, &[Use]) + Sync + Send,
) -> Vec<R> {
    let (shift, count) = shift_and_count(mesh.positions.len());
    let buckets = Buckets::deal(&Sides { mesh, representative, outlines, shift }, count, workers);
    workers.map(buckets.count(), |b| {
        let (starts, mut uses) = by_lower_vertex(&buckets, b, shift);
        let mut result = R::default();
        for (v, range) in starts.windows(2).enumerate() {
            let around = &mut uses[range[0] as usize..range[1] as usize];
            edges_at(around, |higher, edge| {
                visit(&mut result, ((b << shift) + v) as u32, higher, edge)
            });
        }
        result
    })
}

/// Whether a triangle of welded vertices has two corners at one position.
pub(crate) fn is_collapsed([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// Calls `visit(higher vertex, uses)` for every edge among the uses at one lower vertex.
pub(crate) fn edges_at(uses: &mut [Use], mut visit: impl FnMut(u32, &[Use])) {
    uses.sort_unstable_by_key(|u| u.0);
    for edge in uses.chunk_by(|x, y| x.higher() == y.higher()) {
        visit(edge[0].higher(), edge);
    }
}

/// The uses of bucket `b` in order of their lower vertex, and where each vertex begins.
fn by_lower_vertex(buckets: &Buckets<[u32; 3]>, b: usize, shift: u32) -> (Vec<u32>, Vec<Use>) {
    let base = (b << shift) as u32;
    let mut starts = vec![0u32; (1 << shift) + 1];
    for &[lower, ..] in buckets.pieces(b).flatten() {
        starts[(lower - base) as usize + 1] += 1;
    }
    for v in 0..1 << shift {
        starts[v + 1] += starts[v];
    }
    let mut next = starts.clone();
    let mut uses = vec![Use(0); starts[1 << shift] as usize];
    for &[lower, higher, face] in buckets.pieces(b).flatten() {
        let place = &mut next[(lower - base) as usize];
        uses[*place as usize] = Use(u64::from(higher) << 32 | u64::from(face));
        *place += 1;
    }
    (starts, uses)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_have_five_edges_and_one_is_used_twice() {
        let mesh = Mesh {
            positions: vec![[0.0; 3]; 4],
            triangles: vec![[0, 1, 2], [2, 1, 3]],
            ..Mesh::default()
        };
        let identity = [0, 1, 2, 3];
        type Found = (u32, u32, Vec<(u32, bool)>);
        let push = |found: &mut Vec<Found>, a: u32, b: u32, uses: &[Use]| {
            found.push((a, b, uses.iter().map(|u| (u.face(), u.reversed())).collect()));
        };
        let all = for_each_edge(&mesh, &identity, Outlines::AllTriangles, &Workers::single(), push);
        let expected = [
            (0, 1, vec![(0, false)]),
            (0, 2, vec![(0, true)]),
            (1, 2, vec![(0, false), (1, true)]),
            (1, 3, vec![(1, false)]),
            (2, 3, vec![(1, true)]),
        ];
        assert_eq!(all.concat(), expected);
    }
}
