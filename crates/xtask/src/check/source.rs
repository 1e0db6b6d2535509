//! Rules about the text of one file: its length, what is left in it, where `unsafe` may live, and
//! what the floors below the faces may not touch (files, clocks, the environment, threads).

use super::floors;
use super::tokens::{Token, in_tests, tokens};

/// Most lines of a file. Lines that hold nothing but a Rust comment do not count.
const MOST_LINES: usize = 700;

/// Where `unsafe` may live, and why.
const UNSAFE_PLACES: [&str; 6] = [
    "crates/osmesa/",              // the C ABI
    "crates/lab-wasm/", // the attribute that exports a name to WebAssembly, the page's clock; no unsafe block
    "crates/wasm-probe/", // the attribute that exports a name to WebAssembly; no unsafe block
    "fuzz/",            // the fuzzer's entry
    "crates/cli/src/main.rs", // names what the loader calls before `main`
    "crates/cli/src/allocator.rs", // memory that runs out ends with an exit code; a look at the standard output before `main`
];

/// Macros that no finished code holds.
const UNFINISHED: [&str; 3] = ["todo", "unimplemented", "dbg"];

/// Marks of unfinished work in comments. (Written in two parts, so that this file does not object
/// to itself.)
const MARKS: [&str; 3] = [concat!("TO", "DO"), concat!("FIX", "ME"), concat!("XX", "X")];

/// Starts of paths that exist on one machine only.
const MACHINE_PATHS: [&str; 3] =
    [concat!("/wo", "rk/"), concat!("/ro", "ot/"), concat!("/ho", "me/")];

/// Modules of `std` that only faces use, and types that stand for the same.
const FACES_ONLY: [&str; 5] = ["fs", "env", "process", "net", "thread"];
const CLOCKS: [&str; 2] = ["Instant", "SystemTime"];

/// Exceptions: file, module, reason.
const EXCEPTIONS: [(&str, &str, &str); 3] = [
    (
        "crates/math/src/lanes.rs",
        "env",
        "VITRAL_SIMD chooses the instruction set, which no picture depends on",
    ),
    ("crates/exec/src/workers.rs", "thread", "Workers are the one place that knows threads"),
    (
        "crates/exec/src/started.rs",
        "thread",
        "Workers again, and what must wait where a fork comes",
    ),
];

/// One line for each rule that the file breaks. `path` is relative to the repository's top, with
/// `/`.
pub(super) fn check(path: &str, text: &str) -> Vec<String> {
    let path = path.replace('\\', "/");
    let mut violations = Vec::new();
    let count = text
        .lines()
        .filter(|line| !(path.ends_with(".rs") && line.trim_start().starts_with("//")))
        .count();
    if count > MOST_LINES {
        violations.push(format!(
            "{path}: {count} lines without comments; split it by what it holds, {MOST_LINES} is the limit"
        ));
    }
    for (number, line) in (1..).zip(text.lines()) {
        for mark in MARKS.iter().filter(|mark| has_word(line, mark)) {
            violations.push(format!("{path}:{number}: {mark} is left"));
        }
        for start in MACHINE_PATHS.iter().filter(|start| line.contains(**start)) {
            violations.push(format!("{path}:{number}: a path of one machine ({start}...)"));
        }
    }
    if path.ends_with(".rs") {
        let found = tokens(text);
        leftovers(&path, &found, &mut violations);
        unsafe_code(&path, text, &found, &mut violations);
        faces_only(&path, &found, &mut violations);
    }
    violations
}

/// Whether `word` stands in `line` with no letter, digit or underscore beside it.
fn has_word(line: &str, word: &str) -> bool {
    let edge = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric() && c != '_');
    line.match_indices(word).any(|(at, _)| {
        edge(line[..at].chars().next_back()) && edge(line[at + word.len()..].chars().next())
    })
}

