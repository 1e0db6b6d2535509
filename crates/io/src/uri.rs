//! URIs of buffers and images: `data:` URIs with base64 (RFC 2397, RFC 4648), and relative paths
//! with percent escapes.
//!
//! Cost: linear in the length of the URI. Source: \[URI\]: the RFCs named above, RFC 3986 for the
//!       escapes.

/// What a URI stands for.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// The bytes that it holds itself.
    Inline(Vec<u8>),
    /// A file, relative to the one that names it; escapes are resolved.
    File(String),
}

/// Reads a URI. The error says what is wrong with it.
pub(crate) fn resolve(uri: &str) -> Result<Target, String> {
    if let Some(rest) = strip_scheme(uri, "data:") {
        let (head, body) =
            rest.split_once(',').ok_or("a data URI needs a comma between its type and its data")?;
        let is_base64 = head.len() >= 7
            && head.is_char_boundary(head.len() - 7)
            && head[head.len() - 7..].eq_ignore_ascii_case(";base64");
        let bytes = if is_base64 { base64(body.as_bytes())? } else { unescape(body) };
        return Ok(Target::Inline(bytes));
    }
    if let Some((scheme, _)) = uri.split_once("://") {
        return Err(format!("`{scheme}:` addresses are not fetched, only files and data URIs"));
    }
    let path =
        String::from_utf8(unescape(uri)).map_err(|_| "the escapes do not form UTF-8".to_owned())?;
    Ok(Target::File(path))
}

/// The rest of `uri` behind `scheme`, whatever the case of its letters.
fn strip_scheme<'a>(uri: &'a str, scheme: &str) -> Option<&'a str> {
    let head = uri.get(..scheme.len())?;
    head.eq_ignore_ascii_case(scheme).then(|| &uri[scheme.len()..])
}

/// Resolves `%XX`. A percent sign that starts no escape stands for itself, since many exporters
/// forget to escape it.
fn unescape(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let hex = |i: usize| bytes.get(i).and_then(|&b| char::from(b).to_digit(16));
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        match (bytes[i], hex(i + 1), hex(i + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push((high * 16 + low) as u8);
                i += 3;
            }
            (byte, ..) => {
                out.push(byte);
                i += 1;
            }
        }
    }
    out
}

/// Decodes base64, the standard or the URL alphabet, with or without padding, ignoring white space.
fn base64(text: &[u8]) -> Result<Vec<u8>, String> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut bits, mut count, mut ended) = (0u32, 0u32, false);
    for (i, &byte) in text.iter().enumerate() {
        let value = match byte {
            b'=' => {
                ended = true;
                continue;
            }
            b' ' | b'\t' | b'\r' | b'\n' => continue,
            _ if ended => return Err(format!("base64: character {i} behind the padding")),
            _ => DIGITS[usize::from(byte)],
        };
        if value == NO_DIGIT {
            return Err(format!("base64: character {i} is not one of A-Z a-z 0-9 + /"));
        }
        // Collect six bits a character and give out whole bytes.
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
    }
    if count == 6 {
        Err("base64: one character is left over at the end".to_owned())
    } else {
        Ok(out)
    }
}

const NO_DIGIT: u8 = 64;

/// The value of each base64 character.
const DIGITS: [u8; 256] = {
    let mut table = [NO_DIGIT; 256];
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut i = 0;
    while i < 64 {
        table[alphabet[i] as usize] = i as u8;
        i += 1;
    }
    table[b'-' as usize] = 62;
    table[b'_' as usize] = 63;
    table
};

/// Encodes base64 with padding.
pub(crate) fn to_base64(bytes: &[u8]) -> String {
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let bits =
            group.iter().fold(0u32, |bits, &b| bits << 8 | u32::from(b)) << (8 * (3 - group.len()));
        for k in 0..4 {
            let digit = alphabet[(bits >> (18 - 6 * k) & 63) as usize];
            out.push(if k <= group.len() { char::from(digit) } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_by_the_vectors_of_rfc_4648() {
        for (plain, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
        ] {
            assert_eq!(base64(coded.as_bytes()).unwrap(), plain.as_bytes());
            assert_eq!(
                base64(coded.trim_end_matches('=').as_bytes()).unwrap(),
                plain.as_bytes(),
                "padding is optional"
            );
            assert_eq!(to_base64(plain.as_bytes()), coded);
        }
        assert!(base64(b"Zg==Zg").is_err() && base64(b"Z").is_err() && base64(b"Z*==").is_err());
    }

    #[test]
    fn uris_name_bytes_or_files() {
        assert_eq!(
            resolve("data:application/octet-stream;base64,AAEC"),
            Ok(Target::Inline(vec![0, 1, 2]))
        );
        assert_eq!(resolve("DATA:text/plain,a%20b"), Ok(Target::Inline(b"a b".to_vec())));
        assert_eq!(
            resolve("a%20folder/100%.bin"),
            Ok(Target::File("a folder/100%.bin".to_owned()))
        );
        assert!(resolve("data:nothing").is_err());
        assert!(resolve("http://example.org/a.bin").unwrap_err().contains("http"));
        assert!(resolve("a%ff.bin").is_err(), "not UTF-8");
    }
}
