//! The spans of a line: between two active edges the polygons that are in do not change, and one
//! decision serves all samples.
//!
//! In:   active edges from left to right, polygons (screen space). Out: the samples of the line.
//! Cost: spans times the polygons that are in, plus covered samples.
//! Source: [Watkins 1970] for the decisions, [Bouknight 1970] for the in-out flags.

use super::edges::{ActiveEdge, OUT, PolygonEntry, SampleLine, covered};
use super::face::OnLine;
use super::implied_edge::ImpliedEdges;
use crate::stats::VisibilityCounters;
use crate::trace::{Span, SpanVerdict};
use crate::visible::agreement::nearer;
use crate::visible::tiles::put;
use crate::{Coherence, CoherenceSet};
use std::ops::Range;
use vitral_raster::{SUBPIXEL, TILE, TILE_PIXELS, Tile};

/// Parts of spans that are shorter are decided at their samples without asking for an implied edge.
const LONG: usize = 4;

/// What is needed to fill the spans of a line.
pub(super) struct Spans<'s, 'f> {
    pub(super) polygons: &'s mut [PolygonEntry<'f>],
    /// The polygons whose in-out flag is in.
    inside: Vec<u32>,
    /// The polygon that won the last span alone.
    last: u32,
    /// Workspace: polygons that may be visible somewhere in the span, with their nearest depth in
    /// it.
    rivals: Vec<(f32, u32)>,
    implied: ImpliedEdges,
    coherence: CoherenceSet,
    /// The spans of the line, if somebody wants to know.
    pub(super) reported: Option<Vec<Span>>,
    tiles: &'s mut [Tile],
    pub(super) counters: &'s mut VisibilityCounters,
}

