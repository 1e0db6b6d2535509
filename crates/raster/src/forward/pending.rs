//! Shadow maps that are drawn where they are looked at: a depth plane may keep the triangles of a
//! pass in place of its texels.
//!
//! A picture asks a shadow map of 16 million texels for some thousands, so it pays to compute those
//! alone. A pass that clears a texture's depth plane and draws nothing but depths into it, all kept
//! by the same comparison, leaves its tile lists behind. The first lookups in a tile go through the
//! boxes of its triangles. Then those of a tile of few are sorted by blocks of texels, and it is
//! never drawn: a texel's value is the nearest (or farthest) of them there, by the same coverage
//! and depth that drawing uses, and a bound of each triangle's depths decides most. A tile of many
//! is drawn. Either way the bits are the same, and for a lookup that compares, a bound of all the
//! tile's triangles often decides alone. Whoever needs all texels draws them:
//! [`PendingDepth::resolve`].
//!
//! In:   a pass's primitives. Out: depths of single texels, or a drawn plane.
//! Cost: a lookup is linear in the triangles of a block of texels in a tile of few, shared by the
//! texels of a tile that are looked up together; constant in others.

use super::assemble::Primitives;
use super::fragment::{stored, stored_depth};
use super::pass::{ForwardScreen, Pass};
use super::plane::{Plane, PlaneTile};
use super::state::{Compare, FragmentState};
use super::tile_index::{self, Candidate, TileIndex, TileTexels};
use super::wide::{bits_of, every, max, min, select};
use crate::kernel::nearest::NearestDepths;
use crate::kernel::traverse::Window;
use crate::{SUBPIXEL, Setup, TILE, TILE_PIXELS, Viewport};
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, OnceLock};
use vitral_exec::Workers;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Floats, LANES, Level, MOST_LANES, MaskOf, Simd, dispatch};

/// State of a draw, and the pixels that it may touch.
type ClippedState = (Arc<FragmentState>, [i32; 4]);

/// A job's triangles, which name their draws, with the state and the allowed pixels of each draw.
#[derive(Debug)]
struct PendingJob {
    primitives: Primitives,
    draws: Vec<ClippedState>,
}

/// What may decide a tile's texels.
#[derive(Debug)]
struct PendingTile {
    /// The jobs that have triangles there, in [`PendingDepth::touching`].
    jobs: Range<usize>,
    /// How many triangles that is.
    count: u32,
    /// How many lookups there were before it was known.
    asked: AtomicU32,
    /// What lookups go to, once there are some.
    known: OnceLock<Known>,
}

/// How a tile's texels are found.
#[derive(Debug)]
enum Known {
    /// Among its triangles.
    Few(Box<TileIndex>),
    /// It is drawn, as stored.
    Drawn(Box<[f32; TILE_PIXELS]>),
}

/// Lookups in a tile of many triangles after which it is drawn; before, each searches the boxes.
/// Small pictures need no more.
const DRAW_THRESHOLD: u32 = 48;

/// Lookups in a tile of few triangles after which it gets an index; before, each searches the
/// boxes. Measured: benches/results/2026-11-23-eights.md.
const INDEX_THRESHOLD: u32 = 24;

/// Number of drawn or indexed tiles that only a large picture reaches. From there on, every tile is
/// prepared at its first lookup.
const LARGE_PICTURE_TILES: u32 = 32;

/// Tiles that a thread looks at in one go when a pass is left.
const PIECE: usize = 256;

/// See the module.
#[derive(Debug)]
pub(crate) struct PendingDepth {
    /// As in [`PendingKind`].
    sign: f32,
    clear: f32,
    scale: f32,
    /// See [`margin`].
    margin: f32,
    jobs: Vec<PendingJob>,
    tiles: Vec<PendingTile>,
    /// The largest bound of each tile's triangles' depths as read, times the sign.
    bounds: Vec<f32>,
    /// Numbers of jobs, tile by tile.
    touching: Vec<u32>,
    /// How many tiles are known.
    known: AtomicU32,
    viewport: Viewport,
}

