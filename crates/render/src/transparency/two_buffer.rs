//! The two-buffer z-buffer of the course notes: opaque surfaces in one buffer, all transparent ones
//! together in another.
//!
//! First the opaque surfaces are drawn; transparent ones go to a list. Then each of these that is
//! nearer than the z-buffer is added to a second buffer with a coefficient and an intensity, in the
//! order of the list: `k' = 1 - (1 - k) (1 - kc)`, `I' = k I + kc Ic`, with `kc = 1 - kt` of the
//! surface. At last the two are combined, `I + (1 - k) I_opaque`. There is no sorting, and depths
//! of transparent surfaces are not kept. One layer is exact. Beyond that the order of the list
//! shows, and what was there before is weighed once more with its own coefficient: two layers give
//! `k1² I1 + k2 I2 + (1 - k1) (1 - k2) I_opaque` (docs/course.md, E3).
//!
//! In:   fragments of a pixel in the order of the scene. Out: its samples.
//! Cost: linear; memory: one colour and coefficient a sample.
//! Source: course notes F; \[Foley et al. 1990\], 16.5.1. The notes' `f` is left open; here it is
//!         that of two filters.

use super::fragment::{Fragment, in_front_of_opaque};

/// What is behind the transparent surfaces of a sample: the first buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Behind {
    /// Its colour, premultiplied.
    pub color: [f32; 4],
    /// Its depth, if one of the fragments is opaque and took the place of what was there.
    pub depth: Option<f32>,
}

/// The buffers of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filled {
    /// The first buffer.
    pub behind: Behind,
    /// The second buffer's intensity.
    pub light: [f32; 3],
    /// What passes through the second buffer, `1 - k`: three channels, for the sake of filters.
    pub passes: [f32; 3],
    /// Its opacity.
    pub alpha: f32,
    /// How many surfaces of the list went into it; holes cut out by a texture are none.
    pub layers: u32,
}

/// Fills both buffers of a sample.
pub fn fill(fragments: &[Fragment<'_>], sample: usize, mut behind: Behind) -> Filled {
    let (seen, nearest) = in_front_of_opaque(fragments, sample);
    if let Some(nearest) = nearest {
        behind = Behind { color: nearest.color, depth: Some(nearest.depth(sample)) };
    }
    let mut filled = Filled { behind, light: [0.0; 3], passes: [1.0; 3], alpha: 0.0, layers: 0 };
    for fragment in seen {
        for k in 0..3 {
            filled.light[k] = (1.0 - filled.passes[k]) * filled.light[k] + fragment.color[k];
            filled.passes[k] *= fragment.passes[k];
        }
        filled.alpha = 1.0 - (1.0 - filled.alpha) * (1.0 - fragment.color[3]);
        // A hole cut out by a texture is no surface.
        filled.layers += u32::from(fragment.color != [0.0; 4] || fragment.passes != [1.0; 3]);
    }
    filled
}

/// See the module.
pub fn lay(fragments: &[Fragment<'_>], samples: &mut [[f32; 4]]) {
    for (s, color) in samples.iter_mut().enumerate() {
        let Filled { behind, light, passes, alpha, .. } =
            fill(fragments, s, Behind { color: *color, depth: None });
        for k in 0..3 {
            color[k] = light[k] + passes[k] * behind.color[k];
        }
        color[3] = alpha + (1.0 - alpha) * behind.color[3];
    }
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::{laid, pane};
    use super::*;

    #[test]
    fn f8_e3_one_layer_is_exact_and_two_show_the_known_error() {
        let (near, far) = (pane(1, &[0.9], 0.8, 0.25), pane(0, &[0.4], 0.6, 0.5));
        assert!((laid(lay, &[near], 0.2) - (0.75 * 0.8 + 0.25 * 0.2)).abs() < 1e-6);
        // Far first: k1 = 0.5, I1 = 0.6; then k2 = 0.75, I2 = 0.8.
        let printed = 0.5 * 0.5 * 0.6 + 0.75 * 0.8 + 0.5 * 0.25 * 0.2;
        let exact = 0.75 * 0.8 + 0.25 * (0.5 * 0.6 + 0.5 * 0.2);
        let got = laid(lay, &[far, near], 0.2);
        assert!((got - printed).abs() < 1e-6 && (got - exact).abs() > 0.05, "{got}, exact {exact}");
        // The other way round it is another picture.
        let turned = 0.75 * 0.75 * 0.8 + 0.5 * 0.6 + 0.5 * 0.25 * 0.2;
        assert!((laid(lay, &[near, far], 0.2) - turned).abs() < 1e-6);
    }

    #[test]
    fn f7_opaque_fragments_belong_to_the_first_buffer() {
        let (line, pane) = (pane(0, &[0.5], 0.3, 0.0), pane(1, &[0.7], 1.0, 0.5));
        assert!((laid(lay, &[line, pane], 0.9) - 0.65).abs() < 1e-6);
    }
}
