//! Lines in the order in which a plotter draws them: no segment twice, joined, with short ways in
//! the air.
//!
//! Pens come one after another. Segments that a more important pen has drawn are left out, the rest
//! is walked from nearest end to nearest end, either way round; where an end is where the pen is,
//! the line goes on. Dashes become lines of their own.
//!
//! In:   a drawing. Out: the same, lines and points ordered, without fills and with at most one
//!       number of layers for hidden lines.
//! Cost: about linear: ends are found on a grid, which is made anew when half of them are gone.
//! Source: \[HP-GL\] for what plotters do; the tour is that of the nearest neighbour.

use super::pens::{DrawingOptions, Pens, Polyline};
use std::collections::HashSet;
use vitral_frame::Drawing;
use vitral_frame::drawing::{Line, LineClass};

/// A point in steps of the plotter.
type Step = [i32; 2];
/// Lines for which a grid is made anew at least.
const SMALLEST_GRID: usize = 16;

/// The drawing for a plotter with steps of the options' precision, and the options to write it
/// with.
pub fn for_plotter(drawing: &Drawing, options: &DrawingOptions) -> (Drawing, DrawingOptions) {
    in_steps(drawing, options, options.precision().steps_a_millimetre)
}

/// [`for_plotter`] for one that knows `steps_a_millimetre`.
pub(super) fn in_steps(
    drawing: &Drawing,
    options: &DrawingOptions,
    steps_a_millimetre: f64,
) -> (Drawing, DrawingOptions) {
    // Convert between millimetres and steps of the plotter.
    let steps = |points: &[[f64; 2]]| -> Vec<Step> {
        points.iter().map(|p| p.map(|at| (at * steps_a_millimetre).round() as i32)).collect()
    };
    let millimetres = |points: Vec<Step>| -> Polyline {
        points.into_iter().map(|p| p.map(|at| f64::from(at) / steps_a_millimetre)).collect()
    };

    // Route lines along a short way of the pen, and draw no segment twice.
    let mut drawn = HashSet::new();
    let mut route = |lines: Vec<&[[f64; 2]]>| {
        let mut fresh = Vec::new();
        lines.into_iter().for_each(|line| add_fresh(&mut fresh, &steps(line), &mut drawn));
        ordered(fresh).into_iter().map(millimetres).collect::<Vec<Polyline>>()
    };

    // Order the lines of each pen.
    let mut lines = Vec::new();
    for class in LineClass::ALL.map(|row| row.0).into_iter().chain([LineClass::Hatch]) {
        let visible = drawing.lines.iter().filter(|line| line.layers == 0 && line.class == class);
        let points = route(visible.map(|line| &line.points[..]).collect());
        lines.extend(points.into_iter().map(|points| Line { class, layers: 0, points }));
    }

    // Order the points, the title block and the hidden lines.
    let dots = drawing.points.iter().map(|point| steps(&[*point, *point])).collect();
    let points = ordered(dots).into_iter().map(|dot| millimetres(dot)[0]).collect();
    let title = route(options.title.iter().map(|stroke| &stroke[..]).collect());
    let hidden = route(
        drawing.lines.iter().filter(|line| line.layers > 0).map(|line| &line.points[..]).collect(),
    );

    // Hidden lines are one pen's, whatever their classes.
    for line in hidden {
        let pieces = match options.pens.hidden_dashes {
            Some(dashes) => dashed(&line, dashes),
            None => vec![line],
        };
        lines.extend(pieces.into_iter().map(|points| Line {
            class: LineClass::Smooth,
            layers: 1,
            points,
        }));
    }
    let pens = Pens { hidden_dashes: None, ..options.pens };
    (
        Drawing { lines, points, regions: Vec::new(), ..*drawing },
        DrawingOptions { pens, title, ..options.clone() },
    )
}

/// Adds the parts of a line that have not been drawn.
fn add_fresh(lines: &mut Vec<Vec<Step>>, points: &[Step], drawn: &mut HashSet<[Step; 2]>) {
    let mut part: Vec<Step> = Vec::new();
    for pair in points.windows(2).filter(|pair| pair[0] != pair[1]) {
        let segment = if pair[0] < pair[1] { [pair[0], pair[1]] } else { [pair[1], pair[0]] };
        if !drawn.insert(segment) {
            lines.extend((!part.is_empty()).then(|| std::mem::take(&mut part)));
            continue;
        }
        if part.is_empty() {
            part.push(pair[0]);
        }
        part.push(pair[1]);
    }
    lines.extend((!part.is_empty()).then_some(part));
}