impl<'s, 'f> Spans<'s, 'f> {
    /// Of a band whose polygons are all out.
    pub(super) fn new(
        polygons: &'s mut [PolygonEntry<'f>],
        tiles: &'s mut [Tile],
        coherence: CoherenceSet,
        counters: &'s mut VisibilityCounters,
    ) -> Self {
        let (inside, rivals, implied) = (Vec::new(), Vec::new(), ImpliedEdges::default());
        Self {
            polygons,
            inside,
            last: 0,
            rivals,
            implied,
            coherence,
            reported: None,
            tiles,
            counters,
        }
    }

    /// Counts what was found on all lines.
    pub(super) fn finish(self) {
        self.counters.implied_edges += self.implied.found;
    }

    /// Walks along the active edges and fills the spans between them.
    pub(super) fn walk(&mut self, active: &[ActiveEdge], line: &SampleLine) {
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
    fn fill_all(&mut self, pixels: Range<usize>, line: &SampleLine) {
        if self.coherence.has(Coherence::Area) {
            self.counters.saved_by_area += pixels.len() as u64 - 1;
            return self.fill(pixels, line);
        }
        pixels.for_each(|x| self.fill(x..x + 1, line));
    }

    /// Notes how a span was decided.
    fn report(&mut self, pixels: &Range<usize>, verdict: SpanVerdict, winner: Option<u32>) {
        if let Some(reported) = &mut self.reported {
            let facet = winner.map(|p| self.polygons[p as usize].shape.facet());
            let pixels = [pixels.start, pixels.end].map(|x| x as u32);
            let mut inside: Vec<u32> =
                self.inside.iter().map(|&p| self.polygons[p as usize].shape.facet()).collect();
            inside.sort_unstable();
            reported.push(Span { pixels, inside, verdict, facet });
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

    /// Fills a span: with the one polygon that is in, or that hides the others, else sample by
    /// sample.
    fn fill(&mut self, pixels: Range<usize>, line: &SampleLine) {
        self.counters.spans += 1;
        if let [only] = self.inside[..] {
            self.report(&pixels, SpanVerdict::Only, Some(only));
            return self.fill_with(only, pixels, line);
        }
        self.find_rivals(&pixels, line);
        if let [(_, winner)] = self.rivals[..] {
            self.last = winner;
            self.report(&pixels, SpanVerdict::Hides, Some(winner));
            return self.fill_with(winner, pixels, line);
        }
        let mut rivals = std::mem::take(&mut self.rivals);
        self.divide(pixels, &mut rivals, line);
        self.rivals = rivals;
    }

    /// Fills a span in which any of `rivals` may be seen: cuts it at the implied edge of the first
    /// two, and decides what no edge tells sample by sample.
    fn divide(&mut self, pixels: Range<usize>, rivals: &mut [(f32, u32)], line: &SampleLine) {
        if pixels.is_empty() {
            return;
        }

        // Fill the span if one rival is left.
        if let [(_, winner)] = *rivals {
            self.last = winner;
            self.report(&pixels, SpanVerdict::ImpliedEdge, Some(winner));
            return self.fill_with(winner, pixels, line);
        }

        // Test short spans sample by sample.
        if pixels.len() < LONG || !self.coherence.has(Coherence::ImpliedEdge) {
            return self.fill_by_samples(pixels, rivals, line);
        }
        // The lower polygon first, so that a pair has one edge however it is found.
        if rivals[1].1 < rivals[0].1 {
            rivals.swap(0, 1);
        }

        // Cut the span at the line in which the two planes meet.
        let pair = [rivals[0].1, rivals[1].1];
        let shapes = pair.map(|p| self.polygons[p as usize].shape);
        let parts = self.implied.divide(pair, shapes, pixels.clone(), line.sample_x, line.y);
        let (left, right) = (pixels.start..parts.undecided.start, parts.undecided.end..pixels.end);
        self.counters.saved_by_implied_edge += (left.len() + right.len()) as u64;
        // Beside the edge, the farther one is no rival.
        let [left_loser, right_loser] = if parts.first_on_left { [pair[1], pair[0]] } else { pair };
        self.divide(left, without(rivals, left_loser), line);
        self.fill_by_samples(parts.undecided, rivals, line);
        self.divide(right, without(rivals, right_loser), line);
    }

    /// Takes the nearest of `rivals`, whose depths were brought to the line when they were found,
    /// at each sample.
    fn fill_by_samples(&mut self, pixels: Range<usize>, rivals: &[(f32, u32)], line: &SampleLine) {
        if pixels.is_empty() {
            return;
        }
        self.report(&pixels, SpanVerdict::Samples, None);
        self.counters.penetrated_spans += 1;
        self.counters.depth_comparisons += (pixels.len() * (rivals.len() - 1)) as u64;
        for x in pixels {
            let sample_x = x as i32 * SUBPIXEL + line.sample_x;
            let facet = |p: u32| self.polygons[p as usize].shape.facet_within(sample_x, line.y);
            let depths = rivals
                .iter()
                .map(|&(_, p)| (self.polygons[p as usize].on_line().depth(sample_x), p));
            let nearest = depths.reduce(|a, b| {
                // The facets matter where depths are equal.
                let [fa, fb] = if a.0 == b.0 { [a.1, b.1].map(facet) } else { [0; 2] };
                if nearer((b.0, fb), (a.0, fa)) { b } else { a }
            });
            let Some((depth, p)) = nearest else { continue };
            put(&mut self.tiles[x / TILE], place(x, line), (depth, facet(p)));
        }
    }

    /// Brings a polygon's depth to the line, unless it is there already.
    #[inline]
    fn bring(&mut self, polygon: u32, line: &SampleLine) -> OnLine<'f> {
        let polygon = &mut self.polygons[polygon as usize];
        if polygon.line == line.y && self.coherence.has(Coherence::Face) {
            self.counters.saved_by_face += 1;
        } else {
            (polygon.line, polygon.start) = (line.y, polygon.plane().depth_of_line(line.y));
        }
        polygon.on_line()
    }

    /// Finds the polygons that no other hides over the whole span, by their depths at its ends.
    fn find_rivals(&mut self, pixels: &Range<usize>, line: &SampleLine) {
        // Begin with a polygon that is likely to be near.
        let ends = [pixels.start, pixels.end - 1].map(|x| x as i32 * SUBPIXEL + line.sample_x);
        let by_depth = self.coherence.has(Coherence::Depth);
        let lucky = if !by_depth || self.polygons[self.last as usize].slot == OUT {
            self.inside[0]
        } else {
            self.last
        };
        // Some polygon is nowhere farther than `floor`.
        let (mut floor, near) = self.bring(lucky, line).range(ends);
        self.rivals.clear();
        self.rivals.push((near, lucky));

        // Compare the others' ranges of depth with the floor.
        for i in 0..self.inside.len() {
            let p = self.inside[i];
            if p == lucky {
                continue;
            }
            if by_depth && self.polygons[p as usize].plane().z_max < floor {
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

        // Drop those that the last floor hides.
        self.rivals.retain(|&(near, _)| near >= floor);
    }

    /// Fills a span with one polygon; its triangles have their facets.
    fn fill_with(&mut self, polygon: u32, pixels: Range<usize>, line: &SampleLine) {
        // Fill one tile's part of the span after the other.
        let face = self.bring(polygon, line);
        let triangles = self.polygons[polygon as usize].shape.triangles();
        let mut x = pixels.start;
        while x < pixels.end {
            let end = pixels.end.min((x / TILE + 1) * TILE);
            let (tile, at) = (&mut self.tiles[x / TILE], place(x, line));
            tile.touched = true;
            // Write the facet of each triangle.
            match triangles {
                [only] => tile.facet[at..at + (end - x)].fill(only.facet),
                several => {
                    for triangle in several {
                        let columns = covered(triangle, line, &(x..end));
                        tile.facet[at + (columns.start - x)..at + (columns.end - x)]
                            .fill(triangle.facet);
                    }
                }
            }

            // Write the depths.
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
fn place(x: usize, line: &SampleLine) -> usize {
    line.sample * TILE_PIXELS + line.row * TILE + x % TILE
}
