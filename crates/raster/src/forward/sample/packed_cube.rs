//! The common case of cube maps: 8 bits a component, filtered linearly, no border colour in reach.
//!
//! Each face is laid out with a rim of the texels that lie beyond its edges, with seamless
//! filtering those of the faces that meet it there, so that texels are found without a look at
//! edges. A face is laid out when it is first looked at. Other cube maps are [`super::cube`]'s.
//!
//! Source: ARB_seamless_cube_map.

use super::cube::{fill_missing, neighbour};
use super::fetch::{TexelWords, level_of_face, quads};
use super::halves::Halves;
use super::mip::{choose, mix_rgba};
use super::wrap::{linear_in, position_in};
use crate::forward::texture::{
    Columns, Filter, Level, Texels, Texture, TextureKind, Wrap, columns_of,
};
use crate::forward::wide::{bits_of, every, floor, max, min, select_rgba};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, Floats, Lanes, MaskOf, Simd};

/// Most levels: the largest texture has 2^14 texels a side.
const LEVELS: usize = 16;

/// Faces of levels with their rims, as far as lookups asked for them. Texel `(x, y)` of a face
/// `size` wide, both from -1 on, is the first of number `(y + 1) * (size + 3) + x + 1`, the one
/// above it is the second. A copy makes its own.
#[derive(Clone, Debug, Default)]
pub(crate) struct CubeFaces([[Columns; 6]; LEVELS]);

/// A cube map, made ready for lookups.
#[derive(Clone, Copy)]
pub(crate) struct PackedCube<'a> {
    texture: &'a Texture,
    /// The last level.
    last: usize,
    /// Width and height of a face of level 0.
    size: u32,
    /// A face, for what bytes mean.
    first: TexelWords<'a>,
}

impl<'a> PackedCube<'a> {
    /// `None` for textures of another kind.
    pub(crate) fn new(texture: &'a Texture) -> Option<Self> {
        // Every level must be square, of bytes, half as large as the one before, and have no
        // border.
        let levels = texture.faces.first()?;
        let (first, last) = (levels.first()?, levels.len().min(LEVELS) - 1);
        let size = first.size[0];
        let regular = texture.faces.iter().all(|levels| {
            let side = |(k, level): (usize, &Level)| {
                let bytes = matches!(level.texels(), Texels::Rgba8(_));
                bytes && level.border == 0 && level.size[..2] == [(size >> k).max(1); 2]
            };
            levels.len() == last + 1 && levels.iter().map(|l| &**l).enumerate().all(side)
        });

        // Only linear filters are packed.
        let sampler = &texture.sampler;
        let usual =
            texture.kind == TextureKind::Cube && texture.swizzle.is_none() && first.has_columns();
        if !usual || !regular || sampler.mag != Filter::Linear || !sampler.min.is_linear() {
            return None;
        }
        Some(Self { texture, last, size, first: TexelWords::new(first)? })
    }

    /// Whether the level of detail can matter.
    #[inline(always)]
    pub(crate) fn needs_lod(&self) -> bool {
        self.texture.sampler.min != self.texture.sampler.mag
    }

    /// Width and height of a face of level 0.
    #[inline(always)]
    pub(crate) fn size(&self) -> f32 {
        self.size as f32
    }

