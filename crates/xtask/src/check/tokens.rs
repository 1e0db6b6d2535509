//! Rust source as a list of words: comments, strings and characters are left out.
//!
//! Enough of the language to find paths and macros, not to understand them: identifiers (numbers too) are one token,
//! every other visible character is one token.

/// A word of code and the line it stands on, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Token<'a> {
    pub(super) text: &'a str,
    pub(super) line: usize,
}

/// Splits `source` into words.
pub(super) fn tokens(source: &str) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    let (mut rest, mut line) = (source, 1);
    while let Some(first) = rest.chars().next() {
        let length = match blank(rest).or_else(|| quoted(rest)) {
            Some(length) => length,
            None => {
                let length = rest.find(|c: char| !is_word(c)).unwrap_or(rest.len()).max(first.len_utf8());
                found.push(Token { text: &rest[..length], line });
                length
            }
        };
        line += rest[..length].matches('\n').count();
        rest = &rest[length..];
    }
    found
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
        b'\'' if hashes == 0 && !prefix.ends_with('r') => character(after).map(|length| prefix.len() + length),
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

/// Marks the tokens that belong to items under `#[cfg(test)]`.
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

/// Length of `#[cfg(...)]` with `test` somewhere in it.
fn test_attribute(tokens: &[Token<'_>]) -> Option<usize> {
    let starts = ["#", "[", "cfg", "("].iter().zip(tokens).filter(|(a, b)| **a == b.text).count() == 4;
    let end = tokens.iter().position(|t| t.text == "]").filter(|_| starts)?;
    tokens[..end].iter().any(|t| t.text == "test").then_some(end + 1)
}

/// Length of an item: up to the brace that closes its first brace, or a semicolon before that.
fn item_length(tokens: &[Token<'_>]) -> usize {
    let (mut depth, mut brackets) = (0, 0);
    for (at, token) in tokens.iter().enumerate() {
        match token.text {
            "(" | "[" => brackets += 1,
            ")" | "]" => brackets -= 1,
            "{" => depth += 1,
            "}" if depth <= 1 => return at + 1,
            "}" => depth -= 1,
            ";" if depth == 0 && brackets == 0 => return at + 1,
            _ => {}
        }
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
        assert_eq!(words(r##"x("b \" c", r#"d " e"#, b"f", br"g\") y"##), ["x", "(", ",", ",", ",", ")", "y"]);
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
        let outside: Vec<_> =
            found.iter().zip(in_tests(&found)).filter(|(_, test)| !test).map(|(t, _)| t.text).collect();
        assert_eq!(outside.join(" "), "fn a ( ) { } fn d ( ) { } f");
    }
}
