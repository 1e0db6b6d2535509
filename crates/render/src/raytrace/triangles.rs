//! The triangles of a scene in one list: what all structures are built over.
//!
//! There is one flat list, not one for each mesh with instances on top: no matrix stands between
//! ray and triangle, at the price of memory where a mesh is used often. Coordinates are relative to
//! the middle of the scene, so that 32 bits are enough wherever in the world it lies.
//!
//! In:   the world. Out: [`Triangles`], world space less [`Triangles::center`].
//! Cost: linear; 40 bytes a triangle.

use crate::{Cached, Execution, Session};
use std::sync::Arc;
use vitral_exec::{Limit, Workers};
use vitral_math::{DVec3, Vec3, vec3};
use vitral_scene::World;

/// See the module.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// What coordinates are relative to, world space.
    pub center: DVec3,
    /// No coordinate is larger.
    pub extent: f32,
    /// Corners, finite.
    pub corners: Vec<[Vec3; 3]>,
    /// For each triangle its facet.
    pub facets: Vec<u32>,
}

/// Smallest and largest coordinates of corners.
pub(super) fn bounds_of(corners: &[Vec3; 3]) -> [Vec3; 2] {
    let [a, b, c] = *corners;
    [a.min(b).min(c), a.max(b).max(c)]
}

/// Whether a triangle reaches into the box with this middle and half its size, or nearly so: asked
/// of the triangle's box and plane, so that a needle that lies aslant may be said to reach into
/// boxes that it only passes by.
pub(super) fn reaches(corners: &[Vec3; 3], middle: Vec3, half: Vec3) -> bool {
    let [min, max] = bounds_of(corners);
    if (min - middle).cmpgt(half).any() || (max - middle).cmplt(-half).any() {
        return false;
    }
    // The plane passes the box if its distance from the middle is less than that of a corner.
    let [a, b, c] = *corners;
    let normal = (b - a).cross(c - a);
    let reach = normal.abs().dot(half) * (1.0 + 1.0 / (1 << 16) as f32);
    // A normal that is zero or overflows decides nothing; that of a needle is mostly rounding.
    let to_plane = a - middle;
    let distance = normal.dot(to_plane).abs();
    let edges = (b - a).abs().max_element() * (c - a).abs().max_element();
    let rounding =
        edges * (to_plane.abs().max_element() + half.max_element()) * (1.0 / (1 << 19) as f32);
    let beside = distance > reach + rounding;
    !beside
}

impl Cached for Triangles {
    type Key = ();
}

impl Triangles {
    /// Bytes needed while a list of this many is made.
    pub fn bytes(triangles: u64) -> u64 {
        triangles * 80
    }

    /// All triangles of the world. Those with a corner that is not finite are left out, as
    /// everywhere.
    pub fn of_world(world: &World, workers: &Workers) -> Self {
        let center = Self::center_of(world);
        let per_instance = workers.map(world.instances.len(), |i| placed(world, i, center));
        let count: usize = per_instance.iter().map(Vec::len).sum();
        let (mut corners, mut facets) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (facet, triangle) in per_instance.into_iter().flatten() {
            corners.push(triangle);
            facets.push(facet);
        }
        let largest = corners.iter().flatten().fold(Vec3::ZERO, |m, p| m.max(p.abs()));
        Self { center, extent: largest.max_element(), corners, facets }
    }

    /// The session's, built when first asked for: the views of a turntable share it.
    ///
    /// # Errors
    /// A limit of the budget.
    pub fn of(session: &Session, execution: &Execution) -> Result<Arc<Self>, Limit> {
        session.cache.get_or_build((), || Ok(Self::of_world(&session.world, &execution.workers)))
    }

    /// What coordinates are relative to: the middle of the world.
    pub fn center_of(world: &World) -> DVec3 {
        Some(world.bounds.center()).filter(|c| c.is_finite()).unwrap_or(DVec3::ZERO)
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.facets.len()
    }

    /// The box round all; empty (least above most) where there are none.
    pub(super) fn bounds(&self) -> [Vec3; 2] {
        let all = self.corners.iter().flatten();
        all.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[min, max], &p| [min.min(p), max.max(p)])
    }

    /// Whether a hit, its triangle's place and its parameter, is met before the `best` so far by a
    /// ray that leaves the facet `own`: of equally near ones the lower facet is.
    #[inline(always)]
    pub(super) fn replaces(
        &self,
        best: Option<(usize, f32)>,
        (place, t): (usize, f32),
        own: u32,
    ) -> bool {
        let facet = self.facets[place];
        facet != own
            && best
                .is_none_or(|(p, nearest)| t < nearest || (t == nearest && facet < self.facets[p]))
    }

    /// The same triangles in another order.
    pub(super) fn reordered(&self, order: impl ExactSizeIterator<Item = u32> + Clone) -> Self {
        let corners = order.clone().map(|i| self.corners[i as usize]).collect();
        Self { corners, facets: order.map(|i| self.facets[i as usize]).collect(), ..*self }
    }
}

/// An instance's finite triangles, relative to `center`.
fn placed(world: &World, index: usize, center: DVec3) -> Vec<(u32, [Vec3; 3])> {
    let instance = &world.instances[index];
    let place = |p: &[f32; 3]| {
        let p = DVec3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2]));
        let p = instance.world_from_model.transform_point3(p) - center;
        vec3(p.x as f32, p.y as f32, p.z as f32)
    };
    let positions: Vec<Vec3> = instance.mesh.positions.iter().map(place).collect();
    let triangles = (instance.first_facet..).zip(&instance.mesh.triangles);
    let triangles = triangles.map(|(facet, t)| (facet, t.map(|i| positions[i as usize])));
    triangles.filter(|(_, t)| t.iter().all(|p| p.is_finite())).collect()
}
