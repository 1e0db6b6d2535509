//! Images of light: Radiance's HDR and OpenEXR, whose numbers are linear, and all pictures of
//! bytes, which are decoded from sRGB.
//!
//! In:   the bytes of a file. Out: linear RGB, the top row first. Alpha is left out.
//! Cost: that of the decoder. The header's size is checked before anything is allocated.

use super::{decode_else, whole};
use crate::Error;
use vitral_frame::Plane;
use vitral_math::color::linear_from_srgb_table;

/// What is read, for messages about other formats.
const READ: &str = "HDR, EXR, PNG, JPEG, TGA, BMP, GIF, WebP, TIFF and DDS are";

/// Decodes an image of light. `file` is its name, for messages.
///
/// # Errors
/// Formats that are known but not read are [`Error::Unsupported`], damaged files
/// [`Error::Malformed`].
pub fn decode_radiance(bytes: &[u8], file: &str) -> Result<Plane<[f32; 3]>, Error> {
    match bytes {
        [b'#', b'?', ..] => decode_floats(Floats::Hdr, bytes, file),
        [0x76, 0x2f, 0x31, 0x01, ..] => decode_floats(Floats::Exr, bytes, file),
        _ => {
            whole(bytes, file)?;
            let picture = decode_else(bytes, file, READ)?;
            let table = linear_from_srgb_table();
            Ok(picture.map(|&[r, g, b, _]| [r, g, b].map(|byte| table[usize::from(byte)])))
        }
    }
}

/// A format of floating-point numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Floats {
    Hdr,
    Exr,
}

#[cfg(feature = "images")]
use decoders::decode_floats;

/// Refuses the format: its decoder is not part of this build.
#[cfg(not(feature = "images"))]
fn decode_floats(format: Floats, _: &[u8], file: &str) -> Result<Plane<[f32; 3]>, Error> {
    let (name, feature) = match format {
        Floats::Hdr => ("Radiance HDR", "images"),
        Floats::Exr => ("OpenEXR", "exr"),
    };
    Err(Error::Unsupported { file: file.to_owned(), what: crate::format::left_out(name, feature) })
}

#[cfg(feature = "images")]
mod decoders {
    use super::Floats;
    use crate::image::check_size;
    use crate::{Error, Place};
    use image::codecs::hdr::HdrDecoder;
    use image::{DynamicImage, ImageDecoder, ImageResult};
    use std::io::Cursor;
    use vitral_frame::Plane;

    /// So many pixels are read however short a file is; beyond them, most that a byte of a file may
    /// stand for.
    const SURE_PIXELS: u64 = 1 << 22;
    const PIXELS_A_BYTE: u64 = 64;

    pub(super) fn decode_floats(
        format: Floats,
        bytes: &[u8],
        file: &str,
    ) -> Result<Plane<[f32; 3]>, Error> {
        match format {
            Floats::Hdr => {
                decode_by(HdrDecoder::new(Cursor::new(bytes)), "Radiance HDR", (bytes, file))
            }
            Floats::Exr => decode_exr(bytes, file),
        }
    }

    #[cfg(feature = "exr")]
    fn decode_exr(bytes: &[u8], file: &str) -> Result<Plane<[f32; 3]>, Error> {
        decode_by(
            image::codecs::openexr::OpenExrDecoder::new(Cursor::new(bytes)),
            "OpenEXR",
            (bytes, file),
        )
    }

    #[cfg(not(feature = "exr"))]
    fn decode_exr(_: &[u8], file: &str) -> Result<Plane<[f32; 3]>, Error> {
        let what = crate::format::left_out("OpenEXR", "exr");
        Err(Error::Unsupported { file: file.to_owned(), what })
    }

