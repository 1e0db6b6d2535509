//! The user's own files, in memory. A model among them is called `file:NAME#HASH`, so that a link
//! names what it was made with.

use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use vitral::{
    Error, Format, LoadOptions, ResolveError, Resolver, Scene, load_bytes_with, load_with,
};

/// How many digits of a hash name a file.
const HASH_DIGITS: usize = 12;

/// Files by their names.
#[derive(Debug, Default)]
pub(crate) struct Files {
    files: BTreeMap<String, File>,
}

#[derive(Debug)]
struct File {
    bytes: Vec<u8>,
    hash: String,
}

impl Files {
    /// Keeps a file; one of the same name goes.
    pub(crate) fn keep(&mut self, name: &str, bytes: Vec<u8>) {
        let hash = hash(&bytes);
        self.files.insert(name.to_owned(), File { bytes, hash });
    }

    /// Each file: its name, its hash, whether it is a model, and the names of files that it needs
    /// and that are missing.
    pub(crate) fn list(&self) -> Value {
        let tell = |(name, file): (&String, &File)| {
            let is_model = Format::detect(&file.bytes, name).is_ok();
            let missing = if is_model { self.missing(name, file) } else { Vec::new() };
            json!({"name": name, "hash": file.hash, "model": is_model, "missing": missing})
        };
        self.files.iter().map(tell).collect()
    }

    /// The files that a model names and that are not there.
    fn missing(&self, name: &str, file: &File) -> Vec<String> {
        let asked = Asked { files: self, missing: std::sync::Mutex::default() };
        let options = LoadOptions { make_normals: false, ..LoadOptions::default() };
        // Other mistakes of the file are told when it is shown.
        let _ = load_bytes_with(&file.bytes, name, &asked, &options);
        let mut missing = asked.missing.into_inner().unwrap_or_default();
        missing.sort();
        missing.dedup();
        missing
    }

    /// Reads a model: `builtin:NAME`, or `file:NAME#HASH`.
    pub(crate) fn load(&self, model: &str, options: &LoadOptions) -> Result<Scene, Error> {
        if model.starts_with("builtin:") {
            return load_with(model, options);
        }
        let Some(name) = model.strip_prefix("file:") else {
            let hint = "models are builtin:NAME, or files that the page was given";
            return Err(Error::usage(format!("{model}: there is no such model here"), hint));
        };
        let (name, wanted) = name.rsplit_once('#').unwrap_or((name, ""));
        let Some(file) = self.files.get(name) else {
            return Err(Error::usage(
                format!("{name}: this file is needed"),
                "open it, or drop it on the page",
            ));
        };
        if !wanted.is_empty() && wanted != file.hash {
            let what = format!(
                "{name}: this is another file than the link was made with ({}, not {wanted})",
                file.hash
            );
            return Err(Error::usage(what, "open the file that belongs to the link"));
        }
        load_bytes_with(&file.bytes, name, &Beside { files: self, model: name }, options)
    }
}

/// A model's name without its kind and its hash: `builtin:teapot` is `teapot`,
/// `file:chair.obj#0123456789ab` is `chair.obj`.
pub(crate) fn plain_name(model: &str) -> &str {
    let model = model.rsplit_once('#').map_or(model, |(name, _)| name);
    model.split_once(':').map_or(model, |(_, name)| name)
}

/// The first digits of a file's SHA-256.
fn hash(bytes: &[u8]) -> String {
    let digits = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    digits[..HASH_DIGITS].to_owned()
}

/// Finds the files that a model names among the user's, by the whole path, else by its last part:
/// folders are lost when files are dropped.
struct Beside<'f> {
    files: &'f Files,
    model: &'f str,
}

impl Beside<'_> {
    fn find(&self, path: &str) -> Option<&File> {
        let files = &self.files.files;
        let folder = self.model.rsplit_once('/').map_or("", |(folder, _)| folder);
        let whole = if folder.is_empty() { path.to_owned() } else { format!("{folder}/{path}") };
        let last = path.rsplit(['/', '\\']).next().unwrap_or(path);
        let same_end = || {
            files
                .iter()
                .find(|(name, _)| name.rsplit('/').next() == Some(last))
                .map(|(_, file)| file)
        };
        files.get(&whole).or_else(|| files.get(path)).or_else(same_end)
    }
}

impl Resolver for Beside<'_> {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        self.find(path).map(|file| file.bytes.clone()).ok_or(ResolveError::NotFound)
    }
}

/// Notes the files that a model names in vain.
struct Asked<'f> {
    files: &'f Files,
    missing: std::sync::Mutex<Vec<String>>,
}

impl Resolver for Asked<'_> {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        let found = Beside { files: self.files, model: "" }.read(path);
        if found.is_err() {
            self.missing.lock().map_err(|_| ResolveError::NotFound)?.push(path.to_owned());
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &[u8] =
        b"mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl red\nf 1 2 3 4\n";
    const MATERIAL: &[u8] = b"newmtl red\nKd 1 0 0\n";

    #[test]
    fn files_are_found_and_named_by_their_content() {
        let mut files = Files::default();
        files.keep("square.obj", SQUARE.to_vec());
        let list = files.list();
        assert_eq!(
            (&list[0]["model"], &list[0]["missing"]),
            (&json!(true), &json!(["square.mtl"]))
        );
        files.keep("square.mtl", MATERIAL.to_vec());
        let list = files.list();
        assert_eq!((&list[0]["model"], &list[1]["missing"]), (&json!(false), &json!([])));

        let hash = list[1]["hash"].as_str().unwrap().to_owned();
        assert_eq!(hash.len(), HASH_DIGITS);
        let load = |model: &str| files.load(model, &LoadOptions::default());
        assert_eq!(load(&format!("file:square.obj#{hash}")).unwrap().materials.len(), 1);
        let other = load("file:square.obj#000000000000").unwrap_err().to_string();
        assert!(other.contains("another file"), "{other}");
        assert!(load("file:round.obj").unwrap_err().to_string().contains("this file is needed"));
        assert!(load("square.obj").is_err());
    }
}
