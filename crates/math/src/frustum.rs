//! The view volume as six planes in any space, to reject boxes before anything else is done with
//! them.
//!
//! Source: the rows of the clip matrix are the planes [Gribb & Hartmann 2001]. The volume is
//! `-w <= x, y <= w`, `0 <= z <= w`.

use crate::bounds::Aabb;
use glam::{DMat4, DVec4};

/// Where a volume lies with respect to the frustum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Containment {
    /// No point of the volume is visible.
    Outside,
    /// Part of it may be visible.
    Crossing,
    /// Nothing of it needs clipping.
    Inside,
}

/// Six planes with unit normals pointing inwards: left, right, bottom, top, far (`z = 0`), near
/// (`z = w`).
#[derive(Clone, Copy, Debug)]
pub struct Frustum {
    /// `plane · (x, y, z, 1) >= 0` inside.
    pub planes: [DVec4; 6],
}

impl Frustum {
    /// The frustum in the space that `clip_from_here` takes points from.
    pub fn from_matrix(clip_from_here: &DMat4) -> Self {
        let [x, y, z, w] = std::array::from_fn(|i| clip_from_here.row(i));
        let planes = [w + x, w - x, w + y, w - y, z, w - z].map(|p| {
            let length = p.truncate().length();
            if length > 0.0 { p / length } else { p }
        });
        Self { planes }
    }

    /// Names of [`Self::planes`], in their order.
    pub const NAMES: [&'static str; 6] = ["left", "right", "bottom", "top", "far", "near"];

    /// Tests a box by the corner farthest along each plane's normal, and the nearest.
    pub fn test_box(&self, b: &Aabb) -> Containment {
        self.find_box(b).0
    }

    /// [`test_box`](Self::test_box), with the index of the first plane that the box lies beyond, if
    /// it is outside.
    pub fn find_box(&self, b: &Aabb) -> (Containment, Option<usize>) {
        if b.is_empty() {
            return (Containment::Outside, None);
        }
        let (center, half) = ((b.min + b.max) * 0.5, (b.max - b.min) * 0.5);
        let mut result = Containment::Inside;
        for (number, plane) in self.planes.iter().enumerate() {
            let normal = plane.truncate();
            let (distance, reach) = (normal.dot(center) + plane.w, normal.abs().dot(half));
            // A hair of slack: rounding must never cull what a clipper would keep.
            let slack = 1e-9 * (distance.abs() + reach);
            if distance + reach < -slack {
                return (Containment::Outside, Some(number));
            }
            if distance - reach < slack {
                result = Containment::Crossing;
            }
        }
        (result, None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn unit_cube_view() {
        let f = Frustum::from_matrix(&DMat4::IDENTITY);
        let cube = |c: DVec3, h: f64| Aabb { min: c - h, max: c + h };
        assert_eq!(f.test_box(&cube(DVec3::new(0.0, 0.0, 0.5), 0.1)), Containment::Inside);
        assert_eq!(f.test_box(&cube(DVec3::new(1.0, 0.0, 0.5), 0.1)), Containment::Crossing);
        assert_eq!(
            f.find_box(&cube(DVec3::new(2.0, 0.0, 0.5), 0.1)),
            (Containment::Outside, Some(1))
        );
        assert_eq!(Frustum::NAMES[1], "right");
    }
}
