//! Texels of one level, fetched for eight lanes.
//!
//! Fetched colours are raw: bytes stay 0..=255 until a lookup is finished, so that they are divided
//! once instead of once a texel. [`Image::raw`] brings other colours to that scale.

use crate::forward::fragment_ops::packed::unpack_bytes;
use crate::forward::plane::DepthBuffer;
use crate::forward::texture::{Level, Texels, Texture};
use crate::forward::wide::{Rgba, splat};
use crate::{TILE, TILE_PIXELS};
use std::sync::{LazyLock, MutexGuard, PoisonError};
use vitral_math::color::linear_from_srgb_table;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Floats, I32x8, LANES, Lanes, MOST_LANES, Simd, U32x8};

/// Linear light of each sRGB byte.
static LINEAR_FROM_SRGB: LazyLock<[f32; 256]> = LazyLock::new(linear_from_srgb_table);

/// The level `level` of face 0, if there is one.
#[inline(always)]
pub(super) fn level_of(texture: &Texture, level: usize) -> Option<&Level> {
    level_of_face(texture, 0, level)
}

/// The level `level` of a face.
#[inline(always)]
pub(super) fn level_of_face(texture: &Texture, face: usize, level: usize) -> Option<&Level> {
    Some(&**texture.faces.get(face)?.get(level)?)
}

/// Sizes of a level without its border.
#[inline(always)]
pub(super) fn interior(level: &Level, dimensions: usize) -> [u32; 3] {
    let mut size = level.size;
    for side in &mut size[..dimensions] {
        *side = side.saturating_sub(2 * level.border);
    }
    size
}

/// One texel a lane; 0 where there is none.
#[inline(always)]
fn gather<S: Simd, T: Copy + Default>(texels: &[T], index: I32x8<S>) -> [T; LANES] {
    let index = index.to_array();
    let mut out = [T::default(); LANES];
    for lane in 0..LANES {
        out[lane] = texels.get(index[lane] as usize).copied().unwrap_or_default();
    }
    out
}

/// The texels numbered `at`; 0 where there is none.
#[inline(always)]
pub(super) fn singles<S: Simd>(simd: S, texels: &[u32], at: I32x8<S>) -> U32x8<S> {
    U32x8::from_slice(simd, &gather(texels, at))
}

/// The four texels round places, lower left and right, upper left and right; 0 where there are
/// none. A lane's begin with number `at` of `columns(lane)`: see [`Level::columns`].
#[inline(always)]
pub(super) fn quads<'a, S: Simd, V: Floats<S>>(
    simd: S,
    columns: impl Fn(usize) -> &'a [[u32; 2]],
    at: V::Ints,
) -> [V::Words; 4] {
    // Fetch two columns of two texels in each lane.
    let at = at.as_slice();
    let mut quads = [[0u32; 4]; MOST_LANES];
    for lane in 0..V::LEN {
        let at = at[lane] as u32 as usize;
        if let Some([[a, c], [b, d]]) = columns(lane).get(at..at + 2) {
            quads[lane] = [*a, *c, *b, *d];
        }
    }

    // Transpose them to four registers.
    let words: &[u32] = bytemuck::cast_slice(&quads);
    let part = lanes::inlined(
        #[inline(always)]
        |k: usize| V::Words::from_slice(simd, &words[k * V::LEN..(k + 1) * V::LEN]),
    );
    let ((left, right), (more_left, more_right)) =
        ((part(0).deinterleave(part(1))), part(2).deinterleave(part(3)));
    let ((a, b), (c, d)) = (left.deinterleave(more_left), right.deinterleave(more_right));
    [a, b, c, d]
}

/// Texels of 8 bits a component.
#[derive(Clone, Copy)]
pub(super) struct TexelWords<'a> {
    pub(super) texels: &'a [u32],
    /// What colour bytes mean, if they are sRGB-encoded.
    decode: Option<&'a [f32; 256]>,
}

impl<'a> TexelWords<'a> {
    /// Those of a level, if it has such.
    #[inline(always)]
    pub(super) fn new(level: &'a Level) -> Option<Self> {
        match level.texels() {
            Texels::Rgba8(texels) => Some(Self { texels, decode: None }),
            Texels::Srgb8(texels) => Some(Self { texels, decode: Some(&LINEAR_FROM_SRGB) }),
            _ => None,
        }
    }

    /// Bytes do not stand for equal steps of light.
    #[inline(always)]
    pub(super) fn is_encoded(&self) -> bool {
        self.decode.is_some()
    }

