//! The common kinds of fragments, a block of 8x8 pixels at a time: depth test, colours, writing, one after the other.
//!
//! Stencil, logic operations, masks, coverage by alpha and the seldom blend functions go row by row through
//! [`super::fragment`]; what is left is done here in three short loops, each over all samples of a block, with the same
//! operations and the same results.

use super::fragment::{ColorTile, Mixing, SAMPLES, TilePlanes, stored_depth};
use super::fragment_ops::compare::compare;
use super::fragment_ops::packed::{add_packed, add_scaled_packed, mix_packed};
use super::fragment_ops::stencil::{load_stencil, stencil_test};
use super::plane::PlaneTile;
use super::state::{Compare, StencilFace};
use super::wide::{bits_of, mask_of, max, min, select, splat};
use crate::kernel::traverse::Block;
use crate::{BLOCK, SUBPIXEL, Setup, TILE, TILE_PIXELS};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, LANES, Simd, U32x8};

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
pub(crate) fn rectangle(x: i32, y: i32, [x0, y0, x1, y1]: [i32; 4]) -> u64 {
    let columns = super::fragment::columns(x, x0, x1) as u64;
    let (first, last) = ((y0 - y).clamp(0, 8), (y1 - y).clamp(0, 8));
    (first..last).fold(0, |mask, row| mask | columns << (8 * row))
}

/// Leaves in `masks` the samples that pass the depth test, and writes their depths if the rule says so. Sample `s` of the
/// pattern lies at `positions[s]`; with fewer positions than samples, all samples have the first one's depth.
pub(crate) fn depths<S: Simd>(
    simd: S,
    setup: &Setup,
    (left, bottom): (usize, usize),
    block: &Block,
    positions: &[[i32; 2]],
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
                let [sx, sy] = positions[if positions.len() == samples { s } else { 0 }];
                let across = across(simd, setup, left as i32 * SUBPIXEL + sx);
                let (low, high) = (splat(simd, setup.z_min), splat(simd, setup.z_max));
                let mut passed = 0u64;
                for row in block.rows.clone() {
                    let bits = (masks[s] >> (8 * row)) as u32 & 0xff;
                    if bits == 0 {
                        continue;
                    }
                    let y = (bottom + row) as i32 * SUBPIXEL + sy;
                    let dy = (y - setup.origin[1]) as f32 / SUBPIXEL as f32;
                    let z = min(max(across + (setup.z + dy * setup.dz_dy), low), high);
                    let z = stored_depth(simd, z, scale);
                    let at = (block.y + row) * TILE + block.x;
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

/// Leaves in `masks` the samples that pass a stencil test which changes nothing.
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
