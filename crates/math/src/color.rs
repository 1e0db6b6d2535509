//! The sRGB encoding (\[sRGB\]), one value at a time. [`crate::lanes`] has it lane by lane.

use crate::func::pow32;
use crate::lanes::prelude::*;
use crate::lanes::{F32x8, Lanes, Simd, U32x8};
use std::sync::OnceLock;

/// Linear light `0..=1` from an sRGB-encoded value `0..=1`.
pub fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { pow32((encoded + 0.055) / 1.055, 2.4) }
}

/// sRGB-encoded value `0..=1` from linear light `0..=1`.
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * pow32(linear, 1.0 / 2.4) - 0.055 }
}

/// Linear light of each of the 256 sRGB bytes.
pub fn linear_from_srgb_table() -> [f32; 256] {
    std::array::from_fn(|i| linear_from_srgb(i as f32 / 255.0))
}

/// The byte of a value, `0.0 -> 0`, `1.0 -> 255`, rounded to nearest and clamped; NaN gives 0.
#[inline]
pub fn byte_from_unit(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Display bytes of linear light, looked up.
///
/// Values are dealt into cells by their exponent and the first seven bits of their mantissa. A cell
/// is too narrow for two steps of the byte. It holds a number to which the rest of the mantissa is
/// added, and the byte is above that: the byte at the cell's lower end, and as much as is missing
/// to the next where a step is in the cell.
pub struct SrgbBytes {
    cells: Box<[u32; CELLS]>,
}

/// All that is smaller has the byte 0.
const LEAST: f32 = 1.0 / 8192.0;
/// Bits of a value that are not looked at for its cell.
const WITHIN_CELL: u32 = 16;
/// A power of two with room for the cells from [`LEAST`] to 1.
const CELLS: usize = 2048;

impl SrgbBytes {
    /// The table, made when it is first asked for.
    pub fn get() -> &'static Self {
        static TABLE: OnceLock<SrgbBytes> = OnceLock::new();
        TABLE.get_or_init(Self::new)
    }

    fn new() -> Self {
        let mut cells = Box::new([0; CELLS]);
        let mut low = LEAST.to_bits();
        for byte in 1..=255u8 {
            // The least value with this byte, by halving.
            let mut high = 1f32.to_bits();
            while low < high {
                let middle = low.midpoint(high);
                if srgb_byte(f32::from_bits(middle)) >= byte {
                    high = middle
                } else {
                    low = middle + 1
                }
            }
            let (cell, whole) = (cell(low), u32::from(byte) << WITHIN_CELL);
            cells[cell] = whole - within(low);
            cells[cell + 1..].fill(whole);
        }
        Self { cells }
    }

    /// The sRGB byte of linear light, clamped to `0..=1`; NaN gives 0.
    #[inline(always)]
    pub fn byte(&self, linear: f32) -> u8 {
        let bits = Lanes::min(Lanes::max(linear, LEAST), 1.0).to_bits();
        ((self.cells[cell(bits)] + within(bits)) >> WITHIN_CELL) as u8
    }

    /// [`Self::byte`] of eight values.
    #[inline(always)]
    pub fn eight<S: Simd>(&self, linear: F32x8<S>) -> U32x8<S> {
        let bits: U32x8<S> =
            Lanes::min(Lanes::max(linear, linear.splat(LEAST)), linear.splat(1.0)).bitcast();
        let cells = ((bits >> WITHIN_CELL) - (LEAST.to_bits() >> WITHIN_CELL)).to_array();
        let found = cells.map(
            #[inline(always)]
            |cell| self.cells[cell as usize % CELLS],
        );
        (U32x8::from_slice(bits.token(), &found) + (bits & ((1 << WITHIN_CELL) - 1))) >> WITHIN_CELL
    }
}

/// The cell of the bits of a value between [`LEAST`] and 1.
#[inline(always)]
fn cell(bits: u32) -> usize {
    ((bits >> WITHIN_CELL) - (LEAST.to_bits() >> WITHIN_CELL)) as usize % CELLS
}

/// Where in its cell a value is, by its bits.
#[inline(always)]
fn within(bits: u32) -> u32 {
    bits & ((1 << WITHIN_CELL) - 1)
}

fn srgb_byte(linear: f32) -> u8 {
    byte_from_unit(Lanes::srgb_from_linear(linear))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{available_levels, dispatch};

    #[test]
    fn looked_up_bytes_are_those_of_the_formula() {
        let table = SrgbBytes::get();
        let same = |bits: u32| {
            let value = f32::from_bits(bits);
            assert_eq!(table.byte(value), srgb_byte(value), "{value:e}");
        };
        // One value in 97, and all round each step.
        (0..=2f32.to_bits()).step_by(97).for_each(same);
        let mut steps = 0;
        for (bits, cell) in (LEAST.to_bits() >> WITHIN_CELL..).zip(table.cells.iter()) {
            let rest = (1 << WITHIN_CELL) - within(*cell);
            let step = (bits << WITHIN_CELL) + rest;
            if within(*cell) > 0 && step <= 1f32.to_bits() {
                (step - 40..=step + 40).for_each(same);
                steps += 1;
            }
        }
        assert_eq!(steps, 255, "a cell has one step at most");
        for (odd, byte) in
            [(-1.0, 0), (f32::NAN, 0), (f32::INFINITY, 255), (f32::NEG_INFINITY, 0), (-0.0, 0)]
        {
            assert_eq!(table.byte(odd), byte, "{odd}");
        }
    }

    #[test]
    fn eight_bytes_are_those_found_one_by_one() {
        let table = SrgbBytes::get();
        let odd = [-1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, 1.0, LEAST, 1e-42];
        let many = (0..2f32.to_bits()).step_by(9973).map(f32::from_bits);
        let values: Vec<f32> = odd.into_iter().chain(many).collect();
        for (name, level) in available_levels() {
            for eight in values.chunks_exact(8) {
                let found = dispatch!(level, simd => table.eight(F32x8::from_slice(simd, eight)).to_array());
                let expected: Vec<u32> =
                    eight.iter().map(|&value| u32::from(table.byte(value))).collect();
                assert_eq!(found[..], expected[..], "{name}: {eight:?}");
            }
        }
    }

    #[test]
    fn every_byte_survives_the_round_trip() {
        for byte in 0..=255u8 {
            assert_eq!(
                byte_from_unit(srgb_from_linear(linear_from_srgb(f32::from(byte) / 255.0))),
                byte
            );
        }
        assert_eq!(byte_from_unit(f32::NAN), 0);
    }
}
