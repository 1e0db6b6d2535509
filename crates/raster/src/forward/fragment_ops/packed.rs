//! Pixels of four bytes in a word: to and from lanes, and blending of words without unpacking them.
//!
//! The word blends compute two components at a time in the 16-bit halves of a word. On sources of
//! whole bytes they give exactly what [`blend`](super::blend::blend) gives between [`unpack`] and
//! [`pack`]: the nearest byte to the exact result (a tie cannot happen, 255 being odd). A source
//! that is not whole bytes is rounded before instead of after.

use crate::forward::wide::{Rgba, saturate};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{Floats, Simd, U32x8};

/// Red and blue of a word, or green and alpha of a word shifted by 8.
const HALVES: u32 = 0x00ff_00ff;

/// The byte of each value, `0.0 -> 0`, `1.0 -> 255`, rounded to nearest and clamped; red in the
/// lowest byte.
#[inline(always)]
pub(crate) fn pack<S: Simd, V: Floats<S>>(color: &[V; 4]) -> V::Words {
    let r: V::Ints = (saturate(color[0]) * 255.0 + 0.5).to_int();
    let g: V::Ints = (saturate(color[1]) * 255.0 + 0.5).to_int();
    let b: V::Ints = (saturate(color[2]) * 255.0 + 0.5).to_int();
    let a: V::Ints = (saturate(color[3]) * 255.0 + 0.5).to_int();
    (r | (g << 8) | (b << 16) | (a << 24)).bitcast()
}

/// `byte / 255` of each component.
#[inline(always)]
pub(crate) fn unpack<S: Simd>(words: U32x8<S>) -> Rgba<S> {
    let [r, g, b, a]: Rgba<S> = unpack_bytes(words);
    [r / 255.0, g / 255.0, b / 255.0, a / 255.0]
}

/// The bytes as numbers of 0..=255.
#[inline(always)]
pub(crate) fn unpack_bytes<S: Simd, V: Floats<S>>(words: V::Words) -> [V; 4] {
    // Signed integers, because they are turned into floats in one instruction.
    let r: V::Ints = (words & 0xff).bitcast();
    let g: V::Ints = ((words >> 8) & 0xff).bitcast();
    let b: V::Ints = ((words >> 16) & 0xff).bitcast();
    let a: V::Ints = (words >> 24).bitcast();
    [r.to_float(), g.to_float(), b.to_float(), a.to_float()]
}

/// Blending with `ONE, ONE`: each byte of the sum stays at 255.
#[inline(always)]
pub(crate) fn add_packed<S: Simd, W: SimdInt<S, Element = u32>>(source: W, stored: W) -> W {
    let rb = add_halves(source & HALVES, stored & HALVES);
    let ga = add_halves((source >> 8) & HALVES, (stored >> 8) & HALVES);
    rb | (ga << 8)
}

/// [`add_packed`] of one word.
#[inline(always)]
pub(crate) fn add_words(source: u32, stored: u32) -> u32 {
    let add = |a: u32, b: u32| {
        let sum = a + b;
        let over = (sum >> 8) & 0x0001_0001;
        (sum | ((over << 8) - over)) & HALVES
    };
    add(source & HALVES, stored & HALVES) | add((source >> 8) & HALVES, (stored >> 8) & HALVES) << 8
}

/// Blending with `SRC_ALPHA, ONE`.
#[inline(always)]
pub(crate) fn add_scaled_packed<S: Simd, W: SimdInt<S, Element = u32>>(source: W, stored: W) -> W {
    let alpha = source >> 24;
    let rb = add_halves(divide_by_255((source & HALVES) * alpha), stored & HALVES);
    let ga = add_halves(divide_by_255(((source >> 8) & HALVES) * alpha), (stored >> 8) & HALVES);
    rb | (ga << 8)
}

/// Blending with `SRC_ALPHA, ONE_MINUS_SRC_ALPHA`.
#[inline(always)]
pub(crate) fn mix_packed<S: Simd, W: SimdInt<S, Element = u32>>(source: W, stored: W) -> W {
    let alpha = source >> 24;
    let rest = alpha ^ 255;
    let rb = divide_by_255((source & HALVES) * alpha + (stored & HALVES) * rest);
    let ga = divide_by_255(((source >> 8) & HALVES) * alpha + ((stored >> 8) & HALVES) * rest);
    rb | (ga << 8)
}

