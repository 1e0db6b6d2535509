//! The light of a tile's points, and how light and rays go on from them.

use super::FrameConstants;
use super::geometry::F;
use super::material_constants::MaterialConstants;
use crate::shadow::SurfacePoint;
use vitral_light::{Reflected, Rgb};
use vitral_math::DVec3;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, Lanes, Simd, V3};

/// The light of a tile's points, in the space in which pictures are composed.
#[derive(Default)]
pub(crate) struct ShadedPoints {
    /// Premultiplied RGBA.
    pub colors: Vec<[f32; 4]>,
    /// What passes of the light from behind; empty where that is `1 - A` in all channels.
    pub passes: Vec<[f32; 3]>,
    /// How rays go on from there; kept for materials that let them, and empty where none are
    /// followed.
    pub bounces: Vec<Bounce>,
    /// Shadow rays that were followed.
    pub shadow_rays: u64,
}

/// How rays go on from a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounce {
    /// Unit shading normal, view space.
    pub normal: [f32; 3],
    /// What the mirror image is weighed with.
    pub mirror: Rgb,
    /// The point in the world.
    pub place: SurfacePoint,
}

impl Default for Bounce {
    fn default() -> Self {
        let place = SurfacePoint {
            position: DVec3::ZERO,
            normal: DVec3::ZERO,
            facet: u32::MAX,
            seed: 0,
            pixel: None,
        };
        Self { normal: [0.0; 3], mirror: [0.0; 3], place }
    }
}

impl ShadedPoints {
    /// Makes room for `count` points.
    pub(crate) fn reset(&mut self, count: usize, constants: &FrameConstants<'_>) {
        let filtered = constants.transparency.tints();
        // Every colour is written, so old contents may stay.
        self.colors.resize(count, [0.0; 4]);
        self.passes.clear();
        self.passes.resize(if filtered { count } else { 0 }, [0.0; 3]);
        self.bounces.clear();
        self.bounces.resize(if constants.follows_rays() { count } else { 0 }, Bounce::default());
        self.shadow_rays = 0;
    }

    /// Takes the colours of up to eight points: red, green, blue, alpha.
    #[inline(always)]
    pub(super) fn put_colors<S: Simd>(&mut self, simd: S, points: &[u32], [r, g, b, a]: [F<S>; 4]) {
        lanes::rows_of_columns(
            simd,
            [r.bitcast(), g.bitcast(), b.bitcast(), a.bitcast()],
            #[inline(always)]
            |lane, row| {
                if let Some(&p) = points.get(lane) {
                    self.colors[p as usize] = bytemuck::cast(row);
                }
            },
        );
    }
}

/// What a surface reflects and shines, premultiplied.
#[inline(always)]
pub(super) fn premultiplied<T: Lanes>(
    material: &MaterialConstants<'_>,
    filtered: bool,
    reflected: &Reflected<T>,
    emitted: V3<T>,
    alpha: T,
    coverage: T,
) -> V3<T> {
    if material.blend && (filtered || material.material.glass) {
        (reflected.diffuse + emitted).scale(alpha) + reflected.specular.scale(coverage)
    } else {
        (reflected.diffuse + reflected.specular + emitted).scale(alpha)
    }
}
