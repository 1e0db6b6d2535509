//! One tile walks a pass: clears, images (`image.rs`), facets.

mod image;

use super::assemble::{Extent, FacetKind};
use super::block::{self, BlockWords, DepthRule, Words};
use super::fragment::{
    ColorTile, Depths, PlaneRow, RowFragments, SAMPLES, TilePlanes, columns, keeps, stored_depth,
};
use super::hard_line::HardLine;
use super::pass::{Clear, DrawContext, Item, facet_of, intersection};
use super::plane::PlaneTile;
use super::shade::{CENTERS, Shader, TexelCache};
use super::state::Compare;
use super::tiny_eight::{FacetMemory, JobContext, by_eights};
use super::wide::{splat, splat_rgba};
use crate::kernel::block::{Block, BlockSink};
use crate::kernel::plane::RowPlane;
use crate::kernel::traverse::{Placed, Window, traverse_window};
use crate::{BLOCK, SUBPIXEL, SamplePattern, Setup, TILE, TILE_PIXELS, Viewport};
use std::ops::Range;
use std::sync::atomic::Ordering;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Level, Simd, dispatch};

/// A tile of the target and its planes.
pub(crate) struct TileRun<'a> {
    index: usize,
    pub(super) x: u32,
    pub(super) y: u32,
    width: i32,
    /// The rows that are drawn: those of the target, or a strip of them.
    rows: Range<usize>,
    pub(super) planes: TilePlanes<'a>,
    /// What was seen in the tile before, if that is kept.
    seen: Option<&'a mut TexelCache>,
}

impl<'a> TileRun<'a> {
    /// Of tile number `index` these rows.
    pub(crate) fn new(
        index: usize,
        rows: Range<usize>,
        viewport: Viewport,
        planes: TilePlanes<'a>,
        seen: Option<&'a mut TexelCache>,
    ) -> Self {
        let (side, across) = (TILE as u32, viewport.tiles_x());
        let (x, y) = (index as u32 % across * side, index as u32 / across * side);
        let width = (viewport.width - x).min(side) as i32;
        let end = rows.end.min((viewport.height - y) as usize);
        Self { index, x, y, width, rows: rows.start.min(end)..end, planes, seen }
    }

