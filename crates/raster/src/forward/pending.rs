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
use crate::{SUBPIXEL, Setup, TILE};
use std::sync::Arc;
use vitral_math::lanes::{LANES, Level, dispatch};

/// A job's triangles and what bounds them.
#[derive(Debug)]
struct PendingJob {
    primitives: Primitives,
    /// State and allowed pixels of each draw.
    draws: Vec<(Arc<FragmentState>, [i32; 4])>,
    /// For each entry of the tile lists, in blocks of eight entries: the rows of [`candidate`].
    candidates: Vec<f32>,
    /// Where each tile's blocks begin.
    starts: Vec<u32>,
    /// The largest of a tile's.
    tile_bounds: Vec<f32>,
}

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
    if scaled < 8_388_608.0 { (scaled + 0.5).floor() } else { scaled.floor() }
}

impl PendingDepth {
    /// Keeps a pass's primitives. `jobs` are with their draws' states and allowed pixels.
    pub(crate) fn new(
        (sign, clear): (f32, f32),
        scale: f32,
        tiles_x: u32,
        tiles: usize,
        jobs: Vec<(Primitives, Vec<(Arc<FragmentState>, [i32; 4])>)>,
    ) -> Self {
        let jobs: Vec<PendingJob> =
            jobs.into_iter().map(|(p, draws)| job(p, draws, sign, scale, tiles_x as usize, tiles)).collect();
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

    /// The depth of a texel in `0..=1` as it would be read, from the farther of `known` and the clear value on: triangles that cannot beat
    /// `known` are not looked at. Pass `None` for the exact depth.
    pub(crate) fn texel(&self, x: i32, y: i32, known: Option<f32>) -> f32 {
        let tile = ((y / TILE as i32) * self.tiles_x + x / TILE as i32) as usize;
        let floor = known.map_or(f32::NEG_INFINITY, |k| k * self.sign);
        let mut best = self.clear / self.scale * self.sign;
        if self.tile_bounds.get(tile).is_none_or(|bound| *bound <= best.max(floor)) {
            return best * self.sign;
        }
        let (px, py) = (x * SUBPIXEL + SUBPIXEL / 2, y * SUBPIXEL + SUBPIXEL / 2);
        // Places within the tile, as the candidates' planes take them.
        let (u, v) = ((x % TILE as i32) as f32, (y % TILE as i32) as f32);
        for job in self.jobs.iter().filter(|job| job.tile_bounds[tile] > floor) {
            let first = job.primitives.batch.tile_range(tile).start;
            let blocks = job.starts[tile] as usize..job.starts[tile + 1] as usize;
            for (number, block) in job.candidates[blocks].chunks_exact(ROWS * LANES).enumerate() {
                let mut bits = above(block, u, v, best.max(floor));
                while bits != 0 {
                    let at = first + number * LANES + bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    let setup = job.primitives.batch.item(at);
                    let depth = stored(setup.depth(px, py), self.scale) / self.scale * self.sign;
                    if depth > best.max(floor) && setup.covers(px, py) && job.allows(setup, x, y) {
                        best = depth;
                    }
                }
            }
        }
        best * self.sign
    }

    /// Which depth stays: 1 the larger, -1 the smaller.
    pub(crate) fn sign(&self) -> f32 {
        self.sign
    }

    /// Draws everything into the plane.
    pub(crate) fn resolve(self: Box<Self>, plane: &mut Plane<f32>, scale: f32) {
        let viewport = plane.viewport();
        let tiles_x = viewport.tiles_x();
        let layout = super::shade::Layout::default();
        let states: Vec<Vec<(Arc<FragmentState>, [i32; 4])>> = self.jobs.iter().map(|job| job.draws.clone()).collect();
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
    fn allows(&self, setup: &Setup, x: i32, y: i32) -> bool {
        let draw = self.primitives.facets[setup.facet as usize].draw;
        let [x0, y0, x1, y1] = self.draws[draw as usize].1;
        (x0..x1).contains(&x) && (y0..y1).contains(&y)
    }
}

fn job(
    primitives: Primitives,
    draws: Vec<(Arc<FragmentState>, [i32; 4])>,
    sign: f32,
    scale: f32,
    tiles_x: usize,
    tiles: usize,
) -> PendingJob {
    let batch = &primitives.batch;
    let (mut candidates, mut starts) = (Vec::new(), vec![0u32]);
    let mut tile_bounds = Vec::with_capacity(tiles);
    for tile in 0..tiles {
        let origin = [(tile % tiles_x * TILE) as i32, (tile / tiles_x * TILE) as i32];
        let mut most = f32::NEG_INFINITY;
        let range = batch.tile_range(tile);
        for eight in range.clone().step_by(LANES) {
            let block = candidates.len();
            candidates.resize(block + ROWS * LANES, f32::NEG_INFINITY);
            for (lane, at) in (eight..range.end.min(eight + LANES)).enumerate() {
                let row = candidate(batch.item(at), origin, sign, scale);
                most = most.max(row[3]);
                for k in 0..ROWS {
                    candidates[block + k * LANES + lane] = row[k];
                }
            }
        }
        starts.push(candidates.len() as u32);
        tile_bounds.push(most);
    }
    PendingJob { primitives, draws, candidates, starts, tile_bounds }
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
    let margin = size * 1e-6 + 1.0 / scale.min(16_777_216.0).max(1.0e6);
    let corner = setup.z * sign + x + y + margin;
    if corner.is_finite() && dx.is_finite() && dy.is_finite() {
        [corner, dx, dy, bound]
    } else {
        [f32::MAX, 0.0, 0.0, bound]
    }
}

/// Which of a block's eight candidates may be above `floor` at a place of the tile.
#[inline(always)]
fn above(block: &[f32], u: f32, v: f32, floor: f32) -> u32 {
    let mut bits = 0;
    for lane in 0..LANES {
        let plane = block[lane] + block[LANES + lane] * u + block[2 * LANES + lane] * v;
        bits |= u32::from((plane > floor) & (block[3 * LANES + lane] > floor)) << lane;
    }
    bits
}
