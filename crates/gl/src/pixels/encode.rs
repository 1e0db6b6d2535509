//! From colours, depths and stencil values to the client's pixels.

use super::format::{PixelFormat, half_from_float};
use super::transfer::clamp_unit;
use crate::enums::*;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{Level, Simd, U8x16, dispatch, orders_bytes};

/// A number in 0..=1 as an unsigned integer up to `largest`.
#[inline]
fn unsigned(value: f64, largest: f64) -> u32 {
    (value.clamp(0.0, 1.0) * largest + 0.5) as u32
}

/// A number in -1..=1 as a signed integer: (largest * c - 1) / 2.
#[inline]
fn signed(value: f64, largest: f64) -> i64 {
    let c = if value.is_nan() { 0.0 } else { value.clamp(-1.0, 1.0) };
    ((largest * c - 1.0) / 2.0 + 0.5).floor() as i64
}

/// The quotient that a number may have been, of 8 or 16 bits and their largest: integers of 32 bits
/// show how it was rounded.
fn quotient(value: f32) -> f64 {
    let quotient = (f64::from(value) * 65535.0).round() / 65535.0;
    if quotient as f32 == value { quotient } else { f64::from(value) }
}

/// The components at `places` of each colour, as `f` makes them bytes.
#[inline]
fn spread<const BYTES: usize>(
    colors: &[[f32; 4]],
    places: &[usize],
    out: &mut [u8],
    f: impl Fn(f32) -> [u8; BYTES],
) {
    // Places that the compiler knows need no look at each component.
    match *places {
        [0, 1, 2, 3] => place(colors, [0, 1, 2, 3], out, f),
        [2, 1, 0, 3] => place(colors, [2, 1, 0, 3], out, f),
        [0, 1, 2] => place(colors, [0, 1, 2], out, f),
        [first] => place(colors, [first], out, f),
        _ => {
            let pixels = out.chunks_exact_mut(places.len() * BYTES);
            for (bytes, color) in pixels.zip(colors) {
                for (bytes, &place) in bytes.chunks_exact_mut(BYTES).zip(places) {
                    bytes.copy_from_slice(&f(color[place & 3]));
                }
            }
        }
    }
}

#[inline]
fn place<const N: usize, const BYTES: usize>(
    colors: &[[f32; 4]],
    places: [usize; N],
    out: &mut [u8],
    f: impl Fn(f32) -> [u8; BYTES],
) {
    let components = out.as_chunks_mut::<BYTES>().0.as_chunks_mut::<N>().0;
    for (pixel, color) in components.iter_mut().zip(colors) {
        *pixel = places.map(|place| f(color[place & 3]));
    }
}

/// The components at `places` of each colour as numbers of type `kind`.
pub(crate) fn components(colors: &[[f32; 4]], places: &[usize], kind: u32, out: &mut [u8]) {
    const WHOLE: f64 = u32::MAX as f64;
    match kind {
        UNSIGNED_BYTE => spread(colors, places, out, |v| [(clamp_unit(v) * 255.0 + 0.5) as u8]),
        BYTE => spread(colors, places, out, |v| [signed(v.into(), 255.0) as i8 as u8]),
        UNSIGNED_SHORT => {
            spread(colors, places, out, |v| (unsigned(v.into(), 65535.0) as u16).to_ne_bytes())
        }
        SHORT => spread(colors, places, out, |v| (signed(v.into(), 65535.0) as i16).to_ne_bytes()),
        UNSIGNED_INT => spread(colors, places, out, |v| unsigned(quotient(v), WHOLE).to_ne_bytes()),
        INT => spread(colors, places, out, |v| (signed(quotient(v), WHOLE) as i32).to_ne_bytes()),
        HALF_FLOAT_ARB => spread(colors, places, out, |v| half_from_float(v).to_ne_bytes()),
        _ if *places == [0, 1, 2, 3] => out.copy_from_slice(bytemuck::cast_slice(colors)),
        _ => spread(colors, places, out, f32::to_ne_bytes),
    }
}

/// Pixels whose luminance is summed up at a time.
const SUMS: usize = 64;

