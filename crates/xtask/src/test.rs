//! `cargo xtask test`: everything that can fail, then one line with the count.

use crate::shell::{self, Outcome, cargo};
use crate::tally::{Reader, Tally};
use crate::{prepare, wasm};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

/// Runs all tests.
pub(crate) fn run() -> Outcome {
    let prepared = prepare::prepare();

    // Run unit, integration and documentation tests; examples are built by the way. The plain scalar level, which takes
    // minutes and gigabytes to compile, is tested in WebAssembly and by `--features vitral/scalar`.
    let mut reader = Reader::default();
    let mut workspace = cargo();
    workspace.args(["test", "--workspace", "--no-fail-fast", "--", "--show-output"]);
    let complete = stream(&mut workspace, &mut reader)?;
    let mut tally = reader.tally();
    if !complete && tally.failed == 0 {
        println!("a test program did not build, or ended without a result: counted as one failure");
        tally.failed += 1;
    }

    // Draw the same picture in WebAssembly.
    let checks = wasm::run_all(prepared.no_wasm.as_deref());
    for check in &checks {
        println!("test wasm::{} ... {}", check.name, check.result);
        match &check.result {
            wasm::CheckResult::Passed => tally.passed += 1,
            wasm::CheckResult::Failed(_) => tally.failed += 1,
            wasm::CheckResult::Skipped(_) => tally.skipped += 1,
        }
    }

    close(tally, &reader.reasons)
}

/// Says what was skipped, and closes with the count.
fn close(tally: Tally, skipped: &[String]) -> Outcome {
    if !skipped.is_empty() {
        println!("\nskipped, in their own words:");
        skipped.iter().for_each(|reason| println!("  {reason}"));
    }
    println!("\n{tally}");
    if tally.failed == 0 { Ok(()) } else { Err("some tests failed".to_owned()) }
}

/// Runs a test command, shows and counts its lines; says whether it exited with 0.
fn stream(command: &mut Command, reader: &mut Reader) -> Result<bool, String> {
    let mut child = command.stdout(Stdio::piped()).spawn().map_err(|e| format!("cargo test: {e}"))?;
    let output = child.stdout.take().ok_or("cargo test: no output")?;
    for line in BufReader::new(output).split(b'\n') {
        let line = line.map_err(|e| format!("cargo test: {e}"))?;
        let line = String::from_utf8_lossy(&line);
        if reader.line(line.trim_end_matches('\r')) {
            println!("{line}");
        }
    }
    let status = child.wait().map_err(|e| format!("cargo test: {e}"))?;
    Ok(status.success())
}

/// Used by `bless`: runs the workspace's tests with one more environment variable.
pub(crate) fn with_environment(name: &str, value: &str, filter: Option<&str>) -> Outcome {
    shell::run(cargo().env(name, value).args(["test", "--workspace", "--tests", "--no-fail-fast"]).args(filter))
}
