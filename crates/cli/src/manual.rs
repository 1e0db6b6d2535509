//! `vitral man`: the manual, as one page or as a page for each verb. Options come from the
//! definition of the command line, examples from [`examples`]; environment and related pages stand
//! here.

use crate::args::{self, ManArgs};
use crate::examples;
use crate::report::{self, Failure};
use clap_mangen::Man;
use std::fmt::Write;
use std::path::Path;
use vitral::Error;

/// What the environment decides, and for which verbs; none named: all.
const ENVIRONMENT: [(&str, &str, &[&str]); 4] = [
    (
        "VITRAL_THREADS",
        "Threads, where --threads is not given; 0, empty or unset: as many as the process may use.",
        &["render", "draw", "info", "bench", "lab"],
    ),
    (
        "VITRAL_SIMD",
        "The instruction set, for tests; pictures do not depend on it.",
        &["render", "draw", "bench"],
    ),
    (
        "XDG_CONFIG_HOME",
        "The folder of vitral/config.json, the defaults of options; ~/.config where it is not set.",
        &["render", "draw"],
    ),
    ("NO_COLOR", "Set to anything: help without colours.", &[]),
];

/// Runs the verb; gives the exit code.
pub(crate) fn run(args: &ManArgs) -> Result<u8, Failure> {
    let pages = pages()?;
    match &args.folder {
        None => report::print(&pages.into_iter().flat_map(|(_, page)| page).collect::<Vec<_>>())?,
        Some(folder) => write(folder, &pages)?,
    }
    Ok(0)
}

/// Writes each page into its file.
fn write(folder: &Path, pages: &[(String, Vec<u8>)]) -> Result<(), Failure> {
    let failed = |source| Error::Write { path: folder.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(failed)?;
    pages.iter().try_for_each(|(name, page)| report::write(&folder.join(format!("{name}.1")), page))
}

/// The pages with their names: the command's own, then that of each verb.
fn pages() -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let mut command = args::command();
    command.build();
    let verbs: Vec<_> =
        command.get_subcommands().filter(|verb| !verb.is_hide_set()).cloned().collect();
    let names: Vec<_> = verbs.iter().map(|verb| format!("vitral-{}", verb.get_name())).collect();
    let related = |name: &str| -> Vec<String> {
        let all = std::iter::once("vitral".to_owned()).chain(names.iter().cloned());
        all.filter(|other| other != name).collect()
    };
    let mut pages =
        vec![("vitral".to_owned(), page(command.clone(), "vitral", "vitral", &related("vitral"))?)];
    for (verb, name) in verbs.iter().zip(&names) {
        // Of a verb, the command itself is the related page.
        pages.push((
            name.clone(),
            page(verb.clone(), verb.get_name(), name, &["vitral".to_owned()])?,
        ));
    }
    Ok(pages)
}

/// A page of the manual.
fn page(
    command: clap::Command,
    verb: &str,
    name: &str,
    related: &[String],
) -> Result<Vec<u8>, Failure> {
    // What the definition says. The verbs of a page are other pages.
    let mut page = Vec::new();
    let has_arguments = command.get_arguments().any(|argument| !argument.is_hide_set());
    let has_verbs = command.get_subcommands().next().is_some();
    let man = Man::new(command).title(name);
    let written = man
        .render_title(&mut page)
        .and_then(|()| man.render_name_section(&mut page))
        .and_then(|()| man.render_synopsis_section(&mut page))
        .and_then(|()| man.render_description_section(&mut page))
        .and_then(|()| if has_arguments { man.render_options_section(&mut page) } else { Ok(()) })
        .and_then(|()| if has_verbs { man.render_subcommands_section(&mut page) } else { Ok(()) });
    written.map_err(|e| Failure::other(format!("the manual page: {e}")))?;

    // What stands here. Writing to a String cannot fail.
    let mut text = String::new();
    let exits = crate::help::EXIT_CODES.trim_start_matches("Exit codes: ");
    let _ = write!(text, ".SH \"EXIT STATUS\"\n{}\n", roff(exits));
    let of_verb = |variable: &&(&str, &str, &[&str])| {
        verb == "vitral" || variable.2.is_empty() || variable.2.contains(&verb)
    };
    text.push_str(".SH ENVIRONMENT\n");
    for (variable, what, _) in ENVIRONMENT.iter().filter(of_verb) {
        let _ = write!(text, ".TP\n.B {variable}\n{}\n", roff(what));
    }
    text.push_str(".SH EXAMPLES\n");
    for (line, what) in examples::of(verb) {
        let _ = write!(text, ".PP\n{}\n.PP\n.RS 4\n.nf\n{}\n.fi\n.RE\n", roff(what), roff(line));
    }
    let related: Vec<_> = related.iter().map(|page| format!(".BR {} (1)", roff(page))).collect();
    let _ = write!(text, ".SH \"SEE ALSO\"\n{}\n", related.join(" ,\n"));
    page.extend(text.into_bytes());
    Ok(page)
}

/// A line as roff takes it: as it is.
fn roff(text: &str) -> String {
    let text = text.replace('\\', "\\e").replace('-', "\\-");
    if text.starts_with(['.', '\'']) { format!("\\&{text}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_of_roff_are_taken_as_they_are() {
        assert_eq!(roff(".a -o"), "\\&.a \\-o");
        assert_eq!(roff("'{model}'"), "\\&'{model}'");
        assert_eq!(roff("a\\b"), "a\\eb");
    }
}
