//! Following rays that begin at surfaces, through any structure: mirrored and bent rays, and rays
//! to lights.
//!
//! The tree of boxes takes eight rays at a time (`packet.rs`), every other structure one after the
//! other. A structure says which by implementing [`Follow`] in its own file.
//!
//! In:   one to eight rays in the space of the structure's triangles. Out: triangles that they hit.
//! Cost: that of the structure.

use super::beam::Beam;
use super::intersect::Ray;
use super::packet::{PacketVisitor, closest_hits};
use super::{Counters, Structure, Tree, Visitor};
use vitral_math::lanes::{LANES, Simd};

/// A structure that rays can be followed through.
pub(crate) trait Follow: Structure + Sized {
    /// Shows `visitor` what one to eight rays meet, each triangle once.
    #[inline(always)]
    fn follow<S: Simd>(
        &self,
        _: S,
        rays: &[Ray],
        visitor: &mut impl PacketVisitor,
        counters: &mut Counters,
    ) {
        one_by_one(self, rays, visitor, counters);
    }

    /// [`Structure::closest_hit_from`] for one to eight rays, which leave the facets `own`; and
    /// whether they hit something else at the same place, as far as rounding tells.
    #[inline(never)]
    fn closest_hits<S: Simd>(
        &self,
        simd: S,
        rays: &[Ray],
        own: &[u32],
        counters: &mut Counters,
    ) -> ([Option<(usize, f32)>; LANES], [bool; LANES]) {
        closest_hits(
            self.triangles(),
            rays,
            own,
            #[inline(always)]
            |closest| self.follow(simd, rays, closest, counters),
        )
    }

    /// Runs code that is written for any structure, or for any tree if this is one.
    fn lend<U: StructureUser>(&self, user: U) -> U::Outcome {
        user.with_structure(self)
    }
}

/// Code that is written for any structure.
pub(crate) trait StructureUser {
    /// What it makes.
    type Outcome;

    /// Runs with a structure.
    fn with_structure<T: Structure>(self, structure: &T) -> Self::Outcome;

    /// Runs with a structure that any probe can go down.
    fn with_tree<T: Tree>(self, tree: &T) -> Self::Outcome;
}

/// Shows a packet's visitor what each ray of it meets.
fn one_by_one<T: Structure>(
    structure: &T,
    rays: &[Ray],
    visitor: &mut impl PacketVisitor,
    counters: &mut Counters,
) {
    let triangles = structure.triangles();
    let mut hit = Vec::new();
    for (lane, ray) in rays.iter().enumerate() {
        let mut alone = Alone::<T, _> { structure, ray, lane, visitor, hit: &mut hit, tests: 0 };
        counters.boxes += structure.traverse(&Beam::around(ray, triangles.extent), &mut alone);
        counters.triangles += alone.tests;
        hit.clear();
    }
}

/// One ray of a packet, whose visitor is told what it hits.
struct Alone<'a, T, V> {
    structure: &'a T,
    ray: &'a Ray,
    lane: usize,
    visitor: &'a mut V,
    /// Places of the triangles that it was told of, where the structure shows some again.
    hit: &'a mut Vec<usize>,
    tests: u64,
}

impl<T: Structure, V: PacketVisitor> Visitor for Alone<'_, T, V> {
    #[inline(always)]
    fn skips(&self, _: usize, near: f32) -> bool {
        self.done(near)
    }

    #[inline(always)]
    fn done(&self, near: f32) -> bool {
        near > self.visitor.limits()[self.lane]
    }

    #[inline(always)]
    fn triangle(&mut self, place: usize) {
        self.tests += 1;
        let Some(t) = self.ray.hit(&self.structure.triangles().corners[place]) else { return };
        if T::REPEATS {
            if self.hit.contains(&place) {
                return;
            }
            self.hit.push(place);
        }
        self.visitor.hit(self.lane, place, t);
    }
}
