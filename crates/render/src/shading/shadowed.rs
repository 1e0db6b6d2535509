//! Which part of each light reaches the points of a group, and the shadows as pictures of their
//! own.
//!
//! Shadows are found where the surface is, once for each point, whatever the shading model: flat
//! and Gouraud shading illuminate centres and corners, but a shadow's edge runs across facets.

use super::FrameConstants;
use super::facets::FacetTable;
use super::geometry::{F, Surface, point_weights, surface};
use super::material_constants::MaterialConstants;
use super::points::Points;
use super::shadow_edges::{self, Questions};
use super::slots::Slots;
use super::subject::Subject;
use super::terminator;
use crate::shadow::{LightVisibility, Placing, SurfacePoint, SurfacePoints, grey};
use std::cell::Cell;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{LANES, Simd, V3};

/// What reaches the points of a group.
#[derive(Default)]
pub(crate) struct GroupLight {
    /// Which part of each light reaches the side that is seen; empty without shadows.
    pub(crate) seen: Vec<LightVisibility>,
    /// The same for the other side of a translucent sheet.
    pub(crate) behind: Vec<LightVisibility>,
    /// Which part of ambient light arrives; empty without ambient occlusion.
    pub(crate) open: Vec<f32>,
}

impl GroupLight {
    /// What reaches these places, and if `both`, the other side of their facets. Adds the rays that
    /// it took.
    pub(crate) fn of_places(
        constants: &FrameConstants<'_>,
        both: bool,
        places: SurfacePoints,
        rays: &mut u64,
    ) -> Self {
        let open =
            constants.occlusion.map(|occlusion| occlusion.open(&places, rays)).unwrap_or_default();
        let seen = light_visibility_at(constants, &places, rays);
        let behind =
            if both { light_visibility_at(constants, &places.turned(), rays) } else { Vec::new() };
        Self { seen, behind, open }
    }
}

/// What reaches the points of a group that the eye sees. Adds the rays that it took.
pub(crate) fn group_light<S: Simd>(
    simd: S,
    constants: &FrameConstants<'_>,
    (subject, material): (&Subject<'_>, &MaterialConstants<'_>),
    points: &Points,
    order: &[u32],
    facets: &FacetTable,
    rays: &mut u64,
) -> GroupLight {
    if constants.shadows.is_none() && constants.occlusion.is_none() {
        return GroupLight::default();
    }

    // Find the places of the points, eight at a time.
    let placing = placing(constants, subject);
    let corners = placing.facets(simd, facets.triangles());
    let mut all = SurfacePoints::with_capacity(order.len());
    for (eight, records) in order.chunks(LANES).zip(facets.of_point.chunks(LANES)) {
        simd.vectorize(
            #[inline(always)]
            || {
                let slots = Slots::of_points(points, eight, records, subject.first_facet);
                let weights = place_weights(simd, subject, facets, &slots);
                let facets = std::array::from_fn(|lane| &corners[slots.record[lane] as usize]);
                let places =
                    placing.places(simd, (&slots.triangle, facets), &weights, [&slots.x, &slots.y]);
                all.push(places, eight.len());
            },
        );
    }

    // Find which part of the lights and of ambient light reaches them.
    let mut light =
        GroupLight::of_places(constants, material.scatters.is_some() && subject.turns(), all, rays);

    // Sample the lights at each sample near the edges of shadows.
    if constants.view.pattern.len() > 1
        && constants.shadows.is_some_and(|shadows| !shadows.is_smooth())
    {
        let asked = Cell::new(0);

        // Find the places that are asked for, eight at a time.
        let place = |questions: &Questions| {
            let mut places = SurfacePoints::with_capacity(questions.numbers.len());
            let all: Vec<(u32, [f32; 2])> =
                questions.numbers.iter().copied().zip(questions.screen.iter().copied()).collect();
            for eight in all.chunks(LANES) {
                simd.vectorize(
                    #[inline(always)]
                    || {
                        let mut slots = Slots {
                            triangle: [0; LANES],
                            record: [0; LANES],
                            x: [0.0; LANES],
                            y: [0.0; LANES],
                        };
                        for lane in 0..LANES {
                            let (number, [x, y]) = eight[lane.min(eight.len() - 1)];
                            slots.record[lane] = facets.of_point[number as usize];
                            slots.triangle[lane] =
                                points.facet[order[number as usize] as usize] - subject.first_facet;
                            (slots.x[lane], slots.y[lane]) = (x, y);
                        }
                        let weights = place_weights(simd, subject, facets, &slots);
                        let facets =
                            std::array::from_fn(|lane| &corners[slots.record[lane] as usize]);
                        let screen = [&slots.x, &slots.y];
                        let eight_places =
                            placing.places(simd, (&slots.triangle, facets), &weights, screen);
                        places.push(eight_places, eight.len());
                    },
                );
            }
            places
        };

        // Count the rays of these samples.
        let ask = |places: &SurfacePoints| {
            let mut rays = 0;
            let parts = light_visibility_at(constants, places, &mut rays);
            asked.set(asked.get() + rays);
            parts
        };
        shadow_edges::soften(constants, points, order, &mut light.seen, place, ask);
        *rays += asked.get();
    }
    light
}

