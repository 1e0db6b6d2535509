//! The command line as typed: verbs, and the options of all verbs but `render`.

use crate::batch_args::{BatchArgs, BatchWorkerArgs};
use crate::draw_args::DrawArgs;
use crate::help::{self, EXIT_CODES, model_help, model_long_help};
use crate::lab_args::LabPageArgs;
use crate::read_probe::ReadProbeArgs;
use crate::render_args::{CameraArgs, EyeArgs, RenderArgs};
use crate::values;
use clap::{Args, CommandFactory, Parser, Subcommand};
use std::path::PathBuf;
use vitral::Visibility;

/// Renders 3D models to pictures, without GPU, display or GL driver.
///
/// `vitral MODEL -o OUT.png` is short for `vitral render MODEL -o OUT.png`, `vitral help VERB` for
/// `vitral VERB --help`.
#[derive(Debug, Parser)]
#[command(
    name = "vitral",
    version,
    arg_required_else_help = true,
    disable_help_subcommand = true,
    max_term_width = help::WIDTH
)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

/// What `vitral` can do.
#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Make a picture of one or more models
    Render(Box<RenderArgs>),
    /// Make a vector drawing of one or more models: visible and hidden lines
    Draw(Box<DrawArgs>),
    /// Make many pictures and drawings in parallel; a batch that was interrupted continues
    Batch(Box<BatchArgs>),
    #[command(hide = true)]
    BatchWorker(BatchWorkerArgs),
    #[command(hide = true)]
    ReadProbe(ReadProbeArgs),
    /// Open the Lab in a browser: watch the classical algorithms step by step
    Lab(LabPageArgs),
    /// List the contents of a model file
    Info(InfoArgs),
    /// Make the small picture of a model that file managers show
    Thumbnail(ThumbnailArgs),
    /// Compare two pictures; exit code 6 when they differ
    Compare(CompareArgs),
    /// Measure every visible-surface algorithm on one model: time, memory, counters, agreement with
    /// the z-buffer
    Bench(Box<BenchArgs>),
    /// List the algorithms
    Algorithms(ListArgs),
    /// List the formats that are read and written, and the built-in scenes
    Formats(ListArgs),
    /// Print the line that makes programs use vitral's OpenGL (libOSMesa), for the shell's `eval`
    OsmesaEnv(OsmesaEnvArgs),
    /// Print a completion script for a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual, or write a page for each verb
    Man(ManArgs),
}

/// Options of `vitral man`.
#[derive(Args, Debug)]
pub(crate) struct ManArgs {
    /// Folder for vitral.1, vitral-render.1, ... [default: one page on standard output]
    #[arg(value_name = "DIR")]
    pub(crate) folder: Option<PathBuf>,
}

