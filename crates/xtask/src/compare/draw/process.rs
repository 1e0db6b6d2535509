//! One process from its start to its end: seconds, processor time and the most memory, within a
//! limit.

use crate::shell::target_folder;
use crate::spent::Stopwatch;
use std::fs::File;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// How long to wait between two looks at a process: a memory peak shorter than that is missed.
const PAUSE: Duration = Duration::from_millis(2);

/// What a process took.
#[derive(Clone, Debug)]
pub(super) struct Finished {
    /// Seconds on the clock.
    pub(super) seconds: f64,
    /// Seconds of processor time of all threads.
    pub(super) processor: Option<f64>,
    /// The most memory it had resident, bytes, where `/proc` tells.
    pub(super) peak: Option<u64>,
    /// How it ended.
    pub(super) status: ExitStatus,
    /// Its standard output and standard error.
    pub(super) output: String,
}

/// Runs a command; `None` where it is killed after `limit` seconds.
pub(super) fn watch(command: &mut Command, limit: f64) -> Result<Option<Finished>, String> {
    // Files take any amount of output without a reader.
    let path = target_folder().join("compare-draw/output.txt");
    let text =
        |error: std::io::Error| format!("{}: {error}", command.get_program().to_string_lossy());
    let file = File::create(&path).map_err(text)?;
    let same = file.try_clone().map_err(text)?;

    // Look at the process until it ends.
    let (watch, start) = (Stopwatch::start(), Instant::now());
    let mut child = command
        .stdin(Stdio::null())
        .stdout(file)
        .stderr(same)
        .spawn()
        .map_err(|e| format!("it cannot start: {e}"))?;
    let mut peak = None;
    let status = loop {
        peak = resident(&child).max(peak);
        if let Some(status) = child.try_wait().map_err(|e| e.to_string())? {
            break status;
        }
        if start.elapsed().as_secs_f64() > limit {
            let _ = child.kill();
            let _ = child.wait();
            return Ok(None);
        }
        std::thread::sleep(PAUSE);
    };
    let spent = watch.spent();
    let output = String::from_utf8_lossy(&std::fs::read(&path).unwrap_or_default()).into_owned();
    Ok(Some(Finished {
        seconds: spent.wall.as_secs_f64(),
        processor: spent.cpu.map(|cpu| cpu.as_secs_f64()),
        peak,
        status,
        output,
    }))
}

/// The most memory that a running process had resident, bytes.
fn resident(child: &Child) -> Option<u64> {
    high_water_mark(&std::fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?)
}

/// Reads `VmHWM` of proc_pid_status(5), which is in units of 1024 bytes.
fn high_water_mark(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.split_whitespace().next()?.parse::<u64>().ok()? * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_high_water_mark_is_in_kibibytes() {
        assert_eq!(
            high_water_mark("Name:\tcat\nVmHWM:\t    1200 kB\nVmRSS:\t 4 kB\n"),
            Some(1_228_800)
        );
        assert_eq!(high_water_mark("Name:\tcat\n"), None);
    }
}
