//! Floor 1: what there is to see. Meshes (model space), nodes and instances (world space), cameras (view and clip space).
#![forbid(unsafe_code)]

mod camera;
mod mesh;
mod scene;
mod world;

pub use camera::{Camera, Projection, ViewTransform};
pub use mesh::{Attribute, Corners, Faces, Mesh, Part};
pub use scene::{Node, NodeTransform, Scene};
pub use world::{Instance, World, WorldError};
