//! The z-buffer: every sample keeps the nearest facet that covers it.
//!
//! Triangles come in any order. For each covered sample their depth is compared with the depth that the sample holds;
//! the nearer one stays. Here the picture is cut into tiles of 64x64 pixels whose samples fit in the second-level
//! cache, and stay there if nobody keeps them; triangles are sorted into the tiles they touch, a few hundred thousand at
//! a time, and each tile is then walked by one thread. Blocks of 8x8 pixels remember how far their farthest sample is, so
//! that hidden triangles are rejected without looking at samples; what seems nearer is drawn first. Transparent facets
//! are not tested against each other but collected, after all opaque ones.
//!
//! In:   prepared draws (model space). Out: the samples of each tile (screen space).
//! Cost: linear in vertices, triangles and covered samples; memory: the samples and one round of triangles.
//! Source: [Catmull 1974], [Straßer 1974]; hierarchical depth after [Greene et al. 1993]. Departs from them: equal
//! depths go to the lower facet, so the order of triangles cannot be seen.

use super::brute_force::size_in_picture;
use super::facets::BYTES_A_TRIANGLE;
use super::near_first::near_first;
use super::{Peel, Resolved, TileSink, VisibleSurface, charged};
use crate::marks::Marks;
use crate::stats::GeometryStats;
use crate::trace::Step;
use crate::{Execution, PreparedView};
use std::ops::Range;
use std::sync::Mutex;
use vitral_exec::Limit;
use vitral_math::lanes::{Level, Simd, dispatch};
use vitral_raster::{
    Batch, Draw, FragmentSink, LayerList, LayerSink, NO_FACET, RowSink, SUBPIXEL, SamplePattern, ScreenVertex, TILE,
    Tile, TileGrid, TileLists, Viewport, VisibilitySink, transform, traverse_by_rows,
};

/// Triangles in one piece of work.
const TRIANGLES_A_JOB: u32 = 8192;
/// Triangles that are set up before the tiles are walked: bounds the memory.
const TRIANGLES_A_ROUND: u64 = 1 << 18;
/// Vertices in one piece of work.
const VERTICES_A_JOB: usize = 4096;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct ZBuffer;

/// A run of triangles of one draw.
#[derive(Clone)]
pub(super) struct Piece<'v, 'a> {
    pub(super) draw: &'v Draw<'a>,
    /// Index into the view's instances.
    pub(super) item: usize,
    pub(super) range: Range<u32>,
}

/// Pieces that are set up together; a job's batch holds opaque triangles or layers, not both.
pub(super) struct Job<'v, 'a> {
    pub(super) pieces: Vec<Piece<'v, 'a>>,
    pub(super) layered: bool,
}

