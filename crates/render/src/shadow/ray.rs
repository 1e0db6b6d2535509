//! Shadows by rays: a point is lit if nothing stands on the way from it to the light. The reference
//! of the others.
//!
//! From each visible point a ray goes towards each light, and a structure (`--acceleration`) shows
//! it what stands near (`light_rays.rs`).
//!
//! In:   points on facets, world space less the scene's middle; lights. Out: the part of light that
//!       arrives.
//! Cost: a ray for each point and light (or cell of an area light), about `O(log n)` each.
//! Source: [Appel 1968], [Whitted 1980]. Departs from it: transparent things filter light without
//!         bending it.

use super::hash::hash;
use super::light_rays::{Feeler, LightRays};
use super::places::{LightVisibility, SurfacePoint, SurfacePoints};
use super::sources::{Area, LightSource, Shares};
use super::{PreparedShadows, ShadowAlgorithm};
use crate::{Execution, Global, Session, Settings};
use vitral_exec::Limit;
use vitral_light::{Light, Rgb};
use vitral_math::DVec4;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct RayShadows;

struct Prepared<'a> {
    rays: LightRays<'a>,
    sources: Vec<LightSource>,
    /// The same in more cells, for points where those of `sources` disagree; without it, points
    /// choose their places by chance.
    finer: Option<Vec<LightSource>>,
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
        let pixels = u64::from(settings.picture.width) * u64::from(settings.picture.height);
        let asked =
            (pixels.saturating_mul(lights.len() as u64), "shadows by rays without a structure");
        let rays = LightRays::new(session, settings, execution, asked)?;
        let center = rays.center();
        let of = |samples: u32| {
            lights.iter().map(|l| LightSource::new(l, samples, center)).collect::<Vec<_>>()
        };
        let sources = of(settings.shadows.light_samples);
        let finer = (settings.global.model == Global::Radiosity)
            .then(|| of(FINER * settings.shadows.light_samples));
        Ok(Box::new(Prepared { rays, sources, finer }))
    }
}

/// So many times as many cells where those of an area light disagree, with radiosity: lamps there
/// are large, and light that goes on from surfaces is smooth, so that chance would show as noise.
const FINER: u32 = 8;

/// SurfacePoints whose rays are made ready before the first is followed.
const TOGETHER: usize = 64;

impl PreparedShadows for Prepared<'_> {
    fn light_visibility(
        &self,
        light: usize,
        places: &SurfacePoints,
        parts: &mut LightVisibility,
        rays: &mut u64,
    ) {
        let mut feelers = Vec::with_capacity(TOGETHER);

        // Trace several points at a time.
        for first in (0..places.len()).step_by(TOGETHER) {
            let mut found = [[1.0; 3]; TOGETHER];
            let found = &mut found[..TOGETHER.min(places.len() - first)];
            let asking = (first..first + found.len()).map(|number| places.get(number));

            // Trace a ray from each point to the light, or one to each cell of an area light.
            match &self.sources[light] {
                LightSource::Unoccluded => {}
                LightSource::Infinity(towards) => {
                    self.rays.transmittance(
                        &mut feelers,
                        asking.map(|place| (place, *towards)),
                        false,
                        found,
                    );
                }
                LightSource::Point(at) => {
                    self.rays.transmittance(
                        &mut feelers,
                        asking.map(|place| (place, *at - place.position)),
                        true,
                        found,
                    );
                }
                LightSource::Area(area) => {
                    for (place, part) in asking.zip(&mut *found) {
                        let seed = hash(place.seed ^ hash(light as u32));
                        let seed = if self.finer.is_some() { 0 } else { seed };
                        *part = self.area_part(area, &place, seed, &mut feelers, rays);

                        // Divide an area light into more cells where the coarse ones disagree.
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
        self.rays.transmittance(feelers, ways, true, &mut passing);
        *rays += feelers.len() as u64;
        let mut shares = Shares::default();
        for (emitter, passing) in counting.iter().zip(passing) {
            shares.add(emitter.weight(place), || passing);
        }
        shares.part()
    }
}
