//! How a reader gets at the files that a model names. Faces implement it: a folder, a browser's
//! upload, nothing.

/// Why a named file cannot be had.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ResolveError {
    /// There is no such file.
    #[error("there is no such file")]
    NotFound,
    /// The path leaves the model's folder.
    #[error("it lies outside the model's folder (--allow-external permits that)")]
    Outside,
    /// Anything else.
    #[error("{0}")]
    Other(String),
}

/// Access to the files beside a model.
pub trait Resolver: Sync {
    /// The bytes of the file that the model calls `path`: `/`-separated, relative to the model's
    /// folder, already freed of URI escapes and in Unicode, whatever the model's encoding.
    /// Implementations refuse absolute paths and those that leave the folder by `..`, unless the
    /// user allowed them.
    ///
    /// # Errors
    /// [`ResolveError`]: there is no such file, or it may not be read.
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError>;

    /// The name of a file that differs from `path` in the case of letters alone, the first in order
    /// if there are several: models come from systems that do not tell case apart. `None` where
    /// there is none or names cannot be listed.
    fn in_other_case(&self, _path: &str) -> Option<String> {
        None
    }
}

/// A file that was found.
#[derive(Debug)]
pub(crate) struct Found {
    pub(crate) bytes: Vec<u8>,
    pub(crate) name: String,
    /// What is odd about its name.
    pub(crate) oddity: Option<String>,
}

/// The first of the files called `names` that is there; of those that are not, the first that is in
/// other case.
///
/// # Errors
/// Why the first cannot be had.
pub(crate) fn read_first(resolver: &dyn Resolver, names: &[String]) -> Result<Found, ResolveError> {
    let mut why = None;
    for name in names {
        match resolver.read(name) {
            Ok(bytes) => return Ok(Found { bytes, name: name.clone(), oddity: None }),
            Err(e) => why = why.or(Some(e)),
        }
    }
    for wanted in names {
        if let Some(name) = resolver.in_other_case(wanted)
            && let Ok(bytes) = resolver.read(&name)
        {
            let oddity =
                Some(format!("there is no `{wanted}`; `{name}` is read, whose case differs"));
            return Ok(Found { bytes, name, oddity });
        }
    }
    Err(why.unwrap_or(ResolveError::NotFound))
}

/// A resolver without files.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFiles;

impl Resolver for NoFiles {
    fn read(&self, _path: &str) -> Result<Vec<u8>, ResolveError> {
        Err(ResolveError::NotFound)
    }
}
