//! Scan-line: the picture line by line, and on each line only from edge to edge.
//!
//! A horizontal line cuts a polygon in a span that begins and ends at edges. The edge table lists all edges by the line
//! where they begin. Going down, the active edge table holds the edges that the line crosses, sorted from left to
//! right: edges join where they begin, leave where they end, and in between move by a constant step, so the order hardly
//! changes. Walking along the active edges, the in-out flag of an edge's polygon in the polygon table turns: between two
//! edges, the polygons that are in do not change, and one decision serves the whole span. With one polygon in there is
//! nothing to decide. With several, their depths at the two ends of the span show which are hidden throughout. If two are
//! left (they penetrate each other, or touch), the span is cut where their planes meet: along an implied edge, which two
//! points fix for all lines to come (`scanline/implied_edge.rs`). What is left near it, and where it cannot be told, is
//! decided by the depths at the samples.
//!
//! Each row of samples is a line, so a picture with four samples a pixel has four lines a row of pixels. Bands of 64
//! rows of pixels are swept independently, by as many threads as there are.
//!
//! In:   set-up triangles (screen space). Out: the samples of each tile (screen space).
//! Cost: edges crossed on all lines, plus spans times the polygons that are in, plus covered samples.
//! Source: [Wylie et al. 1967], [Bouknight 1970], [Watkins 1970]. Departs from them: where an edge crosses a line is
//! kept as an exact fraction (a whole number and a remainder), so that spans begin and end where the integer edge
//! functions say; depth is not added up along the span but taken from the facet's one depth function.
//! Coherence: of edges (the sorted table is carried from line to line, crossings are stepped), of spans (the winner of the
//! last span is tried first, and whatever is farther with all of its facet is passed over without a look), of faces (their
//! depth is brought to a line once, for all of their spans and samples there: `scanline/face.rs`), of implied edges.

mod face;
mod implied_edge;
mod told;

use super::facets::{Facets, fill_tiles, nearer};
use super::{Resolved, TileSink, VisibleSurface};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::trace::{Span, SpanVerdict, Step};
use crate::{Coherence, CoherenceSet, Execution, PreparedView};
use face::OnLine;
use implied_edge::ImpliedEdges;
use std::ops::Range;
use vitral_exec::Limit;
use vitral_raster::{SUBPIXEL, SamplePattern, Setup, TILE, TILE_PIXELS, Tile, TileGrid};

/// Parts of spans that are shorter are decided at their samples without asking for an implied edge.
const LONG: usize = 4;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct ScanLine;

impl VisibleSurface for ScanLine {
    fn resolve(
        &self,
        view: &PreparedView<'_>,
        marks: Option<&Marks>,
        grid: &mut TileGrid,
        execution: &Execution,
        sink: &dyn TileSink,
    ) -> Result<Resolved, Limit> {
        let tiles_a_row = view.viewport.tiles_x() as usize;
        fill_tiles(view, marks, grid, execution, sink, tiles_a_row, &|facets, first, tiles, counters| {
            let row = first / tiles_a_row;
            let bytes = facets.in_row(row).len() as u64 * BYTES_A_POLYGON;
            let budget = &facets.execution().budget;
            budget.charge(bytes, "scan-line")?;
            let swept = sweep(facets, row, tiles, counters);
            budget.release(bytes);
            swept
        })
    }
}

/// A row of samples.
#[derive(Clone, Copy)]
struct Line {
    /// Within the picture, 1/256 pixel.
    y: i32,
    /// Row of pixels within the band.
    row: usize,
    /// Which sample of the pixels.
    sample: usize,
    /// Its place in the pixel, 1/256 pixel.
    sample_x: i32,
}

/// An entry of the polygon table.
struct Polygon<'f> {
    setup: &'f Setup,
    /// The in-out flag: where the polygon stands in the list of those that are in, or [`OUT`].
    slot: u32,
    /// The last line to which the face's depth was brought, and the depth there: [`Setup::depth_of_line`].
    line: i32,
    start: f32,
}

/// The in-out flag of polygons that are out.
const OUT: u32 = u32::MAX;

impl<'f> Polygon<'f> {
    /// One that is out, on no line yet.
    fn new(setup: &'f Setup) -> Self {
        Self { setup, slot: OUT, line: i32::MIN, start: 0.0 }
    }

    /// On the line to which it was brought.
    #[inline(always)]
    fn on_line(&self) -> OnLine<'f> {
        OnLine { setup: self.setup, start: self.start }
    }
}

/// An entry of the edge table: the edge from corner `corner` of a polygon to the next, crossed by `lines`.
struct Edge {
    polygon: u32,
    corner: u8,
    lines: Range<u16>,
}

