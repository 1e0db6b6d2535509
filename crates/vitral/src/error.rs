//! The one error of this crate, with the exit code and the hint that a program shows.

use std::path::{Path, PathBuf};
use vitral_exec::Limit;
use vitral_io::FormatKind;
use vitral_render::SettingsError;

/// Why something could not be done. Displays in one line as `FILE: WHERE: WHAT`, as far as these are known.
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
        /// The file.
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

/// Whether a file's name may be that of a model.
fn is_model(path: &Path) -> bool {
    let Some(extension) = path.extension() else { return true };
    vitral_io::formats()
        .iter()
        .any(|f| f.kind != FormatKind::Picture && f.extensions.iter().any(|e| extension.eq_ignore_ascii_case(e)))
}

impl From<vitral_io::Error> for Error {
    fn from(error: vitral_io::Error) -> Self {
        Self::Input(error)
    }
}

impl From<Limit> for Error {
    fn from(limit: Limit) -> Self {
        Self::Render(limit.into())
    }
}

impl Error {
    /// Something that is not there.
    pub fn usage(what: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::Usage { what: what.into(), hint: hint.into() }
    }

    /// The exit code of a program that ends with this error: 2 usage, 3 input missing or malformed, 4 not supported,
    /// 5 cannot write, 7 a limit was reached, 130 interrupted, 1 anything else.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage { .. } => 2,
            Self::Read { .. } | Self::State { .. } => 3,
            Self::Unsupported { .. } => 4,
            Self::Write { .. } => 5,
            Self::TooLarge { .. } => 7,
            Self::Input(error) => match error {
                vitral_io::Error::Malformed { .. } | vitral_io::Error::Missing { .. } => 3,
                vitral_io::Error::Unsupported { .. } | vitral_io::Error::Encode { .. } => 4,
                _ => 1,
            },
            Self::Render(error) => match error {
                vitral_render::Error::Settings(SettingsError::Resolution { width, height }) => {
                    if *width.max(height) > vitral_raster::MAX_SIDE { 7 } else { 2 }
                }
                vitral_render::Error::Settings(_) => 2,
                vitral_render::Error::World(_)
                | vitral_render::Error::Scene(_)
                | vitral_render::Error::Radiosity(_) => 3,
                vitral_render::Error::Limit(Limit::Cancelled { .. }) => 130,
                vitral_render::Error::Limit(_) => 7,
                _ => 1,
            },
        }
    }

    /// What the user may do about it, if there is something to say.
    pub fn hint(&self) -> Option<String> {
        let text = match self {
            Self::Usage { hint, .. } | Self::Unsupported { hint, .. } => hint.clone(),
            Self::Read { path, source } if source.kind() == std::io::ErrorKind::NotFound && is_model(path) => {
                let names: Vec<_> = vitral_scene::builtin::names().iter().map(|(name, _)| *name).collect();
                format!("scenes without a file: builtin:{}", names.join(", builtin:"))
            }
            Self::Input(vitral_io::Error::Missing { why, .. }) if why.contains("outside") => {
                "if you trust the model, --allow-external lets it read files outside its folder".to_owned()
            }
            Self::Render(vitral_render::Error::Settings(SettingsError::ListOrder { .. })) => {
                "--visibility bsp or painter makes a list".to_owned()
            }
            Self::Render(vitral_render::Error::Settings(SettingsError::Translucent { material, .. })) => {
                format!("or --material {material}.transmission=transparent")
            }
            Self::Render(vitral_render::Error::Settings(SettingsError::OrderOfRays(_))) => {
                "leave out --transparency-order, or --global ray-trace".to_owned()
            }
            Self::Render(vitral_render::Error::Limit(Limit::Memory { .. })) => {
                "fewer samples or a smaller resolution need less memory".to_owned()
            }
            _ => String::new(),
        };
        Some(text).filter(|t| !t.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_exec::Achieved;

    #[test]
    fn every_kind_has_the_exit_code_of_the_table() {
        let not_found = || std::io::Error::from(std::io::ErrorKind::NotFound);
        let path = PathBuf::from("a.obj");
        let read = Error::Read { path: path.clone(), source: not_found() };
        assert_eq!(read.exit_code(), 3);
        assert!(read.hint().unwrap().contains("builtin:teapot"));
        assert_eq!(Error::Write { path: path.clone(), source: not_found() }.exit_code(), 5);
        assert_eq!(Error::TooLarge { path, limit: 9 }.to_string(), "a.obj: more than 9 bytes");
        let io = |e: vitral_io::Error| Error::from(e).exit_code();
        assert_eq!(io(vitral_io::Error::malformed("f", vitral_io::Place::Line(3), "x")), 3);
        assert_eq!(io(vitral_io::Error::Unsupported { file: "f".into(), what: "x".into() }), 4);
        let size = |width, height| {
            let error = vitral_render::Error::Settings(SettingsError::Resolution { width, height });
            Error::from(error).exit_code()
        };
        assert_eq!((size(0, 5), size(1, 99_999)), (2, 7));
        assert_eq!(Error::from(Limit::Cancelled { stage: "x" }).exit_code(), 130);
        assert_eq!(Error::from(Limit::Time { limit: 1.0, stage: "x", achieved: Achieved::default() }).exit_code(), 7);
    }
}
