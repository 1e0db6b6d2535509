//! What a program does round the making of threads.

use std::sync::OnceLock;

static AROUND: OnceLock<fn(&mut dyn FnMut())> = OnceLock::new();

/// Has `around` called whenever threads are made: it calls what makes them, once. Threads inherit
/// much of the thread that makes them, such as the mask of signals, which is a matter of the face.
/// The first call counts.
pub fn surround_thread_starts(around: fn(&mut dyn FnMut())) {
    let _ = AROUND.set(around);
}

/// Makes threads by `start`.
#[cfg(feature = "threads")]
pub(crate) fn start_threads<R>(start: impl FnOnce() -> R) -> R {
    let Some(around) = AROUND.get() else { return start() };
    let (mut start, mut started) = (Some(start), None);
    around(&mut || started = start.take().map(|start| start()));
    started.expect("the threads are made once")
}
