//! The common kinds of fragments, a block of 8x8 pixels at a time: depth test, colours, writing,
//! one after the other.
//!
//! Coverage by alpha, soft borders, sRGB and floating-point colours go row by row through
//! [`super::fragment`]; the other kinds are done here in short loops, each over all samples of a
//! block, with the same operations and the same results.

use super::depth_ranges::{Verdict, verdict};
use super::fragment::{
    BlendPath, ColorTile, FragmentOps, SAMPLES, TilePlanes, stored, stored_depth,
};
use super::fragment_ops::blend::blend_packed;
use super::fragment_ops::compare::holds;
use super::fragment_ops::logic::{logic_op, write_unprotected};
use super::fragment_ops::stencil::{load_stencil, stencil_test, stencil_update, store_stencil};
use super::pass::places;
use super::plane::PlaneTile;
use super::state::{Compare, FragmentState, StencilFace, StencilOp};
use super::surface::Surface;
use super::wide::{bits_of, every, mask_of, max, min, select, splat};
use crate::kernel::block::Block;
use crate::setup::DepthPlane;
use crate::{BLOCK, SUBPIXEL, SamplePattern, Setup, TILE, TILE_PIXELS};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, F32x16, I32x8, LANES, Mask16, Simd, U32x8, U32x16};

/// A block's packed colours.
pub(crate) type BlockWords = [u32; BLOCK * BLOCK];

/// Colours of a block, packed: one for all pixels, or one each.
pub(crate) enum Words<'a> {
    /// The same colour for all pixels.
    One(u32),
    /// One colour for each pixel, row by row.
    Each(&'a BlockWords),
}

impl<'a> Words<'a> {
    /// As [`super::shade::Shader::block`] gives them.
    #[inline(always)]
    pub(crate) fn of(one: Option<u32>, each: &'a BlockWords) -> Self {
        one.map_or(Self::Each(each), Self::One)
    }
}

/// What depths meet.
#[derive(Clone, Copy)]
pub(crate) struct DepthRule {
    pub func: Compare,
    pub write: bool,
}

/// The pixels of a block at `(x, y)` that lie in `x0..x1`, `y0..y1`: bit `8 * row + column`.
#[inline(always)]
pub(crate) fn rectangle(x: i32, y: i32, [x0, y0, x1, y1]: [i32; 4]) -> u64 {
    let side = BLOCK as i32;
    if x >= x0 && y >= y0 && x + side <= x1 && y + side <= y1 {
        return u64::MAX;
    }
    let columns = super::fragment::columns(x, x0, x1) as u64;
    let (first, last) = ((y0 - y).clamp(0, 8), (y1 - y).clamp(0, 8));
    (first..last).fold(0, |mask, row| mask | columns << (8 * row))
}

/// Which of the eight pixels from `(left, y)` on, `left` a multiple of eight, a polygon stipple
/// lets pass.
pub(crate) fn stippled_row(pattern: &[u32; 32], (left, y): (usize, usize)) -> u8 {
    // The leftmost pixel is the highest bit.
    ((pattern[y % 32] >> (24 - left % 32)) as u8).reverse_bits()
}

/// The same for the block at pixel `(left, bottom)`.
pub(crate) fn stippled(pattern: &[u32; 32], (left, bottom): (usize, usize)) -> u64 {
    let row = |row: usize| u64::from(stippled_row(pattern, (left, bottom + row)));
    (0..BLOCK).fold(0, |mask, k| mask | row(k) << (BLOCK * k))
}

/// Rows of a block that are computed at once, as sixteen lanes hold two.
const ROWS_AT_ONCE: usize = 2;

/// A triangle's depths in a block, for one of its samples: those of row `k` are `across + rows[k]`.
#[derive(Clone, Copy)]
pub(super) struct Slope<S: Simd> {
    /// Depths in row 0, as far as columns change them.
    across: F32x8<S>,
    /// What each row adds.
    rows: [f32; BLOCK],
}

