//! The help of verbs with many options: `--help` shows the options that most people need, examples
//! and the list of groups, `--help GROUP` one group, `--help all` everything.
//!
//! A group is a heading of the command line's definition, so each option is in one group, and help
//! and manual show the same groups. clap finds out that help is wanted; which help it is, this
//! module finds in the words behind `--help`.

use crate::args;
use crate::examples;
use crate::help::{self, EXIT_CODES, essential};
use crate::report::Failure;
use crate::similar::nearest;
use clap::builder::StyledStr;
use clap::{Arg, Command};
use std::ffi::OsString;
use std::fmt::Write;
use std::path::Path;

/// The group that has all options.
const ALL: &str = "all";

/// A group of options.
struct Group {
    /// As typed behind `--help`.
    name: &'static str,
    /// In help texts and in the manual.
    heading: &'static str,
    /// One line that says what its options are about.
    about: &'static str,
}

const fn group(name: &'static str, heading: &'static str, about: &'static str) -> Group {
    Group { name, heading, about }
}

/// All groups, in the order in which they are listed.
const GROUPS: [Group; 19] = [
    group("output", help::OUTPUT, "files, formats and channels; comparison with a reference"),
    group(
        "animation",
        help::ANIMATION,
        "turntables, animations of glTF files, an algorithm step by step",
    ),
    group(
        "picture",
        help::PICTURE,
        "size, samples, background, colour space, fading with distance",
    ),
    group("measurement", help::MEASUREMENT, "what is measured, and how often"),
    group(
        "algorithms",
        help::ALGORITHMS,
        "visible surfaces, culling, illumination, shading, normals",
    ),
    group(
        "transparency",
        help::TRANSPARENCY,
        "how and in which order transparent surfaces are combined",
    ),
    group("shadows", help::SHADOWS, "shadow algorithms and their settings"),
    group("global", help::GLOBAL, "ray tracing and radiosity"),
    group("lines", help::LINES, "edges, lines and points: which are drawn, and how"),
    group(
        "surfaces",
        help::SURFACES,
        "how regions are filled, with --style filled or filled-lines",
    ),
    group("lights", help::LIGHTS, "light sources, and what metals mirror"),
    group("materials", help::MATERIALS, "properties of surfaces"),
    group("sections", help::SECTIONS, "cuts through the model, hatching, exploded views"),
    group("page", help::PAGE, "sheet, scale, several views, title block, plotters"),
    group(
        "camera",
        help::CAMERA,
        "where the viewer is and looks; without these options the model is framed",
    ),
    group("lab3d", help::LAB3D, "exercises and camera of Lab3D, the program of a graphics course"),
    group("files", help::FILES, "configuration and state files, files that models name"),
    group("limits", help::LIMITS, "threads, time and memory"),
    group("reports", help::REPORTS, "warnings, progress, statistics; an explained pixel, traces"),
];

/// The words of a command line with `--help=GROUP` as two words.
pub(crate) fn split(words: Vec<OsString>) -> Vec<OsString> {
    let mut is_option = true;

    // Divide `--help=GROUP` into two words; behind `--` no word is an option.
    let parts = |word: OsString| {
        is_option &= word != "--";
        match word.to_str().and_then(|text| text.strip_prefix("--help=")).filter(|_| is_option) {
            Some(group) => vec!["--help".into(), group.into()],
            None => vec![word],
        }
    };
    words.into_iter().flat_map(parts).collect()
}

