//! Functions have few lines of code and take few arguments.
//!
//! Tests are free of both limits. Methods that are entry points of OpenGL have the arguments that
//! the standard gives them: a function of the crate `gl` may have as many as the table of entry
//! points says for its name, and `self`.

use super::tokens::{Token, tokens, without_tests};
use std::collections::BTreeSet;

/// Most lines of code, from `fn` to the closing brace. Blank lines and comments do not count.
const MOST_LINES: usize = 80;

/// Most arguments, `self` among them.
const MOST_ARGUMENTS: usize = 8;

/// The table of OpenGL's entry points: lines of `glName => method(argument: type, ...) -> type;`.
pub(super) const ENTRY_POINTS: &str = "crates/osmesa/src/entry_points.rs";

/// Where the methods of the entry points are.
const ENTRY_POINT_METHODS: &str = "crates/gl/src/";

/// The methods that entry points call, each with the number of its arguments, `self` among them.
pub(super) struct EntryPoints<'a>(BTreeSet<(&'a str, usize)>);

impl<'a> EntryPoints<'a> {
    /// Reads the table in the text of [`ENTRY_POINTS`].
    pub(super) fn read(table: &'a str) -> Self {
        let code = tokens(table);
        let text = |at: usize| code.get(at).map_or("", |token| token.text);
        let mut methods = BTreeSet::new();
        for arrow in (0..code.len()).filter(|&at| [text(at), text(at + 1)] == ["=", ">"]) {
            // A method in brackets may be followed by another that stands in for it.
            let mut names = vec![text(arrow + 2)];
            let mut open = arrow + 3;
            if names == ["["] {
                names = (open..code.len()).map(text).take_while(|name| *name != "]").collect();
                open += names.len() + 1;
            }
            if text(open) == "(" {
                let (count, _) = count_arguments(&code, open);
                methods.extend(names.into_iter().map(|name| (name, count + 1)));
            }
        }
        Self(methods)
    }

    /// Whether the function of the file `path` is one of these methods.
    fn have(&self, path: &str, function: &Function<'_>) -> bool {
        path.starts_with(ENTRY_POINT_METHODS)
            && self.0.contains(&(function.name, function.arguments))
    }
}

/// A function with its measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Function<'a> {
    pub(super) name: &'a str,
    /// The line of `fn`.
    pub(super) line: usize,
    /// Lines from `fn` to the closing brace, both included.
    pub(super) lines: usize,
    /// Arguments, `self` among them.
    arguments: usize,
}

/// One line for each limit that a function breaks. `path` is relative to the repository's top, with
/// `/`.
pub(super) fn check(path: &str, text: &str, entry_points: &EntryPoints<'_>) -> Vec<String> {
    let mut violations = Vec::new();
    if is_test_file(path) {
        return violations;
    }
    let code = without_tests(&tokens(text));
    let lines_of_code: BTreeSet<usize> = code.iter().map(|token| token.line).collect();
    for function in functions(&code) {
        let Function { name, line, lines, arguments } = function;
        let lines = lines_of_code.range(line..line + lines).count();
        if lines > MOST_LINES {
            violations.push(format!(
                "{path}:{line}: fn {name} has {lines} lines of code; split it by its steps, {MOST_LINES} is the limit"
            ));
        }
        if arguments > MOST_ARGUMENTS && !entry_points.have(path, &function) {
            violations.push(format!(
                "{path}:{line}: fn {name} has {arguments} arguments; group them in a struct, {MOST_ARGUMENTS} is the limit"
            ));
        }
    }
    violations
}

/// Whether the file holds nothing but tests.
pub(super) fn is_test_file(path: &str) -> bool {
    path.ends_with("/tests.rs") || path.starts_with("tests/") || path.contains("/tests/")
}

/// The functions with a name, in the order of the text. A function inside of another counts for
/// both.
pub(super) fn functions<'a>(code: &[Token<'a>]) -> Vec<Function<'a>> {
    let text = |at: usize| code.get(at).map_or("", |token| token.text);
    let mut found = Vec::new();
    for start in (0..code.len()).filter(|&at| text(at) == "fn") {
        // Pass types of functions, and the mark of a macro's variable.
        let name_at = start + 1 + usize::from(text(start + 1) == "$");
        let name = text(name_at);
        if !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
            continue;
        }
        let Some(open) = parameters(code, name_at + 1) else { continue };
        let (arguments, close) = count_arguments(code, open);
        let line = code[start].line;
        found.push(Function { name, line, lines: last_line(code, close) + 1 - line, arguments });
    }
    found
}

