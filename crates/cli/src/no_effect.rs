//! Options that were typed and change nothing beside the others: each is told in a warning.
//!
//! [`ROWS`] has a row for each pair of an option and a condition under which it does nothing. An
//! option that was not typed, or typed with the value that it has anyway, is never told; nor are
//! options that by their nature leave pictures as they are (`--cull`, `--coherence`, `--threads`,
//! ...).

use crate::environment::EnvironmentSource;
use crate::no_effect_camera;
use crate::render_args::RenderArgs;
use std::sync::Arc;
use vitral::{
    AlphaMode, AreaShape, Camera, Channels, ColorSpace, Environment, Global, GroundShadow,
    Illumination, Interpolation, Light, LightKind, LightTerm, Lines, Material, Normals, Projection,
    Reflectance, Renderer, Scene, Settings, Shading, State, Transmission, Transparency,
    TransparencyOrder, View, Viewpoint,
};

/// A row of the table: an option, a condition under which it has no effect, and the reason.
struct Row {
    /// As typed.
    option: &'static str,
    /// Whether it was typed, with another value than the one that holds without it.
    given: fn(&RenderArgs) -> bool,
    /// Whether it does nothing.
    idle: fn(&Case) -> bool,
    /// Why.
    why: &'static str,
}

const fn row(
    option: &'static str,
    given: fn(&RenderArgs) -> bool,
    idle: fn(&Case) -> bool,
    why: &'static str,
) -> Row {
    Row { option, given, idle, why }
}

const DARK: &str = "with --lighting off surfaces show their own colours";
const CONSTANT: &str = "with --illumination constant surfaces show their own colours";
const AMBIENT: &str = "with --illumination ambient no light has a direction";
const DATA: &str = "no colour picture is made";
const NO_EDGES: &str = "no edges are drawn: add --edges, --wireframe or --wireframe-hidden-line";
const WIRES: &str = "edges alone are drawn, in one colour";
const OPAQUE: &str = "with --transparency none every surface is opaque";
const SOLID: &str = "the models have no transparent surfaces";
const NO_CASTER: &str = "no light casts shadows";
const FLAT: &str = "with --shading flat each face has its own normal";
const ALL_EDGES: &str =
    "all edges are drawn, hidden ones included (--wireframe-hidden-line leaves them out)";
const RADIOSITY: &str = "radiosity computes what surfaces light each other with";
const NO_AMBIENT: &str = "no light comes from everywhere: name an ambient one, or an --environment";
const PARALLEL: &str = "the projection is parallel";

