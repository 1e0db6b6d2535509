//! The parts that regions reach under, so that no seam shows.
//!
//! Viewers mix each region with the colours painted already, in proportion to how much of a pixel
//! it covers. Where two regions only touch, the paper shines through between them: half of it
//! passes the first, and half of that the second. A region that reaches a little under its
//! neighbour covers pixels of the border whole, and the neighbour mixes with that region only.
//!
//! A part reaches under the visible parts of all triangles round its corners, and of those whose
//! outlines cut it, or that it cuts. Clear parts reach nowhere: parts under a clear one show.
//! Where parts are smaller than pixels, or belong to bodies that only touch, that is not enough:
//! beneath everything lies the outline of the whole in its mean colour, so that a pixel with a gap
//! is not far from its neighbours.
//!
//! In:   parts with their groups in the order of painting. Out: for each group the parts beneath
//!       which it reaches.
//! Cost: linear in the pairs of neighbours.

use super::groups::{Groups, Joined, LEAST_SHAPE};
use super::parts::{Look, Part, VisibleParts};
use crate::page_mesh::PageMesh;
use crate::run::Run;
use crate::shapes::{area_of, union};
use std::ops::Range;
use vitral_exec::Limit;
use vitral_scene::buckets::{Dealt, Source};

/// Bytes of a pair of neighbours.
const BYTES_A_PAIR: u64 = 8;

/// For each group the parts of later groups that are beside its own.
pub(super) fn beneath(
    mesh: &PageMesh,
    parts: &VisibleParts,
    groups: &Groups,
    run: &Run<'_>,
) -> Result<Vec<Vec<u32>>, Limit> {
    let mut neighbours =
        Neighbours { parts: &parts.all, groups, beneath: vec![Vec::new(); groups.len()] };

    // Those round a vertex.
    let (starts, at_vertex) =
        Dealt::new(&Corners { mesh, parts: &parts.all }, mesh.vertices.len()).into_parts();
    for (v, range) in starts.windows(2).enumerate() {
        let around = &at_vertex[range[0] as usize..range[1] as usize];
        neighbours.add_all(around);
        if v % (1 << 14) == 0 {
            run.budget.check("seams")?;
        }
    }

    // Those that cut each other, and parts of one triangle.
    let first_of = first_parts(mesh.triangles.len(), &parts.all);
    let of_triangle = |t: u32| first_of[t as usize]..first_of[t as usize + 1];
    for &[part, triangle] in &parts.contacts {
        for other in of_triangle(triangle) {
            neighbours.add(part, other);
            neighbours.add(other, part);
        }
    }
    run.budget.check("seams")?;

    // Count each once.
    let pairs: usize = neighbours.beneath.iter().map(Vec::len).sum();
    run.memory.add(pairs as u64 * BYTES_A_PAIR)?;
    for list in &mut neighbours.beneath {
        list.sort_unstable();
        list.dedup();
    }
    Ok(neighbours.beneath)
}

/// The outline of all that is opaque, in its mean colour, where there are several looks.
pub(super) fn ground(parts: &[Part], joined: &[Joined]) -> Option<Joined> {
    let opaque: Vec<&Joined> = joined.iter().filter(|group| group.look.over == 0).collect();
    let [first, _, ..] = opaque.as_slice() else { return None };
    let (mut sum, mut area) = ([0.0; 3], 0.0);
    for group in &opaque {
        let own = area_of(&group.shapes);
        (0..3).for_each(|k| sum[k] += own * f64::from(group.look.color[k]));
        area += own;
    }
    let color = sum.map(|s| (s / area).round() as u8);
    let shapes = parts.iter().filter(|part| part.look.over == 0).map(|part| &part.shapes);
    let (look, surface) = (Look { color, unlit: 0, ..first.look }, first.surface);
    Some(Joined { look, surface, shapes: union(shapes, LEAST_SHAPE) })
}

/// Where the parts of each triangle begin; parts are in the order of their triangles.
fn first_parts(triangles: usize, parts: &[Part]) -> Vec<u32> {
    let mut first = vec![0u32; triangles + 1];
    parts.iter().for_each(|part| first[part.triangle as usize + 1] += 1);
    for t in 0..triangles {
        first[t + 1] += first[t];
    }
    first
}

struct Neighbours<'p> {
    parts: &'p [Part],
    groups: &'p Groups,
    beneath: Vec<Vec<u32>>,
}

impl Neighbours<'_> {
    /// Lets the group of `part` reach under `other`, if that is painted later.
    fn add(&mut self, part: u32, other: u32) {
        let [own, later] = [part, other].map(|i| self.groups.of_part(i));
        if own < later && [part, other].iter().all(|&i| self.parts[i as usize].look.over == 0) {
            self.beneath[own as usize].push(other);
        }
    }

    /// Lets every group of some parts reach under the later ones.
    fn add_all(&mut self, parts: &[u32]) {
        for (k, &part) in parts.iter().enumerate() {
            let group = self.groups.of_part(part);
            if parts[..k].iter().all(|&before| self.groups.of_part(before) != group) {
                parts.iter().for_each(|&other| self.add(part, other));
            }
        }
    }
}

/// Parts under the vertices of their triangles.
struct Corners<'p> {
    mesh: &'p PageMesh,
    parts: &'p [Part],
}

impl Source<u32> for Corners<'_> {
    fn items(&self) -> usize {
        self.parts.len()
    }

    fn visit(&self, range: Range<usize>, mut put: impl FnMut(usize, u32)) {
        for i in range {
            let corners = self.mesh.triangles[self.parts[i].triangle as usize].vertices;
            corners.into_iter().for_each(|v| put(v as usize, i as u32));
        }
    }
}
