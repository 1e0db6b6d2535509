//! Floor 3: model files in, pictures out.
//!
//! Readers take bytes and a [`Resolver`] for the files that a model names (buffers, materials, textures); nothing here
//! touches the file system or the clock, so the same code runs in a browser.
//!
//! Each format is a feature of its own name, on by default: `obj`, `stl`, `ply`, `off`, `gltf`; `images` reads textures of
//! other formats than PNG and writes JPEG. A file of a format that is left out is refused with the name of its feature.
#![forbid(unsafe_code)]
#![cfg_attr(
    not(all(feature = "obj", feature = "stl", feature = "ply", feature = "off", feature = "gltf")),
    allow(dead_code, reason = "readers share helpers, and not all are used where some readers are left out")
)]

mod colored;
pub mod encode;
mod error;
mod format;
#[cfg(feature = "gltf")]
pub mod gltf;
pub mod image;
mod json;
#[cfg(feature = "obj")]
mod mtl;
#[cfg(feature = "obj")]
pub mod obj;
#[cfg(feature = "off")]
pub mod off;
#[cfg(feature = "ply")]
pub mod ply;
mod polygons;
mod resolve;
pub mod scene_json;
#[cfg(feature = "stl")]
pub mod stl;
mod text;
#[cfg(any(feature = "obj", feature = "ply"))]
mod textures;
pub mod triangulate;
mod uri;
#[cfg(any(feature = "obj", feature = "off", feature = "ply", feature = "stl"))]
mod warnings;
#[cfg(feature = "stl")]
mod weld;

pub use error::{Error, Place};
pub use format::{Format, FormatKind, FormatRow, formats};
pub use resolve::{NoFiles, ResolveError, Resolver};

use vitral_exec::Workers;
use vitral_scene::{Axis, Mesh, Scene, normals};

/// Reads a model or scene file of any readable [`Format`], known by its content first, by its extension second.
///
/// `file` is its name, for messages and for the extension; `-` for what came in by standard input. `resolver` gives the
/// files that it names. What is odd but readable is told in [`Scene::warnings`]. The scene does not depend on the number
/// of `workers`.
///
/// # Errors
/// [`Error::Malformed`] says where the file breaks the rules of its format, [`Error::Missing`] names a file that it
/// cannot do without, [`Error::Unsupported`] a format or feature that is not read.
pub fn load(bytes: &[u8], file: &str, resolver: &dyn Resolver, workers: &Workers) -> Result<Scene, Error> {
    let format = Format::detect(bytes, file)?;
    let mut scene = match format {
        #[cfg(feature = "gltf")]
        Format::Gltf | Format::Glb => gltf::load(bytes, file, resolver, workers),
        #[cfg(feature = "obj")]
        Format::Obj => obj::load(bytes, file, resolver, workers),
        #[cfg(feature = "stl")]
        Format::Stl => stl::load(bytes, file, workers),
        #[cfg(feature = "ply")]
        Format::Ply => ply::load(bytes, file, resolver, workers),
        #[cfg(feature = "off")]
        Format::Off => off::load(bytes, file, workers),
        Format::SceneJson => scene_json::load(bytes, file, resolver, workers),
        #[cfg(not(all(feature = "gltf", feature = "obj", feature = "stl", feature = "ply", feature = "off")))]
        _ => Err(format.left_out(file)),
    }?;
    scene.meshes.iter_mut().for_each(|mesh| normals::make_measurable(mesh, workers));
    // A scene file says the rest itself.
    if format == Format::SceneJson {
        return Ok(scene);
    }
    scene.ups = vec![if format == Format::Stl { Axis::PlusZ } else { Axis::PlusY }];
    // The default material of glTF is opaque, whatever the alpha of `COLOR_0`.
    let alpha_counts = !matches!(format, Format::Gltf | Format::Glb);
    colored::give_materials(&mut scene, alpha_counts);
    Ok(scene)
}

/// The name of a file without folder and extension, for meshes that have no name of their own.
pub(crate) fn stem(file: &str) -> String {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    name.rsplit_once('.').map_or(name, |(stem, _)| if stem.is_empty() { name } else { stem }).to_owned()
}

/// Puts a mesh into the scene, and tells what a renderer would stumble over: nothing to show, coordinates that are not
/// finite (they are kept; whoever draws drops the primitives that touch them).
pub(crate) fn finish(mesh: Mesh, mut scene: Scene, file: &str) -> Scene {
    let broken = mesh.positions.iter().filter(|p| !p.iter().all(|c| c.is_finite())).count();
    if broken > 0 {
        scene
            .warnings
            .push(format!("{file}: {broken} vertices have coordinates that are not finite; what they touch vanishes"));
    }
    if mesh.triangles.is_empty() && mesh.lines.is_empty() && mesh.points.is_empty() {
        scene.warnings.push(nothing_to_show(file));
        return scene;
    }
    scene.add_mesh(mesh, vitral_math::DMat4::IDENTITY);
    scene
}

/// The warning of a file without triangles, lines and points.
pub(crate) fn nothing_to_show(file: &str) -> String {
    format!("{file}: the file holds nothing to show")
}