/// Macros and attributes of unfinished work.
fn leftovers(path: &str, tokens: &[Token<'_>], violations: &mut Vec<String>) {
    for pair in tokens.windows(2) {
        if pair[1].text == "!" && UNFINISHED.contains(&pair[0].text) {
            violations.push(format!("{path}:{}: {}! is left", pair[0].line, pair[0].text));
        }
    }
    for triple in
        tokens.windows(3).filter(|t| t[0].text == "#" && t[1].text == "[" && t[2].text == "ignore")
    {
        violations.push(format!("{path}:{}: an ignored test is no test", triple[2].line));
    }
}

/// `unsafe` outside of its places, and blocks that do not say why they are sound.
fn unsafe_code(path: &str, text: &str, tokens: &[Token<'_>], violations: &mut Vec<String>) {
    let allowed = UNSAFE_PLACES.iter().any(|place| path.starts_with(place));
    let lines: Vec<&str> = text.lines().collect();
    for pair in tokens.windows(2).filter(|pair| pair[0].text == "unsafe") {
        let line = pair[0].line;
        let above = &lines[line.saturating_sub(4)..line.min(lines.len())];
        if !allowed {
            violations
                .push(format!("{path}:{line}: unsafe outside of the places where it may live"));
        } else if matches!(pair[1].text, "{" | "impl")
            && !above.iter().any(|l| l.contains("SAFETY:"))
        {
            violations.push(format!("{path}:{line}: an unsafe block without a `// SAFETY:` line"));
        }
    }
}

/// Files, clocks, the environment and threads below floor 4, outside of tests.
fn faces_only(path: &str, tokens: &[Token<'_>], violations: &mut Vec<String>) {
    let mut parts = path.split('/');
    let ("crates", Some(folder), Some("src")) =
        (parts.next().unwrap_or_default(), parts.next(), parts.next())
    else {
        return;
    };
    let below = floors::floor_of_folder(folder).is_some_and(|floor| floor < 4);
    if !below || path.ends_with("/tests.rs") || path.contains("/tests/") {
        return;
    }
    let tests = in_tests(tokens);
    for (at, token) in tokens.iter().enumerate().filter(|(at, _)| !tests[*at]) {
        for name in std_modules(&tokens[at..])
            .into_iter()
            .chain(CLOCKS.into_iter().filter(|c| *c == token.text))
        {
            if !EXCEPTIONS.iter().any(|(file, module, _)| *file == path && *module == name) {
                violations
                    .push(format!("{path}:{}: {name} below floor 4; faces hand it in", token.line));
            }
        }
    }
}

/// The modules of [`FACES_ONLY`] that the path at the start names: `std::fs`, or
/// `std::{fs::File, env}`.
fn std_modules<'a>(tokens: &[Token<'a>]) -> Vec<&'a str> {
    let text = |at: usize| tokens.get(at).map_or("", |t| t.text);
    if [text(0), text(1), text(2)] != ["std", ":", ":"] {
        return Vec::new();
    }
    let banned = |at: usize| FACES_ONLY.contains(&text(at)) && text(at + 1) != "!";
    if text(3) != "{" {
        return if banned(3) { vec![text_of(tokens, 3)] } else { Vec::new() };
    }

    // Look at the first name of each member of the group.
    let (mut found, mut depth) = (Vec::new(), 0);
    for at in 3..tokens.len() {
        match text(at) {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ if depth == 1 && matches!(text(at - 1), "{" | ",") && banned(at) => {
                found.push(text_of(tokens, at))
            }
            _ => {}
        }
        if depth == 0 {
            break;
        }
    }
    found
}

fn text_of<'a>(tokens: &[Token<'a>], at: usize) -> &'a str {
    tokens[at].text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_found_in_code_only() {
        assert_eq!(
            check("crates/io/src/a.rs", "fn f() { todo!() }"),
            ["crates/io/src/a.rs:1: todo! is left"]
        );
        assert_eq!(check("crates/io/src/a.rs", "\n#[ignore = \"slow\"]\nfn f() {}").len(), 1);
        assert!(
            check("crates/io/src/a.rs", "// dbg!(x) would be wrong\nlet s = \"todo!()\";")
                .is_empty()
        );
        assert_eq!(check("benches/a.py", concat!("# FIX", "ME later")).len(), 1);
        assert!(check("benches/a.py", "XXXL and MIXXX are no marks").is_empty());
    }

    #[test]
    fn unsafe_has_its_places_and_its_reason() {
        let block = "fn f() { unsafe { g() } }";
        assert_eq!(check("crates/io/src/a.rs", block).len(), 1);
        assert_eq!(check("crates/osmesa/src/a.rs", block).len(), 1, "no reason");
        assert!(
            check("crates/osmesa/src/a.rs", &format!("// SAFETY: g is fine\n{block}")).is_empty()
        );
        assert!(
            check("crates/io/src/a.rs", "#![forbid(unsafe_code)] // no unsafe here").is_empty()
        );
        assert!(check("crates/wasm-probe/src/lib.rs", "#[unsafe(no_mangle)] fn f() {}").is_empty());
    }

    #[test]
    fn files_clocks_and_threads_belong_to_the_faces() {
        for code in [
            "use std::fs;",
            "std::env::var(x)",
            "use std::{sync::Arc, fs::File};",
            "use std::time::{Duration, Instant};",
            "std::thread::spawn(f)",
        ] {
            assert_eq!(check("crates/io/src/a.rs", code).len(), 1, "{code}");
            assert!(check("crates/cli/src/a.rs", code).is_empty(), "{code} in a face");
            assert!(check("crates/io/tests/a.rs", code).is_empty(), "{code} in a test");
            assert!(
                check(
                    "crates/io/src/a.rs",
                    &format!("#[cfg(test)] mod tests {{ fn f() {{ {code}; }} }}")
                )
                .is_empty()
            );
        }
        for code in [
            "use std::{sync::{Arc, fs}};",
            "env!(\"X\")",
            "use std::time::Duration;",
            "my::fs::read()",
        ] {
            assert!(check("crates/io/src/a.rs", code).is_empty(), "{code}");
        }
        assert!(
            check("crates/math/src/lanes.rs", "std::env::var(x)").is_empty(),
            "an exception with a reason"
        );
    }

    #[test]
    fn long_files_and_machine_paths_are_refused() {
        assert!(check("crates/io/src/a.rs", &"\n".repeat(700)).is_empty());
        assert_eq!(check("crates/io/src/a.rs", &"\n".repeat(701)).len(), 1);
        assert!(
            check("crates/io/src/a.rs", &"    // A step.\n".repeat(701)).is_empty(),
            "comments do not count"
        );
        assert_eq!(check("benches/a.py", &"// 2\n".repeat(701)).len(), 1);
        assert_eq!(check("crates/io/src/a.rs", concat!("let p = \"/ro", "ot/x\";")).len(), 1);
    }
}
