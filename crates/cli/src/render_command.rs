//! `vitral render`: models in, pictures out.

use crate::animation_frames::Moments;
use crate::blank;
use crate::compare_command;
use crate::interrupt;
use crate::models::{self, ReadLimits};
use crate::no_effect;
use crate::outputs::{Output, model_name};
use crate::progress::Progress;
use crate::render_args::{RenderArgs, ReportArgs};
use crate::report::{self, DIFFERENT, Failure};
use crate::resolve::{Plan, execution_within, resolve, save_state};
use crate::step_pictures;
use crate::trace_file::Onlooker;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Instant;
use vitral::explain::{Deciders, Explanation, explain};
use vitral::internals::frame::compare;
use vitral::{Camera, ColorSpace, EncodeOptions, Frame, Plane, Renderer, dump};

/// What each algorithm may take for `--pixel`, if nothing else is said, in seconds.
const SECONDS_TO_EXPLAIN: f64 = 20.0;

/// Largest stored radiosity, in bytes.
const MOST_RADIOSITY_BYTES: u64 = 4 << 30;

/// Exit code for input that is not what it should be.
const MALFORMED: u8 = 3;

/// Runs the verb; gives the exit code.
pub(crate) fn run(args: &RenderArgs) -> Result<u8, Failure> {
    let start = Instant::now();
    let plan = resolve(args)?;
    if let Some(file) = &args.process.save_state {
        save_state(&plan.state, &plan.models, file)?;
    }
    let pictures = u64::from(plan.frames.end() - plan.frames.start() + 1)
        * if plan.apart { plan.models.len() as u64 } else { 1 };
    let (when, quiet) = (args.report.progress.unwrap_or_default(), args.report.quiet);
    let listener = Progress::stages(when, quiet).filter(|_| pictures == 1);
    let execution = execution_within(&args.process, listener)?;
    let unit = if plan.apart { "pictures" } else { "frames" };
    let mut progress = Progress::new(when, quiet, pictures, unit);
    interrupt::heed(&execution.budget.clone(), || {
        let code = if plan.apart {
            render_apart(args, &plan, &execution, &mut progress)
        } else {
            render(args, &plan, execution, start, &mut progress).and_then(|done| tell(args, done))
        };
        progress.finish();
        code
    })
}

/// Renders the models one after the other, each as if it were alone; gives the exit code of the
/// first failure.
fn render_apart(
    args: &RenderArgs,
    plan: &Plan,
    execution: &vitral::Execution,
    progress: &mut Progress,
) -> Result<u8, Failure> {
    // Render each model with limits of its own.
    let start = Instant::now();
    let frames = u64::from(plan.frames.end() - plan.frames.start() + 1);
    let mut begun = 0;
    let (done, code) = models::for_each(&plan.models, &execution.budget, |model| {
        // What a model before left out counts as done.
        progress.advance_to(begun * frames);
        begun += 1;
        let models = vec![model.to_owned()];
        let mut plan = Plan { models, ..plan.clone() };
        plan.state.models = models::in_unicode(&plan.models);
        let execution =
            vitral::Execution { budget: execution.budget.renewed(), ..execution.clone() };
        render(args, &plan, execution, Instant::now(), progress)
    });
    progress.advance_to(begun * frames);

    // Report about all.
    let (mut outputs, mut results, mut stats) = (Vec::new(), Vec::new(), Vec::new());
    for (model, done) in plan.models.iter().zip(done) {
        let mut result = match done {
            Ok(mut done) => {
                done.stats["model"] = json!(model.to_string_lossy());
                stats.push(done.stats);
                outputs.extend(done.result["outputs"].as_array().into_iter().flatten().cloned());
                done.result
            }
            Err(failure) => failure.as_json(),
        };
        result["model"] = json!(model.to_string_lossy());
        results.push(result);
    }
    let stats = json!({"models": stats, "total-seconds": start.elapsed().as_secs_f64()});
    write_stats(&args.report, &stats)?;
    if args.report.json {
        let mut result = json!({"outputs": outputs, "models": results});
        if args.report.stats {
            result["stats"] = stats;
        }
        report::print_json(&result)?;
    }
    Ok(code)
}

/// What came of one scene.
struct Done {
    /// Counters and times.
    stats: Value,
    /// Files and warnings.
    result: Value,
    explained: Option<Explanation>,
    /// A picture differs from the reference.
    different: bool,
}

