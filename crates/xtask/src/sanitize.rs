//! `cargo xtask sanitize`: tools that see wrong uses of memory watch libOSMesa, the one crate that
//! handles pointers of C.
//!
//! * Miri interprets the unit tests of `crates/osmesa`, among them a client of the C functions
//!   (`client.rs`).
//! * Valgrind's memcheck watches all scenes, threads, forks and endings of `scene_runner`, and the
//!   client in C.
//! * ThreadSanitizer and AddressSanitizer watch scenes and threads of `scene_runner`, faster, and
//!   with the standard library.
//!
//! Valgrind comes from Debian, the others from a nightly toolchain. What cannot be installed is
//! told and counts as a failure.

use crate::prepare::debian_packages;
use crate::shell::{Outcome, cargo, command, output, relative, repository, run, target_folder};
use std::path::Path;
use std::process::Command;

/// Modes of the runner's `--lifecycle`. Not `wild`: it leaves arguments undefined on purpose.
const MODES: [&str; 10] = [
    "threads",
    "moved",
    "destroyed-elsewhere",
    "buffer-gone",
    "exit",
    "exit-beside-thread",
    "close",
    "callback",
    "functions",
    "attributes",
];

/// More, for Valgrind: the sanitizers have no threads after a fork. `growth` is for the test suite
/// alone: these tools' own memory grows.
const MORE_MODES: [&str; 2] = ["fork", "fork-while-drawing"];

/// Where the sanitized libraries are for; they need a target by name.
const TARGET: &str = "x86_64-unknown-linux-gnu";

