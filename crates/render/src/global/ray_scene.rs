//! The scene as rays see it: what they meet, from which side, in which medium they are, and what
//! they see beyond.
//!
//! Places are in world space less the scene's middle.

use super::coincident::{CoincidentGroups, unit_normal};
use super::media::Media;
use super::rays::Branch;
use super::sky::Sky;
use super::surface::HitSurface;
use crate::prepare::mirrors;
use crate::raytrace::Visitor;
use crate::raytrace::beam::Beam;
use crate::raytrace::intersect::Ray;
use crate::raytrace::structures::AnyStructure;
use crate::raytrace::triangles::Triangles;
use crate::shading::{FrameConstants, Hit};
use crate::shadow::{SurfacePoint, clearance, facet, weighted, weights};
use vitral_exec::Workers;
use vitral_math::{DMat3, DVec3, Vec3, dvec3};
use vitral_scene::bodies::Side;

/// A direction that is in no simple ratio to the axes.
const ASKEW: Vec3 = Vec3::new(0.531_7, 0.681_9, 0.502_3);

/// See the module.
pub(super) struct RayScene<'a> {
    pub(super) constants: &'a FrameConstants<'a>,
    pub(super) structure: AnyStructure,
    /// They find the bodies of a mesh when it is first met.
    workers: &'a Workers,
    sky: Sky,
    /// World to view directions.
    view_from_world: DMat3,
    /// Width of a pixel at the distance 1, or everywhere for parallel rays.
    pixel: f64,
}

impl<'a> RayScene<'a> {
    pub(super) fn new(
        constants: &'a FrameConstants<'a>,
        structure: AnyStructure,
        workers: &'a Workers,
    ) -> Self {
        let view = constants.view;
        let stretch = view.view.clip_from_view.col(1).y;
        Self {
            constants,
            structure,
            workers,
            sky: Sky {
                stretch,
                middle: -view.view.clip_from_view.z_axis.y,
                perspective: view.view.perspective,
            },
            view_from_world: DMat3::from_mat4(view.view.view_from_world),
            pixel: 2.0 / (stretch * f64::from(view.viewport.height)),
        }
    }

    /// What the eye is in: what a ray to it from afar enters and does not leave. In a parallel view
    /// it is far away.
    pub(super) fn surroundings(&self) -> Media {
        let (eye, perspective) = self.constants.view.eye();
        let eye = (eye - self.structure.triangles().center).as_vec3();
        if !perspective || eye.abs().max_element() > self.structure.triangles().extent {
            return Media::default();
        }
        // Backwards, in a direction that no model has edges in.
        let ray = Ray::new(eye, ASKEW);
        let mut hits = Hits { triangles: self.structure.triangles(), ray: &ray, hits: Vec::new() };
        self.structure.traverse(&Beam::around(&ray, self.structure.triangles().extent), &mut hits);
        hits.hits.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
        hits.hits.dedup();
        let towards = -ASKEW.as_dvec3();
        let crossing = |&(_, facet): &(f32, u32)| self.crossing(facet, self.seen(towards, facet).1);
        Media::around(hits.hits.iter().filter_map(crossing))
    }

    /// The direction in which the eye sees a place, and how far away it is.
    pub(super) fn eye_ray(&self, position: DVec3) -> (DVec3, f64) {
        let (eye, perspective) = self.constants.view.eye();
        if !perspective {
            return (-self.view_from_world.row(2), 1.0);
        }
        let way = position - (eye - self.structure.triangles().center);
        let distance = way.length();
        (way / distance, distance)
    }

    /// The corners of a facet, and whether a ray in this direction comes from the side from which
    /// they run clockwise, in the world.
    #[inline]
    pub(super) fn seen(&self, direction: DVec3, number: u32) -> ([DVec3; 3], bool) {
        let world = &self.constants.view.session.world;
        let instance = &world.instances[world.instance_of_facet(number)];
        let (corners, outward) =
            facet(instance, number - instance.first_facet, self.structure.triangles().center);
        let from_behind = (outward.dot(direction) > 0.0) != mirrors(&instance.world_from_model);
        (corners, from_behind)
    }

    /// The pile that a ray in this direction meets at a position on a facet, see
    /// [`CoincidentGroups::add`].
    #[cold]
    pub(super) fn pile_at(
        &self,
        piles: &mut CoincidentGroups,
        (number, corners): (u32, [DVec3; 3]),
        position: DVec3,
        direction: DVec3,
        is_first: bool,
    ) -> Option<u32> {
        let normal = unit_normal(&corners).unwrap_or_default();
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        piles.add(&self.structure, (number, corners), (position, normal), is_first)
    }

