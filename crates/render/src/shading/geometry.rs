//! The surface at eight points: which corners each point lies between, with which weights, and in which space.
//!
//! Weights come from the facet's corners in homogeneous screen coordinates `(X, Y, W)` taken relative to the point:
//! with `e0 = X1 Y2 - X2 Y1` and so on, `e0 : e1 : e2` are the point's barycentric coordinates on the surface in
//! space (perspective-correct), for corners behind the eye too. Divided by the corners' `W` products they would be
//! those on the screen; that is the classical defect, kept for comparison.
//!
//! Source: [Heckbert & Moreton 1991], [Olano & Greer 1997].

use super::frame_constants::InstanceConstants;
use crate::Interpolation;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Simd, V3};
use vitral_scene::Mesh;

/// Up to eight points of one object and material.
#[derive(Clone, Copy)]
pub(crate) struct Slots {
    /// Triangle of each point within its mesh; unused lanes repeat lane 0.
    pub triangle: [u32; LANES],
    /// Places in pixels.
    pub x: [f32; LANES],
    /// Places in pixels, downwards.
    pub y: [f32; LANES],
}

/// A number in each lane.
pub(crate) type F<S> = F32x8<S>;

/// Loads a constant.
#[inline(always)]
pub(crate) fn constant<S: Simd>(simd: S, value: f32) -> F<S> {
    <F<S> as SimdBase<S>>::splat(simd, value)
}

/// Gathers three values with `N` components for each lane.
#[inline(always)]
pub(crate) fn gather<S: Simd, const N: usize>(simd: S, corners: impl Fn(usize) -> [[f32; N]; 3]) -> [[F<S>; N]; 3] {
    let mut soa = [[[0.0f32; LANES]; N]; 3];
    for lane in 0..LANES {
        let values = corners(lane);
        for c in 0..3 {
            for k in 0..N {
                soa[c][k][lane] = values[c][k];
            }
        }
    }
    soa.map(|c| c.map(|k| F32x8::from_slice(simd, &k)))
}

/// `Σ weight * value` over the three corners.
#[inline(always)]
pub(crate) fn blend<S: Simd>(weights: &[F<S>; 3], values: [F<S>; 3]) -> F<S> {
    weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]
}

/// `Σ weight * vector` over the three corners.
#[inline(always)]
pub(crate) fn blend3<S: Simd>(weights: &[F<S>; 3], v: &[V3<F<S>>; 3]) -> V3<F<S>> {
    let component = |f: fn(&V3<F<S>>) -> F<S>| blend(weights, [f(&v[0]), f(&v[1]), f(&v[2])]);
    V3::new(component(|v| v.x), component(|v| v.y), component(|v| v.z))
}

/// The corners of each lane's facet, and the point's weights.
pub(crate) struct Surface<S: Simd> {
    /// Positions, view space.
    pub positions: [V3<F<S>>; 3],
    /// Shading normals at the corners, view space, any length, turned to the viewer's side where both sides are seen.
    pub normals: [V3<F<S>>; 3],
    /// Unit normal of the facet, view space, turned likewise.
    pub facet_normal: V3<F<S>>,
    /// Barycentric coordinates of the point, not negative, sum 1.
    pub weights: [F<S>; 3],
    /// The same one pixel to the right and one pixel down (may leave `0..=1`), for texture derivatives.
    pub weights_right: [F<S>; 3],
    /// See `weights_right`.
    pub weights_down: [F<S>; 3],
}

/// What a frame says about points and viewer.
#[derive(Clone, Copy)]
pub(crate) struct Viewing {
    pub interpolation: Interpolation,
    pub perspective: bool,
    /// The material shows both sides.
    pub double_sided: bool,
}

