//! Work that goes on while the thread that asked for it does something else.
//!
//! It runs on a thread of its own, which shares what there is to share among the workers: a worker
//! that waits for others takes up whatever is waiting meanwhile, another such work included, and
//! would stand before locks that it holds itself.
//!
//! A process that forks while such work is going on would leave half of it to the child, whose
//! threads are not there. So whoever may be part of a process that forks has [`hold_for_fork`]
//! called before it, and after it [`forked`] and, in the child, [`born_of_fork`].

#[cfg(all(feature = "threads", target_os = "linux", not(miri)))]
use crate::placement::Placement;
#[cfg(feature = "threads")]
use crate::surround::start_threads;
#[cfg(feature = "threads")]
use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

/// How many works are going on in the process.
static GOING_ON: AtomicUsize = AtomicUsize::new(0);

/// How many threads are about to fork.
static FORKING: AtomicUsize = AtomicUsize::new(0);

#[cfg(feature = "threads")]
thread_local! {
    /// Whether the thread runs nothing but a work that was started.
    static IS_STARTED: Cell<bool> = const { Cell::new(false) };
}

/// Whether the calling thread is one that [`Workers::start`] has made.
#[cfg(all(feature = "threads", target_os = "linux", not(miri)))]
pub(crate) fn is_started() -> bool {
    IS_STARTED.get()
}

/// What [`Workers::start`](crate::Workers::start) has started. To drop it is not to stop it.
pub struct Started {
    #[cfg(all(feature = "threads", target_os = "linux", not(miri)))]
    placement: Arc<Placement>,
    outcome: Arc<Outcome>,
}

/// How it ended.
#[derive(Default)]
struct Outcome {
    done: Mutex<Option<thread::Result<()>>>,
    told: Condvar,
}

impl std::fmt::Debug for Started {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Started(done: {})", self.is_done())
    }
}