/// Colours in a colour format. Luminance is the sum of red, green and blue; where these are
/// clamped, so is the sum.
pub(crate) fn colors(colors: &[[f32; 4]], format: PixelFormat, out: &mut [u8]) {
    // Sum up luminance, some pixels at a time.
    let places = format.places();
    if matches!(format.format, LUMINANCE | LUMINANCE_ALPHA) {
        let sum = |c: &[f32; 4]| {
            let (sum, clamped) =
                (c[0] + c[1] + c[2], c[..3].iter().all(|v| (0.0..=1.0).contains(v)));
            [if clamped { sum.min(1.0) } else { sum }, 0.0, 0.0, c[3]]
        };
        let mut sums = [[0.0; 4]; SUMS];
        for (colors, out) in colors.chunks(SUMS).zip(out.chunks_mut(SUMS * format.pixel_bytes())) {
            sums.iter_mut().zip(colors).for_each(|(s, c)| *s = sum(c));
            components(&sums[..colors.len()], places, format.kind, out);
        }
        return;
    }

    // Write unpacked components as they are, and pack the others to one element a pixel.
    let Some(packed) = format.packed() else { return components(colors, places, format.kind, out) };
    for (bytes, color) in out.chunks_exact_mut(packed.bytes).zip(colors) {
        let mut element = 0;
        for (&place, &(shift, width)) in places.iter().zip(packed.fields) {
            let largest = ((1u32 << width) - 1) as f32;
            element |= ((clamp_unit(color[place]) * largest + 0.5) as u32) << shift;
        }
        put(bytes, element);
    }
}

/// An integer of as many bytes as there are.
fn put(bytes: &mut [u8], element: u32) {
    match bytes {
        [byte] => *byte = element as u8,
        [_, _] => bytes.copy_from_slice(&(element as u16).to_ne_bytes()),
        _ => bytes.copy_from_slice(&element.to_ne_bytes()),
    }
}

/// Depths in format `DEPTH_COMPONENT`.
pub(crate) fn depths(depths: &[f32], format: PixelFormat, out: &mut [u8]) {
    const WHOLE: f64 = u32::MAX as f64;
    match format.kind {
        FLOAT => out.copy_from_slice(bytemuck::cast_slice(depths)),
        UNSIGNED_INT => {
            let numbers = out.as_chunks_mut().0.iter_mut().zip(depths);
            numbers.for_each(|(number, &depth)| {
                *number = unsigned(quotient(depth), WHOLE).to_ne_bytes()
            });
        }
        kind => {
            let numbers = out.chunks_exact_mut(format.pixel_bytes()).zip(depths);
            numbers.for_each(|(number, &depth)| {
                components(&[[depth, 0.0, 0.0, 0.0]], &[0], kind, number)
            });
        }
    }
}

/// Stencil values (after transfer) in format `STENCIL_INDEX`.
pub(crate) fn stencils(values: impl Iterator<Item = i64>, format: PixelFormat, out: &mut [u8]) {
    for (bytes, value) in out.chunks_exact_mut(format.pixel_bytes()).zip(values) {
        let number = match format.kind {
            BYTE => value & 0x7f,
            BITMAP => value & 1,
            SHORT => value & 0x7fff,
            INT => value & 0x7fff_ffff,
            HALF_FLOAT_ARB => i64::from(half_from_float(value as f32)),
            FLOAT => i64::from((value as f32).to_bits()),
            _ => value,
        };
        put(bytes, number as u32);
    }
}

/// Depth and stencil together.
pub(crate) fn depth_stencils(depths: &[f32], stencils: &[u8], kind: u32, out: &mut [u8]) {
    let values = depths.iter().zip(stencils);
    if kind == UNSIGNED_INT_24_8 {
        for (pixel, (&depth, &stencil)) in out.as_chunks_mut().0.iter_mut().zip(values) {
            let whole = (f64::from(clamp_unit(depth)) * 16_777_215.0 + 0.5) as u32;
            *pixel = ((whole << 8) | u32::from(stencil)).to_ne_bytes();
        }
    } else {
        for ([first, second], (&depth, &stencil)) in
            out.as_chunks_mut().0.as_chunks_mut().0.iter_mut().zip(values)
        {
            (*first, *second) = (depth.to_ne_bytes(), u32::from(stencil).to_ne_bytes());
        }
    }
}

