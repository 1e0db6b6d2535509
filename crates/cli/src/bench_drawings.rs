//! `vitral bench --drawings --report`: the polygons of the algorithms of the course beside exact
//! drawings.
//!
//! Each algorithm makes a filled drawing of the same view of the same scenes. A list from back to
//! front holds hidden polygons as well, so part of its area is painted more than once. For two
//! small scenes, the report shows the drawings, with the cuts of each algorithm.

use crate::args::BenchArgs;
use crate::command_line;
use crate::models::{self, ReadLimits};
use crate::report::{self, Failure};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use vitral::{
    Budget, DMat4, Drawing, DrawingFormat, DrawingOptions, DrawingSettings, Error, Execution,
    Faces, FillSettings, Lens, Limit, LineClass, Material, Mesh, PageSize, PolygonOrder,
    PolygonSettings, RenderError, Renderer, Scene, Seams, State, View, Visibility, covered_area,
};

/// Length of the longer side of the pictures, millimetres.
const PICTURE: f64 = 60.0;
/// Built-in scenes that are measured.
const BUILT_IN: [&str; 3] = ["builtin:cubs", "builtin:scene0", "builtin:teapot"];

/// A scene, and the side from which it is seen.
struct Subject {
    name: String,
    scene: Scene,
    view: View,
    /// What its pictures are called, if it has some.
    pictures: Option<&'static str>,
}

/// What was measured of an algorithm: `None` stands for the drawing's own, exact one.
struct Row {
    algorithm: Option<Visibility>,
    outcome: Result<Measured, Limit>,
}

struct Measured {
    first_seconds: f64,
    fastest_seconds: f64,
    model_polygons: Option<u64>,
    splits: Option<u64>,
    regions: usize,
    bytes: usize,
    /// Square millimetres: the sum over all regions, and what they cover together.
    area: f64,
    covered: f64,
}

/// Measures, and writes the report and its pictures into `folder`.
pub(crate) fn write(args: &BenchArgs, folder: &Path, execution: &Execution) -> Result<u8, Failure> {
    let mut text = head(args, execution);
    for subject in subjects(args, execution)? {
        // Set up a parallel projection of the scene.
        let mut renderer = Renderer::with_execution(subject.scene, execution.clone())?;
        (renderer.lens, renderer.view) = (Lens::Parallel, subject.view);

        // Measure each algorithm.
        let _ =
            writeln!(text, "## {}\n\n{} triangles.\n", subject.name, renderer.world().facet_count);
        text.push_str(TABLE_HEAD);
        for algorithm in algorithms() {
            if !args.quiet {
                report::line(&format!("{}: {}", subject.name, name_of(algorithm)));
            }
            let outcome = measured(args, &mut renderer, algorithm, execution)?;
            text.push_str(&line(&Row { algorithm, outcome }));
        }
        text.push('\n');

        // Draw the small ones.
        for algorithm in subject.pictures.iter().flat_map(|_| algorithms()) {
            let picture = format!(
                "drawing-{}-{}.svg",
                subject.pictures.unwrap_or_default(),
                name_of(algorithm)
            );
            vitral::picture::write(folder.join(&picture), &small_picture(&renderer, algorithm)?)?;
            let _ = writeln!(
                text,
                "<img src=\"{picture}\" alt=\"{0}: {1}\" title=\"{1}\" width=\"200\">",
                subject.name,
                name_of(algorithm)
            );
        }
        text.push_str(if subject.pictures.is_some() { "\n" } else { "" });
    }

    // End the report with one line break, and write it.
    text.truncate(text.trim_end().len());
    text.push('\n');
    vitral::picture::write(folder.join("drawing-report.md"), text.as_bytes())?;
    Ok(0)
}

/// The exact drawing, then all algorithms that come to polygons.
fn algorithms() -> impl Iterator<Item = Option<Visibility>> {
    std::iter::once(None).chain(Visibility::all().filter(|row| row.polygons.is_some()).map(Some))
}

fn name_of(algorithm: Option<Visibility>) -> &'static str {
    algorithm.map_or("exact", |algorithm| algorithm.name)
}

/// The two small scenes, built-in ones, and the models that were named.
fn subjects(args: &BenchArgs, execution: &Execution) -> Result<Vec<Subject>, Failure> {
    // Build the small scenes.
    let small = |name: &str, scene, view, pictures| Subject {
        name: name.to_owned(),
        scene,
        view,
        pictures: Some(pictures),
    };
    let mut all = vec![
        small("Three bars, each in front of the next", bars(), View::Front, "bars"),
        small("Three squares that cross", squares(), View::Iso, "squares"),
    ];

    // Load the others.
    for model in BUILT_IN.into_iter().map(PathBuf::from).chain(args.models.iter().cloned()) {
        let models = [model];
        let mut state = State { models: models::in_unicode(&models), ..State::default() };
        state.load.allow_external = args.allow_external;
        let scene = models::load_scene(&state, &models, execution, ReadLimits::default())?;
        all.push(Subject {
            name: format!("`{}`", state.models[0]),
            scene,
            view: View::Iso,
            pictures: None,
        });
    }
    Ok(all)
}

