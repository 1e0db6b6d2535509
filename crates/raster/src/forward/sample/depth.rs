//! Depth textures of one and two dimensions: shadow maps.
//!
//! With a comparison each texel becomes 0 or 1 before filtering, so that a linear filter gives the
//! share of the four texels that pass, by their weights.

use super::fetch::{LevelDepths, level_of};
use super::flat::{axes, corner_texels};
use super::mip::mipped;
use super::wrap::position_in;
use crate::forward::fragment_ops::compare::compare;
use crate::forward::pending::PendingDepth;
use crate::forward::plane::DepthBuffer;
use crate::forward::state::Compare;
use crate::forward::texture::{BaseFormat, Filter, Texture, TextureKind, Wrap};
use crate::forward::wide::{Rgba, every, floor, min, mix, saturate, select, splat, splat_rgba};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Floats, Lanes, Simd};

/// A shadow map of the common kind, made ready for lookups: a plane with pending triangles, one
/// texel a lookup, and a comparison that bounds of depths can settle.
#[derive(Clone, Copy)]
pub(crate) struct PackedShadow<'a> {
    texture: &'a Texture,
    pending: &'a PendingDepth,
    size: [f32; 2],
}

impl<'a> PackedShadow<'a> {
    /// `None` for textures of another kind; `plane` is that of the only level.
    pub(crate) fn new(texture: &'a Texture, plane: Option<&'a DepthBuffer>) -> Option<Self> {
        let (sampler, pending) = (&texture.sampler, plane?.pending.as_ref()?);
        let level = level_of(texture, 0)?;
        let nearest = [sampler.min, sampler.mag] == [Filter::Nearest; 2];
        let inside = sampler.wrap[..2] == [Wrap::ClampToEdge; 2] && level.border == 0;
        if texture.kind != TextureKind::Two || texture.swizzle.is_some() || !nearest || !inside {
            return None;
        }
        settles(sampler.compare, pending.sign()).then_some(())?;
        Some(Self { texture, pending, size: [level.size[0] as f32, level.size[1] as f32] })
    }

    /// The texel at coordinates s, t, r, q, and the depth that it is compared with.
    #[inline(always)]
    pub(crate) fn place<S: Simd, V: Floats<S>>(&self, simd: S, [s, t, r, q]: [V; 4]) -> [V; 3] {
        let texel = lanes::inlined(
            #[inline(always)]
            |coordinate: V, size: f32| {
                let size: V = every(simd, size);
                min(floor(position_in(simd, coordinate / q, size, Wrap::ClampToEdge)), size - 1.0)
            },
        );
        [texel(s, self.size[0]), texel(t, self.size[1]), reference(self.texture, r / q)]
    }

    /// The colours at such places.
    #[inline(always)]
    pub(crate) fn at<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        [x, y, reference]: [V; 3],
        active: u32,
    ) -> [V; 4] {
        let sign = self.pending.sign();
        let depth = if self.pending.is_clear::<S, V>(
            simd,
            [x.to_int(), y.to_int()],
            reference * sign,
            active,
        ) {
            every(simd, self.pending.best() * sign)
        } else {
            self.depth(simd, [x, y], reference, active)
        };
        let value = compared(simd, self.texture, reference, depth);
        by_mode(simd, self.texture.depth_mode, value)
    }

    /// The depths of texels, as far as they decide.
    #[inline(never)]
    fn depth<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        [x, y]: [V; 2],
        reference: V,
        active: u32,
    ) -> V {
        simd.vectorize(
            #[inline(always)]
            || {
                // Sixteen in several registers make long code.
                if lanes::has_sixteen(simd.level()) {
                    return self.pending.texels(
                        simd,
                        [x.to_int(), y.to_int()],
                        active,
                        Some(reference),
                    );
                }
                let [depth] = V::by_eights(
                    simd,
                    [x, y, reference],
                    #[inline(always)]
                    |first, [x, y, reference]| {
                        let active = active >> first & 0xff;
                        [self.pending.texels(
                            simd,
                            [x.to_int(), y.to_int()],
                            active,
                            Some(reference),
                        )]
                    },
                );
                depth
            },
        )
    }
}

/// What depths are compared with, from r or a cube's q.
#[inline(always)]
pub(super) fn reference<V: Lanes>(texture: &Texture, r: V) -> V {
    if texture.float_depth { r } else { saturate(r) }
}

