//! The threads that draw, shared by all contexts of the process. They belong to the process that
//! made them: after a fork the child makes its own, and never looks at its parent's, since their
//! threads are not there. What they draw while the program goes on is waited for before a fork.

use crate::environment;
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::{AtomicPtr, Ordering};
use vitral_exec::{Workers, born_of_fork, forked, hold_for_fork, surround_thread_starts};
use vitral_math::lanes::{Level, level_from_environment};
use vitral_raster::forward::Runner;

/// A runner and the process that made it. It is never freed: a thread may be asking while another
/// replaces it, and a library that is closed at the process' end must not wait for threads.
struct Pool {
    process: u32,
    runner: Arc<Runner>,
}

/// No lock: it could be held by a thread that a fork leaves behind.
static POOL: AtomicPtr<Pool> = AtomicPtr::new(ptr::null_mut());

unsafe extern "C" {
    /// POSIX: calls `prepare` before a fork, `parent` and `child` after it. Not 0 if there is no
    /// memory for it.
    fn pthread_atfork(
        prepare: extern "C" fn(),
        parent: extern "C" fn(),
        child: extern "C" fn(),
    ) -> i32;
}

extern "C" fn before_fork() {
    hold_for_fork();
}

extern "C" fn after_fork() {
    forked();
}

extern "C" fn in_child() {
    born_of_fork();
}

/// The process' runner.
pub(crate) fn runner() -> Arc<Runner> {
    let process = std::process::id();
    let found = POOL.load(Ordering::Acquire);
    // SAFETY: what `POOL` points to is never freed.
    if let Some(pool) = unsafe { found.as_ref() }.filter(|pool| pool.process == process) {
        return Arc::clone(&pool.runner);
    }
    let level = level_from_environment().unwrap_or_else(|why| {
        environment::say(&why);
        Level::new()
    });
    if found.is_null() {
        // The child has the same handlers. Where two threads come here at the same time, there are
        // two of each: no harm. SAFETY: the library is linked to be never unloaded (`build.rs`), so
        // that the functions stay.
        let failed = unsafe { pthread_atfork(before_fork, after_fork, in_child) };
        if failed != 0 {
            environment::say("no memory to be told of forks: do not fork while something is drawn");
        }
    }
    surround_thread_starts(crate::signals::blocked);
    let runner = Arc::new(Runner::new(Workers::new(environment::threads()), level));
    let made = Box::into_raw(Box::new(Pool { process, runner }));
    match POOL.compare_exchange(found, made, Ordering::AcqRel, Ordering::Acquire) {
        // SAFETY: never freed, as it is in `POOL`.
        Ok(_) => Arc::clone(&unsafe { &*made }.runner),
        Err(other) => {
            // SAFETY: another thread was faster, so that `made` is ours alone; theirs is never
            // freed.
            unsafe {
                drop(Box::from_raw(made));
                Arc::clone(&(*other).runner)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_has_one_runner() {
        assert!(Arc::ptr_eq(&runner(), &runner()));
        assert!((1..=1024).contains(&runner().workers.threads()));
    }
}
