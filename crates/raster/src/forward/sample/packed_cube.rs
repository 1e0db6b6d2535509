//! The common case of cube maps: 8 bits a component, no border colour in reach.
//!
//! Each face gets a rim of the texels that lie beyond its edges: with seamless filtering those of the faces that meet it there, and
//! at a corner of the cube, where three faces meet and a fourth texel is missing, the three others' mean; else its own, as
//! the wrap modes say. So a lookup need not know of edges. Faces are laid out when they are first looked at.
//!
//! Source: OpenGL 1.5 specification, table 3.20; ARB_seamless_cube_map.

use super::cube::neighbour;
use super::fetch::{Words, level_of_face, quads};
use super::halves::Halves;
use super::mip::mix_rgba;
use super::packed::filter_levels;
use super::wrap::{linear_in, nearest_in, position_in};
use crate::forward::texture::{Sampler, Texels, Texture, TextureKind, Wrap, columns_of};
use crate::forward::wide::{every, floor, max};
use std::sync::OnceLock;
use vitral_math::color::{linear_from_srgb, srgb_from_linear};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, Floats, MOST_LANES, Simd};

/// Most levels: the largest texture has 2^14 texels a side.
const LEVELS: usize = 16;

/// Faces with their rims, by level and face, as far as lookups asked for them. Texel `(x, y)` of a face `size` wide, each from -1 on, is the
/// first of number `(y + 1) * (size + 3) + x + 1`, the one above it the second. A copy makes its own.
#[derive(Debug, Default)]
pub(crate) struct CubeFaces([[OnceLock<Box<[[u32; 2]]>>; 6]; LEVELS]);

impl Clone for CubeFaces {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// A cube map, made ready for lookups.
#[derive(Clone, Copy)]
pub(crate) struct PackedCube<'a> {
    texture: &'a Texture,
    last: usize,
    size: f32,
    /// A face, for what bytes mean.
    first: Words<'a>,
    wrap: [Wrap; 2],
}

impl<'a> PackedCube<'a> {
    /// `None` for textures of another kind.
    pub(crate) fn new(texture: &'a Texture) -> Option<Self> {
        let count = texture.faces.first()?.len();
        if texture.kind != TextureKind::Cube || texture.faces.len() != 6 || count == 0 || count > LEVELS {
            return None;
        }
        if texture.swizzle.is_some() {
            return None;
        }
        let first = texture.faces[0].first()?;
        let [size, ..] = first.size;
        for face in &texture.faces {
            for (k, level) in face.iter().enumerate() {
                let side = (size >> k).max(1);
                if level.border != 0 || level.size[..2] != [side; 2] || Words::new(level).is_none() {
                    return None;
                }
            }
            if face.len() != count {
                return None;
            }
        }
        let Sampler { seamless, wrap, .. } = texture.sampler;
        let wrap = if seamless { [Wrap::ClampToBorder; 2] } else { [wrap[0], wrap[1]] };
        if !seamless && wrap.iter().any(|wrap| matches!(wrap, Wrap::Clamp | Wrap::ClampToBorder)) {
            return None;
        }
        Some(Self { texture, last: count - 1, size: size as f32, first: Words::new(first)?, wrap })
    }

    /// Whether the level of detail can matter.
    #[inline(always)]
    pub(crate) fn needs_lod(&self) -> bool {
        self.texture.sampler.min != self.texture.sampler.mag
    }

    /// Width and height of a face of level 0.
    #[inline(always)]
    pub(crate) fn size(&self) -> f32 {
        self.size
    }

