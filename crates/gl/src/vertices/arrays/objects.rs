//! Vertex array objects. The arrays of the bound object are in the client state; all others are
//! kept here.

use crate::objects::BufferHandle;
use crate::state::{ArrayPointer, ClientState, MAX_TEXTURE_UNITS};
use crate::{Context, enums};

/// What an object holds.
#[derive(Clone, Debug)]
pub(super) struct VertexArray {
    arrays: [ArrayPointer; 7],
    tex: [ArrayPointer; MAX_TEXTURE_UNITS],
    element_buffer: BufferHandle,
}

impl VertexArray {
    /// A new object's arrays.
    fn new() -> Self {
        let ClientState {
            vertex,
            normal,
            color,
            secondary,
            index,
            edge,
            fog,
            tex,
            element_buffer,
            ..
        } = ClientState::default();
        Self { arrays: [vertex, normal, color, secondary, index, edge, fog], tex, element_buffer }
    }

    /// Changes places with the arrays of the object that is bound.
    fn swap(&mut self, c: &mut ClientState) {
        let bound = [
            &mut c.vertex,
            &mut c.normal,
            &mut c.color,
            &mut c.secondary,
            &mut c.index,
            &mut c.edge,
            &mut c.fog,
        ];
        self.arrays.iter_mut().zip(bound).for_each(|(kept, bound)| std::mem::swap(kept, bound));
        std::mem::swap(&mut self.tex, &mut c.tex);
        std::mem::swap(&mut self.element_buffer, &mut c.element_buffer);
    }
}

impl Context {
    /// `glBindVertexArray`.
    pub fn bind_vertex_array(&mut self, array: u32) {
        if self.refused_inside_begin("glBindVertexArray") {
            return;
        }
        let bound = self.client.vertex_array;
        if array != 0 && !self.arrays.objects.contains_key(&array) {
            let why = format!("{array} was not generated, or is deleted");
            self.record_error(enums::INVALID_OPERATION, "glBindVertexArray", &why);
        } else if array != bound {
            // Bound objects count as existing even though their arrays are elsewhere.
            let kept = self.arrays.objects.insert(array, Some(VertexArray::new())).flatten();
            let mut object = kept.unwrap_or_else(VertexArray::new);
            object.swap(&mut self.client);
            self.arrays.objects.insert(bound, Some(object));
            self.client.vertex_array = array;
        }
    }

    /// `glGenVertexArrays`.
    pub fn gen_vertex_arrays(&mut self, n: i32, arrays: usize) {
        self.give_names("glGenVertexArrays", n, arrays, |c, n| {
            c.shared.names.generate(&mut c.arrays.objects, n)
        });
    }

    /// `glDeleteVertexArrays`.
    pub fn delete_vertex_arrays(&mut self, n: i32, arrays: usize) {
        for name in self.doomed_names("glDeleteVertexArrays", n, arrays) {
            if name != 0 {
                if name == self.client.vertex_array {
                    self.bind_vertex_array(0);
                }
                self.arrays.objects.remove(&name);
                self.forget_label(enums::VERTEX_ARRAY, name);
            }
        }
    }

    /// `glIsVertexArray`.
    pub fn is_vertex_array(&mut self, array: u32) -> u8 {
        if self.refused_inside_begin("glIsVertexArray") {
            return 0;
        }
        u8::from(array != 0 && matches!(self.arrays.objects.get(&array), Some(Some(_))))
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::{BASE, context};
    use super::*;

    #[test]
    fn objects_keep_buffers_that_are_deleted() {
        let mut c = context();
        let line = |c: &mut Context, x: f32| {
            c.memory.write(BASE, bytemuck::cast_slice(&[[x, 0.0f32], [1.0, 0.0]]));
            c.bind_buffer(enums::ARRAY_BUFFER, 3);
            c.buffer_data(enums::ARRAY_BUFFER, 16, BASE, enums::STATIC_DRAW);
        };
        c.gen_vertex_arrays(1, BASE);
        c.bind_vertex_array(1);
        line(&mut c, 5.0);
        c.vertex_pointer(2, enums::FLOAT, 0, 0);
        c.enable_client_state(enums::VERTEX_ARRAY);
        c.memory.write(BASE, &[0, 1]);
        c.bind_buffer(enums::ELEMENT_ARRAY_BUFFER, 4);
        c.buffer_data(enums::ELEMENT_ARRAY_BUFFER, 2, BASE, enums::STATIC_DRAW);
        c.bind_vertex_array(0);
        c.map_buffer(enums::ARRAY_BUFFER, enums::READ_ONLY);
        c.memory.write(BASE, bytemuck::cast_slice(&[3u32, 4]));
        c.delete_buffers(2, BASE);
        assert_eq!((c.is_buffer(3), c.client.array_buffer.name), (0, 0));
        // A new buffer of the name is another one.
        line(&mut c, 7.0);
        c.bind_vertex_array(1);
        c.draw_elements(enums::LINES, 2, enums::UNSIGNED_BYTE, 0);
        assert_eq!((c.error, c.builder.log[0].positions[0][0]), (0, 5.0));
        // Deleted while the object is bound, a buffer leaves it.
        c.vertex_pointer(2, enums::FLOAT, 0, 0);
        c.memory.write(BASE, bytemuck::cast_slice(&[3u32]));
        c.delete_buffers(1, BASE);
        assert!(c.client.vertex.buffer.is_none());
    }

    #[test]
    fn each_object_has_its_arrays() {
        let mut c = context();
        c.enable_client_state(enums::VERTEX_ARRAY);
        c.gen_vertex_arrays(1, BASE);
        assert_eq!(c.is_vertex_array(1), 0);
        c.bind_vertex_array(1);
        assert_eq!((c.is_vertex_array(1), c.client.vertex.enabled), (1, false));
        c.vertex_pointer(3, enums::FLOAT, 0, 16);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_OPERATION);
        c.bind_buffer(enums::ELEMENT_ARRAY_BUFFER, 5);
        c.enable_client_state(enums::COLOR_ARRAY);
        c.bind_vertex_array(0);
        assert_eq!(
            (c.client.vertex.enabled, c.client.color.enabled, c.client.element_buffer.name),
            (true, false, 0)
        );
        c.bind_vertex_array(1);
        assert_eq!((c.client.color.enabled, c.client.element_buffer.name), (true, 5));
        c.delete_vertex_arrays(1, BASE);
        assert_eq!(
            (c.client.vertex_array, c.client.vertex.enabled, c.is_vertex_array(1)),
            (0, true, 0)
        );
        c.bind_vertex_array(7);
        assert_eq!(c.error, enums::INVALID_OPERATION);
    }
}
