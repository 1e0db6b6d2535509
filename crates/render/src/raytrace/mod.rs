//! Rays: what they meet, and the structures that find it.
//!
//! A structure knows where triangles are, so that a ray need not ask each of them: a tree of boxes round neighbours
//! ([`bvh`]), a cube cut in eight again and again ([`octree`]), a box cut in two ([`bsp`]), a grid of equal cells ([`grid`]), a
//! volume round each object ([`volumes`]), or nothing but the list ([`triangles`]). Whoever follows a ray is a [`Visitor`]: the structure shows it the triangles near the ray, part
//! by part, about the nearest first; the visitor says which parts it can do without. All structures give the same hits.

pub mod beam;
pub mod bsp;
pub mod bvh;
pub(crate) mod follow;
pub mod grid;
pub mod intersect;
pub mod octree;
pub(crate) mod packet;
pub mod pyramid;
pub mod shaft;
pub mod structures;
pub mod triangles;
pub mod volumes;
mod wide;

use crate::trace::{Passed, Step};
use beam::Beam;
use intersect::Ray;
use triangles::Triangles;
use vitral_exec::Workers;
use vitral_math::Vec3;
use vitral_math::lanes::LANES;

/// Eight boxes side by side: for each axis the least and the largest coordinates. Nothing meets a box whose least are
/// greater than its largest.
pub type Boxes = [[[f32; LANES]; 2]; 3];

/// Something that boxes are tested against: a ray, a beam, rays through a block of pixels.
pub trait Probe {
    /// A parameter that no place common to probe and box goes below; `None` if they are apart.
    fn enters(&self, min: [f32; 3], max: [f32; 3]) -> Option<f32>;

    /// The same for eight boxes: a parameter each, and which are met, a bit each.
    #[inline(always)]
    fn enters_each(&self, boxes: &Boxes) -> ([f32; LANES], u64) {
        let (mut near, mut met) = ([0.0; LANES], 0);
        for lane in 0..LANES {
            let [min, max] = [0, 1].map(|side| [0, 1, 2].map(|k| boxes[k][side][lane]));
            // A probe need not notice that a box is empty.
            if min[0] <= max[0]
                && let Some(at) = self.enters(min, max)
            {
                near[lane] = at;
                met |= 1 << lane;
            }
        }
        (near, met)
    }
}

/// Decides what a traversal does.
pub trait Visitor {
    /// Whether nothing of `part` is wanted, if it is entered no sooner than at `near`.
    fn skips(&self, part: usize, near: f32) -> bool;
    /// Whether nothing of any part is wanted that is entered no sooner than at `near`.
    fn done(&self, near: f32) -> bool;
    /// A triangle near the ray, by its place in [`Structure::triangles`].
    fn triangle(&mut self, place: usize);
    /// The ray goes through `part`: a node that is opened, a cell of a grid whether or not something is in it.
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

    /// Shows `visitor` the triangles of all parts that the beam meets and it does not skip. Returns the number of boxes
    /// or cells looked at.
    fn traverse(&self, beam: &Beam, visitor: &mut impl Visitor) -> u64;

    /// The first triangle that the ray (less [`Triangles::center`]) meets: facet and parameter; the lower facet of two
    /// at the same place. Adds what it took to `counters`.
    fn closest_hit(&self, ray: &Ray, counters: &mut Counters) -> Option<(u32, f32)> {
        self.closest_hit_from(ray, u32::MAX, counters).map(|(place, t)| (self.triangles().facets[place], t))
    }

    /// [`Self::closest_hit`] of a ray that leaves the facet `own`, which it cannot meet again: the triangle's place in
    /// [`Self::triangles`] and the parameter.
    fn closest_hit_from(&self, ray: &Ray, own: u32, counters: &mut Counters) -> Option<(usize, f32)> {
        let triangles = self.triangles();
        let slack = ray.rounding(triangles.extent);
        let mut closest = Closest { triangles, ray, own, slack, best: None, tests: 0 };
        counters.boxes += self.traverse(&Beam::around(ray, triangles.extent), &mut closest);
        counters.triangles += closest.tests;
        closest.best
    }
}

/// A structure of boxes within boxes, which any probe can go down.
pub trait Tree: Structure {
    /// Builds, with all of `workers`, what probes but packets of rays go down, unless it is there. Without this, who goes down it
    /// first builds it alone.
    fn widen(&self, _: &Workers) {}

    /// The box round everything; `None` if there is nothing.
    fn root(&self) -> Option<[[f32; 3]; 2]>;

    /// [`Tree::descend`] below the root, which the probe enters at `near`; boxes looked at besides the root.
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
fn space_step(triangles: &Triangles, [min, max]: [Vec3; 2], cells: Option<[u32; 3]>) -> Step {
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
struct Closest<'a> {
    triangles: &'a Triangles,
    ray: &'a Ray,
    /// The facet that the ray leaves.
    own: u32,
    /// Rounding of a hit's parameter.
    slack: f32,
    best: Option<(usize, f32)>,
    tests: u64,
}

impl Visitor for Closest<'_> {
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
