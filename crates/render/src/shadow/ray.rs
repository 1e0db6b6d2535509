//! Shadows by rays: a point is lit if nothing stands on the way from it to the light. The reference of the others.
//!
//! From each visible point a ray goes towards each light, and a structure (`--acceleration`) shows it what stands near. Unlike a ray of
//! sight it need not know what it meets first: the first opaque thing ends it, and transparent things take their part of the
//! light in any order.
//!
//! A point found by arithmetic lies a hair off its surface, and its ray might meet the very surface it leaves. The facet
//! itself cannot hide its own points from a light in front of it, so it is left out by its number; as its neighbours may,
//! the ray starts as far above the facet as rounding can have put things wrong (`rounding.rs`).
//!
//! Neighbours' rays to one light go together, eight at a time (`raytrace/packet.rs`).
//!
//! In:   points on facets, world space less the scene's middle; lights. Out: the part of light that arrives.
//! Cost: a ray for each point and light (or cell of an area light), about `O(log n)` each.
//! Source: [Appel 1968], [Whitted 1980]. Departs from it: transparent things filter light without bending it.

use super::casters::{near, turned, wide};
use super::hash::hash;
use super::occluders::Occluders;
use super::places::{LightVisibility, SurfacePoint, SurfacePoints};
use super::rounding::{clearance, horizon};
use super::sources::{Area, LightSource, Shares};
use super::{PreparedShadows, ShadowAlgorithm};
use crate::raytrace::intersect::Ray;
use crate::raytrace::structures::AnyStructure;
use crate::raytrace::{Counters, packet};
use crate::{Execution, Global, Session, Settings};
use vitral_exec::Limit;
use vitral_light::{Light, Rgb};
use vitral_math::lanes::{LANES, Level, Simd, dispatch};
use vitral_math::{DVec3, DVec4, Vec3};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct RayShadows;

struct Prepared<'a> {
    structure: AnyStructure,
    occluders: Occluders<'a>,
    sources: Vec<LightSource>,
    /// The same in more cells, for points where those of `sources` disagree; without it, points choose their places by chance.
    finer: Option<Vec<LightSource>>,
    level: Level,
}

impl ShadowAlgorithm for RayShadows {
    fn prepare<'a>(
        &self,
        session: &'a Session,
        lights: &[Light],
        _: DVec4,
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Box<dyn PreparedShadows + 'a>, Limit> {
        let acceleration = settings.acceleration.unwrap_or_default();
        if acceleration.asks_all {
            let pixels = u64::from(settings.picture.width) * u64::from(settings.picture.height);
            let tests = pixels.saturating_mul(lights.len() as u64 * u64::from(session.world.facet_count));
            execution.budget.check_work(tests, "shadows by rays without a structure")?;
        }
        let structure = AnyStructure::new(acceleration, session, execution)?;
        let center = structure.triangles().center;
        let of = |samples: u32| lights.iter().map(|l| LightSource::new(l, samples, center)).collect::<Vec<_>>();
        let sources = of(settings.shadows.light_samples);
        let finer = (settings.global.model == Global::Radiosity).then(|| of(FINER * settings.shadows.light_samples));
        let (occluders, level) = (Occluders::new(session, settings), execution.level);
        Ok(Box::new(Prepared { structure, occluders, sources, finer, level }))
    }
}

/// So many times as many cells where those of an area light disagree, with radiosity: lamps there are large, and light that goes
/// on from surfaces is smooth, so that chance would show as noise.
const FINER: u32 = 8;

/// Places whose rays are made ready before the first is followed.
const TOGETHER: usize = 64;

