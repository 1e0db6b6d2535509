//! Eight rays that go down a tree of boxes together.
//!
//! Neighbours' rays to one light, or through one pane, meet mostly the same boxes. A node is
//! fetched once for eight of them and tested in as many lanes; it is opened if one of them enters
//! it, and below it only those count that do. So each ray is shown the triangles that it would be
//! shown alone, whatever its companions are. Triangles are tested in lanes, too, as far as that is
//! a matter of plain rounding; where it may decide, and for hits, [`Ray::hit`] has the word.
//!
//! In:   rays in the space of the tree's triangles. Out: triangles that they hit.
//! Cost: that of one ray in eight lanes as long as they stay together; rays that part share
//!       nothing, and cost as if alone.
//! Source: \[Wald et al. 2001\].

use super::beam::{self, BeamLines};
use super::intersect::{Ray, surely_beside};
use super::triangles::Triangles;
use vitral_math::Vec3;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Mask8, Simd};

/// Follows the rays of a packet.
pub(crate) trait PacketVisitor {
    /// Whether what most rays enter first is wanted first. Else triangles come in the order of the
    /// tree, which is the same for a ray whatever its companions are.
    const NEAREST_FIRST: bool;

    /// For each ray a parameter beyond which nothing is wanted; negative where nothing at all is.
    fn limits(&self) -> &[f32; LANES];

    /// Ray `lane` meets the triangle at this place of the tree's triangles, at `t`.
    fn hit(&mut self, lane: usize, place: usize, t: f32);
}

/// Rays in lanes.
pub(crate) struct Packet<'r, S: Simd> {
    rays: &'r [Ray],
    /// The lanes that hold a ray.
    live: Mask8<S>,
    /// The beams' lines on each axis.
    lines: [BeamLines<S>; 3],
    /// Whether the upper and the lower one rise.
    rise: [[Mask8<S>; 2]; 3],
    origin: [F32x8<S>; 3],
    /// The axes of all rays, renamed as in [`Ray`], and their shear; `None` if they run along
    /// different axes.
    sheared: Option<([usize; 3], [F32x8<S>; 2])>,
}

/// One number of each of up to eight; unused lanes repeat the first.
#[inline(always)]
fn gathered<S: Simd, T>(simd: S, items: &[T], number: impl Fn(&T) -> f32) -> F32x8<S> {
    let mut soa = [0.0; LANES];
    for lane in 0..LANES {
        soa[lane] = number(&items[if lane < items.len() { lane } else { 0 }]);
    }
    F32x8::from_slice(simd, &soa)
}

impl<'r, S: Simd> Packet<'r, S> {
    /// Puts one to eight rays, in a space of half-width `extent`, into lanes.
    #[inline(always)]
    pub(crate) fn new(simd: S, rays: &'r [Ray], extent: f32) -> Self {
        // Gather origins and directions by component.
        let component = lanes::inlined(
            #[inline(always)]
            |k: usize| {
                [gathered(simd, rays, |r| r.origin[k]), gathered(simd, rays, |r| r.direction[k])]
            },
        );
        let [x, y, z] = [component(0), component(1), component(2)];

        // Enclose each ray in two lines on each axis, so that rounding cannot lose a box.
        let lines = [
            BeamLines::around(simd, x[0], x[1], extent),
            BeamLines::around(simd, y[0], y[1], extent),
            BeamLines::around(simd, z[0], z[1], extent),
        ];
        let zero = F32x8::splat(simd, 0.0);
        let rises = lanes::inlined(
            #[inline(always)]
            |lines: &BeamLines<S>| {
                [lines.inverse_upper_slope.simd_gt(zero), lines.inverse_lower_slope.simd_gt(zero)]
            },
        );

        // Share the shear of triangle tests if all rays have one main axis.
        let axes = rays[0].axes;
        let sheared = rays.iter().all(|r| r.axes == axes).then(|| {
            (axes, [gathered(simd, rays, |r| r.shear.x), gathered(simd, rays, |r| r.shear.y)])
        });
        Self {
            rays,
            live: Mask8::from_bitmask(simd, (1 << rays.len()) - 1),
            rise: [rises(&lines[0]), rises(&lines[1]), rises(&lines[2])],
            lines,
            origin: [x[0], y[0], z[0]],
            sheared,
        }
    }

    /// The lanes that hold a ray.
    #[inline(always)]
    pub(crate) fn live(&self) -> Mask8<S> {
        self.live
    }