impl VisibleSurface for ZBuffer {
    fn resolve(
        &self,
        view: &PreparedView<'_>,
        marks: Option<&Marks>,
        grid: &mut TileGrid,
        execution: &Execution,
        sink: &dyn TileSink,
    ) -> Result<Resolved, Limit> {
        let mut resolved = Resolved::default();
        let jobs = jobs(view);
        let rounds = rounds(&jobs);
        let mut vertices: Vec<Vec<ScreenVertex>> = view.instances.iter().map(|_| Vec::new()).collect();
        let layers: Vec<_> = grid.tiles.iter().map(|_| Mutex::new(view.layer_list_for(sink))).collect();
        // How many facets cover each pixel, for who looks on.
        let watched = if execution.observer.is_some() { grid.tiles.len() } else { 0 };
        let costs: Vec<Mutex<Vec<u32>>> = (0..watched).map(|_| Mutex::default()).collect();
        // Passes go through the layers of all rounds.
        let mut kept = Kept { batches: Vec::new(), charged: 0, execution };
        execution.budget.begin("rounds of triangles", rounds.len() as u64);
        for (number, round) in rounds.iter().enumerate() {
            execution.budget.check("visibility")?;
            let last = number + 1 == rounds.len();
            let jobs = &jobs[round.clone()];
            let start = execution.budget.elapsed();
            transform_vertices(view, jobs, &mut vertices, execution, &mut resolved.geometry);
            let batches = set_up(view, &near_first(view, jobs), &vertices, TileLists::Copied, execution);
            for (_, batch) in &batches {
                resolved.geometry.add(&batch.counters);
            }
            resolved.geometry_seconds += execution.budget.elapsed() - start;
            if !last {
                retire_vertices(view, jobs, &mut vertices);
            }
            let work = |index: usize, tile: &mut Tile| {
                if number == 0 {
                    tile.clear();
                }
                let mut layers = layers[index].lock().expect("no thread panics while it holds layers");
                let passes = sink.takes_passes();
                let tile_batches = batches.iter().filter(|(layered, _)| !(passes && *layered));
                let tile_batches = tile_batches.map(|(layered, batch)| (*layered, batch));
                let marks = marks.filter(|_| last);
                let tile_batches = tile_batches.chain(marks.filter(|_| !passes).map(|m| (true, &m.all)));
                if execution.observer.is_some() {
                    count_facets(view, &batches, index, tile, &mut costs[index].lock().expect("counts"));
                }
                if let Some(marks) = marks {
                    hide_behind(execution.level, &marks.hiding, index, tile, &view.pattern);
                }
                let tile_batches: Vec<_> = tile_batches.collect();
                walk(execution.level, &tile_batches, index, tile, &view.pattern, &mut layers);
                if last {
                    if execution.observer.is_some() {
                        tell_tile(view, &costs[index], execution, tile);
                    }
                    if passes {
                        let here = batches.iter().filter(|(layered, _)| *layered).map(|(_, batch)| batch);
                        let layered = kept.batches.iter().chain(here).chain(marks.map(|m| &m.all));
                        let go_on = || execution.budget.check("passes over layers").is_ok();
                        let mut pass = |peel: &mut Peel| {
                            go_on() && peel.pass(execution.level, layered.clone(), index, tile, &view.pattern)
                        };
                        sink.tile_in_passes(index, tile, &mut pass);
                        return;
                    }
                    layers.finish();
                    sink.tile(index, tile, &mut layers);
                }
            };
            execution.workers.for_each_chunk(&mut grid.tiles, 1, |index, tiles| {
                let [own] = tiles else { return };
                if sink.keeps_tiles() || rounds.len() > 1 {
                    work(index, own);
                } else {
                    with_spare(&view.session.spare_tiles, view.pattern.len(), |tile| {
                        (tile.x, tile.y) = (own.x, own.y);
                        work(index, tile);
                    });
                }
            });
            let mut batches = batches;
            if sink.takes_passes() {
                // Passes end early at a limit.
                execution.budget.check("passes over layers")?;
                batches = kept.keep(batches)?;
            }
            let mut spare = view.session.spare_batches.lock().expect("spare batches");
            spare.extend(batches.into_iter().map(|(_, batch)| batch));
            execution.budget.advance();
        }
        let mut spare = view.session.spare_vertices.lock().expect("spare vertices");
        spare.extend(vertices.into_iter().filter(|v| v.capacity() > 0));
        Ok(resolved)
    }
}

/// Resolves a view whose tiles nobody needs afterwards, without marks: each is filled in memory that the next one uses again,
/// and handed to `sink` unless nothing is in it. The samples are those that [`ZBuffer`] finds. Only the top `rows` of tiles
/// need be.
pub(crate) fn resolve_in_passing(
    view: &PreparedView<'_>,
    rows: u32,
    execution: &Execution,
    sink: &dyn TileSink,
) -> Result<(), Limit> {
    let spare: Mutex<Vec<Tile>> = Mutex::default();
    let tile = |index: usize, batches: &[(bool, &Batch)]| {
        with_spare(&spare, view.pattern.len(), |tile| {
            tile.clear();
            (tile.x, tile.y) = tile_place(view, index);
            let mut layers = view.layer_list_for(sink);
            walk(execution.level, batches, index, tile, &view.pattern, &mut layers);
            layers.finish();
            if tile.touched || !layers.is_empty() {
                sink.tile(index, tile, &mut layers);
            }
        });
    };
    if each_tile(view, rows, execution, tile)? {
        return Ok(());
    }
    // Tiles must wait for more triangles.
    let bytes = TileGrid::bytes(view.viewport, view.pattern.len());
    charged(&execution.budget, bytes, "a z-buffer", || {
        let mut grid = TileGrid::new(view.viewport, view.pattern.len());
        ZBuffer.resolve(view, None, &mut grid, execution, sink).map(|_| ())
    })
}