impl<S: Simd> Slope<S> {
    /// For the block at pixel `(left, bottom)` of the target, and the sample at `[x, y]` of its
    /// pixels, in 1/256 pixel.
    #[inline(always)]
    fn new(simd: S, plane: &DepthPlane, (left, bottom): (usize, usize), [x, y]: [i32; 2]) -> Self {
        let mut rows = [0.0; BLOCK];
        upwards(simd, plane, bottom as i32 * SUBPIXEL + y).store_slice(&mut rows);
        Self { across: across(simd, plane, left as i32 * SUBPIXEL + x), rows }
    }

    /// The depths of rows `row` and `row + 1` as stored.
    #[inline(always)]
    fn two_rows(&self, simd: S, row: usize, [low, high]: [f32; 2], scale: f32) -> F32x16<S> {
        let [first, second] =
            [splat(simd, self.rows[row % BLOCK]), splat(simd, self.rows[(row + 1) % BLOCK])];
        let depths = self.across.combine(self.across) + first.combine(second);
        stored_depth(simd, min(max(depths, every(simd, low)), every(simd, high)), scale)
    }

    /// The least and the largest depth of the block: sums are ordered as their terms are, however
    /// they are rounded.
    #[inline(always)]
    fn bounds(&self) -> [f32; 2] {
        let across = self.across.to_array();
        let sorted = |a: f32, b: f32| if a < b { [a, b] } else { [b, a] };
        let (x, y) =
            (sorted(across[0], across[LANES - 1]), sorted(self.rows[0], self.rows[BLOCK - 1]));
        [x[0] + y[0], x[1] + y[1]]
    }
}

/// What a block's depth test works with.
struct Test<'a, S: Simd> {
    /// Depths of each sample.
    slopes: &'a [Slope<S>; SAMPLES],
    /// Farthest and nearest depth of the facet.
    limits: [f32; 2],
    /// Largest stored depth: 1 for floats, 2^n - 1 for integers of n bits.
    scale: f32,
    write: bool,
}

impl<'a, S: Simd> Test<'a, S> {
    #[inline(always)]
    fn new(surface: &Surface, slopes: &'a [Slope<S>; SAMPLES], write: bool) -> Self {
        Self {
            slopes,
            limits: [surface.plane.z_min, surface.plane.z_max],
            scale: surface.scale,
            write,
        }
    }
}

/// The first rows of those pairs of rows in which bits are set.
#[inline(always)]
fn pairs(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let row = mask.trailing_zeros() as usize / (ROWS_AT_ONCE * BLOCK) * ROWS_AT_ONCE;
        let found = (mask != 0).then_some(row);
        mask &= !(0xffff_u64.wrapping_shl((BLOCK * row) as u32));
        found
    })
}

/// Two rows of a tile's plane of samples, eight pixels each: those from `at` on.
#[inline(always)]
fn rows_from<T>(plane: &mut [T], at: usize) -> [&mut [T]; ROWS_AT_ONCE] {
    let (first, second) = plane[at..at + TILE + LANES].split_at_mut(TILE);
    [&mut first[..LANES], second]
}

