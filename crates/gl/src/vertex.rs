//! Vertices on their way to the pipeline.
//!
//! A batch is one draw: attributes side by side, and the primitives they form. Primitives keep the
//! mode they were given with, also when a display list merged many of them: unfilled polygons need
//! the original edges, and the flat colour of a `POLYGON` is that of its first vertex. Neighbours
//! of the same independent mode (`POINTS`, `LINES`, `TRIANGLES`, `QUADS`) are one [`Primitive`], so
//! that a list of thousands of quads holds one. Incomplete primitives are cut off: `count` is a
//! multiple of 2, 3 or 4 for `LINES`, `TRIANGLES`, `QUADS`, even for `QUAD_STRIP`, and large enough
//! for at least one element.

pub use crate::primitive::Primitive;
use crate::primitive::{complete, is_independent};
use crate::state::{MAX_TEXTURE_UNITS, MaterialFace, State};
pub use crate::tnl::TriangulationCell;
use vitral_math::Mat4;

/// Whether a batch is drawn at once or comes out of a display list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Submission {
    /// By Begin and End, or from arrays.
    #[default]
    Now,
    /// By a list.
    Listed,
}

/// What vertices are drawn with besides their attributes, where a batch does not say otherwise.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CurrentState {
    /// Model to eye.
    pub modelview: Mat4,
    /// Front, back.
    pub material: [MaterialFace; 2],
}

impl CurrentState {
    /// The current matrix and material.
    pub(crate) fn current(state: &State) -> Self {
        Self { modelview: state.matrices.modelview.top(), material: state.lighting.material }
    }
}

/// Vertices and what they form. An attribute that is `None` has the current value for all vertices,
/// taken when drawn. Every attribute that is there has one entry a vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VertexBatch {
    /// Model-space positions.
    pub positions: Vec<[f32; 4]>,
    /// Normals.
    pub normals: Option<Vec<[f32; 3]>>,
    /// Colours.
    pub colors: Option<Vec<[f32; 4]>>,
    /// Secondary colours.
    pub secondary: Option<Vec<[f32; 3]>>,
    /// Fog coordinates.
    pub fog: Option<Vec<f32>>,
    /// Texture coordinates of each unit.
    pub tex: [Option<Vec<[f32; 4]>>; MAX_TEXTURE_UNITS],
    /// Edge flags.
    pub edges: Option<Vec<bool>>,
    /// Materials (front, back) set between vertices: they hold from the given vertex on. If there
    /// are any, the first holds from vertex 0; without any the current material holds.
    pub materials: Vec<(u32, [MaterialFace; 2])>,
    /// Modelview matrices set between primitives, in the same way.
    pub modelviews: Vec<(u32, Mat4)>,
    /// Indices into the attributes; without them vertices are taken in order.
    pub indices: Option<Vec<u32>>,
    /// The primitives, in the order in which they are drawn.
    pub primitives: Vec<Primitive>,
    /// The triangles of filled polygons, made when they are first drawn.
    pub triangulation: TriangulationCell,
}

impl VertexBatch {
    /// The materials at a vertex, if they were set between vertices. `near` is a guess at their
    /// number, and then is that.
    pub(crate) fn material(&self, vertex: u32, near: &mut usize) -> Option<&[MaterialFace; 2]> {
        let all = &self.materials;
        let from = |i: usize| all.get(i).map_or(u32::MAX, |(from, _)| *from);
        let holds = |i: usize| from(i) <= vertex && vertex < from(i + 1);
        if !holds(*near) {
            *near += 1;
        }
        if !holds(*near) {
            *near = all.partition_point(|(from, _)| *from <= vertex).checked_sub(1)?;
        }
        Some(&all[*near].1)
    }

    /// The modelview matrix at a vertex, if it was set between primitives, and how many vertices
    /// from there on have it.
    pub(crate) fn modelview(&self, vertex: u32) -> Option<(&Mat4, u32)> {
        let next = self.modelviews.partition_point(|(from, _)| *from <= vertex);
        let end = self.modelviews.get(next).map_or(u32::MAX, |(from, _)| *from);
        Some((&self.modelviews.get(next.checked_sub(1)?)?.1, end - vertex))
    }

    /// Whether its primitives have so few indices (or vertices) that preparing it for being drawn
    /// again costs more than drawing it.
    pub(crate) fn is_small(&self) -> bool {
        const SMALL: usize = 48;
        // Each has some, so that many need not be counted.
        self.primitives.len() <= SMALL
            && self.primitives.iter().map(|p| p.count as usize).sum::<usize>() <= SMALL
    }

    /// The vertex that the `i`-th index names (the `i`-th vertex, without indices).
    pub fn vertex(&self, i: u32) -> usize {
        self.indices.as_ref().map_or(i, |indices| indices[i as usize]) as usize
    }

    /// Adds a primitive without its incomplete last element; joins it with the one before if that
    /// is the same drawing.
    pub fn add_primitive(&mut self, mode: u32, first: u32, count: u32) {
        let count = complete(mode, count);
        if count == 0 {
            return;
        }
        if let Some(last) = self.primitives.last_mut()
            && last.mode == mode
            && is_independent(mode)
            && last.first + last.count == first
        {
            last.count += count;
            return;
        }
        self.primitives.push(Primitive { mode, first, count });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::enums;

    #[test]
    fn neighbours_of_independent_modes_join() {
        let mut batch = VertexBatch::default();
        batch.add_primitive(enums::QUADS, 0, 4);
        batch.add_primitive(enums::QUADS, 4, 9);
        batch.add_primitive(enums::QUADS, 13, 4);
        batch.add_primitive(enums::TRIANGLE_STRIP, 17, 3);
        batch.add_primitive(enums::TRIANGLE_STRIP, 20, 3);
        let spans: Vec<_> = batch.primitives.iter().map(|p| (p.first, p.count)).collect();
        assert_eq!(spans, [(0, 12), (13, 4), (17, 3), (20, 3)]);
    }
}