    /// The colours at points of faces, 0..=1 along both axes.
    #[inline(always)]
    pub(crate) fn at<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        (face, point): (V::Ints, [V; 2]),
        lod: V,
        active: u32,
    ) -> [V; 4] {
        filter_levels(
            simd,
            (&self.texture.sampler, self.first, self.last),
            lod,
            active,
            #[inline(always)]
            |level| self.halves(simd, face, point, level),
            #[inline(always)]
            |level, linear| self.level(simd, (face, point), level, linear),
        )
    }

    /// A face of a level with its rim.
    #[inline(always)]
    fn face(&self, face: i32, level: i32) -> &'a [[u32; 2]] {
        let (face, level) = (face as usize % 6, level as usize % LEVELS);
        self.texture.cube.0[level][face].get_or_init(|| with_rim(self.texture, face, level))
    }

    /// Filtered bytes of one level a lane.
    #[inline(always)]
    fn halves<S: Simd, V: Floats<S>>(&self, simd: S, face: V::Ints, point: [V; 2], level: V) -> Halves<S, V> {
        let each: V::Ints = level.to_int();
        let (first, first_face) = (each.as_slice()[0], face.as_slice()[0]);
        if !(each.simd_eq(first) & face.simd_eq(first_face)).all_true() {
            return self.mixed_halves(simd, face, point, level);
        }
        // Nearly always all lanes need the same level of the same face.
        let columns = self.face(first_face, first);
        let size = max(floor(lanes::Lanes::exp2_whole(-level) * self.size), every(simd, 1.0));
        let (at, weights) = self.linear(simd, point, size);
        let quads = quads::<S, V>(
            simd,
            #[inline(always)]
            |_| columns,
            at,
        );
        Halves::filter(simd, quads, weights)
    }

    /// [`Self::halves`] where lanes need different levels or faces.
    #[inline(never)]
    fn mixed_halves<S: Simd, V: Floats<S>>(&self, simd: S, face: V::Ints, point: [V; 2], level: V) -> Halves<S, V> {
        simd.vectorize(
            #[inline(always)]
            || {
                let (quads, weights) = self.mixed_quads(simd, (face, point), level);
                Halves::filter(simd, quads, weights)
            },
        )
    }

    /// The texels round points, each on its lane's face and level, and the weights of those further on along both axes.
    #[inline(always)]
    fn mixed_quads<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        (face, point): (V::Ints, [V; 2]),
        level: V,
    ) -> ([V::Words; 4], [V; 2]) {
        let size = max(floor(lanes::Lanes::exp2_whole(-level) * self.size), every(simd, 1.0));
        let (at, weights) = self.linear(simd, point, size);
        let level: V::Ints = level.to_int();
        let (face, level) = (face.as_slice(), level.as_slice());
        let quads = quads::<S, V>(
            simd,
            #[inline(always)]
            |lane| self.face(face[lane], level[lane]),
            at,
        );
        (quads, weights)
    }

    /// Numbers of the first of four texels round points of faces of a size, and the weights of those further on.
    #[inline(always)]
    fn linear<S: Simd, V: Floats<S>>(&self, simd: S, point: [V; 2], size: V) -> (V::Ints, [V; 2]) {
        let along = lanes::inlined(
            #[inline(always)]
            |k: usize| linear_in(simd, position_in(simd, point[k], size, self.wrap[k]), size, self.wrap[k]),
        );
        let (x, y) = (along(0), along(1));
        let stride: V::Ints = (size + 3.0).to_int();
        ((y.near + 1) * stride + (x.near + 1), [x.weight, y.weight])
    }

    /// Raw colours of one level a lane.
    #[inline(never)]
    fn level<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        (face, point): (V::Ints, [V; 2]),
        level: V,
        filtered: bool,
    ) -> [V; 4] {
        simd.vectorize(
            #[inline(always)]
            || {
                let words = &self.first;
                if filtered {
                    let ([a, b, c, d], [x, y]) = self.mixed_quads(simd, (face, point), level);
                    let lower = mix_rgba(words.meaning(simd, a), words.meaning(simd, b), x);
                    let upper = mix_rgba(words.meaning(simd, c), words.meaning(simd, d), x);
                    return mix_rgba(lower, upper, y);
                }
                let size = max(floor(lanes::Lanes::exp2_whole(-level) * self.size), every(simd, 1.0));
                // Nearest texels are a face's own.
                let nearest = lanes::inlined(
                    #[inline(always)]
                    |k: usize| {
                        let wrap = if self.wrap[k] == Wrap::ClampToBorder { Wrap::ClampToEdge } else { self.wrap[k] };
                        nearest_in(position_in(simd, point[k], size, wrap), size, wrap)
                    },
                );
                let (stride, level): (V::Ints, V::Ints) = ((size + 3.0).to_int(), level.to_int());
                let at = (nearest(1) + 1) * stride + (nearest(0) + 1);
                let (at, face, level) = (at.as_slice(), face.as_slice(), level.as_slice());
                let mut texels = [0u32; MOST_LANES];
                for lane in 0..V::LEN {
                    let column = self.face(face[lane], level[lane]).get(at[lane] as u32 as usize);
                    texels[lane] = column.map_or(0, |[texel, _]| *texel);
                }
                words.meaning(simd, V::Words::from_slice(simd, &texels[..V::LEN]))
            },
        )
    }
}

