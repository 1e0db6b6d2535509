//! Boxes on the screen by the cells of a grid, so that a polygon only meets those that overlap it.
//!
//! In:   boxes, 1/256 pixel. Out: numbers of boxes that overlap one.
//! Cost: linear in boxes; of a search, the boxes in its cells.

use super::region::overlap;
use std::ops::Range;
use vitral_scene::buckets::{Dealt, Source};

/// Entries for each box at most, on average: this decides how fine the grid is.
const ENTRIES_A_BOX: usize = 8;

/// See the module.
#[derive(Debug)]
pub(super) struct Buckets {
    boxes: Vec<[f64; 4]>,
    grid: Grid,
    /// Numbers of boxes by cell.
    numbers: Dealt<u32>,
}

/// Boxes, with the cells that they reach.
struct InCells<'b> {
    grid: Grid,
    boxes: &'b [[f64; 4]],
}

impl Source<u32> for InCells<'_> {
    fn items(&self) -> usize {
        self.boxes.len()
    }

    fn visit(&self, range: Range<usize>, mut put: impl FnMut(usize, u32)) {
        for number in range {
            self.grid.cells(self.boxes[number]).for_each(|cell| put(cell, number as u32));
        }
    }
}

/// Cells of the same size over all boxes.
#[derive(Clone, Copy, Debug)]
struct Grid {
    /// Lower corner, in the units of the boxes.
    origin: [f64; 2],
    /// Cells for each unit along x and y.
    cells_a_unit: [f64; 2],
    /// Cells a side.
    side: usize,
}

impl Grid {
    /// First and last column and row of cells that a box reaches.
    fn reach(&self, around: [f64; 4]) -> [[usize; 2]; 2] {
        [0, 1].map(|k| {
            [around[k] - 1.0, around[k + 2] + 1.0].map(|at| {
                (((at - self.origin[k]) * self.cells_a_unit[k]).max(0.0) as usize)
                    .min(self.side - 1)
            })
        })
    }

    fn cells(&self, around: [f64; 4]) -> impl Iterator<Item = usize> + use<> {
        let ([[x0, x1], [y0, y1]], side) = (self.reach(around), self.side);
        (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| y * side + x))
    }
}

impl Buckets {
    pub(super) fn new(boxes: Vec<[f64; 4]>) -> Self {
        // Bound all boxes.
        let mut all = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        for b in &boxes {
            all = [all[0].min(b[0]), all[1].min(b[1]), all[2].max(b[2]), all[3].max(b[3])];
        }

        // Take the finest grid in which there are not too many entries.
        let mut side = boxes.len().isqrt().max(1);
        let grid = loop {
            let cells_a_unit = [0, 1].map(|k| side as f64 / (all[k + 2] - all[k]).max(1.0));
            let grid = Grid { origin: [all[0], all[1]], cells_a_unit, side };
            let entries = |b: &[f64; 4]| {
                let [[x0, x1], [y0, y1]] = grid.reach(*b);
                (x1 - x0 + 1) * (y1 - y0 + 1)
            };
            if side == 1 || boxes.iter().map(entries).sum::<usize>() <= boxes.len() * ENTRIES_A_BOX
            {
                break grid;
            }
            side /= 2;
        };

        // Enter the boxes in the cells they touch.
        let numbers = Dealt::new(&InCells { grid, boxes: &boxes }, side * side);
        Self { boxes, grid, numbers }
    }

    /// The boxes that overlap one, the lowest number first.
    pub(super) fn overlapping(&self, around: [f64; 4], found: &mut Vec<u32>) {
        found.clear();
        for cell in self.grid.cells(around) {
            let numbers = self.numbers.bucket(cell);
            found.extend(
                numbers.iter().filter(|&&number| overlap(self.boxes[number as usize], around)),
            );
        }
        found.sort_unstable();
        found.dedup();
    }

    /// Bytes in memory, about, for so many boxes.
    pub(super) fn bytes(boxes: usize) -> usize {
        boxes * (size_of::<[f64; 4]>() + ENTRIES_A_BOX * size_of::<u32>() + 2 * size_of::<u32>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_overlapping_boxes_are_found() {
        let mut state = 9u32;
        let mut next = |size: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from((state >> 8) % size)
        };
        for size in [3, 100, 900] {
            let boxes: Vec<_> = (0..300)
                .map(|_| {
                    let [x, y] = [next(1000), next(1000)];
                    [x, y, x + next(size), y + next(size)]
                })
                .collect();
            let buckets = Buckets::new(boxes.clone());
            let mut found = Vec::new();
            for around in boxes.iter().copied().chain([[-500.0, 400.0, 2000.0, 401.0]]) {
                buckets.overlapping(around, &mut found);
                let expected: Vec<_> =
                    (0..300).filter(|&i| overlap(boxes[i as usize], around)).collect();
                assert_eq!(found, expected);
            }
        }
        let mut found = vec![1];
        Buckets::new(Vec::new()).overlapping([0.0; 4], &mut found);
        assert!(found.is_empty());
    }
}
