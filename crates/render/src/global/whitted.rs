//! Whitted's ray tracing: mirror images, refraction, and shadows that know both.
//!
//! A ray that meets a mirror goes on in the direction in which the mirror reflects it; one that meets glass goes on behind
//! it, bent as the two media ask; each of them may meet a mirror or glass again. What a pixel shows is a tree of such rays:
//! `I = I_local + ks I_mirrored + kt I_transmitted`, where `I_local` is what the local model says about each surface, with
//! shadow rays. Where no light gets through a surface at that angle (total internal reflection), all of it is mirrored.
//!
//! A tree's rays are followed generation by generation, those of many samples together: what a generation hits is sorted by
//! object and material, and goes eight at a time through the very formulas, textures and shadows of surfaces that the eye
//! sees. Each ray carries the weight with which its light counts; a branch ends where that is less than can be seen, or
//! after `max-depth` turns. Straight ways, through sheets or through glass whose index is that of its surroundings,
//! are no turns.
//!
//! A translucent surface scatters what passes it: the ray goes on as many, in directions round that of clear glass; those
//! are scattered in one direction each where they meet another such surface.
//!
//! Faces that coincide are met one after the other (see `coincident`), and are one border between media: light bends behind the
//! last of them.
//!
//! The first generation comes from the visibility algorithm: it knows what each sample sees first. Only samples on mirrors
//! and on transparent surfaces are followed, each with a ray of its own (stratified, as samples are); all others are shaded
//! as without ray tracing, byte for byte.
//!
//! In:   points of a tile, with normals and weights. Out: their colours, premultiplied.
//! Cost: a search in the structure (`--acceleration`) for each ray, and one for each light at each hit.
//! Source: \[Whitted 1980\]; refraction after \[Heckbert 1989\], scattering after
//! \[Cook, Porter & Carpenter 1984\]. Departs from them: opacity says what is transmitted, the
//! material's flag `mirror` says which surfaces show images; bodies of glass must be closed to bend light.

use super::coincident::{Pile, Piles, unit_normal};
use super::media::{Border, Media};
use super::rays::{Branch, Haze, Rays, add, counts};
use super::sky::Sky;
use super::surface::Surface;
use super::tell::Teller;
use crate::marks::MarkColors;
use crate::prepare::mirrors;
use crate::raytrace::beam::Beam;
use crate::raytrace::chosen::Chosen;
use crate::raytrace::intersect::Ray;
use crate::raytrace::triangles::Triangles;
use crate::raytrace::{Counters, Visitor};
use crate::shading::hits::Hit;
use crate::shading::{Bounce, FrameConstants, Lit, Points, shade_hits};
use crate::shadow::{Place, clearance, facet, hash, weighted, weights};
use crate::stats::TracingCounters;
use crate::transparency::scattering::Strata;
use crate::visible::nearer;
use crate::{Acceleration, Execution, Settings};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use vitral_exec::Limit;
use vitral_light::transmitted;
use vitral_math::lanes::{LANES, Simd, dispatch};
use vitral_math::{DMat3, DVec3, Vec3, dvec3};
use vitral_raster::{Layer, Tile};
use vitral_scene::bodies::Side;

/// A branch whose light makes less of a byte is not followed: the steps are twice as large.
const LEAST_SEEN: f32 = 1.0 / 512.0;
/// How steep the sRGB encoding is in the dark.
const STEEPEST: f32 = 12.92;
/// A direction that is in no simple ratio to the axes.
const ASKEW: Vec3 = Vec3::new(0.531_7, 0.681_9, 0.502_3);
/// Depths that differ by less may be those of faces that coincide: their corners were snapped to 1/256 pixel, and a steep face's
/// depth changes much along that. A probe tells for certain.
const SAME_DEPTH: f32 = 1.0 / (1 << 14) as f32;
/// Samples whose trees are followed together.
const TOGETHER: usize = 2048;

