//! A small sphere round points.
//!
//! Idea: walk from any point to the farthest, and from there to the farthest again: these two are
//! nearly a diameter. Take the sphere on it and grow it for every point outside, just enough to
//! hold what it held before. A second candidate is the sphere round the middle of the axis-aligned
//! box; the smaller of the two is kept.
//!
//! In:   points in any space.
//! Out:  a sphere that holds them all, usually within 5 % of the smallest.
//! Cost: `O(n)`, five passes.
//! Source: [Ritter 1990].

use crate::{Aabb, Sphere};
use glam::DVec3;

impl Sphere {
    /// A small sphere round `points`; points that are not finite are passed over, `None` if there
    /// is no other.
    pub fn from_points(points: &[DVec3]) -> Option<Self> {
        let finite = || points.iter().copied().filter(|p| p.is_finite());
        let farthest = |from: DVec3| {
            finite().fold((0.0, from), |best, p| {
                let d = p.distance_squared(from);
                if d > best.0 { (d, p) } else { best }
            })
        };

        // Ritter's sphere: an approximate diameter, grown point by point.
        let a = farthest(finite().next()?).1;
        let b = farthest(a).1;
        let (mut center, mut radius) = ((a + b) * 0.5, a.distance(b) * 0.5);
        for p in finite() {
            let distance = p.distance(center);
            if distance > radius {
                radius = (radius + distance) * 0.5;
                center += (p - center) * ((distance - radius) / distance);
            }
        }

        // Measure both candidates once more: rounding may have left a point outside by a hair.
        let round =
            |center: DVec3| Self { center, radius: farthest(center).0.sqrt() * (1.0 + 1e-15) };
        let (ritter, boxed) = (round(center), round(Aabb::from_points(finite()).center()));
        Some(if boxed.radius < ritter.radius { boxed } else { ritter })
    }

    /// Whether `p` lies inside or on the boundary.
    pub fn contains(&self, p: DVec3) -> bool {
        p.distance(self.center) <= self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn p13_two_points_and_a_cube_have_their_smallest_sphere() {
        let pair =
            Sphere::from_points(&[DVec3::ZERO, DVec3::new(6.0, 0.0, 0.0), DVec3::NAN]).unwrap();
        assert!((pair.radius - 3.0).abs() < 1e-12 && pair.center == DVec3::new(3.0, 0.0, 0.0));
        let cube = Aabb { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };
        let sphere = Sphere::from_points(&cube.corners()).unwrap();
        assert!((sphere.radius - 3f64.sqrt()).abs() < 1e-12);
        assert_eq!(Sphere::from_points(&[]), None);
        assert_eq!(Sphere::from_points(&[DVec3::ONE]).unwrap().radius, 0.0);
    }

    proptest! {
        #[test]
        fn p13_a_sphere_contains_all_its_points_and_is_not_large(
            points in prop::collection::vec(prop::array::uniform3(-1e3f64..1e3), 1..60),
        ) {
            let points: Vec<DVec3> = points.into_iter().map(DVec3::from_array).collect();
            let sphere = Sphere::from_points(&points).unwrap();
            prop_assert!(points.iter().all(|&p| sphere.contains(p)));
            let diagonal = Aabb::from_points(points.iter().copied()).diagonal();
            prop_assert!(sphere.radius <= diagonal * 0.5 * (1.0 + 1e-12));
        }
    }
}
