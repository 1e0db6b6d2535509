//! What every structure over triangles can do, and who it shows them to.

use super::beam::Beam;
use super::intersect::Ray;
use super::path::PartExtent;
use super::probe::Probe;
use super::triangles::Triangles;
use crate::trace::{Passed, Step};
use vitral_exec::Workers;
use vitral_math::Vec3;

/// Decides what a traversal does.
pub trait Visitor {
    /// Whether nothing of `part` is wanted, if it is entered no sooner than at `near`.
    fn skips(&self, part: usize, near: f32) -> bool;
    /// Whether nothing of any part is wanted that is entered no sooner than at `near`.
    fn done(&self, near: f32) -> bool;
    /// A triangle near the ray, by its place in [`Structure::triangles`].
    fn triangle(&mut self, place: usize);
    /// The ray goes through `part`: a node that is opened, a cell of a grid whether or not
    /// something is in it.
    #[inline(always)]
    fn passes(&mut self, _part: usize) {}
}

/// Keeps the parts that rays go through, for who looks on; another visitor decides.
pub(crate) struct Watched<'v> {
    pub(crate) visitor: &'v mut dyn Visitor,
    pub(crate) passed: &'v mut Vec<u32>,
}

impl Visitor for Watched<'_> {
    fn skips(&self, part: usize, near: f32) -> bool {
        self.visitor.skips(part, near)
    }

    fn done(&self, near: f32) -> bool {
        self.visitor.done(near)
    }

    fn triangle(&mut self, place: usize) {
        self.visitor.triangle(place);
    }

    fn passes(&mut self, part: usize) {
        self.passed.push(part as u32);
    }
}

/// Finds the triangles near a ray.
pub trait Structure: Sync {
    /// Whether a traversal may show a triangle several times.
    const REPEATS: bool;

    /// The triangles, in the structure's order.
    fn triangles(&self) -> &Triangles;

    /// For each part the largest value of the triangles in it; -∞ for an empty one.
    fn largest(&self, value: &dyn Fn(usize) -> f32) -> Vec<f32>;

    /// The step that tells what space the parts divide; none where there are none.
    fn step(&self) -> Option<Step>;

    /// The names of parts, those above a part before it.
    fn names(&self, parts: &[u32]) -> Passed;

    /// How many parts there are; 0 where there is no structure.
    fn part_count(&self) -> u32;

    /// Where parts are and what they hang below, those above a part before it, in the order given.
    fn extents(&self, parts: &[u32]) -> Vec<PartExtent>;

    /// Shows `visitor` the triangles of all parts that the beam meets and it does not skip. Returns
    /// the number of boxes or cells looked at.
    fn traverse(&self, beam: &Beam, visitor: &mut impl Visitor) -> u64;

    /// The first triangle that the ray (less [`Triangles::center`]) meets: facet and parameter; the
    /// lower facet of two at the same place. Adds what it took to `counters`.
    fn closest_hit(&self, ray: &Ray, counters: &mut Counters) -> Option<(u32, f32)> {
        self.closest_hit_from(ray, u32::MAX, counters)
            .map(|(place, t)| (self.triangles().facets[place], t))
    }

    /// [`Self::closest_hit`] of a ray that leaves the facet `own`, which it cannot meet again: the
    /// triangle's place in [`Self::triangles`] and the parameter.
    fn closest_hit_from(
        &self,
        ray: &Ray,
        own: u32,
        counters: &mut Counters,
    ) -> Option<(usize, f32)> {
        let triangles = self.triangles();
        let slack = ray.rounding(triangles.extent);
        let mut closest = ClosestHit { triangles, ray, own, slack, best: None, tests: 0 };
        counters.boxes += self.traverse(&Beam::around(ray, triangles.extent), &mut closest);
        counters.triangles += closest.tests;
        closest.best
    }
}

/// A structure of boxes within boxes, which any probe can go down.
pub trait Tree: Structure {
    /// Builds, with all of `workers`, what probes but packets of rays go down, unless it is there.
    /// Without this, who goes down it first builds it alone.
    fn widen(&self, _: &Workers) {}

    /// The box round everything; `None` if there is nothing.
    fn root(&self) -> Option<[[f32; 3]; 2]>;

    /// [`Tree::descend`] below the root, which the probe enters at `near`; boxes looked at besides
    /// the root.
    fn descend_from(&self, near: f32, probe: &impl Probe, visitor: &mut impl Visitor) -> u64;

    /// [`Structure::traverse`] with any probe.
    #[inline(always)]
    fn descend(&self, probe: &impl Probe, visitor: &mut impl Visitor) -> u64 {
        let Some([min, max]) = self.root() else { return 0 };
        // No closure, which would not have the probe's instruction set if it were not inlined.
        match probe.enters(min, max) {
            Some(near) => 1 + self.descend_from(near, probe, visitor),
            None => 1,
        }
    }
}

/// The step that tells the space of a structure, a box less [`Triangles::center`].
pub(crate) fn space_step(
    triangles: &Triangles,
    [min, max]: [Vec3; 2],
    cells: Option<[u32; 3]>,
) -> Step {
    let [min, max] = [min, max].map(|p| (p.as_dvec3() + triangles.center).to_array());
    Step::Space { min, max, cells }
}

/// What following rays took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Boxes or cells that were tested.
    pub boxes: u64,
    /// Triangles that were tested.
    pub triangles: u64,
}

/// Keeps the closest hit.
struct ClosestHit<'a> {
    triangles: &'a Triangles,
    ray: &'a Ray,
    /// The facet that the ray leaves.
    own: u32,
    /// Rounding of a hit's parameter.
    slack: f32,
    /// Position of the triangle in the structure's list, and the parameter of the hit.
    best: Option<(usize, f32)>,
    tests: u64,
}

impl Visitor for ClosestHit<'_> {
    #[inline(always)]
    fn skips(&self, _: usize, near: f32) -> bool {
        self.done(near)
    }

    #[inline(always)]
    fn done(&self, near: f32) -> bool {
        self.best.is_some_and(|(_, t)| near > t + self.slack)
    }

    #[inline(always)]
    fn triangle(&mut self, place: usize) {
        self.tests += 1;
        let Some(t) = self.ray.hit(&self.triangles.corners[place]) else { return };
        if self.triangles.replaces(self.best, (place, t), self.own) {
            self.best = Some((place, t));
        }
    }
}
