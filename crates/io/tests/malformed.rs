//! Bad files: each is refused with its place, or read with a warning; never a panic, a hang or a large allocation.

mod common;

use common::{Folder, files, models};
use proptest::prelude::*;
use std::time::{Duration, Instant};
use vitral_exec::Workers;
use vitral_io::{Error, NoFiles, load};
use vitral_scene::{Scene, World};

/// What the table in the models' README demands of a file.
enum Expected {
    /// An error whose message holds these pieces.
    Refused(&'static [&'static str]),
    /// A scene with warnings that hold these pieces.
    Warned(&'static [&'static str]),
    /// Either, as long as it ends and the scene is sound.
    Sound,
}

use Expected::{Refused, Sound, Warned};

const TABLE: &[(&str, Expected)] = &[
    ("assimp-invalid/OutOfMemory.off", Refused(&["line 2", "353535235358 vertices"])),
    ("assimp-invalid/empty.", Refused(&["empty file"])),
    ("assimp-invalid/emptyIrrMesh.xml", Refused(&["XML is not read"])),
    ("assimp-invalid/malformed.obj", Refused(&["line 23", "index 12, the file has 8 vertices"])),
    ("assimp-invalid/malformed2.obj", Warned(&["line 22: unknown material", "line 23: a face with 0 corners"])),
    ("assimp-invalid/readme.txt", Refused(&["is not read"])),
    ("off/invalid.off", Refused(&["line 2", "edges are required"])),
    ("gltf/IndexOutOfRange/", Refused(&["ndex"])),
    ("gltf/IncorrectVertexArrays/", Refused(&["Cube.gltf"])),
    ("gltf/MissingBin/", Refused(&["BoxTextured0.bin"])),
    ("gltf/RecursiveNodes/", Refused(&["RecursiveNodes.gltf"])),
    ("gltf/SchemaFailures/", Refused(&["scene"])),
    ("gltf/wrongTypes/", Refused(&[".gltf: "])),
    ("gltf/TestNoRootNode/", Sound),
    ("gltf/BoxWithInfinites", Sound),
    ("gltf/BoxBadNormals", Warned(&["ormal"])),
    ("gltf/issue_3269/", Sound),
];

fn is_sound(scene: &Scene) {
    for mesh in &scene.meshes {
        mesh.check().unwrap();
    }
    let textures = scene.textures.len() as u32;
    for material in scene.materials.clone().iter_mut() {
        assert!(material.textures_mut().all(|t| t.texture < textures));
    }
    World::new(scene).unwrap();
}

fn holds_all(text: &str, pieces: &[&str]) -> bool {
    pieces.iter().all(|piece| text.contains(piece))
}

fn check(name: &str, result: Result<Scene, Error>, expected: &Expected) {
    if let Ok(scene) = &result {
        is_sound(scene);
    }
    match (expected, result) {
        (Refused(pieces), Err(e)) => {
            assert!(holds_all(&e.to_string(), pieces), "{name}: {e}");
            assert!(e.to_string().contains(name.rsplit('/').next().unwrap()), "{name}: {e}");
        }
        (Warned(pieces), Ok(scene)) => {
            assert!(holds_all(&scene.warnings.join("\n"), pieces), "{name}: {:?}", scene.warnings);
        }
        (Sound, _) => {}
        (_, result) => panic!("{name}: {result:?}"),
    }
}

#[test]
fn every_malformed_file_does_what_the_table_says() {
    let Some(models) = models() else { return };
    let folder = models.join("malformed");
    let is_model = |name: &str| !["bin", "png", "jpg"].contains(&name.rsplit('.').next().unwrap_or(""));
    for name in files(&folder).iter().filter(|n| is_model(n)) {
        let path = folder.join(name);
        let Some((_, expected)) = TABLE.iter().find(|(prefix, _)| name.starts_with(prefix)) else {
            panic!("{name} is not in the table");
        };
        let bytes = std::fs::read(&path).unwrap();
        let start = Instant::now();
        let result = load(&bytes, name, &Folder(path.parent().unwrap().to_path_buf()), &Workers::new(2));
        assert!(start.elapsed() < Duration::from_secs(1), "{name} took {:?}", start.elapsed());
        check(name, result, expected);
    }
}

/// The tiny ones of the table again, for checkouts without the shared models.
#[test]
fn tiny_malformed_files_do_what_the_table_says() {
    let off = "-0.5 0.5 0.5\n".repeat(8) + &"4 0 1 3 2\n".repeat(6);
    let vertices = "v 0 0 0\n".repeat(8);
    let cases: [(&str, String, Expected); 10] = [
        ("empty.obj", String::new(), Refused(&["empty file"])),
        ("empty.x", String::new(), Refused(&["empty file"])),
        ("memory.off", format!("OFF\n353535235358 6 0\n{off}"), Refused(&["line 2: 353535235358 vertices"])),
        (
            "invalid.off",
            "OFF\n3 4\n0 0 0\n0 0 0\n0 0 0\n0\n220\n4\n".into(),
            Refused(&["line 2", "edges are required"]),
        ),
        ("range.obj", format!("o 1\n{vertices}f 4 12 2 1\nf 0 1 2"), Refused(&["line 10: index 12"])),
        ("zero.obj", format!("o 1\n{vertices}f 4 2 1\nf 0 1 2"), Refused(&["line 11: vertex index 0"])),
        (
            "bare.obj",
            format!("{vertices}usemtl no\nf\nf 1 2 3"),
            Warned(&["line 9: unknown material", "line 10: a face"]),
        ),
        ("nan.obj", "v nan 0 0\nv 0 1e99 0\nv 0 0 1\nf 1 2 3".into(), Warned(&["2 vertices have coordinates"])),
        ("box.3mf", "PK\u{3}\u{4}".into(), Refused(&["3MF", "readable are glTF (.gltf)"])),
        ("cut.stl", "solid s\nfacet normal 0 0 1\nouter loop\n".into(), Refused(&["line 4: the file ends here"])),
    ];
    for (name, text, expected) in &cases {
        check(name, load(text.as_bytes(), name, &NoFiles, &Workers::single()), expected);
    }
}

