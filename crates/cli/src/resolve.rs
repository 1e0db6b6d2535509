//! From options as typed to a whole plan: defaults, then the configuration file, then the state
//! file, then the options.

use crate::animation_frames;
use crate::compare_command;
use crate::environment::EnvironmentSource;
use crate::light_spec;
use crate::machine;
use crate::models;
use crate::outputs::{FRAMES_HINT, Output, model_name};
use crate::render_args::{
    AlgorithmArgs, CameraArgs, EyeArgs, LabArgs, LightArgs, PictureArgs, ProcessArgs, RenderArgs,
};
use crate::report::{self, Failure};
use crate::{step_pictures, values};
use std::io::ErrorKind;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use vitral::internals::render::registry;
use vitral::internals::render::trace::structure::drawer;
use vitral::{
    Background, Channel, Channels, ColorSpace, Environment, Execution, FileColors, Global,
    GroundShadow, Lines, Normals, Plane, Settings, State, Transparency, Viewpoint, Visibility,
};

/// Largest configuration or state file, in bytes.
const MAX_STATE_BYTES: u64 = 64 << 20;

/// All that `vitral render` is to do.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    /// Models, viewpoint, lights, settings.
    pub(crate) state: State,
    /// The models' names as typed.
    pub(crate) models: Vec<PathBuf>,
    /// Whether each model gives pictures of its own.
    pub(crate) apart: bool,
    /// Where the channels go.
    pub(crate) outputs: Vec<Output>,
    /// Which frames of how many.
    pub(crate) frames: RangeInclusive<u32>,
    /// Views of the whole turn or animation; else 1.
    pub(crate) views: u32,
    /// Where the pictures after one step after the other go.
    pub(crate) steps_video: Option<Output>,
    /// The picture that others are compared with.
    pub(crate) reference: Option<Plane<[u8; 4]>>,
}

/// Resolves the options.
pub(crate) fn resolve(args: &RenderArgs) -> Result<Plan, Failure> {
    let mut state = State::default();
    overlay_files(&mut state, &args.process)?;
    set_options(&mut state, args)?;

    // Outputs decide which channels are rendered.
    let outputs = Output::pair(&args.output.output, &args.output.channel, &args.output.format)?;
    let mut channels = Channels {
        color: args.output.reference.is_some() || outputs.is_empty(),
        ..Channels::default()
    };
    outputs.iter().for_each(|o| o.channel.request(&mut channels));
    state.settings.picture.channels = channels;

    // Refuse what does not fit together.
    check_pictures_are_made(args, &state, &outputs)?;
    state.settings.check().map_err(|e| vitral::Error::from(vitral::RenderError::from(e)))?;
    check_standard_output(args, &outputs)?;
    check_background_and_pixel(args, &state, &outputs)?;
    step_pictures::check(args, &outputs)?;
    let video = args.output.steps_video.as_deref();
    let steps_video = video
        .map(|pattern| Output::sequence("--steps-video", pattern, &args.output.format))
        .transpose()?;

    if args.output.animation_frames.is_some() {
        state.turntable = None;
        state.load.animation_time = state.load.animation_time.or(Some(0.0));
    }
    let turned = state.turntable.unwrap_or(1).clamp(1, 1_000_000) as u32;
    let views = args.output.animation_frames.unwrap_or(turned);
    let frames = frames_of(args, views, &outputs, steps_video.as_ref())?;
    let models = models::named(&args.models, &state);
    let patterns = outputs.iter().chain(&steps_video).map(Output::pattern);
    let apart = models::are_apart(&models, args.output.together, patterns);
    animation_frames::check(&args.output, &models, apart)?;
    if apart {
        check_models_apart(args, &models, outputs.iter().chain(&steps_video), *frames.start())?;
    }
    let checked = if apart { &models[..] } else { &models[..models.len().min(1)] };
    check_files(args, checked, outputs.iter().chain(&steps_video), &frames)?;
    let reference = args.output.reference.as_deref().map(compare_command::read).transpose()?;
    Ok(Plan { state, models, apart, outputs, frames, views, steps_video, reference })
}

