//! Shadows by rays: a point is lit if nothing stands on the way from it to the light. The reference of the others.
//!
//! From each visible point a ray goes towards each light, and a tree of boxes shows it what stands near. Unlike a ray of
//! sight it need not know what it meets first: the first opaque thing ends it, and transparent things take their part of the
//! light in any order.
//!
//! A point found by arithmetic lies a hair off its surface, and its ray might meet the very surface it leaves. The facet
//! itself cannot hide its own points from a light in front of it, so it is left out by its number; as its neighbours may,
//! the ray starts as far above the facet as rounding can have put things wrong. With `u = 2^-24` and no coordinate larger
//! than `e`, a corner relative to the origin is wrong by at most `u (|p| + 2 e)`, and shearing and the hit's weighted mean
//! each add a few times as much: `16 u (|p| + e)` covers them.
//!
//! In:   points on facets, world space less the scene's middle; lights. Out: the part of light that arrives.
//! Cost: a ray for each point and light (or cell of an area light), about `O(log n)` each.
//! Source: [Appel 1968], [Whitted 1980]. Departs from it: transparent things filter light without bending it.

use super::occluders::Occluders;
use super::sources::{Shares, Source, hash};
use super::{Place, ShadowAlgorithm, Shadows};
use crate::raytrace::beam::Beam;
use crate::raytrace::bvh::Bvh;
use crate::raytrace::intersect::Ray;
use crate::raytrace::{Structure, Visitor};
use crate::{Execution, Session, Settings};
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_light::{Light, Rgb};
use vitral_math::{DVec3, DVec4, Vec3};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct RayShadows;

/// Rounding of one operation.
const UNIT: f64 = 1.0 / (1u32 << 24) as f64;

/// How far above its facet a ray must start at this place of a scene of half-width `extent`; see the module.
pub(crate) fn clearance(position: DVec3, extent: f64) -> f64 {
    16.0 * UNIT * (position.abs().max_element() + extent)
}

struct Prepared<'a> {
    tree: Arc<Bvh>,
    occluders: Occluders<'a>,
    sources: Vec<Source>,
}

impl ShadowAlgorithm for RayShadows {
    fn prepare<'a>(
        &self,
        session: &'a Session,
        lights: &[Light],
        _: DVec4,
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Box<dyn Shadows + 'a>, Limit> {
        let tree = session.bvh(execution)?;
        let center = tree.triangles().center;
        let sources = lights.iter().map(|l| Source::new(l, settings.light_samples, center)).collect();
        Ok(Box::new(Prepared { tree, occluders: Occluders::new(session, settings), sources }))
    }
}

impl Shadows for Prepared<'_> {
    fn arriving(&self, light: usize, places: &[Place], parts: &mut [Rgb], rays: &mut u64) {
        for (place, part) in places.iter().zip(parts) {
            *part = match &self.sources[light] {
                Source::Unhindered => [1.0; 3],
                Source::Infinity(towards) => self.passing(place, *towards, false, rays),
                Source::Point(at) => self.passing(place, *at - place.position, true, rays),
                Source::Area(area) => {
                    let seed = hash(place.seed ^ hash(light as u32));
                    let mut shares = Shares::default();
                    for i in 0..area.count() {
                        let emitter = area.emitter(i, seed);
                        let way = emitter.at.truncate() - place.position;
                        shares.add(emitter.weight(place), || self.passing(place, way, true, rays));
                    }
                    shares.part()
                }
            };
        }
    }
}

impl Prepared<'_> {
    /// What passes on the way from the place along `way`, to its end or to infinity.
    fn passing(&self, place: &Place, way: DVec3, ends: bool, rays: &mut u64) -> Rgb {
        // Attached shadow; also a light in the facet's plane, or at the very place.
        if place.normal.dot(way) <= 0.0 {
            return [0.0; 3];
        }
        let triangles = self.tree.triangles();
        let extent = f64::from(triangles.extent);
        let above = clearance(place.position, extent);
        let origin = place.position + place.normal * above;
        let way = if ends { way - place.normal * above } else { way };
        let length = way.abs().max_element();
        let scale = 1.0 / length;
        let ray = Ray::new(origin.as_vec3(), (way * scale).as_vec3());
        if !ray.direction.is_finite() || ray.direction == Vec3::ZERO {
            return [1.0; 3];
        }
        *rays += 1;
        // What the light itself is fixed to does not hide it.
        let far = if ends { (length - above) as f32 } else { f32::INFINITY };
        let mut passing = Passing { prepared: self, ray: &ray, far, own: place.facet, left: [1.0; 3] };
        self.tree.traverse(&Beam::around(&ray, triangles.extent), &mut passing);
        passing.left
    }
}

/// Follows a ray until no light is left.
struct Passing<'a> {
    prepared: &'a Prepared<'a>,
    ray: &'a Ray,
    /// Parameter of the light.
    far: f32,
    /// The facet that the ray leaves.
    own: u32,
    left: Rgb,
}

impl Visitor for Passing<'_> {
    #[inline(always)]
    fn skips(&self, _: usize, near: f32) -> bool {
        self.done(near)
    }

    #[inline(always)]
    fn done(&self, near: f32) -> bool {
        self.left == [0.0; 3] || near >= self.far
    }

    #[inline(always)]
    fn triangle(&mut self, place: usize) {
        let triangles = self.prepared.tree.triangles();
        let (corners, facet) = (&triangles.corners[place], triangles.facets[place]);
        if self.left == [0.0; 3] || facet == self.own {
            return;
        }
        let Some(t) = self.ray.hit(corners).filter(|t| *t < self.far) else { return };
        let point = || (self.ray.origin + self.ray.direction * t).as_dvec3();
        let passing = self.prepared.occluders.passing(facet, corners, point);
        self.left = [0, 1, 2].map(|k| self.left[k] * passing[k]);
    }
}