impl Started {
    /// Starts `f` on a thread of its own; gives `f` back if there is none, or while the process is
    /// about to fork.
    #[cfg(feature = "threads")]
    pub(crate) fn new<F>(
        f: F,
        #[cfg(all(target_os = "linux", not(miri)))] placement: Arc<Placement>,
    ) -> Result<Self, F>
    where
        F: FnOnce() + Send + 'static,
    {
        // Count the work, unless the process is about to fork.
        GOING_ON.fetch_add(1, SeqCst);
        let give_back = |f| {
            GOING_ON.fetch_sub(1, SeqCst);
            Err(f)
        };
        if FORKING.load(SeqCst) != 0 {
            return give_back(f);
        }

        // Let a thread take the work. If there is none, the work must come back.
        let outcome = Arc::new(Outcome::default());
        let started = Self {
            #[cfg(all(target_os = "linux", not(miri)))]
            placement,
            outcome: Arc::clone(&outcome),
        };
        let work = Arc::new(Mutex::new(Some(f)));
        let taken = Arc::clone(&work);
        let run = move || {
            IS_STARTED.set(true);
            let work = lock(&taken).take();
            let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                work.map_or((), |work| work())
            }));
            *lock(&outcome.done) = Some(result);
            outcome.told.notify_all();
            drop(outcome);
            GOING_ON.fetch_sub(1, SeqCst);
        };
        match start_threads(|| thread::Builder::new().name("vitral-ahead".into()).spawn(run)) {
            Ok(_) => Ok(started),
            Err(_) => give_back(lock(&work).take().expect("no thread took it")),
        }
    }

    /// Whether it has ended.
    pub fn is_done(&self) -> bool {
        lock(&self.outcome.done).is_some()
    }

    /// Returns when it has ended.
    ///
    /// # Panics
    /// If the work panicked: its panic goes on here.
    pub fn wait(self) {
        let mut done = lock(&self.outcome.done);
        #[cfg(all(feature = "threads", target_os = "linux", not(miri)))]
        let _lent = done.is_none().then(|| self.placement.lend());
        while done.is_none() {
            done = self.outcome.told.wait(done).unwrap_or_else(PoisonError::into_inner);
        }
        if let Some(Err(panic)) = done.take() {
            drop(done);
            std::panic::resume_unwind(panic);
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Waits until nothing is going on, and lets nothing start until [`forked`] or [`born_of_fork`] is
/// called.
pub fn hold_for_fork() {
    FORKING.fetch_add(1, SeqCst);
    while GOING_ON.load(SeqCst) != 0 {
        thread::yield_now();
    }
}

/// To be called in the parent after a fork.
pub fn forked() {
    FORKING.fetch_sub(1, SeqCst);
}

/// To be called in the child after a fork. Other threads of the parent, which are not there, may
/// have been about to start something, or to fork.
pub fn born_of_fork() {
    GOING_ON.store(0, SeqCst);
    FORKING.store(0, SeqCst);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Workers;
    use std::sync::mpsc::channel;

    /// Held by tests that start something, since what they hold up is held up for the whole
    /// process.
    static ALONE: Mutex<()> = Mutex::new(());

    #[test]
    fn work_goes_on_beside_the_caller_and_shares_its_threads() {
        let _alone = lock(&ALONE);
        let workers = Workers::new(2);
        let (to, from) = channel();
        let (back, answer) = channel();
        let own = workers.clone();
        let work = move || {
            let asked: u32 = from.recv().unwrap();
            back.send(own.map(100, |i| i as u32 * asked).iter().sum::<u32>()).unwrap();
        };
        let started = workers.start(work).unwrap_or_else(|_| panic!("there are threads"));
        assert!(!started.is_done());
        to.send(3).unwrap();
        assert_eq!(answer.recv(), Ok(3 * 4950));
        started.wait();

        let broken = workers
            .start(|| panic!("as it should"))
            .unwrap_or_else(|_| panic!("there are threads"));
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| broken.wait())).is_err());
        assert!(Workers::single().start(|| ()).is_err(), "there is no thread that could");
    }

    /// The first work holds a lock and waits for workers, the second one wants the lock: no worker
    /// may take up the second one while the first waits there.
    #[test]
    fn works_that_hold_locks_do_not_stand_before_their_own() {
        let _alone = lock(&ALONE);
        let workers = Workers::new(2);
        let (held, sum) = (Arc::new(Mutex::new(())), Arc::new(AtomicUsize::new(0)));
        let start = || {
            let (own, held, sum) = (workers.clone(), Arc::clone(&held), Arc::clone(&sum));
            let work = move || {
                let _held = lock(&held);
                for _ in 0..20 {
                    own.for_each((0..8).collect(), |i: usize| {
                        thread::yield_now();
                        sum.fetch_add(i, SeqCst);
                    });
                }
            };
            workers.start(work).unwrap_or_else(|_| panic!("there are threads"))
        };
        let all: Vec<Started> = (0..6).map(|_| start()).collect();
        all.into_iter().for_each(Started::wait);
        assert_eq!(sum.load(SeqCst), 6 * 20 * 28);
    }

    #[test]
    fn nothing_is_going_on_when_a_process_forks() {
        let _alone = lock(&ALONE);
        let workers = Workers::new(2);
        let (to, from) = channel::<()>();
        let started = workers
            .start(move || from.recv().unwrap())
            .unwrap_or_else(|_| panic!("there are threads"));
        let about_to_fork = thread::spawn(hold_for_fork);
        while FORKING.load(SeqCst) == 0 {
            thread::yield_now();
        }
        assert!(workers.start(|| ()).is_err() && !about_to_fork.is_finished());
        to.send(()).unwrap();
        started.wait();
        about_to_fork.join().unwrap();
        forked();
        workers.start(|| ()).unwrap_or_else(|_| panic!("it may start again")).wait();

        // Two threads fork, and a third one starts something: a child has the counts, but not the
        // threads.
        (0..2).for_each(|_| hold_for_fork());
        GOING_ON.fetch_add(1, SeqCst);
        born_of_fork();
        workers.start(|| ()).unwrap_or_else(|_| panic!("a child may start")).wait();
        hold_for_fork();
        forked();
    }
}
