//! Where rays start and how wide they have to be.
//!
//! A ray through a sample is widened into a beam, so that it meets whatever can cover the sample
//! once corners are snapped to the screen's grid and coordinates have been rounded; rays through a
//! block of pixels become a pyramid with the same allowance on each side. And from the distance at
//! which a box begins follows the largest depth that anything in it can have.
//!
//! In:   a prepared view. Out: beams and pyramids, world space less the triangles' centre.
//! Cost: some 50 operations each.
//! Source: [Appel 1968] for the rays.

use crate::PreparedView;
use crate::raytrace::beam::Beam;
use crate::raytrace::pyramid::{Plane, Pyramid};
use crate::raytrace::triangles::Triangles;
use vitral_math::lanes::Simd;
use vitral_math::{DMat4, DVec3, Vec3, vec3};
use vitral_raster::SUBPIXEL;

/// Rounding of a depth on the screen, relative to the facet's range of depths and to how much of a
/// needle it is.
pub(super) const DEPTH_ROUNDING: f32 = 1.0 / (1 << 19) as f32;
/// Half the width of a beam in pixels. Snapping moves a corner by 1/512 pixel an axis, rounding of
/// far corners by a few times that.
const HAIR: f64 = 1.0 / 64.0;
/// Rounding of clip coordinates, relative to their largest term: matrix, products, sums and
/// clipping.
const CLIP_ROUNDING: f64 = 1.0 / (1 << 20) as f64;

/// See the module.
#[derive(Debug)]
pub(super) struct Eye {
    perspective: bool,
    /// World space less the triangles' centre.
    position: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// From pixels to view space at distance 1 (perspective) or anywhere (parallel).
    scale: [f64; 2],
    /// What rounding does to view coordinates.
    view_rounding: [f64; 2],
    /// The pixel on the direction of view.
    middle: [f64; 2],
    /// Half a beam's width on the world's axes: what it has at the eye, and its growth with the
    /// distance.
    width: DVec3,
    growth: DVec3,
    /// Where beams start.
    start: f64,
    extent: f64,
    /// Depth at distance `t`: `depth[0] + depth[1] / t` or `depth[0] - depth[1] t`, and the
    /// rounding of `t`.
    depth: [f32; 2],
    relative_rounding: f32,
    rounding: f32,
}

