//! `vitral draw`: models in, a vector drawing out.

use crate::draw_args::{DrawArgs, Hidden, PageArgs, Sheet, Style};
use crate::interrupt::{self, INTERRUPTED};
use crate::outputs::{expand, model_name};
use crate::progress::Progress;
use crate::report::{self, Failure};
use crate::resolve::{overlay_files, save_state, set_viewpoint};
use crate::values;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Instant;
use vitral::{DrawingSettings, Drawn, LineClasses, PageSize, Renderer, State, SvgOptions, Viewpoint, default_camera};

/// Exit code for what is not supported.
const UNSUPPORTED: u8 = 4;

/// Runs the verb; gives the exit code.
pub(crate) fn run(args: &DrawArgs) -> Result<u8, Failure> {
    let start = Instant::now();
    let state = state_of(args)?;
    let settings = settings_of(args)?;
    let output = output_of(args, &state)?;
    if let Some(file) = &args.process.save_state {
        save_state(&state, file)?;
    }

    // Set the limits.
    let mut execution = values::execution_from(args.process.threads)?;
    let process = &args.process;
    execution.budget = execution.budget.with_time_limit(process.time_limit).with_memory_limit(process.max_memory);
    if let Some(listener) = Progress::stages(args.report.progress.unwrap_or_default(), args.report.quiet) {
        execution.budget = execution.budget.with_progress(listener);
    }
    let cancelled = execution.budget.cancel_flag();
    interrupt::listen(cancelled.clone());

    let result = draw(args, &state, &settings, &output, execution, start);
    if cancelled.load(Ordering::Relaxed) { Ok(INTERRUPTED) } else { result.map(|()| 0) }
}

/// Reads the models, draws, writes.
fn draw(
    args: &DrawArgs,
    state: &State,
    settings: &DrawingSettings,
    output: &Path,
    execution: vitral::Execution,
    start: Instant,
) -> Result<(), Failure> {
    let mut scene = state.load_scene_on(&execution.workers)?;
    let points: usize = scene.meshes.iter().map(|mesh| mesh.points.len()).sum();
    if points > 0 {
        scene.warnings.push(format!("{points} free points are not drawn yet"));
    }
    if !args.report.quiet {
        report::warnings(&scene.warnings);
    }
    execution.budget.check("loading")?;
    let mut renderer = Renderer::with_execution(scene, execution)?;
    state.apply(&mut renderer)?;
    let load_seconds = start.elapsed().as_secs_f64();
    let drawn = match style_of(args) {
        Style::HiddenLine => renderer.draw(settings)?,
        Style::Filled | Style::FilledLines => renderer.draw_filled(settings)?,
    };
    let draw_seconds = start.elapsed().as_secs_f64() - load_seconds;
    let dashes = SvgOptions::default().hidden_dashes.filter(|_| args.lines.hidden != Some(Hidden::Solid));
    let file = vitral::drawing_to_svg(&drawn.drawing, &SvgOptions { hidden_dashes: dashes, ..SvgOptions::default() });
    report::write(output, &file)?;
    if args.report.stats {
        use std::io::Write;
        let seconds = [load_seconds, draw_seconds, start.elapsed().as_secs_f64()];
        let stats = stats_of(&drawn, seconds, file.len(), renderer.execution().budget.peak());
        // Diagnostics that nobody can read are not worth failing for.
        let _ = std::io::stderr().lock().write_all(&report::json(&stats));
    }
    Ok(())
}

/// The state: defaults, then files, then options.
fn state_of(args: &DrawArgs) -> Result<State, Failure> {
    let mut state = State::default();
    overlay_files(&mut state, &args.process)?;
    if !args.models.is_empty() {
        state.models = args.models.iter().map(|m| m.to_string_lossy().into_owned()).collect();
    }
    set_viewpoint(&mut state.viewpoint, &args.camera);
    state.materials.extend(args.lines.material.iter().cloned());
    state.load.allow_external |= args.process.allow_external;
    if let Some(limit) = args.process.max_memory {
        state.load.max_file_bytes = state.load.max_file_bytes.min(limit);
    }

    // A figure is seen from its own camera, unless anything is said about the view.
    if let [model] = &state.models[..]
        && args.camera.view.is_none()
        && state.viewpoint == Viewpoint::default()
    {
        state.viewpoint.camera_index = default_camera(model);
    }
    let viewpoint = &mut state.viewpoint;
    let has_angle = viewpoint.view_angle_degrees.is_some() || viewpoint.camera_index.is_some();
    viewpoint.orthographic |= !args.perspective && !has_angle;
    if args.perspective {
        viewpoint.orthographic = false;
    }
    Ok(state)
}

