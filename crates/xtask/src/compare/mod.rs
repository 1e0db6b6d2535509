//! `cargo xtask compare`: vitral and its peers, in turns, on the same models and sizes.
//!
//! Peers: F3D and PyVista (VTK) from PyPI, over Mesa's software GL (llvmpipe). Two measures:
//!
//! * a turntable inside one process, load excluded: median time of a frame, from the new camera to
//!   the pixels in memory;
//! * the whole process, from a model file to a PNG file.
//!
//! Each round runs every program once, one after the other, so that a busy machine disturbs all
//! alike; the median over the rounds counts. Anti-aliasing is off on both sides, then four samples
//! a pixel; F3D's default is the former, PyVista's the latter (it asks for eight, llvmpipe gives
//! four).

pub(crate) mod draw;
mod measure;
mod peers;
mod table;

use crate::shell::{Outcome, cargo, relative, repository, run as run_command, target_folder};
use measure::{Frames, Program};
use std::path::Path;

/// Models with their names; the ones below `../shared/models` may be absent.
const MODELS: [(&str, &str); 5] = [
    ("bunny", "classics/stanford-bunny.obj"),
    ("peterbilt", "furniture-cc0/peterbilt/peterbilt.obj"),
    ("poolTable", "furniture-cc0/poolTable/poolTable.obj"),
    ("2CylinderEngine", "assimp/gltf/2CylinderEngine-glTF-Binary/2CylinderEngine.glb"),
    ("torus, 1M triangles", GENERATED),
];

/// Stands for the generated mesh.
const GENERATED: &str = "";

/// Triangles of the generated mesh.
const TRIANGLES: u64 = 1_000_000;

/// How much to measure.
#[derive(Clone, Copy)]
struct Effort {
    rounds: usize,
    frames: usize,
    with_vitral: bool,
}

/// Installs, builds, measures, prints.
pub(crate) fn run(options: &[&str]) -> Outcome {
    // Read the options.
    let mut effort = Effort { rounds: 3, frames: 8, with_vitral: true };
    for option in options {
        match *option {
            "--quick" => effort = Effort { rounds: 1, frames: 4, ..effort },
            "--peers-only" => effort.with_vitral = false,
            other => {
                return Err(format!(
                    "compare: unknown option `{other}` (there are --quick and --peers-only)"
                ));
            }
        }
    }

    // Install and build the programs, and generate the torus.
    let python = peers::install()?;
    let mut programs = vec![Program::f3d(&python), Program::pyvista(&python)];
    if effort.with_vitral {
        programs.insert(0, vitral()?);
    }
    let torus = peers::generate(&python, TRIANGLES)?;

    // Measure model after model; what is absent is named, never silently left out.
    let mut report = table::Report::new(&programs);
    for (name, path) in MODELS {
        let model = if path == GENERATED {
            torus.clone()
        } else {
            repository().join("../shared/models").join(path)
        };
        if !model.exists() {
            println!("left out: {} is not there", relative(&model));
            continue;
        }
        let mut parts = None;
        for samples in [1, 4] {
            eprintln!("{name}, {samples} sample(s) a pixel");
            let frames = turntables(&programs, &model, samples, effort);
            let own = frames.first().and_then(|f| f.as_ref().ok()).and_then(|f| f.parts_ms);
            parts = parts.or(own);
            report.turntable(name, samples, &frames);
        }
        let whole = processes(&programs, &model, effort);
        report.parts(name, whole.first().and_then(|w| w.as_ref().ok()).copied(), parts);
        report.processes(name, &whole);
    }

    // Measure how long the programs take to start.
    report.start_up(&python, effort.rounds)?;
    print!("{report}");
    Ok(())
}

/// Builds vitral's command and its turntable program.
fn vitral() -> Result<Program, String> {
    run_command(cargo().args(["build", "--release", "--package", "vitral-cli"]))?;
    run_command(cargo().args([
        "build",
        "--release",
        "--package",
        "vitral",
        "--example",
        "turntable_bench",
    ]))?;
    Ok(Program::vitral(&target_folder().join("release")))
}

/// One median turntable for each program; the reason where a program failed.
fn turntables(
    programs: &[Program],
    model: &Path,
    samples: u32,
    effort: Effort,
) -> Vec<Result<Frames, String>> {
    in_turns(programs, effort.rounds, |program| program.turntable(model, samples, effort.frames))
        .into_iter()
        .map(|rounds| rounds.map(Frames::median))
        .collect()
}

/// The median seconds of the whole process for each program.
fn processes(programs: &[Program], model: &Path, effort: Effort) -> Vec<Result<f64, String>> {
    in_turns(programs, effort.rounds, |program| program.whole_process(model))
        .into_iter()
        .map(|rounds| rounds.map(measure::median))
        .collect()
}

/// Calls `measure` for every program in each round; gives each program's results, or its first
/// failure.
fn in_turns<T>(
    programs: &[Program],
    rounds: usize,
    measure: impl Fn(&Program) -> Result<T, String>,
) -> Vec<Result<Vec<T>, String>> {
    let mut results: Vec<Result<Vec<T>, String>> =
        programs.iter().map(|_| Ok(Vec::new())).collect();
    for _ in 0..rounds {
        for (program, result) in programs.iter().zip(&mut results) {
            if let Ok(done) = result {
                match measure(program) {
                    Ok(one) => done.push(one),
                    Err(why) => *result = Err(why),
                }
            }
        }
    }
    results
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    #[test]
    fn programs_run_in_turns_and_a_failure_ends_only_its_own() {
        let python = Path::new("python");
        let programs = [Program::f3d(python), Program::pyvista(python)];
        let order = RefCell::new(Vec::new());
        let results = in_turns(&programs, 2, |program| {
            order.borrow_mut().push(program.name);
            if program.name == "F3D" { Err("no GL".to_owned()) } else { Ok(1) }
        });
        assert_eq!(order.into_inner(), ["F3D", "PyVista", "PyVista"]);
        assert_eq!(results, [Err("no GL".to_owned()), Ok(vec![1, 1])]);
    }
}
