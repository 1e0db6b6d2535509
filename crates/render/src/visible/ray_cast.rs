//! Ray casting: a ray through every sample, and what it meets first.
//!
//! A tree of boxes finds the triangles near a ray without looking at the others; the nearest box is opened first, and
//! once a facet is found, boxes that begin behind it are passed over. The tree lies in the world and serves every view.
//!
//! So that the picture is that of the other algorithms sample by sample, rays only *find*; what covers a sample and how
//! near it is there is decided on the screen, by `Setup::covers` and `Setup::depth`. Corners on the screen are snapped,
//! so a facet may cover a sample whose ray misses it by a hair: rays are beams, wider than snapping and rounding can
//! move a corner. And the depth on the screen rounds, so a box is passed over only if it lies behind by more than its
//! facets' depths can be wrong. Facets that were culled in this view do not count, nor do boxes with nothing else.
//!
//! In:   prepared draws (model space). Out: the samples of each tile (screen space).
//! Cost: `O(log n)` for each sample in scenes of everyday, after `O(n log n)` for the tree and `O(n)` for a view.
//! Source: [Appel 1968]; the tree after [Rubin & Whitted 1980]. Departs from them: see above; and the facet that the
//!       ray before met is tried first.

use super::brute_force::{each_tile, size_in_picture};
use super::facets::nearer;
use super::screen_setups::{ScreenSetups, charged};
use super::{Resolved, TileSink, VisibleSurface};
use crate::raytrace::beam::Beam;
use crate::raytrace::bvh::{Bvh, Visitor};
use crate::stats::VisibilityCounters;
use crate::{Execution, PreparedView};
use vitral_exec::Limit;
use vitral_math::{DMat4, DVec3, Vec3, vec3};
use vitral_raster::{Batch, Layer, NO_FACET, SUBPIXEL, Setup, TILE, TILE_PIXELS, Tile, TileGrid};

/// Half the width of a beam in pixels. Snapping moves a corner by 1/512 pixel an axis, rounding of far corners by a few
/// times that.
const HAIR: f64 = 1.0 / 64.0;
/// Rounding of clip coordinates, relative to their largest term: matrix, products, sums and clipping.
const CLIP_ROUNDING: f64 = 1.0 / (1 << 20) as f64;
/// Rounding of a depth on the screen, relative to the facet's range of depths and to how much of a needle it is.
const DEPTH_ROUNDING: f32 = 1.0 / (1 << 19) as f32;
/// No facet: nothing was set up for this triangle.
const NONE: u32 = u32::MAX;

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct RayCast;

impl VisibleSurface for RayCast {
    fn resolve(
        &self,
        view: &PreparedView<'_>,
        marks: Option<&Batch>,
        grid: &mut TileGrid,
        execution: &Execution,
        sink: &dyn TileSink,
    ) -> Result<Resolved, Limit> {
        let facets = u64::from(view.session.world.facet_count);
        let bytes = ScreenSetups::bytes(view) + Bvh::bytes(facets) + facets * 16;
        charged(&execution.budget, bytes, "ray casting", || {
            let mut resolved = Resolved::default();
            let start = execution.budget.elapsed();
            let bvh = view.session.bvh(execution)?;
            let on_screen = ScreenSetups::new(view, execution, &mut resolved.geometry)?;
            let found = Findable::new(&bvh, &on_screen, view.session.world.facet_count);
            let eye = Eye::new(view, &bvh);
            resolved.geometry_seconds = execution.budget.elapsed() - start;
            let look = |tile: &mut Tile, layers: &mut Vec<Layer>| look(view, &found, &eye, tile, layers, execution);
            resolved.counters = each_tile(view, marks, grid, execution, sink, look)?;
            Ok(resolved)
        })
    }
}

/// The tree and what its triangles are in this view.
struct Findable<'a> {
    bvh: &'a Bvh,
    on_screen: &'a ScreenSetups,
    /// For each triangle of the tree its first setup, or `NONE`.
    setup_of: Vec<u32>,
    /// For each node how wrong a depth below it may be; -∞ if nothing below it was set up.
    slack: Vec<f32>,
}

impl<'a> Findable<'a> {
    fn new(bvh: &'a Bvh, on_screen: &'a ScreenSetups, facet_count: u32) -> Self {
        // Find each facet's first setup, and how wrong the depths of its setups may be.
        let mut of_facet = vec![(NONE, f32::NEG_INFINITY); facet_count as usize];
        let mut start = 0;
        for &(end, clipped) in &on_screen.runs {
            for (i, setup) in on_screen.setups[start..end].iter().enumerate() {
                let (first, slack) = &mut of_facet[setup.facet as usize];
                *first = (*first).min((start + i) as u32);
                *slack = slack.max(depth_slack(setup, clipped));
            }
            start = end;
        }
        let facets = bvh.facets();
        let setup_of = facets.iter().map(|&f| of_facet[f as usize].0).collect();
        let slack = bvh.largest(|place| of_facet[facets[place] as usize].1);
        Self { bvh, on_screen, setup_of, slack }
    }

