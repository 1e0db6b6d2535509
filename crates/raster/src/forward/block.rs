//! The common kinds of fragments, a block of 8x8 pixels at a time: depth test, colours, writing, one after the other.
//!
//! Logic operations, masks, coverage by alpha and the seldom blend functions go row by row through [`super::fragment`];
//! what is left is done here in short loops, each over all samples of a block, with the same operations and the same
//! results.

use super::fragment::{ColorTile, Mixing, SAMPLES, TilePlanes, stored_depth};
use super::fragment_ops::compare::compare;
use super::fragment_ops::packed::{add_packed, add_scaled_packed, mix_packed};
use super::fragment_ops::stencil::{load_stencil, stencil_test, stencil_update, store_stencil};
use super::plane::PlaneTile;
use super::state::{Compare, StencilFace, StencilOp};
use super::wide::{bits_of, mask_of, max, min, select, splat};
use crate::kernel::traverse::Block;
use crate::{BLOCK, SUBPIXEL, SamplePattern, Setup, TILE, TILE_PIXELS};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, I32x8, LANES, Simd, U32x8};

/// Colours of a block, packed: one for all pixels, or one each.
#[expect(clippy::large_enum_variant, reason = "it lives on the stack, for one block")]
pub(crate) enum Words {
    One(u32),
    Each([u32; BLOCK * BLOCK]),
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

/// Leaves in `masks` the samples that pass the depth test, and writes their depths if the rule says so. With one
/// place in the pattern all samples have the depth there.
pub(crate) fn depths<S: Simd>(
    simd: S,
    setup: &Setup,
    (left, bottom): (usize, usize),
    block: &Block,
    pattern: &SamplePattern,
    planes: &mut TilePlanes<'_>,
    rule: DepthRule,
    masks: &mut [u64; SAMPLES],
) {
    let samples = planes.samples;
    let Some((tile, scale)) = &mut planes.depth else { return };
    let scale = *scale;
    let values = tile.stored(samples);
    simd.vectorize(
        #[inline(always)]
        || {
            for (s, plane) in values.chunks_exact_mut(TILE_PIXELS).enumerate() {
                if masks[s] == 0 {
                    continue;
                }
                let [sx, sy] = pattern.position(if pattern.len() == samples { s } else { 0 });
                let across = across(simd, setup, left as i32 * SUBPIXEL + sx);
                let (low, high) = (splat(simd, setup.z_min), splat(simd, setup.z_max));
                let mut rows = [0.0; BLOCK];
                upwards(simd, setup, bottom as i32 * SUBPIXEL + sy).store_slice(&mut rows);
                let mut passed = 0u64;
                let plane = &mut plane[block.y * TILE + block.x..][..7 * TILE + LANES];
                for row in block.rows.clone() {
                    let bits = (masks[s] >> (8 * row)) as u32 & 0xff;
                    if bits == 0 {
                        continue;
                    }
                    let z = min(max(across + rows[row % BLOCK], low), high);
                    let z = stored_depth(simd, z, scale);
                    let at = row % BLOCK * TILE;
                    let stored = &mut plane[at..at + LANES];
                    let old = F32x8::from_slice(simd, stored);
                    let pass = match rule.func {
                        Compare::GreaterOrEqual => z.simd_ge(old),
                        Compare::Less => z.simd_lt(old),
                        Compare::LessOrEqual => z.simd_le(old),
                        func => compare(simd, func, z, old),
                    };
                    let pass = bits_of(pass) & bits;
                    passed |= u64::from(pass) << (8 * row);
                    if rule.write && pass != 0 {
                        let new = if pass == 0xff { z } else { select(mask_of(simd, pass), z, old) };
                        new.store_slice(stored);
                    }
                }
                masks[s] = passed;
            }
        },
    );
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
    let values = match tile {
        PlaneTile::Stored(values) => values,
        PlaneTile::Cleared(value) => {
            // One value decides for all.
            let stored = load_stencil(simd, &[*value; LANES]);
            if bits_of(stencil_test(simd, face, stored)) == 0 {
                *masks = [0; SAMPLES];
            }
            return;
        }
    };
    debug_assert_eq!(values.len(), samples * TILE_PIXELS);
    simd.vectorize(
        #[inline(always)]
        || {
            for (s, plane) in values.chunks_exact(TILE_PIXELS).enumerate() {
                for row in block.rows.clone() {
                    if (masks[s] >> (8 * row)) & 0xff != 0 {
                        let at = (block.y + row) * TILE + block.x;
                        let stored = load_stencil(simd, &plane[at..at + LANES]);
                        let passed = u64::from(bits_of(stencil_test(simd, face, stored)) & 0xff);
                        masks[s] &= !(0xff << (8 * row)) | passed << (8 * row);
                    }
                }
            }
        },
    );
}

/// The part of a row's depths that changes with x.
#[inline(always)]
fn across<S: Simd>(simd: S, setup: &Setup, x: i32) -> F32x8<S> {
    let dx = (x - setup.origin[0]) as f32 / SUBPIXEL as f32;
    let lanes = F32x8::from_slice(simd, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    (lanes + dx) * setup.dz_dx
}

/// The part of a block's depths that changes with y, for its eight rows.
#[inline(always)]
fn upwards<S: Simd>(simd: S, setup: &Setup, y: i32) -> F32x8<S> {
    let rows = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]) * SUBPIXEL;
    let dy: F32x8<S> = (rows + (y - setup.origin[1])).to_float();
    dy * (1.0 / SUBPIXEL as f32) * setup.dz_dy + setup.z
}

