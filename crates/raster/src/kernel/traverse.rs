//! Walking a triangle through a tile, in blocks of 8x8 pixels.
//!
//! Each edge function is linear; inside a tile it is `a x + b y + c` for pixel `(x, y)` with one
//! constant a sample, exactly, in 32-bit integers: positions are multiples of 1/256 pixel, so with
//! a fixed sample position the sign of the edge function is that of its value divided by 256 and
//! rounded down.
//!
//! Source: [Pineda 1988]; hierarchical traversal after [Greene 1996].

use super::block::{Block, BlockSink, RowSink};
use super::plane::RowPlane;
use crate::setup::is_top_left;
use crate::{BLOCK, SUBPIXEL, SamplePattern, Setup, TILE, Tile};
use std::ops::Range;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{I32x8, I32x16, LANES, Mask8, Simd};

/// Whether the blocks of a box of at most 8x8 pixels, from `low` to `high`, hold nothing but what
/// is nearer than `setup`.
#[inline(always)]
fn hides_box(tile: &Tile, setup: &Setup, low: [usize; 2], high: [usize; 2]) -> bool {
    let far = |x: usize, y: usize| tile.block_far[y / BLOCK * (TILE / BLOCK) + x / BLOCK];
    setup.z_max
        < far(low[0], low[1])
            .min(far(high[0], low[1]))
            .min(far(low[0], high[1]))
            .min(far(high[0], high[1]))
}

/// An edge function within one tile: `a * x + b * y + c[s] >= 0` on covered samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// Change with a pixel to the right.
    pub(crate) a: i32,
    /// Change with a pixel down.
    pub(crate) b: i32,
}

impl Edge {
    /// The constant of a sample at `(x, y)` in its pixel: `corner` is the edge function's value at
    /// the tile's origin.
    #[inline(always)]
    pub(crate) fn constant(self, corner: i32, [x, y]: [i32; 2]) -> i32 {
        (corner + (self.b * y + self.a * x)) >> 8
    }
}

/// An edge of a triangle of any size, with corners in the tile's coordinates, and the function that
/// gives [`Edge::constant`].
#[inline(always)]
fn far_edge(x: &[i32; 3], y: &[i32; 3], i: usize) -> (Edge, impl Fn([i32; 2]) -> i32) {
    let j = (i + 1) % 3;
    let (dx, dy) = (x[j] - x[i], y[j] - y[i]);
    let bias = i64::from(!is_top_left(dx, dy));
    let corner = i64::from(dy) * i64::from(x[i]) - i64::from(dx) * i64::from(y[i]) - bias;
    let constant = move |[x, y]: [i32; 2]| {
        let c = corner + i64::from(dx) * i64::from(y) - i64::from(dy) * i64::from(x);
        (c >> 8).clamp(-FAR_AWAY, FAR_AWAY) as i32
    };
    (Edge { a: -dy, b: dx }, constant)
}

/// The bias added to the edge functions of eight edges `(dx, dy)`, so that 0 counts as inside on
/// top and left edges alone.
#[inline(always)]
pub(crate) fn biases<S: Simd>(simd: S, dx: I32x8<S>, dy: I32x8<S>) -> I32x8<S> {
    let zero = I32x8::splat(simd, 0);
    let top_left = dy.simd_lt(zero) | (dy.simd_eq(zero) & dx.simd_gt(zero));
    top_left.select(zero, I32x8::splat(simd, -1))
}

/// Larger constants decide the sign by themselves: `|a x + b y| < 2^30` inside a tile.
const FAR_AWAY: i64 = 1 << 30;

/// Triangles that extend over fewer 1/256 pixel than this, a tile's side, have edge functions of 32
/// bits in a tile that they touch: the products are below 2^29.
pub(crate) const SMALL: i32 = TILE as i32 * SUBPIXEL;

/// What is at most so many 1/256 pixel thick is walked along its length.
const SLENDER: i64 = 3 * SUBPIXEL as i64;

/// Over how much the corners extend.
#[inline(always)]
fn spread(v: &[i32; 3]) -> i32 {
    v[0].max(v[1]).max(v[2]) - v[0].min(v[1]).min(v[2])
}

#[inline(always)]
fn is_small(x: &[i32; 3], y: &[i32; 3]) -> bool {
    spread(x) < SMALL && spread(y) < SMALL
}

