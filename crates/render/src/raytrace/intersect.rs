//! Watertight intersection of a ray with a triangle.
//!
//! The triangle is moved so that the ray starts at the origin, its axes are renamed so that the ray
//! runs mostly along z, and it is sheared so that the ray *is* the z axis. Whether the ray hits is
//! then a question in the plane: is the origin inside the triangle? Three edge functions answer it,
//! and since an edge that two triangles share gives both the same number with opposite signs, no
//! ray slips between them. Where one is so small that rounding may have decided its sign, they are
//! computed again in double precision, which gets signs right.
//!
//! In:   a ray and three corners in one space. Out: the ray's parameter at the hit.
//! Cost: some 40 operations; the shear is computed once for each ray.
//! Source: [Woop, Benthin & Wald 2013]. Departs from it: both sides of a triangle are hit.

use vitral_math::Vec3;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Mask8, Simd};

/// A ray from `origin` along `direction` (any length but 0), made ready for intersection.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Where it goes; the parameter of a hit counts in lengths of this vector.
    pub direction: Vec3,
    pub(super) axes: [usize; 3],
    pub(super) shear: Vec3,
}

impl Ray {
    /// Renames the axes and finds the shear.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        // The z axis becomes the one along which the ray runs most; x and y keep the winding of
        // triangles.
        let a = direction.abs();
        let z = if a.x >= a.y && a.x >= a.z { 0 } else { 2 - usize::from(a.y >= a.z) };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if direction[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let shear =
            Vec3::new(direction[x] / direction[z], direction[y] / direction[z], 1.0 / direction[z]);
        Self { origin, direction, axes: [x, y, z], shear }
    }

    /// What rounding may do to the parameter of a hit in a space of half-width `extent`.
    pub(crate) fn rounding(&self, extent: f32) -> f32 {
        let reach = self.origin.abs().max_element() + extent;
        reach / self.direction.abs().max_element() * (1.0 / (1 << 19) as f32)
    }

