//! From fragments to strokes on the page, of which no two coincide.
//!
//! Edges of different faces often lie on one another: the front and the back of a box, parts that
//! touch, lines of intersection along an edge. Of strokes that coincide, the most important stays:
//! visible before hidden, sections first, then in the order of the classes. A stroke gives way
//! where another one lies within the reach of snapping all along their common part, and its new end
//! is the other one's end, so that the rest still joins.
//!
//! In:   fragments of edges. Out: strokes in units of the page, in order of fragments.
//! Cost: linear in strokes and their length in cells of a grid, whose cells hold about one stroke
//!       each.

use crate::classes::Classes;
use crate::page_mesh::PageMesh;
use crate::place::Segment;
use crate::run::Run;
use crate::visibility::Fragment;
use std::ops::{Range, RangeInclusive};
use vitral_exec::Limit;
use vitral_frame::drawing::LineClass;
use vitral_scene::buckets::{Dealt, Source};

/// Distance in units within which strokes coincide: two roundings by half a unit each way.
const REACH: f64 = 1.5;
/// Length in units below which strokes are dust and do not count.
pub(crate) const DUST: f64 = 3.0;
/// Strokes in one piece of work.
const BATCH: usize = 2048;
/// Bytes of a stroke, with its place in the grid.
const BYTES_A_STROKE: u64 = 64;

/// A straight piece of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) class: LineClass,
    /// Faces in front of it.
    pub(crate) layers: u32,
    /// Its ends, in units of the page.
    pub(crate) ends: [[f64; 2]; 2],
}

impl Stroke {
    pub(crate) fn length(&self) -> f64 {
        let [[x, y], [u, v]] = self.ends;
        ((u - x) * (u - x) + (v - y) * (v - y)).sqrt()
    }

    /// Less is more important.
    fn rank(&self) -> (bool, bool, LineClass, u32) {
        (self.layers > 0, self.class != LineClass::Section, self.class, self.layers)
    }
}

/// The strokes of fragments of wanted classes.
pub(crate) fn strokes(
    mesh: &PageMesh,
    fragments: &[Fragment],
    wanted: Classes,
    run: &Run<'_>,
) -> Result<Vec<Stroke>, Limit> {
    run.memory.add(fragments.len() as u64 * BYTES_A_STROKE)?;
    let all: Vec<Stroke> = fragments
        .iter()
        .filter_map(|fragment| {
            let edge = &mesh.edges[fragment.edge as usize];
            let segment = Segment { mesh, ends: mesh.ends(edge) };
            let ends = [segment.point(&fragment.from), segment.point(&fragment.to)];
            let class = edge.classes.common(wanted).first()?;
            Some(Stroke { class, layers: fragment.layers, ends })
                .filter(|stroke| stroke.length() >= DUST)
        })
        .collect();
    without_coincident(all, mesh.size, run)
}

/// Takes away the parts of strokes that lie on more important ones.
pub(crate) fn without_coincident(
    all: Vec<Stroke>,
    size: [i32; 2],
    run: &Run<'_>,
) -> Result<Vec<Stroke>, Limit> {
    let cells = Cells::new(&all, size);

    // Cut the strokes of each batch at the more important strokes nearby.
    let pieces = run.workers.map(all.len().div_ceil(BATCH), |batch| {
        run.budget.check("coincident lines")?;
        let (mut left, mut parts) = (Vec::new(), Vec::new());
        for i in batch * BATCH..all.len().min((batch + 1) * BATCH) {
            parts.clear();
            parts.push(all[i]);
            cells.grid.visit(&all[i], |cell| {
                for &other in cells.numbers.bucket(cell) {
                    let front = &all[other as usize];
                    if (front.rank(), other as usize) < (all[i].rank(), i) {
                        parts =
                            parts.iter().flat_map(|part| give_way(part, front)).flatten().collect();
                    }
                }
            });
            left.append(&mut parts);
        }
        Ok(left)
    });
    let mut left = Vec::with_capacity(all.len());
    for piece in pieces {
        left.extend(piece?);
    }
    Ok(left)
}

