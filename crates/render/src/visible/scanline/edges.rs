//! The tables of the scan-line algorithm: lines, polygons, edges, and the edges that a line crosses.
//!
//! In:   set-up triangles (screen space). Out: for each line its crossings, from left to right.
//! Cost: linear in edges and crossings; sorting is nearly so.
//! Source: [Wylie et al. 1967]. Departs from it: a crossing is an exact fraction, a whole number and a remainder.

use super::face::OnLine;
use crate::stats::VisibilityCounters;
use std::ops::Range;
use vitral_raster::{SUBPIXEL, SamplePattern, Setup};

/// A row of samples.
#[derive(Clone, Copy)]
pub(super) struct Line {
    /// Within the picture, 1/256 pixel.
    pub(super) y: i32,
    /// Row of pixels within the band.
    pub(super) row: usize,
    /// Which sample of the pixels.
    pub(super) sample: usize,
    /// Its place in the pixel, 1/256 pixel.
    pub(super) sample_x: i32,
}

/// An entry of the polygon table.
pub(super) struct Polygon<'f> {
    pub(super) setup: &'f Setup,
    /// The in-out flag: where the polygon stands in the list of those that are in, or [`OUT`].
    pub(super) slot: u32,
    /// The last line to which the face's depth was brought, and the depth there: [`Setup::depth_of_line`].
    pub(super) line: i32,
    pub(super) start: f32,
}

/// The in-out flag of polygons that are out.
pub(super) const OUT: u32 = u32::MAX;

impl<'f> Polygon<'f> {
    /// One that is out, on no line yet.
    pub(super) fn new(setup: &'f Setup) -> Self {
        Self { setup, slot: OUT, line: i32::MIN, start: 0.0 }
    }

    /// On the line to which it was brought.
    #[inline(always)]
    pub(super) fn on_line(&self) -> OnLine<'f> {
        OnLine { setup: self.setup, start: self.start }
    }
}

/// An entry of the edge table: the edge from corner `corner` of a polygon to the next, crossed by `lines`.
pub(super) struct Edge {
    pub(super) polygon: u32,
    pub(super) corner: u8,
    pub(super) lines: Range<u16>,
}

/// An entry of the active edge table. The edge crosses the line at `x + remainder / dy`.
#[derive(Clone, Copy)]
pub(super) struct ActiveEdge {
    pub(super) polygon: u32,
    pub(super) corner: u8,
    /// The first line that it does not cross.
    pub(super) end: u16,
    pub(super) x: i32,
    pub(super) remainder: i32,
    pub(super) dy: i32,
    /// What is added to `x` and `remainder` from line to line.
    pub(super) step: [i32; 2],
    /// The first pixel whose sample lies at the crossing or right of it.
    pub(super) column: u32,
}

/// The lines of `height` rows of pixels, from top to bottom.
pub(super) fn lines(pattern: &SamplePattern, top: usize, height: usize) -> Vec<Line> {
    let mut lines: Vec<_> = (0..height * pattern.len())
        .map(|i| {
            let (row, sample) = (i / pattern.len(), i % pattern.len());
            let [sample_x, sample_y] = pattern.position(sample);
            Line { y: (top + row) as i32 * SUBPIXEL + sample_y, row, sample, sample_x }
        })
        .collect();
    lines.sort_by_key(|line| line.y);
    lines
}

/// The distance from each line to the next if it is always the same, else 0.
pub(super) fn spacing(lines: &[Line]) -> i32 {
    let distance = |w: &[Line]| w[1].y - w[0].y;
    let first = lines.windows(2).map(distance).next().unwrap_or(0);
    if lines.windows(2).all(|w| distance(w) == first) { first } else { 0 }
}

