//! What the writers ask of a picture: sides that the format can say, and colours without
//! transparency.

use crate::Error;
use vitral_frame::Plane;
use vitral_math::color;

/// Refuses pictures without pixels or with sides longer than a format can say.
pub(super) fn check_sides(
    width: u32,
    height: u32,
    longest: u32,
    format: &str,
) -> Result<(), Error> {
    if width == 0 || height == 0 || width > longest || height > longest {
        let what = format!("a {format} has 1 to {longest} pixels a side, not {width} x {height}");
        return Err(Error::Encode { what });
    }
    Ok(())
}

/// The RGB bytes of a picture; transparent ones let a white page through, mixed in linear
/// light.
pub(super) fn over_white(picture: &Plane<[u8; 4]>) -> Vec<u8> {
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
        let picture =
            Plane::from_rows(3, 1, vec![[1, 2, 3, 255], [1, 2, 3, 0], [0, 0, 0, 128]]).unwrap();
        let rgb = over_white(&picture);
        assert_eq!(rgb[..6], [1, 2, 3, 255, 255, 255]);
        assert_eq!(rgb[6..], [187; 3], "half the light is the sRGB byte 187 or 188");
    }
}
