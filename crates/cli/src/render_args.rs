//! The options of `vitral render` as typed. What was not typed is `None`, so that files can fill it
//! in.

use crate::draw_args::line_classes;
use crate::environment::{self, EnvironmentSource};
use crate::help::{self, EXIT_CODES, model_help, model_long_help};
use crate::{choices, depth_cue, light_spec, values};
use clap::{ArgAction, Args, ValueEnum};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use vitral::explain::Deciders;
use vitral::{
    Acceleration, Axis, Channel, ColorSpace, Culling, DVec3, DepthCue, FileColors, Global,
    GroundShadow, Illumination, Interpolation, LightEdit, LightTerm, LineClass, LineClasses,
    MaterialOverride, Normals, PictureFormat, Shading, Shadows, Terminator, Transparency,
    TransparencyOrder, View, Visibility, VolumeCounting,
};

/// Options of `vitral render`.
#[derive(Args, Clone, Debug, Default)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct RenderArgs {
    #[arg(required_unless_present_any = ["load_state", "exercise"], value_name = "MODEL", help = model_help(), long_help = model_long_help())]
    pub(crate) models: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
    #[command(flatten)]
    pub(crate) picture: PictureArgs,
    #[command(flatten)]
    pub(crate) algorithms: AlgorithmArgs,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
    #[command(flatten)]
    pub(crate) lab: LabArgs,
    #[command(flatten)]
    pub(crate) process: ProcessArgs,
    #[command(flatten)]
    pub(crate) report: ReportArgs,
}

