//! Primitives of a batch, one by one: assembled, clipped, culled, and told as their polygon mode
//! says.

use super::clip::View;
use super::{Feedback, FeedbackVertex, Vertex, is_culled};
use crate::enums;
use crate::primitive::Primitive;
use crate::vertex::VertexBatch;

/// Tells all primitives of a batch.
pub(super) fn feed(batch: &VertexBatch, processed: &[Vertex], view: &View, to: &mut Feedback) {
    let polygons = &view.state.polygons;
    let only_depths =
        to.mode == enums::SELECT && !polygons.cull && polygons.mode == [enums::FILL; 2];
    let outside = processed.iter().map(|vertex| view.outside(vertex)).collect();
    let mut feeder = Feeder {
        batch,
        processed,
        outside,
        only_depths,
        view,
        to,
        corners: Vec::new(),
        told: Vec::new(),
    };
    for primitive in &batch.primitives {
        feeder.primitive(*primitive);
    }
}

struct Feeder<'a> {
    batch: &'a VertexBatch,
    processed: &'a [Vertex],
    /// Of all vertices, [`View::outside`].
    outside: Vec<u16>,
    /// Of polygons that lie inside, depths are all that counts.
    only_depths: bool,
    view: &'a View<'a>,
    to: &'a mut Feedback,
    /// Memory for a polygon's corners, and for the values reported of them.
    corners: Vec<Vertex>,
    told: Vec<FeedbackVertex>,
}

