//! Object-precision shadows: what the light sees is lit.
//!
//! Hidden surfaces are removed twice. Seen from the light, polygons are clipped against each other
//! until only visible parts are left. These are brought back to the polygons that they are parts
//! of, and stay there as *surface detail*: lit polygons. Then any visible-surface algorithm makes a
//! picture from any side, and a place is lit if it lies in a lit polygon of its facet. The polygons
//! do not depend on the viewer: a session keeps them over a turntable, and they can be written to a
//! file.
//!
//! From each facet is taken away what lies in the solids that other triangles hide from the light.
//! Clipping by their planes, in space, leaves convex polygons, and a light may stand anywhere: no
//! view volume has to be cut in sectors. Where many triangles cast shadows on one facet it is first
//! cut in two, and each half has those that reach it, until they are few or one of them covers the
//! whole part. The cuts are kept as a tree, which leads from a place to its polygon.
//!
//! In:   lights and triangles, world space less the scene's middle. Out: lit polygons; the part of
//!       a light that arrives.
//! Cost: for each facet the triangles between it and the light. 100 bytes a lit polygon.
//! Source: [Atherton, Weiler & Greenberg 1978]. Departs from it: polygons are clipped in their own
//! planes, not in a picture of the light's, by one solid after another.

mod clip;

use super::casters::{Casters, Solid, away, lifted, near, wide, winding_normal};
use super::occluders::Occluders;
use super::places::{LightVisibility, SurfacePoints};
use super::rounding::clearance;
use super::sources::{Emitter, LightSource, Shares};
use super::{Drawn, PreparedShadows, ShadowAlgorithm, ShadowKey};
use crate::raytrace::shaft::Shaft;
use crate::{Cached, Execution, Session, Settings};
use clip::{Cutter, Detail};
use std::cmp::Ordering;
use std::sync::{Arc, Mutex};
use vitral_exec::Limit;
use vitral_light::Light;
use vitral_math::{DVec3, DVec4};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct ObjectPrecisionShadows;

/// The lit polygons of all lights.
#[derive(Debug)]
pub(crate) struct LitPolygons {
    casters: Arc<Casters>,
    lights: Vec<Vec<OfLight>>,
}

/// The lit polygons of one place of a light.
#[derive(Debug)]
struct OfLight {
    from: Emitter,
    /// For each facet of the world where it is found.
    places: Vec<Found>,
    details: Vec<Details>,
}

/// Where the detail of a facet is.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    piece: u32,
    root: u32,
    /// Transparent triangles that may filter the light on it.
    filters: [u32; 2],
}

/// What was found for a run of triangles.
#[derive(Debug, Default)]
struct Details {
    detail: Detail,
    filters: Vec<u32>,
    found: Vec<Found>,
}

struct Prepared<'a> {
    polygons: Arc<LitPolygons>,
    occluders: Occluders<'a>,
}

/// What is nearer to a plane than this part of the scene lies in it.
const EPS: f64 = 1e-13;
/// Light that meets a facet with a smaller cosine grazes it.
const GRAZING: f64 = 0.02;
/// A place beside a lit polygon by no more than this part of the scene is in it: no crack between
/// two.
const SLACK: f64 = 1e-9;
/// Triangles in one piece of work.
const TRIANGLES_A_JOB: usize = 256;

impl Cached for LitPolygons {
    type Key = ShadowKey;
}

impl ShadowAlgorithm for ObjectPrecisionShadows {
    fn prepare<'a>(
        &self,
        session: &'a Session,
        lights: &[Light],
        _: DVec4,
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Box<dyn PreparedShadows + 'a>, Limit> {
        let occluders = Occluders::new(session, settings);
        let polygons = session.cache.get_or_build(ShadowKey::new(lights, settings), || {
            let casters = Casters::of(session, &occluders, execution)?;
            let facets = session.world.facet_count as usize;
            let of_light = |light: &Light| -> Result<Vec<OfLight>, Limit> {
                let places = LightSource::new(
                    light,
                    settings.shadows.light_samples,
                    casters.triangles().center,
                )
                .places();
                places
                    .into_iter()
                    .map(|place| OfLight::new(place, &casters, facets, execution))
                    .collect()
            };
            let lights: Result<_, Limit> = lights.iter().map(of_light).collect();
            Ok(LitPolygons { lights: lights?, casters })
        })?;
        Ok(Box::new(Prepared { polygons, occluders }))
    }
}