/// Where pictures go.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::OUTPUT)]
pub(crate) struct OutputArgs {
    /// Where the picture goes: .png .jpg .ppm .webp .gif .apng .npy, or `-` for standard output
    ///
    /// {model} and {frame:4} expand. A turntable without {frame} is an animation (.gif, .webp,
    /// .apng), and on standard output one picture after another. Several models make one scene, or
    /// with {model} a picture each. Repeatable: one for each --channel
    #[arg(long, short, value_name = "OUT", required_unless_present_any = ["dump", "save_state", "pixel", "export_shadow_polygons", "steps_video"])]
    pub(crate) output: Vec<PathBuf>,
    /// Put several models into one scene, although --output has {model} [default: a picture of each
    /// model]
    #[arg(long)]
    pub(crate) together: bool,
    /// The file format, whatever the name says: one for all outputs, or one for each [default: by
    /// the extension; png for `-`, devices and pipes]
    #[arg(long, value_name = "FORMAT", value_parser = choices::picture_format())]
    pub(crate) format: Vec<PictureFormat>,
    /// Channel to write: the n-th channel goes to the n-th --output [default: color]
    #[arg(long, value_name = "CHANNEL", value_parser = choices::channel())]
    pub(crate) channel: Vec<Channel>,
    /// With --channel steps: the picture after step N of the algorithm, counted from 0 as in
    /// --trace, with one sample per pixel; what the step works on is outlined [default: all steps
    /// over the finished picture]
    #[arg(help_heading = help::ANIMATION)]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) step: Option<u32>,
    /// Write the picture after each step into these files, where {frame} or {frame:4} expands, or
    /// into an animation (.gif, .webp, .apng)
    #[arg(help_heading = help::ANIMATION)]
    #[arg(long, value_name = "OUT", conflicts_with_all = ["turntable", "panels"])]
    pub(crate) steps_video: Option<PathBuf>,
    /// The most pictures of --steps-video, spread evenly over all steps, with the last one among
    /// them; 0 makes one for each step [default: 240]
    #[arg(help_heading = help::ANIMATION)]
    #[arg(long, value_name = "N", requires = "steps_video", allow_negative_numbers = true)]
    pub(crate) steps_frames: Option<u32>,
    /// N views around the model; --output needs {frame}, or a format that can be animated
    #[arg(help_heading = help::ANIMATION)]
    #[arg(long, value_name = "N", value_parser = values::whole(1..=1_000_000u32), allow_negative_numbers = true)]
    #[arg(group = "sequence")]
    pub(crate) turntable: Option<u32>,
    /// N pictures of an animation in a glTF file, from --animation-time to its end, seen by one
    /// camera; --output as for --turntable. The file is read for each picture
    #[arg(help_heading = help::ANIMATION)]
    #[arg(long, value_name = "N", value_parser = values::whole(1..=1_000_000u32), allow_negative_numbers = true)]
    #[arg(group = "sequence", conflicts_with_all = ["steps_video", "trace", "structure", "dump", "reference"])]
    pub(crate) animation_frames: Option<u32>,
    /// Frames per second of an animation as .gif, .webp or .apng [default: 25]
    #[arg(help_heading = help::ANIMATION)]
    #[arg(long, value_name = "N", value_parser = values::frame_rate, allow_negative_numbers = true)]
    pub(crate) frame_rate: Option<f64>,
    /// Only these frames of the turntable or animation, counted from 0: 3 or 0-9
    #[arg(help_heading = help::ANIMATION)]
    #[arg(long, value_name = "FIRST-LAST", value_parser = values::frames, requires = "sequence")]
    pub(crate) frames: Option<RangeInclusive<u32>>,
    /// Compare the colour picture with this one: it is written only if they differ, with exit code
    /// 6
    #[arg(long, value_name = "IMG")]
    pub(crate) reference: Option<PathBuf>,
    /// End with exit code 6 if a picture shows nothing of the models
    #[arg(long)]
    pub(crate) fail_if_blank: bool,
    /// How far a colour channel may differ from the reference, from 0 to 1 of its range [default:
    /// 0]
    #[arg(long, value_name = "F", value_parser = values::share, requires = "reference", allow_negative_numbers = true)]
    pub(crate) reference_threshold: Option<f64>,
    /// Write a figure of the shadow algorithm instead of one picture: six panels, from the light's
    /// view to the finished picture, each of the size of a picture; with --shadows map or
    /// object-precision
    #[arg(long)]
    pub(crate) panels: bool,
    /// Write the radiosity solution into this file, for pictures from other cameras; with --global
    /// radiosity
    #[arg(long, value_name = "FILE")]
    pub(crate) save_radiosity: Option<PathBuf>,
    /// Use the radiosity solution of this file instead of computing one
    #[arg(long, value_name = "FILE", conflicts_with_all = ["patch_size", "iterations"])]
    pub(crate) load_radiosity: Option<PathBuf>,
    /// Write what each stage of the pipeline hands to the next into this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) dump: Option<PathBuf>,
    /// Write the polygons that the shadow algorithm works with (shadow volumes, shadow polygons or
    /// lit polygons) into this OBJ file
    #[arg(long, value_name = "FILE", value_parser = values::obj_file())]
    pub(crate) export_shadow_polygons: Option<PathBuf>,
}

/// Size, background, quality.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::PICTURE)]
pub(crate) struct PictureArgs {
    /// Width and height in pixels [default: 1024x768]
    ///
    /// 1024x768 and 1024,768 mean the same
    #[arg(long, value_name = "WxH", value_parser = values::resolution, allow_hyphen_values = true)]
    pub(crate) resolution: Option<[u32; 2]>,
    /// Samples per pixel, 1 to 16, or 32 [default: 4]
    ///
    /// 1 means no anti-aliasing; 32 samples are a coverage mask of 4 x 8
    #[arg(long, value_name = "N", value_parser = values::samples, allow_negative_numbers = true)]
    pub(crate) samples: Option<u32>,
    /// Background: a name, #rrggbb or r,g,b [default: a soft gradient]
    ///
    /// r, g and b are numbers from 0 to 1
    #[arg(long, value_name = "COLOR", value_parser = values::color, conflicts_with = "no_background")]
    pub(crate) background_color: Option<[f32; 3]>,
    /// Leave the background transparent
    #[arg(long)]
    pub(crate) no_background: bool,
    /// How colours become bytes [default: srgb]
    #[arg(long, value_name = "SPACE", value_parser = choices::color_space())]
    pub(crate) color_space: Option<ColorSpace>,
}

