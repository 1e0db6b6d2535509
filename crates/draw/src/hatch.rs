//! Hatching: parallel lines over the visible parts of cuts, at an angle and a distance on paper.
//!
//! The lines of one pattern belong to one family through the origin of the sheet, so that those of
//! neighbouring regions line up. Parts differ by their patterns: the first six by the angle, 0, 90,
//! 165, 75, 15 and 105 degrees from the first one's (45, 135, 30, 120, 60 and 150 degrees for 45),
//! the next six by the distance as well, half as large again, and so on.
//!
//! In:   outlines of regions in millimetres. Out: lines inside, even-odd.
//! Cost: for each region its corners, and `n log n` for the crossings with its lines.
//! Source: the scan conversion of polygons with sorted crossings, [Foley et al. 1990], section 3.6,
//! in a turned frame; ISO 128 for what hatching looks like.

use crate::fill::PageRegion;
use std::f64::consts::{FRAC_PI_4, PI};
use vitral_frame::drawing::{Line, LineClass};
use vitral_math::func;

/// Angles of patterns from the first one's, degrees.
const ANGLES: [f64; 6] = [0.0, 90.0, -15.0, 75.0, 15.0, 105.0];
/// Distances of the lines of patterns as multiples of the first one's: each time so much more.
const WIDER: f64 = 0.5;
/// Length in millimetres below which a line is dust.
const DUST: f64 = 0.01;

/// Hatching of the first part that is cut; the others' follows from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hatch {
    /// Angle of the lines with the lower border of the sheet, radians, counter-clockwise.
    pub angle: f64,
    /// Distance between lines on paper, millimetres, above 0.
    pub distance: f64,
}

impl Default for Hatch {
    fn default() -> Self {
        Self { angle: FRAC_PI_4, distance: 2.0 }
    }
}

impl Hatch {
    /// The pattern of the part with this number.
    pub(crate) fn of_part(self, number: usize) -> Self {
        let wider = 1.0 + WIDER * (number / ANGLES.len()) as f64;
        Self {
            angle: self.angle + ANGLES[number % ANGLES.len()] * (PI / 180.0),
            distance: self.distance * wider,
        }
    }
}

/// The visible parts of cuts.
#[derive(Debug, Default)]
pub(crate) struct Cuts {
    /// Regions, whose colours are numbers of parts.
    pub(crate) regions: Vec<PageRegion>,
    pub(crate) hatch: Hatch,
}

impl Cuts {
    /// The number of a part as a colour, which keeps regions of different parts apart.
    pub(crate) fn color_of_part(number: usize) -> [u8; 3] {
        let [a, b, c, ..] = (number as u32).to_le_bytes();
        [a, b, c]
    }

    /// The hatching of a region.
    pub(crate) fn pattern(&self, region: &PageRegion) -> Hatch {
        let [a, b, c] = region.color;
        self.hatch.of_part(u32::from_le_bytes([a, b, c, 0]) as usize)
    }
}

/// The lines of a pattern inside closed outlines, all in millimetres.
pub(crate) fn hatch(rings: &[Vec<[f64; 2]>], pattern: Hatch) -> Vec<Line> {
    let (sine, cosine) = (func::sin(pattern.angle), func::cos(pattern.angle));
    // How far along the lines a point is, and how many distances beside the one through the origin.
    let turned =
        |[x, y]: [f64; 2]| [x * cosine + y * sine, (y * cosine - x * sine) / pattern.distance];
    let back = |along: f64, number: i64| {
        let beside = number as f64 * pattern.distance;
        [along * cosine - beside * sine, along * sine + beside * cosine]
    };

    // Find where the outlines cross the lines; a corner on a line counts as beyond it.
    let mut crossings: Vec<(i64, f64)> = Vec::new();
    for ring in rings {
        for (i, &from) in ring.iter().enumerate() {
            let (p, q) = (turned(from), turned(ring[(i + 1) % ring.len()]));
            let (low, high) = if p[1] <= q[1] { (p, q) } else { (q, p) };
            for number in low[1].ceil() as i64..high[1].ceil() as i64 {
                let way = (number as f64 - low[1]) / (high[1] - low[1]);
                crossings.push((number, low[0] + (high[0] - low[0]) * way));
            }
        }
    }
    crossings.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));

    // Draw from each odd crossing to the next.
    let mut lines = Vec::new();
    for on_line in crossings.chunk_by(|a, b| a.0 == b.0) {
        for pair in on_line.chunks_exact(2).filter(|pair| pair[1].1 - pair[0].1 >= DUST) {
            let points =
                [pair[0], pair[1]].map(|(number, along)| back(along, number).map(rounded)).to_vec();
            lines.push(Line { class: LineClass::Hatch, layers: 0, points });
        }
    }
    lines
}

