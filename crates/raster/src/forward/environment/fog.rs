//! Colour sum and fog.

use crate::forward::state::{Fog, FogMode};
use crate::forward::wide::{mix, saturate};
use vitral_math::lanes::{self, Lanes};

/// Adds the secondary colour; the sum is clamped to `0..=1`, alpha stays.
#[inline(always)]
pub(crate) fn color_sum<V: Lanes>(color: [V; 4], secondary: &[V; 3]) -> [V; 4] {
    [
        saturate(color[0] + secondary[0]),
        saturate(color[1] + secondary[1]),
        saturate(color[2] + secondary[2]),
        color[3],
    ]
}

/// How much of the fragment's own colour shows through the fog: 1 without fog, 0 in the thickest.
#[inline(always)]
pub(crate) fn fog_factor<V: Lanes>(mode: FogMode, coordinate: V) -> V {
    // e^-x is 2^(-x log2 e).
    let falling = lanes::inlined(
        #[inline(always)]
        |x: V| Lanes::exp2(x * -std::f32::consts::LOG2_E),
    );
    saturate(match mode {
        FogMode::Linear { start, end } => (coordinate.splat(end) - coordinate) / (end - start),
        FogMode::Exp { density } => falling(coordinate * density),
        FogMode::Exp2 { density } => {
            let depth = coordinate * density;
            falling(depth * depth)
        }
    })
}

/// Fades towards the fog's colour.
#[inline(always)]
pub(crate) fn fog<V: Lanes>(state: &Fog, color: [V; 4], coordinate: V) -> [V; 4] {
    let f = fog_factor(state.mode, coordinate);
    [
        mix(f.splat(state.color[0]), color[0], f),
        mix(f.splat(state.color[1]), color[1], f),
        mix(f.splat(state.color[2]), color[2], f),
        color[3],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::wide::{splat, splat_rgba};
    use vitral_math::lanes::prelude::*;
    use vitral_math::lanes::{F32x8, available_levels, dispatch};

    #[test]
    fn factors_by_their_formulas() {
        let c = [0.0f32, 0.5, 1.0, 2.0, 5.0, 10.0, -1.0, 1e9];
        for (name, level) in available_levels() {
            for (mode, formula) in [
                (FogMode::Linear { start: 1.0, end: 6.0 }, (|c| (6.0 - c) / 5.0) as fn(f64) -> f64),
                (FogMode::Exp { density: 0.3 }, |c| vitral_math::func::exp(-0.3 * c)),
                (FogMode::Exp2 { density: 0.3 }, |c| vitral_math::func::exp(-0.09 * c * c)),
            ] {
                let f = dispatch!(level, simd => fog_factor(mode, F32x8::from_slice(simd, &c)).to_array());
                for lane in 0..8 {
                    let expected = formula(f64::from(c[lane])).clamp(0.0, 1.0) as f32;
                    assert!(
                        (f[lane] - expected).abs() < 1e-6,
                        "{name} {mode:?} {}: {}",
                        c[lane],
                        f[lane]
                    );
                }
            }
            let same = FogMode::Linear { start: 2.0, end: 2.0 };
            let f =
                dispatch!(level, simd => fog_factor(same, F32x8::from_slice(simd, &c)).to_array());
            assert_eq!(
                f,
                [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
                "nothing up to the end, then all"
            );
        }
    }

    #[test]
    fn fog_mixes_colour_and_keeps_alpha() {
        let state = Fog { mode: FogMode::Linear { start: 0.0, end: 4.0 }, color: [1.0, 0.0, 0.5] };
        for (_, level) in available_levels() {
            let out = dispatch!(level, simd => {
                let out = fog(&state, splat_rgba(simd, [0.0, 1.0, 0.5, 0.25]), splat(simd, 3.0));
                [out[0].to_array()[3], out[1].to_array()[3], out[2].to_array()[3], out[3].to_array()[3]]
            });
            assert_eq!(out, [0.75, 0.25, 0.5, 0.25]);
            let out = dispatch!(level, simd => {
                let secondary = [splat(simd, 0.5), splat(simd, 0.25), splat(simd, 0.0)];
                let out = color_sum(splat_rgba(simd, [0.75, 0.5, 0.5, 0.25]), &secondary);
                [out[0].to_array()[0], out[1].to_array()[7], out[2].to_array()[3], out[3].to_array()[3]]
            });
            assert_eq!(out, [1.0, 0.75, 0.5, 0.25]);
        }
    }
}
