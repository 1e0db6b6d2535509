//! Whitted's ray tracing: mirror images, refraction, and shadows that know both.
//!
//! A ray that meets a mirror goes on in the direction in which the mirror reflects it; one that
//! meets glass goes on behind it, bent as the two media ask; each of them may meet a mirror or
//! glass again. What a pixel shows is a tree of such rays:
//! `I = I_local + ks I_mirrored + kt I_transmitted`, where `I_local` is what the local model says
//! about each surface, with shadow rays. Where no light gets through a surface at that angle (total
//! internal reflection), all of it is mirrored. What is mirrored and what passes are never more
//! than what came: mirrors that bend light share it as Fresnel says, and where `ks` and `kt` are
//! together more than 1, both are scaled.
//!
//! A tree's rays are followed generation by generation, those of many samples together: what a
//! generation hits is sorted by object and material, and goes eight at a time through the very
//! formulas, textures and shadows of surfaces that the eye sees. Each ray carries the weight with
//! which its light counts; a branch ends where that is less than can be seen beside the light that
//! the point already has, or after `max-depth` turns. Straight ways, through sheets or through
//! glass whose index is that of its surroundings, are no turns.
//!
//! A translucent surface scatters what passes it: the ray goes on as many, in directions round that
//! of clear glass; those are scattered in one direction each where they meet another such surface.
//! In the same way a metal that is not quite smooth mirrors in directions round that of a mirror.
//!
//! Faces that coincide are met one after the other (see `coincident`), and are one border between
//! media: light bends behind the last of them.
//!
//! The first generation comes from the visibility algorithm: it knows what each sample sees first.
//! Only samples on mirrors and on transparent surfaces are followed, each with a ray of its own
//! (stratified, as samples are); all others are shaded as without ray tracing, byte for byte.
//!
//! In:   points of a tile, with normals and weights. Out: their colours, premultiplied.
//! Cost: a search in the structure (`--acceleration`) for each ray, and one for each light at each
//!       hit.
//! Source: \[Whitted 1980\]; refraction after \[Heckbert 1989\], scattering after \[Cook, Porter &
//! Carpenter 1984\]. Departs from them: opacity says what is transmitted, the material's flag
//! `mirror` says which surfaces show images; bodies of glass must be closed to bend light.

use super::branching::{Branching, RayHit};
use super::coincident::{CoincidentGroup, CoincidentGroups};
use super::media::Media;
use super::ray_scene::RayScene;
use super::rays::{Branch, Rays, add};
use super::trace_writer::TraceWriter;
use crate::marks::MarkColors;
use crate::raytrace::Counters;
use crate::raytrace::intersect::Ray;
use crate::raytrace::structures::AnyStructure;
use crate::raytrace::triangles::Triangles;
use crate::shading::{FrameConstants, Front, Hit, Points, ShadedPoints, Tracer, shade_hits};
use crate::shadow::{Strata, SurfacePoint};
use crate::stats::TracingCounters;
use crate::visible::nearer;
use crate::{Execution, Settings};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use vitral_exec::Limit;
use vitral_math::Vec3;
use vitral_math::lanes::{LANES, Simd, dispatch};
use vitral_raster::{Layer, Tile};

/// A branch whose light makes less of a byte is not followed: the steps are twice as large.
const LEAST_SEEN: f32 = 1.0 / 512.0;
/// How steep the sRGB encoding is in the dark.
const STEEPEST: f32 = 12.92;
/// Depths that differ by less may be those of faces that coincide: their corners were snapped to
/// 1/256 pixel, and a steep face's depth changes much along that. A probe tells for certain.
const SAME_DEPTH: f32 = 1.0 / (1 << 14) as f32;
/// Samples whose trees are followed together.
const TOGETHER: usize = 2048;

/// Ray tracing of one picture.
pub(crate) struct Whitted<'a> {
    branching: Branching<'a>,
    execution: &'a Execution,
    /// What the eye is in.
    surroundings: Media,
    /// What a branch's light must count at least to be followed.
    least: f32,
    spare_forests: Mutex<Vec<Forest>>,
    charged: u64,
    tiles: u64,
    tiles_done: AtomicU64,
    outcome: Mutex<Result<TracingCounters, Limit>>,
}

