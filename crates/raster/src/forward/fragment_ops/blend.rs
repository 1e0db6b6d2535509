//! Blending: the equation of source and stored colour, each times its factor.

use super::packed::unpack_bytes;
use crate::forward::state::{Blend, BlendEquation, BlendFactor};
use crate::forward::wide::{clamp, every_rgba, max, min};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, Floats, Lanes, Simd};

/// The numbers that components are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Components {
    /// As planes of floating point hold them: everything is taken as it is.
    Unclamped,
    /// `0..=1`: source and constant are clamped before, the result after.
    Unit,
    /// `0..=255`: the same, times 255.
    Bytes,
}

/// The blended colour.
#[inline(always)]
pub(crate) fn blend<S: Simd, V: Floats<S>>(
    simd: S,
    state: &Blend,
    source: [V; 4],
    stored: [V; 4],
    components: Components,
) -> [V; 4] {
    // Clamp source and constant colour as the format asks.
    let one = if components == Components::Bytes { 255.0 } else { 1.0 };
    let limited = lanes::inlined(
        #[inline(always)]
        |[r, g, b, a]: [V; 4]| match components {
            Components::Unclamped => [r, g, b, a],
            _ => [clamp(r, 0.0, one), clamp(g, 0.0, one), clamp(b, 0.0, one), clamp(a, 0.0, one)],
        },
    );
    let (source, constant) =
        (limited(source), limited(every_rgba(simd, state.color.map(|c| c * one))));

    // Compute the factors of colour.
    let inputs = Inputs { one, source, stored, constant };
    let s = inputs.color_factor(state.source[0]);
    let d = inputs.color_factor(state.destination[0]);

    // Combine each component with its factor; alpha has its own.
    let component = lanes::inlined(
        #[inline(always)]
        |k: usize, s: V, d: V| {
            combine(state.equation[usize::from(k == 3)], (source[k], s), (stored[k], d), one)
        },
    );
    let alpha_factors =
        [inputs.alpha_factor(state.source[1]), inputs.alpha_factor(state.destination[1])];
    limited([
        component(0, s[0], d[0]),
        component(1, s[1], d[1]),
        component(2, s[2], d[2]),
        component(3, alpha_factors[0], alpha_factors[1]),
    ])
}

/// Blends packed pixels. Each byte is the nearest to the exact result: products and sums of bytes
/// are exact, and 255 is odd, so that no quotient lies half between two.
#[inline(always)]
pub(crate) fn blend_packed<S: Simd, V: Floats<S>>(
    simd: S,
    state: &Blend,
    source: V::Words,
    stored: V::Words,
) -> V::Words {
    let color: [V; 4] =
        blend(simd, state, unpack_bytes(source), unpack_bytes(stored), Components::Bytes);
    let byte = lanes::inlined(
        #[inline(always)]
        |k: usize| -> V::Ints { (color[k] + 0.5).to_int() },
    );
    (byte(0) | (byte(1) << 8) | (byte(2) << 16) | (byte(3) << 24)).bitcast()
}

/// One component, and what it and the stored one are multiplied with; factors count in parts of
/// `one`.
#[inline(always)]
fn combine<V: Lanes>(
    equation: BlendEquation,
    (source, s): (V, V),
    (stored, d): (V, V),
    one: f32,
) -> V {
    match equation {
        BlendEquation::Add => (source * s + stored * d) * (1.0 / one),
        BlendEquation::Subtract => (source * s - stored * d) * (1.0 / one),
        BlendEquation::ReverseSubtract => (stored * d - source * s) * (1.0 / one),
        // These two ignore the factors.
        BlendEquation::Min => min(source, stored),
        BlendEquation::Max => max(source, stored),
    }
}

/// What factors are made of.
#[derive(Clone, Copy)]
struct Inputs<V> {
    /// The value of 1: 255 where components are bytes.
    one: f32,
    /// The incoming colour: red, green, blue, alpha.
    source: [V; 4],
    /// The stored colour.
    stored: [V; 4],
    /// The blend colour.
    constant: [V; 4],
}

impl<V: Lanes> Inputs<V> {
    /// Factors of red, green and blue.
    #[inline(always)]
    fn color_factor(&self, factor: BlendFactor) -> [V; 3] {
        let one = self.source[0].splat(self.one);
        match factor {
            BlendFactor::SrcColor => rgb(self.source),
            BlendFactor::OneMinusSrcColor => complement(one, rgb(self.source)),
            BlendFactor::DstColor => rgb(self.stored),
            BlendFactor::OneMinusDstColor => complement(one, rgb(self.stored)),
            BlendFactor::ConstantColor => rgb(self.constant),
            BlendFactor::OneMinusConstantColor => complement(one, rgb(self.constant)),
            BlendFactor::SrcAlphaSaturate => [min(self.source[3], one - self.stored[3]); 3],
            _ => [self.alpha_factor(factor); 3],
        }
    }

