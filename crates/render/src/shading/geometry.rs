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

/// Gathers three values with `N` components for each lane: `[corner][component]`.
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
    let mut lanes = [[constant(simd, 0.0); N]; 3];
    for c in 0..3 {
        for k in 0..N {
            lanes[c][k] = F32x8::from_slice(simd, &soa[c][k]);
        }
    }
    lanes
}

/// `Σ weight * value` over the three corners.
#[inline(always)]
pub(crate) fn blend<S: Simd>(weights: &[F<S>; 3], values: [F<S>; 3]) -> F<S> {
    weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]
}

/// `Σ weight * vector` over the three corners.
#[inline(always)]
pub(crate) fn blend3<S: Simd>(weights: &[F<S>; 3], v: &[V3<F<S>>; 3]) -> V3<F<S>> {
    V3::new(
        blend(weights, [v[0].x, v[1].x, v[2].x]),
        blend(weights, [v[0].y, v[1].y, v[2].y]),
        blend(weights, [v[0].z, v[1].z, v[2].z]),
    )
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
    screen: [V3<F<S>>; 3],
    place: (F<S>, F<S>),
    interpolation: Interpolation,
}

/// What a frame says about points and viewer.
#[derive(Clone, Copy)]
pub(crate) struct Viewing {
    pub interpolation: Interpolation,
    pub perspective: bool,
    /// The material shows both sides.
    pub double_sided: bool,
}

/// A row of an affine map times `(p, 1)`.
#[inline(always)]
fn affine_row<S: Simd>(m: &[f32; 4], p: &[F<S>; 3]) -> F<S> {
    p[0] * m[0] + p[1] * m[1] + p[2] * m[2] + m[3]
}

/// An affine map of a point.
#[inline(always)]
pub(crate) fn affine<S: Simd>(m: &[[f32; 4]; 3], p: &[F<S>; 3]) -> V3<F<S>> {
    V3::new(affine_row(&m[0], p), affine_row(&m[1], p), affine_row(&m[2], p))
}

/// A linear map of a vector.
#[inline(always)]
pub(crate) fn linear<S: Simd>(m: &[[f32; 3]; 3], p: &[F<S>; 3]) -> V3<F<S>> {
    V3::new(
        p[0] * m[0][0] + p[1] * m[0][1] + p[2] * m[0][2],
        p[0] * m[1][0] + p[1] * m[1][1] + p[2] * m[1][2],
        p[0] * m[2][0] + p[1] * m[2][1] + p[2] * m[2][2],
    )
}

/// The edge functions of corners `(X, Y, W)` at a point of the screen.
#[inline(always)]
fn edges_at<S: Simd>(screen: &[V3<F<S>>; 3], x: F<S>, y: F<S>, interpolation: Interpolation) -> [F<S>; 3] {
    let [ax, bx, cx] = [screen[0].x - x * screen[0].z, screen[1].x - x * screen[1].z, screen[2].x - x * screen[2].z];
    let [ay, by, cy] = [screen[0].y - y * screen[0].z, screen[1].y - y * screen[1].z, screen[2].y - y * screen[2].z];
    let e = [bx * cy - cx * by, cx * ay - ax * cy, ax * by - bx * ay];
    match interpolation {
        Interpolation::Perspective => e,
        Interpolation::Linear => [e[0] * screen[0].z, e[1] * screen[1].z, e[2] * screen[2].z],
    }
}

/// Scales numbers to a sum of 1; a third each where the sum is 0.
#[inline(always)]
fn normalized<S: Simd>(e: [F<S>; 3]) -> [F<S>; 3] {
    let sum = e[0] + e[1] + e[2];
    let (zero, one) = (lanes::Lanes::splat(sum, 0.0), lanes::Lanes::splat(sum, 1.0));
    let usable = lanes::Lanes::lt(zero, lanes::Lanes::abs(sum));
    let inverse = one / sum;
    let third = lanes::Lanes::splat(sum, 1.0 / 3.0);
    [usable.select(e[0] * inverse, third), usable.select(e[1] * inverse, third), usable.select(e[2] * inverse, third)]
}

