//! Where the samples of a pixel lie.
//!
//! The positions are those of a rooks placement: each sample has a row and a column of its own, so
//! that nearly horizontal and nearly vertical edges both show as many steps as there are samples.
//! With four samples it is the rotated grid that GPUs use. Beyond sixteen there are thirty-two: one
//! in each cell of a mask of 4 columns and 8 rows, so that they are spread evenly, and in a rooks
//! placement still. An edge through the pixel, at any angle, is off by 1/64 of the pixel's area on
//! average, by at most 1/32 in nine cases of ten, and by 0.07 where it is worst.

use crate::SUBPIXEL;

/// Most samples a pixel.
pub(crate) const MOST_SAMPLES: usize = 32;

/// Columns of the thirty-two samples, from the top row to the bottom one: of 60,000 placements that
/// annealing tried, with one sample in each cell of 4 columns and 8 rows, the one whose worst
/// half-planes are nearest to their areas.
const MASK_4X8: [i32; 32] = [
    2, 22, 14, 26, 9, 31, 4, 16, 19, 24, 10, 0, 5, 27, 18, 13, 23, 8, 30, 3, 15, 20, 28, 7, 12, 25,
    1, 17, 21, 6, 11, 29,
];

/// Sample positions within a pixel, in 1/256 pixel from its top left corner, sorted from top to
/// bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SamplePattern {
    positions: Vec<[i32; 2]>,
    /// The same by axis, padded with the first.
    axes: [[i32; MOST_SAMPLES]; 2],
    extent: [[i32; 2]; 2],
}

impl SamplePattern {
    /// Most samples of a pixel.
    pub const MAX: usize = MOST_SAMPLES;

    /// `count` samples: 1 to 16, or 32 for whatever is more. One sample lies at the centre.
    pub fn new(count: usize) -> Self {
        if count > 16 {
            let place = |i: i32| (2 * i + 1) * SUBPIXEL / 64;
            return Self::at(
                (0..).zip(MASK_4X8).map(|(row, column)| [place(column), place(row)]).collect(),
            );
        }
        let n = count.clamp(1, 16) as i32;
        // Multiplicative step modulo n + 1, coprime to it and near the golden section: rows i get
        // columns (i+1)k mod (n+1) - 1.
        let gcd = |mut a: i32, mut b: i32| {
            while b != 0 {
                (a, b) = (b, a % b);
            }
            a
        };
        let step = (1..=n)
            .filter(|&k| gcd(k, n + 1) == 1)
            .min_by_key(|&k| (k * 1000 - (n + 1) * 382).abs())
            .unwrap_or(1);
        let place = |i: i32| ((2 * i + 1) * SUBPIXEL) / (2 * n);
        Self::at((0..n).map(|i| [place((i + 1) * step % (n + 1) - 1), place(i)]).collect())
    }

    /// Samples at given positions in 1/256 pixel, 1 to 16 or 32 of them.
    pub fn at(positions: Vec<[i32; 2]>) -> Self {
        let extent = [0, 1].map(|k| {
            let values = positions.iter().map(|p| p[k]);
            [values.clone().min().unwrap_or(0), values.max().unwrap_or(0)]
        });
        let axes = [0, 1].map(|k: usize| {
            std::array::from_fn(|s| {
                positions.get(s).or(positions.first()).map_or(0, |p: &[i32; 2]| p[k])
            })
        });
        Self { positions, axes, extent }
    }

    /// How many there are.
    #[allow(clippy::len_without_is_empty)]
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Position `[x, y]` of sample `s` in 1/256 pixel.
    #[inline(always)]
    pub fn position(&self, s: usize) -> [i32; 2] {
        self.positions[s]
    }

    /// Along an axis, samples lie on the lines `offset + k * 2^shift` (1/256 pixel),
    /// `[offset, shift]`: the largest such step.
    pub fn lines(&self, axis: usize) -> [i32; 2] {
        let first = self.positions[0][axis];
        let apart = self.positions.iter().fold(SUBPIXEL, |bits, p| bits | (p[axis] - first));
        let shift = apart.trailing_zeros() as i32;
        [first & ((1 << shift) - 1), shift]
    }

