//! Ambient occlusion: how much of the light from everywhere reaches a point past what stands near.
//!
//! The ambient term of the illumination models takes light from all sides for granted. In a corner,
//! a fold or under an overhang most of it is kept away, and without that everything floats. So rays
//! go from the point in directions over its facet, more of them straight up than aside (by the
//! cosine, as matt surfaces gather light), and the ambient light is weakened by those that meet
//! something. Distant surfaces count less: rays have all lengths up to a radius, so that the
//! weight of an occluder falls linearly to 0 there, and closed rooms are not black.
//!
//! The hemisphere is cut into cells with a ray in each; chance is a hash of the place in the
//! picture, so a picture is the same whatever algorithm found its surfaces, and on however many
//! threads.
//!
//! In:   points on facets, world space less the scene's middle. Out: the part of ambient light that
//!       arrives, `0..=1`.
//! Cost: a fixed number of rays a point, about `O(log n)` each.
//! Source: \[Zhukov, Iones & Kronin 1998\]; the cells are those of \[Cook, Porter & Carpenter
//! 1984\]. Departs from it: transparent things let through what they let through of other light.

use super::grey;
use super::hash::hash;
use super::light_rays::LightRays;
use super::places::{SurfacePoint, SurfacePoints};
use super::scattering::Strata;
use crate::{Execution, Session, Settings};
use vitral_exec::Limit;
use vitral_math::DVec3;

/// Exponent of the cosine by which a matt surface gathers light.
const COSINE: f32 = 1.0;
/// The radius where none is chosen, in radii of the scene's bounding sphere. Chosen by eye: folds
/// and feet darken, halls do not.
pub(super) const RADIUS: f64 = 0.5;
/// Steps of the golden ratio, in parts of 2^32, spread the rays' lengths evenly.
const GOLDEN: u32 = 0x9e37_79b9;

/// See the module.
pub(crate) struct AmbientOcclusion<'a> {
    rays: LightRays<'a>,
    strata: Strata,
    radius: f64,
}