/// Orders lines from end to nearest end, beginning near the origin, and joins those that meet.
fn ordered(mut lines: Vec<Vec<Step>>) -> Vec<Vec<Step>> {
    let mut route: Vec<Vec<Step>> = Vec::with_capacity(lines.len());
    let mut at = [0, 0];
    let mut left = lines.len();
    let mut ends = Ends::new(&lines);
    while left > 0 {
        if left >= SMALLEST_GRID && left * 2 < ends.lines {
            ends = Ends::new(&lines);
        }
        let Some(end) = ends.nearest(at) else { break };
        let mut line = std::mem::take(&mut lines[end as usize / 2]);
        ends.remove(end, &line);
        left -= 1;
        if end % 2 == 1 {
            line.reverse();
        }
        let start = line[0];
        let target = line[line.len() - 1];
        match route.last_mut() {
            Some(last) if start == at => last.extend_from_slice(&line[1..]),
            _ => route.push(line),
        }
        at = target;
    }
    route
}

/// Both ends of lines in the cells of a grid. End `2 i + k` is the first or last point of line `i`.
struct Ends {
    /// How many lines the grid was made for.
    lines: usize,
    low: Step,
    side: i64,
    columns: i64,
    rows: i64,
    cells: Vec<Vec<(Step, u32)>>,
}

impl Ends {
    fn new(lines: &[Vec<Step>]) -> Self {
        let left = || lines.iter().enumerate().filter(|(_, line)| !line.is_empty());
        let ends = || {
            left().flat_map(|(i, line)| {
                [(line[0], 2 * i as u32), (line[line.len() - 1], 2 * i as u32 + 1)]
            })
        };
        let (mut low, mut high) = ([i32::MAX; 2], [i32::MIN; 2]);
        for (point, _) in ends() {
            for k in 0..2 {
                (low[k], high[k]) = (low[k].min(point[k]), high[k].max(point[k]));
            }
        }
        let count = left().count();
        let along = (count as f64).sqrt().ceil().max(1.0) as i64;
        let size = [0, 1].map(|k| (i64::from(high[k]) - i64::from(low[k])).max(0));
        let side = size[0].max(size[1]) / along + 1;
        let [columns, rows] = size.map(|length| length / side + 1);
        let mut grid = Self {
            lines: count,
            low,
            side,
            columns,
            rows,
            cells: vec![Vec::new(); (columns * rows) as usize],
        };
        for (point, end) in ends() {
            let [x, y] = grid.cell(point);
            grid.cells[(y * columns + x) as usize].push((point, end));
        }
        grid
    }

    /// Column and row of a point; outside the grid for points outside.
    fn cell(&self, point: Step) -> [i64; 2] {
        [0, 1].map(|k| (i64::from(point[k]) - i64::from(self.low[k])).div_euclid(self.side))
    }

    /// The end that is nearest; of equally near ones the first.
    fn nearest(&self, point: Step) -> Option<u32> {
        let [x, y] = self.cell(point);
        let far = |at: i64, count: i64| at.abs().max((count - 1 - at).abs());
        let mut best: Option<(i64, u32)> = None;
        // Ring by ring, from the first that touches the grid.
        let first = [x, y]
            .iter()
            .zip([self.columns, self.rows])
            .map(|(&at, n)| (-at).max(at - n + 1).max(0))
            .max();
        for ring in first.unwrap_or(0)..=far(x, self.columns).max(far(y, self.rows)) {
            let reached = (ring - 1).max(0) * self.side;
            if best.is_some_and(|(distance, _)| distance <= reached * reached) {
                break;
            }
            for row in (y - ring).max(0)..=(y + ring).min(self.rows - 1) {
                let across = if (row - y).abs() == ring { 1 } else { (2 * ring).max(1) };
                let mut column = x - ring;
                while column <= x + ring {
                    if (0..self.columns).contains(&column) {
                        let cell = &self.cells[(row * self.columns + column) as usize];
                        let here = cell.iter().map(|&(at, end)| (square(at, point), end)).min();
                        best = best.into_iter().chain(here).min();
                    }
                    column += across;
                }
            }
        }
        best.map(|(_, end)| end)
    }