/// Options of `vitral info`.
#[derive(Args, Debug)]
pub(crate) struct InfoArgs {
    #[arg(required = true, value_name = "MODEL", help = model_help(), long_help = model_long_help())]
    pub(crate) models: Vec<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(crate) json: bool,
    /// Let models read files outside their folder
    #[arg(long)]
    pub(crate) allow_external: bool,
    /// Threads; 0 means as many as the process may use [default: VITRAL_THREADS, else 0]
    #[arg(long, value_name = "N", value_parser = values::threads, allow_negative_numbers = true)]
    pub(crate) threads: Option<usize>,
    /// Print no warnings
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

/// Options of `vitral thumbnail`.
///
/// File managers call it as `vitral thumbnail %i %o %s`. The picture is a square PNG with a
/// transparent background, whatever OUT is called. No configuration file is read. A thumbnail may
/// take 20 s and 1 GB of memory; beyond that it fails with exit code 7.
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ThumbnailArgs {
    /// The model file
    #[arg(value_name = "IN")]
    pub(crate) model: PathBuf,
    /// Where the picture goes; its folder must exist
    #[arg(value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Width and height in pixels, 1 to 4096
    #[arg(value_name = "SIZE", value_parser = values::whole(1..=4096u32))]
    pub(crate) size: u32,
}

/// Options of `vitral compare`.
#[derive(Args, Debug)]
pub(crate) struct CompareArgs {
    /// The expected picture, or `-` for standard input
    #[arg(value_name = "A")]
    pub(crate) first: PathBuf,
    /// The actual picture, or `-` for standard input
    #[arg(value_name = "B")]
    pub(crate) second: PathBuf,
    /// How far a channel may differ before its pixel counts as different, from 0 to 1 of the range
    #[arg(long, value_name = "F", default_value_t = 0.0, value_parser = values::share, allow_negative_numbers = true)]
    pub(crate) threshold: f64,
    /// Write a picture of the difference: the first picture in grey, with differing pixels in red
    #[arg(long, value_name = "OUT")]
    pub(crate) diff: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(crate) json: bool,
    /// Print nothing
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

/// Options of `vitral bench`.
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES, next_help_heading = help::MEASUREMENT)]
pub(crate) struct BenchArgs {
    #[arg(required_unless_present = "report", value_name = "MODEL", help = model_help(), long_help = model_long_help())]
    pub(crate) models: Vec<PathBuf>,
    /// Measure how time grows with the number of polygons and of pixels, on a scene of its own, and
    /// write visibility-report.md with plots into this folder
    #[arg(long, value_name = "DIR", conflicts_with_all = ["json", "resolution", "samples", "visibility", "CameraArgs", "EyeArgs"])]
    pub(crate) report: Option<PathBuf>,
    /// With --report: compare the polygons of painter, bsp and weiler-atherton with exact drawings,
    /// of its own scenes and of the models, and write drawing-report.md with its pictures
    #[arg(long, requires = "report")]
    pub(crate) drawings: bool,
    /// Measure only these algorithms and the z-buffer; repeatable [default: all]
    #[arg(long, value_name = "NAME", value_parser = crate::choices::visibility())]
    pub(crate) visibility: Vec<Visibility>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", value_parser = values::resolution, default_value = "1024x768")]
    pub(crate) resolution: [u32; 2],
    /// Samples per pixel, 1 to 16, or 32
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = values::samples)]
    pub(crate) samples: u32,
    /// Pictures whose median time is taken, after a first one that is not counted
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = values::whole(1..=1000u32))]
    pub(crate) frames: u32,
    /// Seconds for each algorithm; one that does not finish says so in its row, and the others go
    /// on
    #[arg(help_heading = help::LIMITS)]
    #[arg(long, value_name = "S", value_parser = values::positive, default_value_t = 20.0)]
    pub(crate) time_limit: f64,
    /// Memory that each algorithm may take, such as 512M or 1G [default: the limit of the machine
    /// or control group, where Linux tells it]
    #[arg(help_heading = help::LIMITS)]
    #[arg(long, value_name = "B", value_parser = values::bytes)]
    pub(crate) max_memory: Option<u64>,
    /// Let models read files outside their folder
    #[arg(help_heading = help::FILES)]
    #[arg(long)]
    pub(crate) allow_external: bool,
    /// Threads; 0 means as many as the process may use [default: VITRAL_THREADS, else 0]
    #[arg(help_heading = help::LIMITS)]
    #[arg(long, value_name = "N", value_parser = values::threads, allow_negative_numbers = true)]
    pub(crate) threads: Option<usize>,
    /// Print the results as one JSON object on standard output
    #[arg(help_heading = help::REPORTS)]
    #[arg(long)]
    pub(crate) json: bool,
    /// Print no warnings and no progress
    #[arg(help_heading = help::REPORTS)]
    #[arg(long, short)]
    pub(crate) quiet: bool,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
    #[command(flatten)]
    pub(crate) eye: EyeArgs,
}

