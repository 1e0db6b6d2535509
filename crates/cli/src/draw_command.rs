//! `vitral draw`: models in, a vector drawing out.

use crate::draw_args::{DrawArgs, Hidden, PageArgs, Sheet, Style};
use crate::draw_file::{DrawFile, check_fits, scaled_page};
use crate::draw_polygons;
use crate::draw_sheet;
use crate::interrupt;
use crate::models::{self, ReadLimits};
use crate::outputs::expand;
use crate::progress::Progress;
use crate::report::{self, Failure};
use crate::resolve::{
    execution_within, overlay_files, save_state, set_lights, set_reading, set_viewpoint,
};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;
use vitral::{
    Drawing, DrawingSettings, Drawn, LineClass, LineClasses, PageSize, PolygonDrawing, Renderer,
    State, View, World,
};

/// Runs the verb; gives the exit code.
pub(crate) fn run(args: &DrawArgs) -> Result<u8, Failure> {
    // Plan the drawings: one of all models, or one of each.
    let start = Instant::now();
    let state = state_of(args)?;
    let models = models::named(&args.models, &state);
    let apart = models::are_apart(&models, args.together, [args.output.as_path()]);
    let sheets = if apart {
        models.iter().map(|model| vec![model.clone()]).collect()
    } else {
        vec![models.clone()]
    };

    // Check each drawing as far as its options allow, and the names of the files.
    let jobs: Vec<Job> = sheets
        .into_iter()
        .map(|models| Job::new(args, &state, models))
        .collect::<Result<_, _>>()?;
    if apart {
        models::check_files(&models, |name| Ok(expand(args.output.as_os_str(), name, 0)?.into()))?;
    }

    // Save the state if that is asked for.
    if let Some(path) = &args.process.save_state {
        save_state(&state, &models, path)?;
    }

    // Draw, each model by itself if these are the sheets.
    let (when, quiet) = (args.report.progress.unwrap_or_default(), args.report.quiet);
    let listener = Progress::stages(when, quiet).filter(|_| !apart);
    let execution = execution_within(&args.process, listener)?;
    interrupt::heed(&execution.budget.clone(), || {
        if !apart {
            return jobs
                .iter()
                .try_for_each(|job| draw(args, job, execution.clone(), start))
                .map(|()| 0);
        }

        // Draw each model with a budget of its own, and go on after a model that fails.
        let mut progress = Progress::new(when, quiet, jobs.len() as u64, "drawings");
        let mut jobs = jobs.iter();
        let (_, code) = models::for_each(&models, &execution.budget, |_| {
            let execution =
                vitral::Execution { budget: execution.budget.renewed(), ..execution.clone() };
            let drawn =
                jobs.next().map_or(Ok(()), |job| draw(args, job, execution, Instant::now()));
            progress.step();
            drawn
        });
        progress.finish();
        Ok(code)
    })
}

/// A drawing to make.
struct Job {
    state: State,
    /// The models' names as typed.
    models: Vec<PathBuf>,
    file: DrawFile,
    settings: DrawingSettings,
    /// It is one of several.
    apart: bool,
}

impl Job {
    /// The drawing of these models, checked as far as it can be before the work.
    fn new(args: &DrawArgs, state: &State, models: Vec<PathBuf>) -> Result<Self, Failure> {
        // Restrict the state to the models of this drawing.
        let apart = models::named(&args.models, state).len() > models.len();
        let state = State { models: models::in_unicode(&models), ..state.clone() };

        // Choose the file by the name of the first model.
        let file =
            DrawFile::new(args, &state, models.first().map_or(Path::new(""), PathBuf::as_path))?;

        // Make room for the title block on the sheet.
        let mut settings = settings_of(args)?;
        settings.page = file.page_above_title(settings.page, settings.margin)?;
        Ok(Self { state, models, file, settings, apart })
    }
}

