//! A process that does jobs one after the other, as `vitral batch` hands them in: a line of JSON
//! each way.
//!
//! A job is a command of its own, whose output is kept back. Models stay in memory for the jobs
//! that follow. A finished job goes onto the record before it is reported. The process ends when
//! nobody is left to report to.

use super::record::{self, Entry};
use crate::batch_args::BatchWorkerArgs;
use crate::hashes::hash_of;
use crate::kept_models;
use crate::report::{self, Failure};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::ffi::OsString;
use std::io::{BufRead, Write};
use std::sync::mpsc;
use std::time::Instant;

/// A job for a process.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Order {
    pub(crate) id: String,
    /// Its hash.
    pub(crate) job: String,
    /// Where it writes, if its command does not say more.
    pub(crate) output: String,
    pub(crate) command: Vec<String>,
}

/// What came of it.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Reply {
    /// The exit code that the command would have had.
    pub(crate) code: u8,
    pub(crate) outputs: Vec<String>,
    /// What it told: warnings, and the failure.
    pub(crate) told: Vec<String>,
    pub(crate) seconds: f64,
}

/// Runs a command.
type Dispatch = fn(Vec<OsString>) -> Result<u8, Failure>;

/// Does jobs until there are no more, each by `dispatch`.
pub(crate) fn run(args: &BatchWorkerArgs, dispatch: Dispatch) -> Result<u8, Failure> {
    // Read orders beside the work: their end is the end of this process, whatever it is at.
    let (send, orders) = mpsc::channel::<Order>();
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines() {
            let order = line.ok().and_then(|line| serde_json::from_str(&line).ok());
            if order.is_none_or(|order| send.send(order).is_err()) {
                break;
            }
        }
        std::process::exit(0);
    });

    kept_models::keep();
    for order in orders {
        let reply = serde_json::to_string(&done(order, args, dispatch)).expect("keys are strings");
        let mut out = std::io::stdout().lock();
        if writeln!(out, "{reply}").and_then(|()| out.flush()).is_err() {
            break;
        }
    }
    Ok(0)
}

/// Does a job, and puts it on record.
fn done(order: Order, args: &BatchWorkerArgs, dispatch: Dispatch) -> Reply {
    let start = Instant::now();
    let is_picture = order.command.first().is_some_and(|verb| verb == "render");
    let mut typed = vec!["vitral".to_owned()];
    typed.extend(order.command.iter().cloned());

    // Options go before the models.
    let place = typed.iter().rposition(|word| word == "--").unwrap_or(typed.len());
    if is_picture {
        typed.insert(place, "--json".to_owned());
    }
    if !order.command.iter().any(|word| word == "--threads" || word.starts_with("--threads=")) {
        typed.insert(place, format!("--threads={}", args.threads));
    }

    // Run the command, and keep what it prints and reports.
    report::keep();
    let result = make_folder(&order.output)
        .and_then(|()| dispatch(typed.into_iter().map(Into::into).collect()));
    let (mut code, failure) = match result {
        Ok(code) => (code, None),
        Err(failure) => (failure.code(), Some(failure)),
    };
    failure.iter().for_each(|failure| {
        failure.tell();
    });
    let (printed, mut told) = report::take();

    // Name what was written.
    let outputs = match serde_json::from_slice::<Value>(&printed) {
        Ok(result) if is_picture => {
            serde_json::from_value(result["outputs"].clone()).unwrap_or_default()
        }
        _ if code == 0 => vec![order.output.clone()],
        _ => Vec::new(),
    };

    // Put a finished job on record.
    let seconds = start.elapsed().as_secs_f64();
    if code == 0 {
        let entry = Entry {
            job: order.job,
            id: order.id,
            inputs: kept_models::files(),
            outputs: outputs
                .iter()
                .filter_map(|path| Some((path.clone(), hash_of(path)?)))
                .collect(),
            seconds,
            vitral: env!("CARGO_PKG_VERSION").to_owned(),
        };
        if let Err(e) = record::append(&args.record, &entry) {
            code = 5;
            told.push(format!("{}: {e}", args.record.display()));
        }
    }
    Reply { code, outputs, told, seconds }
}

/// Makes the folder of a job's file.
fn make_folder(output: &str) -> Result<(), Failure> {
    let folder =
        std::path::Path::new(output).parent().filter(|folder| !folder.as_os_str().is_empty());
    let Some(folder) = folder else { return Ok(()) };
    std::fs::create_dir_all(folder)
        .map_err(|e| Failure::with_code(5, format!("{}: {e}", folder.display())))
}
