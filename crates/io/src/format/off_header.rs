//! The first line of an OFF file, by which it is known.

use crate::text::Cursor;

/// What the first word of the file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Header {
    pub(crate) texture: bool,
    pub(crate) color: bool,
    pub(crate) normal: bool,
    pub(crate) homogeneous: bool,
    pub(crate) dimensions: bool,
}

impl Header {
    /// Understands `OFF` and its prefixes; `None` for any other word.
    pub(crate) fn parse(word: &[u8]) -> Option<Self> {
        let (prefixes, name) = word.split_at_checked(word.len().checked_sub(3)?)?;
        if !name.eq_ignore_ascii_case(b"OFF") {
            return None;
        }
        // `N` says that there are normals, `n` how many dimensions: only in lower case throughout
        // they cannot be told apart.
        let is_lower = name == b"off";
        let mut header = Self {
            texture: false,
            color: false,
            normal: false,
            homogeneous: false,
            dimensions: false,
        };
        let mut rest = prefixes;
        while !rest.is_empty() {
            let (flag, length) = match rest {
                [b'S' | b's', b'T' | b't', ..] => (&mut header.texture, 2),
                [b'C' | b'c', ..] => (&mut header.color, 1),
                [b'N', ..] => (&mut header.normal, 1),
                [b'n', ..] if is_lower => (&mut header.normal, 1),
                [b'n', ..] => (&mut header.dimensions, 1),
                [b'4', ..] => (&mut header.homogeneous, 1),
                _ => return None,
            };
            if std::mem::replace(flag, true) {
                return None;
            }
            rest = &rest[length..];
        }
        Some(header)
    }

    /// The header with which `word` begins, and its length. Behind it may be a count, without a
    /// blank between.
    pub(crate) fn begin(word: &[u8]) -> Option<(Self, usize)> {
        let digits = word.iter().rev().take_while(|b| b.is_ascii_digit()).count();
        let length = word.len() - digits;
        Some((Self::parse(&word[..length])?, length))
    }
}

/// Whether the text reads like an OFF file without its first word: a line of three counts, then a
/// vertex.
pub(crate) fn begins_bare(mut cursor: Cursor) -> bool {
    let has_counts = cursor.next_content()
        && (0..3).all(|_| matches!(cursor.integer(), Some(0..)))
        && cursor.at_line_end();
    cursor.next_line();
    has_counts
        && cursor.next_content()
        && (0..3).all(|_| cursor.float().is_some() && !cursor.take_ill_formed())
}
