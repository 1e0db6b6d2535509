//! PPM (P6) out; PPM and PGM (P5) in.
//!
//! A header of words (format, width, height, largest value), one white space, then the samples row
//! by row, one byte each or two (the high one first) where the largest value is above 255.
//!
//! Source: \[PPM\].

use super::pixels::{check_sides, over_white};
use crate::image::check_size;
use crate::{Error, Place};
use vitral_frame::Plane;

/// Writes a picture. PPM knows no transparency: what is transparent lets a white page through.
///
/// # Errors
/// [`Error::Encode`] if the picture has no pixels.
pub fn ppm(picture: &Plane<[u8; 4]>) -> Result<Vec<u8>, Error> {
    check_sides(picture.width(), picture.height(), u32::MAX, "PPM")?;
    let mut out = format!("P6\n{} {}\n255\n", picture.width(), picture.height()).into_bytes();
    out.extend(over_white(picture));
    Ok(out)
}

/// Reads a P5 or P6 file.
pub(crate) fn decode(bytes: &[u8], file: &str) -> Result<Plane<[u8; 4]>, Error> {
    let bad = |at: usize, what: &str| Error::malformed(file, Place::Byte(at as u64), what);
    let mut at = 2;
    let mut number = || {
        read_number(bytes, &mut at)
            .ok_or_else(|| bad(at, "the header needs width, height and largest value"))
    };
    let (width, height, largest) = (number()?, number()?, number()?);
    check_size(width, height, file)?;
    if !(1..=65_535).contains(&largest) {
        return Err(bad(at, "the largest value is 1 to 65535"));
    }
    at += 1;
    let channels = if bytes[1] == b'6' { 3 } else { 1 };
    let sample = if largest > 255 { 2 } else { 1 };
    let needed = width as usize * height as usize * channels * sample;
    let Some(data) = bytes.get(at..).and_then(|rest| rest.get(..needed)) else {
        return Err(bad(bytes.len(), "the file ends before the last row"));
    };

    // Scale every sample to 0..=255, rounding to nearest.
    let scaled = |s: &[u8]| {
        let value = s.iter().fold(0u32, |v, &b| v << 8 | u32::from(b)).min(largest);
        ((value * 255 + largest / 2) / largest) as u8
    };
    let pixels = data.chunks_exact(channels * sample).map(|p| {
        let value = |k: usize| scaled(&p[(k % channels) * sample..][..sample]);
        [value(0), value(1), value(2), 255]
    });
    Plane::from_rows(width, height, pixels.collect())
        .ok_or_else(|| bad(at, "the file ends before the last row"))
}

/// The next decimal number of the header, behind white space and comments.
fn read_number(bytes: &[u8], at: &mut usize) -> Option<u32> {
    loop {
        match bytes.get(*at)? {
            b'#' => {
                while *bytes.get(*at)? != b'\n' {
                    *at += 1
                }
            }
            b if b.is_ascii_whitespace() => *at += 1,
            _ => break,
        }
    }
    let digits = bytes[*at..].iter().take_while(|b| b.is_ascii_digit()).count();
    let text = std::str::from_utf8(&bytes[*at..*at + digits]).ok()?;
    *at += digits;
    text.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_comes_back() {
        let picture = Plane::from_rows(2, 1, vec![[1, 2, 3, 255], [254, 255, 0, 255]]).unwrap();
        let file = ppm(&picture).unwrap();
        assert_eq!(file, b"P6\n2 1\n255\n\x01\x02\x03\xfe\xff\0");
        assert_eq!(decode(&file, "a.ppm").unwrap(), picture);
        for cut in 2..file.len() {
            assert!(decode(&file[..cut], "a.ppm").is_err(), "cut at {cut}");
        }
    }

    #[test]
    fn comments_grey_and_wide_samples() {
        let read = |b: &[u8]| decode(b, "a.pgm").unwrap().into_data();
        assert_eq!(read(b"P5 # grey\n# more\n2 1 15\n\x0f\x03"), [[255; 4], [51, 51, 51, 255]]);
        assert_eq!(read(b"P6 1 1 65535\n\xff\xff\x80\x80\0\0"), [[255, 128, 0, 255]]);
        assert!(decode(b"P6 99999 1 255\n", "a.ppm").is_err());
    }
}
