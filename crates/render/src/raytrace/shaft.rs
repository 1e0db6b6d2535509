//! Shafts: the space between a box and a point, as planes round it.
//!
//! Whatever hides a box from a light, or a part of it, reaches into the convex hull of both. From
//! each of the three axes the box is a rectangle and the light a point; the two lines from the
//! point that touch the rectangle are planes of the hull seen edge-on. With the faces of the box
//! that point away from the light they bound the shaft. A light infinitely far away is a direction:
//! the shaft has no end.
//!
//! In:   a box or a triangle and a point, homogeneous: `w` is 1, or 0 for a direction. Out: a probe
//!       for trees of boxes.
//! Cost: up to twelve products and comparisons for each box.
//! Source: [Haines & Wallace 1991].

use super::{Boxes, Probe};
use vitral_math::lanes::LANES;
use vitral_math::{DVec3, DVec4};

/// Relative rounding of a plane's value, with room to spare.
const ROUNDING: f64 = 1.0 / (1 << 20) as f64;

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct Shaft {
    /// `n · p + d >= 0` inside.
    planes: Vec<[f32; 4]>,
}

/// The places within a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    min: [f32; 3],
    max: [f32; 3],
}

impl Block {
    /// From the smallest coordinates to the largest.
    pub fn new(min: DVec3, max: DVec3) -> Self {
        // Narrowing must not make it smaller.
        let wider = |c: f64, sign: f64| (c + sign * c.abs() * ROUNDING) as f32;
        Self {
            min: min.to_array().map(|c| wider(c, -1.0)),
            max: max.to_array().map(|c| wider(c, 1.0)),
        }
    }
}

impl Probe for Block {
    #[inline(always)]
    fn enters(&self, min: [f32; 3], max: [f32; 3]) -> Option<f32> {
        (0..3).all(|k| min[k] <= self.max[k] && self.min[k] <= max[k]).then_some(0.0)
    }
}

/// From a place to another, or along the direction.
fn way(from: DVec3, to: DVec4) -> DVec3 {
    to.truncate() - from * to.w
}

impl Shaft {
    /// The places between a box and `light`. No coordinate that is asked about is larger than
    /// `extent`.
    pub fn between(min: DVec3, max: DVec3, light: DVec4, extent: f32) -> Self {
        let mut shaft = Self { planes: Vec::with_capacity(12) };
        // Add the sides of the box that face the light, or planes through the light.
        // The box, stretched towards the light.
        for k in 0..3 {
            let axis = DVec3::AXES[k];
            if light[k] >= min[k] * light.w {
                shaft.push(axis, min, extent);
            } else if light.w > 0.0 {
                shaft.push(axis, light.truncate(), extent);
            }
            if light[k] <= max[k] * light.w {
                shaft.push(-axis, max, extent);
            } else if light.w > 0.0 {
                shaft.push(-axis, light.truncate(), extent);
            }
        }

        // Add the planes through edges of the box and the light that have the whole box on one
        // side.
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let corners = [[min[i], min[j]], [max[i], min[j]], [min[i], max[j]], [max[i], max[j]]];
            let place = |[u, v]: [f64; 2]| DVec3::AXES[i] * u + DVec3::AXES[j] * v;
            for corner in corners.map(place) {
                let towards = way(corner, light);
                let mut normal = DVec3::ZERO;
                (normal[i], normal[j]) = (-towards[j], towards[i]);
                let Some(normal) = normal.try_normalize() else { continue };
                let sides = corners.map(|c| normal.dot(place(c) - corner));
                if sides.iter().all(|&s| s >= 0.0) {
                    shaft.push(normal, corner, extent);
                } else if sides.iter().all(|&s| s <= 0.0) {
                    shaft.push(-normal, corner, extent);
                }
            }
        }
        shaft
    }

    /// The places in a flat triangle from `base` to two others.
    pub fn triangle(base: DVec3, others: [DVec4; 2], extent: f32) -> Self {
        let mut shaft = Self { planes: Vec::with_capacity(5) };
        let ways = others.map(|o| way(base, o).normalize_or_zero());
        let normal = ways[0].cross(ways[1]).normalize_or_zero();
        shaft.push(normal, base, extent);
        shaft.push(-normal, base, extent);
        for (along, inner) in [(ways[0], ways[1]), (ways[1], ways[0])] {
            let side = normal.cross(along);
            shaft.push(if side.dot(inner) < 0.0 { -side } else { side }, base, extent);
        }
        // The third side, unless it is at infinity.
        if let Some(finite) = others.iter().find(|o| o.w > 0.0) {
            let (from, to) =
                (finite.truncate(), if *finite == others[0] { others[1] } else { others[0] });
            let side = normal.cross(way(from, to)).normalize_or_zero();
            shaft.push(if side.dot(base - from) < 0.0 { -side } else { side }, from, extent);
        }
        shaft
    }

    /// Adds the plane through `at`, made a little wider than rounding could make it narrower.
    fn push(&mut self, normal: DVec3, at: DVec3, extent: f32) {
        let (n, offset) = (normal.abs(), -normal.dot(at));
        let slack = ((n.x + n.y + n.z) * f64::from(extent) + offset.abs()) * ROUNDING;
        let narrow = normal.as_vec3();
        self.planes.push([narrow.x, narrow.y, narrow.z, (offset + slack) as f32]);
    }
}

