//! Anisotropic filtering: a long footprint is covered by several lookups in a row.
//!
//! A pixel's footprint in the texture is about as long as the longer derivative and as wide as the
//! shorter one. Probes of the width's level of detail along the longer side, averaged, blur less
//! than one lookup of the length's level.
//!
//! Source: EXT_texture_filter_anisotropic.

use super::fetch::{interior, level_of};
use super::mip::{dimensions, lod};
use super::sample;
use crate::forward::plane::DepthBuffer;
use crate::forward::texture::{Texture, TextureKind};
use crate::forward::wide::{Rgba, bits_of, clamp, mask_of, max, min, select, splat, splat_rgba};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Simd};

/// Most probes a lookup.
const MOST_PROBES: f32 = 16.0;

/// As [`sample`], but with the derivatives in texels (see [`super::mip::derivatives`]) and the bias
/// instead of the level of detail, and with as many probes as `sampler.anisotropy` allows. Only
/// textures of two dimensions take more than one.
#[inline(never)]
pub(crate) fn sample_anisotropic<S: Simd>(
    simd: S,
    (texture, plane): (&Texture, Option<&DepthBuffer>),
    coords: [F32x8<S>; 4],
    derivatives: [[F32x8<S>; 3]; 2],
    bias: F32x8<S>,
    active: u32,
) -> Rgba<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            // Find the size by which derivatives are scaled; other kinds take one isotropic sample.
            let [dx, dy] = derivatives;
            let size = match (texture.kind, level_of(texture, 0)) {
                (TextureKind::Two, Some(level)) => interior(level, dimensions(texture.kind)),
                (TextureKind::Rectangle, Some(_)) => [1; 3],
                _ => {
                    let lod = lod(dx[0], dx[1], dx[2], dy[0], dy[1], dy[2]);
                    return sample(simd, texture, plane, coords, lod + bias, active);
                }
            };

            // Choose the number of probes and their level from the footprint.
            let footprint = Footprint::new(simd, dx, dy, texture.sampler.anisotropy);
            let detail = lanes::Lanes::log2(footprint.length / footprint.probes) + bias;
            let [s, t, r, q] = coords;
            let (s, t, r) = (s / q, t / q, r / q);
            let one = splat(simd, 1.0);
            let (step_s, step_t) =
                (footprint.along[0] / size[0] as f32, footprint.along[1] / size[1] as f32);

            // Probe i of n lies at i / (n + 1) - 1/2 of the footprint's length from its middle.
            let mut sum = splat_rgba(simd, [0.0; 4]);
            let mut i = 1.0f32;
            loop {
                let lanes = bits_of(footprint.probes.simd_ge(splat(simd, i))) & active;
                if lanes == 0 {
                    break;
                }
                let at = splat(simd, i) / (footprint.probes + 1.0) - 0.5;
                let color = sample(
                    simd,
                    texture,
                    plane,
                    [s + step_s * at, t + step_t * at, r, one],
                    detail,
                    lanes,
                );
                let counts = mask_of(simd, lanes);
                for k in 0..4 {
                    sum[k] = select(counts, sum[k] + color[k], sum[k]);
                }
                i += 1.0;
            }

            // Average the probes.
            let n = footprint.probes;
            [sum[0] / n, sum[1] / n, sum[2] / n, sum[3] / n]
        },
    )
}

/// The pixel's footprint.
struct Footprint<S: Simd> {
    /// Its longer side in texels.
    along: [F32x8<S>; 2],
    /// How long that is.
    length: F32x8<S>,
    /// How many probes cover it, whole and at least 1.
    probes: F32x8<S>,
}

impl<S: Simd> Footprint<S> {
    #[inline(always)]
    fn new(simd: S, dx: [F32x8<S>; 3], dy: [F32x8<S>; 3], anisotropy: f32) -> Self {
        let (one, zero) = (splat(simd, 1.0), splat(simd, 0.0));
        let across = lanes::Lanes::sqrt(dx[0] * dx[0] + dx[1] * dx[1]);
        let up = lanes::Lanes::sqrt(dy[0] * dy[0] + dy[1] * dy[1]);
        let (length, width) = (max(across, up), min(across, up));
        let x_longer = across.simd_ge(up);
        let along = [select(x_longer, dx[0], dy[0]), select(x_longer, dx[1], dy[1])];
        let most = if anisotropy > 1.0 { anisotropy.min(MOST_PROBES).floor() } else { 1.0 };
        // Whole number not below length / width; a magnified texture needs one probe.
        let ratio = max(length, zero) / max(width, splat(simd, f32::MIN_POSITIVE));
        let probes = -lanes::Lanes::floor(-clamp(ratio, 1.0, most));
        Self { along, length, probes: select(length.simd_gt(one), probes, one) }
    }
}
