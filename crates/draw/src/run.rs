//! How a drawing is computed: threads, budget, and the memory that it has charged.

use std::sync::atomic::{AtomicU64, Ordering};
use vitral_exec::{Budget, Limit, Workers};

/// Threads and budget of one drawing.
pub(crate) struct Run<'a> {
    pub(crate) workers: &'a Workers,
    pub(crate) budget: &'a Budget,
    pub(crate) memory: Memory<'a>,
}

/// Memory charged to a budget, given back at the end.
pub(crate) struct Memory<'a> {
    budget: &'a Budget,
    charged: AtomicU64,
}

impl<'a> Run<'a> {
    /// Starts with nothing charged.
    pub(crate) fn new(workers: &'a Workers, budget: &'a Budget) -> Self {
        Self { workers, budget, memory: Memory { budget, charged: AtomicU64::new(0) } }
    }
}

impl Memory<'_> {
    /// Charges `bytes` until the drawing is done.
    pub(crate) fn charge(&self, bytes: u64) -> Result<(), Limit> {
        self.budget.charge(bytes, "the drawing")?;
        self.charged.fetch_add(bytes, Ordering::Relaxed);
        Ok(())
    }
}

impl Drop for Memory<'_> {
    fn drop(&mut self) {
        self.budget.release(self.charged.load(Ordering::Relaxed));
    }
}
