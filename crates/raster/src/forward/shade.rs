//! From a facet to the colours of a row of eight pixels: interpolation (`interpolation.rs`),
//! textures (`textures.rs`), fog.

mod eight_facets;
mod interpolation;
mod texel_cache;
mod textures;

pub(crate) use eight_facets::{EightFacets, FacetPixels, can_batch_facets};

use self::interpolation::{Differences, Interpolation, MAX_NUMBERS};
pub(crate) use self::texel_cache::TexelCache;
use super::assemble::{Facet, FacetKind, Primitives, Shape};
use super::block::BlockWords;
use super::color_grid::ColorGrid;
use super::environment::UNITS;
use super::environment::fog::{color_sum, fog};
use super::fragment_ops::compare::alpha_test;
use super::fragment_ops::packed::pack;
use super::pass::DrawContext;
use super::soft::{disc_coverage, overlap, pieces, polygon_coverage, stipples};
use super::wide::{Rgba, bits_of, clamp, every, every_rgba, saturate_rgba, splat};
use crate::{BLOCK, Setup, TILE};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, F32x16, Floats, I32x8, LANES, Simd, U32x8};

/// Where a draw's vertex records hold what. The first number of a record is `1 / w`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// Numbers in a record.
    pub stride: usize,
    /// Front colour, RGBA.
    pub color: usize,
    /// Back colour, RGBA, with two-sided lighting.
    pub back_color: Option<usize>,
    /// Secondary colour, RGB.
    pub secondary: Option<usize>,
    /// Back secondary colour, RGB.
    pub back_secondary: Option<usize>,
    /// Fog coordinate.
    pub fog: Option<usize>,
    /// Place in a grid of colours, in cells.
    pub grid: Option<usize>,
    /// Texture coordinates s, t, r, q of units.
    pub tex: [Option<usize>; UNITS],
    /// Units whose coordinates point sprites replace.
    pub sprites: u8,
    /// Line stipple: factor and pattern.
    pub line_stipple: Option<(i32, u16)>,
    /// Coverage of lines, points, polygons is computed and multiplies alpha.
    pub smooth: [bool; 3],
    /// Records hold nothing but colours, the same in all: one serves a whole piece, with 1 in place
    /// of `1 / w`.
    pub uniform: bool,
}

/// What a facet's shader works with, kept from facet to facet so that it need not be cleared.
#[derive(Default)]
pub(crate) struct Scratch {
    interpolation: Interpolation,
    differences: Differences,
    pub(super) seen: TexelCache,
}

/// Blocks with more covered pixels are shaded whole, without compaction, which is cheaper per
/// pixel.
const WHOLE_BLOCK_THRESHOLD: u32 = 24;

pub(super) const CENTERS: [f32; 8] = [0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5];

/// Columns and rows of the centres of two rows' pixels.
const TWO_ROWS: [[f32; 16]; 2] = [
    [0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5],
    [0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5],
];

/// Perspective-correct barycentric coordinates at a group of points.
#[derive(Clone, Copy)]
struct Weights<V> {
    b1: V,
    b2: V,
    /// `1 / Σ l / w`.
    w: V,
}

/// Groups of eight or sixteen pixels, and which of a group matter.
struct Groups<'a, V, const N: usize> {
    weights: [Weights<V>; N],
    active: u32,
    /// The colours of the texture that the draw shows again, at all of these pixels.
    seen: Option<&'a BlockWords>,
}

/// A facet, its draw and its job: what a row's colour needs.
pub(crate) struct Shader<'a> {
    pub draw: &'a DrawContext<'a>,
    pub facet: &'a Facet,
    primitives: &'a Primitives,
    /// The tile's first pixel.
    tile: [f32; 2],
    scratch: &'a mut Scratch,
    ready: bool,
    /// Once [`Self::constant`] was asked for.
    constant: Option<(u32, bool)>,
}

impl<'a> Shader<'a> {
    #[inline(always)]
    pub(crate) fn new(
        facet: &'a Facet,
        draw: &'a DrawContext<'a>,
        primitives: &'a Primitives,
        tile: [f32; 2],
        scratch: &'a mut Scratch,
    ) -> Self {
        Self { draw, facet, primitives, tile, scratch, ready: false, constant: None }
    }

    /// Whether its borders are soft, or it has a stipple, or what else [`Shape`] is for.
    #[inline(always)]
    pub(super) fn is_shaped(&self) -> bool {
        match self.facet.kind {
            FacetKind::Polygon => self.draw.layout.smooth[2],
            FacetKind::Plain => false,
            FacetKind::Line | FacetKind::Point => true,
        }
    }

