//! Which triangles a square window of the picture may show: those whose outline on the screen
//! reaches into it, whether they lie between near and far plane or not.
//!
//! The projectors through a window fill a pyramid with its tip in the eye (in a parallel view, a
//! prism). A triangle is seen in the window if clipping by the pyramid's sides and the plane of the
//! eye leaves something of it. Runs of triangles are rejected by their boxes first.
//!
//! In:   a mesh with the boxes of its runs, model space. Out: runs of triangles.
//! Cost: a box test for each run of triangles; for each triangle of the runs that are kept, its
//!       corners' distances from the sides.
//! Source: [Clark 1976]; clipping after [Sutherland & Hodgman 1974].

use std::ops::Range;
use vitral_math::{Aabb, DMat4, DVec3, DVec4};
use vitral_raster::Viewport;
use vitral_scene::{Instance, Mesh, TRIANGLES_A_RUN, ViewTransform};

/// Sides of a pyramid: the window's four and the plane of the eye.
const SIDES: usize = 5;

/// A square window of the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelWindow {
    clip_from_world: DMat4,
    /// Inner products with points in clip space are not negative inside.
    planes: [DVec4; SIDES],
}

impl PixelWindow {
    /// The window of `side` pixels from `corner`, the upper left one, and `margin` pixels around
    /// it.
    pub(crate) fn new(
        view: &ViewTransform,
        viewport: Viewport,
        corner: [u32; 2],
        side: u32,
        margin: f64,
    ) -> Self {
        let half = [viewport.width, viewport.height].map(|size| f64::from(size) * 0.5);
        let low = corner.map(|c| f64::from(c) - margin);
        let high = corner.map(|c| f64::from(c + side) + margin);
        let planes = [
            DVec4::new(half[0], 0.0, 0.0, half[0] - low[0]),
            DVec4::new(-half[0], 0.0, 0.0, high[0] - half[0]),
            DVec4::new(0.0, -half[1], 0.0, half[1] - low[1]),
            DVec4::new(0.0, half[1], 0.0, high[1] - half[1]),
            DVec4::W,
        ];
        Self { clip_from_world: view.clip_from_world(), planes }
    }

    /// Its pyramid in the model space of an instance.
    pub(crate) fn pyramid_of(&self, instance: &Instance) -> WindowPyramid {
        let model_from_clip = (self.clip_from_world * instance.world_from_model).transpose();
        WindowPyramid { sides: self.planes.map(|plane| model_from_clip * plane) }
    }
}

/// The projectors through a window, in a model's space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WindowPyramid {
    sides: [DVec4; SIDES],
}

impl WindowPyramid {
    /// The triangles of `ranges` that reach into it, as runs; `run_bounds` are the boxes of the
    /// mesh's runs.
    pub(crate) fn triangles(
        &self,
        mesh: &Mesh,
        run_bounds: &[Aabb],
        ranges: &[Range<u32>],
    ) -> Vec<Range<u32>> {
        let mut found: Vec<Range<u32>> = Vec::new();
        let size = TRIANGLES_A_RUN as u32;
        for range in ranges {
            let mut start = range.start;
            while start < range.end {
                let run = start / size;
                let end = range.end.min((run + 1) * size);
                if run_bounds.get(run as usize).is_none_or(|bounds| self.may_meet_box(bounds)) {
                    for triangle in (start..end).filter(|&t| self.meets(&corners(mesh, t))) {
                        match found.last_mut() {
                            Some(last) if last.end == triangle => last.end += 1,
                            _ => found.push(triangle..triangle + 1),
                        }
                    }
                }
                start = end;
            }
        }
        found
    }

    /// Whether a box is not wholly beyond one side.
    fn may_meet_box(&self, bounds: &Aabb) -> bool {
        let (center, half) = ((bounds.min + bounds.max) * 0.5, (bounds.max - bounds.min) * 0.5);
        let beyond = |side: &DVec4| {
            let (distance, reach) =
                (side.truncate().dot(center) + side.w, side.truncate().abs().dot(half));
            distance + reach < -1e-9 * (distance.abs() + reach)
        };
        !bounds.is_empty() && !self.sides.iter().any(beyond)
    }

    /// Whether a triangle reaches into it.
    pub(crate) fn meets(&self, corners: &[DVec3; 3]) -> bool {
        // Test the corners against the sides: all beyond one side, or all inside.
        let distance = |side: &DVec4, p: DVec3| side.truncate().dot(p) + side.w;
        let mut is_inside = true;
        for side in &self.sides {
            let behind = corners.iter().filter(|&&p| distance(side, p) < 0.0).count();
            if behind == 3 {
                return false;
            }
            is_inside &= behind == 0;
        }
        if is_inside {
            return corners.iter().all(|p| p.is_finite());
        }

        // Clip it, side by side.
        let (mut polygon, mut clipped) = (corners.to_vec(), Vec::with_capacity(3 + SIDES));
        for side in &self.sides {
            clipped.clear();
            for (i, &from) in polygon.iter().enumerate() {
                let to = polygon[(i + 1) % polygon.len()];
                let (d_from, d_to) = (distance(side, from), distance(side, to));
                if d_from >= 0.0 {
                    clipped.push(from);
                }
                if (d_from >= 0.0) != (d_to >= 0.0) {
                    clipped.push(from + (to - from) * (d_from / (d_from - d_to)));
                }
            }
            std::mem::swap(&mut polygon, &mut clipped);
        }
        polygon.iter().any(|p| p.is_finite())
    }
}

/// The corners of a mesh's triangle.
pub(crate) fn corners(mesh: &Mesh, triangle: u32) -> [DVec3; 3] {
    mesh.triangles[triangle as usize].map(|i| {
        let [x, y, z] = mesh.positions[i as usize];
        DVec3::new(f64::from(x), f64::from(y), f64::from(z))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_scene::Camera;

    #[test]
    fn a_window_holds_what_projects_into_it_before_the_near_plane_and_beyond_the_far_one_too() {
        let camera = Camera::look_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO);
        let view = camera.transform(1.0, (4.0, 6.0));
        let viewport = Viewport::new(100, 100).unwrap();
        let window = PixelWindow::new(&view, viewport, [50, 50], 1, 0.0);
        let pyramid = WindowPyramid {
            sides: window.planes.map(|plane| view.clip_from_world().transpose() * plane),
        };
        let triangle = |x: f64, z: f64, size: f64| {
            [DVec3::new(x, -size, z), DVec3::new(x + size, -size, z), DVec3::new(x, size, z)]
        };
        for z in [4.9, 2.0, 0.0, -50.0] {
            assert!(pyramid.meets(&triangle(-0.5, z, 1.0)), "{z}");
            assert!(pyramid.meets(&triangle(0.0, z, 1e-4)), "a small one within the pixel, {z}");
            assert!(!pyramid.meets(&triangle(40.0, z, 1.0)), "beside it, {z}");
        }
        assert!(!pyramid.meets(&triangle(-0.5, 5.5, 1.0)), "behind the eye");
        assert!(pyramid.meets(&[
            DVec3::new(0.0, -1.0, 9.0),
            DVec3::new(0.2, -0.1, 0.0),
            DVec3::new(-0.2, 0.1, 0.0)
        ]));
        let edge_on = [
            DVec3::new(0.003, -0.003, 0.0),
            DVec3::new(0.003, -0.003, 1.0),
            DVec3::new(0.003, -0.003, 2.0),
        ];
        assert!(pyramid.meets(&edge_on), "one without area");
    }
}