/// Memory of one tile's work, reused for the next tile.
#[derive(Default)]
struct Forest {
    rays: Rays,
    next: Rays,
    piles: CoincidentGroups,
    /// Rays that hit, and whether they came from behind the facet.
    hitting: Vec<(Branch, bool)>,
    hits: Vec<Hit>,
    points: Points,
    lit: ShadedPoints,
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
        // Refuse work that takes too long without an acceleration structure.
        if view.acceleration.asks_all {
            // About as many rays as samples.
            let samples = u64::from(view.viewport.width)
                * u64::from(view.viewport.height)
                * view.pattern.len() as u64;
            execution
                .budget
                .check_work(samples.saturating_mul(facets), "ray tracing without a structure")?;
        }

        // Charge for the structure and the trees of rays.
        let forests =
            (execution.workers.threads() * TOGETHER * 8) as u64 * size_of::<(Branch, Hit)>() as u64;
        let charged =
            Triangles::bytes(facets) + AnyStructure::bytes(view.acceleration, facets) + forests;
        execution.budget.charge(charged, "ray tracing")?;
        let structure = AnyStructure::new(view.acceleration, view.session, execution)
            .inspect_err(|_| execution.budget.release(charged))?;

        // Prepare the scene for rays.
        let scene = RayScene::new(constants, structure, &execution.workers);
        Ok(Self {
            surroundings: scene.surroundings(),
            branching: Branching {
                scene,
                max_depth: settings.global.max_depth,
                strata: Strata::new(
                    settings.transparency.scatter_samples.div_ceil(settings.picture.samples),
                ),
            },
            execution,
            least: least_weight(constants),
            spare_forests: Mutex::default(),
            charged,
            tiles,
            tiles_done: AtomicU64::new(0),
            outcome: Mutex::new(Ok(TracingCounters::default())),
        })
    }

    /// What was done, or why it ended early.
    pub(crate) fn finish(self) -> Result<TracingCounters, Limit> {
        self.execution.budget.release(self.charged);
        self.outcome.into_inner().expect("no thread panics while it counts")
    }

    fn may_go_on(&self) -> bool {
        let checked = self.execution.budget.check("ray tracing");
        let mut outcome = self.outcome.lock().expect("no thread panics while it counts");
        if let (Err(limit), true) = (checked, outcome.is_ok()) {
            *outcome = Err(limit);
        }
        outcome.is_ok()
    }

    /// Starts the trees of some samples at their first surfaces, which are illuminated: the rays
    /// that go on from there.
    fn plant(
        &self,
        targets: &[u32],
        front: &Front,
        points: &Points,
        lit: &mut ShadedPoints,
        forest: &mut Forest,
        writer: Option<&TraceWriter<'_>>,
        counters: &mut TracingCounters,
    ) {
        let scene = &self.branching.scene;
        forest.rays.clear();
        forest.piles.clear();
        for &target in targets {
            // Trace the eye's ray to the first surface.
            let bounce = lit.bounces[target as usize];
            let SurfacePoint { position, facet: number, .. } = bounce.place;
            let (direction, travelled) = scene.eye_ray(position);
            let (corners, from_behind) = scene.seen(direction, number);
            let touches = front.touching.binary_search(&number).is_ok();
            let pile =
                || scene.pile_at(&mut forest.piles, (number, corners), position, direction, true);
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
                ground: points.ground_at(&front.tile, target),
                seed: bounce.place.seed,
            };
            let so_far = lit.colors[target as usize];
            let met = RayHit { lit, at: target as usize, from_behind, so_far };

            // Report the hit to the observer.
            if let Some(writer) = writer {
                writer.meets(&eye_ray, Some((number, travelled)), lit.colors[target as usize]);
            }

            // Branch into mirrored and passing rays.
            let before = (forest.rays.len(), counters.total_reflections);
            self.branching.branch(
                &eye_ray,
                travelled,
                &met,
                &forest.piles,
                &mut forest.rays,
                counters,
            );
            if let Some(writer) = writer {
                let surface = scene.surface(&eye_ray, bounce.normal, &bounce.place);
                writer.goes_on(&eye_ray, &surface, number, &forest.rays, before, counters);
            }
        }

        // Add the rays that ended.
        forest.rays.settle(&mut lit.colors);
    }

    /// Follows all rays to what they meet, adds its light, and leaves the rays that go on from
    /// there.
    #[inline(always)]
    fn generation<S: Simd>(
        &self,
        simd: S,
        forest: &mut Forest,
        colors: &mut [[f32; 4]],
        writer: Option<&TraceWriter<'_>>,
        counters: &mut TracingCounters,
    ) {
        self.find_hits(simd, forest, colors, writer, counters);

        // Illuminate what was hit as if the eye saw it.
        let Forest { hits, points, lit: met, .. } = &mut *forest;
        let constants = self.branching.scene.constants;
        points.collect_facets(hits.iter().map(|hit| hit.place.facet), constants);
        met.reset(hits.len(), constants);
        shade_hits(simd, points, hits, constants, met);
        counters.shadow_rays += met.shadow_rays;
        counters.hits += hits.len() as u64;

        self.go_on(forest, colors, writer, counters);
        std::mem::swap(&mut forest.rays, &mut forest.next);
    }

    /// Finds what the rays of a generation hit; those that hit nothing see the background.
    #[inline(always)]
    fn find_hits<S: Simd>(
        &self,
        simd: S,
        forest: &mut Forest,
        colors: &mut [[f32; 4]],
        writer: Option<&TraceWriter<'_>>,
        counters: &mut TracingCounters,
    ) {
        let scene = &self.branching.scene;
        let Forest { rays, piles, hitting, hits, .. } = forest;
        hitting.clear();
        hits.clear();

        // Rays between surfaces that coincide meet the next one of them.
        for ray in &rays.piled {
            let (CoincidentGroup { position, .. }, places) =
                piles.get(ray.pile.expect("it is in one"));
            let place = places[ray.layer as usize] as usize;
            let (hit, from_behind) = scene.meet(ray, place, *position);
            hitting.push((Branch { layer: ray.layer + 1, ..*ray }, from_behind));
            hits.push(hit);
        }

        // Search the structure for the others, eight at a time.
        let mut searched = Counters::default();
        for eight in rays.free.chunks(LANES) {
            let mut straight = [Ray::new(Vec3::ZERO, Vec3::Z); LANES];
            let mut own = [u32::MAX; LANES];
            for (lane, branch) in eight.iter().enumerate() {
                straight[lane] = Ray::new(branch.origin.as_vec3(), branch.direction.as_vec3());
                own[lane] = branch.own;
            }
            let (met, crowded) =
                scene.structure.closest_hits(simd, &straight[..eight.len()], &own, &mut searched);
            for ((ray, met), crowded) in eight.iter().zip(met).zip(crowded) {
                // Add the background of rays that hit nothing.
                let Some((place, t)) = met else {
                    let seen = scene.background(ray);
                    add(&mut colors[ray.target as usize], ray.weight, seen);
                    if let Some(writer) = writer {
                        writer.meets(ray, None, seen);
                    }
                    continue;
                };

                // Find the facets that coincide with the one that was hit.
                let position = ray.origin + ray.direction * f64::from(t);
                let (triangles, mut place) = (scene.structure.triangles(), place);
                let facet = triangles.facets[place];
                let corners = || triangles.corners[place].map(|c| c.as_dvec3());
                let pile =
                    || scene.pile_at(piles, (facet, corners()), position, ray.direction, false);
                let pile = crowded.then(pile).flatten();
                if let Some(pile) = pile {
                    place = piles.get(pile).1[0] as usize;
                }
                let (hit, from_behind) = scene.meet(ray, place, position);
                hitting.push((Branch { pile, layer: 1, ..*ray }, from_behind));
                hits.push(hit);
            }
        }

        // Count the work.
        counters.rays += rays.free.len() as u64;
        counters.box_tests += searched.boxes;
        counters.triangle_tests += searched.triangles;
    }

    /// Adds the light of what the rays of a generation hit, and finds the rays of the next.
    #[inline(always)]
    fn go_on(
        &self,
        forest: &mut Forest,
        colors: &mut [[f32; 4]],
        writer: Option<&TraceWriter<'_>>,
        counters: &mut TracingCounters,
    ) {
        let scene = &self.branching.scene;
        let Forest { next, piles, hitting, hits, lit: met, .. } = forest;
        next.clear();
        for (i, ((ray, from_behind), hit)) in hitting.iter().zip(hits.iter()).enumerate() {
            // Add the light of the hit.
            add(&mut colors[ray.target as usize], ray.weight, met.colors[i]);
            if let Some(writer) = writer {
                let distance = ray.origin.distance(hit.place.position);
                writer.meets(ray, Some((hit.place.facet, distance)), met.colors[i]);
            }

            // Branch where the surface mirrors or lets light through.
            if scene.constants.follows(hit.place.facet) {
                let travelled = ray.travelled + ray.origin.distance(hit.place.position);
                let so_far = colors[ray.target as usize];
                let met = RayHit { lit: met, at: i, from_behind: *from_behind, so_far };
                let before = (next.len(), counters.total_reflections);
                self.branching.branch(ray, travelled, &met, piles, next, counters);
                if let Some(writer) = writer {
                    let surface = scene.surface(ray, met.lit.bounces[i].normal, &hit.place);
                    writer.goes_on(ray, &surface, hit.place.facet, next, before, counters);
                }
            }
        }
        next.settle(colors);
    }
}

