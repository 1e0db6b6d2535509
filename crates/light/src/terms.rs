//! The arithmetic of one light at one point, term by term: what [`phong`](fn@crate::phong) and
//! [`cook_torrance`](fn@crate::cook_torrance) add up, for whoever wants to see it.
//!
//! The terms come from the very functions that make pictures, asked about one light at a time, so
//! that their sum is what the picture shows, to the last bit. The factors beside them say how each
//! term comes about.
//!
//! In:   a light, a point and its coefficients, in one space. Out: [`LightTerms`].
//! Cost: twice that of illuminating the point.

use crate::cook_torrance::microfacet_lobe;
use crate::surface::tint;
use crate::{
    Illumination, Microfacet, Phong, PreparedLight, Reflected, Rgb, Surface, cook_torrance, phong,
    reflect,
};
use serde::Serialize;
use std::slice;
use vitral_math::lanes::V3;

/// What one light adds at one point, and how. All vectors in the space of the prepared lights.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct LightTerms {
    /// Unit vector `L` towards the light; zero for ambient light.
    pub l: [f32; 3],
    /// How far away the light is, where it has a place.
    pub distance: Option<f32>,
    /// What the distance leaves of the light, `f_att`.
    pub attenuation: f32,
    /// The share that a spot sends in this direction.
    pub spot: Option<f32>,
    /// The cosine of emission of an area light, 0 behind it.
    pub emission: Option<f32>,
    /// The product of these three factors; 0 for ambient light.
    pub intensity: f32,
    /// The same for the light's ambient colour; 1 for ambient light.
    pub ambient_intensity: f32,
    /// Which part of each colour arrives, `S`: 1 without shadow.
    pub visibility: Rgb,
    /// `N·L`, 0 where the light is behind the surface.
    pub n_l: f32,
    /// What a diffuse surface gets of an area light, in place of `intensity * N·L`.
    pub irradiance: Option<f32>,
    /// How the light is mirrored, where the model has highlights and the light is in front of the
    /// surface.
    pub highlight: Option<Highlight>,
    /// The light's colours: for the ambient, the diffuse and the specular coefficient.
    pub colors: [Rgb; 3],
    /// Ambient term: `Ia ka f`.
    pub ambient: Rgb,
    /// Diffuse term: `S f I kd N·L`.
    pub diffuse: Rgb,
    /// Specular term: `S f I ks lobe`.
    pub specular: Rgb,
}

/// How a light is mirrored towards the viewer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Highlight {
    /// The mirror direction of the light, with Phong's model.
    pub r: Option<[f32; 3]>,
    /// The halfway vector between light and viewer, with Blinn's and with microfacets.
    pub h: Option<[f32; 3]>,
    /// `R·V` or `N·H`.
    pub cosine: f32,
    /// The cosine to the power of the exponent; with microfacets `π D G / (4 N·V)`.
    pub lobe: f32,
    /// The Fresnel term, with microfacets.
    pub fresnel: Option<Rgb>,
}

impl LightTerms {
    /// Everything but the terms and the highlight.
    fn factors(light: &PreparedLight, s: &Surface<f32>, visibility: Rgb) -> Self {
        let (incident, arrival) = (light.incident(s.position), light.arrival(s.position));
        Self {
            l: incident.l.to_array(),
            distance: arrival.distance,
            attenuation: arrival.attenuation,
            spot: arrival.spot,
            emission: arrival.emission,
            intensity: incident.intensity,
            ambient_intensity: incident.ambient_intensity,
            visibility,
            n_l: s.n.dot(incident.l).max(0.0),
            irradiance: light.irradiance(s.position, s.n),
            highlight: None,
            colors: [light.ambient, light.diffuse, light.specular],
            ambient: [0.0; 3],
            diffuse: [0.0; 3],
            specular: [0.0; 3],
        }
    }

    /// The terms of a light alone, of which its ambient colour is apart.
    fn set(&mut self, ambient: V3<f32>, reflected: &Reflected<f32>) {
        self.ambient = ambient.to_array();
        self.diffuse = reflected.diffuse.to_array();
        self.specular = reflected.specular.to_array();
    }
}

