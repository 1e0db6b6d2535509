//! A tree of boxes with eight boxes a node.
//!
//! What goes down a tree alone, be it a ray or the pyramid round a block of pixels, has nothing to
//! fill lanes with, so here they hold what it is asked about. Of the tree with two children a node,
//! the largest nodes below the root are opened until there are eight; their boxes stand side by
//! side and are tested at once, and those below each make a node again. Whatever holds eight
//! triangles or fewer is a leaf. For a ray its triangles are tested at once, too, as far as that is
//! a matter of plain rounding; [`Ray::hit`] has the last word.
//!
//! In:   a tree of boxes with its triangles; rays and other probes in their space. Out: what a ray
//!       meets first, or the triangles near a probe.
//! Cost: linear to build; 60 to 100 bytes a triangle. A ray opens about a third as many nodes as
//!       with two children each.
//! Source: \[Wald, Benthin & Boulos 2008\].

use super::beam::{self, BeamLines};
use super::intersect::{Ray, surely_beside};
use super::path::PartExtent;
use super::sah::{self, area};
use super::triangles::Triangles;
use super::{Boxes, Counters, Probe, Visitor};
use std::collections::HashMap;
use std::ops::Range;
use vitral_exec::Workers;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Simd};
use vitral_math::{DVec3, Vec3};

/// Marks what is below a box as a leaf.
const LEAF: u32 = 1 << 31;
/// Leaves that are filled at once.
const CHUNK: usize = 1024;
/// What may wait without memory being asked for. A ray seldom meets more than a few boxes of a
/// node.
const WAITING: usize = 64;

/// Eight boxes; those that are not there are met by nothing.
#[derive(Clone, Debug, PartialEq)]
struct Node {
    bounds: Boxes,
    /// The node below each, or a leaf and [`LEAF`].
    below: [u32; LANES],
}

/// The corners of one to eight triangles, by corner and axis.
type Leaf = [[[f32; LANES]; 3]; 3];

/// See the module.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Wide {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    /// The places of each leaf's triangles: the first, and the one behind the last.
    places: Vec<[u32; 2]>,
}

/// Children of boxes that were met, and where those are entered; the nearest of a node's boxes
/// come first.
struct Waiting {
    list: [(u32, f32); WAITING],
    count: usize,
    /// What found no place.
    more: Vec<(u32, f32)>,
}

/// The beam round a ray on one axis, the same in all lanes: where it enters boxes, and where it
/// leaves them.
#[derive(Clone, Copy)]
struct Slab<S: Simd> {
    /// The side by which it enters, 0 for the least coordinates.
    side: usize,
    /// Starts of the lines that enter and that leave first.
    start: [F32x8<S>; 2],
    /// One over the slopes of these lines, rounded outwards.
    inverse: [F32x8<S>; 2],
}

impl Wide {
    /// Bytes a triangle, about the most that models take.
    pub(super) const BYTES: usize = 100;

    /// From a tree with two children a node.
    pub(super) fn new(tree: &[sah::BoxNode], triangles: &Triangles, workers: &Workers) -> Self {
        // The triangles below each node.
        let mut runs = vec![[0; 2]; tree.len()];
        for (i, node) in tree.iter().enumerate().rev() {
            runs[i] = match node.count {
                0 => [runs[i + 1][0], runs[i + node.link as usize][1]],
                count => [node.link, node.link + count],
            };
        }

        // Collapse the tree from the root down.
        let mut wide = Self::default();
        if !tree.is_empty() {
            wide.grow(tree, &runs, 0);
        }

        // Gather the corners of each leaf's triangles into lanes.
        wide.leaves = vec![[[[0.0; LANES]; 3]; 3]; wide.places.len()];
        workers.for_each_chunk(&mut wide.leaves, CHUNK, |chunk, leaves| {
            for (leaf, places) in leaves.iter_mut().zip(&wide.places[chunk * CHUNK..]) {
                for (lane, corners) in triangles.corners[range(places)].iter().enumerate() {
                    for (corner, p) in leaf.iter_mut().zip(corners) {
                        (corner[0][lane], corner[1][lane], corner[2][lane]) = (p.x, p.y, p.z);
                    }
                }
            }
        });
        wide
    }

