//! The depths of a face along a line.
//!
//! The law's depth function goes from the origin of a face's plane first down to the line, then
//! along it. The way down is the same for all spans of the face on the line: it is gone once, and
//! each depth, at a sample or at the end of a span, is one step from there:
//! [`Setup::depth_of_line`] and [`Setup::depth_along`], which make up [`Setup::depth`].
//!
//! In:   the plane of a polygon and a line (screen space). Out: depths.
//! Cost: a product and a sum a depth, once the face is on the line.
//! Source: face coherence after [Foley et al. 1990], section 15.2. Departs from it: the step along
//!       the line is a product, since adding up steps would round otherwise.

use vitral_raster::Setup;

/// A face that was brought to a line.
#[derive(Clone, Copy)]
pub(super) struct OnLine<'f> {
    pub(super) setup: &'f Setup,
    /// [`Setup::depth_of_line`].
    pub(super) start: f32,
}

impl OnLine<'_> {
    /// The depth at `x`, 1/256 pixel: [`Setup::depth`].
    #[inline(always)]
    pub(super) fn depth(&self, x: i32) -> f32 {
        self.setup.depth_along(self.start, x)
    }

    /// Farthest and nearest depth between two ends: the depth is monotonic in x, rounding included,
    /// so they are at the ends. Needles so steep that the sums overflow give the facet's whole
    /// range.
    #[inline]
    pub(super) fn range(&self, ends: [i32; 2]) -> (f32, f32) {
        const STEEP: f32 = 1e30;
        let setup = self.setup;
        if !(setup.dz_dx.abs() < STEEP && setup.dz_dy.abs() < STEEP) {
            return (setup.z_min, setup.z_max);
        }
        let [a, b] = ends.map(|x| self.depth(x));
        (a.min(b), a.max(b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::visible::scanline::edges::tests::triangle;

    fn on_line(setup: &Setup, y: i32) -> OnLine<'_> {
        OnLine { setup, start: setup.depth_of_line(y) }
    }

    #[test]
    fn p7_depths_along_a_line_are_the_depth_functions() {
        let slope = triangle([[3, -40], [4099, 700], [-900, 4096]], [0.1, 0.9, 0.3]);
        let mut setups = vec![slope];
        setups.extend(
            [1e-30, -3e-7, 1e25, f32::INFINITY, f32::NAN].map(|dz_dx| Setup { dz_dx, ..slope }),
        );
        setups.extend([-1e-38, 7e-5, f32::NEG_INFINITY].map(|dz_dy| Setup {
            dz_dy,
            z_max: 0.7,
            ..slope
        }));
        for setup in &setups {
            for y in [-8_000_000, -41, -40, 128, 129, 2000] {
                for x in (-5000..5000).step_by(37).chain([3, 8_000_000]) {
                    assert_eq!(
                        on_line(setup, y).depth(x).to_bits(),
                        setup.depth(x, y).to_bits(),
                        "{setup:?} {x} {y}"
                    );
                }
            }
        }
    }

    #[test]
    fn p19_depths_at_the_ends_bound_the_span() {
        let slope = triangle([[0, 0], [4096, 0], [0, 4096]], [0.1, 0.9, 0.3]);
        let line = on_line(&slope, 640);
        let (far, near) = line.range([128, 2000]);
        assert!((128..=2000).all(|x| (far..=near).contains(&line.depth(x))));
        let needle = Setup { dz_dx: f32::INFINITY, ..slope };
        assert_eq!(on_line(&needle, 0).range([0, 9]), (needle.z_min, needle.z_max));
    }
}
