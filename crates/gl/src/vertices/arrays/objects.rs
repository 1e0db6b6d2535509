//! Vertex array objects. The arrays of the bound object are in the client state; all others are kept here.

use crate::state::{ArrayPointer, ClientState, MAX_TEXTURE_UNITS};
use crate::vertices::names::generate;
use crate::{Context, enums};

/// What an object holds.
#[derive(Clone, Debug)]
pub(super) struct VertexArray {
    arrays: [ArrayPointer; 7],
    tex: [ArrayPointer; MAX_TEXTURE_UNITS],
    element_buffer: u32,
}

impl VertexArray {
    fn of(client: &ClientState) -> Self {
        let c = client;
        Self {
            arrays: [c.vertex, c.normal, c.color, c.secondary, c.index, c.edge, c.fog],
            tex: c.tex,
            element_buffer: c.element_buffer,
        }
    }

    fn put(self, client: &mut ClientState) {
        let c = client;
        [c.vertex, c.normal, c.color, c.secondary, c.index, c.edge, c.fog] = self.arrays;
        c.tex = self.tex;
        c.element_buffer = self.element_buffer;
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
            self.arrays.objects.insert(bound, Some(VertexArray::of(&self.client)));
            let kept = self.arrays.objects.get_mut(&array).and_then(Option::take);
            // Bound objects count as existing even though their arrays are elsewhere.
            let fresh = || VertexArray::of(&ClientState::default());
            let object = kept.unwrap_or_else(fresh);
            self.arrays.objects.insert(array, Some(object.clone()));
            object.put(&mut self.client);
            self.client.vertex_array = array;
        }
    }

    /// `glGenVertexArrays`.
    pub fn gen_vertex_arrays(&mut self, n: i32, arrays: usize) {
        self.give_names("glGenVertexArrays", n, arrays, |c, n| generate(&mut c.arrays.objects, n));
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
        assert_eq!((c.client.vertex.enabled, c.client.color.enabled, c.client.element_buffer), (true, false, 0));
        c.bind_vertex_array(1);
        assert_eq!((c.client.color.enabled, c.client.element_buffer), (true, 5));
        c.delete_vertex_arrays(1, BASE);
        assert_eq!((c.client.vertex_array, c.client.vertex.enabled, c.is_vertex_array(1)), (0, true, 0));
        c.bind_vertex_array(7);
        assert_eq!(c.error, enums::INVALID_OPERATION);
    }
}
