//! Which messages the application wants.

use super::DebugMessage;
use crate::enums as gl;
use std::collections::BTreeMap;

pub(super) const SOURCES: [u32; 6] = [
    gl::DEBUG_SOURCE_API,
    gl::DEBUG_SOURCE_WINDOW_SYSTEM,
    gl::DEBUG_SOURCE_SHADER_COMPILER,
    gl::DEBUG_SOURCE_THIRD_PARTY,
    gl::DEBUG_SOURCE_APPLICATION,
    gl::DEBUG_SOURCE_OTHER,
];
pub(super) const KINDS: [u32; 9] = [
    gl::DEBUG_TYPE_ERROR,
    gl::DEBUG_TYPE_DEPRECATED_BEHAVIOR,
    gl::DEBUG_TYPE_UNDEFINED_BEHAVIOR,
    gl::DEBUG_TYPE_PORTABILITY,
    gl::DEBUG_TYPE_PERFORMANCE,
    gl::DEBUG_TYPE_OTHER,
    gl::DEBUG_TYPE_MARKER,
    gl::DEBUG_TYPE_PUSH_GROUP,
    gl::DEBUG_TYPE_POP_GROUP,
];
pub(super) const SEVERITIES: [u32; 4] = [
    gl::DEBUG_SEVERITY_LOW,
    gl::DEBUG_SEVERITY_MEDIUM,
    gl::DEBUG_SEVERITY_HIGH,
    gl::DEBUG_SEVERITY_NOTIFICATION,
];

/// Wanted or not, by severity.
type Wanted = [bool; 4];

/// The volume control of one debug group.
#[derive(Clone, Debug)]
pub(super) struct Volume {
    /// By source and type.
    classes: [[Wanted; 9]; 6],
    /// Messages set apart by number: source, type, number.
    single: BTreeMap<(usize, usize, u32), Wanted>,
}

impl Default for Volume {
    /// Everything but low severity.
    fn default() -> Self {
        Self { classes: [[[false, true, true, true]; 9]; 6], single: BTreeMap::new() }
    }
}

/// The positions in `all` that `token` names; `DONT_CARE` names all.
fn named(token: u32, all: &[u32]) -> impl Fn(usize) -> bool {
    let position = all.iter().position(|t| *t == token);
    move |i| token == gl::DONT_CARE || position == Some(i)
}

fn position(token: u32, all: &[u32]) -> usize {
    all.iter().position(|t| *t == token).unwrap_or(0)
}

impl Volume {
    /// Whether a message passes.
    pub(super) fn wants(&self, message: &DebugMessage) -> bool {
        let (source, kind) = (position(message.source, &SOURCES), position(message.kind, &KINDS));
        let wanted =
            self.single.get(&(source, kind, message.id)).unwrap_or(&self.classes[source][kind]);
        wanted[position(message.severity, &SEVERITIES)]
    }

    /// Sets all messages of a source, type and severity, each perhaps `DONT_CARE`.
    pub(super) fn set_class(&mut self, source: u32, kind: u32, severity: u32, on: bool) {
        let (in_source, in_kind) = (named(source, &SOURCES), named(kind, &KINDS));
        let in_severity = named(severity, &SEVERITIES);
        let set = |wanted: &mut Wanted| {
            wanted
                .iter_mut()
                .enumerate()
                .filter(|(i, _)| in_severity(*i))
                .for_each(|(_, wanted)| *wanted = on);
        };
        for (_, kinds) in self.classes.iter_mut().enumerate().filter(|(i, _)| in_source(*i)) {
            kinds
                .iter_mut()
                .enumerate()
                .filter(|(k, _)| in_kind(*k))
                .for_each(|(_, wanted)| set(wanted));
        }
        for ((s, k, _), wanted) in &mut self.single {
            if in_source(*s) && in_kind(*k) {
                set(wanted);
            }
        }
    }

    /// Sets one message.
    pub(super) fn set_single(&mut self, source: u32, kind: u32, id: u32, on: bool) {
        self.single.insert((position(source, &SOURCES), position(kind, &KINDS), id), [on; 4]);
    }
}