/// What a stencil test leaves behind: `covered` samples, those of them that passed it, and those that passed the depth test too.
pub(crate) fn update_stencil<S: Simd>(
    simd: S,
    block: &Block,
    planes: &mut TilePlanes<'_>,
    face: &StencilFace,
    [covered, reached, passed]: [&[u64; SAMPLES]; 3],
) {
    let samples = planes.samples;
    let Some(tile) = &mut planes.stencil else { return };
    let replaces = face.write_mask == 0xff && face.pass == StencilOp::Replace && covered == passed;
    if replaces && matches!(tile, PlaneTile::Cleared(value) if *value == face.reference) {
        return;
    }
    let values = tile.stored(samples);
    simd.vectorize(
        #[inline(always)]
        || {
            for (s, plane) in values.chunks_exact_mut(TILE_PIXELS).enumerate() {
                for row in block.rows.clone() {
                    let [covered, reached, passed] =
                        [covered, reached, passed].map(|m| (m[s] >> (8 * row)) as u32 & 0xff);
                    if covered == 0 {
                        continue;
                    }
                    let at = (block.y + row) * TILE + block.x;
                    let stored = &mut plane[at..at + LANES];
                    if replaces {
                        replace_bytes(stored, covered, face.reference);
                        continue;
                    }
                    let masks = [covered, reached, passed].map(|bits| mask_of(simd, bits));
                    let old = load_stencil(simd, stored);
                    store_stencil(stencil_update(simd, face, old, masks[0], masks[1], masks[2]), stored);
                }
            }
        },
    );
}

/// Sets the bytes of a row whose bits are set.
#[inline(always)]
fn replace_bytes(row: &mut [u8], bits: u32, value: u8) {
    const EACH: u64 = 0x0101_0101_0101_0101;
    if let Some(row) = row.first_chunk_mut::<8>() {
        // Bit i of byte i, then all bits of the bytes that are not 0.
        let single = (u64::from(bits) * EACH) & 0x8040_2010_0804_0201;
        let mask = (((single | ((single & !(EACH << 7)) + (!(EACH << 7)))) >> 7) & EACH) * 0xff;
        *row = ((u64::from_le_bytes(*row) & !mask) | ((u64::from(value) * EACH) & mask)).to_le_bytes();
    }
}

/// Writes colours to the samples of `masks`.
pub(crate) fn colors<S: Simd>(
    simd: S,
    block: &Block,
    planes: &mut TilePlanes<'_>,
    mixing: Mixing,
    words: &Words,
    masks: &[u64; SAMPLES],
) {
    let samples = planes.samples;
    let Some(ColorTile::Rgba8(tile)) = &mut planes.color else { return };
    let values = tile.stored(samples);
    simd.vectorize(
        #[inline(always)]
        || {
            for (s, plane) in values.chunks_exact_mut(TILE_PIXELS).enumerate() {
                if masks[s] == 0 {
                    continue;
                }
                for row in block.rows.clone() {
                    let bits = (masks[s] >> (8 * row)) as u32 & 0xff;
                    if bits == 0 {
                        continue;
                    }
                    let at = (block.y + row) * TILE + block.x;
                    let stored = &mut plane[at..at + LANES];
                    let new = match words {
                        Words::One(word) => <U32x8<S> as SimdBase<S>>::splat(simd, *word),
                        Words::Each(words) => U32x8::from_slice(simd, &words[8 * row..8 * row + 8]),
                    };
                    if mixing == Mixing::Replace && bits == 0xff {
                        new.store_slice(stored);
                        continue;
                    }
                    let old = U32x8::from_slice(simd, stored);
                    let new = match mixing {
                        Mixing::Add => add_packed(new, old),
                        Mixing::AddScaled => add_scaled_packed(new, old),
                        Mixing::Mix => mix_packed(new, old),
                        _ => new,
                    };
                    let new = if bits == 0xff { new } else { mask_of(simd, bits).select(new, old) };
                    new.store_slice(stored);
                }
            }
        },
    );
}
