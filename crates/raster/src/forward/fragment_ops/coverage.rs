//! Alpha to coverage and sample coverage: how much of a pixel counts, as a set of its samples.
//!
//! A value `v` keeps the samples whose threshold is below it: 0 keeps none, 1 keeps all, and a
//! larger value keeps all that a smaller one keeps. The sets depend on the value alone, not on the
//! pixel, so nothing is dithered.

use crate::forward::state::SampleCoverage;
use crate::forward::wide::{bits_of, splat};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Simd};

/// In which order four samples are taken: the outer two of the sorted pattern first, so that halves
/// are spread.
const RANK: [usize; 4] = [0, 2, 3, 1];

/// The value above which sample `s` of `samples` is kept.
#[inline(always)]
fn threshold(s: usize, samples: usize) -> f32 {
    let rank = if samples == RANK.len() { RANK[s] } else { s };
    (rank as f32 + 0.5) / samples as f32
}

/// The samples that `value` keeps: bit `s` is sample `s`.
pub(crate) fn coverage_bits(value: f32, samples: usize) -> u32 {
    (0..samples).fold(0, |bits, s| bits | u32::from(value >= threshold(s, samples)) << s)
}

/// The samples that `SAMPLE_COVERAGE` keeps, the same for all pixels.
pub(crate) fn sample_coverage_bits(coverage: SampleCoverage, samples: usize) -> u32 {
    let bits = coverage_bits(coverage.value, samples);
    if coverage.invert { !bits & ((1 << samples) - 1) } else { bits }
}

/// The pixels of which `SAMPLE_ALPHA_TO_COVERAGE` keeps sample `s`: bit `i` is pixel `i`.
#[inline(always)]
pub(crate) fn alpha_coverage<S: Simd>(simd: S, alpha: F32x8<S>, s: usize, samples: usize) -> u32 {
    bits_of(alpha.simd_ge(splat(simd, threshold(s, samples))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::lanes::{available_levels, dispatch};

    #[test]
    fn quarters_of_a_pixel() {
        let sets: Vec<u32> =
            [0.0, 0.1, 0.125, 0.25, 0.5, 0.75, 0.87, 0.9, 1.0].map(|v| coverage_bits(v, 4)).into();
        assert_eq!(sets, [0, 0, 0b0001, 0b0001, 0b1001, 0b1011, 0b1011, 0b1111, 0b1111]);
        assert_eq!([0.0, 0.49, 0.5, 1.0].map(|v| coverage_bits(v, 1)), [0, 0, 1, 1]);
        assert_eq!(coverage_bits(f32::NAN, 4), 0);
    }

    #[test]
    fn an_inverted_set_is_the_complement() {
        for value in [0.0, 0.3, 0.5, 0.8, 1.0] {
            let kept = sample_coverage_bits(SampleCoverage { value, invert: false }, 4);
            let others = sample_coverage_bits(SampleCoverage { value, invert: true }, 4);
            assert_eq!((kept & others, kept | others), (0, 0b1111));
        }
    }

    #[test]
    fn alpha_covers_like_the_value() {
        let alpha = [0.0, 0.1, 0.2, 0.4, 0.5, 0.7, 0.9, 1.0];
        for (name, level) in available_levels() {
            for s in 0..4 {
                let bits = dispatch!(level, simd => alpha_coverage(simd, F32x8::from_slice(simd, &alpha), s, 4));
                for lane in 0..8 {
                    assert_eq!(
                        bits >> lane & 1,
                        coverage_bits(alpha[lane], 4) >> s & 1,
                        "{name} {lane} {s}"
                    );
                }
            }
        }
    }
}