/// A light without its ambient colour.
fn without_ambient(light: &PreparedLight) -> PreparedLight {
    let mut alone = light.clone();
    alone.ambient = [0.0; 3];
    alone
}

/// The term of the ambient light that comes from everywhere, `Ia ka`.
pub fn ambient_term(ka: [f32; 3], ambient: Rgb) -> Rgb {
    tint(V3::from_array(ka), ambient).to_array()
}

/// What `light` adds by an empirical model; as [`phong`](fn@crate::phong) with
/// [`PreparedLight::direction_rounding`].
pub fn phong_terms(
    illumination: Illumination,
    light: &PreparedLight,
    s: &Surface<f32>,
    k: &Phong<f32>,
    visibility: Rgb,
) -> LightTerms {
    let mut terms = LightTerms::factors(light, s, visibility);
    let (alone, visible) = (without_ambient(light), V3::from_array(visibility));
    let grazing = |light: &PreparedLight| light.direction_rounding(s.position);
    let reflected =
        phong(illumination, slice::from_ref(&alone), [0.0; 3], s, k, |_| visible, grazing);
    terms.set(tint(k.ka, light.ambient).scale(terms.ambient_intensity), &reflected);
    let mirrors = !matches!(
        illumination,
        Illumination::Constant | Illumination::Ambient | Illumination::Lambert
    );
    if mirrors && terms.n_l > light.direction_rounding(s.position) {
        terms.highlight =
            Some(highlight(illumination, s, k.shininess.max(0.0), V3::from_array(terms.l)));
    }
    terms
}

/// The highlight of a light in front of the surface.
fn highlight(
    illumination: Illumination,
    s: &Surface<f32>,
    shininess: f32,
    l: V3<f32>,
) -> Highlight {
    use vitral_math::lanes::Lanes;
    let (r, h) = match illumination {
        Illumination::BlinnPhong => (None, Some((l + s.v).normalize())),
        _ => (Some(reflect(s.n, l)), None),
    };
    let cosine = r.map_or(0.0, |r| r.dot(s.v)) + h.map_or(0.0, |h| s.n.dot(h));
    let lobe =
        if cosine > 0.0 || shininess <= 0.0 { cosine.positive().pow(shininess) } else { 0.0 };
    Highlight { r: r.map(V3::to_array), h: h.map(V3::to_array), cosine, lobe, fresnel: None }
}

/// What `light` adds by the physical model; as [`cook_torrance`](fn@crate::cook_torrance).
pub fn microfacet_terms(
    light: &PreparedLight,
    s: &Surface<f32>,
    m: &Microfacet<f32>,
    visibility: Rgb,
) -> LightTerms {
    let mut terms = LightTerms::factors(light, s, visibility);
    let (alone, visible) = (without_ambient(light), V3::from_array(visibility));
    let reflected = cook_torrance(slice::from_ref(&alone), [0.0; 3], s, m, |_| visible);
    let ambient = m.base_color.scale(m.occlusion);
    terms.set(tint(ambient, light.ambient).scale(terms.ambient_intensity), &reflected);
    if terms.n_l > 0.0 {
        let found = microfacet_lobe(s, m, V3::from_array(terms.l));
        let (h, cosine, lobe, fresnel) =
            (Some(found.h), found.n_h, found.lobe, Some(found.fresnel));
        terms.highlight = Some(Highlight { r: None, h, cosine, lobe, fresnel });
    }
    terms
}

