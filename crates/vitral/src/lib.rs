//! A complete classical 3D renderer: a model file in, a picture out, without GPU, display or GL
//! driver.
//!
//! ```no_run
//! # fn main() -> Result<(), vitral::Error> {
//! vitral::open("part.glb")?.render()?.save("part.png")?;
//! # Ok(())
//! # }
//! ```
//!
//! [`open`] reads a model and [frames](View) it. [`Renderer`] holds what is to be decided about
//! pictures: [`Settings`] (size, algorithms, background, channels), camera and lights.
//! [`Renderer::render`] gives a [`Picture`], which can be saved, encoded, or read as bytes. A scene
//! can also be built:
//!
//! ```
//! use vitral::{Camera, DMat4, Light, Material, Mesh, PictureFormat, Renderer, Scene};
//!
//! let mut scene = Scene::default();
//! let red = scene.add_material(Material::matte([0.8, 0.1, 0.1]));
//! let triangle = Mesh::new([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.5, 0.0]], [[0, 1, 2]]);
//! scene.add_mesh(triangle.with_material(red), DMat4::IDENTITY);
//! scene.add_light(Light::directional([-1.0, -1.0, -1.0]));
//!
//! let camera = Camera::look_at([0.0, 1.0, 4.0], [0.0, 0.7, 0.0]);
//! let picture = Renderer::new(scene)?.with_camera(camera).render()?;
//! assert!(picture.encode(PictureFormat::Png)?.starts_with(b"\x89PNG"));
//! # Ok::<(), vitral::Error>(())
//! ```
//!
//! Angles are radians. Where an angle is in degrees, as on the command line and in its files, its
//! name says so. Colours of lights and materials are linear RGB; colours of backgrounds are in the
//! display's encoding.
//!
//! | also here | for |
//! |---|---|
//! | [`Renderer::draw`] | vector drawings: visible and hidden lines, filled regions |
//! | [`Renderer::draw_polygons`] | the polygons of painter's algorithm, BSP trees, Weiler–Atherton |
//! | [`info`](mod@info) | what is in a scene |
//! | [`State`] | all that makes a picture, as JSON |
//! | [`explain`](mod@explain) | how each algorithm decides about a pixel |
//! | [`dump`](mod@dump) | what each stage of the pipeline hands on |
//! | [`bench`](mod@bench) | time and memory of every visible-surface algorithm |
//! | [`internals`] | the crates below, without a promise of stability |
//!
//! # Features
//!
//! `threads`: pictures are computed on all processors. `obj`, `stl`, `ply`, `off`, `gltf`: the
//! model formats. `images`: textures of other formats than PNG, and pictures as JPEG. These are on
//! by default. Pictures do not depend on `threads`; a file of a format that is left out is refused
//! with the name of its feature. `scalar` adds the plain scalar instruction set, for comparison.
#![forbid(unsafe_code)]

mod algorithms;
mod batch;
pub mod bench;
mod drawing;
pub mod dump;
mod environment;
mod error;
mod exercise;
pub mod explain;
mod files;
mod framed_camera;
pub mod info;
pub mod internals;
mod light_edit;
mod light_term;
pub mod light_text;
mod load;
mod material_override;
pub mod names;
mod panels;
pub mod picture;
mod polygon_drawing;
mod renderer;
mod shadow_polygons;
pub mod state;
mod system_clock;
mod viewpoint;

pub use algorithms::algorithms;
pub use batch::Batch;
pub use drawing::{ColorBy, DrawingFormat, FillSettings};
pub use environment::{environment_from_bytes, load_environment};
pub use error::Error;
pub use exercise::{EXERCISES, Exercise};
pub use files::{FolderResolver, ReadFile, read};
pub use light_edit::{LightEdit, light_fields};
pub use light_term::LightTerm;
pub use load::{
    FileColors, LoadOptions, Normals, builtin_names, builtin_parameters, load, load_builtin,
    load_bytes, load_bytes_with, load_on, load_telling, load_with,
};
pub use material_override::{MaterialOverride, material_properties, override_material};
pub use panels::panels;
pub use picture::{Channel, EncodeOptions, Picture, PictureFormat};
pub use polygon_drawing::{PolygonDrawing, PolygonFill, PolygonSettings};
pub use renderer::{Moves, Renderer, execution, open};
pub use shadow_polygons::shadow_polygons;
pub use state::{Objects, State};
pub use system_clock::SystemClock;
pub use viewpoint::Viewpoint;

pub use vitral_draw::sheet::{
    Angle as SheetAngle, PlacedView, SYMBOL_SIZE, Sheet, SheetError, SheetLayout, symbol,
};
pub use vitral_draw::{
    Classes as LineClasses, DrawingSettings, DrawingStats, Drawn, FaceLook, Hatch, PageSize, Seams,
    VisibilityStats, covered_area,
};
pub use vitral_exec::{Budget, Clock, Limit, Progress, Workers};
pub use vitral_frame::drawing::{Line, LineClass, Region};
pub use vitral_frame::{
    Drawing, Encoding, Filter, Frame, MipFilter, Plane, Sampler, Texture, Wrap,
};
pub use vitral_io::encode::{
    DrawingOptions, Figure, Pens, Polyline, TitleBlock, for_plotter, simplify,
};
pub use vitral_io::{Error as InputError, Format, NoFiles, ResolveError, Resolver};
pub use vitral_light::{
    AlphaMode, AreaShape, Attenuation, EnvironmentMap, Illumination, Light, LightKind, Material,
    Reflectance, Rgb, TextureRef, Transmission,
};
pub use vitral_math::{Aabb, DMat4, DQuat, DVec3};
pub use vitral_render::catalogue::PolygonOrder;
pub use vitral_render::stats::VisibilityCounters;
pub use vitral_render::{
    Acceleration, Background, Channels, Choice, Coherence, ColorSpace, Culling, DepthCue,
    Environment, Error as RenderError, Execution, Global, GlobalSettings, GroundShadow,
    Interpolation, Lines, PictureSettings, Settings, SettingsError, Shading, ShadingSettings,
    ShadowSettings, Shadows, Stats, Terminator, Transparency, TransparencyOrder,
    TransparencySettings, UnknownName, Visibility, VolumeCounting,
};
pub use vitral_scene::builtin::solids;
pub use vitral_scene::{
    Attribute, Axis, Camera, Faces, Lens, Mesh, Node, NodeTransform, Part, Projection, Scene,
    SectionPlane, View, ViewTransform, World, lab, section, walkthrough,
};

/// The programs of `docs/library.md`, as tests.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/library.md")]
struct LibraryPage;
