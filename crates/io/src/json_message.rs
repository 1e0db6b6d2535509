//! Messages of the JSON parser, in the words of this crate.

/// The message without the position, which [`Place`](crate::Place) gives, and without names of
/// Rust's types.
pub(crate) fn plain_message(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let text = text.split(" at line ").next().unwrap_or_default();
    match text.split_once(", expected struct ") {
        Some((found, _)) => format!("{found}, expected an object"),
        None => text.to_owned(),
    }
}
