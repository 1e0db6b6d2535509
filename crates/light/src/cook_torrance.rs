//! The physical model: a surface made of tiny mirrors.
//!
//! Seen closely, a glossy surface consists of facets, each a perfect mirror, tilted at random. Only
//! the facets whose normal is the halfway vector `H` between light and viewer send light to the
//! viewer. How many they are says the distribution `D`; how much of them hides behind neighbours,
//! for the light or for the viewer, the geometric term `G`; how much a mirror of this material
//! reflects at this angle, the Fresnel term `F`. What a dielectric does not mirror enters it and
//! comes out again, coloured and in all directions: the diffuse part. A metal swallows it, but
//! mirrors in colour.
//!
//! `specular = π F D G / (4 N·L N·V) · N·L`, with
//! * `D = exp(-(tan α / m)²) / (π m² cos⁴ α)`, `α` between `N` and `H`, `m = roughness²`
//!   (Beckmann),
//! * `G = min(1, 2 N·H N·V / V·H, 2 N·H N·L / V·H)` (V-shaped grooves),
//! * `F = F0 + (1 - F0) (1 - V·H)^5`, `F0` = 0.04 for dielectrics, the base colour for metals
//!   (Schlick).
//!
//! `diffuse = (1 - metallic) base (1 - F(N·L)) (1 - F(N·V)) N·L`: light is mirrored on its way in
//! and on its way out, so that both parts together never exceed what arrives. The factor π belongs
//! to the scale of the house, in which a white Lambert surface reflects 1 of 1.
//!
//! In:   lights and a point in one space; base colour in linear RGB.
//! Out:  linear RGB, diffuse and specular apart.
//! Cost: one exponential and three divisions for each light in front of the surface.
//! Source: \[Cook & Torrance 1982\]; \[Beckmann & Spizzichino 1963\] for `D`; \[Schlick 1994\] for
//! `F`. Departs from it: Schlick's form instead of Fresnel's, because it needs no index of
//! refraction per channel, is finite for `F0 = 1`, and stays within a hundredth of the exact curve
//! for glass. `m` is at least 0.01, where the highlight of a point is about as wide as the mirrored
//! disc of the sun; `N·V` at least 0.001. Ambient light is reflected by the base colour, also by
//! metals, which would be black without surroundings to mirror.

use crate::surface::tint;
use crate::{PreparedLight, Reflected, Rgb, Surface};
use vitral_math::lanes::{Lanes, V3, inlined};

/// Reflectance of a dielectric at normal incidence (index of refraction 1.5).
pub const DIELECTRIC_F0: f32 = 0.04;
/// Least RMS slope of the facets: highlights stay finite.
pub const LEAST_SLOPE: f32 = 0.01;
/// Least cosine to the viewer, and least cosine between viewer and halfway vector.
const LEAST_COSINE: f32 = 1e-3;

/// Coefficients of the physical model.
#[derive(Clone, Copy, Debug)]
pub struct Microfacet<T> {
    /// Albedo of a dielectric, specular colour of a metal; linear RGB, `0..=1`.
    pub base_color: V3<T>,
    /// 0: dielectric, 1: metal; clamped.
    pub metallic: T,
    /// 0: mirror, 1: rough; clamped. Its square is the RMS slope `m` of the facets.
    pub roughness: T,
    /// How much of the ambient light arrives, `0..=1`.
    pub occlusion: T,
}

