//! Whether limits hold: `--time-limit`, `--max-memory` and `--max-segments` on meshes that are too
//! much for them.

use super::process::watch;
use super::subjects::{folder, generated};
use crate::shell::command;
use std::path::Path;

/// Seconds after which a command is killed.
const KILL_AFTER: f64 = 60.0;

/// Seconds of `--time-limit`, and how much later the command may end.
const TIME: (f64, f64) = (2.0, 0.5);

/// Mebibytes of `--max-memory`, and the share by which the process may be larger.
const MEMORY: (u64, f64) = (200, 0.1);

/// Segments of `--max-segments`.
const SEGMENTS: u64 = 10_000;

/// One command and what became of it.
pub(super) struct Held {
    pub(super) mesh: &'static str,
    pub(super) options: String,
    pub(super) code: Option<i32>,
    pub(super) seconds: f64,
    pub(super) peak: Option<u64>,
    /// The last line of its standard error that is no hint.
    pub(super) said: String,
    /// Whether the command kept to the limit.
    pub(super) kept: bool,
}

/// Tries all limits on all meshes, as lines and as surfaces.
pub(super) fn measure(vitral: &Path) -> Result<Vec<Held>, String> {
    let meshes = [
        ("torus knot, 1 000 000", generated("knot", 1_000_000)?),
        ("100 000 random triangles", generated("small", 100_000)?),
        ("100 000 triangles across the cube", generated("large", 100_000)?),
    ];
    let limits = [
        format!("--time-limit {}", TIME.0),
        format!("--max-memory {}M", MEMORY.0),
        format!("--max-segments {SEGMENTS}"),
    ];
    let mut all = Vec::new();
    for (mesh, path) in &meshes {
        for limit in &limits {
            for style in ["--lines all", "--style filled"] {
                let options = format!("{style} {limit}");
                eprintln!("{mesh}: {options}");
                all.push(held(vitral, mesh, path, &options)?);
            }
        }
    }
    Ok(all)
}

/// Runs one command.
fn held(vitral: &Path, mesh: &'static str, path: &Path, options: &str) -> Result<Held, String> {
    let drawing = folder()?.join("limits.svg");
    let mut words = command(vitral);
    words
        .arg("draw")
        .arg(path)
        .arg("-o")
        .arg(&drawing)
        .args(options.split(' '))
        .args(["--quiet", "--no-config"]);
    let options = options.to_owned();
    let Some(done) = watch(&mut words, KILL_AFTER)? else {
        let said = format!("killed after {KILL_AFTER} s");
        return Ok(Held {
            mesh,
            options,
            code: None,
            seconds: KILL_AFTER,
            peak: None,
            said,
            kept: false,
        });
    };

    // A command that a limit stops says so with code 7; one that ends in time and memory has kept
    // to it, too.
    let code = done.status.code();
    let most = (MEMORY.0 << 20) as f64 * (1.0 + MEMORY.1);
    let kept = matches!(code, Some(0 | 7))
        && (!options.contains("--time-limit") || done.seconds <= TIME.0 + TIME.1)
        && (!options.contains("--max-memory") || done.peak.is_none_or(|peak| peak as f64 <= most));
    let said = done
        .output
        .lines()
        .rev()
        .find(|line| !line.starts_with("hint:"))
        .unwrap_or_default()
        .to_owned();
    Ok(Held { mesh, options, code, seconds: done.seconds, peak: done.peak, said, kept })
}
