//! Evaluation of maps.
//!
//! A map is a Bézier curve or surface: a sum of control points, weighted by Bernstein polynomials,
//! which come from the triangle `b(i, n) = (1 - t) b(i, n - 1) + t b(i - 1, n - 1)`. The derivative
//! of a polynomial of degree `d` is `d` times that of degree `d - 1` on the differences of
//! neighbouring points.

use crate::state::{Eval, MAX_EVAL_ORDER, Map1, Map2};
use crate::vertices::attribute::{COLOR, INDEX, NORMAL, TEX};
use crate::vertices::immediate::filled;

/// Numbers of a control point, by map.
pub(super) const COMPONENTS: [usize; 9] = [4, 1, 3, 1, 2, 3, 4, 3, 4];

const COLOR_4: usize = 0;
const INDEX_1: usize = 1;
const NORMAL_3: usize = 2;
const TEXTURE_COORD_1: usize = 3;
const VERTEX_3: usize = 7;
const VERTEX_4: usize = 8;

/// A vertex that maps gave.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Evaluated {
    /// Attributes with their values.
    pub(super) attributes: Vec<(usize, [f32; 4])>,
    /// Position; without one there is no vertex.
    pub(super) position: Option<[f32; 4]>,
}

type Weights = [f32; MAX_EVAL_ORDER];

/// Weights of the points of a polynomial of `order`, and of its derivative.
fn weights(order: usize, t: f32) -> (Weights, Weights) {
    let mut value = [0.0; MAX_EVAL_ORDER];
    let mut slope = [0.0; MAX_EVAL_ORDER];
    value[0] = 1.0;

    // Raise the degree step by step; the derivative comes from the degree below.
    for degree in 1..order {
        if degree == order - 1 {
            for i in 0..order {
                let before = if i > 0 { value[i - 1] } else { 0.0 };
                let here = if i < degree { value[i] } else { 0.0 };
                slope[i] = degree as f32 * (before - here);
            }
        }
        for i in (1..=degree).rev() {
            value[i] = (1.0 - t) * value[i] + t * value[i - 1];
        }
        value[0] *= 1.0 - t;
    }
    (value, slope)
}

/// Where `x` lies in a domain.
fn parameter(x: f32, [from, to]: [f32; 2]) -> f32 {
    (x - from) / (to - from)
}

/// The point of a curve.
fn curve(map: &Map1, index: usize, u: f32) -> [f32; 4] {
    let (weights, _) = weights(map.order, parameter(u, map.u));
    let components = COMPONENTS[index];
    let mut point = [0.0; 4];
    for (weight, control) in weights.iter().zip(map.points.chunks_exact(components)) {
        for (x, c) in point.iter_mut().zip(control) {
            *x += weight * c;
        }
    }
    completed(point, components)
}

/// The point of a surface, and its derivatives in u and v.
fn surface(map: &Map2, index: usize, u: f32, v: f32) -> [[f32; 4]; 3] {
    // Weigh the control points.
    let (value_u, slope_u) = weights(map.order[0], parameter(u, map.u));
    let (value_v, slope_v) = weights(map.order[1], parameter(v, map.v));
    let components = COMPONENTS[index];
    let mut sums = [[0.0; 4]; 3];
    for (i, row) in map.points.chunks_exact(components * map.order[1]).enumerate() {
        for (j, control) in row.chunks_exact(components).enumerate() {
            let factors =
                [value_u[i] * value_v[j], slope_u[i] * value_v[j], value_u[i] * slope_v[j]];
            for (sum, factor) in sums.iter_mut().zip(factors) {
                for (x, c) in sum.iter_mut().zip(control) {
                    *x += factor * c;
                }
            }
        }
    }

    // Scale the derivatives to the domain.
    let [point, mut du, mut dv] = sums;
    du = du.map(|x| x / (map.u[1] - map.u[0]));
    dv = dv.map(|x| x / (map.v[1] - map.v[0]));
    [completed(point, components), du, dv]
}

/// Numbers that a point does not have: 0, 0, 0, 1.
fn completed(mut point: [f32; 4], components: usize) -> [f32; 4] {
    if components < 4 {
        point[3] = 1.0;
    }
    point
}

