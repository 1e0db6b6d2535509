//! Polylines with fewer corners.
//!
//! The corner farthest from the line between the ends stays if it is farther than the tolerance,
//! and both parts are simplified in turn. A closed line is cut at its first corner and the one
//! farthest from it.
//!
//! In:   polylines and a tolerance in millimetres. Out: polylines whose corners are some of them.
//! Cost: `n log n` for usual lines. Long ones are simplified in runs of [`RUN`] corners, which
//!       bounds the worst case.
//! Source: [Douglas & Peucker 1973].

use vitral_frame::Drawing;

/// Corners that are looked at together at most.
const RUN: usize = 4096;

/// Simplifies the lines of a drawing. Regions stay: their outlines have to fit those of their
/// neighbours.
pub fn simplify(drawing: &mut Drawing, tolerance: f64) {
    drawing.lines.iter_mut().for_each(|line| line.points = simplified(&line.points, tolerance));
}

fn simplified(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let last = points.len().saturating_sub(1);
    if last < 2 {
        return points.to_vec();
    }

    // Cut the line where corners stay for certain.
    let mut kept = vec![false; points.len()];
    let mut cuts: Vec<usize> = (0..last).step_by(RUN).collect();
    cuts.push(last);
    if points[0] == points[last] {
        let distance = |i: usize| square(points[0], points[i]);
        let farthest =
            (1..last).max_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(b.cmp(&a)));
        cuts.extend(farthest);
        cuts.sort_unstable();
        cuts.dedup();
    }
    cuts.iter().for_each(|&i| kept[i] = true);

    let mut parts: Vec<(usize, usize)> = cuts.windows(2).map(|pair| (pair[0], pair[1])).collect();
    while let Some((from, to)) = parts.pop() {
        let mut farthest = (tolerance * tolerance, None);
        for i in from + 1..to {
            let distance = to_segment(points[i], points[from], points[to]);
            if distance > farthest.0 {
                farthest = (distance, Some(i));
            }
        }
        if let Some(i) = farthest.1 {
            kept[i] = true;
            parts.extend([(from, i), (i, to)]);
        }
    }
    points.iter().zip(kept).filter(|(_, kept)| *kept).map(|(point, _)| *point).collect()
}

fn square(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    x * x + y * y
}

/// Square of the distance of a point from a segment.
fn to_segment(point: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let length = square(a, b);
    if length == 0.0 {
        return square(a, point);
    }
    let along = (point[0] - a[0]) * (b[0] - a[0]) + (point[1] - a[1]) * (b[1] - a[1]);
    let t = (along / length).clamp(0.0, 1.0);
    square(point, [0, 1].map(|k| a[k] + (b[k] - a[k]) * t))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_within_the_tolerance_go() {
        let line = [[0.0, 0.0], [1.0, 0.1], [2.0, -0.1], [3.0, 0.0], [3.0, 5.0]];
        assert_eq!(simplified(&line, 0.2), [[0.0, 0.0], [3.0, 0.0], [3.0, 5.0]]);
        assert_eq!(simplified(&line, 0.0), line);
        assert_eq!(simplified(&line[..2], 9.0), line[..2]);
    }

    #[test]
    fn closed_lines_stay_closed_and_no_corner_is_far_from_what_is_left() {
        let (mut points, mut at) = (Vec::new(), [1.0, 0.0]);
        for _ in 0..10_000 {
            points.push(at);
            at = [at[0] - at[1] * 0.001, at[1] + at[0] * 0.001];
        }
        points.push(points[0]);
        let left = simplified(&points, 0.01);
        assert!(left.len() < 100 && left.first() == left.last(), "{}", left.len());
        let distance = |p: &[f64; 2]| {
            left.windows(2).map(|s| to_segment(*p, s[0], s[1])).fold(f64::INFINITY, f64::min)
        };
        assert!(points.iter().all(|p| distance(p) <= 0.01 * 0.01 + 1e-12));
        let there_and_back = [[0.0, 0.0], [4.0, 0.0], [0.0, 0.0]];
        assert_eq!(simplified(&there_and_back, 9.0), there_and_back);
    }
}
