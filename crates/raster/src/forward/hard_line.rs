//! Lines with hard borders, pixel by pixel along their longer axis.
//!
//! An aliased line is a parallelogram: its ends moved apart by whole pixels along the shorter axis.
//! So it covers as many pixels of every column (row) between its ends, and where these begin is a
//! quotient of whole numbers that grows by equal steps. The pixels are those of the parallelogram's
//! two triangles by the top-left rule, which as long thin triangles would be looked for in many
//! blocks.
//!
//! In:   a line on the grid of 1/256 pixel. Out: boxes of 8x8 pixels with the covered ones.
//! Cost: linear in its length.
//! Source: [Bresenham 1965].

use crate::{BLOCK, SUBPIXEL, TILE};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct HardLine {
    /// The lower of its two long edges, from where to where, x and y in 1/256 pixel.
    pub(super) edge: [[i32; 2]; 2],
    /// The longer axis: 0 for x.
    pub(super) axis: usize,
    /// Pixels along the other one.
    pub(super) width: i32,
}

/// The widest line that goes this way, so that each step along it has its pixels in a box.
pub(super) const WIDEST: i32 = BLOCK as i32;

impl HardLine {
    /// The edge from lower to higher coordinates of the longer axis.
    fn ordered(&self) -> [[i32; 2]; 2] {
        let [from, to] = self.edge;
        if from[self.axis] <= to[self.axis] { [from, to] } else { [to, from] }
    }

    /// Whether it may cover pixels of a tile, which is given by its number across and down.
    pub(super) fn touches(&self, tile: [i32; 2]) -> bool {
        let side = TILE as i32 * SUBPIXEL;
        let (along, across) = (self.axis, 1 - self.axis);
        let [from, to] = self.ordered();
        let start = from[along].max(tile[along] * side);
        let end = to[along].min((tile[along] + 1) * side);
        if start > end {
            return false;
        }
        let slope =
            f64::from(to[across] - from[across]) / f64::from((to[along] - from[along]).max(1));
        let at = |v: i32| f64::from(from[across]) + f64::from(v - from[along]) * slope;
        let (a, b) = (at(start), at(end));
        // A pixel more on both sides than what rounding may do.
        let room = f64::from(SUBPIXEL);
        let low = a.min(b) - room;
        let high = a.max(b) + room + f64::from(self.width * SUBPIXEL);
        high >= f64::from(tile[across] * side) && low <= f64::from((tile[across] + 1) * side)
    }

    /// Calls `box_of` with the first column and row in the tile of boxes of 8x8 pixels, and the
    /// pixels that are covered (bit `8 * row + column`), from one end to the other. `tile` is the
    /// tile's first pixel; `part` what may be covered of it: x0, y0, x1, y1, the last two
    /// exclusive.
    #[inline(always)]
    pub(super) fn boxes(
        &self,
        tile: [u32; 2],
        part: [i32; 4],
        mut box_of: impl FnMut([usize; 2], u64),
    ) {
        const HALF: i32 = SUBPIXEL / 2;
        let (along, across) = (self.axis, 1 - self.axis);
        let [from, to] =
            self.ordered().map(|end| [0, 1].map(|k| end[k] - tile[k] as i32 * SUBPIXEL));
        // The lowest pixel whose centre is not below.
        let above = |v: i32| (v + HALF - 1).div_euclid(SUBPIXEL);
        let (start, end) =
            (above(from[along]).max(part[along]), above(to[along]).min(part[along + 2]));
        if start >= end {
            return;
        }
        let (length, rise) =
            (i64::from(to[along] - from[along]), i64::from(to[across] - from[across]));

        // Follow the edge in whole numbers: pixel j's centre is not below it where j >= (distance *
        // rise) / whole.
        let whole = length * i64::from(SUBPIXEL);
        let distance = i64::from(start * SUBPIXEL + HALF - from[along]);
        let edge = distance * rise + i64::from(from[across] - HALF) * length;
        // A centre on the edge belongs to it on the left, and on the lower side of what does not
        // rise to the right.
        let belongs = along == 1 || rise <= 0;
        let numerator = edge + whole - i64::from(belongs);
        let (mut first, mut rest) =
            (numerator.div_euclid(whole) as i32, numerator.rem_euclid(whole));
        let step = rise * i64::from(SUBPIXEL);
        let (step, step_rest) = (step.div_euclid(whole) as i32, step.rem_euclid(whole));

        // Gather up to eight steps whose pixels fit into a box, and hand them out.
        let [low, high] = [part[across], part[across + 2]];
        // Covered pixels of up to eight steps: the first of each, and one past the last.
        let mut spans = [[0i32; 2]; BLOCK];
        let (mut count, mut begin, mut reach) = (0, start, [i32::MAX, i32::MIN]);
        let mut hand_out = |spans: &[[i32; 2]], begin: i32, lowest: i32| {
            let within = |v: i32| v.min((TILE - BLOCK) as i32);
            let mut corner = [0; 2];
            (corner[along], corner[across]) = (within(begin), within(lowest));
            box_of(corner.map(|v| v as usize), box_mask(spans, begin, corner, along));
        };
        for at in start..end {
            let span = [first.max(low), (first + self.width).min(high)];
            if span[0] < span[1] {
                let wider = [reach[0].min(span[0]), reach[1].max(span[1])];
                let fits = count == (at - begin) as usize
                    && count < BLOCK
                    && wider[1] - wider[0] <= BLOCK as i32;
                if count > 0 && !fits {
                    hand_out(&spans[..count], begin, reach[0]);
                    count = 0;
                }
                if count == 0 {
                    (begin, reach) = (at, span);
                } else {
                    reach = wider;
                }
                spans[count] = span;
                count += 1;
            }
            first += step;
            rest += step_rest;
            if rest >= whole {
                rest -= whole;
                first += 1;
            }
        }
        if count > 0 {
            hand_out(&spans[..count], begin, reach[0]);
        }
    }
}