/// Ray tracing of one picture.
pub(crate) struct Whitted<'a> {
    constants: &'a FrameConstants<'a>,
    execution: &'a Execution,
    structure: Chosen,
    /// What the eye is in.
    surroundings: Media,
    max_depth: u32,
    /// What a branch's light must count at least to be followed.
    least: f32,
    /// The directions in which each sample sees through the first translucent surface.
    strata: Strata,
    sky: Sky,
    /// World to view directions.
    view_from_world: DMat3,
    /// Width of a pixel at the distance 1, or everywhere for parallel rays.
    pixel: f64,
    charged: u64,
    tiles: u64,
    tiles_done: AtomicU64,
    outcome: Mutex<Result<TracingCounters, Limit>>,
}

/// A surface that a ray met: its light and properties, by number.
struct Met<'a> {
    lit: &'a Lit,
    at: usize,
    /// Whether the ray came from the side from which the facet's corners run clockwise.
    from_behind: bool,
}

/// The first surfaces of a tile.
pub(crate) struct Front {
    /// Them, transparent or not.
    pub(crate) tile: Tile,
    /// Lines and points in front of them.
    pub(crate) marked: Vec<Layer>,
    /// Facets, in order, at some samples of which another is as deep.
    touching: Vec<u32>,
}

/// Memory of one tile's work, used again for the next.
#[derive(Default)]
pub(crate) struct Forest {
    rays: Rays,
    next: Rays,
    piles: Piles,
    /// Rays that hit, and whether they came from behind the facet.
    hitting: Vec<(Branch, bool)>,
    hits: Vec<Hit>,
    points: Points,
    lit: Lit,
}

impl<'a> Whitted<'a> {
    pub(crate) fn new(
        constants: &'a FrameConstants<'a>,
        settings: &Settings,
        tiles: u64,
        execution: &'a Execution,
    ) -> Result<Self, Limit> {
        let view = constants.view;
        let facets = u64::from(view.session.world.facet_count);
        if view.acceleration == Acceleration::None {
            // About as many rays as samples.
            let samples = u64::from(view.viewport.width) * u64::from(view.viewport.height) * view.pattern.len() as u64;
            execution.budget.check_work(samples.saturating_mul(facets), "ray tracing without a structure")?;
        }
        let forests = (execution.workers.threads() * TOGETHER * 8) as u64 * size_of::<(Branch, Hit)>() as u64;
        let charged = Triangles::bytes(facets) + Chosen::bytes(view.acceleration, facets) + forests;
        execution.budget.charge(charged, "ray tracing")?;
        let structure = Chosen::new(view.acceleration, view.session, execution)
            .inspect_err(|_| execution.budget.release(charged))?;
        let view_from_world = DMat3::from_mat4(view.view.view_from_world);
        let stretch = view.view.clip_from_view.col(1).y;
        let mut whitted = Self {
            constants,
            execution,
            structure,
            surroundings: Media::default(),
            max_depth: settings.max_depth,
            least: least_weight(constants),
            strata: Strata::new(settings.scatter_samples.div_ceil(settings.samples)),
            sky: Sky { stretch, perspective: view.view.perspective },
            view_from_world,
            pixel: 2.0 / (stretch * f64::from(view.viewport.height)),
            charged,
            tiles,
            tiles_done: AtomicU64::new(0),
            outcome: Mutex::new(Ok(TracingCounters::default())),
        };
        whitted.surroundings = whitted.surroundings();
        Ok(whitted)
    }