/// How the picture is made.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::ALGORITHMS)]
pub(crate) struct AlgorithmArgs {
    /// Algorithm that finds the visible surfaces [default: z-buffer]
    #[arg(long, value_name = "NAME", value_parser = choices::visibility())]
    pub(crate) visibility: Option<Visibility>,
    /// Store depths as integers of N bits, 8 to 32, with --visibility z-buffer: surfaces less than
    /// one step apart get equal depths, which shows z-fighting [default: floating point]
    #[arg(long, value_name = "N", value_parser = values::whole(8..=32u32), allow_negative_numbers = true)]
    pub(crate) depth_bits: Option<u32>,
    /// Structure that finds the triangles near a ray, for --visibility ray-cast, --shadows ray and
    /// --global ray-trace [default: bvh]
    #[arg(long, value_name = "NAME", value_parser = choices::acceleration())]
    pub(crate) acceleration: Option<Acceleration>,
    /// Kinds of coherence to use: a list, all, or none; `vitral algorithms` explains them and lists
    /// those of each algorithm [default: all]
    #[arg(long, value_name = "LIST", value_parser = values::coherence)]
    pub(crate) coherence: Option<values::CoherenceList>,
    /// Culling before rendering: a list of frustum, back-face; or none [default:
    /// frustum,back-face]
    #[arg(long, value_name = "LIST", value_parser = values::culling)]
    pub(crate) cull: Option<Culling>,
    /// Formula for the light that a surface reflects [default: auto]
    #[arg(long, value_name = "MODEL", value_parser = choices::illumination())]
    pub(crate) illumination: Option<Illumination>,
    /// Where illumination is computed: per pixel, vertex or face [default: phong]
    #[arg(long, value_name = "MODEL", value_parser = choices::shading())]
    pub(crate) shading: Option<Shading>,
    /// How values are interpolated between vertices [default: perspective]
    #[arg(long, value_name = "KIND", value_parser = choices::interpolation())]
    pub(crate) interpolation: Option<Interpolation>,
    /// How a transparent surface combines its light with the light behind it [default: linear]
    #[arg(help_heading = help::TRANSPARENCY)]
    #[arg(long, value_name = "MODEL", value_parser = choices::transparency_model())]
    pub(crate) transparency: Option<Transparency>,
    /// Exponent of Kay's model, with --transparency kay: the larger, the thinner the glass looks
    /// [default: 3]
    #[arg(help_heading = help::TRANSPARENCY)]
    #[arg(long, value_name = "M", value_parser = values::exponent, allow_negative_numbers = true)]
    pub(crate) kay_exponent: Option<f32>,
    /// Order in which transparent surfaces are combined, and how it is found [default: a-buffer]
    #[arg(help_heading = help::TRANSPARENCY)]
    #[arg(long, value_name = "ORDER", value_parser = choices::transparency_order())]
    pub(crate) transparency_order: Option<TransparencyOrder>,
    /// About how many rays per pixel a translucent surface scatters, and show what a slightly rough
    /// metal mirrors with --global ray-trace, 1 to 4096 [default: 32]
    #[arg(help_heading = help::TRANSPARENCY)]
    #[arg(long, value_name = "N", value_parser = values::whole(1..=4096u32), allow_negative_numbers = true)]
    pub(crate) scatter_samples: Option<u32>,
    /// Algorithm that finds shadows [default: none; ray with --global]
    #[arg(help_heading = help::SHADOWS)]
    #[arg(long, value_name = "NAME", value_parser = choices::shadows())]
    pub(crate) shadows: Option<Shadows>,
    /// Sample points on each area light, 1 to 4096; more make penumbrae smoother [default: 16]
    #[arg(help_heading = help::SHADOWS)]
    #[arg(long, value_name = "N", value_parser = values::whole(1..=4096u32), allow_negative_numbers = true)]
    pub(crate) light_samples: Option<u32>,
    #[arg(help_heading = help::SHADOWS)]
    #[arg(long, value_name = "RAYS", value_parser = values::whole(1..=4096u32), num_args = 0..=1, require_equals = true, default_missing_value = DEFAULT_RAYS, help = occlusion_help())]
    pub(crate) ambient_occlusion: Option<u32>,
    /// Greatest distance of occluders for --ambient-occlusion, in the model's unit [default: half
    /// the radius of the scene]
    #[arg(help_heading = help::SHADOWS)]
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, allow_negative_numbers = true)]
    pub(crate) occlusion_radius: Option<f64>,
    /// A ground at the lowest point of the model that only shows shadow: it darkens the background,
    /// a transparent one as well [default: none; auto without a kind]
    #[arg(help_heading = help::SHADOWS)]
    #[arg(long, value_name = "KIND", value_parser = choices::ground_shadow(), num_args = 0..=1, require_equals = true, default_missing_value = "auto")]
    pub(crate) ground_shadow: Option<GroundShadow>,
    /// Texels along the longer side of a shadow map, 16 to 8192; with --shadows map [default: 2048]
    #[arg(help_heading = help::SHADOWS)]
    #[arg(long, value_name = "N", value_parser = values::whole(16..=8192u32), allow_negative_numbers = true)]
    pub(crate) shadow_map_size: Option<u32>,
    /// Shadow maps per light, 1 to 8, each for a range of depths, so that near parts get more
    /// detail; for large scenes, with --shadows map [default: 1]
    #[arg(help_heading = help::SHADOWS)]
    #[arg(long, value_name = "N", value_parser = values::whole(1..=8u32), allow_negative_numbers = true)]
    pub(crate) shadow_cascades: Option<u32>,
    /// From where shadow volumes are counted, with --shadows volume [default: z-fail]
    #[arg(help_heading = help::SHADOWS)]
    #[arg(long, value_name = "WAY", value_parser = choices::volume_counting())]
    pub(crate) volume_counting: Option<VolumeCounting>,
    /// Where light ends on round bodies made of flat facets, with --shadows [default: soft]
    #[arg(help_heading = help::SHADOWS)]
    #[arg(long, value_name = "WAY", value_parser = choices::terminator())]
    pub(crate) terminator: Option<Terminator>,
    /// Light from other surfaces: mirrors and glass, or diffuse light [default: none]
    #[arg(help_heading = help::GLOBAL)]
    #[arg(long, value_name = "NAME", value_parser = choices::global())]
    pub(crate) global: Option<Global>,
    /// The most reflections and refractions along a ray, 1 to 64, with --global ray-trace [default:
    /// 8]
    #[arg(help_heading = help::GLOBAL)]
    #[arg(long, value_name = "N", value_parser = values::whole(1..=64u32), allow_negative_numbers = true)]
    pub(crate) max_depth: Option<u32>,
    /// Longest edge of a patch in the scene's units, with --global radiosity [default: 1/16 of the
    /// scene's diagonal]
    #[arg(help_heading = help::GLOBAL)]
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, allow_negative_numbers = true)]
    pub(crate) patch_size: Option<f64>,
    /// The most patches that send light, with --global radiosity [default: until 0.2 % of the light
    /// is left to send]
    #[arg(help_heading = help::GLOBAL)]
    #[arg(long, value_name = "N", value_parser = values::whole(1..=u64::MAX), allow_negative_numbers = true)]
    pub(crate) iterations: Option<u64>,
    /// Fade surfaces into the background with distance
    ///
    /// The optional value, after an equals sign, is key=value,... with the keys color (a name,
    /// #rrggbb or r,g,b) instead of the background's; front and back, the distances from the viewer
    /// between which things fade (where the scene begins and ends, if left out); front-scale and
    /// back-scale, the share of its own light that a surface keeps there, 0 to 1 (1 and 0.2)
    #[arg(help_heading = help::PICTURE)]
    #[arg(long, value_name = "SPEC", value_parser = depth_cue::parse, num_args = 0..=1, require_equals = true, default_missing_value = "")]
    pub(crate) depth_cue: Option<DepthCue>,
    /// Draw edges alone, hidden ones included
    #[arg(help_heading = help::LINES)]
    #[arg(long, group = "lines")]
    pub(crate) wireframe: bool,
    /// Draw visible edges alone, and the lines where faces penetrate each other
    #[arg(help_heading = help::LINES)]
    #[arg(long, group = "lines")]
    pub(crate) wireframe_hidden_line: bool,
    /// Draw surfaces with their edges
    ///
    /// The lines where faces penetrate each other are drawn, too
    #[arg(help_heading = help::LINES)]
    #[arg(long, group = "lines")]
    pub(crate) edges: bool,
    /// Width of edges and of the model's own lines in pixels, 0.1 to 64 [default: 1.3]
    #[arg(help_heading = help::LINES)]
    #[arg(long, value_name = "PX", value_parser = values::line_width, allow_negative_numbers = true)]
    pub(crate) line_width: Option<f32>,
    /// Side of the squares that show the model's own points, in pixels, 0.1 to 64 [default: 3]
    #[arg(help_heading = help::LINES)]
    #[arg(long, value_name = "PX", value_parser = values::line_width, allow_negative_numbers = true)]
    pub(crate) point_size: Option<f32>,
    /// Colour of edges: a name, #rrggbb, or r,g,b from 0 to 1 [default: dark on a light background,
    /// light on a dark one]
    #[arg(help_heading = help::LINES)]
    #[arg(long, value_name = "COLOR", value_parser = values::color)]
    pub(crate) edge_color: Option<[f32; 3]>,
    #[arg(help_heading = help::LINES)]
    #[arg(long, value_name = "LIST", value_parser = line_classes, help = edge_classes_help())]
    pub(crate) edge_classes: Option<LineClasses>,
    /// Which vertex normals are used [default: file]
    #[arg(long, value_name = "KIND", value_parser = choices::normals())]
    pub(crate) normals: Option<Normals>,
    /// Where normals are computed: faces that meet at a larger angle have a sharp edge between
    /// them, 0 (every edge) to 180 (no edge) [default: 40]
    #[arg(long, value_name = "DEGREES", value_parser = values::half_turn, allow_negative_numbers = true)]
    pub(crate) crease_angle: Option<f64>,
}

