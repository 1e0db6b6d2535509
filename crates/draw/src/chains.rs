//! Strokes joined to long polylines.
//!
//! Strokes of one class and one number of layers form a graph: its nodes are the ends, rounded to
//! the drawing's precision. Lines are trails through it that use each stroke once. They begin at
//! nodes where an odd number of strokes is left, for there as many lines must begin or end; what
//! remains then are closed lines. At a node a line goes on as straight as it can. Corners that lie
//! on the way from one to the next are dropped.
//!
//! In:   strokes whose ends are whole steps of the precision. Out: polylines in these steps, in
//!       order of their classes.
//! Cost: `n log n` for the sort of the ends.
//! Source: Euler's trails; the polylines are at most as many as half the odd nodes and the closed
//!         lines.

use std::collections::BTreeMap;
use vitral_frame::drawing::LineClass;

/// A point in steps of the precision.
pub(crate) type Step = [i32; 2];

/// A polyline.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Chain {
    pub(crate) class: LineClass,
    pub(crate) layers: u32,
    /// At least two; the last equals the first of a closed line.
    pub(crate) points: Vec<Step>,
}

/// Farthest, in steps, that a dropped corner lies from the line.
const STRAIGHT: f64 = 0.5;
/// Corners dropped in a row at most: each is looked at again for the next.
const MOST_DROPPED: usize = 64;

/// Joins strokes, given as class, layers and ends.
pub(crate) fn chains(strokes: &[(LineClass, u32, [Step; 2])]) -> Vec<Chain> {
    let mut groups: BTreeMap<(bool, LineClass, u32), Vec<[Step; 2]>> = BTreeMap::new();
    for &(class, layers, ends) in strokes.iter().filter(|stroke| stroke.2[0] != stroke.2[1]) {
        groups.entry((layers > 0, class, layers)).or_default().push(ends);
    }
    let mut all = Vec::new();
    for ((_, class, layers), strokes) in groups {
        let lines = Graph::new(&strokes).trails().into_iter().map(straightened);
        all.extend(lines.map(|points| Chain { class, layers, points }));
    }
    all
}

/// Strokes by the nodes at their ends. End `2 i + k` is end `k` of stroke `i`.
struct Graph<'s> {
    strokes: &'s [[Step; 2]],
    /// Ends in order of their nodes.
    ends: Vec<u32>,
    /// For each end, where the ends at its node begin in `ends`.
    node: Vec<u32>,
    used: Vec<bool>,
}

impl<'s> Graph<'s> {
    fn new(strokes: &'s [[Step; 2]]) -> Self {
        let at = |end: u32| strokes[end as usize / 2][end as usize % 2];
        let mut ends: Vec<u32> = (0..strokes.len() as u32 * 2).collect();
        ends.sort_unstable_by_key(|&end| (at(end), end));
        let mut node = vec![0; ends.len()];
        let mut first = 0;
        for (i, &end) in ends.iter().enumerate() {
            if at(end) != at(ends[first]) {
                first = i;
            }
            node[end as usize] = first as u32;
        }
        Self { strokes, ends, node, used: vec![false; strokes.len()] }
    }

    fn at(&self, end: u32) -> Step {
        self.strokes[end as usize / 2][end as usize % 2]
    }

    /// The ends at a node, by where they begin.
    fn ends_at(&self, node: u32) -> &[u32] {
        let rest = &self.ends[node as usize..];
        let count = rest.iter().take_while(|&&end| self.node[end as usize] == node).count();
        &rest[..count]
    }

    /// All trails.
    fn trails(mut self) -> Vec<Vec<Step>> {
        let mut trails = Vec::new();
        let mut node = 0;
        // Start a trail at each node with an odd number of free strokes.
        while node < self.ends.len() {
            let ends = self.ends_at(node as u32);
            let (count, free) =
                (ends.len(), ends.iter().filter(|&&end| !self.used[end as usize / 2]).count());
            if free % 2 == 1
                && let Some(&start) = ends.iter().find(|&&end| !self.used[end as usize / 2])
            {
                trails.push(self.trail(start));
            }
            node += count;
        }

        // Cover the closed trails that are left.
        for stroke in 0..self.strokes.len() {
            if !self.used[stroke] {
                trails.push(self.trail(stroke as u32 * 2));
            }
        }
        trails
    }

    /// The trail that begins with this end of a stroke.
    fn trail(&mut self, start: u32) -> Vec<Step> {
        let mut points = vec![self.at(start)];
        let mut end = start;
        loop {
            self.used[end as usize / 2] = true;
            let arrival = end ^ 1;
            points.push(self.at(arrival));
            match self.straightest(end, arrival) {
                Some(next) => end = next,
                None => return points,
            }
        }
    }

