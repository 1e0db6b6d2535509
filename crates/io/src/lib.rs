//! Floor 3: model files in, pictures out.
//!
//! Readers take bytes and a [`Resolver`] for the files that a model names (buffers, materials, textures); nothing here
//! touches the file system or the clock, so the same code runs in a browser.
#![forbid(unsafe_code)]

mod error;
mod resolve;

pub use error::{Error, Place};
pub use resolve::{NoFiles, ResolveError, Resolver};
