//! Linear transparency without refraction: a surface shows its own light and, in the proportion
//! `kt`, the colour behind.
//!
//! `I = (1 - kt) I1 + kt I2`, where `I2` is again such a mixture for as long as there are
//! transparent surfaces, down to the first opaque one or the background. `kt` is the same whatever
//! the angle, so thin curved glass looks flat: its rim lets as much light through as its middle.
//!
//! In:   the material's `kt`. Out: opacity `1 - kt`.
//! Source: \[Newell, Newell & Sancha 1972\]. Departs from the notes: they stop the recursion unless
//! `kt = 1`; it goes on for any `kt > 0` (docs/course.md, E2).

use vitral_light::{Material, Reflectance};
use vitral_math::lanes::Lanes;

/// Opacity of a surface.
#[inline(always)]
pub fn opacity<T: Lanes>(kt: T) -> T {
    (-kt + 1.0).saturate()
}

/// Which part of its `kt` glass keeps where it is metal in part, as a texture of metals says:
/// metals let nothing through.
#[inline(always)]
pub fn dielectric_part<T: Lanes>(material: &Material, metallic_factor: T) -> T {
    match material.reflectance {
        Reflectance::MetallicRoughness { metallic, .. } if material.glass => {
            opacity(metallic_factor * metallic)
        }
        _ => metallic_factor.splat(1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn t13_opacity_is_one_minus_kt() {
        assert!((opacity(0.3f32) - 0.7).abs() < 1e-6);
        assert_eq!([opacity(-1.0f32), opacity(2.0f32)], [1.0, 0.0]);
    }
}