/// A coordinate at the precision of sheets, a micrometre.
fn rounded(at: f64) -> f64 {
    (at * 1000.0).round() / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: f64, high: f64) -> Vec<[f64; 2]> {
        vec![[low, low], [high, low], [high, high], [low, high]]
    }

    fn length(lines: &[Line]) -> f64 {
        lines.iter().map(Line::length).sum()
    }

    #[test]
    fn a_square_is_crossed_by_lines_that_can_be_counted() {
        // Level lines at 2, 4, …, 10 mm: the lower border counts, the upper one does not.
        let level = Hatch { angle: 0.0, distance: 2.0 };
        let lines = hatch(&[square(0.5, 10.5)], level);
        assert_eq!((lines.len(), length(&lines)), (5, 50.0));
        let lines = hatch(&[square(2.0, 10.0)], level);
        assert_eq!((lines.len(), lines[0].points[0]), (4, [2.0, 2.0]));
        // At 45 degrees, the diagonal and pairs that are shorter by 4√2 … each.
        let tilted = hatch(&[square(0.0, 10.0)], Hatch { angle: FRAC_PI_4, distance: 2.0 });
        let root = 2f64.sqrt();
        let expected: f64 =
            (-3..=3).map(|k| 10.0 * root - 2.0 * 2.0 * f64::from(i32::abs(k))).sum();
        assert_eq!(tilted.len(), 7);
        assert!((length(&tilted) - expected).abs() < 0.01, "{} {expected}", length(&tilted));
    }

    #[test]
    fn holes_stay_free_and_neighbours_line_up() {
        let level = Hatch { angle: 0.0, distance: 1.0 };
        let mut hole = square(3.25, 6.25);
        hole.reverse();
        let lines = hatch(&[square(0.25, 9.25), hole], level);
        assert_eq!((lines.len(), length(&lines)), (9 + 3, 81.0 - 9.0));
        let tilted = Hatch { angle: 1.0, distance: 1.7 };
        let shifted: Vec<[f64; 2]> = square(0.0, 5.0).iter().map(|p| [p[0] + 5.0, p[1]]).collect();
        let both = vec![[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [0.0, 5.0]];
        let apart =
            length(&hatch(&[square(0.0, 5.0)], tilted)) + length(&hatch(&[shifted], tilted));
        assert!((apart - length(&hatch(&[both], tilted))).abs() < 0.02);
        assert!(hatch(&[], level).is_empty());
    }

    #[test]
    fn parts_have_different_patterns() {
        let degrees = |k: usize| (Hatch::default().of_part(k).angle * 180.0 / PI).round();
        assert_eq!(
            [0, 1, 2, 3, 4, 5, 6].map(degrees),
            [45.0, 135.0, 30.0, 120.0, 60.0, 150.0, 45.0]
        );
        assert_eq!(
            [0, 5, 6, 12].map(|k| Hatch::default().of_part(k).distance),
            [2.0, 2.0, 3.0, 4.0]
        );
    }
}