/// Options of the lists.
#[derive(Args, Debug)]
pub(crate) struct ListArgs {
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `vitral osmesa-env`.
#[derive(Args, Debug)]
pub(crate) struct OsmesaEnvArgs {
    /// The folder with libOSMesa.so.8 [default: looked for beside this program]
    #[arg(long, value_name = "DIR")]
    pub(crate) lib: Option<PathBuf>,
}

/// The definition of the command line, with choices in upper and lower case alike.
pub(crate) fn command() -> clap::Command {
    // Options that take no value cannot have a case.
    let any_case = |option: clap::Arg| {
        if option.get_action().takes_values() { option.ignore_case(true) } else { option }
    };
    Cli::command().mut_subcommands(|verb| help::with_groups(verb.mut_args(any_case)))
}

/// The arguments with the verb `render` put in where none was typed: `vitral MODEL -o OUT`. What is
/// neither a verb nor looks like a model stays, to be refused as a verb. `help VERB GROUP` and
/// `--help VERB GROUP` become `VERB --help GROUP`.
pub(crate) fn with_verb(mut arguments: Vec<std::ffi::OsString>) -> Vec<std::ffi::OsString> {
    // Turn `help VERB GROUP` into `VERB --help GROUP`.
    let is_verb = |word: &str| Cli::command().get_subcommands().any(|c| c.get_name() == word);
    let names_verb = arguments.get(2).and_then(|word| word.to_str()).is_some_and(is_verb);
    if arguments.get(1).is_some_and(|a| a == "help" || a == "--help" && names_verb) {
        arguments.remove(1);
        arguments.truncate(3);
        arguments.insert(arguments.len().min(2), "--help".into());
        return arguments;
    }

    // Return if nothing was typed.
    let Some(first) = arguments.get(1).map(|a| a.to_string_lossy().into_owned()) else {
        return arguments;
    };

    // Insert the verb before a word that may be a model or an option of `render` and `draw`.
    let first = first.as_str();
    let general = ["-h", "--help", "-V", "--version"].contains(&first);
    if !general && !is_verb(first) && may_be_model(&arguments[1]) {
        let verb = if names_drawing(&arguments) { "draw" } else { "render" };
        arguments.insert(1, verb.into());
    }
    arguments
}

/// Whether a word may be the name of a model: it is no plain word, or there is a file of that name.
pub(crate) fn may_be_model(word: &std::ffi::OsStr) -> bool {
    // Take a word for plain if it begins with a letter and has no character of paths or patterns.
    let text = word.to_string_lossy();
    let is_plain = text.starts_with(|c: char| c.is_ascii_alphabetic())
        && !text.contains(['.', '/', '\\', ':', '{']);
    !is_plain || std::path::Path::new(word).exists()
}

/// Whether the arguments have an output whose extension is that of a drawing.
fn names_drawing(arguments: &[std::ffi::OsString]) -> bool {
    let mut texts = arguments.iter().map(|argument| argument.to_string_lossy());
    while let Some(text) = texts.next() {
        // Find the output in each form in which it can be typed; behind `--` all words are models.
        let output = match (&*text, text.strip_prefix("--output="), text.strip_prefix("-o")) {
            ("--", ..) => return false,
            ("-o" | "--output", ..) => texts.next().map(|next| next.into_owned()),
            (_, Some(value), _) => Some(value.to_owned()),
            (_, None, Some(value)) => Some(value.trim_start_matches('=').to_owned()),
            _ => None,
        };

        // Look its extension up among those of drawings.
        let extension =
            output.as_deref().and_then(|name| std::path::Path::new(name).extension()?.to_str());
        if extension
            .is_some_and(|extension| vitral::DrawingFormat::from_extension(extension).is_some())
        {
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn render_is_the_verb_where_none_is_typed() {
        let with = |words: &[&str]| {
            let typed =
                std::iter::once("vitral").chain(words.iter().copied()).map(Into::into).collect();
            with_verb(typed).get(1).and_then(|w| w.to_str().map(str::to_owned))
        };
        assert_eq!(with(&[]), None);
        for (words, expected) in [
            (&["a.obj", "-o", "b.png"][..], "render"),
            (&["-o", "b.png", "a.obj"], "render"),
            (&["-"], "render"),
            (&["info", "a.obj"], "info"),
            (&["draw", "a.obj"], "draw"),
            (&["inof", "a.obj"], "inof"),
            (&["src", "-o", "b.png"], "render"),
            (&["builtin:teapot"], "render"),
            (&["a.obj", "-o", "b.svg"], "draw"),
            (&["a.obj", "--output={model}.pdf"], "draw"),
            (&["-ob.DXF", "a.obj"], "draw"),
            (&["a.svg", "-o", "b.png"], "render"),
            (&["help"], "--help"),
            (&["help", "info"], "info"),
            (&["--help", "info"], "info"),
            (&["--help"], "--help"),
        ] {
            assert_eq!(with(words).as_deref(), Some(expected));
        }
    }
}
