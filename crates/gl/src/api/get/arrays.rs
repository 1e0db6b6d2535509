//! Values: vertex arrays, buffer bindings, lists, feedback; and GetPointerv.

use super::Value;
use crate::state::ArrayPointer;
use crate::{Context, enums as gl};

impl Context {
    fn texture_array(&self) -> &ArrayPointer {
        &self.client.tex[self.client.active_unit]
    }

    pub(super) fn get_arrays(&mut self, pname: u32) -> Option<Value> {
        let client = &self.client;
        let texture = self.texture_array();
        Some(match pname {
            gl::VERTEX_ARRAY_SIZE => Value::integer(client.vertex.size),
            gl::VERTEX_ARRAY_TYPE => Value::token(client.vertex.kind),
            gl::VERTEX_ARRAY_STRIDE => Value::integer(client.vertex.stride),
            gl::NORMAL_ARRAY_TYPE => Value::token(client.normal.kind),
            gl::NORMAL_ARRAY_STRIDE => Value::integer(client.normal.stride),
            gl::COLOR_ARRAY_SIZE => Value::integer(client.color.size),
            gl::COLOR_ARRAY_TYPE => Value::token(client.color.kind),
            gl::COLOR_ARRAY_STRIDE => Value::integer(client.color.stride),
            gl::SECONDARY_COLOR_ARRAY_SIZE => Value::integer(client.secondary.size),
            gl::SECONDARY_COLOR_ARRAY_TYPE => Value::token(client.secondary.kind),
            gl::SECONDARY_COLOR_ARRAY_STRIDE => Value::integer(client.secondary.stride),
            gl::INDEX_ARRAY_TYPE => Value::token(client.index.kind),
            gl::INDEX_ARRAY_STRIDE => Value::integer(client.index.stride),
            gl::EDGE_FLAG_ARRAY_STRIDE => Value::integer(client.edge.stride),
            gl::FOG_COORD_ARRAY_TYPE => Value::token(client.fog.kind),
            gl::FOG_COORD_ARRAY_STRIDE => Value::integer(client.fog.stride),
            gl::TEXTURE_COORD_ARRAY_SIZE => Value::integer(texture.size),
            gl::TEXTURE_COORD_ARRAY_TYPE => Value::token(texture.kind),
            gl::TEXTURE_COORD_ARRAY_STRIDE => Value::integer(texture.stride),
            gl::VERTEX_ARRAY_COUNT_EXT => Value::integer(client.vertex.count),
            gl::NORMAL_ARRAY_COUNT_EXT => Value::integer(client.normal.count),
            gl::COLOR_ARRAY_COUNT_EXT => Value::integer(client.color.count),
            gl::INDEX_ARRAY_COUNT_EXT => Value::integer(client.index.count),
            gl::TEXTURE_COORD_ARRAY_COUNT_EXT => Value::integer(texture.count),
            gl::EDGE_FLAG_ARRAY_COUNT_EXT => Value::integer(client.edge.count),
            gl::PRIMITIVE_RESTART_INDEX_NV => Value::token(client.restart.1),
            gl::CLIENT_ACTIVE_TEXTURE => Value::token(gl::TEXTURE0 + client.active_unit as u32),
            gl::ARRAY_ELEMENT_LOCK_FIRST_EXT => Value::integer(self.locked_elements().0),
            gl::ARRAY_ELEMENT_LOCK_COUNT_EXT => Value::integer(self.locked_elements().1),
            _ => return None,
        })
    }

    pub(super) fn get_array_buffers(&mut self, pname: u32) -> Option<Value> {
        let client = &self.client;
        let buffer = match pname {
            gl::VERTEX_ARRAY_BINDING => return Some(Value::token(client.vertex_array)),
            gl::ARRAY_BUFFER_BINDING => &client.array_buffer,
            gl::ELEMENT_ARRAY_BUFFER_BINDING => &client.element_buffer,
            gl::COPY_READ_BUFFER => &client.copy_buffers[0],
            gl::COPY_WRITE_BUFFER => &client.copy_buffers[1],
            gl::PIXEL_PACK_BUFFER_BINDING => &client.pack.buffer,
            gl::PIXEL_UNPACK_BUFFER_BINDING => &client.unpack.buffer,
            gl::VERTEX_ARRAY_BUFFER_BINDING => &client.vertex.buffer,
            gl::NORMAL_ARRAY_BUFFER_BINDING => &client.normal.buffer,
            gl::COLOR_ARRAY_BUFFER_BINDING => &client.color.buffer,
            gl::SECONDARY_COLOR_ARRAY_BUFFER_BINDING => &client.secondary.buffer,
            gl::INDEX_ARRAY_BUFFER_BINDING => &client.index.buffer,
            gl::EDGE_FLAG_ARRAY_BUFFER_BINDING => &client.edge.buffer,
            gl::FOG_COORD_ARRAY_BUFFER_BINDING => &client.fog.buffer,
            gl::TEXTURE_COORD_ARRAY_BUFFER_BINDING => &self.texture_array().buffer,
            _ => return None,
        };
        Some(Value::token(buffer.name))
    }

    pub(super) fn get_lists(&mut self, pname: u32) -> Option<Value> {
        Some(match pname {
            gl::LIST_BASE => Value::token(self.state.list_base),
            gl::LIST_INDEX => Value::token(self.compiling_list().0),
            gl::LIST_MODE => Value::token(self.compiling_list().1),
            gl::RENDER_MODE => Value::token(self.render_mode_token()),
            gl::FEEDBACK_BUFFER_SIZE => Value::integer(self.feedback_buffer_state().1),
            gl::FEEDBACK_BUFFER_TYPE => Value::token(self.feedback_buffer_state().2),
            gl::SELECTION_BUFFER_SIZE => Value::integer(self.selection_buffer_state().1),
            gl::NAME_STACK_DEPTH => Value::size(self.name_stack_depth()),
            gl::ATTRIB_STACK_DEPTH => Value::size(self.stacks.server_depth()),
            gl::CLIENT_ATTRIB_STACK_DEPTH => Value::size(self.stacks.client_depth()),
            _ => return None,
        })
    }

    /// `glGetPointerv`.
    pub fn get_pointerv(&mut self, pname: u32, params: usize) {
        let call = "glGetPointerv";
        if !self.may_set(call) {
            return;
        }
        let pointer = match pname {
            gl::VERTEX_ARRAY_POINTER => self.client.vertex.pointer,
            gl::NORMAL_ARRAY_POINTER => self.client.normal.pointer,
            gl::COLOR_ARRAY_POINTER => self.client.color.pointer,
            gl::SECONDARY_COLOR_ARRAY_POINTER => self.client.secondary.pointer,
            gl::INDEX_ARRAY_POINTER => self.client.index.pointer,
            gl::EDGE_FLAG_ARRAY_POINTER => self.client.edge.pointer,
            gl::FOG_COORD_ARRAY_POINTER => self.client.fog.pointer,
            gl::TEXTURE_COORD_ARRAY_POINTER => self.texture_array().pointer,
            gl::FEEDBACK_BUFFER_POINTER => self.feedback_buffer_state().0,
            gl::SELECTION_BUFFER_POINTER => self.selection_buffer_state().0,
            gl::DEBUG_CALLBACK_FUNCTION => self.debug.callback().0,
            gl::DEBUG_CALLBACK_USER_PARAM => self.debug.callback().1,
            _ => return self.refuse_enum(call, "pname", pname),
        };
        self.give_results(call, params, &[pointer]);
    }
}