/// Lights and materials.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::LIGHTS)]
pub(crate) struct LightArgs {
    #[arg(long, value_name = "KIND|FILE", value_parser = environment::parse, help = environment::help())]
    pub(crate) environment: Option<EnvironmentSource>,
    /// How the colours in MTL files are encoded [default: srgb; linear with --color-space raw]
    #[arg(help_heading = help::MATERIALS)]
    #[arg(long, value_name = "KIND", value_parser = choices::file_colors())]
    pub(crate) file_colors: Option<FileColors>,
    /// Lighting on or off; off, surfaces show their own colours [default: on]
    #[arg(long, value_name = "on|off", value_parser = values::switch, action = ArgAction::Set)]
    pub(crate) lighting: Option<bool>,
    /// A light, KIND:key=value,..., which replaces the default lights; repeatable
    ///
    /// It replaces the model's own lights, too. KIND is ambient, directional, point, spot or area.
    /// The keys are name, ambient, diffuse, specular (a number, r,g,b or a colour's name),
    /// attenuation (none, inverse-square, c1,c2,c3, gl,constant,linear,quadratic or
    /// range,distance), shadow, position, direction, cutoff (half angle of a spot's cone in
    /// degrees, 30 if left out), inner (half angle where its fall-off begins, cutoff if left out),
    /// exponent, center, normal, radius, corners
    #[arg(long, value_name = "SPEC", value_parser = light_spec::checked)]
    pub(crate) light: Vec<String>,
    #[arg(long, value_name = "LIGHT.FIELD=VALUE", value_parser = values::light_edit, help = light_edit_help())]
    pub(crate) light_edit: Vec<LightEdit>,
    /// Factor for all lights [default: 1; for lights of glTF files, which are in candela and lux,
    /// an exposure that suits the picture]
    #[arg(long, value_name = "FACTOR", value_parser = values::intensity, allow_negative_numbers = true)]
    pub(crate) light_intensity: Option<f32>,
    /// Show one term of all lights alone [default: all three]
    #[arg(long, value_name = "TERM", value_parser = choices::light_term())]
    pub(crate) light_term: Option<LightTerm>,
    /// What lights a model whose own lights leave all that is seen black: auto (a dim light from
    /// the viewer, with a warning) or none [default: auto]
    #[arg(long, value_name = "auto|none", value_parser = choices::fill_light(), conflicts_with = "light")]
    pub(crate) fill_light: Option<bool>,
    #[arg(help_heading = help::MATERIALS)]
    #[arg(long, value_name = "NAME.PROPERTY=VALUE", value_parser = values::material, help = material_help())]
    pub(crate) material: Vec<MaterialOverride>,
}

