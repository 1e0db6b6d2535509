//! The list of a window's polygons: what is left of the list of the window that it is a part of.
//!
//! In:   polygons, a window and the list that is handed down to it (screen space). Out: its own
//!       list, told as a step.
//! Cost: linear in the list that is handed down.

use super::super::agreement::nearer;
use super::super::polygons::Polygons;
use super::super::tiles::extent;
use super::depths::CornerDepths;
use super::facet_at;
use super::window::{SampleBox, Window, WindowRelation, relation};
use crate::stats::VisibilityCounters;
use crate::trace::{Step, WindowVerdict};
use crate::{Coherence, CoherenceSet, Execution, PreparedView};
use std::cmp::Ordering;
use std::ops::Range;

/// A polygon on a window's list.
#[derive(Clone, Copy)]
pub(super) struct Entry {
    pub(super) polygon: u32,
    /// What it is to the window; before that is known, to the one that the window is a part of.
    pub(super) relation: WindowRelation,
}

/// Lists of the windows from the first down to the present one, one after the other.
pub(super) struct Lists<'f> {
    execution: &'f Execution,
    coherence: CoherenceSet,
    /// Places of the samples within a pixel.
    extent: [[i32; 2]; 2],
    polygons: &'f Polygons<'f>,
    stack: Vec<Entry>,
    /// Polygons of the present window that a surrounder hides, if somebody looks on.
    hidden: Vec<u32>,
    pub(super) counters: VisibilityCounters,
}

impl<'f> Lists<'f> {
    /// Begins with a list that is handed down.
    pub(super) fn new(
        view: &'f PreparedView<'_>,
        execution: &'f Execution,
        polygons: &'f Polygons<'f>,
        first: &[Entry],
    ) -> Self {
        let (coherence, extent) = (view.coherence, extent(&view.pattern));
        let (stack, hidden, counters) = (first.to_vec(), Vec::new(), VisibilityCounters::default());
        Self { execution, coherence, extent, polygons, stack, hidden, counters }
    }

    /// Puts the own list of a window behind the others: of those at `list` the ones not disjoint,
    /// and not behind a surrounder. Returns where it begins.
    pub(super) fn look_at(&mut self, window: &Window, list: Range<usize>) -> usize {
        self.counters.windows += 1;
        let (samples, start, handed_down) =
            (window.samples(self.extent), self.stack.len(), list.len());
        self.classify(samples, list);
        let disjoint = handed_down - (self.stack.len() - start);
        self.hidden.clear();
        if self.coherence.has(Coherence::Depth) {
            self.drop_hidden(samples, start);
        }
        self.counters.pixel_windows += u64::from(window.is_pixel() && self.stack.len() - start > 1);
        self.execution.report(|| self.step(window, start, disjoint as u32));
        start
    }

    /// The list that begins at `start`, the last one.
    pub(super) fn from(&self, start: usize) -> &[Entry] {
        &self.stack[start..]
    }

    /// The same, to be kept.
    pub(super) fn own(&mut self, start: usize) -> Vec<Entry> {
        self.stack.split_off(start)
    }

    /// Drops the list that begins at `start`.
    pub(super) fn leave(&mut self, start: usize) {
        self.stack.truncate(start);
    }

    /// The step of a window whose list begins at `start`.
    fn step(&self, window: &Window, start: usize, disjoint: u32) -> Step {
        // Name the case of the window.
        let list = self.from(start);
        let (verdict, drawn) = match list {
            [] => (WindowVerdict::Empty, None),
            [only] if only.relation == WindowRelation::Surrounding => {
                (WindowVerdict::Surrounded, Some(only))
            }
            [only] => (WindowVerdict::One, Some(only)),
            _ if window.is_pixel() => (WindowVerdict::Pixel, None),
            _ => (WindowVerdict::Cut, None),
        };

        // Name the facets by how they lie to the window.
        let of = |entry: &Entry| self.polygons.get(entry.polygon as usize).facet();
        let facets = |relation| list.iter().filter(|e| e.relation == relation).map(of).collect();
        Step::Window {
            pixels: window.pixels(),
            path: window.path.iter().map(|quarter| char::from(b'0' + quarter)).collect(),
            disjoint,
            contained: facets(WindowRelation::Contained),
            intersecting: facets(WindowRelation::Intersecting),
            surrounding: facets(WindowRelation::Surrounding),
            hidden: self.hidden.clone(),
            verdict,
            facet: drawn.map(of),
        }
    }