/// Leaves in `masks` the samples that pass the depth test, and writes their depths if the rule says
/// so. With one place in the pattern all samples have the depth there. Gives whether depths of
/// samples that passed may differ from what was stored.
pub(crate) fn depths<S: Simd>(
    simd: S,
    setup: &Setup,
    place: (usize, usize),
    block: &Block,
    pattern: &SamplePattern,
    planes: &mut TilePlanes<'_>,
    rule: DepthRule,
    masks: &mut [u64; SAMPLES],
) -> bool {
    let samples = planes.samples;
    let Some((tile, scale)) = &mut planes.depth else { return false };
    let (scale, ranges) = (*scale, &mut planes.ranges);
    simd.vectorize(
        #[inline(always)]
        || {
            let count = pattern.len().min(samples).min(SAMPLES);
            let (index, surface) = (block.index(), Surface::new(setup, place, count, scale));
            let before = if block.is_aligned() { tile.surface(index).copied() } else { None };

            // A surface that is drawn over itself is equal to what is stored, at every sample.
            if before == Some(surface) {
                if !holds(rule.func, 0.0, 0.0) {
                    *masks = [0; SAMPLES];
                }
                return false;
            }

            // Where nothing was drawn yet, the depths of the whole triangle mostly tell.
            let (touched, full) = (block.touched(), (0..samples).all(|s| masks[s] == u64::MAX));
            let empty = tile.cleared(touched).filter(|_| full && rule.write && block.is_aligned());
            if empty.is_some_and(|empty| whole_passes(setup, scale, rule.func, empty)) {
                ranges.forget(touched);
                tile.set_surface(index, surface);
                return true;
            }

            // Compare the range of the block's depths with that of what is stored.
            let together = pattern.len() != samples && all_alike(masks, samples);
            let slopes = surface.slopes(simd);
            let test = Test::new(&surface, &slopes, rule.write);
            let old = ranges.of(simd, tile, index, samples);
            let new = surface.bounds(&slopes);
            let verdict = verdict(rule.func, new, old);
            if verdict == Verdict::AllFail {
                *masks = [0; SAMPLES];
                return false;
            }
            if verdict == Verdict::AllPass && !rule.write {
                return true;
            }

            // Store a block that is covered and passes as a whole: as its plane, if it is one of
            // the tile's blocks.
            if verdict == Verdict::AllPass && full {
                ranges.set(index, new);
                if block.is_aligned() {
                    tile.set_surface(index, surface);
                } else {
                    write_out(simd, tile, block, (together, samples), &test);
                }
                return true;
            }

            // Test sample by sample what is stored, or was stored as a plane.
            if let Some(before) = before {
                let slopes = before.slopes(simd);
                write_out(
                    simd,
                    tile,
                    block,
                    (before.places == 1, samples),
                    &Test::new(&before, &slopes, true),
                );
            }
            if rule.write {
                ranges.set(block.index(), [old[0].min(new[0]), old[1].max(new[1])]);
            }
            let opened = tile.open(touched, together, samples);
            let passing =
                Passing::new(if verdict == Verdict::AllPass { Compare::Always } else { rule.func });
            pass_samples(simd, block, opened, &test, passing, masks, samples)
        },
    )
}

/// Writes the depths of a surface to all samples of a block; `together`: they are the same at all
/// samples of a pixel.
#[inline(always)]
fn write_out<S: Simd>(
    simd: S,
    tile: &mut PlaneTile<f32>,
    block: &Block,
    (together, samples): (bool, usize),
    test: &Test<'_, S>,
) {
    let values = tile.replace(block.touched(), together, samples);
    fill(simd, block, values, if together { 1 } else { samples }, test);
}

/// Whether a triangle passes wherever it lies, against a block that holds `empty` everywhere.
#[inline(always)]
fn whole_passes(setup: &Setup, scale: f32, func: Compare, empty: f32) -> bool {
    let all = [setup.z_min, setup.z_max].map(|depth| stored(depth, scale));
    verdict(func, all, [empty; 2]) == Verdict::AllPass
}

/// Tests the samples of the first `count` planes, which stand for all `samples`; gives whether
/// depths may have changed.
#[inline(always)]
fn pass_samples<S: Simd>(
    simd: S,
    block: &Block,
    (count, values): (usize, &mut [f32]),
    test: &Test<'_, S>,
    passing: Passing,
    masks: &mut [u64; SAMPLES],
    samples: usize,
) -> bool {
    let mut changed = 0;
    for (s, plane) in values.chunks_exact_mut(TILE_PIXELS).enumerate().take(count) {
        let place = (block, plane, &test.slopes[s % SAMPLES]);
        changed |= pass_rows(simd, place, test, passing, &mut masks[s]);
    }
    agree(masks, count, samples);
    changed != 0
}

