//! The columns of a sheet, or its rows: how long all are together, and where each is.

use super::{Extent, GAP};
use vitral_scene::View;

/// Columns from the left to the right, or rows upwards, of the orthographic views.
#[derive(Debug)]
pub(super) struct Row {
    /// Number, and the reach of its views to either side of the middle, in units of the world; in
    /// order.
    cells: Vec<(i32, [f64; 2])>,
}

/// Where the axonometric view is along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spot {
    /// Anywhere, in the middle of all.
    Middle,
    /// Past the cell of the front view, on this side.
    Corner(i32),
    /// Past all cells, on this side.
    Beyond(i32),
}

impl Spot {
    fn side(self) -> i32 {
        match self {
            Self::Middle => 0,
            Self::Corner(side) | Self::Beyond(side) => side,
        }
    }

    /// Whether a cell comes before the axonometric view.
    fn is_behind(self, cell: i32) -> bool {
        match self {
            Self::Middle => false,
            Self::Corner(side) => cell * side <= 0,
            Self::Beyond(_) => true,
        }
    }
}

impl Row {
    /// Sorts the orthographic views along axis `k` by the numbers of their cells.
    pub(super) fn new(extents: &[Extent], k: usize, cell: impl Fn(View) -> i32) -> Self {
        let mut cells: Vec<(i32, [f64; 2])> = Vec::new();
        for extent in extents.iter().filter(|extent| extent.view != View::Iso) {
            let number = cell(extent.view);
            match cells.iter_mut().find(|(other, _)| *other == number) {
                Some((_, [low, high])) => {
                    (*low, *high) = (low.max(extent.low[k]), high.max(extent.high[k]))
                }
                None => cells.push((number, [extent.low[k], extent.high[k]])),
            }
        }
        cells.sort_by_key(|(number, _)| *number);
        Self { cells }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Whether there are cells on this side of the front view's.
    pub(super) fn has_side(&self, side: i32) -> bool {
        self.cells.iter().any(|(number, _)| number * side > 0)
    }

    /// The length of all cells in units of the world, and of the gaps between them in millimetres.
    fn all(&self) -> (f64, f64) {
        let units = self.cells.iter().map(|(_, [low, high])| low + high).sum();
        (units, GAP * self.cells.len().saturating_sub(1) as f64)
    }

    /// The same of the cells before the axonometric view, with the gap between them and it.
    fn before(&self, spot: Spot) -> (f64, f64) {
        let behind = || self.cells.iter().filter(|(number, _)| spot.is_behind(*number));
        (behind().map(|(_, [low, high])| low + high).sum(), GAP * behind().count() as f64)
    }

    /// The length of all cells at a scale.
    pub(super) fn full(&self, scale: f64) -> f64 {
        let (units, gaps) = self.all();
        units * scale + gaps
    }

    /// The length of all, with an axonometric view of `size` units; `scales` of the cells and of
    /// this view.
    pub(super) fn length(&self, spot: Spot, scales: [f64; 2], size: f64) -> f64 {
        let (units, gaps) = self.before(spot);
        self.full(scales[0]).max(if size > 0.0 {
            units * scales[0] + gaps + size * scales[1]
        } else {
            0.0
        })
    }

    /// The largest common scale at which all are no longer than `room`; at most 0 where gaps are.
    pub(super) fn largest(&self, spot: Spot, size: f64, room: f64) -> f64 {
        let ((all, all_gaps), (before, gaps)) = (self.all(), self.before(spot));
        let gaps = if size > 0.0 { gaps } else { 0.0 };
        ratio(room - all_gaps, all).min(ratio(room - gaps, before + size))
    }

    /// The largest scale of the axonometric view beside cells at `scale`.
    pub(super) fn largest_rest(&self, spot: Spot, scale: f64, size: f64, room: f64) -> f64 {
        let (before, gaps) = self.before(spot);
        ratio(room - gaps - before * scale, size)
    }

    /// Where the middle of a cell is, from the beginning of all.
    pub(super) fn middle(&self, cell: i32, spot: Spot, scales: [f64; 2], size: f64) -> f64 {
        let spare = self.length(spot, scales, size) - self.full(scales[0]);
        let mut at = match spot.side() {
            0 => spare / 2.0,
            1 => 0.0,
            _ => spare,
        };
        for &(number, [low, high]) in &self.cells {
            if number == cell {
                return at + low * scales[0];
            }
            at += (low + high) * scales[0] + GAP;
        }
        at
    }

    /// From where to where the axonometric view has room.
    pub(super) fn rest(&self, spot: Spot, scales: [f64; 2], size: f64) -> [f64; 2] {
        let length = self.length(spot, scales, size);
        let (units, gaps) = self.before(spot);
        let before = units * scales[0] + gaps;
        if spot.side() < 0 { [0.0, length - before] } else { [before, length] }
    }
}

/// The scale at which something of `size` units has `room`; any where it has no size but room.
fn ratio(room: f64, size: f64) -> f64 {
    match (size > 0.0, room < 0.0) {
        (true, _) => room / size,
        (false, true) => room,
        (false, false) => f64::INFINITY,
    }
}
