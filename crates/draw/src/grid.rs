//! A pyramid of grids over the page, which finds the triangles near an edge, the nearest to the
//! viewer first.
//!
//! Each triangle lies in the level whose cells are at least as large as its box, so in four cells
//! at most; small triangles share the finest level. An edge asks the cells that it runs through on
//! each level. The list of a cell is sorted by the nearest corners: it ends for an edge where
//! triangles begin to lie wholly behind the edge.
//!
//! A face that covers a cell ends the cell's list behind it, for callers that only ask for visible
//! parts: whatever it hides is hidden already. Large triangles are laid over the cells of a level
//! [`COVER_LEVELS`] finer than their own, and finer levels inherit. Without this, models of many
//! parts behind one wall cost as much as if there were no wall.
//!
//! In:   triangles on the page. Out: lists of triangles for an edge or a box.
//! Cost: `O(n log n)` for the sort by depth; memory four entries a triangle at most.
//! Source: [Franklin 1980]. Departs from it: levels, so that the size of faces does not matter.

use crate::page_mesh::{PageMesh, Triangle};
use crate::run::Run;
use std::ops::ControlFlow;
use vitral_exec::Limit;
use vitral_math::exact::{GridPoint, orient2d};

/// Levels between a triangle and the cells that it is laid over: 8 of them along its box.
const COVER_LEVELS: u32 = 3;
/// Bytes of a triangle in the lists and while they are sorted.
const BYTES_A_TRIANGLE: u64 = 28;

/// See the module.
#[derive(Debug)]
pub(crate) struct Grid {
    /// The coarsest first.
    levels: Vec<Level>,
    /// Cells of the finest level are this power of two wide.
    finest: u32,
}

#[derive(Debug)]
struct Level {
    /// Cells are this power of two wide.
    shift: u32,
    width: usize,
    /// Where each cell's list begins.
    starts: Vec<u32>,
    /// Where the part of each list ends that counts for visible parts.
    ends: Vec<u32>,
    items: Vec<u32>,
}

impl Level {
    fn cell_of(&self, point: [i32; 2]) -> [usize; 2] {
        point.map(|c| (c >> self.shift) as usize)
    }

    fn list(&self, cell: usize, visible_only: bool) -> &[u32] {
        let end = if visible_only { self.ends[cell] } else { self.starts[cell + 1] };
        &self.items[self.starts[cell] as usize..end as usize]
    }
}

/// The level of a box: the power of two that its longer side is below.
fn level_of(low: [i32; 2], high: [i32; 2], finest: u32) -> u32 {
    let side = (high[0] - low[0]).max(high[1] - low[1]).max(1);
    (32 - side.leading_zeros()).max(finest)
}

impl Grid {
    /// Sorts the triangles that `wanted` accepts into cells.
    pub(crate) fn new(
        mesh: &PageMesh,
        wanted: impl Fn(&Triangle) -> bool,
        run: &Run<'_>,
    ) -> Result<Self, Limit> {
        // Sort the triangles by depth, the nearest first.
        let (triangles, size) = (&mesh.triangles, mesh.size);
        let mut order: Vec<(i32, u32)> = (0..triangles.len() as u32)
            .filter(|&t| wanted(&triangles[t as usize]))
            .map(|t| (-triangles[t as usize].nearest, t))
            .collect();
        run.memory.add(order.len() as u64 * BYTES_A_TRIANGLE)?;
        order.sort_unstable();
        run.budget.check("the grid")?;

        // About as many cells as triangles.
        let longer = size[0].max(size[1]).max(1) as u32;
        let cells_along = (order.len() as f64).sqrt().max(1.0) as u32;
        let finest = (longer / cells_along).max(1).ilog2();

        // Group them by the level whose cells are about as large as they are.
        let mut by_level: Vec<Vec<u32>> = vec![Vec::new(); 32];
        for &(_, t) in &order {
            let triangle = &triangles[t as usize];
            by_level[level_of(triangle.low, triangle.high, finest) as usize].push(t);
        }

        // Fill the levels from coarse to fine, and cut lists where a triangle covers the whole
        // cell.
        let mut levels: Vec<Level> = Vec::new();
        for shift in (finest..32).rev().filter(|&shift| !by_level[shift as usize].is_empty()) {
            levels.push(Level::new(shift, size, &by_level[shift as usize], triangles));
        }
        let covers = Covers::new(&by_level, finest, size, triangles);
        run.workers
            .for_each(levels.iter_mut().collect(), |level| covers.end_lists(level, triangles));
        Ok(Self { levels, finest })
    }