    /// All setups of the facet that setup `first` begins.
    fn pieces(&self, first: u32) -> impl Iterator<Item = (&Setup, bool)> {
        let first = first as usize;
        let setups = &self.on_screen.setups;
        let facet = setups[first].facet;
        let layered = first >= self.on_screen.opaque;
        setups[first..].iter().take_while(move |s| s.facet == facet).map(move |s| (s, layered))
    }
}

/// By how much `Setup::depth` can differ from the exact interpolation of the corners' depths: rounding grows with the
/// square of the length over the area, but not beyond the range that depths are clamped to.
fn depth_slack(setup: &Setup, clipped: bool) -> f32 {
    let range = setup.z_max - setup.z_min + setup.z_max * DEPTH_ROUNDING;
    if clipped {
        return range;
    }
    let extent = |v: &[i32; 3]| (v[0].max(v[1]).max(v[2]) - v[0].min(v[1]).min(v[2])) as f32;
    let (dx, dy) = (extent(&setup.x), extent(&setup.y));
    let [x, y] = [&setup.x, &setup.y].map(|v| [v[1] - v[0], v[2] - v[0]].map(i64::from));
    let area = (x[0] * y[1] - x[1] * y[0]) as f32;
    range.min(DEPTH_ROUNDING * (range * (dx * dx + dy * dy) / area + setup.z_max))
}

/// Makes beams. Parameters along them are distances from the eye's plane along the direction of view.
struct Eye {
    perspective: bool,
    /// World space less the tree's centre.
    position: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// From pixels to view space at distance 1 (perspective) or anywhere (parallel).
    scale: [f64; 2],
    half_size: [f64; 2],
    /// Half a beam's width on the world's axes: what it has at the eye, and its growth with the distance.
    width: DVec3,
    growth: DVec3,
    /// Where beams start.
    start: f64,
    extent: f64,
    /// Depth at distance `t`: `depth[0] + depth[1] / t` or `depth[0] - depth[1] t`, and the rounding of `t`.
    depth: [f32; 2],
    relative_rounding: f32,
    rounding: f32,
}

impl Eye {
    fn new(view: &PreparedView<'_>, bvh: &Bvh) -> Self {
        let world_from_view = view.view.view_from_world.inverse();
        let axis = |v: DVec3| world_from_view.transform_vector3(v);
        let (right, up, forward) = (axis(DVec3::X), axis(DVec3::Y), axis(DVec3::NEG_Z));
        let position = world_from_view.transform_point3(DVec3::ZERO) - bvh.center;
        let p = &view.view.clip_from_view;
        let half_size = [f64::from(view.viewport.width) * 0.5, f64::from(view.viewport.height) * 0.5];
        let scale = [1.0 / (p.x_axis.x * half_size[0]), 1.0 / (p.y_axis.y * half_size[1])];

        // Widen beams by what rounding does to clip coordinates, and by a hair on the screen.
        let [ex, ey, ez, ew] = clip_rounding(view);
        let spread = |x: f64, y: f64| right.abs() * x + up.abs() * y;
        let rounding = spread((ex + ew) / p.x_axis.x, (ey + ew) / p.y_axis.y);
        let hair = spread(scale[0] * HAIR, scale[1] * HAIR);
        let perspective = view.view.perspective;
        let (width, growth) = if perspective { (rounding, hair) } else { (rounding + hair, DVec3::ZERO) };

        // Start in front of the scene, not far from it, so that 32 bits are enough.
        let extent = f64::from(bvh.extent);
        let nearest = -position.dot(forward) - extent * 2.0;
        let start = if perspective { nearest.max(0.0) } else { nearest };
        let (z, w) = (p.z_axis.z, p.w_axis.z);
        let depth = if perspective { [-z as f32, w as f32] } else { [w as f32, z as f32] };
        let relative_rounding = CLIP_ROUNDING + if perspective { 2.0 * ez / w } else { 0.0 };
        let rounding = if perspective { ew } else { ez / z };
        Self {
            perspective,
            position,
            right,
            up,
            forward,
            scale,
            half_size,
            width,
            growth,
            start,
            extent,
            depth,
            relative_rounding: relative_rounding as f32,
            rounding: (rounding + extent * CLIP_ROUNDING) as f32,
        }
    }

    /// The beam through the sample at `(x, y)` in 1/256 pixel. Its parameter counts from `self.start`.
    fn beam(&self, x: i32, y: i32) -> Beam {
        let pixel = |v: i32| f64::from(v) / f64::from(SUBPIXEL);
        let aside = self.right * ((pixel(x) - self.half_size[0]) * self.scale[0])
            + self.up * ((self.half_size[1] - pixel(y)) * self.scale[1]);
        let (origin, direction) = if self.perspective {
            (self.position, self.forward + aside)
        } else {
            (self.position + aside, self.forward)
        };
        let origin = origin + direction * self.start;
        let width = self.width + self.growth * self.start.max(0.0);
        let width = width + (origin.abs() + self.extent) * CLIP_ROUNDING;
        let growth = self.growth + direction.abs() * CLIP_ROUNDING;
        Beam::new(narrow(origin), narrow(direction), narrow(width), narrow(growth))
    }

