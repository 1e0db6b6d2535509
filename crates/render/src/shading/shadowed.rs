//! What of each light arrives at the points of a group, and the shadows as pictures of their own.
//!
//! Shadows are found where the surface is, once for each point, whatever the shading model: flat and Gouraud shading
//! illuminate centres and corners, but a shadow's edge runs across facets.

use super::FrameConstants;
use super::facets::{FacetTable, Subject};
use super::frame_constants::MaterialConstants;
use super::geometry::{F, Slots, Surface, blend3, point_weights};
use super::group::slots;
use super::phong::interpolated_normal;
use super::points::Points;
use crate::shadow::{Place, Placing, grey};
use vitral_light::Rgb;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Simd, V3};

/// The part of each colour of a light at the points of a group, filled up to whole eights.
pub(crate) struct Arriving([Vec<f32>; 3]);

impl Arriving {
    fn new(parts: &[Rgb]) -> Self {
        let count = parts.len().next_multiple_of(LANES);
        let channel = |k: usize| {
            let mut channel: Vec<_> = parts.iter().map(|part| part[k]).collect();
            channel.resize(count, 0.0);
            channel
        };
        Self([channel(0), channel(1), channel(2)])
    }

    /// At eight points from the `first` of the group.
    #[inline(always)]
    pub(crate) fn eight<S: Simd>(&self, simd: S, first: usize) -> V3<F<S>> {
        let [r, g, b] = &self.0;
        let lanes = lanes::inlined(
            #[inline(always)]
            |channel: &Vec<f32>| F32x8::from_slice(simd, &channel[first..first + LANES]),
        );
        V3::new(lanes(r), lanes(g), lanes(b))
    }

    fn grey(&self, point: usize) -> f32 {
        grey([self.0[0][point], self.0[1][point], self.0[2][point]])
    }
}

/// What of each light arrives at the points of a group that the eye sees, and on the other side of a translucent sheet;
/// empty without shadows. Adds the rays that it took.
pub(crate) fn arriving<S: Simd>(
    simd: S,
    constants: &FrameConstants<'_>,
    (subject, material): (&Subject<'_>, &MaterialConstants<'_>),
    points: &Points,
    order: &[u32],
    facets: &FacetTable,
    rays: &mut u64,
) -> [Vec<Arriving>; 2] {
    if constants.shadows.is_none() {
        return [Vec::new(), Vec::new()];
    }
    let placing = placing(constants, subject);
    let corners = placing.facets(simd, facets.triangles());
    let mut all = Vec::with_capacity(order.len());
    for (eight, records) in order.chunks(LANES).zip(facets.of_point.chunks(LANES)) {
        let slots = slots(points, eight, records, subject.first_facet);
        let weights = point_weights(simd, &facets.records, &slots);
        let facets = std::array::from_fn(|lane| &corners[slots.record[lane] as usize]);
        simd.vectorize(
            #[inline(always)]
            || {
                let place = placing.places(simd, (&slots.triangle, facets), &weights, [&slots.x, &slots.y]);
                all.extend((0..eight.len()).map(place));
            },
        );
    }
    arriving_on_sides(constants, material.scatters.is_some() && subject.turns(), all, rays)
}

/// What of each light arrives at these places, and if asked, on the other side of their facets; empty without shadows.
/// Adds the rays that it took.
pub(crate) fn arriving_on_sides(
    constants: &FrameConstants<'_>,
    both: bool,
    mut places: Vec<Place>,
    rays: &mut u64,
) -> [Vec<Arriving>; 2] {
    let seen = arriving_at(constants, &places, rays);
    if !both {
        return [seen, Vec::new()];
    }
    places.iter_mut().for_each(|place| place.normal = -place.normal);
    [seen, arriving_at(constants, &places, rays)]
}

/// What of each light arrives at these places; empty without shadows. Adds the rays that it took.
fn arriving_at(constants: &FrameConstants<'_>, places: &[Place], rays: &mut u64) -> Vec<Arriving> {
    let Some(shadows) = constants.shadows else { return Vec::new() };
    let mut parts = vec![[0.0; 3]; places.len()];
    let of_light = |&light: &usize| {
        shadows.arriving(light, places, &mut parts, rays);
        Arriving::new(&parts)
    };
    constants.light_numbers.iter().map(of_light).collect()
}

#[inline(always)]
pub(super) fn weights<S: Simd>(surface: &Surface<S>) -> [[f32; LANES]; 3] {
    let [a, b, c] = surface.weights;
    [a.to_array(), b.to_array(), c.to_array()]
}

/// Where eight points are in the world.
#[inline(always)]
pub(super) fn world_places<S: Simd>(
    simd: S,
    constants: &FrameConstants<'_>,
    subject: &Subject<'_>,
    slots: &Slots,
    weights: [[f32; LANES]; 3],
) -> [Place; LANES] {
    let placing = placing(constants, subject);
    let facets = placing.eight_facets(simd, &slots.triangle);
    std::array::from_fn(placing.places(simd, (&slots.triangle, facets.each_ref()), &weights, [&slots.x, &slots.y]))
}

fn placing<'a>(constants: &FrameConstants<'a>, subject: &Subject<'_>) -> Placing<'a> {
    let instance = &constants.view.session.world.instances[subject.instance_index as usize];
    Placing::new(constants.view, instance, subject.turns())
}

/// Attached and cast shadow of eight points, the first the `first` of its group: shares of the lights that have a place
/// or a direction. Nothing hides a light where it does not shine: beside a spot's cone, behind an area light.
/// A surface faces away from a light in its plane, wherever rounding puts it.
#[inline(always)]
pub(crate) fn shadow_shares<S: Simd>(
    constants: &FrameConstants<'_>,
    surface: &Surface<S>,
    arriving: &[Arriving],
    first: usize,
) -> [[f32; LANES]; 2] {
    let (position, normal) = (blend3(&surface.weights, &surface.positions), interpolated_normal(surface));
    let soa = |v: V3<_>| {
        let V3 { x, y, z }: V3<F<S>> = v;
        [x.to_array(), y.to_array(), z.to_array()]
    };
    let (position, normal, facet) = (soa(position), soa(normal), soa(surface.facet_normal));
    let mut shares = [[0.0; LANES]; 2];
    for lane in 0..LANES {
        let at = |v: &[[f32; LANES]; 3]| V3::new(v[0][lane], v[1][lane], v[2][lane]);
        let part = |light: usize| arriving.get(light).map_or(1.0, |parts| parts.grey(first + lane));
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