    /// Calls `visit` with the list of each cell that an edge runs through, until it breaks.
    pub(crate) fn along<B>(
        &self,
        ends: [GridPoint; 2],
        visible_only: bool,
        mut visit: impl FnMut(&[u32]) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        // Order the ends from bottom to top.
        let [p, q] = if ends[0][1] <= ends[1][1] { ends } else { [ends[1], ends[0]] };
        let (low, high) = ([p[0].min(q[0]), p[1]], [p[0].max(q[0]), q[1]]);
        let slope = f64::from(q[0] - p[0]) / f64::from((q[1] - p[1]).max(1));

        // Visit the cells of each level, row by row.
        for level in &self.levels {
            let ([left, bottom], [right, top]) = (level.cell_of(low), level.cell_of(high));
            for row in bottom..=top {
                let (mut from, mut to) = (left, right);
                if to > from + 1 && top > bottom {
                    // Where the edge is within this row, a unit more on both sides.
                    let at = |row: usize| {
                        f64::from(p[0])
                            + slope * (((row as i64) << level.shift) - i64::from(p[1])) as f64
                    };
                    let (a, b) = (at(row), at(row + 1));
                    from = from.max((a.min(b) - 1.0).max(0.0) as usize >> level.shift);
                    to = to.min((a.max(b) + 1.0).max(0.0) as usize >> level.shift);
                }

                // Visit the cells of the row.
                for column in from..=to {
                    let list = level.list(row * level.width + column, visible_only);
                    if !list.is_empty() {
                        visit(list)?;
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Calls `visit` with the list of each cell that a box meets, without what covered cells hide.
    pub(crate) fn over<B>(
        &self,
        low: [i32; 2],
        high: [i32; 2],
        mut visit: impl FnMut(&[u32]) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        for level in &self.levels {
            let ([left, bottom], [right, top]) = (level.cell_of(low), level.cell_of(high));
            for row in bottom..=top {
                for column in left..=right {
                    visit(level.list(row * level.width + column, true))?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Calls `visit` with the list of each cell that a triangle's box meets, on its own level and
    /// coarser ones, and whether it is the triangle's own level: so each pair of triangles is met
    /// from the smaller one.
    pub(crate) fn around<B>(
        &self,
        triangle: &Triangle,
        mut visit: impl FnMut(&[u32], bool) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let own = level_of(triangle.low, triangle.high, self.finest);
        for level in self.levels.iter().filter(|level| level.shift >= own) {
            let ([left, bottom], [right, top]) =
                (level.cell_of(triangle.low), level.cell_of(triangle.high));
            for row in bottom..=top {
                for column in left..=right {
                    visit(level.list(row * level.width + column, false), level.shift == own)?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}

impl Level {
    /// Sorts triangles into cells, in the order given.
    fn new(shift: u32, size: [i32; 2], members: &[u32], triangles: &[Triangle]) -> Self {
        let [width, height] = size.map(|side| (side >> shift) as usize + 1);
        let mut level = Self {
            shift,
            width,
            starts: vec![0; width * height + 1],
            ends: Vec::new(),
            items: Vec::new(),
        };
        let cells = |t: u32| {
            let triangle = &triangles[t as usize];
            let [[left, bottom], [right, top]] =
                [triangle.low, triangle.high].map(|p| p.map(|c| (c >> shift) as usize));
            (bottom..=top)
                .flat_map(move |row| (left..=right).map(move |column| row * width + column))
        };

        // Count the triangles of each cell.
        for &t in members {
            cells(t).for_each(|cell| level.starts[cell + 1] += 1);
        }

        // Sum the counts to offsets.
        for cell in 0..width * height {
            level.starts[cell + 1] += level.starts[cell];
        }

        // Deal the triangles to their cells.
        level.items = vec![0; level.starts[width * height] as usize];
        level.ends = level.starts[..width * height].to_vec();
        for &t in members {
            for cell in cells(t) {
                let end = &mut level.ends[cell];
                level.items[*end as usize] = t;
                *end += 1;
            }
        }
        level
    }
}

/// For the cells of each level, the depth behind which a face that covers the cell hides
/// everything.
struct Covers {
    /// By shift, from the finest; empty where no triangle is laid over the level's cells.
    depths: Vec<Vec<i32>>,
    finest: u32,
    size: [i32; 2],
}

impl Covers {
    fn new(by_level: &[Vec<u32>], finest: u32, size: [i32; 2], triangles: &[Triangle]) -> Self {
        let mut covers = Self { depths: vec![Vec::new(); 32 - finest as usize], finest, size };
        for shift in finest + 2..32 {
            for &t in &by_level[shift as usize] {
                covers.lay(shift.saturating_sub(COVER_LEVELS).max(finest), &triangles[t as usize]);
            }
        }
        covers
    }

    fn width(&self, shift: u32) -> usize {
        (self.size[0] >> shift) as usize + 1
    }

    /// Lays a triangle over the cells that lie wholly inside it.
    fn lay(&mut self, shift: u32, triangle: &Triangle) {
        // Find the cells of the triangle's box and the plane's margin for snapping.
        let (width, height) = (self.width(shift), (self.size[1] >> shift) as usize + 1);
        let [[left, bottom], [right, top]] =
            [triangle.low, triangle.high].map(|p| p.map(|c| c >> shift));
        let plane = triangle.plane();
        let [nx, ny, nz] = plane.normal.map(|n| n as f64);
        let margin = plane.snapping() / nz + 1.0;
        let depths = &mut self.depths[(shift - self.finest) as usize];
        for row in bottom..=top {
            for column in left..=right {
                // A cell ends a unit before the next begins, and covers its border.
                let corners = [[0, 0], [1, 0], [0, 1], [1, 1]]
                    .map(|[x, y]| [(column + x) << shift, (row + y) << shift, 0]);
                let inside = |p: GridPoint| {
                    let [a, b, c] = triangle.corners;
                    orient2d(a, b, p) >= 0 && orient2d(b, c, p) >= 0 && orient2d(c, a, p) >= 0
                };
                if !corners.into_iter().all(inside) {
                    continue;
                }

                // Keep the depth of the nearest triangle that covers the cell.
                let depth = |p: GridPoint| {
                    let [dx, dy] = [0, 1].map(|k| f64::from(p[k]) - f64::from(plane.origin[k]));
                    f64::from(plane.origin[2]) - (nx * dx + ny * dy) / nz
                };
                let farthest = corners.into_iter().map(depth).fold(f64::INFINITY, f64::min);
                let behind =
                    (farthest - margin).floor().clamp(f64::from(i32::MIN), f64::from(i32::MAX))
                        as i32;
                if depths.is_empty() {
                    depths.resize(width * height, i32::MIN);
                }
                let cell = &mut depths[row as usize * width + column as usize];
                *cell = (*cell).max(behind);
            }
        }
    }

    /// Ends the lists of a level at the faces that cover its cells, or coarser cells that these are
    /// in.
    fn end_lists(&self, level: &mut Level, triangles: &[Triangle]) {
        let covering: Vec<u32> = (level.shift..32)
            .filter(|&s| !self.depths[(s - self.finest) as usize].is_empty())
            .collect();
        if covering.is_empty() {
            return;
        }
        for cell in 0..level.ends.len() {
            let (row, column) = (cell / level.width, cell % level.width);
            let behind = covering.iter().fold(i32::MIN, |behind, &shift| {
                let up = shift - level.shift;
                behind.max(
                    self.depths[(shift - self.finest) as usize]
                        [(row >> up) * self.width(shift) + (column >> up)],
                )
            });
            let (start, end) = (level.starts[cell] as usize, level.ends[cell] as usize);
            let list = &level.items[start..end];
            let kept = list.partition_point(|&t| triangles[t as usize].nearest >= behind);
            level.ends[cell] = (start + kept) as u32;
        }
    }
}