/// Refuses what cannot be done for each of several models: reports about one scene, outputs that
/// all would write.
fn check_models_apart<'o>(
    args: &RenderArgs,
    models: &[PathBuf],
    outputs: impl Iterator<Item = &'o Output>,
    frame: u32,
) -> Result<(), Failure> {
    let (output, report) = (&args.output, &args.report);
    let of_one_scene = [
        ("--dump", output.dump.is_some()),
        ("--export-shadow-polygons", output.export_shadow_polygons.is_some()),
        ("--save-radiosity", output.save_radiosity.is_some()),
        ("--load-radiosity", output.load_radiosity.is_some()),
        ("--reference", output.reference.is_some()),
        ("--pixel", report.pixel.is_some()),
        ("--trace", report.trace.is_some()),
        ("--structure", report.structure.is_some()),
    ];
    if let Some((option, _)) = of_one_scene.iter().find(|(_, given)| *given) {
        return Err(models::refuse_for_each(option));
    }
    for output in outputs {
        if !output.names_models() {
            let what = format!(
                "--output {}: every model would be written to this file",
                output.pattern().display()
            );
            return Err(
                Failure::usage(what).with_hint("put {model} into its name, or add --together")
            );
        }
        models::check_files(models, |model| output.path(model, frame))?;
    }
    Ok(())
}

/// How to compute, within the limits that were typed; `listener` is told how far it is.
pub(crate) fn execution_within(
    process: &ProcessArgs,
    listener: Option<Arc<vitral::Progress>>,
) -> Result<Execution, Failure> {
    let mut execution = values::execution_from(process.threads)?;
    execution.budget = execution
        .budget
        .with_time_limit(process.time_limit)
        .with_memory_limit(process.max_memory.or_else(machine::memory));
    if let Some(listener) = listener {
        execution.budget = execution.budget.with_progress(listener);
    }
    Ok(execution)
}

/// Lays the configuration file and the state file over the state.
pub(crate) fn overlay_files(state: &mut State, args: &ProcessArgs) -> Result<(), Failure> {
    if let Some(config) = config_file(args)? {
        overlay(state, &config, "--config")?;
    }
    if let Some(file) = &args.load_state {
        overlay(state, file, "--load-state")?;
    }
    Ok(())
}

/// Lays the options over the state.
pub(crate) fn set_options(state: &mut State, args: &RenderArgs) -> Result<(), Failure> {
    if !args.models.is_empty() {
        state.models = models::in_unicode(&args.models);
    }
    if let Some(number) = args.lab.exercise {
        state.start_exercise(number)?;
    }
    set_picture(state, &args.picture);
    set_algorithms(state, &args.algorithms)?;
    let files = [
        ("--save-radiosity", &args.output.save_radiosity),
        ("--load-radiosity", &args.output.load_radiosity),
    ];
    if let Some((option, _)) = files.iter().find(|(_, file)| file.is_some())
        && state.settings.global.model != Global::Radiosity
    {
        return Err(no_radiosity(option));
    }
    set_lights(state, &args.light)?;
    set_viewpoint(&mut state.viewpoint, &args.camera, &args.lab.eye);
    set_lab(state, &args.lab);
    set_reading(state, &args.process);
    if let Some(limit) = args.process.max_memory {
        state.load.max_file_bytes = state.load.max_file_bytes.min(limit);
        // Layers are dropped with a warning rather than that the picture fails.
        state.settings.transparency.layer_memory =
            state.settings.transparency.layer_memory.min(limit / 2);
    }
    if let Some(views) = args.output.turntable {
        state.turntable = Some(views as usize);
    }
    Ok(())
}