    fn decode_by(
        decoder: ImageResult<impl ImageDecoder>,
        format: &str,
        (bytes, file): (&[u8], &str),
    ) -> Result<Plane<[f32; 3]>, Error> {
        let bad =
            |e: image::ImageError| Error::malformed(file, Place::File, format!("{format}: {e}"));
        let decoder = decoder.map_err(bad)?;
        let (width, height) = decoder.dimensions();
        check_size(width, height, file)?;
        if u64::from(width) * u64::from(height)
            > SURE_PIXELS.max(PIXELS_A_BYTE * bytes.len() as u64)
        {
            let what = format!(
                "{format}: {width} x {height} pixels are announced, the file has {} bytes",
                bytes.len()
            );
            return Err(Error::malformed(file, Place::File, what));
        }
        let texels = DynamicImage::from_decoder(decoder).map_err(bad)?.into_rgb32f().into_raw();
        let texels = texels.as_chunks().0.to_vec();
        Plane::from_rows(width, height, texels).ok_or_else(|| {
            Error::malformed(file, Place::File, "the image ends before its last row")
        })
    }
}

#[cfg(all(test, feature = "exr"))]
mod tests {
    use super::*;
    use image::{ExtendedColorType, ImageEncoder};

    const LIGHT: [[f32; 3]; 6] = [
        [0.5, 1.0, 2.0],
        [0.0; 3],
        [64.0, 32.0, 16.0],
        [0.25; 3],
        [1.0, 0.0, 0.0],
        [0.125, 0.5, 8.0],
    ];

    fn exr() -> Vec<u8> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let numbers: Vec<u8> = LIGHT.iter().flatten().flat_map(|v| v.to_ne_bytes()).collect();
        let encoder = image::codecs::openexr::OpenExrEncoder::new(&mut bytes);
        encoder.write_image(&numbers, 3, 2, ExtendedColorType::Rgb32F).unwrap();
        bytes.into_inner()
    }

    fn hdr() -> Vec<u8> {
        let mut bytes = Vec::new();
        let texels = LIGHT.map(image::Rgb);
        image::codecs::hdr::HdrEncoder::new(&mut bytes).encode(&texels, 3, 2).unwrap();
        bytes
    }

    #[test]
    fn numbers_beyond_one_come_back() {
        let read = decode_radiance(&exr(), "a.exr").unwrap();
        assert_eq!((read.width(), read.height(), read.data()), (3, 2, &LIGHT[..]));
        // RGBE has one exponent for three mantissas of 8 bits.
        let read = decode_radiance(&hdr(), "a.hdr").unwrap();
        for (read, wanted) in read.data().iter().zip(LIGHT) {
            let most = wanted.into_iter().fold(0.0, f32::max);
            assert!(
                (0..3).all(|k| (read[k] - wanted[k]).abs() <= most / 128.0),
                "{read:?} {wanted:?}"
            );
        }
    }

    #[test]
    fn bytes_are_decoded_from_srgb() {
        let picture = Plane::from_rows(2, 1, vec![[0, 255, 188, 255], [0, 0, 0, 0]]).unwrap();
        let png = crate::encode::png(&picture, crate::encode::PngOptions::default()).unwrap();
        let read = decode_radiance(&png, "a.png").unwrap();
        assert!(
            read.data()[0][0] == 0.0
                && read.data()[0][1] == 1.0
                && (read.data()[0][2] - 0.503).abs() < 1e-3
        );
    }

    #[test]
    fn damage_is_an_error() {
        for (bytes, name) in [(exr(), "a.exr"), (hdr(), "a.hdr")] {
            for cut in [4, 11, bytes.len() / 2, bytes.len() - 3] {
                let error = decode_radiance(&bytes[..cut], name).unwrap_err().to_string();
                assert!(error.starts_with(name), "{error}");
            }
        }
        let large = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16000 +X 16000\n";
        let error = decode_radiance(large, "a.hdr").unwrap_err().to_string();
        assert!(error.contains("16000 x 16000 pixels are announced, the file has"), "{error}");
        assert!(decode_radiance(b"nonsense", "a.exr").is_err());
    }
}
