//! Shadow maps: the z-buffer algorithm twice. First from the light, which leaves at each texel how far the nearest thing is;
//! then from the viewer, and a visible point is lit if nothing nearer to the light is in its texel.
//!
//! The first pass computes depths alone, and the second asks only about points that are seen. The maps belong to the
//! lights and the scene, not to the viewer: a session keeps them over a turntable.
//!
//! Texels are coarser than pixels, and a lit surface must not find itself in its own way (*acne*), nor may it be moved so far
//! that its shadow loosens from its foot (*peter-panning*). So the depth that is compared is not the point's own but that of
//! its facet's plane in the middle of the texel, which takes a slope exactly into account; what is left, the rounding of
//! corners to 1/256 texel, grows with the slope (*slope-scaled bias*). And because the texel's middle may lie on a neighbour
//! that rises towards the light, the point is lifted by half a texel along its normal (*normal bias*). Four texels round the
//! point are compared one by one, and the answers are blended (*percentage-closer filtering*), but for those in which the
//! light sees something far behind: the surface does not reach there.
//!
//! A parallel light has one map, fitted to the scene. A point's map is fitted likewise where the scene fills a cone before
//! it; else it has six, the faces of a cube. A spot has the one that fits its cone. An area light has maps at several of its
//! places. Transparent things are kept as lists at their texels, with the part of each colour of light that passes. In large scenes, one
//! map may be joined by sharper ones for what is near the viewer (`map/cascade.rs`), as many as `shadow_cascades` says.
//!
//! In:   lights, scene. Out: the part of a light that arrives at a place.
//! Cost: a z-buffer pass for each map; a question is a constant number of texels. 4 bytes a texel.
//! Source: [Williams 1978]; filtering after [Reeves, Salesin & Cook 1987], area lights after [Brotman & Badler 1984].

mod cascade;
mod draw;
mod lens;
mod lookup;
mod slice;
#[cfg(test)]
mod testing;

use super::casters::faces;
use super::occluders::Occluders;
use super::sources::{Emitter, Shares, Source};
use super::{Parts, Place, Places, ShadowAlgorithm, Shadows};
use crate::raytrace::triangles::Triangles;
use crate::{Cached, ColorSpace, Execution, PreparedView, Reuse, Session, Settings, Transparency};
use cascade::Cascades;
use draw::When;
use lens::Lens;
use std::sync::{Arc, OnceLock};
use vitral_exec::Limit;
use vitral_light::{Light, LightKind, Rgb};
use vitral_math::lanes::Level;
use vitral_math::{DVec3, DVec4};
use vitral_raster::Batch;
use vitral_scene::ViewTransform;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct MapShadows;

/// Shortest side of an area light's maps.
const LEAST_SIDE: u32 = 256;
/// How far a point is lifted along its normal, in texels.
const LIFT: f64 = 0.5;
/// How far behind a point's plane a surface may be and still count as its own, in texels.
const BEYOND: f64 = 2.0;
/// Error of a texel's depth for each texel of depth that the plane rises over a texel: corners are rounded to 1/256
/// texel, and two roundings may add up.
const SLOPE_BIAS: f64 = 1.0 / 64.0;
/// Relative error of a depth.
const DEPTH_BIAS: f64 = 1.0 / (1 << 19) as f64;

/// What maps depend on, besides the scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Key {
    lights: Vec<Light>,
    size: u32,
    samples: u32,
    transparency: Transparency,
    color_space: ColorSpace,
}

/// What cascades depend on, besides the scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CascadesKey {
    maps: Key,
    count: u32,
    view: ViewTransform,
}

/// The maps of all lights, in order.
#[derive(Debug)]
pub(crate) struct Maps(Vec<LightMaps>);

#[derive(Debug)]
enum LightMaps {
    Unhindered,
    Infinity {
        towards: DVec3,
        map: Box<Map>,
    },
    /// Each place of a light with its maps.
    Places(Vec<(Emitter, Vec<Map>)>),
}

/// What the light sees through one lens.
#[derive(Debug)]
struct Map {
    lens: Lens,
    /// Tiles in a row.
    columns: usize,
    tiles: Vec<OnceLock<MapTile>>,
    /// What tiles that are not there yet are drawn from; without it, nothing is in them.
    pending: Option<Pending>,
}

