//! Text as model files have it: bytes to UTF-8, and a cursor that reads words, numbers and lines.
//!
//! The cursor never copies and never looks back. Numbers are the hot spot of every text format:
//! digits are gathered in a 64-bit integer; when that integer is below 2^53 and the power of ten at
//! most 10^22, one exact `f64` product or quotient is the correctly rounded `f64` (Clinger 1990).
//! It is also the correctly rounded `f32`, unless it lies exactly between two of them or is
//! subnormal; these rare cases, and longer numbers, go to the standard library. Numbers in foreign
//! spellings go there, too: with a decimal comma (`0,5`), with Fortran's exponents (`2.0D+00`, and
//! `0.25-101`, where three digits leave no room for the letter).
//!
//! Cost: one look at each byte.

use std::borrow::Cow;

/// The bytes as UTF-8 text without a byte-order mark, lines ended by `\n` or `\r\n`. UTF-16 is
/// known by its mark or by its zero bytes and converted; a `\r` alone ends a line, too, and becomes
/// `\n`. Invalid UTF-8 is kept: keywords and numbers are ASCII, and names are converted by
/// [`name`].
pub(crate) fn to_utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    let text = match bytes {
        [0xEF, 0xBB, 0xBF, rest @ ..] => Cow::Borrowed(rest),
        [0xFF, 0xFE, rest @ ..] => Cow::Owned(from_utf16(rest, u16::from_le_bytes)),
        [0xFE, 0xFF, rest @ ..] => Cow::Owned(from_utf16(rest, u16::from_be_bytes)),
        _ => match zero_bytes(bytes) {
            (0, 1..) => Cow::Owned(from_utf16(bytes, u16::from_le_bytes)),
            (1.., 0) => Cow::Owned(from_utf16(bytes, u16::from_be_bytes)),
            _ => Cow::Borrowed(bytes),
        },
    };
    if !has_lone_return(&text) {
        return text;
    }
    let next = text[1..].iter().copied().chain([0]);
    Cow::Owned(
        text.iter()
            .zip(next)
            .map(|(&b, next)| if b == b'\r' && next != b'\n' { b'\n' } else { b })
            .collect(),
    )
}

/// Whether there is a `\r` that no `\n` follows. Looks at blocks without a branch for each byte, so
/// that it costs next to nothing whether or not there are many `\r\n`.
fn has_lone_return(text: &[u8]) -> bool {
    const BLOCK: usize = 1 << 12;
    let next = text.get(1..).unwrap_or_default();
    let lone = |(a, b): (&[u8], &[u8])| {
        a.iter()
            .zip(b)
            .fold(0, |lone, (&a, &b)| lone | (u8::from(a == b'\r') & u8::from(b != b'\n')))
            != 0
    };
    text.last() == Some(&b'\r') || text.chunks(BLOCK).zip(next.chunks(BLOCK)).any(lone)
}

/// A name or a line of names as text: continued lines become one, with a blank between, and what is
/// not UTF-8 is taken for Latin-1, as old programs wrote it.
pub(crate) fn name(bytes: &[u8]) -> Cow<'_, str> {
    if bytes.contains(&b'\n') {
        let lines = bytes.split(|&b| b == b'\n').map(|line| {
            let line = line.trim_ascii();
            line.strip_suffix(b"\\").unwrap_or(line).trim_ascii_end()
        });
        return Cow::Owned(name(&lines.collect::<Vec<_>>().join(&b' ')).into_owned());
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().copied().map(char::from).collect()),
    }
}

fn from_utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Vec<u8> {
    let units = bytes.as_chunks::<2>().0.iter().map(|&pair| unit(pair));
    let text: String =
        char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
    text.into_bytes()
}

/// Zero bytes at even and at odd offsets among the first 64, if every pair of bytes has at least
/// one ASCII character and the zeros are all on one side; `(0, 0)` for anything else.
fn zero_bytes(bytes: &[u8]) -> (usize, usize) {
    let pairs = &bytes.as_chunks::<2>().0;
    let pairs = &pairs[..pairs.len().min(32)];
    let even = pairs.iter().filter(|p| p[0] == 0 && p[1].is_ascii() && p[1] != 0).count();
    let odd = pairs.iter().filter(|p| p[1] == 0 && p[0].is_ascii() && p[0] != 0).count();
    if pairs.len() >= 2 && (even == pairs.len() || odd == pairs.len()) {
        (even, odd)
    } else {
        (0, 0)
    }
}

/// Whether `byte` separates words on a line.
pub(crate) fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | 0x0B | 0x0C)
}

/// `name` without a comment behind it: a `#` after a blank, unless a digit follows, since 3ds Max
/// calls materials `Material #25`.
pub(crate) fn without_comment(name: &str) -> &str {
    comment_behind(name.as_bytes()).map_or(name, |k| name[..k].trim_ascii_end())
}