    /// What the eye is in: what a ray to it from afar enters and does not leave. In a parallel view it is far away.
    fn surroundings(&self) -> Media {
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

    /// What was done, or why it ended early.
    pub(crate) fn finish(self) -> Result<TracingCounters, Limit> {
        self.execution.budget.release(self.charged);
        self.outcome.into_inner().expect("no thread panics while it counts")
    }

    /// The first surface at each sample of a tile. What lies behind is for rays to find.
    pub(crate) fn frontmost(&self, tile: &Tile, layers: &[Layer], marks: &MarkColors) -> Front {
        let (mut front, mut touching) = (tile.clone(), Vec::new());
        for layer in layers.iter().filter(|l| marks.index(l.facet).is_none()) {
            let (at, candidate) = (layer.at as usize, (layer.depth, layer.facet));
            if (layer.depth - front.depth[at]).abs() < SAME_DEPTH {
                touching.extend([layer.facet, front.facet[at]]);
            }
            if nearer(candidate, (front.depth[at], front.facet[at])) {
                (front.depth[at], front.facet[at]) = candidate;
                front.touched = true;
            }
        }
        let before = |l: &&Layer| {
            let at = l.at as usize;
            marks.index(l.facet).is_some() && nearer((l.depth, l.facet), (front.depth[at], front.facet[at]))
        };
        let marked = layers.iter().filter(before).copied().collect();
        touching.sort_unstable();
        touching.dedup();
        Front { tile: front, marked, touching }
    }

    /// Adds to the points of a tile what mirrors and glass show there.
    pub(crate) fn follow(&self, front: &Front, points: &Points, lit: &mut Lit, forest: &mut Forest) {
        let mut counters = TracingCounters { shadow_rays: lit.shadow_rays, ..TracingCounters::default() };
        let teller = self.execution.observer.as_deref().map(|observer| Teller {
            observer,
            pixels: &points.place,
            center: self.structure.triangles().center,
            constants: self.constants,
        });
        for together in points.followed.chunks(TOGETHER) {
            forest.rays.clear();
            forest.piles.clear();
            for &target in together {
                let bounce = lit.bounces[target as usize];
                let Place { position, facet: number, .. } = bounce.place;
                let (direction, travelled) = self.eye_ray(position);
                let (corners, from_behind) = self.seen(direction, number);
                let touches = front.touching.binary_search(&number).is_ok();
                let pile = || self.pile_at(&mut forest.piles, (number, corners), position, direction, true);
                let eye_ray = Branch {
                    target,
                    weight: [1.0; 4],
                    origin: position - direction * travelled,
                    direction,
                    own: u32::MAX,
                    media: self.surroundings,
                    pile: touches.then(pile).flatten(),
                    layer: 1,
                    depth: 0,
                    scattered: false,
                    least: self.least,
                    travelled: 0.0,
                    row: Some(points.place[target as usize][1] as u32),
                    seed: bounce.place.seed,
                };
                let met = Met { lit, at: target as usize, from_behind };
                if let Some(teller) = &teller {
                    teller.meets(&eye_ray, Some((number, travelled)), lit.colors[target as usize]);
                }
                let before = (forest.rays.len(), counters.total_reflections);
                self.branch(&eye_ray, travelled, &met, &forest.piles, &mut forest.rays, &mut counters);
                if let Some(teller) = &teller {
                    let surface = self.surface(&eye_ray, bounce.normal, &bounce.place);
                    teller.goes_on(&eye_ray, &surface, number, &forest.rays, before, &counters);
                }
            }
            forest.rays.settle(&mut lit.colors);
            while !forest.rays.is_empty() {
                if !self.may_go_on() {
                    return;
                }
                dispatch!(self.execution.level, simd => self.generation(simd, forest, lit, teller.as_ref(), &mut counters));
            }
        }
        if let Ok(sum) = &mut *self.outcome.lock().expect("no thread panics while it counts") {
            sum.add(&counters);
        }
    }

    /// One more tile is shaded, whether rays went on from it or not.
    pub(crate) fn tile_done(&self) {
        let done = self.tiles_done.fetch_add(1, Ordering::Relaxed) + 1;
        self.execution.budget.progress("ray tracing", done, self.tiles);
    }

    fn may_go_on(&self) -> bool {
        let checked = self.execution.budget.check("ray tracing");
        let mut outcome = self.outcome.lock().expect("no thread panics while it counts");
        if let (Err(limit), true) = (checked, outcome.is_ok()) {
            *outcome = Err(limit);
        }
        outcome.is_ok()
    }

    /// Follows all rays to what they meet, adds its light, and leaves the rays that go on from there.
    #[inline(always)]
    fn generation<S: Simd>(
        &self,
        simd: S,
        forest: &mut Forest,
        lit: &mut Lit,
        teller: Option<&Teller<'_>>,
        counters: &mut TracingCounters,
    ) {
        let Forest { rays, next, piles, hitting, hits, points, lit: met } = forest;
        hitting.clear();
        hits.clear();
        for ray in &rays.piled {
            let (Pile { position, .. }, places) = piles.get(ray.pile.expect("it is in one"));
            let place = places[ray.layer as usize] as usize;
            let (hit, from_behind) = self.meet(ray, place, *position);
            hitting.push((Branch { layer: ray.layer + 1, ..*ray }, from_behind));
            hits.push(hit);
        }
        let mut searched = Counters::default();
        for eight in rays.free.chunks(LANES) {
            let mut straight = [Ray::new(Vec3::ZERO, Vec3::Z); LANES];
            let mut own = [u32::MAX; LANES];
            for (lane, branch) in eight.iter().enumerate() {
                straight[lane] = Ray::new(branch.origin.as_vec3(), branch.direction.as_vec3());
                own[lane] = branch.own;
            }
            let (met, crowded) = self.structure.closest_hits(simd, &straight[..eight.len()], &own, &mut searched);
            for ((ray, met), crowded) in eight.iter().zip(met).zip(crowded) {
                let Some((place, t)) = met else {
                    let seen = self.background(ray);
                    add(&mut lit.colors[ray.target as usize], ray.weight, seen);
                    if let Some(teller) = teller {
                        teller.meets(ray, None, seen);
                    }
                    continue;
                };
                let position = ray.origin + ray.direction * f64::from(t);
                let (triangles, mut place) = (self.structure.triangles(), place);
                let facet = triangles.facets[place];
                let corners = || triangles.corners[place].map(|c| c.as_dvec3());
                let pile = || self.pile_at(piles, (facet, corners()), position, ray.direction, false);
                let pile = crowded.then(pile).flatten();
                if let Some(pile) = pile {
                    place = piles.get(pile).1[0] as usize;
                }
                let (hit, from_behind) = self.meet(ray, place, position);
                hitting.push((Branch { pile, layer: 1, ..*ray }, from_behind));
                hits.push(hit);
            }
        }
        counters.rays += rays.free.len() as u64;
        counters.box_tests += searched.boxes;
        counters.triangle_tests += searched.triangles;

        // Illuminate what was hit as if the eye saw it.
        points.collect_facets(hits.iter().map(|hit| hit.place.facet), self.constants);
        met.reset(hits.len(), self.constants);
        shade_hits(simd, points, hits, self.constants, met);
        counters.shadow_rays += met.shadow_rays;
        counters.hits += hits.len() as u64;

        next.clear();
        for (i, ((ray, from_behind), hit)) in hitting.iter().zip(hits.iter()).enumerate() {
            add(&mut lit.colors[ray.target as usize], ray.weight, met.colors[i]);
            if let Some(teller) = teller {
                let distance = ray.origin.distance(hit.place.position);
                teller.meets(ray, Some((hit.place.facet, distance)), met.colors[i]);
            }
            if self.constants.follows(hit.place.facet) {
                let travelled = ray.travelled + ray.origin.distance(hit.place.position);
                let met = Met { lit: met, at: i, from_behind: *from_behind };
                let before = (next.len(), counters.total_reflections);
                self.branch(ray, travelled, &met, piles, next, counters);
                if let Some(teller) = teller {
                    let surface = self.surface(ray, met.lit.bounces[i].normal, &hit.place);
                    teller.goes_on(ray, &surface, hit.place.facet, next, before, counters);
                }
            }
        }
        next.settle(&mut lit.colors);
        std::mem::swap(rays, next);
    }

    /// The direction in which the eye sees a place, and how far away it is.
    fn eye_ray(&self, position: DVec3) -> (DVec3, f64) {
        let (eye, perspective) = self.constants.view.eye();
        if !perspective {
            return (-self.view_from_world.row(2), 1.0);
        }
        let way = position - (eye - self.structure.triangles().center);
        let distance = way.length();
        (way / distance, distance)
    }

    /// The corners of a facet, and whether a ray in this direction comes from the side from which they run clockwise, in the
    /// world.
    #[inline]
    fn seen(&self, direction: DVec3, number: u32) -> ([DVec3; 3], bool) {
        let world = &self.constants.view.session.world;
        let instance = &world.instances[world.instance_of_facet(number)];
        let (corners, outward) = facet(instance, number - instance.first_facet, self.structure.triangles().center);
        let from_behind = (outward.dot(direction) > 0.0) != mirrors(&instance.world_from_model);
        (corners, from_behind)
    }

    /// The pile that a ray in this direction meets at a position on a facet, see [`Piles::add`].
    #[cold]
    fn pile_at(
        &self,
        piles: &mut Piles,
        (number, corners): (u32, [DVec3; 3]),
        position: DVec3,
        direction: DVec3,
        is_first: bool,
    ) -> Option<u32> {
        let normal = unit_normal(&corners).unwrap_or_default();
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        piles.add(&self.structure, (number, corners), (position, normal), is_first)
    }

    /// A ray that meets the triangle at this place of the structure's triangles, at `position`, and whether it comes from behind.
    #[inline]
    fn meet(&self, branch: &Branch, place: usize, position: DVec3) -> (Hit, bool) {
        let triangles = self.structure.triangles();
        let (corners, facet) = (&triangles.corners[place], triangles.facets[place]);

        // The weights of the corners where the ray meets the facet; then the place anew, which lies in its plane.
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
        let distance = if perspective { branch.travelled + branch.origin.distance(position) } else { 1.0 };
        let cos = -normal.dot(branch.direction);
        let along = (branch.direction + normal * cos).try_normalize().unwrap_or(normal.any_orthonormal_vector());
        let width = self.pixel * distance;
        let ways = [normal.cross(along) * width, along * (width / cos.max(0.05))];
        let whole = across.length_squared();
        let slope = |corner: usize, way: DVec3| {
            let edge = corners[(corner + 1) % 3] - corners[(corner + 2) % 3];
            if whole > 0.0 { (way.cross(edge).dot(across) / whole) as f32 } else { 0.0 }
        };
        let along_edges = |k: usize| [weights[k], slope(k, ways[0]), slope(k, ways[1])];
        let weights = [along_edges(0), along_edges(1), along_edges(2)];
        let origin = self.constants.view.view.view_from_world.transform_point3(branch.origin + triangles.center);
        let seed = branch.seed.wrapping_mul(0x2c92_77b5).wrapping_add(0xac56_4b05);
        let place = Place { position, normal, facet, seed, pixel: None };
        (Hit { weights, origin: origin.as_vec3().to_array(), place, row: branch.row }, from_behind)
    }

    /// The rays that go on where `ray` meets a surface.
    fn branch(
        &self,
        ray: &Branch,
        travelled: f64,
        met: &Met<'_>,
        piles: &Piles,
        rays: &mut Rays,
        counters: &mut TracingCounters,
    ) {
        let Met { lit, at, from_behind } = *met;
        let Bounce { normal, mirror, place } = lit.bounces[at];
        let alpha = lit.colors[at][3];
        let passes = lit.passes.get(at).copied().unwrap_or([1.0 - alpha; 3]);
        let weight = |part: [f32; 4]| [0, 1, 2, 3].map(|k| ray.weight[k] * part[k]);
        let passing = weight([passes[0], passes[1], passes[2], 1.0 - alpha]);
        let haze = Haze::new(self.constants, ray.row, place.position + self.structure.triangles().center);
        // The colour that it fades into was added with the surface's own light.
        let mut mirrored = weight([mirror[0], mirror[1], mirror[2], 0.0].map(|m| m * haze.kept));
        let surface = self.surface(ray, normal, &place);
        let go_on = Branch { own: place.facet, travelled, seed: place.seed, pile: None, ..*ray };
        let next = |towards: DVec3| place.position + towards * self.clearance(place.position);

        if counts(passing, ray.least) {
            let branch = Branch { weight: passing, origin: next(-surface.facet), ..go_on };
            let pile = ray.pile.map(|pile| piles.get(pile).1).unwrap_or_default();
            if pile.len() > ray.layer as usize {
                let branch = Branch { weight: passing, seed: place.seed, ..*ray };
                self.pass_to_next(&branch, (&surface, &haze), &place, rays, counters);
            } else if !self.pass(ray, &branch, (&surface, &haze), from_behind, pile, rays, counters) {
                counters.total_reflections += 1;
                let passing = rays.fade(ray.target, passing, &haze);
                mirrored = [0, 1, 2, 3].map(|k| mirrored[k] + passing[k]);
            }
        } else if passing != [0.0; 4] {
            counters.stopped_by_weight += 1;
            rays.end(ray.target, passing);
        }
        if counts(mirrored, ray.least) {
            if ray.depth < self.max_depth {
                counters.mirrored += 1;
                let (origin, depth) = (next(surface.facet), ray.depth + 1);
                let direction = surface.mirrored(ray.direction);
                rays.free.push(Branch { weight: mirrored, origin, direction, depth, row: None, ..go_on });
            } else {
                counters.stopped_by_depth += 1;
                rays.end(ray.target, mirrored);
            }
        } else if mirrored != [0.0; 4] {
            counters.stopped_by_weight += 1;
            rays.end(ray.target, mirrored);
        }
    }

    /// The rays that go on as `branch` behind a surface, or all of a pile, that `ray` meets. None do if all light is reflected:
    /// says so.
    fn pass(
        &self,
        ray: &Branch,
        branch: &Branch,
        (surface, haze): (&Surface, &Haze),
        from_behind: bool,
        pile: &[u32],
        rays: &mut Rays,
        counters: &mut TracingCounters,
    ) -> bool {
        let (direction, media, bent) = match self.through(ray, surface, (branch.own, from_behind), pile) {
            Way::Straight(media) => (ray.direction, media, false),
            Way::Bent(direction, media) => (direction, media, true),
            Way::None => return false,
        };
        let branch = Branch { media, ..*branch };
        let scatters = self.scatters(branch.own);
        if !bent && scatters.is_none() {
            counters.passed += 1;
            rays.free.push(branch);
            return true;
        }
        let branch = Branch { weight: rays.fade(branch.target, branch.weight, haze), ..branch };
        if ray.depth >= self.max_depth {
            counters.stopped_by_depth += 1;
            rays.end(branch.target, branch.weight);
        } else if let Some(exponent) = scatters {
            self.scatter(&branch, direction, surface, exponent, &mut rays.free, counters);
        } else {
            counters.refracted += 1;
            rays.free.push(Branch { direction, depth: ray.depth + 1, row: None, ..branch });
        }
        true
    }

    /// The rays that go on as `branch` to the next surface of a pile, at the same place.
    fn pass_to_next(
        &self,
        branch: &Branch,
        (surface, haze): (&Surface, &Haze),
        place: &Place,
        rays: &mut Rays,
        counters: &mut TracingCounters,
    ) {
        let Some(exponent) = self.scatters(place.facet) else {
            counters.passed += 1;
            rays.piled.push(*branch);
            return;
        };
        let branch = &Branch { weight: rays.fade(branch.target, branch.weight, haze), ..*branch };
        if branch.depth >= self.max_depth {
            counters.stopped_by_depth += 1;
            rays.end(branch.target, branch.weight);
            return;
        }
        let first = rays.piled.len();
        self.scatter(branch, branch.direction, surface, exponent, &mut rays.piled, counters);
        // They come to the place from where they would have come without the surface.
        let distance = branch.origin.distance(place.position);
        for ray in &mut rays.piled[first..] {
            ray.origin = place.position - ray.direction * distance;
        }
    }

    /// The rays that go on where a translucent surface scatters `branch`, which clear glass would send to `axis`.
    fn scatter(
        &self,
        branch: &Branch,
        axis: DVec3,
        surface: &Surface,
        exponent: f32,
        rays: &mut Vec<Branch>,
        counters: &mut TracingCounters,
    ) {
        let strata = if branch.scattered { Strata::new(1) } else { self.strata };
        let share = 1.0 / strata.count() as f32;
        let (weight, least) = (branch.weight.map(|w| w * share), branch.least * share);
        counters.scattered += u64::from(strata.count());
        for i in 0..strata.count() {
            let direction = surface.behind(strata.direction(i, branch.seed, exponent, axis));
            let (depth, seed) = (branch.depth + 1, hash(branch.seed ^ hash(i)));
            rays.push(Branch { weight, least, direction, depth, seed, scattered: true, row: None, ..*branch });
        }
    }

    /// The exponent with which a facet scatters what passes it, if it does.
    fn scatters(&self, number: u32) -> Option<f32> {
        self.material(number).and_then(|m| self.constants.material(Some(m)).scatters)
    }

    /// The material of a facet.
    fn material(&self, number: u32) -> Option<u32> {
        let world = &self.constants.view.session.world;
        let instance = &world.instances[world.instance_of_facet(number)];
        instance.mesh.material_of_triangle((number - instance.first_facet) as usize)
    }

    fn clearance(&self, position: DVec3) -> f64 {
        clearance(position, f64::from(self.structure.triangles().extent))
    }

    /// The surface on the ray's side.
    fn surface(&self, ray: &Branch, normal: [f32; 3], place: &Place) -> Surface {
        let [x, y, z] = normal.map(f64::from);
        let shading = (self.view_from_world.transpose() * dvec3(x, y, z)).normalize_or_zero();
        let facet = if place.normal.dot(ray.direction) > 0.0 { -place.normal } else { place.normal };
        // A shading normal that the ray cannot see is of no use.
        let usable = |n: DVec3| n.dot(ray.direction) < -1e-4;
        let n = [shading, -shading].into_iter().find(|n| usable(*n)).unwrap_or(facet);
        Surface { n, facet }
    }

    /// How the ray goes on behind the surface, or behind all those of a pile.
    fn through(&self, ray: &Branch, surface: &Surface, (number, from_behind): (u32, bool), pile: &[u32]) -> Way {
        let border = if pile.is_empty() {
            self.crossing(number, from_behind).map(|(material, entering)| ray.media.cross(material, entering))
        } else {
            let facet = |&place: &u32| self.structure.triangles().facets[place as usize];
            let crossings = pile.iter().map(facet).map(|f| self.crossing(f, self.seen(ray.direction, f).1));
            ray.media.cross_all(crossings.flatten())
        };
        let Some(Border { before, behind, then }) = border else { return Way::Straight(ray.media) };
        let index = |m: Option<u32>| m.map_or(1.0, |m| f64::from(self.constants.material(Some(m)).material.ior));
        let eta = index(before) / index(behind);
        if (eta - 1.0).abs() < 1e-6 {
            return Way::Straight(then);
        }
        let bent = transmitted(surface.n, -ray.direction, eta).filter(|t| t.dot(surface.facet) < 0.0);
        let bent = bent.or_else(|| transmitted(surface.facet, -ray.direction, eta));
        bent.map_or(Way::None, |direction| Way::Bent(direction.normalize(), then))
    }

    /// The material of the body that a ray enters (or leaves) where it meets a facet, if it is the skin of one.
    #[inline]
    fn crossing(&self, number: u32, from_behind: bool) -> Option<(u32, bool)> {
        let session = self.constants.view.session;
        let instance = &session.world.instances[session.world.instance_of_facet(number)];
        let triangle = (number - instance.first_facet) as usize;
        let material = instance.mesh.material_of_triangle(triangle)?;
        let side = session.sides(instance.mesh_index, &self.execution.workers)[triangle];
        if side == Side::None || self.constants.material(Some(material)).cutoff.is_some() {
            return None;
        }
        let from_outside = from_behind == mirrors(&instance.world_from_model);
        Some((material, from_outside == (side == Side::Behind)))
    }

    /// What a ray sees that meets nothing.
    fn background(&self, ray: &Branch) -> [f32; 4] {
        let background = &self.constants.background;
        let beyond = || self.sky.row(self.view_from_world * ray.direction, background.colors.len()) as u32;
        background.color(ray.row.unwrap_or_else(beyond))
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

/// How a ray goes on behind a surface.
enum Way {
    Straight(Media),
    Bent(DVec3, Media),
    /// Total internal reflection.
    None,
}

/// What a branch's light must count at least to be followed: brighter lights are seen through more, and in sRGB all of it is
/// seen in the dark.
fn least_weight(constants: &FrameConstants<'_>) -> f32 {
    let lights = constants.lights.iter().flat_map(|light| [light.ambient, light.diffuse, light.specular]);
    let glow = constants.materials.iter().map(|m| m.material.emission);
    let brightest = lights.chain(glow).flatten().filter(|channel| channel.is_finite()).fold(1.0, f32::max);
    LEAST_SEEN / brightest / if constants.raw { 1.0 } else { STEEPEST }
}
