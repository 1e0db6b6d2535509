//! How the stages' files are written and listed.

use crate::Error;

/// A file that the index lists.
pub(super) struct Listed {
    pub(super) name: String,
    pub(super) what: String,
}

/// Takes a file: its name and bytes.
pub(super) type Write<'a> = dyn FnMut(&str, &[u8]) -> Result<(), Error> + 'a;