/// The help that a command line asks for, of which clap has said that it asks for help; `None`:
/// clap's own text.
pub(crate) fn asked_for(words: &[OsString]) -> Result<Option<StyledStr>, Failure> {
    // Find the option, and the word behind it if that is no option.
    let is_long = |word: &OsString| word == "--help";
    let position =
        words.iter().position(is_long).or_else(|| words.iter().position(|word| word == "-h"));
    let is_short = !words.iter().any(is_long);
    let behind = position
        .and_then(|at| words.get(at + 1))
        .filter(|word| !word.to_string_lossy().starts_with('-'));

    // Find the verb; without one, a word behind the option must be a verb.
    let command = args::command();
    let Some(verb) = words.get(1).and_then(|word| command.find_subcommand(word)) else {
        return behind
            .map_or(Ok(None), |word| Err(unknown_verb(&command, &word.to_string_lossy())));
    };

    // Choose the summary, all options or one group by the word behind the option.
    let name = verb.get_name();
    match behind.map(|word| (group_of(verb, word), word)) {
        // What may be a model is none of help's words.
        Some((None, word)) if args::may_be_model(word) => Ok(summary(name, is_short)),
        Some((None, word)) => Err(unknown(verb, &word.to_string_lossy())),
        Some((Some(None), _)) => Ok(essential(name).map(|_| everything(name, is_short))),
        Some((Some(Some(group)), _)) => Ok(Some(of_group(name, group, is_short))),
        None => Ok(summary(name, is_short)),
    }
}

/// The error for a word behind `vitral --help` that is no verb.
fn unknown_verb(command: &Command, word: &str) -> Failure {
    // List the verbs that help shows.
    let verbs: Vec<&str> = command
        .get_subcommands()
        .filter(|verb| !verb.is_hide_set())
        .map(Command::get_name)
        .collect();

    // Suggest the verb with the most similar name.
    let meant =
        nearest(word, verbs.iter().copied()).map(|verb| format!("; did you mean `{verb}`?"));
    let text = format!("--help {word}: there is no such verb{}", meant.unwrap_or_default());
    Failure::usage(text).with_hint(format!("the verbs are {}", verbs.join(", ")))
}

/// The groups of a verb.
fn groups(verb: &Command) -> impl Iterator<Item = &'static Group> {
    let is_there = |group: &&Group| {
        verb.get_arguments().any(|option| option.get_help_heading() == Some(group.heading))
    };
    GROUPS.iter().filter(is_there)
}

/// The group of a verb that a word names; `Some(None)`: all of them.
fn group_of(verb: &Command, word: &OsString) -> Option<Option<&'static Group>> {
    // Accept the word for all options, with every verb.
    let word = word.to_str()?.to_lowercase();
    if word == ALL {
        return Some(None);
    }

    // Look the group up among those of the verb, if it has any.
    essential(verb.get_name())?;
    groups(verb).find(|group| group.name == word).map(Some)
}

/// The error for a word that names no group.
fn unknown(verb: &Command, word: &str) -> Failure {
    // Point to the whole help of verbs without groups.
    let name = verb.get_name();
    if essential(name).is_none() {
        return Failure::usage(format!(
            "--help {word}: the options of `vitral {name}` have no groups"
        ))
        .with_hint(format!("`vitral {name} --help` shows all of them"));
    }

    // A group may be meant by its beginning, by a similar name, or by one of its options.
    let lower = word.to_lowercase();
    let names: Vec<&str> = groups(verb).map(|group| group.name).chain([ALL]).collect();
    let begins = names.iter().find(|group| !lower.is_empty() && group.starts_with(&lower)).copied();
    let of_option = || {
        let option = verb.get_arguments().find(|option| option.get_long() == Some(&lower))?;
        groups(verb)
            .find(|group| option.get_help_heading() == Some(group.heading))
            .map(|group| group.name)
    };
    let similar = || nearest(&lower, names.iter().copied());
    let hint = match (begins, of_option()) {
        (None, Some(group)) => Some(format!("the option --{lower} is in the group {group}")),
        (begins, _) => begins
            .or_else(similar)
            .map(|group| format!("did you mean `vitral {name} --help {group}`?")),
    };

    // Name the groups in the message, and the suggestion in the hint.
    let text = format!(
        "--help {word}: there is no such group of options; the groups are {}",
        names.join(", ")
    );
    Failure::usage(text).with_hint(
        hint.unwrap_or_else(|| format!("`vitral {name} --help` says what is in each group")),
    )
}