/// All edges that cross a line, sorted by the line where they begin. Horizontal ones need no entry: a line that runs
/// along the top of a polygon crosses its other two edges, one along its bottom does not.
pub(super) fn edge_table(polygons: &[Polygon<'_>], lines: &[Line]) -> Vec<Edge> {
    let first_at = |y: i32| lines.partition_point(|line| line.y < y) as u16;
    let mut edges = Vec::new();
    for (p, polygon) in polygons.iter().enumerate() {
        let places = polygon.setup.y.map(first_at);
        for corner in 0..3u8 {
            let (a, b) = (places[usize::from(corner)], places[(usize::from(corner) + 1) % 3]);
            if a != b {
                edges.push(Edge { polygon: p as u32, corner, lines: a.min(b)..a.max(b) });
            }
        }
    }
    edges.sort_by_key(|e| e.lines.start);
    edges
}

/// Sorts by column; edges that were there before are nearly in order.
fn sort(active: &mut [ActiveEdge], joined: bool) {
    if joined {
        active.sort_by_key(|e| e.column);
        return;
    }
    for i in 1..active.len() {
        let edge = active[i];
        let mut j = i;
        while j > 0 && active[j - 1].column > edge.column {
            active[j] = active[j - 1];
            j -= 1;
        }
        active[j] = edge;
    }
}

impl ActiveEdge {
    pub(super) fn new(edge: &Edge, setup: &Setup, y: i32, spacing: i32) -> Self {
        let (dx, dy, _) = downwards(setup, edge.corner);
        let step = i64::from(dx) * i64::from(spacing);
        let step = [step.div_euclid(i64::from(dy)), step.rem_euclid(i64::from(dy))].map(|v| v as i32);
        let (polygon, corner, end) = (edge.polygon, edge.corner, edge.lines.end);
        let mut edge = Self { polygon, corner, end, x: 0, remainder: 0, dy, step, column: 0 };
        edge.cross(setup, y);
        edge
    }

    /// Finds the crossing with the line at `y` from the edge's corners.
    fn cross(&mut self, setup: &Setup, y: i32) {
        let (dx, dy, [x0, y0]) = downwards(setup, self.corner);
        let along = i64::from(dx) * i64::from(y - y0);
        self.x = x0 + along.div_euclid(i64::from(dy)) as i32;
        self.remainder = along.rem_euclid(i64::from(dy)) as i32;
    }

    /// Moves the crossing one line down, to `y`.
    fn advance(&mut self, spacing: i32, setup: &Setup, y: i32) {
        if spacing == 0 {
            return self.cross(setup, y);
        }
        self.x += self.step[0];
        self.remainder += self.step[1];
        if self.remainder >= self.dy {
            self.remainder -= self.dy;
            self.x += 1;
        }
    }

    /// The first pixel whose sample on this line is not left of the crossing, at most `width`. A sample on a left edge
    /// is in and one on a right edge is out, so the same pixel begins what is right of either.
    fn column_on(&self, line: &Line, width: u32) -> u32 {
        let first_x = self.x + i32::from(self.remainder > 0);
        ((first_x - line.sample_x + SUBPIXEL - 1) >> 8).clamp(0, width as i32) as u32
    }
}

/// The active edge table, from line to line.
pub(super) struct ActiveEdges<'e> {
    edges: &'e [Edge],
    /// Those that begin on lines to come.
    starting: &'e [Edge],
    active: Vec<ActiveEdge>,
    /// Where edges crossed the last line, for a table that is not kept from line to line.
    crossings: Vec<Option<ActiveEdge>>,
    spacing: i32,
    is_kept: bool,
    width: u32,
}

impl<'e> ActiveEdges<'e> {
    /// Of lines with this spacing, 0 if each crossing is to be found anew. If the table is not kept, each line begins with an
    /// empty one and looks for its edges among all that began above it.
    pub(super) fn new(edges: &'e [Edge], spacing: i32, is_kept: bool, width: u32) -> Self {
        let crossings = if spacing != 0 && !is_kept { vec![None; edges.len()] } else { Vec::new() };
        Self { edges, starting: edges, active: Vec::new(), crossings, spacing, is_kept, width }
    }

    /// The edges that cross the line, from left to right.
    pub(super) fn sorted(&self) -> &[ActiveEdge] {
        &self.active
    }

