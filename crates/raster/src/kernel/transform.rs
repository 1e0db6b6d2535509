//! Vertices to the screen, eight at a time: clip position, outcode, division, viewport, snap.

use crate::screen::{ScreenVertex, ViewportTransform, flag};
use vitral_math::Mat4;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, I32x8, LANES, Level, Mask8, Simd, U32x8, dispatch};

/// Transforms `positions` (model space) by `clip_from_model` into `out`, which has the same length.
///
/// # Panics
/// If the lengths differ.
pub fn transform(
    level: Level,
    positions: &[[f32; 3]],
    clip_from_model: &Mat4,
    viewport: &ViewportTransform,
    out: &mut [ScreenVertex],
) {
    assert_eq!(positions.len(), out.len(), "one screen vertex for each position");
    dispatch!(level, simd => transform_all(simd, positions, clip_from_model, viewport, out));
}

#[inline(always)]
fn transform_all<S: Simd>(
    simd: S,
    positions: &[[f32; 3]],
    clip_from_model: &Mat4,
    viewport: &ViewportTransform,
    out: &mut [ScreenVertex],
) {
    let m = clip_from_model.to_cols_array();
    for (p, o) in positions.chunks(LANES).zip(out.chunks_mut(LANES)) {
        // Load a structure of arrays; a short last chunk repeats its first vertex.
        let mut soa = [[0.0f32; LANES]; 3];
        for lane in 0..LANES {
            let v = if lane < p.len() { p[lane] } else { p[0] };
            for k in 0..3 {
                soa[k][lane] = v[k];
            }
        }
        let p = [load(simd, &soa[0]), load(simd, &soa[1]), load(simd, &soa[2])];
        let clip = [row(p, &m, 0), row(p, &m, 1), row(p, &m, 2), row(p, &m, 3)];
        let (sx, sy, depth, flags) = project(simd, clip, viewport);
        let (sx, sy, depth, flags) =
            (sx.to_array(), sy.to_array(), depth.to_array(), flags.to_array());
        for lane in 0..o.len() {
            o[lane] = ScreenVertex { x: sx[lane], y: sy[lane], z: depth[lane], flags: flags[lane] };
        }
    }
}

#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, lanes: &[f32; LANES]) -> F32x8<S> {
    F32x8::from_slice(simd, lanes)
}

/// Row `r` of the column-major matrix `m` times `(p, 1)`.
#[inline(always)]
fn row<S: Simd>(p: [F32x8<S>; 3], m: &[f32; 16], r: usize) -> F32x8<S> {
    p[0] * m[r] + p[1] * m[4 + r] + p[2] * m[8 + r] + m[12 + r]
}

/// `bit` where the mask is true, else 0.
#[inline(always)]
pub(crate) fn bit<S: Simd>(simd: S, mask: Mask8<S>, bit: u32) -> U32x8<S> {
    mask.select(U32x8::splat(simd, bit), U32x8::splat(simd, 0))
}

/// The whole part of `v` where the mask is true, else 0.
#[inline(always)]
pub(crate) fn whole<S: Simd>(mask: Mask8<S>, v: F32x8<S>) -> I32x8<S> {
    mask.select(v.floor(), F32x8::splat(mask.token(), 0.0)).to_int()
}

/// From clip space to snapped screen coordinates, depth and flags.
#[inline(always)]
fn project<S: Simd>(
    simd: S,
    [x, y, z, w]: [F32x8<S>; 4],
    viewport: &ViewportTransform,
) -> (I32x8<S>, I32x8<S>, F32x8<S>, U32x8<S>) {
    let zero = F32x8::splat(simd, 0.0);

    // Mark what is outside. Comparisons are written so that NaN counts as outside.
    let outside = bit(simd, !x.simd_ge(-w), flag::LEFT)
        | bit(simd, !x.simd_le(w), flag::RIGHT)
        | bit(simd, !y.simd_ge(-w), flag::BOTTOM)
        | bit(simd, !y.simd_le(w), flag::TOP)
        | bit(simd, !z.simd_ge(zero), flag::FAR)
        | bit(simd, !z.simd_le(w), flag::NEAR);
    let (gx, gy) = (w * viewport.guard.x, w * viewport.guard.y);
    let in_band = x.simd_ge(-gx)
        & x.simd_le(gx)
        & y.simd_ge(-gy)
        & y.simd_le(gy)
        & z.simd_ge(zero)
        & z.simd_le(w);
    let in_band = in_band & w.simd_gt(zero);
    // 0 x is 0 for finite numbers only.
    let finite = (x * 0.0 + y * 0.0 + z * 0.0 + w * 0.0).simd_eq(zero);
    let flags = outside | bit(simd, !in_band, flag::CLIP) | bit(simd, !finite, flag::NOT_FINITE);

    // Divide and snap; lanes that will be clipped get harmless numbers.
    let safe_w = in_band.select(w, F32x8::splat(simd, 1.0));
    let (nx, ny, depth) = (x / safe_w, y / safe_w, z / safe_w);
    let sx = (nx * viewport.scale.x + viewport.center.x) + 0.5;
    let sy = (ny * viewport.scale.y + viewport.center.y) + 0.5;
    (whole(in_band, sx), whole(in_band, sy), depth, flags)
}
