//! What polished surfaces mirror where nothing else is there: a soft sky over a darker ground.
//!
//! A metal has no colour of its own, it shows its surroundings. With lights alone all of a polished
//! body but its highlights is of one tone, and its form is lost. A bright sky, a horizon and a
//! ground give each direction its own value.
//!
//! Idea: the colour depends on the height `y` of the mirror direction over the horizon alone: it
//! runs from the horizon to the zenith, and from the horizon to the nadir, and a smooth step at the
//! horizon leads from ground to sky. A rough surface mixes directions, so the step widens with
//! roughness. How much is mirrored is Schlick's term with the rim of rough surfaces lowered:
//! `F0 + (max(1 - roughness, F0) - F0) (1 - N·V)^5`.
//!
//! In:   a point, its microfacet coefficients, the upward direction in the space of both.
//! Out:  mirrored light, linear RGB; a white mirror that sees as much sky as ground mirrors about
//!       0.5 on average.
//! Cost: constant, no transcendental function.
//! Source: \[Lagarde 2011\] for the Fresnel term; the sky is ours.

use crate::cook_torrance::{DIELECTRIC_F0, Microfacet};
use crate::{Rgb, Surface, reflect};
use vitral_math::lanes::{Lanes, V3};

/// Linear RGB straight up, at the horizon on the sky's side, on the ground's side, and straight
/// down.
const ZENITH: Rgb = [0.55, 0.66, 0.85];
const SKY_HORIZON: Rgb = [1.0, 1.0, 1.0];
const GROUND_HORIZON: Rgb = [0.22, 0.21, 0.20];
const NADIR: Rgb = [0.10, 0.09, 0.085];
/// Half the height of the step at the horizon for a perfect mirror, and what full roughness adds to
/// it.
const STEP: f32 = 0.05;
const STEP_ROUGH: f32 = 1.0;

/// The sky over a scene, in the space of shading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Unit vector upwards.
    pub up: [f32; 3],
}

impl Sky {
    /// What a point mirrors of the sky.
    #[inline(always)]
    pub fn mirrored<T: Lanes>(&self, s: &Surface<T>, m: &Microfacet<T>) -> V3<T> {
        let one = s.n.x.splat(1.0);
        let towards = reflect(s.n, s.v);
        let y = towards.dot(V3::splat(one, self.up));
        let roughness = m.roughness.saturate();
        let light = radiance(y, roughness);

        mirrored_share(s, m).times(light).scale(m.occlusion)
    }
}

/// The share of the surroundings' light that a point mirrors at the angle at which it is seen.
#[inline(always)]
pub(crate) fn mirrored_share<T: Lanes>(s: &Surface<T>, m: &Microfacet<T>) -> V3<T> {
    let one = s.n.x.splat(1.0);
    let (roughness, metallic) = (m.roughness.saturate(), m.metallic.saturate());
    let away = -s.n.dot(s.v).saturate() + 1.0;
    let squared = away * away;
    let rim = squared * squared * away;
    m.base_color.map(
        #[inline(always)]
        |channel| {
            let dielectric = one * DIELECTRIC_F0;
            let f0 = dielectric + (channel - dielectric) * metallic;
            f0 + ((one - roughness).max(f0) - f0) * rim
        },
    )
}

/// The light from directions `y` above the horizon (their sine, `-1..=1`), mixed as roughness mixes
/// them.
#[inline(always)]
fn radiance<T: Lanes>(y: T, roughness: T) -> V3<T> {
    let one = y.splat(1.0);
    let zero = y.splat(0.0);

    // Above and below the horizon.
    let (height, depth) = (y.max(zero), (-y).max(zero));
    let color = |rgb: Rgb| V3::splat(one, rgb);
    let sky = color(SKY_HORIZON) + (color(ZENITH) - color(SKY_HORIZON)).scale(height);
    let ground = color(GROUND_HORIZON) + (color(NADIR) - color(GROUND_HORIZON)).scale(depth);

    // The step between them.
    let part = (y / (roughness * (2.0 * STEP_ROUGH) + 2.0 * STEP) + 0.5).saturate();
    let part = part * part * (-part * 2.0 + 3.0);
    ground + (sky - ground).scale(part)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a ball's point mirrors whose mirror direction is `towards`, seen along it.
    fn mirrored(towards: [f32; 3], metallic: f32, roughness: f32) -> Rgb {
        let v = V3::splat(0.0f32, towards).normalize();
        let s = Surface { position: V3::splat(0.0f32, [0.0; 3]), n: v, v };
        let m = Microfacet {
            base_color: V3::splat(0.0f32, [1.0, 0.5, 0.0]),
            metallic,
            roughness,
            occlusion: 1.0,
        };
        Sky { up: [0.0, 1.0, 0.0] }.mirrored(&s, &m).to_array()
    }

    #[test]
    fn polished_metal_shows_sky_and_ground_in_its_colour() {
        let close = |a: Rgb, b: Rgb| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(close(mirrored([0.0, 1.0, 0.0], 1.0, 0.0), [ZENITH[0], 0.5 * ZENITH[1], 0.0]));
        assert!(close(mirrored([0.0, -1.0, 0.0], 1.0, 0.0), [NADIR[0], 0.5 * NADIR[1], 0.0]));
        // On the horizon half of each.
        let half = 0.5 * (SKY_HORIZON[0] + GROUND_HORIZON[0]);
        assert!((mirrored([1.0, 0.0, 0.0], 1.0, 0.0)[0] - half).abs() < 1e-6);
        // A dielectric mirrors 4 % straight on, in no colour.
        assert!(close(mirrored([0.0, 1.0, 0.0], 0.0, 0.0), ZENITH.map(|c| DIELECTRIC_F0 * c)));
    }

    #[test]
    fn roughness_softens_the_horizon() {
        let contrast = |roughness| {
            mirrored([1.0, 0.1, 0.0], 1.0, roughness)[0]
                - mirrored([1.0, -0.1, 0.0], 1.0, roughness)[0]
        };
        assert!(contrast(0.0) > 0.7 && contrast(0.5) < 0.4 && contrast(1.0) < 0.2);
        assert!(contrast(1.0) > 0.05, "what faces up is still brighter");
    }
}
