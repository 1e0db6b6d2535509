//! Faces that lie on one another: a glass box on a floor, a liquid that touches its glass.
//!
//! A ray that passes a surface starts anew so far behind it that rounding cannot let it meet that
//! surface again, and what coincides with the surface is left behind with it. So faces that
//! coincide are looked up: where a ray hits something else at about the same parameter, a probe
//! along the facet's normal finds all that touch there. They are met one after the other at that
//! place, the lower facet first, whatever rounding says about their order.
//!
//! Each surface counts once: the probe stands a little within the facet, off the edges at which a
//! neighbour goes on, and close surfaces go together only if they are about parallel.
//!
//! In:   places on facets, world space less the scene's middle. Out: the triangles that touch
//!       there, in the order of facets.
//! Cost: a short ray for each such place.

use crate::raytrace::Visitor;
use crate::raytrace::beam::Beam;
use crate::raytrace::intersect::Ray;
use crate::raytrace::structures::AnyStructure;
use crate::raytrace::triangles::Triangles;
use crate::shadow::clearance;
use std::ops::Range;
use vitral_math::DVec3;

/// Cosine of the largest angle between surfaces that go together.
const PARALLEL: f64 = 0.99;

/// Weights of the corners at a point within a triangle, on none of its lines of symmetry, where
/// others' edges might be.
const WITHIN: [f64; 3] = [0.47, 0.31, 0.22];

/// Triangles that touch at a place.
pub(super) struct CoincidentGroup {
    /// Where.
    pub position: DVec3,
    /// Which, as a range of all piles' places, in the order in which they are met.
    range: Range<u32>,
}

/// The piles of some rays.
#[derive(Default)]
pub(super) struct CoincidentGroups {
    piles: Vec<CoincidentGroup>,
    /// Places of triangles in the structure.
    places: Vec<u32>,
}

impl CoincidentGroups {
    pub(super) fn clear(&mut self) {
        self.piles.clear();
        self.places.clear();
    }

    /// Adds the pile at a position on the facet with these corners, seen from the side of `normal`;
    /// this facet comes first if it `is_first`, else where its number says. Returns the pile's
    /// number if more than one triangle is in it.
    pub(super) fn add(
        &mut self,
        structure: &AnyStructure,
        (facet, corners): (u32, [DVec3; 3]),
        (position, normal): (DVec3, DVec3),
        is_first: bool,
    ) -> Option<u32> {
        let triangles = structure.triangles();
        let extent = f64::from(triangles.extent);
        let height = clearance(position, extent);

        // Look from above, a little within the facet.
        let inner = (0..3).fold(DVec3::ZERO, |sum, k| sum + corners[k] * WITHIN[k]);
        let way = inner - position;
        let share = (4.0 * height / way.length()).min(0.5);
        let above = position + way * share + normal * height;
        let ray = Ray::new(above.as_vec3(), (-normal).as_vec3());
        let first = self.places.len();
        let mut touching = Touching {
            triangles,
            ray: &ray,
            normal,
            // What is higher was met before; what is lower is met later.
            window: (0.5 * height) as f32..(2.0 * height) as f32,
            slack: ray.rounding(triangles.extent),
            places: &mut self.places,
        };
        structure.traverse(&Beam::around(&ray, triangles.extent), &mut touching);

        // A structure may show a triangle several times.
        let mut found = self.places.split_off(first);
        found.sort_unstable_by_key(|&place| triangles.facets[place as usize]);
        found.dedup();
        let own = found.iter().position(|&place| triangles.facets[place as usize] == facet);
        let own = own.filter(|_| found.len() > 1)?;
        if is_first {
            found[..=own].rotate_right(1);
        }
        self.places.extend(found);
        self.piles
            .push(CoincidentGroup { position, range: first as u32..self.places.len() as u32 });
        Some(self.piles.len() as u32 - 1)
    }

    /// A pile and its triangles.
    pub(super) fn get(&self, pile: u32) -> (&CoincidentGroup, &[u32]) {
        let pile = &self.piles[pile as usize];
        (pile, &self.places[pile.range.start as usize..pile.range.end as usize])
    }
}

/// The normal by the winding; none without area.
pub(super) fn unit_normal([a, b, c]: &[DVec3; 3]) -> Option<DVec3> {
    (*b - *a).cross(*c - *a).try_normalize()
}

/// Collects the triangles about at right angles to a ray that it meets within a window.
struct Touching<'a> {
    triangles: &'a Triangles,
    ray: &'a Ray,
    normal: DVec3,
    window: Range<f32>,
    slack: f32,
    places: &'a mut Vec<u32>,
}

impl Visitor for Touching<'_> {
    #[inline(always)]
    fn skips(&self, _: usize, near: f32) -> bool {
        self.done(near)
    }

    #[inline(always)]
    fn done(&self, near: f32) -> bool {
        near > self.window.end + self.slack
    }

    #[inline(always)]
    fn triangle(&mut self, place: usize) {
        let corners = &self.triangles.corners[place];
        if self.ray.hit(corners).is_some_and(|t| self.window.contains(&t)) {
            let normal = unit_normal(&corners.map(|c| c.as_dvec3()));
            if normal.is_some_and(|n| n.dot(self.normal).abs() > PARALLEL) {
                self.places.push(place as u32);
            }
        }
    }
}
