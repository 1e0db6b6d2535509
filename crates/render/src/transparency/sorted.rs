//! Back to front at each sample: the definition of recursive transparency, the reference of the
//! other orders.
//!
//! The facets in front of a sample are sorted by depth there, then laid over each other from far to
//! near. It is what the painter's algorithm and the BSP tree do with transparent polygons, fragment
//! over pixel, without their having to cut polygons to find an order.
//!
//! In:   fragments of a pixel. Out: its samples.
//! Cost: n log n for n layers, at each sample.
//! Source: \[Newell, Newell & Sancha 1972\].

use super::fragment::Fragment;

/// See the module.
pub fn lay(fragments: &[Fragment<'_>], samples: &mut [[f32; 4]]) {
    let mut here: Vec<&Fragment<'_>> = Vec::with_capacity(fragments.len());
    for (s, below) in samples.iter_mut().enumerate() {
        here.clear();
        here.extend(fragments.iter().filter(|f| f.covers(s)));
        here.sort_unstable_by(|a, b| a.far_to_near(b, s));
        for fragment in &here {
            fragment.over(below);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::{laid, pane};
    use super::*;

    #[test]
    fn t7_f4_e2_the_recursion_goes_on_for_any_kt() {
        // I = (1 - k1) I1 + k1 ((1 - k2) I2 + k2 I3), nearest first, in any order of submission.
        let (near, far) = (pane(0, &[0.9], 0.8, 0.25), pane(1, &[0.4], 0.6, 0.5));
        let expected = 0.75 * 0.8 + 0.25 * (0.5 * 0.6 + 0.5 * 0.2);
        assert!((laid(lay, &[near, far], 0.2) - expected).abs() < 1e-6);
        assert!((laid(lay, &[far, near], 0.2) - expected).abs() < 1e-6);
    }

    #[test]
    fn of_equal_depths_the_lower_facet_is_in_front() {
        let (a, b) = (pane(0, &[0.5], 1.0, 0.5), pane(1, &[0.5], 0.0, 0.5));
        assert_eq!(laid(lay, &[a, b], 0.0), 0.5);
    }
}
