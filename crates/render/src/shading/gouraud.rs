//! Gouraud shading: intensities are computed at the vertices and interpolated.
//!
//! The four steps: normals of the faces; normals of the vertices, the mean of their faces'; intensities of the vertices
//! by an illumination model; interpolation along edges and spans. The first two belong to the mesh
//! (`vitral_scene::normals`). A highlight inside a face is lost.
//!
//! Scan conversion adds one number a pixel: with `py = (iV - iU) / (yV - yU)` along an edge from U to V,
//! `I(k+1) = I(k) + py`, and with `px = (Ik2 - Ik1) / (xk2 - xk1)` along a span, `I(x+1) = I(x) + px`
//! ([`edge_increment`], [`span_increment`]). The tile renderer weighs the vertices directly, which gives the same.
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
            lighting.reflect(simd, &surface.positions[k], &surface.normals[k].normalize(), &corner_coefficients[k])
        },
    );
    let (a, b, c) = (at(0), at(1), at(2));
    Reflected {
        diffuse: blend3(&surface.weights, &[a.diffuse, b.diffuse, c.diffuse]),
        specular: blend3(&surface.weights, &[a.specular, b.specular, c.specular]),
    }
}

/// Change of intensity from one scan line to the next along the edge from `(y, intensity)` `u` to `v`.
pub fn edge_increment(u: (f64, f64), v: (f64, f64)) -> f64 {
    (v.1 - u.1) / (v.0 - u.0)
}

/// Change of intensity from one pixel to the next along the span from `(x, intensity)` `left` to `right`.
pub fn span_increment(left: (f64, f64), right: (f64, f64)) -> f64 {
    (right.1 - left.1) / (right.0 - left.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The intensity at `(x, y)` between three vertices `(x, y, intensity)`.
    fn barycentric(v: [(f64, f64, f64); 3], x: f64, y: f64) -> f64 {
        let area = |a: (f64, f64), b: (f64, f64), c: (f64, f64)| (b.0 - a.0) * (c.1 - a.1) - (c.0 - a.0) * (b.1 - a.1);
        let [a, b, c] = v.map(|p| (p.0, p.1));
        let whole = area(a, b, c);
        let p = (x, y);
        (area(p, b, c) * v[0].2 + area(a, p, c) * v[1].2 + area(a, b, p) * v[2].2) / whole
    }

    #[test]
    fn l9_increments_equal_direct_interpolation() {
        let v @ [top, left, right] = [(40.0, 0.0, 0.9), (0.0, 100.0, 0.1), (90.0, 100.0, 0.5)];
        // Walk both edges down and each span to the right, one addition a step.
        let (dl, dr) = (edge_increment((0.0, 0.9), (100.0, 0.1)), edge_increment((0.0, 0.9), (100.0, 0.5)));
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
                    assert!((intensity - barycentric(v, x, f64::from(y))).abs() < 1e-6, "({x}, {y})");
                    intensity += px;
                    x += 1.0;
                }
            }
            i_left += dl;
            i_right += dr;
        }
    }
}