impl Feeder<'_> {
    fn primitive(&mut self, primitive: Primitive) {
        let Primitive { mode, first, count } = primitive;
        let end = first + count;
        match mode {
            enums::POINTS => (first..end).for_each(|i| self.point(i)),
            enums::LINES => (first..end).step_by(2).for_each(|i| self.line(i, i + 1, true)),
            enums::LINE_STRIP => (first + 1..end).for_each(|i| self.line(i - 1, i, i == first + 1)),
            enums::LINE_LOOP => {
                (first + 1..end).for_each(|i| self.line(i - 1, i, i == first + 1));
                self.line(end - 1, first, false);
            }
            enums::TRIANGLES => {
                (first..end).step_by(3).for_each(|i| self.polygon(&[i, i + 1, i + 2], i + 2, true))
            }
            enums::TRIANGLE_STRIP => {
                for i in first + 2..end {
                    let odd = (i - first) % 2 == 1;
                    let corners = if odd { [i - 1, i - 2, i] } else { [i - 2, i - 1, i] };
                    self.polygon(&corners, i, false);
                }
            }
            enums::TRIANGLE_FAN => {
                (first + 2..end).for_each(|i| self.polygon(&[first, i - 1, i], i, false))
            }
            enums::QUADS => {
                (first..end)
                    .step_by(4)
                    .for_each(|i| self.polygon(&[i, i + 1, i + 2, i + 3], i + 3, true));
            }
            enums::QUAD_STRIP => {
                (first..end - 2)
                    .step_by(2)
                    .for_each(|i| self.polygon(&[i, i + 1, i + 3, i + 2], i + 3, false));
            }
            _ => {
                let corners: Vec<u32> = (first..end).collect();
                self.polygon(&corners, first, true);
            }
        }
    }

    fn vertex(&self, i: u32) -> Vertex {
        self.processed[self.batch.vertex(i)]
    }

    /// A vertex with the colours of `provoking`, if shading is flat.
    fn shaded(&self, i: u32, provoking: u32) -> Vertex {
        let vertex = self.vertex(i);
        if self.view.state.lighting.shade_model != enums::FLAT {
            return vertex;
        }
        let Vertex { color, back_color, secondary, .. } = self.vertex(provoking);
        Vertex { color, back_color, secondary, ..vertex }
    }

    fn point(&mut self, i: u32) {
        let vertex = self.vertex(i);
        if self.view.shows(&vertex) {
            self.to.primitive(enums::POINT_TOKEN, None, &[self.view.window(&vertex, false)]);
        }
    }

    /// A line; `reset` where the stipple begins anew.
    fn line(&mut self, from: u32, to: u32, reset: bool) {
        let (a, b) = (self.shaded(from, to), self.shaded(to, to));
        if let Some(ends) = self.view.clip_line(a, b) {
            self.segment(&ends, false, reset);
        }
    }

    fn segment(&mut self, ends: &[Vertex; 2], back: bool, reset: bool) {
        let token = if reset { enums::LINE_RESET_TOKEN } else { enums::LINE_TOKEN };
        self.to.primitive(token, None, &ends.map(|end| self.view.window(&end, back)));
    }

    /// A polygon; `own_edges` if the vertices' edge flags count (else all edges are boundaries).
    fn polygon(&mut self, corners: &[u32], provoking: u32, own_edges: bool) {
        // Reject polygons outside, and take a shortcut for those inside whose depth alone counts.
        let bits = |i: &u32| self.outside[self.batch.vertex(*i)];
        let (any, all) = corners
            .iter()
            .map(bits)
            .fold((0, u16::MAX), |(any, all), bits| (any | bits, all & bits));
        if all != 0 {
            return;
        }
        if any == 0 && self.only_depths {
            for corner in corners {
                let vertex = &self.processed[self.batch.vertex(*corner)];
                self.to.hit(self.view.depth(vertex));
            }
            return;
        }

        // Clip the polygon.
        let mut polygon = std::mem::take(&mut self.corners);
        polygon.clear();
        polygon.extend(corners.iter().map(|&i| {
            let vertex = self.shaded(i, provoking);
            Vertex { edge: vertex.edge || !own_edges, ..vertex }
        }));
        if any != 0 {
            polygon = self.view.clip_polygon(polygon);
        }

        // Report the clipped polygon.
        if !polygon.is_empty() {
            self.visible(&polygon);
        }
        self.corners = polygon;
    }

    /// What of a polygon is inside.
    fn visible(&mut self, polygon: &[Vertex]) {
        let state = self.view.state;

        // Cull by the sign of the area.
        let area = View::area(polygon);
        let front = if state.polygons.front_face == enums::CW { area < 0.0 } else { area > 0.0 };
        if is_culled(state, front) {
            return;
        }

        // Report the polygon by its mode.
        let back = !front && state.lighting.enabled && state.lighting.model.two_side;
        match state.polygons.mode[usize::from(!front)] {
            enums::POINT => {
                for vertex in polygon.iter().filter(|vertex| vertex.edge) {
                    self.to.primitive(enums::POINT_TOKEN, None, &[self.view.window(vertex, back)]);
                }
            }
            enums::LINE => {
                let mut reset = true;
                for (i, vertex) in polygon.iter().enumerate().filter(|(_, vertex)| vertex.edge) {
                    self.segment(&[*vertex, polygon[(i + 1) % polygon.len()]], back, reset);
                    reset = false;
                }
            }
            _ => {
                self.told.clear();
                self.told.extend(polygon.iter().map(|vertex| self.view.window(vertex, back)));
                self.to.primitive(enums::POLYGON_TOKEN, Some(polygon.len()), &self.told);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::State;

    fn fed(state: &State, mode: u32, corners: &[[f32; 2]]) -> Vec<f32> {
        let mut batch =
            VertexBatch { positions: vec![[0.0; 4]; corners.len()], ..VertexBatch::default() };
        batch.add_primitive(mode, 0, corners.len() as u32);
        let vertex = |(i, [x, y]): (usize, &[f32; 2])| Vertex {
            clip: [*x, *y, 0.0, 1.0],
            color: [i as f32; 4],
            edge: true,
            ..Vertex::default()
        };
        let processed: Vec<_> = corners.iter().enumerate().map(vertex).collect();
        let mut to = Feedback {
            mode: enums::FEEDBACK,
            buffer: Some((0, 100, enums::_2D)),
            ..Feedback::default()
        };
        feed(&batch, &processed, &View::of(state), &mut to);
        to.values
    }

    fn state() -> State {
        let mut state = State::default();
        state.viewport.rect = [0, 0, 2, 2];
        state
    }

    const SQUARE: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

    #[test]
    fn polygons_lines_and_points() {
        let mut state = state();
        let polygon = enums::POLYGON_TOKEN as f32;
        assert_eq!(
            fed(&state, enums::QUADS, &SQUARE),
            [polygon, 4.0, 1.0, 1.0, 2.0, 1.0, 2.0, 2.0, 1.0, 2.0]
        );
        state.polygons.mode[0] = enums::LINE;
        let lines = fed(&state, enums::QUADS, &SQUARE);
        assert_eq!(lines.len(), 20);
        assert_eq!(
            (lines[0], lines[5]),
            (enums::LINE_RESET_TOKEN as f32, enums::LINE_TOKEN as f32)
        );
        assert_eq!(lines[15..], [enums::LINE_TOKEN as f32, 1.0, 2.0, 1.0, 1.0]);
        state.polygons.mode[0] = enums::POINT;
        assert_eq!(fed(&state, enums::QUADS, &SQUARE).len(), 12);
    }

    #[test]
    fn culled_and_clipped_polygons_are_not_told() {
        let mut state = state();
        state.polygons.cull = true;
        assert_eq!(fed(&state, enums::POLYGON, &SQUARE).len(), 10);
        state.polygons.front_face = enums::CW;
        assert!(fed(&state, enums::POLYGON, &SQUARE).is_empty());
        assert!(fed(&state, enums::TRIANGLES, &[[2.0, 0.0], [3.0, 0.0], [2.0, 1.0]]).is_empty());
    }

    #[test]
    fn strips_keep_their_orientation() {
        let mut state = state();
        state.polygons.cull = true;
        let strip = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        assert_eq!(fed(&state, enums::TRIANGLE_STRIP, &strip).len(), 2 * 8);
        let quads = [[0.0, 1.0], [0.0, 0.0], [0.5, 1.0], [0.5, 0.0], [1.0, 1.0], [1.0, 0.0]];
        assert_eq!(fed(&state, enums::QUAD_STRIP, &quads).len(), 2 * 10);
        assert_eq!(fed(&state, enums::LINE_LOOP, &SQUARE).len(), 4 * 5);
    }
}
