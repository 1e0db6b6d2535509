//! Debug groups.

use super::{DebugMessage, Group, MAX_GROUPS, MAX_MESSAGE_LENGTH};
use crate::{Context, enums as gl};

impl Context {
    /// `glPushDebugGroup`.
    pub fn push_debug_group(&mut self, source: u32, id: u32, length: i32, message: usize) {
        let call = "glPushDebugGroup";
        let sources = [gl::DEBUG_SOURCE_APPLICATION, gl::DEBUG_SOURCE_THIRD_PARTY];
        if !self.may_set(call) || !self.check_enum(call, "source", source, &sources) {
            return;
        }
        let Some(text) = self.debug_text(call, message, length, MAX_MESSAGE_LENGTH) else { return };
        if self.debug.depth() >= MAX_GROUPS {
            return self.record_error(gl::STACK_OVERFLOW, call, "too many debug groups are open");
        }
        let severity = gl::DEBUG_SEVERITY_NOTIFICATION;
        let message = DebugMessage { source, kind: gl::DEBUG_TYPE_PUSH_GROUP, id, severity, text };
        self.emit(message.clone());
        let outside = self.debug.wanted.clone();
        self.debug.groups.push(Group { message, outside });
    }

    /// `glPopDebugGroup`.
    pub fn pop_debug_group(&mut self) {
        let call = "glPopDebugGroup";
        if !self.may_set(call) {
            return;
        }
        let Some(Group { message, outside }) = self.debug.groups.pop() else {
            return self.record_error(gl::STACK_UNDERFLOW, call, "no debug group is open");
        };
        self.debug.wanted = outside;
        self.emit(DebugMessage { kind: gl::DEBUG_TYPE_POP_GROUP, ..message });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::{context, put};

    #[test]
    fn groups_nest_and_restore_the_control() {
        let mut c = context();
        c.enable(gl::DEBUG_OUTPUT);
        let at = put(&c, b"frame\0");
        c.push_debug_group(gl::DEBUG_SOURCE_APPLICATION, 7, -1, at);
        c.debug_message_control(gl::DONT_CARE, gl::DONT_CARE, gl::DONT_CARE, 0, 0, 0);
        c.pop_debug_group();
        let kinds: Vec<u32> = c.debug.log.iter().map(|message| message.kind).collect();
        assert_eq!(kinds, [gl::DEBUG_TYPE_PUSH_GROUP, gl::DEBUG_TYPE_POP_GROUP]);
        assert_eq!((c.debug.log[1].id, &c.debug.log[1].text[..]), (7, &b"frame"[..]));
        c.pop_debug_group();
        assert_eq!(c.get_error(), gl::STACK_UNDERFLOW);
        for _ in 1..MAX_GROUPS {
            c.push_debug_group(gl::DEBUG_SOURCE_APPLICATION, 7, 5, at);
        }
        assert_eq!(c.get_error(), gl::NO_ERROR);
        c.push_debug_group(gl::DEBUG_SOURCE_APPLICATION, 7, 5, at);
        assert_eq!(c.get_error(), gl::STACK_OVERFLOW);
        c.push_debug_group(gl::DEBUG_SOURCE_API, 7, 5, at);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
    }
}