    /// Makes a node of what is below `top`: its number.
    fn grow(&mut self, tree: &[sah::BoxNode], runs: &[[u32; 2]], top: usize) -> u32 {
        // Open the largest inner child until there are eight.
        let is_leaf = |i: usize| (runs[i][1] - runs[i][0]) as usize <= LANES;
        let member = |i: usize| {
            (i, if is_leaf(i) { f32::NEG_INFINITY } else { area(&tree[i].min, &tree[i].max) })
        };
        let mut members = [member(top); LANES];
        let mut count = 1;
        while count < LANES {
            let largest = (1..count)
                .fold(0, |m, other| if members[other].1 > members[m].1 { other } else { m });
            let (i, _) = members[largest];
            if is_leaf(i) {
                break;
            }
            members[largest] = member(i + 1);
            members[count] = member(i + tree[i].link as usize);
            count += 1;
        }

        // Emit the node, then what lies below each child.
        let number = self.nodes.len();
        let nowhere = [[f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]];
        self.nodes.push(Node { bounds: [nowhere; 3], below: [0; LANES] });
        for (lane, &(i, _)) in members[..count].iter().enumerate() {
            let below = if is_leaf(i) {
                self.places.push(runs[i]);
                (self.places.len() - 1) as u32 | LEAF
            } else {
                self.grow(tree, runs, i)
            };
            let node = &mut self.nodes[number];
            for k in 0..3 {
                (node.bounds[k][0][lane], node.bounds[k][1][lane]) =
                    (tree[i].min[k], tree[i].max[k]);
            }
            node.below[lane] = below;
        }
        number as u32
    }

    /// [`super::Structure::closest_hit_from`], given the triangles that this was made of.
    #[inline(never)]
    pub(super) fn closest_hit<S: Simd>(
        &self,
        simd: S,
        triangles: &Triangles,
        (ray, own): (&Ray, u32),
        counters: &mut Counters,
    ) -> Option<(usize, f32)> {
        simd.vectorize(
            #[inline(always)]
            || self.descend(simd, triangles, (ray, own), counters),
        )
    }

    #[inline(always)]
    fn descend<S: Simd>(
        &self,
        simd: S,
        triangles: &Triangles,
        (ray, own): (&Ray, u32),
        counters: &mut Counters,
    ) -> Option<(usize, f32)> {
        // Prepare the beam round the ray and the search.
        let slabs = slabs(simd, ray, triangles.extent);
        let slack = ray.rounding(triangles.extent);
        let (mut best, mut limit) = (None, f32::INFINITY);
        let mut waiting = Waiting::new();
        let mut next = 0;
        if self.nodes.is_empty() {
            return None;
        }
        loop {
            // Open a node: descend into a single child, or queue all that are met.
            if next & LEAF == 0 {
                let node = &self.nodes[next as usize];
                counters.boxes += LANES as u64;
                let (near, met) = node.entered(simd, &slabs, limit);
                if met.is_power_of_two() {
                    next = node.below[met.trailing_zeros() as usize];
                    continue;
                }
                waiting.add(&node.below, &near.to_array(), met);
            } else {
                // Test a leaf's eight triangles, then intersect those that may be met exactly.
                let leaf = (next & !LEAF) as usize;
                let places = range(&self.places[leaf]);
                counters.triangles += places.len() as u64;
                let mut met = may_meet(simd, &self.leaves[leaf], ray) & ((1 << places.len()) - 1);
                while met != 0 {
                    let place = places.start + met.trailing_zeros() as usize;
                    met &= met - 1;
                    if let Some(t) = ray.hit(&triangles.corners[place])
                        && triangles.replaces(best, (place, t), own)
                    {
                        best = Some((place, t));
                        limit = t + slack;
                    }
                }
            }
            // What lies behind the hit is passed over.
            next = loop {
                match waiting.next() {
                    None => return best,
                    Some((below, near)) if near <= limit => break below,
                    Some(_) => {}
                }
            };
        }
    }