/// How far above a facet its places are looked at, at most.
fn lift(corners: &[DVec3; 3], extent: f32) -> f64 {
    let position = corners.iter().fold(DVec3::ZERO, |m, c| m.max(c.abs()));
    clearance(position, f64::from(extent))
}

impl OfLight {
    fn new(
        from: Emitter,
        casters: &Casters,
        facets: usize,
        execution: &Execution,
    ) -> Result<Self, Limit> {
        let triangles = casters.triangles();

        // Compute the lit polygons of several triangles a job.
        let jobs = triangles.count().div_ceil(TRIANGLES_A_JOB);
        let charged = Mutex::new(0u64);
        let budget = &execution.budget;
        let details = execution.workers.map(jobs, |job| {
            let first = job * TRIANGLES_A_JOB;
            let mut details = Details::default();
            for t in first..triangles.count().min(first + TRIANGLES_A_JOB) {
                budget.check("object-precision shadows")?;
                details.add(t, from.at, casters);
            }
            let bytes = details.bytes();
            budget.charge(bytes, "object-precision shadows")?;
            *charged.lock().expect("no thread panics while it adds") += bytes;
            Ok(details)
        });

        // Replace the charges of the jobs by that of the whole.
        budget.release(charged.into_inner().expect("no thread panics while it adds"));
        let details: Vec<Details> = details.into_iter().collect::<Result<_, Limit>>()?;

        // Index the polygons by facet.
        let mut places = vec![Found { piece: u32::MAX, ..Found::default() }; facets];
        for (piece, found) in details.iter().enumerate() {
            for (i, found) in found.found.iter().enumerate() {
                let facet = triangles.facets[piece * TRIANGLES_A_JOB + i];
                places[facet as usize] = Found { piece: piece as u32, ..*found };
            }
        }
        Ok(Self { from, places, details })
    }

    /// The transparent triangles that may filter the light at a place, or `None` if it is not lit.
    fn at(&self, facet: u32, place: DVec3, slack: f64) -> Option<&[u32]> {
        // Facets that are not finite have no place.
        let found = self.places.get(facet as usize)?;
        let details = self.details.get(found.piece as usize)?;
        let [first, end] = found.filters.map(|i| i as usize);
        details.detail.lights(found.root, place, slack).then(|| &details.filters[first..end])
    }
}

impl Details {
    /// Clips a triangle.
    fn add(&mut self, triangle: usize, light: DVec4, casters: &Casters) {
        let corners = wide(&casters.triangles().corners[triangle]);
        let first = self.filters.len() as u32;
        let winding = winding_normal(&corners).normalize_or_zero();
        let height = -winding.dot(away(light, corners[0]));
        let root = match height.partial_cmp(&0.0) {
            // What the light sees edge-on, or what has no area, is not lit.
            None | Some(Ordering::Equal) => self.detail.dark(),
            Some(_) => self.clip(triangle, (corners, winding * height.signum()), light, casters),
        };
        self.found.push(Found { piece: 0, root, filters: [first, self.filters.len() as u32] });
    }

