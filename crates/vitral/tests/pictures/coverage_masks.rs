//! How exactly the masks of an A-buffer say what of a pixel is covered.

use super::common::{colors, exact, on_z, one};
use super::transparency::{glass, square};
use vitral::{Camera, Projection, TransparencyOrder};

/// Area of the pixel at `(x, y)` that lies inside all half planes `a x + b y <= c`.
fn exact_coverage(halves: &[[f64; 3]], x: f64, y: f64) -> f64 {
    let mut polygon = vec![[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]];
    for [a, b, c] in halves {
        let inside = |p: &[f64; 2]| c - a * p[0] - b * p[1];
        let mut clipped = Vec::new();
        for (i, p) in polygon.iter().enumerate() {
            let q = &polygon[(i + 1) % polygon.len()];
            let (dp, dq) = (inside(p), inside(q));
            if dp >= 0.0 {
                clipped.push(*p);
            }
            if (dp >= 0.0) != (dq >= 0.0) {
                let t = dp / (dp - dq);
                clipped.push([p[0] + (q[0] - p[0]) * t, p[1] + (q[1] - p[1]) * t]);
            }
        }
        polygon = clipped;
    }
    let cross = |i: usize| {
        let (p, q) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        p[0] * q[1] - p[1] * q[0]
    };
    0.5 * (0..polygon.len()).map(cross).sum::<f64>().abs()
}

/// Errors against exact areas, in the pixels on the border of a white square, turned and moved: of
/// the A-buffer's masks, and of a mask of 4x8 places.
fn coverage_errors(turns: impl Iterator<Item = f64>) -> Vec<[f64; 2]> {
    let mut errors = Vec::new();
    for (i, turn) in turns.enumerate() {
        let mut mesh = square(0.0, 0.0);
        let (sin, cos) = vitral::internals::math::func::sin_cos(turn);
        let moved = [0.137 * i as f64 % 1.0, 0.071 * i as f64 % 1.0];
        // Pixels of the picture, 40 a side, are units of the world.
        let half = 11.3;
        for p in &mut mesh.positions {
            let [x, y] = [f64::from(p[0]) * half, f64::from(p[1]) * half];
            *p =
                [(cos * x - sin * y + moved[0]) as f32, (sin * x + cos * y + moved[1]) as f32, 0.0];
        }
        let mut r = exact(one(mesh, glass([1.0; 3], 0.0)), 40, 40);
        r.camera =
            Some(Camera { projection: Projection::Parallel { height: 40.0 }, ..on_z(5.0, 1.0) });
        (r.settings.picture.samples, r.settings.transparency.order) =
            (16, TransparencyOrder::A_BUFFER);
        let middle = [20.0 + moved[0], 20.0 - moved[1]];
        let halves = [[cos, -sin], [-cos, sin], [sin, cos], [-sin, -cos]]
            .map(|[a, b]| [a, b, half + a * middle[0] + b * middle[1]]);
        for (at, color) in colors(&mut r).iter().enumerate() {
            let exact = exact_coverage(&halves, (at % 40) as f64, (at / 40) as f64);
            if exact > 1e-9 && exact < 1.0 - 1e-9 {
                let place = |i: usize| {
                    [
                        (at % 40) as f64 + (i % 4) as f64 / 4.0 + 0.125,
                        (at / 40) as f64 + (i / 4) as f64 / 8.0 + 0.0625,
                    ]
                };
                let inside = |p: [f64; 2]| halves.iter().all(|[a, b, c]| a * p[0] + b * p[1] <= *c);
                let mask = (0..32).filter(|&i| inside(place(i))).count() as f64 / 32.0;
                errors.push([f64::from(color[0]) / 255.0 - exact, mask - exact]);
            }
        }
    }
    errors
}

#[test]
fn p18_coverage_masks_are_about_as_good_as_exact_areas() {
    // A byte, and 1/256 pixel to which corners are snapped.
    let rounding = 0.5 / 255.0 + 2.0 / 256.0;
    // Upright edges: each of 16 samples has a column and a row of its own, so an edge is off by
    // half a column at most. A corner of the square has two edges.
    let upright = coverage_errors((0..12).map(|_| 0.0));
    assert!(upright.len() > 800);
    let far = upright.iter().filter(|[e, _]| e.abs() > 1.0 / 32.0 + rounding).count();
    assert!(far <= 4 * 12, "{far} of {}: more than the corners", upright.len());
    // Edges of all directions: 1/32 on the mean, to neither side.
    let all = coverage_errors((0..40).map(|i| 0.0393 * f64::from(i)));
    let count = all.len() as f64;
    let mean = |mask: usize| all.iter().map(|e| e[mask].abs()).sum::<f64>() / count;
    let worst = |mask: usize| all.iter().map(|e| e[mask].abs()).fold(0.0, f64::max);
    let bias = all.iter().map(|e| e[0]).sum::<f64>() / count;
    assert!(mean(0) <= 1.0 / 32.0, "{} on the mean", mean(0));
    assert!(bias.abs() <= 1.0 / 320.0, "{bias} to one side");
    // In a single pixel the error can be larger, of any mask: 4x8 places say an edge along their
    // rows or columns is up to an eighth of a pixel from where it is. Twice as many places halve
    // the mean.
    assert!(
        worst(0) <= 0.18 && worst(1) > 1.0 / 32.0,
        "{} and {} at the worst",
        worst(0),
        worst(1)
    );
    assert!(mean(0) <= 2.1 * mean(1), "{} and {} on the mean", mean(0), mean(1));
}
