//! A hierarchy of bounding volumes over all triangles of a scene.
//!
//! Each node is a box round the two nodes below it; a ray that misses the box misses everything in
//! it. How the tree is cut is in `sah.rs`. Packets of eight rays go down it together (`packet.rs`),
//! all others down a tree with eight boxes a node that is made of it (`wide.rs`).
//!
//! In:   triangles. Out: [`Bvh`], with the triangles in the order of its leaves.
//! Cost: `O(n log n)` to build; 32 bytes a node, 40 a triangle, and up to 100 a triangle for eight
//!       boxes a node.
//! Source: [Rubin & Whitted 1980].

use super::beam::Beam;
use super::follow::{Follow, StructureUser};
use super::intersect::Ray;
use super::packet::{Packet, PacketVisitor};
use super::path::PartExtent;
use super::sah::{BYTES_A_TRIANGLE, BoxNode, SAH_DEPTH, build};
use super::triangles::Triangles;
use super::wide::Wide;
use super::{Counters, Probe, Structure, Tree, Visitor, space_step};
use crate::trace::{Passed, Step};
use crate::{Cached, Execution, Session};
use std::sync::{Arc, OnceLock};
use vitral_exec::{Budget, Limit, Workers};
use vitral_math::Vec3;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, LANES, Level, Mask8, Simd, dispatch};

/// 32 halvings of what is left below `SAH_DEPTH` end in a leaf.
const STACK: usize = SAH_DEPTH + 34;

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    nodes: Vec<BoxNode>,
    /// The same with eight boxes a node, once somebody went down it.
    wide: OnceLock<Wide>,
    triangles: Triangles,
}

/// Nodes that a packet goes down later, and where each ray enters them; infinite for those that
/// pass one by.
struct PacketStack {
    nodes: [(u32, [f32; LANES]); STACK],
    count: usize,
}

impl Cached for Bvh {
    type Key = ();
}

impl Bvh {
    /// The session's, built when first asked for: the views of a turntable share it.
    ///
    /// # Errors
    /// A limit of the budget.
    pub fn of(session: &Session, execution: &Execution) -> Result<Arc<Self>, Limit> {
        session.cache.get_or_build((), || {
            // The tree has its own list, in its own order: the common one need not stay for it.
            let list = Triangles::of_world(&session.world, &execution.workers);
            Self::build(&list, &execution.workers, &execution.budget)
        })
    }

    /// Bytes needed while a tree over this many triangles, or the tree with eight boxes a node, is
    /// built.
    pub fn bytes(triangles: u64) -> u64 {
        triangles * (BYTES_A_TRIANGLE + size_of::<[Vec3; 3]>() + 4 + Wide::BYTES) as u64
    }

    /// Builds the tree. The result does not depend on the number of workers.
    ///
    /// # Errors
    /// A limit of the budget.
    pub fn build(triangles: &Triangles, workers: &Workers, budget: &Budget) -> Result<Self, Limit> {
        let (nodes, order) = build(triangles, workers, budget)?;
        Ok(Self {
            nodes,
            wide: OnceLock::new(),
            triangles: triangles.reordered(order.iter().copied()),
        })
    }

    #[inline(always)]
    fn descend_together<S: Simd, V: PacketVisitor>(
        &self,
        simd: S,
        rays: &[Ray],
        visitor: &mut V,
        counters: &mut Counters,
    ) {
        // Enter the root.
        let Some(root) = self.nodes.first() else { return };
        let packet = Packet::new(simd, rays, self.triangles.extent);
        // Where each ray enters the node at hand; infinite for those that pass it by.
        let apart = F32x8::splat(simd, f32::INFINITY);
        let mut near = packet.live().select(packet.enters(simd, root.min, root.max), apart);
        counters.boxes += rays.len() as u64;
        let mut stack = PacketStack { nodes: [(0, [0.0; LANES]); STACK], count: 0 };

        // Walk the tree until nothing waits.
        let mut index = 0;
        loop {
            let wanted = near.simd_le(F32x8::from_slice(simd, visitor.limits()));
            let node = &self.nodes[index];

            // Test the triangles of a leaf, or open an inner node.
            let mut below = None;
            if !wanted.any_true() {
            } else if node.count > 0 {
                for place in node.link as usize..(node.link + node.count) as usize {
                    counters.triangles += u64::from(wanted.to_bitmask().count_ones());
                    packet.triangle((place, &self.triangles.corners[place]), wanted, visitor);
                }
            } else {
                counters.boxes += 2 * u64::from(wanted.to_bitmask().count_ones());
                below = self.open(simd, &packet, index, wanted, V::NEAREST_FIRST, &mut stack);
            }

            // Continue below, or with the node that waits on top of the stack.
            (index, near) = match below {
                Some(next) => next,
                None if stack.count == 0 => return,
                None => {
                    stack.count -= 1;
                    let (index, near) = &stack.nodes[stack.count];
                    (*index as usize, F32x8::from_slice(simd, near))
                }
            };
        }
    }

