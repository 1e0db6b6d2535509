//! The tables of the scan-line algorithm: lines, polygons, edges, and the edges that a line
//! crosses.
//!
//! In:   convex polygons (screen space). Out: for each line its crossings, from left to right.
//! Cost: linear in edges and crossings; sorting is nearly so.
//! Source: [Wylie et al. 1967]. Departs from it: a crossing is an exact fraction, a whole number
//!         and a remainder.

use super::face::OnLine;
use crate::stats::VisibilityCounters;
use crate::visible::polygons::{ConvexPolygon, Polygons};
use std::ops::Range;
use vitral_raster::{SUBPIXEL, SamplePattern, Setup};

/// A row of samples.
#[derive(Clone, Copy)]
pub(super) struct SampleLine {
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
pub(super) struct PolygonEntry<'f> {
    pub(super) shape: ConvexPolygon<'f, 'f>,
    /// The in-out flag: where the polygon stands in the list of those that are in, or [`OUT`].
    pub(super) slot: u32,
    /// The last line to which the face's depth was brought, and the depth there:
    /// [`Setup::depth_of_line`].
    pub(super) line: i32,
    pub(super) start: f32,
}

/// The in-out flag of polygons that are out.
pub(super) const OUT: u32 = u32::MAX;

impl<'f> PolygonEntry<'f> {
    /// One that is out, on no line yet.
    fn new(shape: ConvexPolygon<'f, 'f>) -> Self {
        Self { shape, slot: OUT, line: i32::MIN, start: 0.0 }
    }

    /// Its depth plane.
    #[inline(always)]
    pub(super) fn plane(&self) -> &'f Setup {
        self.shape.plane()
    }

    /// On the line to which it was brought.
    #[inline(always)]
    pub(super) fn on_line(&self) -> OnLine<'f> {
        OnLine { setup: self.plane(), start: self.start }
    }
}

/// An entry of the edge table: the edge from corner `corner` of a polygon to the next, crossed by
/// `lines`.
pub(super) struct EdgeEntry {
    pub(super) polygon: u32,
    pub(super) corner: u32,
    pub(super) lines: Range<u16>,
}

/// An entry of the active edge table. The edge crosses the line at `x + remainder / dy`.
#[derive(Clone, Copy)]
pub(super) struct ActiveEdge {
    pub(super) polygon: u32,
    pub(super) corner: u32,
    /// The first line that it does not cross.
    pub(super) end: u16,
    /// Where the edge crosses the line, rounded down to 1/256 pixel.
    pub(super) x: i32,
    /// The rest of the division, in 1/`dy`.
    pub(super) remainder: i32,
    /// Height of the edge in 1/256 pixel.
    pub(super) dy: i32,
    /// What is added to `x` and `remainder` from line to line.
    pub(super) step: [i32; 2],
    /// The first pixel whose sample lies at the crossing or right of it.
    pub(super) column: u32,
}

/// The polygon table.
pub(super) fn polygon_table<'p>(polygons: &'p Polygons<'_>) -> Vec<PolygonEntry<'p>> {
    (0..polygons.len()).map(|number| PolygonEntry::new(polygons.get(number))).collect()
}

/// The lines of `height` rows of pixels, from top to bottom.
pub(super) fn lines(pattern: &SamplePattern, top: usize, height: usize) -> Vec<SampleLine> {
    let mut lines: Vec<_> = (0..height * pattern.len())
        .map(|i| {
            let (row, sample) = (i / pattern.len(), i % pattern.len());
            let [sample_x, sample_y] = pattern.position(sample);
            SampleLine { y: (top + row) as i32 * SUBPIXEL + sample_y, row, sample, sample_x }
        })
        .collect();
    lines.sort_by_key(|line| line.y);
    lines
}

/// The distance from each line to the next if it is always the same, else 0.
pub(super) fn spacing(lines: &[SampleLine]) -> i32 {
    let distance = |w: &[SampleLine]| w[1].y - w[0].y;
    let first = lines.windows(2).map(distance).next().unwrap_or(0);
    if lines.windows(2).all(|w| distance(w) == first) { first } else { 0 }
}

