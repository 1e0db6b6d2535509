//! Clipping in clip space against the view volume and the user planes, and the way to window
//! coordinates.
//!
//! Polygons are cut plane by plane (Sutherland and Hodgman). An edge that a cut makes counts as a
//! boundary.

use super::{FeedbackVertex, Vertex};
use crate::enums;
use crate::state::State;

/// What clipping and the viewport need to know.
#[derive(Debug)]
pub(super) struct View<'a> {
    pub(super) state: &'a State,
    zero_to_one: bool,
    has_user_planes: bool,
}

/// Planes of the view volume.
const SIDES: usize = 6;

impl<'a> View<'a> {
    pub(super) fn of(state: &'a State) -> Self {
        let has_user_planes = state.clip_plane_enabled.contains(&true);
        Self { state, zero_to_one: state.clip_control.1 == enums::ZERO_TO_ONE, has_user_planes }
    }

    /// Signed distance to a plane: inside is >= 0. `None` if the plane does not clip.
    fn distance(&self, plane: usize, vertex: &Vertex) -> Option<f32> {
        let [x, y, z, w] = vertex.clip;
        let clamped = self.state.depth_clamp;
        Some(match plane {
            0 => w + x,
            1 => w - x,
            2 => w + y,
            3 => w - y,
            4 | 5 if clamped => return None,
            4 if self.zero_to_one => z,
            4 => w + z,
            5 => w - z,
            _ if self.state.clip_plane_enabled[plane - SIDES] => vertex.user[plane - SIDES],
            _ => return None,
        })
    }

    fn planes(&self) -> std::ops::Range<usize> {
        0..if self.has_user_planes { SIDES + self.state.clip_plane_enabled.len() } else { SIDES }
    }

    /// Whether a point is inside.
    pub(super) fn shows(&self, vertex: &Vertex) -> bool {
        self.outside(vertex) == 0
    }

    /// A bit for each plane that a vertex lies outside of.
    pub(super) fn outside(&self, vertex: &Vertex) -> u16 {
        let is_outside =
            |&plane: &usize| self.distance(plane, vertex).is_some_and(|d| d.is_nan() || d < 0.0);
        self.planes().filter(is_outside).fold(0, |bits, plane| bits | 1 << plane)
    }

    /// The part of a line that is inside.
    pub(super) fn clip_line(&self, mut a: Vertex, mut b: Vertex) -> Option<[Vertex; 2]> {
        for plane in self.planes() {
            let (Some(da), Some(db)) = (self.distance(plane, &a), self.distance(plane, &b)) else {
                continue;
            };
            match (da >= 0.0, db >= 0.0) {
                (true, true) => {}
                (true, false) => b = between(&a, &b, da / (da - db)),
                (false, true) => a = between(&b, &a, db / (db - da)),
                (false, false) => return None,
            }
        }
        Some([a, b])
    }

    /// The part of a polygon that is inside; empty if there is none.
    pub(super) fn clip_polygon(&self, mut polygon: Vec<Vertex>) -> Vec<Vertex> {
        // Measure the distances; skip planes that cut nothing.
        for plane in self.planes() {
            let Some(distances) =
                polygon.iter().map(|v| self.distance(plane, v)).collect::<Option<Vec<f32>>>()
            else {
                continue;
            };
            if distances.iter().all(|d| *d >= 0.0) {
                continue;
            }

            // Walk the edges: keep inner corners and add the crossings.
            let mut kept = Vec::with_capacity(polygon.len() + 1);
            for (i, a) in polygon.iter().enumerate() {
                let next = (i + 1) % polygon.len();
                let (b, da, db) = (&polygon[next], distances[i], distances[next]);
                if da >= 0.0 {
                    kept.push(*a);
                    if db < 0.0 {
                        kept.push(Vertex { edge: true, ..between(a, b, da / (da - db)) });
                    }
                } else if db >= 0.0 {
                    kept.push(Vertex { edge: a.edge, ..between(b, a, db / (db - da)) });
                }
            }
            polygon = kept;
            if polygon.len() < 3 {
                return Vec::new();
            }
        }
        polygon
    }