/// Calls `tile` with the number of each tile of the top `rows` that triangles touch, and the batches that hold them: whether
/// they are layers, in order. From any thread. Gives `false` and does nothing where there are too many triangles to be set up
/// at once.
fn each_tile(
    view: &PreparedView<'_>,
    rows: u32,
    execution: &Execution,
    tile: impl Fn(usize, &[(bool, &Batch)]) + Sync + Send,
) -> Result<bool, Limit> {
    let Some(batches) = all_batches(view, execution)? else { return Ok(false) };
    let numbers = 0..view.viewport.tiles_x() * rows.min(view.viewport.tiles_y());
    execution.workers.for_each(numbers.collect(), |number: u32| {
        let touching = touching(&batches, number as usize);
        if !touching.is_empty() {
            tile(number as usize, &touching);
        }
    });
    view.session.spare_batches.lock().expect("spare batches").extend(batches.into_iter().map(|(_, batch)| batch));
    Ok(true)
}

/// All triangles of a view, set up and sorted by tiles: whether they are layers, in order. `None` if there are too many to be
/// set up at once.
pub(crate) fn all_batches(view: &PreparedView<'_>, execution: &Execution) -> Result<Option<Vec<(bool, Batch)>>, Limit> {
    let jobs = jobs(view);
    if rounds(&jobs).len() > 1 {
        return Ok(None);
    }
    execution.budget.check("visibility")?;
    let mut vertices: Vec<Vec<ScreenVertex>> = view.instances.iter().map(|_| Vec::new()).collect();
    transform_vertices(view, &jobs, &mut vertices, execution, &mut GeometryStats::default());
    let batches = set_up(view, &near_first(view, &jobs), &vertices, TileLists::Copied, execution);
    let vertices = vertices.into_iter().filter(|v| v.capacity() > 0);
    view.session.spare_vertices.lock().expect("spare vertices").extend(vertices);
    Ok(Some(batches))
}

/// The batches with triangles that touch a tile.
pub(crate) fn touching(batches: &[(bool, Batch)], tile: usize) -> Vec<(bool, &Batch)> {
    let touching = batches.iter().filter(|(_, batch)| batch.tile(tile).next().is_some());
    touching.map(|(layered, batch)| (*layered, batch)).collect()
}

/// The first pixel of a tile.
pub(crate) fn tile_place(view: &PreparedView<'_>, index: usize) -> (u32, u32) {
    let columns = view.viewport.tiles_x();
    (index as u32 % columns * TILE as u32, index as u32 / columns * TILE as u32)
}

/// Lends `f` a tile as someone left it, or an empty one.
pub(crate) fn with_spare(spare: &Mutex<Vec<Tile>>, samples: usize, f: impl FnOnce(&mut Tile)) {
    let used = spare.lock().expect("spare tiles").pop();
    let mut tile = used.filter(|tile| tile.samples() == samples).unwrap_or_else(|| {
        let side = TILE as u32;
        let one = TileGrid::new(Viewport { width: side, height: side }, samples);
        let mut tile = one.tiles.into_iter().next().expect("one tile");
        tile.clear();
        tile
    });
    f(&mut tile);
    spare.lock().expect("spare tiles").push(tile);
}

/// Layers of earlier rounds, charged to the budget.
struct Kept<'e> {
    batches: Vec<Batch>,
    charged: u64,
    execution: &'e Execution,
}

impl Kept<'_> {
    /// Keeps the layers and gives the rest back.
    fn keep(&mut self, batches: Vec<(bool, Batch)>) -> Result<Vec<(bool, Batch)>, Limit> {
        let (layered, rest): (Vec<_>, Vec<_>) = batches.into_iter().partition(|(layered, _)| *layered);
        for (_, batch) in layered {
            let bytes = batch.counters.tile_entries * BYTES_A_TRIANGLE;
            self.execution.budget.charge(bytes, "layers to go through")?;
            self.charged += bytes;
            self.batches.push(batch);
        }
        Ok(rest)
    }
}

impl Drop for Kept<'_> {
    fn drop(&mut self) {
        self.execution.budget.release(self.charged);
    }
}

/// Adds for each pixel of a tile how many opaque facets of these batches cover its first sample.
fn count_facets(view: &PreparedView<'_>, batches: &[(bool, Batch)], index: usize, tile: &Tile, counts: &mut Vec<u32>) {
    let (rows, columns) = size_in_picture(view, tile);
    counts.resize(rows * columns, 0);
    let [sx, sy] = view.pattern.position(0);
    let setups = batches.iter().filter(|(layered, _)| !layered).flat_map(|(_, batch)| batch.tile(index));
    for setup in setups {
        for (i, count) in counts.iter_mut().enumerate() {
            let x = (tile.x as i32 + (i % columns) as i32) * SUBPIXEL + sx;
            let y = (tile.y as i32 + (i / columns) as i32) * SUBPIXEL + sy;
            *count += u32::from(setup.covers(x, y));
        }
    }
}

