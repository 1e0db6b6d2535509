//! Work without the interpreter's lock, which Ctrl-C ends.

use pyo3::prelude::*;
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

/// How often signals are looked for: what this adds to the time in which a picture stops.
const INTERVAL: Duration = Duration::from_millis(20);

/// The stack of the thread that works, as large as that of a main thread.
const STACK: usize = 8 << 20;

thread_local! {
    /// The process for which this thread is known to be the main one or not.
    static MAIN: Cell<Option<(u32, bool)>> = const { Cell::new(None) };
}

/// Whether Python handles signals on this thread.
fn handles_signals(py: Python<'_>) -> PyResult<bool> {
    let process = std::process::id();
    if let Some((_, is_main)) = MAIN.get().filter(|(known, _)| *known == process) {
        return Ok(is_main);
    }
    let threading = py.import("threading")?;
    let main = threading.call_method0("main_thread")?.getattr("ident")?;
    let is_main = main.eq(threading.call_method0("get_ident")?)?;
    MAIN.set(Some((process, is_main)));
    Ok(is_main)
}

/// Does some work while other Python threads run. On the thread that handles signals, they are
/// handled meanwhile; an exception from there, such as `KeyboardInterrupt`, sets `cancel`, and is
/// raised when the work has ended.
pub(crate) fn run<R: Send>(
    py: Python<'_>,
    cancel: &AtomicBool,
    work: impl FnOnce() -> R + Send,
) -> PyResult<R> {
    if !handles_signals(py)? {
        return Ok(py.detach(work));
    }
    py.detach(|| {
        thread::scope(|scope| {
            let (done, finished) = sync_channel::<()>(1);
            let started = thread::Builder::new()
                .stack_size(STACK)
                .name("vitral".to_owned())
                .spawn_scoped(scope, || {
                    // Dropped when the work has ended, however it ends.
                    let _done = done;
                    work()
                });
            let worker =
                started.map_err(|e| pyo3::exceptions::PyOSError::new_err(e.to_string()))?;
            let mut raised = None;
            while let Err(RecvTimeoutError::Timeout) = finished.recv_timeout(INTERVAL) {
                if raised.is_none()
                    && let Err(error) = Python::attach(|py| py.check_signals())
                {
                    cancel.store(true, Ordering::Relaxed);
                    raised = Some(error);
                }
            }
            let result = worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            match raised {
                Some(error) => Err(error),
                None => Ok(result),
            }
        })
    })
}