/// The normal of a surface, from a homogeneous point and its derivatives.
fn normal(point: [f32; 4], du: [f32; 4], dv: [f32; 4]) -> [f32; 3] {
    let project = |d: [f32; 4]| [0, 1, 2].map(|i| d[i] * point[3] - point[i] * d[3]);
    let (a, b) = (project(du), project(dv));
    let n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
    if length > 0.0 { n.map(|x| x / length) } else { n }
}

/// Which maps apply, with the attribute that each gives: of texture coordinates the widest.
fn attribute_maps(enabled: &[bool; 9]) -> impl Iterator<Item = (usize, usize)> + '_ {
    let tex = (TEXTURE_COORD_1..TEXTURE_COORD_1 + 4).rev().find(|&i| enabled[i]);
    let others = [(COLOR_4, COLOR), (INDEX_1, INDEX), (NORMAL_3, NORMAL)];
    let others = others.into_iter().filter(|(index, _)| enabled[*index]);
    others.chain(tex.map(|index| (index, TEX)))
}

fn vertex_map(enabled: &[bool; 9]) -> Option<usize> {
    [VERTEX_4, VERTEX_3].into_iter().find(|&index| enabled[index])
}

/// What the one-dimensional maps give at `u`.
pub(super) fn evaluate_1(eval: &Eval, u: f32) -> Evaluated {
    let Some(index) = vertex_map(&eval.map1_enabled) else { return Evaluated::default() };
    let attributes = attribute_maps(&eval.map1_enabled);
    Evaluated {
        attributes: attributes
            .map(|(index, which)| (which, curve(&eval.map1[index], index, u)))
            .collect(),
        position: Some(curve(&eval.map1[index], index, u)),
    }
}

/// What the two-dimensional maps give at `(u, v)`.
pub(super) fn evaluate_2(eval: &Eval, u: f32, v: f32) -> Evaluated {
    let Some(index) = vertex_map(&eval.map2_enabled) else { return Evaluated::default() };
    let [position, du, dv] = surface(&eval.map2[index], index, u, v);
    let attributes = attribute_maps(&eval.map2_enabled)
        .filter(|(_, which)| *which != NORMAL || !eval.auto_normal);
    let mut attributes: Vec<_> = attributes
        .map(|(index, which)| (which, surface(&eval.map2[index], index, u, v)[0]))
        .collect();
    if eval.auto_normal {
        attributes.push((NORMAL, filled(normal(position, du, dv))));
    }
    Evaluated { attributes, position: Some(position) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_and_its_slope() {
        // Control values 0, 1, 0 of order 3: 2t(1 - t), slope 2 - 4t.
        let (value, slope) = weights(3, 0.25);
        assert_eq!((value[1], slope[1]), (0.375, 1.0));
        assert_eq!(value[..3].iter().sum::<f32>(), 1.0);
        assert_eq!(slope[..3].iter().sum::<f32>(), 0.0);
        let (constant, none) = weights(1, 0.3);
        assert_eq!((constant[0], none[0]), (1.0, 0.0));
    }

    #[test]
    fn a_flat_patch_faces_up() {
        let mut eval = Eval { auto_normal: true, ..Eval::default() };
        let points = vec![0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 2.0, 0.0, 0.0, 2.0, 2.0, 0.0];
        eval.map2[VERTEX_3] = Map2 { order: [2, 2], u: [0.0, 4.0], v: [0.0, 1.0], points };
        eval.map2_enabled[VERTEX_3] = true;
        eval.map2_enabled[NORMAL_3] = true;
        let found = evaluate_2(&eval, 1.0, 0.5);
        assert_eq!(found.position, Some([0.5, 1.0, 0.0, 1.0]));
        assert_eq!(found.attributes, [(NORMAL, [0.0, 0.0, 1.0, 1.0])]);
    }

    #[test]
    fn the_widest_texture_coordinates_win() {
        let mut eval = Eval::default();
        assert_eq!(evaluate_1(&eval, 0.0), Evaluated::default());
        eval.map1_enabled = [true; 9];
        let order: Vec<_> =
            evaluate_1(&eval, 0.0).attributes.iter().map(|(which, _)| *which).collect();
        assert_eq!(order, [COLOR, INDEX, NORMAL, TEX]);
        assert_eq!(attribute_maps(&eval.map1_enabled).last(), Some((TEXTURE_COORD_1 + 3, TEX)));
    }
}
