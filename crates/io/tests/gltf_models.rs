//! glTF and GLB: the shared models and the table of malformed files.

use super::gltf::check;
use std::path::{Path, PathBuf};
use vitral_exec::Workers;
use vitral_io::{Error, NoFiles, ResolveError, Resolver, gltf};
use vitral_math::{Aabb, DVec3};
use vitral_scene::{NodeTransform, Projection, Scene, World};

const MODELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/models");

/// Files of one folder.
struct Folder(PathBuf);

impl Resolver for Folder {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        std::fs::read(self.0.join(path)).map_err(|_| ResolveError::NotFound)
    }
}

fn shared(path: &str) -> Option<PathBuf> {
    let path = Path::new(MODELS).join(path);
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    Some(path)
}

fn load_path(path: &Path) -> Result<Scene, Error> {
    let bytes = std::fs::read(path).unwrap();
    let folder = Folder(path.parent().unwrap().to_owned());
    gltf::load(&bytes, &path.file_name().unwrap().to_string_lossy(), &folder, &Workers::new(2))
}

#[test]
fn every_shared_model_loads_as_the_manifest_says() {
    let Some(manifest) = shared("manifest.json") else { return };
    let manifest: serde_json::Value =
        serde_json::from_slice(&std::fs::read(manifest).unwrap()).unwrap();
    let mut seen = 0;
    for entry in manifest["files"].as_array().unwrap() {
        let path = entry["path"].as_str().unwrap();
        if !path.starts_with("assimp/gltf") || !(path.ends_with(".gltf") || path.ends_with(".glb"))
        {
            continue;
        }
        let scene = load_path(&Path::new(MODELS).join(path)).unwrap_or_else(|e| panic!("{e}"));
        check(&scene);
        let world = World::new(&scene).unwrap();
        if let Some(triangles) = entry["triangles"].as_u64() {
            // The manifest counts each primitive as a mesh; they are parts here.
            assert_eq!(u64::from(world.facet_count), triangles, "{path}");
            let parts = |meshes: &mut dyn Iterator<Item = &vitral_scene::Mesh>| {
                meshes.map(|m| m.parts.len() as u64).sum::<u64>()
            };
            assert_eq!(
                parts(&mut world.instances.iter().map(|i| &*i.mesh)),
                entry["instances"].as_u64().unwrap(),
                "{path}"
            );
            assert_eq!(
                parts(&mut scene.meshes.iter().map(|m| &**m)),
                entry["meshes"].as_u64().unwrap(),
                "{path}"
            );
            let bounds = Aabb::from_points(world.instances.iter().flat_map(|i| {
                let positions = i.mesh.positions.iter();
                positions.map(|p| {
                    i.world_from_model.transform_point3(DVec3::from_array(p.map(f64::from)))
                })
            }));
            for (k, size) in entry["extent"].as_array().unwrap().iter().enumerate() {
                let (ours, theirs) = (bounds.size()[k], size.as_f64().unwrap());
                assert!(
                    (ours - theirs).abs() < 1e-3 * theirs.max(1.0),
                    "{path}: axis {k}: {ours} against {theirs}"
                );
            }
        } else {
            let mesh = &scene.meshes[0];
            assert!(
                !mesh.points.is_empty() || !mesh.lines.is_empty() || !mesh.triangles.is_empty(),
                "{path}"
            );
        }
        seen += 1;
    }
    assert!(seen >= 26, "{seen} models");
}

#[test]
fn all_primitive_modes_of_the_asset_generator() {
    let Some(folder) = shared("assimp/gltf/glTF-Asset-Generator/Mesh_PrimitiveMode") else {
        return;
    };
    // Points, lines and triangles of files 00 to 15, after the README beside them.
    let expected = [
        (1024, 0, 0),
        (0, 4, 0),
        (0, 4, 0),
        (0, 4, 0),
        (0, 0, 2),
        (0, 0, 2),
        (0, 0, 2),
        (1024, 0, 0),
        (0, 4, 0),
        (0, 4, 0),
        (0, 4, 0),
        (0, 0, 2),
        (0, 0, 2),
        (0, 0, 2),
        (0, 0, 2),
        (0, 0, 2),
    ];
    for (i, expected) in expected.into_iter().enumerate() {
        let scene = load_path(&folder.join(format!("Mesh_PrimitiveMode_{i:02}.gltf"))).unwrap();
        let mesh = &scene.meshes[0];
        let found = (mesh.points.len(), mesh.lines.len(), mesh.triangles.len());
        assert_eq!(found, expected, "file {i:02}");
        // All triangles face the viewer.
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| DVec3::from_array(mesh.positions[i as usize].map(f64::from)));
            assert!((b - a).cross(c - a).z > 0.0, "file {i:02}: {t:?} faces away");
        }
    }
}

