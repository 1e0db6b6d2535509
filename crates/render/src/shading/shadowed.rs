//! Which part of each light arrives at eight points, and the shadows as pictures of their own.
//!
//! Shadows are found where the surface is, once for each point, whatever the shading model: flat and Gouraud shading
//! illuminate centres and corners, but a shadow's edge runs across facets.

use super::FrameConstants;
use super::facets::Subject;
use super::geometry::{Slots, Surface, blend3};
use super::hits::Along;
use super::phong::interpolated_normal;
use crate::shadow::{Place, grey, places};
use vitral_light::Rgb;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{LANES, Simd, V3};

/// The part of each colour of each light at each point; empty without shadows. Adds the rays that it took.
#[inline(always)]
pub(crate) fn arriving<S: Simd>(
    constants: &FrameConstants<'_>,
    subject: &Subject<'_>,
    slots: &Slots,
    surface: &Surface<S>,
    along: Option<&Along>,
    rays: &mut u64,
) -> Vec<[[f32; LANES]; 3]> {
    let Some(shadows) = constants.shadows else { return Vec::new() };
    let places = match along {
        Some(along) => along.places,
        None => world_places(constants, subject, slots, weights(surface)),
    };
    let numbers = constants.light_numbers.iter();
    numbers.map(|&light| each(&places, |place| shadows.arriving(light, place, rays))).collect()
}

/// An answer for each place. Unused lanes repeat the last: they are not asked again.
fn each(places: &[Place; LANES], mut answer: impl FnMut(&Place) -> Rgb) -> [[f32; LANES]; 3] {
    let mut answers = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        let repeated = lane > 0 && places[lane] == places[lane - 1];
        let part = if repeated { answers.map(|channel| channel[lane - 1]) } else { answer(&places[lane]) };
        (0..3).for_each(|k| answers[k][lane] = part[k]);
    }
    answers
}

#[inline(always)]
pub(super) fn weights<S: Simd>(surface: &Surface<S>) -> [[f32; LANES]; 3] {
    let [a, b, c] = surface.weights;
    [a.to_array(), b.to_array(), c.to_array()]
}

pub(super) fn world_places(
    constants: &FrameConstants<'_>,
    subject: &Subject<'_>,
    slots: &Slots,
    weights: [[f32; LANES]; 3],
) -> [Place; LANES] {
    let instance = &constants.view.session.world.instances[subject.instance_index as usize];
    let turns = subject.instance.two_sided || subject.viewing.double_sided;
    places(constants.view, instance, turns, &slots.triangle, weights, [&slots.x, &slots.y])
}

/// Attached and cast shadow of each point: shares of the lights that have a place or a direction.
#[inline(always)]
pub(crate) fn shadow_shares<S: Simd>(
    constants: &FrameConstants<'_>,
    subject: &Subject<'_>,
    slots: &Slots,
    surface: &Surface<S>,
) -> [[f32; LANES]; 2] {
    let (position, normal) = (blend3(&surface.weights, &surface.positions), interpolated_normal(surface));
    let soa = |v: V3<_>| {
        let V3 { x, y, z }: V3<vitral_math::lanes::F32x8<S>> = v;
        [x.to_array(), y.to_array(), z.to_array()]
    };
    let (position, normal, facet) = (soa(position), soa(normal), soa(surface.facet_normal));
    let places = world_places(constants, subject, slots, weights(surface));
    let mut shares = [[0.0; LANES]; 2];
    for lane in 0..LANES {
        let at = |v: &[[f32; LANES]; 3]| V3::new(v[0][lane], v[1][lane], v[2][lane]);
        let [attached, cast] = shares_at(constants, at(&position), [at(&normal), at(&facet)], &places[lane]);
        (shares[0][lane], shares[1][lane]) = (attached, cast);
    }
    shares
}

fn shares_at(constants: &FrameConstants<'_>, position: V3<f32>, normals: [V3<f32>; 2], place: &Place) -> [f32; 2] {
    let (mut attached, mut cast, mut count) = (0.0, 0.0, 0.0);
    for (light, &number) in constants.lights.iter().zip(&constants.light_numbers) {
        let l = light.incident(position).l;
        if l.dot(l) == 0.0 {
            continue;
        }
        count += 1.0;
        if normals.iter().any(|n| n.dot(l) <= 0.0) {
            attached += 1.0;
        } else if let Some(shadows) = constants.shadows {
            cast += 1.0 - grey(shadows.arriving(number, place, &mut 0));
        }
    }
    if count == 0.0 { [0.0; 2] } else { [attached / count, cast / count] }
}
