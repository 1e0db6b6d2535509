//! Messages: control, insertion, callback, log.

use super::super::arguments::{Text, read, read_string};
use super::control::{KINDS, SEVERITIES, SOURCES};
use super::{DebugMessage, MAX_MESSAGE_LENGTH};
use crate::{Context, enums as gl};

impl Context {
    fn check_token(&mut self, call: &str, name: &str, token: u32, all: &[u32], any: bool) -> bool {
        (any && token == gl::DONT_CARE) || self.check_enum(call, name, token, all)
    }

    /// `glDebugMessageControl`.
    pub fn debug_message_control(
        &mut self,
        source: u32,
        type_: u32,
        severity: u32,
        count: i32,
        ids: usize,
        enabled: u8,
    ) {
        let call = "glDebugMessageControl";
        if !self.may_set(call)
            || !self.check_token(call, "source", source, &SOURCES, true)
            || !self.check_token(call, "type", type_, &KINDS, true)
            || !self.check_token(call, "severity", severity, &SEVERITIES, true)
        {
        } else if count < 0 {
            self.refuse_value(call, "the number of messages is negative");
        } else if count == 0 {
            self.debug.wanted.set_class(source, type_, severity, enabled != 0);
        } else if source == gl::DONT_CARE || type_ == gl::DONT_CARE || severity != gl::DONT_CARE {
            self.refuse_operation(call, "numbers need a source and a type, and no severity");
        } else {
            for i in 0..count as usize {
                let id = ids
                    .checked_add(i * 4)
                    .filter(|_| ids != 0)
                    .and_then(|at| read(&*self.memory, at, 1));
                let Some([id]) = id else {
                    return self.refuse_value(call, "the numbers are not in readable memory");
                };
                self.debug.wanted.set_single(source, type_, id, enabled != 0);
            }
        }
    }

    /// The text of a message; records the error if it is too long or cannot be read.
    pub(super) fn debug_text(
        &mut self,
        call: &str,
        address: usize,
        length: i32,
        limit: usize,
    ) -> Option<Vec<u8>> {
        match read_string(&*self.memory, address, length, limit) {
            Text::Bytes(bytes) => return Some(bytes),
            Text::TooLong => self.refuse_value(call, "the text is too long"),
            Text::Unreadable => self.refuse_value(call, "the text is not in readable memory"),
        }
        None
    }

    /// `glDebugMessageInsert`.
    pub fn debug_message_insert(
        &mut self,
        source: u32,
        type_: u32,
        id: u32,
        severity: u32,
        length: i32,
        buf: usize,
    ) {
        let call = "glDebugMessageInsert";
        let sources = [gl::DEBUG_SOURCE_APPLICATION, gl::DEBUG_SOURCE_THIRD_PARTY];
        if self.may_set(call)
            && self.check_token(call, "source", source, &sources, false)
            && self.check_token(call, "type", type_, &KINDS, false)
            && self.check_token(call, "severity", severity, &SEVERITIES, false)
            && let Some(text) = self.debug_text(call, buf, length, MAX_MESSAGE_LENGTH)
        {
            self.emit(DebugMessage { source, kind: type_, id, severity, text });
        }
    }

    /// `glDebugMessageCallback`.
    pub fn debug_message_callback(&mut self, callback: usize, user_param: usize) {
        if self.may_set("glDebugMessageCallback") {
            self.debug.callback = (callback, user_param);
        }
    }

