//! From the client's pixels to colours, depths and stencil values, with pixel transfer.

use super::PIXELS_A_JOB;
use super::format::{Content, PixelFormat, float_from_half};
use super::store::ClientImage;
use super::transfer::{Transfer, clamp_unit};
use crate::enums::*;
use std::borrow::Cow;
use std::ops::Range;
use vitral_exec::Workers;

/// Pixels that are converted at once.
const CHUNK: usize = 1024;

/// Appends each number of `bytes` as a float: integers become 0..=1 or -1..=1.
pub(crate) fn numbers(bytes: &[u8], kind: u32, out: &mut Vec<f32>) {
    let two = |b: &[u8]| [b[0], b[1]];
    let four = |b: &[u8]| [b[0], b[1], b[2], b[3]];
    match kind {
        UNSIGNED_BYTE | BITMAP => out.extend(bytes.iter().map(|&b| f32::from(b) / 255.0)),
        BYTE => out.extend(bytes.iter().map(|&b| (2.0 * f32::from(b as i8) + 1.0) / 255.0)),
        UNSIGNED_SHORT => out
            .extend(bytes.chunks_exact(2).map(|b| f32::from(u16::from_ne_bytes(two(b))) / 65535.0)),
        SHORT => out.extend(
            bytes
                .chunks_exact(2)
                .map(|b| (2.0 * f32::from(i16::from_ne_bytes(two(b))) + 1.0) / 65535.0),
        ),
        HALF_FLOAT_ARB => {
            out.extend(bytes.chunks_exact(2).map(|b| float_from_half(u16::from_ne_bytes(two(b)))))
        }
        UNSIGNED_INT => out.extend(
            bytes
                .chunks_exact(4)
                .map(|b| (f64::from(u32::from_ne_bytes(four(b))) / f64::from(u32::MAX)) as f32),
        ),
        INT => out.extend(bytes.chunks_exact(4).map(|b| {
            ((2.0 * f64::from(i32::from_ne_bytes(four(b))) + 1.0) / f64::from(u32::MAX)) as f32
        })),
        _ => out.extend(bytes.chunks_exact(4).map(|b| f32::from_ne_bytes(four(b)))),
    }
}

/// The element of a packed type.
fn element(bytes: &[u8]) -> u32 {
    match *bytes {
        [a] => u32::from(a),
        [a, b] => u32::from(u16::from_ne_bytes([a, b])),
        [a, b, c, d] => u32::from_ne_bytes([a, b, c, d]),
        _ => 0,
    }
}

/// Colours of pixels of a colour format, before transfer.
fn chunk_colors(
    bytes: &[u8],
    format: PixelFormat,
    scratch: &mut Vec<f32>,
    out: &mut Vec<[f32; 4]>,
) {
    scratch.clear();

    // Copy four floats a pixel as they are.
    if (format.format, format.kind) == (RGBA, FLOAT) {
        numbers(bytes, FLOAT, scratch);
        return out.extend(scratch.as_chunks().0);
    }

    // Unpack the components to numbers.
    match format.packed() {
        Some(packed) => {
            for pixel in bytes.chunks_exact(packed.bytes) {
                let element = element(pixel);
                scratch.extend(packed.fields.iter().map(|&(shift, width)| {
                    let largest = (1u32 << width) - 1;
                    ((element >> shift) & largest) as f32 / largest as f32
                }));
            }
        }
        None => numbers(bytes, format.kind, scratch),
    }
    // The usual ones by themselves: components whose places are known are moved together.
    match *format.places() {
        _ if format.format == LUMINANCE => out.extend(scratch.iter().map(|&l| [l, l, l, 1.0])),
        _ if format.format == LUMINANCE_ALPHA => {
            out.extend(pixels::<2>(scratch).map(|[l, a]| [l, l, l, a]))
        }
        [0, 1, 2, 3] => out.extend(pixels::<4>(scratch)),
        [2, 1, 0, 3] => out.extend(pixels::<4>(scratch).map(|[b, g, r, a]| [r, g, b, a])),
        [0, 1, 2] => out.extend(pixels::<3>(scratch).map(|[r, g, b]| [r, g, b, 1.0])),
        [2, 1, 0] => out.extend(pixels::<3>(scratch).map(|[b, g, r]| [r, g, b, 1.0])),
        [0] => out.extend(scratch.iter().map(|&r| [r, 0.0, 0.0, 1.0])),
        ref places => {
            for pixel in scratch.chunks_exact(places.len()) {
                let mut color = [0.0, 0.0, 0.0, 1.0];
                for (&place, &value) in places.iter().zip(pixel) {
                    color[place] = value;
                }
                out.push(color);
            }
        }
    }
}

