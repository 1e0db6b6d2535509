//! `cargo xtask lab`: the Lab's engine as WebAssembly, its page by npm, and a `vitral` with both
//! inside.

use crate::checks::{Check, CheckResult};
use crate::prepare::{self, WASM_TARGET};
use crate::shell::{Outcome, cargo, command, repository, run, target_folder};
use crate::test;
use crate::wasm;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// The profile of the module.
const PROFILE: &str = "lab";

/// The package of the module, and the module's file.
const PACKAGE: &str = "vitral-lab-wasm";
const MODULE: &str = "vitral_lab.wasm";

/// Lets the linker write addresses with as few bytes as they need: 5 % of the module.
const SHORT_ADDRESSES: &str = "link-arg=--compress-relocations";

/// Modules are built with other flags than programs, in a folder of their own.
const FOLDER: &str = "wasm-lab";

/// Builds everything; the command lies in `target/release`.
pub(crate) fn run_all() -> Outcome {
    build_inside()?;
    run(cargo().args(["build", "--release", "--package", "vitral-cli", "--features", "lab"]))
}

/// Builds what a `vitral` with the feature `lab` holds: the page and the engine.
pub(crate) fn build_inside() -> Outcome {
    build_page()?;
    build_engine()
}

/// Whether that lies there.
pub(crate) fn is_built() -> bool {
    sources().join("dist").join(MODULE).exists()
}

/// The folder of the page's sources.
fn sources() -> PathBuf {
    repository().join("lab")
}

/// Installs what the page needs, and bundles it into `lab/dist`.
fn build_page() -> Outcome {
    prepare::npm()?;
    run(command("npm").args(["ci", "--no-audit", "--no-fund"]).current_dir(sources()))?;
    run(command("npm").args(["run", "build"]).current_dir(sources()))
}

/// Builds the module, and lays it beside the page.
fn build_engine() -> Outcome {
    let folder = target_folder().join(FOLDER);
    let mut build = cargo();
    build.env("RUSTFLAGS", wasm::SIMD).env_remove("CARGO_ENCODED_RUSTFLAGS");
    build.args(["rustc", "--profile", PROFILE, "--package", PACKAGE, "--target", WASM_TARGET]);
    run(build.arg("--target-dir").arg(&folder).args(["--", "-C", SHORT_ADDRESSES]))?;
    place_engine(&folder.join(WASM_TARGET).join(PROFILE))
}

/// Copies the module from the folder it was built in.
fn place_engine(folder: &Path) -> Outcome {
    let (module, place) = (folder.join(MODULE), sources().join("dist").join(MODULE));
    fs::copy(&module, &place).map(drop).map_err(|e| format!("{}: {e}", place.display()))
}

/// Tests the page's own functions under Node, then the page in a browser, with a module that is
/// built quickly and runs slowly. `missing` says why there can be no module.
pub(crate) fn test_all(missing: Option<&str>) -> Vec<Check> {
    let missing = missing.map(str::to_owned).or_else(|| prepare::npm().err());
    if let Some(why) = missing {
        return vec![Check { name: "lab", result: CheckResult::Skipped(why) }];
    }
    let tried =
        |outcome: Outcome| outcome.map_or_else(CheckResult::Failed, |()| CheckResult::Passed);
    let page = build_page()
        .and_then(|()| run(command("npm").args(["run", "unit"]).current_dir(sources())));
    let is_built = page.is_ok();
    let browser = match prepare::browser() {
        Err(why) => CheckResult::Skipped(why),
        Ok(()) if !is_built => CheckResult::Skipped("the page was not built".to_owned()),
        Ok(()) => tried(test_page()),
    };
    vec![
        Check { name: "lab::functions", result: tried(page) },
        Check { name: "lab::page", result: browser },
    ]
}

/// Builds a `vitral` with the Lab inside, lets it serve, and tests the page that it serves.
fn test_page() -> Outcome {
    place_engine(&wasm::build_with_vectors(PACKAGE)?)?;
    let build = [
        "build",
        "--quiet",
        "--profile",
        test::PROFILE,
        "--package",
        "vitral-cli",
        "--features",
        "lab",
    ];
    run(cargo().args(build))?;
    let program =
        target_folder().join(test::PROFILE).join(format!("vitral{}", std::env::consts::EXE_SUFFIX));
    let mut serve = command(&program);
    serve.args(["lab", "--no-open"]).stdout(Stdio::piped());
    let mut server = serve.spawn().map_err(|e| format!("{}: {e}", program.display()))?;

    // It prints its address, and serves until it is told to end.
    let mut url = String::new();
    let read = server.stdout.take().map(|out| BufReader::new(out).read_line(&mut url));
    let tested = match read {
        Some(Ok(1..)) => {
            let mut tests = command("npm");
            run(tests.args(["run", "page"]).current_dir(sources()).env("LAB_URL", url.trim()))
        }
        _ => Err("the server printed no address".to_owned()),
    };
    let ended = server
        .kill()
        .and_then(|()| server.wait())
        .map(drop)
        .map_err(|e| format!("the server: {e}"));
    tested.and(ended)
}