    /// Takes from a triangle what others hide from the light, to which its normal is turned; gives
    /// the root of the lit part.
    fn clip(
        &mut self,
        triangle: usize,
        (corners, normal): ([DVec3; 3], DVec3),
        light: DVec4,
        casters: &Casters,
    ) -> u32 {
        let triangles = casters.triangles();
        let extent = triangles.extent;
        let near = near(light, extent);

        // What touches the facet, as its neighbours do, does not hide it: solids begin a little
        // behind. A facet that light grazes lies along their sides, too: it is looked at from a
        // little above.
        let lift = lift(&corners, extent);
        let cosine = |c: &DVec3| -normal.dot(away(light, *c).normalize_or_zero());
        let grazed = corners.iter().any(|c| cosine(c) < GRAZING);
        let (above, behind) = if grazed { (lift, 0.0) } else { (0.0, lift) };
        let corners = corners.map(|c| c + normal * above);

        // Find the triangles between it and the light.
        let (min, max) = (
            corners[0].min(corners[1]).min(corners[2]),
            corners[0].max(corners[1]).max(corners[2]),
        );
        let shaft = Shaft::between(min, max, light, extent);
        let (mut list, mut filters) = (Vec::new(), Vec::new());
        casters.opaque_near(&shaft, &mut list);
        casters.filters_near(&shaft, &mut filters);

        // Keep the solids that reach it.
        let (middle, half) = ((min + max) * 0.5, (max - min) * 0.5);
        let solid = |corners: &[DVec3; 3]| {
            let mut solid = Solid::new(corners, light, near).filter(|s| s.touches(middle, half))?;
            solid.planes = solid.planes.map(|(normal, at)| (normal.normalize_or_zero(), at));
            let (normal, at) = &mut solid.planes[0];
            *at += *normal * behind;
            Some(solid)
        };
        let own = triangles.facets[triangle];
        let others = list.iter().filter(|&&t| triangles.facets[t as usize] != own);
        let solids: Vec<_> =
            others.filter_map(|&t| solid(&wide(&triangles.corners[t as usize]))).collect();
        self.filters.extend(filters.iter().filter(|&&t| solid(&casters.filter(t)).is_some()));

        let eps = f64::from(extent) * EPS;
        Cutter { detail: &mut self.detail, normal, eps, solids: &solids }.add(corners.to_vec())
    }

    fn bytes(&self) -> u64 {
        let lists = self.filters.capacity() * 4 + self.found.capacity() * size_of::<Found>();
        self.detail.bytes() + lists as u64
    }
}

impl PreparedShadows for Prepared<'_> {
    fn light_visibility(
        &self,
        light: usize,
        places: &SurfacePoints,
        parts: &mut LightVisibility,
        _: &mut u64,
    ) {
        let LitPolygons { casters, lights } = &*self.polygons;
        let lights = &lights[light];
        if lights.is_empty() {
            return parts.fill([1.0; 3]);
        }
        let extent = casters.extent();
        let slack = f64::from(extent) * SLACK;
        // Sum the shares of the light's positions that the place lies in a lit polygon of.
        for (number, place) in places.iter().enumerate() {
            let mut shares = Shares::default();
            for l in lights {
                shares.add(l.from.weight(&place), || {
                    let filters = l.at(place.facet, place.position, slack);
                    let at = lifted(&place, extent);
                    let passing = |filters| {
                        casters.filtered(&self.occluders, l.from.at, place.facet, at, filters)
                    };
                    filters.map_or([0.0; 3], passing)
                });
            }
            parts.set(number, shares.part());
        }
    }

    fn draw(&self, take: &mut dyn FnMut(Drawn<'_>)) {
        let triangles = self.polygons.casters.triangles();
        let center = triangles.center;
        let mut corners = Vec::new();

        // Hand out the lit polygons of each position of each light.
        for (light, places) in self.polygons.lights.iter().enumerate() {
            for (piece, details) in places.iter().flat_map(|place| place.details.iter().enumerate())
            {
                for (i, found) in details.found.iter().enumerate() {
                    let facet = Some(triangles.facets[piece * TRIANGLES_A_JOB + i]);
                    details.detail.each(found.root, &mut |polygon| {
                        corners.clear();
                        corners.extend(polygon.iter().map(|&c| c + center));
                        take(Drawn { light, kind: "lit", facet, corners: &corners });
                    });
                }
            }
        }
    }
}
