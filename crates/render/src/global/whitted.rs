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
//! The first generation comes from the visibility algorithm: it knows what each sample sees first. Only samples on mirrors
//! and on transparent surfaces are followed, each with a ray of its own (stratified, as samples are); all others are shaded
//! as without ray tracing, byte for byte.
//!
//! In:   points of a tile, with normals and weights. Out: their colours, premultiplied.
//! Cost: a search in the tree of boxes for each ray, and one for each light at each hit.
//! Source: \[Whitted 1980\]; refraction after \[Heckbert 1989\], scattering after
//! \[Cook, Porter & Carpenter 1984\]. Departs from them: opacity says what is transmitted, the
//! material's flag `mirror` says which surfaces show images; bodies of glass must be closed to bend light.

use super::media::{Border, Media};
use crate::marks::MarkColors;
use crate::prepare::mirrors;
use crate::raytrace::bvh::Bvh;
use crate::raytrace::intersect::Ray;
use crate::raytrace::triangles::Triangles;
use crate::raytrace::{Counters, Structure};
use crate::shading::hits::Hit;
use crate::shading::{Bounce, FrameConstants, Lit, Points, shade_hits};
use crate::shadow::{Place, clearance, facet, hash, weighted, weights};
use crate::stats::TracingCounters;
use crate::transparency::scattering::Strata;
use crate::visible::nearer;
use crate::{Execution, Settings};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use vitral_exec::Limit;
use vitral_light::transmitted;
use vitral_math::lanes::{LANES, Simd, dispatch};
use vitral_math::{DMat3, DVec3, Vec3, dvec3};
use vitral_raster::{Layer, Tile};
use vitral_scene::bodies::Side;

/// A branch whose light counts less is not followed: the steps of a byte are twice as large.
const LEAST_WEIGHT: f32 = 1.0 / 512.0;
/// Samples whose trees are followed together.
const TOGETHER: usize = 2048;

/// Ray tracing of one picture.
pub(crate) struct Whitted<'a> {
    constants: &'a FrameConstants<'a>,
    execution: &'a Execution,
    tree: Arc<Bvh>,
    max_depth: u32,
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

/// A ray, and what it is for.
#[derive(Clone, Copy)]
struct Branch {
    /// The point whose colour it adds to.
    target: u32,
    /// How its red, green, blue and alpha count.
    weight: [f32; 4],
    /// Where it starts, world space less the scene's middle.
    origin: DVec3,
    /// Where it goes, unit, world space.
    direction: DVec3,
    /// The facet that it leaves.
    own: u32,
    media: Media,
    /// Turns that it took.
    depth: u32,
    /// It is one of many that a translucent surface scattered.
    scattered: bool,
    /// What its light must count at least to be followed.
    least: f32,
    /// Distance from the eye to its start.
    travelled: f64,
    /// Row of the picture whose background it sees; `None` after a turn.
    row: Option<u32>,
    seed: u32,
}

/// A surface that a ray met: its light and properties, by number.
struct Met<'a> {
    lit: &'a Lit,
    at: usize,
    /// Whether the ray came from the side from which the facet's corners run clockwise.
    from_behind: bool,
}