/// Builds the surface under each lane's point.
#[inline(always)]
pub(crate) fn surface<S: Simd>(
    simd: S,
    mesh: &Mesh,
    instance: &InstanceConstants,
    slots: &Slots,
    viewing: Viewing,
) -> Surface<S> {
    let model = gather(simd, |lane| {
        mesh.triangles[slots.triangle[lane] as usize].map(|i| mesh.positions[i as usize])
    });
    let affine = |m: &[[f32; 4]; 3], p: &[F<S>; 3]| {
        let row = |r: usize| p[0] * m[r][0] + p[1] * m[r][1] + p[2] * m[r][2] + m[r][3];
        V3::new(row(0), row(1), row(2))
    };
    let linear = |m: &[[f32; 3]; 3], p: &[F<S>; 3]| {
        let row = |r: usize| p[0] * m[r][0] + p[1] * m[r][1] + p[2] * m[r][2];
        V3::new(row(0), row(1), row(2))
    };

    // Weigh the corners.
    let screen: [V3<F<S>>; 3] = std::array::from_fn(|c| affine(&instance.screen_from_model, &model[c]));
    let (x, y) = (F32x8::from_slice(simd, &slots.x), F32x8::from_slice(simd, &slots.y));
    let edges_at = |x: F<S>, y: F<S>| {
        let relative: [(F<S>, F<S>); 3] =
            std::array::from_fn(|c| (screen[c].x - x * screen[c].z, screen[c].y - y * screen[c].z));
        let cross = |a: usize, b: usize| relative[a].0 * relative[b].1 - relative[b].0 * relative[a].1;
        let mut e = [cross(1, 2), cross(2, 0), cross(0, 1)];
        if viewing.interpolation == Interpolation::Linear {
            for c in 0..3 {
                e[c] = e[c] * screen[c].z;
            }
        }
        e
    };
    let (zero, one) = (constant(simd, 0.0), constant(simd, 1.0));
    let normalized = |e: [F<S>; 3]| {
        let sum = e[0] + e[1] + e[2];
        let usable = lanes::Lanes::lt(zero, lanes::Lanes::abs(sum));
        let inverse = usable.select(one / sum, zero);
        let third = constant(simd, 1.0 / 3.0);
        e.map(|e| usable.select(e * inverse, third))
    };
    let weights = normalized(edges_at(x, y));
    // Snapping may put a sample a hair outside the facet: stay on it.
    let weights = normalized(weights.map(|w| lanes::Lanes::positive(w)));
    let weights_right = normalized(edges_at(x + 1.0, y));
    let weights_down = normalized(edges_at(x, y + 1.0));

    // Bring corners and normals to view space.
    let positions: [V3<F<S>>; 3] = std::array::from_fn(|c| affine(&instance.view_from_model, &model[c]));
    let geometric = (positions[1] - positions[0]).cross(positions[2] - positions[0]).normalize();
    let geometric = if instance.mirrored { -geometric } else { geometric };
    let mut normals = match &mesh.normals {
        Some(attribute) => {
            let values = gather(simd, |lane| attribute.at(slots.triangle[lane] as usize, &mesh.triangles));
            std::array::from_fn(|c| linear(&instance.view_from_model_normal, &values[c]).normalize())
        }
        None => [geometric; 3],
    };
    // A zero normal in the file falls back to the facet's.
    for n in &mut normals {
        let usable = lanes::Lanes::lt(zero, n.dot(*n));
        *n = V3::select(usable, *n, geometric);
    }

    // Where both sides are seen, turn normals to the viewer's side of the facet.
    let mut facet_normal = geometric;
    if instance.two_sided || viewing.double_sided {
        let point = blend3(&weights, &positions);
        let towards = if viewing.perspective { geometric.dot(-point) } else { geometric.z };
        let away = lanes::Lanes::lt(towards, zero);
        facet_normal = V3::select(away, -geometric, geometric);
        for n in &mut normals {
            let behind = lanes::Lanes::lt(n.dot(facet_normal), zero);
            *n = V3::select(behind, -*n, *n);
        }
    }
    Surface { positions, normals, facet_normal, weights, weights_right, weights_down }
}
