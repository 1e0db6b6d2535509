//! The Lab's engine for JavaScript, without any bindings but memory: a message goes in at a place
//! that `lab_alloc` gave, and the answer lies at the place that `lab_request` gives, its length
//! first.

// Exporting functions by name and reading what JavaScript wrote into memory are the only ways into
// a WebAssembly module.
#![allow(unsafe_code)]

use std::cell::RefCell;
use std::sync::Arc;
use vitral_lab::{Lab, Message};

#[cfg(target_arch = "wasm32")]
#[link(wasm_import_module = "env")]
unsafe extern "C" {
    /// Milliseconds, from any beginning.
    safe fn lab_now() -> f64;
}

/// Elsewhere this library is only built, never called.
#[cfg(not(target_arch = "wasm32"))]
fn lab_now() -> f64 {
    0.0
}

/// The page's clock.
#[derive(Debug)]
struct PageClock;

impl vitral_lab::Clock for PageClock {
    fn seconds(&self) -> f64 {
        lab_now() / 1000.0
    }
}

/// What stays from request to request.
struct PageState {
    lab: Lab,
    request: Vec<u8>,
    answer: Vec<u8>,
}

thread_local! {
    static KEPT: RefCell<PageState> =
        RefCell::new(PageState { lab: Lab::with_clock(Arc::new(PageClock)), request: Vec::new(), answer: Vec::new() });
}

/// Makes room for a message of `length` bytes, and gives its place.
#[unsafe(no_mangle)]
pub extern "C" fn lab_alloc(length: usize) -> *mut u8 {
    KEPT.with_borrow_mut(|kept| {
        kept.request = vec![0; length];
        kept.request.as_mut_ptr()
    })
}

/// Answers the message that was written to where [`lab_alloc`] said. At the place that is given lie
/// the length of the answer, four bytes from the lowest, then the answer; it stays there until the
/// next request.
#[unsafe(no_mangle)]
pub extern "C" fn lab_request() -> *const u8 {
    KEPT.with_borrow_mut(|kept| {
        let request = Message::from_bytes(&std::mem::take(&mut kept.request)).unwrap_or_default();
        let answer = kept.lab.answer(request).to_bytes();
        kept.answer = (answer.len() as u32).to_le_bytes().to_vec();
        kept.answer.extend(answer);
        kept.answer.as_ptr()
    })
}
