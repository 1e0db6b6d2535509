//! The scene file: everything that a [`Scene`] holds, as JSON that people and programs can write.
//!
//! `docs/scene-format.md` describes the form. `form.rs` has its types, `mesh.rs` the meshes,
//! `read.rs` makes a scene of them, `reference.rs` brings in other files and built-in scenes,
//! `write.rs` writes a scene down. A written scene is read back as an equal one.
//!
//! Limits: 8 files deep, 2²⁰ nodes, meshes, materials, textures or cameras after all references are
//! followed.
//! Cost: linear in the text and in the scene that comes out.

mod form;
mod mesh;
mod read;
mod reference;
mod write;

pub use form::VERSION;
pub use write::write;

use crate::{Error, Resolver};
use reference::Origin;
use vitral_exec::Workers;
use vitral_scene::Scene;

/// Reads a scene file. `file` is its name, for messages; `resolver` gives the models and images
/// that it names, relative to its folder.
///
/// # Errors
/// [`Error::Malformed`] with a line for what breaks the form and with a JSON path for what does not
/// fit together, [`Error::Missing`] for a model that cannot be had or refers back to itself,
/// [`Error::Unsupported`] for another version. A missing image is a warning.
pub fn load(
    bytes: &[u8],
    file: &str,
    resolver: &dyn Resolver,
    workers: &Workers,
) -> Result<Scene, Error> {
    read::read(bytes, file, &Origin::root(file, resolver, workers))
}
