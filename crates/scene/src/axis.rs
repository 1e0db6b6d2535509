//! The axes of coordinates, each with a direction, as names and as vectors.

use vitral_math::DVec3;

/// A coordinate axis with a direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Axis {
    /// +X.
    PlusX,
    /// -X.
    MinusX,
    /// +Y.
    #[default]
    PlusY,
    /// -Y.
    MinusY,
    /// +Z.
    PlusZ,
    /// -Z.
    MinusZ,
}

/// A text that names no axis.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no axis: one of +X -X +Y -Y +Z -Z is required")]
pub struct AxisError(String);

impl std::str::FromStr for Axis {
    type Err = AxisError;

    /// Reads `+X`, `x`, `-z`, ...
    fn from_str(text: &str) -> Result<Self, AxisError> {
        let (minus, letter) = match text.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, text.strip_prefix('+').unwrap_or(text)),
        };
        match (letter, minus) {
            ("x" | "X", false) => Ok(Self::PlusX),
            ("x" | "X", true) => Ok(Self::MinusX),
            ("y" | "Y", false) => Ok(Self::PlusY),
            ("y" | "Y", true) => Ok(Self::MinusY),
            ("z" | "Z", false) => Ok(Self::PlusZ),
            ("z" | "Z", true) => Ok(Self::MinusZ),
            _ => Err(AxisError(text.to_owned())),
        }
    }
}

impl std::fmt::Display for Axis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::PlusX => "+X",
            Self::MinusX => "-X",
            Self::PlusY => "+Y",
            Self::MinusY => "-Y",
            Self::PlusZ => "+Z",
            Self::MinusZ => "-Z",
        })
    }
}

impl Axis {
    /// Unit vector along the axis.
    pub fn vector(self) -> DVec3 {
        match self {
            Self::PlusX => DVec3::X,
            Self::MinusX => DVec3::NEG_X,
            Self::PlusY => DVec3::Y,
            Self::MinusY => DVec3::NEG_Y,
            Self::PlusZ => DVec3::Z,
            Self::MinusZ => DVec3::NEG_Z,
        }
    }

    /// The direction from a model's middle to its front where this axis is up: +Z, but -Y and +Y
    /// where Z is up or down.
    pub fn front(self) -> DVec3 {
        match self {
            Self::PlusZ => DVec3::NEG_Y,
            Self::MinusZ => DVec3::Y,
            _ => DVec3::Z,
        }
    }
}