/// Whether [`words`] makes pixels of a format.
pub(crate) fn takes_words(format: PixelFormat) -> bool {
    match format.kind {
        UNSIGNED_BYTE => {
            matches!(format.format, RGBA | BGRA | ABGR_EXT | RGB | BGR | RED | GREEN | BLUE | ALPHA)
        }
        UNSIGNED_INT_8_8_8_8 | UNSIGNED_INT_8_8_8_8_REV => matches!(format.format, RGBA | BGRA),
        _ => false,
    }
}

/// Words (red lowest) as pixels of a format that [`takes_words`].
pub(crate) fn words(words: &[u32], format: PixelFormat, out: &mut [u8]) {
    match format.pixel_bytes() {
        1 => {
            let shift = 8 * format.places()[0] as u32;
            out.iter_mut().zip(words).for_each(|(byte, word)| *byte = (word >> shift) as u8);
        }
        4 => {
            let bgra = |w: u32| w.swap_bytes().rotate_right(8);
            let whole = format.kind != UNSIGNED_BYTE;
            let reversed = format.format == ABGR_EXT || format.kind == UNSIGNED_INT_8_8_8_8;
            match (format.format == BGRA, reversed) {
                (false, false) => wholes(words, whole, out, |w| w),
                (true, false) => wholes(words, whole, out, bgra),
                (false, true) => wholes(words, whole, out, u32::swap_bytes),
                (true, true) => wholes(words, whole, out, |w| bgra(w).swap_bytes()),
            }
        }
        _ => threes(words, format, out),
    }
}

/// Pixels of four bytes: integers if `whole`, else bytes from the lowest one on.
#[inline(always)]
fn wholes(words: &[u32], whole: bool, out: &mut [u8], order: impl Fn(u32) -> u32) {
    for (pixel, &word) in out.as_chunks_mut().0.iter_mut().zip(words) {
        let word = order(word);
        *pixel = if whole { word } else { word.to_le() }.to_ne_bytes();
    }
}

/// Pixels of `RGB` or `BGR`.
fn threes(words: &[u32], format: PixelFormat, out: &mut [u8]) {
    let swapped = format.format == BGR;
    let level = Level::new();
    let done = if cfg!(target_endian = "little") && orders_bytes(level) {
        dispatch!(level, simd => triples(simd, words, swapped, out))
    } else {
        0
    };
    let (words, out) = (&words[done..], &mut out[3 * done..]);
    let order = |word: u32| if swapped { word.swap_bytes() >> 8 } else { word & 0x00ff_ffff };
    // Four pixels are three whole words.
    let mut quads = words.chunks_exact(4);
    let mut pixels = out.chunks_exact_mut(12);
    for (bytes, quad) in (&mut pixels).zip(&mut quads) {
        let [a, b, c, d] = [quad[0], quad[1], quad[2], quad[3]].map(order);
        bytes[..4].copy_from_slice(&(a | (b << 24)).to_le_bytes());
        bytes[4..8].copy_from_slice(&((b >> 8) | (c << 16)).to_le_bytes());
        bytes[8..].copy_from_slice(&((c >> 16) | (d << 8)).to_le_bytes());
    }
    let rest = pixels.into_remainder().chunks_exact_mut(3);
    for (bytes, &word) in rest.zip(quads.remainder()) {
        bytes.copy_from_slice(&order(word).to_le_bytes()[..3]);
    }
}

/// Three bytes of each word, the lowest first, or last if `swapped`: of the first so many pixels,
/// which it says.
#[inline(always)]
fn triples<S: Simd>(simd: S, words: &[u32], swapped: bool, out: &mut [u8]) -> usize {
    let order = if swapped {
        [2, 1, 0, 6, 5, 4, 10, 9, 8, 14, 13, 12, 3, 7, 11, 15]
    } else {
        [0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11, 15]
    };
    let order = U8x16::from_slice(simd, &order);
    let words: &[u8] = bytemuck::cast_slice(words);
    let mut done = 0;
    // Each time four bytes more are written, over which the next ones are.
    while let (Some(four), Some(bytes)) =
        (words.get(4 * done..4 * done + 16), out.get_mut(3 * done..3 * done + 16))
    {
        U8x16::from_slice(simd, four).swizzle_dyn(order).store_slice(bytes);
        done += 4;
    }
    done
}

#[cfg(test)]
mod tests {
    use super::*;

    fn format(format: u32, kind: u32) -> PixelFormat {
        PixelFormat::new(format, kind).unwrap()
    }

