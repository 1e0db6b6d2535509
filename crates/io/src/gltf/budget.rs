//! How large a scene a small file may unfold into.

use super::accessor::Source;

/// Bytes that any file may unfold into.
const FREE_BYTES: u64 = 64 << 20;
/// Bytes that a file may unfold into for each byte of its buffers.
const BYTES_PER_BYTE: u64 = 64;

/// Bytes that this document may unfold into.
pub(crate) fn unfolded_bytes(source: &Source<'_>) -> u64 {
    FREE_BYTES + BYTES_PER_BYTE * source.buffers.total()
}
