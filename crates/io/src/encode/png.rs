//! PNG out, tuned for speed.
//!
//! The Paeth filter with `fdeflate` writes a rendered 1024x768 picture in 2.6 ms at 228 kB on one
//! core of the machine where this was chosen. Sub takes 2.3 ms at 249 kB, choosing a filter for
//! each row 3.3 ms at 222 kB. Splitting the rows between threads needs another deflate coder (4.5
//! ms and more at the same size), so it would not pay on two cores.
//!
//! Source: \[PNG\].

use super::pixels::check_sides;
use crate::Error;
use png::{BitDepth, ColorType, Compression, Encoder, Filter, SrgbRenderingIntent};
use std::io::Write;
use std::sync::{Arc, Mutex, PoisonError};
use vitral_frame::Plane;

/// What a PNG says about itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PngOptions {
    /// The bytes are sRGB (the usual case); false for raw values, whose file names no colour space.
    pub srgb: bool,
}

impl Default for PngOptions {
    fn default() -> Self {
        Self { srgb: true }
    }
}

/// Writes a picture: RGB if every pixel is opaque, RGBA otherwise.
///
/// # Errors
/// [`Error::Encode`] if the picture has no pixels or more than 2³¹ - 1 a side.
pub fn png(picture: &Plane<[u8; 4]>, options: PngOptions) -> Result<Vec<u8>, Error> {
    png_with_text(picture, options, &[])
}

/// [`png()`] with text chunks, each a keyword and its text in Latin-1.
///
/// # Errors
/// As [`png()`]; [`Error::Encode`] for a text that PNG cannot hold.
pub fn png_with_text(
    picture: &Plane<[u8; 4]>,
    options: PngOptions,
    texts: &[(&str, &str)],
) -> Result<Vec<u8>, Error> {
    let size = [picture.width(), picture.height()];
    if let Some(rgb) = without_alpha(picture.data()) {
        return write(size, (ColorType::Rgb, BitDepth::Eight), &rgb, options, texts);
    }
    let data = picture.data().as_flattened();
    write(size, (ColorType::Rgba, BitDepth::Eight), data, options, texts)
}

/// Red, green and blue of pixels that are all opaque; four a step.
fn without_alpha(pixels: &[[u8; 4]]) -> Option<Vec<u8>> {
    let mut rgb = vec![0; 3 * pixels.len()];
    let mut alpha = u32::MAX;
    let (fours, rest) = pixels.as_chunks::<4>();
    for (four, out) in fours.iter().zip(rgb.as_chunks_mut::<12>().0) {
        let [a, b, c, d] = four.map(u32::from_le_bytes);
        alpha &= a & b & c & d;
        let words = [a & 0xff_ffff | b << 24, b >> 8 & 0xffff | c << 16, c >> 16 & 0xff | d << 8];
        out.copy_from_slice(words.map(u32::to_le_bytes).as_flattened());
    }
    for (pixel, out) in rest.iter().zip(rgb[12 * fours.len()..].as_chunks_mut::<3>().0) {
        alpha &= u32::from_le_bytes(*pixel);
        out.copy_from_slice(&pixel[..3]);
    }
    (alpha >> 24 == 0xff).then_some(rgb)
}

/// Writes 16-bit grey values, 0 black and 65535 white, without a colour space.
///
/// # Errors
/// As [`png()`].
pub fn png16_gray(plane: &Plane<u16>) -> Result<Vec<u8>, Error> {
    let data: Vec<[u8; 2]> = plane.data().iter().map(|v| v.to_be_bytes()).collect();
    let options = PngOptions { srgb: false };
    let (size, form) = ([plane.width(), plane.height()], (ColorType::Grayscale, BitDepth::Sixteen));
    write(size, form, data.as_flattened(), options, &[])
}

/// An APNG that grows picture by picture and plays for ever.
pub(super) struct Animated {
    writer: png::Writer<Shared>,
    file: Shared,
}