/// What a pass that can be left pending keeps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PendingKind {
    /// 1 where the larger depth stays, -1 where the smaller does.
    sign: f32,
    /// What it clears to.
    clear: f32,
    /// See [`DepthBuffer::scale`](super::plane::DepthBuffer).
    scale: f32,
}

impl PendingKind {
    /// Sorts a job's triangles by tile, with their boxes.
    pub(crate) fn finish(&self, job: &mut Primitives, screen: &ForwardScreen) {
        let Primitives { batch, boxes, .. } = job;
        boxes.resize(batch.entries());
        let margin = margin(self.scale);
        let larger = self.sign > 0.0;
        batch.finish_with_boxes(screen.screen(false), |at, packed, setup| {
            let nearest = if larger { setup.z_max } else { -setup.z_min };
            boxes.set(at, packed, nearest + margin);
        });
    }
}

/// How much larger a depth may be as read than as computed: half a step for rounding when stored,
/// and what two roundings may be off.
fn margin(scale: f32) -> f32 {
    if scale == 1.0 { 0.0 } else { 0.5 / scale + 3e-7 }
}

/// The first pixel of a tile.
fn origin(viewport: Viewport, tile: u32) -> [u32; 2] {
    let across = viewport.tiles_x();
    [tile % across * TILE as u32, tile / across * TILE as u32]
}

