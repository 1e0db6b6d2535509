//! `vitral batch`: many pictures and drawings, of which none is lost and none is made twice.
//!
//! | file | what |
//! |---|---|
//! | `job.rs` | jobs, and their commands |
//! | `record.rs` | the record of finished jobs |
//! | `pool.rs` | processes side by side, and the share of each |
//! | `worker.rs` | a process that does jobs |

mod job;
mod pool;
mod record;
pub(crate) mod worker;

use crate::batch_args::BatchArgs;
use crate::interrupt;
use crate::progress::Progress;
use crate::report::{self, Failure};
use job::{Job, Task};
use pool::Pool;
use record::Record;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use worker::Reply;

/// Exit code of a batch in which a job failed.
const SOME_FAILED: u8 = 1;

/// How many jobs there were of each outcome.
#[derive(Default)]
struct Counts {
    done: usize,
    skipped: usize,
    failed: usize,
}

/// Runs the verb; gives the exit code.
pub(crate) fn run(args: &BatchArgs) -> Result<u8, Failure> {
    // List the jobs, those of one shard alone if one was typed.
    let start = Instant::now();
    let mut jobs = job::all(args)?;
    if let Some(shard) = args.shard {
        // What can be no job fails in the first part.
        jobs.retain(|job| {
            job.task.as_ref().map_or(shard.index == 0, |task| task.part(shard.count) == shard.index)
        });
    }

    // Read the record of finished jobs.
    let path = record_of(args);
    let mut record = Record::read(&path)
        .map_err(|e| Failure::with_code(3, format!("{}: {e}", path.display())))?;

    // Report jobs that are finished or impossible, and collect the others.
    let mut told = Told { args, counts: Counts::default(), progress: None };
    let mut waiting = Vec::new();
    for job in &jobs {
        match &job.task {
            Err(why) => told.failed(&job.id, 2, std::slice::from_ref(why))?,
            Ok(task) if record.has(task) => told.skipped(&job.id, task)?,
            Ok(_) => waiting.push(job),
        }
    }

    // List the waiting jobs instead of doing them, for a dry run.
    if args.dry_run {
        for (id, task) in waiting.iter().filter_map(|job| Some((&job.id, job.task.as_ref().ok()?)))
        {
            told.would_do(id, task)?;
        }
        return Ok(if told.counts.failed > 0 { SOME_FAILED } else { 0 });
    }

    // Do the waiting jobs, and sum up.
    if !(args.fail_fast && told.counts.failed > 0) {
        do_all(args, &waiting, path, &mut told)?;
    }
    told.summary(jobs.len(), start)
}

/// Where the record is.
fn record_of(args: &BatchArgs) -> PathBuf {
    match (&args.record, &args.file) {
        (Some(record), _) => record.clone(),
        (None, Some(file)) if !report::is_standard(file) => file.with_extension("done.jsonl"),
        _ => "batch.done.jsonl".into(),
    }
}

/// Does the jobs that wait.
fn do_all(
    args: &BatchArgs,
    waiting: &[&Job],
    record: PathBuf,
    told: &mut Told<'_>,
) -> Result<(), Failure> {
    // Watch for interruptions, and share the processors out among the processes.
    interrupt::watch();
    let stop = AtomicBool::new(false);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let processes = if args.jobs == 0 { cores } else { args.jobs as usize };
    let threads = (cores / processes.min(waiting.len().max(1))).max(1);
    let pool = Pool { processes, threads, record, stop: &stop };

    // Show a progress bar for the jobs.
    told.progress = Some(Progress::new(
        args.progress.unwrap_or_default(),
        args.quiet,
        waiting.len() as u64,
        "jobs",
    ));

    // Run the pool; stop it at an interruption, a failed report or, with --fail-fast, a failed job.
    let mut trouble = None;
    pool.run(waiting, |id, task, reply| {
        let reported = told.replied(id, task, reply);
        let is_failed = reply.code != 0 && args.fail_fast;
        if is_failed || interrupt::is_asked() || reported.is_err() {
            stop.store(true, Ordering::Relaxed);
        }
        trouble = trouble.take().or(reported.err());
    })?;

    // Remove the bar, and pass the first failed report on.
    told.progress.iter().for_each(Progress::finish);
    trouble.map_or(Ok(()), Err)
}

/// Tells of jobs as they end.
struct Told<'a> {
    args: &'a BatchArgs,
    counts: Counts,
    progress: Option<Progress>,
}

impl Told<'_> {
    /// A line about a job on standard output, if these are wanted.
    fn line(&self, value: &Value) -> Result<(), Failure> {
        if !self.args.json {
            return Ok(());
        }
        let mut line = value.to_string();
        line.push('\n');
        report::print(line.as_bytes())
    }

    fn replied(&mut self, id: &str, task: &Task, reply: &Reply) -> Result<(), Failure> {
        if reply.code != 0 {
            self.failed(id, reply.code, &reply.told)?;
        } else {
            self.counts.done += 1;
            if !self.args.quiet && !self.args.json {
                self.say(id, &reply.told);
            }
            self.line(&json!({
                "id": id, "status": "done", "model": task.models, "outputs": reply.outputs, "seconds": reply.seconds,
                "warnings": reply.told,
            }))?;
        }

        // Move the bar.
        self.progress.iter_mut().for_each(Progress::step);
        Ok(())
    }

    fn failed(&mut self, id: &str, code: u8, why: &[String]) -> Result<(), Failure> {
        // Count the job, and tell why it failed.
        self.counts.failed += 1;
        if !self.args.json {
            self.say(&format!("job {id} failed ({code})"), why);
        }
        self.line(&json!({"id": id, "status": "failed", "code": code, "message": why.join("; ")}))
    }

    fn skipped(&mut self, id: &str, task: &Task) -> Result<(), Failure> {
        // Count the job, and list it in a dry run.
        self.counts.skipped += 1;
        if self.args.dry_run && !self.args.json {
            report::print(format!("done {id} {}\n", task.output).as_bytes())?;
        }
        self.line(&json!({"id": id, "status": "skipped", "outputs": [task.output]}))
    }

    fn would_do(&self, id: &str, task: &Task) -> Result<(), Failure> {
        match self.args.json {
            // Other programs than this one hand jobs out, too: they need the job's hash and its
            // command.
            true => self.line(&json!({
                "id": id, "status": "waiting", "model": task.models, "outputs": [task.output], "job": task.hash(),
                "command": task.command,
            })),
            false => report::print(format!("waits {id} {}\n", task.output).as_bytes()),
        }
    }

    /// Lines about a job on standard error, above the bar.
    fn say(&self, about: &str, lines: &[String]) {
        // Hide the bar while the lines are written.
        let say = || lines.iter().for_each(|line| report::line(&format!("{about}: {line}")));
        match &self.progress {
            Some(Progress::Bar(bar, _)) => bar.suspend(say),
            _ => say(),
        }
    }

    /// What became of all; gives the exit code.
    fn summary(&self, jobs: usize, start: Instant) -> Result<u8, Failure> {
        let (Counts { done, skipped, failed }, seconds) =
            (&self.counts, start.elapsed().as_secs_f64());
        if !self.args.quiet {
            let rate = *done as f64 / seconds.max(1e-9);
            report::line(&format!(
                "{jobs} jobs: {done} done, {skipped} skipped, {failed} failed in {seconds:.1} s ({rate:.1} a second)"
            ));
        }

        // Choose the exit code: an interruption counts more than failed jobs.
        if interrupt::is_asked() {
            return Ok(interrupt::INTERRUPTED);
        }
        Ok(if *failed > 0 { SOME_FAILED } else { 0 })
    }
}
