//! How a light looks at the scene: the frusta of shadow maps, fitted to what is there.

use crate::raytrace::triangles::Triangles;
use std::f64::consts::FRAC_1_SQRT_2;
use vitral_math::{DMat4, DVec3, func};
use vitral_scene::{Camera, Projection, ViewTransform, World, depth_range};

/// A frustum and its texels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lens {
    pub camera: Camera,
    pub view: ViewTransform,
    /// From world space less the scene's middle.
    pub view_from_world: DMat4,
    pub width: u32,
    pub height: u32,
    /// Half the picture's width and height: at distance 1, or at any for a parallel light.
    pub extent: [f64; 2],
    pub perspective: bool,
}

/// Wider cones than this (tangent of half the angle) are cut into the faces of a cube.
const WIDEST: f64 = 1.5;
/// Texels left free along the border of a map.
const BORDER: f64 = 4.0;
/// Nearer to the border than this a map does not tell about places that lie outside of what it was
/// fitted to.
const INNER: f64 = 2.0;

impl Lens {
    /// For light from infinitely far away.
    pub(super) fn parallel(towards: DVec3, world: &World, size: u32) -> Self {
        let camera = far_away(towards, world);
        let view = camera.view_from_world();
        let [low, high] = extent(corners(world).map(|p| view.transform_point3(p)));
        let half = (high - low) * 0.5;
        Self::new(aimed(camera, (low + high) * 0.5), [half.x, half.y], size, world, false)
    }

    /// For light from infinitely far away that falls on these points (world space), with texels of
    /// a size that is smaller than those of `whole` by a power of √2, on their grid: the same place
    /// in another such lens is in the same place of a texel. `None` without points, or for larger
    /// texels.
    pub(super) fn parallel_round(
        towards: DVec3,
        points: &[DVec3],
        whole: &Self,
        world: &World,
        size: u32,
    ) -> Option<Self> {
        // Measure the points as the light sees them.
        let camera = far_away(towards, world);
        let view = camera.view_from_world();
        let [low, high] = extent(points.iter().map(|&p| view.transform_point3(p)));
        let longer = (high - low).truncate().max_element();
        let least = longer / (f64::from(size) - 2.0 * BORDER - 2.0).max(1.0);
        let mut texel = 2.0 * whole.extent[0] / f64::from(whole.width);
        if !(longer.is_finite() && least < texel) {
            return None;
        }
        // Finer than the grid of positions in single precision is of no use.
        let finest = least.max(whole.extent[0].max(whole.extent[1]) * 1e-6);
        while texel * FRAC_1_SQRT_2 >= finest {
            texel *= FRAC_1_SQRT_2;
        }

        // Snap the box to the grid of texels.
        let [low, high] = [(low / texel).floor() - BORDER, (high / texel).ceil() + BORDER]
            .map(|p| [p.x, p.y].map(|k| k as i64));
        let count = [0, 1].map(|k| (high[k] - low[k]).clamp(1, i64::from(size)) as u32);
        let middle = [0, 1].map(|k| (low[k] + high[k]) as f64 * 0.5 * texel);
        Some(Self::of_texels(
            aimed(camera, DVec3::new(middle[0], middle[1], 0.0)),
            count,
            texel,
            world,
            false,
        ))
    }

    /// For light from `at` (less the scene's middle): one lens before which the scene lies, or six.
    pub(super) fn around(at: DVec3, world: &World, size: u32) -> Vec<Self> {
        let position = at + Triangles::center_of(world);
        if let Some(direction) = (world.bounds.center() - position).try_normalize()
            && let Some(lens) = Self::holding(position, direction, corners(world), world, size)
        {
            return vec![lens];
        }
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let faces = axes.into_iter().flat_map(|axis| [axis, -axis]);
        faces
            .map(|direction| Self::new(looking(position, direction), [1.0; 2], size, world, true))
            .collect()
    }

    /// For light from `at` (less the scene's middle) that falls on these points (world space), if
    /// one lens holds them.
    pub(super) fn before(at: DVec3, points: &[DVec3], world: &World, size: u32) -> Option<Self> {
        let position = at + Triangles::center_of(world);
        let ways = || points.iter().map(|&p| (p - position).normalize_or_zero());
        let direction = ways().sum::<DVec3>().try_normalize()?;
        Self::holding(position, direction, points.iter().copied(), world, size)
    }

    /// The lens at `position` that holds these points, unless it is too wide.
    fn holding(
        position: DVec3,
        direction: DVec3,
        points: impl Iterator<Item = DVec3>,
        world: &World,
        size: u32,
    ) -> Option<Self> {
        let camera = looking(position, direction);
        let view = camera.view_from_world();
        let mut extent = [0.0f64; 2];
        for corner in points {
            let p = view.transform_point3(corner);
            let share = |x: f64| if p.z < 0.0 { x.abs() / -p.z } else { f64::INFINITY };
            extent = [extent[0].max(share(p.x)), extent[1].max(share(p.y))];
        }
        (extent[0].max(extent[1]) < WIDEST).then(|| Self::new(camera, extent, size, world, true))
    }

    /// For a spot from `at` (less the scene's middle) with half the angle `cutoff`, unless it is
    /// too wide for one lens.
    pub(super) fn cone(
        at: DVec3,
        direction: DVec3,
        cutoff: f64,
        world: &World,
        size: u32,
    ) -> Option<Self> {
        let position = at + Triangles::center_of(world);
        let extent = func::tan(cutoff.clamp(1e-3, 1.5));
        let camera = looking(position, direction.try_normalize()?);
        (extent < WIDEST).then(|| Self::new(camera, [extent; 2], size, world, true))
    }

