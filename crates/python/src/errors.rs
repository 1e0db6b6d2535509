//! Errors of the library as Python's exceptions, whose classes are in `vitral/_errors.py`.

use pyo3::prelude::*;
use std::path::Path;
use vitral::{Error, InputError, Limit, RenderError};
use vitral_cli::Failure;

/// Why something could not be done.
#[derive(Debug)]
pub(crate) enum Trouble {
    /// The library refused.
    Library(Error),
    /// The command line refused options.
    Options(Failure),
    /// Python refused.
    Python(PyErr),
}

impl From<Error> for Trouble {
    fn from(error: Error) -> Self {
        Self::Library(error)
    }
}

impl From<Failure> for Trouble {
    fn from(failure: Failure) -> Self {
        Self::Options(failure)
    }
}

impl From<PyErr> for Trouble {
    fn from(error: PyErr) -> Self {
        Self::Python(error)
    }
}

impl From<Trouble> for PyErr {
    fn from(trouble: Trouble) -> Self {
        match trouble {
            Trouble::Python(error) => error,
            Trouble::Options(failure) => {
                let class = class_of_code(failure.code());
                raise(class, failure.message(), failure.hint(), None, None)
            }
            Trouble::Library(error) => of_library(error),
        }
    }
}

/// The class of errors with an exit code of the command.
fn class_of_code(code: u8) -> &'static str {
    match code {
        2 => "UsageError",
        3 => "InputError",
        4 => "UnsupportedError",
        7 => "LimitError",
        _ => "Error",
    }
}

fn of_library(error: Error) -> PyErr {
    let (path, place) = match &error {
        Error::Read { path, .. } | Error::TooLarge { path, .. } => (Some(shown(path)), None),
        Error::Input(InputError::Malformed { file, place, .. }) => {
            (Some(file.clone()), Some(place.to_string()))
        }
        Error::Input(InputError::Missing { file, .. } | InputError::Unsupported { file, .. }) => {
            (Some(file.clone()), None)
        }
        _ => (None, None),
    };
    let class = match &error {
        Error::Render(RenderError::Limit(Limit::Time { .. })) => Some("_TimeLimitError"),
        Error::Render(RenderError::Limit(Limit::Memory { .. })) => Some("_MemoryLimitError"),
        _ => None,
    };
    let failure = Failure::from(error);
    let class = class.unwrap_or_else(|| class_of_code(failure.code()));
    raise(class, failure.message(), failure.hint(), path, place)
}

fn shown(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// An exception of a class of `vitral._errors`.
fn raise(
    class: &str,
    message: &str,
    hint: Option<&str>,
    path: Option<String>,
    place: Option<String>,
) -> PyErr {
    Python::attach(|py| {
        let make =
            || py.import("vitral._errors")?.getattr(class)?.call1((message, hint, path, place));
        make().map_or_else(|error| error, PyErr::from_value)
    })
}

/// A `UsageError`.
pub(crate) fn usage(message: impl Into<String>, hint: impl Into<String>) -> PyErr {
    Trouble::Library(Error::usage(message, hint)).into()
}