#[cfg(any(test, feature = "forward"))]
impl Setup {
    /// Whether it extends over less than a tile's side, so that twice its area has fewer than 32
    /// bits.
    #[inline(always)]
    pub(crate) fn is_small(&self) -> bool {
        is_small(&self.x, &self.y)
    }
}

/// Pixels of a tile, columns and rows.
pub type Window = [Range<usize>; 2];

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

/// [`traverse`] for a sink that takes rows: small triangles are not cut into the tile's blocks.
#[inline(always)]
pub fn traverse_by_rows<S: Simd, K: RowSink<S>>(
    simd: S,
    setup: &Setup,
    tile: (u32, u32),
    pattern: &SamplePattern,
    sink: &mut K,
) {
    let window = [0..TILE, 0..TILE];
    let Some(place) = Placed::new(setup, tile, &window, pattern) else { return };
    if place.columns[1] - place.columns[0] < LANES && place.is_small() {
        match pattern.len() {
            1 => rows_outlined::<S, K, 1>(simd, setup, &place, pattern, sink),
            4 => rows_outlined::<S, K, 4>(simd, setup, &place, pattern, sink),
            32 => rows_outlined::<S, K, 32>(simd, setup, &place, pattern, sink),
            _ => rows_outlined::<S, K, 16>(simd, setup, &place, pattern, sink),
        }
    } else {
        match pattern.len() {
            1 => blocks_outlined::<S, K, 1>(simd, setup, &place, pattern, sink),
            4 => blocks_outlined::<S, K, 4>(simd, setup, &place, pattern, sink),
            32 => blocks_outlined::<S, K, 32>(simd, setup, &place, pattern, sink),
            _ => blocks_outlined::<S, K, 16>(simd, setup, &place, pattern, sink),
        }
    }
}

/// [`walk_rows`] as a function of its own: all in one would be a function over which WebAssembly's
/// compiler takes minutes.
#[inline(never)]
fn rows_outlined<S: Simd, K: RowSink<S>, const MAX: usize>(
    simd: S,
    setup: &Setup,
    place: &Placed,
    pattern: &SamplePattern,
    sink: &mut K,
) {
    simd.vectorize(
        #[inline(always)]
        || walk_rows::<S, K, MAX>(simd, setup, place, pattern, sink),
    );
}

/// [`walk_blocks`] as a function of its own.
#[inline(never)]
fn blocks_outlined<S: Simd, K: RowSink<S>, const MAX: usize>(
    simd: S,
    setup: &Setup,
    place: &Placed,
    pattern: &SamplePattern,
    sink: &mut K,
) {
    simd.vectorize(
        #[inline(always)]
        || walk_blocks::<S, K, MAX>(simd, setup, place, pattern, sink),
    );
}

/// Walks the rows of a triangle of any size, block by block.
#[inline(always)]
fn walk_blocks<S: Simd, K: RowSink<S>, const MAX: usize>(
    simd: S,
    setup: &Setup,
    place: &Placed,
    pattern: &SamplePattern,
    sink: &mut K,
) {
    // Set up the edge functions of all samples.
    let edges = SampleEdges::<S, MAX>::new(simd, place, pattern);
    let lane = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
    let zero = I32x8::splat(simd, 0);
    edges.each_block(
        simd,
        place,
        #[inline(always)]
        |block, full| {
            // Skip a block whose samples all hide the facet.
            let hidden =
                sink.hiding().is_some_and(|tile| setup.z_max < tile.block_far[block.index()]);
            if hidden {
                return;
            }
            for s in 0..edges.samples {
                let plane = RowPlane::new(simd, setup, sink.first(s, block.x));
                // Cover full blocks without edge tests.
                if full {
                    let covered = zero.simd_eq(zero);
                    for row in block.rows.clone() {
                        sink.cover_row(simd, (setup, &plane), s, [block.x, block.y + row], covered);
                    }
                    continue;
                }
                // The rows in which no edge has all eight pixels on its outer side.
                let (mut e, mut most) = (edges.across, zero);
                let values = edges.at_block(s, block);
                for i in 0..3 {
                    let Edge { a, b } = edges.edges[i];
                    e[i] += values[i];
                    most |= lane * b + (values[i] + (a * (BLOCK as i32 - 1)).max(0));
                }
                let reached = most.simd_ge(zero).to_bitmask() as u32;
                if reached == 0 {
                    continue;
                }

                // Cut the rows of the block to those that are reached.
                let first = block.rows.start.max(reached.trailing_zeros() as usize);
                let end = block.rows.end.min(32 - reached.leading_zeros() as usize);
                for i in 0..3 {
                    e[i] += edges.edges[i].b * first as i32;
                }

                // Walk these rows, eight pixels at a time.
                for row in first..end {
                    let covered = (e[0] | e[1] | e[2]).simd_ge(zero);
                    if covered.any_true() {
                        sink.cover_row(simd, (setup, &plane), s, [block.x, block.y + row], covered);
                    }
                    for i in 0..3 {
                        e[i] += edges.edges[i].b;
                    }
                }
            }
            sink.end(simd, [block.x, block.y]);
        },
    );
}

