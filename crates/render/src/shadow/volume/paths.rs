//! Eight straight paths that begin at one place, and eight boxes: what a side or a cap means to
//! each.
//!
//! In double precision, the operations in the order of the formulas for one path, so that a path
//! has the same crossings whichever way it is looked at.

use super::edges::{VolumeSide, before};
use crate::shadow::casters::{away, ordered, wide};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F64x8, LANES, Simd};
use vitral_math::{DVec3, DVec4, Vec3};

/// A point or direction in each lane.
type Points<S> = [F64x8<S>; 3];

#[inline(always)]
fn splat<S: Simd>(simd: S, p: DVec3) -> Points<S> {
    [p.x, p.y, p.z].map(
        #[inline(always)]
        |v| F64x8::splat(simd, v),
    )
}

#[inline(always)]
fn points<S: Simd>(simd: S, places: &[DVec3; LANES]) -> Points<S> {
    [0, 1, 2].map(
        #[inline(always)]
        |axis| F64x8::from_slice(simd, &places.map(|p| p[axis])),
    )
}

#[inline(always)]
fn dot<S: Simd>(a: Points<S>, b: Points<S>) -> F64x8<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross<S: Simd>(a: Points<S>, b: Points<S>) -> Points<S> {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

#[inline(always)]
fn minus<S: Simd>(a: Points<S>, b: Points<S>) -> Points<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// [`super::edges::height`] of each point.
#[inline(always)]
fn heights<S: Simd>(simd: S, plane: DVec4, p: Points<S>) -> F64x8<S> {
    let [x, y, z] = splat(simd, plane.truncate());
    (x * p[0] + y * p[1]) + (z * p[2] + plane.w)
}

/// The lanes in which a value is positive, one bit each.
#[inline(always)]
fn positive<S: Simd>(simd: S, value: F64x8<S>) -> u32 {
    value.simd_gt(F64x8::splat(simd, 0.0)).to_bitmask() as u32
}

/// Eight paths from one place, and what is counted along each.
pub(super) struct Paths<S: Simd> {
    simd: S,
    from: DVec3,
    to: Points<S>,
    way: Points<S>,
    /// Normals of the planes through a path and the light.
    normal: Points<S>,
    /// What has been added to the count of each.
    pub(super) changes: [i32; LANES],
}

impl<S: Simd> Paths<S> {
    /// To eight places.
    #[inline(always)]
    pub(super) fn new(simd: S, from: DVec3, to: &[DVec3; LANES], light: DVec4) -> Self {
        let to = points(simd, to);
        let way = minus(to, splat(simd, from));
        let normal = cross(splat(simd, -away(light, from)), way);
        Self { simd, from, to, way, normal, changes: [0; LANES] }
    }

    /// Whether the paths that cross a plane do so along its normal, and which ones do.
    #[inline(always)]
    fn crossing(&self, plane: DVec4) -> (bool, u32) {
        let ends = positive(self.simd, heights(self.simd, plane, self.to));
        let along = !before(plane, self.from);
        (along, if along { ends } else { !ends & 0xff })
    }

    /// The paths that have the line from `a` to `b`, given from where they begin, on their left.
    #[inline(always)]
    fn left_of(&self, a: Points<S>, b: Points<S>) -> u32 {
        positive(self.simd, dot(cross(self.way, a), b))
    }

    #[inline(always)]
    fn add(&mut self, mut met: u32, change: i32) {
        while met != 0 {
            self.changes[met.trailing_zeros() as usize % LANES] += change;
            met &= met - 1;
        }
    }

    /// Counts a side of volumes.
    #[inline(always)]
    pub(super) fn meet_side(&mut self, side: &VolumeSide) {
        // Find the paths that cross the side's plane.
        let (enters, mut met) = self.crossing(side.plane);
        if met == 0 {
            return;
        }

        // Keep those that pass between the rays along its two edges.
        let [a, b] = [side.a, side.b].map(
            #[inline(always)]
            |p| splat(self.simd, p - self.from),
        );
        let [of_a, of_b] = [a, b].map(
            #[inline(always)]
            |p| positive(self.simd, dot(self.normal, p)),
        );
        met &= if enters { !of_a & of_b } else { of_a & !of_b };

        // Keep those on the inner side of the edge itself, and count them.
        if met != 0 {
            let left = self.left_of(a, b);
            met &= if enters { !left } else { left };
            self.add(met, if enters { side.multiplicity } else { -side.multiplicity });
        }
    }

    /// Counts the near cap of a triangle with this plane, which is `turned` towards the light, 1,
    /// or away, -1.
    #[inline(always)]
    pub(super) fn meet_cap(&mut self, plane: DVec4, corners: &[Vec3; 3], turned: i8) {
        let (along, mut met) = self.crossing(plane);
        if met == 0 {
            return;
        }
        let corners = wide(corners);
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            // What two triangles share has one value for both.
            let swap = !ordered(a, b);
            let (a, b) = if swap { (b, a) } else { (a, b) };
            let left =
                self.left_of(splat(self.simd, a - self.from), splat(self.simd, b - self.from));
            met &= if along != swap { left } else { !left };
        }
        self.add(met, if along { -i32::from(turned) } else { i32::from(turned) });
    }
}

