//! Refraction: the direction of a ray behind the surface between two media.
//!
//! Light is slower in the denser medium, so a ray that meets the surface at an angle bends:
//! `η1 sin θi = η2 sin θt`. With `L` from the point back along the ray, `N` on the side of `L` and
//! `ηr = η1 / η2`, the part of the transmitted vector in the surface is `-ηr` times that of `L`,
//! and its length is 1, which gives
//!
//! `T = [ηr (N·L) - √(1 - ηr² (1 - (N·L)²))] N - ηr L`.
//!
//! Where the radicand is negative no direction has the length 1: nothing passes, the surface
//! reflects everything (total internal reflection). On the way out the caller turns `N` round, so
//! that `N·L` stays positive, and swaps the media.
//!
//! In:   unit vectors in one space, indices of refraction. Out: a unit vector.
//! Cost: one square root.
//! Source: \[Heckbert 1989\]; course notes F, which print four forms, and T, which has Snell's law.

use vitral_math::DVec3;

/// The unit direction in which a ray goes on that came from the unit direction `l` (towards where
/// it came from) through a surface with unit normal `n`, `n·l ≥ 0`; `eta_r = η1 / η2` with `l` in
/// medium 1. `None`: total internal reflection.
pub fn transmitted(n: DVec3, l: DVec3, eta_r: f64) -> Option<DVec3> {
    let cos_i = n.dot(l);
    let radicand = 1.0 - eta_r * eta_r * (1.0 - cos_i * cos_i);
    (radicand >= 0.0).then(|| n * (eta_r * cos_i - radicand.sqrt()) - l * eta_r)
}

/// The share of light that a clear surface reflects, of both polarisations in equal parts, by
/// Fresnel's formulas: of a ray at these cosines to the normal, before and behind the surface;
/// `eta_r = η1 / η2`.
pub fn reflected_share(cos_before: f64, cos_behind: f64, eta_r: f64) -> f64 {
    let across = (eta_r * cos_before - cos_behind) / (eta_r * cos_before + cos_behind);
    let within = (eta_r * cos_behind - cos_before) / (eta_r * cos_behind + cos_before);
    (0.5 * (across * across + within * within)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use vitral_math::{dvec3, func};

    /// The unit vector that is `degrees` off the z axis, towards x.
    fn tilted(degrees: f64) -> DVec3 {
        let (sin, cos) = func::sin_cos(degrees.to_radians());
        dvec3(sin, 0.0, cos)
    }

    /// The notes' four forms, in their order.
    fn printed_forms(n: DVec3, l: DVec3, eta_r: f64) -> [DVec3; 4] {
        let cos_i = n.dot(l);
        let sin_i = (1.0 - cos_i * cos_i).sqrt();
        let sin_t = eta_r * sin_i;
        let cos_t = (1.0 - sin_t * sin_t).sqrt();
        let m = (n * cos_i - l) / sin_i;
        [
            m * sin_t - n * cos_t,
            (n * cos_i - l) * (sin_t / sin_i) - n * cos_t,
            n * (eta_r * cos_i - cos_t) - l * eta_r,
            n * (eta_r * cos_i - (1.0 - eta_r * eta_r * (1.0 - cos_i * cos_i)).sqrt()) - l * eta_r,
        ]
    }

    #[test]
    fn t2_e4_the_number_of_the_course() {
        let t = transmitted(DVec3::Z, tilted(40.0), 1.0 / 1.5).unwrap();
        assert!(t.abs_diff_eq(dvec3(-0.42852507, 0.0, -0.90352989), 1e-8), "{t}");
        let angle = func::asin(-t.x).to_degrees();
        assert!((angle - 25.373_993_9).abs() < 1e-7, "{angle}");
        let snell = func::asin(func::sin(40f64.to_radians()) / 1.5);
        assert!((func::asin(-t.x) - snell).abs() < 1e-12);
        // Between equal media nothing bends.
        assert!(
            transmitted(DVec3::Z, tilted(40.0), 1.0).unwrap().abs_diff_eq(-tilted(40.0), 1e-15)
        );
        // Straight on nothing bends either.
        assert_eq!(transmitted(DVec3::Z, DVec3::Z, 0.4), Some(DVec3::NEG_Z));
    }

    #[test]
    fn e4_beyond_the_critical_angle_nothing_passes() {
        let critical = func::asin(1.0 / 1.5).to_degrees();
        assert!(transmitted(DVec3::Z, tilted(critical - 1e-6), 1.5).is_some());
        assert_eq!(transmitted(DVec3::Z, tilted(critical + 1e-6), 1.5), None);
        // Into the denser medium everything passes, even a ray that grazes.
        let grazing = transmitted(DVec3::Z, tilted(90.0), 1.0 / 1.5).unwrap();
        assert!((-grazing.x - 1.0 / 1.5).abs() < 1e-12);
    }

    #[test]
    fn clear_surfaces_reflect_what_fresnel_says() {
        // 4 % head on, whichever way.
        assert!((reflected_share(1.0, 1.0, 1.0 / 1.5) - 0.04).abs() < 1e-12);
        assert!((reflected_share(1.0, 1.0, 1.5) - 0.04).abs() < 1e-12);
        // At Brewster's angle, whose tangent is 1.5, one polarisation passes whole: half of (1.25 /
        // 3.25)^2 is left.
        let (before, behind) = (1.0 / 3.25f64.sqrt(), 1.5 / 3.25f64.sqrt());
        let half = 0.5 * (1.25f64 / 3.25) * (1.25 / 3.25);
        assert!((reflected_share(before, behind, 1.0 / 1.5) - half).abs() < 1e-12);
        // All of it at a grazing angle.
        assert_eq!(reflected_share(0.0, 0.7, 1.0 / 1.5), 1.0);
    }

    proptest! {
        #[test]
        fn f10_the_four_printed_forms_agree(
            n in proptest::array::uniform3(-1.0f64..1.0),
            l in proptest::array::uniform3(-1.0f64..1.0),
            eta_r in 0.3f64..3.0,
        ) {
            let (n, l) = (DVec3::from_array(n).normalize_or_zero(), DVec3::from_array(l).normalize_or_zero());
            prop_assume!(n != DVec3::ZERO && l != DVec3::ZERO);
            let n = if n.dot(l) < 0.0 { -n } else { n };
            // The first two forms divide by the sine, the last two do not mind.
            prop_assume!(n.dot(l) < 0.999);
            let Some(t) = transmitted(n, l, eta_r) else {
                prop_assert!(eta_r * (1.0 - n.dot(l) * n.dot(l)).sqrt() > 1.0);
                return Ok(());
            };
            for form in printed_forms(n, l, eta_r) {
                prop_assert!(form.abs_diff_eq(t, 1e-12), "{form} {t}");
            }
            prop_assert!((t.length() - 1.0).abs() < 1e-12);
            prop_assert!(t.dot(n.cross(l)).abs() < 1e-12, "in the plane of N and L");
            prop_assert!(t.dot(n) <= 1e-12, "on the other side");
            // And back again, with the media swapped.
            if t.dot(n) < -1e-3 {
                let back = transmitted(-n, t, 1.0 / eta_r).unwrap();
                prop_assert!(back.abs_diff_eq(l, 1e-9));
            }
        }
    }
}
