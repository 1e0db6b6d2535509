//! Formats and types of pixels in the client's memory.

use super::Failure;
use crate::enums::*;

/// What a pixel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    Color,
    Index,
    Stencil,
    Depth,
    DepthStencil,
}

/// A valid pair of format and type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PixelFormat {
    /// `RGBA` ...
    pub format: u32,
    /// `UNSIGNED_BYTE` ...
    pub kind: u32,
}

/// A packed type: all components in one unsigned number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Packed {
    /// Bytes of the number.
    pub bytes: usize,
    /// Shift and width of each component, in the format's order.
    pub fields: &'static [(u32, u32)],
}

/// The packed type `kind`, of colours.
fn packed(kind: u32) -> Option<Packed> {
    let (bytes, fields): (usize, &'static [(u32, u32)]) = match kind {
        UNSIGNED_BYTE_3_3_2 => (1, &[(5, 3), (2, 3), (0, 2)]),
        UNSIGNED_BYTE_2_3_3_REV => (1, &[(0, 3), (3, 3), (6, 2)]),
        UNSIGNED_SHORT_5_6_5 => (2, &[(11, 5), (5, 6), (0, 5)]),
        UNSIGNED_SHORT_5_6_5_REV => (2, &[(0, 5), (5, 6), (11, 5)]),
        UNSIGNED_SHORT_4_4_4_4 => (2, &[(12, 4), (8, 4), (4, 4), (0, 4)]),
        UNSIGNED_SHORT_4_4_4_4_REV => (2, &[(0, 4), (4, 4), (8, 4), (12, 4)]),
        UNSIGNED_SHORT_5_5_5_1 => (2, &[(11, 5), (6, 5), (1, 5), (0, 1)]),
        UNSIGNED_SHORT_1_5_5_5_REV => (2, &[(0, 5), (5, 5), (10, 5), (15, 1)]),
        UNSIGNED_INT_8_8_8_8 => (4, &[(24, 8), (16, 8), (8, 8), (0, 8)]),
        UNSIGNED_INT_8_8_8_8_REV => (4, &[(0, 8), (8, 8), (16, 8), (24, 8)]),
        UNSIGNED_INT_10_10_10_2 => (4, &[(22, 10), (12, 10), (2, 10), (0, 2)]),
        UNSIGNED_INT_2_10_10_10_REV => (4, &[(0, 10), (10, 10), (20, 10), (30, 2)]),
        _ => return None,
    };
    Some(Packed { bytes, fields })
}

impl PixelFormat {
    /// The pair, or the error that the specification gives it.
    pub(crate) fn new(format: u32, kind: u32) -> Result<Self, Failure> {
        // Check the format.
        let pair = Self { format, kind };
        let known = matches!(
            format,
            COLOR_INDEX
                | STENCIL_INDEX
                | DEPTH_COMPONENT
                | RED
                | GREEN
                | BLUE
                | RG
                | ALPHA
                | RGB
                | RGBA
                | BGR
                | BGRA
                | ABGR_EXT
                | LUMINANCE
                | LUMINANCE_ALPHA
                | DEPTH_STENCIL
        );

        // Check that a packed type has as many fields as the format has components.
        let fits = |p: Packed| match p.fields.len() {
            3 => format == RGB,
            _ => matches!(format, RGBA | BGRA | ABGR_EXT),
        };
        if packed(kind).is_some_and(|p| !fits(p)) {
            return Err((INVALID_OPERATION, "a packed type does not fit the format"));
        }
        if !known {
            return Err((INVALID_ENUM, "format is not a pixel format"));
        }

        // Check the type.
        match kind {
            BITMAP if matches!(format, COLOR_INDEX | STENCIL_INDEX) => Ok(pair),
            BITMAP => Err((INVALID_ENUM, "type BITMAP needs an index format")),
            UNSIGNED_INT_24_8 | FLOAT_32_UNSIGNED_INT_24_8_REV if format == DEPTH_STENCIL => {
                Ok(pair)
            }
            UNSIGNED_INT_24_8 | FLOAT_32_UNSIGNED_INT_24_8_REV => {
                Err((INVALID_OPERATION, "a type of depth and stencil needs format DEPTH_STENCIL"))
            }
            UNSIGNED_BYTE | BYTE | UNSIGNED_SHORT | SHORT | UNSIGNED_INT | INT | FLOAT
            | HALF_FLOAT_ARB => {
                if format == DEPTH_STENCIL {
                    Err((INVALID_ENUM, "DEPTH_STENCIL needs a type of depth and stencil"))
                } else {
                    Ok(pair)
                }
            }
            _ if packed(kind).is_some() => Ok(pair),
            _ => Err((INVALID_ENUM, "type is not a pixel type")),
        }
    }

    /// What a pixel holds.
    pub(crate) fn content(self) -> Content {
        match self.format {
            COLOR_INDEX => Content::Index,
            STENCIL_INDEX => Content::Stencil,
            DEPTH_COMPONENT => Content::Depth,
            DEPTH_STENCIL => Content::DepthStencil,
            _ => Content::Color,
        }
    }

