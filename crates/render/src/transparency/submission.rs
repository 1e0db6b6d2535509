//! Transparency in a plain z-buffer: facets are blended in the order in which they come. Wrong, and
//! shown for that.
//!
//! Opaque surfaces are drawn first. Then each transparent facet passes the depth test, is laid over
//! the pixel, and leaves its depth there. A facet that comes after a nearer one is lost: what is
//! seen through glass depends on the order of the scene. One layer, or layers that happen to come
//! from far to near, are right.
//!
//! In:   fragments of a pixel in the order of the scene. Out: its samples.
//! Cost: linear, no memory.
//! Source: \[Catmull 1974\] for the z-buffer; the defect is T11 of docs/course.md.

use super::fragment::{Fragment, in_front_of_opaque};

/// See the module.
pub fn lay(fragments: &[Fragment<'_>], samples: &mut [[f32; 4]]) {
    for (s, below) in samples.iter_mut().enumerate() {
        let mut nearest: Option<&Fragment<'_>> = None;
        let (seen, opaque) = in_front_of_opaque(fragments, s);
        let mut color = opaque.map_or(*below, |opaque| opaque.color);
        for fragment in seen {
            // A hole cut out by a texture is no surface: it leaves no depth.
            let is_hole = fragment.color == [0.0; 4] && fragment.passes == [1.0; 3];
            if !is_hole && nearest.is_none_or(|n| fragment.far_to_near(n, s).is_gt()) {
                fragment.over(&mut color);
                nearest = Some(fragment);
            }
        }
        *below = color;
    }
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::{laid, pane};
    use super::*;

    #[test]
    fn t11_the_order_of_submission_shows() {
        let (near, far) = (pane(0, &[0.9], 0.8, 0.25), pane(1, &[0.4], 0.6, 0.5));
        let exact = 0.75 * 0.8 + 0.25 * (0.5 * 0.6 + 0.5 * 0.2);
        assert!(
            (laid(lay, &[far, near], 0.2) - exact).abs() < 1e-6,
            "from far to near it is right"
        );
        let lost = 0.75 * 0.8 + 0.25 * 0.2;
        assert!((laid(lay, &[near, far], 0.2) - lost).abs() < 1e-6, "the far pane is lost");
    }
}
