//! Tokens of OpenGL 1.5 and its extensions.
//!
//! Names, values and versions are those of the Khronos registry (`gl.xml`, Apache-2.0).
#![allow(missing_docs)]

mod added;
mod later_versions;
mod suffixed;
mod version_1_1;
mod version_1_5;

pub use added::*;
pub use later_versions::*;
pub use suffixed::*;
pub use version_1_1::*;
pub use version_1_5::*;
