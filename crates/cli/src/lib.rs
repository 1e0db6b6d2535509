//! The `vitral` command: a model file in, a picture out. No rendering logic lives here; everything
//! is in crate `vitral`.
//!
//! A library, so that other programs offer the same command ([`command`]) and take the same options
//! ([`options`]).

pub mod allocator;
mod animation_frames;
mod args;
mod batch;
mod batch_args;
mod bench_command;
mod bench_drawings;
mod bench_plot;
mod bench_report;
mod bench_rows;
mod blank;
mod choices;
mod command_line;
mod compare_command;
mod depth_cue;
mod draw_args;
mod draw_checks;
mod draw_command;
mod draw_file;
mod draw_polygons;
mod draw_sheet;
mod environment;
mod examples;
mod exit;
mod fields;
mod hashes;
mod help;
mod help_groups;
mod info_command;
mod interrupt;
mod kept_models;
mod lab;
mod lab_args;
mod light_spec;
mod machine;
mod manual;
mod models;
mod no_effect;
mod no_effect_camera;
pub mod options;
mod osmesa_env_command;
mod outputs;
mod program;
mod progress;
mod read_probe;
mod render_args;
mod render_command;
mod report;
mod resolve;
mod section_args;
mod similar;
mod step_pictures;
mod tables;
mod thumbnail_command;
mod trace_file;
mod values;

use args::{Cli, Verb};
use clap::FromArgMatches;
use clap::error::ErrorKind;
use std::ffi::OsString;

pub use osmesa_env_command::osmesa_lies_in;
pub use program::started_by;
pub use report::Failure;

/// Runs the command with these arguments, of which the first is its own name; gives the exit code.
pub fn command(arguments: Vec<OsString>) -> u8 {
    dispatch(arguments).unwrap_or_else(|failure| failure.tell())
}

/// Runs the verb that is typed.
fn dispatch(arguments: Vec<OsString>) -> Result<u8, Failure> {
    // Parse the arguments.
    let typed = help_groups::split(batch_args::arrange(args::with_verb(arguments)));
    let parsed = args::command()
        .try_get_matches_from(&typed)
        .and_then(|matches| Cli::from_arg_matches(&matches));
    let cli = match parsed {
        Ok(cli) => cli,
        // Help and version are results, not errors.
        Err(e) if matches!(e.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) => {
            let asked = if e.kind() == ErrorKind::DisplayHelp {
                help_groups::asked_for(&typed)?
            } else {
                None
            };
            let text = asked.unwrap_or_else(|| e.render());
            let text = if use_color() { text.ansi().to_string() } else { text.to_string() };
            return report::print(text.as_bytes()).map(|()| 0);
        }
        Err(e) if e.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            eprint!("{}", e.render());
            return Ok(2);
        }
        Err(e) => return Err(e.into()),
    };

    // Run the verb.
    match cli.verb {
        Verb::Render(args) => render_command::run(&args),
        Verb::Draw(args) => draw_command::run(&args),
        Verb::Batch(args) => batch::run(&args),
        Verb::BatchWorker(args) => batch::worker::run(&args, dispatch),
        Verb::ReadProbe(args) => read_probe::run(&args),
        Verb::Lab(args) => lab::run(&args),
        Verb::Info(args) => info_command::run(&args),
        Verb::Thumbnail(args) => thumbnail_command::run(&args),
        Verb::Compare(args) => compare_command::run(&args),
        Verb::Bench(args) => bench_command::run(&args),
        Verb::Algorithms(args) => tables::algorithms(&args),
        Verb::Formats(args) => tables::formats(&args),
        Verb::OsmesaEnv(args) => osmesa_env_command::run(&args),
        Verb::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut args::command(), "vitral", &mut script);
            report::print(&script).map(|()| 0)
        }
        Verb::Man(args) => manual::run(&args),
    }
}

/// Colours on a terminal, unless `NO_COLOR` is set to something.
fn use_color() -> bool {
    use std::io::IsTerminal;
    std::io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
}