/// Refuses options about pictures that are not made.
fn check_pictures_are_made(
    args: &RenderArgs,
    state: &State,
    outputs: &[Output],
) -> Result<(), Failure> {
    let output = &args.output;
    for (option, file) in [("--trace", &args.report.trace), ("--structure", &args.report.structure)]
    {
        if let Some(file) = file.as_ref().filter(|_| outputs.is_empty()) {
            let message = format!("{option} {}: no picture is made", file.display());
            return Err(Failure::usage(message).with_hint("give --output"));
        }
    }
    let visibility = state.settings.visibility;
    if args.report.structure.is_some() && drawer(visibility).is_none() {
        let message =
            format!("--structure: the algorithm {visibility} builds no structure to draw");
        let drawn: Vec<_> =
            Visibility::all().filter(|v| drawer(*v).is_some()).map(|v| v.name).collect();
        return Err(
            Failure::usage(message).with_hint(format!("give --visibility {}", drawn.join(" or ")))
        );
    }
    if let Some(other) = outputs.iter().find(|o| output.panels && o.channel != Channel::Color) {
        return Err(Failure::usage(format!(
            "--panels makes colour pictures, not the channel {}",
            other.channel.name()
        )));
    }
    if output.panels && outputs.is_empty() {
        return Err(Failure::usage("--panels: no picture is made").with_hint("give --output"));
    }
    let drawn = !outputs.is_empty() || output.reference.is_some();
    if output.save_radiosity.is_some() && !(drawn && state.settings.picture.channels.color) {
        return Err(Failure::usage("--save-radiosity: no colour picture is made")
            .with_hint("give --output"));
    }
    Ok(())
}

/// Refuses a transparent background in a format without transparency, and a pixel outside the
/// picture.
fn check_background_and_pixel(
    args: &RenderArgs,
    state: &State,
    outputs: &[Output],
) -> Result<(), Failure> {
    if let Some(opaque) =
        outputs.iter().find(|o| args.picture.no_background && !o.keeps_transparency())
    {
        let what =
            format!("--no-background: {} files cannot be transparent", opaque.format().name());
        return Err(Failure::usage(what).with_hint("write a .png, or give --background-color"));
    }
    let [width, height] = [state.settings.picture.width, state.settings.picture.height];
    if let Some([x, y]) = args.report.pixel.filter(|[x, y]| *x >= width || *y >= height) {
        return Err(Failure::usage(format!(
            "--pixel {x},{y}: the picture has {width}x{height} pixels"
        ))
        .with_hint("they are counted from 0"));
    }
    Ok(())
}

/// The frames to render of a turntable or animation with this many views; each needs a name of its
/// own.
fn frames_of(
    args: &RenderArgs,
    views: u32,
    outputs: &[Output],
    steps_video: Option<&Output>,
) -> Result<RangeInclusive<u32>, Failure> {
    let sequence = if args.output.animation_frames.is_some() { "animation" } else { "turntable" };
    let frames = args.output.frames.clone().unwrap_or(0..=views - 1);
    if *frames.end() >= views {
        return Err(Failure::usage(format!(
            "--frames {}: the {sequence} has {views} frames",
            frames.end()
        ))
        .with_hint("they are counted from 0"));
    }
    if frames.end() > frames.start() && outputs.iter().any(|o| !o.holds_frames()) {
        let what = format!("--output has room for one picture, and the {sequence} has {views}");
        return Err(Failure::usage(what).with_hint(FRAMES_HINT));
    }
    if let Some(animation) =
        outputs.iter().find(|o| frames.end() > frames.start() && o.is_animation())
        && args.output.reference.is_some()
    {
        let what = format!("--reference: {} holds several pictures", animation.pattern().display());
        return Err(Failure::usage(what).with_hint("compare single frames"));
    }
    let several = frames.end() > frames.start() || args.output.steps_video.is_some();
    let is_animated = outputs.iter().chain(steps_video).any(Output::is_animation);
    if args.output.frame_rate.is_some() && !(several && is_animated) {
        return Err(Failure::usage("--frame-rate: no animation is written").with_hint(
            "give --turntable, --animation-frames or --steps-video, and a .gif, .webp or .apng",
        ));
    }
    Ok(frames)
}