    /// Local geometry of a line, point or smooth polygon.
    #[inline(always)]
    fn shape(&self) -> Option<Shape> {
        if !self.is_shaped() {
            return None;
        }
        self.primitives.shapes.get(self.facet.shape as usize).copied()
    }

    /// Makes the facet ready to be interpolated: before the first row that shows.
    #[inline(always)]
    pub(crate) fn prepare<S: Simd>(&mut self, simd: S, setup: &Setup) {
        if !self.ready {
            self.ready = true;
            self.scratch.seen.turn();
            let corners = self.facet.corners.map(|slot| slot as usize);
            self.scratch.differences.prepare(
                simd,
                &self.primitives.records,
                corners,
                self.draw.layout.stride,
            );
            if let Some(Shape::Polygon { x, y, .. }) = self.shape() {
                let own = Setup { x, y, ..*setup };
                self.scratch.interpolation.prepare(
                    &own,
                    self.facet,
                    &self.primitives.records,
                    self.tile,
                );
                self.scratch.interpolation.prepare_edges(&own);
            } else {
                self.scratch.interpolation.prepare(
                    setup,
                    self.facet,
                    &self.primitives.records,
                    self.tile,
                );
            }
        }
    }

    #[inline(always)]
    fn weights<S: Simd, V: Floats<S>>(&self, simd: S, x: V, y: V) -> Weights<V> {
        let i = &self.scratch.interpolation;
        let (dx, dy) = (x - i.origin[0], y - i.origin[1]);
        let plane = lanes::inlined(
            #[inline(always)]
            |p: &[f32; 3]| dx * p[1] + dy * p[2] + p[0],
        );
        let (q1, q2) = (plane(&i.first), plane(&i.second));
        if let Some(w) = i.flat_w {
            return Weights { b1: q1, b2: q2, w: every(simd, w) };
        }
        let w = every::<S, V>(simd, 1.0) / plane(&i.sum);
        Weights { b1: q1 * w, b2: q2 * w, w }
    }

    /// Number `k` of the records, interpolated.
    #[inline(always)]
    fn value<S: Simd, V: Floats<S>>(&self, simd: S, weights: &Weights<V>, k: usize) -> V {
        let (d, k) = (&self.scratch.differences, k % MAX_NUMBERS);
        if d.varies >> k & 1 == 0 {
            return every(simd, d.base[k]);
        }
        weights.b1 * d.d1[k] + weights.b2 * d.d2[k] + d.base[k]
    }

    /// Numbers `at..at + 4`, interpolated.
    #[inline(always)]
    fn four<S: Simd, V: Floats<S>>(&self, simd: S, weights: &Weights<V>, at: usize) -> [V; 4] {
        [
            self.value(simd, weights, at),
            self.value(simd, weights, at + 1),
            self.value(simd, weights, at + 2),
            self.value(simd, weights, at + 3),
        ]
    }

