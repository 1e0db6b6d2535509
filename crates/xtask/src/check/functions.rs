//! Functions fit on a screen and take few arguments.
//!
//! Tests are free of both limits. Methods that OpenGL's entry points call have the arguments of the standard.

use super::tokens::{Token, in_tests, tokens};

/// Most lines, from `fn` to the closing brace.
const MOST_LINES: usize = 80;

/// Most arguments, `self` among them.
const MOST_ARGUMENTS: usize = 8;

/// A function with its measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Function<'a> {
    name: &'a str,
    line: usize,
    lines: usize,
    arguments: usize,
}

/// One line for each limit that a function breaks. `path` is relative to the repository's top, with `/`.
pub(super) fn check(path: &str, text: &str) -> Vec<String> {
    let mut violations = Vec::new();
    if path.ends_with("/tests.rs") || path.contains("/tests/") {
        return violations;
    }
    let all = tokens(text);
    let code: Vec<_> = all.iter().zip(in_tests(&all)).filter(|(_, test)| !test).map(|(token, _)| *token).collect();
    for Function { name, line, lines, arguments } in functions(&code) {
        if lines > MOST_LINES {
            violations.push(format!(
                "{path}:{line}: fn {name} has {lines} lines; split it by its steps, {MOST_LINES} is the limit"
            ));
        }
        if arguments > MOST_ARGUMENTS {
            violations.push(format!(
                "{path}:{line}: fn {name} has {arguments} arguments; group them, {MOST_ARGUMENTS} is the limit"
            ));
        }
    }
    violations
}

/// The functions with a name, in the order of the text; inner ones count for themselves and for the outer one.
fn functions<'a>(code: &[Token<'a>]) -> Vec<Function<'a>> {
    let text = |at: usize| code.get(at).map_or("", |token| token.text);
    let mut found = Vec::new();
    for start in (0..code.len()).filter(|&at| text(at) == "fn") {
        // Skip function types, and the mark of a macro's variable.
        let name_at = start + 1 + usize::from(text(start + 1) == "$");
        let name = text(name_at);
        if !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
            continue;
        }
        let Some(open) = parameters(code, name_at + 1) else { continue };
        let (arguments, close) = count_arguments(code, open);
        found.push(Function { name, line: code[start].line, lines: body_end(code, close) + 1 - code[start].line, arguments });
    }
    found
}

/// Where the parameters start: behind the name or its generic parameters.
fn parameters(code: &[Token<'_>], mut at: usize) -> Option<usize> {
    let mut depth = 0;
    while let Some(token) = code.get(at) {
        match token.text {
            "(" if depth == 0 => return Some(at),
            "<" => depth += 1,
            ">" if code[at - 1].text != "-" => depth -= 1,
            _ => {}
        }
        at += 1;
    }
    None
}

/// Counts the parameters of the list at `open`; gives the place of its end too.
fn count_arguments(code: &[Token<'_>], open: usize) -> (usize, usize) {
    let (mut depth, mut count, mut empty) = (0, 0, true);
    for at in open..code.len() {
        match code[at].text {
            "(" | "[" | "{" | "<" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            ">" if code[at - 1].text != "-" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return (count + usize::from(!empty), at);
        }
        if depth == 1 && code[at].text == "," {
            count += 1;
            empty = true;
        } else if at > open {
            empty = false;
        }
    }
    (count, code.len() - 1)
}

/// The line on which the body behind the parameters' end closes, or the declaration without body.
fn body_end(code: &[Token<'_>], close: usize) -> usize {
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
