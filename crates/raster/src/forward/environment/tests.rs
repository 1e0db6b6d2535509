//! Every mode with every base format, and every `COMBINE` function, against the tables written out.

use super::*;
use crate::forward::state::{Combine, CombineFunction, CombineOperand, CombineSource};
use crate::forward::texture::{Filter, Sampler, TextureKind, Wrap};
use crate::forward::wide::splat_rgba;
use std::sync::Arc;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Level, available_levels, dispatch};

fn unit(format: BaseFormat, mode: EnvironmentMode) -> Unit {
    let sampler = Sampler {
        min: Filter::Nearest,
        mag: Filter::Nearest,
        wrap: [Wrap::Repeat; 3],
        border: [0.0; 4],
        lod: [-1000.0, 1000.0],
        anisotropy: 1.0,
        compare: None,
        seamless: false,
    };
    let depth_mode = BaseFormat::Luminance;
    let texture =
        Texture { depth_mode, ..Texture::new(TextureKind::Two, format, Vec::new(), sampler) };
    Unit { index: 1, texture: Arc::new(texture), mode, color: [0.2, 0.4, 0.6, 0.8], lod_bias: 0.0 }
}

/// Texture colours of units 0, 1 and 2; the primary and the previous colour.
const TEXTURES: [[f32; 4]; 3] =
    [[0.1, 0.3, 0.9, 0.6], [0.75, 0.5, 0.25, 0.7], [0.9, 0.05, 0.45, 0.35]];
const PRIMARY: [f32; 4] = [0.15, 0.85, 0.55, 0.95];
const PREVIOUS: [f32; 4] = [0.6, 0.3, 0.8, 0.5];

fn run(level: Level, unit: &Unit) -> [f32; 4] {
    dispatch!(level, simd => {
        let zero = splat_rgba(simd, [0.0; 4]);
        let mut textures = [zero; UNITS];
        for i in 0..3 {
            textures[i] = splat_rgba(simd, TEXTURES[i]);
        }
        let out = environment(simd, unit, &textures, &splat_rgba(simd, PRIMARY), splat_rgba(simd, PREVIOUS), true);
        let lane = |v: F32x8<_>| v.to_array()[5];
        [lane(out[0]), lane(out[1]), lane(out[2]), lane(out[3])]
    })
}

fn check(unit: &Unit, expected: [f32; 4], what: &str) {
    for (name, level) in available_levels() {
        let out = run(level, unit);
        for k in 0..4 {
            let e = expected[k].clamp(0.0, 1.0);
            assert!((out[k] - e).abs() < 1e-6, "{name} {what}: {out:?}, expected {expected:?}");
        }
    }
}

/// Tables 3.22 and 3.23: colour and alpha by mode and format. `None` where the specification leaves
/// it open.
fn table(mode: &EnvironmentMode, format: BaseFormat, k: usize) -> Option<f32> {
    use BaseFormat::*;
    use EnvironmentMode::*;
    let (p, s, c) = (PREVIOUS[k], TEXTURES[1][k], [0.2, 0.4, 0.6, 0.8][k]);
    let a = TEXTURES[1][3];
    let alpha = k == 3;
    Some(match (mode, format) {
        (_, Depth) => return table(mode, Luminance, k),
        (Replace, Alpha) if !alpha => p,
        (Replace, Luminance | Rgb) if alpha => p,
        (Replace, _) => s,
        (Modulate, Alpha) if !alpha => p,
        (Modulate, Luminance | Rgb) if alpha => p,
        (Modulate, _) => p * s,
        (Decal, Rgb) => {
            if alpha {
                p
            } else {
                s
            }
        }
        (Decal, Rgba) => {
            if alpha {
                p
            } else {
                p * (1.0 - a) + s * a
            }
        }
        (Decal, _) => return None,
        (Blend, Alpha) if !alpha => p,
        (Blend, Luminance | Rgb) if alpha => p,
        (Blend, Alpha | LuminanceAlpha | Rgba) if alpha => p * s,
        (Blend, _) => p * (1.0 - s) + c * s,
        (Add, Alpha) if !alpha => p,
        (Add, Luminance | Rgb) if alpha => p,
        (Add, Alpha | LuminanceAlpha | Rgba) if alpha => p * s,
        (Add, _) => p + s,
        (Combine(_), _) => return None,
    })
}