/// The sum of bytes in 16-bit halves, at most 255.
#[inline(always)]
fn add_halves<S: Simd, W: SimdInt<S, Element = u32>>(a: W, b: W) -> W {
    let sum = a + b;
    let over = (sum >> 8) & 0x0001_0001;
    (sum | ((over << 8) - over)) & HALVES
}

/// Each 16-bit half, of at most `255 * 255`, divided by 255 and rounded to nearest.
#[inline(always)]
fn divide_by_255<S: Simd, W: SimdInt<S, Element = u32>>(halves: W) -> W {
    let biased = halves + 0x0080_0080;
    ((biased + ((biased >> 8) & HALVES)) >> 8) & HALVES
}

#[cfg(test)]
mod tests {
    use super::super::blend::{Components, blend};
    use super::*;
    use crate::forward::state::{Blend, BlendEquation, BlendFactor};
    use vitral_math::color::byte_from_unit;
    use vitral_math::lanes::{F32x8, Level, available_levels, dispatch};

    #[test]
    fn words_are_rounded_to_nearest_and_survive_the_round_trip() {
        let values = [-0.5, 0.0, 0.001_960_7, 0.002, 0.5, 0.999, 7.0, f32::NAN];
        for (name, level) in available_levels() {
            let words = dispatch!(level, simd => {
                let v = F32x8::from_slice(simd, &values);
                pack(&[v, v, v, v]).to_array()
            });
            for lane in 0..8 {
                assert_eq!(
                    words[lane].to_le_bytes(),
                    [byte_from_unit(values[lane]); 4],
                    "{name} {}",
                    values[lane]
                );
            }
            for byte in (0..=255u32).step_by(8) {
                let row: Vec<u32> = (0..8)
                    .map(|i| u32::from_le_bytes([byte as u8 + i, 255 - i, i, 77 + i]))
                    .collect();
                let (same, floats) = dispatch!(level, simd => {
                    let color = unpack(U32x8::from_slice(simd, &row));
                    (pack(&color).to_array(), color[0].to_array())
                });
                assert_eq!(same[..], row[..], "{name}");
                assert_eq!(floats[3], (byte + 3) as f32 / 255.0);
            }
        }
    }

    fn float_blend(
        level: Level,
        factors: [BlendFactor; 2],
        s: &[u32; 8],
        d: &[u32; 8],
    ) -> [u32; 8] {
        let state = Blend {
            source: [factors[0]; 2],
            destination: [factors[1]; 2],
            equation: [BlendEquation::Add; 2],
            color: [0.0; 4],
        };
        dispatch!(level, simd => {
            let (s, d) = (U32x8::from_slice(simd, s), U32x8::from_slice(simd, d));
            pack(&blend(simd, &state, unpack(s), unpack(d), Components::Unit)).to_array()
        })
    }

    #[test]
    fn word_blends_equal_the_float_blends_for_all_bytes() {
        let one = BlendFactor::One;
        for (name, level) in available_levels() {
            // All pairs of bytes in three components, alphas in steps that reach 0 and 255.
            for source_byte in 0..=255u32 {
                for i in 0..32u32 {
                    let s: [u32; 8] = std::array::from_fn(|k| {
                        let alpha = (source_byte * 7 + (i * 8 + k as u32) * 5) & 255;
                        (source_byte * 0x0001_0101) | (alpha << 24)
                    });
                    let d: [u32; 8] = std::array::from_fn(|k| {
                        let byte = i * 8 + k as u32;
                        (byte * 0x0001_0101) | ((255 - source_byte) << 24)
                    });
                    let (sum, scaled, mixed) = dispatch!(level, simd => {
                        let (s, d) = (U32x8::from_slice(simd, &s), U32x8::from_slice(simd, &d));
                        (add_packed(s, d).to_array(), add_scaled_packed(s, d).to_array(), mix_packed(s, d).to_array())
                    });
                    assert_eq!(sum, float_blend(level, [one; 2], &s, &d), "{name} add");
                    assert_eq!(sum, std::array::from_fn(|k| add_words(s[k], d[k])), "{name} add");
                    let factors = [BlendFactor::SrcAlpha, one];
                    assert_eq!(scaled, float_blend(level, factors, &s, &d), "{name} add scaled");
                    let factors = [BlendFactor::SrcAlpha, BlendFactor::OneMinusSrcAlpha];
                    assert_eq!(mixed, float_blend(level, factors, &s, &d), "{name} mix");
                }
            }
        }
    }
}