    /// The texels numbered `index`.
    #[inline(always)]
    pub(super) fn words<S: Simd>(&self, simd: S, index: I32x8<S>) -> U32x8<S> {
        singles(simd, self.texels, index)
    }

    /// Raw colours of texels.
    #[inline(always)]
    pub(super) fn meaning<S: Simd, V: Floats<S>>(&self, simd: S, words: V::Words) -> [V; 4] {
        match self.decode {
            None => unpack_bytes(words),
            Some(table) => decode(simd, words, table),
        }
    }

    /// Raw colours of the texels numbered `index`.
    #[inline(always)]
    pub(super) fn colors<S: Simd>(&self, simd: S, index: I32x8<S>) -> Rgba<S> {
        self.meaning(simd, self.words(simd, index))
    }

    /// A colour as if it were fetched.
    #[inline(always)]
    pub(super) fn raw(&self, [r, g, b, a]: [f32; 4]) -> [f32; 4] {
        match self.decode {
            None => [r * 255.0, g * 255.0, b * 255.0, a * 255.0],
            Some(_) => [r, g, b, a * 255.0],
        }
    }

    /// From raw colours to colours.
    #[inline(always)]
    pub(super) fn finish<V: Lanes>(&self, color: [V; 4]) -> [V; 4] {
        // Times the reciprocal, which makes 1.0 of 255, and of a byte what rounds to that byte
        // again.
        const UNIT: f32 = 1.0 / 255.0;
        let [r, g, b, a] = color;
        match self.decode {
            None => [r * UNIT, g * UNIT, b * UNIT, a * UNIT],
            Some(_) => [r, g, b, a * UNIT],
        }
    }
}

/// Colours in linear light, alpha as 0..=255.
#[inline(always)]
fn decode<S: Simd, V: Floats<S>>(simd: S, words: V::Words, table: &[f32; 256]) -> [V; 4] {
    // Look the colour bytes up in the table, lane by lane.
    let bytes = words.as_slice();
    let mut colors = [[0.0f32; MOST_LANES]; 3];
    for lane in 0..V::LEN {
        let bytes = bytes[lane].to_le_bytes();
        for k in 0..3 {
            colors[k][lane] = table[usize::from(bytes[k])];
        }
    }

    // Alpha is linear and needs no table.
    let alpha: V::Ints = (words >> 24).bitcast();
    let [r, g, b] = &colors;
    [
        V::from_slice(simd, &r[..V::LEN]),
        V::from_slice(simd, &g[..V::LEN]),
        V::from_slice(simd, &b[..V::LEN]),
        alpha.to_float(),
    ]
}