/// Memory of one tile's work, used again for the next.
#[derive(Default)]
pub(crate) struct Forest {
    rays: Vec<Branch>,
    next: Vec<Branch>,
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
        let forests = (execution.workers.threads() * TOGETHER * 8) as u64 * size_of::<(Branch, Hit)>() as u64;
        let charged = Triangles::bytes(facets) + Bvh::bytes(facets) + forests;
        execution.budget.charge(charged, "ray tracing")?;
        let tree = view.session.bvh(execution).inspect_err(|_| execution.budget.release(charged))?;
        let view_from_world = DMat3::from_mat4(view.view.view_from_world);
        let stretch = view.view.clip_from_view.col(1).y;
        Ok(Self {
            constants,
            execution,
            tree,
            max_depth: settings.max_depth,
            strata: Strata::new(settings.scatter_samples.div_ceil(settings.samples)),
            sky: Sky { stretch, perspective: view.view.perspective },
            view_from_world,
            pixel: 2.0 / (stretch * f64::from(view.viewport.height)),
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

    /// The tile with the first surface at each sample, transparent or not, and the lines and points in front of it. What
    /// lies behind is for rays to find.
    pub(crate) fn frontmost(&self, tile: &Tile, layers: &[Layer], marks: &MarkColors) -> (Tile, Vec<Layer>) {
        let mut front = tile.clone();
        for layer in layers.iter().filter(|l| marks.index(l.facet).is_none()) {
            let (at, candidate) = (layer.at as usize, (layer.depth, layer.facet));
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
        (front, marked)
    }

    /// Adds to the points of a tile what mirrors and glass show there.
    pub(crate) fn follow(&self, points: &Points, lit: &mut Lit, forest: &mut Forest) {
        let mut counters = TracingCounters { shadow_rays: lit.shadow_rays, ..TracingCounters::default() };
        for together in points.followed.chunks(TOGETHER) {
            forest.rays.clear();
            for &target in together {
                let bounce = lit.bounces[target as usize];
                let (direction, travelled) = self.eye_ray(bounce.place.position);
                let eye_ray = Branch {
                    target,
                    weight: [1.0; 4],
                    origin: bounce.place.position,
                    direction,
                    own: u32::MAX,
                    media: Media::default(),
                    depth: 0,
                    scattered: false,
                    least: LEAST_WEIGHT,
                    travelled,
                    row: Some(points.place[target as usize][1] as u32),
                    seed: bounce.place.seed,
                };
                let met =
                    Met { lit, at: target as usize, from_behind: self.comes_from_behind(&eye_ray, bounce.place.facet) };
                self.branch(&eye_ray, travelled, &met, &mut forest.rays, &mut counters);
            }
            while !forest.rays.is_empty() {
                if !self.may_go_on() {
                    return;
                }
                dispatch!(self.execution.level, simd => self.generation(simd, forest, lit, &mut counters));
            }
        }
        if let Ok(sum) = &mut *self.outcome.lock().expect("no thread panics while it counts") {
            sum.add(&counters);
        }
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
    fn generation<S: Simd>(&self, simd: S, forest: &mut Forest, lit: &mut Lit, counters: &mut TracingCounters) {
        let Forest { rays, next, hitting, hits, points, lit: met } = forest;
        hitting.clear();
        hits.clear();
        let mut searched = Counters::default();
        for eight in rays.chunks(LANES) {
            let mut straight = [Ray::new(Vec3::ZERO, Vec3::Z); LANES];
            let mut own = [u32::MAX; LANES];
            for (lane, branch) in eight.iter().enumerate() {
                straight[lane] = Ray::new(branch.origin.as_vec3(), branch.direction.as_vec3());
                own[lane] = branch.own;
            }
            let met = self.tree.closest_hits(simd, &straight[..eight.len()], &own, &mut searched);
            for (ray, met) in eight.iter().zip(met) {
                let Some((place, t)) = met else {
                    add(&mut lit.colors[ray.target as usize], ray.weight, self.background(ray));
                    continue;
                };
                let (hit, from_behind) = self.meet(ray, place, t);
                hitting.push((*ray, from_behind));
                hits.push(hit);
            }
        }
        counters.rays += rays.len() as u64;
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
            if self.constants.follows(hit.place.facet) {
                let travelled = ray.travelled + ray.origin.distance(hit.place.position);
                let met = Met { lit: met, at: i, from_behind: *from_behind };
                self.branch(ray, travelled, &met, next, counters);
            }
        }
        std::mem::swap(rays, next);
    }

    /// The direction in which the eye sees a place, and how far away it is.
    fn eye_ray(&self, position: DVec3) -> (DVec3, f64) {
        let (eye, perspective) = self.constants.view.eye();
        if !perspective {
            return (-self.view_from_world.row(2), 1.0);
        }
        let way = position - (eye - self.tree.triangles().center);
        let distance = way.length();
        (way / distance, distance)
    }

    /// Whether a ray comes from the side from which the facet's corners run clockwise, in the world.
    fn comes_from_behind(&self, ray: &Branch, number: u32) -> bool {
        let world = &self.constants.view.session.world;
        let instance = &world.instances[world.instance_of_facet(number)];
        let (_, outward) = facet(instance, number - instance.first_facet, self.tree.triangles().center);
        (outward.dot(ray.direction) > 0.0) != mirrors(&instance.world_from_model)
    }

    /// Where a ray meets the triangle at this place of the tree's triangles, at `t`, and whether it comes from behind.
    #[inline]
    fn meet(&self, branch: &Branch, place: usize, t: f32) -> (Hit, bool) {
        let triangles = self.tree.triangles();
        let (corners, facet) = (&triangles.corners[place], triangles.facets[place]);

        // The weights of the corners where the ray meets the facet; then the place anew, which lies in its plane.
        let weights = weights(corners, branch.origin + branch.direction * f64::from(t)).map(|w| w.clamp(0.0, 1.0));
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
        (Hit { weights, origin: origin.as_vec3().to_array(), place }, from_behind)
    }

    /// The rays that go on where `ray` meets a surface.
    fn branch(
        &self,
        ray: &Branch,
        travelled: f64,
        met: &Met<'_>,
        rays: &mut Vec<Branch>,
        counters: &mut TracingCounters,
    ) {
        let Met { lit, at, from_behind } = *met;
        let Bounce { normal, mirror, place } = lit.bounces[at];
        let alpha = lit.colors[at][3];
        let passes = lit.passes.get(at).copied().unwrap_or([1.0 - alpha; 3]);
        let weight = |part: [f32; 4]| [0, 1, 2, 3].map(|k| ray.weight[k] * part[k]);
        let passing = weight([passes[0], passes[1], passes[2], 1.0 - alpha]);
        let mut mirrored = weight([mirror[0], mirror[1], mirror[2], 0.0]);
        let surface = self.surface(ray, normal, &place);
        let go_on = Branch { own: place.facet, travelled, seed: place.seed, ..*ray };
        let next = |towards: DVec3| place.position + towards * self.clearance(place.position);

        if counts(passing, ray.least) {
            let way = self.through(ray, &surface, place.facet, from_behind);
            let exponent = self.material(place.facet).and_then(|m| self.constants.material(Some(m)).scatters);
            match (exponent, way) {
                (Some(exponent), Way::Straight(media)) => {
                    let branch = Branch { weight: passing, origin: next(-surface.facet), media, ..go_on };
                    self.scatter(&branch, ray.direction, &surface, exponent, rays, counters);
                }
                (Some(exponent), Way::Bent(direction, media)) => {
                    let branch = Branch { weight: passing, origin: next(-surface.facet), media, ..go_on };
                    self.scatter(&branch, direction, &surface, exponent, rays, counters);
                }
                (None, Way::Straight(media)) => {
                    counters.passed += 1;
                    rays.push(Branch { weight: passing, origin: next(-surface.facet), media, ..go_on });
                }
                (None, Way::Bent(direction, media)) if ray.depth < self.max_depth => {
                    counters.refracted += 1;
                    let origin = next(-surface.facet);
                    let depth = ray.depth + 1;
                    rays.push(Branch { weight: passing, origin, direction, media, depth, row: None, ..go_on });
                }
                (None, Way::Bent(..)) => counters.stopped_by_depth += 1,
                (_, Way::None) => {
                    counters.total_reflections += 1;
                    mirrored = [0, 1, 2, 3].map(|k| mirrored[k] + passing[k]);
                }
            }
        } else if passing != [0.0; 4] {
            counters.stopped_by_weight += 1;
        }
        if counts(mirrored, ray.least) {
            if ray.depth < self.max_depth {
                counters.mirrored += 1;
                let (origin, depth) = (next(surface.facet), ray.depth + 1);
                let direction = surface.mirrored(ray.direction);
                rays.push(Branch { weight: mirrored, origin, direction, depth, row: None, ..go_on });
            } else {
                counters.stopped_by_depth += 1;
            }
        } else if mirrored != [0.0; 4] {
            counters.stopped_by_weight += 1;
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
        if branch.depth >= self.max_depth {
            counters.stopped_by_depth += 1;
            return;
        }
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

    /// The material of a facet.
    fn material(&self, number: u32) -> Option<u32> {
        let world = &self.constants.view.session.world;
        let instance = &world.instances[world.instance_of_facet(number)];
        instance.mesh.material_of_triangle((number - instance.first_facet) as usize)
    }

    fn clearance(&self, position: DVec3) -> f64 {
        clearance(position, f64::from(self.tree.triangles().extent))
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

    /// How the ray goes on behind the surface.
    fn through(&self, ray: &Branch, surface: &Surface, number: u32, from_behind: bool) -> Way {
        let session = self.constants.view.session;
        let instance = &session.world.instances[session.world.instance_of_facet(number)];
        let triangle = number - instance.first_facet;
        let Some(material) = instance.mesh.material_of_triangle(triangle as usize) else {
            return Way::Straight(ray.media);
        };
        let side = session.sides(instance.mesh_index, &self.execution.workers)[triangle as usize];
        if side == Side::None || self.constants.material(Some(material)).cutoff.is_some() {
            return Way::Straight(ray.media);
        }

        // Which media meet here?
        let from_outside = from_behind == mirrors(&instance.world_from_model);
        let entering = from_outside == (side == Side::Behind);
        let Border { before, behind, then } =
            if entering { ray.media.enter(material) } else { ray.media.leave(material) };
        let index = |m: Option<u32>| m.map_or(1.0, |m| f64::from(self.constants.material(Some(m)).material.ior));
        let eta = index(before) / index(behind);
        if (eta - 1.0).abs() < 1e-6 {
            return Way::Straight(then);
        }
        let bent = transmitted(surface.n, -ray.direction, eta).filter(|t| t.dot(surface.facet) < 0.0);
        let bent = bent.or_else(|| transmitted(surface.facet, -ray.direction, eta));
        bent.map_or(Way::None, |direction| Way::Bent(direction.normalize(), then))
    }

    /// What a ray sees that meets nothing.
    fn background(&self, ray: &Branch) -> [f32; 4] {
        let rows = &self.constants.background.colors;
        let row = match ray.row {
            Some(row) => row as usize,
            None => self.sky.row(self.view_from_world * ray.direction, rows.len()),
        };
        rows[row.min(rows.len() - 1)]
    }
}

/// How a ray goes on behind a surface.
enum Way {
    Straight(Media),
    Bent(DVec3, Media),
    /// Total internal reflection.
    None,
}

/// Normals on the side from which a ray comes, world space, unit.
struct Surface {
    /// Of the shape that the facets stand for.
    n: DVec3,
    /// Of the facet.
    facet: DVec3,
}

impl Surface {
    /// The direction, on the side to which light goes that passes: the other half of the lobe is folded over.
    fn behind(&self, direction: DVec3) -> DVec3 {
        let towards = self.facet.dot(direction);
        if towards < 0.0 { direction } else { direction - self.facet * (2.0 * towards) }
    }

    /// The direction in which a mirror sends a ray: it leaves at the angle at which it came, and not into the facet.
    fn mirrored(&self, direction: DVec3) -> DVec3 {
        let about = |n: DVec3| direction - n * (2.0 * n.dot(direction));
        let mirrored = about(self.n);
        if mirrored.dot(self.facet) > 0.0 { mirrored.normalize() } else { about(self.facet).normalize() }
    }
}

/// The background all round the scene: what the picture shows in each row, and the first and last row beyond it.
struct Sky {
    /// Half of the picture's height, at the distance 1, times this is 1.
    stretch: f64,
    perspective: bool,
}

impl Sky {
    /// The row in which a direction (view space) leaves a picture of `rows` rows.
    fn row(&self, direction: DVec3, rows: usize) -> usize {
        let up = if self.perspective { direction.y / (-direction.z).max(1e-9) * self.stretch } else { direction.y };
        let from_top = (1.0 - up.clamp(-1.0, 1.0)) * 0.5;
        ((from_top * rows as f64) as usize).min(rows - 1)
    }
}

fn counts(weight: [f32; 4], least: f32) -> bool {
    weight.iter().any(|&w| w >= least)
}

fn add(sum: &mut [f32; 4], weight: [f32; 4], color: [f32; 4]) {
    for k in 0..4 {
        sum[k] += weight[k] * color[k];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p36_e14_mirrors_obey_the_law_of_reflection() {
        let surface = Surface { n: DVec3::Y, facet: DVec3::Y };
        let down = dvec3(0.6, -0.8, 0.0);
        assert!(surface.mirrored(down).abs_diff_eq(dvec3(0.6, 0.8, 0.0), 1e-15));
        // A bent normal must not send the ray into the facet.
        let tilted = Surface { n: dvec3(0.8, 0.6, 0.0), facet: DVec3::Y };
        let grazing = dvec3(-0.6, -0.05, 0.0).normalize();
        assert!(tilted.mirrored(grazing).y > 0.0);
    }

    #[test]
    fn the_sky_goes_on_from_the_picture() {
        let sky = Sky { stretch: 2.0, perspective: true };
        assert_eq!(sky.row(dvec3(0.3, 0.0, -1.0), 100), 50);
        assert_eq!(sky.row(dvec3(0.0, 0.25, -1.0), 100), 25);
        assert_eq!([sky.row(DVec3::Y, 100), sky.row(DVec3::NEG_Y, 100)], [0, 99]);
    }
}
