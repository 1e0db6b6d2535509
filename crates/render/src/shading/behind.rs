//! What is seen through translucent surfaces: a blurred picture of the scene behind them, taken
//! from the picture's own layers.
//!
//! A picture that keeps, for every pixel, all transparent fragments and the opaque surface behind
//! them, with their depths and colours, is a scene of its own, seen from the eye. Rays can be
//! followed in it. From each fragment of a translucent surface some dozens start, scattered round
//! the direction of sight; each looks for the next thing on its way: where is the ray when it is as
//! deep as what the pixel under it shows? It is asked of the pixel that the ray is over, which
//! gives a depth, which gives another pixel, three times at the most. There its colour is taken; if
//! it is transparent the ray goes on behind it, if it is translucent in a new direction. The mean
//! of the rays is what the surface shows instead of what is straight behind. Objects in front of
//! the surface are not blurred into it, and things blur the more the farther behind it they are;
//! what touches it stays sharp.
//!
//! A picture does not know what it does not show. A ray that would come to something hidden by an
//! opaque surface in front of the translucent one does not count; beyond the picture's border, the
//! border goes on. A ray counts fragments as behind its start if the start lies on the viewer's
//! side of their planes, so that a pane does not see its own rim. Rays stay within 84° of the
//! direction in which the eye looks.
//!
//! Tiles are kept until all are there, then composed.
//!
//! In:   shaded points and layers of all tiles. Out: for each fragment of a translucent surface
//!       what is behind it.
//! Cost: rays times layers passed times three lookups, each linear in the layers of a pixel;
//!       memory: all points and layers.
//! Source: \[Cook, Porter & Carpenter 1984\] for the rays. Departs from it: they are followed in
//! the picture, from fragment to fragment, as in the lists of \[Carpenter 1984\].

use super::FrameConstants;
use super::fragments::fragment;
use super::points::{FragmentPoint, NO_POINT, Points, Source, samples_in};
use super::shaded_points::ShadedPoints;
use crate::PreparedView;
use crate::marks::MarkColors;
use crate::shadow::{Strata, facet, hash};
use std::sync::Mutex;
use vitral_exec::{Budget, Limit};
use vitral_math::{DMat4, DVec2, DVec3, DVec4, dvec2};
use vitral_raster::{NO_FACET, TILE, TILE_PIXELS, Tile};

/// How often a ray asks where it meets the next thing.
const ASKED: usize = 3;
/// Most things that a ray passes.
const MOST_PASSED: usize = 64;
/// Least part of a ray's direction that goes straight away from the eye.
const LEAST_AWAY: f64 = 0.1;
/// A ray whose light counts less ends.
const LEAST_WEIGHT: f32 = 1.0 / 512.0;
/// How far behind its start, as a part of the distance from the eye, a ray meets things.
const CLEARANCE: f64 = 1e-4;

/// A tile with all that was found out about its pixels.
#[derive(Default)]
pub(crate) struct DeepTile {
    /// Depths and facets of the opaque samples.
    tile: Option<Tile>,
    points: Points,
    lit: ShadedPoints,
    /// What fills each pixel.
    sources: Vec<Source>,
    /// Where each pixel's fragments begin.
    starts: Vec<u32>,
    /// The plane of each point's facet, view space, with the eye on its positive side.
    planes: Vec<DVec4>,
    /// The exponent with which each point scatters; 0 for those that do not.
    exponents: Vec<f32>,
}

impl DeepTile {
    fn bytes(&self) -> u64 {
        let tile = self.tile.as_ref().map_or(0, |t| t.depth.len() * 8);
        let points = self.points.bytes() + self.lit.colors.len() * 28;
        (tile + points + TILE_PIXELS * 12 + self.planes.len() * 36) as u64
    }
}

/// All tiles of a picture, for rays.
pub(crate) struct DeepImage<'a> {
    constants: &'a FrameConstants<'a>,
    marks: &'a MarkColors,
    strata: Strata,
    lens: Lens,
    budget: &'a Budget,
    tiles: Vec<Mutex<DeepTile>>,
    outcome: Mutex<(Result<(), Limit>, u64)>,
}

