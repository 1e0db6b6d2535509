//! A ground that only shows shadow: the background is darkened where the model keeps light from a
//! plane below it.
//!
//! The plane lies at the lowest point of all triangles. Seen from above it is behind everything, so
//! it needs no visibility algorithm: the ray of sight through a pixel meets it at one place, and
//! what is kept away there darkens the pixel's background. From below it is not seen.
//!
//! The ground is matt and lit like the model. It keeps the share of the background that it has of
//! its whole light: with the lights' shadows, ambient light and every light by the cosine, found by
//! rays whatever algorithm shadows the model; or as a soft shadow that no light casts
//! ([`super::contact`]).
//!
//! A pixel asks at its centre; where neighbours differ, at all its samples.
//!
//! In:   a view, lights. Out: for each pixel of a tile the part of the background that the shadow
//!       takes, `0..=1`.
//! Cost: a ray for each pixel and light, more at the edges of shadows; or a lookup for each pixel.

use super::contact::ContactShadow;
use super::hash::hash;
use super::places::{LightVisibility, SurfacePoint, SurfacePoints};
use super::ray::RayShadows;
use super::{PreparedShadows, ShadowAlgorithm, grey};
use crate::display::Fade;
use crate::raytrace::triangles::Triangles;
use crate::settings::GroundShadow;
use crate::{Execution, PreparedView, Settings};
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_light::{Light, PreparedLight, Rgb};
use vitral_math::lanes::V3;
use vitral_math::{DMat4, DVec2, DVec3, DVec4, dvec2};
use vitral_raster::{SamplePattern, TILE, TILE_PIXELS, Tile};
use vitral_scene::Axis;

/// Neighbours that differ by more are at an edge of the shadow.
const EDGE: f32 = 1.0 / 64.0;
/// Pixels along a side of a tile with its neighbours.
const SIDE: usize = TILE + 2;

/// See the module.
pub(crate) struct Ground<'a> {
    up: DVec3,
    /// Along `up`, from the scene's middle.
    height: f64,
    cast: Cast<'a>,
    sight: Sight,
    pattern: SamplePattern,
}

/// What darkens the ground.
enum Cast<'a> {
    Contact(Arc<ContactShadow>),
    Lights(LitGround<'a>),
}

/// The light of a ground.
struct LitGround<'a> {
    shadows: Box<dyn PreparedShadows + 'a>,
    /// With their numbers, world space less the scene's middle.
    lights: Vec<(usize, PreparedLight)>,
    ambient: f32,
}

/// Rays of sight, world space less the scene's middle.
struct Sight {
    world_from_view: DMat4,
    view_from_world: DMat4,
    view_from_clip: DMat4,
    perspective: bool,
    /// Pixels.
    size: DVec2,
}

impl<'a> Ground<'a> {
    /// The ground of a picture; `None` if none is wanted, or there is nothing to stand on it.
    ///
    /// # Errors
    /// A limit of the budget.
    pub(crate) fn new(
        view: &PreparedView<'a>,
        (lights, ambient): (&[Light], Rgb),
        up: Axis,
        (settings, execution): (&Settings, &Execution),
    ) -> Result<Option<Self>, Limit> {
        // Skip pictures without a ground shadow, lighting or surfaces.
        let chosen = settings.shadows.ground;
        if chosen == GroundShadow::None
            || !settings.shading.lighting
            || settings.picture.lines.has_no_surfaces()
        {
            return Ok(None);
        }

        // Lay the ground through the lowest corner of all triangles.
        let session = view.session;
        let triangles = Triangles::of(session, execution)?;
        let corners = || triangles.corners.iter().flatten().map(|corner| corner.as_dvec3());
        let height = corners().map(|corner| corner.dot(up.vector())).fold(f64::INFINITY, f64::min);
        if !height.is_finite() {
            return Ok(None);
        }

        // Prepare the contact shadow over the model's footprint, or rays to the lights.
        let cast = if chosen == GroundShadow::Soft {
            let axes = [up.vector().cross(up.front()), up.front()];
            let on_ground =
                || corners().map(|corner| dvec2(corner.dot(axes[0]), corner.dot(axes[1])));
            let least = on_ground().fold(DVec2::INFINITY, DVec2::min);
            let most = on_ground().fold(DVec2::NEG_INFINITY, DVec2::max);
            let context = (settings, execution);
            Cast::Contact(ContactShadow::of(session, context, up, height, (axes, least, most))?)
        } else {
            let space = DMat4::from_translation(-triangles.center);
            let prepared = lights.iter().map(|light| PreparedLight::new(light, &space)).enumerate();
            let shadows = RayShadows.prepare(session, lights, DVec4::Z, settings, execution)?;
            let lights = prepared.filter_map(|(number, light)| Some((number, light?))).collect();
            Cast::Lights(LitGround { shadows, lights, ambient: grey(ambient) })
        };

        // Set up the rays of sight in world space round the scene's middle.
        let sight = Sight {
            world_from_view: DMat4::from_translation(-triangles.center)
                * view.view.view_from_world.inverse(),
            view_from_world: view.view.view_from_world * DMat4::from_translation(triangles.center),
            view_from_clip: view.view.clip_from_view.inverse(),
            perspective: view.view.perspective,
            size: dvec2(f64::from(view.viewport.width), f64::from(view.viewport.height)),
        };
        Ok(Some(Self { up: up.vector(), height, cast, sight, pattern: view.pattern.clone() }))
    }

