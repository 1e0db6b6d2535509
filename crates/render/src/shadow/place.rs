//! From points of the picture to places in the world.
//!
//! A point is a facet and weights of its corners. The same weights of the corners in the world, as rays see them, give a
//! place that lies in the facet's plane but for the last bit of a double: much nearer than the way back from the screen.

use super::Place;
use crate::PreparedView;
use crate::prepare::mirrors;
use crate::raytrace::triangles::Triangles;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F64x8, LANES, Simd};
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
    let (point, sum) = weighed(corners, weights);
    point / sum
}

/// The same times the sum of the weights, and this sum.
#[inline(always)]
fn weighed(corners: &[DVec3; 3], weights: [f32; 3]) -> (DVec3, f64) {
    let w = [f64::from(weights[0]), f64::from(weights[1]), f64::from(weights[2])];
    (corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2], w[0] + w[1] + w[2])
}

/// What all points of an object have in common.
pub(crate) struct Placing<'a> {
    view: &'a PreparedView<'a>,
    instance: &'a Instance,
    mirrored: bool,
    /// Normals turn to the viewer.
    turns: bool,
    center: DVec3,
}

impl<'a> Placing<'a> {
    /// For points of an instance, both sides of which are seen if it `turns`.
    pub(crate) fn new(view: &'a PreparedView<'a>, instance: &'a Instance, turns: bool) -> Self {
        let center = Triangles::center_of(&view.session.world);
        Self { view, instance, mirrored: mirrors(&instance.world_from_model), turns, center }
    }

    /// A triangle of its mesh.
    pub(crate) fn facet(&self, triangle: u32) -> Facet {
        oriented(self.instance, triangle, self.center, self.mirrored)
    }

    /// Eight points of such triangles: the corners' weights, and where they are on the screen.
    #[inline(always)]
    pub(crate) fn places<S: Simd>(
        &self,
        simd: S,
        (triangles, facets): (&[u32; LANES], [&Facet; LANES]),
        weights: &[[f32; LANES]; 3],
        screen: [&[f32; LANES]; 2],
    ) -> [Place; LANES] {
        // Divisions are what takes long.
        let (mut sums, mut positions) = ([1.0; LANES], [[0.0; LANES]; 3]);
        for (lane, (corners, _)) in facets.iter().enumerate() {
            let (point, sum) = weighed(corners, [weights[0][lane], weights[1][lane], weights[2][lane]]);
            (positions[0][lane], positions[1][lane], positions[2][lane]) = (point.x, point.y, point.z);
            sums[lane] = sum;
        }
        let sums = F64x8::from_slice(simd, &sums);
        for axis in &mut positions {
            (F64x8::from_slice(simd, axis) / sums).store_slice(axis);
        }
        let [x, y, z] = positions;
        std::array::from_fn(|lane| {
            let position = dvec3(x[lane], y[lane], z[lane]);
            self.place(triangles[lane], facets[lane].1, position, [screen[0][lane], screen[1][lane]])
        })
    }

    fn place(&self, triangle: u32, outward: DVec3, position: DVec3, screen: [f32; 2]) -> Place {
        let behind = self.turns && {
            let (eye, perspective) = self.view.eye();
            let parallel = || self.view.view.view_from_world.row(2).truncate();
            outward.dot(if perspective { eye - self.center - position } else { parallel() }) < 0.0
        };
        let [x, y] = screen.map(|s| (s * 256.0) as u32);
        Place {
            position,
            normal: if behind { -outward } else { outward },
            facet: self.instance.first_facet + triangle,
            seed: x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b).rotate_left(16),
            pixel: Some(screen),
        }
    }
}
