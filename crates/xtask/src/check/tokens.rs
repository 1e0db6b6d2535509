//! Rust source as a list of words, in which comments, strings and characters are left out, and as a
//! list of comments.
//!
//! Enough of the language to find paths and macros, not to understand them: identifiers (numbers
//! too) are one token, every other visible character is one token.

/// A word of code, or a comment, and the line it starts on, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Token<'a> {
    pub(super) text: &'a str,
    pub(super) line: usize,
}

/// Splits `source` into words.
pub(super) fn tokens(source: &str) -> Vec<Token<'_>> {
    split(source).0
}

/// The comments of `source`, with their marks: one for each `//` line and one for each block.
pub(super) fn comments(source: &str) -> Vec<Token<'_>> {
    split(source).1
}

/// Splits `source` into words and comments.
fn split(source: &str) -> (Vec<Token<'_>>, Vec<Token<'_>>) {
    let (mut words, mut comments) = (Vec::new(), Vec::new());
    let (mut rest, mut line) = (source, 1);
    while let Some(first) = rest.chars().next() {
        let length = match blank(rest).or_else(|| quoted(rest)) {
            Some(length) => {
                if rest.starts_with("//") || rest.starts_with("/*") {
                    comments.push(Token { text: &rest[..length], line });
                }
                length
            }
            None => {
                let length =
                    rest.find(|c: char| !is_word(c)).unwrap_or(rest.len()).max(first.len_utf8());
                words.push(Token { text: &rest[..length], line });
                length
            }
        };
        line += rest[..length].matches('\n').count();
        rest = &rest[length..];
    }
    (words, comments)
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Length of the white space or comment at the start.
fn blank(rest: &str) -> Option<usize> {
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    if !rest.starts_with("/*") {
        return rest.chars().next().filter(|c| c.is_whitespace()).map(char::len_utf8);
    }

    // Block comments nest.
    let (mut depth, mut at) = (0, 0);
    while at < rest.len() {
        let here = &rest.as_bytes()[at..];
        match here {
            [b'/', b'*', ..] => (depth, at) = (depth + 1, at + 2),
            [b'*', b'/', ..] => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return Some(at);
        }
    }
    Some(rest.len())
}

/// Length of the string, byte string, raw string or character at the start, with its prefix.
fn quoted(rest: &str) -> Option<usize> {
    let prefix = ["br", "cr", "b", "c", "r", ""].into_iter().find(|p| {
        rest.strip_prefix(p).is_some_and(|after| after.starts_with(['"', '#', '\'']))
            && !(p.is_empty() && rest.starts_with('#'))
    })?;
    let after = &rest[prefix.len()..];
    let hashes = after.len() - after.trim_start_matches('#').len();
    match after.as_bytes().get(hashes)? {
        b'"' if prefix.ends_with('r') => {
            let end = format!("\"{}", "#".repeat(hashes));
            let body = prefix.len() + hashes + 1;
            Some(rest[body..].find(&end).map_or(rest.len(), |at| body + at + end.len()))
        }
        b'"' if hashes == 0 => Some(prefix.len() + closing(after, b'"')?),
        b'\'' if hashes == 0 && !prefix.ends_with('r') => {
            character(after).map(|length| prefix.len() + length)
        }
        _ => None,
    }
}

/// Length up to and with the closing quote; `text` starts with the opening one.
fn closing(text: &str, quote: u8) -> Option<usize> {
    let mut escaped = false;
    let end = text.bytes().skip(1).position(|byte| {
        let here = byte == quote && !escaped;
        escaped = byte == b'\\' && !escaped;
        here
    });
    Some(end.map_or(text.len(), |at| at + 2))
}

/// Length of a character; `None` for a lifetime, which has no closing quote.
fn character(text: &str) -> Option<usize> {
    let mut inside = text.char_indices().skip(1);
    let (_, first) = inside.next()?;
    if first == '\\' {
        return closing(text, b'\'');
    }
    inside.next().filter(|&(_, c)| c == '\'').map(|(at, _)| at + 1)
}

/// Marks the tokens that belong to items that only tests have: those under `#[cfg(test)]`.
pub(super) fn in_tests(tokens: &[Token<'_>]) -> Vec<bool> {
    let mut marked = vec![false; tokens.len()];
    let mut at = 0;
    while at < tokens.len() {
        if let Some(end) = test_attribute(&tokens[at..]) {
            let end = (at + end + item_length(&tokens[at + end..])).min(tokens.len());
            marked[at..end].fill(true);
            at = end;
        } else {
            at += 1;
        }
    }
    marked
}

/// The tokens of code that is built outside of tests.
pub(super) fn without_tests<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    tokens.iter().zip(in_tests(tokens)).filter(|(_, test)| !test).map(|(token, _)| *token).collect()
}

/// Length of the bracketed group at the start, at least 1.
pub(super) fn group_length(tokens: &[Token<'_>]) -> usize {
    let mut depth = 0_usize;
    for (at, token) in tokens.iter().enumerate() {
        match token.text {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return at + 1;
        }
    }
    tokens.len().max(1)
}

/// Length of a `#[cfg(...)]` that holds in tests alone.
fn test_attribute(tokens: &[Token<'_>]) -> Option<usize> {
    let starts =
        ["#", "[", "cfg", "("].iter().zip(tokens).filter(|(a, b)| **a == b.text).count() == 4;
    let length = 1 + group_length(tokens.get(1..).filter(|_| starts)?);
    let predicate = tokens.get(4..length.checked_sub(2)?)?;
    needs_test(predicate).then_some(length)
}

/// Whether a predicate of `cfg` cannot hold without `test`: one member of `all` needs it, or every
/// member of `any`.
fn needs_test(predicate: &[Token<'_>]) -> bool {
    let [name, rest @ ..] = predicate else { return false };
    let members = || {
        let inside = rest.get(1..rest.len().saturating_sub(1)).unwrap_or_default();
        split_list(inside).into_iter().filter(|member| !member.is_empty())
    };
    match name.text {
        "test" => true,
        "all" => members().any(needs_test),
        "any" => members().all(needs_test),
        _ => false,
    }
}

/// Cuts a list at its commas, those inside brackets excepted.
fn split_list<'t, 'a>(tokens: &'t [Token<'a>]) -> Vec<&'t [Token<'a>]> {
    let (mut members, mut start, mut at) = (Vec::new(), 0, 0);
    while at < tokens.len() {
        if tokens[at].text == "," {
            members.push(&tokens[start..at]);
            start = at + 1;
        }
        at += group_length(&tokens[at..]);
    }
    members.push(&tokens[start..]);
    members
}

/// Length of an item or field: up to its braces or a semicolon; for a field, up to its comma.
fn item_length(tokens: &[Token<'_>]) -> usize {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text);
    let name = match (text(0), text(1)) {
        ("pub", "(") => 1 + group_length(&tokens[1..]),
        ("pub", _) => 1,
        _ => 0,
    };
    let is_field = text(name + 1) == ":" && text(name + 2) != ":";
    let (mut at, mut angles) = (0, 0);
    while at < tokens.len() {
        match text(at) {
            // The braces around the item close.
            "}" => return at,
            ";" => return at + 1,
            "{" => return at + group_length(&tokens[at..]),
            "<" => angles += 1,
            ">" if text(at.saturating_sub(1)) != "-" => angles -= 1,
            "," if is_field && angles == 0 => return at + 1,
            _ => {}
        }
        at += group_length(&tokens[at..]);
    }
    tokens.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(source: &str) -> Vec<&str> {
        tokens(source).iter().map(|t| t.text).collect()
    }

    #[test]
    fn comments_and_strings_are_left_out() {
        assert_eq!(words("a /* b /* c */ d */ e // f\ng"), ["a", "e", "g"]);
        assert_eq!(
            words(r##"x("b \" c", r#"d " e"#, b"f", br"g\") y"##),
            ["x", "(", ",", ",", ",", ")", "y"]
        );
        assert_eq!(words(r"'a' '\'' '\u{1F600}' 'é' b'x' z"), ["z"]);
    }

    #[test]
    fn lifetimes_and_raw_names_stay() {
        assert_eq!(words("&'a str"), ["&", "'", "a", "str"]);
        assert_eq!(words("#[x] r#type bar"), ["#", "[", "x", "]", "r", "#", "type", "bar"]);
    }

    #[test]
    fn lines_are_counted() {
        let found = tokens("a\n\"two\nlines\"\n/* x\n */ b");
        assert_eq!(found, [Token { text: "a", line: 1 }, Token { text: "b", line: 5 }]);
    }

    #[test]
    fn unfinished_text_ends() {
        for source in ["/* x", "\"x", "r#\"x", "'\\", "'"] {
            assert!(tokens(source).len() <= 2, "{source}");
        }
    }

    #[test]
    fn test_items_are_marked() {
        let source = "fn a() {} #[cfg(test)] mod tests { fn b() { c() } } fn d() {} #[cfg(all(test, x))] use e; f";
        let found = tokens(source);
        let outside: Vec<_> = found
            .iter()
            .zip(in_tests(&found))
            .filter(|(_, test)| !test)
            .map(|(t, _)| t.text)
            .collect();
        assert_eq!(outside.join(" "), "fn a ( ) { } fn d ( ) { } f");
    }

    #[test]
    fn test_items_end_where_they_end() {
        let left = |source| {
            let words: Vec<_> = without_tests(&tokens(source)).iter().map(|t| t.text).collect();
            words.join(" ")
        };
        assert_eq!(left("#[cfg(test)] const A: [u8; 2] = [1; 2]; b"), "b");
        assert_eq!(
            left("struct A { #[cfg(test)] pub(crate) log: Vec<(u8, u8)>, b: u8 } c"),
            "struct A { b : u8 } c"
        );
        assert_eq!(left("struct A { #[cfg(test)] log: Map<A, B> } c"), "struct A { } c");
        assert_eq!(left("#[cfg(test)] fn f<A, B>(a: A) -> [B; 2] where A: C, B: D { {} } c"), "c");
    }

    #[test]
    fn only_what_needs_tests_is_marked() {
        let left = |predicate: &str| {
            without_tests(&tokens(&format!("#[cfg({predicate})] fn f() {{}} c"))).len() == 1
        };
        for predicate in ["test", "all(unix, test)", "any(test)", "any(test, all(test, x = \"y\"))"]
        {
            assert!(left(predicate), "{predicate}");
        }
        for predicate in ["any(test, feature = \"x\")", "not(test)", "unix", "all(unix, not(test))"]
        {
            assert!(!left(predicate), "{predicate}");
        }
    }
}
