//! The sRGB encoding (\[sRGB\]), one value at a time. Whole rows are encoded lane-wise in [`crate::lanes`].

use crate::func::pow32;

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
pub fn byte_from_unit(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_the_round_trip() {
        for byte in 0..=255u8 {
            assert_eq!(byte_from_unit(srgb_from_linear(linear_from_srgb(f32::from(byte) / 255.0))), byte);
        }
        assert_eq!(byte_from_unit(f32::NAN), 0);
    }
}
