//! Logical operations on stored pixels, and the colour mask.

use crate::forward::state::LogicOp;
use std::ops::{BitAnd, BitOr, BitXor, Not};
use vitral_math::lanes::Simd;
use vitral_math::lanes::prelude::*;

/// What a logical operation stores: bit by bit of incoming `s` and stored `d`.
#[inline(always)]
pub(crate) fn logic_op<T>(op: LogicOp, s: T, d: T) -> T
where
    T: Copy + Not<Output = T> + BitAnd<Output = T> + BitOr<Output = T> + BitXor<Output = T>,
{
    match op {
        LogicOp::Clear => s & !s,
        LogicOp::And => s & d,
        LogicOp::AndReverse => s & !d,
        LogicOp::Copy => s,
        LogicOp::AndInverted => !s & d,
        LogicOp::Noop => d,
        LogicOp::Xor => s ^ d,
        LogicOp::Or => s | d,
        LogicOp::Nor => !(s | d),
        LogicOp::Equiv => !(s ^ d),
        LogicOp::Invert => !d,
        LogicOp::OrReverse => s | !d,
        LogicOp::CopyInverted => !s,
        LogicOp::OrInverted => !s | d,
        LogicOp::Nand => !(s & d),
        LogicOp::Set => s | !s,
    }
}

/// A logical operation on a component that stands for 16 bits.
pub(crate) fn logic_op_of_16_bits(op: LogicOp, color: f32, stored: f32) -> f32 {
    const ONE: f32 = 65_535.0;
    let [s, d] = [color, stored].map(|v| (v * ONE + 0.5) as u16);
    f32::from(logic_op(op, s, d)) / ONE
}

/// The bits of a packed pixel that a colour mask protects.
pub(crate) fn protected_bits(masked: [bool; 4]) -> u32 {
    u32::from_le_bytes(masked.map(|protected| if protected { 255 } else { 0 }))
}

/// `new`, but `old` in the protected bits.
#[inline(always)]
pub(crate) fn write_unprotected<S: Simd, W: SimdInt<S, Element = u32>>(
    new: W,
    old: W,
    protected: u32,
) -> W {
    (new & !protected) | (old & protected)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::lanes::U32x8;
    use vitral_math::lanes::{available_levels, dispatch};

    /// Bit `2 * s + d` of each is the result for source bit `s` and destination bit `d` (table 4.2
    /// of the specification).
    const TRUTH: [(LogicOp, u32); 16] = [
        (LogicOp::Clear, 0b0000),
        (LogicOp::And, 0b1000),
        (LogicOp::AndReverse, 0b0100),
        (LogicOp::Copy, 0b1100),
        (LogicOp::AndInverted, 0b0010),
        (LogicOp::Noop, 0b1010),
        (LogicOp::Xor, 0b0110),
        (LogicOp::Or, 0b1110),
        (LogicOp::Nor, 0b0001),
        (LogicOp::Equiv, 0b1001),
        (LogicOp::Invert, 0b0101),
        (LogicOp::OrReverse, 0b1101),
        (LogicOp::CopyInverted, 0b0011),
        (LogicOp::OrInverted, 0b1011),
        (LogicOp::Nand, 0b0111),
        (LogicOp::Set, 0b1111),
    ];

    #[test]
    fn every_operation_by_its_truth_table() {
        let s = [0xdead_beef, 0, u32::MAX, 0x00ff_00ff, 1, 0x8000_0000, 12345, 0x0f0f_0f0f];
        let d = [0x1234_5678, u32::MAX, 0, 0x0000_ffff, 1, 0x7fff_ffff, 54321, 0x3333_3333];
        for (name, level) in available_levels() {
            for (op, truth) in TRUTH {
                let out = dispatch!(level, simd => logic_op(
                    op,
                    U32x8::from_slice(simd, &s),
                    U32x8::from_slice(simd, &d)
                )
                .to_array());
                for lane in 0..8 {
                    for bit in 0..32 {
                        let index = 2 * (s[lane] >> bit & 1) + (d[lane] >> bit & 1);
                        assert_eq!(out[lane] >> bit & 1, truth >> index & 1, "{name} {op:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_mask_protects_components() {
        assert_eq!(protected_bits([true, false, false, true]), 0xff00_00ff);
        for (_, level) in available_levels() {
            let out = dispatch!(level, simd => write_unprotected(
                U32x8::splat(simd, 0x1122_3344),
                U32x8::splat(simd, 0xaabb_ccdd),
                protected_bits([false, true, false, true])
            )
            .to_array());
            assert_eq!(out, [0xaa22_cc44; 8]);
        }
    }
}
