//! Models that were read last, for a process that does many jobs, and the files that a job read.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use vitral::{Error, FolderResolver, LoadOptions, ResolveError, Resolver, Scene, Workers};

/// Models that are kept.
const MOST_KEPT: usize = 4;

/// What is kept; nothing unless somebody wants it.
static KEPT: Mutex<Option<Kept>> = Mutex::new(None);

#[derive(Default)]
struct Kept {
    /// The models, the one that was asked for last in front.
    models: Vec<Model>,
    /// The files that were read for the scene that was asked for last.
    files: Vec<String>,
}

struct Model {
    key: String,
    scene: Scene,
    files: Vec<String>,
}

/// Keeps models from now on.
pub(crate) fn keep() {
    *KEPT.lock().expect("no thread panics while it keeps a model") = Some(Kept::default());
}

/// The files that the last scene was read from.
pub(crate) fn files() -> Vec<String> {
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
    kept.files.extend(kept.models[0].files.iter().cloned());
    Ok(kept.models[0].scene.clone())
}

/// Reads a model, and notes which files that takes.
fn read(path: &Path, key: String, options: &LoadOptions, workers: &Workers) -> Result<Model, Error> {
    let name = path.to_string_lossy().into_owned();
    if name.starts_with("builtin:") {
        let scene = vitral::load_on(path, options, workers)?;
        return Ok(Model { key, scene, files: Vec::new() });
    }
    let bytes = vitral::read(path, options.max_file_bytes)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let files = Arc::new(Mutex::new(vec![name.clone()]));
    let inner = FolderResolver::new(&folder, options.allow_external, options.max_file_bytes);
    let noting = Noting { inner, folder, files: Arc::clone(&files) };
    let scene = vitral::load_bytes_with(&bytes, &name, &noting, options)?;
    let files = files.lock().expect("no thread panics while it notes a file").clone();
    Ok(Model { key, scene, files })
}

/// A resolver that notes what it was asked for.
struct Noting {
    inner: FolderResolver,
    folder: PathBuf,
    files: Arc<Mutex<Vec<String>>>,
}

impl Resolver for Noting {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        let bytes = self.inner.read(path)?;
        let place = self.folder.join(path).to_string_lossy().into_owned();
        self.files.lock().expect("no thread panics while it notes a file").push(place);
        Ok(bytes)
    }
}