    /// The number, as a part, of the child of a box: nodes come first, those above before those
    /// below, then leaves.
    #[inline(always)]
    fn part(&self, below: u32) -> usize {
        if below & LEAF == 0 { below as usize } else { self.nodes.len() + (below & !LEAF) as usize }
    }

    /// [`super::Structure::largest`].
    pub(super) fn largest(&self, value: &dyn Fn(usize) -> f32) -> Vec<f32> {
        let mut values = vec![f32::NEG_INFINITY; self.nodes.len() + self.leaves.len()];
        let (nodes, leaves) = values.split_at_mut(self.nodes.len());
        for (largest, places) in leaves.iter_mut().zip(&self.places) {
            *largest = range(places).map(value).fold(f32::NEG_INFINITY, f32::max);
        }
        // Nodes stand before those below them.
        for (i, node) in self.nodes.iter().enumerate().rev() {
            let there = node
                .below
                .iter()
                .zip(&node.bounds[0][0])
                .filter(|(_, least)| **least < f32::INFINITY);
            let below = there.map(|(&b, _)| {
                if b & LEAF == 0 { nodes[b as usize] } else { leaves[(b & !LEAF) as usize] }
            });
            nodes[i] = below.fold(f32::NEG_INFINITY, f32::max);
        }
        values
    }

    /// [`super::Structure::part_count`].
    pub(super) fn part_count(&self) -> u32 {
        (self.nodes.len() + self.leaves.len()) as u32
    }

    /// [`super::Structure::extents`], with what the boxes are relative to.
    pub(super) fn extents(&self, parts: &[u32], center: DVec3) -> Vec<PartExtent> {
        // A node has the boxes of those below it; the root's is the box round all of these.
        let boxes = |node: &Node| {
            let corner = |lane: usize, side: usize| {
                Vec3::from_array([0, 1, 2].map(|k: usize| node.bounds[k][side][lane]))
            };
            let there = (0..LANES).filter(|&lane| node.bounds[0][0][lane] < f32::INFINITY);
            let child = |lane: usize| (node.below[lane], [corner(lane, 0), corner(lane, 1)]);
            there.map(child).collect::<Vec<_>>()
        };
        let mut known = HashMap::new();
        let root = self.nodes.first().map_or(Vec::new(), boxes).into_iter().map(|(_, b)| b);
        if let Some(root) = root.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]) {
            known.insert(0, PartExtent::of_box(None, root, center));
        }

        // Each node tells where those below it are.
        let extent = |&part: &u32| {
            let above = Some(part);
            for (below, bounds) in self.nodes.get(part as usize).map_or(Vec::new(), boxes) {
                let extent = PartExtent::of_box(above, bounds, center);
                known.insert(self.part(below) as u32, extent);
            }
            known[&part]
        };
        parts.iter().map(extent).collect()
    }

    /// [`super::Tree::descend_from`]: the nearest of a node's boxes come first.
    #[inline(always)]
    pub(super) fn descend_from(
        &self,
        near: f32,
        probe: &impl Probe,
        visitor: &mut impl Visitor,
    ) -> u64 {
        // Begin with the root.
        let mut visited = 0;
        let mut waiting = Waiting::new();
        let mut next = Some((0, near));
        while let Some((below, near)) = next {
            // Open a node, or visit a leaf's triangles.
            let part = self.part(below);
            if !visitor.skips(part, near) {
                visitor.passes(part);
                if below & LEAF == 0 {
                    let node = &self.nodes[below as usize];
                    let (near, met) = probe.enters_each(&node.bounds);
                    visited += LANES as u64;
                    waiting.add(&node.below, &near, met);
                } else {
                    // No closure, which would not have the visitor's instruction set if it were not
                    // inlined.
                    for place in range(&self.places[(below & !LEAF) as usize]) {
                        visitor.triangle(place);
                    }
                }
            }
            next = waiting.next();
        }
        visited
    }
}