    /// Takes both ends of the line with this end out.
    fn remove(&mut self, end: u32, line: &[Step]) {
        for point in [line[0], line[line.len() - 1]] {
            let [x, y] = self.cell(point);
            self.cells[(y * self.columns + x) as usize].retain(|&(_, other)| other / 2 != end / 2);
        }
    }
}

fn square(a: Step, b: Step) -> i64 {
    let [x, y] = [0, 1].map(|k| i64::from(a[k]) - i64::from(b[k]));
    x * x + y * y
}

/// The dashes of a line.
fn dashed(points: &[[f64; 2]], [dash, gap]: [f64; 2]) -> Vec<Polyline> {
    let (mut dashes, mut piece) = (Vec::new(), vec![points[0]]);
    let (mut is_dash, mut left) = (true, dash);
    for pair in points.windows(2) {
        let [x, y] = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let length = (x * x + y * y).sqrt();
        let mut from = 0.0;
        while length - from > left {
            from += left;
            let point = [pair[0][0] + x * (from / length), pair[0][1] + y * (from / length)];
            if is_dash {
                piece.push(point);
                dashes.push(std::mem::take(&mut piece));
            } else {
                piece = vec![point];
            }
            is_dash = !is_dash;
            left = if is_dash { dash } else { gap };
        }
        left -= length - from;
        if is_dash {
            piece.push(pair[1]);
        }
    }
    dashes.extend((piece.len() > 1).then_some(piece));
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(lines: &[&[[f64; 2]]]) -> Drawing {
        let line = |points: &&[[f64; 2]]| Line {
            class: LineClass::Crease,
            layers: 0,
            points: points.to_vec(),
        };
        Drawing {
            width: 100.0,
            height: 100.0,
            lines: lines.iter().map(line).collect(),
            ..Drawing::default()
        }
    }

    fn route(lines: &[&[[f64; 2]]]) -> Vec<Polyline> {
        let (drawing, _) = for_plotter(&drawing(lines), &DrawingOptions::default());
        drawing.lines.into_iter().map(|line| line.points).collect()
    }

    #[test]
    fn lines_are_turned_joined_and_drawn_once() {
        let far: &[[f64; 2]] = &[[50.0, 50.0], [60.0, 50.0]];
        let near: &[[f64; 2]] = &[[9.0, 9.0], [1.0, 1.0]];
        let next: &[[f64; 2]] = &[[9.0, 30.0], [9.0, 9.0], [1.0, 1.0], [0.0, 50.0]];
        assert_eq!(
            route(&[far, near, next]),
            [
                &[[1.0, 1.0], [9.0, 9.0], [9.0, 30.0]][..],
                &[[0.0, 50.0], [1.0, 1.0]],
                &[[50.0, 50.0], [60.0, 50.0]]
            ]
        );
    }

    #[test]
    fn the_grid_finds_what_looking_at_all_finds() {
        let mut seed = 1u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 16) as i32 % 5000
        };
        let lines: Vec<Vec<Step>> =
            (0..300).map(|_| vec![[random(), random()], [random(), random() / 50]]).collect();
        let route = ordered(lines.clone());
        let (mut left, mut at) = (lines, [0, 0]);
        for line in &route {
            let ends = left.iter().flat_map(|line| [line[0], line[line.len() - 1]]);
            assert_eq!(ends.map(|end| square(end, at)).min(), Some(square(line[0], at)));
            for pair in line.windows(2) {
                let same = |l: &Vec<Step>| l[..] == *pair || [l[1], l[0]] == *pair;
                left.remove(left.iter().position(same).unwrap());
            }
            at = line[line.len() - 1];
        }
        assert!(left.is_empty());
    }

    #[test]
    fn points_are_walked_from_nearest_to_nearest() {
        let points = vec![[50.0, 1.0], [10.0, 1.0], [30.0, 1.0], [0.0, 0.0]];
        let (drawing, _) =
            for_plotter(&Drawing { points, ..Drawing::default() }, &DrawingOptions::default());
        assert_eq!(drawing.points, [[0.0, 0.0], [10.0, 1.0], [30.0, 1.0], [50.0, 1.0]]);
    }

    #[test]
    fn dashes_go_round_corners() {
        let dashes = dashed(&[[0.0, 0.0], [1.0, 0.0], [1.0, 4.5]], [2.0, 1.0]);
        assert_eq!(dashes, [&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]][..], &[[1.0, 2.0], [1.0, 4.0]]]);
    }
}