/// Where the comment behind a name begins.
fn comment_behind(name: &[u8]) -> Option<usize> {
    let begins = |k: &usize| {
        let next = name.get(k + 1).copied().unwrap_or(b' ');
        name[*k] == b'#' && is_blank(name[k - 1]) && !next.is_ascii_digit()
    };
    (1..name.len()).find(begins)
}

/// Whether the next line continues `line`: it ends with a `\`, which is not that of a comment.
fn is_continued(line: &[u8]) -> bool {
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    line.last() == Some(&b'\\') && line[0] != b'#' && comment_behind(line).is_none()
}

/// Cuts `text` into pieces of about `size` bytes, each ending after a line break that no `\`
/// continues.
pub(crate) fn cut_at_lines(text: &[u8], size: usize) -> Vec<&[u8]> {
    let mut pieces = Vec::with_capacity(text.len() / size + 1);
    let mut rest = text;
    while rest.len() > size {
        // Go on to the first line break that is not continued.
        let is_cut = |&end: &usize| {
            let before = rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]);
            rest[end] == b'\n' && before.last() != Some(&b'\\')
        };
        let Some(end) = (size..rest.len()).find(is_cut) else { break };
        let (piece, after) = rest.split_at(end + 1);
        pieces.push(piece);
        rest = after;
    }
    if !rest.is_empty() {
        pieces.push(rest);
    }
    pieces
}

/// A place in a text. Every reading method first skips blanks; none but [`Cursor::next_line`]
/// leaves the line, except that a `\` at the end of a line, but for comments, joins the next line
/// to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u64,
    ill_formed: bool,
}