fn tell_tile(view: &PreparedView<'_>, counts: &Mutex<Vec<u32>>, execution: &Execution, tile: &Tile) {
    let (rows, columns) = size_in_picture(view, tile);
    let pixels = [tile.x, tile.y, columns as u32, rows as u32];
    let facets = std::mem::take(&mut *counts.lock().expect("counts"));
    execution.tell(|| Step::Tile { pixels, facets });
}

/// Cuts the view's draws into jobs of about equal size, all opaque ones first.
pub(super) fn jobs<'v, 'a>(view: &'v PreparedView<'a>) -> Vec<Job<'v, 'a>> {
    let mut jobs = Jobs::default();
    for layered in [false, true] {
        for (item, instance) in view.instances.iter().enumerate() {
            for draw in if layered { &instance.layered } else { &instance.opaque } {
                for range in &draw.ranges {
                    jobs.push(&Piece { draw, item, range: range.clone() }, layered);
                }
            }
        }
    }
    jobs.finish()
}

/// Jobs that are being filled with pieces, one after the other.
#[derive(Default)]
pub(super) struct Jobs<'v, 'a> {
    jobs: Vec<Job<'v, 'a>>,
    /// Triangles in the last one.
    size: u32,
}

impl<'v, 'a> Jobs<'v, 'a> {
    /// Appends triangles.
    pub(super) fn push(&mut self, piece: &Piece<'v, 'a>, layered: bool) {
        let mut start = piece.range.start;
        while start < piece.range.end {
            let job = match self.jobs.last_mut() {
                Some(job) if job.layered == layered && self.size < TRIANGLES_A_JOB => job,
                _ => {
                    self.size = 0;
                    self.jobs.push(Job { pieces: Vec::new(), layered });
                    self.jobs.last_mut().expect("just pushed")
                }
            };
            let end = piece.range.end.min(start + (TRIANGLES_A_JOB - self.size));
            self.size += end - start;
            match job.pieces.last_mut() {
                Some(last) if std::ptr::eq(last.draw, piece.draw) && last.range.end == start => last.range.end = end,
                _ => job.pieces.push(Piece { range: start..end, ..piece.clone() }),
            }
            start = end;
        }
    }

    pub(super) fn finish(self) -> Vec<Job<'v, 'a>> {
        self.jobs
    }
}

/// Groups jobs into rounds; there is always at least one, so that tiles are cleared and handed on.
pub(super) fn rounds(jobs: &[Job<'_, '_>]) -> Vec<Range<usize>> {
    let jobs_a_round = (TRIANGLES_A_ROUND / u64::from(TRIANGLES_A_JOB)) as usize;
    let count = jobs.len().div_ceil(jobs_a_round).max(1);
    (0..count).map(|r| r * jobs_a_round..((r + 1) * jobs_a_round).min(jobs.len())).collect()
}

/// Brings the vertices of all instances in `jobs` to the screen, where that has not been done in an earlier round.
pub(super) fn transform_vertices(
    view: &PreparedView<'_>,
    jobs: &[Job<'_, '_>],
    vertices: &mut [Vec<ScreenVertex>],
    execution: &Execution,
    stats: &mut GeometryStats,
) {
    let mut needed: Vec<Option<&Draw<'_>>> = vertices.iter().map(|_| None).collect();
    for piece in jobs.iter().flat_map(|j| &j.pieces) {
        if vertices[piece.item].is_empty() {
            needed[piece.item] = Some(piece.draw);
        }
    }
    let mut spare = view.session.spare_vertices.lock().expect("spare vertices");
    let mut work = Vec::new();
    for (draw, out) in needed.iter().zip(vertices.iter_mut()) {
        let Some(draw) = draw else { continue };
        // Pages of new memory are first touched by the threads that fill them.
        *out = spare.pop().unwrap_or_else(|| bytemuck::zeroed_vec(draw.positions.len()));
        out.resize(draw.positions.len(), ScreenVertex::default());
        stats.vertices += draw.positions.len() as u64;
        let chunks = draw.positions.chunks(VERTICES_A_JOB).zip(out.chunks_mut(VERTICES_A_JOB));
        work.extend(chunks.map(|(positions, out)| (positions, &draw.clip_from_model, out)));
    }
    drop(spare);
    let viewport = view.screen.transform();
    execution.workers.for_each(work, |(positions, clip_from_model, out)| {
        transform(execution.level, positions, clip_from_model, viewport, out);
    });
}

