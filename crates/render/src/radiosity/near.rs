//! Elements so near a patch that it is no point to them.
//!
//! The hemicube in the middle of a patch stands for all of it, which is true some sizes of the
//! patch away. An element that is nearer says itself how much of its sky the patch fills: by
//! Lambert's formula from the element's middle, as far as rays from there reach the parts of the
//! patch. The light that then arrives is `F_pe = F_ep A_e / A_p` of what the patch sends. What is
//! farther away shares the rest in the proportions that the hemicube found, so that no light is
//! lost or made.
//!
//! In:   what a hemicube sees. Out: the same, with the factors of near elements put right.
//! Cost: a search for neighbours; for each of those that face the patch up to 16 rays.
//! Source: \[Wallace, Elmquist & Haines 1989\]. Departs from it: only near elements ask, and for
//!         all of the polygon.

use super::element::{FormFactors, turned};
use super::enclosure::Enclosure;
use super::form_factor::from_point;
use super::parts::quarters;
use crate::Execution;
use crate::raytrace::bvh::Bvh;
use crate::raytrace::follow::Follow;
use crate::raytrace::intersect::Ray;
use crate::raytrace::{Counters, Structure};
use crate::shadow::clearance;
use vitral_math::DVec3;
use vitral_math::lanes::{LANES, dispatch};

/// Longest edges of the patch up to which an element is near.
const NEAR: f64 = 2.0;
/// Up to which the patch is looked at in 16 parts, not in four.
const NEXT: f64 = 1.0;
/// A factor that counts as none.
const NOTHING: f64 = 1e-9;
/// By how much farther elements may be lit more, or less, to make up for near ones.
const MOST_SCALED: f64 = 2.0;

/// A side of a patch, as elements see it.
struct Sender {
    /// Counter-clockwise, seen from this side.
    corners: [DVec3; 3],
    normal: DVec3,
    /// The longest edge.
    longest: f64,
    area: f64,
}

/// Puts the factors of near elements right in what the hemicube on a side of a patch sees.
pub(super) fn refined(
    enclosure: &Enclosure,
    seen: FormFactors,
    shooter: usize,
    execution: &Execution,
) -> FormFactors {
    // Describe the side that shoots.
    let patch = &enclosure.patches[shooter / 2];
    if patch.is_group {
        return seen;
    }
    let [a, b, c] = patch.corners;
    let corners = if shooter.is_multiple_of(2) { [a, b, c] } else { [a, c, b] };
    let sender = Sender {
        corners,
        normal: patch.normal * turned(shooter),
        longest: a.distance(b).max(b.distance(c)).max(c.distance(a)),
        area: 0.5 * (b - a).cross(c - a).length(),
    };

    // Compute the factors of near elements with rays.
    let mut near = FormFactors::new();
    enclosure.neighbours.visit(
        &enclosure.elements,
        patch.center,
        NEAR * sender.longest,
        |number| {
            let element = &enclosure.elements[number as usize];
            let cuts =
                if element.center.distance(patch.center) < NEXT * sender.longest { 2 } else { 1 };
            for side in [2 * number, 2 * number + 1] {
                let normal = element.normal * turned(side as usize);
                let part = sender.seen(element.center, normal, cuts, &enclosure.tree, execution);
                near.extend(part.map(|part| (side, part * element.area / sender.area)));
            }
        },
    );
    if near.is_empty() {
        return seen;
    }

    // Remove these elements from the hemicube's row.
    near.sort_unstable_by_key(|(side, _)| *side);
    let own = |side: u32| near.binary_search_by_key(&side, |(near, _)| *near).is_ok();
    let (mut row, mut replaced) = (FormFactors::with_capacity(seen.len() + near.len()), 0.0);
    for (side, factor) in seen {
        if own(side) { replaced += factor } else { row.push((side, factor)) }
    }

    // What is farther away has the rest, the sky with it.
    let (sum, rest) = (near.iter().map(|(_, factor)| factor).sum::<f64>(), 1.0 - replaced);
    let farther =
        if rest > 0.0 { ((1.0 - sum) / rest).clamp(1.0 / MOST_SCALED, MOST_SCALED) } else { 0.0 };
    let nearer = if sum > 0.0 { (1.0 - farther * rest) / sum } else { 1.0 };
    row.iter_mut().for_each(|(_, factor)| *factor *= farther);
    row.extend(
        near.into_iter().filter(|(_, part)| *part > 0.0).map(|(side, part)| (side, part * nearer)),
    );
    row.sort_unstable_by_key(|(side, _)| *side);
    row
}

