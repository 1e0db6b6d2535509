//! Shadow maps that are never drawn: a depth plane may keep the triangles of a pass in place of its texels.
//!
//! A picture asks a shadow map of 16 million texels for some thousands, so it pays to compute those alone. A pass that
//! clears a texture's depth plane and draws nothing but depths into it, all kept by the same comparison, leaves its tile lists
//! behind. A texel's value is then the nearest (or farthest) of its tile's triangles there, by the same coverage and depth
//! that drawing uses: the bits are the same. For a lookup that compares, a bound of each triangle's depths decides most
//! triangles, and a bound of all the tile's most lookups. Whoever needs all texels draws them: [`PendingDepth::resolve`].
//!
//! In:   a pass's primitives. Out: depths of single texels, or a drawn plane.
//! Cost: a lookup is linear in the triangles of its block of 8x8 texels, eight a step.

use super::assemble::Primitives;
use super::depth_ranges::DepthRanges;
use super::fragment::{TilePlanes, stored};
use super::pass::{DrawContext, Item, Pass, pattern};
use super::plane::{Plane, PlaneTile};
use super::state::{Compare, FragmentState};
use super::tile::TileRun;
use crate::kernel::traverse::center_edges;
use crate::{BLOCK, SUBPIXEL, Setup, TILE};
use std::ops::Range;
use std::sync::{Arc, OnceLock};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Level, Simd, dispatch};

/// State of a draw, and the pixels that it may touch.
type ClippedState = (Arc<FragmentState>, [i32; 4]);

/// A job's triangles, with the state and the allowed pixels of each draw.
#[derive(Debug)]
struct PendingJob {
    primitives: Primitives,
    draws: Vec<ClippedState>,
}

/// What may decide a tile's texels.
#[derive(Debug)]
struct PendingTile {
    /// The largest bound of its triangles, as read; times the sign.
    bound: f32,
    /// The jobs that have triangles there, in [`PendingDepth::touching`].
    jobs: Range<usize>,
    /// Its triangles by blocks, made when it is first searched.
    grid: OnceLock<Box<Grid>>,
}

/// A job, and an entry of its batch.
type Entry = [u32; 2];

/// A tile's triangles by blocks of 8x8 texels.
#[derive(Debug)]
struct Grid {
    /// One list for the whole tile.
    whole: bool,
    /// Block by block.
    entries: Vec<Entry>,
    /// Where each block's entries begin.
    starts: [u32; BLOCKS * BLOCKS + 1],
    /// Eights of a block's entries, the rows of [`candidate`], made when it is first searched.
    candidates: [OnceLock<Box<[f32]>>; BLOCKS * BLOCKS],
}

/// Blocks along a tile's side.
const BLOCKS: usize = TILE / BLOCK;
/// Tiles with no more entries than this have one list for all blocks.
const FEW: usize = 32;

/// See the module.
#[derive(Debug)]
pub(crate) struct PendingDepth {
    /// 1 where the larger depth stays, -1 where the smaller does.
    sign: f32,
    clear: f32,
    scale: f32,
    jobs: Vec<PendingJob>,
    tiles: Vec<PendingTile>,
    /// Numbers of jobs, tile by tile.
    touching: Vec<u32>,
    tiles_x: i32,
}

/// Whether a pass can be left pending: 1 or -1 for which depth stays, and the depth it clears to.
pub(crate) fn pendable(pass: &Pass) -> Option<(f32, f32)> {
    use super::pass::Command;
    let (first, rest) = pass.commands.split_first()?;
    let Command::Clear(clear) = first else { return None };
    let whole = [0, 0, pass.target.viewport.width as i32, pass.target.viewport.height as i32];
    if pass.target.samples != 1 || clear.clip != whole || clear.color.is_some() || clear.stencil.is_some() {
        return None;
    }
    let mut sign = 0.0;
    for command in rest {
        let Command::Draw(_, state) = command else { return None };
        let test = state.depth.filter(|t| t.write)?;
        let colorless = pass.target.color.is_none() || state.masked == [true; 4];
        let plain = state.stencil.is_none() && state.alpha_test.is_none() && state.query.is_none();
        if !(colorless && plain && state.polygon_stipple.is_none()) {
            return None;
        }
        let its = match test.func {
            Compare::Greater | Compare::GreaterOrEqual => 1.0,
            Compare::Less | Compare::LessOrEqual => -1.0,
            _ => return None,
        };
        if sign != 0.0 && sign != its {
            return None;
        }
        sign = its;
    }
    Some((if sign == 0.0 { 1.0 } else { sign }, clear.depth?))
}

