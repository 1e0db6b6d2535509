//! Lossless WebP out. The `image-webp` crate codes each picture; an animation is a container of
//! such pictures.
//!
//! Source: \[WebP\].

use crate::Error;
use vitral_frame::Plane;

/// Most pixels along a side.
pub(super) const LONGEST: u32 = 16_384;

/// Bytes before the first chunk: the common tag, the size of the file, the tag of WebP.
const HEADER_BYTES: usize = 12;

/// A WebP file with one picture.
#[cfg(feature = "images")]
pub(super) fn still(picture: &Plane<[u8; 4]>) -> Result<Vec<u8>, Error> {
    let mut out = Vec::new();
    image_webp::WebPEncoder::new(&mut out)
        .encode(
            picture.data().as_flattened(),
            picture.width(),
            picture.height(),
            image_webp::ColorType::Rgba8,
        )
        .map_err(|e| Error::Encode { what: format!("WebP: {e}") })?;
    Ok(out)
}

/// Refuses: the coder is not part of this build.
#[cfg(not(feature = "images"))]
pub(super) fn still(_: &Plane<[u8; 4]>) -> Result<Vec<u8>, Error> {
    Err(Error::Encode { what: crate::format::left_out("WebP", "images") })
}

/// A WebP animation that grows picture by picture and plays for ever.
pub(super) struct Animated {
    /// The file so far; its size is filled in at the end.
    file: Vec<u8>,
    size: [u32; 2],
}

impl Animated {
    /// An animation without pictures.
    pub(super) fn new(size: [u32; 2]) -> Self {
        const ANIMATION: u8 = 1 << 1;
        const ALPHA: u8 = 1 << 4;
        let mut file = Vec::from(*b"RIFF\0\0\0\0WEBP");
        let mut extended = vec![ANIMATION | ALPHA, 0, 0, 0];
        size.iter().for_each(|side| extended.extend(three_bytes(side - 1)));
        add_chunk(&mut file, b"VP8X", &extended);
        // A transparent background, and no end of repetitions.
        add_chunk(&mut file, b"ANIM", &[0; 6]);
        Self { file, size }
    }

    /// Adds a picture, shown for so many milliseconds.
    pub(super) fn add(&mut self, picture: &Plane<[u8; 4]>, milliseconds: u32) -> Result<(), Error> {
        const REPLACES: u8 = 1 << 1;
        let file = still(picture)?;
        let mut frame = vec![0; 6];
        self.size.iter().for_each(|side| frame.extend(three_bytes(side - 1)));
        frame.extend(three_bytes(milliseconds));
        frame.push(REPLACES);
        frame.extend(&file[HEADER_BYTES..]);
        add_chunk(&mut self.file, b"ANMF", &frame);
        Ok(())
    }

    /// The whole file.
    pub(super) fn finish(mut self) -> Result<Vec<u8>, Error> {
        let too_long =
            |_| Error::Encode { what: "WebP: the animation has more than 4 GiB".to_owned() };
        let size = u32::try_from(self.file.len() - 8).map_err(too_long)?;
        self.file[4..8].copy_from_slice(&size.to_le_bytes());
        Ok(self.file)
    }
}

/// A number of 24 bits, the lowest first.
fn three_bytes(number: u32) -> [u8; 3] {
    let [a, b, c, _] = number.to_le_bytes();
    [a, b, c]
}

/// A tag, the length, the content, and a byte that makes the length even.
fn add_chunk(file: &mut Vec<u8>, tag: &[u8; 4], content: &[u8]) {
    file.extend(tag);
    file.extend((content.len() as u32).to_le_bytes());
    file.extend(content);
    if content.len() % 2 == 1 {
        file.push(0);
    }
}