/// Eight boxes, parallel to the axes.
pub(super) struct Boxes8<S: Simd> {
    simd: S,
    middle: Points<S>,
    half: Points<S>,
}

impl<S: Simd> Boxes8<S> {
    /// By their middles and half their sides.
    #[inline(always)]
    pub(super) fn new(simd: S, middle: &[DVec3; LANES], half: &[DVec3; LANES]) -> Self {
        Self { simd, middle: points(simd, middle), half: points(simd, half) }
    }

    /// How far the corner of each box that is farthest along a normal is from its middle, along the
    /// normal.
    #[inline(always)]
    fn reach(&self, normal: DVec3) -> F64x8<S> {
        dot(splat(self.simd, normal.abs()), self.half)
    }

    /// Those that a plane cuts, with room for the rounding of a height.
    #[inline(always)]
    fn cut_by(&self, plane: DVec4) -> u32 {
        let height = heights(self.simd, plane, self.middle).abs();
        height.simd_le(self.reach(plane.truncate()) * (1.0 + 1e-9)).to_bitmask() as u32
    }

    /// Those into which a side may reach.
    #[inline(always)]
    pub(super) fn touched_by_side(&self, side: &VolumeSide) -> u32 {
        let mut touched = self.cut_by(side.plane);
        if touched == 0 {
            return 0;
        }
        let from_a = minus(self.middle, splat(self.simd, side.a));
        let from_b = minus(self.middle, splat(self.simd, side.b));
        for (normal, from) in side.borders.into_iter().zip([from_a, from_a, from_b]) {
            let least = -(self.reach(normal) * (1.0 + 1e-12));
            touched &= dot(splat(self.simd, normal), from).simd_ge(least).to_bitmask() as u32;
        }
        touched
    }