/// Walks the rows of a triangle that is at most eight pixels wide and whose edge functions fit into
/// 32 bits.
#[inline(always)]
fn walk_rows<S: Simd, K: RowSink<S>, const MAX: usize>(
    simd: S,
    setup: &Setup,
    place: &Placed,
    pattern: &SamplePattern,
    sink: &mut K,
) {
    // Skip the facet if the blocks under its box hide it.
    let ([x0, x1], [y0, y1]) = (place.columns, place.rows);
    if y1 - y0 < BLOCK
        && sink.hiding().is_some_and(|tile| hides_box(tile, setup, [x0, y0], [x1, y1]))
    {
        return;
    }

    // Let the sink note each sample's first position.
    let left = place.left();
    let samples = if MAX == 16 { pattern.len().min(MAX) } else { MAX };
    let mut firsts = [[0; 2]; MAX];
    for (s, first) in firsts[..samples].iter_mut().enumerate() {
        *first = sink.first(s, left);
    }

    // Walk the rows of all samples.
    place.each_row::<S, (usize, RowPlane<S>), MAX>(
        simd,
        pattern,
        #[inline(always)]
        |sample| (sample, RowPlane::new(simd, setup, firsts[sample])),
        #[inline(always)]
        |(sample, plane), y, covered| {
            sink.cover_row(simd, (setup, plane), *sample, [left, y], covered)
        },
    );
    sink.end(simd, [x0, y0]);
}

/// A triangle in a tile's coordinates, with the pixels that its box may cover.
pub(crate) struct Placed {
    /// Corners in 1/256 pixel.
    x: [i32; 3],
    y: [i32; 3],
    /// First and last column and row.
    pub(crate) columns: [usize; 2],
    pub(crate) rows: [usize; 2],
}

impl Placed {
    /// `None` if no pixel of the window can be covered.
    #[inline(always)]
    pub(crate) fn new(
        setup: &Setup,
        (tile_x, tile_y): (u32, u32),
        [columns, rows]: &Window,
        pattern: &SamplePattern,
    ) -> Option<Self> {
        let (origin_x, origin_y) = (tile_x as i32 * SUBPIXEL, tile_y as i32 * SUBPIXEL);
        let x = setup.x.map(|x| x - origin_x);
        let y = setup.y.map(|y| y - origin_y);
        let [extent_x, extent_y] = pattern.extent();
        let first =
            |v: [i32; 3], e: [i32; 2]| (v[0].min(v[1]).min(v[2]) - e[1] + SUBPIXEL - 1) >> 8;
        let last = |v: [i32; 3], e: [i32; 2]| (v[0].max(v[1]).max(v[2]) - e[0]) >> 8;
        let (x0, x1) = (
            first(x, extent_x).max(columns.start as i32),
            last(x, extent_x).min(columns.end as i32 - 1),
        );
        let (y0, y1) =
            (first(y, extent_y).max(rows.start as i32), last(y, extent_y).min(rows.end as i32 - 1));
        let [columns, rows] = [[x0, x1], [y0, y1]].map(|range| range.map(|v| v as usize));
        (x0 <= x1 && y0 <= y1).then_some(Self { x, y, columns, rows })
    }

    /// Whether the edge functions fit into 32 bits.
    #[inline(always)]
    pub(crate) fn is_small(&self) -> bool {
        is_small(&self.x, &self.y)
    }