    /// Twice the signed area on the screen; positive goes counterclockwise.
    pub(super) fn area(polygon: &[Vertex]) -> f32 {
        let point = |v: &Vertex| [v.clip[0] / v.clip[3], v.clip[1] / v.clip[3]];
        let (Some(first), mut area) = (polygon.first().map(point), 0.0) else { return 0.0 };
        let mut last = first;
        for next in polygon[1..].iter().map(point).chain([first]) {
            area += last[0] * next[1] - last[1] * next[0];
            last = next;
        }
        area
    }

    /// A vertex's depth in the window.
    pub(super) fn depth(&self, vertex: &Vertex) -> f32 {
        let [_, _, z, w] = vertex.clip;
        let over_w = if w == 0.0 { 0.0 } else { 1.0 / w };
        let depth = if self.zero_to_one { z * over_w } else { 0.5 * z * over_w + 0.5 };
        let range = &self.state.viewport.depth_range;
        let (near, far) = (range.near as f32, range.far as f32);
        let depth = near + depth * (far - near);
        if self.state.depth_clamp { depth.max(near.min(far)).min(near.max(far)) } else { depth }
    }

    /// A vertex in window coordinates.
    pub(super) fn window(&self, vertex: &Vertex, back: bool) -> FeedbackVertex {
        let viewport = &self.state.viewport;
        let [x, y, _, w] = vertex.clip;
        let over_w = if w == 0.0 { 0.0 } else { 1.0 / w };
        let [left, bottom, width, height] = viewport.rect.map(|n| n as f32);
        let up = if self.state.clip_control.0 == enums::UPPER_LEFT { -1.0 } else { 1.0 };
        let (x, y) = (
            left + (x * over_w + 1.0) * 0.5 * width,
            bottom + (up * y * over_w + 1.0) * 0.5 * height,
        );
        let window = [x, y, self.depth(vertex), w];
        FeedbackVertex {
            window,
            color: if back { vertex.back_color } else { vertex.color },
            tex: vertex.tex[0],
        }
    }
}

/// The vertex at `t` on the way from `a` to `b`.
fn between(a: &Vertex, b: &Vertex, t: f32) -> Vertex {
    fn mix<const N: usize>(a: [f32; N], b: [f32; N], t: f32) -> [f32; N] {
        std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
    }
    Vertex {
        clip: mix(a.clip, b.clip, t),
        user: mix(a.user, b.user, t),
        color: mix(a.color, b.color, t),
        secondary: mix(a.secondary, b.secondary, t),
        back_color: mix(a.back_color, b.back_color, t),
        tex: std::array::from_fn(|unit| mix(a.tex[unit], b.tex[unit], t)),
        fog: a.fog + t * (b.fog - a.fog),
        edge: a.edge,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f32, y: f32, edge: bool) -> Vertex {
        Vertex { clip: [x, y, 0.0, 1.0], color: [x; 4], edge, ..Vertex::default() }
    }

    #[test]
    fn lines_are_cut_at_the_sides() {
        let state = State::default();
        let view = View::of(&state);
        let [a, b] = view.clip_line(at(-3.0, 0.0, true), at(1.0, 0.0, true)).unwrap();
        assert_eq!((a.clip[0], a.color[0], b.clip[0]), (-1.0, -1.0, 1.0));
        assert!(view.clip_line(at(2.0, 0.0, true), at(3.0, 0.0, true)).is_none());
        assert!(view.shows(&at(1.0, -1.0, true)) && !view.shows(&at(1.1, 0.0, true)));
    }

    #[test]
    fn a_cut_edge_is_a_boundary() {
        let state = State::default();
        let view = View::of(&state);
        let cut = view.clip_polygon(vec![
            at(0.0, -0.5, false),
            at(2.0, -0.5, false),
            at(0.0, 0.5, false),
        ]);
        let found: Vec<_> = cut.iter().map(|v| (v.clip[0], v.clip[1], v.edge)).collect();
        assert_eq!(
            found,
            [(0.0, -0.5, false), (1.0, -0.5, true), (1.0, 0.0, false), (0.0, 0.5, false)]
        );
        assert_eq!(View::area(&cut), 1.5);
    }

    #[test]
    fn user_planes_cut_too() {
        let mut state = State::default();
        state.clip_plane_enabled[1] = true;
        let mut vertex = at(0.0, 0.0, true);
        vertex.user[1] = -1.0;
        assert!(!View::of(&state).shows(&vertex));
    }
}
