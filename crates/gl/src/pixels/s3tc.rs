//! S3TC: blocks of 4x4 texels in 8 or 16 bytes. Textures hold the texels that they decode to, and
//! keep the blocks for whoever asks for them.
//!
//! Source: the EXT_texture_compression_s3tc specification.

use crate::enums::*;
use std::sync::Arc;

/// Texels along a block's side.
pub(crate) const SIDE: usize = 4;

/// An image's blocks, row by row.
#[derive(Clone, Debug)]
pub(crate) struct Blocks {
    /// `COMPRESSED_RGB_S3TC_DXT1_EXT` ...
    pub token: u32,
    /// All blocks.
    pub bytes: Arc<Vec<u8>>,
}

/// How alpha is stored.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Alpha {
    /// There is none.
    Opaque,
    /// One of a block's four colours may be clear.
    Clear,
    /// Four bits a texel.
    Plain,
    /// Three bits a texel, between two bytes.
    Between,
}

fn alpha(token: u32) -> Option<Alpha> {
    Some(match token {
        COMPRESSED_RGB_S3TC_DXT1_EXT | COMPRESSED_SRGB_S3TC_DXT1_EXT => Alpha::Opaque,
        COMPRESSED_RGBA_S3TC_DXT1_EXT | COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT => Alpha::Clear,
        COMPRESSED_RGBA_S3TC_DXT3_EXT | COMPRESSED_SRGB_ALPHA_S3TC_DXT3_EXT => Alpha::Plain,
        COMPRESSED_RGBA_S3TC_DXT5_EXT | COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT => Alpha::Between,
        _ => return None,
    })
}

/// Whether a token is a format of this file.
pub(crate) fn is_compressed(token: u32) -> bool {
    alpha(token).is_some()
}

/// The format of the texels that blocks decode to.
pub(crate) fn base(token: u32) -> u32 {
    match token {
        COMPRESSED_RGB_S3TC_DXT1_EXT => RGB,
        COMPRESSED_SRGB_S3TC_DXT1_EXT => SRGB_EXT,
        COMPRESSED_RGBA_S3TC_DXT1_EXT..=COMPRESSED_RGBA_S3TC_DXT5_EXT => RGBA,
        COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT..=COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT => SRGB_ALPHA_EXT,
        other => other,
    }
}

/// Bytes of a block of 4x4 texels.
pub(crate) fn block_bytes(token: u32) -> usize {
    if matches!(alpha(token), Some(Alpha::Plain | Alpha::Between)) { 16 } else { 8 }
}

/// Bytes of an image of `width x height` texels.
pub(crate) fn image_bytes(token: u32, [width, height]: [usize; 2]) -> usize {
    width.div_ceil(SIDE) * height.div_ceil(SIDE) * block_bytes(token)
}

/// The texels of an image, red in the lowest byte. `bytes` are as many as [`image_bytes`] says.
pub(crate) fn decode(token: u32, [width, height]: [usize; 2], bytes: &[u8]) -> Vec<u32> {
    let mut texels = vec![0; width * height];
    let Some(alpha) = alpha(token) else { return texels };
    let across = width.div_ceil(SIDE);
    for (number, block) in bytes.chunks_exact(block_bytes(token)).enumerate() {
        let (x, y) = (number % across * SIDE, number / across * SIDE);
        let decoded = decode_block(alpha, block);
        for (row, source) in decoded.chunks_exact(SIDE).enumerate().take(height - y) {
            let count = SIDE.min(width - x);
            texels[(y + row) * width + x..][..count].copy_from_slice(&source[..count]);
        }
    }
    texels
}

fn decode_block(alpha: Alpha, block: &[u8]) -> [u32; SIDE * SIDE] {
    let (alphas, colors) = block.split_at(block.len() - 8);
    let word = |at: usize| u16::from_le_bytes([colors[at], colors[at + 1]]);
    let four = palette([word(0), word(2)], alpha);
    let codes = u32::from_le_bytes([colors[4], colors[5], colors[6], colors[7]]);
    let mut texels = std::array::from_fn(|i| four[(codes >> (2 * i) & 3) as usize]);

    // Alpha of its own.
    let bits = alphas.iter().rev().fold(0_u64, |bits, &byte| bits << 8 | u64::from(byte));
    let value = |i: usize| match alpha {
        Alpha::Plain => Some((bits >> (4 * i) & 15) as u32 * 17),
        Alpha::Between => Some(between(bits as u8, (bits >> 8) as u8, bits >> (16 + 3 * i) & 7)),
        Alpha::Opaque | Alpha::Clear => None,
    };
    for (i, texel) in texels.iter_mut().enumerate() {
        if let Some(alpha) = value(i) {
            *texel = *texel & 0x00ff_ffff | alpha << 24;
        }
    }
    texels
}

