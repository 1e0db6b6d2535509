//! Signals belong to the program: threads of the library have them blocked, so that a signal that
//! the program waits for, or has blocked, reaches no thread that it does not know of.

use std::mem::MaybeUninit;

/// What a thread's own instructions raise is not blocked: a program's handler for crashes is to see
/// it.
const OWN_FAULTS: [i32; 6] =
    [libc::SIGSEGV, libc::SIGBUS, libc::SIGFPE, libc::SIGILL, libc::SIGTRAP, libc::SIGSYS];

/// Calls `start`, which makes threads, with signals blocked: threads inherit that.
pub(crate) fn blocked(start: &mut dyn FnMut()) {
    if cfg!(miri) {
        return start();
    }
    let (mut all, mut before) = (MaybeUninit::uninit(), MaybeUninit::uninit());
    // SAFETY: fills the set, then takes known signals out of it.
    unsafe {
        libc::sigfillset(all.as_mut_ptr());
        OWN_FAULTS.iter().for_each(|&signal| _ = libc::sigdelset(all.as_mut_ptr(), signal));
    }
    // SAFETY: the first set was filled above, the second one is written.
    let failed =
        unsafe { libc::pthread_sigmask(libc::SIG_SETMASK, all.as_ptr(), before.as_mut_ptr()) };
    start();
    if failed == 0 {
        // SAFETY: the call that did not fail has written the set.
        unsafe { libc::pthread_sigmask(libc::SIG_SETMASK, before.as_ptr(), std::ptr::null_mut()) };
    }
}
