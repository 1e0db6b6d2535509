//! Rays: what they meet, and the structures that find it.
//!
//! A structure knows where triangles are, so that a ray need not ask each of them: a tree of boxes
//! round neighbours ([`bvh`]), a cube cut in eight again and again ([`octree`]), a box cut in two
//! ([`bsp`]), a grid of equal cells ([`grid`]), a volume round each object ([`volumes`]), or
//! nothing but the list (`list.rs`). Whoever follows a ray is a [`Visitor`]: the structure shows it
//! the triangles near the ray, part by part, about the nearest first; the visitor says which parts
//! it can do without. All structures give the same hits.

pub mod beam;
pub mod bsp;
pub mod bvh;
pub(crate) mod follow;
pub mod grid;
pub mod intersect;
mod list;
pub mod octree;
pub(crate) mod packet;
pub mod path;
mod probe;
pub mod pyramid;
mod sah;
pub mod shaft;
mod structure;
pub mod structures;
pub mod triangles;
pub mod volumes;
mod wide;

pub use path::{PartExtent, PartVolume, PathPart, RayPath};
pub use probe::{Boxes, Probe};
pub use structure::{Counters, Structure, Tree, Visitor};
pub(crate) use structure::{Watched, space_step};
