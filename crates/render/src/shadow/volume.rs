//! Shadow volumes: the space that a triangle hides from a light is a solid without end, and a place
//! is in shadow if it lies in one.
//!
//! A triangle's volume has the triangle for its near cap, three sides that run through its edges
//! away from the light, and its shadow at infinity for its far cap. How many volumes a place is in
//! is counted along a path from somewhere known: plus one where the path enters through a polygon
//! of a volume, minus one where it leaves. Two triangles that share an edge have the side there in
//! common. If one turns the same way from it as the other, the two sides add up: a *silhouette
//! edge*. If not, one leaves where the other enters, and both are dropped. The sum is the edge's
//! *multiplicity*; it is ±1 along an open border, and any number where more than two triangles
//! meet, so no mesh has to be closed.
//!
//! *Z-pass* counts from the viewer to the visible point, beginning with the number of volumes that
//! the viewer is in. *Z-fail* counts from infinity beyond it, beginning with the far caps. Both
//! give the number at any place, and need it only once for a batch of neighbours: from there on,
//! the path goes to the others. The batch is cut in two again and again, and each half keeps the
//! polygons that touch the box round its places; where none is left, all have the same number.
//! Polygons are homogeneous (the sides end at points with `w = 0`) and nothing is clipped, so no
//! near plane can cut a volume open.
//!
//! Signs of determinants decide whether a path meets a polygon. What two polygons share, an edge or
//! the ray from a corner to infinity, gives both the same number, so no path slips between them.
//! Places are lifted off their facets as those of rays are. Transparent triangles keep a volume of
//! their own each, and take their part of the light.
//!
//! In:   lights, triangles and places, world space less the scene's middle. Out: the part of a
//!       light that arrives.
//! Cost: linear in triangles for each light; for a batch, the polygons near it, and each again for
//!       the halves it touches.
//! Source: [Crow 1977]; z-fail after [Everitt & Kilgard 2002], multiplicities after [Bergeron
//! 1986], regions with one count after [Aila & Akenine-Möller 2004]. Departs from them: counts go
//! from place to place, not pixel by pixel.

mod count;
mod edges;
mod light_volumes;
mod paths;

use super::casters::{Casters, faces, lifted};
use super::occluders::Occluders;
use super::places::{LightVisibility, SurfacePoints};
use super::sources::{LightSource, Shares};
use super::{Drawn, PreparedShadows, ShadowAlgorithm, ShadowKey};
use crate::{Cached, Execution, Session, Settings, VolumeCounting};
use count::{Batch, Lit, ODD};
pub(crate) use edges::CasterSurface;
use light_volumes::LightVolumes;
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_light::Light;
use vitral_math::DVec4;
use vitral_math::lanes::Level;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct VolumeShadows;

/// The volumes of all lights.
#[derive(Debug)]
pub(crate) struct Volumes {
    casters: Arc<Casters>,
    surface: Arc<CasterSurface>,
    lights: Vec<Vec<LightVolumes>>,
}

/// The volumes, and where a viewer's paths begin.
struct Counting<'a> {
    volumes: Arc<Volumes>,
    occluders: Occluders<'a>,
    level: Level,
    counting: VolumeCounting,
    /// Less the scene's middle; a little beside the true one, lest a light there lie on every path.
    viewer: DVec4,
    /// How many volumes of each place of each light the viewer is in.
    around_viewer: Vec<Vec<i32>>,
}

impl ShadowAlgorithm for VolumeShadows {
    fn prepare<'a>(
        &self,
        session: &'a Session,
        lights: &[Light],
        viewer: DVec4,
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Box<dyn PreparedShadows + 'a>, Limit> {
        let occluders = Occluders::new(session, settings);

        // Build the volumes, or take them from the cache.
        let volumes = session.cache.get_or_build(ShadowKey::new(lights, settings), || {
            Volumes::new(session, lights, &occluders, settings, execution)
        })?;
        let triangles = volumes.casters.triangles();