/// Texels of any kind, as colours.
#[derive(Clone, Copy)]
pub(super) enum Image<'a> {
    Words(TexelWords<'a>),
    Floats(&'a [[f32; 4]]),
    /// A depth in all components.
    Depths(&'a [f32]),
}

impl<'a> Image<'a> {
    /// Those of a level; a depth plane has no colours.
    #[inline(always)]
    pub(super) fn new(level: &'a Level) -> Self {
        match level.texels() {
            Texels::RgbaF32(texels) => Self::Floats(texels),
            Texels::Depth(texels) => Self::Depths(texels),
            _ => TexelWords::new(level).map_or(Self::Floats(&[]), Self::Words),
        }
    }

    /// Raw colours.
    #[inline(always)]
    pub(super) fn colors<S: Simd>(&self, simd: S, index: I32x8<S>) -> Rgba<S> {
        match self {
            Self::Words(words) => words.colors(simd, index),
            Self::Floats(texels) => {
                let index = index.to_array();
                let row =
                    |lane: usize| texels.get(index[lane] as usize).copied().unwrap_or_default();
                let [r, g, b, a] = lanes::columns_of_rows(
                    simd,
                    #[inline(always)]
                    |lane| bytemuck::cast(row(lane)),
                );
                [r.bitcast(), g.bitcast(), b.bitcast(), a.bitcast()]
            }
            Self::Depths(texels) => [F32x8::from_slice(simd, &gather(texels, index)); 4],
        }
    }

    /// One raw colour.
    pub(super) fn color(&self, index: usize) -> [f32; 4] {
        match self {
            Self::Words(words) => {
                let bytes = words.texels.get(index).copied().unwrap_or(0).to_le_bytes();
                let [r, g, b] = [0, 1, 2].map(|k: usize| match words.decode {
                    None => f32::from(bytes[k]),
                    Some(table) => table[usize::from(bytes[k])],
                });
                [r, g, b, f32::from(bytes[3])]
            }
            Self::Floats(texels) => texels.get(index).copied().unwrap_or_default(),
            Self::Depths(texels) => [texels.get(index).copied().unwrap_or_default(); 4],
        }
    }

    /// A colour as if it were fetched.
    #[inline(always)]
    pub(super) fn raw(&self, color: [f32; 4]) -> [f32; 4] {
        match self {
            Self::Words(words) => words.raw(color),
            _ => color,
        }
    }

    /// From raw colours to colours.
    #[inline(always)]
    pub(super) fn finish<V: Lanes>(&self, color: [V; 4]) -> [V; 4] {
        match self {
            Self::Words(words) => words.finish(color),
            _ => color,
        }
    }
}

/// Colours of eight lanes by component.
#[inline(always)]
pub(super) fn columns<S: Simd>(simd: S, colors: &[[f32; 4]; LANES]) -> Rgba<S> {
    let mut columns = [[0.0f32; LANES]; 4];
    for lane in 0..LANES {
        for k in 0..4 {
            columns[k][lane] = colors[lane][k];
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

/// Depths of a level.
pub(super) enum LevelDepths<'a> {
    Stored(&'a [f32]),
    /// Held until the lookup is done.
    Locked(MutexGuard<'a, DepthBuffer>),
    /// Held by the caller.
    Plane(&'a DepthBuffer),
}

impl<'a> LevelDepths<'a> {
    /// Those of a level; what is no depth image has none.
    #[inline(always)]
    pub(super) fn new(level: &'a Level, plane: Option<&'a DepthBuffer>) -> Self {
        match (level.texels(), plane) {
            (Texels::DepthBuffer(_), Some(plane)) => Self::Plane(plane),
            (Texels::Depth(texels), _) => Self::Stored(texels),
            (Texels::DepthBuffer(plane), None) => {
                Self::Locked(plane.lock().unwrap_or_else(PoisonError::into_inner))
            }
            _ => Self::Stored(&[]),
        }
    }

    /// Sign of triangles that are pending, see [`crate::forward::pending`].
    #[inline(always)]
    pub(super) fn pending(&self) -> Option<f32> {
        let plane = match self {
            Self::Stored(_) => return None,
            Self::Locked(plane) => &**plane,
            Self::Plane(plane) => plane,
        };
        plane.pending.as_ref().map(|p| p.sign())
    }

    /// Depths of the texels `(x, y)` of an image `width` wide; 0 where there is none.
    #[inline(always)]
    pub(super) fn at<S: Simd>(
        &self,
        simd: S,
        x: I32x8<S>,
        y: I32x8<S>,
        width: u32,
        active: u32,
        known: Option<F32x8<S>>,
    ) -> F32x8<S> {
        match self {
            Self::Stored(texels) => F32x8::from_slice(simd, &gather(texels, y * width as i32 + x)),
            Self::Locked(plane) => plane_depths(simd, plane, x, y, active, known),
            Self::Plane(plane) => plane_depths(simd, plane, x, y, active, known),
        }
    }
}

/// Depths of sample 0 of a plane's pixels; other lanes than the active ones yield something
/// harmless.
#[inline(always)]
fn plane_depths<S: Simd>(
    simd: S,
    depth: &DepthBuffer,
    x: I32x8<S>,
    y: I32x8<S>,
    active: u32,
    known: Option<F32x8<S>>,
) -> F32x8<S> {
    // Compute the texels of a pending shadow map.
    if let Some(pending) = &depth.pending {
        return pending.texels(simd, [x, y], active, known);
    }

    // Find the tile and the position of each texel.
    const SHIFT: u32 = TILE.trailing_zeros();
    const INSIDE: i32 = TILE as i32 - 1;
    let tiles_x = depth.plane.viewport().tiles_x() as i32;
    let tile = ((y >> SHIFT) * tiles_x + (x >> SHIFT)).to_array();
    let at = ((y & INSIDE) * TILE as i32 + (x & INSIDE)).to_array();
    let mut out = [0.0f32; LANES];
    for lane in 0..LANES {
        if active >> lane & 1 == 1
            && let Some(tile) = depth.plane.tiles.get(tile[lane] as usize)
        {
            out[lane] = tile.get(0, at[lane] as usize % TILE_PIXELS);
        }
    }
    F32x8::from_slice(simd, &out) / splat(simd, depth.scale)
}
