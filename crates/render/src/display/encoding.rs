//! From display encoding to the space in which pictures are composed, and back.

use crate::ColorSpace;
use vitral_frame::Encoding;
use vitral_frame::texture::decode_table;
use vitral_math::color::{SrgbBytes, byte_from_unit};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Lanes, Level, Simd, dispatch};

/// For each byte of a texture its value in the space of composition, of one frame.
pub(crate) struct DecodeTables {
    pub(crate) srgb: [f32; 256],
    pub(crate) linear: [f32; 256],
}

impl DecodeTables {
    pub(crate) fn new(color_space: ColorSpace) -> Self {
        let raw = color_space == ColorSpace::Raw;
        Self {
            srgb: decode_table(Encoding::Srgb, raw),
            linear: decode_table(Encoding::Linear, raw),
        }
    }

    /// The table for textures of an encoding.
    pub(crate) fn table(&self, encoding: Encoding) -> &[f32; 256] {
        match encoding {
            Encoding::Srgb => &self.srgb,
            Encoding::Linear => &self.linear,
        }
    }
}

/// A colour in the display's encoding, in the space in which colours are composed.
pub(crate) fn composed(color: [f32; 3], raw: bool) -> [f32; 3] {
    if raw { color } else { color.map(Lanes::linear_from_srgb) }
}

/// Encodes premultiplied colours as display bytes with straight alpha, each at its pixel of `out`.
pub(crate) fn encode(
    level: Level,
    pixels: &[u32],
    colors: &[[f32; 4]],
    raw: bool,
    out: &mut [[u8; 4]],
) {
    if raw {
        return pixels.iter().zip(colors).for_each(|(&pixel, color)| {
            let [r, g, b, alpha] = straight(color);
            out[pixel as usize] = [r, g, b, alpha].map(byte_from_unit);
        });
    }
    dispatch!(level, simd => encode_srgb(simd, pixels, colors, out));
}

#[inline(always)]
fn encode_srgb<S: Simd>(simd: S, pixels: &[u32], colors: &[[f32; 4]], out: &mut [[u8; 4]]) {
    let table = SrgbBytes::get();
    for (pixels, colors) in pixels.chunks(2).zip(colors.chunks(2)) {
        if let ([first, second], &[[_, _, _, a], [_, _, _, b]]) = (pixels, colors)
            && a >= 1.0
            && b >= 1.0
        {
            // Nearly all pixels are opaque: no division, no alpha to encode.
            let bytes = table.eight(F32x8::from_slice(simd, colors.as_flattened())).to_array();
            let [r, g, b, _, s, h, c, _] = bytes.map(|byte| byte as u8);
            out[*first as usize] = [r, g, b, u8::MAX];
            out[*second as usize] = [s, h, c, u8::MAX];
            continue;
        }
        for (&pixel, color) in pixels.iter().zip(colors) {
            let [r, g, b, alpha] = straight(color);
            out[pixel as usize] =
                [table.byte(r), table.byte(g), table.byte(b), byte_from_unit(alpha)];
        }
    }
}

/// A premultiplied colour with straight alpha.
#[inline(always)]
fn straight(&[r, g, b, alpha]: &[f32; 4]) -> [f32; 4] {
    let straight = match alpha {
        1.0.. => 1.0,
        _ if alpha > 0.0 => 1.0 / alpha,
        _ => 0.0,
    };
    [r * straight, g * straight, b * straight, alpha]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_encode_with_straight_alpha() {
        let (level, mut out) = (Level::new(), [[9; 4]; 3]);
        encode(
            level,
            &[0, 1, 2],
            &[[0.25, 0.0, 0.5, 0.5], [0.0; 4], [2.0, f32::NAN, 1.0, 1.0]],
            true,
            &mut out,
        );
        assert_eq!(out, [[128, 0, 255, 128], [0; 4], [255, 0, 255, 255]]);
        let colors = [[0.25, 0.0, 0.5, 1.0], [2.0, f32::NAN, 1.0, 1.0], [0.125, 0.5, 0.25, 0.5]];
        encode(level, &[2, 0, 1], &colors, false, &mut out);
        assert_eq!(out, [[255, 0, 255, 255], [137, 255, 188, 128], [137, 0, 188, 255]]);
    }
}
