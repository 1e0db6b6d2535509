//! The volumes that hide one place of a light: their sides, found again by a tree, and their caps.

use super::edges::{CasterSurface, VolumeSide, turned_all};
use crate::Execution;
use crate::raytrace::bvh::Bvh;
use crate::raytrace::triangles::Triangles;
use crate::raytrace::{Probe, Structure, Tree};
use crate::shadow::Drawn;
use crate::shadow::casters::{Casters, away, box_around, collect, near, wide};
use crate::shadow::sources::Emitter;
use vitral_exec::Limit;
use vitral_math::{DVec3, Vec3};

/// Sides in one leaf of a tree.
const RUN: usize = 8;

/// The volumes of one place of a light.
#[derive(Debug)]
pub(super) struct LightVolumes {
    pub(super) from: Emitter,
    /// For each triangle whether its winding turns it towards the light, 1, or away, -1.
    pub(super) turned: Vec<i8>,
    pub(super) sides: Vec<VolumeSide>,
    /// Over runs of sides.
    tree: Bvh,
}

impl LightVolumes {
    pub(super) fn new(
        from: Emitter,
        triangles: &Triangles,
        surface: &CasterSurface,
        execution: &Execution,
    ) -> Result<Self, Limit> {
        let light = from.at;

        // Turn each triangle towards the light and find the silhouette's sides.
        execution.budget.check("shadow volumes")?;
        let turned =
            turned_all(light, near(light, triangles.extent), triangles, &execution.workers);
        let sides = surface.sides(light, &turned, triangles, &execution.workers);
        // A tree over runs of sides: neighbours in the list mostly are neighbours in space. A box
        // is a triangle, too.
        let runs = || sides.chunks(RUN);
        let around = |run: &[VolumeSide]| {
            let (middle, half) = box_around(run.iter().flat_map(|s| [s.a, s.b]), 0.0);
            let [min, max] = [middle - half, middle + half].map(|p: DVec3| -> Vec3 { p.as_vec3() });
            [min, max, max]
        };
        let boxes = Triangles {
            corners: runs().map(around).collect(),
            facets: (0..runs().len() as u32).collect(),
            ..*triangles
        };

        // Build the tree and charge what it takes.
        let bytes =
            sides.len() as u64 * size_of::<VolumeSide>() as u64 + Bvh::bytes(sides.len() as u64);
        execution.budget.charge(bytes, "shadow volumes")?;
        execution.budget.release(bytes);
        let tree = Bvh::build(&boxes, &execution.workers, &execution.budget)?;
        tree.widen(&execution.workers);
        Ok(Self { from, turned, sides, tree })
    }

    /// Appends the sides near a probe.
    pub(super) fn sides_near(&self, probe: &impl Probe, list: &mut Vec<u32>) {
        let mut runs = Vec::new();
        collect(&self.tree, probe, &mut runs);
        let (of_place, count) = (&self.tree.triangles().facets, self.sides.len());
        let run = |&place: &u32| {
            let first = of_place[place as usize] as usize * RUN;
            (first..count.min(first + RUN)).map(|s| s as u32)
        };
        list.extend(runs.iter().flat_map(run));
    }

    /// Hands on caps and sides, cut where the scene is well left behind.
    pub(super) fn draw(
        &self,
        light: usize,
        casters: &Casters,
        triangles: &Triangles,
        take: &mut dyn FnMut(Drawn<'_>),
    ) {
        // Extend volumes well beyond the scene.
        let reach = f64::from(triangles.extent) * 2.0;
        let beyond = |p: DVec3| p + away(self.from.at, p).normalize_or_zero() * reach;
        let mut hand = |kind: &'static str, corners: &[DVec3]| {
            let corners: Vec<DVec3> = corners.iter().map(|&c| c + triangles.center).collect();
            take(Drawn { light, kind, facet: None, corners: &corners });
        };
        // Outwards: the near cap towards the light, the far cap away from it.
        let casting =
            || (0..self.turned.len()).filter(|&i| casters.opaque[i] && self.turned[i] != 0);
        let towards = |i: usize| {
            let [a, b, c] = wide(&triangles.corners[i]);
            if self.turned[i] > 0 { [a, b, c] } else { [a, c, b] }
        };

        // Emit the near caps, the far caps and the sides.
        casting().for_each(|i| hand("near-cap", &towards(i)));
        for i in casting() {
            let [a, b, c] = towards(i).map(beyond);
            hand("far-cap", &[a, c, b]);
        }
        for side in &self.sides {
            // Its normal points inwards where volumes begin. As often as volumes have it in common.
            let (p, q) = if side.multiplicity > 0 { (side.a, side.b) } else { (side.b, side.a) };
            (0..side.multiplicity.abs()).for_each(|_| hand("side", &[p, q, beyond(q), beyond(p)]));
        }
    }
}
