//! Visible and hidden parts of edges, each edge by itself.
//!
//! An edge begins wholly visible. Triangles near it are asked in the order of their nearest points,
//! and what each hides is taken away, until nothing is left or all that could hide were asked.
//! Where hidden lines are wanted, nothing ends early: all hidden intervals are sorted, and one
//! sweep counts how many of them cover each part, which is Appel's quantitative invisibility.
//!
//! No decision about an edge depends on another edge's, so edges are shared among threads, and a
//! mistake could not spread. Brute force is the same code that asks all triangles instead of the
//! grid; the result is the same to the last bit.
//!
//! In:   the page's mesh and a grid of the triangles that hide. Out: fragments of edges, in order
//!       of edges and along each.
//! Cost: `O(k log k)` for an edge with `k` triangles in its cells; short-lived lists only.
//! Source: [Appel 1967] for the counts. Departs from it: counts are not propagated from edge to
//!         edge.

use crate::classes::Classes;
use crate::grid::Grid;
use crate::hiding::{Interval, Sides};
use crate::layout::{Content, PageSize, lay_out};
use crate::page_mesh::{Edge, NONE, PageMesh};
use crate::place::{EdgePosition, Segment};
use crate::run::Run;
use crate::strokes::strokes;
use std::ops::ControlFlow;
use vitral_exec::{Limit, Spare};

/// Edges in one piece of work.
const BATCH: usize = 512;
/// Pieces of work in a round.
const ROUND: usize = 32;
/// Visible pieces of an edge beyond which intervals are collected and sorted instead: inserting
/// many is quadratic.
const MOST_PIECES: usize = 16;
/// Triangles that are asked between two looks at the clock.
const TESTS_A_CHECK: u32 = 1 << 16;

/// A part of an edge between two places where its visibility changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fragment {
    /// The edge's number in the mesh.
    pub(crate) edge: u32,
    /// Triangles in front of it.
    pub(crate) layers: u32,
    pub(crate) from: EdgePosition,
    pub(crate) to: EdgePosition,
}

/// Which parts of edges are wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// Edges of these classes.
    pub(crate) classes: Classes,
    /// Parts with up to so many layers in front; 0: only visible ones.
    pub(crate) most_layers: u32,
    /// The most segments that the drawing may have.
    pub(crate) most_segments: Option<u64>,
}

/// Counters of a pass over the edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VisibilityStats {
    /// Edges of wanted classes.
    pub edges: u64,
    /// Triangles in the lists of cells that edges run through.
    pub candidates: u64,
    /// Of these, triangles whose boxes meet that of the edge.
    pub tests: u64,
    /// Hidden intervals.
    pub intervals: u64,
}

/// Where triangles are looked for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Search<'g> {
    /// In the cells that an edge runs through.
    Grid(&'g Grid),
    /// Everywhere: brute force, which tests compare with.
    All,
}

/// The wanted fragments of all edges.
pub(crate) fn fragments(
    mesh: &PageMesh,
    search: Search<'_>,
    wanted: Wanted,
    run: &Run<'_>,
) -> Result<(Vec<Fragment>, VisibilityStats), Limit> {
    // Walk the edges of each batch on a thread of its own.
    let (spare, batches) = (Spare::<Walk>::default(), mesh.edges.len().div_ceil(BATCH));
    run.budget.begin("edges", mesh.edges.len() as u64);
    let of_batch = |batch: usize| {
        spare.lend(|walk| {
            walk.asked.resize(mesh.triangles.len(), NONE);
            let mut found = Vec::new();
            for edge in batch * BATCH..mesh.edges.len().min((batch + 1) * BATCH) {
                if !mesh.edges[edge].classes.common(wanted.classes).is_empty() {
                    walk.edge(mesh, edge as u32, search, wanted.most_layers, run, &mut found)?;
                }
                run.budget.advance();
            }
            run.memory.add((found.len() * size_of::<Fragment>()) as u64)?;
            run.budget.check("visibility")?;
            run.budget.progress("visibility", run.budget.achieved().done, mesh.edges.len() as u64);
            Ok(found)
        })
    };

    // Where segments are limited, go on in rounds, and look now and then at what the fragments
    // would become.
    let (mut fragments, mut watch) = (Vec::new(), wanted.most_segments.map(SegmentWatch::new));
    let round = if watch.is_some() { ROUND } else { batches.max(1) };
    for first in (0..batches).step_by(round) {
        for piece in run.workers.map(round.min(batches - first), |i| of_batch(first + i)) {
            fragments.extend(piece?);
        }
        if let Some(watch) = watch.as_mut().filter(|_| first + round < batches) {
            watch.look(mesh, &fragments, wanted.classes, run)?;
        }
    }
    let stats = spare
        .into_inner()
        .iter()
        .fold(VisibilityStats::default(), |sum, walk| sum.plus(&walk.stats));
    Ok((fragments, stats))
}

