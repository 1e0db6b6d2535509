//! Global illumination: light that comes from other surfaces, not from light sources alone.
//!
//! The local models know a surface, a viewer and lights. Global ones add what other surfaces send:
//! `whitted` follows rays on where they are mirrored and bent. They take what a visibility
//! algorithm found and add to how it is coloured, so each works with every visibility algorithm and
//! every local model. [`crate::registry::GLOBALS`] lists them.

mod branching;
mod coincident;
pub mod media;
mod ray_scene;
mod rays;
mod sky;
mod surface;
mod trace_writer;
mod whitted;

pub(crate) use whitted::Whitted;
