//! Ctrl-C: asks the work to stop, and ends the process if it does not soon.

use crate::report::Failure;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use vitral::Budget;

/// Exit code of an interrupted process.
pub(crate) const INTERRUPTED: u8 = 130;

/// How long the work may take to notice. A file that is being written is finished within this time.
const PATIENCE: Duration = Duration::from_millis(300);

/// Does some work within a budget, which Ctrl-C cancels; gives the exit code.
pub(crate) fn heed(
    budget: &Budget,
    work: impl FnOnce() -> Result<u8, Failure>,
) -> Result<u8, Failure> {
    let cancelled = budget.cancel_flag();
    listen(cancelled.clone());
    let result = work();
    if cancelled.load(Ordering::Relaxed) { Ok(INTERRUPTED) } else { result }
}

/// What Ctrl-C sets: the flag of the work at hand.
static FLAG: Mutex<Option<Arc<AtomicBool>>> = Mutex::new(None);

/// Whether Ctrl-C was pressed.
static IS_ASKED: AtomicBool = AtomicBool::new(false);

/// Whether the work is to end.
pub(crate) fn is_asked() -> bool {
    IS_ASKED.load(Ordering::Relaxed)
}

/// Lets Ctrl-C end the process, soon after work that asks [`is_asked`] knows of it.
pub(crate) fn watch() {
    listen(Arc::default());
}

/// Sets `cancelled` at the first Ctrl-C. Where no handler can be set, the system's default ends the
/// process.
fn listen(cancelled: Arc<AtomicBool>) {
    let is_first = FLAG.lock().expect("no thread panics with it").replace(cancelled).is_none();
    let handler = || {
        IS_ASKED.store(true, Ordering::Relaxed);
        if let Some(flag) = &*FLAG.lock().expect("no thread panics with it") {
            flag.store(true, Ordering::Relaxed);
        }
        std::thread::sleep(PATIENCE);
        std::process::exit(i32::from(INTERRUPTED));
    };
    if is_first && ctrlc::set_handler(handler).is_err() {
        crate::report::line("warning: Ctrl-C is not handled");
    }
}