/// The numbers of each pixel.
fn pixels<const N: usize>(numbers: &[f32]) -> impl Iterator<Item = [f32; N]> + '_ {
    numbers.as_chunks().0.iter().copied()
}

/// The integers of index pixels; floating-point ones are rounded down.
fn indices(bytes: &[u8], kind: u32) -> Vec<i64> {
    let two = |b: &[u8]| [b[0], b[1]];
    let four = |b: &[u8]| [b[0], b[1], b[2], b[3]];
    match kind {
        UNSIGNED_BYTE | BITMAP => bytes.iter().map(|&b| i64::from(b)).collect(),
        BYTE => bytes.iter().map(|&b| i64::from(b as i8)).collect(),
        UNSIGNED_SHORT => {
            bytes.chunks_exact(2).map(|b| i64::from(u16::from_ne_bytes(two(b)))).collect()
        }
        SHORT => bytes.chunks_exact(2).map(|b| i64::from(i16::from_ne_bytes(two(b)))).collect(),
        UNSIGNED_INT => {
            bytes.chunks_exact(4).map(|b| i64::from(u32::from_ne_bytes(four(b)))).collect()
        }
        INT => bytes.chunks_exact(4).map(|b| i64::from(i32::from_ne_bytes(four(b)))).collect(),
        HALF_FLOAT_ARB => bytes
            .chunks_exact(2)
            .map(|b| float_from_half(u16::from_ne_bytes(two(b))).floor() as i64)
            .collect(),
        _ => bytes.chunks_exact(4).map(|b| f32::from_ne_bytes(four(b)).floor() as i64).collect(),
    }
}

/// What `make` makes of the RGBA colours of pixels after transfer, not clamped, some at a time.
/// Indices go through the maps.
pub(crate) fn from_colors<T: Copy + Default + Send>(
    workers: &Workers,
    image: &ClientImage,
    transfer: &Transfer<'_>,
    make: impl Fn(&[[f32; 4]], &mut [T]) + Sync + Send,
) -> Vec<T> {
    let mut out = vec![T::default(); image.bytes.len() / image.format.pixel_bytes()];
    workers.for_each_chunk(&mut out, PIXELS_A_JOB, |job, out| {
        let mut rest = out;
        each_colors(
            image,
            transfer,
            job * PIXELS_A_JOB..job * PIXELS_A_JOB + rest.len(),
            &mut |colors| {
                let (mine, behind) = std::mem::take(&mut rest).split_at_mut(colors.len());
                make(colors, mine);
                rest = behind;
            },
        );
    });
    out
}

/// Hands the colours of pixels to `take`, some at a time.
fn each_colors(
    image: &ClientImage,
    transfer: &Transfer<'_>,
    pixels: Range<usize>,
    take: &mut dyn FnMut(&[[f32; 4]]),
) {
    let pixel = image.format.pixel_bytes();
    let (mut scratch, mut colors) = (Vec::new(), Vec::new());
    for chunk in image.bytes[pixels.start * pixel..pixels.end * pixel].chunks(CHUNK * pixel) {
        colors.clear();
        if image.format.content() == Content::Index {
            colors.extend(
                indices(chunk, image.format.kind).into_iter().map(|i| transfer.color_of_index(i)),
            );
        } else {
            chunk_colors(chunk, image.format, &mut scratch, &mut colors);
            transfer.colors(&mut colors);
        }
        take(&colors);
    }
}

/// The colours of [`from_colors`] themselves.
pub(crate) fn colors(
    workers: &Workers,
    image: &ClientImage,
    transfer: &Transfer<'_>,
) -> Vec<[f32; 4]> {
    from_colors(workers, image, transfer, |colors, out| out.copy_from_slice(colors))
}

/// Depths after transfer. Clamped to 0..=1 if `clamp`.
pub(crate) fn depths(image: &ClientImage, transfer: &Transfer<'_>, clamp: bool) -> Vec<f32> {
    let four = |b: &[u8]| [b[0], b[1], b[2], b[3]];
    let mut out = Vec::new();
    match image.format.kind {
        UNSIGNED_INT_24_8 => out.extend(
            image
                .bytes
                .chunks_exact(4)
                .map(|b| (u32::from_ne_bytes(four(b)) >> 8) as f32 / ((1 << 24) - 1) as f32),
        ),
        FLOAT_32_UNSIGNED_INT_24_8_REV => {
            out.extend(image.bytes.chunks_exact(8).map(|b| f32::from_ne_bytes(four(b))));
        }
        kind => numbers(&image.bytes, kind, &mut out),
    }
    transfer.depths(&mut out);
    if clamp {
        for depth in &mut out {
            *depth = clamp_unit(*depth);
        }
    }
    out
}

