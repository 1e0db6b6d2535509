//! Texels of one level, fetched for eight lanes.

use crate::forward::fragment_ops::packed::unpack_bytes;
use crate::forward::plane::{DepthPlane, PlaneTile};
use crate::forward::texture::{Level, Texels, Texture};
use crate::forward::wide::Rgba;
use crate::{TILE, TILE_PIXELS};
use std::sync::{Arc, LazyLock, MutexGuard, PoisonError};
use vitral_math::color::linear_from_srgb_table;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, I32x8, LANES, Simd, U32x8};

/// Linear light of each sRGB byte.
static LINEAR_FROM_SRGB: LazyLock<[f32; 256]> = LazyLock::new(linear_from_srgb_table);

/// The texels of one level of all faces.
pub(super) enum Images<'a> {
    /// 8 bits.
    Rgba8([&'a [u32]; 6]),
    /// 8 bits, colours sRGB-encoded.
    Srgb8([&'a [u32]; 6], &'a [f32; 256]),
    /// Floating point.
    RgbaF32([&'a [[f32; 4]]; 6]),
    /// Depth.
    Depth([&'a [f32]; 6]),
    /// A depth plane, which has one face; held until the lookup is done.
    Plane(MutexGuard<'a, DepthPlane>),
}

impl<'a> Images<'a> {
    /// Level `level`; faces that are missing or of another form than the first are empty.
    pub(super) fn new(texture: &'a Texture, level: usize) -> Self {
        let face = |i: usize| texture.faces.get(i).and_then(|levels| levels.get(level)).map(|level| &level.texels);
        match face(0) {
            None => Self::Rgba8([&[]; 6]),
            Some(Texels::Rgba8(_)) => Self::Rgba8(std::array::from_fn(|i| match face(i) {
                Some(Texels::Rgba8(texels)) => texels.as_slice(),
                _ => &[],
            })),
            Some(Texels::Srgb8(_)) => {
                let words = std::array::from_fn(|i| match face(i) {
                    Some(Texels::Srgb8(texels)) => texels.as_slice(),
                    _ => &[],
                });
                Self::Srgb8(words, &LINEAR_FROM_SRGB)
            }
            Some(Texels::RgbaF32(_)) => Self::RgbaF32(std::array::from_fn(|i| match face(i) {
                Some(Texels::RgbaF32(texels)) => texels.as_slice(),
                _ => &[],
            })),
            Some(Texels::Depth(_)) => Self::Depth(std::array::from_fn(|i| match face(i) {
                Some(Texels::Depth(texels)) => texels.as_slice(),
                _ => &[],
            })),
            Some(Texels::DepthPlane(plane)) => Self::Plane(plane.lock().unwrap_or_else(PoisonError::into_inner)),
        }
    }

    /// Colours of the texels numbered `index` of the faces `face`; a depth in all components. Missing texels are 0.
    #[inline(always)]
    pub(super) fn colors<S: Simd>(&self, simd: S, face: &[u32; LANES], index: I32x8<S>) -> Rgba<S> {
        match self {
            Self::Rgba8(faces) => {
                let [r, g, b, a] = unpack_bytes(U32x8::from_slice(simd, &gather(faces, face, index)));
                [r / 255.0, g / 255.0, b / 255.0, a / 255.0]
            }
            Self::Srgb8(faces, table) => {
                let [r, g, b, a] = decode(simd, &gather(faces, face, index), table);
                [r, g, b, a / 255.0]
            }
            Self::RgbaF32(faces) => {
                let texels = gather(faces, face, index);
                let mut columns = [[0.0f32; LANES]; 4];
                for lane in 0..LANES {
                    for k in 0..4 {
                        columns[k][lane] = texels[lane][k];
                    }
                }
                let [r, g, b, a] = &columns;
                [
                    F32x8::from_slice(simd, r),
                    F32x8::from_slice(simd, g),
                    F32x8::from_slice(simd, b),
                    F32x8::from_slice(simd, a),
                ]
            }
            Self::Depth(faces) => [F32x8::from_slice(simd, &gather(faces, face, index)); 4],
            Self::Plane(_) => [F32x8::from_slice(simd, &[0.0; LANES]); 4],
        }
    }

    /// Depths of the texels `(x, y)` of an image `width` wide. What is not a depth image has depth 0.
    #[inline(always)]
    pub(super) fn depths<S: Simd>(&self, simd: S, x: I32x8<S>, y: I32x8<S>, width: u32, active: u32) -> F32x8<S> {
        match self {
            Self::Depth(faces) => {
                let texels = gather(faces, &[0; LANES], y * width as i32 + x);
                F32x8::from_slice(simd, &texels)
            }
            Self::Plane(plane) => plane_depths(simd, plane, x, y, active),
            _ => F32x8::from_slice(simd, &[0.0; LANES]),
        }
    }
}

/// Depths of sample 0 of a plane's pixels; other lanes than the active ones are 0.
#[inline(always)]
fn plane_depths<S: Simd>(simd: S, depth: &DepthPlane, x: I32x8<S>, y: I32x8<S>, active: u32) -> F32x8<S> {
    const SHIFT: u32 = TILE.trailing_zeros();
    const INSIDE: i32 = TILE as i32 - 1;
    let tiles_x = depth.plane.viewport().tiles_x() as i32;
    let tile = ((y >> SHIFT) * tiles_x + (x >> SHIFT)).to_array();
    let at = ((y & INSIDE) * TILE as i32 + (x & INSIDE)).to_array();
    let mut out = [0.0f32; LANES];
    for lane in 0..LANES {
        if active >> lane & 1 == 1 {
            out[lane] = match depth.plane.tiles.get(tile[lane] as usize) {
                Some(PlaneTile::Cleared(value)) => *value,
                Some(PlaneTile::Stored(values)) => values[at[lane] as usize % TILE_PIXELS],
                None => 0.0,
            };
        }
    }
    F32x8::from_slice(simd, &out) / depth.scale
}

/// One texel a lane.
#[inline(always)]
pub(super) fn gather<S: Simd, T: Copy + Default>(
    faces: &[&[T]; 6],
    face: &[u32; LANES],
    index: I32x8<S>,
) -> [T; LANES] {
    let index = index.to_array();
    let mut out = [T::default(); LANES];
    for lane in 0..LANES {
        out[lane] = faces[(face[lane] % 6) as usize].get(index[lane] as usize).copied().unwrap_or_default();
    }
    out
}

/// Colours in linear light, alpha as 0..=255.
#[inline(always)]
pub(super) fn decode<S: Simd>(simd: S, words: &[u32; LANES], table: &[f32; 256]) -> Rgba<S> {
    let mut colors = [[0.0f32; LANES]; 3];
    for lane in 0..LANES {
        let bytes = words[lane].to_le_bytes();
        for k in 0..3 {
            colors[k][lane] = table[usize::from(bytes[k])];
        }
    }
    let alpha: I32x8<S> = (U32x8::from_slice(simd, words) >> 24).bitcast();
    let [r, g, b] = &colors;
    [F32x8::from_slice(simd, r), F32x8::from_slice(simd, g), F32x8::from_slice(simd, b), alpha.to_float()]
}

/// The level `level` of face 0, if there is one.
pub(super) fn level_of(texture: &Texture, level: usize) -> Option<&Arc<Level>> {
    texture.faces.first()?.get(level)
}

/// Sizes of a level without its border.
pub(super) fn interior(level: &Level, dimensions: usize) -> [u32; 3] {
    let mut size = level.size;
    for side in &mut size[..dimensions] {
        *side = side.saturating_sub(2 * level.border);
    }
    size
}
