//! Colours of bytes, filtered without being turned into floating point.
//!
//! Two components lie in the 16-bit halves of each word. Weights have 8 bits, so that products stay
//! below 2^16; each mix is rounded to nearest, which puts a colour filtered from eight texels
//! within 2/255 of the exact one.

use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{Floats, Simd};

/// Colours of bytes, two in the 16-bit halves of each word: they are filtered together, with
/// weights of 8 bits.
pub(super) struct Halves<S: Simd, V: Floats<S>> {
    /// Red, and blue in the higher half.
    rb: V::Halves,
    /// Green, and alpha in the higher half.
    ga: V::Halves,
}

impl<S: Simd, V: Floats<S>> Halves<S, V> {
    #[inline(always)]
    pub(super) fn new(words: V::Words) -> Self {
        Self { rb: (words & 0x00ff_00ff).bitcast(), ga: ((words >> 8) & 0x00ff_00ff).bitcast() }
    }

    /// Of four texels round a place, with its distances from the first.
    #[inline(always)]
    pub(super) fn filter(simd: S, [a, b, c, d]: [V::Words; 4], [x, y]: [V; 2]) -> Self {
        let (x, y) = (weight(simd, x), weight(simd, y));
        let lower = Self::new(a).mix(&Self::new(b), x);
        lower.mix(&Self::new(c).mix(&Self::new(d), x), y)
    }

    /// Rounded to nearest; exact where both are equal.
    #[inline(always)]
    pub(super) fn mix(&self, other: &Self, [rest, weight]: [V::Halves; 2]) -> Self {
        let half = V::Halves::splat(weight.token(), 128);
        Self {
            rb: (self.rb * rest + other.rb * weight + half) >> 8,
            ga: (self.ga * rest + other.ga * weight + half) >> 8,
        }
    }

    /// The bytes of each colour in a word, red the lowest.
    #[inline(always)]
    pub(super) fn words(&self) -> V::Words {
        let (rb, ga): (V::Words, V::Words) = (self.rb.bitcast(), self.ga.bitcast());
        rb | (ga << 8)
    }

    /// The bytes as numbers of 0..=255.
    #[inline(always)]
    pub(super) fn unpack(&self) -> [V; 4] {
        let (rb, ga): (V::Words, V::Words) = (self.rb.bitcast(), self.ga.bitcast());
        // Signed integers, because they are turned into floats in one instruction.
        let [r, g, b, a]: [V::Ints; 4] = [
            (rb & 0xffff).bitcast(),
            (ga & 0xffff).bitcast(),
            (rb >> 16).bitcast(),
            (ga >> 16).bitcast(),
        ];
        [r.to_float(), g.to_float(), b.to_float(), a.to_float()]
    }
}

/// The 256ths of the first and of the second of two colours, for a weight in 0..=1 of the second.
#[inline(always)]
pub(super) fn weight<S: Simd, V: Floats<S>>(simd: S, weight: V) -> [V::Halves; 2] {
    let whole: V::Ints = (weight * 256.0 + 0.5).to_int();
    let both: V::Halves = (whole | (whole << 16)).bitcast();
    [V::Halves::splat(simd, 256) - both, both]
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::lanes::{F32x8, LANES, U32x8, available_levels, dispatch};

    /// The mix of bytes, rounded to nearest after each axis, with weights of 8 bits.
    fn by_hand(texels: [u32; 4], [x, y]: [u32; 2], shift: u32) -> u32 {
        let [a, b, c, d] = texels.map(|word| word >> shift & 0xff);
        let mix = |a: u32, b: u32, w: u32| (a * (256 - w) + b * w + 128) / 256;
        mix(mix(a, b, x), mix(c, d, x), y)
    }

    #[test]
    fn components_do_not_touch_each_other() {
        let texels: [[u32; LANES]; 4] = std::array::from_fn(|k| {
            std::array::from_fn(|i| {
                (i as u32).wrapping_mul(0x2947_1bd3).rotate_left(7 * k as u32) ^ 0xff00_00ff
            })
        });
        let weights = [0.0, 0.25, 0.5, 0.498, 0.75, 0.999, 1.0, 0.1];
        for (name, level) in available_levels() {
            let color = dispatch!(level, simd => {
                let [a, b, c, d] = &texels;
                let words = [U32x8::from_slice(simd, a), U32x8::from_slice(simd, b), U32x8::from_slice(simd, c), U32x8::from_slice(simd, d)];
                let x = F32x8::from_slice(simd, &weights);
                let [r, g, b, a] = Halves::filter(simd, words, [x, x.reverse()]).unpack();
                [r.to_array(), g.to_array(), b.to_array(), a.to_array()]
            });
            for lane in 0..LANES {
                let whole = |w: f32| (w * 256.0 + 0.5) as u32;
                let weights = [whole(weights[lane]), whole(weights[LANES - 1 - lane])];
                for k in 0..4 {
                    let expected = by_hand(texels.map(|t| t[lane]), weights, 8 * k as u32);
                    assert_eq!(
                        color[k][lane], expected as f32,
                        "{name}: lane {lane}, component {k}"
                    );
                }
            }
        }
    }
}
