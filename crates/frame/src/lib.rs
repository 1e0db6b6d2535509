//! Floor 1: pixels. Planes of values, textures with their samplers, and the finished [`Frame`]; and
//! its counterpart for vector output, the [`Drawing`].
#![forbid(unsafe_code)]

pub mod compare;
pub mod drawing;
mod frame;
mod line_classes;
mod plane;
pub mod texture;

pub use drawing::Drawing;
pub use frame::{Frame, TwoBuffers};
pub use line_classes::LineClasses;
pub use plane::Plane;
pub use texture::{Encoding, Filter, MipFilter, Sampler, Texture, Wrap, decode_table};
