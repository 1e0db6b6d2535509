//! Phong shading: the normal is interpolated and every pixel is illuminated by itself. The costly
//! reference.
//!
//! Input: corners and weights of a point, view space. Output: reflected light at the point.
//! Source: [Phong 1975].

use super::geometry::{Placed, Surface};
use super::lighting::{Coefficients, Lighting};
use vitral_light::Reflected;
use vitral_math::lanes::{F32x8, Simd, V3};

/// Illuminates each point with its interpolated normal; `normal` replaces it (normal maps).
#[inline(always)]
pub(crate) fn shade<S: Simd>(
    simd: S,
    surface: &Surface<F32x8<S>>,
    normal: Option<V3<F32x8<S>>>,
    lighting: &Lighting<'_>,
    coefficients: &Coefficients<F32x8<S>>,
) -> Reflected<F32x8<S>> {
    let Placed { position, normal } = placed(surface, normal);
    lighting.reflect(simd, &position, &normal, coefficients)
}

/// Where each point is, and its normal.
#[inline(always)]
pub(super) fn placed<S: Simd>(
    surface: &Surface<F32x8<S>>,
    normal: Option<V3<F32x8<S>>>,
) -> Placed<F32x8<S>> {
    Placed {
        position: surface.position(),
        normal: normal.unwrap_or_else(|| surface.interpolated_normal()),
    }
}
