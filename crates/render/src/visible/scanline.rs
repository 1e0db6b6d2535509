//! Scan-line: the picture line by line, and on each line only from edge to edge.
//!
//! A horizontal line cuts a polygon in a span that begins and ends at edges. The edge table lists
//! all edges by the line where they begin. Going down, the active edge table holds the edges that
//! the line crosses, sorted from left to right: edges join where they begin, leave where they end,
//! and in between move by a constant step, so the order hardly changes. Walking along the active
//! edges, the in-out flag of an edge's polygon in the polygon table turns: between two edges, the
//! polygons that are in do not change, and one decision serves the whole span. With one polygon in
//! there is nothing to decide. With several, their depths at the two ends of the span show which
//! are hidden throughout. If two are left (they penetrate each other, or touch), the span is cut
//! where their planes meet: along an implied edge, which two points fix for all lines to come
//! (`scanline/implied_edge.rs`). The part left near it, and where it cannot be told, is decided by
//! the depths at the samples.
//!
//! Each row of samples is a line, so a picture with four samples a pixel has four lines a row of
//! pixels. Bands of 64 rows of pixels are swept independently, by as many threads as there are.
//!
//! In:   set-up triangles, joined to polygons (screen space). Out: the samples of each tile (screen
//!       space).
//! Cost: edges crossed on all lines, plus spans times the polygons that are in, plus covered
//!       samples.
//! Source: [Wylie et al. 1967], [Bouknight 1970], [Watkins 1970]. Departs from them: a flat face is
//! entered as convex polygons, mostly one, and a sample keeps the triangle of the polygon that
//! covers it; where an edge crosses a line is kept as an exact fraction (a whole number and a
//! remainder), so that spans begin and end where the integer edge functions say; depth is not added
//! up along the span but taken from the facet's one depth function. Coherence: of edges (the sorted
//! table is carried from line to line, crossings are stepped), of spans (the winner of the last
//! span is tried first, and whatever is farther with all of its facet is passed over without a
//! look), of faces (their depth is brought to a line once, for all of their spans and samples
//! there: `scanline/face.rs`), of implied edges.

mod edges;
mod face;
mod implied_edge;
mod report;
mod spans;

use super::facets::{Facets, fill_tiles};
use super::polygons::Polygons;
use super::sink::TileSink;
use super::{Resolved, VisibleSurface};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::trace::Step;
use crate::{Coherence, Execution, PreparedView};
use edges::{
    ActiveEdge, ActiveEdges, EdgeEntry, PolygonEntry, edge_table, lines, polygon_table, spacing,
};
use spans::Spans;
use vitral_exec::Limit;
use vitral_raster::{TILE, Tile, TileGrid};

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
        fill_tiles(
            view,
            marks,
            grid,
            execution,
            sink,
            tiles_a_row,
            &|facets, first, tiles, counters| {
                let row = first / tiles_a_row;
                let bytes = facets.in_row(row).len() as u64 * BYTES_A_TRIANGLE;
                let budget = &facets.execution().budget;
                budget.charge(bytes, "scan-line")?;
                let swept = sweep(facets, row, tiles, counters);
                budget.release(bytes);
                swept
            },
        )
    }
}

/// Entries of the tables for a polygon that is one triangle; the more triangles a polygon has, the
/// fewer there are for each.
const BYTES_A_TRIANGLE: u64 = Polygons::BYTES_A_TRIANGLE
    + (size_of::<PolygonEntry<'_>>()
        + 2 * (size_of::<EdgeEntry>() + size_of::<Option<ActiveEdge>>())
        + size_of::<ActiveEdge>()) as u64;

/// Sweeps one row of tiles.
fn sweep(
    facets: &Facets<'_, '_>,
    row: usize,
    tiles: &mut [Tile],
    counters: &mut VisibilityCounters,
) -> Result<(), Limit> {
    // Make the polygon table and the edge table. Without edge coherence each crossing is found
    // anew, as if lines had no common distance.
    let (view, execution) = (facets.view(), facets.execution());
    let height = TILE.min(view.viewport.height as usize - row * TILE);
    let lines = lines(&view.pattern, row * TILE, height);
    let spacing = if view.coherence.has(Coherence::Edge) { spacing(&lines) } else { 0 };
    let joined = Polygons::new(facets.in_row(row), view);
    let mut polygons = polygon_table(&joined);
    let edges = edge_table(&polygons, &lines);
    report::tables(
        execution,
        view,
        [row * TILE, row * TILE + height],
        (&polygons, &edges),
        &lines,
    )?;

    // Sweep: on each line bring the active edges to it, and fill the spans between them.
    let mut active = ActiveEdges::new(
        &edges,
        spacing,
        view.coherence.has(Coherence::ScanLine),
        view.viewport.width,
    );
    let mut spans = Spans::new(&mut polygons, tiles, view.coherence, counters);
    for (number, line) in lines.iter().enumerate() {
        execution.budget.check("scan-line")?;
        if execution.observer.is_some() {
            spans.reported = Some(Vec::new());
        }
        active.move_to(number, line, spans.polygons, spans.counters);
        spans.walk(active.sorted(), line);
        if let Some(spans_of_line) = spans.reported.take() {
            let (row, sample) = ((row * TILE + line.row) as u32, line.sample as u32);
            let active_edges = report::crossings(active.sorted(), spans.polygons);
            execution.report(|| Step::Line { row, sample, active_edges, spans: spans_of_line });
        }
    }
    spans.finish();
    Ok(())
}