/// Stencil values after transfer, masked to 8 bits.
pub(crate) fn stencils(image: &ClientImage, transfer: &Transfer<'_>) -> Vec<u8> {
    let four = |b: &[u8]| [b[0], b[1], b[2], b[3]];
    let masked = |index: i64| (transfer.stencil(index) & 255) as u8;
    match image.format.kind {
        UNSIGNED_INT_24_8 => image
            .bytes
            .chunks_exact(4)
            .map(|b| masked(i64::from(u32::from_ne_bytes(four(b)) & 255)))
            .collect(),
        FLOAT_32_UNSIGNED_INT_24_8_REV => image
            .bytes
            .chunks_exact(8)
            .map(|b| masked(i64::from(u32::from_ne_bytes(four(&b[4..])) & 255)))
            .collect(),
        kind => indices(&image.bytes, kind).into_iter().map(masked).collect(),
    }
}

/// Colours as RGBA words (red lowest), without transfer, of the usual formats; the image is given
/// back if it is of another. Pixels that are such words but for the order of red and blue stay in
/// the image's own memory.
pub(crate) fn words(image: Cow<'_, ClientImage>) -> Result<Vec<u32>, Cow<'_, ClientImage>> {
    let PixelFormat { format, kind } = image.format;
    let whole = matches!(kind, UNSIGNED_INT_8_8_8_8 | UNSIGNED_INT_8_8_8_8_REV);

    // Take words of four bytes over, in the order red, green, blue, alpha.
    if matches!(format, RGBA | BGRA) && (whole || kind == UNSIGNED_BYTE) {
        let mut words = image.into_owned().bytes.into_words();
        if kind == UNSIGNED_INT_8_8_8_8 || kind == UNSIGNED_BYTE && cfg!(target_endian = "big") {
            words.iter_mut().for_each(|w| *w = w.swap_bytes());
        }
        if format == BGRA {
            words
                .iter_mut()
                .for_each(|w| *w = *w & 0xff00_ff00 | *w >> 16 & 255 | (*w & 255) << 16);
        }
        return Ok(words);
    }
    let bytes = &image.bytes;
    let word = |r, g, b, a| u32::from_le_bytes([r, g, b, a]);

    // Expand five and six bits by tables.
    if (format, kind) == (RGB, UNSIGNED_SHORT_5_6_5) {
        let byte =
            |bits: u16, largest: u16| ((f32::from(bits) / f32::from(largest)) * 255.0 + 0.5) as u8;
        let fives: [u8; 32] = std::array::from_fn(|bits| byte(bits as u16, 31));
        let sixes: [u8; 64] = std::array::from_fn(|bits| byte(bits as u16, 63));
        let pixel = |[a, b]: &[u8; 2]| {
            let p = usize::from(u16::from_ne_bytes([*a, *b]));
            word(fives[p >> 11 & 31], sixes[p >> 5 & 63], fives[p & 31], 255)
        };
        return Ok(bytes.as_chunks().0.iter().map(pixel).collect());
    }

    // Expand the formats of bytes.
    if kind != UNSIGNED_BYTE {
        return Err(image);
    }
    Ok(match format {
        RGB => bytes.chunks_exact(3).map(|p| word(p[0], p[1], p[2], 255)).collect(),
        BGR => bytes.chunks_exact(3).map(|p| word(p[2], p[1], p[0], 255)).collect(),
        LUMINANCE => bytes.iter().map(|&l| word(l, l, l, 255)).collect(),
        LUMINANCE_ALPHA => bytes.chunks_exact(2).map(|p| word(p[0], p[0], p[0], p[1])).collect(),
        ALPHA => bytes.iter().map(|&a| word(0, 0, 0, a)).collect(),
        RED => bytes.iter().map(|&r| word(r, 0, 0, 255)).collect(),
        _ => return Err(image),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::PixelTransfer;

    fn image(format: u32, kind: u32, bytes: &[u8]) -> ClientImage {
        let format = PixelFormat::new(format, kind).unwrap();
        ClientImage {
            size: [bytes.len() / format.pixel_bytes(), 1, 1],
            bytes: bytes.into(),
            format,
        }
    }

    fn decoded(format: u32, kind: u32, bytes: &[u8]) -> Vec<[f32; 4]> {
        colors(
            &Workers::single(),
            &image(format, kind, bytes),
            &Transfer::new(&PixelTransfer::default()),
        )
    }

    #[test]
    fn formats_place_their_components() {
        assert_eq!(decoded(BGRA, UNSIGNED_BYTE, &[255, 0, 0, 0]), [[0.0, 0.0, 1.0, 0.0]]);
        assert_eq!(decoded(ABGR_EXT, UNSIGNED_BYTE, &[255, 0, 0, 0]), [[0.0, 0.0, 0.0, 1.0]]);
        assert_eq!(decoded(LUMINANCE_ALPHA, UNSIGNED_BYTE, &[255, 0]), [[1.0, 1.0, 1.0, 0.0]]);
        assert_eq!(decoded(GREEN, UNSIGNED_BYTE, &[255]), [[0.0, 1.0, 0.0, 1.0]]);
        assert_eq!(decoded(ALPHA, BYTE, &[127]), [[0.0, 0.0, 0.0, 1.0]]);
        assert_eq!(decoded(RED, INT, &i32::MIN.to_ne_bytes()), [[-1.0, 0.0, 0.0, 1.0]]);
    }

    #[test]
    fn packed_types_take_their_fields() {
        let red = 0xf800u16.to_ne_bytes();
        assert_eq!(decoded(RGB, UNSIGNED_SHORT_5_6_5, &red), [[1.0, 0.0, 0.0, 1.0]]);
        assert_eq!(decoded(RGB, UNSIGNED_SHORT_5_6_5_REV, &red), [[0.0, 0.0, 1.0, 1.0]]);
        assert_eq!(decoded(RGB, UNSIGNED_BYTE_3_3_2, &[0b0001_1100]), [[0.0, 1.0, 0.0, 1.0]]);
        let first = 0xff00_0000u32.to_ne_bytes();
        assert_eq!(decoded(BGRA, UNSIGNED_INT_8_8_8_8, &first), [[0.0, 0.0, 1.0, 0.0]]);
        let alpha = (3u32 << 30).to_ne_bytes();
        assert_eq!(decoded(RGBA, UNSIGNED_INT_2_10_10_10_REV, &alpha), [[0.0, 0.0, 0.0, 1.0]]);
    }

    #[test]
    fn depth_and_stencil_come_apart() {
        let state = PixelTransfer::default();
        let transfer = Transfer::new(&state);
        let pixel = image(DEPTH_STENCIL, UNSIGNED_INT_24_8, &0xffff_ff07u32.to_ne_bytes());
        assert_eq!(depths(&pixel, &transfer, true), [1.0]);
        assert_eq!(stencils(&pixel, &transfer), [7]);
        let mut bytes = 2.0f32.to_ne_bytes().to_vec();
        bytes.extend(9u32.to_ne_bytes());
        let pixel = image(DEPTH_STENCIL, FLOAT_32_UNSIGNED_INT_24_8_REV, &bytes);
        assert_eq!(depths(&pixel, &transfer, false), [2.0]);
        assert_eq!(depths(&pixel, &transfer, true), [1.0]);
        assert_eq!(stencils(&pixel, &transfer), [9]);
    }

    #[test]
    fn the_fast_way_agrees_with_the_general_one() {
        let bytes = [RGBA, BGRA, RGB, BGR, LUMINANCE, LUMINANCE_ALPHA, ALPHA, RED]
            .map(|format| (format, UNSIGNED_BYTE));
        let packed = [UNSIGNED_INT_8_8_8_8, UNSIGNED_INT_8_8_8_8_REV].iter();
        let packed = packed.flat_map(|&kind| [(RGBA, kind), (BGRA, kind)]);
        for (format, kind) in bytes.into_iter().chain(packed).chain([(RGB, UNSIGNED_SHORT_5_6_5)]) {
            // Of two bytes, all there are.
            let bytes: Vec<u8> = match kind {
                UNSIGNED_SHORT_5_6_5 => (0..=u16::MAX).flat_map(u16::to_ne_bytes).collect(),
                _ => (0..12).map(|i| i * 20).collect(),
            };
            let image = image(format, kind, &bytes);
            let state = PixelTransfer::default();
            let general: Vec<u32> = colors(&Workers::single(), &image, &Transfer::new(&state))
                .into_iter()
                .map(|c| u32::from_le_bytes(c.map(|v| (v * 255.0 + 0.5) as u8)))
                .collect();
            assert_eq!(words(Cow::Owned(image)).unwrap(), general, "{format:#x} {kind:#x}");
        }
        assert!(words(Cow::Owned(image(GREEN, UNSIGNED_BYTE, &[1, 2, 3]))).is_err());
        assert!(words(Cow::Owned(image(RGB, UNSIGNED_SHORT_5_6_5_REV, &[1, 2]))).is_err());
    }
}
