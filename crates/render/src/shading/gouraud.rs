//! Gouraud shading: intensities are computed at the vertices and interpolated.
//!
//! The four steps: normals of the faces; normals of the vertices, the mean of their faces';
//! intensities of the vertices by an illumination model; interpolation along edges and spans. The
//! first two belong to the mesh (`vitral_scene::normals`). A highlight inside a face is lost.
//!
//! Scan conversion adds one number a pixel: with `py = (iV - iU) / (yV - yU)` along an edge from U
//! to V, `I(k+1) = I(k) + py`, and with `px = (Ik2 - Ik1) / (xk2 - xk1)` along a span,
//! `I(x+1) = I(x) + px` ([`edge_increment`], [`span_increment`]): [`scan_convert`] does it, for
//! whoever wants to see it. The tile renderer weighs the vertices directly, since a sum would
//! depend on where it began; up to rounding that is the same.
//!
//! Input: corners and weights of a point, view space. Output: reflected light at the point.
//! Source: [Gouraud 1971].

use super::geometry::{Surface, blend3};
use super::lighting::{Coefficients, Lighting};
use vitral_light::Reflected;
use vitral_math::lanes::{self, F32x8, Simd};

/// Illuminates the three corners of each point's facet and interpolates.
#[inline(always)]
pub(crate) fn shade<S: Simd>(
    simd: S,
    surface: &Surface<F32x8<S>>,
    lighting: &Lighting<'_>,
    corner_coefficients: &[Coefficients<F32x8<S>>; 3],
) -> Reflected<F32x8<S>> {
    let at = lanes::inlined(
        #[inline(always)]
        |k: usize| {
            lighting.reflect(
                simd,
                &surface.positions[k],
                &surface.normals[k].normalize(),
                &corner_coefficients[k],
            )
        },
    );
    let (a, b, c) = (at(0), at(1), at(2));
    Reflected {
        diffuse: blend3(&surface.weights, &[a.diffuse, b.diffuse, c.diffuse]),
        specular: blend3(&surface.weights, &[a.specular, b.specular, c.specular]),
    }
}

/// Change of intensity from one scan line to the next along the edge from `(y, intensity)` `u` to
/// `v`.
pub fn edge_increment(u: (f64, f64), v: (f64, f64)) -> f64 {
    (v.1 - u.1) / (v.0 - u.0)
}

/// Change of intensity from one pixel to the next along the span from `(x, intensity)` `left` to
/// `right`.
pub fn span_increment(left: (f64, f64), right: (f64, f64)) -> f64 {
    (right.1 - left.1) / (right.0 - left.0)
}

/// A vertex on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenIntensity {
    /// Place in pixels, y downwards.
    pub at: [f64; 2],
    /// Intensity of each colour.
    pub intensity: [f64; 3],
}

/// Where an edge crosses a scan line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeStep {
    /// The edge's upper and lower vertex.
    pub ends: [usize; 2],
    /// Change of intensity for a line.
    pub py: [f64; 3],
    /// Place of the crossing in pixels.
    pub x: f64,
    /// Intensity there.
    pub intensity: [f64; 3],
}

/// A scan line with pixels of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpanSteps {
    /// Row of pixels, seen at its middle.
    pub row: i64,
    /// The edge on the left.
    pub left: EdgeStep,
    /// The edge on the right.
    pub right: EdgeStep,
    /// Change of intensity for a pixel.
    pub px: [f64; 3],
    /// The first pixel whose middle is in the span, and the one behind the last.
    pub pixels: [i64; 2],
    /// Intensity at the middle of the first.
    pub first: [f64; 3],
}

/// How many additions of an increment scan conversion took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Additions {
    /// Along edges.
    pub edges: u64,
    /// Along spans.
    pub spans: u64,
}

/// Scan converts a triangle with Gouraud's increments: calls `put` for each pixel whose middle is
/// in it, row by row, with its span, its column and its intensity. Nothing is added up where
/// nothing is: a triangle without height has no lines.
pub fn scan_convert(
    vertices: &[ScreenIntensity; 3],
    mut put: impl FnMut(&SpanSteps, i64, [f64; 3]),
) -> Additions {
    let mut additions = Additions::default();

    // Sort the corners from top to bottom.
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| vertices[a].at[1].total_cmp(&vertices[b].at[1]));
    let [top, middle, bottom] = order;
    let mut long = Walk::new(vertices, [top, bottom]);

    // Walk the long edge together with the two short ones.
    for ends in [[top, middle], [middle, bottom]] {
        let mut short = Walk::new(vertices, ends);
        for row in short.rows.clone() {
            let on_long = long.at(row, &mut additions);
            let on_short = short.at(row, &mut additions);
            let (left, right) =
                if on_long.x <= on_short.x { (on_long, on_short) } else { (on_short, on_long) };

            // Step the intensity along the span.
            let px = [0, 1, 2].map(|k| {
                span_increment((left.x, left.intensity[k]), (right.x, right.intensity[k]))
            });
            let pixels = [left.x, right.x].map(|x| (x - 0.5).ceil() as i64);
            if pixels[0] >= pixels[1] {
                continue;
            }
            let offset = pixels[0] as f64 + 0.5 - left.x;
            let first = [0, 1, 2].map(|k| left.intensity[k] + px[k] * offset);
            let span = SpanSteps { row, left, right, px, pixels, first };
            let mut intensity = first;
            put(&span, pixels[0], intensity);
            for x in pixels[0] + 1..pixels[1] {
                for k in 0..3 {
                    intensity[k] += px[k];
                }
                additions.spans += 1;
                put(&span, x, intensity);
            }
        }
    }
    additions
}

