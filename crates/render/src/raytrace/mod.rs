//! Rays: what they meet, and the tree that finds it.

pub mod beam;
pub mod bvh;
pub mod intersect;