    /// Pushes the polygons of `list` that are not disjoint. Surrounders stay surrounders.
    fn classify(&mut self, samples: SampleBox, list: Range<usize>) {
        for i in list {
            let mut entry = self.stack[i];
            if entry.relation == WindowRelation::Surrounding && self.coherence.has(Coherence::Area)
            {
                self.counters.saved_by_area += 1;
            } else {
                self.counters.window_tests += 1;
                entry.relation =
                    relation(self.polygons.get(entry.polygon as usize).outline(), samples);
                if entry.relation == WindowRelation::Disjoint {
                    continue;
                }
            }
            self.stack.push(entry);
        }
    }

    /// Drops from the list that begins at `start` what the nearest surrounder hides at all four
    /// corners.
    fn drop_hidden(&mut self, samples: SampleBox, start: usize) {
        if self.stack.len() - start < 2 {
            return;
        }

        // Find the nearest and the farthest depth of each surrounder at the window's corners.
        let surrounders = self
            .from(start)
            .iter()
            .filter(|e| e.relation == WindowRelation::Surrounding)
            .map(|e| e.polygon);
        let farthest = |p: u32| {
            let [near, far] = [f32::max, f32::min].map(|pick| {
                let depths =
                    samples.corners().map(|[x, y]| self.polygons.get(p as usize).depth(x, y));
                depths.into_iter().reduce(pick).unwrap_or(0.0)
            });
            (far, near, p)
        };

        // Choose the one that is nearest by its farthest depth, then by its nearest, then by facet.
        let front =
            surrounders.map(farthest).reduce(|a, b| match (b.0, b.1).partial_cmp(&(a.0, a.1)) {
                Some(Ordering::Greater) => b,
                Some(Ordering::Equal)
                    if self.polygons.get(b.2 as usize).facet()
                        < self.polygons.get(a.2 as usize).facet() =>
                {
                    b
                }
                _ => a,
            });
        let Some((_, _, front)) = front else { return };

        // Drop what its plane hides at all corners.
        let (polygons, counters) = (self.polygons, &mut self.counters);
        let watched = self.execution.observer.is_some();
        let plane = CornerDepths::new(polygons.get(front as usize).plane(), samples);
        let mut kept = start;
        for i in start..self.stack.len() {
            let entry = self.stack[i];
            let hidden = entry.polygon != front && {
                counters.depth_comparisons += 1;
                plane.hides(&CornerDepths::new(
                    polygons.get(entry.polygon as usize).plane(),
                    samples,
                ))
            };
            if !hidden {
                self.stack[kept] = entry;
                kept += 1;
            } else if watched {
                self.hidden.push(polygons.get(entry.polygon as usize).facet());
            }
        }

        // Count and cut off the dropped polygons.
        self.counters.saved_by_depth += (self.stack.len() - kept) as u64;
        self.stack.truncate(kept);
    }

    /// The nearest facet of the list that begins at `start` at a sample, with its depth.
    pub(super) fn nearest(&mut self, start: usize, [x, y]: [i32; 2]) -> Option<(f32, u32)> {
        let mut seen: Option<(f32, u32)> = None;
        for entry in &self.stack[start..] {
            let polygon = self.polygons.get(entry.polygon as usize);
            let Some(facet) = facet_at(polygon, *entry, [x, y]) else { continue };
            let candidate = (polygon.depth(x, y), facet);
            self.counters.depth_comparisons += u64::from(seen.is_some());
            if seen.is_none_or(|seen| nearer(candidate, seen)) {
                seen = Some(candidate);
            }
        }
        seen
    }
}
