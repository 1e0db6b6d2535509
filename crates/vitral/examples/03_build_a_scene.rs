//! A scene made by hand: a mesh from points, materials, lights, and one mesh at many places.
//!
//! `cargo run --release -p vitral --example 03_build_a_scene [FOLDER]`

use std::path::PathBuf;
use vitral::light::{Attenuation, LightKind, Reflectance};
use vitral::math::{DMat4, DVec3};
use vitral::scene::{Faces, NodeTransform, Part, builtin::solids, normals};
use vitral::{Camera, Channel, Error, Light, Material, Mesh, Node, Projection, Renderer, Scene, Workers, picture};

/// A pyramid: five points, a square and four triangles, counter-clockwise seen from outside.
fn pyramid() -> Mesh {
    let corners = vec![3, 2, 1, 0, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4];
    let mut mesh = Mesh {
        name: "pyramid".to_owned(),
        positions: vec![[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0], [0.0, 1.5, 0.0]],
        // The square is cut into two triangles; `faces` remembers that they are one face.
        triangles: vec![[3, 2, 1], [3, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        faces: Faces::Polygons { starts: vec![0, 4, 7, 10, 13, 16], corners },
        parts: vec![Part { name: String::new(), triangles: 0..6, material: Some(0) }],
        ..Mesh::default()
    };
    normals::generate(&mut mesh, 0.5, &Workers::single());
    mesh
}

fn main() -> Result<(), Error> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("target/examples".to_owned()));
    std::fs::create_dir_all(&folder).map_err(|source| Error::Write { path: folder.clone(), source })?;

    // Materials: sandstone for the pyramids, a pale ground.
    let matte = |name: &str, color: [f32; 3]| Material {
        name: name.to_owned(),
        reflectance: Reflectance::Phong { ka: color, kd: color, ks: [0.05; 3], shininess: 10.0 },
        ..Material::default()
    };
    let mut scene = Scene::default();
    scene.add_material(matte("sandstone", [0.75, 0.55, 0.3]));
    let sand = scene.add_material(matte("sand", [0.8, 0.7, 0.5]));

    // One mesh at nine places: instances share it.
    scene.add_mesh(pyramid(), DMat4::from_scale(DVec3::splat(1.4)));
    for i in 1..9 {
        let (angle, distance) = (f64::from(i) * 2.4, 1.9 + f64::from(i) * 0.5);
        let turned = DMat4::from_rotation_y(angle) * DMat4::from_translation(DVec3::new(distance, 0.0, 0.0));
        let transform = NodeTransform::Matrix(turned * DMat4::from_scale(DVec3::splat(0.45)));
        scene.add_root(Node { name: format!("pyramid {i}"), transform, mesh: Some(0), ..Node::default() });
    }
    let mut ground = solids::plane(13.0, 13.0, 1, 1);
    ground.parts[0].material = Some(sand);
    scene.add_mesh(ground, DMat4::IDENTITY);

    // A low sun, a lamp whose light fades with the distance, and a little light from everywhere.
    scene.lights.push(Light {
        kind: LightKind::Directional { direction: DVec3::new(-1.0, -0.6, -0.4) },
        diffuse: [0.9, 0.75, 0.55],
        ..Light::default()
    });
    scene.lights.push(Light {
        kind: LightKind::Point { position: DVec3::new(-1.5, 1.2, 3.0) },
        diffuse: [0.3, 0.5, 1.0],
        attenuation: Attenuation::Clamped { c1: 0.5, c2: 0.0, c3: 0.4 },
        ..Light::default()
    });
    scene.ambient = [0.12, 0.13, 0.18];

    let mut renderer = Renderer::new(scene)?;
    renderer.camera = Some(Camera {
        position: DVec3::new(-6.0, 8.0, 18.0),
        focal_point: DVec3::new(0.0, 0.3, 0.0),
        view_up: DVec3::Y,
        projection: Projection::Perspective { view_angle: 38.0f64.to_radians() },
        clip: None,
    });
    let path = folder.join("03_build_a_scene.png");
    picture::save(&path, &renderer.render()?.frame, Channel::Color)?;
    println!("wrote {}", path.display());
    Ok(())
}
