//! Multi-pass transparency: every pass over the geometry lays one more layer, the farthest that is
//! left.
//!
//! Besides the opaque z-buffer there is one more buffer of depths. A pass goes through all
//! transparent facets in any order and keeps, at each sample, the farthest one that is nearer than
//! what has been laid so far; then it is laid over the picture, and its depth becomes the new
//! limit. There are as many passes as layers, and no list is ever sorted. Depth peeling is the same
//! from the other end, from near to far. `visible/peel.rs` goes through the triangles of a tile,
//! `shading/passes.rs` lays what it finds; nothing is kept of earlier passes but their picture, so
//! thousands of layers are only a matter of time. Rays, and the comparison of every facet with
//! every sample, find all layers of a sample at once; for them a pass goes through the pixel's
//! fragments, here.
//!
//! In:   fragments of a pixel. Out: its samples.
//! Cost: n² for n layers; memory: one layer a sample, whatever n is, where passes go through
//!       triangles.
//! Source: \[Mammen 1989\]; from near to far \[Everitt 2001\]. Departs from both: of coincident
//! facets each gets a pass of its own, the lower facet last.

use super::fragment::Fragment;

/// See the module.
pub fn lay(fragments: &[Fragment<'_>], samples: &mut [[f32; 4]]) {
    for (s, below) in samples.iter_mut().enumerate() {
        let mut laid: Option<&Fragment<'_>> = None;
        loop {
            let mut farthest: Option<&Fragment<'_>> = None;
            for fragment in fragments.iter().filter(|f| f.covers(s)) {
                let is_left = laid.is_none_or(|l| fragment.far_to_near(l, s).is_gt());
                if is_left && farthest.is_none_or(|f| fragment.far_to_near(f, s).is_lt()) {
                    farthest = Some(fragment);
                }
            }
            let Some(next) = farthest else { break };
            next.over(below);
            laid = Some(next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::{laid, pane};
    use super::*;

    #[test]
    fn t12_e19_passes_give_what_sorting_gives() {
        let depths = [[0.3], [0.9], [0.5], [0.5], [0.1]];
        let panes: Vec<_> =
            (0..5).map(|i| pane(i as u32, &depths[i], 0.2 * i as f32, 0.3)).collect();
        let expected = laid(super::super::sorted::lay, &panes, 0.4);
        assert_eq!(laid(lay, &panes, 0.4), expected);
        let turned: Vec<_> = panes.iter().rev().copied().collect();
        assert_eq!(laid(lay, &turned, 0.4), expected);
    }
}
