//! Vertices to the screen, eight at a time: clip position, outcode, division, viewport, snap.

use crate::geometry::{ScreenVertex, ViewportTransform, flag};
use vitral_math::Mat4;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, I32x8, LANES, Level, Simd, U32x8, dispatch};

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
        let [x, y, z] = [0, 1, 2].map(|k| F32x8::from_slice(simd, &soa[k]));
        let row = |r: usize| x * m[r] + y * m[4 + r] + z * m[8 + r] + m[12 + r];
        let (sx, sy, depth, flags) = project(simd, [row(0), row(1), row(2), row(3)], viewport);
        let (sx, sy, depth, flags) = (sx.to_array(), sy.to_array(), depth.to_array(), flags.to_array());
        for lane in 0..o.len() {
            o[lane] = ScreenVertex { x: sx[lane], y: sy[lane], z: depth[lane], flags: flags[lane] };
        }
    }
}

/// From clip space to snapped screen coordinates, depth and flags.
#[inline(always)]
fn project<S: Simd>(
    simd: S,
    [x, y, z, w]: [F32x8<S>; 4],
    viewport: &ViewportTransform,
) -> (I32x8<S>, I32x8<S>, F32x8<S>, U32x8<S>) {
    let zero = F32x8::splat(simd, 0.0);
    let bit =
        |mask: vitral_math::lanes::Mask8<S>, bit: u32| mask.select(U32x8::splat(simd, bit), U32x8::splat(simd, 0));

    // Mark what is outside. Comparisons are written so that NaN counts as outside.
    let outside = bit(!x.simd_ge(-w), flag::LEFT)
        | bit(!x.simd_le(w), flag::RIGHT)
        | bit(!y.simd_ge(-w), flag::BOTTOM)
        | bit(!y.simd_le(w), flag::TOP)
        | bit(!z.simd_ge(zero), flag::FAR)
        | bit(!z.simd_le(w), flag::NEAR);
    let (gx, gy) = (w * viewport.guard.x, w * viewport.guard.y);
    let in_band = x.simd_ge(-gx) & x.simd_le(gx) & y.simd_ge(-gy) & y.simd_le(gy) & z.simd_ge(zero) & z.simd_le(w);
    let in_band = in_band & w.simd_gt(zero);
    // 0 x is 0 for finite numbers only.
    let finite = (x * 0.0 + y * 0.0 + z * 0.0 + w * 0.0).simd_eq(zero);
    let flags = outside | bit(!in_band, flag::CLIP) | bit(!finite, flag::NOT_FINITE);

    // Divide and snap; lanes that will be clipped get harmless numbers.
    let safe_w = in_band.select(w, F32x8::splat(simd, 1.0));
    let (nx, ny, depth) = (x / safe_w, y / safe_w, z / safe_w);
    let sx = (nx * viewport.scale.x + viewport.center.x) + 0.5;
    let sy = (ny * viewport.scale.y + viewport.center.y) + 0.5;
    let whole = |v: F32x8<S>| -> I32x8<S> { in_band.select(v.floor(), zero).to_int() };
    (whole(sx), whole(sy), depth, flags)
}
