//! The scene from outside: the view volume of its camera, its lights, the boxes of its objects, the
//! rays of a pixel and the planes of a tree as lines over a picture from elsewhere.
//!
//! Source: the course, notes P, the view volume, rays and BSP trees.

use crate::answer::Answer;
use serde_json::json;
use std::f64::consts::TAU;
use std::fmt::Write;
use vitral::explain::{Deciders, PartVolume, PathPart, explain, ray_path};
use vitral::internals::math::{DVec4, func};
use vitral::internals::render::trace::Step;
use vitral::internals::scene::framing::frame_from;
use vitral::{
    Aabb, AreaShape, Camera, DMat4, DVec3, Error, Light, LightKind, Projection, Renderer, Settings,
    Viewpoint, Visibility,
};

/// How much of the picture is filled.
const FILL: f64 = 0.8;

/// How far rays go on that meet nothing, in diagonals of the scene.
const LOST_RAY: f64 = 0.5;

/// Parts of an acceleration structure that are drawn.
const MOST_PARTS: usize = 200;

/// The second viewpoint, and the pixel and step to draw.
pub(crate) struct Asked<'a> {
    /// From where the scene is seen; none: from beside the camera.
    pub(crate) second: Option<&'a Viewpoint>,
    /// The pixel whose rays are drawn.
    pub(crate) pixel: Option<[u32; 2]>,
    /// The step whose plane is drawn.
    pub(crate) step: Option<&'a Step>,
}

/// The picture from the second viewpoint, with what belongs to the camera drawn over it.
pub(crate) fn overview(renderer: &mut Renderer, asked: &Asked<'_>) -> Answer {
    let camera = renderer.frame_camera();
    let lights = renderer.frame_lights(&camera);
    let volume = view_volume(&camera, renderer);
    let rays = asked.pixel.map(|pixel| Rays::of(renderer, &camera, pixel, &lights)).transpose()?;
    let outside = match asked.second {
        Some(viewpoint) => {
            viewpoint.apply(renderer, renderer.scene().usual_up())?;
            renderer.frame_camera()
        }
        None => beside(&camera, &volume, renderer),
    };

    // Draw lines where the other camera sees them.
    let [width, height] = [renderer.settings.picture.width, renderer.settings.picture.height];
    let seen_by_camera = renderer.view_transform(&camera).clip_from_world();
    let clip_from_world = renderer.view_transform(&outside).clip_from_world();
    let screen = Screen { clip_from_world, size: [f64::from(width), f64::from(height)] };
    let mut svg =
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}">"#);
    for instance in renderer.world().instances.iter().filter(|i| !i.bounds.is_empty()) {
        let corners = instance.bounds.corners();
        let plane = beyond(&corners, &seen_by_camera);
        let (class, told) = plane.map_or(("box kept", ""), |plane| ("box culled", plane));
        screen.cuboid(
            &mut svg,
            corners,
            class,
            [instance.mesh.name.as_str(), told].join(" ").trim(),
        );
    }
    screen.cuboid(&mut svg, volume, "volume", "");

    // Draw the lights that have a place.
    for light in lights.iter().filter(|light| light.enabled) {
        match &light.kind {
            LightKind::Point { position } => {
                screen.point(&mut svg, *position, "light", &light.name)
            }
            LightKind::Spot { position, direction, cutoff, .. } => {
                let length = (renderer.world().bounds.center() - *position).length();
                for edge in cone(*direction, *cutoff) {
                    screen.segment(&mut svg, [*position, *position + edge * length], "cone", "");
                }
                screen.point(&mut svg, *position, "light", &light.name);
            }
            LightKind::Area { shape } => {
                screen.polygon(&mut svg, &outline(shape), "lamp", &light.name);
            }
            _ => {}
        }
    }
    screen.point(&mut svg, camera.position, "eye", "");

    // Draw the plane that a tree divides along, then the rays.
    if let Some(Step::TreeNode { plane, splitter, .. }) = asked.step {
        let name = splitter.map_or(String::new(), |facet| format!("facet {facet}"));
        screen.polygon(&mut svg, &section(&renderer.world().bounds, *plane), "plane", &name);
    }
    if let Some(pixel) = asked.pixel.filter(|_| opens_structure(&renderer.settings)) {
        for part in ray_path(renderer, &camera, pixel)?.parts.iter().take(MOST_PARTS) {
            screen.part(&mut svg, part);
        }
    }
    for (class, from, to, name) in rays.iter().flat_map(|rays| &rays.0) {
        screen.segment(&mut svg, [*from, *to], class, name);
    }
    svg.push_str("</svg>");

    // The lights are those of the first camera.
    renderer.lights = Some(lights);
    renderer.light_edits.clear();
    let picture = renderer.render_from(&outside)?;
    let missing = || Error::usage("this picture has no colours", "");
    let pixels = picture.frame.color.as_ref().ok_or_else(missing)?.data().as_flattened().to_vec();
    Ok((json!({"width": width, "height": height, "drawing": svg}), vec![pixels]))
}

