//! Options of `vitral batch`, and those of `render` and `draw` among them.

use crate::args::Cli;
use crate::help::EXIT_CODES;
use crate::render_args::ProgressWhen;
use crate::values;
use clap::{Arg, Args, Command, CommandFactory};
use std::ffi::OsString;
use std::path::PathBuf;
use std::str::FromStr;

/// Options of `vitral batch`.
///
/// A job is a line of JSON: {"model": "a.glb", "output": "out/a.png", "options": {"resolution":
/// "256x256"}, "id": "a"}. `model` may be a list. `options` are those of `vitral render`, or of
/// `vitral draw` where the output is a drawing; `options` and `id` may be left out. Paths are
/// relative to the current folder. Options of render and draw that are typed beside those below
/// hold for every job that does not set them itself.
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct BatchArgs {
    /// The jobs, one JSON object per line; `-` is standard input
    #[arg(value_name = "JOBS", required_unless_present = "glob")]
    pub(crate) file: Option<PathBuf>,
    /// Make a job of each file that matches, as in 'models/**/*.stl'; repeatable
    #[arg(long, value_name = "PATTERN", requires = "output", conflicts_with = "file")]
    pub(crate) glob: Vec<String>,
    /// With --glob: where each picture goes; {model} is the file's name without its extension
    #[arg(long, short, value_name = "PATH", requires = "glob")]
    pub(crate) output: Option<String>,
    /// Do only the I-th of N parts of the jobs, I from 1 to N. Each job is in the same part on
    /// every machine
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Shard>,
    /// Processes that work at the same time; 0 means as many as there are cores
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::whole(0..=4096u32))]
    pub(crate) jobs: u32,
    /// Print one JSON object for each job on standard output
    #[arg(long)]
    pub(crate) json: bool,
    /// Go on after a job that failed (the default)
    #[arg(long, conflicts_with = "fail_fast")]
    pub(crate) keep_going: bool,
    /// Stop at the first job that fails
    #[arg(long)]
    pub(crate) fail_fast: bool,
    /// Print what would be done, and do nothing
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// File that records which jobs are done [default: JOBS with .done.jsonl for its extension;
    /// batch.done.jsonl with --glob or standard input]
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    /// When to show how far the batch is [default: auto]
    #[arg(long, value_name = "WHEN")]
    pub(crate) progress: Option<ProgressWhen>,
    /// Print no warnings and no summary
    #[arg(long, short)]
    pub(crate) quiet: bool,
    /// Options of render and draw for every job
    #[arg(last = true, value_name = "OPTIONS")]
    pub(crate) options: Vec<OsString>,
}

/// Options of a process that does jobs; `vitral batch` starts them.
#[derive(Args, Debug)]
pub(crate) struct BatchWorkerArgs {
    /// The record of finished jobs.
    #[arg(long)]
    pub(crate) record: PathBuf,
    /// Threads of jobs that do not say how many they take.
    #[arg(long)]
    pub(crate) threads: usize,
}

/// One of several parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    /// Which, from 0.
    pub(crate) index: u64,
    /// How many there are.
    pub(crate) count: u64,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text
            .split_once('/')
            .and_then(|(i, n)| Some((i.parse::<u64>().ok()?, n.parse::<u64>().ok()?)));
        match parts {
            Some((i, n)) if (1..=n).contains(&i) => Ok(Self { index: i - 1, count: n }),
            Some((0, _)) => Err("parts are counted from 1".to_owned()),
            _ => Err("I/N is required, such as 1/4".to_owned()),
        }
    }
}

/// Moves options of other verbs that are typed among those of `batch` behind `--`.
pub(crate) fn arrange(arguments: Vec<OsString>) -> Vec<OsString> {
    if arguments.get(1).is_none_or(|verb| verb != "batch") {
        return arguments;
    }
    let cli = Cli::command();
    let own = cli.find_subcommand("batch").expect("it is a verb");
    let (mut kept, mut moved) = (arguments[..2].to_vec(), Vec::new());
    let mut rest = arguments.into_iter().skip(2);
    while let Some(argument) = rest.next() {
        if argument == "--" {
            moved.extend(rest);
            break;
        }
        let name = argument
            .to_str()
            .and_then(|text| text.strip_prefix("--"))
            .unwrap_or_default()
            .to_owned();
        let (name, has_value) =
            name.split_once('=').map_or((name.as_str(), false), |(name, _)| (name, true));
        let found = if name.is_empty() { None } else { option(own, name) };
        let other =
            if found.is_none() && !name.is_empty() { other_option(&cli, name) } else { None };
        let takes_value = found.or(other).is_some_and(takes_value) && !has_value;
        let place = if other.is_some() { &mut moved } else { &mut kept };
        place.push(argument);
        place.extend(takes_value.then(|| rest.next()).flatten());
    }
    if !moved.is_empty() {
        kept.push("--".into());
        kept.append(&mut moved);
    }
    kept
}

/// An option of a verb, by its long name.
pub(crate) fn option<'c>(verb: &'c Command, name: &str) -> Option<&'c Arg> {
    verb.get_arguments().find(|argument| {
        argument.get_long() == Some(name)
            || argument.get_all_aliases().is_some_and(|all| all.contains(&name))
    })
}

/// An option of render or draw.
fn other_option<'c>(cli: &'c Command, name: &str) -> Option<&'c Arg> {
    ["render", "draw"].iter().find_map(|verb| option(cli.find_subcommand(verb)?, name))
}

/// Whether an option is followed by a value of its own.
pub(crate) fn takes_value(argument: &Arg) -> bool {
    argument.get_action().takes_values()
        && argument.get_num_args().is_none_or(|count| count.min_values() > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_other_verbs_go_behind() {
        let of = |words: &[&str]| -> Vec<String> {
            let typed = ["vitral", "batch"].iter().chain(words).map(OsString::from).collect();
            arrange(typed).into_iter().skip(2).map(|word| word.into_string().unwrap()).collect()
        };
        assert_eq!(
            of(&["--samples", "4", "jobs.jsonl", "--json", "--resolution=8x8", "--wireframe"]),
            ["jobs.jsonl", "--json", "--", "--samples", "4", "--resolution=8x8", "--wireframe"]
        );
        assert_eq!(
            of(&["--glob", "*.stl", "-o", "{model}.png"]),
            ["--glob", "*.stl", "-o", "{model}.png"]
        );
        assert_eq!(
            of(&["j", "--nonsense", "--", "--style", "filled"]),
            ["j", "--nonsense", "--", "--style", "filled"]
        );
        let other = vec!["vitral".into(), "render".into(), "--samples".into()];
        assert_eq!(arrange(other.clone()), other);
    }

    #[test]
    fn shards_are_counted_from_one() {
        assert_eq!("2/8".parse(), Ok(Shard { index: 1, count: 8 }));
        for wrong in ["0/4", "5/4", "1", "a/b", "1/0"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
