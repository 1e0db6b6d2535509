//! Topology: is the surface closed, and what is it made of?
//!
//! Idea: after welding, count the triangles at every edge. One: the surface has a boundary there.
//! Two: it goes on. More: it branches.
//!
//! In:   a mesh, model space. Faces with more than three corners count as triangulated.
//! Out:  [`Topology`] for the reader of `vitral info`.
//! Cost: `O(triangles)` expected.
//! Source: [Mäntylä 1988] (manifolds, Euler's formula).

use crate::disjoint_sets::DisjointSets;
use crate::edge_table::{MAX_FACES, Outlines, for_each_edge, is_collapsed};
use crate::weld::Weld;
use crate::{Mesh, buckets};
use std::ops::Range;
use vitral_exec::Workers;
use vitral_math::DVec3;

/// What a mesh is made of, counted after equal positions are welded.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// Different positions in use by triangles.
    pub vertices: usize,
    /// Different edges of triangles. A degenerate triangle's edge from a vertex to itself counts.
    pub edges: usize,
    /// All triangles, those without area included.
    pub triangles: usize,
    /// Edges with one triangle.
    pub boundary_edges: usize,
    /// Edges with more than two triangles.
    pub non_manifold_edges: usize,
    /// Edges with two triangles that run along it in the same direction.
    pub inconsistent_edges: usize,
    /// Triangles without area: two corners at one position, or three in a line.
    pub degenerate_triangles: usize,
    /// Triangles beyond the first over the same three positions, whatever their winding.
    pub duplicate_triangles: usize,
    /// Bodies: sets of triangles connected through vertices.
    pub components: usize,
    /// Vertices - edges + triangles, of the triangles with three different corners. 2 for a sphere,
    /// 0 for a torus.
    pub euler_characteristic: i64,
    /// Every edge has exactly two triangles, and there is at least one triangle.
    pub closed: bool,
}

impl Topology {
    /// Whether no two neighbours disagree about which side is outside.
    pub fn is_consistent(&self) -> bool {
        self.inconsistent_edges == 0
    }

    /// Counts everything. A mesh of 2^31 triangles or more is only told its size.
    pub fn of(mesh: &Mesh, workers: &Workers) -> Self {
        // Tell only the size of a mesh that is empty or too large.
        let triangles = mesh.triangles.len();
        if triangles == 0 || triangles >= MAX_FACES {
            return Self { triangles, ..Self::default() };
        }

        // Weld vertices at the same position.
        let weld = Weld::new(&mesh.positions, workers);
        let welded = |t: usize| mesh.triangles[t].map(|i| weld.representative[i as usize]);
        let collapsed = |t: usize| is_collapsed(welded(t));

        // Count the edges by the number and the direction of their uses.
        let parts = for_each_edge(
            mesh,
            &weld.representative,
            Outlines::AllTriangles,
            workers,
            |c: &mut EdgeCounts, lower, higher, uses| {
                c.edges += 1;
                c.sound += usize::from(
                    lower != higher && uses.iter().any(|u| !collapsed(u.face() as usize)),
                );
                c.boundary += usize::from(uses.len() == 1);
                c.non_manifold += usize::from(uses.len() > 2);
                c.inconsistent += usize::from(
                    lower != higher && uses.len() == 2 && uses[0].reversed() == uses[1].reversed(),
                );
            },
        );
        let sum = |field: fn(&EdgeCounts) -> usize| parts.iter().map(field).sum::<usize>();

        // Count bodies, vertices and triangles.
        let (components, vertices, sound_vertices) = bodies(mesh, &weld);
        let sound_triangles = (0..triangles).filter(|&t| !collapsed(t)).count();
        let (boundary_edges, non_manifold_edges) = (sum(|c| c.boundary), sum(|c| c.non_manifold));
        Self {
            vertices,
            edges: sum(|c| c.edges),
            triangles,
            boundary_edges,
            non_manifold_edges,
            inconsistent_edges: sum(|c| c.inconsistent),
            degenerate_triangles: (0..triangles).filter(|&t| has_no_area(mesh, t)).count(),
            duplicate_triangles: duplicates(mesh, &weld, workers),
            components,
            euler_characteristic: sound_vertices as i64 - sum(|c| c.sound) as i64
                + sound_triangles as i64,
            closed: boundary_edges == 0 && non_manifold_edges == 0,
        }
    }
}

#[derive(Default)]
struct EdgeCounts {
    edges: usize,
    sound: usize,
    boundary: usize,
    non_manifold: usize,
    inconsistent: usize,
}

/// Whether every edge has exactly two triangles after welding; `false` without triangles.
pub fn is_closed(mesh: &Mesh, workers: &Workers) -> bool {
    if mesh.triangles.is_empty() || mesh.triangles.len() >= MAX_FACES {
        return false;
    }
    let weld = Weld::new(&mesh.positions, workers);
    let visit = |open: &mut bool, _, _, uses: &[_]| *open |= uses.len() != 2;
    !for_each_edge(mesh, &weld.representative, Outlines::AllTriangles, workers, visit)
        .contains(&true)
}