    /// Everything that happens in this tile. A function of its own: whoever shares tiles among
    /// threads calls it at several places.
    #[inline(never)]
    pub(crate) fn run(
        &mut self,
        level: Level,
        items: &[Item<'_>],
        many: &SamplePattern,
        one: &SamplePattern,
    ) {
        dispatch!(level, simd => self.walk(simd, items, many, one));
    }

    #[inline(always)]
    fn walk<S: Simd>(
        &mut self,
        simd: S,
        items: &[Item<'_>],
        many: &SamplePattern,
        one: &SamplePattern,
    ) {
        // Run clears, images and jobs in the order of commands.
        let mut memory: Option<Box<FacetMemory>> = None;
        for item in items {
            match item {
                Item::Clear(clear) => self.clear(clear),
                Item::Image(image, state, ops) => self.image(simd, image, state, ops),
                Item::Job { primitives, draws }
                    if !primitives.batch.tile_range(self.index).is_empty() =>
                {
                    let memory = memory.get_or_insert_with(|| {
                        let mut memory = Box::<FacetMemory>::default();
                        memory.scratch.seen =
                            self.seen.as_deref_mut().map(std::mem::take).unwrap_or_default();
                        memory
                    });
                    self.job(simd, &JobContext { primitives, draws, many, one }, memory);
                }
                Item::Job { .. } => {}
            }
        }

        // Hand back what was seen in the tile.
        if let (Some(seen), Some(memory)) = (&mut self.seen, memory) {
            **seen = memory.scratch.seen;
        }
    }

    /// The part of a rectangle that lies in this tile, in its own pixels.
    fn part(&self, [x0, y0, x1, y1]: [i32; 4]) -> [i32; 4] {
        let (x, y) = (self.x as i32, self.y as i32);
        let (first, end) = (self.rows.start as i32, self.rows.end as i32);
        [(x0 - x).max(0), (y0 - y).max(first), (x1 - x).min(self.width), (y1 - y).min(end)]
    }

    fn clear(&mut self, clear: &Clear) {
        // Limit the rectangle to this run's rows.
        let [x0, y0, x1, y1] = self.part(clear.clip);
        if x0 >= x1 || y0 >= y1 {
            return;
        }
        let area = [x0 as usize, y0 as usize, x1 as usize, y1 as usize];
        let whole = area == [0, self.rows.start, self.width as usize, self.rows.end];
        let samples = self.planes.samples;

        // Clear each plane that the command names.
        if let (Some((color, masked)), Some(tile)) = (clear.color, &mut self.planes.color) {
            clear_color(tile, color, masked, whole, area, samples);
        }
        if let (Some(depth), Some((tile, scale))) = (clear.depth, &mut self.planes.depth) {
            let scaled = depth.clamp(0.0, 1.0) * *scale;
            let value =
                if *scale == 1.0 { scaled } else { (f64::from(scaled) + 0.5).floor() as f32 };
            self.planes.ranges.forget(u64::MAX);
            fill(tile, value, whole, area, samples, |_, new| new);
        }
        if let (Some((value, mask)), Some(tile)) = (clear.stencil, &mut self.planes.stencil) {
            fill(tile, value, whole && mask == 0xff, area, samples, |old, new| {
                old & !mask | new & mask
            });
        }
    }

    /// The facets of a job.
    fn job<S: Simd>(&mut self, simd: S, job: &JobContext<'_>, memory: &mut FacetMemory) {
        simd.vectorize(
            #[inline(always)]
            || {
                // Walk the job's triangles that touch this tile.
                let (x, y) = (self.x, self.y);
                let (mut clips, mut windows, mut tiny) =
                    ([[0; 4]; 2], [[0..0, 0..0], [0..0, 0..0]], false);
                let mut known = u32::MAX;
                let batch = &job.primitives.batch;
                for entry in batch.tile_range(self.index) {
                    let setup = batch.item(entry);
                    let facet = facet_of(job.primitives, setup.facet);
                    let draw = &job.draws[facet.draw as usize];
                    let pattern = job.pattern(draw);
                    if known != facet.draw {
                        known = facet.draw;
                        // Of filled polygons, of lines and points.
                        clips = [self.part(draw.clip), self.part(draw.state.clip)];
                        windows = clips.map(window);
                        tiny = by_eights(draw, self);
                    }

                    // Find the pixels to which the facet is limited.
                    let stroke = usize::from(facet.kind != FacetKind::Polygon);
                    let (mut clip, mut window) = (clips[stroke], &windows[stroke]);
                    let own;
                    match facet.extent(job.primitives) {
                        Extent::Whole => {}
                        Extent::Box(pixels) => {
                            clip = intersection(clip, self.part(pixels));
                            own = self::window(clip);
                            window = &own;
                        }
                        Extent::Line(line) => {
                            let tiny = tiny && facet.kind == FacetKind::Plain;
                            self.hard_line(simd, job, memory, (entry, line), clip, tiny);
                            continue;
                        }
                    }

                    // Gather tiny facets by eights.
                    let Some(place) = Placed::new(setup, (x, y), window, pattern) else { continue };
                    if tiny
                        && place.is_tiny()
                        && matches!(facet.kind, FacetKind::Polygon | FacetKind::Plain)
                    {
                        if !memory.waiting.takes(facet.draw) {
                            self.tiny_facets(simd, job, memory);
                        }
                        memory.waiting.next(entry, facet.draw).push(setup, &place);
                        continue;
                    }

                    // Draw any other facet after those that wait.
                    self.tiny_facets(simd, job, memory);
                    let shader = Shader::new(
                        facet,
                        draw,
                        job.primitives,
                        [x as f32, y as f32],
                        &mut memory.scratch,
                    );
                    let mut sink = ForwardSink {
                        run: self,
                        draw,
                        shader,
                        clip,
                        pattern,
                        words: &mut memory.words,
                    };
                    traverse_window(simd, setup, (x, y), window, pattern, &mut sink);
                }
                self.tiny_facets(simd, job, memory);
            },
        );
    }

    /// A line with hard borders, entry number `entry` of the tile lists.
    #[inline(never)]
    fn hard_line<S: Simd>(
        &mut self,
        simd: S,
        job: &JobContext<'_>,
        memory: &mut FacetMemory,
        (entry, line): (usize, &HardLine),
        clip: [i32; 4],
        tiny: bool,
    ) {
        // Gather the boxes of a tiny line with other tiny facets.
        let setup = job.primitives.batch.item(entry);
        let facet = facet_of(job.primitives, setup.facet);
        let tile = [self.x, self.y];
        if tiny {
            return line.boxes(tile, clip, |corner, mask| {
                if !memory.waiting.takes(facet.draw) {
                    self.tiny_facets(simd, job, memory);
                }
                memory.waiting.next(entry, facet.draw).push_pixels(setup, tile, corner, mask);
            });
        }

        // Draw any other line box by box.
        self.tiny_facets(simd, job, memory);
        let draw = &job.draws[facet.draw as usize];
        let shader =
            Shader::new(facet, draw, job.primitives, tile.map(|v| v as f32), &mut memory.scratch);
        let words = &mut memory.words;
        let mut sink =
            ForwardSink { run: self, draw, shader, clip, pattern: job.pattern(draw), words };
        line.boxes(tile, clip, |corner, mask| {
            sink.cover(simd, setup, &Block::of(corner, mask), &[mask])
        });
    }
}

/// Columns and rows of a part of a tile.
fn window(part: [i32; 4]) -> Window {
    let [x0, y0, x1, y1] = part.map(|v| v.max(0) as usize);
    [x0..x1, y0..y1]
}

/// Covered blocks and rows become fragments.
pub(super) struct ForwardSink<'r, 'a, 'd> {
    pub(super) run: &'r mut TileRun<'a>,
    pub(super) draw: &'d DrawContext<'d>,
    pub(super) shader: Shader<'d>,
    /// Allowed pixels within the tile.
    pub(super) clip: [i32; 4],
    pub(super) pattern: &'d SamplePattern,
    /// Memory for a block's colours.
    pub(super) words: &'r mut BlockWords,
}

impl<S: Simd> BlockSink<S> for ForwardSink<'_, '_, '_> {
    #[inline(always)]
    fn rejects(&self, _setup: &Setup, block: &Block) -> bool {
        let [x0, y0, x1, y1] = self.clip;
        let (x, y) = (block.x as i32, block.y as i32);
        x >= x1 || y >= y1 || x + BLOCK as i32 <= x0 || y + BLOCK as i32 <= y0
    }

