//! The view's draws, cut into jobs of about equal size and grouped into rounds: the work of the
//! geometry front end.
//!
//! In:   prepared draws. Out: jobs, each of one or several runs of triangles, in the order of the
//!       scene.
//! Cost: linear in jobs and draws.

use crate::PreparedView;
use std::ops::Range;
use vitral_raster::Draw;

/// Triangles in one piece of work.
const TRIANGLES_A_JOB: u32 = 8192;
/// Triangles that are set up before the tiles are walked: bounds the memory.
const TRIANGLES_A_ROUND: u64 = 1 << 18;

/// A run of triangles of one draw.
#[derive(Clone)]
pub(super) struct TriangleRun<'v, 'a> {
    pub(super) draw: &'v Draw<'a>,
    /// Index into the view's instances.
    pub(super) item: usize,
    pub(super) range: Range<u32>,
}

/// Pieces that are set up together; a job's batch holds opaque triangles or layers, not both.
pub(super) struct Job<'v, 'a> {
    pub(super) pieces: Vec<TriangleRun<'v, 'a>>,
    pub(super) layered: bool,
}

/// Cuts the view's draws into jobs of about equal size, all opaque ones first.
pub(super) fn jobs<'v, 'a>(view: &'v PreparedView<'a>) -> Vec<Job<'v, 'a>> {
    let mut jobs = Jobs::default();
    for layered in [false, true] {
        for (item, instance) in view.instances.iter().enumerate() {
            for draw in if layered { &instance.layered } else { &instance.opaque } {
                for range in &draw.ranges {
                    jobs.push(&TriangleRun { draw, item, range: range.clone() }, layered);
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
    pub(super) fn push(&mut self, piece: &TriangleRun<'v, 'a>, layered: bool) {
        let mut start = piece.range.start;
        // Append to the open job, or begin one.
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

            // Extend the last piece if the triangles follow it.
            match job.pieces.last_mut() {
                Some(last) if std::ptr::eq(last.draw, piece.draw) && last.range.end == start => {
                    last.range.end = end
                }
                _ => job.pieces.push(TriangleRun { range: start..end, ..piece.clone() }),
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
