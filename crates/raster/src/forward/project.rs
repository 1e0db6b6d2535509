//! Clip space to window space, eight vertices at a time or one.

use crate::kernel::transform::{bit, whole};
use crate::screen::{RESIDUE, ScreenVertex, flag};
use crate::setup::{CornerPosition, DepthPlane};
use crate::{GUARD_BAND, SUBPIXEL};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Level, Mask8, Simd, U32x8, dispatch};

/// The viewport and depth range as a map from normalised device coordinates. Row 0 is the lowest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowTransform {
    /// Half the viewport's size, pixels.
    pub scale: [f32; 2],
    /// Its centre, pixels.
    pub center: [f32; 2],
    /// Window depth = `ndc * z_scale + z_center`.
    pub z_scale: f32,
    /// See `z_scale`.
    pub z_center: f32,
    /// Depth of the near plane in normalised device coordinates: -1, or 0 with `ZERO_TO_ONE`.
    pub near: f32,
    /// Where the guard band ends: lowest and highest x, y in normalised device coordinates. The
    /// band holds the target, not always the viewport.
    pub guard: [[f32; 2]; 2],
}

impl WindowTransform {
    /// For a viewport `x, y, width, height`, depth range `near, far`, and whether clip depth runs
    /// from 0 to 1, and whether y points down (`UPPER_LEFT`).
    pub fn new(
        [x, y, w, h]: [i32; 4],
        [near, far]: [f64; 2],
        zero_to_one: bool,
        upper_left: bool,
    ) -> Self {
        let half = [w as f32 * 0.5, h as f32 * 0.5];
        let scale = [half[0], if upper_left { -half[1] } else { half[1] }];
        let (z_scale, z_center, ndc_near) = if zero_to_one {
            ((far - near) as f32, near as f32, 0.0)
        } else {
            (((far - near) * 0.5) as f32, ((far + near) * 0.5) as f32, -1.0)
        };
        let center = [x as f32 + half[0], y as f32 + half[1]];
        let band = |k: usize| {
            let ends = [(-GUARD_BAND - center[k]) / scale[k], (GUARD_BAND - center[k]) / scale[k]];
            [ends[0].min(ends[1]), ends[0].max(ends[1])]
        };
        Self { scale, center, z_scale, z_center, near: ndc_near, guard: [band(0), band(1)] }
    }

    /// Projects and snaps a clipped point. Rounding of very large numbers may have left it outside
    /// the guard band.
    pub fn project(&self, clip: [f32; 4]) -> CornerPosition {
        let [x, y, z] = self.project_exact(clip);
        let snapped =
            |v: f32| (v.clamp(-GUARD_BAND, GUARD_BAND) * SUBPIXEL as f32 + 0.5).floor() as i32;
        CornerPosition { x: snapped(x), y: snapped(y), z }
    }

    /// Window x and y in pixels, and depth, of a point with `w > 0`.
    pub fn project_exact(&self, clip: [f32; 4]) -> [f32; 3] {
        let [x, y, z] = self.project_beyond(clip);
        [x, y, z.clamp(0.0, 1.0)]
    }

    /// The same for a point before the near or behind the far plane, whose depth lies beyond the
    /// depth range.
    pub(crate) fn project_beyond(&self, clip: [f32; 4]) -> [f32; 3] {
        let w = clip[3];
        [
            clip[0] / w * self.scale[0] + self.center[0],
            clip[1] / w * self.scale[1] + self.center[1],
            clip[2] / w * self.z_scale + self.z_center,
        ]
    }

    /// The lower and the higher end of the depth range.
    pub(crate) fn depth_range(&self) -> [f32; 2] {
        let ends = [self.near * self.z_scale + self.z_center, self.z_scale + self.z_center];
        [ends[0].min(ends[1]).clamp(0.0, 1.0), ends[0].max(ends[1]).clamp(0.0, 1.0)]
    }

