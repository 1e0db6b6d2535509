//! Floor 1: pixels. Planes of values, textures with their samplers, and the finished [`Frame`].
#![forbid(unsafe_code)]

pub mod compare;
mod frame;
mod plane;
pub mod texture;

pub use frame::{Frame, TwoBuffers};
pub use plane::Plane;
pub use texture::{Encoding, Filter, MipFilter, Sampler, Texture, Wrap, decode_table};
