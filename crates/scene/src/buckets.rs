//! Records dealt out into buckets by a small key, in parallel and always in the same order.
//!
//! Idea: a sort of millions of records over a large key range misses the cache at every step. Dealt
//! first into buckets that fit the cache, each bucket can be sorted or hashed alone, by whichever
//! thread is free. The input is read in runs of fixed length; each run counts its records per
//! bucket, then places them (a counting sort). A bucket is then the concatenation of its piece of
//! every run, in the order of the input, whatever the number of threads.
//!
//! In:   a source that visits the records of a range of items, with the bucket of each.
//! Out:  for each bucket, its records in input order.
//! Cost: two readings of the input and one writing, `O(records + runs * buckets)`.
//! Source: [Knuth 1998], sections 5.2 (distribution counting) and 5.2.5 (radix sorting).

use std::ops::Range;
use vitral_exec::Workers;

/// Items that are read together.
const RUN: usize = 1 << 16;

/// Where records come from.
pub trait Source<T>: Sync {
    /// Number of items; each has any number of records.
    fn items(&self) -> usize;
    /// Calls `put(bucket, record)` for the records of the items in `range`, in order. Called twice
    /// for each range.
    fn visit(&self, range: Range<usize>, put: impl FnMut(usize, T));
}

/// Records bucket after bucket, dealt by one thread.
#[derive(Debug)]
pub struct Dealt<T> {
    records: Vec<T>,
    starts: Vec<u32>,
}

impl<T: Copy + Default> Dealt<T> {
    /// Deals all records of `source` into `count` buckets.
    pub fn new(source: &impl Source<T>, count: usize) -> Self {
        Self::of_range(source, 0..source.items(), count)
    }

    /// Deals the records of some items.
    fn of_range(source: &impl Source<T>, range: Range<usize>, count: usize) -> Self {
        // Count the records of each bucket, and turn counts into places.
        let mut starts = vec![0u32; count + 1];
        source.visit(range.clone(), |bucket, _| starts[bucket + 1] += 1);
        for b in 0..count {
            starts[b + 1] += starts[b];
        }

        // Place the records; `next` runs ahead of `starts`, which stays as it is.
        let mut next = starts.clone();
        let mut records = vec![T::default(); starts[count] as usize];
        source.visit(range, |bucket, record| {
            records[next[bucket] as usize] = record;
            next[bucket] += 1;
        });
        Self { records, starts }
    }

    /// The records of bucket `b`, in the order of the input.
    pub fn bucket(&self, b: usize) -> &[T] {
        &self.records[self.starts[b] as usize..self.starts[b + 1] as usize]
    }

    /// Where the records of each bucket begin, and the end of the last ones; and all records.
    pub fn into_parts(self) -> (Vec<u32>, Vec<T>) {
        (self.starts, self.records)
    }
}

/// Records by bucket.
pub(crate) struct Buckets<T> {
    runs: Vec<Dealt<T>>,
    count: usize,
}

impl<T: Copy + Default + Send + Sync> Buckets<T> {
    /// Deals the records of `source` into `count` buckets.
    pub(crate) fn deal(source: &impl Source<T>, count: usize, workers: &Workers) -> Self {
        let items = source.items();
        let runs = workers.map(items.div_ceil(RUN), |r| {
            Dealt::of_range(source, r * RUN..items.min((r + 1) * RUN), count)
        });
        Self { runs, count }
    }

    /// The pieces of bucket `b`, one a run.
    pub(crate) fn pieces(&self, b: usize) -> impl Iterator<Item = &[T]> + Clone {
        self.runs.iter().map(move |run| run.bucket(b))
    }

    /// How many buckets there are.
    pub(crate) fn count(&self) -> usize {
        self.count
    }
}

/// How far to shift keys below `keys` to the right so that about 2048 of them share a bucket, and
/// how many buckets that makes (never more than 1024).
pub(crate) fn shift_and_count(keys: usize) -> (u32, usize) {
    let bits = usize::BITS - keys.leading_zeros();
    let shift = bits.saturating_sub(10).max(11);
    (shift, (keys >> shift) + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Item `i` has the record `i` in bucket `i % 3`.
    struct Numbers(usize);
    impl Source<u32> for Numbers {
        fn items(&self) -> usize {
            self.0
        }
        fn visit(&self, range: Range<usize>, mut put: impl FnMut(usize, u32)) {
            range.for_each(|i| put(i % 3, i as u32));
        }
    }

    #[test]
    fn buckets_keep_the_input_order_for_any_number_of_threads() {
        for workers in [Workers::single(), Workers::new(3)] {
            let buckets = Buckets::deal(&Numbers(200_000), 3, &workers);
            for b in 0..buckets.count() {
                let all: Vec<u32> = buckets.pieces(b).flatten().copied().collect();
                assert_eq!(all, (0..200_000).filter(|i| i % 3 == b as u32).collect::<Vec<_>>());
            }
        }
        assert_eq!(Buckets::<u32>::deal(&Numbers(0), 3, &Workers::single()).pieces(0).count(), 0);
    }

    #[test]
    fn every_key_has_a_bucket() {
        for keys in [0usize, 1, 5000, 1 << 21, u32::MAX as usize] {
            let (shift, count) = shift_and_count(keys);
            assert!((keys.saturating_sub(1) >> shift) < count && count <= 1025);
        }
    }
}
