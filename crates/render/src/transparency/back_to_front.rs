//! Back to front in the order of a list: what the painter's algorithm and the BSP tree do with
//! transparent polygons.
//!
//! A list of polygons from back to front is all that transparency needs. Each polygon is drawn when
//! its turn comes, and each of its fragments is mixed with what the pixel holds by then:
//! `I = (1 - kt) I1 + kt I2`, where `I1` is the fragment and `I2` the pixel. That no depth is
//! compared, here least of all, is the point: polygons that overlap each other in a circle, or
//! meet, were cut when the list was made, so that there is an order of their pieces. Two pieces of
//! one facet in a pixel are two fragments with a colour in common. They are cut along planes of the
//! world; at samples within 1/256 pixel of the line where two surfaces meet, the depth function may
//! contradict that. There `shading/listed.rs` has moved the fragment before it comes here, as the
//! drawing of opaque lists does, and counted it.
//!
//! Transparent polygons take part in the list with the opaque ones; those that lie behind an opaque
//! surface are left out as everywhere (`visible/priority_list.rs`). Lines and points of the model
//! are no polygons and have no place in a list: each is put in front of the last fragment that is
//! farther than it, sample by sample.
//!
//! In:   fragments of a pixel in the order of the list. Out: its samples.
//! Cost: linear, no memory; the list costs what it costs.
//! Source: \[Newell, Newell & Sancha 1972\]; the tree's list is that of \[Fuchs, Kedem & Naylor
//!         1980\].

use super::fragment::Fragment;

/// See the module.
pub fn lay(fragments: &[Fragment<'_>], samples: &mut [[f32; 4]]) {
    fragments.iter().for_each(|fragment| fragment.over_all(samples));
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::{laid, pane};
    use super::*;

    #[test]
    fn t10_the_list_alone_decides() {
        let (far, near) = (pane(0, &[0.4], 0.6, 0.5), pane(1, &[0.9], 0.8, 0.25));
        let exact = 0.75 * 0.8 + 0.25 * (0.5 * 0.6 + 0.5 * 0.2);
        assert!((laid(lay, &[far, near], 0.2) - exact).abs() < 1e-6);
        // Depths are not looked at: a wrong list shows.
        let turned = 0.5 * 0.6 + 0.5 * (0.75 * 0.8 + 0.25 * 0.2);
        assert!((laid(lay, &[near, far], 0.2) - turned).abs() < 1e-6);
    }

    #[test]
    fn pieces_of_one_facet_come_at_different_times() {
        // A facet that another one crosses within the pixel: half of it comes before, half after.
        let piece = |facet, mask, red: f32| {
            Fragment::new(facet, (mask, &[0.5; 4]), [red * 0.5, 0.0, 0.0, 0.5], [0.5; 3])
        };
        let mut samples = [[0.0, 0.0, 0.0, 1.0]; 4];
        lay(&[piece(0, 0b0011, 1.0), piece(1, 0b1111, 0.0), piece(0, 0b1100, 1.0)], &mut samples);
        assert_eq!(samples.map(|s| s[0]), [0.25, 0.25, 0.5, 0.5]);
    }
}
