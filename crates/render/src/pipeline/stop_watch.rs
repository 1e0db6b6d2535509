//! Time from stage to stage.

use vitral_exec::Budget;

/// A clock that gives the seconds since it was last asked, so that no time falls between two
/// stages.
pub(super) struct StopWatch<'a> {
    budget: &'a Budget,
    last: f64,
}

impl<'a> StopWatch<'a> {
    /// Starts at the call.
    pub(super) fn start(budget: &'a Budget) -> Self {
        Self { budget, last: budget.elapsed() }
    }

    /// Adds the seconds since the last stage to `stage`.
    pub(super) fn add_to(&mut self, stage: &mut f64) {
        let now = self.budget.elapsed();
        *stage += now - self.last;
        self.last = now;
    }
}
