//! What the fuzzer feeds: for each reader, for the OpenGL state machine and for drawings, a
//! function that takes any bytes and panics at what must not be.
//!
//! A reader may refuse; what it gives instead must be [`assert_sound`]. The targets in
//! `fuzz/fuzz_targets` call these functions, and so does a plain test
//! (`crates/io/tests/malformed.rs`) with every file of `fuzz/corpus`. Files beside the one that is
//! read exist, see [`Beside`], so that the fuzzer reaches what reads them.

use crate::fixture::{files_below, repository};
pub use crate::fuzz_draw::draw;
pub use crate::fuzz_gl::gl;
use std::path::PathBuf;
use vitral_exec::Workers;
use vitral_frame::Plane;
use vitral_io::encode::{self, PngOptions};
use vitral_io::{Error, NoFiles, ResolveError, Resolver, gltf, off, ply, scene_json, stl};
use vitral_scene::{Scene, World};

/// Something to be fuzzed.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Of the fuzz target and of its folder in `fuzz/corpus`.
    pub name: &'static str,
    /// Reads the bytes; panics if that shows a defect.
    pub run: fn(&[u8]),
}

/// Every target.
pub const TARGETS: [Target; 10] = [
    Target { name: "draw", run: draw },
    Target { name: "gl", run: gl },
    Target { name: "gltf", run: gltf },
    Target { name: "image", run: image },
    Target { name: "mtl", run: mtl },
    Target { name: "obj", run: obj },
    Target { name: "off", run: off },
    Target { name: "ply", run: ply },
    Target { name: "scene_json", run: scene_json },
    Target { name: "stl", run: stl },
];

/// The target of that name.
///
/// # Panics
/// If there is none.
pub fn target(name: &str) -> Target {
    TARGETS
        .into_iter()
        .find(|t| t.name == name)
        .unwrap_or_else(|| panic!("no fuzz target is called {name}"))
}

impl Target {
    /// The files that the fuzzer starts from.
    pub fn corpus(&self) -> Vec<PathBuf> {
        files_below(&repository().join("fuzz/corpus").join(self.name))
    }
}

/// glTF, also as GLB.
pub fn gltf(bytes: &[u8]) {
    check(gltf::load(bytes, "a.gltf", &Beside::default(), &Workers::single()));
}

/// PNG, JPEG, PPM and PGM.
pub fn image(bytes: &[u8]) {
    if let Ok(picture) = encode::decode_picture(bytes, "a") {
        assert!(!picture.data().is_empty(), "a picture without pixels");
    }
}

/// The material library of an OBJ file.
pub fn mtl(bytes: &[u8]) {
    let beside = Beside { library: bytes };
    check(vitral_io::obj::load(USES_LIBRARY.as_bytes(), "a.obj", &beside, &Workers::single()));
}

/// OBJ.
pub fn obj(bytes: &[u8]) {
    let beside = Beside { library: b"newmtl m\nKd 1 0 0\nmap_Kd a.png\n" };
    check(vitral_io::obj::load(bytes, "a.obj", &beside, &Workers::single()));
}

/// OFF.
pub fn off(bytes: &[u8]) {
    check(off::load(bytes, "a.off", &Workers::single()));
}

/// PLY.
pub fn ply(bytes: &[u8]) {
    check(ply::load(bytes, "a.ply", &NoFiles, &Workers::single()));
}

/// Scene files; what is read can be written and read again.
pub fn scene_json(bytes: &[u8]) {
    let read =
        |bytes: &[u8]| scene_json::load(bytes, "a.json", &Beside::default(), &Workers::single());
    let scene = read(bytes);
    if let Ok(text) =
        scene.as_ref().map_err(|_| ()).and_then(|scene| scene_json::write(scene).map_err(|_| ()))
    {
        assert!(read(text.as_bytes()).is_ok(), "what was written is not read");
    }
    check(scene);
}

/// STL.
pub fn stl(bytes: &[u8]) {
    check(stl::load(bytes, "a.stl", &Workers::single()));
}

fn check(result: Result<Scene, Error>) {
    if let Ok(scene) = result {
        assert_sound(&scene);
    }
}

/// Panics unless everything in the scene refers to what is there.
pub fn assert_sound(scene: &Scene) {
    for mesh in &scene.meshes {
        mesh.check().unwrap_or_else(|e| panic!("{e}"));
    }
    let textures = scene.textures.len() as u32;
    for material in scene.materials.clone().iter_mut() {
        assert!(material.textures_mut().all(|t| t.texture < textures), "a texture beyond the last");
    }
    World::new(scene).unwrap_or_else(|e| panic!("{e}"));
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const USES_LIBRARY: &str =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";

/// The files beside the one that is read: every material library holds `library`, every OBJ file a
/// triangle, every picture one pixel, every buffer 64 zeros. Others do not exist.
#[derive(Clone, Copy, Debug, Default)]
pub struct Beside<'a> {
    /// Content of all `.mtl` files.
    pub library: &'a [u8],
}

impl Resolver for Beside<'_> {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        match path.rsplit_once('.').map(|(_, extension)| extension) {
            Some("mtl") => Ok(self.library.to_vec()),
            Some("obj") => Ok(TRIANGLE.into()),
            Some("bin") => Ok(vec![0; 64]),
            Some("png") => encode::png(&Plane::filled(1, 1, [9, 9, 9, 255]), PngOptions::default())
                .map_err(|e| ResolveError::Other(e.to_string())),
            _ => Err(ResolveError::NotFound),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_beside_are_found_by_extension() {
        let beside = Beside { library: b"newmtl m" };
        assert_eq!(beside.read("x/y.mtl").unwrap(), b"newmtl m");
        assert!(beside.read("a.png").unwrap().starts_with(b"\x89PNG"));
        assert_eq!(beside.read("a.txt"), Err(ResolveError::NotFound));
    }

    #[test]
    #[should_panic(expected = "no fuzz target")]
    fn targets_have_names() {
        assert_eq!(target("obj").name, "obj");
        target("fbx");
    }
}