impl<'a> DeepImage<'a> {
    pub(crate) fn new(
        constants: &'a FrameConstants<'a>,
        marks: &'a MarkColors,
        scatter_samples: u32,
        budget: &'a Budget,
    ) -> Self {
        let view = constants.view;
        let tiles = view.viewport.tiles_x() * view.viewport.tiles_y();
        Self {
            constants,
            marks,
            strata: Strata::new(scatter_samples),
            lens: Lens::new(view),
            budget,
            tiles: (0..tiles).map(|_| Mutex::default()).collect(),
            outcome: Mutex::new((Ok(()), 0)),
        }
    }

    /// Keeps a tile; after a limit it is dropped.
    pub(crate) fn keep(&self, index: usize, tile: &Tile, mut points: Points, lit: ShadedPoints) {
        points.forget_workspace();
        let mut sources = vec![Source::Point(NO_POINT); TILE_PIXELS];
        points.pixels.iter().for_each(|p| sources[p.index as usize] = p.source);
        let mut starts = vec![0; TILE_PIXELS + 1];
        points.fragments.iter().for_each(|f| starts[f.pixel as usize + 1] += 1);
        (0..TILE_PIXELS).for_each(|p| starts[p + 1] += starts[p]);
        let mut kept = DeepTile {
            tile: Some(tile.clone()),
            points,
            lit,
            sources,
            starts,
            ..DeepTile::default()
        };
        self.describe(&mut kept);
        let bytes = kept.bytes();
        let mut outcome = self.outcome.lock().expect("no thread panics while it counts");
        let (result, charged) = &mut *outcome;
        if result.is_err() {
            return;
        }
        *result = self.budget.charge(bytes, "what is behind translucent surfaces");
        if result.is_ok() {
            *charged += bytes;
            *self.tiles[index].lock().expect("deep tile") = kept;
        }
    }

    /// Finds the plane and the exponent of each point.
    fn describe(&self, kept: &mut DeepTile) {
        let view = self.constants.view;
        let world = &view.session.world;
        kept.planes = vec![DVec4::ZERO; kept.points.len()];
        kept.exponents = vec![0.0; kept.points.len()];
        // Neighbours mostly lie on one facet.
        let mut last = (u32::MAX, DVec4::ZERO, 0.0);
        for point in 0..kept.points.len() {
            let number = kept.points.facet[point];
            if number != last.0 {
                let instance = &world.instances[world.instance_of_facet(number)];
                let triangle = number - instance.first_facet;
                let material = instance.mesh.material_of_triangle(triangle as usize);
                let (corners, normal) = facet(instance, triangle, DVec3::ZERO);
                let to_view = |p: DVec3| view.view.view_from_world.transform_point3(p);
                let (at, n) =
                    (to_view(corners[0]), view.view.view_from_world.transform_vector3(normal));
                let plane = n.extend(-n.dot(at));
                let eye = if view.view.perspective { DVec4::W } else { DVec4::Z };
                let plane = if plane.dot(eye) < 0.0 { -plane } else { plane };
                last = (number, plane, self.constants.material(material).scatters.unwrap_or(0.0));
            }
            (kept.planes[point], kept.exponents[point]) = (last.1, last.2);
        }
    }

    /// All tiles are there: the picture can be asked. Or the limit that was reached.
    pub(crate) fn finish(self) -> Result<DeepPicture<'a>, Limit> {
        let Self { constants, marks, strata, lens, budget, tiles, outcome } = self;
        let (result, charged) = outcome.into_inner().expect("no thread panics while it counts");
        let tiles = tiles.into_iter().map(|tile| tile.into_inner().expect("deep tile")).collect();
        let picture = DeepPicture { constants, marks, strata, lens, budget, tiles, charged };
        result.map(|()| picture)
    }
}

/// A finished [`DeepImage`].
pub(crate) struct DeepPicture<'a> {
    constants: &'a FrameConstants<'a>,
    marks: &'a MarkColors,
    strata: Strata,
    lens: Lens,
    budget: &'a Budget,
    tiles: Vec<DeepTile>,
    charged: u64,
}

impl Drop for DeepPicture<'_> {
    fn drop(&mut self) {
        self.budget.release(self.charged);
    }
}

