//! Normal maps lean the normal along the texture as it lies on the surface, however it is turned,
//! mirrored or seen (glTF 2.0, 3.7.2.1 and 3.9).

use super::common::{colors, exact, on_z, sun};
use std::sync::Arc;
use vitral::internals::math::DVec2;
use vitral::{
    Attribute, Camera, DMat4, DVec3, Encoding, Illumination, Material, Mesh, Part, Plane,
    Reflectance, Scene, Texture, TextureRef,
};

/// Red and green of the texel: a normal that leans along growing u, and more along falling v.
const TEXEL: [u8; 4] = [153, 204, 230, 255];

/// A square that faces +z, with texture coordinates that grow along these directions, and one texel
/// all over.
fn square(along_u: DVec2, along_v: DVec2, with_normals: bool, world_from_model: DMat4) -> Scene {
    let corners = [[-1.0f32, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let uv = corners.map(|[x, y]| {
        let at = DVec2::new(x.into(), y.into());
        [at.dot(along_u) as f32, at.dot(along_v) as f32]
    });
    let mesh = Mesh {
        positions: corners.map(|[x, y]| [x, y, 0.0]).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        parts: vec![Part { name: String::new(), triangles: 0..2, material: Some(0) }],
        uvs: vec![Attribute::per_vertex(uv.to_vec())],
        normals: with_normals.then(|| Attribute::per_vertex(vec![[0.0, 0.0, 1.0]; 4])),
        ..Mesh::default()
    };
    let mut scene = Scene::default();
    scene.textures.push(Arc::new(Texture::new(
        "leaning".into(),
        Plane::filled(1, 1, TEXEL),
        Encoding::Linear,
    )));
    let reflectance =
        Reflectance::Phong { ka: [0.0; 3], kd: [1.0; 3], ks: [0.0; 3], shininess: 1.0 };
    let normal_texture = Some(TextureRef::new(0));
    scene.add_material(Material {
        reflectance,
        normal_texture,
        double_sided: true,
        ..Material::default()
    });
    scene.add_mesh(mesh, world_from_model);
    scene
}

/// How light the middle of a scene is, seen and lit from these directions.
fn shown(scene: &Scene, seen_from: DVec3, lit_from: DVec3) -> f64 {
    let mut renderer = exact(scene.clone(), 9, 9);
    renderer.camera = Some(Camera { position: seen_from * 5.0, ..on_z(1.0, 0.3) });
    renderer.lights = Some(vec![sun(lit_from, 1.0)]);
    renderer.ambient = [0.0; 3];
    renderer.settings.shading.illumination = Illumination::Lambert;
    f64::from(colors(&mut renderer)[4 * 9 + 4][0]) / 255.0
}

#[test]
fn bumps_stay_bumps_on_mirrored_textures_and_nodes_and_are_dents_from_behind() {
    let [x, y, z] = [0, 1, 2].map(|k| f64::from(TEXEL[k]) / 255.0 * 2.0 - 1.0);
    let quarter = DVec2::new(0.8, 0.6);
    // u and v of the usual way up, mirrored each, both, and turned.
    let ways = [
        (DVec2::X, -DVec2::Y),
        (-DVec2::X, -DVec2::Y),
        (DVec2::X, DVec2::Y),
        (-DVec2::X, DVec2::Y),
        (quarter, DVec2::new(0.6, -0.8)),
        (-quarter, DVec2::new(0.6, -0.8)),
    ];
    let scales = [
        DVec3::ONE,
        DVec3::new(-1.0, 1.0, 1.0),
        DVec3::new(1.0, -1.0, 1.0),
        DVec3::new(1.0, 1.0, -1.0),
    ];
    for ((along_u, along_v), scale, side, with_normals) in cases(&ways, &scales) {
        let scene = square(along_u, along_v, with_normals, DMat4::from_scale(scale));
        // What the texture says, in the model: the front is where corners run counter-clockwise,
        // which a node does not change.
        let leaning = (along_u * x - along_v * y).extend(0.0) * scale;
        let front = scale.z * DVec3::Z;
        let normal = (leaning + front * z).normalize();
        let seen_from = DVec3::Z * side;
        let normal = if front.dot(seen_from) > 0.0 { normal } else { -normal };
        for from in
            [DVec3::new(0.5, 0.3, side), DVec3::new(-0.4, 0.6, side), DVec3::new(0.2, -0.7, side)]
        {
            let shown = shown(&scene, seen_from, from);
            let expected = normal.dot(from.normalize()).max(0.0);
            let case = format!(
                "u {along_u}, v {along_v}, node {scale}, side {side}, normals {with_normals}, from {from}"
            );
            assert!((shown - expected).abs() < 0.02, "{case}: {shown}, not {expected}");
        }
    }
}

#[test]
fn a_files_own_tangents_say_where_the_texture_lies() {
    let [x, y, z] = [0, 1, 2].map(|k| f64::from(TEXEL[k]) / 255.0 * 2.0 - 1.0);
    let along = DVec3::new(0.6, 0.8, 0.0);
    for (scale, side, w) in [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, 1.0, -1.0)]
        .into_iter()
        .flat_map(|scale| {
            [1.0, -1.0].into_iter().flat_map(move |side| [1.0, -1.0].map(|w| (scale, side, w)))
        })
    {
        // Texture coordinates say something else, and do not count.
        let mut scene = square(DVec2::X, -DVec2::Y, true, DMat4::from_scale(scale));
        let given = along.as_vec3().extend(w as f32).to_array();
        Arc::make_mut(&mut scene.meshes[0]).tangents = Some(Attribute::per_vertex(vec![given; 4]));
        let leaning = (along * x + DVec3::Z.cross(along) * w * y) * scale;
        let front = scale.z * DVec3::Z;
        let normal = (leaning + front * z).normalize();
        let seen_from = DVec3::Z * side;
        let normal = if front.dot(seen_from) > 0.0 { normal } else { -normal };
        for from in [DVec3::new(0.5, 0.3, side), DVec3::new(-0.4, 0.6, side)] {
            let shown = shown(&scene, seen_from, from);
            let expected = normal.dot(from.normalize()).max(0.0);
            assert!(
                (shown - expected).abs() < 0.02,
                "node {scale}, side {side}, w {w}: {shown}, not {expected}"
            );
        }
    }
}

type Case = ((DVec2, DVec2), DVec3, f64, bool);

/// Every combination.
fn cases(ways: &[(DVec2, DVec2)], scales: &[DVec3]) -> Vec<Case> {
    let mut cases = Vec::new();
    for &way in ways {
        for &scale in scales {
            for side in [1.0, -1.0] {
                cases.extend([true, false].map(|with_normals| (way, scale, side, with_normals)));
            }
        }
    }
    cases
}
