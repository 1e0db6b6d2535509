//! The sRGB encoding (\[sRGB\]), one value at a time. [`crate::lanes`] has it lane by lane.

use crate::func::pow32;
use crate::lanes::Lanes;
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
/// Values are dealt into cells by their exponent and the first seven bits of their mantissa. A cell is too narrow for two steps
/// of the byte: it knows the byte at its lower end, and from which value on it is one more.
pub struct SrgbBytes {
    cells: Box<[Cell]>,
}

#[derive(Clone, Copy)]
struct Cell {
    step: f32,
    below: u32,
}

/// All that is smaller has the byte 0.
const LEAST: f32 = 1.0 / 8192.0;
/// Bits of a value that are not looked at for its cell.
const WITHIN_CELL: u32 = 16;

impl SrgbBytes {
    /// The table, made when it is first asked for.
    pub fn get() -> &'static Self {
        static TABLE: OnceLock<SrgbBytes> = OnceLock::new();
        TABLE.get_or_init(Self::new)
    }

    fn new() -> Self {
        let cells = cell(1.0) + 1;
        let mut table: Box<[Cell]> = vec![Cell { step: f32::INFINITY, below: 0 }; cells].into();
        let value = |bits: u32| f32::from_bits(bits);
        let mut low = LEAST.to_bits();
        for byte in 1..=255 {
            // The least value with this byte, by halving.
            let mut high = 1f32.to_bits();
            while low < high {
                let middle = low.midpoint(high);
                if srgb_byte(value(middle)) >= byte { high = middle } else { low = middle + 1 }
            }
            table[cell(value(low))].step = value(low);
            table[cell(value(low)) + 1..].iter_mut().for_each(|cell| cell.below = u32::from(byte));
        }
        Self { cells: table }
    }

    /// The sRGB byte of linear light, clamped to `0..=1`; NaN gives 0.
    #[inline(always)]
    pub fn byte(&self, linear: f32) -> u8 {
        let value = if linear > LEAST { linear.min(1.0) } else { LEAST };
        let Cell { step, below } = self.cells[cell(value)];
        (below + u32::from(value >= step)) as u8
    }
}

/// The cell of a value between [`LEAST`] and 1.
#[inline(always)]
fn cell(value: f32) -> usize {
    ((value.to_bits() >> WITHIN_CELL) - (LEAST.to_bits() >> WITHIN_CELL)) as usize
}

fn srgb_byte(linear: f32) -> u8 {
    byte_from_unit(Lanes::srgb_from_linear(linear))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looked_up_bytes_are_those_of_the_formula() {
        let table = SrgbBytes::get();
        let same = |bits: u32| {
            let value = f32::from_bits(bits);
            assert_eq!(table.byte(value), srgb_byte(value), "{value:e}");
        };
        // One value in 97, and all round each step.
        (0..=2f32.to_bits()).step_by(97).for_each(same);
        let steps: Vec<u32> = table.cells.iter().filter(|c| c.step <= 1.0).map(|c| c.step.to_bits()).collect();
        assert_eq!(steps.len(), 255, "a cell has one step at most");
        steps.iter().flat_map(|bits| bits - 40..=bits + 40).for_each(same);
        for (odd, byte) in [(-1.0, 0), (f32::NAN, 0), (f32::INFINITY, 255), (f32::NEG_INFINITY, 0), (-0.0, 0)] {
            assert_eq!(table.byte(odd), byte, "{odd}");
        }
    }

    #[test]
    fn every_byte_survives_the_round_trip() {
        for byte in 0..=255u8 {
            assert_eq!(byte_from_unit(srgb_from_linear(linear_from_srgb(f32::from(byte) / 255.0))), byte);
        }
        assert_eq!(byte_from_unit(f32::NAN), 0);
    }
}
