//! The calling thread's context, and the way of every call into it.

use crate::environment;
use crate::floating::in_default_environment;
use crate::handle::Handle;
use crate::messages::{Messages, Waiting};
use std::any::Any;
use std::cell::Cell;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::sync::{Arc, OnceLock};
use vitral_gl::{Context, enums};

thread_local! {
    static CURRENT: Cell<*const Handle> = const { Cell::new(ptr::null()) };
}

/// The key of threads that have had a context, made with the first one.
static KEY: OnceLock<Option<libc::pthread_key_t>> = OnceLock::new();

/// Rounds in which the C library calls the destructors of keys, at least
/// (`PTHREAD_DESTRUCTOR_ITERATIONS`).
const ROUNDS: usize = 4;

/// Lets go of the current context when the thread ends, in the last round: destructors of the
/// client find it current.
extern "C" fn at_thread_end(rounds: *mut c_void) {
    let rounds = rounds.addr() + 1;
    if rounds < ROUNDS {
        count_rounds(rounds);
    } else {
        // The client's buffer may be gone: nothing is stored.
        // SAFETY: null.
        unsafe { replace(ptr::null()) };
    }
}

/// Has [`at_thread_end`] called when the calling thread ends, or in the next round of destructors.
fn count_rounds(rounds: usize) {
    let key = KEY.get_or_init(|| {
        let mut key = 0;
        // SAFETY: writes the key. The library is linked to be never unloaded (`build.rs`), so that
        // the function stays.
        (unsafe { libc::pthread_key_create(&raw mut key, Some(at_thread_end)) } == 0).then_some(key)
    });
    if let Some(key) = *key {
        // SAFETY: the key was made, and is never deleted. The value is a number.
        unsafe { libc::pthread_setspecific(key, ptr::without_provenance(rounds)) };
    }
}

/// The calling thread's context, or null.
pub(crate) fn current() -> *const Handle {
    CURRENT.get()
}

/// Makes `handle` (null: none) the calling thread's context, and lets go of the one before.
///
/// # Safety
/// `handle` is null or alive.
pub(crate) unsafe fn replace(handle: *const Handle) {
    // SAFETY: promised by the caller.
    if let Some(handle) = unsafe { handle.as_ref() } {
        handle.acquire();
        count_rounds(1);
    }
    let before = CURRENT.replace(handle);
    if !before.is_null() {
        // SAFETY: it was acquired when it became current.
        unsafe { Handle::release(before) };
    }
}

/// Calls `body` with the calling thread's context. Without one nothing happens, and the result is
/// 0. A panic becomes an error of OpenGL.
#[inline]
pub(crate) fn call<R: Default>(name: &'static str, body: impl FnOnce(&mut Context) -> R) -> R {
    // SAFETY: the current handle is alive until it is replaced.
    let Some(handle) = (unsafe { CURRENT.get().as_ref() }) else { return R::default() };
    // SAFETY: the machine belongs to this thread. Calls do not nest: `body` runs no code of the
    // client, whose debug callback is called below, when this borrow has ended.
    let context = unsafe { &mut (*handle.machine()).context };
    let result =
        in_default_environment(|| match catch_unwind(AssertUnwindSafe(|| body(context))) {
            Ok(result) => result,
            Err(cause) => panicked(context, name, cause),
        });
    if handle.messages.any() {
        deliver(handle);
    }
    result
}

/// Calls `quick` with the calling thread's context, and [`call`]s `body` if that says that it did
/// nothing. `quick` must neither panic nor leave a message: an entry point that does no more than
/// this keeps no register.
#[inline(always)]
pub(crate) fn call_unless<R: Default>(
    name: &'static str,
    quick: impl FnOnce(&mut Context) -> bool,
    body: impl FnOnce(&mut Context) -> R,
) -> R {
    // SAFETY: as in `call`.
    let context = unsafe { CURRENT.get().as_ref().map(|handle| &mut (*handle.machine()).context) };
    if context.is_some_and(quick) { R::default() } else { call_apart(name, body) }
}

/// Laid out behind what is called a million times a frame.
#[cold]
#[inline(never)]
fn call_apart<R: Default>(name: &'static str, body: impl FnOnce(&mut Context) -> R) -> R {
    call(name, body)
}

/// Turns a panic into INVALID_OPERATION.
#[cold]
#[inline(never)]
fn panicked<R: Default>(context: &mut Context, name: &str, cause: Box<dyn Any + Send>) -> R {
    let what = cause
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| cause.downcast_ref::<&str>().copied());
    let what = what.unwrap_or("no reason given");
    environment::say(&format!("{name}: this is a fault of vitral: {what}"));
    let record = AssertUnwindSafe(|| {
        context.record_error(enums::INVALID_OPERATION, name, "the library failed")
    });
    if catch_unwind(record).is_err() {
        environment::say(&format!("{name}: and the error could not be recorded"));
    }
    R::default()
}

/// `GLDEBUGPROC`.
type DebugProc = unsafe extern "C" fn(u32, u32, u32, u32, i32, *const u8, usize);

/// Calls the client's debug callback with each message that waits for the current context's. The
/// callback may call OpenGL, and even destroy the context: nothing of its handle is borrowed here.
#[cold]
#[inline(never)]
fn deliver(handle: *const Handle) {
    // SAFETY: the current handle is alive until it is replaced.
    let messages: Arc<Messages> = unsafe { Arc::clone(&(*handle).messages) };
    while let Some(Waiting { callback, user, mut message }) = messages.next() {
        let length = i32::try_from(message.text.len()).unwrap_or(i32::MAX);
        message.text.push(0);
        let callback = ptr::with_exposed_provenance::<()>(callback);
        // SAFETY: the client gave this address as a GLDEBUGPROC; the state machine calls no hook
        // for address 0.
        let callback = unsafe { std::mem::transmute::<*const (), DebugProc>(callback) };
        // SAFETY: a call as KHR_debug says, with a terminated text that lives until it returns.
        unsafe {
            callback(
                message.source,
                message.kind,
                message.id,
                message.severity,
                length,
                message.text.as_ptr(),
                user,
            );
        }
    }
}