/// What does nothing beside what. Rows of one option stand together; the first that holds is told.
const ROWS: &[Row] = &[
    row(
        "--samples",
        gives_samples,
        Case::makes_no_color,
        "data channels have one sample per pixel",
    ),
    row("--background-color", |a| a.picture.background_color.is_some(), Case::makes_no_color, DATA),
    row("--no-background", |a| a.picture.no_background, Case::makes_no_color, DATA),
    row("--color-space", gives_color_space, Case::makes_no_color, DATA),
    row("--depth-cue", |a| a.algorithms.depth_cue.is_some(), Case::makes_no_color, DATA),
    row("--edges", |a| a.algorithms.edges, Case::makes_no_color, DATA),
    row(
        "--wireframe-hidden-line",
        |a| a.algorithms.wireframe_hidden_line,
        Case::makes_no_color,
        DATA,
    ),
    row(
        "--line-width",
        |a| a.algorithms.line_width.is_some(),
        |c| !c.has_lines(),
        "there are no lines: add --edges",
    ),
    row("--edge-color", |a| a.algorithms.edge_color.is_some(), |c| !c.draws_edges(), NO_EDGES),
    row("--edge-classes", |a| a.algorithms.edge_classes.is_some(), |c| !c.draws_edges(), NO_EDGES),
    row("--illumination", gives_illumination, Case::makes_no_color, DATA),
    row("--illumination", gives_illumination, Case::draws_wires, WIRES),
    row("--illumination", gives_illumination, |c| c.is_dark() && !c.is_constant(), DARK),
    row("--shading", gives_shading, Case::makes_no_color, DATA),
    row("--shading", gives_shading, Case::draws_wires, WIRES),
    row("--shading", gives_shading, |c| c.is_dark() && c.is_plain(), DARK),
    row("--shading", gives_shading, |c| c.is_constant() && c.is_plain(), CONSTANT),
    row("--interpolation", gives_interpolation, Case::makes_no_color, DATA),
    row("--interpolation", gives_interpolation, Case::draws_wires, WIRES),
    row("--interpolation", gives_interpolation, Case::is_parallel, PARALLEL),
    row("--transparency", gives_transparency, Case::makes_no_color, DATA),
    row("--transparency", gives_transparency, Case::draws_wires, WIRES),
    row("--transparency", gives_transparency, Case::is_solid, SOLID),
    row("--transparency-order", gives_order, Case::makes_no_color, DATA),
    row("--transparency-order", gives_order, Case::draws_wires, WIRES),
    row("--transparency-order", gives_order, Case::is_opaque, OPAQUE),
    row("--transparency-order", gives_order, Case::is_solid, SOLID),
    row("--kay-exponent", |a| a.algorithms.kay_exponent.is_some(), Case::is_solid, SOLID),
    row("--kay-exponent", |a| a.algorithms.kay_exponent.is_some(), Case::makes_no_color, DATA),
    row("--kay-exponent", |a| a.algorithms.kay_exponent.is_some(), Case::draws_wires, WIRES),
    row("--global", gives_global, |c| c.makes_no_color() && !c.shows_shadows(), DATA),
    row("--max-depth", |a| a.algorithms.max_depth.is_some(), Case::makes_no_color, DATA),
    row("--patch-size", |a| a.algorithms.patch_size.is_some(), Case::makes_no_color, DATA),
    row("--iterations", |a| a.algorithms.iterations.is_some(), Case::makes_no_color, DATA),
    row("--visibility", gives_visibility, |c| c.draws_all_edges() && c.has_no_steps(), ALL_EDGES),
    row(
        "--depth-bits",
        |a| a.algorithms.depth_bits.is_some(),
        |c| c.draws_all_edges() && c.has_no_steps(),
        ALL_EDGES,
    ),
    row(
        "--shadow-map-size",
        |a| a.algorithms.shadow_map_size.is_some(),
        |c| !c.casts_shadows(),
        NO_CASTER,
    ),
    row(
        "--shadow-cascades",
        |a| a.algorithms.shadow_cascades.is_some(),
        |c| !c.casts_shadows(),
        NO_CASTER,
    ),
    row(
        "--volume-counting",
        |a| a.algorithms.volume_counting.is_some(),
        |c| !c.casts_shadows(),
        NO_CASTER,
    ),
    row("--terminator", |a| a.algorithms.terminator.is_some(), |c| !c.casts_shadows(), NO_CASTER),
    row("--together", |a| a.output.together, |c| c.models < 2, "there is one model"),
    row("--scatter-samples", gives_scatter, Case::makes_no_color, DATA),
    row("--scatter-samples", gives_scatter, |c| c.is_opaque() && !c.scatters(), OPAQUE),
    row(
        "--scatter-samples",
        gives_scatter,
        |c| !c.scatters(),
        "the models have no translucent surfaces, and rays meet no metal",
    ),
    row("--shadows", gives_shadows, |c| c.makes_no_color() && !c.shows_shadows(), DATA),
    row("--shadows", gives_shadows, |c| c.draws_wires() && !c.shows_shadows(), WIRES),
    row("--shadows", gives_shadows, |c| c.is_dark() && !c.shows_shadows(), DARK),
    row("--shadows", gives_shadows, |c| c.is_constant() && !c.shows_shadows(), CONSTANT),
    row("--shadows", gives_shadows, |c| c.is_ambient() && !c.shows_shadows(), AMBIENT),
    row("--shadows", gives_shadows, |c| !c.casts_shadows(), NO_CASTER),
    row("--light-samples", gives_light_samples, |c| !c.has_areas(), "no light has an area"),
    row(
        "--light",
        |a| !a.light.light.is_empty(),
        |c| c.makes_no_color() && !c.shows_shadows(),
        DATA,
    ),
    row("--light", |a| !a.light.light.is_empty(), |c| c.is_dark() && !c.shows_shadows(), DARK),
    row(
        "--light",
        |a| !a.light.light.is_empty(),
        |c| c.is_constant() && !c.shows_shadows(),
        CONSTANT,
    ),
    row(
        "--light-edit",
        |a| !a.light.light_edit.is_empty(),
        |c| c.makes_no_color() && !c.shows_shadows(),
        DATA,
    ),
    row(
        "--light-edit",
        |a| !a.light.light_edit.is_empty(),
        |c| c.is_dark() && !c.shows_shadows(),
        DARK,
    ),
    row(
        "--light-edit",
        |a| !a.light.light_edit.is_empty(),
        |c| c.is_constant() && !c.shows_shadows(),
        CONSTANT,
    ),
    row("--light", |a| !a.light.light.is_empty(), |c| c.draws_wires() && !c.shows_shadows(), WIRES),
    row(
        "--light-edit",
        |a| !a.light.light_edit.is_empty(),
        |c| c.draws_wires() && !c.shows_shadows(),
        WIRES,
    ),
    row("--lighting", gives_lighting, Case::makes_no_color, DATA),
    row("--lighting", gives_lighting, Case::draws_wires, WIRES),
    row("--light-intensity", gives_intensity, Case::draws_wires, WIRES),
    row("--light-intensity", gives_intensity, Case::makes_no_color, DATA),
    row("--light-intensity", gives_intensity, Case::is_dark, DARK),
    row("--light-intensity", gives_intensity, Case::is_constant, CONSTANT),
    row("--light-term", |a| a.light.light_term.is_some(), Case::makes_no_color, DATA),
    row("--light-term", |a| a.light.light_term.is_some(), Case::is_dark, DARK),
    row("--light-term", |a| a.light.light_term.is_some(), Case::is_constant, CONSTANT),
    row("--environment", |a| a.light.environment.is_some(), Case::makes_no_color, DATA),
    row("--environment", |a| a.light.environment.is_some(), Case::draws_wires, WIRES),
    row("--environment", |a| a.light.environment.is_some(), Case::is_dark, DARK),
    row("--environment", |a| a.light.environment.is_some(), Case::has_radiosity, RADIOSITY),
    row(
        "--environment",
        gives_image,
        |c| c.shows_diffuse_term,
        "this term of the lights is not its own",
    ),
    row(
        "--environment",
        gives_surroundings,
        |c| !c.mirrors_surroundings(),
        "no surface has metal or roughness",
    ),
    row(
        "--ambient-occlusion",
        |a| a.algorithms.ambient_occlusion.is_some(),
        Case::makes_no_color,
        DATA,
    ),
    row(
        "--ambient-occlusion",
        |a| a.algorithms.ambient_occlusion.is_some(),
        Case::draws_wires,
        WIRES,
    ),
    row("--ambient-occlusion", |a| a.algorithms.ambient_occlusion.is_some(), Case::is_dark, DARK),
    row(
        "--ambient-occlusion",
        |a| a.algorithms.ambient_occlusion.is_some(),
        Case::is_constant,
        CONSTANT,
    ),
    row(
        "--ambient-occlusion",
        |a| a.algorithms.ambient_occlusion.is_some(),
        Case::has_radiosity,
        RADIOSITY,
    ),
    row(
        "--ambient-occlusion",
        |a| a.algorithms.ambient_occlusion.is_some(),
        |c| !c.has_ambient,
        NO_AMBIENT,
    ),
    row("--ground-shadow", gives_ground, Case::makes_no_color, DATA),
    row("--ground-shadow", gives_ground, Case::draws_wires, WIRES),
    row("--ground-shadow", gives_ground, Case::is_dark, DARK),
    row(
        "--ground-shadow",
        gives_ground,
        |c| c.lights_shade_ground && !c.casts_shadows(),
        NO_CASTER,
    ),
    row("--ground-shadow", gives_ground, |c| c.is_below_ground, "the viewer is below the ground"),
    row("--file-colors", |a| a.light.file_colors.is_some(), Case::makes_no_color, DATA),
    row("--file-colors", |a| a.light.file_colors.is_some(), Case::draws_wires, WIRES),
    row("--fill-light", gives_fill_light, Case::makes_no_color, DATA),
    row("--fill-light", gives_fill_light, Case::is_dark, DARK),
    row("--fill-light", gives_fill_light, Case::is_constant, CONSTANT),
    row("--normals", gives_normals, |c| c.makes_no_color() && !c.shows_normals(), DATA),
    row("--normals", gives_normals, |c| c.draws_wires() && !c.shows_normals(), WIRES),
    row("--normals", gives_normals, |c| c.is_dark() && c.is_solid() && !c.shows_normals(), DARK),
    row("--normals", gives_normals, |c| c.is_flat() && c.is_solid() && !c.shows_normals(), FLAT),
    row("--crease-angle", gives_crease, |c| c.makes_no_color() && !c.shows_normals(), DATA),
    row("--crease-angle", gives_crease, |c| c.draws_wires() && !c.shows_normals(), WIRES),
    row(
        "--crease-angle",
        gives_crease,
        |c| c.is_dark() && c.is_solid() && !c.shows_normals(),
        DARK,
    ),
    row(
        "--crease-angle",
        gives_crease,
        |c| c.is_flat() && c.is_solid() && !c.shows_normals(),
        FLAT,
    ),
    row(
        "--view",
        gives_view,
        Case::has_camera,
        "--camera-index or --camera-direction decides the view",
    ),
    row(
        "--up",
        |a| a.camera.up.is_some(),
        Case::has_own_up,
        "the camera of --camera-index has an upward direction of its own",
    ),
    row(
        "--camera-view-angle",
        |a| a.camera.camera_view_angle.is_some(),
        Case::is_parallel_without_angle,
        PARALLEL,
    ),
];