/// Opaque triangles of a map.
#[derive(Debug)]
struct Pending {
    batches: Vec<Batch>,
    level: Level,
}

/// What the light sees in a tile.
#[derive(Debug, Default)]
struct MapTile {
    /// Distance of the nearest opaque thing along the axis, ∞ where there is none; empty if there is none at all.
    depth: Vec<f32>,
    /// Transparent things, sorted by texel.
    layers: Vec<Layer>,
}

/// A transparent thing at a texel.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layer {
    /// Within the tile.
    texel: u32,
    depth: f32,
    /// The part of each colour of light that passes.
    passing: Rgb,
}

impl Cached for Maps {
    type Key = Key;
}

impl Cached for Cascades {
    type Key = CascadesKey;
    const REUSE: Reuse = Reuse::View;
}

impl ShadowAlgorithm for MapShadows {
    fn prepare<'a>(
        &self,
        session: &'a Session,
        lights: &[Light],
        _: DVec4,
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Box<dyn Shadows + 'a>, Limit> {
        let maps = Maps::of(session, lights, settings, execution)?;
        Ok(Box::new(Prepared { maps, cascades: None, level: execution.level }))
    }

    fn prepare_for<'a>(
        &self,
        view: &PreparedView<'a>,
        lights: &[Light],
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Box<dyn Shadows + 'a>, Limit> {
        let session = view.session;
        let maps = Maps::of(session, lights, settings, execution)?;
        let (count, size) = (settings.shadow_cascades, settings.shadow_map_size);
        if count < 2 {
            return Ok(Box::new(Prepared { maps, cascades: None, level: execution.level }));
        }
        let key = CascadesKey { maps: Key::new(lights, settings), count, view: view.view };
        let cascades = session.cache.get_or_build(key, || {
            let occluders = Occluders::new(session, settings);
            let draw = |lens: Lens| Map::draw(lens, session, &occluders, settings, execution, When::Asked);
            Cascades::new(&session.world, &view.view, &maps, (count, size), draw)
        })?;
        Ok(Box::new(Prepared { maps, cascades: Some(cascades), level: execution.level }))
    }
}

impl Key {
    fn new(lights: &[Light], settings: &Settings) -> Self {
        Self {
            lights: lights.to_vec(),
            size: settings.shadow_map_size,
            samples: settings.light_samples,
            transparency: settings.transparency,
            color_space: settings.color_space,
        }
    }
}

impl Maps {
    /// Those that the session keeps, or new ones.
    fn of(session: &Session, lights: &[Light], settings: &Settings, execution: &Execution) -> Result<Arc<Self>, Limit> {
        let key = Key::new(lights, settings);
        if let Some(old) = session.cache.take_outdated::<Self>(&key) {
            Arc::into_inner(old).into_iter().for_each(|old| old.recycle(session));
        }
        session.cache.get_or_build(key, || {
            let occluders = Occluders::new(session, settings);
            let maps = lights.iter().map(|l| LightMaps::new(l, session, &occluders, settings, execution));
            Ok(Self(maps.collect::<Result<_, Limit>>()?))
        })
    }
}

impl Maps {
    /// Hands memory back to the session.
    fn recycle(self, session: &Session) {
        let mut spare = session.spare_batches.lock().expect("spare batches");
        for maps in self.0 {
            let maps = match maps {
                LightMaps::Unhindered => Vec::new(),
                LightMaps::Infinity { map, .. } => vec![*map],
                LightMaps::Places(places) => places.into_iter().flat_map(|(_, maps)| maps).collect(),
            };
            spare.extend(maps.into_iter().filter_map(|map| map.pending).flat_map(|pending| pending.batches));
        }
    }
}

