//! A facet made ready to be interpolated: the planes of its barycentric coordinates, and its vertex
//! records as differences between corners.

use super::Weights;
use crate::forward::assemble::Facet;
use crate::forward::wide::{bits_of, every, splat};
use crate::{SUBPIXEL, Setup};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Floats, LANES, Simd};

/// Most numbers in a record: `1 / w`, primary and secondary colours of both sides, fog, eight
/// units' coordinates, the grid's.
pub(super) const MAX_NUMBERS: usize = 64;

/// A facet's records as they are interpolated: number `k` is `base[k] + b1 * d1[k] + b2 * d2[k]`.
pub(super) struct Differences {
    /// Numbers of corner 0.
    pub(super) base: [f32; MAX_NUMBERS],
    /// What corner 1 has more.
    pub(super) d1: [f32; MAX_NUMBERS],
    /// What corner 2 has more.
    pub(super) d2: [f32; MAX_NUMBERS],
    /// Bit `k`: number `k` is not the same at all corners.
    pub(super) varies: u64,
}

impl Default for Differences {
    fn default() -> Self {
        Self { base: [0.0; MAX_NUMBERS], d1: [0.0; MAX_NUMBERS], d2: [0.0; MAX_NUMBERS], varies: 0 }
    }
}

impl Differences {
    /// Takes up records of `stride` numbers that begin at `corners`.
    #[inline(always)]
    pub(super) fn prepare<S: Simd>(
        &mut self,
        simd: S,
        records: &[f32],
        corners: [usize; 3],
        stride: usize,
    ) {
        self.varies = 0;
        let mut from = 0;
        while from < stride.min(MAX_NUMBERS) {
            let a = eight(simd, records, corners[0] + from);
            let (b, c) =
                (eight(simd, records, corners[1] + from), eight(simd, records, corners[2] + from));
            let (d1, d2) = (b - a, c - a);
            let zero = splat(simd, 0.0);
            let same = bits_of(d1.simd_eq(zero) & d2.simd_eq(zero));
            self.varies |= u64::from(!same & 0xff) << from;
            a.store_slice(&mut self.base[from..from + LANES]);
            d1.store_slice(&mut self.d1[from..from + LANES]);
            d2.store_slice(&mut self.d2[from..from + LANES]);
            from += LANES;
        }
    }
}

/// Eight numbers from `at` on, 0 beyond the end.
#[inline(always)]
fn eight<S: Simd>(simd: S, records: &[f32], at: usize) -> F32x8<S> {
    match records.get(at..at + LANES) {
        Some(eight) => F32x8::from_slice(simd, eight),
        None => F32x8::from_slice(simd, &last_of(records, at)),
    }
}

#[cold]
fn last_of(records: &[f32], at: usize) -> [f32; LANES] {
    std::array::from_fn(|k| records.get(at + k).copied().unwrap_or(0.0))
}

/// `1 / w` of a facet's corners differs much if it differs by more than this factor.
pub(super) const MOST_W: f32 = 8.0;

/// A facet made ready to be interpolated. With `l` a corner's screen-space barycentric coordinate,
/// `l1 / w1`, `l2 / w2` and `Σ l / w` are planes over the pixels: their value at `origin`, their
/// change with x, with y. The origin is corner 0, so that what lies on a grid of pixels stays
/// exact. But where `1 / w` differs much, corners lie far away or near the eye: then it is the
/// tile's, and the planes' values there are found in double precision.
#[derive(Default)]
pub(super) struct Interpolation {
    /// Pixel position of the planes' values, in the target.
    pub(super) origin: [f32; 2],
    /// The plane of `l1 / w1`: value at the origin, change with x, change with y.
    pub(super) first: [f32; 3],
    /// The plane of `l2 / w2`, likewise.
    pub(super) second: [f32; 3],
    /// The plane of `Σ l / w`, likewise.
    pub(super) sum: [f32; 3],
    /// `w` of all corners, if it is the same.
    pub(super) flat_w: Option<f32>,
    /// Unit edge normals and offsets of the triangle, for smooth polygons: distance = a x + b y +
    /// c.
    pub(super) edges: [[f32; 3]; 3],
}

impl Interpolation {
    /// Makes it ready for a setup, with corner records by `facet.corners`; places are in pixels of
    /// the target. Fields are set one by one: a whole that was put together elsewhere would be read
    /// again before its parts are in the cache.
    #[inline(always)]
    pub(super) fn prepare(
        &mut self,
        setup: &Setup,
        facet: &Facet,
        records: &[f32],
        tile: [f32; 2],
    ) {
        let inverse_w = facet.corners.map(|slot| records[slot as usize]);
        let least = inverse_w[0].min(inverse_w[1]).min(inverse_w[2]);
        let steep = inverse_w.iter().any(|w| *w > MOST_W * least);
        if steep || !setup.is_small() {
            self.far(setup, inverse_w, steep, tile);
        } else {
            self.near(setup, inverse_w);
        }
    }