/// Whether all that is written has a place: nobody wants to hear of a mistyped folder after hours
/// of work.
fn check_files<'o>(
    args: &RenderArgs,
    models: &[PathBuf],
    mut outputs: impl Iterator<Item = &'o Output>,
    frames: &RangeInclusive<u32>,
) -> Result<(), Failure> {
    let names: Vec<_> = match models {
        [] => vec![model_name(Path::new(""))],
        models => models.iter().map(|model| model_name(model)).collect(),
    };
    outputs.try_for_each(|output| {
        names.iter().try_for_each(|model| output.check_places(model, frames.clone()))
    })?;
    let stats = args.report.stats_file.as_ref().filter(|file| !report::is_standard(file));
    let files =
        [stats, args.output.save_radiosity.as_ref(), args.output.export_shadow_polygons.as_ref()];
    files.into_iter().flatten().try_for_each(|file| Ok(vitral::picture::check_place(file)?))
}

/// Standard output holds one thing; an explained pixel goes into the object of `--json`.
fn check_standard_output(args: &RenderArgs, outputs: &[Output]) -> Result<(), Failure> {
    let report = &args.report;
    let is_standard = |file: &Option<PathBuf>| file.as_deref().is_some_and(report::is_standard);
    let wanted = [
        (report.json, "--json"),
        (report.pixel.is_some() && !report.json, "--pixel"),
        (outputs.iter().any(Output::is_standard), "--output -"),
        (is_standard(&args.process.save_state), "--save-state -"),
        (is_standard(&report.stats_file), "--stats-file -"),
        (is_standard(&report.trace), "--trace -"),
        (is_standard(&report.structure), "--structure -"),
    ];
    let mut wanted = wanted.iter().filter(|(wants, _)| *wants).map(|(_, option)| option);
    match (wanted.next(), wanted.next()) {
        (Some(one), Some(other)) => {
            Err(Failure::usage(format!("{one} and {other} both write to standard output")))
        }
        _ => Ok(()),
    }
}

/// Writes the state into the file that `--save-state` names.
pub(crate) fn save_state(state: &State, models: &[PathBuf], file: &Path) -> Result<(), Failure> {
    if let Some(odd) = models.iter().find(|model| model.to_str().is_none()) {
        let what = format!(
            "--save-state: the name {} is not Unicode, which JSON cannot hold",
            odd.display()
        );
        return Err(Failure::usage(what).with_hint("rename the model, or name a link to it"));
    }
    let mut state = state.clone();
    if let Some(folder) = file.parent().filter(|_| !report::is_standard(file)) {
        state.leave_for(folder);
    }
    report::write(file, state.to_json().as_bytes())
}

/// The configuration file to use, if any: the one that was named, else the user's if it exists.
fn config_file(args: &ProcessArgs) -> Result<Option<PathBuf>, Failure> {
    if args.no_config {
        return Ok(None);
    }
    if let Some(file) = &args.config {
        return Ok(Some(file.clone()));
    }
    let folder = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let base =
        folder("XDG_CONFIG_HOME").or_else(|| folder("HOME").map(|home| home.join(".config")));
    Ok(base.map(|b| b.join("vitral").join("config.json")).filter(|f| f.is_file()))
}

/// The text of a state file; `option` names it.
pub(crate) fn read_state(file: &Path, option: &str) -> Result<String, Failure> {
    let bytes = vitral::read(file, MAX_STATE_BYTES).map_err(|e| {
        let is_missing = matches!(&e, vitral::Error::Read { source, .. } if source.kind() == ErrorKind::NotFound);
        let failure = Failure::from(e);
        let hint = || format!("{option} takes a file that --save-state wrote");
        if is_missing { failure.or_hint(hint) } else { failure }
    })?;
    let not_text = |_| vitral::Error::State {
        file: file.to_string_lossy().into_owned(),
        place: String::new(),
        what: "not UTF-8 text".to_owned(),
    };
    Ok(String::from_utf8(bytes).map_err(not_text)?)
}