/// What a point reflects by the physical model. `visibility` as in [`crate::phong`].
#[inline(always)]
pub fn cook_torrance<T: Lanes>(
    lights: &[PreparedLight],
    global_ambient: Rgb,
    s: &Surface<T>,
    m: &Microfacet<T>,
    visibility: impl Fn(usize) -> V3<T>,
) -> Reflected<T> {
    // Blend the reflectance at normal incidence between dielectric and metal.
    let zero = s.n.x.splat(0.0);
    let metallic = m.metallic.saturate();
    let f0 = m.base_color.map(
        #[inline(always)]
        |channel| mix(channel.splat(DIELECTRIC_F0), channel, metallic),
    );
    let n_v = s.n.dot(s.v).max(zero.splat(LEAST_COSINE)).min(zero.splat(1.0));

    // Light that enters a dielectric must also get out towards the viewer.
    let inside = (-metallic + 1.0) * (-schlick(zero.splat(DIELECTRIC_F0), n_v) + 1.0);
    let albedo = m.base_color.scale(inside);
    let facets = Facets::new(m.roughness);

    // Start with the ambient light.
    let ambient = m.base_color.scale(m.occlusion);
    let mut sum =
        Reflected { diffuse: tint(ambient, global_ambient), specular: V3::new(zero, zero, zero) };
    for (j, light) in lights.iter().enumerate() {
        let incident = light.incident(s.position);
        if light.ambient != [0.0; 3] {
            sum.diffuse =
                sum.diffuse + tint(ambient, light.ambient).scale(incident.ambient_intensity);
        }
        let n_l = s.n.dot(incident.l).saturate();
        let visible = visibility(j);
        let arriving = visible.scale(incident.intensity);
        let enters = inlined(
            #[inline(always)]
            |cos: T| -schlick(zero.splat(DIELECTRIC_F0), cos) + 1.0,
        );
        // Add the light that enters, is scattered and gets out.
        let entering = match light.irradiance(s.position, s.n) {
            Some(irradiance) => {
                // At the angle whose cosine is the mean over the shape.
                let mean =
                    T::select(zero.lt(incident.intensity), irradiance / incident.intensity, n_l)
                        .saturate();
                visible.scale(irradiance * enters(mean))
            }
            None => arriving.scale(n_l * enters(n_l)),
        };
        sum.diffuse = sum.diffuse + tint(albedo, light.diffuse).times(entering);

        // Add the light that the microfacets mirror.
        let in_front = zero.lt(n_l);
        if !T::any(in_front) {
            continue;
        }
        let h = (incident.l + s.v).normalize();
        let v_h = s.v.dot(h).max(zero.splat(LEAST_COSINE)).min(zero.splat(1.0));
        let mirrored = T::select(in_front, facets.mirrored(s.n, h, n_l, n_v, v_h), zero);
        let fresnel = f0.map(
            #[inline(always)]
            |channel| schlick(channel, v_h),
        );
        sum.specular = sum.specular + tint(fresnel, light.specular).times(arriving.scale(mirrored));
    }
    sum
}

/// The factors of one light's highlight at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MicrofacetLobe {
    /// The halfway vector.
    pub h: [f32; 3],
    /// Cosine between normal and halfway vector.
    pub n_h: f32,
    /// What a mirror of this material reflects at this angle, `F`.
    pub fresnel: Rgb,
    /// `π D G / (4 N·V)`; 0 where the light is behind the surface.
    pub lobe: f32,
}

/// The factors of the highlight that light from the unit direction `l` makes.
pub(crate) fn microfacet_lobe(s: &Surface<f32>, m: &Microfacet<f32>, l: V3<f32>) -> MicrofacetLobe {
    let metallic = m.metallic.saturate();
    let f0 = m.base_color.map(|channel| mix(DIELECTRIC_F0, channel, metallic));
    let n_v = s.n.dot(s.v).clamp(LEAST_COSINE, 1.0);
    let n_l = s.n.dot(l).saturate();
    let h = (l + s.v).normalize();
    let v_h = s.v.dot(h).clamp(LEAST_COSINE, 1.0);
    let lobe =
        if n_l > 0.0 { Facets::new(m.roughness).mirrored(s.n, h, n_l, n_v, v_h) } else { 0.0 };
    let fresnel = f0.map(|channel| schlick(channel, v_h)).to_array();
    MicrofacetLobe { h: h.to_array(), n_h: s.n.dot(h), fresnel, lobe }
}

/// The statistics of the facets.
#[derive(Clone, Copy)]
struct Facets<T> {
    /// `1 / m²`.
    inverse_square: T,
}

impl<T: Lanes> Facets<T> {
    #[inline(always)]
    fn new(roughness: T) -> Self {
        let roughness = roughness.saturate();
        let m = (roughness * roughness).max(roughness.splat(LEAST_SLOPE));
        Self { inverse_square: m.splat(1.0) / (m * m) }
    }

