//! Where the samples of a pixel lie.
//!
//! The positions are those of a rooks placement: each sample has a row and a column of its own, so that nearly
//! horizontal and nearly vertical edges both show as many steps as there are samples. With four samples it is the
//! rotated grid that GPUs use.

use crate::SUBPIXEL;

/// Most samples a pixel.
pub(crate) const MOST_SAMPLES: usize = 16;

/// Sample positions within a pixel, in 1/256 pixel from its top left corner, sorted from top to bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SamplePattern {
    positions: Vec<[i32; 2]>,
    /// The same by axis, padded with the first.
    axes: [[i32; MOST_SAMPLES]; 2],
    extent: [[i32; 2]; 2],
}

impl SamplePattern {
    /// `count` samples, clamped to 1..=16. One sample lies at the centre.
    pub fn new(count: usize) -> Self {
        let n = count.clamp(1, 16) as i32;
        // Multiplicative step modulo n + 1, coprime to it and near the golden section: rows i get columns (i+1)k mod (n+1) - 1.
        let gcd = |mut a: i32, mut b: i32| {
            while b != 0 {
                (a, b) = (b, a % b);
            }
            a
        };
        let step =
            (1..=n).filter(|&k| gcd(k, n + 1) == 1).min_by_key(|&k| (k * 1000 - (n + 1) * 382).abs()).unwrap_or(1);
        let place = |i: i32| ((2 * i + 1) * SUBPIXEL) / (2 * n);
        Self::at((0..n).map(|i| [place((i + 1) * step % (n + 1) - 1), place(i)]).collect())
    }

    /// Samples at given positions in 1/256 pixel, 1 to 16 of them.
    pub fn at(positions: Vec<[i32; 2]>) -> Self {
        let extent = [0, 1].map(|k| {
            let values = positions.iter().map(|p| p[k]);
            [values.clone().min().unwrap_or(0), values.max().unwrap_or(0)]
        });
        let axes = [0, 1].map(|k: usize| {
            std::array::from_fn(|s| positions.get(s).or(positions.first()).map_or(0, |p: &[i32; 2]| p[k]))
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

    /// Along an axis, samples lie on the lines `offset + k * 2^shift` (1/256 pixel), `[offset, shift]`: the largest such step.
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
        for n in 1..=16 {
            let pattern = SamplePattern::new(n);
            for k in 0..2 {
                let mut seen: Vec<_> = pattern.positions.iter().map(|p| p[k] as usize * n / 256).collect();
                seen.sort_unstable();
                assert_eq!(seen, (0..n).collect::<Vec<_>>(), "{n} samples, axis {k}");
            }
        }
    }
}
