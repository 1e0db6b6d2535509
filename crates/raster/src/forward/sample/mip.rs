//! Level of detail: from derivatives to levels and filters.

use super::cube;
use super::fetch::interior;
use crate::forward::texture::{Filter, Sampler, Texture, TextureKind};
use crate::forward::wide::{bits_of, clamp, every, floor, mask_of, max, mix, select, splat};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Floats, Lanes, Simd};

/// Whether the level of detail can matter: otherwise any number will do.
pub(crate) fn needs_lod(texture: &Texture) -> bool {
    let Sampler { min, mag, .. } = texture.sampler;
    min != mag
}

/// The level of detail of level 0 from how many texels a step of one pixel to the right crosses in
/// each dimension, and a step up: the logarithm to base 2 of the longer step. -63 for no step at
/// all.
#[inline(always)]
pub(crate) fn lod<S: Simd>(
    du_dx: F32x8<S>,
    dv_dx: F32x8<S>,
    dw_dx: F32x8<S>,
    du_dy: F32x8<S>,
    dv_dy: F32x8<S>,
    dw_dy: F32x8<S>,
) -> F32x8<S> {
    let across = du_dx * du_dx + dv_dx * dv_dx + dw_dx * dw_dx;
    let up = du_dy * du_dy + dv_dy * dv_dy + dw_dy * dw_dy;
    half_log2(max(across, up))
}

/// The logarithm to base 2 of a step, given its squared length, to within 3e-7; exact for powers of
/// two.
#[inline(always)]
pub(crate) fn half_log2<V: Lanes>(square: V) -> V {
    let (exponent, mantissa) = max(square, square.splat(f32::MIN_POSITIVE)).split_exponent();
    // The polynomial of degree 7 without a constant that is nearest to log2(1 + t) in 0..=1. It
    // takes no division, unlike `Lanes::log2`, whose error is smaller.
    let t = mantissa - 1.0;
    let mut p = t.splat(0.015_529_888);
    for c in [-0.079_557_63, 0.194_294_19, -0.325_901_9, 0.473_553_37, -0.720_585_46, 1.442_667_8] {
        p = p * t + c;
    }
    (exponent + p * t) * 0.5
}

/// How many texels of level 0 a step to the right and a step up cross in each dimension, from the
/// derivatives of (s, t, r, q) as interpolated.
#[inline(always)]
pub(crate) fn derivatives<S: Simd>(
    simd: S,
    texture: &Texture,
    coords: [F32x8<S>; 4],
    dx: [F32x8<S>; 4],
    dy: [F32x8<S>; 4],
) -> [[F32x8<S>; 3]; 2] {
    // Take the size of level 0 without borders.
    let zero = splat(simd, 0.0);
    let dimensions = dimensions(texture.kind);
    let size = match super::fetch::level_of(texture, 0) {
        Some(level) => interior(level, dimensions),
        None => [1; 3],
    };

    // Take a cube map's derivatives on the face.
    if texture.kind == TextureKind::Cube {
        let chart = cube::Chart::new(simd, [coords[0], coords[1], coords[2]]);
        let along = [[dx[0], dx[1], dx[2]], [dy[0], dy[1], dy[2]]];
        return cube::derivatives(simd, size[0] as f32, &chart, along).map(|[s, t]| [s, t, zero]);
    }

    // Apply the quotient rule in each dimension.
    let size = if texture.kind == TextureKind::Rectangle { [1; 3] } else { size };
    let mut steps = [[zero; 3]; 2];
    for k in 0..dimensions {
        // d(s / q) = (ds - s / q * dq) / q, times the size.
        let scale = splat(simd, size[k] as f32) / coords[3];
        let projected = coords[k] / coords[3];
        steps[0][k] = (dx[k] - projected * dx[3]) * scale;
        steps[1][k] = (dy[k] - projected * dy[3]) * scale;
    }
    steps
}

/// How many coordinates a kind uses.
pub(super) fn dimensions(kind: TextureKind) -> usize {
    match kind {
        TextureKind::One => 1,
        TextureKind::Two | TextureKind::Rectangle | TextureKind::Cube => 2,
        TextureKind::Three => 3,
    }
}

/// What each lane reads.
pub(super) struct Choice<V> {
    /// Level, or the finer of two.
    pub(super) level: V,
    /// How much of the next coarser level is mixed in.
    pub(super) fraction: V,
    /// Which lanes filter linearly within a level.
    pub(super) linear: u32,
}

/// How a minification filter treats levels.
#[derive(Clone, Copy, PartialEq)]
enum Mip {
    /// Level 0 alone.
    None,
    /// The nearest level.
    Nearest,
    /// A mixture of two levels.
    Linear,
}

