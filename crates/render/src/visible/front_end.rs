//! The geometry front end: from a view's draws to triangles that are set up on the screen and
//! sorted by tile.
//!
//! All visibility algorithms begin with it. Vertices of an instance are transformed once, in
//! pieces; triangles are culled, clipped, projected and set up job by job, on all threads. Callers
//! that walk tiles after each round of jobs bound the memory; others set up everything and keep it
//! ([`super::facets`], [`super::screen_setups`]).
//!
//! In:   prepared draws (model space). Out: batches of set-up triangles (screen space).
//! Cost: linear in vertices and triangles; memory: one round of triangles, the vertices of the
//! instances in it. Memory is taken from the session and given back to it.

use super::jobs::{Job, jobs, rounds};
use super::near_first::near_first;
use crate::prepare::PreparedInstance;
use crate::stats::GeometryStats;
use crate::{Execution, PreparedView, Session};
use std::ops::Range;
use vitral_exec::Limit;
use vitral_raster::{Batch, Draw, ScreenVertex, Setup, TileLists, transform};

/// Vertices in one piece of work.
const VERTICES_A_JOB: usize = 4096;

/// Vertices of which all or none are transformed, where few triangles of a mesh are drawn.
const VERTICES_A_BLOCK: usize = 128;

/// Where less than this part of a mesh's triangles is drawn, its vertices are searched for those
/// that are needed.
const SPARSE: usize = 2;

/// Bytes of a triangle: its setup, its entry in a tile's list, and what becomes of that when the
/// lists are sorted.
pub(super) const BYTES_A_TRIANGLE: u64 = size_of::<Setup>() as u64 + 16;

/// How many triangles a view's draws hold.
pub(super) fn triangle_count(view: &PreparedView<'_>) -> u64 {
    let draws = view.instances.iter().flat_map(|i| i.opaque.iter().chain(&i.layered));
    draws.flat_map(|d| &d.ranges).map(|r| u64::from(r.end - r.start)).sum()
}

/// In which order triangles are set up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DrawOrder {
    /// That of the scene.
    Scene,
    /// Opaque ones roughly from near to far.
    NearFirst,
}

/// The jobs of a view, the vertices of the instances at hand, and what was counted on the way.
pub(super) struct FrontEnd<'v, 'a> {
    view: &'v PreparedView<'a>,
    execution: &'v Execution,
    jobs: Vec<Job<'v, 'a>>,
    /// By instance of the view; empty where none are needed or not yet.
    vertices: Vec<Vec<ScreenVertex>>,
    pub(super) stats: GeometryStats,
}

impl<'v, 'a> FrontEnd<'v, 'a> {
    pub(super) fn new(view: &'v PreparedView<'a>, execution: &'v Execution) -> Self {
        if execution.observer.is_some() {
            view.tell_clipping(execution);
        }
        let vertices = view.instances.iter().map(|_| Vec::new()).collect();
        Self { view, execution, jobs: jobs(view), vertices, stats: GeometryStats::default() }
    }

    /// The jobs in rounds, at least one.
    pub(super) fn rounds(&self) -> Vec<Range<usize>> {
        rounds(&self.jobs)
    }

    /// All jobs as one round.
    pub(super) fn whole(&self) -> Range<usize> {
        0..self.jobs.len()
    }

    /// Brings the vertices of all instances in a round to the screen, where that has not been done
    /// in an earlier one.
    pub(super) fn transform(&mut self, round: Range<usize>) {
        // Find the instances.
        let mut needed: Vec<Option<&Draw<'_>>> = self.vertices.iter().map(|_| None).collect();
        for piece in self.jobs[round].iter().flat_map(|j| &j.pieces) {
            if self.vertices[piece.item].is_empty() {
                needed[piece.item] = Some(piece.draw);
            }
        }

        // Cut the vertices that their triangles need into pieces. Pages of new memory are first
        // touched by the threads that fill them; vertices between the pieces are never looked at.
        let mut spare = self.view.session.spare_vertices.lock().expect("spare vertices");
        let mut work = Vec::new();
        for (item, (draw, out)) in needed.iter().zip(self.vertices.iter_mut()).enumerate() {
            let Some(draw) = draw else { continue };
            *out = spare.pop().unwrap_or_else(|| bytemuck::zeroed_vec(draw.positions.len()));
            out.resize(draw.positions.len(), ScreenVertex::default());
            let mut rest = (0, out.as_mut_slice());
            for piece in needed_vertices(&self.view.instances[item], draw) {
                let (start, end) = (piece.start, piece.end);
                let (_, behind) = rest.1.split_at_mut(start - rest.0);
                let (own, behind) = behind.split_at_mut(end - start);
                rest = (end, behind);
                self.stats.vertices += (end - start) as u64;
                let chunks = draw.positions[piece]
                    .chunks(VERTICES_A_JOB)
                    .zip(own.chunks_mut(VERTICES_A_JOB));
                work.extend(chunks.map(|(positions, out)| (positions, &draw.clip_from_model, out)));
            }
        }
        drop(spare);

        let (viewport, level) = (self.view.screen.transform(), self.execution.level);
        self.execution.workers.for_each(work, |(positions, clip_from_model, out)| {
            transform(level, positions, clip_from_model, viewport, out);
        });
    }