/// Builds the surface under each lane's point.
pub(crate) fn surface<S: Simd>(
    simd: S,
    mesh: &Mesh,
    instance: &InstanceConstants,
    slots: &Slots,
    viewing: Viewing,
) -> Surface<S> {
    simd.vectorize(
        #[inline(always)]
        || surface_inlined(simd, mesh, instance, slots, viewing),
    )
}

#[inline(always)]
fn surface_inlined<S: Simd>(
    simd: S,
    mesh: &Mesh,
    instance: &InstanceConstants,
    slots: &Slots,
    viewing: Viewing,
) -> Surface<S> {
    let model = gather(
        simd,
        #[inline(always)]
        |lane| {
            let [a, b, c] = mesh.triangles[slots.triangle[lane] as usize];
            [mesh.positions[a as usize], mesh.positions[b as usize], mesh.positions[c as usize]]
        },
    );

    // Weigh the corners.
    let to_screen = &instance.screen_from_model;
    let screen = [affine(to_screen, &model[0]), affine(to_screen, &model[1]), affine(to_screen, &model[2])];
    let (x, y) = (F32x8::from_slice(simd, &slots.x), F32x8::from_slice(simd, &slots.y));
    let w = normalized(edges_at(&screen, x, y, viewing.interpolation));
    // Snapping may put a sample a hair outside the facet: stay on it.
    let zero = constant(simd, 0.0);
    let weights =
        normalized([lanes::Lanes::max(w[0], zero), lanes::Lanes::max(w[1], zero), lanes::Lanes::max(w[2], zero)]);

    // Bring corners and normals to view space.
    let to_view = &instance.view_from_model;
    let positions = [affine(to_view, &model[0]), affine(to_view, &model[1]), affine(to_view, &model[2])];
    let geometric = (positions[1] - positions[0]).cross(positions[2] - positions[0]).normalize();
    let geometric = if instance.mirrored { -geometric } else { geometric };
    let mut normals = [geometric; 3];
    if let Some(attribute) = &mesh.normals {
        let corners = attribute.corners.as_deref().unwrap_or(&mesh.triangles);
        let values = gather(
            simd,
            #[inline(always)]
            |lane| {
                let [a, b, c] = corners[slots.triangle[lane] as usize];
                [attribute.values[a as usize], attribute.values[b as usize], attribute.values[c as usize]]
            },
        );
        for c in 0..3 {
            let n = linear(&instance.view_from_model_normal, &values[c]).normalize();
            // A zero normal in the file falls back to the facet's.
            normals[c] = V3::select(lanes::Lanes::lt(zero, n.dot(n)), n, geometric);
        }
    }

    // Where both sides are seen, turn normals to the viewer's side of the facet.
    let mut facet_normal = geometric;
    if instance.two_sided || viewing.double_sided {
        let towards = if viewing.perspective { geometric.dot(-blend3(&weights, &positions)) } else { geometric.z };
        facet_normal = V3::select(lanes::Lanes::lt(towards, zero), -geometric, geometric);
        // A normal in the facet's plane, but for rounding, is on neither side: it stays as it is.
        let hair = constant(simd, -1e-4);
        for c in 0..3 {
            let behind = lanes::Lanes::lt(normals[c].dot(facet_normal), hair);
            normals[c] = V3::select(behind, -normals[c], normals[c]);
        }
    }
    Surface { screen, place: (x, y), interpolation: viewing.interpolation, positions, normals, facet_normal, weights }
}

impl<S: Simd> Surface<S> {
    /// Barycentric coordinates one pixel to the right and one pixel down, for texture derivatives; they may leave
    /// `0..=1`.
    #[inline(always)]
    pub(crate) fn neighbours(&self) -> [[F<S>; 3]; 2] {
        let (x, y) = self.place;
        [
            normalized(edges_at(&self.screen, x + 1.0, y, self.interpolation)),
            normalized(edges_at(&self.screen, x, y + 1.0, self.interpolation)),
        ]
    }
}