#[test]
fn three_containers_of_one_box_are_equal() {
    let Some(root) = shared("assimp/gltf") else { return };
    let names = [
        "BoxTextured-glTF/BoxTextured.gltf",
        "BoxTextured-glTF-Embedded/BoxTextured.gltf",
        "BoxTextured-glTF-Binary/BoxTextured.glb",
    ];
    let [a, b, c] = names.map(|n| load_path(&root.join(n)).unwrap());
    // The first file's sampler repeats mirrored, that of the other two does not.
    let with_default_sampler = |scene: &Scene| {
        let mut material = scene.materials[0].clone();
        material.textures_mut().for_each(|t| t.sampler = vitral_frame::Sampler::default());
        material
    };
    assert_eq!(b.materials, c.materials);
    for other in [&b, &c] {
        assert_eq!(a.meshes, other.meshes);
        assert_eq!(with_default_sampler(&a), with_default_sampler(other));
        assert_eq!(a.textures[0].levels, other.textures[0].levels);
        assert_eq!(a.textures[0].encoding, other.textures[0].encoding);
    }
    assert_eq!((a.meshes.len(), a.textures.len(), a.warnings.len()), (1, 1, 0));
    assert!(a.materials[0].base_texture.is_some());
}

#[test]
fn the_engine_shares_its_meshes() {
    let Some(path) = shared("assimp/gltf/2CylinderEngine-glTF-Binary/2CylinderEngine.glb") else {
        return;
    };
    let scene = load_path(&path).unwrap();
    let world = World::new(&scene).unwrap();
    assert_eq!((scene.meshes.len(), world.instances.len(), world.facet_count), (29, 67, 121_496));
    for workers in [Workers::single(), Workers::new(3)] {
        let again =
            gltf::load(&std::fs::read(&path).unwrap(), "2CylinderEngine.glb", &NoFiles, &workers)
                .unwrap();
        assert_eq!((again.meshes, again.warnings), (scene.meshes.clone(), scene.warnings.clone()));
    }
}

#[test]
fn cameras_of_the_shared_file() {
    let Some(path) = shared("assimp/gltf/cameras/Cameras.gltf") else { return };
    let world = World::new(&load_path(&path).unwrap()).unwrap();
    let [perspective, parallel] = &world.cameras[..] else {
        panic!("two cameras, not {}", world.cameras.len())
    };
    assert_eq!(perspective.position, DVec3::new(0.5, 0.5, 3.0));
    assert_eq!(perspective.projection, Projection::Perspective { view_angle: f64::from(0.7f32) });
    assert_eq!(perspective.clip, Some((f64::from(0.01f32), 100.0)));
    assert_eq!(parallel.projection, Projection::Parallel { height: 2.0 });
    assert_eq!(parallel.focal_point, DVec3::new(0.5, 0.5, 2.0));
}

#[test]
fn the_texture_transform_test_points_at_its_own_marks() {
    let Some(path) = shared("assimp/gltf/textureTransform/TextureTransformTest.gltf") else {
        return;
    };
    let scene = load_path(&path).unwrap();
    let transform = |name: &str| {
        scene.materials.iter().find(|m| m.name == name).unwrap().base_texture.unwrap().transform
    };
    // Under the mark "correct" lies the arrow's diagonal, just beyond its tip at (0.68, 0.68) of
    // the image.
    for (name, x, y) in [("Rotation", -0.079_048_22f32, -0.516_267_5f32), ("All", -0.07, -0.25)] {
        let [u, v] = transform(name).map(|row| row[0] * (x + 0.5) + row[1] * (0.5 - y) + row[2]);
        assert!((u - v).abs() < 0.05 && (0.7..0.85).contains(&u), "{name}: ({u}, {v})");
    }
    assert_eq!(transform("Offset UV"), [[1.0, 0.0, 0.5], [0.0, 1.0, 0.5]]);
}