/// Rays of `--ambient-occlusion` where it says none: folds look even, at a few times the cost of a
/// picture with shadows.
const DEFAULT_RAYS: &str = "32";

/// The help of `--ambient-occlusion`.
fn occlusion_help() -> String {
    format!(
        "Ambient light, and that of the sky or the environment, is weakened where other surfaces are near: by so many rays from each \
         point, 1 to 4096 [default: off; {DEFAULT_RAYS} without a number]"
    )
}

/// The help of `--edge-classes`.
fn edge_classes_help() -> String {
    let names: Vec<&str> = LineClass::ALL.iter().map(|row| row.1).collect();
    format!(
        "Which edges are drawn with --edges and the wireframes: a list of {}, as in `vitral draw --lines`, with creases above 30 \
         degrees; smooth means every edge of a face [default: all]",
        names.join(", ")
    )
}

/// The help of `--light-edit`.
fn light_edit_help() -> String {
    let fields: Vec<&str> = vitral::light_fields().map(|(name, _)| name).collect();
    format!(
        "Change one field of one light, such as LIGHT0.diffuse=1,0,0, and keep its others; repeatable. LIGHT is a light's name, or \
         its number from 0 (2 or LIGHT2), * for all; FIELD is one of {} (docs/materials.md explains them)",
        fields.join(", ")
    )
}

