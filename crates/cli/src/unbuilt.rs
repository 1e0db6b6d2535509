//! What the contract of the command line names and this version cannot do yet. None of it is in the help; whoever asks
//! for it is told so, rather than that it is unknown.

/// Verbs to come.
const VERBS: [&str; 1] = ["batch"];

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
        }
    }
}
