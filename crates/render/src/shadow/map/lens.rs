//! How a light looks at the scene: the frusta of shadow maps, fitted to what is there.

use crate::raytrace::triangles::Triangles;
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
    extent: [f64; 2],
    perspective: bool,
}

/// Wider cones than this (tangent of half the angle) are cut into the faces of a cube.
const WIDEST: f64 = 1.5;
/// Texels left free along the border of a map.
const BORDER: f64 = 4.0;

impl Lens {
    /// For light from infinitely far away.
    pub(super) fn parallel(towards: DVec3, world: &World, size: u32) -> Self {
        let center = Triangles::center_of(world);
        let (focal_point, position) = (center, center + towards);
        let projection = Projection::Parallel { height: 1.0 };
        let mut camera = Camera { position, focal_point, view_up: DVec3::Y, projection, clip: None };
        let view = camera.view_from_world();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in corners(world) {
            let p = view.transform_point3(corner);
            (low, high) = (low.min(p), high.max(p));
        }
        // Aim at the middle of what the light sees.
        let middle = (low + high) * 0.5;
        let shift = view.inverse().transform_vector3(DVec3::new(middle.x, middle.y, 0.0));
        (camera.position, camera.focal_point) = (position + shift, focal_point + shift);
        let extent = (high - low) * 0.5;
        Self::new(camera, [extent.x, extent.y], size, world, false)
    }

    /// For light from `at` (less the scene's middle): one lens before which the scene lies, or six.
    pub(super) fn around(at: DVec3, world: &World, size: u32) -> Vec<Self> {
        let position = at + Triangles::center_of(world);
        let towards = |direction: DVec3| Camera {
            position,
            focal_point: position + direction,
            view_up: DVec3::Y,
            projection: Projection::Perspective { view_angle: 1.0 },
            clip: None,
        };
        if let Some(direction) = (world.bounds.center() - position).try_normalize() {
            let camera = towards(direction);
            let view = camera.view_from_world();
            let mut extent = [0.0f64; 2];
            for corner in corners(world) {
                let p = view.transform_point3(corner);
                let share = |x: f64| if p.z < 0.0 { x.abs() / -p.z } else { f64::INFINITY };
                extent = [extent[0].max(share(p.x)), extent[1].max(share(p.y))];
            }
            if extent[0].max(extent[1]) < WIDEST {
                return vec![Self::new(camera, extent, size, world, true)];
            }
        }
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let faces = axes.into_iter().flat_map(|axis| [axis, -axis]);
        faces.map(|direction| Self::new(towards(direction), [1.0; 2], size, world, true)).collect()
    }

    /// For a spot from `at` (less the scene's middle) with half the angle `cutoff`, unless it is too wide for one lens.
    pub(super) fn cone(at: DVec3, direction: DVec3, cutoff: f64, world: &World, size: u32) -> Option<Self> {
        let position = at + Triangles::center_of(world);
        let extent = func::tan(cutoff.clamp(1e-3, 1.5));
        let focal_point = position + direction.try_normalize()?;
        let projection = Projection::Perspective { view_angle: 1.0 };
        let camera = Camera { position, focal_point, view_up: DVec3::Y, projection, clip: None };
        (extent < WIDEST).then(|| Self::new(camera, [extent; 2], size, world, true))
    }

    fn new(mut camera: Camera, extent: [f64; 2], size: u32, world: &World, perspective: bool) -> Self {
        // Square texels, as many as fit.
        let longer = extent[0].max(extent[1]).max(1e-12);
        let side = |e: f64| ((e / longer * f64::from(size)).ceil() as u32).clamp(1, size);
        let (width, height) = (side(extent[0]), side(extent[1]));
        let texel = 2.0 * longer / (f64::from(size) - 2.0 * BORDER).max(1.0);
        let extent = [f64::from(width) * texel * 0.5, f64::from(height) * texel * 0.5];
        camera.projection = if perspective {
            Projection::Perspective { view_angle: 2.0 * func::atan2(extent[1], 1.0) }
        } else {
            Projection::Parallel { height: 2.0 * extent[1] }
        };
        let view = camera.transform(f64::from(width) / f64::from(height), depth_range(&camera, &world.bounds));
        let view_from_world = view.view_from_world * DMat4::from_translation(Triangles::center_of(world));
        Self { camera, view, view_from_world, width, height, extent, perspective }
    }

    /// Distance along the axis from what the z-buffer holds.
    pub(super) fn distance(&self, depth: f32) -> f32 {
        let (near, far, depth) = (self.view.near, self.view.far, f64::from(depth));
        let distance =
            if self.perspective { near * far / (depth * (far - near) + near) } else { far - depth * (far - near) };
        distance as f32
    }

    /// Whether this is the lens for a place, of those round a light.
    pub(super) fn sees(&self, place: DVec3) -> bool {
        let p = self.view_from_world.transform_point3(place);
        p.z < 0.0 && p.x.abs() <= -p.z * self.extent[0] && p.y.abs() <= -p.z * self.extent[1]
    }

    /// Side of a texel at the distance of a place.
    pub(super) fn texel(&self, place: DVec3) -> f64 {
        let side = 2.0 * self.extent[0] / f64::from(self.width);
        if self.perspective { side * self.view_from_world.transform_point3(place).z.abs() } else { side }
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

    /// Distance at which the ray of a place on the map meets the plane through `point` with this normal, view space; the
    /// point's own if it does not.
    pub(super) fn plane_depth(&self, at: [f64; 2], point: DVec3, normal: DVec3) -> f64 {
        let (start, ahead) =
            if self.perspective { (DVec3::ZERO, self.point(at, 1.0)) } else { (self.point(at, 0.0), DVec3::NEG_Z) };
        let distance = normal.dot(point - start) / normal.dot(ahead);
        if distance.is_finite() && (distance > 0.0 || !self.perspective) { distance } else { -point.z }
    }
}

/// Corners of the boxes round all objects, world space.
fn corners(world: &World) -> impl Iterator<Item = DVec3> + '_ {
    world.instances.iter().filter(|i| !i.bounds.is_empty()).flat_map(|i| i.bounds.corners())
}