    /// Primary colours, before textures.
    #[inline(always)]
    fn primary<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        weights: &[Weights<V>; N],
    ) -> [[V; 4]; N] {
        if self.draw.state.flat {
            return [every_rgba(simd, self.provoking_color()); N];
        }
        if let (Some(at), Some(grid)) =
            (self.draw.layout.grid, self.primitives.grids.get(self.facet.grid as usize))
        {
            return self.grid_colors(simd, weights, grid, at);
        }
        let mut colors = [every_rgba(simd, [0.0; 4]); N];
        for i in 0..N {
            // Beyond the facet's border (a pixel's centre may be) colours are extrapolated: keep
            // them in range.
            let color = self.four(simd, &weights[i], self.color_at());
            colors[i] =
                if self.draw.state.unclamped_vertices { color } else { saturate_rgba(color) };
        }
        colors
    }

    #[inline(never)]
    fn grid_colors<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        weights: &[Weights<V>; N],
        grid: &ColorGrid,
        at: usize,
    ) -> [[V; 4]; N] {
        simd.vectorize(
            #[inline(always)]
            || {
                let mut places = [[every(simd, 0.0); 2]; N];
                for i in 0..N {
                    places[i] =
                        [self.value(simd, &weights[i], at), self.value(simd, &weights[i], at + 1)];
                }
                let shade =
                    |row: u32, eight: u32| self.draw.geometry.grid_colors(simd.level(), row, eight);
                grid.at(simd, &self.primitives.grid_colors, &places, &shade)
            },
        )
    }

    #[inline(always)]
    fn secondary<S: Simd, V: Floats<S>>(&self, simd: S, weights: &Weights<V>) -> Option<[V; 3]> {
        let front = self.draw.layout.secondary?;
        let at =
            if self.facet.back { self.draw.layout.back_secondary.unwrap_or(front) } else { front };
        if self.draw.state.flat {
            let r = &self.primitives.records[self.facet.provoking as usize + at..][..3];
            return Some([every(simd, r[0]), every(simd, r[1]), every(simd, r[2])]);
        }
        Some([
            clamp(self.value(simd, weights, at), 0.0, 1.0),
            clamp(self.value(simd, weights, at + 1), 0.0, 1.0),
            clamp(self.value(simd, weights, at + 2), 0.0, 1.0),
        ])
    }

    /// The colours of eight pixels whose centres are `x`, `y`; `active` says which matter. Gives
    /// also which of them stipples let pass.
    #[inline(always)]
    pub(crate) fn row<S: Simd>(
        &self,
        simd: S,
        x: F32x8<S>,
        y: F32x8<S>,
        active: u32,
    ) -> (Rgba<S>, u32) {
        let groups = Groups { weights: [self.weights(simd, x, y)], active, seen: None };
        let [color] = self.colors(simd, &groups);
        self.covered(simd, x, y, color)
    }

    /// The colours of groups of pixels, before soft borders. Groups go through each step together,
    /// since what a step needs of the facet is the same for all.
    #[inline(always)]
    fn colors<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        groups: &Groups<'_, V, N>,
    ) -> [[V; 4]; N] {
        let mut colors = self.primary(simd, &groups.weights);
        if !self.draw.state.units.is_empty() {
            self.textured(simd, groups, &mut colors);
        }
        if self.draw.state.color_sum || self.draw.state.fog.is_some() {
            for i in 0..N {
                colors[i] = self.summed(simd, &groups.weights[i], colors[i]);
            }
        }
        colors
    }

    /// Adds the secondary colour, and mixes with fog.
    #[inline(always)]
    fn summed<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        weights: &Weights<V>,
        mut color: [V; 4],
    ) -> [V; 4] {
        if self.draw.state.color_sum
            && let Some(secondary) = self.secondary(simd, weights)
        {
            color = color_sum(color, &secondary);
        }
        if let (Some(f), Some(at)) = (&self.draw.state.fog, self.draw.layout.fog) {
            color = fog(f, color, self.value(simd, weights, at));
        }
        color
    }

    /// The packed colour of a block's pixels in `any` (bit `8 * row + column`), and which pass the
    /// alpha test. `None` if each has its own: these are in `words` then, where those of other
    /// pixels have no meaning.
    #[inline(always)]
    pub(crate) fn block<S: Simd>(
        &mut self,
        simd: S,
        setup: &Setup,
        place: (usize, usize),
        any: u64,
        words: &mut BlockWords,
    ) -> (Option<u32>, u64) {
        if self.draw.constant {
            let (word, passes) = self.constant();
            return (Some(word), if passes { any } else { 0 });
        }
        (None, self.block_apart(simd, setup, place, any, words))
    }

    #[inline(never)]
    fn block_apart<S: Simd>(
        &mut self,
        simd: S,
        setup: &Setup,
        place: (usize, usize),
        any: u64,
        words: &mut BlockWords,
    ) -> u64 {
        simd.vectorize(
            #[inline(always)]
            || self.block_inlined(simd, setup, place, any, words),
        )
    }

    #[inline(always)]
    fn block_inlined<S: Simd>(
        &mut self,
        simd: S,
        setup: &Setup,
        (left, bottom): (usize, usize),
        any: u64,
        words: &mut BlockWords,
    ) -> u64 {
        // Shade blocks with many covered pixels whole.
        self.prepare(simd, setup);
        if any.count_ones() > WHOLE_BLOCK_THRESHOLD && !lanes::is_oldest(simd.level()) {
            return self.whole(simd, (left, bottom), words) & any;
        }
        let mut passed = 0u64;
        // Small facets cover few pixels of a row: eight of any rows go together.
        let (mut rest, tested) = (any, self.draw.state.alpha_test.is_some());
        while rest != 0 {
            let (mut places, mut count) = ([rest.trailing_zeros(); LANES], 0);
            while rest != 0 && count < LANES {
                places[count] = rest.trailing_zeros();
                rest &= rest - 1;
                count += 1;
            }

            // Shade the gathered pixels and scatter their colours.
            let mut out = [0; LANES];
            let pass = self.eight(simd, &places, (left, bottom), (1 << count) - 1, &mut out);
            for lane in 0..count {
                words[places[lane] as usize % words.len()] = out[lane];
                if tested {
                    passed |= u64::from(pass >> lane & 1) << places[lane];
                }
            }
        }
        if tested { passed } else { any }
    }

    /// The packed colours of all pixels of a block, and which pass the alpha test.
    #[inline(never)]
    fn whole<S: Simd>(
        &mut self,
        simd: S,
        (left, bottom): (usize, usize),
        words: &mut BlockWords,
    ) -> u64 {
        simd.vectorize(
            #[inline(always)]
            || {
                // Two rows go together.
                let x = F32x16::from_slice(simd, &TWO_ROWS[0]) + left as f32;
                let y = F32x16::from_slice(simd, &TWO_ROWS[1]) + bottom as f32;
                let mut rows = [y; BLOCK / 2];
                for pair in 1..BLOCK / 2 {
                    rows[pair] = y + (2 * pair) as f32;
                }
                let block = bottom % TILE / BLOCK * (TILE / BLOCK) + left % TILE / BLOCK;

                // Interpolate the weights of all pairs of rows.
                let mut weights = [self.weights(simd, x, rows[0]); BLOCK / 2];
                for pair in 1..BLOCK / 2 {
                    weights[pair] = self.weights(simd, x, rows[pair]);
                }

                // Look up cached texture colours if the draw shows them repeatedly.
                let mut seen = None;
                if self.draw.again.is_some() {
                    self.see(simd, block, &weights);
                    seen = self.scratch.seen.get(block);
                }
                self.packed(simd, &Groups { weights, active: 0xffff, seen }, words)
            },
        )
    }

    /// The packed colours of eight pixels of a block, each at `8 * row + column`, and which pass
    /// the alpha test. `active` says which matter.
    #[inline(never)]
    fn eight<S: Simd>(
        &self,
        simd: S,
        places: &[u32; LANES],
        (left, bottom): (usize, usize),
        active: u32,
        words: &mut [u32; LANES],
    ) -> u32 {
        simd.vectorize(
            #[inline(always)]
            || {
                let places: I32x8<S> = U32x8::from_slice(simd, places).bitcast();
                let (column, row): (F32x8<S>, F32x8<S>) =
                    ((places & 7).to_float(), (places >> 3).to_float());
                let (x, y) = (column + (left as f32 + 0.5), row + (bottom as f32 + 0.5));
                let groups = Groups { weights: [self.weights(simd, x, y)], active, seen: None };
                self.packed(simd, &groups, words) as u32
            },
        )
    }

    /// The packed colours of groups of pixels, a word for each, and which pass the alpha test.
    #[inline(always)]
    fn packed<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        groups: &Groups<'_, V, N>,
        words: &mut [u32],
    ) -> u64 {
        let colors = self.colors(simd, groups);
        for (color, words) in colors.iter().zip(words.chunks_exact_mut(V::LEN)) {
            pack::<S, V>(color).store_slice(words);
        }
        let mut passed = u64::MAX;
        if let Some(test) = self.draw.state.alpha_test {
            passed = 0;
            for i in 0..N {
                passed |= u64::from(bits_of(alpha_test(simd, test, colors[i][3]))) << (V::LEN * i);
            }
        }
        passed
    }

    /// The packed colour of all pixels of a facet whose draw is [`DrawContext::constant`], and
    /// whether it passes the alpha test.
    #[inline(always)]
    fn constant(&mut self) -> (u32, bool) {
        *self
            .constant
            .get_or_insert_with(|| Self::constant_of(self.draw, self.facet, self.primitives))
    }

    /// The packed colour of a facet whose draw is [`DrawContext::constant`], and whether it passes
    /// the alpha test.
    #[inline(always)]
    pub(crate) fn constant_of(
        draw: &DrawContext<'_>,
        facet: &Facet,
        primitives: &Primitives,
    ) -> (u32, bool) {
        let from = facet.provoking as usize + Self::color_of(draw, facet);
        let color = primitives.records[from..]
            .first_chunk::<4>()
            .map_or([0.0; 4], |c| c.map(|c| c.clamp(0.0, 1.0)));
        let passes = draw.state.alpha_test.is_none_or(|test| test.passes(color[3]));
        let word = (0..4).fold(0, |word, k| word | (((color[k] * 255.0 + 0.5) as u32) << (8 * k)));
        (word, passes)
    }

    /// Where the colour of the facet's side begins in a record.
    #[inline(always)]
    fn color_at(&self) -> usize {
        Self::color_of(self.draw, self.facet)
    }

    #[inline(always)]
    fn color_of(draw: &DrawContext<'_>, facet: &Facet) -> usize {
        if facet.back {
            draw.layout.back_color.unwrap_or(draw.layout.color)
        } else {
            draw.layout.color
        }
    }

    #[inline(always)]
    fn provoking_color(&self) -> [f32; 4] {
        let r = &self.primitives.records[self.facet.provoking as usize + self.color_at()..][..4];
        [r[0], r[1], r[2], r[3]]
    }

    /// Stipples and the soft borders of smooth primitives.
    #[inline(always)]
    fn covered<S: Simd>(
        &self,
        simd: S,
        x: F32x8<S>,
        y: F32x8<S>,
        color: Rgba<S>,
    ) -> (Rgba<S>, u32) {
        if self.is_shaped() { self.soft(simd, x, y, color) } else { (color, 0xff) }
    }

    #[inline(never)]
    fn soft<S: Simd>(
        &self,
        simd: S,
        x: F32x8<S>,
        y: F32x8<S>,
        mut color: Rgba<S>,
    ) -> (Rgba<S>, u32) {
        simd.vectorize(
            #[inline(always)]
            || {
                // Multiply alpha by the coverage of the primitive's kind.
                let mut pass = 0xff;
                match self.shape() {
                    None => {}
                    Some(Shape::Polygon { boundary, .. }) => {
                        // Cover by the part of the pixel inside the polygon's own edges.
                        let coverage = polygon_coverage(
                            simd,
                            x,
                            y,
                            &self.scratch.interpolation.edges,
                            boundary,
                        );
                        color[3] *= coverage;
                        pass = bits_of(coverage.simd_gt(splat(simd, 0.0)));
                    }
                    Some(Shape::Line { from, to, width, first, stipple, .. }) => {
                        // Measure how far along the line the samples lie.
                        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
                        let length = (dx * dx + dy * dy).sqrt();
                        let (ux, uy) = (dx / length, dy / length);
                        let along = (x - from[0]) * ux + (y - from[1]) * uy;
                        let smooth = self.draw.layout.smooth[1];

                        // Cover the part between the line's sides and ends.
                        if smooth {
                            let across = (x - from[0]) * -uy + (y - from[1]) * ux;
                            let coverage = overlap(across, -width * 0.5, width * 0.5);
                            color[3] *= coverage;
                            let ends = overlap(along, 0.0, length);
                            pass = bits_of((coverage * ends).simd_gt(splat(simd, 0.0)));
                        }

                        // Apply the stipple pattern, as coverage if smooth and as on and off
                        // otherwise.
                        match self.draw.layout.line_stipple {
                            Some(stippling) if smooth => {
                                let pieces = along
                                    .to_array()
                                    .map(|at| pieces(at, length, stipple, stippling));
                                color[3] *= F32x8::from_slice(simd, &pieces);
                            }
                            Some(stippling) => {
                                let steps = match first {
                                    None => along,
                                    Some(first) if dx.abs() >= dy.abs() => {
                                        (x - first) * dx.signum()
                                    }
                                    Some(first) => (y - first) * dy.signum(),
                                };
                                for (lane, step) in steps.to_array().into_iter().enumerate() {
                                    let on = stipples(
                                        stippling,
                                        stipple.wrapping_add(step.max(0.0) as u32),
                                    );
                                    pass &= !(u32::from(!on) << lane);
                                }
                            }
                            None if smooth => color[3] *= overlap(along, 0.0, length),
                            None => {}
                        }
                    }
                    Some(Shape::Point { center, size, fade, .. }) => {
                        // Cover a smooth point as a disc, and fade it.
                        if self.draw.layout.smooth[0] {
                            let coverage =
                                disc_coverage(simd, x - center[0], y - center[1], size * 0.5);
                            color[3] *= coverage;
                            pass = bits_of(coverage.simd_gt(splat(simd, 0.0)));
                        }
                        color[3] *= fade;
                    }
                }
                (color, pass)
            },
        )
    }
}
