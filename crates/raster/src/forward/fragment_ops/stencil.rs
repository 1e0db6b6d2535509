//! The stencil test and what it writes. Stencil values are widened to 32 bits.

use super::compare::holds;
use crate::forward::state::{Compare, StencilFace, StencilOp};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{I32x8, LANES, Mask8, Simd};

/// Eight stencil values, one a lane.
#[inline(always)]
pub(crate) fn load_stencil<S: Simd>(simd: S, row: &[u8]) -> I32x8<S> {
    let mut wide = [0i32; LANES];
    for (wide, &value) in wide.iter_mut().zip(row) {
        *wide = i32::from(value);
    }
    I32x8::from_slice(simd, &wide)
}

/// Stores eight values of 0..=255.
#[inline(always)]
pub(crate) fn store_stencil<S: Simd>(values: I32x8<S>, row: &mut [u8]) {
    let wide = values.to_array();
    for (value, wide) in row.iter_mut().zip(wide) {
        *value = wide as u8;
    }
}

/// `(reference & mask) func (stored & mask)`.
#[inline(always)]
pub(crate) fn stencil_test<S: Simd>(simd: S, face: &StencilFace, stored: I32x8<S>) -> Mask8<S> {
    let reference = I32x8::splat(simd, i32::from(face.reference & face.mask));
    let stored = stored & i32::from(face.mask);
    match face.func {
        Compare::Never => Mask8::splat(simd, false),
        Compare::Less => reference.simd_lt(stored),
        Compare::Equal => reference.simd_eq(stored),
        Compare::LessOrEqual => reference.simd_le(stored),
        Compare::Greater => reference.simd_gt(stored),
        Compare::NotEqual => !reference.simd_eq(stored),
        Compare::GreaterOrEqual => reference.simd_ge(stored),
        Compare::Always => Mask8::splat(simd, true),
    }
}

/// [`stencil_test`] of one value.
#[inline(always)]
pub(crate) fn stencil_holds(face: &StencilFace, stored: u8) -> bool {
    holds(face.func, f32::from(face.reference & face.mask), f32::from(stored & face.mask))
}

/// The values after the test: `covered` lanes change by the operation of their case, within the
/// write mask.
#[inline(always)]
pub(crate) fn stencil_update<S: Simd>(
    simd: S,
    face: &StencilFace,
    stored: I32x8<S>,
    covered: Mask8<S>,
    stencil_passed: Mask8<S>,
    depth_passed: Mask8<S>,
) -> I32x8<S> {
    let failed = operation(simd, face.fail, face.reference, stored);
    let hidden = operation(simd, face.depth_fail, face.reference, stored);
    let passed = operation(simd, face.pass, face.reference, stored);
    let new = stencil_passed.select(depth_passed.select(passed, hidden), failed);
    let write = i32::from(face.write_mask);
    let masked = (new & write) | (stored & !write);
    covered.select(masked, stored)
}

