//! The surface at eight points: which corners each point lies between, and with which weights.
//!
//! Values that are the same all over a facet are in its [`Record`], see [`super::facets`]; here
//! each point weighs the corners.

use super::slots::Slots;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x4, F32x8, Floats, LANES, Lanes, Simd, V3};

/// Numbers of a facet, in view space: `c a b` of the three corners' weights, anchor `x y`, facet
/// normal, three positions, three normals.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Record(pub [f32; 32]);

/// A number in each lane.
pub(crate) type F<S> = F32x8<S>;

/// Loads a constant.
#[inline(always)]
pub(crate) fn constant<S: Simd>(simd: S, value: f32) -> F<S> {
    every(simd, value)
}

/// [`constant`] for as many lanes as there are.
#[inline(always)]
pub(super) fn every<S: Simd, V: Floats<S>>(simd: S, value: f32) -> V {
    <V as SimdBase<S>>::splat(simd, value)
}

/// Gathers `C` values with `N` components, at most four, for each lane: `[value][component]`.
/// `value` gives a lane's by number. Each is one load, and they are transposed in registers:
/// numbers that are put side by side in memory one by one are slow to load together.
#[inline(always)]
pub(crate) fn gather<S: Simd, const N: usize, const C: usize>(
    simd: S,
    value: impl Fn(usize, usize) -> [f32; N],
) -> [[F<S>; N]; C] {
    let mut gathered = [[constant(simd, 0.0); N]; C];
    for c in 0..C {
        let columns = lanes::columns_of_rows(
            simd,
            #[inline(always)]
            |lane| {
                let mut row = [0.0f32; 4];
                row[..N].copy_from_slice(&value(lane, c));
                bytemuck::cast(row)
            },
        );
        for k in 0..N {
            gathered[c][k] = columns[k].bitcast();
        }
    }
    gathered
}

/// `Σ weight * value` over the three corners.
#[inline(always)]
pub(crate) fn blend<T: Lanes>(weights: &[T; 3], values: [T; 3]) -> T {
    weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]
}

/// `Σ weight * vector` over the three corners.
#[inline(always)]
pub(crate) fn blend3<T: Lanes>(weights: &[T; 3], v: &[V3<T>; 3]) -> V3<T> {
    V3::new(
        blend(weights, [v[0].x, v[1].x, v[2].x]),
        blend(weights, [v[0].y, v[1].y, v[2].y]),
        blend(weights, [v[0].z, v[1].z, v[2].z]),
    )
}

/// Where a surface is, and how it is turned: a point in each lane.
pub(crate) struct Placed<T> {
    /// View space.
    pub position: V3<T>,
    /// Unit shading normal, view space.
    pub normal: V3<T>,
}

impl<T: Lanes> Placed<T> {
    /// At a surface's points, with the normal between the corners'.
    #[inline(always)]
    pub(crate) fn new(surface: &Surface<T>) -> Self {
        Self { position: surface.position(), normal: surface.interpolated_normal() }
    }
}

/// The corners of each lane's facet, and the point's weights.
pub(crate) struct Surface<T> {
    /// Positions, view space.
    pub positions: [V3<T>; 3],
    /// Shading normals at the corners, view space, any length, turned to the viewer's side where
    /// both sides are seen.
    pub normals: [V3<T>; 3],
    /// Unit normal of the facet, view space, turned likewise.
    pub facet_normal: V3<T>,
    /// Barycentric coordinates of the point, not negative, sum 1: interpolated values have these
    /// weights of the corners.
    pub weights: [T; 3],
    /// The weights are linear on the screen, and thus not those of the place, see
    /// [`Self::place_weights`].
    pub screen_linear: bool,
    edges: [Edge<T>; 3],
    /// Barycentric coordinates before they were scaled to the sum 1.
    values: [T; 3],
}

