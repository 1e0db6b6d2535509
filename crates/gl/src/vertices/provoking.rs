//! Which corner of an element gives it its colour in flat shading.
//!
//! Everywhere else it is the last one, as OpenGL has it from the beginning. Where a program wants the
//! first one (`ProvokingVertex`), elements are taken apart here, and their corners are named from the
//! second one on: the first comes last. Quads and strips of quads keep to the last corner
//! (`QUADS_FOLLOW_PROVOKING_VERTEX_CONVENTION` is false), and a polygon has the colour of its first
//! corner in any case.
//!
//! Lines run the other way round then, and a stipple begins anew with each of them.
//!
//! In:   a batch. Out: one of single lines and triangles that draws the same.
//! Cost: a copy of the batch each time that it is drawn.

use crate::enums::{LINE_LOOP, LINE_STRIP, LINES, TRIANGLE_FAN, TRIANGLE_STRIP, TRIANGLES};
use crate::primitive::Primitive;
use crate::vertex::VertexBatch;

impl VertexBatch {
    /// The batch with the corner last that comes first of each line and triangle.
    pub(super) fn with_first_corner_last(&self) -> Self {
        let (mut indices, mut primitives) = (Vec::new(), Vec::new());
        for primitive in &self.primitives {
            let first = indices.len() as u32;
            let mode = rename(primitive, &mut indices);
            let count = indices.len() as u32 - first;
            primitives.push(Primitive { mode, first, count });
        }
        let vertex = |place: &u32| self.vertex(*place) as u32;
        let indices = Some(indices.iter().map(vertex).collect());
        Self { indices, primitives, ..self.clone() }
    }
}

/// Adds the places of a primitive's corners, element by element; gives the mode of the elements.
fn rename(primitive: &Primitive, places: &mut Vec<u32>) -> u32 {
    let &Primitive { mode, first, count } = primitive;
    let triangles = 0..count.saturating_sub(2);
    match mode {
        LINES => {
            places.extend((0..count / 2).flat_map(|i| [first + 2 * i + 1, first + 2 * i]));
            LINES
        }
        LINE_STRIP | LINE_LOOP => {
            places.extend((1..count).flat_map(|i| [first + i, first + i - 1]));
            if mode == LINE_LOOP && count > 0 {
                places.extend([first, first + count - 1]);
            }
            LINES
        }
        TRIANGLES => {
            let corners = |i: u32| [1, 2, 0].map(|k| first + 3 * i + k);
            places.extend((0..count / 3).flat_map(corners));
            TRIANGLES
        }
        TRIANGLE_STRIP => {
            // Every second triangle names its corners the other way round.
            let corners = |i: u32| match i % 2 {
                0 => [1, 2, 0].map(|k| first + i + k),
                _ => [2, 1, 0].map(|k| first + i + k),
            };
            places.extend(triangles.flat_map(corners));
            TRIANGLES
        }
        TRIANGLE_FAN => {
            // The first corner of a fan's triangle is the one that follows the middle.
            places.extend(triangles.flat_map(|i| [first + i + 2, first, first + i + 1]));
            TRIANGLES
        }
        // Points, quads, strips of quads and polygons stay.
        _ => {
            places.extend(first..first + count);
            mode
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::enums::{POINTS, POLYGON, QUAD_STRIP, QUADS};

    fn renamed(mode: u32, count: u32) -> (u32, Vec<u32>) {
        let mut places = Vec::new();
        (rename(&Primitive { mode, first: 10, count }, &mut places), places)
    }

    #[test]
    fn the_first_corner_of_each_element_comes_last_and_sides_stay() {
        assert_eq!(renamed(LINES, 4), (LINES, vec![11, 10, 13, 12]));
        assert_eq!(renamed(LINE_STRIP, 3), (LINES, vec![11, 10, 12, 11]));
        assert_eq!(renamed(LINE_LOOP, 3), (LINES, vec![11, 10, 12, 11, 10, 12]));
        assert_eq!(renamed(TRIANGLES, 6), (TRIANGLES, vec![11, 12, 10, 14, 15, 13]));
        assert_eq!(renamed(TRIANGLE_STRIP, 4), (TRIANGLES, vec![11, 12, 10, 13, 12, 11]));
        assert_eq!(renamed(TRIANGLE_FAN, 4), (TRIANGLES, vec![12, 10, 11, 13, 10, 12]));
        for mode in [POINTS, QUADS, QUAD_STRIP, POLYGON] {
            assert_eq!(renamed(mode, 4), (mode, vec![10, 11, 12, 13]));
        }
    }
}
