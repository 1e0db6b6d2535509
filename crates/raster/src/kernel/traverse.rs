//! Walking a triangle through a tile, in blocks of 8x8 pixels.
//!
//! Each edge function is linear; inside a tile it is `a x + b y + c` for pixel `(x, y)` with one constant a sample,
//! exactly, in 32-bit integers: positions are multiples of 1/256 pixel, so with a fixed sample position the sign of
//! the edge function is that of its value divided by 256 and rounded down.
//!
//! Source: [Pineda 1988]; hierarchical traversal after [Greene 1996].

use crate::setup::is_top_left;
use crate::{BLOCK, SUBPIXEL, SamplePattern, Setup, TILE};
use std::ops::Range;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{I32x8, Simd};

/// A block of 8x8 pixels of a tile.
#[derive(Clone, Debug)]
pub struct Block {
    /// Left pixel column within the tile.
    pub x: usize,
    /// Top pixel row within the tile.
    pub y: usize,
    /// Rows of the block that may hold covered samples.
    pub rows: Range<usize>,
}

impl Block {
    /// Its number in the tile, row by row.
    pub fn index(&self) -> usize {
        self.y / BLOCK * (TILE / BLOCK) + self.x / BLOCK
    }
}

/// What to do with covered samples.
pub trait BlockSink<S: Simd> {
    /// Whether nothing of `setup` can matter in this block, so that coverage need not be computed.
    fn rejects(&self, setup: &Setup, block: &Block) -> bool;

    /// `masks[s]` has bit `8 * row + column` set where sample `s` of the block's pixel is covered; not all are 0.
    fn cover(&mut self, simd: S, setup: &Setup, block: &Block, masks: &[u64]);
}

/// An edge function within one tile: `a * x + b * y + c[s] >= 0` on covered samples.
#[derive(Clone, Copy)]
struct Edge {
    a: i32,
    b: i32,
}

/// Larger constants decide the sign by themselves: `|a x + b y| < 2^30` inside a tile.
const FAR_AWAY: i64 = 1 << 30;

/// Pixels of a tile, columns and rows.
type Window = [Range<usize>; 2];

/// Hands every block of the tile at pixel `(tile_x, tile_y)` that `setup` covers to `sink`.
#[inline(always)]
pub fn traverse<S: Simd, K: BlockSink<S>>(
    simd: S,
    setup: &Setup,
    tile: (u32, u32),
    pattern: &SamplePattern,
    sink: &mut K,
) {
    traverse_window(simd, setup, tile, &[0..TILE, 0..TILE], pattern, sink);
}

/// [`traverse`] for the one block whose top left pixel within the tile is `(x, y)`.
#[inline(always)]
pub fn traverse_block<S: Simd, K: BlockSink<S>>(
    simd: S,
    setup: &Setup,
    tile: (u32, u32),
    (x, y): (usize, usize),
    pattern: &SamplePattern,
    sink: &mut K,
) {
    traverse_window(simd, setup, tile, &[x..x + BLOCK, y..y + BLOCK], pattern, sink);
}

#[inline(always)]
fn traverse_window<S: Simd, K: BlockSink<S>>(
    simd: S,
    setup: &Setup,
    tile: (u32, u32),
    window: &Window,
    pattern: &SamplePattern,
    sink: &mut K,
) {
    match pattern.len() {
        1 => traverse_samples::<S, K, 1>(simd, setup, tile, window, pattern, sink),
        4 => traverse_samples::<S, K, 4>(simd, setup, tile, window, pattern, sink),
        _ => traverse_samples::<S, K, 16>(simd, setup, tile, window, pattern, sink),
    }
}