/// Whether all samples have the same mask.
#[inline(always)]
fn all_alike(masks: &[u64; SAMPLES], samples: usize) -> bool {
    (1..samples.min(SAMPLES)).all(|s| masks[s] == masks[0])
}

/// After one sample stood for all, gives them its mask.
#[inline(always)]
fn agree(masks: &mut [u64; SAMPLES], count: usize, samples: usize) {
    if count < samples {
        *masks = [masks[0]; SAMPLES];
    }
}

impl Surface {
    /// The triangle's depths in the block, for each place.
    #[inline(always)]
    fn slopes<S: Simd>(&self, simd: S) -> [Slope<S>; SAMPLES] {
        let (place, places) =
            ((self.place[0] as usize, self.place[1] as usize), places(self.places));
        let mut slopes = [Slope::new(simd, &self.plane, place, places[0]); SAMPLES];
        for s in 1..places.len().min(SAMPLES) {
            slopes[s] = Slope::new(simd, &self.plane, place, places[s]);
        }
        slopes
    }

    /// The least and the largest depth in the block, as stored.
    #[inline(always)]
    fn bounds<S: Simd>(&self, slopes: &[Slope<S>; SAMPLES]) -> [f32; 2] {
        let mut all = slopes[0].bounds();
        for slope in &slopes[1..self.places.clamp(1, SAMPLES)] {
            let [low, high] = slope.bounds();
            all = [all[0].min(low), all[1].max(high)];
        }
        let limited =
            |depth: f32| stored(depth.max(self.plane.z_min).min(self.plane.z_max), self.scale);
        [limited(all[0]), limited(all[1])]
    }

    /// [`Self::bounds`], for who has nothing but the surface.
    #[inline(always)]
    pub(super) fn range<S: Simd>(&self, simd: S) -> [f32; 2] {
        self.bounds(&self.slopes(simd))
    }
}

/// Writes all depths of a block.
#[inline(always)]
fn fill<S: Simd>(simd: S, block: &Block, values: &mut [f32], count: usize, test: &Test<'_, S>) {
    for (s, plane) in values.chunks_exact_mut(TILE_PIXELS).enumerate().take(count) {
        let slope = &test.slopes[s % SAMPLES];
        let plane = &mut plane[block.y * TILE + block.x..][..7 * TILE + LANES];
        for row in (0..BLOCK).step_by(ROWS_AT_ONCE) {
            let [first, second] = rows_from(plane, row * TILE);
            let (low, high) = slope.two_rows(simd, row, test.limits, test.scale).split();
            low.store_slice(first);
            high.store_slice(second);
        }
    }
}

/// A depth function as bits of two rows: what passes is
/// `((at_least ^ flip[0] | any[0]) & (at_most ^ flip[1] | any[1])) ^ other`. So all functions are
/// one piece of code without branches.
#[derive(Clone, Copy)]
pub(super) struct Passing {
    /// Bits that exchange passing and failing of each of the two comparisons.
    flip: [u32; 2],
    /// Bits that make each of the two comparisons pass in any case.
    any: [u32; 2],
    other: u32,
}

impl Passing {
    #[inline(always)]
    pub(super) fn new(func: Compare) -> Self {
        let all = 0xffff;
        let (flip, any, other) = match func {
            Compare::Less => ([all, 0], [0, 0], 0),
            Compare::Greater => ([0, all], [0, 0], 0),
            Compare::Equal => ([0, 0], [0, 0], 0),
            Compare::NotEqual => ([0, 0], [0, 0], all),
            Compare::LessOrEqual => ([0, 0], [all, 0], 0),
            Compare::GreaterOrEqual => ([0, 0], [0, all], 0),
            Compare::Always => ([0, 0], [all, all], 0),
            Compare::Never => ([0, 0], [all, all], all),
        };
        Self { flip, any, other }
    }

