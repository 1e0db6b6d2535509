//! The client's memory, as the state machine sees it.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Reads and writes the client's memory. Addresses are as the client gave them; 0 is never passed.
pub trait ClientMemory: Send + Sync + std::fmt::Debug {
    /// Copies `out.len()` bytes from `address`. `false` if that range is not the client's (nothing
    /// is promised of `out`).
    fn read(&self, address: usize, out: &mut [u8]) -> bool;
    /// Copies `bytes` to `address`. `false` if that range is not the client's.
    fn write(&self, address: usize, bytes: &[u8]) -> bool;
    /// Whether `length` bytes from `address` on are still the client's, asked before a picture is
    /// stored or loaded in a call that does not say so.
    fn is_there(&self, address: usize, length: usize) -> bool {
        let _ = (address, length);
        true
    }
    /// Hands a buffer's bytes to the client and returns their address (not 0), where it may read
    /// and write them.
    fn map(&self, bytes: Vec<u8>) -> usize;
    /// Takes mapped bytes back; `None` if nothing is mapped there.
    fn unmap(&self, address: usize) -> Option<Vec<u8>>;
}

/// Memory of at least so many bytes is asked for before it is taken: less can nearly always be had.
pub(crate) const LARGE: usize = 1 << 20;

/// Whether so many bytes can be had. What cannot is an error of the program, and not the end of the
/// process.
pub(crate) fn can_have(bytes: usize) -> bool {
    if bytes < LARGE {
        return true;
    }
    let mut memory = Vec::<u8>::new();
    let reserved = memory.try_reserve_exact(bytes).is_ok();
    // Without this the compiler may leave out memory that nobody uses.
    std::hint::black_box(&memory);
    reserved
}

/// A bounded piece of memory at a made-up address, for tests and fuzzing. Mapped buffers lie behind
/// it.
#[derive(Debug)]
pub struct Arena {
    regions: Mutex<Regions>,
}

#[derive(Debug)]
struct Regions {
    /// By address; they never overlap.
    bytes: BTreeMap<usize, Vec<u8>>,
    /// The arena itself, which cannot be unmapped.
    base: usize,
    /// Where the next mapped buffer will lie.
    next: usize,
}

/// Between regions, so that what runs over an end is seen.
const GAP: usize = 4096;

impl Arena {
    /// `len` zero bytes that appear to the state machine at `base` (not 0).
    pub fn new(base: usize, len: usize) -> Self {
        let bytes = BTreeMap::from([(base, vec![0; len])]);
        Self {
            regions: Mutex::new(Regions {
                bytes,
                base,
                next: base.saturating_add(len).saturating_add(GAP),
            }),
        }
    }

    fn lock(&self) -> MutexGuard<'_, Regions> {
        self.regions.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Regions {
    fn slice(&mut self, address: usize, len: usize) -> Option<&mut [u8]> {
        let (base, bytes) = self.bytes.range_mut(..=address).next_back()?;
        let start = address - base;
        bytes.get_mut(start..start.checked_add(len)?)
    }
}

impl ClientMemory for Arena {
    fn read(&self, address: usize, out: &mut [u8]) -> bool {
        let mut regions = self.lock();
        let Some(bytes) = regions.slice(address, out.len()) else { return false };
        out.copy_from_slice(bytes);
        true
    }

    fn write(&self, address: usize, bytes: &[u8]) -> bool {
        let mut regions = self.lock();
        let Some(into) = regions.slice(address, bytes.len()) else { return false };
        into.copy_from_slice(bytes);
        true
    }

    fn map(&self, bytes: Vec<u8>) -> usize {
        let mut regions = self.lock();
        let address = regions.next;
        regions.next = address.saturating_add(bytes.len()).saturating_add(GAP);
        regions.bytes.insert(address, bytes);
        address
    }

    fn unmap(&self, address: usize) -> Option<Vec<u8>> {
        let mut regions = self.lock();
        if address == regions.base { None } else { regions.bytes.remove(&address) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_lies_within_is_reached() {
        let arena = Arena::new(1000, 8);
        let mut two = [9; 2];
        assert!(arena.write(1006, &[1, 2]) && arena.read(1006, &mut two));
        assert_eq!(two, [1, 2]);
        assert!(
            !arena.read(1007, &mut two)
                && !arena.read(999, &mut two)
                && !arena.read(usize::MAX, &mut two)
        );
    }

    #[test]
    fn wild_amounts_cannot_be_had() {
        assert!(can_have(0) && can_have(LARGE) && !can_have(usize::MAX / 2));
    }

    #[test]
    fn mapped_bytes_come_back_as_written() {
        let arena = Arena::new(1000, 8);
        let address = arena.map(vec![1, 2, 3]);
        assert!(arena.write(address + 1, &[7]) && !arena.write(address + 3, &[7]));
        assert_eq!(arena.unmap(address), Some(vec![1, 7, 3]));
        assert_eq!(arena.unmap(address), None);
        assert_eq!(arena.unmap(1000), None);
    }
}