/// A tool by its name.
type Tool = (&'static str, fn() -> Outcome);

/// Runs those of `tools` that are named, or all.
pub(crate) fn run_all(wanted: &[&str]) -> Outcome {
    let tools: [Tool; 4] = [
        ("miri", miri),
        ("valgrind", valgrind),
        ("thread", || sanitizer("thread")),
        ("address", || sanitizer("address")),
    ];
    if let Some(unknown) = wanted.iter().find(|name| tools.iter().all(|(tool, _)| tool != *name)) {
        return Err(format!("there is no tool {unknown}: miri, valgrind, thread, address"));
    }
    let mut failed = Vec::new();
    for (name, tool) in
        tools.into_iter().filter(|(name, _)| wanted.is_empty() || wanted.contains(name))
    {
        println!("== {name}");
        if let Err(why) = tool() {
            println!("{why}");
            failed.push(name);
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(format!("failed: {}", failed.join(", "))) }
}

/// The nightly cargo, with these components.
fn nightly(components: &[&str]) -> Result<Command, String> {
    let has = |name: &str| {
        let list = output(command("rustup").args([
            "component",
            "list",
            "--toolchain",
            "nightly",
            "--installed",
        ]));
        list.is_ok_and(|list| list.lines().any(|line| line.starts_with(name)))
    };
    if !components.iter().all(|name| has(name)) {
        println!("installing a nightly toolchain with {}", components.join(" and "));
        let mut install = command("rustup");
        install.args(["toolchain", "install", "nightly", "--profile", "minimal"]);
        for name in components {
            install.args(["--component", name]);
        }
        output(&mut install).map_err(|why| format!("could not install: {why}"))?;
    }
    let mut words = command("rustup");
    // The cargo that runs us names its own toolchain to its children.
    words.env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO").args(["run", "nightly", "cargo"]);
    Ok(words)
}

/// Where a tool's build lies: it must not replace that of other commands.
fn folder(tool: &str) -> std::path::PathBuf {
    target_folder().join("sanitize").join(tool)
}

fn miri() -> Outcome {
    let mut words = nightly(&["miri", "rust-src"])?;
    words
        .args(["miri", "test", "--package", "vitral-osmesa", "--lib", "--target-dir"])
        .arg(folder("miri"));
    // Addresses come from C as numbers. One thread: Miri counts what threads still hold at the end
    // as lost.
    words
        .env("MIRIFLAGS", "-Zmiri-permissive-provenance -Zmiri-disable-isolation")
        .env("VITRAL_THREADS", "1");
    run(&mut words)
}

fn sanitizer(name: &str) -> Outcome {
    let target = folder(name);
    let cargo = |subcommand: &str, what: &[&str]| {
        let mut words = nightly(&["rust-src"])?;
        words.args([
            subcommand,
            "--package",
            "vitral-osmesa",
            "-Zbuild-std",
            "--target",
            TARGET,
            "--target-dir",
        ]);
        words.arg(&target).args(what);
        words.env("RUSTFLAGS", format!("-Zsanitizer={name} -Zexport-executable-symbols"));
        run(words.env("CARGO_PROFILE_DEV_DEBUG", "line-tables-only"))
    };
    // Asked for by itself, the library comes to the folder's top, where it has the same name with
    // every cargo.
    cargo("build", &["--lib"])?;
    // The program has the sanitizer's functions, and the library finds them there.
    cargo("rustc", &["--example", "scene_runner", "--", "-Clink-arg=-Wl,--export-dynamic"])?;

    let debug = target.join(TARGET).join("debug");
    let (runner, library) = (debug.join("examples/scene_runner"), debug.join("libOSMesa.so"));
    let watched = || {
        let mut words = command(&runner);
        // Clients leave contexts behind; Valgrind tells what leaks.
        words.env("VITRAL_THREADS", "4").env("ASAN_OPTIONS", "detect_leaks=0");
        words
    };
    output(watched().arg(&library).arg(target.join("scenes")))?;
    for mode in MODES {
        println!("{mode}");
        output(watched().args(["--lifecycle", mode]).arg(&library))?;
    }
    Ok(())
}

fn valgrind() -> Outcome {
    // Build the library and the runner with the lines of the code.
    debian_packages(&["valgrind", "libc6-dbg", "gcc", "libc6-dev", "libgl-dev"])?;
    let target = folder("valgrind");
    let mut build = cargo();
    build.args([
        "build",
        "--package",
        "vitral-osmesa",
        "--lib",
        "--example",
        "scene_runner",
        "--target-dir",
    ]);
    run(build.arg(&target).env("CARGO_PROFILE_DEV_DEBUG", "line-tables-only"))?;
    let debug = target.join("debug");
    let (runner, library) = (debug.join("examples/scene_runner"), debug.join("libOSMesa.so"));

    // Watch the scenes and the modes of the lifecycle.
    let scenes = target.join("scenes");
    watch(&runner, "definite", |words| {
        words.arg(&library).arg(&scenes);
    })?;
    for mode in MODES.into_iter().chain(MORE_MODES) {
        // In the others the client itself leaves contexts behind, or the parent's threads are gone.
        let leaks = if matches!(mode, "threads" | "close") { "definite" } else { "none" };
        println!("{mode}");
        watch(&runner, leaks, |words| {
            words.args(["--lifecycle", mode]).arg(&library);
        })?;
    }

    // Build and watch the client in C.
    println!("buffers.c");
    let program = target.join("buffers");
    let named = target.join("libOSMesa.so.8");
    std::fs::copy(&library, &named).map_err(|e| format!("{}: {e}", named.display()))?;
    let sources = repository().join("crates/osmesa");
    let mut compile = command("cc");
    compile
        .arg(sources.join("tests/clients/buffers.c"))
        .arg(format!("-I{}", sources.join("include").display()));
    run(compile.args(["-g", "-O1"]).arg(&named).args(["-lm", "-o"]).arg(&program))?;
    watch(&program, "definite", |words| {
        words.arg(&target).env("LD_LIBRARY_PATH", &target);
    })
}

/// Runs a program under memcheck; any finding, and any leak of these kinds, is a failure.
fn watch(program: &Path, leaks: &str, arguments: impl FnOnce(&mut Command)) -> Outcome {
    let mut words = command("valgrind");
    words.args([
        "--quiet",
        "--error-exitcode=99",
        "--leak-check=full",
        "--show-leak-kinds=definite",
    ]);
    words.arg(format!("--errors-for-leak-kinds={leaks}")).arg(program).env("VITRAL_THREADS", "3");
    arguments(&mut words);
    output(&mut words).map(drop).map_err(|why| format!("{}: {why}", relative(program)))
}