/// Adds the terms up in the order of the models: the ambient light, then light by light.
pub fn sum_of_terms(ambient: Rgb, lights: &[LightTerms]) -> Reflected<f32> {
    let zero = V3::from_array([0.0; 3]);
    let mut sum = Reflected { diffuse: V3::from_array(ambient), specular: zero };
    for light in lights {
        if light.colors[0] != [0.0; 3] {
            sum.diffuse = sum.diffuse + V3::from_array(light.ambient);
        }
        sum.diffuse = sum.diffuse + V3::from_array(light.diffuse);
        sum.specular = sum.specular + V3::from_array(light.specular);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Attenuation, Light, LightKind};
    use vitral_math::{DMat4, DVec3, dvec3};

    fn lights() -> Vec<PreparedLight> {
        let at = dvec3(1.0, 2.0, 1.5);
        let spot = LightKind::Spot {
            position: at,
            direction: -at,
            cutoff: 0.6,
            inner: 0.2,
            exponent: 3.0,
        };
        let kinds = [
            LightKind::Ambient,
            LightKind::Directional { direction: dvec3(-0.3, -0.2, -1.0) },
            LightKind::Point { position: at },
            spot,
            LightKind::Point { position: DVec3::NEG_Z },
        ];
        let attenuation = Attenuation::Clamped { c1: 0.3, c2: 0.2, c3: 0.1 };
        let light =
            |kind| Light { kind, ambient: [0.1, 0.05, 0.0], attenuation, ..Light::default() };
        kinds.map(|kind| PreparedLight::new(&light(kind), &DMat4::IDENTITY).unwrap()).to_vec()
    }

    fn point(i: u16) -> Surface<f32> {
        let tilt = f32::from(i) * 0.07 - 0.6;
        let n = V3::new(tilt, 0.2 - tilt * 0.5, 1.0f32).normalize();
        Surface { position: V3::new(tilt, 0.1, 0.0), n, v: V3::new(0.1f32, -tilt, 2.0).normalize() }
    }

    #[test]
    fn terms_add_up_to_what_the_models_reflect() {
        let (lights, visible) = (lights(), |j: usize| [1.0, 0.5, 1.0 - j as f32 * 0.125]);
        let ka = V3::new(0.3f32, 0.2, 0.1);
        let k =
            Phong { ka, kd: V3::new(0.7, 0.6, 0.5), ks: V3::new(0.9, 0.8, 0.7), shininess: 7.5 };
        let m = Microfacet {
            base_color: V3::new(0.8, 0.5, 0.2),
            metallic: 0.4,
            roughness: 0.5,
            occlusion: 0.9f32,
        };
        let bits =
            |r: Reflected<f32>| [r.diffuse, r.specular].map(|v| v.to_array().map(f32::to_bits));
        let see = |j| V3::from_array(visible(j));
        for s in (0..20).map(point) {
            for model in [
                Illumination::Ambient,
                Illumination::Lambert,
                Illumination::Phong,
                Illumination::BlinnPhong,
            ] {
                let terms = |(j, light)| phong_terms(model, light, &s, &k, visible(j));
                let terms: Vec<_> = lights.iter().enumerate().map(terms).collect();
                let sum = sum_of_terms(ambient_term(k.ka.to_array(), [0.2; 3]), &terms);
                let rounding = |light: &PreparedLight| light.direction_rounding(s.position);
                let whole = phong(model, &lights, [0.2; 3], &s, &k, see, rounding);
                assert_eq!(bits(sum), bits(whole), "{model}");
                for t in &terms {
                    let factors = t.attenuation * t.spot.unwrap_or(1.0) * t.emission.unwrap_or(1.0);
                    assert!(t.intensity == factors || t.l == [0.0; 3], "{t:?}");
                    let lobe = t.highlight.map_or(0.0, |h| h.lobe);
                    let expected = k.ks.x * t.colors[2][0] * t.visibility[0] * t.intensity * lobe;
                    assert!((t.specular[0] - expected).abs() < 1e-6, "{model}: {t:?}");
                }
            }
            let terms = |(j, light)| microfacet_terms(light, &s, &m, visible(j));
            let terms: Vec<_> = lights.iter().enumerate().map(terms).collect();
            let sum = sum_of_terms(
                ambient_term(m.base_color.scale(m.occlusion).to_array(), [0.2; 3]),
                &terms,
            );
            assert_eq!(bits(sum), bits(cook_torrance(&lights, [0.2; 3], &s, &m, see)));
            for t in terms.iter().filter(|t| t.highlight.is_some()) {
                let h = t.highlight.unwrap();
                let expected =
                    h.fresnel.unwrap()[1] * t.colors[2][1] * t.visibility[1] * t.intensity * h.lobe;
                assert!((t.specular[1] - expected).abs() <= 1e-6 * expected.max(1.0), "{t:?}");
            }
        }
    }
}