/// The pieces of a stroke beside a more important one: all of it, or a piece before and a piece
/// behind.
fn give_way(stroke: &Stroke, front: &Stroke) -> [Option<Stroke>; 2] {
    // Measure along and across the stroke.
    let length = stroke.length();
    let [p, q] = stroke.ends;
    let direction = [0, 1].map(|k| (q[k] - p[k]) / length);
    // How far along the stroke a point is, and how far beside it.
    let along = |at: [f64; 2]| {
        let d = [at[0] - p[0], at[1] - p[1]];
        (d[0] * direction[0] + d[1] * direction[1], d[1] * direction[0] - d[0] * direction[1])
    };

    // Order the ends of the other stroke along this one.
    let (mut from, mut to) = (front.ends[0], front.ends[1]);
    let ((mut a, mut off_a), (mut b, mut off_b)) = (along(from), along(to));
    if a > b {
        (from, to) = (to, from);
        ((a, off_a), (b, off_b)) = ((b, off_b), (a, off_a));
    }

    // Keep the whole stroke unless the other one runs beside it.
    let (low, high) = (a.max(0.0), b.min(length));
    let beside = |at: f64| (off_a + (off_b - off_a) * ((at - a) / (b - a))).abs();
    let common = high - low;
    if common.is_nan() || common < DUST || beside(low) > REACH || beside(high) > REACH {
        return [Some(*stroke), None];
    }

    // Keep the pieces before and behind.
    let piece = |ends: [[f64; 2]; 2]| {
        Some(Stroke { ends, ..*stroke }).filter(|piece| piece.length() >= DUST)
    };
    let before = if low > 0.0 { piece([p, from]) } else { None };
    let behind = if high < length { piece([to, q]) } else { None };
    [before, behind]
}

/// Strokes by the cells of a grid that they run through.
struct Cells {
    grid: CellGrid,
    numbers: Dealt<u32>,
}

/// Cells of equal size over the page.
#[derive(Clone, Copy)]
struct CellGrid {
    shift: u32,
    width: usize,
    height: usize,
}

/// Strokes, with the cells within their reach.
struct InCells<'s> {
    grid: CellGrid,
    strokes: &'s [Stroke],
}

impl Source<u32> for InCells<'_> {
    fn items(&self) -> usize {
        self.strokes.len()
    }

    fn visit(&self, range: Range<usize>, mut put: impl FnMut(usize, u32)) {
        range.for_each(|i| self.grid.visit(&self.strokes[i], |cell| put(cell, i as u32)));
    }
}

impl Cells {
    fn new(strokes: &[Stroke], size: [i32; 2]) -> Self {
        let longer = size[0].max(size[1]).max(1) as u32;
        let along = (strokes.len() as f64).sqrt().max(1.0) as u32;
        let shift = (longer / along).max(16).ilog2();
        let [width, height] = size.map(|side| (side >> shift) as usize + 1);
        let grid = CellGrid { shift, width, height };
        Self { grid, numbers: Dealt::new(&InCells { grid, strokes }, width * height) }
    }
}

impl CellGrid {
    /// Columns or rows within reach of a range of coordinates.
    fn range(&self, low: f64, high: f64, count: usize) -> RangeInclusive<usize> {
        let cell = |at: f64| (at.max(0.0) as usize >> self.shift).min(count - 1);
        cell(low - REACH - 1.0)..=cell(high + REACH + 1.0)
    }