/// As [`super::sample`].
#[inline(never)]
pub(super) fn sample<S: Simd>(
    simd: S,
    texture: &Texture,
    plane: Option<&DepthBuffer>,
    coords: [F32x8<S>; 4],
    lod: F32x8<S>,
    active: u32,
) -> Rgba<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            // Divide by q and compare the texels with r.
            let [s, t, r, q] = coords;
            let point = [s / q, t / q, reference(texture, r / q)];
            let [value] = mipped(
                simd,
                texture,
                lod,
                active,
                #[inline(always)]
                |level, linear, lanes| {
                    // A constant number of dimensions unrolls the loops.
                    [match texture.kind {
                        TextureKind::One => {
                            lookup::<S, 1>(simd, texture, plane, level, linear, point, lanes)
                        }
                        _ => lookup::<S, 2>(simd, texture, plane, level, linear, point, lanes),
                    }]
                },
            );
            by_mode(simd, texture.depth_mode, value)
        },
    )
}

/// What `DEPTH_TEXTURE_MODE` makes of a value.
#[inline(always)]
pub(super) fn by_mode<S: Simd, V: Floats<S>>(simd: S, mode: BaseFormat, value: V) -> [V; 4] {
    let (zero, one) = (every(simd, 0.0), every(simd, 1.0));
    match mode {
        BaseFormat::Alpha => [zero, zero, zero, value],
        BaseFormat::Intensity => [value; 4],
        BaseFormat::Rgb => [value, zero, zero, one],
        _ => [value, value, value, one],
    }
}

/// A texel as it is filtered: its depth, or 1 where the comparison of the reference with it holds.
#[inline(always)]
pub(super) fn compared<S: Simd, V: Floats<S>>(
    simd: S,
    texture: &Texture,
    reference: V,
    depth: V,
) -> V {
    match texture.sampler.compare {
        None => depth,
        Some(func) => {
            let passes = compare(simd, func, reference, depth);
            select(passes, every(simd, 1.0), every(simd, 0.0))
        }
    }
}

/// Whether a comparison only fails more with a depth that is nearer in the plane, so that what is
/// no nearer than the reference is settled.
#[inline(always)]
fn settles(func: Option<Compare>, sign: f32) -> bool {
    match func {
        Some(Compare::GreaterOrEqual) => sign > 0.0,
        Some(Compare::LessOrEqual) => sign < 0.0,
        _ => false,
    }
}

/// The stored depth that decides a comparison, for each lane: triangles that are no nearer need not
/// be looked at.
#[inline(always)]
fn known<S: Simd>(
    texture: &Texture,
    depths: &LevelDepths<'_>,
    reference: F32x8<S>,
) -> Option<F32x8<S>> {
    settles(texture.sampler.compare, depths.pending()?).then_some(reference)
}

/// One level, filtered.
#[inline(always)]
fn lookup<S: Simd, const DIMENSIONS: usize>(
    simd: S,
    texture: &Texture,
    plane: Option<&DepthBuffer>,
    level: usize,
    linear: bool,
    point: [F32x8<S>; 3],
    lanes: u32,
) -> F32x8<S> {
    // Find the texels and weights along the axes.
    let Some(shape) = level_of(texture, level) else { return splat(simd, 0.0) };
    let depths = LevelDepths::new(shape, plane);
    let known = known(texture, &depths, point[2]);
    let axes = axes(simd, texture, shape, DIMENSIONS, linear, point);

    // Compare each corner with the reference.
    let border = splat_rgba(simd, texture.sampler.border)[0];
    let corners = if linear { 1 << DIMENSIONS } else { 1 };
    let mut values = [border; 4];
    for corner in 0..corners {
        let ([x, y, _], outside) = corner_texels(simd, shape, DIMENSIONS, &axes, corner);
        let depth = select(outside, border, depths.at(simd, x, y, shape.size[0], lanes, known));
        values[corner] = compared(simd, texture, point[2], depth);
    }

    // Filter the results of comparison.
    let mut count = corners;
    for k in 0..DIMENSIONS {
        count /= 2;
        for i in 0..count {
            values[i] = mix(values[2 * i], values[2 * i + 1], axes[k].weight);
        }
    }
    values[0]
}
