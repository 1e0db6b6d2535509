//! From the coefficients of one model to those of the other, so that every material can be seen
//! under every model.
//!
//! Two numbers of a highlight can be matched, its width and its height. Near the mirror direction,
//! Phong's `cos^n` resembles Blinn's with `4n`, and Blinn's `cos^b α ≈ exp(-b α²/2)` resembles
//! Beckmann's `exp(-α²/m²)` for `b = 2/m² - 2`, the form that also holds for rough surfaces.
//! Straight on, the physical highlight is `F0 / (4 m²)` high, Phong's `ks`. The way there and back
//! does not always lead home: the models know different things.
//!
//! Source: \[Blinn 1977\] for the factor between the exponents; course notes P (highlights have the
//!         light's colour, except on metals).

use crate::{DIELECTRIC_F0, LEAST_SLOPE, Microfacet, Phong};
use vitral_math::lanes::Lanes;

/// The largest exponent that the mapping gives, that of MTL files.
const MOST_SHININESS: f32 = 1000.0;

/// Phong coefficients for a metallic-roughness material:
/// * `ka` = base colour: ambient light shows metals too,
/// * `kd` = base colour · (1 - metallic),
/// * `ks` = `F0 / (4 m²)`, reduced in proportion if a channel would exceed 1; `F0` = 0.04 for
///   dielectrics, the base colour for metals,
/// * `n` = `(2/m² - 2) / 4`, from 1 to 1000, with `m = roughness²`.
#[inline(always)]
pub fn phong_from_microfacet<T: Lanes>(m: &Microfacet<T>) -> Phong<T> {
    let one = m.roughness.splat(1.0);
    let metallic = m.metallic.saturate();
    let dielectric = -metallic + 1.0;
    let roughness = m.roughness.saturate();
    let slope = (roughness * roughness).max(one.splat(LEAST_SLOPE));
    let inverse_square = one / (slope * slope);

    let f0 = m.base_color.map(
        #[inline(always)]
        |channel| dielectric * DIELECTRIC_F0 + channel * metallic,
    );
    let brightest = f0.x.max(f0.y).max(f0.z).max(one.splat(1e-6));
    let height = (inverse_square * 0.25).min(one / brightest);
    let shininess = ((inverse_square * 2.0 - 2.0) * 0.25).max(one).min(one.splat(MOST_SHININESS));
    Phong {
        ka: m.base_color.scale(m.occlusion),
        kd: m.base_color.scale(dielectric),
        ks: f0.scale(height),
        shininess,
    }
}

/// Metallic-roughness coefficients for a Phong material:
/// * metallic = saturation of `ks`, `1 - least / greatest` channel: coloured highlights are a
///   metal's,
/// * base colour = from `kd` (dielectric) to `ks` (metal) in that proportion,
/// * roughness = `√m` with `m² = 2 / (4n + 2)`, so that highlights are as wide; but for
///   dielectrics, whose `F0` is always 0.04, at least `m² = 0.01 / ks`, so that they are not
///   higher. Without highlight (`ks = 0`) it is 1.
///
/// `ka` has no counterpart: the base colour reflects ambient light.
#[inline(always)]
pub fn microfacet_from_phong<T: Lanes>(k: &Phong<T>) -> Microfacet<T> {
    let one = k.shininess.splat(1.0);
    let tiny = one.splat(1e-6);
    let greatest = k.ks.x.max(k.ks.y).max(k.ks.z);
    let least = k.ks.x.min(k.ks.y).min(k.ks.z);
    let metallic = (-(least / greatest.max(tiny)) + 1.0).saturate();
    let metallic = T::select(greatest.le(tiny), one.splat(0.0), metallic);

    let wide = one.splat(2.0) / (k.shininess.positive() * 4.0 + 2.0);
    let low = (-metallic + 1.0) * (DIELECTRIC_F0 * 0.25) / greatest.max(tiny);
    let square = wide.max(low).min(one);
    let base_color = k.kd.scale(-metallic + 1.0) + k.ks.scale(metallic);
    Microfacet { base_color, metallic, roughness: square.sqrt().sqrt(), occlusion: one }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::lanes::V3;

    fn grey(value: f32) -> V3<f32> {
        V3::splat(0.0, [value; 3])
    }

    #[test]
    fn p29_microfacets_become_a_highlight_of_the_same_width_and_height() {
        let k = phong_from_microfacet(&Microfacet {
            base_color: grey(0.5),
            metallic: 0.0,
            roughness: 0.5,
            occlusion: 1.0,
        });
        // m = 1/4: n = (32 - 2)/4, ks = 0.04 * 4.
        assert_eq!(k.shininess, 7.5);
        assert!((k.ks.x - 0.16).abs() < 1e-6 && k.kd.x == 0.5 && k.ka.x == 0.5);

        let gold = Microfacet {
            base_color: V3::new(1.0f32, 0.75, 0.25),
            metallic: 1.0,
            roughness: 0.3,
            occlusion: 1.0,
        };
        let k = phong_from_microfacet(&gold);
        assert_eq!(
            (k.kd.x, k.ks.x, k.ks.y, k.ks.z),
            (0.0, 1.0, 0.75, 0.25),
            "limited to 1, the hue kept"
        );
        let mirror = phong_from_microfacet(&Microfacet { roughness: 0.0, ..gold });
        assert_eq!(mirror.shininess, 1000.0);
        let black = phong_from_microfacet(&Microfacet {
            base_color: grey(0.0),
            metallic: 1.0,
            roughness: 0.3,
            occlusion: 1.0,
        });
        assert_eq!((black.ks.x, black.kd.x), (0.0, 0.0));
    }

    #[test]
    fn p35_coloured_highlights_are_metal() {
        let k =
            Phong { ka: grey(0.1), kd: V3::new(0.8f32, 0.1, 0.1), ks: grey(0.5), shininess: 40.0 };
        let apple = microfacet_from_phong(&k);
        assert_eq!((apple.metallic, apple.base_color.x, apple.base_color.y), (0.0, 0.8, 0.1));
        assert!(
            (apple.roughness - 0.02f32.sqrt().sqrt()).abs() < 1e-6,
            "as high as ks, {}",
            apple.roughness
        );
        let copper =
            microfacet_from_phong(&Phong { ks: V3::new(1.0, 0.5, 0.0), kd: grey(0.2), ..k });
        assert_eq!((copper.metallic, copper.base_color.x, copper.base_color.y), (1.0, 1.0, 0.5));
        assert!((copper.roughness - (2.0f32 / 162.0).sqrt().sqrt()).abs() < 1e-6, "as wide as n");
        let chalk = microfacet_from_phong(&Phong { ks: grey(0.0), ..k });
        assert_eq!((chalk.metallic, chalk.roughness), (0.0, 1.0));
    }

    #[test]
    fn a_dielectric_comes_home() {
        for roughness in [0.35f32, 0.5, 0.7, 0.8] {
            let m = Microfacet {
                base_color: V3::new(0.2f32, 0.4, 0.6),
                metallic: 0.0,
                roughness,
                occlusion: 1.0,
            };
            let back = microfacet_from_phong(&phong_from_microfacet(&m));
            assert!(
                (back.roughness - roughness).abs() < 0.01,
                "{roughness} became {}",
                back.roughness
            );
            assert_eq!((back.metallic, back.base_color.y), (0.0, 0.4));
        }
    }
}
