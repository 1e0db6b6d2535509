//! Models that a scene file names: other files, read by their own readers, and built-in scenes.
//!
//! A file is read once, however often it is named. Paths are relative to the folder of the file
//! that names them. A scene file may name scene files, 8 deep, but none that is being read already.

use crate::{Error, Format, Place, ResolveError, Resolver, models};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;
use vitral_exec::Workers;
use vitral_scene::Scene;
use vitral_scene::builtin::{self, BuiltinError};

/// Scene files inside each other.
const MAX_DEPTH: usize = 8;

/// Models that have been read, by their path from the root file's folder.
type Known = RefCell<BTreeMap<String, Arc<Scene>>>;

/// Where a scene file stands: its folder, and the files that led to it.
pub(super) struct Origin<'a> {
    resolver: &'a dyn Resolver,
    pub(super) workers: &'a Workers,
    known: Rc<Known>,
    /// Paths of the scene files that are being read, the root first.
    chain: Vec<String>,
}

/// What a model file turned out to be.
pub(super) enum Reference<'a> {
    /// A scene: that of a model, or of a scene file that was read at an earlier mention.
    Scene(Arc<Scene>),
    /// A scene file that is still to be read.
    SceneFile {
        bytes: Vec<u8>,
        /// From the root file's folder.
        path: String,
        origin: Origin<'a>,
    },
}

impl<'a> Origin<'a> {
    /// The file that the user named.
    pub(super) fn root(file: &str, resolver: &'a dyn Resolver, workers: &'a Workers) -> Self {
        let name = file.rsplit(['/', '\\']).next().unwrap_or(file).to_owned();
        Self { resolver, workers, known: Rc::default(), chain: vec![name] }
    }

    /// The path from the root file's folder to what the current file calls `path`.
    pub(super) fn locate(&self, path: &str) -> String {
        let here = self.chain.last().map_or("", String::as_str);
        join(here.rfind('/').map_or("", |slash| &here[..slash]), path)
    }

    /// The bytes of a file beside the current one.
    pub(super) fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        self.resolver.read(&self.locate(path))
    }

    /// The model file `path`, which `file` names at `place`: its scene, or the scene file in it,
    /// which is still to be read.
    pub(super) fn model(
        &self,
        path: &str,
        file: &str,
        place: &Place,
    ) -> Result<Reference<'a>, Error> {
        let full = self.locate(path);

        // Share a scene that is loaded already.
        if let Some(scene) = self.known.borrow().get(&full) {
            return Ok(Reference::Scene(Arc::clone(scene)));
        }

        // Refuse a file that refers back to itself, and one that cannot be read.
        let missing = |why: String| Error::Missing {
            file: format!("{file}: {}", place.to_string().trim_end_matches(": ")),
            needed: path.to_owned(),
            why,
        };
        if self.chain.contains(&full) {
            return Err(missing("it refers back to itself".to_owned()));
        }
        let bytes = self.resolver.read(&full).map_err(|e| missing(e.to_string()))?;

        // Load the model, whose own files are found from its folder.
        let folder = full.rfind('/').map_or("", |slash| &full[..slash]);
        let below = Below { inner: self.resolver, folder };
        match models::load(
            Format::detect(&bytes, &full)?,
            &bytes,
            &full,
            &below,
            self.workers,
            None,
        ) {
            Some(scene) => Ok(Reference::Scene(self.keep(full, scene?))),
            None if self.chain.len() >= MAX_DEPTH => {
                Err(missing(format!("scene files are read {MAX_DEPTH} deep")))
            }
            None => {
                let chain = self.chain.iter().chain([&full]).cloned().collect();
                let (resolver, workers, known) =
                    (self.resolver, self.workers, Rc::clone(&self.known));
                Ok(Reference::SceneFile {
                    bytes,
                    origin: Self { resolver, workers, known, chain },
                    path: full,
                })
            }
        }
    }

    /// Keeps the scene of the file at `path` for all that name it.
    pub(super) fn keep(&self, path: String, scene: Scene) -> Arc<Scene> {
        let scene = Arc::new(scene);
        self.known.borrow_mut().insert(path, Arc::clone(&scene));
        scene
    }

    /// A built-in scene.
    pub(super) fn builtin(
        &self,
        name: &str,
        file: &str,
        place: Place,
    ) -> Result<Arc<Scene>, Error> {
        let key = format!("builtin:{name}");
        if let Some(scene) = self.known.borrow().get(&key) {
            return Ok(Arc::clone(scene));
        }
        let names = || builtin::names().iter().map(|n| n.0).collect::<Vec<_>>().join(", ");
        let scene = builtin::parse(name).map_err(|error| {
            let what = match error {
                BuiltinError::Name => format!("no built-in scene `{name}`; there are {}", names()),
                BuiltinError::Parameter { what, hint } => format!("{what}; {hint}"),
            };
            Error::malformed(file, place, what)
        })?;
        Ok(self.keep(key, scene))
    }
}

/// The files beside a model in another folder.
struct Below<'a> {
    inner: &'a dyn Resolver,
    folder: &'a str,
}

impl Resolver for Below<'_> {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        self.inner.read(&join(self.folder, path))
    }

    fn in_other_case(&self, path: &str) -> Option<String> {
        let found = self.inner.in_other_case(&join(self.folder, path))?;
        let below = if self.folder.is_empty() {
            Some(found.as_str())
        } else {
            found.strip_prefix(self.folder)
        };
        Some(below?.trim_start_matches('/').to_owned())
    }
}

/// `path` as seen from where `folder` is seen from, without `.` and without `..` behind a name.
/// Absolute paths stay as they are; whether they may be read is the resolver's decision.
fn join(folder: &str, path: &str) -> String {
    if path.starts_with(['/', '\\']) || path.get(1..2) == Some(":") {
        return path.to_owned();
    }
    let mut parts: Vec<&str> = Vec::new();
    for part in folder.split('/').chain(path.split('/')) {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|&last| last != "..") => {
                parts.pop();
            }
            _ => parts.push(part),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_joined() {
        for (folder, path, joined) in [
            ("", "a.obj", "a.obj"),
            ("parts", "./a.obj", "parts/a.obj"),
            ("parts/x", "../a.obj", "parts/a.obj"),
            ("parts", "../../a.obj", "../a.obj"),
            ("..", "../a.obj", "../../a.obj"),
            ("parts", "/etc/a.obj", "/etc/a.obj"),
            ("parts", "C:/a.obj", "C:/a.obj"),
        ] {
            assert_eq!(join(folder, path), joined, "{folder} + {path}");
        }
    }
}
