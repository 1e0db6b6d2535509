//! The `COMBINE` environment: functions of up to three arguments, for colour and alpha.

use super::UNITS;
use crate::forward::state::{Combine, CombineFunction, CombineOperand, CombineSource, Unit};
use vitral_math::lanes::{Floats, Lanes, Simd};

/// What sources are taken from.
struct Sources<'a, V> {
    unit: &'a Unit,
    textures: &'a [[V; 4]; UNITS],
    primary: &'a [V; 4],
    previous: &'a [V; 4],
}

/// The combined colour, scaled.
#[inline(never)]
pub(super) fn combine<S: Simd, V: Floats<S>>(
    simd: S,
    state: &Combine,
    unit: &Unit,
    textures: &[[V; 4]; UNITS],
    primary: &[V; 4],
    previous: &[V; 4],
) -> [V; 4] {
    simd.vectorize(
        #[inline(always)]
        || {
            // Fetch the operands and apply the colour function.
            let sources = Sources { unit, textures, primary, previous };
            let [color_scale, alpha_scale] = state.scale;
            let a = [
                sources.color(state.rgb[0]),
                sources.color(state.rgb[1]),
                sources.color(state.rgb[2]),
            ];
            let color = match state.functions[0] {
                CombineFunction::Dot3Rgb | CombineFunction::Dot3Rgba => [dot3(&a[0], &a[1]); 3],
                function => [
                    component(function, a[0][0], a[1][0], a[2][0]),
                    component(function, a[0][1], a[1][1], a[2][1]),
                    component(function, a[0][2], a[1][2], a[2][2]),
                ],
            };

            // Apply the function of alpha.
            let alpha = if state.functions[0] == CombineFunction::Dot3Rgba {
                // The dot product is alpha too; alpha's own function does not count.
                color[0] * alpha_scale
            } else {
                let b = [
                    sources.alpha(state.alpha[0]),
                    sources.alpha(state.alpha[1]),
                    sources.alpha(state.alpha[2]),
                ];
                component(state.functions[1], b[0], b[1], b[2]) * alpha_scale
            };

            // Scale the result.
            [color[0] * color_scale, color[1] * color_scale, color[2] * color_scale, alpha]
        },
    )
}

impl<V: Lanes> Sources<'_, V> {
    #[inline(always)]
    fn source(&self, source: CombineSource) -> [V; 4] {
        match source {
            CombineSource::Texture => self.textures[self.unit.index % UNITS],
            CombineSource::TextureUnit(unit) => self.textures[unit % UNITS],
            CombineSource::Constant => self.unit.color.map(|c| self.previous[0].splat(c)),
            CombineSource::PrimaryColor => *self.primary,
            CombineSource::Previous => *self.previous,
            CombineSource::Zero => [self.previous[0].splat(0.0); 4],
            CombineSource::One => [self.previous[0].splat(1.0); 4],
        }
    }

    /// An argument of the colour function.
    #[inline(always)]
    fn color(&self, (source, operand): (CombineSource, CombineOperand)) -> [V; 3] {
        let [r, g, b, a] = self.source(source);
        let one = self.previous[0].splat(1.0);
        match operand {
            CombineOperand::Color => [r, g, b],
            CombineOperand::OneMinusColor => [one - r, one - g, one - b],
            CombineOperand::Alpha => [a; 3],
            CombineOperand::OneMinusAlpha => [one - a; 3],
        }
    }

    /// An argument of the alpha function, whose operands can only mean alpha.
    #[inline(always)]
    fn alpha(&self, (source, operand): (CombineSource, CombineOperand)) -> V {
        let a = self.source(source)[3];
        match operand {
            CombineOperand::Color | CombineOperand::Alpha => a,
            CombineOperand::OneMinusColor | CombineOperand::OneMinusAlpha => {
                self.previous[0].splat(1.0) - a
            }
        }
    }
}

/// One component of all functions but the dot products, which alpha does not have: they keep the
/// first argument.
#[inline(always)]
fn component<V: Lanes>(function: CombineFunction, a: V, b: V, c: V) -> V {
    match function {
        CombineFunction::Replace | CombineFunction::Dot3Rgb | CombineFunction::Dot3Rgba => a,
        CombineFunction::Modulate => a * b,
        CombineFunction::Add => a + b,
        CombineFunction::AddSigned => a + b - 0.5,
        CombineFunction::Interpolate => a * c + b * (a.splat(1.0) - c),
        CombineFunction::Subtract => a - b,
        CombineFunction::ModulateAdd => a * c + b,
        CombineFunction::ModulateSignedAdd => a * c + b - 0.5,
        CombineFunction::ModulateSubtract => a * c - b,
    }
}

/// `4 (a - 1/2) . (b - 1/2)`: colours as vectors.
#[inline(always)]
fn dot3<V: Lanes>(a: &[V; 3], b: &[V; 3]) -> V {
    ((a[0] - 0.5) * (b[0] - 0.5) + (a[1] - 0.5) * (b[1] - 0.5) + (a[2] - 0.5) * (b[2] - 0.5)) * 4.0
}