/// The summary of a verb: the options that most people need, examples, the list of groups. `None`
/// for a verb without groups.
fn summary(name: &str, is_short: bool) -> Option<StyledStr> {
    let essential = essential(name)?;
    let command = args::command();
    let verb = command.find_subcommand(name).expect("verbs with groups are verbs");

    // Examples stand in the longer form alone.
    let mut after = String::new();
    if !is_short {
        after.push_str("Examples:\n");
        for (line, what) in examples::of(name) {
            // Writing to a String cannot fail.
            let _ = writeln!(after, "  {line}\n      {what}");
        }
        after.push('\n');
    }

    // List the groups.
    let _ = writeln!(after, "More options, by group (`vitral {name} --help GROUP`, `--help all`):");
    for group in groups(verb) {
        let _ = writeln!(after, "  {:<13} {}", group.name, group.about);
    }
    if !is_short {
        let _ = write!(after, "\n{EXIT_CODES}");
    }

    // Show the essential options under one heading, and hide the others.
    let change = |option: Arg| {
        if option.is_positional() {
            option
        } else if essential.contains(&option.get_id().as_str()) {
            option.help_heading("Options")
        } else {
            option.hide(true)
        }
    };
    Some(rendered(name, true, |verb| verb.mut_args(change).after_help(after)))
}

/// The options of one group.
fn of_group(name: &str, group: &Group, is_short: bool) -> StyledStr {
    // Describe the group above its options, and name the way to the others below.
    let is_in = |option: &Arg| option.get_help_heading() == Some(group.heading);
    let after = format!(
        "`vitral {name} --help` lists the other groups, `vitral {name} --help all` shows all options"
    );
    let about = format!("{}: {}", group.heading, group.about);

    // Hide all options of other groups.
    rendered(name, is_short, |verb| {
        let verb = verb.mut_args(|option| if is_in(&option) { option } else { option.hide(true) });
        let usage = format!("vitral {name} [OPTIONS] [MODEL]...");
        verb.override_usage(usage).about(about.clone()).long_about(about).after_help(after)
    })
}

/// All options.
fn everything(name: &str, is_short: bool) -> StyledStr {
    rendered(name, is_short, |verb| verb)
}

