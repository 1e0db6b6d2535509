//! Translucent surfaces: light is scattered on its way through.
//!
//! A polished pane lets light go on in one direction. A rough one is made of tiny facets that bend
//! it in different directions, as they also mirror it in different directions: what is behind is
//! blurred, the more the farther it is, and by the same roughness that makes highlights wide. So
//! the directions in which light leaves lie round the one of clear glass as a highlight lies round
//! the mirror direction, `cos^n`, with the exponent of the material's highlight: 1 scatters nearly
//! all over the half space, 1000 hardly blurs.
//!
//! A light source is too small to be found by looking through the surface. What it sends through is
//! taken as scattered evenly: the side that is turned away from it glows, `f Ip max(0, -N·L)`, in
//! proportion to the transmission.
//!
//! In:   reflectance; numbers from 0 to 1; lights and a point in one space. Out: exponent;
//!       directions; light, linear RGB.
//! Source: \[Cook, Porter & Carpenter 1984\] for scattered directions, \[Walter et al. 2007\] for
//! one roughness of both, \[Rushmeier & Torrance 1990\] for diffuse transmission. Departs from the
//! second: the lobe is the empirical one.

use crate::surface::tint;
use crate::{PreparedLight, Reflectance};
use vitral_math::func;
use vitral_math::lanes::{Lanes, V3};

/// The widest and the narrowest lobe.
const EXPONENTS: (f32, f32) = (1.0, 1000.0);
/// The RMS slope of facets that counts as none.
const MIRROR_SLOPE: f32 = 1e-4;

/// The exponent of the directions in which a surface scatters what passes it: that of its
/// highlight, from 1 to 1000.
pub fn scattering_exponent(reflectance: &Reflectance) -> f32 {
    // Not `clamp`: what is not a number becomes the least.
    highlight_exponent(reflectance).max(EXPONENTS.0).min(EXPONENTS.1)
}

/// The exponent of the directions in which a surface that is not quite smooth shows mirror images:
/// that of its highlight. `None` where the images are sharp: smoother surfaces blur by less than an
/// eighth of a degree.
pub fn mirroring_exponent(reflectance: &Reflectance) -> Option<f32> {
    const SHARP: f32 = 200_000.0;
    let exponent = highlight_exponent(reflectance);
    (exponent < SHARP).then(|| exponent.max(EXPONENTS.0))
}

/// The exponent of a surface's highlight round the mirror direction.
fn highlight_exponent(reflectance: &Reflectance) -> f32 {
    match *reflectance {
        Reflectance::Phong { shininess, .. } => shininess,
        Reflectance::MetallicRoughness { roughness, .. } => {
            // As in `phong_from_microfacet`.
            let slope = (roughness * roughness).max(MIRROR_SLOPE);
            (2.0 / (slope * slope) - 2.0) * 0.25
        }
    }
}

/// A direction round +z, unit, from two numbers in `0..1` that are spread evenly: as dense as
/// `cos^exponent`.
pub fn scattered(u: f64, v: f64, exponent: f32) -> [f64; 3] {
    let z = func::pow(u.clamp(0.0, 1.0), 1.0 / (f64::from(exponent) + 1.0));
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = func::sin_cos(std::f64::consts::TAU * v);
    [r * cos, r * sin, z]
}

/// The light that comes through evenly from behind a surface which lets all of it pass: position
/// and unit normal on the viewer's side, `visibility(j)` as in [`crate::phong`], for the other
/// side.
#[inline(always)]
pub fn transmitted_light<T: Lanes>(
    lights: &[PreparedLight],
    position: V3<T>,
    n: V3<T>,
    visibility: impl Fn(usize) -> V3<T>,
) -> V3<T> {
    let zero = n.x.splat(0.0);
    let mut sum = V3::new(zero, zero, zero);
    for (j, light) in lights.iter().enumerate() {
        let incident = light.incident(position);
        let behind = (-n.dot(incident.l)).positive();
        let white = V3::new(zero, zero, zero).map(
            #[inline(always)]
            |channel| channel.splat(1.0),
        );
        sum = sum
            + tint(white, light.diffuse).times(visibility(j).scale(incident.intensity * behind));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Light, LightKind};
    use vitral_math::{DMat4, dvec3};

    #[test]
    fn rough_surfaces_scatter_widely() {
        let phong =
            |shininess| Reflectance::Phong { ka: [0.0; 3], kd: [0.0; 3], ks: [0.0; 3], shininess };
        let exponents = [-1.0, 0.0, 40.0, 1e9, f32::NAN].map(|n| scattering_exponent(&phong(n)));
        assert_eq!(exponents, [1.0, 1.0, 40.0, 1000.0, 1.0]);
        let rough = |roughness| Reflectance::MetallicRoughness {
            base_color: [1.0; 3],
            metallic: 0.0,
            roughness,
        };
        assert_eq!([0.0, 1.0].map(|r| scattering_exponent(&rough(r))), [1000.0, 1.0]);
        assert_eq!([0.0, 0.03].map(|r| mirroring_exponent(&rough(r))), [None; 2]);
        let fifth = mirroring_exponent(&rough(0.2)).unwrap();
        assert!((fifth / 312.0 - 1.0).abs() < 1e-3, "{fifth}");
        let half = scattering_exponent(&rough(0.5));
        assert!((half - 7.5).abs() < 1e-4, "m = 1/4: (32 - 2) / 4, {half}");
    }

    #[test]
    fn directions_are_as_dense_as_the_lobe() {
        // The mean of the cosine over cos^n is (n + 1) / (n + 2).
        for n in [1.0, 7.0, 40.0] {
            let (mut mean, count) = ([0.0; 3], 64);
            for i in 0..count * count {
                let [u, v] =
                    [i % count, i / count].map(|k| (f64::from(k) + 0.5) / f64::from(count));
                let d = scattered(u, v, n);
                assert!((d.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-12);
                (0..3).for_each(|k| mean[k] += d[k] / f64::from(count * count));
            }
            let expected = f64::from(n + 1.0) / f64::from(n + 2.0);
            assert!(mean[0].abs() < 1e-9 && mean[1].abs() < 1e-9, "{mean:?}");
            assert!((mean[2] - expected).abs() < 1e-3, "n {n}: {}, not {expected}", mean[2]);
        }
    }

    #[test]
    fn t1_the_side_that_is_turned_away_from_the_light_glows() {
        let kind = LightKind::Directional { direction: dvec3(0.0, -0.6, 0.8) };
        let light = Light { kind, diffuse: [1.0, 0.5, 0.0], ..Light::default() };
        let light = PreparedLight::new(&light, &DMat4::IDENTITY).unwrap();
        let at = V3::new(0.0f32, 0.0, 0.0);
        let glow = |z: f32, part: f32| {
            transmitted_light(std::slice::from_ref(&light), at, V3::new(0.0, 0.0, z), |_| {
                V3::new(part, part, part)
            })
        };
        let v = glow(1.0, 0.5);
        assert!((v.x - 0.4).abs() < 1e-6 && (v.y - 0.2).abs() < 1e-6 && v.z == 0.0, "{v:?}");
        assert_eq!(glow(-1.0, 1.0).x, 0.0, "in front of the light nothing comes through");
    }
}