/// A face of a level with a rim one texel wide, in columns.
fn with_rim(texture: &Texture, face: usize, level: usize) -> Box<[[u32; 2]]> {
    let words = |face: usize| match level_of_face(texture, face, level).map(|level| (level.texels(), level.size[0])) {
        Some((Texels::Rgba8(words) | Texels::Srgb8(words), size)) => (&words[..], size as i32),
        _ => (&[][..], 0),
    };
    let (_, size) = words(face);
    let texel = |face: usize, x: i32, y: i32| words(face).0.get((y * size + x) as usize).copied().unwrap_or(0);
    let encoded = level_of_face(texture, face, level).is_some_and(|l| matches!(l.texels(), Texels::Srgb8(_)));
    let Sampler { seamless, wrap, .. } = texture.sampler;
    let own = |at: i32, wrap: Wrap| if wrap == Wrap::Repeat { at.rem_euclid(size) } else { at.clamp(0, size - 1) };
    let beyond = |x: i32, y: i32| match neighbour(face as u32, x, y, size) {
        _ if !seamless => texel(face, own(x, wrap[0]), own(y, wrap[1])),
        Some((face, x, y)) => texel(face as usize, x, y),
        None => {
            let (inner_x, inner_y) = (x.clamp(0, size - 1), y.clamp(0, size - 1));
            let others = [(x, inner_y), (inner_x, y)].map(|(x, y)| neighbour(face as u32, x, y, size));
            let others = others.map(|place| place.map_or(0, |(face, x, y)| texel(face as usize, x, y)));
            mean([texel(face, inner_x, inner_y), others[0], others[1]], encoded)
        }
    };
    let mut rimmed = Vec::with_capacity(((size + 2) * (size + 2)) as usize);
    for y in -1..=size {
        let row_inside = (0..size).contains(&y);
        rimmed.extend((-1..=size).map(|x| {
            let inside = row_inside && (0..size).contains(&x);
            if inside { texel(face, x, y) } else { beyond(x, y) }
        }));
    }
    columns_of(&rimmed, size as usize + 2)
}

/// The mean of three colours, in linear light.
fn mean(texels: [u32; 3], encoded: bool) -> u32 {
    let bytes = texels.map(u32::to_le_bytes);
    let component = |k: usize| {
        let values = bytes.map(|b| f32::from(b[k]) / 255.0);
        let [a, b, c] = if encoded && k < 3 { values.map(linear_from_srgb) } else { values };
        let mean = (a + b + c) / 3.0;
        let mean = if encoded && k < 3 { srgb_from_linear(mean) } else { mean };
        (mean * 255.0 + 0.5) as u8
    };
    u32::from_le_bytes([component(0), component(1), component(2), component(3)])
}
