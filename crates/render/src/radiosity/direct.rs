//! Light that comes straight from light sources to elements, with shadows by rays.
//!
//! An element is asked at the middles of 16 parts. Where they disagree, as at the border of a
//! shadow or in a narrow cone of light, each quarter of the element is asked as finely again, and
//! those of its quarters in which neighbours disagree.
//!
//! In:   sides of elements. Out: the mean of what arrives.
//! Cost: 16 places for each light, each with a ray or as many as an area light has samples; up to
//!       336 where light ends.

use super::element::Color;
use super::parts::{PARTS, WHOLE, middle, parts, quarters};
use crate::raytrace::triangles::Triangles;
use crate::shadow::{
    LightVisibility, PreparedShadows, ShadowAlgorithm, SurfacePoint, SurfacePoints, ray::RayShadows,
};
use crate::{Execution, GlobalSettings, Session, Settings};
use vitral_exec::Limit;
use vitral_light::{Light, PreparedLight};
use vitral_math::lanes::V3;
use vitral_math::{DMat4, DVec3, DVec4};

/// Neighbours disagree if their light differs by more than this part of the most.
const DISAGREEING: f64 = 0.5;
/// How often quarters are asked more finely.
const MOST_DEPTH: u32 = 2;

/// See the module.
pub(super) struct Direct<'a> {
    /// With their numbers.
    lights: Vec<(usize, PreparedLight)>,
    shadows: Box<dyn PreparedShadows + 'a>,
}

impl<'a> Direct<'a> {
    /// `None` if there is no light.
    pub(super) fn new(
        session: &'a Session,
        lights: &[Light],
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Option<Self>, Limit> {
        let here = DMat4::from_translation(-Triangles::center_of(&session.world));
        let prepared = lights.iter().map(|l| PreparedLight::new(l, &here)).enumerate();
        let prepared: Vec<_> = prepared.filter_map(|(i, l)| Some((i, l?))).collect();
        if prepared.is_empty() || !settings.shading.lighting {
            return Ok(None);
        }
        // Means over many places need no finer areas.
        let settings = Settings { global: GlobalSettings::default(), ..settings.clone() };
        let shadows = RayShadows.prepare(session, lights, DVec4::Z, &settings, execution)?;
        Ok(Some(Self { lights: prepared, shadows }))
    }

    /// What arrives on average at those parts of a triangle that are `there`; `side` says where it
    /// faces.
    pub(super) fn mean(&self, side: &SurfacePoint, corners: [DVec3; 3], there: u16) -> Color {
        self.mean_at(side, corners, there, 0)
    }

    fn mean_at(&self, side: &SurfacePoint, corners: [DVec3; 3], there: u16, depth: u32) -> Color {
        let numbers: Vec<usize> = (0..PARTS).filter(|part| there >> part & 1 == 1).collect();
        let parts = parts(corners);
        let seed = |part: usize| side.seed.wrapping_mul(PARTS as u32).wrapping_add(part as u32);
        let place = |&part: &usize| SurfacePoint {
            position: middle(parts[part]),
            seed: seed(part),
            ..*side
        };
        let mut light = self.arriving(&numbers.iter().map(place).collect::<Vec<_>>());
        let sums: Vec<f64> = light.iter().map(|color| color.iter().sum()).collect();
        let most = sums.iter().copied().fold(0.0, f64::max);
        let disagree = |some: &[usize]| {
            let least = some.iter().map(|&i| sums[i]).fold(f64::INFINITY, f64::min);
            some.iter().any(|&i| sums[i] - least > DISAGREEING * most)
        };
        // Between the first places light may end unseen anywhere, once it ends somewhere.
        let all = depth == 0 && disagree(&(0..sums.len()).collect::<Vec<_>>());
        for (quarter, corners) in
            quarters(corners).into_iter().enumerate().filter(|_| depth < MOST_DEPTH)
        {
            let own: Vec<usize> =
                (0..numbers.len()).filter(|&i| numbers[i] / 4 == quarter).collect();
            if own.len() == 4 && (all || disagree(&own)) {
                let mean = self.mean_at(side, corners, WHOLE, depth + 1);
                own.into_iter().for_each(|i| light[i] = mean);
            }
        }
        let count = light.len().max(1) as f64;
        [0, 1, 2].map(|k| light.iter().map(|c| c[k]).sum::<f64>() / count)
    }

    fn arriving(&self, places: &[SurfacePoint]) -> Vec<Color> {
        let three = |v: DVec3| V3::splat(0.0f32, v.as_vec3().to_array());
        let mut sums = vec![[0.0; 3]; places.len()];
        let all: SurfacePoints = places.iter().copied().collect();
        for (number, light) in &self.lights {
            // Compute what would arrive if nothing were in between.
            let unhidden = places.iter().map(|place| {
                let (position, normal) = (three(place.position), three(place.normal));
                light.irradiance(position, normal).unwrap_or_else(|| {
                    let incident = light.incident(position);
                    incident.intensity * normal.dot(incident.l).max(0.0)
                })
            });
            let unhidden: Vec<f32> = unhidden.collect();
            if unhidden.iter().all(|&light| light <= 0.0) {
                continue;
            }

            // Multiply by the visible part of the light.
            let mut visible = LightVisibility::new(places.len(), [0.0; 3]);
            self.shadows.light_visibility(*number, &all, &mut visible, &mut 0);
            for (i, sum) in sums.iter_mut().enumerate() {
                let visible = visible.get(i);
                (0..3)
                    .for_each(|k| sum[k] += f64::from(light.diffuse[k] * visible[k] * unhidden[i]));
            }
        }
        sums
    }
}
