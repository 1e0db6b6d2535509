//! Pictures and channels out, and pictures back in to be compared.
//!
//! | writer | for |
//! |---|---|
//! | [`png()`] | pictures with or without transparency |
//! | [`png16_gray`] | depth and the like as 16-bit grey |
//! | [`jpeg()`] | small opaque pictures |
//! | [`ppm()`] | the simplest format there is |
//! | [`npy_f32`], [`npy_f32x3`], [`npy_u32`] | channels without loss, for numpy |
//!
//! All take planes with the top row first and straight alpha, and give the whole file.

mod jpeg;
mod npy;
mod png;
mod ppm;

pub use jpeg::jpeg;
pub use npy::{npy_f32, npy_f32x3, npy_u32};
pub use png::{PngOptions, png, png16_gray};
pub use ppm::ppm;

use crate::Error;
use vitral_frame::Plane;
use vitral_math::color;

/// What is read, for messages about other formats.
const READ: &str =
    if cfg!(feature = "images") { "PNG, JPEG, TGA, BMP, GIF, WebP, TIFF, DDS and PPM are" } else { "PNG and PPM are" };

/// Reads a picture: PPM (also PGM), or a format that textures come in, known by content.
///
/// # Errors
/// [`Error::Unsupported`] for content of no known format, [`Error::Malformed`] for damaged one.
pub fn decode_picture(bytes: &[u8], file: &str) -> Result<Plane<[u8; 4]>, Error> {
    match bytes {
        [b'P', b'5' | b'6', ..] => ppm::decode(bytes, file),
        _ => {
            crate::image::whole(bytes, file)?;
            crate::image::decode_else(bytes, file, READ)
        }
    }
}

/// Refuses pictures without pixels or with sides longer than a format can say.
fn check_sides(width: u32, height: u32, longest: u32, format: &str) -> Result<(), Error> {
    if width == 0 || height == 0 || width > longest || height > longest {
        let what = format!("a {format} has 1 to {longest} pixels a side, not {width} x {height}");
        return Err(Error::Encode { what });
    }
    Ok(())
}

/// The RGB bytes of a picture; what is transparent lets a white page through, mixed in linear light.
fn over_white(picture: &Plane<[u8; 4]>) -> Vec<u8> {
    let linear = color::linear_from_srgb_table();
    let mixed = |c: u8, a: u8| {
        let a = f32::from(a) / 255.0;
        color::byte_from_unit(color::srgb_from_linear(linear[usize::from(c)] * a + (1.0 - a)))
    };
    let pixel = |&[r, g, b, a]: &[u8; 4]| match a {
        255 => [r, g, b],
        0 => [255; 3],
        _ => [r, g, b].map(|c| mixed(c, a)),
    };
    picture.data().iter().map(pixel).collect::<Vec<_>>().into_flattened()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transparent_picture_lies_on_white_paper() {
        let picture = Plane::from_rows(3, 1, vec![[1, 2, 3, 255], [1, 2, 3, 0], [0, 0, 0, 128]]).unwrap();
        let rgb = over_white(&picture);
        assert_eq!(rgb[..6], [1, 2, 3, 255, 255, 255]);
        assert_eq!(rgb[6..], [187; 3], "half the light is the sRGB byte 187 or 188");
    }
}
