//! What stands between a point and a light: the first facet on the way, for whoever wants to know
//! who casts a shadow.
//!
//! No structure is needed for one ray: runs of triangles are rejected by their boxes, and the
//! triangles of the others are met one by one, in double precision.
//!
//! In:   a place, a light. Out: the facet, and how far away it is.
//! Cost: a box test for each run of triangles of the scene.
//! Source: \[Möller & Trumbore 1997\].

use super::{Occluders, SurfacePoint, clearance, facet};
use crate::Session;
use crate::raytrace::triangles::Triangles;
use std::ops::Range;
use vitral_light::{Light, LightKind};
use vitral_math::{Aabb, DMat4, DVec3};
use vitral_scene::{Instance, TRIANGLES_A_RUN};

/// A facet on the way to a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Blocker {
    pub facet: u32,
    /// How far it is from the point, world space.
    pub distance: f64,
}

/// A way through the scene: the points `origin + t way`, world space less the scene's middle.
struct Feeler {
    origin: DVec3,
    way: DVec3,
    reach: Range<f64>,
    own: u32,
}

/// The first facet that keeps light of `light` from `place`; on the way to its middle, if it has a
/// shape. `None` for ambient light and where nothing stands.
pub(crate) fn blocker(
    session: &Session,
    occluders: &Occluders<'_>,
    light: &Light,
    place: &SurfacePoint,
) -> Option<Blocker> {
    // Aim at the light, or along the way its light comes.
    let world = &session.world;
    let center = Triangles::center_of(world);
    let to = |at: DVec3| (at - center - place.position, 1.0);
    let (way, end) = match &light.kind {
        LightKind::Ambient => return None,
        LightKind::Directional { direction } => (-direction.normalize_or_zero(), f64::INFINITY),
        LightKind::Point { position } | LightKind::Spot { position, .. } => to(*position),
        LightKind::Area { shape } => to(shape.middle()),
    };

    // Lift the origin off the surface, as shadow rays do.
    let size = world.bounds.size().max_element() * 0.5;
    let origin = place.position + place.normal * clearance(place.position, size);
    let mut feeler = Feeler { origin, way, reach: 0.0..end, own: place.facet };

    // Search all facets for the nearest that keeps light.
    let mut found = None;
    for instance in &world.instances {
        for run in feeler.runs(instance, &world.run_bounds[instance.mesh_index as usize], center) {
            for triangle in run {
                let (corners, _) = facet(instance, triangle, center);
                let number = instance.first_facet + triangle;
                let Some(t) = feeler.meets(number, &corners) else { continue };
                let passing = || origin + feeler.way * t;
                if occluders.transmittance(number, &corners.map(DVec3::as_vec3), passing)
                    != [1.0; 3]
                {
                    feeler.reach.end = t;
                    found = Some(Blocker { facet: number, distance: t * way.length() });
                }
            }
        }
    }
    found
}

impl Feeler {
    /// The runs of an instance's triangles whose boxes it passes.
    fn runs(&self, instance: &Instance, bounds: &[Aabb], center: DVec3) -> Vec<Range<u32>> {
        // Bring the ray to the instance's space.
        let count = instance.mesh.triangles.len();
        let inverse = (DMat4::from_translation(-center) * instance.world_from_model).inverse();
        let (origin, way) =
            (inverse.transform_point3(self.origin), inverse.transform_vector3(self.way));
        let known = origin.is_finite() && way.is_finite();
        let passes = |bounds: &Aabb| {
            // A hair more than the box, for what rounding moved out of it.
            let slack = DVec3::splat(
                1e-5 * (bounds.size().max_element() + origin.abs().max_element() * 1e-3),
            );
            let [a, b] =
                [bounds.min - slack, bounds.max + slack].map(|corner| (corner - origin) / way);
            let (mut enter, mut leave) = (self.reach.start, self.reach.end);
            // Intersect the ray with the two planes of each axis.
            for axis in 0..3 {
                if way[axis] == 0.0 {
                    let is_beside = origin[axis] < bounds.min[axis] - slack[axis]
                        || origin[axis] > bounds.max[axis] + slack[axis];
                    leave = if is_beside { f64::NEG_INFINITY } else { leave };
                } else {
                    enter = enter.max(a[axis].min(b[axis]));
                    leave = leave.min(a[axis].max(b[axis]));
                }
            }
            !bounds.is_empty() && enter <= leave
        };

        // Keep the runs whose box the ray meets.
        let runs = (0..count.div_ceil(TRIANGLES_A_RUN))
            .filter(|&run| !known || bounds.get(run).is_none_or(passes));
        runs.map(|run| {
            (run * TRIANGLES_A_RUN) as u32..((run + 1) * TRIANGLES_A_RUN).min(count) as u32
        })
        .collect()
    }

    /// The parameter at which it meets a facet other than its own, within reach.
    fn meets(&self, facet: u32, [a, b, c]: &[DVec3; 3]) -> Option<f64> {
        let (e1, e2) = (*b - *a, *c - *a);
        let p = self.way.cross(e2);
        let determinant = e1.dot(p);
        if determinant == 0.0 || facet == self.own {
            return None;
        }
        let from = self.origin - *a;
        let u = from.dot(p) / determinant;
        let q = from.cross(e1);
        let (v, t) = (self.way.dot(q) / determinant, e2.dot(q) / determinant);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > self.reach.start && t < self.reach.end)
            .then_some(t)
    }
}