/// Stops the search for fragments where their segments are far too many.
///
/// Fragments still get fewer: coincident ones are dropped, and those in a line are joined. So they
/// are joined to be counted, each time that they have doubled. Fragments found later may join
/// earlier ones, so only twice the limit stops the search; the finished drawing is counted exactly.
struct SegmentWatch {
    limit: u64,
    /// Fragments at which they are counted next.
    next: u64,
}

impl SegmentWatch {
    fn new(limit: u64) -> Self {
        Self { limit, next: 2 * limit }
    }

    fn look(
        &mut self,
        mesh: &PageMesh,
        fragments: &[Fragment],
        wanted: Classes,
        run: &Run<'_>,
    ) -> Result<(), Limit> {
        let count = fragments.len() as u64;
        if count <= self.next {
            return Ok(());
        }
        self.next = 2 * count;
        let strokes = strokes(mesh, fragments, wanted, run)?;
        let content = Content {
            size: mesh.size,
            strokes: &strokes,
            regions: &[],
            cuts: &crate::hatch::Cuts::default(),
            points: &[],
        };
        let segments = lay_out(&content, PageSize::default(), 0.0).segments();
        let (limit, achieved) = (self.limit, run.budget.achieved());
        if segments > 2 * limit {
            Err(Limit::Segments { limit, stage: "visibility", achieved })
        } else {
            Ok(())
        }
    }
}

impl VisibilityStats {
    pub(crate) fn plus(self, other: &Self) -> Self {
        Self {
            edges: self.edges + other.edges,
            candidates: self.candidates + other.candidates,
            tests: self.tests + other.tests,
            intervals: self.intervals + other.intervals,
        }
    }
}

/// What a thread needs to look at edges.
#[derive(Default)]
struct Walk {
    /// For each triangle the edge that asked it last.
    asked: Vec<u32>,
    /// Visible pieces of the edge, in no order.
    pieces: Vec<(EdgePosition, EdgePosition)>,
    /// Hidden intervals of the edge.
    hidden: Vec<Interval>,
    changes: Vec<Change>,
    tests: u32,
    stats: VisibilityStats,
}

/// Where a hidden interval begins or ends.
#[derive(Clone, Copy)]
struct Change {
    place: EdgePosition,
    sides: Sides,
    by: i32,
}

impl Walk {
    /// Adds the fragments of an edge.
    fn edge(
        &mut self,
        mesh: &PageMesh,
        number: u32,
        search: Search<'_>,
        most_layers: u32,
        run: &Run<'_>,
        found: &mut Vec<Fragment>,
    ) -> Result<(), Limit> {
        let edge = &mesh.edges[number as usize];
        let segment = Segment { mesh, ends: mesh.ends(edge) };
        let [p, q] = segment.ends;
        if (p[0], p[1]) == (q[0], q[1]) {
            // Seen end-on, it is a point.
            return Ok(());
        }

        // Start with the whole edge visible.
        self.stats.edges += 1;
        self.pieces.clear();
        self.hidden.clear();
        self.pieces.push((EdgePosition::START, EdgePosition::END));

        // Subtract what the triangles hide, by the grid or one by one.
        let visible_only = most_layers == 0;
        let flow = match search {
            Search::Grid(grid) => grid.along(segment.ends, visible_only, |list: &[u32]| {
                self.ask(list, &segment, edge, number, visible_only, run)
            }),
            Search::All => (0..mesh.triangles.len() as u32)
                .filter(|&t| mesh.triangles[t as usize].hides)
                .try_for_each(|t| {
                    match self.ask(&[t], &segment, edge, number, visible_only, run) {
                        ControlFlow::Break(Some(limit)) => ControlFlow::Break(Some(limit)),
                        _ => ControlFlow::Continue(()),
                    }
                }),
        };
        if let ControlFlow::Break(Some(limit)) = flow {
            return Err(limit);
        }

        // Emit the visible pieces, or count layers along the edge.
        self.stats.intervals += self.hidden.len() as u64;
        if visible_only && self.pieces.len() <= MOST_PIECES {
            self.pieces.sort_by(|a, b| segment.compare(&a.0, &b.0));
            let visible = |&(from, to): &(EdgePosition, EdgePosition)| Fragment {
                edge: number,
                layers: 0,
                from,
                to,
            };
            found.extend(self.pieces.iter().map(visible));
        } else {
            self.sweep(&segment, number, most_layers, found);
        }
        Ok(())
    }

