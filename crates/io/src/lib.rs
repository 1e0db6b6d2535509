//! Floor 3: model files in, pictures out.
//!
//! Readers take bytes and a [`Resolver`] for the files that a model names (buffers, materials,
//! textures); nothing here touches the file system or the clock, so the same code runs in a
//! browser.
//!
//! Each format is a feature of its own name, on by default: `obj`, `stl`, `ply`, `off`, `gltf`;
//! `images` reads textures of other formats than PNG and writes JPEG. A file of a format that is
//! left out is refused with the name of its feature.
#![forbid(unsafe_code)]
#![cfg_attr(
    not(all(
        feature = "obj",
        feature = "stl",
        feature = "ply",
        feature = "off",
        feature = "gltf"
    )),
    allow(
        dead_code,
        unused_variables,
        reason = "readers share helpers, and not all are used where some readers are left out"
    )
)]

#[cfg(any(feature = "obj", feature = "off", feature = "ply"))]
mod color_range;
mod colored;
mod detect;
pub mod encode;
mod error;
#[cfg(any(feature = "obj", feature = "off", feature = "ply", feature = "stl"))]
mod far;
mod file_name;
mod format;
#[cfg(feature = "gltf")]
pub mod gltf;
pub mod image;
mod json_message;
mod mesh_scene;
mod models;
mod moment;
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
pub use moment::Moment;
pub use resolve::{NoFiles, ResolveError, Resolver};

use vitral_exec::Workers;
use vitral_scene::{Scene, normals};

/// Reads a model or scene file of any readable [`Format`], known by its content first, by its
/// extension second.
///
/// `file` is its name, for messages and for the extension; `-` for what came in by standard input.
/// `resolver` gives the files that it names. Odd but readable parts are reported in
/// [`Scene::warnings`]. The scene does not depend on the number of `workers`.
///
/// # Errors
/// [`Error::Malformed`] says where the file breaks the rules of its format, [`Error::Missing`]
/// names a file that it cannot do without, [`Error::Unsupported`] a format or feature that is not
/// read.
pub fn load(
    bytes: &[u8],
    file: &str,
    resolver: &dyn Resolver,
    workers: &Workers,
) -> Result<Scene, Error> {
    load_at(bytes, file, resolver, workers, None)
}

/// [`load`] at a moment of an animation, which glTF files may have.
///
/// # Errors
/// As [`load`]; [`Error::Absent`] for an animation that the file does not have.
pub fn load_at(
    bytes: &[u8],
    file: &str,
    resolver: &dyn Resolver,
    workers: &Workers,
    moment: Option<&Moment>,
) -> Result<Scene, Error> {
    let format = Format::detect(bytes, file)?;
    if let (Some(moment), false) = (moment, matches!(format, Format::Gltf | Format::Glb)) {
        let what = format!("{file}: no animation `{}`", moment.animation);
        return Err(Error::Absent { what, hint: "glTF files have animations".to_owned() });
    }
    if let Some(model) = models::load(format, bytes, file, resolver, workers, moment) {
        return model;
    }
    let mut scene = scene_json::load(bytes, file, resolver, workers)?;
    scene.meshes.iter_mut().for_each(|mesh| normals::make_measurable(mesh, workers));
    Ok(scene)
}