impl Waiting {
    #[inline(always)]
    fn new() -> Self {
        Self { list: [(0, 0.0); WAITING], count: 0, more: Vec::new() }
    }

    /// Adds what is below those boxes of a node that were `met`, a bit each, the nearest last.
    #[inline(always)]
    fn add(&mut self, below: &[u32; LANES], near: &[f32; LANES], mut met: u64) {
        let bottom = self.count;
        while met != 0 {
            let lane = met.trailing_zeros() as usize % LANES;
            met &= met - 1;
            let entry = (below[lane], near[lane]);
            if self.count == WAITING {
                self.more.push(entry);
                continue;
            }
            let mut at = self.count;
            while at > bottom && self.list[at - 1].1 < entry.1 {
                self.list[at] = self.list[at - 1];
                at -= 1;
            }
            self.list[at] = entry;
            self.count += 1;
        }
    }

    #[inline(always)]
    fn next(&mut self) -> Option<(u32, f32)> {
        if let Some(last) = self.more.pop() {
            return Some(last);
        }
        self.count = self.count.checked_sub(1)?;
        Some(self.list[self.count % WAITING])
    }
}

/// The beam round a ray on each axis.
#[inline(always)]
fn slabs<S: Simd>(simd: S, ray: &Ray, extent: f32) -> [Slab<S>; 3] {
    // Enclose the ray in two lines on each axis.
    let axes = lanes::inlined(
        #[inline(always)]
        |v: Vec3| F32x8::from_slice(simd, &[v.x, v.y, v.z, 0.0, 0.0, 0.0, 0.0, 0.0]),
    );
    let lines = BeamLines::around(simd, axes(ray.origin), axes(ray.direction), extent);
    let (upper, lower) = (lines.inverse_upper_slope, lines.inverse_lower_slope);
    // The upper line meets a side sooner than the lower one if it rises. If only it rises, the beam
    // is flat and gets infinitely far before it leaves.
    let rises = upper.simd_gt(F32x8::splat(simd, 0.0));
    let sides = !rises.to_bitmask();

    // Choose the lines that enter and leave first, with rounding outwards.
    let (start, inverse) = (
        [
            rises.select(lines.upper_start, lines.lower_start),
            rises.select(lines.lower_start, lines.upper_start),
        ],
        [rises.select(upper, lower), rises.select(lanes::Lanes::abs(lower), upper)],
    );
    let inverse = [inverse[0] * (1.0 - beam::ROUNDING), inverse[1] * (1.0 + beam::ROUNDING)];

    // Spread each axis over all lanes.
    let [enter, leave] = [start[0].to_array(), start[1].to_array()];
    let [enter_inverse, leave_inverse] = [inverse[0].to_array(), inverse[1].to_array()];
    let wide = lanes::inlined(
        #[inline(always)]
        |value: f32| F32x8::splat(simd, value),
    );
    lanes::three(
        #[inline(always)]
        |k| Slab {
            side: (sides >> k & 1) as usize,
            start: [wide(enter[k]), wide(leave[k])],
            inverse: [wide(enter_inverse[k]), wide(leave_inverse[k])],
        },
    )
}

impl Node {
    /// Where a ray enters each box, and which it enters before `limit`, a bit each.
    #[inline(always)]
    fn entered<S: Simd>(&self, simd: S, slabs: &[Slab<S>; 3], limit: f32) -> (F32x8<S>, u64) {
        let (mut near, mut far) = (F32x8::splat(simd, 0.0), F32x8::splat(simd, limit));
        for (bounds, slab) in self.bounds.iter().zip(slabs) {
            let enters = F32x8::from_slice(simd, &bounds[slab.side & 1]) - slab.start[0];
            let leaves = F32x8::from_slice(simd, &bounds[!slab.side & 1]) - slab.start[1];
            near = lanes::Lanes::max(near, enters * slab.inverse[0]);
            far = lanes::Lanes::min(far, leaves * slab.inverse[1]);
        }
        (near, near.simd_le(far).to_bitmask())
    }
}