    /// For each ray a parameter that no place common to it and the box goes below; infinite if they
    /// are apart.
    #[inline(always)]
    pub(crate) fn enters(&self, simd: S, min: [f32; 3], max: [f32; 3]) -> F32x8<S> {
        let infinity = F32x8::splat(simd, f32::INFINITY);
        let (mut near, mut far) = (F32x8::splat(simd, 0.0), infinity);
        for (k, (lines, &[upper_rises, lower_rises])) in
            self.lines.iter().zip(&self.rise).enumerate()
        {
            let at_min = (-lines.upper_start + min[k]) * lines.inverse_upper_slope;
            let at_max = (-lines.lower_start + max[k]) * lines.inverse_lower_slope;
            near = lanes::Lanes::max(near, upper_rises.select(at_min, -infinity));
            far = lanes::Lanes::min(far, upper_rises.select(infinity, at_min));
            far = lanes::Lanes::min(far, lower_rises.select(at_max, infinity));
            near = lanes::Lanes::max(near, lower_rises.select(-infinity, at_max));
        }
        let near = near * (1.0 - beam::ROUNDING);
        near.simd_le(far * (1.0 + beam::ROUNDING)).select(near, infinity)
    }

    /// The lanes among `wanted` whose ray may meet a triangle: what a ray's own edge functions deny
    /// without doubt is left out.
    #[inline(always)]
    fn may_meet(&self, corners: &[Vec3; 3], wanted: Mask8<S>) -> u64 {
        let Some(([x, y, z], shear)) = self.sheared else { return wanted.to_bitmask() };
        let place = lanes::inlined(
            #[inline(always)]
            |p: Vec3| {
                let p = [p.x, p.y, p.z];
                let away = -self.origin[z] + p[z];
                [-self.origin[x] + p[x] - shear[0] * away, -self.origin[y] + p[y] - shear[1] * away]
            },
        );
        let beside = surely_beside(place(corners[0]), place(corners[1]), place(corners[2]));
        (wanted & !beside).to_bitmask()
    }

    /// Tells `visitor` which rays hit the triangle at `place`; only `wanted` ones are tested.
    #[inline(always)]
    pub(crate) fn triangle(
        &self,
        (place, corners): (usize, &[Vec3; 3]),
        wanted: Mask8<S>,
        visitor: &mut impl PacketVisitor,
    ) {
        let mut lanes = self.may_meet(corners, wanted);
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            if let Some(t) = self.rays[lane].hit(corners) {
                visitor.hit(lane, place, t);
            }
        }
    }
}

/// Keeps the first hit of each ray.
pub(super) struct ClosestHits<'a> {
    triangles: &'a Triangles,
    /// The facets that the rays leave.
    own: &'a [u32],
    /// Rounding of the hits' parameters.
    slack: [f32; LANES],
    /// Parameters beyond which a ray searches nothing.
    limits: [f32; LANES],
    /// Position of the triangle in the structure's list, and the parameter of the hit.
    best: [Option<(usize, f32)>; LANES],
    /// Whether something else was hit at about the same parameter.
    crowded: [bool; LANES],
}

impl PacketVisitor for ClosestHits<'_> {
    const NEAREST_FIRST: bool = true;

    #[inline(always)]
    fn limits(&self) -> &[f32; LANES] {
        &self.limits
    }

    #[inline(always)]
    fn hit(&mut self, lane: usize, place: usize, t: f32) {
        let best = self.best[lane];
        if self.triangles.replaces(best, (place, t), self.own[lane]) {
            self.crowded[lane] = best.is_some_and(|(_, farther)| farther <= t + self.slack[lane]);
            self.best[lane] = Some((place, t));
            self.limits[lane] = t + self.slack[lane];
        } else if t <= self.limits[lane] && self.triangles.facets[place] != self.own[lane] {
            self.crowded[lane] = true;
        }
    }
}

/// What `follow` shows of one to eight rays, which leave the facets `own`: their first hits, and
/// whether they hit something else at the same place.
#[inline(always)]
pub(super) fn closest_hits<'a>(
    triangles: &'a Triangles,
    rays: &[Ray],
    own: &'a [u32],
    follow: impl FnOnce(&mut ClosestHits<'a>),
) -> ([Option<(usize, f32)>; LANES], [bool; LANES]) {
    let mut slack = [0.0; LANES];
    for (slack, ray) in slack.iter_mut().zip(rays) {
        *slack = ray.rounding(triangles.extent);
    }
    let (limits, best, crowded) = ([f32::MAX; LANES], [None; LANES], [false; LANES]);
    let mut closest = ClosestHits { triangles, own, slack, limits, best, crowded };
    follow(&mut closest);
    (closest.best, closest.crowded)
}
