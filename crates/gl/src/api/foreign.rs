//! State that other rooms keep, as queries and attribute stacks ask for it.

use crate::{Context, enums as gl};

impl Context {
    /// `RENDER_MODE`.
    pub(crate) fn render_mode_token(&self) -> u32 {
        self.feedback.mode
    }

    /// Address, size and type of the feedback buffer.
    pub(crate) fn feedback_buffer_state(&self) -> (usize, i32, u32) {
        self.feedback
            .buffer
            .map_or((0, 0, gl::_2D), |(address, size, kind)| (address, size as i32, kind))
    }

    /// Address and size of the selection buffer.
    pub(crate) fn selection_buffer_state(&self) -> (usize, i32) {
        self.feedback.selection.map_or((0, 0), |(address, size)| (address, size as i32))
    }

    /// `NAME_STACK_DEPTH`.
    pub(crate) fn name_stack_depth(&self) -> usize {
        self.feedback.names.len()
    }

    /// `LIST_INDEX` and `LIST_MODE` of the list that is being compiled; 0 and 0 for none.
    pub(crate) fn compiling_list(&self) -> (u32, u32) {
        (self.lists.name, self.lists.mode)
    }

    /// `ARRAY_ELEMENT_LOCK_FIRST_EXT`, `ARRAY_ELEMENT_LOCK_COUNT_EXT`.
    pub(crate) fn locked_elements(&self) -> (i32, i32) {
        self.arrays.locked.unwrap_or((0, 0))
    }

    /// Whether there is an object. `kind` is a token of `ObjectLabel` (`BUFFER`, `TEXTURE` ...).
    pub(crate) fn object_exists(&mut self, kind: u32, name: u32) -> bool {
        match kind {
            gl::QUERY => self.queries.is_object(name),
            gl::TEXTURE => self.texture_exists(name),
            gl::BUFFER => self.is_buffer(name) != 0,
            gl::VERTEX_ARRAY => self.is_vertex_array(name) != 0,
            gl::RENDERBUFFER => self.renderbuffer_exists(name),
            gl::FRAMEBUFFER => self.framebuffer_exists(name),
            gl::SAMPLER => self.is_sampler(name) != 0,
            gl::DISPLAY_LIST => self.is_list(name) != 0,
            _ => false,
        }
    }

    /// Binds a vertex array object: its arrays move to `client`, those of the one bound before move
    /// out.
    pub(crate) fn switch_vertex_array(&mut self, name: u32) {
        self.bind_vertex_array(name);
    }
}