    /// Tests the triangles of a list, the nearest first; breaks when all of the edge is hidden, or
    /// at a limit.
    fn ask(
        &mut self,
        list: &[u32],
        segment: &Segment<'_>,
        edge: &Edge,
        number: u32,
        visible_only: bool,
        run: &Run<'_>,
    ) -> ControlFlow<Option<Limit>> {
        // Bound the edge.
        let [p, q] = segment.ends;
        let (low, high) = ([p[0].min(q[0]), p[1].min(q[1])], [p[0].max(q[0]), p[1].max(q[1])]);
        let farthest = p[2].min(q[2]);
        for &t in list {
            let triangle = &segment.mesh.triangles[t as usize];
            if triangle.nearest <= farthest {
                break;
            }
            self.stats.candidates += 1;
            self.tests += 1;

            // Check the budget from time to time.
            if self.tests.is_multiple_of(TESTS_A_CHECK)
                && let Err(limit) = run.budget.check("visibility")
            {
                return ControlFlow::Break(Some(limit));
            }

            // Skip triangles beside the edge, tested ones, and those at the edge itself.
            let apart = |k: usize| triangle.low[k] > high[k] || triangle.high[k] < low[k];
            if apart(0)
                || apart(1)
                || std::mem::replace(&mut self.asked[t as usize], number) == number
            {
                continue;
            }
            if segment.mesh.triangles_at(edge).contains(&t) {
                continue;
            }

            // Find the hidden interval, and subtract it from the visible pieces.
            self.stats.tests += 1;
            let Some(interval) = segment.hidden_by(t, triangle) else { continue };
            self.hidden.push(interval);
            if visible_only && self.pieces.len() <= MOST_PIECES {
                self.take_away(segment, &interval);
                if self.pieces.is_empty() {
                    return ControlFlow::Break(None);
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Takes an interval from the visible pieces.
    fn take_away(&mut self, segment: &Segment<'_>, hidden: &Interval) {
        let mut i = 0;
        while i < self.pieces.len() {
            // Keep pieces that do not overlap the interval.
            let (from, to) = self.pieces[i];
            if !segment.is_before(&from, &hidden.to) || !segment.is_before(&hidden.from, &to) {
                i += 1;
                continue;
            }

            // Shorten, split or drop those that do.
            match (segment.is_before(&from, &hidden.from), segment.is_before(&hidden.to, &to)) {
                (true, true) => {
                    self.pieces[i].1 = hidden.from;
                    self.pieces.push((hidden.to, to));
                    i += 1;
                }
                (true, false) => {
                    self.pieces[i].1 = hidden.from;
                    i += 1;
                }
                (false, true) => {
                    self.pieces[i].0 = hidden.to;
                    i += 1;
                }
                (false, false) => {
                    self.pieces.swap_remove(i);
                }
            }
        }
    }

    /// Counts the layers along the edge, and adds the parts with few enough.
    fn sweep(
        &mut self,
        segment: &Segment<'_>,
        number: u32,
        most_layers: u32,
        found: &mut Vec<Fragment>,
    ) {
        // Sort the changes of the number of layers along the edge.
        self.changes.clear();
        for interval in &self.hidden {
            self.changes.push(Change { place: interval.from, sides: interval.sides, by: 1 });
            self.changes.push(Change { place: interval.to, sides: interval.sides, by: -1 });
        }
        self.changes.push(Change { place: EdgePosition::END, sides: Sides::Both, by: 0 });
        self.changes.sort_by(|a, b| segment.compare(&a.place, &b.place));

        // Count the layers over both sides of the edge; the side with more of them tells.
        let (mut counts, mut at) = ([0; 3], EdgePosition::START);
        let first = found.len();
        for change in &self.changes {
            if segment.is_before(&at, &change.place) {
                let layers = (counts[Sides::Both as usize]
                    + counts[Sides::Left as usize].max(counts[Sides::Right as usize]))
                    as u32;
                match found[first..].last_mut() {
                    Some(last) if last.layers == layers && last.to == at => last.to = change.place,
                    _ if layers <= most_layers => {
                        found.push(Fragment { edge: number, layers, from: at, to: change.place });
                    }
                    _ => {}
                }
                at = change.place;
            }
            counts[change.sides as usize] += change.by;
        }
    }
}

#[cfg(test)]
mod tests;