#[test]
fn every_mode_with_every_format() {
    use BaseFormat::*;
    use EnvironmentMode::*;
    for mode in [Replace, Modulate, Decal, Blend, Add] {
        for format in [Alpha, Luminance, LuminanceAlpha, Intensity, Rgb, Rgba, Depth] {
            let expected = [0, 1, 2, 3].map(|k| table(&mode, format, k).unwrap_or(PREVIOUS[k]));
            check(&unit(format, mode), expected, &format!("{mode:?} {format:?}"));
        }
    }
}

fn combine(functions: [CombineFunction; 2], scale: [f32; 2]) -> Combine {
    use CombineOperand::*;
    use CombineSource::*;
    Combine {
        functions,
        rgb: [(Texture, Color), (Previous, Color), (Constant, Alpha)],
        alpha: [(Texture, Alpha), (Previous, Alpha), (Constant, Alpha)],
        scale,
    }
}

#[test]
fn every_combine_function_with_every_scale() {
    use CombineFunction::*;
    let [t, p] = [TEXTURES[1], PREVIOUS];
    for scale in [1.0, 2.0, 4.0] {
        for (function, formula) in [
            (Replace, (|a, _, _| a) as fn(f32, f32, f32) -> f32),
            (Modulate, |a, b, _| a * b),
            (Add, |a, b, _| a + b),
            (AddSigned, |a, b, _| a + b - 0.5),
            (Interpolate, |a, b, c| a * c + b * (1.0 - c)),
            (Subtract, |a, b, _| a - b),
        ] {
            let state = combine([function; 2], [scale, 1.0]);
            let mut expected = [0, 1, 2, 3].map(|k| formula(t[k], p[k], 0.8) * scale);
            expected[3] /= scale;
            let u = unit(BaseFormat::Rgba, EnvironmentMode::Combine(state));
            check(&u, expected, &format!("{function:?} times {scale}"));
        }
    }
}

#[test]
fn dot_products_go_to_colour_or_to_all() {
    use CombineFunction::*;
    let [t, p] = [TEXTURES[1], PREVIOUS];
    let dot = 4.0 * (0..3).map(|k| (t[k] - 0.5) * (p[k] - 0.5)).sum::<f32>();
    assert!(dot < 0.0, "clamped");
    let bright = CombineSource::TextureUnit(2);
    for (function, scale, alpha) in [(Dot3Rgb, 2.0, t[3] * p[3] * 4.0), (Dot3Rgba, 2.0, dot * 4.0)]
    {
        let state = combine([function, Modulate], [scale, 4.0]);
        let u = unit(BaseFormat::Rgba, EnvironmentMode::Combine(state));
        check(&u, [dot * 2.0, dot * 2.0, dot * 2.0, alpha], &format!("{function:?}"));
    }
    let mut state = combine([Dot3Rgba, Replace], [1.0, 1.0]);
    state.rgb[0].0 = bright;
    state.rgb[1].0 = bright;
    let b = TEXTURES[2];
    let length = 4.0 * (0..3).map(|k| (b[k] - 0.5) * (b[k] - 0.5)).sum::<f32>();
    check(
        &unit(BaseFormat::Rgba, EnvironmentMode::Combine(state)),
        [length; 4],
        "a vector with itself",
    );
}

#[test]
fn every_source_with_every_operand() {
    use CombineOperand::*;
    use CombineSource::*;
    for (source, value) in [
        (Texture, TEXTURES[1]),
        (TextureUnit(0), TEXTURES[0]),
        (TextureUnit(2), TEXTURES[2]),
        (Constant, [0.2, 0.4, 0.6, 0.8]),
        (PrimaryColor, PRIMARY),
        (Previous, PREVIOUS),
    ] {
        for operand in [Color, OneMinusColor, Alpha, OneMinusAlpha] {
            let mut state = combine([CombineFunction::Replace; 2], [1.0; 2]);
            state.rgb[0] = (source, operand);
            state.alpha[0] = (source, operand);
            let of = |k: usize| match operand {
                Color => value[k],
                OneMinusColor => 1.0 - value[k],
                Alpha => value[3],
                OneMinusAlpha => 1.0 - value[3],
            };
            let u = unit(BaseFormat::Rgba, EnvironmentMode::Combine(state));
            check(&u, [of(0), of(1), of(2), of(3)], &format!("{source:?} {operand:?}"));
        }
    }
}
