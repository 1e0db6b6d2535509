//! What keeps light: the triangles of the scene, and the solid without end that each hides from a
//! light.
//!
//! Opaque triangles are found in the session's tree of boxes, transparent ones in a tree of their
//! own. A light is a homogeneous point: `w` is 1, or 0 for a direction. Whatever two triangles
//! share, an edge or a corner, gives both the same numbers, so that their solids leave no gap.

use super::occluders::Occluders;
use super::places::SurfacePoint;
use super::rounding::{clearance, horizon};
use crate::raytrace::bvh::Bvh;
use crate::raytrace::shaft::Shaft;
use crate::raytrace::triangles::Triangles;
use crate::raytrace::{Probe, Structure, Tree, Visitor};
use crate::{Cached, Execution, Session};
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_light::Rgb;
use vitral_math::{DVec3, DVec4, Vec3};

/// See the module.
#[derive(Debug)]
pub(crate) struct Casters {
    /// All triangles.
    pub(super) tree: Arc<Bvh>,
    /// For each triangle of the tree whether it keeps all light.
    pub(super) opaque: Vec<bool>,
    /// Triangles that do not.
    filters: Bvh,
}

/// The space that a triangle hides from a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Solid {
    /// Normals, turned inwards, and a point on each: the triangle's own plane, those through its
    /// edges and the light.
    pub(super) planes: [(DVec3, DVec3); 4],
}

/// Transparent triangles up to which all points of a facet share one list of filters; with more,
/// each point searches its own.
const MAX_SHARED_FILTERS: usize = 512;

/// Whether `a` comes first: any order will do that is the same for all.
#[inline(always)]
pub(super) fn ordered(a: DVec3, b: DVec3) -> bool {
    if a.x != b.x {
        a.x < b.x
    } else if a.y != b.y {
        a.y < b.y
    } else {
        a.z < b.z
    }
}

/// The corners, in double precision.
#[inline(always)]
pub(super) fn wide(corners: &[Vec3; 3]) -> [DVec3; 3] {
    corners.map(|c| c.as_dvec3())
}

/// The direction from the light through a place.
#[inline(always)]
pub(super) fn away(light: DVec4, p: DVec3) -> DVec3 {
    p * light.w - light.truncate()
}

/// Twice the area along the normal that the winding says.
#[inline(always)]
pub(super) fn winding_normal([a, b, c]: &[DVec3; 3]) -> DVec3 {
    (*b - *a).cross(*c - *a)
}

/// 1 if a triangle's winding turns it towards the light, -1 if away, 0 if the light is no farther
/// than `near` from its plane: then it hides nothing.
#[inline(always)]
pub(super) fn turned(corners: &[DVec3; 3], light: DVec4, near: f64) -> i8 {
    let normal = winding_normal(corners);
    let height = -normal.dot(away(light, corners[0]));
    // For a direction, what is thinner than rounding.
    let least =
        if light.w > 0.0 { near } else { 1e-9 * light.truncate().length() } * normal.length();
    i8::from(height > least) - i8::from(height < -least)
}

/// The plane through an edge, its ends `ordered`, and the light.
#[inline(always)]
pub(super) fn side_normal(a: DVec3, b: DVec3, light: DVec4) -> DVec3 {
    (b - a).cross(-away(light, a))
}

/// Triangles nearer to a light than this hide nothing from it: what it is fixed to does not.
pub(super) fn near(light: DVec4, extent: f32) -> f64 {
    let position = light.truncate() * light.w;
    clearance(position, f64::from(extent))
}

/// Where a place is looked at: a little above its facet.
pub(super) fn lifted(place: &SurfacePoint, extent: f32) -> DVec3 {
    place.position + place.normal * clearance(place.position, f64::from(extent))
}

/// Whether a place looks at the light. If not it is in its own shadow.
pub(super) fn faces(place: &SurfacePoint, light: DVec4) -> bool {
    -place.normal.dot(away(light, place.position)) > horizon(place.position, light)
}

