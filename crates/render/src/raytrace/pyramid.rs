//! The rays through a block of pixels as one probe: the pyramid (or, in a parallel view, the prism)
//! that holds them all.
//!
//! Rays through neighbouring pixels meet the same boxes. Instead of testing a box against each of
//! them, it is tested against the four planes round them: a box that lies behind one of the planes
//! is met by none. For a plane only the corner that lies farthest along its normal counts, and the
//! four planes are tested at the same time, one a lane. Two more lanes hold the direction of view:
//! how near the box begins, and whether it lies behind the eye altogether. Of eight boxes, each
//! plane is asked in turn, one box a lane.
//!
//! In:   planes and boxes in one space. Out: the smallest distance along the direction of view at
//!       which they may meet.
//! Cost: six products on eight lanes for a box, 18 for eight.
//! Source: packets of rays after [Wald et al. 2001], the test of boxes after [Gribb & Hartmann
//!         2001].

use super::{Boxes, Probe};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Simd};
use vitral_math::{DVec3, Vec3};

/// Relative rounding of a plane's value, with room to spare.
const ROUNDING: f64 = 1.0 / (1 << 20) as f64;
/// The lane of the direction backwards: its value is the distance, negative.
const NEAR: usize = 4;
/// The lane of the direction of view.
const AHEAD: usize = 5;
const PLANES: usize = 6;

/// `normal · p + offset >= 0` for the places inside.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// Points inwards; any length.
    pub normal: DVec3,
    /// See above.
    pub offset: f64,
}

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct Pyramid<S: Simd> {
    /// Components of the planes' normals, one lane for each plane.
    normal: [F32x8<S>; 3],
    /// The planes' offsets: `normal · p + offset >= 0` inside.
    offset: F32x8<S>,
    /// Each plane by itself.
    planes: [Side; PLANES],
}

/// One plane.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    /// Normal, inwards.
    normal: [f32; 3],
    /// `normal · p + offset >= 0` inside, with slack for rounding.
    offset: f32,
    /// Where a box lies farthest along the normal, on each axis: 0 at its least coordinate, 1 at
    /// its largest.
    corner: [usize; 3],
}

impl<S: Simd> Pyramid<S> {
    /// The pyramid inside `sides` and, unless the view is parallel, ahead of `eye`; no coordinate
    /// of a box is larger than `extent`.
    #[inline(always)]
    pub fn new(
        simd: S,
        sides: &[Plane; 4],
        forward: DVec3,
        eye: DVec3,
        perspective: bool,
        extent: f64,
    ) -> Self {
        // Round the planes outwards to single precision.
        let mut normal = [[0.0f32; LANES]; 3];
        let mut offset = [0.0f32; LANES];
        let mut lane = |i: usize, plane: Plane, slack: f64| {
            let narrow: Vec3 = plane.normal.as_vec3();
            (normal[0][i], normal[1][i], normal[2][i]) = (narrow.x, narrow.y, narrow.z);
            offset[i] = (plane.offset + slack) as f32;
        };
        let slack = |p: Plane| {
            let a = p.normal.abs();
            ((a.x + a.y + a.z) * extent + p.offset.abs()) * ROUNDING
        };

        // Store the four sides, then the planes behind and ahead of the eye.
        for (i, side) in sides.iter().enumerate() {
            lane(i, *side, slack(*side));
        }
        let back = Plane { normal: -forward, offset: forward.dot(eye) };
        lane(NEAR, back, slack(back));
        if perspective {
            let ahead = Plane { normal: forward, offset: -forward.dot(eye) };
            lane(AHEAD, ahead, slack(ahead));
        }
        let side = |i: usize| {
            let normal = [normal[0][i], normal[1][i], normal[2][i]];
            Side { normal, offset: offset[i], corner: normal.map(|n| usize::from(n > 0.0)) }
        };

        // Keep each plane with the corner of a box that lies farthest inside.
        let planes = [side(0), side(1), side(2), side(3), side(NEAR), side(AHEAD)];
        Self {
            planes,
            normal: [
                F32x8::from_slice(simd, &normal[0]),
                F32x8::from_slice(simd, &normal[1]),
                F32x8::from_slice(simd, &normal[2]),
            ],
            offset: F32x8::from_slice(simd, &offset),
        }
    }
}

impl<S: Simd> Probe for Pyramid<S> {
    #[inline(always)]
    fn enters(&self, min: [f32; 3], max: [f32; 3]) -> Option<f32> {
        // Each plane's value at the corner where it is largest.
        let n = &self.normal;
        let x = lanes::Lanes::max(n[0] * min[0], n[0] * max[0]);
        let y = lanes::Lanes::max(n[1] * min[1], n[1] * max[1]);
        let z = lanes::Lanes::max(n[2] * min[2], n[2] * max[2]);
        let value = (x + y) + (z + self.offset);
        let behind = value.simd_lt(F32x8::splat(value.token(), 0.0)).to_bitmask() & !(1 << NEAR);
        (behind == 0).then(|| -value.to_array()[NEAR])
    }

