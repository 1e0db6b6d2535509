//! Triangles for the tests of several kernels.

use crate::{CornerPosition, SUBPIXEL, Setup};

/// `count` triangles of all sizes and shapes all over the tile whose first pixel is
/// `[origin, origin]`, across its borders, too. Those without area are left out.
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

/// The box of a triangle's middles of pixels in the tile at pixel `origin`; where there is none,
/// nothing lies within.
#[cfg(feature = "forward")]
pub(crate) fn box_of(setup: &Setup, origin: [i32; 2]) -> i32 {
    use crate::TILE;
    use crate::geometry::packed_box;
    let side = |v: [i32; 3], axis: usize| {
        let first = origin[axis] * SUBPIXEL + SUBPIXEL / 2;
        let (low, high) = (v[0].min(v[1]).min(v[2]) - first, v[0].max(v[1]).max(v[2]) - first);
        [((low + SUBPIXEL - 1) >> 8).clamp(0, TILE as i32), (high >> 8).clamp(-1, TILE as i32 - 1)]
    };
    let ([x0, x1], [y0, y1]) = (side(setup.x, 0), side(setup.y, 1));
    packed_box([x0, y0, x1, y1])
}