    /// Calls `f` for the cells within reach of a stroke.
    fn visit(&self, stroke: &Stroke, mut f: impl FnMut(usize)) {
        // Order the ends from bottom to top.
        let [p, q] = if stroke.ends[0][1] <= stroke.ends[1][1] {
            stroke.ends
        } else {
            [stroke.ends[1], stroke.ends[0]]
        };
        let slope = (q[0] - p[0]) / (q[1] - p[1]);
        for row in self.range(p[1], q[1], self.height) {
            // The part of the stroke within the row.
            let border =
                |row: usize, slack: f64| ((row << self.shift) as f64 + slack).clamp(p[1], q[1]);
            let at = |y: f64| {
                if y == p[1] {
                    p[0]
                } else if y == q[1] {
                    q[0]
                } else {
                    p[0] + (y - p[1]) * slope
                }
            };
            let (mut a, mut b) = (at(border(row, -REACH - 1.0)), at(border(row + 1, REACH + 1.0)));
            if p[1] == q[1] {
                // All of a level stroke lies in its rows.
                (a, b) = (p[0], q[0]);
            }

            // Visit the columns of the row.
            let columns = self.range(a.min(b), a.max(b), self.width);
            columns.for_each(|column| f(row * self.width + column));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::with_run;
    use proptest::prelude::*;

    fn stroke(class: LineClass, layers: u32, p: [f64; 2], q: [f64; 2]) -> Stroke {
        Stroke { class, layers, ends: [p, q] }
    }

    fn left(all: &[Stroke]) -> Vec<Stroke> {
        with_run(1, |run| without_coincident(all.to_vec(), [4096; 2], run)).unwrap()
    }

    #[test]
    fn the_more_important_of_coincident_lines_stays() {
        use LineClass::{Contour, Crease};
        let long = stroke(Crease, 0, [100.0, 100.0], [900.0, 900.0]);
        let middle = stroke(Contour, 0, [700.0, 700.5], [300.0, 300.0]);
        let rest = [
            stroke(Crease, 0, [100.0, 100.0], [300.0, 300.0]),
            stroke(Crease, 0, [700.0, 700.5], [900.0, 900.0]),
        ];
        assert_eq!(left(&[long, middle]), [rest[0], rest[1], middle]);
        // A hidden line gives way to a visible one of any class, and of equal ones the first stays.
        assert_eq!(left(&[stroke(Contour, 1, [0.0, 0.0], [1000.0, 1000.0]), long]).len(), 3);
        assert_eq!(left(&[long, long, long]), [long]);
        // A level line that runs the other way coincides, too.
        let level = stroke(Crease, 0, [100.0, 500.0], [4000.0, 500.0]);
        let back = Stroke { ends: [level.ends[1], level.ends[0]], ..level };
        let others: Vec<Stroke> = (1..90)
            .map(|i| stroke(Crease, 0, [f64::from(i) * 40.0, 900.0], [f64::from(i) * 40.0, 990.0]))
            .collect();
        assert_eq!(left(&[&[level, back], &others[..]].concat()).len(), 90);
    }

    #[test]
    fn lines_that_meet_or_run_beside_each_other_stay() {
        use LineClass::Crease;
        let a = stroke(Crease, 0, [100.0, 100.0], [900.0, 100.0]);
        for other in [
            stroke(Crease, 0, [900.0, 100.0], [1700.0, 100.0]),
            stroke(Crease, 0, [100.0, 103.0], [900.0, 103.0]),
            stroke(Crease, 0, [100.0, 100.0], [900.0, 104.0]),
            stroke(Crease, 0, [500.0, 0.0], [500.0, 900.0]),
        ] {
            assert_eq!(left(&[a, other]), [a, other]);
        }
    }

    proptest! {
        #[test]
        fn lines_on_lines_cover_what_they_covered(ends in prop::collection::vec((0u32..100, 1u32..40, 0u32..3), 1..30)) {
            // Along one slanted line; the union is measured in whole steps.
            let at = |i: u32| [f64::from(i) * 30.0, f64::from(i) * 20.0];
            let class = |c: u32| [LineClass::Contour, LineClass::Crease, LineClass::Smooth][c as usize];
            let all: Vec<Stroke> = ends.iter().map(|&(a, n, c)| stroke(class(c), 0, at(a), at(a + n))).collect();
            let union = (0..140).filter(|&i| ends.iter().any(|&(a, n, _)| (a..a + n).contains(&i))).count();
            let step = (900f64 + 400.0).sqrt();
            let total: f64 = left(&all).iter().map(Stroke::length).sum();
            prop_assert!((total / step - union as f64).abs() < 1e-6, "{} {}", total / step, union);
        }
    }
}
