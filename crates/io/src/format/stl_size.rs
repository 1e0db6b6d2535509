//! The size of a binary STL file, by which it is known: the format has no magic number.

/// Bytes before the first triangle: free text, then the number of triangles.
pub(crate) const HEADER: usize = 84;
/// Bytes of a triangle.
pub(crate) const RECORD: usize = 50;

/// Whether the size is what the triangle count of a binary file demands.
pub(crate) fn is_binary_size(bytes: &[u8]) -> bool {
    claimed(bytes)
        .is_some_and(|n| bytes.len() as u64 == HEADER as u64 + RECORD as u64 * u64::from(n))
}

/// Whether the size is that of a binary file whose count was never filled in, as programs leave it
/// that write into a pipe.
pub(crate) fn is_unfinished(bytes: &[u8]) -> bool {
    let blank = matches!(claimed(bytes), Some(0 | u32::MAX));
    blank && bytes.len() > HEADER && (bytes.len() - HEADER).is_multiple_of(RECORD)
}

/// The triangle count of a binary file's header.
pub(crate) fn claimed(bytes: &[u8]) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(80..HEADER)?.first_chunk()?))
}