    /// Goes on to line `number`, which is the next one.
    pub(super) fn move_to(
        &mut self,
        number: usize,
        line: &Line,
        polygons: &[Polygon<'_>],
        counters: &mut VisibilityCounters,
    ) {
        // Let edges leave that end above the line, and move the others to it.
        self.active.retain(|e| usize::from(e.end) > number);
        if !self.is_kept {
            self.active.clear();
            self.starting = self.edges;
        }
        for edge in &mut self.active {
            edge.advance(self.spacing, polygons[edge.polygon as usize].setup, line.y);
        }
        let kept = self.active.len() as u64;
        counters.saved_by_scan_line += kept;
        counters.saved_by_edge += if self.spacing == 0 { 0 } else { kept };

        // Let edges join that begin.
        let joined = self.join(number, line, polygons, counters);

        // Sort from left to right.
        for edge in &mut self.active {
            edge.column = edge.column_on(line, self.width);
        }
        sort(&mut self.active, joined);
        counters.active_edges += self.active.len() as u64;
    }

    /// Adds the edges that begin on or above a line and are not in the table; whether there may be some.
    fn join(
        &mut self,
        number: usize,
        line: &Line,
        polygons: &[Polygon<'_>],
        counters: &mut VisibilityCounters,
    ) -> bool {
        let joining = self.starting.partition_point(|e| usize::from(e.lines.start) <= number);
        let (begun, later) = self.starting.split_at(joining);
        for (i, edge) in begun.iter().enumerate().filter(|(_, e)| usize::from(e.lines.end) > number) {
            let setup = polygons[edge.polygon as usize].setup;
            self.active.push(match self.crossings.get_mut(i) {
                Some(Some(known)) => {
                    known.advance(self.spacing, setup, line.y);
                    counters.saved_by_edge += 1;
                    *known
                }
                none => {
                    let new = ActiveEdge::new(edge, setup, line.y, self.spacing);
                    none.into_iter().for_each(|crossing| *crossing = Some(new));
                    new
                }
            });
        }
        self.starting = later;
        joining > 0
    }
}

/// `dx`, `dy > 0` and the upper end of a triangle's edge that is not horizontal.
pub(super) fn downwards(setup: &Setup, corner: u8) -> (i32, i32, [i32; 2]) {
    let (i, j) = (usize::from(corner), (usize::from(corner) + 1) % 3);
    let (i, j) = if setup.y[i] < setup.y[j] { (i, j) } else { (j, i) };
    (setup.x[j] - setup.x[i], setup.y[j] - setup.y[i], [setup.x[i], setup.y[i]])
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use vitral_raster::CornerPosition;

    pub(in crate::visible::scanline) fn triangle(corners: [[i32; 2]; 3], z: [f32; 3]) -> Setup {
        let [a, b, c] = [0, 1, 2].map(|i| CornerPosition { x: corners[i][0], y: corners[i][1], z: z[i] });
        Setup::new([a, b, c], Setup::doubled_area(a, b, c), 0)
    }

    /// Pixels of a line that the active edges say are covered.
    fn covered(setup: &Setup, pattern: &SamplePattern, width: u32) -> Vec<(i32, Range<u32>)> {
        let lines = lines(pattern, 0, 16);
        let spacing = spacing(&lines);
        let edges = edge_table(&[Polygon::new(setup)], &lines);
        let mut active: Vec<ActiveEdge> = Vec::new();
        let mut spans = Vec::new();
        for (number, line) in lines.iter().enumerate() {
            active.retain(|e| usize::from(e.end) > number);
            active.iter_mut().for_each(|e| e.advance(spacing, setup, line.y));
            let joining = edges.iter().filter(|e| usize::from(e.lines.start) == number);
            active.extend(joining.map(|e| ActiveEdge::new(e, setup, line.y, spacing)));
            let mut columns: Vec<_> = active.iter().map(|e| e.column_on(line, width)).collect();
            columns.sort_unstable();
            assert!(columns.is_empty() || columns.len() == 2, "a line crosses two edges of a triangle, or none");
            spans.push((line.y, columns.first().copied().unwrap_or(0)..columns.last().copied().unwrap_or(0)));
        }
        spans
    }

    #[test]
    fn p19_spans_of_edges_are_the_samples_that_the_edge_functions_cover() {
        let mut random = 7u32;
        let mut next = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 8) as i32
        };
        for samples in [1, 3, 4] {
            let pattern = SamplePattern::new(samples);
            for round in 0..300 {
                // Every other triangle lies on a coarse grid, where samples meet corners and edges.
                let grid = if round % 2 == 0 { 32 } else { 1 };
                let corners = [0; 3].map(|_| [0; 2].map(|_| (next() % 6000 - 900) / grid * grid));
                let setup = triangle(corners, [0.5; 3]);
                for (line, (y, span)) in lines(&pattern, 0, 16).iter().zip(covered(&setup, &pattern, 16)) {
                    for x in 0..16 {
                        let covers = setup.covers(x as i32 * SUBPIXEL + line.sample_x, y);
                        assert_eq!(covers, span.contains(&x), "{corners:?}, pixel {x}, y {y}");
                    }
                }
            }
        }
    }
}
