//! A process that reads a model first, where several models are drawn one by one under a memory
//! limit.
//!
//! Readers know no limits: a process that asks for more memory ends. So that one model does not end
//! the others, a process of its own tries whether the model can be read, and its exit code tells.
//!
//! Cost: each model is read twice. Only for several models and a limit that was typed.

use crate::allocator::{self, LIMIT};
use crate::program;
use crate::report::Failure;
use clap::Args;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};
use vitral::{LoadOptions, Workers, load_on};

/// How often the process is looked at.
const PAUSE: Duration = Duration::from_millis(5);

/// Options of the process.
#[derive(Args, Debug)]
pub(crate) struct ReadProbeArgs {
    model: PathBuf,
    /// Bytes that it may take.
    #[arg(long)]
    max_memory: u64,
    /// How the model is read, as JSON.
    #[arg(long)]
    load: String,
    #[arg(long)]
    threads: usize,
}

/// Reads the model and forgets it; gives the exit code.
pub(crate) fn run(args: &ReadProbeArgs) -> Result<u8, Failure> {
    let options: LoadOptions =
        serde_json::from_str(&args.load).map_err(|e| Failure::usage(format!("--load: {e}")))?;
    let _held = allocator::hold(args.max_memory);
    // What else is wrong with the model is told by whoever reads it for its picture.
    let _ = load_on(&args.model, &options, &Workers::new(args.threads));
    Ok(0)
}

/// Tries whether a model can be read within `bytes` of this process, as long as there are `left`
/// seconds.
pub(crate) fn check(
    model: &Path,
    options: &LoadOptions,
    threads: usize,
    bytes: u64,
    left: f64,
) -> Result<(), Failure> {
    let text = model.to_string_lossy();
    if text == "-" || text.starts_with("builtin:") {
        return Ok(());
    }

    // Start the process with what this one has left.
    let failed = |e: std::io::Error| {
        Failure::other(format!("no process can be started to read the model: {e}"))
    };
    let free = bytes.saturating_sub(allocator::taken());
    let mut command = program::command().map_err(failed)?;
    command
        .arg("read-probe")
        .arg(format!("--max-memory={free}"))
        .arg(format!("--threads={threads}"));
    command
        .arg("--load")
        .arg(serde_json::to_string(options).expect("every field has a JSON form"))
        .arg("--")
        .arg(model);
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(failed)?;

    // Wait for it. Where the time is over, reading ends at the limit of time.
    let start = Instant::now();
    let status = loop {
        match child.try_wait().map_err(failed)? {
            Some(status) => break status,
            None if start.elapsed().as_secs_f64() > left => {
                // It may have ended in between.
                let _ = child.kill();
                break child.wait().map_err(failed)?;
            }
            None => std::thread::sleep(PAUSE),
        }
    };
    if status.code() != Some(i32::from(LIMIT)) {
        return Ok(());
    }
    let mut told = String::new();
    if let Some(mut stderr) = child.stderr.take() {
        // Without its words the failure is told in others.
        let _ = stderr.read_to_string(&mut told);
    }
    let what = told
        .lines()
        .next()
        .and_then(|line| line.strip_prefix("vitral: "))
        .unwrap_or("the memory limit is reached");
    Err(Failure::with_code(LIMIT, what)
        .with_hint("smaller textures need less memory, or raise --max-memory"))
}
