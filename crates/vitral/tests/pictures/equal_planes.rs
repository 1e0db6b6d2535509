//! P17: facets in one plane have equal depths at every sample, whatever their corners, order,
//! winding or size.

use super::common::{colors, exact, poster};
use vitral::internals::render::registry::VISIBILITY;
use vitral::{Camera, DMat4, DVec3, Mesh, Projection, Renderer, Scene, solids};

/// Adds a mesh of one colour.
fn add(scene: &mut Scene, mut mesh: Mesh, color: [f32; 3], place: DMat4) {
    let material = Some(scene.add_material(poster(color)));
    mesh.parts.iter_mut().for_each(|p| p.material = material);
    scene.add_mesh(mesh, place);
}

/// A decal of many small triangles, turned in the plane of a floor of two.
fn floor_with_decal(decal_first: bool) -> Scene {
    let mut scene = Scene::default();
    let tilted = DMat4::from_rotation_x(0.3) * DMat4::from_rotation_z(0.1);
    let parts = [
        (solids::plane(2.0, 2.0, 1, 1), [1.0, 0.0, 0.0], tilted),
        (solids::plane(0.7, 0.5, 9, 4), [0.0, 1.0, 0.0], tilted * DMat4::from_rotation_y(0.4)),
    ];
    let order = if decal_first { [1, 0] } else { [0, 1] };
    for i in order {
        let (mesh, color, place) = &parts[i];
        add(&mut scene, mesh.clone(), *color, *place);
    }
    scene
}

/// From around and above.
fn cameras() -> Vec<Camera> {
    let around = (0..12).map(|i| {
        let turn = DMat4::from_rotation_y(f64::from(i) * 0.55);
        let position = turn.transform_point3(DVec3::new(2.0, 0.75 + 0.03 * f64::from(i), 0.0));
        let projection = match i % 3 {
            0 => Projection::Parallel { height: 2.5 },
            _ => Projection::Perspective { view_angle: 0.9 },
        };
        Camera { projection, ..Camera::look_at(position, DVec3::ZERO) }
    });
    around.collect()
}

fn count(picture: &[[u8; 4]], is: impl Fn(&[u8; 4]) -> bool) -> usize {
    picture.iter().filter(|p| is(p)).count()
}

/// Pixels that are neither of a pure red or green nor of the background, of a renderer without
/// filtering.
fn red_and_green(r: &mut Renderer) -> [usize; 2] {
    let picture = colors(r);
    [count(&picture, |p| p[0] > 200 && p[1] < 50), count(&picture, |p| p[1] > 200 && p[0] < 50)]
}

#[test]
fn of_a_decal_and_a_floor_the_first_is_seen_whole_and_without_a_speck() {
    for camera in cameras() {
        let seen = |scene: Scene, algorithm: &str| {
            let mut r = exact(scene, 160, 120);
            r.camera = Some(camera);
            r.settings.visibility = algorithm.parse().unwrap();
            red_and_green(&mut r)
        };
        let mut alone = Scene::default();
        let tilted = DMat4::from_rotation_x(0.3) * DMat4::from_rotation_z(0.1);
        let place = tilted * DMat4::from_rotation_y(0.4);
        add(&mut alone, solids::plane(0.7, 0.5, 9, 4), [0.0, 1.0, 0.0], place);
        let [_, whole] = seen(alone, "z-buffer");
        assert!(whole > 10, "{whole}");
        for algorithm in VISIBILITY {
            let [_, green] = seen(floor_with_decal(true), algorithm.name);
            assert_eq!(green, whole, "{}, {:?}", algorithm.name, camera.position);
            let [_, green] = seen(floor_with_decal(false), algorithm.name);
            assert_eq!(green, 0, "{}, {:?}", algorithm.name, camera.position);
        }
    }
}

#[test]
fn of_a_sheet_with_two_sides_the_one_that_faces_the_viewer_is_seen() {
    // The same square twice, cut along different diagonals, with its back first or last.
    let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let front = Mesh::new(corners, [[0, 1, 2], [0, 2, 3]]);
    let back = Mesh::new(corners, [[1, 0, 3], [3, 2, 1]]);
    let place = DMat4::from_rotation_y(0.37) * DMat4::from_rotation_x(0.5);
    for back_first in [false, true] {
        let mut scene = Scene::default();
        let mut sides = [(&front, [1.0, 0.0, 0.0]), (&back, [0.0, 1.0, 0.0])];
        if back_first {
            sides.reverse();
        }
        sides.into_iter().for_each(|(mesh, color)| add(&mut scene, mesh.clone(), color, place));
        for camera in cameras() {
            let towards = place.transform_vector3(DVec3::Z);
            let direction = match camera.projection {
                Projection::Parallel { .. } => camera.position - camera.focal_point,
                Projection::Perspective { .. } | Projection::Window { .. } => {
                    camera.position - place.transform_point3(DVec3::ZERO)
                }
            };
            let from_front = towards.dot(direction) > 0.0;
            for algorithm in VISIBILITY {
                let mut r = exact(scene.clone(), 120, 90);
                r.camera = Some(camera);
                r.settings.visibility = algorithm.choice();
                let [red, green] = red_and_green(&mut r);
                let (seen, hidden) = if from_front { (red, green) } else { (green, red) };
                assert!(
                    seen > 100 && hidden == 0,
                    "{}: {red} red, {green} green, {:?}",
                    algorithm.name,
                    camera.position
                );
            }
        }
    }
}