    /// Whether it is higher than wide.
    #[inline(always)]
    pub(crate) fn is_upright(&self) -> bool {
        spread(&self.y) > spread(&self.x)
    }

    /// Whether it is at most [`SLENDER`] pixels thick, measured across its longer side, so that
    /// walking along that pays.
    #[inline(always)]
    pub(crate) fn is_slender(&self) -> bool {
        let (x, y) = (&self.x, &self.y);
        let doubled = |a: i32, b: i32| i64::from(a) * i64::from(b);
        let area = doubled(x[1] - x[0], y[2] - y[0]) - doubled(x[2] - x[0], y[1] - y[0]);
        area.abs() <= i64::from(spread(x).max(spread(y))) * SLENDER
    }

    /// Whether its pixels lie within a box of 8x8, and the edge functions fit into 32 bits.
    #[cfg(any(test, feature = "forward"))]
    #[inline(always)]
    pub(crate) fn is_tiny(&self) -> bool {
        let ([x0, x1], [y0, y1]) = (self.columns, self.rows);
        x1 - x0 < BLOCK && y1 - y0 < BLOCK && self.is_small()
    }

    /// The corners' x and y in 1/256 pixel of the tile.
    #[cfg(any(test, feature = "forward"))]
    #[inline(always)]
    pub(crate) fn corners(&self) -> ([i32; 3], [i32; 3]) {
        (self.x, self.y)
    }

    /// Where rows of eight pixels begin that hold its columns and do not reach beyond the tile.
    #[inline(always)]
    pub(crate) fn left(&self) -> usize {
        self.columns[0].min(TILE - LANES)
    }

    /// Walks the rows of a triangle that is at most eight pixels wide and whose edge functions fit
    /// into 32 bits, sample by sample. `begin` is called for each sample; `row` with what that
    /// gave, the row of the tile and which of the eight pixels from [`Self::left`] on are covered,
    /// if any are.
    #[inline(always)]
    fn each_row<S: Simd, T, const MAX: usize>(
        &self,
        simd: S,
        pattern: &SamplePattern,
        mut begin: impl FnMut(usize) -> T,
        mut row: impl FnMut(&mut T, usize, Mask8<S>),
    ) {
        // Set up edge functions for eight pixels of a row.
        let samples = if MAX == 16 { pattern.len().min(MAX) } else { MAX };
        let (left, [y0, y1]) = (self.left(), self.rows);
        let lane = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
        let (edges, corners) = self.edges();
        let across = [lane * edges[0].a, lane * edges[1].a, lane * edges[2].a];
        let zero = I32x8::splat(simd, 0);
        let [xs, ys] = pattern.axes();

        // Walk each sample's rows from the top.
        for s in 0..samples {
            // Move the edge functions to the sample's position in the first row.
            let mut e = across;
            for i in 0..3 {
                let at_sample = edges[i].constant(corners[i], [xs[s], ys[s]]);
                e[i] += at_sample + edges[i].a * left as i32 + edges[i].b * y0 as i32;
            }
            let mut begun = begin(s);

            // Hand on the rows of which a pixel is covered.
            for y in y0..=y1 {
                let covered = (e[0] | e[1] | e[2]).simd_ge(zero);
                if covered.any_true() {
                    row(&mut begun, y, covered);
                }
                for i in 0..3 {
                    e[i] += edges[i].b;
                }
            }
        }
    }

    /// [`center_edges`] of the triangle.
    #[inline(always)]
    pub(crate) fn center_edges(&self) -> ([Edge; 3], [i32; 3]) {
        center_edges(&self.x, &self.y)
    }

    /// The edges, and the edge functions' values at the tile's origin in 1/65536 square pixels; for
    /// [`Self::is_small`].
    #[inline(always)]
    pub(crate) fn edges(&self) -> ([Edge; 3], [i32; 3]) {
        let mut edges = [Edge { a: 0, b: 0 }; 3];
        let mut corners = [0; 3];
        for i in 0..3 {
            let j = (i + 1) % 3;
            let (dx, dy) = (self.x[j] - self.x[i], self.y[j] - self.y[i]);
            edges[i] = Edge { a: -dy, b: dx };
            corners[i] = dy * self.x[i] - dx * self.y[i] - i32::from(!is_top_left(dx, dy));
        }
        (edges, corners)
    }
}