    /// The child of an inner node that is gone down first and where each of the `wanted` rays
    /// enters it, if any does. The other one is left for later.
    #[inline(always)]
    fn open<S: Simd>(
        &self,
        simd: S,
        packet: &Packet<'_, S>,
        index: usize,
        wanted: Mask8<S>,
        nearest_first: bool,
        stack: &mut PacketStack,
    ) -> Option<(usize, F32x8<S>)> {
        // Find where the rays enter both children.
        let apart = F32x8::splat(simd, f32::INFINITY);
        let (left, right) = (index + 1, index + self.nodes[index].link as usize);
        let (l, r) = (&self.nodes[left], &self.nodes[right]);
        let at_left = wanted.select(packet.enters(simd, l.min, l.max), apart);
        let at_right = wanted.select(packet.enters(simd, r.min, r.max), apart);
        match (at_left.simd_lt(apart).any_true(), at_right.simd_lt(apart).any_true()) {
            (false, false) => None,
            (true, false) => Some((left, at_left)),
            (false, true) => Some((right, at_right)),
            (true, true) => {
                // Descend first where more rays enter sooner.
                let sooner = |mask: Mask8<S>| mask.to_bitmask().count_ones();
                let left_first = !nearest_first
                    || sooner(at_right.simd_lt(at_left)) <= sooner(at_left.simd_lt(at_right));
                let (next, later) = if left_first {
                    ((left, at_left), (right, at_right))
                } else {
                    ((right, at_right), (left, at_left))
                };
                stack.nodes[stack.count] = (later.0 as u32, later.1.to_array());
                stack.count += 1;
                Some(next)
            }
        }
    }

    /// The tree for all but packets of rays.
    pub(super) fn wide(&self) -> &Wide {
        self.wide.get_or_init(|| Wide::new(&self.nodes, &self.triangles, &Workers::single()))
    }
}

impl Follow for Bvh {
    #[inline(always)]
    fn follow<S: Simd>(
        &self,
        simd: S,
        rays: &[Ray],
        visitor: &mut impl PacketVisitor,
        counters: &mut Counters,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.descend_together(simd, rays, visitor, counters),
        );
    }

    fn lend<U: StructureUser>(&self, user: U) -> U::Outcome {
        user.with_tree(self)
    }
}

impl Structure for Bvh {
    const REPEATS: bool = false;

    fn triangles(&self) -> &Triangles {
        &self.triangles
    }

    fn largest(&self, value: &dyn Fn(usize) -> f32) -> Vec<f32> {
        self.wide().largest(value)
    }

    fn step(&self) -> Option<Step> {
        let [min, max] = self.root()?.map(Vec3::from_array);
        Some(space_step(&self.triangles, [min, max], None))
    }

    fn names(&self, parts: &[u32]) -> Passed {
        Passed::Nodes(parts.to_vec())
    }

    fn part_count(&self) -> u32 {
        self.wide().part_count()
    }

    fn extents(&self, parts: &[u32]) -> Vec<PartExtent> {
        self.wide().extents(parts, self.triangles.center)
    }

    fn traverse(&self, beam: &Beam, visitor: &mut impl Visitor) -> u64 {
        self.descend(beam, visitor)
    }

    /// With the machine's best instruction set: it makes no difference to what is met.
    fn closest_hit_from(
        &self,
        ray: &Ray,
        own: u32,
        counters: &mut Counters,
    ) -> Option<(usize, f32)> {
        dispatch!(Level::new(), simd => self.wide().closest_hit(simd, &self.triangles, (ray, own), counters))
    }
}

impl Tree for Bvh {
    fn widen(&self, workers: &Workers) {
        self.wide.get_or_init(|| Wide::new(&self.nodes, &self.triangles, workers));
    }

    fn root(&self) -> Option<[[f32; 3]; 2]> {
        self.nodes.first().map(|root| [root.min, root.max])
    }

