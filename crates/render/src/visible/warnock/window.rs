//! Windows: rectangles of pixels, how they are cut, and what a polygon is to one.
//!
//! In:   a polygon's outline, a window (screen space). Out: which of the four relations holds.
//! Cost: linear in the polygon's edges.

use std::ops::Range;
use vitral_raster::{SUBPIXEL, TILE};

/// A rectangle of pixels of the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Window {
    /// Columns.
    pub(super) x: Range<u32>,
    /// Rows.
    pub(super) y: Range<u32>,
    /// The way down from the whole picture: for each cut the quarter, 0 to 3, across and then down.
    pub(super) path: Vec<u8>,
}

/// The box round a window's samples in the picture, ends included, 1/256 pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct SampleBox {
    /// Least and greatest x of a sample, in 1/256 pixel.
    pub(super) x: [i32; 2],
    /// Least and greatest y of a sample, in 1/256 pixel.
    pub(super) y: [i32; 2],
}

/// What a polygon is to a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WindowRelation {
    /// It has no sample in it.
    Disjoint,
    /// It lies within the window's pixels.
    Contained,
    /// It is partly in it.
    Intersecting,
    /// It covers it.
    Surrounding,
}

impl Window {
    /// The whole picture.
    pub(super) fn whole(width: u32, height: u32) -> Self {
        Self { x: 0..width, y: 0..height, path: Vec::new() }
    }

    /// Whether it is one pixel.
    pub(super) fn is_pixel(&self) -> bool {
        self.x.len() == 1 && self.y.len() == 1
    }

    /// Whether it lies in one tile.
    pub(super) fn is_in_tile(&self) -> bool {
        self.x.len().max(self.y.len()) <= TILE
    }

    /// Left, top, width, height.
    pub(super) fn pixels(&self) -> [u32; 4] {
        [self.x.start, self.y.start, self.x.end - self.x.start, self.y.end - self.y.start]
    }

    /// The four smaller windows, or two where it is too narrow for four. A window of several tiles
    /// is cut between tiles, nearest to its middle, one within a tile at powers of two.
    pub(super) fn parts(&self) -> Vec<Self> {
        // Choose the cut of each side.
        let half = (self.x.len().max(self.y.len()).next_power_of_two() / 2) as u32;
        let tile = TILE as u32;
        let cut = |range: &Range<u32>| {
            let length = range.end - range.start;
            let at = if !self.is_in_tile() {
                (length > tile).then(|| (range.start + range.end + tile) / (2 * tile) * tile)
            } else {
                (length > half).then_some(range.start + half)
            };
            match at {
                Some(at) => vec![range.start..at, at..range.end],
                None => vec![range.clone()],
            }
        };

        // Combine columns and rows to windows.
        let (columns, rows) = (cut(&self.x), cut(&self.y));
        let part = |(down, y): (usize, &Range<u32>), (across, x): (usize, &Range<u32>)| {
            let mut path = self.path.clone();
            path.push((2 * down + across) as u8);
            Self { x: x.clone(), y: y.clone(), path }
        };
        rows.iter()
            .enumerate()
            .flat_map(|row| columns.iter().enumerate().map(move |column| part(row, column)))
            .collect()
    }

    /// The box round its samples, whose places within a pixel are in `extent`.
    pub(super) fn samples(&self, extent: [[i32; 2]; 2]) -> SampleBox {
        let ends = |pixels: &Range<u32>, [low, high]: [i32; 2]| {
            [pixels.start as i32 * SUBPIXEL + low, (pixels.end as i32 - 1) * SUBPIXEL + high]
        };
        SampleBox { x: ends(&self.x, extent[0]), y: ends(&self.y, extent[1]) }
    }
}

impl SampleBox {
    /// Its corners, 1/256 pixel.
    pub(super) fn corners(self) -> [[i32; 2]; 4] {
        let ([x0, x1], [y0, y1]) = (self.x, self.y);
        [[x0, y0], [x1, y0], [x0, y1], [x1, y1]]
    }
}

