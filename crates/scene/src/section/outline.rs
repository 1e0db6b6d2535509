//! The outline of a cut: which bodies are closed, and how the sides of their triangles in the plane
//! join to loops.
//!
//! What a plane leaves of a closed surface is bounded by sides in the plane alone. Sides that two
//! triangles use in opposite directions cancel out; the rest enters and leaves each vertex equally
//! often, if the triangles agree about the outside, and falls apart into loops. If they do not,
//! sides that are used an odd number of times make loops as well, of no direction.
//!
//! In:   sides in the plane. Out: for each body its outline, and loops if it is closed.
//! Cost: `n log n` in the number of sides.

use super::clip::PlaneSide;
use crate::Mesh;
use crate::disjoint_sets::DisjointSets;
use crate::edge_table::{MAX_FACES, Outlines, Use, for_each_edge};
use crate::weld::Weld;
use vitral_exec::Workers;

/// Triangles that are connected by their sides.
pub(super) struct Bodies {
    /// For each triangle the first triangle of its body.
    body: Vec<u32>,
    /// For each first triangle, whether the body has a border.
    is_open: Vec<bool>,
}

/// How the loops of a body tell its inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Inside {
    /// Loops run round it: the winding number is not 0.
    Winding,
    /// An odd number of loops lies round it.
    Parity,
}

/// The cut through a closed body.
#[derive(Debug)]
pub(super) struct BodyLoops {
    /// The first triangle of the whole mesh that was cut.
    pub(super) triangle: u32,
    pub(super) inside: Inside,
    /// Closed, without repeating the first vertex; they run as the cap does.
    pub(super) loops: Vec<Vec<u32>>,
}

/// The cut through a mesh.
#[derive(Debug, Default)]
pub(super) struct Outline {
    /// All its edges, as vertices of the clipped mesh.
    pub(super) edges: Vec<[u32; 2]>,
    /// Closed bodies.
    pub(super) bodies: Vec<BodyLoops>,
}

impl Bodies {
    pub(super) fn new(mesh: &Mesh, weld: &Weld, workers: &Workers) -> Self {
        let count = mesh.triangles.len();
        let mut bodies = Self { body: (0..count as u32).collect(), is_open: vec![true; count] };
        if count >= MAX_FACES {
            return bodies;
        }
        let sets = DisjointSets::new(count);
        let visit = |borders: &mut Vec<u32>, _, _, uses: &[Use]| {
            uses.windows(2).for_each(|pair| sets.join(pair[0].face(), pair[1].face()));
            if uses.len() % 2 == 1 {
                borders.push(uses[0].face());
            }
        };
        let borders =
            for_each_edge(mesh, &weld.representative, Outlines::SoundTriangles, workers, visit);
        bodies.body.iter_mut().for_each(|body| *body = sets.find(*body));
        bodies.is_open.fill(false);
        borders.iter().flatten().for_each(|&t| bodies.is_open[sets.find(t) as usize] = true);
        bodies
    }
}

/// A side under its body and its lower end.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Use2 {
    body: u32,
    edge: [u32; 2],
    reversed: bool,
    /// Its ends before welding.
    ends: [u32; 2],
    triangle: u32,
}

impl Outline {
    pub(super) fn new(bodies: &Bodies, sides: Vec<PlaneSide>, weld: &Weld) -> Self {
        // Sort the sides by body and edge; new vertices are welded as they are.
        let welded = |v: u32| if (v as usize) < weld.representative.len() { weld.of(v) } else { v };
        let mut uses: Vec<Use2> = Vec::with_capacity(sides.len());
        for PlaneSide { triangle, ends } in sides {
            let [a, b] = ends.map(welded);
            if a != b {
                let body = bodies.body[triangle as usize];
                uses.push(Use2 {
                    body,
                    edge: [a.min(b), a.max(b)],
                    reversed: a > b,
                    ends,
                    triangle,
                });
            }
        }
        uses.sort_unstable();

        // Find what is left of each body's sides after those that cancel out, and join it.
        let mut outline = Self::default();
        for of_body in uses.chunk_by(|a, b| a.body == b.body) {
            let mut triangle = u32::MAX;
            let (mut directed, mut odd) = (Vec::new(), Vec::new());
            for of_edge in of_body.chunk_by(|a, b| a.edge == b.edge) {
                let forth = of_edge.iter().filter(|side| !side.reversed).count();
                let back = of_edge.len() - forth;
                if forth != back || of_edge.len() % 2 == 1 {
                    outline.edges.extend(of_edge.iter().map(|side| side.ends));
                    triangle =
                        of_edge.iter().fold(triangle, |first, side| first.min(side.triangle));
                }
                // A cap runs against the triangles beside it.
                let [a, b] = of_edge[0].edge;
                directed.extend(std::iter::repeat_n([b, a], forth.saturating_sub(back)));
                directed.extend(std::iter::repeat_n([a, b], back.saturating_sub(forth)));
                odd.extend((of_edge.len() % 2 == 1).then_some([a, b]));
            }
            if triangle == u32::MAX || bodies.is_open[of_body[0].body as usize] {
                continue;
            }
            let by_winding = directed_loops(directed).map(|loops| (Inside::Winding, loops));
            if let Some((inside, loops)) =
                by_winding.or_else(|| Some((Inside::Parity, undirected_loops(&odd)?)))
            {
                outline.bodies.push(BodyLoops { triangle, inside, loops });
            }
        }
        outline
    }
}

