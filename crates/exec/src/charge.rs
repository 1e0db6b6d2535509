//! Memory that is charged to a budget as long as something lives.

use crate::{Budget, Limit};
use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes that are charged to a budget, from any thread, and given back when this is dropped.
#[derive(Debug)]
pub struct Charge<'b> {
    budget: &'b Budget,
    stage: &'static str,
    bytes: AtomicU64,
}

impl<'b> Charge<'b> {
    /// Nothing yet; `stage` is named where the limit is reached.
    pub fn new(budget: &'b Budget, stage: &'static str) -> Self {
        Self { budget, stage, bytes: AtomicU64::new(0) }
    }

    /// Charges `bytes` more.
    ///
    /// # Errors
    /// [`Limit::Memory`].
    pub fn add(&self, bytes: u64) -> Result<(), Limit> {
        self.budget.charge(bytes, self.stage)?;
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
        Ok(())
    }

    /// Something that took `before` bytes takes `after`.
    ///
    /// # Errors
    /// [`Limit::Memory`].
    pub fn change(&self, before: u64, after: u64) -> Result<(), Limit> {
        if after >= before {
            return self.add(after - before);
        }
        self.budget.release(before - after);
        self.bytes.fetch_sub(before - after, Ordering::Relaxed);
        Ok(())
    }
}

impl Drop for Charge<'_> {
    fn drop(&mut self) {
        self.budget.release(*self.bytes.get_mut());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_charged_is_given_back() {
        let budget = Budget::default().with_memory_limit(Some(100));
        let charge = Charge::new(&budget, "a test");
        charge.add(60).unwrap();
        charge.change(60, 40).unwrap();
        assert!(matches!(charge.add(70), Err(Limit::Memory { needed: 110, .. })));
        assert!(budget.charge(61, "a test").is_err());
        drop(charge);
        budget.charge(100, "a test").unwrap();
    }
}
