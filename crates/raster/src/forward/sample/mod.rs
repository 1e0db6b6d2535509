//! Looking eight points up in a texture: choose levels, wrap, fetch, compare, filter.
//!
//! [`mip::derivatives`] tell how many texels of level 0 a step of one pixel crosses, [`mip::lod`]
//! is the logarithm of the larger step, and [`sample`] reads the levels it calls for. Lanes that
//! choose the same level are looked up together, so that a row of pixels on one surface takes one
//! or two passes. Texels are fetched lane by lane, everything else is done in lanes. The
//! [`PackedTexture`] kinds of textures have ways of their own, for eight lanes or sixteen. A lookup
//! never fails: missing texels read as opaque black, and a coordinate that is not finite reads
//! the texel at the low edge.
//!
//! In:   interpolated coordinates (s, t, r, q), level of detail. Out: RGBA, straight alpha, linear
//!       light.
//! Cost: one texel (nearest), two, four or eight (linear in one to three dimensions); twice that
//!       between two levels.
//! Source: OpenGL 1.5 specification, sections 3.8.7 to 3.8.11, 3.8.14; ARB_seamless_cube_map,
//! EXT_texture_sRGB, EXT_texture_filter_anisotropic. Departs from it: texels are fetched once a
//! lane, also where a lane is not active.

pub(crate) mod anisotropic;
pub(crate) mod cube;
pub(crate) mod depth;
mod fetch;
mod flat;
mod halves;
pub(crate) mod mip;
pub(crate) mod packed;
pub(crate) mod packed_cube;
mod wrap;

#[cfg(test)]
mod tests;

use super::plane::DepthBuffer;
use super::texture::{Texels, Texture, TextureKind};
use super::wide::{Rgba, splat_rgba};
use depth::PackedShadow;
use packed::Packed;
use packed_cube::PackedCube;
use vitral_math::lanes::{F32x8, Simd};

/// A texture of a common kind, made ready for lookups.
#[derive(Clone, Copy)]
pub(crate) enum PackedTexture<'a> {
    /// Packed colours of one or two dimensions.
    Flat(Packed<'a>),
    /// A cube map of packed colours.
    Cube(PackedCube<'a>),
    /// A depth texture that is compared with.
    Shadow(PackedShadow<'a>),
}

impl<'a> PackedTexture<'a> {
    /// `None` for textures of another kind; `plane` is that of a depth texture's only level.
    pub(crate) fn new(texture: &'a Texture, plane: Option<&'a DepthBuffer>) -> Option<Self> {
        match (texture.kind, plane) {
            (_, Some(_)) => PackedShadow::new(texture, plane).map(Self::Shadow),
            (TextureKind::Cube, _) => PackedCube::new(texture).map(Self::Cube),
            _ => Packed::new(texture).map(Self::Flat),
        }
    }
}

/// The texture's colours at eight points. `coords` are s, t, r, q as interpolated: they are divided
/// by q here; of cube maps' q the sign matters alone, for s, t, r are a direction. `lod` is the
/// logarithm to base 2 of the texels of level 0 per pixel, plus the bias; see [`mip::needs_lod`].
/// Lanes without their bit in `active` yield something harmless.
///
/// `plane` is that of a depth texture whose texels are one, where the caller holds it already.
///
/// Depth textures yield what their mode makes of the depth, or with a comparison of its result; the
/// reference is r / q, for cube maps q.
#[inline(always)]
pub(crate) fn sample<S: Simd>(
    simd: S,
    texture: &Texture,
    plane: Option<&DepthBuffer>,
    coords: [F32x8<S>; 4],
    lod: F32x8<S>,
    active: u32,
) -> Rgba<S> {
    let Some(first) = texture.faces.first().and_then(|face| face.first()) else {
        return splat_rgba(simd, [0.0, 0.0, 0.0, 1.0]);
    };
    let is_depth = matches!(first.texels(), Texels::Depth(_) | Texels::DepthBuffer(_));
    if let Some(packed) = Packed::new(texture) {
        return packed::sample(simd, &packed, coords, lod, active);
    }
    match texture.kind {
        TextureKind::Cube => cube::sample(simd, texture, coords, lod, active),
        _ if is_depth => depth::sample(simd, texture, plane, coords, lod, active),
        _ => flat::sample(simd, texture, coords, lod, active),
    }
}
