//! GIF out: 256 colours a picture, each pixel opaque or transparent; pictures one after the other
//! make an animation.
//!
//! A picture of more colours gets those that a neural network finds (NeuQuant, in the `gif` crate),
//! without dithering.
//!
//! Source: \[GIF89a\].

use crate::Error;
#[cfg(feature = "images")]
use vitral_frame::Plane;

/// Most pixels along a side.
pub(super) const LONGEST: u32 = 65_535;

/// How fast colours are chosen, 1 (best) to 30 (fastest): the middle that the `gif` crate advises.
#[cfg(feature = "images")]
const SPEED: i32 = 10;

/// Pixels with at least this much alpha are opaque.
#[cfg(feature = "images")]
const OPAQUE_FROM: u8 = 128;

/// A GIF that grows picture by picture.
#[cfg(feature = "images")]
pub(super) struct Gif(gif::Encoder<Vec<u8>>);

#[cfg(feature = "images")]
impl Gif {
    /// An empty file; `repeats` for one that plays for ever.
    pub(super) fn new([width, height]: [u32; 2], repeats: bool) -> Result<Self, Error> {
        // The sides have been checked.
        let mut encoder =
            gif::Encoder::new(Vec::new(), width as u16, height as u16, &[]).map_err(failed)?;
        if repeats {
            encoder.set_repeat(gif::Repeat::Infinite).map_err(failed)?;
        }
        Ok(Self(encoder))
    }

    /// Adds a picture, shown for so many hundredths of a second.
    pub(super) fn add(&mut self, picture: &Plane<[u8; 4]>, hundredths: u16) -> Result<(), Error> {
        let whole = |&[r, g, b, a]: &[u8; 4]| if a < OPAQUE_FROM { [0; 4] } else { [r, g, b, 255] };
        let mut pixels = picture.data().iter().map(whole).collect::<Vec<_>>().into_flattened();
        let (width, height) = (picture.width() as u16, picture.height() as u16);
        let mut frame = gif::Frame::from_rgba_speed(width, height, &mut pixels, SPEED);
        frame.delay = hundredths;
        // The next picture does not lie over this one.
        frame.dispose = gif::DisposalMethod::Background;
        self.0.write_frame(&frame).map_err(failed)
    }

    /// The whole file.
    pub(super) fn finish(self) -> Result<Vec<u8>, Error> {
        self.0.into_inner().map_err(|e| Error::Encode { what: format!("GIF: {e}") })
    }
}

#[cfg(feature = "images")]
fn failed(error: gif::EncodingError) -> Error {
    Error::Encode { what: format!("GIF: {error}") }
}

/// Stands for the writer that is not part of this build.
#[cfg(not(feature = "images"))]
pub(super) struct Gif(std::convert::Infallible);

#[cfg(not(feature = "images"))]
impl Gif {
    /// Refuses.
    pub(super) fn new(_: [u32; 2], _: bool) -> Result<Self, Error> {
        Err(Error::Encode { what: crate::format::left_out("GIF", "images") })
    }

    /// Cannot be called.
    pub(super) fn add(&mut self, _: &vitral_frame::Plane<[u8; 4]>, _: u16) -> Result<(), Error> {
        match self.0 {}
    }

    /// Cannot be called.
    pub(super) fn finish(self) -> Result<Vec<u8>, Error> {
        match self.0 {}
    }
}
