//! Closes the gaps between a cap and the loops that it should end at.
//!
//! Vertices are rounded, so that loops cross where they come close to each other. There a cap ends
//! at a crossing, and hairs of it look the wrong way. Hairs beside a gap are taken away; thin
//! triangles then join what is left to the loops.
//!
//! In:   loops, and triangles for what they go round. Out: triangles whose outline is the loops,
//! but for wide gaps: those are left where surfaces penetrate themselves.
//! Cost: `n log n` in the number of triangles.

use super::outline::directed_loops;
use crate::Corners;
use std::collections::{BTreeMap, HashSet};

/// How thick triangles are that rounding could turn over, in what it moves a vertex.
const HAIR: f64 = 1.0;
/// How thick triangles are that fill gaps. Vertices along edges that are almost in the plane move
/// farther than others, and the hairs that were taken away add up.
const GAP: f64 = 32.0;
/// Corners of gaps up to which they are filled; rounding makes none so long.
const MAX_CORNERS: usize = 64;

/// What runs along an edge.
#[derive(Clone, Copy, Default)]
struct Uses {
    /// How often loops do, from its lower vertex to the higher, less how often triangles do.
    missing: i32,
    /// How many triangles do, in each direction.
    triangles: [u32; 2],
}

/// Makes triangles end at the loops. `thickness` is that of a triangle in what rounding may move a
/// vertex.
pub(super) fn close_gaps(
    loops: &[&[u32]],
    triangles: &mut Vec<Corners>,
    thickness: impl Fn(Corners) -> f64,
) {
    // Take the outline of the triangles from the loops. What is left goes round the gaps.
    let mut edges: BTreeMap<[u32; 2], Uses> = BTreeMap::new();
    for (edge, forward) in loops.iter().flat_map(|corners| sides(corners)) {
        edges.entry(edge).or_default().missing += if forward { 1 } else { -1 };
    }
    for (edge, forward) in triangles.iter().flat_map(|corners| sides(corners)) {
        let uses = edges.entry(edge).or_default();
        uses.missing -= if forward { 1 } else { -1 };
        uses.triangles[usize::from(forward)] += 1;
    }

    // Take hairs away that lie beside a gap or on each other, which widens gaps, until there are
    // none.
    let mut count = usize::MAX;
    while count != triangles.len() {
        count = triangles.len();
        let is_amiss =
            |uses: &Uses| uses.missing != 0 || uses.triangles.iter().any(|&count| count > 1);
        let amiss: HashSet<[u32; 2]> =
            edges.iter().filter(|(_, uses)| is_amiss(uses)).map(|(&edge, _)| edge).collect();
        let stays = |corners: &Corners| {
            !sides(corners).any(|(edge, _)| amiss.contains(&edge)) || thickness(*corners) > HAIR
        };
        let hairs: Vec<Corners> = triangles.extract_if(.., |corners| !stays(corners)).collect();
        for (edge, forward) in hairs.iter().flat_map(|corners| sides(corners)) {
            let uses = edges.entry(edge).or_default();
            uses.missing += if forward { 1 } else { -1 };
            uses.triangles[usize::from(forward)] -= 1;
        }
    }

    // Fill those that are thin.
    let left = edges.iter().flat_map(|(&[a, b], uses)| {
        let side = if uses.missing > 0 { [a, b] } else { [b, a] };
        std::iter::repeat_n(side, uses.missing.unsigned_abs() as usize)
    });
    let mut gaps = directed_loops(left.collect()).unwrap_or_default();
    gaps.retain(|gap| gap.len() <= MAX_CORNERS);
    for mut gap in gaps {
        let mut filling = Vec::new();
        while gap.len() > 2 {
            let ear =
                |k: usize| [gap[(k + gap.len() - 1) % gap.len()], gap[k], gap[(k + 1) % gap.len()]];
            let ears = (0..gap.len()).map(|k| (thickness(ear(k)), k));
            let Some((_, k)) = ears.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|ear| ear.0 <= GAP)
            else {
                break;
            };
            filling.push(ear(k));
            gap.remove(k);
        }
        if gap.len() <= 2 {
            triangles.extend(filling);
        }
    }
}

/// The sides of a polygon, each with its ends in order and whether it runs that way.
fn sides(corners: &[u32]) -> impl Iterator<Item = ([u32; 2], bool)> {
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    ends.map(|(&from, &to)| ([from.min(to), from.max(to)], from < to))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vertices of a square, 0 to 3, and 4 on its side from 0 to 1.
    fn thickness(corners: Corners) -> f64 {
        if corners.iter().all(|v| [0, 1, 4].contains(v)) { 0.5 } else { 1e9 }
    }

    #[test]
    fn a_vertex_on_a_side_is_joined_by_a_thin_triangle() {
        let mut triangles = vec![[0, 4, 3], [4, 1, 2], [4, 2, 3]];
        close_gaps(&[&[0, 1, 2, 3]], &mut triangles, thickness);
        assert_eq!(triangles[3..], [[4, 0, 1]]);
        // Nothing is missing.
        let closed = triangles.clone();
        close_gaps(&[&[0, 1, 2, 3]], &mut triangles, thickness);
        assert_eq!(triangles, closed);
    }

    #[test]
    fn hairs_that_look_the_wrong_way_go() {
        let mut triangles = vec![[0, 1, 2], [0, 2, 3], [0, 1, 4]];
        close_gaps(&[&[0, 1, 2, 3]], &mut triangles, thickness);
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn wide_gaps_stay() {
        let mut triangles = vec![[0, 1, 2]];
        close_gaps(&[&[0, 1, 2, 3]], &mut triangles, thickness);
        assert_eq!(triangles, [[0, 1, 2]]);
    }
}
