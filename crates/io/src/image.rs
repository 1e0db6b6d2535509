//! Images in: PNG, JPEG, TGA, BMP, GIF, WebP, TIFF and DDS, known by their content, as 8-bit RGBA
//! with straight alpha.
//!
//! In:   the bytes of a file. Out: a plane, the top row first. PNG: every colour type, 16 bits
//! reduced to 8, transparency chunks and interlacing. JPEG: grey, RGB and CMYK, baseline and
//! progressive. GIF, WebP and TIFF: the first picture. DDS: the largest level of what S3TC packs
//! (DXT1, DXT3, DXT5).
//! Cost: that of the decoder, linear in bytes and pixels. The header's size is checked before
//!       anything is allocated.

#[cfg(feature = "images")]
mod codecs;
mod radiance;

pub use radiance::decode_radiance;

use crate::{Error, Place};
use std::io::Cursor;
use vitral_frame::Plane;

/// Most pixels along a side.
pub const MAX_SIDE: u32 = 16_384;
/// Most pixels in all.
pub const MAX_PIXELS: u64 = 1 << 28;
/// Bytes that a decoder may take besides its output.
const DECODER_MEMORY: usize = 64 << 20;

/// What is read, for messages about other formats.
const READ: &str = if cfg!(feature = "images") {
    "PNG, JPEG, TGA, BMP, GIF, WebP, TIFF and DDS are"
} else {
    "PNG is"
};

/// Decodes a picture. `file` is its name, for messages.
///
/// # Errors
/// Formats that are known but not read are [`Error::Unsupported`], damaged files
/// [`Error::Malformed`].
pub fn decode(bytes: &[u8], file: &str) -> Result<Plane<[u8; 4]>, Error> {
    whole(bytes, file)?;
    decode_else(bytes, file, READ)
}

/// [`decode`] for textures: a JPEG that is cut off is shown as far as it goes; the message says so.
pub(crate) fn decode_texture(
    bytes: &[u8],
    file: &str,
) -> Result<(Plane<[u8; 4]>, Option<String>), Error> {
    let plane = decode_else(bytes, file, READ)?;
    Ok((plane, whole(bytes, file).err().map(|e| e.to_string())))
}

/// Refuses a JPEG without its end, which decoders fill up with grey.
pub(crate) fn whole(bytes: &[u8], file: &str) -> Result<(), Error> {
    if bytes.starts_with(&[0xff, 0xd8, 0xff]) && !has_jpeg_end(bytes) {
        let place = Place::Byte(bytes.len() as u64);
        return Err(Error::malformed(file, place, "JPEG: the file ends before the image does"));
    }
    Ok(())
}

/// Whether a JPEG's markers lead to the end of an image: segments by their lengths, the data of
/// scans byte by byte.
fn has_jpeg_end(bytes: &[u8]) -> bool {
    let mut at = 2;
    while let Some(found) =
        bytes.get(at..).and_then(|rest| rest.windows(2).position(is_jpeg_marker))
    {
        at += found + 2;
        match bytes[at - 1] {
            0xd9 => return true,
            0x01 | 0xd8 => {}
            _ => match bytes.get(at..at + 2) {
                Some(length) => {
                    at += usize::from(u16::from_be_bytes([length[0], length[1]])).max(2)
                }
                None => return false,
            },
        }
    }
    false
}

/// A marker, and neither a stuffed byte, nor filling, nor a restart within a scan.
fn is_jpeg_marker(pair: &[u8]) -> bool {
    pair[0] == 0xff && !matches!(pair[1], 0x00 | 0xd0..=0xd7 | 0xff)
}

/// [`decode`]; `readable` is what the message about another format says in its place.
pub(crate) fn decode_else(
    bytes: &[u8],
    file: &str,
    readable: &str,
) -> Result<Plane<[u8; 4]>, Error> {
    let unsupported = |what: &str| Error::Unsupported {
        file: file.to_owned(),
        what: format!("{what} is not read; {readable}"),
    };
    match bytes {
        [] => Err(Error::malformed(file, Place::File, "empty file")),
        [0x89, b'P', b'N', b'G', ..] => decode_png(bytes, file),
        [0xab, b'K', b'T', b'X', ..] => Err(unsupported("KTX")),
        _ => match Codec::detect(bytes) {
            Some(codec) => decode_coded(codec, bytes, file),
            None => Err(unsupported("this image format")),
        },
    }
}

