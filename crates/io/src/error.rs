//! What can be wrong with a file, and where.

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line, counted from 1.
    Line(u64),
    /// A byte offset, counted from 0.
    Byte(u64),
    /// A JSON path such as `meshes[0].primitives[1].attributes.POSITION`.
    Json(String),
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(n) => write!(f, "line {n}: "),
            Self::Byte(n) => write!(f, "byte {n}: "),
            Self::Json(path) => write!(f, "{path}: "),
        }
    }
}

/// Why a file could not be read or written. Displays as `FILE: PLACE: WHAT`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The content breaks the rules of its format. `what` says what was seen and what is required.
    #[error("{file}: {place}{what}")]
    Malformed {
        /// The file as the caller named it.
        file: String,
        /// Where in it.
        place: Place,
        /// What was seen, what is required.
        what: String,
    },
    /// A file that the model cannot do without is not there or not allowed.
    #[error("{file}: needs `{needed}`: {why}")]
    Missing {
        /// The file that names the other.
        file: String,
        /// The other.
        needed: String,
        /// Not there, outside the model's folder, too large ...
        why: String,
    },
    /// The format is known but not read, or the file demands a feature that is not there.
    #[error("{file}: {what}")]
    Unsupported {
        /// The file as the caller named it.
        file: String,
        /// The format or feature.
        what: String,
    },
    /// Something was asked for that the file does not have.
    #[error("{what}")]
    Absent {
        /// What was asked for.
        what: String,
        /// What there is.
        hint: String,
    },
    /// A picture that cannot be written in the wanted format.
    #[error("{what}")]
    Encode {
        /// Why.
        what: String,
    },
}

impl Error {
    /// A malformed file.
    pub fn malformed(file: &str, place: Place, what: impl Into<String>) -> Self {
        Self::Malformed { file: file.to_owned(), place, what: what.into() }
    }
}