/// An entry of the active edge table. The edge crosses the line at `x + remainder / dy`.
#[derive(Clone, Copy)]
struct ActiveEdge {
    polygon: u32,
    corner: u8,
    /// The first line that it does not cross.
    end: u16,
    x: i32,
    remainder: i32,
    dy: i32,
    /// What is added to `x` and `remainder` from line to line.
    step: [i32; 2],
    /// The first pixel whose sample lies at the crossing or right of it.
    column: u32,
}

/// Entries of the tables for one polygon.
const BYTES_A_POLYGON: u64 = (size_of::<Polygon<'_>>()
    + 2 * (size_of::<Edge>() + size_of::<Option<ActiveEdge>>())
    + size_of::<ActiveEdge>()) as u64;

/// Sweeps one row of tiles.
fn sweep(
    facets: &Facets<'_, '_>,
    row: usize,
    tiles: &mut [Tile],
    counters: &mut VisibilityCounters,
) -> Result<(), Limit> {
    let view = facets.view();
    let height = TILE.min(view.viewport.height as usize - row * TILE);
    let lines = lines(&view.pattern, row * TILE, height);
    let (coherence, execution) = (view.coherence, facets.execution());
    // Without edge coherence each crossing is found anew, as if lines had no common distance.
    let spacing = if coherence.has(Coherence::Edge) { spacing(&lines) } else { 0 };
    let mut polygons: Vec<_> = facets.in_row(row).map(Polygon::new).collect();
    let edges = edge_table(&polygons, &lines);
    told::tables(execution, view, [row * TILE, row * TILE + height], (&polygons, &edges), &lines)?;
    let mut starting = edges.as_slice();
    let mut active: Vec<ActiveEdge> = Vec::new();
    // Where edges crossed the line before, for a table that is not kept from line to line.
    let mut crossings: Vec<Option<ActiveEdge>> = Vec::new();
    if spacing != 0 && !coherence.has(Coherence::ScanLine) {
        crossings.resize(edges.len(), None);
    }
    let mut spans = Spans {
        polygons: &mut polygons,
        inside: Vec::new(),
        last: 0,
        rivals: Vec::new(),
        implied: ImpliedEdges::default(),
        coherence,
        told: None,
        tiles,
        counters,
    };
    for (number, line) in lines.iter().enumerate() {
        execution.budget.check("scan-line")?;
        if execution.observer.is_some() {
            spans.told = Some(Vec::new());
        }

        // Let edges leave that end above the line, move the others to it, and let edges join that begin.
        active.retain(|e| usize::from(e.end) > number);
        if !coherence.has(Coherence::ScanLine) {
            // Each line begins with an empty table, and looks for its edges among all that began above it.
            active.clear();
            starting = &edges;
        }
        for edge in &mut active {
            edge.advance(spacing, spans.polygons[edge.polygon as usize].setup, line.y);
        }
        let kept = active.len() as u64;
        let mut advanced = if spacing == 0 { 0 } else { kept };
        let joining = starting.partition_point(|e| usize::from(e.lines.start) <= number);
        for (i, edge) in starting[..joining].iter().enumerate().filter(|(_, e)| usize::from(e.lines.end) > number) {
            let setup = spans.polygons[edge.polygon as usize].setup;
            active.push(match crossings.get_mut(i) {
                Some(Some(before)) => {
                    before.advance(spacing, setup, line.y);
                    advanced += 1;
                    *before
                }
                none => {
                    let new = ActiveEdge::new(edge, setup, line.y, spacing);
                    none.into_iter().for_each(|place| *place = Some(new));
                    new
                }
            });
        }
        starting = &starting[joining..];
        spans.counters.saved_by_scan_line += kept;
        spans.counters.saved_by_edge += advanced;

        // Sort from left to right.
        for edge in &mut active {
            edge.column = edge.column_on(line, view.viewport.width);
        }
        sort(&mut active, joining > 0);
        spans.counters.active_edges += active.len() as u64;
        spans.walk(&active, line);
        if let Some(told) = spans.told.take() {
            let (row, sample) = ((row * TILE + line.row) as u32, line.sample as u32);
            let active_edges = told::crossings(&active, spans.polygons);
            execution.tell(|| Step::Line { row, sample, active_edges, spans: told });
        }
    }
    spans.counters.implied_edges += spans.implied.found;
    Ok(())
}