/// Where the list of parameters opens: behind the name, or behind its generic parameters.
fn parameters(code: &[Token<'_>], start: usize) -> Option<usize> {
    let mut depth = 0;
    for at in start..code.len() {
        match code[at].text {
            "(" if depth == 0 => return Some(at),
            "<" => depth += 1,
            ">" if code[at - 1].text != "-" => depth -= 1,
            _ => {}
        }
    }
    None
}

/// The number of parameters in the list that opens at `open`, and where it closes.
fn count_arguments(code: &[Token<'_>], open: usize) -> (usize, usize) {
    let (mut depth, mut count, mut is_empty) = (0, 0, true);
    for at in open..code.len() {
        match code[at].text {
            "(" | "[" | "{" | "<" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            ">" if code[at - 1].text != "-" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return (count + usize::from(!is_empty), at);
        }
        if depth == 1 && code[at].text == "," {
            count += 1;
            is_empty = true;
        } else if at > open {
            is_empty = false;
        }
    }
    (count, code.len() - 1)
}

/// The line on which the function ends whose parameters close at `close`: that of its last brace,
/// or of the semicolon of a declaration.
fn last_line(code: &[Token<'_>], close: usize) -> usize {
    let (mut braces, mut others) = (0, 0);
    for token in &code[close + 1..] {
        match token.text {
            "(" | "[" => others += 1,
            ")" | "]" => others -= 1,
            "{" => braces += 1,
            "}" => braces -= 1,
            _ => {}
        }
        if others == 0 && braces == 0 && matches!(token.text, "}" | ";") {
            return token.line;
        }
    }
    code[close].line
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The violations of a file with an empty table of entry points.
    fn check_alone(path: &str, text: &str) -> Vec<String> {
        check(path, text, &EntryPoints::read(""))
    }

    /// A function of so many lines.
    fn long(lines: usize) -> String {
        format!("fn f() {{{};}}", ";\n".repeat(lines - 1))
    }

    /// Parameters in parentheses.
    fn list(count: usize) -> String {
        format!("({})", "a: u8, ".repeat(count))
    }

    #[test]
    fn long_functions_are_refused() {
        assert!(check_alone("crates/io/src/a.rs", &long(80)).is_empty());
        assert_eq!(
            check_alone("crates/io/src/a.rs", &format!("\n{}", long(81))),
            [
                "crates/io/src/a.rs:2: fn f has 81 lines of code; split it by its steps, 80 is the limit"
            ]
        );
        let signature = format!("fn f(\n) -> [u8; 2]\nwhere\n    A: B,\n{{{}}}", ";\n".repeat(77));
        assert_eq!(
            check_alone("benches/a.rs", &signature).len(),
            1,
            "lines of the signature count"
        );
        assert!(
            check_alone("benches/a.rs", &format!("fn f();{}fn g() {{}}", ";\n".repeat(99)))
                .is_empty()
        );
        assert!(
            check_alone("benches/a.rs", &format!("fn f() {{{}}}", "// a step\n\n".repeat(99)))
                .is_empty()
        );
        assert!(
            check_alone("benches/a.rs", &format!("type A = fn(u8);{}", ";\n".repeat(99)))
                .is_empty()
        );
    }

    #[test]
    fn many_arguments_are_refused() {
        assert!(check_alone("crates/io/src/a.rs", &format!("fn f{} {{}}", list(8))).is_empty());
        assert_eq!(
            check_alone("crates/io/src/a.rs", &format!("impl A {{\nfn f{} {{}}\n}}", list(9))),
            ["crates/io/src/a.rs:2: fn f has 9 arguments; group them in a struct, 8 is the limit"]
        );
    }

    #[test]
    fn arguments_are_counted_with_self_and_without_inner_commas() {
        let count =
            |signature: &str| functions(&tokens(&format!("fn f{signature} {{}}")))[0].arguments;
        assert_eq!(count("()"), 0);
        assert_eq!(count("(&mut self)"), 1);
        assert_eq!(count("(&self, a: u8,)"), 2);
        assert_eq!(
            count("<A: Fn(u8, u8) -> u8, const N: usize>(a: A, [b, c]: [u8; N]) -> (u8, u8)"),
            2
        );
        assert_eq!(count("(a: Map<u8, u8>, b: impl Fn(u8) -> u8, (c, d): (u8, u8))"), 3);
    }

    #[test]
    fn tests_are_free() {
        for code in [long(99), format!("fn f{} {{}}", list(9))] {
            assert_eq!(check_alone("crates/io/src/a.rs", &code).len(), 1);
            assert!(
                check_alone("crates/io/src/a.rs", &format!("#[cfg(test)] mod tests {{ {code} }}"))
                    .is_empty()
            );
            for path in
                ["crates/io/tests/a.rs", "crates/io/src/a/tests.rs", "crates/io/src/tests/a.rs"]
            {
                assert!(check_alone(path, &code).is_empty(), "{path}");
            }
        }
    }

    #[test]
    fn entry_points_have_the_arguments_of_the_standard() {
        let arguments = list(8);
        let table = format!(
            "glA glB => a{arguments} -> (); glC => [c]{arguments} -> u8; glD => [d unless e]{arguments};"
        );
        let found = |path, name, count| {
            check(path, &format!("pub fn {name}{} {{}}", list(count)), &EntryPoints::read(&table))
                .len()
        };
        for name in ["a", "c", "d", "e"] {
            assert_eq!(found("crates/gl/src/pixels/a.rs", name, 9), 0, "{name}: `self` and eight");
            assert_eq!(
                found("crates/gl/src/pixels/a.rs", name, 10),
                1,
                "{name}: more than the table says"
            );
            assert_eq!(found("crates/raster/src/a.rs", name, 9), 1, "{name}: another crate");
        }
        assert_eq!(found("crates/gl/src/pixels/a.rs", "f", 9), 1, "no entry point");
        assert_eq!(
            check(
                "crates/gl/src/a.rs",
                &long(81).replace("fn f", "fn a"),
                &EntryPoints::read(&table)
            )
            .len(),
            1
        );
    }
}