impl PreparedShadows for Prepared<'_> {
    fn light_visibility(&self, light: usize, places: &SurfacePoints, parts: &mut LightVisibility, rays: &mut u64) {
        let mut feelers = Vec::with_capacity(TOGETHER);
        // Trace several points at a time.
        for first in (0..places.len()).step_by(TOGETHER) {
            let mut found = [[1.0; 3]; TOGETHER];
            let found = &mut found[..TOGETHER.min(places.len() - first)];
            let asking = (first..first + found.len()).map(|number| places.get(number));
            match &self.sources[light] {
                LightSource::Unoccluded => {}
                LightSource::Infinity(towards) => {
                    self.transmittance(&mut feelers, asking.map(|place| (place, *towards)), false, found);
                }
                LightSource::Point(at) => {
                    self.transmittance(&mut feelers, asking.map(|place| (place, *at - place.position)), true, found);
                }
                LightSource::Area(area) => {
                    for (place, part) in asking.zip(&mut *found) {
                        let seed = hash(place.seed ^ hash(light as u32));
                        let seed = if self.finer.is_some() { 0 } else { seed };
                        *part = self.area_part(area, &place, seed, &mut feelers, rays);
                        let finer = self.finer.as_ref().map(|finer| &finer[light]);
                        if let (Some(LightSource::Area(finer)), true) =
                            (finer, part.iter().any(|&p| p > 0.0 && p < 1.0))
                        {
                            *part = self.area_part(finer, &place, seed, &mut feelers, rays);
                        }
                    }
                    feelers.clear();
                }
            }

            // Count the rays and store the results.
            *rays += feelers.len() as u64;
            found.iter().enumerate().for_each(|(k, part)| parts.set(first + k, *part));
        }
    }
}

/// A ray from a place to a light.
struct Feeler {
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

impl Prepared<'_> {
    /// The part of an area light that arrives at a place: a ray to each cell. Adds the rays.
    fn area_part(
        &self,
        area: &Area,
        place: &SurfacePoint,
        seed: u32,
        feelers: &mut Vec<Feeler>,
        rays: &mut u64,
    ) -> Rgb {
        let emitters = (0..area.count()).map(|i| area.emitter(i, seed));
        let counting: Vec<_> = emitters.filter(|e| e.weight(place) > 0.0).collect();
        let ways = counting.iter().map(|e| (*place, e.at.truncate() - place.position));
        let mut passing = vec![[0.0; 3]; counting.len()];
        self.transmittance(feelers, ways, true, &mut passing);
        *rays += feelers.len() as u64;
        let mut shares = Shares::default();
        for (emitter, passing) in counting.iter().zip(passing) {
            shares.add(emitter.weight(place), || passing);
        }
        shares.part()
    }

    /// What passes from each of these places along its way, to the way's end or to infinity, into as many `parts`. Leaves in
    /// `feelers` the rays that were followed for it.
    fn transmittance(
        &self,
        feelers: &mut Vec<Feeler>,
        ways: impl Iterator<Item = (SurfacePoint, DVec3)>,
        ends: bool,
        parts: &mut [Rgb],
    ) {
        feelers.clear();
        for (of, (place, way)) in ways.enumerate() {
            match self.feeler(&place, way, ends) {
                Ok((ray, far, light)) => feelers.push(Feeler { ray, far, light, own: place.facet, of }),
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

    /// The ray from a place along `way`, the parameter of its end, and the light, homogeneous; or what arrives, where that is known
    /// without one.
    fn feeler(&self, place: &SurfacePoint, way: DVec3, ends: bool) -> Result<(Ray, f32, DVec4), Rgb> {
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
        let mut passing = Passing { prepared: self, feelers, limits, left: [[1.0; 3]; LANES] };
        self.structure.follow(simd, &rays[..feelers.len()], &mut passing, &mut Counters::default());
        passing.left.map(|left| left.map(|part| part as f32))
    }
}

/// Follows rays until no light is left.
struct Passing<'a> {
    prepared: &'a Prepared<'a>,
    feelers: &'a [Feeler],
    /// Parameters of the light; negative for rays of which nothing is left.
    limits: [f32; LANES],
    /// In double precision: rounded once, the product is the same in whatever order a structure shows the triangles.
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
        let triangles = self.prepared.structure.triangles();
        let (corners, facet) = (&triangles.corners[place], triangles.facets[place]);
        let Feeler { ray, far, light, own, .. } = &self.feelers[lane];
        if self.limits[lane] < 0.0 || facet == *own || t >= *far {
            return;
        }
        // A facet in whose plane the light lies does not hide it: a ray that grazes it seems to meet it well before its end.
        if turned(&wide(corners), *light, near(*light, triangles.extent)) == 0 {
            return;
        }
        let point = || (ray.origin + ray.direction * t).as_dvec3();
        let passing = self.prepared.occluders.transmittance(facet, corners, point);
        let [r, g, b] = passing.map(f64::from);
        let left = self.left[lane];
        self.left[lane] = [left[0] * r, left[1] * g, left[2] * b];
        if self.left[lane] == [0.0; 3] {
            self.limits[lane] = -1.0;
        }
    }
}
