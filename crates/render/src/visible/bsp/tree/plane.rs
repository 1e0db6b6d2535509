//! The planes of a BSP tree's nodes, and the side of them on which polygons lie.
//!
//! In:   polygons, world space. Out: thick planes, see `tree.rs`; sides.

use super::super::polygons::WorldPolygons;
use vitral_math::{DVec3, DVec4};

/// The half-thickness of planes, relative to the numbers that enter the distance.
const THICKNESS: f64 = 1.0 / (1 << 21) as f64;

/// Points at distance `normal . p + offset`, in the plane up to its thickness.
#[derive(Clone, Copy, Debug)]
pub(super) struct ThickPlane {
    pub(super) equation: DVec4,
    pub(super) thickness: f64,
}

impl ThickPlane {
    /// The plane of a triangle; of one that is thinner than its corners are certain, some plane
    /// through it.
    pub(super) fn of([a, b, c]: [DVec3; 3]) -> Self {
        let edges = [b - a, c - b, a - c];
        let longest = edges
            .into_iter()
            .fold(DVec3::ZERO, |l, e| if e.length_squared() > l.length_squared() { e } else { l });
        let cross = edges[0].cross(-edges[2]);
        let wide = cross.length() > 1e-9 * longest.length_squared();
        let across = if wide { cross } else { longest.any_orthogonal_vector() };
        let normal = across.try_normalize().unwrap_or(DVec3::Z);
        Self {
            equation: normal.extend(-normal.dot(a)),
            thickness: Self::rounding(normal, &[a, b, c]),
        }
    }

    /// The plane of a polygon: the one that it shares with others, or that of its first corners.
    pub(super) fn of_polygon(polygons: &WorldPolygons, polygon: u32) -> Self {
        let corners = polygons.corners(polygon);
        let Some(number) = polygons.plane(polygon) else {
            return Self::of([corners[0], corners[1], corners[2]]);
        };
        let equation = polygons.equation(number);
        let faces_back = polygons.doubled_area(polygon).dot(equation.truncate()) < 0.0;
        let equation = if faces_back { -equation } else { equation };
        let thickness = Self::rounding(equation.truncate(), corners).max(polygons.tolerance);
        Self { equation, thickness }
    }

    /// How far off the plane with this normal corners may be by their rounding.
    fn rounding(normal: DVec3, corners: &[DVec3]) -> f64 {
        corners.iter().map(|&p| (normal * p).abs().element_sum()).fold(0.0, f64::max) * THICKNESS
    }

    /// The plane through `at` across an axis. It is exact.
    pub(super) fn across(axis: usize, at: f64) -> Self {
        let mut equation = DVec4::ZERO;
        equation[axis] = 1.0;
        equation.w = -at;
        Self { equation, thickness: 0.0 }
    }

    /// Distance in front of the plane; 0 in it.
    #[inline]
    pub(super) fn side(&self, p: DVec3) -> f64 {
        let e = self.equation;
        let distance = e.x * p.x + e.y * p.y + e.z * p.z + e.w;
        if distance.abs() <= self.thickness { 0.0 } else { distance }
    }
}

/// Where a polygon lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BspSide {
    /// All corners lie in front, or in the plane.
    Front,
    /// All corners lie behind, or in the plane.
    Back,
    /// All corners lie in the plane.
    In,
    /// Corners lie on both sides.
    Across,
}

/// Where a polygon lies by the distances of its corners.
#[inline]
pub(super) fn side_of(plane: &ThickPlane, points: &[DVec3]) -> BspSide {
    let (mut front, mut back) = (false, false);
    for &p in points {
        let d = plane.side(p);
        front |= d > 0.0;
        back |= d < 0.0;
    }
    match (front, back) {
        (true, true) => BspSide::Across,
        (true, false) => BspSide::Front,
        (false, true) => BspSide::Back,
        (false, false) => BspSide::In,
    }
}
