//! The edges of the page's triangles: one for each pair of vertices, with the list of all triangles
//! at it.
//!
//! Every triangle says for each of its sides "I run from a to b". Sorted by (lower vertex, higher
//! vertex), the uses of one edge come together; an edge of more than two triangles keeps them all.
//! Of triangles over the same three vertices only the first counts: the others hide nothing that it
//! does not hide, and have no edges.
//!
//! In:   facets and triangles. Out: edges with their triangles and classes, in order of their
//!       vertices; duplicates hide nothing.
//! Cost: linear for meshes of bounded valence, at most `n log n`.
//! Source: a counting sort by the lower vertex, as for the winged edges of [Baumgart 1975].

use crate::classes::{Classes, Side, Thresholds, classes_of};
use crate::page_mesh::{Edge, PageMesh, Triangle};
use crate::projection::{CUT_SIDES, Facet, Projected};
use crate::run::Run;
use std::ops::Range;
use vitral_exec::Limit;
use vitral_frame::drawing::LineClass;
use vitral_math::func;
use vitral_scene::buckets::{Dealt, Source};

/// Vertices in one piece of work.
const BATCH: usize = 1 << 13;
/// Degrees between the normals of two faces up to which the edge between them is a tangent one.
const TANGENT_DEGREES: f64 = 1.0;
/// Bytes of an edge with two triangles, and of its uses.
const BYTES_A_SIDE: u64 = 32;

/// A side of a triangle under its lower vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Use {
    higher: u32,
    triangle: u32,
    /// Whether the triangle runs from the higher vertex to the lower one.
    reversed: bool,
    /// Whether the side is one of the face's.
    outline: bool,
    /// Whether a plane of section has cut along it.
    cut: bool,
}

/// Makes the page's mesh. `crease_angle` in radians; tangent edges are left out where
/// `hide_tangent` says so.
pub(crate) fn with_edges(
    projected: Projected,
    crease_angle: f64,
    hide_tangent: bool,
    run: &Run<'_>,
) -> Result<PageMesh, Limit> {
    // List the uses of each lower vertex.
    run.memory.add(projected.facets.len() as u64 * 3 * BYTES_A_SIDE)?;
    run.budget.check("edges")?;
    let (starts, mut uses) =
        Dealt::new(&Sides(&projected.facets), projected.vertices.len()).into_parts();

    // Sort the uses of each vertex by the other end, a batch of vertices on each thread.
    let mut lists: Vec<&mut [Use]> = Vec::new();
    let mut rest = uses.as_mut_slice();
    for first in (0..projected.vertices.len()).step_by(BATCH) {
        let last = projected.vertices.len().min(first + BATCH);
        let (list, others) = rest.split_at_mut((starts[last] - starts[first]) as usize);
        lists.push(list);
        rest = others;
    }
    let vertices_of =
        |batch: usize| batch * BATCH..projected.vertices.len().min((batch + 1) * BATCH);
    run.workers.for_each(
        lists.into_iter().enumerate().collect(),
        |(batch, list): (usize, &mut [Use])| {
            let base = starts[batch * BATCH];
            for v in vertices_of(batch) {
                list[(starts[v] - base) as usize..(starts[v + 1] - base) as usize].sort_unstable();
            }
        },
    );
    run.budget.check("edges")?;

    // Find duplicates, then classify what the others have in common.
    let uses_of = |v: usize| &uses[starts[v] as usize..starts[v + 1] as usize];
    let batches = projected.vertices.len().div_ceil(BATCH);
    let duplicates =
        duplicates(&projected, batches, &|batch| vertices_of(batch).map(uses_of).collect(), run);
    let thresholds = Thresholds {
        crease: (func::cos(crease_angle.clamp(0.0, std::f64::consts::PI)) - 1e-6) as f32,
        tangent: hide_tangent.then(|| func::cos(TANGENT_DEGREES.to_radians()) as f32),
    };
    let pieces = run.workers.map(batches, |batch| {
        let (mut edges, mut triangles) = (Vec::new(), Vec::new());
        for v in vertices_of(batch) {
            for edge in uses_of(v).chunk_by(|a, b| a.higher == b.higher) {
                add_edge(
                    v as u32,
                    edge,
                    &projected,
                    &duplicates,
                    thresholds,
                    &mut edges,
                    &mut triangles,
                );
            }
        }
        (edges, triangles)
    });
    Ok(put_together(projected, pieces, &duplicates))
}