/// One operation on all lanes.
#[inline(always)]
fn operation<S: Simd>(simd: S, op: StencilOp, reference: u8, stored: I32x8<S>) -> I32x8<S> {
    match op {
        StencilOp::Keep => stored,
        StencilOp::Zero => I32x8::splat(simd, 0),
        StencilOp::Replace => I32x8::splat(simd, i32::from(reference)),
        StencilOp::Increment => (stored + 1).min(I32x8::splat(simd, 255)),
        StencilOp::Decrement => (stored - 1).max(I32x8::splat(simd, 0)),
        StencilOp::Invert => stored ^ 255,
        StencilOp::IncrementWrap => (stored + 1) & 255,
        StencilOp::DecrementWrap => (stored - 1) & 255,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::wide::{bits_of, mask_of};
    use vitral_math::lanes::{Level, available_levels, dispatch};

    type Test = fn(u8, u8) -> bool;
    type Change = fn(u8, u8) -> u8;

    const FUNCS: [(Compare, Test); 8] = [
        (Compare::Never, |_, _| false),
        (Compare::Less, |r, s| r < s),
        (Compare::Equal, |r, s| r == s),
        (Compare::LessOrEqual, |r, s| r <= s),
        (Compare::Greater, |r, s| r > s),
        (Compare::NotEqual, |r, s| r != s),
        (Compare::GreaterOrEqual, |r, s| r >= s),
        (Compare::Always, |_, _| true),
    ];

    const OPS: [(StencilOp, Change); 8] = [
        (StencilOp::Keep, |s, _| s),
        (StencilOp::Zero, |_, _| 0),
        (StencilOp::Replace, |_, r| r),
        (StencilOp::Increment, |s, _| s.saturating_add(1)),
        (StencilOp::Decrement, |s, _| s.saturating_sub(1)),
        (StencilOp::Invert, |s, _| !s),
        (StencilOp::IncrementWrap, |s, _| s.wrapping_add(1)),
        (StencilOp::DecrementWrap, |s, _| s.wrapping_sub(1)),
    ];

    const ROW: [u8; 8] = [0, 1, 3, 127, 128, 200, 254, 255];

    fn face(func: Compare, mask: u8) -> StencilFace {
        let keep = StencilOp::Keep;
        StencilFace {
            func,
            reference: 0x83,
            mask,
            fail: keep,
            depth_fail: keep,
            pass: keep,
            write_mask: 255,
        }
    }

    #[test]
    fn every_function_compares_the_masked_reference_with_the_masked_value() {
        for (name, level) in available_levels() {
            for (func, scalar) in FUNCS {
                for mask in [255, 0x0f, 0x80, 0] {
                    let face = face(func, mask);
                    let bits = dispatch!(level, simd => bits_of(stencil_test(simd, &face, load_stencil(simd, &ROW))));
                    for lane in 0..8 {
                        let expected = scalar(0x83 & mask, ROW[lane] & mask);
                        assert_eq!(
                            bits >> lane & 1 == 1,
                            expected,
                            "{name} {func:?} {mask} {}",
                            ROW[lane]
                        );
                    }
                }
            }
        }
    }

    /// Lane bits: covered, stencil passes, depth passes.
    fn updated(level: Level, face: &StencilFace, row: [u8; 8], masks: [u32; 3]) -> [u8; 8] {
        let mut out = [0; 8];
        dispatch!(level, simd => {
            let [covered, stencil, depth] = [mask_of(simd, masks[0]), mask_of(simd, masks[1]), mask_of(simd, masks[2])];
            store_stencil(stencil_update(simd, face, load_stencil(simd, &row), covered, stencil, depth), &mut out);
        });
        out
    }

    #[test]
    fn every_operation_in_every_case_within_the_write_mask() {
        for (name, level) in available_levels() {
            for (op, scalar) in OPS {
                for write_mask in [255u8, 0x0f, 0] {
                    let base = StencilFace { write_mask, ..face(Compare::Always, 255) };
                    for (face, masks) in [
                        (StencilFace { fail: op, ..base }, [255, 0, 255]),
                        (StencilFace { depth_fail: op, ..base }, [255, 255, 0]),
                        (StencilFace { pass: op, ..base }, [255, 255, 255]),
                    ] {
                        let out = updated(level, &face, ROW, masks);
                        for lane in 0..8 {
                            let s = ROW[lane];
                            let expected = (scalar(s, 0x83) & write_mask) | (s & !write_mask);
                            assert_eq!(out[lane], expected, "{name} {op:?} {s}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn each_lane_has_its_own_case() {
        let face = StencilFace {
            fail: StencilOp::Zero,
            depth_fail: StencilOp::Replace,
            pass: StencilOp::Invert,
            ..face(Compare::Always, 255)
        };
        for (_, level) in available_levels() {
            let out = updated(level, &face, [10; 8], [0b1111, 0b1100, 0b1010]);
            assert_eq!(out, [0, 0, 0x83, !10, 10, 10, 10, 10]);
        }
    }
}
