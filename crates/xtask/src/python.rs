//! The Python package: `cargo xtask wheel` builds it, `cargo xtask test` tests it in a virtual
//! environment of its own.

use crate::checks::{Check, CheckResult};
use crate::prepare::debian_packages;
use crate::shell::{Outcome, command, output, repository, run, target_folder};
use std::path::{Path, PathBuf};

/// What builds the package.
const BUILDERS: [&str; 2] = ["maturin>=1.9,<2", "numpy"];

/// What tests it.
const TESTERS: [&str; 3] = ["pytest", "mypy", "ruff"];

/// Other people's programs that the tests use where they can be had; tests that miss one say so and
/// are skipped.
const CLIENTS: [&str; 10] = [
    "trimesh",
    "mujoco",
    "gymnasium",
    "imageio",
    "dm_control",
    "PyOpenGL",
    "glfw",
    "ray[data]",
    "nbclient",
    "ipykernel",
];

/// Programs that want a MuJoCo of their own, older than the newest.
const OLDER: [&str; 5] = ["pytest", "mujoco<3.4", "robosuite", "dm_control", "PyOpenGL"];

/// The package's own sources and tests.
const SOURCES: &str = "crates/python";

/// The most that a wheel may take, in bytes.
const BELOW: u64 = 15_000_000;

/// Builds the wheel in release, and tells its size.
pub(crate) fn wheel() -> Outcome {
    let python = environment("venv", &BUILDERS)?;
    let folder = target_folder().join("wheels");
    let wheel = build(&python, &folder, None, &[])?;
    let bytes = std::fs::metadata(&wheel).map_err(|e| format!("{}: {e}", wheel.display()))?.len();
    println!("{}: {:.2} MB", crate::shell::relative(&wheel), bytes as f64 / 1e6);
    if bytes < BELOW {
        Ok(())
    } else {
        Err(format!("the wheel has {bytes} bytes; it is to stay below {BELOW}"))
    }
}

/// Builds the wheel with this profile and a library that is there already, every file dated with
/// this time; gives its path.
pub(crate) fn wheel_of(
    folder: &Path,
    profile: &str,
    library: &Path,
    time: u64,
) -> Result<PathBuf, String> {
    let python = environment("venv", &BUILDERS)?;
    let (library, time) = (library.display().to_string(), time.to_string());
    build(
        &python,
        folder,
        Some(profile),
        &[("VITRAL_OSMESA", &library), ("SOURCE_DATE_EPOCH", &time)],
    )
}

/// Builds and installs the package with this profile, then runs its tests, types, examples and the
/// style of its sources.
pub(crate) fn test_all(profile: &str) -> Vec<Check> {
    let skipped = |why: String| vec![Check { name: "python", result: CheckResult::Skipped(why) }];
    let python = match environment("venv", &[&BUILDERS[..], &TESTERS].concat()) {
        Ok(python) => python,
        Err(why) => return skipped(why),
    };
    for client in CLIENTS {
        if let Err(why) = install(&python, &[client]) {
            println!(
                "could not install: {client}: {}",
                why.lines().next_back().unwrap_or_default()
            );
        }
    }
    let check = |name: &'static str, outcome: Outcome| {
        let result = outcome.map_or_else(CheckResult::Failed, |()| CheckResult::Passed);
        Check { name, result }
    };
    let installed = build(&python, &target_folder().join("python/wheels"), Some(profile), &[])
        .and_then(|wheel| {
            let wheel = wheel.display().to_string();
            install(&python, &["--force-reinstall", "--no-deps", &wheel]).map(|()| wheel)
        });
    let mut checks = vec![check("python::style", tool(&python, &["ruff", "check", SOURCES]))];
    let wheel = installed.as_ref().ok().cloned();
    checks.push(check("python::wheel", installed.map(drop)));
    if let Some(wheel) = wheel {
        let tests = format!("{SOURCES}/tests");
        checks.push(check(
            "python::tests",
            tool(&python, &["pytest", "-rs", "-p", "no:cacheprovider", &tests]),
        ));
        checks.push(check("python::types", tool(&python, &["mypy"])));
        checks.push(check("python::stubs", tool(&python, &["mypy.stubtest", "vitral._vitral"])));
        checks.push(Check { name: "python::older_programs", result: test_older(&wheel) });
    }
    checks
}

/// Tests OpenGL with programs that want an older MuJoCo, in an environment of their own.
fn test_older(wheel: &str) -> CheckResult {
    let python = environment("older", &OLDER).and_then(|python| {
        install(&python, &["--force-reinstall", "--no-deps", wheel]).map(|()| python)
    });
    let python = match python {
        Ok(python) => python,
        Err(why) => return CheckResult::Skipped(why),
    };
    let tests = format!("{SOURCES}/tests/test_osmesa.py");
    let which = ["-k", "dm_control or robosuite"];
    let words = [&["pytest", "-rs", "-p", "no:cacheprovider"][..], &which, &[&tests]].concat();
    tool(&python, &words).map_or_else(CheckResult::Failed, |()| CheckResult::Passed)
}

/// Runs a module of Python on the sources.
fn tool(python: &Path, words: &[&str]) -> Outcome {
    run(command(python).arg("-m").args(words).env("PYTHONDONTWRITEBYTECODE", "1"))
}

/// Builds a wheel into an empty folder, with these environment variables; gives its path.
fn build(
    python: &Path,
    folder: &Path,
    profile: Option<&str>,
    variables: &[(&str, &str)],
) -> Result<PathBuf, String> {
    let shown = |e: std::io::Error| format!("{}: {e}", folder.display());
    let _ = std::fs::remove_dir_all(folder);
    std::fs::create_dir_all(folder).map_err(shown)?;
    let mut pip = command(python);
    pip.args(["-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir"]);
    pip.arg(folder).arg(repository()).envs(variables.iter().copied());
    if let Some(profile) = profile {
        pip.env("VITRAL_PROFILE", profile);
    }
    // The scripts of the environment, maturin among them, come first.
    let scripts = python.parent().unwrap_or(Path::new("."));
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::iter::once(scripts.to_path_buf()).chain(std::env::split_paths(&path));
    run(pip.env("PATH", std::env::join_paths(path).map_err(|e| e.to_string())?))?;
    let files =
        std::fs::read_dir(folder).map_err(shown)?.filter_map(|entry| Some(entry.ok()?.path()));
    let mut wheels = files.filter(|file| file.extension().is_some_and(|e| e == "whl"));
    wheels.next().ok_or_else(|| format!("{}: pip made no wheel", folder.display()))
}

/// The Python of a virtual environment of this name in cargo's folder, with these packages.
fn environment(name: &str, packages: &[&str]) -> Result<PathBuf, String> {
    let folder = target_folder().join("python").join(name);
    let python = folder.join("bin/python");
    if !python.exists() {
        let make = || output(command("python3").args(["-m", "venv"]).arg(&folder)).map(drop);
        if make().is_err() {
            debian_packages(&["python3-venv"])?;
            make()?;
        }
    }
    let is_new_enough = "import sys; sys.exit(sys.version_info < (3, 10))";
    output(command(&python).args(["-c", is_new_enough]))
        .map_err(|_| "Python 3.10 or newer is needed".to_owned())?;
    install(&python, packages)?;
    Ok(python)
}

/// Installs packages from PyPI, or wheels.
fn install(python: &Path, packages: &[&str]) -> Outcome {
    let mut pip = command(python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(packages);
    output(&mut pip).map(drop)
}
