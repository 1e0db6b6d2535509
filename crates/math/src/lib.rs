//! Floor 0: numbers. Vectors (glam), deterministic functions, lanes, boxes, frusta, colour
//! encodings.
//!
//! Everything above takes its transcendental functions from [`func`] and its SIMD types from
//! [`lanes`], so that one picture has the same bytes on every machine.
//!
//! Spaces, in the order in which a point meets them: **model, world, view, clip, ndc, screen**. A
//! transform is named `to_from_from`: `clip_from_view * view_from_world * world_from_model`.
#![forbid(unsafe_code)]

mod bounding_sphere;
pub mod bounds;
pub mod color;
pub mod exact;
mod fingerprint;
pub mod frustum;
pub mod func;
pub mod lanes;
pub mod obb;

pub use bounds::{Aabb, Sphere};
pub use fingerprint::{Fingerprint, mixed};
pub use frustum::Frustum;
pub use glam::{
    DAffine3, DMat3, DMat4, DQuat, DVec2, DVec3, DVec4, IVec2, Mat3, Mat4, UVec2, Vec2, Vec3, Vec4,
    dvec2, dvec3, dvec4, ivec2, uvec2, vec2, vec3, vec4,
};
pub use obb::Obb;