/// The lines of `height` rows of pixels, from top to bottom.
fn lines(pattern: &SamplePattern, top: usize, height: usize) -> Vec<Line> {
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
fn spacing(lines: &[Line]) -> i32 {
    let distance = |w: &[Line]| w[1].y - w[0].y;
    let first = lines.windows(2).map(distance).next().unwrap_or(0);
    if lines.windows(2).all(|w| distance(w) == first) { first } else { 0 }
}

/// All edges that cross a line, sorted by the line where they begin. Horizontal ones need no entry: a line that runs
/// along the top of a polygon crosses its other two edges, one along its bottom does not.
fn edge_table(polygons: &[Polygon<'_>], lines: &[Line]) -> Vec<Edge> {
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
    fn new(edge: &Edge, setup: &Setup, y: i32, spacing: i32) -> Self {
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

/// `dx`, `dy > 0` and the upper end of a triangle's edge that is not horizontal.
fn downwards(setup: &Setup, corner: u8) -> (i32, i32, [i32; 2]) {
    let (i, j) = (usize::from(corner), (usize::from(corner) + 1) % 3);
    let (i, j) = if setup.y[i] < setup.y[j] { (i, j) } else { (j, i) };
    (setup.x[j] - setup.x[i], setup.y[j] - setup.y[i], [setup.x[i], setup.y[i]])
}

/// What is needed to fill the spans of a line.
struct Spans<'s, 'f> {
    polygons: &'s mut [Polygon<'f>],
    /// The polygons whose in-out flag is in.
    inside: Vec<u32>,
    /// The polygon that won the last span alone.
    last: u32,
    /// Workspace: polygons that may be visible somewhere in the span, with their nearest depth in it.
    rivals: Vec<(f32, u32)>,
    implied: ImpliedEdges,
    coherence: CoherenceSet,
    /// The spans of the line, if somebody wants to know.
    told: Option<Vec<Span>>,
    tiles: &'s mut [Tile],
    counters: &'s mut VisibilityCounters,
}

impl<'f> Spans<'_, 'f> {
    /// Walks along the active edges and fills the spans between them.
    fn walk(&mut self, active: &[ActiveEdge], line: &Line) {
        let mut from = 0;
        for edge in active {
            if edge.column > from {
                if !self.inside.is_empty() {
                    self.fill_all(from as usize..edge.column as usize, line);
                }
                from = edge.column;
            }
            self.turn(edge.polygon);
        }
    }

    /// Fills what lies between two edges: as one span, or pixel by pixel without area coherence.
    fn fill_all(&mut self, pixels: Range<usize>, line: &Line) {
        if self.coherence.has(Coherence::Area) {
            self.counters.saved_by_area += pixels.len() as u64 - 1;
            return self.fill(pixels, line);
        }
        pixels.for_each(|x| self.fill(x..x + 1, line));
    }

    /// Notes how a span was decided.
    fn tell(&mut self, pixels: &Range<usize>, verdict: SpanVerdict, winner: Option<u32>) {
        if let Some(told) = &mut self.told {
            let facet = winner.map(|p| self.polygons[p as usize].setup.facet);
            let pixels = [pixels.start, pixels.end].map(|x| x as u32);
            let mut inside: Vec<u32> = self.inside.iter().map(|&p| self.polygons[p as usize].setup.facet).collect();
            inside.sort_unstable();
            told.push(Span { pixels, inside, verdict, facet });
        }
    }

    /// Turns a polygon's in-out flag.
    fn turn(&mut self, polygon: u32) {
        let slot = &mut self.polygons[polygon as usize].slot;
        if *slot == OUT {
            *slot = self.inside.len() as u32;
            self.inside.push(polygon);
            return;
        }
        let hole = std::mem::replace(slot, OUT) as usize;
        self.inside.swap_remove(hole);
        if let Some(&moved) = self.inside.get(hole) {
            self.polygons[moved as usize].slot = hole as u32;
        }
    }

    /// Fills a span: with the one polygon that is in, or that hides the others, else sample by sample.
    fn fill(&mut self, pixels: Range<usize>, line: &Line) {
        self.counters.spans += 1;
        if let [only] = self.inside[..] {
            self.tell(&pixels, SpanVerdict::Only, Some(only));
            return self.fill_with(only, pixels, line);
        }
        self.find_rivals(&pixels, line);
        if let [(_, winner)] = self.rivals[..] {
            self.last = winner;
            self.tell(&pixels, SpanVerdict::Hides, Some(winner));
            return self.fill_with(winner, pixels, line);
        }
        let mut rivals = std::mem::take(&mut self.rivals);
        self.divide(pixels, &mut rivals, line);
        self.rivals = rivals;
    }

    /// Fills a span in which any of `rivals` may be seen: cuts it at the implied edge of the first two, and decides what
    /// no edge tells sample by sample.
    fn divide(&mut self, pixels: Range<usize>, rivals: &mut [(f32, u32)], line: &Line) {
        if pixels.is_empty() {
            return;
        }
        if let [(_, winner)] = *rivals {
            self.last = winner;
            self.tell(&pixels, SpanVerdict::ImpliedEdge, Some(winner));
            return self.fill_with(winner, pixels, line);
        }
        if pixels.len() < LONG || !self.coherence.has(Coherence::ImpliedEdge) {
            return self.fill_by_samples(pixels, rivals, line);
        }
        // The lower polygon first, so that a pair has one edge however it is found.
        if rivals[1].1 < rivals[0].1 {
            rivals.swap(0, 1);
        }
        let pair = [rivals[0].1, rivals[1].1];
        let setups = pair.map(|p| self.polygons[p as usize].setup);
        let parts = self.implied.divide(pair, setups, pixels.clone(), line.sample_x, line.y);
        let (left, right) = (pixels.start..parts.undecided.start, parts.undecided.end..pixels.end);
        self.counters.saved_by_implied_edge += (left.len() + right.len()) as u64;
        // Beside the edge, who is farther is no rival any more.
        let [left_loser, right_loser] = if parts.first_on_left { [pair[1], pair[0]] } else { pair };
        self.divide(left, without(rivals, left_loser), line);
        self.fill_by_samples(parts.undecided, rivals, line);
        self.divide(right, without(rivals, right_loser), line);
    }

    /// Takes the nearest of `rivals`, whose depths were brought to the line when they were found, at each sample.
    fn fill_by_samples(&mut self, pixels: Range<usize>, rivals: &[(f32, u32)], line: &Line) {
        if pixels.is_empty() {
            return;
        }
        self.tell(&pixels, SpanVerdict::Samples, None);
        self.counters.penetrated_spans += 1;
        self.counters.depth_comparisons += (pixels.len() * (rivals.len() - 1)) as u64;
        for x in pixels {
            let sample_x = x as i32 * SUBPIXEL + line.sample_x;
            let seen = rivals.iter().map(|&(_, p)| {
                let face = self.polygons[p as usize].on_line();
                (face.depth(sample_x), face.setup.facet)
            });
            let Some(seen) = seen.reduce(|a, b| if nearer(b, a) { b } else { a }) else { continue };
            super::facets::put(&mut self.tiles[x / TILE], place(x, line), seen);
        }
    }

    /// Brings a polygon's depth to the line, unless it is there already.
    #[inline]
    fn bring(&mut self, polygon: u32, line: &Line) -> OnLine<'f> {
        let polygon = &mut self.polygons[polygon as usize];
        if polygon.line == line.y && self.coherence.has(Coherence::Face) {
            self.counters.saved_by_face += 1;
        } else {
            (polygon.line, polygon.start) = (line.y, polygon.setup.depth_of_line(line.y));
        }
        polygon.on_line()
    }

    /// Finds the polygons that no other hides over the whole span, by their depths at its ends.
    fn find_rivals(&mut self, pixels: &Range<usize>, line: &Line) {
        let ends = [pixels.start, pixels.end - 1].map(|x| x as i32 * SUBPIXEL + line.sample_x);
        let by_depth = self.coherence.has(Coherence::Depth);
        let lucky = if !by_depth || self.polygons[self.last as usize].slot == OUT { self.inside[0] } else { self.last };
        // Some polygon is nowhere farther than `floor`.
        let (mut floor, near) = self.bring(lucky, line).range(ends);
        self.rivals.clear();
        self.rivals.push((near, lucky));
        for i in 0..self.inside.len() {
            let p = self.inside[i];
            if p == lucky {
                continue;
            }
            if by_depth && self.polygons[p as usize].setup.z_max < floor {
                self.counters.saved_by_depth += 1;
                continue;
            }
            self.counters.depth_comparisons += 1;
            let (far, near) = self.bring(p, line).range(ends);
            if near >= floor {
                self.rivals.push((near, p));
                floor = floor.max(far);
            }
        }
        self.rivals.retain(|&(near, _)| near >= floor);
    }

    /// Fills a span with one polygon.
    fn fill_with(&mut self, polygon: u32, pixels: Range<usize>, line: &Line) {
        let face = self.bring(polygon, line);
        let mut x = pixels.start;
        while x < pixels.end {
            let end = pixels.end.min((x / TILE + 1) * TILE);
            let (tile, at) = (&mut self.tiles[x / TILE], place(x, line));
            tile.touched = true;
            tile.facet[at..at + (end - x)].fill(face.setup.facet);
            for (depth, x) in tile.depth[at..].iter_mut().zip(x..end) {
                *depth = face.depth(x as i32 * SUBPIXEL + line.sample_x);
            }
            x = end;
        }
    }
}

/// The rivals but one, who is put first.
fn without(rivals: &mut [(f32, u32)], loser: u32) -> &mut [(f32, u32)] {
    let at = rivals.iter().position(|&(_, p)| p == loser).unwrap_or(0);
    rivals.swap(0, at);
    &mut rivals[1..]
}

/// Where a sample lies in its tile's planes.
fn place(x: usize, line: &Line) -> usize {
    line.sample * TILE_PIXELS + line.row * TILE + x % TILE
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_raster::CornerPosition;

    pub(super) fn triangle(corners: [[i32; 2]; 3], z: [f32; 3]) -> Setup {
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
