//! Clipping in clip space against the view volume and the user planes, and the way to window coordinates.
//!
//! Polygons are cut plane by plane (Sutherland and Hodgman). An edge that a cut makes counts as a boundary.

use super::FeedbackVertex;
use crate::enums;
use crate::state::State;
use crate::tnl::ProcessedVertex;

/// What clipping and the viewport need to know.
#[derive(Debug)]
pub(super) struct View<'a> {
    pub(super) state: &'a State,
    zero_to_one: bool,
}

/// Planes of the view volume.
const SIDES: usize = 6;

impl<'a> View<'a> {
    pub(super) fn of(state: &'a State) -> Self {
        Self { state, zero_to_one: state.clip_control.1 == enums::ZERO_TO_ONE }
    }

    /// Signed distance to a plane: inside is >= 0. `None` if the plane does not clip.
    fn distance(&self, plane: usize, vertex: &ProcessedVertex) -> Option<f32> {
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
        0..SIDES + self.state.clip_plane_enabled.len()
    }

    /// Whether a point is inside.
    pub(super) fn shows(&self, vertex: &ProcessedVertex) -> bool {
        self.planes().all(|plane| self.distance(plane, vertex).is_none_or(|d| d >= 0.0))
    }

    /// The part of a line that is inside.
    pub(super) fn clip_line(&self, mut a: ProcessedVertex, mut b: ProcessedVertex) -> Option<[ProcessedVertex; 2]> {
        for plane in self.planes() {
            let (Some(da), Some(db)) = (self.distance(plane, &a), self.distance(plane, &b)) else { continue };
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
    pub(super) fn clip_polygon(&self, mut polygon: Vec<ProcessedVertex>) -> Vec<ProcessedVertex> {
        for plane in self.planes() {
            let Some(distances) = polygon.iter().map(|v| self.distance(plane, v)).collect::<Option<Vec<f32>>>() else {
                continue;
            };
            if distances.iter().all(|d| *d >= 0.0) {
                continue;
            }
            let mut kept = Vec::with_capacity(polygon.len() + 1);
            for (i, a) in polygon.iter().enumerate() {
                let next = (i + 1) % polygon.len();
                let (b, da, db) = (&polygon[next], distances[i], distances[next]);
                if da >= 0.0 {
                    kept.push(*a);
                    if db < 0.0 {
                        kept.push(ProcessedVertex { edge: true, ..between(a, b, da / (da - db)) });
                    }
                } else if db >= 0.0 {
                    kept.push(ProcessedVertex { edge: a.edge, ..between(b, a, db / (db - da)) });
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
    pub(super) fn area(polygon: &[ProcessedVertex]) -> f32 {
        let points: Vec<[f32; 2]> = polygon.iter().map(|v| [v.clip[0] / v.clip[3], v.clip[1] / v.clip[3]]).collect();
        let next = points.iter().cycle().skip(1);
        points.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
    }

    /// A vertex in window coordinates.
    pub(super) fn window(&self, vertex: &ProcessedVertex, back: bool) -> FeedbackVertex {
        let viewport = &self.state.viewport;
        let [x, y, z, w] = vertex.clip;
        let over_w = if w == 0.0 { 0.0 } else { 1.0 / w };
        let [left, bottom, width, height] = viewport.rect.map(|n| n as f32);
        let (near, far) = (viewport.depth_range.near as f32, viewport.depth_range.far as f32);
        let up = if self.state.clip_control.0 == enums::UPPER_LEFT { -1.0 } else { 1.0 };
        let depth = if self.zero_to_one { z * over_w } else { 0.5 * z * over_w + 0.5 };
        let mut depth = near + depth * (far - near);
        if self.state.depth_clamp {
            depth = depth.max(near.min(far)).min(near.max(far));
        }
        let window =
            [left + (x * over_w + 1.0) * 0.5 * width, bottom + (up * y * over_w + 1.0) * 0.5 * height, depth, w];
        FeedbackVertex { window, color: if back { vertex.back_color } else { vertex.color }, tex: vertex.tex[0] }
    }
}

/// The vertex at `t` on the way from `a` to `b`.
fn between(a: &ProcessedVertex, b: &ProcessedVertex, t: f32) -> ProcessedVertex {
    fn mix<const N: usize>(a: [f32; N], b: [f32; N], t: f32) -> [f32; N] {
        std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
    }
    ProcessedVertex {
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

    fn at(x: f32, y: f32, edge: bool) -> ProcessedVertex {
        ProcessedVertex { clip: [x, y, 0.0, 1.0], color: [x; 4], edge, ..ProcessedVertex::default() }
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
        let cut = view.clip_polygon(vec![at(0.0, -0.5, false), at(2.0, -0.5, false), at(0.0, 0.5, false)]);
        let found: Vec<_> = cut.iter().map(|v| (v.clip[0], v.clip[1], v.edge)).collect();
        assert_eq!(found, [(0.0, -0.5, false), (1.0, -0.5, true), (1.0, 0.0, false), (0.0, 0.5, false)]);
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
