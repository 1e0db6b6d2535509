//! Tests of readers and writers. One program: linking and starting dominate the cost of many small
//! ones.

mod common;
mod encode;
mod gltf;
mod gltf_animation;
mod gltf_extensions;
mod gltf_models;
mod malformed;
mod models;
mod scene_json;
mod wild;