    #[inline(always)]
    fn descend_from(&self, near: f32, probe: &impl Probe, visitor: &mut impl Visitor) -> u64 {
        self.wide().descend_from(near, probe, visitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::triangles::bounds_of;
    use vitral_math::lanes::available_levels;
    use vitral_math::vec3;
    use vitral_scene::{World, builtin};

    fn build(name: &str, threads: usize) -> Bvh {
        let world = World::new(&builtin::scene(name).unwrap()).unwrap();
        let workers = Workers::new(threads);
        Bvh::build(&Triangles::of_world(&world, &workers), &workers, &Budget::default()).unwrap()
    }

    #[test]
    fn the_tree_does_not_depend_on_threads_and_holds_every_triangle_once() {
        let (one, three) = (build("teapot", 1), build("teapot", 3));
        assert!(one == three);
        let mut facets = one.triangles.facets.clone();
        facets.sort_unstable();
        assert!(facets.iter().copied().eq(0..facets.len() as u32));
        // Each box holds those below it, each leaf its triangles.
        let inside = |inner: [[f32; 3]; 2], outer: &BoxNode| {
            (0..3).all(|k| outer.min[k] <= inner[0][k] && inner[1][k] <= outer.max[k])
        };
        for (i, node) in one.nodes.iter().enumerate() {
            if node.count == 0 {
                for child in [i + 1, i + node.link as usize] {
                    assert!(inside([one.nodes[child].min, one.nodes[child].max], node));
                }
            }
            for place in node.link..node.link + node.count {
                let [min, max] = bounds_of(&one.triangles.corners[place as usize]);
                assert!(inside([min.to_array(), max.to_array()], node));
            }
        }
    }

    #[test]
    fn coinciding_and_no_triangles_make_a_tree_too() {
        let corners = [vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 1.0), vec3(0.0, 1.0, 1.0)];
        for count in [0u32, 1, 100, 5000] {
            let triangles = Triangles {
                extent: 1.0,
                corners: vec![corners; count as usize],
                facets: (0..count).collect(),
                ..Triangles::default()
            };
            let bvh = Bvh::build(&triangles, &Workers::single(), &Budget::default()).unwrap();
            assert_eq!(bvh.triangles.count(), count as usize);
            let hit =
                bvh.closest_hit(&Ray::new(vec3(0.2, 0.3, -1.0), Vec3::Z), &mut Counters::default());
            assert_eq!(hit, (count > 0).then_some((0, 2.0)), "the lowest of equals");
        }
    }

    /// Numbers without pattern from -1 to 1.
    fn random(state: &mut u32) -> f32 {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (*state >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    #[test]
    fn rays_together_meet_what_each_meets_alone() {
        let world = World::new(&builtin::scene("teapot").unwrap()).unwrap();
        let triangles = Triangles::of_world(&world, &Workers::single());
        let bvh = Bvh::build(&triangles, &Workers::single(), &Budget::default()).unwrap();
        let (size, mut state, mut hits) = (triangles.extent, 3, 0);
        for packet in 0..600 {
            // Bundles side by side, bundles from one point, and rays that have nothing in common;
            // some packets are not full.
            let mut vector =
                || vec3(random(&mut state), random(&mut state), random(&mut state)) * size;
            let (from, to) = (vector() * 2.0, vector() * 0.5);
            let rays: Vec<Ray> = (0..1 + packet % 8)
                .map(|_| match packet % 3 {
                    0 => Ray::new(from + vector() * 0.1, to - from),
                    1 => Ray::new(from, to + vector() * 0.1 - from),
                    _ => Ray::new(vector() * 2.0, vector()),
                })
                .collect();
            let mut alone = Counters::default();
            let first: Vec<_> =
                rays.iter().map(|r| bvh.closest_hit_from(r, u32::MAX, &mut alone)).collect();
            // Leaving what was met, each ray meets the next.
            let own: Vec<u32> = first
                .iter()
                .map(|hit| hit.map_or(u32::MAX, |(p, _)| bvh.triangles().facets[p]))
                .collect();
            let second: Vec<_> = rays
                .iter()
                .zip(&own)
                .map(|(r, own)| bvh.closest_hit_from(r, *own, &mut alone))
                .collect();
            for (_, level) in available_levels() {
                let mut together = Counters::default();
                let nobody = [u32::MAX; LANES];
                let (a, b) = dispatch!(level, simd => (
                    bvh.closest_hits(simd, &rays, &nobody, &mut together).0,
                    bvh.closest_hits(simd, &rays, &own, &mut together).0
                ));
                assert_eq!(
                    (&a[..rays.len()], &b[..rays.len()]),
                    (&first[..], &second[..]),
                    "packet {packet}"
                );
            }
            hits += second.iter().flatten().count();
        }
        assert!(hits > 500, "{hits}");
    }
}