impl<'a> Cursor<'a> {
    /// The beginning of `bytes`, line 1.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, line: 1, ill_formed: false }
    }

    /// The beginning of `bytes`, which is line `line` of the file.
    pub(crate) fn at_line(bytes: &'a [u8], line: u64) -> Self {
        Self { line, ..Self::new(bytes) }
    }

    /// The line the cursor is on, counted from 1.
    pub(crate) fn line(&self) -> u64 {
        self.line
    }

    /// The byte offset of the cursor.
    pub(crate) fn offset(&self) -> usize {
        self.at
    }

    /// Bytes that are not read yet.
    pub(crate) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Whether the text is at its end.
    pub(crate) fn at_end(&self) -> bool {
        self.at >= self.bytes.len()
    }

    /// Whether a number with something behind it, such as `3.1+e2`, was read since the last call.
    pub(crate) fn take_ill_formed(&mut self) -> bool {
        std::mem::take(&mut self.ill_formed)
    }

    /// The byte at the cursor; the end of the text reads as a line break.
    #[inline(always)]
    pub(crate) fn peek(&self) -> u8 {
        self.byte(self.at)
    }

    #[inline(always)]
    fn byte(&self, at: usize) -> u8 {
        if at < self.bytes.len() { self.bytes[at] } else { b'\n' }
    }

    /// Goes on `count` bytes, at most to the end.
    #[inline(always)]
    pub(crate) fn advance(&mut self, count: usize) {
        self.at = (self.at + count).min(self.bytes.len());
    }

    /// Goes on to the next word of the line, over continued line ends.
    #[inline(always)]
    pub(crate) fn skip_blanks(&mut self) {
        while is_blank(self.peek()) {
            self.at += 1;
        }
        if self.peek() == b'\\' {
            self.skip_continuation();
        }
    }

    #[cold]
    fn skip_continuation(&mut self) {
        loop {
            while is_blank(self.peek()) {
                self.at += 1;
            }
            if !self.is_continuation(self.at) {
                return;
            }
            let after = self.at + 1 + usize::from(self.byte(self.at + 1) == b'\r');
            self.at = (after + 1).min(self.bytes.len());
            self.line += 1;
            if self.at_end() {
                return;
            }
        }
    }

    /// Whether the byte at `at` is a `\` at the end of a line.
    fn is_continuation(&self, at: usize) -> bool {
        let after = at + 1 + usize::from(self.byte(at + 1) == b'\r');
        self.byte(at) == b'\\' && self.byte(after) == b'\n'
    }

    /// Whether nothing but a comment (`#`) is left on the line.
    #[inline(always)]
    pub(crate) fn at_line_end(&mut self) -> bool {
        self.skip_blanks();
        matches!(self.peek(), b'\n' | b'#')
    }

    /// Goes to the beginning of the next line, whatever is left on this one and those that continue
    /// it.
    #[inline]
    pub(crate) fn next_line(&mut self) {
        self.finish_line();
        if !self.at_end() {
            self.at += 1;
            self.line += 1;
        }
    }

    /// Goes to the end of the line, or of the last one that continues it.
    #[inline]
    fn finish_line(&mut self) {
        loop {
            let rest = &self.bytes[self.at..];
            let length = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
            self.at += length;
            if self.at_end() || !is_continued(&rest[..length]) {
                return;
            }
            self.at += 1;
            self.line += 1;
        }
    }

    /// Goes to the first line that holds more than blanks and a comment; false at the end of the
    /// text.
    pub(crate) fn next_content(&mut self) -> bool {
        while self.at_line_end() {
            if self.at_end() {
                return false;
            }
            self.next_line();
        }
        true
    }

    /// The next word; empty at the end of the line.
    #[inline]
    pub(crate) fn word(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let start = self.at;
        while !is_blank(self.peek()) && self.peek() != b'\n' {
            self.at += 1;
        }
        // The sign of a continued line is no part of a word.
        if self.at > start && self.bytes[self.at - 1] == b'\\' && self.is_continuation(self.at - 1)
        {
            self.at -= 1;
        }
        &self.bytes[start..self.at]
    }

    /// The first word from byte `at` on, which was passed already.
    pub(crate) fn word_at(&self, at: usize) -> &'a [u8] {
        Self { at, ..*self }.word()
    }

    /// What is left of the line and those that continue it, for [`name`]; without blanks round it.
    pub(crate) fn rest_of_line(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let start = self.at;
        self.finish_line();
        self.bytes[start..self.at].trim_ascii()
    }

    /// The next number in double precision; otherwise as [`Self::float`].
    pub(crate) fn double(&mut self) -> Option<f64> {
        self.skip_blanks();
        let start = self.at;
        let single = self.float()?;

        // Read the same bytes once more. What the library does not know has no more digits than
        // single precision.
        let word = self.bytes[start..self.at].trim_ascii();
        let spelled = foreign_spelling(word);
        let word = spelled.as_deref().unwrap_or(word);
        let parsed = std::str::from_utf8(word).ok().and_then(|text| text.parse::<f64>().ok());
        Some(parsed.filter(|value| value.is_finite()).unwrap_or(f64::from(single)))
    }

    /// The next number as `f32`, or `None` (and no step) if the next word does not begin as one or
    /// has commas that could part numbers. Anything else glued to the number is skipped and noted
    /// for [`Self::take_ill_formed`]. Reads `nan`, `inf` and MSVC's `1.#QNAN` too.
    #[inline]
    pub(crate) fn float(&mut self) -> Option<f32> {
        self.skip_blanks();
        let start = self.at;
        let mut at = start;
        let negative = self.byte(at) == b'-';
        at += usize::from(matches!(self.byte(at), b'-' | b'+'));

        // Gather the digits on both sides of the point.
        let mut mantissa = 0u64;
        let whole = self.digits(&mut at, &mut mantissa);
        let mut fraction = 0;
        if self.byte(at) == b'.' {
            at += 1;
            fraction = self.digits(&mut at, &mut mantissa);
        }
        if whole + fraction == 0 {
            return self.named_float();
        }
        let mut power = -(fraction.min(1 << 20) as i32);
        if matches!(self.byte(at), b'e' | b'E') {
            power += self.exponent(&mut at);
        }

        // Take the short way where it is exact.
        self.at = at;
        let value = match exact(mantissa, whole + fraction, power) {
            Some(value) => {
                if negative {
                    -value
                } else {
                    value
                }
            }
            None => long_float(&self.bytes[start..at]),
        };
        let next = self.peek();
        if is_blank(next) || next == b'\n' { Some(value) } else { self.tail_of_float(start, value) }
    }

    /// The digits at `at`, appended to `mantissa` (which wraps round: the caller counts); gives
    /// their number.
    #[inline(always)]
    fn digits(&self, at: &mut usize, mantissa: &mut u64) -> usize {
        let start = *at;
        loop {
            let digit = self.byte(*at).wrapping_sub(b'0');
            if digit > 9 {
                return *at - start;
            }
            *mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
            *at += 1;
        }
    }

    /// The exponent at `at`, which is on an `e`; `at` stays there if no digits follow.
    fn exponent(&self, at: &mut usize) -> i32 {
        let sign = self.byte(*at + 1);
        let mut end = *at + 1 + usize::from(matches!(sign, b'-' | b'+'));
        let mut value = 0i32;
        let first = end;
        while self.byte(end).is_ascii_digit() {
            value = (value * 10 + i32::from(self.byte(end) - b'0')).min(1 << 24);
            end += 1;
        }
        if end > first {
            *at = end;
        }
        if sign == b'-' { -value } else { value }
    }

    #[cold]
    fn named_float(&mut self) -> Option<f32> {
        let start = self.at;
        let word = self.word().to_ascii_lowercase();
        let (negative, name) = match word.as_slice() {
            [b'-', name @ ..] => (true, name),
            [b'+', name @ ..] => (false, name),
            name => (false, name),
        };
        match name {
            b"inf" | b"infinity" => Some(if negative { f32::NEG_INFINITY } else { f32::INFINITY }),
            name if name.starts_with(b"nan") => Some(f32::NAN),
            _ => {
                self.at = start;
                None
            }
        }
    }

    /// The number that began at `start` and whose head is `value`, with something behind it.
    #[cold]
    fn tail_of_float(&mut self, start: usize, value: f32) -> Option<f32> {
        let end = self.at;
        if self.is_continuation(end) {
            return Some(value);
        }
        let tail = self.word().to_ascii_uppercase();
        let word = &self.bytes[start..self.at];
        if let Some(spelled) = foreign_spelling(word) {
            return Some(long_float(&spelled));
        }
        Some(match tail.as_slice() {
            [b'#', b'I', b'N', b'F', ..] => f32::INFINITY.copysign(value),
            [b'#', b'Q' | b'S' | b'I', ..] => f32::NAN,
            // A comment may follow without a blank.
            [b'#', ..] => {
                self.at = end;
                value
            }
            // `1,2,3` may be one number or three.
            [b',', b'0'..=b'9', ..] => {
                self.at = start;
                return None;
            }
            _ => {
                self.ill_formed = true;
                value
            }
        })
    }

    /// The next integer, saturated at 2^62, or `None` (and no step) if there is none. It may be
    /// followed by anything.
    #[inline]
    pub(crate) fn integer(&mut self) -> Option<i64> {
        self.skip_blanks();
        let mut at = self.at;
        let negative = self.byte(at) == b'-';
        at += usize::from(matches!(self.byte(at), b'-' | b'+'));
        let first = at;
        let mut value = 0i64;
        loop {
            let digit = self.byte(at).wrapping_sub(b'0');
            if digit > 9 {
                break;
            }
            value = if value < 1 << 58 { value * 10 + i64::from(digit) } else { 1 << 62 };
            at += 1;
        }
        if at == first {
            return None;
        }
        self.at = at;
        Some(if negative { -value } else { value })
    }
}

