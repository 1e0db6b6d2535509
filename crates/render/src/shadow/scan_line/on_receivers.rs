//! Shadow polygons: every polygon projected, from the light, on every polygon behind it.
//!
//! What a caster hides from the light is a solid. Where it meets the plane of a receiver it is the
//! caster's projection, and clipped by the receiver's edges it is the shadow polygon that lies on
//! it. A scan line finds the same polygon by its crossings with the solid's planes; here it is
//! found whole. Shadow polygons of several casters overlap. A face of a solid body that turns away
//! from the light lies in its own shadow and gets none; nor does what the light sees edge-on.
//!
//! In:   a light and triangles, world space less the scene's middle. Out: convex polygons, world
//!       space, each in the plane of its receiver and in its winding.
//! Cost: for each receiver the triangles between it and the light.
//! Source: [Bouknight & Kelley 1970], [Sutherland & Hodgman 1974].

use crate::prepare::mirrors;
use crate::raytrace::shaft::Shaft;
use crate::shadow::casters::{Casters, Solid, away, near, wide, winding_normal};
use crate::shadow::rounding::clearance;
use crate::{Execution, Session, Transparency};
use vitral_exec::Limit;
use vitral_math::{DVec3, DVec4};
use vitral_raster::BackFaces;

/// Receivers in one piece of work.
const RECEIVERS_A_JOB: usize = 256;
/// Pieces of work whose polygons wait to be handed on.
const JOBS_AT_ONCE: usize = 64;
/// A polygon smaller than this part of its receiver is rounding.
const SLIVER: f64 = 1e-12;

/// All triangles as receivers of one place of a light.
pub(super) struct Receivers<'a> {
    pub(super) session: &'a Session,
    pub(super) transparency: Transparency,
    pub(super) execution: &'a Execution,
    pub(super) casters: &'a Casters,
    pub(super) light: DVec4,
}

