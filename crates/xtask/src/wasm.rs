//! The WebAssembly test: one picture, drawn natively and by the same code under Node, must have the
//! same bytes.
//!
//! The probe (`crates/wasm-probe`) is built without threads, once plain and once with simd128, and
//! each time the hash of its bytes is compared with that of the native program. Crates are compiled
//! once for each variant; the native program is what the tests have built.

use crate::checks::{Check, CheckResult};
use crate::prepare::WASM_TARGET;
use crate::shell::{cargo, command, output, run, target_folder};
use crate::test::PROFILE;
use std::path::PathBuf;

const PACKAGE: &str = "vitral-wasm-probe";
/// The compiler takes six times as long to optimise the kernels for WebAssembly at level 2, and the
/// pictures are small.
const OPT_LEVEL: &str = "1";

/// Flags of modules with vectors, and the folder below cargo's in which they are built.
pub(crate) const SIMD: &str = "-C target-feature=+simd128";
const SIMD_FOLDER: &str = "wasm-simd128";

/// A set of compiler flags.
struct Variant {
    name: &'static str,
    flags: &'static str,
    /// Below cargo's folder. Modules have the same file name whatever their flags, so that each
    /// variant needs its own folder. The scalar one shares procedural macros with the check of the
    /// OpenGL machine.
    folder: &'static str,
}

const VARIANTS: [Variant; 2] = [
    Variant { name: "wasm::scalar", flags: "", folder: "" },
    Variant { name: "wasm::simd128", flags: SIMD, folder: SIMD_FOLDER },
];

/// Runs all variants, unless `missing` says why that cannot be.
pub(crate) fn run_all(missing: Option<&str>) -> Vec<Check> {
    let native = match missing {
        Some(_) => Ok(String::new()),
        None => native_hash(),
    };
    let check = |variant: Variant| {
        let result = match (missing, &native) {
            (Some(why), _) => CheckResult::Skipped(why.to_owned()),
            (None, Err(why)) => CheckResult::Failed(why.clone()),
            (None, Ok(native)) => match hash_under_node(&variant) {
                Ok(hash) if hash == *native => CheckResult::Passed,
                Ok(hash) => CheckResult::Failed(format!(
                    "native bytes have the hash {native}, WebAssembly's {hash}"
                )),
                Err(why) => CheckResult::Failed(why),
            },
        };
        Check { name: variant.name, result }
    };
    let mut checks: Vec<Check> = VARIANTS.into_iter().map(check).collect();
    checks.push(Check {
        name: "wasm::opengl",
        result: missing.map_or_else(opengl, |why| CheckResult::Skipped(why.to_owned())),
    });
    checks
}

/// The OpenGL machine builds for WebAssembly; nothing there calls it yet, so that it is only
/// checked.
fn opengl() -> CheckResult {
    match run(cargo().args([
        "check",
        "--quiet",
        "--profile",
        PROFILE,
        "--package",
        "vitral-gl",
        "--target",
        WASM_TARGET,
    ])) {
        Ok(()) => CheckResult::Passed,
        Err(why) => CheckResult::Failed(why),
    }
}

/// Builds a package's library with vectors, as the tests' modules are built; gives the folder of
/// the modules.
pub(crate) fn build_with_vectors(package: &str) -> Result<PathBuf, String> {
    let folder = target_folder().join(SIMD_FOLDER);
    run(module(SIMD).args(["--package", package, "--target-dir"]).arg(&folder))?;
    Ok(folder.join(WASM_TARGET).join(PROFILE))
}

/// The command that builds a library's module.
fn module(flags: &str) -> std::process::Command {
    let mut build = cargo();
    build.env("RUSTFLAGS", flags).env_remove("CARGO_ENCODED_RUSTFLAGS");
    build.env(format!("CARGO_PROFILE_{}_OPT_LEVEL", PROFILE.to_uppercase()), OPT_LEVEL);
    build.args(["build", "--quiet", "--profile", PROFILE, "--lib", "--target", WASM_TARGET]);
    build
}

/// The hash that the native program prints, which was built with the tests: one of the probe's asks
/// for it.
fn native_hash() -> Result<String, String> {
    let program =
        target_folder().join(PROFILE).join(format!("{PACKAGE}{}", std::env::consts::EXE_SUFFIX));
    output(&mut command(program)).map(|hash| hash.trim().to_owned())
}

/// Builds one variant and runs it; gives the hash that it prints.
fn hash_under_node(variant: &Variant) -> Result<String, String> {
    let folder: PathBuf = target_folder().join(variant.folder);
    run(module(variant.flags)
        .args(["--package", PACKAGE, "--no-default-features", "--target-dir"])
        .arg(&folder))?;
    let module = folder.join(WASM_TARGET).join(PROFILE).join("vitral_wasm_probe.wasm");
    output(command("node").arg("crates/wasm-probe/run.mjs").arg(module))
        .map(|hash| hash.trim().to_owned())
}
