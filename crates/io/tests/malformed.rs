//! Bad files: each is refused with its place, or read with a warning; never a panic, a hang or a
//! large allocation.

use crate::common::{Folder, files, models};
use proptest::prelude::*;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use vitral_exec::Workers;
use vitral_io::{Error, NoFiles, load};
use vitral_scene::Scene;
use vitral_testkit::fixture::repository;
use vitral_testkit::fuzz::{self, Beside, Target, assert_sound};

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
    (
        "assimp-invalid/malformed.obj",
        Warned(&["line 23: index 12, the file has 8 vertices; 2 faces with"]),
    ),
    (
        "assimp-invalid/malformed2.obj",
        Warned(&["line 22: unknown material", "line 23: a face with 0 corners"]),
    ),
    ("assimp-invalid/readme.txt", Refused(&["is not read"])),
    ("off/invalid.off", Refused(&["line 8", "index 20, the file has 3 vertices"])),
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

fn holds_all(text: &str, pieces: &[&str]) -> bool {
    pieces.iter().all(|piece| text.contains(piece))
}

fn check(name: &str, result: Result<Scene, Error>, expected: &Expected) {
    if let Ok(scene) = &result {
        assert_sound(scene);
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
    let is_model =
        |name: &str| !["bin", "png", "jpg"].contains(&name.rsplit('.').next().unwrap_or(""));
    for name in files(&folder).iter().filter(|n| is_model(n)) {
        let path = folder.join(name);
        let Some((_, expected)) = TABLE.iter().find(|(prefix, _)| name.starts_with(prefix)) else {
            panic!("{name} is not in the table");
        };
        let bytes = std::fs::read(&path).unwrap();
        let start = Instant::now();
        let result =
            load(&bytes, name, &Folder(path.parent().unwrap().to_path_buf()), &Workers::new(2));
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
        (
            "memory.off",
            format!("OFF\n353535235358 6 0\n{off}"),
            Refused(&["line 2: 353535235358 vertices"]),
        ),
        (
            "invalid.off",
            "OFF\n3 4\n0 0 0\n0 0 0\n0 0 0\n0\n220\n4\n".into(),
            Refused(&["line 8", "index 4, the file has 3 vertices"]),
        ),
        (
            "range.obj",
            format!("o 1\n{vertices}f 4 12 2 1\nf 0 1 2"),
            Refused(&["line 10: index 12"]),
        ),
        (
            "zero.obj",
            format!("o 1\n{vertices}f 4 2 1\nf 0 1 2"),
            Warned(&["line 11: vertex index 0"]),
        ),
        (
            "bare.obj",
            format!("{vertices}usemtl no\nf\nf 1 2 3"),
            Warned(&["line 9: unknown material", "line 10: a face"]),
        ),
        (
            "nan.obj",
            "v nan 0 0\nv 0 1e99 0\nv 0 0 1\nf 1 2 3".into(),
            Warned(&["2 vertices have coordinates"]),
        ),
        ("box.3mf", "PK\u{3}\u{4}".into(), Refused(&["3MF", "readable are glTF (.gltf)"])),
        (
            "cut.stl",
            "solid s\nfacet normal 0 0 1\nouter loop\n".into(),
            Refused(&["line 4: the file ends here"]),
        ),
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
    let header =
        |rest: &str| format!("ply\nformat binary_big_endian 1.0\n{rest}end_header\n").into_bytes();
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
            header(&format!(
                "element none 18446744073709551615\nelement vertex 18446744073709551615\n{vertex}"
            )),
        ),
    ];
    for (name, bytes) in files {
        let error = load(&bytes, name, &NoFiles, &Workers::single()).unwrap_err().to_string();
        assert!(error.starts_with(name), "{error}");
    }
}

/// Valid files of the fuzzer's corpus, to be damaged: the target and the file.
const SEEDS: [(&str, &str); 11] = [
    ("gltf", "triangle.gltf"),
    ("gltf", "scene.glb"),
    ("obj", "square.obj"),
    ("off", "square.off"),
    ("ply", "ascii.ply"),
    ("ply", "little.ply"),
    ("scene_json", "scene.json"),
    ("stl", "ascii.stl"),
    ("stl", "binary.stl"),
    ("image", "palette.png"),
    ("mtl", "materials.mtl"),
];
/// How many of them are models.
const MODELS: usize = 9;

fn seed(index: usize) -> (Target, PathBuf, Vec<u8>) {
    let (name, file) = SEEDS[index];
    let path = repository().join("fuzz/corpus").join(name).join(file);
    let bytes = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    (fuzz::target(name), path, bytes)
}

#[test]
fn the_seeds_are_valid() {
    for index in 0..MODELS {
        let (_, path, bytes) = seed(index);
        let scene = load(
            &bytes,
            &path.to_string_lossy(),
            &Beside { library: b"newmtl m" },
            &Workers::single(),
        )
        .unwrap_or_else(|e| panic!("{e}"));
        assert_sound(&scene);
        assert!(!scene.meshes[0].triangles.is_empty(), "{}", path.display());
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    }
}

/// Every fuzz target, over every file that its fuzzer starts from.
#[test]
fn the_fuzzers_corpus_is_read_without_a_panic() {
    for target in fuzz::TARGETS {
        let corpus = target.corpus();
        assert!(corpus.len() >= 2, "{} has no corpus", target.name);
        for file in corpus {
            println!("{}", file.display());
            (target.run)(&std::fs::read(&file).unwrap());
        }
    }
}

/// The fuzz crate is no member of the workspace, so nothing else would miss a target there.
#[test]
fn the_fuzz_crate_has_every_target() {
    let manifest = std::fs::read_to_string(repository().join("fuzz/Cargo.toml")).unwrap();
    assert_eq!(manifest.matches("[[bin]]").count(), fuzz::TARGETS.len());
    for Target { name, .. } in fuzz::TARGETS {
        assert!(
            manifest.contains(&format!("name = \"{name}\"\npath = \"fuzz_targets/{name}.rs\"")),
            "{name}"
        );
        let source =
            std::fs::read_to_string(repository().join(format!("fuzz/fuzz_targets/{name}.rs")))
                .unwrap();
        assert!(source.contains(&format!("vitral_testkit::fuzz::{name}(bytes)")), "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300), format in 0..MODELS) {
        let (_, path, _) = seed(format);
        if let Ok(scene) = load(&bytes, &path.to_string_lossy(), &NoFiles, &Workers::single()) {
            assert_sound(&scene);
        }
        for target in fuzz::TARGETS {
            (target.run)(&bytes);
        }
    }

    #[test]
    fn damaged_files_never_panic(
        format in 0..SEEDS.len(),
        edits in proptest::collection::vec((any::<prop::sample::Index>(), 0u8..5, any::<u8>()), 1..6),
    ) {
        let (target, path, mut bytes) = seed(format);
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
        (target.run)(&bytes);
        if let Ok(scene) = load(&bytes, &path.to_string_lossy(), &NoFiles, &Workers::single()) {
            assert_sound(&scene);
        }
    }
}
