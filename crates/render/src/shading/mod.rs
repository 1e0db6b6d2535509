//! Colouring what is visible: one pass over the samples of each tile, eight points at a time.
//!
//! A *point* is a facet in a pixel: however many samples of the pixel show it, it is illuminated
//! once, at the pixel's centre, or at the middle of its samples where it does not fill the pixel.
//! Points of one object and material go through the formulas together.
//!
//! From the ground up: `collect` finds the `Points` of a tile. `facets` and `geometry` place them
//! on their facets, `surface_parameters` looks textures up, `lighting` reflects the lights, and
//! `shade` puts these steps together, a `batch` of eight points at a time. `composite` makes pixels
//! of points and `color_sink` runs the steps for each tile. Ray tracing takes over samples through
//! the trait `Tracer`.
//!
//! In:   a tile's facets and depths. Out: display colours, straight alpha.
//! Cost: linear in points, times the number of lights.

pub mod face_colors;
pub mod face_table;
pub mod flat;
pub mod gouraud;
pub mod phong;

mod batch;
mod behind;
mod buffers;
mod channels;
mod collect;
mod color_only;
mod color_sink;
mod composite;
mod corners;
mod deadline;
mod depth_cue;
mod examine;
mod facets;
mod fragments;
mod frame_constants;
mod geometry;
mod glow;
mod hits;
mod instance_constants;
mod lighting;
mod listed;
mod material_constants;
mod model;
mod passes;
pub mod pixel_light;
mod points;
mod scratch;
mod shade;
mod shaded_points;
mod shadow_edges;
mod shadowed;
mod slots;
mod subject;
mod surface_parameters;
mod terminator;
mod tile_rows;
mod tracer;

pub(crate) use behind::DeepImage;
pub(crate) use buffers::{BYTES_A_PIXEL, BufferPlanes};
pub(crate) use channels::{ChannelSink, DataPlanes};
pub(crate) use color_sink::{ColorSink, Passes, Shown};
pub use corners::LitCorner;
pub(crate) use corners::lit_corners;
pub(crate) use examine::Examination;
pub use face_table::FaceTable;
pub(crate) use frame_constants::{FrameConstants, FrameLight};
pub(crate) use hits::Hit;
pub(crate) use points::Points;
pub(crate) use shade::shade_hits;
pub(crate) use shaded_points::{Bounce, ShadedPoints};
pub(crate) use tile_rows::TileRows;
pub(crate) use tracer::{Front, Tracer};
