//! Sets that grow together: union-find, by several threads at once.
//!
//! Idea: each member points to another of its set or, the set's root, to itself. Joining two sets
//! makes the higher root point to the lower one, so that a set's root is its lowest member, whoever
//! joins first. Only roots ever get a new parent from a join (compare and exchange); who looks for
//! a root halves the path on the way.
//!
//! In:   pairs of members that belong together.
//! Out:  the lowest member of each member's set.
//! Cost: nearly constant a join.
//! Source: [Tarjan 1975].

use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;

pub(crate) struct DisjointSets {
    parent: Vec<AtomicU32>,
}

impl DisjointSets {
    pub(crate) fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).map(AtomicU32::new).collect() }
    }

    pub(crate) fn find(&self, mut x: u32) -> u32 {
        loop {
            let parent = self.parent[x as usize].load(Relaxed);
            let grandparent = self.parent[parent as usize].load(Relaxed);
            if parent == grandparent {
                return parent;
            }
            // Parents only ever get lower, towards the root: another thread's store may be lost
            // without harm.
            self.parent[x as usize].store(grandparent, Relaxed);
            x = grandparent;
        }
    }

    pub(crate) fn join(&self, mut a: u32, mut b: u32) {
        // Neighbours mostly have the same parent already.
        if self.parent[a as usize].load(Relaxed) == self.parent[b as usize].load(Relaxed) {
            return;
        }
        loop {
            (a, b) = (self.find(a), self.find(b));
            if a == b {
                return;
            }
            let (low, high) = (a.min(b), a.max(b));
            // Only a root gets another parent; retry if another thread has given it one.
            if self.parent[high as usize].compare_exchange(high, low, Relaxed, Relaxed).is_ok() {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_exec::Workers;

    #[test]
    fn the_lowest_member_stands_for_its_set_whoever_joins() {
        // A chain of even and one of odd numbers, joined in pieces by several threads, each piece
        // from its far end.
        let sets = DisjointSets::new(100_000);
        Workers::new(4).map(100, |piece| {
            for i in
                (1000 * piece as u32..1000 * (piece as u32 + 1)).rev().filter(|i| i + 2 < 100_000)
            {
                sets.join(i + 2, i);
            }
        });
        assert!((0..100_000).all(|i| sets.find(i) == i % 2));
        sets.join(99_999, 4);
        assert_eq!((sets.find(77_777), sets.find(1)), (0, 0));
    }
}
