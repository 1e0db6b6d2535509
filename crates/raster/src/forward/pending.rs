//! Shadow maps that are never drawn: a depth plane may keep the triangles of a pass in place of its texels.
//!
//! A picture asks a shadow map of 16 million texels for some thousands, so it pays to compute those alone. A pass that
//! clears a texture's depth plane and draws nothing but depths into it, all kept by the same comparison, leaves its tile lists
//! behind. A texel's value is then the nearest (or farthest) of its tile's triangles there, by the same coverage and depth
//! that drawing uses: the bits are the same. For a lookup that compares, a bound of each triangle's depths decides most
//! triangles, and a bound of all the tile's most lookups. Whoever needs all texels draws them: [`PendingDepth::resolve`].
//!
//! In:   a pass's primitives. Out: depths of single texels, or a drawn plane.
//! Cost: a lookup is linear in its tile's triangles, eight bounds a step.

use super::assemble::Primitives;
use super::fragment::TilePlanes;
use super::pass::{DrawContext, Item, Pass, pattern};
use super::plane::{Plane, PlaneTile};
use super::state::{Compare, FragmentState};
use super::tile::TileRun;
use crate::{BLOCK, SUBPIXEL, Setup, TILE};
use std::sync::{Arc, OnceLock};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Level, Simd, dispatch};

/// State of a draw, and the pixels that it may touch.
type ClippedState = (Arc<FragmentState>, [i32; 4]);

/// A job's triangles and what bounds them.
#[derive(Debug)]
struct PendingJob {
    primitives: Primitives,
    /// State and allowed pixels of each draw.
    draws: Vec<ClippedState>,
    /// The largest of a tile's.
    tile_bounds: Vec<f32>,
    /// What searching a tile needs, made when it is first searched.
    grids: Vec<OnceLock<Box<Grid>>>,
}

/// A tile's triangles by blocks of 8x8 texels.
#[derive(Debug)]
struct Grid {
    /// One list for the whole tile.
    whole: bool,
    /// Blocks of eight entries, the rows of [`candidate`].
    candidates: Vec<f32>,
    /// The entries that the candidates are.
    entries: Vec<u32>,
    /// Where each block's candidates begin, in eights.
    starts: [u32; BLOCKS * BLOCKS + 1],
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
    /// The largest bound of each tile over all jobs.
    tile_bounds: Vec<f32>,
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

/// A depth in `0..=1` as stored.
pub(crate) fn stored(depth: f32, scale: f32) -> f32 {
    if scale == 1.0 {
        return depth;
    }
    let scaled = depth * scale;
    // From 2^23 on every number is whole, and adding a half would round again.
    if scaled < 8_388_608.0 { (scaled + 0.5) as u32 as f32 } else { scaled as u32 as f32 }
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
        let jobs: Vec<PendingJob> = jobs.into_iter().map(|(p, draws)| job(p, draws, sign, scale, tiles)).collect();
        let mut tile_bounds = vec![f32::NEG_INFINITY; tiles];
        for job in &jobs {
            for (all, its) in tile_bounds.iter_mut().zip(&job.tile_bounds) {
                *all = all.max(*its);
            }
        }
        let clear = if scale == 1.0 { clear } else { (f64::from(clear * scale) + 0.5).floor() as f32 };
        Self { sign, clear, scale, jobs, tile_bounds, tiles_x: tiles_x as i32 }
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
            if let Some(bound) = self.tile_bounds.get(tile[lane] as u32 as usize) {
                bounds[lane] = *bound;
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
        for job in self.jobs.iter().filter(|job| job.tile_bounds[tile] > floor) {
            let grid = job.grid(tile, self.sign, self.scale, self.tiles_x as usize);
            let block = if grid.whole { 0 } else { (y as usize % TILE / BLOCK) * BLOCKS + x as usize % TILE / BLOCK };
            let eights = grid.starts[block] as usize..grid.starts[block + 1] as usize;
            let candidates = &grid.candidates[eights.start * ROWS * LANES..eights.end * ROWS * LANES];
            let entries = &grid.entries[eights.start * LANES..eights.end * LANES];
            for (number, block) in candidates.chunks_exact(ROWS * LANES).enumerate() {
                let mut bits = above(simd, block, u, v, best.max(floor));
                while bits != 0 {
                    let at = entries[number * LANES + bits.trailing_zeros() as usize] as usize;
                    bits &= bits - 1;
                    let setup = job.primitives.batch.item(at);
                    let depth = stored(setup.depth(px, py), self.scale) / self.scale * self.sign;
                    if depth > best.max(floor) && setup.covers(px, py) && job.allows(setup, x, y) {
                        best = depth;
                    }
                }
            }
        }
        best
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
            *tile = PlaneTile::Cleared(self.clear);
            let (x, y) = (index as u32 % tiles_x * TILE as u32, index as u32 / tiles_x * TILE as u32);
            let planes = TilePlanes { color: None, depth: Some((tile, scale)), stencil: None, samples: 1 };
            let mut run = TileRun::new(index, x, y, viewport, planes);
            dispatch!(Level::new(), simd => run.walk(simd, &items, &one, &one));
        }
    }
}

