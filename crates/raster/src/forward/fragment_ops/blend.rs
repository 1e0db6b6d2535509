//! Blending: the equation of source and stored colour, each times its factor.

use crate::forward::state::{Blend, BlendEquation, BlendFactor};
use crate::forward::wide::{Rgba, max, min, saturate_rgba, splat, splat_rgba};
use vitral_math::lanes::{F32x8, Simd};

/// The blended colour. With `clamped` (planes of fixed point) the source and the constant are clamped to `0..=1` before
/// and the result after; planes of floating point take everything as it is.
#[inline(always)]
pub(crate) fn blend<S: Simd>(simd: S, state: &Blend, source: Rgba<S>, stored: Rgba<S>, clamped: bool) -> Rgba<S> {
    let constant = splat_rgba(simd, state.color);
    let (source, constant) =
        if clamped { (saturate_rgba(source), saturate_rgba(constant)) } else { (source, constant) };
    let inputs = Inputs { simd, source, stored, constant };
    let s = inputs.color_factor(state.source[0]);
    let d = inputs.color_factor(state.destination[0]);
    let equation = state.equation[0];
    let blended = [
        combine(equation, source[0], s[0], stored[0], d[0]),
        combine(equation, source[1], s[1], stored[1], d[1]),
        combine(equation, source[2], s[2], stored[2], d[2]),
        combine(
            state.equation[1],
            source[3],
            inputs.alpha_factor(state.source[1]),
            stored[3],
            inputs.alpha_factor(state.destination[1]),
        ),
    ];
    if clamped { saturate_rgba(blended) } else { blended }
}

/// One component.
#[inline(always)]
fn combine<S: Simd>(
    equation: BlendEquation,
    source: F32x8<S>,
    source_factor: F32x8<S>,
    stored: F32x8<S>,
    stored_factor: F32x8<S>,
) -> F32x8<S> {
    match equation {
        BlendEquation::Add => source * source_factor + stored * stored_factor,
        BlendEquation::Subtract => source * source_factor - stored * stored_factor,
        BlendEquation::ReverseSubtract => stored * stored_factor - source * source_factor,
        // These two ignore the factors.
        BlendEquation::Min => min(source, stored),
        BlendEquation::Max => max(source, stored),
    }
}

/// What factors are made of.
#[derive(Clone, Copy)]
struct Inputs<S: Simd> {
    simd: S,
    source: Rgba<S>,
    stored: Rgba<S>,
    constant: Rgba<S>,
}

impl<S: Simd> Inputs<S> {
    /// Factors of red, green and blue.
    #[inline(always)]
    fn color_factor(&self, factor: BlendFactor) -> [F32x8<S>; 3] {
        let one = splat(self.simd, 1.0);
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
    fn alpha_factor(&self, factor: BlendFactor) -> F32x8<S> {
        let one = splat(self.simd, 1.0);
        match factor {
            BlendFactor::Zero => splat(self.simd, 0.0),
            BlendFactor::One | BlendFactor::SrcAlphaSaturate => one,
            BlendFactor::SrcColor | BlendFactor::SrcAlpha => self.source[3],
            BlendFactor::OneMinusSrcColor | BlendFactor::OneMinusSrcAlpha => one - self.source[3],
            BlendFactor::DstColor | BlendFactor::DstAlpha => self.stored[3],
            BlendFactor::OneMinusDstColor | BlendFactor::OneMinusDstAlpha => one - self.stored[3],
            BlendFactor::ConstantColor | BlendFactor::ConstantAlpha => self.constant[3],
            BlendFactor::OneMinusConstantColor | BlendFactor::OneMinusConstantAlpha => one - self.constant[3],
        }
    }
}

#[inline(always)]
fn rgb<S: Simd>(c: Rgba<S>) -> [F32x8<S>; 3] {
    [c[0], c[1], c[2]]
}

#[inline(always)]
fn complement<S: Simd>(one: F32x8<S>, c: [F32x8<S>; 3]) -> [F32x8<S>; 3] {
    [one - c[0], one - c[1], one - c[2]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use BlendFactor::*;
    use vitral_math::lanes::prelude::*;
    use vitral_math::lanes::{Level, available_levels, dispatch};

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

    fn check(level: Level, name: &str, state: &Blend, s: [[f32; 4]; 8], d: [[f32; 4]; 8], clamped: bool) {
        let column = |v: [[f32; 4]; 8], k: usize| v.map(|p| p[k]);
        let out: [[f32; 8]; 4] = dispatch!(level, simd => {
            let load = |v: [[f32; 4]; 8]| -> Rgba<_> {
                let at = |k| F32x8::from_slice(simd, &column(v, k));
                [at(0), at(1), at(2), at(3)]
            };
            let [r, g, b, a] = blend(simd, state, load(s), load(d), clamped);
            [r.to_array(), g.to_array(), b.to_array(), a.to_array()]
        });
        for lane in 0..8 {
            let expected = scalar(state, s[lane], d[lane], clamped);
            assert_eq!(column_of(&out, lane), expected, "{name} {state:?} {:?} {:?}", s[lane], d[lane]);
        }
    }

    fn column_of(out: &[[f32; 8]; 4], lane: usize) -> [f32; 4] {
        [out[0][lane], out[1][lane], out[2][lane], out[3][lane]]
    }

    /// Eight colours, some beyond `0..=1`.
    fn colors(seed: u32) -> [[f32; 4]; 8] {
        std::array::from_fn(|i| std::array::from_fn(|k| ((seed + 37 * i as u32 + 101 * k as u32) % 71) as f32 / 64.0))
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
                let out = blend(simd, &state, load(half[0]), load([0.0, 1.0, 0.5, 0.25]), true);
                [out[0].to_array()[0], out[1].to_array()[0], out[2].to_array()[0], out[3].to_array()[0]]
            });
            assert_eq!(out, [0.5, 0.5, 0.5, 0.0]);
        }
    }
}
