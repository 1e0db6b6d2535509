//! The maps of lights: how many each light needs, of what frusta, and what the session keeps of
//! them.

use super::draw::{FirstPass, When};
use super::lens::Lens;
use super::tiles::Map;
use crate::raytrace::triangles::Triangles;
use crate::shadow::occluders::Occluders;
use crate::shadow::sources::{Emitter, LightSource};
use crate::{Cached, ColorSpace, Execution, Session, Settings, Transparency};
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_light::{Light, LightKind};
use vitral_math::DVec3;

/// Shortest side of an area light's maps.
const LEAST_SIDE: u32 = 256;

/// What maps depend on, besides the scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LightMapsKey {
    lights: Vec<Light>,
    size: u32,
    samples: u32,
    transparency: Transparency,
    color_space: ColorSpace,
}

/// The maps of all lights, in order.
#[derive(Debug)]
pub(crate) struct Maps(pub(super) Vec<LightMaps>);

impl Cached for Maps {
    type Key = LightMapsKey;
}

/// The maps of one light.
#[derive(Debug)]
pub(super) enum LightMaps {
    /// Ambient light, or a scene without anything in it.
    Unoccluded,
    /// A light infinitely far away: the unit vector to it, and its map.
    Infinity { towards: DVec3, map: Box<Map> },
    /// Each position of a light at a finite distance, with its maps.
    Positions(Vec<(Emitter, Vec<Map>)>),
}

impl LightMapsKey {
    pub(super) fn new(lights: &[Light], settings: &Settings) -> Self {
        Self {
            lights: lights.to_vec(),
            size: settings.shadows.map_size,
            samples: settings.shadows.light_samples,
            transparency: settings.transparency.model,
            color_space: settings.picture.color_space,
        }
    }
}

impl Maps {
    /// Those that the session keeps, or new ones.
    pub(super) fn of(
        session: &Session,
        lights: &[Light],
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Arc<Self>, Limit> {
        let key = LightMapsKey::new(lights, settings);
        if let Some(old) = session.cache.take_outdated::<Self>(&key) {
            Arc::into_inner(old).into_iter().for_each(|old| old.recycle(session));
        }
        session.cache.get_or_build(key, || {
            let occluders = Occluders::new(session, settings);
            let pass = FirstPass {
                session,
                occluders: &occluders,
                settings,
                execution,
                when: When::Asked,
            };
            let maps = lights.iter().map(|light| LightMaps::new(light, pass));
            Ok(Self(maps.collect::<Result<_, Limit>>()?))
        })
    }

    /// Hands memory back to the session.
    fn recycle(self, session: &Session) {
        let mut spare = session.spare_batches.lock().expect("spare batches");
        for maps in self.0 {
            let maps = match maps {
                LightMaps::Unoccluded => Vec::new(),
                LightMaps::Infinity { map, .. } => vec![*map],
                LightMaps::Positions(places) => {
                    places.into_iter().flat_map(|(_, maps)| maps).collect()
                }
            };
            spare.extend(
                maps.into_iter().filter_map(|map| map.pending).flat_map(|pending| pending.batches),
            );
        }
    }
}

impl LightMaps {
    fn new(light: &Light, pass: FirstPass<'_>) -> Result<Self, Limit> {
        let (world, size) = (&pass.session.world, pass.settings.shadows.map_size);
        if world.bounds.is_empty() {
            return Ok(Self::Unoccluded);
        }
        let source = LightSource::new(
            light,
            pass.settings.shadows.light_samples,
            Triangles::center_of(world),
        );
        let emitters = source.places();
        // Draw one map for a parallel light or a spot, and a cube of maps for any other position.
        match source {
            LightSource::Unoccluded => Ok(Self::Unoccluded),
            LightSource::Infinity(towards) => {
                let map = Box::new(pass.draw(Lens::parallel(towards, world, size))?);
                Ok(Self::Infinity { towards, map })
            }
            LightSource::Point(at) => Ok(Self::Positions(vec![match spot_lens(light, at, pass) {
                Some(lens) => (emitters[0], vec![pass.draw(lens)?]),
                None => maps_around(emitters[0], size, pass)?,
            }])),
            LightSource::Area(_) => {
                let side = (f64::from(size) / (emitters.len() as f64).sqrt()) as u32;
                let side = side.max(LEAST_SIDE.min(size));
                let pass = FirstPass { when: When::Before, ..pass };
                let places = emitters.into_iter().map(|from| maps_around(from, side, pass));
                Ok(Self::Positions(places.collect::<Result<_, Limit>>()?))
            }
        }
    }
}

/// The lens of a spot at a point, if one is wide enough.
fn spot_lens(light: &Light, at: DVec3, pass: FirstPass<'_>) -> Option<Lens> {
    let (world, size) = (&pass.session.world, pass.settings.shadows.map_size);
    match light.kind {
        LightKind::Spot { direction, cutoff, .. } => Lens::cone(at, direction, cutoff, world, size),
        _ => None,
    }
}

/// The maps of this size round a place of a light.
fn maps_around(
    from: Emitter,
    size: u32,
    pass: FirstPass<'_>,
) -> Result<(Emitter, Vec<Map>), Limit> {
    let lenses = Lens::around(from.at.truncate(), &pass.session.world, size);
    let maps: Result<_, Limit> = lenses.into_iter().map(|lens| pass.draw(lens)).collect();
    Ok((from, maps?))
}