/// Adds a quadrilateral in a colour.
fn add_quad(scene: &mut Scene, color: [f32; 3], corners: [[f32; 3]; 4]) {
    // Make one polygon of the four corners, visible from both sides.
    let material = scene.add_material(Material { double_sided: true, ..Material::matte(color) });
    let faces = Faces::Polygons { starts: vec![0, 4], corners: vec![0, 1, 2, 3] };
    let mesh = Mesh { faces, ..Mesh::new(corners, [[0, 1, 2], [0, 2, 3]]) };
    scene.add_mesh(mesh.with_material(material), DMat4::IDENTITY);
}

/// Three bars round a triangle. Each is near at one end and far at the other, so that they cover
/// each other in a circle.
fn bars() -> Scene {
    let mut scene = Scene::default();
    let ends = [[-6.0, -3.5], [6.0, -3.5], [0.0, 6.0]];
    let colors = [[0.75, 0.35, 0.3], [0.35, 0.6, 0.35], [0.35, 0.45, 0.75]];
    for (i, color) in colors.into_iter().enumerate() {
        // Run along one side of the triangle, beyond both corners.
        let [[ax, ay], [bx, by]]: [[f32; 2]; 2] = [ends[i], ends[(i + 1) % 3]];
        let [dx, dy] = [bx - ax, by - ay];
        let length = (dx * dx + dy * dy).sqrt();
        let ([ux, uy], half) = ([dx / length, dy / length], 0.8);
        let end = |x: f32, y: f32, way: f32, side: f32, z: f32| {
            [x + ux * way - uy * half * side, y + uy * way + ux * half * side, z]
        };

        // Lower the first end, and raise the second.
        let near = [end(bx, by, 1.5, -1.0, 1.0), end(bx, by, 1.5, 1.0, 1.0)];
        let far = [end(ax, ay, -1.5, -1.0, -1.0), end(ax, ay, -1.5, 1.0, -1.0)];
        add_quad(&mut scene, color, [far[0], near[0], near[1], far[1]]);
    }
    scene
}

/// A square in each plane of two axes.
fn squares() -> Scene {
    let mut scene = Scene::default();
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    add_quad(&mut scene, [0.75, 0.35, 0.3], corners.map(|[a, b]| [a, b, 0.0]));
    add_quad(&mut scene, [0.35, 0.6, 0.35], corners.map(|[a, b]| [0.0, a, b]));
    add_quad(&mut scene, [0.35, 0.45, 0.75], corners.map(|[a, b]| [b, 0.0, a]));
    scene
}

/// Draws several times, and measures; a limit is a row of the table.
fn measured(
    args: &BenchArgs,
    renderer: &mut Renderer,
    algorithm: Option<Visibility>,
    execution: &Execution,
) -> Result<Result<Measured, Limit>, Failure> {
    // Each drawing has the whole budget for itself.
    let budget = || {
        let renewed: Budget = execution.budget.renewed();
        renewed
            .with_time_limit(Some(args.time_limit))
            .with_memory_limit(args.max_memory.or_else(crate::machine::memory))
    };

    // Leave the lines out: only regions are measured.
    let page = DrawingSettings { lines: vitral::LineClasses::EMPTY, ..DrawingSettings::default() };

    // Measure the first drawing in full, and of the others the time.
    let mut all: Option<Measured> = None;
    for _ in 0..=args.frames {
        let own = budget();
        renderer.execution_mut().budget = own.clone();
        let drawn = filled(renderer, algorithm, &page);
        let seconds = own.elapsed();
        match (drawn, &mut all) {
            (Ok(_), Some(measured)) => {
                measured.fastest_seconds = measured.fastest_seconds.min(seconds)
            }
            (Ok((drawing, model_polygons, splits)), None) => {
                all = Some(Measured {
                    first_seconds: seconds,
                    fastest_seconds: seconds,
                    model_polygons,
                    splits,
                    regions: drawing.regions.len(),
                    bytes: DrawingFormat::Svg.encode(&drawing, &DrawingOptions::default()).len(),
                    area: drawing.area(),
                    covered: covered_area(&drawing.regions),
                });
            }
            (Err(Error::Render(RenderError::Limit(limit))), None)
                if !matches!(limit, Limit::Cancelled { .. }) =>
            {
                return Ok(Err(limit));
            }
            // A limit after the first drawing only means fewer of them.
            (Err(Error::Render(RenderError::Limit(Limit::Time { .. }))), Some(_)) => break,
            (Err(error), _) => return Err(error.into()),
        }
    }
    all.map(Ok).ok_or_else(|| Failure::usage("--frames: nothing is measured without one"))
}

/// Regions that only touch, as the polygons of Weiler and Atherton do.
fn touching() -> FillSettings {
    FillSettings { seams: Seams::None, ..FillSettings::default() }
}

/// A filled drawing; polygons of the model and splits, if the algorithm counts them.
type Filled = (Drawing, Option<u64>, Option<u64>);

