//! Floor 4: vitral as a library. A model file in, a picture out, without GPU, display or GL driver.
//!
//! ```
//! let mut renderer = vitral::Renderer::new(vitral::load_builtin("teapot")?)?;
//! (renderer.settings.picture.width, renderer.settings.picture.height) = (160, 120);
//! let picture = renderer.render()?.frame;
//! let png = vitral::picture::encode(&picture, vitral::Channel::Color, vitral::PictureFormat::Png)?;
//! assert!(png.starts_with(b"\x89PNG"));
//! # Ok::<(), vitral::Error>(())
//! ```
//!
//! [`load()`] reads a model, [`Renderer`] draws it with the [`Settings`] that it holds, [`picture`] writes what came out.
//! [`info`](mod@info) tells what is in a scene, [`State`] keeps everything that makes a picture as JSON, [`dump`](mod@dump)
//! writes what each stage of the pipeline hands on. The floors below are here under short names, for whoever builds
//! scenes or algorithms: [`math`], [`exec`], [`frame`], [`light`], [`scene`], [`raster`], [`render`], [`io`].
//!
//! This crate and the command line are the only places that know files, clocks and the environment.
#![forbid(unsafe_code)]

pub use vitral_exec as exec;
pub use vitral_frame as frame;
pub use vitral_io as io;
pub use vitral_light as light;
pub use vitral_math as math;
pub use vitral_raster as raster;
pub use vitral_render as render;
pub use vitral_scene as scene;

pub mod bench;
pub mod dump;
mod error;
pub mod explain;
mod files;
pub mod info;
mod load;
mod material_override;
pub mod names;
mod panels;
pub mod picture;
mod renderer;
mod shadow_polygons;
pub mod state;
mod system_clock;
mod viewpoint;

pub use error::Error;
pub use files::{FolderResolver, read};
pub use load::{LoadOptions, Normals, default_camera, load, load_builtin, load_bytes};
pub use material_override::{MaterialOverride, material_properties, override_material};
pub use panels::panels;
pub use picture::{Channel, PictureFormat};
pub use renderer::{Moves, Renderer, execution};
pub use shadow_polygons::shadow_polygons;
pub use state::State;
pub use system_clock::SystemClock;
pub use viewpoint::Viewpoint;

pub use vitral_exec::{Budget, Workers};
pub use vitral_frame::Frame;
pub use vitral_light::{Illumination, Light, Material};
pub use vitral_render::{
    Acceleration, Background, Channels, Choice, Coherence, ColorSpace, Culling, DepthCue, Execution, Global,
    GlobalSettings, Interpolation, Lines, PictureSettings, Rendered, Settings, SettingsError, Shading, ShadingSettings,
    ShadowSettings, Shadows, Stats, Transparency, TransparencyOrder, TransparencySettings, UnknownName, Visibility,
    VolumeCounting,
};
pub use vitral_scene::{Axis, Camera, Lens, Mesh, Node, Projection, Scene, View};
