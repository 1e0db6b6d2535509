//! Cameras: perspective (projectors meet in a point) and parallel (projectors share a direction).
//!
//! View space is right-handed, x to the right, y up, looking along -z. Clip space is
//! `-w <= x, y <= w`, `0 <= z <= w` with **z = w on the near plane and z = 0 on the far plane**:
//! larger is nearer, as in the course's convention (back plane 0, front plane zmax), and the
//! precision of floating point is where perspective needs it.

use serde::{Deserialize, Serialize};
use vitral_math::{DMat4, DVec3, DVec4, func};

/// A viewer. Position, focal point and up are in world space (or the space of the node that carries
/// it).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Camera {
    /// Where the viewer is.
    pub position: DVec3,
    /// Where the viewer looks; a different point.
    pub focal_point: DVec3,
    /// Roughly upwards in the picture; not parallel to the direction of view.
    pub view_up: DVec3,
    /// How rays run.
    pub projection: Projection,
    /// Distances of the near and far plane along the direction of view, `0 < near < far` (parallel:
    /// `near < far`); `None`: fitted to the scene.
    #[serde(default)]
    pub clip: Option<(f64, f64)>,
}

/// Perspective or parallel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    tag = "type",
    rename_all = "kebab-case",
    rename_all_fields = "kebab-case",
    deny_unknown_fields
)]
pub enum Projection {
    /// Projectors through the position.
    Perspective {
        /// Vertical angle of view in radians, `0..π`.
        view_angle: f64,
    },
    /// Projectors along the direction of view.
    Parallel {
        /// Height of the picture in world units.
        height: f64,
    },
    /// Projectors through the position, and a picture whose middle need not lie on the direction of
    /// view, as of a measured camera. The picture keeps this window whatever its aspect, so pixels
    /// need not be square.
    Window {
        /// Left and right border of the picture at the distance 1, view space, in this order.
        across: [f64; 2],
        /// Lower and upper border at the distance 1, in this order.
        upwards: [f64; 2],
    },
}

/// A camera made ready for a viewport.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewTransform {
    /// Rigid: world space to view space.
    pub view_from_world: DMat4,
    /// Projection, to the clip space of this module.
    pub clip_from_view: DMat4,
    /// Distance of the near plane along -z.
    pub near: f64,
    /// Distance of the far plane along -z.
    pub far: f64,
    /// Whether projectors meet in the eye.
    pub perspective: bool,
}

impl Camera {
    /// Vertical angle of view where none is chosen: 30 degrees in radians, a moderate telephoto
    /// lens with little distortion.
    pub const VIEW_ANGLE: f64 = std::f64::consts::FRAC_PI_6;

    /// A perspective camera at `position` that looks at `focal_point`, with +Y up in the picture,
    /// the angle of view [`VIEW_ANGLE`](Self::VIEW_ANGLE) and clipping planes fitted to the scene.
    pub fn look_at(position: impl Into<DVec3>, focal_point: impl Into<DVec3>) -> Self {
        let projection = Projection::Perspective { view_angle: Self::VIEW_ANGLE };
        Self {
            position: position.into(),
            focal_point: focal_point.into(),
            view_up: DVec3::Y,
            projection,
            clip: None,
        }
    }

    /// With this direction upwards in the picture.
    #[must_use]
    pub fn with_up(self, view_up: impl Into<DVec3>) -> Self {
        Self { view_up: view_up.into(), ..self }
    }

    /// In perspective with this vertical angle of view in radians, `0..π`.
    #[must_use]
    pub fn with_view_angle(self, view_angle: f64) -> Self {
        Self { projection: Projection::Perspective { view_angle }, ..self }
    }

    /// In perspective as a measured camera sees: the focal lengths and the principal point, both in
    /// pixels of a picture of `size` pixels. The principal point counts from the picture's top left
    /// corner, so that `size / 2` is the middle.
    #[must_use]
    pub fn with_intrinsics(self, focal: [f64; 2], principal: [f64; 2], size: [u32; 2]) -> Self {
        let size = size.map(f64::from);
        let across = [-principal[0] / focal[0], (size[0] - principal[0]) / focal[0]];
        let upwards = [(principal[1] - size[1]) / focal[1], principal[1] / focal[1]];
        Self { projection: Projection::Window { across, upwards }, ..self }
    }

    /// With clipping planes at these distances along the direction of view, `0 < near < far`.
    #[must_use]
    pub fn with_clip(self, near: f64, far: f64) -> Self {
        Self { clip: Some((near, far)), ..self }
    }

