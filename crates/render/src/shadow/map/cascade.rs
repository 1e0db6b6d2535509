//! Cascades: maps for parts of what the viewer sees, the sharper the nearer.
//!
//! A map that holds a large scene spends its texels evenly, but the picture does not: a texel that
//! is smaller than a pixel far away is many pixels wide in front of the viewer. So the view is cut
//! in depth, and each slice has a map fitted to the objects in it, `n` slices between the nearest
//! and the farthest visible point. With cuts in geometric progression,
//! `d(i) = near (far / near)^(i / n)`, texels are as wide in the picture at the near end of every
//! slice; the *practical split scheme* takes the mean of these and of equal cuts, weighted. As
//! `near` is fitted to visible points, the weight of the first may be large.
//!
//! A slice's map must hold everything between the slice and the light, but only beside the slice
//! may it be cut off. A map has to pay: where it would not be twice as sharp as the one of the
//! whole scene, that is used, and kept from picture to picture; so small scenes get none. Towards
//! the end of its slice a map fades into the next one.
//!
//! Seen from a moving viewer, edges must not crawl. Maps of a parallel light have axes that depend
//! on the light alone, texels of a few sizes, and borders on a grid of whole texels: a place keeps
//! its texel from picture to picture.
//!
//! In:   lights, scene and view. Out: a map, or none, for each slice of each light that has one map
//!       for the whole scene.
//! Cost: a z-buffer pass for each map, for each view; a question is one of a map's, in the borders
//!       between slices two.
//! Source: [Zhang et al. 2006], [Dimitrov 2007]. Departs from them: slices are fitted to objects,
//!         not to the frustum.

use super::lens::Lens;
use super::light_maps::{LightMaps, LightMapsKey, Maps};
use super::tiles::Map;
use super::{lookup, slice};
use crate::raytrace::triangles::Triangles;
use crate::shadow::places::SurfacePoints;
use crate::{Cached, Reuse};
use vitral_exec::Limit;
use vitral_light::Rgb;
use vitral_math::lanes::Level;
use vitral_math::{DVec3, DVec4, func};
use vitral_scene::{ViewTransform, World};

/// Weight of the geometric progression.
const GEOMETRIC: f64 = 0.98;
/// Part of a slice in which its map fades into the next one.
const FADE: f64 = 0.1;
/// How much sharper than the map of the whole scene a map must be.
const PAYS: f64 = 2.0;

/// What cascades depend on, besides the scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CascadesKey {
    pub(super) maps: LightMapsKey,
    pub(super) count: u32,
    pub(super) view: ViewTransform,
}

/// The slices of a view and their maps.
#[derive(Debug)]
pub(crate) struct Cascades {
    /// Depth of a place: `depth · (x, y, z, 1)`.
    depth: DVec4,
    /// Depths of the cuts, with both ends.
    cuts: Vec<f64>,
    /// For each light, for each slice its map; none where the one of the whole scene serves.
    maps: Vec<Vec<Option<Map>>>,
}

impl Cached for Cascades {
    type Key = CascadesKey;
    const REUSE: Reuse = Reuse::View;
}

impl Cascades {
    /// `count` slices of a view; `draw` makes a map.
    pub(super) fn new(
        world: &World,
        view: &ViewTransform,
        whole: &Maps,
        (count, size): (u32, u32),
        draw: impl Fn(Lens) -> Result<Map, Limit>,
    ) -> Result<Self, Limit> {
        let row = -view.view_from_world.row(2);
        let center = Triangles::center_of(world);
        let solids = slice::seen(world, view);
        let depths =
            solids.iter().flat_map(slice::ConvexSolid::corners).map(|p| row.dot(p.extend(1.0)));
        let [near, far] =
            depths.fold([f64::INFINITY, f64::NEG_INFINITY], |[n, f], d| [n.min(d), f.max(d)]);
        let cuts = if near < far { cuts(near, far, view.perspective, count) } else { Vec::new() };
        // A slice's map is asked about places before it, too: those that fade into it.
        let start =
            |i: usize| if i == 0 { cuts[0] } else { cuts[i] - FADE * (cuts[i] - cuts[i - 1]) };
        let ends = (1..cuts.len()).map(|i| [start(i - 1), cuts[i]]);
        let slices: Vec<_> = ends.map(|ends| slice::between(&solids, row, ends)).collect();
        let of_light = |light: &LightMaps| -> Result<Vec<Option<Map>>, Limit> {
            let lenses = slices.iter().map(|solids| lens(light, solids, world, size));
            lenses.map(|lens| lens.map(&draw).transpose()).collect()
        };
        let maps: Result<_, Limit> = whole.0.iter().map(of_light).collect();
        // Places are less the scene's middle.
        let depth = row.truncate().extend(row.dot(center.extend(1.0)));
        Ok(Self { depth, cuts, maps: maps? })
    }