/// Reads the models, draws, writes.
fn draw(
    args: &DrawArgs,
    job: &Job,
    execution: vitral::Execution,
    start: Instant,
) -> Result<(), Failure> {
    // Read the models.
    let Job { state, models, file, settings, apart } = job;
    let mut settings = *settings;
    let scene = models::load_scene(
        state,
        models,
        &execution,
        ReadLimits::of(&args.process).among_others(*apart),
    )?;

    // Cut the scene, and print its warnings.
    let scene = args.section.apply(scene, &execution)?;
    if !args.report.quiet {
        report::warnings(&scene.warnings);
    }

    // Set up the renderer and its camera.
    execution.budget.check("loading")?;
    let mut renderer = Renderer::with_execution(scene, execution)?;
    projected(args, state, renderer.world()).apply(&mut renderer)?;
    let load_seconds = start.elapsed().as_secs_f64();

    // Draw.
    let (made, views) = make(args, &renderer, &mut settings)?;
    let draw_seconds = start.elapsed().as_secs_f64() - load_seconds;

    // Write.
    if let Some(warning) = file.warning(made.drawing()).filter(|_| !args.report.quiet) {
        report::warnings(&[warning]);
    }
    let counted = args.report.stats.then(|| match &made {
        Made::Exact(drawn) => stats_of(drawn),
        Made::Polygons(drawn) => draw_polygons::stats_of(drawn),
    });

    // Encode the drawing, and write the file.
    let bytes = file.encode(made.into_drawing(), settings.margin);
    report::write(&file.path, &bytes)?;

    // Print the statistics.
    if let Some(mut stats) = counted {
        use std::io::Write;
        if let Some(views) = views {
            stats["views"] = views;
        }
        let total = start.elapsed().as_secs_f64();
        stats["bytes"] = bytes.len().into();
        stats["charged-bytes"] = renderer.execution().budget.peak().into();
        stats["seconds"] = json!({ "load": load_seconds, "draw": draw_seconds, "total": total });
        // Diagnostics that nobody can read are not worth failing for.
        let _ = std::io::stderr().lock().write_all(&report::json(&stats));
    }
    Ok(())
}

/// Makes the drawing, and tells where the views of a sheet are.
pub(crate) fn make(
    args: &DrawArgs,
    renderer: &Renderer,
    settings: &mut DrawingSettings,
) -> Result<(Made, Option<serde_json::Value>), Failure> {
    // Warn if no surface is transparent, although transparency is asked for.
    let is_opaque = renderer.opacities().iter().all(|&opacity| opacity == 1.0);
    if args.fill.transparency && is_opaque && !args.report.quiet {
        report::warnings(&["--transparency: the models have no transparent surfaces".to_owned()]);
    }

    // Draw several views on one sheet.
    if !args.page.views.is_empty() {
        let (drawn, layout) = draw_sheet::draw(args, renderer, settings)?;
        return Ok((Made::Exact(drawn), Some(draw_sheet::stats_of(args, &layout))));
    }

    // Draw one view at its scale: polygons of an algorithm, filled regions or lines.
    settings.page = scaled_page(args, settings.page, renderer.drawing_window())?;
    let made = match args.polygons() {
        Some(algorithm) => {
            Made::Polygons(Box::new(draw_polygons::draw(args, algorithm, renderer, settings)?))
        }
        None => Made::Exact(match args.surfaces() {
            Some(fill) => renderer.draw_filled(settings, &fill)?,
            None => renderer.draw(settings)?,
        }),
    };

    // Check that the drawing fits on the sheet.
    check_fits(args, settings, made.drawing())?;
    Ok((made, None))
}

/// A drawing, by whom it was made.
pub(crate) enum Made {
    Exact(Drawn),
    Polygons(Box<PolygonDrawing>),
}

impl Made {
    pub(crate) fn drawing(&self) -> &Drawing {
        match self {
            Self::Exact(drawn) => &drawn.drawing,
            Self::Polygons(drawn) => &drawn.drawing,
        }
    }

    pub(crate) fn into_drawing(self) -> Drawing {
        match self {
            Self::Exact(drawn) => drawn.drawing,
            Self::Polygons(drawn) => drawn.drawing,
        }
    }
}

