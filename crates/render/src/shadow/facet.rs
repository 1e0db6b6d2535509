//! A facet in the world: its corners and normal as rays see them, and the way between points and
//! barycentric weights.

use crate::prepare::mirrors;
use vitral_math::{DVec3, Vec3};
use vitral_scene::Instance;

/// The corners of an instance's triangle, world space less `center`, as the rays' triangles have
/// them, and its unit normal on the side from which they run counter-clockwise in the model; zero
/// without area.
pub(crate) fn facet(instance: &Instance, triangle: u32, center: DVec3) -> ([DVec3; 3], DVec3) {
    let corners = instance.corners(triangle).map(|p| (p - center).as_vec3().as_dvec3());
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
    (corners, if mirrors(&instance.world_from_model) { -normal } else { normal })
}

/// The point with these weights of the corners.
pub(crate) fn weighted(corners: &[DVec3; 3], weights: [f32; 3]) -> DVec3 {
    let w = weights.map(f64::from);
    (corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2]) / (w[0] + w[1] + w[2])
}

/// Barycentric coordinates of a point in a triangle's plane.
pub(crate) fn weights(corners: &[Vec3; 3], point: DVec3) -> [f32; 3] {
    let (a, b, c) = (corners[0].as_dvec3(), corners[1].as_dvec3(), corners[2].as_dvec3());
    let normal = (b - a).cross(c - a);
    let whole = normal.length_squared();
    if whole == 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let at = |p: DVec3, q: DVec3| ((p - point).cross(q - point).dot(normal) / whole) as f32;
    [at(b, c), at(c, a), at(a, b)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::{dvec3, vec3};

    #[test]
    fn weights_bring_the_point_back() {
        let corners = [vec3(1.0, 0.0, 2.0), vec3(4.0, 1.0, 2.0), vec3(1.0, 3.0, 5.0)];
        let p = corners[0] * 0.5 + corners[1] * 0.25 + corners[2] * 0.25;
        let w = weights(&corners, p.as_dvec3());
        assert!(
            (w[0] - 0.5).abs() < 1e-6 && (w[1] - 0.25).abs() < 1e-6 && (w[2] - 0.25).abs() < 1e-6,
            "{w:?}"
        );
        assert_eq!(weights(&[Vec3::ONE; 3], dvec3(1.0, 1.0, 1.0)), [1.0, 0.0, 0.0]);
    }
}
