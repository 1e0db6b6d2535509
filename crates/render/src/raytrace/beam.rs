//! A beam: a ray with a square cross-section that may grow along the way.
//!
//! A ray answers "what lies under this point"; but corners on the screen are snapped, so what
//! covers a sample may miss the ray by a hair. A beam as wide as that hair meets everything that
//! can cover the sample. On each axis it fills the places
//! `origin ± width + (direction ± growth) t`, so a box and the beam share a place at `t` if two
//! straight lines lie on the right sides of the box's faces: the slabs of a ray, with one line for
//! each side.
//!
//! In:   a box, in the beam's space. Out: the smallest parameter at which they may meet.
//! Cost: six multiplications.
//! Source: slabs after [Kay & Kajiya 1986]. Departs from it by the width.

use super::Probe;
use super::intersect::Ray;
use vitral_math::Vec3;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Simd};

/// Relative error of a bound on the parameter, with room to spare.
pub(super) const ROUNDING: f32 = 1.0 / (1 << 20) as f32;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// Where its middle starts.
    pub origin: Vec3,
    /// Where its middle goes.
    pub direction: Vec3,
    /// Half its width at the start, by axis.
    pub width: Vec3,
    /// How that grows with the parameter.
    pub growth: Vec3,
    axes: [Axis; 3],
}

/// Two lines on one axis: the beam's upper side must reach the box's lower face, its lower side the
/// upper one.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// Where the upper line starts.
    upper_start: f32,
    /// Where the lower line starts.
    lower_start: f32,
    /// One over the upper line's slope.
    inverse_upper_slope: f32,
    /// One over the lower line's slope.
    inverse_lower_slope: f32,
}

impl Beam {
    /// A beam round the ray from `origin` along `direction`, with half its width and that width's
    /// growth by axis.
    pub fn new(origin: Vec3, direction: Vec3, width: Vec3, growth: Vec3) -> Self {
        let axis = |k: usize| {
            // A slope of zero is replaced by one that lets more through.
            let away = |slope: f32, tiny: f32| if slope.abs() < 1e-20 { tiny } else { slope };
            Axis {
                upper_start: origin[k] + width[k],
                lower_start: origin[k] - width[k],
                inverse_upper_slope: 1.0 / away(direction[k] + growth[k], 1e-20),
                inverse_lower_slope: 1.0 / away(direction[k] - growth[k], -1e-20),
            }
        };
        Self { origin, direction, width, growth, axes: [axis(0), axis(1), axis(2)] }
    }

    /// A beam just wide enough that rounding in a space of half-width `extent` cannot make it miss
    /// what `ray` meets.
    pub fn around(ray: &Ray, extent: f32) -> Self {
        let width = (ray.origin.abs() + extent) * ROUNDING;
        Self::new(
            ray.origin,
            ray.direction,
            width,
            ray.direction.abs() * ROUNDING + Vec3::splat(1e-30),
        )
    }
}

/// What [`Beam::around`] has on one axis for each ray of a packet, or on each axis for one ray.
pub(super) struct BeamLines<S: Simd> {
    /// Where the upper lines start.
    pub(super) upper_start: F32x8<S>,
    /// Where the lower lines start.
    pub(super) lower_start: F32x8<S>,
    /// One over the upper lines' slopes.
    pub(super) inverse_upper_slope: F32x8<S>,
    /// One over the lower lines' slopes.
    pub(super) inverse_lower_slope: F32x8<S>,
}

impl<S: Simd> BeamLines<S> {
    /// From where rays start and where they go.
    #[inline(always)]
    pub(super) fn around(simd: S, origin: F32x8<S>, direction: F32x8<S>, extent: f32) -> Self {
        let width = (lanes::Lanes::abs(origin) + extent) * ROUNDING;
        let growth = lanes::Lanes::abs(direction) * ROUNDING + 1e-30;
        let inverse = lanes::inlined(
            #[inline(always)]
            |slope: F32x8<S>, tiny: f32| {
                let flat = lanes::Lanes::lt(lanes::Lanes::abs(slope), F32x8::splat(simd, 1e-20));
                F32x8::splat(simd, 1.0) / flat.select(F32x8::splat(simd, tiny), slope)
            },
        );
        Self {
            upper_start: origin + width,
            lower_start: origin - width,
            inverse_upper_slope: inverse(direction + growth, 1e-20),
            inverse_lower_slope: inverse(direction - growth, -1e-20),
        }
    }
}

impl Probe for Beam {
    #[inline(always)]
    fn enters(&self, min: [f32; 3], max: [f32; 3]) -> Option<f32> {
        let (mut near, mut far) = (0.0f32, f32::INFINITY);
        for (k, axis) in self.axes.iter().enumerate() {
            let at_min = (min[k] - axis.upper_start) * axis.inverse_upper_slope;
            let at_max = (max[k] - axis.lower_start) * axis.inverse_lower_slope;
            if axis.inverse_upper_slope > 0.0 {
                near = near.max(at_min);
            } else {
                far = far.min(at_min);
            }
            if axis.inverse_lower_slope > 0.0 {
                far = far.min(at_max);
            } else {
                near = near.max(at_max);
            }
        }
        (near * (1.0 - ROUNDING) <= far * (1.0 + ROUNDING)).then_some(near * (1.0 - ROUNDING))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::vec3;

    #[test]
    fn a_beam_meets_what_its_width_reaches() {
        let beam = |width: f32, growth: f32| {
            Beam::new(Vec3::ZERO, Vec3::Z, Vec3::splat(width), Vec3::splat(growth))
        };
        let (min, max) = ([0.1, -1.0, 4.0], [0.5, 1.0, 5.0]);
        assert_eq!(beam(0.05, 0.0).enters(min, max), None);
        assert!((beam(0.2, 0.0).enters(min, max).unwrap() - 3.8).abs() < 1e-4);
        // Growing by 0.01 a unit, the beam never becomes wide enough; by 0.025 it does after 4
        // units.
        assert_eq!(beam(0.0, 0.01).enters(min, max), None);
        assert!((beam(0.0, 0.025).enters(min, max).unwrap() - 4.0).abs() < 1e-4);
        assert_eq!(beam(0.2, 0.1).enters([0.0, 0.0, -3.0], [1.0, 1.0, -2.0]), None, "behind");
        assert_eq!(beam(0.1, 0.0).enters([-1.0; 3], [1.0; 3]), Some(0.0), "inside");
        let slanted = Beam::new(vec3(1.0, 0.0, 0.0), vec3(-1.0, 0.0, 1.0), Vec3::ZERO, Vec3::ZERO);
        assert!((slanted.enters([-0.1, -0.1, 0.5], [0.1, 0.1, 9.0]).unwrap() - 0.9).abs() < 1e-5);
    }
}