fn gives_fill_light(args: &RenderArgs) -> bool {
    args.light.fill_light == Some(false)
}

fn gives_ground(args: &RenderArgs) -> bool {
    args.algorithms.ground_shadow.is_some_and(|kind| kind != GroundShadow::None)
}

/// An image of the surroundings, or the sky where it is not by itself.
fn gives_surroundings(args: &RenderArgs) -> bool {
    gives_image(args) || args.light.environment == Some(EnvironmentSource::Kind(Environment::Sky))
}

fn gives_image(args: &RenderArgs) -> bool {
    matches!(args.light.environment, Some(EnvironmentSource::File(_)))
}

fn gives_lighting(args: &RenderArgs) -> bool {
    args.light.lighting == Some(false)
}

fn gives_global(args: &RenderArgs) -> bool {
    args.algorithms.global.is_some_and(|model| model != Global::None)
}

fn gives_visibility(args: &RenderArgs) -> bool {
    args.algorithms.visibility.is_some_and(|algorithm| algorithm != Settings::default().visibility)
}

fn gives_samples(args: &RenderArgs) -> bool {
    args.picture.samples.is_some_and(|count| count != Settings::default().picture.samples)
}

fn gives_color_space(args: &RenderArgs) -> bool {
    args.picture.color_space.is_some_and(|space| space != ColorSpace::default())
}

