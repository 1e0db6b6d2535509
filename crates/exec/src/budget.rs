//! What may stop a computation: time, memory, or the user. Clocks come in from the faces, so that
//! wasm works.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

/// Seconds since some fixed moment.
pub trait Clock: Send + Sync {
    /// The present moment, in seconds; never goes back.
    fn seconds(&self) -> f64;
}

/// A clock that stands still: no deadline ever passes.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoClock;

impl Clock for NoClock {
    fn seconds(&self) -> f64 {
        0.0
    }
}

/// Steps beyond which [`Budget::check_work`] refuses a computation: tests of a triangle at a
/// sample, about an hour of them on one thread.
pub const MAX_STEPS: u64 = 1 << 40;

/// Called with a stage's name, the work done and the whole work.
pub type Progress = dyn Fn(&str, u64, u64) + Send + Sync;

/// Why a computation stopped early.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Limit {
    /// The deadline passed.
    #[error("the time limit of {limit} s was reached during {stage}{achieved}")]
    Time {
        /// Seconds allowed.
        limit: f64,
        /// What was being done.
        stage: &'static str,
        /// How far it had come.
        achieved: Achieved,
    },
    /// More memory would be needed than allowed.
    #[error("{stage} needs {needed} bytes, the memory limit is {limit}")]
    Memory {
        /// Bytes needed in all.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
        /// What wanted them.
        stage: &'static str,
    },
    /// More steps would be needed than make sense for the algorithm.
    #[error("{stage} needs {needed} steps, the limit is {limit}")]
    Work {
        /// Steps needed.
        needed: u64,
        /// Steps allowed.
        limit: u64,
        /// What wanted them.
        stage: &'static str,
    },
    /// A drawing would have more segments than allowed.
    #[error("the limit of {limit} segments was reached during {stage}{achieved}")]
    Segments {
        /// Segments allowed.
        limit: u64,
        /// What was being done.
        stage: &'static str,
        /// How far it had come.
        achieved: Achieved,
    },
    /// The user cancelled.
    #[error("cancelled during {stage}")]
    Cancelled {
        /// What was being done.
        stage: &'static str,
    },
}

/// How much of a stage was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Achieved {
    /// Pieces done.
    pub done: u64,
    /// Pieces in all; 0 if nobody counts.
    pub whole: u64,
    /// What the pieces are, in the plural.
    pub pieces: &'static str,
}

impl std::fmt::Display for Achieved {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.whole == 0 {
            return Ok(());
        }
        write!(f, ", after {} of {} {}", self.done, self.whole, self.pieces)
    }
}

/// Time, memory, cancellation and progress of one computation. Clones share the counters.
#[derive(Clone)]
pub struct Budget {
    clock: Arc<dyn Clock>,
    start: f64,
    time_limit: Option<f64>,
    memory_limit: Option<u64>,
    memory: Arc<AtomicU64>,
    peak: Arc<AtomicU64>,
    cancelled: Arc<AtomicBool>,
    /// What is counted, and how many of it are done.
    counted: Arc<Mutex<Achieved>>,
    done: Arc<AtomicU64>,
    progress: Option<Arc<Progress>>,
}

impl std::fmt::Debug for Budget {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "Budget {{ time: {:?} s, memory: {:?} bytes }}",
            self.time_limit, self.memory_limit
        )
    }
}

impl Default for Budget {
    fn default() -> Self {
        Self::new(Arc::new(NoClock))
    }
}

impl Budget {
    /// No limits; time starts with the call.
    pub fn new(clock: Arc<dyn Clock>) -> Self {
        let start = clock.seconds();
        Self {
            clock,
            start,
            time_limit: None,
            memory_limit: None,
            memory: Arc::default(),
            peak: Arc::default(),
            cancelled: Arc::default(),
            counted: Arc::default(),
            done: Arc::default(),
            progress: None,
        }
    }

    /// Allows `seconds` from the budget's making.
    #[must_use]
    pub fn with_time_limit(mut self, seconds: Option<f64>) -> Self {
        self.time_limit = seconds;
        self
    }

    /// The seconds that are allowed.
    pub fn time_limit(&self) -> Option<f64> {
        self.time_limit
    }

    /// Allows `bytes` to be charged in all.
    #[must_use]
    pub fn with_memory_limit(mut self, bytes: Option<u64>) -> Self {
        self.memory_limit = bytes;
        self
    }

    /// A budget with the same clock, cancellation and listener that starts with the call, with
    /// nothing charged: for one of several computations with limits of their own.
    #[must_use]
    pub fn renewed(&self) -> Self {
        let start = self.clock.seconds();
        let (memory, peak) = (Arc::default(), Arc::default());
        Self { start, memory, peak, counted: Arc::default(), done: Arc::default(), ..self.clone() }
    }

    /// Reports progress to `progress`.
    #[must_use]
    pub fn with_progress(mut self, progress: Arc<Progress>) -> Self {
        self.progress = Some(progress);
        self
    }

