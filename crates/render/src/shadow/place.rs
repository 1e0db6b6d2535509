//! From points of the picture to places in the world.
//!
//! A point is a facet and weights of its corners. The same weights of the corners in the world, as rays see them, give a
//! place that lies in the facet's plane but for the last bit of a double: much nearer than the way back from the screen.

use super::Place;
use crate::PreparedView;
use crate::prepare::mirrors;
use crate::raytrace::triangles::Triangles;
use vitral_math::lanes::LANES;
use vitral_math::{DVec3, dvec3};
use vitral_scene::Instance;

/// Corners and unit normal of a facet.
pub(crate) type Facet = ([DVec3; 3], DVec3);

/// The corners of an instance's triangle, world space less `center`, as the rays' triangles have them, and its unit normal
/// on the side from which they run counter-clockwise in the model; zero without area.
pub(crate) fn facet(instance: &Instance, triangle: u32, center: DVec3) -> Facet {
    oriented(instance, triangle, center, mirrors(&instance.world_from_model))
}

/// The same for an instance of which it is known whether it is `mirrored`.
fn oriented(instance: &Instance, triangle: u32, center: DVec3, mirrored: bool) -> Facet {
    let mesh = &instance.mesh;
    let corner = |i: u32| {
        let [x, y, z] = mesh.positions[i as usize];
        let p = dvec3(f64::from(x), f64::from(y), f64::from(z));
        (instance.world_from_model.transform_point3(p) - center).as_vec3().as_dvec3()
    };
    let [a, b, c] = mesh.triangles[triangle as usize];
    let corners = [corner(a), corner(b), corner(c)];
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
    (corners, if mirrored { -normal } else { normal })
}

/// The point with these weights of the corners.
pub(crate) fn weighted(corners: &[DVec3; 3], weights: [f32; 3]) -> DVec3 {
    let w = [f64::from(weights[0]), f64::from(weights[1]), f64::from(weights[2])];
    (corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2]) / (w[0] + w[1] + w[2])
}

/// What all points of an object have in common.
pub(crate) struct Placing<'a> {
    view: &'a PreparedView<'a>,
    instance: &'a Instance,
    /// Normals turn to the viewer.
    turns: bool,
    center: DVec3,
}

/// Places of up to eight points of an object: the triangles of its mesh, the corners' weights, where they are on the
/// screen. Both sides of the object are seen if it `turns`.
pub(crate) fn places(
    view: &PreparedView<'_>,
    instance: &Instance,
    turns: bool,
    triangles: &[u32; LANES],
    weights: [[f32; LANES]; 3],
    screen: [&[f32; LANES]; 2],
) -> [Place; LANES] {
    let center = Triangles::center_of(&view.session.world);
    let placing = Placing { view, instance, turns, center };
    // Neighbours mostly lie on one facet.
    let mirrored = mirrors(&instance.world_from_model);
    let mut last = (triangles[0], oriented(instance, triangles[0], center, mirrored));
    std::array::from_fn(|lane| {
        if last.0 != triangles[lane] {
            last = (triangles[lane], oriented(instance, triangles[lane], center, mirrored));
        }
        let weights = [weights[0][lane], weights[1][lane], weights[2][lane]];
        let [x, y] = screen.map(|s| (s[lane] * 256.0) as u32);
        let seed = x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b).rotate_left(16);
        placing.place(&last, weights, seed, Some(screen.map(|s| s[lane])))
    })
}

impl Placing<'_> {
    fn place(
        &self,
        &(triangle, (corners, outward)): &(u32, Facet),
        weights: [f32; 3],
        seed: u32,
        pixel: Option<[f32; 2]>,
    ) -> Place {
        let position = weighted(&corners, weights);
        let (eye, perspective) = self.view.eye();
        let towards =
            if perspective { eye - self.center - position } else { self.view.view.view_from_world.row(2).truncate() };
        let behind = self.turns && outward.dot(towards) < 0.0;
        let facet = self.instance.first_facet + triangle;
        Place { position, normal: if behind { -outward } else { outward }, facet, seed, pixel }
    }
}