/// The next thing on a ray's way, over some pixel.
enum Next {
    /// Something behind the ray's start.
    Surface(LayerHit),
    /// Nothing.
    Background,
    /// The picture shows something else there.
    Hidden,
}

/// What a ray meets.
#[derive(Clone, Copy)]
struct LayerHit {
    /// Distance from the eye along the direction of view.
    away: f64,
    color: [f32; 4],
    /// The part of the light from behind that passes.
    passes: [f32; 3],
    /// How it scatters; 0: not.
    exponent: f32,
}

impl DeepPicture<'_> {
    /// Whether there is time left.
    pub(crate) fn check(&self) -> Result<(), Limit> {
        self.budget.check("what is behind translucent surfaces")
    }

    /// A tile, with a copy of its colours for the composition to change.
    pub(crate) fn tile(&self, index: usize) -> Option<(&Tile, &Points, ShadedPoints)> {
        let tile = &self.tiles[index];
        let lit = ShadedPoints {
            colors: tile.lit.colors.clone(),
            passes: tile.lit.passes.clone(),
            ..ShadedPoints::default()
        };
        Some((tile.tile.as_ref()?, &tile.points, lit))
    }

    /// The colour behind a fragment of a translucent surface, premultiplied; `None` for other
    /// fragments, for those behind others of the kind at all their samples, and where the picture
    /// does not show it. `fragments` are all of the pixel.
    pub(crate) fn behind(
        &self,
        index: usize,
        of: &FragmentPoint,
        fragments: &[FragmentPoint],
    ) -> Option<[f32; 4]> {
        // Find how far the surface scatters.
        let tile = &self.tiles[index];
        let exponent = self.exponent(tile, of);
        if exponent == 0.0 || self.is_behind_another(tile, of, fragments) {
            return None;
        }

        // Place the fragment in view space.
        let depths = &tile.points.depths[of.start as usize..][..of.mask.count_ones() as usize];
        let depth = depths.iter().sum::<f32>() / depths.len() as f32;
        let [x, y] = tile.points.place[of.source as usize].map(f64::from);
        let from = self.lens.place(dvec2(x, y), self.lens.away(depth));
        let pixel = [x as u32, y as u32];
        let seed = hash(pixel[0] ^ pixel[1] << 16);
        let axis =
            if self.constants.view.view.perspective { from.normalize() } else { DVec3::NEG_Z };

        // Follow several scattered rays and take the mean.
        let (mut sum, mut count) = ([0.0; 4], 0.0);
        for i in 0..self.strata.count() {
            let direction = self.strata.direction(i, seed, exponent, axis);
            let start = Start { pixel, from, direction };
            if let Some(light) = self.follow(start, i, hash(seed ^ hash(i))) {
                (0..4).for_each(|k| sum[k] += light[k]);
                count += 1.0;
            }
        }
        (count > 0.0).then(|| sum.map(|channel| channel / count))
    }

    fn exponent(&self, tile: &DeepTile, of: &FragmentPoint) -> f32 {
        if of.is_mark { 0.0 } else { tile.exponents[of.source as usize] }
    }

    /// Whether other translucent fragments lie in front of it at each of its samples.
    fn is_behind_another(
        &self,
        tile: &DeepTile,
        of: &FragmentPoint,
        fragments: &[FragmentPoint],
    ) -> bool {
        let mut left = of.mask;
        for other in
            fragments.iter().filter(|f| f.facet != of.facet && self.exponent(tile, f) > 0.0)
        {
            let common = left & other.mask;
            for sample in samples_in(common) {
                let [own, others] = [of, other].map(|f| tile.points.depth(f, sample));
                if others > own || (others == own && other.facet < of.facet) {
                    left &= !(1 << sample);
                }
            }
        }
        left == 0
    }

    /// What a ray sees; `None` if the picture does not show it.
    fn follow(&self, start: Start, ray: u32, seed: u32) -> Option<[f32; 4]> {
        // Start with the full weight.
        let Start { mut pixel, mut from, direction } = start;
        let mut direction = forward(direction);
        let sample = ray as usize % self.constants.view.pattern.len();
        let (mut light, mut weight, mut opacity) = ([0.0; 4], [1.0; 3], 1.0);

        // March through the layers.
        for passed in 0..MOST_PASSED {
            // Move to the pixel in which the ray meets the surface found in this one.
            let mut met = None;
            for _ in 0..ASKED {
                let to = match self.next(pixel, sample, from) {
                    Next::Surface(surface) => {
                        let way = direction * ((surface.away + from.z) / -direction.z);
                        met = Some((pixel, Some(surface)));
                        self.lens.pixel((from + way).extend(1.0))
                    }
                    Next::Background => {
                        met = Some((pixel, None));
                        self.lens.pixel(direction.extend(0.0))
                    }
                    Next::Hidden => return None,
                };
                if to.is_none_or(|to| to == pixel) {
                    break;
                }
                pixel = to.unwrap_or(pixel);
            }
            let (place, surface) = met?;

            // Add the surface's light, and weaken what lies behind it.
            let color = match surface {
                Some(surface) => surface.color,
                None => self.background(place),
            };
            (0..3).for_each(|k| light[k] += weight[k] * color[k]);
            light[3] += opacity * color[3];
            let Some(surface) = surface else { break };
            weight = [0, 1, 2].map(|k| weight[k] * surface.passes[k]);
            opacity *= 1.0 - color[3];
            if weight.iter().all(|&w| w < LEAST_WEIGHT) && opacity < LEAST_WEIGHT {
                break;
            }

            // Continue behind it, scattered if it scatters.
            pixel = place;
            from = self
                .lens
                .place(dvec2(f64::from(place[0]) + 0.5, f64::from(place[1]) + 0.5), surface.away);
            if surface.exponent > 0.0 {
                let strata = Strata::new(1);
                direction = forward(strata.direction(
                    passed as u32,
                    seed,
                    surface.exponent,
                    direction.normalize(),
                ));
            }
        }
        Some(light)
    }

    /// The colour behind all surfaces of a pixel.
    fn background(&self, pixel: [u32; 2]) -> [f32; 4] {
        let side = TILE as u32;
        let tile = &self.tiles
            [(pixel[1] / side * self.constants.view.viewport.tiles_x() + pixel[0] / side) as usize];
        let dark = tile.points.ground.get((pixel[1] % side * side + pixel[0] % side) as usize);
        let rows = &self.constants.background;
        dark.map_or_else(|| rows.color(pixel[1]), |&dark| rows.shaded(pixel[1], dark))
    }

    /// What lies behind a place (view space), over a pixel.
    fn next(&self, pixel: [u32; 2], sample: usize, from: DVec3) -> Next {
        // Find the pixel's tile, and the least distance of what lies behind the place.
        let side = TILE as u32;
        let tiles_x = self.constants.view.viewport.tiles_x();
        let tile = &self.tiles[(pixel[1] / side * tiles_x + pixel[0] / side) as usize];
        let Some(opaque) = &tile.tile else { return Next::Background };
        let at = (pixel[1] % side * side + pixel[0] % side) as usize;
        let least = -from.z * (1.0 + CLEARANCE);
        let faces = |point: usize| tile.planes[point].dot(from.extend(1.0)) > -from.z * CLEARANCE;

        // Find the nearest fragment behind the place.
        let mut nearest: Option<(&FragmentPoint, f64)> = None;
        for f in &tile.points.fragments[tile.starts[at] as usize..tile.starts[at + 1] as usize] {
            if f.mask >> sample & 1 == 0 {
                continue;
            }
            let away = self.lens.away(tile.points.depth(f, sample as u32));
            let is_next = away > least
                && nearest.is_none_or(|(n, d)| away < d || (away == d && f.facet < n.facet))
                && (f.is_mark || faces(f.source as usize));
            if is_next {
                nearest = Some((f, away));
            }
        }
        if let Some((f, away)) = nearest {
            let exponent = self.exponent(tile, f);
            let of = fragment(f, opaque, &tile.points, &tile.lit, self.constants, self.marks);
            return Next::Surface(LayerHit { away, color: of.color, passes: of.passes, exponent });
        }

        // Otherwise find the opaque surface, or the background.
        let sample_at = sample * TILE_PIXELS + at;
        if opaque.facet[sample_at] == NO_FACET {
            return Next::Background;
        }
        let point = match tile.sources[at] {
            Source::Point(point) => point,
            Source::Mixed(start) => tile.points.mixed[start as usize + sample],
        };

        // Give up where it has no point, lies in front of the place, or is turned away from it.
        let away = self.lens.away(opaque.depth[sample_at]);
        if point == NO_POINT || away <= least || !faces(point as usize) {
            return Next::Hidden;
        }
        Next::Surface(LayerHit {
            away,
            color: tile.lit.colors[point as usize],
            passes: [0.0; 3],
            exponent: 0.0,
        })
    }
}

