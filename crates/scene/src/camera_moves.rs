//! Moves of a camera round what it looks at, with the names that model viewers give them.
//!
//! Angles are radians. Every move gives a new camera; the clipping planes, if the camera has its
//! own, stay.

use crate::{Camera, Projection};
use vitral_math::{Aabb, DQuat, DVec3, func};

impl Camera {
    /// Zooms in (`factor > 1`) or out without moving: the angle of view (perspective) or the height
    /// (parallel) is divided. A factor that is not positive and finite changes nothing.
    #[must_use]
    pub fn zoomed(&self, factor: f64) -> Self {
        if !(factor.is_finite() && factor > 0.0) {
            return *self;
        }
        let projection = match self.projection {
            Projection::Perspective { view_angle } => {
                Projection::Perspective { view_angle: (view_angle / factor).clamp(1e-6, 3.1) }
            }
            Projection::Parallel { height } => Projection::Parallel { height: height / factor },
            Projection::Window { across, upwards } => Projection::Window {
                across: about_middle(across, factor),
                upwards: about_middle(upwards, factor),
            },
        };
        Self { projection, ..*self }
    }

    /// Walks round the focal point about the up vector; seen from above counter-clockwise for
    /// positive angles, so that an eye at +z moves towards +x where y is up.
    #[must_use]
    pub fn azimuth(&self, angle: f64) -> Self {
        let axis = self.view_up.try_normalize().unwrap_or(DVec3::Y);
        self.turned(DQuat::from_axis_angle(axis, angle), self.view_up)
    }

    /// Climbs over the focal point (positive) or dives below it. The up vector goes along, so that
    /// climbing past the zenith does not flip the picture.
    #[must_use]
    pub fn elevation(&self, angle: f64) -> Self {
        let view = self.view_from_world();
        let (right, up) = (view.row(0).truncate(), view.row(1).truncate());
        let rotation = DQuat::from_axis_angle(right, -angle);
        self.turned(rotation, rotation * up)
    }

    /// The same view with parallel projectors: what lies in the plane of the focal point keeps its
    /// size.
    #[must_use]
    pub fn orthographic(&self) -> Self {
        match self.projection {
            Projection::Parallel { .. } => *self,
            Projection::Perspective { view_angle } => {
                let distance = self.position.distance(self.focal_point);
                let height = 2.0 * distance * func::tan(0.5 * view_angle);
                Self { projection: Projection::Parallel { height }, ..*self }
            }
            Projection::Window { upwards: [low, high], .. } => {
                let height = self.position.distance(self.focal_point) * (high - low);
                Self { projection: Projection::Parallel { height }, ..*self }
            }
        }
    }

    /// Looks along `direction` (from the eye) at the same focal point from the same distance. A
    /// zero or infinite direction changes nothing.
    #[must_use]
    pub fn with_direction(&self, direction: DVec3) -> Self {
        let Some(direction) = direction.try_normalize() else { return *self };
        let distance = self.position.distance(self.focal_point);
        Self { position: self.focal_point - direction * distance, ..*self }
    }

    /// Whether the eye is inside `bounds`: back faces of solids may then be in view.
    pub fn is_inside(&self, bounds: &Aabb) -> bool {
        bounds.contains(self.position)
    }

    fn turned(&self, rotation: DQuat, view_up: DVec3) -> Self {
        Self {
            position: self.focal_point + rotation * (self.position - self.focal_point),
            view_up,
            ..*self
        }
    }
}

/// A window's borders brought nearer to their middle by a factor.
fn about_middle([low, high]: [f64; 2], factor: f64) -> [f64; 2] {
    let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5 / factor);
    [middle - half, middle + half]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn camera() -> Camera {
        Camera {
            position: DVec3::new(1.0, 2.0, 8.0),
            focal_point: DVec3::new(1.0, 2.0, 3.0),
            view_up: DVec3::Y,
            projection: Projection::Perspective { view_angle: 1.0 },
            clip: None,
        }
    }

    #[test]
    fn azimuth_and_elevation_walk_round_the_focal_point() {
        let c = camera();
        assert!(c.azimuth(FRAC_PI_2).position.abs_diff_eq(DVec3::new(6.0, 2.0, 3.0), 1e-12));
        let top = c.elevation(FRAC_PI_2);
        assert!(top.position.abs_diff_eq(DVec3::new(1.0, 7.0, 3.0), 1e-12));
        assert!(top.view_up.abs_diff_eq(DVec3::NEG_Z, 1e-12), "the picture has not flipped");
        assert!(c.azimuth(0.7).azimuth(-0.7).position.abs_diff_eq(c.position, 1e-12));
    }

    #[test]
    fn zoom_direction_and_projection_change_only_what_they_say() {
        let c = camera();
        assert_eq!(c.zoomed(2.0).projection, Projection::Perspective { view_angle: 0.5 });
        assert_eq!(c.zoomed(0.0), c);
        let window = Camera {
            projection: Projection::Window { across: [-1.0, 3.0], upwards: [0.0, 2.0] },
            ..c
        };
        assert_eq!(
            window.zoomed(2.0).projection,
            Projection::Window { across: [0.0, 2.0], upwards: [0.5, 1.5] }
        );
        assert_eq!(window.orthographic().projection, Projection::Parallel { height: 10.0 });
        assert_eq!(c.zoomed(f64::NAN), c);
        assert_eq!(
            c.with_direction(DVec3::new(-3.0, 0.0, 0.0)).position,
            DVec3::new(6.0, 2.0, 3.0)
        );
        assert_eq!(c.with_direction(DVec3::ZERO), c);
        let flat = c.orthographic();
        assert_eq!(flat.orthographic(), flat);
        assert_eq!(flat.zoomed(4.0).orthographic().position, c.position);

        // A point in the focal plane is at the same place in both pictures.
        let p = DVec3::new(2.0, 2.5, 3.0).extend(1.0);
        let [a, b] = [c, flat]
            .map(|c| c.transform(1.0, (1.0, 9.0)).clip_from_world() * p)
            .map(|p| p.truncate() / p.w);
        assert!((a - b).truncate().length() < 1e-12);
    }
}
