//! Shading that ends at a limit. Whoever finds visible surfaces hands tiles on one after the other
//! and asks nothing; from the limit on nothing is shaded, and who asked for the picture is told in
//! the end.

use std::sync::OnceLock;
use vitral_exec::{Budget, Limit};

/// The limits of a picture that is shaded tile by tile.
pub(crate) struct Deadline<'a> {
    budget: &'a Budget,
    reached: OnceLock<Limit>,
}

impl<'a> Deadline<'a> {
    pub(crate) fn new(budget: &'a Budget) -> Self {
        Self { budget, reached: OnceLock::new() }
    }

    /// Whether a limit was reached. Ask before each tile.
    pub(crate) fn is_over(&self) -> bool {
        if let Err(limit) = self.budget.check("shading") {
            // Of several limits the first is kept.
            let _ = self.reached.set(limit);
        }
        self.reached.get().is_some()
    }

    /// The limit, if one was reached.
    pub(crate) fn into_result(self) -> Result<(), Limit> {
        self.reached.into_inner().map_or(Ok(()), Err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::Ordering;

    #[test]
    fn a_limit_is_kept_and_told() {
        let budget = Budget::default();
        let deadline = Deadline::new(&budget);
        assert!(!deadline.is_over());
        let cancel = budget.cancel_flag();
        cancel.store(true, Ordering::Relaxed);
        assert!(deadline.is_over());
        cancel.store(false, Ordering::Relaxed);
        assert!(deadline.is_over());
        assert_eq!(deadline.into_result(), Err(Limit::Cancelled { stage: "shading" }));
        assert_eq!(Deadline::new(&budget).into_result(), Ok(()));
    }
}