/// A format besides PNG, decoded by the feature `images`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Codec {
    Jpeg,
    Gif,
    WebP,
    Dds,
    Bmp,
    Tiff,
    Tga,
}

impl Codec {
    /// The format of `bytes`, by their first ones.
    fn detect(bytes: &[u8]) -> Option<Self> {
        match bytes {
            [0xff, 0xd8, 0xff, ..] => Some(Self::Jpeg),
            [b'G', b'I', b'F', b'8', ..] => Some(Self::Gif),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some(Self::WebP),
            [b'D', b'D', b'S', b' ', ..] => Some(Self::Dds),
            [b'B', b'M', _, _, _, _, 0, 0, 0, 0, ..] => Some(Self::Bmp),
            [b'I', b'I', 42, 0, ..] | [b'M', b'M', 0, 42, ..] => Some(Self::Tiff),
            _ if has_tga_header(bytes) => Some(Self::Tga),
            _ => None,
        }
    }

    /// Its name, for messages.
    fn name(self) -> &'static str {
        match self {
            Self::Jpeg => "JPEG",
            Self::Gif => "GIF",
            Self::WebP => "WebP",
            Self::Dds => "DDS",
            Self::Bmp => "BMP",
            Self::Tiff => "TIFF",
            Self::Tga => "TGA",
        }
    }
}

#[cfg(feature = "images")]
use codecs::decode as decode_coded;

/// Refuses the format: its decoder is not part of this build.
#[cfg(not(feature = "images"))]
fn decode_coded(codec: Codec, _: &[u8], file: &str) -> Result<Plane<[u8; 4]>, Error> {
    let what = crate::format::left_out(codec.name(), "images");
    Err(Error::Unsupported { file: file.to_owned(), what })
}

/// A TGA has no magic number: look at its colour map type, image type and depth.
fn has_tga_header(bytes: &[u8]) -> bool {
    matches!(bytes, [_, 0 | 1, 1 | 2 | 3 | 9 | 10 | 11, ..])
        && matches!(bytes.get(16), Some(8 | 15 | 16 | 24 | 32))
}

/// Refuses pictures beyond the limits.
pub(crate) fn check_size(width: u32, height: u32, file: &str) -> Result<(), Error> {
    let fits = width <= MAX_SIDE
        && height <= MAX_SIDE
        && u64::from(width) * u64::from(height) <= MAX_PIXELS;
    if width == 0 || height == 0 || !fits {
        let what = format!(
            "{width} x {height} pixels; 1 to {MAX_SIDE} a side and {MAX_PIXELS} in all are read"
        );
        return Err(Error::malformed(file, Place::File, what));
    }
    Ok(())
}

/// The plane of RGBA bytes that a decoder gave.
fn plane(width: u32, height: u32, rgba: Vec<[u8; 4]>, file: &str) -> Result<Plane<[u8; 4]>, Error> {
    Plane::from_rows(width, height, rgba)
        .ok_or_else(|| Error::malformed(file, Place::File, "the image ends before its last row"))
}

fn decode_png(bytes: &[u8], file: &str) -> Result<Plane<[u8; 4]>, Error> {
    let bad = |e: png::DecodingError| Error::malformed(file, Place::File, format!("PNG: {e}"));
    let mut decoder =
        png::Decoder::new_with_limits(Cursor::new(bytes), png::Limits { bytes: DECODER_MEMORY });
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info().map_err(bad)?;
    let (width, height) = (header.width, header.height);
    check_size(width, height, file)?;
    let mut reader = decoder.read_info().map_err(bad)?;
    let size = reader
        .output_buffer_size()
        .ok_or_else(|| Error::malformed(file, Place::File, "PNG: too large"))?;
    let mut data = vec![0; size];
    let info = reader.next_frame(&mut data).map_err(bad)?;
    data.truncate(info.buffer_size());
    let rgba = match info.color_type {
        png::ColorType::Grayscale => data.iter().map(|&l| [l, l, l, 255]).collect(),
        png::ColorType::GrayscaleAlpha => {
            data.as_chunks().0.iter().map(|&[l, a]| [l, l, l, a]).collect()
        }
        png::ColorType::Rgb => data.as_chunks().0.iter().map(|&[r, g, b]| [r, g, b, 255]).collect(),
        png::ColorType::Rgba => rgba_from_bytes(data),
        png::ColorType::Indexed => {
            return Err(Error::malformed(file, Place::File, "PNG: palette without entries"));
        }
    };
    plane(width, height, rgba, file)
}

