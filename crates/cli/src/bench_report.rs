//! `vitral bench --report`: how the algorithms grow with the number of polygons and with the number
//! of pixels.
//!
//! The notes compare image precision, which looks at all polygons for each pixel, with object
//! precision, which compares all polygons with each other (docs/course.md P6, P25). Here both grow
//! over four sizes, with the other held still, on a scene whose shape does not change with its
//! polygons: eight rings in a heap, each ring cut finer.

use crate::args::BenchArgs;
use crate::bench_plot::{Curve, exponent, svg};
use crate::bench_rows::{Row, differing, rows};
use crate::command_line;
use crate::report::{self, Failure};
use std::fmt::Write;
use std::path::Path;
use vitral::bench::Entrant;
use vitral::solids::grid_torus;
use vitral::{DMat4, DQuat, DVec3, Execution, Renderer, Scene};

/// Polygons, at [`PIXELS`] of the third size.
const POLYGONS: [usize; 4] = [512, 2048, 8192, 32_768];
/// Width and height, with [`POLYGONS`] of the second size.
const PIXELS: [[u32; 2]; 4] = [[80, 60], [160, 120], [320, 240], [640, 480]];

/// What was measured at one size.
struct Step {
    polygons: u32,
    pixels: u32,
    rows: Vec<Row>,
}

fn polygons(step: &Step) -> u32 {
    step.polygons
}

fn pixels(step: &Step) -> u32 {
    step.pixels
}

/// Measures, and writes the report and its plots into `folder`.
pub(crate) fn write(args: &BenchArgs, folder: &Path, execution: &Execution) -> Result<u8, Failure> {
    // Measure with more and more polygons, then with more and more pixels.
    let over_polygons = POLYGONS.iter().map(|&n| step(args, execution, n, PIXELS[2]));
    let over_polygons = over_polygons.collect::<Result<Vec<_>, _>>()?;
    let over_pixels = PIXELS.iter().map(|&p| step(args, execution, POLYGONS[1], p));
    let over_pixels = over_pixels.collect::<Result<Vec<_>, _>>()?;

    // Plot both series.
    let first =
        svg("A built scene, more and more polygons", "polygons", &curves(&over_polygons, polygons));
    let second =
        svg("The same polygons, more and more pixels", "pixels", &curves(&over_pixels, pixels));

    // Write the plots and the report.
    let write = |name: &str, text: &str| vitral::picture::write(folder.join(name), text.as_bytes());
    write("visibility-polygons.svg", &first)?;
    write("visibility-pixels.svg", &second)?;
    write("visibility-report.md", &text(args, execution, &over_polygons, &over_pixels))?;
    Ok(0)
}

fn step(
    args: &BenchArgs,
    execution: &Execution,
    polygons: usize,
    size: [u32; 2],
) -> Result<Step, Failure> {
    // Set up the scene and the size of the picture.
    let mut renderer = Renderer::with_execution(heap(polygons), execution.clone())?;
    let settings = &mut renderer.settings;
    ([settings.picture.width, settings.picture.height], settings.picture.samples) = (size, 1);

    // Say which size is measured.
    if !args.quiet {
        report::line(&format!(
            "{} triangles, {} x {} pixels",
            renderer.world().facet_count,
            size[0],
            size[1]
        ));
    }

    // Measure all algorithms.
    let rows = rows(args, &renderer, &Entrant::all())?;
    Ok(Step { polygons: renderer.world().facet_count, pixels: size[0] * size[1], rows })
}

/// Eight rings that lie across each other, of about `polygons` triangles in all.
fn heap(polygons: usize) -> Scene {
    let mut scene = Scene::default();
    let mesh = grid_torus(polygons / 8);
    for i in 0..8 {
        // Turn each ring by a multiple of the golden angle, and move it off the centre.
        let angle = f64::from(i) * 2.399_963;
        let turn = DQuat::from_axis_angle(DVec3::new(1.0, f64::from(i), 0.5).normalize(), angle);
        let at = turn * DVec3::new(0.8, 0.0, 0.0);
        scene.add_mesh(mesh.clone(), DMat4::from_rotation_translation(turn, at));
    }
    scene
}

/// A curve for each algorithm; those of image precision are drawn through, the others dashed.
fn curves(steps: &[Step], size: fn(&Step) -> u32) -> Vec<Curve> {
    let curve = |(i, entrant): (usize, Entrant)| {
        // Plot the fastest time at each size; sizes that met a limit have no point.
        let point = |s: &Step| {
            s.rows[i].1.as_ref().ok().map(|m| [f64::from(size(s)), m.fastest_seconds.max(1e-9)])
        };
        let points = steps.iter().filter_map(point).collect();
        Curve { name: entrant.name(), dashed: entrant.algorithm.precision != "image", points }
    };
    Entrant::all().into_iter().enumerate().map(curve).collect()
}

