//! State calls, one file per chapter of the specification.

/// The attribute stacks.
#[derive(Debug, Default)]
pub(crate) struct AttribStacks {}

/// KHR_debug's log and callback, and the debug variable.
#[derive(Debug, Default)]
pub(crate) struct DebugState {}

/// Occlusion queries: names are in `Shared`, the active one here.
#[derive(Debug, Default)]
pub(crate) struct Queries {}

impl crate::Context {
    /// Records `error` if none is pending, and tells the debug output: `call` is the entry point (`glEnable`), `why` a
    /// sentence.
    pub(crate) fn record_error(&mut self, error: u32, call: &str, why: &str) {
        let _ = (call, why);
        if self.error == crate::enums::NO_ERROR {
            self.error = error;
        }
    }
}