    /// All samples' x, then y, in 1/256 pixel; beyond the last sample the first one's.
    #[inline(always)]
    pub(crate) fn axes(&self) -> &[[i32; MOST_SAMPLES]; 2] {
        &self.axes
    }

    /// Position of sample `s` in pixels, `0..1`.
    pub fn offset(&self, s: usize) -> [f32; 2] {
        self.positions[s].map(|p| p as f32 / SUBPIXEL as f32)
    }

    /// Smallest and largest x, then y, over all samples.
    #[inline(always)]
    pub(crate) fn extent(&self) -> [[i32; 2]; 2] {
        self.extent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pattern_is_a_rooks_placement() {
        assert_eq!(SamplePattern::new(1).positions, [[128, 128]]);
        assert_eq!(SamplePattern::new(4).positions, [[96, 32], [224, 96], [32, 160], [160, 224]]);
        for n in (1..=16).chain([32]) {
            let pattern = SamplePattern::new(n);
            for k in 0..2 {
                let mut seen: Vec<_> =
                    pattern.positions.iter().map(|p| p[k] as usize * n / 256).collect();
                seen.sort_unstable();
                assert_eq!(seen, (0..n).collect::<Vec<_>>(), "{n} samples, axis {k}");
            }
        }
    }

    #[test]
    fn thirty_two_samples_fill_a_mask_of_4_columns_and_8_rows() {
        let pattern = SamplePattern::new(32);
        let mut cells: Vec<_> =
            pattern.positions.iter().map(|[x, y]| (y / 32) * 4 + x / 64).collect();
        cells.sort_unstable();
        assert_eq!(cells, (0..32).collect::<Vec<_>>());
        assert_eq!(SamplePattern::new(17), pattern);
    }

    /// The part of the pixel where `a x + b y <= c`, for a and b of at least 0.
    fn area([a, b]: [f64; 2], c: f64) -> f64 {
        let square = |t: f64| if t > 0.0 { t * t } else { 0.0 };
        match (a < 1e-9, b < 1e-9) {
            (true, _) => (c / b).clamp(0.0, 1.0),
            (_, true) => (c / a).clamp(0.0, 1.0),
            _ => (square(c) - square(c - a) - square(c - b) + square(c - a - b)) / (2.0 * a * b),
        }
    }

    #[test]
    fn p18_coverage_by_the_mask_is_the_area_beside_an_edge_at_any_angle() {
        // Mean and largest error, in 1/32, and the part of the edges with at most 1/32.
        let errors = |count: usize| {
            let pattern = SamplePattern::new(count);
            let (mut sum, mut largest, mut small, mut edges) = (0.0, 0.0f64, 0, 0);
            for direction in 0..360 {
                let (s, c) = vitral_math::func::sin_cos((f64::from(direction) + 0.37).to_radians());
                let low = c.min(0.0) + s.min(0.0);
                for step in 1..100 {
                    let at = f64::from(step) / 100.0 * (c.abs() + s.abs());
                    let inside = |p: &&[i32; 2]| {
                        (c * f64::from(p[0]) + s * f64::from(p[1])) / 256.0 - low <= at
                    };
                    let covered =
                        pattern.positions.iter().filter(inside).count() as f64 / count as f64;
                    let error = 32.0 * (covered - area([c.abs(), s.abs()], at)).abs();
                    (sum, largest, edges) = (sum + error, largest.max(error), edges + 1);
                    small += i32::from(error <= 1.0);
                }
            }
            (sum / f64::from(edges), largest, f64::from(small) / f64::from(edges))
        };
        let (mean, largest, small) = errors(32);
        assert!(mean < 0.55 && largest < 2.4 && small > 0.85, "{mean} {largest} {small}");
        let (sixteen, ..) = errors(16);
        assert!(sixteen > 1.5 * mean, "{sixteen}");
    }
}
