//! What textures do to a fragment's colour: the texture environment of each unit, then colour sum
//! and fog.
//!
//! Source: OpenGL 1.5 specification, sections 3.8.13 (tables 3.22 to 3.24), 3.9 and 3.10.

mod combine;
pub(crate) mod fog;

use super::state::{EnvironmentMode, Unit};
use super::texture::{BaseFormat, Texture};
use super::wide::{mix, saturate_rgba};
use vitral_math::lanes::{Floats, Lanes, Simd};

/// How many texture units there are.
pub(crate) const UNITS: usize = 8;

/// The colour after `unit`, brought into `0..=1` if it `clamps`: `textures` are the texture colours
/// of all units by their index, `primary` is the colour before the first unit, `previous` the one
/// before this unit.
#[inline(always)]
pub(crate) fn environment<S: Simd, V: Floats<S>>(
    simd: S,
    unit: &Unit,
    textures: &[[V; 4]; UNITS],
    primary: &[V; 4],
    previous: [V; 4],
    clamps: bool,
) -> [V; 4] {
    let texture = &textures[unit.index % UNITS];
    let color = match &unit.mode {
        EnvironmentMode::Modulate => product(format_of(&unit.texture), texture, previous),
        EnvironmentMode::Combine(state) => {
            combine::combine(simd, state, unit, textures, primary, &previous)
        }
        mode => simple(simd, mode, format_of(&unit.texture), unit.color, texture, previous),
    };
    if clamps { saturate_rgba(color) } else { color }
}

/// The base format that decides: that of a depth texture is what its mode turns depths into.
#[inline(always)]
pub(crate) fn format_of(texture: &Texture) -> BaseFormat {
    if texture.format == BaseFormat::Depth { texture.depth_mode } else { texture.format }
}

/// Whether a format changes the colour, whether it changes alpha.
#[inline(always)]
fn parts(format: BaseFormat) -> (bool, bool) {
    let has_color = format != BaseFormat::Alpha;
    let has_alpha = !matches!(format, BaseFormat::Luminance | BaseFormat::Rgb | BaseFormat::Depth);
    (has_color, has_alpha)
}

/// `color` of the format's parts, `previous` of the others.
#[inline(always)]
fn keep_other_parts<V: Lanes>(format: BaseFormat, color: [V; 4], previous: [V; 4]) -> [V; 4] {
    let (has_color, has_alpha) = parts(format);
    let [r, g, b, _] = if has_color { color } else { previous };
    [r, g, b, if has_alpha { color[3] } else { previous[3] }]
}

/// `MODULATE`, the mode that nearly all programs use, clamped.
#[inline(always)]
pub(crate) fn modulate<V: Lanes>(format: BaseFormat, t: &[V; 4], p: [V; 4]) -> [V; 4] {
    saturate_rgba(product(format, t, p))
}

#[inline(always)]
fn product<V: Lanes>(format: BaseFormat, t: &[V; 4], p: [V; 4]) -> [V; 4] {
    keep_other_parts(format, [p[0] * t[0], p[1] * t[1], p[2] * t[2], p[3] * t[3]], p)
}

/// The other modes of OpenGL 1.1 and 1.3: `c` is the environment colour.
#[inline(never)]
fn simple<S: Simd, V: Floats<S>>(
    simd: S,
    mode: &EnvironmentMode,
    format: BaseFormat,
    c: [f32; 4],
    t: &[V; 4],
    p: [V; 4],
) -> [V; 4] {
    simd.vectorize(
        #[inline(always)]
        || {
            // Apply the mode, then keep the components that the texture's format lacks.
            let intensity = format == BaseFormat::Intensity;
            let color = match mode {
                EnvironmentMode::Replace => *t,
                EnvironmentMode::Decal => decal(format, t, p),
                EnvironmentMode::Blend => blend(c, intensity, t, p),
                EnvironmentMode::Add => {
                    let alpha = if intensity { p[3] + t[3] } else { p[3] * t[3] };
                    [p[0] + t[0], p[1] + t[1], p[2] + t[2], alpha]
                }
                EnvironmentMode::Modulate | EnvironmentMode::Combine(_) => p,
            };
            keep_other_parts(format, color, p)
        },
    )
}

/// `DECAL`: the specification leaves other formats than RGB and RGBA open; here they change
/// nothing.
#[inline(always)]
fn decal<V: Lanes>(format: BaseFormat, t: &[V; 4], p: [V; 4]) -> [V; 4] {
    match format {
        BaseFormat::Rgb => [t[0], t[1], t[2], p[3]],
        BaseFormat::Rgba => {
            [mix(p[0], t[0], t[3]), mix(p[1], t[1], t[3]), mix(p[2], t[2], t[3]), p[3]]
        }
        _ => p,
    }
}

/// `BLEND`: the texture mixes the colour with the constant.
#[inline(always)]
fn blend<V: Lanes>(c: [f32; 4], intensity: bool, t: &[V; 4], p: [V; 4]) -> [V; 4] {
    let (c, one) = (c.map(|c| p[0].splat(c)), p[0].splat(1.0));
    let alpha = if intensity { p[3] * (one - t[3]) + c[3] * t[3] } else { p[3] * t[3] };
    [
        p[0] * (one - t[0]) + c[0] * t[0],
        p[1] * (one - t[1]) + c[1] * t[1],
        p[2] * (one - t[2]) + c[2] * t[2],
        alpha,
    ]
}

#[cfg(test)]
mod tests;