/// Number of bodies, of vertices in use, and of vertices in use by triangles with three different
/// corners.
fn bodies(mesh: &Mesh, weld: &Weld) -> (usize, usize, usize) {
    let sets = DisjointSets::new(mesh.positions.len());
    let mut used = vec![0u8; mesh.positions.len()];
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|i| weld.representative[i as usize]);
        sets.join(a, b);
        sets.join(b, c);
        let mark = if is_collapsed([a, b, c]) { 1 } else { 3 };
        [a, b, c].iter().for_each(|&v| used[v as usize] |= mark);
    }
    let roots =
        (0..used.len()).filter(|&v| used[v] != 0 && sets.find(v as u32) as usize == v).count();
    (roots, used.iter().filter(|&&u| u != 0).count(), used.iter().filter(|&&u| u == 3).count())
}

/// Counts triangles that repeat the three positions of another one.
fn duplicates(mesh: &Mesh, weld: &Weld, workers: &Workers) -> usize {
    let (shift, count) = buckets::shift_and_count(mesh.positions.len());
    let source = SortedTriangles { mesh, weld, shift };
    let dealt = buckets::Buckets::deal(&source, count, workers);
    let repeated = workers.map(count, |b| {
        let mut triangles: Vec<[u32; 3]> = dealt.pieces(b).flatten().copied().collect();
        triangles.sort_unstable();
        triangles.windows(2).filter(|w| w[0] == w[1]).count()
    });
    repeated.iter().sum()
}

struct SortedTriangles<'a> {
    mesh: &'a Mesh,
    weld: &'a Weld,
    shift: u32,
}

impl buckets::Source<[u32; 3]> for SortedTriangles<'_> {
    fn items(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn visit(&self, range: Range<usize>, mut put: impl FnMut(usize, [u32; 3])) {
        for corners in &self.mesh.triangles[range] {
            let mut v = corners.map(|i| self.weld.representative[i as usize]);
            v.sort_unstable();
            put((v[0] >> self.shift) as usize, v);
        }
    }
}

fn has_no_area(mesh: &Mesh, t: usize) -> bool {
    let [a, b, c] = mesh.triangles[t].map(|i| mesh.position(i));
    let normal = (b - a).cross(c - a);
    normal == DVec3::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solidity;
    use crate::builtin::solids;

    fn of(mesh: &Mesh) -> Topology {
        let one = Topology::of(mesh, &Workers::single());
        assert_eq!(one, Topology::of(mesh, &Workers::new(3)));
        assert_eq!(one.closed, is_closed(mesh, &Workers::single()));
        one
    }

    fn solid(mesh: &Mesh) -> [bool; 3] {
        let s = Solidity::of(mesh, &Workers::single());
        [s.closed, s.consistent, s.outward]
    }

    #[test]
    fn a_cube_is_closed_and_has_euler_characteristic_two() {
        let cube = solids::cuboid(DVec3::ONE);
        let t = of(&cube);
        assert_eq!((t.vertices, t.edges, t.triangles, t.euler_characteristic), (8, 18, 12, 2));
        assert!(t.closed && t.is_consistent() && t.components == 1);
        assert_eq!(solid(&cube), [true; 3]);
    }

    #[test]
    fn an_open_cube_is_told() {
        let mut cube = solids::cuboid(DVec3::ONE);
        cube.faces = crate::Faces::Triangles;
        cube.triangles.pop();
        let t = of(&cube);
        assert_eq!((t.boundary_edges, t.closed, t.euler_characteristic), (3, false, 1));
        assert!(!solid(&cube)[0]);
    }

    #[test]
    fn a_turned_triangle_and_an_inside_out_cube_are_told() {
        let mut cube = solids::cuboid(DVec3::ONE);
        cube.faces = crate::Faces::Triangles;
        cube.triangles[0].swap(0, 1);
        assert_eq!(of(&cube).inconsistent_edges, 3);
        assert_eq!(solid(&cube), [true, false, false]);
        cube.triangles[0].swap(0, 1);
        cube.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        assert_eq!(solid(&cube), [true, true, false]);
    }

    #[test]
    fn one_inside_out_body_among_two_is_told() {
        let (mut two, second) = (solids::cuboid(DVec3::splat(4.0)), solids::cuboid(DVec3::ONE));
        two.faces = crate::Faces::Triangles;
        two.positions.extend(second.positions.iter().map(|p| [p[0] + 9.0, p[1], p[2]]));
        two.triangles.extend(second.triangles.iter().map(|t| [t[1] + 8, t[0] + 8, t[2] + 8]));
        assert_eq!(of(&two).components, 2);
        assert_eq!(solid(&two), [true, true, false]);
    }

    #[test]
    fn degenerate_duplicate_and_branching_triangles_are_counted() {
        // Three triangles on one edge, the last twice; one on a line; one with two corners at one
        // place.
        let positions = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [2.0, 0.0, 0.0],
            [-0.0, 0.0, 0.0],
        ];
        let triangles = vec![[0, 1, 2], [1, 0, 3], [0, 1, 4], [4, 0, 1], [0, 1, 5], [0, 6, 2]];
        let t = of(&Mesh { positions, triangles, ..Mesh::default() });
        assert_eq!((t.degenerate_triangles, t.duplicate_triangles, t.components), (2, 1, 1));
        // The edges 0-1 (five triangles), and 0-2 (one and the two sides of the collapsed one).
        assert_eq!(t.non_manifold_edges, 2);
        assert_eq!(of(&Mesh::default()), Topology::default());
    }
}