/// The slope of an unscaled barycentric coordinate `c + a x + b y`.
#[derive(Clone, Copy)]
struct Edge<T> {
    a: T,
    b: T,
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

/// Scales numbers to a sum of 1; a third each where the sum is 0.
#[inline(always)]
fn normalized<T: Lanes>(e: [T; 3]) -> [T; 3] {
    let sum = e[0] + e[1] + e[2];
    let usable = sum.splat(0.0).lt(sum.abs());
    let (inverse, third) = (sum.splat(1.0) / sum, sum.splat(1.0 / 3.0));
    [
        T::select(usable, e[0] * inverse, third),
        T::select(usable, e[1] * inverse, third),
        T::select(usable, e[2] * inverse, third),
    ]
}

/// Builds the surface under each lane's point.
pub(crate) fn surface<S: Simd>(simd: S, records: &[Record], slots: &Slots) -> Surface<F<S>> {
    simd.vectorize(
        #[inline(always)]
        || surfaces(simd, records, [slots; 2]),
    )
}

/// Columns `at..at + 4` of eight rows, one row a lane.
#[inline(always)]
fn columns<S: Simd>(simd: S, rows: &[&Record; LANES], at: usize) -> [F<S>; 4] {
    let half = lanes::inlined(
        #[inline(always)]
        |first: usize| {
            let row = lanes::inlined(
                #[inline(always)]
                |i: usize| F32x4::from_slice(simd, &rows[first + i].0[at..at + 4]),
            );
            let (even_low, even_high) =
                (simd.zip_low_f32x4(row(0), row(2)), simd.zip_high_f32x4(row(0), row(2)));
            let (odd_low, odd_high) =
                (simd.zip_low_f32x4(row(1), row(3)), simd.zip_high_f32x4(row(1), row(3)));
            [
                simd.zip_low_f32x4(even_low, odd_low),
                simd.zip_high_f32x4(even_low, odd_low),
                simd.zip_low_f32x4(even_high, odd_high),
                simd.zip_high_f32x4(even_high, odd_high),
            ]
        },
    );
    let (low, high) = (half(0), half(4));
    [
        simd.combine_f32x4(low[0], high[0]),
        simd.combine_f32x4(low[1], high[1]),
        simd.combine_f32x4(low[2], high[2]),
        simd.combine_f32x4(low[3], high[3]),
    ]
}

/// [`columns`] for as many lanes as there are.
#[inline(always)]
fn columns_of<S: Simd, V: Floats<S>>(simd: S, rows: &[[&Record; LANES]; 2], at: usize) -> [V; 4] {
    V::by_eights(
        simd,
        [],
        #[inline(always)]
        |lane, []| columns(simd, &rows[lane / LANES], at),
    )
}

/// Slopes and values of the unscaled barycentric coordinates of each lane's point, and the number
/// that comes after them in the records.
#[inline(always)]
fn weighed<S: Simd, V: Floats<S>>(
    simd: S,
    rows: &[[&Record; LANES]; 2],
    slots: [&Slots; 2],
) -> ([Edge<V>; 3], [V; 3], V) {
    let ([c0, a0, b0, c1], [a1, b1, c2, a2]): ([V; 4], [V; 4]) =
        (columns_of(simd, rows, 0), columns_of(simd, rows, 4));
    let [b2, x0, y0, next]: [V; 4] = columns_of(simd, rows, 8);
    let place = V::by_eights(
        simd,
        [],
        #[inline(always)]
        |lane, []| {
            let Slots { x, y, .. } = slots[lane / LANES];
            [F32x8::from_slice(simd, x), F32x8::from_slice(simd, y)]
        },
    );
    let (x, y) = (place[0] - x0, place[1] - y0);
    let edges = [Edge { a: a0, b: b0 }, Edge { a: a1, b: b1 }, Edge { a: a2, b: b2 }];
    (edges, [c0 + a0 * x + b0 * y, c1 + a1 * x + b1 * y, c2 + a2 * x + b2 * y], next)
}

/// Barycentric coordinates. Snapping may put a sample a hair outside the facet: stay on it.
#[inline(always)]
fn on_facet<T: Lanes>(values: [T; 3]) -> [T; 3] {
    let w = normalized(values);
    normalized([w[0].positive(), w[1].positive(), w[2].positive()])
}

#[inline(always)]
fn rows<'a>(records: &'a [Record], slots: &Slots) -> [&'a Record; LANES] {
    let r = &slots.record;
    let row = lanes::inlined(
        #[inline(always)]
        |i: usize| &records[r[i] as usize],
    );
    [row(0), row(1), row(2), row(3), row(4), row(5), row(6), row(7)]
}

