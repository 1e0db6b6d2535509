//! Jobs: a line of JSON each, or a file that matches a pattern.

use crate::args::Cli;
use crate::batch_args::{BatchArgs, option, takes_value};
use crate::hashes::hexadecimal;
use crate::options::{Given, option_words};
use crate::outputs::model_name;
use crate::report::Failure;
use clap::CommandFactory;
use serde::Deserialize;
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

/// Largest file of jobs, in bytes.
const MOST_BYTES: u64 = 4 << 30;

/// Options that have no place in a batch: they read or print what belongs to all jobs.
const NOT_IN_A_BATCH: [&str; 6] = ["output", "json", "pixel", "progress", "help", "version"];

/// A picture or drawing that is to be made.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Job {
    /// Its name in reports: its own, or that of its line or file.
    pub(crate) id: String,
    /// What it asks for; or why it can be none.
    pub(crate) task: Result<Task, String>,
}

/// What a job asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Task {
    pub(crate) models: Vec<String>,
    pub(crate) output: String,
    /// The command without `vitral`: verb, models, options, output.
    pub(crate) command: Vec<String>,
}

impl Task {
    /// The same for the same task done by the same version, in hexadecimal digits.
    pub(crate) fn hash(&self) -> String {
        // Hash the version and the words, each behind its length so that words cannot run together.
        let mut hash = Sha256::new();
        for part in std::iter::once(env!("CARGO_PKG_VERSION"))
            .chain(self.command.iter().map(String::as_str))
        {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        }
        hexadecimal(&hash.finalize())
    }

    /// The part of `count` parts that it is in.
    pub(crate) fn part(&self, count: u64) -> u64 {
        u64::from_str_radix(&self.hash()[..16], 16).expect("a hash has hexadecimal digits") % count
    }
}

/// A job as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    model: Models,
    output: String,
    #[serde(default)]
    options: Map<String, Value>,
    id: Option<Value>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Models {
    One(String),
    Several(Vec<String>),
}

/// All jobs of the command line, in their order.
pub(crate) fn all(args: &BatchArgs) -> Result<Vec<Job>, Failure> {
    // Read the options for all jobs, then the jobs.
    let commands = Commands::new(&args.options)?;
    let jobs = match &args.file {
        Some(file) => written(&text_of(file)?, &commands),
        None => matching(args, &commands)?,
    };

    // Refuse jobs that write one file.
    check_outputs(&jobs)?;
    Ok(jobs)
}

fn text_of(file: &Path) -> Result<String, Failure> {
    // Read standard input or the file, up to the limit.
    let mut bytes = Vec::new();
    if file.as_os_str() == "-" {
        let read = std::io::stdin().lock().take(MOST_BYTES).read_to_end(&mut bytes);
        read.map_err(|e| Failure::with_code(3, format!("standard input: {e}")))?;
    } else {
        bytes = vitral::read(file, MOST_BYTES)?;
    }

    // Refuse bytes that are not text.
    String::from_utf8(bytes)
        .map_err(|_| Failure::with_code(3, format!("{}: it is not UTF-8", file.display())))
}

/// Jobs that are written line by line. What cannot be read is a job that fails.
fn written(text: &str, commands: &Commands) -> Vec<Job> {
    // Number the lines, and skip empty ones.
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());

    // Parse each line; a line that fails becomes a job that fails.
    let job = |(number, line): (usize, &str)| {
        let place = format!("line {}", number + 1);
        match serde_json::from_str::<Line>(line) {
            Err(e) => Job { id: place, task: Err(format!("it cannot be read: {e}")) },
            Ok(Line { model, output, options, id }) => {
                // Name the job by its own id, or else by its line.
                let id = match id {
                    None => place,
                    Some(Value::String(text)) => text,
                    Some(other) => other.to_string(),
                };

                // Accept one model or a list of them.
                let models = match model {
                    Models::One(model) => vec![model],
                    Models::Several(models) => models,
                };
                Job { id, task: commands.task(models, output, &options) }
            }
        }
    };
    lines.map(job).collect()
}