/// Where a ray starts: pixel, place and direction in view space.
#[derive(Clone, Copy)]
struct Start {
    pixel: [u32; 2],
    from: DVec3,
    direction: DVec3,
}

/// The direction, turned so that it goes away from the eye.
fn forward(direction: DVec3) -> DVec3 {
    DVec3 { z: direction.z.min(-LEAST_AWAY), ..direction }
}

/// The way from pixels and depths to view space and back.
#[derive(Clone, Copy)]
struct Lens {
    clip_from_view: DMat4,
    size: DVec2,
    perspective: bool,
}

impl Lens {
    fn new(view: &PreparedView<'_>) -> Self {
        let size = dvec2(f64::from(view.viewport.width), f64::from(view.viewport.height));
        Self { clip_from_view: view.view.clip_from_view, size, perspective: view.view.perspective }
    }

    /// The distance along the direction of view at a depth.
    fn away(&self, depth: f32) -> f64 {
        let (a, b, depth) =
            (self.clip_from_view.z_axis.z, self.clip_from_view.w_axis.z, f64::from(depth));
        if self.perspective { b / (depth + a) } else { (b - depth) / a }
    }

    /// The place (view space) at a distance, seen at a place of the picture in pixels.
    fn place(&self, at: DVec2, away: f64) -> DVec3 {
        let m = &self.clip_from_view;
        let ndc = dvec2(2.0, -2.0) * at / self.size + dvec2(-1.0, 1.0);
        let w = if self.perspective { away } else { 1.0 };
        let x = (ndc.x * w + m.z_axis.x * away - m.w_axis.x) / m.x_axis.x;
        let y = (ndc.y * w + m.z_axis.y * away - m.w_axis.y) / m.y_axis.y;
        DVec3::new(x, y, -away)
    }

