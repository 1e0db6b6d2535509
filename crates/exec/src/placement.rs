//! Keeps workers off the processor of the thread that shares its work with them.
//!
//! Linux wakes a thread where it last ran, and looks for an idle processor only as long as few are
//! busy: of two that are busy two thirds of the time it looks at none. A worker then waits behind
//! the very thread that woke it, until the next tick of the scheduler: longer than many pictures
//! take. So workers are kept off that thread's processor; asking where it runs costs some ten
//! nanoseconds, and system calls are made only when it has moved. Where several threads share their
//! work with the same workers by turns, these are left where they are.
//!
//! Workers stay within the processors that they were given, by `taskset` for example.

use rustix::thread::{CpuSet, Pid, gettid, sched_getaffinity, sched_getcpu, sched_setaffinity};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// See the module.
#[derive(Debug, Default)]
pub(crate) struct Placement {
    workers: Mutex<Vec<Worker>>,
    /// The processor that workers are kept off, plus 1; 0 if there are some that were not told.
    avoided: AtomicUsize,
    /// The thread that shared work last: the address of its [`MARK`].
    last: AtomicUsize,
}

thread_local! {
    static MARK: u8 = const { 0 };
}

#[derive(Debug)]
struct Worker {
    thread: Pid,
    /// Where others let it run.
    allowed: CpuSet,
    /// Where it may run.
    given: CpuSet,
}

impl Placement {
    /// The calling thread is one of the workers.
    pub(crate) fn register(&self) {
        if let Ok(allowed) = sched_getaffinity(None) {
            let worker = Worker { thread: gettid(), allowed, given: allowed };
            self.workers.lock().unwrap_or_else(PoisonError::into_inner).push(worker);
            self.avoided.store(0, Ordering::Relaxed);
        }
    }

    /// Keeps workers off the calling thread's processor.
    #[inline]
    pub(crate) fn make_way(&self) {
        let this = MARK.with(|mark| std::ptr::from_ref(mark).addr());
        if self.last.swap(this, Ordering::Relaxed) != this {
            return;
        }
        let here = sched_getcpu();
        if self.avoided.swap(here + 1, Ordering::Relaxed) != here + 1 {
            self.keep_off(here);
        }
    }

    /// Where workers are kept off a processor, puts one of them on it: the calling thread waits for
    /// them as long as what is returned lives. Then all may go everywhere again.
    pub(crate) fn lend(&self) -> Option<Lent<'_>> {
        let avoided = self.avoided.swap(0, Ordering::Relaxed).checked_sub(1)?;
        let mut workers = self.workers.lock().unwrap_or_else(PoisonError::into_inner);
        let worker =
            workers.iter_mut().find(|w| avoided < CpuSet::MAX_CPU && w.allowed.is_set(avoided))?;
        let mut there = CpuSet::new();
        there.set(avoided);
        if sched_setaffinity(Some(worker.thread), &there).is_ok() {
            worker.given = there;
        }
        Some(Lent(self))
    }

    #[cold]
    fn keep_off(&self, here: usize) {
        for worker in self.workers.lock().unwrap_or_else(PoisonError::into_inner).iter_mut() {
            // Somebody else may have changed it meanwhile.
            let Ok(now) = sched_getaffinity(Some(worker.thread)) else { continue };
            if now != worker.given {
                worker.allowed = now;
            }
            let mut others = worker.allowed;
            if here < CpuSet::MAX_CPU {
                others.unset(here);
            }
            worker.given = if others.count() > 0 { others } else { worker.allowed };
            if worker.given != now && sched_setaffinity(Some(worker.thread), &worker.given).is_err()
            {
                worker.given = now;
            }
        }
    }
}

/// See [`Placement::lend`].
pub(crate) struct Lent<'p>(&'p Placement);

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        self.0.keep_off(CpuSet::MAX_CPU);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;

    #[test]
    fn workers_leave_the_processor_of_the_thread_that_shares_work() {
        let all = sched_getaffinity(None).unwrap();
        let placement = Placement::default();
        let (registered, done) = (Barrier::new(2), Barrier::new(2));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                placement.register();
                registered.wait();
                done.wait();
            });
            registered.wait();
            let thread = placement.workers.lock().unwrap()[0].thread;
            let mask = || sched_getaffinity(Some(thread)).unwrap();
            let but = |here: usize| {
                let mut others = all;
                others.unset(here);
                if others.count() > 0 { others } else { all }
            };
            for here in (0..CpuSet::MAX_CPU).filter(|&cpu| all.is_set(cpu)) {
                placement.keep_off(here);
                assert_eq!(mask(), but(here));
            }
            placement.make_way();
            placement.make_way();
            assert_ne!(placement.avoided.load(Ordering::Relaxed), 0);
            let here = placement.avoided.load(Ordering::Relaxed) - 1;
            let lent = placement.lend();
            assert!(
                mask() != all && mask().is_set(here) && mask().count() == 1 || all.count() == 1
            );
            drop(lent);
            assert_eq!((mask(), placement.avoided.load(Ordering::Relaxed)), (all, 0));
            assert!(placement.lend().is_none());
            // What others set holds.
            let last = (0..CpuSet::MAX_CPU).rfind(|&cpu| all.is_set(cpu)).unwrap();
            let mut alone = CpuSet::new();
            alone.set(last);
            sched_setaffinity(Some(thread), &alone).unwrap();
            (0..=last).for_each(|here| placement.keep_off(here));
            assert_eq!(mask(), alone);
            placement.make_way();
            assert_eq!(mask(), alone);
            done.wait();
        });
    }

    #[test]
    fn threads_that_share_work_by_turns_move_nobody() {
        let placement = Placement::default();
        let call = || (placement.make_way(), placement.avoided.load(Ordering::Relaxed)).1;
        assert_eq!(call(), 0);
        for _ in 0..3 {
            assert_eq!(std::thread::scope(|scope| scope.spawn(call).join().unwrap()), 0);
            assert_eq!(call(), 0);
        }
        // The second time in a row.
        assert!(call() > 0);
    }
}