    /// The colours at points of faces, 0..=1 along both axes.
    #[inline(always)]
    pub(crate) fn at<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        place: (V::Ints, [V; 2]),
        lod: V,
    ) -> [V; 4] {
        if !self.needs_lod() {
            return self.level(simd, place, every(simd, 0.0));
        }
        let choice = choose(simd, &self.texture.sampler, self.last, lod);
        let color = self.level(simd, place, choice.level);
        if bits_of(choice.fraction.simd_gt(every::<S, V>(simd, 0.0))) == 0 {
            return color;
        }
        let next = min(choice.level + 1.0, every(simd, self.last as f32));
        mix_rgba(color, self.level(simd, place, next), choice.fraction)
    }

    /// The colours on one level a lane.
    #[inline(always)]
    fn level<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        (face, point): (V::Ints, [V; 2]),
        level: V,
    ) -> [V; 4] {
        // Find the texels and weights along both axes.
        let size = max(floor(Lanes::exp2_whole(-level) * self.size as f32), every(simd, 1.0));
        let along = lanes::inlined(
            #[inline(always)]
            |k: usize| {
                // Points are on their faces: the rim holds what wrapping finds beside them.
                let wrap = Wrap::ClampToBorder;
                linear_in(simd, position_in(simd, point[k], size, wrap), size, wrap)
            },
        );
        let (x, y) = (along(0), along(1));
        let width: V::Ints = size.to_int();
        let at = (y.near + 1) * (width + 3) + (x.near + 1);

        // Fetch the four texels, usually from one face and level.
        let level: V::Ints = level.to_int();
        let (first_face, first_level) = (face.as_slice()[0], level.as_slice()[0]);
        let quads = if (face.simd_eq(first_face) & level.simd_eq(first_level)).all_true() {
            // Nearly always all lanes need the same level of the same face.
            let columns = self.face(first_face, first_level);
            quads::<S, V>(
                simd,
                #[inline(always)]
                |_| columns,
                at,
            )
        } else {
            self.mixed::<S, V>(simd, face, level, at)
        };

        // Filter, and repair the lanes whose texels lie beyond an edge.
        let beyond =
            [x.near.simd_lt(0), x.far.simd_ge(width), y.near.simd_lt(0), y.far.simd_ge(width)];
        let weights = [x.weight, y.weight];
        let mut color = Halves::filter(simd, quads, weights).unpack();
        let edges = beyond[0] | beyond[1] | beyond[2] | beyond[3];
        if bits_of(edges) != 0 {
            color = select_rgba(edges, self.across_edges(simd, &quads, weights, beyond), color);
        }
        self.first.finish(color)
    }

    /// Raw colours of four texels round places, some of which are beyond the left, right, lower and
    /// upper edges: what two faces make of an edge shall be the same, so they are not rounded.
    #[inline(never)]
    fn across_edges<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        quads: &[V::Words; 4],
        [x, y]: [V; 2],
        [left, right, low, high]: [MaskOf<S, V>; 4],
    ) -> [V; 4] {
        simd.vectorize(
            #[inline(always)]
            || {
                let mut colors = lanes::four(
                    #[inline(always)]
                    |k| self.first.meaning::<S, V>(simd, quads[k]),
                );
                fill_missing(&mut colors, [left & low, right & low, left & high, right & high]);
                let [a, b, c, d] = colors;
                mix_rgba(mix_rgba(a, b, x), mix_rgba(c, d, x), y)
            },
        )
    }

    /// Texels where lanes need different levels or faces.
    #[inline(never)]
    fn mixed<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        face: V::Ints,
        level: V::Ints,
        at: V::Ints,
    ) -> [V::Words; 4] {
        let (face, level) = (face.as_slice(), level.as_slice());
        simd.vectorize(
            #[inline(always)]
            || {
                quads::<S, V>(
                    simd,
                    #[inline(always)]
                    |lane| self.face(face[lane], level[lane]),
                    at,
                )
            },
        )
    }

    /// A face of a level with its rim.
    #[inline(always)]
    fn face(&self, face: i32, level: i32) -> &'a [[u32; 2]] {
        let (face, level) = (face as usize % 6, level as usize % LEVELS);
        self.texture.cube.0[level][face].0.get_or_init(|| with_rim(self.texture, face, level))
    }
}

/// A face of a level with a rim one texel wide, in columns.
#[cold]
fn with_rim(texture: &Texture, face: usize, level: usize) -> Box<[[u32; 2]]> {
    // Read texels of any face of this level.
    let words = |face: usize| match level_of_face(texture, face, level)
        .map(|level| (level.texels(), level.size[0]))
    {
        Some((Texels::Rgba8(words), size)) => (&words[..], size as i32),
        _ => (&[][..], 0),
    };
    let (own, size) = words(face);
    let texel =
        |words: &[u32], x: i32, y: i32| words.get((y * size + x) as usize).copied().unwrap_or(0);

    // Find the texel beyond an edge: a neighbouring face's, or what the wrap mode says.
    let sampler = &texture.sampler;
    let border = sampler.border_word();
    let along = |axis: usize, at: i32| match sampler.wrap[axis].after_mirror() {
        Wrap::Repeat => Some(at.rem_euclid(size)),
        Wrap::MirroredRepeat | Wrap::ClampToEdge => Some(at.clamp(0, size - 1)),
        _ => (0..size).contains(&at).then_some(at),
    };
    let beyond = |x: i32, y: i32| match neighbour(face as u32, x, y, size) {
        Some((face, x, y)) if sampler.seamless => texel(words(face as usize).0, x, y),
        _ if sampler.seamless => texel(own, x.clamp(0, size - 1), y.clamp(0, size - 1)),
        _ => along(0, x).zip(along(1, y)).map_or(border, |(x, y)| texel(own, x, y)),
    };

    // Copy the face row by row with its rim.
    let mut rimmed = Vec::with_capacity(((size + 2) * (size + 2)) as usize);
    for y in -1..=size {
        rimmed.push(beyond(-1, y));
        if (0..size).contains(&y) {
            rimmed.extend((0..size).map(|x| texel(own, x, y)));
        } else {
            rimmed.extend((0..size).map(|x| beyond(x, y)));
        }
        rimmed.push(beyond(size, y));
    }
    columns_of(&rimmed, size as usize + 2)
}
