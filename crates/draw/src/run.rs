//! How a drawing is computed: threads, budget, and the memory that it has charged.

use vitral_exec::{Budget, Charge, Workers};

/// Threads and budget of one drawing.
pub(crate) struct Run<'a> {
    pub(crate) workers: &'a Workers,
    pub(crate) budget: &'a Budget,
    /// Memory that is taken until the drawing is done.
    pub(crate) memory: Charge<'a>,
}

impl<'a> Run<'a> {
    /// Starts with nothing charged.
    pub(crate) fn new(workers: &'a Workers, budget: &'a Budget) -> Self {
        Self { workers, budget, memory: Charge::new(budget, "the drawing") }
    }
}