fn filled(
    renderer: &Renderer,
    algorithm: Option<Visibility>,
    page: &DrawingSettings,
) -> Result<Filled, Error> {
    // Draw exactly where no algorithm is named.
    let Some(algorithm) = algorithm else {
        return Ok((renderer.draw_filled(page, &touching())?.drawing, None, None));
    };

    // Draw the polygons of the algorithm without outlines.
    let settings = PolygonSettings { outlines: false, ..PolygonSettings::new(algorithm) };
    let drawn = renderer.draw_polygons(&settings, page)?;
    Ok((drawn.drawing, Some(drawn.model_polygons), Some(drawn.counters.splits)))
}

/// An SVG with outlines.
fn small_picture(renderer: &Renderer, algorithm: Option<Visibility>) -> Result<Vec<u8>, Failure> {
    // Fit the sheet to the picture.
    let page = PageSize::Fit { longer: PICTURE };
    let page = DrawingSettings { page, margin: 2.0, ..DrawingSettings::default() };
    let mut options = DrawingOptions { decimals: 2, ..DrawingOptions::default() };

    // Draw exactly where no algorithm is named.
    let Some(algorithm) = algorithm else {
        return Ok(
            DrawingFormat::Svg.encode(&renderer.draw_filled(&page, &touching())?.drawing, &options)
        );
    };

    // Draw the polygons; outline each where later ones cover earlier ones.
    let drawn = renderer.draw_polygons(&PolygonSettings::new(algorithm), &page)?;
    options.region_outlines =
        Some(LineClass::Smooth).filter(|_| drawn.order == PolygonOrder::BackToFront);
    Ok(DrawingFormat::Svg.encode(&drawn.drawing, &options))
}

const TABLE_HEAD: &str = "| algorithm | polygons of the model | splits | regions | bytes of SVG | first, ms | fastest, ms | area, mm² | \
                          of it drawn again |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";

/// A line of the table.
fn line(row: &Row) -> String {
    let name = name_of(row.algorithm);

    // Put a limit into the row in place of numbers.
    let m = match &row.outcome {
        Ok(measured) => measured,
        Err(limit) => return format!("| {name} | {limit} | - | - | - | - | - | - | - |\n"),
    };

    // Write a dash for counters that the algorithm does not have.
    let count = |count: Option<u64>| count.map_or("-".to_owned(), |count| count.to_string());

    // Compute the area that lies under another region.
    let again = (m.area - m.covered).max(0.0);
    format!(
        "| {name} | {} | {} | {} | {} | {:.2} | {:.2} | {:.1} | {:.1} % |\n",
        count(m.model_polygons),
        count(m.splits),
        m.regions,
        m.bytes,
        m.first_seconds * 1e3,
        m.fastest_seconds * 1e3,
        m.area,
        again / m.area.max(f64::MIN_POSITIVE) * 100.0,
    )
}

fn head(args: &BenchArgs, execution: &Execution) -> String {
    format!(
        "# Polygons of the classical algorithms, and exact drawings\n\n\
         Written by `{}`, and not by hand.\n\n\
         `vitral draw --algorithm painter`, `bsp` and `weiler-atherton` write the polygons that these algorithms come to, in their own\n\
         order. The lists of painter's algorithm and of a BSP tree go from back to front: all polygons are in them, and what is painted\n\
         later covers what is hidden. They are list-priority algorithms (Sutherland, Sproull & Schumacker 1974): the order is found in\n\
         object space, and whoever paints the file does the rest, pixel by pixel. Weiler–Atherton gives the visible polygons, which do not\n\
         overlap but for surfaces in one place. The exact drawing joins faces of one colour that touch; the others keep every polygon.\n\n\
         All drawings are filled, without outlines, 180 mm along the longer side, in a parallel projection with {} thread(s). Times are a\n\
         drawing in memory: the first, which also builds a BSP tree, and the fastest of {} after it. *Splits* are cuts in two, of a BSP\n\
         tree those of polygons that are not seen, too. The area is the sum over all regions; *drawn again* is what lies under another.\n\n",
        command_line::typed(),
        execution.workers.threads(),
        args.frames,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral::execution;

    fn splits(scene: Scene, view: View) -> Vec<(Option<u64>, usize)> {
        let mut renderer = Renderer::with_execution(scene, execution(1)).unwrap();
        (renderer.lens, renderer.view) = (Lens::Parallel, view);
        let page = DrawingSettings::default();
        let drawn = |algorithm| filled(&renderer, algorithm, &page).unwrap();
        algorithms()
            .map(drawn)
            .map(|(drawing, _, splits)| (splits, drawing.regions.len()))
            .collect()
    }

    #[test]
    fn the_small_scenes_are_cut_as_they_are_meant_to_be() {
        let cut = splits(bars(), View::Front);
        // Painter's algorithm cuts the circle once: four pieces of three bars.
        assert_eq!(cut[1], (Some(1), 4), "{cut:?}");
        let cut = splits(squares(), View::Iso);
        // The first plane of the tree cuts the two other squares, the second the halves of the
        // third.
        assert_eq!(cut[2], (Some(4), 7), "{cut:?}");
    }
}