/// Lays a file over the state; `option` names it.
fn overlay(state: &mut State, file: &Path, option: &str) -> Result<(), Failure> {
    let (name, text) = (file.to_string_lossy(), read_state(file, option)?);
    let before = std::mem::take(&mut state.models);
    state.overlay(&text, &name)?;
    if state.models.is_empty() {
        state.models = before;
    } else {
        state.enter(file.parent().unwrap_or(Path::new("")));
    }
    Ok(())
}

fn set_picture(state: &mut State, args: &PictureArgs) {
    let settings = &mut state.settings;
    if let Some([width, height]) = args.resolution {
        (settings.picture.width, settings.picture.height) = (width, height);
    }
    settings.picture.samples = args.samples.unwrap_or(settings.picture.samples);
    settings.picture.color_space = args.color_space.unwrap_or(settings.picture.color_space);
    if let Some(color) = args.background_color {
        settings.picture.background = Background::Color { color };
    }
    if args.no_background {
        settings.picture.background = Background::Transparent;
    }
}

fn set_algorithms(state: &mut State, args: &AlgorithmArgs) -> Result<(), Failure> {
    set_surfaces(&mut state.settings, args);
    set_transparency(&mut state.settings, args)?;
    set_global(&mut state.settings, args)?;
    set_shadows(&mut state.settings, args)?;
    set_normals(state, args)
}

/// Which surfaces are seen, and how they are shaded.
fn set_surfaces(settings: &mut Settings, args: &AlgorithmArgs) {
    settings.visibility = args.visibility.unwrap_or(settings.visibility);
    settings.depth_bits = args.depth_bits.or(settings.depth_bits);
    settings.acceleration = args.acceleration.or(settings.acceleration);
    if let Some(values::CoherenceList(kinds)) = &args.coherence {
        settings.coherence.clone_from(kinds);
    }
    settings.cull = args.cull.unwrap_or(settings.cull);
    settings.shading.illumination = args.illumination.unwrap_or(settings.shading.illumination);
    settings.shading.model = args.shading.unwrap_or(settings.shading.model);
    settings.shading.interpolation = args.interpolation.unwrap_or(settings.shading.interpolation);
    settings.picture.depth_cue = args.depth_cue.or(settings.picture.depth_cue);
    let lines = [
        (args.wireframe, Lines::Wireframe),
        (args.wireframe_hidden_line, Lines::WireframeHiddenLine),
        (args.edges, Lines::Edges),
    ];
    if let Some((_, chosen)) = lines.into_iter().find(|l| l.0) {
        settings.picture.lines = chosen;
    }
    settings.picture.line_width = args.line_width.unwrap_or(settings.picture.line_width);
    settings.picture.point_size = args.point_size.unwrap_or(settings.picture.point_size);
    settings.picture.edge_color = args.edge_color.or(settings.picture.edge_color);
    settings.picture.edge_classes = args.edge_classes.unwrap_or(settings.picture.edge_classes);
}

fn set_transparency(settings: &mut Settings, args: &AlgorithmArgs) -> Result<(), Failure> {
    settings.transparency.model = args.transparency.unwrap_or(settings.transparency.model);
    if args.kay_exponent.is_some() && settings.transparency.model != Transparency::Kay {
        return Err(Failure::usage("--kay-exponent: it needs Kay's model of transparency")
            .with_hint("add --transparency kay"));
    }
    settings.transparency.kay_exponent =
        args.kay_exponent.unwrap_or(settings.transparency.kay_exponent);
    settings.transparency.order = args.transparency_order.unwrap_or(settings.transparency.order);
    settings.transparency.scatter_samples =
        args.scatter_samples.unwrap_or(settings.transparency.scatter_samples);
    Ok(())
}