impl<'a> AmbientOcclusion<'a> {
    /// That of a picture; `None` if it is not wanted.
    ///
    /// # Errors
    /// A limit of the budget.
    pub(crate) fn new(
        session: &'a Session,
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Option<Self>, Limit> {
        let shading = &settings.shading;
        let Some(count) = shading.ambient_occlusion.filter(|_| shading.lighting) else {
            return Ok(None);
        };
        let radius = shading.occlusion_radius;
        let radius =
            radius.unwrap_or_else(|| RADIUS * session.world.bounds.bounding_sphere().radius);
        let pixels = u64::from(settings.picture.width) * u64::from(settings.picture.height);
        Self::with(session, (settings, execution), (count, radius), pixels * u64::from(count))
            .map(Some)
    }

    /// That of any points: `count` rays of each within `radius`, `rays` in all.
    ///
    /// # Errors
    /// A limit of the budget.
    pub(super) fn with(
        session: &'a Session,
        (settings, execution): (&Settings, &Execution),
        (count, radius): (u32, f64),
        rays: u64,
    ) -> Result<Self, Limit> {
        let rays = LightRays::new(
            session,
            settings,
            execution,
            (rays, "ambient occlusion without a structure"),
        )?;
        Ok(Self { rays, strata: Strata::new(count), radius })
    }

    /// The part of ambient light that reaches each of the places. Adds the rays that it took.
    pub(crate) fn open(&self, places: &SurfacePoints, rays: &mut u64) -> Vec<f32> {
        let (mut feelers, mut passing) = (Vec::new(), vec![[0.0; 3]; self.strata.count() as usize]);
        let of_place = |place: SurfacePoint| {
            passing.fill([1.0; 3]);
            self.rays.transmittance(&mut feelers, self.ways(&place), true, &mut passing);
            *rays += feelers.len() as u64;
            passing.iter().map(|&part| grey(part)).sum::<f32>() / passing.len() as f32
        };
        places.iter().map(of_place).collect()
    }

    /// The ways of a place's rays. Those that end before they have left the surface meet nothing,
    /// and are left out. A facet without area has no side, and no rays.
    fn ways(&self, place: &SurfacePoint) -> impl Iterator<Item = (SurfacePoint, DVec3)> {
        let (place, strata, radius, rays) = (*place, self.strata, self.radius, &self.rays);
        let first = hash(place.seed);
        let ways = (0..strata.count()).map(move |i| {
            let direction = strata.direction(i, first, COSINE, place.normal);
            let length = first.wrapping_add(GOLDEN.wrapping_mul(i));
            direction * (radius * (f64::from(length) + 0.5) / 4_294_967_296.0)
        });
        let leaves = move |way: &DVec3| place.normal.dot(*way) > rays.least_height(&place, *way);
        ways.filter(leaves).map(move |way| (place, way))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use vitral_math::DMat4;
    use vitral_scene::builtin::solids;
    use vitral_scene::{Mesh, Scene};

    /// The part that reaches the middle of a floor with something above it.
    fn open(above: Mesh, lift: f64, radius: f64) -> f32 {
        let mut scene = Scene::default();
        scene.add_mesh(
            solids::cuboid(DVec3::new(200.0, 1.0, 200.0)),
            DMat4::from_translation(DVec3::Y * -0.5),
        );
        scene.add_mesh(above, DMat4::from_translation(DVec3::Y * lift));
        let session = Session::new(Arc::new(scene)).unwrap();
        let mut settings = Settings::default();
        (settings.shading.ambient_occlusion, settings.shading.occlusion_radius) =
            (Some(4096), Some(radius));
        let occlusion =
            AmbientOcclusion::new(&session, &settings, &Execution::default()).unwrap().unwrap();
        let floor = (0..12u32).find(|&f| {
            let (corners, normal) =
                super::super::facet(&session.world.instances[0], f, occlusion.rays.center());
            normal.normalize().y > 0.9
                && corners.iter().any(|c| c.y + occlusion.rays.center().y > -0.1)
        });
        let position = DVec3::new(0.01, 0.0, 0.02) - occlusion.rays.center();
        let place = SurfacePoint {
            position,
            normal: DVec3::Y,
            facet: floor.unwrap(),
            seed: 7,
            pixel: None,
        };
        let mut rays = 0;
        let part = occlusion.open(&SurfacePoints::from_iter([place]), &mut rays)[0];
        let followed = occlusion.ways(&place).count() as u64;
        assert!(rays == followed && followed > 4000, "{rays}, {followed}");
        part
    }

    #[test]
    fn a_plate_above_keeps_away_what_its_solid_angle_says() {
        // A square of side 2a at the height h fills a part of the hemisphere, weighted by the
        // cosine, of 4/π X/√(1+X²) atan(X/√(1+X²)) with X = a/h (the configuration factor of a
        // parallel rectangle). Radii much larger than the distance leave all of that.
        let factor = |x: f64| {
            let s = x / (1.0 + x * x).sqrt();
            4.0 / std::f64::consts::PI * s * vitral_math::func::atan2(s, 1.0)
        };
        for (half, lift) in [(1.0, 1.0), (0.5, 2.0), (4.0, 1.0)] {
            let plate = solids::cuboid(DVec3::new(2.0 * half, 0.002, 2.0 * half));
            let part = open(plate, lift, 1e7);
            let expected = 1.0 - factor(half / (lift - 0.001)) as f32;
            assert!((part - expected).abs() < 0.01, "{half} at {lift}: {part} for {expected}");
        }
    }

    #[test]
    fn what_is_beyond_the_radius_keeps_nothing_away() {
        let plate = || solids::cuboid(DVec3::new(100.0, 0.002, 100.0));
        assert_eq!(open(plate(), 2.0, 1.9), 1.0);
        assert!(open(plate(), 2.0, 1e7) < 0.01);
        // Straight up at half the radius: half of it.
        let small = open(solids::cuboid(DVec3::new(4.0, 0.002, 4.0)), 10.0, 20.0);
        let whole = open(solids::cuboid(DVec3::new(4.0, 0.002, 4.0)), 10.0, 1e7);
        assert!(((1.0 - small) / (1.0 - whole) - 0.5).abs() < 0.06, "{small} {whole}");
    }
}
