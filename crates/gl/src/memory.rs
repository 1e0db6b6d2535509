//! The client's memory, as the state machine sees it.

use std::sync::Mutex;

/// Reads and writes the client's memory. Addresses are as the client gave them; 0 is never passed.
pub trait ClientMemory: Send + Sync + std::fmt::Debug {
    /// Copies `out.len()` bytes from `address`. `false` if that range is not the client's (nothing is promised of `out`).
    fn read(&self, address: usize, out: &mut [u8]) -> bool;
    /// Copies `bytes` to `address`. `false` if that range is not the client's.
    fn write(&self, address: usize, bytes: &[u8]) -> bool;
    /// Hands a buffer's bytes to the client and returns their address (not 0), where it may read and write them.
    fn map(&self, bytes: Vec<u8>) -> usize;
    /// Takes mapped bytes back; `None` if nothing is mapped there.
    fn unmap(&self, address: usize) -> Option<Vec<u8>>;
}

/// A bounded piece of memory at a made-up address, for tests and fuzzing.
#[derive(Debug)]
pub struct Arena {
    base: usize,
    bytes: Mutex<Vec<u8>>,
}

impl Arena {
    /// `len` zero bytes that appear to the state machine at `base` (not 0).
    pub fn new(base: usize, len: usize) -> Self {
        Self { base, bytes: Mutex::new(vec![0; len]) }
    }

    fn range(&self, address: usize, len: usize, total: usize) -> Option<std::ops::Range<usize>> {
        let start = address.checked_sub(self.base)?;
        let end = start.checked_add(len)?;
        (end <= total).then_some(start..end)
    }
}

impl ClientMemory for Arena {
    fn read(&self, address: usize, out: &mut [u8]) -> bool {
        let bytes = self.bytes.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let Some(range) = self.range(address, out.len(), bytes.len()) else { return false };
        out.copy_from_slice(&bytes[range]);
        true
    }

    fn write(&self, address: usize, data: &[u8]) -> bool {
        let mut bytes = self.bytes.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let total = bytes.len();
        let Some(range) = self.range(address, data.len(), total) else { return false };
        bytes[range].copy_from_slice(data);
        true
    }
}