    fn new(camera: Camera, extent: [f64; 2], size: u32, world: &World, perspective: bool) -> Self {
        // Square texels, as many as fit.
        let longer = extent[0].max(extent[1]).max(1e-12);
        let side = |e: f64| ((e / longer * f64::from(size)).ceil() as u32).clamp(1, size);
        let texel = 2.0 * longer / (f64::from(size) - 2.0 * BORDER).max(1.0);
        Self::of_texels(camera, extent.map(side), texel, world, perspective)
    }

    /// So many square texels of this side: at distance 1, or at any for a parallel light.
    fn of_texels(
        mut camera: Camera,
        [width, height]: [u32; 2],
        texel: f64,
        world: &World,
        perspective: bool,
    ) -> Self {
        let extent = [f64::from(width) * texel * 0.5, f64::from(height) * texel * 0.5];
        camera.projection = if perspective {
            Projection::Perspective { view_angle: 2.0 * func::atan2(extent[1], 1.0) }
        } else {
            Projection::Parallel { height: 2.0 * extent[1] }
        };
        let depths = depth_range(&camera, &world.bounds);
        if !perspective {
            camera.clip = all_round(depths);
        }
        let view = camera.transform(f64::from(width) / f64::from(height), depths);
        let view_from_world =
            view.view_from_world * DMat4::from_translation(Triangles::center_of(world));
        Self { camera, view, view_from_world, width, height, extent, perspective }
    }

    /// Distance along the axis from what the z-buffer holds.
    #[inline(always)]
    pub(super) fn distance(&self, depth: f32) -> f32 {
        let (near, far, depth) = (self.view.near, self.view.far, f64::from(depth));
        let distance = if self.perspective {
            near * far / (depth * (far - near) + near)
        } else {
            far - depth * (far - near)
        };
        distance as f32
    }

    /// Whether this is the lens for a place, of those round a light.
    pub(super) fn sees(&self, place: DVec3) -> bool {
        let p = self.view_from_world.transform_point3(place);
        p.z < 0.0 && p.x.abs() <= -p.z * self.extent[0] && p.y.abs() <= -p.z * self.extent[1]
    }

    /// Whether the map tells about a place, and about what is a few texels beside it.
    pub(super) fn holds(&self, place: DVec3) -> bool {
        let at = self.texel_place(self.view_from_world.transform_point3(place));
        let inside = |x: f64, side: u32| x >= INNER && x <= f64::from(side) - INNER;
        at.is_some_and(|[x, y]| inside(x, self.width) && inside(y, self.height))
    }

    /// Side of a texel at the distance of a place.
    pub(super) fn texel(&self, place: DVec3) -> f64 {
        let distance = if self.perspective {
            self.view_from_world.transform_point3(place).z.abs()
        } else {
            1.0
        };
        self.side() * distance
    }

    /// Side of a texel at distance 1, or at any for a parallel light.
    pub(super) fn side(&self) -> f64 {
        2.0 * self.extent[0] / f64::from(self.width)
    }

    /// Where a point of view space is on the map, in texels.
    pub(super) fn texel_place(&self, p: DVec3) -> Option<[f64; 2]> {
        let distance = if self.perspective { -p.z } else { 1.0 };
        let x = (p.x / (distance * self.extent[0]) + 1.0) * 0.5 * f64::from(self.width);
        let y = (1.0 - p.y / (distance * self.extent[1])) * 0.5 * f64::from(self.height);
        (distance > 0.0).then_some([x, y])
    }

    /// The point of view space through which the ray of a texel passes at `distance`.
    pub(super) fn point(&self, [x, y]: [f64; 2], distance: f64) -> DVec3 {
        let x = (x / f64::from(self.width) * 2.0 - 1.0) * self.extent[0];
        let y = (1.0 - y / f64::from(self.height) * 2.0) * self.extent[1];
        let scale = if self.perspective { distance } else { 1.0 };
        DVec3::new(x * scale, y * scale, -distance)
    }
}

/// A viewer in the place of a light that is infinitely far away.
fn far_away(towards: DVec3, world: &World) -> Camera {
    let center = Triangles::center_of(world);
    let projection = Projection::Parallel { height: 1.0 };
    Camera {
        position: center + towards,
        focal_point: center,
        view_up: DVec3::Y,
        projection,
        clip: None,
    }
}

/// Clipping planes a little outside these depths, also those behind the viewer: light that is
/// infinitely far away comes from behind all of the scene.
fn all_round((nearest, farthest): (f64, f64)) -> Option<(f64, f64)> {
    let margin = ((farthest - nearest) * 0.01).max(farthest.abs().max(nearest.abs()) * 1e-4);
    let margin = if margin > 0.0 { margin } else { 1e-9 };
    let usable = nearest.is_finite() && farthest.is_finite() && nearest <= farthest;
    usable.then_some((nearest - margin, farthest + margin))
}

/// The viewer, moved sideways to this place of its view space.
fn aimed(camera: Camera, middle: DVec3) -> Camera {
    let shift =
        camera.view_from_world().inverse().transform_vector3(DVec3::new(middle.x, middle.y, 0.0));
    Camera { position: camera.position + shift, focal_point: camera.focal_point + shift, ..camera }
}

fn looking(position: DVec3, direction: DVec3) -> Camera {
    let projection = Projection::Perspective { view_angle: 1.0 };
    Camera {
        position,
        focal_point: position + direction,
        view_up: DVec3::Y,
        projection,
        clip: None,
    }
}

/// Smallest and largest coordinates.
fn extent(points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    points.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)])
}

/// Corners of the boxes round all objects, world space.
fn corners(world: &World) -> impl Iterator<Item = DVec3> + '_ {
    world.instances.iter().filter(|i| !i.bounds.is_empty()).flat_map(|i| i.bounds.corners())
}