    /// For facets whose corners lie so near each other that twice the area is a number of 32 bits.
    /// Planes are rounded but once: what programs lay on a grid of pixels shall stay there.
    #[inline(always)]
    fn near(&mut self, setup: &Setup, inverse_w: [f32; 3]) {
        let (dx1, dy1) = (setup.x[1] - setup.x[0], setup.y[1] - setup.y[0]);
        let (dx2, dy2) = (setup.x[2] - setup.x[0], setup.y[2] - setup.y[0]);
        // Differences are in 1/256 pixel: one factor of 256 remains.
        let inverse = f64::from(SUBPIXEL) / f64::from(dx1 * dy2 - dx2 * dy1);
        let (a, b) = ([dy2, -dx2], [-dy1, dx1]);
        let (a, b) = (a.map(|v| f64::from(v) * inverse), b.map(|v| f64::from(v) * inverse));
        let flat = inverse_w[0] == inverse_w[1] && inverse_w[1] == inverse_w[2];
        let [w0, w1, w2] = if flat { [1.0; 3] } else { inverse_w.map(f64::from) };
        let (d1, d2) = (w1 - w0, w2 - w0);
        self.origin = [setup.x[0] as f32, setup.y[0] as f32].map(|v| v / SUBPIXEL as f32);
        self.first = [0.0, (a[0] * w1) as f32, (a[1] * w1) as f32];
        self.second = [0.0, (b[0] * w2) as f32, (b[1] * w2) as f32];
        self.sum = [w0 as f32, (a[0] * d1 + b[0] * d2) as f32, (a[1] * d1 + b[1] * d2) as f32];
        self.flat_w = flat.then_some(1.0 / inverse_w[0]);
    }

    #[inline(never)]
    fn far(&mut self, setup: &Setup, inverse_w: [f32; 3], steep: bool, tile: [f32; 2]) {
        let scale = 1.0 / f64::from(SUBPIXEL);
        let origin = if steep {
            tile
        } else {
            [setup.x[0] as f32, setup.y[0] as f32].map(|v| v / SUBPIXEL as f32)
        };
        let x = |k: usize| f64::from(setup.x[k]) * scale - f64::from(origin[0]);
        let y = |k: usize| f64::from(setup.y[k]) * scale - f64::from(origin[1]);
        let ((x0, y0), (dx1, dy1), (dx2, dy2)) =
            ((x(0), y(0)), (x(1) - x(0), y(1) - y(0)), (x(2) - x(0), y(2) - y(0)));
        let inverse = 1.0 / (dx1 * dy2 - dx2 * dy1);
        let flat = inverse_w[0] == inverse_w[1] && inverse_w[1] == inverse_w[2];
        // With one w for all corners the weights themselves are planes.
        let [w0, w1, w2] = if flat { [1.0; 3] } else { inverse_w.map(f64::from) };
        let plane =
            |dx: f64, dy: f64, at: f64, w: f64| [(at - x0 * dx - y0 * dy) * w, dx * w, dy * w];
        let (a, b) = ((dy2 * inverse, -dx2 * inverse), (-dy1 * inverse, dx1 * inverse));
        let (first, second) = (plane(a.0, a.1, 0.0, w1), plane(b.0, b.1, 0.0, w2));
        let rest = plane(-a.0 - b.0, -a.1 - b.1, 1.0, w0);
        self.origin = origin;
        self.first = first.map(|v| v as f32);
        self.second = second.map(|v| v as f32);
        self.sum = [0, 1, 2].map(|k: usize| (first[k] + second[k] + rest[k]) as f32);
        self.flat_w = flat.then_some(1.0 / inverse_w[0]);
    }

    /// How the weights of corners 1 and 2 change with one pixel to the right (axis 0), or one up.
    #[inline(always)]
    pub(super) fn weight_steps<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        weights: &Weights<V>,
        axis: usize,
    ) -> [V; 2] {
        let (q1, q2): (V, V) =
            (every(simd, self.first[axis + 1]), every(simd, self.second[axis + 1]));
        if self.flat_w.is_some() {
            return [q1, q2];
        }
        // b = (l / w) / Σ, so db = (d(l / w) - b dΣ) / Σ.
        let sum = self.sum[axis + 1];
        [(q1 - weights.b1 * sum) * weights.w, (q2 - weights.b2 * sum) * weights.w]
    }

    pub(super) fn prepare_edges(&mut self, setup: &Setup) {
        let scale = 1.0 / SUBPIXEL as f32;
        for i in 0..3 {
            let j = (i + 1) % 3;
            let (dx, dy) = (
                (setup.x[j] - setup.x[i]) as f32 * scale,
                (setup.y[j] - setup.y[i]) as f32 * scale,
            );
            let length = (dx * dx + dy * dy).sqrt();
            let (a, b) = (-dy / length, dx / length);
            let (x, y) = (setup.x[i] as f32 * scale, setup.y[i] as f32 * scale);
            self.edges[i] = [a, b, -(a * x + b * y)];
        }
    }
}
