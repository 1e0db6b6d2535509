//! Comments: long functions are divided into paragraphs, and no comment tells history.
//!
//! A function is a list of steps, and a comment above each step says what the step achieves. The
//! rule counts comments, not their lines: adjacent lines are one comment. Tests are free of it, and
//! so are tables: functions most of whose lines end with a comma, such as a `match` of one-line
//! arms.
//!
//! Comments describe how things are. How they were belongs to the changelog and to commit messages.

use super::functions::{functions, is_test_file};
use super::tokens::{comments, tokens, without_tests};
use std::collections::{BTreeMap, BTreeSet};

/// Lines of code from which on a function needs comments.
const LONG_FUNCTION: usize = 40;

/// A long function has at least one comment for so many lines of code.
const LINES_PER_COMMENT: usize = 15;

/// Phrases that tell history, in lower case.
const HISTORY: [&str; 13] = [
    "now",
    "no longer",
    "anymore",
    "any more",
    "as before",
    "previously",
    "formerly",
    "nowadays",
    "used to",
    "again now",
    "once again",
    "use again",
    "used again",
];

/// Phrases that contain one of [`HISTORY`] and speak of something else: of an instant at run time,
/// of a length, or of a purpose.
const NO_HISTORY: [&str; 15] = [
    "until now",
    "from now on",
    "now and then",
    "goes on as before",
    "no longer than",
    "any more than",
    "is used to",
    "are used to",
    "be used to",
    "was used to",
    "were used to",
    "been used to",
    "and used to",
    "or used to",
    "not used to",
];

/// One line for each rule that the comments of a file break. `path` is relative to the repository's
/// top, with `/`.
pub(super) fn check(path: &str, text: &str) -> Vec<String> {
    let mut violations = Vec::new();
    if !is_test_file(path) {
        violations.extend(check_paragraphs(path, text));
    }
    violations.extend(check_history(path, text));
    violations
}

/// Long functions with too few comments.
fn check_paragraphs(path: &str, text: &str) -> Vec<String> {
    let code = without_tests(&tokens(text));

    // Note the last word of each line of code, and the lines on which a comment starts.
    let last_words: BTreeMap<usize, &str> =
        code.iter().map(|token| (token.line, token.text)).collect();
    let with_comment: BTreeSet<usize> = comments(text).iter().map(|comment| comment.line).collect();

    let mut violations = Vec::new();
    for function in functions(&code) {
        let lines = function.line..function.line + function.lines;

        // Skip short functions and tables.
        let count = last_words.range(lines.clone()).count();
        let commas = last_words.range(lines.clone()).filter(|(_, word)| **word == ",").count();
        if count <= LONG_FUNCTION || commas * 2 > count {
            continue;
        }

        // Count the comments: lines whose neighbour above has none.
        let found =
            with_comment.range(lines).filter(|&line| !with_comment.contains(&(line - 1))).count();
        let wanted = count / LINES_PER_COMMENT;
        if found < wanted {
            violations.push(format!(
                "{path}:{}: fn {} has {found} comments in {count} lines of code; say its steps, {wanted} are the least",
                function.line, function.name
            ));
        }
    }
    violations
}

/// Comments with a phrase that tells history. Phrases within backticks are code; those across two
/// lines are not seen.
fn check_history(path: &str, text: &str) -> Vec<String> {
    let mut violations = Vec::new();
    for comment in comments(text) {
        for (number, line) in (comment.line..).zip(comment.text.lines()) {
            let line = in_words(line);
            let line = NO_HISTORY
                .iter()
                .fold(line, |line, phrase| line.replace(&format!(" {phrase} "), " | "));
            if let Some(phrase) =
                HISTORY.iter().find(|phrase| line.contains(&format!(" {phrase} ")))
            {
                violations.push(format!(
                    "{path}:{number}: \"{phrase}\" tells history; say how it is, the changelog tells how it was"
                ));
            }
        }
    }
    violations
}

/// The words of a comment in lower case, each between two spaces, and `|` for punctuation and code.
fn in_words(comment: &str) -> String {
    let prose = comment.split('`').step_by(2).collect::<Vec<_>>().join("|");
    let mut words = String::from(" ");
    for word in prose.split_inclusive(|c: char| !c.is_alphanumeric() && c != '\'') {
        let text = word.trim_end_matches(|c: char| !c.is_alphanumeric() && c != '\'');
        words.push_str(&text.to_lowercase());
        words.push_str(if word[text.len()..].trim().is_empty() { " " } else { " | " });
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A function of so many lines of code, with so many comments after its first line.
    fn function(lines: usize, count: usize, line: &str) -> String {
        format!(
            "fn f() {{\n{}{}}}",
            "// A step.\n\n".repeat(count),
            format!("{line}\n").repeat(lines - 2)
        )
    }

    #[test]
    fn long_functions_say_their_steps() {
        let found =
            |lines, comments| check("crates/io/src/a.rs", &function(lines, comments, "g();")).len();
        assert_eq!(found(40, 0), 0, "a short function");
        assert_eq!(
            check("crates/io/src/a.rs", &function(41, 1, "g();")),
            [
                "crates/io/src/a.rs:1: fn f has 1 comments in 41 lines of code; say its steps, 2 are the least"
            ]
        );
        assert_eq!([found(41, 2), found(44, 2), found(45, 2), found(45, 3)], [0, 0, 1, 0]);
    }

    #[test]
    fn adjacent_lines_are_one_comment_and_blank_lines_are_no_code() {
        let two_lines =
            function(41, 0, "g();").replacen("g();", "// A step\n// of two lines.\ng();", 1);
        assert_eq!(check("crates/io/src/a.rs", &two_lines).len(), 1);
        assert!(check("crates/io/src/a.rs", &function(40, 0, "g();\n\n")).is_empty());
        assert_eq!(check("crates/io/src/a.rs", &function(41, 0, "g(\"// no comment\");")).len(), 1);
    }

    #[test]
    fn tests_and_tables_are_free_of_steps() {
        let long = function(60, 0, "g();");
        assert!(
            check("crates/io/src/a.rs", &format!("#[cfg(test)] mod tests {{ {long} }}")).is_empty()
        );
        for path in ["crates/io/tests/a.rs", "crates/io/src/a/tests.rs"] {
            assert!(check(path, &long).is_empty(), "{path}");
        }
        assert!(check("crates/io/src/a.rs", &function(60, 0, "A => b,")).is_empty());
    }

    #[test]
    fn comments_tell_no_history() {
        assert_eq!(
            check("crates/io/src/a.rs", "fn f() {}\n// It was slow; now it is fast."),
            [
                "crates/io/src/a.rs:2: \"now\" tells history; say how it is, the changelog tells how it was"
            ]
        );
        for text in [
            "/// Now it is fast.",
            "//! The list is no longer sorted.",
            "/* one line\nnot needed anymore */",
            "// Not needed any more.",
            "// Sorted as before",
            "// This used to be slow.",
            "// Previously sorted.",
            "// Memory to use again.",
        ] {
            assert_eq!(check("crates/io/tests/a.rs", text).len(), 1, "{text}");
        }
    }

    #[test]
    fn instants_lengths_purposes_and_code_are_no_history() {
        for text in [
            "// What was tracked until now keeps the colour.",
            "// Counts from now on.",
            "// Asked now and then.",
            "// A stroke no longer than `room`.",
            "// The list is used to sort.",
            "// Known nowhere.",
            "/// The time `now`, and `Instant::now()`.",
            "let s = \"now\"; let now = 1;",
        ] {
            assert!(check("crates/io/src/a.rs", text).is_empty(), "{text}");
        }
    }
}
