//! The client's memory: the process' own, wherever the client says.

use std::collections::BTreeMap;
use std::mem::ManuallyDrop;
use std::ptr;
use std::sync::{Mutex, PoisonError};
use vitral_gl::ClientMemory;

/// A mapped buffer: length and capacity of the vector that was taken apart.
type Mapped = (usize, usize);

/// The memory of this process. That an address is right is the client's part of the contract.
#[derive(Debug, Default)]
pub(crate) struct ProcessMemory {
    /// Mapped buffers by address.
    mapped: Mutex<BTreeMap<usize, Mapped>>,
}

impl ClientMemory for ProcessMemory {
    fn read(&self, address: usize, out: &mut [u8]) -> bool {
        // SAFETY: OpenGL's contract: the client gave an address from which this many bytes can be
        // read. `out` is ours alone, so the two do not overlap.
        unsafe {
            ptr::copy_nonoverlapping(
                ptr::with_exposed_provenance(address),
                out.as_mut_ptr(),
                out.len(),
            )
        };
        true
    }

    fn write(&self, address: usize, bytes: &[u8]) -> bool {
        // SAFETY: OpenGL's contract: the client gave an address to which this many bytes can be
        // written. `bytes` is ours, so the two do not overlap.
        unsafe {
            ptr::copy_nonoverlapping(
                bytes.as_ptr(),
                ptr::with_exposed_provenance_mut(address),
                bytes.len(),
            )
        };
        true
    }

    fn is_there(&self, address: usize, length: usize) -> bool {
        crate::presence::is_there(address, length)
    }

    fn map(&self, mut bytes: Vec<u8>) -> usize {
        // An empty vector has no address of its own. Others stay where they are: a large one may
        // not be had twice.
        if bytes.capacity() == 0 {
            bytes.reserve(1);
        }
        let mut bytes = ManuallyDrop::new(bytes);
        let address = bytes.as_mut_ptr().expose_provenance();
        let mut mapped = self.mapped.lock().unwrap_or_else(PoisonError::into_inner);
        mapped.insert(address, (bytes.len(), bytes.capacity()));
        address
    }

    fn unmap(&self, address: usize) -> Option<Vec<u8>> {
        let mut mapped = self.mapped.lock().unwrap_or_else(PoisonError::into_inner);
        let (length, capacity) = mapped.remove(&address)?;
        // SAFETY: `map` took apart a vector of this address, length and capacity; the entry was
        // removed, so it is put together once.
        Some(unsafe {
            Vec::from_raw_parts(ptr::with_exposed_provenance_mut(address), length, capacity)
        })
    }
}

/// An argument of an entry point, and what the state machine is given of it.
pub(crate) trait Argument {
    type Given;
    fn given(self) -> Self::Given;
}

macro_rules! by_value {
    ($($kind:ty)+) => {
        $(impl Argument for $kind {
            type Given = Self;
            #[inline(always)]
            fn given(self) -> Self {
                self
            }
        })+
    };
}

by_value! { u8 i8 u16 i16 u32 i32 u64 i64 usize isize f32 f64 }

/// A pointer at a few numbers: what it points at, none for null.
impl<T: Copy, const N: usize> Argument for *const [T; N] {
    type Given = Option<[T; N]>;
    #[inline(always)]
    fn given(self) -> Option<[T; N]> {
        // SAFETY: OpenGL's contract: the client gave an address from which so many numbers can be
        // read, aligned or not.
        (!self.is_null()).then(|| unsafe { self.read_unaligned() })
    }
}

impl Drop for ProcessMemory {
    fn drop(&mut self) {
        let addresses: Vec<usize> =
            self.mapped.get_mut().unwrap_or_else(PoisonError::into_inner).keys().copied().collect();
        for address in addresses {
            drop(self.unmap(address));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_and_go() {
        let memory = ProcessMemory::default();
        let mut client = [1_u8, 2, 3, 4];
        let address = client.as_mut_ptr().expose_provenance();
        let mut out = [0; 2];
        assert!(memory.read(address + 1, &mut out));
        assert_eq!(out, [2, 3]);
        assert!(memory.write(address + 2, &[9, 8]));
        assert_eq!(client, [1, 2, 9, 8]);
    }

    #[test]
    fn what_the_client_writes_into_a_mapped_buffer_comes_back_once() {
        let memory = ProcessMemory::default();
        let address = memory.map(vec![1, 2, 3]);
        assert!(memory.write(address, &[7]));
        assert_eq!(memory.unmap(address), Some(vec![7, 2, 3]));
        assert_eq!(memory.unmap(address), None);
        let empty = memory.map(Vec::new());
        assert_ne!(empty, 0);
        assert_eq!(memory.unmap(empty), Some(Vec::new()));
        let _left_mapped = memory.map(vec![1]);
    }
}