/// Tests a polygon, given by its outline, against the box round a window's samples: one of the
/// box's sides or of the outline's edges has the other on its outer side, if they are disjoint.
pub(super) fn relation(outline: &[[i32; 2]], samples: SampleBox) -> WindowRelation {
    let outside =
        // Reject outlines beside the box.
        |k: usize, [low, high]: [i32; 2]| outline.iter().all(|v| v[k] < low) || outline.iter().all(|v| v[k] > high);
    if outside(0, samples.x) || outside(1, samples.y) {
        return WindowRelation::Disjoint;
    }
    // An edge function is largest and smallest at two corners of the box.
    let mut surrounds = true;
    for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
        let (dx, dy) = (i64::from(b[0] - a[0]), i64::from(b[1] - a[1]));
        // Positive inside, y downwards: left edges go up, top edges go right; on these, 0 is
        // inside.
        let inside = if dy < 0 || (dy == 0 && dx > 0) { 0 } else { 1 };
        let down = samples.y.map(|y| dx * i64::from(y - a[1]));
        let across = samples.x.map(|x| -dy * i64::from(x - a[0]));
        if down[0].max(down[1]) + across[0].max(across[1]) < inside {
            return WindowRelation::Disjoint;
        }
        surrounds &= down[0].min(down[1]) + across[0].min(across[1]) >= inside;
    }

    // Tell surrounding, contained and intersecting apart.
    let within = |k: usize, [low, high]: [i32; 2]| {
        let sides =
            low.div_euclid(SUBPIXEL) * SUBPIXEL..=(high.div_euclid(SUBPIXEL) + 1) * SUBPIXEL;
        outline.iter().all(|v| sides.contains(&v[k]))
    };
    if surrounds {
        WindowRelation::Surrounding
    } else if within(0, samples.x) && within(1, samples.y) {
        WindowRelation::Contained
    } else {
        WindowRelation::Intersecting
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use vitral_raster::{CornerPosition, Setup};

    pub(crate) fn triangle(corners: [[i32; 2]; 3], z: [f32; 3], facet: u32) -> Setup {
        let [a, b, c] =
            [0, 1, 2].map(|i| CornerPosition { x: corners[i][0], y: corners[i][1], z: z[i] });
        Setup::new([a, b, c], Setup::doubled_area(a, b, c), facet)
    }

    pub(crate) const WINDOW: SampleBox = SampleBox { x: [128, 1920], y: [128, 1920] };

    #[test]
    fn p20_windows_are_cut_down_to_pixels() {
        for (width, height) in [(1, 1), (5, 1), (16, 16), (64, 64), (65, 3), (200, 150), (640, 480)]
        {
            let (mut open, mut pixels) = (vec![Window::whole(width, height)], 0);
            while let Some(window) = open.pop() {
                if window.is_pixel() {
                    pixels += 1;
                    continue;
                }
                let parts = window.parts();
                assert!((2..=4).contains(&parts.len()), "{window:?}");
                let areas = parts.iter().map(|p| p.x.len() * p.y.len());
                assert_eq!(areas.sum::<usize>(), window.x.len() * window.y.len());
                // Tiles stay whole until the window lies in one.
                let tile = TILE as u32;
                let aligned =
                    |p: &Window| p.x.start.is_multiple_of(tile) && p.y.start.is_multiple_of(tile);
                assert!(window.is_in_tile() || parts.iter().all(aligned), "{window:?}");
                open.extend(parts);
            }
            assert_eq!(pixels, width * height);
        }
        let [left, right] = &Window::whole(640, 48).parts()[..] else { panic!("too low for four") };
        assert_eq!((left.pixels(), right.pixels()), ([0, 0, 320, 48], [320, 0, 320, 48]));
        assert_eq!((left.path.as_slice(), right.path.as_slice()), (&[0][..], &[1][..]));
    }

    #[test]
    fn p20_the_relations_of_a_polygon_to_a_window() {
        let relation = |corners| {
            let setup = triangle(corners, [0.5; 3], 0);
            relation(&[0, 1, 2].map(|i| [setup.x[i], setup.y[i]]), WINDOW)
        };
        assert_eq!(relation([[3000, 0], [4000, 0], [3000, 900]]), WindowRelation::Disjoint);
        // Its box overlaps the window, but an edge has the window on its outer side.
        assert_eq!(relation([[4000, 0], [4000, 4000], [0, 4000]]), WindowRelation::Disjoint);
        assert_eq!(relation([[300, 300], [900, 300], [300, 900]]), WindowRelation::Contained);
        assert_eq!(relation([[-300, 300], [900, 300], [300, 900]]), WindowRelation::Intersecting);
        assert_eq!(
            relation([[-300, -300], [9000, -300], [-300, 9000]]),
            WindowRelation::Surrounding
        );
        // The samples on the left and top edges are in, those on the right one are out.
        assert_eq!(relation([[128, 128], [9000, 128], [128, 9000]]), WindowRelation::Surrounding);
        assert_eq!(
            relation([[1920, 9000], [1920, -7000], [-7000, -7000]]),
            WindowRelation::Intersecting
        );
    }
}