impl Solid {
    /// `None` if the triangle hides nothing.
    pub(super) fn new(corners: &[DVec3; 3], light: DVec4, near: f64) -> Option<Self> {
        let turned = match turned(corners, light, near) {
            0 => return None,
            sign => f64::from(sign),
        };
        let side = |p: DVec3, q: DVec3| {
            if ordered(p, q) {
                (side_normal(p, q, light) * -turned, p)
            } else {
                (side_normal(q, p, light) * turned, q)
            }
        };
        let [a, b, c] = *corners;
        Some(Self {
            planes: [(winding_normal(corners) * -turned, a), side(a, b), side(b, c), side(c, a)],
        })
    }

    /// Whether a place that is on no triangle is in it.
    pub(super) fn contains(&self, p: DVec3) -> bool {
        let [(behind, at), ref sides @ ..] = self.planes;
        behind.dot(p - at) > 0.0 && sides.iter().all(|(n, at)| n.dot(p - *at) >= 0.0)
    }

    /// Whether it may reach into a box, given by its middle and half its sides.
    #[inline(always)]
    pub(super) fn touches(&self, middle: DVec3, half: DVec3) -> bool {
        self.planes.iter().all(|(n, at)| n.dot(middle - *at) >= -n.abs().dot(half) * (1.0 + 1e-12))
    }
}

/// The middle of the box round some places, and half its sides.
pub(super) fn box_around(places: impl Iterator<Item = DVec3>, slack: f64) -> (DVec3, DVec3) {
    let [min, max] = places
        .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[min, max], p| [min.min(p), max.max(p)]);
    ((min + max) * 0.5, (max - min) * 0.5 + DVec3::splat(slack))
}

/// Collects what a tree shows.
struct Collect<'a>(&'a mut Vec<u32>);

impl Visitor for Collect<'_> {
    #[inline(always)]
    fn skips(&self, _: usize, _: f32) -> bool {
        false
    }

    #[inline(always)]
    fn done(&self, _: f32) -> bool {
        false
    }

    #[inline(always)]
    fn triangle(&mut self, place: usize) {
        self.0.push(place as u32);
    }
}

/// Appends the triangles of all leaves that the probe meets.
pub(super) fn collect(tree: &Bvh, probe: &impl Probe, list: &mut Vec<u32>) {
    tree.descend(probe, &mut Collect(list));
}

impl Cached for Casters {
    /// Whether blended materials keep all light.
    type Key = bool;
}

impl Casters {
    /// Those of the session; lights do not matter.
    pub(super) fn of(
        session: &Session,
        occluders: &Occluders<'_>,
        execution: &Execution,
    ) -> Result<Arc<Self>, Limit> {
        session.cache.get_or_build(occluders.key(), || Self::new(session, occluders, execution))
    }

    fn new(
        session: &Session,
        occluders: &Occluders<'_>,
        execution: &Execution,
    ) -> Result<Self, Limit> {
        let tree = Bvh::of(session, execution)?;
        tree.widen(&execution.workers);
        let triangles = tree.triangles();
        let opaque: Vec<bool> = triangles.facets.iter().map(|&f| occluders.is_opaque(f)).collect();
        let chosen = || (0..triangles.count()).filter(|&i| !opaque[i]);
        let clear = Triangles {
            corners: chosen().map(|i| triangles.corners[i]).collect(),
            facets: chosen().map(|i| triangles.facets[i]).collect(),
            ..*triangles
        };
        let filters = Bvh::build(&clear, &execution.workers, &execution.budget)?;
        filters.widen(&execution.workers);
        Ok(Self { tree, opaque, filters })
    }

    /// All triangles, in the order of the tree.
    pub(super) fn triangles(&self) -> &Triangles {
        self.tree.triangles()
    }

    /// No coordinate of a triangle is larger.
    pub(super) fn extent(&self) -> f32 {
        self.triangles().extent
    }

    /// Appends the opaque triangles near a probe.
    pub(super) fn opaque_near(&self, probe: &impl Probe, list: &mut Vec<u32>) {
        let first = list.len();
        collect(&self.tree, probe, list);
        let mut kept = first;
        for i in first..list.len() {
            if self.opaque[list[i] as usize] {
                list[kept] = list[i];
                kept += 1;
            }
        }
        list.truncate(kept);
    }

