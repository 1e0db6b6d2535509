//! The command as it was typed, for reports that others are to repeat.

use std::ffi::OsString;

/// Characters that no shell takes for something else.
const PLAIN: &str = "-_./:,=+@%";

/// The command of this process as a line for a shell; the program is called `vitral` wherever it
/// lies.
pub(crate) fn typed() -> String {
    line(std::env::args_os().skip(1))
}

/// `vitral` with these arguments, quoted where a shell needs it.
fn line(arguments: impl Iterator<Item = OsString>) -> String {
    let mut line = "vitral".to_owned();
    for argument in arguments {
        line.push(' ');
        line.push_str(&quoted(&argument.to_string_lossy()));
    }
    line
}

/// An argument as a shell has to see it.
fn quoted(argument: &str) -> String {
    let is_plain = !argument.is_empty()
        && argument.chars().all(|c| c.is_ascii_alphanumeric() || PLAIN.contains(c));
    if is_plain { argument.to_owned() } else { format!("'{}'", argument.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_quoted_where_a_shell_needs_it() {
        let of = |arguments: &[&str]| line(arguments.iter().map(OsString::from));
        assert_eq!(
            of(&["bench", "builtin:cubs", "--camera-position=-1,2,3"]),
            "vitral bench builtin:cubs --camera-position=-1,2,3"
        );
        assert_eq!(
            of(&["bench", "my model.obj", "it's", ""]),
            r"vitral bench 'my model.obj' 'it'\''s' ''"
        );
        assert_eq!(of(&["$HOME/{a}"]), "vitral '$HOME/{a}'");
    }
}
