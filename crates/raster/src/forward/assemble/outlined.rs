//! Polygons in their polygon mode: the edges or corners of what clipping leaves of them, or their
//! interior.
//!
//! Edges and corners that planes of the user make are drawn (OpenGL 1.5, section 2.11). Those that
//! the view volume makes are not, though the section speaks of them, too: nobody else draws them,
//! and half of them would frame the picture.

use super::lines::Stroke;
use super::*;

/// How many planes a user may have.
const USER_PLANES: usize = flag::USERS.count_ones() as usize;

/// A corner of an outline.
#[derive(Clone, Copy, Debug)]
struct Corner {
    /// In clip space.
    clip: [f32; 4],
    /// Distances to the user's planes.
    user: [f32; USER_PLANES],
    /// Point size and fade factor.
    size: [f32; 2],
    /// Where its record is.
    slot: u32,
    /// The edge from here to the next corner is drawn.
    boundary: bool,
}

impl Assembler<'_> {
    /// A polygon in its polygon mode. `edges[i]` says whether the edge from corner `i` is a
    /// boundary.
    pub fn polygon(&mut self, corners: &[u32], edges: &[bool], provoking: u32) {
        // Reject polygons outside the view volume.
        let s = self.vertices.screen;
        let flags = corners.iter().map(|&v| s[v as usize].flags);
        let (any, all) = flags.fold((0, u32::MAX), |(any, all), flags| (any | flags, all & flags));
        if any & flag::NOT_FINITE != 0 || all & self.outside() != 0 {
            return;
        }
        let clip = |v: u32| self.vertices.clip[v as usize];
        // The sign of the area in homogeneous coordinates needs no clipping.
        let (mut area, mut outside, mut largest) = (0.0f64, true, (-1.0, [[0.0; 4]; 3]));
        for i in 1..corners.len() - 1 {
            let triangle = [corners[0], corners[i], corners[i + 1]].map(clip);
            let [a, b, c] = triangle.map(|c| c.map(f64::from));
            let part = a[3] * (b[0] * c[1] - b[1] * c[0]) - b[3] * (a[0] * c[1] - a[1] * c[0])
                + c[3] * (a[0] * b[1] - a[1] * b[0]);
            area += part;
            outside &= a[3] <= 0.0 && b[3] <= 0.0 && c[3] <= 0.0;
            if part.abs() > largest.0 {
                largest = (part.abs(), triangle);
            }
        }
        if outside {
            return;
        }
        // A polygon without area, such as one seen edge-on, is a back face; its edges and corners
        // are drawn.
        let back = area == 0.0 || (area > 0.0) != self.state.counter_clockwise;
        if self.state.cull[usize::from(back)] {
            return;
        }

        // Draw filled polygons as such.
        let mode = usize::from(self.state.polygon_mode[usize::from(back)]);
        if mode > 1 {
            return self.interior(corners, provoking, back);
        }

        // Cut the outline at the clip planes.
        let outline: Vec<Corner> =
            corners.iter().zip(edges).map(|(&v, &edge)| self.corner(v, edge)).collect();
        let outline = if any & (CUT | flag::FRUSTUM) == 0 {
            outline
        } else {
            self.cut_outline(outline, mode)
        };
        let offset = self.outline_offset(largest.1, &outline, mode);
        let stroke = Stroke { provoking: self.slot(provoking), back, offset };

        // Draw a dot for each boundary corner, or a segment for each boundary edge.
        let mut stipple = 0;
        for (i, corner) in outline.iter().enumerate().filter(|(_, corner)| corner.boundary) {
            if mode == 0 {
                self.dot(corner.clip, corner.size, corner.slot, stroke);
            } else {
                let next = &outline[(i + 1) % outline.len()];
                stipple = self.segment(
                    [corner.clip, next.clip],
                    [corner.slot, next.slot],
                    stroke,
                    stipple,
                );
            }
        }
    }

    /// A filled polygon, cut from the corner that provokes.
    fn interior(&mut self, corners: &[u32], provoking: u32, back: bool) {
        let (n, first) = (corners.len(), corners.iter().position(|&v| v == provoking).unwrap_or(0));
        let corner = |i: usize| corners[(first + i) % n];
        for i in 1..n - 1 {
            let piece = [corner(0), corner(i), corner(i + 1)];
            if self.state.polygon_smooth {
                self.smooth_triangle(piece, [i == 1, true, i + 2 == n], provoking, back);
            } else {
                self.triangle(piece, provoking);
            }
        }
    }

    fn corner(&mut self, vertex: u32, boundary: bool) -> Corner {
        let planes = self.state.user_planes;
        let mut user = [0.0; USER_PLANES];
        user[..planes].copy_from_slice(&self.vertices.user[vertex as usize * planes..][..planes]);
        let (clip, size) = (self.vertices.clip[vertex as usize], self.size(vertex));
        Corner { clip, user, size, slot: self.slot(vertex), boundary }
    }

    /// The part of an outline that is inside, for lines (1) or for its corners alone (0); the edges
    /// along planes of the user are boundary edges.
    fn cut_outline(&mut self, mut outline: Vec<Corner>, mode: usize) -> Vec<Corner> {
        for plane in 0..self.cutting_planes() {
            let d: Vec<f32> =
                outline.iter().map(|c| self.distance(plane, c.clip, |k| c.user[k])).collect();
            if d.iter().all(|&d| d >= 0.0) {
                continue;
            }

            // Drop outer corners where only corners are drawn.
            let by_user = plane < self.state.user_planes;
            if mode == 0 && !by_user {
                let mut d = d.into_iter();
                outline.retain(|_| d.next().is_some_and(|d| d >= 0.0));
                continue;
            }

            // Walk the outline, keep inner corners and add the crossings.
            let mut kept = Vec::with_capacity(outline.len() + 1);
            for (i, corner) in outline.iter().enumerate() {
                let j = (i + 1) % outline.len();
                // Always from the inner to the outer corner: neighbours that share the edge get the
                // same point.
                if d[i] >= 0.0 {
                    kept.push(*corner);
                    if d[j].is_nan() || d[j] < 0.0 {
                        kept.push(self.on_edge(corner, &outline[j], d[i] / (d[i] - d[j]), by_user));
                    }
                } else if d[j] >= 0.0 {
                    kept.push(self.on_edge(
                        &outline[j],
                        corner,
                        d[j] / (d[j] - d[i]),
                        corner.boundary,
                    ));
                }
            }
            outline = kept;
        }
        outline
    }

    /// The corner at `t` on the way from one corner to another.
    fn on_edge(&mut self, inner: &Corner, outer: &Corner, t: f32, boundary: bool) -> Corner {
        let mix = |a: f32, b: f32| a + (b - a) * t;
        let clip: [f32; 4] = std::array::from_fn(|k| mix(inner.clip[k], outer.clip[k]));
        let slot = self.new_slot(
            [inner.slot, outer.slot, outer.slot],
            [1.0 - t, t, 0.0],
            1.0 / clip[3],
            None,
        );
        Corner {
            clip,
            user: std::array::from_fn(|k| mix(inner.user[k], outer.user[k])),
            size: std::array::from_fn(|k| mix(inner.size[k], outer.size[k])),
            slot,
            boundary,
        }
    }

    /// Polygon offset of points or lines: by the slope of the polygon whose largest triangle is
    /// given.
    fn outline_offset(&self, triangle: [[f32; 4]; 3], outline: &[Corner], offset: usize) -> f32 {
        if self.state.offset[offset] == [0.0; 2] {
            return 0.0;
        }
        let deepest =
            outline.iter().map(|c| self.project(c.clip)[2].clamp(0.0, 1.0)).fold(0.0, f32::max);
        match self.state.window.homogeneous_plane(triangle, [0; 2]) {
            Some(plane) => self.offset_of(&DepthPlane { z_max: deepest, ..plane }, offset),
            None => 0.0,
        }
    }
}
