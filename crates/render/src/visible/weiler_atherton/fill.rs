//! Visible polygons drawn into tiles.
//!
//! A row of tiles is filled polygon by polygon: on each line of samples, the crossings with its
//! boundary begin and end the spans that are its own. Visible polygons do not overlap but for what
//! rounding of depths leaves open, and there each sample is decided by the facets' depth function.
//!
//! In:   visible polygons (screen space). Out: the samples of a row of tiles.
//! Cost: edges times lines of samples that they cross, and the samples within.

use super::region::{FillEdge, Region};
use crate::visible::agreement::nearer;
use crate::visible::polygons::Polygons;
use crate::visible::tiles::put;
use std::ops::Range;
use vitral_exec::{Budget, Limit};
use vitral_raster::{SUBPIXEL, SamplePattern, TILE, TILE_PIXELS, Tile, Viewport};

/// Visible polygons with the edges of each.
#[derive(Debug, Default)]
pub(super) struct VisiblePolygons {
    edges: Vec<FillEdge>,
    polygons: Vec<Visible>,
}

/// A visible polygon.
#[derive(Clone, Debug)]
struct Visible {
    /// The polygon that it is a part of, by its number among the view's.
    polygon: u32,
    edges: Range<usize>,
    /// First whole y with a crossing, and the one behind the last, 1/256 pixel.
    y: [i32; 2],
    /// Square pixels.
    #[cfg(test)]
    area: f64,
}

impl VisiblePolygons {
    /// Adds a part of a polygon, which has this number among the view's.
    pub(super) fn push(&mut self, polygon: u32, region: &Region) {
        let first = self.edges.len();
        self.edges.extend(region.fill_edges());
        let own = &self.edges[first..];
        let y = own
            .iter()
            .fold([i32::MAX, i32::MIN], |[low, high], e| [low.min(e.y[0]), high.max(e.y[1])]);
        self.polygons.push(Visible {
            polygon,
            edges: first..self.edges.len(),
            y,
            #[cfg(test)]
            area: region.area(),
        });
    }

    /// Appends others.
    pub(super) fn append(&mut self, others: Self) {
        let first = self.edges.len();
        self.edges.extend(others.edges);
        let moved = |v: Visible| Visible { edges: v.edges.start + first..v.edges.end + first, ..v };
        self.polygons.extend(others.polygons.into_iter().map(moved));
    }

    /// Number of the polygon and area of each.
    #[cfg(test)]
    pub(super) fn areas(&self) -> impl Iterator<Item = (u32, f64)> {
        self.polygons.iter().map(|visible| (visible.polygon, visible.area))
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.polygons.len()
    }

    /// Bytes in memory.
    pub(super) fn bytes(&self) -> u64 {
        (size_of_val(self.edges.as_slice()) + size_of_val(self.polygons.as_slice())) as u64
    }

    /// Numbers of the visible polygons by the rows of tiles that they may have samples in.
    pub(super) fn rows(&self, viewport: Viewport) -> Vec<Vec<u32>> {
        let tile_rows = viewport.tiles_y() as i32;
        let mut rows = vec![Vec::new(); tile_rows as usize];
        let row = |y: i32| y.div_euclid(TILE as i32 * SUBPIXEL);
        for (number, visible) in (0..).zip(&self.polygons) {
            for r in row(visible.y[0]).max(0)..=row(visible.y[1]).min(tile_rows - 1) {
                rows[r as usize].push(number);
            }
        }
        rows
    }
}

/// What a row of tiles is filled with.
pub(super) struct Filling<'f, 'p> {
    pub(super) viewport: Viewport,
    pub(super) pattern: &'f SamplePattern,
    pub(super) polygons: &'f Polygons<'p>,
    pub(super) visible: &'f VisiblePolygons,
}

