//! Surfaces that rays meet, in the form in which the eye's points are shaded.
//!
//! A point of the picture knows its place on the screen; a hit knows the weights of the corners of
//! its facet. Its record says so: weights that hold at the place `(0, 0)`, and change from there as
//! the footprint of the pixel's ray does. So hits go through the same formulas, textures and levels
//! of detail as what the eye sees.
//!
//! In:   hits on one object. Out: a record for each of them.
//! Source: the footprint after [Amanatides 1984], a cone round the ray.

use super::facets::{model_corners, write_records};
use super::geometry::{F, Record, constant};
use super::slots::Slots;
use super::subject::Subject;
use crate::shadow::SurfacePoint;
use vitral_math::lanes::prelude::SimdBase;
use vitral_math::lanes::{F32x8, LANES, Simd, V3};

/// A place where a ray meets a facet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// Weights of the facet's corners, and how they change over the pixel's footprint along two
    /// directions.
    pub weights: [[f32; 3]; 3],
    /// Where the ray comes from, view space.
    pub origin: [f32; 3],
    /// The place in the world.
    pub place: SurfacePoint,
    /// Row of the picture whose background the ray sees; `None` if it took a turn since it left the
    /// eye.
    pub row: Option<u32>,
}

/// What eight hits have in place of a common eye.
pub(crate) struct Along {
    /// Where the rays come from, view space.
    pub origins: [[f32; LANES]; 3],
    /// Where they hit.
    pub places: [SurfacePoint; LANES],
    /// Rows of the picture, for rays that took no turn.
    pub rows: [Option<u32>; LANES],
}

impl Along {
    /// Of up to eight hits; the last is repeated.
    fn new(hits: &[Hit]) -> Self {
        let hit = |lane: usize| &hits[lane.min(hits.len() - 1)];
        let origins = [0, 1, 2].map(|k| std::array::from_fn(|lane| hit(lane).origin[k]));
        let rows = std::array::from_fn(|lane| hit(lane).row);
        Self { origins, places: std::array::from_fn(|lane| hit(lane).place), rows }
    }

    /// 1 for rays that took no turn, else 0.
    #[inline(always)]
    pub(crate) fn straight<S: Simd>(&self, simd: S) -> F<S> {
        F32x8::from_slice(simd, &self.rows.map(|row| f32::from(u8::from(row.is_some()))))
    }

    /// Where the rays come from, view space.
    #[inline(always)]
    pub(crate) fn origin<S: Simd>(&self, simd: S) -> V3<F<S>> {
        let [x, y, z] = &self.origins;
        V3::new(F32x8::from_slice(simd, x), F32x8::from_slice(simd, y), F32x8::from_slice(simd, z))
    }
}

/// Slots, records and rays of up to eight hits on the object.
#[inline(always)]
pub(crate) fn prepare<S: Simd>(
    simd: S,
    subject: &Subject<'_>,
    hits: &[Hit],
    records: &mut [Record; LANES],
) -> (Slots, Along) {
    // Spread the hits over the lanes; missing ones repeat the last.
    let along = Along::new(hits);
    let mut slots =
        Slots { triangle: [0; LANES], record: [0; LANES], x: [0.0; LANES], y: [0.0; LANES] };
    let mut weights = [[[0.0; LANES]; 3]; 3];
    for lane in 0..LANES {
        let hit = &hits[lane.min(hits.len() - 1)];
        slots.triangle[lane] = hit.place.facet - subject.first_facet;
        slots.record[lane] = lane as u32;
        for corner in 0..3 {
            for k in 0..3 {
                weights[corner][k][lane] = hit.weights[corner][k];
            }
        }
    }
    let zero = constant(simd, 0.0);
    let mut lanes = [[zero; 3]; 3];
    for corner in 0..3 {
        for k in 0..3 {
            lanes[corner][k] = F32x8::from_slice(simd, &weights[corner][k]);
        }
    }

    // Write the facets' records.
    let model = model_corners(simd, &slots.triangle, subject.mesh);
    write_records(
        simd,
        &slots.triangle,
        subject,
        &model,
        Some(along.origin(simd)),
        lanes,
        [zero; 2],
        records,
    );
    (slots, along)
}