    #[inline(always)]
    fn cover(&mut self, simd: S, setup: &Setup, block: &Block, masks: &[u64]) {
        if self.by_blocks() {
            return self.block(simd, setup, block, masks);
        }

        // Clip each row to the allowed rectangle.
        let [x0, y0, x1, y1] = self.clip;
        let allowed = columns(block.x as i32, x0, x1);
        for row in block.rows.clone() {
            let y = (block.y + row) as i32;
            if y < y0 || y >= y1 {
                continue;
            }

            // Cut the row's bits out of the masks.
            let mut bits = [0; SAMPLES];
            for (s, mask) in masks.iter().enumerate() {
                bits[s] = (mask >> (8 * row)) as u32 & 0xff & allowed;
            }
            if bits[0] | bits[1] | bits[2] | bits[3] != 0 {
                self.row(simd, setup, block, row, bits);
            }
        }
    }
}

impl ForwardSink<'_, '_, '_> {
    /// Whether its fragments are of the common kinds, see [`super::block`].
    #[inline(always)]
    pub(super) fn by_blocks(&self) -> bool {
        let packed = !matches!(self.run.planes.color, Some(ColorTile::RgbaF32(_)));
        self.draw.ops.common && packed && !self.shader.is_shaped()
    }

    /// The common kinds of fragments, see [`super::block`]. One function, since traversals come in
    /// several kinds.
    #[inline(never)]
    fn block<S: Simd>(&mut self, simd: S, setup: &Setup, block: &Block, masks: &[u64]) {
        simd.vectorize(
            #[inline(always)]
            || self.block_inlined(simd, setup, block, masks),
        );
    }

    #[inline(always)]
    fn block_inlined<S: Simd>(&mut self, simd: S, setup: &Setup, block: &Block, masks: &[u64]) {
        // Drop the pixels outside the rectangle or the stipple pattern.
        let (state, samples) = (self.draw.state, self.run.planes.samples);
        let place = (self.run.x as usize + block.x, self.run.y as usize + block.y);
        let mut allowed = block::rectangle(block.x as i32, block.y as i32, self.clip);
        if let (Some(pattern), FacetKind::Polygon) =
            (&state.polygon_stipple, self.shader.facet.kind)
        {
            allowed &= block::stippled(pattern, place);
        }

        // Spread one mask over all samples where the draw has no multisampling.
        let mut bits = [0; SAMPLES];
        for s in 0..samples {
            bits[s] = masks[if masks.len() == samples { s } else { 0 }] & allowed;
        }
        // What the stencil is updated by: copied only where it is needed, since a whole that is
        // read before its parts are in the cache takes long.
        let mut writes_stencil = None;
        if let Some(test) = &state.stencil {
            let face = if self.shader.facet.back { &test.back } else { &test.front };
            let covered = bits;
            block::stencil(simd, block, &mut self.run.planes, face, &mut bits);
            if !keeps(face) {
                writes_stencil = Some((face, covered, bits));
            } else if bits == [0; SAMPLES] {
                return;
            }
        }

        // Run the depth test.
        let rule = state.depth.map(|test| DepthRule { func: test.func, write: test.write });
        // Before the alpha test depth may be looked at, but not written.
        let late = state.alpha_test.is_some();
        let mut changes = false;
        if let Some(rule) = rule {
            let early = DepthRule { write: rule.write && !late, ..rule };
            changes = self.depths(simd, setup, place, block, early, &mut bits);
        }

        // Update the stencil values by the outcomes.
        if let Some((face, covered, reached)) = &writes_stencil {
            block::update_stencil(
                simd,
                block,
                &mut self.run.planes,
                face,
                [covered, reached, &bits],
            );
        }

        // Shade the visible pixels and write colours.
        let any = bits[0] | bits[1] | bits[2] | bits[3];
        if any != 0 && self.draw.shaded {
            self.block_colors(
                simd,
                setup,
                place,
                block,
                rule.filter(|rule| rule.write && changes),
                any,
                &mut bits,
            );
        }

        // Count the samples that passed.
        if let Some(query) = &state.query {
            let count: u32 = bits[..samples].iter().map(|bits| bits.count_ones()).sum();
            query.fetch_add(u64::from(count), Ordering::Relaxed);
        }
    }

    /// The colours of a block's pixels in `any`, and the alpha test, which leaves in `bits` what
    /// passes; then `write` says how its depths are written.
    #[inline(always)]
    fn block_colors<S: Simd>(
        &mut self,
        simd: S,
        setup: &Setup,
        place: (usize, usize),
        block: &Block,
        write: Option<DepthRule>,
        any: u64,
        bits: &mut [u64; SAMPLES],
    ) {
        let state = self.draw.state;
        let (one, passed) = self.shader.block(simd, setup, place, any, self.words);
        if state.alpha_test.is_some() {
            for b in &mut *bits {
                *b &= passed;
            }
            // Mostly the depths are there already, from a draw before.
            if let Some(rule) = write {
                let write = DepthRule { func: Compare::Always, ..rule };
                self.depths(simd, setup, place, block, write, bits);
            }
        }
        let words = Words::of(one, self.words);
        block::colors(simd, block, &mut self.run.planes, (&self.draw.ops, state), &words, bits);
    }

    #[inline(always)]
    fn depths<S: Simd>(
        &mut self,
        simd: S,
        setup: &Setup,
        place: (usize, usize),
        block: &Block,
        rule: DepthRule,
        bits: &mut [u64; SAMPLES],
    ) -> bool {
        block::depths(simd, setup, place, block, self.pattern, &mut self.run.planes, rule, bits)
    }

    /// A row of eight pixels, with all operations that there are.
    #[inline(never)]
    fn row<S: Simd>(
        &mut self,
        simd: S,
        setup: &Setup,
        block: &Block,
        row: usize,
        bits: [u32; SAMPLES],
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.row_inlined(simd, setup, block, row, bits),
        );
    }

    #[inline(always)]
    fn row_inlined<S: Simd>(
        &mut self,
        simd: S,
        setup: &Setup,
        block: &Block,
        row: usize,
        mut bits: [u32; SAMPLES],
    ) {
        // Drop pixels that the stipple pattern leaves out.
        let (state, samples) = (self.draw.state, self.run.planes.samples);
        let y = block.y + row;
        let (left, top) = (self.run.x as usize + block.x, self.run.y as usize + y);
        if self.shader.facet.kind == FacetKind::Polygon
            && let Some(pattern) = &state.polygon_stipple
        {
            let allowed = u32::from(block::stippled_row(pattern, (left, top)));
            for b in &mut bits {
                *b &= allowed;
            }
        }

        // Evaluate the depths of each sample.
        let mut depths: Depths<S> = [splat(simd, 0.0); SAMPLES];
        if let Some((_, scale)) = self.run.planes.depth {
            for s in 0..self.pattern.len() {
                let [sx, sy] = self.pattern.position(s);
                let (x, y) = (left as i32 * SUBPIXEL + sx, top as i32 * SUBPIXEL + sy);
                depths[s] = stored_depth(simd, RowPlane::new(simd, setup, [x, y]).row(0), scale);
            }
        }

        // Copy the first sample to all without multisampling.
        if !self.draw.multisample && samples > 1 {
            (bits, depths) = ([bits[0]; SAMPLES], [depths[0]; SAMPLES]);
        }

        // Skip a row that the depth test hides.
        let at = PlaneRow { at: y * TILE + block.x };
        let visible = self.run.planes.visible(simd, state, at, &bits, &depths);
        let mut active = visible[0] | visible[1] | visible[2] | visible[3];
        if active == 0 {
            return;
        }
        if state.stencil.is_none() {
            bits = visible;
        }

        // Shade the visible pixels.
        let mut color = splat_rgba(simd, [0.0; 4]);
        if self.draw.shaded {
            let x = F32x8::from_slice(simd, &CENTERS) + left as f32;
            let passed;
            self.shader.prepare(simd, setup);
            (color, passed) = self.shader.row(simd, x, splat(simd, top as f32 + 0.5), active);
            active &= passed;
            for b in &mut bits {
                *b &= passed;
            }
        }

        // Run the remaining operations.
        if active != 0 {
            let fragments = RowFragments {
                row: at,
                back: self.shader.facet.back,
                bits,
                depths: &depths,
                color,
            };
            self.run.planes.fragments(
                simd,
                state,
                &self.draw.ops,
                fragments,
                state.stencil.is_none(),
            );
        }
    }
}

