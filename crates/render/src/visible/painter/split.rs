//! Splitting polygons of the painter's list: where two penetrate each other, and where some wait
//! for each other in a circle.
//!
//! In:   marked polygons that cannot be painted. Out: their parts, which wait.
//! Cost: the corners of a polygon for a split; for a circle the edges of its neighbours for each
//!       polygon.
//! Source: [Newell, Newell & Sancha 1972]; see `painter.rs` for the departures.

use super::super::cut::Cut;
use super::compare::{PainterPolygon, crossing};
use super::{Farness, Marked, Progress, Sorting, State};
use crate::trace::Step;
use vitral_raster::SUBPIXEL;

impl Sorting<'_, '_> {
    /// Splits the last marked polygon, or the one that it penetrates, where their planes meet: the
    /// smaller one, if the line splits it, and if it is not marked.
    pub(super) fn split_at_plane(&mut self, other: u32) -> bool {
        let last = self.marked.len() - 1;
        let top = self.marked[last].polygon;
        let Some(line) = crossing(self.plane(top), self.plane(other)) else { return false };
        let [own_area, other_area] =
            [top, other].map(|i| self.polygons[i as usize].area(&self.corners));
        let splits_other = other_area < own_area && self.states[other as usize] == State::Waiting;
        if splits_other
            && let Some(halves) = self.polygons[other as usize].split(&self.corners, &line)
        {
            self.replace((other, self.progress[other as usize]), &halves, line, top, Vec::new());
            return true;
        }
        self.split(last, line, other)
    }

    /// Cuts the circle of marked polygons that begins at `start`: somewhere along it, one is split
    /// by its neighbour.
    pub(super) fn cut_cycle(&mut self, start: u32) -> bool {
        // Report the circle.
        self.counters.cycles += 1;
        let first = self.marked.iter().position(|m| m.polygon == start).unwrap_or(0);
        let last = self.marked.len() - 1;
        self.execution.report(|| {
            let polygons: Vec<u32> = self.marked[first..].iter().map(|m| m.polygon).collect();
            let facets = polygons.iter().map(|&p| self.facet(p)).collect();
            Step::Circle { polygons, facets }
        });
        // Each has to be painted after the next one, and the last after the first. Split one so
        // that no part waits and is waited for.
        let (next, previous) = (
            |place: usize| if place == last { first } else { place + 1 },
            |place: usize| if place == first { last } else { place - 1 },
        );
        for place in (first..=last).rev() {
            let [p, q, r] = [place, next(place), previous(place)].map(|i| self.marked[i].polygon);
            let [own, behind, in_front] = [p, q, r].map(|i| &self.polygons[i as usize]);
            if let Some((line, is_of_next)) =
                own.separating_line([behind, in_front], self.wholes, &self.corners)
                && self.split(place, line, if is_of_next { q } else { r })
            {
                return true;
            }
        }

        // Without such a line, split one along any that splits it.
        for place in (first..=last).rev() {
            for (split, by) in [(place, next(place)), (next(place), place)] {
                let [p, q] = [split, by].map(|i| self.marked[i].polygon);
                let edges = self.polygons[q as usize].edges(&self.corners);
                let lines: Vec<_> =
                    crossing(self.plane(p), self.plane(q)).into_iter().chain(edges).collect();
                if lines.into_iter().any(|line| self.split(split, line, q)) {
                    return true;
                }
            }
        }
        false
    }

    /// Splits a marked polygon along a line, that of the plane or an edge of another, if it lies
    /// clearly on both sides. Those marked after it have to wait again.
    fn split(&mut self, place: usize, line: Cut, by: u32) -> bool {
        let Marked { polygon: number, progress } = self.marked[place];
        let Some(halves) = self.polygons[number as usize].split(&self.corners, &line) else {
            return false;
        };
        self.marked[place..]
            .iter()
            .for_each(|left| self.progress[left.polygon as usize] = left.progress);
        let unmarked: Vec<u32> =
            self.marked.drain(place..).skip(1).map(|left| left.polygon).collect();
        for &left in &unmarked {
            self.states[left as usize] = State::Waiting;
            self.waiting.push(Farness {
                far: self.polygons[left as usize].far,
                facet: self.facet(left),
                polygon: left,
            });
        }
        self.replace((number, progress), &halves, line, by, unmarked);
        true
    }

    /// Puts the halves of a polygon in its place; its comparisons had come so far.
    fn replace(
        &mut self,
        (number, progress): (u32, Progress),
        halves: &[Vec<[f64; 2]>; 2],
        line: Cut,
        by: u32,
        unmarked: Vec<u32>,
    ) {
        // Retire the whole polygon.
        self.counters.splits += 1;
        self.finish(number, State::Split);
        let PainterPolygon { whole, ref cuts, .. } = self.polygons[number as usize];
        let cuts = cuts.clone();
        let mut parts = [None; 2];

        // Add both parts with the cuts that matter to them.
        for (part, (corners, cut)) in
            parts.iter_mut().zip(halves.iter().zip([line, line.opposite()]))
        {
            let first = self.cuts.len() as u32;
            for inherited in cuts.clone() {
                // A line that stays clear of the part cuts nothing off it.
                let inherited = self.cuts[inherited as usize];
                if !inherited.holds(corners) {
                    self.cuts.push(inherited);
                }
            }
            self.cuts.push(cut);
            *part = self.add(whole, corners, first..self.cuts.len() as u32);
            if let Some(part) = *part {
                self.go_on(part, progress);
            }
        }

        // Report the split.
        self.execution.report(|| Step::Split {
            polygon: number,
            facet: self.facet(number),
            by,
            by_facet: self.facet(by),
            line: [line.a, line.b, line.c / f64::from(SUBPIXEL)],
            parts: parts.iter().flatten().map(|&part| self.listed(part)).collect(),
            unmarked,
        });
    }

    /// Lets a part go on where the whole has come to.
    fn go_on(&mut self, part: u32, progress: Progress) {
        let [x0, y0, x1, y1] = self.polygons[part as usize].cells;
        let [x, y] = progress.cell;
        // The part may begin after the cell, or end before it in this row.
        let cell = match (y < y0, x > x1) {
            (true, _) => [x0, y0],
            (false, true) => [x0, y + 1],
            (false, false) => [x.max(x0), y],
        };
        let own = if cell == progress.cell {
            progress
        } else if cell[1] > y1 {
            // All is compared: nothing is left in the last cell.
            Progress { cell: [x1, y1], at: u32::MAX, version: self.versions[self.index([x1, y1])] }
        } else {
            Progress { cell, at: 0, version: self.versions[self.index(cell)] }
        };
        self.progress[part as usize] = own;
    }
}