impl PendingJob {
    /// The finer lists of a tile.
    fn grid(&self, tile: usize, sign: f32, scale: f32, tiles_x: usize) -> &Grid {
        self.grids[tile].get_or_init(|| {
            let origin = [(tile % tiles_x * TILE) as i32, (tile / tiles_x * TILE) as i32];
            let batch = &self.primitives.batch;
            let mut lists: [Vec<u32>; BLOCKS * BLOCKS] = std::array::from_fn(|_| Vec::new());
            let range = batch.tile_range(tile);
            let whole = range.len() <= FEW;
            for at in range {
                let setup = batch.item(at);
                if whole {
                    lists[0].push(at as u32);
                    continue;
                }
                // Texels whose centres may lie within the box.
                let span = |v: [i32; 3], origin: i32| {
                    let low = (v[0].min(v[1]).min(v[2]) / SUBPIXEL - 1 - origin).clamp(0, TILE as i32 - 1);
                    let high = (v[0].max(v[1]).max(v[2]) / SUBPIXEL + 1 - origin).clamp(0, TILE as i32 - 1);
                    low as usize / BLOCK..high as usize / BLOCK + 1
                };
                for y in span(setup.y, origin[1]) {
                    for x in span(setup.x, origin[0]) {
                        lists[y * BLOCKS + x].push(at as u32);
                    }
                }
            }
            let mut grid =
                Grid { whole, candidates: Vec::new(), entries: Vec::new(), starts: [0; BLOCKS * BLOCKS + 1] };
            for (block, list) in lists.iter().enumerate() {
                for eight in list.chunks(LANES) {
                    let rows = grid.candidates.len();
                    grid.candidates.resize(rows + ROWS * LANES, f32::NEG_INFINITY);
                    for (lane, &at) in eight.iter().enumerate() {
                        let row = candidate(batch.item(at as usize), origin, sign, scale);
                        for k in 0..ROWS {
                            grid.candidates[rows + k * LANES + lane] = row[k];
                        }
                    }
                    grid.entries.extend(eight);
                    grid.entries.resize(grid.entries.len().next_multiple_of(LANES), 0);
                }
                grid.starts[block + 1] = (grid.entries.len() / LANES) as u32;
            }
            Box::new(grid)
        })
    }

    fn allows(&self, setup: &Setup, x: i32, y: i32) -> bool {
        let draw = self.primitives.facets[setup.facet as usize].draw;
        let [x0, y0, x1, y1] = self.draws[draw as usize].1;
        (x0..x1).contains(&x) && (y0..y1).contains(&y)
    }
}

fn job(primitives: Primitives, draws: Vec<ClippedState>, sign: f32, scale: f32, tiles: usize) -> PendingJob {
    let batch = &primitives.batch;
    let bound = |s: &Setup| if sign > 0.0 { s.z_max } else { -s.z_min };
    let tile_bounds = (0..tiles).map(|tile| {
        let range = batch.tile_range(tile);
        let most = range.clone().map(|at| bound(batch.item(at))).fold(f32::NEG_INFINITY, f32::max);
        // As read: stored and divided again. Both keep the order.
        if range.is_empty() { most } else { stored(most.abs(), scale) / scale * sign }
    });
    let tile_bounds = tile_bounds.collect();
    let grids = (0..tiles).map(|_| OnceLock::new()).collect();
    PendingJob { primitives, draws, tile_bounds, grids }
}

/// Numbers of a candidate: its plane at the tile's corner (with a margin for rounding), the change with x and y, and the
/// bound of its depths; times the sign.
const ROWS: usize = 4;

fn candidate(setup: &Setup, origin: [i32; 2], sign: f32, scale: f32) -> [f32; ROWS] {
    let bound = if sign > 0.0 { stored(setup.z_max, scale) / scale } else { -stored(setup.z_min, scale) / scale };
    let (dx, dy) = (setup.dz_dx * sign, setup.dz_dy * sign);
    let at = |k: usize| ((origin[k] * SUBPIXEL + SUBPIXEL / 2 - setup.origin[k]) as f32) / SUBPIXEL as f32;
    let (x, y) = (at(0) * dx, at(1) * dy);
    let size = setup.z.abs() + x.abs() + y.abs() + (dx.abs() + dy.abs()) * TILE as f32;
    // Half a step for rounding when stored, and what five roundings may be off.
    let margin = size * 1.8e-7 + if scale == 1.0 { 0.0 } else { 0.5 / scale };
    let corner = setup.z * sign + x + y + margin;
    if corner.is_finite() && dx.is_finite() && dy.is_finite() {
        [corner, dx, dy, bound]
    } else {
        [f32::MAX, 0.0, 0.0, bound]
    }
}

/// Which of a block's eight candidates may be above `floor` at a place of the tile.
#[inline(always)]
fn above<S: Simd>(simd: S, block: &[f32], u: f32, v: f32, floor: f32) -> u32 {
    let row = lanes::inlined(
        #[inline(always)]
        |k: usize| F32x8::from_slice(simd, &block[k * LANES..(k + 1) * LANES]),
    );
    let plane = row(0) + row(1) * u + row(2) * v;
    let floor = <F32x8<S> as SimdBase<S>>::splat(simd, floor);
    (plane.simd_gt(floor) & row(3).simd_gt(floor)).to_bitmask() as u32
}