/// Weights of the facets' corners at eight points on the screen.
#[inline(always)]
fn place_weights<S: Simd>(
    simd: S,
    subject: &Subject<'_>,
    facets: &FacetTable,
    slots: &Slots,
) -> [F<S>; 3] {
    if !subject.viewing.screen_linear() {
        return point_weights(simd, &facets.records, slots);
    }
    let mut surface = surface(simd, &facets.records, slots);
    surface.screen_linear = true;
    surface.place_weights()
}

/// Which part of each light reaches these places; empty without shadows. Adds the rays that it
/// took.
fn light_visibility_at(
    constants: &FrameConstants<'_>,
    places: &SurfacePoints,
    rays: &mut u64,
) -> Vec<LightVisibility> {
    let Some(shadows) = constants.shadows else { return Vec::new() };
    let of_light = |(number, &light): (usize, &usize)| {
        let mut parts = LightVisibility::new(places.len(), [0.0; 3]);
        shadows.light_visibility(light, places, &mut parts, rays);
        terminator::soften(constants, number, places, &mut parts, rays);
        parts
    };
    constants.light_numbers.iter().enumerate().map(of_light).collect()
}

/// Where eight points are in the world.
#[inline(always)]
pub(super) fn world_places<S: Simd>(
    simd: S,
    constants: &FrameConstants<'_>,
    subject: &Subject<'_>,
    slots: &Slots,
    weights: &[F<S>; 3],
) -> [SurfacePoint; LANES] {
    let placing = placing(constants, subject);
    let facets = placing.eight_facets(simd, &slots.triangle);
    let places =
        placing.places(simd, (&slots.triangle, facets.each_ref()), weights, [&slots.x, &slots.y]);
    std::array::from_fn(|lane| places.get(lane))
}

fn placing<'a>(constants: &FrameConstants<'a>, subject: &Subject<'_>) -> Placing<'a> {
    let instance = &constants.view.session.world.instances[subject.instance_index as usize];
    Placing::new(constants.view, instance, subject.turns())
}

/// Attached and cast shadow of eight points, the first the `first` of its group: shares of the
/// lights that have a place or a direction. Nothing hides a light where it does not shine: beside a
/// spot's cone, behind an area light. A surface faces away from a light in its plane, wherever
/// rounding puts it.
#[inline(always)]
pub(crate) fn shadow_shares<S: Simd>(
    constants: &FrameConstants<'_>,
    surface: &Surface<F<S>>,
    light_visibility: &[LightVisibility],
    first: usize,
) -> [[f32; LANES]; 2] {
    let (position, normal) = (surface.position(), surface.interpolated_normal());
    let soa = |v: V3<_>| {
        let V3 { x, y, z }: V3<F<S>> = v;
        [x.to_array(), y.to_array(), z.to_array()]
    };
    let (position, normal, facet) = (soa(position), soa(normal), soa(surface.facet_normal));
    let mut shares = [[0.0; LANES]; 2];
    for lane in 0..LANES {
        let at = |v: &[[f32; LANES]; 3]| V3::new(v[0][lane], v[1][lane], v[2][lane]);
        let part = |light: usize| {
            light_visibility.get(light).map_or(1.0, |parts| grey(parts.get(first + lane)))
        };
        let [attached, cast] = shares_at(constants, at(&position), [at(&normal), at(&facet)], part);
        (shares[0][lane], shares[1][lane]) = (attached, cast);
    }
    shares
}

fn shares_at(
    constants: &FrameConstants<'_>,
    position: V3<f32>,
    normals: [V3<f32>; 2],
    part: impl Fn(usize) -> f32,
) -> [f32; 2] {
    let (mut attached, mut cast, mut count) = (0.0, 0.0, 0.0);
    for (number, light) in constants.lights.iter().enumerate() {
        let incident = light.incident(position);
        let l = incident.l;
        if l.dot(l) == 0.0 {
            continue;
        }
        count += 1.0;
        let rounding = light.direction_rounding(position);
        if normals.iter().any(|n| n.dot(l) <= rounding) {
            attached += 1.0;
        } else if incident.intensity > 0.0 {
            cast += 1.0 - part(number);
        }
    }
    if count == 0.0 { [0.0; 2] } else { [attached / count, cast / count] }
}
