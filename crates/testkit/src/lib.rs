//! Beside the house: what tests share. [`golden`] images, the [`matrix`] of SIMD levels and thread
//! counts, [`fixture`] files, and what the [`fuzz`] targets call. Nothing in the house depends on
//! this crate except its tests.
#![forbid(unsafe_code)]

pub mod fixture;
pub mod fuzz;
pub mod fuzz_draw;
pub mod fuzz_gl;
pub mod golden;
pub mod matrix;
mod page;

pub use golden::{Tolerance, check};