/// The state: defaults, then files, then options.
fn state_of(args: &DrawArgs) -> Result<State, Failure> {
    // Overlay the configuration and state files.
    let mut state = State::default();
    overlay_files(&mut state, &args.process)?;

    // Overlay the models, camera, lights and illumination of the command line.
    if !args.models.is_empty() {
        state.models = models::in_unicode(&args.models);
    }
    set_viewpoint(&mut state.viewpoint, &args.camera, &args.eye);
    set_lights(&mut state, &args.light)?;
    let shading = &mut state.settings.shading;
    shading.illumination = args.fill.illumination.unwrap_or(shading.illumination);

    // Set how files are read, up to the memory limit.
    set_reading(&mut state, &args.process);
    if let Some(limit) = args.process.max_memory {
        state.load.max_file_bytes = state.load.max_file_bytes.min(limit);
    }
    Ok(state)
}

/// The state with the projection of drawings: a parallel one, unless that is said or the camera has
/// an angle of view. A framed model is seen at equal angles to all axes, if no side is said.
pub(crate) fn projected(args: &DrawArgs, state: &State, world: &World) -> State {
    // Use the own camera of the scene, unless the sheet has several views.
    let mut state = state.clone();
    if args.page.views.is_empty() {
        state.viewpoint = state.viewpoint.or_own(world);
    }

    // Choose between parallel and perspective projection.
    let viewpoint = &mut state.viewpoint;
    let has_angle = viewpoint.view_angle_degrees.is_some() || viewpoint.camera_index.is_some();
    viewpoint.orthographic =
        !args.perspective && (!args.page.views.is_empty() || viewpoint.orthographic || !has_angle);

    // Look at a framed model from the isometric side, unless a side is named.
    if viewpoint.orthographic && viewpoint.is_framed() {
        viewpoint.view.get_or_insert(View::Iso);
    }
    state
}

/// The settings of the drawing: its lines, hidden layers and sheet.
pub(crate) fn settings_of(args: &DrawArgs) -> Result<DrawingSettings, Failure> {
    let usual = DrawingSettings::default();
    let lines = &args.lines;
    let has_lines = args.style() != Style::Filled;

    // If no number is given, hidden lines are drawn behind any number of faces.
    let hidden_layers = match (lines.hidden, lines.hidden_max_layers) {
        (None | Some(Hidden::None), _) => 0,
        (_, None | Some(0)) => u32::MAX,
        (_, Some(layers)) => layers,
    };

    // Take the default of each option that was not typed.
    Ok(DrawingSettings {
        lines: if has_lines { lines.lines.unwrap_or(usual.lines) } else { LineClasses::EMPTY },
        hidden_layers,
        crease_angle: lines.crease_angle.map_or(usual.crease_angle, f64::to_radians),
        hide_tangent: lines.hide_tangent,
        max_segments: lines.max_segments,
        hatch: args.section.hatch().filter(|_| has_lines),
        page: page_of(&args.page)?,
        margin: args.page.margin.unwrap_or(usual.margin),
        ..usual
    })
}

fn page_of(args: &PageArgs) -> Result<PageSize, Failure> {
    // Fit the sheet to the drawing if it has no size.
    let Some(Sheet::Size([width, height])) = args.page else {
        if args.landscape {
            return Err(Failure::usage("--landscape: it needs a sheet with a fixed size")
                .with_hint("give --page A4"));
        }
        return Ok(PageSize::default());
    };

    // Refuse margins that leave no room.
    let margin = args.margin.unwrap_or(DrawingSettings::default().margin);
    if 2.0 * margin >= width.min(height) {
        return Err(Failure::usage(format!(
            "--margin {margin}: no room is left on a sheet of {width} x {height} mm"
        )));
    }

    // Turn the sheet if it is to lie across.
    let (shorter, longer) = (width.min(height), width.max(height));
    Ok(match args.landscape {
        true => PageSize::Sheet { width: longer, height: shorter },
        false => PageSize::Sheet { width, height },
    })
}

/// Counters.
fn stats_of(drawn: &Drawn) -> serde_json::Value {
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
        "segments": drawn.drawing.segments(),
        "free-points": drawn.drawing.points.len(),
        "points": lines.iter().map(|line| line.points.len()).sum::<usize>(),
        "visible-millimetres": drawn.drawing.length(|line| line.layers == 0 && line.class != LineClass::Hatch),
        "hatch-millimetres": drawn.drawing.length(|line| line.class == LineClass::Hatch),
        "hidden-millimetres": drawn.drawing.length(|line| line.layers > 0),
    })
}