/// Gives the vertices of finished instances back: all but the last of the round, which may go on in the next.
pub(super) fn retire_vertices(view: &PreparedView<'_>, jobs: &[Job<'_, '_>], vertices: &mut [Vec<ScreenVertex>]) {
    let last = jobs.last().and_then(|j| j.pieces.last()).map(|p| p.item);
    let mut spare = view.session.spare_vertices.lock().expect("spare vertices");
    for (item, v) in vertices.iter_mut().enumerate() {
        if Some(item) != last && v.capacity() > 0 {
            let mut v = std::mem::take(v);
            v.clear();
            spare.push(v);
        }
    }
}

/// Sets up each job's triangles and, if wanted, sorts them by tile.
pub(super) fn set_up(
    view: &PreparedView<'_>,
    jobs: &[Job<'_, '_>],
    vertices: &[Vec<ScreenVertex>],
    tile_lists: TileLists,
    execution: &Execution,
) -> Vec<(bool, Batch)> {
    execution.workers.map(jobs.len(), |i| {
        let mut batch = view.session.spare_batches.lock().expect("spare batches").pop().unwrap_or_default();
        let mut unsorted = view.session.spare_unsorted.lock().expect("spare memory").pop().unwrap_or_default();
        batch.clear(tile_lists);
        batch.exchange(&mut unsorted);
        for piece in &jobs[i].pieces {
            batch.add(execution.level, piece.draw, &vertices[piece.item], piece.range.clone(), &view.screen);
        }
        batch.finish(&view.screen);
        batch.exchange(&mut unsorted);
        view.session.spare_unsorted.lock().expect("spare memory").push(unsorted);
        (jobs[i].layered, batch)
    })
}

/// Walks a tile's triangles.
pub(crate) fn walk(
    level: Level,
    batches: &[(bool, &Batch)],
    index: usize,
    tile: &mut Tile,
    pattern: &SamplePattern,
    layers: &mut LayerList,
) {
    walk_opaque(level, batches, index, tile, pattern);
    let place = (tile.x, tile.y);
    let mut in_front = batches.iter().filter(|(layered, batch)| *layered && batch.tile(index).next().is_some());
    let Some(first) = in_front.next() else { return };
    let in_front = std::iter::once(first).chain(in_front).map(|(_, batch)| *batch);
    dispatch!(level, simd => {
        if layers.gathers() {
            let mut sink = FragmentSink::new(tile, pattern, layers);
            in_front.for_each(|batch| walk_batch(simd, batch, index, place, pattern, &mut sink));
        } else {
            let mut sink = LayerSink::new(tile, pattern, layers);
            in_front.for_each(|batch| walk_batch(simd, batch, index, place, pattern, &mut sink));
        }
    });
}

/// Draws what is opaque in a tile. Out of line: compilers for WebAssembly take very long over functions that are very large.
#[inline(never)]
fn walk_opaque(level: Level, batches: &[(bool, &Batch)], index: usize, tile: &mut Tile, pattern: &SamplePattern) {
    let place = (tile.x, tile.y);
    dispatch!(level, simd => {
        for (_, batch) in batches.iter().filter(|(layered, _)| !layered) {
            walk_batch(simd, batch, index, place, pattern, &mut VisibilitySink::new(tile, pattern));
        }
    });
}

/// Lets facets that are drawn as layers hide what is behind them, though not each other where they are equally near: nothing is
/// left there but a depth just behind theirs.
pub(super) fn hide_behind(level: Level, hiding: &Batch, index: usize, tile: &mut Tile, pattern: &SamplePattern) {
    let Some(first) = hiding.tile(index).map(|setup| setup.facet).min() else { return };
    walk_opaque(level, &[(false, hiding)], index, tile, pattern);
    for (facet, depth) in tile.facet.iter_mut().zip(&mut tile.depth) {
        if *facet >= first && *facet != NO_FACET {
            (*facet, *depth) = (NO_FACET, depth.next_down());
        }
    }
}

#[inline(always)]
fn walk_batch<S: Simd, K: RowSink<S>>(
    simd: S,
    batch: &Batch,
    index: usize,
    place: (u32, u32),
    pattern: &SamplePattern,
    sink: &mut K,
) {
    for setup in batch.tile(index) {
        traverse_by_rows(simd, setup, place, pattern, sink);
    }
}
