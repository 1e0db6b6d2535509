//! ARB_pixel_buffer_object: images that lie in buffer objects instead of the client's memory.
//!
//! What reads or writes images asks for a memory and an address. With a buffer bound the memory is
//! that buffer's data store, as it is at the call, and the address is an offset.

use super::Failure;
use crate::Context;
use crate::enums::*;
use crate::memory::ClientMemory;
use crate::objects::BufferHandle;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Where the store begins: an offset of 0 must not look like no address.
const START: usize = 1 << 16;

/// A data store as memory. Writes make a copy; the buffer gets it when all of them fit.
#[derive(Debug)]
struct Store(Mutex<Arc<Vec<u8>>>);

impl Store {
    fn bytes(&self) -> MutexGuard<'_, Arc<Vec<u8>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl ClientMemory for Store {
    fn read(&self, address: usize, out: &mut [u8]) -> bool {
        let bytes = self.bytes();
        let start = address.checked_sub(START);
        let Some(part) = start.and_then(|start| bytes.get(start..start.checked_add(out.len())?))
        else {
            return false;
        };
        out.copy_from_slice(part);
        true
    }

    fn write(&self, address: usize, from: &[u8]) -> bool {
        let mut bytes = self.bytes();
        let range = address
            .checked_sub(START)
            .and_then(|start| Some(start..start.checked_add(from.len())?));
        let Some(range) = range.filter(|range| range.end <= bytes.len()) else { return false };
        Arc::make_mut(&mut bytes)[range].copy_from_slice(from);
        true
    }

    fn map(&self, _bytes: Vec<u8>) -> usize {
        0
    }

    fn unmap(&self, _address: usize) -> Option<Vec<u8>> {
        None
    }
}

/// The data store of a buffer.
fn store_of(buffer: &BufferHandle) -> Result<Store, Failure> {
    match buffer.lock() {
        Some(buffer) if !buffer.is_mapped() => Ok(Store(Mutex::new(buffer.bytes.clone()))),
        _ => Err((INVALID_OPERATION, "the buffer of pixels is mapped")),
    }
}

/// Where an offset lies in a store of elements of `unit` bytes.
fn place(offset: usize, unit: usize) -> Result<usize, Failure> {
    let whole = offset.is_multiple_of(unit).then(|| offset.saturating_add(START));
    whole.ok_or((INVALID_OPERATION, "the offset is not one of whole numbers"))
}

impl Context {
    /// Where pixels of elements of `unit` bytes are unpacked from: a memory, and the address there.
    pub(crate) fn unpack_memory(
        &self,
        address: usize,
        unit: usize,
    ) -> Result<(Arc<dyn ClientMemory>, usize), Failure> {
        let buffer = &self.client.unpack.buffer;
        if buffer.is_none() {
            return Ok((self.memory.clone(), address));
        }
        Ok((Arc::new(store_of(buffer)?), place(address, unit)?))
    }