/// Polygons of several receivers.
#[derive(Debug, Default)]
struct Found {
    /// What each is, and where it ends among the corners.
    polygons: Vec<(&'static str, usize)>,
    corners: Vec<DVec3>,
}

impl Receivers<'_> {
    /// Calls `take` with what each polygon is and its corners, receiver by receiver in the order of
    /// the tree; ends early at a limit.
    pub(super) fn each(&self, take: &mut dyn FnMut(&'static str, &[DVec3])) {
        let world = &self.session.world;
        let workers = &self.execution.workers;
        let back_faces: Vec<_> = world
            .instances
            .iter()
            .map(|i| self.session.back_faces(i.mesh_index, self.transparency, workers))
            .collect();

        // Search some receivers at a time in parallel, and hand out what they found in order.
        let jobs = self.casters.triangles().count().div_ceil(RECEIVERS_A_JOB);
        for first in (0..jobs).step_by(JOBS_AT_ONCE) {
            let count = JOBS_AT_ONCE.min(jobs - first);
            for found in workers.map(count, |job| self.piece(first + job, &back_faces)) {
                let Ok(found) = found else { return };
                let mut start = 0;
                for (kind, end) in found.polygons {
                    take(kind, &found.corners[start..end]);
                    start = end;
                }
            }
        }
    }

    fn piece(&self, job: usize, back_faces: &[BackFaces<'_>]) -> Result<Found, Limit> {
        let (mut found, mut lists) = (Found::default(), [Vec::new(), Vec::new()]);
        let first = job * RECEIVERS_A_JOB;
        for t in first..self.casters.triangles().count().min(first + RECEIVERS_A_JOB) {
            self.execution.budget.check("shadow polygons")?;
            self.on(t, back_faces, &mut lists, &mut found);
        }
        Ok(found)
    }

    /// Finds the shadow polygons on a triangle.
    fn on(
        &self,
        receiver: usize,
        back_faces: &[BackFaces<'_>],
        lists: &mut [Vec<u32>; 2],
        found: &mut Found,
    ) {
        // Skip a receiver that faces away from the light.
        let triangles = self.casters.triangles();
        let corners = wide(&triangles.corners[receiver]);
        let winding = winding_normal(&corners);
        if !self.can_receive(receiver, -winding.dot(away(self.light, corners[0])), back_faces) {
            return;
        }

        // What touches the receiver, as its neighbours do, casts nothing on it: solids begin a
        // little behind their triangle.
        let position = corners.iter().fold(DVec3::ZERO, |m, c| m.max(c.abs()));
        let behind = clearance(position, f64::from(triangles.extent));
        let near = near(self.light, triangles.extent);
        // Clip the receiver to each caster's volume, which begins behind the caster.
        for (kind, caster) in self.before(receiver, &corners, lists) {
            let Some(mut solid) = Solid::new(&caster, self.light, near) else { continue };
            let (normal, at) = &mut solid.planes[0];
            *at += normal.normalize_or_zero() * behind;
            let shadow = clipped(&corners, &solid);
            let area = (2..shadow.len())
                .map(|i| winding_normal(&[shadow[0], shadow[i - 1], shadow[i]]))
                .sum::<DVec3>();
            // Keep polygons that are more than slivers.
            if area.length() > SLIVER * winding.length() {
                found.corners.extend(shadow.iter().map(|&c| c + triangles.center));
                found.polygons.push((kind, found.corners.len()));
            }
        }
    }

    /// Whether shadows can fall on a triangle, given the light's height above it by its winding:
    /// not on what the light sees edge-on, nor on faces of solid bodies that turn away from it.
    fn can_receive(&self, receiver: usize, height: f64, back_faces: &[BackFaces<'_>]) -> bool {
        if height == 0.0 || height.is_nan() {
            return false;
        }
        let (world, facet) = (&self.session.world, self.casters.triangles().facets[receiver]);
        let number = world.instance_of_facet(facet);
        let instance = &world.instances[number];
        let outside = if mirrors(&instance.world_from_model) { -height } else { height };
        !(outside < 0.0 && back_faces[number].drops(facet - instance.first_facet))
    }

    /// The triangles between a triangle and the light, each with the kind of its shadow; `lists` is
    /// workspace.
    fn before<'l>(
        &'l self,
        receiver: usize,
        corners: &[DVec3; 3],
        [opaque, filters]: &'l mut [Vec<u32>; 2],
    ) -> impl Iterator<Item = (&'static str, [DVec3; 3])> + 'l {
        let casters = self.casters;
        let triangles = casters.triangles();
        let own = triangles.facets[receiver];
        let (min, max) = (
            corners[0].min(corners[1]).min(corners[2]),
            corners[0].max(corners[1]).max(corners[2]),
        );
        let shaft = Shaft::between(min, max, self.light, triangles.extent);
        opaque.clear();
        filters.clear();
        casters.opaque_near(&shaft, opaque);
        casters.filters_near(&shaft, filters);
        let others = opaque.iter().filter(move |&&t| triangles.facets[t as usize] != own);
        let opaque = others.map(move |&t| ("shadow", wide(&triangles.corners[t as usize])));
        let filters = filters.iter().filter(move |&&t| casters.filter_facet(t) != own);
        opaque.chain(filters.map(move |&t| ("tinted-shadow", casters.filter(t))))
    }
}

/// The part of a triangle that lies in a solid.
fn clipped(corners: &[DVec3; 3], solid: &Solid) -> Vec<DVec3> {
    // Clip at each plane of the solid.
    let (mut polygon, mut kept) = (corners.to_vec(), Vec::new());
    for (normal, at) in solid.planes {
        kept.clear();
        for (i, &from) in polygon.iter().enumerate() {
            let to = polygon[(i + 1) % polygon.len()];
            let [start, end] = [from, to].map(|p| normal.dot(p - at));
            if start >= 0.0 {
                kept.push(from);
            }
            if (start >= 0.0) != (end >= 0.0) {
                kept.push(from + (to - from) * (start / (start - end)));
            }
        }
        std::mem::swap(&mut polygon, &mut kept);
    }
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    #[test]
    fn f21_the_shadow_of_a_triangle_is_its_projection() {
        let corners = [dvec3(-1.0, 1.0, -1.0), dvec3(1.0, 1.0, -1.0), dvec3(0.0, 1.0, 1.0)];
        let floor = [dvec3(-100.0, 0.0, -100.0), dvec3(0.0, 0.0, 100.0), dvec3(100.0, 0.0, -100.0)];
        let lamp = Solid::new(&corners, DVec4::new(0.0, 2.0, 0.0, 1.0), 1e-9).unwrap();
        let mut shadow = clipped(&floor, &lamp);
        shadow.sort_by(|a, b| a.z.total_cmp(&b.z).then(a.x.total_cmp(&b.x)));
        let expected = [dvec3(-2.0, 0.0, -2.0), dvec3(2.0, 0.0, -2.0), dvec3(0.0, 0.0, 2.0)];
        assert_eq!(shadow.len(), 3);
        assert!(shadow.iter().zip(expected).all(|(a, b)| a.distance(b) < 1e-12), "{shadow:?}");
        // What lies before the triangle is not in its shadow.
        let above = floor.map(|p| p + dvec3(0.0, 1.5, 0.0));
        assert!(clipped(&above, &lamp).len() < 3);
    }
}
