//! Comparisons: alpha test, depth test, shadow look-ups.

use crate::forward::state::{Compare, DepthTest};
use crate::forward::wide::every;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Floats, Mask8, MaskOf, Simd};

/// `incoming func stored`. NaN compares as IEEE 754 says: only `NotEqual` and `Always` pass.
#[inline(always)]
pub(crate) fn compare<S: Simd, V: Floats<S>>(simd: S, func: Compare, incoming: V, stored: V) -> MaskOf<S, V> {
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
pub(crate) fn alpha_test<S: Simd, V: Floats<S>>(simd: S, (func, reference): (Compare, f32), alpha: V) -> MaskOf<S, V> {
    compare(simd, func, alpha, every(simd, reference))
}

/// Which samples pass the depth test; both depths in the plane's units.
#[inline(always)]
pub(crate) fn depth_test<S: Simd>(simd: S, test: DepthTest, incoming: F32x8<S>, stored: F32x8<S>) -> Mask8<S> {
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
                    assert_eq!(bits >> lane & 1 == 1, scalar(a[lane], b[lane]), "{name} {func:?} {lane}");
                }
            }
        }
    }

    #[test]
    fn alpha_and_depth_put_the_fragment_on_the_left() {
        for (_, level) in available_levels() {
            let alpha = [0.0, 0.98, 0.99, 1.0, 0.5, 0.2, 0.3, 0.4];
            let bits = dispatch!(level, simd => bits_of(alpha_test(
                simd,
                (Compare::GreaterOrEqual, 0.99),
                F32x8::from_slice(simd, &alpha)
            )));
            assert_eq!(bits, 0b1100);
            let test = DepthTest { func: Compare::Less, write: true };
            let bits = dispatch!(level, simd => bits_of(depth_test(
                simd,
                test,
                F32x8::from_slice(simd, &alpha),
                splat(simd, 0.5)
            )));
            assert_eq!(bits, 0b1110_0001);
        }
    }
}