    /// The largest depth at a place that a beam reaches no sooner than at `near`.
    #[inline(always)]
    fn depth_behind(&self, near: f32) -> f32 {
        let t = self.start as f32 + near;
        let t = t - t.abs() * self.relative_rounding - self.rounding;
        if !self.perspective {
            return self.depth[0] - self.depth[1] * t;
        }
        if t > 0.0 { self.depth[0] + self.depth[1] / t } else { f32::INFINITY }
    }
}

fn narrow(v: DVec3) -> Vec3 {
    let v = v.clamp(DVec3::splat(-1e30), DVec3::splat(1e30));
    vec3(v.x as f32, v.y as f32, v.z as f32)
}

/// How wrong the clip coordinates `x y z w` of any vertex of the view may be.
fn clip_rounding(view: &PreparedView<'_>) -> [f64; 4] {
    let clip_from_world = view.view.clip_from_world();
    let mut largest = [0.0f64; 4];
    for prepared in &view.instances {
        let instance = &view.session.world.instances[prepared.instance];
        let bounds = instance.model_bounds;
        let reach = bounds.min.abs().max(bounds.max.abs());
        let m: DMat4 = clip_from_world * instance.world_from_model;
        for (k, largest) in largest.iter_mut().enumerate() {
            let row = m.row(k).abs();
            let sum = row.truncate().dot(reach) + row.w;
            *largest = largest.max(if sum.is_finite() { sum } else { 1e30 });
        }
    }
    largest.map(|l| l * CLIP_ROUNDING)
}

/// What the ray through one sample has met.
struct Search<'a> {
    found: &'a Findable<'a>,
    eye: &'a Eye,
    sample: [i32; 2],
    /// Depth, facet and first setup of the nearest opaque facet.
    nearest: (f32, u32),
    setup: u32,
    /// Transparent facets, some of them hidden.
    layers: Vec<(f32, u32)>,
    tests: u64,
}

impl Search<'_> {
    /// Asks the law of agreement about the facet that setup `first` begins.
    #[inline]
    fn test(&mut self, first: u32) {
        let [x, y] = self.sample;
        let found = self.found;
        for (setup, layered) in found.pieces(first) {
            self.tests += 1;
            if setup.z_max < self.nearest.0 || !setup.covers(x, y) {
                continue;
            }
            let candidate = (setup.depth(x, y), setup.facet);
            if nearer(candidate, self.nearest) {
                if layered {
                    self.layers.push(candidate);
                } else {
                    (self.nearest, self.setup) = (candidate, first);
                }
            }
        }
    }
}

impl Visitor for Search<'_> {
    #[inline(always)]
    fn skips(&self, node: usize, near: f32) -> bool {
        let slack = self.found.slack[node];
        let depth = self.eye.depth_behind(near);
        depth + depth.abs() * DEPTH_ROUNDING + self.eye.depth[0].abs() * DEPTH_ROUNDING + slack < self.nearest.0
    }

    #[inline(always)]
    fn triangle(&mut self, place: usize) {
        let first = self.found.setup_of[place];
        if first != NONE {
            self.test(first);
        }
    }
}

/// Fills a tile, a ray for each sample.
fn look(
    view: &PreparedView<'_>,
    found: &Findable<'_>,
    eye: &Eye,
    tile: &mut Tile,
    layers: &mut Vec<Layer>,
    execution: &Execution,
) -> Result<VisibilityCounters, Limit> {
    let mut counters = VisibilityCounters::default();
    let background = (0.0, NO_FACET);
    let layer_list = Vec::new();
    let mut search =
        Search { found, eye, sample: [0; 2], nearest: background, setup: NONE, layers: layer_list, tests: 0 };
    let (rows, columns) = size_in_picture(view, tile);
    for row in 0..rows {
        execution.budget.check("ray casting")?;
        for column in 0..columns {
            for sample in 0..view.pattern.len() {
                let [sx, sy] = view.pattern.position(sample);
                let x = (tile.x as i32 + column as i32) * SUBPIXEL + sx;
                let y = (tile.y as i32 + row as i32) * SUBPIXEL + sy;
                (search.sample, search.nearest) = ([x, y], background);

                // Try what the ray before met, then follow the beam.
                let before = std::mem::replace(&mut search.setup, NONE);
                if before != NONE {
                    search.test(before);
                }
                counters.box_tests += found.bvh.traverse(&eye.beam(x, y), &mut search);
                counters.rays += 1;

                // Keep the nearest, and the layers in front of it.
                let at = sample * TILE_PIXELS + row * TILE + column;
                (tile.depth[at], tile.facet[at]) = search.nearest;
                tile.touched |= search.nearest.1 != NO_FACET;
                let nearest = search.nearest;
                let seen = search.layers.drain(..).filter(|c| nearer(*c, nearest));
                layers.extend(seen.map(|(depth, facet)| Layer { at: at as u32, depth, facet }));
            }
        }
    }
    counters.triangle_tests = search.tests;
    Ok(counters)
}