    /// The parameter, not negative, at which the ray meets the triangle.
    #[inline]
    pub fn hit(&self, corners: &[Vec3; 3]) -> Option<f32> {
        // Bring the corners into the ray's space.
        let [x, y, z] = self.axes;
        let place = |p: Vec3| {
            // Four numbers and two bits of an index: nothing needs to be checked.
            let p = (p - self.origin).extend(0.0).to_array();
            let (x, y, z) = (x & 3, y & 3, z & 3);
            [p[x] - self.shear.x * p[z], p[y] - self.shear.y * p[z], self.shear.z * p[z]]
        };
        let (a, b, c) = (place(corners[0]), place(corners[1]), place(corners[2]));

        // Ask each edge on which side the origin lies. What rounding may have decided deserves a
        // closer look.
        let [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
        let (least, largest) = (smaller(smaller(u, v), w), larger(larger(u, v), w));
        if least < 0.0 && largest > 0.0 {
            let size = |p: [f32; 3]| larger(p[0].abs(), p[1].abs());
            let size = larger(larger(size(a), size(b)), size(c));
            if smaller(-least, largest) > size * size * ROUNDING {
                return None;
            }
        }
        let [u, v, w] = [precise_edge(c, b), precise_edge(a, c), precise_edge(b, a)];
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let determinant = u + v + w;
        if determinant == 0.0 {
            return None;
        }

        // The corners' distances, weighted by the opposite areas, are the distance of the hit. Of a
        // needle the areas are small differences of large products: rounded ones would move the hit
        // by more than the boxes round triangles allow for.
        let t = (u * f64::from(a[2]) + v * f64::from(b[2]) + w * f64::from(c[2])) / determinant;
        (t >= 0.0).then_some(t as f32)
    }
}

/// Three roundings of an edge function, as a part of the square of the largest coordinate: 2 of
/// half a unit for the products, and one for a difference of at most twice that square.
const ROUNDING: f32 = 2.0 * f32::EPSILON;

// With comparisons, since `f32::min` and `f32::max` take several instructions for the sake of NaN.
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Doubled area of the triangle from the origin to `p` and `q`.
fn edge(p: [f32; 3], q: [f32; 3]) -> f32 {
    p[0] * q[1] - p[1] * q[0]
}

/// What [`Ray::hit`] finds before it looks closer, in lanes: where the ray passes beside the
/// triangle without doubt, given where the corners are, sheared, from the ray.
#[inline(always)]
pub(super) fn surely_beside<S: Simd>(
    a: [F32x8<S>; 2],
    b: [F32x8<S>; 2],
    c: [F32x8<S>; 2],
) -> Mask8<S> {
    let edge = lanes::inlined(
        #[inline(always)]
        |p: [F32x8<S>; 2], q: [F32x8<S>; 2]| p[0] * q[1] - p[1] * q[0],
    );
    let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
    let (least, largest) = (
        lanes::Lanes::min(lanes::Lanes::min(u, v), w),
        lanes::Lanes::max(lanes::Lanes::max(u, v), w),
    );
    let size = lanes::inlined(
        #[inline(always)]
        |p: [F32x8<S>; 2]| lanes::Lanes::max(lanes::Lanes::abs(p[0]), lanes::Lanes::abs(p[1])),
    );
    let size = lanes::Lanes::max(lanes::Lanes::max(size(a), size(b)), size(c));
    lanes::Lanes::min(-least, largest).simd_gt(size * size * ROUNDING)
}

/// [`edge`], whose sign is right: products of two `f32` are exact in `f64`.
fn precise_edge(p: [f32; 3], q: [f32; 3]) -> f64 {
    f64::from(p[0]) * f64::from(q[1]) - f64::from(p[1]) * f64::from(q[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::vec3;

    #[test]
    fn the_parameter_is_the_distance_in_lengths_of_the_direction() {
        let triangle = [vec3(-1.0, -1.0, 3.0), vec3(2.0, -1.0, 3.0), vec3(-1.0, 2.0, 3.0)];
        for swap in [false, true] {
            let [a, b, c] = triangle;
            let triangle = if swap { [a, c, b] } else { triangle };
            assert_eq!(
                Ray::new(vec3(0.0, 0.0, 1.0), vec3(0.0, 0.0, 0.5)).hit(&triangle),
                Some(4.0)
            );
            assert_eq!(
                Ray::new(vec3(0.0, 0.0, 1.0), vec3(0.0, 0.0, -1.0)).hit(&triangle),
                None,
                "behind"
            );
            assert_eq!(
                Ray::new(vec3(3.0, 0.0, 1.0), vec3(0.0, 0.0, 1.0)).hit(&triangle),
                None,
                "beside"
            );
        }
    }

    #[test]
    fn no_ray_slips_between_two_triangles() {
        // A fan round a vertex that rays are aimed at, and at points of the edges.
        let center = vec3(0.137, 0.291, 1.1);
        let rim: Vec<Vec3> = (0..7)
            .map(|i| {
                let (sin, cos) =
                    vitral_math::func::sin_cos(f64::from(i) * std::f64::consts::TAU / 7.0);
                center + vec3(cos as f32 * 5.3, sin as f32 * 6.1, 0.3 * i as f32)
            })
            .collect();
        let origin = vec3(0.1, -0.2, -9.0);
        for (i, &p) in rim.iter().enumerate() {
            for step in 0..50 {
                let target = center + (p - center) * (step as f32 / 60.0);
                let ray = Ray::new(origin, target - origin);
                let hits = (0..7)
                    .filter(|j| ray.hit(&[center, rim[*j], rim[(j + 1) % 7]]).is_some())
                    .count();
                assert!(hits >= 1, "edge {i}, step {step}");
            }
        }
    }

    #[test]
    fn a_needle_is_hit_where_the_ray_is_in_its_plane() {
        // From a model: 0.71 wide, 1520 long. The ray reaches its plane, y = 77.05, at 0.77913.
        let needle = [
            vec3(115.03, 77.05, -1023.725),
            vec3(115.74, 77.05, 496.41498),
            vec3(115.74, 77.05, -1023.725),
        ];
        let (origin, direction) =
            (vec3(1146.2803, -1215.408, 1492.9237), vec3(-1322.7184, 1658.8336, -2134.9873));
        let t = Ray::new(origin, direction).hit(&needle).unwrap();
        let expected = (77.05 - f64::from(origin.y)) / f64::from(direction.y);
        assert!((f64::from(t) - expected).abs() < 1e-6, "{t} {expected}");
    }

    #[test]
    fn a_triangle_without_area_is_never_hit() {
        let p = vec3(0.0, 0.0, 1.0);
        assert_eq!(Ray::new(Vec3::ZERO, Vec3::Z).hit(&[p, p, p]), None);
    }
}