impl Sender {
    /// The part of the sky above `point` that the side fills, as far as it is seen, cut into 4 to
    /// the power `cuts` parts; `None` if it would not be seen if nothing were in between.
    fn seen(
        &self,
        point: DVec3,
        normal: DVec3,
        cuts: u32,
        tree: &Bvh,
        execution: &Execution,
    ) -> Option<f64> {
        // Skip the point if it lies behind the side or the side below its horizon.
        let (center, extent) = (tree.triangles().center, f64::from(tree.triangles().extent));
        let clear = clearance(point, extent);
        if (point - self.corners[0]).dot(self.normal) <= clear {
            return None;
        }
        if self.corners.iter().all(|corner| (*corner - point).dot(normal) <= clear) {
            return None;
        }

        // Compute the form factor without occlusion.
        let polygon = above(&self.corners, point, normal);
        let whole = from_point(point, normal, &polygon);
        if whole <= NOTHING {
            return None;
        }

        // Cut the side into parts.
        let mut parts = vec![self.corners];
        for _ in 0..cuts {
            parts = parts.into_iter().flat_map(quarters).collect();
        }

        // Trace a ray to the middle of each part that lies above the horizon.
        let mut visible = Vec::with_capacity(parts.len());
        let polygons =
            parts.iter().map(|part| above(part, point, normal)).filter(|polygon| polygon.len() > 2);
        let polygons: Vec<Vec<DVec3>> = polygons.collect();
        for eight in polygons.chunks(LANES) {
            let from = point + normal * clear;
            let rays = eight.iter().map(|polygon| {
                let middle =
                    polygon.iter().sum::<DVec3>() / polygon.len() as f64 + self.normal * clear;
                Ray::new((from - center).as_vec3(), (middle - from).as_vec3())
            });
            let rays: Vec<Ray> = rays.collect();
            let own = [u32::MAX; LANES];
            let (hits, _) = dispatch!(execution.level, simd => {
                tree.closest_hits(simd, &rays, &own, &mut Counters::default())
            });
            visible.extend(hits[..eight.len()].iter().map(|hit| hit.is_none_or(|(_, t)| t >= 1.0)));
        }

        // Sum the form factors of the visible parts.
        if visible.iter().all(|v| *v) {
            return Some(whole);
        }
        let seen = polygons.iter().zip(visible).filter(|(_, visible)| *visible);
        Some(seen.map(|(polygon, _)| from_point(point, normal, polygon)).sum())
    }
}

/// What of a triangle is above the horizon of a point: corners in order, none if nothing is.
fn above(corners: &[DVec3; 3], point: DVec3, normal: DVec3) -> Vec<DVec3> {
    let mut polygon = Vec::with_capacity(4);
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let (height_a, height_b) = ((a - point).dot(normal), (b - point).dot(normal));
        if height_a > 0.0 {
            polygon.push(a);
        }
        if (height_a > 0.0) != (height_b > 0.0) {
            polygon.push(a.lerp(b, height_a / (height_a - height_b)));
        }
    }
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    #[test]
    fn what_is_below_the_horizon_is_cut_off() {
        let corners = [dvec3(0.0, 0.0, -1.0), dvec3(0.0, 0.0, 1.0), dvec3(2.0, 0.0, 1.0)];
        let polygon = above(&corners, DVec3::ZERO, DVec3::Z);
        assert_eq!(polygon, [DVec3::ZERO, corners[1], corners[2], dvec3(1.0, 0.0, 0.0)]);
        assert!(above(&corners, DVec3::ZERO, -DVec3::Z).len() == 3);
        assert!(above(&corners, DVec3::Z, DVec3::Z).is_empty());
    }
}
