//! What an answer consists of.

use serde_json::Value;
use vitral::Error;

/// What was asked for, and planes of bytes beside it.
pub(crate) type Answer = Result<(Value, Vec<Vec<u8>>), Error>;