/// Bytes that the writer and its owner have in common: `png` does not give them back.
#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Animated {
    /// A file for so many pictures with transparency.
    pub(super) fn new(
        [width, height]: [u32; 2],
        count: u32,
        options: PngOptions,
    ) -> Result<Self, Error> {
        let file = Shared::default();
        let mut encoder = Encoder::new(file.clone(), width, height);
        encoder.set_animated(count, 0).map_err(failed)?;
        let writer = begin(encoder, (ColorType::Rgba, BitDepth::Eight), options, &[])?;
        Ok(Self { writer, file })
    }

    /// Adds a picture, shown for so many milliseconds.
    pub(super) fn add(&mut self, picture: &Plane<[u8; 4]>, milliseconds: u16) -> Result<(), Error> {
        self.writer.set_frame_delay(milliseconds, 1000).map_err(failed)?;
        self.writer.write_image_data(picture.data().as_flattened()).map_err(failed)
    }

    /// The whole file.
    pub(super) fn finish(self) -> Result<Vec<u8>, Error> {
        self.writer.finish().map_err(failed)?;
        Ok(std::mem::take(&mut *self.file.0.lock().unwrap_or_else(PoisonError::into_inner)))
    }
}

fn failed(error: png::EncodingError) -> Error {
    Error::Encode { what: format!("PNG: {error}") }
}

/// Writes all that stands before the pixels.
fn begin<W: Write>(
    mut encoder: Encoder<'_, W>,
    (color, depth): (ColorType, BitDepth),
    options: PngOptions,
    texts: &[(&str, &str)],
) -> Result<png::Writer<W>, Error> {
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Paeth);
    if options.srgb {
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    }
    encoder.add_text_chunk("Software".to_owned(), "vitral".to_owned()).map_err(failed)?;
    for &(keyword, text) in texts {
        encoder.add_text_chunk(keyword.to_owned(), text.to_owned()).map_err(failed)?;
    }
    encoder.write_header().map_err(failed)
}

fn write(
    [width, height]: [u32; 2],
    (color, depth): (ColorType, BitDepth),
    data: &[u8],
    options: PngOptions,
    texts: &[(&str, &str)],
) -> Result<Vec<u8>, Error> {
    check_sides(width, height, i32::MAX as u32, "PNG")?;
    let mut out = Vec::with_capacity(data.len() / 4 + 1024);
    let mut writer = begin(Encoder::new(&mut out, width, height), (color, depth), options, texts)?;
    writer.write_image_data(data).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::decode;

    #[test]
    fn the_colour_type_follows_the_alpha() {
        for (alpha, color) in [(255, 2), (254, 6)] {
            let picture = Plane::from_rows(2, 1, vec![[1, 2, 3, 255], [4, 5, 6, alpha]]).unwrap();
            let file = png(&picture, PngOptions::default()).unwrap();
            assert_eq!(file[25], color, "IHDR's colour type");
            assert_eq!(decode(&file, "a.png").unwrap(), picture);
            let has = |tag: &[u8]| file.windows(tag.len()).any(|w| w == tag);
            assert!(has(b"sRGB") && has(b"tEXtSoftware\0vitral"));
            let raw = png(&picture, PngOptions { srgb: false }).unwrap();
            assert!(!raw.windows(4).any(|w| w == b"sRGB"));
        }
        assert!(
            png(&Plane::default(), PngOptions::default())
                .unwrap_err()
                .to_string()
                .contains("0 x 0")
        );
    }

    #[test]
    fn opaque_pixels_lose_their_alpha() {
        let pixels: Vec<[u8; 4]> = (0..11u8).map(|i| [i, 100 + i, 200 + i, 255]).collect();
        for count in 0..pixels.len() {
            let expected: Vec<u8> =
                pixels[..count].iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
            assert_eq!(without_alpha(&pixels[..count]), Some(expected));
            let mut clear = pixels.clone();
            clear[count][3] = 254;
            assert_eq!(without_alpha(&clear), None);
        }
    }

    #[test]
    fn sixteen_bits_are_kept() {
        let plane = Plane::from_rows(3, 1, vec![0u16, 258, 65535]).unwrap();
        let file = png16_gray(&plane).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut data).unwrap();
        assert_eq!(data, [0, 0, 1, 2, 255, 255]);
    }
}