fn gives_illumination(args: &RenderArgs) -> bool {
    args.algorithms.illumination.is_some_and(|model| model != Illumination::default())
}

fn gives_shading(args: &RenderArgs) -> bool {
    args.algorithms.shading.is_some_and(|model| model != Shading::default())
}

fn gives_interpolation(args: &RenderArgs) -> bool {
    args.algorithms.interpolation.is_some_and(|kind| kind != Interpolation::default())
}

fn gives_transparency(args: &RenderArgs) -> bool {
    args.algorithms.transparency.is_some_and(|model| model != Transparency::default())
}

fn gives_order(args: &RenderArgs) -> bool {
    args.algorithms.transparency_order.is_some_and(|order| order != TransparencyOrder::default())
}

fn gives_scatter(args: &RenderArgs) -> bool {
    args.algorithms
        .scatter_samples
        .is_some_and(|count| count != Settings::default().transparency.scatter_samples)
}

fn gives_shadows(args: &RenderArgs) -> bool {
    args.algorithms.shadows.is_some_and(|algorithm| !algorithm.is_none)
}

fn gives_light_samples(args: &RenderArgs) -> bool {
    args.algorithms
        .light_samples
        .is_some_and(|count| count != Settings::default().shadows.light_samples)
}

fn gives_intensity(args: &RenderArgs) -> bool {
    args.light.light_intensity.is_some_and(|factor| factor != 1.0)
}