/// Jobs of files that match patterns, in the order of their names.
fn matching(args: &BatchArgs, commands: &Commands) -> Result<Vec<Job>, Failure> {
    // Collect the files, each once.
    let mut files = Vec::new();
    for pattern in &args.glob {
        let found =
            glob::glob(pattern).map_err(|e| Failure::usage(format!("--glob {pattern}: {e}")))?;
        let before = files.len();
        files.extend(found.filter_map(Result::ok).filter(|path| path.is_file()));
        if files.len() == before {
            return Err(Failure::with_code(3, format!("--glob {pattern}: no file matches"))
                .with_hint("quote the pattern, so that the shell leaves it alone"));
        }
    }

    // Sort them, and drop files that several patterns match.
    files.sort();
    files.dedup();

    // Name the output of each.
    let pattern = args.output.as_deref().unwrap_or_default();
    let job = |file: &std::path::PathBuf| {
        let model = file.to_string_lossy().into_owned();
        let output = pattern.replace("{model}", &model_name(file).to_string_lossy());
        Job { id: model.clone(), task: commands.task(vec![model], output, &Map::new()) }
    };
    Ok(files.iter().map(job).collect())
}

/// Refuses jobs that write over each other.
fn check_outputs(jobs: &[Job]) -> Result<(), Failure> {
    // Note the job of each output, and stop at the first output that has one already.
    let mut outputs: BTreeMap<&str, &str> = BTreeMap::new();
    for (id, task) in jobs.iter().filter_map(|job| Some((&job.id, job.task.as_ref().ok()?))) {
        if let Some(other) = outputs.insert(&task.output, id) {
            let message = format!("the jobs {other} and {id} both write {}", task.output);
            return Err(Failure::usage(message).with_hint("give each job a file of its own"));
        }
    }
    Ok(())
}

/// Makes commands of jobs.
struct Commands {
    cli: clap::Command,
    /// Options for every job that does not say otherwise: the name of each, and the words as typed.
    defaults: Vec<(String, Vec<String>)>,
}

impl Commands {
    fn new(options: &[std::ffi::OsString]) -> Result<Self, Failure> {
        let cli = Cli::command();
        let mut defaults = Vec::new();
        let mut rest = options.iter().map(|word| word.to_string_lossy().into_owned());
        while let Some(word) = rest.next() {
            // Find the option by its name.
            let name = word
                .strip_prefix("--")
                .map(|name| name.split_once('=').map_or(name, |(name, _)| name));
            let name = name.filter(|name| !name.is_empty()).ok_or_else(|| {
                Failure::usage(format!("{word}: an option for all jobs begins with --"))
            })?;
            let found =
                ["render", "draw"].iter().find_map(|verb| option(cli.find_subcommand(verb)?, name));
            let found =
                found.ok_or_else(|| Failure::usage(format!("there is no option --{name}")))?;

            // Refuse options that have no place in a batch.
            if NOT_IN_A_BATCH.contains(&name) {
                return Err(Failure::usage(format!("--{name} cannot be used in a batch")));
            }

            // Take its value along.
            let mut typed = vec![word.clone()];
            if takes_value(found) && !word.contains('=') {
                typed.extend(rest.next());
            }
            defaults.push((name.to_owned(), typed));
        }
        Ok(Self { cli, defaults })
    }

    /// The command of a job.
    fn task(
        &self,
        models: Vec<String>,
        output: String,
        options: &Map<String, Value>,
    ) -> Result<Task, String> {
        // Choose the verb by the extension of the output.
        let verb = if is_drawing(&output) { "draw" } else { "render" };
        let known = self.cli.find_subcommand(verb).expect("it is a verb");

        // Refuse standard input and output, which the processes use for orders and replies.
        if models.is_empty() || models.iter().any(|model| model == "-") || output == "-" {
            return Err("a job reads models from files and writes a file".to_owned());
        }

        // Take the options for all that this verb has and the job does not give itself.
        let mut command = vec![verb.to_owned()];
        let wanted = self
            .defaults
            .iter()
            .filter(|(name, _)| option(known, name).is_some() && !options.contains_key(name));
        command.extend(wanted.flat_map(|(_, typed)| typed.iter().cloned()));

        // Add the job's own, the output and the models.
        for (name, value) in options {
            let found = option(known, name)
                .ok_or_else(|| format!("vitral {verb} has no option `{name}`"))?;
            if NOT_IN_A_BATCH.contains(&name.as_str()) {
                return Err(format!("the option `{name}` cannot be used in a batch"));
            }
            if let Some(given) = given(name, value)? {
                command.extend(
                    option_words(found, name, &given)
                        .map_err(|why| format!("the option `{name}`: {why}"))?,
                );
            }
        }

        // Name the output, and keep the process from drawing a progress bar.
        command.extend([
            "--output".to_owned(),
            output.clone(),
            "--progress".to_owned(),
            "never".to_owned(),
        ]);

        // End the options, so that a model may begin with a dash.
        command.push("--".to_owned());
        command.extend(models.iter().cloned());
        Ok(Task { models, output, command })
    }
}

