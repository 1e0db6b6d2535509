//! Who computes a frame, with which instructions, and how much it may cost.

use crate::trace::{Observer, Step};
use std::sync::Arc;
use vitral_exec::{Budget, Workers};
use vitral_math::lanes::Level;

/// The means of a frame: threads, instruction set, limits, and who watches. Pictures do not depend
/// on any of them.
#[derive(Clone, Debug)]
pub struct Execution {
    /// The threads.
    pub workers: Workers,
    /// The instruction set.
    pub level: Level,
    /// Time, memory, cancellation, progress.
    pub budget: Budget,
    /// Receives the steps of the algorithm.
    pub observer: Option<Arc<dyn Observer>>,
}

impl Execution {
    /// Sends the step that `step` makes to the observer, if there is one.
    #[inline]
    pub fn report(&self, step: impl FnOnce() -> Step) {
        if let Some(observer) = &self.observer {
            observer.step(&step());
        }
    }
}

impl Default for Execution {
    /// All threads that the process may use, the machine's best instruction set, no limits.
    fn default() -> Self {
        Self {
            workers: Workers::new(0),
            level: Level::new(),
            budget: Budget::default(),
            observer: None,
        }
    }
}
