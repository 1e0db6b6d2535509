//! The models of a command: their names as typed, whether each is drawn by itself, and how one bad
//! model leaves the others alone.

use crate::allocator;
use crate::kept_models;
use crate::outputs::{has_model, model_name};
use crate::read_probe;
use crate::render_args::ProcessArgs;
use crate::report::{self, Failure};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;
use vitral::internals::exec::Achieved;
use vitral::{Budget, Error, Execution, Limit, Scene, State};

/// The names of the models: those that were typed, else those of the state.
pub(crate) fn named(typed: &[PathBuf], state: &State) -> Vec<PathBuf> {
    if typed.is_empty() { state.models.iter().map(PathBuf::from).collect() } else { typed.to_vec() }
}

/// The names as a state holds them, in Unicode.
pub(crate) fn in_unicode(models: &[PathBuf]) -> Vec<String> {
    models.iter().map(|model| model.to_string_lossy().into_owned()).collect()
}

/// Whether each model is drawn by itself: there are several, and one of the outputs names them.
pub(crate) fn are_apart<'o>(
    models: &[PathBuf],
    together: bool,
    outputs: impl IntoIterator<Item = &'o Path>,
) -> bool {
    !together && models.len() > 1 && outputs.into_iter().any(has_model)
}

/// What reading may take.
#[derive(Clone, Copy, Default)]
pub(crate) struct ReadLimits {
    /// Seconds since the budget began.
    time: Option<f64>,
    /// Bytes of the process.
    memory: Option<u64>,
    /// Other models go on where the memory is not enough.
    goes_on: bool,
}

impl ReadLimits {
    /// The limits that were typed.
    pub(crate) fn of(args: &ProcessArgs) -> Self {
        Self { time: args.time_limit, memory: args.max_memory, goes_on: false }
    }

    /// For one of several models, `apart` from the others.
    pub(crate) fn among_others(self, apart: bool) -> Self {
        Self { goes_on: apart, ..self }
    }
}

/// The stack of a thread that reads: as much as the main thread has.
const STACK: usize = 8 << 20;

/// The scene of a state whose models are files of these names, which need not be Unicode. Readers
/// know no limits: beyond that of time they are left to themselves, beyond that of memory the
/// process ends.
pub(crate) fn load_scene(
    state: &State,
    models: &[PathBuf],
    execution: &Execution,
    limits: ReadLimits,
) -> Result<Scene, Failure> {
    if let (Some(bytes), true) = (limits.memory, limits.goes_on) {
        let left = limits.time.map_or(f64::INFINITY, |limit| limit - execution.budget.elapsed());
        let threads = execution.workers.threads();
        models
            .iter()
            .try_for_each(|model| read_probe::check(model, &state.load, threads, bytes, left))?;
    }
    let _held = limits.memory.map(allocator::hold);
    let (state, models, workers) = (state.clone(), models.to_vec(), execution.workers.clone());
    let load = state.load_options();
    let read = move || {
        let mut names = models.iter();
        kept_models::begin();
        state.load_scene_by(|text| {
            let name = names.next().map_or(Path::new(text), PathBuf::as_path);
            kept_models::load(name, &load, &workers)
        })
    };
    let Some(limit) = limits.time else { return Ok(read()?) };

    // Wait for another thread as long as there is time.
    let reached =
        || Error::from(Limit::Time { limit, stage: "loading", achieved: Achieved::default() });
    let left = (limit - execution.budget.elapsed()).max(0.0);
    let left = Duration::try_from_secs_f64(left).unwrap_or(Duration::MAX);
    let (told, waiting) = channel();
    let reader = thread::Builder::new().stack_size(STACK).spawn(move || {
        // Nobody waits any longer where the time is over.
        let _ = told.send(read());
    });
    match reader {
        Ok(_) => Ok(waiting.recv_timeout(left).unwrap_or_else(|_| Err(reached()))?),
        Err(source) => Err(Error::Read { path: "a thread that reads".into(), source }.into()),
    }
}

/// Refuses an option whose one file or answer would come from each of several models.
pub(crate) fn refuse_for_each(option: &str) -> Failure {
    Failure::usage(format!(
        "{option}: it works with one scene, and each model is a scene of its own here"
    ))
    .with_hint("add --together, or leave {model} out of --output")
}

/// Refuses models that would be written into one file; `file` gives that of a model.
pub(crate) fn check_files(
    models: &[PathBuf],
    file: impl Fn(&OsString) -> Result<PathBuf, Failure>,
) -> Result<(), Failure> {
    let mut taken: BTreeMap<PathBuf, &Path> = BTreeMap::new();
    for model in models {
        let file = file(&model_name(model))?;
        let shown = file.display().to_string();
        if let Some(other) = taken.insert(file, model) {
            let what = format!(
                "{} and {} would both be written to {shown}",
                other.display(),
                model.display()
            );
            return Err(Failure::usage(what)
                .with_hint("{model} is the last part of a model's name without its extension"));
        }
    }
    Ok(())
}

/// Does `work` for each model. What fails is told, and the others go on; gives what came of each,
/// and the exit code: that of the first failure.
pub(crate) fn for_each<T>(
    models: &[PathBuf],
    budget: &Budget,
    mut work: impl FnMut(&Path) -> Result<T, Failure>,
) -> (Vec<Result<T, Failure>>, u8) {
    let (mut done, mut code, mut failed) = (Vec::new(), 0, 0);
    for model in models {
        if budget.cancel_flag().load(std::sync::atomic::Ordering::Relaxed) {
            break;
        }
        let result = work(model).map_err(|failure| failure.about(model));
        if let Err(failure) = &result {
            let this = failure.tell();
            code = if code == 0 { this } else { code };
            failed += 1;
        }
        done.push(result);
    }
    if failed > 0 {
        report::line(&format!("{failed} of {} models failed", models.len()));
    }
    (done, code)
}