/// Reports about one scene; gives the exit code.
fn tell(args: &RenderArgs, done: Done) -> Result<u8, Failure> {
    let Done { stats, mut result, explained, different } = done;
    write_stats(&args.report, &stats)?;
    if args.report.json {
        if args.report.stats {
            result["stats"] = stats;
        }
        if let Some(explained) = &explained {
            result["pixel"] = report::to_value(explained)?;
        }
        report::print_json(&result)?;
    } else if let Some(explained) = &explained {
        report::print(explained.to_string().as_bytes())?;
    }
    Ok(if different { DIFFERENT } else { 0 })
}

/// Renders the frames of the plan.
fn render(
    args: &RenderArgs,
    plan: &Plan,
    execution: vitral::Execution,
    start: Instant,
    progress: &mut Progress,
) -> Result<Done, Failure> {
    // Read the models.
    let mut seconds = Map::new();
    let loaded = timed(&mut seconds, "load", || load(args, plan, execution));
    let (mut renderer, mut warnings) = loaded?;
    let load_seconds = start.elapsed().as_secs_f64();
    if args.report.verbose {
        let triangles = renderer.world().facet_count;
        report::line(&format!("read {triangles} triangles in {load_seconds:.3} s"));
    }

    // Write what goes beside pictures.
    let cameras = match plan.state.turntable {
        Some(_) => renderer.turntable_cameras(plan.views as usize),
        None => vec![renderer.frame_camera(); plan.views as usize],
    };
    let first = &cameras[*plan.frames.start() as usize];
    if let Some(folder) = &args.output.dump {
        timed(&mut seconds, "dump", || dump::dump_to_folder(&mut renderer, first, folder))?;
    }
    if let Some(file) = &args.output.export_shadow_polygons {
        let write = || vitral::picture::write(file, vitral::shadow_polygons(&renderer)?.as_bytes());
        timed(&mut seconds, "shadow-polygons", write)?;
    }

    // Render the frames, and explain a pixel of the first.
    let drawn = timed(&mut seconds, "frames", || {
        draw_traced(args, plan, &mut renderer, &cameras, progress)
    })?;
    let explain =
        |pixel| timed(&mut seconds, "pixel", || explain_pixel(args, &renderer, first, pixel));
    let explained = args.report.pixel.map(explain).transpose()?;

    // Sum up.
    warnings.extend(drawn.warnings);
    if args.report.verbose {
        report::line(&times(&seconds, &drawn.frames));
    }
    let stats = json!({
        "load-seconds": load_seconds,
        "seconds": seconds,
        "frames": drawn.frames,
        "total-seconds": start.elapsed().as_secs_f64(),
    });
    let result = json!({"outputs": drawn.written, "warnings": warnings});
    Ok(Done { stats, result, explained, different: drawn.different })
}

/// Where the time went: loading and what else was done once, then the stages of all frames
/// together, the longest first.
fn times(once: &Map<String, Value>, frames: &[Value]) -> String {
    let mut stages: BTreeMap<&str, f64> = BTreeMap::new();
    for (name, value) in frames.iter().filter_map(|frame| frame["seconds"].as_object()).flatten() {
        *stages.entry(name).or_default() += value.as_f64().unwrap_or(0.0);
    }
    let mut stages: Vec<(&str, f64)> =
        stages.into_iter().filter(|(_, seconds)| *seconds > 0.0).collect();
    stages.sort_by(|a, b| b.1.total_cmp(&a.1));
    let tell = |(name, seconds): (&str, f64)| format!("{name} {seconds:.3} s");
    let once = once
        .iter()
        .map(|(name, value)| tell((name.as_str(), value.as_f64().unwrap_or(0.0))))
        .collect::<Vec<_>>()
        .join(", ");
    match stages.is_empty() {
        true => format!("time: {once}"),
        false => format!(
            "time: {once} ({})",
            stages.into_iter().map(tell).collect::<Vec<_>>().join(", ")
        ),
    }
}

/// What `work` gives; its seconds go into `seconds` under this name.
fn timed<T>(seconds: &mut Map<String, Value>, name: &str, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let done = work();
    seconds.insert(name.to_owned(), json!(start.elapsed().as_secs_f64()));
    done
}

