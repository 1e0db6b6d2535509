//! What an answer consists of.

use serde_json::{Value, json};
use vitral::Error;

/// What was asked for, and planes of bytes beside it.
pub(crate) type Answer = Result<(Value, Vec<Vec<u8>>), Error>;

/// An error as its message and a hint, which may be null.
pub(crate) fn told(error: &Error) -> Value {
    let hint = match error {
        Error::Usage { hint, .. } | Error::Unsupported { hint, .. } => Some(hint.as_str()),
        _ => None,
    };
    json!({"message": error.to_string(), "hint": hint.filter(|hint| !hint.is_empty())})
}