/// The filter within a level and between levels.
fn split(filter: Filter) -> (bool, Mip) {
    match filter {
        Filter::Nearest => (false, Mip::None),
        Filter::Linear => (true, Mip::None),
        Filter::NearestMipmapNearest => (false, Mip::Nearest),
        Filter::LinearMipmapNearest => (true, Mip::Nearest),
        Filter::NearestMipmapLinear => (false, Mip::Linear),
        Filter::LinearMipmapLinear => (true, Mip::Linear),
    }
}

/// Levels and filters for levels `0..=last`.
#[inline(always)]
pub(super) fn choose<S: Simd, V: Floats<S>>(
    simd: S,
    sampler: &Sampler,
    last: usize,
    lod: V,
) -> Choice<V> {
    // Clamp the level of detail.
    let zero = every(simd, 0.0);
    let (magnify_linear, _) = split(sampler.mag);
    let (minify_linear, mip) = split(sampler.min);
    let lod = clamp(lod, sampler.lod[0], sampler.lod[1]);

    // Where texels are larger than pixels, only level 0 is read.
    let from_nearest =
        matches!(sampler.min, Filter::NearestMipmapNearest | Filter::NearestMipmapLinear);
    let switch_over = if magnify_linear && from_nearest { 0.5 } else { 0.0 };
    let magnified = lod.simd_le(every::<S, V>(simd, switch_over));
    let linear = match (magnify_linear, minify_linear) {
        (true, true) => u32::MAX,
        (true, false) => bits_of(magnified),
        (false, true) => !bits_of(magnified),
        (false, false) => 0,
    };

    // Choose the level, and the fraction of the next one.
    let last = last as f32;
    let (level, fraction) = match mip {
        Mip::None => (zero, zero),
        // ceil(lod + 1/2) - 1: half way between two levels the finer one is read.
        Mip::Nearest => (clamp(-floor(-(lod + 0.5)) - 1.0, 0.0, last), zero),
        Mip::Linear => {
            let lod = clamp(lod, 0.0, last);
            let level = floor(lod);
            (level, lod - level)
        }
    };
    Choice {
        level: select(magnified, zero, level),
        fraction: select(magnified, zero, fraction),
        linear,
    }
}

/// Mixes what `lookup(level, linear, lanes)` yields on the levels that the active lanes call for.
#[inline(always)]
pub(super) fn mipped<S: Simd, const N: usize>(
    simd: S,
    texture: &Texture,
    lod: F32x8<S>,
    active: u32,
    lookup: impl Fn(usize, bool, u32) -> [F32x8<S>; N],
) -> [F32x8<S>; N] {
    // Without mipmaps every lane reads level 0.
    if !needs_lod(texture) {
        return lookup(0, texture.sampler.mag == Filter::Linear, active);
    }

    // Choose levels and filters for all lanes.
    let last = texture.faces.first().map_or(0, Vec::len).saturating_sub(1);
    let choice = choose(simd, &texture.sampler, last, lod);
    let levels = choice.level.to_array();
    let between = bits_of(choice.fraction.simd_gt(splat(simd, 0.0)));

    // Visit groups of lanes that read the same levels.
    let mut result = [splat(simd, 0.0); N];
    let mut rest = active & 0xff;
    while rest != 0 {
        // Take all lanes that read what the first one reads.
        let first = rest.trailing_zeros() as usize;
        let level = levels[first];
        let linear = choice.linear >> first & 1 == 1;
        let same_filter = if linear { choice.linear } else { !choice.linear };
        let group =
            bits_of(choice.level.simd_eq(splat(simd, level))) & same_filter & rest | 1 << first;

        // Look one level up, or two and mix them.
        let level = level as usize;
        let mut color = [splat(simd, 0.0); N];
        let steps = if group & between == 0 { 1 } else { 2 };
        for step in 0..steps {
            let texel = lookup((level + step).min(last), linear, group);
            for k in 0..N {
                color[k] =
                    if step == 0 { texel[k] } else { mix(color[k], texel[k], choice.fraction) };
            }
        }

        // Keep the lanes of the group.
        if group == active & 0xff {
            return color;
        }
        let counts = mask_of(simd, group);
        for k in 0..N {
            result[k] = select(counts, color[k], result[k]);
        }
        rest &= !group;
    }
    result
}

/// All components mixed alike.
#[inline(always)]
pub(super) fn mix_rgba<V: Lanes>(a: [V; 4], b: [V; 4], t: V) -> [V; 4] {
    [mix(a[0], b[0], t), mix(a[1], b[1], t), mix(a[2], b[2], t), mix(a[3], b[3], t)]
}