/// What is drawn, and on what sheet.
fn settings_of(args: &DrawArgs) -> Result<DrawingSettings, Failure> {
    let usual = DrawingSettings::default();
    let lines = &args.lines;
    let has_lines = style_of(args) != Style::Filled;
    let line_options = [(lines.lines.is_some(), "--lines"), (lines.hidden.is_some(), "--hidden")];
    if let Some((_, option)) = line_options.iter().find(|(given, _)| *given && !has_lines) {
        return Err(
            Failure::usage(format!("{option}: --style filled draws no lines")).with_hint("give --style filled-lines")
        );
    }
    let is_hidden_drawn = lines.hidden.is_some_and(|hidden| hidden != Hidden::None);
    let hidden_layers = match (is_hidden_drawn, lines.hidden_max_layers) {
        (false, Some(_)) => {
            return Err(
                Failure::usage("--hidden-max-layers: hidden lines are not drawn").with_hint("add --hidden dashed")
            );
        }
        (false, None) => 0,
        (true, None | Some(0)) => u32::MAX,
        (true, Some(layers)) => layers,
    };
    Ok(DrawingSettings {
        lines: if has_lines { lines.lines.unwrap_or(usual.lines) } else { LineClasses::EMPTY },
        hidden_layers,
        crease_angle: lines.crease_angle.map_or(usual.crease_angle, f64::to_radians),
        page: page_of(&args.page)?,
        margin: args.page.margin.unwrap_or(usual.margin),
        ..usual
    })
}

/// What the drawing is made of.
fn style_of(args: &DrawArgs) -> Style {
    args.lines.style.unwrap_or_default()
}

fn page_of(args: &PageArgs) -> Result<PageSize, Failure> {
    let Some(Sheet::Size([width, height])) = args.page else {
        if args.landscape {
            return Err(Failure::usage("--landscape: a sheet that fits the drawing cannot be turned")
                .with_hint("give --page A4"));
        }
        return Ok(PageSize::default());
    };
    let margin = args.margin.unwrap_or(DrawingSettings::default().margin);
    if 2.0 * margin >= width.min(height) {
        return Err(Failure::usage(format!("--margin {margin}: nothing is left of a sheet of {width} x {height} mm")));
    }
    let (shorter, longer) = (width.min(height), width.max(height));
    Ok(match args.landscape {
        true => PageSize::Sheet { width: longer, height: shorter },
        false => PageSize::Sheet { width, height },
    })
}

/// The file to write.
fn output_of(args: &DrawArgs, state: &State) -> Result<PathBuf, Failure> {
    if report::is_standard(&args.output) {
        if args.process.save_state.as_deref().is_some_and(report::is_standard) {
            return Err(Failure::usage("--output - and --save-state - both want standard output"));
        }
        return Ok(args.output.clone());
    }
    let model = model_name(state.models.first().map_or("", String::as_str));
    let path = PathBuf::from(expand(&args.output.to_string_lossy(), &model, 0)?);
    match path.extension().map(|e| e.to_ascii_lowercase()) {
        Some(extension) if extension == "svg" => {}
        Some(extension) if extension == "pdf" || extension == "dxf" || extension == "hpgl" => {
            let what = format!("{}: drawings of this format are not there yet", path.display());
            return Err(Failure::with_code(UNSUPPORTED, what).with_hint(".svg is written"));
        }
        _ => {
            let what = format!("{}: not a format of drawings", path.display());
            return Err(Failure::with_code(UNSUPPORTED, what).with_hint(".svg is written"));
        }
    }
    vitral::picture::check_place(&path)?;
    Ok(path)
}

/// Counters and times.
fn stats_of(drawn: &Drawn, [load, draw, total]: [f64; 3], bytes: usize, peak: u64) -> serde_json::Value {
    let (stats, lines) = (&drawn.stats, &drawn.drawing.lines);
    json!({
        "triangles": stats.triangles,
        "hiding-triangles": stats.hiding_triangles,
        "edges": stats.edges,
        "edges-asked": stats.visibility.edges,
        "candidates": stats.visibility.candidates,
        "tests": stats.visibility.tests,
        "hidden-intervals": stats.visibility.intervals,
        "intersections": stats.intersections,
        "fragments": stats.fragments,
        "regions": drawn.drawing.regions.len(),
        "polylines": lines.len(),
        "points": lines.iter().map(|line| line.points.len()).sum::<usize>(),
        "visible-millimetres": drawn.drawing.length(|line| line.layers == 0),
        "hidden-millimetres": drawn.drawing.length(|line| line.layers > 0),
        "bytes": bytes,
        "charged-bytes": peak,
        "seconds": { "load": load, "draw": draw, "total": total },
    })
}
