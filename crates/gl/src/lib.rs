//! Floor 3: OpenGL 1.5 with extensions, a state machine in safe Rust.
//!
//! A [`Context`] has one method for each GL entry point, named as the entry point without `gl`, in
//! snake case, with addresses in place of pointers: memory of the client is reached through
//! [`ClientMemory`] alone.
//!
//! The way of a call: a method reads its arguments, then hands a closure to `Context::listable`,
//! which runs it, or keeps it in the display list that is being compiled. The closure checks
//! (outside Begin/End? valid? else record the error and change nothing) and stores. Vertices gather
//! in a `vertices::Builder`; complete primitives become a [`vertex::VertexBatch`], which `tnl`
//! draws: a snapshot of the state is recorded in a pass of `vitral_raster::forward`, and runs when
//! someone looks.
#![forbid(unsafe_code)]

mod api;
mod context;
pub mod enums;
pub mod memory;
mod names;
pub mod objects;
mod pixels;
mod primitive;
pub mod state;
mod tnl;
pub mod vertex;
mod vertices;

pub use api::{DebugHook, DebugMessage};
pub use context::Context;
pub use memory::ClientMemory;
pub use objects::Shared;
pub use pixels::{BufferInfo, DepthCopy, OSMESA_ARGB, OSMESA_BGR, OSMESA_BGRA, OSMESA_RGB_565};
pub use tnl::RunnerSource;