/// The help of `--material`.
fn material_help() -> String {
    let properties: Vec<&str> = vitral::material_properties().map(|(name, _)| name).collect();
    format!(
        "Override a material's property, such as glass.opacity=0.5; repeatable. NAME is a material's, * for all, default for \
         surfaces without material; PROPERTY is one of {} (docs/materials.md explains them)",
        properties.join(", ")
    )
}

/// The viewer.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::CAMERA)]
pub(crate) struct CameraArgs {
    /// Side from which the model is framed [default: three-quarter; iso for parallel drawings]
    #[arg(long, value_name = "SIDE", value_parser = choices::view())]
    pub(crate) view: Option<View>,
    /// Axis that points up [default: +Y; +Z where the first model is STL]
    ///
    /// One of +X -X +Y -Y +Z -Z
    #[arg(long, value_name = "AXIS", value_parser = clap::value_parser!(Axis), allow_hyphen_values = true)]
    pub(crate) up: Option<Axis>,
    /// Use camera N of the model, counted from 0
    #[arg(long, value_name = "N", value_parser = values::whole(0..=u32::MAX as usize), allow_negative_numbers = true)]
    pub(crate) camera_index: Option<usize>,
    /// Position of the viewer
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) camera_position: Option<DVec3>,
    /// Point at which the viewer looks
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) camera_focal_point: Option<DVec3>,
    /// Direction that points up in the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = values::direction, allow_hyphen_values = true)]
    pub(crate) camera_view_up: Option<DVec3>,
    /// Vertical angle of view in degrees [default: 30]
    #[arg(long, value_name = "DEGREES", value_parser = values::view_angle, allow_negative_numbers = true)]
    pub(crate) camera_view_angle: Option<f64>,
    /// Direction in which the viewer looks; without --camera-focal-point the model is framed
    #[arg(long, value_name = "X,Y,Z", value_parser = values::direction, allow_hyphen_values = true)]
    #[arg(conflicts_with = "camera_position")]
    pub(crate) camera_direction: Option<DVec3>,
    /// Zoom in (above 1) or out (below 1) [default: 1]
    #[arg(long, value_name = "FACTOR", value_parser = values::positive, allow_negative_numbers = true)]
    pub(crate) camera_zoom_factor: Option<f64>,
    /// Move the viewer round the model by this angle in degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::number, allow_hyphen_values = true)]
    pub(crate) camera_azimuth_angle: Option<f64>,
    /// Move the viewer above the model by this angle in degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::number, allow_hyphen_values = true)]
    pub(crate) camera_elevation_angle: Option<f64>,
    /// Parallel projection
    #[arg(long)]
    pub(crate) camera_orthographic: bool,
    /// Show only the parts between these distances from the viewer, along the direction of view
    /// [default: all in front of the viewer]
    #[arg(long, value_name = "NEAR,FAR", value_parser = values::distances, allow_hyphen_values = true)]
    pub(crate) camera_clip: Option<(f64, f64)>,
}

