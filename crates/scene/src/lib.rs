//! Floor 1: what there is to see. Meshes (model space), nodes and instances (world space), cameras
//! (view and clip space).
#![forbid(unsafe_code)]

mod axis;
pub mod bodies;
pub mod buckets;
pub mod builtin;
mod camera;
mod camera_moves;
mod corner_fans;
mod cut_marks;
mod default_lights;
mod directions;
mod disjoint_sets;
mod edge_table;
pub mod edges;
mod explode;
mod exposure;
pub mod extent;
mod face_data;
mod fill_light;
pub mod framing;
pub mod lab;
mod light_form;
mod mesh;
mod mesh_builders;
pub mod normals;
pub mod planes;
mod scene;
pub mod section;
mod skins;
mod solidity;
pub mod spaces;
mod tangents;
pub mod topology;
mod triangle_buckets;
pub mod walkthrough;
pub mod weld;
mod world;

pub use axis::{Axis, AxisError};
pub use camera::{Camera, Projection, ViewTransform};
pub use cut_marks::Section;
pub use default_lights::default_lights;
pub use edges::{Edge, EdgeKind};
pub use exposure::LightMeter;
pub use extent::{Extent1, Extent2};
pub use fill_light::{fill_light, leaves_dark};
pub use framing::{Lens, View, depth_range, frame};
pub use light_form::LightForm;
pub use mesh::{Attribute, Corners, Faces, FreePart, Mesh, Part, TRIANGLES_A_RUN};
pub use planes::SharedPlanes;
pub use scene::{Animation, Node, NodeTransform, Scene};
pub use section::SectionPlane;
pub use solidity::{KnownSolidity, Solidity, Solids};
pub use tangents::tangents;
pub use topology::{Topology, is_closed};
pub use world::{Instance, World, WorldError};
