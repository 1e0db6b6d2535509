//! Labels of objects.

use super::MAX_LABEL_LENGTH;
use crate::{Context, enums as gl};
use std::collections::BTreeMap;
use std::sync::PoisonError;

/// Labels by kind (`BUFFER`, `TEXTURE` ...) and name.
pub(crate) type Labels = BTreeMap<(u32, u32), Vec<u8>>;

const KINDS: [u32; 11] = [
    gl::BUFFER,
    gl::SHADER,
    gl::PROGRAM,
    gl::VERTEX_ARRAY,
    gl::QUERY,
    gl::PROGRAM_PIPELINE,
    gl::SAMPLER,
    gl::TEXTURE,
    gl::RENDERBUFFER,
    gl::FRAMEBUFFER,
    gl::DISPLAY_LIST,
];

/// Container objects and queries belong to one context.
fn shared(kind: u32) -> bool {
    !matches!(kind, gl::VERTEX_ARRAY | gl::QUERY | gl::FRAMEBUFFER)
}

impl Context {
    fn with_labels<T>(&mut self, kind: u32, act: impl FnOnce(&mut Labels) -> T) -> T {
        if shared(kind) {
            act(&mut self.shared.labels.lock().unwrap_or_else(PoisonError::into_inner))
        } else {
            act(&mut self.debug.labels)
        }
    }

    /// Called when an object is deleted: a later one of its name has no label.
    pub(crate) fn forget_label(&mut self, kind: u32, name: u32) {
        self.with_labels(kind, |labels| labels.remove(&(kind, name)));
    }

    /// Whether there is such an object; else records the error.
    fn check_object(&mut self, call: &str, kind: u32, name: u32) -> bool {
        if !self.may_set(call) || !self.check_enum(call, "identifier", kind, &KINDS) {
            return false;
        }
        let exists = self.object_exists(kind, name);
        if !exists {
            self.refuse_value(call, "there is no such object");
        }
        exists
    }

    /// `glObjectLabel`.
    pub fn object_label(&mut self, identifier: u32, name: u32, length: i32, label: usize) {
        let call = "glObjectLabel";
        if !self.check_object(call, identifier, name) {
        } else if label == 0 {
            self.forget_label(identifier, name);
        } else if let Some(text) = self.debug_text(call, label, length, MAX_LABEL_LENGTH) {
            self.with_labels(identifier, |labels| labels.insert((identifier, name), text));
        }
    }

    /// `glGetObjectLabel`.
    pub fn get_object_label(
        &mut self,
        identifier: u32,
        name: u32,
        buf_size: i32,
        length: usize,
        label: usize,
    ) {
        let call = "glGetObjectLabel";
        if self.check_object(call, identifier, name) {
            self.give_label(call, (identifier, name), buf_size, length, label);
        }
    }

    fn give_label(
        &mut self,
        call: &str,
        of: (u32, u32),
        buf_size: i32,
        length: usize,
        label: usize,
    ) {
        let Ok(size) = usize::try_from(buf_size) else {
            return self.refuse_value(call, "the buffer's size is negative");
        };
        let mut text =
            self.with_labels(of.0, |labels| labels.get(&of).cloned().unwrap_or_default());
        if label != 0 {
            text.truncate(size.saturating_sub(1));
        }
        if length != 0 {
            self.give_results(call, length, &[text.len() as i32]);
        }
        if label != 0 && size > 0 {
            text.push(0);
            self.give_results(call, label, &text);
        }
    }

    /// `glObjectPtrLabel`, of a sync object.
    pub fn object_ptr_label(&mut self, ptr: usize, length: i32, label: usize) {
        let (call, of) = ("glObjectPtrLabel", (gl::SYNC_FENCE, ptr as u32));
        if !self.knows_fence(call, ptr) {
        } else if label == 0 {
            self.forget_label(of.0, of.1);
        } else if let Some(text) = self.debug_text(call, label, length, MAX_LABEL_LENGTH) {
            self.with_labels(of.0, |labels| labels.insert(of, text));
        }
    }

    /// `glGetObjectPtrLabel`.
    pub fn get_object_ptr_label(&mut self, ptr: usize, buf_size: i32, length: usize, label: usize) {
        let call = "glGetObjectPtrLabel";
        if self.knows_fence(call, ptr) {
            self.give_label(call, (gl::SYNC_FENCE, ptr as u32), buf_size, length, label);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::{RESULT, context, put, take};

    #[test]
    fn labels_of_queries() {
        let mut c = context();
        c.begin_query(gl::SAMPLES_PASSED, 4);
        c.end_query(gl::SAMPLES_PASSED);
        let at = put(&c, b"visible\0");
        c.object_label(gl::QUERY, 4, -1, at);
        c.get_object_label(gl::QUERY, 4, 4, RESULT, RESULT + 4);
        assert_eq!(take::<u8, 8>(&c), *b"\x03\0\0\0vis\0");
        c.get_object_label(gl::QUERY, 4, 0, RESULT, 0);
        assert_eq!(take::<i32, 1>(&c), [7]);
        c.object_label(gl::QUERY, 4, 0, 0);
        c.get_object_label(gl::QUERY, 4, 4, RESULT, RESULT + 4);
        assert_eq!(take::<i32, 1>(&c), [0]);
        assert_eq!(c.get_error(), gl::NO_ERROR);
    }

    #[test]
    fn labels_go_with_their_objects() {
        let mut c = context();
        let name = put(&c, b"\x03\0\0\0old\0");
        let make = |c: &mut Context| {
            c.bind_texture(gl::TEXTURE_2D, 3);
            c.bind_buffer(gl::ARRAY_BUFFER, 3);
            c.bind_framebuffer_ext(gl::FRAMEBUFFER, 3);
            c.bind_renderbuffer_ext(gl::RENDERBUFFER, 3);
            c.gen_vertex_arrays(3, RESULT);
            c.bind_vertex_array(3);
            c.new_list(3, gl::COMPILE);
            c.end_list();
        };
        make(&mut c);
        let kinds = [
            gl::TEXTURE,
            gl::BUFFER,
            gl::FRAMEBUFFER,
            gl::RENDERBUFFER,
            gl::VERTEX_ARRAY,
            gl::DISPLAY_LIST,
        ];
        for kind in kinds {
            c.object_label(kind, 3, -1, name + 4);
        }
        c.delete_textures(1, name);
        c.delete_buffers(1, name);
        c.delete_framebuffers(1, name);
        c.delete_renderbuffers(1, name);
        c.delete_vertex_arrays(1, name);
        c.delete_lists(3, 1);
        make(&mut c);
        for kind in kinds {
            c.get_object_label(kind, 3, 4, RESULT, 0);
            assert_eq!((take::<i32, 1>(&c), c.get_error()), ([0], gl::NO_ERROR), "{kind:#x}");
        }
    }

    #[test]
    fn errors() {
        let mut c = context();
        c.object_label(gl::QUERY, 4, 0, 0);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        c.object_label(gl::SHADER, 1, 0, 0);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        c.object_label(gl::TEXTURE_2D, 1, 0, 0);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        c.object_ptr_label(0, 0, 0);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        let (fence, at) = (c.fence_sync(gl::SYNC_GPU_COMMANDS_COMPLETE, 0), put(&c, b"gate"));
        c.object_ptr_label(fence, 4, at);
        c.get_object_ptr_label(fence, 4, RESULT, RESULT + 4);
        assert_eq!((take::<u8, 8>(&c), c.get_error()), (*b"\x03\0\0\0gat\0", gl::NO_ERROR));
    }
}