impl Probe for Shaft {
    #[inline(always)]
    fn enters(&self, min: [f32; 3], max: [f32; 3]) -> Option<f32> {
        let beyond = |p: &[f32; 4]| {
            let most = |k: usize| (p[k] * min[k]).max(p[k] * max[k]);
            most(0) + most(1) + (most(2) + p[3]) < 0.0
        };
        (!self.planes.iter().any(beyond)).then_some(0.0)
    }

    #[inline(always)]
    fn enters_each(&self, boxes: &Boxes) -> ([f32; LANES], u64) {
        // A box that is not there is beyond every plane.
        let there = |lane| if boxes[0][0][lane] <= boxes[0][1][lane] { 0.0 } else { -1.0 };
        let mut least: [f32; LANES] = std::array::from_fn(there);
        for p in &self.planes {
            // The corners that lie farthest along the normal.
            let [x, y, z] = [0, 1, 2].map(|k| &boxes[k][usize::from(p[k] > 0.0)]);
            for lane in 0..LANES {
                let value = p[0] * x[lane] + p[1] * y[lane] + (p[2] * z[lane] + p[3]);
                least[lane] = if value < least[lane] { value } else { least[lane] };
            }
            if least.iter().all(|&v| v < 0.0) {
                break;
            }
        }
        let met = |mask, lane: usize| mask | u64::from(least[lane] >= 0.0) << lane;
        ([0.0; LANES], (0..LANES).fold(0, met))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    fn meets(shaft: &Shaft, at: [f32; 3]) -> bool {
        shaft.enters(at.map(|c| c - 0.1), at.map(|c| c + 0.1)).is_some()
    }

    #[test]
    fn a_shaft_holds_what_lies_between() {
        let to_point =
            Shaft::between(-DVec3::ONE, DVec3::ONE, DVec4::new(0.0, 10.0, 0.0, 1.0), 20.0);
        assert!(
            meets(&to_point, [0.0, 5.0, 0.0])
                && meets(&to_point, [0.4, 5.0, -0.4])
                && meets(&to_point, [0.0; 3])
        );
        assert!(
            !meets(&to_point, [0.9, 5.0, 0.0]) && !meets(&to_point, [0.0, 5.0, -0.9]),
            "beside"
        );
        assert!(
            !meets(&to_point, [0.0, 10.3, 0.0]) && !meets(&to_point, [0.0, -1.3, 0.0]),
            "before and behind"
        );
        let to_infinity =
            Shaft::between(-DVec3::ONE, DVec3::ONE, DVec4::new(1.0, 1.0, 0.0, 0.0), 200.0);
        assert!(meets(&to_infinity, [99.0, 99.0, 0.9]) && meets(&to_infinity, [100.5, 99.0, 0.0]));
        assert!(
            !meets(&to_infinity, [99.0, 102.3, 0.0]) && !meets(&to_infinity, [99.0, 99.0, 1.3])
        );
        assert!(!meets(&to_infinity, [-5.0, -5.0, 0.0]));
        // Side by side, with one that is not there.
        let places = [
            [99.0, 99.0, 0.9],
            [99.0, 102.3, 0.0],
            [1.0, 1.5, -0.5],
            [5.0; 3],
            [0.0; 3],
            [100.5, 99.0, 0.0],
        ];
        let mut boxes = [[[f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]]; 3];
        for (lane, place) in places.iter().enumerate() {
            for (k, axis) in boxes.iter_mut().enumerate() {
                (axis[0][lane], axis[1][lane]) = (place[k] - 0.1, place[k] + 0.1);
            }
        }
        let each = places
            .iter()
            .enumerate()
            .map(|(lane, &p)| u64::from(meets(&to_infinity, p)) << lane)
            .sum::<u64>();
        assert_eq!(to_infinity.enters_each(&boxes).1, each);
        assert_eq!(each, 0b110101);
        // The light in the box: nothing but the box.
        let inside = Shaft::between(-DVec3::ONE, DVec3::ONE, DVec4::new(0.1, 0.2, 0.3, 1.0), 20.0);
        assert!(meets(&inside, [0.9, 0.9, 0.9]) && !meets(&inside, [1.3, 0.0, 0.0]));
    }

    #[test]
    fn a_block_meets_what_it_touches() {
        let block = Block::new(-DVec3::ONE, dvec3(1.0, 2.0, 3.0));
        assert!(block.enters([1.0, -9.0, 0.0], [2.0, 9.0, 1.0]).is_some());
        assert!(block.enters([1.1, -9.0, 0.0], [2.0, 9.0, 1.0]).is_none());
    }

    #[test]
    fn a_triangle_is_flat() {
        let other = [DVec4::new(4.0, 0.0, 0.0, 1.0), DVec4::new(0.0, 0.0, 1.0, 0.0)];
        let strip = Shaft::triangle(DVec3::ZERO, other, 100.0);
        assert!(meets(&strip, [2.0, 0.0, 50.0]) && meets(&strip, [0.0, 0.05, 0.0]));
        assert!(
            !meets(&strip, [2.0, 0.2, 5.0])
                && !meets(&strip, [4.2, 0.0, 5.0])
                && !meets(&strip, [2.0, 0.0, -0.2])
        );
        let small = Shaft::triangle(
            dvec3(1.0, 1.0, 1.0),
            [other[0], DVec4::new(0.0, 0.0, 2.0, 1.0)],
            100.0,
        );
        assert!(meets(&small, [1.6, 0.3, 1.0]) && !meets(&small, [4.0, 0.5, 2.0]));
    }
}
