//! The WebAssembly test: one picture, drawn natively and by the same code under Node, must have the same bytes.
//!
//! The probe (`crates/wasm-probe`) is built without threads, once plain and once with simd128, and each time the hash of
//! its bytes is compared with that of the native program.

use crate::prepare::WASM_TARGET;
use crate::shell::{cargo, command, output, run, target_folder};

const PACKAGE: &str = "vitral-wasm-probe";

/// How one check ended.
pub(crate) enum CheckResult {
    Passed,
    Failed(String),
    Skipped(String),
}

impl std::fmt::Display for CheckResult {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Passed => write!(f, "ok"),
            Self::Failed(why) => write!(f, "FAILED\n{why}"),
            Self::Skipped(why) => write!(f, "skipped: {why}"),
        }
    }
}

/// A check with its name.
pub(crate) struct Check {
    pub(crate) name: &'static str,
    pub(crate) result: CheckResult,
}

/// Name of each variant and the compiler flags that make it.
const VARIANTS: [(&str, &str); 2] = [("scalar", ""), ("simd128", "-C target-feature=+simd128")];

/// Runs all variants, unless `missing` says why that cannot be.
pub(crate) fn run_all(missing: Option<&str>) -> Vec<Check> {
    let native = match missing {
        Some(_) => Ok(String::new()),
        None => output(cargo().args(["run", "--quiet", "--package", PACKAGE])).map(|hash| hash.trim().to_owned()),
    };
    let check = |(name, flags)| {
        let result = match (missing, &native) {
            (Some(why), _) => CheckResult::Skipped(why.to_owned()),
            (None, Err(why)) => CheckResult::Failed(why.clone()),
            (None, Ok(native)) => match hash_under_node(name, flags) {
                Ok(hash) if hash == *native => CheckResult::Passed,
                Ok(hash) => CheckResult::Failed(format!("native bytes have the hash {native}, WebAssembly's {hash}")),
                Err(why) => CheckResult::Failed(why),
            },
        };
        Check { name, result }
    };
    let mut checks: Vec<Check> = VARIANTS.into_iter().map(check).collect();
    checks.push(Check {
        name: "opengl",
        result: missing.map_or_else(opengl, |why| CheckResult::Skipped(why.to_owned())),
    });
    checks
}

/// The OpenGL machine builds for WebAssembly; nothing there calls it yet, so that it is only checked.
fn opengl() -> CheckResult {
    match run(cargo().args(["check", "--quiet", "--package", "vitral-gl", "--target", WASM_TARGET])) {
        Ok(()) => CheckResult::Passed,
        Err(why) => CheckResult::Failed(why),
    }
}

/// Builds one variant and runs it; gives the hash that it prints. Each variant has a build folder of its own, since
/// other flags mean other files.
fn hash_under_node(name: &str, flags: &str) -> Result<String, String> {
    let folder = target_folder().join(format!("wasm-{name}"));
    let mut build = cargo();
    build.env("RUSTFLAGS", flags).env_remove("CARGO_ENCODED_RUSTFLAGS");
    build.args(["build", "--quiet", "--lib", "--package", PACKAGE, "--no-default-features", "--target", WASM_TARGET]);
    run(build.arg("--target-dir").arg(&folder))?;
    let module = folder.join(WASM_TARGET).join("debug/vitral_wasm_probe.wasm");
    output(command("node").arg("crates/wasm-probe/run.mjs").arg(module)).map(|hash| hash.trim().to_owned())
}