/// What a pass keeps whose target has this scale, if it can be left pending.
pub(crate) fn pendable(pass: &Pass, scale: f32) -> Option<PendingKind> {
    use super::pass::{Command, intersection};

    // The pass must begin by clearing all depths, and nothing else.
    let (first, rest) = pass.commands.split_first()?;
    let Command::Clear(clear) = first else { return None };
    let whole = [0, 0, pass.target.viewport.width as i32, pass.target.viewport.height as i32];
    if pass.target.samples != 1
        || clear.clip != whole
        || clear.color.is_some()
        || clear.stencil.is_some()
    {
        return None;
    }

    // Every draw must write depths alone, and all must keep the depth of the same side.
    let mut sign = 0.0;
    for command in rest {
        let Command::Draw(geometry, state) = command else { return None };
        // What waits has one clip a draw.
        if geometry.has_strokes() && intersection(geometry.clip(), state.clip) != state.clip {
            return None;
        }
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
    Some(PendingKind { sign: if sign == 0.0 { 1.0 } else { sign }, clear: clear.depth?, scale })
}

impl PendingDepth {
    /// Keeps a pass's primitives, each job after [`PendingKind::finish`]. `jobs` are with their
    /// draws' states and allowed pixels.
    pub(crate) fn new(
        kind: PendingKind,
        viewport: Viewport,
        jobs: Vec<(Primitives, Vec<ClippedState>)>,
        workers: &Workers,
        level: Level,
    ) -> Self {
        // Gather what may decide the texels of each tile, several tiles to a task.
        let PendingKind { sign, clear, scale } = kind;
        let jobs: Vec<PendingJob> =
            jobs.into_iter().map(|(primitives, draws)| PendingJob { primitives, draws }).collect();
        let count = (viewport.tiles_x() * viewport.tiles_y()) as usize;
        let pieces = workers.map(count.div_ceil(PIECE), |piece| {
            let range = piece * PIECE..((piece + 1) * PIECE).min(count);
            dispatch!(level, simd => tiles(simd, &jobs, range))
        });

        // Join the lists of all tasks.
        let (mut tiles, mut bounds, mut touching) =
            (Vec::with_capacity(count), Vec::with_capacity(count), Vec::new());
        for (piece_tiles, piece_bounds, piece_touching) in pieces {
            let first = touching.len();
            bounds.extend(piece_bounds);
            tiles.extend(piece_tiles.into_iter().map(|mut tile: PendingTile| {
                tile.jobs = tile.jobs.start + first..tile.jobs.end + first;
                tile
            }));
            touching.extend(piece_touching);
        }

        // Round the clear value as it is stored.
        let clear =
            if scale == 1.0 { clear } else { (f64::from(clear * scale) + 0.5).floor() as f32 };
        Self {
            sign,
            clear,
            scale,
            margin: margin(scale),
            jobs,
            tiles,
            bounds,
            touching,
            known: AtomicU32::new(0),
            viewport,
        }
    }

    /// The primitives, to use their memory again.
    pub(crate) fn into_primitives(self) -> impl Iterator<Item = Primitives> {
        self.jobs.into_iter().map(|job| job.primitives)
    }

    /// Whether no triangle can be above `floors`, depths in `0..=1` times the sign, or above the
    /// clear value at texels `(x, y)`, as far as bounds of tiles tell; lanes without their bit in
    /// `active` do not count.
    #[inline(always)]
    pub(crate) fn is_clear<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        [x, y]: [V::Ints; 2],
        floors: V,
        active: u32,
    ) -> bool {
        const SHIFT: u32 = TILE.trailing_zeros();
        let tiles = (y >> SHIFT) * self.viewport.tiles_x() as i32 + (x >> SHIFT);
        let (tiles, mut bounds) = (tiles.as_slice(), [f32::NEG_INFINITY; MOST_LANES]);
        for lane in 0..V::LEN {
            if let Some(bound) = self.bounds.get(tiles[lane] as u32 as usize) {
                bounds[lane] = *bound;
            }
        }
        let bounds = V::from_slice(simd, &bounds[..V::LEN]);
        let open = bounds.simd_gt(floors) & bounds.simd_gt(every::<S, V>(simd, self.best()));
        bits_of(open) & active == 0
    }

    /// The clear value in `0..=1`, times the sign.
    #[inline(always)]
    pub(crate) fn best(&self) -> f32 {
        self.clear / self.scale * self.sign
    }

    /// The depths of texels in `0..=1` as they would be read, from the farther of `known` and the
    /// clear value on: triangles that cannot beat `known` are not looked at, and one that does is
    /// enough. Pass `None` for the exact depths. Lanes without their bit in `active` yield the
    /// clear value.
    #[inline(always)]
    pub(crate) fn texels<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        [x, y]: [V::Ints; 2],
        active: u32,
        known: Option<V>,
    ) -> V {
        const SHIFT: u32 = TILE.trailing_zeros();

        // Look up the bound of each texel's tile: none of the tile's depths is better.
        let tile = (y >> SHIFT) * self.viewport.tiles_x() as i32 + (x >> SHIFT);
        let (tiles, mut bounds) = (tile.as_slice(), [f32::NEG_INFINITY; MOST_LANES]);
        for lane in 0..V::LEN {
            if let Some(bound) = self.bounds.get(tiles[lane] as u32 as usize) {
                bounds[lane] = *bound;
            }
        }

        // Close the lanes that the bound or the clear value already decides.
        let best = self.best();
        let floors = match known {
            Some(known) => known * self.sign,
            None => every(simd, f32::NEG_INFINITY),
        };
        let settled = known.is_some();
        let bounds = V::from_slice(simd, &bounds[..V::LEN]);
        let mut open =
            bits_of(bounds.simd_gt(floors) & bounds.simd_gt(every::<S, V>(simd, best))) & active;

        // Visit the tiles of the open lanes.
        let mut depths = every(simd, best);
        while open != 0 {
            // All texels of a tile go together.
            let number = tiles[open.trailing_zeros() as usize % V::LEN];
            let together =
                bits_of(tile.simd_eq(<V::Ints as SimdBase<S>>::splat(simd, number))) & open;
            open &= !together;
            let active = MaskOf::<S, V>::from_bitmask(simd, u64::from(together));
            let texels = TileTexels { x, y, active };
            let found = match self.known(number as usize, together.count_ones()) {
                Some(Known::Few(index)) => self.search(simd, index, &texels, settled, floors, best),
                Some(Known::Drawn(drawn)) => {
                    let at = (y & (TILE as i32 - 1)) * TILE as i32 + (x & (TILE as i32 - 1));
                    let (at, mut stored) = (at.as_slice(), [0.0; MOST_LANES]);
                    for lane in 0..V::LEN {
                        stored[lane] = drawn[at[lane] as usize % TILE_PIXELS];
                    }
                    V::from_slice(simd, &stored[..V::LEN]) / self.scale * self.sign
                }
                None => self.scan_all(simd, number as usize, &texels, settled, floors, best),
            };
            depths = select(active, found, depths);
        }
        depths * self.sign
    }

    /// The best of a few triangles at texels, if better than `floors` and `best`, or one that is if
    /// that settles it; times the sign.
    #[inline(never)]
    fn search<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        index: &TileIndex,
        texels: &TileTexels<S, V>,
        settled: bool,
        floors: V,
        best: f32,
    ) -> V {
        simd.vectorize(
            #[inline(always)]
            || {
                // Start from what must be beaten; a settled lane is beaten by nothing.
                let mut best = every(simd, best);
                let next = lanes::inlined(
                    #[inline(always)]
                    |best: V| {
                        let higher = max(best, floors);
                        if settled {
                            select(best.simd_gt(floors), every(simd, f32::INFINITY), higher)
                        } else {
                            higher
                        }
                    },
                );

                // Test the index's triangles, best first.
                let mut above = next(best);
                index.find(
                    simd,
                    texels,
                    above,
                    #[inline(always)]
                    |setup, covered| {
                        let depth = depths_at(simd, setup, texels);
                        // Rounding as stored takes a division: most need none.
                        let near = covered & (depth * self.sign + self.margin).simd_gt(above);
                        if near.any_true() {
                            let depth =
                                stored_depth(simd, depth, self.scale) / self.scale * self.sign;
                            best = select(near & depth.simd_gt(above), depth, best);
                            above = next(best);
                        }
                        above
                    },
                );
                best
            },
        )
    }

    /// The same for a tile of which little is known, texel by texel.
    #[inline(never)]
    fn scan_all<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        tile: usize,
        texels: &TileTexels<S, V>,
        settled: bool,
        floors: V,
        best: f32,
    ) -> V {
        simd.vectorize(
            #[inline(always)]
            || {
                let (x, y, floors) = (texels.x.as_slice(), texels.y.as_slice(), floors.as_slice());
                let (mut rest, mut depths) = (texels.active.to_bitmask(), [best; MOST_LANES]);
                while rest != 0 {
                    let lane = rest.trailing_zeros() as usize % V::LEN;
                    rest &= rest - 1;
                    depths[lane] =
                        self.scan(simd, [x[lane], y[lane]], tile, settled, floors[lane], best);
                }
                V::from_slice(simd, &depths[..V::LEN])
            },
        )
    }

    /// The same among those triangles of a tile whose box holds the texel.
    #[inline(always)]
    fn scan<S: Simd>(
        &self,
        simd: S,
        at: [i32; 2],
        tile: usize,
        settled: bool,
        floor: f32,
        mut best: f32,
    ) -> f32 {
        // Search the boxes of every job that touches the tile.
        let place = at.map(|v| v % TILE as i32);
        for &job in &self.touching[self.tiles[tile].jobs.clone()] {
            let job = &self.jobs[job as usize];
            let Primitives { batch, boxes, .. } = &job.primitives;
            let above = next_floor(settled, floor, best);
            let found = lanes::inlined(
                #[inline(always)]
                |entry| {
                    best = self.better(job, batch.item(entry), at, floor, best);
                    next_floor(settled, floor, best)
                },
            );
            boxes.find(simd, batch.tile_range(tile), place, above, found);
        }
        best
    }

    /// A triangle's depth at a texel if it is better than `floor` and `best`, else `best`; times
    /// the sign.
    #[inline(always)]
    fn better(
        &self,
        job: &PendingJob,
        setup: &Setup,
        [x, y]: [i32; 2],
        floor: f32,
        best: f32,
    ) -> f32 {
        let (px, py) = (x * SUBPIXEL + SUBPIXEL / 2, y * SUBPIXEL + SUBPIXEL / 2);
        let (depth, above) = (setup.depth(px, py), best.max(floor));
        // Rounding as stored takes a division: most need none.
        if depth * self.sign + self.margin <= above || !setup.covers(px, py) {
            return best;
        }
        let depth = stored(depth, self.scale) / self.scale * self.sign;
        if depth > above && job.allows(setup, x, y) { depth } else { best }
    }

    /// How the texels of a tile are found, of which this call looks up `count`; none if it is
    /// looked up too seldom.
    #[inline(always)]
    fn known(&self, tile: usize, count: u32) -> Option<&Known> {
        let pending = &self.tiles[tile];
        pending.known.get().or_else(
            #[inline(always)]
            || {
                let patience = if self.known.load(Ordering::Relaxed) >= LARGE_PICTURE_TILES {
                    0
                } else if pending.count as usize > tile_index::MAX_TRIANGLES {
                    DRAW_THRESHOLD
                } else {
                    INDEX_THRESHOLD
                };
                let patient = pending.asked.fetch_add(count, Ordering::Relaxed) < patience;
                (!patient).then(|| pending.known.get_or_init(|| self.know(tile)))
            },
        )
    }

    #[inline(never)]
    fn know(&self, tile: usize) -> Known {
        let pending = &self.tiles[tile];
        self.known.fetch_add(1, Ordering::Relaxed);
        if pending.count as usize > tile_index::MAX_TRIANGLES {
            return Known::Drawn(self.draw(tile));
        }

        // Gather the candidates of all jobs.
        let mut candidates = Vec::with_capacity(pending.count as usize);
        for &job in &self.touching[pending.jobs.clone()] {
            let PendingJob { primitives: Primitives { batch, boxes, .. }, draws, .. } =
                &self.jobs[job as usize];
            candidates.extend(batch.tile_range(tile).filter_map(|at| {
                let ((within, bound), setup) = (boxes.get(at)?, batch.item(at));
                Some(Candidate { within, bound, setup, clip: draws[setup.facet as usize].1 })
            }));
        }

        // Index them by blocks of texels.
        let origin = origin(self.viewport, tile as u32).map(|v| v as i32);
        Known::Few(Box::new(TileIndex::new(origin, candidates)))
    }

    /// The depths of a tile with everything drawn, as stored.
    #[inline(never)]
    fn draw(&self, tile: usize) -> Box<[f32; TILE_PIXELS]> {
        let ([x, y], level) = (origin(self.viewport, tile as u32), Level::new());
        let mut nearest = NearestDepths::with_sign((x, y), self.sign);
        for &job in &self.touching[self.tiles[tile].jobs.clone()] {
            let job = &self.jobs[job as usize];
            nearest.draw_within(
                level,
                job.primitives.batch.tile(tile).map(|s| (s, job.window(s.facet, [x, y]))),
            );
        }
        let depths = nearest.into_depths();
        let mut drawn = Box::new([self.clear; TILE_PIXELS]);
        dispatch!(level, simd => self.store(simd, &depths, &mut drawn));
        drawn
    }

    /// Brings depths, times the sign, into a tile that is clear. Rounding keeps their order: the
    /// nearest is the nearest as stored.
    #[inline(always)]
    fn store<S: Simd>(&self, simd: S, depths: &[f32], tile: &mut [f32; TILE_PIXELS]) {
        let clear = F32x8::splat(simd, self.clear);
        for (depths, tile) in depths.chunks_exact(LANES).zip(tile.chunks_exact_mut(LANES)) {
            let depth = stored_depth(simd, F32x8::from_slice(simd, depths) * self.sign, self.scale);
            let nearest = if self.sign > 0.0 { max(depth, clear) } else { min(depth, clear) };
            nearest.store_slice(tile);
        }
    }

    /// Which depth stays: 1 the larger, -1 the smaller.
    pub(crate) fn sign(&self) -> f32 {
        self.sign
    }

    /// Draws everything into the plane.
    pub(crate) fn resolve(mut self, plane: &mut Plane<f32>) {
        for (index, tile) in plane.tiles.iter_mut().enumerate() {
            *tile = PlaneTile::new(self.clear);
            if !self.tiles[index].jobs.is_empty() {
                let drawn = match self.tiles[index].known.take() {
                    Some(Known::Drawn(drawn)) => drawn,
                    _ => self.draw(index),
                };
                tile.replace(u64::MAX, true, 1).copy_from_slice(&drawn[..]);
            }
        }
    }
}

