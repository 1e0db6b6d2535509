//! The edges of the process: memory that runs out, and a standard output that is closed.
//!
//! Rust ends a process whose memory runs out by an abort, with a signal. Here it ends as at any
//! other limit: one line, exit code 7.

#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Exit code of a limit that was reached.
pub(crate) const LIMIT: u8 = 7;

/// Smaller requests are not counted: together they are little beside a mesh or a texture.
const COUNTED_FROM: usize = 1 << 10;

/// Bytes that the process has, of requests that are counted.
static TAKEN: AtomicUsize = AtomicUsize::new(0);

/// Bytes that it may have while models are read.
static ALLOWED: AtomicUsize = AtomicUsize::new(usize::MAX);

/// The system's memory. A refused request, or one beyond the allowed bytes, ends the process. For
/// programs, not for libraries.
#[derive(Debug)]
pub struct Exiting;

// SAFETY: each method is the system's own, with the same arguments; what it refuses is never
// returned.
unsafe impl GlobalAlloc for Exiting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        take(layout.size());
        // SAFETY: the caller keeps to the contract, which is the same.
        given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        take(layout.size());
        // SAFETY: the caller keeps to the contract, which is the same.
        given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, old: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        give_back(layout.size());
        take(size);
        // SAFETY: the caller keeps to the contract, which is the same.
        given(unsafe { System.realloc(old, layout, size) }, size)
    }

    unsafe fn dealloc(&self, old: *mut u8, layout: Layout) {
        give_back(layout.size());
        // SAFETY: the caller keeps to the contract, which is the same.
        unsafe { System.dealloc(old, layout) }
    }
}

/// Counts a request.
fn take(size: usize) {
    if size >= COUNTED_FROM {
        let taken = TAKEN.fetch_add(size, Ordering::Relaxed) + size;
        let allowed = ALLOWED.load(Ordering::Relaxed);
        if taken > allowed {
            end(format_args!("loading needs {taken} bytes, the memory limit is {allowed}"));
        }
    }
}

/// Counts bytes that are given back.
fn give_back(size: usize) {
    if size >= COUNTED_FROM {
        TAKEN.fetch_sub(size, Ordering::Relaxed);
    }
}

/// The memory, if there is some.
fn given(memory: *mut u8, size: usize) -> *mut u8 {
    if memory.is_null() {
        end(format_args!("the system has no memory left: {size} more bytes were asked for"));
    }
    memory
}

/// Ends the process without allocating anything.
#[cold]
fn end(what: std::fmt::Arguments<'_>) -> ! {
    // What follows may not be stopped by the limit once more.
    ALLOWED.store(usize::MAX, Ordering::Relaxed);
    let mut line = [0; 200];
    let mut rest = &mut line[..];
    // The line is longer than the messages.
    let _ = writeln!(rest, "vitral: {what}");
    let _ = writeln!(
        rest,
        "hint: fewer models, smaller textures, a smaller picture or fewer samples need less memory"
    );
    let left = rest.len();
    let _ = std::io::stderr().lock().write_all(&line[..line.len() - left]);
    std::process::exit(i32::from(LIMIT))
}

/// Allows the process so many bytes, as long as this lives.
pub(crate) struct Held(());

impl Drop for Held {
    fn drop(&mut self) {
        ALLOWED.store(usize::MAX, Ordering::Relaxed);
    }
}

/// Bytes that the process has, of requests that are counted.
pub(crate) fn taken() -> u64 {
    TAKEN.load(Ordering::Relaxed) as u64
}

/// Holds the process to so many bytes: one that asks for more ends with exit code 7.
pub(crate) fn hold(bytes: u64) -> Held {
    ALLOWED.store(usize::try_from(bytes).unwrap_or(usize::MAX), Ordering::Relaxed);
    Held(())
}

/// Whether standard output was closed when the process started.
static OUTPUT_IS_CLOSED: AtomicBool = AtomicBool::new(false);

/// Whether standard output was closed when the process started. Rust opens `/dev/null` in its
/// place, where all would seem well.
pub(crate) fn output_is_closed() -> bool {
    OUTPUT_IS_CLOSED.load(Ordering::Relaxed)
}

/// Notes whether standard output is closed, for the loader to call before Rust looks at the
/// standard streams.
#[cfg(target_os = "linux")]
pub extern "C" fn note_closed_output() {
    /// What the system says of a stream that is not open (EBADF).
    const NOT_OPEN: i32 = 9;
    // SAFETY: the number is only given to a call that fails where nothing is open.
    let output = unsafe { std::os::fd::BorrowedFd::borrow_raw(1) };
    let is_closed =
        output.try_clone_to_owned().is_err_and(|error| error.raw_os_error() == Some(NOT_OPEN));
    OUTPUT_IS_CLOSED.store(is_closed, Ordering::Relaxed);
}
