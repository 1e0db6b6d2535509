//! Comparisons: alpha test, depth test, shadow look-ups.

use crate::forward::state::{AlphaTest, Compare, DepthTest};
use crate::forward::wide::every;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Floats, Mask8, MaskOf, Simd};

/// `incoming func stored`. NaN compares as IEEE 754 says: only `NotEqual` and `Always` pass.
#[inline(always)]
pub(crate) fn compare<S: Simd, V: Floats<S>>(
    simd: S,
    func: Compare,
    incoming: V,
    stored: V,
) -> MaskOf<S, V> {
    match func {
        Compare::Never => SimdMask::splat(simd, false),
        Compare::Less => incoming.simd_lt(stored),
        Compare::Equal => incoming.simd_eq(stored),
        Compare::LessOrEqual => incoming.simd_le(stored),
        Compare::Greater => incoming.simd_gt(stored),
        Compare::NotEqual => !incoming.simd_eq(stored),
        Compare::GreaterOrEqual => incoming.simd_ge(stored),
        Compare::Always => SimdMask::splat(simd, true),
    }
}

/// Which fragments pass the alpha test.
#[inline(always)]
pub(crate) fn alpha_test<S: Simd, V: Floats<S>>(
    simd: S,
    test: AlphaTest,
    alpha: V,
) -> MaskOf<S, V> {
    let [low, high]: [V; 2] = [every(simd, test.range[0]), every(simd, test.range[1])];
    let inside = low.simd_le(alpha) & alpha.simd_le(high);
    if test.inside { inside } else { !inside }
}

/// Which samples pass the depth test; both depths in the plane's units.
#[inline(always)]
pub(crate) fn depth_test<S: Simd>(
    simd: S,
    test: DepthTest,
    incoming: F32x8<S>,
    stored: F32x8<S>,
) -> Mask8<S> {
    compare(simd, test.func, incoming, stored)
}

/// Whether a comparison holds, for one value.
pub(crate) fn holds(func: Compare, incoming: f32, stored: f32) -> bool {
    match func {
        Compare::Never => false,
        Compare::Less => incoming < stored,
        Compare::Equal => incoming == stored,
        Compare::LessOrEqual => incoming <= stored,
        Compare::Greater => incoming > stored,
        Compare::NotEqual => incoming != stored,
        Compare::GreaterOrEqual => incoming >= stored,
        Compare::Always => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::wide::{bits_of, splat};
    use vitral_math::lanes::{available_levels, dispatch};

    #[test]
    fn every_function_by_its_truth_table() {
        let a = [0.0, 1.0, 0.5, 0.5, -1.0, f32::NAN, 0.25, 0.0];
        let b = [0.0, 0.5, 1.0, 0.5, -2.0, 0.0, 0.25, -0.0];
        for (name, level) in available_levels() {
            for (func, scalar) in [
                (Compare::Never, (|_, _| false) as fn(f32, f32) -> bool),
                (Compare::Less, |x, y| x < y),
                (Compare::Equal, |x, y| x == y),
                (Compare::LessOrEqual, |x, y| x <= y),
                (Compare::Greater, |x, y| x > y),
                (Compare::NotEqual, |x, y| x != y),
                (Compare::GreaterOrEqual, |x, y| x >= y),
                (Compare::Always, |_, _| true),
            ] {
                let bits = dispatch!(level, simd => bits_of(compare(
                    simd,
                    func,
                    F32x8::from_slice(simd, &a),
                    F32x8::from_slice(simd, &b)
                )));
                for lane in 0..8 {
                    assert_eq!(
                        bits >> lane & 1 == 1,
                        scalar(a[lane], b[lane]),
                        "{name} {func:?} {lane}"
                    );
                }
            }
        }
    }

    const FUNCTIONS: [Compare; 8] = [
        Compare::Never,
        Compare::Less,
        Compare::Equal,
        Compare::LessOrEqual,
        Compare::Greater,
        Compare::NotEqual,
        Compare::GreaterOrEqual,
        Compare::Always,
    ];

    fn passes(func: Compare, reference: f32, one: Option<f32>, alpha: f32) -> bool {
        AlphaTest::new(func, reference, one).is_none_or(|test| test.passes(alpha))
    }

    #[test]
    fn alphas_are_compared_as_they_would_be_stored() {
        for one in [255.0f32, 65_535.0] {
            let step = if one == 255.0 { 1 } else { 257 };
            for func in FUNCTIONS {
                for reference in (0..=one as u32).step_by(step).map(|r| r as f32) {
                    // The number itself, both ends of what is rounded to it, and its neighbours.
                    for (away, number) in
                        [(0.0, 0.0), (-0.49, 0.0), (0.49, 0.0), (-0.51, -1.0), (0.51, 1.0)]
                    {
                        let alpha = (reference + away) / one;
                        let expected = holds(func, (reference + number).clamp(0.0, one), reference);
                        assert_eq!(
                            passes(func, reference / one, Some(one), alpha),
                            expected,
                            "{func:?} {reference} {away}"
                        );
                        assert_eq!(
                            passes(func, reference / one, Some(one), reference / one),
                            holds(func, 0.0, 0.0)
                        );
                    }
                }
            }
        }
        // Halves are rounded up, as when they are stored.
        assert!(passes(Compare::Equal, 0.5, Some(255.0), 128.0 / 255.0));
        assert!(
            passes(Compare::Greater, 0.499, Some(255.0), 0.5)
                && !passes(Compare::Greater, 0.5, Some(255.0), 0.5)
        );
        // Floating-point buffers store them as they are.
        for func in FUNCTIONS {
            for alpha in
                [-1.0, 0.0, 0.5f32.next_down(), 0.5, 0.5f32.next_up(), 7.0, f32::INFINITY, f32::NAN]
            {
                assert_eq!(
                    passes(func, 0.5, None, alpha),
                    holds(func, alpha, 0.5),
                    "{func:?} {alpha}"
                );
            }
        }
    }

    #[test]
    fn alpha_and_depth_put_the_fragment_on_the_left() {
        for (_, level) in available_levels() {
            let alpha = [0.0, 0.98, 0.99, 1.0, 0.5, 0.2, f32::NAN, 0.4];
            for func in FUNCTIONS {
                let Some(test) = AlphaTest::new(func, 0.99, Some(255.0)) else { continue };
                let bits = dispatch!(level, simd => bits_of(alpha_test(simd, test, F32x8::from_slice(simd, &alpha))));
                (0..8).for_each(|lane| {
                    assert_eq!(bits >> lane & 1 == 1, test.passes(alpha[lane]), "{func:?} {lane}")
                });
            }
            let test = DepthTest { func: Compare::Less, write: true };
            let bits = dispatch!(level, simd => bits_of(depth_test(
                simd,
                test,
                F32x8::from_slice(simd, &alpha),
                splat(simd, 0.5)
            )));
            assert_eq!(bits, 0b1010_0001);
        }
    }
}
