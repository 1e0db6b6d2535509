//! Which pixels a small draw may change, found before it is recorded: no more of the client's
//! picture is loaded.

use crate::Context;
use crate::state::MAX_POINT_SIZE;
use crate::vertex::{CurrentState, VertexBatch};
use vitral_math::Vec4;

/// Vertices up to which it is looked for: a draw of more is likely to cover much.
const MOST_VERTICES: usize = 64;

/// Pixels round the vertices, for rounded positions.
const MARGIN: f32 = 2.0;

impl Context {
    /// Pixels x0, y0, x1, y1, the last two exclusive, outside of which `batch` changes nothing;
    /// `None` if that is not known.
    pub(super) fn drawn_area(&self, batch: &VertexBatch, given: &CurrentState) -> Option<[i32; 4]> {
        let s = &self.state;
        let (origin, _) = s.clip_control;
        let few = batch.positions.len() <= MOST_VERTICES && batch.modelviews.is_empty();
        if !few || origin != crate::enums::LOWER_LEFT {
            return None;
        }

        // Find the box of the vertices in clip space, if all lie ahead.
        let clip_from_model = s.matrices.projection.top() * given.modelview;
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for position in &batch.positions {
            let p = clip_from_model * Vec4::from_array(*position);
            let place = [p.x / p.w, p.y / p.w];
            if !(p.w > 0.0 && place.iter().all(|v| v.is_finite())) {
                return None;
            }
            for k in 0..2 {
                (low[k], high[k]) = (low[k].min(place[k]), high[k].max(place[k]));
            }
        }

        // Widen it by what points and lines reach beyond their vertices.
        let changing = s.points.attenuation != [1.0, 0.0, 0.0];
        let widest = if changing {
            MAX_POINT_SIZE
        } else {
            s.points.size.max(s.points.limits[0]).max(s.lines.width).clamp(1.0, MAX_POINT_SIZE)
        };
        let around = widest + MARGIN;
        let [x, y, width, height] = s.viewport.rect.map(|v| v as f32);
        let pixel = |v: f32, start: f32, size: f32| start + (v + 1.0) / 2.0 * size;
        let whole = |v: f32| v.clamp(-1e6, 1e6) as i32;
        Some([
            whole((pixel(low[0], x, width) - around).floor()),
            whole((pixel(low[1], y, height) - around).floor()),
            whole((pixel(high[0], x, width) + around).ceil()),
            whole((pixel(high[1], y, height) + around).ceil()),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::Arena;
    use crate::objects::Shared;
    use std::sync::Arc;

    #[test]
    fn the_area_of_few_vertices_is_their_box_and_a_margin() {
        let mut c = Context::new(Arc::new(Arena::new(8, 8)), Arc::new(Shared::default()));
        c.viewport(100, 0, 200, 100);
        let batch = |w: f32| VertexBatch {
            positions: vec![[-0.5, 0.0, 0.0, 1.0], [0.5, 0.5, 0.0, w]],
            ..VertexBatch::default()
        };
        let given = CurrentState::current(&c.state);
        assert_eq!(c.drawn_area(&batch(1.0), &given), Some([147, 47, 253, 78]));
        assert_eq!(c.drawn_area(&batch(0.0), &given), None);
        c.state.points.size = 10.0;
        assert_eq!(c.drawn_area(&batch(1.0), &given), Some([138, 38, 262, 87]));
        let many = VertexBatch { positions: vec![[0.0; 4]; 65], ..VertexBatch::default() };
        assert_eq!(c.drawn_area(&many, &given), None);
    }
}
