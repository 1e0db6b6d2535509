//! The symbol of the projection method: a truncated cone that lies on its side, seen from the front
//! and from the left.
//!
//! Its narrow end is on the left, so both circles are visible from there. In first angle the view
//! from the left stands on the right of the front view; in third angle it stands on the left.
//!
//! Source: \[ISO 5456-2\]; the sizes are those for letters of 2.5 mm.

use super::Angle;
use vitral_math::func;

/// Diameters of the ends, and length of the cone, in millimetres.
const NARROW: f64 = 2.5;
const WIDE: f64 = 5.0;
/// How far the axes stand out, in millimetres.
const BEYOND: f64 = 1.0;
/// Millimetres between the views, axes included.
const BETWEEN: f64 = 1.5;
/// Sides of the polygons that stand for circles.
const SIDES: usize = 48;
/// Long dash, gap, dot, gap, long dash of the cone's axis, in millimetres.
const AXIS: [f64; 5] = [2.6, 0.6, 0.6, 0.6, 2.6];

/// Width and height of the symbol in millimetres.
pub const SYMBOL_SIZE: [f64; 2] = [2.0 * (WIDE + 2.0 * BEYOND) + BETWEEN, WIDE + 2.0 * BEYOND];

/// The strokes of the symbol in millimetres, from its lower left corner.
pub fn symbol(angle: Angle) -> Vec<Vec<[f64; 2]>> {
    // Choose the side of the cone.
    let view = WIDE + 2.0 * BEYOND;
    let (cone, circles) = match angle {
        Angle::First => (0.0, view + BETWEEN),
        Angle::Third => (view + BETWEEN, 0.0),
    };
    let middle = view / 2.0;

    // Draw the cone from the front, with its axis.
    let [left, right] = [cone + BEYOND, cone + BEYOND + WIDE];
    let [narrow, wide] = [NARROW / 2.0, WIDE / 2.0];
    let mut strokes = vec![vec![
        [left, middle - narrow],
        [right, middle - wide],
        [right, middle + wide],
        [left, middle + narrow],
        [left, middle - narrow],
    ]];
    let mut at = cone;
    for (i, length) in AXIS.into_iter().enumerate() {
        strokes.extend((i % 2 == 0).then(|| vec![[at, middle], [at + length, middle]]));
        at += length;
    }

    // Draw its ends from the left, with both axes.
    let center = circles + middle;
    for radius in [narrow, wide] {
        let corner = |i: usize| {
            let angle = std::f64::consts::TAU * (i % SIDES) as f64 / SIDES as f64;
            [center + radius * func::cos(angle), middle + radius * func::sin(angle)]
        };
        strokes.push((0..=SIDES).map(corner).collect());
    }
    strokes.push(vec![[circles, middle], [circles + view, middle]]);
    strokes.push(vec![[center, 0.0], [center, view]]);
    strokes
}
