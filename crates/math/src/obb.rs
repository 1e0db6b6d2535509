//! The oriented bounding box: a box that may be turned to fit.
//!
//! Idea: the directions in which points spread most, least and in between are the eigenvectors of
//! their covariance; a long thing lying askew has its length along the first. A box along them is
//! usually smaller than one along the axes, but not always (points crowded in one place pull the
//! directions their way), so both are made and the smaller kept.
//!
//! In:   points in any space.
//! Out:  centre, three perpendicular directions and half lengths; every point is inside.
//! Cost: `O(n)`, three passes over the points.
//! Source: [Gottschalk, Lin & Manocha 1996]; the eigenvectors by Jacobi's rotations,
//! [Golub & Van Loan 1996], section 8.4.
//! Departs from it: covariance of the points themselves, not of their convex hull.

use glam::{DMat3, DVec3};

/// A box in any orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obb {
    /// Its centre.
    pub center: DVec3,
    /// Directions of its edges: a right-handed orthonormal basis, as columns.
    pub axes: DMat3,
    /// Half its edge lengths along the axes.
    pub half: DVec3,
}

impl Obb {
    /// A small box round `points`; points that are not finite are passed over, `None` if there is
    /// no other.
    pub fn from_points(points: &[DVec3]) -> Option<Self> {
        let axis_aligned = Self::along(DMat3::IDENTITY, points)?;
        let turned = Self::along(principal_axes(points), points)?;
        Some(if turned.surface() < axis_aligned.surface() { turned } else { axis_aligned })
    }

    /// The smallest box along `axes` round `points`.
    fn along(axes: DMat3, points: &[DVec3]) -> Option<Self> {
        let to_box = axes.transpose();
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for p in points.iter().filter(|p| p.is_finite()) {
            let q = to_box * *p;
            (min, max) = (min.min(q), max.max(q));
        }
        if min.x > max.x {
            return None;
        }
        // A hair more, for the rounding of going there and back.
        let half = (max - min) * 0.5;
        let slack = 1e-14 * (min.abs().max(max.abs()).max_element() + half.max_element());
        Some(Self { center: axes * ((min + max) * 0.5), axes, half: half + slack })
    }

    /// Whether `p` lies inside or on the boundary.
    pub fn contains(&self, p: DVec3) -> bool {
        (self.axes.transpose() * (p - self.center)).abs().cmple(self.half).all()
    }

    /// The eight corners. Bit 0 of the index chooses the first axis, bit 1 the second, bit 2 the
    /// third.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
            self.center + self.axes * (self.half * DVec3::new(sign(1), sign(2), sign(4)))
        })
    }

    /// Area of the faces: what a ray's chance to hit the box goes with.
    pub fn surface(&self) -> f64 {
        8.0 * (self.half.x * self.half.y + self.half.y * self.half.z + self.half.z * self.half.x)
    }
}

/// The eigenvectors of the points' covariance, as a rotation.
fn principal_axes(points: &[DVec3]) -> DMat3 {
    let finite = || points.iter().filter(|p| p.is_finite());
    let count = finite().count().max(1) as f64;
    let mean = finite().fold(DVec3::ZERO, |s, p| s + *p / count);
    // Scale to the largest offset, so that squares neither overflow nor vanish.
    let reach = finite().fold(0.0f64, |r, p| r.max((*p - mean).abs().max_element()));
    if !(reach > 0.0 && reach.is_finite()) {
        return DMat3::IDENTITY;
    }
    let mut a = [[0.0; 3]; 3];
    for p in finite() {
        let d = ((*p - mean) / reach).to_array();
        for i in 0..3 {
            for j in 0..3 {
                a[i][j] += d[i] * d[j] / count;
            }
        }
    }
    let mut v = DMat3::IDENTITY.to_cols_array_2d();
    for _ in 0..16 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut v, p, q);
        }
    }

    // Make the directions perpendicular to the last bit, and right-handed.
    let x = DVec3::from_array(v[0]).try_normalize().unwrap_or(DVec3::X);
    let y = DVec3::from_array(v[1]);
    let y = (y - x * x.dot(y)).try_normalize().unwrap_or_else(|| x.any_orthonormal_vector());
    DMat3::from_cols(x, y, x.cross(y))
}

/// One Jacobi rotation: makes `a[p][q]` zero and turns the columns `p` and `q` of `v` along.
fn rotate(a: &mut [[f64; 3]; 3], v: &mut [[f64; 3]; 3], p: usize, q: usize) {
    if a[p][q].abs() < 1e-300 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let sign = if theta < 0.0 { -1.0 } else { 1.0 };
    let t = sign / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for k in 0..3 {
        let (akp, akq) = (a[k][p], a[k][q]);
        (a[k][p], a[k][q]) = (c * akp - s * akq, s * akp + c * akq);
    }
    for k in 0..3 {
        let (apk, aqk) = (a[p][k], a[q][k]);
        (a[p][k], a[q][k]) = (c * apk - s * aqk, s * apk + c * aqk);
    }
    for k in 0..3 {
        let (vp, vq) = (v[p][k], v[q][k]);
        (v[p][k], v[q][k]) = (c * vp - s * vq, s * vp + c * vq);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn p13_a_turned_box_is_found_again() {
        let rotation =
            DMat3::from_quat(glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 0.9, -1.3));
        let half = DVec3::new(5.0, 2.0, 1.0);
        let original = Obb { center: DVec3::new(3.0, -7.0, 2.0), axes: rotation, half };
        let found = Obb::from_points(&original.corners()).unwrap();
        assert!(
            (found.surface() - original.surface()).abs() < 1e-9 * original.surface(),
            "{found:?}"
        );
        assert!((found.axes.determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn p13_degenerate_sets_have_a_box_and_empty_ones_have_none() {
        assert_eq!(Obb::from_points(&[]), None);
        assert_eq!(Obb::from_points(&[DVec3::NAN, DVec3::INFINITY]), None);
        let one = Obb::from_points(&[DVec3::ONE; 3]).unwrap();
        assert!(one.contains(DVec3::ONE) && one.half.max_element() < 1e-12);
        let line = Obb::from_points(&[DVec3::ZERO, DVec3::ONE]).unwrap();
        assert!(line.half.min_element() < 1e-12 && line.surface() < 1e-9);
    }

    proptest! {
        #[test]
        fn p13_an_obb_contains_all_its_points_and_is_no_larger_than_the_aabb(
            points in prop::collection::vec(prop::array::uniform3(-1e3f64..1e3), 1..40), scale in -12i32..12,
        ) {
            let factor = (0..scale.abs()).fold(1.0, |f, _| if scale < 0 { f / 10.0 } else { f * 10.0 });
            let points: Vec<DVec3> = points.into_iter().map(|p| DVec3::from_array(p) * factor).collect();
            let obb = Obb::from_points(&points).unwrap();
            let aabb = crate::Aabb::from_points(points.iter().copied());
            let size = aabb.size();
            let surface = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
            prop_assert!(points.iter().all(|&p| obb.contains(p) && aabb.contains(p)));
            prop_assert!(obb.surface() <= surface * (1.0 + 1e-9) + 1e-9 * factor * factor);
        }
    }
}
