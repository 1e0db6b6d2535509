//! Floor 3: model files in, pictures out.
//!
//! Readers take bytes and a [`Resolver`] for the files that a model names (buffers, materials, textures); nothing here
//! touches the file system or the clock, so the same code runs in a browser.
#![forbid(unsafe_code)]

mod colored;
mod detect;
pub mod encode;
mod error;
mod file_name;
mod format;
pub mod gltf;
pub mod image;
mod json_message;
mod mesh_scene;
mod models;
mod mtl;
pub mod obj;
pub mod off;
pub mod ply;
mod polygons;
mod resolve;
pub mod scene_json;
pub mod stl;
mod text;
mod textures;
pub mod triangulate;
mod uri;
mod warnings;
mod weld;

pub use error::{Error, Place};
pub use format::{Format, FormatKind, FormatRow, formats};
pub use resolve::{NoFiles, ResolveError, Resolver};

use vitral_exec::Workers;
use vitral_scene::{Scene, normals};

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
    if let Some(model) = models::load(format, bytes, file, resolver, workers) {
        return model;
    }
    let mut scene = scene_json::load(bytes, file, resolver, workers)?;
    scene.meshes.iter_mut().for_each(|mesh| normals::make_measurable(mesh, workers));
    Ok(scene)
}
