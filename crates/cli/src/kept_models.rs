//! Models that were read last, for a process that does many jobs, and the files that a job read.

use crate::hashes::hash_of_bytes;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use vitral::{Error, LoadOptions, ReadFile, Scene, Workers};

/// Models that are kept.
const MOST_KEPT: usize = 4;

/// The cached models; `None` unless a caller turns the cache on.
static KEPT: Mutex<Option<Kept>> = Mutex::new(None);

#[derive(Default)]
struct Kept {
    /// The models, the one that was asked for last in front.
    models: Vec<Model>,
    /// The files that the scene at hand was read from, with the hashes of their contents.
    files: BTreeMap<String, String>,
}

struct Model {
    key: String,
    scene: Scene,
    files: BTreeMap<String, String>,
}

/// Keeps models from now on.
pub(crate) fn keep() {
    *KEPT.lock().expect("no thread panics while it keeps a model") = Some(Kept::default());
}

/// The files that the last scene was read from, with the hashes of their contents.
pub(crate) fn files() -> BTreeMap<String, String> {
    let kept = KEPT.lock().expect("no thread panics while it keeps a model");
    kept.as_ref().map(|kept| kept.files.clone()).unwrap_or_default()
}

/// A new scene begins.
pub(crate) fn begin() {
    if let Some(kept) = KEPT.lock().expect("no thread panics while it keeps a model").as_mut() {
        kept.files.clear();
    }
}

/// A model of the scene: a kept one, where it can be.
pub(crate) fn load(name: &Path, options: &LoadOptions, workers: &Workers) -> Result<Scene, Error> {
    let mut kept = KEPT.lock().expect("no thread panics while it keeps a model");
    let Some(kept) = kept.as_mut() else { return vitral::load_on(name, options, workers) };
    let key = format!("{name:?} {}", serde_json::to_string(options).unwrap_or_default());
    match kept.models.iter().position(|known| known.key == key) {
        Some(place) => kept.models[..=place].rotate_right(1),
        None => {
            kept.models.truncate(MOST_KEPT - 1);
            kept.models.insert(0, read(name, key, options, workers)?);
        }
    }
    kept.files.extend(kept.models[0].files.clone());
    Ok(kept.models[0].scene.clone())
}

/// Reads a model, and notes which files that takes.
fn read(
    name: &Path,
    key: String,
    options: &LoadOptions,
    workers: &Workers,
) -> Result<Model, Error> {
    let files = Mutex::new(BTreeMap::new());
    let scene = vitral::load_telling(name, options, workers, &|file: ReadFile<'_>| {
        let path = file.path.to_string_lossy().into_owned();
        files
            .lock()
            .expect("no thread panics while it notes a file")
            .insert(path, hash_of_bytes(file.bytes));
    })?;
    Ok(Model {
        key,
        scene,
        files: files.into_inner().expect("no thread panicked while it noted a file"),
    })
}
