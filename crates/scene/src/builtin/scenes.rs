//! The built-in scenes themselves. Y is up, a unit is about a hand.

use super::solids;
use crate::lab::{self, LabView};
use crate::{Camera, Mesh, Node, Projection, Scene};
use vitral_light::{Material, Reflectance, Rgb};
use vitral_math::{DMat4, DVec3};

/// Coloured plastic: the colour in ambient and diffuse light, white highlights (docs/course.md
/// P35).
pub(super) fn plastic(name: &str, color: Rgb, shininess: f32) -> Material {
    let reflectance = Reflectance::Phong { ka: color, kd: color, ks: [0.35; 3], shininess };
    Material { name: name.to_owned(), reflectance, ..Material::default() }
}

/// Chalk: no highlights.
pub(super) fn chalk(name: &str, color: Rgb) -> Material {
    let reflectance = Reflectance::Phong { ka: color, kd: color, ks: [0.0; 3], shininess: 1.0 };
    Material { name: name.to_owned(), reflectance, ..Material::default() }
}

/// A scene with Lab3D's lights and a camera that looks at `target` from 20 degrees above.
fn lab_scene(target: DVec3, distance: f64) -> Scene {
    let mut scene = Scene { lights: lab::lights(), ..Scene::default() };
    scene.cameras.push(lab_camera(target, DVec3::new(-20.0, 30.0, 0.0), distance));
    scene.add_root(Node { name: "eye".to_owned(), camera: Some(0), ..Node::default() });
    scene
}

/// A camera that looks at `target` with the eye turned by `eye_u`, degrees.
pub(super) fn lab_camera(target: DVec3, eye_u: DVec3, distance: f64) -> Camera {
    let projection = Projection::Perspective { view_angle: std::f64::consts::FRAC_PI_6 };
    LabView::towards(target, eye_u, distance).camera(projection)
}

/// Adds `mesh` at `position`, all of it of one material.
pub(super) fn place(scene: &mut Scene, mesh: Mesh, material: Material, position: DVec3) {
    place_as(scene, mesh, material, DMat4::from_translation(position));
}

/// Adds `mesh`, moved by a transform, all of it of one material.
pub(super) fn place_as(
    scene: &mut Scene,
    mut mesh: Mesh,
    material: Material,
    world_from_model: DMat4,
) {
    mesh.name.clone_from(&material.name);
    let material = Some(scene.add_material(material));
    mesh.parts.iter_mut().for_each(|p| p.material = material);
    scene.add_mesh(mesh, world_from_model);
}

pub(super) fn place_floor(scene: &mut Scene, width: f64, tiles: u32) {
    let mut floor = solids::checkerboard(width, tiles);
    let colors = [("dark tiles", [0.2, 0.22, 0.26]), ("light tiles", [0.75, 0.73, 0.68])];
    for (part, (name, color)) in floor.parts.iter_mut().zip(colors) {
        part.material = Some(scene.add_material(chalk(name, color)));
    }
    floor.name = "floor".to_owned();
    scene.add_mesh(floor, DMat4::IDENTITY);
}

/// Eight cubes with gaps between them; x brings red, y green, z blue.
pub(super) fn cubs() -> Scene {
    let mut scene = lab_scene(DVec3::ZERO, 9.0);
    for k in 0..8u8 {
        let bit = |n: u8| f64::from(k >> n & 1);
        let at = DVec3::new(bit(0), bit(1), bit(2));
        let color = (at * 0.65 + 0.2).as_vec3().to_array();
        let material = plastic(&format!("cube {k}"), color, 30.0);
        place(&mut scene, solids::cuboid(DVec3::splat(0.9)), material, (at - 0.5) * 1.5);
    }
    scene
}

/// One sphere of radius 1 at the origin.
pub(super) fn sphere(slices: u32, stacks: u32) -> Scene {
    let mut scene = lab_scene(DVec3::ZERO, 5.0);
    place(
        &mut scene,
        solids::sphere(1.0, slices, stacks),
        plastic("ball", [0.75, 0.2, 0.15], 60.0),
        DVec3::ZERO,
    );
    scene
}

