//! The edges of a mesh's faces, with what lies on both sides: for wireframes, edge drawings and
//! hidden-line work.
//!
//! Idea: the outline of every face, as in the file, is walked; sides between the same two places
//! are one edge. The diagonals along which polygons were cut into triangles are not edges. The
//! angle between the two faces tells a crease from a mere subdivision of a smooth surface.
//!
//! In:   a mesh, model space; equal positions are welded first.
//! Out:  each edge once, in order of its vertices.
//! Cost: `O(corners)` expected.
//! Source: the table is `edge_table`; the classes are those of [Bénard & Hertzmann 2019], section
//!         2.

use crate::Mesh;
use crate::edge_table::{MAX_FACES, Outlines, Use, for_each_edge};
use crate::normals::face_normals;
use crate::weld::Weld;
use vitral_exec::Workers;
use vitral_math::func;

/// What kind of line an edge is, before any question of visibility.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EdgeKind {
    /// One face only.
    Boundary,
    /// Two faces at an angle above the crease angle.
    Crease,
    /// Two faces at an angle up to the crease angle.
    Smooth,
    /// More than two faces.
    NonManifold,
}

/// An edge between two faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Its ends as indices into the mesh's positions, the lower first; of vertices at one place,
    /// the first.
    pub ends: [u32; 2],
    /// The faces at it in ascending order, `u32::MAX` for none. Of more than two, the first two.
    pub faces: [u32; 2],
    /// What it is.
    pub kind: EdgeKind,
    /// Cosine of the angle between the faces' normals: 1 flat, 0 a right angle, -1 folded back.
    /// Where the faces run along the edge in the same direction, one of them is turned first. 1
    /// with fewer or more than two faces, and beside a face without area.
    pub cosine: f32,
}

impl Edge {
    /// The number of no face: at a boundary edge.
    pub const NO_FACE: u32 = u32::MAX;
}

/// The edges of `mesh`. `crease_angle` in radians separates creases from smooth edges: `0` makes a
/// crease of every edge that is not flat, `π` of none. A mesh of 2^31 faces or more has none.
pub fn edges(mesh: &Mesh, crease_angle: f64, workers: &Workers) -> Vec<Edge> {
    if mesh.face_count() >= MAX_FACES {
        return Vec::new();
    }
    let weld = Weld::new(&mesh.positions, workers);
    let normals = face_normals(mesh, workers);
    // A hair of slack, so that a right angle is not a crease for a crease angle of π/2.
    let threshold = (func::cos(crease_angle.clamp(0.0, std::f64::consts::PI)) - 1e-6) as f32;
    let visit = |list: &mut Vec<Edge>, lower, higher, uses: &[Use]| {
        list.push(classify([lower, higher], uses, &normals, threshold));
    };
    for_each_edge(mesh, &weld.representative, Outlines::Faces, workers, visit).concat()
}

fn classify(ends: [u32; 2], uses: &[Use], normals: &[[f32; 3]], threshold: f32) -> Edge {
    let faces = [uses[0].face(), uses.get(1).map_or(Edge::NO_FACE, |u| u.face())];
    let cosine = match uses {
        [a, b] => cosine_between(
            normals[a.face() as usize],
            normals[b.face() as usize],
            a.reversed() == b.reversed(),
        ),
        _ => 1.0,
    };
    let kind = match uses.len() {
        1 => EdgeKind::Boundary,
        2 if cosine < threshold => EdgeKind::Crease,
        2 => EdgeKind::Smooth,
        _ => EdgeKind::NonManifold,
    };
    Edge { ends, faces, kind, cosine }
}

fn cosine_between(n: [f32; 3], m: [f32; 3], turned: bool) -> f32 {
    if n == [0.0; 3] || m == [0.0; 3] {
        return 1.0;
    }
    let dot = (n[0] * m[0] + n[1] * m[1] + n[2] * m[2]).clamp(-1.0, 1.0);
    if turned { -dot } else { dot }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::solids;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    use vitral_math::DVec3;

    fn count(edges: &[Edge], kind: EdgeKind) -> usize {
        edges.iter().filter(|e| e.kind == kind).count()
    }

    #[test]
    fn a_cube_has_twelve_edges_and_no_diagonals() {
        let cube = solids::cuboid(DVec3::ONE);
        let edges = edges(&cube, FRAC_PI_4, &Workers::single());
        assert_eq!((edges.len(), count(&edges, EdgeKind::Crease)), (12, 12));
        assert!(edges.iter().all(|e| e.cosine.abs() < 1e-6 && e.faces[0] < e.faces[1]));
        let blunt = super::edges(&cube, FRAC_PI_2, &Workers::new(2));
        assert_eq!(count(&blunt, EdgeKind::Smooth), 12, "a right angle is not above a right angle");
    }

    #[test]
    fn boundaries_branches_and_seams_are_told() {
        // Two triangles that share an edge by position only, and a third on one of them.
        let positions = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, -0.0, 0.0],
            [0.0, -1.0, 0.0],
        ];
        let mut mesh = Mesh { positions, triangles: vec![[0, 1, 2], [3, 4, 5]], ..Mesh::default() };
        let two = edges(&mesh, 0.1, &Workers::single());
        assert_eq!((count(&two, EdgeKind::Smooth), count(&two, EdgeKind::Boundary)), (1, 4));
        assert_eq!((two[0].ends, two[0].faces), ([0, 1], [0, 1]));
        mesh.positions.push([0.0, 0.0, 1.0]);
        mesh.triangles.push([0, 1, 6]);
        assert_eq!(count(&edges(&mesh, 0.1, &Workers::single()), EdgeKind::NonManifold), 1);
    }

    #[test]
    fn a_turned_neighbour_does_not_make_a_crease() {
        let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [0, 1, 3]], ..Mesh::default() };
        assert_eq!(edges(&mesh, 0.1, &Workers::single())[0].cosine, 1.0);
    }
}