/// A leaf's places in [`Triangles`].
#[inline(always)]
fn range(places: &[u32; 2]) -> Range<usize> {
    places[0] as usize..places[1] as usize
}

/// The triangles of a leaf that a ray may meet, a bit each; those that are not there, too.
#[inline(always)]
fn may_meet<S: Simd>(simd: S, leaf: &Leaf, ray: &Ray) -> u64 {
    let [x, y, z] = ray.axes;
    let place = lanes::inlined(
        #[inline(always)]
        |corner: &[[f32; LANES]; 3]| {
            let away = lanes::inlined(
                #[inline(always)]
                |k: usize| F32x8::from_slice(simd, &corner[k]) - ray.origin[k],
            );
            let z = away(z);
            [away(x) - z * ray.shear.x, away(y) - z * ray.shear.y]
        },
    );
    !surely_beside(place(&leaf[0]), place(&leaf[1]), place(&leaf[2])).to_bitmask()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::Structure;
    use crate::raytrace::bvh::Bvh;
    use vitral_exec::Budget;
    use vitral_math::lanes::{available_levels, dispatch};
    use vitral_math::vec3;
    use vitral_scene::{World, builtin};

    /// Its triangles in their own order, and in a tree.
    fn teapot() -> (Triangles, Bvh) {
        let world = World::new(&builtin::scene("teapot").unwrap()).unwrap();
        let list = Triangles::of_world(&world, &Workers::single());
        let bvh = Bvh::build(&list, &Workers::single(), &Budget::default()).unwrap();
        (list, bvh)
    }

    #[test]
    fn every_instruction_set_finds_what_asking_all_triangles_finds() {
        let (list, bvh) = teapot();
        let wide = bvh.wide();
        let mut hits = 0;
        for i in 0..200u32 {
            let turn = |step: u32| (i * step % 97) as f32 / 48.0 - 1.0;
            let origin = vec3(turn(13), turn(29), turn(53)) * list.extent * 2.0;
            // Some go along an axis, or in a plane of two.
            let aim = vec3(turn(71), turn(37), turn(11)) * list.extent * 0.5;
            let direction = (aim - origin)
                * [vec3(1.0, 1.0, 1.0), vec3(0.0, 1.0, 1.0), vec3(0.0, 0.0, 1.0)][i as usize % 3];
            let ray = Ray::new(origin, direction);
            let expected = list.closest_hit(&ray, &mut Counters::default());
            hits += usize::from(expected.is_some());
            for (name, level) in available_levels() {
                let counters = &mut Counters::default();
                let found = dispatch!(level, simd => wide.closest_hit(simd, bvh.triangles(), (&ray, u32::MAX), counters));
                assert_eq!(
                    found.map(|(place, t)| (bvh.triangles().facets[place], t)),
                    expected,
                    "{name}, {ray:?}"
                );
            }
        }
        assert!(hits > 20, "{hits}");
    }

    #[test]
    fn a_tree_holds_each_triangle_once() {
        let (list, bvh) = teapot();
        let wide = bvh.wide();
        let mut next = 0;
        let mut runs = wide.places.clone();
        runs.sort_unstable();
        for [first, end] in runs {
            assert_eq!(first, next);
            next = end;
        }
        assert_eq!(next as usize, list.count());
        let below = wide
            .nodes
            .iter()
            .flat_map(|n| n.bounds[0][0].iter().zip(n.below))
            .filter(|(x, _)| x.is_finite());
        assert_eq!(below.count(), wide.leaves.len() + wide.nodes.len() - 1);
    }
}
