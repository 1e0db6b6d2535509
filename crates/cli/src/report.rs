//! What the user is told: results on standard output, everything else on standard error, one line
//! each.

use crate::allocator::output_is_closed;
use crate::exit::{exit_code, hint};
use crate::similar::for_missing;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::io::Write;
use std::path::Path;
use std::sync::{Mutex, MutexGuard};

/// Warnings that are shown before the rest is only counted.
const MOST_WARNINGS: usize = 10;

/// Exit code of a usage error.
const USAGE: u8 = 2;

/// Exit code for pictures that differ.
pub(crate) const DIFFERENT: u8 = 6;

/// The hint where there is no better one.
const HELP: &str = "`vitral --help` and `vitral VERB --help` list what is possible";

/// What other programs call `--resolution`.
const SIZES: [&str; 3] = ["--size", "--width", "--height"];

/// Why `vitral` ends early.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    code: u8,
    /// `FILE: WHERE: WHAT`; `None`: nothing is to be said.
    message: Option<String>,
    /// What may help.
    hint: Option<String>,
}

impl Failure {
    /// Something was asked for that cannot be.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self { code: USAGE, message: Some(message.into()), hint: None }
    }

    /// Anything that has no exit code of its own.
    pub(crate) fn other(message: impl Into<String>) -> Self {
        Self { code: 1, message: Some(message.into()), hint: None }
    }

    /// Anything that has one.
    pub(crate) fn with_code(code: u8, message: impl Into<String>) -> Self {
        Self { code, message: Some(message.into()), hint: None }
    }

    /// With a hint.
    #[must_use]
    pub(crate) fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// With a hint, unless there is a better one.
    #[must_use]
    pub(crate) fn or_hint(mut self, hint: impl FnOnce() -> String) -> Self {
        self.hint = self.hint.or_else(|| Some(hint()));
        self
    }

    /// With the model's name in front, unless the message begins with it.
    #[must_use]
    pub(crate) fn about(mut self, model: &Path) -> Self {
        let name = model.to_string_lossy();
        self.message = self
            .message
            .map(|text| if text.starts_with(&*name) { text } else { format!("{name}: {text}") });
        self
    }

    /// What the user is told, and the exit code.
    pub(crate) fn as_json(&self) -> serde_json::Value {
        serde_json::json!({"error": self.message, "exit-code": self.code})
    }

    /// Standard output cannot be written. A reader that has gone away had enough, which is no
    /// failure.
    pub(crate) fn standard_output(error: &std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Self { code: 0, message: None, hint: None },
            _ => Self { code: 5, message: Some(format!("standard output: {error}")), hint: None },
        }
    }

    /// The exit code of the command.
    pub fn code(&self) -> u8 {
        self.code
    }

    /// The error, `FILE: WHERE: WHAT`; empty if nothing is to be said.
    pub fn message(&self) -> &str {
        self.message.as_deref().unwrap_or_default()
    }

    /// What may help.
    pub fn hint(&self) -> Option<&str> {
        self.hint.as_deref()
    }

    /// Tells the user, and gives the exit code.
    pub(crate) fn tell(&self) -> u8 {
        if let Some(message) = &self.message {
            line(message);
        }
        if let Some(hint) = &self.hint {
            say("hint: ", hint);
        }
        self.code
    }
}

impl From<vitral::Error> for Failure {
    fn from(error: vitral::Error) -> Self {
        Self { code: exit_code(&error), message: Some(error.to_string()), hint: hint(&error) }
    }
}

impl From<vitral::Limit> for Failure {
    fn from(limit: vitral::Limit) -> Self {
        vitral::Error::from(limit).into()
    }
}

impl From<clap::Error> for Failure {
    /// One line of what `clap` says in several, its tip as the hint.
    fn from(error: clap::Error) -> Self {
        let context = |kind| match error.get(kind) {
            Some(ContextValue::String(text)) => text.as_str(),
            _ => "",
        };
        match error.kind() {
            ErrorKind::InvalidSubcommand => {
                let word = context(ContextKind::InvalidSubcommand);
                let similar = match error.get(ContextKind::SuggestedSubcommand) {
                    Some(ContextValue::Strings(names)) => names.first(),
                    _ => None,
                };
                let verb = similar.map(|name| format!("did you mean the verb `{name}`?"));
                let hint = verb
                    .or_else(|| for_missing(Path::new(word)))
                    .unwrap_or_else(|| HELP.to_owned());
                return Self::usage(format!(
                    "{word}: there is no such verb, and no file of that name"
                ))
                .with_hint(hint);
            }
            ErrorKind::UnknownArgument if SIZES.contains(&context(ContextKind::InvalidArg)) => {
                let option = context(ContextKind::InvalidArg);
                return Self::usage(format!("there is no option {option}"))
                    .with_hint("--resolution 1024x768 sets the size of the picture");
            }
            _ => {}
        }

        // The first paragraph is the message, a tip in a later one the hint.
        let text = error.render().to_string();
        let text = text.strip_prefix("error: ").unwrap_or(&text);
        let (message, rest) = text.split_once("\n\n").unwrap_or((text, ""));
        let message = message.split_whitespace().collect::<Vec<_>>().join(" ");
        let tip = rest.lines().find_map(|l| l.trim().strip_prefix("tip: "));
        let hint = tip.unwrap_or(HELP);
        Self::usage(message).with_hint(hint)
    }
}