    /// The depth plane of the triangle with these corners in clip space, wherever they are: depth
    /// is `a x + b y + c w` for all three, before any of them is divided. `origin` is in 1/256
    /// pixel. `None` if the triangle is seen edge on.
    pub(crate) fn homogeneous_plane(
        &self,
        corners: [[f32; 4]; 3],
        origin: [i32; 2],
    ) -> Option<DepthPlane> {
        // Solve for the plane's coefficients by Cramer's rule.
        let [p, q, r] = corners.map(|c| c.map(f64::from));
        let column = |k: usize| [p[k], q[k], r[k]];
        let determinant = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        let [x, y, z, w] = [column(0), column(1), column(2), column(3)];
        let all = determinant(x, y, w);
        let factors =
            [determinant(z, y, w) / all, determinant(x, z, w) / all, determinant(x, y, z) / all];
        if !factors.iter().all(|f| f.is_finite()) {
            return None;
        }

        // Transform the plane to the window.
        let slope = |k: usize| factors[k] * f64::from(self.z_scale) / f64::from(self.scale[k]);
        let from_center =
            |k: usize| f64::from(origin[k]) / f64::from(SUBPIXEL) - f64::from(self.center[k]);
        let depth = slope(0) * from_center(0)
            + slope(1) * from_center(1)
            + factors[2] * f64::from(self.z_scale)
            + f64::from(self.z_center);
        // Far beyond the range one number is as good as another, and these do not overflow.
        let held = |v: f64| v.clamp(-1e20, 1e20) as f32;
        let [z_min, z_max] = self.depth_range();
        Some(DepthPlane {
            z: held(depth),
            dz_dx: held(slope(0)),
            dz_dy: held(slope(1)),
            origin,
            z_min,
            z_max,
        })
    }
}

/// `matrix * position` for each position (column-major, clip space), and the same in the window.
///
/// # Panics
/// If the lengths differ.
pub fn project(
    level: Level,
    positions: &[[f32; 4]],
    matrix: &[f32; 16],
    window: &WindowTransform,
    clip: &mut [[f32; 4]],
    screen: &mut [ScreenVertex],
) {
    assert!(
        positions.len() == clip.len() && positions.len() == screen.len(),
        "one result for each position"
    );
    dispatch!(level, simd => project_all(simd, positions, matrix, window, clip, screen));
}

#[inline(always)]
fn project_all<S: Simd>(
    simd: S,
    positions: &[[f32; 4]],
    m: &[f32; 16],
    window: &WindowTransform,
    clip: &mut [[f32; 4]],
    screen: &mut [ScreenVertex],
) {
    let ((eights, rest), (clips, last_clips)) = (positions.as_chunks(), clip.as_chunks_mut());
    let (screens, last_screens) = screen.as_chunks_mut();
    for ((p, clip), screen) in eights.iter().zip(clips).zip(screens) {
        project_eight(simd, p, m, window, clip, screen);
    }
    if let Some(first) = rest.first() {
        let mut eight = [*first; LANES];
        eight[..rest.len()].copy_from_slice(rest);
        let (mut clip, mut screen) = ([[0.0; 4]; LANES], [ScreenVertex::default(); LANES]);
        project_eight(simd, &eight, m, window, &mut clip, &mut screen);
        last_clips.copy_from_slice(&clip[..rest.len()]);
        last_screens.copy_from_slice(&screen[..rest.len()]);
    }
}

#[inline(always)]
fn project_eight<S: Simd>(
    simd: S,
    p: &[[f32; 4]; LANES],
    m: &[f32; 16],
    window: &WindowTransform,
    clip: &mut [[f32; 4]; LANES],
    screen: &mut [ScreenVertex; LANES],
) {
    // Transform eight points to clip space.
    let columns = lanes::columns_of_rows(
        simd,
        #[inline(always)]
        |lane| bytemuck::cast(p[lane]),
    );
    let [x, y, z, w]: [F32x8<S>; 4] =
        [columns[0].bitcast(), columns[1].bitcast(), columns[2].bitcast(), columns[3].bitcast()];
    let c = [
        x * m[0] + y * m[4] + z * m[8] + w * m[12],
        x * m[1] + y * m[5] + z * m[9] + w * m[13],
        x * m[2] + y * m[6] + z * m[10] + w * m[14],
        x * m[3] + y * m[7] + z * m[11] + w * m[15],
    ];

    // Project them to the window.
    let (sx, sy, depth, flags) = to_window(simd, c, window);

    // Store both, one row for each vertex.
    lanes::rows_of_columns(
        simd,
        [c[0].bitcast(), c[1].bitcast(), c[2].bitcast(), c[3].bitcast()],
        #[inline(always)]
        |lane, row| clip[lane] = bytemuck::cast(row),
    );
    lanes::rows_of_columns(
        simd,
        [sx, sy, depth.bitcast(), flags.bitcast()],
        #[inline(always)]
        |lane, row| screen[lane] = bytemuck::cast(row),
    );
}