/// All edges that cross a line, sorted by the line where they begin. Horizontal ones need no entry:
/// a line that runs along the top of a polygon crosses its other two edges, one along its bottom
/// does not.
pub(super) fn edge_table(polygons: &[PolygonEntry<'_>], lines: &[SampleLine]) -> Vec<EdgeEntry> {
    let first_at = |y: i32| lines.partition_point(|line| line.y < y) as u16;
    let mut edges = Vec::new();
    // Find the line of each corner; an edge runs from one to the next.
    for (p, polygon) in polygons.iter().enumerate() {
        let outline = polygon.shape.outline();
        let first = first_at(outline[0][1]);
        let mut a = first;
        for corner in 0..outline.len() {
            let b = outline.get(corner + 1).map_or(first, |next| first_at(next[1]));
            if a != b {
                edges.push(EdgeEntry {
                    polygon: p as u32,
                    corner: corner as u32,
                    lines: a.min(b)..a.max(b),
                });
            }
            a = b;
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
    pub(super) fn new(edge: &EdgeEntry, outline: &[[i32; 2]], y: i32, spacing: i32) -> Self {
        let (dx, dy, _) = downwards(outline, edge.corner);
        let step = i64::from(dx) * i64::from(spacing);
        let step =
            [step.div_euclid(i64::from(dy)), step.rem_euclid(i64::from(dy))].map(|v| v as i32);
        let (polygon, corner, end) = (edge.polygon, edge.corner, edge.lines.end);
        let mut edge = Self { polygon, corner, end, x: 0, remainder: 0, dy, step, column: 0 };
        edge.cross(outline, y);
        edge
    }

    /// Finds the crossing with the line at `y` from the edge's corners.
    fn cross(&mut self, outline: &[[i32; 2]], y: i32) {
        [self.x, self.remainder] = crossing(downwards(outline, self.corner), y);
    }

    /// Moves the crossing one line down, to `y`.
    fn advance(&mut self, spacing: i32, outline: &[[i32; 2]], y: i32) {
        if spacing == 0 {
            return self.cross(outline, y);
        }
        self.x += self.step[0];
        self.remainder += self.step[1];
        if self.remainder >= self.dy {
            self.remainder -= self.dy;
            self.x += 1;
        }
    }

    /// [`column`], at most `width`.
    fn column_on(&self, line: &SampleLine, width: u32) -> u32 {
        column([self.x, self.remainder], line).clamp(0, width as i32) as u32
    }
}

/// Where an edge, given by its extent and its upper end, crosses the line at `y`: a whole number
/// and a remainder.
fn crossing((dx, dy, [x0, y0]): (i32, i32, [i32; 2]), y: i32) -> [i32; 2] {
    let (along, dy) = (i64::from(dx) * i64::from(y - y0), i64::from(dy));
    [x0 + along.div_euclid(dy) as i32, along.rem_euclid(dy) as i32]
}

/// The first pixel whose sample on a line is not left of a crossing. A sample on a left edge is in
/// and one on a right edge is out, so the same pixel begins the span right of either.
fn column([x, remainder]: [i32; 2], line: &SampleLine) -> i32 {
    (x + i32::from(remainder > 0) - line.sample_x + SUBPIXEL - 1) >> 8
}

/// Which of these pixels of a line a triangle covers.
pub(super) fn covered(triangle: &Setup, line: &SampleLine, pixels: &Range<usize>) -> Range<usize> {
    let outline = triangle.corners();
    let [first, last] = [pixels.start, pixels.end].map(|pixel| pixel as i32);
    let (mut from, mut to) = (last, first);
    for corner in 0..3 {
        let ends = [outline[corner][1], outline[(corner + 1) % 3][1]];
        if (ends[0] <= line.y) != (ends[1] <= line.y) {
            let crossed = column(crossing(downwards(&outline, corner as u32), line.y), line)
                .clamp(first, last);
            (from, to) = (from.min(crossed), to.max(crossed));
        }
    }
    from as usize..to.max(from) as usize
}

/// The active edge table, from line to line.
pub(super) struct ActiveEdges<'e> {
    edges: &'e [EdgeEntry],
    /// Those that begin on lines to come.
    starting: &'e [EdgeEntry],
    active: Vec<ActiveEdge>,
    /// Where edges crossed the last line, for a table that is not kept from line to line.
    crossings: Vec<Option<ActiveEdge>>,
    spacing: i32,
    is_kept: bool,
    width: u32,
}

impl<'e> ActiveEdges<'e> {
    /// Of lines with this spacing, 0 if each crossing is to be found anew. If the table is not
    /// kept, each line begins with an empty one and looks for its edges among all that began above
    /// it.
    pub(super) fn new(edges: &'e [EdgeEntry], spacing: i32, is_kept: bool, width: u32) -> Self {
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
        line: &SampleLine,
        polygons: &[PolygonEntry<'_>],
        counters: &mut VisibilityCounters,
    ) {
        // Let edges leave that end above the line, and move the others to it.
        self.active.retain(|e| usize::from(e.end) > number);
        if !self.is_kept {
            self.active.clear();
            self.starting = self.edges;
        }
        for edge in &mut self.active {
            edge.advance(self.spacing, polygons[edge.polygon as usize].shape.outline(), line.y);
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

    /// Adds the edges that begin on or above a line and are not in the table; whether there may be
    /// some.
    fn join(
        &mut self,
        number: usize,
        line: &SampleLine,
        polygons: &[PolygonEntry<'_>],
        counters: &mut VisibilityCounters,
    ) -> bool {
        // Take the edges that begin on or above the line and do not end there.
        let joining = self.starting.partition_point(|e| usize::from(e.lines.start) <= number);
        let (begun, later) = self.starting.split_at(joining);
        for (i, edge) in begun.iter().enumerate().filter(|(_, e)| usize::from(e.lines.end) > number)
        {
            let outline = polygons[edge.polygon as usize].shape.outline();
            // Advance a crossing that is known from the line above, or compute it.
            self.active.push(match self.crossings.get_mut(i) {
                Some(Some(known)) => {
                    known.advance(self.spacing, outline, line.y);
                    counters.saved_by_edge += 1;
                    *known
                }
                none => {
                    let new = ActiveEdge::new(edge, outline, line.y, self.spacing);
                    none.into_iter().for_each(|crossing| *crossing = Some(new));
                    new
                }
            });
        }
        self.starting = later;
        joining > 0
    }
}

/// `dx`, `dy > 0` and the upper end of a polygon's edge that is not horizontal.
pub(super) fn downwards(outline: &[[i32; 2]], corner: u32) -> (i32, i32, [i32; 2]) {
    let from = outline[corner as usize];
    let to = outline.get(corner as usize + 1).copied().unwrap_or(outline[0]);
    let (upper, lower) = if from[1] < to[1] { (from, to) } else { (to, from) };
    (lower[0] - upper[0], lower[1] - upper[1], upper)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use vitral_raster::CornerPosition;

    pub(in crate::visible::scanline) fn triangle(corners: [[i32; 2]; 3], z: [f32; 3]) -> Setup {
        let [a, b, c] =
            [0, 1, 2].map(|i| CornerPosition { x: corners[i][0], y: corners[i][1], z: z[i] });
        Setup::new([a, b, c], Setup::doubled_area(a, b, c), 0)
    }

    /// The polygons that are triangles, each alone.
    pub(in crate::visible::scanline) fn apart(setups: &[Setup]) -> Polygons<'_> {
        Polygons::joined(setups, |facet| facet)
    }

    /// Pixels of a line that the active edges say are covered.
    fn columns(setup: &Setup, pattern: &SamplePattern, width: u32) -> Vec<(i32, Range<u32>)> {
        let lines = lines(pattern, 0, 16);
        let spacing = spacing(&lines);
        let polygons = apart(std::slice::from_ref(setup));
        let outline = polygons.get(0).outline();
        let edges = edge_table(&polygon_table(&polygons), &lines);
        let mut active: Vec<ActiveEdge> = Vec::new();
        let mut spans = Vec::new();
        for (number, line) in lines.iter().enumerate() {
            active.retain(|e| usize::from(e.end) > number);
            active.iter_mut().for_each(|e| e.advance(spacing, outline, line.y));
            let joining = edges.iter().filter(|e| usize::from(e.lines.start) == number);
            active.extend(joining.map(|e| ActiveEdge::new(e, outline, line.y, spacing)));
            let mut columns: Vec<_> = active.iter().map(|e| e.column_on(line, width)).collect();
            columns.sort_unstable();
            assert!(
                columns.is_empty() || columns.len() == 2,
                "a line crosses two edges of a triangle, or none"
            );
            spans.push((
                line.y,
                columns.first().copied().unwrap_or(0)..columns.last().copied().unwrap_or(0),
            ));
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
                for (line, (y, span)) in
                    lines(&pattern, 0, 16).iter().zip(columns(&setup, &pattern, 16))
                {
                    assert!(
                        covered(&setup, line, &(0..16)).eq(span.start as usize..span.end as usize)
                    );
                    let part = covered(&setup, line, &(5..9));
                    assert!((5..=9).contains(&part.start) && (5..=9).contains(&part.end));
                    assert!(part.eq((5..9).filter(|&x| span.contains(&x)).map(|x| x as usize)));
                    for x in 0..16 {
                        let covers = setup.covers(x as i32 * SUBPIXEL + line.sample_x, y);
                        assert_eq!(covers, span.contains(&x), "{corners:?}, pixel {x}, y {y}");
                    }
                }
            }
        }
    }
}