    /// The factor of alpha, where a colour counts with its alpha.
    #[inline(always)]
    fn alpha_factor(&self, factor: BlendFactor) -> V {
        let one = self.source[0].splat(self.one);
        match factor {
            BlendFactor::Zero => one.splat(0.0),
            BlendFactor::One | BlendFactor::SrcAlphaSaturate => one,
            BlendFactor::SrcColor | BlendFactor::SrcAlpha => self.source[3],
            BlendFactor::OneMinusSrcColor | BlendFactor::OneMinusSrcAlpha => one - self.source[3],
            BlendFactor::DstColor | BlendFactor::DstAlpha => self.stored[3],
            BlendFactor::OneMinusDstColor | BlendFactor::OneMinusDstAlpha => one - self.stored[3],
            BlendFactor::ConstantColor | BlendFactor::ConstantAlpha => self.constant[3],
            BlendFactor::OneMinusConstantColor | BlendFactor::OneMinusConstantAlpha => {
                one - self.constant[3]
            }
        }
    }
}

#[inline(always)]
fn rgb<V: Lanes>(c: [V; 4]) -> [V; 3] {
    [c[0], c[1], c[2]]
}

#[inline(always)]
fn complement<V: Lanes>(one: V, c: [V; 3]) -> [V; 3] {
    [one - c[0], one - c[1], one - c[2]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::fragment_ops::packed::{pack, unpack};
    use crate::forward::wide::{Rgba, splat_rgba};
    use BlendFactor::*;
    use vitral_math::lanes::{F32x8, F32x16, Level, U32x8, U32x16, available_levels, dispatch};

    const FACTORS: [BlendFactor; 15] = [
        Zero,
        One,
        SrcColor,
        OneMinusSrcColor,
        DstColor,
        OneMinusDstColor,
        SrcAlpha,
        OneMinusSrcAlpha,
        DstAlpha,
        OneMinusDstAlpha,
        ConstantColor,
        OneMinusConstantColor,
        ConstantAlpha,
        OneMinusConstantAlpha,
        SrcAlphaSaturate,
    ];

    const EQUATIONS: [BlendEquation; 5] = [
        BlendEquation::Add,
        BlendEquation::Subtract,
        BlendEquation::ReverseSubtract,
        BlendEquation::Min,
        BlendEquation::Max,
    ];

    /// Table 4.1 of the specification, written out for component `k`.
    fn factor(f: BlendFactor, k: usize, s: [f32; 4], d: [f32; 4], c: [f32; 4]) -> f32 {
        match f {
            Zero => 0.0,
            One => 1.0,
            SrcColor => s[k],
            OneMinusSrcColor => 1.0 - s[k],
            DstColor => d[k],
            OneMinusDstColor => 1.0 - d[k],
            SrcAlpha => s[3],
            OneMinusSrcAlpha => 1.0 - s[3],
            DstAlpha => d[3],
            OneMinusDstAlpha => 1.0 - d[3],
            ConstantColor => c[k],
            OneMinusConstantColor => 1.0 - c[k],
            ConstantAlpha => c[3],
            OneMinusConstantAlpha => 1.0 - c[3],
            SrcAlphaSaturate if k == 3 => 1.0,
            SrcAlphaSaturate => s[3].min(1.0 - d[3]),
        }
    }

    fn scalar(state: &Blend, mut s: [f32; 4], d: [f32; 4], clamped: bool) -> [f32; 4] {
        let mut c = state.color;
        if clamped {
            s = s.map(|v| v.clamp(0.0, 1.0));
            c = c.map(|v| v.clamp(0.0, 1.0));
        }
        std::array::from_fn(|k| {
            let which = usize::from(k == 3);
            let fs = factor(state.source[which], k, s, d, c);
            let fd = factor(state.destination[which], k, s, d, c);
            let value = match state.equation[which] {
                BlendEquation::Add => s[k] * fs + d[k] * fd,
                BlendEquation::Subtract => s[k] * fs - d[k] * fd,
                BlendEquation::ReverseSubtract => d[k] * fd - s[k] * fs,
                BlendEquation::Min => s[k].min(d[k]),
                BlendEquation::Max => s[k].max(d[k]),
            };
            if clamped { value.clamp(0.0, 1.0) } else { value }
        })
    }

    fn check(
        level: Level,
        name: &str,
        state: &Blend,
        s: [[f32; 4]; 8],
        d: [[f32; 4]; 8],
        clamped: bool,
    ) {
        let column = |v: [[f32; 4]; 8], k: usize| v.map(|p| p[k]);
        let out: [[f32; 8]; 4] = dispatch!(level, simd => {
            let load = |v: [[f32; 4]; 8]| -> Rgba<_> {
                let at = |k| F32x8::from_slice(simd, &column(v, k));
                [at(0), at(1), at(2), at(3)]
            };
            let components = if clamped { Components::Unit } else { Components::Unclamped };
            let [r, g, b, a] = blend(simd, state, load(s), load(d), components);
            [r.to_array(), g.to_array(), b.to_array(), a.to_array()]
        });
        for lane in 0..8 {
            let expected = scalar(state, s[lane], d[lane], clamped);
            assert_eq!(
                column_of(&out, lane),
                expected,
                "{name} {state:?} {:?} {:?}",
                s[lane],
                d[lane]
            );
        }
    }

    fn column_of(out: &[[f32; 8]; 4], lane: usize) -> [f32; 4] {
        [out[0][lane], out[1][lane], out[2][lane], out[3][lane]]
    }

    /// Eight colours, some beyond `0..=1`.
    fn colors(seed: u32) -> [[f32; 4]; 8] {
        std::array::from_fn(|i| {
            std::array::from_fn(|k| ((seed + 37 * i as u32 + 101 * k as u32) % 71) as f32 / 64.0)
        })
    }

    #[test]
    fn every_pair_of_factors_with_every_equation() {
        let stored = colors(29).map(|c| c.map(|v| v.min(1.0)));
        for (name, level) in available_levels() {
            for source in FACTORS {
                for destination in FACTORS {
                    for equation in EQUATIONS {
                        let state = Blend {
                            source: [source; 2],
                            destination: [destination; 2],
                            equation: [equation; 2],
                            color: [0.25, 1.5, -0.5, 0.75],
                        };
                        check(level, name, &state, colors(11), stored, true);
                        check(level, name, &state, colors(11), colors(29), false);
                    }
                }
            }
        }
    }

    #[test]
    fn packed_pixels_blend_as_their_components_do() {
        let word = |i: u32| i.wrapping_mul(0x9e37_79b9) ^ i.wrapping_mul(i) << 7;
        let (source, stored): ([u32; 16], [u32; 16]) = (
            std::array::from_fn(|i| word(i as u32 + 3)),
            std::array::from_fn(|i| word(i as u32 + 77)),
        );
        for (name, level) in available_levels() {
            for (source_factor, destination) in
                FACTORS.iter().flat_map(|s| FACTORS.map(|d| (*s, d)))
            {
                for equation in EQUATIONS {
                    let state = Blend {
                        source: [source_factor; 2],
                        destination: [destination; 2],
                        equation: [equation; 2],
                        // Of bytes: what lies half between two could be rounded either way.
                        color: [0.2, 1.5, -0.5, 0.6],
                    };
                    let (eight, sixteen, expected) = dispatch!(level, simd => {
                        let [s, d] = [&source, &stored].map(|words| U32x8::from_slice(simd, &words[..8]));
                        let eight = blend_packed::<_, F32x8<_>>(simd, &state, s, d).to_array();
                        let apart = pack(&blend(simd, &state, unpack(s), unpack(d), Components::Unit)).to_array();
                        let [s, d] = [&source, &stored].map(|words| U32x16::from_slice(simd, words));
                        (eight, blend_packed::<_, F32x16<_>>(simd, &state, s, d).to_array(), apart)
                    });
                    assert_eq!(eight, expected, "{name} {state:?}");
                    assert_eq!(sixteen[..8], expected, "{name} {state:?}");
                }
            }
        }
    }

    #[test]
    fn colour_and_alpha_blend_separately() {
        let state = Blend {
            source: [SrcAlpha, One],
            destination: [OneMinusSrcAlpha, Zero],
            equation: [BlendEquation::Add, BlendEquation::ReverseSubtract],
            color: [0.0; 4],
        };
        for (name, level) in available_levels() {
            check(level, name, &state, colors(3), colors(5), false);
            let half = [[1.0, 0.0, 0.5, 0.5]; 8];
            let out = dispatch!(level, simd => {
                let load = |c: [f32; 4]| splat_rgba(simd, c);
                let out = blend(simd, &state, load(half[0]), load([0.0, 1.0, 0.5, 0.25]), Components::Unit);
                [out[0].to_array()[0], out[1].to_array()[0], out[2].to_array()[0], out[3].to_array()[0]]
            });
            assert_eq!(out, [0.5, 0.5, 0.5, 0.0]);
        }
    }
}