/// The edges of a triangle of any size with corners in a tile's coordinates, and [`Edge::constant`]
/// of the middles of pixels.
#[inline(always)]
pub(crate) fn center_edges(x: &[i32; 3], y: &[i32; 3]) -> ([Edge; 3], [i32; 3]) {
    let mut edges = [Edge { a: 0, b: 0 }; 3];
    let mut constants = [0; 3];
    for i in 0..3 {
        let constant;
        (edges[i], constant) = far_edge(x, y, i);
        constants[i] = constant([SUBPIXEL / 2; 2]);
    }
    (edges, constants)
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

/// [`traverse`] for the blocks that hold pixels of `window`, columns and rows of the tile; above
/// and below it no rows are covered.
#[inline(always)]
pub fn traverse_window<S: Simd, K: BlockSink<S>>(
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
        32 => traverse_samples::<S, K, 32>(simd, setup, tile, window, pattern, sink),
        _ => traverse_samples::<S, K, 16>(simd, setup, tile, window, pattern, sink),
    }
}

/// `MAX` is the number of samples, or 16 where there are fewer.
#[inline(always)]
fn traverse_samples<S: Simd, K: BlockSink<S>, const MAX: usize>(
    simd: S,
    setup: &Setup,
    tile: (u32, u32),
    window: &Window,
    pattern: &SamplePattern,
    sink: &mut K,
) {
    let Some(place) = Placed::new(setup, tile, window, pattern) else { return };

    // Set up the edge functions of all samples, then visit the blocks that the facet touches.
    let edges = SampleEdges::<S, MAX>::new(simd, &place, pattern);
    let mut masks = [0u64; MAX];
    edges.each_block(
        simd,
        &place,
        #[inline(always)]
        |block, full| {
            if sink.rejects(setup, block) {
                return;
            }

            // Compute the coverage mask of each sample.
            let mut any = u64::MAX;
            if full {
                masks = [u64::MAX; MAX];
            } else {
                any = 0;
                for (s, mask) in masks[..edges.samples].iter_mut().enumerate() {
                    *mask = mask_rows(
                        simd,
                        &edges.edges,
                        &edges.across,
                        edges.at_block(s, block),
                        block.rows.clone(),
                    );
                    any |= *mask;
                }
            }

            // Hand the block on if a sample is covered.
            if any != 0 {
                sink.cover(simd, setup, block, &masks[..edges.samples]);
            }
        },
    );
}

/// The edge functions of a triangle in a tile at all samples.
struct SampleEdges<S: Simd, const MAX: usize> {
    samples: usize,
    /// Changes with a pixel to the right and down.
    edges: [Edge; 3],
    /// At the tile's origin.
    constants: [[i32; MAX]; 3],
    /// What they change over the eight pixels of a row.
    across: [I32x8<S>; 3],
}

impl<S: Simd, const MAX: usize> SampleEdges<S, MAX> {
    #[inline(always)]
    fn new(simd: S, place: &Placed, pattern: &SamplePattern) -> Self {
        let samples = if MAX == 16 { pattern.len().min(MAX) } else { MAX };
        let mut edges = [Edge { a: 0, b: 0 }; 3];
        let mut constants = [[0i32; MAX]; 3];

        // Compute each edge's constant at each sample, in 32 bits where the triangle is small
        // enough.
        let [xs, ys] = pattern.axes();
        if place.is_small() {
            let corners;
            (edges, corners) = place.edges();
            for i in 0..3 {
                for s in 0..MAX {
                    constants[i][s] = edges[i].constant(corners[i], [xs[s], ys[s]]);
                }
            }
        } else {
            for i in 0..3 {
                let constant;
                (edges[i], constant) = far_edge(&place.x, &place.y, i);
                for s in 0..samples {
                    constants[i][s] = constant([xs[s], ys[s]]);
                }
            }
        }
        let lane = I32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
        Self {
            samples,
            edges,
            constants,
            across: [lane * edges[0].a, lane * edges[1].a, lane * edges[2].a],
        }
    }

    /// The values at a sample of a block's first pixel.
    #[inline(always)]
    fn at_block(&self, sample: usize, block: &Block) -> [i32; 3] {
        let mut values = [0; 3];
        for i in 0..3 {
            let Edge { a, b } = self.edges[i];
            values[i] = self.constants[i][sample] + (a * block.x as i32 + b * block.y as i32);
        }
        values
    }