/// Global illumination and its parameters.
fn set_global(settings: &mut Settings, args: &AlgorithmArgs) -> Result<(), Failure> {
    if let Some(global) = args.global {
        // Each model comes with its own shadows, unless others are chosen.
        let row = registry::GLOBALS.iter().find(|row| row.value == global);
        if let Some(row) =
            row.filter(|row| args.shadows.is_none() && row.value != settings.global.model)
        {
            settings.shadows.algorithm = row.shadows;
        }
        settings.global.model = global;
    }
    if let Some(depth) = args.max_depth {
        if settings.global.model != Global::RayTrace {
            return Err(Failure::usage("--max-depth: no rays are traced")
                .with_hint("add --global ray-trace"));
        }
        settings.global.max_depth = depth;
    }
    let radiosity = settings.global.model == Global::Radiosity;
    for (option, given) in
        [("--patch-size", args.patch_size.is_some()), ("--iterations", args.iterations.is_some())]
    {
        if given && !radiosity {
            return Err(no_radiosity(option));
        }
    }
    settings.global.patch_size = args.patch_size.or(settings.global.patch_size);
    settings.global.iterations = args.iterations.or(settings.global.iterations);
    Ok(())
}

/// What weakens ambient light.
fn set_occlusion(settings: &mut Settings, args: &AlgorithmArgs) -> Result<(), Failure> {
    let shading = &mut settings.shading;
    shading.ambient_occlusion = args.ambient_occlusion.or(shading.ambient_occlusion);
    if args.occlusion_radius.is_some() && shading.ambient_occlusion.is_none() {
        let what = "--occlusion-radius: ambient light is not weakened";
        return Err(Failure::usage(what).with_hint("add --ambient-occlusion"));
    }
    shading.occlusion_radius = args.occlusion_radius.or(shading.occlusion_radius);
    Ok(())
}

/// The shadow algorithm and its parameters; global illumination may have chosen the algorithm.
fn set_shadows(settings: &mut Settings, args: &AlgorithmArgs) -> Result<(), Failure> {
    settings.shadows.algorithm = args.shadows.unwrap_or(settings.shadows.algorithm);
    settings.shadows.ground = args.ground_shadow.unwrap_or(settings.shadows.ground);
    set_occlusion(settings, args)?;
    let has_ground = settings.shadows.ground != GroundShadow::None;
    if args.light_samples.is_some() && settings.shadows.algorithm.is_none && !has_ground {
        return Err(Failure::usage("--light-samples: no shadows are computed")
            .with_hint("add --shadows ray"));
    }
    if args.terminator.is_some() && settings.shadows.algorithm.is_none {
        return Err(
            Failure::usage("--terminator: no shadows are computed").with_hint("add --shadows ray")
        );
    }
    settings.shadows.terminator = args.terminator.unwrap_or(settings.shadows.terminator);
    settings.shadows.light_samples = args.light_samples.unwrap_or(settings.shadows.light_samples);
    let of_maps =
        [("--shadow-map-size", args.shadow_map_size), ("--shadow-cascades", args.shadow_cascades)];
    if let Some((option, _)) =
        of_maps.iter().find(|(_, given)| given.is_some() && !settings.shadows.algorithm.draws_maps)
    {
        return Err(Failure::usage(format!("{option}: no shadow maps are drawn"))
            .with_hint("add --shadows map"));
    }
    settings.shadows.map_size = args.shadow_map_size.unwrap_or(settings.shadows.map_size);
    settings.shadows.cascades = args.shadow_cascades.unwrap_or(settings.shadows.cascades);
    settings.shadows.volume_counting = args.volume_counting.or(settings.shadows.volume_counting);
    Ok(())
}

fn set_normals(state: &mut State, args: &AlgorithmArgs) -> Result<(), Failure> {
    state.load.normals = args.normals.unwrap_or(state.load.normals);
    if args.crease_angle.is_some() && state.load.normals == Normals::None {
        return Err(Failure::usage("--crease-angle: no normals are made with --normals none"));
    }
    state.load.crease_angle = args.crease_angle.map(f64::to_radians).or(state.load.crease_angle);
    Ok(())
}

/// An option of radiosity without radiosity.
fn no_radiosity(option: &str) -> Failure {
    Failure::usage(format!("{option}: radiosity is not computed"))
        .with_hint("add --global radiosity")
}

