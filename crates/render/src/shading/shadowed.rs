//! Which part of each light arrives at the points of a group, and the shadows as pictures of their own.
//!
//! Shadows are found where the surface is, once for each point, whatever the shading model: flat and Gouraud shading
//! illuminate centres and corners, but a shadow's edge runs across facets.

use super::FrameConstants;
use super::facets::{FacetTable, Subject};
use super::geometry::{Surface, blend3, surface};
use super::group::slots;
use super::phong::interpolated_normal;
use super::points::Points;
use crate::shadow::places;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{LANES, Simd, V3};

/// The part of each light at each point of a group, filled up to whole eights; empty without shadows.
pub(crate) fn arriving<S: Simd>(
    simd: S,
    constants: &FrameConstants<'_>,
    subject: &Subject<'_>,
    points: &Points,
    order: &[u32],
    facets: &FacetTable,
) -> Vec<Vec<f32>> {
    let Some(shadows) = constants.shadows else { return Vec::new() };
    let instance = &constants.view.session.world.instances[subject.instance_index as usize];
    let turns = subject.instance.two_sided || subject.viewing.double_sided;
    let mut all = Vec::with_capacity(order.len());
    for (eight, records) in order.chunks(LANES).zip(facets.of_point.chunks(LANES)) {
        let slots = slots(points, eight, records, subject.first_facet);
        let weights = simd.vectorize(
            #[inline(always)]
            || {
                let [a, b, c] = surface(simd, &facets.records, &slots).weights;
                [a.to_array(), b.to_array(), c.to_array()]
            },
        );
        let eight_places = places(constants.view, instance, turns, &slots.triangle, weights, [&slots.x, &slots.y]);
        all.extend_from_slice(&eight_places[..eight.len()]);
    }
    let part = |&light: &usize| {
        let mut parts = vec![0.0; all.len().next_multiple_of(LANES)];
        shadows.arriving(light, &all, &mut parts[..all.len()]);
        parts
    };
    constants.light_numbers.iter().map(part).collect()
}

/// Attached and cast shadow of eight points, the first the `first` of its group: shares of the lights that have a place
/// or a direction.
#[inline(always)]
pub(crate) fn shadow_shares<S: Simd>(
    constants: &FrameConstants<'_>,
    surface: &Surface<S>,
    arriving: &[Vec<f32>],
    first: usize,
) -> [[f32; LANES]; 2] {
    let (position, normal) = (blend3(&surface.weights, &surface.positions), interpolated_normal(surface));
    let soa = |v: V3<_>| {
        let V3 { x, y, z }: V3<vitral_math::lanes::F32x8<S>> = v;
        [x.to_array(), y.to_array(), z.to_array()]
    };
    let (position, normal, facet) = (soa(position), soa(normal), soa(surface.facet_normal));
    let mut shares = [[0.0; LANES]; 2];
    for lane in 0..LANES {
        let at = |v: &[[f32; LANES]; 3]| V3::new(v[0][lane], v[1][lane], v[2][lane]);
        let part = |light: usize| arriving.get(light).map_or(1.0, |parts| parts[first + lane]);
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
        let l = light.incident(position).l;
        if l.dot(l) == 0.0 {
            continue;
        }
        count += 1.0;
        if normals.iter().any(|n| n.dot(l) <= 0.0) {
            attached += 1.0;
        } else {
            cast += 1.0 - part(number);
        }
    }
    if count == 0.0 { [0.0; 2] } else { [attached / count, cast / count] }
}
