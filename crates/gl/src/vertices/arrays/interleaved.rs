//! `InterleavedArrays`: all arrays at once, by name of a layout.

use super::POSITION;
use crate::vertices::attribute::{COLOR, EDGE, FOG, INDEX, NORMAL, SECONDARY};
use crate::{Context, enums};

/// Where the parts of an element lie.
struct Layout {
    /// Components of the texture coordinates, which come first; 0 is none.
    tex: i32,
    /// Components, type and offset of the colour.
    color: Option<(i32, u32, usize)>,
    /// Offset of the normal.
    normal: Option<usize>,
    /// Components and offset of the position.
    vertex: (i32, usize),
    /// Size of an element.
    size: i32,
}

/// Bytes of a float, and of four unsigned bytes.
const F: usize = 4;

/// The layouts of the specification's table.
fn layout(format: u32) -> Option<Layout> {
    let floats = |components: i32, offset: usize| Some((components, enums::FLOAT, offset));
    let bytes = |offset: usize| Some((4, enums::UNSIGNED_BYTE, offset));
    let (tex, color, normal, vertex) = match format {
        enums::V2F => (0, None, None, (2, 0)),
        enums::V3F => (0, None, None, (3, 0)),
        enums::C4UB_V2F => (0, bytes(0), None, (2, F)),
        enums::C4UB_V3F => (0, bytes(0), None, (3, F)),
        enums::C3F_V3F => (0, floats(3, 0), None, (3, 3 * F)),
        enums::N3F_V3F => (0, None, Some(0), (3, 3 * F)),
        enums::C4F_N3F_V3F => (0, floats(4, 0), Some(4 * F), (3, 7 * F)),
        enums::T2F_V3F => (2, None, None, (3, 2 * F)),
        enums::T4F_V4F => (4, None, None, (4, 4 * F)),
        enums::T2F_C4UB_V3F => (2, bytes(2 * F), None, (3, 3 * F)),
        enums::T2F_C3F_V3F => (2, floats(3, 2 * F), None, (3, 5 * F)),
        enums::T2F_N3F_V3F => (2, None, Some(2 * F), (3, 5 * F)),
        enums::T2F_C4F_N3F_V3F => (2, floats(4, 2 * F), Some(6 * F), (3, 9 * F)),
        enums::T4F_C4F_N3F_V4F => (4, floats(4, 4 * F), Some(8 * F), (4, 11 * F)),
        _ => return None,
    };
    let size = (vertex.1 + vertex.0 as usize * F) as i32;
    Some(Layout { tex, color, normal, vertex, size })
}

impl Context {
    /// `glInterleavedArrays`.
    pub fn interleaved_arrays(&mut self, format: u32, stride: i32, pointer: usize) {
        const CALL: &str = "glInterleavedArrays";
        if self.refused_inside_begin(CALL) {
            return;
        }

        // Check the format, the stride and the pointer.
        let Some(layout) = layout(format) else {
            self.record_error(enums::INVALID_ENUM, CALL, &format!("{format:#x} is not a format"));
            return;
        };
        if stride < 0 {
            self.record_error(enums::INVALID_VALUE, CALL, &format!("stride {stride} is negative"));
            return;
        }
        if self.client.vertex_array != 0 && self.client.array_buffer.is_none() && pointer != 0 {
            let why = "a vertex array object takes no arrays in client memory";
            self.record_error(enums::INVALID_OPERATION, CALL, why);
            return;
        }

        // Find where each attribute lies.
        let stride = if stride == 0 { layout.size } else { stride };
        let coordinates = self.active_coordinates();
        let tex = (layout.tex > 0).then_some((layout.tex, enums::FLOAT, 0));
        let normal = layout.normal.map(|offset| (3, enums::FLOAT, offset));
        let vertex = Some((layout.vertex.0, enums::FLOAT, layout.vertex.1));
        let parts =
            [(coordinates, tex), (COLOR, layout.color), (NORMAL, normal), (POSITION, vertex)];

        // Enable the attributes of the format and disable the others.
        for (which, part) in
            parts.into_iter().chain([EDGE, INDEX, SECONDARY, FOG].map(|which| (which, None)))
        {
            self.client.array_mut(which).enabled = part.is_some();
            if let Some((size, kind, offset)) = part {
                self.place_array(which, size, kind, stride, pointer.wrapping_add(offset));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::context;
    use super::*;

    #[test]
    fn sizes_are_those_of_the_table() {
        let floats = |format| layout(format).unwrap().size / 4;
        assert_eq!(
            (enums::V2F..=enums::T4F_C4F_N3F_V4F).map(floats).collect::<Vec<_>>(),
            [2, 3, 3, 4, 6, 6, 10, 5, 8, 6, 8, 8, 12, 15]
        );
    }

    #[test]
    fn a_format_sets_and_unsets_arrays() {
        let mut c = context();
        c.enable_client_state(enums::NORMAL_ARRAY);
        c.interleaved_arrays(enums::T2F_C4UB_V3F, 0, 64);
        assert!(c.client.tex[0].enabled && c.client.color.enabled && c.client.vertex.enabled);
        assert!(!c.client.normal.enabled);
        assert_eq!((c.client.color.pointer, c.client.color.kind), (72, enums::UNSIGNED_BYTE));
        assert_eq!((c.client.vertex.pointer, c.client.vertex.stride), (76, 24));
    }
}
