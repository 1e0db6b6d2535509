//! Names of objects.
//!
//! Contexts that share objects hand out names from a range of their own. A program that deletes
//! objects while a context of another range is current then deletes nothing, instead of objects of
//! that context.

use std::sync::atomic::{AtomicU32, Ordering};

/// Names in use and their objects. `None`: the name was generated but nothing has been bound to it.
pub type Names<T> = std::collections::BTreeMap<u32, Option<T>>;

/// Most names that one call generates or reads.
pub(crate) const MAX_NAMES: usize = 1 << 22;

/// The names that a group of contexts generates, as long as there are some left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NameRange {
    first: u32,
}

impl Default for NameRange {
    /// The range that begins with 1.
    fn default() -> Self {
        Self { first: 1 }
    }
}

impl NameRange {
    /// Names of a range: more than programs make objects of a kind.
    const LENGTH: u32 = 1 << 20;

    /// Ranges before the first one comes up again. Names stay below 2^31, since programs keep them
    /// as signed numbers.
    const COUNT: u32 = 1 << 11;

    /// The range after the one that was given last; the first begins with 1.
    pub(crate) fn next() -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        Self::numbered(NEXT.fetch_add(1, Ordering::Relaxed))
    }

    fn numbered(number: u32) -> Self {
        Self { first: number % Self::COUNT * Self::LENGTH + 1 }
    }

    /// The lowest name.
    pub(crate) fn first(self) -> u32 {
        self.first
    }

    /// The highest name.
    pub(crate) fn last(self) -> u32 {
        self.first + (Self::LENGTH - 1)
    }

    /// Reserves `count` unused names: above all others of the range as long as there is room, then
    /// in the gaps, then beyond.
    pub(crate) fn generate<T>(self, names: &mut Names<T>, count: usize) -> Vec<u32> {
        let below = self.first - 1;
        let highest =
            names.range(self.first..=self.last()).next_back().map_or(below, |(name, _)| *name);
        let mut candidate = if (self.last() - highest) as usize >= count { highest } else { below };

        let mut free = Vec::with_capacity(count);
        while free.len() < count {
            candidate = candidate.wrapping_add(1);
            if candidate != 0 && !names.contains_key(&candidate) {
                names.insert(candidate, None);
                free.push(candidate);
            }
        }
        free
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_new() {
        let (mut names, range) = (Names::<()>::new(), NameRange::default());
        assert_eq!(range.generate(&mut names, 2), [1, 2]);
        names.insert(u32::MAX, None);
        assert_eq!(range.generate(&mut names, 2), [3, 4]);
        names.remove(&3);
        names.insert(range.last(), None);
        assert_eq!(range.generate(&mut names, 2), [3, 5]);
        assert_eq!(names.len(), 7);
    }

    #[test]
    fn ranges_do_not_overlap() {
        let ranges: Vec<NameRange> = (0..NameRange::COUNT).map(NameRange::numbered).collect();
        assert_eq!(
            (ranges[0], ranges[1].first()),
            (NameRange::default(), NameRange::default().last() + 1)
        );
        assert!(ranges.windows(2).all(|pair| pair[0].last() < pair[1].first()));
        assert_eq!(ranges.last().map(|range| range.last()), Some(1 << 31));
        assert_eq!(NameRange::numbered(NameRange::COUNT), ranges[0]);
        let mut names = Names::<()>::from([(7, None)]);
        assert_eq!(ranges[2].generate(&mut names, 2), [(1 << 21) + 1, (1 << 21) + 2]);
    }
}