    /// Those that pass, of sixteen new depths of which these are at least, and at most, the old
    /// ones.
    #[inline(always)]
    pub(super) fn of(&self, at_least: u32, at_most: u32) -> u32 {
        ((at_least ^ self.flip[0] | self.any[0]) & (at_most ^ self.flip[1] | self.any[1]))
            ^ self.other
    }
}

/// Leaves in `mask` the samples whose new depths pass, and writes these if the test does. Not 0 if
/// one of them differs from what was stored.
#[inline(always)]
fn pass_rows<S: Simd>(
    simd: S,
    (block, plane, slope): (&Block, &mut [f32], &Slope<S>),
    test: &Test<'_, S>,
    passing: Passing,
    mask: &mut u64,
) -> u32 {
    // Compare two rows of eight samples in each step.
    let plane = &mut plane[block.y * TILE + block.x..][..7 * TILE + LANES];
    let (mut passed, mut changed) = (0, 0);
    for row in pairs(*mask) {
        let new = slope.two_rows(simd, row, test.limits, test.scale);
        let [first, second] = rows_from(plane, row * TILE);
        let old = F32x8::from_slice(simd, first).combine(F32x8::from_slice(simd, second));
        let (at_least, at_most) = (bits_of(new.simd_ge(old)), bits_of(new.simd_le(old)));
        let pass = passing.of(at_least, at_most) & (*mask >> (8 * row)) as u32 & 0xffff;
        passed |= u64::from(pass) << (8 * row);
        changed |= pass & !(at_least & at_most);
        // Write the new depths where they pass.
        if test.write {
            let (low, high) = select(Mask16::from_bitmask(simd, u64::from(pass)), new, old).split();
            low.store_slice(first);
            high.store_slice(second);
        }
    }
    *mask = passed;
    changed
}

/// Leaves in `masks` the samples that pass a stencil test; what it writes is [`update_stencil`]'s.
pub(crate) fn stencil<S: Simd>(
    simd: S,
    block: &Block,
    planes: &mut TilePlanes<'_>,
    face: &StencilFace,
    masks: &mut [u64; SAMPLES],
) {
    let samples = planes.samples;
    let Some(tile) = &mut planes.stencil else { return };

    // Decide a tile that was only cleared with one test.
    if let Some(value) = tile.uniform() {
        // One value decides for all.
        let passes = simd.vectorize(
            #[inline(always)]
            || bits_of(stencil_test(simd, face, load_stencil(simd, &[value; LANES]))) != 0,
        );
        if !passes {
            *masks = [0; SAMPLES];
        }
        return;
    }

    // Test the rows of the block, once for all samples if they agree.
    let together = all_alike(masks, samples);
    let (count, values) = tile.open(block.touched(), together, samples);
    simd.vectorize(
        #[inline(always)]
        || {
            for (s, plane) in values.chunks_exact(TILE_PIXELS).enumerate().take(count) {
                for row in block.rows.clone() {
                    if (masks[s] >> (8 * row)) & 0xff != 0 {
                        let at = (block.y + row) * TILE + block.x;
                        let stored = load_stencil(simd, &plane[at..at + LANES]);
                        let passed = u64::from(bits_of(stencil_test(simd, face, stored)) & 0xff);
                        masks[s] &= !(0xff << (8 * row)) | passed << (8 * row);
                    }
                }
            }
            agree(masks, count, samples);
        },
    );
}

/// The part of a row's depths that changes with x.
#[inline(always)]
fn across<S: Simd>(simd: S, plane: &DepthPlane, x: i32) -> F32x8<S> {
    let dx = (x - plane.origin[0]) as f32 / SUBPIXEL as f32;
    let lanes = F32x8::from_slice(simd, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    (lanes + dx) * plane.dz_dx
}

/// The part of a block's depths that changes with y, for its eight rows.
#[inline(always)]
fn upwards<S: Simd>(simd: S, plane: &DepthPlane, y: i32) -> F32x8<S> {
    let rows = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]) * SUBPIXEL;
    let dy: F32x8<S> = (rows + (y - plane.origin[1])).to_float();
    dy * (1.0 / SUBPIXEL as f32) * plane.dz_dy + plane.z
}

