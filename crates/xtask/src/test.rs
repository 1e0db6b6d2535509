//! `cargo xtask test`: everything that can fail, then what it took, then one line with the count.

use crate::checks::CheckResult;
use crate::shell::{self, Outcome, cargo};
use crate::spent::{Spent, Stopwatch};
use crate::tally::{Program, Reader, Tally};
use crate::{dist, lab, prepare, python, wasm};
use std::io::{BufRead, BufReader};
use std::process::Command;
use std::time::Instant;

/// The profile that everything here is built with, and the name of its folder: see the workspace's
/// manifest.
pub(crate) const PROFILE: &str = "suite";

/// Where property tests take the seed of their random cases from. `cargo test` by itself draws
/// other cases each time.
const SEED: &str = "PROPTEST_RNG_SEED";

/// How many of the slowest test programs are listed.
const LISTED_PROGRAMS: usize = 8;

/// Runs all tests.
pub(crate) fn run() -> Outcome {
    let prepared = prepare::prepare();

    // Build all test programs, and examples. The plain scalar level, which takes minutes and
    // gigabytes to compile, is tested in WebAssembly and by `--features vitral/scalar`.
    let build = Stopwatch::start();
    let built = shell::run(test_workspace().arg("--no-run"));
    let build = build.spent();

    // Run unit, integration and documentation tests.
    let tests = Stopwatch::start();
    let mut reader = Reader::default();
    let complete = match &built {
        Ok(()) => stream(&mut test_programs(), &mut reader)?,
        Err(_) => false,
    };
    let tests = tests.spent();
    let mut tally = reader.tally();
    if !complete && tally.failed == 0 {
        println!("a test program did not build, or ended without a result: counted as one failure");
        tally.failed += 1;
    }

    // Draw the same picture in WebAssembly.
    let web_assembly = Stopwatch::start();
    let mut checks = wasm::run_all(prepared.no_wasm.as_deref());
    let web_assembly = web_assembly.spent();

    // Build the Lab's page and try it in a browser.
    let page = Stopwatch::start();
    checks.extend(lab::test_all(prepared.no_wasm.as_deref()));
    let page = page.spent();

    // Build the Python package and test it.
    let package = Stopwatch::start();
    checks.extend(python::test_all(PROFILE));
    let package = package.spent();

    // Pack what people install, and try it.
    let packages = Stopwatch::start();
    checks.extend(dist::test_all(PROFILE));
    let packages = packages.spent();
    for check in checks {
        println!("test {} ... {}", check.name, check.result);
        match check.result {
            CheckResult::Passed => tally.passed += 1,
            CheckResult::Failed(_) => tally.failed += 1,
            CheckResult::Skipped(_) => tally.skipped += 1,
        }
    }

    list_skipped(&reader.reasons);
    let steps = [
        ("build", build),
        ("tests", tests),
        ("WebAssembly", web_assembly),
        ("the Lab", page),
        ("the Python package", package),
        ("packages", packages),
    ];
    list_spent(&steps, reader.programs);
    close(tally)
}

/// `cargo test` of the whole workspace.
fn test_workspace() -> Command {
    let mut command = cargo();
    command.args(["test", "--workspace", "--profile", PROFILE]);

    // The same commit has the same result each time.
    if std::env::var_os(SEED).is_none() {
        command.env(SEED, "1");
    }
    command
}

/// The command that runs what is built.
fn test_programs() -> Command {
    let mut command = test_workspace();
    command.args(["--no-fail-fast", "--color", "never", "--", "--show-output"]);
    command
}

/// Lists the tests that were skipped.
fn list_skipped(reasons: &[String]) {
    if !reasons.is_empty() {
        println!("\nskipped, in their own words:");
        reasons.iter().for_each(|reason| println!("  {reason}"));
    }
}

/// Lists what each step took, and the slowest test programs.
fn list_spent(steps: &[(&str, Spent)], mut programs: Vec<Program>) {
    println!(
        "\ntime spent (`cargo test --workspace --profile {PROFILE} --no-run --timings` tells the build by crate):"
    );
    steps.iter().for_each(|(name, spent)| println!("  {name:<32}{spent}"));
    programs.sort_by_key(|program| std::cmp::Reverse(program.wall));
    for program in programs.iter().take(LISTED_PROGRAMS) {
        println!("    {:<30}{:7.1} s", program.name, program.wall.as_secs_f64());
    }
}

/// Closes with the count.
fn close(tally: Tally) -> Outcome {
    println!("\n{tally}");
    if tally.failed == 0 { Ok(()) } else { Err("some tests failed".to_owned()) }
}

/// Runs a test command, shows and counts its lines; says whether it exited with 0. Errors and
/// output share a pipe, so that the headings that cargo writes to its errors keep their place among
/// the output of the programs.
fn stream(command: &mut Command, reader: &mut Reader) -> Result<bool, String> {
    let error = |e: std::io::Error| format!("cargo test: {e}");
    let start = Instant::now();
    let (output, input) = std::io::pipe().map_err(error)?;
    let mut child =
        command.stdout(input.try_clone().map_err(error)?).stderr(input).spawn().map_err(error)?;
    // The command keeps its ends of the pipe open, and reading ends when all are closed.
    command.stdout(std::process::Stdio::null()).stderr(std::process::Stdio::null());
    for line in BufReader::new(output).split(b'\n') {
        let line = line.map_err(error)?;
        let line = String::from_utf8_lossy(&line);
        if reader.line(line.trim_end_matches('\r'), start.elapsed()) {
            println!("{line}");
        }
    }
    reader.end_program(start.elapsed());
    let status = child.wait().map_err(error)?;
    Ok(status.success())
}

/// Used by `bless`: runs the workspace's tests with one more environment variable.
pub(crate) fn with_environment(name: &str, value: &str, filter: Option<&str>) -> Outcome {
    shell::run(test_workspace().env(name, value).args(["--tests", "--no-fail-fast"]).args(filter))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// Files and folders of modules in `folder`, and the modules that `suite` declares.
    fn modules(folder: &Path, suite: &str) -> (Vec<String>, Vec<String>) {
        let is_module = |path: &Path| {
            path.extension().is_some_and(|e| e == "rs") || path.join("mod.rs").exists()
        };
        let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let stem =
            |path: std::path::PathBuf| path.file_stem().unwrap().to_string_lossy().into_owned();
        let mut found: Vec<String> = paths.filter(|path| is_module(path)).map(stem).collect();
        found.sort();
        let module = |line: &str| Some(line.strip_prefix("mod ")?.strip_suffix(';')?.to_owned());
        (found, suite.lines().filter_map(module).collect())
    }

    /// A crate whose tests are one program finds its files by declarations alone: none may be
    /// forgotten.
    #[test]
    fn every_test_file_belongs_to_a_program() {
        let crates = std::fs::read_dir(shell::repository().join("crates")).unwrap();
        let mut suites = 0;
        for folder in crates.map(|entry| entry.unwrap().path()) {
            let Ok(suite) = std::fs::read_to_string(folder.join("tests/suite.rs")) else {
                continue;
            };
            let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
            let (found, declared) = modules(&folder.join("tests"), &suite);
            let alone = |name: &String| manifest.contains(&format!("path = \"tests/{name}.rs\""));
            let expected: Vec<String> = found.into_iter().filter(|name| !alone(name)).collect();
            assert_eq!(declared, expected, "{}", folder.display());
            suites += 1;
        }
        assert!(suites > 0);
    }
}