/// The mesh of the pieces, with the free lines as edges without triangles.
fn put_together(
    projected: Projected,
    pieces: Vec<(Vec<Edge>, Vec<u32>)>,
    duplicates: &[u32],
) -> PageMesh {
    let Projected { size, vertices, mut triangles, sources, facets, lines, points } = projected;
    // Duplicates hide nothing and are not filled.
    for &t in duplicates {
        (triangles[t as usize].hides, triangles[t as usize].clear) = (false, false);
    }
    let sources = facets.iter().map(|facet| sources[facet.source as usize]).collect();
    let mut mesh = PageMesh { size, vertices, triangles, sources, points, ..PageMesh::default() };

    // Number the edges of the pieces, then add the free lines.
    for (edges, triangles) in pieces {
        let first = mesh.edge_triangles.len() as u32;
        mesh.edges.extend(edges.into_iter().map(|edge| Edge { first: first + edge.first, ..edge }));
        mesh.edge_triangles.extend(triangles);
    }
    let classes = Classes::one(LineClass::Boundary) | Classes::one(LineClass::Smooth);
    mesh.edges.extend(lines.iter().map(|&ends| Edge { ends, first: 0, count: 0, classes }));
    mesh
}

/// The sides of all triangles, each under its lower vertex.
struct Sides<'f>(&'f [Facet]);

impl Source<Use> for Sides<'_> {
    fn items(&self) -> usize {
        self.0.len()
    }

    fn visit(&self, range: Range<usize>, mut put: impl FnMut(usize, Use)) {
        for t in range {
            let facet = &self.0[t];
            for k in 0..3 {
                let (a, b) = (facet.vertices[k], facet.vertices[(k + 1) % 3]);
                let has = |bit: u32| facet.outline >> bit & 1 == 1;
                let (outline, cut) = (has(k as u32), has(k as u32 + CUT_SIDES));
                put(
                    a.min(b) as usize,
                    Use { higher: a.max(b), triangle: t as u32, reversed: a > b, outline, cut },
                );
            }
        }
    }
}

/// Triangles over the same vertices as an earlier one, in order.
fn duplicates<'u>(
    projected: &Projected,
    batches: usize,
    uses_of: &(dyn Fn(usize) -> Vec<&'u [Use]> + Sync),
    run: &Run<'_>,
) -> Vec<u32> {
    // Two triangles at an edge are over the same vertices if their third corners are one.
    let third = |v: usize, u: &Use| {
        let corners = projected.facets[u.triangle as usize].vertices;
        corners.into_iter().find(|&c| c != v as u32 && c != u.higher)
    };
    let found = run.workers.map(batches, |batch| {
        let mut found = Vec::new();
        for (v, uses) in (batch * BATCH..).zip(uses_of(batch)) {
            for edge in uses.chunk_by(|a, b| a.higher == b.higher).filter(|edge| edge.len() > 1) {
                let mut thirds: Vec<_> = edge.iter().map(|u| (third(v, u), u.triangle)).collect();
                thirds.sort_unstable();
                found.extend(thirds.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| w[1].1));
            }
        }
        found
    });
    let mut all = found.concat();
    all.sort_unstable();
    all.dedup();
    all
}

/// Adds an edge, if triangles that count are at it.
fn add_edge(
    lower: u32,
    uses: &[Use],
    projected: &Projected,
    duplicates: &[u32],
    thresholds: Thresholds,
    edges: &mut Vec<Edge>,
    triangles: &mut Vec<u32>,
) {
    // Keep the triangles that are no duplicates.
    let counts = |u: &&Use| duplicates.is_empty() || duplicates.binary_search(&u.triangle).is_err();
    let first = triangles.len() as u32;
    triangles.extend(uses.iter().filter(counts).map(|u| u.triangle));
    let count = triangles.len() as u32 - first;
    if count == 0 {
        return;
    }

    // Classify the edge. A diagonal of a face that is not flat may be a contour and nothing else,
    // and so may a side that a face uses twice, as where a bridge leads to a hole.
    let source = |t: u32| &projected.sources[projected.facets[t as usize].source as usize];
    let side = |u: &Use| Side {
        triangle: &projected.triangles[u.triangle as usize],
        source: source(u.triangle),
        reversed: u.reversed,
    };
    let outlines: Vec<Side<'_>> =
        uses.iter().filter(counts).filter(|u| u.outline).map(side).collect();
    let is_cut = uses.iter().filter(counts).any(|u| u.cut);
    let is_bridge = outlines.len() > 1
        && outlines.iter().all(|s| s.source.surface == outlines[0].source.surface);
    let classes = if outlines.is_empty() || is_bridge {
        let all: Vec<Side<'_>> = uses.iter().filter(counts).map(side).collect();
        classes_of(&all, thresholds).common(Classes::one(LineClass::Contour))
    } else {
        classes_of(&outlines, thresholds)
    };
    let classes = if is_cut { classes | Classes::one(LineClass::Section) } else { classes };
    edges.push(Edge { ends: [lower, uses[0].higher], first, count, classes });
}

impl Triangle {
    /// Whether a vertex is one of its corners.
    pub(crate) fn has(&self, vertex: u32) -> bool {
        self.vertices.contains(&vertex)
    }
}