    #[inline(always)]
    fn enters_each(&self, boxes: &Boxes) -> ([f32; LANES], u64) {
        // Evaluate the inner corner of eight boxes on each plane.
        let simd = self.offset.token();
        let value = lanes::inlined(
            #[inline(always)]
            |i: usize| {
                let Side { normal: n, offset, corner } = &self.planes[i];
                let along = lanes::inlined(
                    #[inline(always)]
                    |k: usize| F32x8::from_slice(simd, &boxes[k][corner[k] & 1]) * n[k],
                );
                (along(0) + along(1)) + (along(2) + *offset)
            },
        );
        let zero = F32x8::splat(simd, 0.0);
        let lowest = lanes::Lanes::min(
            lanes::Lanes::min(value(0), value(1)),
            lanes::Lanes::min(lanes::Lanes::min(value(2), value(3)), value(AHEAD)),
        );
        // A box that is not there has no corner within.
        let there =
            F32x8::from_slice(simd, &boxes[0][0]).simd_le(F32x8::from_slice(simd, &boxes[0][1]));

        // Return where each box begins and which are met.
        let met = lowest.simd_ge(zero).to_bitmask() & there.to_bitmask();
        ((zero - value(NEAR)).to_array(), met)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;
    use vitral_math::lanes::{available_levels, dispatch};

    #[test]
    fn boxes_are_met_or_lie_beside_or_behind() {
        // The eye at (0, 0, 1) looks along z; the sides are |x| <= t / 4 and |y| <= t / 2 at
        // distance t.
        let (eye, forward) = (dvec3(0.0, 0.0, 1.0), DVec3::Z);
        let side = |normal: DVec3| Plane { normal, offset: -normal.dot(eye) };
        let sides = [
            side(dvec3(1.0, 0.0, 0.25)),
            side(dvec3(-1.0, 0.0, 0.25)),
            side(dvec3(0.0, 1.0, 0.5)),
            side(dvec3(0.0, -1.0, 0.5)),
        ];
        for (name, level) in available_levels() {
            let enters = |min: [f32; 3], max: [f32; 3]| dispatch!(level, simd => Pyramid::new(simd, &sides, forward, eye, true, 10.0).enters(min, max));
            let near = enters([-1.0, -1.0, 3.0], [1.0, 1.0, 4.0]).unwrap();
            assert!(near <= 2.0 && near > 1.9999, "{name}: {near}");
            assert_eq!(
                enters([0.8, -0.1, 3.0], [0.9, 0.1, 4.0]),
                None,
                "{name}: beside, at distance 3 the side is 0.75"
            );
            assert!(enters([0.7, -0.1, 3.0], [0.9, 0.1, 4.0]).is_some(), "{name}");
            assert_eq!(enters([-0.1, 1.6, 3.0], [0.1, 1.7, 4.0]), None, "{name}: above");
            assert_eq!(enters([-9.0, -9.0, -4.0], [9.0, 9.0, 0.9]), None, "{name}: behind the eye");
            assert!(
                enters([-9.0; 3], [9.0; 3]).is_some_and(|near| near <= 0.0),
                "{name}: round the eye"
            );
        }
    }

    #[test]
    fn eight_boxes_are_met_as_each_by_itself() {
        let (eye, forward) = (dvec3(0.5, 0.0, -3.0), dvec3(0.1, -0.2, 1.0).normalize());
        let side = |normal: DVec3| Plane { normal, offset: -normal.dot(eye) };
        let sides = [
            dvec3(1.0, 0.1, 0.3),
            dvec3(-1.0, 0.0, 0.3),
            dvec3(0.0, 1.0, 0.4),
            dvec3(0.2, -1.0, 0.4),
        ];
        let sides = sides.map(side);
        let (mut met, mut apart) = (0, 0);
        for (name, level) in available_levels() {
            for perspective in [true, false] {
                for turn in 0..40u32 {
                    // The last box is not there.
                    let mut boxes = [[[f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]]; 3];
                    for lane in 0..LANES - 1 {
                        for (k, axis) in boxes.iter_mut().enumerate() {
                            let at = |step: u32| {
                                ((turn * 8 + lane as u32) * step % 89) as f32 / 22.0 - 2.0
                            };
                            axis[0][lane] = at([13, 29, 53][k]);
                            axis[1][lane] = axis[0][lane] + at([7, 37, 11][k]).abs();
                        }
                    }
                    let ((near, mask), single) = dispatch!(level, simd => {
                        let pyramid = Pyramid::new(simd, &sides, forward, eye, perspective, 4.0);
                        (pyramid.enters_each(&boxes), [0, 1, 2, 3, 4, 5, 6].map(|lane| {
                            let corner = |side: usize| [0, 1, 2].map(|k| boxes[k][side][lane]);
                            pyramid.enters(corner(0), corner(1))
                        }))
                    });
                    for (lane, single) in single.into_iter().enumerate() {
                        let among = (mask >> lane & 1 == 1).then_some(near[lane]);
                        assert_eq!(among, single, "{name}, {perspective}, {turn}, {lane}");
                        met += u32::from(single.is_some());
                        apart += u32::from(single.is_none());
                    }
                    assert_eq!(mask >> (LANES - 1), 0, "{name}: nothing meets what is not there");
                }
            }
        }
        assert!(met > 100 && apart > 100, "{met} {apart}");
    }
}
