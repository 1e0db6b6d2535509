//! How a reader gets at the files that a model names. Faces implement it: a folder, a browser's upload, nothing.

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
    /// The bytes of the file that the model calls `path`: `/`-separated, relative to the model's folder, already
    /// freed of URI escapes and in Unicode, whatever the model's encoding. Implementations refuse absolute paths and those that
    /// leave the folder by `..`, unless the user allowed them.
    ///
    /// # Errors
    /// [`ResolveError`]: there is no such file, or it may not be read.
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError>;
}

/// A resolver without files.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFiles;

impl Resolver for NoFiles {
    fn read(&self, _path: &str) -> Result<Vec<u8>, ResolveError> {
        Err(ResolveError::NotFound)
    }
}