/// Whether a file of this name is a drawing.
fn is_drawing(output: &str) -> bool {
    let extension =
        Path::new(output).extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    ["svg", "pdf", "dxf", "hpgl", "plt"]
        .iter()
        .any(|drawing| extension.eq_ignore_ascii_case(drawing))
}

/// The value of an option; `None` for `null`.
fn given(name: &str, value: &Value) -> Result<Option<Given>, String> {
    // Write strings and numbers as words, and refuse other values.
    let text = |value: &Value| match value {
        Value::String(text) => Ok(text.clone()),
        Value::Number(number) => Ok(number.to_string()),
        _ => Err(format!("the option `{name}` has no value that can be: {value}")),
    };

    // Turn each JSON type into the way in which it is typed.
    Ok(match value {
        Value::Null => None,
        Value::Bool(is_on) => Some(Given::Switch(*is_on)),
        Value::Array(values) => {
            let texts = values.iter().map(text).collect::<Result<Vec<_>, _>>()?;
            // A size is one value.
            Some(if name == "resolution" {
                Given::Text(texts.join("x"))
            } else {
                Given::List(texts)
            })
        }
        value => Some(Given::Text(text(value)?)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jobs(text: &str, options: &[&str]) -> Vec<Job> {
        let options: Vec<_> = options.iter().map(std::ffi::OsString::from).collect();
        written(text, &Commands::new(&options).unwrap())
    }

    #[test]
    fn a_line_becomes_a_command() {
        let text = concat!(
            r#"{"model": "a.obj", "output": "a.png", "options": {"resolution": [64, 48], "samples": 1, "wireframe": true, "lighting": false}}"#,
            "\n\n",
            r#"{"model": ["a.obj", "b.stl"], "output": "b.svg", "options": {"style": "filled"}, "id": 7}"#,
        );
        let all = jobs(text, &["--samples", "16", "--threads=2"]);
        assert_eq!((all[0].id.as_str(), all[1].id.as_str()), ("line 1", "7"));
        let command = |job: &Job| job.task.as_ref().unwrap().command.join(" ");
        let end = "--output a.png --progress never -- a.obj";
        let first = command(&all[0]);
        assert!(first.starts_with("render --threads=2 ") && first.ends_with(end), "{first}");
        for part in ["--resolution=64x48", "--samples=1", " --wireframe ", "--lighting=off"] {
            assert!(first.contains(part), "{first}");
        }
        let second =
            "draw --threads=2 --style=filled --output b.svg --progress never -- a.obj b.stl";
        assert_eq!(command(&all[1]), second);
    }

    #[test]
    fn what_cannot_be_a_job_says_why() {
        let why = |line: &str| jobs(line, &[])[0].task.clone().unwrap_err();
        assert!(why("{").contains("cannot be read"));
        assert!(why(r#"{"model": "a", "output": "a.png", "size": 3}"#).contains("size"));
        assert!(
            why(r#"{"model": "a", "output": "a.png", "options": {"sampels": 3}}"#)
                .contains("`sampels`")
        );
        assert!(
            why(r#"{"model": "a", "output": "a.png", "options": {"json": true}}"#)
                .contains("cannot be used")
        );
        assert!(why(r#"{"model": "a", "output": "-"}"#).contains("writes a file"));
        assert!(
            why(r#"{"model": "a", "output": "a.png", "options": {"samples": {}}}"#)
                .contains("samples")
        );
        let twice = jobs(
            "{\"model\": \"a\", \"output\": \"x.png\"}\n{\"model\": \"b\", \"output\": \"x.png\"}",
            &[],
        );
        assert!(check_outputs(&twice).is_err());
        assert!(Commands::new(&["--nonsense".into()]).is_err());
    }

    #[test]
    fn parts_hold_each_job_once() {
        let text: String =
            (0..200).map(|i| format!("{{\"model\": \"a\", \"output\": \"{i}.png\"}}\n")).collect();
        let all = jobs(&text, &[]);
        let count =
            |part: u64| all.iter().filter(|job| job.task.as_ref().unwrap().part(4) == part).count();
        let counts: Vec<_> = (0..4).map(count).collect();
        assert_eq!(counts.iter().sum::<usize>(), 200);
        assert!(counts.iter().all(|count| (25..75).contains(count)), "{counts:?}");
    }
}
