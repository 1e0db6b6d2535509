//! Every shared model is read, and has as many triangles as the manifest says.

use crate::common::{Folder, models};
use serde_json::Value;
use vitral_exec::Workers;
use vitral_io::{Error, load};
use vitral_scene::{Mesh, Scene, World};

const READ: [&str; 6] = ["obj", "stl", "ply", "off", "gltf", "glb"];

fn open(path: &str) -> Result<Scene, Error> {
    let full = models().unwrap().join(path);
    let bytes = std::fs::read(&full).unwrap();
    load(&bytes, path, &Folder(full.parent().unwrap().to_path_buf()), &Workers::new(2))
}

fn extension(path: &str) -> String {
    path.rsplit('.').next().unwrap_or("").to_ascii_lowercase()
}

#[test]
fn triangle_counts_are_those_of_the_manifest() {
    let Some(models) = models() else { return };
    let manifest: Value =
        serde_json::from_slice(&std::fs::read(models.join("manifest.json")).unwrap()).unwrap();
    let mut compared = 0;
    for entry in manifest["files"].as_array().unwrap() {
        let path = entry["path"].as_str().unwrap();
        if path.starts_with("malformed/") || !READ.contains(&extension(path).as_str()) {
            continue;
        }
        let scene = open(path).unwrap_or_else(|e| panic!("{e}"));
        scene.meshes.iter().for_each(|m| m.check().unwrap());
        let world = World::new(&scene).unwrap();
        if let Some(triangles) = entry["triangles"].as_u64() {
            assert_eq!(u64::from(world.facet_count), triangles, "{path}: {:?}", scene.warnings);
            compared += 1;
        }
        // The extent is the second witness: it tells a wrong number or axis.
        if let Some(extent) =
            entry["extent"].as_array().filter(|_| !extension(path).starts_with("gl"))
        {
            let size = world.bounds.size();
            for (axis, expected) in extent.iter().enumerate() {
                let (seen, expected) = (size[axis], expected.as_f64().unwrap());
                assert!(
                    (seen - expected).abs() <= 1e-3 * world.bounds.diagonal() + 1e-3,
                    "{path}: {seen} {expected}"
                );
            }
        }
    }
    assert!(compared > 50, "only {compared} files have a count");
}

#[test]
fn files_without_an_extension_are_known_by_content() {
    if models().is_none() {
        return;
    }
    assert_eq!(open("assimp/noext/stl_without_extension").unwrap().meshes[0].triangles.len(), 1);
    assert_eq!(open("assimp/noext/off_without_extension").unwrap().meshes[0].triangles.len(), 12);
}

#[test]
fn formats_that_are_not_read_are_named() {
    if models().is_none() {
        return;
    }
    for (path, name) in [
        ("assimp/dae/teapots.DAE", "Collada"),
        ("assimp/3ds/fels.3ds", "3DS"),
        ("assimp/3ds/cubes_with_alpha.3DS", "3DS"),
        ("assimp/3mf/box.3mf", "3MF"),
    ] {
        match open(path) {
            Err(Error::Unsupported { what, .. }) => {
                assert!(what.contains(name) && what.contains("OBJ (.obj)"), "{what}")
            }
            other => panic!("{path}: {other:?}"),
        }
    }
}

/// Positions of every corner, in order.
fn corners(mesh: &Mesh) -> Vec<[f32; 3]> {
    mesh.triangles.as_flattened().iter().map(|&i| mesh.positions[i as usize]).collect()
}

#[test]
fn both_spiders_are_equal() {
    if models().is_none() {
        return;
    }
    let (text, binary) = (
        open("assimp/stl/Spider_ascii.stl").unwrap(),
        open("assimp/stl/Spider_binary.stl").unwrap(),
    );
    let (text, binary) = (&text.meshes[0], &binary.meshes[0]);
    assert_eq!((text.positions.len(), binary.positions.len()), (722, 722));
    assert_eq!(text.triangles, binary.triangles);
    // The text has six decimals.
    for (a, b) in corners(text).iter().zip(corners(binary)) {
        assert!((0..3).all(|k| (a[k] - b[k]).abs() <= 1e-6), "{a:?} {b:?}");
    }
}

#[test]
fn results_do_not_depend_on_threads() {
    if models().is_none() {
        return;
    }
    for path in
        ["furniture-cc0/peterbilt/peterbilt.obj", "robot/laser_link.stl", "assimp/ply/Wuson.ply"]
    {
        let full = models().unwrap().join(path);
        let bytes = std::fs::read(&full).unwrap();
        let folder = Folder(full.parent().unwrap().to_path_buf());
        let one = load(&bytes, path, &folder, &Workers::single()).unwrap();
        let three = load(&bytes, path, &folder, &Workers::new(3)).unwrap();
        assert_eq!(one.meshes, three.meshes, "{path}");
        assert_eq!(one.warnings, three.warnings, "{path}");
    }
}

#[test]
fn materials_and_textures_are_found() {
    if models().is_none() {
        return;
    }
    let pool = open("furniture-cc0/poolTable/poolTable.obj").unwrap();
    assert_eq!(
        (pool.materials.len(), pool.textures.len(), pool.warnings.len()),
        (27, 17, 0),
        "{:?}",
        pool.warnings
    );
    let spider = open("assimp/obj/spider.obj").unwrap();
    // The fifth material of its library, Brusttex, is used by no face.
    assert_eq!((spider.materials.len(), spider.textures.len()), (4, 4), "{:?}", spider.warnings);
    let cabinet = open("furniture-cc0/glassDoorCabinet/glassDoorCabinet.obj").unwrap();
    assert_eq!(cabinet.materials.iter().filter(|m| m.opacity < 1.0).count(), 1);
}