    /// World to view. Falls back to another up vector where `view_up` is parallel to the view
    /// direction or zero.
    pub fn view_from_world(&self) -> DMat4 {
        let forward = (self.focal_point - self.position).try_normalize().unwrap_or(DVec3::NEG_Z);
        let side = |up: DVec3| forward.cross(up).try_normalize().filter(|s| s.is_finite());
        let right = [self.view_up.normalize_or_zero(), DVec3::Y, DVec3::Z]
            .into_iter()
            .find_map(|up| side(up).filter(|_| forward.cross(up).length_squared() > 1e-12));
        let right = right.unwrap_or(DVec3::X);
        let up = right.cross(forward);
        let rows = [right, up, -forward].map(|r| DVec4::from((r, -r.dot(self.position))));
        DMat4::from_cols(rows[0], rows[1], rows[2], DVec4::W).transpose()
    }

    /// The transform for a picture `aspect = width / height`. `depths` is the range of distances
    /// along the direction of view that holds the scene; it chooses the clipping planes where the
    /// camera has none of its own.
    pub fn transform(&self, aspect: f64, depths: (f64, f64)) -> ViewTransform {
        let (near, far) = self.clip.unwrap_or_else(|| self.fitted_clip(depths));
        let perspective = !matches!(self.projection, Projection::Parallel { .. });
        // z_clip = (near z_view + near far) / (far - near): w = near at the near plane, 0 at the
        // far plane.
        let central = |focal: [f64; 2], middle: [f64; 2]| {
            let (a, b) = (near / (far - near), near * far / (far - near));
            DMat4::from_cols(
                DVec4::new(focal[0], 0.0, 0.0, 0.0),
                DVec4::new(0.0, focal[1], 0.0, 0.0),
                DVec4::new(middle[0], middle[1], a, -1.0),
                DVec4::new(0.0, 0.0, b, 0.0),
            )
        };
        let clip_from_view = match self.projection {
            Projection::Perspective { view_angle } => {
                let focal = 1.0 / func::tan(view_angle * 0.5);
                central([focal / aspect, focal], [0.0, 0.0])
            }
            Projection::Window { across, upwards } => {
                let size = [across, upwards].map(|[low, high]| high - low);
                let sum = [across, upwards].map(|[low, high]| low + high);
                central(size.map(|s| 2.0 / s), [sum[0] / size[0], sum[1] / size[1]])
            }
            Projection::Parallel { height } => {
                let (sx, sy, sz) = (2.0 / (height * aspect), 2.0 / height, 1.0 / (far - near));
                DMat4::from_cols(
                    DVec4::new(sx, 0.0, 0.0, 0.0),
                    DVec4::new(0.0, sy, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, sz, 0.0),
                    DVec4::new(0.0, 0.0, far * sz, 1.0),
                )
            }
        };
        ViewTransform {
            view_from_world: self.view_from_world(),
            clip_from_view,
            near,
            far,
            perspective,
        }
    }

    /// Clipping planes a little outside `depths`; for a perspective the near plane stays in front
    /// of the eye, in a parallel view it goes through the position at the nearest.
    fn fitted_clip(&self, (nearest, farthest): (f64, f64)) -> (f64, f64) {
        let usable = nearest.is_finite() && farthest.is_finite() && nearest <= farthest;
        let (nearest, farthest) = if usable { (nearest, farthest) } else { (0.1, 100.0) };
        let margin = ((farthest - nearest) * 0.01).max(farthest.abs().max(nearest.abs()) * 1e-4);
        let margin = if margin > 0.0 { margin } else { 1e-9 };
        match self.projection {
            Projection::Parallel { .. } => {
                let near = (nearest - margin).max(0.0);
                (near, (farthest + margin).max(near + margin))
            }
            Projection::Perspective { .. } | Projection::Window { .. } => {
                let far = if farthest + margin > 0.0 { farthest + margin } else { 1e-6 };
                ((nearest - margin).max(far * 1e-4), far)
            }
        }
    }
}

impl ViewTransform {
    /// The distance along the direction of view at a depth of a picture, 1 on the near plane and 0
    /// on the far plane.
    pub fn distance_at(&self, depth: f32) -> f64 {
        let (a, b) = (self.clip_from_view.z_axis.z, self.clip_from_view.w_axis.z);
        if self.perspective { b / (f64::from(depth) + a) } else { (b - f64::from(depth)) / a }
    }