    /// A ray that meets the triangle at this place of the structure's triangles, at `position`, and
    /// whether it comes from behind.
    #[inline]
    pub(super) fn meet(&self, branch: &Branch, place: usize, position: DVec3) -> (Hit, bool) {
        let triangles = self.structure.triangles();
        let (corners, facet) = (&triangles.corners[place], triangles.facets[place]);

        // The weights of the corners where the ray meets the facet; then the place anew, which lies
        // in its plane.
        let weights = weights(corners, position).map(|w| w.clamp(0.0, 1.0));
        let sum: f32 = weights.iter().sum();
        let weights = weights.map(|w| w / sum);
        let corners = corners.map(|c| c.as_dvec3());
        let position = weighted(&corners, weights);
        let across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let normal = across.normalize_or_zero();
        let from_behind = normal.dot(branch.direction) > 0.0;
        let normal = if from_behind { -normal } else { normal };

        // The footprint of the pixel: round the ray, stretched by the slant of the facet.
        let perspective = self.constants.view.view.perspective;
        let distance =
            if perspective { branch.travelled + branch.origin.distance(position) } else { 1.0 };
        let cos = -normal.dot(branch.direction);
        let along = (branch.direction + normal * cos)
            .try_normalize()
            .unwrap_or(normal.any_orthonormal_vector());
        let width = self.pixel * distance;
        let ways = [normal.cross(along) * width, along * (width / cos.max(0.05))];
        let whole = across.length_squared();
        let slope = |corner: usize, way: DVec3| {
            let edge = corners[(corner + 1) % 3] - corners[(corner + 2) % 3];
            if whole > 0.0 { (way.cross(edge).dot(across) / whole) as f32 } else { 0.0 }
        };
        let along_edges = |k: usize| [weights[k], slope(k, ways[0]), slope(k, ways[1])];
        let weights = [along_edges(0), along_edges(1), along_edges(2)];
        let origin = self
            .constants
            .view
            .view
            .view_from_world
            .transform_point3(branch.origin + triangles.center);
        let seed = branch.seed.wrapping_mul(0x2c92_77b5).wrapping_add(0xac56_4b05);
        let place = SurfacePoint { position, normal, facet, seed, pixel: None };
        (Hit { weights, origin: origin.as_vec3().to_array(), place, row: branch.row }, from_behind)
    }

    /// The surface on the ray's side.
    pub(super) fn surface(
        &self,
        ray: &Branch,
        normal: [f32; 3],
        place: &SurfacePoint,
    ) -> HitSurface {
        let [x, y, z] = normal.map(f64::from);
        let shading = (self.view_from_world.transpose() * dvec3(x, y, z)).normalize_or_zero();
        let facet =
            if place.normal.dot(ray.direction) > 0.0 { -place.normal } else { place.normal };
        // A shading normal that the ray cannot see is of no use.
        let usable = |n: DVec3| n.dot(ray.direction) < -1e-4;
        let n = [shading, -shading].into_iter().find(|n| usable(*n)).unwrap_or(facet);
        HitSurface { n, facet }
    }

    /// The exponent with which a facet scatters what passes it, if it does.
    pub(super) fn scatters(&self, number: u32) -> Option<f32> {
        self.material(number).and_then(|m| self.constants.material(Some(m)).scatters)
    }

    /// The exponent with which a facet blurs what it mirrors, if it does.
    pub(super) fn blurs(&self, number: u32) -> Option<f32> {
        self.material(number).and_then(|m| self.constants.material(Some(m)).blurs)
    }

    /// The material of a facet.
    fn material(&self, number: u32) -> Option<u32> {
        let world = &self.constants.view.session.world;
        let instance = &world.instances[world.instance_of_facet(number)];
        instance.mesh.material_of_triangle((number - instance.first_facet) as usize)
    }

    pub(super) fn clearance(&self, position: DVec3) -> f64 {
        clearance(position, f64::from(self.structure.triangles().extent))
    }

    /// The material of the body that a ray enters (or leaves) where it meets a facet, if it is the
    /// skin of one.
    #[inline]
    pub(super) fn crossing(&self, number: u32, from_behind: bool) -> Option<(u32, bool)> {
        let session = self.constants.view.session;
        let instance = &session.world.instances[session.world.instance_of_facet(number)];
        let triangle = (number - instance.first_facet) as usize;
        let material = instance.mesh.material_of_triangle(triangle)?;
        let side = session.sides(instance.mesh_index, self.workers)[triangle];
        if side == Side::None || self.constants.material(Some(material)).cutoff.is_some() {
            return None;
        }
        let from_outside = from_behind == mirrors(&instance.world_from_model);
        Some((material, from_outside == (side == Side::Behind)))
    }

    /// What a ray sees that meets nothing: the background of its pixel, or after a turn the image
    /// of the surroundings, if there is one.
    pub(super) fn background(&self, ray: &Branch) -> [f32; 4] {
        if let (Some(environment), None) = (&self.constants.environment, ray.row) {
            let [r, g, b] =
                environment.seen((self.view_from_world * ray.direction).as_vec3().to_array());
            return [r, g, b, 1.0];
        }
        let background = &self.constants.background;
        let beyond =
            || self.sky.row(self.view_from_world * ray.direction, background.colors.len()) as u32;
        match ray.row {
            Some(row) if ray.ground > 0.0 => background.shaded(row, ray.ground),
            Some(row) => background.color(row),
            None => background.color(beyond()),
        }
    }
}

/// Collects all hits of a ray: parameters and facets.
struct Hits<'a> {
    triangles: &'a Triangles,
    ray: &'a Ray,
    hits: Vec<(f32, u32)>,
}

impl Visitor for Hits<'_> {
    fn skips(&self, _: usize, _: f32) -> bool {
        false
    }

    fn done(&self, _: f32) -> bool {
        false
    }

    fn triangle(&mut self, place: usize) {
        let hit = self.ray.hit(&self.triangles.corners[place]);
        self.hits.extend(hit.map(|t| (t, self.triangles.facets[place])));
    }
}