impl PendingDepth {
    /// Keeps a pass's primitives. `jobs` are with their draws' states and allowed pixels.
    pub(crate) fn new(
        (sign, clear): (f32, f32),
        scale: f32,
        tiles_x: u32,
        tiles: usize,
        jobs: Vec<(Primitives, Vec<ClippedState>)>,
    ) -> Self {
        let jobs: Vec<PendingJob> =
            jobs.into_iter().map(|(primitives, draws)| PendingJob { primitives, draws }).collect();
        let mut touching = Vec::new();
        let tiles = (0..tiles).map(|tile| {
            let (first, mut most) = (touching.len(), f32::NEG_INFINITY);
            for (number, job) in jobs.iter().enumerate() {
                let batch = &job.primitives.batch;
                let range = batch.tile_range(tile);
                if !range.is_empty() {
                    touching.push(number as u32);
                    let its = |at| if sign > 0.0 { batch.item(at).z_max } else { -batch.item(at).z_min };
                    most = range.map(its).fold(most, f32::max);
                }
            }
            // As read: stored and divided again. Both keep the order.
            let bound = if most.is_finite() { stored(most.abs(), scale) / scale * sign } else { most };
            PendingTile { bound, jobs: first..touching.len(), grid: OnceLock::new() }
        });
        let tiles = tiles.collect();
        let clear = if scale == 1.0 { clear } else { (f64::from(clear * scale) + 0.5).floor() as f32 };
        Self { sign, clear, scale, jobs, tiles, touching, tiles_x: tiles_x as i32 }
    }

    /// The primitives, to use their memory again.
    pub(crate) fn into_primitives(self) -> impl Iterator<Item = Primitives> {
        self.jobs.into_iter().map(|job| job.primitives)
    }

    /// The depths of eight texels in `0..=1` as they would be read, from the farther of `known` and the clear value on:
    /// triangles that cannot beat `known` are not looked at. Pass `None` for the exact depths. Lanes without their bit in
    /// `active` yield the clear value.
    #[inline(always)]
    pub(crate) fn texels<S: Simd>(
        &self,
        simd: S,
        x: I32x8<S>,
        y: I32x8<S>,
        active: u32,
        known: Option<F32x8<S>>,
    ) -> F32x8<S> {
        const SHIFT: u32 = TILE.trailing_zeros();
        let tile = ((y >> SHIFT) * self.tiles_x + (x >> SHIFT)).to_array();
        let mut bounds = [f32::NEG_INFINITY; LANES];
        for lane in 0..LANES {
            if let Some(tile) = self.tiles.get(tile[lane] as u32 as usize) {
                bounds[lane] = tile.bound;
            }
        }
        let best = self.clear / self.scale * self.sign;
        let splat = |v| <F32x8<S> as SimdBase<S>>::splat(simd, v);
        let floors = match known {
            Some(known) => known * self.sign,
            None => splat(f32::NEG_INFINITY),
        };
        let open =
            F32x8::from_slice(simd, &bounds).simd_gt(floors) & F32x8::from_slice(simd, &bounds).simd_gt(splat(best));
        let mut open = open.to_bitmask() as u32 & active;
        let mut depths = [best; LANES];
        if open != 0 {
            let (x, y, floors) = (x.to_array(), y.to_array(), floors.to_array());
            while open != 0 {
                let lane = open.trailing_zeros() as usize % LANES;
                open &= open - 1;
                depths[lane] = self.search(simd, x[lane], y[lane], tile[lane] as usize, floors[lane], best);
            }
        }
        F32x8::from_slice(simd, &depths) * self.sign
    }

    /// The best of a tile's triangles at a texel, if better than `floor` and `best`; times the sign.
    #[inline(never)]
    fn search<S: Simd>(&self, simd: S, x: i32, y: i32, tile: usize, floor: f32, best: f32) -> f32 {
        simd.vectorize(
            #[inline(always)]
            || self.search_inlined(simd, x, y, tile, floor, best),
        )
    }