/// The course's program Lab3D.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::LAB3D)]
pub(crate) struct LabArgs {
    /// Start from the scene, lights and settings of an exercise with Lab3D, the program of the
    /// graphics course that vitral follows; models and options override them
    #[arg(long, value_name = "NUMBER", value_parser = choices::exercise())]
    pub(crate) exercise: Option<&'static str>,
    #[command(flatten)]
    pub(crate) eye: EyeArgs,
    /// Rotate all objects together, but not the scene's own lights: degrees about x, then y, then z
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) all_rotation: Option<DVec3>,
    /// Move all objects together, after --all-rotation
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub(crate) all_translation: Option<DVec3>,
}

/// The eye of Lab3D.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::LAB3D)]
pub(crate) struct EyeArgs {
    /// Rotate the eye, which looks along -z at first: degrees about x, then y, then z. Without
    /// --eye-translation the model is framed
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true, conflicts_with_all = OTHER_CAMERAS)]
    pub(crate) eye_rotation: Option<DVec3>,
    /// Position of the eye
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true, conflicts_with_all = OTHER_CAMERAS)]
    pub(crate) eye_translation: Option<DVec3>,
}

/// Options that place a camera as the eye of Lab3D does.
const OTHER_CAMERAS: [&str; 5] =
    ["view", "camera_index", "camera_position", "camera_focal_point", "camera_direction"];