fn gives_normals(args: &RenderArgs) -> bool {
    args.algorithms.normals.is_some_and(|normals| normals != Normals::default())
}

fn gives_crease(args: &RenderArgs) -> bool {
    args.algorithms.crease_angle.is_some()
}

fn gives_view(args: &RenderArgs) -> bool {
    args.camera.view.is_some_and(|view| view != View::default())
}

/// The picture that conditions are about: its settings, scene, camera and lights.
struct Case {
    /// An explained pixel or a dump tells of light and normals, whatever channels are made.
    told: bool,
    /// Panels or a file show shadows by themselves.
    files: bool,
    viewpoint: Viewpoint,
    /// Views are made from all around.
    turns: bool,
    /// How many models there are.
    models: usize,
    /// The steps of the visibility algorithm are written.
    traces: bool,
    settings: Settings,
    scene: Arc<Scene>,
    camera: Camera,
    lights: Vec<Light>,
    /// One term of all lights is shown, to which the image of the surroundings adds nothing.
    shows_diffuse_term: bool,
    /// Some light comes from everywhere.
    has_ambient: bool,
    /// The shadow on the ground is that of the lights.
    lights_shade_ground: bool,
    /// The ground shows its back.
    is_below_ground: bool,
}

impl Case {
    fn new(args: &RenderArgs, state: &State, renderer: &Renderer) -> Self {
        let camera = renderer.frame_camera();
        Self {
            told: args.report.pixel.is_some() || args.output.dump.is_some(),
            files: args.output.panels || args.output.export_shadow_polygons.is_some(),
            viewpoint: state.viewpoint.clone(),
            turns: state.turntable.is_some(),
            models: state.models.len(),
            traces: args.report.trace.is_some()
                || args.report.structure.is_some()
                || args.output.steps_video.is_some(),
            settings: renderer.settings.clone(),
            scene: Arc::clone(renderer.scene()),
            camera,
            lights: renderer.frame_lights(&camera),
            shows_diffuse_term: renderer.light_term == Some(LightTerm::Diffuse),
            has_ambient: renderer.has_ambient_light(&camera),
            lights_shade_ground: renderer.ground_shadow() == GroundShadow::Lights,
            is_below_ground: renderer.is_below_ground(&camera),
        }
    }

    /// Whether all that comes out are channels of data.
    fn makes_no_color(&self) -> bool {
        let channels = self.settings.picture.channels;
        !(channels.color || channels.steps || self.told)
    }

    /// Whether shadows are shown by themselves.
    fn shows_shadows(&self) -> bool {
        self.told || self.files || self.settings.picture.channels.any_shadow()
    }

    /// Whether normals are shown by themselves.
    fn shows_normals(&self) -> bool {
        self.told || self.settings.picture.channels.normal
    }

    fn draws_wires(&self) -> bool {
        matches!(self.settings.picture.lines, Lines::Wireframe | Lines::WireframeHiddenLine)
    }

    fn draws_edges(&self) -> bool {
        self.settings.picture.lines != Lines::None
    }

    /// Whether edges are drawn, or the model has lines of its own.
    fn has_lines(&self) -> bool {
        self.draws_edges() || self.scene.meshes.iter().any(|mesh| !mesh.lines.is_empty())
    }

    fn draws_all_edges(&self) -> bool {
        self.settings.picture.lines == Lines::Wireframe
    }

    /// Whether nothing but a colour picture comes of the visibility algorithm.
    fn has_no_steps(&self) -> bool {
        let channels = self.settings.picture.channels;
        let only_color = Channels { color: true, ..Channels::default() };
        channels == only_color && !self.traces && !self.told
    }

    fn is_dark(&self) -> bool {
        !self.settings.shading.lighting
    }

    fn is_constant(&self) -> bool {
        self.settings.shading.illumination == Illumination::Constant
    }

    /// Whether light between surfaces takes the place of all light from everywhere.
    fn has_radiosity(&self) -> bool {
        self.settings.global.model == Global::Radiosity
    }

