//! The folder of shared models, a resolver over it, and small files made here.

pub(crate) mod documents;

use std::path::{Path, PathBuf};
use vitral_io::{ResolveError, Resolver};

/// Files below a folder.
pub(crate) struct Folder(pub(crate) PathBuf);

impl Resolver for Folder {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        if Path::new(path).is_absolute() || path.split('/').any(|part| part == "..") {
            return Err(ResolveError::Outside);
        }
        std::fs::read(self.0.join(path)).map_err(|_| ResolveError::NotFound)
    }

    fn in_other_case(&self, path: &str) -> Option<String> {
        let names = std::fs::read_dir(&self.0)
            .ok()?
            .map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.filter(|name| name != path && name.eq_ignore_ascii_case(path)).min()
    }
}

/// The shared models, or `None` with a printed line where they are absent.
pub(crate) fn models() -> Option<PathBuf> {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/models"));
    if path.is_dir() {
        return Some(path);
    }
    println!("skipped: the shared models are absent ({})", path.display());
    None
}

/// All files below `folder`, sorted, as paths relative to it.
pub(crate) fn files(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    let mut stack = vec![folder.to_path_buf()];
    while let Some(at) = stack.pop() {
        for entry in std::fs::read_dir(&at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                stack.push(path);
            } else {
                found.push(path.strip_prefix(folder).unwrap().to_string_lossy().replace('\\', "/"));
            }
        }
    }
    found.sort();
    found
}