/// The channels of a PNG file of 16 bits a channel; `None` for anything else, damaged files among
/// it.
pub fn decode_deep(bytes: &[u8]) -> Option<Plane<[u16; 4]>> {
    let mut decoder =
        png::Decoder::new_with_limits(Cursor::new(bytes), png::Limits { bytes: DECODER_MEMORY });
    let header = decoder.read_header_info().ok()?;
    let (width, height, color) = (header.width, header.height, header.color_type);
    check_size(width, height, "").ok()?;
    let mut reader =
        decoder.read_info().ok().filter(|r| r.info().bit_depth == png::BitDepth::Sixteen)?;
    let mut data = vec![0; reader.output_buffer_size()?];
    let info = reader.next_frame(&mut data).ok()?;
    data.truncate(info.buffer_size());
    let values: Vec<u16> =
        data.as_chunks().0.iter().map(|&pair| u16::from_be_bytes(pair)).collect();
    const OPAQUE: u16 = u16::MAX;
    let rgba = match color {
        png::ColorType::Grayscale => values.iter().map(|&l| [l, l, l, OPAQUE]).collect(),
        png::ColorType::GrayscaleAlpha => {
            values.as_chunks().0.iter().map(|&[l, a]| [l, l, l, a]).collect()
        }
        png::ColorType::Rgb => {
            values.as_chunks().0.iter().map(|&[r, g, b]| [r, g, b, OPAQUE]).collect()
        }
        png::ColorType::Rgba => values.as_chunks().0.to_vec(),
        png::ColorType::Indexed => return None,
    };
    Plane::from_rows(width, height, rgba)
}