/// What may decide the texels of some tiles: their jobs lie in the vector that comes with them.
#[inline(always)]
fn tiles<S: Simd>(
    simd: S,
    jobs: &[PendingJob],
    range: Range<usize>,
) -> (Vec<PendingTile>, Vec<f32>, Vec<u32>) {
    // Most jobs touch few tiles: those without triangles are passed over eight at a time.
    let mut touched = Vec::new();
    for (number, job) in (0..).zip(jobs) {
        job.primitives
            .batch
            .touched_tiles(simd, range.clone(), |tile| touched.push([tile, number]));
    }
    // Jobs come in their order; this brings them together by tile.
    touched.sort_by_key(|t| t[0]);

    let (mut tiles, mut touching) =
        (Vec::with_capacity(range.len()), Vec::with_capacity(touched.len()));
    let mut bounds = Vec::with_capacity(range.len());
    let mut rest = touched.as_slice();

    // Gather each tile's jobs, entries and best depth.
    for tile in range {
        let here = rest.iter().take_while(|t| t[0] as usize == tile).count();
        let (mine, after) = rest.split_at(here);
        rest = after;
        let (first, mut bound, mut count) = (touching.len(), f32::NEG_INFINITY, 0);
        for &[_, number] in mine {
            let Primitives { batch, boxes, .. } = &jobs[number as usize].primitives;
            let entries = batch.tile_range(tile);
            touching.push(number);
            count += entries.len() as u32;
            bound = bound.max(boxes.largest(simd, entries));
        }
        let jobs = first..touching.len();
        bounds.push(bound);
        tiles.push(PendingTile { jobs, count, asked: AtomicU32::new(0), known: OnceLock::new() });
    }
    (tiles, bounds, touching)
}

