//! KHR_debug: who is told what happened. The way of a message: dropped if the output is off or the
//! application does not want it; else to the callback; without one, to the log.

mod calls;
mod control;
mod groups;
mod labels;

pub(crate) use labels::Labels;

use crate::{Context, enums as gl};
use control::Volume;
use std::collections::VecDeque;
use std::sync::Arc;

/// Characters of a message, with its NUL.
pub(super) const MAX_MESSAGE_LENGTH: usize = 4096;
/// Messages that the log keeps.
pub(super) const MAX_LOGGED: usize = 256;
/// Groups on the stack, with the default group.
pub(super) const MAX_GROUPS: usize = 64;
/// Characters of a label, with its NUL.
pub(super) const MAX_LABEL_LENGTH: usize = 256;

/// A message of the debug output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DebugMessage {
    /// `DEBUG_SOURCE_...`.
    pub source: u32,
    /// `DEBUG_TYPE_...`.
    pub kind: u32,
    /// Number of the message within source and type.
    pub id: u32,
    /// `DEBUG_SEVERITY_...`.
    pub severity: u32,
    /// The text, without a NUL at the end.
    pub text: Vec<u8>,
}

/// Calls the client's debug callback: its address, the message, the user parameter.
pub type DebugHook = Arc<dyn Fn(usize, &DebugMessage, usize) + Send + Sync>;

/// An open debug group.
#[derive(Debug)]
struct Group {
    /// The message that opened it.
    message: DebugMessage,
    /// What was wanted outside.
    outside: Volume,
}

/// KHR_debug's log and callback, and the debug variable.
#[derive(Default)]
pub(crate) struct DebugState {
    hook: Option<DebugHook>,
    printer: Option<fn(&str)>,
    /// Address and user parameter.
    callback: (usize, usize),
    log: VecDeque<DebugMessage>,
    wanted: Volume,
    groups: Vec<Group>,
    /// Labels of objects that are not shared.
    labels: Labels,
}

impl std::fmt::Debug for DebugState {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("DebugState")
            .field("callback", &self.callback)
            .field("log", &self.log)
            .field("groups", &self.groups)
            .finish_non_exhaustive()
    }
}

impl DebugState {
    /// Address and user parameter of the callback.
    pub(super) fn callback(&self) -> (usize, usize) {
        self.callback
    }

    /// How many messages are in the log.
    pub(super) fn logged(&self) -> usize {
        self.log.len()
    }

    /// Length of the oldest message with its NUL, 0 without one.
    pub(super) fn next_length(&self) -> usize {
        self.log.front().map_or(0, |message| message.text.len() + 1)
    }

    /// `DEBUG_GROUP_STACK_DEPTH`: the default group counts.
    pub(super) fn depth(&self) -> usize {
        self.groups.len() + 1
    }
}

impl Context {
    /// Says how the client's debug callback is called. Without a hook messages go to the log.
    pub fn set_debug_hook(&mut self, hook: Option<DebugHook>) {
        self.debug.hook = hook;
    }

    /// Gives every error, as one line, to `printer`, whatever the debug output is set to.
    pub fn set_debug_printer(&mut self, printer: Option<fn(&str)>) {
        self.debug.printer = printer;
    }

    /// Tells the printer and the debug output of an error.
    pub(super) fn report_error(&mut self, error: u32, text: &str) {
        if let Some(print) = self.debug.printer {
            print(text);
        }
        if !self.state.debug_output.0 {
            return;
        }
        let length = text.floor_char_boundary(MAX_MESSAGE_LENGTH - 1);
        self.emit(DebugMessage {
            source: gl::DEBUG_SOURCE_API,
            kind: gl::DEBUG_TYPE_ERROR,
            id: error,
            severity: gl::DEBUG_SEVERITY_HIGH,
            text: text.as_bytes()[..length].to_vec(),
        });
    }

    /// Delivers a message.
    fn emit(&mut self, message: DebugMessage) {
        if !self.state.debug_output.0 || !self.debug.wanted.wants(&message) {
            return;
        }
        let (callback, user) = self.debug.callback;
        match &self.debug.hook {
            Some(hook) if callback != 0 => hook.clone()(callback, &message, user),
            _ if self.debug.log.len() < MAX_LOGGED => self.debug.log.push_back(message),
            _ => {}
        }
    }
}
