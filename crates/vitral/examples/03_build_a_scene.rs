//! A scene made by hand: a mesh from points, materials, lights, and one mesh at many places.
//!
//! `cargo run --release -p vitral --example 03_build_a_scene [FOLDER]`

use std::path::PathBuf;
use vitral::{Attenuation, Camera, DMat4, DVec3, Light, Material, Mesh, Renderer, Scene, solids};

/// A pyramid: five points, a square and four triangles, counter-clockwise seen from outside.
fn pyramid() -> Mesh {
    let corners =
        [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0], [0.0, 1.5, 0.0]];
    let faces = [&[3, 2, 1, 0][..], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];
    Mesh::from_polygons(corners, faces).with_name("pyramid")
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("target/examples".to_owned()));
    std::fs::create_dir_all(&folder)?;

    // Materials: sandstone for the pyramids, a pale ground.
    let mut scene = Scene::default();
    let stone = scene.add_material(Material::matte([0.75, 0.55, 0.3]).with_name("sandstone"));
    let sand = scene.add_material(Material::matte([0.8, 0.7, 0.5]).with_name("sand"));

    // One mesh at nine places: instances share it.
    scene.add_mesh(pyramid().with_material(stone), DMat4::from_scale(DVec3::splat(1.4)));
    for i in 1..9 {
        let (angle, distance) = (f64::from(i) * 2.4, 1.9 + f64::from(i) * 0.5);
        let turned =
            DMat4::from_rotation_y(angle) * DMat4::from_translation(DVec3::new(distance, 0.0, 0.0));
        scene.add_instance(0, turned * DMat4::from_scale(DVec3::splat(0.45)));
    }
    scene.add_mesh(solids::plane(13.0, 13.0, 1, 1).with_material(sand), DMat4::IDENTITY);

    // A low sun, a lamp whose light fades with the distance, and a little light from everywhere.
    scene.add_light(Light::directional([-1.0, -0.6, -0.4]).with_color([0.9, 0.75, 0.55]));
    let fading = Attenuation::Clamped { c1: 0.5, c2: 0.0, c3: 0.4 };
    scene.add_light(
        Light::point([-1.5, 1.2, 3.0]).with_color([0.3, 0.5, 1.0]).with_attenuation(fading),
    );
    scene.ambient = [0.12, 0.13, 0.18];

    let camera =
        Camera::look_at([-6.0, 8.0, 18.0], [0.0, 0.3, 0.0]).with_view_angle(38.0f64.to_radians());
    let path = folder.join("03_build_a_scene.png");
    Renderer::new(scene)?.with_camera(camera).render()?.save(&path)?;
    println!("wrote {}", path.display());
    Ok(())
}
