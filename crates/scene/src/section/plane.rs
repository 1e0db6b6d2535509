//! Planes of section, and how high vertices lie over them.

use crate::Instance;
use vitral_math::DVec3;

/// Distance from a plane within which a vertex lies in it, as a part of the largest coordinate: a
/// step of single precision.
const IN_PLANE: f64 = 1.0 / (1u64 << 22) as f64;

/// A plane of section, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionPlane {
    pub(super) point: DVec3,
    pub(super) normal: DVec3,
}

impl SectionPlane {
    /// The plane through a point. The side to which the normal, of any length, points is taken
    /// away. `None` for a normal without length and for numbers that are not finite.
    pub fn new(point: impl Into<DVec3>, normal: impl Into<DVec3>) -> Option<Self> {
        let (point, normal) = (point.into(), normal.into().try_normalize()?);
        (point.is_finite() && normal.is_finite()).then_some(Self { point, normal })
    }

    /// Distance of a point, positive on the side that is taken away.
    pub fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point)
    }
}

/// The heights of a mesh's vertices over a plane.
pub(super) struct Heights {
    /// Distance in world space, positive on the side that is taken away.
    pub(super) of: Vec<f64>,
    /// The plane's normal as a covector of model space: points to the side that is taken away.
    pub(super) normal: DVec3,
    /// Heights up to this are none.
    pub(super) tolerance: f64,
}

impl Heights {
    pub(super) fn new(instance: &Instance, plane: &SectionPlane) -> Self {
        let normal = instance.world_from_model.transpose().transform_vector3(plane.normal);
        let offset = plane.distance(instance.world_from_model.transform_point3(DVec3::ZERO));
        let of = instance
            .mesh
            .positions
            .iter()
            .map(|&p| normal.dot(DVec3::from_array(p.map(f64::from))) + offset);
        let bounds = instance.model_bounds;
        let largest = bounds.min.abs().max(bounds.max.abs());
        Self { of: of.collect(), normal, tolerance: normal.abs().dot(largest) * IN_PLANE }
    }

    /// 1 where a vertex is taken away, -1 where it stays, 0 in the plane; `None` where it is not
    /// finite.
    pub(super) fn side(&self, vertex: u32) -> Option<i8> {
        let height = self.of[vertex as usize];
        let side = i8::from(height > self.tolerance) - i8::from(height < -self.tolerance);
        height.is_finite().then_some(side)
    }
}
