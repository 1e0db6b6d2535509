//! A uniform grid: space is cut into equal cells, and a ray walks from cell to cell.
//!
//! The walk is that of a line drawn on paper with squares, in three dimensions. For each axis we
//! know at which parameter the ray meets the next wall across that axis; the smallest of the three
//! numbers says which wall comes first, and one step along its axis leads into the next cell. No
//! tree is searched, and cells come in the order of the ray, so that the walk can end at the first
//! hit. The price is that a cell is as large where there is much as where there is little.
//!
//! A ray may be a thin beam here (see [`super::beam`]). So each triangle is listed in all cells
//! that it comes within a margin of, and a beam no wider than that finds all it meets by walking
//! along its middle. A beam that is wider looks into the neighbouring cells, too, as many as it is
//! wide.
//!
//! In:   triangles. Out: [`Grid`].
//! Cost: linear to build, about [`DENSITY`] cells a triangle; a walk passes `O(n^(1/3))` cells.
//! Source: [Amanatides & Woo 1987]; the number of cells after [Cleary & Wyvill 1988]. Departs from
//!         the first: the parameter of a wall is computed anew, not by adding, so that rounding
//!         does not grow along the way.

use super::beam::Beam;
use super::follow::Follow;
use super::path::PartExtent;
use super::triangles::{Triangles, bounds_of};
use super::{Structure, Visitor, space_step};
use crate::trace::{Passed, Step};
use crate::{Cached, Execution, Session};
use std::sync::Arc;
use vitral_exec::{Budget, Limit};
use vitral_math::Vec3;

/// Cells a triangle.
pub const DENSITY: f32 = 4.0;
/// Most cells on an axis.
const MAX_CELLS_ALONG_AN_AXIS: f32 = 1024.0;
/// The margin, in sides of a cell.
const MARGIN: f32 = 1.0 / 32.0;
/// Entries for each triangle, at most: else cells become larger.
const REFERENCES: u64 = 32;
/// Triangles between questions to the budget.
const PIECE: usize = 1 << 16;

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    min: Vec3,
    cell: Vec3,
    /// Cells along each axis.
    count: [i32; 3],
    /// `entries[starts[c]..starts[c + 1]]` are the places of triangles in cell `c`; x runs fastest,
    /// then y.
    starts: Vec<u32>,
    entries: Vec<u32>,
    triangles: Arc<Triangles>,
}

impl Cached for Grid {
    type Key = ();
}

impl Grid {
    /// The session's, built when first asked for: the views of a turntable share it.
    ///
    /// # Errors
    /// A limit of the budget.
    pub fn of(session: &Session, execution: &Execution) -> Result<Arc<Self>, Limit> {
        let triangles = Triangles::of(session, execution)?;
        session.cache.get_or_build((), || Self::build(&triangles, &execution.budget))
    }

    /// Bytes needed while a grid over this many triangles is built.
    pub fn bytes(triangles: u64) -> u64 {
        triangles * (40 + 4 * REFERENCES + 12 * DENSITY as u64)
    }

    /// Builds the grid.
    ///
    /// # Errors
    /// A limit of the budget.
    pub fn build(triangles: &Arc<Triangles>, budget: &Budget) -> Result<Self, Limit> {
        budget.check("building the grid")?;
        let mut grid = Self::layout(triangles);

        // Count the entries of each cell, then put them in, cell by cell.
        let cells = grid.count.iter().product::<i32>() as usize;
        let mut starts = vec![0u32; cells + 2];
        for (i, corners) in triangles.corners.iter().enumerate() {
            if i % PIECE == 0 {
                budget.check("building the grid")?;
            }
            grid.for_cells(corners, |cell| starts[cell + 2] += 1);
        }
        for c in 2..starts.len() {
            starts[c] += starts[c - 1];
        }

        // Deal the triangles to their cells.
        let mut entries = vec![0u32; starts[cells + 1] as usize];
        for (place, corners) in (0u32..).zip(&triangles.corners) {
            grid.for_cells(corners, |cell| {
                entries[starts[cell + 1] as usize] = place;
                starts[cell + 1] += 1;
            });
        }
        starts.pop();
        (grid.starts, grid.entries) = (starts, entries);
        Ok(grid)
    }

