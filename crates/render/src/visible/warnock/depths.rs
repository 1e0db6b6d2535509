//! The four-corner test: whether one polygon hides another all over a window.
//!
//! In:   two planes of depth, a window (screen space). Out: whether the first is nearer at every
//!       sample of the window.
//! Cost: constant.

use super::super::polygons::same_plane;
use super::window::SampleBox;
use vitral_raster::{SUBPIXEL, Setup};

/// A facet's plane at the four corners of a window.
pub(super) struct CornerDepths<'f> {
    setup: &'f Setup,
    /// The plane's depths, not clamped to the facet's.
    depths: [f64; 4],
    /// How far [`Setup::depth`] may be from the plane at most, by rounding.
    margin: f64,
}

impl<'f> CornerDepths<'f> {
    pub(super) fn new(setup: &'f Setup, samples: SampleBox) -> Self {
        let mut margin = 0.0f64;
        let depths = samples.corners().map(|[x, y]| {
            let offset = |v: i32, k: usize| f64::from(v - setup.origin[k]) / f64::from(SUBPIXEL);
            let (across, down) =
                (offset(x, 0) * f64::from(setup.dz_dx), offset(y, 1) * f64::from(setup.dz_dy));
            // Four roundings to 24 bits, of numbers no larger than the sum.
            let rounding = (f64::from(setup.z.abs()) + across.abs() + down.abs())
                * f64::from(f32::EPSILON)
                * 4.0;
            // f64::max would swallow the NaN of a plane that overflows.
            margin = if rounding <= margin { margin } else { rounding };
            f64::from(setup.z) + across + down
        });
        Self { setup, depths, margin }
    }

    /// Whether this facet is the visible one of the two at each sample of the window that both
    /// cover. The planes' distance is linear, so smallest at a corner; depths are clamped, so
    /// neither plane may leave the other facet's range on the wrong side.
    pub(super) fn hides(&self, other: &Self) -> bool {
        let (near, far) = (self.setup, other.setup);
        if near.z_min > far.z_max {
            return true;
        }
        if same_plane(near, far) {
            return near.facet < far.facet;
        }
        let margin = self.margin + other.margin;
        near.z_max > far.z_min
            && (0..4).all(|i| {
                let (a, b) = (self.depths[i], other.depths[i]);
                a - b > margin
                    && a - margin > f64::from(far.z_min)
                    && b + margin < f64::from(near.z_max)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::super::window::tests::{WINDOW, triangle};
    use super::*;

    #[test]
    fn p20_the_four_corner_test_decides_only_what_is_so_at_every_sample() {
        let large = [[-300, -300], [9000, -300], [-300, 9000]];
        let at = |setup| CornerDepths::new(setup, WINDOW);
        let front = triangle(large, [0.6, 0.9, 0.6], 1);
        let behind = triangle(large, [0.4, 0.8, 0.4], 0);
        let through = triangle(large, [0.6, 0.6, 0.9], 2);
        assert!(at(&front).hides(&at(&behind)) && !at(&behind).hides(&at(&front)));
        assert!(!at(&front).hides(&at(&through)) && !at(&through).hides(&at(&front)));
        let twin = Setup { facet: 5, ..front };
        assert!(at(&front).hides(&at(&twin)) && !at(&twin).hides(&at(&front)));
        // Less than the rounding apart: left to the samples.
        let close = triangle(large, [0.6 + 1e-7, 0.9, 0.6], 3);
        assert!(!at(&close).hides(&at(&front)) && !at(&front).hides(&at(&close)));
        let overflowing = Setup { dz_dx: f32::INFINITY, ..through };
        assert!(!at(&front).hides(&at(&overflowing)) && !at(&overflowing).hides(&at(&front)));
    }
}