    /// Of the strokes that are left at the node of `arrival`, the one that turns least from the way
    /// from `departure`.
    fn straightest(&self, departure: u32, arrival: u32) -> Option<u32> {
        let [from, at] = [self.at(departure), self.at(arrival)];
        let before = step(from, at);
        let cosine = |end: u32| {
            let after = step(at, self.at(end ^ 1));
            dot(before, after) / dot(after, after).sqrt()
        };
        let free = self
            .ends_at(self.node[arrival as usize])
            .iter()
            .filter(|&&end| !self.used[end as usize / 2]);
        free.copied().max_by(|&a, &b| cosine(a).total_cmp(&cosine(b)).then(b.cmp(&a)))
    }
}

/// Drops corners that lie on the way between their neighbours.
fn straightened(points: Vec<Step>) -> Vec<Step> {
    let mut kept = vec![points[0]];
    let mut dropped: Vec<Step> = Vec::new();
    for pair in points.windows(2).skip(1).chain(std::iter::once(&points[points.len() - 1..])) {
        let (here, next) = (pair[0], pair.get(1).copied());
        let anchor = kept[kept.len() - 1];
        dropped.push(here);
        let goes_on = next.filter(|&next| {
            let ahead = dropped.iter().skip(1).chain([&next]);
            let goes_ahead =
                dropped.iter().zip(ahead).all(|(&a, &b)| dot(step(anchor, next), step(a, b)) > 0.0);
            dropped.len() < MOST_DROPPED
                && goes_ahead
                && dropped.iter().all(|&point| is_between(anchor, point, next))
        });
        if goes_on.is_none() {
            kept.push(here);
            dropped.clear();
        }
    }
    kept
}

/// The way from one point to another.
fn step(from: Step, to: Step) -> [f64; 2] {
    [0, 1].map(|k| f64::from(to[k]) - f64::from(from[k]))
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Whether a point is on the way from one to another, but for rounding.
fn is_between(a: Step, point: Step, b: Step) -> bool {
    let (way, at) = (step(a, b), step(a, point));
    let (square, along, beside) = (dot(way, way), dot(way, at), way[0] * at[1] - way[1] * at[0]);
    along >= 0.0 && along <= square && beside * beside <= STRAIGHT * STRAIGHT * square
}

#[cfg(test)]
mod tests {
    use super::*;
    use LineClass::{Contour, Crease};
    use proptest::prelude::*;

    fn lines(strokes: &[[Step; 2]]) -> Vec<Vec<Step>> {
        let strokes: Vec<_> = strokes.iter().map(|&ends| (Contour, 0, ends)).collect();
        chains(&strokes).into_iter().map(|chain| chain.points).collect()
    }

    #[test]
    fn a_square_of_pieces_is_one_closed_line_of_four_corners() {
        let strokes = [
            [[0, 0], [5, 0]],
            [[10, 10], [10, 0]],
            [[5, 0], [10, 0]],
            [[0, 10], [10, 10]],
            [[0, 10], [0, 0]],
        ];
        let found = lines(&strokes);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].len(), found[0][0]), (5, found[0][4]), "{found:?}");
    }

    #[test]
    fn lines_go_on_straight_where_they_cross() {
        let found =
            lines(&[[[0, 0], [5, 5]], [[5, 5], [0, 10]], [[5, 5], [10, 10]], [[10, 0], [5, 5]]]);
        assert_eq!(found, [[[0, 0], [10, 10]], [[0, 10], [10, 0]]]);
        assert!(lines(&[[[3, 3], [3, 3]]]).is_empty());
    }

    #[test]
    fn classes_and_layers_stay_apart() {
        let found = chains(&[
            (Crease, 0, [[1, 0], [2, 0]]),
            (Contour, 1, [[1, 0], [0, 0]]),
            (Contour, 0, [[1, 0], [1, 1]]),
        ]);
        assert_eq!(
            found.iter().map(|c| (c.class, c.layers)).collect::<Vec<_>>(),
            [(Contour, 0), (Crease, 0), (Contour, 1)]
        );
    }

    proptest! {
        #[test]
        fn trails_use_each_stroke_once(ends in prop::collection::vec(prop::array::uniform2(prop::array::uniform2(0i32..5)), 1..40)) {
            let strokes: Vec<[Step; 2]> = ends.into_iter().filter(|e| e[0] != e[1]).collect();
            let sorted = |mut all: Vec<[Step; 2]>| {
                all.iter_mut().for_each(|e| e.sort_unstable());
                all.sort_unstable();
                all
            };
            let trails = Graph::new(&strokes).trails();
            let walked = trails.iter().flat_map(|t| t.windows(2).map(|w| [w[0], w[1]])).collect();
            prop_assert_eq!(sorted(walked), sorted(strokes.clone()));
            let length = |p: &[Step]| dot(step(p[0], p[1]), step(p[0], p[1])).sqrt();
            for trail in trails {
                // Large steps: what lies within half a step of a line lies on it.
                let trail: Vec<Step> = trail.iter().map(|p| p.map(|c| c * 100)).collect();
                let whole: f64 = trail.windows(2).map(length).sum();
                let kept = straightened(trail.clone());
                prop_assert_eq!((kept.first(), kept.last()), (trail.first(), trail.last()));
                prop_assert!((kept.windows(2).map(length).sum::<f64>() - whole).abs() < 1e-6);
            }
        }
    }
}