/// Files and limits.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::FILES)]
pub(crate) struct ProcessArgs {
    /// Let models read files outside their folder
    #[arg(long)]
    pub(crate) allow_external: bool,
    /// Show the model as an animation of its glTF file has it: the number from 0, or the name;
    /// `vitral info` lists them [default: the pose of the file]
    #[arg(help_heading = help::ANIMATION)]
    #[arg(long, value_name = "N|NAME")]
    pub(crate) animation: Option<String>,
    /// Moment of the animation in seconds; of the first animation if --animation is not given
    /// [default: 0]
    #[arg(help_heading = help::ANIMATION)]
    #[arg(long, value_name = "S", value_parser = values::not_negative, allow_negative_numbers = true)]
    pub(crate) animation_time: Option<f64>,
    /// Read defaults from this file [default: $XDG_CONFIG_HOME/vitral/config.json]
    #[arg(long, value_name = "FILE", conflicts_with = "no_config")]
    pub(crate) config: Option<PathBuf>,
    /// Read no configuration file
    #[arg(long)]
    pub(crate) no_config: bool,
    /// Write all settings to this file; relative paths of models in it begin in its folder
    #[arg(long, value_name = "FILE")]
    pub(crate) save_state: Option<PathBuf>,
    /// Read all settings from this file; options override them
    #[arg(long, value_name = "FILE")]
    pub(crate) load_state: Option<PathBuf>,
    /// Threads; 0 means as many as the process may use [default: VITRAL_THREADS, else 0]
    #[arg(help_heading = help::LIMITS)]
    #[arg(long, value_name = "N", value_parser = values::threads, allow_negative_numbers = true)]
    pub(crate) threads: Option<usize>,
    /// Stop after S seconds, with exit code 7; where each model gives a picture, each has S seconds
    #[arg(help_heading = help::LIMITS)]
    #[arg(long, value_name = "S", value_parser = values::positive, allow_negative_numbers = true)]
    pub(crate) time_limit: Option<f64>,
    /// Stop at this much memory, such as 512M or 1G, with exit code 7 [default: the limit of the
    /// machine or control group, where Linux tells it]
    #[arg(help_heading = help::LIMITS)]
    #[arg(long, value_name = "B", value_parser = values::bytes, allow_negative_numbers = true)]
    pub(crate) max_memory: Option<u64>,
}

/// Statistics, explanations, traces, progress.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = help::REPORTS)]
pub(crate) struct ReportArgs {
    /// Print counters and times as JSON on standard error: the seconds of each stage of each frame,
    /// and of loading, dumps and the explained pixel
    #[arg(long)]
    pub(crate) stats: bool,
    /// Write these counters and times into a file
    #[arg(long, value_name = "FILE")]
    pub(crate) stats_file: Option<PathBuf>,
    /// Explain a pixel on standard output
    ///
    /// It names the facets over the pixel and what became of each, shows how its light adds up to
    /// its bytes, and says what the algorithm decided there. With --shading gouraud it shows the
    /// increments of the intensity, and with --global ray-trace what each ray hits
    #[arg(long, value_name = "X,Y", value_parser = values::pixel, allow_hyphen_values = true)]
    pub(crate) pixel: Option<[u32; 2]>,
    /// With --pixel: what other algorithms decide there, each with a picture of its own: a list, or
    /// all. Each may take 20 s, or what --time-limit says [default: the --visibility algorithm, for
    /// the part of the picture round the pixel]
    #[arg(long, value_name = "LIST", value_parser = values::deciders, requires = "pixel")]
    pub(crate) pixel_algorithms: Option<Deciders>,
    /// Write the steps of the visibility algorithm into this file, one JSON object per line
    #[arg(long, value_name = "FILE")]
    pub(crate) trace: Option<PathBuf>,
    /// Draw the structure that the visibility algorithm builds as SVG: the quadtree of warnock, the
    /// list of painter, the tree of bsp; of the last frame
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) structure: Option<PathBuf>,
    /// Print the results as one JSON object on standard output
    #[arg(long)]
    pub(crate) json: bool,
    /// Report each step of the work, and how long it takes
    #[arg(long, short, conflicts_with = "quiet")]
    pub(crate) verbose: bool,
    /// Print no warnings
    #[arg(long, short)]
    pub(crate) quiet: bool,
    /// When to show a progress bar, for frames and for long stages of a picture [default: auto]
    #[arg(long, value_name = "WHEN", value_enum)]
    pub(crate) progress: Option<ProgressWhen>,
}

/// When a progress bar is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProgressWhen {
    /// On a terminal
    #[default]
    Auto,
    /// Even where standard error is no terminal
    Always,
    /// Not at all
    Never,
}