/// A renderer with the models, the settings and a solution of radiosity as asked for, and the
/// warnings of the files.
fn load(
    args: &RenderArgs,
    plan: &Plan,
    execution: vitral::Execution,
) -> Result<(Renderer, Vec<String>), Failure> {
    let scene = models::load_scene(
        &plan.state,
        &plan.models,
        &execution,
        ReadLimits::of(&args.process).among_others(plan.apart),
    )?;
    let mut warnings = scene.warnings.clone();
    if !args.report.quiet {
        report::warnings(&warnings);
    }
    execution.budget.check("loading")?;
    let mut renderer = Renderer::with_execution(scene, execution)?;
    plan.state.apply(&mut renderer)?;
    let idle = no_effect::warnings(args, &plan.state, &mut renderer);
    if !args.report.quiet {
        report::warnings(&idle);
    }
    warnings.extend(idle);
    if let Some(file) = &args.output.load_radiosity {
        let bytes = vitral::read(file, MOST_RADIOSITY_BYTES)?;
        let loaded = renderer.session().load_radiosity(&bytes);
        loaded.map_err(|e| Failure::with_code(MALFORMED, format!("{}: {e}", file.display())))?;
    }
    Ok((renderer, warnings))
}

/// Draws the pictures, if any are wanted, with a trace of the steps and a picture of the structure
/// if these are; saves the solution of radiosity.
fn draw_traced(
    args: &RenderArgs,
    plan: &Plan,
    renderer: &mut Renderer,
    cameras: &[Camera],
    progress: &mut Progress,
) -> Result<Drawn, Failure> {
    // Render, and let a trace look on.
    let has_frames = plan.frames.end() > plan.frames.start();
    let mut onlooker = Onlooker::new(&args.report, renderer, has_frames)?;
    let mut drawn = if plan.outputs.is_empty() && args.output.reference.is_none() {
        Drawn::default()
    } else {
        draw(args, plan, renderer, cameras, onlooker.as_mut(), progress)?
    };

    // Write what came of it besides pictures.
    if let Some(output) = &plan.steps_video {
        let camera = &cameras[*plan.frames.start() as usize];
        let options = encode_options(plan);
        drawn.written.extend(step_pictures::video(
            args,
            output,
            &model_of(plan),
            renderer,
            camera,
            &options,
        )?);
    }
    if let Some(file) = &args.output.save_radiosity
        && let Some(bytes) = renderer.session().save_radiosity()
    {
        vitral::picture::write(file, &bytes)?;
    }
    if let Some(onlooker) = onlooker {
        onlooker.finish(renderer)?;
    }
    Ok(drawn)
}

/// Explains a pixel of the first frame.
fn explain_pixel(
    args: &RenderArgs,
    renderer: &Renderer,
    camera: &Camera,
    pixel: [u32; 2],
) -> Result<Explanation, Failure> {
    let limit = args.process.time_limit.unwrap_or(SECONDS_TO_EXPLAIN);
    let deciders = args.report.pixel_algorithms.as_ref().unwrap_or(&Deciders::Chosen);
    Ok(explain(renderer, camera, pixel, deciders, Some(limit))?)
}

/// What came of the frames.
#[derive(Default)]
struct Drawn {
    /// Counters and times of each frame.
    frames: Vec<Value>,
    /// Files that were written.
    written: Vec<String>,
    /// Differences between the picture and the options.
    warnings: Vec<String>,
    /// A picture differs from the reference, or is blank and must not be.
    different: bool,
}

impl Drawn {
    /// A file was written.
    fn note_file(&mut self, args: &RenderArgs, output: &Output, path: &Path) {
        self.written.push(path.to_string_lossy().into_owned());
        if args.report.verbose && !output.is_standard() {
            report::line(&format!("wrote {}", path.display()));
        }
    }
}