    #[inline(always)]
    fn search_inlined<S: Simd>(&self, simd: S, x: i32, y: i32, tile: usize, floor: f32, mut best: f32) -> f32 {
        let (px, py) = (x * SUBPIXEL + SUBPIXEL / 2, y * SUBPIXEL + SUBPIXEL / 2);
        // Places within the tile, as the candidates' planes take them.
        let (u, v) = ((x % TILE as i32) as f32, (y % TILE as i32) as f32);
        let grid = self.grid(tile);
        let block = if grid.whole { 0 } else { (y as usize % TILE / BLOCK) * BLOCKS + x as usize % TILE / BLOCK };
        let entries = &grid.entries[grid.starts[block] as usize..grid.starts[block + 1] as usize];
        let candidates = grid.candidates[block].get_or_init(|| self.candidates(entries, tile));
        for (number, block) in candidates.chunks_exact(ROWS * LANES).enumerate() {
            let mut bits = above(simd, block, u, v, best.max(floor));
            while bits != 0 {
                let entry = entries[number * LANES + bits.trailing_zeros() as usize];
                bits &= bits - 1;
                let setup = self.setup(entry);
                let depth = stored(setup.depth(px, py), self.scale) / self.scale * self.sign;
                let allowed = || self.jobs[entry[0] as usize].allows(setup, x, y);
                if depth > best.max(floor) && setup.covers(px, py) && allowed() {
                    best = depth;
                }
            }
        }
        best
    }

    #[inline(always)]
    fn setup(&self, [job, at]: Entry) -> &Setup {
        self.jobs[job as usize].primitives.batch.item(at as usize)
    }

    /// The first pixel of a tile.
    fn origin(&self, tile: usize) -> [i32; 2] {
        [tile as i32 % self.tiles_x * TILE as i32, tile as i32 / self.tiles_x * TILE as i32]
    }

    /// The finer lists of a tile.
    fn grid(&self, tile: usize) -> &Grid {
        let pending = &self.tiles[tile];
        pending.grid.get_or_init(|| {
            let origin = self.origin(tile);
            let mut all: Vec<Entry> = Vec::new();
            for &job in &self.touching[pending.jobs.clone()] {
                let range = self.jobs[job as usize].primitives.batch.tile_range(tile);
                all.extend(range.map(|at| [job, at as u32]));
            }
            let mut starts = [0; BLOCKS * BLOCKS + 1];
            let candidates = [const { OnceLock::new() }; BLOCKS * BLOCKS];
            if all.len() <= FEW {
                starts[1..].fill(all.len() as u32);
                return Box::new(Grid { whole: true, entries: all, starts, candidates });
            }
            // Texels whose centres may lie within the box.
            let span = |v: [i32; 3], origin: i32| {
                let low = ((v[0].min(v[1]).min(v[2]) >> 8) - 1 - origin).clamp(0, TILE as i32 - 1);
                let high = ((v[0].max(v[1]).max(v[2]) >> 8) + 1 - origin).clamp(0, TILE as i32 - 1);
                [(low as usize / BLOCK) as u8, (high as usize / BLOCK) as u8]
            };
            let blocks = |[x, y]: [[u8; 2]; 2]| (y[0]..=y[1]).flat_map(move |y| (x[0]..=x[1]).map(move |x| (x, y)));
            let number = |(x, y): (u8, u8)| usize::from(y) * BLOCKS + usize::from(x);
            let mut spans = Vec::with_capacity(all.len());
            for &entry in &all {
                let setup = self.setup(entry);
                let spanned = [span(setup.x, origin[0]), span(setup.y, origin[1])];
                blocks(spanned).for_each(|block| starts[number(block) + 1] += 1);
                spans.push(spanned);
            }
            for block in 0..BLOCKS * BLOCKS {
                starts[block + 1] += starts[block];
            }
            let (mut next, mut entries) = (starts, vec![[0; 2]; starts[BLOCKS * BLOCKS] as usize]);
            for (&entry, &spanned) in all.iter().zip(&spans) {
                for block in blocks(spanned) {
                    let next = &mut next[number(block)];
                    entries[*next as usize] = entry;
                    *next += 1;
                }
            }
            Box::new(Grid { whole: false, entries, starts, candidates })
        })
    }

    /// Eights of entries, row by row; what is missing to an eight is below everything.
    fn candidates(&self, entries: &[Entry], tile: usize) -> Box<[f32]> {
        let origin = self.origin(tile);
        let mut rows = vec![f32::NEG_INFINITY; entries.len().div_ceil(LANES) * ROWS * LANES];
        for (eight, rows) in entries.chunks(LANES).zip(rows.chunks_exact_mut(ROWS * LANES)) {
            for (lane, &entry) in eight.iter().enumerate() {
                let row = candidate(self.setup(entry), origin, self.sign, self.scale);
                for k in 0..ROWS {
                    rows[k * LANES + lane] = row[k];
                }
            }
        }
        rows.into_boxed_slice()
    }

    /// Which depth stays: 1 the larger, -1 the smaller.
    pub(crate) fn sign(&self) -> f32 {
        self.sign
    }

