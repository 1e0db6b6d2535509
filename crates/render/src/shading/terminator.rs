//! The border between light and attached shadow on surfaces that facets only stand for.
//!
//! A facet that faces away from a light has none by its own plane, though the interpolated normal
//! still faces the light near the border: coarse round bodies would end in steps along their
//! facets. So there the interpolated normal decides: the place is moved to the curved surface that
//! the corners' normals tell, and a ray from there finds what stands between. It is a ray whatever
//! algorithm finds the other shadows, since these know the facets alone.
//!
//! In:   places that get no light, and the light. Out: what arrives at those that face away by
//!       their facet alone.
//! Cost: a look at each dark place; a ray for each in the band between both borders.
//! Source: \[Hanika 2021\].

use super::FrameConstants;
use crate::raytrace::triangles::Triangles;
use crate::shadow::ray::RayShadows;
use crate::shadow::{
    LightVisibility, PreparedShadows, ShadowAlgorithm, SurfacePoint, SurfacePoints,
    facet as facet_of, weights,
};
use crate::{Execution, PreparedView, Settings};
use std::sync::OnceLock;
use vitral_light::Light;
use vitral_math::lanes::V3;
use vitral_math::{DMat3, DVec3, DVec4};
use vitral_scene::Instance;

/// Rays for the places in the band, made ready for the first.
pub(crate) struct SoftTerminator<'a> {
    view: &'a PreparedView<'a>,
    lights: Vec<Light>,
    settings: Settings,
    execution: Execution,
    rays: OnceLock<Option<Box<dyn PreparedShadows + 'a>>>,
}

impl<'a> SoftTerminator<'a> {
    pub(super) fn new(
        view: &'a PreparedView<'a>,
        lights: &[Light],
        settings: &Settings,
        execution: &Execution,
    ) -> Self {
        let (settings, execution) =
            (settings.clone(), Execution { observer: None, ..execution.clone() });
        Self { view, lights: lights.to_vec(), settings, execution, rays: OnceLock::new() }
    }
}

impl PreparedShadows for SoftTerminator<'_> {
    /// Leaves places dark whose rays the budget does not allow.
    fn light_visibility(
        &self,
        light: usize,
        places: &SurfacePoints,
        parts: &mut LightVisibility,
        rays: &mut u64,
    ) {
        let prepare = || {
            RayShadows
                .prepare(self.view.session, &self.lights, DVec4::Z, &self.settings, &self.execution)
                .ok()
        };
        if let Some(shadows) = self.rays.get_or_init(prepare) {
            shadows.light_visibility(light, places, parts, rays);
        }
    }
}

/// Finds what arrives of a light at those dark places whose interpolated normal faces it. `light`
/// is its number in the frame.
pub(super) fn soften(
    constants: &FrameConstants<'_>,
    light: usize,
    places: &SurfacePoints,
    parts: &mut LightVisibility,
    rays: &mut u64,
) {
    let Some(soft) = &constants.terminator else { return };
    let to_view = DMat3::from_mat4(constants.view.view.view_from_world);
    let center = Triangles::center_of(&constants.view.session.world);
    let prepared = &constants.lights[light];
    let (mut numbers, mut curved) = (Vec::new(), Vec::new());
    for number in (0..places.len()).filter(|&number| parts.get(number) == [0.0; 3]) {
        let place = places.get(number);
        let position =
            constants.view.view.view_from_world.transform_point3(place.position + center).as_vec3();
        let position = V3::new(position.x, position.y, position.z);
        let incident = prepared.incident(position);
        let facing = |normal: DVec3| {
            let n = (to_view * normal).as_vec3();
            V3::new(n.x, n.y, n.z).dot(incident.l)
        };
        if incident.intensity <= 0.0 || facing(place.normal) > prepared.direction_rounding(position)
        {
            continue;
        }
        let Some(place) = on_curve(constants, &place, center) else { continue };
        if facing(place.normal) > prepared.direction_rounding(position) {
            numbers.push(number);
            curved.push(place);
        }
    }
    if numbers.is_empty() {
        return;
    }
    let curved: SurfacePoints = curved.into_iter().collect();
    let mut found = LightVisibility::new(curved.len(), [0.0; 3]);
    soft.light_visibility(constants.light_numbers[light], &curved, &mut found, rays);
    numbers.into_iter().enumerate().for_each(|(i, number)| parts.set(number, found.get(i)));
}

/// A place on the curved surface for which its facet stands, with the normal there; `None` where
/// the facet stands for itself.
fn on_curve(
    constants: &FrameConstants<'_>,
    place: &SurfacePoint,
    center: DVec3,
) -> Option<SurfacePoint> {
    let world = &constants.view.session.world;
    let instance = &world.instances[world.instance_of_facet(place.facet)];
    let triangle = place.facet - instance.first_facet;
    let normals = corner_normals(instance, triangle)?;
    let (corners, outward) = facet_of(instance, triangle, center);
    let side = if outward.dot(place.normal) < 0.0 { -1.0 } else { 1.0 };
    let normals = normals.map(|n| n * side);
    let weights =
        weights(&corners.map(|c| c.as_vec3()), place.position).map(|w| f64::from(w.max(0.0)));
    let normal = (0..3).map(|k| normals[k] * weights[k]).sum::<DVec3>().try_normalize()?;

    // Each corner's plane lifts the place by what it is above it.
    let lift = (0..3).map(|k| {
        let below = (place.position - corners[k]).dot(normals[k]).min(0.0);
        normals[k] * (-below * weights[k])
    });
    let position = place.position + lift.sum::<DVec3>();
    (position.is_finite() && normal.is_finite()).then_some(SurfacePoint {
        position,
        normal,
        ..*place
    })
}

/// The normals of a triangle's corners in the world, unit; `None` if they are the facet's.
fn corner_normals(instance: &Instance, triangle: u32) -> Option<[DVec3; 3]> {
    let mesh = &instance.mesh;
    let normals = mesh.normals.as_ref()?.at(triangle as usize, &mesh.triangles);
    if normals[0] == normals[1] && normals[1] == normals[2] {
        return None;
    }
    let to_world = DMat3::from_mat4(instance.world_from_model).inverse().transpose();
    let unit =
        normals.map(|n| (to_world * DVec3::from_array(n.map(f64::from))).normalize_or_zero());
    Some(unit)
}