impl Tracer for Whitted<'_> {
    fn front(&self, tile: &Tile, layers: &[Layer], marks: &MarkColors) -> Front {
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
            marks.index(l.facet).is_some()
                && nearer((l.depth, l.facet), (front.depth[at], front.facet[at]))
        };
        let marked = layers.iter().filter(before).copied().collect();
        touching.sort_unstable();
        touching.dedup();
        Front { tile: front, marked, touching }
    }

    fn follow(&self, front: &Front, points: &Points, lit: &mut ShadedPoints) {
        // Prepare the counters, and a writer if somebody observes.
        let mut counters =
            TracingCounters { shadow_rays: lit.shadow_rays, ..TracingCounters::default() };
        let scene = &self.branching.scene;
        let writer = self.execution.observer.as_deref().map(|observer| TraceWriter {
            observer,
            pixels: &points.place,
            center: scene.structure.triangles().center,
            constants: scene.constants,
        });
        let writer = writer.as_ref();
        let mut forest =
            self.spare_forests.lock().expect("spare forests").pop().unwrap_or_default();

        // Grow the trees of some samples at a time, generation by generation.
        for targets in points.followed.chunks(TOGETHER) {
            self.plant(targets, front, points, lit, &mut forest, writer, &mut counters);
            while !forest.rays.is_empty() {
                if !self.may_go_on() {
                    return;
                }
                let (level, colors) = (self.execution.level, &mut lit.colors);
                dispatch!(level, simd => self.generation(simd, &mut forest, colors, writer, &mut counters));
            }
        }

        // Return the memory and add the counters.
        self.spare_forests.lock().expect("spare forests").push(forest);
        if let Ok(sum) = &mut *self.outcome.lock().expect("no thread panics while it counts") {
            sum.add(&counters);
        }
    }

    fn tile_done(&self) {
        let done = self.tiles_done.fetch_add(1, Ordering::Relaxed) + 1;
        self.execution.budget.progress("ray tracing", done, self.tiles);
    }
}

/// What a branch's light must count at least to be followed: brighter lights are seen through more,
/// and in sRGB all of it is seen in the dark.
fn least_weight(constants: &FrameConstants<'_>) -> f32 {
    let lights =
        constants.lights.iter().flat_map(|light| [light.ambient, light.diffuse, light.specular]);
    let glow = constants.materials.iter().map(|m| m.material.emission);
    let brightest =
        lights.chain(glow).flatten().filter(|channel| channel.is_finite()).fold(1.0, f32::max);
    LEAST_SEEN / brightest / if constants.raw { 1.0 } else { STEEPEST }
}