    /// Components of a pixel.
    pub(crate) fn components(self) -> usize {
        match self.format {
            RG | LUMINANCE_ALPHA => 2,
            RGB | BGR => 3,
            RGBA | BGRA | ABGR_EXT => 4,
            _ => 1,
        }
    }

    /// The layout of a packed type.
    pub(crate) fn packed(self) -> Option<Packed> {
        packed(self.kind)
    }

    /// Bytes of an element: the unit of alignment and of byte swapping.
    pub(crate) fn element_bytes(self) -> usize {
        match self.kind {
            UNSIGNED_BYTE | BYTE | BITMAP => 1,
            UNSIGNED_SHORT | SHORT | HALF_FLOAT_ARB => 2,
            UNSIGNED_INT | INT | FLOAT | UNSIGNED_INT_24_8 | FLOAT_32_UNSIGNED_INT_24_8_REV => 4,
            _ => self.packed().map_or(1, |p| p.bytes),
        }
    }

    /// Bytes of a pixel; a bitmap has one byte a pixel once it is unpacked.
    pub(crate) fn pixel_bytes(self) -> usize {
        match self.kind {
            UNSIGNED_INT_24_8 | BITMAP => self.element_bytes(),
            FLOAT_32_UNSIGNED_INT_24_8_REV => 8,
            _ if self.packed().is_some() => self.element_bytes(),
            _ => self.components() * self.element_bytes(),
        }
    }

    /// Where each component of the format goes in RGBA. `LUMINANCE` is red.
    pub(crate) fn places(self) -> &'static [usize] {
        match self.format {
            GREEN => &[1],
            BLUE => &[2],
            ALPHA => &[3],
            RG => &[0, 1],
            RGB => &[0, 1, 2],
            BGR => &[2, 1, 0],
            RGBA => &[0, 1, 2, 3],
            BGRA => &[2, 1, 0, 3],
            ABGR_EXT => &[3, 2, 1, 0],
            LUMINANCE_ALPHA => &[0, 3],
            _ => &[0],
        }
    }
}

/// A half-precision number as a float.
pub(crate) fn float_from_half(half: u16) -> f32 {
    let sign = u32::from(half & 0x8000) << 16;
    let exponent = u32::from((half >> 10) & 31);
    let fraction = u32::from(half & 0x3ff);
    match exponent {
        // Zero and subnormal numbers: fraction * 2^-24, exact.
        0 => f32::from_bits(sign | (fraction as f32 * f32::from_bits(103 << 23)).to_bits()),
        31 => f32::from_bits(sign | (0xff << 23) | (fraction << 13)),
        _ => f32::from_bits(sign | ((exponent + 112) << 23) | (fraction << 13)),
    }
}

/// The half-precision number nearest to a float, ties to even.
pub(crate) fn half_from_float(value: f32) -> u16 {
    let bits = value.to_bits();
    let sign = ((bits >> 16) & 0x8000) as u16;
    let magnitude = bits & 0x7fff_ffff;
    if magnitude > 0x7f80_0000 {
        return sign | 0x7e00;
    }
    if magnitude >= 0x4780_0000 {
        return sign | 0x7c00;
    }
    if magnitude < 0x3880_0000 {
        // Subnormal: a multiple of 2^-24. Adding 0.5 lets the float unit round at that place.
        return sign | ((f32::from_bits(magnitude) + 0.5).to_bits() - 0.5f32.to_bits()) as u16;
    }
    let rounded = magnitude + 0xfff + ((magnitude >> 13) & 1);
    sign | ((rounded - (112 << 23)) >> 13) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_that_do_not_fit_give_the_specified_errors() {
        let error = |format, kind| PixelFormat::new(format, kind).unwrap_err().0;
        assert_eq!(error(0x1234, UNSIGNED_BYTE), INVALID_ENUM);
        assert_eq!(error(RGBA, 0x1234), INVALID_ENUM);
        assert_eq!(error(RGBA, BITMAP), INVALID_ENUM);
        assert_eq!(error(RGBA, UNSIGNED_SHORT_5_6_5), INVALID_OPERATION);
        assert_eq!(error(RGB, UNSIGNED_INT_8_8_8_8), INVALID_OPERATION);
        assert_eq!(error(DEPTH_STENCIL, FLOAT), INVALID_ENUM);
        assert_eq!(error(DEPTH_COMPONENT, UNSIGNED_INT_24_8), INVALID_OPERATION);
        assert!(PixelFormat::new(BGRA, UNSIGNED_SHORT_1_5_5_5_REV).is_ok());
    }

    #[test]
    fn every_half_survives_the_round_trip() {
        for half in (0..=u16::MAX).filter(|h| h & 0x7c00 != 0x7c00) {
            assert_eq!(half_from_float(float_from_half(half)), half);
        }
        assert_eq!(float_from_half(0x3c00), 1.0);
        assert_eq!(half_from_float(65520.0), 0x7c00);
        assert_eq!(half_from_float(65519.0), 0x7bff);
        assert_eq!(half_from_float(0.1), 0x2e66);
    }
}