/// Joins edges to loops along their directions; `None` where one ends.
pub(super) fn directed_loops(mut edges: Vec<[u32; 2]>) -> Option<Vec<Vec<u32>>> {
    // Take the edges that leave each vertex one after the other.
    edges.sort_unstable();
    let first_at = |v: u32| edges.partition_point(|edge| edge[0] < v);
    let mut next: Vec<usize> = (0..edges.len()).collect();
    let mut is_used = vec![false; edges.len()];
    let mut loops = Vec::new();
    for first in 0..edges.len() {
        if is_used[first] {
            continue;
        }
        let (mut edge, mut found) = (first, Vec::new());
        loop {
            is_used[edge] = true;
            found.push(edges[edge][0]);
            let to = edges[edge][1];
            if to == edges[first][0] {
                break;
            }
            let start = first_at(to);
            let place = next.get_mut(start).filter(|_| edges[start][0] == to)?;
            while *place < edges.len() && edges[*place][0] == to && is_used[*place] {
                *place += 1;
            }
            if *place >= edges.len() || edges[*place][0] != to {
                return None;
            }
            edge = *place;
        }
        loops.push(found);
    }
    Some(loops)
}

/// Joins edges to loops in any direction; `None` where one ends.
fn undirected_loops(edges: &[[u32; 2]]) -> Option<Vec<Vec<u32>>> {
    let mut ends: Vec<(u32, usize)> = Vec::with_capacity(edges.len() * 2);
    edges.iter().enumerate().for_each(|(i, edge)| ends.extend(edge.map(|v| (v, i))));
    ends.sort_unstable();
    let mut is_used = vec![false; edges.len()];
    let mut loops = Vec::new();
    for first in 0..edges.len() {
        if is_used[first] {
            continue;
        }
        is_used[first] = true;
        let [start, mut at] = edges[first];
        let mut found = vec![start];
        while at != start {
            found.push(at);
            let place = ends.partition_point(|end| end.0 < at);
            let around = ends[place..].iter().take_while(|end| end.0 == at);
            let &(_, edge) = around.into_iter().find(|end| !is_used[end.1])?;
            is_used[edge] = true;
            let [a, b] = edges[edge];
            at = if a == at { b } else { a };
        }
        loops.push(found);
    }
    Some(loops)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loops_need_no_order_and_no_ends() {
        let square = vec![[2, 3], [0, 1], [3, 0], [1, 2]];
        assert_eq!(directed_loops(square.clone()), Some(vec![vec![0, 1, 2, 3]]));
        assert_eq!(undirected_loops(&[[0, 1], [2, 1], [2, 3], [0, 3]]).map(|l| l.len()), Some(1));
        assert_eq!(directed_loops(square[1..].to_vec()), None);
        assert_eq!(undirected_loops(&square[1..]), None);
        // Two triangles that touch in a vertex.
        let eight = vec![[0, 1], [1, 2], [2, 0], [0, 3], [3, 4], [4, 0]];
        assert_eq!(directed_loops(eight.clone()).map(|l| l.concat().len()), Some(6));
        assert_eq!(undirected_loops(&eight).map(|l| l.concat().len()), Some(6));
        assert_eq!(directed_loops(Vec::new()), Some(Vec::new()));
    }
}
