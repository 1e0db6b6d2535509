//! The list of triangles as a structure that is none: it shows every triangle to every ray, the
//! `O(n p)` that other structures are measured against.
//!
//! In:   triangles. Out: all of them.
//! Cost: linear in the triangles for each ray.
//! Source: [Appel 1968].

use super::beam::Beam;
use super::follow::Follow;
use super::path::PartExtent;
use super::triangles::Triangles;
use super::{Structure, Visitor};
use crate::trace::{Passed, Step};

impl Follow for Triangles {}

impl Structure for Triangles {
    const REPEATS: bool = false;

    fn triangles(&self) -> &Triangles {
        self
    }

    fn largest(&self, value: &dyn Fn(usize) -> f32) -> Vec<f32> {
        vec![(0..self.count()).map(value).fold(f32::NEG_INFINITY, f32::max)]
    }

    fn step(&self) -> Option<Step> {
        None
    }

    fn names(&self, _: &[u32]) -> Passed {
        Passed::Nowhere
    }

    fn part_count(&self) -> u32 {
        0
    }

    fn extents(&self, _: &[u32]) -> Vec<PartExtent> {
        Vec::new()
    }

    fn traverse(&self, _: &Beam, visitor: &mut impl Visitor) -> u64 {
        (0..self.count()).for_each(|place| visitor.triangle(place));
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::Counters;
    use crate::raytrace::intersect::Ray;
    use vitral_exec::Workers;
    use vitral_math::Vec3;
    use vitral_scene::{Scene, World, builtin};

    #[test]
    fn every_triangle_is_asked_and_the_nearest_wins() {
        let mut mesh = builtin::solids::tetrahedron(1.0);
        mesh.positions[0][1] = f32::NAN;
        let world = World::new(&Scene::from_mesh(mesh)).unwrap();
        let list = Triangles::of_world(&world, &Workers::single());
        assert_eq!(list.count(), 1, "three of the four have the broken corner");
        let middle = list.corners[0].iter().copied().sum::<Vec3>() / 3.0;
        let mut counters = Counters::default();
        let hit = list.closest_hit(&Ray::new(middle * 3.0, -middle), &mut counters);
        assert!(
            hit.is_some_and(|(facet, t)| facet == list.facets[0] && (t - 2.0).abs() < 1e-5),
            "{hit:?}"
        );
        assert_eq!(counters, Counters { boxes: 0, triangles: 1 });
    }
}
