//! Depths of a block of 8x8 pixels that one triangle covers wholly, kept as the triangle's plane.
//!
//! Most blocks lie inside one triangle. Their depths are written only where something else meets
//! them there; a later pass that draws the same triangle again finds its own plane, and need not
//! compare.
//!
//! In:   a triangle and a block. Out: its depths there as stored, the same bits as [`super::block`]
//!       writes.
//! Source: the idea of depth planes from graphics hardware, [Morein 2000].

use super::fragment::stored;
use super::pass::places;
use crate::setup::DepthPlane;
use crate::{BLOCK, SUBPIXEL, Setup};
use vitral_math::lanes::Lanes;

/// See the module.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surface {
    pub(super) plane: DepthPlane,
    /// The block's first pixel in the target.
    pub(super) place: [u32; 2],
    /// At how many places of a pixel depths are taken: one for all samples, or one each.
    pub(super) places: usize,
    /// See [`DepthBuffer::scale`](super::plane::DepthBuffer::scale).
    pub(super) scale: f32,
}

impl Surface {
    /// The depths of a triangle in the block at a pixel of the target.
    #[inline(always)]
    pub(super) fn new(setup: &Setup, (x, y): (usize, usize), places: usize, scale: f32) -> Self {
        Self { plane: setup.plane(), place: [x as u32, y as u32], places, scale }
    }

    /// The depths of the block as stored, at the place of a sample: the rows of
    /// [`super::block::Slope`].
    pub(super) fn rows(&self, sample: usize) -> [[f32; BLOCK]; BLOCK] {
        let (across, upwards) = self.slope(sample);
        let mut rows = [[0.0; BLOCK]; BLOCK];
        for (row, up) in rows.iter_mut().zip(upwards) {
            *row = self.row_of(&across, up);
        }
        rows
    }

    /// One of [`Self::rows`].
    pub(super) fn row(&self, sample: usize, row: usize) -> [f32; BLOCK] {
        let (across, upwards) = self.slope(sample);
        self.row_of(&across, upwards[row % BLOCK])
    }

    /// What changes with the column, and what changes with the row.
    #[inline(always)]
    fn slope(&self, sample: usize) -> ([f32; BLOCK], [f32; BLOCK]) {
        let places = places(self.places);
        let place = places[sample % places.len()];
        let away = |axis: usize| {
            self.place[axis] as i32 * SUBPIXEL + place[axis] - self.plane.origin[axis]
        };
        let (dx, dy) = (away(0) as f32 / SUBPIXEL as f32, away(1));
        let across = std::array::from_fn(|column| (column as f32 + dx) * self.plane.dz_dx);
        let upwards = std::array::from_fn(|row| {
            let dy = (row as i32 * SUBPIXEL + dy) as f32;
            dy * (1.0 / SUBPIXEL as f32) * self.plane.dz_dy + self.plane.z
        });
        (across, upwards)
    }

    #[inline(always)]
    fn row_of(&self, across: &[f32; BLOCK], up: f32) -> [f32; BLOCK] {
        // A loop, since what an array's `map` is made of is not inlined here.
        let mut row = *across;
        for depth in &mut row {
            *depth = Lanes::min(Lanes::max(*depth + up, self.plane.z_min), self.plane.z_max);
        }
        if self.scale != 1.0 {
            row.iter_mut().for_each(|depth| *depth = stored(*depth, self.scale));
        }
        row
    }
}