    /// Whether some surface shows the surroundings of the scene: by its roughness, or by rays that
    /// it turns.
    fn mirrors_surroundings(&self) -> bool {
        let illumination = self.settings.shading.illumination;
        let is_rough = |m: &Material| {
            illumination.for_reflectance(&m.reflectance) == Illumination::CookTorrance && !m.unlit
        };
        let turns_rays = |m: &Material| m.mirror || m.alpha_mode == AlphaMode::Blend;
        let is_traced = self.settings.global.model == Global::RayTrace;
        let materials = &self.scene.materials;
        let default = Material::default();
        materials.iter().chain([&default]).any(|m| is_rough(m) || (is_traced && turns_rays(m)))
    }

    fn is_ambient(&self) -> bool {
        self.settings.shading.illumination == Illumination::Ambient
    }

    fn is_flat(&self) -> bool {
        self.settings.shading.model == Shading::Flat && self.settings.global.model == Global::None
    }

    /// Whether each surface has one colour: no texture, no colours of vertices.
    fn is_plain(&self) -> bool {
        let scene = &self.scene;
        scene.textures.is_empty() && scene.meshes.iter().all(|mesh| mesh.colors.is_none())
    }

    fn is_opaque(&self) -> bool {
        self.settings.transparency.model == Transparency::None
    }

    /// Whether all that is drawn is faces of which none is seen through.
    fn is_solid(&self) -> bool {
        let scene = &self.scene;
        let opaque =
            scene.materials.iter().all(|material| material.alpha_mode == AlphaMode::Opaque);
        let faces = scene.meshes.iter().all(|mesh| mesh.lines.is_empty() && mesh.points.is_empty());
        opaque && faces && self.settings.picture.lines == Lines::None
    }

    fn scatters(&self) -> bool {
        let scene = &self.scene;
        let traced = self.settings.global.model == Global::RayTrace;
        scene.materials.iter().any(|material| {
            let is_metal = matches!(material.reflectance, Reflectance::MetallicRoughness { .. });
            material.transmission == Transmission::Translucent || (traced && is_metal)
        })
    }

    fn casts_shadows(&self) -> bool {
        self.lights
            .iter()
            .any(|light| light.enabled && light.shadow && light.kind != LightKind::Ambient)
    }

    fn has_areas(&self) -> bool {
        let is_point =
            |shape: &AreaShape| matches!(shape, AreaShape::Disc { radius, .. } if *radius == 0.0);
        self.lights
            .iter()
            .any(|light| matches!(&light.kind, LightKind::Area { shape } if !is_point(shape)))
    }

    fn is_parallel(&self) -> bool {
        matches!(self.camera.projection, Projection::Parallel { .. })
    }

    /// Whether an angle of view has no say in a parallel projection: it has one where it opens a
    /// camera of the model first.
    fn is_parallel_without_angle(&self) -> bool {
        let viewpoint = &self.viewpoint;
        let opened = viewpoint.camera_index.is_some() && viewpoint.orthographic;
        self.is_parallel() && !opened
    }

    /// Whether a camera of the model says which way is up, and nothing else asks for it.
    fn has_own_up(&self) -> bool {
        self.viewpoint.camera_index.is_some()
            && !self.turns
            && self.settings.global.model != Global::Radiosity
    }

    /// Whether the direction of view comes from elsewhere than from a side.
    fn has_camera(&self) -> bool {
        let viewpoint = &self.viewpoint;
        let alone = viewpoint.direction.is_some()
            && viewpoint.position.is_none()
            && viewpoint.focal_point.is_none();
        viewpoint.camera_index.is_some() || alone
    }
}

/// A warning for each option that was typed and changes nothing.
pub(crate) fn warnings(args: &RenderArgs, state: &State, renderer: &mut Renderer) -> Vec<String> {
    // Of each option tell the first row that holds.
    let case = Case::new(args, state, renderer);
    let mut told: Vec<(&str, &str)> = Vec::new();
    for row in ROWS {
        if told.iter().all(|(option, _)| *option != row.option)
            && (row.given)(args)
            && (row.idle)(&case)
        {
            told.push((row.option, row.why));
        }
    }

    // The camera's options are tried.
    for (option, why) in no_effect_camera::idle(&args.camera, state, renderer) {
        if told.iter().all(|(other, _)| *other != option)
            && (option != "--view" || gives_view(args))
        {
            told.push((option, why));
        }
    }
    told.into_iter().map(|(option, why)| format!("{option}: no effect, {why}")).collect()
}