    /// The pixel over which a homogeneous point appears, or the nearest to it; `None` for a
    /// direction in a parallel view.
    fn pixel(&self, point: DVec4) -> Option<[u32; 2]> {
        let clip = self.clip_from_view * point;
        if clip.w <= 0.0 {
            return None;
        }
        let at = dvec2(clip.x / clip.w + 1.0, 1.0 - clip.y / clip.w) * 0.5 * self.size;
        Some([at.x.clamp(0.0, self.size.x - 1.0) as u32, at.y.clamp(0.0, self.size.y - 1.0) as u32])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_scene::{Camera, Projection};

    #[test]
    fn a_lens_knows_the_way_there_and_back() {
        for projection in
            [Projection::Perspective { view_angle: 0.7 }, Projection::Parallel { height: 3.0 }]
        {
            let camera = Camera {
                position: DVec3::new(3.0, 4.0, 5.0),
                focal_point: DVec3::ZERO,
                view_up: DVec3::Y,
                projection,
                clip: Some((2.0, 9.0)),
            };
            let view = camera.transform(1.5, (2.0, 9.0));
            let lens = Lens {
                clip_from_view: view.clip_from_view,
                size: dvec2(300.0, 200.0),
                perspective: view.perspective,
            };
            for (at, away) in [([10.5, 20.5], 2.5), ([290.5, 150.5], 8.0)] {
                let place = lens.place(DVec2::from(at), away);
                let clip = view.clip_from_view * place.extend(1.0);
                assert!((lens.away((clip.z / clip.w) as f32) - away).abs() < 1e-4);
                assert_eq!(lens.pixel(place.extend(1.0)), Some(at.map(|c: f64| c as u32)));
                assert!((place.z + away).abs() < 1e-12);
            }
        }
    }
}
