//! What rounding may put wrong: how far a point is lifted off its facet, and when a facet faces a
//! light at all.
//!
//! With `u = 2^-24` and no coordinate larger than `e`, a corner relative to the origin is wrong by
//! at most `u (|p| + 2 e)`; shearing and the hit's weighted mean each add a few times as much.
//! `16 u (|p| + e)` covers them.

use vitral_light::DIRECTION_ROUNDING;
use vitral_math::{DVec3, DVec4};

/// Rounding of one operation.
const UNIT: f64 = 1.0 / (1u32 << 24) as f64;

/// How far above its facet a ray must start at this place of a scene of half-width `extent`; see
/// the module.
pub(crate) fn clearance(position: DVec3, extent: f64) -> f64 {
    16.0 * UNIT * (position.abs().max_element() + extent)
}

/// What the product of a facet's unit normal and the way from a place of it to a light
/// (homogeneous) exceeds where the facet faces the light: less is rounding, and a light in the
/// facet's plane shines past it.
#[inline(always)]
pub(crate) fn horizon(position: DVec3, light: DVec4) -> f64 {
    let sum = |v: DVec3| v.x.abs() + v.y.abs() + v.z.abs();
    let at = sum(light.truncate());
    f64::from(DIRECTION_ROUNDING) * (at + light.w * (2.0 * sum(position) + at))
}