/// A table with a column for each size, in milliseconds, and the exponent of the growth.
fn table(steps: &[Step], size: fn(&Step) -> u32, what: &str) -> String {
    // Write the head: a column for each size.
    let heads: Vec<_> = steps.iter().map(|s| format!("{} {what}", size(s))).collect();
    let mut out = format!("| algorithm | precision | {} | exponent |\n", heads.join(" | "));
    let _ = writeln!(out, "|---|---|{}---:|", "---:|".repeat(steps.len()));

    // Write a row for each algorithm: its times or limits, and the exponent.
    for (i, (entrant, curve)) in Entrant::all().iter().zip(curves(steps, size)).enumerate() {
        let cell = |s: &Step| match &s.rows[i].1 {
            Ok(m) => format!("{:.2}", m.fastest_seconds * 1e3),
            Err(limit) => limit.to_string(),
        };
        let cells: Vec<_> = steps.iter().map(cell).collect();
        let power = exponent(&curve.points).map_or("-".to_owned(), |e| format!("{e:.2}"));
        let _ = writeln!(
            out,
            "| {} | {} | {} | {power} |",
            entrant.name(),
            entrant.algorithm.precision,
            cells.join(" | ")
        );
    }
    out
}

/// Memory and what is built once, at the largest number of polygons.
fn memory(step: &Step) -> String {
    let mut out =
        "| algorithm | first picture, ms | memory, KiB | samples unlike the z-buffer's |\n|---|---:|---:|---:|\n"
            .to_owned();

    // Write a row for each algorithm, with its limit where it met one.
    for (entrant, row) in &step.rows {
        let _ = match row {
            Ok(m) => {
                let differs = differing(&step.rows, m).map_or("-".to_owned(), |n| n.to_string());
                let (first, bytes) = (m.first_seconds * 1e3, m.bytes.div_ceil(1024));
                writeln!(out, "| {} | {first:.2} | {bytes} | {differs} |", entrant.name())
            }
            Err(limit) => writeln!(out, "| {} | {limit} | - | - |", entrant.name()),
        };
    }
    out
}

fn text(
    args: &BenchArgs,
    execution: &Execution,
    over_polygons: &[Step],
    over_pixels: &[Step],
) -> String {
    let threads = execution.workers.threads();
    let [width, height] = PIXELS[2];
    format!(
        "# Image precision and object precision, measured\n\n\
         Written by `{command}`, and not by hand.\n\n\
         The scene is a heap of eight rings, cut ever finer, so that the picture stays what it is while the polygons grow. One\n\
         sample a pixel, {threads} thread(s). Times are finding the visible surface of every sample, without shading: the fastest\n\
         of {frames} pictures after a first one, which also builds trees (other processes can only add to it). An exponent `e` says that the time grows like `size^e`;\n\
         it is the slope of the line through the logarithms. The same machine in the same minutes serves all rows: compare\n\
         them with each other, not with other machines.\n\n\
         The notes say what to expect (docs/course.md P6): an algorithm of image precision asks, for each of `p` pixels, which of\n\
         `n` polygons is nearest, `O(n p)`; one of object precision compares the polygons with each other, `O(n^2)`, and does\n\
         not care for pixels. Brute force is the first in its pure form. The others save work by coherence, by sorting\n\
         or by structures, and their exponents say how much.\n\n\
         ## Growth with polygons\n\n{width} x {height} pixels, milliseconds.\n\n{}\n![Seconds over polygons](visibility-polygons.svg)\n\n\
         ## Growth with pixels\n\n{} polygons, milliseconds.\n\n{}\n![Seconds over pixels](visibility-pixels.svg)\n\n\
         Dashed: list priority and object precision. Here their last step, like that of all others, fills the samples of\n\
         the picture, which is what grows with pixels. Aliasing comes with that step: what Weiler–Atherton and the lists hold\n\
         are outlines, good at any size; what image precision holds are samples. All of them end in the same samples, so\n\
         their pictures, and the aliasing in them, are equal.\n\n\
         ## What is built once, and memory\n\n{} polygons, {width} x {height} pixels. Memory is what an algorithm charges to its budget for its own lists,\n\
         trees and facets.\n\n{}",
        table(over_polygons, polygons, "polygons"),
        over_pixels.first().map_or(0, polygons),
        table(over_pixels, pixels, "pixels"),
        over_polygons.last().map_or(0, polygons),
        over_polygons.last().map_or(String::new(), memory),
        command = command_line::typed(),
        frames = args.frames,
    )
}