impl Filling<'_, '_> {
    /// Fills the samples of a row of tiles with the visible polygons of these numbers.
    pub(super) fn row(
        &self,
        row: usize,
        numbers: &[u32],
        tiles: &mut [Tile],
        budget: &Budget,
    ) -> Result<(), Limit> {
        let mut crossings = Vec::new();
        for (done, &number) in numbers.iter().enumerate() {
            if done % 1024 == 0 {
                budget.check("Weiler–Atherton")?;
            }
            let visible = &self.visible.polygons[number as usize];
            self.cross(row, &self.visible.edges[visible.edges.clone()], &mut crossings);
            crossings.sort_unstable();
            for pair in crossings.chunks_exact(2) {
                let ([line, from], [_, to]) = (pair[0], pair[1]);
                self.span(visible.polygon, line, [from, to], tiles);
            }
        }
        Ok(())
    }

    /// Finds where edges cross the lines of samples of a row of tiles: the line (row of pixels in
    /// the tiles, sample), and the first column whose sample is to the right. A sample on an edge
    /// counts as one a little to the right, and if that is on it too, a little below: this is the
    /// rule of top and left edges.
    fn cross(&self, row: usize, edges: &[FillEdge], crossings: &mut Vec<[u32; 2]>) {
        crossings.clear();
        let (pattern, viewport) = (self.pattern, self.viewport);
        let top = (row * TILE) as i32 * SUBPIXEL;
        let height = TILE.min(viewport.height as usize - row * TILE) as i32;
        for edge in edges {
            for s in 0..pattern.len() {
                let [sx, sy] = pattern.position(s);
                // The line of row r is at top + r * SUBPIXEL + sy.
                let first_not_above = |y: i32| -(top + sy - y).div_euclid(SUBPIXEL);
                for r in first_not_above(edge.y[0]).max(0)..first_not_above(edge.y[1]).min(height) {
                    let column = first_right(edge, top + r * SUBPIXEL + sy, sx);
                    let line = r as u32 * pattern.len() as u32 + s as u32;
                    crossings.push([line, column.clamp(0, viewport.width.into()) as u32]);
                }
            }
        }
    }

    /// Puts a polygon's facets into the samples of a span, where nothing nearer is.
    fn span(&self, polygon: u32, line: u32, [from, to]: [u32; 2], tiles: &mut [Tile]) {
        // Find the sample of the line.
        let pattern = self.pattern;
        let (r, s) = (line as usize / pattern.len(), line as usize % pattern.len());
        let [sx, sy] = pattern.position(s);
        let polygon = self.polygons.get(polygon as usize);
        let plane = polygon.plane();
        let mut from = from as usize;

        // Fill one tile's part of the span after the other.
        while from < to as usize {
            let tile = &mut tiles[from / TILE];
            let y = (tile.y as usize + r) as i32 * SUBPIXEL + sy;
            let along = plane.depth_of_line(y);
            let end = (to as usize).min((from / TILE + 1) * TILE);
            for column in from..end {
                let x = column as i32 * SUBPIXEL + sx;
                let sample = s * TILE_PIXELS + r * TILE + column % TILE;
                let depth = plane.depth_along(along, x);
                if depth < tile.depth[sample] {
                    continue;
                }
                // Keep the nearer facet.
                let candidate = (depth, polygon.facet_within(x, y));
                if nearer(candidate, (tile.depth[sample], tile.facet[sample])) {
                    put(tile, sample, candidate);
                }
            }
            from = end;
        }
    }
}

/// The first column whose sample at `y` lies right of an edge, or on it; `x` is its place in the
/// pixel.
pub(super) fn first_right(edge: &FillEdge, y: i32, x: i32) -> i64 {
    let line = &edge.line;
    let (a, rest) = (i64::from(line.a), i64::from(line.b) * i64::from(y) + line.c);
    let (a, rest) = if a < 0 { (-a, -rest) } else { (a, rest) };
    // Right of it is where a x + rest is not negative.
    let up = |n: i64, d: i64| -(-n).div_euclid(d);
    up(up(-rest, a) - i64::from(x), SUBPIXEL.into())
}
