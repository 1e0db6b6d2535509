//! A facet in a pixel, and how it is laid over what is behind it.

use std::cmp::Ordering;

/// Most samples a pixel.
pub const MOST_SAMPLES: usize = 32;

/// Lays a pixel's fragments, in the order of the scene, over the colours of its samples.
pub type Lay = fn(fragments: &[Fragment<'_>], samples: &mut [[f32; 4]]);

/// A facet in a pixel, in front of what is opaque there.
#[derive(Clone, Copy, Debug)]
pub struct Fragment<'a> {
    /// The facet; of equal depths the lower one is in front.
    pub facet: u32,
    /// The samples that it covers, one bit each.
    pub mask: u32,
    /// Its depth at each of them, 1 near.
    pub depths: &'a [f32],
    /// The farthest of these.
    pub far: f32,
    /// The nearest of these.
    pub near: f32,
    /// Its own light, premultiplied, and its opacity.
    pub color: [f32; 4],
    /// The part of the light from behind that passes.
    pub passes: [f32; 3],
    /// What is behind it in place of what the pixel holds, premultiplied: blurred, for a
    /// translucent surface.
    pub behind: Option<[f32; 4]>,
}

/// The farthest and the nearest of depths.
pub(crate) fn range(depths: &[f32]) -> [f32; 2] {
    depths.iter().fold([f32::MAX, f32::MIN], |[far, near], &depth| {
        [if depth < far { depth } else { far }, if depth > near { depth } else { near }]
    })
}

impl<'a> Fragment<'a> {
    /// A fragment of `facet` at the samples `mask`, with its depth at each of them; nothing is
    /// known of the colour behind it.
    pub fn new(
        facet: u32,
        (mask, depths): (u32, &'a [f32]),
        color: [f32; 4],
        passes: [f32; 3],
    ) -> Self {
        let [far, near] = range(depths);
        Self { facet, mask, depths, far, near, color, passes, behind: None }
    }
}

impl Fragment<'_> {
    /// Whether it covers a sample.
    #[inline]
    pub fn covers(&self, sample: usize) -> bool {
        self.mask >> sample & 1 == 1
    }

    /// Depth at a sample that it covers.
    #[inline]
    pub fn depth(&self, sample: usize) -> f32 {
        let before = self.mask & ((1u32 << sample) - 1);
        self.depths[before.count_ones() as usize]
    }

    /// Whether nothing can be seen through it.
    pub fn is_opaque(&self) -> bool {
        self.color[3] >= 1.0 && self.passes == [0.0; 3]
    }

    /// Lays it over a colour: `I = I1 + t I2`, both premultiplied.
    #[inline]
    pub fn over(&self, below: &mut [f32; 4]) {
        let behind = self.behind.unwrap_or(*below);
        let [r, g, b] = self.passes;
        let passes = [r, g, b, 1.0 - self.color[3]];
        *below = std::array::from_fn(|k| self.color[k] + passes[k] * behind[k]);
    }

    /// Lays it over all samples that it covers.
    #[inline]
    pub(super) fn over_all(&self, samples: &mut [[f32; 4]]) {
        let mut mask = self.mask;
        while mask != 0 {
            self.over(&mut samples[mask.trailing_zeros() as usize]);
            mask &= mask - 1;
        }
    }

    /// From far to near at a sample that both cover.
    #[inline]
    pub(super) fn far_to_near(&self, other: &Self, sample: usize) -> Ordering {
        self.depth(sample).total_cmp(&other.depth(sample)).then(other.facet.cmp(&self.facet))
    }
}

/// The fragments that cover `sample`, in the order of the scene, without the ones that an opaque
/// one hides (cut-outs, lines), and the nearest opaque one, which is behind them. For the orders
/// that know nothing but one transparent buffer.
pub(super) fn in_front_of_opaque<'f, 'a>(
    fragments: &'f [Fragment<'a>],
    sample: usize,
) -> (impl Iterator<Item = &'f Fragment<'a>> + use<'f, 'a>, Option<&'f Fragment<'a>>) {
    let here = move |f: &&Fragment<'_>| f.covers(sample);
    let opaque = fragments.iter().filter(here).filter(|f| f.is_opaque());
    let nearest = opaque.max_by(|a, b| a.far_to_near(b, sample));
    let hidden = move |f: &Fragment<'_>| {
        nearest.is_some_and(|n| f.far_to_near(n, sample) != Ordering::Greater)
    };
    (fragments.iter().filter(here).filter(move |f| !hidden(f)), nearest)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A grey pane with transmission `kt` that covers one sample.
    pub(crate) fn pane(facet: u32, depth: &[f32], grey: f32, kt: f32) -> Fragment<'_> {
        let own = grey * (1.0 - kt);
        Fragment::new(facet, (1, depth), [own, own, own, 1.0 - kt], [kt; 3])
    }

    /// What an order makes of fragments over grey in one sample.
    pub(crate) fn laid(lay: Lay, fragments: &[Fragment<'_>], background: f32) -> f32 {
        let mut samples = [[background, background, background, 1.0]];
        lay(fragments, &mut samples);
        assert!((samples[0][3] - 1.0).abs() < 1e-6, "opaque stays opaque");
        samples[0][0]
    }

    #[test]
    fn opaque_fragments_hide_what_is_behind() {
        let fragments =
            [pane(0, &[0.2], 1.0, 0.5), pane(1, &[0.5], 0.3, 0.0), pane(2, &[0.7], 1.0, 0.5)];
        let (seen, nearest) = in_front_of_opaque(&fragments, 0);
        let seen: Vec<_> = seen.map(|f| f.facet).collect();
        assert_eq!((seen, nearest.map(|f| f.color)), (vec![2], Some([0.3, 0.3, 0.3, 1.0])));
    }
}
