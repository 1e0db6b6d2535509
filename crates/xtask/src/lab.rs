//! `cargo xtask lab`: the Lab's engine as WebAssembly, its page by npm, and a `vitral` with both inside.

use crate::prepare::WASM_TARGET;
use crate::shell::{Outcome, cargo, command, repository, run, target_folder};
use std::fs;
use std::path::PathBuf;

/// The profile of the module: the release's, stripped.
const PROFILE: &str = "lab";

/// Modules are built with other flags than programs, in a folder of their own.
const FOLDER: &str = "wasm-lab";

/// Builds everything; the command lies in `target/release`.
pub(crate) fn run_all() -> Outcome {
    build_page()?;
    build_engine(None)?;
    run(cargo().args(["build", "--release", "--package", "vitral-cli", "--features", "lab"]))
}

/// The folder of the page's sources.
fn sources() -> PathBuf {
    repository().join("lab")
}

/// Installs what the page needs, and bundles it into `lab/dist`.
pub(crate) fn build_page() -> Outcome {
    run(command("npm").args(["ci", "--no-audit", "--no-fund"]).current_dir(sources()))?;
    run(command("npm").args(["run", "build"]).current_dir(sources()))
}

/// Builds the module and lays it beside the page; at another level than the release's if one is given.
pub(crate) fn build_engine(level: Option<&str>) -> Outcome {
    let folder = target_folder().join(FOLDER);
    let mut build = cargo();
    build.env("RUSTFLAGS", "-C target-feature=+simd128").env_remove("CARGO_ENCODED_RUSTFLAGS");
    if let Some(level) = level {
        build.env(format!("CARGO_PROFILE_{}_OPT_LEVEL", PROFILE.to_uppercase()), level);
    }
    build.args(["build", "--profile", PROFILE, "--package", "vitral-lab-wasm", "--target", WASM_TARGET]);
    run(build.arg("--target-dir").arg(&folder))?;
    let module = folder.join(WASM_TARGET).join(PROFILE).join("vitral_lab.wasm");
    let place = sources().join("dist").join("vitral_lab.wasm");
    fs::copy(&module, &place).map(drop).map_err(|e| format!("{}: {e}", place.display()))
}