    /// `glGetDebugMessageLog`.
    pub fn get_debug_message_log(
        &mut self,
        count: u32,
        buf_size: i32,
        sources: usize,
        types: usize,
        ids: usize,
        severities: usize,
        lengths: usize,
        message_log: usize,
    ) -> u32 {
        let call = "glGetDebugMessageLog";

        // Refuse calls inside Begin/End and negative sizes.
        if !self.may_set(call) {
            return 0;
        }
        if buf_size < 0 && message_log != 0 {
            self.refuse_value(call, "the buffer's size is negative");
            return 0;
        }

        // Hand out messages until `count` are out or the text exceeds the buffer.
        let mut used = 0;
        let mut done = 0;
        while done < count {
            let Some(message) = self.debug.log.front() else { break };
            let length = message.text.len() + 1;
            if message_log != 0 && used + length > buf_size as usize {
                break;
            }
            let Some(message) = self.debug.log.pop_front() else { break };

            // Write the message's fields, each to its array.
            let fields =
                [message.source, message.kind, message.id, message.severity, length as u32];
            for (array, value) in [sources, types, ids, severities, lengths].into_iter().zip(fields)
            {
                if array != 0
                    && !self.give_results(call, array.saturating_add(done as usize * 4), &[value])
                {
                    return done;
                }
            }

            // Write its text with the final NUL.
            let text = [&message.text[..], &[0]].concat();
            if message_log != 0 && !self.give_results(call, message_log.saturating_add(used), &text)
            {
                return done;
            }
            used += length;
            done += 1;
        }
        done
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::{BASE, RESULT, context, put, take};
    use std::sync::{Arc, Mutex};

    fn insert(c: &mut Context, id: u32, severity: u32, text: &[u8]) {
        let at = put(c, text);
        let (source, kind) = (gl::DEBUG_SOURCE_APPLICATION, gl::DEBUG_TYPE_OTHER);
        c.debug_message_insert(source, kind, id, severity, text.len() as i32, at);
    }

    #[test]
    fn errors_reach_the_log() {
        let mut c = context();
        c.enable(0x1234);
        assert_eq!(c.debug.log.len(), 0);
        c.enable(gl::DEBUG_OUTPUT);
        c.enable(0x1234);
        let text = b"GL_INVALID_ENUM in glEnable: cap 0x1234 is not accepted";
        assert_eq!(c.debug.log[0].text, text);
        let at = |i| RESULT + i * 0x100;
        assert_eq!(c.get_debug_message_log(9, 10, 0, 0, 0, 0, 0, at(5)), 0);
        assert_eq!(c.get_debug_message_log(9, 0x100, at(0), at(1), at(2), at(3), at(4), at(5)), 1);
        let field = |i| read::<u32, 1>(&*c.memory, at(i), 1).unwrap();
        let [source, kind, id, severity, length] = std::array::from_fn(field);
        assert_eq!([source, kind], [[gl::DEBUG_SOURCE_API], [gl::DEBUG_TYPE_ERROR]]);
        assert_eq!([id, severity], [[gl::INVALID_ENUM], [gl::DEBUG_SEVERITY_HIGH]]);
        assert_eq!(length, [text.len() as u32 + 1]);
        assert_eq!(read::<u8, 56>(&*c.memory, at(5), 56).unwrap()[..55], text[..]);
        assert_eq!(c.get_debug_message_log(9, 0, 0, 0, 0, 0, 0, 0), 0);
    }

    #[test]
    fn unwanted_messages_are_dropped() {
        let mut c = context();
        c.enable(gl::DEBUG_OUTPUT);
        insert(&mut c, 1, gl::DEBUG_SEVERITY_LOW, b"low");
        assert_eq!(c.debug.log.len(), 0);
        c.debug_message_control(gl::DONT_CARE, gl::DONT_CARE, gl::DEBUG_SEVERITY_LOW, 0, 0, 1);
        insert(&mut c, 1, gl::DEBUG_SEVERITY_LOW, b"low");
        assert_eq!(c.debug.log.len(), 1);
        put(&c, &[1_u32, 2]);
        let (source, kind) = (gl::DEBUG_SOURCE_APPLICATION, gl::DEBUG_TYPE_OTHER);
        c.debug_message_control(source, kind, gl::DONT_CARE, 2, BASE, 0);
        insert(&mut c, 2, gl::DEBUG_SEVERITY_HIGH, b"high");
        assert_eq!(c.debug.log.len(), 1);
        insert(&mut c, 3, gl::DEBUG_SEVERITY_HIGH, b"high");
        assert_eq!(c.debug.log.len(), 2);
        c.debug_message_control(source, gl::DONT_CARE, gl::DONT_CARE, 1, BASE, 0);
        assert_eq!(c.get_error(), gl::INVALID_OPERATION);
        c.debug_message_control(0, gl::DONT_CARE, gl::DONT_CARE, 0, 0, 0);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
    }

    #[test]
    fn the_callback_is_called_through_the_hook() {
        let mut c = context();
        let seen = Arc::new(Mutex::new(Vec::new()));
        let out = seen.clone();
        c.set_debug_hook(Some(Arc::new(move |callback, message: &DebugMessage, user| {
            out.lock().unwrap().push((callback, message.text.clone(), user));
        })));
        c.enable(gl::DEBUG_OUTPUT);
        c.debug_message_callback(0xABC, 0xDEF);
        insert(&mut c, 1, gl::DEBUG_SEVERITY_HIGH, b"hello");
        assert_eq!(*seen.lock().unwrap(), [(0xABC, b"hello".to_vec(), 0xDEF)]);
        c.get_pointerv(gl::DEBUG_CALLBACK_USER_PARAM, RESULT);
        assert_eq!(take::<u64, 1>(&c), [0xDEF]);
        assert_eq!(c.debug.log.len(), 0);
    }

    #[test]
    fn texts_have_limits() {
        let mut c = context();
        let at = put(&c, &[b'x'; 5000]);
        let (source, kind) = (gl::DEBUG_SOURCE_APPLICATION, gl::DEBUG_TYPE_MARKER);
        for length in [-1, 4096, i32::MAX] {
            c.debug_message_insert(source, kind, 0, gl::DEBUG_SEVERITY_HIGH, length, at);
            assert_eq!(c.get_error(), gl::INVALID_VALUE);
        }
        c.debug_message_insert(gl::DEBUG_SOURCE_API, kind, 0, gl::DEBUG_SEVERITY_HIGH, 1, at);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
    }
}