        // Move the viewer by an odd amount, so that it lies on no side of a volume.
        let odd = ODD * (f64::from(triangles.extent) * 1e-4);
        let viewer = if viewer.w > 0.0 {
            (viewer.truncate() - triangles.center + odd).extend(1.0)
        } else {
            (viewer.truncate() + ODD * 1e-4).extend(0.0)
        };

        // Count the volumes around the viewer, once for each position of the light.
        let counting = settings.shadows.volume_counting.unwrap_or_default();
        let around_viewer = volumes.lights.iter().map(|places| {
            let around = |l: &LightVolumes| match counting {
                VolumeCounting::ZPass => volumes.lit(l).around(viewer),
                VolumeCounting::ZFail => 0,
            };
            places.iter().map(around).collect()
        });
        let around_viewer = around_viewer.collect();
        Ok(Box::new(Counting {
            volumes,
            occluders,
            level: execution.level,
            counting,
            viewer,
            around_viewer,
        }))
    }
}

impl Cached for Volumes {
    type Key = ShadowKey;
}

impl Volumes {
    fn new(
        session: &Session,
        lights: &[Light],
        occluders: &Occluders<'_>,
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Self, Limit> {
        let casters = Casters::of(session, occluders, execution)?;
        let surface = session.cache.get_or_build(occluders.key(), || {
            CasterSurface::new(&session.world, &casters, execution)
        })?;
        let triangles = casters.triangles();
        let of_light = |light: &Light| -> Result<Vec<LightVolumes>, Limit> {
            let places =
                LightSource::new(light, settings.shadows.light_samples, triangles.center).places();
            places
                .into_iter()
                .map(|place| LightVolumes::new(place, triangles, &surface, execution))
                .collect()
        };
        let lights: Result<_, Limit> = lights.iter().map(of_light).collect();
        Ok(Self { lights: lights?, surface, casters })
    }

    fn lit<'a>(&'a self, volumes: &'a LightVolumes) -> Lit<'a> {
        Lit { volumes, casters: &self.casters, planes: &self.surface.planes }
    }
}

impl PreparedShadows for Counting<'_> {
    fn light_visibility(
        &self,
        light: usize,
        places: &SurfacePoints,
        parts: &mut LightVisibility,
        _: &mut u64,
    ) {
        let volumes = &self.volumes.lights[light];
        if volumes.is_empty() {
            return parts.fill([1.0; 3]);
        }
        parts.fill([0.0; 3]);
        let mut batch = Batch::default();
        // Count the volumes around all places that face the position of the light.
        for (place_of_light, &around_viewer) in volumes.iter().zip(&self.around_viewer[light]) {
            // Attached shadows, and a light in the facet's plane, need no count.
            let (from, extent) = (place_of_light.from, self.volumes.casters.extent());
            let light = from.at;
            let asked = places.iter().enumerate().filter(|(_, p)| faces(p, light));
            batch.reset(asked.map(|(i, p)| (i as u32, lifted(&p, extent))));

            // Add what arrives where the count says that no volume holds the place.
            let lit = self.volumes.lit(place_of_light);
            let start = (self.counting, self.viewer, around_viewer);
            batch.count(self.level, &lit, start, |index, at, count, filters| {
                if count <= 0 {
                    let place = places.get(index);
                    let passing = self.volumes.casters.filtered(
                        &self.occluders,
                        light,
                        place.facet,
                        at,
                        filters,
                    );
                    parts.add(index, from.weight(&place), passing);
                }
            });
        }

        // Divide by the weights of all positions.
        Shares::normalize(volumes.iter().map(|v| v.from), places, parts);
    }

    fn draw(&self, take: &mut dyn FnMut(Drawn<'_>)) {
        let triangles = self.volumes.casters.triangles();
        for (light, places) in self.volumes.lights.iter().enumerate() {
            places
                .iter()
                .for_each(|place| place.draw(light, &self.volumes.casters, triangles, take));
        }
    }
}