/// Captured text that is not printed: standard output, and the lines of standard error.
static KEPT: Mutex<Option<(Vec<u8>, Vec<String>)>> = Mutex::new(None);

/// Captures all text that is reported, until [`take`].
pub(crate) fn keep() {
    *kept() = Some(<(Vec<u8>, Vec<String>)>::default());
}

/// The text captured since [`keep`]: standard output, and the lines of standard error.
pub(crate) fn take() -> (Vec<u8>, Vec<String>) {
    kept().take().unwrap_or_default()
}

fn kept() -> MutexGuard<'static, Option<(Vec<u8>, Vec<String>)>> {
    KEPT.lock().expect("no thread panics while it keeps what is told")
}

/// Writes to standard output and flushes it.
pub(crate) fn print(bytes: &[u8]) -> Result<(), Failure> {
    if let Some((printed, _)) = kept().as_mut() {
        printed.extend_from_slice(bytes);
        return Ok(());
    }
    if output_is_closed() {
        return Err(Failure::with_code(5, "standard output: it is closed"));
    }
    let mut out = std::io::stdout().lock();
    out.write_all(bytes).and_then(|()| out.flush()).map_err(|e| Failure::standard_output(&e))
}

/// Writes a file, or to standard output for `-`.
pub(crate) fn write(file: &Path, bytes: &[u8]) -> Result<(), Failure> {
    if is_standard(file) { print(bytes) } else { Ok(vitral::picture::write(file, bytes)?) }
}

/// Whether a file's name means standard output.
pub(crate) fn is_standard(file: &Path) -> bool {
    file.as_os_str() == "-" || cfg!(unix) && file == Path::new("/dev/stdout")
}

/// Prints a value as JSON, ending with a new line.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    print(&json(value))
}

/// A value as JSON whose numbers have the digits that they need: numbers of single precision, such
/// as the corners of a mesh, are told as a file has them, 0.8 and not 0.800000011920929.
pub(crate) fn to_value(value: &impl serde::Serialize) -> Result<serde_json::Value, Failure> {
    let mut value = serde_json::to_value(value).map_err(|e| Failure::other(e.to_string()))?;
    shorten(&mut value);
    Ok(value)
}

/// Gives each number that single precision holds exactly its shortest digits there.
fn shorten(value: &mut serde_json::Value) {
    use serde_json::Value;
    match value {
        Value::Array(list) => list.iter_mut().for_each(shorten),
        Value::Object(fields) => fields.values_mut().for_each(shorten),
        Value::Number(number) => {
            let single = number.as_f64().filter(|_| number.is_f64()).map(|v| (v, v as f32));
            let exact = single
                .filter(|(v, single)| f64::from(*single) == *v)
                .map(|(_, single)| single.to_string());
            if let Some(short) =
                exact.and_then(|text| text.parse().ok()).and_then(serde_json::Number::from_f64)
            {
                *number = short;
            }
        }
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

/// A value as indented JSON, ending with a new line.
pub(crate) fn json(value: &impl serde::Serialize) -> Vec<u8> {
    let mut text = serde_json::to_vec_pretty(value).expect("keys are strings");
    text.push(b'\n');
    text
}

/// A line `vitral: MESSAGE` on standard error.
pub(crate) fn line(message: &str) {
    say("vitral: ", message);
}

/// Shows the warnings of a model, the first ones in full.
pub(crate) fn warnings(warnings: &[String]) {
    for warning in warnings.iter().take(MOST_WARNINGS) {
        line(&marked(warning));
    }
    if let Some(more) = warnings.len().checked_sub(MOST_WARNINGS + 1) {
        line(&format!("warning: ... and {} more", more + 1));
    }
}

/// `FILE: WHAT` as `FILE: warning: WHAT`.
fn marked(warning: &str) -> String {
    match warning.split_once(": ") {
        Some((file, what)) => format!("{file}: warning: {what}"),
        None => format!("warning: {warning}"),
    }
}

/// One line on standard error. If that cannot be written there is nobody left to tell.
fn say(mark: &str, text: &str) {
    let text: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if let Some((_, told)) = kept().as_mut() {
        told.push(if mark == "hint: " { format!("{mark}{text}") } else { text });
        return;
    }
    let _ = writeln!(std::io::stderr().lock(), "{mark}{text}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_say_that_they_are_warnings_after_the_file() {
        assert_eq!(marked("a.obj: line 3: odd"), "a.obj: warning: line 3: odd");
        assert_eq!(marked("odd"), "warning: odd");
    }

    #[test]
    fn a_reader_that_went_away_is_no_failure() {
        let code = |kind: std::io::ErrorKind| Failure::standard_output(&kind.into()).code;
        assert_eq!(
            [code(std::io::ErrorKind::BrokenPipe), code(std::io::ErrorKind::StorageFull)],
            [0, 5]
        );
    }
}
