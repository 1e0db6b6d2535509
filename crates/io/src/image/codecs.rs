//! Pictures by the decoders of the `image` crate: JPEG, TGA, BMP, GIF, WebP, TIFF and DDS.

use super::{Codec, check_size, plane, rgba_from_bytes};
use crate::{Error, Place};
use image::codecs::{
    bmp::BmpDecoder, dds::DdsDecoder, gif::GifDecoder, jpeg::JpegDecoder, tga::TgaDecoder,
};
use image::codecs::{tiff::TiffDecoder, webp::WebPDecoder};
use image::{DynamicImage, ImageDecoder, ImageResult};
use std::io::Cursor;
use vitral_frame::Plane;

/// So many pixels are read however short a file is: one colour all over takes few bytes.
const SURE_PIXELS: u64 = 1 << 24;
/// Beyond them, most pixels that a byte of a file may stand for.
const PIXELS_A_BYTE: u64 = 1 << 12;

/// Most pixels that a byte of a JPEG file can stand for: each block of 64 takes at least one bit of
/// its first scan.
const JPEG_PIXELS_A_BYTE: u64 = 64 * 8;

/// Decodes a picture of any format but PNG.
pub(super) fn decode(codec: Codec, bytes: &[u8], file: &str) -> Result<Plane<[u8; 4]>, Error> {
    let (cursor, source, name) = (Cursor::new(bytes), (bytes, file), codec.name());
    match codec {
        Codec::Jpeg => decode_by(
            JpegDecoder::new(cursor),
            name,
            source,
            JPEG_PIXELS_A_BYTE * bytes.len() as u64,
        ),
        Codec::Gif => decode_dense(GifDecoder::new(cursor), name, source),
        Codec::WebP => decode_dense(WebPDecoder::new(cursor), name, source),
        Codec::Dds => decode_dense(DdsDecoder::new(cursor), name, source),
        Codec::Bmp => decode_dense(BmpDecoder::new(cursor), name, source),
        Codec::Tiff => decode_dense(TiffDecoder::new(cursor), name, source),
        Codec::Tga => decode_dense(TgaDecoder::new(cursor), name, source),
    }
}

/// Any of the formats whose pictures may be much shorter than their pixels.
fn decode_dense(
    decoder: ImageResult<impl ImageDecoder>,
    format: &str,
    (bytes, file): (&[u8], &str),
) -> Result<Plane<[u8; 4]>, Error> {
    decode_by(decoder, format, (bytes, file), SURE_PIXELS.max(PIXELS_A_BYTE * bytes.len() as u64))
}

/// What a decoder gives of a file that cannot hold more than `most` pixels.
fn decode_by(
    decoder: ImageResult<impl ImageDecoder>,
    format: &str,
    (bytes, file): (&[u8], &str),
    most: u64,
) -> Result<Plane<[u8; 4]>, Error> {
    let bad = |e: image::ImageError| Error::malformed(file, Place::File, format!("{format}: {e}"));
    let decoder = decoder.map_err(bad)?;
    let (width, height) = decoder.dimensions();
    check_size(width, height, file)?;
    // Pixels of more than four bytes count for as many as they take.
    if (u64::from(width) * u64::from(height)).max(decoder.total_bytes() / 4) > most {
        let what = format!(
            "{format}: {width} x {height} pixels are announced, the file has {} bytes",
            bytes.len()
        );
        return Err(Error::malformed(file, Place::File, what));
    }
    let rgba = DynamicImage::from_decoder(decoder).map_err(bad)?.into_rgba8().into_raw();
    plane(width, height, rgba_from_bytes(rgba), file)
}