fn clear_color(
    tile: &mut ColorTile<'_>,
    color: [f32; 4],
    masked: [bool; 4],
    whole: bool,
    area: [usize; 4],
    samples: usize,
) {
    let unmasked = masked == [false; 4];
    match tile {
        ColorTile::Rgba8(tile) => {
            let byte =
                |k: usize| u32::from((color[k].clamp(0.0, 1.0) * 255.0 + 0.5) as u8) << (8 * k);
            let value = byte(0) | byte(1) | byte(2) | byte(3);
            let protected = super::fragment_ops::logic::protected_bits(masked);
            fill(tile, value, whole && unmasked, area, samples, |old, new| {
                old & protected | new & !protected
            });
        }
        ColorTile::RgbaF32(tile) => {
            fill(tile, color, whole && unmasked, area, samples, |old, new| {
                std::array::from_fn(|k| if masked[k] { old[k] } else { new[k] })
            });
        }
    }
}

/// Sets a rectangle of all samples; the whole tile becomes a cleared one.
fn fill<T: Copy + PartialEq>(
    tile: &mut PlaneTile<T>,
    value: T,
    whole: bool,
    [x0, y0, x1, y1]: [usize; 4],
    samples: usize,
    combine: impl Fn(T, T) -> T,
) {
    // Handle the whole tile, or values that stay as they are, without touching samples.
    if whole {
        return tile.clear(value);
    }
    if tile.uniform().is_some_and(|old| combine(old, value) == old) {
        return;
    }

    // Combine the rectangle, sample by sample.
    let values = tile.stored(samples);
    for s in 0..samples {
        for y in y0..y1 {
            let start = s * TILE_PIXELS + y * TILE;
            for v in &mut values[start + x0..start + x1] {
                *v = combine(*v, value);
            }
        }
    }
}