    /// Sets up the triangles of each job of a round and, if wanted, sorts them by tile: batches,
    /// and whether they hold layers.
    pub(super) fn set_up(
        &mut self,
        round: Range<usize>,
        order: DrawOrder,
        lists: TileLists,
    ) -> Vec<(bool, Batch)> {
        let in_order = &self.jobs[round];
        let from_near = (order == DrawOrder::NearFirst).then(|| near_first(self.view, in_order));
        let jobs = from_near.as_deref().unwrap_or(in_order);
        let batches = self
            .execution
            .workers
            .map(jobs.len(), |i| (jobs[i].layered, self.batch(&jobs[i], lists)));
        for (_, batch) in &batches {
            self.stats.add(&batch.counters);
        }
        batches
    }

    /// Sets up the triangles of a job.
    fn batch(&self, job: &Job<'_, '_>, lists: TileLists) -> Batch {
        let session = self.view.session;
        let mut batch =
            session.spare_batches.lock().expect("spare batches").pop().unwrap_or_default();
        let mut unsorted =
            session.spare_unsorted.lock().expect("spare memory").pop().unwrap_or_default();
        batch.clear(lists);
        batch.exchange(&mut unsorted);
        for piece in &job.pieces {
            let vertices = &self.vertices[piece.item];
            batch.add(
                self.execution.level,
                piece.draw,
                vertices,
                piece.range.clone(),
                &self.view.screen,
            );
        }
        batch.finish(&self.view.screen);
        batch.exchange(&mut unsorted);
        session.spare_unsorted.lock().expect("spare memory").push(unsorted);
        batch
    }

    /// Gives the vertices of finished instances back: all but the last of the round, which may go
    /// on in the next.
    pub(super) fn retire(&mut self, round: Range<usize>) {
        let last = self.jobs[round].last().and_then(|j| j.pieces.last()).map(|p| p.item);
        let mut spare = self.view.session.spare_vertices.lock().expect("spare vertices");
        for (item, v) in self.vertices.iter_mut().enumerate() {
            if Some(item) != last && v.capacity() > 0 {
                let mut v = std::mem::take(v);
                v.clear();
                spare.push(v);
            }
        }
    }
}

impl Drop for FrontEnd<'_, '_> {
    fn drop(&mut self) {
        if let Ok(mut spare) = self.view.session.spare_vertices.lock() {
            spare.extend(self.vertices.drain(..).filter(|v| v.capacity() > 0));
        }
    }
}

/// The vertices, in pieces, that an instance's draws need; `draw` is one of them. All where most
/// triangles are drawn: the search would cost more than it saves.
fn needed_vertices(instance: &PreparedInstance<'_>, draw: &Draw<'_>) -> Vec<Range<usize>> {
    let vertices = draw.positions.len();
    let ranges =
        || instance.opaque.iter().chain(&instance.layered).flat_map(|d| d.ranges.iter().cloned());
    let drawn: usize = ranges().map(|range| range.len()).sum();
    if drawn > draw.triangles.len() / SPARSE {
        let all = 0..vertices;
        return vec![all];
    }

    // Mark the blocks that hold a corner, and join neighbouring ones.
    let mut marked = vec![false; vertices.div_ceil(VERTICES_A_BLOCK)];
    for triangles in ranges().map(|range| &draw.triangles[range.start as usize..range.end as usize])
    {
        triangles
            .as_flattened()
            .iter()
            .for_each(|&corner| marked[corner as usize / VERTICES_A_BLOCK] = true);
    }
    let mut pieces: Vec<Range<usize>> = Vec::new();
    for (block, _) in marked.iter().enumerate().filter(|(_, marked)| **marked) {
        let (start, end) =
            (block * VERTICES_A_BLOCK, ((block + 1) * VERTICES_A_BLOCK).min(vertices));
        match pieces.last_mut() {
            Some(last) if last.end == start => last.end = end,
            _ => pieces.push(start..end),
        }
    }
    pieces
}

/// All triangles of a view, set up and sorted by tiles: whether they are layers, in order. `None`
/// if there are too many to be set up at once.
pub(crate) fn all_batches(
    view: &PreparedView<'_>,
    execution: &Execution,
) -> Result<Option<Vec<(bool, Batch)>>, Limit> {
    let mut front_end = FrontEnd::new(view, execution);
    let [round] = &front_end.rounds()[..] else { return Ok(None) };
    execution.budget.check("visibility")?;
    front_end.transform(round.clone());
    Ok(Some(front_end.set_up(round.clone(), DrawOrder::NearFirst, TileLists::Copied)))
}

/// The batches with triangles that touch a tile.
pub(crate) fn touching(batches: &[(bool, Batch)], tile: usize) -> Vec<(bool, &Batch)> {
    let touching = batches.iter().filter(|(_, batch)| batch.tile(tile).next().is_some());
    touching.map(|(layered, batch)| (*layered, batch)).collect()
}

/// Gives the memory of batches back to the session.
pub(crate) fn give_back(session: &Session, batches: Vec<(bool, Batch)>) {
    let mut spare = session.spare_batches.lock().expect("spare batches");
    spare.extend(batches.into_iter().map(|(_, batch)| batch));
}
