//! The one error of this crate.

use std::path::PathBuf;
use vitral_exec::Limit;

/// Why something could not be done. Displays in one line as `FILE: WHERE: WHAT`, as far as these
/// are known.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file cannot be written.
    #[error("{}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file has more bytes than are allowed.
    #[error("{}: more than {limit} bytes", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Bytes allowed.
        limit: u64,
    },
    /// A model cannot be understood.
    #[error(transparent)]
    Input(vitral_io::Error),
    /// A picture cannot be made.
    #[error(transparent)]
    Render(#[from] vitral_render::Error),
    /// Views that cannot be put on a sheet.
    #[error(transparent)]
    Sheet(#[from] vitral_draw::sheet::SheetError),
    /// Known, but not possible here.
    #[error("{what}")]
    Unsupported {
        /// What was asked for.
        what: String,
        /// What is possible instead; may be empty.
        hint: String,
    },
    /// A state or configuration file that cannot be understood.
    #[error("{file}: {place}{what}")]
    State {
        /// The file as it was named.
        file: String,
        /// `line L, column C: path: `, as far as it is known.
        place: String,
        /// What is wrong.
        what: String,
    },
    /// Something was asked for that is not there: a name, an index, a value out of range.
    #[error("{what}")]
    Usage {
        /// What was asked for.
        what: String,
        /// What there is; may be empty.
        hint: String,
    },
}

impl From<vitral_io::Error> for Error {
    fn from(error: vitral_io::Error) -> Self {
        match error {
            vitral_io::Error::Absent { what, hint } => Self::Usage { what, hint },
            other => Self::Input(other),
        }
    }
}

impl From<vitral_scene::section::SectionError> for Error {
    fn from(error: vitral_scene::section::SectionError) -> Self {
        use vitral_scene::section::SectionError;
        match error {
            SectionError::World(error) => Self::Render(error.into()),
            SectionError::Limit(limit) => limit.into(),
        }
    }
}

impl From<Limit> for Error {
    fn from(limit: Limit) -> Self {
        Self::Render(limit.into())
    }
}

impl Error {
    /// [`Error::Usage`] from texts.
    pub fn usage(what: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::Usage { what: what.into(), hint: hint.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_begins_with_the_file() {
        let error = Error::TooLarge { path: "a.obj".into(), limit: 9 };
        assert_eq!(error.to_string(), "a.obj: more than 9 bytes");
        let error = Error::from(vitral_io::Error::malformed("f", vitral_io::Place::Line(3), "x"));
        assert_eq!(error.to_string(), "f: line 3: x");
    }
}