#[test]
fn a_skin_in_its_bind_pose() {
    let Some(path) = shared("assimp/gltf/simple_skin/simple_skin.gltf") else { return };
    let scene = load_path(&path).unwrap();
    // Both joints stand at (0, 1, 0) and both inverse bind matrices move by (-0.5, -1, 0).
    let mut expected = Vec::new();
    for y in [0.0, 0.5, 1.0, 1.5, 2.0] {
        expected.extend([[-0.5, y, 0.0], [0.5, y, 0.0]]);
    }
    assert_eq!(scene.meshes[0].positions, expected);
    let root = &scene.nodes[*scene.roots.last().unwrap() as usize];
    assert_eq!(
        (root.mesh, root.transform),
        (Some(0), NodeTransform::default()),
        "the mesh hangs in the world"
    );
    assert!(scene.nodes[0].mesh.is_none());
}

#[test]
fn the_table_of_malformed_files() {
    let Some(root) = shared("malformed/gltf") else { return };
    let fails = |path: &str, parts: &[&str]| {
        let message = load_path(&root.join(path)).map(|_| ()).expect_err(path).to_string();
        for part in parts {
            assert!(message.contains(part), "{path}: `{message}` should contain `{part}`");
        }
    };
    fails(
        "IncorrectVertexArrays/Cube.gltf",
        &["Cube.gltf: meshes[1].primitives[0]: 35 vertices, TRIANGLES need a multiple of 3"],
    );
    fails(
        "IndexOutOfRange/IndexOutOfRange.gltf",
        &["meshes[0].primitives[0].indices", "the primitive has 24 vertices"],
    );
    fails("IndexOutOfRange/AllIndicesOutOfRange.gltf", &["meshes[0].primitives[0].indices"]);
    fails(
        "MissingBin/BoxTextured.gltf",
        &["BoxTextured.gltf: needs `BoxTextured0.bin`: there is no such file"],
    );
    fails("RecursiveNodes/RecursiveNodes.gltf", &["nodes[0]", "its own ancestor"]);
    fails("SchemaFailures/sceneWrongType.gltf", &["scene: invalid type: string"]);
    fails("wrongTypes/badArray.gltf", &["badArray.gltf: meshes[0].primitives: invalid type: map"]);
    fails(
        "wrongTypes/badExtension.gltf",
        &["materials[0].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform"],
    );
    fails("wrongTypes/badNumber.gltf", &["materials[0].normalTexture.scale: invalid type: string"]);
    fails("wrongTypes/badObject.gltf", &["materials[0].pbrMetallicRoughness", "invalid type"]);
    fails("wrongTypes/badString.gltf", &["scenes[0].name: invalid type: integer `42`"]);
    fails(
        "wrongTypes/badUint.gltf",
        &["materials[0].pbrMetallicRoughness.baseColorTexture.index: invalid type: integer `-1`"],
    );

    let loads = |path: &str, part: &str| {
        let scene = load_path(&root.join(path)).unwrap_or_else(|e| panic!("{e}"));
        check(&scene);
        assert!(scene.warnings.iter().any(|w| w.contains(part)), "{path}: {:?}", scene.warnings);
        scene
    };
    assert!(loads("TestNoRootNode/NoScene.gltf", "there is no scene").nodes.is_empty());
    assert!(
        loads("TestNoRootNode/SceneWithoutNodes.gltf", "the scene has no nodes").nodes.is_empty()
    );
    loads("BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb", "positions are not finite");
    let mended =
        loads("BoxBadNormals-glTF-Binary/BoxBadNormals.glb", "normals are zero or not finite");
    for mesh in &mended.meshes {
        let finite = |n: &[f32; 3]| n.iter().all(|c| c.is_finite()) && n.iter().any(|&c| c != 0.0);
        assert!(mesh.normals.iter().all(|n| n.values.iter().all(finite)));
    }
    loads("issue_3269/texcoord_crash.gltf", "TEXCOORD_1 without TEXCOORD_0");
}