impl Eye {
    /// The eye of a view, which looks at `triangles`.
    pub(super) fn new(view: &PreparedView<'_>, triangles: &Triangles) -> Self {
        // Take the eye's axes and position in the world.
        let world_from_view = view.view.view_from_world.inverse();
        let axis = |v: DVec3| world_from_view.transform_vector3(v);
        let (right, up, forward) = (axis(DVec3::X), axis(DVec3::Y), axis(DVec3::NEG_Z));
        let position = world_from_view.transform_point3(DVec3::ZERO) - triangles.center;

        // Find the step of a ray from pixel to pixel.
        let p = &view.view.clip_from_view;
        let half_size =
            [f64::from(view.viewport.width) * 0.5, f64::from(view.viewport.height) * 0.5];
        let scale = [1.0 / (p.x_axis.x * half_size[0]), 1.0 / (p.y_axis.y * half_size[1])];

        let middle = [half_size[0] * (1.0 - p.z_axis.x), half_size[1] * (1.0 + p.z_axis.y)];

        // Widen beams by what rounding does to clip coordinates, and by a hair on the screen.
        let [ex, ey, ez, ew] = clip_rounding(view);
        let spread = |x: f64, y: f64| right.abs() * x + up.abs() * y;
        let view_rounding = [(ex + ew) / p.x_axis.x, (ey + ew) / p.y_axis.y];
        let rounding = spread(view_rounding[0], view_rounding[1]);
        let hair = spread(scale[0] * HAIR, scale[1] * HAIR);
        let perspective = view.view.perspective;
        let (width, growth) =
            if perspective { (rounding, hair) } else { (rounding + hair, DVec3::ZERO) };

        // Start in front of the scene, not far from it, so that 32 bits are enough.
        let extent = f64::from(triangles.extent);
        let nearest = -position.dot(forward) - extent * 2.0;
        let start = if perspective { nearest.max(0.0) } else { nearest };

        // Relate depths to distances, with the rounding of both.
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
            middle,
            view_rounding,
            width,
            growth,
            start,
            extent,
            depth,
            relative_rounding: relative_rounding as f32,
            rounding: (rounding + extent * CLIP_ROUNDING) as f32,
        }
    }

    /// Where a ray through `(x, y)` in 1/256 pixel leads in view space, at distance 1 (perspective)
    /// or anywhere.
    fn aside(&self, x: i32, y: i32) -> [f64; 2] {
        let pixel = |v: i32| f64::from(v) / f64::from(SUBPIXEL);
        [(pixel(x) - self.middle[0]) * self.scale[0], (self.middle[1] - pixel(y)) * self.scale[1]]
    }

    /// The ray through the sample at `(x, y)` in 1/256 pixel, from the eye or its plane: where it
    /// starts, and where it goes in one unit of distance from the eye's plane.
    #[inline(always)]
    pub(super) fn ray(&self, x: i32, y: i32) -> [DVec3; 2] {
        let [right, up] = self.aside(x, y);
        let aside = self.right * right + self.up * up;
        if self.perspective {
            [self.position, self.forward + aside]
        } else {
            [self.position + aside, self.forward]
        }
    }

    /// The distance from the eye's plane of what has this depth.
    pub(super) fn distance(&self, depth: f32) -> f64 {
        let [at_zero, slope] = self.depth.map(f64::from);
        let depth = f64::from(depth);
        if self.perspective { slope / (depth - at_zero) } else { (at_zero - depth) / slope }
    }

    /// The beam through the sample at `(x, y)` in 1/256 pixel. Its parameter counts from
    /// [`Self::start`].
    pub(super) fn beam(&self, x: i32, y: i32) -> Beam {
        let [origin, direction] = self.ray(x, y);
        let origin = origin + direction * self.start;
        let width = self.width + self.growth * self.start.max(0.0);
        let width = width + (origin.abs() + self.extent) * CLIP_ROUNDING;
        let growth = self.growth + direction.abs() * CLIP_ROUNDING;
        Beam::new(narrow(origin), narrow(direction), narrow(width), narrow(growth))
    }

    /// All beams through samples between `low` and `high` (x and y in 1/256 pixel) at once; its
    /// parameter counts from the eye's plane.
    #[inline(always)]
    pub(super) fn pyramid<S: Simd>(&self, simd: S, low: [i32; 2], high: [i32; 2]) -> Pyramid<S> {
        let ([left, top], [right, bottom]) =
            (self.aside(low[0], low[1]), self.aside(high[0], high[1]));
        let hair = self.scale.map(|s| s * HAIR);
        let plane = |axis: DVec3, at: f64, slack: f64| {
            // Inside is where the coordinate along `axis` is at least `at`, times the distance in a
            // perspective view.
            let (normal, offset) = if self.perspective {
                (axis - self.forward * at, slack)
            } else {
                (axis, slack - at)
            };
            Plane { normal, offset: offset - normal.dot(self.position) }
        };
        let [slack_x, slack_y] = self.view_rounding;
        let sides = [
            plane(self.right, left - hair[0], slack_x),
            plane(-self.right, -right - hair[0], slack_x),
            plane(-self.up, -top - hair[1], slack_y),
            plane(self.up, bottom - hair[1], slack_y),
        ];
        Pyramid::new(simd, &sides, self.forward, self.position, self.perspective, self.extent)
    }

    /// Where beams start: a distance from the eye's plane.
    pub(super) fn start(&self) -> f32 {
        self.start as f32
    }

    /// Whether all depths at places whose distance from the eye's plane is `t` or more are smaller
    /// than `depth`; a facet's own depths may be wrong by `slack`.
    #[inline(always)]
    pub(super) fn is_behind(&self, t: f32, slack: f32, depth: f32) -> bool {
        let t = t - t.abs() * self.relative_rounding - self.rounding;
        let [at_zero, slope] = self.depth;
        let room = depth - slack - at_zero.abs() * (4.0 * DEPTH_ROUNDING);
        if self.perspective {
            // The largest depth is `at_zero + slope / t`; both sides times `t`, since a division
            // takes longer.
            t > 0.0 && room > 0.0 && (at_zero * t + slope) * (1.0 + 2.0 * DEPTH_ROUNDING) < room * t
        } else {
            let nearest = at_zero - slope * t;
            nearest + nearest.abs() * DEPTH_ROUNDING < room
        }
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