/// [`Surface::weights`] alone.
#[inline(always)]
pub(super) fn point_weights<S: Simd>(simd: S, records: &[Record], slots: &Slots) -> [F<S>; 3] {
    let rows = rows(records, slots);
    let (_, values, _) = weighed(simd, &[rows; 2], [slots; 2]);
    on_facet(values)
}

/// [`surface`] under eight points and eight more, or the first eight alone.
#[inline(always)]
pub(super) fn surfaces<S: Simd, V: Floats<S>>(
    simd: S,
    records: &[Record],
    slots: [&Slots; 2],
) -> Surface<V> {
    let rows = [rows(records, slots[0]), rows(records, slots[1])];
    let q = lanes::inlined(
        #[inline(always)]
        |i: usize| columns_of::<S, V>(simd, &rows, 4 * i),
    );
    let (edges, values, nx) = weighed(simd, &rows, slots);
    let [ny, nz, p0x, p0y] = q(3);
    let ([p0z, p1x, p1y, p1z], [p2x, p2y, p2z, n0x]) = (q(4), q(5));
    let ([n0y, n0z, n1x, n1y], [n1z, n2x, n2y, n2z]) = (q(6), q(7));
    Surface {
        positions: [V3::new(p0x, p0y, p0z), V3::new(p1x, p1y, p1z), V3::new(p2x, p2y, p2z)],
        normals: [V3::new(n0x, n0y, n0z), V3::new(n1x, n1y, n1z), V3::new(n2x, n2y, n2z)],
        facet_normal: V3::new(nx, ny, nz),
        weights: on_facet(values),
        screen_linear: false,
        edges,
        values,
    }
}

impl<T: Lanes> Surface<T> {
    /// Weights of the corners in the place of the point. Values interpolated linearly on the
    /// screen shows a defect; the place, with the ways to lights and shadows, is the real one.
    #[inline(always)]
    pub(crate) fn place_weights(&self) -> [T; 3] {
        if !self.screen_linear {
            return self.weights;
        }
        let ([w0, w1, w2], [a, b, c]) = (self.weights, self.positions.map(|p| -p.z));
        // See `super::facets`: where a corner is not before the eye, weights are not linear.
        let before = a.splat(0.0).lt(a.min(b).min(c));
        let of_place = normalized([w0 / a, w1 / b, w2 / c]);
        [
            T::select(before, of_place[0], w0),
            T::select(before, of_place[1], w1),
            T::select(before, of_place[2], w2),
        ]
    }

    /// The point, view space.
    #[inline(always)]
    pub(crate) fn position(&self) -> V3<T> {
        blend3(&self.place_weights(), &self.positions)
    }

    /// The unit normal between the corners'.
    #[inline(always)]
    pub(crate) fn interpolated_normal(&self) -> V3<T> {
        let n = blend3(&self.weights, &self.normals).normalize();
        // Opposite corner normals can cancel out: use the facet's.
        let length2 = n.dot(n);
        let usable = (length2 * 0.0).lt(length2);
        V3::select(usable, n, self.facet_normal)
    }

    /// Barycentric coordinates one pixel to the right and one pixel down, for texture derivatives;
    /// they may leave `0..=1`.
    #[inline(always)]
    pub(crate) fn neighbours(&self) -> [[T; 3]; 2] {
        let ([v0, v1, v2], [e0, e1, e2]) = (self.values, self.edges);
        [
            normalized([v0 + e0.a, v1 + e1.a, v2 + e2.a]),
            normalized([v0 + e0.b, v1 + e1.b, v2 + e2.b]),
        ]
    }
}