/// How models are read.
pub(crate) fn set_reading(state: &mut State, args: &ProcessArgs) {
    state.load.allow_external |= args.allow_external;
    state.load.animation = args.animation.clone().or(state.load.animation.take());
    state.load.animation_time = args.animation_time.or(state.load.animation_time);
}

pub(crate) fn set_lights(state: &mut State, args: &LightArgs) -> Result<(), Failure> {
    if args.file_colors == Some(FileColors::Srgb)
        && state.settings.picture.color_space == ColorSpace::Raw
    {
        return Err(Failure::usage(
            "--file-colors srgb: with --color-space raw, colours are the numbers in the file",
        )
        .with_hint("leave out one of the two"));
    }
    match &args.environment {
        Some(EnvironmentSource::Kind(kind)) => {
            (state.settings.shading.environment, state.environment_image) = (*kind, None);
        }
        Some(EnvironmentSource::File(file)) => {
            (state.settings.shading.environment, state.environment_image) =
                (Environment::Auto, Some(file.clone()));
        }
        None => {}
    }
    state.load.file_colors = args.file_colors.unwrap_or(state.load.file_colors);
    state.settings.shading.lighting = args.lighting.unwrap_or(state.settings.shading.lighting);
    if !args.light.is_empty() {
        let raw = state.settings.picture.color_space == ColorSpace::Raw;
        let lights =
            args.light.iter().map(|text| light_spec::parse(text, raw)).collect::<Result<_, _>>();
        state.lights = Some(lights.map_err(|e| Failure::usage(format!("--light: {e}")))?);
    }
    state.light_edits.extend(args.light_edit.iter().cloned());
    state.light_intensity = args.light_intensity.or(state.light_intensity);
    state.light_term = args.light_term.or(state.light_term);
    state.fill_light = args.fill_light.unwrap_or(state.fill_light);
    state.materials.extend(args.material.iter().cloned());
    Ok(())
}

/// The objects of Lab3D.
fn set_lab(state: &mut State, args: &LabArgs) {
    let objects = &mut state.objects;
    objects.rotation = args.all_rotation.map_or(objects.rotation, |v| v.to_array());
    objects.translation = args.all_translation.map_or(objects.translation, |v| v.to_array());
}

/// The viewer, by the options that `render` and `bench` share.
pub(crate) fn set_viewpoint(viewpoint: &mut Viewpoint, args: &CameraArgs, eye: &EyeArgs) {
    viewpoint.view = args.view.or(viewpoint.view);
    viewpoint.up = args.up.or(viewpoint.up);
    viewpoint.camera_index = args.camera_index.or(viewpoint.camera_index);
    viewpoint.position = args.camera_position.map(|p| p.to_array()).or(viewpoint.position);
    viewpoint.focal_point = args.camera_focal_point.map(|p| p.to_array()).or(viewpoint.focal_point);
    viewpoint.view_up = args.camera_view_up.map(|p| p.to_array()).or(viewpoint.view_up);
    viewpoint.direction = args.camera_direction.map(|p| p.to_array()).or(viewpoint.direction);
    viewpoint.view_angle_degrees = args.camera_view_angle.or(viewpoint.view_angle_degrees);
    viewpoint.orthographic |= args.camera_orthographic;
    viewpoint.clip = args.camera_clip.or(viewpoint.clip);
    viewpoint.zoom_factor = args.camera_zoom_factor.unwrap_or(viewpoint.zoom_factor);
    viewpoint.azimuth_degrees = args.camera_azimuth_angle.unwrap_or(viewpoint.azimuth_degrees);
    viewpoint.elevation_degrees =
        args.camera_elevation_angle.unwrap_or(viewpoint.elevation_degrees);
    viewpoint.eye_rotation = eye.eye_rotation.map(|v| v.to_array()).or(viewpoint.eye_rotation);
    viewpoint.eye_translation =
        eye.eye_translation.map(|v| v.to_array()).or(viewpoint.eye_translation);
}