    /// The matrix from world space to clip space.
    pub fn clip_from_world(&self) -> DMat4 {
        self.clip_from_view * self.view_from_world
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(projection: Projection) -> Camera {
        Camera {
            position: DVec3::new(0.0, 0.0, 5.0),
            focal_point: DVec3::ZERO,
            view_up: DVec3::Y,
            projection,
            clip: Some((1.0, 10.0)),
        }
    }

    #[test]
    fn a_camera_looks_at_its_focal_point() {
        let camera = Camera::look_at([0.0, -4.0, 0.0], [0.0; 3])
            .with_up(DVec3::Z)
            .with_view_angle(1.0)
            .with_clip(1.0, 9.0);
        let view = camera.view_from_world();
        assert!(view.transform_point3(DVec3::ZERO).abs_diff_eq(DVec3::new(0.0, 0.0, -4.0), 1e-12));
        assert!(view.transform_vector3(DVec3::Z).abs_diff_eq(DVec3::Y, 1e-12));
        assert_eq!(
            (camera.projection, camera.clip),
            (Projection::Perspective { view_angle: 1.0 }, Some((1.0, 9.0)))
        );
    }

    #[test]
    fn depth_is_one_on_the_near_plane_and_zero_on_the_far_plane() {
        for projection in
            [Projection::Perspective { view_angle: 1.0 }, Projection::Parallel { height: 2.0 }]
        {
            let clip = camera(projection).transform(1.0, (0.0, 0.0)).clip_from_world();
            for (z, depth) in [(4.0, 1.0), (-5.0, 0.0)] {
                let p = clip * DVec4::new(0.0, 0.0, z, 1.0);
                assert!(
                    (p.z / p.w - depth).abs() < 1e-12 && p.w > 0.0,
                    "{projection:?} at z = {z}: {p}"
                );
            }
            let view = camera(projection).transform(1.0, (0.0, 0.0));
            assert_eq!(
                [1.0, 0.0].map(|depth| (view.distance_at(depth) * 1e9).round() / 1e9),
                [1.0, 10.0]
            );
            let right = clip * DVec4::new(1.0, 0.0, 0.0, 1.0);
            let up = clip * DVec4::new(0.0, 1.0, 0.0, 1.0);
            assert!(right.x > 0.0 && up.y > 0.0);
        }
    }

    #[test]
    fn a_measured_camera_puts_its_axis_on_the_principal_point() {
        let measured = camera(Projection::Parallel { height: 1.0 }).with_intrinsics(
            [200.0, 100.0],
            [30.0, 80.0],
            [320, 240],
        );
        let clip = measured.transform(4.0 / 3.0, (0.0, 0.0)).clip_from_world();
        let pixel = |x: f64, y: f64, z: f64| {
            let p = clip * DVec4::new(x, y, z, 1.0);
            [(p.x / p.w + 1.0) * 160.0, (1.0 - p.y / p.w) * 120.0]
        };
        // One unit aside at the distance 5 is a fifth of a focal length; down is a larger row.
        for (place, [x, y]) in [((0.0, 0.0, 0.0), [30.0, 80.0]), ((1.0, -2.0, 0.0), [70.0, 120.0])]
        {
            let [px, py] = pixel(place.0, place.1, place.2);
            assert!((px - x).abs() < 1e-9 && (py - y).abs() < 1e-9, "{px} {py}");
        }
        // With the principal point in the middle it is the usual camera of that angle.
        let middle = measured.with_intrinsics([120.0, 120.0], [160.0, 120.0], [320, 240]);
        let usual = camera(Projection::Perspective { view_angle: std::f64::consts::FRAC_PI_2 });
        let [a, b] = [middle, usual].map(|c| c.transform(4.0 / 3.0, (0.0, 0.0)).clip_from_view);
        assert!(a.abs_diff_eq(b, 1e-12), "{a} {b}");
    }

    #[test]
    fn clipping_planes_fit_scenes_of_any_size() {
        for projection in
            [Projection::Perspective { view_angle: 1.0 }, Projection::Parallel { height: 2.0 }]
        {
            let fitted = |depths| Camera { clip: None, ..camera(projection) }.fitted_clip(depths);
            for size in [1e-30, 1e-12, 1.0, 1e12] {
                let (near, far) = fitted((3.0 * size, 5.0 * size));
                assert!(
                    2.9 * size < near && near < 3.0 * size && 5.0 * size < far && far < 5.1 * size,
                    "{near} {far}"
                );
            }
            for depths in [(0.0, 0.0), (-5.0, -3.0), (f64::NAN, 1.0)] {
                let (near, far) = fitted(depths);
                assert!(near < far && (1.0 / (far - near)).is_finite(), "{depths:?}: {near} {far}");
            }
        }
    }

    #[test]
    fn a_bad_up_vector_is_replaced() {
        let mut c = camera(Projection::Parallel { height: 2.0 });
        for up in [DVec3::Z, DVec3::ZERO, DVec3::NAN] {
            c.view_up = up;
            let m = c.view_from_world();
            assert!(m.is_finite() && (m.determinant() - 1.0).abs() < 1e-12);
        }
    }
}