    /// A flag that stops the computation when set.
    pub fn cancel_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.cancelled)
    }

    /// Seconds since the budget was made; 0 without a clock.
    pub fn elapsed(&self) -> f64 {
        self.clock.seconds() - self.start
    }

    /// Fails when the deadline has passed or the user cancelled. Call it once for each batch of
    /// work.
    ///
    /// # Errors
    /// [`Limit::Time`] and [`Limit::Cancelled`].
    pub fn check(&self, stage: &'static str) -> Result<(), Limit> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(Limit::Cancelled { stage });
        }
        match self.time_limit {
            Some(limit) if self.elapsed() > limit => {
                Err(Limit::Time { limit, stage, achieved: self.achieved() })
            }
            _ => Ok(()),
        }
    }

    /// Begins a stage of `whole` pieces, of which [`Self::advance`] counts the finished ones: for
    /// who asks how far it came.
    pub fn begin(&self, pieces: &'static str, whole: u64) {
        *self.counted.lock().expect("no thread panics while it counts") =
            Achieved { done: 0, whole, pieces };
        self.done.store(0, Ordering::Relaxed);
    }

    /// A piece of the stage is finished.
    pub fn advance(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    /// How far the present stage came.
    pub fn achieved(&self) -> Achieved {
        let counted = *self.counted.lock().expect("no thread panics while it counts");
        Achieved { done: self.done.load(Ordering::Relaxed).min(counted.whole), ..counted }
    }

    /// Charges `bytes` before they are allocated; give them back with [`Self::release`].
    ///
    /// # Errors
    /// [`Limit::Memory`] where more would be charged than is allowed; nothing is charged then.
    pub fn charge(&self, bytes: u64, stage: &'static str) -> Result<(), Limit> {
        let needed = self.memory.fetch_add(bytes, Ordering::Relaxed) + bytes;
        match self.memory_limit {
            Some(limit) if needed > limit => {
                self.release(bytes);
                Err(Limit::Memory { needed, limit, stage })
            }
            _ => {
                self.peak.fetch_max(needed, Ordering::Relaxed);
                Ok(())
            }
        }
    }

    /// Gives charged bytes back.
    pub fn release(&self, bytes: u64) {
        self.memory.fetch_sub(bytes, Ordering::Relaxed);
    }

    /// Runs `work` while `bytes` are charged.
    ///
    /// # Errors
    /// [`Limit::Memory`] where they are too many, and what stops `work`.
    pub fn charged<R>(
        &self,
        bytes: u64,
        stage: &'static str,
        work: impl FnOnce() -> Result<R, Limit>,
    ) -> Result<R, Limit> {
        self.charge(bytes, stage)?;
        let result = work();
        self.release(bytes);
        result
    }

    /// Refuses work of more than [`MAX_STEPS`] steps, whatever the time limit: a combination of
    /// choices that nobody waits for.
    ///
    /// # Errors
    /// [`Limit::Work`].
    pub fn check_work(&self, needed: u64, stage: &'static str) -> Result<(), Limit> {
        if needed > MAX_STEPS {
            Err(Limit::Work { needed, limit: MAX_STEPS, stage })
        } else {
            Ok(())
        }
    }

    /// The most bytes that were charged at one time.
    pub fn peak(&self) -> u64 {
        self.peak.load(Ordering::Relaxed)
    }

    /// Tells the listener, if there is one.
    pub fn progress(&self, stage: &str, done: u64, total: u64) {
        if let Some(listener) = &self.progress {
            listener(stage, done, total);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Tick(AtomicU64);
    impl Clock for Tick {
        fn seconds(&self) -> f64 {
            self.0.fetch_add(1, Ordering::Relaxed) as f64
        }
    }

    #[test]
    fn limits_stop_the_work() {
        let budget = Budget::new(Arc::new(Tick(AtomicU64::new(0)))).with_time_limit(Some(1.5));
        assert!(budget.check("a").is_ok());
        budget.begin("tiles", 12);
        budget.advance();
        let late = budget.check("b").unwrap_err();
        assert!(matches!(late, Limit::Time { stage: "b", .. }));
        assert_eq!(
            late.to_string(),
            "the time limit of 1.5 s was reached during b, after 1 of 12 tiles"
        );
        let budget = Budget::default().with_memory_limit(Some(100));
        assert!(budget.charge(80, "x").is_ok());
        assert!(matches!(
            budget.charge(30, "y"),
            Err(Limit::Memory { needed: 110, limit: 100, .. })
        ));
        budget.release(80);
        assert!(budget.charge(100, "z").is_ok());
        assert_eq!((budget.peak(), budget.renewed().peak()), (100, 0));
        assert_eq!(budget.charged(0, "z", || Ok(1)), Ok(1));
        assert!(budget.charged(1, "z", || Ok(())).is_err());
        assert!(budget.check_work(MAX_STEPS, "steps").is_ok());
        assert!(matches!(
            budget.check_work(MAX_STEPS + 1, "steps"),
            Err(Limit::Work { stage: "steps", .. })
        ));
        budget.cancel_flag().store(true, Ordering::Relaxed);
        assert!(matches!(budget.check("c"), Err(Limit::Cancelled { .. })));
    }
}