/// A still life.
pub(super) fn scene0() -> Scene {
    let mut scene = lab_scene(DVec3::new(0.0, 0.5, 0.0), 13.0);
    place_floor(&mut scene, 6.0, 8);
    let red = plastic("red box", [0.75, 0.17, 0.13], 20.0);
    place(&mut scene, solids::cuboid(DVec3::new(1.4, 1.4, 1.4)), red, DVec3::new(-1.1, 0.7, -1.1));
    let blue = plastic("blue ball", [0.15, 0.3, 0.75], 80.0);
    place(&mut scene, solids::sphere(0.8, 72, 36), blue, DVec3::new(0.7, 0.8, 1.2));
    let yellow = plastic("yellow cone", [0.85, 0.65, 0.12], 40.0);
    place(&mut scene, solids::cone(0.75, 1.8, 64), yellow, DVec3::new(1.5, 0.9, -1.0));
    let green = plastic("green cylinder", [0.2, 0.55, 0.25], 40.0);
    place(&mut scene, solids::cylinder(0.55, 1.2, 64), green, DVec3::new(-1.3, 0.6, 1.1));
    scene
}

/// Four steps that rise to the left, each with a solid.
pub(super) fn scene1() -> Scene {
    let mut scene = lab_scene(DVec3::new(0.0, 0.8, 0.0), 15.0);
    place_floor(&mut scene, 7.0, 8);
    let at = |k: u32| 1.95 - f64::from(k) * 1.3;
    for k in 0..4 {
        let height = 0.4 * f64::from(k + 1);
        let stone = chalk(&format!("step {}", k + 1), [0.62, 0.58, 0.52]);
        place(
            &mut scene,
            solids::cuboid(DVec3::new(1.3, height, 2.6)),
            stone,
            DVec3::new(at(k), 0.5 * height, 0.0),
        );
    }
    let violet = plastic("violet torus", [0.5, 0.25, 0.65], 60.0);
    place(&mut scene, solids::torus(0.4, 0.17, 72, 36), violet, DVec3::new(at(0), 0.57, 0.5));
    let orange = plastic("orange tetrahedron", [0.85, 0.42, 0.12], 30.0);
    place(&mut scene, solids::tetrahedron(0.7), orange, DVec3::new(at(1), 1.21, 0.2));
    let white = plastic("white column", [0.8, 0.8, 0.78], 30.0);
    place(&mut scene, solids::cylinder(0.3, 1.3, 48), white, DVec3::new(at(2), 1.85, -0.3));
    let teal = plastic("teal ball", [0.12, 0.55, 0.55], 100.0);
    place(&mut scene, solids::sphere(0.5, 72, 36), teal, DVec3::new(at(3), 2.1, 0.3));
    scene
}

/// The teapot alone.
pub(super) fn teapot_scene(divisions: u32) -> Scene {
    let mut scene = Scene::default();
    place(
        &mut scene,
        super::teapot(divisions),
        plastic("teapot", [0.72, 0.66, 0.58], 60.0),
        DVec3::ZERO,
    );
    scene
}

#[cfg(test)]
mod tests {
    use crate::{Solidity, World, builtin};
    use vitral_exec::Workers;

    #[test]
    fn every_name_has_a_sound_scene_with_normals() {
        assert!(builtin::scene("nothing").is_none());
        for (name, description) in builtin::names() {
            let scene = builtin::scene(name).unwrap();
            assert!(!description.is_empty());
            for mesh in &scene.meshes {
                mesh.check().unwrap();
                assert!(mesh.normals.is_some() && mesh.parts.iter().all(|p| p.material.is_some()));
            }
            let world = World::new(&scene).unwrap();
            assert!(world.facet_count > 0 && world.bounds.diagonal() > 0.9, "{name}");
            assert_eq!(world.lights.is_empty(), *name == "teapot", "{name}");
        }
    }

    #[test]
    fn l17_cubs_has_quads_with_one_normal_each_and_sphere_has_vertex_normals() {
        let cubs = builtin::scene("cubs").unwrap();
        assert_eq!(cubs.meshes.len(), 8);
        for cube in &cubs.meshes {
            assert_eq!((cube.face_count(), cube.triangles.len()), (6, 12));
            assert_eq!(cube.normals.as_ref().unwrap().values.len(), 6);
            assert!(Solidity::of(cube, &Workers::single()).is_solid());
        }
        let sphere = builtin::scene("sphere").unwrap();
        let mesh = &sphere.meshes[0];
        for t in 0..mesh.triangles.len() {
            let at = |k: usize| mesh.positions[mesh.triangles[t][k] as usize];
            for (k, n) in mesh.normals.as_ref().unwrap().at(t, &mesh.triangles).iter().enumerate() {
                assert!(
                    (0..3).all(|c| (n[c] - at(k)[c]).abs() < 1e-6),
                    "the normal of a unit sphere is its point"
                );
            }
        }
    }
}
