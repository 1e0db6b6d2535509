//! JPEG out: 8-bit RGB, baseline.
//!
//! Source: \[JPEG\]; the coder is the `image` crate's.

use super::pixels::check_sides;
use crate::Error;
use vitral_frame::Plane;

/// Writes an sRGB picture. `quality` is 1 (small) to 100 (good); 90 is a usual choice. JPEG knows
/// no transparency: transparent pixels let a white page through.
///
/// # Errors
/// [`Error::Encode`] if the picture has no pixels or more than 65535 a side, if `quality` is out of
/// range, or if the feature `images` is left out.
pub fn jpeg(picture: &Plane<[u8; 4]>, quality: u8) -> Result<Vec<u8>, Error> {
    check_sides(picture.width(), picture.height(), 65_535, "JPEG")?;
    if !(1..=100).contains(&quality) {
        return Err(Error::Encode {
            what: format!("JPEG quality {quality}, 1 to 100 are possible"),
        });
    }
    code(picture, quality)
}

#[cfg(feature = "images")]
fn code(picture: &Plane<[u8; 4]>, quality: u8) -> Result<Vec<u8>, Error> {
    let mut out = Vec::new();
    let rgb = super::pixels::over_white(picture);
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut out, quality)
        .encode(&rgb, picture.width(), picture.height(), image::ExtendedColorType::Rgb8)
        .map_err(|e| Error::Encode { what: format!("JPEG: {e}") })?;
    Ok(out)
}

/// Refuses: the coder is not part of this build.
#[cfg(not(feature = "images"))]
fn code(_: &Plane<[u8; 4]>, _: u8) -> Result<Vec<u8>, Error> {
    Err(Error::Encode { what: crate::format::left_out("JPEG", "images") })
}

#[cfg(all(test, feature = "images"))]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back_roughly() {
        let picture = Plane::filled(16, 9, [200, 100, 50, 255]);
        let back = crate::image::decode(&jpeg(&picture, 90).unwrap(), "a.jpg").unwrap();
        assert_eq!((back.width(), back.height()), (16, 9));
        for p in back.data() {
            assert!(p.iter().zip([200, 100, 50, 255]).all(|(&a, b)| a.abs_diff(b) <= 3), "{p:?}");
        }
        assert!(jpeg(&picture, 0).is_err() && jpeg(&Plane::default(), 90).is_err());
    }
}