impl PendingJob {
    /// The pixels of the tile at pixel `origin` that a draw may touch.
    fn window(&self, draw: u32, origin: [u32; 2]) -> Window {
        let [x0, y0, x1, y1] = self.draws[draw as usize].1;
        let within = |v: i32, axis: usize| (v - origin[axis] as i32).clamp(0, TILE as i32) as usize;
        [within(x0, 0)..within(x1, 0), within(y0, 1)..within(y1, 1)]
    }

    fn allows(&self, setup: &Setup, x: i32, y: i32) -> bool {
        let [x0, y0, x1, y1] = self.draws[setup.facet as usize].1;
        (x0..x1).contains(&x) && (y0..y1).contains(&y)
    }
}

/// A triangle's depths at texels, by the operations of [`Setup::depth`].
#[inline(always)]
fn depths_at<S: Simd, V: Floats<S>>(simd: S, setup: &Setup, texels: &TileTexels<S, V>) -> V {
    let away = lanes::inlined(
        #[inline(always)]
        |texel: V::Ints, axis: usize| -> V {
            let distance: V = ((texel << SUBPIXEL.trailing_zeros())
                + (SUBPIXEL / 2 - setup.origin[axis]))
                .to_float();
            distance * (1.0 / SUBPIXEL as f32)
        },
    );
    let z = (away(texels.y, 1) * setup.dz_dy + setup.z) + away(texels.x, 0) * setup.dz_dx;
    min(max(z, every(simd, setup.z_min)), every(simd, setup.z_max))
}

/// The depth that later triangles must be above. Nothing is above infinity: a depth better than the
/// floor may settle it.
#[inline(always)]
fn next_floor(settled: bool, floor: f32, best: f32) -> f32 {
    if settled && best > floor { f32::INFINITY } else { best.max(floor) }
}