/// What a stencil test leaves behind: `covered` samples, those of them that passed it, and those
/// that passed the depth test too.
pub(crate) fn update_stencil<S: Simd>(
    simd: S,
    block: &Block,
    planes: &mut TilePlanes<'_>,
    face: &StencilFace,
    [covered, reached, passed]: [&[u64; SAMPLES]; 3],
) {
    let samples = planes.samples;
    let Some(tile) = &mut planes.stencil else { return };

    // Skip a replacement that changes nothing.
    let replaces = face.write_mask == 0xff && face.pass == StencilOp::Replace && covered == passed;
    if replaces && tile.uniform() == Some(face.reference) {
        return;
    }

    // Update the rows of the block, once for all samples if they agree.
    let together = [covered, reached, passed].iter().all(|masks| all_alike(masks, samples));
    let (count, values) = tile.open(block.touched(), together, samples);
    simd.vectorize(
        #[inline(always)]
        || {
            for (s, plane) in values.chunks_exact_mut(TILE_PIXELS).enumerate().take(count) {
                for row in block.rows.clone() {
                    let [covered, reached, passed] =
                        [covered, reached, passed].map(|m| (m[s] >> (8 * row)) as u32 & 0xff);
                    if covered == 0 {
                        continue;
                    }
                    let at = (block.y + row) * TILE + block.x;
                    let stored = &mut plane[at..at + LANES];
                    // Replace without reading the stored colours.
                    if replaces {
                        replace_bytes(stored, covered, face.reference);
                        continue;
                    }

                    // Apply the operations of the outcomes.
                    let masks = [covered, reached, passed].map(|bits| mask_of(simd, bits));
                    let old = load_stencil(simd, stored);
                    store_stencil(
                        stencil_update(simd, face, old, masks[0], masks[1], masks[2]),
                        stored,
                    );
                }
            }
        },
    );
}

/// Sets the bytes of a row whose bits are set.
#[inline(always)]
fn replace_bytes(row: &mut [u8], bits: u32, value: u8) {
    const LOW_BITS: u64 = 0x0101_0101_0101_0101;
    if let Some(row) = row.first_chunk_mut::<8>() {
        // Bit i of byte i, then all bits of the bytes that are not 0.
        let single = (u64::from(bits) * LOW_BITS) & 0x8040_2010_0804_0201;
        let mask = (((single | ((single & !(LOW_BITS << 7)) + (!(LOW_BITS << 7)))) >> 7)
            & LOW_BITS)
            * 0xff;
        *row = ((u64::from_le_bytes(*row) & !mask) | ((u64::from(value) * LOW_BITS) & mask))
            .to_le_bytes();
    }
}