/// Groups bytes into pixels, without a copy where the allocation allows it.
fn rgba_from_bytes(bytes: Vec<u8>) -> Vec<[u8; 4]> {
    bytemuck::allocation::try_cast_vec(bytes)
        .unwrap_or_else(|(_, bytes)| bytes.as_chunks().0.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A PNG of the given kind from raw rows.
    fn png_of(
        color: png::ColorType,
        depth: png::BitDepth,
        width: u32,
        height: u32,
        data: &[u8],
        extra: impl Fn(&mut png::Encoder<'_, &mut Vec<u8>>),
    ) -> Vec<u8> {
        let mut out = Vec::new();
        let mut encoder = png::Encoder::new(&mut out, width, height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        extra(&mut encoder);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        out
    }

    #[test]
    fn every_png_colour_type() {
        use png::{BitDepth, ColorType};
        let read = |bytes: Vec<u8>| decode(&bytes, "a.png").unwrap().into_data();
        let none = |_: &mut png::Encoder<'_, &mut Vec<u8>>| {};
        assert_eq!(
            read(png_of(ColorType::Grayscale, BitDepth::One, 3, 1, &[0b1010_0000], none)),
            [[255; 4], [0, 0, 0, 255], [255; 4]]
        );
        assert_eq!(
            read(png_of(ColorType::Grayscale, BitDepth::Sixteen, 1, 1, &[0x80, 0xff], none)),
            [[128, 128, 128, 255]]
        );
        let deep = decode_deep(&png_of(
            ColorType::Grayscale,
            BitDepth::Sixteen,
            1,
            1,
            &[0x80, 0xfe],
            none,
        ));
        assert_eq!(deep.unwrap().into_data(), [[0x80fe, 0x80fe, 0x80fe, 0xffff]]);
        assert!(
            decode_deep(&png_of(ColorType::Rgb, BitDepth::Eight, 1, 1, &[1, 2, 3], none)).is_none()
        );
        assert_eq!(
            read(png_of(ColorType::GrayscaleAlpha, BitDepth::Eight, 1, 1, &[9, 7], none)),
            [[9, 9, 9, 7]]
        );
        assert_eq!(
            read(png_of(ColorType::Rgb, BitDepth::Eight, 1, 1, &[1, 2, 3], |e| e
                .set_trns(vec![0, 1, 0, 2, 0, 3]))),
            [[1, 2, 3, 0]]
        );
        assert_eq!(
            read(png_of(ColorType::Rgba, BitDepth::Sixteen, 1, 1, &[1, 0, 2, 0, 3, 0, 4, 0], none)),
            [[1, 2, 3, 4]]
        );
        let palette = |e: &mut png::Encoder<'_, &mut Vec<u8>>| {
            e.set_palette(vec![1, 2, 3, 4, 5, 6]);
            e.set_trns(vec![8]);
        };
        assert_eq!(
            read(png_of(ColorType::Indexed, BitDepth::Two, 2, 1, &[0b0001_0000], palette)),
            [[1, 2, 3, 8], [4, 5, 6, 255]]
        );
    }

    #[test]
    fn sizes_are_refused_before_they_are_allocated() {
        let mut bytes = png_of(png::ColorType::Grayscale, png::BitDepth::Eight, 1, 1, &[0], |_| {});
        bytes[16..20].copy_from_slice(&0x7fff_ffffu32.to_be_bytes());
        assert!(decode(&bytes, "a.png").is_err());
        assert!(
            check_size(16_384, 16_384, "x").is_ok()
                && check_size(16_385, 1, "x").is_err()
                && check_size(0, 1, "x").is_err()
        );
    }

    #[test]
    fn a_short_jpeg_is_no_large_picture() {
        let picture = Plane::filled(16, 16, [9, 9, 9, 255]);
        let mut bytes = crate::encode::jpeg(&picture, 90).unwrap();
        assert!(decode(&bytes, "a.jpg").is_ok());
        let frame = bytes.windows(2).position(|w| w == [0xff, 0xc0]).unwrap();
        bytes[frame + 5..frame + 9].copy_from_slice(&[0x40, 0, 0x40, 0]);
        let error = decode(&bytes, "a.jpg").unwrap_err().to_string();
        assert!(error.contains("16384 x 16384 pixels are announced"), "{error}");
    }

    #[test]
    fn a_jpeg_that_is_cut_off_is_told() {
        let picture =
            Plane::from_rows(16, 16, (0..256).map(|i| [(i * 37) as u8, i as u8, 9, 255]).collect())
                .unwrap();
        let bytes = crate::encode::jpeg(&picture, 90).unwrap();
        assert!(decode_texture(&bytes, "a.jpg").unwrap().1.is_none());
        assert!(
            decode_texture(&[&bytes[..], &[0; 9]].concat(), "a.jpg").unwrap().1.is_none(),
            "padding is harmless"
        );
        let cut = &bytes[..bytes.len() - 20];
        let message =
            format!("a.jpg: byte {}: JPEG: the file ends before the image does", cut.len());
        assert_eq!(decode_texture(cut, "a.jpg").unwrap().1.as_ref(), Some(&message));
        assert_eq!(decode(cut, "a.jpg").unwrap_err().to_string(), message);
    }

    /// The colours of a picture of three by two pixels.
    const SIX: [[u8; 4]; 6] = [
        [255, 0, 0, 255],
        [0, 255, 0, 128],
        [0, 0, 255, 255],
        [1, 2, 3, 255],
        [250, 128, 4, 0],
        [9, 8, 7, 255],
    ];

    fn of_hex(text: &str) -> Vec<u8> {
        (0..text.len() / 2)
            .map(|k| u8::from_str_radix(&text[2 * k..2 * k + 2], 16).unwrap())
            .collect()
    }

    #[test]
    fn pictures_of_old_programs_and_of_the_web() {
        let opaque = SIX.map(|[r, g, b, _]| [r, g, b, 255]);
        let tga =
            "000002000000000000000000030002002008030201ff0480fa00070809ff0000ffff00ff0080ff0000ff";
        let runs = "00000a00000000000000000003000200200802030201ff0480fa00070809ff020000ffff00ff0080ff0000ff";
        let bmp = "424d4e0000000000000036000000280000000300000002000000010018000000000018000000c40e0000c40e0000000000\
                   00000000000302010480fa0708090000000000ff00ff00ff0000000000";
        let webp = "524946464c000000574542505650384c400000002f024000102fa0a06d1ba69ff7508f8adab66d18c393ff7fd6e951d3b6\
                    01930efe7c7b9540d2c6e87bf207f0e3458ca9dedb5503810065ac58e68288fec77801";
        let gif = "47494638376103000200820000fa800400ff00090807010203ff00000000ff0000000000002c0000000003000200000809\
                   000904283000808080003b";
        let tiff = "49492a00080000000b0000010400010000000300000001010400010000000200000002010300040000009200000003\
                    010300010000000100000006010300010000000200000011010400010000009a000000150103000100000004000000\
                    1601040001000000020000001701040001000000180000001c01030001000000010000005201030001000000020000\
                    00000000000800080008000800ff0000ff00ff00800000ffff010203fffa800400090807ff";
        let lzw = "49492a0022000000803fc00008140901037fbfc020201bfdf48002000120803bfe020b000001030001000000030000\
                    000101030001000000020000000201030004000000ac00000003010300010000000500000006010300010000000200\
                    000011010400010000000800000015010300010000000400000016010300010000000200000017010400010000001a\
                    0000001c0103000100000001000000520103000100000002000000000000000800080008000800";
        let files = [
            (tga, SIX),
            (runs, SIX),
            (bmp, opaque),
            (webp, SIX),
            (gif, opaque),
            (tiff, SIX),
            (lzw, SIX),
        ];
        for (number, (file, colors)) in files.into_iter().enumerate() {
            let bytes = of_hex(file);
            let picture = decode(&bytes, "a").unwrap();
            assert_eq!((picture.width(), picture.height()), (3, 2), "file {number}");
            assert_eq!(picture.into_data(), colors, "file {number}");
            // GIF and WebP pictures may end with bytes that nobody needs.
            for end in 0..bytes.len() * 2 / 3 {
                assert!(decode(&bytes[..end], "a").is_err(), "file {number} cut at {end}");
            }
        }
        let mut large = of_hex(gif);
        large[6..10].copy_from_slice(&[0, 0x40, 0, 0x40]);
        let error = decode(&large, "a.gif").unwrap_err().to_string();
        assert!(
            error.contains("16384 x 16384 pixels are announced, the file has 60 bytes"),
            "{error}"
        );
        let grey = of_hex("00000300000000000000000002000100080007c8");
        assert_eq!(decode(&grey, "a").unwrap().into_data(), [[7, 7, 7, 255], [200, 200, 200, 255]]);
    }

    #[test]
    fn packed_blocks_of_dds() {
        // Four by four pixels: red and blue are the ends, the rows below each other are red, blue
        // and the mixtures between.
        let header = |packing: &[u8; 4]| {
            let numbers = [124u32, 0x0008_1007, 4, 4, 8, 0, 0];
            let mut bytes = [
                b"DDS ".to_vec(),
                numbers.iter().flat_map(|n| n.to_le_bytes()).collect(),
                vec![0; 44],
            ]
            .concat();
            bytes.extend([32u32, 4].iter().flat_map(|n| n.to_le_bytes()));
            bytes.extend(packing);
            bytes.resize(128, 0);
            bytes[109] = 0x10;
            bytes
        };
        let block = [0x00, 0xf8, 0x1f, 0x00, 0b0000_0000, 0b0101_0101, 0b1010_1010, 0b1111_1111];
        let rows = [[255, 0, 0], [0, 0, 255], [170, 0, 85], [85, 0, 170]];
        let dxt1 = [header(b"DXT1"), block.to_vec()].concat();
        let picture = decode(&dxt1, "a.dds").unwrap();
        for (at, &[r, g, b, a]) in picture.data().iter().enumerate() {
            assert_eq!(([r, g, b], a), (rows[at / 4], 255), "pixel {at}");
        }
        let dxt3 =
            [header(b"DXT3"), vec![0xf0, 0xf0, 0, 0, 0x88, 0x88, 0xff, 0xff], block.to_vec()]
                .concat();
        let picture = decode(&dxt3, "a.dds").unwrap();
        assert_eq!(picture.data()[..2], [[255, 0, 0, 0], [255, 0, 0, 255]]);
        assert_eq!((picture.data()[4], picture.data()[8]), ([0, 0, 255, 0], [170, 0, 85, 136]));
        let other =
            decode(&[header(b"DX9!"), block.to_vec()].concat(), "a.dds").unwrap_err().to_string();
        assert!(other.starts_with("a.dds: DDS: "), "{other}");
        assert!(decode(&dxt1[..dxt1.len() - 1], "a.dds").is_err());
    }

    #[test]
    fn damage_is_an_error_and_strange_formats_are_named() {
        let good = png_of(png::ColorType::Rgb, png::BitDepth::Eight, 4, 4, &[7; 48], |_| {});
        for cut in 0..good.len() - 12 {
            assert!(decode(&good[..cut], "a.png").is_err(), "cut at {cut}");
        }
        assert!(
            decode(b"\xabKTX 20", "a.ktx2")
                .unwrap_err()
                .to_string()
                .contains("KTX is not read; PNG, JPEG, TGA")
        );
        assert!(decode(b"II*\0", "a.tif").unwrap_err().to_string().starts_with("a.tif: TIFF: "));
        assert!(decode(b"\xff\xd8\xff\xe0junk", "a.jpg").is_err());
    }
}
