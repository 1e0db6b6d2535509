//! What the contract of the command line names and this version cannot do yet. None of it is in the help; whoever asks
//! for it is told so, rather than that it is unknown.

/// Verbs to come.
const VERBS: [&str; 2] = ["lab", "batch"];

/// Options of `draw` to come.
const DRAWING_OPTIONS: [&str; 12] = [
    "--algorithm",
    "--angle",
    "--color-by",
    "--flatten",
    "--hide-tangent",
    "--max-segments",
    "--seams",
    "--shades",
    "--shadows",
    "--transparency",
    "--views",
    "--light",
];

/// Whether this option of `draw` is to come.
pub(crate) fn drawing_option(name: &str) -> bool {
    DRAWING_OPTIONS.contains(&name)
}

/// Whether this verb is to come.
pub(crate) fn verb(name: &str) -> bool {
    VERBS.contains(&name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::Cli;
    use clap::CommandFactory;

    #[test]
    fn nothing_is_both_there_and_to_come() {
        let cli = Cli::command();
        for command in cli.get_subcommands() {
            assert!(!verb(command.get_name()), "{}", command.get_name());
            for option in command.get_arguments().filter_map(|a| a.get_long()).filter(|_| command.get_name() == "draw")
            {
                assert!(!drawing_option(&format!("--{option}")), "{option}");
            }
        }
    }
}
