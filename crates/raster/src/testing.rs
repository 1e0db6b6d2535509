//! Triangles for the tests of several kernels.

use crate::{CornerPosition, SUBPIXEL, Setup};

/// `count` triangles of all sizes and shapes all over the tile whose first pixel is `[origin, origin]`, across its borders, too.
/// Those without area are left out.
pub(crate) fn triangles(count: u32, origin: i32) -> Vec<Setup> {
    let mut state = 7u32;
    // Numbers without pattern, from a linear congruence.
    let mut random = |below: i32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        ((u64::from(state) * below as u64) >> 32) as i32
    };
    let mut setups = Vec::new();
    for facet in 0..count {
        let size = [300, 900, 2500, 9000, 60_000][facet as usize % 5];
        let middle = [0, 1].map(|_| (origin - 1) * SUBPIXEL + random(66 * SUBPIXEL));
        let mut corner = || CornerPosition {
            x: middle[0] + random(size) - size / 2,
            // Half of them lie flat.
            y: middle[1] + random(if facet % 2 == 0 { size } else { 200 }) - 100,
            z: random(1000) as f32 / 1000.0,
        };
        let corners = [corner(), corner(), corner()];
        let area = Setup::doubled_area(corners[0], corners[1], corners[2]);
        if area != 0 {
            setups.push(Setup::new(corners, area, facet));
        }
    }
    setups
}