    /// Draws everything into the plane.
    pub(crate) fn resolve(self, plane: &mut Plane<f32>, scale: f32) {
        let viewport = plane.viewport();
        let tiles_x = viewport.tiles_x();
        let layout = super::shade::Layout::default();
        let states: Vec<Vec<ClippedState>> = self.jobs.iter().map(|job| job.draws.clone()).collect();
        let items: Vec<Item<'_>> = self
            .jobs
            .into_iter()
            .zip(&states)
            .map(|(job, draws)| Item::Job {
                primitives: job.primitives,
                draws: draws.iter().map(|(state, clip)| DrawContext::depth_alone(state, *clip, &layout)).collect(),
            })
            .collect();
        let one = pattern(1);
        for (index, tile) in plane.tiles.iter_mut().enumerate() {
            *tile = PlaneTile::new(self.clear);
            let (x, y) = (index as u32 % tiles_x * TILE as u32, index as u32 / tiles_x * TILE as u32);
            let ranges = DepthRanges::new();
            let planes = TilePlanes { color: None, depth: Some((tile, scale)), stencil: None, samples: 1, ranges };
            let mut run = TileRun::new(index, x, y, viewport, planes);
            dispatch!(Level::new(), simd => run.walk(simd, &items, &one, &one));
        }
    }
}

impl PendingJob {
    fn allows(&self, setup: &Setup, x: i32, y: i32) -> bool {
        let draw = self.primitives.facets[setup.facet as usize].draw;
        let [x0, y0, x1, y1] = self.draws[draw as usize].1;
        (x0..x1).contains(&x) && (y0..y1).contains(&y)
    }
}

/// Numbers of a candidate: its plane at the tile's corner (with a margin for rounding), the change with x and y, and the
/// bound of its depths, all times the sign; and the change with x and y of its three edge functions, and their values there
/// (with a margin).
const ROWS: usize = 13;

fn candidate(setup: &Setup, origin: [i32; 2], sign: f32, scale: f32) -> [f32; ROWS] {
    let bound = if sign > 0.0 { stored(setup.z_max, scale) / scale } else { -stored(setup.z_min, scale) / scale };
    let (dx, dy) = (setup.dz_dx * sign, setup.dz_dy * sign);
    let at = |k: usize| ((origin[k] * SUBPIXEL + SUBPIXEL / 2 - setup.origin[k]) as f32) / SUBPIXEL as f32;
    let (x, y) = (at(0) * dx, at(1) * dy);
    let size = setup.z.abs() + x.abs() + y.abs() + (dx.abs() + dy.abs()) * TILE as f32;
    // Half a step for rounding when stored, and what five roundings may be off.
    let margin = size * 1.8e-7 + if scale == 1.0 { 0.0 } else { 0.5 / scale };
    let corner = setup.z * sign + x + y + margin;
    let mut row = [0.0; ROWS];
    row[3] = bound;
    if corner.is_finite() && dx.is_finite() && dy.is_finite() {
        [row[0], row[1], row[2]] = [corner, dx, dy];
    } else {
        row[0] = f32::MAX;
    }
    for (edge, row) in center_edges(setup, origin).iter().zip(row[4..].chunks_exact_mut(3)) {
        let [a, b, c] = edge.map(|v| v as f32);
        let margin = ((a.abs() + b.abs()) * TILE as f32 + c.abs()) * 4e-7;
        row.copy_from_slice(&[a, b, c + margin]);
    }
    row
}

/// Which of a block's eight candidates may cover a place of the tile, and be above `floor` there.
#[inline(always)]
fn above<S: Simd>(simd: S, block: &[f32], u: f32, v: f32, floor: f32) -> u32 {
    let row = lanes::inlined(
        #[inline(always)]
        |k: usize| F32x8::from_slice(simd, &block[k * LANES..(k + 1) * LANES]),
    );
    let plane = row(0) + row(1) * u + row(2) * v;
    let splat = |value| <F32x8<S> as SimdBase<S>>::splat(simd, value);
    let nearer = plane.simd_gt(splat(floor)) & row(3).simd_gt(splat(floor));
    if !nearer.any_true() {
        return 0;
    }
    let edge = lanes::inlined(
        #[inline(always)]
        |k: usize| row(k) * u + row(k + 1) * v + row(k + 2),
    );
    let inside = lanes::Lanes::min(lanes::Lanes::min(edge(4), edge(7)), edge(10));
    (nearer & inside.simd_ge(splat(0.0))).to_bitmask() as u32
}
