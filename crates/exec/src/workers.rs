//! Loops over a pool of our own. With one thread there is no pool and nothing is locked.

use crate::Started;
#[cfg(all(feature = "threads", target_os = "linux", not(miri)))]
use crate::placement::Placement;
#[cfg(feature = "threads")]
use std::sync::Arc;
use std::sync::{Mutex, PoisonError};

/// A pool of worker threads. Cheap to clone; clones share the threads.
#[derive(Clone)]
pub struct Workers {
    threads: usize,
    #[cfg(feature = "threads")]
    pool: Option<Arc<rayon::ThreadPool>>,
    #[cfg(all(feature = "threads", target_os = "linux", not(miri)))]
    placement: Arc<Placement>,
}

impl std::fmt::Debug for Workers {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Workers({})", self.threads)
    }
}

impl Workers {
    /// The calling thread alone.
    pub fn single() -> Self {
        Self {
            threads: 1,
            #[cfg(feature = "threads")]
            pool: None,
            #[cfg(all(feature = "threads", target_os = "linux", not(miri)))]
            placement: Arc::default(),
        }
    }

    /// The most threads of a pool: more than machines have processors, and few enough to start at
    /// once.
    pub const MOST: usize = 1024;

    /// `threads` workers, at most [`Self::MOST`]; 0 means as many as the process may use (affinity,
    /// cgroup). Falls back to the calling thread alone where threads cannot be made.
    pub fn new(threads: usize) -> Self {
        let threads = number(threads);
        #[cfg(feature = "threads")]
        if threads > 1 {
            let builder = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .thread_name(|i| format!("vitral-{i}"));
            #[cfg(all(target_os = "linux", not(miri)))]
            let placement = Arc::<Placement>::default();
            #[cfg(all(target_os = "linux", not(miri)))]
            let builder = {
                let placement = Arc::clone(&placement);
                builder.start_handler(move |_| placement.register())
            };
            if let Ok(pool) = crate::surround::start_threads(|| builder.build()) {
                return Self {
                    threads,
                    pool: Some(Arc::new(pool)),
                    #[cfg(all(target_os = "linux", not(miri)))]
                    placement,
                };
            }
        }
        #[cfg(not(feature = "threads"))]
        let _ = threads;
        Self::single()
    }

    /// How many threads share the work.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Calls `f` with each item; the order is unspecified.
    pub fn for_each<T: Send>(&self, items: Vec<T>, f: impl Fn(T) + Sync + Send) {
        self.share(items.into_iter(), f);
    }

    /// `f(0), f(1), ... f(count - 1)`, in this order in the result.
    pub fn map<R: Send>(&self, count: usize, f: impl Fn(usize) -> R + Sync + Send) -> Vec<R> {
        if self.threads < 2 || count < 2 {
            return (0..count).map(f).collect();
        }
        let results = Mutex::new(Vec::with_capacity(count));
        self.share(0..count, |i| {
            let result = f(i);
            results.lock().unwrap_or_else(PoisonError::into_inner).push((i, result));
        });
        let mut results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
        results.sort_unstable_by_key(|(i, _)| *i);
        results.into_iter().map(|(_, result)| result).collect()
    }

    /// Calls `f(index of the chunk, chunk)` for each piece of `chunk` elements (the last may be
    /// shorter).
    ///
    /// # Panics
    /// If `chunk` is 0.
    pub fn for_each_chunk<T: Send>(
        &self,
        slice: &mut [T],
        chunk: usize,
        f: impl Fn(usize, &mut [T]) + Sync + Send,
    ) {
        self.share(slice.chunks_mut(chunk).enumerate(), |(i, chunk)| f(i, chunk));
    }

    /// Hands items to threads, one at a time. The calling thread takes part, so that little work is
    /// done before others wake. It takes the first, they the last: neighbours, who share cache
    /// lines, mostly stay together.
    fn share<T: Send>(
        &self,
        mut items: impl ExactSizeIterator<Item = T> + DoubleEndedIterator + Send,
        f: impl Fn(T) + Sync + Send,
    ) {
        #[cfg(feature = "threads")]
        if let Some(pool) = &self.pool
            && items.len() > 1
        {
            #[cfg(all(target_os = "linux", not(miri)))]
            self.make_way(pool);
            let others = self.threads.min(items.len()) - 1;
            let items = Mutex::new(items);
            let first = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
            let last = || items.lock().unwrap_or_else(PoisonError::into_inner).next_back();
            pool.in_place_scope(|scope| {
                for _ in 0..others {
                    scope.spawn(|_| {
                        while let Some(item) = last() {
                            f(item);
                        }
                    });
                }
                while let Some(item) = first() {
                    f(item);
                }
            });
            return;
        }
        items.by_ref().for_each(f);
    }

    /// Has `f` run while the calling thread goes on; it may share work among the same threads.
    ///
    /// # Errors
    /// `f` itself, where there are no threads, and while the process is about to fork
    /// ([`hold_for_fork`](crate::hold_for_fork)).
    pub fn start<F: FnOnce() + Send + 'static>(&self, f: F) -> Result<Started, F> {
        #[cfg(feature = "threads")]
        if self.pool.is_some() {
            #[cfg(all(target_os = "linux", not(miri)))]
            self.pool.iter().for_each(|pool| self.make_way(pool));
            return Started::new(
                f,
                #[cfg(all(target_os = "linux", not(miri)))]
                Arc::clone(&self.placement),
            );
        }
        Err(f)
    }

    /// Keeps workers off the processor of the calling thread, unless it works for others itself.
    #[cfg(all(feature = "threads", target_os = "linux", not(miri)))]
    fn make_way(&self, pool: &rayon::ThreadPool) {
        if pool.current_thread_index().is_none() && !crate::started::is_started() {
            self.placement.make_way();
        }
    }

    /// Runs both, at the same time where there are threads.
    pub fn join<A: Send, B: Send>(
        &self,
        a: impl FnOnce() -> A + Send,
        b: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        #[cfg(feature = "threads")]
        if let Some(pool) = &self.pool {
            #[cfg(all(target_os = "linux", not(miri)))]
            let _lent = pool.current_thread_index().is_none().then(|| self.placement.lend());
            return pool.install(|| rayon::join(a, b));
        }
        (a(), b())
    }
}

/// How many threads `asked` means.
fn number(asked: usize) -> usize {
    let available = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if asked == 0 { available() } else { asked };
    threads.min(Workers::MOST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_pool_has_more_threads_than_can_start() {
        assert_eq!(
            [3, Workers::MOST, Workers::MOST + 1, usize::MAX].map(number),
            [3, 1024, 1024, 1024]
        );
        assert!((1..=Workers::MOST).contains(&number(0)));
    }

    #[test]
    fn results_do_not_depend_on_threads() {
        for workers in [Workers::single(), Workers::new(3)] {
            assert_eq!(workers.map(5, |i| i * i), [0, 1, 4, 9, 16]);
            let mut v = vec![0; 10];
            workers.for_each_chunk(&mut v, 3, |i, c| c.fill(i));
            assert_eq!(v, [0, 0, 0, 1, 1, 1, 2, 2, 2, 3]);
            assert_eq!(workers.join(|| 1, || 2), (1, 2));
        }
    }
}
