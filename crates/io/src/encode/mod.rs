//! Pictures and channels out, and pictures back in to be compared.
//!
//! | writer | for |
//! |---|---|
//! | [`png()`] | pictures with or without transparency |
//! | [`png16_gray`] | depth and the like as 16-bit grey |
//! | [`jpeg()`] | small opaque pictures |
//! | [`gif()`] | pictures of few colours |
//! | [`webp()`] | small lossless pictures |
//! | [`Animation`] | turntables as GIF, APNG or WebP |
//! | [`ppm()`] | the simplest format there is |
//! | [`npy_f32`], [`npy_f32x3`], [`npy_u32`] | channels without loss, for numpy |
//! | [`svg()`] | drawings for browsers and drawing programs |
//! | [`pdf()`] | drawings for print |
//! | [`dxf()`] | drawings for CAD programs |
//! | [`hpgl()`] | drawings for plotters |
//!
//! Those of pictures take planes with the top row first and straight alpha; all give the whole
//! file. [`simplify()`], [`for_plotter`] and [`TitleBlock`] change a drawing before it is written.

mod animation;
mod dxf;
mod gif;
mod hpgl;
mod jpeg;
mod npy;
mod pdf;
mod pens;
mod pixels;
mod plotter;
mod png;
mod ppm;
mod simplify;
mod svg;
mod title_block;
mod webp;

pub use animation::{Animation, AnimationFormat, gif, webp};
pub use dxf::dxf;
pub use hpgl::hpgl;
pub use jpeg::jpeg;
pub use npy::{npy_f32, npy_f32x3, npy_u32};
pub use pdf::pdf;
pub use pens::{DrawingOptions, HATCH, HIDDEN, POINT, Pens, Polyline, TITLE};
pub use plotter::for_plotter;
pub use png::{PngOptions, png, png_with_text, png16_gray};
pub use ppm::ppm;
pub use simplify::simplify;
pub use svg::svg;
pub use title_block::{Figure, TitleBlock};

use crate::Error;
use vitral_frame::Plane;

/// What is read, for messages about other formats.
const READ: &str = if cfg!(feature = "images") {
    "PNG, JPEG, TGA, BMP, GIF, WebP, TIFF, DDS and PPM are"
} else {
    "PNG and PPM are"
};

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
