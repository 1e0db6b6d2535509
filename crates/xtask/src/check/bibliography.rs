//! The bibliography and the code agree: every cited key has an entry, every entry is cited or
//! stands under "Further reading".
//!
//! A citation is a key in brackets, `[` and `]` (escaped or not), in a comment of Rust source or in
//! a Markdown text. A key is what an entry is called, and whatever else looks like one: a name with
//! a year behind it. It may run over the end of a line.

use std::collections::{BTreeMap, BTreeSet};

/// Where the entries are.
pub(super) const FILE: &str = "docs/bibliography.md";

/// The heading below which entries need no citation.
const FURTHER: &str = "## Further reading";

/// Most bytes of a key.
const LONGEST: usize = 80;

/// One line for each key without entry, entry without citation, and entry that stands there twice.
/// `texts` are paths relative to the repository's top with their contents.
pub(super) fn check<'a>(
    bibliography: &'a str,
    texts: impl Iterator<Item = (&'a str, &'a str)>,
) -> Vec<String> {
    let mut violations = Vec::new();
    let mut entries: BTreeMap<&str, (usize, bool)> = BTreeMap::new();
    let mut further = false;
    for (number, line) in (1..).zip(bibliography.lines()) {
        if line.starts_with("## ") {
            further = line == FURTHER;
        }
        let Some((key, _)) = line.strip_prefix("- **[").and_then(|rest| rest.split_once("]**"))
        else {
            continue;
        };
        if entries.insert(key, (number, further)).is_some() {
            violations.push(format!("{FILE}:{number}: a second entry [{key}]"));
        }
    }

    // Look every citation up. Entries may name each other, which does not count as use.
    let mut cited: BTreeSet<String> = BTreeSet::new();
    for (path, text) in texts.chain([(FILE, bibliography)]) {
        for (line, key) in bracketed(path, text) {
            if !entries.contains_key(key.as_str()) {
                if looks_like_a_key(&key) {
                    violations.push(format!("{path}:{line}: [{key}] has no entry in {FILE}"));
                }
            } else if path != FILE {
                cited.insert(key);
            }
        }
    }
    let unused = entries.iter().filter(|(key, (_, further))| !further && !cited.contains(**key));
    violations.extend(unused.map(|(key, (number, _))| {
        format!(
            "{FILE}:{number}: [{key}] is cited nowhere; its place is below \"{}\"",
            FURTHER.trim_start_matches('#')
        )
    }));
    violations
}

/// A capital at the start, and a year at the end: `Phong 1975`.
fn looks_like_a_key(text: &str) -> bool {
    let Some((name, year)) = text.rsplit_once(' ') else { return false };
    let year = year.strip_suffix(|c: char| c.is_ascii_lowercase()).unwrap_or(year);
    let is_year =
        year.len() == 4 && year.parse().is_ok_and(|year: u32| (1600..2100).contains(&year));
    is_year && name.starts_with(char::is_uppercase)
}

/// What stands in brackets in the comments of Rust source, or anywhere in another text, with its
/// line.
fn bracketed(path: &str, text: &str) -> Vec<(usize, String)> {
    let rust = path.ends_with(".rs");
    let mut found = Vec::new();
    let mut open: Option<(usize, String)> = None;
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim_start();
        let line = match line.strip_prefix("//") {
            Some(comment) if rust => comment.trim_start_matches(['/', '!']).trim_start(),
            None if rust => {
                open = None;
                continue;
            }
            _ => line,
        };
        for c in line.chars().chain([' ']) {
            match (c, &mut open) {
                ('[', _) => open = Some((number, String::new())),
                (']', _) => found.extend(open.take()),
                ('\\', _) | (_, None) => {}
                (_, Some((_, key))) if key.len() >= LONGEST => open = None,
                (c, Some((_, key))) => key.push(c),
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENTRIES: &str = "# B\n\n## One\n- **[Phong 1975]** x\n- **[OBJ]** y, see [Crow 1977]\n\n## Further reading\n\n\
                           ### Two\n- **[Crow 1977]** z\n";

    fn with(path: &str, text: &str) -> Vec<String> {
        check(ENTRIES, [("a.rs", "//! [Phong 1975], \\[OBJ\\]"), (path, text)].into_iter())
    }

    #[test]
    fn cited_entries_and_further_reading_are_in_order() {
        assert!(with("a.md", "[Crow 1977]").is_empty());
        assert!(with("a.rs", "// see [`Crow`] and [a b]\nlet x = [Gouraud 1971];").is_empty());
    }

    #[test]
    fn a_key_without_entry_is_told() {
        assert_eq!(
            with("a.rs", "\n/// after [Gouraud 1971b]"),
            ["a.rs:2: [Gouraud 1971b] has no entry in docs/bibliography.md"]
        );
        let split = with("a.rs", "//! [Newell, Newell &\n//! Sancha 1972]");
        assert_eq!(
            split,
            ["a.rs:1: [Newell, Newell & Sancha 1972] has no entry in docs/bibliography.md"]
        );
    }

    #[test]
    fn an_entry_without_citation_is_told() {
        let found = check(
            ENTRIES,
            [("a.rs", "// [OBJ]"), ("b.rs", "let x = \"[Phong 1975]\";")].into_iter(),
        );
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(
            found[0].starts_with("docs/bibliography.md:4: [Phong 1975] is cited nowhere"),
            "{found:?}"
        );
        let twice = format!("{ENTRIES}- **[OBJ]** again\n");
        assert!(
            check(&twice, [("a.rs", "// [OBJ], [Phong 1975]")].into_iter())[0]
                .contains("second entry [OBJ]")
        );
    }
}