/// The pixels of some steps along an axis, from `begin` on, in the box of 8x8 pixels at `corner`;
/// each step has a span of pixels along the other axis.
#[inline(always)]
fn box_mask(spans: &[[i32; 2]], begin: i32, corner: [i32; 2], along: usize) -> u64 {
    let mut mask = 0u64;
    for (i, [from, to]) in spans.iter().enumerate() {
        let at = (begin - corner[along]) as u32 + i as u32;
        let (from, to) = ((from - corner[1 - along]) as u32, (to - corner[1 - along]) as u32);
        let pixels = (1u64 << to) - (1u64 << from);
        if along == 1 {
            mask |= pixels << (8 * at);
        } else {
            // The bits of a column are eight apart.
            for row in from..to {
                mask |= 1 << (8 * row + at);
            }
        }
    }
    mask
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Setup;
    use crate::setup::CornerPosition;

    /// Whether the parallelogram's triangles cover a pixel's centre.
    fn covers(line: &HardLine, [x, y]: [i32; 2]) -> bool {
        let [a, b] = line.edge;
        let mut moved = [0; 2];
        moved[1 - line.axis] = line.width * SUBPIXEL;
        let corners =
            [a, b, [b[0] + moved[0], b[1] + moved[1]], [a[0] + moved[0], a[1] + moved[1]]]
                .map(|[x, y]| CornerPosition { x, y, z: 0.0 });
        [[0, 1, 2], [0, 2, 3]].iter().any(|&[i, j, k]| {
            let triangle = [corners[i], corners[j], corners[k]];
            let area = Setup::doubled_area(triangle[0], triangle[1], triangle[2]);
            let center = [x, y].map(|v| v * SUBPIXEL + SUBPIXEL / 2);
            area != 0 && Setup::new(triangle, area, 0).covers(center[0], center[1])
        })
    }

    #[test]
    fn covers_what_its_triangles_cover() {
        let mut seed = 7u32;
        let mut dice = |n: i32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as i32 % n
        };
        let tile = [64, 128];
        let side = TILE as i32;
        let mut drawn = 0;
        for number in 0..3000 {
            // Many ends lie on centres or borders of pixels.
            let grid = [1, 64, 128][number % 3];
            let mut end =
                || [dice(200 * SUBPIXEL / grid) * grid, dice(240 * SUBPIXEL / grid) * grid];
            let edge = [end(), end()];
            let axis =
                usize::from((edge[0][0] - edge[1][0]).abs() < (edge[0][1] - edge[1][1]).abs());
            let line = HardLine { edge, axis, width: 1 + dice(WIDEST) };
            let part = if number % 2 == 0 { [0, 0, side, side] } else { [3, 10, 50, side - 1] };
            let mut found = vec![false; TILE * TILE];
            line.boxes(tile, part, |[x, y], mask| {
                assert!(mask != 0 && x <= TILE - BLOCK && y <= TILE - BLOCK);
                for place in (0..64).filter(|place| mask >> place & 1 == 1) {
                    let at = &mut found[(y + place / 8) * TILE + x + place % 8];
                    assert!(!std::mem::replace(at, true), "no pixel twice");
                }
            });
            for (at, found) in found.iter().enumerate() {
                let [x, y] = [(at % TILE) as i32, (at / TILE) as i32];
                let allowed = x >= part[0] && y >= part[1] && x < part[2] && y < part[3];
                let expected = allowed && covers(&line, [x + tile[0] as i32, y + tile[1] as i32]);
                assert_eq!(*found, expected, "{line:?} at {x} {y}");
                drawn += usize::from(*found);
            }
            if found.contains(&true) {
                assert!(line.touches([1, 2]));
            }
        }
        assert!(drawn > 20_000, "{drawn}");
    }
}
