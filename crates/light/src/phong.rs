//! The empirical models: ambient, Lambert, Phong, Blinn–Phong.
//!
//! What a surface reflects is the sum of three parts. Ambient light, which comes from everywhere,
//! is reflected in the proportion `ka`. Light from a source spreads evenly in all directions
//! (diffuse), in proportion to `kd` and to how much of the beam the tilted surface catches,
//! `cos θ = N·L`. And a glossy surface sends a beam round the mirror direction `R` (specular),
//! which fades with the angle to the viewer like `cos^n`; Blinn measures the angle between the
//! normal and the vector half way between light and viewer instead, which is four times as tolerant
//! with the exponent.
//!
//! `I = Ia ka + Σj S_j f_j [ I_j kd max(0, N·L) + I_j ks max(0, R·V)^n ]`, the specular term 0
//! unless `N·L > 0`; the ambient colour of each light adds to `Ia`, attenuated but not shadowed.
//!
//! In:   lights and a point in one space; coefficients in linear RGB.
//! Out:  linear RGB, diffuse and specular apart.
//! Cost: one power for each light that reaches the front of the surface.
//! Source: \[Lambert 1760\], \[Phong 1975\], \[Blinn 1977\]; course notes L and P.
//! Departs from the notes: the clamps, which they leave out.

use crate::surface::tint;
use crate::{Illumination, PreparedLight, Reflected, Rgb, Surface, reflect};
use vitral_math::lanes::{Lanes, V3};

/// Coefficients of the empirical models, linear RGB.
#[derive(Clone, Copy, Debug)]
pub struct Phong<T> {
    /// Reflected part of ambient light.
    pub ka: V3<T>,
    /// Diffusely reflected part.
    pub kd: V3<T>,
    /// Specularly reflected part.
    pub ks: V3<T>,
    /// Specular exponent; a negative one counts as 0.
    pub shininess: T,
}

/// What a point reflects by an empirical model.
///
/// `illumination` chooses the terms: [`Illumination::Ambient`], [`Illumination::Lambert`],
/// [`Illumination::Phong`] or [`Illumination::BlinnPhong`]. [`Illumination::Constant`] reflects
/// nothing (see [`crate::constant_color`]); the others count as Phong. `visibility(j)` says how
/// much of each colour of light `j` is not in shadow, `0..=1`; it does not touch ambient light. A
/// light is in front of the surface where `N·L` is more than what `grazing` says, usually 0; where
/// rounding decides whether a light in the surface's plane is in front,
/// [`PreparedLight::direction_rounding`] keeps highlights from coming in specks.
#[inline(always)]
pub fn phong<T: Lanes>(
    illumination: Illumination,
    lights: &[PreparedLight],
    global_ambient: Rgb,
    s: &Surface<T>,
    k: &Phong<T>,
    visibility: impl Fn(usize) -> V3<T>,
    grazing: impl Fn(&PreparedLight) -> T,
) -> Reflected<T> {
    let zero = s.n.x.splat(0.0);
    let mut sum =
        Reflected { diffuse: tint(k.ka, global_ambient), specular: V3::new(zero, zero, zero) };
    if illumination == Illumination::Constant {
        return Reflected { diffuse: sum.specular, ..sum };
    }
    let shininess = k.shininess.positive();
    for (j, light) in lights.iter().enumerate() {
        let incident = light.incident(s.position);
        if light.ambient != [0.0; 3] {
            sum.diffuse = sum.diffuse + tint(k.ka, light.ambient).scale(incident.ambient_intensity);
        }
        if illumination == Illumination::Ambient {
            continue;
        }

        // Diffuse: the beam spreads over 1/cos of its width, and not over the back. Area lights
        // send many beams.
        let n_l = s.n.dot(incident.l).positive();
        let visible = visibility(j);
        let arriving = visible.scale(incident.intensity);
        let caught = match light.irradiance(s.position, s.n) {
            Some(irradiance) => visible.scale(irradiance),
            None => arriving.scale(n_l),
        };
        sum.diffuse = sum.diffuse + tint(k.kd, light.diffuse).times(caught);

        // Specular: only where the light is in front of the surface.
        if illumination == Illumination::Lambert {
            continue;
        }
        let in_front = grazing(light).lt(n_l);
        if !T::any(in_front) {
            continue;
        }
        let cos = match illumination {
            Illumination::BlinnPhong => s.n.dot((incident.l + s.v).normalize()),
            _ => reflect(s.n, incident.l).dot(s.v),
        };

        // Away from the mirror direction the power is 0 (unless the exponent is), and need not be
        // computed.
        let shining = in_front & (zero.lt(cos) | shininess.le(zero));
        if !T::any(shining) {
            continue;
        }
        // Above 1 where OpenGL gives normals that are longer: it shines all the more.
        let lobe = T::select(shining, cos.positive().pow(shininess), zero);
        sum.specular = sum.specular + tint(k.ks, light.specular).times(arriving.scale(lobe));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Light, LightKind};
    use vitral_math::{DMat4, dvec3};

    fn sun(from: [f64; 3]) -> PreparedLight {
        let kind = LightKind::Directional { direction: -dvec3(from[0], from[1], from[2]) };
        let light = Light { kind, ambient: [0.1, 0.2, 0.3], ..Light::default() };
        PreparedLight::new(&light, &DMat4::IDENTITY).unwrap()
    }

    /// Diffuse red and specular red of a surface that faces the viewer.
    fn red(illumination: Illumination, from: [f64; 3], shininess: f32) -> (f32, f32) {
        let z = V3::new(0.0f32, 0.0, 1.0);
        let s = Surface { position: V3::splat(0.0, [0.0; 3]), n: z, v: z };
        let k = Phong {
            ka: V3::splat(0.0, [0.5; 3]),
            kd: V3::splat(0.0, [0.25; 3]),
            ks: V3::splat(0.0, [1.0; 3]),
            shininess,
        };
        let r = phong(
            illumination,
            &[sun(from)],
            [0.2; 3],
            &s,
            &k,
            |_| V3::new(1.0, 1.0, 1.0),
            |_| 0.0,
        );
        (r.diffuse.x, r.specular.x)
    }

    #[test]
    fn each_model_adds_its_term() {
        let above = [0.0, 0.0, 1.0];
        assert_eq!(red(Illumination::Constant, above, 5.0), (0.0, 0.0));
        assert_eq!(red(Illumination::Ambient, above, 5.0), (0.15, 0.0));
        assert_eq!(red(Illumination::Lambert, above, 5.0), (0.4, 0.0));
        assert_eq!(red(Illumination::Phong, above, 5.0), (0.4, 1.0));
        assert_eq!(red(Illumination::BlinnPhong, above, 5.0), (0.4, 1.0));
    }

    #[test]
    fn e13_a_light_behind_gives_exactly_nothing() {
        // Exponent 0 would be 1 everywhere without the clamp; grazing light from behind has R close
        // to V for Blinn.
        for from in [[0.0, 0.0, -1.0], [1.0, 0.0, -1e-3], [1.0, 0.0, 0.0]] {
            for model in [Illumination::Phong, Illumination::BlinnPhong] {
                assert_eq!(red(model, from, 0.0), (0.15, 0.0), "{model} from {from:?}");
            }
        }
    }
}
