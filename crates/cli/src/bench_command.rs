//! `vitral bench`: every visible-surface algorithm on one model, as a table.

use crate::args::BenchArgs;
use crate::bench_drawings;
use crate::bench_report;
use crate::bench_rows::{Row, differing, rows};
use crate::command_line;
use crate::interrupt;
use crate::models::{self, ReadLimits};
use crate::report::{self, Failure};
use crate::resolve::set_viewpoint;
use crate::values;
use serde_json::{Value, json};
use std::fmt::Write;
use vitral::bench::{Entrant, Measured};
use vitral::{Execution, Renderer, State};

/// Runs the verb; gives the exit code.
pub(crate) fn run(args: &BenchArgs) -> Result<u8, Failure> {
    let execution = values::execution_from(args.threads)?;
    interrupt::heed(&execution.budget.clone(), || match &args.report {
        Some(folder) if args.drawings => bench_drawings::write(args, folder, &execution),
        Some(_) if !args.models.is_empty() => {
            Err(Failure::usage("--report: it measures a scene of its own")
                .with_hint("leave the models out, or add --drawings"))
        }
        Some(folder) => bench_report::write(args, folder, &execution),
        None => bench(args, execution),
    })
}

fn bench(args: &BenchArgs, execution: Execution) -> Result<u8, Failure> {
    // The model.
    let models = models::in_unicode(&args.models);
    let mut state = State { models, ..State::default() };
    state.load.allow_external = args.allow_external;
    set_viewpoint(&mut state.viewpoint, &args.camera, &args.eye);
    let settings = &mut state.settings;
    ([settings.picture.width, settings.picture.height], settings.picture.samples) =
        (args.resolution, args.samples);
    settings.check().map_err(|e| vitral::Error::from(vitral::RenderError::from(e)))?;
    let scene = models::load_scene(&state, &args.models, &execution, ReadLimits::default())?;
    if !args.quiet {
        report::warnings(&scene.warnings);
    }
    let mut renderer = Renderer::with_execution(scene, execution)?;
    state.apply(&mut renderer)?;

    // The algorithms.
    let wanted =
        |e: &Entrant| args.visibility.is_empty() || args.visibility.contains(&e.algorithm.choice());
    let all = Entrant::all();
    let entrants: Vec<_> =
        all.iter().enumerate().filter(|(i, e)| *i == 0 || wanted(e)).map(|(_, e)| *e).collect();
    let rows = rows(args, &renderer, &entrants)?;
    if args.json {
        report::print_json(&as_json(args, &renderer, &rows))?;
    } else {
        report::print(table(args, &renderer, &rows).as_bytes())?;
    }
    Ok(0)
}

/// The counters of a row that are not 0, by name.
fn counters(measured: &Measured) -> Vec<(String, u64)> {
    let value = serde_json::to_value(measured.counters).unwrap_or_default();
    let Value::Object(fields) = value else { return Vec::new() };
    fields
        .into_iter()
        .filter_map(|(name, v)| v.as_u64().filter(|&n| n > 0).map(|n| (name, n)))
        .collect()
}

fn table(args: &BenchArgs, renderer: &Renderer, rows: &[Row]) -> String {
    let [width, height] = args.resolution;
    let mut text = format!(
        "{}\n{} triangles, {width} x {height} pixels, {} sample(s) a pixel, {} thread(s)\n\n{:<18} {:<14} {:>11} {:>11} {:>12} {:>10}\n",
        command_line::typed(),
        renderer.world().facet_count,
        args.samples,
        renderer.execution().workers.threads(),
        "algorithm",
        "precision",
        "first, ms",
        "median, ms",
        "memory, KiB",
        "differing",
    );
    // Writing to a String cannot fail.
    for (entrant, row) in rows {
        let _ = write!(text, "{:<18} {:<14} ", entrant.name(), entrant.algorithm.precision);
        let _ = match row {
            Ok(m) => {
                let differs = differing(rows, m).map_or("-".to_owned(), |n| n.to_string());
                let (first, median) = (m.first_seconds * 1e3, m.median_seconds * 1e3);
                writeln!(
                    text,
                    "{first:>11.2} {median:>11.2} {:>12} {differs:>10}",
                    m.bytes.div_ceil(1024)
                )
            }
            Err(limit) => writeln!(text, "{limit}"),
        };
    }
    text.push_str("\nfirst: with what is built once; memory: what the algorithm charged; differing: samples unlike the z-buffer's\n\n");
    for (entrant, row) in rows {
        let Ok(m) = row else { continue };
        let list: Vec<_> = counters(m).into_iter().map(|(name, n)| format!("{name} {n}")).collect();
        let list =
            if list.is_empty() { "counts nothing of its own".to_owned() } else { list.join(", ") };
        let _ = writeln!(text, "{}: {list}", entrant.name());
    }
    text
}

fn as_json(args: &BenchArgs, renderer: &Renderer, rows: &[Row]) -> Value {
    let row = |(entrant, row): &Row| {
        let mut value = json!({
            "algorithm": entrant.algorithm.name,
            "acceleration": entrant.acceleration.map(|structure| structure.name),
            "precision": entrant.algorithm.precision,
        });
        match row {
            Ok(m) => {
                value["first-seconds"] = json!(m.first_seconds);
                value["median-seconds"] = json!(m.median_seconds);
                value["fastest-seconds"] = json!(m.fastest_seconds);
                value["frames"] = json!(m.frames);
                value["bytes"] = json!(m.bytes);
                value["differing"] = json!(differing(rows, m));
                value["geometry"] = json!(m.geometry);
                value["counters"] =
                    json!(counters(m).into_iter().collect::<std::collections::BTreeMap<_, _>>());
            }
            Err(limit) => value["limit"] = json!(limit.to_string()),
        }
        value
    };
    json!({
        "command": command_line::typed(),
        "models": args.models,
        "triangles": renderer.world().facet_count,
        "resolution": args.resolution,
        "samples": args.samples,
        "threads": renderer.execution().workers.threads(),
        "algorithms": rows.iter().map(row).collect::<Vec<_>>(),
    })
}