fn draw(
    args: &RenderArgs,
    plan: &Plan,
    renderer: &mut Renderer,
    cameras: &[Camera],
    mut onlooker: Option<&mut Onlooker>,
    progress: &mut Progress,
) -> Result<Drawn, Failure> {
    let (model, options) = (model_of(plan), encode_options(plan));
    let count = plan.frames.end() - plan.frames.start() + 1;
    let animate = |output: &Output| output.animation(count, args.output.frame_rate, &options);
    let mut animations = plan.outputs.iter().map(animate).collect::<Result<Vec<_>, _>>()?;
    let mut drawn = Drawn::default();
    let moments = Moments::new((&args.output, &args.process), &plan.state, &plan.models, renderer);
    for number in plan.frames.clone() {
        // Render it.
        let camera = &cameras[number as usize];
        moments.iter().try_for_each(|moments| moments.show(number, renderer))?;
        let render_start = Instant::now();
        let mut rendered = if args.output.panels {
            vitral::panels(renderer, camera)?
        } else {
            renderer.render_from(camera)?
        };
        if let Some(onlooker) = &mut onlooker {
            onlooker.take_frame(renderer, number)?;
        }
        if let Some(step) = args.output.step {
            step_pictures::after_step(renderer, camera, step, &mut rendered.frame)?;
        }

        // Tell its warnings; a turntable's frames mostly share them.
        let blank = blank::why(renderer, &rendered).map(str::to_owned);
        drawn.different |= blank.is_some() && args.output.fail_if_blank;
        rendered.warnings.extend(blank);
        let news: Vec<_> =
            rendered.warnings.iter().filter(|w| !drawn.warnings.contains(*w)).cloned().collect();
        if !args.report.quiet {
            report::warnings(&news);
        }
        drawn.warnings.extend(news);

        // Write it, if it is none that is there already.
        let encode_start = Instant::now();
        let render_seconds = (encode_start - render_start).as_secs_f64();
        let wanted =
            plan.reference.as_ref().is_none_or(|expected| differs(args, expected, &rendered.frame));
        drawn.different |= wanted && plan.reference.is_some();
        for (output, animation) in plan.outputs.iter().zip(&mut animations).filter(|_| wanted) {
            if let Some(animation) = animation {
                animation.add(&rendered.frame)?;
                continue;
            }
            let path = output.path(&model, number)?;
            output.write(
                &path,
                &rendered.frame,
                &EncodeOptions { exposure: rendered.exposure, ..options },
            )?;
            drawn.note_file(args, output, &path);
        }

        // Keep its counters.
        if args.report.stats || args.report.stats_file.is_some() || args.report.verbose {
            let mut stats = report::to_value(&rendered.stats)?;
            stats["frame"] = json!(number);
            stats["exposure"] = report::to_value(&rendered.exposure)?;
            if args.output.panels {
                // The stages are those of the last panel.
                stats["seconds"]["panels"] = json!(render_seconds);
            }
            stats["seconds"]["encode"] = json!(encode_start.elapsed().as_secs_f64());
            drawn.frames.push(stats);
        }
        renderer.recycle(rendered);
        progress.step();
    }

    // Write the animations.
    for (output, animation) in plan.outputs.iter().zip(animations) {
        if let Some(animation) = animation {
            let path = output.path(&model, *plan.frames.start())?;
            output.write_bytes(&path, &animation.finish()?)?;
            drawn.note_file(args, output, &path);
        }
    }
    Ok(drawn)
}

/// The model's name in names of files.
fn model_of(plan: &Plan) -> OsString {
    model_name(plan.models.first().map_or(Path::new(""), PathBuf::as_path))
}

/// How pictures are encoded.
fn encode_options(plan: &Plan) -> EncodeOptions {
    let srgb = plan.state.settings.picture.color_space == ColorSpace::Srgb;
    EncodeOptions { srgb, ..EncodeOptions::default() }
}

/// Whether the colour picture is farther from the reference than allowed.
fn differs(args: &RenderArgs, expected: &Plane<[u8; 4]>, frame: &Frame) -> bool {
    let color = frame.color.as_ref().expect("a reference asks for colours");
    let threshold = compare_command::threshold_byte(args.output.reference_threshold.unwrap_or(0.0));
    let found = compare::compare(expected, color, threshold);
    let different = compare_command::differs(&found);
    if let Some(reference) =
        args.output.reference.as_ref().filter(|_| different && !args.report.quiet)
    {
        let text = found.as_ref().map_or_else(ToString::to_string, ToString::to_string);
        report::line(&format!("{}: {text}", reference.display()));
    }
    different
}

fn write_stats(args: &ReportArgs, stats: &Value) -> Result<(), Failure> {
    if let Some(file) = &args.stats_file {
        report::write(file, &report::json(stats))?;
    }
    if args.stats {
        use std::io::Write;
        // Diagnostics that nobody can read are not worth failing for.
        let _ = std::io::stderr().lock().write_all(&report::json(stats));
    }
    Ok(())
}