    fn encoded(color: [f32; 4], token: u32, kind: u32) -> Vec<u8> {
        let mut out = vec![0; format(token, kind).pixel_bytes()];
        colors(&[color], format(token, kind), &mut out);
        out
    }

    #[test]
    fn numbers_take_the_types_range() {
        assert_eq!(encoded([1.0, 0.0, 0.5, 0.0], RGB, UNSIGNED_BYTE), [255, 0, 128]);
        assert_eq!(encoded([1.0; 4], RED, BYTE), [127]);
        assert_eq!(encoded([0.0; 4], RED, SHORT), 0i16.to_ne_bytes());
        assert_eq!(encoded([-1.0; 4], RED, INT), i32::MIN.to_ne_bytes());
        assert_eq!(encoded([2.0; 4], RED, UNSIGNED_INT), u32::MAX.to_ne_bytes());
        assert_eq!(encoded([0.25, 0.5, 0.125, 1.0], LUMINANCE, FLOAT), 0.875f32.to_ne_bytes());
        assert_eq!(
            encoded([1.0, 0.0, 0.0, 0.0], RGB, UNSIGNED_SHORT_5_6_5),
            0xf800u16.to_ne_bytes()
        );
    }

    #[test]
    fn bytes_repeat_in_larger_integers() {
        for byte in 0..=255u8 {
            let color = [f32::from(byte) / 255.0; 4];
            let whole = u32::from_ne_bytes([byte; 4]);
            assert_eq!(encoded(color, RED, UNSIGNED_SHORT), [byte; 2]);
            assert_eq!(encoded(color, RED, UNSIGNED_INT), [byte; 4]);
            // (2^32 - 1) c - 1 is halved; halves may go either way.
            let found = i32::from_ne_bytes(encoded(color, RED, INT).try_into().unwrap());
            assert!((i64::from(found) * 2 + 1 - i64::from(whole)).abs() <= 1, "{byte}: {found}");
        }
    }

    #[test]
    fn words_become_what_colors_become() {
        let bytes = [RGBA, BGRA, ABGR_EXT, RGB, BGR, RED, GREEN, BLUE, ALPHA]
            .map(|token| (token, UNSIGNED_BYTE));
        let kinds = [UNSIGNED_INT_8_8_8_8, UNSIGNED_INT_8_8_8_8_REV];
        let wholes = kinds.iter().flat_map(|&kind| [(RGBA, kind), (BGRA, kind)]);
        let source = [0x0403_0201u32, 0xf3f2_f1f0, 0x00ff_8001];
        let pixels = source.map(|word| word.to_le_bytes().map(|byte| f32::from(byte) / 255.0));
        for (token, kind) in bytes.into_iter().chain(wholes) {
            let format = format(token, kind);
            assert!(takes_words(format));
            let [mut fast, mut general] = [(); 2].map(|()| vec![0; 3 * format.pixel_bytes()]);
            words(&source, format, &mut fast);
            colors(&pixels, format, &mut general);
            assert_eq!(fast, general, "{token:#x} {kind:#x}");
        }
        assert!(!takes_words(format(LUMINANCE, UNSIGNED_BYTE)) && !takes_words(format(RGB, BYTE)));
    }

    #[test]
    fn runs_of_rgb_are_tight() {
        for count in 0..40u8 {
            let source: Vec<u32> =
                (0..u32::from(count)).map(|i| 0xff00_0000 | (i * 0x0003_0201)).collect();
            let (mut forward, mut backward) =
                (vec![0; 3 * source.len()], vec![0; 3 * source.len()]);
            words(&source, format(RGB, UNSIGNED_BYTE), &mut forward);
            words(&source, format(BGR, UNSIGNED_BYTE), &mut backward);
            assert_eq!(forward, (0..count).flat_map(|i| [i, 2 * i, 3 * i]).collect::<Vec<_>>());
            assert_eq!(backward, (0..count).flat_map(|i| [3 * i, 2 * i, i]).collect::<Vec<_>>());
        }
    }

    #[test]
    fn depth_and_stencil_share_a_word() {
        let mut out = [0; 4];
        depth_stencils(&[1.0], &[5], UNSIGNED_INT_24_8, &mut out);
        assert_eq!(out, 0xffff_ff05u32.to_ne_bytes());
    }
}
