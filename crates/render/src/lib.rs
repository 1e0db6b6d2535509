//! Floor 3: the classical algorithms, from a scene to a [`Frame`](vitral_frame::Frame).
//!
//! The way of the data is in [`pipeline`]: scene → cull → prepare → visible → shade → frame.
//! Finding the visible surface of each sample and colouring it are separate, so every visibility
//! algorithm works with every illumination and shading model. [`registry`] lists the algorithms.
#![forbid(unsafe_code)]

mod cache;
pub mod catalogue;
pub mod choice;
pub mod coherence;
pub mod cull;
mod display;
mod execution;
pub mod global;
pub mod marks;
pub mod pipeline;
pub mod prepare;
pub mod radiosity;
pub mod raytrace;
pub mod registry;
mod session;
mod settings;
pub mod shading;
pub mod shadow;
pub mod stats;
mod surroundings;
pub mod trace;
pub mod transparency;
pub mod visible;

pub use cache::{Cache, Cached, PerMesh, Reuse};
pub use catalogue::{Acceleration, Shadows, Visibility};
pub use choice::{Choice, UnknownName};
pub use coherence::{Coherence, CoherenceSet};
pub use execution::Execution;
pub use pipeline::{
    ExaminedPixel, Rendered, Shot, examine_pixel, illuminate_corners, outlined_polygons, render,
    watch_picture, watch_steps,
};
pub use prepare::PreparedView;
pub use session::Session;
pub use settings::{
    Background, Channels, ColorSpace, Culling, DepthCue, Environment, Global, GlobalSettings,
    GroundShadow, Interpolation, Lines, PictureSettings, Settings, SettingsError, Shading,
    ShadingSettings, ShadowSettings, Terminator, Transparency, TransparencyOrder,
    TransparencySettings, VolumeCounting,
};
pub use stats::Stats;
pub use surroundings::Surroundings;

/// Why a picture could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The settings ask for what cannot be.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The scene graph is not sound.
    #[error(transparent)]
    World(#[from] vitral_scene::WorldError),
    /// The scene's parts do not fit together.
    #[error("{0}")]
    Scene(String),
    /// Stored radiosity that cannot be used.
    #[error("{0}")]
    Radiosity(String),
    /// A limit was reached.
    #[error(transparent)]
    Limit(#[from] vitral_exec::Limit),
}
