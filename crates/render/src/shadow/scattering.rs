//! Scattered rays: the directions in which a translucent surface shows what is behind it.
//!
//! What a rough surface lets through is a mean over directions. The square of the two numbers that
//! choose one is cut into cells, and one direction is taken in each (stratified sampling), so that
//! a few dozen stand for all. Chance is a hash of the place in the picture: a picture is the same
//! however it is made, and neighbours err differently. A ray that was scattered before is scattered
//! again in one direction only: its siblings see to the others.
//!
//! In:   number and seed of a ray, the direction of clear glass. Out: its direction.
//! Source: \[Cook, Porter & Carpenter 1984\]; the lobe is that of `vitral_light`.

use super::hash::hash;
use vitral_light::scattered;
use vitral_math::DVec3;

/// Cells of the directions that stand for a lobe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Strata {
    columns: u32,
    rows: u32,
}

impl Strata {
    /// At least `samples` of them, and at most as many as complete a row.
    pub(crate) fn new(samples: u32) -> Self {
        let columns = samples.max(1).isqrt();
        Self { columns, rows: samples.max(1).div_ceil(columns) }
    }

    /// How many there are.
    pub(crate) fn count(self) -> u32 {
        self.columns * self.rows
    }

    /// The direction of cell `i` round `axis`, unit, by the chance that `seed` gives.
    pub(crate) fn direction(self, i: u32, seed: u32, exponent: f32, axis: DVec3) -> DVec3 {
        let chance = hash(seed ^ hash(i + 1));
        let [u, v] = [chance & 0xffff, chance >> 16].map(|bits| (f64::from(bits) + 0.5) / 65_536.0);
        let (column, row) = (f64::from(i % self.columns), f64::from(i / self.columns));
        let (u, v) = ((column + u) / f64::from(self.columns), (row + v) / f64::from(self.rows));
        let [x, y, z] = scattered(u, v, exponent);
        let (right, up) = axis.any_orthonormal_pair();
        (right * x + up * y + axis * z).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stand_for_the_lobe() {
        assert_eq!([1, 2, 16, 32, 33].map(|n| Strata::new(n).count()), [1, 2, 16, 35, 35]);
        let strata = Strata::new(1024);
        let axis = DVec3::new(0.0, 0.6, -0.8);
        let mean: DVec3 = (0..strata.count()).map(|i| strata.direction(i, 7, 40.0, axis)).sum();
        let mean = mean / f64::from(strata.count());
        assert!((mean.dot(axis) - 41.0 / 42.0).abs() < 1e-3, "{mean}");
        assert!((mean - axis * mean.dot(axis)).length() < 5e-3, "{mean}");
    }
}
