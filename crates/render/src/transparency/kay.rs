//! Kay's transparency: curved thin glass is darker at its rim, where light has a longer way through
//! it.
//!
//! The transmission depends on how much the surface faces the viewer, by the z component of its
//! unit normal in view space: `kt = kmin + (kmax - kmin) (1 - (1 - |nz|)^m)`. Seen from the front
//! (`|nz| = 1`) it is `kmax`, at the silhouette (`nz = 0`) `kmin`; the larger `m`, the thinner the
//! glass looks. 2 and 3 are usual.
//!
//! In:   kmin, kmax, nz, m. Out: kt.
//! Cost: one power.
//! Source: \[Kay & Greenberg 1979\]. Departs from one set of notes, which prints `nz^m`
//! (docs/course.md, E1): it agrees at both ends and is wrong between them.

use vitral_math::lanes::Lanes;

/// Transmission of a surface whose unit normal has the z component `nz` in view space.
#[inline(always)]
pub fn transmission<T: Lanes>(least: T, most: T, nz: T, exponent: T) -> T {
    let away = (-nz.abs() + 1.0).saturate();
    least + (most - least) * (-away.pow(exponent) + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn t9_f5_e1_interior_points_tell_the_formula_from_the_misprint() {
        for (nz, m, expected, misprint) in
            [(0.5f32, 2.0f32, 0.75f32, 0.25f32), (0.5, 3.0, 0.875, 0.125), (-0.5, 2.0, 0.75, 0.25)]
        {
            let kt = transmission(0.0, 1.0, nz, m);
            assert!(
                (kt - expected).abs() < 1e-5 && (kt - misprint).abs() > 0.4,
                "nz {nz}, m {m}: {kt}"
            );
        }
        // The ends cannot tell them apart.
        assert!((transmission(0.2f32, 0.9, 1.0, 2.0) - 0.9).abs() < 1e-6);
        assert!((transmission(0.2f32, 0.9, 0.0, 2.0) - 0.2).abs() < 1e-6);
        assert!((transmission(0.2f32, 0.9, 0.5, 2.0) - (0.2 + 0.7 * 0.75)).abs() < 1e-5);
    }
}