/// A block's four colours: two of 5, 6 and 5 bits, and two between them, or one and black.
fn palette(ends: [u16; 2], alpha: Alpha) -> [u32; 4] {
    let widened = |value: u16, bits: u32| u32::from(value << (8 - bits) | value >> (2 * bits - 8));
    let [first, second] =
        ends.map(|v| [widened(v >> 11, 5), widened(v >> 5 & 63, 6), widened(v & 31, 5)]);
    let mixed = |a: u32, b: u32| std::array::from_fn(|k| (a * first[k] + b * second[k]) / (a + b));
    let opaque = |[r, g, b]: [u32; 3]| r | g << 8 | b << 16 | 0xff00_0000;
    let (third, fourth) = if ends[0] > ends[1] || matches!(alpha, Alpha::Plain | Alpha::Between) {
        (opaque(mixed(2, 1)), opaque(mixed(1, 2)))
    } else {
        (opaque(mixed(1, 1)), if alpha == Alpha::Clear { 0 } else { 0xff00_0000 })
    };
    [opaque(first), opaque(second), third, fourth]
}

/// The alpha that a code means.
fn between(first: u8, second: u8, code: u64) -> u32 {
    let (a, b, code) = (u32::from(first), u32::from(second), code as u32);
    match code {
        0 => a,
        1 => b,
        _ if a > b => ((8 - code) * a + (code - 1) * b) / 7,
        6 => 0,
        7 => 255,
        _ => ((6 - code) * a + (code - 1) * b) / 5,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White and black as ends, and in the first row all four codes.
    const COLORS: [u8; 8] = [0xff, 0xff, 0, 0, 0b1110_0100, 0, 0, 0];

    #[test]
    fn colours_lie_between_the_ends() {
        let texels = decode(COMPRESSED_RGB_S3TC_DXT1_EXT, [4, 4], &COLORS);
        assert_eq!(texels[..5], [0xffff_ffff, 0xff00_0000, 0xffaa_aaaa, 0xff55_5555, 0xffff_ffff]);
        // The ends the other way round: the middle, and black or nothing.
        let swapped = [0, 0, 0xff, 0xff, 0b1110_0100, 0, 0, 0];
        for (token, last) in
            [(COMPRESSED_RGB_S3TC_DXT1_EXT, 0xff00_0000), (COMPRESSED_RGBA_S3TC_DXT1_EXT, 0)]
        {
            assert_eq!(
                decode(token, [4, 4], &swapped)[..4],
                [0xff00_0000, 0xffff_ffff, 0xff7f_7f7f, last]
            );
        }
        // Red of 5 bits, green of 6, blue of 5.
        let ends = [0b0001_0000u16 << 8, 0, 0, 0].map(|v| v.to_le_bytes()).concat();
        assert_eq!(decode(COMPRESSED_RGB_S3TC_DXT1_EXT, [1, 1], &ends), [0xff00_0010]);
    }

    #[test]
    fn alpha_is_plain_or_between_two_values() {
        let plain = [&[0x21, 0xf3, 0, 0, 0, 0, 0, 0][..], &COLORS].concat();
        let texels = decode(COMPRESSED_RGBA_S3TC_DXT3_EXT, [4, 4], &plain);
        assert_eq!(texels[..4], [0x11ff_ffff, 0x2200_0000, 0x33aa_aaaa, 0xff55_5555]);
        // Codes 0, 1, 2, 7 in the first row.
        let codes = 0o7210_u64;
        let block = |first: u8, second: u8| {
            let alphas = codes << 16 | u64::from(second) << 8 | u64::from(first);
            [&alphas.to_le_bytes()[..], &COLORS].concat()
        };
        let alphas = |first, second| {
            let texels = decode(COMPRESSED_RGBA_S3TC_DXT5_EXT, [4, 4], &block(first, second));
            [texels[0], texels[1], texels[2], texels[3]].map(|texel| texel >> 24)
        };
        assert_eq!(alphas(140, 0), [140, 0, 120, 20]);
        assert_eq!(alphas(0, 100), [0, 100, 20, 255]);
    }

    #[test]
    fn images_need_not_be_whole_blocks() {
        assert_eq!(image_bytes(COMPRESSED_RGBA_S3TC_DXT5_EXT, [5, 3]), 32);
        let bytes = [COLORS, [0; 8]].concat();
        let texels = decode(COMPRESSED_RGB_S3TC_DXT1_EXT, [5, 1], &bytes);
        assert_eq!(texels, [0xffff_ffff, 0xff00_0000, 0xffaa_aaaa, 0xff55_5555, 0xff00_0000]);
    }
}