    /// Those into which a triangle with this plane may reach.
    #[inline(always)]
    pub(super) fn touched_by_triangle(&self, plane: DVec4, corners: &[Vec3; 3]) -> u32 {
        let mut touched = self.cut_by(plane);
        if touched == 0 {
            return 0;
        }
        let [a, b, c] = wide(corners);
        let (min, max) = (splat(self.simd, a.min(b).min(c)), splat(self.simd, a.max(b).max(c)));
        for k in 0..3 {
            let inside = min[k].simd_le(self.middle[k] + self.half[k])
                & max[k].simd_ge(self.middle[k] - self.half[k]);
            touched &= inside.to_bitmask() as u32;
        }
        touched
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::volume::edges::height;
    use vitral_math::lanes::{available_levels, dispatch};

    const LIGHT: DVec4 = DVec4::new(0.3, 0.4, 8.0, 1.0);

    /// Numbers in -1..1, the same at every run.
    fn noise(seed: &mut u64) -> f64 {
        *seed =
            seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn place(seed: &mut u64) -> DVec3 {
        DVec3::new(noise(seed), noise(seed), noise(seed))
    }

    fn triangle(seed: &mut u64) -> ([Vec3; 3], DVec4) {
        let corners = [0; 3].map(|_| place(seed).as_vec3());
        let [a, b, c] = wide(&corners);
        let normal = (b - a).cross(c - a);
        (corners, normal.extend(-normal.dot(a)))
    }

    #[test]
    fn a_path_meets_a_cap_where_the_line_cuts_the_triangle() {
        let mut seed = 1;
        for _ in 0..200 {
            let from = place(&mut seed);
            let to = [0; LANES].map(|_| place(&mut seed));
            let (corners, plane) = triangle(&mut seed);
            // Barycentric coordinates of where the line meets the plane.
            let expected = to.map(|to| {
                let (start, end) = (height(plane, from), height(plane, to));
                let at = from + (to - from) * (start / (start - end));
                let [a, b, c] = wide(&corners);
                let normal = plane.truncate();
                let inside = [(a, b), (b, c), (c, a)]
                    .iter()
                    .all(|(p, q)| (*q - *p).cross(at - *p).dot(normal) > 0.0);
                if (start > 0.0) != (end > 0.0) && inside {
                    if start > 0.0 { 1 } else { -1 }
                } else {
                    0
                }
            });
            for (name, level) in available_levels() {
                let changes = dispatch!(level, simd => {
                    let mut paths = Paths::new(simd, from, &to, LIGHT);
                    paths.meet_cap(plane, &corners, 1);
                    paths.changes
                });
                assert_eq!(changes, expected, "{name}");
            }
        }
    }

    #[test]
    fn a_path_meets_a_side_where_it_passes_beyond_the_edge() {
        let mut seed = 2;
        let mut met = 0;
        for _ in 0..400 {
            let from = place(&mut seed);
            let to = [0; LANES].map(|_| place(&mut seed));
            let [a, b] = [place(&mut seed), place(&mut seed)];
            let (a, b) = if ordered(a, b) { (a, b) } else { (b, a) };
            let side = VolumeSide::new(a, b, LIGHT, 3);
            let light = LIGHT.truncate();
            let expected = to.map(|to| {
                let (start, end) = (height(side.plane, from), height(side.plane, to));
                let at = from + (to - from) * (start / (start - end));
                // Seen from the light between both ends, and farther away than the edge.
                let (toward, normal) = (at - light, side.plane.truncate());
                let between = (a - light).cross(toward).dot(normal)
                    * (toward.cross(b - light)).dot(normal)
                    > 0.0
                    && toward.dot((a - light) + (b - light)) > 0.0;
                let edge_side =
                    (b - a).cross(at - a).dot(normal) * (b - a).cross(light - a).dot(normal);
                let crosses = (start > 0.0) != (end > 0.0) && between && edge_side < 0.0;
                if !crosses {
                    0
                } else if end > 0.0 {
                    3
                } else {
                    -3
                }
            });
            met += expected.iter().filter(|&&n| n != 0).count();
            for (name, level) in available_levels() {
                let changes = dispatch!(level, simd => {
                    let mut paths = Paths::new(simd, from, &to, LIGHT);
                    paths.meet_side(&side);
                    paths.changes
                });
                assert_eq!(changes, expected, "{name}");
            }
        }
        assert!(met > 50, "{met}");
    }

    #[test]
    fn boxes_touch_what_reaches_into_them() {
        let mut seed = 3;
        let (mut missed, mut touched) = (0, 0);
        for _ in 0..200 {
            let middle = [0; LANES].map(|_| place(&mut seed));
            let half = [0; LANES].map(|_| place(&mut seed).abs() * 0.2);
            let (corners, plane) = triangle(&mut seed);
            let [a, b, c] = wide(&corners);
            let side = VolumeSide::new(a.min(b), a.max(b), LIGHT, 1);
            for (name, level) in available_levels() {
                let [by_triangle, by_side] = dispatch!(level, simd => {
                    let boxes = Boxes8::new(simd, &middle, &half);
                    [boxes.touched_by_triangle(plane, &corners), boxes.touched_by_side(&side)]
                });
                for lane in 0..LANES {
                    let inside =
                        |p: DVec3| ((p - middle[lane]).abs() - half[lane]).max_element() <= 0.0;
                    let steps = || {
                        (0..=20).flat_map(|i| {
                            (0..=20).map(move |j| (f64::from(i) / 20.0, f64::from(j) / 20.0))
                        })
                    };
                    let in_triangle =
                        steps().any(|(s, t)| s + t <= 1.0 && inside(a + (b - a) * s + (c - a) * t));
                    let beyond = |p: DVec3, t: f64| p + (p - LIGHT.truncate()) * t;
                    let in_side = steps()
                        .any(|(s, t)| inside(beyond(side.a + (side.b - side.a) * s, t * 0.3)));
                    assert!(!in_triangle || by_triangle >> lane & 1 == 1, "{name}");
                    assert!(!in_side || by_side >> lane & 1 == 1, "{name}");
                    touched += (by_triangle >> lane & 1) + (by_side >> lane & 1);
                    missed += (!by_triangle >> lane & 1) + (!by_side >> lane & 1);
                }
            }
        }
        assert!(touched > 100 && missed > 100, "{touched} {missed}");
    }
}
