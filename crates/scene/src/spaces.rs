//! The perspective transformation: from view space to a space in which projectors are parallel.
//!
//! Idea: two points in view space are on one projector if `x1/z1 = x2/z2` and `y1/z1 = y2/z2`: four
//! divisions for every pair. Divide each point by its depth once, before any comparison, and the
//! test is `x1 = x2` and `y1 = y2`. The transformation keeps lines lines and planes planes and the
//! order of depths, so hidden surfaces may be found after it.
//!
//! In:   points in view space in front of the eye.
//! Out:  points in ndc: x and y in `-1..=1` inside the picture, z from 0 (far plane) to 1 (near
//!       plane).
//! Cost: three divisions a point, none a pair.
//! Source: the course, notes P (docs/course.md P8, P9); [Foley et al. 1990], section 15.2.2.

use crate::ViewTransform;
use vitral_math::DVec3;

/// Whether two points in view space lie on one projector of a perspective with its centre in the
/// origin: by division, up to `tolerance` in the quotients. False for points in the plane of the
/// eye.
pub fn share_projector_in_view(p: DVec3, q: DVec3, tolerance: f64) -> bool {
    (p.x / p.z - q.x / q.z).abs() <= tolerance && (p.y / p.z - q.y / q.z).abs() <= tolerance
}

/// Whether two points in ndc lie on one projector: by comparison, up to `tolerance`. Also right for
/// parallel views.
pub fn share_projector_in_ndc(p: DVec3, q: DVec3, tolerance: f64) -> bool {
    (p.x - q.x).abs() <= tolerance && (p.y - q.y).abs() <= tolerance
}

impl ViewTransform {
    /// A point of view space in ndc; not finite for points in the plane of the eye.
    pub fn ndc_from_view(&self, p: DVec3) -> DVec3 {
        let clip = self.clip_from_view * p.extend(1.0);
        clip.truncate() / clip.w
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Camera, Projection};
    use proptest::prelude::*;
    use vitral_math::DMat3;

    fn transform(perspective: bool) -> ViewTransform {
        let projection = if perspective {
            Projection::Perspective { view_angle: 1.2 }
        } else {
            Projection::Parallel { height: 30.0 }
        };
        let (position, focal_point) = (DVec3::ZERO, DVec3::NEG_Z);
        Camera { position, focal_point, view_up: DVec3::Y, projection, clip: Some((1.0, 50.0)) }
            .transform(1.5, (0.0, 0.0))
    }

    fn point() -> impl Strategy<Value = DVec3> {
        (-20.0f64..20.0, -20.0f64..20.0, -50.0f64..-1.0).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    #[test]
    fn p9_depth_is_zero_at_the_back_and_one_in_front() {
        for view in [transform(true), transform(false)] {
            let depth = |z: f64| view.ndc_from_view(DVec3::new(0.5, -0.5, z)).z;
            assert!((depth(-50.0)).abs() < 1e-12 && (depth(-1.0) - 1.0).abs() < 1e-12);
            assert!(depth(-60.0) < 0.0 && depth(-0.5) > 1.0, "signs beyond the planes");
            assert!(depth(-2.0) > depth(-3.0), "nearer is larger");
        }
    }

    proptest! {
        #[test]
        fn p8_both_tests_agree_on_points_of_one_projector(p in point(), s in 0.1f64..3.0) {
            let view = transform(true);
            prop_assert!(share_projector_in_view(p, p * s, 1e-12 * (1.0 + p.length())));
            prop_assert!(share_projector_in_ndc(view.ndc_from_view(p), view.ndc_from_view(p * s), 1e-9));
        }

        #[test]
        fn p8_both_tests_agree_on_any_two_points(p in point(), q in point(), towards in 0.0f64..1.0) {
            // Move q towards the projector of p, so that near misses are tried as well. With both
            // tolerances as one through the focal length, the answers differ only within rounding
            // of the tolerance.
            let view = transform(true);
            let q = q + (p * (q.z / p.z) - q) * towards;
            let (sx, sy) = (view.clip_from_view.x_axis.x, view.clip_from_view.y_axis.y);
            for tolerance in [1e-6, 1e-3, 0.1] {
                let (dx, dy) = ((p.x / p.z - q.x / q.z).abs(), (p.y / p.z - q.y / q.z).abs());
                prop_assume!((dx - tolerance).abs() > 1e-9 && (dy - tolerance).abs() > 1e-9);
                let (a, b) = (view.ndc_from_view(p), view.ndc_from_view(q));
                let scaled = |n: DVec3| DVec3::new(n.x / sx, n.y / sy, n.z);
                prop_assert_eq!(
                    share_projector_in_view(p, q, tolerance),
                    share_projector_in_ndc(scaled(a), scaled(b), tolerance)
                );
            }
        }

        #[test]
        fn p8_lines_stay_lines_and_planes_stay_planes(
            a in point(), b in point(), c in point(), s in 0.0f64..1.0, t in 0.0f64..1.0, perspective: bool,
        ) {
            let view = transform(perspective);
            let on_line = view.ndc_from_view(a + (b - a) * s);
            let on_plane = view.ndc_from_view(a + (b - a) * s + (c - a) * (t * (1.0 - s)));
            let [a, b, c] = [a, b, c].map(|p| view.ndc_from_view(p));
            let scale = 1.0 + a.length() + b.length() + c.length();
            prop_assert!((on_line - a).cross(b - a).length() < 1e-9 * scale * scale);
            let volume = DMat3::from_cols(b - a, c - a, on_plane - a).determinant();
            prop_assert!(volume.abs() < 1e-9 * scale * scale * scale);
        }

        #[test]
        fn p9_what_is_nearer_along_a_projector_has_the_larger_depth(p in point(), s in 1.001f64..3.0) {
            let view = transform(true);
            prop_assert!(view.ndc_from_view(p).z > view.ndc_from_view(p * s).z);
        }
    }
}