    /// Runs `write` with the memory that pixels of elements of `unit` bytes are packed into and the
    /// address there. `false` of `write` is an error with a buffer, which then keeps what it had.
    pub(crate) fn pack_into(
        &self,
        address: usize,
        unit: usize,
        write: impl FnOnce(&dyn ClientMemory, usize) -> bool,
    ) -> Result<(), Failure> {
        let buffer = &self.client.pack.buffer;
        if buffer.is_none() {
            write(&*self.memory, address);
            return Ok(());
        }
        let store = store_of(buffer)?;
        if !write(&store, place(address, unit)?) {
            return Err((INVALID_OPERATION, "the pixels do not fit in the buffer"));
        }
        let bytes = store.bytes().clone();
        if let Some(mut buffer) = buffer.lock() {
            buffer.replace(bytes);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context_with, read_u32};
    use super::*;

    #[test]
    fn pixels_go_through_buffers() {
        let mut c = context_with(2, 2);
        c.clear_color(1.0, 0.0, 0.0, 1.0);
        c.clear(COLOR_BUFFER_BIT);
        c.bind_buffer(PIXEL_PACK_BUFFER, 1);
        c.buffer_data(PIXEL_PACK_BUFFER, 20, 0, STREAM_READ);
        c.read_pixels(0, 0, 2, 2, RGBA, UNSIGNED_BYTE, 4);
        c.get_buffer_sub_data(PIXEL_PACK_BUFFER, 0, 8, BASE);
        assert_eq!(
            (c.error, read_u32(&c, BASE), read_u32(&c, BASE + 4)),
            (NO_ERROR, 0, 0xff00_00ff)
        );
        // One byte too far: nothing is written.
        c.read_pixels(0, 0, 2, 2, RGBA, UNSIGNED_BYTE, 8);
        assert_eq!(std::mem::take(&mut c.error), INVALID_OPERATION);
        // The same bytes as a texture, and back from it.
        c.bind_buffer(PIXEL_UNPACK_BUFFER, 1);
        c.tex_image_2d(TEXTURE_2D, 0, RGBA as i32, 2, 2, 0, RGBA, UNSIGNED_BYTE, 4);
        assert_eq!(c.error, NO_ERROR);
        c.tex_sub_image_2d(TEXTURE_2D, 0, 0, 0, 2, 2, RGBA, UNSIGNED_BYTE, 8);
        assert_eq!(std::mem::take(&mut c.error), INVALID_OPERATION);
        c.bind_buffer(PIXEL_PACK_BUFFER, 2);
        c.buffer_data(PIXEL_PACK_BUFFER, 16, 0, STREAM_READ);
        c.get_tex_image(TEXTURE_2D, 0, RGBA, UNSIGNED_BYTE, 0);
        c.get_buffer_sub_data(PIXEL_PACK_BUFFER, 0, 16, BASE);
        assert_eq!((c.error, read_u32(&c, BASE + 12)), (NO_ERROR, 0xff00_00ff));
        // A mapped buffer belongs to the client.
        c.map_buffer(PIXEL_PACK_BUFFER, READ_ONLY);
        c.read_pixels(0, 0, 1, 1, RGBA, UNSIGNED_BYTE, 0);
        assert_eq!(std::mem::take(&mut c.error), INVALID_OPERATION);
        c.unmap_buffer(PIXEL_PACK_BUFFER);
    }

    #[test]
    fn offsets_are_multiples_of_the_type() {
        let mut c = context_with(2, 2);
        let mut error = |call: &dyn Fn(&mut Context)| {
            call(&mut c);
            std::mem::take(&mut c.error)
        };
        for target in [PIXEL_PACK_BUFFER, PIXEL_UNPACK_BUFFER] {
            error(&|c| c.bind_buffer(target, 1));
        }
        error(&|c| c.buffer_data(PIXEL_PACK_BUFFER, 64, 0, STREAM_READ));
        for (kind, good, bad) in
            [(FLOAT, 4, 2), (UNSIGNED_SHORT, 2, 1), (UNSIGNED_SHORT_5_6_5, 2, 3)]
        {
            assert_eq!(error(&|c| c.read_pixels(0, 0, 1, 1, RGB, kind, good)), NO_ERROR);
            assert_eq!(error(&|c| c.read_pixels(0, 0, 1, 1, RGB, kind, bad)), INVALID_OPERATION);
        }
        assert_eq!(error(&|c| c.read_pixels(0, 0, 1, 1, RGB, UNSIGNED_BYTE, 3)), NO_ERROR);
        assert_eq!(error(&|c| c.pixel_mapfv(PIXEL_MAP_R_TO_R, 2, 2)), INVALID_OPERATION);
        assert_eq!(error(&|c| c.pixel_mapuiv(PIXEL_MAP_R_TO_R, 2, 2)), INVALID_OPERATION);
        assert_eq!(error(&|c| c.pixel_mapusv(PIXEL_MAP_R_TO_R, 2, 1)), INVALID_OPERATION);
        assert_eq!(error(&|c| c.pixel_mapusv(PIXEL_MAP_R_TO_R, 2, 2)), NO_ERROR);
        assert_eq!(error(&|c| c.get_pixel_mapfv(PIXEL_MAP_R_TO_R, 2)), INVALID_OPERATION);
        assert_eq!(error(&|c| c.get_pixel_mapusv(PIXEL_MAP_R_TO_R, 2)), NO_ERROR);
    }
}
