//! Triangles by the vertices that they have corners at.
//!
//! Idea: triangles are dealt to buckets of neighbouring vertices, once to each that one of their
//! corners lies in. What is asked of all triangles round a vertex is asked bucket by bucket then,
//! in memory that fits the cache.
//!
//! In:   a mesh of triangles, welded vertices.
//! Out:  for each bucket of vertices the triangles round them, in order.
//! Cost: `O(triangles)`; a mesh in a good order has each triangle in little more than one bucket.
//! Source: [Knuth 1998], section 5.2 (distribution counting).

use crate::Mesh;
use crate::buckets::{Buckets, Source, shift_and_count};
use crate::weld::Weld;
use std::ops::Range;
use vitral_exec::Workers;

/// All triangles, dealt.
pub(crate) struct TriangleBuckets<'a> {
    mesh: &'a Mesh,
    weld: &'a Weld,
    shift: u32,
    dealt: Buckets<u32>,
}

struct Undealt<'a> {
    mesh: &'a Mesh,
    weld: &'a Weld,
    shift: u32,
}

impl Source<u32> for Undealt<'_> {
    fn items(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn visit(&self, range: Range<usize>, mut put: impl FnMut(usize, u32)) {
        for t in range {
            let [a, b, c] =
                self.mesh.triangles[t].map(|v| (self.weld.of(v) >> self.shift) as usize);
            put(a, t as u32);
            if b != a {
                put(b, t as u32);
            }
            if c != a && c != b {
                put(c, t as u32);
            }
        }
    }
}

impl<'a> TriangleBuckets<'a> {
    /// Deals the triangles of `mesh`.
    pub(crate) fn new(mesh: &'a Mesh, weld: &'a Weld, workers: &Workers) -> Self {
        let (shift, count) = shift_and_count(mesh.positions.len());
        Self {
            mesh,
            weld,
            shift,
            dealt: Buckets::deal(&Undealt { mesh, weld, shift }, count, workers),
        }
    }

    /// How many buckets there are.
    pub(crate) fn count(&self) -> usize {
        self.dealt.count()
    }
}

/// The faces round the vertices of a bucket. Vertices are counted from the first one.
#[derive(Default)]
pub(crate) struct Around {
    pub(crate) first_vertex: u32,
    /// How many corners of faces there are at each vertex.
    pub(crate) degrees: Vec<u32>,
    /// The faces, by their number in the mesh, in order.
    pub(crate) faces: Vec<u32>,
    /// If they are triangles, their corners' welded vertices.
    pub(crate) welded: Vec<[u32; 3]>,
}

impl Around {
    /// Makes it that of bucket `b`.
    pub(crate) fn fill(&mut self, all: &TriangleBuckets, b: usize) {
        let first = b << all.shift;
        self.first_vertex = first as u32;
        self.faces.clear();
        all.dealt.pieces(b).for_each(|piece| self.faces.extend_from_slice(piece));
        self.welded.clear();
        let welded = |t: &u32| all.mesh.triangles[*t as usize].map(|v| all.weld.of(v));
        self.welded.extend(self.faces.iter().map(welded));
        self.degrees.clear();
        self.degrees
            .resize((1 << all.shift).min(all.mesh.positions.len().saturating_sub(first)), 0);
        for vertex in self.welded.as_flattened() {
            if let Some(degree) =
                self.degrees.get_mut(vertex.wrapping_sub(self.first_vertex) as usize)
            {
                *degree += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::solids;

    #[test]
    fn each_bucket_has_the_triangles_round_its_vertices_in_order() {
        // Every third triangle is torn off.
        let mut mesh = solids::sphere(1.0, 160, 80);
        for t in (0..mesh.triangles.len()).step_by(3) {
            let torn = mesh.triangles[t].map(|v| mesh.positions[v as usize]);
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(torn);
            mesh.triangles[t] = [first, first + 1, first + 2];
        }
        let weld = Weld::new(&mesh.positions, &Workers::single());
        let all = TriangleBuckets::new(&mesh, &weld, &Workers::new(2));
        assert!(all.count() > 3);
        let mut around = Around::default();
        let mut corners = 0;
        for b in 0..all.count() {
            around.fill(&all, b);
            let last = around.first_vertex as usize + around.degrees.len();
            let here = |t: &[u32; 3]| {
                t.iter()
                    .any(|&v| (around.first_vertex as usize..last).contains(&(weld.of(v) as usize)))
            };
            let expected =
                mesh.triangles.iter().enumerate().filter(|(_, t)| here(t)).map(|(t, _)| t as u32);
            assert!(expected.eq(around.faces.iter().copied()), "bucket {b}");
            corners += around.degrees.iter().sum::<u32>() as usize;
        }
        assert_eq!(corners, 3 * mesh.triangles.len());
    }
}
