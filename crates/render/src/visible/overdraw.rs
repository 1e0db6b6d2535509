//! The z-buffer as somebody who looks on is told it: facet by facet, in the order of the scene.
//!
//! Tiles are drawn from near to far, which is faster and gives the same picture. For an onlooker
//! each tile is gone through once more, one sample a pixel: for each facet, where it stays and
//! where it is hidden.
//!
//! In:   batches of set-up triangles (screen space). Out: a step for each facet in a tile.
//! Cost: linear in the pixels that the triangles' boxes cover; nothing where nobody looks on.

use super::agreement::nearer;
use super::tiles::size_in_picture;
use crate::trace::Step;
use crate::{Execution, PreparedView};
use std::sync::Mutex;
use vitral_raster::{Batch, SUBPIXEL, Setup, Tile};

/// What the first sample of a pixel holds: depth and facet.
type Held = Option<(f32, u32)>;

/// What the tiles hold as far as facets came; none where nobody looks on.
pub(super) struct Overdraw(Vec<Mutex<Vec<Held>>>);

impl Overdraw {
    pub(super) fn new(tiles: usize, execution: &Execution) -> Self {
        let watched = if execution.observer.is_some() { tiles } else { 0 };
        Self((0..watched).map(|_| Mutex::default()).collect())
    }

    /// Lets the opaque facets of these batches come, and tells what happens in a tile.
    pub(super) fn come(
        &self,
        view: &PreparedView<'_>,
        execution: &Execution,
        batches: &[(bool, Batch)],
        index: usize,
        tile: &Tile,
    ) {
        let Some(pixels) = self.0.get(index) else { return };
        let mut pixels = pixels.lock().expect("no thread panics while it compares depths");
        let (rows, columns) = size_in_picture(view, tile);
        pixels.resize(rows * columns, None);
        let mut setups: Vec<_> = batches
            .iter()
            .filter(|(layered, _)| !layered)
            .flat_map(|(_, batch)| batch.tile(index))
            .collect();
        setups.sort_by_key(|setup| setup.facet);
        for setup in setups {
            let mut there =
                Pixels { held: &mut pixels, size: [columns, rows], origin: [tile.x, tile.y] };
            there.compare(setup, view.pattern.position(0), execution);
        }
    }
}

/// A tile's pixels in the picture, and what their first samples hold.
struct Pixels<'p> {
    held: &'p mut [Held],
    /// Columns and rows.
    size: [usize; 2],
    /// The first pixel.
    origin: [u32; 2],
}

impl Pixels<'_> {
    /// Compares a facet with what is there, and keeps the nearer.
    fn compare(&mut self, setup: &Setup, [sample_x, sample_y]: [i32; 2], execution: &Execution) {
        let [left, top] = self.origin;
        let [columns, rows] = self.within_box(setup);
        let (mut stays, mut hidden) = (Vec::new(), Vec::new());
        // Compare at each pixel that the facet covers.
        for row in rows {
            for column in columns.clone() {
                let pixel = [left + column as u32, top + row as u32];
                let [x, y] =
                    [pixel[0] as i32 * SUBPIXEL + sample_x, pixel[1] as i32 * SUBPIXEL + sample_y];
                if !setup.covers(x, y) {
                    continue;
                }
                let held = &mut self.held[row * self.size[0] + column];
                let (came, was) = ((setup.depth(x, y), setup.facet), *held);
                let is_nearer = was.is_none_or(|was| nearer(came, was));
                if is_nearer {
                    *held = Some(came);
                }
                // Report the outcome, in detail where somebody watches the pixel.
                extend(if is_nearer { &mut stays } else { &mut hidden }, pixel);
                if execution.observer.as_ref().is_some_and(|observer| observer.watches(pixel)) {
                    let ((depth, facet), stays) = (came, held.map_or(came.1, |(_, facet)| facet));
                    let (there, there_depth) =
                        (was.map(|(_, facet)| facet), was.map(|(depth, _)| depth));
                    execution.report(|| Step::DepthTest {
                        pixel,
                        facet,
                        depth,
                        there,
                        there_depth,
                        stays,
                    });
                }
            }
        }
        if !stays.is_empty() || !hidden.is_empty() {
            execution.report(|| Step::Drawn { facet: setup.facet, stays, hidden });
        }
    }

    /// Columns and rows of the tile that the facet's box touches.
    fn within_box(&self, setup: &Setup) -> [std::ops::Range<usize>; 2] {
        let ends = |corners: [i32; 3], k: usize| {
            let [low, high] =
                [corners.iter().min(), corners.iter().max()].map(|v| v.copied().unwrap_or(0));
            let pixel = |v: i32| i64::from(v.div_euclid(SUBPIXEL)) - i64::from(self.origin[k]);
            let place = |pixel: i64| pixel.clamp(0, self.size[k] as i64) as usize;
            place(pixel(low))..place(pixel(high) + 1)
        };
        [ends(setup.x, 0), ends(setup.y, 1)]
    }
}

/// Adds a pixel, the next in order, to runs.
fn extend(runs: &mut Vec<[u32; 3]>, [x, y]: [u32; 2]) {
    match runs.last_mut() {
        Some([row, _, end]) if (*row, *end) == (y, x) => *end += 1,
        _ => runs.push([y, x, x + 1]),
    }
}