impl LightMaps {
    fn new(
        light: &Light,
        session: &Session,
        occluders: &Occluders<'_>,
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Self, Limit> {
        let world = &session.world;
        if world.bounds.is_empty() {
            return Ok(Self::Unhindered);
        }
        let source = Source::new(light, settings.light_samples, Triangles::center_of(world));
        let when = if matches!(source, Source::Area(_)) { When::Before } else { When::Asked };
        let draw = |lens: Lens| Map::draw(lens, session, occluders, settings, execution, when);
        let size = settings.shadow_map_size;
        let around = |from: Emitter, size: u32| -> Result<(Emitter, Vec<Map>), Limit> {
            let lenses = Lens::around(from.at.truncate(), world, size);
            let maps: Result<_, Limit> = lenses.into_iter().map(draw).collect();
            Ok((from, maps?))
        };
        let emitters = source.places();
        Ok(match source {
            Source::Unhindered => Self::Unhindered,
            Source::Infinity(towards) => {
                Self::Infinity { towards, map: Box::new(draw(Lens::parallel(towards, world, size))?) }
            }
            Source::Point(at) => {
                let lens = match light.kind {
                    LightKind::Spot { direction, cutoff, .. } => Lens::cone(at, direction, cutoff, world, size),
                    _ => None,
                };
                Self::Places(vec![match lens {
                    Some(lens) => (emitters[0], vec![draw(lens)?]),
                    None => around(emitters[0], size)?,
                }])
            }
            Source::Area(_) => {
                let side = (f64::from(size) / (emitters.len() as f64).sqrt()) as u32;
                let side = side.max(LEAST_SIDE.min(size));
                let places: Result<_, Limit> = emitters.into_iter().map(|from| around(from, side)).collect();
                Self::Places(places?)
            }
        })
    }
}

/// The maps, ready to be asked.
struct Prepared {
    maps: Arc<Maps>,
    cascades: Option<Arc<Cascades>>,
    level: Level,
}

impl Shadows for Prepared {
    fn arriving(&self, light: usize, places: &Places, parts: &mut Parts, _: &mut u64) {
        match &self.maps.0[light] {
            LightMaps::Unhindered => parts.fill([1.0; 3]),
            LightMaps::Infinity { towards, map } if self.cascades.is_none() => {
                lookup::arriving(self.level, map, towards.extend(0.0), places, parts);
            }
            LightMaps::Infinity { towards, map } => {
                parts.fill([0.0; 3]);
                let facing = places.iter().enumerate().filter(|(_, place)| faces(place, towards.extend(0.0)));
                let questions: Vec<_> = facing.map(|(number, _)| (0, number)).collect();
                let answers = self.answers(light, &[map], &questions, places);
                questions.iter().zip(answers).for_each(|((_, number), answer)| parts.set(*number, answer));
            }
            LightMaps::Places(emitters)
                if self.cascades.is_none()
                    && let [(from, maps)] = &emitters[..]
                    && let [map] = &maps[..] =>
            {
                lookup::arriving(self.level, map, from.at, places, parts);
            }
            LightMaps::Places(emitters) => {
                let mut shares = vec![Shares::default(); places.len()];
                for (from, maps) in emitters {
                    let maps: Vec<_> = maps.iter().collect();
                    let weights: Vec<_> = places.iter().map(|place| from.weight(&place)).collect();
                    // What no map sees is lit: nothing has this number.
                    let seeing = |p: Place| maps.iter().position(|m| m.lens.sees(p.position)).unwrap_or(usize::MAX);
                    let asking = places.iter().zip(&weights).enumerate().filter(|(_, (_, weight))| **weight > 0.0);
                    let questions: Vec<_> = asking.map(|(number, (place, _))| (seeing(place), number)).collect();
                    let mut answers = self.answers(light, &maps, &questions, places).into_iter();
                    for (share, &weight) in shares.iter_mut().zip(&weights) {
                        share.add(weight, || answers.next().unwrap_or([1.0; 3]));
                    }
                }
                shares.iter().enumerate().for_each(|(number, share)| parts.set(number, share.part()));
            }
        }
    }
}

impl Prepared {
    /// What maps of the whole scene, or sharper ones in their place, answer to questions: which map, about which place.
    fn answers(&self, light: usize, maps: &[&Map], questions: &[(usize, usize)], places: &Places) -> Vec<Rgb> {
        match &self.cascades {
            Some(cascades) => cascades.answers(self.level, light, maps, questions, places),
            None => lookup::answers(self.level, maps, questions, places),
        }
    }
}

impl MapTile {
    /// What the transparent things at a texel let through to this depth.
    #[inline(never)]
    fn filtered(&self, texel: usize, depth: f64) -> Rgb {
        let first = self.layers.partition_point(|l| (l.texel as usize) < texel);
        let here = self.layers[first..].iter().take_while(|l| l.texel as usize == texel);
        let before = here.filter(|l| f64::from(l.depth) < depth);
        before.fold([1.0; 3], |left, l| [0, 1, 2].map(|k| left[k] * l.passing[k]))
    }
}
