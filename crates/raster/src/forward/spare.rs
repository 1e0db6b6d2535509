//! Memory that passes reuse.
//!
//! What programs draw is much alike from frame to frame, so a job gets the memory of the job that
//! had its place before: each grows to what its own place needs, not to what the largest does.
//! Passes that stay pending have places of their own, since they stay while others run, and need
//! long tile lists but no vertices.

use super::assemble::{PieceScratch, Primitives};
use crate::Unsorted;
use std::sync::{Mutex, PoisonError};

/// Memory of jobs, by the number of the job.
#[derive(Debug, Default)]
pub(crate) struct SparePrimitives(Mutex<Vec<Primitives>>);

impl SparePrimitives {
    /// Memory for this many jobs, each to be taken once.
    pub(crate) fn take(&self, count: usize) -> Vec<Mutex<Primitives>> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = count.min(all.len());
        let mut jobs: Vec<_> = all.drain(..found).map(Mutex::new).collect();
        jobs.resize_with(count, Mutex::default);
        jobs
    }

    /// Takes the memory of jobs back, in their order.
    pub(crate) fn give(&self, jobs: impl IntoIterator<Item = Primitives>) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).splice(..0, jobs);
    }
}

/// What is needed while a job's primitives are assembled, and not afterwards.
#[derive(Debug, Default)]
pub(crate) struct Assembly {
    scratch: PieceScratch,
    unsorted: Unsorted,
}

impl Assembly {
    /// Exchanges its memory with that of a job: once before the job's primitives are assembled,
    /// once afterwards.
    pub(crate) fn exchange(&mut self, job: &mut Primitives) {
        std::mem::swap(&mut self.scratch, &mut job.scratch);
        job.batch.exchange(&mut self.unsorted);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_gets_the_memory_of_its_place() {
        let places = SparePrimitives::default();
        let job = |capacity| Primitives {
            records: Vec::with_capacity(capacity),
            ..Primitives::default()
        };
        let capacities = |jobs: &[Mutex<Primitives>]| -> Vec<usize> {
            jobs.iter().map(|job| job.lock().unwrap().records.capacity()).collect()
        };
        places.give([job(1), job(2), job(3)]);
        // A short pass leaves the places behind its own as they are.
        let short = places.take(1);
        assert_eq!(capacities(&short), [1]);
        places.give(short.into_iter().map(|job| job.into_inner().unwrap()));
        assert_eq!(capacities(&places.take(4)), [1, 2, 3, 0]);
    }
}