/// A header that claims 4 billion triangles, with nothing behind it, in each binary format.
#[test]
fn claimed_counts_allocate_nothing() {
    let mut stl = vec![0u8; 84];
    stl[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let header = |rest: &str| format!("ply\nformat binary_big_endian 1.0\n{rest}end_header\n").into_bytes();
    let vertex = "property float x\nproperty float y\nproperty float z\n";
    let files = [
        ("claim.stl", stl),
        ("vertices.ply", header(&format!("element vertex 4000000000\n{vertex}"))),
        (
            "faces.ply",
            header(&format!(
                "element vertex 0\n{vertex}element face 9000000000000000000\nproperty list uchar int vertex_index\n"
            )),
        ),
        (
            "empty.ply",
            header(&format!("element none 18446744073709551615\nelement vertex 18446744073709551615\n{vertex}")),
        ),
    ];
    for (name, bytes) in files {
        let error = load(&bytes, name, &NoFiles, &Workers::single()).unwrap_err().to_string();
        assert!(error.starts_with(name), "{error}");
    }
}

/// Small valid files of every text and binary format, to be damaged.
fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let obj = "mtllib a.mtl\no x\nv 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\ns 1\nusemtl m\nf 1/1/1 2/2/1 3//1 -1\nl 1 2\np 3\n";
    let off = "COFF\n4 2 0\n0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 0 0 0\n4 0 1 2 3\n3 0 1 2\n";
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 4 5 6\n0 1 0 7 8 9\n3 0 1 2\n";
    let mut binary_stl = vec![b' '; 80];
    binary_stl.extend(2u32.to_le_bytes());
    for _ in 0..2 {
        binary_stl.extend(
            [0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|f| f.to_le_bytes()),
        );
        binary_stl.extend([0; 2]);
    }
    let mut binary_ply = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n".as_bytes().to_vec();
    binary_ply.extend([0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|f| f.to_le_bytes()));
    for _ in 0..2 {
        binary_ply.push(3);
        binary_ply.extend([0u32, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
    }
    let gltf = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;
    vec![
        ("s.obj", obj.into()),
        ("s.off", off.into()),
        ("s.stl", stl.into()),
        ("b.stl", binary_stl),
        ("s.ply", ply.into()),
        ("b.ply", binary_ply),
        ("s.gltf", gltf.into()),
    ]
}

#[test]
fn the_seeds_are_valid() {
    for (name, bytes) in seeds() {
        let scene = load(&bytes, name, &NoFiles, &Workers::single()).unwrap_or_else(|e| panic!("{e}"));
        is_sound(&scene);
        assert!(!scene.meshes[0].triangles.is_empty(), "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300), format in 0usize..7) {
        let (name, _) = seeds()[format];
        type Loader = fn(&[u8], &str) -> Result<Scene, Error>;
        let loaders: [Loader; 6] = [
            |b, n| load(b, n, &NoFiles, &Workers::single()),
            |b, n| vitral_io::obj::load(b, n, &NoFiles, &Workers::single()),
            |b, n| vitral_io::stl::load(b, n, &Workers::single()),
            |b, n| vitral_io::ply::load(b, n, &Workers::single()),
            |b, n| vitral_io::off::load(b, n, &Workers::single()),
            |b, n| vitral_io::gltf::load(b, n, &NoFiles, &Workers::single()),
        ];
        for loader in loaders {
            if let Ok(scene) = loader(&bytes, name) {
                is_sound(&scene);
            }
        }
    }

    #[test]
    fn damaged_files_never_panic(
        format in 0usize..7,
        edits in proptest::collection::vec((any::<prop::sample::Index>(), 0u8..5, any::<u8>()), 1..6),
    ) {
        let (name, mut bytes) = seeds().swap_remove(format);
        for (index, kind, value) in edits {
            let at = index.index(bytes.len());
            match kind {
                0 => bytes[at] = value,
                1 => bytes.insert(at, value),
                2 => bytes.truncate(at.max(1)),
                3 => bytes[at] = b"0123456789-/. \n"[value as usize % 15],
                _ => {
                    // Repeat a stretch: longer lists, more lines.
                    let end = (at + value as usize).min(bytes.len());
                    let copy = bytes[at..end].to_vec();
                    bytes.splice(at..at, copy);
                }
            }
        }
        if let Ok(scene) = load(&bytes, name, &NoFiles, &Workers::single()) {
            is_sound(&scene);
        }
    }
}