    /// How large cells are: cubes, nearly, `DENSITY` a triangle, unless triangles are so large that
    /// each would be in very many.
    fn layout(triangles: &Arc<Triangles>) -> Self {
        // Measure the scene.
        let n = triangles.count() as f32;
        let [min, max] = if n > 0.0 { triangles.bounds() } else { [Vec3::ZERO, Vec3::ONE] };
        let size = max - min;
        // A flat scene has a little height, too.
        let size = size.max(Vec3::splat(size.max_element() * 1e-3)).max(Vec3::splat(1e-30));

        // Halve the number of cells until triangles lie in few enough of them.
        let mut cells = (DENSITY * n).max(1.0);
        loop {
            // Divided first, so that nothing overflows.
            let largest = size.max_element();
            let relative = size / largest;
            let side = cube_root(relative.x * relative.y * relative.z / cells);
            let count = [0, 1, 2]
                .map(|k| (relative[k] / side + 0.5).floor().clamp(1.0, MAX_CELLS_ALONG_AN_AXIS));
            let cell =
                size / Vec3::from_array(count) * (1.0 + 4.0 * MARGIN / Vec3::from_array(count));
            let grid = Self {
                min: min - cell * (2.0 * MARGIN),
                cell,
                count: count.map(|c| c as i32),
                starts: Vec::new(),
                entries: Vec::new(),
                triangles: Arc::clone(triangles),
            };
            let entries: u64 =
                triangles.corners.iter().map(|corners| grid.cells_of_box(corners)).sum();
            if entries <= REFERENCES * triangles.count() as u64 || count == [1.0; 3] {
                return grid;
            }
            cells *= 0.5;
        }
    }

    /// The cells, first and last on each axis, that come within a margin of the triangle's box.
    fn range(&self, corners: &[Vec3; 3]) -> [[i32; 2]; 3] {
        let [min, max] = bounds_of(corners);
        let at = |p: f32, k: usize| {
            ((p - self.min[k]) / self.cell[k]).floor().clamp(0.0, self.count[k] as f32 - 1.0)
        };
        [0, 1, 2].map(|k| {
            let margin = self.cell[k] * MARGIN;
            [at(min[k] - margin, k) as i32, at(max[k] + margin, k) as i32]
        })
    }

    fn cells_of_box(&self, corners: &[Vec3; 3]) -> u64 {
        self.range(corners).iter().map(|[first, last]| (last - first + 1) as u64).product()
    }