/// Whether the pixel's ray goes through an acceleration structure.
fn opens_structure(settings: &Settings) -> bool {
    settings.visibility == Visibility::RAY_CAST || settings.acceleration.is_some()
}

/// The plane of the view volume beyond which a whole box lies.
fn beyond(corners: &[DVec3; 8], clip_from_world: &DMat4) -> Option<&'static str> {
    let clip = corners.map(|corner| *clip_from_world * corner.extend(1.0));
    let distances = |c: &DVec4| [c.w + c.x, c.w - c.x, c.w + c.y, c.w - c.y, c.w - c.z, c.z];
    let names = ["left", "right", "bottom", "top", "near", "far"];
    (0..6)
        .find(|&plane| clip.iter().all(|corner| distances(corner)[plane] < 0.0))
        .map(|plane| names[plane])
}

/// Lines of rays: class, both ends in world space, name.
struct Rays(Vec<(&'static str, DVec3, DVec3, String)>);

impl Rays {
    /// The rays of a pixel: from the eye to what it sees and on from there, and from there to the
    /// lights.
    fn of(
        renderer: &Renderer,
        camera: &Camera,
        pixel: [u32; 2],
        lights: &[Light],
    ) -> Result<Self, Error> {
        let told = explain(renderer, camera, pixel, &Deciders::Chosen, None)?;
        let bounds = renderer.world().bounds;
        let far = (bounds.max - bounds.min).length() * LOST_RAY;
        let mut lines = Vec::new();

        // Follow the rays of ray tracing, or the one of the eye.
        for ray in &told.rays {
            let [from, along] = [ray.origin, ray.direction].map(DVec3::from_array);
            let length = ray.meets.as_ref().map_or(far, |met| met.distance);
            let name = ray.meets.as_ref().map_or(String::new(), |met| met.mesh.clone());
            lines.push(("ray", from, from + along * length, name));
        }
        let Some(point) = told.light.points.first() else { return Ok(Self(lines)) };
        let at = DVec3::from_array(point.world);
        if lines.is_empty() {
            let eye = match camera.projection {
                Projection::Parallel { .. } => {
                    let back = (camera.position - camera.focal_point).normalize_or_zero();
                    at + back * (camera.position - at).dot(back)
                }
                _ => camera.position,
            };
            lines.push(("ray", eye, at, String::new()));
        }

        // Draw a line to each light; to a directional one, a line of fixed length.
        for light in lights.iter().filter(|light| light.enabled) {
            let to = match light.kind {
                LightKind::Point { position } | LightKind::Spot { position, .. } => position,
                LightKind::Directional { direction } => at - direction.normalize_or_zero() * far,
                _ => continue,
            };
            lines.push(("light-ray", at, to, light.name.clone()));
        }
        Ok(Self(lines))
    }
}

/// Edges of the cone of a spot light that spreads `cutoff` radians to each side: unit vectors.
fn cone(direction: DVec3, cutoff: f64) -> Vec<DVec3> {
    const EDGES: u32 = 8;
    let axis = direction.normalize_or_zero();
    let side = axis.any_orthogonal_vector().normalize_or_zero();
    let other = axis.cross(side);
    let (sin, cos) = func::sin_cos(cutoff);
    let edge = |i: u32| {
        let (y, x) = func::sin_cos(f64::from(i) / f64::from(EDGES) * TAU);
        axis * cos + (side * x + other * y) * sin
    };
    (0..EDGES).map(edge).collect()
}

/// The outline of an area light.
fn outline(shape: &AreaShape) -> Vec<DVec3> {
    const CORNERS: u32 = 24;
    match shape {
        AreaShape::Polygon { corners } => corners.clone(),
        AreaShape::Disc { center, normal, radius } => {
            let side = normal.any_orthogonal_vector().normalize_or_zero();
            let other = normal.normalize_or_zero().cross(side);
            let corner = |i: u32| {
                let (y, x) = func::sin_cos(f64::from(i) / f64::from(CORNERS) * TAU);
                *center + (side * x + other * y) * *radius
            };
            (0..CORNERS).map(corner).collect()
        }
    }
}

/// The polygon in which the plane `a x + b y + c z + d = 0` cuts a box; fewer than three corners
/// where it does not.
fn section(bounds: &Aabb, [a, b, c, d]: [f64; 4]) -> Vec<DVec3> {
    let normal = DVec3::new(a, b, c);
    let (corners, distance) = (bounds.corners(), |p: DVec3| normal.dot(p) + d);

    // Collect the points at which the plane crosses edges of the box.
    let mut points = Vec::new();
    for (from, bit) in (0..8usize).flat_map(|from| [1, 2, 4].map(|bit| (from, bit))) {
        let (p, q) = (corners[from], corners[from | bit]);
        let (dp, dq) = (distance(p), distance(q));
        if from & bit == 0 && (dp < 0.0) != (dq < 0.0) {
            points.push(p.lerp(q, dp / (dp - dq)));
        }
    }

    // Sort them round their middle.
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let side = normal.any_orthogonal_vector().normalize_or_zero();
    let other = normal.cross(side);
    let angle = |p: &DVec3| func::atan2((*p - middle).dot(other), (*p - middle).dot(side));
    points.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
    points
}

/// The corners of the view volume, in the order of a box's corners; the far ones come first, as
/// depth is 0 there.
fn view_volume(camera: &Camera, renderer: &Renderer) -> [DVec3; 8] {
    let world_from_clip = renderer.view_transform(camera).clip_from_world().inverse();
    let clip = Aabb { min: DVec3::new(-1.0, -1.0, 0.0), max: DVec3::ONE };
    clip.corners().map(|corner| world_from_clip.project_point3(corner))
}

/// A camera beside another one, that sees it, its view volume and the scene.
fn beside(camera: &Camera, volume: &[DVec3; 8], renderer: &Renderer) -> Camera {
    let axes = camera.view_from_world();
    let [right, up, backward] = [0, 1, 2].map(|k| axes.row(k).truncate());
    let mut all = renderer.world().bounds;
    volume.iter().chain([&camera.position]).for_each(|corner| all.include(*corner));
    frame_from(&all, right + up * 0.5 + backward * 0.35, up, renderer.lens, renderer.aspect(), FILL)
}

/// Where a camera sees places of the world.
struct Screen {
    clip_from_world: DMat4,
    /// Width and height in pixels.
    size: [f64; 2],
}

impl Screen {
    /// The pixel of a place in front of the camera.
    fn place(&self, at: DVec3) -> Option<[f64; 2]> {
        let clip = self.clip_from_world * at.extend(1.0);
        let [width, height] = self.size;
        let pixel = [(1.0 + clip.x / clip.w) / 2.0 * width, (1.0 - clip.y / clip.w) / 2.0 * height];
        (clip.w > 0.0 && pixel.iter().all(|c| c.is_finite())).then_some(pixel)
    }

    /// The twelve edges of a box; corners differ in x by the first bit of their number, in y by the
    /// second, in z by the third.
    fn cuboid(&self, svg: &mut String, corners: [DVec3; 8], class: &str, name: &str) {
        // Writing to a String cannot fail.
        let _ = write!(svg, r#"<g class="{class}"><title>{}</title>"#, plain(name));
        let at = corners.map(|corner| self.place(corner));
        for (from, bit) in (0..8usize)
            .flat_map(|from| [1, 2, 4].map(|bit| (from, bit)))
            .filter(|(from, bit)| from & bit == 0)
        {
            if let (Some([x1, y1]), Some([x2, y2])) = (at[from], at[from | bit]) {
                let _ =
                    write!(svg, r#"<line x1="{x1:.2}" y1="{y1:.2}" x2="{x2:.2}" y2="{y2:.2}"/>"#);
            }
        }
        svg.push_str("</g>");
    }

    /// A polygon of the world, the part of it in front of the camera.
    fn polygon(&self, svg: &mut String, corners: &[DVec3], class: &str, name: &str) {
        let places: Vec<String> = corners
            .iter()
            .filter_map(|corner| self.place(*corner))
            .map(|[x, y]| format!("{x:.2},{y:.2}"))
            .collect();
        if places.len() > 2 {
            let (points, name) = (places.join(" "), plain(name));
            // Writing to a String cannot fail.
            let _ = write!(
                svg,
                r#"<polygon class="{class}" points="{points}"><title>{name}</title></polygon>"#
            );
        }
    }

    /// A line between two places of the world, the part of it in front of the camera.
    fn segment(&self, svg: &mut String, [from, to]: [DVec3; 2], class: &str, name: &str) {
        /// The least `w` of a place in front.
        const FRONT: f64 = 1e-6;
        let w = |p: DVec3| (self.clip_from_world * p.extend(1.0)).w;
        let (mut ends, [w0, w1]) = ([from, to], [w(from), w(to)]);
        if w0 < FRONT && w1 < FRONT {
            return;
        }
        let crossing = || from.lerp(to, (FRONT - w0) / (w1 - w0));
        match (w0 < FRONT, w1 < FRONT) {
            (true, _) => ends[0] = crossing(),
            (_, true) => ends[1] = crossing(),
            _ => {}
        }
        if let [Some([x1, y1]), Some([x2, y2])] = ends.map(|end| self.place(end)) {
            let name = plain(name);
            // Writing to a String cannot fail.
            let _ = write!(
                svg,
                r#"<line class="{class}" x1="{x1:.2}" y1="{y1:.2}" x2="{x2:.2}" y2="{y2:.2}"><title>{name}</title></line>"#
            );
        }
    }

    /// A part of an acceleration structure: the volume that rays are tested against.
    fn part(&self, svg: &mut String, part: &PathPart) {
        let [min, max] = [part.min, part.max].map(DVec3::from_array);
        match part.volume {
            PartVolume::AxisAlignedBox => {
                self.cuboid(svg, Aabb { min, max }.corners(), "part", &part.name);
            }
            PartVolume::OrientedBox { center, axes } => {
                let unit = Aabb { min: -DVec3::ONE, max: DVec3::ONE }.corners();
                let [x, y, z] = axes.map(DVec3::from_array);
                let corners = unit.map(|c| DVec3::from_array(center) + x * c.x + y * c.y + z * c.z);
                self.cuboid(svg, corners, "part", &part.name);
            }
            PartVolume::Sphere { center, radius } => {
                for normal in [DVec3::X, DVec3::Y, DVec3::Z] {
                    let center = DVec3::from_array(center);
                    let circle = outline(&AreaShape::Disc { center, normal, radius });
                    self.polygon(svg, &circle, "part", &part.name);
                }
            }
        }
    }

    /// A dot with its name.
    fn point(&self, svg: &mut String, at: DVec3, class: &str, name: &str) {
        let Some([x, y]) = self.place(at) else { return };
        let name = plain(name);
        // Writing to a String cannot fail.
        let _ = write!(
            svg,
            r#"<circle class="{class}" cx="{x:.2}" cy="{y:.2}" r="4"><title>{name}</title></circle>"#
        );
    }
}

/// A text inside XML.
fn plain(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p10_a_box_is_culled_by_the_plane_that_it_lies_beyond() {
        let clip_from_world = Camera::look_at([0.0, 0.0, 10.0], [0.0; 3])
            .transform(1.0, (1.0, 20.0))
            .clip_from_world();
        let cube = |x: f64, z: f64| {
            Aabb { min: DVec3::new(x - 1.0, -1.0, z - 1.0), max: DVec3::new(x + 1.0, 1.0, z + 1.0) }
                .corners()
        };
        assert_eq!(beyond(&cube(0.0, 0.0), &clip_from_world), None);
        assert_eq!(beyond(&cube(-20.0, 0.0), &clip_from_world), Some("left"));
        assert_eq!(beyond(&cube(20.0, 0.0), &clip_from_world), Some("right"));
        assert_eq!(beyond(&cube(0.0, -30.0), &clip_from_world), Some("far"));
    }

    #[test]
    fn p22_a_plane_cuts_a_box_in_a_polygon() {
        let unit = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
        let square = section(&unit, [0.0, 0.0, 1.0, -0.25]);
        assert_eq!(square.len(), 4);
        assert!(square.iter().all(|p| (p.z - 0.25).abs() < 1e-12));
        let around: f64 = (0..4).map(|i| (square[i] - square[(i + 1) % 4]).length()).sum();
        assert!((around - 4.0).abs() < 1e-12, "in order round the square: {around}");
        assert_eq!(section(&unit, [1.0, 1.0, 1.0, -1.5]).len(), 6);
        assert!(section(&unit, [1.0, 0.0, 0.0, -2.0]).is_empty());
    }

    #[test]
    fn places_are_where_the_picture_shows_them() {
        let camera = Camera::look_at([0.0, 0.0, 10.0], [0.0, 0.0, 0.0]);
        let screen = Screen {
            clip_from_world: camera.transform(2.0, (1.0, 20.0)).clip_from_world(),
            size: [200.0, 100.0],
        };
        assert_eq!(screen.place(DVec3::ZERO), Some([100.0, 50.0]));
        assert_eq!(screen.place(DVec3::new(0.0, 0.0, 11.0)), None);
        let top = 10.0 * func::tan(Camera::VIEW_ANGLE / 2.0);
        let [x, y] = screen.place(DVec3::new(-2.0 * top, top, 0.0)).unwrap();
        assert!(x.abs() < 1e-9 && y.abs() < 1e-9, "{x} {y}");
    }
}