/// Writes colours to the samples of `masks`, as a draw's state has it.
pub(crate) fn colors<S: Simd>(
    simd: S,
    block: &Block,
    planes: &mut TilePlanes<'_>,
    (ops, state): (&FragmentOps, &FragmentState),
    words: &Words<'_>,
    masks: &[u64; SAMPLES],
) {
    let samples = planes.samples;
    let Some(ColorTile::Rgba8(tile)) = planes.color.as_mut().filter(|_| !ops.all_protected) else {
        return;
    };
    let together = all_alike(masks, samples);
    simd.vectorize(
        #[inline(always)]
        || {
            // Fill an aligned block that is covered whole.
            let replaces = ops.blend_path == BlendPath::Replace && ops.protected == 0;
            if replaces && together && masks[0] == u64::MAX && block.is_aligned() {
                replace_block(simd, block, tile.replace(block.touched(), true, samples), words);
                return;
            }

            // Move a block that would reach beyond the tile up, so that its words become the last
            // rows.
            let (count, values) = tile.open(block.touched(), together, samples);
            let below = block.y.saturating_sub(TILE - BLOCK);
            let mut copy;
            let words = match words {
                Words::Each(words) if below == 0 => *words,
                Words::Each(words) => {
                    copy = [0; BLOCK * BLOCK];
                    copy[BLOCK * below..].copy_from_slice(&words[..BLOCK * (BLOCK - below)]);
                    &copy
                }
                Words::One(word) => {
                    copy = [*word; BLOCK * BLOCK];
                    &copy
                }
            };

            // Mix the words with what is there, sample by sample.
            for (s, plane) in values.chunks_exact_mut(TILE_PIXELS).enumerate().take(count) {
                let mask = masks[s] << (BLOCK * below);
                let plane = &mut plane[(block.y - below) * TILE + block.x..][..7 * TILE + LANES];
                if ops.protected == 0 && ops.blend_path.is_simple() {
                    each_two_rows(
                        simd,
                        words,
                        mask,
                        plane,
                        #[inline(always)]
                        |new, old| ops.blend_path.blend_fast(new, old),
                    );
                } else {
                    write_seldom_rows(simd, words, (ops, state), mask, plane);
                }
            }
        },
    );
}

/// Writes colours to all pixels of a block.
#[inline(always)]
fn replace_block<S: Simd>(simd: S, block: &Block, values: &mut [u32], words: &Words<'_>) {
    let plane = &mut values[block.y * TILE + block.x..][..7 * TILE + LANES];
    for row in 0..BLOCK {
        let new = match words {
            Words::One(word) => <U32x8<S> as SimdBase<S>>::splat(simd, *word),
            Words::Each(words) => U32x8::from_slice(simd, &words[BLOCK * row..BLOCK * (row + 1)]),
        };
        new.store_slice(&mut plane[row * TILE..row * TILE + LANES]);
    }
}

/// Writes colours to the pixels of `mask` with all that a draw's state may have: seldom factors,
/// logical operations, masks.
#[inline(never)]
fn write_seldom_rows<S: Simd>(
    simd: S,
    words: &BlockWords,
    (ops, state): (&FragmentOps, &FragmentState),
    mask: u64,
    stored: &mut [u32],
) {
    simd.vectorize(
        #[inline(always)]
        || {
            each_two_rows(
                simd,
                words,
                mask,
                stored,
                #[inline(always)]
                |new, old| {
                    let mixed = match (ops.blend_path, &state.blend) {
                        (BlendPath::Logic(op), _) => logic_op(op, new, old),
                        (BlendPath::General, Some(blend)) => {
                            blend_packed::<S, F32x16<S>>(simd, blend, new, old)
                        }
                        (blend_path, _) => blend_path.blend_fast(new, old),
                    };
                    write_unprotected(mixed, old, ops.protected)
                },
            );
        },
    );
}

/// Brings what `mix` makes of new and stored colours to the pixels of `mask`; `stored` begins with
/// the block's first.
#[inline(always)]
fn each_two_rows<S: Simd>(
    simd: S,
    words: &BlockWords,
    mask: u64,
    stored: &mut [u32],
    mix: impl Fn(U32x16<S>, U32x16<S>) -> U32x16<S>,
) {
    for row in pairs(mask) {
        let new = U32x16::from_slice(simd, &words[BLOCK * row..BLOCK * (row + ROWS_AT_ONCE)]);
        let [first, second] = rows_from(stored, row * TILE);
        let old = U32x8::from_slice(simd, first).combine(U32x8::from_slice(simd, second));
        let new = mix(new, old);
        let (low, high) =
            Mask16::from_bitmask(simd, (mask >> (8 * row)) & 0xffff).select(new, old).split();
        low.store_slice(first);
        high.store_slice(second);
    }
}

#[cfg(test)]
mod tests;