    /// Calls `f` with the number of each cell that comes within a margin of the triangle's box and
    /// plane.
    fn for_cells(&self, corners: &[Vec3; 3], mut f: impl FnMut(usize)) {
        let [xs, ys, zs] = self.range(corners);
        let [a, b, c] = *corners;
        let normal = (b - a).cross(c - a);
        let reach = normal.abs().dot(self.cell) * (0.5 + MARGIN + 1.0 / (1 << 14) as f32);
        // The normal of a needle is mostly rounding.
        let rounding =
            (b - a).abs().max_element() * (c - a).abs().max_element() * (1.0 / (1 << 19) as f32);
        let one = xs[0] == xs[1] && ys[0] == ys[1] && zs[0] == zs[1];
        for z in zs[0]..=zs[1] {
            for y in ys[0]..=ys[1] {
                for x in xs[0]..=xs[1] {
                    let middle =
                        self.min + self.cell * (Vec3::new(x as f32, y as f32, z as f32) + 0.5) - a;
                    let slack = rounding * (middle.abs().max_element() + self.cell.max_element());
                    // A normal that is zero or overflows decides nothing.
                    let beside = normal.dot(middle).abs() > reach + slack;
                    if one || !beside {
                        f(self.index([x, y, z]));
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn index(&self, [x, y, z]: [i32; 3]) -> usize {
        ((z * self.count[1] + y) * self.count[0] + x) as usize
    }

    /// The column, row and layer of the cell of this number.
    fn cell_of(&self, index: u32) -> [u32; 3] {
        let [columns, rows, _] = self.count.map(|c| c as u32);
        [index % columns, index / columns % rows, index / (columns * rows)]
    }

    /// Shows the triangles of one cell.
    #[inline(always)]
    fn show(&self, cell: [i32; 3], near: f32, visitor: &mut impl Visitor) {
        let index = self.index(cell);
        visitor.passes(index);
        let (start, end) = (self.starts[index] as usize, self.starts[index + 1] as usize);
        if start < end && !visitor.skips(index, near) {
            self.entries[start..end].iter().for_each(|&place| visitor.triangle(place as usize));
        }
    }
}

/// The cube root by Newton's method: exact operations only, for `0 < v <= 1`.
fn cube_root(v: f32) -> f32 {
    let mut r = 1.0f32;
    for _ in 0..64 {
        r = (2.0 * r + v / (r * r)) / 3.0;
    }
    r
}

/// A beam on its way through the grid.
struct Walk {
    /// The present cell.
    at: [i32; 3],
    /// One cell on, or back.
    step: [i32; 3],
    /// The parameter of the next wall across each axis.
    next: [f32; 3],
    /// How many cells the beam is wide, to each side.
    reach: [i32; 3],
}

impl Walk {
    /// Where the middle of the beam comes into the grid, and the parameter there; `None` if it
    /// passes by.
    fn start(grid: &Grid, beam: &Beam) -> Option<(Self, f32)> {
        // How wide does the beam become before it leaves?
        let size = grid.cell * Vec3::from_array(grid.count.map(|c| c as f32));
        let far = (grid.min + size * 0.5 - beam.origin).length() + size.length();
        let far = far / beam.direction.length();
        let width = beam.width + beam.growth * far;
        // Half the margin is for rounding.
        let reach = [0, 1, 2].map(|k| {
            let cells = (width[k] / grid.cell[k] - 0.5 * MARGIN).ceil().max(0.0);
            cells.min(grid.count[k] as f32) as i32
        });

        // Find the part of the middle line within reach of the grid.
        let (mut enter, mut leave) = (0.0f32, f32::INFINITY);
        for k in 0..3 {
            let wide = reach[k] as f32 * grid.cell[k];
            let (low, high) = (
                grid.min[k] - wide - beam.origin[k],
                grid.min[k] + size[k] + wide - beam.origin[k],
            );
            let d = beam.direction[k];
            if d == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (a, b) = (low / d, high / d);
            (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
        }
        if enter > leave {
            return None;
        }

        // Begin in the cell where the line enters.
        let p = beam.origin + beam.direction * enter;
        let mut walk = Self { at: [0; 3], step: [0; 3], next: [f32::INFINITY; 3], reach };
        for k in 0..3 {
            let (low, high) = (-reach[k], grid.count[k] - 1 + reach[k]);
            let cell = ((p[k] - grid.min[k]) / grid.cell[k]).floor();
            walk.at[k] = cell.clamp(low as f32, high as f32) as i32;
            walk.step[k] = if beam.direction[k] < 0.0 { -1 } else { 1 };
            walk.next[k] = walk.wall(grid, beam, k);
        }
        Some((walk, enter))
    }

    /// The parameter at which the present cell ends on an axis.
    #[inline(always)]
    fn wall(&self, grid: &Grid, beam: &Beam, k: usize) -> f32 {
        let ahead = self.at[k] + i32::from(self.step[k] > 0);
        if beam.direction[k] == 0.0 {
            return f32::INFINITY;
        }
        (grid.min[k] + ahead as f32 * grid.cell[k] - beam.origin[k]) / beam.direction[k]
    }

    /// Goes through the nearest wall: its parameter, or `None` where the grid ends.
    #[inline(always)]
    fn advance(&mut self, grid: &Grid, beam: &Beam) -> Option<f32> {
        let [x, y, z] = self.next;
        let k = if x <= y && x <= z { 0 } else { 2 - usize::from(y <= z) };
        let near = self.next[k];
        self.at[k] += self.step[k];
        if near == f32::INFINITY
            || self.at[k] < -self.reach[k]
            || self.at[k] >= grid.count[k] + self.reach[k]
        {
            return None;
        }
        self.next[k] = self.wall(grid, beam, k);
        Some(near)
    }

    /// Shows the present cell and all within reach; returns how many.
    #[inline(always)]
    fn look(&self, grid: &Grid, near: f32, visitor: &mut impl Visitor) -> u64 {
        if self.reach == [0; 3] {
            grid.show(self.at, near, visitor);
            return 1;
        }
        let range = |k: usize| {
            (self.at[k] - self.reach[k]).max(0)..(self.at[k] + self.reach[k] + 1).min(grid.count[k])
        };
        let mut count = 0;
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    grid.show([x, y, z], near, visitor);
                    count += 1;
                }
            }
        }
        count
    }
}

impl Follow for Grid {}

impl Structure for Grid {
    const REPEATS: bool = true;

    fn triangles(&self) -> &Triangles {
        &self.triangles
    }

    fn largest(&self, value: &dyn Fn(usize) -> f32) -> Vec<f32> {
        let largest = |places: &[u32]| {
            places.iter().map(|&p| value(p as usize)).fold(f32::NEG_INFINITY, f32::max)
        };
        self.starts
            .windows(2)
            .map(|w| largest(&self.entries[w[0] as usize..w[1] as usize]))
            .collect()
    }

    fn step(&self) -> Option<Step> {
        let cells = self.count.map(|c| c as u32);
        let size = self.cell * Vec3::from_array(self.count.map(|c| c as f32));
        Some(space_step(&self.triangles, [self.min, self.min + size], Some(cells)))
    }

    fn names(&self, parts: &[u32]) -> Passed {
        Passed::Cells(parts.iter().map(|&part| self.cell_of(part)).collect())
    }

    fn part_count(&self) -> u32 {
        self.count.iter().product::<i32>() as u32
    }

    fn extents(&self, parts: &[u32]) -> Vec<PartExtent> {
        let extent = |&part: &u32| {
            let corner = Vec3::from_array(self.cell_of(part).map(|c| c as f32));
            let cell = [corner, corner + 1.0].map(|c| self.min + self.cell * c);
            PartExtent::of_box(None, cell, self.triangles.center)
        };
        parts.iter().map(extent).collect()
    }

    fn traverse(&self, beam: &Beam, visitor: &mut impl Visitor) -> u64 {
        let Some((mut walk, mut near)) = Walk::start(self, beam) else { return 1 };
        let mut looked = 0;
        while !visitor.done(near) {
            looked += walk.look(self, near, visitor);
            match walk.advance(self, beam) {
                Some(next) => near = near.max(next),
                None => break,
            }
        }
        looked
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::vec3;

    /// Keeps the order in which triangles are shown.
    struct Seen(Vec<usize>);

    impl Visitor for Seen {
        fn skips(&self, _: usize, _: f32) -> bool {
            false
        }
        fn done(&self, _: f32) -> bool {
            false
        }
        fn triangle(&mut self, place: usize) {
            if self.0.last() != Some(&place) {
                self.0.push(place);
            }
        }
    }

    /// A tiny triangle in the middle of each of 4x4x4 unit cubes, numbered as cells are.
    fn dust() -> Grid {
        let at = |i: u32| vec3((i % 4) as f32, (i / 4 % 4) as f32, (i / 16) as f32) + 0.5;
        let corners = |i: u32| [at(i), at(i) + vec3(0.01, 0.0, 0.0), at(i) + vec3(0.0, 0.01, 0.01)];
        let triangles = Arc::new(Triangles {
            extent: 4.0,
            corners: (0..64).map(corners).collect(),
            facets: (0..64).collect(),
            ..Triangles::default()
        });
        let mut grid = Grid::build(&triangles, &Budget::default()).unwrap();
        assert_eq!(grid.count, [6; 3], "four cells a triangle are 6.3 on an axis");
        // The walk itself is easier to follow on unit cubes.
        (grid.min, grid.cell, grid.count) = (Vec3::ZERO, Vec3::ONE, [4; 3]);
        (grid.starts, grid.entries) = ((0..=64).collect(), (0..64).collect());
        grid
    }

    fn walk(origin: Vec3, direction: Vec3, width: f32) -> Vec<usize> {
        let mut seen = Seen(Vec::new());
        dust().traverse(&Beam::new(origin, direction, Vec3::splat(width), Vec3::ZERO), &mut seen);
        seen.0
    }

    #[test]
    fn the_walk_passes_cell_by_cell() {
        assert_eq!(walk(vec3(-1.0, 0.5, 0.5), Vec3::X, 0.0), [0, 1, 2, 3]);
        assert_eq!(walk(vec3(5.0, 0.5, 0.5), Vec3::NEG_X, 0.0), [3, 2, 1, 0]);
        // Slope one half: y reaches 1 at x = 1.5 and 2 at x = 3.5.
        assert_eq!(walk(vec3(0.0, 0.25, 2.5), vec3(1.0, 0.5, 0.0), 0.0), [32, 33, 37, 38, 39, 43]);
        assert_eq!(walk(vec3(2.5, 2.5, 2.5), Vec3::Z, 0.0), [42, 58], "from inside");
        assert_eq!(walk(vec3(-1.0, 4.5, 0.5), Vec3::X, 0.0), [0; 0], "beside");
        assert_eq!(walk(vec3(5.0, 0.5, 0.5), Vec3::X, 0.0), [0; 0], "behind");
    }

    #[test]
    fn a_wide_beam_looks_into_the_cells_beside() {
        let mut seen = walk(vec3(-1.0, 0.5, 0.5), Vec3::X, 0.6);
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen, [0, 1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19, 20, 21, 22, 23]);
        assert!(
            !walk(vec3(-1.0, 4.5, 0.5), Vec3::X, 0.6).is_empty(),
            "its middle passes the grid by"
        );
    }

    #[test]
    fn flat_huge_and_no_triangles_have_a_grid() {
        let build = |corners: Vec<[Vec3; 3]>| {
            let facets = (0..corners.len() as u32).collect();
            let triangles =
                Arc::new(Triangles { extent: 1e30, corners, facets, ..Triangles::default() });
            Grid::build(&triangles, &Budget::default()).unwrap()
        };
        assert_eq!(build(Vec::new()).entries.len(), 0);
        let flat = build(
            (0..100).map(|i| [0.0, 1.0, 2.0].map(|k| vec3(i as f32 + k, k * k, 0.0))).collect(),
        );
        assert_eq!(flat.count[2], 1, "{:?}", flat.count);
        let walls =
            build(vec![
                [vec3(-1e30, 0.0, 0.0), vec3(1e30, 1e30, 3.0), vec3(1.0, -1e30, -9.0)];
                1000
            ]);
        assert!(walls.entries.len() as u64 <= REFERENCES * 1000);
    }
}
