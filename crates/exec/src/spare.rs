//! Memory that threads keep from one piece of work to the next.

use std::sync::{Mutex, PoisonError};

/// As many `T` as there are threads at work on pieces; who begins a piece takes one that another
/// has left.
#[derive(Debug, Default)]
pub struct Spare<T>(Mutex<Vec<T>>);

impl<T: Default> Spare<T> {
    /// Calls `f` with one that nobody else has: as a piece before has left it, or new.
    pub fn lend<R>(&self, f: impl FnOnce(&mut T) -> R) -> R {
        let mut lent = self.all().pop().unwrap_or_default();
        let result = f(&mut lent);
        self.all().push(lent);
        result
    }

    /// All that were made, in no order.
    pub fn into_inner(self) -> Vec<T> {
        self.0.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn all(&self) -> std::sync::MutexGuard<'_, Vec<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Workers;

    #[test]
    fn nobody_shares_and_nothing_is_lost() {
        let sums = Spare::<u64>::default();
        Workers::new(3).map(1000, |i| sums.lend(|sum| *sum += i as u64));
        sums.lend(|one| sums.lend(|other| (*one, *other) = (*one + 1, *other + 2)));
        let sums = sums.into_inner();
        assert_eq!(sums.iter().sum::<u64>(), 999 * 500 + 3);
        assert!(sums.len() <= 4, "{} for three threads and one within another", sums.len());
    }
}