/// The way down an edge.
struct Walk {
    step: EdgeStep,
    dx: f64,
    /// Lines that it crosses.
    rows: std::ops::Range<i64>,
    started: bool,
}

impl Walk {
    fn new(vertices: &[ScreenIntensity; 3], ends: [usize; 2]) -> Self {
        let [u, v] = ends.map(|i| vertices[i]);
        let rows = (u.at[1] - 0.5).ceil() as i64..(v.at[1] - 0.5).ceil() as i64;
        let py =
            [0, 1, 2].map(|k| edge_increment((u.at[1], u.intensity[k]), (v.at[1], v.intensity[k])));
        let dx = edge_increment((u.at[1], u.at[0]), (v.at[1], v.at[0]));
        let down = rows.start as f64 + 0.5 - u.at[1];
        let intensity = [0, 1, 2].map(|k| u.intensity[k] + py[k] * down);
        let step = EdgeStep { ends, py, x: u.at[0] + dx * down, intensity };
        Self { step, dx, rows, started: false }
    }

    /// Goes on to the next row, which is this one.
    fn at(&mut self, row: i64, additions: &mut Additions) -> EdgeStep {
        if self.started {
            self.step.x += self.dx;
            for k in 0..3 {
                self.step.intensity[k] += self.step.py[k];
            }
            additions.edges += 1;
        }
        debug_assert!(self.started || row == self.rows.start);
        self.started = true;
        self.step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The intensity at `(x, y)` between three vertices `(x, y, intensity)`.
    fn barycentric(v: [(f64, f64, f64); 3], x: f64, y: f64) -> f64 {
        let area = |a: (f64, f64), b: (f64, f64), c: (f64, f64)| {
            (b.0 - a.0) * (c.1 - a.1) - (c.0 - a.0) * (b.1 - a.1)
        };
        let [a, b, c] = v.map(|p| (p.0, p.1));
        let whole = area(a, b, c);
        let p = (x, y);
        (area(p, b, c) * v[0].2 + area(a, p, c) * v[1].2 + area(a, b, p) * v[2].2) / whole
    }

    #[test]
    fn l9_increments_equal_direct_interpolation() {
        let v @ [top, left, right] = [(40.0, 0.0, 0.9), (0.0, 100.0, 0.1), (90.0, 100.0, 0.5)];
        // Walk both edges down and each span to the right, one addition a step.
        let (dl, dr) =
            (edge_increment((0.0, 0.9), (100.0, 0.1)), edge_increment((0.0, 0.9), (100.0, 0.5)));
        let (mut i_left, mut i_right) = (top.2, top.2);
        for y in 0..=100 {
            let t = f64::from(y) / 100.0;
            let (x_left, x_right) = (top.0 + (left.0 - top.0) * t, top.0 + (right.0 - top.0) * t);
            if y > 0 {
                let px = span_increment((x_left, i_left), (x_right, i_right));
                let first = x_left.ceil();
                let mut intensity = i_left + px * (first - x_left);
                let mut x = first;
                while x <= x_right {
                    assert!(
                        (intensity - barycentric(v, x, f64::from(y))).abs() < 1e-6,
                        "({x}, {y})"
                    );
                    intensity += px;
                    x += 1.0;
                }
            }
            i_left += dl;
            i_right += dr;
        }
    }

    #[test]
    fn l9_scan_conversion_adds_once_a_pixel_and_gives_what_weights_give() {
        let mut state = 11u32;
        let mut next = |size: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from((state >> 8) % (size * 16)) / 16.0
        };
        let (mut pixels, mut spans) = (0u64, 0u64);
        for _ in 0..400 {
            let mut vertex = || ScreenIntensity {
                at: [next(200) - 40.0, next(120)],
                intensity: [0; 3].map(|_| next(16) / 16.0),
            };
            let v = [vertex(), vertex(), vertex()];
            let at = |k: usize| v.map(|p| (p.at[0], p.at[1], p.intensity[k]));
            let inside = |x: f64, y: f64| {
                let side = |i: usize| {
                    let (a, b) = (v[i].at, v[(i + 1) % 3].at);
                    (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
                };
                (0..3).all(|i| side(i) > 1e-9) || (0..3).all(|i| side(i) < -1e-9)
            };
            let (mut put, mut rows) =
                (std::collections::BTreeSet::new(), std::collections::BTreeSet::new());
            let additions = scan_convert(&v, |span, x, intensity| {
                let place = (x as f64 + 0.5, span.row as f64 + 0.5);
                for k in 0..3 {
                    let direct = barycentric(at(k), place.0, place.1);
                    // What is left of a needle's width is rounding.
                    let steep = span.px[k].abs().max(1.0);
                    assert!(
                        (intensity[k] - direct).abs() <= 1e-6 * steep,
                        "{v:?} {place:?}: {intensity:?}, {direct}"
                    );
                }
                assert!(put.insert((x, span.row)), "each pixel once");
                rows.insert(span.row);
            });
            assert_eq!(
                additions.spans,
                (put.len() - rows.len()) as u64,
                "one addition for each pixel but the first"
            );
            assert!(additions.edges <= 2 * 120);
            for (x, y) in (-42..162).flat_map(|x| (0..121).map(move |y| (x, y))) {
                assert!(
                    !inside(x as f64 + 0.5, y as f64 + 0.5) || put.contains(&(x, y)),
                    "{v:?}: {x} {y}"
                );
            }
            (pixels, spans) = (pixels + put.len() as u64, spans + rows.len() as u64);
        }
        assert!(pixels > 100_000 && spans > 5000, "{pixels} {spans}");
    }
}
