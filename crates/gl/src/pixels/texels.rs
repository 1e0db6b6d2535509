//! Values on their way into a texture image: converted to what the internal format stores.

use super::decode;
use super::format::{Content, float_from_half, half_from_float};
use super::internal_format::{InternalFormat, Storage};
use super::store::ClientImage;
use super::transfer::{Transfer, clamp_unit};
use crate::enums::RGBA;
use std::borrow::Cow;
use vitral_exec::Workers;
use vitral_raster::forward::Texels;

/// Texels of a box, in the form in which an image of that format stores them.
#[derive(Clone, Debug)]
pub(crate) enum TexelData {
    /// `Rgba8` and `Srgb8`.
    Words(Vec<u32>),
    /// `RgbaF32`.
    Floats(Vec<[f32; 4]>),
    /// Depth 0..=1, and stencil if the format has one.
    Depths(Vec<f32>, Option<Vec<u8>>),
}

/// A word of a colour in 0..=1, red in the lowest byte.
#[inline]
pub(crate) fn word_from_color(color: [f32; 4]) -> u32 {
    u32::from_le_bytes(color.map(|v| (clamp_unit(v) * 255.0 + 0.5) as u8))
}

/// The colour of a word.
#[inline]
pub(crate) fn color_from_word(word: u32) -> [f32; 4] {
    word.to_le_bytes().map(|v| f32::from(v) / 255.0)
}

/// `depth` as a depth plane of `scale` stores it.
#[inline]
pub(crate) fn stored_depth(depth: f32, scale: f32) -> f32 {
    if scale == 1.0 {
        depth
    } else {
        (f64::from(clamp_unit(depth)) * f64::from(scale) + 0.5).floor() as f32
    }
}

/// The client's pixels as texels of `format`.
pub(crate) fn from_client(
    workers: &Workers,
    image: Cow<'_, ClientImage>,
    format: &InternalFormat,
    transfer: &Transfer<'_>,
) -> TexelData {
    if format.has_depth() {
        let mut depths = decode::depths(&image, transfer, format.depth_scale() != 1.0);
        round_depths(&mut depths, format);
        // Depths alone leave the stencil values as they are.
        let both = format.has_stencil() && image.format.content() == Content::DepthStencil;
        let stencils = both.then(|| decode::stencils(&image, transfer));
        return TexelData::Depths(depths, stencils);
    }
    if !matches!(format.storage, Storage::Unorm8 | Storage::Srgb8) {
        return from_colors(decode::colors(workers, &image, transfer), format);
    }
    let image = if transfer.keeps_colors() { decode::words(image) } else { Err(image) };
    let image = match image {
        Ok(words) => return from_words(words, format),
        Err(image) => image,
    };
    let word =
        |(word, &color): (&mut u32, &[f32; 4])| *word = format.expand_word(word_from_color(color));
    TexelData::Words(decode::from_colors(workers, &image, transfer, |colors, words| {
        words.iter_mut().zip(colors).for_each(word);
    }))
}

/// Colours (after transfer) as texels of a colour format.
pub(crate) fn from_colors(mut colors: Vec<[f32; 4]>, format: &InternalFormat) -> TexelData {
    if matches!(format.storage, Storage::Unorm8 | Storage::Srgb8) {
        return TexelData::Words(
            colors.into_iter().map(|c| format.expand_word(word_from_color(c))).collect(),
        );
    }
    for color in &mut colors {
        let rounded = match format.storage {
            Storage::Unorm16 => color.map(|v| (clamp_unit(v) * 65535.0 + 0.5).floor() / 65535.0),
            Storage::Half => color.map(|v| float_from_half(half_from_float(v))),
            _ => *color,
        };
        *color = format.expand(rounded);
    }
    TexelData::Floats(colors)
}

/// Words of a framebuffer as texels of a colour format.
pub(crate) fn from_words(mut words: Vec<u32>, format: &InternalFormat) -> TexelData {
    if matches!(format.storage, Storage::Unorm8 | Storage::Srgb8) {
        if format.base != RGBA {
            words.iter_mut().for_each(|w| *w = format.expand_word(*w));
        }
        return TexelData::Words(words);
    }
    from_colors(words.into_iter().map(color_from_word).collect(), format)
}

/// Rounds depths to the bits of `format`.
pub(crate) fn round_depths(depths: &mut [f32], format: &InternalFormat) {
    let scale = format.depth_scale();
    if scale != 1.0 {
        for depth in depths {
            *depth = (f64::from(stored_depth(*depth, scale)) / f64::from(scale)) as f32;
        }
    }
}

/// Texels of `count` undefined pixels: zeros.
pub(crate) fn blank(format: &InternalFormat, count: usize) -> Texels {
    match format.storage {
        Storage::Unorm8 => Texels::Rgba8(vec![format.expand_word(0); count]),
        Storage::Srgb8 => Texels::Srgb8(vec![format.expand_word(0); count]),
        Storage::Unorm16 | Storage::Half | Storage::Float => {
            Texels::RgbaF32(vec![format.expand([0.0; 4]); count])
        }
        Storage::Depth(_) | Storage::Stencil => Texels::Depth(vec![0.0; count]),
    }
}

/// Copies the runs (rows) of a box: source row, first texel of the destination row.
fn copy_rows<T: Copy>(
    from: &[T],
    into: &mut [T],
    full: [usize; 3],
    origin: [usize; 3],
    size: [usize; 3],
) {
    let [width, height, depth] = size;
    if width == 0 {
        return;
    }
    for z in 0..depth {
        for y in 0..height {
            let first = ((origin[2] + z) * full[1] + origin[1] + y) * full[0] + origin[0];
            let source = (z * height + y) * width;
            into[first..first + width].copy_from_slice(&from[source..source + width]);
        }
    }
}

/// Puts a box of texels into an image of size `full`. Both are of one format. Depths that are in a
/// plane are not touched here.
pub(crate) fn put(
    into: &mut Texels,
    full: [usize; 3],
    origin: [usize; 3],
    size: [usize; 3],
    data: &TexelData,
) {
    match (into, data) {
        (Texels::Rgba8(into) | Texels::Srgb8(into), TexelData::Words(from)) => {
            copy_rows(from, into, full, origin, size);
        }
        (Texels::RgbaF32(into), TexelData::Floats(from)) => {
            copy_rows(from, into, full, origin, size)
        }
        (Texels::Depth(into), TexelData::Depths(from, _)) => {
            copy_rows(from, into, full, origin, size)
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::enums::*;

    #[test]
    fn depth_rounds_to_its_bits() {
        let format = InternalFormat::of_texture(DEPTH_COMPONENT16).unwrap();
        let mut depths = [0.5, 1.5, f32::NAN];
        round_depths(&mut depths, &format);
        assert_eq!(depths, [(32768.0f64 / 65535.0) as f32, 1.0, 0.0]);
        // Every 24-bit depth survives the way through a float in 0..=1.
        for whole in [0u32, 1, 8_388_607, 8_388_609, 16_777_213, 16_777_214, 16_777_215] {
            let depth = (f64::from(whole) / 16_777_215.0) as f32;
            assert_eq!(stored_depth(depth, 16_777_215.0), whole as f32);
        }
    }

    #[test]
    fn a_box_lands_in_its_place() {
        let mut image = Texels::Rgba8(vec![0; 12]);
        put(&mut image, [3, 2, 2], [1, 1, 1], [2, 1, 1], &TexelData::Words(vec![5, 6]));
        let Texels::Rgba8(words) = image else { panic!() };
        assert_eq!(words, [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5, 6]);
    }
}