/// The help of a verb whose definition `change` adapts.
fn rendered(name: &str, is_short: bool, change: impl FnOnce(Command) -> Command) -> StyledStr {
    // Adapt the verb, then build the whole definition so that headings and usage are filled in.
    let mut command = args::command().mut_subcommand(name, change);
    command.build();

    // Render the help of the verb alone.
    let verb = command.find_subcommand_mut(Path::new(name)).expect("the verb is there");
    if is_short { verb.render_help() } else { verb.render_long_help() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::help::{ESSENTIAL, WIDTH};

    /// Words as a command line.
    fn words(text: &str) -> Vec<OsString> {
        text.split(' ').map(OsString::from).collect()
    }

    /// The help for a command line, empty for clap's own.
    fn shown(text: &str) -> Result<String, Failure> {
        Ok(asked_for(&words(text))?.map(|text| text.to_string()).unwrap_or_default())
    }

    #[test]
    fn each_option_is_in_one_group_that_is_listed() {
        let command = args::command();
        for (name, essential) in ESSENTIAL {
            let verb = command.find_subcommand(name).unwrap();
            for option in verb.get_arguments().filter(|option| !option.is_positional()) {
                let in_it =
                    GROUPS.iter().filter(|group| option.get_help_heading() == Some(group.heading));
                assert_eq!(in_it.count(), 1, "{name}: {}", option.get_id());
            }
            for id in essential {
                assert!(verb.get_arguments().any(|option| option.get_id() == id), "{name}: {id}");
            }
        }
        for group in &GROUPS {
            assert_eq!(
                GROUPS
                    .iter()
                    .filter(|other| other.name == group.name || other.heading == group.heading)
                    .count(),
                1
            );
        }
    }

    /// The options that a help text defines, by their long names.
    fn defined(text: &str) -> Vec<&str> {
        // An option stands two columns in, or six where it has no short name; its text begins
        // farther to the right.
        let option = |line| {
            let line: &str = line;
            let start = line
                .strip_prefix("      --")
                .or_else(|| line.strip_prefix("  -")?.split_once(", --").map(|p| p.1));
            start.map(|name| name.split([' ', '[', '=']).next().unwrap_or_default())
        };
        text.lines().filter_map(option).collect()
    }

    #[test]
    fn each_group_shows_its_own_options_alone() {
        let command = args::command();
        for (name, _) in ESSENTIAL {
            let verb = command.find_subcommand(name).unwrap();
            let named = |group: Option<&Group>| -> Vec<&str> {
                let is_in = |option: &&Arg| {
                    group.is_none_or(|group| option.get_help_heading() == Some(group.heading))
                };
                verb.get_arguments().filter(is_in).filter_map(Arg::get_long).collect()
            };
            for group in groups(verb) {
                let text = shown(&format!("vitral {name} --help {}", group.name)).unwrap();
                assert_eq!(defined(&text), named(Some(group)), "{name} {}", group.name);
            }
            let all = shown(&format!("vitral {name} --help all")).unwrap();
            let (mut found, mut expected) = (defined(&all), named(None));
            found.sort_unstable();
            expected.sort_unstable();
            assert_eq!(found, expected, "{name}");
        }
    }

    #[test]
    fn a_summary_is_two_screens_and_the_short_form_about_one() {
        for (name, _) in ESSENTIAL {
            for (option, most) in [("--help", 100), ("-h", 55)] {
                let text = shown(&format!("vitral {name} {option}")).unwrap();
                let count = text.lines().count();
                assert!((10..=most).contains(&count), "{name} {option}: {count} lines\n{text}");
                let widest = text.lines().map(|line| line.chars().count()).max().unwrap();
                assert!(widest <= WIDTH, "{name} {option}: {widest} columns\n{text}");
                assert!(
                    text.contains(&format!("vitral {name}")) && text.contains("by group"),
                    "{text}"
                );
            }
        }
        // Verbs without groups fit into the same number of lines.
        let mut command = args::command();
        command.build();
        for verb in
            command.get_subcommands_mut().filter(|verb| essential(verb.get_name()).is_none())
        {
            let count = verb.render_long_help().to_string().lines().count();
            assert!(verb.is_hide_set() || count <= 100, "{}: {count} lines", verb.get_name());
        }
    }

    #[test]
    fn unknown_groups_bring_a_suggestion() {
        let failure = |text: &str| shown(text).unwrap_err();
        for (typed, hint) in [
            ("vitral render --help alg", "did you mean `vitral render --help algorithms`?"),
            ("vitral render --help shadow", "did you mean `vitral render --help shadows`?"),
            ("vitral draw --help camra", "did you mean `vitral draw --help camera`?"),
            (
                "vitral render --help crease-angle",
                "the option --crease-angle is in the group algorithms",
            ),
            ("vitral render --help quux", "`vitral render --help` says what is in each group"),
            ("vitral info --help alg", "`vitral info --help` shows all of them"),
        ] {
            let failure = failure(typed);
            assert_eq!(
                (failure.code(), failure.hint()),
                (2, Some(hint)),
                "{typed}: {}",
                failure.message()
            );
        }
        assert!(
            failure("vitral render --help alg").message().contains("output, animation, picture")
        );
        assert!(failure("vitral --help rendr").message().ends_with("did you mean `render`?"));
    }

    #[test]
    fn the_word_behind_may_be_a_model_or_another_option() {
        let summary = shown("vitral render --help").unwrap();
        for other in ["render a.obj --help", "render --help a.obj", "render --help --shadows map"] {
            assert_eq!(shown(&format!("vitral {other}")).unwrap(), summary, "{other}");
        }
        let group = shown("vitral render a.obj --help Camera").unwrap();
        assert!(group.contains("--camera-position") && !group.contains("--shadows"), "{group}");
        assert!(shown("vitral render -h camera").unwrap().len() < group.len());
        assert_eq!(shown("vitral info --help").unwrap(), "");
        assert_eq!(
            split(words("vitral render --help=all -- --help=x")),
            words("vitral render --help all -- --help=x")
        );
    }
}