/// From clip space to snapped window coordinates, depth and flags.
#[inline(always)]
fn to_window<S: Simd>(
    simd: S,
    [x, y, z, w]: [F32x8<S>; 4],
    window: &WindowTransform,
) -> (I32x8<S>, I32x8<S>, F32x8<S>, U32x8<S>) {
    let (zero, one) = (F32x8::splat(simd, 0.0), F32x8::splat(simd, 1.0));
    let near = w * window.near;

    // Mark what is outside. Comparisons are written so that NaN counts as outside.
    let outside = bit(simd, !x.simd_ge(-w), flag::LEFT)
        | bit(simd, !x.simd_le(w), flag::RIGHT)
        | bit(simd, !y.simd_ge(-w), flag::BOTTOM)
        | bit(simd, !y.simd_le(w), flag::TOP)
        | bit(simd, !z.simd_ge(near), flag::FAR)
        | bit(simd, !z.simd_le(w), flag::NEAR);
    let [[x0, x1], [y0, y1]] = window.guard;
    let in_band = x.simd_ge(w * x0) & x.simd_le(w * x1) & y.simd_ge(w * y0) & y.simd_le(w * y1);
    let in_band = in_band & z.simd_ge(near) & z.simd_le(w);
    let in_band = in_band & w.simd_gt(F32x8::splat(simd, 1e-30));
    // 0 x is 0 for finite numbers only.
    let finite = (x * 0.0 + y * 0.0 + z * 0.0 + w * 0.0).simd_eq(zero);
    let flags = outside | bit(simd, !in_band, flag::CLIP) | bit(simd, !finite, flag::NOT_FINITE);

    // Divide and snap; lanes that will be clipped get harmless numbers. The order of operations is
    // `project_exact`'s.
    let safe_w = in_band.select(w, one);
    let sx = x / safe_w * window.scale[0] + window.center[0];
    let sy = y / safe_w * window.scale[1] + window.center[1];
    let sz = z / safe_w * window.z_scale + window.z_center;
    let sz = lanes::Lanes::saturate(sz);
    let (gx, gy) = (sx * SUBPIXEL as f32 + 0.5, sy * SUBPIXEL as f32 + 0.5);
    (whole(in_band, gx), whole(in_band, gy), sz, flags | residues(in_band, gx, gy))
}

/// The remainder of places on the grid, half a step to the right and below, when they are snapped:
/// as the bits of flags.
#[inline(always)]
fn residues<S: Simd>(in_band: Mask8<S>, x: F32x8<S>, y: F32x8<S>) -> U32x8<S> {
    let kept = lanes::inlined(
        #[inline(always)]
        |v: F32x8<S>| -> U32x8<S> {
            // A place just below a step may be rounded to a whole one.
            let most = F32x8::splat(in_band.token(), 1.0 / RESIDUE - 1.0);
            let kept = lanes::Lanes::min((v - v.floor()) * (1.0 / RESIDUE), most);
            whole(in_band, kept).bitcast()
        },
    );
    // Half a step is in them: to take it off is to turn the highest bit over.
    let halves =
        in_band.select(U32x8::splat(in_band.token(), HALVES), U32x8::splat(in_band.token(), 0));
    (kept(x) << flag::RESIDUE_X | kept(y) << flag::RESIDUE_Y) ^ halves
}

/// Half a step in both residues.
const HALVES: u32 = (1 << flag::RESIDUE_X | 1 << flag::RESIDUE_Y) << (flag::RESIDUE_BITS - 1);
