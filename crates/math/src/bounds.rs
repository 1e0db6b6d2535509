//! Bounding volumes: the axis-aligned box and the sphere.
//!
//! An empty box has `min > max` in every axis; it is the neutral element of [`Aabb::union`].

use glam::{DMat4, DVec3};

/// An axis-aligned box, closed on all sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The corner with the smallest coordinates.
    pub min: DVec3,
    /// The corner with the largest coordinates.
    pub max: DVec3,
}

impl Default for Aabb {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Aabb {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box round `points`. Points with a NaN or infinite coordinate are passed over.
    pub fn from_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        let mut bounds = Self::EMPTY;
        for p in points {
            if p.is_finite() {
                bounds.include(p);
            }
        }
        bounds
    }

    /// Grows the box to hold `p`.
    pub fn include(&mut self, p: DVec3) {
        self.min = self.min.min(p);
        self.max = self.max.max(p);
    }

    /// The smallest box round both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the box holds no point.
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x || self.min.y > self.max.y || self.min.z > self.max.z
    }

    /// Its centre; the origin for an empty box.
    pub fn center(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { (self.min + self.max) * 0.5 }
    }

    /// Edge lengths; zero for an empty box.
    pub fn size(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { self.max - self.min }
    }

    /// Length of the diagonal; zero for an empty box.
    pub fn diagonal(&self) -> f64 {
        self.size().length()
    }

    /// The eight corners. Bit 0 of the index chooses x, bit 1 y, bit 2 z; set means `max`.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            DVec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }

    /// The axis-aligned box round this box after an affine transform.
    #[must_use]
    pub fn transformed(&self, to_from_here: &DMat4) -> Self {
        if self.is_empty() {
            *self
        } else {
            Self::from_points(self.corners().map(|c| to_from_here.transform_point3(c)))
        }
    }

    /// Whether `p` lies inside or on the boundary.
    pub fn contains(&self, p: DVec3) -> bool {
        self.min.cmple(p).all() && p.cmple(self.max).all()
    }

    /// The sphere round the box.
    pub fn bounding_sphere(&self) -> Sphere {
        Sphere { center: self.center(), radius: self.diagonal() * 0.5 }
    }
}

/// A sphere by its centre and radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub center: DVec3,
    /// Radius, not negative.
    pub radius: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_holds_its_points_and_passes_over_nan() {
        let b = Aabb::from_points([
            DVec3::ZERO,
            DVec3::new(f64::NAN, 0.0, 0.0),
            DVec3::new(1.0, 2.0, 3.0),
        ]);
        assert_eq!((b.min, b.max), (DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)));
        assert!(b.corners().iter().all(|&c| b.contains(c)));
        assert!(Aabb::EMPTY.is_empty() && Aabb::EMPTY.diagonal() == 0.0);
        assert_eq!(Aabb::EMPTY.union(&b), b);
    }
}
