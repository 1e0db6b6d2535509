//! Rays on which light comes, or does not: what of it is left at their ends.
//!
//! Unlike a ray of sight such a ray need not know what it meets first: the first opaque thing ends
//! it, and transparent things take their part of the light in any order.
//!
//! A point found by arithmetic lies a hair off its surface, and its ray might meet the very surface
//! it leaves. The facet itself cannot hide its own points from a light in front of it, so it is
//! left out by its number; as its neighbours may, the ray starts as far above the facet as rounding
//! can have put things wrong (`rounding.rs`).
//!
//! Neighbours' rays go together, eight at a time (`raytrace/packet.rs`).
//!
//! In:   places, and ways from them, world space less the scene's middle. Out: the part of light
//!       that passes.
//! Cost: about `O(log n)` a ray.
//! Source: [Whitted 1980]. Departs from it: transparent things filter light without bending it.

use super::casters::{near, turned, wide};
use super::occluders::Occluders;
use super::places::SurfacePoint;
use super::rounding::{clearance, horizon};
use crate::raytrace::intersect::Ray;
use crate::raytrace::structures::AnyStructure;
use crate::raytrace::{Counters, packet};
use crate::{Execution, Session, Settings};
use vitral_exec::Limit;
use vitral_light::Rgb;
use vitral_math::lanes::{LANES, Level, Simd, dispatch};
use vitral_math::{DVec3, DVec4, Vec3};

/// See the module.
pub(crate) struct LightRays<'a> {
    structure: AnyStructure,
    occluders: Occluders<'a>,
    level: Level,
}

/// A ray from a place to a light.
pub(super) struct Feeler {
    ray: Ray,
    /// Parameter of the light.
    far: f32,
    /// Where the light is, homogeneous.
    light: DVec4,
    /// The facet that the ray leaves.
    own: u32,
    /// The number of the place.
    of: usize,
}

impl<'a> LightRays<'a> {
    /// Rays through the scene; `tests` is how many there are about, each with all triangles, where
    /// no structure helps.
    ///
    /// # Errors
    /// A limit of the budget.
    pub(super) fn new(
        session: &'a Session,
        settings: &Settings,
        execution: &Execution,
        (rays, what): (u64, &'static str),
    ) -> Result<Self, Limit> {
        let acceleration = settings.acceleration.unwrap_or_default();
        if acceleration.asks_all {
            execution
                .budget
                .check_work(rays.saturating_mul(u64::from(session.world.facet_count)), what)?;
        }
        let structure = AnyStructure::new(acceleration, session, execution)?;
        Ok(Self { structure, occluders: Occluders::new(session, settings), level: execution.level })
    }

    /// The scene's middle, world space: places count from it.
    pub(super) fn center(&self) -> DVec3 {
        self.structure.triangles().center
    }

    /// What passes from each of these places along its way, to the way's end or to infinity, into
    /// as many `parts`. Leaves in `feelers` the rays that were followed for it.
    pub(super) fn transmittance(
        &self,
        feelers: &mut Vec<Feeler>,
        ways: impl Iterator<Item = (SurfacePoint, DVec3)>,
        ends: bool,
        parts: &mut [Rgb],
    ) {
        feelers.clear();
        for (of, (place, way)) in ways.enumerate() {
            match self.feeler(&place, way, ends) {
                Ok((ray, far, light)) => {
                    feelers.push(Feeler { ray, far, light, own: place.facet, of })
                }
                Err(part) => parts[of] = part,
            }
        }
        dispatch!(self.level, simd => {
            for eight in feelers.chunks(LANES) {
                let left = self.left(simd, eight);
                eight.iter().zip(left).for_each(|(feeler, left)| parts[feeler.of] = left);
            }
        });
    }

    /// How high above a place's facet the end of a way has to be for a ray to find what is before
    /// it.
    pub(super) fn least_height(&self, place: &SurfacePoint, way: DVec3) -> f64 {
        let extent = f64::from(self.structure.triangles().extent);
        let horizon = horizon(place.position, (place.position + way).extend(1.0));
        clearance(place.position, extent).max(horizon)
    }

    /// The ray from a place along `way`, the parameter of its end, and the light, homogeneous; or
    /// what arrives, where that is known without one.
    fn feeler(
        &self,
        place: &SurfacePoint,
        way: DVec3,
        ends: bool,
    ) -> Result<(Ray, f32, DVec4), Rgb> {
        // Attached shadow; also a light in the facet's plane, or at the very place.
        let light = if ends { (place.position + way).extend(1.0) } else { way.extend(0.0) };
        if place.normal.dot(way) <= horizon(place.position, light) {
            return Err([0.0; 3]);
        }
        let above = clearance(place.position, f64::from(self.structure.triangles().extent));
        let origin = place.position + place.normal * above;
        let way = if ends { way - place.normal * above } else { way };
        let length = way.abs().max_element();
        let ray = Ray::new(origin.as_vec3(), (way * (1.0 / length)).as_vec3());
        if !ray.direction.is_finite() || ray.direction == Vec3::ZERO {
            return Err([1.0; 3]);
        }
        // What the light itself is fixed to does not hide it.
        Ok((ray, if ends { (length - above) as f32 } else { f32::INFINITY }, light))
    }

    /// What of the light of one to eight rays is left at their ends.
    #[inline(never)]
    fn left<S: Simd>(&self, simd: S, feelers: &[Feeler]) -> [Rgb; LANES] {
        let mut rays = [feelers[0].ray; LANES];
        let mut limits = [-1.0; LANES];
        for (lane, feeler) in feelers.iter().enumerate() {
            rays[lane] = feeler.ray;
            limits[lane] = if feeler.far < f32::MAX { feeler.far } else { f32::MAX };
        }
        let mut passing = Passing { rays: self, feelers, limits, left: [[1.0; 3]; LANES] };
        self.structure.follow(simd, &rays[..feelers.len()], &mut passing, &mut Counters::default());
        passing.left.map(|left| left.map(|part| part as f32))
    }
}

/// Follows rays until no light is left.
struct Passing<'a> {
    rays: &'a LightRays<'a>,
    feelers: &'a [Feeler],
    /// Parameters of the light; negative for rays of which nothing is left.
    limits: [f32; LANES],
    /// In double precision: rounded once, the product is the same in whatever order a structure
    /// shows the triangles.
    left: [[f64; 3]; LANES],
}

impl packet::PacketVisitor for Passing<'_> {
    // Every triangle on the way counts.
    const NEAREST_FIRST: bool = false;

    #[inline(always)]
    fn limits(&self) -> &[f32; LANES] {
        &self.limits
    }

    #[inline(always)]
    fn hit(&mut self, lane: usize, place: usize, t: f32) {
        let triangles = self.rays.structure.triangles();
        let (corners, facet) = (&triangles.corners[place], triangles.facets[place]);
        let Feeler { ray, far, light, own, .. } = &self.feelers[lane];
        if self.limits[lane] < 0.0 || facet == *own || t >= *far {
            return;
        }
        // A facet in whose plane the light lies does not hide it: a ray that grazes it seems to
        // meet it well before its end.
        if turned(&wide(corners), *light, near(*light, triangles.extent)) == 0 {
            return;
        }
        let point = || (ray.origin + ray.direction * t).as_dvec3();
        let passing = self.rays.occluders.transmittance(facet, corners, point);
        let [r, g, b] = passing.map(f64::from);
        let left = self.left[lane];
        self.left[lane] = [left[0] * r, left[1] * g, left[2] * b];
        if self.left[lane] == [0.0; 3] {
            self.limits[lane] = -1.0;
        }
    }
}