    /// What the maps of a light answer to questions, which of those of the whole scene (`maps`) and
    /// about which of `places`; sharper ones where they hold it.
    pub(super) fn answers(
        &self,
        level: Level,
        light: usize,
        maps: &[&Map],
        questions: &[(usize, usize)],
        places: &SurfacePoints,
    ) -> Vec<Rgb> {
        // Ask one map or two about each place. The slices' maps are numbered from the end of the
        // others on.
        let slices = &self.maps[light];
        let all: Vec<&Map> = maps.iter().copied().chain(slices.iter().flatten()).collect();
        let number = |slice: usize| maps.len() + slices[..slice].iter().flatten().count();
        let numbers: Vec<_> = (0..slices.len()).map(number).collect();
        let mut asked = Vec::with_capacity(questions.len());
        // How much the next question's answer counts against this one's.
        let mut fades = Vec::with_capacity(questions.len());
        for &(whole, place) in questions {
            // Choose the map of the slice where there is one, and of the next slice near its end.
            let position = places.position(place);
            let map = |slice: usize| {
                let sharper =
                    slices.get(slice).and_then(Option::as_ref).filter(|m| m.lens.holds(position));
                if sharper.is_some() { numbers[slice] } else { whole }
            };
            let (slice, fade) = self.slice_at(position);
            asked.push((slice.map_or(whole, map), place));
            if let (Some(slice), Some(_)) = (slice, fade) {
                asked.push((map(slice + 1), place));
            }
            fades.push(fade);
        }

        // Blend the answers where there are two.
        let mut found = lookup::answers(level, &all, &asked, places).into_iter();
        let mut next = || found.next().unwrap_or([1.0; 3]);
        let mut blend = |fade: Option<f32>| {
            let here = next();
            let Some(fade) = fade else { return here };
            let there = next();
            [0, 1, 2].map(|k| here[k] + (there[k] - here[k]) * fade)
        };
        fades.into_iter().map(&mut blend).collect()
    }

    /// The slice that holds a position, if there is one; and how far it has faded there into the
    /// next one, if it has begun to.
    fn slice_at(&self, position: DVec3) -> (Option<usize>, Option<f32>) {
        let depth = self.depth.dot(position.extend(1.0));
        // A little before the first cut is in the first slice, as is what rays find beside the
        // view.
        let slice = self.cuts.partition_point(|&cut| cut < depth).max(1) - 1;
        let Some((start, end)) = self.cuts.get(slice).zip(self.cuts.get(slice + 1)) else {
            return (None, None);
        };
        let fade = (depth - end) / ((end - start) * FADE) + 1.0;
        let fades_out = !(fade <= 0.0 || slice + 2 >= self.cuts.len());
        (Some(slice), fades_out.then_some(fade.min(1.0) as f32))
    }
}

/// Depths at which a view is cut, with both ends: the practical split scheme. A parallel view shows
/// all depths alike and is not cut.
fn cuts(near: f64, far: f64, perspective: bool, count: u32) -> Vec<f64> {
    if !perspective {
        return vec![near, far];
    }
    let near = near.max(far * 1e-6);
    let cut = |i: u32| {
        let share = f64::from(i) / f64::from(count);
        GEOMETRIC * near * func::pow(far / near, share)
            + (1.0 - GEOMETRIC) * (near + (far - near) * share)
    };
    (0..=count).map(cut).collect()
}

/// The lens for what is seen in a slice, if it pays.
fn lens(
    light: &LightMaps,
    solids: &[slice::ConvexSolid],
    world: &World,
    size: u32,
) -> Option<Lens> {
    let (whole, lens, middle) = match light {
        LightMaps::Infinity { towards, map } => {
            // Fit a parallel lens to the slice.
            let corners: Vec<DVec3> = solids.iter().flat_map(slice::ConvexSolid::corners).collect();
            let middle = *corners.first()?;
            (&map.lens, Lens::parallel_round(*towards, &corners, &map.lens, world, size)?, middle)
        }
        LightMaps::Positions(places) => {
            // All around a light, or from many places, there is no one map to be better than.
            let [(from, maps)] = &places[..] else { return None };
            let [map] = &maps[..] else { return None };
            let solids = slice::within(solids, &map.lens.view.clip_from_world());
            let corners: Vec<DVec3> = solids.iter().flat_map(slice::ConvexSolid::corners).collect();
            let middle = corners.iter().sum::<DVec3>() / corners.len().max(1) as f64;
            (&map.lens, Lens::before(from.at.truncate(), &corners, world, size)?, middle)
        }
        LightMaps::Unoccluded => return None,
    };

    // Use it only where its texels are clearly smaller than those of the whole map.
    let middle = middle - Triangles::center_of(world);
    (lens.texel(middle) * PAYS <= whole.texel(middle)).then_some(lens)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cuts_are_nearly_a_geometric_progression() {
        let found = cuts(1.0, 1000.0, true, 3);
        assert_eq!((found[0], found[3]), (1.0, 1000.0));
        assert!(
            found[1] > 10.0 && found[1] < 20.0 && found[2] > 100.0 && found[2] < 120.0,
            "{found:?}"
        );
        assert_eq!(cuts(1.0, 1000.0, false, 3), [1.0, 1000.0]);
        assert!(cuts(0.0, 1.0, true, 4).windows(2).all(|c| c[0] < c[1]));
    }
}