    /// Appends the transparent triangles near a probe.
    pub(super) fn filters_near(&self, probe: &impl Probe, list: &mut Vec<u32>) {
        collect(&self.filters, probe, list);
    }

    /// The corners of a transparent triangle.
    pub(super) fn filter(&self, triangle: u32) -> [DVec3; 3] {
        wide(&self.filters.triangles().corners[triangle as usize])
    }

    /// The facet of a transparent triangle.
    pub(super) fn filter_facet(&self, triangle: u32) -> u32 {
        self.filters.triangles().facets[triangle as usize]
    }

    /// The part of each colour that transparent triangles let through to a place (lifted) on the
    /// facet `own`. `list` has all that may matter, and more.
    pub(super) fn filtered(
        &self,
        occluders: &Occluders<'_>,
        light: DVec4,
        own: u32,
        place: DVec3,
        list: &[u32],
    ) -> Rgb {
        // Narrow long lists to the filters near the way to the light.
        let triangles = self.filters.triangles();
        let near = near(light, triangles.extent);
        let mut nearer = Vec::new();
        let list = if list.len() > MAX_SHARED_FILTERS {
            self.filters_near(&Shaft::between(place, place, light, triangles.extent), &mut nearer);
            &nearer
        } else {
            list
        };

        // Find the filters whose shadow volume holds the place.
        let hides = |t: &&u32| {
            let facet = triangles.facets[**t as usize];
            facet != own
                && Solid::new(&self.filter(**t), light, near).is_some_and(|s| s.contains(place))
        };
        let mut hits: Vec<_> =
            list.iter().filter(hides).map(|&t| (triangles.facets[t as usize], t)).collect();
        // In one order, as products are rounded.
        hits.sort_unstable();

        // Multiply what each of them lets through where the way to the light crosses it.
        let passing = |&(facet, t): &(u32, u32)| {
            let corners = wide(&triangles.corners[t as usize]);
            let (normal, way) = (winding_normal(&corners), away(light, place));
            let along = normal.dot(corners[0] - place) / normal.dot(way);
            occluders.transmittance(facet, &triangles.corners[t as usize], || place + way * along)
        };
        hits.iter().map(passing).fold([1.0; 3], |left, part| [0, 1, 2].map(|k| left[k] * part[k]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    #[test]
    fn a_solid_is_what_lies_behind() {
        let corners = [dvec3(-1.0, 1.0, -1.0), dvec3(1.0, 1.0, -1.0), dvec3(0.0, 1.0, 2.0)];
        for corners in [corners, [corners[1], corners[0], corners[2]]] {
            let lamp = Solid::new(&corners, DVec4::new(0.0, 2.0, 0.0, 1.0), 1e-6).unwrap();
            assert!(
                lamp.contains(DVec3::ZERO) && lamp.contains(dvec3(0.0, -3.0, 9.0)),
                "it widens"
            );
            assert!(!lamp.contains(dvec3(0.0, 1.5, 0.0)) && !lamp.contains(dvec3(0.0, 9.0, 0.0)));
            let sun = Solid::new(&corners, DVec4::new(0.0, 1.0, 0.0, 0.0), 1e-6).unwrap();
            assert!(sun.contains(dvec3(0.0, -99.0, 0.0)) && !sun.contains(dvec3(0.0, -99.0, 2.1)));
            assert!(sun.touches(dvec3(0.0, -5.0, 3.0), DVec3::splat(1.1)));
            assert!(!sun.touches(dvec3(0.0, 2.1, 0.0), DVec3::splat(1.0)));
        }
        assert_eq!(
            Solid::new(&corners, DVec4::new(5.0, 1.0, 0.0, 1.0), 1e-6),
            None,
            "the light is in its plane"
        );
        assert_eq!(Solid::new(&corners, DVec4::new(1.0, 0.0, 0.0, 0.0), 1e-6), None);
    }
}