/// `MOST` is the number of samples, or 16 where there are fewer.
#[inline(always)]
fn traverse_samples<S: Simd, K: BlockSink<S>, const MOST: usize>(
    simd: S,
    setup: &Setup,
    (tile_x, tile_y): (u32, u32),
    [columns, rows]: &Window,
    pattern: &SamplePattern,
    sink: &mut K,
) {
    let samples = if MOST == 16 { pattern.len().min(MOST) } else { MOST };
    let (origin_x, origin_y) = (tile_x as i32 * SUBPIXEL, tile_y as i32 * SUBPIXEL);
    let x = setup.x.map(|x| x - origin_x);
    let y = setup.y.map(|y| y - origin_y);
    let [extent_x, extent_y] = pattern.extent();

    // The pixels of the window that the triangle's box may cover.
    let first = |v: [i32; 3], e: [i32; 2]| (v[0].min(v[1]).min(v[2]) - e[1] + SUBPIXEL - 1) >> 8;
    let last = |v: [i32; 3], e: [i32; 2]| (v[0].max(v[1]).max(v[2]) - e[0]) >> 8;
    let (x0, x1, y0, y1) = (first(x, extent_x), last(x, extent_x), first(y, extent_y), last(y, extent_y));
    let side = BLOCK as i32;
    let several = x0 / side != x1 / side || y0 / side != y1 / side;
    let (x0, x1) = (x0.max(columns.start as i32), x1.min(columns.end as i32 - 1));
    let (y0, y1) = (y0.max(rows.start as i32), y1.min(rows.end as i32 - 1));
    if x1 < x0 || y1 < y0 {
        return;
    }
    let (x0, x1, y0, y1) = (x0 as usize, x1 as usize, y0 as usize, y1 as usize);

    // Edge functions at the tile's origin, one constant a sample.
    let mut edges = [Edge { a: 0, b: 0 }; 3];
    let mut constants = [[0i32; 3]; MOST];
    for i in 0..3 {
        let j = (i + 1) % 3;
        let (dx, dy) = (x[j] - x[i], y[j] - y[i]);
        edges[i] = Edge { a: -dy, b: dx };
        let bias = if is_top_left(dx, dy) { 0 } else { -1 };
        let corner = i64::from(dy) * i64::from(x[i]) - i64::from(dx) * i64::from(y[i]) + bias;
        for s in 0..samples {
            let [sx, sy] = pattern.position(s);
            let c = corner + i64::from(dx) * i64::from(sy) - i64::from(dy) * i64::from(sx);
            constants[s][i] = (c >> 8).clamp(-FAR_AWAY, FAR_AWAY) as i32;
        }
    }

    let lane = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
    let across = [lane * edges[0].a, lane * edges[1].a, lane * edges[2].a];
    let mut masks = [0u64; MOST];
    for by in (y0 & !(BLOCK - 1)..=y1).step_by(BLOCK) {
        let rows = y0.max(by) - by..(y1 + 1).min(by + BLOCK) - by;
        for bx in (x0 & !(BLOCK - 1)..=x1).step_by(BLOCK) {
            let block = Block { x: bx, y: by, rows: rows.clone() };
            if sink.rejects(setup, &block) {
                continue;
            }
            let mut any = 0;
            for s in 0..samples {
                let mut at_block = constants[s];
                for i in 0..3 {
                    at_block[i] += edges[i].a * bx as i32 + edges[i].b * by as i32;
                }
                let known = if several { corner_test(&edges, at_block) } else { None };
                masks[s] = match known {
                    Some(mask) => mask,
                    None => mask_rows(simd, &edges, &across, at_block, rows.clone()),
                };
                any |= masks[s];
            }
            if any != 0 {
                sink.cover(simd, setup, &block, &masks[..samples]);
            }
        }
    }
}

/// All or nothing of a block by its corner samples; `None` if it has to be looked at.
#[inline(always)]
fn corner_test(edges: &[Edge; 3], at_block: [i32; 3]) -> Option<u64> {
    let side = BLOCK as i32 - 1;
    let mut full = true;
    for i in 0..3 {
        let (a, b) = (edges[i].a * side, edges[i].b * side);
        if at_block[i] + a.max(0) + b.max(0) < 0 {
            return Some(0);
        }
        full &= at_block[i] + a.min(0) + b.min(0) >= 0;
    }
    full.then_some(u64::MAX)
}

/// The coverage mask of the block's `rows`, eight pixels a step.
#[inline(always)]
fn mask_rows<S: Simd>(
    simd: S,
    edges: &[Edge; 3],
    across: &[I32x8<S>; 3],
    at_block: [i32; 3],
    rows: Range<usize>,
) -> u64 {
    let zero = I32x8::splat(simd, 0);
    let mut e = *across;
    for i in 0..3 {
        e[i] += at_block[i] + edges[i].b * rows.start as i32;
    }
    let mut mask = 0;
    for row in rows {
        let inside = (e[0] | e[1] | e[2]).simd_ge(zero).to_bitmask();
        mask |= inside << (8 * row);
        for i in 0..3 {
            e[i] += edges[i].b;
        }
    }
    mask
}