    /// Visits the blocks that may hold covered samples, in rows, and tells of each whether all its
    /// samples are covered.
    #[inline(always)]
    fn each_block(&self, simd: S, place: &Placed, mut visit: impl FnMut(&Block, bool)) {
        let ([x0, x1], [y0, y1]) = (place.columns, place.rows);
        let extremes = Extremes::new(simd, &self.edges, &self.constants, self.samples);
        let columns = (0xff << (x0 / BLOCK)) & (0xff >> (TILE / BLOCK - 1 - x1 / BLOCK));
        for y in (y0 & !(BLOCK - 1)..=y1).step_by(BLOCK) {
            let rows = y0.max(y) - y..(y1 + 1).min(y + BLOCK) - y;
            let [touched, full] = extremes.row(simd, &self.edges, y);
            let mut rest = touched & columns;
            while rest != 0 {
                let number = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let block = Block { x: number * BLOCK, y, rows: rows.clone() };
                visit(&block, full >> number & 1 == 1);
            }
        }
    }
}

/// The least and the largest values that the edge functions take on the samples of the eight blocks
/// of a tile's top row.
pub(crate) struct Extremes<S: Simd> {
    /// Least values, by edge; one lane for each block.
    least: [I32x8<S>; 3],
    /// Largest values, by edge; one lane for each block.
    largest: [I32x8<S>; 3],
}

impl<S: Simd> Extremes<S> {
    #[inline(always)]
    pub(crate) fn new<const MAX: usize>(
        simd: S,
        edges: &[Edge; 3],
        constants: &[[i32; MAX]; 3],
        samples: usize,
    ) -> Self {
        let side = BLOCK as i32 - 1;
        let blocks = I32x8::from_slice(simd, &[0, 8, 16, 24, 32, 40, 48, 56]);
        let zero = I32x8::splat(simd, 0);
        let (mut least, mut largest) = ([zero; 3], [zero; 3]);
        for i in 0..3 {
            let (mut low, mut high) = (constants[i][0], constants[i][0]);
            for &c in &constants[i][1..samples] {
                (low, high) = (low.min(c), high.max(c));
            }
            let (a, b) = (edges[i].a * side, edges[i].b * side);
            let across = blocks * edges[i].a;
            least[i] = across + (low + a.min(0) + b.min(0));
            largest[i] = across + (high + a.max(0) + b.max(0));
        }
        Self { least, largest }
    }

    /// A bit for each block of the row of blocks at pixel row `y`: those that may hold covered
    /// samples, and those whose samples all are.
    #[inline(always)]
    pub(crate) fn row(&self, simd: S, edges: &[Edge; 3], y: usize) -> [u32; 2] {
        let zero = I32x8::splat(simd, 0);
        let (mut touched, mut full) = (zero, zero);
        for i in 0..3 {
            let down = edges[i].b * y as i32;
            touched |= self.largest[i] + down;
            full |= self.least[i] + down;
        }
        [touched, full].map(
            #[inline(always)]
            |v| v.simd_ge(zero).to_bitmask() as u32,
        )
    }
}

/// The coverage mask of the block's `rows`, two rows a step.
#[inline(always)]
fn mask_rows<S: Simd>(
    simd: S,
    edges: &[Edge; 3],
    across: &[I32x8<S>; 3],
    at_block: [i32; 3],
    rows: Range<usize>,
) -> u64 {
    let zero = I32x16::splat(simd, 0);
    let (first, mut e) = (rows.start & !1, [zero; 3]);
    for i in 0..3 {
        let b = edges[i].b;
        e[i] = across[i].combine(across[i] + b) + (at_block[i] + b * first as i32);
    }
    let mut mask = 0;
    for row in (first..rows.end).step_by(2) {
        let inside = (e[0] | e[1] | e[2]).simd_ge(zero).to_bitmask() & 0xffff;
        mask |= inside << (8 * row);
        for i in 0..3 {
            e[i] += 2 * edges[i].b;
        }
    }
    mask & u64::MAX << (8 * rows.start) & u64::MAX >> (8 * (BLOCK - rows.end))
}
