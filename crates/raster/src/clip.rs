//! Polygon clipping in clip space, before the division by `w`.
//!
//! The polygon walks past the planes one after the other, like a workpiece past saws; each keeps
//! the vertices on its inner side and adds a vertex where an edge crosses it. A vertex behind the
//! eye (`w <= 0`) needs no special case: it is outside the near plane.
//!
//! In:   a convex polygon in clip space.
//! Out:  its part with `0 <= z <= w` and `|x| <= g.x w`, `|y| <= g.y w`, in the same order; fewer
//!       than three vertices mean nothing is left.
//! Cost: `O(planes * vertices)`.
//! Source: [Sutherland & Hodgman 1974], homogeneous after [Blinn & Newell 1978]. Departs from it:
//!       the side planes are a guard band `g` wider than the view, so that few triangles are cut;
//!       samples outside the view are simply not visited.

use vitral_math::{Vec2, Vec4};

/// Most corners that a triangle can have after six planes.
pub const MAX_CORNERS: usize = 9;

/// A convex polygon with at most [`MAX_CORNERS`] corners.
#[derive(Clone, Copy, Debug)]
pub struct Polygon {
    corners: [Vec4; MAX_CORNERS + 1],
    len: usize,
}

impl Polygon {
    /// From three corners, clip space.
    pub fn triangle(corners: [Vec4; 3]) -> Self {
        let mut polygon = Self { corners: [Vec4::ZERO; MAX_CORNERS + 1], len: 3 };
        polygon.corners[..3].copy_from_slice(&corners);
        polygon
    }

    /// Its corners in order.
    pub fn corners(&self) -> &[Vec4] {
        &self.corners[..self.len]
    }

    fn push(&mut self, corner: Vec4) {
        if self.len < self.corners.len() {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    /// Keeps the part where `distance` is not negative.
    fn cut(&self, distance: impl Fn(Vec4) -> f32) -> Self {
        let mut result = Self { corners: [Vec4::ZERO; MAX_CORNERS + 1], len: 0 };
        for i in 0..self.len {
            let (from, to) = (self.corners[i], self.corners[(i + 1) % self.len]);
            let (d_from, d_to) = (distance(from), distance(to));
            if d_from >= 0.0 {
                result.push(from);
            }
            if (d_from >= 0.0) != (d_to >= 0.0) {
                // Always from the inner to the outer vertex: two polygons that share the edge get
                // the same point.
                let (inner, outer, d_inner, d_outer) =
                    if d_from >= 0.0 { (from, to, d_from, d_to) } else { (to, from, d_to, d_from) };
                result.push(inner + (outer - inner) * (d_inner / (d_inner - d_outer)));
            }
        }
        result
    }
}

/// The planes that cut, in their order: near, far, and the sides of the guard band.
pub const PLANES: [&str; 6] = ["near", "far", "right", "left", "top", "bottom"];

/// Clips against near, far and the guard band `guard` (how many times wider than the view, per
/// axis).
pub fn clip(polygon: Polygon, guard: Vec2) -> Polygon {
    clip_watched(polygon, guard, |_, _, _| ())
}

/// [`clip`], which tells `cut` each time that a plane cuts: its index in [`PLANES`], the polygon
/// before and after.
pub fn clip_watched(
    polygon: Polygon,
    guard: Vec2,
    mut cut: impl FnMut(usize, &Polygon, &Polygon),
) -> Polygon {
    let planes: [&dyn Fn(Vec4) -> f32; 6] = [
        &|p| p.w - p.z,
        &|p| p.z,
        &|p| guard.x * p.w - p.x,
        &|p| guard.x * p.w + p.x,
        &|p| guard.y * p.w - p.y,
        &|p| guard.y * p.w + p.y,
    ];
    let mut polygon = polygon;
    for (number, plane) in planes.into_iter().enumerate() {
        if polygon.corners().iter().any(|&c| plane(c) < 0.0) {
            let before = polygon;
            polygon = before.cut(plane);
            cut(number, &before, &polygon);
        }
    }
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::vec4;

    /// Area of the projection in NDC.
    fn projected_area(polygon: &Polygon) -> f32 {
        let ndc: Vec<_> =
            polygon.corners().iter().map(|p| (*p / p.w).truncate().truncate()).collect();
        (0..ndc.len()).map(|i| ndc[i].perp_dot(ndc[(i + 1) % ndc.len()])).sum::<f32>() / 2.0
    }

    #[test]
    fn a_polygon_round_the_guard_band_becomes_the_guard_band() {
        let triangle = Polygon::triangle([
            vec4(-9., -9., 0.5, 1.),
            vec4(9., -9., 0.5, 1.),
            vec4(0., 30., 0.5, 1.),
        ]);
        assert!((projected_area(&clip(triangle, Vec2::ONE)) - 4.0).abs() < 1e-5);
    }

    #[test]
    fn a_vertex_behind_the_eye_leaves_only_what_is_in_front() {
        let triangle = Polygon::triangle([
            vec4(-0.5, 0., 0.5, 1.),
            vec4(0.5, 0., 0.5, 1.),
            vec4(0., 0.5, -3., -1.),
        ]);
        let clipped = clip(triangle, Vec2::splat(10.0));
        assert!(clipped.corners().len() >= 3);
        assert!(
            clipped.corners().iter().all(|p| p.w > 0.0 && p.z >= 0.0 && p.z <= p.w * 1.000_001)
        );
    }

    #[test]
    fn the_parts_on_both_sides_of_a_plane_add_up() {
        let t = Polygon::triangle([
            vec4(-0.9, -0.8, 0.5, 1.),
            vec4(0.7, -0.3, 0.5, 1.),
            vec4(0.1, 0.9, 0.5, 1.),
        ]);
        let (right, left) = (t.cut(|p| p.x - 0.05 * p.w), t.cut(|p| 0.05 * p.w - p.x));
        assert!((projected_area(&right) + projected_area(&left) - projected_area(&t)).abs() < 1e-6);
    }

    #[test]
    fn a_polygon_beyond_the_far_plane_vanishes() {
        let triangle = Polygon::triangle([
            vec4(0., 0., -0.1, 1.),
            vec4(1., 0., -0.2, 1.),
            vec4(0., 1., -0.1, 1.),
        ]);
        assert!(clip(triangle, Vec2::ONE).corners().len() < 3);
    }
}