const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// `mantissa * 10^power` correctly rounded to `f32`, where that takes one exact step.
#[inline(always)]
fn exact(mantissa: u64, digits: usize, power: i32) -> Option<f32> {
    if digits > 19 || mantissa >= 1 << 53 || power.unsigned_abs() > 22 {
        return None;
    }
    let scale = POWERS[power.unsigned_abs() as usize];
    let value = if power < 0 { mantissa as f64 / scale } else { mantissa as f64 * scale };
    // Rounding twice may go wrong half-way between two f32 and among the subnormal ones.
    let half_way = value.to_bits() & 0x1FFF_FFFF == 0x1000_0000;
    let subnormal = value < f64::from(f32::MIN_POSITIVE) && value != 0.0;
    if half_way || subnormal { None } else { Some(value as f32) }
}

/// `word` as the standard library spells numbers, if it has a decimal comma between digits or an
/// exponent of Fortran's.
#[cold]
fn foreign_spelling(word: &[u8]) -> Option<Vec<u8>> {
    let is_digit = |k: usize| word.get(k).is_some_and(u8::is_ascii_digit);
    let mut spelled = word.to_vec();

    // Turn a comma into a point where there is no point.
    let comma = word.iter().position(|&b| b == b',');
    if let Some(k) = comma {
        if k == 0 || !is_digit(k - 1) || !is_digit(k + 1) || word.contains(&b'.') {
            return None;
        }
        spelled[k] = b'.';
    }

    // Turn a `D` into an `e`, or put one before a sign that three digits follow.
    let exponent = word.iter().position(|b| b.eq_ignore_ascii_case(&b'd'));
    if let Some(k) = exponent {
        spelled[k] = b'e';
    }
    let sign = word
        .iter()
        .rposition(|b| matches!(b, b'+' | b'-'))
        .filter(|&k| k > 0 && k + 4 == word.len());
    let bare = sign.filter(|&k| is_digit(k - 1) || word[k - 1] == b'.');
    if let Some(k) = bare {
        spelled.insert(k, b'e');
    }
    let is_foreign = comma.is_some() || exponent.is_some() || bare.is_some();
    let is_number = || std::str::from_utf8(&spelled).is_ok_and(|text| text.parse::<f64>().is_ok());
    (is_foreign && is_number()).then_some(spelled)
}

#[cold]
fn long_float(token: &[u8]) -> f32 {
    // The token has the standard library's grammar; it is ASCII.
    std::str::from_utf8(token).ok().and_then(|t| t.parse().ok()).unwrap_or(f32::NAN)
}

#[cfg(test)]
mod tests;