    /// `π D G / (4 N·V)`: what facets that mirror everything send from the light to the viewer.
    #[inline(always)]
    fn mirrored(self, n: V3<T>, h: V3<T>, n_l: T, n_v: T, v_h: T) -> T {
        // The sine from the cross product, since 1 - cos² has no digits left for small angles.
        let across = n.cross(h);
        let n_h = n.dot(h).saturate().max(n_l.splat(LEAST_COSINE));
        let cos2 = n_h * n_h;
        let tan2 = across.dot(across) / cos2;
        let exponent = tan2 * self.inverse_square * -std::f32::consts::LOG2_E;
        let pi_d = exponent.exp2() * self.inverse_square / (cos2 * cos2);

        let groove = n_h * 2.0 / v_h;
        let g = (groove * n_v.min(n_l)).min(n_l.splat(1.0));
        pi_d * g / (n_v * 4.0)
    }
}

/// Fresnel reflection at an angle with cosine `cos` of a material that reflects `f0` straight on.
#[inline(always)]
fn schlick<T: Lanes>(f0: T, cos: T) -> T {
    let c = -cos + 1.0;
    let c2 = c * c;
    f0 + (-f0 + 1.0) * (c2 * c2 * c)
}

/// `a` at 0, `b` at 1.
#[inline(always)]
fn mix<T: Lanes>(a: T, b: T, t: T) -> T {
    a * (-t + 1.0) + b * t
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Light, LightKind};
    use vitral_math::{DMat4, DVec3, dvec3, func};

    fn sun(l: DVec3) -> PreparedLight {
        let light = Light { kind: LightKind::Directional { direction: -l }, ..Light::default() };
        PreparedLight::new(&light, &DMat4::IDENTITY).unwrap()
    }

    fn tilted(cos: f64) -> DVec3 {
        dvec3((1.0 - cos * cos).sqrt(), 0.0, cos)
    }

    fn reflected(l: DVec3, v: DVec3, base: f32, metallic: f32, roughness: f32) -> Reflected<f32> {
        let s = Surface {
            position: V3::splat(0.0, [0.0; 3]),
            n: V3::new(0.0, 0.0, 1.0),
            v: V3::splat(0.0, v.as_vec3().to_array()),
        };
        let m = Microfacet {
            base_color: V3::splat(0.0, [base; 3]),
            metallic,
            roughness,
            occlusion: 1.0,
        };
        cook_torrance(&[sun(l)], [0.0; 3], &s, &m, |_| V3::new(1.0, 1.0, 1.0))
    }

    #[test]
    fn straight_on_the_highlight_is_f0_over_four_m_squared() {
        let r = reflected(DVec3::Z, DVec3::Z, 0.5, 0.0, 0.5);
        assert!((r.specular.x - 0.04 / (4.0 * 0.25 * 0.25)).abs() < 1e-6, "{}", r.specular.x);
        assert!((r.diffuse.x - 0.5 * 0.96 * 0.96).abs() < 1e-6, "{}", r.diffuse.x);
        assert!((reflected(DVec3::Z, DVec3::Z, 1.0, 1.0, 1.0).specular.x - 0.25).abs() < 1e-6);
        let mirror = reflected(DVec3::Z, DVec3::Z, 1.0, 1.0, 0.0).specular.x;
        assert!(
            (mirror / 2500.0 - 1.0).abs() < 1e-5,
            "the least slope keeps a mirror finite: {mirror}"
        );
    }

    #[test]
    fn ambient_light_shows_metals_too() {
        let z = V3::new(0.0f32, 0.0, 1.0);
        let s = Surface { position: z, n: z, v: z };
        let m = Microfacet {
            base_color: V3::new(1.0f32, 0.5, 0.25),
            metallic: 1.0,
            roughness: 0.3,
            occlusion: 1.0,
        };
        let r = cook_torrance(&[], [0.5; 3], &s, &m, |_| V3::new(1.0, 1.0, 1.0));
        assert_eq!((r.diffuse.x, r.diffuse.y, r.diffuse.z, r.specular.x), (0.5, 0.25, 0.125, 0.0));
    }

    /// The part of a beam from direction `v` that a surface scatters, over the whole hemisphere. By
    /// symmetry it is the light that the viewer at `v` sees under a sky of 1, so the sky is summed
    /// up: the diffuse part over directions with density `cos/π`, the specular part over halfway
    /// vectors with the density of the facets.
    fn scattered(v: DVec3, base: f32, metallic: f32, roughness: f32) -> (f64, f64) {
        const STEPS: usize = 48;
        let m = f64::from((roughness * roughness).max(LEAST_SLOPE));
        let m2 = m * m;
        let (mut diffuse, mut specular) = (0.0, 0.0);
        for i in 0..STEPS {
            for j in 0..STEPS {
                let u = (i as f64 + 0.5) / STEPS as f64;
                let (sin, cos) =
                    func::sin_cos((j as f64 + 0.5) / STEPS as f64 * std::f64::consts::TAU);
                let ring = |cos_theta: f64| {
                    let sin_theta = (1.0 - cos_theta * cos_theta).sqrt();
                    dvec3(sin_theta * cos, sin_theta * sin, cos_theta)
                };
                let l = ring(u.sqrt());
                diffuse += f64::from(reflected(l, v, base, metallic, roughness).diffuse.x) / l.z;

                let cos2 = 1.0 / (1.0 - m2 * func::ln(u));
                let h = ring(cos2.sqrt());
                let l = h * (2.0 * h.dot(v)) - v;
                if l.z > 1e-6 && h.dot(v) > 0.0 {
                    // Density of h: D cos α; of l: that over 4 V·H. u is exp(-tan²/m²).
                    let density =
                        u / (std::f64::consts::PI * m2 * cos2 * cos2) * h.z / (4.0 * h.dot(v));
                    let seen = f64::from(reflected(l, v, base, metallic, roughness).specular.x);
                    specular += seen / std::f64::consts::PI / density;
                }
            }
        }
        let samples = (STEPS * STEPS) as f64;
        (diffuse / samples, specular / samples)
    }

    #[test]
    fn e12_never_reflects_more_than_arrives() {
        for roughness in [0.0, 0.1, 0.25, 0.5, 0.7, 1.0] {
            for cos in [0.02, 0.1, 0.3, 0.6, 0.9, 1.0] {
                for (base, metallic) in [(1.0, 1.0), (0.5, 1.0), (1.0, 0.0), (0.2, 0.0), (1.0, 0.5)]
                {
                    let (diffuse, specular) = scattered(tilted(cos), base, metallic, roughness);
                    let sum = diffuse + specular;
                    assert!(
                        sum <= 1.005,
                        "roughness {roughness}, cos {cos}, base {base}, metallic {metallic}: {diffuse} + {specular}"
                    );
                }
            }
        }
    }

    #[test]
    fn smooth_metal_reflects_nearly_everything_and_the_normalisation_holds() {
        let (_, specular) = scattered(tilted(0.8), 1.0, 1.0, 0.1);
        assert!((specular - 1.0).abs() < 0.01, "{specular}");
        let (diffuse, specular) = scattered(DVec3::Z, 1.0, 0.0, 0.3);
        assert!((specular - 0.04).abs() < 0.002, "{specular}");
        assert!((0.85..0.96).contains(&diffuse), "{diffuse}");
    }

    #[test]
    fn light_and_viewer_can_change_places() {
        for (a, b) in [(0.9, 0.3), (0.5, 0.7), (0.99, 0.2)] {
            let (l, v) = (tilted(a), dvec3(-tilted(b).x, 0.0, b));
            let there = reflected(l, v, 0.6, 0.4, 0.6);
            let back = reflected(v, l, 0.6, 0.4, 0.6);
            assert!(
                (f64::from(there.specular.x) / l.z - f64::from(back.specular.x) / v.z).abs() < 1e-5
            );
            assert!(
                (f64::from(there.diffuse.x) / l.z - f64::from(back.diffuse.x) / v.z).abs() < 1e-5
            );
        }
    }
}
