//! The scene from outside: the view volume of its camera, its lights and the boxes of its objects
//! as lines over a picture from elsewhere.
//!
//! Source: the course, notes P, the view volume.

use crate::answer::Answer;
use serde_json::json;
use std::fmt::Write;
use vitral::internals::math::DVec4;
use vitral::internals::scene::framing::{depth_range, frame_from};
use vitral::{Aabb, Camera, DMat4, DVec3, Error, LightKind, Renderer, Viewpoint};

/// How much of the picture is filled.
const FILL: f64 = 0.8;

/// The picture from `second`, or from beside the camera, with what belongs to the camera drawn over
/// it.
pub(crate) fn overview(renderer: &mut Renderer, second: Option<&Viewpoint>) -> Answer {
    let camera = renderer.frame_camera();
    let lights = renderer.frame_lights(&camera);
    let volume = view_volume(&camera, renderer);
    let outside = match second {
        Some(viewpoint) => {
            viewpoint.apply(renderer, renderer.scene().usual_up())?;
            renderer.frame_camera()
        }
        None => beside(&camera, &volume, renderer),
    };

    // Draw lines where the other camera sees them.
    let [width, height] = [renderer.settings.picture.width, renderer.settings.picture.height];
    let seen_by_camera = clip_from_world(&camera, renderer);
    let clip_from_world = clip_from_world(&outside, renderer);
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
    for light in lights.iter().filter(|light| light.enabled) {
        if let LightKind::Point { position } | LightKind::Spot { position, .. } = light.kind {
            screen.point(&mut svg, position, "light", &light.name);
        }
    }
    screen.point(&mut svg, camera.position, "eye", "");
    svg.push_str("</svg>");

    // The lights are those of the first camera.
    renderer.lights = Some(lights);
    renderer.light_edits.clear();
    let picture = renderer.render_from(&outside)?;
    let missing = || Error::usage("this picture has no colours", "");
    let pixels = picture.frame.color.as_ref().ok_or_else(missing)?.data().as_flattened().to_vec();
    Ok((json!({"width": width, "height": height, "drawing": svg}), vec![pixels]))
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

/// World to clip for what a camera sees of the scene.
fn clip_from_world(camera: &Camera, renderer: &Renderer) -> DMat4 {
    camera
        .transform(renderer.aspect(), depth_range(camera, &renderer.world().bounds))
        .clip_from_world()
}

/// The corners of the view volume, in the order of a box's corners; the far ones come first, as
/// depth is 0 there.
fn view_volume(camera: &Camera, renderer: &Renderer) -> [DVec3; 8] {
    let world_from_clip = clip_from_world(camera, renderer).inverse();
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
    fn places_are_where_the_picture_shows_them() {
        let camera = Camera::look_at([0.0, 0.0, 10.0], [0.0, 0.0, 0.0]);
        let screen = Screen {
            clip_from_world: camera.transform(2.0, (1.0, 20.0)).clip_from_world(),
            size: [200.0, 100.0],
        };
        assert_eq!(screen.place(DVec3::ZERO), Some([100.0, 50.0]));
        assert_eq!(screen.place(DVec3::new(0.0, 0.0, 11.0)), None);
        let top = 10.0 * vitral::internals::math::func::tan(Camera::VIEW_ANGLE / 2.0);
        let [x, y] = screen.place(DVec3::new(-2.0 * top, top, 0.0)).unwrap();
        assert!(x.abs() < 1e-9 && y.abs() < 1e-9, "{x} {y}");
    }
}
