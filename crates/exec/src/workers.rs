//! Loops over a pool of our own. With one thread there is no pool and nothing is locked.

#[cfg(feature = "threads")]
use std::sync::Arc;

/// A pool of worker threads. Cheap to clone; clones share the threads.
#[derive(Clone)]
pub struct Workers {
    threads: usize,
    #[cfg(feature = "threads")]
    pool: Option<Arc<rayon::ThreadPool>>,
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
        }
    }

    /// `threads` workers; 0 means as many as the process may use (affinity, cgroup). Falls back to fewer threads
    /// where threads cannot be made.
    pub fn new(threads: usize) -> Self {
        let available = || std::thread::available_parallelism().map_or(1, usize::from);
        let threads = if threads == 0 { available() } else { threads };
        #[cfg(feature = "threads")]
        if threads > 1 {
            let built = rayon::ThreadPoolBuilder::new().num_threads(threads).thread_name(|i| format!("vitral-{i}"));
            if let Ok(pool) = built.build() {
                return Self { threads, pool: Some(Arc::new(pool)) };
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
        #[cfg(feature = "threads")]
        if let Some(pool) = &self.pool
            && items.len() > 1
        {
            use rayon::prelude::*;
            pool.install(|| items.into_par_iter().with_max_len(1).for_each(f));
            return;
        }
        items.into_iter().for_each(f);
    }

    /// `f(0), f(1), ... f(count - 1)`, in this order in the result.
    pub fn map<R: Send>(&self, count: usize, f: impl Fn(usize) -> R + Sync + Send) -> Vec<R> {
        #[cfg(feature = "threads")]
        if let Some(pool) = &self.pool
            && count > 1
        {
            use rayon::prelude::*;
            return pool.install(|| (0..count).into_par_iter().with_max_len(1).map(f).collect());
        }
        (0..count).map(f).collect()
    }

    /// Calls `f(index of the chunk, chunk)` for each piece of `chunk` elements (the last may be shorter).
    ///
    /// # Panics
    /// If `chunk` is 0.
    pub fn for_each_chunk<T: Send>(&self, slice: &mut [T], chunk: usize, f: impl Fn(usize, &mut [T]) + Sync + Send) {
        #[cfg(feature = "threads")]
        if let Some(pool) = &self.pool
            && slice.len() > chunk
        {
            use rayon::prelude::*;
            pool.install(|| slice.par_chunks_mut(chunk).enumerate().with_max_len(1).for_each(|(i, c)| f(i, c)));
            return;
        }
        slice.chunks_mut(chunk).enumerate().for_each(|(i, c)| f(i, c));
    }

    /// Runs both, at the same time where there are threads.
    pub fn join<A: Send, B: Send>(&self, a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
        #[cfg(feature = "threads")]
        if let Some(pool) = &self.pool {
            return pool.install(|| rayon::join(a, b));
        }
        (a(), b())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
