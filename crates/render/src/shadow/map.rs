//! Shadow maps: the z-buffer algorithm twice. First from the light, which leaves at each texel how
//! far the nearest thing is; then from the viewer, and a visible point is lit if nothing nearer to
//! the light is in its texel.
//!
//! The first pass computes depths alone, and the second asks only about points that are seen. The
//! maps belong to the lights and the scene, not to the viewer: a session keeps them over a
//! turntable.
//!
//! Texels are coarser than pixels, and a lit surface must not find itself in its own way (*acne*),
//! nor may it be moved so far that its shadow loosens from its foot (*peter-panning*). So the depth
//! that is compared is not the point's own but that of its facet's plane in the middle of the
//! texel, which takes a slope exactly into account; the remaining error, the rounding of corners to
//! 1/256 texel, grows with the slope (*slope-scaled bias*). And because the texel's middle may lie
//! on a neighbour that rises towards the light, the point is lifted by half a texel along its
//! normal (*normal bias*). Four texels round the point are compared one by one, and the answers are
//! blended (*percentage-closer filtering*), but for those in which the light sees something far
//! behind: the surface does not reach there.
//!
//! A parallel light has one map, fitted to the scene. A point's map is fitted likewise where the
//! scene fills a cone before it; else it has six, the faces of a cube. A spot has the one that fits
//! its cone. An area light has maps at several of its places. Transparent things are kept as lists
//! at their texels, with the part of each colour of light that passes. In large scenes, one map may
//! be joined by sharper ones for the part near the viewer (`map/cascade.rs`), as many as
//! `shadow_cascades` says.
//!
//! In:   lights, scene. Out: the part of a light that arrives at a place.
//! Cost: a z-buffer pass for each map; a question is a constant number of texels. 4 bytes a texel.
//! Source: [Williams 1978]; filtering after [Reeves, Salesin & Cook 1987], area lights after
//!         [Brotman & Badler 1984].

mod cascade;
mod draw;
mod lens;
mod light_maps;
mod lookup;
mod slice;
#[cfg(test)]
mod testing;
mod tiles;

use super::casters::faces;
use super::occluders::Occluders;
use super::places::{LightVisibility, SurfacePoint, SurfacePoints};
use super::sources::Shares;
use super::{PreparedShadows, ShadowAlgorithm};
use crate::{Execution, PreparedView, Session, Settings};
use cascade::{Cascades, CascadesKey};
use draw::{FirstPass, When};
use light_maps::LightMaps;
use light_maps::{LightMapsKey, Maps};
use std::sync::Arc;
use tiles::Map;
use vitral_exec::Limit;
use vitral_light::{Light, Rgb};
use vitral_math::DVec4;
use vitral_math::lanes::Level;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct MapShadows;

impl ShadowAlgorithm for MapShadows {
    fn prepare<'a>(
        &self,
        session: &'a Session,
        lights: &[Light],
        _: DVec4,
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Box<dyn PreparedShadows + 'a>, Limit> {
        let maps = Maps::of(session, lights, settings, execution)?;
        Ok(Box::new(Prepared { maps, cascades: None, level: execution.level }))
    }

    fn prepare_for<'a>(
        &self,
        view: &PreparedView<'a>,
        lights: &[Light],
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Box<dyn PreparedShadows + 'a>, Limit> {
        let session = view.session;
        let maps = Maps::of(session, lights, settings, execution)?;
        let (count, size) = (settings.shadows.cascades, settings.shadows.map_size);
        if count < 2 {
            return Ok(Box::new(Prepared { maps, cascades: None, level: execution.level }));
        }
        let key = CascadesKey { maps: LightMapsKey::new(lights, settings), count, view: view.view };
        let cascades = session.cache.get_or_build(key, || {
            let occluders = Occluders::new(session, settings);
            let pass = FirstPass {
                session,
                occluders: &occluders,
                settings,
                execution,
                when: When::Asked,
            };
            Cascades::new(&session.world, &view.view, &maps, (count, size), |lens| pass.draw(lens))
        })?;
        Ok(Box::new(Prepared { maps, cascades: Some(cascades), level: execution.level }))
    }
}

/// The maps, ready to be asked.
struct Prepared {
    maps: Arc<Maps>,
    cascades: Option<Arc<Cascades>>,
    level: Level,
}

impl PreparedShadows for Prepared {
    fn is_smooth(&self) -> bool {
        // Texels are filtered.
        true
    }

    fn light_visibility(
        &self,
        light: usize,
        places: &SurfacePoints,
        parts: &mut LightVisibility,
        _: &mut u64,
    ) {
        match &self.maps.0[light] {
            LightMaps::Unoccluded => parts.fill([1.0; 3]),
            LightMaps::Infinity { towards, map } if self.cascades.is_none() => {
                lookup::light_visibility(self.level, map, towards.extend(0.0), places, parts);
            }

            // Ask the cascades about the places that face the light.
            LightMaps::Infinity { towards, map } => {
                parts.fill([0.0; 3]);
                let facing = places
                    .iter()
                    .enumerate()
                    .filter(|(_, place)| faces(place, towards.extend(0.0)));
                let questions: Vec<_> = facing.map(|(number, _)| (0, number)).collect();
                let answers = self.answers(light, &[map], &questions, places);
                questions
                    .iter()
                    .zip(answers)
                    .for_each(|((_, number), answer)| parts.set(*number, answer));
            }
            LightMaps::Positions(emitters)
                if self.cascades.is_none()
                    && let [(from, maps)] = &emitters[..]
                    && let [map] = &maps[..] =>
            {
                lookup::light_visibility(self.level, map, from.at, places, parts);
            }
            LightMaps::Positions(emitters) => {
                // Sum the shares of all positions of the light, each with its maps around it.
                let mut shares = vec![Shares::default(); places.len()];
                for (from, maps) in emitters {
                    let maps: Vec<_> = maps.iter().collect();
                    let weights: Vec<_> = places.iter().map(|place| from.weight(&place)).collect();
                    // What no map sees is lit: nothing has this number.
                    let seeing = |p: SurfacePoint| {
                        maps.iter().position(|m| m.lens.sees(p.position)).unwrap_or(usize::MAX)
                    };
                    let asking = places
                        .iter()
                        .zip(&weights)
                        .enumerate()
                        .filter(|(_, (_, weight))| **weight > 0.0);
                    let questions: Vec<_> =
                        asking.map(|(number, (place, _))| (seeing(place), number)).collect();
                    let mut answers = self.answers(light, &maps, &questions, places).into_iter();
                    for (share, &weight) in shares.iter_mut().zip(&weights) {
                        share.add(weight, || answers.next().unwrap_or([1.0; 3]));
                    }
                }
                shares
                    .iter()
                    .enumerate()
                    .for_each(|(number, share)| parts.set(number, share.part()));
            }
        }
    }
}

impl Prepared {
    /// What maps of the whole scene, or sharper ones in their place, answer to questions: which
    /// map, about which place.
    fn answers(
        &self,
        light: usize,
        maps: &[&Map],
        questions: &[(usize, usize)],
        places: &SurfacePoints,
    ) -> Vec<Rgb> {
        match &self.cascades {
            Some(cascades) => cascades.answers(self.level, light, maps, questions, places),
            None => lookup::answers(self.level, maps, questions, places),
        }
    }
}