    /// The part of the background that the shadow takes in each pixel of a tile, less where depth
    /// cueing fades it; empty if it takes nothing.
    pub(crate) fn tile(&self, tile: &Tile, fade: Option<&Fade>) -> Vec<f32> {
        // Ask at the centres of all pixels and of their neighbours.
        let place = |i: usize| {
            dvec2(f64::from(tile.x), f64::from(tile.y))
                + dvec2((i % SIDE) as f64, (i / SIDE) as f64)
                - 0.5
        };
        let centres = self.dark((0..SIDE * SIDE).map(place), fade);
        if centres.iter().all(|&dark| dark == 0.0) {
            return Vec::new();
        }
        let at = |pixel: usize| (pixel / TILE + 1) * SIDE + pixel % TILE + 1;
        let mut dark: Vec<f32> = (0..TILE_PIXELS).map(|pixel| centres[at(pixel)]).collect();

        // Ask at all samples where neighbours differ.
        let samples = self.pattern.len();
        let is_edge = |pixel: &usize| {
            let (i, own) = (at(*pixel), dark[*pixel]);
            let neighbours = [
                i - SIDE - 1,
                i - SIDE,
                i - SIDE + 1,
                i - 1,
                i + 1,
                i + SIDE - 1,
                i + SIDE,
                i + SIDE + 1,
            ];
            samples > 1 && neighbours.iter().any(|&n| (centres[n] - own).abs() > EDGE)
        };
        let edges: Vec<usize> = (0..TILE_PIXELS).filter(is_edge).collect();
        let sample = |&pixel: &usize| {
            let corner = place(at(pixel)) - 0.5;
            (0..samples)
                .map(move |s| corner + DVec2::from_array(self.pattern.offset(s).map(f64::from)))
        };
        let found = self.dark(edges.iter().flat_map(sample), fade);
        for (pixel, found) in edges.iter().zip(found.chunks(samples)) {
            dark[*pixel] = found.iter().sum::<f32>() / samples as f32;
        }
        dark
    }

    /// The part that the shadow takes at places of the picture, in pixels.
    fn dark(&self, places: impl Iterator<Item = DVec2>, fade: Option<&Fade>) -> Vec<f32> {
        let seen: Vec<Option<(SurfacePoint, f32)>> =
            places.map(|place| self.seen(place, fade)).collect();
        let shown: SurfacePoints = seen.iter().flatten().map(|(place, _)| *place).collect();
        let found = match &self.cast {
            Cast::Contact(shadow) => shown.iter().map(|place| shadow.at(place.position)).collect(),
            Cast::Lights(lit) => lit.dark(&shown, self.up),
        };
        let mut found = found.into_iter();
        let mut next = |kept: f32| found.next().unwrap_or(0.0) * kept;
        seen.iter().map(|seen| seen.as_ref().map_or(0.0, |(_, kept)| next(*kept))).collect()
    }

    /// The place of the ground that is seen at a place of the picture, and how much depth cueing
    /// keeps of it.
    fn seen(&self, at: DVec2, fade: Option<&Fade>) -> Option<(SurfacePoint, f32)> {
        let (origin, direction) = self.sight.ray(at);
        let above = origin.dot(self.up) - self.height;
        let descent = -direction.dot(self.up);
        let way = above / descent;
        if !(descent > 0.0 && way.is_finite()) || (self.sight.perspective && above <= 0.0) {
            return None;
        }
        let position = origin + direction * way;
        let depth = || -self.sight.view_from_world.transform_point3(position).z;
        let kept = fade.map_or(1.0, |fade| fade.kept(depth() as f32));
        let [x, y] = [at.x, at.y].map(|v| (v * 16.0) as i32 as u32);
        let seed = hash(x ^ hash(y));
        Some((SurfacePoint { position, normal: self.up, facet: u32::MAX, seed, pixel: None }, kept))
    }
}

impl LitGround<'_> {
    /// The part of their light that places of the ground do not get.
    fn dark(&self, places: &SurfacePoints, up: DVec3) -> Vec<f32> {
        let n = V3::splat(0.0f32, up.as_vec3().to_array());
        let (mut whole, mut lost) = (vec![self.ambient; places.len()], vec![0.0; places.len()]);
        for (number, light) in &self.lights {
            let strength = grey(light.diffuse);
            let mut parts = LightVisibility::new(places.len(), [0.0; 3]);
            self.shadows.light_visibility(*number, places, &mut parts, &mut 0);
            for (i, place) in places.iter().enumerate() {
                let position = V3::splat(0.0f32, place.position.as_vec3().to_array());
                let incident = light.incident(position);
                let by_cosine = || incident.intensity * n.dot(incident.l).max(0.0);
                let arriving = strength * light.irradiance(position, n).unwrap_or_else(by_cosine);
                whole[i] += grey(light.ambient) * incident.ambient_intensity + arriving;
                lost[i] += if arriving > 0.0 { arriving * (1.0 - grey(parts.get(i))) } else { 0.0 };
            }
        }
        lost.iter()
            .zip(&whole)
            .map(|(lost, whole)| if *lost > 0.0 { (lost / whole).min(1.0) } else { 0.0 })
            .collect()
    }
}

impl Sight {
    /// Origin and direction of the ray through a place of the picture.
    fn ray(&self, at: DVec2) -> (DVec3, DVec3) {
        let ndc = at / self.size * 2.0 - 1.0;
        let near = self.view_from_clip.project_point3(DVec3::new(ndc.x, -ndc.y, 1.0));
        let (origin, direction) =
            if self.perspective { (DVec3::ZERO, near) } else { (near, DVec3::NEG_Z) };
        (
            self.world_from_view.transform_point3(origin),
            self.world_from_view.transform_vector3(direction),
        )
    }
}
